"""The matrices of a robot in symbols: one for each row of its table, and their product."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.brief import Brief
from robokin.derivation.angle_sums import Function
from robokin.derivation.coupled_names import CoupledNames
from robokin.derivation.symbol_names import Names, quarters_of
from robokin.derivation.symbol_sums import ONE, ZERO, negative, symbols_of
from robokin.derivation.symbolic_product import EXACT, Element, Matrix, SymbolicShift, Tilt, Turn, Vector, product, tilt
from robokin.model import CoupledRobot, Joint, JointType, Robot
from robokin.spatial import z_to
from robokin.spatial.rotations import cos_sin
from robokin.units import Units


@dataclass(frozen=True, repr=False)
class SymbolicKinematics(Brief):
    """T = A1 A2 … An, each a matrix (4, 4) of sums, and what their symbols mean.

    `values` are numbers in the units, `definitions` sums of joint values q1, q2, … and numbers, and
    `functions` the cosines and sines. `notes` are the formulas that a value comes from.
    """

    matrices: Mapping[str, Matrix]
    frames: Mapping[str, Matrix]
    T: Matrix
    values: Mapping[str, float]
    definitions: Mapping[str, str]
    functions: Mapping[str, Function]
    notes: Mapping[str, str]


def symbolic_kinematics(
    robot: Robot, units: Units | None = None, *, numbers: bool = False, frames: bool = False
) -> SymbolicKinematics:
    """The matrices of a robot in symbols, lengths and angles in the units, by default the robot's own.

    `numbers` writes lengths and twists as numbers; `frames` adds the frame after each row, in the world.
    """
    names: Names
    if isinstance(robot, CoupledRobot):
        names = CoupledNames(robot, units or robot.units, numbers)
    else:
        names = Names(robot, units or robot.units, numbers)
    parts: dict[str, list[Element]] = {}
    if not np.array_equal(robot.base, np.eye(4)):
        parts["base"] = _pose(robot.base, _texts(robot.texts, "base "), "0", -1, names)
    labels = names.labels
    for i, row in enumerate(names.robot.rows):
        # A helical joint is a turn and a slide, in one matrix.
        parts.setdefault(f"A{labels[i]}", []).extend(_row(robot, row, i, names))
    rows = [name for name in parts if name != "base"]
    if not np.array_equal(robot.tool, np.eye(4)):
        parts["tool"] = _pose(robot.tool, _texts(robot.texts, "tool "), "t", len(labels), names)
    matrices = {name: product(elements, names.trigonometry) for name, elements in parts.items()}
    elements = [element for part in parts.values() for element in part]
    T = product(elements, names.trigonometry)
    products: dict[str, Matrix] = {}
    if frames:
        chain = list(parts.get("base", []))
        for name in rows:
            chain += parts[name]
            products[f"T_0_{name[1:]}"] = product(chain, names.trigonometry)
    return _used(matrices, products, T, names)


def _row(robot: Robot, row: Joint, i: int, names: Names) -> list[Element]:
    """One row of the table as turns about z, shifts and constant rotations."""
    texts = dict(row.texts)
    if robot.convention == "frames":
        return [*_pose(row.origin, texts, names.labels[i], i, names), *_motion(row, i, names)]
    modified = robot.convention == "modified"
    label = names.before(i) if modified else names.labels[i]
    a = SymbolicShift((names.length(row.a, "a", label, i + 1, texts.get("a", "")), ZERO, ZERO))
    twist = _twist(row.alpha, label, i, texts.get("alpha", ""), names)
    if row.type is JointType.REVOLUTE:
        angle = names.turn(row, i)
    else:
        angle = names.constant_turn(row.theta, i, texts.get("theta", ""))
    if row.type is JointType.PRISMATIC:
        d = names.variable(row, i)
    else:
        d = names.length(row.d, "d", names.labels[i], i + 1, texts.get("d", ""))
    along: list[Element] = [Turn(angle), SymbolicShift((ZERO, ZERO, d))]
    return [twist, a, *along] if modified else [*along, a, twist]


def _motion(row: Joint, i: int, names: Names) -> list[Element]:
    """The motion of a row about or along its axis."""
    if not row.moves:
        return []
    to_axis = z_to([0.0, 0.0, 1.0] if row.axis is None else row.axis)[:3, :3]
    turns = row.type is JointType.REVOLUTE
    motion = Turn(names.turn(row, i)) if turns else SymbolicShift((ZERO, ZERO, names.variable(row, i)))
    return [tilt(to_axis.tolist()), motion, tilt(to_axis.T.tolist())]


def _pose(T: Array | None, texts: Mapping[str, str], label: str, i: int, names: Names) -> list[Element]:
    """A constant pose (4, 4) [m]. A rotation about z is a turn; another is in numbers where it is no right angle."""
    if T is None:
        return []
    position = [float(value) for value in T[:3, 3]]
    dust = EXACT * max(map(abs, position))  # what cancelled in a product of steps
    x, y, z = (
        names.length(value if abs(value) > dust else 0.0, letter, label, i + 1, texts.get(letter, ""))
        for letter, value in zip("xyz", position, strict=True)
    )
    shift: Vector = (x, y, z)
    rotation = tilt(T[:3, :3].tolist())
    upright = rotation.values[2][2]
    angle = math.atan2(T[1, 0], T[0, 0])
    if abs(upright) == 1.0 and quarters_of(angle) is None:
        flip = tilt(((1, 0, 0), (0, upright, 0), (0, 0, upright)))
        return [SymbolicShift(shift), Turn(names.constant_turn(angle, i)), flip]
    return [SymbolicShift(shift), rotation]


def _twist(alpha: float, label: str, i: int, text: str, names: Names) -> Tilt:
    """Rot(x, alpha)."""
    c, s = names.twist(alpha, label, i, text)
    value_c, value_s = (float(part) for part in cos_sin(alpha))
    rows = ((ONE, ZERO, ZERO), (ZERO, c, negative(s)), (ZERO, s, c))
    return Tilt(rows, ((1.0, 0.0, 0.0), (0.0, value_c, -value_s), (0.0, value_s, value_c)))


def _texts(texts: tuple[tuple[str, str], ...], prefix: str) -> dict[str, str]:
    return {name.removeprefix(prefix): text for name, text in texts if name.startswith(prefix)}


def _used(matrices: Mapping[str, Matrix], frames: Mapping[str, Matrix], T: Matrix, names: Names) -> SymbolicKinematics:
    """The result, with the meaning of the symbols that stand in it and of no others."""
    every = [*matrices.values(), *frames.values(), T]
    order = [found.name for found in symbols_of(entry for matrix in every for row in matrix for entry in row)]
    functions = {name: names.trigonometry.functions[name] for name in order if name in names.trigonometry.functions}
    words = set(order).union(*(function.argument.split() for function in functions.values()))
    definitions = {name: text for name, text in names.definitions.items() if name in words}
    words = words.union(*(text.replace("*", " ").split() for text in definitions.values()))
    values = {name: value for name, value in names.values.items() if name in words}
    notes = {name: text for name, text in names.notes.items() if name in values}
    return SymbolicKinematics(matrices, frames, T, values, definitions, functions, notes)
