"""What all checks share: their options, and the way from marks to output and status."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated

import typer

from robokin.cli import DONE, NO
from robokin.cli.options import choose, output_format
from robokin.errors import InputError, shown

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
    typer.Option("--points", metavar="P", help="With --gradescope: what all is worth.  [default: 1 an item]"),
]
VisibilityOption = Annotated[
    str | None,
    typer.Option(
        "--visibility", metavar="WHO", help="With --gradescope: visible, hidden, after_due_date or after_published."
    ),
]


@dataclass(frozen=True)
class Delivery:
    """Where marks go and how: `kind` is the format."""

    kind: str
    output: str | None
    gradescope: str | None
    points: float | None
    visibility: str | None

    def deliver(self, report: Report) -> int:
        """Write the marks; the status."""
        from robokin.cli.check_output import gradescope, written
        from robokin.cli.output.sink import sink

        students = {item.student for item in report.items}
        if self.gradescope is not None and len(students) > 1:
            raise InputError(
                f"--gradescope: found the answers of {len(students)} students, expected those of one: "
                "an autograder marks one submission at a time"
            )
        data = written(report, self.kind)
        if self.gradescope is not None:
            results = gradescope(report, self.points, self.visibility)
            with sink(self.gradescope, "--gradescope") as stream:
                stream.write(results)
        with sink(self.output) as stream:
            stream.write(data)
        return DONE if report.passed == len(report.items) else NO


def delivery(
    output: str | None, format: str | None, json: bool, gradescope: str | None, points: str | None,
    visibility: str | None,
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
    return Delivery(kind, output, gradescope, worth, choose(visibility, VISIBILITIES, "--visibility"))


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
