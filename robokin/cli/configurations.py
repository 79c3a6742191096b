"""Where configurations come from: --q, a file, or standard input."""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Iterator, Mapping, Sequence

import numpy as np

from robokin.arrays import Array
from robokin.cli.arguments import parse_configuration, split_vector
from robokin.cli.statuses import say
from robokin.errors import InputError
from robokin.formats.typed_angles import unit_of_values
from robokin.model import Robot, Tree
from robokin.tables.carried import Carried
from robokin.units import Units


def configurations(
    robot: Robot | Tree, units: Units, q: list[str] | None, input: str | None, carried: Carried, *, still: bool = False
) -> tuple[Iterable[Array], bool, bool]:
    """Blocks of configurations (m, n) in the units, whether they are a stream, and whether there is just one.

    `still`: whether a robot that has no joints has an answer, without a configuration. Raises InputError for options
    that contradict each other, or say nothing.
    """
    if not robot.n and not still:
        raise InputError(f"{robot.name} has no joints, expected a robot that can move")
    if input is not None and q:
        raise InputError("--input and --q exclude each other, expected one of them")
    source = input if input is not None else "-" if q == ["-"] else None
    if source is not None and not robot.n:
        raise InputError(f"{robot.name} has no joints and one pose, expected no configurations to read")
    if source is not None:
        return read_configurations(source, robot, units, carried), True, False
    if not q and robot.n:
        example = ",".join(["0"] * robot.n)
        raise InputError(
            f"--q is missing, expected {robot.n} values, one for each joint of {robot.name} ({robot.types}), "
            f"such as --q {example}; --q - reads standard input"
        )
    if q and "-" in q:
        raise InputError("--q - stands for all configurations on standard input, expected no other --q beside it")
    given = typed_configurations(q or [""], robot, units)
    return [given], False, len(given) == 1


def typed_configurations(texts: Sequence[str], robot: Robot | Tree, units: Units, option: str = "--q") -> Array:
    """Joint values (m, n) in the units that an option says, with a note where they look like the other angle unit.

    Raises InputError that names the option.
    """
    given = np.array([parse_configuration(text, robot, units, option) for text in texts]).reshape(len(texts), robot.n)
    note_units(texts, robot, units, given, option)
    return given


def note_units(texts: Sequence[str], robot: Robot | Tree, units: Units, given: Array, option: str = "--q") -> None:
    """The note on joint values (m, n) in the units, as texts of an option say them; those of named poses are sure."""
    typed = [i for i, text in enumerate(texts) if text.strip() not in robot.poses]
    say_unit(robot, units, given[typed], "" if option == "--q" else f"{option}: ")


def note_answered_units(texts: Sequence[str], robot: Robot | Tree, units: Units) -> None:
    """The same of answers, which may hold anything: those that are no plain numbers say nothing."""
    told: list[str] = []
    rows: list[list[float]] = []
    for text in texts:
        with contextlib.suppress(ValueError):
            row = [float(part) for part in split_vector(text)]
            if len(row) == robot.n:
                told, rows = [*told, text], [*rows, row]
    note_units(told, robot, units, np.array(rows).reshape(len(rows), robot.n))


def read_configurations(source: str, robot: Robot | Tree, units: Units, carried: Carried) -> Iterator[Array]:
    """Blocks of configurations (m, n) from a file or from standard input, in the units.

    `carried` takes what is not understood.
    """
    from robokin.tables.joint_columns import JointColumns
    from robokin.tables.rows import read_rows

    for i, block in enumerate(read_rows(source, JointColumns(robot, units), carried, say)):
        if i == 0:
            say_unit(robot, units, block, "standard input: " if source == "-" else f"{source}: ")
        yield block


def note_held_units(held: Mapping[int, float], robot: Robot | Tree, units: Units) -> None:
    """The same of joints, from 0, that are held at values in the units."""
    values = np.zeros((1, robot.n))
    values[0, [*held]] = [*held.values()]
    say_unit(robot, units, values, "--hold: ")


def say_unit(robot: Robot | Tree, units: Units, q: Array, where: str = "") -> None:
    """A note where joint values q: (m, n) look like angles in the other unit."""
    if note := unit_of_values(robot, units, q):
        say(where + note)
