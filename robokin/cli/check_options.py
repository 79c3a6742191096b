"""What all checks share: their options, declared once, and the one way from answers to output and status."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

import typer

from robokin.cli.cluster_options import ClusterOption
from robokin.cli.cores import CoresOption, whole_cores
from robokin.cli.option_groups import DescriptionOptions, OptionGroup, OutputOptions
from robokin.cli.options import SetOption, choose, option
from robokin.cli.statuses import DONE, NO
from robokin.errors import InputError, shown
from robokin.grading.feedback import ANSWER, LEVELS, PART
from robokin.jobs.guarded import BUDGET

if TYPE_CHECKING:
    from robokin.grading.mark_items import Item, Report
    from robokin.grading.marking import Rules, Subject
    from robokin.grading.tolerance import Tolerance
    from robokin.units import Units

VISIBILITIES = ("visible", "hidden", "after_due_date", "after_published")
"""Who sees a test of an autograder, and when: the words of Gradescope's format."""

LEAST_BUDGET, GREATEST_BUDGET = 0.01, 86400.0
"""Seconds: a clock's ticks and a day."""

FollowOption = Annotated[bool, typer.Option("--follow", help="Read what symbolic links point to.")]

Kind = TypeVar("Kind", bound="Subject")


class AnswerFileOptions(OptionGroup):
    """A file of answers, in place of those that options say."""

    input: Annotated[
        str | None, option("--input -i", "FILE", "A CSV of answers with a header, or a .parquet; - for standard input.")
    ] = None
    key: Annotated[str | None, option("--key", "FILE", "With --input: a CSV of the questions, by the same ids.")] = None
    follow: FollowOption = False
    cluster: ClusterOption = None

    def refuse_beside(self, options: dict[str, object]) -> None:
        """Raise InputError where answers come from options and from a file."""
        given = [name for name, value in options.items() if value]
        if self.input is not None and given:
            raise InputError(f"--input and {given[0]} exclude each other, expected one of them")
        if self.input is None and self.cluster is not None:
            raise InputError("--cluster goes with --input, a file of many answers")
        if self.input is None and self.key is not None:
            raise InputError("--key goes with --input, the file of the answers")
        if self.input == "-" == self.key:
            raise InputError("--input and --key are both standard input, expected a file for one of them")


class TableToleranceOptions(OptionGroup):
    """How far the cells of a table may be off."""

    tol: Annotated[
        str | None, option("--tol --atol", "L", "How far a length may be off.  [default: 0.0001 of the arm]")
    ] = None
    tol_angle: Annotated[
        str | None, option("--tol-angle", "A", "How far an angle may be off.  [default: 0.01 deg]")
    ] = None

    def over(self, default: Tolerance, units: Units) -> Tolerance:
        """A tolerance with what was stated in its place. Raises InputError."""
        from robokin.formats.vector_expressions import parse_numbers

        stated = {}
        for name, option_name, text, factor in (
            ("position", "--tol", self.tol, units.metres), ("angle", "--tol-angle", self.tol_angle, units.radians)
        ):  # fmt: skip
            if text is not None:
                angle = name == "angle"
                (value,) = parse_numbers(text, option_name, [angle], units, "an angle" if angle else "a length")
                if value < 0.0:
                    raise InputError(f"{option_name}: found {shown(text)}, expected 0 or more")
                stated[name] = float(value * factor)
        return replace(default, **stated, relative=plain_number(getattr(self, "rtol", None), "--rtol") or 0.0)


class ToleranceOptions(TableToleranceOptions):
    """How far poses and joint values may be off."""

    tol: Annotated[
        str | None, option("--tol --atol", "L", "How far a position may be off.  [default: 0.001 of the arm]")
    ] = None
    tol_angle: Annotated[
        str | None, option("--tol-angle", "A", "How far an orientation may be off.  [default: 0.1 deg]")
    ] = None
    rtol: Annotated[
        str | None, option("--rtol", "R", "Added to --tol: this part of the right value.  [default: 0]")
    ] = None


class JacobianToleranceOptions(ToleranceOptions):
    """How far the entries of a Jacobian may be off."""

    tol: Annotated[
        str | None, option("--tol --atol", "L", "How far a length may be off.  [default: 0.001 of the arm]")
    ] = None
    tol_angle: Annotated[
        str | None, option("--tol-angle", "A", "How far a direction may be off.  [default: 0.1 deg]")
    ] = None


class FeedbackOptions(OptionGroup):
    """Who is told how much."""

    feedback: Annotated[
        str | None,
        option(
            "--feedback",
            "LEVEL",
            "What is told: verdict, part (what is wrong), distance (how far), answer.  [default: answer; what "
            "Gradescope's students read: part]",
        ),
    ] = None
    gradescope: Annotated[
        str | None, option("--gradescope", "FILE", "Also write the results.json that Gradescope reads.")
    ] = None
    points: Annotated[str | None, option("--points", "P", "With --gradescope: total points.  [default: 1 an item]")] = (
        None
    )
    visibility: Annotated[
        str | None,
        option("--visibility", "WHO", "With --gradescope: visible, hidden, after_due_date or after_published."),
    ] = None


class RuleOptions(OptionGroup):
    """What holds for all marks."""

    budget: Annotated[str | None, option("--budget", "SECONDS", "Processor time for each answer.  [default: 10]")] = (
        None
    )
    partial: Annotated[
        str | None,
        option("--partial", "SCORE", "The least score of an answer with a known mistake, such as another unit."),
    ] = None
    cores: CoresOption = None


# Options stand in the help in the order of the groups from the last to the first, then a class's own.


class DeliveryOptions(OutputOptions, FeedbackOptions):
    """Where marks go. Raises InputError for what is wrong with it before any work is done."""

    def __init__(self, **typed: Any) -> None:
        super().__init__(**typed)
        self.written_as = self.kind
        for name in ("points", "visibility") if self.gradescope is None else ():
            if typed[name] is not None:
                raise InputError(f"--{name} is about the results of an autograder, expected --gradescope FILE with it")
        self.worth = plain_number(self.points, "--points")
        choose(self.feedback, LEVELS, "--feedback")
        choose(self.visibility, VISIBILITIES, "--visibility")

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
        students = self.gradescope is not None and self.written_as == "table"
        data = written(report, self.written_as, self.feedback or (PART if students else ANSWER))
        if self.gradescope is not None:
            document = results(report, self.worth, self.visibility, self.feedback or PART)
            with sink(self.gradescope, "--gradescope") as stream:
                stream.write(document)
        with sink(self.file) as stream:
            stream.write(data)
        return DONE if report.right else NO


class CountMarkOptions(DeliveryOptions):
    """What marks of counts need."""

    set_: SetOption = None


class MarkRuleOptions(RuleOptions):
    """What holds for all marks. Raises InputError for what is wrong with it before any work is done."""

    def __init__(self, **typed: Any) -> None:
        super().__init__(**typed)
        self.most_cores = whole_cores(self.cores)
        self.seconds, self.least = plain_number(self.budget, "--budget"), plain_number(self.partial, "--partial")
        if self.seconds is not None and not LEAST_BUDGET <= self.seconds <= GREATEST_BUDGET:
            expected = f"expected seconds for each answer, {LEAST_BUDGET:g} to {GREATEST_BUDGET:g}"
            raise InputError(f"--budget: found {shown(self.budget or '')}, {expected}")
        if self.least is not None and self.least > 1.0:
            raise InputError(f"--partial: found {shown(self.partial or '')}, expected a score from 0 to 1")

    @property
    def rules(self) -> Rules:
        """What holds for all marks."""
        from robokin.grading.marking import Rules

        return Rules(BUDGET if self.seconds is None else self.seconds, self.least, self.most_cores)


class MarkOptions(DescriptionOptions, DeliveryOptions, MarkRuleOptions):
    """How answers about a robot are marked, and where the marks go."""

    def subject(
        self, kind: type[Kind], name: str, allowed: TableToleranceOptions, *, table: bool = False, **more: Any
    ) -> Kind:
        """What answers about a robot are marked against; `table` tells whether its table is asked for."""
        from robokin.cli.arguments import load_robot
        from robokin.cli.options import parameter_overrides
        from robokin.grading.tolerance import default_tolerance

        robot = load_robot(name, parameter_overrides(self.set_), self.part())
        if not (robot.n or table):
            raise InputError(f"{robot.name} has no joints, expected a robot that can move")
        units = self.over(robot.units)
        return kind(robot, units, allowed.over(default_tolerance(robot, table=table), units), **more)

    def finish(self, check: str, name: str, subject: Subject, items: Iterable[Item]) -> int:
        """Mark the answers and write the marks; `name` is what the robot was called. The status."""
        return self.deliver(subject.report(check, subject.robot.id or name, tuple(items)))


def plain_number(text: str | None, name: str) -> float | None:
    """A finite number of 0 or more, None for none. Raises InputError."""
    if text is None:
        return None
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not (math.isfinite(value) and value >= 0.0):
        raise InputError(f"{name}: found '{shown(text)}', expected a number of 0 or more")
    return value
