"""Batches of targets: CSV as `fk` writes it, JSON, arrays."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError, shown
from robokin.files import open_input
from robokin.formats.printed_matrices import pose_from_matrix
from robokin.tables.array_rows import ArrayReader, array_header
from robokin.tables.carried import Carried
from robokin.tables.csv_rows import CsvReader
from robokin.tables.json_documents import DocumentReader
from robokin.tables.json_rows import Passing, stated_units
from robokin.tables.near_targets import BadRowError, near_enough
from robokin.tables.orientations import ORIENTATIONS
from robokin.tables.pose_columns import PLACES, PLANE, WAYS, PoseColumns, poses_from_rows
from robokin.tables.rows import kind_of_stream, places_of
from robokin.tables.text_source import ROWS, Say
from robokin.tables.wanted_columns import factors
from robokin.units import Units

if TYPE_CHECKING:
    from robokin.tables.arrow_rows import ArrowReader

SHAPES = "expected numbers (m, 4, 4), (m, 16), (m, 6): x, y, z, roll, pitch, yaw, or (m, 3): x, y, z"
IN_PLANE = ", or (m, 2): x, y"


class Targets:
    """Poses from a file or from standard input, as `robokin fk` and `robokin ik` write them.

    CSV and arrays hold x, y, z with the columns of an orientation or alone, or the 16 elements of a matrix; JSON
    holds matrices or such rows. `kind` is the orientation of rows that do not say it themselves; `plane` the pose
    (4, 4) [m] at zero of an arm that moves in the plane of x and y: its targets may be x, y, phi or x, y.
    """

    def __init__(
        self, source: str, units: Units, kind: str | None, carried: Carried, say: Say, *, plane: Array | None = None
    ) -> None:
        self.source, self.units, self.kind, self.carried, self.say = source, units, kind, carried, say
        self.plane = plane
        self.task = ""
        """What is asked of the tool (pose, position or approach); known when the first block has come."""

    def blocks(self) -> Iterator[Array]:
        """Blocks of poses (m, 4, 4) [m]. Raises InputError with the number of the line that is wrong."""
        for place in places_of(self.source):
            with open_input(place, ROWS) as (stream, name):
                yield from self.blocks_in(stream, name)

    def blocks_in(self, stream: Any, name: str) -> Iterator[Array]:
        """The same from a stream with this name."""
        try:
            kind, buffered = kind_of_stream(stream, name)
            if kind in ("parquet", "arrow"):
                yield from self._arrow(kind, buffered, name)
            else:
                yield from {"npy": self._arrays, "json": self._json, "csv": self._csv}[kind](buffered, name)
        except OSError as error:
            raise InputError(f"{name}: {error.strerror}, expected rows that can be read") from None

    def _csv(self, stream: Any, name: str) -> Iterator[Array]:
        wanted = PoseColumns(self.units, self.kind, self.plane)
        yield from self._rows_of(CsvReader(stream, name, wanted, self.carried, self.say))

    def _arrow(self, kind: str, stream: Any, name: str) -> Iterator[Array]:
        from robokin.tables.arrow_rows import ArrowReader

        wanted = PoseColumns(self.units, self.kind, self.plane)
        yield from self._rows_of(ArrowReader(stream, name, kind, wanted, self.carried, self.say))

    def _rows_of(self, reader: CsvReader | ArrowReader) -> Iterator[Array]:
        """The poses of rows below names."""
        for rows in reader.rows():
            assert reader.found is not None
            kind = reader.found.way.kind
            self.task = "position" if kind in PLACES else "pose"
            try:
                yield poses_from_rows(rows, kind, self.units, self.plane)
            except BadRowError as bad:
                raise reader.error(reader.row_lines[bad.row], bad.sentence) from None

    def _json(self, stream: Any, name: str) -> Iterator[Array]:
        reader = DocumentReader(stream, name, "expected a pose such as robokin fk writes", self.say)
        passing = Passing(self.carried)
        for documents in reader.documents():
            poses = []
            for line, document in documents:
                try:
                    for one in _each(document):
                        T, task, _ = pose_of(one, self.units, self.kind, self.plane)
                        self.task = self.task or task
                        if task != self.task:
                            raise ValueError(f"found a target of the task {task}, expected {self.task} as before")
                        poses.append(T)
                        used = _used(one, self.units, self.kind, self.plane)
                        passing.add(one if isinstance(one, dict) else {}, used, 1)
                except ValueError as error:
                    raise reader.error(line, str(error)) from None
            if poses:
                yield np.array(poses)

    def _arrays(self, stream: Any, name: str) -> Iterator[Array]:
        flat = ((2,),) if self.plane is not None and self.kind is None else ()
        shapes = SHAPES + IN_PLANE if flat else SHAPES
        shape, fortran, dtype = array_header(stream, name, shapes)
        inner = shape[1:] if len(shape) == 3 or (len(shape) == 2 and shape != (4, 4)) else shape
        if inner not in ((4, 4), (16,), (7,), (6,), (3,), *flat):
            raise InputError(f"{name}: found an array of shape {shown(str(shape))}, {shapes}")
        width = math.prod(inner)
        try:
            way = WAYS["matrix"] if inner == (4, 4) else PoseColumns(self.units, self.kind, self.plane).bare(width)
        except InputError as error:
            raise InputError(f"{name}: {error}") from None
        if len(way.columns) != width:
            raise InputError(
                f"{name}: found an array of shape {shown(str(shape))}, expected rows of {', '.join(way.names)}"
            )
        self.task = "position" if way.kind in PLACES else "pose"
        first = 1
        for rows in ArrayReader(stream, name, 1 if inner == shape else shape[0], inner, dtype, fortran).blocks():
            try:
                yield poses_from_rows(rows, way.kind, self.units, self.plane)
            except BadRowError as bad:
                raise InputError(f"{name}, row {first + bad.row}: {bad.sentence}") from None
            first += len(rows)


def _each(document: Any) -> list[Any]:
    """The targets of a document: itself, or the elements of a list that is no matrix and no row of numbers."""
    if isinstance(document, list) and document:
        objects = all(isinstance(one, dict) for one in document)
        rows = all(isinstance(one, list) for one in document) and (
            {len(one) for one in document} not in ({3}, {4}) or len(document) > 4
        )
        if objects or rows:
            return document
    return [document]


def _used(document: Any, units: Units, kind: str | None, plane: Array | None) -> list[str]:
    """The keys of an object that its pose was taken from."""
    if not isinstance(document, dict) or _pose_part(document) is not document or "matrix" in document:
        return []
    if "position" in document:
        return list(JSON_KEYS)
    names = list(document)
    return [names[i] for i in PoseColumns(units, kind, plane).headed(names).places]


JSON_KEYS = {kind.replace("-", "_"): kind for kind in ORIENTATIONS}
"""What a document calls the ways to say an orientation."""


def _pose_part(document: dict[str, Any]) -> dict[str, Any]:
    for key in ("pose", "target"):
        if isinstance(document.get(key), dict):
            part: dict[str, Any] = document[key]
            return part
    return document


def pose_of(document: Any, units: Units, kind: str | None = None, plane: Array | None = None) -> tuple[Array, str, str]:
    """The pose (4, 4) [m] of a JSON document such as `fk`, `ik` and `frame` write, or of a list.

    Also what is asked of the tool (pose, position or approach), and a note or "". `plane` is as in `Targets`. Raises
    ValueError for what is none.
    """
    task = "pose"
    if isinstance(document, dict):
        units = stated_units(document.get("units"), units)
        document = _pose_part(document)
        task = document.get("task", "pose")
        if task not in ("pose", "position", "approach"):
            raise ValueError(f"found a target of the task {json.dumps(task)[:40]}, expected pose, position or approach")
        if "matrix" not in document:
            return (*_by_names(document, units, kind, plane), "")
        document = document["matrix"]
    if not isinstance(document, list):
        raise ValueError(f"found {json.dumps(document)[:40]}, expected a 4×4 matrix or an object that holds one")
    if document and all(_is_number(value) for value in document):
        way = PoseColumns(units, kind, plane).bare(len(document))
        if len(document) != len(way.columns):
            raise ValueError(f"found {len(document)} numbers, expected {', '.join(way.names)}")
        T = _row(document, way.kind, units, plane)
        return T, "position" if way.kind in PLACES else task, ""
    try:
        T, note = pose_from_matrix(document, units)
    except OverflowError:
        raise ValueError("found a number that is not finite, expected finite numbers") from None
    return near_enough(T, units), task, note


def _by_names(document: dict[str, Any], units: Units, kind: str | None, plane: Array | None) -> tuple[Array, str]:
    """The pose of an object without a matrix: `position` and an orientation, or the columns of a table."""
    if "position" in document:
        said = [JSON_KEYS[key] for key in document if key in JSON_KEYS]
        taken = kind or (said[0] if said else "position")
        parts = [document["position"], [] if taken == "position" else document.get(taken.replace("-", "_"), [])]
        if not all(isinstance(part, list) for part in parts) or not all(map(_is_number, [*parts[0], *parts[1]])):
            raise ValueError(f"found {json.dumps(parts)[:60]}, expected lists of numbers")
        row = [*parts[0], *parts[1]]
        if taken == "position" and len(row) == 2 and plane is not None:
            return _row(row, PLANE.kind, units, plane), "position"
        expected = 3 if taken == "position" else len(WAYS[taken].columns)
        if len(row) != expected:
            raise ValueError(f"found {len(row)} numbers of a position and its {taken}, expected {expected}")
        return _row(row, taken, units), "position" if taken == "position" else "pose"
    names = list(document)
    try:
        found = PoseColumns(units, kind, plane).headed(names)
    except InputError as error:
        raise ValueError(f"found no matrix, expected a pose such as robokin fk writes; or by names: {error}") from None
    values = [document[names[i]] for i in found.places]
    if not all(map(_is_number, values)):
        raise ValueError(f"found {json.dumps(values)[:60]}, expected numbers")
    scale = factors(found, units)
    row = values if scale is None else (np.array(values, dtype=np.float64) * scale).tolist()
    return _row(row, found.way.kind, units, plane), "position" if found.way.kind in PLACES else "pose"


def _row(values: list[Any], kind: str, units: Units, plane: Array | None = None) -> Array:
    try:
        T: Array = poses_from_rows(np.array([values], dtype=np.float64), kind, units, plane)[0]
    except OverflowError:
        raise ValueError("found a number that is not finite, expected finite numbers") from None
    except BadRowError as bad:
        raise ValueError(bad.sentence) from None
    return T


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def one_pose(stream: Any, name: str, source: str, units: Units, say: Say) -> Array:
    """The only pose (4, 4) [m] of a stream that --matrix names. Raises InputError where it has none or several."""
    targets = Targets(source, units, None, Carried((), say, wanted=False), say)
    poses = [T for block in targets.blocks_in(stream, name) for T in block[:2]]
    if len(poses) != 1:
        raise InputError(f"--matrix {source}: found {len(poses)} poses, expected one; --input {source} reads many")
    if targets.task != "pose":
        raise InputError(f"--matrix {source}: found a target of the task {targets.task}, expected a whole pose")
    T: Array = poses[0]
    return T
