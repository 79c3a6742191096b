"""Forward kinematics: joint values to poses."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.expected import expect_numbers, expect_whole
from robokin.jobs.ordered_map import MOST_CORES
from robokin.jobs.shared_rows import by_threads
from robokin.kernel.chain import chain_of
from robokin.kernel.columns import BLOCK, ChainProgram, Constant
from robokin.kernel.facts import fact
from robokin.kernel.frames import fill_poses, frames, pose, program_to_tool, run
from robokin.kernel.native_kernel import native
from robokin.kernel.straight_line import Straight, straight_frame
from robokin.kinematics.at_once import ALONE, keep_at_once, pose_at_once
from robokin.kinematics.code_at_once import POSE, keep_code
from robokin.model import CoupledRobot, Robot, expect_robot
from robokin.model.named_values import plain_joint_values
from robokin.spatial import exact

FLOATS = np.dtype(np.float64)

SHARE = 8 * BLOCK
"""Configurations that a thread takes at once: for fewer it is not worth while to start one."""


def threads_wanted(cores: int | None) -> int | None:
    """`cores` as a caller gives them, checked. Raises InputError."""
    if type(cores) is int and cores == 1:
        return 1
    return None if cores is None else expect_whole(cores, "cores", 1, MOST_CORES)


def forward_kinematics(robot: Robot, q: ArrayLike, cores: int | None = 1) -> Array:
    """The pose of the tool in the world.

    q: (..., n) joint values in file order [rad | m]. Returns (..., 4, 4) [m]. cores: threads that share a large batch,
    all usable cores for None; the poses are the same. NaN in a row of q gives NaN in its pose. Raises InputError when q
    has another length than n, or for less than one core.
    Source: J. Denavit and R. S. Hartenberg, A kinematic notation for lower-pair mechanisms based on matrices,
    J. Applied Mechanics 22, 1955; modified tables as J. J. Craig, Introduction to Robotics, 1986, has them.
    """
    if cores is ALONE:
        T: Array | None = pose_at_once(robot, q)
        if T is not None:
            return T
    q, moving = joint_motions(robot, q)
    cores = threads_wanted(cores)
    keep_at_once(robot)
    if cores == 1 and native is None and q.ndim == 1:
        one = _one_pose(moving)
        if one is not None:
            keep_code(POSE, moving, one)
            try:
                return one(q.tolist())
            except ValueError:  # of an infinite angle: the batch has NaN for it
                pass
    chain = chain_of(moving)
    if cores == 1:
        return pose(chain, q)
    return by_threads(lambda part, out: fill_poses(chain, part, out), q, (4, 4), SHARE, cores)


@fact
def _one_pose(robot: Robot) -> Straight | None:
    """The tool's pose (4, 4) [m] at one configuration, if there is code for the robot."""
    return straight_frame(program_to_tool(chain_of(robot)))


def link_frames(robot: Robot, q: ArrayLike) -> Array:
    """The frames of the links in the world, base to last, before the tool.

    q: (..., n) joint values in file order [rad | m]. Returns (..., n + 1, 4, 4) [m]: frame 0 is the
    base's, frame k the one that the row of joint k leads to. Fixed rows extend the link that they
    follow, so that `link_frames(robot, q)[..., -1, :, :] @ robot.tool` is the tool's pose.
    Raises InputError when q has another length than n.
    Source: Denavit and Hartenberg 1955, Craig 1986, as for `forward_kinematics`.
    """
    q, moving = joint_motions(robot, q)
    return run(_row_program(moving, False), q)


def row_frames(robot: Robot, q: ArrayLike) -> Array:
    """The frame after every row of the table, fixed rows included.

    q: (..., n) joint values in file order [rad | m]. Returns (..., rows, 4, 4) [m].
    """
    q, moving = joint_motions(robot, q)
    T = run(_row_program(moving, True), q)
    if len(robot.rows) == len(moving.rows):
        return T
    # A helical row is two of the arm's that moves: its frame is the one after both.
    return T[..., np.cumsum([1 + bool(row.pitch) for row in robot.rows]) - 1, :, :]


def joint_frames(robot: Robot, q: ArrayLike) -> Array:
    """The frame that each joint starts from, its axis along z, and the tool's pose last.

    q: (..., n) joint values in file order [rad | m]. Returns (..., n + 1, 4, 4) [m].
    """
    q, moving = joint_motions(robot, q)
    return frames(chain_of(moving), q)


def joint_motions(robot: Robot, q: ArrayLike) -> tuple[Array, Robot]:
    """The values (..., m) of the joints that q (..., n) [rad | m] moves, and the arm whose joints they are.

    These are q and the robot itself, but for one whose joints hang on each other.
    """
    q = joint_values(robot, q)
    if isinstance(robot, CoupledRobot):
        return robot.drive.motions(q), robot.free_motion
    return q, robot


def joint_values(robot: Robot, q: ArrayLike) -> Array:
    """q as an array (..., n) of floats; InputError when it is not one, or `robot` no robot."""
    if type(q) is np.ndarray and q.dtype == FLOATS and isinstance(robot, Robot) and q.shape[-1:] == (robot.n,):
        return q
    robot = expect_robot(robot)
    q = expect_numbers(plain_joint_values(robot, q), "q", "joint values: numbers in an array (..., n)")
    if q.ndim == 0 or q.shape[-1] != robot.n:
        given = "a single number" if q.ndim == 0 else f"{q.shape[-1]} in the last dimension"
        raise InputError(
            f"q: found {given}, expected {robot.n}: "
            f"one value for each joint of {robot.name} ({robot.types or 'no joints'})"
        )
    return q


@fact
def _row_program(robot: Robot, every_row: bool) -> ChainProgram:
    """The way row by row; a mark after every row, or only after the last row of each link."""
    segments = [[Constant(robot.base, mark=not every_row)]]
    for joint in robot.graph.joints:
        segments[-1].append(Constant(joint.before))
        if joint.moves:
            segments.append([Constant(exact(joint.after), mark=True)])
        else:
            if not every_row:
                segments[-1] = [Constant(part.matrix) for part in segments[-1]]
            segments[-1].append(Constant(joint.after, mark=True))
    chain = chain_of(robot)
    return ChainProgram(segments, chain.revolute, chain.offsets)
