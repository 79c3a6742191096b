"""The configurations that come closest to targets without a solution.

Statement, the law of what closest means. Of all configurations within the limits those count whose position
is nearest to the target's (to within `SAME_PLACE`); of these, those whose orientation is nearest, by the angle
of the turn that is left (to within `SAME_ANGLE`); of these, that with the least joint move from home, and of several
that with the least sum of moves.
Derivation. A descent ends in the minimum that it starts above (`position_first`), so that what counts is where it
starts: in each of as many parts of the joint space, inside the box of joint limits and on its faces, and at its
corners (`initial_guesses`). All go down for some steps of ½|p - t|² + w (1 - cos θ), position and angle together; the
ends that differ, the best first, are followed with the position first, and the best of these to the last digit.
Degenerate case. At the edge of the reach, where the position has no slope in some direction, and where an arm is
singular at its limits, the ends are put on the limits, brought nearer with hardly any damping, and turned once more.
"""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.analysis import Analysis
from robokin.inverse.numeric.initial_guesses import CORNERS, GUESSES, guesses
from robokin.inverse.numeric.position_first import (
    SAME_PLACE,
    DescentEnds,
    Ways,
    at_the_edge,
    better,
    nearer_still,
    on_limits,
    position_first,
)
from robokin.inverse.numeric.second_order import go_down
from robokin.inverse.numeric.turn_in_place import turned_in_place
from robokin.kernel.chain import Chain
from robokin.spatial.angles import circled

MoreStarts = tuple[Index, Array]
"""More initial guesses: the targets (s,) that they are for and the configurations (s, n) [rad | m]."""

FINALISTS = 24
"""Ends of the first descents that are followed further."""

LEADERS = 8
"""Ends of those that are followed to the last digit."""

HOPE = 1e-2
"""A distance [size] that counts as much as an angle of one radian among those that may become better yet."""

TOGETHER = 32
"""Targets searched for at once: enough that the interpreter's share is spread thin; more gain little."""

FIRST = 1e-2
"""w of the first descents: not so small that the way leads through a narrow curved valley."""

CAREFUL = 1e-4
"""w of the first descents that every fourth initial guess begins as well."""

AGAIN = 4
"""Every fourth initial guess goes down at once with a small w, too: with the great one two branches near which
the arm is singular, such as those of a nearly folded elbow, lead to one and the same end."""

THEN = (1e-3, 1e-5)
"""w of the descents that follow."""

LAST = (1e-4, 1e-6, 1e-8)
"""w of the last descents, of the best alone, with more steps: few need them."""

LEAST = (1e-10, 1e-12)
"""w of the descents where the position has no slope in some direction: there the joints move by its third root."""

RANKED = 1e-3
"""w by which the ends of the first descents are compared: the position counts for more than it did for these."""

ALIKE = 1e-3
"""Ends whose distances [size] and angles [rad] differ by less are followed once."""

ROUGH_PLACE = 1e-6
"""Distances [size] that ends followed roughly may differ by and still be the same."""

ROUGH_ANGLE = 1e-4
"""The same for angles [rad]."""

SAME_ANGLE = 1e-7
"""Angles [rad] that differ by less are the same."""


def nearest_configurations(
    analysis: Analysis,
    T: Array,
    limits: Array,
    home: Array,
    seed: int,
    more_starts: MoreStarts | None = None,
) -> tuple[Array, Array, Array]:
    """For targets T: (m, 4, 4) [m] the closest configurations (m, n) [rad | m] within limits (n, 2).

    Also their distances (m,) [m] and angles (m,) [rad] from the targets. Idle joints stay at `home` (n,), which is
    also one of the initial guesses. more_starts: more of them, the targets (s,) and the configurations (s, n)
    [rad | m], within the limits or not: angles are turned towards the limits and what is outside is put on them.
    The answer for a target does not depend on the others, but for the last digits.
    """
    chain, size = analysis.chain, analysis.size
    scale = np.where(chain.revolute, 1.0, size)
    wide, at_home, chosen = initial_guesses(analysis, T, limits, home, seed, more_starts)
    ways = Ways(chain, size, *(bound[:, None] for bound in (wide / scale[:, None]).T))
    known = chosen.shape[1] - GUESSES
    q, position, angle = np.empty((len(T), len(home))), np.empty(len(T)), np.empty(len(T))
    for first in range(0, len(T), TOGETHER):
        some = slice(first, first + TOGETHER)
        ends = _search(ways, T[some], chosen[some] / scale, known, at_home / scale, analysis.open)
        q[some], position[some], angle[some] = (ends.x.T * scale)[:, : len(home)], ends.distance, ends.angle
    return q, position * size, angle


def initial_guesses(
    analysis: Analysis, T: Array, limits: Array, home: Array, seed: int, more: MoreStarts | None
) -> tuple[Array, Array, Array]:
    """The limits (n, 2), the home (n,) and the initial guesses (m, k, n) for targets T: (m, 4, 4) [rad | m].

    n counts the joints that the task leaves open, too; the arguments are those of `nearest_configurations`. Home
    and `more` come first, then those chosen for the target.
    """
    wide = np.concatenate([limits, np.tile([-np.inf, np.inf], (analysis.open, 1))])
    idle = list(analysis.idle)
    wide[idle] = home[idle, None]
    at_home = np.concatenate([home, np.zeros(analysis.open)])
    drawn = guesses(analysis.chain, wide, analysis.size, seed)
    parts = [drawn.nearest(T[i : i + TOGETHER], analysis.size) for i in range(0, len(T), TOGETHER)]
    chosen = np.concatenate([np.empty((0, GUESSES, analysis.chain.n)), *parts])
    return wide, at_home, np.concatenate([_side_by_side(analysis, len(T), limits, at_home, more), chosen], axis=1)


def _side_by_side(analysis: Analysis, m: int, limits: Array, home: Array, more: MoreStarts | None) -> Array:
    """(m, k, n) home and more initial guesses for each target; where one has fewer, home again."""
    if more is None or not len(more[0]):
        return np.tile(home, (m, 1, 1))
    index, q = more
    own = q.shape[1]
    low, high = limits.T
    turns = analysis.chain.revolute[:own] & np.isfinite(limits).all(axis=1)
    amid = np.where(turns, 0.5 * (np.where(turns, low, 0.0) + np.where(turns, high, 0.0)), 0.0)
    q = np.where(turns, q + 2.0 * np.pi * np.round((amid - q) / (2.0 * np.pi)), q)
    order = np.argsort(index, kind="stable")
    place = np.arange(len(index)) - np.searchsorted(index[order], index[order])
    table = np.tile(home, (m, 1 + int(place.max()) + 1, 1))
    table[index[order], 1 + place, :own] = np.clip(q[order], low, high)
    return table


def beyond_reach(analysis: Analysis, T: Array, limits: Array) -> Flags:
    """Which targets T: (m, 4, 4) [m] are farther away than the arm, stretched out, is long.

    From the first joint's axis to the tool there are the constant transforms' lengths and the slides' ways.
    True proves that a target is out of reach; False proves nothing.
    """
    chain, own = analysis.chain, len(limits)
    farthest = np.max(np.abs(limits + chain.offsets[:own, None]), axis=1)
    length = np.sum(np.linalg.norm(chain.constants[1:, :3, 3], axis=1))
    length += np.sum(farthest[~chain.revolute[:own]])
    away = np.linalg.norm(T[:, :3, 3] - chain.constants[0, :3, 3], axis=1)
    beyond: Flags = away > length + 1e-6 * analysis.size
    return beyond


def _search(ways: Ways, T: Array, x: Array, known: int, home: Array, opened: int) -> DescentEnds:
    """The best of what the guesses x: (m, k, n) come to; home (n,) [rad | size]; the last `opened` joints are none."""
    m, k, n = x.shape
    targets = np.ascontiguousarray(T[:, :3].transpose(2, 1, 0))
    careful = np.concatenate([x[:, :known], x[:, known::AGAIN], x[:, -CORNERS:]], axis=1)
    every = np.concatenate([x, careful], axis=1)
    weights = np.repeat([FIRST, CAREFUL], [k, careful.shape[1]])
    k = every.shape[1]
    ends, place, turn = go_down(
        ways.chain,
        np.repeat(targets, k, axis=2),
        np.ascontiguousarray(every.reshape(m * k, n).T),
        ways.size,
        (ways.low, ways.high),
        np.tile(weights, m),
        steps=8,
        still=1e-3,
    )
    picked = _finalists(place.reshape(m, k), turn.reshape(m, k), FINALISTS) + k * np.arange(m)[:, None]
    count, own = picked.shape[1], n - opened
    found = position_first(ways, np.repeat(targets, count, axis=2), ends[:, picked.ravel()], THEN, 8, 8)
    move = _moves(ways.chain, found.x.T.reshape(m, count, n), home, own)
    picked = _leaders(found.distance.reshape(m, count), found.angle.reshape(m, count), move)
    found = found.pick((picked + count * np.arange(m)[:, None]).ravel())
    count = picked.shape[1]
    many = np.repeat(targets, count, axis=2)
    found = better(found, position_first(ways, many, found.x, LAST, 30, 25))
    found = on_limits(ways, many, found, LAST, 15, 25)
    found = nearer_still(ways, many, found, 40)
    found = at_the_edge(ways, many, found, LEAST, 20, 25)
    found = better(found, turned_in_place(ways, many, found))
    x = found.x.T.reshape(m, count, n)
    move, away = _moves(ways.chain, x, home, own), np.abs(x - home)[:, :, :own]
    moves = move, np.max(away, axis=2), np.sum(away, axis=2)
    best = _closest(found.distance.reshape(m, count), found.angle.reshape(m, count), moves)
    return found.pick(best + count * np.arange(m))


def _finalists(place: Array, turn: Array, count: int) -> Index:
    """(m, count) the ends to follow, the best that differ, of those with ½|p - t|² and 1 - cos θ, each (m, k)."""
    order = np.argsort(place + RANKED * turn, axis=1, kind="stable")
    distance = np.take_along_axis(np.sqrt(2.0 * place), order, axis=1)
    angle = np.take_along_axis(np.sqrt(2.0 * turn), order, axis=1)
    alike = np.abs(distance[:, :, None] - distance[:, None]) < ALIKE
    alike &= np.abs(angle[:, :, None] - angle[:, None]) < ALIKE
    again = np.any(alike & np.tri(order.shape[1], k=-1, dtype=bool), axis=2)
    return np.take_along_axis(order, np.argsort(again, axis=1, kind="stable"), axis=1)[:, :count]


def _leaders(distance: Array, angle: Array, move: Array) -> Index:
    """(m, LEADERS) the best of ends with distances [size], angles (m, k) and joint moves (m, k), followed roughly.

    Half of them are the best by the law; the others are those that may become better yet: at limits the last of a
    distance vanishes slowly.
    """
    nearest = distance.min(axis=1, keepdims=True)
    law = np.where(distance <= nearest + ROUGH_PLACE, np.round(angle / ROUGH_ANGLE), 1e9 + distance)
    best = np.lexsort((move, law), axis=1)[:, : LEADERS // 2]
    hope = (distance - nearest) / HOPE + angle
    np.put_along_axis(hope, best, np.inf, axis=1)
    others = np.argsort(hope, axis=1, kind="stable")[:, : LEADERS - LEADERS // 2]
    return np.concatenate([best, others], axis=1)


def _moves(chain: Chain, x: Array, home: Array, own: int) -> Array:
    """(m, k) the greatest joint move from home (n,) to x: (m, k, n) [rad | size], angles on the circle."""
    move = circled((x - home)[:, :, :own], chain.revolute[:own])
    farthest: Array = np.max(np.abs(move), axis=2)
    return farthest


def _closest(distance: Array, angle: Array, moves: tuple[Array, ...]) -> Index:
    """(m,) the best of ends with distances [size], angles and joint moves, each (m, k), by the law above.

    moves: the greatest with angles on the circle; without, which tell apart what is a full turn apart; their sums, so
    that not rounding tells apart what a joint that moves farther than all others leaves alike.
    """
    law = np.where(distance <= distance.min(axis=1, keepdims=True) + SAME_PLACE, angle, np.inf)
    for move in moves:
        law = np.where(law <= law.min(axis=1, keepdims=True) + SAME_ANGLE, move, np.inf)
    best: Index = np.argmin(law, axis=1)
    return best
