"""Answers to a stream of questions as bytes, a block at a time, in the formats that every such command has."""

from __future__ import annotations

import io
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator
from typing import IO, TYPE_CHECKING, Any

from robokin.arrays import Array
from robokin.model import Robot
from robokin.tables.arrow_library import KINDS
from robokin.tables.carried import Carried
from robokin.tables.sink import sink
from robokin.tables.written_rows import json_document, json_line, json_list
from robokin.units import Units

if TYPE_CHECKING:
    from robokin.jobs.ordered_map import Workers


class AnswerStream(ABC):
    """Blocks of questions (m, …) to bytes."""

    alone: bool
    """Whether one question was asked, so that JSON is one document and text a page."""

    carried: Carried
    """What goes through from the input."""

    def write(self, kind: str, blocks: Iterable[Array], stream: IO[bytes]) -> Iterator[bytes]:
        """The answers to blocks in a format, piece by piece; arrays go to the stream themselves."""
        if kind == "npy":
            self.npy(blocks, stream)
            return iter(())
        if kind in KINDS:
            self.arrow(kind, blocks, stream)
            return iter(())
        return {"csv": self.csv, "jsonl": self.jsonl, "json": self.json, "table": self.table}[kind](blocks)

    def send(self, output: str | None, kind: str, blocks: Iterable[Array]) -> None:
        """Write the answers to a file, or to standard output, as they come."""
        with sink(output) as stream:
            for data in self.write(kind, blocks, stream):
                stream.write(data)
                stream.flush()  # whoever waits for an answer gets it before the next question

    @abstractmethod
    def documents(self, blocks: Iterable[Array]) -> Iterator[Iterable[dict[str, Any]]]:
        """The documents of the answers, as many at a time as come at once."""

    @abstractmethod
    def csv(self, blocks: Iterable[Array]) -> Iterator[bytes]:
        """The answers as rows of a CSV."""

    @abstractmethod
    def npy(self, blocks: Iterable[Array], stream: IO[bytes]) -> None:
        """The answers as an array."""

    @abstractmethod
    def table(self, blocks: Iterable[Array]) -> Iterator[bytes]:
        """The answers for eyes."""

    @property
    @abstractmethod
    def about(self) -> dict[str, Any]:
        """What a file says of the answers beside its columns: the robot, and the units."""

    def arrow(self, kind: str, blocks: Iterable[Array], stream: IO[bytes]) -> int:
        """The answers as a Parquet or an Arrow file: the columns of the CSV, each with a type; the number of rows."""
        from robokin.tables.arrow_writer import write_csv_as

        return write_csv_as(kind, self.write("csv", blocks, stream), stream, self.carried, self.about)

    def json(self, blocks: Iterable[Array]) -> Iterator[bytes]:
        """One document, or a list of them."""
        if not self.alone:
            return json_list(self.documents(blocks))
        return (json_document(document) for documents in self.documents(blocks) for document in documents)

    def jsonl(self, blocks: Iterable[Array]) -> Iterator[bytes]:
        """A document a line."""
        return (b"".join(map(json_line, documents)) for documents in self.documents(blocks))


class SharedStream(AnswerStream):
    """The same about a robot, where several cores may share long files."""

    @property
    @abstractmethod
    def robot(self) -> Robot:
        """The robot that is asked about."""

    @property
    @abstractmethod
    def units(self) -> Units:
        """The units of what comes out."""

    cores: int | None
    """How many share the blocks; None for all."""

    def write(self, kind: str, blocks: Iterable[Array], stream: IO[bytes]) -> Iterator[bytes]:
        """The answers to blocks in a format, piece by piece; the same bytes on any number of cores."""
        if kind in ("npy", *KINDS) or self.cores == 1:
            yield from super().write(kind, blocks, stream)
            return
        from robokin.reports.shared_blocks import blocks_written

        total = 0
        shared = blocks_written(self.bare().part, kind, blocks, self.carried, self.cores, self.workers(kind))
        for data, rows, found in shared:
            total += rows
            if rows:
                self.add(rows, found)
            yield data
        if not total and kind != "json":
            yield from super().write(kind, (), stream)

    def workers(self, kind: str) -> Workers:
        """What the cores are: processes, where Python does the work."""
        return "processes"

    def part(self, kind: str, first: int, block: Array, carried: Carried) -> tuple[bytes, Any]:
        """The answers to one block whose first question has the number first + 1, and what else is known of them."""
        own = self.from_number(first, carried)
        return b"".join(own.write(kind, [block], io.BytesIO())), own.found

    @abstractmethod
    def bare(self) -> SharedStream:
        """The same without what is carried, which travels with each block."""

    @abstractmethod
    def from_number(self, first: int, carried: Carried) -> SharedStream:
        """The same on one core, for the questions behind the first ones, under what stands above all answers."""

    @abstractmethod
    def alone_from(self, first: int, carried: Carried) -> SharedStream:
        """The same, with what stands above all answers: for those of a file of their own."""

    @property
    @abstractmethod
    def found(self) -> Any:
        """What is known of the answers so far, for `add`."""

    @abstractmethod
    def add(self, rows: int, found: Any) -> None:
        """Count the answers to a block, and what was found, that another core made."""
