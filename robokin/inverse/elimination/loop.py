"""A six-joint chain and its target as one closed loop.

T = C0 J1 C1 J2 C2 … J6 C6 says the same as

    J1 L1 J2 L2 J3 L3 J4 L4 J5 L5 J6 L6 = I,    L1 … L5 = C1 … C5,    L6 = C6 T⁻¹ C0,

where each J turns about z or slides along z. A loop has no beginning: what is derived for joints at one
place holds for joints at every other, cyclically, so that "wrist at the hand" and "wrist at the base" are
one case. Only L6 depends on the target.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robokin.arrays import Array, Complex, Flags, Index
from robokin.kernel.chain import Chain, chain_size
from robokin.kernel.facts import fact
from robokin.kernel.native_kernel import native
from robokin.kernel.sweep import skew_part, sweep, twists
from robokin.spatial import invert


@dataclass(frozen=True, eq=False)
class Loop:
    """Six joints and the constant links between them; lengths are in units of `size`.

    revolute: (6,) bool; links: (5, 4, 4) L1 … L5; first, last: (4, 4) C0 and C6; size: the arm's size [m],
    so that all lengths inside are of order one.
    """

    revolute: Flags
    links: Array
    first: Array
    last: Array
    size: float

    def closing(self, T: Array) -> Array:
        """L6 (m, 4, 4) for targets T: (m, 4, 4) [m]."""
        target = T.copy()
        target[:, :3, 3] /= self.size
        return self.last @ invert(target) @ self.first


@dataclass(frozen=True, eq=False)
class Candidates:
    """What a solver finds for a block of targets, before it is verified.

    index: (s,) the target in the block that each candidate is for; values: (s, 6) the arguments of
    J1 … J6 [rad | size], joint offsets included. Of a closed form: leaves, how many roots its equations have in all,
    real or not; near, loose: (m,) the targets where an axis is nearly free, or an equation says nothing; few: (m,)
    those at which the equations leave finitely many solutions, but for the self-motions of straight wrists, each on a
    branch of its own. None where that is not told.
    """

    index: Index
    values: Array
    leaves: int | None = None
    near: Flags | None = None
    loose: Flags | None = None
    few: Flags | None = None


@dataclass(frozen=True, eq=False)
class ComplexCandidates:
    """The same for complex solutions: values (s, 6) complex; of each conjugate pair one."""

    index: Index
    values: Complex


def loop_of(chain: Chain, size: float | None = None) -> Loop:
    """The loop of a chain of six joints, whose size may be known [m]."""
    size = chain_size(chain) if size is None else size
    constants = chain.constants.copy()
    constants[:, :3, 3] /= size
    return Loop(chain.revolute, constants[1:6], constants[0], constants[6], size)


@fact
def native_loop(loop: Loop) -> object | None:
    """What the native kernel knows a loop by; None where there is none."""
    if native is None:
        return None
    constants = np.concatenate([np.eye(4)[None], loop.links, np.eye(4)[None]])
    made: object = native.chain(constants, loop.revolute.astype(np.float64), np.zeros(6))
    return made


def columns_of(closing: NDArray[Any]) -> NDArray[Any]:
    """Columns x, y, z, p of L6 (4, 3, m) of closing (m, 4, 4), for `follow`."""
    return np.ascontiguousarray(closing[:, :3].transpose(2, 1, 0))


def follow(loop: Loop, last: NDArray[Any], q: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    """The joints' axes z and o (2, joint, 3, s), X's error v [size], w (6, s) and 3 less its trace (s,).

    X = J1 L1 … J6 L6; w is the vector of its rotation's skew part. last: (4, 3, s) from `columns_of`; q: (6, s), real
    or complex.
    """
    axes, X = sweep(loop.links, loop.revolute, q)
    error = np.empty((6, q.shape[1]), dtype=q.dtype)
    p = X[3]
    X = last[:, 0, None] * X[0] + last[:, 1, None] * X[1] + last[:, 2, None] * X[2]
    np.add(X[3], p, out=error[:3])
    skew_part(X, error[3:])
    error[3:] *= 0.5
    return axes, error, 3.0 - (X[0, 0] + X[1, 1] + X[2, 2])


def twist_columns(loop: Loop, axes: NDArray[Any]) -> NDArray[Any]:
    """S (s, 6, 6): the joints' twists as columns, for their axes from `follow`."""
    return np.ascontiguousarray(twists(axes, loop.revolute).transpose(2, 1, 0))
