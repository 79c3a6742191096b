"""`robokin workspace`: what an arm can reach, how much that is, and how freely the tool can be turned."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from robokin.cli.cluster_options import MOST_ROWS, SAMPLE_ROWS, ClusterOption, PartRowsOption, working_on
from robokin.cli.completion import robots, words
from robokin.cli.cores import CoresOption, whole_cores
from robokin.cli.option_groups import DescriptionOptions
from robokin.cli.options import (
    AsOption,
    FormatOption,
    JsonOption,
    RobotArgument,
    choose,
    option,
    output_format,
    whole_number,
)
from robokin.cli.statuses import DONE, NO, say
from robokin.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from robokin.model import Robot
    from robokin.pictures.views import View
    from robokin.units import Units
    from robokin.workspace.space import Space

SAMPLINGS = ("sobol", "random", "grid")
HELD = ("joints", "poses")

MOST_SAMPLES = 10**12
"""Samples at most: days of work."""


def command(
    robot: RobotArgument,
    *,
    samples: Annotated[str | None, option("--samples -n", "N", "Number of points.  [default: 131072]")] = None,
    seed: Annotated[str | None, option("--seed", "N", "Random seed.  [default: 0]")] = None,
    sampling: Annotated[
        str | None, option("--sampling", "KIND", "sobol (even), random or grid.  [default: sobol]", words(*SAMPLINGS))
    ] = None,
    dextrous: Annotated[
        bool, typer.Option("--dextrous", help="Also how freely the tool can be turned, place by place.")
    ] = False,
    voxel: Annotated[str | None, option("--voxel", "L", "Side of the cells of the map of --dextrous.")] = None,
    at: Annotated[
        list[str] | None,
        option("--at", "X,Y,Z", "Is it reachable, with which orientations? X,Y for a planar arm. Repeatable."),
    ] = None,
    section: Annotated[
        bool, typer.Option("--section", help="The half plane that the first joint turns: its area and boundary.")
    ] = False,
    slice_: Annotated[
        list[str] | None, option("--slice", "z=H", "The plane x, y or z at a length: area, boundary. Repeatable.")
    ] = None,
    compare: Annotated[str | None, option("--compare", "ROBOT", "Another robot beside it.", robots)] = None,
    plot: Annotated[str | None, option("--plot -p", "FILE", "Draw to .png, .svg, .pdf, or .html that turns.")] = None,
    output: Annotated[
        str | None,
        option("--output -o", "FILE", "Write the samples, to .csv, .jsonl, .npy, .ply or .parquet, or to a FOLDER/."),
    ] = None,
    with_: Annotated[
        str | None, option("--with", "WHAT", "What --output has beside positions: joints, poses or both.", words(*HELD))
    ] = None,
    as_: AsOption = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with a file or a folder of --output that was interrupted.")
    ] = False,
    cores: CoresOption = None,
    cluster: ClusterOption = None,
    part_rows: PartRowsOption = None,
    format: FormatOption = None,
    json: JsonOption = False,
    description: DescriptionOptions,
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

    kind = output_format(format, json) or "table"
    count = whole_number(samples, "--samples", 1, MOST_SAMPLES, grouped=True)
    arguments: dict[str, Any] = {
        "samples": 131072 if count is None else count,
        "seed": whole_number(seed, "--seed", 0, 2**63 - 1, grouped=True) or 0,
        "sampling": choose(sampling, SAMPLINGS, "--sampling") or "sobol",
        "cores": whole_cores(cores),
    }
    if cluster is not None and cores is not None:
        raise InputError("--cluster and --cores exclude each other, expected one of them")
    _one_question({"--at": at, "--compare": compare, "--output": output}, {"--dextrous": dextrous, "--section": section,
                  "--slice": slice_, "--plot": plot, "--voxel": voxel})  # fmt: skip
    if voxel is not None and not dextrous:
        raise InputError("--voxel: is the side of the cells of the map, expected --dextrous with it")
    for name, value in (("--with", with_), ("--as", as_), ("--resume", resume), ("--part-rows", part_rows)):
        if value and output is None:
            raise InputError(f"{name}: says what is written to a file, expected --output FILE with it")
    if plot is not None:
        from robokin.pictures.picture_files import picture_ending
        from robokin.tables.sink import Destination

        picture_ending(plot, "--plot")
        Destination(plot, "--plot")
    model, units = description.robot(robot)
    if at:
        # To start processes takes as long as some places: only who asks for them gets them.
        arguments["cores"] = 1 if cores is None and cluster is None else arguments["cores"]
        with working_on(cluster):
            return _places(model, units, kind, at, arguments)
    if output is not None:
        if format is not None or json:
            raise InputError("--output writes samples by the file's ending, expected no --format and no --json")
        with working_on(cluster):
            return _write(model, units, output, (with_, as_), (resume, part_rows), arguments)
    if dextrous:
        arguments["dextrous"] = True
    if voxel is not None:
        (side,) = parse_numbers(voxel, "--voxel", [False], units, "a length")
        if not side > 0.0:
            raise InputError(f"--voxel: found {voxel}, expected a length greater than 0")
        arguments["voxel"] = float(side) * units.metres
    robots = [model] if compare is None else [model, load_robot(compare, {})]
    with working_on(cluster):
        return _analyse(robots, units, kind, (section, slice_ or []), plot, arguments)


def _analyse(
    robots: list[Robot], units: Units, kind: str, asked: tuple[bool, list[str]], plot: str | None,
    arguments: dict[str, Any],
) -> int:  # fmt: skip
    """The workspaces of one robot or two; `asked` tells whether for the section, and for which slices."""
    from pathlib import Path

    from robokin.cli.progress import Stages
    from robokin.jobs.stages import about, stage
    from robokin.pictures.workspace_cuts import cut_of
    from robokin.reports.workspace_pictures import plates_of, workspace_picture
    from robokin.reports.workspace_report import workspaces_written
    from robokin.tables.sink import sink
    from robokin.workspace.analyse import analyse_workspace
    from robokin.workspace.space import space_of

    with Stages():
        # What is asked for must exist before the work begins.
        views = [_views(space_of(robot), units, *asked) for robot in robots]
        samples, seed, cores = arguments["samples"], arguments["seed"], arguments["cores"]
        found, cuts, plates = [], [], []
        for robot, own in zip(robots, views, strict=True):
            about(robot.name if len(robots) > 1 else "")
            found.append(analyse_workspace(robot, **arguments))
            cuts.append([cut_of(view, samples, seed, cores) for view in own])
        about("")
        if plot is not None or (kind == "table" and len(robots) == 1):
            stage("picture")
        if plot is not None:
            drawn = workspace_picture(found, views, cuts, units, Path(plot).suffix.lower(), cores)
            with sink(plot, "--plot") as stream:
                stream.write(drawn)
        elif kind == "table" and len(robots) == 1:
            plates = plates_of(found[0], views[0], units, cores)
        answer = list(workspaces_written(found, cuts, units, kind, plates))
    with sink(None) as stream:
        stream.writelines(answer)
    return DONE


def _one_question(questions: dict[str, Any], more: dict[str, Any]) -> None:
    """Raise InputError where two things are asked for that have different answers."""
    asked = [name for name, value in questions.items() if value]
    if len(asked) > 1:
        raise InputError(f"{asked[0]} and {asked[1]} exclude each other, expected one of them")
    beside = [name for name, value in more.items() if value]
    if asked and asked[0] != "--compare" and beside:
        raise InputError(f"{asked[0]} and {beside[0]} exclude each other, expected one of them")


def _places(robot: Robot, units: Units, kind: str, at: list[str], arguments: dict[str, Any]) -> int:
    """Which places can be reached, and how."""
    import numpy as np

    from robokin.cli.progress import Stages
    from robokin.cli.targets import parse_place
    from robokin.jobs.stages import stage
    from robokin.reports.workspace_report import places_written
    from robokin.tables.sink import sink
    from robokin.workspace.place import at_points
    from robokin.workspace.space import space_of

    points = [parse_place(text, "--at", robot, units) for text in at]
    space = space_of(robot)
    places = []
    with Stages():
        answers = at_points(space, np.array(points), arguments["seed"], arguments["cores"])
        for number in range(len(points)):
            stage(f"place {number + 1} of {len(points)}")
            places.append(next(answers))
    with sink(None) as stream:
        stream.writelines(places_written(places, robot, units, kind))
    return DONE if all(place.reachable for place in places) else NO


def _write(
    robot: Robot, units: Units, output: str, content: tuple[str | None, str | None], way: tuple[bool, str | None],
    arguments: dict[str, Any],
) -> int:  # fmt: skip
    """Write samples to a file or a folder; `content` is --with and --as, `way` is --resume and --part-rows."""
    from robokin.cli.options import orientation_kind
    from robokin.cli.progress import Progress
    from robokin.reports.part_runs import PartRun, sample_parts
    from robokin.reports.sample_files import write_samples
    from robokin.reports.sample_rows import Samples, sample_format
    from robokin.reports.sample_tables import write_sample_table
    from robokin.tables.arrow_library import KINDS
    from robokin.tables.sink import is_folder
    from robokin.workspace.space import space_of

    with_, as_ = content
    resume, part_rows = way
    folder, cores = is_folder(output), arguments["cores"]
    if part_rows is not None and not folder:
        raise InputError("--part-rows: is about a folder of parts, expected --output FOLDER/ with it")
    rows = whole_number(part_rows, "--part-rows", 1, MOST_ROWS, grouped=True) or SAMPLE_ROWS
    held = [part.strip() for part in with_.split(",")] if with_ is not None else []
    for part in held:
        choose(part, HELD, "--with")
    turned = orientation_kind(as_) or "rpy"
    if as_ is not None and "poses" not in held:
        raise InputError("--as: says how poses are written, expected --with poses")
    samples = Samples(
        space_of(robot), units, "parquet" if folder else sample_format(output), arguments["sampling"],
        arguments["seed"], arguments["samples"], "joints" in held, turned if "poses" in held else None,
    )  # fmt: skip
    with Progress("samples") as progress:
        before = 0
        if folder:
            before = sample_parts(PartRun(output, resume, cores, progress.told), samples, rows)
        elif samples.kind in KINDS:
            write_sample_table(output, samples, cores, resume, progress.told)
        else:
            before = write_samples(output, samples, cores, resume, progress.told, say)
    if before:
        say(f"{before:,} of {samples.count:,} samples were there before")
    return DONE


def _views(space: Space, units: Units, section: bool, slices: Sequence[str]) -> list[View]:
    """The planes that --section and --slice ask for. Raises InputError where a robot has none such."""
    from robokin.cli.arguments import parse_numbers
    from robokin.pictures.views import section_view, slice_view

    views: list[View] = []
    if (section or slices) and space.dimension != 3:
        option = "--section" if section else "--slice"
        raise InputError(f"{option}: {space.robot.name} reaches no solid, expected an arm that does")
    if section:
        view = section_view(space)
        if view is None:
            turns = "does not turn it" if space.leads else "moves others, too"
            raise InputError(f"--section: the first joint of {space.robot.name} {turns}, expected --slice")
        views.append(view)
    for text in slices:
        name, equals, value = (part.strip() for part in text.partition("="))
        if name not in ("x", "y", "z") or not equals:
            raise InputError(f"--slice: found '{text}', expected x=, y= or z= and a length")
        at = float(parse_numbers(value, "--slice", [False], units, "a length")[0])
        views.append(slice_view(space, name, at * units.metres, f"{at:g} {units.length}"))
    return views
