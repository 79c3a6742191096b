"""The dimension of a branch of configurations at one of its points.

At a point of a branch the constraints are reduced anew. Either they vanish all about the point, and the kernel is the
branch's dimension; or the kernel is larger all along the branch, which is then a multiple zero. Such a zero is known to
1e-8 only, by its constraints alone; but their derivative vanishes on it too, so g = 0 and Dg = 0 together (deflation)
find it to the last digit, and their kernel is the dimension, if they vanish all about. Where branches meet, g and Dg
vanish, too; there the second derivatives have zeros beside the branch, and nothing is said.

Source: A. Leykin, J. Verschelde, A. Zhao, "Newton's method with deflation for isolated singularities of polynomial
systems", Theoret. Comput. Sci. 359, 2006.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.brief import Brief
from robokin.mobility.reduced import Reduced, directions
from robokin.mobility.zeros import spread

SECOND = 1e-3
"""Second derivatives below this part of the greatest are none."""

DOUBLE = 1e-4
"""Singular values below this part of the greatest, but above the cut, at a zero that is known to 1e-8 only may be
zeros of a multiple branch."""

SHARP = 1e-9
"""Singular values below this part of the greatest are zero at a point known to the last digit."""

NOISE = 30.0
"""Dimensions wrong by the noise e leave singular values of some times e."""


@dataclass(frozen=True, eq=False, repr=False)
class Branch(Brief):
    """A branch of configurations through the pose: its dimension; kernel, that of the constraints all along it (larger
    than the dimension on a multiple branch); q (n,) a point of it and tangent (n, dimension) there; start (n,
    dimension): the directions in which it leaves the pose, on one side where they differ; times: how often the
    constraints vanish all along."""

    dimension: int
    kernel: int
    q: Array
    tangent: Array
    start: Array
    times: int = 1


def measured(reduced: Reduced, q: Array, radius: float) -> Branch | None:
    """The branch at a point q (n,), looked at up to a radius; None where its dimension cannot be told."""
    chart = reduced.chart
    radii = (radius, 0.5 * radius, 0.2 * radius, 0.05 * radius)
    cut = max(SHARP, NOISE * reduced.noise)
    sharp = Reduced(chart, q, cut=cut)
    loose = loose_kernel(reduced, sharp.values)
    if sharp.k != loose:
        # A multiple zero that is not known to 1e-8 seems to be a simple one.
        multiple = _deflated(Reduced(chart, q, kernel=loose), radii)
        if multiple is not None:
            return multiple
    clear = sharp.k == loose or (sharp.rank > 0 and sharp.values[sharp.rank - 1] > 100.0 * cut)
    if sharp.k and clear and (sharp.free or sharp.flat(radii)[0]):
        return Branch(sharp.k, sharp.k, q, sharp.V0, sharp.V0)
    return _deflated(sharp, radii) if loose and sharp.k == loose else None


def loose_kernel(reduced: Reduced, values: Array) -> int:
    """How many of the singular values at a point may be zeros of a multiple branch."""
    return int(np.sum(values < max(DOUBLE, SHARP, NOISE * reduced.noise)))


def _deflated(reduced: Reduced, radii: tuple[float, ...]) -> Branch | None:
    """The multiple branch at a point: where not only the reduced constraints but their derivatives vanish."""
    k = reduced.k
    x, y = np.zeros((1, k)), np.zeros((1, reduced.rank))
    for _ in range(8):
        Gs, DGs, y = _with_derivatives(reduced, x, y)
        G, DG = Gs[0], DGs[0]
        U, values, Vt = np.linalg.svd(DG)
        rank = int(np.sum(values > SECOND * max(values[0], SECOND)))
        dx = -Vt[:rank].T @ ((U[:, :rank].T @ G) / values[:rank])
        if not np.linalg.norm(x + dx) < radii[0]:
            return None
        if np.linalg.norm(dx) < 1e-11:
            break
        x = x + dx
    if np.max(np.abs(G)) > 1e-9 or rank in (0, k):
        return None
    T, N = Vt[rank:].T, Vt[:rank].T
    c = reduced.U0.shape[1]
    if rank > 1 and _meets_others(N.T @ DG[c:].reshape(c, k, k) @ N):
        return None  # where greater branches meet, the derivatives vanish, too
    if not any(_flat_along(reduced, x, y, T, N, radius) for radius in radii):
        return None
    found = reduced.at(x)
    slope = reduced.equations(found.x, found.y)[4][0]
    tangent = np.asarray(np.linalg.qr((reduced.V0 + reduced.V1 @ slope) @ T)[0])
    return Branch(k - rank, k, reduced.q(found.x, found.y)[0], tangent, tangent, 2)


def _meets_others(H: Array) -> bool:
    """Whether quadratic forms (c, e, e) have a zero in common: other branches pass through that of x = 0."""
    n = spread(H.shape[1])
    for _ in range(15):
        forms = np.einsum("ni,cij,nj->nc", n, H, n)
        slopes = 2.0 * np.einsum("cij,nj->nci", H, n)
        slopes -= (slopes @ n[..., None]) * n[:, None, :]
        n = n - (np.linalg.pinv(slopes, rcond=1e-6) @ forms[..., None])[..., 0].clip(-0.5, 0.5)
        n /= np.linalg.norm(n, axis=1)[:, None]
    forms = np.linalg.norm(np.einsum("ni,cij,nj->nc", n, H, n), axis=1)
    return bool(np.min(forms) < SECOND * np.max(np.linalg.norm(H, axis=(1, 2))))


def _with_derivatives(reduced: Reduced, x: Array, y: Array) -> tuple[Array, Array, Array]:
    """g and Dg at points x (N, k) in one vector each (N, c + c k), its derivative (…, k) by differences, and y (N, r)
    there; y: where the steps begin."""
    h = 1e-5
    N, k = x.shape
    middle = reduced.at(x, y)
    slope = reduced.equations(middle.x, middle.y)[4]
    offsets = np.concatenate([h * np.eye(k), -h * np.eye(k)])
    # Along the slope y is right to h²: one step is enough.
    beside = middle.y[:, None] + offsets @ slope.swapaxes(1, 2)
    around = reduced.at((x[:, None] + offsets).reshape(-1, k), beside.reshape(-1, y.shape[1]))
    G, sides = (
        np.concatenate([np.where(f.solved[:, None], f.g, 1e3), f.Dg.reshape(len(f.x), -1)], axis=1)
        for f in (middle, around)
    )
    sides = sides.reshape(N, 2, k, -1)
    return G, ((sides[:, 0] - sides[:, 1]) / (2.0 * h)).transpose(0, 2, 1), middle.y


def _flat_along(reduced: Reduced, x: Array, y: Array, T: Array, N: Array, radius: float) -> bool:
    """Whether the multiple branch goes on all about x (1, k), y (1, r) along T, at a radius."""
    at = x + radius * directions(T.shape[1]) @ T.T
    y = np.repeat(y, len(at), axis=0)
    c = reduced.U0.shape[1]
    for _ in range(8):
        G, DG, y = _with_derivatives(reduced, at, y)
        step = -(np.linalg.pinv(DG @ N, rcond=1e-6) @ G[..., None])[..., 0]
        if np.max(np.abs(step)) < 1e-10 or not np.max(np.abs(step)) < 1.0:
            break
        at = at + step @ N.T
    return bool(np.max(np.abs(G[:, :c])) < 1e-12 and np.max(np.abs(G[:, c:])) < 1e-8)
