"""Where configurations come from: --q, a file, or standard input."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

from robokin.cli.arguments import parse_configuration
from robokin.errors import InputError
from robokin.model import Robot
from robokin.units import Units

Array = NDArray[np.float64]


def configurations(
    robot: Robot, units: Units, q: list[str] | None, input: str | None
) -> tuple[Iterable[Array], bool, bool]:
    """Blocks of configurations (m, n) in the units, whether they are a stream, and whether there is just one.

    Raises InputError for options that contradict each other, or say nothing.
    """
    if not robot.n:
        raise InputError(f"{robot.name} has no joints, expected a robot that can move")
    if input is not None and q:
        raise InputError("--input and --q exclude each other, expected one of them")
    source = input if input is not None else "-" if q == ["-"] else None
    if source is not None:
        return read_configurations(source, robot, units), True, False
    if not q:
        example = ",".join(["0"] * robot.n)
        raise InputError(
            f"--q is missing, expected {robot.n} values, one for each joint of {robot.name} ({robot.types}), "
            f"such as --q {example}; --q - reads standard input"
        )
    if "-" in q:
        raise InputError("--q - stands for all configurations on standard input, expected no other --q beside it")
    given = np.array([parse_configuration(text, robot, units) for text in q])
    return [given], False, len(given) == 1


def read_configurations(source: str, robot: Robot, units: Units) -> Iterator[Array]:
    """Blocks of configurations (m, n) from a file or from standard input, in the units."""
    from robokin.cli.rows import Columns, open_input, read_rows

    columns = Columns(
        names=tuple(f"q{i}" for i in range(1, robot.n + 1)),
        aliases=tuple(joint.name for joint in robot.joints),
        angles=tuple(bool(turns) for turns in robot.revolute),
        key="q",
        what=f"one for each joint of {robot.name} ({robot.types})",
    )
    with open_input(source) as (stream, name):
        yield from read_rows(stream, name, columns, units)
