"""Twists, the motions that they lead to in unit time, and the twists that lead to motions.

A twist is (v, w): the velocity of the point that is at the origin, and the angular velocity, in one frame's axes.
Source: R. M. Murray, Z. Li and S. S. Sastry, A Mathematical Introduction to Robotic Manipulation, 1994, section 2.3 and
appendix A.
"""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array
from robokin.spatial import transform

SMALL = 1e-4
"""An angle [rad] below which sin and cos quotients are taken from their series, good to 1e-17 there."""


def moved_screws(g: Array, screws: Array) -> Array:
    """Ad(g) S: twists (f, 6) carried along by displacements g (f, 4, 4)."""
    R, t = g[:, :3, :3], g[:, :3, 3]
    v = np.einsum("fij,fj->fi", R, screws[:, :3])
    w = np.einsum("fij,fj->fi", R, screws[:, 3:])
    return np.concatenate([v + np.cross(t, w), w], axis=1)


def exponential(twists: Array) -> Array:
    """The rigid motions (m, 4, 4) of unit time at twists (m, 6)."""
    v, w = twists[:, :3], twists[:, 3:]
    angle = np.linalg.norm(w, axis=1)[:, None]
    small = angle < SMALL
    safe = np.where(small, 1.0, angle)
    square = angle * angle
    a = np.where(small, 1.0 - square / 6.0, np.sin(safe) / safe)
    # Half angles: 1 - cos would lose half of its digits where the angle is small.
    b = np.where(small, 0.5 - square / 24.0, 2.0 * (np.sin(0.5 * safe) / safe) ** 2)
    c = np.where(small, 1.0 / 6.0 - square / 120.0, (safe - np.sin(safe)) / safe**3)
    W = skew(w)
    WW = W @ W
    R = np.eye(3) + a[:, :, None] * W + b[:, :, None] * WW
    V = np.eye(3) + b[:, :, None] * W + c[:, :, None] * WW
    return transform(R, np.einsum("mij,mj->mi", V, v))


def logarithm(T: Array) -> Array:
    """The twists (m, 6) of unit time that lead to rigid motions T (m, 4, 4), turned by less than 180°."""
    R, t = T[:, :3, :3], T[:, :3, 3]
    w = 0.5 * np.stack([R[:, 2, 1] - R[:, 1, 2], R[:, 0, 2] - R[:, 2, 0], R[:, 1, 0] - R[:, 0, 1]], axis=1)
    sine = np.linalg.norm(w, axis=1)[:, None]
    cosine = 0.5 * (np.trace(R, axis1=1, axis2=2)[:, None] - 1.0)
    angle = np.arctan2(sine, cosine)
    small = angle < SMALL
    w = w * np.where(small, 1.0 + angle * angle / 6.0, angle / np.where(small, 1.0, sine))
    half = 0.5 * np.where(small, 1.0, angle)
    k = np.where(
        small, 1.0 / 12.0 + angle * angle / 720.0, (1.0 - half / np.tan(half)) / np.where(small, 1.0, angle) ** 2
    )
    W = skew(w)
    V = np.eye(3) - 0.5 * W + k[:, :, None] * (W @ W)
    return np.concatenate([np.einsum("mij,mj->mi", V, t), w], axis=1)


def skew(w: Array) -> Array:
    """The matrices (..., 3, 3) of the cross product with vectors (..., 3)."""
    W = np.zeros((*w.shape[:-1], 3, 3))
    W[..., 0, 1], W[..., 0, 2], W[..., 1, 2] = -w[..., 2], w[..., 1], -w[..., 0]
    W[..., 1, 0], W[..., 2, 0], W[..., 2, 1] = w[..., 2], -w[..., 1], w[..., 0]
    return W
