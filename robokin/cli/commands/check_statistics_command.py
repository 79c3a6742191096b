"""`robokin check statistics`: what a class did."""

from __future__ import annotations

from typing import Annotated

import typer

from robokin.cli.option_groups import OutputOptions
from robokin.cli.statuses import DONE


def command(
    files: Annotated[
        list[str],
        typer.Argument(
            metavar="MARKS...", help="Files of marks: .json or .jsonl of robokin check; - for standard input.",
            show_default=False,
        ),
    ],
    *,
    answer: OutputOptions,
) -> int:  # fmt: skip
    """Statistics of a class: how hard each question was, and which known mistakes were made how often.

    It reads marks of any check, told with --feedback part or more, which say the known mistakes. The score of a
    question is the mean of its marks; a question that nobody answered counts as unanswered and as 0. CSV has a row for
    each question with a column for each mistake.

    Examples:
        robokin check statistics marks.jsonl
        robokin check statistics week1.json week2.json -o course.csv
    """
    from robokin.grading.answers.mark_files import read_marks
    from robokin.grading.class_statistics import class_statistics
    from robokin.records.statistics_records import statistics_record, statistics_rows
    from robokin.reports.statistics_page import statistics_page
    from robokin.tables.sink import sink
    from robokin.tables.written_rows import csv_without_formulas, written

    kind = answer.kind
    found = class_statistics((mark for file in files for mark in read_marks(file)), " ".join(files))
    record = statistics_record(found)
    with sink(answer.file) as stream:
        stream.writelines(
            written(
                kind, record, [record], lambda: csv_without_formulas(*statistics_rows(found)),
                lambda: statistics_page(record),
            )
        )  # fmt: skip
    return DONE
