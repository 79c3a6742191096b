"""Pieces of self-motions within the limits, of many targets at once, and configurations spread over them.

Statement. Given solutions within the limits of an arm that is redundant for its task, find more of them beside these:
as many as are wanted, however short the pieces of the self-motions are on which they lie.
Derivation. From each solution steps go along a null vector of the Jacobian and against it, each brought back to the
task by Newton's steps at right angles to it, until a joint meets its limit. A step ends where the tangent meets the
first limit; one that ends outside is repeated, shortened in proportion, so that a piece is followed to its end whether
that is a radian away or a millionth of one. The points that were stepped on are solutions; more of them stand at equal
distances along the cubics between these, brought back to the task.
A self-motion of more dimensions is followed along straight rays, each on in the direction of its last step.
Degenerate case. A solution at which every way leads out of the limits is a piece of one point. Where the Jacobian loses
rank the way goes straight on.

Here x are joint values [rad | size] and lengths are in the arm's size.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.self_motion.bounded_task import BoundedTask
from robokin.inverse.self_motion.pose_correction import CLOSES, errors
from robokin.inverse.self_motion.spread import well_spread
from robokin.inverse.verify import SAME, Found, wrapped

LONGEST = 0.25
"""The longest step [rad | size]: cubics between the points are then right to some 1e-4."""

MOST_STEPS = 48
"""Steps of a ray at most, shortened ones included."""

END = 1e-3
"""A step shorter than this part of the way so far is not made: the end of the piece is near enough."""

SHORTEST = 1e-8
"""Nor one that is shorter than this [rad | size]: solutions nearer than 1e-6 are the same."""

STRAIGHT = 0.95
"""Cosine of the greatest angle between the tangents at a step's ends, some 18°."""

CORRECTION = 0.3
"""The greatest correction of a step, as a part of it."""

GROWTH = 1.6
"""What a step is lengthened by after one that went well."""

STANDING = 1e-5
"""A joint whose part of a tangent is less meets its limit by the bend of the curve, if at all, and is judged there."""

APART = 3.0 * SAME
"""Solutions on a piece are no nearer [rad | size]: no joint then differs by less than makes them the same."""

BEGUN = 3
"""Steps after which a ray that comes back to its start has gone round a closed curve."""


@dataclass(eq=False)
class Pieces:
    """Pieces within the limits as points in order.

    target: (p,) the target of each point; ray: (p,) its piece, the points of which follow each other; x, ahead:
    (p, n) [rad | size] the points and the tangents there, of length 1.
    """

    target: Index
    ray: Index
    x: Array
    ahead: Array

    def of(self, targets: Flags) -> Pieces:
        """Those of some targets (m,)."""
        on = targets[self.target]
        return Pieces(self.target[on], self.ray[on], self.x[on], self.ahead[on])


def far_apart(task: BoundedTask, known: Found, most: int) -> tuple[Found, Index]:
    """At most so many of the known solutions of each target, far from each other; (s,) the number of each, from 0."""
    turning = task.analysis.chain.revolute[: known.q.shape[1]]
    x = wrapped(known.q, turning) / np.where(turning, 1.0, task.size)
    even = np.zeros(len(x), dtype=np.intp)
    chosen = well_spread(known.index, x, turning, np.zeros(len(x)), even, most)
    return known.pick(chosen), ranks(known.index[chosen])


def ranks(index: Index) -> Index:
    """(s,) the number of each entry among those with the same index, which is sorted."""
    return np.asarray(np.arange(len(index)) - np.searchsorted(index, index))


def rays(task: BoundedTask, start: Found, ways: int, seed: int) -> Pieces:
    """The pieces that solutions (s, n) within the limits are on, both ways along `ways` null vectors of each.

    Where there is one null vector, one way is all.
    """
    x, index = task.points(start), start.index
    n = x.shape[1]
    T = task.targets(index, x)
    x, _, null = task.corrected(T, x)
    ways = ways if n - task.analysis.window.dimension > 1 else 1
    ahead = (np.random.default_rng(seed).normal(size=(ways, n)) @ null).reshape(-1, n)
    ahead /= np.maximum(np.linalg.norm(ahead, axis=1, keepdims=True), 1e-300)
    rows = np.repeat(np.arange(len(x)), ways)
    x, T, index = x[rows], T[rows], index[rows]
    return _joined(index, x, ahead, _followed(task, np.concatenate([T, T]), np.concatenate([x, x]), ahead))


def _followed(task: BoundedTask, T: Array, x: Array, ahead: Array) -> list[tuple[Index, Array, Array]]:
    """The points of rays from x (2 r, n) along `ahead` (r, n) and against it: which rays, the points, the tangents."""
    steps: list[tuple[Index, Array, Array]] = []
    start, first = x, np.concatenate([ahead, -ahead])
    x, t, bend = start.copy(), first.copy(), np.zeros(x.shape)
    h, gone, count = np.full(len(x), LONGEST), np.zeros(len(x)), np.zeros(len(x), dtype=np.intp)
    rows = np.arange(len(x))
    for _ in range(MOST_STEPS):
        step = np.minimum(h[rows], _room(task, x[rows], t[rows]))
        on = step > np.maximum(END * gone[rows], SHORTEST)
        rows, step = rows[on], step[on, None]
        if not len(rows):
            break
        guess = x[rows] + step * t[rows] + 0.5 * step**2 * bend[rows]
        new, error, null = task.corrected(T[rows], guess)
        tangent = (t[rows, None] @ null)[:, 0]
        length = np.linalg.norm(tangent, axis=1, keepdims=True)
        good = (np.max(np.abs(error), axis=1) <= CLOSES) & (length[:, 0] >= STRAIGHT)
        good &= np.linalg.norm(new - guess, axis=1) <= CORRECTION * step[:, 0]
        kept = _kept_part(task, x[rows], new)
        went = good & (kept >= 1.0)
        h[rows] = np.where(went, np.minimum(GROWTH * h[rows], LONGEST), step[:, 0] * np.where(good, kept, 0.5))
        bend[rows[~good]] = 0.0
        some, new, tangent = rows[went], new[went], tangent[went] / length[went]
        bend[some] = (tangent - t[some]) / np.linalg.norm(new - x[some], axis=1, keepdims=True)
        x[some], t[some] = new, tangent
        gone[some] += step[went, 0]
        count[some] += 1
        steps.append((some, new, tangent))
        back = wrapped(start[some] - new, task.chain.revolute)
        round_ = (count[some] >= BEGUN) & (np.linalg.norm(back, axis=1) <= LONGEST)
        round_ &= (np.sum(back * tangent, axis=1) > 0.0) & (np.sum(first[some] * tangent, axis=1) > 0.9)
        rows = np.setdiff1d(rows, some[round_], assume_unique=True)
    return steps


def _room(task: BoundedTask, x: Array, t: Array) -> Array:
    """(r,) how far from x (r, n) along t (r, n) the first limit is."""
    bound = np.where(t > 0.0, task.high, task.low)
    moves = np.abs(t) > STANDING
    with np.errstate(invalid="ignore"):
        room = np.where(moves, (bound - x) / np.where(moves, t, 1.0), np.inf)
    return np.asarray(np.maximum(np.min(room, axis=1), 0.0))


def _kept_part(task: BoundedTask, x: Array, new: Array) -> Array:
    """(r,) what part of a step from x to new (r, n) stays within the limits: 1 for all of it, a little less than that.

    Less than a tenth is not said: the way may be bent.
    """
    inside = np.minimum(x - task.low, task.high - x)
    after = np.minimum(new - task.low, task.high - new)
    beyond = after < -task.tolerance
    with np.errstate(invalid="ignore"):
        part = np.where(beyond, inside / np.where(beyond, inside - after, 1.0), np.inf)
    least = np.min(part, axis=1)
    return np.asarray(np.where(np.isinf(least), 1.0, np.clip(0.98 * least, 0.1, 0.98)))


def _joined(index: Index, x: Array, ahead: Array, steps: list[tuple[Index, Array, Array]]) -> Pieces:
    """Rays from x (r, n) along `ahead` (r, n) and against it as pieces: their points in order."""
    r = len(x)
    rays_, places, points, tangents = [np.arange(r)], [np.zeros(r)], [x], [ahead]
    for k, (rows, new, tangent) in enumerate(steps):
        sign = np.where(rows < r, 1.0, -1.0)
        rays_.append(rows % max(r, 1))
        places.append(sign * (k + 1))
        points.append(new)
        tangents.append(sign[:, None] * tangent)
    ray, place = np.concatenate(rays_), np.concatenate(places)
    order = np.lexsort((place, ray))
    ray = ray[order]
    return Pieces(index[ray], ray, np.concatenate(points)[order], np.concatenate(tangents)[order])


def joined(parts: list[Pieces]) -> Pieces:
    """Pieces one after the other, by target."""
    counts = np.cumsum([0, *(int(part.ray.max(initial=-1)) + 1 for part in parts)])[:-1]
    target = np.concatenate([part.target for part in parts])
    ray = np.concatenate([part.ray + count for part, count in zip(parts, counts, strict=True)])
    order = np.argsort(target, kind="stable")
    x, ahead = (np.concatenate([getattr(part, name) for part in parts])[order] for name in ("x", "ahead"))
    return Pieces(target[order], ray[order], x, ahead)


def stepped_on(task: BoundedTask, pieces: Pieces) -> Found:
    """The points of pieces as solutions."""
    T = task.targets(pieces.target, pieces.x)
    error, _ = errors(task.chain, T, pieces.x, task.size)
    return task.found(pieces.target, pieces.x, error)


def spread_over(task: BoundedTask, pieces: Pieces, count: int) -> Found:
    """Some `count` solutions of each target at equal distances along its pieces, fewer where these are short."""
    same = (np.diff(pieces.ray) == 0) & (np.diff(pieces.target) == 0)
    chord = np.linalg.norm(np.diff(pieces.x, axis=0), axis=1) * same
    along = np.concatenate([[0.0], np.cumsum(chord)])
    targets = np.unique(pieces.target)
    first = np.searchsorted(pieces.target, targets)
    last = np.searchsorted(pieces.target, targets, side="right") - 1
    length = along[last] - along[first]
    many = np.minimum(count, length / APART).astype(np.intp)
    rank = np.arange(np.sum(many)) - np.repeat(np.cumsum(many) - many, many)
    place = np.repeat(along[first], many) + (rank + 0.5) * np.repeat(length / np.maximum(many, 1), many)
    index = np.repeat(targets, many)
    i = np.searchsorted(along, place, side="right") - 1
    i, place, index = (part[chord[i] > 0.0] for part in (i, place, index))
    x = between(pieces, i + (place - along[i]) / chord[i])
    x, error, _ = task.corrected(task.targets(index, x), x)
    return task.found(index, x, error)


def between(pieces: Pieces, place: Array) -> Array:
    """Points (s, n) on the cubics between points i and i + 1 of pieces, at places (s,) i and a fraction."""
    i = np.floor(place).astype(np.intp)
    f = (place - i)[:, None]
    a, chord = pieces.x[i], pieces.x[i + 1] - pieces.x[i]
    length = np.linalg.norm(chord, axis=1, keepdims=True)
    s, t = pieces.ahead[i] * length, pieces.ahead[i + 1] * length
    return np.asarray(a + f * (s + f * (3.0 * chord - 2.0 * s - t + f * (s + t - 2.0 * chord))))
