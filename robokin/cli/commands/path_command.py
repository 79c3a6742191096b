"""`robokin path`: from one configuration to others, or to poses, in time."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Annotated, Any

import typer

from robokin.cli.completion import named_poses, words
from robokin.cli.option_groups import ArrayOutputOptions, DescriptionOptions
from robokin.cli.options import RobotArgument, choose, option, whole_number
from robokin.cli.statuses import DONE, NO, say
from robokin.cli.target_options import TargetOptions
from robokin.cli.timing_options import TimingOptions
from robokin.errors import InputError, counted

if TYPE_CHECKING:
    from robokin.inverse.path_goals import Goal
    from robokin.model import Robot
    from robokin.units import Units


TASKS = ("pose", "position")

TRANSFORM = re.compile(r"[A-Z]\w*\s*\(")
"""What transforms have, and joint values with formulas, such as sqrt(2), have not."""

STEPS = 100
"""Steps when nobody says how many."""


STRAIGHT = "line"
"""What --arc says of a piece that is straight."""


def command(
    robot: RobotArgument,
    *,
    from_: Annotated[
        str | None, option("--from", "Q", "Where it starts: joint values, a named pose, or a transform.", named_poses)
    ] = None,
    to: Annotated[
        list[str] | None,
        option("--to", "Q", "Where it goes: joint values, a named pose, or a transform; repeatable.", named_poses),
    ] = None,
    target: TargetOptions,
    steps: Annotated[
        str | None, option("--steps", "N", "Steps, of each piece of a line; a row more is written.  [default: 100]")
    ] = None,
    joint: Annotated[
        bool, typer.Option("--joint", help="All joints together, each from its value to the other; the default.")
    ] = False,
    line: Annotated[bool, typer.Option("--line", help="The tool in a straight line, on one branch.")] = False,
    arc: Annotated[
        list[str] | None,
        option("--arc", "X,Y,Z", "The tool along the circle by this place; one for each --to, or 'line'."),
    ] = None,
    task: Annotated[
        str | None,
        option(
            "--task",
            "TASK",
            "What follows the line: pose or position.  [default: position for arms that place a point, else pose]",
            words(*TASKS),
        ),
    ] = None,
    hold: Annotated[
        list[str] | None,
        option("--hold", "JOINT=VALUE", "Fix a joint, such as q3=20, or q3 where it starts; repeatable."),
    ] = None,
    plot: Annotated[
        str | None,
        option("--plot -p", "FILE", "Draw it to .html that plays it, .gif, or a still: .png, .svg, .pdf."),
    ] = None,
    no_limits: Annotated[bool, typer.Option("--no-limits", help="Also outside the joint limits.")] = False,
    timing: TimingOptions,
    output: ArrayOutputOptions,
    description: DescriptionOptions,
) -> int:
    """A path in time: joint by joint through points, along straight lines, or along an arc.

    Without options about time t runs from 0 to 1, at rest at both ends, by a quintic. With --duration or --max-velocity
    t is in seconds, and velocities and accelerations of the joints are written too. All joints begin and end each piece
    together; at each point between they stop, unless --spline or --blend says how to pass. Lines and arcs stop too,
    unless --blend or --blend-radius rounds their corners: by how much each point is missed is said.

    From a pose (--from with a transform) the best branch over the whole path is taken: that of which the joint that
    travels farthest travels least. Where a path breaks, it is said which other start gets to the end.

    --xyz alone keeps the orientation of the start. A straight line turns about one fixed axis. It ends where a joint
    leaves its limits, where there is no solution, or where a joint would have to jump; the rows up to there are
    written, how far it goes is said, and the status is 3.
    Singularities on the way are said with the fraction of the path. A CSV or an array has the columns t, q1...qn, x, y,
    z, roll, pitch, yaw, and in seconds qd1...qdn, qdd1...qddn.

    Examples:
        robokin path puma560 --from 90,-30,60,0,40,0 --to 60,-20,70,10,30,0
        robokin path puma560 --from 90,-30,60,0,40,0 --xyz -300,700,200 --line -f csv
        robokin path planar3r --from 10,40,20 --xy 0.9,1.2 --phi 90 --line -f csv
        robokin path scara --from 0,60,100,0 --to 40,30,50,90 --json
        robokin path ur5e --from "Trans(500,300,200)" --to "Trans(0,500,300)" --line
        robokin path planar2r --from 0,10 --to 40,20 --to 20,80 --duration 3 --spline
        robokin path planar2r --from 30,40 --xy -0.9,0.1 --line --duration 2 -f csv
        robokin path puma560 --from home --xyz -300,700,200 --line --plot line.html
        robokin path planar2r --from 30,40 --to 60,30 --to 20,80 --line --blend 0.5
        robokin path panda --from 0,-30,0,-100,0,90,0 --xyz 400,0,400 --line --hold q3
    """
    from robokin.inverse.follow import MOST
    from robokin.inverse.held_paths import path_with_held_joints
    from robokin.inverse.path_goals import Manner, expect_near
    from robokin.inverse.paths_to_poses import path_through
    from robokin.pictures.picture_files import MOVING, picture_ending
    from robokin.records.path_records import PathRecords
    from robokin.reports.path_report import PathReport
    from robokin.tables.sink import sink

    kind = output.kind
    if plot is not None:
        picture_ending(plot, "--plot", MOVING)
    way: Any = "line" if line else "arc" if arc else "joint"
    chosen_ways = [name for name, flag in (("--joint", joint), ("--line", line), ("--arc", arc)) if flag]
    if len(chosen_ways) > 1:
        raise InputError(f"{' and '.join(chosen_ways)} exclude each other, expected one of them")
    if task is not None and way == "joint":
        raise InputError("--task goes with --line and --arc, which need to know what follows the line")
    chosen: Any = choose(task, TASKS, "--task")
    count = whole_number(steps, "--steps", 1, MOST) or STEPS
    model, units = description.moving_robot(robot)
    if from_ is None:
        example = ",".join(["0"] * model.n)
        raise InputError(f"--from is missing, expected {model.n} values or a named pose, such as --from {example}")
    begin = _goal(from_, model, units, "--from")
    target.exclude("--to", to or None)
    if not to and not target.given:
        raise InputError("there is no end, expected --to, --pose, --matrix, --xyz or --xy")
    goals = [_goal(text, model, units, "--to") for text in to or []] or [_target(target.texts, model, units)]
    expect_near(model, (begin, *goals))
    goals = _with_places(goals, arc or [], model, units)
    timed, rounding = timing.read(model, units, way), timing.rounding(units, way)
    manner = Manner(way, not no_limits, chosen, timed, rounding=rounding)
    held = _held(hold or [], model, units, manner.limits, [("--from", begin), *(("--to", goal) for goal in goals)])
    start = begin if begin.q is None else begin.q
    path = (
        path_with_held_joints(model, held, start, goals, count, manner)
        if held
        else path_through(model, start, goals, count, manner)
    )
    answer = PathReport(PathRecords(path, units), goals[-1].q if way != "joint" else None)
    if kind not in ("table", "json"):
        for sentence in answer.notes():
            say(sentence)
    if plot is not None:
        from robokin.pictures.drawn_path import path_picture

        told = [*answer.event_notes(), *answer.turn_notes(), *answer.end_notes()]
        picture = path_picture(path, units, plot.rpartition(".")[2].lower(), told, words=description.words(robot))
        with sink(plot, "--plot") as stream:
            stream.write(picture)
    with sink(output.file) as stream:
        stream.writelines(answer.write(kind, stream))
    return DONE if path.complete else NO


def _goal(text: str, robot: Robot, units: Units, name: str) -> Goal:
    """What a --from or --to says: joint values, a named pose, or a transform."""
    from robokin.cli.configurations import typed_configurations
    from robokin.cli.targets import parse_target
    from robokin.inverse.path_goals import Goal
    from robokin.model.joint_units import joint_factors

    if not TRANSFORM.search(text):
        return Goal(typed_configurations([text], robot, units, name)[0] * joint_factors(robot, units))
    try:
        found = parse_target({"--pose": text}, robot, units)
    except InputError as error:
        raise InputError(str(error).replace("--pose", name, 1)) from None
    for note in found.notes:
        say(note)
    return Goal(T=found.T, task=found.task)


def _held(
    texts: list[str], robot: Robot, units: Units, limits: bool, goals: list[tuple[str, Goal]]
) -> dict[int, float]:
    """The held joints (from 0) and their values [rad | m], which those of the goals must be, by their options."""
    from robokin.cli.configurations import note_held_units
    from robokin.cli.held_joints import expect_held, parse_hold
    from robokin.model.joint_units import in_units, joint_factors

    factors, start = joint_factors(robot, units), goals[0][1].q
    held = parse_hold(texts, robot, units, limits, None if start is None else in_units(start, factors))
    if held:
        note_held_units(held, robot, units)
    for said, goal in goals:
        expect_held(goal.q, held, robot, units, said)
    return {joint: value * float(factors[joint]) for joint, value in held.items()}


def _with_places(goals: list[Goal], texts: list[str], robot: Robot, units: Units) -> list[Goal]:
    """The goals, each with the place by which an arc goes to it, if one does."""
    from dataclasses import replace

    from robokin.cli.targets import parse_place

    if not texts:
        return goals
    if len(texts) != len(goals):
        ends, places = counted(len(goals), "end"), counted(len(texts), "place")
        expected = "an --arc for each --to, 'line' for a straight piece" if len(goals) > 1 else "one --arc"
        raise InputError(f"--arc: found {places} for {ends}, expected {expected}")
    vias = [None if text.strip() == STRAIGHT else parse_place(text, "--arc", robot, units) for text in texts]
    if not any(via is not None for via in vias):
        raise InputError(f"--arc: found '{STRAIGHT}' alone, expected a place on a circle, or --line")
    return [replace(goal, via=via) for goal, via in zip(goals, vias, strict=True)]


def _target(texts: dict[str, str | None], robot: Robot, units: Units) -> Goal:
    """The goal that the options of a target say."""
    from robokin.cli.targets import parse_target
    from robokin.inverse.path_goals import Goal

    target = parse_target(texts, robot, units)
    for note in target.notes:
        say(note)
    return Goal(T=target.T, task=target.task)
