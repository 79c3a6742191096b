"""The member that stands for a self-motion of a spherical wrist.

Statement. Where axes 1 and 3 of three that meet in a point lie on one line, the two trade motion: a curve of
solutions. One of them is listed: the middle joint exactly where the axes are aligned, the first held at a chosen
value, the third with the rest.
Derivation. The cosine of the angle between axes 1 and 3 is p · Rz(q) s, p the third row of P and s the third column
of Q (see `turns`): A cos(q - φ) + p_z s_z. With tilts μ and ν it is at most cos(μ - ν) and at least cos(μ + ν): the
axes are aligned at q = φ only if μ = ν, opposed at q = φ + π only if μ + ν = π.
What the solver finds there is off by rounding, or by half of the digits where another joint has a double root. So
the other joints are brought back by least squares with the first and the middle one held, which has a slope where
the six together have none; a pose that is only near a singular one does not close then, and is left as it is.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from robokin.inverse.analysis import Analysis
from robokin.inverse.numeric import descend
from robokin.inverse.spherical import SphericalTriple
from robokin.inverse.verify import CLOSES, Found
from robokin.kinematics.chain import Chain

Array = NDArray[np.float64]
TURN = 2.0 * math.pi

ALIGNED = 1e-12
"""Tilts whose cosines agree to this are equal: those of tables in degrees do to rounding."""

NEAR = 1e-6
"""A middle joint this near [rad] to where the axes are aligned may be there but for rounding; double roots are
good to 1e-8."""


def with_families_held(analysis: Analysis, T: Array, found: Found, held: Array, limits: Array) -> Found:
    """Configurations of the window (s, n) with those of a wrist's self-motion replaced by one that stands for it.

    T: (m, 4, 4) the targets; held: (n,) values for the wrist's first joint; limits: (n, 2), which the first
    and the last joint of the wrist keep to if they can. The copies of one family become equal.
    """
    if not isinstance(analysis.solver, SphericalTriple) or analysis.redundancy or analysis.six is None:
        return found
    if analysis.six.virtual or not len(found):
        return found
    chain = analysis.six.chain
    first = analysis.solver.first
    for value, sign in aligned(chain, first):
        off = half_turn(found.q[:, first + 1] - value)
        near = np.flatnonzero(np.abs(off) < NEAR)
        if not len(near):
            continue
        q = found.q[near].copy()
        q[:, first + 2] += sign * (q[:, first] - held[first])
        q[:, first] = held[first]
        q[:, first + 1] = value
        bounds = np.tile([-np.inf, np.inf], (chain.n, 1))
        bounds[first], bounds[first + 1] = held[first], value
        q, error = descend(chain, T[found.index[near]], q, analysis.size, limits=bounds, steps=6)
        position = np.linalg.norm(error[:, :3], axis=1) * analysis.size
        angle = np.linalg.norm(error[:, 3:], axis=1)
        closes = (position <= CLOSES * analysis.size) & (angle <= CLOSES)
        near, q = near[closes], within(q[closes], first, sign, limits)
        everywhere = found.q.copy(), found.position.copy(), found.angle.copy()
        for whole, part in zip(everywhere, (q, position[closes], angle[closes]), strict=True):
            whole[near] = part
        found = Found(found.index, *everywhere)
    return found


def half_turn(angle: Array) -> Array:
    """Angles in [-π, π]."""
    return angle - TURN * np.round(angle / TURN)


def aligned(chain: Chain, first: int) -> list[tuple[float, int]]:
    """Values of joint first + 1 at which the axes of its neighbours lie on one line, and 1, or -1 if opposed."""
    P, Q = chain.constants[first + 1], chain.constants[first + 2]
    p, s = P[2, :3], Q[:3, 2]
    phi = math.atan2(p[1] * s[0] - p[0] * s[1], p[0] * s[0] + p[1] * s[1]) - float(chain.offsets[first + 1])
    values = []
    if abs(p[2] - s[2]) < ALIGNED:
        values.append((phi, 1))
    if abs(p[2] + s[2]) < ALIGNED:
        values.append((phi + math.pi, -1))
    return values


def within(q: Array, first: int, sign: int, limits: Array) -> Array:
    """Configurations moved along the family as little as brings the wrist's last joint into its limits (2,)."""
    last = first + 2
    low, high = limits[last]
    value = half_turn(q[:, last])
    if np.isinf(low) or np.isinf(high):
        return q
    fits = np.floor((high - value) / TURN) >= np.ceil((low - value) / TURN)
    ends = half_turn(np.stack([low - value, high - value]))
    shift = np.where(fits, 0.0, ends[np.argmin(np.abs(ends), axis=0), np.arange(len(q))])
    q = q.copy()
    q[:, last] += shift
    q[:, first] -= sign * shift
    return q
