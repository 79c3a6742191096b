"""Answered counts of freedoms as items."""

from __future__ import annotations

from robokin.errors import InputError
from robokin.grading.answers.typed_answers import whole_number
from robokin.grading.feedback import Words
from robokin.grading.mark_items import BLANK, NOT_A_NUMBER, WRONG, Item
from robokin.grading.pose_difference import PASS


def count_item(id: str, text: str, option: str, right: int | None, note: str) -> Item:
    """The mark of an answered number; `note` says more of the right one.

    Raises InputError, with the option's name, where there is nothing to compare it with, and for what cannot be read.
    """
    if right is None:
        raise InputError(f"{option}: the true mobility is not known ({note}), expected --expect alone, the count")
    value = whole_number(text, option)
    if value is None:
        return Item(id, NOT_A_NUMBER if text.strip() else BLANK, 0.0, right, None, {"count": None})
    if value == right:
        return Item(id, PASS, 1.0, right, value, {"count": 0.0})
    side = "too many" if value > right else "too few"
    words = Words("", f"{value} is {side}", f"found {value}, expected {right}" + (f": {note}" if note else ""))
    return Item(id, WRONG, 0.0, right, value, {"count": float(value - right)}, words)
