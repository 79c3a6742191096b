"""Rows of numbers as JSON records are what a record after the other would be."""

from __future__ import annotations

import json

import numpy as np
import pytest

from robokin.tables.number_records import BLOCK, document_with_rows, json_row_lines
from robokin.tables.written_rows import json_document, json_line

FIELDS = [("t", 0), ("q", 2), ("one", 1)]
HEAD = {"schema": 1, "name": "100 % of it", "units": {"length": "mm"}}


def records(table):
    return [{"t": row[0], "q": row[1:3], "one": row[3:]} for row in table.tolist()]


@pytest.mark.parametrize("count", [1, 2, BLOCK, 2 * BLOCK + 1])
def test_documents_and_lines(count, rng):
    table = np.round(rng.normal(size=(count, 4)), 3)
    table[rng.random(table.shape) < 0.3] *= np.pi  # records of one line, and of several
    table[rng.random(table.shape) < 0.1] = 0.0
    whole = b"".join(document_with_rows(HEAD, "path", FIELDS, table))
    assert whole == json_document({**HEAD, "path": records(table)})
    lines = b"".join(json_row_lines(HEAD, FIELDS, table))
    assert lines == b"".join(json_line({**HEAD, **record}) for record in records(table))


def test_great_and_small_numbers_keep_every_digit():
    table = np.array([[1e-7, 1e300, -0.0, 5e-324], [0.1 + 0.2, -1e-5, 1e22, 123456789.123456789]])
    whole = json.loads(b"".join(document_with_rows({}, "path", FIELDS, table)))
    assert [[row["t"], *row["q"], *row["one"]] for row in whole["path"]] == table.tolist()
    assert [json.loads(line) for line in b"".join(json_row_lines({}, FIELDS, table)).splitlines()] == whole["path"]
