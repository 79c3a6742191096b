"""What a tree's fixed joints hold together: which joint carries every link, and where on it the next joints are."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError, shown
from robokin.model import Joint, JointType
from robokin.model.graph import Coupling, Graph, GraphJoint
from robokin.model.tree import NO_SHIFT, ROUND_AXIS
from robokin.spatial import exact, rotation_transform, translation_transform

ROOT = -1
"""What carries the links that do not move."""


@dataclass(frozen=True, eq=False)
class Bodies:
    """places: of each link that joints lead to, the number of the moving joint that carries it, or `ROOT`, and its
    frame (4, 4) [m] in that of the joint's child, or of the root. Joints that never move are fixed in `graph`.
    """

    graph: Graph
    places: dict[int, tuple[int, Array]]

    def bearer(self, number: int) -> int:
        """The joint that carries the parent of a joint."""
        return self.places[self.graph.joints[number].parent][0]

    def before(self, number: int) -> Array:
        """The frame (4, 4) [m], in that of its bearer's child, along whose z a joint moves."""
        joint = self.graph.joints[number]
        return np.asarray(self.places[joint.parent][1] @ joint.before)

    def tip(self, number: int) -> tuple[int, Array]:
        """The joint that carries a tip, and its frame (4, 4) [m] in that of the joint's child."""
        tip = self.graph.tips[number]
        bearer, frame = self.places[tip.link]
        return bearer, np.asarray(frame @ tip.tool)

    def steps(self) -> Iterator[Array]:
        """Every constant transform (4, 4) [m] of the joints and tips."""
        for number in self.graph.moving:
            yield from (self.before(number), self.graph.joints[number].after)
        yield from (self.tip(number)[1] for number in range(len(self.graph.tips)))


def bodies_of(graph: Graph) -> Bodies:
    """The bodies of a graph that is a tree. Raises InputError for loops and for links that stand on nothing."""
    graph = _settled(graph)
    standing: dict[int, list[int]] = {}
    for number, joint in enumerate(graph.joints):
        standing.setdefault(joint.parent, []).append(number)
    places = {graph.root: (ROOT, np.eye(4))}
    waiting = [graph.root]
    while waiting:
        link = waiting.pop()
        bearer, frame = places[link]
        for number in standing.get(link, ()):
            joint = graph.joints[number]
            if joint.child in places:
                name = shown(graph.links[joint.child])
                raise InputError(f"several joints lead to the link {name}, expected a tree without loops")
            still = not joint.moves
            places[joint.child] = (bearer, frame @ joint.before @ joint.after) if still else (number, np.eye(4))
            waiting.append(joint.child)
    for name, link in [
        *((f"joint {joint.name}", joint.parent) for joint in graph.joints),
        *((f"tip {tip.name}", tip.link) for tip in graph.tips),
    ]:
        if link not in places:
            raise InputError(f"no joints lead from the root to {shown(name)}, expected a tree of one piece")
    return Bodies(graph, places)


def placed_row(name: str, joint: GraphJoint, frame: Array, own: bool = False) -> tuple[Joint, Array]:
    """A joint that moves along the z of a frame (4, 4) [m] as a row of frames, and its child's frame after the row.

    A joint whose axis passes through the origin of its child's frame is told by that frame and the axis in it, unless
    its own frame is asked for.
    """
    through = not own and float(np.max(np.abs(joint.after[:3, 3]))) <= NO_SHIFT
    axis = joint.after[2, :3] if through else np.array([0.0, 0.0, 1.0])
    whole = np.round(axis)
    axis = np.where(np.abs(axis - whole) <= ROUND_AXIS, whole, axis) + 0.0
    origin = exact(frame @ joint.after if through else frame)
    if joint.pitch and joint.zero:  # a row advances from where it stands at the zero of its variable
        origin = origin @ translation_transform(joint.pitch * joint.zero * axis)
    row = Joint(
        name,
        JointType.of(joint.turns),
        offset=joint.zero,
        limits=joint.limits,
        origin=origin,
        axis=axis,
        pitch=joint.pitch,
        motion_limits=joint.motion_limits,
    )
    return row, np.eye(4) if through else joint.after


def _settled(graph: Graph) -> Graph:
    """The graph with joints whose value no variable changes as fixed ones, and without couplings to them."""
    S, o = graph.value_map
    still = {
        graph.joints[number].name: float(o[place])
        for place, number in enumerate(graph.moving)
        if number not in graph.variables and not S[place].any()
    }
    if not still and all(coupling.ratios for coupling in graph.couplings):
        return graph
    couplings, zeros = [], {}
    for coupling in graph.couplings:
        offset = coupling.offset + sum(ratio * still.get(other, 0.0) for other, ratio in coupling.ratios)
        ratios = tuple((other, ratio) for other, ratio in coupling.ratios if other not in still)
        if coupling.joint in still:
            continue
        if ratios:
            couplings.append(Coupling(coupling.joint, ratios, offset, coupling.own))
        else:  # its own variable with something added
            zeros[coupling.joint] = offset
    joints = (
        _held(joint, still[joint.name])
        if joint.moves and joint.name in still
        else replace(joint, zero=joint.zero + zeros.get(joint.name, 0.0))
        for joint in graph.joints
    )
    return replace(graph, joints=tuple(joints), couplings=tuple(couplings))


def _held(joint: GraphJoint, value: float) -> GraphJoint:
    """A joint fixed at a value [rad | m]."""
    value += joint.zero
    motion = np.eye(4)
    if joint.type != "prismatic":
        motion = rotation_transform([0.0, 0.0, 1.0], value)
    if joint.type != "revolute":
        motion = motion @ translation_transform([0.0, 0.0, value * (1.0 if joint.type == "prismatic" else joint.pitch)])
    return replace(joint, type="fixed", freedoms=0, before=joint.before @ motion, zero=0.0)
