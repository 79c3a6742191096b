"""`robokin check sheet`: the answers of a class to a sheet of questions."""

from __future__ import annotations

from typing import Annotated

import typer

from robokin.cli.check_options import DeliveryOptions, FollowOption, MarkRuleOptions
from robokin.cli.options import option
from robokin.errors import InputError


def command(
    key: Annotated[
        str, typer.Argument(metavar="KEY", help="The folder `key` that robokin check new wrote.", show_default=False)
    ],
    *,
    input: Annotated[
        list[str] | None,
        option("--input -i", "PLACE", "A file of answers, or a folder of them; - for standard input; repeatable."),
    ] = None,
    student: Annotated[str | None, option("--student", "NAME", "All answers are this student's.")] = None,
    metadata: Annotated[
        str | None, option("--metadata", "FILE", "Gradescope's submission_metadata.json says whose they are.")
    ] = None,
    follow: FollowOption = False,
    rules: MarkRuleOptions,
    way: DeliveryOptions,
) -> int:
    """Mark the answers of a class to the sheet that robokin check new made.

    The answers are in the form answers.csv, all in one file or one file a student. In a folder the outermost folder
    called like a student, else the file's name, says whose a file is, and no line in it can answer for somebody else;
    in a file of a class the column student does. Questions without a line are missing. Right answers are worked out
    from the numbers of the questions, within the tolerances that stand in the key.

    Examples:
        robokin check sheet week3/key -i submissions/
        robokin check sheet week3/key -i all.csv -o marks.jsonl --partial 0.5
        robokin check sheet week3/key -i answers.csv --student ada --feedback part
    """
    from robokin.cli.statuses import say
    from robokin.grading.answers.sheet_answers import sheet_tasks, whose
    from robokin.grading.answers.sheet_keys import read_sheet_key
    from robokin.grading.answers.submission_metadata import submitters
    from robokin.grading.questions.sheet_marks import sheet_report

    if not input:
        raise InputError("--input is missing, expected a file of answers, or a folder of them")
    if student is not None and metadata is not None:
        raise InputError("--student and --metadata exclude each other, expected one of them")
    known = read_sheet_key(key)
    names = submitters(metadata) if metadata is not None else [[student]] if student is not None else None
    own = None
    if names is not None:
        try:
            own = whose(known, names)
        except InputError as error:
            raise InputError(f"{'--student' if metadata is None else '--metadata'}: {error}") from None
    tasks = sheet_tasks(known, input, say, follow=follow, student=own)
    return way.deliver(sheet_report(known.name, known.exercises, tasks, rules.rules))
