"""A robot as URDF, for programs that read no tables."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import numpy as np

from robokin.arrays import Array
from robokin.formats.exact_numbers import rpy_exactly
from robokin.formats.node_values import LONGEST
from robokin.formats.written_robot import different_names
from robokin.kinematics.dh_table import to_convention
from robokin.model import Joint, JointType, Robot
from robokin.spatial import exact, rotation_transform, translation_transform

NO_NAME = re.compile(r"[^\w.-]+", re.ASCII)
"""What names in URDF do without."""

EFFORT, VELOCITY = "100", "1"
"""Placeholders: URDF wants to know of each joint with limits how strong and how fast it is."""

REMARK = "lengths in metres, angles in radians; effort and velocity are placeholders"


def urdf_text(robot: Robot) -> str:
    """The robot as URDF: its chain of links from base_link to tool.

    Numbers have up to 17 digits, so that the poses stay what they are. Base, tool and fixed rows become fixed joints;
    an offset becomes a part of the joint's origin, a sense of -1 the opposite axis. Joints without limits are
    continuous, slides without limits have those of ±1e6 m. Raises InputTypeError for what is no robot.
    Source of the form: Open Robotics, urdfdom, parser of joints, 2011.
    """
    robot = to_convention(robot, "frames")
    root = ElementTree.Element("robot", name=valid_name(robot.id or robot.name, "robot"))
    said = "; ".join(part.rstrip(". ") for part in (robot.name, robot.source, REMARK) if part)
    said = "".join(letter if letter.isprintable() else " " for letter in said)
    root.append(ElementTree.Comment(f" {re.sub('-(?=-|$)', '- ', said)} "))
    names = [valid_name(row.name, f"joint_{i}") for i, row in enumerate(robot.rows, start=1)]
    steps: list[tuple[str, Joint]] = []
    if not np.array_equal(robot.base, np.eye(4)):
        steps.append(("base", Joint("base", JointType.FIXED, origin=robot.base)))
    steps += zip(names, robot.rows, strict=True)
    if not np.array_equal(robot.tool, np.eye(4)):
        steps.append(("tool", Joint("tool", JointType.FIXED, origin=robot.tool)))
    joints = different_names(name for name, _ in steps)
    links = ["base_link", *(f"link_{i}" for i in range(1, len(steps))), "tool"]
    for link in links:
        ElementTree.SubElement(root, "link", name=link)
    for i, (name, (_, row)) in enumerate(zip(joints, steps, strict=True)):
        root.append(_joint(name, row, links[i], links[i + 1]))
    ElementTree.indent(root)
    return '<?xml version="1.0"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"


def valid_name(name: str, otherwise: str) -> str:
    """A name of letters, digits, points and dashes that begins with a letter."""
    said = NO_NAME.sub("_", name).strip("_")
    if not said:
        return otherwise
    return said if said[0].isalpha() else f"joint_{said}"


def _joint(name: str, row: Joint, parent: str, child: str) -> ElementTree.Element:
    """The element of one row of frames."""
    turns = row.type is JointType.REVOLUTE
    axis = np.array([0.0, 0.0, 1.0]) if row.axis is None else row.axis / np.linalg.norm(row.axis)
    origin = np.eye(4) if row.origin is None else row.origin
    if row.offset:
        moved = rotation_transform(axis, row.offset) if turns else translation_transform(row.offset * axis)
        origin = exact(origin @ moved)
    kind = "continuous" if turns and row.unlimited else str(row.type)
    joint = ElementTree.Element("joint", name=name, type=kind)
    ElementTree.SubElement(joint, "parent", link=parent)
    ElementTree.SubElement(joint, "child", link=child)
    if not np.array_equal(origin, np.eye(4)):
        ElementTree.SubElement(joint, "origin", xyz=_numbers(origin[:3, 3]), rpy=_numbers(rpy_exactly(origin[:3, :3])))
    if row.moves:
        ElementTree.SubElement(joint, "axis", xyz=_numbers(row.sense * axis + 0.0))
    if row.moves and kind != "continuous":
        low, high = (_numbers([min(max(limit, -LONGEST), LONGEST)]) for limit in row.limits)
        ElementTree.SubElement(joint, "limit", lower=low, upper=high, effort=EFFORT, velocity=VELOCITY)
    return joint


def _numbers(values: Array | tuple[float, ...] | list[float]) -> str:
    """Numbers with a blank between them, each with as many digits as it needs."""
    return " ".join(repr(float(value)).removesuffix(".0") for value in values)
