"""The shoulder's condition as an equation in the joints, in the letters of the table: a2 c2 + a3 c23 + d4 s23 = 0.

Statement. P, the wrist centre, lies in the plane through axis 1 that is parallel to axis 2.
Derivation. With z1 and z2 the directions of the axes and o1 a point on axis 1 this says ρ = (P - o1) · u = 0,
u = z1 × z2 / |z1 × z2|. Where axes 2, 3, … are parallel, P moves in circles about them: ρ is linear in the cosines and
sines of θ2, θ2 + θ3, …, and its coefficients follow from as many random configurations as are needed; that the equation
holds at others proves the form. A coefficient that is a length of the table gets its letter.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.kernel.joint_axes import nearest_point
from robokin.kinematics.forward import joint_frames
from robokin.kinematics.velocity import wrist_centre
from robokin.model import Robot

NONE = 1e-9
"""Coefficients and misfits below this part of the arm's size are rounding."""


@dataclass(frozen=True)
class EquationTerm:
    """coefficient [m] times c, s or nothing of an angle, the sum of joints (from 1) with signs; letter: the table's."""

    coefficient: float
    function: str
    angles: tuple[int, ...]
    letter: str

    @property
    def argument(self) -> str:
        """`c23` for cos(q2 + q3), `c(q2-q3)` where a sign is negative, "" for a constant."""
        if not self.function:
            return ""
        if min(self.angles) > 0 and max(self.angles) < 10:
            return self.function + "".join(map(str, self.angles))
        summed = "".join(f"{'+' if k > 0 else '-'}q{abs(k)}" for k in self.angles)
        return f"{self.function}({summed.removeprefix('+')})"


@dataclass(frozen=True)
class Equation:
    """A sum of terms that must be zero."""

    terms: tuple[EquationTerm, ...]

    def value(self, q: Array) -> Array:
        """(...) what the sum is [m] at q: (..., n) [rad | m]."""
        total = np.zeros(np.shape(q)[:-1])
        for term in self.terms:
            angle = sum((np.sign(k) * q[..., abs(k) - 1] for k in term.angles), np.zeros(np.shape(q)[:-1]))
            shape = {"c": np.cos, "s": np.sin}.get(term.function)
            total = total + term.coefficient * (1.0 if shape is None else shape(angle))
        return total

    def solved(self, q: Array, joint: int) -> Array:
        """q (s, n) with the value of a joint (from 0) that fulfils the equation; NaN where none does.

        Every term has the joint in its angle once or not at all, so that it reads A cos + B sin + C = 0.
        """
        at = np.repeat(q[:, None], 3, axis=1)
        at[:, :, joint] = [0.0, np.pi / 2.0, np.pi]
        zero, quarter, half = self.value(at).T
        C, A = (zero + half) / 2.0, (zero - half) / 2.0
        B = quarter - C
        out = q.copy()
        with np.errstate(invalid="ignore", divide="ignore"):
            out[:, joint] = np.arctan2(B, A) + np.arccos(-C / np.hypot(A, B))
        return out

    @property
    def lettered(self) -> str:
        """The equation in the table's letters, or "" where a coefficient is no length of the table."""
        if not all(term.letter for term in self.terms):
            return ""
        return f"{signed([(term.letter, term.argument) for term in self.terms])} = 0"


def signed(parts: list[tuple[str, str]]) -> str:
    """Coefficients and factors as a sum, `a2 c2 - d4 s23`."""
    text = ""
    for coefficient, factor in parts:
        minus = coefficient.startswith("-")
        sign = ("-" if minus else "") if not text else (" - " if minus else " + ")
        text += f"{sign}{coefficient.lstrip('-')}{' ' if factor else ''}{factor}"
    return text


def reference_point(robot: Robot, frames: Array) -> Array:
    """(..., 3) P [m]: the wrist centre, or the point of axis n - 1 nearest to axis n, or the hand if n is below 5."""
    centre = wrist_centre(robot, frames)
    if centre is not None:
        return centre
    if robot.n < 5 or not robot.revolute[-2:].all():
        return np.asarray(frames[..., -1, :3, 3])
    z, o = frames[..., -3:-1, :3, 2], frames[..., -3:-1, :3, 3]
    return nearest_point(z[..., 1, :], o[..., 1, :], z[..., 0, :], o[..., 0, :])


def lateral(robot: Robot, q: Array) -> Array | None:
    """(...) ρ [m] at q: (..., n), or P's distance from axis 1 where axis 2 is parallel to it; None for joint 1 sliding.

    A planar arm has no shoulder: None.
    """
    if not robot.revolute[0] or robot.n < 2:
        return None
    F = joint_frames(robot, q)
    z1, z2 = F[..., 0, :3, 2], F[..., 1, :3, 2]
    out = reference_point(robot, F) - F[..., 0, :3, 3]
    normal = np.cross(z1, z2)
    length = np.linalg.norm(normal, axis=-1)
    if np.min(length) > 1e-6:
        return np.asarray(np.sum(out * normal, axis=-1) / length)
    if robot.revolute[1]:
        return None
    return np.asarray(np.linalg.norm(np.cross(out, z1), axis=-1))


def equation_of(robot: Robot, joints: tuple[int, ...], size: float) -> Equation | None:
    """ρ = 0 as an equation in some joints (from 0), where these are parallel axes from the second on; None else."""
    last = max(joints)
    q = np.random.default_rng(3).uniform(-2.0, 2.0, (60, robot.n)) * np.where(robot.revolute, 1.0, size)
    z = joint_frames(robot, q[:1])[0, :-1, :3, 2]
    signs = z[1 : last + 1] @ z[1]
    if min(joints) != 1 or not robot.revolute[1 : last + 1].all() or np.any(np.abs(np.abs(signs) - 1.0) > NONE):
        return None
    sums = [tuple(int(np.sign(signs[i])) * (i + 2) for i in range(k)) for k in range(1, last + 1)]
    angles = np.stack([sum(np.sign(k) * q[:, abs(k) - 1] for k in part) for part in sums])
    columns = [np.ones(len(q)), *np.concatenate([np.stack([np.cos(a), np.sin(a)]) for a in angles])]
    names = [("", ())] + [(letter, part) for part in sums for letter in "cs"]
    basis = np.stack(columns, axis=1)
    rho = lateral(robot, q)
    if rho is None:
        return None
    fitted = np.linalg.lstsq(basis[:30], rho[:30], rcond=None)[0]
    if np.max(np.abs(basis @ fitted - rho)) > NONE * size:
        return None
    terms = [
        (float(value), letter, part)
        for value, (letter, part) in zip(fitted, names, strict=True)
        if abs(value) > NONE * size
    ]
    letters = [_letter(robot, value, part) for value, _, part in terms]
    minus = [letter.startswith("-") if letter else term[0] < 0.0 for letter, term in zip(letters, terms, strict=True)]
    if 2 * sum(minus) > len(minus):
        terms = [(-value, letter, part) for value, letter, part in terms]
    return Equation(
        tuple(EquationTerm(value, letter, part, _letter(robot, value, part)) for value, letter, part in terms)
    )


def _letter(robot: Robot, value: float, angles: tuple[int, ...]) -> str:
    """The length of the table that a coefficient is, with its sign, the rows nearest to the last joint first."""
    if robot.convention == "frames":
        return ""
    place = max((abs(k) for k in angles), default=1)
    for i in sorted(range(1, len(robot.rows) + 1), key=lambda i: (abs(i - place), -i)):
        row = robot.rows[i - 1]
        for letter, length in (("a", row.a), ("d", row.d)):
            if length and abs(abs(value) - abs(length)) < NONE:
                return f"{letter}{i}" if value * length > 0.0 else f"-{letter}{i}"
    return ""


def exact_angle(robot: Robot, joint: int, value: float) -> str:
    """An angle as atan2 of two lengths of the table, `atan2(d4, a3)`; "" for a round angle or where there is none."""
    if robot.convention == "frames" or not robot.revolute[joint] or abs(np.degrees(value) / 15.0 % 1.0) < 1e-9:
        return ""
    lengths = [
        (f"{letter}{i}", length)
        for i, row in enumerate(robot.rows, start=1)
        for letter, length in (("a", row.a), ("d", row.d))
        if length
    ]
    for y_name, y in lengths:
        for x_name, x in lengths:
            for sy in (1.0, -1.0):
                for sx in (1.0, -1.0):
                    gap = np.mod(np.arctan2(sy * y, sx * x) - value + np.pi, 2.0 * np.pi) - np.pi
                    if y_name != x_name and abs(gap) < NONE:
                        return f"atan2({'-' if sy < 0 else ''}{y_name}, {'-' if sx < 0 else ''}{x_name})"
    return ""
