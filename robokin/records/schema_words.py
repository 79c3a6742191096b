"""The few words that the JSON Schemas of documents are written with (JSON Schema, draft 2020-12).

A description ends with the unit of a quantity in brackets: [length] and [angle] are those that the document's `units`
state, [joint] the one or the other by the joint's type, [rad] and [1] are radians and pure numbers whatever the units.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

Schema = dict[str, Any]

DRAFT = "https://json-schema.org/draft/2020-12/schema"


def record(about: str, keys: Mapping[str, Schema], optional: Mapping[str, Schema] | None = None) -> Schema:
    """An object with all of `keys`, perhaps some of the `optional` ones, and no others."""
    return {
        "type": "object",
        "description": about,
        "properties": {**keys, **(optional or {})},
        "required": list(keys),
        "additionalProperties": False,
    }


def mapping(values: Schema, about: str) -> Schema:
    """An object whose keys are names that the description chooses."""
    return {"type": "object", "description": about, "additionalProperties": values}


def text(about: str) -> Schema:
    """A string."""
    return {"type": "string", "description": about}


def word(about: str, *choices: str) -> Schema:
    """One of some strings."""
    return {"enum": list(choices), "description": about}


def number(about: str, least: float | None = None) -> Schema:
    """A number, of at least `least`."""
    return {"type": "number", "description": about} | ({} if least is None else {"minimum": least})


def whole(about: str, least: int | None = None) -> Schema:
    """A whole number, of at least `least`."""
    return {"type": "integer", "description": about} | ({} if least is None else {"minimum": least})


def flag(about: str) -> Schema:
    """true or false."""
    return {"type": "boolean", "description": about}


def items(values: Schema, about: str, count: int | None = None) -> Schema:
    """A list, of `count` values where their number is fixed."""
    fixed = {} if count is None else {"minItems": count, "maxItems": count}
    return {"type": "array", "description": about, "items": values} | fixed


def numbers(about: str, count: int | None = None) -> Schema:
    """A list of numbers."""
    return items({"type": "number"}, about, count)


def texts(about: str) -> Schema:
    """A list of strings."""
    return items({"type": "string"}, about)


def rows(about: str, count: int | None = None, width: int | None = None) -> Schema:
    """Lists of numbers in a list."""
    fixed = {} if width is None else {"minItems": width, "maxItems": width}
    return items({"type": "array", "items": {"type": "number"}} | fixed, about, count)


def matrix(about: str) -> Schema:
    """A homogeneous matrix 4×4, row by row; its last column holds lengths."""
    return rows(f"{about}: a 4×4 matrix, row by row [1; last column length]", 4, 4)


def maybe(schema: Schema, when: str) -> Schema:
    """The schema, or null; `when` says what null means."""
    about = f"{schema['description']}; null {when}"
    if "enum" in schema:
        return schema | {"enum": [*schema["enum"], None], "description": about}
    return schema | {"type": [schema["type"], "null"], "description": about}


UNITS = record(
    "The units of the document's quantities.",
    {"length": word("Unit of lengths.", "m", "cm", "mm", "in"), "angle": word("Unit of angles.", "rad", "deg")},
)


def head(key: str, about: Schema, *, units: bool = True, named: bool = True) -> dict[str, Schema]:
    """The keys that every document has: see `envelope`. `named`: whether it is about what has a name."""
    id = text("What the document is about: a name of the library, or a file's name without its ending.")
    keys = {
        "schema": {"const": 1, "description": "Version of this schema; keys are only added to a version."},
        key: about,
        "id": id if named else maybe(id, "for a bare count"),
    }
    return keys | ({"units": UNITS} if units else {})


ROBOT = text("The robot, as `id`.")
Q = numbers("Joint values, in the order of the description [joint].")


def documents(command: str, about: str, listed: Sequence[str], **variants: Schema) -> Schema:
    """The schema of what a command writes: one of the variants, or a list of one of those that come in lists."""
    references: list[Schema] = [{"$ref": f"#/$defs/{name}"} for name in variants]
    references += [{"type": "array", "items": {"$ref": f"#/$defs/{name}"}} for name in listed]
    return {
        "$schema": DRAFT,
        "title": f"robokin {command}, version 1",
        "description": f"{about} With -f jsonl, each line is such a document.",
        "anyOf": references,
        "$defs": variants,
    }
