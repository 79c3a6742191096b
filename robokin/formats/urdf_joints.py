"""One joint of a URDF: its type, its links, its frame, its axis and its limits.

Source: ROS wiki, urdf/XML/joint, and urdfdom's joint.cpp, whose defaults these are.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from robokin.arrays import Array
from robokin.errors import Note, did_you_mean, shown
from robokin.formats.faults import Faults
from robokin.formats.snapped_angles import RoundedAngles, listed_joints
from robokin.formats.xml_numbers import number_of, numbers_of
from robokin.formats.xml_tree import XmlNode
from robokin.spatial import rotation_from_rpy, transform
from robokin.spatial.transforms import FARTHEST

KINDS = {
    "revolute": "revolute",
    "continuous": "revolute",
    "prismatic": "prismatic",
    "fixed": "fixed",
    "floating": "floating",
    "planar": "planar",
}
"""A joint's kind in a tree by its type in a URDF."""

FREE = {"floating": 6, "planar": 3}
"""The freedoms of joints that are more than one."""


SNAP_SAID = 1e-9
"""An angle [rad] that is moved by less than this is moved without a note."""


@dataclass(eq=False)
class UrdfJoint:
    """A joint as it stands in the file, with all its values but those of other joints."""

    name: str
    kind: str
    parent: str
    child: str
    node: XmlNode
    origin: Array
    axis: Array
    limits: tuple[float, float] = (-np.inf, np.inf)

    @property
    def moves(self) -> bool:
        """Whether it has a value."""
        return self.kind in ("revolute", "prismatic")


@dataclass(eq=False)
class UrdfReading:
    """What has been found on the way: mistakes, notes, and names that one note is written for."""

    exact: bool
    faults: Faults = field(default_factory=Faults)
    notes: list[Note] = field(default_factory=list)
    unlimited: list[tuple[str, XmlNode]] = field(default_factory=list)
    halved: list[tuple[str, XmlNode]] = field(default_factory=list)
    turning: list[tuple[str, XmlNode]] = field(default_factory=list)

    @cached_property
    def rounded(self) -> RoundedAngles:
        """The angles that are taken as what was meant."""
        return RoundedAngles(self.exact, SNAP_SAID)

    def note(self, node: XmlNode, message: str) -> None:
        """Keep a note at a node."""
        mark = node.mark
        self.notes.append(Note(message, mark.file, mark.line, mark.column))

    def gathered(self) -> tuple[Note, ...]:
        """All notes, one for each kind of thing that happened at several joints."""
        self.notes += self.rounded.notes()
        for found, start in (
            (self.unlimited, "no limits are given, and none are taken, for"),
            (self.halved, "one limit is missing, and is taken as 0 as URDF has it, for"),
            (self.turning, "limits are ignored, as the joint is continuous, for"),
        ):
            if found:
                self.note(found[0][1], f"{start} {listed_joints([*dict(found)])}")
        return tuple(sorted(self.notes, key=lambda note: (note.line, note.column)))


def name_of(node: XmlNode) -> str:
    """A link's or a joint's name. Raises DescriptionError for none, and for one that would steer a terminal."""
    name = node.attributes.get("name", "")
    if not name.strip():
        raise node.error(f'found a <{node.tag}> without a name, expected name="…"', "name")
    if not name.isprintable():
        raise node.error(f"found the name '{shown(name)}', expected one of printable characters", "name")
    return name


def read_joint(node: XmlNode, links: Mapping[str, XmlNode], reading: UrdfReading) -> UrdfJoint:
    """One joint. Raises DescriptionError."""
    name = name_of(node)
    type = node.attributes.get("type", "")
    if type not in KINDS:
        found = f"the type '{shown(type)}'" if type else "no type"
        expected = did_you_mean(type, KINDS) or ", expected revolute, continuous, prismatic or fixed"
        raise node.error(f"found {found} of joint '{shown(name)}'{expected}", "type")
    parent, child = (_link_of(node, name, end, links) for end in ("parent", "child"))
    if parent == child:
        raise node.error(f"found link '{shown(child)}' as its own parent in joint '{shown(name)}', expected two links")
    joint = UrdfJoint(
        name, KINDS[type], parent, child, node, _read_origin(node, name, reading), np.array([1.0, 0.0, 0.0])
    )
    if joint.moves:
        joint.axis = _read_axis(node, name, reading)
        joint.limits = _read_limits(node, name, type, reading)
    return joint


def _link_of(node: XmlNode, joint: str, end: str, links: Mapping[str, XmlNode]) -> str:
    """The link that a joint's `parent` or `child` names."""
    inner = node.first(end)
    if inner is None or "link" not in inner.attributes:
        raise (inner or node).error(f"found joint '{shown(joint)}' without a {end}, expected <{end} link=\"…\"/>")
    name = inner.attributes["link"]
    if name not in links:
        expected = did_you_mean(name, links) or ", expected the name of a <link>"
        raise inner.error(
            f"found the unknown link '{shown(name)}' as {end} of joint '{shown(joint)}'{expected}", "link"
        )
    return name


def single_child(node: XmlNode, tag: str, joint: str, reading: UrdfReading) -> XmlNode | None:
    """A child of which there should be one: the first, as other programs take it."""
    found = node.all(tag)
    if len(found) > 1 and any(other.attributes != found[0].attributes for other in found):
        reading.note(found[1], f"found a second <{tag}> in joint '{shown(joint)}', the first is taken")
    return found[0] if found else None


def _vector(node: XmlNode, attribute: str, reading: UrdfReading) -> tuple[float, ...]:
    """Three numbers, none beyond what is a length."""
    values = numbers_of(node, attribute, 3, reading.notes)
    if max(map(abs, values)) > FARTHEST:
        raise node.error(f"found '{shown(node.attributes[attribute])}', expected numbers up to {FARTHEST:g}", attribute)
    return values


def _read_origin(node: XmlNode, joint: str, reading: UrdfReading) -> Array:
    """The joint's frame (4, 4) [m] in its parent's."""
    origin = single_child(node, "origin", joint, reading)
    xyz: tuple[float, ...] = (0.0, 0.0, 0.0)
    rpy = xyz
    if origin is not None and "xyz" in origin.attributes:
        xyz = _vector(origin, "xyz", reading)
    if origin is not None and "rpy" in origin.attributes:
        rpy = _vector(origin, "rpy", reading)
        words = origin.attributes["rpy"].replace(",", " ").split()
        rpy = tuple(reading.rounded.meant(a, word, origin.mark, joint) for a, word in zip(rpy, words, strict=False))
    return transform(rotation_from_rpy(rpy), xyz)


def _read_axis(node: XmlNode, joint: str, reading: UrdfReading) -> Array:
    """The joint's axis (3,) in its frame, of any length but zero."""
    axis = single_child(node, "axis", joint, reading)
    if axis is None or "xyz" not in axis.attributes:
        return np.array([1.0, 0.0, 0.0])
    values = np.array(_vector(axis, "xyz", reading))
    size = float(np.max(np.abs(values)))
    if size == 0.0:
        raise axis.error(f"found the axis 0 0 0 of joint '{shown(joint)}', expected a direction such as 0 0 1", "xyz")
    return values / size


def _read_limits(node: XmlNode, joint: str, type: str, reading: UrdfReading) -> tuple[float, float]:
    """Least and greatest value [rad | m], ±inf where there is none."""
    limit = single_child(node, "limit", joint, reading)
    given = [word for word in ("lower", "upper") if limit is not None and word in limit.attributes]
    if limit is None or not given:
        if type != "continuous" and node.first("mimic") is None:
            reading.unlimited.append((joint, limit or node))
        return -np.inf, np.inf
    lower, upper = (number_of(limit, word, 0.0) for word in ("lower", "upper"))
    if type == "continuous":
        if lower != upper:  # 0 and 0 stand there as a rule, and mean nothing
            reading.turning.append((joint, limit))
        return -np.inf, np.inf
    if len(given) == 1:
        reading.halved.append((joint, limit))
    if lower > upper:
        raise limit.error(
            f"found the lower limit {lower:g} above the upper {upper:g} of joint '{shown(joint)}', expected the lower "
            "first; without lower and upper there is no limit",
            given[0],
        )
    return (lower if lower > -FARTHEST else -np.inf), (upper if upper < FARTHEST else np.inf)


def mimic_factors(mimic: XmlNode) -> tuple[float, float]:
    """Multiplier and offset."""
    values = number_of(mimic, "multiplier", 1.0), number_of(mimic, "offset", 0.0)
    for name, value in zip(("multiplier", "offset"), values, strict=True):
        if abs(value) > FARTHEST:
            raise mimic.error(f"found the {name} {value:g}, expected one up to {FARTHEST:g}", name)
    return values
