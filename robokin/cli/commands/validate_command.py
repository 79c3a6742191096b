"""`robokin validate`: is this file a description?"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from robokin.cli.options import FormatOption, JsonOption, OutputOption, output_format
from robokin.cli.statuses import DONE, WRONG_INPUT, say

if TYPE_CHECKING:
    from robokin.cli.descriptions import Verdict

COLUMNS = ("file", "valid", "kind", "name", "error", "line", "column")
"""What a CSV has of each file, the notes behind it."""

INDENT = " " * 7
"""What stands below a verdict."""


def command(
    files: Annotated[
        list[str],
        typer.Argument(metavar="FILE...", help="Descriptions, or names of the library.", show_default=False),
    ],
    output: OutputOption = None,
    format: FormatOption = None,
    json: JsonOption = False,
) -> int:
    """Check descriptions; the status is 2 if any is wrong.

    Examples:
        robokin validate arm.yaml
        robokin validate robots/arms/*.yaml --json
    """
    from robokin.cli.descriptions import file_record, verdict_of
    from robokin.cli.output.sink import format_of, sink
    from robokin.cli.output.text import csv_records, json_document, json_line, page

    kind = format_of(output, output_format(format, json))
    verdicts = [verdict_of(file) for file in files]
    records = [file_record(file, verdict) for file, verdict in zip(files, verdicts, strict=True)]
    with sink(output) as stream:
        if kind == "json":
            stream.write(json_document(records))
        elif kind == "jsonl":
            stream.write(b"".join(json_line(record) for record in records))
        elif kind == "csv":
            rows = [[*(record[name] for name in COLUMNS), _one_line(record["notes"])] for record in records]
            stream.write(csv_records([*COLUMNS, "notes"], rows))
        else:
            for record, loaded in zip(records, verdicts, strict=True):
                stream.write(page(_text(record, loaded)))
    wrong = sum(not record["valid"] for record in records)
    if wrong:
        say(f"{wrong} of {len(records)} descriptions {'is' if wrong == 1 else 'are'} wrong")
    return WRONG_INPUT if wrong else DONE


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
