"""The bodies of a MuJoCo file, one under another, with the joints and sites in them.

A body's joints move it one after the other, in the order of the file, the parent's side first; each turns about, or
slides along, an axis that is fixed in the body. A `<frame>` only moves what stands in it.

Source: MuJoCo 4.0, XML reference, `body`, `joint`, `frame`; what it leaves open was tried with mujoco 4.0.0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from robokin.arrays import Array
from robokin.errors import Note, did_you_mean, or_list, shown
from robokin.formats.faults import Faults
from robokin.formats.mjcf_settings import MAIN, NO_LENGTH, MjcfClasses, MjcfPoses, choice_of, flag_of, values_of
from robokin.formats.taken_names import TakenNames
from robokin.formats.xml_tree import XmlNode
from robokin.spatial import translation_transform, z_to

WORLD = "world"
"""The body in which all others stand."""

SKIPPED = ("geom", "inertial", "camera", "light", "plugin")
"""Elements of a body that move nothing."""

GENERATING = ("composite", "flexcomp", "replicate", "attach")
"""Elements that MuJoCo makes bodies of."""

READ = ("body", "joint", "freejoint", "site", "frame")

MOST_BODIES = 5000
MOST_JOINTS = 2000
MOST_SITES = 5000
"""Bodies, joints and sites of one file; a humanoid with two hands has some 100."""


@dataclass(eq=False)
class MjcfJoint:
    """A joint in a body: its axis (3,) and a point (3,) [m] on it in the body's frame; `ref` [rad | m] is its value in
    the pose of the file. address: the place of its first value in MuJoCo's qpos.
    """

    name: str
    type: str
    node: XmlNode
    axis: Array
    point: Array
    ref: float = 0.0
    limits: tuple[float, float] = (-math.inf, math.inf)
    address: int = 0


@dataclass(eq=False)
class MjcfSite:
    """A named frame in a body: its pose (4, 4) [m]."""

    name: str
    pose: Array


@dataclass(eq=False)
class MjcfBody:
    """A body: its parent by its number, its pose (4, 4) [m] in the parent's frame, and what is in it.

    free: whether it floats; mocap: whether the user of a simulation places it.
    """

    name: str
    node: XmlNode
    parent: int
    pose: Array
    joints: list[MjcfJoint] = field(default_factory=list)
    sites: list[MjcfSite] = field(default_factory=list)
    free: bool = False
    free_name: str = ""
    free_address: int = 0
    mocap: bool = False


@dataclass(frozen=True)
class _Standing:
    """Where elements stand: in a body by its number, in a frame (4, 4) [m] of it, under a class of defaults."""

    body: int
    frame: Array
    childclass: str


class MjcfBodies:
    """Reads the bodies of a file; mistakes are gathered in `faults`."""

    def __init__(self, world: XmlNode, poses: MjcfPoses, classes: MjcfClasses, faults: Faults) -> None:
        self.poses = poses
        self.classes = classes
        self.faults = faults
        self.found = [MjcfBody(WORLD, world, -1, np.eye(4))]
        self.notes: list[Note] = []
        self.values = 0
        self.joints = 0
        self.sites = 0
        self.names = TakenNames()
        self.names.take(world, "body", WORLD)

    def read(self, section: XmlNode) -> None:
        """Read a `<worldbody>`."""
        self._read_inside(section, _Standing(0, np.eye(4), MAIN))

    def finish(self) -> None:
        """Give what has no name one that is no other's; count the values of MuJoCo's qpos, body by body."""
        unnamed_joints = 0
        for number, body in enumerate(self.found):
            body.name = body.name or self.names.free("body", f"body~{number}")
            for joint in body.joints:
                unnamed_joints += 1
                joint.name = joint.name or self.names.free("joint", f"joint~{unnamed_joints}")
                joint.address = self.values
                self.values += 4 if joint.type == "ball" else 1
            if body.free:
                body.free_address = self.values
                self.values += 7

    def _read_inside(self, node: XmlNode, standing: _Standing) -> None:
        for child in node.children:
            self.faults.attempt(None, self._read_one, child, standing)

    def _read_one(self, node: XmlNode, standing: _Standing) -> None:
        if node.tag == "body":
            self._read_body(node, standing)
        elif node.tag == "frame":
            frame = standing.frame @ self.poses.pose_of(node)
            childclass = self.classes.expect(node, "childclass", standing.childclass)
            self._read_inside(node, _Standing(standing.body, frame, childclass))
        elif node.tag in ("joint", "freejoint"):
            self._read_joint(node, standing)
        elif node.tag == "site":
            self._read_site(node, standing)
        elif node.tag in GENERATING:
            self._pass_over(node)
        elif node.tag not in SKIPPED:
            known = (*READ, *SKIPPED, *GENERATING)
            hint = did_you_mean(node.tag, known) or f", expected {or_list(READ)}"
            raise node.error(f"found <{shown(node.tag)}> in a body{hint}")

    def _read_body(self, node: XmlNode, standing: _Standing) -> None:
        if len(self.found) >= MOST_BODIES:
            self._end(node, f"found more than {MOST_BODIES} bodies, expected a robot")
        name = self.names.take(node, "body", node.attributes.get("name", ""))
        pose = self.faults.attempt(np.eye(4), self.poses.pose_of, node)
        childclass = self.faults.attempt(
            standing.childclass, self.classes.expect, node, "childclass", standing.childclass
        )
        body = MjcfBody(name, node, standing.body, standing.frame @ pose)
        body.mocap = flag_of(node, "mocap", False)
        self.found.append(body)
        self._read_inside(node, _Standing(len(self.found) - 1, np.eye(4), childclass))
        self._check_joints(body)

    def _check_joints(self, body: MjcfBody) -> None:
        """Refuse what MuJoCo does of several joints in a body."""
        if body.free and body.joints:
            raise body.joints[0].node.error(f"found a joint beside the free one of {shown(body.name)}, expected none")
        if body.free and body.parent != 0:
            raise body.node.error(f"found {shown(body.name)} floating within another body, expected it in the world")

    def _read_joint(self, node: XmlNode, standing: _Standing) -> None:
        body = self.found[standing.body]
        if standing.body == 0:
            raise node.error("found a joint of the world, expected joints in bodies")
        self.joints += 1
        if self.joints > MOST_JOINTS:
            self._end(node, f"found more than {MOST_JOINTS} joints, expected a robot")
        full = self.classes.filled(node, standing.childclass) if node.tag == "joint" else node
        types = ("hinge", "slide", "ball", "free")
        kind = "free" if node.tag == "freejoint" else choice_of(full, "type", types, "hinge")
        name = self.names.take(node, "joint", node.attributes.get("name", ""))
        if kind == "free":
            if body.free:
                raise node.error(f"found two free joints in {shown(body.name)}, expected one")
            body.free, body.free_name = True, name
            return
        R = standing.frame[:3, :3]
        axis = np.array(values_of(full, "axis", 3) or (0.0, 0.0, 1.0))
        length = math.hypot(*axis)
        if length < NO_LENGTH and kind != "ball":
            raise full.error("found an axis of length zero, expected a direction", "axis")
        point = np.array(values_of(full, "pos", 3) or (0.0, 0.0, 0.0))
        body.joints.append(
            MjcfJoint(
                name=name,
                type=kind,
                node=full,
                axis=R @ (axis / length) if length >= NO_LENGTH else np.array([0.0, 0.0, 1.0]),
                point=R @ point + standing.frame[:3, 3],
                ref=self._measured(kind, (values_of(full, "ref", 1) or (0.0,))[0]),
                limits=self._limits(full, kind),
            )
        )

    def _measured(self, kind: str, value: float) -> float:
        """A joint's value in the file's unit [rad | m]."""
        return value if kind == "slide" else self.poses.compiler.angle(value)

    def _limits(self, node: XmlNode, kind: str) -> tuple[float, float]:
        """A joint's limits [rad | m]: its `range`, where it is limited. Raises DescriptionError."""
        free = (-math.inf, math.inf)
        low, high = values_of(node, "range", 2) or (0.0, 0.0)
        limited = choice_of(node, "limited", ("true", "false", "auto"), "auto")
        if limited == "false":
            return free
        if limited == "true" and low >= high:
            found = f"the range {low:g} .. {high:g}" if "range" in node.attributes else 'limited="true" without a range'
            raise node.error(f"found {found}, expected its least and its greatest value", "range")
        if limited == "auto" and not self.poses.compiler.autolimits and low < high:
            self._note(node, "range", "found a range and neither limited nor autolimits, taken as no limits")
            return free
        if low > high:
            self._note(node, "range", f"found the range {low:g} .. {high:g} the wrong way round, taken as no limits")
        if low >= high:
            return free
        return self._measured(kind, low), self._measured(kind, high)

    def _note(self, node: XmlNode, key: str, message: str) -> None:
        place = node.place_of(key)
        self.notes.append(Note(message, place.file, place.line, place.column))

    def _end(self, node: XmlNode, message: str) -> None:
        """Raise DescriptionError for what ends the reading: more of its kind would be no news."""
        self.faults.add(node.error(message))
        self.faults.stop()

    def _read_site(self, node: XmlNode, standing: _Standing) -> None:
        self.sites += 1
        if self.sites > MOST_SITES:
            self._end(node, f"found more than {MOST_SITES} sites, expected a robot")
        name = self.names.take(node, "site", node.attributes.get("name", ""))
        full = self.classes.filled(node, standing.childclass)
        pose = self._along(full) if full.attributes.get("fromto", "").strip() else self.poses.pose_of(full)
        if name:
            self.found[standing.body].sites.append(MjcfSite(name, standing.frame @ pose))

    def _along(self, node: XmlNode) -> Array:
        """The pose (4, 4) [m] of a site that is told by two points: its middle, with z from the second to the first."""
        ends = np.array(values_of(node, "fromto", 6))
        along = ends[:3] - ends[3:]
        if math.hypot(*along) < NO_LENGTH:
            raise node.error("found two equal points, expected a line from one to another", "fromto")
        return translation_transform(0.5 * (ends[:3] + ends[3:])) @ z_to(along)

    def _pass_over(self, node: XmlNode) -> None:
        """Refuse an element that makes bodies; what it makes otherwise moves nothing."""
        if node.tag != "replicate" or any(
            _holds(node, tag) for tag in ("body", "site", "joint", "freejoint", "attach")
        ):
            raise node.error(
                f"found <{node.tag}>, which makes bodies by a rule, expected every body written out: "
                "MuJoCo saves a file so (mj_saveLastXML)"
            )


def _holds(node: XmlNode, tag: str) -> bool:
    return any(child.tag == tag or _holds(child, tag) for child in node.children)
