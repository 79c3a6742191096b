"""Forward kinematics of a tree: the poses of all its tips."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from robokin.arrays import Array, Index, combined
from robokin.kernel.columns import ChainProgram, Constant
from robokin.kernel.facts import fact
from robokin.kernel.frames import run
from robokin.model import Tree, expect_tree
from robokin.spatial import exact


def tip_poses(tree: Tree, q: ArrayLike) -> Array:
    """The poses of a tree's tips in the world.

    q: (..., n) the values of the joints with a variable, in the order of `tree.joints` [rad | m]; those of joints that
    follow others come from them. Returns (..., k, 4, 4) [m], in the order of `tree.tips`. Raises InputError when q
    has another length than n.
    Source: J. J. Craig, Introduction to Robotics, 3rd ed., sec. 3.8 (coupled joints); the chains are those of
    `forward_kinematics`.
    """
    tree = expect_tree(tree)
    q = tree.values_of(q)
    rows = q.reshape(math.prod(q.shape[:-1]), tree.n)
    T = np.empty((len(rows), len(tree.tips), 4, 4))
    for place, (program, variables, S) in enumerate(_tip_programs(tree)):
        own = rows[:, variables]
        T[:, place] = run(program, own if S is None else combined(own, S.T))[:, 0]
    return T.reshape(*q.shape[:-1], len(tree.tips), 4, 4)


@fact
def _tip_programs(tree: Tree) -> list[tuple[ChainProgram, Index, Array | None]]:
    """The way from the root to each tip, the variables that move it, and S of its values, None where it is I."""
    graph = tree.graph
    found = []
    for tip in graph.tips:
        chain = graph.chain(graph.links[graph.root], tip.name)
        last = len(chain.constants) - 1
        segments = [[Constant(exact(C), mark=i == last)] for i, C in enumerate(chain.constants)]
        # Where each joint has a variable of its own the values are the variables, to the last digit.
        plain = np.array_equal(chain.S, np.eye(len(chain.variables)))
        program = ChainProgram(segments, chain.turns, chain.offsets)
        found.append((program, chain.variables, None if plain else chain.S))
    return found
