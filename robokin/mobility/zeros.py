"""Zeros of reduced constraints: sought on a sphere about the pose, and followed to the pose.

Every branch of configurations of dimension 1 or more meets every small sphere |x| = r. From many directions Newton's
steps go to g = 0 on a sphere as large as can be solved, damped ones (Levenberg and Marquardt) and undamped ones: those
go to the branch that is near, these jump, and find the thin. There a constraint of high order that only comes near to
zero is told from a zero, since |g| must fall to 1e-10 of what it is elsewhere on the sphere.

Then the sphere is halved again and again, until the constraints are so small that rounding is seen. A zero that is
lost, or whose direction jumps, was not on a branch that passes through the pose.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robokin.arrays import Array, Flags
from robokin.mobility.reduced import Reduced

WIDEST, NARROWEST = 0.4, 2e-3
"""Greatest and least radius [rad | size] of the spheres."""

FIRST_STEPS, STEPS = 12, 35
"""Steps from all directions, and from those that come near to a zero: a double zero takes half the way in each, some
thirty to 1e-8 of it."""

SLOW, LONGER = 1e-4, 6
"""Points whose constraints, as parts of those elsewhere, are less may still come to a multiple zero that is narrow in
one direction and wide in another: as often as this they get more steps, if the last have led on."""

UNDAMPED = 1e-10
"""Derivatives below this, or this part of the greatest, lead nowhere: rounding would be made a step of 1e-6."""

COMING = 1e-2
"""Constraints, as parts of those elsewhere on the sphere, that the first steps leave where they come near to a zero."""

FOLLOWED = 40
"""Zeros that are followed to the pose, those that are farthest apart."""

ASIDE = 0.2
"""Points nearer than this [radius] to directions that are known are of those, which bend up to here."""

DIFFERENT = 1e-5
"""Points that differ by more [radius] are different: a double zero is known to 1e-7."""

CLEAR = 1e-10
"""A zero's constraints, as a part of those elsewhere on its sphere, are less; order 16 at `WIDEST` leaves 1e-6."""

SEEN = 1e-9
"""Constraints [size, rad] elsewhere on a sphere are greater, or a zero cannot be told by them there."""

TURN = 0.5
"""Cosine of the greatest turn of a branch's direction as its sphere is halved."""


def spread(k: int, turn: int = 0) -> Array:
    """Directions (N, k): all round a circle, evenly over a sphere, and drawn once and for all beyond; others, drawn
    too, for every further turn."""
    if turn:
        d = np.random.default_rng((20, turn)).normal(size=(40 * min(k, 16), k))
        return np.asarray(d / np.linalg.norm(d, axis=1)[:, None])
    if k == 2:
        angles = 0.013 + 2.0 * np.pi * np.arange(64) / 64.0
        return np.stack([np.cos(angles), np.sin(angles)], axis=1)
    if k == 3:
        i = np.arange(120) + 0.5
        z, angle = 1.0 - 2.0 * i / 120.0, np.pi * (1.0 + 5.0**0.5) * i
        ring = np.sqrt(1.0 - z * z)
        return np.stack([ring * np.cos(angle), ring * np.sin(angle), z], axis=1)
    d = np.random.default_rng(20).normal(size=(20 * min(k, 16), k))
    d = np.concatenate([d, np.eye(k) + 0.01, -np.eye(k) + 0.01])
    return np.asarray(d / np.linalg.norm(d, axis=1)[:, None])


def sought(reduced: Reduced, radius: float, turn: int = 0, known: Sequence[Array] = ()) -> tuple[Array, Array]:
    """Zeros on the sphere, those that are different: x (N, k), y (N, r); from other directions for another turn.

    known: bases (k, d) of directions that are not of interest.
    """
    begun = reduced.at(radius * spread(reduced.k, turn))
    keep = begun.solved
    if not np.any(keep):
        return begun.x[:0], begun.y[:0]
    scale = float(np.median(np.max(np.abs(begun.g[keep]), axis=1)))
    x, y = (np.concatenate([part[keep], part[keep]]) for part in (begun.x, begun.y))
    damped = np.arange(len(x)) < len(x) // 2
    x, y, size = zeros_on_sphere(reduced, x, y, radius, damped, FIRST_STEPS)
    (near,) = np.nonzero(size < COMING * scale)
    for plane in known:
        near = near[np.linalg.norm(x[near] - x[near] @ plane @ plane.T, axis=1) > ASIDE * radius]
    if not len(near):
        return x[near], y[near]
    near = near[apart(x[near], 1e-2 * radius, FOLLOWED)]
    x, y, size = zeros_on_sphere(reduced, x[near], y[near], radius, damped[near], STEPS)
    bound = max(CLEAR * scale, 10.0 * float(reduced.tolerance(radius)))
    going = np.nonzero((size > bound) & (size < SLOW * scale))[0]
    for _ in range(LONGER):
        if not len(going):
            break
        after = zeros_on_sphere(reduced, x[going], y[going], radius, damped[near][going], FIRST_STEPS)
        better = after[2] < 0.3 * size[going]
        x[going], y[going], size[going] = after
        going = going[better & (after[2] > bound)]
    (zero,) = np.nonzero(size < bound)
    zero = zero[apart(x[zero], DIFFERENT * radius, FOLLOWED)]
    return x[zero], y[zero]


def zeros_on_sphere(
    reduced: Reduced, x: Array, y: Array, radius: float, damped: Flags, steps: int
) -> tuple[Array, Array, Array]:
    """Zeros x, y on |x| = radius near by, and what g and the regular equations leave there (N,).

    damped: (N,) which steps are. Not `damped_newton.brought_down`: each step solves the regular equations beside, and
    a zero counts where the steps end, not where the constraints were least, which is at a smaller radius.
    """
    x, y = x.copy(), y.copy()
    size = np.full(len(x), np.inf)
    active = np.arange(len(x))
    for step in range(steps + 1):
        if not len(active):
            break
        lacking, g, Dg, dy, slope = reduced.equations(x[active], y[active])
        off = (np.sum(x[active] ** 2, axis=1) - radius**2) / (2.0 * radius)
        size[active] = np.maximum(np.max(np.abs(np.concatenate([lacking, off[:, None]], axis=1)), axis=1),
                                  np.max(np.abs(g), axis=1))  # fmt: skip
        if step == steps:
            break
        dx = _toward_zero(x[active], g, Dg, off, damped[active])
        length = np.linalg.norm(dx, axis=1)
        dx *= np.minimum(1.0, 0.3 * radius / np.maximum(length, 1e-300))[:, None]
        dy = dy + (slope @ dx[..., None])[..., 0]
        x[active] += dx
        y[active] += dy * np.minimum(1.0, 0.5 / np.maximum(np.max(np.abs(dy), axis=1, initial=0.0), 1e-300))[:, None]
        done = (size[active] < 5e-15) | ((length < 1e-14) & (size[active] < 1e-13))
        gone = ~np.isfinite(x[active]).all(axis=1) | (np.max(np.abs(y[active]), axis=1, initial=0.0) > 3.0)
        size[active[gone]] = np.inf
        active = active[~done & ~gone]
    return x, y, np.where(np.isfinite(size), size, np.inf)


def _toward_zero(x: Array, g: Array, Dg: Array, off: Array, damped: Flags) -> Array:
    """Steps (N, k) along the sphere toward g = 0, and back on the sphere, which is off by (N,).

    damped: (N,) whether by Levenberg and Marquardt: with a damping as g is, so that small constraints do not lead
    before the great ones are met, and at last none. Those go to the branch that is near; undamped ones jump, and find
    the thin.
    """
    out = x / np.linalg.norm(x, axis=1)[:, None]
    back = -off[:, None] * out
    g = g + (Dg @ back[..., None])[..., 0]
    along = Dg - (Dg @ out[..., None]) * out[:, None, :]
    U, values, Vt = np.linalg.svd(along, full_matrices=False)
    squares = np.sum(g * g, axis=1) / np.sum(x * x, axis=1)
    damping = np.where(damped, squares, 0.0)[:, None]
    leads = values > UNDAMPED * np.maximum(values[:, :1], 1.0)
    factors = np.where(leads, values / np.where(leads, values**2 + damping, 1.0), 0.0)
    step = factors * (U.transpose(0, 2, 1) @ g[..., None])[..., 0]
    return np.asarray(back - (Vt.transpose(0, 2, 1) @ step[..., None])[..., 0])


def followed(reduced: Reduced, x: Array, y: Array, radius: float) -> tuple[Array, Array, Array, Array] | None:
    """The zeros that can be followed to the pose: x (N, k) on the sphere given, q (N, n) at half its radius, and x (N,
    k) and y (N, r) on the least sphere."""
    some = spread(reduced.k)[:: max(1, len(spread(reduced.k)) // 12)]
    wide, half = x, None
    narrowest = max(NARROWEST, 5.0 * reduced.noise**0.25)  # there order 5 still outweighs the noise
    while True:
        smaller = 0.5 * radius
        elsewhere = reduced.at(smaller * some)
        sizes = np.max(np.abs(elsewhere.g[elsewhere.solved]), axis=1, initial=0.0)
        scale = float(np.median(sizes)) if len(sizes) else 0.0
        if half is not None and (scale < SEEN or smaller < narrowest):
            near = np.max(np.abs(y), axis=1, initial=0.0) < 5.0 * radius  # not on another sheet of configurations
            return (wide[near], half[near], x[near], y[near]) if np.any(near) else None
        if scale == 0.0:
            return None
        x_, y_, size = zeros_on_sphere(reduced, 0.5 * x, 0.25 * y, smaller, np.zeros(len(x), dtype=bool), 20)
        straight = np.sum(x_ * x, axis=1) > TURN * smaller * radius
        keep = straight & (size < max(1e-6 * scale, 10.0 * float(reduced.tolerance(smaller))))
        if not np.any(keep):
            return None
        x, y, wide, radius = x_[keep], y_[keep], wide[keep], smaller
        half = reduced.q(x, y) if half is None else half[keep]


def apart(x: Array, distance: float, most: int) -> list[int]:
    """Numbers of points x (N, k), no two nearer than a distance, each as far from those before as can be."""
    if not len(x):
        return []
    picked = [0]
    away = np.linalg.norm(x - x[0], axis=1)
    while len(picked) < most and np.max(away) > distance:
        picked.append(int(np.argmax(away)))
        away = np.minimum(away, np.linalg.norm(x - x[picked[-1]], axis=1))
    return picked
