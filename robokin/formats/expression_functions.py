"""The functions of number expressions, with their trigonometry in the angle unit at hand."""

from __future__ import annotations

import math
from collections.abc import Callable

MANY = 10_000
"""More arguments than any expression has room for."""


def _sine_of_degrees(x: float) -> float:
    """sin of x degrees, exact where it is 0, ±0.5 or ±1 (the sine of a rounded pi/6 is not 0.5)."""
    sign = math.copysign(1.0, x)
    r = math.fmod(abs(x), 360.0)  # this and both differences below are exact
    if r >= 180.0:
        r, sign = r - 180.0, -sign
    if r > 90.0:
        r = 180.0 - r
    exact = {0.0: 0.0, 30.0: 0.5, 90.0: 1.0}
    sine = exact[r] if r in exact else math.sin(math.radians(r))
    return sign * sine if sine else 0.0


def _cosine_of_degrees(x: float) -> float:
    return _sine_of_degrees(90.0 - math.fmod(abs(x), 360.0))


def _tangent_of_degrees(x: float) -> float:
    r = math.fmod(x, 180.0)
    if abs(r) in (45.0, 135.0):
        return math.copysign(1.0, r) if abs(r) == 45.0 else -math.copysign(1.0, r)
    return _sine_of_degrees(x) / _cosine_of_degrees(x) + 0.0  # no negative zero


Function = Callable[..., float]

IN_RADIANS: dict[str, Function] = {
    "sin": math.sin, "cos": math.cos, "tan": math.tan,
    "asin": math.asin, "acos": math.acos, "atan": math.atan, "atan2": math.atan2,
}  # fmt: skip

IN_DEGREES: dict[str, Function] = {
    "sin": _sine_of_degrees,
    "cos": _cosine_of_degrees,
    "tan": _tangent_of_degrees,
    "asin": lambda x: math.degrees(math.asin(x)),
    "acos": lambda x: math.degrees(math.acos(x)),
    "atan": lambda x: math.degrees(math.atan(x)),
    "atan2": lambda y, x: math.degrees(math.atan2(y, x)),
}

PLAIN: dict[str, Function] = {
    "sqrt": math.sqrt,
    "abs": abs,
    "min": lambda *values: min(values),  # of one value too
    "max": lambda *values: max(values),
    "deg": math.degrees,
    "rad": math.radians,
}

FUNCTIONS = ("sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "abs", "min", "max", "deg", "rad")
TAKES_ANGLE = ("sin", "cos", "tan")
ARGUMENTS = {"atan2": (2, 2), "min": (1, MANY), "max": (1, MANY)}
"""Least and greatest number of arguments, where it is not one."""
