"""A six-joint chain and its target as one closed loop.

T = C0 J1 C1 J2 C2 … J6 C6 says the same as

    J1 L1 J2 L2 J3 L3 J4 L4 J5 L5 J6 L6 = I,    L1 … L5 = C1 … C5,    L6 = C6 T⁻¹ C0,

where each J turns about z or slides along z. A loop has no beginning: what is derived for joints at one
place holds for joints at every other, cyclically, so that "wrist at the hand" and "wrist at the base" are
one case. Only L6 depends on the target.
"""

from __future__ import annotations

from dataclasses import dataclass

from robokin.arrays import Array, Complex, Flags, Index
from robokin.kernel.chain import Chain, chain_size
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


def loop_of(chain: Chain) -> Loop:
    """The loop of a chain of six joints."""
    size = chain_size(chain)
    constants = chain.constants.copy()
    constants[:, :3, 3] /= size
    return Loop(chain.revolute, constants[1:6], constants[0], constants[6], size)
