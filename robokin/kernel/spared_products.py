"""Sums and products of entries, numbers or columns or terms, that leave out what a 0 or ±1 spares.

Nothing is loaded here: one configuration needs no arrays.
"""

from __future__ import annotations

TYPE_CHECKING = False  # `typing` has the same, and takes a while to load
if TYPE_CHECKING:
    from robokin.arrays import Array

    Entry = float | Array


def times(a: Entry, b: Entry) -> Entry:
    """a b."""
    if isinstance(b, float):
        a, b = b, a
    if isinstance(a, float):
        if a == 0.0:
            return 0.0
        if a == 1.0:
            return b
        if a == -1.0:
            return -b
    return a * b


def plus(a: Entry, b: Entry) -> Entry:
    """a + b."""
    if isinstance(a, float) and a == 0.0:
        return b
    if isinstance(b, float) and b == 0.0:
        return a
    return a + b


def minus(a: Entry, b: Entry) -> Entry:
    """a - b."""
    if isinstance(b, float) and b == 0.0:
        return a
    if isinstance(a, float) and a == 0.0:
        return -b
    return a - b


def increased(total: Entry, number: float, entry: Entry) -> Entry:
    """total + number · entry."""
    if isinstance(entry, float):
        return plus(total, number * entry) if entry else total
    if isinstance(total, float) and total == 0.0:
        return times(number, entry)
    if number == 1.0:
        return total + entry
    if number == -1.0:
        return total - entry
    return total + number * entry if number else total


def turned(c: Entry, u: Entry, s: Entry, v: Entry) -> Entry:
    """c u + s v."""
    if isinstance(u, float) or isinstance(v, float):
        return plus(times(c, u), times(s, v))
    product = c * u
    product += s * v
    return product


def turned_back(c: Entry, u: Entry, s: Entry, v: Entry) -> Entry:
    """c u - s v."""
    if isinstance(u, float) or isinstance(v, float):
        return minus(times(c, u), times(s, v))
    product = c * u
    product -= s * v
    return product
