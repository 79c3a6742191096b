"""Records of a CSV as RFC 4180 says, from a stream, with the numbers of their lines.

Cells are separated by commas, semicolons or tabs, which the first line tells, or by spaces. In quotes
everything is text, also the ends of lines; a quote in a quoted cell is doubled. Outside of quotes a blank
line, and one that begins with #, is passed over.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator
from typing import Any, NamedTuple

from robokin.errors import InputError, shown
from robokin.tables.text_source import MAX_ROW, Say, TextSource

QUOTED = re.compile(r'"(?:[^"]|"")*"?')
DECIMAL_COMMA = re.compile(r"(?<=\d),(?=\d)")
PADDED_COMMA = re.compile(r"[ \t]*,[ \t]*")
TWO_NUMBERS = re.compile(r"[\d.] +\.?\d")


class Record(NamedTuple):
    """The cells of a record, the line where it begins, the one where it ends, and what is wrong with it, or ""."""

    cells: list[str]
    line: int
    last: int
    fault: str = ""


class RecordReader(TextSource):
    """A stream of CSV."""

    def __init__(self, stream: Any, name: str, say: Say, *, spaces: bool = True) -> None:
        """`spaces` tells whether a line without a separator may have white space between its cells."""
        super().__init__(stream, name, say)
        self.spaces = spaces
        self.separator = ""
        """Comma, semicolon, tab, or a space for any white space; "" before the first record."""
        self.aligned = False
        """Whether white space of any length separates cells, as numbers are aligned with several tabs."""
        self.waiting = self.blocks()
        self.lines: Iterator[bytes] = iter(())
        self.begun = 0
        """The line where the present record begins; 0 between records."""
        self.size = 0
        """Bytes of the present record."""

    def records(self) -> Iterator[Record]:
        """All records. Raises InputError where the stream ends inside quotes, or a record is too long."""
        for block in self.waiting:
            yield from self.records_of(block)

    def records_of(self, block: bytes) -> Iterator[Record]:
        """The records that begin in a block of whole lines; of the last one the rest is read from the stream."""
        self.lines = iter(block.splitlines(keepends=True))
        while (text := self._first_line()) is not None:
            line = self.begun
            lines = [text]
            if not self.separator:
                lines = self._whole(text)
                text = "".join(lines)
                self.separator = self._separator_of(text, line)
            if self.aligned or (self.spaces and self.separator in ", " and not ("," in text or '"' in text)):
                yield Record(text.split(), line, line)
            else:
                yield self._record(lines, line)
            self.begun = 0

    def _record(self, lines: list[str], line: int) -> Record:
        cells, fault = [], ""
        separator = self.separator if self.separator != " " else ","
        try:
            cells = next(csv.reader(self._lines_from(lines), delimiter=separator, strict=True, skipinitialspace=True))
        except csv.Error:
            fault = "found a quote inside a cell, expected quotes around the whole cell and doubled quotes in it"
            if self.size > csv.field_size_limit():
                fault = f"found a cell of more than {csv.field_size_limit()} characters, expected a shorter one"
            if self.line > line:  # rows of others may be inside the quotes
                raise self.error(line, f"{fault}; quotes make one row of it up to line {self.line}") from None
        return Record([cell.strip() for cell in cells], line, self.line, fault)

    def _first_line(self) -> str | None:
        """The next line of the block that is not blank and no comment; None at the end of the block."""
        for raw in self.lines:
            self.line += 1
            start = raw.lstrip()
            if start and not start.startswith(b"#"):
                self.begun, self.size = self.line, len(raw)
                self._check_size()
                return self.text(raw, self.line)
        return None

    def _lines_from(self, known: list[str]) -> Iterator[str]:
        """The lines of a record whose first ones are known, as far as the parser asks for them."""
        yield from known
        while True:
            raw = next(self.lines, None)
            if raw is None:
                block = next(self.waiting, None)
                if block is None:
                    raise self.error(self.begun, "found a quote that is not closed, expected one at the cell's end")
                self.lines = iter(block.splitlines(keepends=True))
                continue
            self.line += 1
            self.size += len(raw)
            self._check_size()
            yield self.text(raw, self.line)

    def _check_size(self) -> None:
        if self.size > MAX_ROW:
            end = f"; quotes make one row of it up to line {self.line}" if self.line > self.begun else ""
            raise self.error(self.begun, f"found a row of more than {MAX_ROW} bytes, expected a shorter one{end}")

    def _whole(self, text: str) -> list[str]:
        """The lines of the first record: quoted cells may be on further lines."""
        lines, more = [text], self._lines_from([])
        quotes = text.count('"')
        while quotes % 2:
            lines.append(next(more))
            quotes += lines[-1].count('"')
        return lines

    def _separator_of(self, text: str, line: int) -> str:
        try:
            return separator_of(text)
        except InputError as error:
            raise self.error(line, str(error)) from None


def separator_of(line: str) -> str:
    """What stands between the cells of a record: comma, semicolon, tab, or a space for any white space.

    It is the sign that is there most often, outside of quotes and round brackets. Between digits a comma beside
    semicolons or tabs is a decimal one and does not count, nor does a tab that only pads a comma. Raises InputError
    where two would do.
    """
    bare = _outside_parentheses(QUOTED.sub("q", line.strip(" \r\n")))
    packed = PADDED_COMMA.sub(",", bare)
    counts = {"semicolons": packed.count(";"), "tabs": packed.count("\t"), "commas": packed.count(",")}
    decimal = counts["commas"] == len(DECIMAL_COMMA.findall(packed))
    if decimal and (counts["semicolons"] or counts["tabs"]):
        counts["commas"] = 0
    most = max(counts.values())
    names = [name for name, count in counts.items() if count == most]
    if most and len(names) > 1:
        raise InputError(
            f"found as many {names[0]} as {names[1]} in '{shown(line)}', expected one of them between cells"
        )
    if most and names != ["commas"]:
        return ";" if names == ["semicolons"] else "\t"
    if most and decimal and TWO_NUMBERS.search(packed):
        raise InputError(
            f"found commas and spaces between numbers in '{shown(line)}', expected one of them; "
            "with decimal commas, semicolons or tabs between the cells"
        )
    return "," if most or '"' in line else " "


def _outside_parentheses(text: str) -> str:
    """A text without what stands in round brackets: the commas there belong to a function."""
    if "(" not in text:
        return text
    depth, kept = 0, []
    for character in text:
        depth = max(depth + (character == "(") - (character == ")"), 0)
        if not depth:
            kept.append(character)
    return "".join(kept)
