"""The models of an SDF file: what is in them, the joints they have, and which of them is the robot.

Source: SDFormat specification 1.0 to 1.12.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.errors import did_you_mean, or_list, shown
from robokin.formats.faults import Faults
from robokin.formats.sdf_frames import MODEL, NESTED, SDF_WORLD, SdfFrame, SdfPlaces, SdfScope, pose_in
from robokin.formats.snapped_angles import RoundedAngles
from robokin.formats.xml_numbers import number_at, numbers_at
from robokin.formats.xml_tree import XmlNode
from robokin.spatial import invert

UNLIMITED = 1e16
"""A limit so far off is none."""

AXES = {
    "revolute": 1,
    "continuous": 1,
    "prismatic": 1,
    "screw": 1,
    "fixed": 0,
    "universal": 2,
    "revolute2": 2,
    "ball": 3,
}
"""The types of joints, and the freedoms that each has."""

SHORTEST_AXIS = 1e-12

MOST_LINKS = 5000
MOST_JOINTS = 2000
MOST_FRAMES = 20_000
"""Links, joints and frames of one file, models within models with the frames; a humanoid with two hands has some 100
links."""


@dataclass(eq=False)
class SdfAxis:
    """One freedom of a joint: its direction (3,) in the joint's frame, limits [rad | m], what it mimics."""

    direction: Array
    limits: tuple[float, float]
    mimic: XmlNode | None = None


@dataclass(eq=False)
class SdfJoint:
    """A joint of two links; pose: (4, 4) [m] in the outermost model. pitch [m/rad]: of a screw."""

    frame: SdfFrame
    type: str
    parent: SdfFrame
    child: SdfFrame
    pose: Array
    axes: list[SdfAxis]
    pitch: float = 0.0


class SdfModel:
    """Reads a model and the models in it; mistakes are gathered in `faults`."""

    def __init__(self, node: XmlNode, version: tuple[int, int], rounded: RoundedAngles, faults: Faults) -> None:
        self.version = version
        self.rounded = rounded
        self.faults = faults
        self.links: list[SdfFrame] = []
        self.frames: list[SdfFrame] = []
        self.joint_frames: list[SdfFrame] = []
        pose, _ = pose_in(node, rounded)
        self.top = SdfFrame(node.attributes.get("name", ""), "model", node, None, pose)
        self.world = SdfFrame(SDF_WORLD, SDF_WORLD, node, None, invert(pose))
        self.places = SdfPlaces(self.top, self.world)
        self.scope = SdfScope("", self.top)
        self.top.inside = self.scope
        _refuse_too_many(node)
        self._collect(node, self.scope)
        faults.stop()
        self.joints = [joint for frame in self.joint_frames if (joint := faults.attempt(None, self._joint, frame))]
        faults.stop()

    def _collect(self, model: XmlNode, scope: SdfScope) -> None:
        """Read the names and poses of what is in a model."""
        for node in model.children:
            if node.tag in ("link", "joint", "frame", "model"):
                self.faults.attempt(None, self._add, node, scope)
            elif node.tag == "include":
                raise node.error("found <include>, expected a model written out: robokin fetches no other file")

    def _add(self, node: XmlNode, scope: SdfScope) -> None:
        name = node.attributes.get("name", "")
        if not name:
            raise node.error(f"found a <{node.tag}> without a name, expected one")
        if name in scope.names and scope.names[name].kind == node.tag:
            raise node.error(f"found the {node.tag} {shown(repr(name))} twice, expected different names", "name")
        pose, towards = self.faults.attempt((np.eye(4), ""), pose_in, node, self.rounded)
        if self.version < (1, 7):
            towards = ""  # until then what a pose was in was fixed
        frame = SdfFrame(scope.prefix + name, node.tag, node, scope, pose, towards, scope.own)
        if node.tag == "model":
            self._add_model(node, frame, scope, name)
        elif node.tag == "link":
            self.links.append(frame)
            scope.links.append(frame)
        elif node.tag == "frame":
            frame.holder = node.attributes.get("attached_to", "")
            frame.towards = towards or frame.holder
            self.frames.append(frame)
        else:
            frame.holder = _text_in(node, "child")
            frame.towards = towards or frame.holder
            self.joint_frames.append(frame)
        if name not in scope.names or node.tag == "link":  # until 1.6 a joint may be called as a link is
            scope.names[name] = frame

    def _add_model(self, node: XmlNode, frame: SdfFrame, scope: SdfScope, name: str) -> None:
        inner = SdfScope(frame.name + NESTED, frame)
        scope.scopes[name] = frame.inside = inner
        self._collect(node, inner)
        if placement := node.attributes.get("placement_frame", ""):
            self.places.placed[frame] = inner.find(placement, node, "placement_frame")

    def _joint(self, frame: SdfFrame) -> SdfJoint:
        """A joint with its links and axes. Raises DescriptionError."""
        node, scope = frame.node, frame.scope
        assert scope is not None
        kind = node.attributes.get("type", "")
        if kind not in AXES:
            hint = did_you_mean(kind, AXES) or f", expected {or_list(AXES)}"
            raise node.error(f"found the type {shown(repr(kind))}{hint}", "type")
        parent, child = (
            self.places.link(scope.find(_text_in(node, tag), node.first(tag) or node, world=self.world))
            for tag in ("parent", "child")
        )
        if child is self.world:
            raise node.error("found the world as a joint's child, expected a link")
        pose = self.places.pose(frame)
        axes = [self._axis(frame, tag, kind, pose) for tag in ("axis", "axis2")[: AXES[kind] if kind != "ball" else 0]]
        return SdfJoint(frame, kind, parent, child, pose, axes, _pitch(node) if kind == "screw" else 0.0)

    def _axis(self, frame: SdfFrame, tag: str, kind: str, pose: Array) -> SdfAxis:
        """One of a joint's axes. Raises DescriptionError."""
        axis = frame.node.first(tag)
        if axis is None:
            raise frame.node.error(f"found a {kind} joint without <{tag}>, expected it")
        xyz = axis.first("xyz")
        direction = np.array([0.0, 0.0, 1.0])
        if xyz is not None and xyz.text.strip():
            direction = np.array(numbers_at(xyz.text, xyz.mark, "the axis", 3, []))
        length = math.hypot(*direction)
        if length < SHORTEST_AXIS:
            raise (xyz or axis).error("found an axis of length zero, expected a direction")
        turned = self._axis_frame(frame, axis, xyz)
        if turned is not None:
            direction = pose[:3, :3].T @ self.places.pose(turned)[:3, :3] @ direction
        limits = (-math.inf, math.inf) if kind == "continuous" else _limits(axis)
        return SdfAxis(direction / length, limits, axis.first("mimic"))

    def _axis_frame(self, frame: SdfFrame, axis: XmlNode, xyz: XmlNode | None) -> SdfFrame | None:
        """The frame that an axis is expressed in, None for the joint's own.

        Until 1.4 it is that of the model, in 1.5 and 1.6 where a flag says so, since then the one that is named.
        """
        assert frame.scope is not None
        if self.version >= (1, 7):
            name = xyz.attributes.get("expressed_in", "") if xyz is not None else ""
            return frame.scope.find(name, xyz or axis, "expressed_in", self.world) if name else None
        if self.version >= (1, 5) and _text_in(axis, "use_parent_model_frame", "false") not in ("true", "1"):
            return None
        return frame.scope.find(MODEL, axis)


def _refuse_too_many(model: XmlNode) -> None:
    """Raise DescriptionError for a model of far more parts than a robot has, those of models within it counted."""
    counts = {"link": 0, "joint": 0, "frame": 0, "model": 0}
    most = {"link": MOST_LINKS, "joint": MOST_JOINTS, "frame": MOST_FRAMES, "model": MOST_FRAMES}
    waiting = [model]
    while waiting:
        for node in waiting.pop().children:
            if node.tag not in counts:
                continue
            counts[node.tag] += 1
            if counts[node.tag] > most[node.tag]:
                raise node.error(f"found more than {most[node.tag]} {node.tag}s, expected a robot")
            if node.tag == "model":
                waiting.append(node)


def _text_in(node: XmlNode, tag: str, otherwise: str = "") -> str:
    """The text of an element in another, without blanks around it."""
    child = node.first(tag)
    return child.text.strip() if child is not None else otherwise


def _limits(axis: XmlNode) -> tuple[float, float]:
    """The limits of an axis [rad | m]. Raises DescriptionError for a least value above the greatest."""
    limit = axis.first("limit")
    ends = [-math.inf, math.inf]
    for place, tag in enumerate(("lower", "upper")):
        node = limit.first(tag) if limit is not None else None
        text = node.text.strip() if node is not None else ""
        if node is None or not text or text.lower().lstrip("+-") in ("inf", "infinity"):
            continue
        value = number_at(text, node.mark, f"<{tag}>")
        ends[place] = value if abs(value) < UNLIMITED else math.copysign(math.inf, value)
    if limit is not None and (ends[0] > ends[1] or ends[0] == math.inf or ends[1] == -math.inf):
        raise limit.error(f"found the limits {ends[0]:g} .. {ends[1]:g}, expected the lower one first")
    return ends[0], ends[1]


def _pitch(node: XmlNode) -> float:
    """A screw's advance [m/rad]. Raises DescriptionError.

    `screw_thread_pitch` is metres a turn, right-handed; the older `thread_pitch` radians a metre, left-handed.
    """
    new, old = node.first("screw_thread_pitch"), node.first("thread_pitch")
    if new is not None:
        return number_at(new.text, new.mark, "<screw_thread_pitch>") / (2.0 * math.pi)
    if old is None:
        raise node.error("found a screw joint without <screw_thread_pitch>, expected it")
    value = number_at(old.text, old.mark, "<thread_pitch>")
    if value == 0.0:
        raise old.error("found a thread pitch of zero radians a metre, expected another number")
    return -1.0 / value
