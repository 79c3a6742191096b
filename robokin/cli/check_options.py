"""What all checks share: their options, and the way from marks to output and status."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Annotated

import typer

from robokin.cli.options import choose, output_format
from robokin.cli.statuses import DONE, NO
from robokin.errors import InputError, shown
from robokin.grading.feedback import ANSWER, LEVELS, PART
from robokin.grading.guarded import BUDGET

if TYPE_CHECKING:
    from robokin.cli.checks import Report
    from robokin.grading.tolerance import Tolerance
    from robokin.units import Units

TolOption = Annotated[
    str | None,
    typer.Option("--tol", "--atol", metavar="L", help="How far a position may be off.  [default: 0.001 of the arm]"),
]
TolAngleOption = Annotated[
    str | None, typer.Option("--tol-angle", metavar="A", help="How far an orientation may be off.  [default: 0.1 deg]")
]
RtolOption = Annotated[
    str | None,
    typer.Option("--rtol", metavar="R", help="Added to --tol: this part of the right value.  [default: 0]"),
]
InputAnswersOption = Annotated[
    str | None,
    typer.Option("--input", "-i", metavar="FILE", help="A CSV of answers with a header; - for standard input."),
]
KeyOption = Annotated[
    str | None,
    typer.Option("--key", metavar="FILE", help="With --input: a CSV of the questions, by the same ids."),
]
GradescopeOption = Annotated[
    str | None,
    typer.Option("--gradescope", metavar="FILE", help="Also write the results.json that Gradescope reads."),
]
PointsOption = Annotated[
    str | None,
    typer.Option("--points", metavar="P", help="With --gradescope: total points.  [default: 1 an item]"),
]
VisibilityOption = Annotated[
    str | None,
    typer.Option(
        "--visibility", metavar="WHO", help="With --gradescope: visible, hidden, after_due_date or after_published."
    ),
]
BudgetOption = Annotated[
    str | None,
    typer.Option("--budget", metavar="SECONDS", help="Processor time for each answer.  [default: 10]"),
]
FeedbackOption = Annotated[
    str | None,
    typer.Option(
        "--feedback",
        metavar="LEVEL",
        help="What is told: verdict, part (what is wrong), distance (how far), answer.  [default: answer; what "
        "Gradescope's students read: part]",
    ),
]
PartialOption = Annotated[
    str | None,
    typer.Option(
        "--partial", metavar="SCORE", help="The least score of an answer with a known mistake, such as another unit."
    ),
]
FollowOption = Annotated[bool, typer.Option("--follow", help="Read what symbolic links point to.")]


@dataclass(frozen=True)
class Rules:
    """What holds for all marks: seconds for each answer, and the least score of an answer with a known mistake."""

    budget: float = BUDGET
    partial: float | None = None


@dataclass(frozen=True)
class Delivery:
    """Where marks go and how: `kind` is the format, `feedback` what they tell, if that is said."""

    kind: str
    output: str | None
    gradescope: str | None
    points: float | None
    visibility: str | None
    feedback: str | None = None
    rules: Rules = field(default_factory=Rules)

    def deliver(self, report: Report) -> int:
        """Write the marks; the status."""
        from robokin.cli.check_output import gradescope, written
        from robokin.cli.output.sink import sink

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
            results = gradescope(report, self.points, self.visibility, self.feedback or PART)
            with sink(self.gradescope, "--gradescope") as stream:
                stream.write(results)
        with sink(self.output) as stream:
            stream.write(data)
        return DONE if report.right else NO


def delivery(
    output: str | None, format: str | None, json: bool, gradescope: str | None, points: str | None,
    visibility: str | None, feedback: str | None = None, budget: str | None = None, partial: str | None = None,
) -> Delivery:  # fmt: skip
    """Where the options send the marks. Raises InputError before any work is done."""
    from robokin.cli.check_output import VISIBILITIES
    from robokin.cli.output.sink import format_of

    kind = format_of(output, output_format(format, json))
    if gradescope is None:
        for option, value in (("--points", points), ("--visibility", visibility)):
            if value is not None:
                raise InputError(f"{option} is about the results of an autograder, expected --gradescope FILE with it")
    worth = None if points is None else plain_number(points, "--points")
    told = choose(feedback, LEVELS, "--feedback")
    who = choose(visibility, VISIBILITIES, "--visibility")
    return Delivery(kind, output, gradescope, worth, who, told, Rules(_budget(budget), _partial(partial)))


def _budget(text: str | None) -> float:
    """The seconds of --budget. Raises InputError."""
    if text is None:
        return BUDGET
    seconds = plain_number(text, "--budget")
    if not LEAST_BUDGET <= seconds <= GREATEST_BUDGET:
        raise InputError(
            f"--budget: found {shown(text)}, expected seconds for each answer, {LEAST_BUDGET:g} to {GREATEST_BUDGET:g}"
        )
    return seconds


def _partial(text: str | None) -> float | None:
    """The score of --partial. Raises InputError."""
    if text is None:
        return None
    score = plain_number(text, "--partial")
    if score > 1.0:
        raise InputError(f"--partial: found {shown(text)}, expected a score from 0 to 1")
    return score


LEAST_BUDGET, GREATEST_BUDGET = 0.01, 86400.0
"""Seconds: a clock's ticks and a day."""


def plain_number(text: str, option: str) -> float:
    """A finite number of 0 or more. Raises InputError."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not (math.isfinite(value) and value >= 0.0):
        raise InputError(f"{option}: found '{shown(text)}', expected a number of 0 or more")
    return value


def stated_tolerance(
    default: Tolerance, tol: str | None, tol_angle: str | None, rtol: str | None, units: Units
) -> Tolerance:
    """The tolerance that the options state, the default's values where they do not. Raises InputError."""
    from robokin.cli.arguments import parse_numbers

    values = []
    for text, option, angle, factor, own in (
        (tol, "--tol", False, units.metres, default.position),
        (tol_angle, "--tol-angle", True, units.radians, default.angle),
    ):
        if text is None:
            values.append(own)
            continue
        (value,) = parse_numbers(text, option, [angle], units, "an angle" if angle else "a length")
        if value < 0.0:
            raise InputError(f"{option}: found {shown(text)}, expected 0 or more")
        values.append(float(value * factor))
    relative = 0.0 if rtol is None else plain_number(rtol, "--rtol")
    return replace(default, position=values[0], angle=values[1], relative=relative)


def one_source(options: dict[str, object], input: str | None, key: str | None) -> None:
    """Raise InputError where answers come from options and from a file."""
    given = [name for name, value in options.items() if value]
    if input is not None and given:
        raise InputError(f"--input and {given[0]} exclude each other, expected one of them")
    if input is None and key is not None:
        raise InputError("--key goes with --input, the file of the answers")
    if input == "-" == key:
        raise InputError("--input and --key are both standard input, expected a file for one of them")
