"""`robokin dof`: how freely a mechanism, a robot or a wheeled base can move."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from robokin.cli.completion import robots, words
from robokin.cli.options import (
    AngleOption,
    ArrayOutputOption,
    FormatOption,
    JsonOption,
    LengthOption,
    SetOption,
    choose,
    effective_units,
    output_format,
    parameter_overrides,
)
from robokin.cli.statuses import DONE
from robokin.errors import InputError, or_list, shown

if TYPE_CHECKING:
    from robokin.cli.motions import Point
    from robokin.mobility.trace import Trace
    from robokin.model import Mechanism
    from robokin.units import Units

SPACES = ("planar", "spherical", "spatial")

MOST_STEPS = 100_000
"""Configurations along a motion."""

MOST_LINKS = 10**6
"""Links of a bare count; more are a slip of the key."""


def command(
    name: Annotated[
        str | None,
        typer.Argument(
            metavar="[NAME]",
            help="A mechanism, a robot or a wheeled base: of `robokin list`, or a path to a description.",
            autocompletion=robots,
            show_default=False,
        ),
    ] = None,
    links: Annotated[
        str | None, typer.Option("--links", metavar="N", help="Count without a description: links, with the ground.")
    ] = None,
    joints: Annotated[
        str | None,
        typer.Option("--joints", metavar="JOINTS", help="With --links: joints by type, such as 6R or 12S,6P."),
    ] = None,
    space: Annotated[
        str | None,
        typer.Option(
            "--space",
            metavar="SPACE",
            help="With --links: planar, spherical or spatial.",
            autocompletion=words(*SPACES),
        ),
    ] = None,
    between: Annotated[
        str | None, typer.Option("--between", metavar="A,B", help="How link A moves against link B.")
    ] = None,
    trace: Annotated[
        str | None, typer.Option("--trace", metavar="N", help="Write N configurations along the motion instead.")
    ] = None,
    drive: Annotated[
        str | None,
        typer.Option("--drive", metavar="JOINT", help="The joint that leads the motion.  [default: the actuated one]"),
    ] = None,
    point: Annotated[
        list[str] | None,
        typer.Option(
            "--point", metavar="LINK:X,Y", help="Follow a point of a link, where it is as assembled; repeatable."
        ),
    ] = None,
    plot: Annotated[
        str | None,
        typer.Option(
            "--plot", "-p", metavar="FILE", help="Draw the mechanism to .png, .svg, .pdf, or .html that moves."
        ),
    ] = None,
    mode: Annotated[
        str | None,
        typer.Option("--mode", metavar="N", help="Which way to put links of given lengths together."),
    ] = None,
    seed: Annotated[
        str | None, typer.Option("--seed", metavar="N", help="Taken as before: nothing hangs on it.")
    ] = None,
    output: ArrayOutputOption = None,
    format: FormatOption = None,
    json: JsonOption = False,
    angle: AngleOption = None,
    length: LengthOption = None,
    set_: SetOption = None,
) -> int:
    """Degrees of freedom: Grübler's count, and what the geometry says.

    The count is written in both forms, F = λ(n − j − 1) + Σf and F = λ(n − 1) − ΣC. Where a mechanism's
    description has the geometry of its joints its true mobility stands beside it, with the reason why the two
    differ. A robot has its controllable and its total freedoms, a wheeled base its degrees of mobility,
    steerability and manoeuvrability.

    Joints by letters: R revolute, P prismatic, H helical, C cylindrical, U universal, S spherical, E planar,
    F fixed, G a contact (gears, cams, belts: 2 freedoms in the plane and on the sphere, 5 in space). A joint that
    pins m links counts as m − 1 joints.

    Examples:
        robokin dof four-bar
        robokin dof sarrus --json
        robokin dof puma560
        robokin dof car
        robokin dof --links 7 --joints 6R --space spatial
        robokin dof --links 14 --joints 12S,6P --space spatial --json
        robokin dof four-bar --between coupler,crank
        robokin dof slider-crank --trace 5
        robokin dof four-bar --trace 360 --point coupler:3,4 --output path.csv
    """
    from robokin.cli.output.sink import format_of, sink

    kind = format_of(output, output_format(format, json), arrays=True)
    if kind == "npy" and trace is None:
        raise InputError(f"--output {output}: an array holds configurations, expected --trace N with it")
    bare = {"--links": links, "--joints": joints, "--space": space}
    motion = {"--between": between, "--trace": trace, "--drive": drive, "--point": point, "--plot": plot}
    if name is None:
        _refuse(motion | {"--set": set_, "--mode": mode}, "is for a description", "its name")
        data = _bare(links, joints, space, kind)
    else:
        _refuse(bare, "counts without a description", f"it without {name}")
        from robokin.cli.arguments import way_of

        data = _described(
            name, kind, motion, _whole(seed, "--seed", 0, 2**63 - 1) or 0, (length, angle), set_, way_of(mode)
        )
    with sink(output) as stream:
        stream.write(data)
    return DONE


def _refuse(options: dict[str, Any], reason: str, expected: str) -> None:
    """Raise InputError for an option that does not belong here."""
    for option, value in options.items():
        if value:
            raise InputError(f"{option} {reason}, expected {expected}")


def _whole(text: str | None, option: str, least: int, most: int) -> int | None:
    """A whole number within bounds. Raises InputError."""
    if text is None:
        return None
    digits = text.strip()
    if not (digits.isascii() and digits.isdecimal() and len(digits) < 25) or not least <= int(digits) <= most:
        limit = f"of {least} or more" if most >= 2**62 else f"from {least} to {most}"
        raise InputError(f"{option}: found '{shown(text)}', expected a whole number {limit}")
    return int(digits)


def _bare(links: str | None, joints: str | None, space: str | None, kind: str) -> bytes:
    """The count of bare numbers; neither arrays nor descriptions are needed for it."""
    from robokin.cli.bare_counts import bare_record, parse_joints

    if links is None and joints is None and space is None:
        raise InputError("NAME is missing, expected a mechanism, a robot or a wheeled base, or --links and --joints")
    for option, value, example in (("--links", links, "--links 7"), ("--joints", joints, "--joints 6R"),
                                   ("--space", space, f"--space {or_list(SPACES)}")):  # fmt: skip
        if value is None:
            raise InputError(f"{option} is missing, expected for example {example}: a count needs all three")
    chosen = choose(space, SPACES, "--space")
    number = _whole(links, "--links", 1, MOST_LINKS)
    assert chosen is not None and number is not None and joints is not None
    return _written(bare_record(number, parse_joints(joints, chosen), chosen), kind)


def _written(record: dict[str, Any], kind: str) -> bytes:
    """The answer in a format."""
    from robokin.cli.output.text import csv_records, json_document, json_line

    if kind == "json":
        return json_document(record)
    if kind == "jsonl":
        return json_line(record)
    if kind == "csv":
        cells: dict[str, Any] = {}
        for key, value in record.items():
            if key not in ("schema", "id") and not isinstance(value, (dict, list)):
                cells[key] = value
            if key == "kind" and record["id"] is not None:
                cells["id"] = record["id"]
        return csv_records(list(cells), [list(cells.values())])
    from robokin.cli.mobility_tables import mobility_table, wheeled_table

    return wheeled_table(record) if record["kind"] == "wheeled" else mobility_table(record)


def _described(
    name: str, kind: str, motion: dict[str, Any], seed: int, unit_names: tuple[str | None, str | None],
    set_: list[str] | None, mode: int | None,
) -> bytes:  # fmt: skip
    """The answer about what a description describes."""
    from robokin.cli.arguments import load_entry
    from robokin.model import Mechanism, Robot

    entry = load_entry(name, parameter_overrides(set_), mode)
    units = effective_units(entry.units, *unit_names)
    if isinstance(entry, Mechanism):
        return _mechanism(entry, units, kind, motion, seed)
    _refuse(motion, "is for mechanisms", "one of those")
    if isinstance(entry, Robot):
        from robokin.cli.mobilities import robot_record

        return _written(robot_record(entry, units), kind)
    from robokin.cli.mobilities import wheeled_record
    from robokin.mobility.manoeuvrability import manoeuvrability_of

    return _written(wheeled_record(entry, manoeuvrability_of(entry), units), kind)


def _mechanism(mechanism: Mechanism, units: Units, kind: str, motion: dict[str, Any], seed: int) -> bytes:
    from robokin.cli.mobilities import mechanism_record
    from robokin.mobility.verdict import mobility_of

    steps, plot = _whole(motion["--trace"], "--trace", 1, MOST_STEPS), motion["--plot"]
    if steps is None and plot is None:
        about = {option: motion[option] for option in ("--drive", "--point")}
        _refuse(about, "is about a motion", "--trace N or --plot")
    if steps is not None and motion["--between"]:
        raise InputError("--trace and --between exclude each other, expected one of them")
    if plot is not None:
        from robokin.cli.mechanism_plots import check_drawable

        check_drawable(mechanism, plot, "--plot")
    if steps is not None or plot is not None:
        from robokin.cli.motions import MotionRows, parse_point

        points = [parse_point(text, mechanism, units) for text in motion["--point"] or []]
        wanted = bool(steps is not None or points or motion["--drive"])
        moved = _trace(mechanism, steps, motion["--drive"], wanted)
        if plot is not None:
            _plot(plot, mechanism, moved, points, units)
        if steps is not None and moved is not None:
            return MotionRows(moved, points, units).written(kind)
    found = mobility_of(mechanism, _pair(motion["--between"]), seed)
    return _written(mechanism_record(found, units, seed), kind)


def _plot(plot: str, mechanism: Mechanism, moved: Trace | None, points: list[Point], units: Units) -> None:
    """Draw to a file."""
    from pathlib import Path

    from robokin.cli.mechanism_plots import picture_of
    from robokin.cli.motions import paths_of
    from robokin.cli.output.sink import sink

    paths = paths_of(moved, points) if moved is not None else None
    picture = picture_of(mechanism, moved, paths, units, Path(plot).suffix.lower())
    with sink(plot, "--plot") as stream:
        stream.write(picture)


def _trace(mechanism: Mechanism, steps: int | None, drive: str | None, wanted: bool) -> Trace | None:
    """Configurations along the motion; None where a picture alone is asked of what does not move."""
    from robokin.cli.mechanism_plots import DRAWN_STEPS, motion_to_draw
    from robokin.mobility.trace import trace

    if wanted:
        return trace(mechanism, steps or DRAWN_STEPS, drive)
    return motion_to_draw(mechanism, drive)[0]  # what cannot move, or not be followed, can be drawn as it is


def _pair(between: str | None) -> tuple[str, str] | None:
    """The links of --between."""
    if between is None:
        return None
    names = [part.strip() for part in between.split(",")]
    if len(names) != 2 or not all(names):
        raise InputError(f"--between: found '{shown(between)}', expected two links with a comma: A,B")
    return names[0], names[1]
