"""The table of a robot's description to a Robot."""

from __future__ import annotations

import re
from collections.abc import Mapping as MappingType

import numpy as np
from numpy.typing import NDArray

from robokin.description.cells import (
    Context,
    choice_of,
    fields_of,
    list_of,
    number_of,
    parameters_in,
    parameters_in_position,
    text_of,
    transform_of,
    vector_of,
)
from robokin.description.read import Head
from robokin.description.schema import CONVENTIONS, DH_ROW, FRAME_ROW, MAX_ROWS, ROW_TYPES, TYPE_LETTERS
from robokin.description.transforms import PRIMES
from robokin.description.tree import Mapping, Mark, Node, Scalar, Sequence, describe
from robokin.errors import shown
from robokin.model import Joint, JointType, Robot

Array = NDArray[np.float64]

VARIABLE = {JointType.REVOLUTE: "theta", JointType.PRISMATIC: "d"}
"""The cell that the joint variable stands in."""

NUMBERS = ("theta", "d", "a", "alpha", "offset")
"""The cells of a row that hold one number."""

ZERO = re.compile(r"[-+]?(0+\.?0*|\.0+)")
"""The ways to write a cell of a column that says nothing."""


def read_robot(fields: MappingType[str, Node], head: Head) -> Robot:
    """The robot with these fields. Raises DescriptionError."""
    convention = "standard"
    if "convention" in fields:
        convention = choice_of(fields["convention"], CONVENTIONS, "the convention")
    rows = _rows(fields["joints"], convention, head.context)
    joints = [row for row in rows if row.moves]
    return Robot(
        name=head.name,
        rows=rows,
        convention=convention,  # type: ignore[arg-type]  # choice_of has made sure
        id=head.id,
        description=head.description,
        source=head.source,
        units=head.context.units,
        parameters=head.parameters,
        base=transform_of(fields["base"], head.context, "base") if "base" in fields else np.eye(4),
        tool=transform_of(fields["tool"], head.context, "tool") if "tool" in fields else np.eye(4),
        poses=_poses(fields["poses"], joints, head.context) if "poses" in fields else {},
        texts=tuple(
            (f"{name} {axis}", text)
            for name in ("base", "tool")
            if name in fields
            for axis, text in parameters_in_position(fields[name], head.context)
        ),
    )


def _rows(node: Node, convention: str, context: Context) -> tuple[Joint, ...]:
    known = FRAME_ROW if convention == "frames" else DH_ROW
    other = DH_ROW if convention == "frames" else FRAME_ROW
    rows = _rows_of_columns(node, convention) if isinstance(node, Mapping) else list_of(node, "the joints")
    if not rows:
        raise node.mark.error("found no joints, expected at least one row")
    if len(rows) > MAX_ROWS:
        raise node.mark.error(f"found {len(rows)} rows, expected at most {MAX_ROWS}")
    joints: list[Joint] = []
    names: dict[str, int] = {}
    for i, row in enumerate(rows, start=1):
        if isinstance(row, Mapping):
            for name, mark in row.keys.items():
                if name in other and name not in known:
                    raise mark.error(_other_convention(name, f"row {i}", convention, known))
        joint = _row(fields_of(row, known, f"row {i}"), row.mark, i, convention, context)
        if joint.name in names:
            raise row.mark.error(
                f"found the name '{shown(joint.name)}' of row {i} on row {names[joint.name]} too, expected another name"
            )
        names[joint.name] = i
        joints.append(joint)
    return tuple(joints)


def _other_convention(name: str, where: str, convention: str, known: MappingType[str, object]) -> str:
    """The message for a cell that belongs to the other kind of table."""
    right = "standard or modified" if convention == "frames" else "frames"
    return (
        f"found '{name}' in {where} of the {convention} convention, expected one of {', '.join(known)}, "
        f"or `convention: {right}`"
    )


def _rows_of_columns(node: Mapping, convention: str) -> list[Node]:
    """One mapping a row, from a mapping of columns."""
    known = FRAME_ROW if convention == "frames" else DH_ROW
    other = DH_ROW if convention == "frames" else FRAME_ROW
    for name, mark in node.keys.items():
        if name in other and name not in known:
            raise mark.error(_other_convention(name, "the joints' columns", convention, known))
    columns = fields_of(node, known, "the joints' columns")
    types = columns["type"]
    if isinstance(types, Scalar):
        start = types.mark
        kinds: list[Node] = [
            Scalar(letter, Mark(start.file, start.line, start.column + i + types.quoted))
            for i, letter in enumerate(types.text)
            if not letter.isspace()
        ]
    else:
        kinds = list_of(types, "the joints' types")
    rows: list[Node] = []
    for i, kind in enumerate(kinds):
        row = Mapping({"type": kind}, kind.mark, {"type": node.keys["type"]})
        for name, column in columns.items():
            if name == "type":
                continue
            cells = list_of(column, f"the column {name}")
            if len(cells) != len(kinds):
                raise column.mark.error(
                    f"found {len(cells)} values in the column {name}, expected {len(kinds)}: one for each type"
                )
            if not _left_out(cells[i], name, _row_type(kind)):
                row.entries[name] = cells[i]
                row.keys[name] = cells[i].mark
        rows.append(row)
    return rows


def _left_out(cell: Node, column: str, kind: JointType) -> bool:
    """Whether a column's cell says nothing: it is empty, or 0 where the row form has no cell.

    A column has a cell for every row, so also for the ones that the row form would leave out: theta of
    a revolute and d of a prismatic row, where the variable stands, and the offset of a fixed one.
    """
    if not isinstance(cell, Scalar):
        return False
    none_due = column == ("offset" if kind is JointType.FIXED else VARIABLE[kind])
    return cell.empty or (none_due and ZERO.fullmatch(cell.text.strip()) is not None)


def _row_type(node: Node) -> JointType:
    if isinstance(node, Scalar) and node.text.upper() in TYPE_LETTERS:
        return JointType(TYPE_LETTERS[node.text.upper()])
    return JointType(choice_of(node, ROW_TYPES, "the type"))


def _row(cells: MappingType[str, Node], mark: Mark, i: int, convention: str, context: Context) -> Joint:
    """One row of the table."""
    kind = _row_type(cells["type"])
    where = f"of row {i}"
    variable = VARIABLE.get(kind, "")
    if variable in cells and convention != "frames":
        raise cells[variable].mark.error(
            f"found '{variable}' on a {kind} row (row {i}), where the joint variable stands: "
            f"expected 'offset' for a constant shift, {variable} = q + offset"
        )
    if kind is JointType.FIXED:
        for name in ("offset", "limits"):
            if name in cells:
                raise cells[name].mark.error(
                    f"found '{name}' on a fixed row (row {i}), expected none: it has no variable"
                )
    turns = kind is JointType.REVOLUTE

    def number(name: str, angle: bool) -> float:
        return number_of(cells[name], context, f"{name} {where}", angle=angle) if name in cells else 0.0

    limits = (-np.inf, np.inf)
    if "limits" in cells:
        limits = _limits(cells["limits"], turns, where, context)
    origin = axis = None
    if convention == "frames":
        origin = transform_of(cells["origin"], context, f"origin {where}") if "origin" in cells else np.eye(4)
        axis = _axis(cells["axis"], where, context) if "axis" in cells else np.array([0.0, 0.0, 1.0])
    return Joint(
        name=text_of(cells["name"], f"the name {where}") if "name" in cells else str(i),
        type=kind,
        theta=number("theta", True),
        d=number("d", False),
        a=number("a", False),
        alpha=number("alpha", True),
        offset=number("offset", turns),
        limits=limits,
        origin=origin,
        axis=axis,
        texts=_texts(cells, context),
    )


def _texts(cells: MappingType[str, Node], context: Context) -> tuple[tuple[str, str], ...]:
    """The cells that name parameters, as they are written."""
    if "origin" in cells:
        return parameters_in_position(cells["origin"], context)
    named = ((name, parameters_in(cells[name], context)) for name in NUMBERS if name in cells)
    return tuple((name, text) for name, text in named if text)


def _limits(node: Node, angle: bool, where: str, context: Context) -> tuple[float, float]:
    low, high = (
        number_of(item, context, f"limits {where}", angle=angle)
        for item in list_of(node, f"limits {where}: [min, max]", 2)
    )
    if low > high:
        raise node.mark.error(f"found min above max in the limits {where}, expected [min, max]")
    return low, high


def _axis(node: Node, where: str, context: Context) -> Array:
    if isinstance(node, Scalar):
        letter = node.text.strip().lower().rstrip(PRIMES)
        if letter not in ("x", "y", "z"):
            raise node.mark.error(f"found {describe(node)} as the axis {where}, expected x, y, z or [x, y, z]")
        return np.array([float(letter == name) for name in "xyz"])
    if not isinstance(node, Sequence) or len(node.items) != 3:
        raise node.mark.error(f"found {describe(node)} as the axis {where}, expected x, y, z or [x, y, z]")
    return vector_of(node, context, f"the axis {where}", direction=True)


def _poses(node: Node, joints: list[Joint], context: Context) -> dict[str, Array]:
    if not isinstance(node, Mapping):
        raise node.mark.error(f"found {describe(node)}, expected poses: a mapping of names to lists of joint values")
    poses: dict[str, Array] = {}
    for name, values in node.entries.items():
        if not name.replace("-", "_").isidentifier():
            raise node.keys[name].error(f"found the pose '{shown(name)}', expected a name of letters, digits, - and _")
        what = f"the pose {shown(name)}"
        items = list_of(values, what)
        if len(items) != len(joints):
            raise values.mark.error(
                f"found {len(items)} values in the pose {shown(name)}, expected {len(joints)}: one for each joint"
            )
        poses[name] = np.array(
            [
                number_of(item, context, what, angle=joint.type is JointType.REVOLUTE)
                for item, joint in zip(items, joints, strict=True)
            ]
        )
    return poses
