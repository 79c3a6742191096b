"""Paths from a configuration to a pose: which solution they end with."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

from robokin.arrays import Array
from robokin.inverse.joint_paths import Path, follow_line, interpolate_joints, line_task, no_path
from robokin.inverse.solutions import Result
from robokin.inverse.solve import solve_ik
from robokin.kinematics.forward import forward_kinematics
from robokin.model import Robot


def path_to_pose(
    robot: Robot, start: Array, T: Array, task: str = "pose", steps: int = 100, *, line: bool = False,
    limits: bool = True, follows: Literal["pose", "position"] | None = None,
) -> Path:  # fmt: skip
    """A path from joint values start: (n,) [rad | m] to a pose T: (4, 4) [m], to its solution nearest to the start.

    task: what of the pose is asked for, as `solve_ik` has it; a position alone keeps the start's orientation, where the
    arm can turn its tool. line: whether the tool goes along a straight line, as `follow_line` has it, rather than all
    joints together; follows: what follows the line, by default the position for arms that only place a point. A pose
    that is not reached makes a path of its start alone.
    """
    if task == "position" and line_task(robot) == "pose":
        T = T.copy()
        T[:3, :3] = forward_kinematics(robot, start)[:3, :3]
    elif task == "position":
        follows = follows or "position"
    elif task == "approach" and line:
        # The roll about the tool's axis is free: that of the solution nearest to the start.
        found = _nearest(robot, start, T, limits, "approach")
        if not found.solutions:
            return replace(no_path(robot, start, found.reason or "not reached", steps), kind="line")
        T = forward_kinematics(robot, found.solutions[0].q)
    if line:
        return follow_line(robot, start, T, steps, limits, follows)
    found = _nearest(robot, start, T, limits, "approach" if task == "approach" else follows or line_task(robot))
    if not found.solutions:
        return no_path(robot, start, found.reason or "not reached", steps)
    return interpolate_joints(robot, start, found.solutions[0].q, steps, limits)


def _nearest(robot: Robot, start: Array, T: Array, limits: bool, task: str) -> Result:
    """The answer with the solution nearest to the start alone."""
    result = solve_ik(robot, T, limits=limits, near=start, task=task, most=1)  # type: ignore[arg-type]
    assert isinstance(result, Result)
    return result
