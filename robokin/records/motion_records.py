"""Configurations along a motion as plain data: joint values, link poses, and the paths of points."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.mobility.point_paths import Point, paths_of
from robokin.mobility.trace import Trace
from robokin.model.joint_units import in_units
from robokin.records.envelope import envelope
from robokin.records.pose_records import poses_in
from robokin.spatial import rpy_from_rotation
from robokin.units import Units


class MotionRecords:
    """A trace in units, with the paths of points.

    values: (m, f) joint values; paths: (m, points, 3); numbers: (m, k) all columns.
    """

    def __init__(self, trace: Trace, points: Sequence[Point], units: Units) -> None:
        self.trace, self.points, self.units = trace, points, units
        self.planar = trace.mechanism.space == "planar"
        factors = np.where(trace.turning, units.radians, units.metres)
        self.values = in_units(trace.values, factors)
        self.poses = poses_in(trace.poses.copy(), units)
        self.moving = [i for i, name in enumerate(trace.links) if name != trace.mechanism.ground]
        self.paths = paths_of(trace, points) / units.metres + 0.0

    @property
    def columns(self) -> list[str]:
        """The columns of a CSV and of an array."""
        parts = ("x", "y", "angle") if self.planar else ("x", "y", "z", "roll", "pitch", "yaw")
        links = [f"{self.trace.links[i]}.{part}" for i in self.moving for part in parts]
        return [*self.trace.labels, *links, *self.point_columns]

    @property
    def point_columns(self) -> list[str]:
        """The columns of the points."""
        axes = "xy" if self.planar else "xyz"
        return [f"P{i}.{axis}" for i in range(1, len(self.points) + 1) for axis in axes]

    @property
    def point_numbers(self) -> Array:
        """(m, k) where the points are."""
        return self.paths[:, :, : 2 if self.planar else 3].reshape(len(self.paths), -1)

    @property
    def numbers(self) -> Array:
        """The columns (m, k)."""
        poses = self.poses[:, self.moving]
        turns = rpy_from_rotation(poses[..., :3, :3]) / self.units.radians
        if self.planar:
            links = np.concatenate([poses[..., :2, 3], turns[..., 2:]], axis=-1)
        else:
            links = np.concatenate([poses[..., :3, 3], turns], axis=-1)
        return np.concatenate([self.values, links.reshape(len(links), -1), self.point_numbers], axis=1) + 0.0

    def records(self) -> Iterator[dict[str, Any]]:
        """A document for each configuration."""
        rows = zip(self.values.tolist(), self.poses.tolist(), self.paths.tolist(), strict=True)
        for step, (values, poses, points) in enumerate(rows, start=1):
            record = {
                "step": step,
                "q": dict(zip(self.trace.labels, values, strict=True)),
                "links": {self.trace.links[i]: poses[i] for i in self.moving},
            }
            yield record | ({"points": points} if self.points else {})

    def head(self) -> dict[str, Any]:
        """What all configurations share."""
        mechanism = self.trace.mechanism
        head = envelope("mechanism", mechanism.id, self.units)
        return head | {"driven": self.trace.driven, "closed": self.trace.closed}
