"""The kinematic graph: links, the joints between them, couplings of their values, tips. Metres and radians throughout.

A serial arm, a tree of branches and a mechanism with loops are the same thing: links numbered from 0, joints of two
links. Tables are views on it. A joint moves its child's frame against its parent's by

    T_parent_child = before · motion(value + zero) · after,

the motion about or along the z axis of the joint's own frame, so that constants say where an axis is and which way it
points. What a user gives are the variables u; the joints' values are v = S u + o, S the identity where nothing is
coupled.

Reference: J. J. Craig, Introduction to Robotics, 3rd ed., sec. 3.8 (actuator space and joint space).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from graphlib import CycleError, TopologicalSorter

import numpy as np

from robokin.arrays import Array, Flags, Index, read_only
from robokin.brief import Brief
from robokin.errors import InputError, did_you_mean, shown
from robokin.model.topology import Topology, topology_of

NO_LIMITS = (-np.inf, np.inf)

MOST_LISTED = 12
"""Links and tips that a message lists."""

GREATEST_RATIO = 1e9
"""What couplings may multiply a value by, and add to it [rad | m]: gears are far below, and products of a few stay
numbers."""


@dataclass(frozen=True, eq=False, repr=False)
class GraphJoint(Brief):
    """A joint that leads from the link `parent` to the link `child`, by their numbers.

    type: as in the description, `revolute`, `prismatic`, `helical`, `fixed` or another; freedoms: f, 0 where it is
    fixed. before, after: (4, 4) [m] the constant transforms before and after the motion, NaN where the description
    says no axis. pitch [m/rad]: a helical joint's advance. zero [rad | m]: what is added to the value. limits
    [rad | m]: of the variable, motion_limits of the joint's own value. row: the number of the joint in the description,
    where a joint of many links is one.
    """

    name: str
    type: str
    parent: int
    child: int
    freedoms: int = 1
    before: Array = field(default_factory=lambda: np.eye(4))
    after: Array = field(default_factory=lambda: np.eye(4))
    pitch: float = 0.0
    zero: float = 0.0
    limits: tuple[float, float] = NO_LIMITS
    row: int = 0
    motion_limits: tuple[float, float] = NO_LIMITS

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        for name in ("before", "after"):
            object.__setattr__(self, name, read_only(getattr(self, name)))

    @property
    def moves(self) -> bool:
        """Whether it has a value."""
        return self.freedoms > 0

    @property
    def turns(self) -> bool:
        """Whether its value is an angle, as a helical joint's is too; else it is a length."""
        return self.type != "prismatic"


@dataclass(frozen=True)
class Coupling:
    """A joint whose value hangs on those of others: value = Σ ratio · other's value + offset, by the joints' names.

    own: whether its own variable is added; without it the joint follows and has no variable. Ratios are of SI units.
    """

    joint: str
    ratios: tuple[tuple[str, float], ...]
    offset: float = 0.0
    own: bool = False


@dataclass(frozen=True, eq=False, repr=False)
class Tip(Brief):
    """A frame that a user asks for: `tool` (4, 4) [m] on a link, by its number."""

    name: str
    link: int
    tool: Array = field(default_factory=lambda: np.eye(4))

    def __post_init__(self) -> None:
        """Make the tool read-only."""
        object.__setattr__(self, "tool", read_only(self.tool))


@dataclass(frozen=True, eq=False, repr=False)
class SerialChain(Brief):
    """The joints that move between two links of a graph, as C0 J1(v1) C1 … Jn(vn) Cn, v = S u + offsets.

    A helical joint is two of them, a turn and a slide that follows it.
    constants: (n + 1, 4, 4) [m]; base: (4, 4) the pose of the first link in the frame that C0 begins in, which is the
    world's for the graph's root and the link's own for another. variables: (k,) the numbers of those of the graph's
    variables that move it; S: (n, k); offsets: (n,) [rad | m], zeros of the joints included.
    """

    joints: tuple[GraphJoint, ...]
    constants: Array
    variables: Index
    S: Array
    offsets: Array
    base: Array

    @property
    def turns(self) -> Flags:
        """(n,) whether each joint turns; the others slide."""
        return np.array([joint.type != "prismatic" for joint in self.joints], dtype=bool)


@dataclass(frozen=True, eq=False, repr=False)
class Graph(Brief):
    """Links, joints and what hangs on them; base: (4, 4) [m] the pose of the root link in the world.

    Raises InputError for links of one name, joints and tips on links that there are not, and couplings of joints that
    there are not or that go round in a circle.
    """

    links: tuple[str, ...]
    joints: tuple[GraphJoint, ...]
    root: int = 0
    base: Array = field(default_factory=lambda: np.eye(4))
    tips: tuple[Tip, ...] = ()
    couplings: tuple[Coupling, ...] = ()

    def __post_init__(self) -> None:
        """Make the base read-only; refuse what is no graph."""
        object.__setattr__(self, "base", read_only(self.base))
        for what, names in (("link", self.links), ("tip", [tip.name for tip in self.tips])):
            twice = [name for name, count in Counter(names).items() if count > 1]
            if twice:
                raise InputError(f"found the {what} '{shown(twice[0])}' twice, expected different names")
        for joint in self.joints:
            if joint.parent == joint.child:
                raise InputError(f"joint {shown(joint.name)} joins a link to itself, expected two links")
        ends = [(f"joint {joint.name}", end) for joint in self.joints for end in (joint.parent, joint.child)]
        for owner, link in [("the root", self.root), *ends, *((f"tip {tip.name}", tip.link) for tip in self.tips)]:
            if not 0 <= link < len(self.links):
                raise InputError(f"found link {link} of {shown(owner)}, expected 0 to {len(self.links) - 1}")
        if self.couplings:
            _ = self.value_map  # a circle of couplings is refused at once

    @cached_property
    def topology(self) -> Topology:
        """The spanning forest, the root's tree first, then of what is left the trees from the first links on."""
        ends = [(joint.parent, joint.child) for joint in self.joints]
        return topology_of(len(self.links), ends, (self.root, *range(len(self.links))))

    @cached_property
    def parts(self) -> tuple[tuple[str, ...], ...]:
        """The groups of links that joints connect, the root's first."""
        groups: dict[int, list[str]] = {self.root: []}
        for link, root in zip(self.links, self.topology.root.tolist(), strict=True):
            groups.setdefault(root, []).append(link)
        return tuple(tuple(group) for group in groups.values())

    @cached_property
    def moving(self) -> tuple[int, ...]:
        """The numbers of the joints that have a value, in the order of the values."""
        return tuple(number for number, joint in enumerate(self.joints) if joint.moves)

    @cached_property
    def variables(self) -> tuple[int, ...]:
        """The numbers of the joints with a variable of their own, in the order of u."""
        following = {coupling.joint for coupling in self.couplings if not coupling.own}
        return tuple(number for number in self.moving if self.joints[number].name not in following)

    @cached_property
    def value_map(self) -> tuple[Array, Array]:
        """S (m, k) and o (m,) of the joints' values S u + o, for the variables u (k,) [rad | m]."""
        S = (np.array(self.moving)[:, None] == np.array(self.variables)).astype(np.float64)
        o = np.zeros(len(self.moving))
        coupled = {coupling.joint: coupling for coupling in self.couplings}
        if len(coupled) < len(self.couplings):
            raise InputError("found two couplings of one joint, expected one with all ratios")
        try:
            order = [*TopologicalSorter({name: [n for n, _ in c.ratios] for name, c in coupled.items()}).static_order()]
        except CycleError as error:
            circle = " → ".join(error.args[1][::-1])
            raise InputError(f"the couplings go round in a circle, {circle}, expected one joint that is free") from None
        places = {name: self._value_of(name) for name in order}
        for name in order:
            for other, ratio in coupled[name].ratios if name in coupled else ():
                S[places[name]] += ratio * S[places[other]]
                o[places[name]] += ratio * o[places[other]]
            o[places[name]] += coupled[name].offset if name in coupled else 0.0
            if not max(np.max(np.abs(S[places[name]]), initial=0.0), abs(o[places[name]])) <= GREATEST_RATIO:
                expected = f"expected ratios and offsets that make less than {GREATEST_RATIO:g}"
                raise InputError(f"the couplings of joint {shown(name)} multiply its values too far, {expected}")
        return read_only(S), read_only(o)

    @cached_property
    def value_limits(self) -> Array:
        """(m, 2) limits of the joints' values themselves [rad | m]: of the motion, and of what follows its own too."""
        following = {coupling.joint for coupling in self.couplings if not coupling.own}
        joints = [self.joints[number] for number in self.moving]
        own = np.array([joint.motion_limits for joint in joints]).reshape(-1, 2)
        led = np.array([joint.limits if joint.name in following else NO_LIMITS for joint in joints]).reshape(-1, 2)
        return read_only(np.stack([np.maximum(own[:, 0], led[:, 0]), np.minimum(own[:, 1], led[:, 1])], axis=1))

    def _value_of(self, name: str) -> int:
        """The place of a joint's value among the values."""
        names = [self.joints[number].name for number in self.moving]
        if names.count(name) != 1:
            found = "twice" if name in names else "nowhere"
            hint = did_you_mean(name, names) or ", expected the name of one joint that moves"
            raise InputError(f"found the joint '{shown(name)}' of a coupling {found}{hint}")
        return names.index(name)

    def way(self, root: str, tip: str) -> tuple[tuple[int, ...], Array]:
        """The numbers of the joints that lead from a link to a tip or to a link's frame, and the tool (4, 4) [m] there.

        Raises InputError where no joints lead from one to the other, each from its parent to its child.
        """
        tips = {name: (number, np.eye(4)) for number, name in enumerate(self.links)}
        tips |= {one.name: (one.link, one.tool) for one in self.tips}
        # The tips come first: they are what is asked for most, and a message has no room for all links.
        named = [*(one.name for one in self.tips), *(name for name in self.links)]
        for what, name, known in (("root", root, [*self.links]), ("tip", tip, [*dict.fromkeys(named)])):
            if name not in known:
                more = ", …" if len(known) > MOST_LISTED else ""
                listed = ", ".join(shown(one) for one in known[:MOST_LISTED])
                hint = did_you_mean(name, known) or f", expected one of {listed}{more}"
                raise InputError(f"{what}: found the unknown link '{shown(name)}'{hint}")
        first, (last, tool) = self.links.index(root), tips[tip]
        numbers: list[int] = []
        while last != first:
            number = int(self.topology.joint[last])
            if number < 0 or self.joints[number].child != last:
                raise InputError(f"no joints lead from link {shown(root)} to {shown(tip)}, expected what stands on it")
            numbers.insert(0, number)
            last = self.joints[number].parent
        return tuple(numbers), tool

    def frame_of(self, link: str) -> Array:
        """The frame (4, 4) [m] that chains from a link begin in: the world for the root, the link's own for another."""
        return self.base if self.links.index(link) == self.root else np.eye(4)

    def chain(self, root: str, tip: str) -> SerialChain:
        """The chain from a link to a tip, or to a link's frame, by their names.

        Raises InputError where no joints lead from one to the other, each from its parent to its child, or where one of
        them has no axis.
        """
        way, tool = self.way(root, tip)
        frame = self.frame_of(root)
        constants = [frame]
        for number in way:
            joint = self.joints[number]
            if np.isnan(joint.before).any():
                raise InputError(f"joint {shown(joint.name)} has no axis in a known place, expected a hinge or a slide")
            constants[-1] = constants[-1] @ joint.before
            if joint.type == "helical":  # a turn, and a slide along the same axis by so much as its pitch says
                constants.append(np.eye(4))
            if joint.moves:
                constants.append(joint.after)
            else:
                constants[-1] = constants[-1] @ joint.after
        constants[-1] = constants[-1] @ tool
        moving = [number for number in way if self.joints[number].moves]
        return self._driven(moving, np.stack(constants), frame)

    def _driven(self, moving: Sequence[int], constants: Array, frame: Array) -> SerialChain:
        """A chain of joints that move, with the variables that move them; of a helical one a turn and a slide."""
        S, o = self.value_map
        joints, rows, offsets = [], [], []
        for number in moving:
            joint, row = self.joints[number], self.moving.index(number)
            parts = [(joint, 1.0)]
            if joint.type == "helical":
                parts = [(replace(joint, type="revolute"), 1.0), (replace(joint, type="prismatic"), joint.pitch)]
            for part, factor in parts:
                joints.append(part)
                rows.append(factor * S[row])
                offsets.append(factor * (o[row] + joint.zero))
        values = np.array(rows).reshape(len(joints), S.shape[1])
        (variables,) = np.nonzero(np.any(values != 0.0, axis=0))
        return SerialChain(tuple(joints), constants, variables, values[:, variables], np.array(offsets), frame)
