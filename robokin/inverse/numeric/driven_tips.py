"""Tips whose joints are driven by variables that they share, or that move several joints: errors and their slopes.

Statement. For variables u say how far each of k tips is from its target, and how that changes with u.
Derivation. Each tip is at the end of a chain whose joint values are v = S u + o. So its Jacobian in u is J S, and the
errors of all tips are one error, with the Jacobians on top of each other (B. Siciliano et al., "Robotics: Modelling,
Planning and Control", 2009, sec. 3.1 and 3.5; couplings: J. J. Craig, Introduction to Robotics, 3rd ed., sec. 3.8).
Lengths are in each chain's own size, so that a short finger counts as much as a long arm.
What a task leaves open has no rows: the orientation of a position; of an approach the turn about the tool's z axis,
whose error is the shortest turn that brings that axis to the target's.
Degenerate case. Two z axes that are opposite have no shortest turn: one about an axis across them is taken.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.brief import Brief
from robokin.inverse.analysis import Task
from robokin.inverse.verify import CLOSES, closing_distances
from robokin.kernel.chain import Chain, chain_size, near_the_arm, with_joints
from robokin.kernel.frames import pose
from robokin.kernel.residual import error_and_jacobian
from robokin.model.graph import SerialChain
from robokin.spatial import exact, invert

OPPOSITE = 1e-9
"""Sine of the angle of two z axes below which, where they are opposite, no turn is the shortest."""


@dataclass(frozen=True, eq=False, repr=False)
class DrivenTips(Brief):
    """k chains, each with what its target asks for, and the variables u (n,) that drive them.

    maps: S (n_i, n) of each chain's joint values S u, the offsets being the chain's own. turns: (n,) whether each
    variable is an angle; limits: (n, 2) of the variables; rows: (r, n), offsets: (r,) and bounds: (r, 2) of those
    values rows u + offsets that have limits of their own [rad | m].
    """

    chains: tuple[Chain, ...]
    maps: tuple[Array, ...]
    tasks: tuple[Task, ...]
    turns: Flags
    limits: Array
    rows: Array
    offsets: Array
    bounds: Array

    @cached_property
    def sizes(self) -> Array:
        """(k,) the size of each chain [m]."""
        return np.array([chain_size(chain) for chain in self.chains])

    @cached_property
    def size(self) -> float:
        """The size of the greatest chain [m], the unit of slides."""
        return float(np.max(self.sizes))

    @cached_property
    def scale(self) -> Array:
        """(n,) what a variable is counted in [rad | m]."""
        return np.where(self.turns, 1.0, self.size)

    @property
    def n(self) -> int:
        """The number of variables."""
        return len(self.turns)

    def values(self, tip: int, u: Array) -> Array:
        """The joint values (..., n_i) of a chain at variables u (..., n) [rad | m]."""
        return np.asarray(u @ self.maps[tip].T)

    def poses(self, u: Array) -> Array:
        """The tips' poses (s, k, 4, 4) [m] at variables u (s, n)."""
        return np.stack([pose(chain, self.values(i, u)) for i, chain in enumerate(self.chains)], axis=1)

    def reached(self, u: Array, place: Array, angle: Array) -> Flags:
        """(s,) whether errors place [m] and angle [rad], each (s, k), at u (s, n) are those of rounding."""
        near = [closing_distances(chain, self.values(i, u), self.sizes[i]) for i, chain in enumerate(self.chains)]
        closes = [(place[:, i] <= distance) & (angle[:, i] <= CLOSES) for i, distance in enumerate(near)]
        return np.asarray(np.all(closes, axis=0))

    def over(self, u: Array) -> Array:
        """(s, r) by how much values with limits of their own are above or, negative, below them [rad | m]."""
        v = u @ self.rows.T + self.offsets
        return np.asarray(v - np.clip(v, self.bounds[:, 0], self.bounds[:, 1]))


def driven_tips(
    parts: Sequence[SerialChain],
    tasks: Sequence[Task],
    turns: Flags,
    limits: Array,
    following: Collection[str] = (),
) -> DrivenTips:
    """The tips at the ends of chains (k) of one graph; variables are those that move one of them, in their order.

    turns: (n,), limits: (n, 2) [rad | m] of all variables of the graph; following: the names of the joints without a
    variable of their own. Joints that hang on several variables keep the limits of their motion.
    """
    variables = driving(parts)
    chains, maps = [], []
    rows: dict[str, tuple[Array, float, tuple[float, float]]] = {}
    for part in parts:
        S = np.zeros((len(part.joints), len(variables)))
        S[:, np.searchsorted(variables, part.variables)] = part.S
        start = (invert(part.constants[0]) @ part.base)[:3, 3]
        chains.append(
            near_the_arm(Chain(np.stack([exact(C) for C in part.constants]), part.turns, part.offsets, start))
        )
        maps.append(S)
        for joint, row, offset in zip(part.joints, S, part.offsets, strict=True):
            low, high = joint.motion_limits
            if joint.name in following:  # its limits are those of its motion, too
                low, high = max(low, joint.limits[0]), min(high, joint.limits[1])
            if np.count_nonzero(row) > 1 and joint.name not in rows and np.isfinite([low, high]).any():
                rows[joint.name] = row, offset - joint.zero, (low, high)
    return DrivenTips(
        tuple(chains),
        tuple(maps),
        tuple(tasks),
        turns[variables],
        limits[variables],
        np.array([row for row, _, _ in rows.values()]).reshape(len(rows), len(variables)),
        np.array([offset for _, offset, _ in rows.values()]),
        np.array([bounds for _, _, bounds in rows.values()]).reshape(len(rows), 2),
    )


def driving(parts: Sequence[SerialChain]) -> Index:
    """The numbers of the variables that move one of the chains, in their order."""
    return np.unique(np.concatenate([part.variables for part in parts])).astype(np.intp)


def errors_and_slopes(tips: DrivenTips, T: Array, u: Array) -> tuple[Array, Array]:
    """The errors (s, m) of the tips at u (s, n) [rad | m] against T (s, k, 4, 4), and their slopes (s, m, n).

    The slopes are in u / scale, lengths in the chains' sizes. m: 6 rows for a pose or an approach, 3 for a position,
    and one for each value that has limits of its own.
    """
    errors, slopes = [], []
    for i, (chain, task) in enumerate(zip(tips.chains, tips.tasks, strict=True)):
        e, J = _of_tip(chain, task, T[:, i], tips.values(i, u), tips.sizes[i])
        unit = np.where(chain.revolute, 1.0, tips.sizes[i])
        errors.append(e)
        slopes.append(J @ (tips.maps[i] * tips.scale / unit[:, None]))
    if len(tips.rows):
        over = tips.over(u) / tips.size
        errors.append(-over)
        slopes.append(np.where(over[:, :, None] != 0.0, tips.rows * tips.scale / tips.size, 0.0))
    return np.concatenate(errors, axis=1), np.concatenate(slopes, axis=1)


def _of_tip(chain: Chain, task: Task, T: Array, v: Array, size: float) -> tuple[Array, Array]:
    """The error and the Jacobian of one tip in its joints' values v (s, n_i), of what its task asks for."""
    if task != "approach":
        e, J = error_and_jacobian(chain, T, v, size)
        return (e, J) if task == "pose" else (e[:, :3], J[:, :3])
    # A joint about the tool's z axis that stands still tells that axis.
    e, J = error_and_jacobian(_with_roll(chain), T, np.concatenate([v, np.zeros((len(v), 1))], axis=1), size)
    z, J = J[:, 3:, -1], J[:, :, :-1].copy()
    e[:, 3:] = turn_of_axes(z, T[:, :3, 2])
    J[:, 3:] -= z[:, :, None] * np.einsum("si,sij->sj", z, J[:, 3:])[:, None]
    return e, J


def turn_of_axes(z: Array, wish: Array) -> Array:
    """The shortest rotation vectors (s, 3) [rad] that bring unit vectors z (s, 3) to the wished ones."""
    across = np.cross(z, wish)
    sine = np.linalg.norm(across, axis=1)
    cosine = np.einsum("si,si->s", z, wish)
    turn = across * (np.arctan2(sine, cosine) / np.maximum(sine, np.finfo(float).tiny))[:, None]
    stuck = (sine < OPPOSITE) & (cosine < 0.0)
    if stuck.any():
        least = np.eye(3)[np.argmin(np.abs(z[stuck]), axis=1)]
        side = np.cross(z[stuck], least)
        turn[stuck] = np.pi * side / np.linalg.norm(side, axis=1, keepdims=True)
    return np.asarray(turn)


def _with_roll(chain: Chain) -> Chain:
    return with_joints(chain, [2], [True])


def tip_errors(tips: DrivenTips, T: Array, u: Array) -> tuple[Array, Array]:
    """Distances [m] and angles [rad], each (s, k), of the tips at u (s, n) from T (s, k, 4, 4); 0 what is not asked."""
    e, _ = errors_and_slopes(tips, T, u)
    place, angle = np.empty((len(u), len(tips.chains))), np.zeros((len(u), len(tips.chains)))
    first = 0
    for i, task in enumerate(tips.tasks):
        place[:, i] = np.linalg.norm(e[:, first : first + 3], axis=1) * tips.sizes[i]
        if task != "position":
            angle[:, i] = np.linalg.norm(e[:, first + 3 : first + 6], axis=1)
        first += 3 if task == "position" else 6
    return place, angle
