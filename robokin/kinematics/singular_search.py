"""Where an arm is singular: conditions on its joints, found by number and tested at random.

The singular configurations of an arm are surfaces in the space of its joints, and the Jacobian's determinant often
falls into factors, each a function of few joints: for a spherical wrist det J = det J_arm(q2, q3) · det J_wrist(q5)
(B. Siciliano et al., Robotics: Modelling, Planning and Control, 2009, section 3.3). The factors are found without
symbols. A joint alone is enough where the least singular value vanishes at some value of it for all values of the
others: a scan finds those. Other surfaces are met by descending from random starts; the joints that can be moved at
random there without the rank coming back do not matter, and the condition is one on the rest.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product

import numpy as np

from robokin.arrays import Array, Flags
from robokin.kinematics.jacobian import jacobian
from robokin.kinematics.velocity import MotionTask, scaled
from robokin.model import Robot

GRID = 90
"""Values of a joint in a scan: four degrees apart. Factors of library arms are harmonics of the first degree."""

SAMPLES = 4
"""Random values of the other joints in a scan: what vanishes at all of them vanishes everywhere."""

STARTS = 96
"""Starts of descents; PUMA's three surfaces are met from one in three each."""

MANY = 12
"""Joints from which on there are fewer starts, for a step costs their square: so many joints leave a rank rarely."""

FEWEST = 12
"""Starts at least."""

FOUND = 1e-9
"""A least singular value, as a part of the greatest, that is zero: descents end at 1e-12 or do not converge."""

HOLDS = 1e-7
"""The same after the other joints were moved, which may magnify what was left."""

SAME = 1e-5
"""Joint values [rad | size] that differ by less are one."""

BESIDE = 1e-2
"""Configurations that miss a known condition by less are not looked at: where two surfaces cross, a least singular
value that is the product of two small numbers passes for zero beside them."""

STEEPEST = 50.0
"""How fast a least singular value, as a part of the greatest, grows with a joint [1/rad | 1/size] at most: a column of
the Jacobian changes by some columns at most, of which an arm has tens."""

LONGEST = 0.3
"""The longest step of a descent [rad | size]."""

STAYS = 1e-11
"""The same for what a descent met, which ends at 1e-15: arms with small offsets are nearly singular on more joints."""

DRAWS = 8
"""Random values that a joint is given to see whether it matters."""

SLIDE = 2.0
"""How far a sliding joint without limits is searched, in sizes each way."""

FEW = 8
"""A condition on several joints is one on their values where descents meet so few sets of values, one of them twice."""

RIGHT = np.pi / 2.0


@dataclass(frozen=True, eq=False)
class Condition:
    """Joints (from 0) and the values (v, k) [rad | m] that make the arm singular, whatever the others are.

    Without values it is an equation between the joints. `met`: (s, n) configurations that fulfil it.
    """

    joints: tuple[int, ...]
    values: Array
    met: Array


class Search:
    """The search on one arm. Joint values x = q / scale are in radians and sizes here."""

    def __init__(self, robot: Robot, task: MotionTask, seed: int = 0) -> None:
        self.robot, self.task = robot, task
        self.rng = np.random.default_rng(seed)
        self.scale = np.where(robot.revolute, 1.0, task.size)
        low, high = (robot.limits / self.scale[:, None]).T
        self.low = np.where(robot.revolute, -np.pi, np.where(np.isfinite(low), np.minimum(low, -1.0), -SLIDE))
        self.high = np.where(robot.revolute, np.pi, np.where(np.isfinite(high), np.maximum(high, 1.0), SLIDE))

    def drawn(self, *shape: int) -> Array:
        """Random x (..., n)."""
        return self.low + (self.high - self.low) * self.rng.random((*shape, self.robot.n))

    def matrices(self, x: Array) -> Array:
        """What counts of the Jacobian (..., r, n), lengths in sizes."""
        return scaled(self.robot, jacobian(self.robot, x * self.scale), self.task.size)[..., self.task.rows, :]

    def least(self, x: Array) -> Array:
        """(...) the least of the M singular values as a part of the greatest."""
        values = np.linalg.svd(self.matrices(x), compute_uv=False)
        return np.asarray(values[..., self.task.dimension - 1] / np.maximum(values[..., 0], 1e-300))

    def conditions(self) -> list[Condition]:
        """All conditions that are found: on one joint, by joint; on several, those on few joints first."""
        singles = [found for k in range(self.robot.n) if (found := self.single(k)) is not None]
        several = self.several(singles)
        return [*singles, *sorted(several, key=lambda found: (len(found.joints), found.joints))]

    # One joint --------------------------------------------------------------------------------------------

    def single(self, k: int) -> Condition | None:
        """The values of joint k at which the arm is singular for all values of the others."""
        others = self.drawn(SAMPLES)
        turns = bool(self.robot.revolute[k])
        grid = np.linspace(self.low[k], self.high[k], GRID, endpoint=not turns)

        def worst(values: Array) -> Array:
            x = np.broadcast_to(others, (len(values), *others.shape)).copy()
            x[:, :, k] = values[:, None]
            return np.asarray(np.max(self.least(x), axis=1))

        H = worst(grid)
        before, after = np.roll(H, 1), np.roll(H, -1)
        if not turns:
            before[0] = after[-1] = np.inf
        # A joint that does not matter shows dips of rounding alone.
        dips = np.flatnonzero((before >= H) & (after >= H) & (0.9 * np.max(H) > H))
        if not len(dips):
            return None
        step = grid[1] - grid[0]
        values = _golden(worst, grid[dips] - step, grid[dips] + step)
        if not len(values):
            return None
        values = values[worst(values) <= FOUND]
        values = _distinct(self.tidy(values, turns)[:, None], np.array([turns]))
        if not len(values):
            return None
        met = self.drawn(len(values))
        met[:, k] = values[:, 0]
        return Condition((k,), values * self.scale[k], met * self.scale)

    @staticmethod
    def tidy(values: Array, turns: bool) -> Array:
        """Angles in (-π, π], and what is a multiple of 15° (or a slide of nothing) but for rounding, exactly that."""
        if not turns:
            return np.where(np.abs(values) < 1e-7, 0.0, values)
        part = np.pi / 12.0
        whole = np.round(values / part) * part
        values = np.where(np.abs(values - whole) < 1e-7, whole, values)
        values = np.pi - np.mod(np.pi - values, 2.0 * np.pi)
        return np.asarray(np.where(np.abs(values + np.pi) < 1e-9, np.pi, values) + 0.0)

    # Several joints ---------------------------------------------------------------------------------------

    def several(self, singles: list[Condition]) -> list[Condition]:
        """Conditions on several joints, met by descending from random starts."""
        starts = STARTS if self.robot.n <= MANY else max(FEWEST, STARTS * MANY**2 // self.robot.n**2)
        x = self.descended(self.drawn(starts))
        x = x[self.least(x) <= FOUND]
        for found in singles:
            x = x[~self.beside(x, found)]
        bound = self.binding(x)
        sets = sorted({tuple(np.flatnonzero(row).tolist()) for row in bound}, key=len)
        out: list[Condition] = []
        for joints in sets:
            met = x[np.all(bound == np.isin(np.arange(self.robot.n), joints), axis=1)]
            for found in out:
                met = met[~self.beside(met, found)] if len(found.values) else met
            met = met[self.holds(met, joints)]
            if len(joints) < 2 or not len(met):
                continue
            turns = self.robot.revolute[list(joints)]
            columns = np.stack([self.tidy(met[:, k], bool(self.robot.revolute[k])) for k in joints], axis=1)
            met[:, list(joints)] = columns
            values = _distinct(columns, turns)
            right = np.abs(np.mod(columns + RIGHT / 2.0, RIGHT) - RIGHT / 2.0)
            if turns.all() and len(joints) <= 3 and np.max(right) < BESIDE:
                values = self.right_angled(joints)
            elif len(values) > FEW or len(values) == len(met):
                values = values[:0]
            else:
                values = self.rounded(joints, values)
            kept = values * self.scale[list(joints)]
            out.append(Condition(joints, kept, met * self.scale))
        return out

    def right_angled(self, joints: tuple[int, ...]) -> Array:
        """The values (v, k) among right angles that make the arm singular whatever the other joints are."""
        turns = [0.0, RIGHT, -RIGHT, 2.0 * RIGHT]
        values = np.array(list(product(turns, repeat=len(joints))))
        x = np.broadcast_to(self.drawn(SAMPLES), (len(values), SAMPLES, self.robot.n)).copy()
        x[:, :, list(joints)] = values[:, None]
        return np.asarray(values[np.max(self.least(x), axis=1) <= FOUND])

    def rounded(self, joints: tuple[int, ...], values: Array) -> Array:
        """Values (v, k) with those that descents left near a multiple of 15° there, if the arm is singular there."""
        part = np.pi / 12.0
        whole = np.round(values / part) * part
        near = np.where(np.abs(values - whole) < BESIDE, np.where(whole <= -np.pi + SAME, np.pi, whole), values) + 0.0
        x = np.broadcast_to(self.drawn(SAMPLES), (len(values), SAMPLES, self.robot.n)).copy()
        x[:, :, list(joints)] = near[:, None]
        good = np.max(self.least(x), axis=1) <= HOLDS
        return np.where(good[:, None], near, values)

    def beside(self, x: Array, found: Condition) -> Flags:
        """(s,) which x (s, n) fulfil a condition on values, or nearly."""
        joints = list(found.joints)
        gap = np.abs(x[:, None, joints] - found.values / self.scale[joints])
        turned = np.abs(np.mod(gap + np.pi, 2.0 * np.pi) - np.pi)
        gap = np.where(self.robot.revolute[joints], turned, gap)
        return np.asarray(np.any(np.max(gap, axis=2) < BESIDE, axis=1))

    def binding(self, x: Array) -> Flags:
        """(s, n) which joints a singular x (s, n) depends on: moved at random, they bring the rank back."""
        s, n = x.shape
        moved = np.broadcast_to(x[:, None, None], (s, n, DRAWS, n)).copy()
        k = np.arange(n)
        moved[:, k, :, k] = np.moveaxis(self.drawn(s, DRAWS), 2, 0)
        return np.asarray(np.max(self.least(moved), axis=2) > STAYS)

    def holds(self, x: Array, joints: tuple[int, ...]) -> Flags:
        """(s,) whether x (s, n) stay singular when all joints but these are moved at random together."""
        moved = np.repeat(x[:, None], DRAWS, axis=1)
        free = np.setdiff1d(np.arange(self.robot.n), joints)
        moved[:, :, free] = self.drawn(len(x), DRAWS)[:, :, free]
        return np.asarray(np.max(self.least(moved), axis=1, initial=0.0) <= STAYS)

    def descended(self, x: Array, steps: int = 60) -> Array:
        """x (s, n) moved by Newton's steps to where the least of the singular values is zero."""
        h, n, last = 1e-6, self.robot.n, self.task.dimension - 1
        x, active = x.copy(), np.arange(len(x))
        for _ in range(steps):
            at = x[active]
            u, values, vt = np.linalg.svd(self.matrices(at))
            u, v, value = u[:, :, last], vt[:, last], values[:, last]
            shifts = h * np.eye(n)
            change = (self.matrices(at[:, None] + shifts) - self.matrices(at[:, None] - shifts)) / (2.0 * h)
            slope = np.einsum("si,skij,sj->sk", u, change, v)
            step = -value[:, None] * slope / (np.sum(slope * slope, axis=1) + 1e-9)[:, None]
            longest = np.max(np.abs(step), axis=1)
            x[active] += step * np.minimum(1.0, LONGEST / np.maximum(longest, 1e-300))[:, None]
            active = active[longest > 1e-14]
            if not len(active):
                break
        wrapped = np.mod(x + np.pi, 2.0 * np.pi) - np.pi
        return np.where(self.robot.revolute, wrapped, x)


def _golden(f: Callable[[Array], Array], low: Array, high: Array) -> Array:
    """Where a function is least between low and high, (k,) each, by the golden section.

    Only where it can be zero: a place is left out as soon as the function is too great for its interval.
    """
    ratio = (np.sqrt(5.0) - 1.0) / 2.0
    a, b = low, high
    for _ in range(80):
        if not len(a):
            break
        c, d = b - ratio * (b - a), a + ratio * (b - a)
        at_c, at_d = f(c), f(d)
        left = at_c < at_d
        hope = np.minimum(at_c, at_d) <= np.maximum(STEEPEST * (b - a), HOLDS)
        a, b = np.where(left, a, c)[hope], np.where(left, d, b)[hope]
    return np.asarray((a + b) / 2.0)


def _distinct(rows: Array, turns: Flags) -> Array:
    """Rows (v, k) without those that equal an earlier one, in order; angles modulo a turn."""
    kept: list[Array] = []
    for row in rows[np.lexsort(np.round(rows, 6).T[::-1])]:
        gaps = [
            np.where(turns, np.abs(np.mod(row - other + np.pi, 2.0 * np.pi) - np.pi), row - other) for other in kept
        ]
        if all(np.max(np.abs(gap)) > SAME for gap in gaps):
            kept.append(row)
    return np.array(kept).reshape(-1, rows.shape[1])
