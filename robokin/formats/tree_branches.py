"""A tree of links as branches: serial chains that each have a table, and what hangs on them.

A tree is cut at the links that carry more than one joint that moves; what is fixed becomes a part of bases, tools and
rows. Where the joints are called `branch.joint`, as a description with branches calls them, its own branches come back.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from graphlib import TopologicalSorter

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError, Note, shown
from robokin.formats.description_lines import different_names, one_line, plain_name, row_names
from robokin.formats.tree_bodies import ROOT, Bodies, bodies_of, placed_row
from robokin.kinematics.dh_table import to_convention
from robokin.model import Joint, JointType, Robot, Tree
from robokin.model.graph import NO_LIMITS, Coupling
from robokin.model.robot import Convention, row_constants
from robokin.spatial import exact, invert, rotation_transform, translation_transform

WORLD = "base"
"""What stands on no branch stands on it."""

KINDS = ("revolute", "prismatic", "helical")
"""Types of joints that branches can hold."""

ROUNDING = 1e-15
"""Coordinates that are shorter, in the size of the tree, are rounding."""


@dataclass(frozen=True, eq=False)
class TreeBranch:
    """A serial chain of a tree: base, rows and tool of `chain` in its convention, as if its joints moved one by one.

    on: the branch, or the joint (branch.joint), at whose end it stands, "" for the base. rows: those of the chain, with
    what helical ones advance and the limits of their motions. joints: the numbers of the graph's joints.
    """

    name: str
    on: str
    chain: Robot
    rows: tuple[Joint, ...]
    joints: tuple[int, ...]

    @property
    def names(self) -> list[str]:
        """The rows' names in the tree, `branch.joint`."""
        return [f"{self.name}.{row.name}" for row in self.rows]


@dataclass(frozen=True, eq=False)
class BranchTip:
    """A tip on a branch, on the base, or on a joint (branch.joint), and its tool (4, 4) [m] there."""

    name: str
    on: str
    tool: Array


@dataclass(frozen=True, eq=False)
class TreeBranches:
    """What the description of a tree is made of; couplings by the names in it, ratios in SI.

    order: the numbers (from 0) of the tree's variables in the order of the branches. notes: what is not as was asked.
    """

    tree: Tree
    branches: tuple[TreeBranch, ...]
    tips: tuple[BranchTip, ...]
    couplings: tuple[Coupling, ...]
    order: tuple[int, ...]
    notes: tuple[Note, ...] = ()

    @property
    def default_tips(self) -> bool:
        """Whether the tips are those that a description has which lists none."""
        carrying = {branch.on.partition(".")[0] for branch in self.branches}
        names = [branch.name for branch in self.branches if branch.name not in carrying]
        return [tip.on for tip in self.tips] == names == [tip.name for tip in self.tips]


def branches_of(tree: Tree, convention: Convention = "frames") -> TreeBranches:
    """The branches of a tree, their tables in a convention.

    A branch that has no such table is one of frames, with a note. Raises InputError for joints that are none of
    `KINDS`, and for loops.
    """
    bodies = bodies_of(tree.graph)
    for number in bodies.graph.moving:
        joint = bodies.graph.joints[number]
        if joint.type not in KINDS:
            raise InputError(f"joint {shown(joint.name)} is {shown(joint.type)}, expected one that turns or slides")
    return _Cutting(tree, bodies, convention).cut()


class _Cutting:
    """The cutting of one tree. A group is the numbers of the joints of a branch, in the order of the chain."""

    def __init__(self, tree: Tree, bodies: Bodies, convention: Convention) -> None:
        self.tree, self.bodies, self.convention = tree, bodies, convention
        self.groups = _named_groups(bodies) or _cut_groups(bodies)
        self.owner = {number: name for name, group in self.groups.items() for number in group}
        self.on_end = {self.owner[one] for one in self._bearers() if self.groups[self.owner[one]][-1] == one}
        own = {name: _own_tip(bodies, name, group) for name, group in self.groups.items() if name not in self.on_end}
        self.own_tips = {name: number for name, number in own.items() if number is not None}
        self.size = max((float(np.max(np.abs(step[:3, 3]))) for step in bodies.steps()), default=0.0)
        self.ends: dict[int, tuple[str, Array]] = {}
        """Of each joint its last row by its name in the tree, and the frame of its child link (4, 4) [m] there."""
        self.notes: list[Note] = []

    def _bearers(self) -> list[int]:
        """The joints on whose links branches stand."""
        found = [self.bodies.bearer(group[0]) for group in self.groups.values()]
        return [number for number in found if number != ROOT]

    def cut(self) -> TreeBranches:
        """The branches, in an order that keeps that of the variables as far as can be."""
        graph = self.bodies.graph
        below = {}
        for name, group in self.groups.items():
            bearer = self.bodies.bearer(group[0])
            below[name] = set() if bearer == ROOT else {self.owner[bearer]}
        made = {name: self._branch(name, self.groups[name]) for name in TopologicalSorter(below).static_order()}
        places = {number: place for place, number in enumerate(graph.moving)}

        def first(name: str) -> int:
            group = self.groups[name]
            return min(places[number] for number in [one for one in group if one in graph.variables] or group)

        branches = [made[name] for name in sorted(self.groups, key=first)] or [self._still()]
        order = [graph.variables.index(one) for branch in branches for one in branch.joints if one in graph.variables]
        return TreeBranches(
            self.tree,
            tuple(branches),
            tuple(self._tips()),
            tuple(self._couplings()),
            tuple(order),
            tuple(self.notes),
        )

    def _still(self) -> TreeBranch:
        """The branch of a tree in which nothing moves: a fixed row that does nothing."""
        row = Joint("still", JointType.FIXED)
        return TreeBranch("links", "", self._chain("links", [row], np.eye(4)), (row,), ())

    def _branch(self, name: str, group: Sequence[int]) -> TreeBranch:
        """One branch; that on which it stands has been made."""
        on, frame = "", np.eye(4)
        bearer = self.bodies.bearer(group[0])
        if bearer != ROOT:
            on, frame = self.ends[bearer]
            other = self.owner[bearer]
            if self.groups[other][-1] == bearer:  # the end of a branch on which others stand is the link's frame
                on, frame = other, np.eye(4)
        rows: list[Joint] = []
        frames: list[Array] = []
        for number in group:
            row, frame = self._row(name, number, frame @ self.bodies.before(number))
            rows.append(row)
            frames.append(frame)
        names = row_names(rows)
        rows = [replace(row, name=called) for row, called in zip(rows, names, strict=True)]
        end = frame @ self.bodies.tip(self.own_tips[name])[1] if name in self.own_tips else frame
        plain = self._chain(name, rows, self._clean(end))
        chain = self._in_convention(plain)
        if chain is not plain:
            places = zip(_frames_at_zero(chain), _frames_at_zero(plain), frames, strict=True)
            frames = [invert(new) @ old @ own for new, old, own in places]
        for number, called, own in zip(group, names, frames, strict=True):
            self.ends[number] = f"{name}.{called}", self._clean(own)
        whole = (
            replace(made, pitch=row.pitch, motion_limits=row.motion_limits)
            for made, row in zip(chain.rows, rows, strict=True)
        )
        return TreeBranch(name, on, chain, tuple(whole), tuple(group))

    def _chain(self, name: str, rows: Sequence[Joint], tool: Array) -> Robot:
        title = f"{self.tree.name or self.tree.id}, {name}"
        plain = tuple(replace(row, pitch=0.0, motion_limits=NO_LIMITS) for row in rows)
        return Robot(title, plain, "frames", id=self.tree.id, units=self.tree.units, tool=tool)

    def _in_convention(self, chain: Robot) -> Robot:
        """The chain in the convention that is asked for; as frames, with a note, where it has no such table."""
        try:
            made = to_convention(chain, self.convention)
        except InputError as error:
            self.notes.append(Note(f"{error}; this branch is written in frames"))
            return chain
        self.notes += made.notes
        return made

    def _row(self, branch: str, number: int, frame: Array) -> tuple[Joint, Array]:
        """The row of a joint that moves along the z of a frame (4, 4) [m], and its child's frame after it."""
        joint = self.bodies.graph.joints[number]
        name = joint.name.removeprefix(f"{branch}.")
        row, after = placed_row(name, joint, frame)
        if row.axis is not None and row.axis[2] != 1.0 and joint.before[2, 2] == 1.0:
            row, after = placed_row(name, joint, frame, own=True)  # a table's row: about the z of the frame before it
        assert row.origin is not None
        return replace(row, origin=self._clean(row.origin)), after

    def _clean(self, T: Array) -> Array:
        """A transform (4, 4) [m] without what is rounding of products."""
        T = exact(T)
        T[:3, 3] = np.where(np.abs(T[:3, 3]) <= ROUNDING * self.size, 0.0, T[:3, 3])
        return T

    def _tips(self) -> Iterator[BranchTip]:
        tips = self.bodies.graph.tips
        own = {number: name for name, number in self.own_tips.items()}
        others = [number for number in range(len(tips)) if number not in own]
        names = different_names([*own.values(), *(one_line(tips[number].name) or "tip" for number in others)])
        called = dict(zip([*own, *others], names, strict=True))
        for number in range(len(tips)):
            bearer, tool = self.bodies.tip(number)
            if number in own:
                yield BranchTip(called[number], own[number], np.eye(4))
                continue
            on, frame = (WORLD, np.eye(4)) if bearer == ROOT else self.ends[bearer]
            ends = self.groups.get(called[number], [ROOT])[-1] == bearer != ROOT and called[number] in self.on_end
            if ends and np.array_equal(tool, np.eye(4)):  # the branch of its name, which ends in the link's frame
                on, frame = called[number], np.eye(4)
            yield BranchTip(called[number], on, self._clean(frame @ tool))

    def _couplings(self) -> Iterator[Coupling]:
        """The couplings by the names of rows."""
        graph = self.bodies.graph
        rows = {graph.joints[number].name: self.ends[number][0] for number in graph.moving}
        for one in graph.couplings:
            ratios = tuple((rows[other], ratio) for other, ratio in one.ratios)
            yield replace(one, joint=rows[one.joint], ratios=ratios)


def _frames_at_zero(chain: Robot) -> list[Array]:
    """The frames (4, 4) [m] after the rows of a chain where all its variables are 0."""
    T, found = chain.base, []
    for row in chain.rows:
        before, after = row_constants(row, chain.convention)
        zero, z = row.sense * row.offset, np.array([0.0, 0.0, 1.0])
        turns = row.type is JointType.REVOLUTE
        T = T @ before @ (rotation_transform(z, zero) if turns else translation_transform(zero * z)) @ after
        found.append(T)
    return found


def branch_name(text: str) -> str:
    """A name for a branch: letters, digits, - and _, not beginning with a digit, and not that of the base."""
    name = plain_name(text)
    return f"_{name}" if name == WORLD else name


def _named_groups(bodies: Bodies) -> dict[str, list[int]] | None:
    """The groups that the joints' names `branch.joint` say; None where a name says none, or one is no chain."""
    groups: dict[str, list[int]] = {}
    for number in bodies.graph.moving:
        branch, point, rest = bodies.graph.joints[number].name.partition(".")
        if not point or branch_name(branch) != branch or one_line(rest) != rest or not rest:
            return None
        group = groups.setdefault(branch, [])
        if group and bodies.bearer(number) != group[-1]:
            return None
        group.append(number)
    return groups


def _cut_groups(bodies: Bodies) -> dict[str, list[int]]:
    """The groups between links that carry several joints, by the names of the tips or the links that they end at."""
    carried = Counter(bodies.bearer(number) for number in bodies.graph.moving)
    ends: dict[int, list[int]] = {}
    waiting: dict[int, list[int]] = {bodies.bearer(number): [] for number in bodies.graph.moving}
    for number in bodies.graph.moving:
        waiting[bodies.bearer(number)].append(number)
    ready = [[number] for number in waiting.get(ROOT, ())]
    while ready:
        group = ready.pop()
        while carried[group[-1]] == 1:
            group += waiting[group[-1]]
        ends[group[-1]] = group
        ready += [[number] for number in waiting.get(group[-1], ())]
    tips: dict[int, str] = {}
    for number, tip in enumerate(bodies.graph.tips):
        tips.setdefault(bodies.tip(number)[0], tip.name)
    last = sorted(ends, key=lambda end: (carried[end] > 0 or end not in tips, bodies.graph.moving.index(end)))
    links, joints = bodies.graph.links, bodies.graph.joints
    said = [links[joints[end].child] if carried[end] or end not in tips else tips[end] for end in last]
    names = different_names(branch_name(name) for name in said)
    return {name: ends[end] for name, end in zip(names, last, strict=True)}


def _own_tip(bodies: Bodies, branch: str, group: Sequence[int]) -> int | None:
    """The number of the tip that has a branch's name and is carried by its last joint."""
    for number, tip in enumerate(bodies.graph.tips):
        if tip.name == branch and bodies.tip(number)[0] == group[-1]:
            return number
    return None
