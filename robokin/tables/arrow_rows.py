"""Rows of numbers from Parquet and Arrow files, a batch at a time.

Columns are found by their names, as below the header of a CSV. A file that states its units, as those that robokin
writes do, is read in them.
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from copy import copy
from itertools import compress
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robokin.arrays import Array
from robokin.errors import InputError, shown
from robokin.files import HeededStream
from robokin.tables.arrow_library import kind_of_start, pyarrow
from robokin.tables.carried import Carried
from robokin.tables.json_rows import stated_units
from robokin.tables.text_source import Say
from robokin.tables.wanted_columns import Wanted, factors

ARROW_ROWS = 8192
"""Rows that are handed on at once."""

ABOUT = b"robokin"
"""The key of a schema's metadata below which robokin says, in JSON, what a table is about."""

PIECE = 1 << 20
"""Bytes taken at once of a pipe, whose content has to be in a file before its end can be read."""


@contextmanager
def refused_as_input(name: str, what: str) -> Iterator[None]:
    """What Arrow says against a file becomes an InputError."""
    try:
        yield
    except InputError:
        raise
    except (pyarrow().ArrowException, OSError, ValueError, LookupError, NotImplementedError, MemoryError) as error:
        reason = str(error).partition("\n")[0] or type(error).__name__
        raise InputError(f"{name}: this is no whole {what} file ({shown(reason)}), expected rows below names") from None


class ArrowBatches:
    """A stream that is a Parquet or an Arrow file: its schema and its rows, a batch at a time."""

    def __init__(self, stream: Any, name: str, kind: str) -> None:
        """kind: parquet or arrow, as the name's ending or the first bytes say. Raises InputError."""
        self.name = name
        self.what = {"parquet": "Parquet", "arrow": "Arrow"}[kind]
        self.kept: Any = None
        """A temporary file that holds what came through a pipe."""
        self.file: Any = None
        self.reader: Any = None
        arrow = pyarrow()
        with refused_as_input(name, self.what):
            head = bytes(stream.peek(8)[:8])
            if kind_of_start(head) != kind:
                raise ValueError("it begins otherwise")
            if kind == "arrow" and not head.startswith(b"ARROW1"):
                self.reader = pyarrow("pyarrow.ipc").open_stream(arrow.PythonFile(_Source(stream), mode="r"))
                self.schema = self.reader.schema
                return
            if not stream.seekable():
                stream = self.kept = _kept(stream)
            source = arrow.PythonFile(stream, mode="r")
            if kind == "arrow":
                self.file = pyarrow("pyarrow.ipc").open_file(source)
                self.schema = self.file.schema
            else:
                self.file = pyarrow("pyarrow.parquet").ParquetFile(source)
                self.schema = self.file.schema_arrow

    @property
    def names(self) -> list[str]:
        """The columns."""
        return list(self.schema.names)

    def about(self) -> dict[str, Any]:
        """What the schema says of the table below the key of robokin; nothing where it is of another program."""
        try:
            found = json.loads((self.schema.metadata or {}).get(ABOUT, b"{}"))
        except (ValueError, RecursionError):
            return {}
        return found if isinstance(found, dict) else {}

    def batches(self, places: Sequence[int]) -> Iterator[Any]:
        """The columns at some places, a batch of rows at a time. Raises InputError for a file that is damaged."""
        names = [self.names[place] for place in places]
        try:
            with refused_as_input(self.name, self.what):
                yield from self._parquet(names) if self.what == "Parquet" else self._arrow(names)
        finally:
            if self.kept is not None:
                self.kept.close()

    def _parquet(self, names: list[str]) -> Iterator[Any]:
        for batch in self.file.iter_batches(batch_size=ARROW_ROWS, columns=names, use_threads=False):
            yield batch.select(names)

    def _arrow(self, names: list[str]) -> Iterator[Any]:
        if self.reader is not None:
            whole: Any = iter(self.reader)
        else:
            whole = (self.file.get_batch(number) for number in range(self.file.num_record_batches))
        for batch in whole:
            batch.validate(full=True)
            for start in range(0, batch.num_rows, ARROW_ROWS):
                yield batch.select(names).slice(start, ARROW_ROWS)


class _Source:
    """A stream as Arrow reads one that has no way back."""

    def __init__(self, stream: Any) -> None:
        self.stream = stream if stream.seekable() else HeededStream(stream)
        self.closed = False

    def read(self, most: int) -> bytes:
        """So many bytes, or fewer at the end."""
        parts, left = [], most
        while left > 0 and (part := self.stream.read(left)):
            parts.append(part)
            left -= len(part)
        return b"".join(parts)

    def readable(self) -> bool:
        """It is."""
        return True


def _kept(stream: Any) -> Any:
    """What a pipe holds, in a temporary file."""
    source, kept = _Source(stream), tempfile.TemporaryFile()  # noqa: SIM115 - it is read for as long as its reader lives
    while part := source.read(PIECE):
        kept.write(part)
    kept.seek(0)
    return kept


class ArrowReader:
    """A file whose rows hold numbers below names; what is not understood goes to `carried`."""

    def __init__(self, stream: Any, name: str, kind: str, wanted: Wanted, carried: Carried, say: Say) -> None:
        """Raises InputError for what is no such file, and where the wanted columns are not in it."""
        self.name, self.wanted, self.carried, self.say = name, wanted, carried, say
        self.source = ArrowBatches(stream, name, kind)
        names = self.source.names
        try:
            # A column's own unit counts before that of its file, and that before the command's.
            stated = copy(wanted)
            stated.units = stated_units(self.source.about().get("units"), wanted.units)
            self.found = stated.headed(names)
            self.factors = factors(self.found, wanted.units)
        except InputError as error:
            raise InputError(f"{name}: {error}") from None
        for place in self.found.places:
            self._check_type(place)
        passed = carried.choose(names, self.found.places)
        kept = [(place, called) for place, called in zip(passed, carried.names, strict=True) if self._passes(place)]
        self.passed = [place for place, _ in kept]
        carried.names = tuple(called for _, called in kept)
        carried.kinds = tuple(kind_of_cells(self.source.schema.field(place).type) for place in self.passed)
        carried.typed = True
        self.solution = names.index("solution") if {"solution", "target"} <= {*names} else None
        self.unsolved = 0
        """How many rows said that inverse kinematics had no solution: they hold no configuration."""
        self.row_lines: Sequence[int] | NDArray[np.int64] = ()
        """The number of each row of the last block, from 1."""

    def error(self, row: int, message: str) -> InputError:
        """An error that names the file and the row."""
        return InputError(f"{self.name}, row {row}: {message}")

    def rows(self) -> Iterator[Array]:
        """Blocks (m, k) of the wanted columns. Raises InputError with the number of a row that has no number."""
        places = [*self.found.places, *self.passed]
        places = [*dict.fromkeys(places if self.solution is None else [*places, self.solution])]
        first = 1
        for batch in self.source.batches(places):
            numbers = np.arange(first, first + batch.num_rows)
            first += batch.num_rows
            answered = np.ones(batch.num_rows, dtype=bool)
            if self.solution is not None:
                answered = ~self._none(batch.column(places.index(self.solution)))
                self.unsolved += int(np.sum(~answered))
            if not answered.any():
                continue
            self.row_lines = numbers[answered]
            kept = pyarrow().array(answered)
            columns = [batch.column(places.index(place)).filter(kept) for place in self.found.places]
            block = np.stack([self._numbers(column, i) for i, column in enumerate(columns)], axis=1)
            if self.passed:  # chosen as values: Arrow chooses no texts of polars
                cells = [cells_of(batch.column(places.index(place))) for place in self.passed]
                self.carried.put(list(compress(zip(*cells, strict=True), answered)))
            yield block

    def _none(self, column: Any) -> Any:
        """(m,) which rows of the column `solution` say that there is none."""
        return np.array([value in (0, "0") for value in column.to_pylist()], dtype=bool)

    def _numbers(self, column: Any, i: int) -> Array:
        """A wanted column (m,) in the wanted units."""
        heading = shown(self.source.names[self.found.places[i]])
        if column.null_count:
            row = int(np.argmax(column.is_null().to_numpy(zero_copy_only=False)))
            raise self.error(int(self.row_lines[row]), f"found nothing in the column '{heading}', expected a number")
        with np.errstate(over="ignore"):
            values = _doubles(column).to_numpy(zero_copy_only=False)
        finite = np.isfinite(values)
        if not finite.all():
            row = int(np.argmin(finite))
            said = f"found {values[row]} in the column '{heading}', expected a finite number"
            raise self.error(int(self.row_lines[row]), said)
        return np.asarray(values * self.factors[i] if self.factors is not None else values)

    def _check_type(self, place: int) -> None:
        """Raises InputError for a column that has no numbers."""
        field = self.source.schema.field(place)
        if kind_of_type(field.type) not in ("number", "whole"):
            said = f"found values of type {shown(str(field.type))} in the column '{shown(field.name)}'"
            raise InputError(f"{self.name}: {said}, expected numbers")

    def _passes(self, place: int) -> bool:
        """Whether a column that is not understood goes through: lists and bytes have no cell."""
        field = self.source.schema.field(place)
        if kind_of_cells(field.type):
            return True
        self.say(f"the column '{shown(field.name)}' is left out, since its type is {shown(str(field.type))}")
        return False


def kind_of_type(of: Any) -> str:
    """What a column of an Arrow type holds: number, whole, truth, text; "" for what is none of these."""
    types = pyarrow("pyarrow.types")
    if types.is_dictionary(of):
        return kind_of_type(of.value_type)
    if types.is_boolean(of):
        return "truth"
    if types.is_integer(of):
        return "whole"
    if types.is_floating(of) or types.is_decimal(of):
        return "number"
    texts = (types.is_string, types.is_large_string, types.is_string_view, types.is_null)
    times = (types.is_date, types.is_time, types.is_timestamp)
    return "text" if any(one(of) for one in (*texts, *times)) else ""


def kind_of_cells(of: Any) -> str:
    """What the cells of a column hold that goes through: numbers with more digits than others have are text."""
    types = pyarrow("pyarrow.types")
    return "text" if types.is_decimal(of) or types.is_uint64(of) else kind_of_type(of)


def _plain(column: Any) -> Any:
    """A column without a dictionary."""
    if not pyarrow("pyarrow.types").is_dictionary(column.type):
        return column
    words = column.dictionary
    if pyarrow("pyarrow.types").is_string_view(words.type):  # of polars: Arrow takes none by number
        column = pyarrow().DictionaryArray.from_arrays(column.indices, words.cast("large_string"))
    return column.dictionary_decode()


def _doubles(column: Any) -> Any:
    """A column of numbers as the doubles that are nearest, which Arrow's own cast of decimal numbers is not."""
    column = _plain(column)
    if pyarrow("pyarrow.types").is_decimal(column.type):
        column = column.cast("string")
    return column.cast("float64", safe=False)


def cells_of(column: Any) -> list[Any]:
    """The values of a column as JSON has them; what has a date or a time is text."""
    column = _plain(column)
    kind = kind_of_cells(column.type)
    if kind == "text":
        column = column.cast("string")
    elif kind == "number":
        column = column.cast("float64", safe=False)
    values = column.to_pylist()
    # No JSON has them, and a CSV no other word for them.
    return [None if kind == "number" and value is not None and not np.isfinite(value) else value for value in values]
