"""`robokin schema`: the format, for editors."""

from __future__ import annotations

from robokin.cli.options import OutputOption


def command(output: OutputOption = None) -> int:
    """The format of descriptions as a JSON Schema, for editors that complete and check YAML.

    Example: robokin schema -o robokin.schema.json
    """
    import json

    from robokin.cli.output.sink import sink
    from robokin.description.schema import json_schema

    with sink(output) as stream:
        stream.write((json.dumps(json_schema(), indent=2) + "\n").encode())
    return 0
