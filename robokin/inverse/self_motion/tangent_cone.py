"""Near one configuration: which joint motions keep the pose, to first, to second order and indeed.

Statement. At a configuration x that reaches a pose, find the directions of the curves of configurations through x
that reach it too.
Derivation. With the twists S_j (linear, angular) of the joints in the axes of the base, taken at the tool, the pose
along x + v t + ½ a t² moves by J v in the first order and by J a + P(v), P(v) = Σ_{i<j} [S_i, S_j] v_i v_j, in the
second, as joint i moves all joints after it: ∂S_j/∂q_i = [S_i, S_j] for i < j, and

    [(v, w), (v', w')] = (w × v' + v × w', w × w').

So v is a direction only if J v = 0 and U P(v) = 0 for all rows u of U with u J = 0: a cone in the null space. One null
vector is left at nearly every point of a curve. Where two curves cross there are two, and the cone is two lines;
where a wrist and an elbow are both singular along a curve the cone is one line counted twice; where it is the whole
of the null space the solutions form a surface. Whether a curve follows a direction is then tried: a step along it,
brought back by Newton steps in the plane through the step's end at right angles to it, must close.
Degenerate case. A fold (two solutions that merge) has a null vector, and U P(v) is not zero. Contacts of higher order
look like curves to second order; the step along them does not close.
Reference: A. Müller, "Higher-order analysis of kinematic singularities of lower pair linkages and serial manipulators",
J. Mechanisms and Robotics 10(1), 2018, for the tangent cone.

Here x are joint values [rad | size] and lengths are in the arm's size.
"""

from __future__ import annotations

import math

import numpy as np

from robokin.arrays import Array, Flags
from robokin.inverse.numeric.nearest import few_joints
from robokin.inverse.self_motion.pose_correction import CLOSES, SLOW_STEPS, corrected, least_squares
from robokin.inverse.self_motion.straight_motions import coaxial_pairs
from robokin.kernel.chain import Chain
from robokin.kernel.ranks import ROOT_RANK

PROBES = (0.05, 0.01)
"""Lengths of the steps [rad | size] that try whether a curve follows a direction. After 0.01 the second order of a
mere fold still leaves an error of 1e-5; it is for curves that bend at once."""

PROBE_CORRECTION = 0.5
"""A step that is corrected by more, as a part of itself, has not followed its direction."""

IDENTICAL = 1e-6
"""P(v) [size and rad per rad²] below this on the whole null space is zero: ten times what a configuration does to it
that is off by 1e-7."""

CONE = 0.05
"""P(v), as a part of its greatest value on the null space, below which a minimum of it is worth a trial."""

COSINES, SINES = np.cos(np.arange(360) * (np.pi / 180)), np.sin(np.arange(360) * (np.pi / 180))
"""Of twice the angles at which the forms are sampled, which are half a degree apart."""

CIRCLE_STEPS = 60
"""Newton's steps from there at most. Where a zero counts twice each takes away a third of the distance."""

DRAWN = 48
"""Random null vectors from which zeros of P(v) are sought where the null space has three dimensions or more."""


def brackets(J: Array) -> Array:
    """(..., n, n, 6) the twists [S_i, S_j] for i < j, zero elsewhere, of the columns of J (..., 6, n)."""
    v_i, w_i = J[..., :3, :, None], J[..., 3:, :, None]
    v_j, w_j = J[..., :3, None, :], J[..., 3:, None, :]
    n = J.shape[-1]
    whole = np.empty((*J.shape[:-2], n, n, 6))
    for k, (a, b) in enumerate(((1, 2), (2, 0), (0, 1))):
        wa_i, wb_i, wa_j, wb_j = w_i[..., a, :, :], w_i[..., b, :, :], w_j[..., a, :, :], w_j[..., b, :, :]
        linear = wa_i * v_j[..., b, :, :] - wb_i * v_j[..., a, :, :]
        linear += v_i[..., a, :, :] * wb_j - v_i[..., b, :, :] * wa_j
        whole[..., k], whole[..., 3 + k] = linear, wa_i * wb_j - wb_i * wa_j
    whole *= np.triu(np.ones((n, n)), 1)[:, :, None]
    return whole


def second_order(J: Array, null: Array, left: Array) -> Array:
    """(m, d, d) the forms v ↦ u P(v) on the null space, for its basis (d, n) and left null vectors (m, 6)."""
    P = np.einsum("ai,bj,ijk->kab", null, null, brackets(J))
    P = np.einsum("mk,kab->mab", left, P)
    return np.asarray(0.5 * (P + np.swapaxes(P, 1, 2)))


def null_spaces(J: Array) -> tuple[Array, Array]:
    """A basis of the null space (d, n) of one Jacobian (6, n) and of its left null space (m, 6)."""
    U, values, Vt = np.linalg.svd(J)
    rank = int(np.sum(values > ROOT_RANK))
    return np.asarray(Vt[rank:]), np.asarray(U[:, rank:].T)


def cone(J: Array) -> tuple[Array, bool]:
    """Directions (k, n) of length 1 that curves may have, to second order, and whether all of the null space does."""
    return cones(J[None])[0]


def cones(J: Array) -> list[tuple[Array, bool]]:
    """`cone` of each of some Jacobians (s, 6, n)."""
    U, values, Vt = np.linalg.svd(J)
    rank = np.sum(values > ROOT_RANK, axis=1).tolist()
    null, left = [v[r:] for v, r in zip(Vt, rank, strict=True)], [u[:, r:].T for u, r in zip(U, rank, strict=True)]
    Q = [second_order(*parts) if len(parts[1]) > 1 else None for parts in zip(J, null, left, strict=True)]
    great = [i for i, forms in enumerate(Q) if forms is not None and forms.size and np.max(np.abs(forms)) > IDENTICAL]
    weights: dict[int, Array] = {}
    for shape in {Q[i].shape for i in great}:  # type: ignore[union-attr]
        some = [i for i in great if Q[i].shape == shape]  # type: ignore[union-attr]
        forms = np.array([Q[i] for i in some])
        found = [_zeros_on_circle(one) for one in forms] if shape[1] == 2 else _zeros_on_spheres(forms)
        weights |= dict(zip(some, found, strict=True))
    out: list[tuple[Array, bool]] = []
    for i, basis in enumerate(null):
        if len(basis) <= 1:
            out.append((basis, True))
        elif i not in weights:
            ways = few_joints(basis)
            out.append((ways / np.linalg.norm(ways, axis=1, keepdims=True), True))
        else:
            ways = weights[i] @ basis
            # Two joints with one axis are known exactly, also where their direction counts twice.
            exact = coaxial_pairs(J[i])
            new = np.all(np.abs(ways @ exact.T) < 0.999, axis=1)
            out.append((np.concatenate([exact, ways[new]]), False))
    return out


def _norms(Q: Array, v: Array) -> Array:
    """(k,) the length of the forms' values at v (k, d)."""
    return np.asarray(np.linalg.norm(np.einsum("mab,ka,kb->km", Q, v, v), axis=1))


def _zeros_on_circle(Q: Array) -> Array:
    """(k, 2) unit vectors at which the forms (m, 2, 2) are least and nearly zero, one of each pair ±v.

    At an angle θ a form is a + b cos 2θ + c sin 2θ. The sum of their squares is sampled, and Newton's steps lead to
    where its slope vanishes.
    """
    a, b = 0.5 * (Q[:, 0, 0] + Q[:, 1, 1]), 0.5 * (Q[:, 0, 0] - Q[:, 1, 1])
    c = 0.5 * (Q[:, 0, 1] + Q[:, 1, 0])
    step = np.pi / 360
    value = np.linalg.norm(a[:, None] + b[:, None] * COSINES + c[:, None] * SINES, axis=0)
    lower = (value <= np.roll(value, 1)) & (value < np.roll(value, -1))
    found = []
    forms = np.stack([a, b, c], axis=1).tolist()
    for i in np.flatnonzero(lower & (value <= CONE * np.max(value))).tolist():
        low, high = 2.0 * step * (i - 1), 2.0 * step * (i + 1)
        double = 2.0 * step * i
        for _ in range(CIRCLE_STEPS):
            cosine, sine = math.cos(double), math.sin(double)
            slope = bend = 0.0
            for x, y, z in forms:
                f, rate = x + y * cosine + z * sine, z * cosine - y * sine
                slope += f * rate
                bend += rate * rate + f * (x - f)
            low, high = (low, double) if slope > 0.0 else (double, high)
            ahead = double - slope / bend if bend > 0.0 else low
            ahead = ahead if low < ahead < high else 0.5 * (low + high)
            if abs(ahead - double) < 1e-14:
                break
            double = ahead
        found.append([math.cos(0.5 * double), math.sin(0.5 * double)])
    return np.array(found).reshape(-1, 2)


def _zeros_on_spheres(Q: Array) -> list[Array]:
    """Of each of c sets of forms (c, m, d, d) unit vectors (k, d) at which they are zero, for d of three or more.

    There are infinitely many: some are found.
    """
    c, d = len(Q), Q.shape[2]
    drawn = np.concatenate([np.eye(d), np.random.default_rng(7).normal(size=(DRAWN, d))])
    drawn /= np.linalg.norm(drawn, axis=1, keepdims=True)
    v, of = np.tile(drawn, (c, 1)), np.repeat(np.arange(c), len(drawn))
    rows = np.arange(len(v))
    for _ in range(30):
        x = v[rows]
        slope = np.einsum("kmab,kb->kma", Q[of[rows]], x)
        value = np.einsum("kma,ka->km", slope, x)
        # At right angles to v: along it the forms only shrink.
        A = np.concatenate([2.0 * slope, x[:, None]], axis=1)
        dx = least_squares(A, np.concatenate([value, np.zeros((len(x), 1))], axis=1))
        x = x - dx
        v[rows] = x / np.linalg.norm(x, axis=1, keepdims=True)
        rows = rows[np.max(np.abs(dx), axis=1) > 1e-15]
        if not len(rows):
            break
    found = []
    for forms, some in zip(Q, v.reshape(c, -1, d), strict=True):
        kept: list[Array] = []
        for row in some[_norms(forms, some) <= IDENTICAL + 1e-3 * float(np.max(np.abs(forms)))]:
            if all(abs(float(row @ other)) < 0.999 for other in kept):
                kept.append(row)
        found.append(np.array(kept).reshape(-1, d))
    return found


def follows(chain: Chain, T: Array, x: Array, ways: Array, size: float) -> Flags:
    """(s,) whether a step from x (s, n) along ways (s, n) or against them stays with T (s, 4, 4)."""
    out = np.zeros(len(x), dtype=bool)
    for length in PROBES:
        rows = np.flatnonzero(~out)
        if not len(rows):
            break
        signed = np.concatenate([ways[rows], -ways[rows]])
        start = np.tile(x[rows], (2, 1)) + length * signed
        end, off, _ = corrected(chain, np.tile(T[rows], (2, 1, 1)), start, size, signed[:, None], SLOW_STEPS)
        moved = np.linalg.norm(end - start, axis=1)
        on = (off <= CLOSES) & (moved <= PROBE_CORRECTION * length)
        out[rows] = np.any(on.reshape(2, -1), axis=0)
    return out
