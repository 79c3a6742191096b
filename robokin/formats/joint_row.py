"""One row of a robot's table to a joint."""

from __future__ import annotations

from collections.abc import Mapping as MappingType
from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.errors import ExpressionError
from robokin.formats.joint_variables import VariableCell, other_variable, own_names, shift_of
from robokin.formats.node_values import (
    Context,
    choice_of,
    list_of,
    number_of,
    parameters_in,
    parameters_in_position,
    raw_number_of,
    text_of,
    transform_of,
    vector_of,
)
from robokin.formats.schema import ROW_TYPES, TYPE_LETTERS
from robokin.formats.transform_expressions import PRIMES
from robokin.formats.yaml_tree import Node, Scalar, Sequence, describe
from robokin.model import Joint, JointType

VARIABLE = {JointType.REVOLUTE: "theta", JointType.PRISMATIC: "d"}
"""The cell that the joint variable stands in."""

NUMBERS = ("theta", "d", "a", "alpha", "offset")
"""The cells of a row that hold one number."""


@dataclass(frozen=True)
class RowPlace:
    """Where a row stands: its number and that of its joint (from 1), and of how many joints.

    convention: as the file states it, "" where that is wrong; counted: whether the joint's number is known.
    """

    row: int
    joint: int
    joints: int
    convention: str
    counted: bool


def row_type(node: Node) -> JointType:
    """The type of a row, by its name or its letter; a helical one is a revolute one with a pitch."""
    name = _type_name(node)
    return JointType.REVOLUTE if name == "helical" else JointType(name)


def _type_name(node: Node) -> str:
    if isinstance(node, Scalar) and node.text.upper() in TYPE_LETTERS:
        return TYPE_LETTERS[node.text.upper()]
    return choice_of(node, ROW_TYPES, "the type")


def row_of(cells: MappingType[str, Node], place: RowPlace, convention: str, context: Context) -> Joint:
    """One row of the table; its mistakes are gathered."""
    attempt = context.faults.attempt
    before = context.faults.count
    where = f"of row {place.row}"
    name = str(place.row)
    if "name" in cells:
        name = attempt(name, text_of, cells["name"], f"the name {where}")
    kind = attempt(None, row_type, cells["type"])
    cells = dict(cells)
    shift = VariableCell(1, "")
    variable = "" if kind is None or convention in ("frames", "screws") else VARIABLE.get(kind, "")
    if kind is None:  # which of the cells hold the variable, and what limits are, is not known
        for cell in ("theta", "d", "offset", "limits", "sense", "motion_limits", "pitch"):
            cells.pop(cell, None)
    if variable in cells:
        shift = attempt(shift, _shift, cells, variable, name, place, context)
        del cells[variable]
    if kind is JointType.FIXED:
        _without_variable(cells, place, convention, context)
    turns = kind is JointType.REVOLUTE

    def number(cell: str, angle: bool) -> float:
        if cell not in cells:
            return 0.0
        return attempt(0.0, number_of, cells[cell], context, f"{cell} {where}", angle=angle)

    limits = motion_limits = (-np.inf, np.inf)
    if "limits" in cells:
        limits = attempt(limits, limits_of, cells["limits"], turns, where, context)
    if "motion_limits" in cells:
        motion_limits = attempt(
            motion_limits, limits_of, cells["motion_limits"], turns, f"of the motion {where}", context
        )
    pitch = attempt(0.0, _pitch, cells, where, context) if kind is not None else 0.0
    origin, axis = _placing(cells, where, convention, context)
    sense = attempt(1, sense_of, cells["sense"], where, context) if "sense" in cells else 1
    angles = (True, False, False, True, turns)
    numbers = {cell: number(cell, angle) for cell, angle in zip(NUMBERS, angles, strict=True)}
    return Joint(
        name=name,
        type=kind or JointType.FIXED,
        **numbers,
        limits=limits,
        origin=origin,
        axis=axis,
        texts=() if context.faults.count > before else _texts(cells, context),
        sense=sense * shift.sense,
        pitch=pitch,
        motion_limits=motion_limits,
    )


def _without_variable(cells: dict[str, Node], place: RowPlace, convention: str, context: Context) -> None:
    """Gather the mistakes of a fixed row, and take out the cells that only a joint has."""
    if convention == "screws":
        context.faults.add(
            cells["type"].mark.error(
                f"found a fixed row (row {place.row}) of screws, expected revolute or prismatic: what does not move is "
                "in 'home'"
            )
        )
        return
    for cell in ("offset", "limits", "sense", "motion_limits", "pitch"):
        if cell in cells:
            context.faults.add(
                cells.pop(cell).mark.error(
                    f"found '{cell}' on a fixed row (row {place.row}), expected none: it has no variable"
                )
            )


def _pitch(cells: MappingType[str, Node], where: str, context: Context) -> float:
    """What a helical row advances [m/rad], 0 of another. Raises DescriptionError for one of both without the other."""
    helical = _type_name(cells["type"]) == "helical"
    if "pitch" not in cells:
        if helical:
            raise cells["type"].mark.error(
                f"found no 'pitch' {where}, expected what a helical row advances in one turn"
            )
        return 0.0
    if not helical:
        raise cells["pitch"].mark.error(f"found 'pitch' {where}, expected it on a helical row alone")
    pitch = number_of(cells["pitch"], context, f"pitch {where}", angle=False)
    if pitch == 0.0:
        raise cells["pitch"].mark.error(f"found the pitch 0 {where}, expected an advance, or a revolute row")
    return pitch / (2.0 * np.pi)


def _placing(
    cells: MappingType[str, Node], where: str, convention: str, context: Context
) -> tuple[Array | None, Array | None]:
    """The origin (4, 4) and the axis (3,) of a row that has them; of screws in the base's frame."""
    if convention not in ("frames", "screws"):
        return None, None
    origin, axis = np.eye(4), np.array([0.0, 0.0, 1.0])
    if "origin" in cells:
        origin = context.faults.attempt(origin, transform_of, cells["origin"], context, f"origin {where}")
    if "at" in cells:
        origin[:3, 3] = context.faults.attempt(
            np.zeros(3), vector_of, cells["at"], context, f"at {where}", direction=False
        )
    if "axis" in cells:
        axis = context.faults.attempt(axis, _axis, cells["axis"], where, context)
    return origin, axis


def _shift(cells: dict[str, Node], variable: str, name: str, place: RowPlace, context: Context) -> VariableCell:
    """What the variable's own cell says; its constant becomes the row's offset."""
    node = cells[variable]
    own = own_names(variable, place.joint, name) if place.counted else ()
    where = f"{variable} of row {place.row}"
    shift = other = None
    if isinstance(node, Scalar) and not node.empty:
        if not place.counted:
            raise node.mark.silent().error(f"{where}: the number of its joint is not known")
        try:
            shift = shift_of(node.text, own, context.scope)
            other = other_variable(node.text, own, variable, place.joints, context.scope)
        except ExpressionError as error:
            raise node.mark.error(f"{where}: {error}") from None
    if other is not None:
        raise node.mark.error(f"{where}: {other}")
    if shift is None:
        raise node.mark.error(
            f"found {describe(node)} as {where}, where the joint variable stands: expected the variable "
            f"(`{variable}: q + c`), or no {variable} and a constant shift as 'offset' ({variable} = q + offset)"
        )
    for cell, stated in (("offset", shift.constant), ("sense", shift.sense < 0)):
        if cell in cells and stated:
            what = "a constant" if cell == "offset" else "a minus"
            raise cells[cell].mark.error(f"found '{cell}' and {what} in {where}, expected one of them")
    if shift.constant:
        assert isinstance(node, Scalar)
        cells["offset"] = Scalar(shift.constant, node.mark, node.quoted)
    return shift


def sense_of(node: Node, where: str, context: Context) -> int:
    """A sense, 1 or -1. Raises DescriptionError."""
    number = raw_number_of(node, context.scope, f"sense {where}")
    if number not in (1.0, -1.0):
        raise node.mark.error(f"found {describe(node)} as sense {where}, expected 1 or -1")
    return int(number)


def _texts(cells: MappingType[str, Node], context: Context) -> tuple[tuple[str, str], ...]:
    """The cells that name parameters, as they are written."""
    if "origin" in cells:
        return parameters_in_position(cells["origin"], context)
    numbers = {name: cells[name] for name in NUMBERS if name in cells}
    if isinstance(at := cells.get("at"), Sequence):
        numbers |= zip("xyz", at.items, strict=True)
    named = ((name, parameters_in(node, context)) for name, node in numbers.items())
    return tuple((name, text) for name, text in named if text)


def limits_of(node: Node, angle: bool, where: str, context: Context) -> tuple[float, float]:
    """The least and the greatest value [rad | m] that a list of two says. Raises DescriptionError."""
    low, high = context.faults.each(
        lambda item: number_of(item, context, f"limits {where}", angle=angle),
        list_of(node, f"limits {where}: [min, max]", 2),
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
