"""Answers of `robokin ik` for eyes."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, cast

import numpy as np

from robokin.inverse.analysis import Analysis, Task, analysis_of
from robokin.inverse.full_turns import MOST_TURNS, unlimited
from robokin.inverse.hold import HeldArm, held_arm
from robokin.inverse.solutions import Result, Solution
from robokin.model import CoupledRobot, Robot
from robokin.model.joint_units import joint_factors
from robokin.number_text import show
from robokin.records.self_motion_records import is_within
from robokin.records.solution_records import SolutionRecords
from robokin.reports.page_parts import WIDTH
from robokin.reports.page_tables import heading, narrow_table, render
from robokin.reports.self_motion_words import DECIMALS, FamilyWords, held_in_words, joint_names, joints_can_move
from robokin.reports.solution_verdicts import BLANK, verdict
from robokin.units import Units


@dataclass(frozen=True)
class AnswerTable:
    """Draws the answers for a robot and a task.

    `limits` tells whether the joint limits count, `turns` that full turns are listed; `most` is the number that a list
    is cut to, if it is.
    """

    records: SolutionRecords
    limits: bool = True
    turns: bool = False
    most: int | None = None

    @property
    def robot(self) -> Robot:
        """The robot that was asked about."""
        return self.records.robot

    @property
    def units(self) -> Units:
        """What all values are in."""
        return self.records.units

    @property
    def task(self) -> str:
        """What was asked of the tool."""
        return self.records.task

    @property
    def held(self) -> Mapping[int, float]:
        """The joints, from 0, that are held, with their values in the units."""
        return self.records.held

    def head(self) -> bytes:
        """The line above all answers."""
        return render(heading(self.robot.name, f"lengths in {self.units.length}, angles in {self.units.angle}"))

    def solutions(self, result: Result) -> tuple[Solution, ...]:
        """What is shown: the solutions, or the nearest configuration."""
        return result.solutions or ((result.nearest,) if result.nearest else ())

    def paragraph(self, label: str, result: Result) -> bytes:
        """One answer; `label` says which."""
        shown = self.solutions(result)
        joints = [self.records.joints(solution.q) for solution in shown]
        parts: list[Any] = [label + verdict(result, self.idle, held_in_words(self.held), self.turns)]
        which = [(i + 1, bool(turns)) for i, turns in enumerate(self.robot.revolute)]
        for drawn in drawn_solutions(shown, joints, bool(result.solutions), which, self.units):
            parts += ["", drawn]
        notes = list(self.notes(result, shown))
        if notes:
            parts += ["", *notes]
        return render(*map(filled, parts), *([""] if label else []))

    def notes(self, result: Result, shown: Sequence[Solution]) -> Iterator[str]:
        """What is to be said of the rows."""
        nearest = result.nearest
        if not result.solutions and nearest is not None:
            off = f"position error {show(nearest.position_error / self.units.metres)} {self.units.length}"
            if self.task != "position":
                off += f", angle error {show(nearest.angle_error / self.units.radians)} {self.units.angle}"
            yield f"~ the nearest configuration ({off})"
        elif any(s.position_error > 1e-6 or s.angle_error > 1e-6 for s in result.solutions):
            position = max(s.position_error for s in result.solutions) / self.units.metres
            angle = max(s.angle_error for s in result.solutions) / self.units.radians
            yield (
                f"not exact, within the tolerances: position error {show(position)} {self.units.length}, "
                f"angle error {show(angle)} {self.units.angle}"
            )
        if any(not solution.within_limits for solution in shown):
            yield "! outside the joint limits"
        yield from self.motions(result, [solution.free for solution in shown])
        yield from self.full_turns(result)

    def full_turns(self, result: Result) -> Iterator[str]:
        """How many solutions there are with full turns, or which joints those leave out."""
        listed = len(result.solutions)
        if self.turns and listed and (endless := [i + 1 for i in unlimited(self.robot) if i not in self.held]):
            verb = "has no limits and is" if len(endless) == 1 else "have no limits and are"
            yield f"full turns: {joint_names(endless)} {verb} not turned"
        elif not self.turns and listed != self.most and (count := result.counts.get("turns", listed)) > listed:
            many = str(count) if count <= listed * MOST_TURNS else f"more than {listed * MOST_TURNS}"
            yield f"with full turns of joints within the limits {many} solutions: --turns lists them"

    @property
    def idle(self) -> list[int]:
        """The joints, from 1, that only move what the task leaves open."""
        if isinstance(self.robot, CoupledRobot):
            moved = self.robot.drive.S != 0.0
            still = [i for i in range(len(moved)) if i not in self.analysis.idle]
            return [i + 1 for i in range(self.robot.n) if not moved[still, i].any()]
        idle = tuple(i + 1 for i in self.analysis.idle)
        return list(self.arm.numbers(idle) if self.held else idle)

    @cached_property
    def arm(self) -> HeldArm:
        """The arm that is solved for: all of the robot but for the held joints."""
        factors = joint_factors(self.robot, self.units)
        return held_arm(self.robot, {joint: value * float(factors[joint]) for joint, value in self.held.items()})

    @cached_property
    def analysis(self) -> Analysis:
        """How the arm is solved for the task."""
        arm = self.arm.part if self.held else self.robot
        return analysis_of(arm.free_motion if isinstance(arm, CoupledRobot) else arm, cast("Task", self.task))

    def motions(self, result: Result, free: Sequence[tuple[int, ...]]) -> Iterator[str]:
        """The self-motions in words, given the joints of each solution that are free to move."""
        written = FamilyWords(self.robot, self.units, self.limits)
        yield from motions_in_words(result, free, self.idle, written, self.task, bool(self.analysis.redundancy))


def motions_in_words(
    result: Result,
    free: Sequence[tuple[int, ...]],
    idle: Sequence[int],
    written: FamilyWords,
    task: str,
    redundant: bool,
) -> Iterator[str]:
    """The self-motions of an answer in words.

    free: the joints of each solution that are free to move; idle: those that only move what the task leaves open;
    redundant: whether the arm has more joints than the task needs.
    """
    together = [tuple(i for i in joints if i not in idle) for joints in free]
    if any(len(joints) > len(rest) for joints, rest in zip(free, together, strict=True)):
        yield f"free: {joint_names(idle)} may have any value; each posture is listed once"
    for family in filter(is_within, result.families if result.solutions else ()):
        yield from written.lines(family, result, task)
    told = [set(family.joints) for family in result.families]
    untold = {joints for joints in together if joints and not any(known.issuperset(joints) for known in told)}
    if redundant and untold:
        union = sorted({i for joints in untold for i in joints})
        yield f"self-motion: {joints_can_move(union, task)}; well spread postures are listed"
        return
    for joints in sorted(untold):
        yield f"self-motion: {joints_can_move(joints, task)}; one such posture is listed"


def drawn_solutions(
    shown: Sequence[Solution],
    joints: Sequence[Sequence[float]],
    solved: bool,
    which: Sequence[tuple[int, bool]],
    units: Units,
) -> Iterator[Any]:
    """Configurations, a row each; side by side in several tables where a page is too narrow for one.

    joints: their values in the units; solved: whether they are solutions; which: the numbers, from 1, of the joints
    that are shown, and whether each turns.
    """
    labels = [
        ("" if solution.within_limits else "!") + (str(k) if solved else "~") for k, solution in enumerate(shown, 1)
    ]
    columns = []
    for i, turns in which:
        decimals = DECIMALS[units.angle if turns else units.length]
        # Rounded first, so that nothing is shown as -0.
        cells = [f"{value:.{decimals}f}" for value in np.round([q[i - 1] for q in joints], decimals) + 0.0]
        columns.append((f"q{i}", "right", cells))
    # "shoulder right, elbow up" is a column for the shoulder and one for the elbow.
    words = [_words(solution.branch) for solution in shown]
    for kind in dict.fromkeys(kind for named in words for kind in named):
        columns.append((kind, "left", [named.get(kind, "") for named in words]))
    first = max(map(len, ["#", *labels]))
    for group in _pages(columns, WIDTH - first):
        table = narrow_table()
        table.add_column("#", justify="right", style="cyan", no_wrap=True)
        for name, side, _ in group:
            table.add_column(name, justify=side, no_wrap=True)
        for label, *cells in zip(labels, *(cells for _, _, cells in group), strict=True):
            table.add_row(label, *cells)
        yield table


def _pages(columns: Sequence[tuple[str, Any, list[str]]], room: int) -> Iterator[list[tuple[str, Any, list[str]]]]:
    """The columns in groups that are no wider than the room."""
    group: list[tuple[str, Any, list[str]]] = []
    used = 0
    for column in columns:
        width = 1 + max(map(len, [column[0], *column[2]]))
        if group and used + width > room:
            yield group
            group, used = [], 0
        group.append(column)
        used += width
    yield group


def filled(part: Any) -> Any:
    """A text in lines of a page; further lines of an indented one are indented more."""
    if not isinstance(part, str):
        return part
    margin = len(part) - len(part.lstrip())
    indent = " " * (margin + 2) if margin else ""
    return textwrap.fill(part, WIDTH, break_long_words=False, subsequent_indent=indent).replace(BLANK, " ")


def _words(branch: str) -> dict[str, str]:
    """`shoulder right, elbow up` as {"shoulder": "right", "elbow": "up"}."""
    pairs = (part.partition(" ") for part in branch.split(", "))
    return {name: word for name, _, word in pairs if word}
