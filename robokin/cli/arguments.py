"""What users type as values: vectors of expressions, joint values, named poses."""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array
from robokin.cli.output.numbers import counted
from robokin.cli.statuses import say
from robokin.errors import ExpressionError, InputError, did_you_mean, shown
from robokin.formats.library import load_any
from robokin.formats.number_expressions import Scope, evaluate
from robokin.model import Mechanism, Robot, WheeledBase
from robokin.units import Units


def load_entry(name: str, overrides: dict[str, str], mode: int | None = None) -> Robot | Mechanism | WheeledBase:
    """What a command works on; what looks like a slip in it is noted on stderr, in one line. Raises InputError."""
    loaded = load_any(name, overrides, mode)
    if loaded.notes:
        more = len(loaded.notes) - 1
        say(str(loaded.notes[0]) + (f"; {more} more: robokin validate {name}" if more else ""))
    return loaded


def load_robot(name: str, overrides: dict[str, str]) -> Robot:
    """The robot that a command works on. Raises InputError, also for a mechanism or a wheeled base."""
    loaded = load_entry(name, overrides)
    if isinstance(loaded, WheeledBase):
        raise InputError(f"{name} is a wheeled base, expected a robot")
    if not isinstance(loaded, Robot):
        raise InputError(f"{name} is a mechanism (links and joints that may form loops), expected a robot")
    return loaded


def way_of(text: str | None) -> int | None:
    """The number of --mode: which way to put a mechanism together. Raises InputError."""
    if text is None:
        return None
    digits = text.strip()
    if not (digits.isascii() and digits.isdecimal() and len(digits) < 10) or not int(digits):
        raise InputError(f"--mode: found '{shown(text)}', expected a whole number from 1")
    return int(digits)


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


def parse_numbers(text: str, option: str, angles: list[bool], units: Units, what: str) -> Array:
    """A vector (k,) in the given units; `angles` tells which of its k values are angles.

    Raises InputError that names the option, the value and what was expected.
    """
    parts = split_vector(text)
    if len(parts) != len(angles):
        found = counted(len(parts), "value")
        raise InputError(f"{option}: found {found} in '{shown(text)}', expected {len(angles)}: {what}")
    scope = Scope(degrees=units.degrees)
    values = np.empty(len(parts))
    for i, (part, angle) in enumerate(zip(parts, angles, strict=True)):
        try:
            values[i] = evaluate(part, scope, angle=angle).number
        except ExpressionError as error:
            raise InputError(f"{option}: value {i + 1} of {len(angles)}: {error}") from None
    return values


def joint_factors(robot: Robot, units: Units) -> Array:
    """(n,) SI in one unit of each joint's value [rad | m]."""
    return np.where(robot.revolute, units.radians, units.metres)


def parse_configuration(text: str, robot: Robot, units: Units, option: str = "--q") -> Array:
    """Joint values (n,) in the given units, from a vector or the name of a pose of the description."""
    name = text.strip()
    if name in robot.poses:
        return in_units(robot.poses[name], joint_factors(robot, units))
    if name.lower().endswith((".csv", ".jsonl", ".npy")):
        raise InputError(f"{option}: found the name of a file, '{name}', expected values; --input {name} reads a file")
    if name.replace("-", "_").isidentifier() and name != "pi":
        known = list(robot.poses)
        listed = f", expected one of its poses: {', '.join(known)}" if known else ", which has none: expected values"
        raise InputError(
            f"{option}: found '{name}', no named pose of {robot.name}{did_you_mean(name, known) or listed}"
        )
    what = f"one for each joint of {robot.name} ({robot.types})"
    return parse_numbers(text, option, [bool(turns) for turns in robot.revolute], units, what)


def in_units(values: Array, factors: Array | float) -> Array:
    """SI values in units of `factors`, without the last digit's dust that the division leaves.

    90° in radians and back is 90.00000000000001; a value within two units in the last place of one
    with twelve digits is that one.
    """
    scaled = values / factors
    short = np.array([float(f"{value:.12g}") for value in np.ravel(scaled)]).reshape(np.shape(scaled))
    return np.where(np.abs(scaled - short) <= 4.0 * np.spacing(np.abs(scaled)), short, scaled) + 0.0
