"""The units of a pasted table: those that it names, or those that its numbers tell of."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping

from robokin.errors import InputError
from robokin.formats.pasted_headings import PastedHeading
from robokin.formats.pasted_joints import TableDraft
from robokin.formats.written_numbers import is_part_of_pi
from robokin.units import METRES

ANGLES = ("theta", "alpha")
MILLIMETRES_FROM = 10.0
"""Lengths without a unit of which one is at least this are taken for millimetres: no arm of a lecture is 10 m long."""


def angle_unit(
    headings: list[PastedHeading], draft: TableDraft, values: Mapping[str, str], wished: str | None
) -> tuple[str, list[str]]:
    """The unit of angles, and what is to be told of it; values: those of names in cells of angles.

    Raises InputError where it cannot be told, or is told twice, and for a part of pi that would be read as degrees.
    """
    unit, notes = _angle_unit(headings, draft, values, wished)
    if unit == "deg" and (of_pi := next((name for name, value in values.items() if "pi" in value), None)):
        raise InputError(
            f"found {of_pi} = {values[of_pi]} beside angles in degrees, expected degrees, with --set {of_pi}=VALUE"
        )
    return unit, notes


def _angle_unit(
    headings: list[PastedHeading], draft: TableDraft, values: Mapping[str, str], wished: str | None
) -> tuple[str, list[str]]:
    named = draft.angle_units | {unit for heading in headings for unit in heading.units if unit in ("deg", "rad")}
    texts = [*values.values(), *(row.cells[name] for row in draft.rows for name in ANGLES)]
    texts += [limit for row in draft.rows if row.kind == "R" for limit in row.limits or ()]
    numbers = [number for text in texts if not re.search(r"\bpi\b", text) for number in _numbers(text) if number[0]]
    if wished is not None and named and wished not in named:
        raise InputError(f"--angle {wished}: found angles in {next(iter(named))} in the table, expected that unit")
    if len(named) > 1:
        # Parts of pi say themselves that they are radians; of a bare number only its own column could tell.
        if numbers and any(unit == "rad" for heading in headings for unit in heading.units):
            raise InputError("found angles in deg and in rad, expected one unit in the whole table")
        return "deg", []
    if wished is not None:
        return wished, []
    if named:
        return named.pop(), []
    if any(re.search(r"\bpi\b", text) for text in texts):
        large = [digits for value, digits in numbers if abs(value) > 2.0 * math.pi]
        if large:
            raise InputError(
                f"found angles with pi, and such as {large[0]}, expected ° behind those in degrees, or --angle"
            )
        return "rad", []
    large = [digits for value, digits in numbers if abs(value) > 2.0 * math.pi]
    parts = [digits for value, digits in numbers if "." in digits and is_part_of_pi(value, digits)]
    if large and parts:
        raise InputError(f"found angles such as {large[0]} and {parts[0]}, expected one unit, or --angle")
    if large:
        return "deg", ["angles are in degrees: some are over 2π"]
    if any(is_part_of_pi(value, digits) for value, digits in numbers):
        return "rad", ["angles are in radians: some are parts of π"]
    if numbers:
        raise InputError(
            f"found angles such as {numbers[0][1]} without their unit, expected --angle deg or --angle rad"
        )
    return "deg", ["angles are in degrees: the table has none to tell by"]


def length_unit(
    headings: list[PastedHeading], draft: TableDraft, values: list[str], wished: str | None
) -> tuple[str, list[str]]:
    """The unit of lengths, and what is to be told of it. Raises InputError where the table names another, or two."""
    named = draft.length_units | {unit for heading in headings for unit in heading.units if unit in METRES}
    if len(named) > 1:
        raise InputError(f"found lengths in {' and in '.join(sorted(named))}, expected one unit in the whole table")
    if named and wished not in (None, *named):
        raise InputError(f"--length {wished}: found lengths in {next(iter(named))} in the table, expected that unit")
    if wished is not None:
        return wished, []
    if named:
        return named.pop(), []
    texts = [*values, *(row.cells[name] for row in draft.rows for name in ("d", "a"))]
    numbers = [value for text in texts for value, _ in _numbers(text)]
    greatest = max(map(abs, numbers), default=0.0)
    unit = "mm" if greatest >= MILLIMETRES_FROM else "m"
    why = f"up to {greatest:g}" if greatest else "of which the table has none"
    return unit, [f"lengths are taken for {unit} ({why}); --length says otherwise"]


def _numbers(text: str) -> list[tuple[float, str]]:
    """The numbers in an expression, with their digits."""
    found = re.finditer(r"(?<![\w.])(?<!\*\*)(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?![\w.])", text)
    return [(float(match[0]), match[0]) for match in found]
