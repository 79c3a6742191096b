"""`robokin validate`: is this file a description?"""

from __future__ import annotations

from typing import Annotated, Any

import typer

from robokin.cli import DONE, WRONG_INPUT, say
from robokin.cli.options import FormatOption, JsonOption, OutputOption, output_format


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
        robokin validate robots/*.yaml --json
    """
    from robokin.cli.output.sink import format_of, sink
    from robokin.cli.output.text import csv_records, encode, json_document, json_line

    kind = format_of(output, output_format(format, json))
    records = [_verdict(file) for file in files]
    with sink(output) as stream:
        if kind == "json":
            stream.write(json_document(records))
        elif kind == "jsonl":
            stream.write(b"".join(json_line(record) for record in records))
        elif kind == "csv":
            stream.write(csv_records(list(records[0]), [list(record.values()) for record in records]))
        else:
            for record in records:
                noun = "wheeled base" if record["kind"] == "wheeled" else record["kind"]
                detail = f"{noun} {record['name']}" if record["valid"] else record["error"]
                stream.write(encode(f"{'ok   ' if record['valid'] else 'wrong'}  {_shown(record, detail)}\n"))
    wrong = sum(not record["valid"] for record in records)
    if wrong:
        say(f"{wrong} of {len(records)} descriptions {'is' if wrong == 1 else 'are'} wrong")
    return WRONG_INPUT if wrong else DONE


def _shown(record: dict[str, Any], detail: str) -> str:
    # An error names its file, line and column itself.
    return detail if detail.startswith(record["file"]) else f"{record['file']}: {detail}"


def _verdict(file: str) -> dict[str, Any]:
    from robokin.cli.records import kind_of
    from robokin.description.library import load_any
    from robokin.errors import InputError

    record: dict[str, Any] = {
        "file": file, "valid": False, "kind": None, "name": None, "error": None, "line": None, "column": None,
    }  # fmt: skip
    try:
        loaded = load_any(file)
    except InputError as error:
        record["error"] = str(error)
        record["line"] = getattr(error, "line", 0) or None
        record["column"] = getattr(error, "column", 0) or None
    else:
        record["valid"] = True
        record["kind"] = kind_of(loaded)
        record["name"] = loaded.name
    return record
