"""A URDF text to a tree of links.

A joint is Trans(xyz) RPY(rpy) and then its motion about or along its axis, lengths in metres and angles in radians.
Only what moves links is read: the children `link` and `joint` of `robot`; meshes, inertia, transmissions and control
are skipped.

Source: ROS wiki, urdf/XML/joint, and urdfdom's joint.cpp, whose defaults these are.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from robokin.arrays import Array
from robokin.errors import DescriptionError, InputError, Note, counted, did_you_mean, shown
from robokin.formats.faults import Faults
from robokin.formats.snapped_angles import snapped_angle
from robokin.formats.tool_names import default_tips
from robokin.formats.xml_numbers import number_of, numbers_of
from robokin.formats.xml_tree import XmlNode, XmlText, read_xml
from robokin.model.graph import Coupling, Graph, GraphJoint
from robokin.model.tree import Tree
from robokin.spatial import exact as whole_entries
from robokin.spatial import invert, rotation_from_rpy, transform, z_to
from robokin.spatial.transforms import FARTHEST

MAX_LINKS = 2000
"""Links of a tree; a humanoid with two hands has 150."""

MOST_NAMED = 12
"""Names that a message lists."""

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

NAMELESS = "robot"


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
    snapped: list[tuple[str, XmlNode]] = field(default_factory=list)
    unlimited: list[tuple[str, XmlNode]] = field(default_factory=list)
    halved: list[tuple[str, XmlNode]] = field(default_factory=list)
    turning: list[tuple[str, XmlNode]] = field(default_factory=list)

    def note(self, node: XmlNode, message: str) -> None:
        """Keep a note at a node."""
        mark = node.mark
        self.notes.append(Note(message, mark.file, mark.line, mark.column))

    def gathered(self) -> tuple[Note, ...]:
        """All notes, one for each kind of thing that happened at several joints."""
        for found, start, end in (
            (self.snapped, "angles cut in print are taken as multiples of 15° in", "(--exact takes them as written)"),
            (self.unlimited, "no limits are given, and none are taken, for", ""),
            (self.halved, "one limit is missing, and is taken as 0 as URDF has it, for", ""),
            (self.turning, "limits are ignored, as the joint is continuous, for", ""),
        ):
            if found:
                names = _listed([name for name, _ in dict(found).items()])
                self.note(found[0][1], f"{start} {names} {end}".strip())
        return tuple(sorted(self.notes, key=lambda note: (note.line, note.column)))


def read_urdf(data: bytes | str, place: str, exact: bool = False, id: str = "") -> Tree:
    """The tree of links that a URDF text describes; `place` is the name that errors give it.

    Angles that are multiples of 15° cut in print are taken as meant, with a note, unless they are to be `exact`. The
    tips are the last links, those that are called tools first; every other link may be asked for by its name.
    Raises one DescriptionError for all mistakes, with their lines and columns.
    """
    return tree_of_urdf(read_xml(data, place), exact, id)


def tree_of_urdf(
    root: XmlNode, exact: bool = False, id: str = "", texts: Sequence[XmlText] = (), least_joints: int = 0
) -> Tree:
    """The tree of links of a `robot` element that has so many joints at least; `texts`: all that its nodes stand in.

    Raises DescriptionError.
    """
    reading = UrdfReading(exact)
    files = {text.file: text for text in (root.document, *texts)}
    try:
        tree = _read_robot(root, reading, id, least_joints)
    except DescriptionError as error:
        whole = reading.faults.ended(error, "")
        for one in whole.errors:
            files[one.file].with_line(one)
        raise whole from None
    return tree


def _read_robot(root: XmlNode, reading: UrdfReading, id: str, least_joints: int) -> Tree:
    """The tree. Raises DescriptionError."""
    if root.tag != "robot":
        raise root.error(f"found <{shown(root.tag)}>, expected <robot>, as a URDF begins")
    if macro := next((child for child in root.children if child.tag.startswith("xacro:")), None):
        raise macro.error(f"found <{shown(macro.tag)}>, expected a URDF without macros: name the file .xacro")
    links = _read_links(root, reading.faults)
    joints = _read_joints(root, links, reading)
    if len(joints) < least_joints and not reading.faults.found:
        raise root.error(f"found {counted(len(joints), '<joint>')} in <robot>, expected at least {least_joints}")
    couplings = _read_mimics(joints, reading)
    reading.faults.stop()
    joints, base = _from_root(joints, links, reading)
    kept = {base} | {joint.child for joint in joints}
    links = {name: node for name, node in links.items() if name in kept}
    couplings = [coupling for coupling in couplings if any(joint.name == coupling.joint for joint in joints)]
    name = root.attributes.get("name", "").strip()
    names = [*links]
    numbers = {link: number for number, link in enumerate(names)}
    graph_joints = tuple(_graph_joint(joint, row, numbers) for row, joint in enumerate(joints))
    try:
        graph = Graph(
            tuple(names),
            graph_joints,
            numbers[base],
            tips=default_tips(names, graph_joints),
            couplings=tuple(couplings),
        )
    except InputError as error:
        raise root.error(str(error)) from None
    return Tree(name or id or NAMELESS, graph, id=id, notes=reading.gathered())


def _read_links(root: XmlNode, faults: Faults) -> dict[str, XmlNode]:
    """The links' nodes by name. Raises DescriptionError where there is none, or far too many."""
    links: dict[str, XmlNode] = {}
    nodes = root.all("link")
    if not nodes:
        raise root.error("found no <link> in <robot>, expected the links of a robot; a file of macros alone has none")
    if len(nodes) > MAX_LINKS:
        raise nodes[MAX_LINKS].error(f"found {len(nodes)} links, expected at most {MAX_LINKS}")
    for node in nodes:
        name = faults.attempt("", _name_of, node)
        if name and name in links:
            first = links[name].mark.line
            faults.add(
                node.error(f"found a second link '{shown(name)}', expected another name than line {first}'s", "name")
            )
        elif name:
            links[name] = node
    return links


def _name_of(node: XmlNode) -> str:
    name = node.attributes.get("name", "")
    if not name.strip():
        raise node.error(f'found a <{node.tag}> without a name, expected name="…"', "name")
    return name


def _read_joints(root: XmlNode, links: Mapping[str, XmlNode], reading: UrdfReading) -> list[UrdfJoint]:
    """The joints in the order of the file; each mistake is kept."""
    joints: dict[str, UrdfJoint] = {}
    owners: dict[str, UrdfJoint] = {}
    nodes = root.all("joint")
    if len(nodes) > MAX_LINKS:
        raise nodes[MAX_LINKS].error(f"found {len(nodes)} joints, expected at most {MAX_LINKS}")
    for node in nodes:
        joint = reading.faults.attempt(None, _read_joint, node, links, reading)
        if joint is None:
            continue
        if joint.name in joints:
            first = joints[joint.name].node.mark.line
            message = f"found a second joint '{shown(joint.name)}', expected another name than line {first}'s"
            reading.faults.add(node.error(message, "name"))
        elif joint.child in owners:
            other = owners[joint.child]
            reading.faults.add(
                (node.first("child") or node).error(
                    f"found link '{shown(joint.child)}' as the child of '{shown(joint.name)}', expected one parent: it "
                    f"is the child of '{shown(other.name)}' in line {other.node.mark.line}, and loops are no URDF",
                    "link",
                )
            )
        else:
            joints[joint.name] = owners[joint.child] = joint
    return [*joints.values()]


def _read_joint(node: XmlNode, links: Mapping[str, XmlNode], reading: UrdfReading) -> UrdfJoint:
    """One joint. Raises DescriptionError."""
    name = _name_of(node)
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


def _single(node: XmlNode, tag: str, joint: str, reading: UrdfReading) -> XmlNode | None:
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
    origin = _single(node, "origin", joint, reading)
    xyz: tuple[float, ...] = (0.0, 0.0, 0.0)
    rpy = xyz
    if origin is not None and "xyz" in origin.attributes:
        xyz = _vector(origin, "xyz", reading)
    if origin is not None and "rpy" in origin.attributes:
        rpy = _vector(origin, "rpy", reading)
        if not reading.exact:
            words = origin.attributes["rpy"].replace(",", " ").split()
            meant = tuple(map(snapped_angle, rpy, words))
            if max(abs(a - b) for a, b in zip(meant, rpy, strict=True)) > SNAP_SAID:
                reading.snapped.append((joint, origin))
            rpy = meant
    return transform(rotation_from_rpy(rpy), xyz)


SNAP_SAID = 1e-9
"""An angle [rad] that is moved by less than this is moved without a note."""


def _read_axis(node: XmlNode, joint: str, reading: UrdfReading) -> Array:
    """The joint's axis (3,) in its frame, of any length but zero."""
    axis = _single(node, "axis", joint, reading)
    if axis is None or "xyz" not in axis.attributes:
        return np.array([1.0, 0.0, 0.0])
    values = np.array(_vector(axis, "xyz", reading))
    size = float(np.max(np.abs(values)))
    if size == 0.0:
        raise axis.error(f"found the axis 0 0 0 of joint '{shown(joint)}', expected a direction such as 0 0 1", "xyz")
    return values / size


def _read_limits(node: XmlNode, joint: str, type: str, reading: UrdfReading) -> tuple[float, float]:
    """Least and greatest value [rad | m], ±inf where there is none."""
    limit = _single(node, "limit", joint, reading)
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


def _read_mimics(joints: Sequence[UrdfJoint], reading: UrdfReading) -> list[Coupling]:
    """What joints follow others; mistakes are kept, circles among them."""
    known = {joint.name: joint for joint in joints}
    couplings: dict[str, Coupling] = {}
    for joint in joints:
        mimic = _single(joint.node, "mimic", joint.name, reading) if joint.moves else None
        if mimic is None:
            continue
        leader = mimic.attributes.get("joint", "")
        factor, offset = reading.faults.attempt((1.0, 0.0), _factors, mimic)
        if leader in known and known[leader].kind not in FREE:
            ratios = ((leader, factor),) if known[leader].moves else ()
            couplings[joint.name] = Coupling(joint.name, ratios, offset)
        elif not reading.faults.found:
            hint = did_you_mean(leader, known)
            what = f"'{shown(leader)}', which is no joint" if leader else "nothing"
            reading.note(
                mimic, f"joint '{shown(joint.name)}' follows {what}, and is taken as one that moves freely{hint}"
            )
    circle = _circle_of_mimics(couplings)
    if circle:
        names = " → ".join(shown(name) for name in [*circle[:MOST_NAMED], circle[0]])
        mimic = known[circle[0]].node.first("mimic")
        assert mimic is not None
        reading.faults.add(
            mimic.error(f"found mimics that go round in a circle, {names}, expected one joint that moves by itself")
        )
    return [*couplings.values()]


def _factors(mimic: XmlNode) -> tuple[float, float]:
    """Multiplier and offset."""
    values = number_of(mimic, "multiplier", 1.0), number_of(mimic, "offset", 0.0)
    for name, value in zip(("multiplier", "offset"), values, strict=True):
        if abs(value) > FARTHEST:
            raise mimic.error(f"found the {name} {value:g}, expected one up to {FARTHEST:g}", name)
    return values


def _circle_of_mimics(couplings: Mapping[str, Coupling]) -> list[str]:
    """Joints each of which follows the next and the last the first; none where no joint follows itself."""
    done: set[str] = set()
    for start in couplings:
        way: dict[str, None] = {}
        name = start
        while name in couplings and couplings[name].ratios and name not in done:
            if name in way:
                names = [*way]
                return names[names.index(name) :]
            way[name] = None
            name = couplings[name].ratios[0][0]
        done.update(way)
    return []


def _from_root(
    joints: list[UrdfJoint], links: Mapping[str, XmlNode], reading: UrdfReading
) -> tuple[list[UrdfJoint], str]:
    """The joints of the tree and its root; a joint that lets the whole robot move is cut, with a note.

    Raises DescriptionError for several roots, for none, for a circle of links, and for other joints of many freedoms.
    """
    children: dict[str, list[UrdfJoint]] = {name: [] for name in links}
    for joint in joints:
        children[joint.parent].append(joint)
    below = {joint.child: joint for joint in joints}
    roots = [name for name in links if name not in below]
    if len(roots) > 1:
        raise links[roots[1]].error(
            f"found {len(roots)} links without a parent, {_listed(roots)}, expected one root: a joint leads to every "
            "other link"
        )
    reached = set(roots)
    waiting = list(roots)
    while waiting:
        ends = [joint.child for joint in children[waiting.pop()]]
        reached.update(ends)
        waiting += ends
    if len(reached) < len(links):
        _refuse_circle(next(name for name in links if name not in reached), below)
    root = roots[0]
    while free := next((joint for joint in joints if joint.kind in FREE), None):
        upward = _only_way(root, children, free)
        if upward is None:
            raise free.node.error(
                f"found the {free.kind} joint '{shown(free.name)}' ({FREE[free.kind]} freedoms) from "
                f"'{shown(free.parent)}' to '{shown(free.child)}', expected revolute, continuous, prismatic or fixed "
                'joints: make it type="fixed", or take what is beyond it into a file of its own',
                "type",
            )
        joints = [joint for joint in joints if joint.name not in upward]
        root = free.child
        reading.note(
            free.node,
            f"the {free.kind} joint '{shown(free.name)}' moves the whole robot: it is left out, and "
            f"'{shown(root)}' is the root",
        )
    return joints, root


def _only_way(root: str, children: Mapping[str, list[UrdfJoint]], last: UrdfJoint) -> set[str] | None:
    """The joints' names from the root to a joint, where nothing else stands on the way and nothing moves; else None."""
    names: set[str] = set()
    while len(children[root]) == 1 and not children[root][0].moves:
        (joint,) = children[root]
        names.add(joint.name)
        root = joint.child
        if joint is last:
            return names
    return None


def _refuse_circle(link: str, below: Mapping[str, UrdfJoint]) -> None:
    """Raise DescriptionError for the circle that the way up from a link ends in."""
    way: dict[str, UrdfJoint] = {}
    while link not in way:
        way[link] = below[link]
        link = below[link].parent
    names = [*way]
    circle = names[names.index(link) :][::-1]
    listed = " → ".join(shown(name) for name in [*circle[:MOST_NAMED], circle[0]])
    raise below[circle[0]].node.error(f"found links that go round in a circle, {listed}, expected a tree")


def _graph_joint(joint: UrdfJoint, row: int, numbers: Mapping[str, int]) -> GraphJoint:
    """The joint of the graph: T_parent_child = before · motion(value) about or along z · after."""
    parent, child = numbers[joint.parent], numbers[joint.child]
    if not joint.moves:
        return GraphJoint(joint.name, "fixed", parent, child, 0, before=whole_entries(joint.origin), row=row)
    A = z_to(joint.axis)
    return GraphJoint(
        joint.name,
        joint.kind,
        parent,
        child,
        before=whole_entries(joint.origin @ A),
        after=invert(A),
        limits=joint.limits,
        row=row,
    )


def _listed(names: Sequence[str]) -> str:
    """Names in a line."""
    more = f" and {len(names) - MOST_NAMED} more" if len(names) > MOST_NAMED else ""
    return ", ".join(shown(name) for name in names[:MOST_NAMED]) + more
