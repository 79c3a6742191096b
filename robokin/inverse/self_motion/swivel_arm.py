"""Arms of seven turning joints whose redundancy is one angle: a spherical shoulder, an elbow, a spherical wrist.

Statement. Recognise an arm whose first three axes meet in a point S, the shoulder, and whose last three meet in a point
W, the wrist. Say what about it is the same for all poses.
Derivation. S is fixed in the base and in the upper arm (link 3), W in the forearm (link 4) and in the hand. So the
distance from S to W depends on q4 alone, and at one pose q4 has two values, the elbows. With either the upper arm,
elbow and forearm are one body that may turn about the line from S to W: the swivel angle ψ. What is left is two triples
of turns, R = Rz(a) K Rz(b) L Rz(c), the shoulder's with R the upper arm in the base and the wrist's with R the hand in
the forearm. Their middle turn follows from zᵀ R z = k + r cos(b - φ).
Degenerate case. Neighbours in a triple that are parallel (r = 0), or a distance that q4 does not change, make no such
arm.
Reference: M. Shimizu, H. Kakuya, W.-K. Yoon, K. Kitagaki, K. Kosuge, Analytical inverse kinematic computation for 7-DOF
redundant manipulators with joint limits and global configuration control, IEEE Trans. Robotics 24(5), 2008;
C. Faria, F. Ferreira, W. Erlhagen, S. Monteiro, E. Bicho, Position-based kinematics for 7-DoF serial manipulators with
global configuration control, joint limit and singularity avoidance, Mech. Mach. Theory 121, 2018.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from robokin.arrays import Array
from robokin.kernel.chain import Chain, chain_size
from robokin.kernel.facts import fact

MEET = 1e-12
"""Distance [size] up to which two axes meet: the rounding of what a description says."""

OBLIQUE = 0.02
"""Sine of the least angle of two neighbours in a triple."""


@dataclass(frozen=True, eq=False)
class Triples:
    """The two triples of turns Rz(a) K Rz(b) L Rz(c), each number with the shoulder's first.

    K, L: (2, 3, 3); k, r, phi: (2,) zᵀ R z = k + r cos(b - phi) [rad]; u: (2, 3, 2) of x and y of K Rz(b) L z the
    factors of 1, cos b and sin b; v: (2, 3, 2) the same of Lᵀ Rz(-b) Kᵀ z; cos_phi, sin_phi: (2,).
    """

    K: Array
    L: Array
    k: Array
    r: Array
    phi: Array
    u: Array
    v: Array

    @cached_property
    def cos_phi(self) -> Array:
        """The cosines of phi."""
        return np.cos(self.phi)

    @cached_property
    def sin_phi(self) -> Array:
        """The sines of phi."""
        return np.sin(self.phi)


@dataclass(frozen=True, eq=False)
class SwivelArm:
    """An arm with a spherical shoulder and a spherical wrist.

    shoulder: (3,) S in the frame after C0, which the base's z axis is axis 1 of; upper: (3,) S in the frame after
    joint 3; lower: (3,) W in the frame after joint 4; wrist: (3,) W in the tool [m]; elbow: (3,) the point of axis 4
    next to S, from there, in the frame after joint 3 [m]; hand: (3, 3) the frame after joint 7 in the tool.
    """

    chain: Chain
    size: float
    shoulder: Array
    upper: Array
    lower: Array
    wrist: Array
    elbow: Array
    hand: Array
    triples: Triples


@fact
def swivel_arm(chain: Chain) -> SwivelArm | None:
    """The arm with its points and triples; None for a chain that is none."""
    if chain.n != 7 or not chain.revolute.all():
        return None
    C, size = chain.constants, chain_size(chain)
    first, last = _meeting(C[1], C[2], size), _meeting(C[5], C[6], size)
    if first is None or last is None:
        return None
    shoulder, upper = (np.array([0.0, 0.0, z]) for z in first)
    forearm, hand = (np.array([0.0, 0.0, z]) for z in last)
    lower = C[4][:3, :3] @ forearm + C[4][:3, 3]
    seen = C[3][:3, :3].T @ (upper - C[3][:3, 3])
    if np.hypot(*seen[:2]) * np.hypot(*lower[:2]) <= OBLIQUE**2 * size**2:
        return None
    elbow = C[3][:3, 3] + C[3][:3, 2] * seen[2] - upper
    R = C[7][:3, :3].T
    wrist = R @ (hand - C[7][:3, 3])
    triples = _triples(C[[1, 5], :3, :3], C[[2, 6], :3, :3])
    return SwivelArm(chain, size, shoulder, upper, lower, wrist, elbow, R, triples)


def _meeting(C: Array, D: Array, size: float) -> tuple[float, float] | None:
    """Where three axes with C and D (4, 4) between them meet: z [m] on the first and on the last; None if nowhere."""
    one, two = _crossing(C), _crossing(D)
    if one is None or two is None:
        return None
    off = max(one[2], two[2], abs(one[1] - two[0]))
    return (one[0], two[1]) if off <= MEET * size else None


def _crossing(C: Array) -> tuple[float, float, float] | None:
    """z [m] on each of two axes with C (4, 4) between them where they are nearest, and their distance there."""
    axis, place = C[:3, 2], C[:3, 3]
    square = float(axis[0] ** 2 + axis[1] ** 2)
    if square < OBLIQUE**2:
        return None
    there = -float(axis[:2] @ place[:2]) / square
    point = place + there * axis
    return float(point[2]), there, float(np.hypot(point[0], point[1]))


def _triples(K: Array, L: Array) -> Triples:
    """The triples of turns with constants K, L (2, 3, 3) between them."""
    row, column = K[:, 2], L[:, :, 2]
    k = row[:, 2] * column[:, 2]
    cosine = row[:, 0] * column[:, 0] + row[:, 1] * column[:, 1]
    sine = row[:, 1] * column[:, 0] - row[:, 0] * column[:, 1]
    u = _turned(K[:, :2], column)
    v = _turned(np.swapaxes(L, 1, 2)[:, :2], row)
    v[:, 2] *= -1.0  # Rz(-b)
    return Triples(K, L, k, np.hypot(cosine, sine), np.arctan2(sine, cosine), u, v)


def _turned(A: Array, x: Array) -> Array:
    """The factors (2, 3, 2) of 1, cos b and sin b in both entries of A Rz(b) x for A (2, 2, 3) and x (2, 3)."""
    ahead, across = np.stack([x[:, 0], x[:, 1]], axis=1), np.stack([-x[:, 1], x[:, 0]], axis=1)
    still = A[:, :, 2] * x[:, None, 2]
    turning = (np.einsum("tij,tj->it", A[:, :, :2], part) for part in (ahead, across))
    return np.stack([still.T, *turning], axis=1)
