"""Answers to a stream of questions as bytes, a block at a time, in the formats that every such command has."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator
from typing import IO, Any, Generic, TypeVar

from robokin.tables.sink import sink
from robokin.tables.written_rows import json_document, json_line, json_list

Block = TypeVar("Block")


class AnswerStream(ABC, Generic[Block]):
    """Blocks of questions to bytes."""

    alone: bool
    """Whether one question was asked, so that JSON is one document and text a page."""

    def write(self, kind: str, blocks: Iterable[Block], stream: IO[bytes]) -> Iterator[bytes]:
        """The answers to blocks in a format, piece by piece; arrays go to the stream themselves."""
        if kind == "npy":
            self.npy(blocks, stream)
            return iter(())
        return {"csv": self.csv, "jsonl": self.jsonl, "json": self.json, "table": self.table}[kind](blocks)

    def send(self, output: str | None, kind: str, blocks: Iterable[Block]) -> None:
        """Write the answers to a file, or to standard output, as they come."""
        with sink(output) as stream:
            for data in self.write(kind, blocks, stream):
                stream.write(data)
                stream.flush()  # whoever waits for an answer gets it before the next question

    @abstractmethod
    def documents(self, blocks: Iterable[Block]) -> Iterator[Iterable[dict[str, Any]]]:
        """The documents of the answers, as many at a time as come at once."""

    @abstractmethod
    def csv(self, blocks: Iterable[Block]) -> Iterator[bytes]:
        """The answers as rows of a CSV."""

    @abstractmethod
    def npy(self, blocks: Iterable[Block], stream: IO[bytes]) -> None:
        """The answers as an array."""

    @abstractmethod
    def table(self, blocks: Iterable[Block]) -> Iterator[bytes]:
        """The answers for eyes."""

    def json(self, blocks: Iterable[Block]) -> Iterator[bytes]:
        """One document, or a list of them."""
        if not self.alone:
            return json_list(self.documents(blocks))
        return (json_document(document) for documents in self.documents(blocks) for document in documents)

    def jsonl(self, blocks: Iterable[Block]) -> Iterator[bytes]:
        """A document a line."""
        return (b"".join(map(json_line, documents)) for documents in self.documents(blocks))
