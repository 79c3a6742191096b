"""How fast joints move where the tool follows a curve, by the part of the way.

Statement. Give q' and q'' at rows of a path of the tool.
Derivation. q' solves J q' = x', the twist of the curve, with the least motion; q'' is its derivative along the curve,
by a difference between both sides.
Degenerate case. At a singular configuration the twist does not say what joints trade with each other: that is read off
rows beside it. Where the twist is one that the tool cannot do q' has no bound.
"""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array, Flags
from robokin.inverse.joint_paths import Path, PathTask
from robokin.inverse.tool_curves import ToolCurve
from robokin.kinematics.jacobian import jacobian
from robokin.kinematics.velocity import nearly_singular
from robokin.model import Robot

CLOSES = 1e-4
"""How far J q' may be off the twist, relatively: beyond that the configuration is singular."""

FLAT = 1e-9
"""A determinant below this part of the product of the rows' lengths is looked at for its rank."""

SQUARE = 1e-6
"""A determinant of J Jᵀ above this part of the product of its diagonal has an inverse with digits enough."""

FLATTEST = 1e-7
"""Singular values below this part of the greatest are those of a singular configuration."""

BESIDE = 1e-5
"""A least singular value below which rates are read off rows beside it."""

APART = 1e-4
"""How far these are, by the part of the way, so that the rounding of joint values is no rate."""

DIFFERENCE = 1e-5
"""The step along a line, as a part of it, between whose sides q'' is the difference of q'."""


def curve_rates(path: Path, curve: ToolCurve, task: PathTask) -> tuple[Array, Array]:
    """q' and q'' (m, n) by the part of the way, at each row; inf where the configuration is singular."""
    robot, s, q = path.robot, path.s, path.q
    first = _joint_rates(robot, q, curve.twist(s), task)
    singular = np.flatnonzero(nearly_singular(robot, q, BESIDE, "position" if task == "position" else None))
    step = DIFFERENCE / np.maximum(1.0, np.max(np.abs(first), axis=1, keepdims=True))
    step[~np.isfinite(step)] = DIFFERENCE
    with np.errstate(invalid="ignore"):
        moves = np.where(np.isfinite(first), step * first, 0.0)
        ahead = _joint_rates(robot, q + moves, curve.twist(s + step[:, 0]), task)
        behind = _joint_rates(robot, q - moves, curve.twist(s - step[:, 0]), task)
        second = (ahead - behind) / (2.0 * step)
    # Where the arm is singular what joints trade with each other is not told by the twist, but by rows beside.
    told = singular[np.isfinite(first[singular]).all(axis=1)]
    for i in told:
        first[i] = _by_rows(q, s, i)
    for i in told:
        second[i] = _by_rows(first, s, i)
    return first, second


def _by_rows(values: Array, s: Array, i: int) -> Array:
    """The derivative (n,) by s of rows (m, n) at row i, by the nearest rows that are far enough for rounding."""
    before, after = np.searchsorted(s, s[i] - APART, side="right") - 1, np.searchsorted(s, s[i] + APART)
    low, high = max(int(before), 0), min(int(after), len(s) - 1)
    usable = [k for k in (low, high) if k != i and np.isfinite(values[k]).all()]
    if not usable:
        return np.zeros(values.shape[1])
    rates = [(values[k] - values[i]) / (s[k] - s[i]) for k in usable]
    if len(usable) == 1 or not (s[i] - s[low] > 0.5 * APART and s[high] - s[i] > 0.5 * APART):
        return np.asarray(max(zip(usable, rates, strict=True), key=lambda one: abs(s[one[0]] - s[i]))[1])
    # Weighed so that a parabola through the three has this slope.
    h, k = s[i] - s[low], s[high] - s[i]
    return np.asarray((k * rates[0] + h * rates[1]) / (h + k))


def spare_part(path: Path, task: PathTask, rates: Array) -> Array | None:
    """What of rates (m, n) leaves the tool where it is, at each row; None where there are no joints to spare.

    What joints trade at a singular configuration of an arm without is no part of it.
    """
    J = jacobian(path.robot, path.q)[:, : 3 if task == "position" else 6]
    middle = J[len(J) // 2]
    rank = max(
        int(np.linalg.matrix_rank(part, tol=1e-6 * float(np.max(np.abs(part))))) for part in (J[0], middle, J[-1])
    )
    if rank >= path.robot.n:
        return None
    return np.asarray(rates - _least_rates(J, np.einsum("mij,mj->mi", J, rates)))


def _least_rates(J: Array, twist: Array) -> Array:
    """The rates (m, n) of least motion whose J (m, k, n) rate comes nearest to twist (m, k)."""
    rates = np.zeros((len(J), J.shape[2]))
    plain: Flags = np.zeros(len(J), dtype=bool)
    if J.shape[1] < J.shape[2]:
        # Most are regular, and a tenth of the time is enough for these.
        G = J @ np.swapaxes(J, 1, 2)
        plain = np.linalg.det(G) > SQUARE * np.prod(np.einsum("mii->mi", G), axis=1)
        inverse, across, part = np.linalg.inv(G[plain]), np.swapaxes(J[plain], 1, 2), twist[plain, :, None]
        found = across @ (inverse @ part)
        # What squares lost comes back by a second step.
        rates[plain] = (found + across @ (inverse @ (part - J[plain] @ found)))[:, :, 0]
    rates[~plain] = np.einsum("mij,mj->mi", np.linalg.pinv(J[~plain], rcond=1e-10), twist[~plain])
    return rates


def _joint_rates(robot: Robot, q: Array, twist: Array, task: PathTask) -> Array:
    """The rates (m, n) of least motion with J rate = twist (m, 6) at q (m, n); inf where there are none."""
    J = jacobian(robot, q)
    if task == "position":
        J, twist = J[:, :3], twist[:, :3]
    if J.shape[1] == J.shape[2]:
        # Most are regular, and a third of the time is enough for these.
        J = J.copy()
        with np.errstate(all="ignore"):
            flat = np.abs(np.linalg.det(J)) <= FLAT * np.prod(np.linalg.norm(J, axis=2), axis=1)
            rates = np.zeros(q.shape)
            rates[~flat] = np.linalg.solve(J[~flat], twist[~flat, :, None])[:, :, 0]
        rates[flat] = np.einsum("mij,mj->mi", np.linalg.pinv(J[flat], rcond=FLATTEST), twist[flat])
    else:
        rates = _least_rates(J, twist)
    off = np.max(np.abs(np.einsum("mij,mj->mi", J, rates) - twist), axis=1)
    rates[off > CLOSES * np.maximum(1e-12, np.max(np.abs(twist), axis=1))] = np.inf
    return rates
