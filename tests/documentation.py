"""What the pages show: find the console blocks, run them, compare, and rewrite them.

`make docs` runs this file. It writes a page for each command that has none, the list of commands in docs/README.md, the
reference of the public names (docs/api.md), and in README.md, docs/ and its notebooks what each command and each cell
shows today, wherever that is not what the page shows.

A console block holds commands after `$ ` (further lines of one after `> `) and what they print. The blocks of a page
run from top to bottom in one folder of their own, so what a command writes is there for the next one. The folder is
empty, or holds what stands beside the page in a folder of its name (docs/grading/ for docs/grading.md).
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from unittest import mock

import api_reference
import notebooks

ROOT = Path(__file__).parent.parent
DOCS = ROOT / "docs"
INDEX = DOCS / "README.md"

NOT_RUN = re.compile(r"(make|pip|pipx|uv|git|cd) ")
"""Commands of an installation, which a page may show without output."""

OPTIONAL = ("jq",)
"""Programs that not every machine has; what needs one is run where it is."""

PLAIN = re.compile(r"""(?:[^'"\\$`*?<>;&(){}\[\]~#!\n]|'[^']*'|"[^"\\$`]*")*""")
"""A command that means to a shell what its words say: no variables, patterns, redirections, lists."""

NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
CLOSE = 1e-9
"""Numbers of a page may differ by this, relative or absolute: the last digit of a sine is the processor's own."""


@dataclass(frozen=True)
class Step:
    """A command of a page and what the page shows of it: the lines `start` to `end`, the latter excluded."""

    command: str
    shown: str
    start: int
    end: int


def steps(text: str) -> Iterator[Step]:
    """The commands of all console blocks of a page."""
    lines = text.splitlines()
    command, start, inside = "", 0, False
    for i, line in enumerate(lines):
        if not inside:
            inside = line == "```console"
        elif line == "```" or line.startswith("$ "):
            if command:
                yield Step(command, "\n".join(lines[start:i]).rstrip(), start, i)
            command, start, inside = line[2:], i + 1, line != "```"
            command = command if inside else ""
        elif line.startswith("> ") and i == start:
            command, start = f"{command}\n{line[2:]}", i + 1


def runs(command: str) -> bool:
    """Whether a command is one to be run here."""
    missing = (name for name in OPTIONAL if re.search(rf"\b{name}\b", command) and not shutil.which(name))
    return not NOT_RUN.match(command) and not any(missing)


def output(command: str) -> str:
    """What a user sees of a command in the current folder: both streams, as a terminal of 80 columns shows them."""
    shown = in_this_process(command) if PLAIN.fullmatch(command) else in_a_shell(command)
    return "\n".join(line.rstrip() for line in shown.decode().rstrip().splitlines())


def in_a_shell(command: str) -> bytes:
    """Both streams of a command line that sh runs."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    environment = {**os.environ, "PATH": path, "COLUMNS": "80", "PYTHONUNBUFFERED": "1"}
    return subprocess.run(
        ["sh", "-c", command], env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False
    ).stdout


def in_this_process(command: str) -> bytes:
    """Both streams of a pipeline whose robokins run here, which saves their start."""
    words = shlex.shlex(command, posix=True, punctuation_chars="|")
    words.whitespace_split = True
    stages: list[list[str]] = [[]]
    for word in words:
        stages.append([]) if word == "|" else stages[-1].append(word)
    screen, data = io.BytesIO(), b""
    for i, stage in enumerate(stages):
        sink = screen if i == len(stages) - 1 else io.BytesIO()
        if stage[0] == "robokin":
            robokin(stage[1:], data, sink, screen)
        else:
            done = subprocess.run(stage, input=data, capture_output=True, check=False)
            screen.write(done.stderr)
            sink.write(done.stdout)
        data = sink.getvalue()
    return screen.getvalue()


def robokin(arguments: list[str], data: bytes, sink: io.BytesIO, screen: io.BytesIO) -> None:
    """Run a command line in this process."""
    from robokin.cli import run

    out, err = (io.TextIOWrapper(stream, encoding="utf-8", line_buffering=True) for stream in (sink, screen))
    source = io.TextIOWrapper(io.BytesIO(data), encoding="utf-8")
    with (
        mock.patch.multiple(sys, stdin=source, stdout=out, stderr=err),
        mock.patch.dict(os.environ, {"COLUMNS": "80"}),
    ):
        run(arguments)
    for stream in (out, err):
        stream.flush()
        stream.detach()


def same(printed: str, shown: str) -> bool:
    """Whether two outputs are the same text, their numbers to 1e-9."""
    if printed == shown:
        return True
    if NUMBER.sub("#", printed) != NUMBER.sub("#", shown):
        return False
    pairs = zip(NUMBER.findall(printed), NUMBER.findall(shown), strict=True)
    return all(abs(float(a) - float(b)) <= CLOSE * max(1.0, abs(float(b))) for a, b in pairs)


def lay_out(page: Path, folder: Path) -> None:
    """Copy the files that a page needs into a folder."""
    beside = page.with_suffix("")
    if beside.is_dir():
        shutil.copytree(beside, folder, dirs_exist_ok=True)


def rewritten(text: str, page: Path = INDEX) -> str:
    """A page with what its commands print now; what is right to 1e-9 stays as it is."""
    lines = text.splitlines()
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        lay_out(page, Path(folder))
        # The outputs are put in from the end, so that the places of those before stay what they are.
        outputs = [(step, output(step.command)) for step in steps(text) if runs(step.command)]
    for step, printed in reversed(outputs):
        if not same(printed, step.shown):
            lines[step.start : step.end] = printed.splitlines()
    return "\n".join(lines) + "\n"


def pages() -> list[Path]:
    """README.md and every page of docs/."""
    return [ROOT / "README.md", *sorted(DOCS.rglob("*.md"))]


# The pages of the commands ------------------------------------------------------------------------------------


def command_page(name: str) -> Path:
    """Where the page of a command is."""
    return DOCS / "commands" / f"{name}.md"


def new_command_page(name: str, line: str) -> str:
    """A page for a command that has none: its help, and the first of the help's examples."""
    _, _, examples = output(f"robokin {name} --help").partition("\nExamples:\n")
    example = examples.splitlines()[0].strip() if examples else f"robokin {name}"
    return (
        f"# robokin {name}\n\n{line}\n\n```console\n$ {example}\n```\n\n"
        f"## All options\n\n```console\n$ robokin {name} --help\n```\n"
    )


def with_title(page: str, name: str, line: str) -> str:
    """A command's page with the title and the line that the command has now."""
    return "\n".join([f"# robokin {name}", "", line, *page.splitlines()[3:]]) + "\n"


def with_commands(index: str) -> str:
    """The index with a line for each command between its marks."""
    from robokin.cli.app import COMMANDS

    rows = [f"| [{name}](commands/{name}.md) | {line} |" for name, line in COMMANDS.items()]
    table = "\n".join(["", "| command | |", "| --- | --- |", *rows, ""])
    parts = re.split(r"(<!-- commands -->|<!-- end -->)", index)
    return "".join([*parts[:2], table, *parts[3:]])


def main() -> None:
    """Write what is missing and what is not true any more; say which pages those were."""
    from robokin.cli.app import COMMANDS

    for name, line in COMMANDS.items():
        page = command_page(name)
        page.parent.mkdir(exist_ok=True)
        page.write_text(with_title(page.read_text() if page.exists() else new_command_page(name, line), name, line))
    api_reference.PAGE.write_text(api_reference.page())
    wanted = [(ROOT / name).resolve() for name in sys.argv[1:]]
    for page in pages():
        if wanted and page not in wanted:
            continue
        text = page.read_text()
        now = rewritten(with_commands(text) if page == INDEX else text, page)
        if now != text:
            page.write_text(now)
            print(f"rewritten: {page.relative_to(ROOT)}")
    for path in notebooks.notebooks() if not wanted else ():
        text = path.read_text()
        now = notebooks.text_of(notebooks.run(notebooks.read(path)))
        if not same(now, text):
            path.write_text(now)
            print(f"rewritten: {path.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
