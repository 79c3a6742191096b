"""Answered counts of freedoms as items."""

from __future__ import annotations

from collections.abc import Callable

from robokin.cli.check_poses import no_number
from robokin.cli.checks import PASS, WRONG, Item
from robokin.errors import InputError, shown
from robokin.grading.feedback import Words


def whole_number(text: str, option: str) -> int | None:
    """A whole number, None for a blank or what is no number. Raises InputError for anything else."""
    if no_number(text):
        return None
    digits = text.strip()
    try:
        if len(digits) < 20 and float(digits).is_integer():
            return int(float(digits))
    except ValueError:
        pass
    raise InputError(f"{option}: found '{shown(text)}', expected a whole number")


def count_item(id: str, text: str, option: str, right: int | None, note: Callable[[], str]) -> Item:
    """The mark of an answered number. Raises InputError where there is nothing to compare it with."""
    if right is None:
        raise InputError(f"{option}: the true mobility is not known ({note()}), expected --expect alone, the count")
    value = whole_number(text, option)
    if value is None:
        return Item(id, "not a number" if text.strip() else "blank", 0.0, right, None, {"count": None})
    if value == right:
        return Item(id, PASS, 1.0, right, value, {"count": 0.0})
    side = "too many" if value > right else "too few"
    answer = f"found {value}, expected {right}" + (f": {said}" if (said := note()) else "")
    words = Words("", f"{value} is {side}", answer)
    return Item(id, WRONG, 0.0, right, value, {"count": float(value - right)}, words)
