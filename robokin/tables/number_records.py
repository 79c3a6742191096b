"""Rows of numbers as JSON records of one shape: what `json_document` and `json_line` write of each, all at once.

A record has fields of one number and of several. Its text is one template; the numbers' texts are those of a CSV, so
that both say the same digits.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.tables.written_rows import WIDTH, csv_rows, json_document, json_line

Fields = Sequence[tuple[str, int]]
"""Names, and how many numbers each has; 0 for one that is not in a list."""

BLOCK = 2000
"""Rows that are put into their template together."""


def json_row_lines(head: dict[str, Any], fields: Fields, table: Array) -> Iterator[bytes]:
    """A line for each row (m, k), with what all have in common before."""
    before = json_line(head)[:-2].replace(b"%", b"%%") + (b", " if head else b"")
    yield from _filled([before + _flat(fields)[1:] + b"\n"], table, np.zeros(len(table), dtype=np.intp), b"")


def document_with_rows(document: dict[str, Any], name: str, fields: Fields, table: Array) -> Iterator[bytes]:
    """The document with one more key, the last: a list of a record for each row (m, k) of one and more."""
    yield json_document({**document, name: []}).rpartition(b"[]")[0] + b"[\n"
    flat = _flat(fields)
    long = b"{\n" + b",\n".join(b'      "%s": ' % key.encode() + _value(width) for key, width in fields) + b"\n    }"
    digits = np.array([len(line) + 1 for line in csv_rows(table).splitlines()]) - table.shape[1]
    # A record that fits into a line is written in one, as `json_document` does.
    lengths = digits + len(flat.replace(b"%s", b""))
    wide = (lengths + 4 > WIDTH) & any(width for _, width in fields)
    yield from _filled([b"    " + flat, b"    " + long], table, wide.astype(np.intp), b",\n")
    yield b"\n  ]\n}\n"


def _flat(fields: Fields) -> bytes:
    return b"{" + b", ".join(b'"%s": ' % name.encode() + _value(width) for name, width in fields) + b"}"


def _value(width: int) -> bytes:
    return b"[" + b", ".join([b"%s"] * width) + b"]" if width else b"%s"


def _filled(templates: Sequence[bytes], table: Array, which: Array, between: bytes) -> Iterator[bytes]:
    """Each row's template with its numbers, in blocks."""
    for i in range(0, len(table), BLOCK):
        numbers = csv_rows(table[i : i + BLOCK]).replace(b"\n", b",").split(b",")[:-1]
        chosen = which[i : i + BLOCK].tolist()
        yield (between if i else b"") + between.join([templates[k] for k in chosen]) % tuple(numbers)
