"""`robokin check dh`: tables against a robot."""

from __future__ import annotations

from typing import Annotated

import typer

from robokin.cli.check_options import FollowOption, MarkOptions, TableToleranceOptions
from robokin.cli.completion import robots
from robokin.cli.options import option
from robokin.errors import InputError, did_you_mean, shown


def command(
    files: Annotated[
        list[str],
        typer.Argument(
            metavar="FILE...", help="The tables to be marked: descriptions, or folders of them.", show_default=False
        ),
    ],
    *,
    against: Annotated[
        str | None, option("--against", "ROBOT", "The right robot: a name of `robokin list`, or a path.", robots)
    ] = None,
    up_to: Annotated[
        str | None, option("--up-to", "PARTS", "What may differ: base, tool, zero, sign, with commas; or all.")
    ] = None,
    allowed: TableToleranceOptions,
    follow: FollowOption = False,
    way: MarkOptions,
) -> int:
    """Mark tables: is it kinematically the same robot?

    The joints' axes decide, not the cells: a table in another convention, or with frames elsewhere along its
    axes, is the same robot. It must bring the end effector to the same pose for the same joint values, except for what
    --up-to leaves open: another base or tool frame, the zeros of joints, their senses. Where a table differs,
    the first joint that does is named with what was found and expected; the score is the part of the joints
    that stand right to the one before; where single cells are wrong, they are named. --set is about the right
    robot. Limits are not compared. Of a folder all .yaml files are marked, whatever they are called.

    Examples:
        robokin check dh arm.yaml --against robots/arm.yaml
        robokin check dh submissions/ --against arm.yaml -f csv
        robokin check dh puma560-craig --against puma560 --up-to all
    """
    from dataclasses import replace

    from robokin.grading.answers.answer_tasks import table_task
    from robokin.grading.answers.submissions import submissions
    from robokin.grading.marking import marked
    from robokin.grading.table_marks import TableCheck

    if against is None:
        raise InputError("--against is missing, expected --against ROBOT, the right table")
    check = way.subject(TableCheck, against, allowed, table=True, free=_open_parts(up_to))
    found = submissions(files, follow)
    check = replace(check, alone=len(found) == 1 and way.gradescope is None)
    return way.finish("dh", against, check, marked(check, list(map(table_task, found)), way.rules))


def _open_parts(text: str | None) -> frozenset[str]:
    """What --up-to leaves open. Raises InputError."""
    from robokin.grading.same_robot import OPEN

    names = [name.strip().lower() for name in (text or "").replace(" ", ",").split(",") if name.strip()]
    if names == ["all"]:
        return frozenset(OPEN)
    for name in names:
        if name not in OPEN:
            expected = f"expected some of {', '.join(OPEN)} with commas, or all{did_you_mean(name, OPEN)}"
            raise InputError(f"--up-to: found '{shown(name)}', {expected}")
    return frozenset(names)


def arguments(words: list[str]) -> list[str]:
    """The arguments, in which no student's file is an option, whatever it is called."""
    from robokin.cli.file_words import files_kept

    return files_kept(words, "--against")
