"""What the joints and links of a mechanism do in its motion: dead joints, strained ones, idle links."""

from __future__ import annotations

import numpy as np

from robokin.arrays import Flags
from robokin.kernel.ranks import LOOP_RANK
from robokin.mobility.assembly import Assembly
from robokin.mobility.linkage import Linkage
from robokin.mobility.true_mobility import STILL, TrueMobility

PLANE = (0, 1, 5)
"""The parts of a twist that a motion in the plane has: x, y and the turn about z."""


def still_freedoms(linkage: Linkage, motion: TrueMobility) -> Flags:
    """Freedoms (f,) that only tremble along a branch where constraints vanish many times: steps that do not hold them
    would go along with them as far as rounding lets them."""
    moving = np.isin(linkage.joint, list(set().union(*(course.moving for course in motion.courses))))
    many = np.zeros(linkage.freedoms, dtype=bool)
    for part in motion.parts:
        many[part.block.freedoms] = part.branches[0].times > 1
    return np.asarray(many & ~moving)


def moving_joints(assembly: Assembly, elements: frozenset[int]) -> tuple[str, ...]:
    """The mechanism's joints that move where these of the linkage's elements do; a gear with the joints it couples."""
    names = {assembly.linkage.elements[number].name for number in elements}
    names |= {own[0] for own in assembly.tied if names & set(own[1:])}
    return tuple(joint.name for joint in assembly.mechanism.joints if joint.name in names)


def strained_joints(assembly: Assembly, motion: TrueMobility) -> tuple[str, ...]:
    """The joints through which redundant constraints can strain the mechanism, in the space that it lives in."""
    linkage, loops = assembly.linkage, assembly.linkage.loops
    # In the plane two forces and a moment are constraints that λ = 3 counts; the rest is strained by every loop.
    kept = PLANE if assembly.mechanism.space == "planar" else tuple(range(6))
    J = linkage.jacobian(motion.state)
    by_loop, rows = J[: 6 * len(loops)].reshape(len(loops), 6, linkage.freedoms)[:, kept], J[6 * len(loops) :]
    found: set[str] = set()
    for part in motion.parts:
        own = part.block.freedoms
        (chords,) = np.nonzero(np.isin(linkage.chords, part.block.elements))
        (tied,) = np.nonzero(np.any(rows[:, own] != 0.0, axis=1) | ~np.any(rows != 0.0, axis=1))
        equations = len(chords) * len(kept)
        U, values, _ = np.linalg.svd(
            np.concatenate([by_loop[chords][:, :, own].reshape(equations, len(own)), rows[tied][:, own]])
        )
        left = U[:, int(np.sum(values > LOOP_RANK * values[:1])) :]
        strains = np.einsum(
            "lj,lck->jck", loops[chords], left[:equations].reshape(len(chords), len(kept), left.shape[1])
        )
        for number in np.nonzero(np.linalg.norm(strains, axis=(1, 2)) > STILL)[0]:
            found.add(linkage.elements[int(number)].name)
        for row, size in zip(tied, np.linalg.norm(left[equations:], axis=1), strict=True):
            found |= set(assembly.tied[int(row)]) if size > STILL else set()
    return tuple(joint.name for joint in assembly.mechanism.joints if joint.name in found)


def idle_freedoms(assembly: Assembly, motion: TrueMobility) -> int:
    """Freedoms of one link, or of two that a joint connects, that move nothing else: spins of rods and legs."""
    linkage, T = assembly.linkage, motion.tangent
    if not T.shape[1]:
        return 0
    bodies = linkage.body_twists(motion.state, T)
    ground = linkage.ground
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
