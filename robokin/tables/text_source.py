"""A stream of text in blocks of whole lines: where lines end, which bytes are text, and how much is too much."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from robokin.errors import InputError
from robokin.files import wait_for

CHUNK = 1 << 18
"""Bytes read at once: about 2,000 lines of six numbers."""

MAX_ROW = 1 << 20
"""Bytes of a row: a longer one is no row of numbers."""

MAX_NOTHING = 1 << 22
"""Bytes of blank lines and comments on end: a stream of more may have no end."""

BYTE_ORDER_MARK = b"\xef\xbb\xbf"
"""What some editors put before UTF-8."""

UTF_16 = (b"\xff\xfe", b"\xfe\xff")
"""What a text in UTF-16 begins with."""

ROWS = "a file of rows (.csv, .jsonl, .npy or .parquet)"
"""What is expected where a file of many configurations or poses is named."""

Say = Callable[[str], None]
"""Takes a sentence for the user."""


class TextSource:
    """A stream of bytes that is to be text, its name in messages, and where notes about it go."""

    def __init__(self, stream: Any, name: str, say: Say) -> None:
        self.stream = stream
        self.name = name
        self.say = say
        self.line = 0
        """Number of the last line that was handed on."""
        self.latin = False
        """Whether a note has said that some lines are read as Latin-1."""

    def error(self, line: int, message: str) -> InputError:
        """An error that names the stream and the line."""
        return InputError(f"{self.name}, line {line}: {message}")

    def blocks(self) -> Iterator[bytes]:
        """Blocks of whole lines, as they come. A line ends with LF, CR LF or CR, the last one perhaps with nothing."""
        kept = b""
        first = True
        nothing = 0
        while True:
            if not first:  # where the stream was looked at, its buffer has the first bytes
                wait_for(self.stream)
            if not (chunk := self.stream.read1(CHUNK)):
                break
            if first:
                chunk, first = self._beginning(chunk), False
            # Behind a CR that ends the chunk there may come its LF.
            cut = max(chunk.rfind(b"\n"), chunk.rfind(b"\r", 0, -1)) + 1
            if not cut:
                kept += chunk
                if len(kept) > MAX_ROW:
                    raise self.error(self.line + 1, f"longer than {MAX_ROW} bytes, expected a row")
                continue
            block, kept = kept + chunk[:cut], chunk[cut:]
            nothing = nothing + len(block) if says_nothing(block) else 0
            if nothing > MAX_NOTHING:
                said = f"found more than {MAX_NOTHING} bytes of blank lines and comments"
                raise self.error(self.line + 1, f"{said}, expected rows")
            yield block
        if kept:
            yield kept

    def _beginning(self, chunk: bytes) -> bytes:
        """The first bytes without a byte order mark. Raises InputError for what is no UTF-8 by its first bytes."""
        while len(chunk) < len(BYTE_ORDER_MARK):
            wait_for(self.stream)
            if not (more := self.stream.read1(CHUNK)):
                break
            chunk += more
        if chunk.startswith(UTF_16):
            raise InputError(f"{self.name}: found text in UTF-16, expected UTF-8 (in Excel: save as CSV UTF-8)")
        if chunk.startswith(b"PK\x03\x04"):
            raise InputError(f"{self.name}: found a spreadsheet or a zip archive, expected CSV: save it as CSV UTF-8")
        return chunk.removeprefix(BYTE_ORDER_MARK)

    def text(self, line: bytes, number: int) -> str:
        """A line as text: UTF-8, or else Latin-1 as Windows extends it, with a note for the first such line."""
        if b"\0" in line:
            raise self.error(number, "found bytes that are no text, expected UTF-8")
        try:
            return line.decode()
        except UnicodeDecodeError:
            if not self.latin:
                self.latin = True
                self.say(f"{self.name}, line {number}: not UTF-8, read as Latin-1 (Windows-1252)")
            return line.decode("cp1252", errors="replace")


def says_nothing(block: bytes) -> bool:
    """Whether all lines of a block are blank, or comments."""
    if block[:1].isspace() or block[:1] == b"#":  # what begins with anything else says something
        return all(not line or line.startswith(b"#") for line in map(bytes.strip, block.splitlines()))
    return False
