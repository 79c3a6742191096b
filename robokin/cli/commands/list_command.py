"""`robokin list`: what the library holds."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from robokin.cli.options import FormatOption, JsonOption, OutputOption, output_format

COLUMNS = ("id", "name", "kind", "joints", "dof", "source")
"""What a CSV has of each entry, and where words are looked for."""


def command(
    words: Annotated[
        list[str] | None, typer.Argument(metavar="[WORD]...", help="Only what has all of these words.")
    ] = None,
    output: OutputOption = None,
    format: FormatOption = None,
    json: JsonOption = False,
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
    from robokin.cli.library_search import found, nothing_found
    from robokin.cli.output.sink import format_of, sink
    from robokin.cli.output.text import csv_records, json_document, json_line
    from robokin.cli.statuses import DONE, NO, say
    from robokin.formats.library_index import library_entries
    from robokin.records.envelope import SCHEMA

    kind = format_of(output, output_format(format, json))
    wanted = [part for word in words or [] for part in word.split()]
    entries = library_entries()
    records = [{"schema": SCHEMA, **entry.record()} for entry in found(entries, wanted)]
    with sink(output) as stream:
        if kind == "json":
            stream.write(json_document(records))
        elif kind == "jsonl":
            stream.write(b"".join(json_line(record) for record in records))
        elif kind == "csv":
            stream.write(csv_records(COLUMNS, [[record[name] for name in COLUMNS] for record in records]))
        elif records:
            stream.write(_table(records))
    if wanted and not records:
        say(nothing_found(entries, wanted))
        return NO
    return DONE


def _table(records: list[dict[str, Any]]) -> bytes:
    from robokin.cli.output.numbers import counted
    from robokin.cli.output.tables import render, table

    drawn = table()
    drawn.add_column("id", style="cyan", no_wrap=True)
    drawn.add_column("name")
    drawn.add_column("joints", max_width=12)
    drawn.add_column("dof", justify="right")
    for record in records:
        dof = "–" if record["dof"] is None else str(record["dof"])
        drawn.add_row(record["id"], record["name"], record["joints"], dof)
    kinds = [record["kind"] for record in records]
    sums = [counted(kinds.count("robot"), "robot"), counted(kinds.count("mechanism"), "mechanism")]
    if "wheeled" in kinds:
        sums.append(counted(kinds.count("wheeled"), "wheeled base"))
    return render(drawn, "\n" + ", ".join(sums))
