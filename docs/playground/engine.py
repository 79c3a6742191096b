"""The playground's answers: command lines, run by the Python that is in the browser.

It runs in any Python. There is no shell, but what the pages of the lectures do with one is understood: commands of
robokin, pipes between them, a here-document, a change of a word by sed, a loop. Filters at a pipe's end only shorten
an answer, which is shown whole.
"""

from __future__ import annotations

import io
import os
import re
import shlex
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from robokin.cli.app import COMMANDS
from robokin.cli.program import run as run_program
from robokin.errors import InputError
from robokin.formats.library import library_file
from robokin.model import Tree
from robokin.records.description_records import file_record, verdict_of

FILTERS = ("head", "tail", "sed", "grep", "cut", "jq")
"""What a page sends an answer through to show a part of it."""

HERE = re.compile(r"cat > (?P<name>[\w./-]+) <<'?(?P<end>\w+)'?\n(?P<text>.*)\n(?P=end)\s*", re.DOTALL)
CHANGED = re.compile(r"sed 's/(?P<old>[^/\\]*)/(?P<new>[^/\\&]*)/' (?P<from>[\w.-]+) > (?P<to>[\w.-]+)")
EACH = re.compile(r"for (?P<name>\w+) in (?P<words>[\w -]+); do\n(?P<body>.*)\ndone", re.DOTALL)
STATUS = re.compile(r'; echo "status \$\?"$')
QUIET = re.compile(r"\s2>\s*/dev/null")

NO_SHELL = "there is no shell here: expected a command of robokin, such as: robokin fk puma560 --q home"


class NoShellError(Exception):
    """A line that is no command of robokin."""


def run(command: str, columns: int = 80) -> dict[str, Any]:
    """What a command prints.

    `text` and `said` are what it writes on standard output and standard error, `status` its status, `note` what is left
    out of it here; `files` are the bytes of the files that it wrote, by name. columns: the width of the screen.
    """
    command = command.strip()
    if here := HERE.fullmatch(command):
        Path(here["name"]).write_text(here["text"] + "\n", encoding="utf-8")
        return answer(note=f"{here['name']} is written")
    if changed := CHANGED.fullmatch(command):
        before = Path(changed["from"]).read_text(encoding="utf-8")
        after = [line.replace(changed["old"], changed["new"], 1) for line in before.splitlines(keepends=True)]
        Path(changed["to"]).write_text("".join(after), encoding="utf-8")
        return answer(note=f"{changed['to']} is written")
    if each := EACH.fullmatch(command):
        lines = [each["body"].strip().replace(f"${each['name']}", word) for word in each["words"].split()]
        found = [run(line, columns) for line in lines]
        return found[-1] | {part: "".join(one[part] for one in found) for part in ("text", "said")}
    try:
        steps, note = steps_of(STATUS.sub("", QUIET.sub("", command)))
    except (NoShellError, ValueError) as error:
        return answer(said=str(error), status=2)
    found = answer()
    for words in steps:
        found = asked(words, columns, found["text"])
    if STATUS.search(command):
        found["text"] += f"status {found['status']}\n"
    return found | {"note": note}


def answer(text: str = "", said: str = "", status: int = 0, note: str = "") -> dict[str, Any]:
    """An answer's parts."""
    return {"text": text, "said": said, "status": status, "note": note, "files": {}}


def steps_of(command: str) -> tuple[list[list[str]], str]:
    """The words of each command of a pipe, without `robokin`, and a note where filters at its end are left out.

    Raises NoShellError for anything else, ValueError for quotes that do not end.
    """
    lexer = shlex.shlex(command, posix=True, punctuation_chars="|;<>&")
    lexer.whitespace_split, lexer.commenters = True, "#"
    steps: list[list[str]] = [[]]
    for word in lexer:
        if word == "|":
            steps.append([])
        elif word and set(word) <= set(";<>&|"):
            raise NoShellError(NO_SHELL)
        else:
            steps[-1].append(word)
    note = ""
    while len(steps) > 1 and steps[-1][:1] and steps[-1][0] in FILTERS:
        note = f" | {shlex.join(steps.pop())}{note}"
    for number, words in enumerate(steps):
        if words[:1] == ["robokin"]:
            del words[0]
        elif len(steps) > 1 or (words and words[0] not in COMMANDS and not words[0].startswith("-")):
            raise NoShellError(NO_SHELL)
        if words[:1] == ["serve"]:
            raise NoShellError("serve answers programs; here each command is answered by itself")
        steps[number] = words
    return steps, f"the whole answer, without{note}" if note else ""


def asked(words: list[str], columns: int, given: str) -> dict[str, Any]:
    """What the command line with these words answers; `given` is its standard input."""
    before = stamps()
    with captured(columns, given) as (out, err):
        try:
            status = run_program(words)
        except SystemExit as end:
            status = end.code if isinstance(end.code, int) else 1
        except Exception as error:  # one answer's crash is not the end of the page
            status = 1
            err.write(f"robokin: the answer failed ({type(error).__name__}: {error})\n")
        out.flush()
        text = out.buffer.getvalue().decode("utf-8", "replace")  # type: ignore[attr-defined]
    files = {name: Path(name).read_bytes() for name, stamp in stamps().items() if before.get(name) != stamp}
    return answer(text, err.getvalue(), status) | {"files": files}


@contextmanager
def captured(columns: int, given: str) -> Iterator[tuple[io.TextIOWrapper, io.StringIO]]:
    """The process's streams in memory, with what is given on standard input, for a screen of so many columns."""
    out, err = io.TextIOWrapper(io.BytesIO(), encoding="utf-8"), io.StringIO()
    kept = sys.stdin, sys.stdout, sys.stderr, os.environ.get("COLUMNS")
    sys.stdin, sys.stdout, sys.stderr = io.TextIOWrapper(io.BytesIO(given.encode())), out, err
    os.environ["COLUMNS"] = str(max(40, int(columns)))
    try:
        yield out, err
    finally:
        sys.stdin, sys.stdout, sys.stderr = kept[:3]
        if kept[3] is None:
            del os.environ["COLUMNS"]
        else:
            os.environ["COLUMNS"] = kept[3]


def stamps() -> dict[str, tuple[int, int]]:
    """The files of this folder with what tells that one has changed."""
    return {str(path): (path.stat().st_mtime_ns, path.stat().st_size) for path in Path().iterdir() if path.is_file()}


def description(name: str) -> str:
    """The text of a description of the library."""
    found = library_file(name)
    if found is None:
        raise ValueError(f"there is no robot {name} in the library")
    return found.read_text(encoding="utf-8")


def written(name: str, text: str) -> dict[str, Any]:
    """Write a description; what it describes, or what is wrong with it: the document of `robokin validate`.

    Beside that `tips` has, of a tree with several, a pair for each: its name, and the places of its chain's joint
    values among those of the tree, of which there are `joints`.
    """
    Path(name).write_text(text, encoding="utf-8")
    verdict = verdict_of(name)
    return file_record(name, verdict) | {"tips": tips_of(verdict), "joints": getattr(verdict, "n", 0)}


def tips_of(verdict: object) -> list[list[Any]]:
    """The tips of a tree that has several, each with the places of its chain's joint values; [] of anything else."""
    if not isinstance(verdict, Tree) or len(verdict.tips) < 2:
        return []
    places = {joint.name: place for place, joint in enumerate(verdict.joints)}
    found: list[list[Any]] = []
    for tip in verdict.tips:
        try:
            found.append([tip, [places[joint.name] for joint in verdict.robot(tip).joints]])
        except InputError:  # a joint that chains do not have: the question says which
            found.append([tip, []])
    return found
