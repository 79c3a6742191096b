"""A block of targets with their answers as flat lists: what is listed of what was found, and in which order."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.analysis import Analysis
from robokin.inverse.claims import unclaimed
from robokin.inverse.known_motions import known_families, known_motions, with_known
from robokin.inverse.numeric.closest import TOGETHER, beyond_reach, nearest_configurations
from robokin.inverse.numeric.closing import closing_nearest
from robokin.inverse.numeric.least_squares import descend
from robokin.inverse.numeric.nearest import free_at, numeric_solutions
from robokin.inverse.self_motion.arcs import arcs_of_each
from robokin.inverse.self_motion.chosen_members import SelfMotion
from robokin.inverse.self_motion.members import listed_once
from robokin.inverse.self_motion.onto_limits import onto_limits
from robokin.inverse.self_motion.redundant import MOST_SOUGHT, UNPROVEN, supplemented
from robokin.inverse.self_motion.spread import well_spread
from robokin.inverse.self_motion.swivel_members import SwivelAnswers
from robokin.inverse.solution_names import branch_names, listed_names
from robokin.inverse.solutions import Arc, Family
from robokin.inverse.solve_blocks import solve_block, turned_in_the_open
from robokin.inverse.verify import CLOSES, Found, distinct, merged, nothing, with_ones_within, within_limits, wrapped
from robokin.kernel.residual import distance_and_angle, error_and_jacobian
from robokin.model import Robot
from robokin.model.robot import tolerated
from robokin.spatial.transforms import FARTHEST

Method = Literal["auto", "analytic", "numeric"]

TYPED = 1e-3
"""A wish that misses a target by less [size and rad] is meant to be a solution for it: it was typed or printed."""

USELESS = 10.0 * FARTHEST
"""A limit beyond this [m] keeps a joint from no target, and its square may be no number."""

MOST = 16
"""Solutions listed for an arm that has infinitely many."""

STANDS = 1e-5
"""A listed solution this near [rad | size] to the member that was chosen to stand for a self-motion is that member."""

OUTSIDE = "outside the joint limits"
"""The reason where there are solutions but for the limits."""


@dataclass(frozen=True, eq=False)
class Request:
    """What is asked for, checked; pattern: (n,) values of held joints [rad | m], NaN for its own, for the kernel."""

    robot: Robot
    analysis: Analysis
    limits: bool
    near: Array | None
    method: Method
    most: int | None
    seed: int
    motions: bool = False
    pattern: Array | None = None

    @cached_property
    def own_limits(self) -> Array:
        """(n, 2) the limits that searches stay within; those of a slide beyond every target are none."""
        none = np.tile([-np.inf, np.inf], (self.robot.n, 1))
        if not self.limits:
            return none
        return np.where(np.abs(self.robot.limits) > USELESS, none, self.robot.limits)

    @property
    def wanted(self) -> int:
        """How many solutions are looked for where there are infinitely many."""
        return MOST if self.most is None or self.most > MOST_SOUGHT else self.most

    @cached_property
    def middle(self) -> Array:
        """(n,) where a joint is put that may be anywhere [rad | m]: at `near`, or at zero, or amid its limits."""
        low, high = self.robot.limits.T
        if self.near is not None:
            turned, _ = within_limits(self.near[None], self.robot.revolute, self.robot.limits, self.near)
            return np.clip(turned[0], low, high) if self.limits else self.near
        with np.errstate(invalid="ignore"):
            amid = np.where(np.isfinite(low) & np.isfinite(high), (low + high) / 2.0, np.clip(0.0, low, high))
        return np.where((low <= 0.0) & (high >= 0.0), 0.0, amid)


class TargetBlock:
    """The answers for a block of targets, as flat lists."""

    def __init__(self, request: Request, T: Array) -> None:
        robot, analysis = request.robot, request.analysis
        self.request, self.T = request, T
        self._nearest: dict[int, tuple[Array, float, float]] = {}
        self._arcs: dict[int, list[tuple[Arc, ...]]] = {}
        found, since = self._solved()
        found, inside = _limited(request, found)
        if request.limits and not analysis.redundancy and not analysis.open:
            found, moved = onto_limits(analysis, T, found, inside, request.own_limits)
            if moved.any():
                found, inside = _limited(request, distinct(found, robot.revolute, analysis.size))
        later: Index | None = None
        if request.method != "numeric" and analysis.solver is not None and analysis.redundancy:
            search = ~self.beyond if request.method == "auto" else np.zeros(len(T), dtype=bool)
            limits, middle = request.own_limits, request.middle
            counting = inside if request.limits else np.ones(len(found), dtype=bool)
            count = np.bincount(found.index[counting], minlength=len(T))
            if self.swivel is not None:
                count, search = np.where(self.swivel.known, MOST_SOUGHT, count), search & ~self.swivel.known
            more, later = supplemented(
                analysis, T, limits, middle, request.seed, found, count, request.wanted, MOST, search
            )
            more, more_inside = _limited(request, more)
            order = np.argsort(np.concatenate([found.index, more.index]), kind="stable")
            later = np.concatenate([since, later])[order]
            found, inside = merged(found, more).pick(order), np.concatenate([inside, more_inside])[order]
        searches: list[Callable[[Analysis, Array, Array, Array, int], Found]] = []
        if request.method == "numeric" or (request.method == "auto" and analysis.solver is None):
            searches = [numeric_solutions, closing_nearest]
        elif request.method == "auto" and not analysis.redundancy:
            # Where nothing vouches for there being none, what comes nearest within the limits may close.
            searches = [closing_nearest]
        for search_for in searches:
            if (self.claims.basis > 0).all():
                break
            answered = (np.bincount(found.index[inside], minlength=len(T)) > 0) | self.beyond | (self.claims.basis > 0)
            missing = np.flatnonzero(~answered)
            if len(missing):
                more = search_for(analysis, T[missing], request.own_limits, request.middle, request.seed)
                if analysis.solver is not None and not analysis.open:
                    more = self._each_once(missing, more)
                both = _with_more(found, more, missing)
                once = distinct(both, robot.revolute, analysis.size)
                once, _ = with_ones_within(once, both, robot.revolute, request.own_limits, analysis.size)
                found, inside = _limited(request, once)
        self.closing = np.bincount(found.index, minlength=len(T))
        self.every = found.q, found.index
        if request.limits:
            later = None if later is None else later[inside]
            found, inside = found.pick(inside), inside[inside]
        self.within = np.bincount(found.index, minlength=len(T))
        self.found, self.inside = in_order(request, found, inside, later)
        whole = len(self.found) == len(found)
        self.count = self.within if whole else np.bincount(self.found.index, minlength=len(T))
        self.cut = self.within > self.count

    def _solved(self) -> tuple[Found, Index]:
        """What the closed forms and eliminations find, with the generations of what is listed of self-motions (s,).

        `swivel` is what is known of these, and `claims` what may be said.
        """
        request, T, analysis = self.request, self.T, self.request.analysis
        found, self.claims = nothing(request.robot.n), unclaimed(len(T))
        self.swivel: SwivelAnswers | None = None
        if request.method == "numeric":
            return found, np.empty(0, dtype=np.intp)
        if analysis.solver is not None:
            bounds = request.own_limits, request.robot.limits
            self.swivel = known_motions(analysis, T, *bounds, request.near, max(request.wanted, MOST))
        others = np.arange(len(T)) if self.swivel is None else np.flatnonzero(~self.swivel.known)
        if len(others):
            found, self.claims = solve_block(analysis, T[others], request.own_limits, request.near, request.middle)
        if request.near is not None and analysis.redundancy and not analysis.open:
            found = _with_more(found, _beside(request, T[others], request.near), np.arange(len(others)))
        if self.swivel is None:
            return found, np.zeros(len(found), dtype=np.intp)
        found, since, self.claims = with_known(found, others, self.swivel)
        return found, since

    def __getstate__(self) -> dict[str, Any]:
        """All but what was asked: the process that asked another one has it, and sets it again."""
        return {name: value for name, value in self.__dict__.items() if name != "request"}

    def _each_once(self, targets: Index, more: Found) -> Found:
        """What a search found for some targets (k,), by these, with each multiple root and each self-motion once."""
        request, analysis = self.request, self.request.analysis
        moving, motions = analysis.moving, self.claims.motions
        order = np.argsort(more.index, kind="stable")
        found = Found(more.index[order], more.q[order][:, moving], more.position[order], more.angle[order])
        found = distinct(found, analysis.own.revolute, analysis.size)
        followed = {k: [one.curve for one in motions.get(i, ())] for k, i in enumerate(targets.tolist())}
        wish = None if request.near is None else request.near[moving]
        found, said, _, _ = listed_once(
            analysis.own,
            analysis.solver,
            self.T[targets],
            found,
            analysis.size,
            request.own_limits[moving],
            request.middle[moving],
            wish,
            followed,
        )
        for k, some in said.items():
            again = [one.curve for one in some]
            others = [one for one in motions.get(int(targets[k]), ()) if all(one.curve is not curve for curve in again)]
            motions[int(targets[k])] = [*others, *some]
        q = np.tile(request.middle, (len(found), 1))
        q[:, moving] = found.q
        return Found(found.index, q, found.position, found.angle)

    def pad(self, q: Array, position: Array, angle: Array, inside: Flags) -> None:
        """Put what is listed into tables: joint values (m, most, n), distances, angles, inside, (m, most) each.

        Rows beyond a target's number are NaN and not inside.
        """
        found = self.found
        rows = np.flatnonzero(np.arange(q.shape[1]) < self.count[:, None])
        for table, values in ((q, found.q), (position, found.position), (angle, found.angle), (inside, self.inside)):
            if len(rows) < inside.size:
                table.fill(np.nan if table.dtype == np.float64 else False)
            table.reshape(inside.size, *table.shape[2:])[rows] = values

    @cached_property
    def names(self) -> list[str]:
        """The branch of each configuration."""
        robot, found = self.request.robot, self.found
        if self.request.analysis.redundancy:
            # What is listed is a choice. Orientations that were tried are no postures, and no numbers tell them apart.
            return branch_names(robot, found.q, None if self.request.analysis.open else found.index)
        return listed_names(robot, found.q, found.index, self.every)

    @cached_property
    def free(self) -> list[tuple[int, ...]]:
        """The joints of each configuration that may trade motion with each other."""
        analysis, found = self.request.analysis, self.found
        if analysis.redundancy or analysis.solver is None or self.request.method == "numeric":
            return free_at(analysis, found.q) if len(found) else []
        moving, idle = analysis.moving, tuple(i + 1 for i in analysis.idle)
        free = [idle] * len(found)
        for i, motions in self.claims.motions.items():
            rows = np.arange(np.searchsorted(found.index, i), np.searchsorted(found.index, i, side="right"))
            for motion in motions:
                row = stands_for(self.request.robot, analysis, found.q[rows], motion)
                if row >= 0:
                    own = {int(moving[k - 1]) + 1 for k in motion.curve.joints if k <= len(moving)}
                    free[rows[row]] = tuple(sorted({*idle, *own}))
        return free

    def in_closed_form(self, i: int) -> bool:
        """Whether the self-motions of target i are known as intervals of the swivel angle."""
        return self.swivel is not None and bool(self.swivel.known[i])

    def families(self, i: int) -> tuple[Family, ...] | None:
        """The self-motions of target i where all are known in closed form, None elsewhere."""
        if self.swivel is None or not self.swivel.known[i]:
            return None
        return known_families(self.swivel, i, self.request.own_limits, self.found.q[self.found.index == i])

    def outside(self, i: int) -> str:
        """Why target i, which has solutions but for the limits, has none: proven or not."""
        return OUTSIDE if self.claims.basis[i] else UNPROVEN

    @cached_property
    def turned(self) -> Array:
        """The targets (m, 4, 4) as the solver takes them."""
        return turned_in_the_open(self.request.analysis, self.T)

    @cached_property
    def beyond(self) -> Flags:
        """Which targets are farther off than the arm is long."""
        return beyond_reach(self.request.analysis, self.T, self.request.own_limits)

    def arcs(self, i: int) -> list[tuple[Arc, ...]]:
        """Of each self-motion of target i the pieces within the limits, in the joints that are solved for.

        Together they take less time each: with these those of the next targets are found.
        """
        if i not in self._arcs:
            motions = self.claims.motions
            targets = sorted(k for k in motions if k >= i)[:TOGETHER]
            pairs = [(k, motion.curve) for k in targets for motion in motions[k]]
            analysis = self.request.analysis
            limits, T = self.request.own_limits[analysis.moving], self.turned[[k for k, _ in pairs]]
            found = arcs_of_each([curve for _, curve in pairs], analysis.own, T, limits, analysis.size)
            for (k, _), arcs in zip(pairs, found, strict=True):
                self._arcs.setdefault(k, []).append(arcs)
        return self._arcs[i]

    def nearest(self, i: int) -> tuple[Array, float, float]:
        """The configuration (n,) closest to target i, which has no solution, and its distance [m] and angle [rad].

        Together they take less time each: the more are asked for, the more of the next targets' are found with one,
        of those without a solution of the same kind, as often only one kind is asked for.
        """
        if i not in self._nearest:
            alike = (self.count == 0) & ((self.closing > 0) == (self.closing[i] > 0))
            rows = i + np.flatnonzero(alike[i:])[: min(TOGETHER, 1 + len(self._nearest))]
            request = self.request
            found = nearest_configurations(
                request.analysis, self.T[rows], request.own_limits, request.middle, request.seed
            )
            for row, q, position, angle in zip(rows.tolist(), *found, strict=True):
                self._nearest[row] = q, float(position), float(angle)
        return self._nearest[i]


def _beside(request: Request, T: Array, near: Array) -> Found:
    """The solutions for targets T (m, 4, 4) that steps from `near` (n,) lead to, where it nearly is one itself."""
    analysis, chain = request.analysis, request.analysis.chain
    start = np.tile(near, (len(T), 1))
    off, _ = error_and_jacobian(chain, T, start, analysis.size)
    index = np.flatnonzero(np.max(np.abs(off), axis=1) <= TYPED)
    q, off = descend(chain, T[index], start[index], analysis.size, limits=request.own_limits, steps=10)
    position, angle = distance_and_angle(off)
    closes = (position <= CLOSES) & (angle <= CLOSES)
    return Found(index, q, position * analysis.size, angle).pick(closes)


def _with_more(found: Found, more: Found, missing: Index) -> Found:
    """All configurations, sorted by target; more's targets are numbered as in `missing`."""
    both = merged(found, more.numbered(missing))
    return both.pick(np.argsort(both.index, kind="stable"))


def _limited(request: Request, found: Found) -> tuple[Found, Flags]:
    """Angles turned into the limits, and which configurations are within them.

    Where limits do not count, an angle whose wish is outside them is turned next to the wish.
    """
    robot = request.robot
    if request.near is None or request.limits or robot.within_limits(request.near):
        q, inside = within_limits(found.q, robot.revolute, robot.limits, request.near)
    else:
        low, high = tolerated(robot.limits)
        outside = (request.near < low) | (request.near > high)
        counting = np.where(outside[:, None], [-np.inf, np.inf], robot.limits)
        q, _ = within_limits(found.q, robot.revolute, counting, request.near)
        inside = np.asarray(robot.within_limits(q)).reshape(len(q))
    return Found(found.index, q, found.position, found.angle), inside


def in_order(request: Request, found: Found, inside: Flags, later: Index | None) -> tuple[Found, Flags]:
    """By target, then by the move from `near` if there is one, and cut to the number asked for.

    Of infinitely many some well spread ones; without `near` each is the farthest from those before it. later: (s,)
    the generation of each, if there are any; the first ones are listed first.
    """
    analysis, revolute = request.analysis, request.robot.revolute
    if not len(found):
        return found, inside
    scale = np.where(revolute, 1.0, analysis.size)
    if analysis.redundancy or analysis.solver is None:
        move = np.max(np.abs(found.q - request.middle) / scale, axis=1)
        most = MOST if request.most is None else request.most
        rank = inside.astype(np.intp)
        if later is not None:
            rank *= 1 + later.max(initial=0) - later
        chosen = well_spread(found.index, wrapped(found.q, revolute) / scale, revolute, move, rank, most)
        found, inside = found.pick(chosen), inside[chosen]
    if request.near is not None:
        move = np.max(np.abs(found.q - request.near) / scale, axis=1)
        order = np.lexsort((move, found.index))
        found, inside = found.pick(order), inside[order]
    if request.most is None:
        return found, inside
    rank = np.arange(len(found)) - np.searchsorted(found.index, found.index)
    keep = rank < request.most
    return found.pick(keep), inside[keep]


def stands_for(robot: Robot, analysis: Analysis, q: Array, motion: SelfMotion) -> int:
    """Which of solutions q: (k, n) stands for a self-motion; -1 for none, as where the list was cut."""
    moving = analysis.moving
    if not len(moving) or not len(q):
        return -1
    turning = robot.revolute[moving]
    away = (q[:, moving] - motion.q[: len(moving)]) / np.where(turning, 1.0, analysis.size)
    gap = np.max(np.abs(wrapped(away, turning)), axis=1)
    return int(np.argmin(gap)) if np.min(gap) <= STANDS else -1
