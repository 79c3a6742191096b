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
from numpy.typing import NDArray

from robokin.description.expressions import MAX_NESTING, Parser, Scope, names_parameters
from robokin.errors import ExpressionError, did_you_mean, shown
from robokin.kinematics.dh import modified_dh, standard_dh
from robokin.spatial import (
    invert,
    nearest_rotation,
    rotation_error,
    rotation_from_euler,
    rotation_from_quaternion,
    rotation_from_rpy,
    rotation_transform,
    transform,
    translation_transform,
)
from robokin.spatial.rotations import DIGITS_LOST, ZERO_AXIS
from robokin.units import Units

Array = NDArray[np.float64]

STEPS = {
    "trans": "Trans(x, y, z)",
    "rot": "Rot(x|y|z, angle) or Rot([x, y, z], angle)",
    "rpy": "RPY(roll, pitch, yaw)",
    "euler": "Euler(phi, theta, psi)",
    "quat": "Quat(w, x, y, z)",
    "dh": "DH(theta, d, a, alpha)",
    "mdh": "MDH(alpha, a, theta, d)",
    "inv": "Inv(…)",
    "matrix": "Matrix([[…], […], […], […]])",
}
"""The steps by their name in lower case, with how they are written."""

PRIMES = "'′’"
"""What may follow the letter of an axis, as often as a lecture writes it: Rot(z'', 90)."""

ROUNDING = 1e-12
"""A matrix this near to a rotation is taken as it stands."""

Kind = Literal["length", "angle", "ratio"]


@dataclass
class Reader:
    """Reads one transform expression; `notes` collects what the user should know of it.

    `shifts` are its translations: a direction (3,) in the first frame and the text of how far, or "" where
    the direction itself is the translation [m].
    """

    text: str
    scope: Scope
    units: Units
    notes: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.parser = Parser(self.text, self.scope)
        self.shifts: list[tuple[Array, str]] = []
        self.arguments: list[str] = []

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
        if kind == "angle":
            return self.parser.angle() * self.units.radians
        value = self.parser.number().number
        return value * self.units.metres if kind == "length" else value

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

    def _rpy(self) -> Array:
        return transform(rotation_from_rpy(self._numbers("rpy", "angle", "angle", "angle")), np.zeros(3))

    def _euler(self) -> Array:
        return transform(rotation_from_euler(self._numbers("euler", "angle", "angle", "angle")), np.zeros(3))

    def _quat(self) -> Array:
        token = self.parser.token
        q = self._numbers("quat", "ratio", "ratio", "ratio", "ratio")
        length = math.hypot(*q)
        if abs(length - 1.0) > DIGITS_LOST:
            raise self.parser.error(f"found a quaternion of length {length:.6g}, expected 1", token)
        if abs(length - 1.0) > ROUNDING:
            self.notes.append(f"the quaternion's length is {length:.9g}; it is taken as 1")
        return transform(rotation_from_quaternion(q), np.zeros(3))

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
        return T


def pose_from_matrix(rows: object, units: Units) -> tuple[Array, str]:
    """A pose (4, 4) [m] from a homogeneous matrix in the given length unit, and a note or "".

    Three rows of four are taken too (the last one is 0 0 0 1). A rotation whose digits were cut is made
    a rotation and a note says by how much it was off. Raises ValueError when it is no pose, saying how far off.
    """
    try:
        M = np.array(rows, dtype=np.float64)
    except (TypeError, ValueError):
        raise ValueError("found rows that are not numbers of one count, expected 4 rows of 4 numbers") from None
    if M.shape == (3, 4):
        M = np.vstack([M, [0.0, 0.0, 0.0, 1.0]])
    if M.shape != (4, 4):
        shape = "×".join(str(count) for count in M.shape)
        raise ValueError(f"found a matrix of {shape}, expected 4×4")
    if not np.all(np.isfinite(M)):
        raise ValueError("found a number that is not finite in the matrix, expected finite numbers")
    if np.max(np.abs(M[3] - [0.0, 0.0, 0.0, 1.0])) > ROUNDING:
        raise ValueError(f"found the last row {' '.join(f'{v:g}' for v in M[3])}, expected 0 0 0 1")
    R = M[:3, :3]
    with np.errstate(all="ignore"):  # of great numbers the products overflow, and are refused
        off = float(rotation_error(R))
        reflects = np.linalg.det(R) < 0.0
    if reflects:
        raise ValueError("found a reflection in the upper left 3×3 (its determinant is negative), expected a rotation")
    if not off <= DIGITS_LOST:
        raise ValueError(
            f"found no rotation in the upper left 3×3: RᵀR is off by {off:.2g}, expected at most {DIGITS_LOST:g}"
        )
    note = ""
    if off > ROUNDING:
        R = nearest_rotation(R)
        note = f"the matrix is a rotation only to {off:.1g}; the nearest rotation is taken"
    return transform(R, M[:3, 3] * units.metres), note


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
