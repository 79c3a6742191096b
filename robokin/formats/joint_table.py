"""The table of a robot's description, by rows or by columns, to joints."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Mapping as MappingType

from robokin.errors import DescriptionError, or_list, shown
from robokin.formats.joint_row import VARIABLE, RowPlace, row_of, row_type
from robokin.formats.node_values import Context, fields_of, list_of
from robokin.formats.schema import DH_ROW, FRAME_ROW, MAX_ROWS, SCREW_ROW, Fields
from robokin.formats.yaml_tree import FilePlace, Mapping, Node, Scalar, Sequence
from robokin.model import Joint, JointType

TABLES: dict[str, Fields] = {"standard": DH_ROW, "modified": DH_ROW, "frames": FRAME_ROW, "screws": SCREW_ROW}
"""What a row holds, by convention."""

ZERO = re.compile(r"[-+]?(0+\.?0*|\.0+)")
"""The ways to write a cell of a column that says nothing."""


def rows_of(
    node: Node, stated: str | None, context: Context
) -> tuple[tuple[Joint, ...] | None, tuple[JointType, ...] | None]:
    """The rows of the table and the types of its joints; None, and the mistakes gathered, where any is wrong.

    stated: the convention, None where that is not known.
    """
    before = context.faults.count
    convention = stated or _convention_by_keys(node)
    known = TABLES[convention]
    rows = _rows_of_columns(node, convention, context) if isinstance(node, Mapping) else list_of(node, "the joints")
    if not rows:
        raise node.mark.error("found no joints, expected at least one row")
    if len(rows) > MAX_ROWS:
        raise node.mark.error(f"found {len(rows)} rows, expected at most {MAX_ROWS}")
    joints: list[Joint | None] = []
    names: dict[str, int] = {}
    kinds = [_kind_or_none(row) for row in rows]
    moving = [kind is not JointType.FIXED for kind in kinds]
    for i, row in enumerate(rows, start=1):
        # How many joints there are before a row is known only if every type is.
        place = RowPlace(i, sum(moving[: i - 1]) + 1, sum(moving), stated or "", None not in kinds[: i - 1])
        joint = context.faults.attempt(None, _row_in, row, known, place, convention, context)
        if joint is not None and joint.name in names:
            context.faults.add(
                row.mark.error(
                    f"found the name '{shown(joint.name)}' of row {i} on row {names[joint.name]} too, "
                    "expected another name"
                )
            )
        elif joint is not None:
            names[joint.name] = i
        joints.append(joint)
    types = tuple(kind for kind in kinds if kind is not None)
    moving_types = tuple(kind for kind in types if kind is not JointType.FIXED) if len(types) == len(kinds) else None
    if context.faults.count > before or None in joints:
        return None, moving_types
    return tuple(joint for joint in joints if joint is not None), moving_types


def _convention_by_keys(node: Node) -> str:
    """The convention that a table is meant in, where the file states none that there is."""
    rows = node.items if isinstance(node, Sequence) else [node]
    keys = {key for row in rows if isinstance(row, Mapping) for key in row.keys}
    return "screws" if "at" in keys else "frames" if keys & {"origin", "axis"} else "standard"


def _kind_or_none(row: Node) -> JointType | None:
    if isinstance(row, Mapping) and "type" in row.entries:
        with contextlib.suppress(DescriptionError):
            return row_type(row.entries["type"])
    return None


def _row_in(row: Node, known: Fields, place: RowPlace, convention: str, context: Context) -> Joint | None:
    """One row; None, and the mistakes gathered, where it is wrong."""
    before = context.faults.count
    if isinstance(row, Mapping):
        row = _without_other_cells(row, known, f"row {place.row}", place.convention, context)
    joint = row_of(fields_of(row, known, f"row {place.row}", context.faults), place, convention, context)
    return joint if context.faults.count == before else None


def _without_other_cells(row: Mapping, known: Fields, where: str, convention: str, context: Context) -> Mapping:
    """A row, or columns, without the cells of other kinds of tables: mistakes, if the convention is known."""
    other = {name for table in TABLES.values() for name in table}
    keys = {name: mark for name, mark in row.keys.items() if name not in other or name in known}
    for name, mark in row.keys.items():
        if name not in keys and convention:
            context.faults.add(mark.error(_other_convention(name, where, convention, known, "at" in row.keys)))
    return Mapping({name: row.entries[name] for name in keys}, row.mark, keys)


def _other_convention(name: str, where: str, convention: str, known: MappingType[str, object], placed: bool) -> str:
    """The message for a cell that belongs to another kind of table; placed: whether its row has a place `at`."""
    right = or_list([other for other, fields in TABLES.items() if name in fields])
    if name == "axis":
        right = "screws" if placed else "frames"
    return (
        f"found '{name}' in {where} of the {convention} convention, expected one of {', '.join(known)}, "
        f"or `convention: {right}`"
    )


def _rows_of_columns(node: Mapping, convention: str, context: Context) -> list[Node]:
    """One mapping a row, from a mapping of columns."""
    known = TABLES[convention]
    node = _without_other_cells(node, known, "the joints' columns", convention, context)
    columns = fields_of(node, known, "the joints' columns", context.faults)
    types = columns["type"]
    if types.mark.said:
        raise types.mark.error("found no rows, expected a type for each")
    if isinstance(types, Scalar):
        start = types.mark
        kinds: list[Node] = [
            Scalar(letter, FilePlace(start.file, start.line, start.column + i + types.quoted))
            for i, letter in enumerate(types.text)
            if not letter.isspace()
        ]
    else:
        kinds = list_of(types, "the joints' types")
    listed = {
        name: context.faults.attempt(None, _column, column, name, len(kinds))
        for name, column in columns.items()
        if name != "type"
    }
    rows: list[Node] = []
    for i, kind in enumerate(kinds):
        row = Mapping({"type": kind}, kind.mark, {"type": kind.mark})
        for name, cells in listed.items():
            if cells is None:
                continue
            if not _left_out(cells[i], name, _kind_or_none(row)):
                row.entries[name] = cells[i]
                row.keys[name] = cells[i].mark
        rows.append(row)
    return rows


def _column(node: Node, name: str, count: int) -> list[Node]:
    cells = list_of(node, f"the column {name}")
    if len(cells) != count:
        raise node.mark.error(f"found {len(cells)} values in the column {name}, expected {count}: one for each type")
    return cells


def _left_out(cell: Node, column: str, kind: JointType | None) -> bool:
    """Whether a column's cell says nothing: it is empty, or 0 where the row form has no cell.

    A column has a cell for every row, so also for the ones that the row form would leave out: theta of
    a revolute and d of a prismatic row, where the variable stands, and the offset of a fixed one.
    """
    if not isinstance(cell, Scalar):
        return False
    # The sense of a row without a variable is no more than 1.
    if kind is None or (column == "sense" and kind is JointType.FIXED):
        return cell.empty or (kind is not None and cell.text.strip() in ("1", "+1"))
    none_due = column == ("offset" if kind is JointType.FIXED else VARIABLE[kind])
    return cell.empty or (none_due and ZERO.fullmatch(cell.text.strip()) is not None)
