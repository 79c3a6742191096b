"""`robokin validate`: is this file a description?"""

from __future__ import annotations

from typing import Annotated

import typer

from robokin.cli.option_groups import OutputOptions
from robokin.cli.statuses import DONE, WRONG_INPUT, say


def command(
    files: Annotated[
        list[str], typer.Argument(metavar="FILE...", help="Descriptions, or names of the library.", show_default=False)
    ],
    *,
    output: OutputOptions,
) -> int:
    """Check descriptions; the status is 2 if any is wrong.

    Examples:
        robokin validate arm.yaml
        robokin validate robots/arms/*.yaml --json
    """
    from robokin.records.description_records import file_record, verdict_of
    from robokin.reports.verdict_report import verdicts_written
    from robokin.tables.sink import sink

    kind = output.kind
    verdicts = [verdict_of(file) for file in files]
    records = [file_record(file, verdict) for file, verdict in zip(files, verdicts, strict=True)]

    with sink(output.file) as stream:
        stream.writelines(verdicts_written(kind, records, verdicts))
    wrong = sum(not record["valid"] for record in records)
    if wrong:
        say(f"{wrong} of {len(records)} descriptions {'is' if wrong == 1 else 'are'} wrong")
    return WRONG_INPUT if wrong else DONE
