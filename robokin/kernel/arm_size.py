"""The size of an arm, read off its joint axes and not off the frames of its table.

Statement. On each revolute axis there is a point where the arm arrives: the foot of its common normal with the axis
before. The size is the length of the way from the base along these points to the tool: for each link the root of
d² + a², with a its common normal and d the way along the axis to it. For a usual Denavit-Hartenberg table it is the sum
over its rows. Prismatic joints stand at q = 0.

Derivation. Two axes that are not parallel have one common normal. Parallel axes have the same distance everywhere, and
d may go along any of them: the arm passes to the next one where it has come to the first of them, or where it leaves
the last of them, in the way that makes the sum least (found from joint to joint, by dynamic programming). Calibrated
tables have axes that are parallel but for 1e-4 rad. Their common normal may be hundreds of metres away, where one d
goes forth and the next comes back; near the arm they are as good as parallel. So axes at a small angle are passed as
parallel ones are; between the two angles below the place moves from there to the foot, so that the size has no jumps.

Degenerate case. An arm without revolute joints: the distance from the base to the tool at q = 0. Where nothing has a
length the size is 1.

Reference: the parameters of axes, J. Denavit, R. S. Hartenberg, A kinematic notation for lower-pair mechanisms based on
matrices, J. Appl. Mech. 22, 1955; nearly parallel axes: S. Hayati, M. Mirmirani, Improving the absolute positioning
accuracy of robot manipulators, J. Robotic Systems 2(4), 1985.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from robokin.arrays import Array, Flags

AS_PARALLEL = 0.02
"""Sine of the angle of two axes up to which they count as parallel: calibration changes tables by some 0.01 rad."""

ASKEW = 0.1
"""Sine of the angle from which on the common normal's foot counts: designed axes are parallel or at 10° or more."""

LENGTH = 1e-15
"""A sum of lengths [m] that is no more is nothing: the rounding of products of matrices."""


def axis_path(constants: Array, revolute: Flags, offsets: Array, start: Array) -> tuple[float, Array]:
    """The size of the chain C0 J1 C1 … Jn Cn [m], and (n,) where the arm arrives on each joint's axis.

    constants: (n + 1, 4, 4) [m]; revolute: (n,) bool; offsets: (n,) [rad | m]; start: (3,) the base's origin in the
    frame that the first joint starts from [m]. The second is z in the frame of the joint [m]; 0 for prismatic joints,
    which have a direction and no place.
    """
    arrivals = np.zeros(len(revolute))
    start, links, tip = _revolute_links(constants, revolute, offsets, start)
    if not links:
        return _length(float(np.linalg.norm(tip - start))), arrivals
    first, last = float(start[2]), float(tip[2])
    # For each place where the arm may be on an axis: what it has cost to come there, and the places before.
    ways: list[tuple[float, float, tuple[float, ...]]] = [(0.0, first, (first,))]
    axes = [_Axis(*L[:3, 3].tolist(), *L[:3, 2].tolist()) for L in links[1:]]
    for axis, leaves in zip(axes, _leaves(axes, first, last), strict=True):
        onwards = []
        for leave in leaves:
            arrive = axis.foot(leave)
            x, y, z = axis.t_x + arrive * axis.z_x, axis.t_y + arrive * axis.z_y, axis.t_z + arrive * axis.z_z
            cost, places = min([(cost + math.hypot(x, y, z - at), places) for cost, at, places in ways])
            onwards.append((cost, arrive, (*places, arrive)))
        ways = onwards
    cost, places = min((cost + math.hypot(tip[0], tip[1], last - at), places) for cost, at, places in ways)
    arrivals[revolute] = places
    return _length(cost), arrivals


def _length(length: float) -> float:
    return length if length > LENGTH else 1.0


def _revolute_links(
    constants: Array, revolute: Flags, offsets: Array, start: Array
) -> tuple[Array, list[Array], Array]:
    """The base's origin, the transforms (4, 4) to each revolute joint from the one before, and the tool's point.

    The origin (3,) is seen from the first revolute joint, the point (3,) from the last one; without any, from the first
    joint. The first transform is that from the first joint of the chain.
    """
    links: list[Array] = []
    step = np.eye(4)
    for turns, offset, C in zip(revolute, offsets, constants[1:], strict=True):
        if turns:
            links.append(step)
            step = C
        else:
            step = step.copy()
            step[:3, 3] += step[:3, 2] * offset
            step = step @ C
    if links:
        start = links[0][:3, :3].T @ (start - links[0][:3, 3])
    return start, links, step[:3, 3]


class _Axis(NamedTuple):
    """The next axis as it is seen from one: a point t on it and its direction z."""

    t_x: float
    t_y: float
    t_z: float
    z_x: float
    z_y: float
    z_z: float

    def foot(self, at: float) -> float:
        """Where on the next axis what is nearest to z = `at` is."""
        return -self.z_x * self.t_x - self.z_y * self.t_y + self.z_z * (at - self.t_z)


def _leaves(axes: list[_Axis], first: float, last: float) -> list[set[float]]:
    """Where the arm may leave each axis but the last, z in its frame: (one or two places).

    first: where it begins on the first axis; last: where it ends on the last one.
    """
    entries, exits = [], []
    at = first
    for axis in axes:
        entries.append(_passage(axis, at))
        at = axis.foot(entries[-1])
    at = last
    for axis in reversed(axes):
        at = _passage(axis, axis.t_z + at * axis.z_z)
        exits.append(at)
    return [{entry, end} for entry, end in zip(entries, exits[::-1], strict=True)]


def _passage(axis: _Axis, at: float) -> float:
    """Where the arm leaves an axis for the next one: at z = `at` or at the foot."""
    sine = math.hypot(axis.z_x, axis.z_y)
    if sine <= AS_PARALLEL:
        return at
    foot = axis.t_z - (axis.t_x * axis.z_x + axis.t_y * axis.z_y) * axis.z_z / sine**2
    return at + min((sine - AS_PARALLEL) / (ASKEW - AS_PARALLEL), 1.0) * (foot - at)
