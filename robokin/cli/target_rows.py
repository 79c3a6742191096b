"""Batches of targets: CSV as `fk` writes it, JSON lines, arrays."""

from __future__ import annotations

import io
import json
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from robokin.cli.array_rows import ARRAY_ROWS, ArrayReader, array_header
from robokin.cli.csv_rows import CsvReader
from robokin.cli.json_rows import JsonReader
from robokin.cli.lines import BYTE_ORDER_MARK, MAX_LINE, Columns
from robokin.cli.records import pose_columns
from robokin.cli.rows import open_input
from robokin.description.transforms import pose_from_matrix
from robokin.errors import InputError
from robokin.spatial import (
    nearest_rotation,
    rotation_error,
    rotation_from_euler,
    rotation_from_quaternion,
    rotation_from_rpy,
    transform,
)
from robokin.spatial.rotations import DIGITS_LOST
from robokin.spatial.transforms import FARTHEST
from robokin.units import Units

Array = NDArray[np.float64]

CLEAN = 1e-12
"""A rotation that is off by less holds nothing but rounding."""

KINDS = {16: "matrix", 7: "quaternion", 6: "rpy"}
"""What a row of so many numbers is, where no header says it."""

SHAPES = "expected numbers (m, 4, 4), (m, 16), (m, 7): x, y, z, qw, qx, qy, qz, or (m, 6): x, y, z, roll, pitch, yaw"


def read_targets(source: str, units: Units) -> Iterator[Array]:
    """Blocks of poses (m, 4, 4) [m] from a file or from standard input, as `robokin fk` writes them.

    CSV and arrays hold x, y, z with the columns of an orientation, or the 16 elements of a matrix; JSON lines
    hold matrices or such rows. Raises InputError with the number of the line that is wrong.
    """
    with open_input(source) as (stream, name):
        try:
            yield from _blocks(stream, name, units)
        except OSError as error:
            raise InputError(f"{name}: {error.strerror}, expected rows that can be read") from None


def _blocks(stream: Any, name: str, units: Units) -> Iterator[Array]:
    buffered: Any = stream if hasattr(stream, "peek") else io.BufferedReader(stream)
    ending = Path(name).suffix.lower()
    if ending == ".npy" or bytes(buffered.peek(8)).startswith(b"\x93NUMPY"):
        return _array_targets(buffered, name, units)
    lines = FirstLines(buffered)
    brace = lines.first.lstrip()[:1] in (b"{", b"[")
    if ending == ".jsonl" or (brace and ending != ".csv"):
        return _json_targets(lines, name, units)
    return _csv_targets(lines, name, units)


class FirstLines:
    """A stream whose first line with something on it has been looked at, and is still to be read."""

    def __init__(self, stream: Any) -> None:
        """Read up to that line."""
        self.stream = stream
        self.kept = b""
        self.first = b""
        while not self.first and (line := stream.readline(MAX_LINE)):
            self.kept += line
            text = line.removeprefix(BYTE_ORDER_MARK).strip()
            self.first = b"" if text.startswith(b"#") else text

    def read1(self, count: int) -> bytes:
        """What has been looked at, then the rest."""
        if self.kept:
            kept, self.kept = self.kept, b""
            return kept
        return bytes(self.stream.read1(count))


# CSV ------------------------------------------------------------------------------------------------------


class PoseReader(CsvReader):
    """A CSV of poses, which knows the line of each row of its last block."""

    text = b""
    start = 0

    def fast_csv(self, block: bytes) -> Array | None:
        """As a CsvReader; keeps the block."""
        self.text, self.start = block, self.line + 1
        return super().fast_csv(block)

    def line_of(self, row: int) -> int:
        """The line of a row of the block."""
        lines = (line.strip() for line in self.text.split(b"\n"))
        numbers = [number for number, line in enumerate(lines, self.start) if line and not line.startswith(b"#")]
        return numbers[row]


def _csv_targets(stream: Any, name: str, units: Units) -> Iterator[Array]:
    kind = _kind_of(stream.first.decode(errors="replace"))
    names = pose_columns(kind)[3:] if kind == "matrix" else pose_columns(kind)
    angles = (False,) * 3 + (kind in ("rpy", "euler"),) * (len(names) - 3)
    what = "the 16 elements of a matrix, row by row" if kind == "matrix" else ", ".join(names)
    reader = PoseReader(stream, name, Columns(names, names, angles, "target", what), units)
    for rows in reader.blocks():
        try:
            yield poses_from_rows(rows, kind, units)
        except BadRowError as bad:
            raise reader.error(reader.line_of(bad.row), bad.sentence) from None


def _kind_of(line: str) -> str:
    """Which orientation a CSV holds, by its first line."""
    cells = [cell.strip(' \t"') for cell in (line.split(",") if "," in line else line.split())]
    for kind, first in (("rpy", "roll"), ("matrix", "m11"), ("quaternion", "qw"), ("euler", "phi")):
        if first in cells:
            return kind
    return KINDS.get(len(cells), "rpy")


# JSON lines -----------------------------------------------------------------------------------------------


def _json_targets(stream: Any, name: str, units: Units) -> Iterator[Array]:
    reader = pose_documents(stream, name, units)
    for block in reader.text_blocks():
        lines = reader.decode(block, reader.line + 1).split("\n")
        poses = [
            _json_target(reader, line, number) for number, line in enumerate(lines, reader.line + 1) if line.strip()
        ]
        reader.line += len(lines)
        if poses:
            yield np.array(poses)


def pose_documents(stream: IO[bytes], name: str, units: Units) -> JsonReader:
    """A reader of JSON documents of poses."""
    return JsonReader(stream, name, Columns(("matrix",), (), (False,), "matrix", "a pose"), units)


def _json_target(reader: JsonReader, line: str, number: int) -> Array:
    try:
        document = json.loads(line)
    except (ValueError, RecursionError):
        raise reader.error(number, "this is not JSON, expected a pose such as robokin fk writes") from None
    try:
        return pose_in_document(document, reader, number)[0]
    except ValueError as error:
        raise reader.error(number, str(error)) from None


def pose_in_document(document: Any, reader: JsonReader, number: int = 1) -> tuple[Array, str]:
    """The pose (4, 4) [m] of a JSON document such as `fk`, `ik` and `frame` write, or of a list; and a note or "".

    Raises ValueError for what is none, InputError for units that are none.
    """
    units = reader.units
    if isinstance(document, dict):
        units = reader.stated_units(document.get("units"), number)
        for key in ("pose", "target"):
            if isinstance(document.get(key), dict):
                document = document[key]
        if document.get("task", "pose") != "pose":
            raise ValueError(f"found a target of the task {json.dumps(document['task'])[:40]}, expected a whole pose")
        if "matrix" not in document:
            raise ValueError("found no matrix, expected a pose such as robokin fk writes")
        document = document["matrix"]
    if not isinstance(document, list):
        raise ValueError(f"found {json.dumps(document)[:40]}, expected a 4×4 matrix or an object that holds one")
    flat = [value for value in document if isinstance(value, (int, float)) and not isinstance(value, bool)]
    if document and len(flat) == len(document) and len(flat) in KINDS:
        try:
            row = np.array([flat], dtype=np.float64)
            return poses_from_rows(row, KINDS[len(flat)], units)[0], ""
        except OverflowError:
            raise ValueError("found a number that is not finite, expected finite numbers") from None
        except BadRowError as bad:
            raise ValueError(bad.sentence) from None
    try:
        T, note = pose_from_matrix(document, units)
    except OverflowError:
        raise ValueError("found a number that is not finite, expected finite numbers") from None
    return near_enough(T, units), note


# Arrays ---------------------------------------------------------------------------------------------------


def _array_targets(stream: Any, name: str, units: Units) -> Iterator[Array]:
    shape, fortran, dtype = array_header(stream, name, SHAPES)
    inner = shape[1:] if len(shape) == 3 or (len(shape) == 2 and shape != (4, 4)) else shape
    if inner not in ((4, 4), (16,), (7,), (6,)) or dtype.kind not in "fiu":
        raise InputError(f"{name}: found an array of shape {shape} and type {dtype}, {SHAPES}")
    width = int(np.prod(inner))
    reader = ArrayReader(stream, name, 1 if inner == shape else shape[0], width, dtype)
    first = 1
    for rows in reader.fortran_blocks() if fortran else reader.plain_blocks():
        if fortran and inner == (4, 4):
            rows = rows.reshape(-1, 4, 4).swapaxes(1, 2).reshape(-1, 16)
        try:
            yield poses_from_rows(rows, KINDS[width], units)
        except BadRowError as bad:
            raise InputError(f"{name}, row {first + bad.row}: {bad.sentence}") from None
        first += ARRAY_ROWS


# Rows to poses --------------------------------------------------------------------------------------------


class BadRowError(Exception):
    """A row, counted from 0, that is no pose, and why."""

    def __init__(self, row: int, sentence: str) -> None:
        """`sentence` says what was found and what was expected."""
        self.row, self.sentence = row, sentence


def poses_from_rows(rows: Array, kind: str, units: Units) -> Array:
    """Poses (m, 4, 4) [m] from rows (m, k) in the units. Raises BadRowError for the first that is none."""
    finite = np.isfinite(rows).all(axis=1)
    if not finite.all():
        raise BadRowError(int(np.argmin(finite)), "found a number that is not finite, expected finite numbers")
    if kind == "matrix":
        return _poses_from_matrices(rows.reshape(-1, 4, 4), units)
    angles = rows[:, 3:]
    if kind == "quaternion":
        with np.errstate(over="ignore"):
            length = np.linalg.norm(angles, axis=1)
        wrong = ~(np.abs(length - 1.0) <= DIGITS_LOST)
        if wrong.any():
            row = int(np.argmax(wrong))
            raise BadRowError(row, f"found a quaternion of length {length[row]:.6g}, expected 1")
        R = rotation_from_quaternion(angles / length[:, None])
    else:
        R = (rotation_from_rpy if kind == "rpy" else rotation_from_euler)(angles * units.radians)
    return near_enough(transform(R, rows[:, :3] * units.metres), units)


def _poses_from_matrices(M: Array, units: Units) -> Array:
    with np.errstate(all="ignore"):  # of great numbers the products overflow, and are refused
        off = rotation_error(M[:, :3, :3])
        wrong = ~(off <= DIGITS_LOST) | (M[:, 3] != [0.0, 0.0, 0.0, 1.0]).any(axis=1)
    R = M[:, :3, :3]
    for row in np.flatnonzero(wrong):
        try:
            R[row] = pose_from_matrix(M[row], units)[0][:3, :3]
        except ValueError as error:
            raise BadRowError(int(row), str(error)) from None
    cut = off > CLEAN
    if cut.any():
        R[cut] = nearest_rotation(R[cut])
    return near_enough(transform(R, M[:, :3, 3] * units.metres), units)


def near_enough(T: Array, units: Units) -> Array:
    """Poses (..., 4, 4) [m] as they are. Raises BadRowError, or ValueError for one, when they are too far away."""
    far = ~(np.abs(T[..., :3, 3]) <= FARTHEST).all(axis=-1)
    if far.any():
        sentence = f"found a target too far away, expected less than {FARTHEST / units.metres:g} {units.length}"
        if T.ndim == 2:
            raise ValueError(sentence)
        raise BadRowError(int(np.argmax(far)), sentence)
    return T
