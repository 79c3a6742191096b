"""Columns that are not understood, on their way from the input to the output: the time of a row, its number."""

from __future__ import annotations

import json
import re
from collections import deque
from collections.abc import Collection, Iterable, Sequence
from typing import Any

from robokin.errors import shown
from robokin.tables.text_source import Say
from robokin.tables.written_rows import encode

QUOTE = '"'

SPECIAL = re.compile(r'["\r\n]|^#')
"""What is quoted: beside RFC 4180 a # at the beginning of a line, which would make a comment of it."""

NUMERAL = re.compile(r"-?(0|[1-9]\d{0,14})(\.\d{1,15})?", re.ASCII)
"""A cell that JSON writes as a number; 007 and 1e5 may be names."""

WRITTEN_BY_IK = ("target", "solution", "branch", "within_limits", "position_error", "angle_error", "reason")
"""Beside joint values; where the first two stand together, the table is one of `robokin ik`."""


ID, INPUT = "id", "input_"
"""A number of the user's, and what stands before it in a document, which has an `id` of its own: what it is about."""


class Carried:
    """Cells that go through, in the order of the rows: the reader puts them in, the writer takes them out."""

    def __init__(self, taken: Collection[str], say: Say, *, wanted: bool = True) -> None:
        """`taken` are the names that the output has itself; `wanted` tells whether anything goes through.

        An `id` where the output has one is called `input_id` in it.
        """
        self.taken, self.say, self.wanted = frozenset(taken), say, wanted
        self.names: tuple[str, ...] = ()
        self.typed = False
        """Whether the cells are values of JSON; else they are text."""
        self.kinds: tuple[str, ...] = ()
        """Of columns that have a type of their own what they hold: number, whole, truth or text."""
        self.rows: deque[Sequence[Any]] = deque()

    def choose(self, headings: Sequence[str], used: Collection[int]) -> list[int]:
        """Which columns of a table go through, by where they stand; `used` are those that were understood."""
        if not self.wanted:
            return []
        by_ik = WRITTEN_BY_IK if {"target", "solution"} <= {*headings} else ()
        places: list[int] = []
        seen = {*self.taken}
        names: list[str] = []
        for i, heading in enumerate(headings):
            if i in used or heading in by_ik or not heading:
                continue
            name = self.named(heading, headings)
            if name in seen:
                if not OWN.fullmatch(name):
                    self.say(f"the column '{shown(heading)}' is left out, since the output has one of that name")
                continue
            places.append(i)
            names.append(name)
            seen.add(name)
        self.names = tuple(names)
        return places

    def named(self, heading: str, headings: Sequence[str]) -> str:
        """What a column is called in the output."""
        if heading != ID or ID not in self.taken:
            return heading
        name = INPUT + ID
        while name in headings:
            name = INPUT + name
        return name

    def put(self, rows: Iterable[Sequence[Any]]) -> None:
        """The cells of some rows."""
        self.rows.extend(rows)

    def taken_out(self, count: int | None = None) -> Carried:
        """The rows that are here, or the first `count` of them, by themselves: those of a block, for a worker."""
        own = Carried((), self.say, wanted=self.wanted)
        own.names, own.typed, own.kinds = self.names, self.typed, self.kinds
        if count is None or count >= len(self.rows):
            own.rows, self.rows = self.rows, deque()
        else:
            own.rows = deque(self.rows.popleft() for _ in range(count))
        return own

    def cells(self) -> list[str]:
        """The next row's cells, as text."""
        return [cell_text(value) for value in self._next()]

    def fronts(self, count: int) -> list[str]:
        """What stands in front of the next rows' lines of a CSV."""
        return [_line(self.cells()) for _ in range(count)]

    def columns(self, count: int) -> list[list[Any]]:
        """The next rows' cells by their columns: values of the columns that have a type, else text."""
        rows = [self._next() for _ in range(count)] if self.names else []
        kinds = self.kinds or ("text",) * len(self.names)
        return [
            [value if kind != "text" else _plain(cell_text(value)) for value in column]
            for kind, column in zip(kinds, zip(*rows, strict=True), strict=True)
        ]

    def in_front_of(self, record: dict[str, Any]) -> dict[str, Any]:
        """A JSON document behind the next row's cells; those of a CSV are numbers where they are plain decimal ones."""
        values = self._next() if self.names else ()
        own = dict(zip(self.names, values if self.typed else map(_value, values), strict=True))
        return own | record

    def before(self, head: bytes, lines: bytes, cells: Iterable[Sequence[str]] | None = None) -> bytes:
        """A heading and lines of CSV, each behind its cells: those that are given, or the next ones."""
        if not self.names:
            return head + lines
        first = [encode(_line(self.names)) + head.removesuffix(b"\n")] if head else []
        rows = lines.splitlines()
        own = (self.cells() for _ in rows) if cells is None else cells
        return b"".join(line + b"\n" for line in [*first, *map(bytes.__add__, map(encode, map(_line, own)), rows)])

    def _next(self) -> Sequence[Any]:
        return self.rows.popleft() if self.rows else ()


OWN = re.compile(r"q\d+|[xyz]|roll|pitch|yaw|q[wxyz]|phi|theta|psi|r[xyz]|[ABCWPR]|m[1-4][1-4]")
"""Columns of joint values and poses: those that are computed take the place of those that were read."""


def given_back(names: Collection[str]) -> str:
    """Which of a document's own names was an `id` before it went through; "" for none."""
    return max((name for name in names if re.fullmatch(f"({INPUT})+{ID}", name)), key=len, default="")


def nothing() -> Carried:
    """Nothing goes through."""
    return Carried((), _unsaid, wanted=False)


def _unsaid(sentence: str) -> None:
    """Say nothing."""


def _line(cells: Sequence[str]) -> str:
    """Cells and the comma behind the last, quoted where they need it."""
    line = ",".join(cells)
    if SPECIAL.search(line) or line.count(",") >= len(cells):
        line = ",".join(f'"{cell.replace(QUOTE, QUOTE * 2)}"' for cell in cells)
    return f"{line},"


def _plain(text: str) -> str:
    """A text as UTF-8 has it."""
    return text if text.isascii() else encode(text).decode()


def cell_text(value: Any) -> str:
    """A value of JSON as a cell: text as it is, nothing as nothing."""
    if isinstance(value, str):
        return value
    return "" if value is None else json.dumps(value, ensure_ascii=False)


def _value(value: str) -> Any:
    if not NUMERAL.fullmatch(value):
        return value
    return float(value) if "." in value else int(value)
