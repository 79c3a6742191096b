"""JSON, JSON lines and CSV."""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

from robokin.errors import visible
from robokin.tables.fast_json import pydantic_function

if TYPE_CHECKING:
    from robokin.arrays import Array


STEERING = re.compile(r"[\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]")
"""Characters that steer a terminal or the order of reading, and that JSON need not escape but may."""


def encode(text: str) -> bytes:
    """A text in UTF-8. What a file's name holds that is no text is written as \\udcxx, in JSON an escape too."""
    return text.encode(errors="backslashreplace")


def page(text: str) -> bytes:
    """A text for eyes, in which nothing but line breaks steers the terminal."""
    return encode(visible(text, lines=True))


def json_document(record: Any) -> bytes:
    """One JSON document, indented for eyes, its matrices a row a line; never NaN or Infinity."""
    return encode(_pretty(record, 0) + "\n")


def json_line(record: Any) -> bytes:
    """One JSON document on one line."""
    return encode(_dumped(record) + "\n")


def json_list(blocks: Iterable[Iterable[Any]]) -> Iterator[bytes]:
    """A JSON list of the records in all blocks, a record a line, written as the blocks come."""
    separator = b"[\n"
    for records in blocks:
        if lines := b",\n".join(json_line(record)[:-1] for record in records):
            yield separator + lines
            separator = b",\n"
    yield b"[]\n" if separator == b"[\n" else b"\n]\n"


def json_documents(records: Sequence[Any]) -> Iterator[bytes]:
    """The document of one record, or a list of several."""
    return iter([json_document(records[0])]) if len(records) == 1 else json_list([record] for record in records)


def written(
    kind: str, document: Any, lines: Iterable[Any], csv: Callable[[], bytes], page: Callable[[], bytes] | None = None
) -> Iterator[bytes]:
    """An answer in a format: its document as JSON, or `lines`, documents a line each, or what `csv` or `page` gives."""
    if kind == "json":
        yield json_document(document)
    elif kind == "jsonl":
        yield from map(json_line, lines)
    else:
        yield csv() if page is None or kind == "csv" else page()


def _dumped(value: Any) -> str:
    text = json.dumps(value, ensure_ascii=False, allow_nan=False)
    return text if text.isascii() and "\x7f" not in text else STEERING.sub(lambda c: f"\\u{ord(c[0]):04x}", text)


def _pretty(value: Any, indent: int) -> str:
    flat = _dumped(value)
    if not isinstance(value, (dict, list)) or not value:
        return flat
    nested = [item for item in (value.values() if isinstance(value, dict) else value) if isinstance(item, (dict, list))]
    short = len(flat) + indent <= 80 and not any(isinstance(item, dict) for item in nested)
    if not nested or short:
        return flat
    inner = " " * (indent + 2)
    if isinstance(value, dict):
        items = [f"{inner}{_dumped(key)}: {_pretty(item, indent + 2)}" for key, item in value.items()]
        return "{\n" + ",\n".join(items) + "\n" + " " * indent + "}"
    items = [inner + _pretty(item, indent + 2) for item in value]
    return "[\n" + ",\n".join(items) + "\n" + " " * indent + "]"


BOOLEANS = {True: "true", False: "false"}
"""Truth values in a CSV: the words of JSON."""


def csv_header(names: Iterable[str]) -> bytes:
    """The line with the columns' names."""
    return (",".join(names) + "\n").encode()


def csv_rows(table: Array) -> bytes:
    """Rows of numbers, a line each, every number with the fewest digits that give it back.

    pydantic's core, which Typer brings, writes them ten times faster than repr does. The digits are the
    same; an exponent looks like 1e-7 rather than 1e-07.
    """
    if not len(table):
        return b""
    rows = table.tolist()
    to_json = pydantic_function("to_json")
    if to_json is not None:
        return bytes(to_json(rows)[2:-2].replace(b"],[", b"\n") + b"\n")
    return "".join(",".join(map(repr, row)) + "\n" for row in rows).encode()


def csv_records(columns: Sequence[str] | None, rows: Iterable[Sequence[Any]]) -> bytes:
    """Rows of mixed values, quoted where they need it, below their header if there is one.

    Booleans are written as JSON has them, `true` and `false`; None is an empty cell.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    if columns is not None:
        writer.writerow(columns)
    writer.writerows([BOOLEANS[cell] if cell is True or cell is False else cell for cell in row] for row in rows)
    return encode(text.getvalue())
