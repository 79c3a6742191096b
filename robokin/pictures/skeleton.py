"""What moves with what in a robot or a tree: bodies that joints carry, and the strands of links through them.

Body 0 is the world with what stands still, every other body what one joint moves; its frame is the joint's own frame
after the motion, with the joint's axis along z. A serial arm is a tree of one branch, whose body k is what joint k
moves.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError, shown
from robokin.kernel.facts import fact
from robokin.model import CoupledRobot, Robot, Tree
from robokin.model.graph import Graph, GraphJoint
from robokin.spatial import exact

MOVING = ("revolute", "prismatic", "helical")
"""Joints whose motion is known: a turn, a slide, or both."""


@dataclass(frozen=True, eq=False)
class CarriedBody:
    """What a joint of the graph moves, by its number there.

    parent: the number of the body before it; start: (4, 4) [m] the frame in which the joint starts, in that body's
    frame; reach [m]: how far along its links the joint is from that body's origin.
    """

    joint: GraphJoint
    number: int
    parent: int
    start: Array
    reach: float

    @property
    def turns(self) -> bool:
        """Whether its value is an angle."""
        return self.joint.type != "prismatic"

    @property
    def rates(self) -> tuple[float, float]:
        """How far it turns [rad] and slides [m] for each unit of its value."""
        if self.joint.type == "helical":
            return 1.0, self.joint.pitch
        return (1.0, 0.0) if self.turns else (0.0, 1.0)

    @property
    def slides(self) -> bool:
        """Whether it moves along its axis."""
        return self.rates[1] != 0.0


@dataclass(frozen=True, eq=False)
class FrameMark:
    """A frame with its name: T (4, 4) [m] in a body. `end`: whether it is the root's or a tip's, and always drawn."""

    name: str
    body: int
    T: Array
    end: bool = False


def branches_of(robot: Robot | Tree) -> list[tuple[str, list[int]]]:
    """The joints with a variable by the branch that they are in, with its name: "" where there is one branch.

    A branch is called by what its joints' names have in common, `index` of index.mcp and index.pip, else by its tip,
    or by the link at its end.
    """
    if isinstance(robot, CoupledRobot):
        return [("", list(range(robot.n)))]
    skeleton, graph = skeleton_of(robot), robot.graph
    runs, children = skeleton.runs(), skeleton.children
    where = {body.number: run for body, run in zip(skeleton.bodies, runs[1:], strict=True)}
    groups: dict[int, list[int]] = {}
    for i, number in enumerate(graph.variables):
        groups.setdefault(where[number], []).append(i)
    if len(groups) < 2:
        return [("", list(range(robot.n)))]
    named = []
    for run, members in groups.items():
        names = [graph.joints[graph.variables[i]].name for i in members]
        heads = {name.rpartition(".")[0] for name in names}
        last = max(body for body, own in enumerate(runs) if own == run)
        tips = [tip.name for tip in skeleton.tips if tip.body == last]
        name = tips[0] if len(tips) == 1 and not children[last] else graph.links[skeleton.bodies[last - 1].joint.child]
        named.append((heads.pop() if len(heads) == 1 and "" not in heads else name, members))
    return named


def leads_of(robot: Robot | Tree, i: int) -> list[str]:
    """The names of the joints that move with variable i beside its own joint."""
    if isinstance(robot, CoupledRobot):
        moving = [row.name for row in robot.rows if row.moves]
        led = np.flatnonzero(robot.row_values[0][:, i])
        return [moving[k] for k in led if moving[k] != robot.joints[i].name]
    S = robot.graph.value_map[0]
    own = robot.graph.variables[i]
    return [
        robot.graph.joints[robot.graph.moving[k]].name for k in np.flatnonzero(S[:, i]) if robot.graph.moving[k] != own
    ]


@dataclass(frozen=True, eq=False)
class _Place:
    """A link's frame T (4, 4) [m] in a body, `run` [m] from the body's origin along the links, and the number of the
    line that ends there and may go on; None where another goes on with it."""

    body: int
    T: Array
    run: float
    line: int | None


@dataclass(frozen=True, eq=False)
class ArmSkeleton:
    """The bodies after body 0, parents first, and what is on them.

    S: (b, n), o: (b,) [rad | m] give the values S u + o of the bodies' joints. lines: the corners (k, 3) [m] of
    links, each on one body, `on`; strands: the numbers of the lines that follow one another, from the root or a fork
    to a tip. marks: the root's frame, those of links that are no tips, the tips; links: root and links; tips: these
    alone. spans: (b + 1,) [m] how far each body reaches along its links.
    """

    bodies: tuple[CarriedBody, ...]
    S: Array
    o: Array
    lines: tuple[Array, ...]
    on: tuple[int, ...]
    strands: tuple[tuple[int, ...], ...]
    marks: tuple[FrameMark, ...]
    links: tuple[FrameMark, ...]
    tips: tuple[FrameMark, ...]
    spans: Array

    @property
    def children(self) -> list[list[int]]:
        """The bodies that follow each body, body 0 first."""
        following: list[list[int]] = [[] for _ in range(len(self.bodies) + 1)]
        for number, body in enumerate(self.bodies, start=1):
            following[body.parent].append(number)
        return following

    def runs(self) -> list[int]:
        """(b + 1,) of each body the first of the bodies that follow one another without a fork."""
        children, firsts = self.children, [0]
        for number, body in enumerate(self.bodies, start=1):
            firsts.append(firsts[body.parent] if len(children[body.parent]) == 1 else number)
        return firsts

    def frames(self, q: Array) -> Array:
        """(b + 1, 4, 4) [m] the frames of the bodies in the world at q: (n,) [rad | m]."""
        frames = np.empty((len(self.bodies) + 1, 4, 4))
        frames[0] = np.eye(4)
        for number, (body, value) in enumerate(zip(self.bodies, self.S @ q + self.o, strict=True), start=1):
            turn, slide = body.rates
            J = np.eye(4)
            if turn:
                J[0, 0] = J[1, 1] = np.cos(value)
                J[1, 0] = np.sin(value)
                J[0, 1] = -J[1, 0]
            J[2, 3] = slide * value
            frames[number] = frames[body.parent] @ body.start @ J
        return frames


@fact
def skeleton_of(robot: Robot | Tree) -> ArmSkeleton:
    """The skeleton of a robot or a tree.

    Raises InputError for a joint whose motion is not known.
    """
    # What moves the joints of a chain may be joints beside it: its drive says how.
    graph = robot.free_graph if isinstance(robot, CoupledRobot) else robot.graph
    S, o = robot.row_values if isinstance(robot, CoupledRobot) else graph.value_map
    walk = _Walk(graph, not isinstance(robot, Robot) or robot.convention == "standard")
    walk.all()
    moving = [graph.moving.index(body.number) for body in walk.bodies]
    zeros = np.array([body.joint.zero for body in walk.bodies])
    named = {tip.name for tip in walk.tips}
    strands: dict[int, list[int]] = {}
    for number, strand in enumerate(walk.strands):
        strands.setdefault(strand, []).append(number)
    return ArmSkeleton(
        bodies=tuple(walk.bodies),
        S=S[moving].reshape(len(moving), robot.n),
        o=o[moving] + zeros,
        lines=tuple(np.array(corners) for corners in walk.lines),
        on=tuple(walk.on),
        strands=tuple(map(tuple, strands.values())),
        marks=(*(mark for mark in walk.marks if mark.name not in named or mark.end), *walk.tips),
        links=tuple(walk.marks),
        tips=tuple(walk.tips),
        spans=np.array(walk.spans),
    )


@dataclass
class _Walk:
    """Goes from the root through all links, each joint from its parent to its child.

    cornered: whether links run along their joint's axis, then across it, as those of a standard table do. on, strands:
    of each line the body and the strand.
    """

    graph: Graph
    cornered: bool
    bodies: list[CarriedBody] = field(default_factory=list)
    lines: list[list[Array]] = field(default_factory=list)
    on: list[int] = field(default_factory=list)
    strands: list[int] = field(default_factory=list)
    marks: list[FrameMark] = field(default_factory=list)
    tips: list[FrameMark] = field(default_factory=list)
    spans: list[float] = field(default_factory=lambda: [0.0])

    def all(self) -> None:
        """Go through all that leads to a joint that moves, or to a tip."""
        graph = self.graph
        leaving: list[list[int]] = [[] for _ in graph.links]
        for number, joint in enumerate(graph.joints):
            leaving[joint.parent].append(number)
        wanted = {tip.link for tip in graph.tips} | {joint.child for joint in graph.joints if joint.moves}
        for link, _, parent in reversed(graph.topology.steps):
            wanted |= {parent} if link in wanted else set()
        tips: list[list[int]] = [[] for _ in graph.links]
        for number, tip in enumerate(graph.tips):
            tips[tip.link].append(number)
        found: dict[int, FrameMark] = {}
        start = np.array(graph.base)
        self.marks.append(FrameMark(graph.links[graph.root], 0, start, end=True))
        # What is still to be gone through: a joint from a body, where it is there, and the line that it continues.
        waiting: list[tuple[int, _Place]] = []

        def leave(link: int, place: _Place) -> None:
            ways = [n for n in leaving[link] if graph.joints[n].child in wanted and graph.topology.joint[
                graph.joints[n].child] == n]  # fmt: skip
            alone = _Place(place.body, place.T, place.run, None)
            waiting.extend((n, alone) for n in reversed(ways[1:]))
            waiting.extend((n, place) for n in ways[:1])
            for number in tips[link]:
                at = alone if ways else place
                end = at.T @ graph.tips[number].tool
                self._to(self._line(at), end[:3, 3], at.run)
                place = alone
                found[number] = FrameMark(graph.tips[number].name, at.body, end, end=True)

        leave(graph.root, _Place(0, start, 0.0, None))
        while waiting:
            number, place = waiting.pop()
            leave(graph.joints[number].child, self._through(number, place))
        self.tips = [found[number] for number in sorted(found)]

    def _through(self, number: int, place: _Place) -> _Place:
        """Go through a joint, to the frame of its child."""
        joint = self.graph.joints[number]
        known = not joint.moves or joint.type in MOVING
        if np.isnan(joint.before).any() or not known:
            found = "has no axis in a known place" if known else f"is {shown(joint.type)}"
            raise InputError(f"joint {shown(joint.name)} {found}, expected a hinge, a slide or a screw")
        body, line = place.body, self._line(place)
        T = place.T @ joint.before
        run = self._to(line, T[:3, 3], place.run)
        if joint.moves:
            self.bodies.append(CarriedBody(joint, number, body, exact(T), run))
            self.spans.append(0.0)
            body, T, run = len(self.bodies), np.eye(4), 0.0
            line = self._new(body, T, self.strands[line])
        if self.cornered:
            run = self._to(line, T[:3, 3] + joint.after[2, 3] * T[:3, 2], run)
        T = T @ joint.after
        run = self._to(line, T[:3, 3], run)
        self.marks.append(FrameMark(self.graph.links[joint.child], body, T))
        return _Place(body, T, run, line)

    def _line(self, place: _Place) -> int:
        """The line that ends at a place, or a new one in a strand of its own."""
        return self._new(place.body, place.T, len(self.lines)) if place.line is None else place.line

    def _new(self, body: int, T: Array, strand: int) -> int:
        self.lines.append([T[:3, 3]])
        self.on.append(body)
        self.strands.append(strand)
        return len(self.lines) - 1

    def _to(self, line: int, point: Array, run: float) -> float:
        """Go on to a point (3,) [m]; how far that is from the body's origin."""
        run += float(np.linalg.norm(point - self.lines[line][-1]))
        self.lines[line].append(point)
        self.spans[self.on[line]] = max(self.spans[self.on[line]], run)
        return run
