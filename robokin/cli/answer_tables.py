"""Answers of `robokin ik` for eyes."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, cast

import numpy as np

from robokin.cli.output.numbers import counted, show
from robokin.cli.output.tables import WIDTH, heading, narrow_table, render
from robokin.inverse.analysis import Analysis, Task, analysis_of
from robokin.inverse.result import Result, Solution
from robokin.model import Robot
from robokin.units import Units

DECIMALS = {"mm": 3, "cm": 3, "in": 4, "m": 5, "deg": 3, "rad": 5}
"""Decimals of a joint value: a hundredth of a millimetre or of a thousandth of a radian."""


@dataclass(frozen=True)
class AnswerTable:
    """Draws the answers for a robot and a task."""

    robot: Robot
    units: Units
    task: str

    def head(self) -> bytes:
        """The line above all answers."""
        return render(heading(self.robot.name, f"lengths in {self.units.length}, angles in {self.units.angle}"))

    def solutions(self, result: Result) -> tuple[Solution, ...]:
        """What is shown: the solutions, or the nearest configuration."""
        return result.solutions or ((result.nearest,) if result.nearest else ())

    def paragraph(self, label: str, result: Result, joints: Sequence[Sequence[float]]) -> bytes:
        """One answer; `label` says which, `joints` are the values of its solutions in the units."""
        shown = self.solutions(result)
        parts: list[Any] = [label + self.verdict(result)]
        for drawn in self.drawn(shown, joints, bool(result.solutions)):
            parts += ["", drawn]
        notes = list(self.notes(result, shown))
        if notes:
            parts += ["", *notes]
        return render(*(_wrapped(part) for part in parts), *([""] if label else []))

    def verdict(self, result: Result) -> str:
        """How many solutions there are, or why none."""
        if not result.reachable:
            return f"no solution: {result.reason} ({result.method})"
        whole = "all there are" if result.complete else "there may be more"
        if result.families and not result.complete:
            whole = f"all there are but for the value of {_joints(self.idle)}"
        return f"{counted(len(result.solutions), 'solution')}, {whole} ({result.method})"

    def notes(self, result: Result, shown: Sequence[Solution]) -> Iterator[str]:
        """What is to be said of the rows."""
        nearest = result.nearest
        if not result.solutions and nearest is not None:
            off = f"{show(nearest.position_error / self.units.metres)} {self.units.length}"
            if self.task != "position":
                off += f" and {show(nearest.angle_error / self.units.radians)} {self.units.angle}"
            yield f"~ the nearest configuration, off by {off}"
        elif any(s.position_error > 1e-6 or s.angle_error > 1e-6 for s in result.solutions):
            position = max(s.position_error for s in result.solutions) / self.units.metres
            angle = max(s.angle_error for s in result.solutions) / self.units.radians
            yield (
                f"not exact, within the tolerances: off by {show(position)} {self.units.length} "
                f"and {show(angle)} {self.units.angle}"
            )
        if any(not solution.within_limits for solution in shown):
            yield "! outside the joint limits"
        yield from self.motions([solution.free for solution in shown])

    @property
    def idle(self) -> list[int]:
        """The joints, from 1, that only move what the task leaves open."""
        return [i + 1 for i in self.analysis.idle]

    @cached_property
    def analysis(self) -> Analysis:
        """How the robot is solved for the task."""
        return analysis_of(self.robot, cast("Task", self.task))

    def motions(self, free: Sequence[tuple[int, ...]]) -> Iterator[str]:
        """What is to be said of joints that are free to move, given those of each solution."""
        together = [tuple(i for i in joints if i not in self.idle) for joints in free]
        if any(len(joints) > len(rest) for joints, rest in zip(free, together, strict=True)):
            yield f"free: {_joints(self.idle)} may have any value; each posture is listed once"
        if self.analysis.redundancy and any(together):
            union = sorted({i for joints in together for i in joints})
            yield f"{_joints(union)} may move together and the hand do what is asked; well spread postures are listed"
            return
        for joints in sorted({joints for joints in together if joints}):
            moving = f"{_joints(joints)} may move" + (" together" if len(joints) > 1 else "")
            yield f"singular: {moving} there and the hand stand still; one such posture is listed"

    def drawn(self, shown: Sequence[Solution], joints: Sequence[Sequence[float]], solved: bool) -> Iterator[Any]:
        """The solutions, a row each; side by side in several tables where a page is too narrow for one."""
        labels = [
            ("" if solution.within_limits else "!") + (str(k) if solved else "~") for k, solution in enumerate(shown, 1)
        ]
        columns = []
        for i, revolute in enumerate(self.robot.revolute):
            decimals = DECIMALS[self.units.angle if revolute else self.units.length]
            # Rounded first, so that nothing is shown as -0.
            cells = [f"{value:.{decimals}f}" for value in np.round([q[i] for q in joints], decimals) + 0.0]
            columns.append((f"q{i + 1}", "right", cells))
        # "shoulder right, elbow up" is a column for the shoulder and one for the elbow.
        words = [_words(solution.branch) for solution in shown]
        for kind in words[0] if words else ():
            columns.append((kind, "left", [named[kind] for named in words]))
        first = max(map(len, ["#", *labels]))
        for group in _pages(columns, WIDTH - first):
            table = narrow_table()
            table.add_column("#", justify="right", style="cyan", no_wrap=True)
            for name, side, _ in group:
                table.add_column(name, justify=side, no_wrap=True)
            for label, *cells in zip(labels, *(cells for _, _, cells in group), strict=True):
                table.add_row(label, *cells)
            yield table


def _joints(numbers: Sequence[int]) -> str:
    """`q4, q6`, and more than two in a row as `q1 to q7`."""
    runs: list[list[int]] = []
    for i in numbers:
        if runs and i == runs[-1][-1] + 1:
            runs[-1].append(i)
        else:
            runs.append([i])
    names = [f"q{run[0]} to q{run[-1]}" if len(run) > 2 else ", ".join(f"q{i}" for i in run) for run in runs]
    return ", ".join(names)


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


def _wrapped(part: Any) -> Any:
    return textwrap.fill(part, WIDTH, break_long_words=False) if isinstance(part, str) else part


def _words(branch: str) -> dict[str, str]:
    """`shoulder right, elbow up` as {"shoulder": "right", "elbow": "up"}."""
    pairs = (part.partition(" ") for part in branch.split(", "))
    return {name: word for name, _, word in pairs if word}
