"""Plates between the joints that leave one body, as the palm of a hand."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.pictures.arm_bars import NOTHING
from robokin.pictures.skeleton import ArmSkeleton

STRAIGHT = 1.1
"""Links no longer than so many times the way from a body's origin to a joint are spokes of a plate."""

FLAT = 0.2
"""Where joints leave a body, those no farther from a plane than this part of their spread have a plate between them."""


@dataclass(frozen=True, eq=False)
class Palm:
    """The plate of a body that several joints leave: its corners (k, 3) [m], round its middle."""

    body: int
    corners: Array


def palms_of(skeleton: ArmSkeleton, length: float) -> list[Palm]:
    """The plates: between a body's origin and the joints that leave it straight, where a plane holds three of them."""
    palms = []
    for body, following in enumerate(skeleton.children):
        first = skeleton.marks[0].T[:3, 3] if body == 0 else np.zeros(3)
        corners = [first]
        for joint in (skeleton.bodies[number - 1] for number in following):
            place = joint.start[:3, 3]
            apart = min(float(np.linalg.norm(place - other)) for other in corners)
            if apart > NOTHING * length and joint.reach <= STRAIGHT * float(np.linalg.norm(place - first)):
                corners.append(place)
        if len(following) > 1 and (ring := _ring(np.array(corners))) is not None:
            palms.append(Palm(body, ring))
    return palms


def _ring(corners: Array) -> Array | None:
    """Corners (k, 3) round their middle, without one, but the first, that stands out, as a thumb does.

    None where they are in no plane, or in a row.
    """
    if len(corners) > 4 and _spread(corners)[2] > FLAT * _spread(corners)[1]:
        rest = [np.delete(corners, i, axis=0) for i in range(1, len(corners))]
        corners = min(rest, key=lambda part: float(_spread(part)[2]))
    spread = _spread(corners)
    if len(corners) < 3 or spread[1] <= FLAT * spread[0] or spread[2] > FLAT * spread[1]:
        return None
    middle = corners.mean(axis=0)
    axes = np.linalg.svd(corners - middle, full_matrices=False)[2]
    u, v = ((corners - middle) @ axis for axis in axes[:2])
    return np.asarray(corners[np.argsort(np.arctan2(v, u), kind="stable")])


def _spread(corners: Array) -> Array:
    """(3,) how far points (k, 3) [m] spread about their middle, along the directions in which they do so most."""
    return np.sqrt(np.linalg.svd(np.asarray(np.cov(corners.T, bias=True), dtype=np.float64), compute_uv=False))
