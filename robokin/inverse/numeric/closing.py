"""Solutions within the joint limits, found by search: the last resort before it is said that there is none.

Statement. For targets without a listed solution find configurations within the limits that reach them.
Derivation. Where solvers list what there is but for the limits, what they miss lies where the arm is singular, or,
of an arm that is redundant, on a short piece of the self-motion, often a single point at which several joints are at
their limits. From the initial guesses of the nearest configuration, which lie on the faces and corners of the box of
limits as often as inside it, ½|p - t|² + w (1 - cos θ) goes down with its curvature (`second_order`), all lengths and
angles alike in weight. What comes near is then made exact by steps within the limits that come from the singular
values of the Jacobian: its normal equations would lose those below the root of their rounding, 1e-8, which decide
next to a singular configuration. A joint at a limit takes no part where the slope or the step itself would push it
outwards (D. P. Bertsekas, "Projected Newton methods for optimization problems with simple constraints", SIAM
J. Control Optim. 20(2), 1982).
Degenerate case. At a double solution the error is quadratic in the distance and each step halves that.
"""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array, Index
from robokin.inverse.analysis import Analysis
from robokin.inverse.numeric.closest import MoreStarts, initial_guesses, nearest_configurations
from robokin.inverse.numeric.position_first import Ways
from robokin.inverse.numeric.second_order import go_down
from robokin.inverse.verify import CLOSES, Found, merged, nothing
from robokin.kernel.chain import Chain
from robokin.kernel.damped_newton import brought_down, held_at, limited, singular_step
from robokin.kernel.residual import distance_and_angle, error_and_jacobian

TOGETHER = 32
"""Targets searched for at once: enough that the interpreter's share is spread thin; more gain little."""

BALANCE = 0.1
"""w: the weight of 1 - cos θ against ½|p - t|² [size²]: a tool is some thirds of an arm's size from its joints."""

FEW, MANY = 8, 40
"""Ends that are followed for every target, and for those that the first do not serve."""

HOPELESS = 0.03
"""½|p - t|² + w (1 - cos θ) above which an end is not followed: a target is then some 0.2 sizes or radians off."""

CLOSE = 1e-2
"""Distance [size] and angle [rad] from which ends are made exact."""

PROMISING = 0.02
"""Distance [size] and angle [rad] of a nearest configuration from which there may be a solution close by."""

AGAIN = 5
"""Searches from other initial guesses for a target whose nearest configuration is promising."""

EXACT_STEPS = 40
"""Steps that make ends exact: at a double solution each gains a factor of four."""

CAUTION = 1e-2
"""Damping as a part of the squared error (T. Sugihara, IEEE T-RO 27(5), 2011: 1e-3 to 1e-1)."""

LONGEST = 0.3
"""Longest step of a joint [rad | size]: ends that are made exact are near their solutions."""

DONE = 1e-14
"""Error [size and rad] at which an end is exact: some ten times the rounding of a pose."""


def closing_nearest(
    analysis: Analysis,
    T: Array,
    limits: Array,
    home: Array,
    seed: int,
    more_starts: MoreStarts | None = None,
    thorough: bool = True,
) -> Found:
    """Solutions within limits (n, 2) found for targets T: (m, 4, 4) [m], by target, with duplicates.

    q: (s, n) [rad | m], each closes to `CLOSES`. Idle joints stay at `home` (n,), which is also an initial guess.
    more_starts: as for `nearest_configurations`. thorough: where nothing is found the nearest configuration is
    searched for as well and made exact; if it comes near without, other initial guesses follow. That takes some
    three times as long where there is nothing, more where something is nearly there.
    What is found for a target does not depend on the others.
    """
    parts = []
    for first in range(0, len(T), TOGETHER):
        some = np.arange(first, min(first + TOGETHER, len(T)))
        more = _of(more_starts, some)
        found = _search(analysis, T[some], limits, home, seed, more)
        none = np.flatnonzero(np.bincount(found.index, minlength=len(some)) == 0)
        if thorough and len(none):
            again = _thorough(analysis, T[some[none]], limits, home, seed, _of(more, none))
            found = merged(found, again.numbered(none))
        parts.append(found.numbered(some))
    both = merged(nothing(len(home)), *parts)
    return both.pick(np.argsort(both.index, kind="stable"))


def _thorough(analysis: Analysis, T: Array, limits: Array, home: Array, seed: int, more: MoreStarts | None) -> Found:
    """From the nearest configurations and, where these are near, from other initial guesses."""
    q, position, angle = nearest_configurations(analysis, T, limits, home, seed, more)
    bounds, at_home, _ = initial_guesses(analysis, T[:0], limits, home, seed, None)
    whole = np.tile(at_home, (len(q), 1))
    whole[:, : q.shape[1]] = q
    parts = [exact_within(analysis, T, np.arange(len(T)), whole, bounds, CLOSE)]
    missing = (position <= PROMISING * analysis.size) & (angle <= PROMISING)
    for another in range(1, 1 + AGAIN):
        missing &= np.bincount(parts[-1].index, minlength=len(T)) == 0
        rows = np.flatnonzero(missing)
        if not len(rows):
            break
        found = _search(analysis, T[rows], limits, home, seed + another, _of(more, rows))
        parts.append(found.numbered(rows))
    return merged(nothing(len(home)), *parts)


def _search(analysis: Analysis, T: Array, limits: Array, home: Array, seed: int, more: MoreStarts | None) -> Found:
    """What descents from the initial guesses come to."""
    chain, size = analysis.chain, analysis.size
    bounds, _, x = initial_guesses(analysis, T, limits, home, seed, more)
    scale = np.where(chain.revolute, 1.0, size)
    ways = Ways(chain, size, *(bound[:, None] for bound in (bounds / scale[:, None]).T))
    m, k, n = x.shape
    index = np.repeat(np.arange(m), k)
    ends, f = _down(ways, T[index], np.ascontiguousarray((x / scale).reshape(m * k, n).T), steps=10)
    order = np.argsort(f.reshape(m, k), axis=1, kind="stable") + k * np.arange(m)[:, None]
    parts, missing = [], np.ones(m, dtype=bool)
    for ranks, steps in ((slice(0, FEW), 20), (slice(FEW, MANY), 60)):
        rows = order[missing][:, ranks].ravel()
        rows = rows[f[rows] < HOPELESS]
        if not len(rows):
            break
        went, _ = _down(ways, T[index[rows]], ends[:, rows], steps)
        found = exact_within(analysis, T, index[rows], went.T * scale, bounds, CLOSE)
        parts.append(found)
        missing &= np.bincount(found.index, minlength=m) == 0
    return merged(nothing(len(home)), *parts)


def _down(ways: Ways, T: Array, x: Array, steps: int) -> tuple[Array, Array]:
    """Where x: (n, s) comes to on the way to targets (s, 4, 4), and ½|p - t|² + w (1 - cos θ) there, (s,)."""
    columns = np.ascontiguousarray(T[:, :3].transpose(2, 1, 0))
    w = np.full(x.shape[1], BALANCE)
    limits = ways.low, ways.high
    ends, place, turn = go_down(ways.chain, columns, x, ways.size, limits, w, steps=steps, still=1e-7)
    return ends, place + BALANCE * turn


def exact_within(analysis: Analysis, T: Array, index: Index, q: Array, limits: Array, near: float) -> Found:
    """Of configurations q: (s, n) [rad | m] near solutions for targets index (s,) those solutions, verified.

    limits: (n, 2) of all the chain's joints, also those that the task leaves open; near: distance [size] and angle
    [rad] within which a configuration is followed. The found ones hold the arm's own joints only.
    """
    chain, size, own = analysis.chain, analysis.size, analysis.chain.n - analysis.open
    error, _ = error_and_jacobian(chain, T[index], q, size)
    close = np.max(np.abs(error), axis=1) <= near
    index = index[close]
    q, error = newton_within(chain, T[index], q[close], size, limits, EXACT_STEPS)
    position, angle = distance_and_angle(error)
    return Found(index, q[:, :own], position * size, angle).pick((position <= CLOSES) & (angle <= CLOSES))


def newton_within(chain: Chain, T: Array, q: Array, size: float, limits: Array, steps: int) -> tuple[Array, Array]:
    """Joint values (s, n) [rad | m] within limits (n, 2) after some steps from q to targets T: (s, 4, 4), and errors.

    The errors (s, 6) are in sizes and radians.
    """
    scale = np.where(chain.revolute, 1.0, size)
    low, high = (limits / scale[:, None]).T

    def errors(rows: Index, x: Array) -> tuple[Array, Array]:
        return error_and_jacobian(chain, T[rows], x * scale, size)

    def step(rows: Index, x: Array, e: Array, J: Array) -> Array:
        return limited(step_within(x, e, J, low, high, CAUTION * np.sum(e * e, axis=1)), LONGEST)

    x, error = brought_down(errors, step, q / scale, low, high, steps=steps, arrived=DONE**2)
    return x * scale, error


def step_within(x: Array, e: Array, J: Array, low: Array, high: Array, damping: Array) -> Array:
    """The damped step (s, n) of the joints that it does not push outwards from their limits, by singular values.

    x: (s, n) within low and high (n,), e: (s, m) the errors there, J: (s, m, n); damping: (s,).
    """
    held = held_at(x, low, high, np.einsum("sij,si->sj", J, e))
    dx = np.zeros(x.shape)
    for _ in range(3):
        dx = singular_step(np.where(held[:, None], 0.0, J), e, damping)
        outwards = ~held & held_at(x, low, high, dx)
        if not outwards.any():
            break
        held |= outwards
    return np.where(held, 0.0, dx)


def _of(more: MoreStarts | None, some: Index) -> MoreStarts | None:
    """More starts for some of the targets, numbered anew."""
    if more is None:
        return None
    number = np.full(max(int(some.max()), int(more[0].max(initial=0))) + 1, -1)
    number[some] = np.arange(len(some))
    which = number[more[0]] >= 0
    return number[more[0][which]], more[1][which]
