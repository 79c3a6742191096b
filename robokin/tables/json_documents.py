"""JSON documents from a stream: one a line, or one JSON text, of which a list's elements come one after another."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any

from robokin.errors import InputError
from robokin.json_text import DECODER, value_in
from robokin.tables.text_source import MAX_ROW, Say, TextSource

WHITE = re.compile(r"[ \t\r\n]*")
COMMA = re.compile(r"[ \t\r\n]*(?:,[ \t\r\n]*)?")
"""What may stand before an element of a list, the first one and the others."""

Numbered = tuple[int, Any]
"""A document with the number of the line where it begins."""


class DocumentReader(TextSource):
    """A stream of JSON; `expected` says in messages what each document is to be."""

    def __init__(self, stream: Any, name: str, expected: str, say: Say) -> None:
        super().__init__(stream, name, say)
        self.expected = expected

    def documents(self) -> Iterator[list[Numbered]]:
        """The documents of each block of lines."""
        blocks = self.blocks()
        for block in blocks:
            lines = block.splitlines(keepends=True)
            first = next((i for i, line in enumerate(lines) if line.strip()), None)
            if first is None:
                self.line += len(lines)
                continue
            # A line that is no whole document begins one JSON text, such as `robokin fk --json` writes.
            if lines[first].strip() in (b"[", b"{"):
                self.line += first
                yield from self._one_text(b"".join(lines[first:]), blocks)
                return
            yield self._of_lines(lines)
            for more in blocks:
                yield self._of_lines(more.splitlines(keepends=True))

    def _of_lines(self, lines: list[bytes]) -> list[Numbered]:
        found = []
        for raw in lines:
            self.line += 1
            if not raw.isspace():
                found.append((self.line, self._document(self.text(raw, self.line))))
        return found

    def _document(self, line: str) -> Any:
        try:
            return value_in(line)
        except InputError as error:
            raise self.error(self.line, str(error)) from None
        except (ValueError, RecursionError) as error:
            raise self._no_json(self.line, error) from None

    def _no_json(self, line: int, error: Exception) -> Exception:
        reason = f"{error.msg} at column {error.colno}" if isinstance(error, json.JSONDecodeError) else str(error)
        return self.error(line, f"this is not JSON ({reason}), {self.expected}")

    def _one_text(self, begun: bytes, blocks: Iterator[bytes]) -> Iterator[list[Numbered]]:
        """The elements of a list, or one object, that stand on as many lines as they like."""
        self.line += 1
        listed = begun.startswith(b"[")
        text = self._whole(begun.removeprefix(b"[") if listed else begun)
        many, done = False, False
        while not done:
            found: list[Numbered] = []
            failure: Exception | None = None
            place = 0
            while failure is None and not done:
                start = self._gap(text, place, comma=listed and many)
                if listed and text.startswith("]", start):
                    place, done = start + 1, True
                    continue
                try:
                    document, place = DECODER.raw_decode(text, start)
                except InputError as error:
                    raise self.error(self.line, str(error)) from None
                except (ValueError, RecursionError) as error:
                    failure, place = error, start
                    continue
                found.append((self.line, document))
                many, done = True, not listed
                self.line += text.count("\n", start, place)
            if found:
                yield found
            text = text[place:]
            if failure is not None:
                more = next(blocks, None) if len(text) <= MAX_ROW else None
                if more is None:
                    raise self._no_json(self.line, failure)
                text += self._whole(more)
        self._end(text, blocks)

    def _gap(self, text: str, place: int, *, comma: bool) -> int:
        """Where the next element begins behind white space and, where one is due, a comma; counts the lines."""
        match = (COMMA if comma else WHITE).match(text, place)
        end = match.end() if match else place
        self.line += text.count("\n", place, end)
        return end

    def _end(self, text: str, blocks: Iterator[bytes]) -> None:
        """Nothing but white space may follow. Raises InputError."""
        while not text.strip():
            self.line += text.count("\n")
            block = next(blocks, None)
            if block is None:
                return
            text = self._whole(block)
        raise self.error(self.line, f"found more after the end of the JSON, {self.expected}")

    def _whole(self, block: bytes) -> str:
        return "".join(self.text(line, self.line) for line in block.splitlines(keepends=True))
