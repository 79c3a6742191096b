"""`robokin convert`: a robot in another convention, or in another format."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from robokin.cli.completion import words
from robokin.cli.option_groups import DescriptionOptions
from robokin.cli.options import JsonOption, RobotArgument, choose, option
from robokin.cli.statuses import say
from robokin.errors import InputError, or_list, shown

if TYPE_CHECKING:
    from robokin.model import Robot
    from robokin.units import Units

CONVENTIONS = ("standard", "modified", "frames")
FORMATS = ("yaml", "urdf", "markdown", "latex", "csv", "json", "jsonl")
ENDINGS = {".yaml": "yaml", ".yml": "yaml", ".urdf": "urdf", ".md": "markdown", ".tex": "latex", ".csv": "csv",
           ".json": "json", ".jsonl": "jsonl"}  # fmt: skip
"""Formats by the ending of the output's name."""


def command(
    robot: RobotArgument,
    *,
    convention: Annotated[
        str | None,
        option(
            "--convention",
            "NAME",
            "standard or modified (Denavit-Hartenberg tables) or frames.  [default: the robot's own]",
            words(*CONVENTIONS),
        ),
    ] = None,
    output: Annotated[
        str | None,
        option(
            "--output -o",
            "FILE",
            "Write to a file, by its ending: .yaml, .urdf, .md, .tex, .csv, .json or .jsonl; - prints.",
        ),
    ] = None,
    format: Annotated[
        str | None,
        option(
            "--format -f",
            "FORMAT",
            "yaml, urdf, markdown, latex, csv, json or jsonl.  [default: yaml]",
            words(*FORMATS),
        ),
    ] = None,
    json: JsonOption = False,
    description: DescriptionOptions,
) -> int:
    """A robot in another convention or format: a description, a URDF, a table for a paper.

    Every pose stays what it is. Parameters are worked out, fixed rows go into the rows after them, and what a table
    cannot hold stands in base and tool. Axes that are nearly but not quite parallel have no table worth the name; they
    are refused, and --convention frames holds them. A URDF is always of frames, in metres and radians.

    Examples:
        robokin convert puma560 --convention modified
        robokin convert scara-frames --convention standard -o scara.yaml
        robokin convert ur5e -o ur5e.urdf
        robokin convert planar2r -f markdown
        robokin convert panda --convention standard -o panda.tex
    """
    from dataclasses import replace

    from robokin.kinematics.dh_table import to_convention
    from robokin.tables.sink import sink

    kind = _format_of(output, choose(format, FORMATS, "--format"), json)
    wanted: Any = choose(convention, CONVENTIONS, "--convention")
    loaded, units = description.robot(robot)
    if kind == "urdf" and wanted not in (None, "frames"):
        raise InputError(f"--convention: found {wanted}, expected frames or nothing for a URDF, which has no tables")
    made = to_convention(loaded, wanted or loaded.convention)
    for note in made.notes[len(loaded.notes) :]:
        say(str(note))
    data = WRITERS[kind](replace(made, units=units), units)
    with sink(None if output == "-" else output) as stream:
        stream.write(data)
    return 0


def _format_of(output: str | None, chosen: str | None, json: bool) -> str:
    """The format to write: the chosen one, that of the output's ending, YAML. Raises InputError where they differ."""
    if json and chosen not in (None, "json"):
        raise InputError(f"--json and --format {chosen} exclude each other, expected one of them")
    chosen = "json" if json else chosen
    if output in (None, "-"):
        return chosen or "yaml"
    kind = ENDINGS.get(Path(str(output)).suffix.lower())
    if kind is None:
        if chosen is not None and not Path(str(output)).suffix:  # such as /dev/stdout
            return chosen
        raise InputError(f"--output: found '{shown(str(output))}', expected a name that ends with {or_list(ENDINGS)}")
    if chosen not in (None, kind):
        raise InputError(f"--output {output} and --format {chosen} say different things, expected one of them")
    return kind


def _yaml(robot: Robot, units: Units) -> bytes:
    from robokin.formats.written_robot import written

    return written(robot).encode()


def _urdf(robot: Robot, units: Units) -> bytes:
    from robokin.formats.written_urdf import urdf_text

    return urdf_text(robot).encode()


def _table(name: str) -> Callable[[Robot, Units], bytes]:
    """The writer of a table, a function of `robokin.reports.table_files`."""

    def write(robot: Robot, units: Units) -> bytes:
        from robokin.records.description_records import robot_record
        from robokin.reports import table_files

        record = robot_record(robot, units)
        if name == "csv_table" and (ends := table_files.ends_in_short(record)):
            say(f"a CSV has no place for {'; '.join(ends)}")
        data: bytes = getattr(table_files, name)(record)
        return data

    return write


def _document(kind: str) -> Callable[[Robot, Units], bytes]:
    """The writer of the document, the same as that of `robokin show`."""

    def write(robot: Robot, units: Units) -> bytes:
        from robokin.records.description_records import robot_record
        from robokin.tables.written_rows import written

        record = robot_record(robot, units)
        return b"".join(written(kind, record, [record], bytes, bytes))

    return write


WRITERS: dict[str, Callable[[Robot, Units], bytes]] = {
    "yaml": _yaml,
    "urdf": _urdf,
    "markdown": _table("markdown_table"),
    "latex": _table("latex_table"),
    "csv": _table("csv_table"),
    "json": _document("json"),
    "jsonl": _document("jsonl"),
}
