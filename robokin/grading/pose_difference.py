"""Poses compared: position and orientation apart."""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array
from robokin.grading.tolerance import Tolerance

WRONG_POSITION, WRONG_ORIENTATION, WRONG_POSE = "wrong position", "wrong orientation", "wrong pose"
PASS = "pass"


def pose_errors(right: Array, given: Array, task: str = "pose") -> tuple[float, float]:
    """Distance [m] and angle [rad] between two poses (4, 4), of which the second may be no exact rotation.

    The angle is 2 asin(|R - M| / √8), which is the angle between two rotations whatever they are said with (a
    quaternion's sign, other Euler angles), and counts what is no rotation in M as well: neither a matrix whose
    digits were cut nor one that is scaled passes for more than it is. For the task `approach` it is the angle
    between the z axes, for `position` zero.
    """
    position = float(np.linalg.norm(right[:3, 3] - given[:3, 3]))
    if task == "position":
        return position, 0.0
    if task == "approach":
        return position, chord_angle(float(np.linalg.norm(right[:3, 2] - given[:3, 2])), 2.0)
    return position, chord_angle(float(np.linalg.norm(right[:3, :3] - given[:3, :3])), np.sqrt(8.0))


def chord_angle(chord: float, greatest: float) -> float:
    """The angle [rad] whose chord is given, `greatest` being that of 180°."""
    return float(2.0 * np.arcsin(min(chord / greatest, 1.0)))


def pose_status(position: float, angle: float, allowed: Tolerance, right: Array) -> str:
    """`pass`, or what is wrong, of errors [m, rad] from the right pose (4, 4)."""
    near = allowed.allows_position(position, float(np.linalg.norm(right[:3, 3])))
    turned = allowed.allows_angle(angle)
    if near and turned:
        return PASS
    return WRONG_ORIENTATION if near else WRONG_POSITION if turned else WRONG_POSE
