"""How links hang together by joints of two: a spanning forest, the loops outside it, the blocks of joints in loops.

Links and joints are numbers; a joint leads from its first link to its second.

Source: J. Hopcroft, R. Tarjan, "Efficient algorithms for graph manipulation", Comm. ACM 16(6), 1973 (the components).
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array, Index


@dataclass(frozen=True, eq=False)
class Topology:
    """A spanning forest over links, each tree from a root.

    parent, joint, root: (n,) of each link the one before it, the joint between them, and the root of its tree; -1 where
    there is none, as before a root or where no joint leads. steps: (link, joint, parent) of every joint of the forest,
    parents first. signs: (n, j) with which joints lead from the root to each link, -1 where one is gone through from
    its second link. loops: the joints outside, each of which closes a loop.
    """

    parent: Index
    joint: Index
    root: Index
    steps: tuple[tuple[int, int, int], ...]
    signs: Array
    loops: tuple[int, ...]


def topology_of(links: int, ends: Sequence[tuple[int, int]], roots: Iterable[int]) -> Topology:
    """The topology of so many links, with joints between the links of each pair; nearer links are reached first.

    A root that is reached from one before it is none.
    """
    touching: list[list[int]] = [[] for _ in range(links)]
    for number, pair in enumerate(ends):
        for link in pair:
            touching[link].append(number)
    parent, joint, tree = (np.full(links, -1, dtype=np.intp) for _ in range(3))
    signs = np.zeros((links, len(ends)))
    steps: list[tuple[int, int, int]] = []
    for root in roots:
        if tree[root] >= 0:
            continue
        tree[root] = root
        waiting = deque([root])
        while waiting:
            here = waiting.popleft()
            for number in touching[here]:
                forward = ends[number][0] == here
                link = ends[number][1 if forward else 0]
                if tree[link] >= 0:
                    continue
                tree[link], parent[link], joint[link] = root, here, number
                signs[link] = signs[here]
                signs[link, number] = 1.0 if forward else -1.0
                steps.append((link, number, here))
                waiting.append(link)
    used = {number for _, number, _ in steps}
    loops = tuple(number for number in range(len(ends)) if number not in used)
    for array in (parent, joint, tree, signs):
        array.flags.writeable = False
    return Topology(parent, joint, tree, tuple(steps), signs, loops)


def components(pairs: list[tuple[int, int]]) -> list[set[int]]:
    """The biconnected components of a graph of edges, pairs of links: sets of the edges' numbers."""
    touching: dict[int, list[int]] = {}
    for number, pair in enumerate(pairs):
        for link in pair:
            touching.setdefault(link, []).append(number)
    depth: dict[int, int] = {}
    low: dict[int, int] = {}
    found: list[set[int]] = []
    for root in touching:
        if root in depth:
            continue
        depth[root] = low[root] = 0
        trail: list[int] = []
        stack = [(root, -1, iter(touching[root]))]
        while stack:
            link, came, edges = stack[-1]
            for number in edges:
                if number == came:
                    continue
                other = pairs[number][1] if pairs[number][0] == link else pairs[number][0]
                if other not in depth:
                    depth[other] = low[other] = depth[link] + 1
                    trail.append(number)
                    stack.append((other, number, iter(touching[other])))
                    break
                if depth[other] < depth[link]:
                    trail.append(number)
                    low[link] = min(low[link], depth[other])
            else:
                stack.pop()
                if stack:
                    parent = stack[-1][0]
                    low[parent] = min(low[parent], low[link])
                    if low[link] >= depth[parent]:
                        at = trail.index(came)
                        found.append(set(trail[at:]))
                        del trail[at:]
    return found
