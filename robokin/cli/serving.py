"""Questions on a stream, a line each, answered in order by a document each."""

from __future__ import annotations

import io
import json
import os
import sys
from typing import IO, TYPE_CHECKING, Any

from robokin.cli.statuses import WRONG_INPUT
from robokin.errors import InputError, RobokinError, shown, visible
from robokin.formats.library import library_file
from robokin.formats.plain_robots import FILES, PlainRobot, library_robot
from robokin.quick.plain_words import answered
from robokin.quick.questions import LONGEST_LINE, AskedLine
from robokin.tables.written_rows import json_line

if TYPE_CHECKING:
    from robokin.formats.plain_files import FileRobots

REFUSED = {
    "plot": "plot draws pictures, expected a command that answers with a document",
    "serve": "these questions are served already, expected another command",
}

WRITES = ("-o", "--output", "-p", "--plot", "--gradescope")
"""Options that write files."""

CRASH = 1
"""The status of an answer that failed for no fault of the question."""


class QuestionServer:
    """Answers the questions of `lines` on `answers`."""

    def __init__(self, lines: IO[bytes], answers: IO[bytes]) -> None:
        self.lines, self.answers = lines, answers
        self.number = 0
        self.known: dict[str, tuple[str, tuple[int, ...], PlainRobot]] = {}
        """Robots of the library by the names that questions give them, with their files and these files' stamps."""
        self.files: FileRobots | None = None

    def run(self) -> None:
        """Answer until the lines end. Raises OSError where they cannot be read, or answers cannot be written."""
        while line := self.lines.readline(LONGEST_LINE + 2):
            self.number += 1
            rest = line
            while len(rest) == LONGEST_LINE + 2 and not rest.endswith(b"\n"):
                rest = self.lines.readline(LONGEST_LINE + 2)
            if answer := self.answer(line.rstrip(b"\r\n") if rest is line else line):
                self.answers.write(answer)
                self.answers.flush()

    def answer(self, line: bytes) -> bytes:
        """The answer to a line, a document on a line; b"" for one that asks nothing."""
        question = AskedLine()
        try:
            if not question.read(line):
                return b""
            document = self._plain(question)
            if document is None:
                document = self._documented(question)
            return document
        except RobokinError as error:
            sentence, status = str(error), WRONG_INPUT
        except OSError as error:
            sentence = f"{error.filename or 'a file'}: {error.strerror or error}, expected one that can be read"
            status = WRONG_INPUT
        except Exception as error:  # one question's crash is not the next one's
            sentence, status = f"the answer failed ({type(error).__name__}: {shown(str(error))})", CRASH
        mistake = {"error": visible(sentence, lines=True), "status": status, "line": self.number}
        return json_line(_front(question) | mistake)

    def _plain(self, question: AskedLine) -> bytes | None:
        """The answer to a plain question."""
        document = answered(question.words, self.robot, "jsonl") if question.words[0] == "fk" else None
        if document is None or not question.numbered:
            return document
        return json_line(_front(question))[:-2] + b", " + document[1:]

    def robot(self, name: str) -> PlainRobot | None:
        """A robot of the library or of a plain file, read anew when its file has changed."""
        if name.endswith(FILES):
            if self.files is None:
                from robokin.formats.plain_files import FileRobots

                self.files = FileRobots()
            return self.files.robot(name)
        if name in self.known:
            path, stamp, robot = self.known[name]
            if _stamp(path) == stamp:
                return robot
            del self.known[name]
        found = library_robot(name)
        if found is not None and (file := library_file(found.id)) is not None:
            path = str(file)
            stamp = _stamp(path)
            found = library_robot(name)  # the stamp is that of the file that is read now, or of an older one
            if found is not None:
                self.known[name] = path, stamp, found
        return found

    def _documented(self, question: AskedLine) -> bytes:
        """The answer to any question, by way of the command."""
        words = question.words
        _check(words)
        place = 2 if words[0] == "check" else 1
        status, out, notes = _asked([*words[:place], "--json", *words[place:]])
        try:
            document = json.loads(out)
        except ValueError:
            if notes and not out:
                raise InputError(notes[-1]) from None
            raise InputError("the answer is no document, expected a question that has one") from None
        front: dict[str, Any] = _front(question)
        if status:
            front["status"] = status
        answer = document if isinstance(document, dict) else {"documents": document}
        if notes:  # some documents have notes of their own
            front["notes"] = answer["notes"] = [*dict.fromkeys([*notes, *answer.get("notes", ())])]
        return json_line(front | answer)


def _front(question: AskedLine) -> dict[str, Any]:
    """What stands in front of an answer."""
    return {"input_id": question.id} if question.numbered else {}


def _stamp(path: str) -> tuple[int, ...]:
    """What changes with a file; nothing for one that is not there."""
    try:
        known = os.stat(path)  # noqa: PTH116 - with every question: a Path takes as long again
    except OSError:
        return ()
    return known.st_mtime_ns, known.st_ctime_ns, known.st_size, known.st_ino


def _check(words: list[str]) -> None:
    """Raise InputError for a question that is no question here."""
    if words[0] in REFUSED:
        raise InputError(REFUSED[words[0]])
    for word in words[1:]:
        name = word.partition("=")[0]
        if name in WRITES:
            raise InputError(f"found {shown(name)}, expected no file to write: answers are documents")
        if word == "-" or word.endswith("=-"):
            raise InputError("found -, expected values or a file: standard input holds the questions")


def _asked(words: list[str]) -> tuple[int, bytes, list[str]]:
    """The status of a command line, what it writes, and its notes. Raises what the command raises."""
    from robokin.cli.app import invoke

    out, err = io.TextIOWrapper(io.BytesIO(), encoding="utf-8"), io.StringIO()
    kept = sys.stdin, sys.stdout, sys.stderr
    sys.stdin, sys.stdout, sys.stderr = io.TextIOWrapper(io.BytesIO()), out, err
    try:
        status = invoke(words)
        out.flush()
    finally:
        sys.stdin, sys.stdout, sys.stderr = kept
    said = [line.removeprefix("robokin: ") for line in err.getvalue().splitlines() if line.startswith("robokin: ")]
    return status, out.buffer.getvalue(), said
