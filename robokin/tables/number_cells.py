"""Numbers in cells: plain ones, expressions, and decimal commas where they can be told."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from enum import Enum

from robokin.errors import ExpressionError, shown
from robokin.formats.number_expressions import Scope, evaluate
from robokin.units import Units

PLAIN = re.compile(r"\s*[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\s*", re.ASCII)
"""A number that is no expression."""

COMMA = re.compile(r"\s*[-+]?(\d+,\d*|,\d+)([eE][-+]?\d+)?\s*", re.ASCII)
"""A number with a decimal comma."""

THOUSANDS = re.compile(r"\s*[-+]?[1-9]\d{0,2},\d{3}\s*", re.ASCII)
"""A number whose comma could also stand before the hundreds."""


class Decimals(Enum):
    """How the numbers of a file may be written, beside as expressions."""

    POINT = 1
    COMMA_OR_POINT = 2
    COMMA_UNLESS_THOUSANDS = 3
    """1,234 may be either where other numbers have points: it is refused there."""

    def plain(self, cell: str) -> str:
        """A cell with a decimal point in place of a decimal comma; as it stands where it may not have one."""
        if self is Decimals.POINT or "," not in cell or not COMMA.fullmatch(cell):
            return cell
        return cell if self is Decimals.COMMA_UNLESS_THOUSANDS and THOUSANDS.fullmatch(cell) else cell.replace(",", ".")


def decimals_of(separator: str, cells: Iterable[str]) -> Decimals:
    """How numbers are written in a file with this separator and these cells."""
    if separator not in (";", "\t"):
        return Decimals.POINT
    points = any("." in cell and PLAIN.fullmatch(cell) for cell in cells)
    return Decimals.COMMA_UNLESS_THOUSANDS if points else Decimals.COMMA_OR_POINT


class OneDecimalSign:
    """The decimal sign of a stream: of its numbers all have points, or all have commas.

    Commas are decimal only where something else separates the cells.
    """

    def __init__(self, separator: str) -> None:
        self.commas = separator in (";", "\t")
        self.seen: str | None = None

    def plain(self, cell: str) -> str:
        """A cell with a decimal point in place of a decimal comma. Raises ExpressionError for a stream with both.

        There a comma may also stand before the hundreds.
        """
        comma = "," in cell and COMMA.fullmatch(cell) is not None
        if comma and not self.commas:
            raise ExpressionError(
                f"found a comma in the number '{shown(cell)}', expected a decimal point; "
                "with decimal commas, semicolons or tabs between the cells"
            )
        sign = "," if comma else "." if "." in cell and PLAIN.fullmatch(cell) else None
        if sign and self.seen and sign != self.seen:
            raise ExpressionError(
                f"found decimal commas and decimal points in one file, here '{shown(cell)}', expected one of them"
            )
        self.seen = self.seen or sign
        return cell.replace(",", ".") if comma else cell


def number_in(cell: str, units: Units, angle: bool) -> float:
    """The number in a cell, in the given units. Raises ExpressionError."""
    # A plain number is most of what there is, and needs no parser.
    if PLAIN.fullmatch(cell) and math.isfinite(number := float(cell)):
        return number
    return evaluate(cell, Scope(degrees=units.degrees), angle=angle).number
