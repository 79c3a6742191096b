"""Arms with fewer than six joints, made six-joint chains by virtual joints at the tool.

Statement. Let an arm have n < 6 joints and reach a set of poses of dimension n. Append 6 - n virtual joints
that move the tool in directions that the arm cannot, so that the six together can move it in every
direction. Every pose near an attainable one is then reached by the six-joint chain, and it is attainable by
the arm itself exactly where all virtual values are zero. So the solutions of the six-joint chain whose
virtual values vanish are all solutions of the arm, and the six-joint solvers serve for every arm.

Which virtual joints: of the six elementary motions of a frame (slides along and turns about its axes) the
subset that keeps the six-joint Jacobian best conditioned with the virtual values at zero; that a wrist of
three turns about x, y, z is regular there (Z-Y-Z would be singular) comes out by itself. Where a choice makes
a closed form of the chain (a spherical triple, three parallel axes, three prismatic joints) it is preferred.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations, permutations

import numpy as np

from robokin.arrays import Array
from robokin.kernel.chain import Chain, chain_size, with_joints
from robokin.kernel.frames import frames
from robokin.kernel.geometric_jacobian import jacobian_of
from robokin.spatial import exact, invert, translation_transform

REGULAR = 1e-3
"""Least singular value (lengths in the arm's size) at which a choice of virtual joints counts as regular."""

SAMPLES = 6
"""Configurations at which a choice is judged."""


@dataclass(frozen=True, eq=False)
class Padded:
    """A chain of six joints of which the last `virtual` are none of the arm's."""

    chain: Chain
    virtual: int


def padded_chains(chain: Chain, most: int = 40) -> Iterator[Padded]:
    """Six-joint chains for an arm of at most six joints, the best conditioned first.

    Yields nothing when the arm's own joints depend on each other everywhere (its rank is below n).
    """
    missing = 6 - chain.n
    if missing == 0:
        yield Padded(chain, 0)
        return
    size = chain_size(chain)
    q = _sample(chain)
    rated: list[tuple[float, int, tuple[int, ...]]] = []
    places = _places(chain, q[0])
    for place, G in enumerate(places):
        F = frames(chain, q)
        F[:, -1] = F[:, -1] @ G
        J = jacobian_of(F, chain.revolute, "tool", size)
        for chosen in combinations(range(6), missing):
            whole = np.concatenate([J, np.broadcast_to(np.eye(6)[:, chosen], (len(q), 6, missing))], axis=2)
            least = float(np.median(np.linalg.svd(whole, compute_uv=False)[:, -1]))
            if least > REGULAR:
                rated.append((least, place, chosen))
    rated.sort(key=lambda entry: -entry[0])
    count = 0
    for _, place, chosen in rated[:12]:
        for order in permutations(chosen):
            # Turns about one point may follow each other in any order; only where slides stand matters.
            axes, turning = [i % 3 for i in order], [i >= 3 for i in order]
            yield Padded(with_joints(chain, axes, turning, places[place]), missing)
            count += 1
            if count >= most:
                return


def _sample(chain: Chain) -> Array:
    """Generic configurations (SAMPLES, n); the seed is arbitrary."""
    size = chain_size(chain)
    q = np.random.default_rng(7).uniform(-2.0, 2.0, (SAMPLES, chain.n))
    return np.where(chain.revolute, q, 0.5 * size * q)


def _places(chain: Chain, q: Array) -> list[Array]:
    """Frames in the tool whose axes the virtual joints may have: the tool's, the last joint's, the wrist's."""
    last = invert(chain.constants[-1])
    places = [np.eye(4), exact(last)]
    if chain.n >= 2:
        # Where the last two axes meet, if they do: a third one through that point makes a spherical wrist.
        F = frames(chain, q)
        z, o = F[-3:-1, :3, 2], F[-3:-1, :3, 3]
        normal = np.cross(z[0], z[1])
        if chain.revolute[-2:].all() and normal @ normal > 1e-12:
            s = np.cross(o[0] - o[1], z[0]) @ -normal / (normal @ normal)
            places.append(exact(last @ translation_transform([0.0, 0.0, float(s)])))
    return places
