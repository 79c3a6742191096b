"""JSON, JSON lines and CSV."""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from types import ModuleType
from typing import TYPE_CHECKING, Any

from robokin.errors import visible
from robokin.tables.fast_json import pydantic_function

if TYPE_CHECKING:
    from robokin.arrays import Array


STEERING = re.compile(r"[\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]")
"""Characters that steer a terminal or the order of reading, and that JSON need not escape but may."""


WIDTH = 80
"""Columns of a line of a document that may stay one."""

ENCODER = json.JSONEncoder(ensure_ascii=False, allow_nan=False)
"""Made once: json.dumps makes one for each document."""


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
    text = ENCODER.encode(value)
    return text if text.isascii() and "\x7f" not in text else STEERING.sub(lambda c: f"\\u{ord(c[0]):04x}", text)


def _pretty(value: Any, indent: int) -> str:
    flat = _dumped(value)
    if not isinstance(value, (dict, list)) or not value:
        return flat
    nested = [item for item in (value.values() if isinstance(value, dict) else value) if isinstance(item, (dict, list))]
    short = len(flat) + indent <= WIDTH and not any(isinstance(item, dict) for item in nested)
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
    """Rows of numbers (m, k), a line each, every number with the fewest digits that give it back.

    Numbers look as JSON's do, 1e-7 and 0.00001 where repr has 1e-07 and 1e-05. Without the native kernel pydantic's
    core, which Typer brings, writes them three times faster than repr does.
    """
    if not len(table):
        return b""
    native = _kernel()
    if native is not None:
        lines: bytes = native.text_of_rows(table)
        return lines
    to_json = pydantic_function("to_json")
    if to_json is None or not table.shape[1]:
        return "".join(",".join(map(_number, row)) + "\n" for row in table.tolist()).encode()
    import numpy as np

    signs = bytearray(to_json(table.ravel().tolist()))
    signs[-1:] = b","
    places = np.frombuffer(signs, dtype=np.uint8)
    places[np.flatnonzero(places == COMMA)[table.shape[1] - 1 :: table.shape[1]]] = END_OF_LINE
    text = bytes(memoryview(signs)[1:])
    # Older cores write 1e16 for 1e+16.
    return UNSIGNED.sub(rb"e+\1", text) if b"e" in text else text


COMMA, END_OF_LINE = b",\n"


def number_lines(table: Array) -> list[str]:
    """Rows of numbers (m, k) as `csv_records` writes them, by repr, without the ends of the lines."""
    native = _kernel()
    if native is None:
        return [",".join(map(repr, row)) for row in table.tolist()]
    import numpy as np

    lines: list[str] = native.text_of_rows(table).decode("ascii").split("\n")
    lines.pop()
    # The kernel has other words for these than repr, or may have: 1e-7 for 1e-07, NaN for nan.
    size = np.abs(table)
    same = ((size >= 1e-3) & (size < 1e15)) | (size <= 1e-10)
    for row in np.flatnonzero(~same.all(axis=1)).tolist():
        lines[row] = ",".join(map(repr, table[row].tolist()))
    return lines


def _kernel() -> ModuleType | None:
    """The native kernel; it is loaded with numpy, and so not before there are rows."""
    from robokin.kernel.native_kernel import native

    return native


UNSIGNED = re.compile(rb"e(\d)")
"""An exponent without a sign."""

WORDS = {"nan": "NaN", "inf": "Infinity", "-inf": "-Infinity"}
"""What is no number, and JSON's words for it."""


def _number(x: float) -> str:
    """A number as pydantic's core writes it."""
    text = repr(x)
    if 1e-5 <= abs(x) < 1e-4:
        digits, _, exponent = text.lstrip("-").partition("e")
        if exponent:
            return "-" * (x < 0) + "0.0000" + digits.replace(".", "")
    return WORDS.get(text) or re.sub(r"e([-+])0", r"e\1", text)


FORMULA = re.compile(r"[=+\-@\t\r\n＝＋－＠]")
"""What a text begins with that a spreadsheet would run as a formula."""


def no_formula(cell: Any) -> Any:
    """A cell that no spreadsheet runs: a text that begins like a formula, and is no number, gets a ' before it."""
    if not isinstance(cell, str) or not FORMULA.match(cell):
        return cell
    try:
        float(cell)
    except ValueError:
        return f"'{cell}"
    return cell


def csv_without_formulas(columns: Sequence[str], rows: Iterable[Sequence[Any]]) -> bytes:
    """The same as `csv_records` for texts that strangers wrote, such as names of files and of students."""
    return csv_records(columns, (map(no_formula, row) for row in rows))


def csv_cell(text: str) -> str:
    """A text as a cell among others, quoted where it needs it."""
    written = io.StringIO()
    csv.writer(written, lineterminator="").writerow([text, ""])
    return written.getvalue()[:-1]


def csv_records(columns: Sequence[str] | None, rows: Iterable[Iterable[Any]]) -> bytes:
    """Rows of mixed values, quoted where they need it, below their header if there is one.

    Booleans are written as JSON has them, `true` and `false`; None is an empty cell.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    if columns is not None:
        writer.writerow(columns)
    writer.writerows([BOOLEANS[cell] if cell is True or cell is False else cell for cell in row] for row in rows)
    return encode(text.getvalue())
