"""The kinds of arrays that functions take and return, in annotations. Shapes and units are in their docstrings."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
"""Real numbers."""

Complex = NDArray[np.complex128]
"""Complex numbers."""

Flags = NDArray[np.bool_]
"""Yes or no, each."""

Index = NDArray[np.intp]
"""Positions in other arrays, or counts."""

Whole = NDArray[np.int64]
"""Whole numbers."""

Bytes = NDArray[np.uint8]
"""Whole numbers below 256."""


def read_only(values: ArrayLike) -> Array:
    """A copy that cannot be changed."""
    array = np.array(values, dtype=np.float64)
    array.flags.writeable = False
    return array


def combined(values: Array, S: Array) -> Array:
    """values @ S, (..., m) by (m, n), each sum in the order of its terms: a row among others has the digits that it has
    alone, which those of BLAS have not."""
    if values.ndim == 1:
        made = [0.0] * S.shape[1]
        for value, row in zip(values.tolist(), S.tolist(), strict=True):
            made = [known + value * factor for known, factor in zip(made, row, strict=True)]
        return np.array(made)
    sums = np.zeros((*values.shape[:-1], S.shape[1]))
    for place, row in enumerate(S):
        sums += values[..., place, None] * row
    return sums
