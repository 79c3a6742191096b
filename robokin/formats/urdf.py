"""A URDF text to a tree of links.

A joint is Trans(xyz) RPY(rpy) and then its motion about or along its axis, lengths in metres and angles in radians.
Only what moves links is read: the children `link` and `joint` of `robot`; meshes, inertia, transmissions and control
are skipped.

Source: ROS wiki, urdf/XML/joint, and urdfdom's joint.cpp, whose defaults these are.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from robokin.errors import DescriptionError, InputError, counted, did_you_mean, shown, visible
from robokin.formats.faults import Faults
from robokin.formats.snapped_angles import MOST_NAMED, listed_joints
from robokin.formats.tool_names import default_tips
from robokin.formats.urdf_joints import (
    FREE,
    UrdfJoint,
    UrdfReading,
    mimic_factors,
    name_of,
    read_joint,
    single_child,
)
from robokin.formats.xml_tree import XmlNode, XmlText, read_xml
from robokin.model.graph import Coupling, Graph, GraphJoint
from robokin.model.tree import Tree
from robokin.spatial import exact as whole_entries
from robokin.spatial import invert, z_to

MAX_LINKS = 2000
"""Links of a tree; a humanoid with two hands has 150."""

NAMELESS = "robot"


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
    said = [note for text in files.values() for note in text.notes]
    return replace(tree, notes=(*said, *tree.notes)) if said else tree


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
    name = visible(root.attributes.get("name", "").strip())
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
        name = faults.attempt("", name_of, node)
        if name and name in links:
            first = links[name].mark.line
            faults.add(
                node.error(f"found a second link '{shown(name)}', expected another name than line {first}'s", "name")
            )
        elif name:
            links[name] = node
    return links


def _read_joints(root: XmlNode, links: Mapping[str, XmlNode], reading: UrdfReading) -> list[UrdfJoint]:
    """The joints in the order of the file; each mistake is kept."""
    joints: dict[str, UrdfJoint] = {}
    owners: dict[str, UrdfJoint] = {}
    nodes = root.all("joint")
    if len(nodes) > MAX_LINKS:
        raise nodes[MAX_LINKS].error(f"found {len(nodes)} joints, expected at most {MAX_LINKS}")
    for node in nodes:
        joint = reading.faults.attempt(None, read_joint, node, links, reading)
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


def _read_mimics(joints: Sequence[UrdfJoint], reading: UrdfReading) -> list[Coupling]:
    """What joints follow others; mistakes are kept, circles among them."""
    known = {joint.name: joint for joint in joints}
    couplings: dict[str, Coupling] = {}
    for joint in joints:
        mimic = single_child(joint.node, "mimic", joint.name, reading) if joint.moves else None
        if mimic is None:
            continue
        leader = mimic.attributes.get("joint", "")
        factor, offset = reading.faults.attempt((1.0, 0.0), mimic_factors, mimic)
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
            f"found {len(roots)} links without a parent, {listed_joints(roots)}, expected one root: a joint leads to "
            "every other link"
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
