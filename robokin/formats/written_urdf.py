"""A robot as URDF, for programs that read no tables."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import numpy as np

from robokin.arrays import Array
from robokin.formats.description_lines import different_names
from robokin.formats.exact_numbers import rpy_exactly
from robokin.formats.node_values import LONGEST
from robokin.kinematics.dh_table import to_convention
from robokin.model import Joint, JointType, Robot, Tree
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
    root = urdf_root(robot)
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
        root.append(joint_element(name, row, links[i], links[i + 1]))
    return xml_text(root)


def urdf_root(described: Robot | Tree) -> ElementTree.Element:
    """The element `robot`, with a comment that says where the numbers come from."""
    root = ElementTree.Element("robot", name=valid_name(described.id or described.name, "robot"))
    said = "; ".join(part.rstrip(". ") for part in (described.name, described.source, REMARK) if part)
    said = "".join(letter if letter.isprintable() else " " for letter in said)
    root.append(ElementTree.Comment(f" {re.sub('-(?=-|$)', '- ', said)} "))
    return root


def xml_text(root: ElementTree.Element) -> str:
    """The text of a whole file, an element a line."""
    ElementTree.indent(root)
    return '<?xml version="1.0"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"


def valid_name(name: str, otherwise: str, first: str = "joint") -> str:
    """A name of letters, digits, points and dashes that begins with a letter, or with the word `first`."""
    said = NO_NAME.sub("_", name).strip("_")
    if not said:
        return otherwise
    return said if said[0].isalpha() else f"{first}_{said}"


def joint_element(
    name: str, row: Joint, parent: str, child: str, farthest: float = LONGEST
) -> ElementTree.Element:  # fmt: skip
    """The element of one row of frames, between two links; limits that it has not are as far [rad | m] as is said."""
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
        ElementTree.SubElement(
            joint, "origin", xyz=numbers_text(origin[:3, 3]), rpy=numbers_text(rpy_exactly(origin[:3, :3]))
        )
    if row.moves:
        ElementTree.SubElement(joint, "axis", xyz=numbers_text(row.sense * axis + 0.0))
    if row.moves and kind != "continuous":
        low, high = (numbers_text([min(max(limit, -farthest), farthest)]) for limit in row.limits)
        ElementTree.SubElement(joint, "limit", lower=low, upper=high, effort=EFFORT, velocity=VELOCITY)
    return joint


def numbers_text(values: Array | tuple[float, ...] | list[float]) -> str:
    """Numbers with a blank between them, each with as many digits as it needs."""
    return " ".join(repr(float(value)).removesuffix(".0") for value in values)
