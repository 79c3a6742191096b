"""What an orientation means for an arm, and grids of them that are as even as can be.

Where the tool's origin is held still, the joints that remain turn the tool: by the rank of the Jacobian's angular
part on the kernel of its linear part not at all (a place has finitely many orientations), about one direction
that never changes (planar arms, SCARA), or in more ways. For arms that can only choose the direction of the tool's
z axis, and for those whose last joint rolls the tool about it through a whole turn, so that the roll says
nothing, an orientation is that direction.

Grids: equal angles; the spiral of golden angles on the sphere (R. Swinbank and R. J. Purser, "Fibonacci grids",
Q. J. R. Meteorol. Soc. 132, 2006); super-Fibonacci spirals of quaternions (M. Alexa, CVPR 2022).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from robokin.arrays import Array, Flags
from robokin.inverse.analysis import Task, analysis_of
from robokin.kernel.frames import frames, pose
from robokin.kernel.geometric_jacobian import jacobian_of
from robokin.kernel.ranks import RANK
from robokin.spatial import rotation_from_axis_angle, rotation_from_quaternion
from robokin.workspace.space import PROBES, Space

Group = Literal["SO(2)", "S2", "SO(3)", "curve", "finite"]

ALIKE = 1e-6
"""Directions that differ by less are the same: axes come from tables printed to some five digits and more."""

TASKS: dict[Group, Task] = {"SO(2)": "pose", "S2": "approach", "SO(3)": "pose"}
"""What of the tool's pose counts where an orientation is of a group that has a grid."""

GOLDEN_ANGLE = np.pi * (3.0 - np.sqrt(5.0))

PSI = 1.533751168755204288118041413
"""Alexa's constant ψ, the positive root of ψ⁴ = ψ + 4; the other one is φ = √2."""


@dataclass(frozen=True, eq=False)
class Attitudes:
    """Orientations to be tried at every place.

    group: "SO(2)", "S2" or "SO(3)"; rotations: (k, 3, 3) of the tool in the world; task: what of them counts;
    spacing: [rad] the side of the part of the group that belongs to each; axis: (3,) that of the turns of SO(2).
    """

    group: Group
    rotations: Array
    task: Task
    spacing: float
    axis: Array | None = None


def group_of(space: Space) -> Group:
    """What orientations a place can have: "curve" where there are infinitely many but no grid to compare with."""
    J, z_tool = _probes(space)
    angular = _kernel_turns(J, space.dimension)
    values = np.linalg.svd(angular, compute_uv=False)
    rank = int(np.max(np.sum(values > RANK, axis=1)))
    if rank == 0:
        return "finite"
    if rank == 1:
        return "SO(2)" if _one_direction(J) is not None else "curve"
    # How the tool's z axis moves: a turn about it does not count.
    pointing = np.linalg.svd(np.cross(angular, z_tool[:, None, :], axis=2), compute_uv=False)
    directions = int(np.max(np.sum(pointing > RANK, axis=1)))
    if directions < 2:
        return "curve"
    if space.gears is None:
        idle = analysis_of(space.arm, "approach").idle
        rolls = bool(idle) and all(space.full[~space.held][i] for i in idle)
    else:
        rolls = bool(np.any(_idle(J, z_tool) & space.full))
    return "S2" if rank == 2 or rolls else "SO(3)"


def _idle(J: Array, z_tool: Array) -> Flags:
    """(n,) which variables only turn the tool about its z axis, by Jacobians (p, 6, n) and these axes (p, 3)."""
    across = np.cross(np.swapaxes(J[:, 3:], 1, 2), z_tool[:, None])
    moved = np.linalg.norm(J[:, :3], axis=1) + np.linalg.norm(across, axis=2)
    return np.asarray((np.max(moved, axis=0) <= RANK) & np.any(J[:, 3:] != 0.0, axis=(0, 1)))


def attitudes(space: Space, group: Group, count: int, seed: int) -> Attitudes:
    """A grid of `count` orientations, turned at random. Raises ValueError where the group has none."""
    rng = np.random.default_rng((seed, count, 0x0A77))
    if group == "SO(2)":
        J, _ = _probes(space)
        axis = _one_direction(J)
        assert axis is not None
        own = pose(space.chain, space.motions(0.5 * (space.low + space.high)))[:3, :3]
        angles = 2.0 * np.pi * (np.arange(count) + rng.random()) / count
        return Attitudes(group, rotation_from_axis_angle(axis, angles) @ own, TASKS[group], 2.0 * np.pi / count, axis)
    turned = rotation_from_quaternion(_unit(rng.normal(size=4)))
    if group == "S2":
        return Attitudes(group, turned @ _pointing(spiral(count)), TASKS[group], float(np.sqrt(4.0 * np.pi / count)))
    if group == "SO(3)":
        spacing = float(np.cbrt(8.0 * np.pi**2 / count))
        return Attitudes(group, turned @ rotation_from_quaternion(super_spiral(count)), TASKS[group], spacing)
    raise ValueError(f"no grid of orientations for {group}")


def small_turns(tried: Attitudes, rotations: Array) -> Array:
    """(m, c, 3) the axes in the world about which a small turn of rotations (m, 3, 3) leads to all that are near."""
    if tried.axis is not None:
        return np.broadcast_to(tried.axis, (len(rotations), 1, 3))
    if tried.group == "S2":
        return np.swapaxes(rotations[:, :, :2], 1, 2)
    return np.broadcast_to(np.eye(3), (len(rotations), 3, 3))


def spiral(count: int) -> Array:
    """(count, 3) unit vectors spread evenly over the sphere."""
    i = np.arange(count)
    z = 1.0 - (2.0 * i + 1.0) / count
    r = np.sqrt(1.0 - z * z)
    return np.stack([r * np.cos(GOLDEN_ANGLE * i), r * np.sin(GOLDEN_ANGLE * i), z], axis=1)


def super_spiral(count: int) -> Array:
    """(count, 4) unit quaternions spread evenly over the rotations."""
    s = np.arange(count) + 0.5
    inner, outer = np.sqrt(s / count), np.sqrt(1.0 - s / count)
    alpha, beta = 2.0 * np.pi * s / np.sqrt(2.0), 2.0 * np.pi * s / PSI
    return np.stack([inner * np.sin(alpha), inner * np.cos(alpha), outer * np.sin(beta), outer * np.cos(beta)], axis=1)


def _unit(v: Array) -> Array:
    return np.asarray(v / np.linalg.norm(v, axis=-1, keepdims=True))


def _pointing(z: Array) -> Array:
    """(k, 3, 3) rotations whose third columns are z: (k, 3)."""
    # A direction that is far from z: along the axis of its least component.
    other = np.eye(3)[np.argmin(np.abs(z), axis=1)]
    x = _unit(np.cross(other, z))
    return np.stack([x, np.cross(z, x), z], axis=2)


def _probes(space: Space) -> tuple[Array, Array]:
    """Jacobians (p, 6, n), linear part in sizes, and the tool's z axis (p, 3) at arbitrary configurations."""
    # Values of no meaning: whatever holds at all of them holds everywhere.
    q = space.low + (space.high - space.low) * np.random.default_rng(12).random((PROBES, space.robot.n))
    F = frames(space.chain, space.motions(q))
    J = space.by_variables(jacobian_of(F, space.chain.revolute, size=space.size), space.size)
    J[:, :, space.held] = 0.0
    return J, F[:, -1, :3, 2]


def _kernel_turns(J: Array, dimension: int) -> Array:
    """(p, n - dimension, 3) angular velocities of the motions that leave the tool's origin where it is."""
    _, _, rows = np.linalg.svd(J[:, :3], full_matrices=True)
    return np.asarray(rows[:, dimension:] @ np.swapaxes(J[:, 3:], 1, 2))


def _one_direction(J: Array) -> Array | None:
    """(3,) the direction of all turns, if it is one and the same everywhere."""
    turns = np.swapaxes(J[:, 3:], 1, 2).reshape(-1, 3)
    _, values, directions = np.linalg.svd(turns, full_matrices=False)
    return directions[0] if values[1] <= ALIKE * values[0] else None
