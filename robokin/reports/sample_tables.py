"""Sampled positions as one Parquet or Arrow file, made on several cores and written in order."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Generator
from functools import partial

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.jobs.ordered_map import ordered_map
from robokin.reports.sample_rows import Samples
from robokin.tables.sink import sink
from robokin.unfinished_work import in_order
from robokin.workspace.sampling import TASK


def write_sample_table(
    output: str, samples: Samples, cores: int | None, resume: bool, progress: Callable[[int, int], None]
) -> None:
    """Write a file of samples; `progress` is told how many of how many there are.

    What such a file says of its rows stands at its end, so that one that is not whole says nothing: InputError for
    `resume`. Raises OutputError for a place that cannot be written.
    """
    if resume:
        expected = "expected a folder of parts (a name with / at its end)"
        raise InputError(f"--resume: {output} is whole or absent, {expected}")
    total = samples.count

    def tables() -> Generator[Array, None, None]:
        done = 0
        for table in ordered_map(partial(_table, samples), range(0, total, TASK), cores):
            yield table
            done += len(table)
            progress(done, total)

    with in_order(), sink(output) as stream, contextlib.closing(tables()) as whole:
        samples.write_rows(stream, samples.kind, whole)


def _table(samples: Samples, start: int) -> Array:
    return samples.table(start, min(TASK, samples.count - start))
