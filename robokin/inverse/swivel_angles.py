"""The swivel angle of seven-joint arms with a spherical shoulder and wrist: a configuration's, and solutions at one."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.expected import expect_flag, expect_numbers
from robokin.inverse.self_motion.swivel_arm import SwivelArm, swivel_arm
from robokin.inverse.self_motion.swivel_curves import swivel_curves
from robokin.inverse.self_motion.swivel_pieces import CODES
from robokin.inverse.solve import target_poses
from robokin.inverse.verify import within_limits
from robokin.kernel.chain import chain_of
from robokin.kernel.frames import pose
from robokin.model import Robot, expect_robot
from robokin.model.named_values import plain_joint_values


def swivel_angle(robot: Robot, q: ArrayLike) -> Array:
    """The swivel angle of configurations: how far the elbow is turned about the line from shoulder to wrist.

    q: (..., 7) [rad]. Returns (...) [rad] in [-π, π], zero where the elbow is in the half plane of that line that axis
    1 points into (the base's x axis, where the line is along axis 1), positive by the right hand from shoulder to
    wrist.
    Raises InputError for a robot without a spherical shoulder (joints 1 to 3) and a spherical wrist (joints 5 to 7).
    Source: M. Shimizu et al., Analytical inverse kinematic computation for 7-DOF redundant manipulators with joint
    limits and global configuration control, IEEE Trans. Robotics 24(5), 2008.
    """
    arm = _expect_swivel_arm(robot)
    values = expect_numbers(plain_joint_values(robot, q), "q", "7 joint values, or rows of them")
    if values.ndim == 0 or values.shape[-1] != 7:
        raise InputError(f"q: found an array of shape {values.shape}, expected joint values (..., 7)")
    if not np.all(np.isfinite(values)):
        raise InputError("q: found a number that is not finite, expected finite numbers")
    rows = values.reshape(-1, 7)
    curves = swivel_curves(arm, pose(arm.chain, rows))
    here = np.arange(len(rows))
    # Of both elbows the one that the joint stands at.
    away = np.abs(np.exp(1j * curves.q4) - np.exp(1j * (rows[:, 3:4] + arm.chain.offsets[3])))
    return curves.swivel(here, np.argmin(away, axis=1), rows).reshape(values.shape[:-1])


def swivel_solutions(robot: Robot, T: ArrayLike, swivel: float, limits: bool = True) -> Array:
    """Every configuration that brings the tool to T with the elbow at one swivel angle.

    T: (4, 4) pose of the tool in the world [m]; swivel: [rad], as `swivel_angle` counts it; limits: whether only what
    respects the joint limits. Returns (k, 7) [rad]: up to eight, two for each of elbow, shoulder and wrist, none where
    the elbow does not reach. Raises InputError for another arm, as `swivel_angle` does, and for what is no pose.
    Source: M. Shimizu et al., as `swivel_angle`.
    """
    arm = _expect_swivel_arm(robot)
    poses = target_poses(T)
    if poses.ndim != 2:
        raise InputError(f"T: found poses of shape {poses.shape}, expected one (4, 4)")
    angle = expect_numbers(swivel, "swivel", "an angle [rad]")
    if angle.ndim or not np.isfinite(angle):
        raise InputError(f"swivel: found {swivel!r}, expected one finite angle [rad]")
    limits = expect_flag(limits, "limits")
    curves = swivel_curves(arm, poses[None])
    signs = CODES[curves.real[0, CODES[:, 0]]]
    count = len(signs)
    q = curves.configurations(np.zeros(count, dtype=np.intp), signs, np.full(count, float(angle)))
    if not limits:
        return q
    q, inside = within_limits(q, robot.revolute, robot.limits, None)
    return q[inside]


def _expect_swivel_arm(robot: Robot) -> SwivelArm:
    arm = swivel_arm(chain_of(expect_robot(robot)))
    if arm is None:
        raise InputError(
            f"{robot.name} has no swivel angle, expected seven turning joints of which the first three axes meet in a "
            "point, and the last three"
        )
    return arm
