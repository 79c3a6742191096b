"""What follows poses, for each kind of robot: joints move one by one, hang on each other, or follow others."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal, Protocol

import numpy as np

from robokin.arrays import Array, Index
from robokin.inverse.coupled_search import coupled_tips
from robokin.inverse.follow import DAMPING, HALVINGS, LONGEST, NEAR, STEPS, Follower
from robokin.inverse.numeric.driven_descent import driven_ends
from robokin.inverse.numeric.driven_tips import errors_and_slopes
from robokin.inverse.verify import CLOSES
from robokin.kernel.damped_newton import brought_down, limited, singular_step
from robokin.kinematics.jacobian import jacobian
from robokin.model import CoupledRobot, Robot

AROUND = (1e-4, 1e-3, 1e-2, 0.05, 0.3)
"""How far around a configuration [rad | size] descents start where steps from it do not arrive."""

AROUND_EACH = 4
"""How many of them so far: of two ways out of a stretched arm one of them finds each."""


class Follows(Protocol):
    """What `Follower` and `CoupledFollower` both do."""

    def advance(self, q: Array, before: float, i: int) -> tuple[float, Array, str]:
        """See `Follower.advance`."""

    def nearest(self, q: Array, s: float) -> Array | None:
        """See `Follower.nearest`."""

    def stepped(self, q: Array, s: float) -> Array | None:
        """See `Follower.stepped`."""

    def begin(self, q: Array) -> None:
        """See `Follower.begin`."""

    def run(self, q: Array, i: int) -> Array:
        """See `Follower.run`."""

    def beginnings(self, q: Array) -> list[tuple[Array, Array]]:
        """See `Follower.beginnings`."""


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

    def stepped(self, q: Array, s: float) -> Array | None:
        """See `Follower.stepped`."""
        v = self.follower.stepped(self.drive.motions(q), s)
        return None if v is None else self.drive.variables_for(v)

    def begin(self, q: Array) -> None:
        """See `Follower.begin`."""
        self.follower.begin(q)

    def run(self, q: Array, i: int) -> Array:
        """See `Follower.run`."""
        return self.drive.variables_for(self.follower.run(self.drive.motions(q), i))

    def beginnings(self, q: Array) -> list[tuple[Array, Array]]:
        """See `Follower.beginnings`."""
        ways = self.follower.beginnings(self.drive.motions(q))
        return [(self.drive.variables_for(start), self.drive.variables_for(begun)) for start, begun in ways]


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
        self.begin(np.zeros(robot.n))
        away = np.random.default_rng(0).uniform(-1.0, 1.0, (AROUND_EACH, robot.n))
        moved = jacobian(robot, self.scale * away[0])[: 3 if task == "position" else 6]
        self.spare = bool(np.linalg.matrix_rank(moved * self.scale, tol=1e-9 * np.max(np.abs(moved))) < robot.n)
        self._around = np.concatenate([np.zeros((1, robot.n)), *(far * away for far in AROUND)])

    def run(self, q: Array, i: int) -> Array:
        """See `Follower.run`."""
        return np.empty((0, len(q)))

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


def follower_of(
    robot: Robot,
    at: Callable[[Array], Array],
    task: Literal["pose", "position"],
    s: Array,
    halvings: int = HALVINGS,
) -> Follows:
    """What follows poses at(s), looked up at places s (k,); a step is halved up to `halvings` times."""
    if isinstance(robot, CoupledRobot) and not robot.drive.invertible:
        follower: Follower = DrivenFollower(robot, at, task, s)
    else:
        follower = Follower(robot.free_motion if isinstance(robot, CoupledRobot) else robot, at, task, s)
    follower.halvings = halvings
    if isinstance(robot, CoupledRobot) and robot.drive.invertible:
        return CoupledFollower(robot, follower)
    return follower
