"""Self-motions: which configurations stand alone, and the sets of configurations that the others are on.

Statement. Given configurations that reach a pose, tell which stand alone, which count twice, and follow the sets that
the others are on.
Derivation. With a Jacobian of full rank the solutions are a manifold of as many dimensions as there are joints more
than six. Otherwise the directions of the tangent cone are tried (`tangent_cone`), and a set is followed along those
that close (`curve_tracing`). What does not is a root on its own, mostly a double one (`fold`).
Degenerate case. Of a set of more dimensions only the curves are followed on which one joint of a basis moves and the
others of the basis are locked.

Here x are joint values [rad | size] and lengths are in the arm's size.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.numeric.nearest import few_joints
from robokin.inverse.self_motion.curve_tracing import Curve, leads_away, trace_many
from robokin.inverse.self_motion.fold import SLIGHT_BEND, to_fold, to_multiple_roots
from robokin.inverse.self_motion.pose_correction import CLOSES, SLOW_STEPS, corrected, errors, scale_of
from robokin.inverse.self_motion.straight_motions import straight_line
from robokin.inverse.self_motion.tangent_cone import cone, cones, follows, null_spaces
from robokin.kernel.chain import Chain
from robokin.kernel.ranks import RANK, ROOT_RANK


class Local(NamedTuple):
    """What configurations near solutions are.

    q: (s, n) [rad | m] brought to the pose, x: (s, n) the same as far as Newton's steps go; null: (s,) dimension of the
    null space; dimension: (s,) that of the set of solutions there: 0 where the solution stands alone; double: (s,)
    whether it is a root of two or more solutions that merge, and known to full digits; ways: for each the directions
    (k, n) in which curves leave it (in x, of length 1). What stands alone with null > 0 and is not double is near a
    fold that the target is not at, or a root of an order that is not known. trial: (s,) whether it is still to be shown
    that a curve leads away.
    """

    q: Array
    x: Array
    null: Index
    dimension: Index
    double: Flags
    ways: list[Array]
    trial: Flags


def classify(chain: Chain, T: Array, q: Array, size: float) -> Local:
    """What q (s, n) [rad | m], which nearly reach T (s, 4, 4) or (4, 4), are: alone, double, or on a set."""
    T = np.broadcast_to(T, (len(q), 4, 4))
    local = suspected(chain, T, q, size)
    rows = np.flatnonzero(local.trial)
    if len(rows):
        ways = np.array([local.ways[i][0] for i in rows])
        on = leads_away(chain, T[rows], local.x[rows], ways, size)
        local.trial[rows] = False
        stand_alone(chain, T, local, rows[~on], size)
    return local


def suspected(chain: Chain, T: Array, q: Array, size: float, alone: bool = True) -> Local:
    """`classify` for T (s, 4, 4), but for `trial`: what has one null vector may turn out to stand alone.

    Following a curve shows that as well. Unless `alone` nothing is made of solutions that are on no curve.
    """
    scale = scale_of(chain, size)
    x, off, J = corrected(chain, T, q / scale, size)
    # Of an arm with a joint to spare the null vectors are wanted as well.
    spare = chain.n > J.shape[1]
    values, Vt = np.linalg.svd(J)[1:] if spare else (np.linalg.svd(J, compute_uv=False), J)
    null = chain.n - np.sum(values > ROOT_RANK, axis=1)
    exact = np.where(off[:, None] <= CLOSES, x * scale, q)
    double = np.zeros(len(x), dtype=bool)
    # With a Jacobian of full rank the solutions are a manifold, and at a fold no curve leaves: neither is tried.
    manifold = (chain.n - null == 6) & (null > 0)
    trying = (null > 0) & ~manifold
    single = np.flatnonzero(trying & (null == 1))
    folds = to_fold(chain, T[single], exact[single], size)
    double[single] = folds.double
    exact[double] = folds.q[folds.double]
    trying[single[np.isfinite(folds.mu)]] = False
    ways = [np.empty((0, chain.n))] * len(x)
    dimension = np.where(manifold, null, 0)
    # The one null vector of a Jacobian of full rank is the direction.
    for i in np.flatnonzero(manifold & (null == 1)).tolist():
        ways[i] = Vt[i, 6:]
    for i in np.flatnonzero(manifold & (null > 1)).tolist():
        ways[i] = cone(J[i])[0]
    trial = _follow(chain, T, x, J, np.flatnonzero(trying), size, ways, dimension)
    if alone:
        _sharpen(chain, T, np.where(dimension == 0, null, 0), size, exact, double)
        # Beside a root that counts many times no curve is seen; at the root itself one may lead away.
        many = np.flatnonzero(double & (null > 1) & (dimension == 0))
        if len(many):
            x[many] = exact[many] / scale
            _, J[many] = errors(chain, T[many], x[many], size)
            trial |= _follow(chain, T, x, J, many, size, ways, dimension)
            double[many] = dimension[many] == 0
    # Of a curve of double solutions, as of a stretched arm with a straight wrist, a seed has half of the digits.
    curved = (dimension == 1) & (null > 1) & ~manifold
    for many in np.unique(null[curved]).tolist():
        rows = np.flatnonzero(curved & (null == many))
        roots, found = to_multiple_roots(chain, T[rows], exact[rows], size, many)
        exact[rows[found]] = roots[found]
    return Local(exact, x, null, dimension, double, ways, trial)


def stand_alone(chain: Chain, T: Array, local: Local, rows: Index, size: float) -> None:
    """Say of some rows (k,) that no curve leaves them, and bring them to full digits where they are multiple roots."""
    local.dimension[rows] = 0
    for i in rows.tolist():
        local.ways[i] = local.ways[i][:0]
    null = np.zeros_like(local.null)
    null[rows] = local.null[rows]
    _sharpen(chain, T, null, size, local.q, local.double)


def _follow(
    chain: Chain, T: Array, x: Array, J: Array, rows: Index, size: float, ways: list[Array], dimension: Index
) -> Flags:
    """Fill in the directions and dimensions of the sets that leave x (s, n), for the rows (k,) that may be on some.

    Gives (s,) those of which this is not sure yet: with one null vector the one direction is all that there may be.
    """
    trial = np.zeros(len(x), dtype=bool)
    if not len(rows):
        return trial
    cones_of = cones(J[rows])
    place = np.repeat(np.arange(len(rows)), [len(found) for found, _ in cones_of])
    tried, index = np.concatenate([found for found, _ in cones_of]), rows[place]
    on = follows(chain, T[index], x[index], tried, size)
    # A straight line is proven, and on a surface a single direction is no curve's.
    proven = np.array([straight_line(J[i], way) is not None for i, way in zip(index, tried, strict=True)], dtype=bool)
    surface = np.array([flat and found.shape[0] > 1 for found, flat in cones_of], dtype=bool)[place]
    doubtful = on & ~proven & ~surface
    single = np.array([flat and found.shape[0] == 1 for found, flat in cones_of], dtype=bool)[place]
    trial[index[doubtful & single]] = True
    doubtful = np.flatnonzero(doubtful & ~single)
    if len(doubtful):
        on[doubtful] = leads_away(chain, T[index[doubtful]], x[index[doubtful]], tried[doubtful], size)
    surfaces = []
    for k, i in enumerate(rows.tolist()):
        ways[i] = tried[on & (place == k)]
        if len(ways[i]):
            dimension[i] = _dimension(chain, T[i], x[i], ways[i], cones_of[k][1], size)
        if dimension[i] > 1:
            surfaces.append(i)
    leading = _that_lead_away(chain, T, x, J, surfaces, [ways[i] for i in surfaces], dimension, size)
    for i, found in zip(surfaces, leading, strict=True):
        ways[i], dimension[i] = found, min(len(found), dimension[i])
    return trial


def _sharpen(chain: Chain, T: Array, null: Index, size: float, exact: Array, double: Flags) -> None:
    """Bring the multiple roots among `exact` (s, n) to full digits; null: (s,) 0 for what is none."""
    if not null.any():
        return
    # Known not to be on curves, also those that bend less may be folds: an elbow beside a nearly singular wrist.
    slight = np.flatnonzero((null == 1) & ~double)
    folds = to_fold(chain, T[slight], exact[slight], size, SLIGHT_BEND)
    double[slight], exact[slight[folds.double]] = folds.double, folds.q[folds.double]
    for many in np.unique(null[(null > 0) & ~double]).tolist():
        rows = np.flatnonzero((null == many) & ~double)
        roots, found = to_multiple_roots(chain, T[rows], exact[rows], size, many)
        double[rows[found]], exact[rows[found]] = True, roots[found]


def _dimension(chain: Chain, T: Array, x: Array, ways: Array, flat: bool, size: float) -> int:
    """The dimension of the set that leaves x (n,) along ways (k, n): that of its null space a little way off.

    At a generic point of a surface the null space is its tangent plane; along a curve that counts twice the null
    space has more dimensions, of which the cone has only one.
    """
    if len(ways) == 1 and flat:
        return 1
    mixed = np.linalg.svd(ways, full_matrices=False)[2][: np.linalg.matrix_rank(ways, tol=RANK)]
    if flat and len(mixed) > 1:
        drawn = np.random.default_rng(3).normal(size=(2, len(mixed))) @ mixed
        drawn /= np.linalg.norm(drawn, axis=1, keepdims=True)
        many = np.broadcast_to(T, (2, 4, 4))
        if follows(chain, many, np.tile(x, (2, 1)), drawn, size).all():
            return len(mixed)
    start = x + 0.03 * ways
    many = np.broadcast_to(T, (len(ways), 4, 4))
    y, off, J = corrected(chain, many, start, size, ways[:, None], SLOW_STEPS)
    found = 1
    for i in np.flatnonzero(off <= CLOSES):
        null, _ = null_spaces(J[i])
        if len(null) > 1:
            further, whole = cone(J[i])
            on = follows(
                chain, np.broadcast_to(T, (len(further), 4, 4)), np.tile(y[i], (len(further), 1)), further, size
            )
            if whole:
                found = max(found, int(np.sum(on)))
    return found


def _that_lead_away(
    chain: Chain, T: Array, x: Array, J: Array, rows: list[int], ways: list[Array], dimension: Index, size: float
) -> list[Array]:
    """Of each surface through some rows of x (s, n) those of its directions (k, n) that curves follow on it.

    They are all `ways`, if all do. J: (s, 6, n) the Jacobians.
    """
    chosen = [_coordinates(some, int(dimension[i])) for i, some in zip(rows, ways, strict=True)]
    index = np.array([i for i, some in zip(rows, chosen, strict=True) for _ in some], dtype=np.intp)
    if not len(index):
        return []
    along = np.array([way for some in chosen for way, _ in some])
    on = leads_away(chain, T[index], x[index], along, size, np.array([locks for some in chosen for _, locks in some]))
    on |= np.array([straight_line(J[i], way) is not None for i, way in zip(index, along, strict=True)])
    cuts = np.cumsum([len(some) for some in chosen])[:-1]
    parts = zip(ways, np.split(along, cuts), np.split(on, cuts), strict=True)
    return [some if which.all() else those[which] for some, those, which in parts]


def trace(chain: Chain, T: Array, q: Array, size: float, way: Array | None = None) -> Curve | None:
    """The self-motion through q (n,) [rad | m] at T (4, 4), along `way` (n,) in x; None where there is none."""
    local = suspected(chain, T[None], q[None], size)
    if not local.dimension[0]:
        return None
    which = 0 if way is None else int(np.argmax(np.abs(local.ways[0] @ way)))
    return traced_sets(chain, T[None], local, [(0, which)], size)[0]


def traced_sets(
    chain: Chain, T: Array, local: Local, chosen: list[tuple[int, int]], size: float, limits: Array | None = None
) -> list[Curve | None]:
    """The sets through some seeds, each given as (seed, which of its directions); T: (s, 4, 4) the seeds' targets.

    limits: (own, 2) [rad | m] which slides are followed to if they are far.

    Where the set has more dimensions all its directions are followed. Where no curve leads away from a seed on trial
    there is None.
    """
    scale = scale_of(chain, size)
    rows: list[tuple[int, Array, Flags]] = []
    spans = []
    for i, k in chosen:
        first = len(rows)
        if local.dimension[i] <= 1:
            rows.append((i, local.ways[i][k], np.zeros(chain.n, dtype=bool)))
        else:
            rows.extend((i, way, locked) for way, locked in _coordinates(local.ways[i], int(local.dimension[i])))
        spans.append((first, len(rows)))
    index = np.array([row[0] for row in rows], dtype=np.intp)
    curves = trace_many(
        chain,
        T[index],
        local.q[index] / scale,
        np.array([row[1] for row in rows]),
        size,
        np.array([row[2] for row in rows]),
        limits,
        local.trial[index],
    )
    out: list[Curve | None] = []
    for (i, _), (first, last) in zip(chosen, spans, strict=True):
        dimension = int(local.dimension[i])
        sheets = tuple(one for one in curves[first:last] if one is not None) if dimension > 1 else ()
        head = curves[first]
        if head is None:
            out.append(None)
            continue
        out.append(Curve(head.q, head.tangents, scale, head.closed, head.ended, dimension, sheets, head.second))
    return out


def _coordinates(ways: Array, dimension: int) -> list[tuple[Array, Flags]]:
    """Directions (n,) in which one joint of a basis moves, each with the others of the basis, which are locked (n,)."""
    span = np.linalg.svd(ways, full_matrices=False)[2][:dimension]
    basis = few_joints(span)
    pivots = []
    for row in range(len(basis)):
        alone = np.all(np.abs(np.delete(basis, row, axis=0)) < 1e-9, axis=0)
        pivots.append(int(np.argmax(np.abs(basis[row]) * alone)))
    out = []
    for row, way in enumerate(basis):
        locked = np.zeros(basis.shape[1], dtype=bool)
        locked[[pivot for i, pivot in enumerate(pivots) if i != row]] = True
        out.append((way / np.linalg.norm(way), locked))
    return out
