"""The configurations that come closest to targets without a solution.

Statement, the law of what closest means. Of all configurations within the limits those count whose position
is nearest to the target's (to within `SAME_PLACE`); of these, those whose orientation is nearest, by the angle
of the turn that is left (to within `SAME_ANGLE`); of these, that with the least joint move from home.
Derivation. The position comes first as the limit of a sum: ½|p - t|² + w (1 - cos θ) is minimised for w = 1e-2,
1e-4, 1e-6, 1e-8 and then 0, each from where the one before ended (`second_order`; J. Nocedal, S. J. Wright,
"Numerical Optimization", 2nd ed., 2006, section 17.1, the quadratic penalty method). With w the position's error is
above its least by w times a number of order one, so that the last descent, for the position alone, moves joints by
some 1e-8, and the orientation's error is above its least by the square of that: along what the position leaves free
it has no slope there.
The least of all. A descent ends in the minimum that it starts above. Of configurations drawn at random those are
started from that come nearest in each of as many parts of the joint space; the ends that differ, the best first,
are followed further.
Degenerate case. At the edge of the reach, where f is quartic, the position is exact to 1e-9 of the arm's size.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robokin.inverse.analysis import Analysis
from robokin.inverse.nearest import starts
from robokin.inverse.padding import joint_frames_of
from robokin.inverse.second_order import go_down
from robokin.kinematics.chain import Chain

Array = NDArray[np.float64]

DRAWN = 2048
"""Configurations drawn to choose the starts from."""

STARTS = 32
"""Parts of the joint space, and starts of the search for one target; a power of two."""

FINALISTS = 20
"""Ends of these that are followed further."""

TOGETHER = 32
"""Targets searched for at once: enough that the interpreter's share is spread thin; more gain little."""

FIRST = 1e-2
"""w of the first descents: not so small that the way leads through a narrow curved valley."""

AGAIN = 4
"""The starts of every fourth part go down at once with a small w, too: with the great one two branches near which
the arm is singular, such as those of a nearly folded elbow, lead to one and the same end."""

THEN = (1e-4, 1e-6)
"""w of those that follow."""

LAST = (1e-6, 1e-8)
"""w of the last descents, of the best alone, with more steps: few need them."""

RANKED = 1e-3
"""w by which the ends of the first descents are compared: the position counts for more than it did for these."""

TURN = 1e-2
"""w by which the configurations drawn are compared."""

ALIKE = 1e-3
"""Ends whose distances [size] and angles [rad] differ by less are followed once."""

SAME_PLACE = 1e-10
"""Distances from the target [size] that differ by less are the same."""

SAME_ANGLE = 1e-7
"""Angles [rad] that differ by less are the same."""


def nearest_configurations(
    analysis: Analysis, T: Array, limits: Array, home: Array, seed: int
) -> tuple[Array, Array, Array]:
    """For targets T: (m, 4, 4) [m] the closest configurations (m, n) [rad | m] within limits (n, 2).

    Also their distances (m,) [m] and angles (m,) [rad] from the targets. Idle joints stay at `home` (n,), which is
    also one of the starts. The answer for a target does not depend on the others.
    """
    chain = analysis.chain
    wide = np.concatenate([limits, np.tile([-np.inf, np.inf], (analysis.open, 1))])
    idle = list(analysis.idle)
    wide[idle] = home[idle, None]
    at_home = np.concatenate([home, np.zeros(analysis.open)])
    scale = np.where(chain.revolute, 1.0, analysis.size)
    drawn = starts(chain, wide, analysis.size, DRAWN, seed)
    drawn = drawn[_parts(drawn / scale)]
    poses = joint_frames_of(chain, drawn)[:, -1]
    q, position, angle = np.empty((len(T), len(home))), np.empty(len(T)), np.empty(len(T))
    for first in range(0, len(T), TOGETHER):
        some = slice(first, first + TOGETHER)
        chosen = drawn[_best_of_parts(poses, T[some], analysis.size)]
        chosen = np.concatenate(
            [np.broadcast_to(at_home, (len(chosen), 1, chain.n)), chosen, chosen[:, ::AGAIN]], axis=1
        )
        q[some], position[some], angle[some] = _search(analysis, T[some], chosen / scale, wide / scale[:, None], home)
    return q, position * analysis.size, angle


def beyond_reach(analysis: Analysis, T: Array, limits: Array) -> NDArray[np.bool_]:
    """Which targets T: (m, 4, 4) [m] are farther away than the arm, stretched out, is long.

    From the first joint's axis to the tool there are the constant transforms' lengths and the slides' ways.
    True proves that a target is out of reach; False proves nothing.
    """
    chain, own = analysis.chain, len(limits)
    farthest = np.max(np.abs(limits + chain.offsets[:own, None]), axis=1)
    length = np.sum(np.linalg.norm(chain.constants[1:, :3, 3], axis=1))
    length += np.sum(farthest[~chain.revolute[:own]])
    away = np.linalg.norm(T[:, :3, 3] - chain.constants[0, :3, 3], axis=1)
    beyond: NDArray[np.bool_] = away > length + 1e-6 * analysis.size
    return beyond


def _parts(x: Array) -> NDArray[np.intp]:
    """The order of configurations (DRAWN, n) that puts those of each of STARTS parts of the joint space together.

    The parts come from halving at the median, joint after joint (J. L. Bentley's k-d tree, Commun. ACM 18(9),
    1975).
    """
    cells, joint = [np.arange(len(x))], 0
    while len(cells) < STARTS:
        ordered = [cell[np.argsort(x[cell, joint % x.shape[1]], kind="stable")] for cell in cells]
        cells = [half for cell in ordered for half in (cell[: len(cell) // 2], cell[len(cell) // 2 :])]
        joint += 1
    return np.concatenate(cells)


def _best_of_parts(poses: Array, T: Array, size: float) -> NDArray[np.intp]:
    """(m, STARTS) which of the poses (DRAWN, 4, 4) comes nearest to each target (m, 4, 4) in each part."""
    away = np.zeros((len(T), len(poses)))
    for row in range(3):
        for column in range(4):
            weight = 1.0 / size**2 if column == 3 else TURN / 2.0
            away += weight * np.square(poses[:, row, column] - T[:, None, row, column])
    each = len(poses) // STARTS
    best: NDArray[np.intp] = np.argmin(away.reshape(len(T), STARTS, each), axis=2) + each * np.arange(STARTS)
    return best


def _search(analysis: Analysis, T: Array, x: Array, limits: Array, home: Array) -> tuple[Array, Array, Array]:
    """The best of what starts x: (m, k, n) come to, their distances [size] and angles; limits (n, 2) [rad | size]."""
    chain, size = analysis.chain, analysis.size
    scale = np.where(chain.revolute, 1.0, size)
    low_high = limits[:, :1], limits[:, 1:]
    m, k, n = x.shape
    targets = np.ascontiguousarray(T[:, :3].transpose(2, 1, 0))
    ends, place, turn = go_down(
        chain,
        np.repeat(targets, k, axis=2),
        np.ascontiguousarray(x.reshape(m * k, n).T),
        size,
        low_high,
        np.tile(np.where(np.arange(k) <= STARTS, FIRST, THEN[0]), m),
        steps=8,
        still=1e-3,
    )
    picked = _finalists(place.reshape(m, k), turn.reshape(m, k)) + k * np.arange(m)[:, None]
    many = np.repeat(targets, FINALISTS, axis=2)
    ends, distance, angle = _position_first(chain, many, ends[:, picked.ravel()], size, low_high, THEN, 8)
    away = (ends.T[:, : len(home)] * scale[: len(home)]).reshape(m, FINALISTS, len(home)) - home
    best = _closest(chain, distance.reshape(m, FINALISTS), angle.reshape(m, FINALISTS), away, size)
    best += FINALISTS * np.arange(m)
    end, distance, angle = ends[:, best], distance[best], angle[best]
    last, nearer, less = _position_first(chain, targets, end, size, low_high, LAST, 40)
    # Beside a singular configuration the way along what the position leaves free may lead off it.
    better = nearer <= distance + SAME_PLACE
    end, distance, angle = (
        np.where(better, last, end),
        np.where(better, nearer, distance),
        np.where(better, less, angle),
    )
    return end.T[:, : len(home)] * scale[: len(home)], distance, angle


def _position_first(
    chain: Chain, T: Array, x: Array, size: float, limits: tuple[Array, Array], weights: tuple[float, ...], steps: int
) -> tuple[Array, Array, Array]:
    """Where x: (n, s) comes to by the law above [rad | size], its distances [size] and angles [rad], each (s,).

    T: (4, 3, s) the targets' columns [m].
    """
    for w in weights:
        every = np.full(x.shape[1], w)
        x, _, _ = go_down(chain, T, x, size, limits, every, steps=steps, still=0.1 * w**0.5)
    none = np.zeros(x.shape[1])
    x, place, turn = go_down(chain, T, x, size, limits, none, steps=25, still=1e-7, least=1e-9)
    return x, np.sqrt(2.0 * place), 2.0 * np.arcsin(np.sqrt(np.minimum(0.5 * turn, 1.0)))


def _finalists(place: Array, turn: Array) -> NDArray[np.intp]:
    """(m, FINALISTS) the ends to follow, the best that differ, of those with ½|p - t|² and 1 - cos θ, each (m, k)."""
    order = np.argsort(place + RANKED * turn, axis=1, kind="stable")
    distance = np.take_along_axis(np.sqrt(2.0 * place), order, axis=1)
    angle = np.take_along_axis(np.sqrt(2.0 * turn), order, axis=1)
    alike = np.abs(distance[:, :, None] - distance[:, None]) < ALIKE
    alike &= np.abs(angle[:, :, None] - angle[:, None]) < ALIKE
    again = np.any(alike & np.tri(order.shape[1], k=-1, dtype=bool), axis=2)
    return np.take_along_axis(order, np.argsort(again, axis=1, kind="stable"), axis=1)[:, :FINALISTS]


def _closest(chain: Chain, distance: Array, angle: Array, move: Array, size: float) -> NDArray[np.intp]:
    """(m,) the best of ends with distances [size], angles (m, k) and joint moves (m, k, n), by the law above."""
    turns = chain.revolute[: move.shape[2]]
    move = np.where(turns, move - 2.0 * np.pi * np.round(move / (2.0 * np.pi)), move / size)
    farthest = np.max(np.abs(move), axis=2)
    angle = np.where(distance <= distance.min(axis=1, keepdims=True) + SAME_PLACE, angle, np.inf)
    farthest = np.where(angle <= angle.min(axis=1, keepdims=True) + SAME_ANGLE, farthest, np.inf)
    best: NDArray[np.intp] = np.argmin(farthest, axis=1)
    return best
