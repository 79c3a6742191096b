"""`robokin ik`: poses to joint values, every solution."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Annotated, Any

import typer

from robokin.cli.cluster_options import SOLUTION_ROWS, PartOptions
from robokin.cli.completion import named_poses, tip_targets, words
from robokin.cli.cores import SOME, CoresOption, cores_worth, whole_cores
from robokin.cli.option_groups import DescriptionOptions, RowOutputOptions
from robokin.cli.options import TABLES, DropOption, RobotArgument, choose, option, orientation_kind, whole_number
from robokin.cli.statuses import DONE, NO, say
from robokin.cli.target_options import TargetOptions
from robokin.errors import InputError, counted

if TYPE_CHECKING:
    from robokin.arrays import Array
    from robokin.inverse.answers_in_turn import Following
    from robokin.units import Units


METHODS = ("auto", "analytic", "numeric")

DIGITS = 18
"""Digits of a whole number that is read."""


def command(
    robot: RobotArgument,
    *,
    target: TargetOptions,
    tips: Annotated[
        list[str] | None,
        option(
            "--target",
            "TIP=X,Y,Z|EXPR",
            "Of a tree with several tips: the position or the pose of one of them; repeatable.",
            tip_targets,
        ),
    ] = None,
    input: Annotated[
        str | None,
        option(
            "--input -i",
            "FILE",
            "A pose a line: x, y, z, roll, pitch, yaw or what else `robokin fk` writes (.csv, .jsonl, .json, "
            ".npy, .parquet), or x, y, z alone, or x, y, phi of a planar arm; - for standard input.",
        ),
    ] = None,
    near: Annotated[
        str | None,
        option(
            "--near",
            "Q",
            "Order by the greatest joint move from these values or this named pose; of a self-motion the "
            "nearest member is listed. Of a file also previous: each target by the solution nearest to the last one's.",
            named_poses,
        ),
    ] = None,
    max_jump: Annotated[
        str | None,
        option("--max-jump", "A", "With --near previous: a greater move of a joint is a jump.  [default: 30°]"),
    ] = None,
    method: Annotated[
        str | None, option("--method", "METHOD", "auto, analytic or numeric.  [default: auto]", words(*METHODS))
    ] = None,
    no_limits: Annotated[bool, typer.Option("--no-limits", help="Also solutions outside the joint limits.")] = False,
    max_: Annotated[str | None, option("--max", "N", "At most so many solutions for a target.")] = None,
    turns: Annotated[
        bool, typer.Option("--turns", help="Also the ±360° equivalents of each solution within the joint limits.")
    ] = False,
    hold: Annotated[
        list[str] | None,
        option("--hold", "JOINT=VALUE", "Fix a joint, such as q3=20, and solve for the others; repeatable."),
    ] = None,
    seed: Annotated[str | None, option("--seed", "N", "Random seed (default 0).")] = None,
    tol_position: Annotated[
        str | None, option("--tol-position", "L", "Take the nearest pose if its position error is no more.")
    ] = None,
    tol_angle: Annotated[
        str | None, option("--tol-angle", "A", "Take the nearest pose if its angle error is no more.")
    ] = None,
    explain: Annotated[
        bool, typer.Option("--explain", help="Also the closed-form steps with the numbers in them, as a lecture does.")
    ] = False,
    as_: Annotated[
        str | None,
        option(
            "--as",
            "KIND",
            "With --input, of rows without a header: rpy, quaternion (w x y z), quaternion-xyzw, euler (Z Y "
            "Z), rotvec, abc, wpr or matrix.  [default: rpy, or matrix for 16 columns]",
        ),
    ] = None,
    drop: DropOption = False,
    cores: CoresOption = None,
    scale: PartOptions,
    output: RowOutputOptions,
    description: DescriptionOptions,
) -> int:
    """Inverse kinematics: every joint configuration that reaches a pose.

    A target is a pose, a position with the direction of the tool's z axis, or a position alone. Angles and
    lengths are in the description's units unless --angle and --length say otherwise. Solutions are exact; with
    a tolerance, the nearest pose that can be reached will do where it is within it.

    The answer says whether all solutions are listed, and why that is known. Where joints can move while the pose
    stays (a self-motion), one solution stands for it and its intervals within the limits are given.

    The status is 3 when there is no solution, or in a batch when a target has none; the reason is said, and the
    configuration that comes nearest. A CSV has a row for each solution, which robokin fk reads; a target without
    one has a row with solution 0, which robokin fk leaves out.

    With --target several tips of a tree have targets at once: those that share no joints each with all
    solutions, others together with one.

    Examples:
        robokin ik puma560 --pose "Trans(-149.09,921.12,20.32) RPY(0,90,90)"
        robokin ik puma560 --xyz 500,100,300 --rpy 180,0,45 --near home --max 1
        robokin ik puma560 --xyz 500,100,300 --approach 0,0,-1 --json
        robokin ik planar3r-brac --xy 26.4743,50.8716 --phi 85
        robokin ik planar3r-brac --xy 26.4743,50.8716 --phi 85 --explain
        robokin ik panda --xyz 400,100,400 --rpy 180,0,0 --hold q3=20
        robokin ik ur5e --xyz 400,200,300 --rpy 180,0,0 --turns
        robokin ik scorbot --xyz 300,40,200 --rpy 0,170,8 --tol-angle 1
        robokin ik human-hand --target index=150,30,-60 --target thumb=100,23,-68
        robokin fk puma560 -i joints.csv -f csv | robokin ik puma560 -i - -f csv
    """
    from itertools import chain

    from robokin.cli.configurations import note_held_units, typed_configurations
    from robokin.cli.held_joints import parse_hold
    from robokin.cli.targets import parse_target
    from robokin.kinematics.flat_arm import flat_arm
    from robokin.model.joint_units import joint_factors
    from robokin.records.solution_records import RECORD_KEYS, SolutionRecords
    from robokin.reports.solution_report import SolutionReport, csv_columns
    from robokin.tables.carried import Carried

    if tips:
        from robokin.cli.tip_target_options import answer_tips, refuse_beside

        refuse_beside(
            {
                **target.texts, "--input": input, "--tip": description.tip, "--root": description.root,
                "--method": method, "--turns": turns, "--hold": hold or None, "--tol-position": tol_position,
                "--tol-angle": tol_angle, "--explain": explain, "--as": as_, "--drop": drop, "--cores": cores,
                "--cluster": scale.cluster, "--resume": scale.resume, "--part-rows": scale.part_rows,
            }
        )  # fmt: skip
        asked_for = {"limits": not no_limits, "most": _count(max_, "--max", 1), "seed": _count(seed, "--seed", 0) or 0}
        return answer_tips(robot, tips, near=near, output=output, description=description, arguments=asked_for)
    kind = output.kind
    long = scale.is_long(output, cores, input)
    used = whole_cores(cores) if long else cores_worth(whole_cores(cores), input, SOME)
    model, units = description.moving_robot(robot)
    target.exclude("--input", input)
    if input is None and (as_ is not None or drop):
        raise InputError(f"{'--as' if as_ is not None else '--drop'} is for rows of a file, expected --input with it")
    if explain:
        _check_explain(kind, input, method, hold)
    if turns and no_limits:
        raise InputError("--turns and --no-limits exclude each other, expected full turns within the limits or neither")
    factors = joint_factors(model, units)
    arguments: dict[str, Any] = {
        "limits": not no_limits,
        "method": choose(method, METHODS, "--method") or "auto",
        "most": _count(max_, "--max", 1),
        "seed": _count(seed, "--seed", 0) or 0,
        "turns": turns,
    }
    held = parse_hold(hold or [], model, units, not no_limits)
    if held:
        note_held_units(held, model, units)
        arguments["hold"] = {joint: value * factors[joint] for joint, value in held.items()}
    folder = output.file if output.folder else None
    alone = {"--max": max_, "--turns": turns or None, "--cluster": scale.cluster, "--output": folder}
    following = _following(near, max_jump, input, units, alone)
    if following is not None:
        used = 1
    elif near is not None:
        arguments["near"] = typed_configurations([near], model, units, "--near")[0] * factors
    tolerances = (
        _tolerance(tol_position, "--tol-position", units, angle=False),
        _tolerance(tol_angle, "--tol-angle", units, angle=True),
    )
    taken = csv_columns(model, following is not None) if kind in TABLES else RECORD_KEYS
    carried = Carried(taken, say, wanted=not drop and kind not in ("table", "npy"))
    if input is None:
        asked = parse_target(target.texts, model, units)
        for note in asked.notes:
            say(note)
        arguments["task"] = asked.task
        blocks: Iterable[Array] = iter([asked.T[None]])
        if explain:
            from robokin.derivation.explain import require_lesson

            require_lesson(model, arguments["task"])
    else:
        from robokin.tables.target_rows import Targets

        targets = Targets(input, units, orientation_kind(as_), carried, say, plane=flat_arm(model))
        arriving = targets.blocks()
        first = next(arriving, None)  # which says what is asked of the tool
        arguments["task"] = targets.task or "pose"
        blocks = chain([] if first is None else [first], arriving)

    records = SolutionRecords(model, units, arguments["task"], held)
    answers = SolutionReport(records, tolerances, arguments, input is None, explain, carried, cores=used)
    answers.following = following
    if long:
        from robokin.cli.part_answers import send_answers

        given = {name: value.tolist() if name == "near" else value for name, value in arguments.items()}
        question = {"command": "ik"} | given | {"tolerances": tolerances}
        send_answers(answers, blocks, output, kind, scale, question, SOLUTION_ROWS)
    else:
        answers.send(output.file, kind, blocks)
    if not answers.alone and answers.unreached:
        verb = "has" if answers.unreached == 1 else "have"
        say(f"{answers.unreached} of {counted(answers.count, 'target')} {verb} no solution")
    if following is not None and following.jumps:
        say(f"{counted(following.jumps, 'jump')}: a joint moves by more than {_shown_jump(following.jump, units)}")
    return NO if answers.unreached else DONE


def _following(
    near: str | None, max_jump: str | None, input: str | None, units: Units, others: dict[str, Any]
) -> Following | None:
    """What --near previous asks for; None where it does not. Raises InputError."""
    from robokin.inverse.answers_in_turn import Following

    if near != "previous":
        if max_jump is not None:
            raise InputError("--max-jump goes with --near previous, expected both")
        return None
    if input is None:
        raise InputError("--near previous is for targets of a file, expected --input with it")
    for name, value in others.items():
        if value is not None:
            raise InputError(f"{name}: --near previous gives one solution after the other, expected it alone")
    jump = _tolerance(max_jump, "--max-jump", units, angle=True)
    return Following() if jump is None else Following(jump)


def _shown_jump(jump: float, units: Units) -> str:
    from robokin.number_text import show

    return f"{show(jump / units.radians)} {units.angle}"


def _check_explain(kind: str, input: str | None, method: str | None, hold: list[str] | None) -> None:
    """Raise InputError for what a lesson does not go with."""
    if input is not None:
        raise InputError("--explain and --input exclude each other, expected one target, as --pose gives it")
    if hold:
        raise InputError("--explain and --hold exclude each other, expected the steps for the whole arm")
    if kind not in ("table", "json", "jsonl"):
        raise InputError(f"--explain: found the format {kind}, expected table, json or jsonl")
    if method == "numeric":
        raise InputError("--explain shows the closed form, found --method numeric, expected auto or analytic")


def _tolerance(text: str | None, option: str, units: Units, *, angle: bool) -> float | None:
    """A tolerance [m or rad]; None for none."""
    from robokin.cli.arguments import parse_numbers

    if text is None:
        return None
    (value,) = parse_numbers(text, option, [angle], units, "an angle" if angle else "a length")
    if value < 0.0:
        raise InputError(f"{option}: found {text}, expected 0 or more")
    return float(value * (units.radians if angle else units.metres))


def _count(text: str | None, option: str, least: int) -> int | None:
    if text is not None and (digits := text.strip()).isdecimal() and digits.isascii() and len(digits) > DIGITS:
        raise InputError(f"{option}: found a number of {len(digits)} digits, expected at most {DIGITS}")
    return whole_number(text, option, least, 2**63)
