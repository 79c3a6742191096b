"""The values of xacro's expressions: numbers, strings and truths, and the tables and lists of YAML files.

Nothing of a file is run: a table is what robokin's own reader of YAML makes of it, and of xacro's tags `!degrees` and
`!radians` before a number.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping as MappingType
from dataclasses import dataclass

from robokin.errors import ExpressionError, did_you_mean, shown
from robokin.formats.faults import Faults
from robokin.formats.yaml_reader import read_tree
from robokin.formats.yaml_tree import Mapping, Node, Scalar

ANGLE_TAG = re.compile(
    r"!(degrees|radians)[ \t]+([+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)(?![\w.*/(])"
)
"""A number of a YAML file with one of xacro's tags; angles are radians where it is used."""


TWICE = " twice, first on line "
"""What is said of a key that stands twice: which is meant is not known, and nobody need know where it is not used."""


NOTHING = re.compile(r"^\s*#.*$|^---.*$|\ufeff", re.MULTILINE)
"""Comments, which are nothing in a file."""


@dataclass(frozen=True, eq=False)
class XacroTable:
    """A mapping of a YAML file, or of `dict(…)`."""

    entries: MappingType[str, XacroValue]

    def __len__(self) -> int:
        """How many keys there are; an empty table is no truth, as in Python."""
        return len(self.entries)


@dataclass(frozen=True, eq=False)
class XacroList:
    """A list of a YAML file."""

    items: tuple[XacroValue, ...]

    def __len__(self) -> int:
        """How many items there are."""
        return len(self.items)


@dataclass(frozen=True, eq=False)
class XacroAbsent:
    """A part that a table has not: a mistake only where it is used, as `t['a'] if 'a' in t else 0` has a value."""

    message: str

    def __bool__(self) -> bool:
        """Used as a condition. Raises ExpressionError."""
        raise ExpressionError(self.message)


XacroValue = float | int | str | bool | XacroTable | XacroList | XacroAbsent


def present(value: XacroValue) -> XacroValue:
    """The value. Raises ExpressionError where it is a part that a table has not."""
    if isinstance(value, XacroAbsent):
        raise ExpressionError(value.message)
    return value


def absent_of(*values: XacroValue) -> XacroAbsent | None:
    """The first of some values that is a part which a table has not: what is made of it is none either."""
    return next((value for value in values if isinstance(value, XacroAbsent)), None)


def as_xacro_number(value: XacroValue, where: str) -> float | int:
    """The value, a number or a truth. Raises ExpressionError that says where it stands."""
    if isinstance(value, str):
        raise ExpressionError(f"found {where} the string '{shown(value)}', expected numbers")
    value = present(value)
    if isinstance(value, XacroTable | XacroList):
        raise ExpressionError(f"found {where} a table or a list, expected numbers")
    assert not isinstance(value, str | XacroAbsent)
    return value


def xacro_text(value: XacroValue) -> str:
    """A value as it stands in an attribute. Raises ExpressionError for a table or a list."""
    value = present(value)
    if isinstance(value, XacroTable | XacroList):
        raise ExpressionError("found a table or a list in a text, expected a part of it, by its key in brackets")
    return value if isinstance(value, str) else repr(value)


def xacro_typed(text: str) -> XacroValue:
    """What a text stands for in an expression: a number, a truth, else the text."""
    word = text.strip()
    if re.fullmatch(r"[+-]?[0-9]{1,15}", word):
        return int(word)
    if re.fullmatch(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?", word):
        return float(word)
    return {"true": True, "false": False}.get(word.lower(), text)


def part_of_xacro(value: XacroValue, key: XacroValue) -> XacroValue:
    """What a table has by a key, a list or a string by a number. Raises ExpressionError for other values."""
    if isinstance(value, XacroAbsent):
        return value
    if isinstance(value, XacroTable):
        name = xacro_text(key)
        if name in value.entries:
            return value.entries[name]
        hint = did_you_mean(name, value.entries) or f", expected one of {', '.join([*value.entries][:12]) or 'none'}"
        return XacroAbsent(f"found no part '{shown(name)}' of a table{hint}")
    if isinstance(value, str | XacroList):
        parts = value if isinstance(value, str) else value.items
        if isinstance(key, bool) or not isinstance(key, int):
            raise ExpressionError("found a part taken of a list by no number, expected a whole one")
        if -len(parts) <= key < len(parts):
            return parts[key]
        return XacroAbsent(f"found part {key} of {len(parts)}, expected 0 to {len(parts) - 1}")
    raise ExpressionError(f"found a part taken of {xacro_text(value)}, expected one of a table, a list or a string")


def xacro_table(text: str, file: str) -> XacroValue:
    """What is in the text of a YAML file. Raises DescriptionError with its place."""

    def in_radians(found: re.Match[str]) -> str:
        number = float(found[2])
        return repr(math.radians(number) if found[1] == "degrees" else number)

    if not NOTHING.sub("", text).strip():
        return XacroTable({})
    faults = Faults()
    root = read_tree(ANGLE_TAG.sub(in_radians, text), file, faults)
    if any(TWICE not in fault.message for fault in faults.found):
        faults.stop()
    return _value_of(root)


def _value_of(node: Node) -> XacroValue:
    if isinstance(node, Scalar):
        if node.mark.said:
            return XacroAbsent(f"found a key twice in {node.mark.file}, line {node.mark.line}, expected each key once")
        if node.empty:
            return ""
        return node.text if node.quoted else xacro_typed(node.text)
    if isinstance(node, Mapping):
        return XacroTable({key: _value_of(value) for key, value in node.entries.items()})
    return XacroList(tuple(_value_of(item) for item in node.items))
