"""Where a path is to be looked at more closely so that limits of velocity and acceleration hold also between places.

Statement. Joints were looked at at some places of the time. Say between which of them a joint may be faster, or may
speed up more, than at any of them.
Derivation. Between two places joints move by their mean velocity times the time between. If it is the mean of the
velocities at both, nothing happens between; if it is off by d, a parabola through both with that mean bulges by 3/2 d.
Where twice that leads beyond the greatest of all, or where d is no small part of it, places are added: a joint that
turns fast between two places is seen by how far it got. Accelerations are looked at in the same way, by velocities.
Degenerate case. A profile's acceleration jumps: two places on both sides of that are too near for a look between.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.time_profiles import RAMP, MotionLimits, Profile

PARTS = 4
"""Into how many parts the time between two places is cut."""

BEYOND = 5e-4
"""How far beyond the greatest, relatively, what lies between two places may be: less is not looked for."""

UNTOLD = 0.02
"""The part of the greatest of a limit by which a mean may be off that of both sides; else something is between."""

NARROWEST = 1e-6
"""The part of the time between two places that is not looked into."""

LOOKS = 12
"""How often places are added at most: from a hundredth to the narrowest seven times do."""


RATES = ("q", "speed", "push")


@dataclass(frozen=True, eq=False)
class UnitRates:
    """Rows at parts of the time tau (m,) of a path in a duration of one: joint values q (m, n) [rad | m], their first
    and second derivatives speed and push (m, n); spare: of some joint these are read off the rows."""

    tau: Array
    q: Array
    speed: Array
    push: Array
    spare: bool = False

    def demand(self, limits: MotionLimits) -> float:
        """The least duration [s] in which these rows keep to limits."""
        return demand(self.speed, self.push, limits)


def demand(speed: Array, push: Array, limits: MotionLimits) -> float:
    """By what factor a duration must be longer for velocities and accelerations (m, n) to keep to limits."""
    faster = float(np.max(np.abs(speed) / limits.velocity, initial=0.0))
    harder = float(np.max(np.abs(push) / limits.acceleration, initial=0.0))
    return max(faster, math.sqrt(harder))


def looked_at_closely(
    rows: UnitRates, limits: MotionLimits, profile: Profile, look: Callable[[Array, Array], UnitRates]
) -> UnitRates:
    """The rows, and those between them that are needed to know how fast joints are within `BEYOND`.

    look: the rows at parts of the time (k,) of which the first has given joint values (n,), as far as they can be
    followed and are regular. What joints to spare do is read off rows, which are too rough nearer together: these are
    left as they are.
    """
    if rows.spare:
        return rows
    jumps = [RAMP, 1.0 - RAMP] if profile == "trapezoidal" else []
    for jump in jumps:
        if not rows.tau[0] < jump < rows.tau[-1]:
            continue
        before = int(np.searchsorted(rows.tau, jump - NARROWEST)) - 1
        beside = jump + 0.4 * NARROWEST * np.array([-1.0, 1.0])
        rows = _merged([rows, look(np.append(rows.tau[before], beside), rows.q[before])])
    for _ in range(LOOKS):
        between = _between(rows, limits)
        if not len(between):
            break
        found = [rows]
        for run in np.split(between, np.flatnonzero(np.diff(between) > 1) + 1):
            first, last = int(run[0]), int(run[-1]) + 1
            cuts = np.interp(np.arange(PARTS * first, PARTS * last) / PARTS, np.arange(len(rows.tau)), rows.tau)
            found.append(look(cuts, rows.q[first]))
        if not any(len(np.setdiff1d(one.tau, rows.tau)) for one in found):
            break
        rows = _merged(found)
    return rows


def _merged(found: list[UnitRates]) -> UnitRates:
    """All rows in the order of time; a look repeats rows that there are."""
    tau, order = np.unique(np.concatenate([one.tau for one in found]), return_index=True)
    q, speed, push = (np.concatenate([getattr(one, name) for one in found])[order] for name in RATES)
    return UnitRates(tau, q, speed, push)


def _between(rows: UnitRates, limits: MotionLimits) -> Index:
    """The rows (k,) between which and the next ones limits may be passed."""
    if len(rows.tau) < 2:
        return np.empty(0, dtype=np.intp)
    h, greatest = np.diff(rows.tau)[:, None], rows.demand(limits)
    fast = _bulges(h, rows.q, rows.speed, limits.velocity, greatest)
    hard = _bulges(h, rows.speed, rows.push, limits.acceleration, greatest**2)
    return np.flatnonzero((fast | hard) & (h[:, 0] > NARROWEST))


def _bulges(h: Array, values: Array, rates: Array, limit: Array, greatest: float) -> Flags:
    """Whether rates (m, n) may pass the greatest part of a limit (n,) between places h (m - 1, 1) apart: (m - 1,)."""
    before, after = rates[:-1], rates[1:]
    off = np.abs(np.diff(values, axis=0) / h - 0.5 * (before + after)) / limit
    most = np.maximum(np.abs(before), np.abs(after)) / limit
    return np.asarray(((most + 3.0 * off > greatest * (1.0 + BEYOND)) | (off > UNTOLD * greatest)).any(axis=1))
