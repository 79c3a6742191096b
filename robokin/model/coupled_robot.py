"""A serial robot whose joints do not all move one by one: what a user gives are the values of its drives.

The joints' values are v = S u + o, of the variables u (n,). Where as many joints move as there are variables (S is
square: a forearm that is held against the horizontal, a wrist whose motors turn each other) every v has its u. Where
joints follow others (S is tall: a finger, a mimic joint, a screw, which turns and slides) the arm has fewer freedoms
than joints that move.

Reference: J. J. Craig, Introduction to Robotics, 3rd ed., sec. 3.8 (actuator space and joint space).
"""

from __future__ import annotations

from collections.abc import Mapping as MappingType
from collections.abc import Sequence as SequenceType
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from robokin.arrays import Array, Flags, combined, read_only
from robokin.brief import Brief
from robokin.errors import InputError, shown
from robokin.model.graph import NO_LIMITS, Coupling, Graph
from robokin.model.robot import Joint, JointType, Robot, graph_joint, within

SINGULAR = 1e-12
"""Least singular value of a square S, as a part of its greatest, at which every v still has its u in numbers."""


@dataclass(frozen=True, eq=False, repr=False)
class Drive(Brief):
    """How n variables move m joints, v = S u + offsets.

    variables: (n,) name, type and limits of each, [rad | m]; S: (m, n); offsets: (m,) [rad | m]; limits: (m, 2) of the
    joints themselves; couplings: the same by name, for who writes them down.
    """

    variables: tuple[Joint, ...]
    S: Array
    offsets: Array
    limits: Array
    couplings: tuple[Coupling, ...] = ()

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        for name in ("S", "offsets", "limits"):
            object.__setattr__(self, name, read_only(getattr(self, name)))

    def motions(self, u: Array) -> Array:
        """The joints' values v (..., m) for variables u (..., n) [rad | m]."""
        return combined(np.asarray(u), self.S.T) + self.offsets

    @cached_property
    def invertible(self) -> bool:
        """Whether every v has its u: S is square and not singular."""
        if self.S.shape[0] != self.S.shape[1]:
            return False
        values = np.linalg.svd(self.S, compute_uv=False)
        return bool(np.all(values > SINGULAR * values[:1]))

    @cached_property
    def inverse(self) -> Array:
        """S⁻¹ (n, n); entries that are whole numbers but for rounding are whole."""
        inverse = np.linalg.inv(self.S)
        whole = np.round(inverse)
        return read_only(np.where(np.abs(inverse - whole) <= 1e-13 * np.maximum(1.0, np.abs(whole)), whole, inverse))

    def variables_for(self, v: Array) -> Array:
        """The variables u (..., n) for which the joints have the values v (..., m), where S is invertible."""
        return combined(np.asarray(v - self.offsets), self.inverse.T)


@dataclass(frozen=True, eq=False, repr=False)
class CoupledRobot(Robot):
    """A robot whose `rows` move as `drive` says: `joints`, `n` and `limits` are of the variables.

    `free_motion` is the arm whose joints move one by one.
    """

    drive: Drive = field(default_factory=lambda: Drive((), np.zeros((0, 0)), np.zeros(0), np.zeros((0, 2))))

    @cached_property
    def joints(self) -> tuple[Joint, ...]:
        """The variables, in the order of q."""
        return self.drive.variables

    @cached_property
    def free_motion(self) -> Robot:
        """The arm of the same rows whose joints move one by one, without limits."""
        free = np.tile([-np.inf, np.inf], (len(self.drive.offsets), 1))
        return Robot(
            self.name, self._rows(free), self.convention, self.id, self.description, self.source, self.units,
            self.parameters, self.base, self.tool,
        )  # fmt: skip

    @cached_property
    def bounded_motion(self) -> Robot:
        """The same within what the limits of the variables and of the joints leave each joint by itself."""
        S, (low, high) = self.drive.S, self.limits.T
        with np.errstate(invalid="ignore"):
            ends = np.where(S == 0.0, 0.0, [S * low, S * high])
        hull = np.stack([ends.min(axis=0).sum(axis=1), ends.max(axis=0).sum(axis=1)], axis=1)
        hull += self.drive.offsets[:, None]
        box = np.stack(
            [np.maximum(hull[:, 0], self.drive.limits[:, 0]), np.minimum(hull[:, 1], self.drive.limits[:, 1])]
        )
        if np.any(box[0] > box[1]):
            return self.free_motion  # no value is within: what is found elsewhere is told as outside
        return replace(self.free_motion, rows=self._rows(box.T))

    def _rows(self, limits: Array) -> tuple[Joint, ...]:
        own = iter(limits.tolist())
        parts = (part for row in self.rows for part in parts_of(row, self.convention))
        return tuple(
            replace(part, limits=tuple(next(own)), motion_limits=NO_LIMITS) if part.moves else part for part in parts
        )

    def _check_rows(self) -> None:
        """Whatever its rows are, the drive says how they move."""

    @cached_property
    def free_graph(self) -> Graph:
        """The table as a graph without its couplings."""
        plain: Graph = Robot.graph.func(self)  # type: ignore[attr-defined]
        return plain

    @cached_property
    def row_values(self) -> tuple[Array, Array]:
        """S (k, n) and o (k,) of the values S u + o of the rows that move; of a helical one that of its turn."""
        moving = [row for row in self.rows if row.moves]
        first = np.cumsum([0, *(1 + bool(row.pitch) for row in moving)])[:-1].astype(np.intp)
        return self.drive.S[first], self.drive.offsets[first]

    @cached_property
    def graph(self) -> Graph:
        """The table as a graph with its couplings. Raises InputError where what moves a joint is not in the chain."""
        plain = self.free_graph
        names = {joint.name for joint in plain.joints if joint.moves}
        for coupling in self.drive.couplings:
            for name in (coupling.joint, *(other for other, _ in coupling.ratios)):
                if name not in names:
                    raise InputError(f"joint {shown(name)} moves others and is not in the chain, expected the tree")
        graph: Graph = replace(plain, couplings=self.drive.couplings)
        return graph

    def within_limits(self, q: ArrayLike) -> Flags:
        """(...) whether each q: (..., n) [rad | m] respects every limit, those of the joints that it moves too.

        Raises InputError when q has another length than n.
        """
        inside = super().within_limits(q)
        return inside & within(self.drive.limits, self.drive.motions(np.asarray(q, dtype=np.float64)))

    @cached_property
    def coupled(self) -> str:
        """Which joints hang on which, in words, for messages."""
        if not self.drive.couplings:
            helical = next((row.name for row in self.rows if row.pitch), "")
            return f"joint {shown(helical)} is helical"
        first = self.drive.couplings[0]
        others = ", ".join(shown(name) for name, _ in first.ratios)
        return f"joint {shown(first.joint)} hangs on {others}"


def expect_uncoupled(robot: Robot) -> Robot:
    """The robot, if each of its joints moves by itself. Raises InputError that says which does not."""
    if isinstance(robot, CoupledRobot):
        raise InputError(f"{robot.coupled}, expected a robot whose joints move one by one")
    return robot


def driven(robot: MappingType[str, Any], couplings: tuple[Coupling, ...]) -> Robot:
    """The robot of some fields, with couplings by the names of its rows: limits of rows are those of what moves them.

    `poses` are of the variables. It is a `Robot` where nothing is coupled. Raises InputError for couplings of joints
    that there are not, and for limits that leave no value.
    """
    rows: tuple[Joint, ...] = robot["rows"]
    if not (couplings or any(row.pitch for row in rows)):
        return Robot(**{**robot, "rows": tuple(_within_both(row) for row in rows)})
    convention = robot.get("convention", "standard")
    joints = tuple(graph_joint(row, convention, i, i + 1, row.name, i) for i, row in enumerate(rows))
    links = ("base", *(str(i + 1) for i in range(len(rows))))
    S, o = Graph(links, joints, couplings=couplings).value_map
    following = {coupling.joint for coupling in couplings if not coupling.own}
    moving = [row for row in rows if row.moves]
    variables = [row for row in moving if row.name not in following]
    return CoupledRobot(**robot, drive=drive_of(moving, variables, S, o, couplings))


def _within_both(row: Joint) -> Joint:
    """A row that moves by itself: its limits and those of its motion are of one value."""
    (low, high), (least, most) = row.limits, row.motion_limits
    low, high = max(low, least), min(high, most)
    if low > high:
        raise InputError(f"joint {shown(row.name)} has limits that leave no value, expected limits that agree")
    return replace(row, limits=(low, high), motion_limits=NO_LIMITS)


def drive_of(
    moving: SequenceType[Joint], variables: SequenceType[Joint], S: Array, o: Array, couplings: tuple[Coupling, ...]
) -> Drive:
    """The drive of rows that move with the values S u + o: (m, n), (m,), a helical one taking two of the drive's.

    The limits of rows that follow others are those of their motion.
    """
    following = {coupling.joint for coupling in couplings if not coupling.own}
    parts, offsets, bounds = [], [], []
    for row, values, offset in zip(moving, S, o.tolist(), strict=True):
        parts.append(values)
        offsets.append(offset)
        bounds.append(_within_both(row).limits if row.name in following else row.motion_limits)
        if row.pitch:
            parts.append(row.pitch * values)
            offsets.append(row.pitch * offset)
            bounds.append(NO_LIMITS)
    S, o, box = np.array(parts).reshape(len(parts), len(variables)), np.array(offsets), np.array(bounds).reshape(-1, 2)
    own = tuple(Joint(row.name, row.type, limits=row.limits, pitch=row.pitch) for row in variables)
    return Drive(with_followers_limits(own, S, o, box), S, o, box, couplings)


def parts_of(row: Joint, convention: str) -> tuple[Joint, ...]:
    """The rows that one variable each moves: of a helical one a turn, and a slide along the same axis."""
    if not row.pitch:
        return (row,)
    turn = replace(row, pitch=0.0, texts=(), motion_limits=NO_LIMITS)
    slide = replace(turn, type=JointType.PRISMATIC, name=f"{row.name} advance", theta=0.0, offset=0.0)
    if convention == "frames":
        return turn, replace(slide, origin=np.eye(4))
    # The constant length of a helical row stands in the same cell as that of a turning one: d.
    slide = replace(slide, d=0.0, offset=row.d)
    if convention == "standard":
        return replace(turn, d=0.0, a=0.0, alpha=0.0), slide
    return replace(turn, d=0.0), replace(slide, a=0.0, alpha=0.0)


def with_followers_limits(variables: tuple[Joint, ...], S: Array, o: Array, limits: Array) -> tuple[Joint, ...]:
    """The variables with limits [rad | m] that leave all those of the joints that one alone moves, (m, 2).

    Raises InputError where none are left.
    """
    least = [list(joint.limits) for joint in variables]
    for row, (low, high) in enumerate(limits.tolist()):
        (led,) = np.nonzero(S[row])
        if len(led) != 1:
            continue
        implied = sorted((bound - float(o[row])) / float(S[row, led[0]]) for bound in (low, high))
        mine = least[led[0]]
        mine[0], mine[1] = max(mine[0], implied[0]), min(mine[1], implied[1])
        if mine[0] > mine[1]:
            raise InputError(
                f"no value of joint {shown(variables[led[0]].name)} is within the limits of all joints that it moves, "
                "expected limits that agree"
            )
    return tuple(replace(joint, limits=(mine[0], mine[1])) for joint, mine in zip(variables, least, strict=True))
