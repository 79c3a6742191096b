"""`robokin plot`: pictures of an arm or a mechanism, still or turning."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from robokin.cli.completion import named_poses
from robokin.cli.options import (
    AngleOption,
    FormatOption,
    JsonOption,
    LengthOption,
    RobotArgument,
    SetOption,
    effective_units,
    output_format,
    parameter_overrides,
)
from robokin.cli.statuses import DONE, NO
from robokin.cli.target_options import (
    ApproachOption,
    EulerOption,
    MatrixOption,
    PhiOption,
    PoseOption,
    QuatOption,
    RpyOption,
    XyOption,
    XyzOption,
    target_texts,
)

if TYPE_CHECKING:
    from robokin.model import Mechanism
    from robokin.units import Units


def command(
    robot: RobotArgument,
    q: Annotated[
        list[str] | None,
        typer.Option(
            "--q",
            metavar="Q",
            help="Joint values, or the name of a pose of the description. Repeatable: all but the first are drawn "
            "pale.  [default: home, else zero]",
            autocompletion=named_poses,
        ),
    ] = None,
    ik: Annotated[
        str | None,
        typer.Option(
            "--ik",
            metavar="EXPR",
            help="A target, as a transform expression or X,Y,Z: all solutions. Or the target options of `robokin ik`.",
        ),
    ] = None,
    pose: PoseOption = None,
    matrix: MatrixOption = None,
    xyz: XyzOption = None,
    rpy: RpyOption = None,
    euler: EulerOption = None,
    quat: QuatOption = None,
    approach: ApproachOption = None,
    xy: XyOption = None,
    phi: PhiOption = None,
    frames: Annotated[bool, typer.Option("--frames", help="Also the frame after each row of the table.")] = False,
    view: Annotated[
        str | None,
        typer.Option(
            "--view", metavar="AZ,EL", help="Azimuth and elevation of the eye in degrees.  [default: -58,22 or flat]"
        ),
    ] = None,
    mode: Annotated[
        str | None,
        typer.Option("--mode", metavar="N", help="Which way to put a mechanism's links of given lengths together."),
    ] = None,
    output: Annotated[
        str | None,
        typer.Option("--output", "-o", metavar="FILE", help="Draw to .png, .svg, .pdf, or .html that turns."),
    ] = None,
    format: FormatOption = None,
    json: JsonOption = False,
    angle: AngleOption = None,
    length: LengthOption = None,
    set_: SetOption = None,
) -> int:
    """A picture of an arm or a mechanism: links, joints by kind, frames, and every solution of a target.

    Joints that turn are cylinders along their axes, joints that slide are boxes with their stroke; frames are x red,
    y green, z blue. An .html is one page that needs no network: the arm turns with the mouse and has a slider for
    each joint; a mechanism has one along its motion. Without --output a stick figure is drawn as text; --json has its
    corners. `robokin dof NAME --plot FILE` draws a mechanism with another drive, or the paths of points.

    The status is 3 when the target cannot be reached; the nearest configuration is then drawn.

    Examples:
        robokin plot puma560
        robokin plot puma560 --frames -o puma.html
        robokin plot planar3r --q 30,40,50 --q 60,20,10 --json
        robokin plot puma560 --ik "Trans(500,149,200) RPY(0,90,0)" -o arms.html
        robokin plot scara --ik 400,200,300 -f csv
        robokin plot planar3r --xy 0.9,1.2 --phi 90
        robokin plot bennett -o bennett.html
    """
    import numpy as np

    from robokin.cli.arguments import joint_factors, load_entry, load_robot, parse_configuration, way_of
    from robokin.cli.output.sink import sink
    from robokin.cli.plots import FARTHEST, answer, asked, ending_of, scene_of, view_of, wanted_target
    from robokin.cli.poses import PoseMaker
    from robokin.cli.statuses import say
    from robokin.errors import InputError
    from robokin.kinematics.forward import joint_frames
    from robokin.model import Mechanism
    from robokin.pictures.arm import default_configuration

    options = target_texts(pose, matrix, xyz, rpy, euler, quat, approach, xy, phi)
    kind = output_format(format, json)
    if output is not None and kind is not None:
        raise InputError("--output draws a picture by the file's ending, expected no --format and no --json")
    ending = ending_of(output) if output is not None else ""
    eye = view_of(view)
    loaded = load_entry(robot, parameter_overrides(set_), way_of(mode))
    if isinstance(loaded, Mechanism):
        for option, value in (("--q", q), ("--ik", ik), *options.items(), ("--frames", frames)):
            if value:
                raise InputError(f"{option} is for robots, expected none for a mechanism: `robokin dof` has --drive")
        _draw_mechanism(loaded, effective_units(loaded.units, length, angle), kind, output, eye)
        return DONE
    model = load_robot(robot, parameter_overrides(set_))
    units = effective_units(model.units, length, angle)
    if q and "-" in q:
        raise InputError("--q: found '-', expected joint values or the name of a pose; a picture reads no input")
    values = [parse_configuration(text, model, units) for text in q or []]
    if values:
        for note in PoseMaker(model, units, False).outside_notes(np.array(values)):
            say(note)
    given, name = [value * joint_factors(model, units) for value in values], ""
    if q and q[0].strip() in model.poses:
        name = q[0].strip()
    target = wanted_target(ik, options, model, units)
    if not given and target is None:
        home, name = default_configuration(model)
        given = [home]
    wanted = asked(model, units, given, target)
    if not wanted.postures:
        home, name = default_configuration(model)
        wanted = type(wanted)(asked(model, units, [home], None).postures, wanted.target, wanted.result, wanted.notes)
    for posture in wanted.postures:
        if not np.max(np.abs(joint_frames(model, posture.q)[:, :3, 3])) < FARTHEST:
            raise InputError("--q: the arm is too long for a picture, expected smaller values")
    for note in wanted.notes:
        say(note)
    scene = scene_of(model, units, wanted, name, eye, frames)
    if output is None:
        with sink(None) as stream:
            for data in answer(kind or "table", scene, wanted):
                stream.write(data)
    else:
        if ending == ".html":
            from robokin.pictures.arm_page import arm_page

            data = arm_page(scene)
        else:
            from robokin.pictures.arm_stills import arm_still

            data = arm_still(scene, ending[1:])
        with sink(output) as stream:
            stream.write(data)
    return NO if wanted.unreachable else DONE


def _draw_mechanism(
    mechanism: Mechanism, units: Units, kind: str | None, output: str | None, eye: tuple[float, float] | None
) -> None:
    """Write a mechanism's picture, or what it shows."""
    from pathlib import Path

    from robokin.cli.mechanism_plots import answer, check_drawable, motion_to_draw, picture_of
    from robokin.cli.output.sink import sink
    from robokin.cli.statuses import say
    from robokin.pictures.mechanism_scene import mechanism_scene

    check_drawable(mechanism, output, "--output")
    if output is None:
        with sink(None) as stream:
            for data in answer(kind or "table", mechanism_scene(mechanism, None, None, units, eye)):
                stream.write(data)
        return
    moved, note = motion_to_draw(mechanism)
    if note:
        say(f"drawn as it stands: {note}")
    picture = picture_of(mechanism, moved, None, units, Path(output).suffix.lower(), eye)
    with sink(output) as stream:
        stream.write(picture)
