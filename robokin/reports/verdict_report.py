"""Answers of `robokin validate` in every format."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from robokin.records.description_records import Verdict
from robokin.tables.written_rows import csv_records, page, written

COLUMNS = ("file", "valid", "kind", "name", "error", "line", "column")
"""What a CSV has of each file, the notes behind it."""

INDENT = " " * 7
"""What stands below a verdict."""


def verdicts_written(kind: str, records: Sequence[dict[str, Any]], verdicts: Sequence[Verdict]) -> Iterator[bytes]:
    """The verdicts on files in a format, each with its document."""

    def csv() -> bytes:
        rows = [[*(record[name] for name in COLUMNS), _one_line(record["notes"])] for record in records]
        return csv_records([*COLUMNS, "notes"], rows)

    def text() -> bytes:
        return b"".join(page(_text(record, loaded)) for record, loaded in zip(records, verdicts, strict=True))

    return written(kind, records, records, csv, text)


def _one_line(places: list[dict[str, Any]]) -> str:
    return "; ".join(f"{place['line']}:{place['column']}: {place['message']}" for place in places)


def _text(record: dict[str, Any], verdict: Verdict) -> str:
    """A verdict as text: the kind and the name and what looks wrong, or all mistakes with their lines."""
    if isinstance(verdict, Exception):
        # An error names its file, line and column itself.
        detail = str(verdict) if str(verdict).startswith(record["file"]) else f"{record['file']}: {verdict}"
        return f"wrong  {detail}\n".replace("\n", f"\n{INDENT}").removesuffix(INDENT)
    noun = "wheeled base" if record["kind"] == "wheeled" else record["kind"]
    notes = "".join(f"note   {note}\n" for note in verdict.notes)
    return f"ok     {record['file']}: {noun} {record['name']}\n{notes}"
