"""One configuration that brings all tips of a group to their targets, found by descents from many starts.

Statement. For tips whose joints are driven by shared variables u find u within the limits with every tip at its
target; where none is found, the u that comes nearest.
Derivation. The errors of all tips are one error e(u) with one Jacobian (`driven_tips`); damped steps within the limits
(`damped_newton`) bring it down. They end in the minimum above which they start. So configurations are drawn within the
limits, those that come nearest of each part of the space are the starts, and where none of them arrives more and others
follow. Of the ends that arrive that counts which moves the joints least from the first start; where none does that with
the least Σ (place / size)² + angle², brought down by steps that are taken only where they lower it.
Degenerate case. Where several variables move a tip alike, or it stands on the edge of its reach, the Jacobian has lost
rank; the steps come from its singular values. A search proves nothing: what it does not find may exist.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.numeric.closing import CAUTION, DONE, step_within
from robokin.inverse.numeric.driven_tips import DrivenTips, errors_and_slopes, tip_errors
from robokin.inverse.numeric.initial_guesses import between
from robokin.kernel.damped_newton import Judged, Known, Trial, brought_down, held_at, led_down, singular_step

DRAWN = 2048
"""Configurations drawn for each round of starts."""

STARTS = 32
"""Starts of the first round."""

ROUNDS = (1, 2, 4, 16)
"""How many times as many starts each round has: the next one is for targets that the ones before did not serve. The
first one serves all of 10,000 targets of hands, grippers, torsos with two arms and random trees."""

HOPE = 0.1
"""Root of Σ (place / size)² + angle² up to which a target is worth the last round."""

STEPS = 60
"""Steps of a descent at most."""

LONGEST = 0.6
"""The most that a joint turns in a step [rad]."""

MOST_TURNS = 4.0
"""How many turns an angle without limits is drawn from at most: joints that follow it at a part of its speed come back
after several."""

TOGETHER = 32
"""Targets searched for at once: enough that the interpreter's share is spread thin; more gain little."""

NEAREST = 8
"""Ends that are followed to what is nearest."""

NEAREST_STEPS = 80
"""Steps there, each of them taken only where it brings the tips nearer."""

ROW_OVER = 1e-9
"""By how much [rad | size] a value may be beyond a limit of its own and count as on it."""


class DrivenEnds(NamedTuple):
    """u: (m, n) [rad | m]; place [m], angle [rad]: (m, k) how far each tip is off; reached: (m,) whether none is."""

    u: Array
    place: Array
    angle: Array
    reached: Flags


def driven_search(tips: DrivenTips, T: Array, home: Array, seed: int = 0, starts: Array | None = None) -> DrivenEnds:
    """For targets T (m, k, 4, 4) [m] one configuration each, within the limits.

    home: (n,) [rad | m] is the first start, and that from which of several answers the one with the least joint move
    is taken; starts: (s, n) are more. What is found for a target does not depend on the others.
    """
    first = home[None] if starts is None else np.concatenate([home[None], starts])
    first = np.clip(first, tips.limits[:, 0], tips.limits[:, 1])
    parts = [_searched(tips, T[i : i + TOGETHER], first, seed) for i in range(0, len(T), TOGETHER)]
    if not parts:
        k = len(tips.chains)
        return DrivenEnds(np.empty((0, tips.n)), np.empty((0, k)), np.empty((0, k)), np.empty(0, dtype=bool))
    return DrivenEnds(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


def driven_ends(tips: DrivenTips, T: Array, u: Array, steps: int = STEPS) -> DrivenEnds:
    """Where descents from u (s, n) [rad | m] to targets T (s, k, 4, 4) [m] end, within the limits, each on its own."""
    low, high = (tips.limits / tips.scale[:, None]).T

    def errors(rows: Index, x: Array) -> tuple[Array, Array]:
        return errors_and_slopes(tips, T[rows], x * tips.scale)

    def step(rows: Index, x: Array, e: Array, J: Array) -> Array:
        damping = np.minimum(CAUTION * np.sum(e * e, axis=1), 1.0)
        return _limited_turns(tips, step_within(x, e, J, low, high, damping))

    x, _ = brought_down(errors, step, u / tips.scale, low, high, steps=steps, arrived=DONE**2)
    return ended(tips, T, _on_limits(x * tips.scale, tips.limits))


def _limited_turns(tips: DrivenTips, dx: Array) -> Array:
    """Steps (s, n) shortened so that no joint turns by more than LONGEST; what only slides goes as far as it likes.

    A slide's way is straight, and a target may be many sizes away along it.
    """
    rates = _turning_rates(tips) * tips.scale
    most = np.max(np.abs(dx) * rates, axis=1, keepdims=True)
    return np.where(rates > 0.0, dx * (LONGEST / np.maximum(most, LONGEST)), dx)


def _turning_rates(tips: DrivenTips) -> Array:
    """(n,) by how much the joint that turns most turns with each variable [rad]."""
    turning = np.concatenate([S[chain.revolute] for S, chain in zip(tips.maps, tips.chains, strict=True)])
    return np.asarray(np.max(np.abs(turning), axis=0, initial=0.0))


def _on_limits(u: Array, limits: Array) -> Array:
    """Values (s, n) [rad | m] within the limits (n, 2) to the last digit, which scaling may have changed."""
    return np.clip(u, limits[:, 0], limits[:, 1])


def ended(tips: DrivenTips, T: Array, u: Array) -> DrivenEnds:
    """What configurations u (s, n) [rad | m] are for targets T (s, k, 4, 4)."""
    place, angle = tip_errors(tips, T, u)
    reached = tips.reached(u, place, angle)
    if len(tips.rows):
        reached &= np.max(np.abs(tips.over(u)), axis=1) <= ROW_OVER * max(tips.size, 1.0)
    return DrivenEnds(u, place, angle, reached)


def drawn_starts(tips: DrivenTips, seed: int, count: int) -> Array:
    """Configurations (count, n) [rad | m] within the limits; where there are none within some turns, or a size."""
    ends = np.where(np.isinf(tips.limits), _reach(tips)[:, None] * [-1.0, 1.0], tips.limits)
    ends = np.clip(ends, tips.limits[:, :1], tips.limits[:, 1:])
    return between(tips.turns, ends, tips.size, np.random.default_rng(seed).random((count, tips.n)))


def _reach(tips: DrivenTips) -> Array:
    """(n,) how far to both sides variables without limits are drawn from [rad | m]."""
    rates = np.concatenate([S[chain.revolute] for S, chain in zip(tips.maps, tips.chains, strict=True)])
    rates = np.abs(np.where(rates == 0.0, np.inf, rates))
    slowest = np.min(rates, axis=0, initial=1.0)
    return np.where(tips.turns, np.pi * np.minimum(1.0 / slowest, MOST_TURNS), tips.size)


def _searched(tips: DrivenTips, T: Array, first: Array, seed: int) -> DrivenEnds:
    """The answers for some targets."""
    m, n = len(T), tips.n
    best = ended(tips, T, np.tile(first[0], (m, 1)))
    nearest = [np.empty((0, n)) for _ in range(m)]
    for number, factor in enumerate(ROUNDS):
        missing = np.flatnonzero(~best.reached)
        if factor == ROUNDS[-1]:
            missing = missing[_off(tips, best)[missing] <= HOPE**2]
        if not len(missing):
            break
        u = chosen_starts(tips, T[missing], len(ROUNDS) * seed + number, STARTS * factor)
        if number == 0:
            u = np.concatenate([np.tile(first, (len(missing), 1, 1)), u], axis=1)
        ends = driven_ends(tips, np.repeat(T[missing], u.shape[1], axis=0), u.reshape(-1, n))
        place = _best_of_each(tips, ends, len(missing), first[0])
        _put(best, missing, ends, place[:, 0])
        for target, some in zip(missing.tolist(), place, strict=True):
            nearest[target] = np.concatenate([nearest[target], ends.u[some]])
    for target in np.flatnonzero(~best.reached).tolist():
        u = nearest[target]
        ends = brought_nearest(tips, np.repeat(T[target : target + 1], len(u), axis=0), u)
        _put(best, np.array([target]), ends, _best_of_each(tips, ends, 1, first[0])[:, 0])
    return best


def _put(best: DrivenEnds, targets: Index, ends: DrivenEnds, which: Index) -> None:
    """Put some ends in the places of targets."""
    for whole, part in zip(best, ends, strict=True):
        whole[targets] = part[which]


def chosen_starts(tips: DrivenTips, T: Array, seed: int, count: int) -> Array:
    """(m, count, n) for each target T (m, k, 4, 4) [m] the nearest of each of `count` groups of those drawn."""
    u = drawn_starts(tips, seed, max(DRAWN, 8 * count))
    off = distances(tips, T, tips.poses(u))
    each = len(u) // count
    best = np.argmin(off[:, : count * each].reshape(len(T), count, each), axis=2) + each * np.arange(count)
    return np.asarray(u[best])


def distances(tips: DrivenTips, T: Array, poses: Array) -> Array:
    """(m, s) Σ (place / size)² + 2 (1 - cos angle) of poses (s, k, 4, 4) from targets T (m, k, 4, 4) [m]."""
    off = np.zeros((len(T), len(poses)))
    for i, task in enumerate(tips.tasks):
        columns = {"pose": (0, 1, 2), "approach": (2,), "position": ()}[task]
        for column in (*columns, 3):
            weight = 1.0 / tips.sizes[i] ** 2 if column == 3 else 1.0 / (1 + (len(columns) > 1))
            for row in range(3):
                off += weight * np.square(poses[:, i, row, column] - T[:, None, i, row, column])
    return off


def _off(tips: DrivenTips, ends: DrivenEnds) -> Array:
    """(s,) Σ (place / size)² + angle² of ends, with what values are beyond limits of their own."""
    over = np.sum((tips.over(ends.u) / tips.size) ** 2, axis=1) if len(tips.rows) else 0.0
    return np.asarray(np.sum((ends.place / tips.sizes) ** 2 + ends.angle**2, axis=1) + over)


def _best_of_each(tips: DrivenTips, ends: DrivenEnds, m: int, home: Array) -> Index:
    """(m, NEAREST) of the ends of m targets, as many of each, the best: what moves least from home, or is nearest."""
    move = np.max(np.abs(ends.u - home) / tips.scale, axis=1)
    merit = np.where(ends.reached, move, _off(tips, ends)).reshape(m, -1)
    order = np.lexsort((merit, ~ends.reached.reshape(m, -1)), axis=1)
    return np.asarray(order[:, :NEAREST] + len(ends.u) // m * np.arange(m)[:, None])


def brought_nearest(tips: DrivenTips, T: Array, u: Array) -> DrivenEnds:
    """Where u (s, n) [rad | m] comes to, each step nearer to its targets T (s, k, 4, 4) [m], within the limits.

    The damping grows where a step leads away and shrinks where it does not (D. Marquardt, SIAM J. 11, 1963).
    """
    low, high = (tips.limits / tips.scale[:, None]).T

    def look(rows: Index, x: Array) -> Known:
        e, J = errors_and_slopes(tips, T[rows], x * tips.scale)
        return np.sum(e * e, axis=1), e, J

    def step(rows: Index, x: Array, here: Known, trust: Known) -> Trial:
        off, e, J = here
        held = held_at(x, low, high, np.einsum("sij,si->sj", J, e))
        dx = singular_step(np.where(held[:, None], 0.0, J), e, trust[0] * np.minimum(off, 1.0))
        return Trial(np.clip(x + _limited_turns(tips, np.where(held, 0.0, dx)), low, high), trust)

    def judge(x: Array, here: Known, there: Known, trial: Trial) -> Judged:
        better, damping = there[0] < here[0], trial.trust[0]
        return Judged(better, (np.where(better, np.maximum(0.2 * damping, 1e-9), np.minimum(5.0 * damping, 1e6)),))

    start, trust = np.clip(u / tips.scale, low, high), (np.full(len(u), 1e-2),)
    (x,) = led_down(look, step, judge, start, trust, steps=NEAREST_STEPS, told=0)
    return ended(tips, T, _on_limits(x * tips.scale, tips.limits))
