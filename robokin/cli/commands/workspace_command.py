"""`robokin workspace`: what an arm can reach, how much that is, and how freely the tool can be turned."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from robokin.cli.completion import robots, words
from robokin.cli.options import (
    AngleOption,
    AsOption,
    FormatOption,
    JsonOption,
    LengthOption,
    RobotArgument,
    SetOption,
    choose,
    effective_units,
    output_format,
    parameter_overrides,
)
from robokin.cli.statuses import DONE, NO

if TYPE_CHECKING:
    from robokin.model import Robot
    from robokin.units import Units

SAMPLINGS = ("sobol", "random", "grid")
HELD = ("joints", "poses")

MOST_SAMPLES = 10**12
"""Samples at most: days of work."""

MOST_CORES = 1024
"""Cores at most: more are a slip."""


def command(
    robot: RobotArgument,
    samples: Annotated[
        str | None, typer.Option("--samples", "-n", metavar="N", help="Number of points.  [default: 131072]")
    ] = None,
    seed: Annotated[str | None, typer.Option("--seed", metavar="N", help="Random seed.  [default: 0]")] = None,
    sampling: Annotated[
        str | None,
        typer.Option(
            "--sampling",
            metavar="KIND",
            help="sobol (even), random or grid.  [default: sobol]",
            autocompletion=words(*SAMPLINGS),
        ),
    ] = None,
    dextrous: Annotated[
        bool, typer.Option("--dextrous", help="Also how freely the tool can be turned, place by place.")
    ] = False,
    voxel: Annotated[
        str | None, typer.Option("--voxel", metavar="L", help="Side of the cells of the map of --dextrous.")
    ] = None,
    at: Annotated[
        list[str] | None,
        typer.Option(
            "--at", metavar="X,Y,Z", help="Is it reachable, with which orientations? X,Y for a planar arm. Repeatable."
        ),
    ] = None,
    section: Annotated[
        bool, typer.Option("--section", help="The half plane that the first joint turns: its area and boundary.")
    ] = False,
    slice_: Annotated[
        list[str] | None,
        typer.Option("--slice", metavar="z=H", help="The plane x, y or z at a length: area, boundary. Repeatable."),
    ] = None,
    compare: Annotated[
        str | None, typer.Option("--compare", metavar="ROBOT", help="Another robot beside it.", autocompletion=robots)
    ] = None,
    plot: Annotated[
        str | None,
        typer.Option("--plot", "-p", metavar="FILE", help="Draw to .png, .svg, .pdf, or .html that turns."),
    ] = None,
    output: Annotated[
        str | None,
        typer.Option("--output", "-o", metavar="FILE", help="Write the samples, to .csv, .jsonl, .npy or .ply."),
    ] = None,
    with_: Annotated[
        str | None,
        typer.Option(
            "--with",
            metavar="WHAT",
            help="What --output has beside positions: joints, poses or both.",
            autocompletion=words(*HELD),
        ),
    ] = None,
    as_: AsOption = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with a file of --output that was interrupted.")
    ] = False,
    cores: Annotated[
        str | None, typer.Option("--cores", metavar="N", help="Cores to work on; the answer is the same.")
    ] = None,
    format: FormatOption = None,
    json: JsonOption = False,
    angle: AngleOption = None,
    length: LengthOption = None,
    set_: SetOption = None,
) -> int:
    """What an arm can reach: bounds, volume or area with its error, holes, and how freely the tool turns.

    The tool's origin counts, with any orientation; joints stay within their limits. Every size comes with a bound
    that holds with 99 % confidence. In a terminal the section through the first joint's axis (of a planar arm: its
    plane) is drawn as text; --plot makes pictures.

    Places of an arm form three sets: those it reaches with some orientation, with more than one, and with every
    one (--dextrous). --at asks about a place; the status is 3 when it is out of reach. With --output the samples
    are written and nothing else is worked out.

    Examples:
        robokin workspace planar3r
        robokin workspace planar3r --dextrous --samples 8192
        robokin workspace scara --plot scara.html
        robokin workspace spherical --slice z=0.1 --json
        robokin workspace planar2r --compare planar3r
        robokin workspace planar3r --at 1,0.5
        robokin workspace puma560 --samples 1000 --with joints --output cloud.csv
    """
    from robokin.cli.arguments import load_robot, parse_numbers
    from robokin.errors import InputError

    kind = output_format(format, json) or "table"
    count = _whole(samples, "--samples", 1, MOST_SAMPLES)
    arguments: dict[str, Any] = {
        "samples": 131072 if count is None else count,
        "seed": _whole(seed, "--seed", 0, 2**63 - 1) or 0,
        "sampling": choose(sampling, SAMPLINGS, "--sampling") or "sobol",
        "cores": _whole(cores, "--cores", 1, MOST_CORES),
    }
    _one_question({"--at": at, "--compare": compare, "--output": output}, {"--dextrous": dextrous, "--section": section,
                  "--slice": slice_, "--plot": plot, "--voxel": voxel})  # fmt: skip
    if voxel is not None and not dextrous:
        raise InputError("--voxel: is the side of the cells of the map, expected --dextrous with it")
    for option, value in (("--with", with_), ("--as", as_), ("--resume", resume)):
        if value and output is None:
            raise InputError(f"{option}: says what is written to a file, expected --output FILE with it")
    if plot is not None:
        from robokin.cli.workspace_report import require_drawable

        require_drawable(plot)
    overrides = parameter_overrides(set_)
    model = load_robot(robot, overrides)
    units = effective_units(model.units, length, angle)
    if at:
        return _places(model, units, kind, at, arguments)
    if output is not None:
        if format is not None or json:
            raise InputError("--output writes samples by the file's ending, expected no --format and no --json")
        return _write(model, units, output, with_, as_, resume, arguments)
    if dextrous:
        arguments["dextrous"] = True
    if voxel is not None:
        (side,) = parse_numbers(voxel, "--voxel", [False], units, "a length")
        if not side > 0.0:
            raise InputError(f"--voxel: found {voxel}, expected a length greater than 0")
        arguments["voxel"] = float(side) * units.metres
    from robokin.cli.workspace_report import report

    robots = [model] if compare is None else [model, load_robot(compare, {})]
    from robokin.cli.progress import Stages

    with Stages():
        answer = list(report(robots, units, kind, (section, slice_ or []), plot, arguments))
    for data in answer:
        _print(data)
    return DONE


def _one_question(questions: dict[str, Any], more: dict[str, Any]) -> None:
    """Raise InputError where two things are asked for that have different answers."""
    from robokin.errors import InputError

    asked = [name for name, value in questions.items() if value]
    if len(asked) > 1:
        raise InputError(f"{asked[0]} and {asked[1]} exclude each other, expected one of them")
    beside = [name for name, value in more.items() if value]
    if asked and asked[0] != "--compare" and beside:
        raise InputError(f"{asked[0]} and {beside[0]} exclude each other, expected one of them")


def _places(robot: Robot, units: Units, kind: str, at: list[str], arguments: dict[str, Any]) -> int:
    """Which places can be reached, and how."""
    import numpy as np

    from robokin.cli.output.text import csv_records, json_document, json_line, json_list
    from robokin.cli.progress import Stages
    from robokin.cli.targets import parse_place
    from robokin.cli.workspaces import place_record
    from robokin.jobs.stages import stage
    from robokin.workspace.place import at_point
    from robokin.workspace.space import space_of

    points = [parse_place(text, "--at", robot, units) for text in at]
    space = space_of(robot)
    places = []
    with Stages():
        for number, point in enumerate(points, start=1):
            stage(f"place {number} of {len(points)}")
            places.append(at_point(space, np.asarray(point), seed=arguments["seed"]))
    if kind == "table":
        from robokin.cli.workspace_tables import places_table

        _print(places_table(places, robot.name, units))
    else:
        records = [place_record(place, robot.id, units) for place in places]
        if kind == "csv":
            names = ["reachable", "solutions", "group", "orientations", "reached", "fraction"]
            rows = [
                [*record["position"], str(record["reachable"]).lower(),
                 *("" if record[name] is None else record[name] for name in names[1:])]
                for record in records
            ]  # fmt: skip
            _print(csv_records(["x", "y", "z", *names], rows))
        elif kind == "json" and len(records) == 1:
            _print(json_document(records[0]))
        else:
            data = json_list([record] for record in records) if kind == "json" else map(json_line, records)
            for part in data:
                _print(part)
    return DONE if all(place.reachable for place in places) else NO


def _write(
    robot: Robot,
    units: Units,
    output: str,
    with_: str | None,
    as_: str | None,
    resume: bool,
    arguments: dict[str, Any],
) -> int:
    """Write samples to a file."""
    from robokin.cli.options import orientation_kind
    from robokin.cli.progress import Progress
    from robokin.cli.sample_files import write_samples
    from robokin.cli.sample_rows import Samples, sample_format
    from robokin.cli.statuses import say
    from robokin.errors import InputError
    from robokin.workspace.space import space_of

    held = [part.strip() for part in with_.split(",")] if with_ is not None else []
    for part in held:
        choose(part, HELD, "--with")
    turned = orientation_kind(as_) or "rpy"
    if as_ is not None and "poses" not in held:
        raise InputError("--as: says how poses are written, expected --with poses")
    samples = Samples(
        space_of(robot), units, sample_format(output), arguments["sampling"], arguments["seed"],
        arguments["samples"], "joints" in held, turned if "poses" in held else None,
    )  # fmt: skip
    with Progress("samples") as progress:
        before = write_samples(output, samples, arguments["cores"], resume, progress.told)
    if before:
        say(f"{before:,} of {samples.count:,} samples were there before")
    return DONE


def _print(data: bytes) -> None:
    """Bytes to standard output."""
    from robokin.cli.output.sink import sink

    with sink(None) as stream:
        stream.write(data)


def _whole(text: str | None, option: str, least: int, most: int) -> int | None:
    """A whole number within bounds. Raises InputError."""
    from robokin.errors import InputError, shown

    if text is None:
        return None
    digits = text.strip().replace("_", "")
    if not (digits.isascii() and digits.isdecimal() and len(digits) < 25) or not least <= int(digits) <= most:
        limit = f"of {least} or more" if most >= 2**62 else f"from {least} to {most}"
        raise InputError(f"{option}: found '{shown(text)}', expected a whole number {limit}")
    return int(digits)
