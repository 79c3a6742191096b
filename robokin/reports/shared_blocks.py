"""Long batches on several cores: a worker makes the bytes of a block's answers, and they come out in order."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import partial
from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.jobs.executors import lent_executor
from robokin.jobs.ordered_map import Workers, ordered_map, usable_cores
from robokin.tables.carried import Carried

WINDOW = 3
"""Blocks for each core that are under way, or wait to be written: a block's answers may be a dozen megabytes."""


FAR_ROWS = 1 << 14
"""Rows of a block that goes to a cluster, whose scheduler takes some milliseconds for each."""


def blocks_written(
    part: Callable[[str, int, Array, Carried], tuple[bytes, Any]],
    kind: str,
    blocks: Iterable[Array],
    carried: Carried,
    cores: int | None,
    workers: Workers = "processes",
) -> Iterator[tuple[bytes, int, Any]]:
    """The bytes of each block (m, …), its number of rows, and what else `part` found.

    part: makes the answers to a block in a format whose first row has a number, from 0, with what the rows carry.
    JSON is a list of lines. workers: threads where `part` lets go of the interpreter's lock most of its time.
    """
    window = WINDOW * (cores or usable_cores())
    made = partial(_made, part, "jsonl" if kind == "json" else kind)
    before = b"[\n"
    if lent_executor() is not None:
        blocks, workers = regrouped(blocks, FAR_ROWS), "processes"
    for data, rows, more in ordered_map(made, numbered(blocks, carried), cores, window, workers):
        if kind == "json":
            # No text within a line of JSON has a line break.
            data, before = before + data[:-1].replace(b"\n", b",\n"), b",\n"
        yield data, rows, more
    if kind == "json":
        yield b"[]\n" if before == b"[\n" else b"\n]\n", 0, None


def numbered(blocks: Iterable[Array], carried: Carried) -> Iterator[tuple[int, Array, Carried]]:
    """Each block with the number of its first row and what its rows carry."""
    first = 0
    for block in blocks:
        yield first, block, carried.taken_out(len(block))
        first += len(block)


def regrouped(blocks: Iterable[Array], rows: int) -> Iterator[Array]:
    """The same rows in blocks of so many, the last one perhaps of fewer."""
    waiting: list[Array] = []
    count = 0
    for block in blocks:
        waiting.append(block)
        count += len(block)
        if count < rows:
            continue
        whole = np.concatenate(waiting)
        for start in range(0, count - rows + 1, rows):
            yield whole[start : start + rows]
        waiting, count = [whole[count - count % rows :]], count % rows
    if count:
        yield np.concatenate(waiting)


def _made(
    part: Callable[[str, int, Array, Carried], tuple[bytes, Any]], kind: str, task: tuple[int, Array, Carried]
) -> tuple[bytes, int, Any]:
    data, more = part(kind, *task)
    return data, len(task[1]), more
