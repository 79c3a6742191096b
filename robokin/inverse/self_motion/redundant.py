"""More solutions of redundant arms: for targets that held joints do not serve, and as many as are asked for.

Statement. Of an arm with more joints than it needs, the joints outside a window are held at some values and the rest
is solved for (`blocks`). Give a solution within the limits to each target that got none so, and as many solutions
as are wanted to those that have a self-motion within the limits.
Derivation. A target that gets none is served within the limits on a short piece of its self-motion, which lies
between two held values, or on a single point of it, where several joints are at their limits: a search within the
limits (`closing`) starts there, and where the solutions found outside are put on the limits. More solutions lie on the
pieces of the self-motions that the known ones are on, which are followed to where they leave the limits
(`pieces_within`): on a piece of any length there are as many as are wanted.
Where that is too little, solutions are looked for where the self-motions come near the limits (`limit_contacts`).
Degenerate case. A piece may be a single point, at a corner of the limits: then there is one solution.
"""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.analysis import Analysis, General
from robokin.inverse.numeric.closing import closing_nearest
from robokin.inverse.self_motion.bounded_task import BoundedTask
from robokin.inverse.self_motion.limit_contacts import contacts
from robokin.inverse.self_motion.pieces_within import Pieces, far_apart, joined, ranks, rays, spread_over, stepped_on
from robokin.inverse.solve_blocks import solve_block
from robokin.inverse.verify import SAME, Found, merged, nothing, within_limits, wrapped

UNPROVEN = "none within the joint limits found by search (not proven unreachable)"
"""The reason where solutions outside the limits are known: a search proves nothing."""

NOT_FOUND = "not found by search (not proven unreachable)"
"""The reason where none is known at all."""

CLIPPED = 8
"""Solutions outside the limits, those that are least so, that a search for one within starts from."""

MOST_SOUGHT = 4096
"""Greatest number of solutions of one target that is looked for. Who asks for more wants all that the held values
give, and gets these."""

SEEDS = 24
"""Solutions, within the limits or not, from fewer of which not all self-motions of a target may be known."""

HOPELESS = 0.5
"""How far [rad | size] outside the limits all known solutions of a target are that is not looked at once more: between
two held values joints move by some tenths at most where a solution within the limits may lie."""

MANY_SEEDS = 64
"""Solutions of a target, far from each other, from which all its self-motions are followed."""

STARTS = 8
"""Known solutions of a target, far from each other, that pieces of its self-motions are followed from."""

FIRST_STARTS = 3
"""Those that are followed from first: they are mostly enough."""

WAYS = (2, 4)
"""Directions from each of the first and of the others, where the self-motions have more than one dimension."""

DENSITIES = (47, 509, 8221)
"""Solutions put at equal distances along the pieces of a target, the next where the ones before give too few. They are
prime numbers: on a piece that is found from several of its points no two then stand at one place."""

TOGETHER = 32
"""Targets of which pieces are followed together: the tables stay small."""


def supplemented(
    analysis: Analysis,
    T: Array,
    limits: Array,
    rest: Array,
    seed: int,
    known: Found,
    count: Index,
    wanted: int,
    usual: int,
    search: Flags,
) -> tuple[Found, Index]:
    """More than the solutions that are `known` of targets T: (m, 4, 4) [m] by held joints, by target.

    limits: (n, 2) [rad | m]; rest: (n,) where idle joints are; count: (m,) those known that are within the limits;
    wanted: solutions within the limits for a target, where there are so many, and always `usual` at least; search: (m,)
    the targets for which one is searched for if there is none. Returns also (s,) 0 for those found until there were
    `usual`, more for those that came later: each generation is the same however many are wanted, so that fewer can be
    the first of more.
    """
    wanted = max(wanted, usual)
    lacking = count < wanted
    if not lacking.any():
        return nothing(known.q.shape[1]), np.empty(0, dtype=np.intp)
    known = known.pick(lacking[known.index])
    generation = np.full(len(known), -1)
    none = np.flatnonzero((count == 0) & search)
    if len(none):
        clipped = _least_outside(analysis, known, limits, none)
        more = closing_nearest(analysis, T[none], limits, rest, seed, clipped)
        known, generation = _with(analysis, known, generation, _of(more, none), count < usual)
        count = np.where(lacking, _inside_count(analysis, known, limits, rest, len(T)), count)
        lacking = count < wanted
    held = lacking
    if isinstance(analysis.solver, General):
        # An elimination for as many held values takes longer than to follow the self-motion.
        held = lacking & (count == 0) & ~search
    few = np.flatnonzero(held)
    if len(few):
        more, _ = solve_block(analysis, T[few], limits, None, rest, more=True)
        known, generation = _with(analysis, known, generation, _of(more, few), count < usual)
        count = np.where(lacking, _inside_count(analysis, known, limits, rest, len(T)), count)
    farthest = HOPELESS if isinstance(analysis.solver, General) else HOPELESS / 3.0  # more values were held
    hopeful = search & (_outside_by(analysis, known, limits, len(T)) <= farthest)
    few = np.flatnonzero((count < wanted) & ((count > 0) | hopeful))
    parts, later = [known.pick(generation >= 0)], [generation[generation >= 0]]
    for first in range(0, len(few), TOGETHER):
        some = few[first : first + TOGETHER]
        own = known.pick(np.isin(known.index, some))
        own = Found(np.searchsorted(some, own.index), own.q, own.position, own.angle)
        gathering = _Gathering(BoundedTask(analysis, T[some], limits, rest), own, wanted, usual)
        gathering.run(seed)
        more, since = gathering.more()
        parts.append(_of(more, some))
        later.append(np.where(since > 0, 1 + generation.max(initial=0) + since, 0))
    return _by_target(parts, later)


def seeds_of(analysis: Analysis, T: Array, known: Array, limits: Array, rest: Array) -> Array:
    """Solutions (k, n) of a target T (4, 4), within the limits or not, far from each other, for an arm with one joint
    to spare: some of those `known` (s, n), and others at held values, whatever the limits where these are few."""
    index = np.zeros(len(known), dtype=np.intp)
    found = Found(index, known, np.zeros(len(known)), np.zeros(len(known)))
    if len(known) < SEEDS:
        free = np.tile([-np.inf, np.inf], (analysis.chain.n, 1))
        found = merged(found, solve_block(analysis, T[None], free, None, rest)[0])
    found = merged(found, solve_block(analysis, T[None], limits, None, rest, more=True)[0])
    if not len(found):
        return known
    return far_apart(BoundedTask(analysis, T[None], limits, rest), found, MANY_SEEDS)[0].q


class _Gathering:
    """Solutions of some targets gathered from their self-motions until there are as many as are wanted.

    known: those to begin with, outside the limits too; found: those within the limits, each with its generation: -1
    known, 0 found until there were `usual`, more later.
    """

    def __init__(self, task: BoundedTask, known: Found, wanted: int, usual: int) -> None:
        self.task, self.known, self.wanted, self.usual = task, known, wanted, usual
        q, inside = within_limits(known.q, task.analysis.chain.revolute[: known.q.shape[1]], task.limits, task.rest)
        self.found = Found(known.index, q, known.position, known.angle).pick(inside)
        self.generation = np.full(len(self.found), -1)
        self.pieces: list[Pieces] = []

    def run(self, seed: int) -> None:
        """Follow pieces from some known solutions, from more of them, from contacts; put more and more on them."""
        start, rank = far_apart(self.task, self.found, STARTS)
        for part, ways in ((rank < FIRST_STARTS, WAYS[0]), (rank >= FIRST_STARTS, WAYS[1])):
            self._follow(start.pick(part), ways, seed)
        self._spread(DENSITIES[0])
        if self.task.analysis.redundancy == 1 and not self.task.analysis.open and self.lacking.any():
            self._touch(seed)
        for count in DENSITIES[1:]:
            self._spread(count)

    @property
    def lacking(self) -> Flags:
        """(m,) the targets that have too few."""
        return np.asarray(np.bincount(self.found.index, minlength=len(self.task.T)) < self.wanted)

    def more(self) -> tuple[Found, Index]:
        """What was found, but for what was known, by target, and (s,) the generations."""
        return self.found.pick(self.generation >= 0), self.generation[self.generation >= 0]

    def _touch(self, seed: int) -> None:
        """Follow pieces from where the self-motions come near the limits."""
        analysis, lacking = self.task.analysis, np.flatnonzero(self.lacking)
        few = lacking[np.bincount(self.known.index, minlength=len(self.task.T))[lacking] < SEEDS]
        free = np.tile([-np.inf, np.inf], (analysis.chain.n, 1))
        beyond, _ = solve_block(analysis, self.task.T[few], free, None, self.task.rest)
        known, _ = _by_target([self.known, _of(beyond, few)], [self.known.index, few[beyond.index]])
        touching = contacts(self.task, known.pick(np.isin(known.index, lacking)))
        touching = touching.pick(_new(analysis, self.found, touching))
        self._add(touching)
        self._follow(far_apart(self.task, touching, STARTS)[0], 1, seed)

    def _follow(self, start: Found, ways: int, seed: int) -> None:
        start = start.pick(self.lacking[start.index])
        if len(start):
            self.pieces.append(rays(self.task, start, ways, seed))
            self._add(stepped_on(self.task, self.pieces[-1]))

    def _spread(self, count: int) -> None:
        lacking = self.lacking
        if self.pieces and lacking.any():
            self._add(spread_over(self.task, joined(self.pieces).of(lacking), count))

    def _add(self, more: Found) -> None:
        first = np.bincount(self.found.index, minlength=len(self.task.T)) < self.usual
        self.found, self.generation = _with(self.task.analysis, self.found, self.generation, more, first)


def _inside_count(analysis: Analysis, found: Found, limits: Array, rest: Array, m: int) -> Index:
    """(m,) how many of each target are within the limits, but for full turns."""
    own = analysis.chain.n - analysis.open
    _, inside = within_limits(found.q, analysis.chain.revolute[:own], limits, rest)
    count: Index = np.bincount(found.index[inside], minlength=m)
    return count


def _least_outside(analysis: Analysis, found: Found, limits: Array, targets: Index) -> tuple[Index, Array]:
    """The solutions of some targets that are least outside the limits, the targets numbered among themselves."""
    own = analysis.chain.n - analysis.open
    number = np.full(int(max(found.index.max(initial=0), targets.max())) + 1, -1)
    number[targets] = np.arange(len(targets))
    found = found.pick(number[found.index] >= 0)
    scale = np.where(analysis.chain.revolute[:own], 1.0, analysis.size)
    outside = _outside(found.q, limits, scale)
    found = found.pick(np.lexsort((outside, found.index)))
    found = found.pick(ranks(found.index) < CLIPPED)
    return number[found.index], found.q


def _outside(q: Array, limits: Array, scale: Array) -> Array:
    """(s,) how far the joint that is most outside its limits (n, 2) is so at q (s, n) [rad | size]."""
    return np.asarray(np.max(np.maximum(limits[:, 0] - q, q - limits[:, 1]) / scale, axis=1, initial=0.0))


def _outside_by(analysis: Analysis, known: Found, limits: Array, m: int) -> Array:
    """(m,) how far outside the limits the known solution is that is least so [rad | size]; 0 where few are known."""
    own = analysis.chain.n - analysis.open
    scale = np.where(analysis.chain.revolute[:own], 1.0, analysis.size)
    least = np.full(m, np.inf)
    np.minimum.at(least, known.index, _outside(known.q, limits, scale))
    return np.where(np.bincount(known.index, minlength=m) < SEEDS, 0.0, least)


def _of(found: Found, targets: Index) -> Found:
    """The same, the targets of which are some (k,) of more, by their numbers among those."""
    return Found(targets[found.index], found.q, found.position, found.angle)


def _with(analysis: Analysis, found: Found, generation: Index, more: Found, first: Flags) -> tuple[Found, Index]:
    """All of both by target, those of `more` that are not `found` yet as the next generation.

    first: (m,) the targets for which it still counts to the first generation.
    """
    more = more.pick(np.argsort(more.index, kind="stable"))
    more = more.pick(_new(analysis, found, more))
    later = np.where(first[more.index], 0, generation.max(initial=0) + 1)
    return _by_target([found, more], [generation, later])


def _by_target(parts: list[Found], generations: list[Index]) -> tuple[Found, Index]:
    """All of them, sorted by target."""
    index = np.concatenate([part.index for part in parts])
    order = np.argsort(index, kind="stable")
    rows = (np.concatenate([getattr(part, name) for part in parts])[order] for name in ("q", "position", "angle"))
    return Found(index[order], *rows), np.concatenate(generations)[order]


def _new(analysis: Analysis, found: Found, more: Found) -> Flags:
    """(s,) which of `more` differ by `SAME` from those found, and from those of `more` before them.

    Equal configurations have equal weighted sums of their joint values, whatever full turns: in the order of these only
    neighbours are compared.
    """
    turning = analysis.chain.revolute[: more.q.shape[1]]
    found = found.pick(np.isin(found.index, more.index))
    both = merged(found, more)
    x = wrapped(both.q, turning) / np.where(turning, 1.0, analysis.size)
    weights = 1.0 + np.modf(np.arange(1.0, x.shape[1] + 1.0) * 0.6180339887498949)[0]
    key = np.abs(x) @ weights
    order = np.lexsort((key, both.index))
    again = np.zeros(len(order), dtype=bool)
    rows, step = np.arange(len(order)), 0
    while True:
        step += 1
        rows = rows[rows + step < len(order)]
        a, b = order[rows], order[rows + step]
        near = (both.index[a] == both.index[b]) & (key[b] - key[a] < SAME * weights.sum())
        rows, a, b = rows[near], a[near], b[near]
        if not len(rows):
            break
        gap = np.abs(x[a] - x[b])
        same = np.max(np.where(turning, np.minimum(gap, 2.0 * np.pi - gap), gap), axis=1) < SAME
        again[np.maximum(a[same], b[same])] = True
    return ~again[len(found) :]
