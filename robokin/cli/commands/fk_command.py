"""`robokin fk`: joint values to poses, one, several, or a stream of them."""

from __future__ import annotations

from typing import Annotated

import typer

from robokin.cli.cluster_options import POSE_ROWS, PartOptions
from robokin.cli.completion import named_poses
from robokin.cli.cores import MANY, CoresOption, cores_worth, whole_cores
from robokin.cli.option_groups import DescriptionOptions, RowOutputOptions
from robokin.cli.options import TABLES, AsOption, DropOption, RobotArgument, option, orientation_kind
from robokin.cli.statuses import say
from robokin.errors import InputError


def command(
    robot: RobotArgument,
    *,
    q: Annotated[
        list[str] | None,
        option(
            "--q",
            "Q",
            "Joint values separated by commas or spaces, expressions allowed; or the name of a pose of the "
            "description; or - for a configuration a line on standard input. Repeatable.",
            named_poses,
        ),
    ] = None,
    input: Annotated[
        str | None,
        option(
            "--input -i",
            "FILE",
            "A configuration a line: .csv (with a header or without), .jsonl, .json, .npy or .parquet; "
            "- for standard input.",
        ),
    ] = None,
    frames: Annotated[bool, typer.Option("--frames", help="Also the frame after each row of the table.")] = False,
    symbolic: Annotated[bool, typer.Option("--symbolic", help="The matrices in symbols, c1*c23, and no --q.")] = False,
    latex: Annotated[bool, typer.Option("--latex", help="With --symbolic: in LaTeX, or -o FILE.tex.")] = False,
    python: Annotated[bool, typer.Option("--python", help="With --symbolic: a numpy function, or -o FILE.py.")] = False,
    numbers: Annotated[bool, typer.Option("--numbers", help="With --symbolic: lengths and twists as numbers.")] = False,
    as_: AsOption = None,
    drop: DropOption = False,
    cores: CoresOption = None,
    scale: PartOptions,
    output: RowOutputOptions,
    description: DescriptionOptions,
) -> int:
    """Forward kinematics: the pose of the end effector, or of a tree's tips, at given joint values.

    Angles and lengths are in the description's units unless --angle and --length say otherwise.

    Examples:
        robokin fk puma560 --q 90,0,90,0,0,0
        robokin fk puma560 --q "-90 0 90 0 atan2(3,4) 0" --json
        robokin fk puma560 --q home --frames
        robokin fk puma560 --input joints.csv --output poses.csv
        shuf -n 3 joints.csv | robokin fk puma560 --q - -f csv
        robokin fk human-hand --q pinch
        robokin fk human-hand --tip index --q 0,45,30,20
        robokin fk anthropomorphic --symbolic
    """
    from robokin.cli.configurations import configurations
    from robokin.model import Robot, Tree
    from robokin.records.pose_blocks import PoseMaker
    from robokin.reports.pose_report import RECORD_KEYS, PoseReport, csv_columns
    from robokin.reports.tip_report import TIP_KEYS, TipReport, tip_columns
    from robokin.tables.carried import Carried
    from robokin.tables.sink import sink

    if symbolic or latex or python or numbers:
        from robokin.cli.symbolic_options import check_options, form_of
        from robokin.derivation.symbolic_kinematics import symbolic_kinematics
        from robokin.reports.symbolic_pages import symbolic_written

        forms = {"--latex": latex, "--python": python, "--numbers": numbers}
        check_options(symbolic, forms, {"--q": q, "--input": input, "--as": as_})
        form = form_of(output.file, output.chosen, latex=latex, python=python)
        model, units = description.robot(robot)
        symbols = symbolic_kinematics(model, units, numbers=numbers, frames=frames)
        with sink(output.file) as stream:
            stream.write(symbolic_written(form, model, units, symbols))
        return 0
    kind, long = output.kind, scale.is_long(output, cores, input)
    orientation, most = orientation_kind(as_), whole_cores(cores)
    subject, units = description.robot_or_tree(robot)
    tree: Tree | None = None
    keys: tuple[str, ...] = RECORD_KEYS
    if isinstance(subject, Tree):
        tree, keys, columns = subject, TIP_KEYS, tip_columns(subject, orientation)
    else:
        columns = csv_columns(subject, orientation)
    carried = Carried(
        columns if kind in TABLES else keys,
        say,
        wanted=not drop and kind not in ("table", "npy"),
    )
    blocks, streamed, alone = configurations(subject, units, q, input, carried, still=True)
    if frames and tree:
        raise InputError(f"--frames: {subject.name} is a tree, expected --tip with one of {tree.listed_tips()}")
    if frames and kind in TABLES:
        name = "CSV" if kind == "csv" else f"an output in {kind}"
        expected = "expected the format table, json, jsonl or npy"
        raise InputError(f"--frames: a row of {name} has no room for frames, {expected}")
    maker = PoseMaker(subject, units, frames)
    if not streamed:
        for note in (note for given in blocks for note in maker.outside_notes(given)):
            say(note)
    if alone and not frames and not as_ and isinstance(subject, Robot):
        from robokin.quick.plain_poses import KINDS, plain_pose

        (given,) = blocks
        pose = plain_pose(description.plain(robot, subject), units, given) if kind in KINDS else None
        if pose is not None:
            with sink(output.file) as stream:
                stream.write(pose.written(kind))
            return 0
    used = cores_worth(most, "-" if input is None else input, MANY) if streamed else 1
    if tree and long:
        raise InputError(f"{subject.name} is a tree, expected --tip with one of {tree.listed_tips()}")
    if tree:
        TipReport(tree, maker, orientation, alone, carried).send(output.file, kind, blocks)
    else:
        report = PoseReport(maker, orientation, alone, carried, cores=most if long else used)
        if long:
            from robokin.cli.part_answers import send_answers

            send_answers(report, blocks, output, kind, scale, {"command": "fk", "as": orientation}, POSE_ROWS)
        else:
            report.send(output.file, kind, blocks)
    if streamed and (summary := maker.outside_summary()):
        say(summary)
    return 0
