"""Parts of a long answer as files: each whole or absent, written where its folder is seen, else handed back.

A part is written under another name, and takes its own when it has reached the disk.
"""

from __future__ import annotations

import contextlib
import hashlib
import io
import json
import os
import zlib
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import IO, Any

from robokin.errors import OutputError
from robokin.unfinished_work import unfinished

WORD = "_word"
"""The file that tells a worker whether it sees the folder of its run."""

PIECE = 1 << 22
"""Bytes read at once of a part that is looked at again."""


@dataclass(frozen=True)
class WrittenPart:
    """A part that is there: its number from 0, its rows, its bytes with their SHA-256, and what it answers.

    questions: how many rows of the input it answers; asked: the digest of these, or ""; found: what else is known.
    """

    number: int
    rows: int
    bytes: int
    sha256: str
    questions: int = 0
    asked: str = ""
    found: Any = None

    @property
    def file(self) -> str:
        """The file's name."""
        return f"part-{self.number:08d}.parquet"


def record_of(part: WrittenPart) -> dict[str, Any]:
    """What a manifest or a journal says of a part, with the check sum of this."""
    return asdict(part) | {"check": _check_sum(part)}


def _check_sum(part: WrittenPart) -> int:
    return zlib.crc32(json.dumps(asdict(part)).encode())


def part_of(record: Any) -> WrittenPart | None:
    """The part that a record of a manifest or of a journal means; None for what is none or is damaged."""
    try:
        part = WrittenPart(**{key: value for key, value in record.items() if key not in ("file", "check")})
        if "check" in record and record["check"] != _check_sum(part):  # those of older folders have none
            return None
    except (AttributeError, TypeError, RecursionError):
        return None
    whole = (part.number, part.rows, part.bytes, part.questions)
    texts = isinstance(part.sha256, str) and isinstance(part.asked, str)
    return part if texts and all(type(value) is int and value >= 0 for value in whole) else None


@dataclass(frozen=True)
class PartPlace:
    """Where parts go: a folder, and a word that stands in it, by which a worker knows that it sees the same one."""

    folder: str
    word: str

    def seen(self) -> bool:
        """Whether this machine has the folder before it."""
        with contextlib.suppress(OSError):
            return (Path(self.folder) / WORD).read_text("ascii").strip() == self.word
        return False

    def holds(self, part: WrittenPart) -> bool | None:
        """Whether a part is there with the bytes that it had; None where the folder is not seen from here."""
        if not self.seen():
            return None
        digest, size = hashlib.sha256(), 0
        try:
            with open(Path(self.folder) / part.file, "rb") as stream:  # noqa: PTH123 - the same of any path
                while piece := stream.read(PIECE):
                    digest.update(piece)
                    size += len(piece)
        except OSError:
            return False
        return size == part.bytes and digest.hexdigest() == part.sha256

    def write(self, part: WrittenPart, data: bytes) -> None:
        """Write the bytes of a part that was made where the folder is not seen. Raises OutputError."""
        with self.new(part.file) as stream:
            stream.write(data)

    @contextlib.contextmanager
    def new(self, name: str) -> Iterator[IO[bytes]]:
        """A stream to a file that takes its name when all of it is on the disk. Raises OutputError."""
        folder = Path(self.folder)
        temporary = folder / f".{name}.{os.urandom(4).hex()}.part"
        try:
            with unfinished(str(temporary)):
                with temporary.open("xb") as stream:
                    yield stream
                    stream.flush()
                    os.fsync(stream.fileno())
                temporary.replace(folder / name)
                _settle(folder)
        except OSError as error:
            raise OutputError(
                f"{self.folder}: {error.strerror or error}, the parts that are whole are kept, --resume goes on"
            ) from None

    def made(
        self, number: int, fill: Callable[[IO[bytes]], tuple[int, Any]], questions: int, asked: str
    ) -> tuple[WrittenPart, bytes | None]:
        """A part whose content a function writes, and its bytes where the folder is not seen from here.

        fill: gives the number of rows and what else is known.
        """
        name, data = WrittenPart(number, 0, 0, "").file, None
        if self.seen():
            with self.new(name) as stream:
                digested: Any = _Digested(stream)
                rows, found = fill(digested)
        else:
            kept = io.BytesIO()
            digested = _Digested(kept)
            rows, found = fill(digested)
            data = kept.getvalue()
        return WrittenPart(number, rows, digested.size, digested.digest.hexdigest(), questions, asked, found), data


class _Digested(io.RawIOBase):
    """A stream that is written to another one, with its size and its SHA-256."""

    def __init__(self, stream: IO[bytes]) -> None:
        self.stream, self.size, self.digest = stream, 0, hashlib.sha256()

    def writable(self) -> bool:
        """It is."""
        return True

    def write(self, data: Any) -> int:
        """Write some bytes."""
        self.digest.update(data)
        count = memoryview(data).nbytes
        self.size += count
        self.stream.write(data)
        return count


def _settle(folder: Path) -> None:
    """Bring what a folder lists to the disk, where the system can."""
    with contextlib.suppress(OSError, AttributeError):
        number = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
        try:
            os.fsync(number)
        finally:
            os.close(number)
