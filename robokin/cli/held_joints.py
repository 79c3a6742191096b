"""What `--hold` says: joints of a robot and the values that they are held at."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from robokin.arrays import Array
from robokin.cli.arguments import parse_numbers
from robokin.errors import InputError, did_you_mean
from robokin.inverse.hold import held_inside
from robokin.model import Robot
from robokin.model.joint_units import in_units, joint_factors
from robokin.number_text import show
from robokin.units import Units

OPTION = "--hold"

ALIKE = 1e-9
"""Values in the units that differ by less, or by this part of them, are one."""


def parse_hold(
    texts: Sequence[str], robot: Robot, units: Units, limits: bool, start: Array | None = None
) -> dict[int, float]:
    """The held joints, from 0, with their values in the units, of texts such as `q3=20`, `3=20` or `elbow=20`.

    start: (n,) in the units, where a path starts: a joint without a value is held at its own there.

    Raises InputError for a joint that the robot does not have, one that is held twice, a value that is no number or,
    where `limits` count, outside the joint's limits.
    """
    held: dict[int, float] = {}
    for text in texts:
        name, equals, value = text.partition("=")
        name = name.strip()
        own = start is not None and not equals
        if not name or not (own or (equals and value.strip())):
            raise InputError(f"{OPTION}: found '{text}', expected JOINT=VALUE, such as q3=20")
        joint = _joint(name, robot)
        if joint in held:
            raise InputError(f"{OPTION}: q{joint + 1} is held twice, expected one value for a joint")
        option = f"{OPTION} {name}"
        turns = bool(robot.revolute[joint])
        if own:
            assert start is not None
            number = float(start[joint])
        else:
            (number,) = parse_numbers(value, option, [turns], units, "one value").tolist()
        factor = float(joint_factors(robot, units)[joint])
        if limits and not held_inside(robot, joint, number * factor):
            low, high = (robot.limits[joint] / factor).tolist()
            unit = units.angle if turns else units.length
            raise InputError(
                f"{option}: found {show(number)}, expected {show(low)} to {show(high)} {unit}: the joint's limits, "
                f"which --no-limits leaves out"
            )
        held[joint] = number
    if held and len(held) == robot.n:
        raise InputError(f"{OPTION}: all {robot.n} joints are held, expected at least one that can move")
    return held


def expect_held(q: Array | None, held: Mapping[int, float], robot: Robot, units: Units, option: str) -> None:
    """Raise InputError where joint values (n,) [rad | m] that an option says are others than the held ones."""
    if q is None:
        return
    values = in_units(q, joint_factors(robot, units))
    for joint, value in held.items():
        if abs(float(values[joint]) - value) > ALIKE * max(1.0, abs(value)):
            raise InputError(
                f"{option}: q{joint + 1} is {show(float(values[joint]))}, expected {show(value)}, at which {OPTION} "
                "keeps it"
            )


def _joint(name: str, robot: Robot) -> int:
    """The joint, from 0, that is meant: `q3` or `3` by its place, or by the name in the description."""
    names = [joint.name for joint in robot.joints]
    numbers = [f"q{i}" for i in range(1, robot.n + 1)]
    named = [i for i, own in enumerate(names) if own == name and not own.isdecimal()]
    placed = [i for i in range(robot.n) if name in (numbers[i], str(i + 1))]
    found = sorted({*named, *placed})
    if len(found) == 1:
        return found[0]
    if found:
        listed = " and ".join(f"joint {i + 1}" for i in found)
        raise InputError(f"{OPTION}: '{name}' names {listed}, expected the number of one of them")
    if name in [row.name for row in robot.rows if row.moves] and not name.isdecimal():
        raise InputError(f"{OPTION}: joint '{name}' follows others, expected one of {_listed(robot)}")
    known = [own for own in names if not own.isdecimal()]
    expected = f", expected {_listed(robot)}"
    raise InputError(f"{OPTION}: {robot.name} has no joint '{name}'{did_you_mean(name, known) or expected}")


def _listed(robot: Robot) -> str:
    return f"q1 to q{robot.n}" if robot.n > 1 else "q1"
