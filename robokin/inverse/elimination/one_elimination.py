"""The elimination of one target with few operations on arrays, real and complex roots in one go.

Statement. Give all N solutions of a loop of six turning joints for one target, or nothing.
Derivation. The equations and their eigenvalues are those of `raghavan_roth` and `pencil`. Of sixteen roots the
interpreter's share is all, so that real ones are treated as complex ones: joint values, Newton's steps and the count
are one sequence of operations on all of them. A joint and the link after it, J(q) M, are linear in (1, cos q, sin q).
What is counted is as in `complex_newton`: distinct regular solutions with a small residual.
Degenerate case. Roots that lie together are not told apart, nor is anything tried again: what is found is all, or not
given.
"""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array, Complex, Flags
from robokin.inverse.elimination import pencil
from robokin.inverse.elimination.complex_newton import APART, CLOSED, FAR_OUT, OUT, REGULAR, STEP, STILL, SURE
from robokin.inverse.elimination.fourteen_functions import X_PARTS
from robokin.inverse.elimination.loop import Loop
from robokin.inverse.elimination.raghavan_roth import LARGEST, REAL, SPURIOUS, STEEPEST, Elimination
from robokin.kernel.facts import fact

STEPS = 3
"""Newton steps at most; where all candidates close to `ENOUGH` there are no more."""

ENOUGH = 1e-14

REAL_VALUE = 1e-7
"""Imaginary parts [rad] below which a refined solution is real."""

AHEAD, BEHIND = np.array([1, 2, 0]), np.array([2, 0, 1])
"""The two other entries of a vector, for each of its three, as a vector product takes them."""

TURN = 2.0 * np.pi

# J(q) = (1, cos q, sin q) of these.
_TURNING = np.zeros((3, 4, 4))
_TURNING[0, (2, 3), (2, 3)] = 1.0
_TURNING[1, (0, 1), (0, 1)] = 1.0
_TURNING[2, (0, 1), (1, 0)] = -1.0, 1.0

_Z_PARTS = X_PARTS + 2


def all_solutions(solver: Elimination, loop: Loop, closing: Array, number: int) -> tuple[int, Array] | None:
    """How many candidates are real, and the real solutions (k, 6) [rad] for L6 (1, 4, 4).

    None where not all `number` complex ones were found.
    """
    # Values that run away overflow: they are no solutions.
    with np.errstate(all="ignore"):
        tried, values = _candidates(solver, closing)
        values, residual, S, beyond = _refined(loop, closing[0], values)
        kept = _regular(values, residual, S, beyond)
        values = values[kept]
        # Of a pair that with a positive imaginary part in the first joint that has any stands for both.
        side = np.sign(np.where(np.abs(values.imag) > REAL_VALUE, values.imag, 0.0))
        side = side[np.arange(len(side)), (side != 0.0).argmax(axis=1)]
        values = np.where(side[:, None] < 0.0, values.conj(), values)
        first = _first_of_equals(values)
    real = first & (side == 0.0)
    if int(real.sum()) + 2 * int((first & (side != 0.0)).sum()) != number:
        return None
    return tried, values[real].real


def _candidates(solver: Elimination, closing: Array) -> tuple[int, Complex]:
    """How many candidates for L6 (1, 4, 4) are real, and the values (s, 6) of all, first the real ones."""
    equations = solver.equations(closing)
    roots, vectors = pencil.eigenvectors(equations.C)
    roots, vectors = roots[0], vectors[0]
    size = np.minimum(np.abs(roots), LARGEST)
    real = np.abs(roots.imag) <= solver.imaginary * (1.0 + size * size)
    # Spurious roots x = ±i stand for no angle.
    others = (roots.imag > REAL) & (np.abs(roots * roots + 1.0) > SPURIOUS)
    x, v = roots[real], vectors[:, real]
    x = np.concatenate([x.real + x.imag, roots[others]])
    v = np.concatenate([v.real + v.imag, vectors[:, others]], axis=1)
    if equations.kept is not None:
        v = equations.kept[0] @ v[: equations.kept.shape[-1]]
    q = np.empty((len(x), 6), dtype=complex)
    q[:, solver.joints] = _joint_values(solver, equations.links, equations.V[0], x, v[:12].T)
    if solver.backwards:
        q = -q
    sound = (np.abs(q) < 1e6).all(axis=1) & (np.abs(q.imag) < STEEPEST).all(axis=1)
    return int(sound[: int(real.sum())].sum()), q[sound]


def _joint_values(solver: Elimination, links: list[Array], V: Array, x: Complex, v: Complex) -> Complex:
    """The values (s, 6) of all joints in the split's order, for roots x (s,) and products v (s, 12)."""
    s = np.arange(len(x))
    q = np.empty((6, len(x)), dtype=complex)
    products = v.reshape(-1, 4, 3)
    squares = products.real**2 + products.imag**2
    y = products[s, :, squares.sum(axis=1).argmax(axis=1)].T
    w = products[s, squares.sum(axis=2).argmax(axis=1)].T
    # Ratios at the greater end: the half-angle tangents of joints 0, 1 and 2.
    pairs = np.ones((2, 3, len(x)), dtype=complex)
    pairs[0, 0] = x
    pairs[:, 1] = np.where(np.abs(y[0]) >= np.abs(y[3]), y[1::-1], y[:1:-1])
    pairs[:, 2] = np.where(np.abs(w[0]) >= np.abs(w[2]), w[1::-1], w[:0:-1])
    over, under = 1j * pairs[0], pairs[1]
    q[:3] = -1j * np.log((under + over) / (under - over))
    q[0] += solver.shift
    M = _joints_and_links(q[:3], _ahead(solver, links))
    X = links[5][0] @ M[0] @ M[1] @ M[2]
    f = np.empty((len(x), 14), dtype=complex)
    z, p = X[:, :3, 2], X[:, :3, 3]
    f[:, :3], f[:, 3:6] = z, p
    f[:, 6:9] = z[:, AHEAD] * p[:, BEHIND] - z[:, BEHIND] * p[:, AHEAD]
    pp, zp = np.einsum("si,si->s", p, p), np.einsum("si,si->s", z, p)
    f[:, 9:12] = pp[:, None] * z - (2.0 * zp)[:, None] * p
    f[:, 12], f[:, 13] = pp, zp
    # Joint 5 leaves some functions alone: in these joint 4 is found, by least squares.
    alone = V[_LEFT_ALONE]
    A = alone[:, 1:]
    cs = (f[:, _LEFT_ALONE - 1] - alone[:, 0]) @ (A @ np.linalg.inv(A.T @ A))
    q[4] = _angle(cs[:, 0], cs[:, 1])
    weights = np.empty((len(x), 3), dtype=complex)
    weights[:, 0], weights[:, 1], weights[:, 2] = 1.0, np.cos(q[4]), np.sin(q[4])
    turned = V[X_PARTS] + 1j * V[X_PARTS + 1]
    plus, minus = weights @ turned.T, weights @ turned.conj().T
    across, along = f[:, X_PARTS], f[:, X_PARTS - 1]
    forth = (plus.conj() * (along + 1j * across)).sum(axis=1)
    back = (minus.conj() * (along - 1j * across)).sum(axis=1)
    a, b = (np.abs(plus) ** 2).sum(axis=1), (np.abs(minus) ** 2).sum(axis=1)
    greater = np.abs(forth) * b >= np.abs(back) * a
    q[5] = np.where(greater, 1j, -1j) * np.log(np.where(greater, forth / a, back / b))
    # The first column of Y = J5⁻¹ M4⁻¹ J4⁻¹ M3⁻¹ is that of X turned by joint 3.
    k = links[3][0, 0, :3]
    K = np.array([[0.0, 0.0, k[2]], [k[0], k[1], 0.0], [k[1], -k[0], 0.0]]) @ links[4][0, :3, :3]
    Y = weights @ K
    c, sine = np.cos(q[5]), np.sin(q[5])
    first = np.stack([c * Y[:, 0] + sine * Y[:, 1], c * Y[:, 1] - sine * Y[:, 0], Y[:, 2]], axis=1)
    ends = np.einsum("sij,si->js", X[:, :3, :2], first)
    q[3] = _angle(ends[0], ends[1])
    return q.T


_LEFT_ALONE = np.array([*_Z_PARTS, 13, 14])


def _angle(c: Complex, s: Complex) -> Complex:
    """The angle of a cosine and a sine: from the greater of e^(±iq)."""
    plus, minus = c + 1j * s, c - 1j * s
    greater = np.abs(plus) >= np.abs(minus)
    return np.asarray(np.where(greater, -1j, 1j) * np.log(np.where(greater, plus, minus)))


def _ahead(solver: Elimination, links: list[Array]) -> Array:
    """(3, 3, 16) the entries of J(q) M for joints 0, 1 and 2 as multiples of 1, cos and sin."""
    return (_TURNING @ np.concatenate(links[:3])[:, None]).reshape(3, 3, 16)


@fact
def _around(loop: Loop) -> Array:
    """(5, 3, 16) the same of J1 L1 … J5 L5."""
    return (_TURNING @ loop.links[:, None]).reshape(5, 3, 16)


def _joints_and_links(q: Complex, parts: Array) -> Complex:
    """J(q) M (n, s, 4, 4) at q (n, s)."""
    weights = np.empty((*q.shape, 3), dtype=np.complex128)
    weights[..., 0], weights[..., 1], weights[..., 2] = 1.0, np.cos(q), np.sin(q)
    return np.asarray(weights @ parts, dtype=np.complex128).reshape(*q.shape, 4, 4)


def _refined(loop: Loop, closing: Array, values: Complex) -> tuple[Complex, Array, Complex, Array]:
    """Values (s, 6) after some Newton steps; what the loop then lacks (s,); the twists there (s, 6, 6); how far the
    next step would go (s,)."""
    parts = np.concatenate([_around(loop), (_TURNING @ closing).reshape(1, 3, 16)])
    F = np.empty((7, len(values), 4, 4), dtype=complex)
    F[0] = np.eye(4)
    error = np.empty((len(values), 6), dtype=complex)
    for step in range(STEPS + 1):
        M = _joints_and_links(values.T, parts)
        for i in range(6):
            np.matmul(F[i], M[i], out=F[i + 1])
        z, o, X = F[:6, :, :3, 2], F[:6, :, :3, 3], F[6]
        S = np.empty((6, 6, len(values)), dtype=complex)
        S[:, 3:] = z.transpose(0, 2, 1)
        S[:, :3] = (o[..., AHEAD] * z[..., BEHIND] - o[..., BEHIND] * z[..., AHEAD]).transpose(0, 2, 1)
        S = S.transpose(2, 1, 0)
        error[:, :3] = X[:, :3, 3]
        error[:, 3:] = 0.5 * (X[:, BEHIND, AHEAD] - X[:, AHEAD, BEHIND])
        lack = 3.0 - (X[:, 0, 0] + X[:, 1, 1] + X[:, 2, 2])
        size = (z.real**2 + z.imag**2).sum(axis=2).max(axis=0)
        residual = np.sqrt((error.real**2 + error.imag**2).sum(axis=1) + np.abs(lack) ** 2) / size
        try:
            dq = np.linalg.solve(S, error[..., None])[..., 0]
        except np.linalg.LinAlgError:
            return values, np.full(len(values), np.inf), S, residual
        length = np.abs(dq).max(axis=1)
        if step == STEPS or not (residual > ENOUGH).any():
            break
        values = values - dq * (STEP / np.maximum(length, STEP))[:, None]
    return values, residual, S, length


def _regular(values: Complex, residual: Array, S: Complex, beyond: Array) -> Flags:
    """(s,) which candidates are regular solutions, and not on their way to infinity."""
    needed = np.maximum(REGULAR, np.sqrt(residual / SURE))
    squared = (S.real**2 + S.imag**2).sum(axis=(1, 2))
    kept = (residual <= CLOSED) & (np.abs(np.linalg.det(S)) > needed * (squared / 5.0) ** 2.5)
    unclear = np.flatnonzero((residual <= CLOSED) & ~kept)
    if len(unclear):
        kept[unclear] = np.linalg.svd(S[unclear], compute_uv=False)[:, -1] > needed[unclear]
    away = np.abs(values.imag).max(axis=1)
    kept &= (away <= OUT) | ((residual <= STILL) & (away <= FAR_OUT)) | (beyond <= 1e-2)
    return np.asarray(kept)


def _first_of_equals(values: Complex) -> Flags:
    """(s,) which solutions (s, 6) are the first of those that are equal."""
    gap = values[:, None] - values
    gap -= TURN * np.round(gap.real / TURN)
    return np.asarray(~np.tril(np.abs(gap).max(axis=2) < APART, -1).any(axis=1))
