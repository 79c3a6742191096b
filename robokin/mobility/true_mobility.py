"""True mobility: what a mechanism can do, from its geometry, and why a count may differ.

Statement. Given an assembled linkage, find the dimension of the set of its configurations at the one given.

1. The linkage is taken apart into blocks, whose dimensions add; links that spin on their own are set aside.
2. In each block joint speeds must lie in the kernel of the equations of its loops: its dimension is the *instantaneous*
   mobility. Singular values tell it; the gap between the least that counts and the greatest that does not is part of
   the answer. No kernel: the block is rigid. Independent equations: the configurations are a smooth surface of just
   that dimension, by the implicit function theorem.
3. Otherwise the constraints are reduced to the kernel. If what is left vanishes all about the pose, the configurations
   are a smooth surface of the kernel's dimension.
4. If not, and the kernel has one dimension, the pose is isolated: a function of one variable that is analytic and not
   zero has isolated zeros. The *order* in which the constraints grow is that of the tremble.
5. Else the branches through the pose are sought, followed and measured. The *mobility* is the greatest dimension, the
   *generic* mobility the kernel's along that branch.

What is proven: no kernel, and independent equations, as far as the singular values' gap is beyond rounding; that a
mobility is less than the kernel, since one point suffices. That constraints vanish all about is calculated at some
points at a great radius, with which all analytic functions of moderate order would be seen; that there are no more
branches rests on the number of directions in which they are sought.

Degenerate. The answer is that of the configuration given and near it, not all round. A block with contacts whose points
wander on their links is judged by its velocities alone; where its equations are independent that is all there is.

Sources: J. M. Selig, Geometric Fundamentals of Robotics, 2nd ed., 2005 (twists); C. W. Wampler, J. D. Hauenstein,
A. J. Sommese, "Mechanism mobility and a local dimension test", Mech. Mach. Theory 46(9), 2011; R. Connelly and
H. Servatius, "Higher-order rigidity: what is the proper definition?", Discrete Comput. Geom. 11, 1994 (at a cusp an
order forbids what still moves).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import prod

import numpy as np

from robokin.arrays import Array
from robokin.brief import Brief
from robokin.kernel.ranks import LOOP_RANK
from robokin.mobility.configuration_branches import branches_of, isolation
from robokin.mobility.linkage import Linkage, LinkageState
from robokin.mobility.linkage_blocks import Block, blocks_of, speeds_of, state_of
from robokin.mobility.measured import Branch
from robokin.mobility.reduced import Reduced, directions

ASIDE = (0.3, 0.1, 0.03, 0.01)
"""How far [rad | size] a configuration beside the pose is, at which it is seen what is usual."""

LISTED = 64
"""Combinations of the blocks' branches that are listed."""

STILL = 1e-7
"""A joint whose part in every motion is less does not move."""


@dataclass(frozen=True, eq=False, repr=False)
class BlockMobility(Brief):
    """What a block can do.

    values: the singular values of its equations, as parts of the greatest, descending; kernel: the instantaneous
    mobility, spins included, and allowed (n, kernel - spins) its velocities; branches: at least one, of dimension 0
    where nothing leads away; order: that in which constraints forbid what velocities allow, or None; undecided: why no
    mobility is known, or None; broken: whether a constraint that velocities keep to is known to be broken, so that the
    mobility is less than the kernel.
    """

    block: Block
    values: Array
    kernel: int
    allowed: Array
    branches: tuple[Branch, ...]
    order: int | None = None
    undecided: str | None = None
    broken: bool = False

    @property
    def most(self) -> int:
        """What its mobility is at most."""
        if self.undecided is None:
            return self.branches[0].dimension + len(self.block.spins)
        return self.kernel - self.broken


@dataclass(frozen=True, eq=False, repr=False)
class Course(Brief):
    """A branch of a linkage's configurations: its dimension, the elements that move in it, and the branch of each
    block."""

    dimension: int
    moving: frozenset[int]
    branches: tuple[Branch, ...]


@dataclass(frozen=True, eq=False, repr=False)
class TrueMobility(Brief):
    """What a linkage can do near its configuration.

    instantaneous, generic, finite: the three mobilities; values: the singular values of the blocks' equations at the
    given configuration, as parts of the greatest of the block, descending; rank: how many count; state: a configuration
    beside the pose on the branch of the greatest dimension; tangent: (f, finite) the motions' joint speeds there,
    orthonormal; redundant: equations of loops and rows that say nothing new (of λ a loop) there; courses: the branches
    through the pose, the greatest first (at most `LISTED`), and count: how many there are; order: that of the tremble;
    undecided: why finite is not known, or None: finite then is what is known to be possible at least.
    """

    instantaneous: int
    generic: int
    finite: int
    values: Array
    rank: int
    state: LinkageState
    tangent: Array
    redundant: int
    courses: tuple[Course, ...]
    count: int
    order: int | None
    undecided: str | None
    parts: tuple[BlockMobility, ...]

    @property
    def most(self) -> int:
        """What the finite mobility is at most: where it is undecided it is between `finite` and this."""
        return sum(part.most for part in self.parts)

    @property
    def gap(self) -> tuple[float, float]:
        """The least singular value that counts, and the greatest that does not (0 where there is none)."""
        least = float(self.values[self.rank - 1]) if self.rank else 0.0
        rest = float(self.values[self.rank]) if self.rank < len(self.values) else 0.0
        return least, rest


def motion_of(linkage: Linkage, order: int, wandering: frozenset[int] = frozenset()) -> TrueMobility:
    """The motion of a linkage in a space of λ = order; wandering: elements that are known at the pose only."""
    found = (part_of(block, bool(wandering & set(block.elements))) for block in blocks_of(linkage))
    parts = tuple(_in_order(linkage, part) for part in found)
    state, T = along(linkage, parts, tuple(part.branches[0] for part in parts))
    instantaneous = sum(part.kernel for part in parts)
    generic = sum(part.branches[0].kernel + len(part.block.spins) for part in parts)
    values = np.sort(np.concatenate([np.zeros(0), *(part.values for part in parts)]))[::-1] + 0.0
    orders = [part.order for part in parts if part.order is not None]
    reasons = [part.undecided for part in parts if part.undecided is not None]
    return TrueMobility(
        instantaneous,
        generic,
        T.shape[1],
        values,
        linkage.freedoms - instantaneous,
        state,
        T,
        max(order * len(linkage.loops) + len(linkage.rows) - (linkage.freedoms - generic), 0),
        _courses(linkage, parts, state),
        prod(len(part.branches) for part in parts),
        max(orders, default=None),
        reasons[0] if reasons else None,
        parts,
    )


def velocities_of(linkage: Linkage, motion: TrueMobility) -> Array:
    """The joints' speeds (f, instantaneous) that the constraints allow at the given configuration."""
    state = linkage.reference
    speeds = [speeds_of(linkage, state, p.block, np.zeros(p.block.chart.n), p.allowed) for p in motion.parts]
    return np.concatenate(speeds, axis=1) if speeds else np.zeros((linkage.freedoms, 0))


def beginnings_of(linkage: Linkage, motion: TrueMobility) -> Array:
    """The joints' speeds (f, d) with which the greatest branch leaves the given configuration."""
    state = linkage.reference
    speeds = [speeds_of(linkage, state, p.block, np.zeros(p.block.chart.n), p.branches[0].start) for p in motion.parts]
    return np.concatenate(speeds, axis=1) if speeds else np.zeros((linkage.freedoms, 0))


def kernel_at(linkage: Linkage, state: LinkageState, rank: float = LOOP_RANK) -> tuple[Array, Array]:
    """Singular values of the equations as parts of the greatest, and their kernel (f, k): those below `rank`."""
    J = linkage.jacobian(state)
    if not J.size:
        return np.zeros(0), np.eye(linkage.freedoms)
    _, values, Vt = np.linalg.svd(J)
    greatest = float(values[0]) or 1.0
    values = values / greatest
    return values, Vt[int(np.sum(values > rank)) :].T


def part_of(block: Block, wandering: bool = False) -> BlockMobility:
    """What a block can do; one with contacts that wander is judged by its velocities."""
    chart = block.chart
    if not chart.equations or not chart.n:
        q = 0.2 * directions(chart.n)[-1] if chart.n else np.zeros(0)
        free = Branch(chart.n, chart.n, q, np.eye(chart.n), np.eye(chart.n))
        return BlockMobility(block, np.zeros(0), chart.n + len(block.spins), np.eye(chart.n), (free,))
    reduced = Reduced(chart, np.zeros(chart.n), cut=LOOP_RANK)
    whole = Reduced(block.whole, np.zeros(block.whole.n), cut=LOOP_RANK) if block.spins else reduced
    values = whole.values[: 6 * len(chart.chords) + len(chart.rows)]
    part = BlockMobility(block, values, reduced.k + len(block.spins), reduced.V0, (_pose(reduced),))
    if not reduced.k:
        return part
    if wandering:
        return replace(part, branches=(Branch(reduced.k, reduced.k, reduced.q0, reduced.V0, reduced.V0),))
    if reduced.free:
        return replace(part, branches=(_beside(reduced),))
    flat, reached = reduced.flat()
    if flat:
        return replace(part, branches=(_beside(reduced),))
    if flat is None:
        return replace(part, undecided="its loops cannot be closed again beside this pose")
    part = replace(part, broken=True)
    if reduced.k == 1:
        return replace(part, order=reduced.order())
    branches, undecided = branches_of(reduced, reached)
    if not branches:
        return replace(part, undecided=undecided, order=None if undecided else isolation(reduced, reached))
    times = max(branch.times for branch in branches)
    return replace(part, branches=tuple(branches), undecided=undecided, order=times if times > 1 else None)


def _pose(reduced: Reduced) -> Branch:
    """The pose itself, from which nothing leads away."""
    return Branch(0, reduced.k, reduced.q0, np.zeros((reduced.chart.n, 0)), np.zeros((reduced.chart.n, 0)))


def _beside(reduced: Reduced) -> Branch:
    """The smooth surface of the kernel's dimension, at a point beside the pose."""
    d = directions(reduced.k)[-1:]
    for radius in ASIDE:
        found = reduced.at(radius * d)
        if found.solved[0]:
            slope = reduced.equations(found.x, found.y)[4][0]
            tangent = np.linalg.qr(reduced.V0 + reduced.V1 @ slope)[0]
            return Branch(reduced.k, reduced.k, reduced.q(found.x, found.y)[0], tangent, reduced.V0)
    return Branch(reduced.k, reduced.k, reduced.q0, reduced.V0, reduced.V0)


def along(
    linkage: Linkage, parts: tuple[BlockMobility, ...], branches: tuple[Branch, ...]
) -> tuple[LinkageState, Array]:
    """A state on a branch of each block, and the joints' speeds (f, d) there, orthonormal."""
    chosen = list(zip(parts, branches, strict=True))
    state = state_of(linkage, [(part.block, branch.q) for part, branch in chosen])
    speeds = [speeds_of(linkage, state, part.block, branch.q, branch.tangent) for part, branch in chosen]
    T = np.concatenate(speeds, axis=1) if speeds else np.zeros((linkage.freedoms, 0))
    return state, np.linalg.qr(T)[0] if T.shape[1] else T


def _in_order(linkage: Linkage, part: BlockMobility) -> BlockMobility:
    """The part with branches of one dimension in an order that does not hang on how they were found or the joints are
    listed: by how evenly the joints take part as they begin."""
    if len(part.branches) < 2:
        return part

    def key(branch: Branch) -> tuple[float, ...]:
        T = speeds_of(linkage, linkage.reference, part.block, np.zeros(part.block.chart.n), branch.start)
        T = np.linalg.qr(T)[0]
        sizes = [float(np.linalg.norm(T[linkage.joint == number])) for number in part.block.elements]
        return (-branch.dimension, branch.kernel, *np.round(sorted(sizes, reverse=True), 3).tolist())

    return replace(part, branches=tuple(sorted(part.branches, key=key)))


def _courses(linkage: Linkage, parts: tuple[BlockMobility, ...], first: LinkageState) -> tuple[Course, ...]:
    """The combinations of the blocks' branches, the greatest first, at most `LISTED`; the state is on the first."""
    courses = [Course(0, frozenset(), ())]
    for part in parts:
        own = []
        for branch in part.branches:
            state = first if branch is part.branches[0] else state_of(linkage, [(part.block, branch.q)])
            T = speeds_of(linkage, state, part.block, branch.q, branch.tangent)
            own.append((T.shape[1], {int(j) for j in linkage.joint[np.linalg.norm(T, axis=1) > STILL]}, branch))
        combined = [
            Course(course.dimension + size, course.moving | moving, (*course.branches, branch))
            for course in courses
            for size, moving, branch in own
        ]
        courses = sorted(combined, key=lambda course: -course.dimension)[:LISTED]
    return tuple(courses)
