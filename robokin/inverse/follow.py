"""One branch of inverse kinematics along a path of poses."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal, Protocol

import numpy as np

from robokin.arrays import Array, Index
from robokin.inverse.analysis import analysis_of
from robokin.inverse.coupled_search import coupled_tips
from robokin.inverse.numeric.driven_descent import driven_ends
from robokin.inverse.numeric.driven_tips import errors_and_slopes
from robokin.inverse.numeric.least_squares import descend
from robokin.inverse.self_motion.nearest_member import nearest_on
from robokin.inverse.self_motion.solution_sets import families
from robokin.inverse.solve import solve_many
from robokin.inverse.verify import CLOSES
from robokin.kernel.damped_newton import brought_down, limited, singular_step
from robokin.kernel.frames import pose
from robokin.kernel.residual import error_and_jacobian
from robokin.kinematics.jacobian import jacobian
from robokin.model import CoupledRobot, Robot
from robokin.spatial.angles import circled

NEAR = 0.1
"""A step that moves no joint by more [rad | size] is no jump: different solutions are farther apart but near a
singularity, and there a step is halved while it gets shorter by that."""

HALVINGS = 26
"""How often a step is halved at most, to 1e-8 of itself. A joint that still moves by more than NEAR jumps."""

BEGUN = 1e-6
"""Part of the line after which its solutions tell how it begins: they are then 1e-6 from where they begin, or 1e-3
where two meet."""

MOST = 1_000_000
"""Steps of a path at most: what is kept of each is some hundred bytes."""

STEPS = 30
"""Newton steps to one pose; three do where the arm is regular."""

LONGEST = 0.3
"""The longest of them [rad | size]."""

DAMPING = 1e-3
"""Damping of these steps as a part of the squared error."""

AROUND = (1e-4, 1e-3, 1e-2, 0.05, 0.3)
"""How far around a configuration [rad | size] descents start where steps from it do not arrive."""

AROUND_EACH = 4
"""How many of them so far: of two ways out of a stretched arm one of them finds each."""

BLOCK = 1024
"""Poses that are solved together."""


class Follower:
    """Follows poses at(s): (m,) -> (m, 4, 4), looked up at the places s (k,) one after the other."""

    def __init__(self, robot: Robot, at: Callable[[Array], Array], task: Literal["pose", "position"], s: Array) -> None:
        self.robot, self.at, self.task, self.s = robot, at, task, s
        self.analysis = analysis_of(robot, task)
        self.scale = np.where(robot.revolute, 1.0, self.analysis.size)
        self.spare = bool(self.analysis.redundancy or self.analysis.idle)
        self.numeric = self.spare or self.analysis.solver is None
        self.block: tuple[int, Array, Index] | None = None
        self.poses = at(s)
        self.ahead = np.zeros(robot.n)

    def advance(self, q: Array, before: float, i: int) -> tuple[float, Array, str]:
        """From q (n,) at `before` to place i: how far it got, with which q, and what stopped it (unreachable, jump)."""
        end = float(self.s[i])
        found = self.track(q, self.poses[i], self.ahead) if self.numeric else self.chosen(self.listed(i), q)
        if found is not None and self.move(q, found) <= NEAR:
            # Steps grow and shrink slowly with the time law: the last one is a good guess of the next. Not where joints
            # are to spare: what they did with the tool at rest would go on and on.
            if not self.spare:
                self.ahead = found - q
            return end, found, ""
        self.ahead = np.zeros_like(q)
        return self.halved(q, before, end)

    def halved(self, q: Array, before: float, end: float) -> tuple[float, Array, str]:
        """The same by steps as short as they must be."""
        at, step, least = before, end - before, (end - before) * 0.5**HALVINGS
        why = ""
        while at < end:
            ahead = min(at + step, end)
            found = self.nearest(q, ahead)
            if found is not None and self.move(q, found) <= NEAR:
                at, q, step = ahead, found, 2.0 * step
                continue
            why = "unreachable" if found is None else "jump"
            step /= 2.0
            if step < least:
                return at, q, why
        return end, q, ""

    def nearest(self, q: Array, s: float) -> Array | None:
        """The configuration (n,) at s that is nearest to q, or None where there is none."""
        if self.numeric:
            return self.track(q, self.at(np.array([s]))[0], np.zeros_like(q))
        # Asked for near q, a family of solutions is met at its nearest member.
        batch = solve_many(self.robot, self.at(np.array([s])), limits=False, near=q, task=self.task)
        return self.chosen(batch.q[0, : batch.count[0]], q)

    def turned_start(self, q: Array, i: int) -> Array | None:
        """A configuration (n,) with the pose of q (n,), from which a line goes on that q itself does not begin.

        At a singular start joints can trade motion while the tool stands still; the solutions a little way along the
        line tell from which member of that self-motion it goes on. None where there is none.
        """
        if self.numeric:
            return None
        chain, size = self.analysis.own, self.analysis.size
        T = self.at(self.s[i - 1 : i])
        batch = solve_many(self.robot, self.at(self.s[i - 1 : i] + BEGUN), limits=False, near=q, task=self.task)
        begun = batch.q[0, : batch.count[0]]
        moving = self.analysis.moving
        sets = families(chain, T, np.concatenate([q[moving], np.zeros(self.analysis.open)])[None], size).curves[0]
        wide = np.tile([-np.inf, np.inf], (len(moving), 1))
        best: Array | None = None
        for curve in sets:
            for other in begun:
                member = nearest_on(curve, chain, T[0], other[moving], wide, size)
                if member is None:
                    continue
                there = q.copy()
                there[moving] = member
                start = self.turned(there, q)
                near = self.move(start, self.turned(other, start)) <= NEAR
                if near and (best is None or self.move(q, start) < self.move(q, best)):
                    best = start
        return best

    def listed(self, i: int) -> Array:
        """All configurations (k, n) at place i, some poses ahead solved with them."""
        if self.block is None or not self.block[0] <= i < self.block[0] + BLOCK:
            batch = solve_many(self.robot, self.poses[i : i + BLOCK], limits=False, task=self.task)
            self.block = i, batch.q, batch.count
        first, rows, count = self.block
        return rows[i - first, : count[i - first]]

    def turned(self, x: Array, q: Array) -> Array:
        """A configuration x (n,) with its angles turned as near to q (n,) as they come."""
        return np.asarray(q + circled(x - q, self.robot.revolute))

    def chosen(self, rows: Array, q: Array) -> Array | None:
        """The nearest of the rows (k, n), angles turned as near to q as they come."""
        if not len(rows):
            return None
        gap = circled(rows - q, self.robot.revolute)
        best = int(np.argmin(np.max(np.abs(gap) / self.scale, axis=1)))
        return np.asarray(q + gap[best])

    def track(self, q: Array, T: Array, ahead: Array) -> Array | None:
        """The configuration at the pose T (4, 4) that steps of least joint motion lead to from q, or from q + ahead."""
        chain, size, opened = self.analysis.chain, self.analysis.size, self.analysis.open
        x = np.concatenate([q, np.zeros(opened)])
        if opened:
            # What is left open turns from where the tool is: its rotation is the target's.
            T = T.copy()
            T[:3, :3] = pose(chain, x)[:3, :3]
        found = self.steps(np.concatenate([q + ahead, np.zeros(opened)]), T[None])
        if found is not None and (self.robot.within_limits(found[: len(q)]) or not self.robot.within_limits(q)):
            return found[: len(q)]
        # A joint that meets its limit is held there, if the others can do without it.
        limits = np.concatenate([self.robot.limits, np.tile([-np.inf, np.inf], (opened, 1))])
        held, error = descend(chain, T[None], x[None], size, limits=limits)
        if np.max(np.abs(error)) <= CLOSES and self.robot.within_limits(q):
            return np.asarray(held[0, : len(q)])
        return None if found is None else found[: len(q)]

    def steps(self, x: Array, T: Array) -> Array | None:
        """Joint values (k,) that Newton's steps of least motion lead to from x (k,); None where they do not close."""
        chain, size = self.analysis.chain, self.analysis.size
        scale = np.where(chain.revolute, 1.0, size)
        endless = np.full(chain.n, np.inf)

        def errors(_: Index, x: Array) -> tuple[Array, Array]:
            return error_and_jacobian(chain, T, x * scale, size)

        def step(_: Index, x: Array, e: Array, J: Array) -> Array:
            # The damping is far below what regular configurations notice, and keeps singular ones finite.
            damping = DAMPING * (np.max(e * e) + 1e-9) * np.eye(6)
            A = J[0]
            return limited((A.T @ np.linalg.solve(A @ A.T + damping, e[0]))[None], LONGEST)

        ends, e = brought_down(
            errors, step, (x / scale)[None], -endless, endless, steps=STEPS, arrived=(0.1 * CLOSES) ** 2
        )
        return ends[0] * scale if np.max(np.abs(e)) <= 0.1 * CLOSES else None

    def move(self, q: Array, other: Array) -> float:
        """The greatest joint move between two configurations [rad | size]."""
        return float(np.max(np.abs(other - q) / self.scale))


class Follows(Protocol):
    """What `Follower` and `CoupledFollower` both do."""

    def advance(self, q: Array, before: float, i: int) -> tuple[float, Array, str]:
        """See `Follower.advance`."""

    def nearest(self, q: Array, s: float) -> Array | None:
        """See `Follower.nearest`."""

    def turned_start(self, q: Array, i: int) -> Array | None:
        """See `Follower.turned_start`."""


class CoupledFollower:
    """The same for a robot whose joints hang on each other: the arm whose joints move one by one goes ahead."""

    def __init__(self, robot: CoupledRobot, follower: Follower) -> None:
        self.drive, self.follower = robot.drive, follower

    def advance(self, q: Array, before: float, i: int) -> tuple[float, Array, str]:
        """See `Follower.advance`."""
        reached, v, why = self.follower.advance(self.drive.motions(q), before, i)
        return reached, self.drive.variables_for(v), why

    def nearest(self, q: Array, s: float) -> Array | None:
        """See `Follower.nearest`."""
        v = self.follower.nearest(self.drive.motions(q), s)
        return None if v is None else self.drive.variables_for(v)

    def turned_start(self, q: Array, i: int) -> Array | None:
        """See `Follower.turned_start`."""
        v = self.follower.turned_start(self.drive.motions(q), i)
        return None if v is None else self.drive.variables_for(v)


class DrivenFollower(Follower):
    """The same for a robot whose joints follow others: steps of least motion of what is typed, no list of solutions.

    Where they do not arrive, as from a stretched arm, all of whose steps lead outwards, descents from around there do.
    """

    def __init__(
        self, robot: CoupledRobot, at: Callable[[Array], Array], task: Literal["pose", "position"], s: Array
    ) -> None:
        self.robot, self.at, self.task, self.s = robot, at, task, s
        self.free, self.bounded = coupled_tips(robot, task, False), coupled_tips(robot, task, True)
        self.scale = self.free.scale
        self.numeric = True
        self.poses = at(s)
        self.ahead = np.zeros(robot.n)
        away = np.random.default_rng(0).uniform(-1.0, 1.0, (AROUND_EACH, robot.n))
        moved = jacobian(robot, self.scale * away[0])[: 3 if task == "position" else 6]
        self.spare = bool(np.linalg.matrix_rank(moved * self.scale, tol=1e-9 * np.max(np.abs(moved))) < robot.n)
        self._around = np.concatenate([np.zeros((1, robot.n)), *(far * away for far in AROUND)])

    def track(self, q: Array, T: Array, ahead: Array) -> Array | None:
        """See `Follower.track`."""
        found = self._steps(q + ahead, T)
        if found is not None and self.move(q, found) > NEAR:
            found = None
        inside = bool(self.robot.within_limits(q))
        if found is not None and (self.robot.within_limits(found) or not inside):
            return found
        # Either it is singular, or a joint meets its limit and the others may do without it.
        around = q + self.scale * self._around
        tips = self.bounded if inside else self.free
        u = np.clip(around, tips.limits[:, 0], tips.limits[:, 1])
        ends = driven_ends(tips, np.repeat(T[None, None], len(u), axis=0), u, STEPS)
        moves = np.where(ends.reached, np.max(np.abs(ends.u - q) / self.scale, axis=1), np.inf)
        best = int(np.argmin(moves))
        if moves[best] <= NEAR or (found is None and np.isfinite(moves[best])):
            return np.asarray(ends.u[best])
        return found

    def _steps(self, u: Array, T: Array) -> Array | None:
        """The variables (n,) that steps of least motion lead to from u (n,); None where they do not arrive."""
        endless = np.full(len(u), np.inf)
        target = T[None, None]

        def errors(_: Index, x: Array) -> tuple[Array, Array]:
            return errors_and_slopes(self.free, target, x * self.scale)

        def step(_: Index, x: Array, e: Array, J: Array) -> Array:
            damping = DAMPING * (np.max(e * e, axis=1) + 1e-9)
            # Of a great ratio next to small ones: by singular values, since what is squared is lost in rounding.
            return limited(singular_step(J, e, damping), LONGEST)

        ends, e = brought_down(
            errors, step, (u / self.scale)[None], -endless, endless, steps=STEPS, arrived=(0.1 * CLOSES) ** 2
        )
        return np.asarray(ends[0] * self.scale) if np.max(np.abs(e)) <= 0.1 * CLOSES else None


def follower_of(robot: Robot, at: Callable[[Array], Array], task: Literal["pose", "position"], s: Array) -> Follows:
    """What follows poses at(s), looked up at places s (k,)."""
    if not isinstance(robot, CoupledRobot):
        return Follower(robot, at, task, s)
    if not robot.drive.invertible:
        return DrivenFollower(robot, at, task, s)
    return CoupledFollower(robot, Follower(robot.free_motion, at, task, s))
