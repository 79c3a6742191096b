"""Self-motions that no path of a homotopy ends on: those that cross known ones, and those that only a search finds.

Statement. Of targets with self-motions list the solutions once each (`members`), with all self-motions that are
connected with a known one, and with those that Newton's steps find.
Derivation. The paths of a homotopy end on each connected set of complex solutions, but not on each of the curves that
it consists of: of a four-bar linkage whose sides are equal in pairs they may all end on the curve on which all joints
move, and none where two bars are folded onto each other and turn as one. Where such curves cross the Jacobian loses
rank (`curve_crossings`): from there all curves are followed, and so on from those that they lead to. Nor do paths end
on each real piece of a complex curve: those that end on it may all end where it is not real. So where paths end in
singular solutions steps from random configurations look for others; on a curve many of them end.
Degenerate case. Of a target whose curves have no end nothing is vouched for.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.numeric.least_squares import descend
from robokin.inverse.self_motion.chosen_members import SelfMotion
from robokin.inverse.self_motion.curve_crossings import crossings
from robokin.inverse.self_motion.curve_tracing import Curve
from robokin.inverse.self_motion.members import listed_once
from robokin.inverse.self_motion.solution_sets import families, on_curve
from robokin.inverse.verify import CLOSES, Found, merged
from robokin.kernel.chain import Chain
from robokin.kernel.residual import distance_and_angle, error_and_jacobian
from robokin.spatial.angles import circled

ROUNDS = 4
"""How often curves are followed from crossings with known ones: a curve that is three crossings away is rare."""

GUESSES = 64
"""Random configurations that steps are made from: of those that end, from one in ten to nearly all end on a curve."""

GUESS_STEPS = 30
"""Steps from each: those that end take some fifteen, and one in fifty more than this."""

KNOWN = 1e-2
"""A configuration that ends nearer [rad | size] to a listed one was on the way to it, if that counts many times."""

AMID = 0.29
"""Which point of a curve is its seed, as a part of its length: not where it was followed from, which is a crossing."""


def listed_with_more(
    chain: Chain,
    solver: object,
    T: Array,
    found: Found,
    size: float,
    limits: Array,
    rest: Array,
    near: Array | None,
    searched: Index,
) -> tuple[Found, dict[int, list[SelfMotion]], Index, Index]:
    """What `members.listed_once` says of solutions (s, n), sorted, of targets T (m, 4, 4), with more self-motions.

    searched: (k,) the targets for which they are looked for from random configurations. Targets whose curves had no
    end are among those said to be unclear.
    """
    found, motions, unclear, beside = listed_once(chain, solver, T, found, size, limits, rest, near)
    growing = sorted({*motions, *searched.tolist()})
    ends = _searched(chain, T[searched], size)
    for step in range(ROUNDS):
        curves = _crossing(chain, T, motions, growing, size, limits)
        seeds = {i: _amid(chain, some) for i, some in curves.items()}
        for i in searched.tolist() if step == 0 else ():
            mine = ends.q[ends.index == np.searchsorted(searched, i)]
            others = _new(chain, T[i], mine, found.q[found.index == i], motions.get(i, []), size)
            seeds[i] = np.concatenate([seeds[i], others]) if i in seeds else others
        targets = np.array([i for i in growing if len(seeds.get(i, ()))], dtype=np.intp)
        if not len(targets):
            return found, motions, unclear, beside
        more = _solutions(chain, T, targets, [seeds[i] for i in targets.tolist()], size)
        known = found.pick(np.isin(found.index, targets))
        both = merged(Found(np.searchsorted(targets, known.index), known.q, known.position, known.angle), more)
        both = both.pick(np.argsort(both.index, kind="stable"))
        followed = {
            k: [*(motion.curve for motion in motions.get(i, [])), *curves.get(i, [])]
            for k, i in enumerate(targets.tolist())
        }
        again, said, doubtful, near_by = listed_once(
            chain, solver, T[targets], both, size, limits, rest, near, followed
        )
        number = np.bincount(again.index, minlength=len(targets)) - np.bincount(known.index, minlength=len(T))[targets]
        # A new self-motion may have taken up solutions that seemed to stand alone.
        new = [len(said.get(k, ())) > len(motions.get(i, ())) for k, i in enumerate(targets.tolist())]
        grown = np.flatnonzero((number > 0) | np.array(new))
        growing = targets[grown].tolist()
        if not growing:
            return found, motions, unclear, beside
        again = again.pick(np.isin(again.index, grown))
        kept = found.pick(~np.isin(found.index, growing))
        found = merged(kept, again.numbered(targets))
        found = found.pick(np.argsort(found.index, kind="stable"))
        motions |= {int(targets[k]): said[k] for k in grown.tolist() if k in said}
        unclear = np.union1d(unclear, targets[np.intersect1d(doubtful, grown)])
        beside[growing] += near_by[grown]
    return found, motions, np.union1d(unclear, np.array(growing, dtype=np.intp)), beside


def _crossing(
    chain: Chain, T: Array, motions: dict[int, list[SelfMotion]], targets: list[int], size: float, limits: Array
) -> dict[int, list[Curve]]:
    """The curves that leave the crossings of known ones, which are not among them, of some targets that have any."""
    known = [(i, motion.curve) for i in targets for motion in motions.get(i, [])]
    of = np.array([i for i, _ in known], dtype=np.intp)
    which, at = crossings([curve for _, curve in known], chain, T[of], size)
    if not len(at):
        return {}
    some, index = np.unique(of[which], return_inverse=True)
    before = {k: [motion.curve for motion in motions[i]] for k, i in enumerate(some.tolist())}
    found = {}
    for k, sets in enumerate(families(chain, T[some], at, size, index, before, False, limits).curves):
        curves = [part for curve in sets[len(before[k]) :] for part in curve.sheets or (curve,)]
        i = int(some[k])
        new = ~_on(chain, T[i], _amid(chain, curves), motions[i], size)
        found[i] = [curve for curve, one in zip(curves, new.tolist(), strict=True) if one]
    return found


def _amid(chain: Chain, curves: Sequence[Curve]) -> Array:
    """A member (k, n) [rad | m] of each of some curves."""
    return np.array([curve.q[int(AMID * len(curve.q))] for curve in curves]).reshape(-1, chain.n)


def _searched(chain: Chain, T: Array, size: float) -> Found:
    """Solutions (s, n) of targets T (m, 4, 4) that steps from random configurations end at."""
    span = np.where(chain.revolute, np.pi, size)
    start = np.random.default_rng(11).uniform(-span, span, (GUESSES, chain.n))
    index = np.repeat(np.arange(len(T)), GUESSES)
    q, error = descend(chain, T[index], np.tile(start, (len(T), 1)), size, steps=GUESS_STEPS)
    position, angle = distance_and_angle(error)
    return Found(index, q, position * size, angle).pick((position <= CLOSES) & (angle <= CLOSES))


def _new(chain: Chain, T: Array, ends: Array, q: Array, motions: list[SelfMotion], size: float) -> Array:
    """Which of solutions (k, n) [rad | m] are neither listed, in q (s, n), nor on a self-motion that is known."""
    gap = circled((ends[:, None] - q[None]) / np.where(chain.revolute, 1.0, size), chain.revolute)
    ends = ends[np.all(np.max(np.abs(gap), axis=2) > KNOWN, axis=1)]
    return np.asarray(ends[~_on(chain, T, ends, motions, size)])


def _on(chain: Chain, T: Array, q: Array, motions: list[SelfMotion], size: float) -> Flags:
    """(k,) whether configurations (k, n) are on self-motions."""
    on = np.zeros(len(q), dtype=bool)
    for motion in motions:
        rest = np.flatnonzero(~on)
        on[rest] = on_curve(motion.curve, chain, T, q[rest], size)
    return on


def _solutions(chain: Chain, T: Array, targets: Index, seeds: list[Array], size: float) -> Found:
    """Configurations of some targets (k,) that close, numbered as in these."""
    index = np.repeat(np.arange(len(targets)), [len(part) for part in seeds])
    q = np.concatenate(seeds)
    error, _ = error_and_jacobian(chain, T[targets[index]], q, size)
    position, angle = distance_and_angle(error)
    return Found(index, q, position * size, angle).pick((position <= CLOSES) & (angle <= CLOSES))
