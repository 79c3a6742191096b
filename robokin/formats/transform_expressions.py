"""Transform expressions: one grammar for YAML cells, `robokin frame` and the targets of `robokin ik`.

    expression = { step }        a space or * between steps; they multiply from left to right

with the steps of `STEPS`; case does not matter. An empty expression is the identity. A primed axis
(`y'`) reads as the axis itself, since steps multiply on the right. Lengths and angles are in the units
of the place where the expression stands; the result is in metres.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from robokin.arrays import Array
from robokin.errors import ExpressionError, did_you_mean, shown
from robokin.formats.number_expressions import MAX_NESTING, Parser, Scope, names_parameters
from robokin.formats.printed_matrices import ROUNDING, pose_from_matrix
from robokin.spatial import (
    invert,
    rotation_from_euler,
    rotation_from_quaternion,
    rotation_from_rotation_vector,
    rotation_from_rpy,
    rotation_from_sequence,
    rotation_transform,
    transform,
    translation_transform,
)
from robokin.spatial.dh import modified_dh, standard_dh
from robokin.spatial.rotations import DIGITS_LOST, ZERO_AXIS
from robokin.units import Units

STEPS = {
    "trans": "Trans(x, y, z)",
    "rot": "Rot(x|y|z, angle) or Rot([x, y, z], angle)",
    "rpy": "RPY(roll, pitch, yaw)",
    "euler": "Euler(phi, theta, psi) or Euler(xyz, a, b, c)",
    "oat": "OAT(o, a, t)",
    "abc": "ABC(a, b, c)",
    "wpr": "WPR(w, p, r)",
    "rotvec": "RotVec(x, y, z)",
    "quat": "Quat(w, x, y, z)",
    "quatxyzw": "QuatXYZW(x, y, z, w)",
    "dh": "DH(theta, d, a, alpha)",
    "mdh": "MDH(alpha, a, theta, d)",
    "inv": "Inv(…)",
    "matrix": "Matrix([[…], […], […], […]])",
}
"""The steps by their name in lower case, with how they are written."""

SEQUENCES = tuple(a + b + c for a in "xyz" for b in "xyz" for c in "xyz" if a != b and b != c)
"""The twelve orders of axes of Euler angles; in upper case about fixed axes."""

PRIMES = "'′’"
"""What may follow the letter of an axis, as often as a lecture writes it: Rot(z'', 90)."""

Kind = Literal["length", "angle", "ratio"]


@dataclass
class Reader:
    """Reads one transform expression; `notes` collects what the user should know of it.

    `shifts` are its translations: a direction (3,) in the first frame and the text of how far, or "" where
    the direction itself is the translation [m]. `measures` are its lengths and angles: text, value in the units at
    hand, whether it is an angle.
    """

    text: str
    scope: Scope
    units: Units
    notes: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.parser = Parser(self.text, self.scope)
        self.shifts: list[tuple[Array, str]] = []
        self.arguments: list[str] = []
        self.measures: list[tuple[str, float, bool]] = []

    def whole(self) -> Array:
        """The transform (4, 4) of the whole text [m]."""
        with np.errstate(all="ignore"):  # what overflows is refused below
            T = self.steps()
        if self.parser.token.kind != "end":
            raise self.parser.error(
                f"found {self.parser.found()}, expected a step such as {STEPS['trans']}, or the end"
            )
        if not np.all(np.isfinite(T)):
            raise ExpressionError("found a result that is too large, expected finite numbers", self.text)
        return T

    def steps(self) -> Array:
        """The product of the steps up to a closing parenthesis or the end."""
        T = np.eye(4)
        parser = self.parser
        parser.depth += 1
        if parser.depth > MAX_NESTING:
            raise parser.error(f"found more than {MAX_NESTING} levels of nesting, expected a plain product of steps")
        while parser.token.kind == "name":
            name = parser.token.text.lower()
            step = self.step()
            if parser.depth == 1:  # what is inside Inv(…) counts as a whole
                if name == "trans":
                    self.shifts += zip(T[:3, :3].T, self.arguments, strict=True)
                else:
                    self.shifts.append((T[:3, :3] @ step[:3, 3], ""))
            T = T @ step
            if parser.token.text == "*":
                parser.accept("*")
                if parser.token.kind != "name":
                    raise parser.error(f"found {parser.found()} after '*', expected a step")
        parser.depth -= 1
        return T

    def step(self) -> Array:
        """One step: a name and its arguments."""
        parser = self.parser
        token = parser.token
        name = token.text.lower()
        if name not in STEPS:
            hint = did_you_mean(token.text, [form.split("(")[0] for form in STEPS.values()])
            forms = ", ".join(form.split("(")[0] for form in STEPS.values())
            raise parser.error(f"found the unknown step '{shown(token.text)}'{hint or f', expected one of {forms}'}")
        parser.index += 1
        if not parser.accept("("):
            raise parser.error(f"found {parser.found()} after '{token.text}', expected {STEPS[name]}")
        try:
            T: Array = getattr(self, f"_{name}")()
        except ValueError as error:
            if isinstance(error, ExpressionError):
                raise
            raise parser.error(f"{error}: expected {STEPS[name]}", token) from None
        if not parser.accept(")"):
            raise parser.error(f"found {parser.found()}, expected ')' to end {STEPS[name]}")
        return T

    def _numbers(self, form: str, *kinds: Kind) -> list[float]:
        """As many numbers as kinds, separated by commas, in metres and radians."""
        values = []
        self.arguments = []
        for i, kind in enumerate(kinds):
            if i and not self.parser.accept(","):
                raise self.parser.error(
                    f"found {self.parser.found()} after {i} of {len(kinds)} arguments, expected {STEPS[form]}"
                )
            start = self.parser.token.position
            values.append(self._number(kind))
            self.arguments.append(self.text[start : self.parser.token.position].strip())
        return values

    def _number(self, kind: Kind) -> float:
        start = self.parser.token.position
        value = self.parser.angle() if kind == "angle" else self.parser.number().number
        if kind == "ratio":
            return value
        self.measures.append((self.text[start : self.parser.token.position].strip(), value, kind == "angle"))
        return value * (self.units.radians if kind == "angle" else self.units.metres)

    def _trans(self) -> Array:
        return translation_transform(self._numbers("trans", "length", "length", "length"))

    def _rot(self) -> Array:
        parser = self.parser
        axis = self._axis()
        if not parser.accept(","):
            raise parser.error(f"found {parser.found()} after the axis, expected {STEPS['rot']}")
        return rotation_transform(axis, self._number("angle"))

    def _axis(self) -> list[float]:
        parser = self.parser
        letter = parser.token.text.lower().rstrip(PRIMES)
        if parser.token.kind == "name" and letter in ("x", "y", "z"):
            parser.index += 1
            return [float(letter == name) for name in "xyz"]
        start = parser.token
        if not parser.accept("["):
            raise parser.error(f"found {parser.found()} as the axis, expected x, y, z or [x, y, z]")
        axis = self._numbers("rot", "ratio", "ratio", "ratio")
        parser.expect("]")
        greatest = max(abs(part) for part in axis)
        if greatest < ZERO_AXIS:
            raise parser.error("found zero as the axis, expected a direction", start)
        return [part / greatest for part in axis]  # the squares of great numbers would not be finite

    def _turned(self, R: Array) -> Array:
        return transform(R, np.zeros(3))

    def _angles(self, form: str) -> list[float]:
        return self._numbers(form, "angle", "angle", "angle")

    def _rpy(self) -> Array:
        return self._turned(rotation_from_rpy(self._angles("rpy")))

    def _wpr(self) -> Array:
        return self._turned(rotation_from_rpy(self._angles("wpr")))

    def _abc(self) -> Array:
        return self._turned(rotation_from_rpy(self._angles("abc")[::-1]))

    def _oat(self) -> Array:
        return self._turned(rotation_from_euler(self._angles("oat")))

    def _rotvec(self) -> Array:
        return self._turned(rotation_from_rotation_vector(self._angles("rotvec")))

    def _euler(self) -> Array:
        parser = self.parser
        order = parser.token.text
        if order.lower() not in SEQUENCES or order in self.scope.names:
            return self._turned(rotation_from_euler(self._angles("euler")))
        if not (order.islower() or order.isupper()):
            raise parser.error(
                f"found the axes '{order}', expected lower case (about moving axes) or upper case (about fixed axes)"
            )
        parser.index += 1
        if not parser.accept(","):
            raise parser.error(f"found {parser.found()} after the axes, expected {STEPS['euler']}")
        return self._turned(rotation_from_sequence(order, self._angles("euler")))

    def _quat(self, form: str = "quat") -> Array:
        token = self.parser.token
        q = self._numbers(form, "ratio", "ratio", "ratio", "ratio")
        length = math.hypot(*q)
        if abs(length - 1.0) > DIGITS_LOST:
            raise self.parser.error(f"found a quaternion of length {length:.6g}, expected 1", token)
        if abs(length - 1.0) > ROUNDING:
            self.notes.append(f"the quaternion's length is {length:.9g}; it is taken as 1")
        return self._turned(rotation_from_quaternion(q if form == "quat" else [q[3], *q[:3]]))

    def _quatxyzw(self) -> Array:
        return self._quat("quatxyzw")

    def _dh(self) -> Array:
        theta, d, a, alpha = self._numbers("dh", "angle", "length", "length", "angle")
        return standard_dh(theta, d, a, alpha)

    def _mdh(self) -> Array:
        alpha, a, theta, d = self._numbers("mdh", "angle", "length", "angle", "length")
        return modified_dh(alpha, a, theta, d)

    def _inv(self) -> Array:
        return invert(self.steps())

    def _matrix(self) -> Array:
        parser = self.parser
        start = parser.token
        rows: list[list[float]] = []
        parser.expect("[")
        while not rows or parser.accept(","):
            parser.expect("[")
            row = [parser.number().number]
            while parser.accept(","):
                row.append(parser.number().number)
            parser.expect("]")
            rows.append(row)
        parser.expect("]")
        try:
            T, note = pose_from_matrix(rows, self.units)
        except ValueError as error:
            raise parser.error(str(error), start) from None
        if note:
            self.notes.append(note)
        self.measures += [("", row[3], False) for row in rows[:3]]
        return T


def evaluate_transform(text: str, scope: Scope, units: Units, notes: list[str] | None = None) -> Array:
    """The transform (4, 4) [m] that an expression describes. Raises ExpressionError.

    `notes` takes sentences that the user should see, such as that a printed matrix was made a rotation.
    """
    reader = Reader(text, scope, units, [] if notes is None else notes)
    return reader.whole()


def position_texts(text: str, scope: Scope, units: Units) -> tuple[tuple[str, str], ...]:
    """The coordinates of a transform's position that name parameters, as expressions in the file's units.

    `Rot(z, 90) Trans(l1, 0, 2)` gives `(("y", "l1"),)`. Raises ExpressionError.
    """
    reader = Reader(text, scope, units)
    reader.whole()
    named = [(line, far, names_parameters(far, scope)) for line, far in reader.shifts]
    found = []
    for i, axis in enumerate("xyz"):
        parts = [(part, names) for line, far, names in named if (part := _part(line[i], far, units))]
        if any(names for _, names in parts):
            found.append((axis, " + ".join(part for part, _ in parts)))
    return tuple(found)


def _part(direction: float, how_far: str, units: Units) -> str:
    """A coordinate of a translation; "" for none."""
    if abs(direction) < ROUNDING or (how_far and not how_far.strip("+-0. ")):
        return ""
    if not how_far:
        return repr(float(direction / units.metres))
    return how_far if direction == 1.0 else f"{float(direction)!r}*({how_far})"
