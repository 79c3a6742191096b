"""The pose of a plain robot at one configuration, as `robokin fk` prints it."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, Any

from robokin.errors import InputError
from robokin.formats.plain_robots import FILES, library_robot
from robokin.formats.typed_angles import unit_of_angles
from robokin.records.envelope import configuration_record, envelope
from robokin.rotation_entries import Floats, quaternion_of_floats, rpy_of_entries
from robokin.tables.written_rows import json_document, json_line
from robokin.units import Units

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from robokin.arrays import Array
    from robokin.formats.plain_robots import PlainRobot

    Find = Callable[[str], PlainRobot | None]

KINDS = ("table", "json", "jsonl")
"""The formats that are written here."""


class PlainPose:
    """The pose of a robot at q, n values in the units. Raises OverflowError where it is too far away for a number."""

    def __init__(self, robot: PlainRobot, units: Units, q: list[float]) -> None:
        self.robot, self.units = robot, units
        self.q = [value + 0.0 for value in q]
        si = [value * factor for value, factor in zip(q, robot.factors(units), strict=True)]
        self.within_limits = robot.within_limits(si)
        numbers = [value + 0.0 for value in robot.frame(si)]
        metres = units.metres
        self.rows = [[*numbers[k : k + 3], numbers[k + 3] / metres] for k in (0, 4, 8)]
        if not all(isfinite(row[3]) for row in self.rows):
            raise OverflowError("the pose is too far away")
        radians = units.radians
        self.rpy = [angle / radians + 0.0 for angle in rpy_of_entries(self.rows, Floats)]
        self.quaternion = [value + 0.0 for value in quaternion_of_floats(self.rows)]

    def document(self) -> dict[str, Any]:
        """What --json prints."""
        pose = {
            "matrix": [*self.rows, [0.0, 0.0, 0.0, 1.0]],
            "position": [row[3] for row in self.rows],
            "rpy": self.rpy,
            "quaternion": self.quaternion,
        }
        head = envelope("robot", self.robot.id, self.units)
        return configuration_record(head, self.q, self.within_limits, pose)

    def written(self, kind: str) -> bytes:
        """The answer in one of `KINDS`."""
        if kind != "table":
            return (json_document if kind == "json" else json_line)(self.document())
        from robokin.reports.page_tables import render
        from robokin.reports.pose_pages import pose_page

        said = [("rpy", self.rpy), ("quaternion", self.quaternion)]
        return render(*pose_page(self.robot.name, self.units, self.q, self.rows, said))


def plain_pose(robot: PlainRobot | None, units: Units, q: Array) -> PlainPose | None:
    """The pose of a robot at one configuration (1, n) in the units; None where it has no answer here."""
    try:
        return None if robot is None else PlainPose(robot, units, q[0].tolist())
    except OverflowError:
        return None


def _known(name: str) -> PlainRobot | None:
    """An arm of the library, or of a plain file of one's own; None where the file must be read."""
    if not name.endswith(FILES):
        return library_robot(name)
    from robokin.formats.plain_files import file_robot

    return file_robot(name)


def fk_written(name: str, given: Mapping[str, str], kind: str, find: Find | None) -> bytes | None:
    """What `robokin fk NAME` prints of one configuration in one of `KINDS`; None where the parser must look.

    `given` holds --q, and --angle and --length where they are there; `find` looks robots of the library up.
    """
    robot = (find or _known)(name)
    if robot is None:
        return None
    units = robot.units
    if "--length" in given or "--angle" in given:
        units = Units(given.get("--length", units.length), given.get("--angle", units.angle))
    try:
        q, named = robot.configuration(given["--q"], units)
        turning = [value for value, turns in zip(q, robot.turns, strict=True) if turns]
        if not named and unit_of_angles(turning, units.degrees):
            return None
        pose = PlainPose(robot, units, q)
    except (InputError, OverflowError):
        return None
    return pose.written(kind) if pose.within_limits else None
