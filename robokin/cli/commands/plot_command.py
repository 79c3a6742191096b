"""`robokin plot`: pictures of an arm, a tree or a mechanism, still or turning."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from robokin.cli.completion import named_poses
from robokin.cli.option_groups import DescriptionOptions
from robokin.cli.options import FormatOption, JsonOption, RobotArgument, option, output_format
from robokin.cli.statuses import DONE, NO, say
from robokin.cli.target_options import TargetOptions
from robokin.errors import InputError, shown

if TYPE_CHECKING:
    from collections.abc import Iterable

    from robokin.arrays import Array
    from robokin.cli.targets import Target
    from robokin.model import Mechanism, Robot, Tree
    from robokin.units import Units


def command(
    robot: RobotArgument,
    *,
    q: Annotated[
        list[str] | None,
        option(
            "--q",
            "Q",
            "Joint values, or the name of a pose of the description. Repeatable: all but the first are drawn "
            "pale.  [default: home, else zero]",
            named_poses,
        ),
    ] = None,
    ik: Annotated[
        str | None,
        option(
            "--ik",
            "EXPR",
            "A target, as a transform expression or X,Y,Z: all solutions. Or the target options of `robokin ik`.",
        ),
    ] = None,
    target: TargetOptions,
    frames: Annotated[bool, typer.Option("--frames", help="Also the frame after each row of the table.")] = False,
    view: Annotated[
        str | None, option("--view", "AZ,EL", "Azimuth and elevation of the eye in degrees.  [default: -58,22 or flat]")
    ] = None,
    drive: Annotated[
        str | None, option("--drive", "JOINT", "The joint that leads a mechanism.  [default: the actuated one]")
    ] = None,
    point: Annotated[
        list[str] | None, option("--point", "LINK:X,Y", "Trace a point of a mechanism's link; repeatable.")
    ] = None,
    mode: Annotated[
        str | None, option("--mode", "N", "Which way to put a mechanism's links of given lengths together.")
    ] = None,
    output: Annotated[
        str | None, option("--output -o", "FILE", "Draw to .png, .svg, .pdf, .html that turns, or .gif of a mechanism.")
    ] = None,
    format: FormatOption = None,
    json: JsonOption = False,
    description: DescriptionOptions,
) -> int:
    """A picture of an arm, a hand or a mechanism: links, joints by kind, frames, and every solution of a target.

    Joints that turn are cylinders along their axes, joints that slide are boxes with their stroke; frames are x red,
    y green, z blue. An .html is one page that needs no network: the arm turns with the mouse and has a slider for
    each joint, in the branches of a hand or another tree; a mechanism is moved by its drive, and --point traces a
    point of a link. Without --output a stick figure is drawn as text; --json has its corners. `robokin path --plot`
    draws an arm that moves.

    The status is 3 when the target cannot be reached; the nearest configuration is then drawn.

    Examples:
        robokin plot puma560
        robokin plot puma560 --frames -o puma.html
        robokin plot planar3r --q 30,40,50 --q 60,20,10 --json
        robokin plot puma560 --ik "Trans(500,149,200) RPY(0,90,0)" -o arms.html
        robokin plot scara --ik 400,200,300 -f csv
        robokin plot planar3r --xy 0.9,1.2 --phi 90
        robokin plot human-hand --q pinch
        robokin plot human-hand --tip index --ik 150,30,-60 -o finger.html
        robokin plot bennett -o bennett.html
        robokin plot four-bar --point coupler:3,4 -o four-bar.gif
    """
    from dataclasses import replace

    from robokin.cli.arguments import expect_jointed, way_of
    from robokin.inverse.solutions import Question
    from robokin.model import Mechanism, Tree
    from robokin.pictures.arm import default_configuration
    from robokin.pictures.drawn_arm import AskedPostures, arm_picture, given_postures, scene_of, solved_postures
    from robokin.pictures.picture_files import picture_ending
    from robokin.reports.picture_report import arms_written
    from robokin.tables.sink import sink

    kind = output_format(format, json)
    if output is not None and kind is not None:
        raise InputError("--output draws a picture by the file's ending, expected no --format and no --json")
    eye = _view(view)
    loaded = description.anything(robot, way_of(mode))
    if isinstance(loaded, Mechanism):
        if output is None and (drive or point):
            raise InputError(f"{'--drive' if drive else '--point'} is about a motion, expected --output with it")
        for option, value in (("--q", q), ("--ik", ik), *target.texts.items(), ("--frames", frames)):
            if value:
                raise InputError(f"{option} is for robots, expected none for a mechanism, which --drive moves")
        _draw_mechanism(loaded, description, kind, output, eye, drive, point or [], description.words(robot))
        return DONE
    ending = picture_ending(output, "--output") if output is not None else ""
    if drive or point:
        raise InputError(f"{'--drive' if drive else '--point'} is for mechanisms, expected one of those")
    model = expect_jointed(robot, loaded)
    units = description.over(model.units)
    given, name = _configurations(q, model, units)
    asked = _wanted_target(ik, target, model, units)
    if not given and asked is None:
        home, name = default_configuration(model)
        given = [home]
    if asked is None or isinstance(model, Tree):
        wanted = AskedPostures(given_postures(model, units, given))
    else:
        wanted = solved_postures(Question(model, asked.T, asked.task), units, given, asked.notes)
    if not wanted.postures:
        home, name = default_configuration(model)
        wanted = replace(wanted, postures=given_postures(model, units, [home]))
    scene = replace(scene_of(model, units, wanted, name, eye, frames, "--q"), words=description.words(robot))
    for note in wanted.notes:
        say(note)
    drawn = arms_written(kind or "table", scene, wanted) if output is None else [arm_picture(scene, ending[1:])]
    with sink(output) as stream:
        stream.writelines(drawn)
    return NO if wanted.unreachable else DONE


def _configurations(q: list[str] | None, model: Robot | Tree, units: Units) -> tuple[list[Array], str]:
    """The configurations (n,) [rad | m] of --q, and the pose's name where the first is one. Raises InputError."""
    from robokin.cli.configurations import typed_configurations
    from robokin.model.joint_units import joint_factors
    from robokin.records.pose_blocks import PoseMaker

    if q and "-" in q:
        raise InputError("--q: found '-', expected joint values or the name of a pose; a picture reads no input")
    values = typed_configurations(q or [], model, units)
    if len(values):
        for note in PoseMaker(model, units, False).outside_notes(values):
            say(note)
    name = q[0].strip() if q and q[0].strip() in model.poses else ""
    return [value * joint_factors(model, units) for value in values], name


def _draw_mechanism(
    mechanism: Mechanism, description: DescriptionOptions, kind: str | None, output: str | None,
    eye: tuple[float, float] | None, drive: str | None, points: list[str], words: str,
) -> None:  # fmt: skip
    """Write a mechanism's picture, or what it shows."""
    from pathlib import Path

    from robokin.cli.mechanism_points import typed_point
    from robokin.mobility.point_paths import paths_of
    from robokin.pictures.drawn_mechanism import check_drawable, motion_to_draw, picture_of
    from robokin.pictures.mechanism_scene import mechanism_scene
    from robokin.reports.picture_report import mechanism_written
    from robokin.tables.sink import sink

    units = description.over(mechanism.units)
    check_drawable(mechanism, output, "--output")
    if output is None:
        drawn: Iterable[bytes] = mechanism_written(kind or "table", mechanism_scene(mechanism, None, None, units, eye))
    else:
        followed = [typed_point(text, mechanism, units) for text in points]
        moved, note = motion_to_draw(mechanism, drive)
        if note and (drive or followed):
            raise InputError(note)
        paths = paths_of(moved, followed) if moved is not None else None
        ending = Path(output).suffix.lower()
        drawn = [picture_of(mechanism, moved, paths, units, ending, eye, note if ending == ".gif" else "", words)]
        if note:
            say(f"drawn as it stands: {note}")
    with sink(output) as stream:
        stream.writelines(drawn)


def _view(text: str | None) -> tuple[float, float] | None:
    """Azimuth and elevation [°] of --view. Raises InputError."""
    from robokin.cli.arguments import parse_numbers
    from robokin.units import Units

    if text is None:
        return None
    azimuth, elevation = parse_numbers(text, "--view", [True] * 2, Units(angle="deg"), "azimuth, elevation in degrees")
    if abs(elevation) > 90.0 or abs(azimuth) > 360.0:
        raise InputError(f"--view: found {text}, expected an azimuth within ±360 and an elevation within ±90 degrees")
    return float(azimuth), float(elevation)


def _ik_target(text: str, robot: Robot, units: Units) -> Target:
    """The target of --ik: a transform expression, a matrix, a position x, y, z alone, or x, y of a planar arm."""
    from robokin.cli.arguments import split_vector
    from robokin.kinematics.structure import structure_of

    if not text.strip():
        raise InputError("--ik: found nothing, expected x,y,z or a transform expression")
    if text.lstrip().startswith("[["):
        return _target({"--matrix": text}, robot, units)
    # With a comma more, what commas outside parentheses separate is told from an expression.
    count = len(split_vector(text.strip().removeprefix("[").removesuffix("]") + ",0")) - 1
    if count > 3 or (count == 2 and structure_of(robot).arm != "planar"):
        raise InputError(f"--ik: found {count} values in '{shown(text)}', expected x,y,z or a transform expression")
    return _target({{2: "--xy", 3: "--xyz"}.get(count, "--pose"): text}, robot, units)


def _target(options: dict[str, str | None], robot: Robot, units: Units) -> Target:
    """The target that one of the options of `robokin ik` says, whose messages name --ik."""
    import re

    from robokin.cli.targets import parse_target

    try:
        return parse_target(options, robot, units)
    except InputError as error:
        raise InputError(re.sub(rf"{next(iter(options))}\b", "--ik", str(error))) from None


def _wanted_target(ik: str | None, options: TargetOptions, robot: Robot | Tree, units: Units) -> Target | None:
    """The target of --ik, or of the options that `robokin ik` has; None without. Raises InputError for both."""
    from robokin.cli.targets import parse_target
    from robokin.model import Tree

    options.exclude("--ik", ik)
    if isinstance(robot, Tree):
        for option in ["--ik"] if ik is not None else options.given:
            raise InputError(f"{option}: {robot.name} is a tree, expected --tip with one of {robot.listed_tips()}")
        return None
    if (ik is not None or options.given) and not robot.n:
        raise InputError(f"{robot.name} has no joints, expected a robot that can move")
    if ik is not None:
        return _ik_target(ik, robot, units)
    return parse_target(options.texts, robot, units) if options.given else None
