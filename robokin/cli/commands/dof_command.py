"""`robokin dof`: how freely a mechanism, a robot or a wheeled base can move."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from robokin.cli.completion import robots, words
from robokin.cli.option_groups import ArrayOutputOptions, DescriptionOptions
from robokin.cli.options import choose, option, whole_number
from robokin.cli.statuses import DONE
from robokin.errors import InputError, or_list, shown

if TYPE_CHECKING:
    from robokin.mobility.point_paths import Point
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
    *,
    links: Annotated[str | None, option("--links", "N", "Count without a description: links, with the ground.")] = None,
    joints: Annotated[
        str | None, option("--joints", "JOINTS", "With --links: joints by type, such as 6R or 12S,6P.")
    ] = None,
    space: Annotated[
        str | None, option("--space", "SPACE", "With --links: planar, spherical or spatial.", words(*SPACES))
    ] = None,
    between: Annotated[str | None, option("--between", "A,B", "How link A moves against link B.")] = None,
    trace: Annotated[str | None, option("--trace", "N", "Write N configurations along the motion instead.")] = None,
    drive: Annotated[
        str | None, option("--drive", "JOINT", "The joint that leads the motion.  [default: the actuated one]")
    ] = None,
    point: Annotated[
        list[str] | None,
        option("--point", "LINK:X,Y", "Follow a point of a link, where it is as assembled; repeatable."),
    ] = None,
    plot: Annotated[
        str | None, option("--plot -p", "FILE", "Draw the mechanism to .png, .svg, .pdf, or .html and .gif that move.")
    ] = None,
    mode: Annotated[str | None, option("--mode", "N", "Which way to put links of given lengths together.")] = None,
    seed: Annotated[str | None, option("--seed", "N", "Taken as before: nothing hangs on it.")] = None,
    output: ArrayOutputOptions,
    description: DescriptionOptions,
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
    from robokin.reports.freedom_report import freedoms_written
    from robokin.tables.sink import sink

    kind = output.kind
    if kind == "npy" and trace is None:
        raise InputError(f"--output {output.file}: an array holds configurations, expected --trace N with it")
    bare = {"--links": links, "--joints": joints, "--space": space}
    motion = {"--between": between, "--trace": trace, "--drive": drive, "--point": point, "--plot": plot}
    if name is None:
        _refuse(motion | {"--set": description.set_, "--mode": mode}, "is for a description", "its name")
        answer: dict[str, Any] | bytes = _bare(links, joints, space)
    else:
        from robokin.cli.arguments import way_of

        _refuse(bare, "counts without a description", f"it without {name}")
        whole = whole_number(seed, "--seed", 0, 2**63 - 1) or 0
        answer = _described(name, kind, motion, whole, description, way_of(mode))
    data = answer if isinstance(answer, bytes) else freedoms_written(answer, kind)
    with sink(output.file) as stream:
        stream.write(data)
    return DONE


def _refuse(options: dict[str, Any], reason: str, expected: str) -> None:
    """Raise InputError for an option that does not belong here."""
    for name, value in options.items():
        if value:
            raise InputError(f"{name} {reason}, expected {expected}")


def _bare(links: str | None, joints: str | None, space: str | None) -> dict[str, Any]:
    """The count of bare numbers; neither arrays nor descriptions are needed for it."""
    from robokin.formats.joint_counts import parse_joints
    from robokin.records.count_records import bare_record

    if links is None and joints is None and space is None:
        raise InputError("NAME is missing, expected a mechanism, a robot or a wheeled base, or --links and --joints")
    for name, value, example in (
        ("--links", links, "7"),
        ("--joints", joints, "6R"),
        ("--space", space, or_list(SPACES)),
    ):
        if value is None:
            raise InputError(f"{name} is missing, expected for example {name} {example}: a count needs all three")
    chosen = choose(space, SPACES, "--space")
    number = whole_number(links, "--links", 1, MOST_LINKS)
    assert chosen is not None and number is not None and joints is not None
    return bare_record(number, parse_joints(joints, chosen), chosen)


def _described(
    name: str, kind: str, motion: dict[str, Any], seed: int, description: DescriptionOptions, mode: int | None
) -> dict[str, Any] | bytes:  # fmt: skip
    """The document about what a description describes, or the bytes of its motion."""
    from robokin.model import Mechanism, Robot, Tree

    entry = description.anything(name, mode)
    units = description.over(entry.units)
    if isinstance(entry, Mechanism):
        return _mechanism(entry, units, kind, motion, seed, description.words(name))
    _refuse(motion, "is for mechanisms", "one of those")
    if isinstance(entry, Robot | Tree):
        from robokin.records.freedom_records import jointed_record

        return jointed_record(entry, units)
    from robokin.mobility.manoeuvrability import manoeuvrability_of
    from robokin.records.freedom_records import wheeled_record

    return wheeled_record(entry, manoeuvrability_of(entry), units)


def _mechanism(
    mechanism: Mechanism, units: Units, kind: str, motion: dict[str, Any], seed: int, words: str
) -> dict[str, Any] | bytes:
    from robokin.mobility.verdict import mobility_of
    from robokin.records.freedom_records import mechanism_record

    steps, plot = whole_number(motion["--trace"], "--trace", 1, MOST_STEPS), motion["--plot"]
    if steps is None and plot is None:
        about = {option: motion[option] for option in ("--drive", "--point")}
        _refuse(about, "is about a motion", "--trace N or --plot")
    if steps is not None and motion["--between"]:
        raise InputError("--trace and --between exclude each other, expected one of them")
    if plot is not None:
        from robokin.pictures.drawn_mechanism import check_drawable

        check_drawable(mechanism, plot, "--plot")
    if steps is not None or plot is not None:
        from robokin.cli.mechanism_points import typed_point
        from robokin.records.motion_records import MotionRecords
        from robokin.reports.motion_report import motion_written

        points = [typed_point(text, mechanism, units) for text in motion["--point"] or []]
        wanted = bool(steps is not None or points or motion["--drive"])
        moved = _trace(mechanism, steps, motion["--drive"], wanted)
        if plot is not None:
            _plot(plot, mechanism, moved, points, units, words)
        if steps is not None and moved is not None:
            return motion_written(MotionRecords(moved, points, units), kind)
    found = mobility_of(mechanism, _pair(motion["--between"]), seed)
    return mechanism_record(found, units, seed)


def _plot(plot: str, mechanism: Mechanism, moved: Trace | None, points: list[Point], units: Units, words: str) -> None:
    """Draw to a file."""
    from pathlib import Path

    from robokin.mobility.point_paths import paths_of
    from robokin.pictures.drawn_mechanism import picture_of
    from robokin.tables.sink import sink

    paths = paths_of(moved, points) if moved is not None else None
    picture = picture_of(mechanism, moved, paths, units, Path(plot).suffix.lower(), words=words)
    with sink(plot, "--plot") as stream:
        stream.write(picture)


def _trace(mechanism: Mechanism, steps: int | None, drive: str | None, wanted: bool) -> Trace | None:
    """Configurations along the motion; None where a picture alone is asked of what does not move."""
    from robokin.mobility.trace import trace
    from robokin.pictures.drawn_mechanism import DRAWN_STEPS, motion_to_draw

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
