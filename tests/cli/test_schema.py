"""`robokin schema`: the format for editors."""

from __future__ import annotations

import json

from .conftest import refused


def test_the_schema_is_json(call):
    answer = call("schema")
    assert (answer.status, answer.err) == (0, "")
    assert answer.json["$schema"] == "https://json-schema.org/draft/2020-12/schema"


def test_every_reference_is_defined(call):
    schema = call("schema").json

    def references(value):
        if isinstance(value, dict):
            if "$ref" in value:
                yield value["$ref"]
            for inner in value.values():
                yield from references(inner)
        elif isinstance(value, list):
            for inner in value:
                yield from references(inner)

    assert set(references(schema)) <= {f"#/$defs/{name}" for name in schema["$defs"]}


def test_the_formats_are_one_document(call, tmp_path):
    schema = call("schema").json
    assert call("schema", "--json").json == schema
    assert call("schema", "-f", "jsonl").jsonl == [schema]
    assert call("schema", "-o", tmp_path / "robokin.schema.json").status == 0
    assert json.loads((tmp_path / "robokin.schema.json").read_text()) == schema


def test_a_schema_is_no_table(call, tmp_path):
    refused(call("schema", "-f", "csv"), "expected -f json")
    refused(call("schema", "-o", tmp_path / "schema.csv"), "expected", ".json")
    assert not list(tmp_path.iterdir())
