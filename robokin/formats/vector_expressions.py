"""Vectors of number expressions in one text, and joint values by the name of a pose, as people type them."""

from __future__ import annotations

import re
from math import isfinite
from typing import TYPE_CHECKING

from robokin.errors import ExpressionError, InputError, counted, did_you_mean, shown
from robokin.formats.number_expressions import Scope, evaluate
from robokin.units import Units

if TYPE_CHECKING:
    from collections.abc import Sequence

    from robokin.arrays import Array
    from robokin.model import Robot, Tree


PLAIN = re.compile(r"(\s*[-+]?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][+-]?[0-9]+)?\s*(,|$))+(?<!,)")
"""Numbers between commas, without a formula."""


def split_vector(text: str) -> list[str]:
    """The parts of a vector in one argument: separated by commas if there is one, else by spaces.

    Commas and spaces inside parentheses belong to an expression. Brackets around the whole are allowed.
    """
    text = text.strip()
    if text.startswith("[") and text.endswith("]"):
        text = text[1:-1].strip()
    parts: list[str] = [""]
    spaced: list[str] = [""]
    depth = 0
    commas = False
    for character in text:
        depth += (character in "([") - (character in ")]")
        if character == "," and depth <= 0:
            commas = True
            parts.append("")
        else:
            parts[-1] += character
        if character.isspace() and depth <= 0:
            spaced.append("")
        else:
            spaced[-1] += character
    if commas:
        return [part.strip() for part in parts]
    return [part for part in spaced if part]


def parse_numbers(text: str, option: str, angles: Sequence[bool], units: Units, what: str) -> Array:
    """A vector (k,) in the given units; `angles` tells which of its k values are angles.

    Raises InputError that names the option, the value and what was expected.
    """
    import numpy as np

    return np.array(parse_floats(text, option, angles, units, what), dtype=np.float64)


def parse_floats(text: str, option: str, angles: Sequence[bool], units: Units, what: str) -> list[float]:
    """The same as a list."""
    if PLAIN.fullmatch(text):
        values = [*map(float, text.split(","))]
        if len(values) == len(angles) and all(map(isfinite, values)):
            return values
    parts = split_vector(text)
    if len(parts) != len(angles):
        found = counted(len(parts), "value")
        raise InputError(f"{option}: found {found} in '{shown(text)}', expected {len(angles)}: {what}")
    scope = Scope(degrees=units.degrees)
    values = []
    for i, (part, angle) in enumerate(zip(parts, angles, strict=True)):
        try:
            values.append(evaluate(part, scope, angle=angle).number)
        except ExpressionError as error:
            raise InputError(f"{option}: value {i + 1} of {len(angles)}: {error}") from None
    return values


def parse_configuration(text: str, robot: Robot | Tree, units: Units, option: str = "--q") -> Array:
    """Joint values (n,) in the given units, from a vector or the name of a pose of the description."""
    from robokin.model.joint_units import in_units, joint_factors

    name = text.strip()
    if name in robot.poses:
        return in_units(robot.poses[name], joint_factors(robot, units))
    if name.lower().endswith((".csv", ".jsonl", ".npy")):
        raise InputError(f"{option}: found the name of a file, '{name}', expected values; --input {name} reads a file")
    if name.replace("-", "_").isidentifier() and not name.startswith("-") and name != "pi":
        known = list(robot.poses)
        listed = f", expected one of its poses: {', '.join(known)}" if known else ", which has none: expected values"
        raise InputError(
            f"{option}: found '{name}', no named pose of {robot.name}{did_you_mean(name, known) or listed}"
        )
    what = f"one for each joint of {robot.name} ({robot.types})"
    return parse_numbers(text, option, [bool(turns) for turns in robot.revolute], units, what)
