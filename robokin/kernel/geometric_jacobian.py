"""The geometric Jacobian: how a chain's tool moves with its joints.

A revolute joint about z through o gives the tool's origin p the velocity z × (p - o) and the tool the angular velocity
z; a prismatic one z and none.
Source: B. Siciliano et al., Robotics: Modelling, Planning and Control, 2009, eq. (3.30).
"""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

import numpy as np

from robokin.arrays import Array, Flags
from robokin.kernel.chain import Chain
from robokin.kernel.frames import program_to_joints
from robokin.kernel.native_kernel import handle, native

BLOCK = 2048
"""Configurations at a time: their columns stay in the second-level cache."""

COLUMNS, PADDING = 1024, 8
"""The same where all entries of the Jacobians are kept until they are put in their order."""

CROSS = ((1, 2), (2, 0), (0, 1))
"""Entry k of a × b is a[i] b[j] - a[j] b[i]."""


def jacobian(chain: Chain, q: Array, frame: Literal["base", "tool"] = "base", size: float = 1.0) -> Array:
    """J (..., 6, n) at q: (..., n) [rad | m], linear before angular part, in the axes of the base or of the tool.

    size: the unit of length [m], of prismatic joints as well; the twist is that of the tool's origin.
    """
    known = handle(chain)
    if native is None or known is None:
        out = np.empty((math.prod(q.shape[:-1]), 6, chain.n))
        _fill_blocks(chain, q.reshape(len(out), chain.n), frame, size, out)
        return out.reshape(*q.shape[:-1], 6, chain.n)
    J: Array = native.jacobian(known, q, size, frame == "tool")
    return J


def fill_jacobians(chain: Chain, q: Array, frame: Literal["base", "tool"], out: Array) -> None:
    """The same for q: (m, n), into `out` (m, 6, n), an array in C's order."""
    known = handle(chain)
    if native is None or known is None:
        _fill_blocks(chain, q, frame, 1.0, out)
    else:
        native.jacobian(known, q, 1.0, frame == "tool", out)


def _fill_blocks(chain: Chain, q: Array, frame: Literal["base", "tool"], size: float, out: Array) -> None:
    """Python's way: out (m, 6, n) at q: (m, n), a block at a time."""
    program, sliding = program_to_joints(chain), np.flatnonzero(~chain.revolute)
    width = min(len(q), COLUMNS)
    # A few columns more: rows a power of two apart would share their places in the cache.
    whole = np.empty((2, 3, chain.n, width + PADDING))
    lever = np.empty((3, chain.n, width))
    for start in range(0, len(q), COLUMNS):
        part = q[start : start + COLUMNS]
        m = len(part)
        J, r = whole[..., :m], lever[..., :m]
        linear, axes = J
        *starts, tool = program.columns(part.T)
        for i, (_, _, z, o) in enumerate(starts):
            for k in range(3):
                axes[k, i] = z[k]
                np.subtract(tool[3][k], o[k], out=r[k, i])
        for k, (i, j) in enumerate(CROSS):
            np.multiply(axes[i], r[j], out=linear[k])
            linear[k] -= axes[j] * r[i]
        if size != 1.0:
            linear /= size
        if len(sliding):
            linear[:, sliding], axes[:, sliding] = axes[:, sliding], 0.0
        if frame == "tool":
            J = np.stack([v[0] * x[0] + v[1] * x[1] + v[2] * x[2] for v in J for x in tool[:3]])
        out[start : start + m].reshape(m, -1)[:] = J.reshape(-1, m).T


def jacobian_of(F: Array, revolute: Flags, frame: Literal["base", "tool"] = "base", size: float = 1.0) -> Array:
    """The same for the frames F: (..., n + 1, 4, 4) [m] that the joints start from and, last, of what is moved."""
    z, o = F[..., :-1, :3, 2], F[..., :-1, :3, 3]
    R, p = F[..., -1, :3, :3], F[..., -1, None, :3, 3]
    turns = revolute[:, None]
    linear = np.where(turns, np.cross(z, p - o) / size, z)
    angular = np.where(turns, z, 0.0)
    if frame == "tool":
        linear, angular = linear @ R, angular @ R
    return np.swapaxes(np.concatenate([linear, angular], axis=-1), -1, -2)


class Motion(NamedTuple):
    """How a tool moves, configurations last.

    linear: (n, 3, s) the velocity of its origin by each joint [size]; axes: (n, 3, s) the joints' axes z; tool:
    (4, 3, s) the columns x, y, z, p of its frame [m].
    """

    linear: Array
    axes: Array
    tool: Array


def motion(chain: Chain, q: Array, size: float = 1.0) -> Motion:
    """How the tool moves at q: (n, s) [rad | m], in the base's axes; size: the unit of length [m]."""
    n, s = q.shape
    found = Motion(np.empty((n, 3, s)), np.empty((n, 3, s)), np.empty((4, 3, s)))
    for start in range(0, s, BLOCK):
        part = slice(start, start + BLOCK)
        _fill(Motion(*(whole[..., part] for whole in found)), chain, q[:, part], size)
    return found


def _fill(block: Motion, chain: Chain, q: Array, size: float) -> None:
    """The motion of a block of configurations."""
    *starts, tool = program_to_joints(chain).columns(q)
    for column, entries in zip(block.tool, tool, strict=True):
        for row, entry in zip(column, entries, strict=True):
            row[:] = entry
    lever = np.empty_like(block.axes)
    for i, (_, _, z, o) in enumerate(starts):
        for k in range(3):
            block.axes[i, k] = z[k]
            np.subtract(block.tool[3, k], o[k], out=lever[i, k])
    if size != 1.0:
        lever /= size
    crossed(block.axes, lever, block.linear)
    sliding = ~chain.revolute
    block.linear[sliding] = block.axes[sliding]


def crossed(u: Array, v: Array, out: Array | None = None) -> Array:
    """u × v of vectors (..., 3, s), into `out` where it is given."""
    w = np.empty(np.broadcast_shapes(u.shape, v.shape)) if out is None else out
    for k, (i, j) in enumerate(CROSS):
        np.multiply(u[..., i, :], v[..., j, :], out=w[..., k, :])
        w[..., k, :] -= u[..., j, :] * v[..., i, :]
    return w
