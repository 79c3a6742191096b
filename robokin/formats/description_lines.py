"""The lines of a description: texts, transforms, rows of a table and poses as YAML that reads as just the same."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction

from robokin.arrays import Array, Flags
from robokin.formats.exact_numbers import angle_text, length_text, number_text, transform_text
from robokin.formats.node_values import LONGEST, NO_WORD
from robokin.model import Joint, JointType
from robokin.model.graph import NO_LIMITS, Coupling
from robokin.units import Units

PLAIN = re.compile(r"[A-Za-z_](?:[\w ./()²³-]*[\w.)])?")
"""Texts that YAML takes as they stand."""

NOT_PLAIN = ("null", "true", "false", "yes", "no", "on", "off")

GREATEST_PART = 100
"""The greatest numerator and denominator of a ratio that is written as a fraction."""

AXES = {(1.0, 0.0, 0.0): "x", (0.0, 1.0, 0.0): "y", (0.0, 0.0, 1.0): "z"}


def different_names(names: Iterable[str]) -> list[str]:
    """The names in order, a number behind each that is there before."""
    found: dict[str, None] = {}
    for name in names:
        number, other = 2, name
        while other in found:
            other, number = f"{name}_{number}", number + 1
        found[other] = None
    return [*found]


def one_line(text: str) -> str:
    """A text without line breaks and what no text of a description has."""
    return " ".join(NO_WORD.sub(" ", text).split())


def plain_name(text: str) -> str:
    """A text as a name of letters, digits, - and _ that begins with none of the digits."""
    name = "".join(letter if letter == "-" or f"a{letter}".isidentifier() else "_" for letter in text)
    return name if name.replace("-", "_").isidentifier() else f"_{name}"


def yaml_text(text: str) -> str:
    """A text in one line as a YAML scalar."""
    text = one_line(text)
    if PLAIN.fullmatch(text) and text.casefold() not in NOT_PLAIN:
        return text
    return "".join(_escaped(letter) for letter in json.dumps(text, ensure_ascii=False))


def _escaped(letter: str) -> str:
    """A letter of a quoted text; what a terminal would not show, such as a change of direction, by its number."""
    if letter.isprintable():
        return letter
    number = ord(letter)
    return f"\\u{number:04x}" if number <= 0xFFFF else f"\\U{number:08x}"


def transform_lines(name: str, T: Array, units: Units) -> list[str]:
    """The line of a transform (4, 4) [m], such as the base; none for the identity."""
    text = transform_text(T, units)
    return [f"{name}: {text}"] if text else []


def row_names(rows: Iterable[Joint]) -> list[str]:
    """The names that rows have in a description, each once: their own, or their numbers."""
    return different_names(one_line(row.name) or str(i) for i, row in enumerate(rows, start=1))


def row_lines(rows: Iterable[Joint], convention: str, units: Units) -> list[str]:
    """The rows of a table, one a line, names that are there twice with a number."""
    rows = [*rows]
    lines = []
    for i, (row, name) in enumerate(zip(rows, row_names(rows), strict=True), start=1):
        named = {} if name == str(i) else {"name": yaml_text(name)}
        cells = named | _cells(row, convention, units)
        lines.append(f"- {{{', '.join(f'{cell}: {text}' for cell, text in cells.items())}}}")
    return lines


def _cells(row: Joint, convention: str, units: Units) -> dict[str, str]:
    """The cells of a row but for its name as texts, in the order in which they are written."""
    turns = row.type is JointType.REVOLUTE
    cells = {"type": "helical" if row.pitch else str(row.type)}
    if convention == "frames":
        origin = "" if row.origin is None else transform_text(row.origin, units)
        if origin:
            cells["origin"] = f'"{origin}"'
        if row.moves and row.axis is not None:
            cells["axis"] = _axis(row.axis)
    else:
        numbers = {
            "theta": angle_text(row.theta, units),
            "d": length_text(row.d, units),
            "a": length_text(row.a, units),
            "alpha": angle_text(row.alpha, units),
        }
        order = ("alpha", "a", "theta", "d") if convention == "modified" else ("theta", "d", "a", "alpha")
        variable = {JointType.REVOLUTE: "theta", JointType.PRISMATIC: "d"}.get(row.type)
        cells |= {cell: numbers[cell] for cell in order if cell != variable}
    if row.moves:
        if row.offset:
            cells["offset"] = value_text(row.offset, turns, units)
        if row.sense != 1:
            cells["sense"] = str(row.sense)
        if not row.unlimited:
            cells["limits"] = _limits(row.limits, turns, units)
        if row.pitch:
            cells["pitch"] = number_text(row.pitch, units.metres / (2.0 * math.pi))
        if row.motion_limits != NO_LIMITS:
            cells["motion_limits"] = _limits(row.motion_limits, turns, units)
    return cells


def _limits(limits: tuple[float, float], turns: bool, units: Units) -> str:
    """Limits [rad | m] as a list; of one side alone the other is as far as a description goes."""
    low, high = (value_text(min(max(limit, -LONGEST), LONGEST), turns, units) for limit in limits)
    return f"[{low}, {high}]"


def value_text(value: float, turns: bool, units: Units) -> str:
    """A joint's value [rad | m] in the units."""
    return angle_text(value, units) if turns else length_text(value, units)


def _axis(axis: Array) -> str:
    """The axis of a row of frames: a letter, or its parts."""
    x, y, z = map(float, axis)
    letter = AXES.get((x, y, z))
    return letter or f"[{', '.join(number_text(float(part)) for part in axis)}]"


def pose_lines(poses: Mapping[str, Array], revolute: Flags, units: Units) -> list[str]:
    """The named poses (n,) [rad | m]; revolute: (n,) which of the joints turn."""
    if not poses or not len(revolute):
        return []
    lines = ["poses:"]
    for name, q in zip(different_names(map(plain_name, poses)), poses.values(), strict=True):
        values = [value_text(float(value), bool(turns), units) for value, turns in zip(q, revolute, strict=True)]
        lines.append(f"  {yaml_text(name)}: [{', '.join(values)}]")
    return lines


def head_lines(name: str, description: str, source: str, units: Units) -> list[str]:
    """The first lines of a description: what it is of, and its units."""
    lines = [f"name: {yaml_text(name)}"]
    for key, text in (("description", description), ("source", source)):
        if one_line(text):
            lines.append(f"{key}: {yaml_text(text)}")
    return [*lines, f"units: {{length: {units.length}, angle: {units.angle}}}"]


def coupling_lines(couplings: Sequence[Coupling], turning: Mapping[str, bool], units: Units) -> list[str]:
    """The couplings, ratios in the units; turning: which of the joints, by name, turn."""
    return ["couplings:", *(f"  - {_coupling(one, turning, units)}" for one in couplings)] if couplings else []


def _coupling(coupling: Coupling, turning: Mapping[str, bool], units: Units) -> str:
    """A coupling as a mapping in one line, its ratios in the units."""
    word = "adds" if coupling.own else "follows"
    factors = {True: units.radians, False: units.metres}
    turns = turning[coupling.joint]
    said = [
        (yaml_text(other), _ratio(ratio, factors[turns] / factors[turning[other]] if turns != turning[other] else 1.0))
        for other, ratio in coupling.ratios
    ]
    if len(said) == 1:
        ((other, ratio),) = said
        cells = {"joint": yaml_text(coupling.joint), word: other} | ({"ratio": ratio} if ratio != "1" else {})
    else:
        listed = ", ".join(f"{other}: {ratio}" for other, ratio in said)
        cells = {"joint": yaml_text(coupling.joint), word: f"{{{listed}}}"}
    if coupling.offset:
        cells["offset"] = value_text(coupling.offset, turns, units)
    return f"{{{', '.join(f'{cell}: {text}' for cell, text in cells.items())}}}"


def _ratio(ratio: float, unit: float) -> str:
    """A ratio in SI as a number of its unit; as a fraction where it is one."""
    text = number_text(ratio, unit)
    if len(text) > 8:
        near = Fraction(ratio / unit).limit_denominator(GREATEST_PART)
        if near and abs(near.numerator) <= GREATEST_PART and near.numerator / near.denominator * unit == ratio:
            return f"{near.numerator}/{near.denominator}"
    return text
