"""Are two tables the same robot? Decided by the joints' axes, not by the cells.

A table is one of many for a robot: standard, modified or frames, z axes up or down, frames anywhere along parallel
axes. What counts is where the hand goes:

    T_a(q) = X T_b(s q + c) Y    for all q,

where the base X, the tool Y, the zeros c and the senses s are each the identity unless they are left open.

The joints are brought together one after the other from the base on. `Freedom` is the set of motions that may still
be done to the rest of b: all of them before the first joint if the base is open, then those that leave the last axis
as it is, and the joint's own motion if its zero is open. Each axis of b is moved onto that of a by the best motion of
the set. What is then left is a difference of the robots: it stands wholly at the first joint that differs and is said
in the terms of a table, the twist and the distance to the axis before, the offset along it and the turn about it. A
sense that is open is tried both ways; states that differ only by what is free are one.

Of a robot whose joints hang on each other the axes are those of all joints that move, and what each of them takes of
what is typed must be the same too (`other_couplings`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain, combinations

import numpy as np

from robokin.arrays import Array
from robokin.brief import Brief
from robokin.grading.chain_freedom import EVERYTHING, NOTHING, Axis, ChainFreedom, Near, across
from robokin.grading.gaps import Gap, gap_of
from robokin.grading.other_couplings import OtherCoupling, couplings_between
from robokin.grading.pose_difference import pose_errors
from robokin.grading.tolerance import Tolerance
from robokin.kinematics.forward import joint_frames
from robokin.model import CoupledRobot, Robot
from robokin.spatial import invert, quaternion_from_rotation

OPEN = ("base", "tool", "zero", "sign")
"""What may be left open."""

STATES = 256
"""Ways to choose the senses that are followed at a time. States that can be told apart by what follows are few (two a
joint, mostly), so this is far above what occurs."""


ZERO, NOT_ZERO = 1e-9, 1e-2
"""Radians, and parts of the arm's size: less is rounding, more is meant."""

SAME_LINE = 1e-3
"""Metres, and sines: a turn about a joint's axis is off it by no more. It only decides how a match is told."""


@dataclass(frozen=True, eq=False, repr=False)
class Skeleton(Brief):
    """The axes of a robot at q = 0 in the world, and its tool there (4, 4) [m]."""

    axes: tuple[Axis, ...]
    tool: Array

    @property
    def types(self) -> str:
        """The joints' types in a word."""
        return "".join("R" if axis.turning else "P" for axis in self.axes)

    def end(self, first: int) -> Skeleton:
        """What is left without the joints before one, from 0."""
        return Skeleton(self.axes[first:], self.tool)


def skeleton_of(robot: Robot) -> Skeleton:
    """The skeleton of a robot; of one whose joints hang on each other, of all that move, each axis once."""
    frames = joint_frames(robot, np.zeros(robot.n))
    own = [row for row in robot.rows if row.moves]
    # A helical joint is a turn and then a slide along the same axis: the frame it starts from is that of its turn.
    first = np.cumsum([0, *(1 + bool(row.pitch) for row in own)])[:-1].astype(np.intp)
    turning = [row.type.letter == "R" for row in own]
    axes = zip(frames[first, :3, 2], frames[first, :3, 3], turning, strict=True)
    return Skeleton(tuple(Axis(u, o, turning) for u, o, turning in axes), frames[-1])


@dataclass(frozen=True, eq=False, repr=False)
class MatchState(Brief):
    """How b has been moved: a motion (4, 4) for each joint so far, its senses, and what is still free."""

    motions: tuple[Array, ...]
    signs: tuple[int, ...]
    freedom: ChainFreedom
    worst: float = 0.0


@dataclass(frozen=True, eq=False, repr=False)
class Match(Brief):
    """How far b could be brought to a: the joint (from 0) that differs, or n for the tool, or None; and its gap.

    state: of all joints before.
    """

    joint: int | None
    gap: Gap | None
    state: MatchState
    right: Skeleton
    given: Skeleton

    @property
    def same(self) -> bool:
        """Whether it is the same robot."""
        return self.joint is None

    @cached_property
    def zeros(self) -> Array:
        """(n,) c of q_b = s (q_a + c), angles in (-π, π] [rad | m].

        What b was moved by after a joint is that joint's own motion, that of one before it about the same line or
        in the same direction, or the base's.
        """
        values = np.zeros(len(self.state.signs))
        axes = self.right.axes
        for j, (before, after) in enumerate(zip(self.state.motions, self.state.motions[1:], strict=False)):
            k = after @ invert(before)
            w, *v = quaternion_from_rotation(k[:3, :3])
            for i in [i for i in range(j, -1, -1) if axes[i].turning]:
                shift = across(k[:3, :3] @ axes[i].o + k[:3, 3] - axes[i].o, axes[i].u)
                if np.linalg.norm(np.cross(v, axes[i].u)) < SAME_LINE and np.linalg.norm(shift) < SAME_LINE:
                    values[i] += 2.0 * np.arctan2(axes[i].u @ v, w)
                    break
            sliding = [i for i in range(j + 1) if not axes[i].turning]
            if sliding:
                # Where on the line of the turn does not matter: the part along it is the same everywhere.
                at = next((axis.o for axis in reversed(axes[: j + 1]) if axis.turning), np.zeros(3))
                shift = k[:3, :3] @ at + k[:3, 3] - at
                values[sliding] += np.linalg.lstsq(np.array([axes[i].u for i in sliding]).T, shift, rcond=1e-6)[0]
        turning = np.array([axis.turning for axis in axes], dtype=bool)
        return np.where(turning, np.pi - (np.pi - values) % (2.0 * np.pi), values)


def near_zero(allowed: Tolerance) -> Near:
    """What is taken for parallel and for coaxial: what the tolerance cannot tell from it, within bounds.

    Rounding must not tell parallel axes apart where nothing is allowed, and a generous tolerance must not make
    axes parallel that are not.
    """
    angle, part = (float(np.clip(value, ZERO, NOT_ZERO)) for value in (allowed.angle, allowed.position / allowed.size))
    return Near(angle, part * allowed.size)


def match(right: Skeleton, given: Skeleton, allowed: Tolerance, free: frozenset[str]) -> Match:
    """Bring a given skeleton to the right one as far as it goes; both have joints of the same types."""
    near = near_zero(allowed)
    states = [MatchState((), (), EVERYTHING if "base" in free else NOTHING)]
    for i, (a, b) in enumerate(zip(right.axes, given.axes, strict=True)):
        before = right.axes[i - 1] if i else None
        tried = [
            _joined(state, a, b, before, sign, allowed, "zero" in free)
            for state in states
            for sign in ((1, -1) if "sign" in free else (1,))
        ]
        good = [state for state, gap in tried if gap.within(allowed)]
        if not good:
            _, gap = min(tried, key=lambda pair: pair[1].worst(allowed)[1])
            return Match(i, gap, states[0], right, given)
        states = _different(sorted(good, key=lambda state: state.worst), near)[:STATES]
    ends = [_ended(state, right, given) for state in states]
    end, gap = min(ends, key=lambda pair: pair[1].worst(allowed)[1])
    if "tool" in free or gap.within(allowed):
        return Match(None, None, end if "tool" not in free else states[0], right, given)
    return Match(len(right.axes), gap, end, right, given)


def _joined(
    state: MatchState, a: Axis, b: Axis, before: Axis | None, sign: int, allowed: Tolerance, zero: bool
) -> tuple[MatchState, Gap]:
    """The state after one joint more, and how far its axis is off."""
    near = near_zero(allowed)
    W = state.motions[-1] if state.motions else np.eye(4)
    W = state.freedom.fit(a, b.moved(W, sign), near) @ W
    gap, back = gap_of(a, b.moved(W, sign), before, near)
    left = state.freedom.leaving(a, near)
    left = left.moving(a, near) if zero else left
    worst = max(state.worst, gap.worst(allowed)[1])
    # What is allowed is taken back: an angle that is off a little must not count again as a length farther out.
    return MatchState((*state.motions, back @ W), (*state.signs, sign), left, worst), gap


def _ended(state: MatchState, right: Skeleton, given: Skeleton) -> tuple[MatchState, Gap]:
    """The state with the tool brought as near as it goes, and how far it is off."""
    W = state.motions[-1] if state.motions else np.eye(4)
    W = state.freedom.fit_frame(right.tool, W @ given.tool) @ W
    position, angle = pose_errors(right.tool, W @ given.tool)
    if right.axes and right.axes[-1].turning:
        # The last joint's angle is no length of the tool.
        about = ChainFreedom(np.empty((3, 0)), "line", right.axes[-1]).fit_frame(right.tool, W @ given.tool)
        position = min(position, pose_errors(right.tool, about @ W @ given.tool)[0])
    return MatchState((*state.motions, W), state.signs, state.freedom, state.worst), Gap(angle, 0.0, position, 0.0)


def _different(states: list[MatchState], near: Near) -> list[MatchState]:
    """One of the states that differ only by what is free."""
    kept: list[MatchState] = []
    for state in states:
        k = invert(state.motions[-1])
        if not any(state.freedom.holds(other.motions[-1] @ k, near) for other in kept):
            kept.append(state)
    return kept


@dataclass(frozen=True, eq=False, repr=False)
class Comparison(Brief):
    """The verdict on a table.

    same: with what was left open; `needs` is the least that must be left open for it to be the same robot, or None if
    it is another one. match: with what `needs` leaves open, or for another robot with everything open. differences:
    where the robots differ, each from the joint before on; empty for the same robot. couplings: the joints that hang
    on others in another way.
    """

    same: bool
    needs: tuple[str, ...] | None
    match: Match | None
    differences: tuple[Match, ...]
    score: float
    couplings: tuple[OtherCoupling, ...] = ()


def compare_tables(right: Robot, given: Robot, allowed: Tolerance, free: frozenset[str]) -> Comparison:
    """Whether a given table is the right robot, up to what is left open (of `OPEN`).

    The score is the part of the joints, and of the tool unless it is open, that stand right to the one before. A
    robot with other joints is another one, with score 0 and no match. Joints that hang on others in another way count
    as wrong ones.
    """
    found = _compare_axes(right, given, allowed, free)
    signs = found.match.state.signs if found.match is not None else ()
    coupled = isinstance(right, CoupledRobot) or isinstance(given, CoupledRobot)
    if not coupled or found.match is None:
        return found
    signs = (*signs, *(1 for _ in range(len(found.match.right.axes) - len(signs))))
    other = couplings_between(right, given, signs, free)
    if not other:
        return found
    parts = len(signs) + ("tool" not in free)
    score = max(0.0, min(found.score, 1.0) - len(other) / parts)
    return replace(found, same=False, needs=None, score=score, couplings=other)


def _compare_axes(right: Robot, given: Robot, allowed: Tolerance, free: frozenset[str]) -> Comparison:
    """The verdict by the joints' axes alone."""
    a, b = skeleton_of(right), skeleton_of(given)
    if a.types != b.types:
        return Comparison(False, None, None, (), 0.0)
    # What is open already costs nothing; of the rest the least, unless the two differ with everything open: then they
    # do whatever is open, as most wrong tables do.
    own, more = _subsets(tuple(name for name in OPEN if name in free)), _subsets(OPEN)
    needs = _least(own, a, b, allowed)
    if needs is None and match(a, b, allowed, frozenset(OPEN)).same:
        needs = _least(sorted(more, key=lambda names: (len({*names} - free), len(names))), a, b, allowed)
    if needs is not None and free.issuperset(needs):
        return Comparison(True, needs, match(a, b, allowed, frozenset(needs)), (), 1.0)
    # Another robot is compared with its zeros and senses as they fit best: what is left is in the lengths and twists.
    wanted = free if needs is not None else free | {"base", "zero", "sign"}
    differences: list[Match] = []
    start = 0
    while (found := match(a.end(start), b.end(start), allowed, wanted)).joint is not None:
        joint = start + found.joint
        if not differences or differences[-1].joint != joint:
            differences.append(Match(joint, found.gap, found.state, a, b))
        if joint == len(a.axes):
            break
        # It goes on from the joint that differs, as if that were the first one on an open base, which fits; where it
        # does not, for numbers whose rounding is more than is allowed, from the next one.
        start = joint + (found.joint == 0 and "base" in wanted)
        wanted = wanted | {"base"}
    parts = len(a.axes) + ("tool" not in free)
    score = max(0.0, 1.0 - len(differences) / max(parts, 1))
    best = match(a, b, allowed, frozenset(OPEN if needs is None else needs))
    return Comparison(False, needs, best, tuple(differences), score)


def _least(
    choices: list[tuple[str, ...]], right: Skeleton, given: Skeleton, allowed: Tolerance
) -> tuple[str, ...] | None:
    """The first of some choices of what is left open with which a skeleton is the right one."""
    return next((names for names in choices if match(right, given, allowed, frozenset(names)).same), None)


def _subsets(names: tuple[str, ...]) -> list[tuple[str, ...]]:
    """All subsets, the small ones first."""
    return list(chain.from_iterable(combinations(names, count) for count in range(len(names) + 1)))
