"""Sampled positions as the bytes of a file, block by block: CSV, JSON lines, a NumPy array or a PLY point cloud."""

from __future__ import annotations

import hashlib
import io
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import IO, Any

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError, or_list
from robokin.jobs.sequences import Kind
from robokin.kinematics.forward import forward_kinematics
from robokin.model.joint_units import joint_factors
from robokin.records.envelope import envelope
from robokin.tables.arrow_library import ENDINGS as ARROW_ENDINGS
from robokin.tables.orientations import orientation, orientation_columns
from robokin.tables.written_rows import csv_header, csv_rows, json_line
from robokin.units import Units
from robokin.workspace.sampling import TASK, joint_values, positions, sample_count
from robokin.workspace.space import Space

ENDINGS = {".csv": "csv", ".jsonl": "jsonl", ".npy": "npy", ".ply": "ply", **ARROW_ENDINGS}
"""Formats by the ending of the output's name."""

BLOCK = 1 << 14
"""Samples written at once: some 10 MB of text at most, of which a few wait for their turn."""


def sample_format(output: str) -> str:
    """The format of a file of samples, by its name's ending. Raises InputError."""
    kind = ENDINGS.get(Path(output).suffix.lower())
    if kind is None:
        raise InputError(f"--output: found '{output}', expected a name that ends with {or_list(ENDINGS)}, or a folder/")
    return kind


@dataclass(frozen=True)
class Samples:
    """What a file of samples holds.

    kind: csv, jsonl, npy, ply, parquet or arrow; sampling, seed and samples as everywhere; joints: whether each
    position comes with its joint values; orientation: rpy, quaternion, euler or matrix where it comes with the tool's
    orientation, else None. Lengths and angles are in the units.
    """

    space: Space
    units: Units
    kind: str
    sampling: Kind = "sobol"
    seed: int = 0
    samples: int = 1 << 17
    joints: bool = False
    orientation: str | None = None

    @cached_property
    def count(self) -> int:
        """The number of samples that there will be: fewer than asked for where they form a grid."""
        return sample_count(self.space, self.sampling, self.samples, self.every)

    @property
    def every(self) -> bool:
        """Whether the joints that leave the tool's origin where it is matter, too."""
        return self.joints or self.orientation is not None

    @property
    def columns(self) -> list[str]:
        """The names of a row's numbers; a PLY file has the position first, so that viewers find it."""
        q = [f"q{i}" for i in range(1, len(self.space.low) + 1)] if self.joints else []
        turned = orientation_columns(self.orientation) if self.orientation else ()
        return ["x", "y", "z", *turned, *q] if self.kind == "ply" else [*q, "x", "y", "z", *turned]

    def header(self) -> bytes:
        """What stands before the first sample."""
        if self.kind == "csv":
            return csv_header(self.columns)
        if self.kind == "npy":
            stream = io.BytesIO()
            shape = self.count, len(self.columns)
            np.lib.format.write_array_header_1_0(stream, {"descr": "<f8", "fortran_order": False, "shape": shape})
            return stream.getvalue()
        if self.kind == "ply":
            name = (self.space.robot.id or self.space.robot.name).encode("ascii", "replace").decode()
            lines = [
                "ply",
                "format binary_little_endian 1.0",
                f"comment robokin: reachable positions of {name}",
                f"comment {self.sampling} sampling, seed {self.seed}",
                f"comment lengths in {self.units.length}, angles in {self.units.angle}",
                f"element vertex {self.count}",
                *(f"property double {name}" for name in self.columns),
                "end_header",
            ]
            return "".join(" ".join(line.split()) + "\n" for line in lines).encode()
        return b""

    def block(self, number: int) -> bytes:
        """The bytes of block `number`."""
        start = number * BLOCK
        count = min(BLOCK, self.count - start)
        if self.kind == "jsonl":
            return self._lines(*self._values(start, count))
        table = self.table(start, count)
        return csv_rows(table) if self.kind == "csv" else np.ascontiguousarray(table, dtype="<f8").tobytes()

    def _values(self, start: int, count: int) -> tuple[Array, Array, Array | None]:
        """Joint values, positions and, where they are asked for, poses of some samples, in the units."""
        q = joint_values(self.space, self.sampling, self.seed, start, count, self.samples, self.every)
        p = positions(self.space, q).T / self.units.metres + 0.0
        values = q.T / joint_factors(self.space.robot, self.units) + 0.0
        T = None
        if self.orientation is not None:
            T = forward_kinematics(self.space.robot, q.T)
            T[:, :3, 3] = p
            T += 0.0
        return values, p, T

    def table(self, start: int, count: int) -> Array:
        """(count, k) the samples from one on, in their columns."""
        values, p, T = self._values(start, count)
        turned = [orientation(T, self.orientation, self.units)] if T is not None and self.orientation else []
        joints = [values] if self.joints else []
        parts = [p, *turned, *joints] if self.kind == "ply" else [*joints, p, *turned]
        return np.concatenate(parts, axis=1)

    def write_rows(self, stream: IO[bytes], kind: str, tables: Iterable[Array]) -> int:
        """Write tables of samples as a Parquet or an Arrow file; the number of rows."""
        from robokin.tables.arrow_writer import ArrowWriter

        about = envelope("robot", self.space.robot.id, self.units)
        writer = ArrowWriter(stream, kind, [(name, "number") for name in self.columns], about)
        for table in tables:
            writer.columns(np.ascontiguousarray(table.T))
        return writer.close()

    def tables(self, first: int, count: int) -> Iterator[Array]:
        """The samples from one on, some at a time."""
        end = first + count
        return (self.table(start, min(TASK, end - start)) for start in range(first, end, TASK))

    def _lines(self, q: Array, p: Array, T: Array | None) -> bytes:
        """A JSON document a line."""
        start = json_line(envelope("robot", self.space.robot.id, self.units))[:-2]
        fields = [("q", _lists(q))] if self.joints else []
        fields.append(("position", _lists(p)))
        if T is not None:
            matrices = _lists(T.reshape(-1, 4))
            pose = [("matrix", [b"[%b, %b, %b, %b]" % rows for rows in zip(*[iter(matrices)] * 4, strict=True)])]
            pose.append(("position", fields[-1][1]))
            for kind in dict.fromkeys(["rpy", "quaternion", str(self.orientation)]):
                if kind != "matrix":
                    pose.append((kind.replace("-", "_"), _lists(orientation(T, kind, self.units))))
            fields.append(("pose", [b"{%b}" % text for text in _documents(pose)]))
        return b"".join(b"%b, %b}\n" % (start, text) for text in _documents(fields))

    def settings(self) -> dict[str, Any]:
        """What decides about the file's bytes."""
        robot, chain = self.space.robot, self.space.chain
        arrays = [chain.constants, chain.revolute, chain.offsets, self.space.low, self.space.high]
        if self.space.gears is not None:
            arrays += [self.space.gears.S, self.space.gears.cuts.G, self.space.gears.cuts.h]
        digest = hashlib.sha256(repr((robot.id, robot.name)).encode())
        for array in arrays:
            digest.update(np.ascontiguousarray(array).tobytes())
        return {
            "robot": robot.id or robot.name,
            "table": digest.hexdigest()[:16],
            "samples": self.samples,
            "seed": self.seed,
            "sampling": self.sampling,
            "joints": self.joints,
            "orientation": self.orientation,
            "length": self.units.length,
            "angle": self.units.angle,
            "block": BLOCK,
        }


def _lists(table: Array) -> list[bytes]:
    """The rows (m, k) of a table as JSON lists."""
    # Rows of CSV are what stands between the brackets.
    return [b"[%b]" % row for row in csv_rows(table).replace(b",", b", ").splitlines()]


def _documents(fields: list[tuple[str, list[bytes]]]) -> Iterator[bytes]:
    """What stands between the braces of JSON objects, from the names and the values of each field."""
    form = b", ".join(b'"%b": %%b' % name.encode() for name, _ in fields)
    return (form % values for values in zip(*(column for _, column in fields), strict=True))
