"""What of a chain may still be moved: sets of rigid motions that leave the joints before it as they are.

Take two chains of which the first joints have been brought together. The rest of one may still be moved by the
motions that leave those joints' axes where they are, and, where the zero of a joint is free, by the joint's own
motion. Such a set is always of one kind: any turn, turns about one line, or no turn, together with the translations
along some directions. For a turning joint the motions that leave its axis alone turn about it and slide along it;
for a sliding joint, of which only the direction counts, they turn about its direction and translate anyhow.
Two different lines, one after the other, leave what both allow.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.spatial import (
    axis_angle_from_rotation,
    invert,
    quaternion_from_rotation,
    rotation_from_axis_angle,
    transform,
    translation_transform,
)


@dataclass(frozen=True, eq=False)
class Axis:
    """A joint's axis: direction u (3,) of length 1 and a point o (3,) [m] on it; of a sliding joint any point."""

    u: Array
    o: Array
    turning: bool

    def moved(self, T: Array, sign: int = 1) -> Axis:
        """The axis moved by T (4, 4), and reversed for the sign -1."""
        return Axis(sign * (T[:3, :3] @ self.u), T[:3, :3] @ self.o + T[:3, 3], self.turning)


@dataclass(frozen=True)
class Near:
    """What is taken as zero: angles [rad] and lengths [m]."""

    angle: float
    length: float


@dataclass(frozen=True, eq=False)
class ChainFreedom:
    """Rigid motions: translations along the columns of slides (3, k), and turns: `all`, about `line`, or `none`."""

    slides: Array
    turns: str = "none"
    line: Axis | None = None

    def fit(self, right: Axis, given: Axis, near: Near) -> Array:
        """The motion (4, 4) of the set that brings the given axis nearest to the right one."""
        k = self._turned(right, given, near)
        if not given.turning or not self.slides.shape[1]:
            return k
        off = across(right.o - given.moved(k).o, right.u)
        U, values, Vt = np.linalg.svd(across(self.slides.T, right.u).T, full_matrices=False)
        # Slides along the axis itself do nothing for it, and those that nearly do would have to be great.
        parts = np.where(values > near.angle, (U.T @ off) / np.where(values > near.angle, values, 1.0), 0.0)
        return translation_transform(self.slides @ (Vt.T @ parts)) @ k

    def _turned(self, right: Axis, given: Axis, near: Near) -> Array:
        if self.turns == "all":
            R = shortest_turn(given.u, right.u)
            return transform(R, right.o - R @ given.o)
        if self.line is None:
            return np.eye(4)
        u, o = self.line.u, self.line.o
        a, b = across(right.u, u), across(given.u, u)
        if min(np.linalg.norm(a), np.linalg.norm(b)) <= near.angle:
            # Parallel to the line: where the axis stands tells the turn, unless translations take it anywhere.
            a, b = across(right.o - o, u), across(given.o - o, u)
            free = self.slides.shape[1] == 3 or not given.turning
            if free or min(np.linalg.norm(a), np.linalg.norm(b)) <= near.length:
                return np.eye(4)
        return turn_about(self.line, float(np.arctan2(u @ np.cross(b, a), b @ a)))

    def fit_frame(self, right: Array, given: Array) -> Array:
        """The motion (4, 4) of the set that brings a given frame (4, 4) to the right one, turns first."""
        if self.turns == "all":
            return right @ invert(given)
        k = np.eye(4)
        if self.line is not None:
            w, *v = quaternion_from_rotation(right[:3, :3] @ given[:3, :3].T)
            k = turn_about(self.line, float(2.0 * np.arctan2(self.line.u @ v, w)))
        off = right[:3, 3] - (k @ given)[:3, 3]
        return translation_transform(self.slides @ (self.slides.T @ off)) @ k

    def leaving(self, axis: Axis, near: Near) -> ChainFreedom:
        """The motions of the set that leave an axis as it is."""
        if self.turns == "all":
            return ChainFreedom(axis.u[:, None] if axis.turning else np.eye(3), "line", axis)
        parallel = self.line is not None and np.linalg.norm(np.cross(self.line.u, axis.u)) <= near.angle
        if not axis.turning:
            return self if parallel else ChainFreedom(self.slides)
        along = self.slides @ (self.slides.T @ axis.u)
        slides = axis.u[:, None] if np.linalg.norm(axis.u - along) <= near.angle else np.empty((3, 0))
        if parallel and self.line is not None:
            if self.slides.shape[1] == 3:
                return ChainFreedom(slides, "line", axis)
            if np.linalg.norm(across(axis.o - self.line.o, self.line.u)) <= near.length:
                return ChainFreedom(slides, "line", self.line)
        return ChainFreedom(slides)

    def moving(self, axis: Axis, near: Near) -> ChainFreedom:
        """The set with the joint's own motion; what is in the set leaves the axis as it is."""
        if axis.turning:
            return self if self.line is not None else ChainFreedom(self.slides, "line", axis)
        rest = axis.u - self.slides @ (self.slides.T @ axis.u)
        length = float(np.linalg.norm(rest))
        if length <= near.angle:
            return self
        return ChainFreedom(np.column_stack([self.slides, rest / length]), self.turns, self.line)

    def holds(self, k: Array, near: Near) -> bool:
        """Whether a motion (4, 4) is one of the set."""
        if self.turns == "all":
            return True
        R, p = k[:3, :3], k[:3, 3]
        if self.line is None:
            turned, shift = float(axis_angle_from_rotation(R)[1]), p
        else:
            turned = float(np.linalg.norm(R @ self.line.u - self.line.u))
            shift = R @ self.line.o + p - self.line.o
        rest = shift - self.slides @ (self.slides.T @ shift)
        return turned <= near.angle and float(np.linalg.norm(rest)) <= near.length


NOTHING = ChainFreedom(np.empty((3, 0)))
"""No motion but rest."""

EVERYTHING = ChainFreedom(np.eye(3), "all")
"""Every rigid motion."""


def across(v: Array, u: Array) -> Array:
    """The part of vectors (..., 3) across a direction u (3,)."""
    return np.asarray(v - (v @ u)[..., None] * u)


def turn_about(line: Axis, angle: float) -> Array:
    """The rotation (4, 4) about a line by an angle [rad]."""
    R = rotation_from_axis_angle(line.u, angle)
    return transform(R, line.o - R @ line.o)


def shortest_turn(b: Array, a: Array) -> Array:
    """The rotation (3, 3) by the least angle that takes b to a."""
    normal = np.cross(b, a)
    if np.linalg.norm(normal) < 1e-12:
        if b @ a > 0.0:
            return np.eye(3)
        normal = np.cross(b, np.eye(3)[np.argmin(np.abs(b))])
    return rotation_from_axis_angle(normal, float(np.arctan2(np.linalg.norm(np.cross(b, a)), b @ a)))
