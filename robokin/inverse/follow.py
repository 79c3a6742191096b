"""One branch of inverse kinematics along a path of poses."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np

from robokin.arrays import Array, Index
from robokin.inverse.analysis import analysis_of
from robokin.inverse.listed_rows import ListedRows, leads
from robokin.inverse.numeric.least_squares import descend
from robokin.inverse.plain_rows import PlainRows
from robokin.inverse.solve import solve_many
from robokin.inverse.verify import CLOSES, ROUNDING
from robokin.kernel.damped_newton import brought_down, limited
from robokin.kernel.frames import pose
from robokin.kernel.residual import error_and_jacobian
from robokin.kinematics.velocity import is_singular
from robokin.model import Robot
from robokin.spatial.angles import circled

NEAR = 0.1
"""A step that moves no joint by more [rad | size] is no jump: different solutions are farther apart but near a
singularity, and there a step is halved while it gets shorter by that."""

HALVINGS = 26
"""How often a step is halved at most, to 1e-8 of itself. A joint that still moves by more than NEAR jumps."""

ASKED = 9
"""Of steps that do not arrive the last of so many asks for all solutions."""

CREEPING, CREPT = 64.0, 64
"""Steps up to this many of the shortest, and how many of them are taken at most: beside the poses that an arm can take
one after the other closes within rounding, and none of them leads on."""

BEGUN = 1e-6
"""Part of the line after which its solutions tell how it begins: they are then 1e-6 from where they begin, or 1e-3
where two meet."""

MOST = 1_000_000
"""Steps of a path at most: what is kept of each is some hundred bytes."""

LISTED = 64
"""Poses whose solutions are listed together where they take long, and steps go on as soon as they can."""

STEPS = 30
"""Newton steps to one pose; three do where the arm is regular."""

LONGEST = 0.3
"""The longest of them [rad | size]."""

DAMPING = 1e-3
"""Damping of these steps as a part of the squared error."""

CONTINUES = 1e-2
"""The solutions there are farther from the configuration that they come from [rad | size] at no regular beginning."""

ITSELF = 1e-4
"""Configurations [rad | size] that differ by less are one beginning: no more is known of it by solutions beside it."""

STILL = 1e-9
"""Moves of joints below this [rad | size] are rounding."""


class Follower:
    """Follows poses at(s): (m,) -> (m, 4, 4), looked up at the places s (k,) one after the other."""

    def __init__(self, robot: Robot, at: Callable[[Array], Array], task: Literal["pose", "position"], s: Array) -> None:
        self.robot, self.at, self.task, self.s = robot, at, task, s
        self.analysis = analysis_of(robot, task)
        self.scale = np.where(robot.revolute, 1.0, self.analysis.size)
        self.spare = bool(self.analysis.redundancy or self.analysis.idle)
        self.numeric = self.spare or self.analysis.solver is None
        self.poses = at(s)
        self.plain = PlainRows(robot, self.analysis, self.spare, self.numeric)
        self.begin(np.zeros(robot.n))
        block = LISTED if self.plain.plain else None
        self.rows = ListedRows(self.solved, self.poses, s, self.scale, robot.revolute, block)

    def solved(self, poses: Array) -> tuple[Array, Index]:
        """All configurations (m, k, n) at poses (m, 4, 4), padded with NaN, and how many they are (m,)."""
        batch = solve_many(self.robot, poses, limits=False, task=self.task)
        return batch.q, batch.count

    halvings = HALVINGS
    """How often a step is halved at most."""

    def begin(self, q: Array) -> None:
        """A branch begins at q (n,), of which it is not known where it leads."""
        self.ahead = np.zeros_like(q)
        self.rate = np.zeros_like(q)

    def run(self, q: Array, i: int) -> Array:
        """The rows (r, n) from place i on that go on plainly from q (n,) at the place before; r may be 0."""
        rows, self.ahead = self.plain.run(self.poses[i:], q, self.ahead)
        if self.numeric:
            return rows
        if not len(rows):
            # What is listed beside a singular configuration leads to where steps go on from.
            rows, self.rate = self.rows.run(q, self.rate, i, NEAR)
        if len(rows):
            last = np.concatenate([q[None], rows])[-2:]
            step = self.s[i + len(rows) - 1] - self.s[i + len(rows) - 2]
            self.ahead = last[1] - last[0]
            self.rate = self.ahead / step if step > 0.0 else np.zeros_like(q)
        return rows

    def advance(self, q: Array, before: float, i: int) -> tuple[float, Array, str]:
        """From q (n,) at `before` to place i: how far it got, with which q, and what stopped it (unreachable, jump)."""
        end = float(self.s[i])
        found = self.track(q, self.poses[i], self.ahead) if self.numeric else None
        if found is not None and self.move(q, found) <= NEAR:
            # Steps grow and shrink slowly with the time law: the last one is a good guess of the next. Not where joints
            # are to spare: what they did with the tool at rest would go on and on.
            if not self.spare:
                self.ahead = found - q
            return end, found, ""
        self.begin(q)
        reached, found, why = self.halved(q, before, end)
        if not why and not self.numeric and (exact := self.nearest(found, end)) is not None:
            # Steps end within rounding of poses; the list of solutions has the last digits.
            found = exact if self.move(found, exact) <= 0.01 * ITSELF else found
        return reached, found, why

    def halved(self, q: Array, before: float, end: float) -> tuple[float, Array, str]:
        """The same by steps as short as they must be."""
        at, step, least = before, end - before, (end - before) * 0.5**self.halvings
        why, rate, failed, crept = "", np.zeros_like(q), 0, 0
        while at < end:
            ahead = min(at + step, end)
            led = q if self.numeric else q + rate * (ahead - at)
            found = self.stepped(led, ahead)
            if not self.numeric and (found is None or not self._follows(q, led, found)):
                # All solutions tell more than steps to one, and take long beside a singularity.
                failed += 1
                found = self.nearest(led, ahead) if failed % ASKED == 0 or step <= 2.0 * least else None
            crept += step <= CREEPING * least
            if found is not None and self._follows(q, led, found) and crept <= CREPT:
                rate = (found - q) / (ahead - at)
                at, q, step = ahead, found, 2.0 * step
                continue
            why = "jump" if found is not None and not self._follows(q, led, found) else "unreachable"
            if crept > CREPT:
                return at, q, why
            step /= 2.0
            if step < least:
                return at, q, why
        return end, q, ""

    def _follows(self, q: Array, led: Array, found: Array) -> bool:
        """Whether a step from q (n,), where the last ones lead to led (n,), comes to `found` (n,) on its branch."""
        far = self.move(q, found)
        return far <= NEAR and (self.numeric or bool(leads(np.array(self.move(led, found)), np.array(far))))

    def stepped(self, q: Array, s: float) -> Array | None:
        """The configuration (n,) at s that Newton's steps lead to from q (n,), or None where they do not arrive."""
        T = self.at(np.array([s]))[0]
        if self.numeric:
            return self.track(q, T, np.zeros_like(q))
        x, T = self._opened(q, T)
        found = self.steps(x, T[None])
        return None if found is None else found[: len(q)]

    def nearest(self, q: Array, s: float) -> Array | None:
        """The configuration (n,) at s that is nearest to q, or None where there is none."""
        if self.numeric:
            return self.track(q, self.at(np.array([s]))[0], np.zeros_like(q))
        # Asked for near q, a family of solutions is met at its nearest member.
        batch = solve_many(self.robot, self.at(np.array([s])), limits=False, near=q, task=self.task)
        return self.chosen(batch.q[0, : batch.count[0]], q)

    def beginnings(self, q: Array) -> list[tuple[Array, Array]]:
        """How ways go on from a singular configuration q (n,): where each begins, and where it is at the part `BEGUN`.

        At a singular pose solutions meet, or joints can trade motion while the tool stands still: the solutions a
        little way along tell which ways there are, and from which configurations with the pose of q they go on. Where
        some go on from q itself these alone. Empty where q is regular, and where solutions are not listed.
        """
        if self.numeric or not is_singular(self.robot, q, "position" if self.task == "position" else None):
            return []
        ways: list[tuple[Array, Array]] = []
        batch = solve_many(self.robot, self.at(np.array([BEGUN])), limits=False, near=q, task=self.task)
        for other in batch.q[0, : batch.count[0]]:
            start = self.nearest(other, 0.0)
            if start is None or self.move(start, other) > CONTINUES:
                continue
            near = self.turned(start, q)
            # Joints that do not turn stand still to the last digit.
            near = np.where(np.abs(near - q) <= STILL * self.scale, q, near)
            ways.append((q if self.move(near, q) <= ITSELF else near, other + near - start))
        own = [way for way in ways if way[0] is q]
        return own or ways

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
        x, T = self._opened(q, T)
        found = self.steps(np.concatenate([q + ahead, np.zeros(opened)]), T[None])
        if found is not None and (self.robot.within_limits(found[: len(q)]) or not self.robot.within_limits(q)):
            return found[: len(q)]
        # A joint that meets its limit is held there, if the others can do without it.
        limits = np.concatenate([self.robot.limits, np.tile([-np.inf, np.inf], (opened, 1))])
        held, error = descend(chain, T[None], x[None], size, limits=limits)
        if np.max(np.abs(error)) <= CLOSES and self.robot.within_limits(q):
            return np.asarray(held[0, : len(q)])
        return None if found is None else found[: len(q)]

    def _opened(self, q: Array, T: Array) -> tuple[Array, Array]:
        """Joint values q (n,) with those of what is left open, which turns from where the tool is; its target."""
        x = np.concatenate([q, np.zeros(self.analysis.open)])
        if self.analysis.open:
            T = T.copy()
            T[:3, :3] = pose(self.analysis.chain, x)[:3, :3]
        return x, T

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
        off = np.max(np.abs(e))
        if not off <= 0.1 * CLOSES:
            return None
        if off > ROUNDING:
            # A last step, to rounding.
            last, left = brought_down(errors, step, ends, -endless, endless, steps=1, arrived=0.0)
            ends = last if np.max(np.abs(left)) < off else ends
        return np.asarray(ends[0] * scale)

    def move(self, q: Array, other: Array) -> float:
        """The greatest joint move between two configurations [rad | size]."""
        return float(np.max(np.abs(other - q) / self.scale))
