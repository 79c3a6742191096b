"""Sweeps of which a sample runs with every change, and the whole with the slow tests."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pytest


def sweep(values: Iterable[Any], every: int) -> list[Any]:
    """Values of a parametrized test, of which the first of each `every` is looked at each time and the rest is slow.

    A tuple holds the values of several parameters.
    """
    rows = [value if isinstance(value, tuple) else (value,) for value in values]
    return [pytest.param(*row, marks=[pytest.mark.slow] if i % every else []) for i, row in enumerate(rows)]
