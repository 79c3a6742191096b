"""Tables written as Parquet or Arrow files, in groups of rows that do not hang on the blocks in which the rows come."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable, Sequence
from typing import IO, Any

from robokin.errors import OutputError
from robokin.tables.arrow_library import pyarrow
from robokin.tables.arrow_rows import ABOUT
from robokin.tables.carried import Carried

GROUP = 1 << 16
"""Rows of a group: what a reader takes at once."""

TYPES = {"number": "float64", "whole": "int64", "truth": "bool", "text": "string"}
"""Arrow's types, by what a column holds."""

OWN_KINDS = {"target": "whole", "solution": "whole", "rank": "whole", "within_limits": "truth", "branch": "text",
             "reason": "text", "jump": "truth"}  # fmt: skip
"""What columns of answers hold that are no numbers with fractions."""


class ArrowWriter:
    """Writes rows one block after the other.

    kind: parquet or arrow; on a stream that has no way back Arrow's format of streams is written. columns: their names
    and what they hold (number, whole, truth, text); about: what the schema says of them under the key `robokin`.
    """

    def __init__(self, stream: IO[bytes], kind: str, columns: Sequence[tuple[str, str]], about: dict[str, Any]) -> None:
        arrow = pyarrow()
        self.schema = arrow.schema(
            [arrow.field(name, TYPES[held]) for name, held in columns],
            metadata={ABOUT: json.dumps(about, ensure_ascii=False).encode(errors="backslashreplace")},
        )
        self.waiting: list[Any] = []
        self.rows = 0
        """Rows that wait for their group to be whole."""
        self.written = 0
        """Rows that do not wait any more."""
        self.sink = arrow.PythonFile(_ArrowSink(stream), mode="w")
        if kind == "parquet":
            texts = [name for name, held in columns if held == "text"]
            packed = {name: "none" if held == "number" else "snappy" for name, held in columns}
            self.writer = pyarrow("pyarrow.parquet").ParquetWriter(
                self.sink, self.schema, use_dictionary=texts or False, compression=packed or "none"
            )
        else:
            ipc = pyarrow("pyarrow.ipc")
            new = ipc.new_file if stream.seekable() else ipc.new_stream
            self.writer = new(self.sink, self.schema)

    def columns(self, columns: Iterable[Any]) -> None:
        """Write a block by its columns: arrays, also masked ones, or lists whose None is nothing."""
        arrow = pyarrow()
        arrays = [arrow.array(column, type=field.type) for column, field in zip(columns, self.schema, strict=True)]
        self.batch(arrow.record_batch(arrays, schema=self.schema))

    def batch(self, batch: Any) -> None:
        """Write a block of rows of the schema."""
        self.waiting.append(batch)
        self.rows += batch.num_rows
        while self.rows >= GROUP:
            self._write(GROUP)

    def _write(self, count: int) -> None:
        """Write the first rows of those that wait, as one group."""
        table = pyarrow().Table.from_batches(self.waiting, schema=self.schema).combine_chunks()
        group, rest = table.slice(0, count), table.slice(count)
        # Arrow's formats write batches as they are: each of them is one piece.
        for batch in group.combine_chunks().to_batches(max_chunksize=GROUP):
            self.writer.write_batch(batch)
        self.written += count
        self.waiting, self.rows = rest.to_batches(), rest.num_rows

    def close(self) -> int:
        """Write the last group and what stands at the end; the rows of the table."""
        if self.rows:
            self._write(self.rows)
        self.writer.close()
        self.sink.close()
        return self.written


class _ArrowSink:
    """A stream that is written from where it stands, and is not closed with the table."""

    def __init__(self, stream: IO[bytes]) -> None:
        self.stream, self.size, self.closed = stream, 0, False

    def write(self, data: Any) -> int:
        """Write some bytes."""
        size = memoryview(data).nbytes
        self.stream.write(data)
        self.size += size
        return size

    def tell(self) -> int:
        """How many bytes there are."""
        return self.size

    def flush(self) -> None:
        """Hand on what is written."""
        self.stream.flush()

    def close(self) -> None:
        """No more is written."""
        self.closed = True

    def writable(self) -> bool:
        """It is."""
        return True

    def seekable(self) -> bool:
        """It is not."""
        return False


def write_csv_as(kind: str, pieces: Iterable[bytes], stream: IO[bytes], carried: Carried, about: dict[str, Any]) -> int:
    """Write a CSV that comes in pieces of whole records, the header first, as a Parquet or an Arrow file; its rows.

    carried: the columns that go through, which stand first. An empty cell of anything
    but text is nothing. Raises OutputError where a cell does not hold what its column does.
    """
    writer: ArrowWriter | None = None
    for piece in pieces:
        if not piece:
            continue
        skipped = 0
        if writer is None:
            names = next(csv.reader(io.StringIO(piece.decode())))
            writer, skipped = ArrowWriter(stream, kind, columns_of(names, carried), about), 1
        for batch in _parsed(piece, writer.schema, skipped):
            writer.batch(batch)
    return writer.close() if writer is not None else 0


def columns_of(names: Sequence[str], carried: Carried) -> list[tuple[str, str]]:
    """The columns of a table and what they hold; those that are carried stand first."""
    through = len(carried.names)
    kinds = carried.kinds or ("text",) * through
    own = [(name, OWN_KINDS.get(name, "number")) for name in names[through:]]
    return [*zip(names[:through], kinds, strict=True), *own]


def _parsed(piece: bytes, schema: Any, skipped: int) -> list[Any]:
    """The records of a CSV below `skipped` records as batches of a schema."""
    arrow, reader = pyarrow(), pyarrow("pyarrow.csv")
    reading = {"column_names": schema.names, "skip_rows_after_names": skipped, "block_size": 2 * len(piece) + (1 << 16)}
    cells = {"null_values": [""], "strings_can_be_null": False, "true_values": ["true"], "false_values": ["false"]}
    try:
        table = reader.read_csv(
            arrow.BufferReader(piece),
            reader.ReadOptions(use_threads=False, **reading),
            reader.ParseOptions(newlines_in_values=True, ignore_empty_lines=False),
            reader.ConvertOptions(column_types=schema, **cells),
        )
    except (arrow.ArrowException, ValueError) as error:
        reason = str(error).partition("\n")[0]
        raise OutputError(f"found a row that is none of the table ({reason}), expected its columns") from None
    return list(table.cast(schema).to_batches())
