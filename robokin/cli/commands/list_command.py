"""`robokin list`: what the library holds."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from robokin.cli.options import FormatOption, JsonOption, OutputOption, output_format


def command(
    words: Annotated[
        list[str] | None, typer.Argument(metavar="[WORD]...", help="Only what has all of these words in it.")
    ] = None,
    output: OutputOption = None,
    format: FormatOption = None,
    json: JsonOption = False,
) -> int:
    """The library of robots, mechanisms and wheeled bases: names to use in every other command.

    The freedoms (dof) of a mechanism are those that its file states: where a count is wrong only its geometry tells,
    and robokin dof works that out. Those of a wheeled base are its degree of mobility.

    Examples:
        robokin list
        robokin list kuka
        robokin list mechanism --json
        robokin list wheeled
    """
    from robokin.cli.output.sink import format_of, sink
    from robokin.cli.output.text import csv_records, json_document, json_line
    from robokin.description.library import library_names, load_any

    kind = format_of(output, output_format(format, json))
    records = [_record(load_any(name)) for name in library_names()]
    for word in words or []:
        records = [record for record in records if _plain(word) in _plain(" ".join(map(str, record.values())))]
    with sink(output) as stream:
        if kind == "json":
            stream.write(json_document(records))
        elif kind == "jsonl":
            stream.write(b"".join(json_line(record) for record in records))
        elif kind == "csv":
            columns = ["id", "name", "kind", "joints", "dof", "source"]
            stream.write(csv_records(columns, [list(record.values()) for record in records]))
        else:
            stream.write(_table(records))
    return 0


def _plain(text: str) -> str:
    """The text without accents and capitals, so that `staubli` finds Stäubli."""
    from unicodedata import combining, normalize

    return "".join(letter for letter in normalize("NFKD", text.casefold()) if not combining(letter))


def _record(entry: Any) -> dict[str, Any]:
    from robokin.cli.records import kind_of
    from robokin.model import Robot

    return {
        "id": entry.id,
        "name": entry.name,
        "kind": kind_of(entry),
        "joints": entry.types,
        "dof": entry.n if isinstance(entry, Robot) else entry.expected.get("mobility"),
        "source": entry.source,
    }


def _table(records: list[dict[str, Any]]) -> bytes:
    from robokin.cli.output.numbers import counted
    from robokin.cli.output.tables import render, table

    drawn = table()
    drawn.add_column("id", style="cyan", no_wrap=True)
    drawn.add_column("name", overflow="fold")
    drawn.add_column("joints", overflow="fold", max_width=12)
    drawn.add_column("dof", justify="right")
    for record in records:
        dof = "–" if record["dof"] is None else str(record["dof"])
        drawn.add_row(record["id"], record["name"], record["joints"], dof)
    kinds = [record["kind"] for record in records]
    sums = [counted(kinds.count("robot"), "robot"), counted(kinds.count("mechanism"), "mechanism")]
    if "wheeled" in kinds:
        sums.append(counted(kinds.count("wheeled"), "wheeled base"))
    return render(drawn, "\n" + ", ".join(sums))
