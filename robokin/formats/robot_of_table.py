"""A Denavit-Hartenberg table, pasted or as numbers, as a robot."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from robokin.errors import InputError, shown
from robokin.expected import (
    expect_choice,
    expect_columns,
    expect_finite,
    expect_kind,
    expect_number,
    has_names,
    names_of,
)
from robokin.formats.pasted_description import Wishes, described_table
from robokin.formats.read import read_text
from robokin.model import Robot
from robokin.units import METRES, RADIANS

CONVENTIONS = ("standard", "modified")

OPTION = re.compile(r"--(\w+)")

CELLS = ("theta", "d", "a", "alpha")
"""The columns of a table of numbers, in their order."""


def from_table(
    table: str | ArrayLike,
    *,
    types: str | None = None,
    convention: str | None = None,
    length: str | None = None,
    angle: str | None = None,
    name: str = "my arm",
    values: Mapping[str, float] | None = None,
) -> Robot:
    """The robot of a Denavit-Hartenberg table.

    table: (n, 4) [rad, m], a row theta, d, a, alpha for each joint, in other units where `length` and `angle` name it;
    theta of a joint that turns, and d of one that slides, is what it is at zero. Or a text, as a page prints it (see
    `robokin new --table`). types: R, P or F (fixed) for each row, by default all R for numbers, and as the text says;
    convention: standard or modified; values: of the names in a text's cells, in the text's units.
    Raises InputError for what is no table, and where it leaves something open.
    Source: J. Denavit and R. S. Hartenberg, A kinematic notation for lower-pair mechanisms, J. Appl. Mech. 22, 1955.
    """
    for given, choices, argument in ((convention, CONVENTIONS, "convention"), (length, METRES, "length"),
                                     (angle, RADIANS, "angle")):  # fmt: skip
        if given is not None:
            expect_choice(given, choices, argument)
    expect_kind(name, str, "name", "a name")
    if types is not None:
        expect_kind(types, str, "types", "a letter R, P or F for each row")
    if values is not None:
        expect_kind(values, Mapping, "values", "numbers by their names")
    columns = None
    if not isinstance(table, str):
        table = _in_order(table)
        rows = expect_finite(table, "table", "a text, or rows of theta, d, a and alpha")
        if rows.ndim != 2 or rows.shape[1] != 4 or not len(rows):
            raise InputError(f"table: found an array of shape {rows.shape}, expected rows of theta, d, a and alpha")
        table = "theta,d,a,alpha\n" + "\n".join(",".join(map(repr, row)) for row in rows.tolist())
        types, columns = types or "R" * len(rows), CELLS
        convention, length, angle = convention or "standard", length or "m", angle or "rad"
    said = {key: repr(expect_number(value, f"values[{key!r}]", "a number")) for key, value in (values or {}).items()}
    try:
        made = described_table(table, Wishes(name, convention, length, angle, types, columns, said))
    except InputError as error:
        if type(error) is not InputError:
            raise
        # The reader speaks of the command's options: here they are arguments, and what has none is the table's.
        sentence = OPTION.sub(r"\1", str(error).replace("--set ", "values: "))
        raise InputError(sentence if OPTION.match(str(error)) else f"table: {sentence}") from None
    if made.missing:
        raise InputError(f"the table gives no value for {', '.join(made.missing)}, expected them in values")
    robot = read_text(made.text, "the table")
    assert isinstance(robot, Robot)
    return robot


def _in_order(table: ArrayLike) -> ArrayLike:
    """A data frame with the columns of a table as an array, in their order; all else as it is. Raises InputError."""
    if not has_names(table):
        return table
    names = [str(name).strip().casefold() for name in names_of(table)]
    if sorted(names) != sorted(CELLS):
        raise InputError(
            f"table: found the columns {shown(', '.join(names))}, expected {', '.join(CELLS)}, in any order"
        )
    return np.atleast_2d(expect_columns(table, map(names.index, CELLS), "table"))
