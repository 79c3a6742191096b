"""Reaching for points with more joints than needed: damped Newton steps within the joint limits, many at once.

For a point t the squared distance |t - p(q)|² / 2 is brought down over the joint box: a point is reachable exactly
where its minimum is zero. The step of least squares dq = Jᵀ(J Jᵀ + λ)⁻¹ e, e = t - p, is taken with the joints
that stand at a limit and would be pushed over it left out (an active set, found anew at every step), clipped to the
box, undone where the distance grew, and damped by λ = μ |e|, μ following the success of the steps.

What ends a search is the distance (reached) or a point where no step within the limits comes nearer (a boundary of
the set, or a barrier inside it). On a barrier other starts go on: some near the point and some from anywhere; then one
from each face of the joint box, then one from each edge (faces.py), for those from the inside may all stand before the
same barrier; what comes near is followed to the last. The answer "not reachable" is that of all of them. Where closed
forms give the answer (one_spare.py), they follow the first searches instead.
"""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.kernel.damped_newton import limited
from robokin.kernel.facts import fact
from robokin.workspace.extremes import extent, outermost
from robokin.workspace.faces import edges_of, faces_of
from robokin.workspace.geared_form import invertible
from robokin.workspace.geared_slopes import GearedSlopes
from robokin.workspace.geared_starts import PlacedStarts, geared_tables
from robokin.workspace.one_spare import one_spare_of
from robokin.workspace.sampling import moving_chain
from robokin.workspace.slopes import STEP, Slopes
from robokin.workspace.space import Space
from robokin.workspace.starts import Starts

Table = Starts | PlacedStarts

REACHED = 1e-7
"""Distance, in the arm's size, at which a point is reached."""

STUCK = 0.01
"""A search ends at a minimum: where Newton's step promises to take less than this part off the squared distance."""

CLOSE = 0.02
"""Searches that end this near [size] are taken up again, for they may be near a boundary from inside, where an arm
must be stretched to the last: what is left to gain is little, and the steps are many."""

STUCK_CLOSE, STEPS_CLOSE = 1e-3, 60
"""The same two limits for these."""

NEARLY, STUCK_LAST, STEPS_LAST = 2e-3, 1e-6, 300
"""Searches that ended this near [size] are followed to their very end: next to a singular configuration each step
gains a part of the distance only."""

NEAR_LAST = 3
"""Starts on each face for these."""

ALMOST, NEAR_ALMOST = 5e-5, 16
"""What is still this near [size], and no more, is sought from so many starts on each face and edge: where the arm is
singular with joints at their limits, steps gain ever less, and only starts on the right side of it arrive."""

NEAR_GEARED = 8, 48
"""Searches from starts near a point, at least and at most, where joints hang on each other: only starts on the right
one of several sheets arrive."""

SHEETS = 4
"""So many of them for each combination of quarters of a turn that the variables' ranges hold."""

ALMOST_GEARED = 2e-4
"""The same where joints hang on each other: no closed form has found what is beside a singular configuration."""

ON_LIMIT, STEPS_ON_LIMITS = 1e-6, 20
"""How near a limit [rad | size] a joint counts as on it in the very last steps, and how many these are."""

MU = 0.1
"""The damping at first, as a part of the distance."""

POOL = 2048
"""Searches that go on together: their columns stay in cache."""

BATCH = 16384
"""Points whose starts are looked up at a time."""

NEAR, FAR = 3, 2
"""Searches for a point before it is said to be out of reach: from starts near it and from anywhere."""

NEAR_CLOSE = 8
"""Searches from starts near a point that no search reached but one came close to."""

STEPS = 30
"""Steps of one search: from a start in the same cell five are enough, along a boundary it takes more."""

OUTER, SWEEPS = 4096, 2
"""Starts that lie between a sampled configuration and one that is sought as far out as it comes, and how often each
joint is given its best value for that: many joints are hardly ever all stretched by chance."""

MANY, MANY_GEARED, ROOM = 7, 4, 1e-3
"""From more joints on, or from more variables where joints hang on each other, it is bounds and reach, with some room
[size], that tell what need not be sought."""


class Descent:
    """Reaching for points with the moving joints of a space."""

    def __init__(self, space: Space) -> None:
        moving = list(space.moving)
        self.chain = moving_chain(space)
        self.slopes: Slopes | GearedSlopes = GearedSlopes(space) if space.gears is not None else Slopes(space)
        self.low, self.high, self.full = space.low[moving], space.high[moving], space.full[moving]
        self.size = space.size
        self.basis = space.basis if space.basis is not None else np.eye(3)
        self.centre = space.centre
        self.exact = one_spare_of(space)
        # What closed forms give need not be sought from everywhere.
        formed = space.gears is not None and len(moving) == space.dimension and invertible(space)
        self.starts: Table
        self.tables: list[list[Table]]
        self.learned: list[Table] = []
        if space.gears is None:
            box = self.chain, self.low, self.high, self.full
            spare = len(moving) > space.dimension and self.exact is None
            self.starts = Starts(self.chain, self.low, self.high, _outer(space))
            self.tables = [[*faces_of(*box)], [*edges_of(*box)]] if spare else []
        else:
            self.starts, faces, edges = geared_tables(space, self.slopes.place)
            self.tables = [] if formed else [[*faces], [*edges]]
        self.every_table = self.tables
        quarters = np.maximum((self.high - self.low)[space.robot.revolute[moving]] / (0.5 * np.pi), 1.0)
        sought = space.gears is not None and not formed
        self.sheets = int(np.clip(SHEETS * np.prod(quarters), *NEAR_GEARED)) if sought else 0
        self.almost = ALMOST if space.gears is None else ALMOST_GEARED
        # Samples of many joints lie close together; what they leave empty may well be reached.
        many = MANY if space.gears is None else MANY_GEARED
        self.extent = extent(space) if len(moving) > many else None
        # A joint that makes a whole turn may go round more than once.
        self.box = np.where(self.full, -np.inf, self.low)[:, None], np.where(self.full, np.inf, self.high)[:, None]

    def reachable(self, points: Array) -> Flags:
        """(m,) whether each of the points (m, 3) [m] is reached."""
        return self.reached(points)[0]

    def hurry(self) -> None:
        """Leave out the starts on edges until some are learned: for a million points, of which witnesses tell how
        many are denied."""
        self.tables = self.tables[:1]

    def lacks(self, points: Array) -> Array:
        """(m, 3) [m] the vectors from the nearest position that was found to points (m, 3): zero where reached, NaN
        where so far away that none was sought."""
        inside, q = self.reached(points)
        away = np.zeros(points.shape)
        away[~inside] = points[~inside] - self.slopes.place(q[:, ~inside]).T
        return away

    def reached(self, points: Array) -> tuple[Flags, Array]:
        """(m,) whether each of the points (m, 3) [m] is reached, and (n, m) by which values [rad | m], the nearest ones
        where it is not, NaN where none were sought."""
        p = np.ascontiguousarray(points.T)
        off = p - self.centre[:, None]
        off -= self.basis @ (self.basis.T @ off)
        inside = np.zeros(len(points), dtype=bool)
        values = np.full((len(self.low), len(points)), np.nan)
        in_plane = np.flatnonzero(np.sum(off * off, axis=0) <= (REACHED * self.size) ** 2)
        in_plane = in_plane[~self._beyond(p[:, in_plane])]
        for start in range(0, len(in_plane), BATCH):
            part = in_plane[start : start + BATCH]
            inside[part], values[:, part] = self._sought(p[:, part])
        return inside, values

    def learn(self, q: Array) -> None:
        """Begin searches also at configurations q (n, k) [rad | m], since they lead where no others did."""
        self.tables = self.every_table
        if isinstance(self.starts, Starts):
            self.learned.append(Starts(self.chain, self.low, self.high, more=q, kept=0))
        else:
            self.learned.append(PlacedStarts(self.slopes.place, self.starts.basis, self.starts.dimension, q))

    def _beyond(self, points: Array) -> Flags:
        """(m,) whether points (3, m) [m] lie so far from what can be reached that they need not be sought."""
        if self.extent is None:
            return self.starts.beyond(points)
        bounds, room = self.extent, ROOM * self.size
        away = np.linalg.norm(points - bounds.origin[:, None], axis=0)
        out = (away > bounds.greatest + room) | (away < bounds.least - room)
        out |= np.any((points < bounds.low[:, None] - room) | (points > bounds.high[:, None] + room), axis=0)
        return np.asarray(out)

    def _sought(self, points: Array) -> tuple[Flags, Array]:
        """`reached` for points (3, m) of the set's plane, m at most a batch.

        A pool of searches goes on together: one for each point, then the further starts of those not yet reached;
        where there is room they run beside each other, and what one of them reaches ends the others.
        """
        m = points.shape[1]
        inside, values = np.zeros(m, dtype=bool), np.zeros((len(self.low), m))
        least = np.full(m, np.inf)
        starts = self.starts.near(points, NEAR, FAR)
        self._search(points, np.arange(m), starts, [(STUCK, STEPS)] * (NEAR + FAR), inside, least, values)
        close = np.flatnonzero(~inside & (least <= CLOSE**2))
        if len(close):
            # The best end goes on; and it may lie on a barrier inside the set that another start goes round.
            others = self.starts.near(points[:, close], NEAR_CLOSE, 0)[NEAR:]
            starts = np.concatenate([values[None][:, :, close], others])
            ends = [(STUCK_CLOSE, STEPS_CLOSE)] + [(STUCK, STEPS)] * len(others)
            self._search(points, close, starts, ends, inside, least, values)
        self._escalate(points, inside, least, values)
        return inside, values

    def _escalate(self, points: Array, inside: Flags, least: Array, values: Array) -> None:
        """Whatever else can be done for those of points (3, m) that no search has reached yet."""
        left = np.flatnonzero(~inside)
        if self.exact is not None and len(left):
            there, q = self.exact.reached(np.ascontiguousarray(points[:, left].T))
            inside[left[there]], values[:, left[there]] = True, q[:, there]
        if self.sheets:
            left = np.flatnonzero(~inside)
            starts = self.starts.near(points[:, left], self.sheets, 0)[NEAR:]
            self._search(points, left, starts, [(STUCK, STEPS)] * len(starts), inside, least, values)
        for tables in [*self.tables, self.learned]:
            left = np.flatnonzero(~inside)
            if len(left) and tables:
                starts = np.concatenate([table.near(points[:, left], 1, 0) for table in tables])
                self._search(points, left, starts, [(STUCK, STEPS)] * len(starts), inside, least, values)
        left = np.flatnonzero(~inside & (least <= NEARLY**2))
        if len(left):
            more = [table.near(points[:, left], NEAR_LAST, 0) for table in (self.tables or [[]])[0]]
            starts = np.concatenate([values[None][:, :, left], *more])
            self._search(points, left, starts, [(STUCK_LAST, STEPS_LAST)] * len(starts), inside, least, values)
        left = np.flatnonzero(~inside & (least <= self.almost**2))
        if len(left):
            more = [table.near(points[:, left], NEAR_ALMOST, 0) for tables in self.every_table for table in tables]
            starts = np.concatenate(more) if more else np.empty((0, len(values), len(left)))
            self._search(points, left, starts, [(STUCK_LAST, STEPS_LAST)] * len(starts), inside, least, values)
            for i in left[~inside[left]].tolist():
                far, q = self._on_the_limits(points[:, i], values[:, i])
                if far < least[i]:
                    least[i], values[:, i], inside[i] = far, q, far <= REACHED**2

    def _on_the_limits(self, t: Array, q: Array) -> tuple[float, Array]:
        """What is left of the squared distance [size²] to t (3,) by undamped steps from q (n,), and where.

        Joints at their limits stay there: what the others can do there alone may be ill conditioned, and damping holds
        them back.
        """
        low, high, scale = self.low, self.high, self.slopes.scale[:, 0]
        held = ~self.full & ((q <= low + ON_LIMIT * scale) | (q >= high - ON_LIMIT * scale))
        least, best = float(np.inf), q
        for _ in range(STEPS_ON_LIMITS):
            e, J = self.slopes.lacking(t, q)
            far = float(np.sum(e * e))
            if far < least:
                least, best = far, q
            dx = np.asarray(np.linalg.lstsq(np.where(held, 0.0, J), e, rcond=1e-12)[0], np.float64)
            ahead = q + limited(dx[:, None], STEP, axis=0)[:, 0] * scale
            q = np.asarray(np.where(self.full, ahead, np.clip(ahead, low, high)))
        return least, best

    def _search(
        self,
        points: Array,
        which: Index,
        starts: Array,
        ends: list[tuple[float, int]],
        inside: Flags,
        least: Array,
        values: Array,
    ) -> None:
        """Searches for points[:, which] from each of the starts (k, n, len(which)) in turn, until they are reached;
        ends: what ends each, STUCK and STEPS or others."""
        pool = _Pool(self, points)
        for attempt, end in zip(starts, ends, strict=True):
            waiting = np.arange(len(which))
            while len(waiting):
                waiting = waiting[~inside[which[waiting]]]
                room = max(POOL - len(pool), 0)
                if room > POOL // 4:
                    take, waiting = waiting[:room], waiting[room:]
                    pool.add(which[take], attempt[:, take], *end)
                if len(waiting):
                    self._note(pool, inside, least, values)
        while len(pool):
            self._note(pool, inside, least, values)

    def _note(self, pool: _Pool, inside: Flags, least: Array, values: Array) -> None:
        """A step of the pool, and what has become known by it."""
        which, far, q = pool.advance()
        # Searches for one point may end together: the nearest is noted last, and so stays.
        order = np.argsort(-far, kind="stable")
        which, far, q = which[order], far[order], q[:, order]
        nearer = far < least[which]
        which, far, q = which[nearer], far[nearer], q[:, nearer]
        least[which] = far
        values[:, which] = q
        reached = which[far <= REACHED**2]
        inside[reached] = True
        if len(reached):
            pool.drop(inside)


def _outer(space: Space) -> Array:
    """(n, OUTER) configurations from those of the inside to the outermost ones."""
    rng = np.random.default_rng(OUTER)
    directions = rng.normal(size=(OUTER, 3))
    far = outermost(space, directions / np.linalg.norm(directions, axis=1)[:, None], SWEEPS)
    moving = list(space.moving)
    low, high = space.low[moving, None], space.high[moving, None]
    near = low + (high - low) * rng.random(far.shape)
    # One in four is as far out as it comes, and a joint may stand anywhere between.
    return np.asarray(near + (far - near) * np.minimum(4.0 / 3.0 * rng.random(OUTER), 1.0))


class _Pool:
    """Searches that go on together, each for its own point and from its own start.

    Not `damped_newton.led_down`, though steps are taken and damped alike: searches come while others go on, and end
    when another one reaches their point.
    """

    def __init__(self, descent: Descent, points: Array) -> None:
        self.descent, self.points = descent, points
        self.which = np.zeros(0, dtype=np.intp)
        self.state: list[Array] = []

    def __len__(self) -> int:
        """How many searches go on."""
        return len(self.which)

    def add(self, which: Index, q: Array, stuck: float, steps: int) -> None:
        """Searches for points `which` from q (n, k), until they are stuck or have made so many steps."""
        n, k = q.shape
        new = [
            q, q, np.full(k, np.inf), np.full(k, 2.0 * MU), np.full(k, float(steps)), np.full(k, stuck),
            *self.descent.slopes.blank(n, k),
        ]  # fmt: skip
        old = self.state or [part[..., :0] for part in new]
        self.state = [np.concatenate(pair, axis=-1) for pair in zip(old, new, strict=True)]
        self.which = np.concatenate([self.which, which])

    def drop(self, which: Flags) -> None:
        """End the searches for points that are known to be reached, `which` (m,)."""
        over = which[self.which]
        if over.any():
            self._keep(np.flatnonzero(~over))

    def _keep(self, keep: Index) -> None:
        self.which = self.which[keep]
        self.state = [part.take(keep, axis=-1) for part in self.state]

    def advance(self) -> tuple[Index, Array, Array]:
        """A step of every search: the points of those that ended, their squared distances and their values."""
        q, tried, far, mu, left, stuck, *parts = self.state
        far2, *parts2 = self.descent.slopes.model(self.points.take(self.which, axis=1), tried)
        better = far2 < far
        mu *= np.where(better, np.where(far2 < 0.1 * far, 0.1, 0.5), 8.0)
        for old, new in ((q, tried), (far, far2), *zip(parts, parts2, strict=True)):
            np.copyto(old, new, where=better)
        left -= 1.0
        dq, gain = self.descent.slopes.step(q, self.descent.box, far, mu, parts)
        over = (far <= REACHED**2) | (gain <= stuck * far) | (left < 0.0)
        out = np.flatnonzero(over)
        answer = self.which[out], far[out], q[:, out]
        self.state = [q, np.clip(q + dq, *self.descent.box), far, mu, left, stuck, *parts]
        if len(out):
            self._keep(np.flatnonzero(~over))
        return answer


@fact
def descent_of(space: Space) -> Descent:
    """The descent of a space, with its table of starts, made when it is first asked for."""
    return Descent(space)
