"""The fourteen functions of a pose on which every joint acts linearly, of first degree in its cosine and sine.

Let l be the z axis of a frame and p its origin. Turning the frame about l changes neither l nor p. The functions

    l, p, l × p, (p·p) l - 2 (l·p) p, p·p, l·p                                     (M. Raghavan and B. Roth, 1993)

are not only of first degree in the cosine and sine of each joint that moves the frame: a rigid motion X = (R, t)
acts on them, with 1 in front, by a matrix A(X),

    l' = R l,  p' = R p + t,  m' = R m + R l × t  for m = l × p,
    w' = R w + 2 t × R m + (t·t) R l - 2 (R l·t) t - 2 (l·p) t  for w = (p·p) l - 2 (l·p) p,
    (p·p)' = p·p + 2 t·R p + t·t,  (l·p)' = l·p + t·R l.

So A(XY) = A(X) A(Y), and all equations of the elimination are products of such matrices. For a frame that slides
along its z axis the same holds of the fourteen functions that do not see it slide,

    x, y, z, z × p, x·p, y·p.

In both cases l or x, y, z and the moments are vectors, the last two functions numbers; a joint turns or slides
them, and all that elimination needs to know of it are the functions that it leaves alone.
"""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array

COUNT = 15
"""1 and the fourteen functions."""

X_PARTS = np.array([1, 4, 7, 10])
"""Where the x parts of the four vectors stand; y and z parts follow."""


def start(free_turns: bool) -> Array:
    """The functions (15,) of the identity, for a frame that is free to turn about z, or to slide along it."""
    functions = np.zeros(COUNT)
    functions[0] = 1.0
    functions[[3] if free_turns else [1, 5, 9]] = 1.0
    return functions


def of_frames(X: Array, free_turns: bool) -> Array:
    """The functions (..., 15) of frames X: (..., 4, 4)."""
    x, y, z, p = (X[..., :3, j] for j in range(4))
    one = np.ones(X.shape[:-2])[..., None]
    if free_turns:
        pp, lp = _dot(p, p), _dot(z, p)
        return np.concatenate([one, z, p, np.cross(z, p), pp * z - 2.0 * lp * p, pp, lp], axis=-1)
    return np.concatenate([one, x, y, z, np.cross(z, p), _dot(x, p), _dot(y, p)], axis=-1)


def action(X: Array, free_turns: bool) -> Array:
    """A(X): (..., 15, 15) for rigid motions X: (..., 4, 4)."""
    R, t = X[..., :3, :3], X[..., :3, 3]
    A = np.zeros((*X.shape[:-2], COUNT, COUNT))
    A[..., 0, 0] = 1.0
    for i in X_PARTS:
        A[..., i : i + 3, i : i + 3] = R
    for i in (13, 14):
        A[..., i, i] = 1.0
    tR = (t[..., None, :] @ R)[..., 0, :]
    cross = np.zeros((*t.shape, 3))  # t ×
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        cross[..., j, i] = t[..., k]
        cross[..., i, j] = -t[..., k]
    tR_cross = cross @ R
    if free_turns:
        tt = _dot(t, t)
        A[..., 4:7, 0] = t
        A[..., 7:10, 1:4] = -tR_cross
        A[..., 10:13, 7:10] = 2.0 * tR_cross
        A[..., 10:13, 1:4] = tt[..., None] * R - 2.0 * t[..., :, None] * tR[..., None, :]
        A[..., 10:13, 14] = -2.0 * t
        A[..., 13, 4:7] = 2.0 * tR
        A[..., 13, 0] = tt[..., 0]
        A[..., 14, 1:4] = tR
    else:
        A[..., 10:13, 7:10] = -tR_cross
        A[..., 13, 1:4] = tR
        A[..., 14, 4:7] = tR
    return A


def joint_action(turns: bool, free_turns: bool, backwards: bool = False) -> Array:
    """The matrices (3, 15, 15) of A(J) on 1, cos, sin of a joint that turns, or on 1, d, d² of one that slides.

    They are read off three values of the joint, exactly, since these determine a polynomial of that degree.
    backwards: of J⁻¹.
    """
    sign = -1.0 if backwards else 1.0
    J = np.tile(np.eye(4), (3, 1, 1))
    if turns:
        c, s = np.array([1.0, -1.0, 0.0]), np.array([0.0, 0.0, sign])
        J[:, 0, 0], J[:, 0, 1], J[:, 1, 0], J[:, 1, 1] = c, -s, s, c
        A0, A180, A90 = action(J, free_turns)
        constant = 0.5 * (A0 + A180)
        return np.stack([constant, 0.5 * (A0 - A180), A90 - constant])
    J[:, 2, 3] = [0.0, sign, -sign]
    A0, forth, back = action(J, free_turns)
    return np.stack([A0, 0.5 * (forth - back), 0.5 * (forth + back) - A0])


def invariants(turns: bool, free_turns: bool) -> list[int]:
    """Which functions a joint leaves alone."""
    z_parts = [3, 6, 9, 12]
    if turns:
        return [*z_parts, 13, 14]
    return [1, 2, 3, 4, 5, 9] if free_turns else [*range(1, 10), 12]


def moved(turns: bool, free_turns: bool, g: Array, f: Array) -> Array:
    """By how much (s,) a joint moves the functions g (s, 15) to f (s, 15)."""
    if turns:
        gx, gy, fx, fy = g[:, X_PARTS], g[:, X_PARTS + 1], f[:, X_PARTS], f[:, X_PARTS + 1]
        if np.iscomplexobj(f):
            # f_x ± i f_y is g_x ± i g_y times e^(±iq).
            plus, minus = gx + 1j * gy, gx - 1j * gy
            a, b = np.sum(np.square(np.abs(plus)), axis=1), np.sum(np.square(np.abs(minus)), axis=1)
            forth, back = np.sum(plus.conj() * (fx + 1j * fy), axis=1), np.sum(minus.conj() * (fx - 1j * fy), axis=1)
            known = np.where(np.abs(forth) * b >= np.abs(back) * a, forth / a, back / b)
            return np.asarray(np.where(np.abs(forth) * b >= np.abs(back) * a, -1j, 1j) * np.log(known))
        return np.asarray(np.arctan2(np.sum(gx * fy - gy * fx, axis=1), np.sum(gx * fx + gy * fy, axis=1)))
    if free_turns:
        return np.asarray(f[:, 6] - g[:, 6])  # p
    # z × p, x·p and y·p grow by (z_y, -z_x), x_z and y_z.
    growth = np.stack([g[:, 8], -g[:, 7], g[:, 3], g[:, 6]], axis=1)
    moved = np.sum(growth * (f - g)[:, [10, 11, 13, 14]], axis=1)
    return np.asarray(moved / np.maximum(np.sum(growth * growth, axis=1), 1e-300))


def angle_of(c: Array, s: Array, scale: Array | float) -> Array:
    """The angle (s,) of a cosine and a sine times a scale, which is positive where they are real.

    A complex angle q is read from the greater of e^(±iq) = cos q ± i sin q: in the other one they cancel.
    """
    if np.iscomplexobj(c):
        plus, minus = (c + 1j * s) / scale, (c - 1j * s) / scale
        greater = np.abs(plus) >= np.abs(minus)
        return np.asarray(np.where(greater, -1j, 1j) * np.log(np.where(greater, plus, minus)))
    return np.asarray(np.arctan2(s, c))


def _dot(a: Array, b: Array) -> Array:
    """a·b (..., 1) of vectors (..., 3)."""
    return np.asarray(np.sum(a * b, axis=-1, keepdims=True))
