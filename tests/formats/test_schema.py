"""The JSON Schema says what the reader reads."""

from __future__ import annotations

import json
import re

import pytest
import yaml
from formats.texts import DEGREES, arm, linkage
from sweeps import sweep

from robokin.formats.library import library_files
from robokin.formats.schema import json_schema

SCHEMA = json_schema()
KNOWN = {"$schema", "title", "description", "$defs", "$ref", "anyOf", "type", "properties", "required", "const", "enum",
         "additionalProperties", "items", "minItems", "maxItems"}  # fmt: skip
TYPES = {"string": str, "number": (int, float), "array": list, "object": dict, "boolean": bool, "null": type(None)}


def errors(value, schema, where="$"):
    """What a value lacks by a schema: the few words of JSON Schema that ours is made of."""
    assert set(schema) <= KNOWN, set(schema) - KNOWN
    if "$ref" in schema:
        name = schema["$ref"].removeprefix("#/$defs/")
        yield from errors(value, SCHEMA["$defs"][name], where)
    if "anyOf" in schema:
        found = [list(errors(value, part, where)) for part in schema["anyOf"]]
        if all(found):
            yield from min(found, key=len)
    if "const" in schema and value != schema["const"]:
        yield f"{where} is not {schema['const']}"
    if "enum" in schema and value not in schema["enum"]:
        yield f"{where} is none of {schema['enum']}"
    if "type" in schema:
        kinds = [schema["type"]] if isinstance(schema["type"], str) else schema["type"]
        is_flag = isinstance(value, bool)
        if not any(isinstance(value, TYPES[kind]) and (kind == "boolean" or not is_flag) for kind in kinds):
            yield f"{where} is no {kinds}"
            return
    if isinstance(value, dict):
        for name in schema.get("required", []):
            if name not in value:
                yield f"{where} lacks {name}"
        extra = schema.get("additionalProperties", True)
        for name, inner in value.items():
            if name in schema.get("properties", {}):
                yield from errors(inner, schema["properties"][name], f"{where}.{name}")
            elif extra is False:
                yield f"{where} has {name}"
            elif isinstance(extra, dict):
                yield from errors(inner, extra, f"{where}.{name}")
    if isinstance(value, list):
        if not schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", len(value)):
            yield f"{where} has {len(value)} items"
        for i, inner in enumerate(value):
            yield from errors(inner, schema.get("items", {}), f"{where}[{i}]")


class EditorLoader(yaml.SafeLoader):
    """YAML 1.2, as editors have it: `on` is a word, and only `true` and `false` are flags."""

    yaml_implicit_resolvers = {  # noqa: RUF012
        first: [(tag, words) for tag, words in found if not tag.endswith(":bool")]
        for first, found in yaml.SafeLoader.yaml_implicit_resolvers.items()
    }


EditorLoader.add_implicit_resolver("tag:yaml.org,2002:bool", re.compile("true|false"), list("tf"))


def test_the_schema_is_json_and_holds_every_definition_that_it_names():
    text = json.dumps(SCHEMA)
    assert json.loads(text) == SCHEMA
    for part in text.split('"#/$defs/')[1:]:
        assert part[: part.index('"')] in SCHEMA["$defs"]


@pytest.mark.parametrize("path", sweep(library_files(), 4), ids=lambda path: path.stem)
def test_the_library_keeps_to_the_schema(path):
    value = yaml.load(path.read_text(encoding="utf-8"), Loader=EditorLoader)
    assert list(errors(value, SCHEMA)) == []


@pytest.mark.parametrize(
    "text",
    [
        arm(
            "type: R, a: l1/2, limits: [-90, 90]",
            "name: 2b, type: fixed, d: 5",
            tail="poses: {home: [0]}\nbase: Trans(1, 0, 0)\n",
        ),
        arm("type: R", tail="base:\nparameters:\n"),
        arm("name: 1, type: R"),
        DEGREES
        + "convention: frames\njoints: [{type: R, axis: x}, {type: P, origin: 'Trans(1, 0, 0)', axis: [0, 0, 1]}]\n",
        DEGREES + "joints: {type: RRP, a: [1, 2, 3], theta: [0, 0, ~]}\n",
        DEGREES + "joints: {type: [R, P], limits: [[0, 1], ~]}\n",
        DEGREES + "convention: screws\nhome: ''\njoints: [{type: R, axis: x, at: [1, l1, 2], sense: -1}, {type: P}]\n",
        DEGREES + "convention: screws\nhome: ''\njoints: {type: RP, axis: [x, [0, 0, 1]], at: [[1, 1, 2], ~]}\n",
        DEGREES + "ets: Rz(q1) tx(1) Rz(q2)\nlimits: [[0, 1], ~]\ntool: Trans(1, 0, 0)\nposes: {home: [0, 0]}\n",
        DEGREES + "convention: opw\na1: 1\nc2: 2\nc3: l3\noffsets: [0, 0, 0, 0, 0, a/2]\nsenses: [1, -1, 1, 1, 1, 1]\n",
        DEGREES + "branches: {a: {ets: Rz(q1), limits: [~], 'on': b}, b: {joints: [{type: R}], tool: ''}}\n",
        DEGREES + "branches: {a: {convention: screws, home: '', joints: [{type: R, at: [0, 0, 1]}]}}\ntips: [a]\n",
        DEGREES + "convention: opw\nbranches: {a: {c2: 1, c3: 2, base: 'Trans(1, 0, 0)', tool: ''}}\n",
        linkage("type: revolute, links: [ground, crank], at: [0, 0], actuated: true"),
        linkage(
            "type: universal, links: [ground, crank], axes: [[1, 0, 0], [0, 1, 0]]",
            "type: custom, links: [1, 2], freedoms: 2",
        ),
    ],
)
def test_what_the_reader_takes_keeps_to_the_schema(text):
    assert list(errors(yaml.safe_load(text), SCHEMA)) == []


@pytest.mark.parametrize(
    "text",
    [
        "{}",
        "[]",
        "name: x\njoints: [{type: R}]\n",
        "robokin: 2\nname: x\njoints: [{type: R}]\n",
        "robokin: 1\nname: x\n",
        "robokin: 1\nname: x\njoints: []\n",
        arm("a: 5"),
        arm("type: revolut"),
        arm("type: R, alhpa: 5"),
        arm("type: R, limits: [1]"),
        arm("type: R, a: [1]"),
        arm(tail="units2: 1\n"),
        DEGREES + "ets: Rz(q1)\njoints: [{type: R}]\n",
        DEGREES + "convention: screws\njoints: [{type: R}]\n",
        DEGREES + "convention: screws\nhome: ''\njoints: [{type: fixed}]\n",
        DEGREES + "convention: opw\nc2: 2\n",
        DEGREES + "convention: opw\nc2: 2\nc3: 2\nsenses: [1, 1]\n",
        DEGREES + "branches: {a: {ets: Rz(q1), joints: [{type: R}]}}\n",
        DEGREES + "branches: {a: {ets: Rz(q1), poses: {}}}\n",
        DEGREES + "branches: {a: {convention: opw, c2: 1}}\n",
        linkage("type: rotary, links: [ground, crank]"),
        linkage("type: revolute"),
        linkage("type: revolute, links: [ground, crank], at: [1]"),
    ],
)
def test_what_the_reader_refuses_breaks_the_schema(text):
    assert list(errors(yaml.safe_load(text), SCHEMA)) != []
