"""Names of solutions: shoulder right or left, elbow up or down, wrist flip or no-flip.

The words are geometry, so that one name means the same posture on every arm:

- shoulder right: the wrist centre (or the hand of an arm without a wrist) lies on the positive side of the
  first axis, where x₁ · (w - o₁) ≥ 0 with x₁ the direction in which the arm reaches at the given q₁. With
  the lecture's table of the anthropomorphic arm this is θ₁ = atan2(p_y, p_x), shoulder left is half a turn on.
- elbow up: the elbow lies above the line from the shoulder to the wrist, above being the direction of the
  first axis; for a planar arm: to the left of the line from the base to the wrist.
- wrist no-flip: the wrist's middle axis has turned to the positive side, sin θ ≥ 0.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robokin.inverse.padding import joint_frames_of
from robokin.kinematics.chain import chain_of
from robokin.kinematics.structure import structure_of
from robokin.model import Robot

Array = NDArray[np.float64]


def branch_names(robot: Robot, q: Array) -> list[str]:
    """The name of each configuration q: (s, n), or "" where the arm has no such words."""
    if not len(q):
        return []
    structure = structure_of(robot)
    arm, n = structure.arm, robot.n
    chain = chain_of(robot)
    F = joint_frames_of(chain, q)
    words: list[list[str]] = [[] for _ in q]
    if (arm == "planar" and n >= 3) or (arm in ("planar", "SCARA") and n >= 2):
        _add(words, _planar_elbow(F), "elbow up", "elbow down")
    elif arm == "anthropomorphic" and 3 <= n <= 6:
        wrist = _wrist_centre(F, structure.wrist, n)
        _add(words, _shoulder(F, wrist), "shoulder right", "shoulder left")
        _add(words, _elbow(F, wrist), "elbow up", "elbow down")
    elif arm == "spherical":
        _add(words, _side(F, 1), "shoulder right", "shoulder left")
    if n == 6 and (structure.wrist.startswith("spherical") or arm == "anthropomorphic"):
        _add(words, _side(F, 4), "wrist no-flip", "wrist flip")
    elif arm == "spherical wrist":
        _add(words, _side(F, 1), "wrist no-flip", "wrist flip")
    return [", ".join(parts) for parts in words]


def _add(words: list[list[str]], yes: NDArray[np.bool_], name: str, other: str) -> None:
    for parts, flag in zip(words, yes, strict=True):
        parts.append(name if flag else other)


def _wrist_centre(F: Array, wrist: str, n: int) -> Array:
    """(s, 3) where the wrist's axes meet, or the origin of the last arm joint's successor, or the hand."""
    if n <= 3:
        return F[:, -1, :3, 3]
    if wrist.startswith("spherical"):
        z, o = F[:, -3:-1, :3, 2], F[:, -3:-1, :3, 3]
        return _meeting(z[:, 0], o[:, 0], z[:, 1], o[:, 1])
    return F[:, min(n - 1, 4), :3, 3]


def _meeting(z0: Array, o0: Array, z1: Array, o1: Array) -> Array:
    """The point (s, 3) of the second line nearest to the first one."""
    normal = np.cross(z0, z1)
    along = np.einsum("si,si->s", np.cross(o1 - o0, z0), normal) / np.einsum("si,si->s", normal, normal)
    return np.asarray(o1 + along[:, None] * z1)


def _shoulder(F: Array, wrist: Array) -> NDArray[np.bool_]:
    """Whether the wrist is on the side that x of the first link points to."""
    x1, o1 = F[:, 1, :3, 0], F[:, 0, :3, 3]
    return _along(wrist - o1, x1)


def _elbow(F: Array, wrist: Array) -> NDArray[np.bool_]:
    z1, shoulder, elbow = F[:, 0, :3, 2], F[:, 1, :3, 3], F[:, 2, :3, 3]
    normal = F[:, 1, :3, 2]
    line = wrist - shoulder
    up = np.cross(normal, line)
    up = up * np.sign(np.einsum("si,si->s", up, z1))[:, None]
    return _along(elbow - shoulder, up)


def _planar_elbow(F: Array) -> NDArray[np.bool_]:
    base, elbow = F[:, 0, :3, 3], F[:, 1, :3, 3]
    wrist = F[:, 2, :3, 3]
    left = np.cross(F[:, 0, :3, 2], wrist - base)
    return _along(elbow - base, left)


def _side(F: Array, joint: int) -> NDArray[np.bool_]:
    """Whether a joint has turned its neighbours' axes to the positive side, sin θ ≥ 0."""
    before, axis, after = F[:, joint - 1, :3, 2], F[:, joint, :3, 2], F[:, joint + 1, :3, 2]
    return _along(np.cross(before, after), axis, 1.0)


UNDECIDED = 1e-6
"""A sine this small is no side: a straight elbow is up, a straight wrist no-flip, whatever its last digits say."""


def _along(v: Array, direction: Array, length: float | None = None) -> NDArray[np.bool_]:
    """Whether vectors v (s, 3) point along directions (s, 3) rather than against them; neither counts as along."""
    longest = np.linalg.norm(v, axis=1) if length is None else length
    scale = longest * np.linalg.norm(direction, axis=1)
    return np.asarray(np.einsum("si,si->s", v, direction) >= -UNDECIDED * scale)
