"""Numbers that a person types: few digits, and the same digits on every machine.

A last digit that is worked out differs from machine to machine, so that a value on the border of two roundings would
be printed in two ways. It is rounded twice: six digits beyond those that are shown first, which takes away what the
arithmetic left, then half away from zero.
"""

from __future__ import annotations

import math
from decimal import ROUND_HALF_UP, Decimal
from functools import cache

import numpy as np

from robokin.arrays import Array, Flags
from robokin.units import Units

SPARE = 6
"""Digits beyond those shown that are kept by the first rounding."""


def decimals_for(part: float) -> int:
    """So many decimals round a number by no more than half of a part of it, such as a tenth of a tolerance."""
    return max(0, math.ceil(-math.log10(part) - 1e-9)) if part > 0.0 else 9


@cache
def _last_digit(decimals: int) -> Decimal:
    return Decimal(1).scaleb(-decimals)


def decimal_text(value: float, decimals: int) -> str:
    """A number with at most so many decimals, without zeros behind and never -0."""
    steady = Decimal(repr(round(float(value), decimals + SPARE)))
    text = format(steady.quantize(_last_digit(decimals), ROUND_HALF_UP), "f")
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def angle_text(value: float, decimals: int, units: Units) -> str:
    """The same of an angle in the units, where minus half a turn is half a turn."""
    text = decimal_text(value, decimals)
    half = decimal_text(np.pi / units.radians, decimals)
    return half if text == f"-{half}" else text


def multiples(step: tuple[int, int], low: float, high: float) -> list[float]:
    """All multiples of a step, (1, -2) for 0.01, from low to high, each the nearest number to its digits."""
    digit, power = step
    size = digit * 10.0**power
    first, last = math.ceil(low / size - 1e-9), math.floor(high / size + 1e-9)
    return [float(f"{number * digit}e{power}") for number in range(first, last + 1)]


def round_step(part: float) -> tuple[int, int]:
    """The greatest of 1, 2, 5 times a power of ten that is no more than a length: (5, -2) for 0.07."""
    power = math.floor(math.log10(part) + 1e-9)
    digit = max(digit for digit in (1, 2, 5) if digit * 10.0**power <= part * (1.0 + 1e-9))
    return digit, power


def whole_turn(values: Array, revolute: Array | Flags) -> Array:
    """Differences of joint values (..., n) [rad | m], those of angles by the shorter way round."""
    return np.where(revolute, np.remainder(values + np.pi, 2.0 * np.pi) - np.pi, values)
