"""Arms of fewer than six joints as general arms of six: the missing joints turn about skew axes.

Statement. Let an arm have n < 6 joints. Append 6 - n joints that turn about axes in general position. Solutions of the
six in which the added joints stand still are the solutions of the arm.
Why skew. Added joints along or about the axes of the tool's frame (`padding`) make closed forms, but at round poses
they come to lie like a joint of the arm's own; the loop is singular there though the arm is not, and solutions are
lost. Axes in general position do that at no pose that anybody types. The elimination of the loop counts its complex
solutions, so that it also vouches for there being no other.
"""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.elimination.loop import Loop, loop_of
from robokin.inverse.elimination.native_elimination import candidates_at
from robokin.inverse.elimination.padding import Padded
from robokin.inverse.elimination.splits import ORDER, choose_splits, count_solutions, elimination_of, generic_count
from robokin.kernel.chain import Chain, chain_size
from robokin.spatial import invert, rotation_from_rpy, transform

AWAY = 0.3
"""How far the added axes are from the tool and from each other [size]."""


class Skew:
    """A window's chain with added joints, its loop, an elimination of it, and its number N of complex solutions."""

    def __init__(self, chain: Chain, seed: int) -> None:
        self.six = skewed(chain, seed)
        self.loop: Loop = loop_of(self.six.chain)
        # Where all joints turn any split serves; a joint that slides asks for a choice.
        splits = list(ORDER[:1]) if chain.revolute.all() else choose_splits(self.loop) or list(ORDER[:1])
        self.number = generic_count(self.loop, splits)
        self.solver = elimination_of(self.loop, splits[0])

    def solutions(self, T: Array) -> tuple[Index, Array, Flags]:
        """Real solutions of the loop for targets T (m, 4, 4): the target of each (s,), values (s, 6) [rad | m], and
        for which targets (m,) as many complex ones were found as there are."""
        closing = self.loop.closing(T)
        real, imaginary = candidates_at(self.solver, self.loop, closing)
        parts = [(real.index, real.values), (imaginary.index, imaginary.values)]
        counted = count_solutions(self.loop, closing, parts, 3)
        scale = np.where(self.six.chain.revolute, 1.0, self.loop.size)
        return real.index, real.values * scale - self.six.chain.offsets, counted.number == self.number


def skewed(chain: Chain, seed: int) -> Padded:
    """The chain with turns about random axes after its last joint; the tool is where it was when they stand still."""
    missing = 6 - chain.n
    size = chain_size(chain)
    rng = np.random.default_rng(seed)
    places = [
        transform(rotation_from_rpy(rng.uniform(-2.0, 2.0, 3)), AWAY * size * rng.uniform(-1.0, 1.0, 3))
        for _ in range(missing)
    ]
    constants = [*chain.constants[:-1]]
    before = chain.constants[-1]
    for place in places:
        constants.append(before @ place)
        before = invert(place)
    constants.append(before)
    return Padded(
        Chain(
            np.stack(constants),
            np.concatenate([chain.revolute, np.ones(missing, dtype=bool)]),
            np.concatenate([chain.offsets, np.zeros(missing)]),
        ),
        missing,
    )
