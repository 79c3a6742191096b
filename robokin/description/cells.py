"""Nodes of the tree to values: texts, numbers, lists, mappings with known keys.

Each function takes a node and gives the value that belongs there, or raises a DescriptionError that
names file, line and column, what was found and what was expected.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robokin.description.expressions import Scope, evaluate, names_parameters
from robokin.description.schema import Fields
from robokin.description.transforms import evaluate_transform, position_texts
from robokin.description.tree import Mapping, Mark, Node, Scalar, Sequence, describe
from robokin.errors import DescriptionError, ExpressionError, did_you_mean, or_list, shown
from robokin.spatial.rotations import ZERO_AXIS
from robokin.units import Units

Array = NDArray[np.float64]

INFINITE = re.compile(r"[-+]?\.?(inf|infinity|nan)", re.IGNORECASE)

GREATEST = 1e90
"""Greatest length [m] or angle [rad]: no machine is near it, and the cube of a sum of them is still a number."""

NO_WORD = re.compile(r"[\x00-\x1f\x7f-\x9f\ud800-\udfff]")
"""Characters that a quoted text can smuggle in by an escape and that no name or line of text has."""


@dataclass(frozen=True)
class Context:
    """The units of a file and what its expressions may refer to."""

    units: Units
    scope: Scope

    def factor(self, angle: bool) -> float:
        """SI in one unit of an angle or a length."""
        return self.units.radians if angle else self.units.metres


def fields_of(node: Node, fields: Fields, what: str) -> dict[str, Node]:
    """The entries of a mapping, all keys known and none missing; `what` names the mapping."""
    if not isinstance(node, Mapping):
        raise node.mark.error(f"found {describe(node)}, expected {what}: a mapping of keys to values")
    for name, mark in node.keys.items():
        if name not in fields:
            hint = did_you_mean(name, fields) or f", expected one of {', '.join(fields)}"
            raise mark.error(f"found the unknown key '{shown(name)}' in {what}{hint}")
    for name, field in fields.items():
        if field.required and name not in node.entries:
            raise node.mark.error(f"found no '{name}' in {what}, expected {name}: {field.doc}")
    return node.entries


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
    number = raw_number_of(node, context.scope, what, angle=angle) * context.factor(angle)
    _check_size(abs(number), node, what)
    return number


def _check_size(size: float, node: Node, what: str) -> None:
    """Refuse what later sums and products could not hold; size [m | rad]."""
    if size > GREATEST:
        raise node.mark.error(f"found {describe(node)} as {what}, expected a size of a machine, below {GREATEST:g}")


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
    numbers = [raw_number_of(item, context.scope, what) for item in items]
    vector = np.array([*numbers, 0.0][:3])
    greatest = float(np.max(np.abs(vector)))
    if not direction:
        _check_size(greatest, node, what)
        return vector * context.units.metres
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
        T = evaluate_transform("" if node.empty else node.text, context.scope, context.units)
    except ExpressionError as error:
        raise _located(node.mark, what, error) from None
    _check_size(float(np.max(np.abs(T))), node, what)
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


def names_of(node: Node, what: str) -> tuple[str, ...]:
    """A list of different names."""
    names: dict[str, None] = {}
    for item in list_of(node, what):
        name = text_of(item, "a name")
        if name in names:
            raise item.mark.error(f"found '{shown(name)}' twice in {what}, expected each name once")
        names[name] = None
    return tuple(names)


def flag_of(node: Node, what: str) -> bool:
    """true or false."""
    return choice_of(node, ("true", "false"), what) == "true"


def _located(mark: Mark, what: str, error: ExpressionError) -> DescriptionError:
    return mark.error(f"{what}: {error}")
