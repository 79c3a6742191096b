"""`robokin convert`: a robot in another convention, or in another format."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from robokin.cli.completion import words
from robokin.cli.option_groups import DescriptionOptions
from robokin.cli.options import JsonOption, RobotArgument, choose, option
from robokin.errors import InputError, or_list, shown

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
    are refused, and --convention frames holds them. A tree is written as its branches, each with a table, and with
    --tip as one chain. A URDF is always of frames, in metres and radians.

    Examples:
        robokin convert puma560 --convention modified
        robokin convert scara-frames --convention standard -o scara.yaml
        robokin convert ur5e -o ur5e.urdf
        robokin convert planar2r -f markdown
        robokin convert panda --convention standard -o panda.tex
        robokin convert human-hand --convention standard -o hand.yaml
    """

    from robokin.cli.written_forms import written_form
    from robokin.tables.sink import sink

    kind = _format_of(output, choose(format, FORMATS, "--format"), json)
    wanted: Any = choose(convention, CONVENTIONS, "--convention")
    loaded, units = description.robot_or_tree(robot)
    if kind == "urdf" and wanted not in (None, "frames"):
        raise InputError(f"--convention: found {wanted}, expected frames or nothing for a URDF, which has no tables")
    data = written_form(loaded, units, kind, wanted)
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
