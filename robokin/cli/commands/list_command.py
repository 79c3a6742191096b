"""`robokin list`: what the library holds."""

from __future__ import annotations

from typing import Annotated

import typer

from robokin.cli.option_groups import OutputOptions
from robokin.cli.statuses import DONE, NO, say

COLUMNS = ("id", "name", "kind", "joints", "dof", "source")
"""What a CSV has of each entry, and where words are looked for."""


def command(
    words: Annotated[
        list[str] | None, typer.Argument(metavar="[WORD]...", help="Only what has all of these words.")
    ] = None,
    *,
    output: OutputOptions,
) -> int:
    """The library of robots, mechanisms and wheeled bases: names to use in every other command.

    The freedoms (dof) of a mechanism are those that its file states: where a count is wrong only its geometry tells,
    and robokin dof works that out. Those of a wheeled base are its degree of mobility.

    A word is found where a word of an entry's id, name, kind, class, description or source starts with it; in a
    description or a source one of up to three letters must stand alone. The status is 3 when nothing has all words.

    Examples:
        robokin list
        robokin list kuka
        robokin list scara epson
        robokin list mechanism --json
        robokin list wheeled
    """
    from robokin.formats.library_index import library_entries
    from robokin.formats.library_search import found, nothing_found
    from robokin.records.envelope import SCHEMA
    from robokin.tables.sink import sink
    from robokin.tables.written_rows import csv_records, written

    kind = output.kind
    wanted = [part for word in words or [] for part in word.split()]
    entries = library_entries()
    records = [{"schema": SCHEMA, **entry.record()} for entry in found(entries, wanted)]

    def page() -> bytes:
        from robokin.reports.library_table import library_table

        return library_table(records) if records else b""

    with sink(output.file) as stream:
        rows = [[record[name] for name in COLUMNS] for record in records]
        stream.writelines(written(kind, records, records, lambda: csv_records(COLUMNS, rows), page))
    if wanted and not records:
        say(nothing_found(entries, wanted))
        return NO
    return DONE
