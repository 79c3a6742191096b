"""A robot as the text of a description, which loads again as the same robot."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping

from robokin.arrays import Array
from robokin.formats.exact_numbers import angle_text, length_text, number_text, transform_text
from robokin.formats.node_values import LONGEST, NO_WORD
from robokin.formats.schema import VERSION
from robokin.model import Joint, JointType, Robot, expect_robot, expect_uncoupled
from robokin.units import Units

PLAIN = re.compile(r"[A-Za-z_](?:[\w ./()²³-]*[\w.)])?")
"""Texts that YAML takes as they stand."""

NOT_PLAIN = ("null", "true", "false", "yes", "no", "on", "off")

AXES = {(1.0, 0.0, 0.0): "x", (0.0, 1.0, 0.0): "y", (0.0, 0.0, 1.0): "z"}


def written(robot: Robot) -> str:
    """The description of a robot in its own units and convention, as YAML.

    Numbers are the shortest that read as the same value; parameters are resolved, notes left out. Of a joint with one
    limit the other is written as 1e6 m or rad. Raises InputTypeError for what is no robot.
    """
    robot = expect_uncoupled(expect_robot(robot))
    units = robot.units
    lines = [f"robokin: {VERSION}", f"name: {_text(robot.name or robot.id or 'robot')}"]
    for name in ("description", "source"):
        if _one_line(getattr(robot, name)):
            lines.append(f"{name}: {_text(getattr(robot, name))}")
    lines.append(f"units: {{length: {units.length}, angle: {units.angle}}}")
    lines.append(f"convention: {robot.convention}")
    lines += _end("base", robot.base, units)
    names = different_names([_one_line(row.name) or str(i) for i, row in enumerate(robot.rows, start=1)])
    rows = [_cells(row, name, i, robot) for i, (row, name) in enumerate(zip(robot.rows, names, strict=True), start=1)]
    lines += ["joints:", *(f"  - {{{', '.join(f'{cell}: {text}' for cell, text in row.items())}}}" for row in rows)]
    lines += _end("tool", robot.tool, units)
    lines += _poses(robot.poses, robot)
    return "\n".join(lines) + "\n"


def different_names(names: Iterable[str]) -> list[str]:
    """The names in order, a number behind each that is there before."""
    found: dict[str, None] = {}
    for name in names:
        number, other = 2, name
        while other in found:
            other, number = f"{name}_{number}", number + 1
        found[other] = None
    return [*found]


def _one_line(text: str) -> str:
    """A text without line breaks and what no text of a description has."""
    return " ".join(NO_WORD.sub(" ", text).split())


def _text(text: str) -> str:
    """A text as a YAML scalar."""
    text = _one_line(text)
    if PLAIN.fullmatch(text) and text.casefold() not in NOT_PLAIN:
        return text
    return "".join(_escaped(letter) for letter in json.dumps(text, ensure_ascii=False))


def _escaped(letter: str) -> str:
    """A letter of a quoted text; what a terminal would not show, such as a change of direction, by its number."""
    if letter.isprintable():
        return letter
    number = ord(letter)
    return f"\\u{number:04x}" if number <= 0xFFFF else f"\\U{number:08x}"


def _end(name: str, T: Array, units: Units) -> list[str]:
    """The line of base or tool, where there is one."""
    text = transform_text(T, units)
    return [f"{name}: {text}"] if text else []


def _cells(row: Joint, name: str, number: int, robot: Robot) -> dict[str, str]:
    """The cells of a row as texts, in the order in which they are written."""
    units, turns = robot.units, row.type is JointType.REVOLUTE
    cells = {} if name == str(number) else {"name": _text(name)}
    cells["type"] = str(row.type)
    if robot.convention == "frames":
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
        order = ("alpha", "a", "theta", "d") if robot.convention == "modified" else ("theta", "d", "a", "alpha")
        variable = {JointType.REVOLUTE: "theta", JointType.PRISMATIC: "d"}.get(row.type)
        cells |= {cell: numbers[cell] for cell in order if cell != variable}
    if row.moves:
        if row.offset:
            cells["offset"] = _value(row.offset, turns, units)
        if row.sense != 1:
            cells["sense"] = str(row.sense)
        if not row.unlimited:
            low, high = (_value(min(max(limit, -LONGEST), LONGEST), turns, units) for limit in row.limits)
            cells["limits"] = f"[{low}, {high}]"
    return cells


def _value(value: float, turns: bool, units: Units) -> str:
    """A joint's value [rad | m] in the units."""
    return angle_text(value, units) if turns else length_text(value, units)


def _axis(axis: Array) -> str:
    """The axis of a row of frames: a letter, or its parts."""
    x, y, z = map(float, axis)
    letter = AXES.get((x, y, z))
    return letter or f"[{', '.join(number_text(float(part)) for part in axis)}]"


def _poses(poses: Mapping[str, Array], robot: Robot) -> list[str]:
    if not poses or not robot.n:
        return []
    lines = ["poses:"]
    for name, q in poses.items():
        pairs = zip(q, robot.revolute, strict=True)
        values = [_value(float(value), bool(turns), robot.units) for value, turns in pairs]
        lines.append(f"  {_text(name)}: [{', '.join(values)}]")
    return lines
