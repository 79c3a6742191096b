"""Targets that are near enough to calculate with."""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array
from robokin.spatial.transforms import FARTHEST
from robokin.units import Units


class BadRowError(Exception):
    """A row, counted from 0, that is no pose, and why."""

    def __init__(self, row: int, sentence: str) -> None:
        """`sentence` says what was found and what was expected."""
        self.row, self.sentence = row, sentence


def near_enough(T: Array, units: Units) -> Array:
    """Poses (..., 4, 4) [m] as they are. Raises BadRowError, or ValueError for one, when they are too far away."""
    far = ~(np.abs(T[..., :3, 3]) <= FARTHEST).all(axis=-1)
    if far.any():
        sentence = f"found a target too far away, expected less than {FARTHEST / units.metres:g} {units.length}"
        if T.ndim == 2:
            raise ValueError(sentence)
        raise BadRowError(int(np.argmax(far)), sentence)
    return T
