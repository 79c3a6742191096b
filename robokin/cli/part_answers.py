"""Answers to the rows of a file where there may be many: to a file, or to a folder of parts, here or on a cluster."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from robokin.cli.cluster_options import PartOptions, working_on
from robokin.cli.statuses import say

if TYPE_CHECKING:
    from robokin.arrays import Array
    from robokin.cli.option_groups import RowOutputOptions
    from robokin.reports.answer_stream import SharedStream


def send_answers(
    report: SharedStream, blocks: Iterable[Array], output: RowOutputOptions, kind: str, scale: PartOptions,
    question: dict[str, Any], usual: int,
) -> None:  # fmt: skip
    """Write the answers to blocks of questions where the options say.

    question: what the answers hang on beside the rows and the robot, as JSON values by names; usual: a part's rows.
    """
    with working_on(scale.cluster):
        if not output.folder:
            report.send(output.file, kind, blocks)
            return
        from robokin.cli.progress import Progress
        from robokin.reports.part_runs import PartRun, answer_parts, described

        with Progress("rows") as progress:
            run = PartRun(str(output.file), scale.resume, report.cores, progress.told)
            asked = question | described(report.robot, report.units)
            before = answer_parts(run, report, blocks, report.carried, asked, scale.rows(usual))
        if before:
            say(f"{before:,} rows were there before")
