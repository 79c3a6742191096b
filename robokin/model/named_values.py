"""Joint values and poses by name: columns of data frames, which are read by the package's own face."""

from __future__ import annotations

from typing import Any

from robokin.expected import has_names


def plain_joint_values(robot: Any, q: Any, argument: str = "q") -> Any:
    """What was given; of a data frame, a row of one or a dict, the columns of the joints in their order.

    robot: a Robot or a Tree, whose module imports this one. Raises InputError where a joint has no column.
    """
    if not has_names(q):
        return q
    import robokin  # the package's own face: tables are read in a room above this one

    return robokin.dataframes.joints(robot, q, argument=argument)


def plain_poses(T: Any, argument: str = "T", robot: Any = None, task: str = "pose") -> Any:
    """What was given; of a data frame, a row of one or a dict, the poses that its columns say. Raises InputError."""
    if not has_names(T):
        return T
    import robokin  # as above

    return robokin.dataframes.poses(T, None, robot, task, argument)
