"""`robokin schema`: the format of descriptions for editors, and that of each command's documents for programs."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from robokin.cli.options import FormatOption, JsonOption, option, output_format
from robokin.errors import InputError, shown


def command(
    command: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[COMMAND]",
            help="The command whose documents are described, such as fk; of check with its kind: check ik. "
            "[default: descriptions]",
            show_default=False,
        ),
    ] = None,
    output: Annotated[str | None, option("--output -o", "FILE", "Write to a file that ends with .json.")] = None,
    format: FormatOption = None,
    json: JsonOption = False,
) -> int:
    """The format of descriptions as a JSON Schema, for editors that complete and check YAML.

    With COMMAND: the JSON Schema of the documents that the command writes with --json and -f jsonl. A schema is JSON:
    there is no table of it.

    Examples:
        robokin schema --output robokin.schema.json
        robokin schema fk
        robokin schema check ik --output check-ik.schema.json
    """
    from json import dumps

    from robokin.tables.sink import format_of, sink
    from robokin.tables.written_rows import json_line

    kind = format_of(output, output_format(format, json))
    if kind == "csv" or (output is not None and kind != "json"):
        raise InputError("a schema is one JSON document, expected -f json or an --output that ends with .json")
    schema = _schema(command or [])
    with sink(output) as stream:
        stream.write(json_line(schema) if kind == "jsonl" else (dumps(schema, indent=2) + "\n").encode())
    return 0


def _schema(words: list[str]) -> dict[str, Any]:
    """The schema of descriptions, or of a command's documents."""
    if not words:
        from robokin.formats.schema import json_schema

        return json_schema()
    from robokin.records.schemas import document_schema

    if len(words) > 2:
        raise InputError(f"found '{shown(words[2])}', expected one command, or check and its kind")
    return document_schema(*words)
