"""How a number is written: its digits, and whether they are those of an angle in the other unit."""

from __future__ import annotations

import math


def is_whole_degrees(value: float, text: str) -> bool:
    """Whether a number is the radians of a whole number of degrees, cut in print after three decimals or more."""
    degrees = math.degrees(value)
    return decimals(text) >= 3 and abs(degrees - round(degrees)) <= 0.51 * math.degrees(10.0 ** -decimals(text))


def is_part_of_pi(value: float, text: str = "", turns: int = 2) -> bool:
    """Whether a number is pi times a twelfth or more, cut in print: 1.57, 1.5708, -2.0944.

    Quarters of a turn count with three digits, others with four: 0.26 and 1.05 are too common. It is so of no more
    turns than given.
    """
    text = text or repr(float(value))
    digits = significant(text)
    part = round(abs(value) / (math.pi / 12.0))
    if digits < 3 or decimals(text) < 2 or part == 0 or part > 24 * turns or "pi" in text:
        return False
    off = abs(abs(value) - part * math.pi / 12.0)
    whole = part % 6 == 0
    return off <= 1.001 * 10.0 ** -min(decimals(text), 12) and (whole or digits >= 4)


def significant(text: str) -> int:
    """Digits of a number as it is written, without zeros before it; 0 for an expression."""
    mantissa = text.strip().lstrip("+-").lower().partition("e")[0]
    digits = mantissa.replace(".", "", 1)
    return len(digits.lstrip("0")) if digits.isdecimal() else 0


def whole(text: str) -> bool:
    """Whether a number is written as a whole number."""
    return significant(text) > 0 and "." not in text


def decimals(text: str) -> int:
    """Digits behind the point of a number as it is written; 0 for an expression."""
    mantissa, _, exponent = text.strip().lower().partition("e")
    if not significant(text):
        return 0
    shift = int(exponent) if exponent.lstrip("+-").isdecimal() else 0
    return max(len(mantissa.partition(".")[2]) - shift, 0)
