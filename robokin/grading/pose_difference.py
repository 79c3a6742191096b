"""Poses compared: position and orientation apart; and shown."""

from __future__ import annotations

from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.grading.tolerance import Tolerance
from robokin.spatial import rotation_error, rpy_from_rotation
from robokin.units import Units

WRONG_POSITION, WRONG_ORIENTATION, WRONG_POSE = "wrong position", "wrong orientation", "wrong pose"
PASS = "pass"

HALVES = {PASS: 1.0, WRONG_POSITION: 0.5, WRONG_ORIENTATION: 0.5}
"""The score of a pose: its position is one half, its orientation the other."""


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


MATRIX_CUT = 0.05
"""A matrix of two decimals is this near to a rotation; what is farther is shown as it stands."""


def pose_value(T: Array, task: str, units: Units) -> dict[str, list[Any]]:
    """A pose (4, 4) [m] as a mark shows it, in the units: of a matrix that is no rotation the matrix."""
    if task != "position" and float(rotation_error(T[:3, :3])) > MATRIX_CUT:
        M = T.copy()
        M[:3, 3] /= units.metres
        return {"matrix": M.tolist()}
    value: dict[str, list[Any]] = {"position": (T[:3, 3] / units.metres + 0.0).tolist()}
    if task == "pose":
        value["rpy"] = (rpy_from_rotation(T[:3, :3]) / units.radians + 0.0).tolist()
    if task == "approach":
        value["approach"] = (T[:3, 2] + 0.0).tolist()
    return value


def pose_score(status: str, task: str) -> float:
    """The score of a pose with a status of `pose_status`; of a task that is not a whole pose, all or nothing."""
    return HALVES.get(status, 0.0) if task == "pose" else float(status == PASS)
