"""More solutions of redundant arms: for targets that held joints do not serve, and as many as are asked for.

Statement. Of an arm with more joints than it needs, the joints outside a window are held at some values and the rest
is solved for (`blocks`). Give a solution within the limits to each target that got none so, and as many solutions
as are wanted to those that have a self-motion within the limits.
Derivation. A target that gets none is served within the limits on a short piece of its self-motion, which lies
between two held values, or on a single point of it, where several joints are at their limits: a search within the
limits (`closing`) starts there, and where the solutions found outside are put on the limits. More solutions lie along
the self-motion of one that is known: a step along the Jacobian's null vector and Newton's steps back to the target,
both ways, until a joint passes its limit; with smaller steps where the piece is short.
Degenerate case. Where the Jacobian loses rank the null vector is not the only one and the way may end there.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robokin.inverse.analysis import Analysis, General
from robokin.inverse.blocks import solve_block
from robokin.inverse.closing import closing_nearest, newton_within
from robokin.inverse.numeric import error_and_jacobian
from robokin.inverse.verify import CLOSES, Found, distinct, merged, nothing, within_limits
from robokin.model.robot import LIMIT_TOLERANCE

Array = NDArray[np.float64]
Index = NDArray[np.intp]

UNPROVEN = "none within the joint limits found by search (not proven unreachable)"
"""The reason where solutions outside the limits are known: a search proves nothing."""

NOT_FOUND = "not found by search (not proven unreachable)"
"""The reason where none is known at all."""

CLIPPED = 8
"""Solutions outside the limits, those that are least so, that a search for one within starts from."""

WAYS = 8
"""Known solutions of a target from which its self-motion is followed."""

MOST_SOUGHT = 4096
"""Greatest number of solutions of one target that is looked for. Who asks for more wants all that the held values
give, and gets these."""

LONG = 64
"""Steps along a self-motion each way."""

STEPS = (0.1, 0.02, 0.004, 0.0008)
"""Lengths of a step along a self-motion [rad | size], the next where the one before gives too few."""

BACK = 4
"""Newton's steps back to the target after each: from the curve's curvature, 1e-2, they are quadratic."""


def supplemented(
    analysis: Analysis,
    T: Array,
    limits: Array,
    rest: Array,
    seed: int,
    found: Found,
    wanted: int,
    usual: int,
    search: NDArray[np.bool_],
) -> tuple[Found, Index]:
    """What is `found` for targets T: (m, 4, 4) [m] by held joints and more of the same, by target.

    limits: (n, 2) [rad | m]; rest: (n,) where idle joints are; wanted: solutions within the limits for a target,
    where there are so many, and always `usual` at least; search: (m,) the targets for which one is searched for if
    there is none. Returns also (s,) 0 for those found until there were `usual`, more for those that came later: each
    generation is the same however many are wanted, so that fewer can be the first of more.
    """
    wanted, every = max(wanted, usual), np.arange(len(T))
    generation = np.zeros(len(found), dtype=np.intp)
    count = _inside_count(analysis, found, limits, rest, len(T))
    none = np.flatnonzero((count == 0) & search)
    if len(none):
        clipped = _least_outside(analysis, found, limits, none)
        more = _once(analysis, closing_nearest(analysis, T[none], limits, rest, seed, clipped))
        found, generation = _with(found, generation, none, more, count < usual)
        count = _inside_count(analysis, found, limits, rest, len(T))
    lacking = count < wanted
    if isinstance(analysis.solver, General):
        # An elimination for as many held values takes longer than to follow the self-motion.
        lacking &= (count == 0) & ~search
    few = np.flatnonzero(lacking)
    if len(few):
        more, _ = solve_block(analysis, T[few], limits, None, rest, more=True)
        found, generation = _with(found, generation, few, more, count < usual)
        count = _inside_count(analysis, found, limits, rest, len(T))
    if analysis.redundancy != 1 or analysis.open or analysis.idle:
        return found, generation
    q, inside = within_limits(found.q, analysis.chain.revolute, limits, rest)
    known = Found(found.index, q, found.position, found.angle).pick(inside & (generation == 0))
    known = known.pick(_rank(known.index) < WAYS)
    for step in STEPS:
        lacking = (count > 0) & (count < wanted)
        if not lacking.any():
            break
        more = _once(analysis, along_self_motion(analysis, T, known.pick(lacking[known.index]), limits, step))
        found, generation = _with(found, generation, every, more, count < usual)
        count = _inside_count(analysis, found, limits, rest, len(T))
    return found, generation


def along_self_motion(analysis: Analysis, T: Array, start: Found, limits: Array, step: float) -> Found:
    """Solutions within the limits on the self-motions of those at the start, every `step` of the way [rad | size].

    At most `LONG` steps are made each way.
    """
    chain, size = analysis.chain, analysis.size
    scale = np.where(chain.revolute, 1.0, size)
    low, high = limits.T
    free = np.tile([-np.inf, np.inf], (chain.n, 1))
    index, q = np.tile(start.index, 2), np.tile(start.q, (2, 1))
    before = np.zeros(q.shape)
    sign = np.repeat([1.0, -1.0], len(start))
    out = nothing(chain.n)
    for _ in range(LONG):
        if not len(index):
            break
        _, J = error_and_jacobian(chain, T[index], q, size)
        ahead = np.linalg.svd(J)[2][:, -1]
        turned = np.where(np.any(before, axis=1), np.einsum("si,si->s", ahead, before), sign)
        ahead = ahead * np.where(turned < 0.0, -1.0, 1.0)[:, None]
        q, error = newton_within(chain, T[index], q + step * ahead * scale, size, free, BACK)
        position, angle = np.linalg.norm(error[:, :3], axis=1), np.linalg.norm(error[:, 3:], axis=1)
        on = (position <= CLOSES) & (angle <= CLOSES)
        on &= np.all((q >= low - LIMIT_TOLERANCE) & (q <= high + LIMIT_TOLERANCE), axis=1)
        out = merged(out, Found(index, q, position * size, angle).pick(on))
        index, q, before, sign = index[on], q[on], ahead[on], sign[on]
    return out.pick(np.argsort(out.index, kind="stable"))


def _once(analysis: Analysis, found: Found) -> Found:
    """Each once: no two are found by the same held values."""
    return distinct(found, analysis.chain.revolute[: found.q.shape[1]], analysis.size)


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
    outside = np.max(np.maximum(limits[:, 0] - found.q, found.q - limits[:, 1]) / scale, axis=1, initial=0.0)
    found = found.pick(np.lexsort((outside, found.index)))
    found = found.pick(_rank(found.index) < CLIPPED)
    return number[found.index], found.q


def _rank(index: Index) -> Index:
    """(s,) the number of each entry among those with the same index, which is sorted."""
    rank: Index = np.arange(len(index)) - np.searchsorted(index, index)
    return rank


def _with(
    found: Found, generation: Index, targets: Index, more: Found, first: NDArray[np.bool_]
) -> tuple[Found, Index]:
    """All of both by target, `more` as the next generation; its targets are numbered as in `targets`.

    first: (m,) the targets for which it still counts to the first generation.
    """
    index = targets[more.index]
    both = merged(found, Found(index, more.q, more.position, more.angle))
    later = np.where(first[index], 0, generation.max(initial=0) + 1)
    order = np.argsort(both.index, kind="stable")
    return both.pick(order), np.concatenate([generation, later])[order]
