"""The way down to the nearest position and, at that, to the nearest orientation, within joint limits.

Statement. From configurations x go down to local minima of the law of `closest`: the distance |p - t| counts first,
then the angle θ of the turn that is left; the joints stay within limits.
Derivation. Where the position can be had this is: minimise 1 - cos θ subject to p = t and the limits. Rounds of
`second_order` minimise ½|p - t + s|² + w (1 - cos θ), each from where the one before ended, with a shift s of the
target that takes over what the round before left: s' = (s + p - t) w'/w, the method of multipliers, with
λ = (s + p - t)/w (M. J. D. Powell, "A method for nonlinear constraints in minimization problems", in R. Fletcher
(ed.), "Optimization", 1969; J. Nocedal, S. J. Wright, "Numerical Optimization", 2nd ed., 2006, section 17.3). The
distance left shrinks by w a round, so that three rounds are exact. Where the position cannot be had, s stays below
the distance left, and w alone makes the position first (the quadratic penalty method, section 17.1 there).
Degenerate case. Where the joints that are off their limits cannot move the position in every direction (an arm
stretched at a limit) there are no multipliers, and the distance vanishes faster than the joints arrive: they end
some 1e-5 beside their limits. So joints near their limits are put on them and held there (`on_limits`), the others
go down once more, and the better of the two ends counts.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from robokin.arrays import Array, Index
from robokin.inverse.numeric.second_order import go_down, offsets, place_jacobian
from robokin.kernel.chain import Chain

AT_LIMIT = 1e-3
"""Joints nearer to a limit than this [rad | size] are tried on it: some ten times as far as they end beside it."""

STILL = 1e-2
"""A step [rad | size] that ends a round, as a part of √w: in flat valleys steps are short while the way is long."""

EXACT_STILL = 1e-9
"""A step [rad | size] that ends the last descents: the joints are then at the minimum to rounding."""

EDGE = 1e-3
"""Least singular value of the position's Jacobian [size] at which a position may be at the edge of the reach."""

STANDS = 1e-12
"""A joint that moves the position by less [size / rad] does not move it: rounding of an axis through the tool."""

SLOW_FROM, SLOW_TO = 1e-11, 1e-5
"""Distances [size] between which an end may still be on its slow way to a position at the edge of the reach."""

SAME_PLACE = 1e-10
"""Distances from the target [size] that differ by less are the same."""


class DescentEnds(NamedTuple):
    """x: (n, s) [rad | size], their distances [size] and angles [rad] from the targets, each (s,)."""

    x: Array
    distance: Array
    angle: Array

    def pick(self, which: Index) -> DescentEnds:
        """Some of them."""
        return DescentEnds(self.x[:, which], self.distance[which], self.angle[which])


class Ways(NamedTuple):
    """What descents are asked for: chain; size: of the arm [m]; low, high: (n, 1) or (n, s) limits [rad | size]."""

    chain: Chain
    size: float
    low: Array
    high: Array


def position_first(ways: Ways, T: Array, x: Array, weights: tuple[float, ...], steps: int, last: int) -> DescentEnds:
    """Where x: (n, s) [rad | size] comes to in rounds with these weights w, each of at most some steps.

    T: (4, 3, s) the targets' columns [m]; last: steps of one more round, for the position alone.
    """
    chain, size, low, high = ways
    shift, before = np.zeros((3, x.shape[1])), 1.0
    for w in weights:
        shift *= w / before
        shifted = T.copy()
        shifted[3] -= size * shift
        every = np.full(x.shape[1], w)
        x, _, _ = go_down(chain, shifted, x, size, (low, high), every, steps=steps, still=STILL * w**0.5)
        shift += offsets(chain, T, x, size)
        before = w
    none = np.zeros(x.shape[1])
    x, place, turn = go_down(chain, T, x, size, (low, high), none, steps=last, still=EXACT_STILL, least=1e-9)
    return DescentEnds(x, np.sqrt(2.0 * place), _angle(turn))


def on_limits(
    ways: Ways, T: Array, ends: DescentEnds, weights: tuple[float, ...], steps: int, last: int
) -> DescentEnds:
    """The ends, or those of descents with all joints that are near their limits held at these, where they are better.

    The arguments are those of `position_first`.
    """
    low, high = np.broadcast_to(ways.low, ends.x.shape), np.broadcast_to(ways.high, ends.x.shape)
    at_low, at_high = ends.x <= low + AT_LIMIT, ends.x >= high - AT_LIMIT
    held = Ways(ways.chain, ways.size, np.where(at_high, high, low), np.where(at_low & ~at_high, low, high))
    return better(ends, position_first(held, T, ends.x, weights, steps, last))


def nearer_still(ways: Ways, T: Array, ends: DescentEnds, steps: int) -> DescentEnds:
    """The ends, those that nearly have the position moved on towards it with hardly any damping.

    At the edge of the reach the curvature vanishes with the distance, and the damping that keeps still what the
    position leaves free, where that is far off, is more than it.
    """
    chain, size, low, high = ways
    slow = np.flatnonzero((ends.distance > SLOW_FROM) & (ends.distance < SLOW_TO))
    if not len(slow):
        return ends
    chosen, none = ends.pick(slow), np.zeros(len(slow))
    x, place, turn = go_down(
        chain, T[..., slow], chosen.x, size, (low, high), none, steps=steps, still=1e-12, least=1e-15
    )
    on = better(chosen, DescentEnds(x, np.sqrt(2.0 * place), _angle(turn)))
    for whole, part in zip(ends, on, strict=True):
        whole[..., slow] = part
    return ends


def at_the_edge(
    ways: Ways, T: Array, ends: DescentEnds, weights: tuple[float, ...], steps: int, last: int
) -> DescentEnds:
    """The ends; those that have the position where the free joints cannot move it in some direction, less turned.

    There the distance grows with the square of the joints' move, which the weights of `position_first` must be far
    below. The arguments are those of `position_first`.
    """
    chain, size, low, high = ways
    near = np.flatnonzero(ends.distance < SLOW_TO)
    if not len(near):
        return ends
    x = ends.x[:, near]
    held = (x <= np.broadcast_to(low, ends.x.shape)[:, near]) | (x >= np.broadcast_to(high, ends.x.shape)[:, near])
    J = np.where(held[:, None], 0.0, place_jacobian(chain, x, size))
    values = np.linalg.svd(J.transpose(2, 1, 0), compute_uv=False)
    near = near[(values[:, -1] < EDGE) | (chain.n < 3)]
    if not len(near):
        return ends
    T, part = T[..., near], ends.pick(near)
    on = better(part, nearer_still(ways, T, position_first(ways, T, part.x, weights, steps, last), 40))
    # What the joints lost on the last of the way is made good by those that do not move the position at all.
    moves = np.sum(np.square(place_jacobian(chain, on.x, size)), axis=1) > STANDS**2
    low, high = np.where(moves, on.x, low), np.where(moves, on.x, high)
    x, place, turn = go_down(chain, T, on.x, size, (low, high), np.ones(len(near)), steps=8, still=EXACT_STILL)
    on = better(on, DescentEnds(x, np.sqrt(2.0 * place), _angle(turn)))
    for whole, entries in zip(ends, on, strict=True):
        whole[..., near] = entries
    return ends


def _angle(turn: Array) -> Array:
    """θ [rad] of 1 - cos θ."""
    angle: Array = 2.0 * np.arcsin(np.sqrt(np.minimum(0.5 * turn, 1.0)))
    return angle


def better(first: DescentEnds, second: DescentEnds) -> DescentEnds:
    """Of each pair of ends that which is nearer, or as near and less turned; the first where both are the same."""
    nearer = second.distance < first.distance - SAME_PLACE
    turned = (second.distance <= first.distance + SAME_PLACE) & (second.angle < first.angle)
    take = nearer | turned
    return DescentEnds(*(np.where(take, new, old) for new, old in zip(second, first, strict=True)))
