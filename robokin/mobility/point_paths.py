"""Paths of points of links along a motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.mobility.trace import Trace


@dataclass(frozen=True, eq=False)
class Point:
    """A point of a link: where it is (3,) [m] in the assembled configuration."""

    link: str
    at: Array


def paths_of(trace: Trace, points: Sequence[Point]) -> Array:
    """(m, points, 3) [m] where points of links are along a motion."""
    paths = np.zeros((len(trace.poses), len(points), 3))
    for i, point in enumerate(points):
        T = trace.poses[:, trace.links.index(point.link)]
        paths[:, i] = T[:, :3, :3] @ point.at + T[:, :3, 3]
    return paths
