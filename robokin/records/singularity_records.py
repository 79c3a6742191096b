"""What `robokin singular` says of an arm's singular configurations as plain data."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from robokin.kinematics.singular import Singularity
from robokin.kinematics.singular_equation import signed
from robokin.kinematics.velocity import TaskName, motion_task
from robokin.model import Robot
from robokin.model.joint_units import in_units, joint_factors
from robokin.number_text import show
from robokin.records.envelope import envelope
from robokin.units import Units

COLUMNS = ("name", "joints", "condition", "values", "example", "lost")


def singular_record(
    robot: Robot, units: Units, task: TaskName | None, singularities: Sequence[Singularity]
) -> dict[str, Any]:
    """The document of `robokin singular`: the singular configurations for a task (None for the arm's own)."""
    whole = motion_task(robot, task)
    found = [singularity_record(robot, units, one) for one in singularities]
    head = envelope("robot", robot.id, units)
    return head | {"task": whole.name, "full_rank": whole.dimension, "singularities": found}


def singularity_record(robot: Robot, units: Units, one: Singularity) -> dict[str, Any]:
    """The JSON of a condition, values in the units: numbers for one joint, a list for each set of values of several."""
    factors = joint_factors(robot, units)
    joints = [k - 1 for k in one.joints]
    values = in_units(one.values, factors[joints]).tolist()
    return {
        "name": one.name,
        "joints": list(one.joints),
        "condition": condition(robot, units, one),
        "values": [row[0] for row in values] if len(joints) == 1 else values,
        "within_limits": list(one.inside),
        "example": in_units(one.example, factors).tolist(),
        "example_within_limits": bool(robot.within_limits(one.example)),
        "lost": "; ".join(lost.words for lost in one.lost),
    }


def condition(robot: Robot, units: Units, one: Singularity) -> str:
    """The condition in a line: values, or an equation, or at least the joints that it is on."""
    if len(one.values):
        return " or ".join(value_texts(robot, units, one))
    names = ", ".join(f"q{k}" for k in one.joints)
    if one.equation is None:
        return f"det J = 0 in {names}" if robot.n <= 6 else f"det(J Jᵀ) = 0 in {names}"
    letters = one.equation.lettered
    text = f"{letters}: {numbers(units, one)}" if letters else numbers(units, one)
    return text if one.enough else f"{text}, and another equation in {names}"


def numbers(units: Units, one: Singularity) -> str:
    """The equation with numbers."""
    assert one.equation is not None
    parts = [(show(term.coefficient / units.metres), term.argument) for term in one.equation.terms]
    return f"{signed(parts)} = 0"


def value_texts(robot: Robot, units: Units, one: Singularity) -> list[str]:
    """Each set of values, as `q3 = 92.686391 = atan2(d4, a3)`."""
    factors = joint_factors(robot, units)[[k - 1 for k in one.joints]]
    texts = []
    for row, exact in zip(in_units(one.values, factors), one.exact, strict=True):
        parts = [f"q{k} = {show(value)}" for k, value in zip(one.joints, row, strict=True)]
        texts.append(", ".join(parts) + (f" = {exact}" if exact else ""))
    return texts


def row(record: dict[str, Any]) -> list[str]:
    """The cells of a CSV: numbers of a list separated by blanks, sets of values by semicolons."""

    def cell(value: Any) -> str:
        if isinstance(value, list):
            nested = bool(value) and isinstance(value[0], list)
            return ("; " if nested else " ").join(cell(item) for item in value)
        return str(value)

    return [cell(record[name]) for name in COLUMNS]
