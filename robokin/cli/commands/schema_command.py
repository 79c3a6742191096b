"""`robokin schema`: the format, for editors."""

from __future__ import annotations

from typing import Annotated

import typer

from robokin.cli.options import FormatOption, JsonOption, output_format


def command(
    output: Annotated[
        str | None, typer.Option("--output", "-o", metavar="FILE", help="Write to a file that ends with .json.")
    ] = None,
    format: FormatOption = None,
    json: JsonOption = False,
) -> int:
    """The format of descriptions as a JSON Schema, for editors that complete and check YAML.

    A schema is JSON: there is no table of it.

    Examples:
        robokin schema --output robokin.schema.json
    """
    from json import dumps

    from robokin.cli.output.sink import format_of, sink
    from robokin.cli.output.text import json_line
    from robokin.description.schema import json_schema
    from robokin.errors import InputError

    kind = format_of(output, output_format(format, json))
    if kind == "csv" or (output is not None and kind != "json"):
        raise InputError("a schema is one JSON document, expected -f json or an --output that ends with .json")
    with sink(output) as stream:
        stream.write(json_line(json_schema()) if kind == "jsonl" else (dumps(json_schema(), indent=2) + "\n").encode())
    return 0
