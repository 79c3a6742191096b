"""A robot as the text of a description, which loads again as the same robot."""

from __future__ import annotations

from dataclasses import replace

from robokin.formats.description_lines import (
    coupling_lines,
    head_lines,
    pose_lines,
    row_lines,
    row_names,
    transform_lines,
)
from robokin.formats.schema import VERSION
from robokin.model import CoupledRobot, JointType, Robot, expect_robot


def written(robot: Robot) -> str:
    """The description of a robot in its own units and convention, as YAML.

    Numbers are the shortest that read as the same value; parameters are resolved, notes left out. Of a joint with one
    limit the other is written as 1e6 m or rad. Variables are in the order of their rows (`row_order`). Raises
    InputTypeError for what is no robot, InputError for a chain of a tree whose joints others move that are not in it.
    """
    robot = expect_robot(robot)
    units, order = robot.units, row_order(robot)
    lines = [
        f"robokin: {VERSION}",
        *head_lines(robot.name or robot.id or "robot", robot.description, robot.source, units),
    ]
    lines.append(f"convention: {robot.convention}")
    lines += transform_lines("base", robot.base, units)
    lines += ["joints:", *(f"  {line}" for line in row_lines(robot.rows, robot.convention, units))]
    lines += transform_lines("tool", robot.tool, units)
    if isinstance(robot, CoupledRobot):
        called = {row.name: name for row, name in zip(robot.rows, row_names(robot.rows), strict=True) if row.moves}
        turning = {called[row.name]: row.type is JointType.REVOLUTE for row in robot.rows if row.moves}
        couplings = [
            replace(one, joint=called[one.joint], ratios=tuple((called[name], ratio) for name, ratio in one.ratios))
            for one in robot.drive.couplings
        ]
        lines += coupling_lines(couplings, turning, units)
    poses = {name: q[order] for name, q in robot.poses.items()}
    lines += pose_lines(poses, robot.revolute[order], units)
    return "\n".join(lines) + "\n"


def row_order(robot: Robot) -> list[int]:
    """The numbers (from 0) of a robot's variables in the order of the rows, which is that of its description.

    Raises InputError for a chain of a tree whose joints others move that are not in it.
    """
    if not isinstance(robot, CoupledRobot):
        return [*range(robot.n)]
    _ = robot.graph  # refuses joints that are not in the chain
    numbers = {joint.name: number for number, joint in enumerate(robot.joints)}
    return [numbers[row.name] for row in robot.rows if row.moves and row.name in numbers]
