"""Hostile command lines: from the commands' own options and the pages' examples, changed a little at a time."""

from __future__ import annotations

import itertools
import random
import re
import shlex
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import typer
from documentation import DOCS, ROOT, runs, steps
from fuzz_files import NAMES, contents, mutated

from robokin.cli.app import COMMANDS, app
from robokin.cli.commands.check_command import CHECKS
from robokin.formats import library_names

OFTEN = {"frame": 9, "fk": 9, "validate": 7, "ik": 6, "show": 4, "jacobian": 5, "path": 3, "dof": 3, "list": 1,
         "schema": 0.2, "singular": 0.4, "plot": 1.5, "workspace": 0.6, "check": 9}  # fmt: skip
"""How often each command is drawn; those that take long, seldom."""

NUMBERS = ("0", "-0", "1", "-1", "90", "1e308", "-1e308", "1e400", "1e-320", "nan", "inf", "-inf", "1e16", "1e30",
           "0x1F", "1_000", "9" * 25, "9" * 400, "1/0", "sqrt(-1)", "pi", "2*pi", "1/3", "sqrt(2)/2", "deg(90)", "-",
           "+", ".", "1,5", "½", "−5", "٣", "1e", "--1", "(1", "1)", "1 2", "2**9**9", "atan2(0,0)", "acos(2)",
           "tan(90)", "0.1+0.2")  # fmt: skip
"""What stands where a number may stand."""

WORDS = ("", " ", "-", "--", "=", "home", "table", "json", "jsonl", "csv", "yes", "NULL", "none", "é", "\u202e",
         "\x1b[31m", "a\tb", "a\nb", "a" * 5000, "%s", "{0}", "[red]", "\\", "'", '"', "q1=", "=1",
         "q1=q1", "a=1", "~", "*", "🤖")  # fmt: skip
"""What stands where anything else may stand."""

TERMINALS: tuple[dict[str, str], ...] = (
    {}, {"TERM": "dumb"}, {"COLUMNS": "1"}, {"COLUMNS": "0"}, {"COLUMNS": "-5"}, {"COLUMNS": "x"}, {"NO_COLOR": "1"},
    {"LANG": "C", "LC_ALL": "C"}, {"FORCE_COLOR": "1"}, {"TERM": ""}, {"PYTHONIOENCODING": "ascii"},
)  # fmt: skip
"""Environments of odd terminals."""


OUTSIDE = re.compile(r"^(--?[\w-]*=?)?[/~]|\.\.|/\.")
"""Places outside the folder of a call."""


@dataclass(frozen=True)
class Call:
    """A command line and all that it meets."""

    arguments: tuple[str, ...]
    files: dict[str, bytes] = field(default_factory=dict)
    stdin: bytes = b""
    environment: dict[str, str] = field(default_factory=dict)
    closed: tuple[str, ...] = ()
    terminal: bool = False
    own_process: bool = False

    @property
    def command(self) -> str:
        """`fk`, `check ik` and so on."""
        return " ".join(self.arguments[: 1 + (self.arguments[:1] == ("check",))])


class Caller:
    """Makes calls. What it has seen to be answered in a new way is what it changes next."""

    def __init__(self, seed: str) -> None:
        self.rng = random.Random(seed)
        self.examples = list(examples())
        self.options = {name: options(command) for name, command in commands()}
        self.values: defaultdict[str, list[str]] = defaultdict(list)
        for example in self.examples:
            for option, value in itertools.pairwise(example):
                if option.startswith("-") and not value.startswith("--"):
                    self.values[option].append(value)
        self.robots = library_names()
        self.kept: defaultdict[tuple[str, bool], list[Call]] = defaultdict(list)

    def keep(self, call: Call, refused: bool) -> None:
        """Remember a call that was answered, or refused, as none before."""
        kept = self.kept[call.arguments[0], refused]
        kept.append(call)
        del kept[:-200]

    def call(self) -> Call:
        """The next call."""
        rng = self.rng
        command = rng.choices(list(OFTEN), list(OFTEN.values()))[0]
        kept = self.kept[command, rng.random() < 0.25]
        if kept and rng.random() < 0.5:
            call = replace(rng.choice(kept), environment={}, closed=(), terminal=False)
            words, files = list(call.arguments), dict(call.files)
        else:
            found = [example for example in self.examples if example[0] == command]
            words = list(rng.choice(found)) if found and rng.random() < 0.7 else self.from_options(command)
            files = {}
        for _ in range(rng.choice((0, 1, 1, 1, 1, 2, 2, 5))):
            self.change(words)
        self.change_files(words, files)
        stdin = rng.choice(list(files.values())) if files and rng.random() < 0.5 else contents(rng, rng.choice(NAMES))
        return Call(
            tuple(harmless(words)),
            files,
            stdin if rng.random() < 0.8 else b"",
            rng.choice(TERMINALS) if rng.random() < 0.2 else {},
            tuple(name for name in ("stdin", "stdout", "stderr") if rng.random() < 0.5) if rng.random() < 0.04 else (),
            rng.random() < 0.08,
            rng.random() < 0.004,
        )

    def from_options(self, command: str) -> list[str]:
        """A command with options drawn from its own."""
        rng = self.rng
        words = [command, *([rng.choice(list(CHECKS))] if command == "check" else [])]
        known = self.options[" ".join(words)]
        words += [self.positional()] * (rng.random() < 0.95)
        for _ in range(rng.choice((0, 1, 1, 2, 2, 3, 4, 6))):
            words += self.option(known)
        return words

    def option(self, known: dict[str, str | None]) -> list[str]:
        """An option of those that there are, with a value where it takes one."""
        name = self.rng.choice(list(known))
        return [name] if known[name] is None else [name, self.value(name)]

    def value(self, option: str) -> str:
        """A value for an option: one of the pages, a list of numbers, a file, anything."""
        rng = self.rng
        seen, draw = self.values[option], rng.random()
        if seen and draw < 0.5:
            return rng.choice(seen)
        if draw < 0.75:
            return ",".join(rng.choice(NUMBERS) for _ in range(rng.choice((1, 2, 3, 3, 4, 6, 6, 7, 16))))
        if draw < 0.9:
            return rng.choice(NAMES)
        return rng.choice(WORDS)

    def positional(self) -> str:
        """A robot, a file or a word."""
        rng = self.rng
        return rng.choice((rng.choice(self.robots), rng.choice(self.robots), rng.choice(NAMES), rng.choice(WORDS)))

    def change(self, words: list[str]) -> None:
        """Change a command line in one place."""
        rng = self.rng
        draw, i = rng.random(), rng.randrange(len(words))
        name = " ".join(words[: 1 + (words[0] == "check")])
        known = self.options.get(name) or self.options[next(iter(self.options))]
        if draw < 0.25:
            words += self.option(known)
        elif draw < 0.35 and len(words) > 1:
            del words[max(i, 1)]
        elif draw < 0.45:
            words.insert(max(i, 1), rng.choice(words))
        elif draw < 0.55 and len(words) > 1:
            words[max(i, 1)] = self.positional()
        elif i > 0:
            words[i] = self.value(words[i - 1]) if draw < 0.75 else changed_text(rng, words[i])

    def change_files(self, words: list[str], files: dict[str, bytes]) -> None:
        """A content for every file that the command line names; most of them a little wrong."""
        rng = self.rng
        for word in words:
            if word in NAMES and word not in files and rng.random() < 0.97:
                files[word] = contents(rng, word)
        for name in files:
            while rng.random() < 0.45:
                files[name] = mutated(rng, files[name], NUMBERS)


def changed_text(rng: random.Random, text: str) -> str:
    """A text with one change: a number for another, a piece gone, doubled or put in."""
    pieces = text.replace("(", ",").replace(")", ",").replace("=", ",").replace(" ", ",").split(",")
    piece = rng.choice(pieces)
    if piece and rng.random() < 0.6:
        return text.replace(piece, rng.choice(NUMBERS), 1)
    i = rng.randrange(len(text) + 1)
    j = min(len(text), i + rng.choice((0, 1, 1, 2, 8)))
    return text[:i] + rng.choice(("", text[i:j] * 2, *WORDS[:24], rng.choice(NUMBERS))) + text[j:]


def harmless(words: list[str]) -> Iterator[str]:
    """The words without places outside the folder, without NUL (no command line holds one), and with few samples."""
    slow = "workspace" in words[:1]
    for word in words:
        word = word.replace("\0", "").encode("utf-8", "replace").decode()
        yield "x" if OUTSIDE.search(word) else word
    if slow and "--help" not in words:
        yield from ("--samples", "200", "--cores", "1")


def examples() -> Iterator[tuple[str, ...]]:
    """The robokins of every example of the pages."""
    for page in (ROOT / "README.md", *sorted(DOCS.rglob("*.md"))):
        for step in steps(Path(page).read_text()):
            if not runs(step.command):
                continue
            try:
                words = shlex.split(step.command)
            except ValueError:
                continue
            stage: list[str] = []
            for word in [*words, "|"]:
                if word in ("|", "&&", ";", ">", "<"):
                    if stage[:1] == ["robokin"] and stage[1:2] and stage[1] in COMMANDS:
                        yield tuple(stage[1:])
                    stage = []
                else:
                    stage.append(word)


def commands() -> Iterator[tuple[str, Any]]:
    """Every command with its name, the checks one by one."""
    group: Any = typer.main.get_command(app)
    context = group.make_context("robokin", ["list"], resilient_parsing=True)
    for name in COMMANDS:
        command = group.get_command(context, name)
        if name == "check":
            yield from ((f"check {kind}", command.get_command(context, kind)) for kind in CHECKS)
        else:
            yield name, command


def options(command: Any) -> dict[str, str | None]:
    """The options of a command: what each takes, None where it takes nothing."""
    context = command.make_context(command.name, [], resilient_parsing=True)
    return {
        name: None if getattr(param, "is_flag", False) else str(param.metavar)
        for param in command.get_params(context)
        for name in param.opts
        if name.startswith("-")
    }
