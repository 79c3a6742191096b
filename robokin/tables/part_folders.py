"""Folders of parts: a long answer as Parquet files, each of which is whole or absent.

`part-00000000.parquet` and so on hold the rows in their order. `_manifest.json` says what was asked, and when all is
done which parts there are, with the SHA-256 of each; until then `_done.jsonl` has a line for each part that is there.
Readers of such folders pass over names that begin with an underscore or a point.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import IO, Any

from robokin.errors import InputError, OutputError, counted, shown
from robokin.files import open_path, read_up_to
from robokin.tables.part_files import WORD, PartPlace, WrittenPart, part_of, record_of
from robokin.unfinished_work import in_order

MANIFEST, JOURNAL, LOCK = "_manifest.json", "_done.jsonl", "_lock"

OWN = re.compile(r"part-\d{8,}\.parquet|_manifest\.json|_done\.jsonl|_lock|_word|\.[\w.-]+\.part")
"""What a run writes in its folder."""

MOST_OF_A_MANIFEST = 1 << 30
"""Bytes of a manifest, or of a journal: a part has some two hundred."""

EXPECTED = "a folder of parts as robokin writes it"


class PartFolder:
    """A folder that a run writes its parts to."""

    def __init__(self, output: str, question: dict[str, Any]) -> None:
        self.output, self.path = output, Path(output)
        self.question = json.loads(json.dumps(question))  # as it will be read
        with self._saying():  # the folder that the command is in may be gone
            self.place = PartPlace(str(self.path.absolute()), os.urandom(16).hex())
        self.recorded: dict[int, WrittenPart] = {}
        """The parts that an earlier run has recorded."""
        self.journal: IO[bytes] | None = None
        self.lock: IO[bytes] | None = None

    @classmethod
    @contextlib.contextmanager
    def opened(cls, output: str, question: dict[str, Any], *, resume: bool) -> Iterator[PartFolder]:
        """A folder for the parts of a question (JSON values by their names), which is made if it is not there.

        With `resume` the parts of an earlier run are gone on with. Raises OutputError for a place that cannot be
        written, or that another run is writing, InputError where there are the parts of another question, or parts and
        no `resume`.
        """
        folder = cls(output, question)
        with in_order():
            with folder._saying():
                folder.path.mkdir(parents=True, exist_ok=True)
                foreign = sorted(one.name for one in folder.path.iterdir() if not OWN.fullmatch(one.name))
                if foreign:
                    said = f"found '{shown(foreign[0])}', which is no part of a run"
                    raise OutputError(f"--output {output}: {said}, expected an empty folder, or one that robokin wrote")
                folder._take()
            try:
                with folder._saying():
                    folder._begin(resume)
                yield folder
            finally:
                folder._leave()

    @contextlib.contextmanager
    def _saying(self) -> Iterator[None]:
        """What the system refuses becomes an OutputError."""
        try:
            yield
        except OSError as error:
            sentence = f"--output {self.output}: {error.strerror or error}, expected a folder that can be written"
            raise OutputError(sentence) from None

    def _take(self) -> None:
        """Two runs must not write the same folder; where the system knows no locks, that is the user's care."""
        self.lock = open(self.path / LOCK, "ab")  # noqa: SIM115, PTH123 - open as long as the run goes on
        with contextlib.suppress(ImportError):
            import fcntl

            try:
                # Of this process alone: workers that outlive it do not hold it.
                fcntl.lockf(self.lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except (BlockingIOError, PermissionError):
                self.lock.close()
                raise OutputError(
                    f"--output {self.output}: another run is writing this folder, expected it to be done"
                ) from None
            except OSError:
                pass  # a file system without locks
        (self.path / WORD).write_text(self.place.word, "ascii")

    def _begin(self, resume: bool) -> None:
        """Read what an earlier run has left, or say what this one is about."""
        for left in self.path.glob(".*.part"):
            left.unlink(missing_ok=True)
        manifest = self.path / MANIFEST
        if not manifest.exists():
            if any(self.path.glob("part-*.parquet")):
                raise InputError(f"{self.output}: found parts without {MANIFEST}, expected another folder")
            self._manifest({"complete": False})
        else:
            if not resume:
                said = f"--output {self.output}: found the parts of a run"
                raise InputError(f"{said}, expected --resume to go on with it, or another folder")
            found = read_manifest(self.output)
            self._compare(found["question"])
            listed = found.get("parts") or []
            for part in filter(None, map(part_of, [*listed, *self._journal()])):
                self.recorded[part.number] = part
            # At no moment is a part that is there in neither of the two.
            with self.place.new(JOURNAL) as stream:
                stream.writelines(_line(self.recorded[number]) for number in sorted(self.recorded))
            if found.get("complete"):
                self._manifest({"complete": False})
        self.journal = (self.path / JOURNAL).open("ab")

    def _compare(self, before: dict[str, Any]) -> None:
        """Raises InputError where the folder answers another question."""
        for key, value in self.question.items():
            if before.get(key) == value:
                continue
            if key == "description":
                robot = self.question.get("robot")
                raise InputError(
                    f"--resume: {self.output} was made from another description of {robot}, expected the same one"
                )
            said = before.get(key)
            text = shown(json.dumps(said)) if isinstance(said, dict | list) else said
            raise InputError(f"--resume: {self.output} was made with {key} {text}, found {value}, expected the same")

    def _journal(self) -> list[Any]:
        """The records of the journal; the last line may be torn."""
        path = self.path / JOURNAL
        if not path.is_file():
            return []
        with open_path(str(path), EXPECTED) as stream:
            data = read_up_to(stream, str(path), MOST_OF_A_MANIFEST, EXPECTED)
        records = []
        for line in data.split(b"\n"):
            with contextlib.suppress(ValueError, RecursionError):
                records.append(json.loads(line))
        return records

    def record(self, part: WrittenPart) -> None:
        """Say that a part is there."""
        assert self.journal is not None
        with self._saying():
            self.journal.write(_line(part))
            self.journal.flush()
            os.fsync(self.journal.fileno())

    def finish(self, parts: Iterable[WrittenPart]) -> None:
        """All parts are there: say so in the manifest, whose bytes hang on nothing but the question and its answer."""
        listed = [{"file": part.file} | record_of(part) for part in sorted(parts, key=lambda part: part.number)]
        rows = sum(part["rows"] for part in listed)
        self._manifest({"complete": True, "rows": rows, "parts": listed})
        if self.journal is not None:
            self.journal.close()
        (self.path / JOURNAL).unlink(missing_ok=True)

    def _manifest(self, more: dict[str, Any]) -> None:
        with self.place.new(MANIFEST) as stream:
            stream.write(json.dumps({"schema": 1, "question": self.question} | more, indent=1).encode() + b"\n")

    def _leave(self) -> None:
        """Nothing under a temporary name stays, nor the lock."""
        for left in self.path.glob(".*.part"):
            left.unlink(missing_ok=True)
        if self.journal is not None:
            self.journal.close()
        (self.path / WORD).unlink(missing_ok=True)
        if self.lock is not None:
            self.lock.close()


def _line(part: WrittenPart) -> bytes:
    return json.dumps(record_of(part)).encode() + b"\n"


def read_manifest(folder: str) -> dict[str, Any]:
    """What the manifest of a folder says. Raises InputError for what is none."""
    path = str(Path(folder) / MANIFEST)
    with open_path(path, EXPECTED) as stream:
        data = read_up_to(stream, path, MOST_OF_A_MANIFEST, EXPECTED)
    try:
        found = json.loads(data)
    except (ValueError, RecursionError):
        found = None
    parts = found.get("parts", []) if isinstance(found, dict) else None
    if not isinstance(found, dict) or not isinstance(found.get("question"), dict) or not isinstance(parts, list):
        raise InputError(f"{path}: this is no manifest of parts, expected one as robokin writes it")
    return found


def whole_parts(folder: str) -> list[str]:
    """The files of a folder of Parquet files, in the order of their rows.

    Of a folder that robokin wrote the parts of its manifest. Raises InputError where a run is not done, where a part is
    missing or was changed in length or in its record, and for a folder without such files.
    """
    path = Path(folder)
    if (path / MANIFEST).is_file():
        found = read_manifest(folder)
        if not found.get("complete"):
            raise InputError(f"{folder}: found the parts of a run that is not done, expected --resume to finish it")
        parts = [part for part in map(part_of, found.get("parts", [])) if part is not None]
        numbers, rows = [part.number for part in parts], sum(part.rows for part in parts)
        if numbers != [*range(len(found.get("parts", [])))] or rows != found.get("rows"):
            raise InputError(
                f"{path / MANIFEST}: it was changed, expected one as robokin wrote it; --resume makes it anew"
            )
        for part in parts:
            file = path / part.file
            if not file.is_file() or file.stat().st_size != part.bytes:
                raise InputError(
                    f"{file}: found no file of {counted(part.bytes, 'byte')}, expected the part of its run"
                )
        return [str(path / part.file) for part in parts]
    try:
        names = [one.name for one in path.iterdir() if one.suffix.lower() == ".parquet" and one.name[0] not in "._"]
    except OSError as error:
        raise InputError(f"{folder}: {error.strerror}, expected a folder that can be read") from None
    if not names:
        raise InputError(f"{folder}: found a directory without .parquet files, expected a file of rows, or parts")
    return [str(path / name) for name in sorted(names, key=_by_numbers)]


def _by_numbers(name: str) -> list[tuple[int, str]]:
    """Names in the order of the numbers in them: part.2 before part.10."""
    return [(int(text), "") if text.isdecimal() else (-1, text) for text in re.split(r"(\d+)", name)]
