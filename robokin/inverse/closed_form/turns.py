"""Directions and orientations by two and by three turns about z, with constant turns between.

Two turns: Rz(α) P Rz(β) s = w for unit vectors s and w. The third row p of P gives p · Rz(β) s = w_z,

    A cos(β - φ) + p_z s_z = w_z,    A = |p_xy| |s_xy|,    A (cos φ, sin φ) = (p_x s_x + p_y s_y, p_y s_x - p_x s_y),

two solutions, and then α turns (P Rz(β) s)_xy to w_xy. Solutions exist for |w_z - p_z s_z| ≤ A. An arc
cosine would lose half of the digits where the two meet. With the tilts p_z = cos μ, s_z = cos ν,

    D₋ = A + p_z s_z - w_z = (cos(μ - ν) - 1) + (1 - w_z),    D₊ = A - p_z s_z + w_z,
    cos(β - φ) = (D₊ - D₋) / 2A,    sin(β - φ) = ± √(D₊ D₋) / A,

and 1 - w_z = |w_xy|² / (1 + w_z) keeps all digits when the tilts are equal (every wrist of right angles).
Degenerate: where w_xy and (P Rz(β) s)_xy vanish α is free and set to 0; where A vanishes β is.

Three turns: R = Rz(q1) P Rz(q2) Q Rz(q3). Rz(q1) P Rz(q2) (Q z) = R z is the case above: two solutions,
which meet where the three axes lie in a plane. Then the second axis, Rz(q1) P z in the base and
Rz(-q3) Qᵀ z in the hand, gives q3 from Rᵀ Rz(q1) P z = Rz(-q3) Qᵀ z. Since q1 enters, q3 makes up for
what rounding does to q1 near q2's singular values, and at them (q1 = 0) takes the whole of the turn.
Reference: Elias and Wen, "IK-Geo: unified robot inverse kinematics using subproblem decomposition",
Mechanism and Machine Theory 209, 2025, subproblems 2 and 4, which the above restates without their
least-squares answers.
"""

from __future__ import annotations

import math

import numpy as np

from robokin.arrays import Array, Flags
from robokin.inverse.closed_form.trigonometry import (
    CLAMP,
    FREE,
    Turn,
    both,
    normalized,
    turn_between,
    turned,
)
from robokin.kernel.entries import (
    NOTHING,
    Entry,
    Matrix,
    Vector,
    angle,
    applied,
    applied_back,
    minus,
    plus,
    root,
    times,
)


def two_turns(P: Matrix, s: Vector, w: Vector) -> tuple[Turn, Turn, Flags]:
    """The turns α and β with Rz(α) P Rz(β) s = w as (cos, sin), each (2, …), and whether they are real: (1, …)."""
    p = P[2]
    a, b = lever_of(p, s)
    A = root(plus(times(a, a), times(b, b)))
    middle = times(p[2], s[2])
    square = plus(times(w[0], w[0]), times(w[1], w[1]))
    w_z = np.asarray(w[2])
    small, great = square / (1.0 + np.abs(w_z)), 1.0 + np.abs(w_z)
    up = w_z > 0.0
    near = plus(zeroed(middle + A - 1.0), np.where(up, small, great))
    far = plus(zeroed(A - middle - 1.0), np.where(up, great, small))
    real = np.asarray(np.minimum(near, far) >= -CLAMP)
    near, far = np.maximum(near, 0.0), np.maximum(far, 0.0)
    # Scaled by A: beyond the boundary, where one of the two was negative, cosine and sine need it anyway.
    c, side = normalized(far - near, 2.0 * np.sqrt(near * far))
    cos_phi, sin_phi = normalized(a, b)
    beta = (
        both(times(cos_phi, c), times(-1.0, times(sin_phi, side))),
        both(times(sin_phi, c), times(cos_phi, side)),
    )
    alpha = turn_between(applied(P[:2], turned(beta, s)), w)
    return alpha, beta, real[None]


def three_turns(P: Matrix, Q: Matrix, R: Matrix) -> tuple[Array, Array, Array, Flags]:
    """q1, q2, q3, each (2, …) [rad], with R = Rz(q1) P Rz(q2) Q Rz(q3), and whether they are real: (1, …)."""
    s = [row[2] for row in Q]
    R = _alike(R)
    w = [row[2] for row in R]
    axis = [row[2] for row in P]
    if right_angled(P, Q):
        return _right_angled(P, Q, R)
    alpha, beta, real = two_turns(P, s, w)
    q3 = _third(Q, R, turned(alpha, axis))
    return np.asarray(angle(*alpha)), np.asarray(angle(*beta)), np.asarray(q3), real


def _alike(R: Matrix) -> Matrix:
    """R with as many axes of branches in all of its columns: what some of them do not depend on, others may."""
    most = max(np.ndim(entry) for row in R for entry in row)
    if all(isinstance(entry, float) or entry.ndim == most for row in R for entry in row):
        return R
    return [
        [
            entry if isinstance(entry, float) else entry.reshape((1,) * (most - entry.ndim) + entry.shape)
            for entry in row
        ]
        for row in R
    ]


def right_angled(P: Matrix, Q: Matrix) -> bool:
    """Whether the first axis is at right angles to the second, and that to the third, for every target."""
    corners = P[2][2], Q[2][2]
    return all(isinstance(corner, float) and abs(corner) < NOTHING for corner in corners)


def _right_angled(P: Matrix, Q: Matrix, R: Matrix) -> tuple[Array, Array, Array, Flags]:
    """Three turns where both solutions are q1, φ + θ, q3 and q1 + π, φ - θ, q3 + π."""
    s = [row[2] for row in Q]
    x, y, z = (row[2] for row in R)
    a, b = lever_of(P[2], s)
    phi = float(angle(a, b))
    theta = np.arctan2(np.sqrt(x * x + y * y), z)
    # The direction of (P Rz(β) s)_xy, which is sin(β - φ) times this.
    side = applied(P[:2], turned((-b, a), s))
    alpha = turn_between(side, (x, y), FREE)
    q3 = _third(Q, R, turned(alpha, [row[2] for row in P]))
    q1 = np.asarray(angle(*alpha))
    q = np.empty((3, 2, *np.broadcast_shapes(q1.shape, theta.shape, np.shape(q3))))
    q[0, 0], q[1, 0], q[2, 0] = q1, phi + theta, q3
    q[0, 1], q[1, 1], q[2, 1] = q1 + math.pi, phi - theta, q3 + math.pi
    return q[0], q[1], q[2], np.ones((1,) * (q.ndim - 1), dtype=bool)


def _third(Q: Matrix, R: Matrix, axis: Vector) -> Entry:
    """q3 from the second axis in the base."""
    x, y = applied_back([row[:2] for row in R], axis)
    k_x, k_y = Q[2][0], Q[2][1]
    # Rz(-q3) k = (x, y)
    return angle(plus(times(k_x, x), times(k_y, y)), minus(times(x, k_y), times(k_x, y)))


def lever_of(p: Vector, s: Vector) -> Turn:
    """A (cos φ, sin φ)."""
    return plus(times(p[0], s[0]), times(p[1], s[1])), minus(times(p[1], s[0]), times(p[0], s[1]))


def zeroed(value: Entry) -> Entry:
    """A constant that is 0 but for the rounding of two products."""
    return 0.0 if isinstance(value, float) and abs(value) < 2.0 * NOTHING else value
