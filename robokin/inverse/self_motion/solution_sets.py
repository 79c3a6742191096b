"""Which solutions are on the same self-motion, and every self-motion once.

Statement. Given configurations that reach poses, find the sets that they are on, each once, and for each
configuration its set.
Derivation. A configuration is on a curve if it is beside its polyline and the curve's point in the plane through it
at right angles to the curve is the configuration itself. Two configurations are on one surface if steps within the
null space, each the projection of the way to go, lead from one to the other. Seeds are followed some at a time; those
that turn out to be on a curve that was followed need no curve of their own. Where curves cross, a seed at the crossing
has several directions, and each is asked for on its own.
Degenerate case. A surface that is not convex enough for straight steps is taken for two.

Here x are joint values [rad | size] and lengths are in the arm's size.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.self_motion.curve_tracing import BESIDE, Curve
from robokin.inverse.self_motion.fronts import LONGEST, SAME
from robokin.inverse.self_motion.native_curves import ON, levels_of
from robokin.inverse.self_motion.pose_correction import CLOSES, SLOW_STEPS, corrected, errors, scale_of
from robokin.inverse.self_motion.singular_solutions import Local, stand_alone, suspected, traced_sets
from robokin.kernel.chain import Chain
from robokin.kernel.ranks import ROOT_RANK
from robokin.spatial.angles import circled

FEW = 4
"""Seeds of one target that are followed at the same time: most targets have no more curves."""

MOST_SETS = 12
"""Sets of a target that are followed at most: arms of six joints have some four, and a surface is taken apart into any
number."""

ALONG = 0.98
"""Cosine of the angle up to which a direction of a seed is that of a curve through it."""

WALK = 200
"""Steps of a walk on a surface at most: 30 rad."""


class Families(NamedTuple):
    """The self-motions that seeds are on.

    curves: for each target its sets, each once; of: (s,) the place of each seed's (first) set among those of its
    target, -1 where the seed stands alone; local: what the seeds are; open: the targets of which not all was followed:
    more than `MOST_SETS` curves, or a surface, to which all seeds on surfaces are then said to belong.
    """

    curves: list[list[Curve]]
    of: Index
    local: Local
    open: frozenset[int]


def families(
    chain: Chain,
    T: Array,
    seeds: Array,
    size: float,
    index: Index | None = None,
    known: Mapping[int, Sequence[Curve]] | None = None,
    alone: bool = True,
    limits: Array | None = None,
) -> Families:
    """Every self-motion that seeds (s, n) [rad | m] are on, for targets T (m, 4, 4); index: (s,) the seeds' targets.

    known: those of some targets, by their numbers, that have been followed before; alone: whether seeds that are on
    none are made exact; limits: (own, 2) [rad | m], which slides are followed to if they are far.
    """
    index = np.zeros(len(seeds), dtype=np.intp) if index is None else index
    T = T.reshape(-1, 4, 4)
    local = suspected(chain, T[index], seeds, size, alone)
    curves: list[list[Curve]] = [list(known.get(i, ())) if known else [] for i in range(len(T))]
    of = np.full(len(seeds), -1, dtype=np.intp)
    open_: set[int] = set()
    single: list[int] = []
    # One entry for each direction of a curve, one for all of a surface.
    waiting = [(i, k) for i, ways in enumerate(local.ways) for k in range(len(ways) if local.dimension[i] == 1 else 1)]
    waiting = [(i, k) for i, k in waiting if local.dimension[i] > 0]
    if known:
        waiting = _unclaimed(chain, T, waiting, index, curves, of, local, size)
    while waiting:
        chosen = _few_of_each(waiting, index)
        known_before = [len(some) for some in curves]
        done = set(chosen)
        traced = traced_sets(chain, T[index], local, chosen, size, limits)
        single += [entry[0] for entry, curve in zip(chosen, traced, strict=True) if curve is None]
        found = [(entry, curve) for entry, curve in zip(chosen, traced, strict=True) if curve is not None]
        same = _pairs_through(chain, T, found, index, local, size)
        kept: list[int] = []
        for place, ((i, _), curve) in enumerate(found):
            first = next((other for other in kept if (other, place) in same), None)
            if first is None:
                kept.append(place)
                curves[index[i]].append(curve)
                of[i] = len(curves[index[i]]) - 1 if of[i] < 0 else of[i]
            elif of[i] < 0:
                of[i] = of[found[first][0][0]]
        waiting = [entry for entry in waiting if entry not in done]
        waiting = _within_bounds(waiting, index, curves, of, local, open_)
        waiting = _unclaimed(chain, T, waiting, index, curves, of, local, size, known_before)
    if alone:
        stand_alone(chain, T[index], local, np.array(single, dtype=np.intp), size)
    return Families(curves, of, local, frozenset(open_))


def _within_bounds(
    waiting: list[tuple[int, int]], index: Index, curves: list[list[Curve]], of: Index, local: Local, open_: set[int]
) -> list[tuple[int, int]]:
    """The waiting entries without those that are not to be followed; their targets are added to `open_`."""
    left = []
    for entry in waiting:
        target = int(index[entry[0]])
        surface = next((k for k, curve in enumerate(curves[target]) if curve.sheets), None)
        if local.dimension[entry[0]] > 1 and surface is not None:
            of[entry[0]] = surface
            open_.add(target)
        elif len(curves[target]) >= MOST_SETS:
            open_.add(target)
        else:
            left.append(entry)
    return left


def _few_of_each(waiting: list[tuple[int, int]], index: Index) -> list[tuple[int, int]]:
    """Some entries of each target, spread over what is waiting: neighbours in a list are often on one curve."""
    by_target: dict[int, list[tuple[int, int]]] = {}
    for entry in waiting:
        by_target.setdefault(int(index[entry[0]]), []).append(entry)
    chosen: list[tuple[int, int]] = []
    for entries in by_target.values():
        places = np.unique(np.linspace(0, len(entries) - 1, min(FEW, len(entries))).astype(int))
        chosen.extend(entries[place] for place in places)
    return chosen


def _unclaimed(
    chain: Chain,
    T: Array,
    waiting: list[tuple[int, int]],
    index: Index,
    curves: list[list[Curve]],
    of: Index,
    local: Local,
    size: float,
    before: list[int] | None = None,
) -> list[tuple[int, int]]:
    """The waiting entries that no curve runs through; `of` is filled in for the others.

    before: of each target how many of its first curves are known to run through none.
    """
    scale = scale_of(chain, size)
    by_target: dict[int, list[tuple[int, int]]] = {}
    for entry in waiting:
        by_target.setdefault(int(index[entry[0]]), []).append(entry)
    pairs = [
        (entry, number, curve)
        for target, entries in by_target.items()
        for entry in entries
        for number, curve in enumerate(curves[target])
        if before is None or number >= before[target]
    ]
    claimed: dict[tuple[int, int], int] = {}
    x = np.array([local.q[entry[0]] for entry, _, _ in pairs]).reshape(-1, chain.n) / scale
    ways = np.array([local.ways[entry[0]][entry[1]] for entry, _, _ in pairs]).reshape(-1, chain.n)
    through = _through(chain, T[index[[entry[0] for entry, _, _ in pairs]]], [pair[2] for pair in pairs], x, ways, size)
    for (entry, number, _), on in zip(pairs, through.tolist(), strict=True):
        if on and entry not in claimed:
            claimed[entry] = number
            of[entry[0]] = number if of[entry[0]] < 0 else of[entry[0]]
    return [entry for entry in waiting if entry not in claimed]


def _pairs_through(
    chain: Chain, T: Array, found: list[tuple[tuple[int, int], Curve]], index: Index, local: Local, size: float
) -> set[tuple[int, int]]:
    """The pairs (a, b), a < b, of curves followed from seeds of one target of which a runs through b's seed."""
    entries = [entry for entry, _ in found]
    pairs = [(a, b) for b in range(len(found)) for a in range(b) if index[entries[a][0]] == index[entries[b][0]]]
    x = np.array([local.q[entries[b][0]] for _, b in pairs]).reshape(-1, chain.n) / scale_of(chain, size)
    ways = np.array([local.ways[entries[b][0]][entries[b][1]] for _, b in pairs]).reshape(-1, chain.n)
    targets = T[index[[entries[b][0] for _, b in pairs]]]
    through = _through(chain, targets, [found[a][1] for a, _ in pairs], x, ways, size)
    return {pair for pair, on in zip(pairs, through.tolist(), strict=True) if on}


def _through(chain: Chain, T: Array, curves: list[Curve], x: Array, ways: Array, size: float) -> Flags:
    """(m,) whether each of m sets runs through its x (m, n) in its direction (m, n), T: (m, 4, 4) being the targets."""
    levels = levels_of(curves, chain, T, x, ways, size)
    if levels is None:
        rows, tangents = _passes(curves, chain, T, x, size)
        along = np.abs(np.einsum("ij,ij->i", tangents, ways[rows])) >= ALONG
        on = np.isin(np.arange(len(x)), rows[along])
    else:
        on = levels > ON
    for i in [i for i, curve in enumerate(curves) if curve.sheets]:
        # A seed on a curve is asked for on the curves that were followed on a surface, not on all of it.
        sheets = curves[i].sheets
        on[i] = len(_passes(list(sheets), chain, T[[i] * len(sheets)], x[[i] * len(sheets)], size)[0]) > 0
    return np.asarray(on)


def on_curve(curve: Curve, chain: Chain, T: Array, q: Array, size: float) -> Flags:
    """(m,) whether configurations q (m, n) [rad | m], angles modulo full turns, are on a self-motion at T (4, 4)."""
    x = q / curve.scale
    on = np.zeros(len(x), dtype=bool)
    many = np.broadcast_to(T, (len(x), 4, 4))
    for part in curve.sheets or (curve,):
        on[_passes([part] * len(x), chain, many, x, size)[0]] = True
    if curve.sheets:
        rest = np.flatnonzero(~on)
        on[rest] = walks_to(chain, T, curve.x[0], x[rest], size)
    return on


def _passes(curves: list[Curve], chain: Chain, T: Array, x: Array, size: float) -> tuple[Index, Array]:
    """Where each of m curves at T (m, 4, 4) passes through its x (m, n): rows (k,) of x, tangents (k, n) there.

    A curve that crosses itself passes more than once. The native kernel has the same (`native_curves.levels_of`).
    """
    none = np.empty((0, chain.n))
    parts = [(np.empty(0, dtype=np.intp), none, none)]
    for curve in {id(curve): curve for curve in curves}.values():
        mine = np.array([i for i, other in enumerate(curves) if other is curve], dtype=np.intp)
        rows, feet, tangents = _feet(curve, chain, x[mine])
        parts.append((mine[rows], feet, tangents))
    rows, foot, t = (np.concatenate(column) for column in zip(*parts, strict=True))
    if not len(rows):
        return rows, t
    off = circled(x[rows] - foot, chain.revolute)
    start = foot + np.einsum("ij,ij->i", off, t)[:, None] * t
    landed, left, _ = corrected(chain, T[rows], start, size, t[:, None], SLOW_STEPS)
    miss = np.max(np.abs(circled(landed - x[rows], chain.revolute)), axis=1)
    # A point of the curve itself needs no correction, which at a crossing would lead astray.
    on = ((miss <= SAME) & (left <= CLOSES)) | (np.max(np.abs(off), axis=1) <= SAME)
    return rows[on], t[on]


def _feet(curve: Curve, chain: Chain, x: Array) -> tuple[Index, Array, Array]:
    """The points (k, n) of a curve's polyline that are beside x (m, n), which rows (k,) of x, the tangents (k, n)."""
    points = curve.x
    chord = np.diff(points, axis=0)
    gap = circled(x[:, None] - points[:-1], chain.revolute)
    along = np.clip(np.einsum("mkj,kj->mk", gap, chord) / np.einsum("kj,kj->k", chord, chord), 0.0, 1.0)
    distance = np.linalg.norm(gap - along[:, :, None] * chord, axis=2)
    edge = np.full((len(x), 1), np.inf)
    lower = (distance <= np.hstack([edge, distance[:, :-1]])) & (distance <= np.hstack([distance[:, 1:], edge]))
    rows, best = np.nonzero(lower & (distance <= BESIDE))
    part = along[rows, best][:, None]
    t = (1.0 - part) * curve.tangents[best] + part * curve.tangents[best + 1]
    t /= np.maximum(np.linalg.norm(t, axis=1, keepdims=True), 1e-12)
    return rows, points[best] + part * chord[best], t


def walks_to(chain: Chain, T: Array, start: Array, ends: Array, size: float) -> Flags:
    """(m,) whether steps on the set of solutions at T (4, 4) lead from start (n,) to ends (m, n) [rad | size]."""
    reached, on = np.zeros(len(ends), dtype=bool), np.arange(len(ends))
    x = np.tile(start, (len(ends), 1))
    for _ in range(WALK):
        gap = circled(ends[on] - x, chain.revolute)
        distance = np.linalg.norm(gap, axis=1)
        near = distance <= SAME
        reached[on[near]] = True
        on, x, gap, distance = on[~near], x[~near], gap[~near], distance[~near]
        if not len(on):
            break
        many = np.broadcast_to(T, (len(on), 4, 4))
        _, J = errors(chain, many, x, size)
        values, Vt = np.linalg.svd(J)[1:]
        felt = Vt[:, : values.shape[1]] * (values > ROOT_RANK)[:, :, None]
        step = gap - ((felt @ gap[:, :, None]).transpose(0, 2, 1) @ felt)[:, 0]
        length = np.linalg.norm(step, axis=1)
        step *= np.minimum(1.0, LONGEST / np.maximum(length, 1e-300))[:, None]
        new, off, _ = corrected(chain, many, x + step, size)
        goes = (length >= 0.05 * distance) & (off <= CLOSES)
        goes &= np.linalg.norm(new - x - step, axis=1) <= 0.5 * np.linalg.norm(step, axis=1)
        on, x = on[goes], new[goes]
    return reached
