"""Loops of special kinds, and whether candidates close them: a product of matrices and Newton steps, nothing clever."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import robokin
from robokin.inverse.elimination.loop import Loop, loop_of
from robokin.kernel.chain import chain_of
from robokin.spatial import invert, rotation_from_axis_angle, transform

RIGHT = np.pi / 2


def named(name):
    return loop_of(chain_of(robokin.load(name)))


def joint(turns, q):
    J = np.zeros((*q.shape, 4, 4))
    J[...] = np.eye(4)
    if turns:
        c, s = np.cos(q), np.sin(q)
        J[..., 0, 0], J[..., 0, 1], J[..., 1, 0], J[..., 1, 1] = c, -s, s, c
    else:
        J[..., 2, 3] = q
    return J


def frames(loop, q):
    """The frames (s, 4, 4) before each joint, and J1 L1 … J6."""
    T = np.broadcast_to(np.eye(4), (len(q), 4, 4))
    before = []
    for i in range(6):
        before.append(T)
        T = T @ joint(loop.revolute[i], q[:, i])
        if i < 5:
            T = T @ loop.links[i]
    return before, T


def closing_of(loop, q):
    return invert(frames(loop, q)[1])


def error(loop, q, closing):
    E = frames(loop, q)[1] @ closing
    R = E[:, :3, :3]
    w = 0.5 * np.stack([R[:, 2, 1] - R[:, 1, 2], R[:, 0, 2] - R[:, 2, 0], R[:, 1, 0] - R[:, 0, 1]], axis=1)
    w = w + (np.trace(R, axis1=1, axis2=2) < 1.0)[:, None]  # more than a right angle off: not closed at all
    return np.concatenate([E[:, :3, 3], w], axis=1)


def twists(loop, q):
    columns = []
    for turns, T in zip(loop.revolute, frames(loop, q)[0], strict=True):
        z, o = T[:, :3, 2], T[:, :3, 3]
        columns.append(np.concatenate([np.cross(o, z), z] if turns else [z, 0.0 * z], axis=1))
    return np.stack(columns, axis=2)


def newton(loop, q, closing, steps):
    for _ in range(steps):
        e, S = error(loop, q, closing), twists(loop, q)
        St = np.swapaxes(S, 1, 2)
        damping = (1e-3 * np.sum(e * e, axis=1) + 1e-15)[:, None, None] * np.eye(6)
        q = q - np.linalg.solve(St @ S + damping, St @ e[..., None])[..., 0]
    return q


def determinants(loop, q):
    return np.linalg.det(twists(loop, q))


def values_of(loop, rng, count):
    spans = np.where(loop.revolute, np.pi, 0.7)
    return rng.uniform(-spans, spans, (count, 6))


def right_angles(loop, rng, count):
    """Every angle a multiple of 90°, every length one of five."""
    return np.where(loop.revolute, rng.integers(-1, 3, (count, 6)) * RIGHT, rng.integers(-2, 3, (count, 6)) * 0.15)


def singular_values_of(loop, rng, count, vary):
    """Singular joint values, by bisection of the determinant in one joint."""
    q = values_of(loop, rng, 4 * count)
    low, high = q.copy(), q.copy()
    low[:, vary], high[:, vary] = q[:, vary] - 0.7, q[:, vary] + 0.7
    sign = np.sign(determinants(loop, low))
    crosses = sign * np.sign(determinants(loop, high)) < 0.0
    low, high, sign = low[crosses][:count], high[crosses][:count], sign[crosses][:count]
    for _ in range(60):
        middle = (low + high) / 2.0
        same = (np.sign(determinants(loop, middle)) == sign)[:, None]
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return low


def gaps(loop, a, b):
    gap = np.abs(a - b)
    return np.where(loop.revolute, np.abs(gap - 2 * np.pi * np.round(gap / (2 * np.pi))), gap)


@dataclass
class Outcome:
    """Of each target: the number of candidates that close, and the least gap to the joints that made it."""

    closing: np.ndarray
    gap: np.ndarray
    open: int
    """Candidates that do not close."""
    values: np.ndarray
    index: np.ndarray

    @property
    def solved(self):
        return float(np.mean(self.closing > 0))

    @property
    def found(self):
        return float(np.mean(self.gap < 1e-4))


def outcome(solver, loop, q, steps=2, joints=slice(None)):
    """What a solver finds for the poses of q: (m, 6), after some Newton steps; gaps are those of the given joints."""
    closing = closing_of(loop, q)
    candidates = solver.candidates(closing)
    index = candidates.index
    values = np.ascontiguousarray(candidates.values)
    assert values.shape == (len(index), 6)
    assert np.isfinite(values).all()
    values = newton(loop, values, closing[index], steps)
    closed = np.linalg.norm(error(loop, values, closing[index]), axis=1) < 1e-9
    gap = np.full(len(q), np.inf)
    np.minimum.at(gap, index[closed], np.max(gaps(loop, values, q[index])[closed][:, joints], axis=1))
    return Outcome(
        np.bincount(index[closed], minlength=len(q)), gap, int(np.sum(~closed)), values[closed], index[closed]
    )


def random_rotation(rng, special):
    if special:
        turn = [rng.choice([0.0, 0.0, RIGHT, -RIGHT, 0.25 * np.pi]) for _ in range(2)]
        twist = rng.choice([0.0, RIGHT, -RIGHT, np.pi])
        x, z = [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]
        return (
            rotation_from_axis_angle(z, turn[0])
            @ rotation_from_axis_angle(x, twist)
            @ rotation_from_axis_angle(z, turn[1])
        )
    return rotation_from_axis_angle(rng.normal(size=3), rng.uniform(0.3, 2.8))


def random_links(rng, special):
    """Five links; of special ones half of the lengths are 0 and the twists are right angles."""
    kept = rng.random((5, 3)) < (0.5 if special else 1.0)
    rotations = np.stack([random_rotation(rng, special) for _ in range(5)])
    return transform(rotations, rng.uniform(-0.3, 0.3, (5, 3)) * kept)


def regular(loop, rng):
    """Whether the arm is not singular everywhere."""
    S = twists(loop, values_of(loop, rng, 4))
    return np.max(np.linalg.svd(S, compute_uv=False)[:, -1]) > 1e-6


def with_types(first, types, links):
    """A loop whose joints first, first + 1, first + 2 turn and whose others, cyclically, are of the given types."""
    revolute = np.ones(6, dtype=bool)
    for i, letter in enumerate(types):
        revolute[(first + 3 + i) % 6] = letter == "R"
    return Loop(revolute, links, np.eye(4), np.eye(4), 1.0)


def spherical_loop(rng, first, types, special):
    """Axes first, first + 1, first + 2 meet in a point; not singular everywhere."""
    while True:
        links = random_links(rng, special)
        heights = rng.uniform(-0.3, 0.3, 3)
        for i in range(2):
            R = links[first + i, :3, :3]
            links[first + i, :3, 3] = [0.0, 0.0, heights[i]] - R[:, 2] * heights[i + 1]
        loop = with_types(first, types, links)
        if np.all(np.abs(links[first : first + 2, 2, 2]) < 0.95) and regular(loop, rng):
            return loop


def parallel_loop(rng, first, types, special):
    """Axes first, first + 1, first + 2 are parallel or opposite; not singular everywhere."""
    while True:
        links = random_links(rng, special)
        for i in range(2):
            turn = rng.choice([0.0, RIGHT]) if special else rng.uniform(-3.0, 3.0)
            flip = np.diag([1.0, *rng.choice([1.0, -1.0]) * np.ones(2)])
            links[first + i, :3, :3] = rotation_from_axis_angle([0.0, 0.0, 1.0], turn) @ flip
        loop = with_types(first, types, links)
        if regular(loop, rng):
            return loop
