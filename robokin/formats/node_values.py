"""Nodes of the tree to values: texts, numbers, lists, mappings with known keys.

Each function takes a node and gives the value that belongs there, or raises a DescriptionError that
names file, line and column, what was found and what was expected. Where several things can be wrong at once
(keys, items) each is added to the `Faults`, and a ConsequenceError is raised if no value is left.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping as MappingType
from dataclasses import dataclass, field

import numpy as np

from robokin.arrays import Array
from robokin.errors import DescriptionError, ExpressionError, did_you_mean, nearest, or_list, shown
from robokin.formats.faults import Faults
from robokin.formats.number_expressions import Scope, evaluate, names_parameters
from robokin.formats.schema import Fields
from robokin.formats.transform_expressions import Reader, position_texts
from robokin.formats.yaml_tree import FilePlace, Mapping, Node, Scalar, Sequence, describe
from robokin.spatial.rotations import ZERO_AXIS
from robokin.units import Units

INFINITE = re.compile(r"[-+]?\.?(inf|infinity|nan)", re.IGNORECASE)

LONGEST = 1e6
"""Greatest length [m]: a thousand kilometres. No arm is near it, and beside it a millimetre still has ten digits."""

GREATEST = 1e90
"""Greatest angle [rad]: sums and products of them are still numbers."""

NO_WORD = re.compile(r"[\x00-\x1f\x7f-\x9f\ud800-\udfff]")
"""Characters that a quoted text can smuggle in by an escape and that no name or line of text has."""


@dataclass(frozen=True)
class Context:
    """The units of a file and what its expressions may refer to; its mistakes and its numbers so far."""

    units: Units
    scope: Scope
    faults: Faults
    numbers: list[Number] = field(default_factory=list)
    parameters: MappingType[str, str] = field(default_factory=dict)

    def factor(self, angle: bool) -> float:
        """SI in one unit of an angle or a length."""
        return self.units.radians if angle else self.units.metres

    def record(self, node: Node, what: str, text: str, value: float, *, angle: bool) -> None:
        """Keep a length or an angle, as it is written, in the units of the file. Raises DescriptionError if it is
        beyond what a machine measures."""
        if abs(value) * self.factor(angle) > (GREATEST if angle else LONGEST):
            found = describe(node) if isinstance(node, Scalar) else f"'{shown(text)}'"
            expected = f"an angle below {GREATEST:g} rad" if angle else f"a length below {LONGEST:g} m"
            raise node.mark.error(f"found {found} as {what}, expected {expected}")
        self.numbers.append(Number(node.mark, what, self.parameters.get(text.strip("+-() "), text), value, angle))


@dataclass(frozen=True, slots=True)
class Number:
    """A length or an angle as it is written, in the units of the file; what: such as `alpha of row 2`."""

    mark: FilePlace
    what: str
    text: str
    value: float
    angle: bool


def fields_of(node: Node, fields: Fields, what: str, faults: Faults) -> dict[str, Node]:
    """The entries of a mapping whose keys are known; `what` names the mapping.

    Unknown and missing keys are gathered; in place of a missing entry stands one whose reading is a ConsequenceError.
    """
    if not isinstance(node, Mapping):
        raise node.mark.error(f"found {describe(node)}, expected {what}: a mapping of keys to values")
    entries = {name: value for name, value in node.entries.items() if name in fields}
    meant: set[str] = set()
    for name, mark in node.keys.items():
        if name not in fields:
            close = [near for near in nearest(name, fields) if near not in entries]
            meant.update(close)
            hint = did_you_mean(name, fields) or f", expected one of {', '.join(fields)}"
            value = node.entries[name]
            if name.isdecimal() and isinstance(value, Scalar) and value.empty:  # what is left of 149,09
                hint = ", expected a point before decimals: a comma ends a value"
            faults.add(mark.error(f"found the unknown key '{shown(name)}' in {what}{hint}"))
    for name, field_ in fields.items():
        if field_.required and name not in entries:
            if name not in meant:
                faults.add(node.mark.error(f"found no '{name}' in {what}, expected {name}: {field_.doc}"))
            entries[name] = Scalar("", node.mark.silent())
    return entries


def text_of(node: Node, what: str) -> str:
    """A text that is not empty."""
    if not isinstance(node, Scalar) or node.empty or not node.text.strip():
        raise node.mark.error(f"found {describe(node)}, expected {what}")
    text = " ".join(node.text.split())
    if NO_WORD.search(text):
        raise node.mark.error(f"found {describe(node)} with a control character, expected {what}")
    return text


def choice_of(node: Node, choices: tuple[str, ...], what: str) -> str:
    """One of some words."""
    text = text_of(node, f"{what}: {or_list(choices)}")
    if text not in choices:
        hint = did_you_mean(text, choices)
        raise node.mark.error(f"found '{shown(text)}' as {what}, expected {or_list(choices)}{hint}")
    return text


def expression_text(node: Node, what: str) -> str:
    """A scalar that is to be read as a number."""
    if not isinstance(node, Scalar) or node.empty:
        raise node.mark.error(f"found {describe(node)}, expected {what}: a number or an expression")
    if INFINITE.fullmatch(node.text.strip()):
        raise node.mark.error(f"found {describe(node)} as {what}, expected a finite number")
    return node.text


def raw_number_of(node: Node, scope: Scope, what: str, *, angle: bool = False) -> float:
    """A number in the units of the file."""
    text = expression_text(node, what)
    try:
        return evaluate(text, scope, angle=angle).number
    except ExpressionError as error:
        raise _located(node.mark, what, error) from None


def number_of(node: Node, context: Context, what: str, *, angle: bool) -> float:
    """A length [m] or an angle [rad]."""
    number = raw_number_of(node, context.scope, what, angle=angle)
    context.record(node, what, expression_text(node, what), number, angle=angle)
    return number * context.factor(angle)


def whole_number_of(node: Node, context: Context, what: str) -> int:
    """A whole number."""
    number = raw_number_of(node, context.scope, what)
    if number != int(number):
        raise node.mark.error(f"found {number:g} as {what}, expected a whole number")
    return int(number)


def whole_numbers_of(node: Node, fields: Fields, context: Context) -> dict[str, int]:
    """What a description says that the answer is: whole numbers, by their keys."""
    cells = fields_of(node, fields, "what is expected", context.faults)
    return {
        key: context.faults.attempt(0, whole_number_of, cell, context, f"expected {key}") for key, cell in cells.items()
    }


def type_of(node: Node, choices: tuple[str, ...], other_names: MappingType[str, str], where: str) -> str:
    """One of some types; what other books call it is answered with our word."""
    text = text_of(node, f"the type {where}: {or_list(choices)}")
    if text.casefold() in other_names:
        raise node.mark.error(f"found '{shown(text)}' as the type {where}, expected {other_names[text.casefold()]}")
    return choice_of(node, choices, f"the type {where}")


def refuse_keys_of_others(
    cells: MappingType[str, Node], owners: MappingType[str, tuple[str, ...]], kind: str, noun: str, where: str,
    context: Context,
) -> None:  # fmt: skip
    """Gather a mistake for each key that belongs to other types of what the noun says."""
    for key, types in owners.items():
        if key in cells and kind not in types:
            context.faults.add(
                cells[key].mark.error(
                    f"found '{key}' {where}, a {kind} {noun}, expected it only on type {or_list(types)}"
                )
            )


def rounding_of(node: Node, context: Context, what: str) -> float:
    """How far a number in the units of the file may be off, as it is written. The number has been read before."""
    return evaluate(expression_text(node, what), context.scope).rounding


def roundings_of(node: Node, context: Context, what: str) -> Array:
    """How far the components (3,) of a vector may be off, in the units of the file, as they are written."""
    return np.array([*(rounding_of(item, context, what) for item in list_of(node, what)), 0.0][:3])


def direction_roundings_of(node: Node, context: Context, what: str) -> Array:
    """How far the components (3,) of a unit direction may be off, as those of the vector are written."""
    length = math.hypot(*(raw_number_of(item, context.scope, what) for item in list_of(node, what)))
    return roundings_of(node, context, what) / length


def list_of(node: Node, what: str, length: int | tuple[int, int] | None = None) -> list[Node]:
    """The items of a list, of the given length or between two lengths."""
    if not isinstance(node, Sequence):
        raise node.mark.error(f"found {describe(node)}, expected {what}: a list")
    if length is not None:
        least, most = (length, length) if isinstance(length, int) else length
        if not least <= len(node.items) <= most:
            count = str(least) if least == most else f"{least} to {most}"
            raise node.mark.error(f"found {describe(node)} as {what}, expected {count} values")
    return node.items


def vector_of(node: Node, context: Context, what: str, *, direction: bool, plane: bool = False) -> Array:
    """A point (3,) [m] or a unit direction (3,); in the plane two numbers are taken as x and y."""
    items = list_of(node, what, (2, 3) if plane else 3)
    if not direction:
        lengths = context.faults.each(lambda item: number_of(item, context, what, angle=False), items)
        return np.array([*lengths, 0.0][:3])
    numbers = context.faults.each(lambda item: raw_number_of(item, context.scope, what), items)
    vector = np.array([*numbers, 0.0][:3])
    greatest = float(np.max(np.abs(vector)))
    if greatest < ZERO_AXIS:
        raise node.mark.error(f"found zero as {what}, expected a direction")
    vector /= greatest  # the squares of great numbers would not be finite
    vector /= np.linalg.norm(vector)
    return vector


def transform_of(node: Node, context: Context, what: str) -> Array:
    """A transform (4, 4) [m]; nothing is the identity."""
    if not isinstance(node, Scalar):
        raise node.mark.error(
            f"found {describe(node)}, expected {what}: a transform expression such as Trans(0, 0, 1) Rot(z, 90)"
        )
    try:
        reader = Reader("" if node.empty else node.text, context.scope, context.units)
        T = reader.whole()
    except ExpressionError as error:
        raise _located(node.mark, what, error) from None
    for text, value, angle in reader.measures:
        context.record(node, what, text, value, angle=angle)
    return T


def parameters_in(node: Node, context: Context) -> str:
    """A number's text where it names parameters; "" where it does not. The number has been read before."""
    if isinstance(node, Scalar) and names_parameters(node.text, context.scope):
        return node.text
    return ""


def parameters_in_position(node: Node, context: Context) -> tuple[tuple[str, str], ...]:
    """The coordinates of a transform that name parameters, `("z", "l1")`. The transform has been read before."""
    if isinstance(node, Scalar) and not node.empty and names_parameters(node.text, context.scope):
        return position_texts(node.text, context.scope, context.units)
    return ()


def flag_of(node: Node, what: str) -> bool:
    """true or false."""
    return choice_of(node, ("true", "false"), what) == "true"


def _located(mark: FilePlace, what: str, error: ExpressionError) -> DescriptionError:
    # What a parameter lacks has been said where it stands.
    return (mark.silent() if error.parameter else mark).error(f"{what}: {error}")
