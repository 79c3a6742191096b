"""What the joints and links of a mechanism do in its motion: dead joints, strained ones, idle links."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robokin.mobility.assembly import Assembly
from robokin.mobility.linkage import RANK, State
from robokin.mobility.mobility import Motion

Array = NDArray[np.float64]

STILL = 1e-7
"""A joint whose part in every motion is less never moves."""

PLANE = (0, 1, 5)
"""The parts of a twist that a motion in the plane has: x, y and the turn about z."""


def shares(assembly: Assembly, T: Array) -> list[float]:
    """How much each of the mechanism's joints takes part in motions T (f, k)."""
    sizes = np.zeros(len(assembly.mechanism.joints))
    np.maximum.at(sizes, assembly.own, np.linalg.norm(T, axis=1) if T.size else np.zeros(len(T)))
    return [float(size) for size in sizes]


def strained_joints(assembly: Assembly, state: State) -> tuple[str, ...]:
    """The joints through which redundant constraints can strain the mechanism, in the space that it lives in."""
    linkage, loops = assembly.linkage, len(assembly.linkage.loops)
    # In the plane two forces and a moment are constraints that λ = 3 counts; the rest is strained by every loop.
    rows = PLANE if assembly.mechanism.space == "planar" else slice(None)
    J = linkage.jacobian(state).reshape(loops, 6, -1)[:, rows]
    U, values, _ = np.linalg.svd(J.reshape(-1, J.shape[2]))
    left = U[:, int(np.sum(values > RANK * values[:1])) :].reshape(loops, J.shape[1], -1)
    strains = np.einsum("lj,lck->jck", linkage.loops, left).reshape(len(linkage.elements), -1)
    names = (e.name for e, size in zip(linkage.elements, np.linalg.norm(strains, axis=1), strict=True) if size > STILL)
    return tuple(dict.fromkeys(names))


def idle_freedoms(assembly: Assembly, motion: Motion) -> int:
    """Freedoms of one link, or of two that a joint connects, that move nothing else: spins of rods and legs."""
    linkage, T = assembly.linkage, motion.tangent
    if not T.shape[1]:
        return 0
    bodies = linkage.body_twists(motion.state, T)
    ground = assembly.link(assembly.mechanism.ground)
    groups = [{i} for i in range(len(bodies)) if i != ground]
    groups += [{e.a, e.b} for e in linkage.elements if ground not in (e.a, e.b)]
    spins = np.zeros((T.shape[1], 0))
    touches = np.array([(linkage.elements[j].a, linkage.elements[j].b) for j in linkage.joint])
    for group in groups:
        # T's columns are orthonormal: a motion has its whole length in the joints at the group if no other moves.
        at_group = T[np.isin(touches, list(group)).any(axis=1)]
        _, values, Vt = np.linalg.svd(at_group, full_matrices=False)
        alone = Vt[values > 1.0 - STILL].T
        if not alone.shape[1]:
            continue
        others = [i for i in range(len(bodies)) if i not in group]
        _, values, Vt = np.linalg.svd((bodies[others] @ alone).reshape(-1, alone.shape[1]))
        alone = alone @ Vt[int(np.sum(values > STILL)) :].T
        # All that moves is the group: a mechanism of one moving link has no idle freedom.
        if len(others) > 1 and alone.shape[1] < T.shape[1]:
            spins = np.concatenate([spins, alone], axis=1)
    return int(np.sum(np.linalg.svd(spins, compute_uv=False) > STILL)) if spins.size else 0
