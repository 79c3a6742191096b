"""Tables that are as long as their input: a heading once, then a line a row in columns of one width."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from robokin.arrays import Array
from robokin.units import Units

PAGE = 80
"""Characters of a line."""

LENGTH_DECIMALS = {"m": 6, "cm": 4, "mm": 3, "in": 5}
ANGLE_DECIMALS = {"rad": 6, "deg": 4}
"""Decimals that show a micrometre and a microradian."""


class NumberColumns:
    """Lines of numbers under their headings.

    `names` are the headings of the numbers and `kinds` is a letter for each: l for a length, a for an
    angle, anything else for a pure number. `labels` are the headings of what stands before them, each
    with its width.
    """

    def __init__(self, labels: Sequence[tuple[str, int]], names: Sequence[str], kinds: str, units: Units) -> None:
        decimals = {"l": LENGTH_DECIMALS[units.length], "a": ANGLE_DECIMALS[units.angle]}
        widest = {"l": 10, "a": 9}
        self.decimals = [decimals.get(kind, 6) for kind in kinds]
        widths = [widest.get(kind, 9) for kind in kinds]
        room = PAGE - sum(width for _, width in labels) - sum(widths)
        gap = 2 if room >= 2 * (len(labels) + len(names)) else 1
        space = " " * gap
        self.line = space.join(
            [f"%{width}s" for _, width in labels]
            + [f"%{width}.{decimals}f" for width, decimals in zip(widths, self.decimals, strict=True)]
        )
        headings = [f"{name:>{width}}" for name, width in [*labels, *zip(names, widths, strict=True)]]
        self.heading = f"{space.join(headings)}\n{'─' * len(space.join(headings))}\n"

    def lines(self, labels: Iterable[Sequence[object]], numbers: Array) -> str:
        """Lines for rows of numbers (m, k), each after its labels."""
        rounded = np.empty_like(numbers)
        for i, decimals in enumerate(self.decimals):
            # Rounded here, so that nothing is shown as -0.
            rounded[:, i] = np.round(numbers[:, i], decimals) + 0.0
        shown = [self.line % (*label, *row) for label, row in zip(labels, rounded.tolist(), strict=True)]
        return "".join(f"{line}\n" for line in shown)
