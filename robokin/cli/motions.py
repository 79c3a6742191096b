"""Configurations along a motion as rows: joint values, link poses, and the paths of points."""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.cli.arguments import in_units, parse_numbers, split_vector
from robokin.cli.output.array_files import ArrayWriter
from robokin.cli.output.tables import heading, number_table, render
from robokin.cli.output.text import csv_records, csv_rows, json_document, json_line
from robokin.cli.records import poses_in
from robokin.errors import InputError, did_you_mean, shown
from robokin.mobility.trace import Trace
from robokin.model import Mechanism
from robokin.records.envelope import envelope
from robokin.spatial import rpy_from_rotation
from robokin.units import Units

PAGE_COLUMNS = 6
"""Columns of numbers that fit beside one another on a page."""

FORMATS = ("csv", "jsonl", "npy")
"""What a motion is written to a file as; standard output takes JSON and a table too."""


@dataclass(frozen=True, eq=False)
class Point:
    """A point of a link: where it is (3,) [m] in the assembled configuration."""

    link: str
    at: Array


def parse_point(text: str, mechanism: Mechanism, units: Units) -> Point:
    """A point such as `coupler:1,2`, of a link and in the assembled configuration. Raises InputError."""
    link, colon, place = text.rpartition(":")
    link = link.strip()
    if not colon or not link:
        raise InputError(f"--point: found '{shown(text)}', expected LINK:X,Y, such as {mechanism.links[-1]}:1,2")
    if link not in mechanism.links:
        hint = did_you_mean(link, mechanism.links) or f", expected one of {', '.join(mechanism.links[:12])}"
        raise InputError(f"--point: found the unknown link '{shown(link)}'{hint}")
    plane = mechanism.space == "planar" and len(split_vector(place)) != 3
    what = "x, y" if plane else "x, y and z"
    numbers = parse_numbers(place, "--point", [False] * (2 if plane else 3), units, what)
    return Point(link, np.append(numbers, 0.0)[:3] * units.metres)


class MotionRows:
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

    def written(self, kind: str) -> bytes:
        """The motion in a format."""
        if kind == "csv":
            return csv_records(self.columns, []) + csv_rows(self.numbers)
        if kind == "jsonl":
            head = self.head()
            return b"".join(json_line(head | record) for record in self.records())
        if kind == "json":
            return json_document(self.head() | {"configurations": list(self.records())})
        if kind == "npy":
            stream = io.BytesIO()
            numbers = self.numbers
            writer = ArrayWriter(stream, numbers.shape[1:])
            writer.write(numbers)
            writer.close()
            return stream.getvalue()
        return self.table()

    def table(self) -> bytes:
        """Joint values and points, some columns at a time; the links' poses are for programs."""
        names = [*self.trace.labels, *self.point_columns]
        rows = np.concatenate([self.values, self.point_numbers], axis=1)
        steps = [str(i) for i in range(1, len(rows) + 1)]
        units = self.units
        parts: list[Any] = [
            heading(self.trace.mechanism.name, f"lengths in {units.length}, angles in {units.angle}"),
            f"{self.trace.driven} leads; {self.outcome}",
        ]
        for first in range(0, len(names), PAGE_COLUMNS):
            part = slice(first, first + PAGE_COLUMNS)
            parts += ["", number_table(names[part], rows[:, part].tolist(), steps)]
        return render(*parts)

    @property
    def outcome(self) -> str:
        """How the motion ends."""
        return "the motion comes back to its beginning" if self.trace.closed else "the motion does not come back"


def paths_of(trace: Trace, points: Sequence[Point]) -> Array:
    """(m, points, 3) [m] where points of links are along a motion."""
    paths = np.zeros((len(trace.poses), len(points), 3))
    for i, point in enumerate(points):
        T = trace.poses[:, trace.links.index(point.link)]
        paths[:, i] = T[:, :3, :3] @ point.at + T[:, :3, 3]
    return paths
