"""A tree of links as URDF: its links and joints as they are, joints that follow others by `mimic`, tips as links."""

from __future__ import annotations

from dataclasses import replace
from xml.etree import ElementTree

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError, shown
from robokin.formats.description_lines import different_names
from robokin.formats.node_values import LONGEST
from robokin.formats.tree_bodies import Bodies, bodies_of, placed_row
from robokin.formats.written_urdf import joint_element, numbers_text, urdf_root, valid_name, xml_text
from robokin.model import Joint, JointType, Tree
from robokin.model.graph import Graph, Tip
from robokin.spatial import exact

OTHERWISE = "expected joints that move by themselves or with one other in a URDF; -f yaml holds it"


def tree_urdf(tree: Tree) -> str:
    """The tree as URDF, in metres and radians.

    Numbers have up to 17 digits, so that the poses stay what they are; the joints keep their order. A tip that is no
    link of its own becomes one, behind a fixed joint. A joint that follows others mimics the one that moves them all;
    one that no variable moves is fixed. Raises InputError for what a URDF cannot say: joints that several others move,
    or that add others to their own value, and helical ones.
    Source of the form: Open Robotics, urdfdom, parser of joints, 2011.
    """
    bodies = bodies_of(tree.graph)
    graph = bodies.graph
    mimics = _mimics(graph)
    rows, frames = _rows(bodies, {number: offset for number, (leader, _, offset) in mimics.items() if leader == number})
    tips = [replace(tip, tool=exact(frames[tip.link] @ tip.tool)) for tip in graph.tips]
    placed = not np.array_equal(graph.base, np.eye(4))
    names, tip_names, world = _link_names(bodies, tips, placed)
    added = [number for number, tip in enumerate(tips) if names[tip.link] != tip_names[number]]
    joints = different_names(
        [
            *(valid_name(joint.name, f"joint_{i}") for i, joint in enumerate(graph.joints, start=1)),
            "base",
            *(f"{tip_names[number]}_tip" for number in added),
        ]
    )
    root = urdf_root(tree)
    for name in [*([world] if placed else []), *names.values(), *(tip_names[number] for number in added)]:
        ElementTree.SubElement(root, "link", name=name)
    if placed:
        row = Joint("base", JointType.FIXED, origin=graph.base)
        root.append(joint_element(joints[len(graph.joints)], row, world, names[graph.root]))
    for number, joint in enumerate(graph.joints):
        leader, ratio, offset = mimics.get(number, (number, 1.0, 0.0))
        offset = 0.0 if leader == number else offset  # its own is a part of its origin
        farthest = max(1.0, abs(ratio)) * LONGEST + abs(offset)  # no nearer than its leader may go
        ends = names[joint.parent], names[joint.child]
        element = joint_element(joints[number], rows[number], *ends, farthest)
        root.append(element)
        if leader != number:
            ElementTree.SubElement(
                element,
                "mimic",
                joint=joints[leader],
                multiplier=numbers_text([ratio]),
                offset=numbers_text([offset]),
            )
    for number, name in zip(added, joints[len(graph.joints) + 1 :], strict=True):
        row = Joint(name, JointType.FIXED, origin=tips[number].tool)
        root.append(joint_element(name, row, names[tips[number].link], tip_names[number]))
    return xml_text(root)


def _mimics(graph: Graph) -> dict[int, tuple[int, float, float]]:
    """Of each joint that moves: the joint with the variable that moves it, the ratio, the offset [rad | m]."""
    S, o = graph.value_map
    found = {}
    for place, number in enumerate(graph.moving):
        joint = graph.joints[number]
        if joint.type not in ("revolute", "prismatic"):
            raise InputError(f"joint {shown(joint.name)} is {shown(joint.type)}, which a URDF has no type for; {HELD}")
        leading = np.flatnonzero(S[place])
        if len(leading) != 1:
            others = ", ".join(shown(graph.joints[graph.variables[i]].name) for i in leading)
            raise InputError(f"joint {shown(joint.name)} moves with {others}, {OTHERWISE}")
        (i,) = leading
        found[number] = graph.variables[i], float(S[place, i]), float(o[place])
    return found


HELD = "-f yaml holds it"


def _rows(bodies: Bodies, shifts: dict[int, float]) -> tuple[dict[int, Joint], dict[int, Array]]:
    """The rows of the joints, by their numbers, and the graph's link frames (4, 4) [m] in those of the URDF.

    shifts [rad | m]: what is added to the values of joints that move by themselves.
    """
    graph = bodies.graph
    frames = {graph.root: np.eye(4)}
    rows: dict[int, Joint] = {}
    order = {link: place for place, link in enumerate(bodies.places)}  # a link is behind the one that it stands on
    for number in sorted(range(len(graph.joints)), key=lambda number: order[graph.joints[number].child]):
        joint = graph.joints[number]
        frame = frames[joint.parent] @ joint.before
        if joint.moves:
            row, frames[joint.child] = placed_row(joint.name, joint, frame)
            shift = shifts.get(number, 0.0)
            (low, high), (least, most) = row.limits, row.motion_limits
            limits = max(low, least - shift), min(high, most - shift)
            rows[number] = replace(row, limits=limits, offset=row.offset + shift)
        else:
            rows[number] = Joint(joint.name, JointType.FIXED, origin=exact(frame @ joint.after))
            frames[joint.child] = np.eye(4)
    return rows, frames


def _link_names(bodies: Bodies, tips: list[Tip], placed: bool) -> tuple[dict[int, str], list[str], str]:
    """The links' names by their numbers, those of the tips, and that of the world; a tip may be a link's.

    A link that is a tip of the same name and on which nothing stands shares it.
    """
    graph = bodies.graph
    inner = {joint.parent for joint in graph.joints}
    shared = {
        tip.link: number
        for number, tip in enumerate(tips)
        if tip.name == graph.links[tip.link] and tip.link not in inner and np.array_equal(tip.tool, np.eye(4))
    }
    said = [valid_name(tip.name, f"tip_{i}", "link") for i, tip in enumerate(tips, start=1)]
    others = [link for link in sorted(bodies.places) if link not in shared]
    said += [valid_name(graph.links[link], f"link_{link}", "link") for link in others]
    *called, world = different_names([*said, "world"])
    names = dict(zip(others, called[len(tips) :], strict=True)) | {link: called[one] for link, one in shared.items()}
    return dict(sorted(names.items())), called[: len(tips)], world
