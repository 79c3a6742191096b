"""What `robokin list` prints, in every format."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from robokin.formats.library_index import library_entries
from robokin.formats.library_search import found, nothing_found
from robokin.records.envelope import SCHEMA
from robokin.tables.written_rows import csv_records, written

COLUMNS = ("id", "name", "kind", "joints", "dof", "source")
"""What a CSV has of each entry."""


def listed(words: Sequence[str], kind: str) -> tuple[Iterator[bytes], str]:
    """The entries that have all of some words, in a format, and a sentence where there are none."""
    wanted = [part for word in words for part in word.split()]
    entries = library_entries()
    records = [{"schema": SCHEMA, **entry.record()} for entry in found(entries, wanted)]

    def page() -> bytes:
        from robokin.reports.library_table import library_table

        return library_table(records) if records else b""

    rows = [[record[name] for name in COLUMNS] for record in records]
    data = written(kind, records, records, lambda: csv_records(COLUMNS, rows), page)
    return data, nothing_found(entries, wanted) if wanted and not records else ""
