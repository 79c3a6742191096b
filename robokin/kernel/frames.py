"""Frames along a chain, for one configuration or for any number of them.

The chain's constants are compiled once to programs for columns of joint values; they are kept on the chain.
"""

from __future__ import annotations

import math

import numpy as np

from robokin.arrays import Array
from robokin.kernel.chain import Chain
from robokin.kernel.columns import BLOCK, ChainProgram, Constant
from robokin.kernel.facts import fact
from robokin.kernel.native_kernel import handle, native


@fact
def program_to_tool(chain: Chain) -> ChainProgram:
    """The way to the tool's frame alone."""
    segments = [[Constant(C, mark=i == chain.n)] for i, C in enumerate(chain.constants)]
    return ChainProgram(segments, chain.revolute, chain.offsets)


@fact
def program_to_joints(chain: Chain) -> ChainProgram:
    """The way to the frame that each joint starts from, and to the tool's."""
    return ChainProgram([[Constant(C, mark=True)] for C in chain.constants], chain.revolute, chain.offsets)


def frames(chain: Chain, q: Array) -> Array:
    """The frame that each joint starts from, its axis along z, and the tool's last.

    q: (..., n) [rad | m]. Returns (..., n + 1, 4, 4) [m].
    """
    known = handle(chain)
    return run(program_to_joints(chain), q) if native is None or known is None else native.frames(known, q)


def pose(chain: Chain, q: Array) -> Array:
    """The tool's frame (..., 4, 4) [m] at q: (..., n) [rad | m]."""
    known = handle(chain)
    return run(program_to_tool(chain), q)[..., 0, :, :] if native is None or known is None else native.pose(known, q)


def fill_poses(chain: Chain, q: Array, out: Array) -> None:
    """The same for q: (m, n), into `out` (m, 4, 4), an array in C's order."""
    known = handle(chain)
    if native is None or known is None:
        out[:] = pose(chain, q)
    else:
        native.pose(known, q, out)


def run(program: ChainProgram, q: Array) -> Array:
    """The frames (..., k, 4, 4) [m] that a program leads to at q: (..., n) [rad | m], a block at a time."""
    rows = q.reshape(math.prod(q.shape[:-1]), program.n)
    out = np.empty((len(rows), program.marks, 4, 4))
    for start in range(0, len(rows), BLOCK):
        program.frames(rows[start : start + BLOCK], out[start : start + BLOCK])
    return out.reshape(*q.shape[:-1], program.marks, 4, 4)


def joint_motion(turns: bool, q: Array) -> Array:
    """J (..., 4, 4) at q: (...) [rad | m], real or complex: a turn about z, or a slide along it."""
    J = np.zeros((*q.shape, 4, 4), dtype=q.dtype)
    J[..., (0, 1, 2, 3), (0, 1, 2, 3)] = 1.0
    if turns:
        c, s = np.cos(q), np.sin(q)
        J[..., 0, 0], J[..., 0, 1], J[..., 1, 0], J[..., 1, 1] = c, -s, s, c
    else:
        J[..., 2, 3] = q
    return J
