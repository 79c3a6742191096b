"""Records of a class's file, where one that is wrong costs its own line and no other.

Whoever writes a cell can leave a quote open, and what follows, the rows of others, would be text in that cell. So a
record that goes on over several lines and does not end as one with all its cells is only its first line, and the
lines after it are read again, each by itself; since the writer of that cell may also have made them up, they are
doubtful, and count only where there is no other row for the same student and question.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator
from itertools import chain
from typing import IO, NamedTuple

from robokin.errors import InputError, counted
from robokin.files import read_up_to
from robokin.tables.csv_records import Record, RecordReader
from robokin.tables.text_source import MAX_ROW, Say

LARGEST = 64 << 20
"""Bytes of a file of answers; it is held as a whole, since answers to one question may stand anywhere in it."""

MULTILINE = 5
"""Cells of several lines of which a note says where they are."""


class SheetRecord(NamedTuple):
    """The cells of a record, the line where it begins, what is wrong with it or "", and whether it is doubtful."""

    cells: list[str]
    line: int
    fault: str
    doubtful: bool


class SheetReader(RecordReader):
    """A file of rows below a header, as RFC 4180 says. It never gives up, but for what is no text at all."""

    def __init__(self, stream: IO[bytes], name: str, say: Say) -> None:
        super().__init__(stream, name, say, spaces=False)
        self.width = 0
        """Cells of the header; 0 before it is read."""
        self.taken: list[bytes] = []
        """The lines of the present record after its first."""
        self.doubtful = 0
        """The last line of what was read again."""
        self.several: list[str] = []
        """The lines of the records that go over more than one."""

    def rows(self) -> Iterator[SheetRecord]:
        """All records, the header first. Raises InputError for a header that cannot be read."""
        for record in self.records():
            if not self.width:
                self.width = len(record.cells)
            yield SheetRecord(record.cells, record.line, record.fault, record.line <= self.doubtful)
            if record.last > record.line:
                self.several.append(f"{record.line} to {record.last}")
        if self.several:
            more = f" and {len(self.several) - MULTILINE} more" if len(self.several) > MULTILINE else ""
            places = ", ".join(self.several[:MULTILINE])
            self.say(f"{self.name}: quotes make one row each of the lines {places}{more}")

    def blocks(self) -> Iterator[bytes]:
        """The whole file. Raises InputError for one that is too large or no text."""
        data = read_up_to(self.stream, self.name, LARGEST, "rows that can be read")
        if len(data) > LARGEST:
            raise InputError(f"{self.name}: found more than {LARGEST} bytes, expected the answers of a class")
        if data:
            yield self._beginning(data)

    def text(self, line: bytes, number: int) -> str:
        """A line as text; a null character is no number, and no reason to refuse the file."""
        return super().text(line.replace(b"\0", b"\xef\xbf\xbd"), number)

    def _check_size(self) -> None:
        """The size is looked at with the record."""

    def _record(self, lines: list[str], line: int) -> Record:
        # All but the header have only their first line yet.
        self.taken = []
        text = lines[0]
        cells: list[str] = []
        try:
            cells, last, fault = self._parsed(lines, line)
        except InputError as error:
            fault, last = str(error).removeprefix(f"{self.name}, line {line}: "), self.line
        if not fault and self.width and len(cells) != self.width:
            fault = f"found {counted(len(cells), 'cell')}, expected {self.width} as in the header"
        if not fault or not self.width:
            if fault:
                raise self.error(line, fault)
            return Record(cells, line, last)
        if self.taken:
            # Not the rows of others with it: they are read again, by themselves.
            self.lines = chain(self.taken, self.lines)
            self.line, self.doubtful = line, max(self.doubtful, last)
            cells = self._first_cells(text)
        return Record(cells or self._first_cells(text), line, line, fault)

    def _parsed(self, lines: list[str], line: int) -> tuple[list[str], int, str]:
        if sum(map(len, lines)) > MAX_ROW:
            return [], line, f"found a row of more than {MAX_ROW} bytes, expected a shorter one"
        cells, _, last, fault = super()._record(lines, line)
        return cells, last, fault

    def _lines_from(self, known: list[str]) -> Iterator[str]:
        yield from known
        for raw in self.lines:
            self.line += 1
            self.size += len(raw)
            self.taken.append(raw)
            if self.size > MAX_ROW:
                break
            yield self.text(raw, self.line)
        raise self.error(self.begun, "found a quote that is not closed, expected one at the cell's end")

    def _first_cells(self, text: str) -> list[str]:
        """The cells of a line that is no record, as far as they tell whose it is."""
        separator = "," if self.separator == " " else self.separator
        with_quotes = csv.reader([text[:MAX_ROW].replace("\n", "").replace("\r", "")], delimiter=separator)
        try:
            return [cell.strip() for cell in next(with_quotes)][: self.width]
        except (csv.Error, StopIteration):
            return [cell.strip() for cell in text[:MAX_ROW].split(separator)][: self.width]
