"""The two ends of curves that are being followed, all curves at once.

Statement. From seeds follow curves of configurations that reach a pose both ways, until the ends meet.
Derivation. Each step along the tangent, the null vector of the Jacobian, is brought back to the pose by Newton steps
in the plane at right angles to the tangent; the guess takes the curve's bend from the last step. A step is halved
where the tangent turns by more than some 11° or the correction is large. Towards what looks like a crossing of two
curves, where a second singular value vanishes, steps get shorter, so that a mere approach is followed round its bend.
Where two fronts of a curve face each other, modulo full turns, they step towards each other; where the one lands on
the other the curve is closed.
Degenerate case. At a crossing the Jacobian has two null vectors; of the directions of the tangent cone (`tangent_cone`)
the one that goes straight on is taken. Curves that pass within some 4e-3 [rad | size] of each other without a
crossing may be taken to cross.
Reference: E. L. Allgower, K. Georg, "Introduction to Numerical Continuation Methods", SIAM 2003, chapters 6 and 8.

Here x are joint values [rad | size] and lengths are in the arm's size.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.self_motion.pose_correction import CLOSES, SLOW_STEPS, STEPS, corrected, errors, scale_of
from robokin.inverse.self_motion.tangent_cone import cone
from robokin.kernel.chain import Chain
from robokin.kernel.native_kernel import handle, native
from robokin.spatial.angles import TURN, circled

FIRST = 0.05
"""Length of the first step [rad | size]."""

LONGEST = 0.15
"""The longest step [rad | size]: cubic pieces between the points are then right to some 1e-5."""

SHORTEST = 1e-4
"""A step below this [rad | size] does not get on: the curve ends there, which is said."""

THIN = 1e-7
"""Singular values below this are zero along a curve. Offsets of a millimetre leave some of 1e-5 all along a curve."""

CROSSING = 1e-4
"""Second least singular value of the Jacobian below which a point is on a crossing: its place across the curve is then
known to 1e-9 at best."""

DODGES = 3
"""How often a step that ends on a crossing is shortened: where it still does, the whole curve is one."""

APPROACH = 2e-3
"""The shortest step [rad | size] towards what looks like a crossing: curves that pass each other nearer than two such
steps are taken to cross."""

GROWTH = 1.6
"""What a step is lengthened by after one that went well."""

STRAIGHT = 0.98
"""Cosine of the greatest angle between the tangents at a step's ends, some 11°."""

CORRECTION = 0.3
"""The greatest correction of a step, as a part of it."""

REACH = 20.0
"""How far a joint that slides is followed where its limits are no wider [size]."""

BEYOND = 0.5
"""How far it is followed beyond wider limits [size]."""

MOST_STEPS = 500
"""Steps each way at most: curves of some 70 rad. Closed ones take some 60, and more where they pass crossings."""

TRIAL_STEPS = 8
"""Steps that show whether a curve leads away from its seed: unhindered it is 0.8 away [rad | size] by then."""

AWAY = 0.2
"""How far [rad | size] a curve must lead: the third order of a root of four solutions leaves an error of 1e-7 there."""

MEETS = 0.2
"""Fronts nearer than this part of a step that face each other have met, if a landing confirms it."""

SAME = 1e-5
"""A configuration this near [rad | size] to the point of a curve beside it is on the curve: solutions are known to
1e-8 at least, and to 1e-6 where they count twice."""


ENDS = ("", "bound", "lost")
"""Why a front has ended, by the native kernel's numbers."""

NATIVELY = 7
"""Joints of a chain up to which the six rows of its Jacobian leave one direction at most."""


def slide_reach(chain: Chain, size: float, limits: Array | None) -> Array:
    """How far (n,) joints are followed [size]: those that slide to their limits (own, 2) [m] if these are far."""
    reach = np.where(chain.revolute, np.inf, REACH)
    if limits is not None:
        farthest = np.max(np.abs(limits), axis=1, where=np.isfinite(limits), initial=0.0) / size + BEYOND
        reach[: len(limits)] = np.maximum(reach[: len(limits)], farthest)
    return reach


def reach_of(chain: Chain, x: Array, size: float, limits: Array | None) -> Array:
    """The same (s, n) for curves that begin at x (s, n) [rad | size], which may be farther out."""
    reach = slide_reach(chain, size, limits)
    return np.asarray(reach + np.where(np.abs(x) > reach, np.abs(x), 0.0))


class Fronts:
    """Both ends of many curves that grow from their seeds, all at once.

    Row i and row s + i are the two fronts of curve i.
    """

    def __init__(
        self, chain: Chain, T: Array, x: Array, ways: Array, size: float, locked: Flags, limits: Array | None
    ) -> None:
        self.chain, self.size, self.scale = chain, size, scale_of(chain, size)
        self.s, self.n = x.shape
        self.T = np.concatenate([T, T])
        self.x = np.concatenate([x, x])
        self.t = np.concatenate([ways, -ways])
        self.t /= np.linalg.norm(self.t, axis=1, keepdims=True)
        self.moved_on = np.zeros(2 * self.s, dtype=np.intp)
        self.bend = np.zeros_like(self.x)
        self.alive = np.ones(2 * self.s, dtype=bool)
        self.count = np.zeros(2 * self.s, dtype=np.intp)
        self.closed, self.stays = np.zeros(self.s, dtype=bool), np.zeros(self.s, dtype=bool)
        self.ended, self.codes = [""] * (2 * self.s), np.zeros(2 * self.s)
        self.history: list[tuple[Index, Array, Array, Array]] = []
        self.locks = np.where(np.concatenate([locked, locked])[:, :, None], np.eye(self.n), 0.0)
        self.locking = bool(locked.any())
        # What one curve comes to is not to depend on what others are followed beside it.
        reach = reach_of(chain, self.x, size, limits)
        self.low, self.high = -reach, reach
        # Solutions that count twice along the curve need more Newton steps; beside a crossing the first step is short.
        _, J = errors(chain, self.T, self.x, size)
        values = np.linalg.svd(np.concatenate([J, self.locks], axis=1), compute_uv=False)[:, self.n - 2]
        self.second = values
        self.seeds = self.x.copy(), self.t.copy(), values.copy()
        self.slow = values <= THIN
        self.slow = np.tile(self.slow[: self.s] | self.slow[self.s :], 2)
        self.h = np.where(values > THIN, np.clip(2.0 * values, APPROACH, FIRST), FIRST)

    def run(self, trial: Flags) -> None:
        """Follow all curves to their ends, but for those on trial (s,) that do not lead away from their seeds."""
        self.advances(TRIAL_STEPS)
        if self.alive.any():
            self.stays = trial & ~self.away()
            self.alive &= ~np.tile(self.stays, 2)
        self.advances(MOST_STEPS - TRIAL_STEPS)
        for row in np.flatnonzero(self.alive):
            self.ended[row] = "lost"

    def away(self) -> Flags:
        """(s,) which curves have led away from their seeds."""
        far = np.zeros(2 * self.s)
        for rows, points, *_ in self.history:
            far[rows] = np.maximum(far[rows], np.linalg.norm(points - self.seeds[0][rows], axis=1))
        return np.asarray(self.closed | (np.max(far.reshape(2, -1), axis=0) >= AWAY))

    def advances(self, steps: int) -> None:
        """So many steps of every front that has not come to its end: Python's where there is a crossing."""
        left = np.full(self.s, float(steps))
        while True:
            left, waiting = self._plainly(left)
            some = (left > 0.0) & waiting & (self.alive[: self.s] | self.alive[self.s :])
            if not some.any():
                return
            self.advance(some)
            left[some] -= 1.0

    def _plainly(self, left: Array) -> tuple[Array, Flags]:
        """How many steps (s,) are left of these after those of the native kernel, and (s,) which curves wait.

        It leaves to Python those that are on a crossing, or count twice; without it all are.
        """
        known = handle(self.chain)
        if native is None or known is None or self.locking or self.n > NATIVELY:
            return left, np.ones(self.s, dtype=bool)
        numbers = np.stack([self.h, self.second, self.moved_on, self.count, self.alive, self.codes], axis=1)
        state = np.concatenate([self.x, self.t, self.bend, numbers], axis=1)
        most = np.where(self.slow, float(SLOW_STEPS), float(STEPS))
        asked = self.T, most, self.low, self.high, state, self.closed.astype(np.float64), left, self.size, float(STEPS)
        state, closed, left, waits, points = native.advanced(known, *asked)
        n = self.n
        self.x, self.t, self.bend = (np.ascontiguousarray(state[:, i * n : (i + 1) * n]) for i in range(3))
        self.h, self.second, moved_on, count, alive, codes = np.ascontiguousarray(state[:, 3 * n :].T)
        self.moved_on, self.count = moved_on.astype(np.intp), count.astype(np.intp)
        self.alive, self.closed = alive > 0.0, closed > 0.0
        for row in np.flatnonzero(codes != self.codes):
            self.ended[row] = ENDS[int(codes[row])]
        self.codes = codes
        if len(points):
            rows, x, t, second = np.split(points, [1, 1 + n, 1 + 2 * n], axis=1)
            self.history.append((rows[:, 0].astype(np.intp), x, t, second[:, 0]))
        return left, waits > 0.0

    def advance(self, some: Flags) -> None:
        """One step of every front of some curves (s,) that has not come to its end."""
        self._meet(some)
        rows = np.flatnonzero(self.alive & np.tile(some, 2))
        if len(rows):
            self._step(rows)

    def _gaps(self, rows: Index) -> Array:
        """(k, n) from the fronts in rows to their partners, modulo full turns."""
        gap = self.x[(rows + self.s) % (2 * self.s)] - self.x[rows]
        return circled(gap, self.chain.revolute)

    def _meet(self, some: Flags) -> None:
        """Steps shortened so that fronts that face each other meet half way; those that have met are done."""
        first = np.flatnonzero(self.alive[: self.s] & self.alive[self.s :] & some)
        if not len(first):
            return
        gap = self._gaps(first)
        distance = np.linalg.norm(gap, axis=1)
        ahead = np.einsum("ij,ij->i", gap, self.t[first])
        facing = np.einsum("ij,ij->i", self.t[first], self.t[first + self.s]) < -0.9
        begun = np.minimum(self.count[first], self.count[first + self.s]) >= 2
        h = np.minimum(self.h[first], self.h[first + self.s])
        near = facing & begun & (ahead > 0.8 * distance) & (ahead < 2.5 * h)
        # Not half and half: of a curve that is symmetric about its seed that may be where it crosses another.
        for rows, part in ((first[near], 0.6), (first[near] + self.s, 0.4)):
            self.h[rows] = np.maximum(np.minimum(self.h[rows], part * ahead[near]), SHORTEST)
        met = facing & begun & (distance < np.maximum(MEETS * h, 2.0 * SHORTEST))
        if met.any():
            self._land(first[met], gap[met])

    def _land(self, rows: Index, gap: Array) -> None:
        """Fronts that have met: the one lands beside the other, and if it lands on it the curve is closed."""
        x, t = self.x[rows], self.t[rows]
        along = np.einsum("ij,ij->i", gap, t)[:, None]
        landed, off, _ = self._corrected(rows, x + along * t, t)
        same = (np.max(np.abs(landed - x - gap), axis=1) <= 10.0 * SAME) & (off <= CLOSES)
        done = rows[same]
        self.closed[done] = True
        self.alive[done] = self.alive[done + self.s] = False

    def _corrected(self, rows: Index, x: Array, t: Array) -> tuple[Array, Array, Array]:
        normals = t[:, None]
        if self.locking:
            normals = np.concatenate([normals, self.locks[rows]], axis=1)
        T, steps = self.T[rows], np.where(self.slow[rows], SLOW_STEPS, STEPS)
        return corrected(self.chain, T, x, self.size, normals, steps, zero=THIN)

    def _step(self, rows: Index) -> None:
        x, t, h = self.x[rows], self.t[rows], self.h[rows, None]
        guess = x + h * t + (0.5 * h * h) * self.bend[rows]
        new, off, J = self._corrected(rows, guess, t)
        ahead, second = self._tangents(rows, J, t)
        cosine = np.einsum("ij,ij->i", ahead, t)
        moved = np.linalg.norm(new - guess, axis=1)
        good = (off <= CLOSES) & (cosine >= STRAIGHT) & (moved <= CORRECTION * h[:, 0])
        # On a crossing itself Newton's steps are least exact: a little before it there is a better point.
        on_crossing = good & (second < CROSSING) & (self.second[rows] >= CROSSING) & (self.moved_on[rows] < DODGES)
        dodging = rows[on_crossing]
        self.h[dodging] *= 0.7
        self.moved_on[dodging] += 1
        failed = rows[~good]
        good &= ~on_crossing
        went = rows[good]
        length = np.maximum(np.linalg.norm(new[good] - x[good], axis=1), SHORTEST)
        self.bend[went] = (ahead[good] - t[good]) / length[:, None]
        self.h[went] = np.minimum(GROWTH * self.h[went], LONGEST)
        self._slow_down(went, self.second[went], second[good], length)
        self.x[went], self.t[went], self.second[went], self.moved_on[went] = new[good], ahead[good], second[good], 0
        self.count[went] += 1
        self.history.append((went, new[good], ahead[good], second[good]))
        beyond = np.any((new[good] < self.low[went]) | (new[good] > self.high[went]), axis=1)
        self.h[failed] *= 0.5
        self.bend[failed] = 0.0
        self._end(went[beyond], "bound")
        self._end(failed[self.h[failed] < SHORTEST], "lost")

    def _slow_down(self, rows: Index, before: Array, after: Array, length: Array) -> None:
        """Shorter steps towards a crossing, so that a mere approach of two curves is told from it.

        The second least singular value (before, after: (k,) at the ends of a step) is about proportional to the
        distance from there.
        """
        rate = (before - after) / length
        towards = (rate > 0.0) & (before > THIN)
        distance = after[towards] / rate[towards]
        self.h[rows[towards]] = np.minimum(self.h[rows[towards]], np.maximum(0.5 * distance, APPROACH))

    def _end(self, rows: Index, why: str) -> None:
        self.alive[rows], self.codes[rows] = False, ENDS.index(why)
        for row in rows:
            self.ended[row] = why

    def _tangents(self, rows: Index, J: Array, before: Array) -> tuple[Array, Array]:
        """(k, n) the tangents at new points, on in the direction of those before, and the second least values (k,)."""
        A = np.concatenate([J, self.locks[rows]], axis=1) if self.locking else J
        values, Vt = np.linalg.svd(A)[1:]
        t = Vt[:, -1].copy()
        for i in np.flatnonzero(values[:, self.n - 2] <= THIN):
            t[i] = self._straight_on(rows[i], J[i], before[i], Vt[i, np.sum(values[i] > THIN) :])
        t *= np.where(np.einsum("ij,ij->i", t, before) < 0.0, -1.0, 1.0)[:, None]
        return t, values[:, self.n - 2]

    def _straight_on(self, row: int, J: Array, before: Array, null: Array) -> Array:
        """The direction (n,) of the tangent cone that is nearest to the one before, at a point with several."""
        t = before @ null.T @ null
        if not self.locks[row].any():
            ways, flat = cone(J)
            if not flat and len(ways):
                nearest = ways[int(np.argmax(np.abs(ways @ before)))]
                t = nearest if abs(float(nearest @ before)) > 0.5 else t
        return np.asarray(t / max(float(np.linalg.norm(t)), 1e-12))

    def points(self, i: int) -> tuple[Array, Array, Array]:
        """The points (k, n) of curve i in order, the tangents (k, n) and the second least singular values (k,) there.

        The last point closes the curve if it is closed.
        """
        forward, backward = self._side(i), self._side(i + self.s)
        points = np.concatenate([backward[0][:0:-1], forward[0]])
        tangents = np.concatenate([-backward[1][:0:-1], forward[1]])
        second = np.concatenate([backward[2][:0:-1], forward[2]])
        if self.closed[i]:
            turns = np.where(self.chain.revolute, TURN * np.round((points[-1] - points[0]) / TURN), 0.0)
            points[-1], tangents[-1], second[-1] = points[0] + turns, tangents[0], second[0]
        return points, tangents, second

    @cached_property
    def _sides(self) -> tuple[Array, Array, Array, Index]:
        """What is said of the points of all fronts that have come to their ends, and where each front's begin."""
        every = np.arange(2 * self.s)
        rows = np.concatenate([every, *(part[0] for part in self.history)])
        order = np.argsort(rows, kind="stable")
        x, t, second = (
            np.concatenate([self.seeds[k], *(part[1 + k] for part in self.history)])[order] for k in range(3)
        )
        return x, t, second, np.searchsorted(rows[order], np.arange(2 * self.s + 1))

    def _side(self, row: int) -> tuple[Array, Array, Array]:
        """The points of a front, the seed first, the tangents and second least singular values."""
        *parts, first = self._sides
        x, t, second = (part[first[row] : first[row + 1]] for part in parts)
        return x, t, second
