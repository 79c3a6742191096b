"""Solutions of a pose by an independent way: Newton's method from many random initial guesses.

Statement. For a robot and a pose T the configurations q with T(q) = T that many guesses lead to.
Derivation. Levenberg and Marquardt's method on the error (p_T - p, log(R_T R')), lengths in the arm's size, with the
damping proportional to the squared error, so that the last steps are Newton's; then steps from the singular value
decomposition of the Jacobian, which keep all digits next to singular poses. It uses forward kinematics and the
Jacobian only, nothing of what solves inverse kinematics.
Degenerate case. On a self-motion the guesses end at members of it, as many as there are guesses. A search proves
nothing: a solution that it misses is not missed by it alone.
Reference. N. Yamashita, M. Fukushima, On the rate of convergence of the Levenberg-Marquardt method, 2001.
"""

from __future__ import annotations

import numpy as np

import robokin
from robokin.spatial import axis_angle_from_rotation

TURN = 2.0 * np.pi

ACCEPTED = 1e-10
"""A guess that ends with a greater error [size | rad] has found nothing: rounding gives 1e-15, and next to a regular
configuration with so small an error there is a solution."""

EXACT = 1e-14
"""The same for a singular configuration, next to which there may be none: rounding of the pose and little more."""

REGULAR = 1e-4
"""Least singular value of the Jacobian, lengths in the arm's size, from which a solution is regular: rounding of the
pose, 1e-16, moves it by less than 1e-12."""

APART = 1e-5
"""Configurations that are nearer [rad | size] in every joint are one: half of the digits are lost where two meet."""

LONGEST = 0.7
"""The greatest change of a joint in a step [rad | size]: from farther the linear model says nothing."""


class Scale:
    """The lengths of an arm, whatever frames its table has.

    size: the greatest distance of the tool from the middle of where it gets to [m], 1 if it stays in place;
    unit: (n,) 1 for a turning joint and the size for a sliding one; low, high: (n,) where values are drawn from:
    the limits, else a turn, else what a slide of the arm's size allows.
    """

    def __init__(self, robot):
        rng = np.random.default_rng(1)
        links = robokin.link_frames(robot, np.zeros(robot.n))[:, :3, 3]
        length = float(np.sum(np.linalg.norm(np.diff(links, axis=0), axis=1))) or 1.0
        span = np.where(robot.revolute, np.pi, min(length, 1e3))
        limits = np.clip(robot.limits, -1e3, 1e3)
        self.low = np.where(np.isfinite(robot.limits[:, 0]), limits[:, 0], -span)
        self.high = np.where(np.isfinite(robot.limits[:, 1]), limits[:, 1], np.maximum(span, self.low))
        places = robokin.forward_kinematics(robot, rng.uniform(self.low, self.high, (400, robot.n)))[:, :3, 3]
        size = float(np.max(np.linalg.norm(places - np.mean(places, axis=0), axis=1)))
        self.size = size if size > 1e-9 else 1.0
        self.unit = np.where(robot.revolute, 1.0, self.size)


def jacobian(robot, scale, q):
    """(..., 6, n) the Jacobian with lengths in the arm's size."""
    J = robokin.jacobian(robot, q) * scale.unit
    J[..., :3, :] /= scale.size
    return J


def least_singular_value(robot, scale, q):
    """(...) of the n columns of the Jacobian at q: (..., n)."""
    return np.linalg.svd(jacobian(robot, scale, q), compute_uv=False)[..., -1]


def errors(robot, scale, q, T):
    """(s, 6) how T: (s, 4, 4) differs from the poses at q: (s, n) [size, rad], in the axes of the world."""
    F = robokin.forward_kinematics(robot, q)
    return np.concatenate([(T[:, :3, 3] - F[:, :3, 3]) / scale.size, rotation_vectors(T, F)], axis=1)


def rotation_vectors(T, F):
    """(s, 3) the rotations from F to T: (s, 4, 4) [rad], with all digits of the smallest ones."""
    R = T[:, :3, :3] @ np.swapaxes(F[:, :3, :3], 1, 2)
    sine = 0.5 * np.stack([R[:, 2, 1] - R[:, 1, 2], R[:, 0, 2] - R[:, 2, 0], R[:, 1, 0] - R[:, 0, 1]], axis=1)
    length, cosine = np.linalg.norm(sine, axis=1), (np.trace(R, axis1=1, axis2=2) - 1.0) / 2.0
    angle = np.arctan2(length, cosine)
    out = sine * np.where(length > 0.0, angle / np.where(length > 0.0, length, 1.0), 1.0)[:, None]
    wide = cosine < -0.9  # near half a turn the sine has lost the axis
    axis, turned = axis_angle_from_rotation(R[wide])
    out[wide] = axis * turned[:, None]
    return out


def gaps(robot, a, b):
    """|a - b| [rad | m] of joint values, whole turns aside."""
    gap = np.abs(a - b)
    return np.where(robot.revolute, np.abs(gap - TURN * np.round(gap / TURN)), gap)


def search(robot, scale, T, rng, guesses=300, steps=60):
    """Configurations (s, n) that reach T: (4, 4), each once, and their least singular values (s,)."""
    q = rng.uniform(np.where(robot.revolute, -np.pi, scale.low), np.where(robot.revolute, np.pi, scale.high),
                    (guesses, robot.n))  # fmt: skip
    done = []
    for _ in range(steps):
        e = errors(robot, scale, q, np.broadcast_to(T, (len(q), 4, 4)))
        squared = np.sum(e * e, axis=1)
        ready = squared < 1e-14
        done.append(q[ready])
        q, e, squared = q[~ready], e[~ready], squared[~ready]
        if not len(q):
            break
        J = jacobian(robot, scale, q)
        Jt = np.swapaxes(J, 1, 2)
        damping = (0.1 * squared + 1e-14)[:, None, None] * np.eye(robot.n)
        step = np.linalg.solve(Jt @ J + damping, Jt @ e[..., None])[..., 0]
        step *= np.minimum(1.0, LONGEST / np.maximum(np.max(np.abs(step), axis=1), 1e-300))[:, None]
        q = q + step * scale.unit
    return _once(robot, scale, *polished(robot, scale, np.concatenate(done), T))


def polished(robot, scale, q, T, steps=8):
    """Those of q: (s, n) that reach T: (4, 4) after some Newton steps, and their least singular values."""
    best, error = q, np.full(len(q), np.inf)
    for k in range(steps + 1):
        e = errors(robot, scale, q, np.broadcast_to(T, (len(q), 4, 4)))
        size = np.max(np.abs(e), axis=1, initial=0.0)
        best, error = np.where((size < error)[:, None], q, best), np.minimum(size, error)
        if k == steps or not len(q):
            break
        U, s, Vt = np.linalg.svd(jacobian(robot, scale, q), full_matrices=False)
        # A direction without a slope is left alone: it is the one along a self-motion.
        along = np.einsum("sij,si->sj", U, e) * np.where(s > 1e-9, 1.0 / np.maximum(s, 1e-9), 0.0)
        step = np.einsum("sji,sj->si", Vt, along)
        step *= np.minimum(1.0, 0.1 / np.maximum(np.max(np.abs(step), axis=1), 1e-300))[:, None]
        q = q + step * scale.unit
    best, error = best[error < ACCEPTED], error[error < ACCEPTED]
    if not len(best):
        return best, np.empty(0)
    least = least_singular_value(robot, scale, best)
    kept = (least >= REGULAR) | (error < EXACT)
    return best[kept], least[kept]


def _once(robot, scale, q, least):
    """Each configuration once, the regular ones first."""
    order = np.argsort(-least, kind="stable")
    kept = []
    for i in order:
        if not kept or np.min(np.max(gaps(robot, q[kept], q[i]) / scale.unit, axis=1)) > APART:
            kept.append(i)
    return q[kept], least[kept]
