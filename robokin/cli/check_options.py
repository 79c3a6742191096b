"""What all checks share: their options, declared once, and the one way from answers to output and status."""

from __future__ import annotations

import functools
import inspect
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any, TypeVar, get_type_hints

import typer

from robokin.cli.options import (
    AngleOption,
    FormatOption,
    JsonOption,
    LengthOption,
    OutputOption,
    SetOption,
    choose,
    effective_units,
    output_format,
    parameter_overrides,
)
from robokin.cli.statuses import DONE, NO
from robokin.errors import InputError, shown
from robokin.grading.feedback import ANSWER, LEVELS, PART
from robokin.grading.guarded import BUDGET

if TYPE_CHECKING:
    from robokin.grading.mark_items import Item, Report
    from robokin.grading.marking import Rules, Subject
    from robokin.grading.tolerance import Tolerance
    from robokin.units import Units

VISIBILITIES = ("visible", "hidden", "after_due_date", "after_published")
"""Who sees a test of an autograder, and when: the words of Gradescope's format."""

LEAST_BUDGET, GREATEST_BUDGET = 0.01, 86400.0
"""Seconds: a clock's ticks and a day."""


def _text(name: str, metavar: str, help: str, *others: str) -> Any:
    return Annotated[str | None, typer.Option(name, *others, metavar=metavar, help=help)]


def length_tolerance(help: str) -> Any:
    """The option --tol of a check."""
    return _text("--tol", "L", help, "--atol")


def angle_tolerance(help: str) -> Any:
    """The option --tol-angle of a check."""
    return _text("--tol-angle", "A", help)


OPTIONS: dict[str, Any] = {
    "input": _text("--input", "FILE", "A CSV of answers with a header; - for standard input.", "-i"),
    "key": _text("--key", "FILE", "With --input: a CSV of the questions, by the same ids."),
    "follow": Annotated[bool, typer.Option("--follow", help="Read what symbolic links point to.")],
    "tol": length_tolerance("How far a position may be off.  [default: 0.001 of the arm]"),
    "tol_angle": angle_tolerance("How far an orientation may be off.  [default: 0.1 deg]"),
    "rtol": _text("--rtol", "R", "Added to --tol: this part of the right value.  [default: 0]"),
    "budget": _text("--budget", "SECONDS", "Processor time for each answer.  [default: 10]"),
    "partial": _text(
        "--partial", "SCORE", "The least score of an answer with a known mistake, such as another unit."
    ),
    "feedback": _text(
        "--feedback", "LEVEL", "What is told: verdict, part (what is wrong), distance (how far), answer.  "
        "[default: answer; what Gradescope's students read: part]",
    ),
    "gradescope": _text("--gradescope", "FILE", "Also write the results.json that Gradescope reads."),
    "points": _text("--points", "P", "With --gradescope: total points.  [default: 1 an item]"),
    "visibility": _text(
        "--visibility", "WHO", "With --gradescope: visible, hidden, after_due_date or after_published."
    ),
    "output": OutputOption, "format": FormatOption, "json": JsonOption,
    "angle": AngleOption, "length": LengthOption, "set_": SetOption,
}  # fmt: skip
"""The options by the names of their parameters."""

FILES = ("input", "key", "follow")
TOLERANCES = ("tol", "tol_angle", "rtol")
DELIVERY = ("feedback", "gradescope", "points", "visibility", "output", "format", "json")
MARKS = ("budget", "partial", *DELIVERY, "angle", "length", "set_")

Kind = TypeVar("Kind", bound="Subject")


def marking(*names: str, **own: Any) -> Callable[[Callable[..., int]], Callable[..., int]]:
    """A command with the options of some names behind its own; it is handed what they say as its argument `way`.

    own: declarations that differ from those of `OPTIONS`.
    """

    def with_options(function: Callable[..., int]) -> Callable[..., int]:
        hints = get_type_hints(function, include_extras=True)
        parameters = [
            parameter.replace(annotation=hints[name])
            for name, parameter in inspect.signature(function).parameters.items()
            if name != "way"
        ]
        for name in names:
            default = False if name in ("follow", "json") else None
            kind, annotation = inspect.Parameter.POSITIONAL_OR_KEYWORD, own.get(name, OPTIONS[name])
            parameters.append(inspect.Parameter(name, kind, default=default, annotation=annotation))

        @functools.wraps(function)
        def command(**typed: Any) -> int:
            shared = {name: typed.pop(name) for name in names}
            return function(**typed, way=Marking(shared))

        command.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
        command.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
        return command

    return with_options


class Marking:
    """What the options that checks share say: how answers are marked, and where the marks go.

    Raises InputError before any work is done.
    """

    def __init__(self, typed: Mapping[str, Any]) -> None:
        """`typed` is what was typed, by the names of `OPTIONS`."""
        from robokin.tables.sink import format_of

        self.typed = typed
        self.input: str | None = typed.get("input")
        self.key: str | None = typed.get("key")
        self.follow = bool(typed.get("follow"))
        self.gradescope: str | None = typed["gradescope"]
        self.kind = format_of(typed["output"], output_format(typed["format"], typed["json"]))
        for name in ("points", "visibility") if self.gradescope is None else ():
            if typed[name] is not None:
                raise InputError(f"--{name} is about the results of an autograder, expected --gradescope FILE with it")
        self.points = None if typed["points"] is None else plain_number(typed["points"], "--points")
        self.feedback = choose(typed["feedback"], LEVELS, "--feedback")
        self.visibility = choose(typed["visibility"], VISIBILITIES, "--visibility")
        self.budget = _budget(typed.get("budget"))
        self.partial = _partial(typed.get("partial"))

    @property
    def rules(self) -> Rules:
        """What holds for all marks."""
        from robokin.grading.marking import Rules

        return Rules(self.budget, self.partial)

    @property
    def overrides(self) -> dict[str, str]:
        """The parameters of --set."""
        return parameter_overrides(self.typed["set_"])

    def one_source(self, options: dict[str, object]) -> None:
        """Raise InputError where answers come from options and from a file."""
        given = [name for name, value in options.items() if value]
        if self.input is not None and given:
            raise InputError(f"--input and {given[0]} exclude each other, expected one of them")
        if self.input is None and self.key is not None:
            raise InputError("--key goes with --input, the file of the answers")
        if self.input == "-" == self.key:
            raise InputError("--input and --key are both standard input, expected a file for one of them")

    def subject(self, kind: type[Kind], robot: str, *, table: bool = False, **more: Any) -> Kind:
        """What answers about a robot are marked against; `table` tells whether its table is asked for."""
        from robokin.cli.arguments import load_robot
        from robokin.grading.tolerance import default_tolerance

        model = load_robot(robot, self.overrides)
        if not (model.n or table):
            raise InputError(f"{model.name} has no joints, expected a robot that can move")
        units = effective_units(model.units, self.typed["length"], self.typed["angle"])
        return kind(model, units, self.tolerance(default_tolerance(model, table=table), units), **more)

    def tolerance(self, default: Tolerance, units: Units) -> Tolerance:
        """The tolerance that the options state, the default's values where they do not. Raises InputError."""
        from robokin.cli.arguments import parse_numbers

        stated = {}
        for name, option, angle, factor in (
            ("position", "--tol", False, units.metres),
            ("angle", "--tol-angle", True, units.radians),
        ):
            text = self.typed["tol_angle" if angle else "tol"]
            if text is not None:
                (value,) = parse_numbers(text, option, [angle], units, "an angle" if angle else "a length")
                if value < 0.0:
                    raise InputError(f"{option}: found {shown(text)}, expected 0 or more")
                stated[name] = float(value * factor)
        relative = self.typed.get("rtol")
        return replace(default, **stated, relative=0.0 if relative is None else plain_number(relative, "--rtol"))

    def finish(self, check: str, robot: str, subject: Subject, items: Iterable[Item]) -> int:
        """Mark the answers and write the marks; `robot` is what the robot was called. The status."""
        return self.deliver(subject.report(check, subject.robot.id or robot, tuple(items)))

    def deliver(self, report: Report) -> int:
        """Write the marks; the status."""
        from robokin.reports.mark_report import results, written
        from robokin.tables.sink import sink

        names = {item.student for item in report.items}
        if self.gradescope is not None and len(names) > 1:
            raise InputError(
                f"--gradescope: found the answers of {len(names)} students, expected those of one: "
                "an autograder marks one submission at a time"
            )
        # A page beside results for students may end up before their eyes as well; data are for the teacher's scripts.
        students = self.gradescope is not None and self.kind == "table"
        data = written(report, self.kind, self.feedback or (PART if students else ANSWER))
        if self.gradescope is not None:
            document = results(report, self.points, self.visibility, self.feedback or PART)
            with sink(self.gradescope, "--gradescope") as stream:
                stream.write(document)
        with sink(self.typed["output"]) as stream:
            stream.write(data)
        return DONE if report.right else NO


def _budget(text: str | None) -> float:
    """The seconds of --budget. Raises InputError."""
    seconds = BUDGET if text is None else plain_number(text, "--budget")
    if not LEAST_BUDGET <= seconds <= GREATEST_BUDGET:
        raise InputError(
            f"--budget: found {shown(text or '')}, expected seconds for each answer, "
            f"{LEAST_BUDGET:g} to {GREATEST_BUDGET:g}"
        )
    return seconds


def _partial(text: str | None) -> float | None:
    """The score of --partial. Raises InputError."""
    score = None if text is None else plain_number(text, "--partial")
    if text is not None and score is not None and score > 1.0:
        raise InputError(f"--partial: found {shown(text)}, expected a score from 0 to 1")
    return score


def plain_number(text: str, option: str) -> float:
    """A finite number of 0 or more. Raises InputError."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not (math.isfinite(value) and value >= 0.0):
        raise InputError(f"{option}: found '{shown(text)}', expected a number of 0 or more")
    return value
