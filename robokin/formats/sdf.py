"""An SDF file to a tree of links.

What kinematics needs is read: models, links, joints, frames and their poses; shapes, masses, sensors and plugins are
passed over. Of several models that one is the robot in which most joints move.

Source: SDFormat specification 1.2 to 1.12.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from robokin.errors import DescriptionError, InputError, Note, counted, did_you_mean, shown
from robokin.files import open_path, read_up_to
from robokin.formats.faults import Faults
from robokin.formats.sdf_frames import NESTED, SdfFrame
from robokin.formats.sdf_models import SdfAxis, SdfJoint, SdfModel
from robokin.formats.snapped_angles import RoundedAngles
from robokin.formats.taken_names import TakenNames
from robokin.formats.xml_numbers import number_at
from robokin.formats.xml_tree import MAX_XML_BYTES, XmlNode, read_xml
from robokin.model.graph import Coupling, Graph, GraphJoint, Tip
from robokin.model.tree import Tree
from robokin.spatial import exact as cleaned
from robokin.spatial import invert, z_to

SDF_EXPECTED = "an SDF description (.sdf)"

VERSION = re.compile(r"\s*([0-9]{1,3})\.([0-9]{1,3})(?:\.[0-9]{1,3})?\s*")
OLDEST = (1, 2)

TYPES = {"prismatic": "prismatic", "screw": "helical"}
"""What is no revolute joint, of those with one freedom an axis."""

MOST_SHOWN = 8
"""Names that a note lists."""


def read_sdf(
    source: Path | bytes | str, place: str = "", exact: bool = False, id: str = "", *, balls: bool = False
) -> Tree:
    """The tree of links that an SDF file, or its text, describes; `place` is the name that errors give it.

    exact: angles in radians as they are written, also those plainly cut in print. balls: a ball joint is three revolute
    ones about x, y and z in turn, and no mistake. Raises one DescriptionError for all mistakes, InputError for a file
    that cannot be read.
    """
    place = place or (str(source) if isinstance(source, Path) else "description")
    if isinstance(source, Path):
        id = id or source.stem
        with open_path(str(source), SDF_EXPECTED) as stream:
            source = read_up_to(stream, place, MAX_XML_BYTES, SDF_EXPECTED)
    root = read_xml(source, place)
    faults = Faults()
    try:
        version = _version(root)
        notes: list[Note] = [*root.document.notes]
        rounded = RoundedAngles(exact)
        model = SdfModel(_chosen_model(root, notes), version, rounded, faults)
        maker = _SdfGraph(model, faults, balls)
        try:
            graph = maker.graph()
        except InputError as error:
            raise error if isinstance(error, DescriptionError) else model.top.node.error(str(error)) from None
    except DescriptionError as error:
        whole = faults.ended(error, "")
        for known in whole.errors:
            root.document.with_line(known)
        raise whole from None
    return Tree(model.top.name or id or "robot", graph, id=id, notes=(*notes, *maker.notes, *rounded.notes()))


def _version(root: XmlNode) -> tuple[int, int]:
    """The version of a file: what poses and axes are in depends on it. Raises DescriptionError."""
    if root.tag != "sdf":
        raise root.error(f"found <{shown(root.tag)}>, expected <sdf>")
    text = root.attributes.get("version", "")
    match = VERSION.fullmatch(text)
    if not match:
        raise root.error(f"found the version {shown(repr(text))}, expected one such as 1.7", "version")
    version = int(match[1]), int(match[2])
    if not OLDEST <= version < (2, 0):
        raise root.error(f"found the version {shown(text)}, expected 1.2 or later, below 2", "version")
    return version


def _chosen_model(root: XmlNode, notes: list[Note]) -> XmlNode:
    """The model with most joints that move; notes tell of others. Raises DescriptionError where there is none."""
    homes = [root, *root.all("world")]
    models = [model for home in homes for model in home.all("model")]
    includes = [node for home in homes for node in home.all("include")]
    if includes and not models:
        raise includes[0].error("found <include>, expected a model written out: robokin fetches no other file")
    if not models:
        raise root.error("found no <model>, expected one")
    for joint in (node for world in root.all("world") for node in world.all("joint")):
        raise joint.error("found a joint between models, expected joints in one model")
    chosen = max(models, key=_moving_joints)
    left = [shown(node.attributes.get("name", "")) for node in models if node is not chosen]
    if left or includes:
        names = ", ".join(left[:MOST_SHOWN] + ["…"] * (len(left) > MOST_SHOWN))
        others = " and ".join(filter(None, [names, "what is included" if includes else ""]))
        mark = chosen.mark
        message = f"the model {shown(chosen.attributes.get('name', ''))} is read; left out: {others}"
        notes.append(Note(message, mark.file, mark.line, mark.column))
    return chosen


def _moving_joints(model: XmlNode) -> int:
    """How many joints of a model and of those in it move."""
    own = sum(joint.attributes.get("type") != "fixed" for joint in model.all("joint"))
    return own + sum(_moving_joints(inner) for inner in model.all("model"))


class _SdfGraph:
    """Makes a graph of a model: the links that hang together by most freedoms."""

    def __init__(self, model: SdfModel, faults: Faults, balls: bool) -> None:
        self.model = model
        self.faults = faults
        self.balls = balls
        self.notes: list[Note] = []
        self.names = TakenNames()
        for kind, frames in (("link", model.links), ("joint", model.joint_frames)):
            for frame in frames:
                self.names.take(frame.node, kind, frame.name)
        self.above: dict[SdfFrame, SdfJoint] = {}
        self.links: list[str] = []
        self.link_of: dict[SdfFrame, int] = {}
        self.joints: list[GraphJoint] = []
        self.singles: dict[SdfFrame, list[str]] = {}

    def graph(self) -> Graph:
        """The graph. Raises DescriptionError."""
        self._join_links()
        root, kept = self._chosen()
        for frame in kept:
            self.link_of[frame] = len(self.links)
            self.links.append(self.names.free("link", frame.name) if frame is self.model.world else frame.name)
        for joint in self.model.joints:
            if joint.child in self.link_of:
                self.faults.attempt(None, self._add, joint)
        self.faults.stop()
        couplings = [found for joint in self.model.joints for found in self._couplings(joint)]
        self.faults.stop()
        base = self.model.top.local @ self.model.places.pose(root)
        graph = Graph(
            tuple(self.links), tuple(self.joints), self.link_of[root], cleaned(base), self._tips(kept), tuple(couplings)
        )
        _ = graph.value_map
        return graph

    def _join_links(self) -> None:
        """Note which joint holds each link; refuse a second one."""
        for joint in self.model.joints:
            if joint.parent is joint.child:
                self.faults.add(joint.frame.node.error("found a joint of a link with itself, expected two links"))
            elif joint.child in self.above:
                first = self.above[joint.child].frame
                message = (
                    f"found {shown(joint.child.name)} as the child of {shown(joint.frame.name)} and of "
                    f"{shown(first.name)}, which closes a loop, expected one joint above each link"
                )
                self.faults.add((joint.frame.node.first("child") or joint.frame.node).error(message))
            else:
                self.above[joint.child] = joint
        self.faults.stop()

    def _chosen(self) -> tuple[SdfFrame, list[SdfFrame]]:
        """The root of the robot, and its links in the order of the file."""
        tops: dict[SdfFrame, SdfFrame] = {}
        for frame in self.model.links:
            way: dict[SdfFrame, None] = {}
            while frame not in tops and frame in self.above:
                way[frame] = None
                tops[frame] = frame  # met again only in a circle
                frame = self.above[frame].parent
                if frame in way:
                    raise self.above[frame].frame.node.error(
                        f"found joints in a circle through {shown(frame.name)}, expected a tree"
                    )
            top = tops.get(frame, frame)
            tops |= dict.fromkeys([*way, frame], top)
        if not tops:
            raise self.model.top.node.error("found a model without links, expected some")
        counts: dict[SdfFrame, int] = dict.fromkeys(tops.values(), 0)
        for joint in self.model.joints:
            counts[tops[joint.child]] += joint.type != "fixed"
        root = max(counts, key=lambda top: counts[top])
        left = [frame for frame, top in tops.items() if top is not root]
        if left:
            names = ", ".join(shown(frame.name) for frame in left[:MOST_SHOWN]) + ", …" * (len(left) > MOST_SHOWN)
            message = f"{counted(len(left), 'link')} that no joint holds to {shown(root.name)} left out: {names}"
            mark = left[0].node.mark
            self.notes.append(Note(message, mark.file, mark.line, mark.column))
        return root, [root, *(frame for frame in self.model.links if tops[frame] is root and frame is not root)]

    def _add(self, joint: SdfJoint) -> None:
        """Add a joint, and the links between its axes. Raises DescriptionError for a ball, unless it may be three."""
        name = joint.frame.name
        places = self.model.places
        before = invert(places.pose(joint.parent)) @ joint.pose
        end = invert(joint.pose) @ places.pose(joint.child)
        parent, child = self.link_of[joint.parent], self.link_of[joint.child]
        axes = joint.axes
        if joint.type == "ball":
            if not self.balls:
                raise joint.frame.node.error(
                    f"found the ball joint {shown(name)}, expected joints with axes; with balls=True it is read as "
                    "three revolute ones about x, y and z in turn",
                    "type",
                )
            axes = [SdfAxis(direction, (-np.inf, np.inf)) for direction in np.eye(3)]
        if not axes:
            self.joints.append(
                GraphJoint(name, "fixed", parent, child, 0, before=cleaned(before @ end), row=len(self.joints))
            )
        letters = "xyz" if joint.type == "ball" else "123"
        several = [self.names.free("joint", f"{name}~{letter}") for letter in letters[: len(axes)]]
        self.singles[joint.frame] = several if len(axes) > 1 else [name]
        for place, axis in enumerate(axes):
            last = place == len(axes) - 1
            if not last:
                self.links.append(self.names.free("link", f"{joint.child.name}~{place + 1}"))
            A = z_to(axis.direction)
            self.joints.append(
                GraphJoint(
                    name=self.singles[joint.frame][place],
                    type=TYPES.get(joint.type, "revolute"),
                    parent=parent,
                    child=child if last else len(self.links) - 1,
                    before=cleaned(before @ A),
                    after=cleaned(invert(A) @ (end if last else np.eye(4))),
                    pitch=joint.pitch,
                    limits=axis.limits,
                    row=len(self.joints),
                )
            )
            parent, before = len(self.links) - 1, np.eye(4)

    def _couplings(self, joint: SdfJoint) -> list[Coupling]:
        """What a joint's axes mimic."""
        if joint.frame not in self.singles:
            return []
        found = [
            self.faults.attempt(None, self._coupling, joint, single, axis.mimic)
            for single, axis in zip(self.singles[joint.frame], joint.axes, strict=False)
            if axis.mimic is not None
        ]
        return [coupling for coupling in found if coupling is not None]

    def _coupling(self, joint: SdfJoint, follower: str, node: XmlNode) -> Coupling:
        """follower = multiplier (leader - reference) + offset. Raises DescriptionError."""
        name, axis = node.attributes.get("joint", ""), node.attributes.get("axis", "axis")
        scope = joint.frame.scope
        assert scope is not None
        known = {frame.name: names for frame, names in self.singles.items() if names}
        leaders = known.get(scope.prefix + name, ())
        place = ("axis", "axis2").index(axis) if axis in ("axis", "axis2") else len(leaders)
        if place >= len(leaders):
            hint = did_you_mean(name, [one.removeprefix(scope.prefix) for one in known if NESTED not in one])
            found = f"{shown(repr(name))}, {shown(repr(axis))}"
            raise node.error(f"found a mimic of the unknown axis {found}{hint or ', expected one of a joint'}", "joint")
        numbers = {
            tag: number_at(part.text, part.mark, f"<{tag}>") if (part := node.first(tag)) is not None else otherwise
            for tag, otherwise in (("multiplier", 1.0), ("offset", 0.0), ("reference", 0.0))
        }
        offset = numbers["offset"] - numbers["multiplier"] * numbers["reference"]
        return Coupling(follower, ((leaders[place], numbers["multiplier"]),), offset + 0.0)

    def _tips(self, kept: list[SdfFrame]) -> tuple[Tip, ...]:
        """The links that joints move and on which no other stands, else all those; by the frames on them, if any."""
        places = self.model.places
        parents = {joint.parent for joint in self.model.joints}
        leaves = [frame for frame in kept if frame not in parents]
        leaves = [frame for frame in leaves if self._is_moved(frame)] or leaves
        tips: list[Tip] = []
        frames: dict[SdfFrame, list[SdfFrame]] = {}
        for frame in self.model.frames:
            frames.setdefault(places.link(frame), []).append(frame)
        for leaf in leaves:
            on = frames.get(leaf, [])
            link = self.link_of[leaf]
            inverse = invert(places.pose(leaf))
            tips += [Tip(frame.name, link, cleaned(inverse @ places.pose(frame))) for frame in on]
            tips += [] if on else [Tip(leaf.name, link)]
        return tuple(tips)

    def _is_moved(self, frame: SdfFrame) -> bool:
        """Whether a joint between the root and a link moves."""
        while frame in self.above:
            joint = self.above[frame]
            if joint.type != "fixed":
                return True
            frame = joint.parent
        return False
