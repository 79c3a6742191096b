"""Long answers written as folders of parts, on the cores of this machine or on a cluster, and gone on with later.

A part hangs on nothing but the question and its place in it, so that the files are the same on any number of workers
and after any interruption.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
from collections.abc import Callable, Generator, Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import IO, Any

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.jobs.ordered_map import finished_map
from robokin.model import Robot
from robokin.reports.answer_stream import SharedStream
from robokin.reports.sample_rows import Samples
from robokin.reports.shared_blocks import regrouped
from robokin.tables.arrow_library import pyarrow
from robokin.tables.carried import Carried
from robokin.tables.part_files import PartPlace, WrittenPart
from robokin.tables.part_folders import PartFolder
from robokin.units import Units

Progress = Callable[[int, int | None], None]
"""Is told how many rows are done, and of how many, if that is known."""


@dataclass(frozen=True)
class PartRun:
    """Where parts go: a folder, whether an earlier run is gone on with, the cores (None for all), and who is told."""

    output: str
    resume: bool = False
    cores: int | None = None
    progress: Progress | None = None


def write_parts(
    run: PartRun,
    question: dict[str, Any],
    fill: Callable[[Any, IO[bytes]], tuple[int, Any]],
    tasks: Iterable[tuple[int, Any]],
    total: int | None = None,
) -> tuple[list[WrittenPart], int]:
    """Make the part of each task; all parts in order, and how many rows were there before.

    question: what the parts hang on, as JSON values by names. fill: writes the rows of a task to a stream, gives their
    number and what else is known of them. tasks: of each part how many rows of a question it answers, and what `fill`
    is handed. total: rows of all parts, if known. Raises InputError and OutputError as `PartFolder.opened` does, and
    where an earlier run had other rows to answer.
    """
    question = question | {"versions": _versions()}
    with PartFolder.opened(run.output, question, resume=run.resume) as folder:
        there = _still_there(folder, run.cores)
        parts: dict[int, WrittenPart] = {}
        before = done = 0

        def left() -> Iterator[tuple[int, int, Any]]:
            nonlocal before, done
            for number, (count, task) in enumerate(tasks):
                part = there.get(number)
                if part is None:
                    yield number, count, task
                    continue
                _same_rows(run.output, part, count, task)
                parts[number] = part
                before, done = before + part.rows, done + part.rows

        work = partial(_make, folder.place, fill)
        with contextlib.closing(_closable(finished_map(work, left(), run.cores))) as finished:
            for part, data in finished:
                if data is not None:
                    folder.place.write(part, data)
                folder.record(part)
                parts[part.number] = part
                done += part.rows
                if run.progress is not None:
                    run.progress(done, total)
        if set(parts) != {*range(len(parts))} or there.keys() - parts.keys():
            raise InputError(f"--resume: {run.output} has more parts than there are rows now, expected the same rows")
        whole = [parts[number] for number in range(len(parts))]
        folder.finish(whole)
    return whole, before


def _versions() -> dict[str, str]:
    """What the bytes of a part hang on beside the question."""
    import robokin

    return {"robokin": robokin.__version__, "pyarrow": str(pyarrow().__version__)}


def _make(
    place: PartPlace, fill: Callable[[Any, IO[bytes]], tuple[int, Any]], task: tuple[int, int, Any]
) -> tuple[WrittenPart, bytes | None]:
    """The part of a task, made by a worker."""
    number, questions, what = task
    return place.made(number, partial(fill, what), questions, _digest(what))


def _still_there(folder: PartFolder, cores: int | None) -> dict[int, WrittenPart]:
    """The recorded parts whose files have the bytes that they had."""
    recorded = [*folder.recorded.values()]
    looked_at = finished_map(partial(_looked_at, folder.place), recorded, cores)
    there = {}
    for part, held in looked_at:
        if held or (held is None and folder.place.holds(part)):
            there[part.number] = part
    return there


def _looked_at(place: PartPlace, part: WrittenPart) -> tuple[WrittenPart, bool | None]:
    return part, place.holds(part)


def _same_rows(output: str, part: WrittenPart, count: int, task: Any) -> None:
    """Raises InputError where a part that is there answers other rows than those of a task."""
    if part.questions != count or part.asked != _digest(task):
        said = f"--resume: {output} was made from other rows than there are now, beginning with part {part.number}"
        raise InputError(f"{said}, expected the same input")


def _digest(task: Any) -> str:
    """The digest of the rows that a task brings along; "" where it brings none."""
    if isinstance(task, int):
        return ""
    first, block, carried = task
    digest = hashlib.sha256(repr((first, block.shape, carried.names, carried.kinds, carried.typed)).encode())
    digest.update(block.tobytes())
    for row in carried.rows:
        digest.update(repr(row).encode(errors="backslashreplace"))
    return digest.hexdigest()[:32]


def _closable(results: Iterator[Any]) -> Generator[Any, None, None]:
    """Results as a generator, whose end ends the workers even where an error holds on to them."""
    yield from results


def described(robot: Robot, units: Units) -> dict[str, Any]:
    """What answers about a robot hang on, whatever the question: all that is known of it, and the units."""
    from robokin.records.description_records import robot_record

    digest = hashlib.sha256(json.dumps(robot_record(robot, units)).encode()).hexdigest()[:16]
    return {"robot": robot.id or robot.name, "description": digest} | units.as_record()


# Samples ----------------------------------------------------------------------------------------------------


def sample_parts(run: PartRun, samples: Samples, rows: int) -> int:
    """Write samples in parts; how many of them were there before. Raises as `write_parts` does."""
    question = {"command": "workspace"} | samples.settings() | {"part_rows": rows}
    question["description"] = question.pop("table")
    del question["block"]
    tasks = [(min(rows, samples.count - first), first) for first in range(0, samples.count, rows)]
    _, before = write_parts(run, question, partial(_fill_samples, samples, rows), tasks, samples.count)
    return before


def _fill_samples(samples: Samples, rows: int, first: int, stream: IO[bytes]) -> tuple[int, Any]:
    return samples.write_rows(stream, "parquet", samples.tables(first, min(rows, samples.count - first))), None


# Answers ----------------------------------------------------------------------------------------------------


def answer_parts(
    run: PartRun,
    report: SharedStream,
    blocks: Iterable[Array],
    carried: Carried,
    question: dict[str, Any],
    part_rows: int,
) -> int:
    """Write the answers to blocks of questions in parts; how many rows were there before.

    The report counts what was found, in order. Raises as `write_parts` does.
    """
    fill = partial(_fill_answers, report.bare())
    whole, before = write_parts(run, question | {"part_rows": part_rows}, fill, _tasks(blocks, carried, part_rows))
    for part in whole:
        report.add(part.questions, part.found)
    return before


def _tasks(blocks: Iterable[Array], carried: Carried, rows: int) -> Iterator[tuple[int, Any]]:
    """The questions of each part: their number; the number of the first, the rows, and what they carry."""
    first = 0
    for block in regrouped(blocks, rows):
        yield len(block), (first, block, carried.taken_out(len(block)))
        first += len(block)
    if not first:
        yield 0, (0, np.zeros((0, 0)), carried.taken_out())


def _fill_answers(report: SharedStream, task: tuple[int, Array, Carried], stream: IO[bytes]) -> tuple[int, Any]:
    first, block, carried = task
    own = report.alone_from(first, carried)
    rows = own.arrow("parquet", [block] if len(block) else [], stream)
    return rows, own.found
