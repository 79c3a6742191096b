"""A robot's forward kinematics as a Python function of its own, from its symbols."""

from __future__ import annotations

import re
import textwrap

from robokin.derivation.symbolic_kinematics import SymbolicKinematics
from robokin.derivation.written_sums import written
from robokin.model import Robot
from robokin.units import Units

WIDTH = 100
"""Characters of a line, where a product can be broken."""

QUOTES = re.compile(r'[\\"]')


def python_source(robot: Robot, units: Units, symbolic: SymbolicKinematics) -> str:
    """A module with `forward_kinematics(q)`, q (..., n) in the units, that needs numpy and nothing else."""
    kinds = ", ".join(units.angle if turns else units.length for turns in robot.revolute)
    name = QUOTES.sub("'", robot.name)
    lines = [
        f'"""Forward kinematics of {name}."""',
        "",
        "import numpy as np",
        "",
        "",
        "def forward_kinematics(q):",
        f'    """The tool\'s pose (..., 4, 4) [{units.length}] at joint values q (..., {robot.n})'
        f'{f" [{kinds}]" if kinds else ""}."""',
        "    q = np.asarray(q, dtype=float)",
    ]
    variables = [f"q{i}" for i in range(1, robot.n + 1)]
    if variables:
        lines.append(f"    {', '.join(variables)}{',' if robot.n == 1 else ''} = np.moveaxis(q, -1, 0)")
    used = _used_in(symbolic)
    lines += [f"    {name} = {value!r}" for name, value in symbolic.values.items() if name in used]
    lines += [f"    {name} = {text}" for name, text in symbolic.definitions.items() if name in used]
    for name, function in symbolic.functions.items():
        if name in used:
            argument = f"np.radians({function.argument})" if units.degrees else function.argument
            lines.append(f"    {name} = np.{function.name}({argument})")
    lines.append("    T = np.zeros((*q.shape[:-1], 4, 4))")
    for i, row in enumerate(symbolic.T):
        lines += [_assignment(f"    T[..., {i}, {j}] = ", written(entry)) for j, entry in enumerate(row) if entry]
    return "\n".join([*lines, "    return T", ""])


def _used_in(symbolic: SymbolicKinematics) -> set[str]:
    """The names that T needs, directly or by way of another."""
    used = {name for row in symbolic.T for entry in row for name in _words(written(entry))}
    used |= {word for name in used & {*symbolic.functions} for word in _words(symbolic.functions[name].argument)}
    return used | {word for name in used & {*symbolic.definitions} for word in _words(symbolic.definitions[name])}


def _words(text: str) -> list[str]:
    return re.findall(r"[^\W\d]\w*", text)


def _assignment(start: str, text: str) -> str:
    """A line, or several in parentheses where it would be long."""
    if len(start) + len(text) <= WIDTH:
        return start + text
    inside = " " * 8
    lines = textwrap.wrap(
        text, WIDTH, initial_indent=inside, subsequent_indent=inside, break_long_words=False, break_on_hyphens=False
    )
    return "\n".join([f"{start}(", *lines, "    )"])
