"""The names of everything that stands in the matrices, and what each name means.

An angle is called by the number of its joint: `c2` is cos(q2), `s23` is sin(q2 + q3). That number is
the one in the joint's name when every joint's name has one (theta4, theta5, theta6 give c4, c5, c6).
A length goes by the name of its parameter, or where the table has a number by its column and row:
`a2`, `d4`; a modified row i holds a of i - 1, as J. J. Craig numbers it.
"""

from __future__ import annotations

import keyword
import math
import re
from collections.abc import Mapping

from robokin.derivation.angle_sums import Angle, NamedAngle, Trigonometry
from robokin.derivation.symbol_sums import LEAD, TRAIL, ZERO, Sum, number, symbol, times, total
from robokin.derivation.symbolic_cells import linear_of, names_in
from robokin.derivation.written_sums import written
from robokin.model import Joint, Robot
from robokin.spatial.rotations import cos_sin
from robokin.units import Units

NUMBERED = re.compile(r"[^\W\d]+[ _-]?(\d+)")
"""A joint's name that ends in a number, such as theta4 or joint_4."""

OURS = re.compile(r"[cs]m?[atfbo]?\d[\dm_fto]*|q\d+|(theta|alpha)\w*|q|T|np|forward_kinematics")
"""Names that a matrix or the Python form uses for something else than a parameter."""

ALONG = "zd"
"""Lengths along an axis: they follow the cosines and sines, `c2*d3`; those across it lead, `a2*c2`."""


class Names:
    """Gives names to the cells of a robot's table and remembers what they mean, in the given units.

    `values` has the numbers, `definitions` the sums of variables and numbers, `notes` the formulas
    that were too long for a matrix. With `numbers` the lengths and twists are numbers themselves.
    """

    def __init__(self, robot: Robot, units: Units, numbers: bool) -> None:
        self.robot = robot
        self.units = units
        self.numbers = numbers
        self.values: dict[str, float] = {}
        self.definitions: dict[str, str] = {}
        self.notes: dict[str, str] = {}
        self.labels = labels_of(robot)
        self.trigonometry = Trigonometry(any(len(label) > 1 for label in self.labels))
        self.variables = {id(joint): f"q{i}" for i, joint in enumerate(robot.joints, start=1)}
        texts = [text for row in robot.rows for _, text in row.texts] + [text for _, text in robot.texts]
        self.named = set[str]().union(*(names_in(text, robot.parameters) for text in texts))

    def before(self, i: int) -> str:
        """The label of the row before row i: the one that a modified row's a and alpha belong to."""
        return self.labels[i - 1] if i else "0" if "0" not in self.labels else "b"

    def length(self, value: float, letter: str, label: str, row: int, text: str = "") -> Sum:
        """A length [m] by its parameters or its letter; `row` is its place along the chain."""
        if not value and not text:
            return ZERO
        if self.numbers:
            return number(in_unit(value, self.units.metres))
        across = letter[-1] not in ALONG
        # A product of poses is read from its end: its lecture prints l3*s12 + l2*s1.
        place = (LEAD, -row if self.robot.convention == "frames" else row) if across else (TRAIL, row)
        formula = self._formula(text, value, self.robot.units.metres, self.units.metres, place)
        if formula is not None:
            return formula
        name = self._free(letter + label)
        self.values[name] = in_unit(value, self.units.metres)
        if text:
            self.notes[name] = " ".join(text.split())
        return symbol(name, *place)

    def variable(self, joint: Joint, i: int) -> Sum:
        """The variable of a prismatic row, its offset in it: d = q + offset."""
        q = self.variables[id(joint)]
        name = "d" + self.labels[i]
        text = self._shifted(q, joint, self.robot.units.metres, self.units.metres)
        if text == q and name in self.named:
            return symbol(q, TRAIL, i + 1)
        name = self._free(name)
        self.definitions[name] = text
        return symbol(name, TRAIL, i + 1)

    def turn(self, joint: Joint, i: int) -> Angle:
        """The angle of a revolute row. An offset of whole quarter turns changes signs, another is added to q.

        So is one to a variable that enters with the other sign.
        """
        part = self.variables[id(joint)]
        quarters = quarters_of(joint.offset) if joint.sense > 0 else None
        if quarters is None:
            quarters, q, part = 0, part, f"theta{self.labels[i]}"
            self.definitions[part] = self._shifted(q, joint, self.robot.units.radians, self.units.radians)
        return Angle(quarters, ((NamedAngle(i + 1, self.labels[i], part), 1),))

    def constant_turn(self, value: float, i: int, text: str = "") -> Angle:
        """A constant angle [rad] about z in row i, -1 for the base, the number of rows for the tool."""
        quarters = quarters_of(value)
        if quarters is not None:
            return Angle(quarters)
        if i < 0:
            label = self.before(0)
        elif i == len(self.labels):
            label = "t"
        else:
            # The joint of a row of frames has the row's own label.
            label = ("o" if self.robot.convention == "frames" else "") + self.labels[i]
        self.trigonometry.spaced |= len(label) > 1
        return Angle(0, ((NamedAngle(i + 1, label, self._constant(f"theta{label}", value, text)), 1),))

    def twist(self, value: float, label: str, i: int, text: str) -> tuple[Sum, Sum]:
        """Cosine and sine of a constant angle [rad] about x."""
        c, s = (float(part) for part in cos_sin(value))
        if self.numbers or quarters_of(value) is not None:
            return number(c), number(s)
        part = NamedAngle(i + 1, f"a{label}", self._constant(f"alpha{label}", value, text), 1)
        angle = Angle(0, ((part, 1),))
        return self.trigonometry.cos(angle), self.trigonometry.sin(angle)

    def _constant(self, name: str, value: float, text: str) -> str:
        formula = self._formula(text, value, self.robot.units.radians, self.units.radians, (LEAD, 0))
        if formula is None:
            self.values[name] = in_unit(value, self.units.radians)
            if text:
                self.notes[name] = " ".join(text.split())
        else:
            self.definitions[name] = written(formula)
        return name

    def _shifted(self, q: str, joint: Joint, own: float, unit: float) -> str:
        """`q + offset`, written; `offset - q` for the other sense."""
        text = dict(joint.texts).get("offset", "")
        formula = self._formula(text, joint.offset, own, unit, (LEAD, 1))
        constant = number(in_unit(joint.offset, unit)) if formula is None else formula
        return written(total((times(number(float(joint.sense)), symbol(q, LEAD, 0)), constant)))

    def _formula(self, text: str, value: float, own: float, unit: float, place: tuple[int, ...]) -> Sum | None:
        """A cell's text in its parameters' names, each worth its value in the unit; None if it is not linear."""
        form = linear_of(text, value / own, self.robot.parameters) if text else None
        if form is None:
            return None
        parts = [number(in_unit(form.pop("", 0.0) * own, unit))]
        for name, coefficient in form.items():
            # A parameter has no dimension; here it stands for a length or an angle of the file's unit.
            worth = in_unit(self.robot.parameters[name] * own, unit)
            called = name + "_" if OURS.fullmatch(name) or keyword.iskeyword(name) else name
            if self.values.setdefault(called, worth) != worth:
                return None
            parts.append(times(number(coefficient), symbol(called, *place)))
        return total(parts)

    def _free(self, name: str) -> str:
        """The name, or the name with _ as often as it is taken."""
        while name in self.named or name in self.values or name in self.definitions:
            name += "_"
        return name


def quarters_of(angle: float) -> int | None:
    """The quarter turns that an angle [rad] is, 0 to 3; None when it is none."""
    c, s = (float(part) for part in cos_sin(angle))
    return {(1.0, 0.0): 0, (0.0, 1.0): 1, (-1.0, 0.0): 2, (0.0, -1.0): 3}.get((c, s))


def in_unit(value: float, unit: float) -> float:
    """An SI value in a unit, without the last digit's dust that the division leaves."""
    scaled = float(value) / unit
    short = float(f"{scaled:.12g}")
    return short if abs(scaled - short) <= 4.0 * math.ulp(scaled) else scaled


def labels_of(robot: Robot) -> tuple[str, ...]:
    """The number that each row goes by: a joint its own, a fixed row its row's, with an f where that is taken."""
    joints = _numbers_in_names(robot) or {id(joint): str(i) for i, joint in enumerate(robot.joints, start=1)}
    taken = set(joints.values())
    rows = [str(i) for i in range(1, len(robot.rows) + 1)]
    return tuple(
        joints.get(id(row), own if own not in taken else f"f{own}") for row, own in zip(robot.rows, rows, strict=True)
    )


def _numbers_in_names(robot: Robot) -> Mapping[int, str] | None:
    found = [NUMBERED.fullmatch(joint.name) for joint in robot.joints]
    numbers = [match[1] for match in found if match]
    if len(numbers) < robot.n or len(set(numbers)) < robot.n:
        return None
    return {id(joint): label for joint, label in zip(robot.joints, numbers, strict=True)}
