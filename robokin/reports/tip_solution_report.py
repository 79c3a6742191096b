"""Answers of `robokin ik --target` as bytes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from robokin.inverse.solutions import Result
from robokin.inverse.tip_targets import TipAnswer, TipGroup
from robokin.model import Tree
from robokin.number_text import show
from robokin.records.tip_solution_records import TipSolutionRecords
from robokin.reports.page_tables import heading, render
from robokin.reports.self_motion_words import FamilyWords, joint_names
from robokin.reports.solution_tables import drawn_solutions, filled, motions_in_words
from robokin.reports.solution_verdicts import verdict
from robokin.tables.written_rows import csv_header, csv_records, json_document, json_line
from robokin.units import Units

FORMATS = ("table", "json", "jsonl", "csv")


def tip_solution_columns(tree: Tree) -> list[str]:
    """The columns of a CSV, as those of the answers for one tip: `target` names the tips."""
    names = [f"q{i}" for i in range(1, tree.n + 1)]
    return ["target", "solution", *names, "branch", "within_limits", "position_error", "angle_error", "reason"]


@dataclass(frozen=True)
class TipSolutionReport:
    """The answer in units; `near` tells that joints which nothing moves stand at values that were given."""

    answer: TipAnswer
    units: Units
    near: bool = False

    @property
    def records(self) -> TipSolutionRecords:
        """What makes the document."""
        return TipSolutionRecords(self.answer, self.units)

    @property
    def tree(self) -> Tree:
        """The tree that was asked about."""
        return self.answer.question.tree

    def written(self, kind: str) -> Iterator[bytes]:
        """The answer in one of FORMATS."""
        if kind == "csv":
            yield csv_header(tip_solution_columns(self.tree)) + csv_records(None, self.rows())
        elif kind == "table":
            yield self.page()
        else:
            yield (json_document if kind == "json" else json_line)(self.records.document())

    def rows(self) -> list[list[Any]]:
        """A row for each solution of each group; a group without one has a row with solution 0."""
        rows: list[list[Any]] = []
        for group in self.answer.groups:
            tips = " ".join(group.tips)
            for k, solution in enumerate(group.result.solutions):
                position, angle = group.errors[k].max(axis=0).tolist()
                q = self.records.joints(solution.q)
                branch = solution.branch.replace(", ", " / ")
                errors = [position / self.units.metres, angle / self.units.radians]
                rows.append([tips, k + 1, *q, branch, solution.within_limits, *errors, ""])
            if not group.result.solutions:
                rows.append([tips, 0, *[""] * (self.tree.n + 4), group.result.reason])
        return rows

    # For eyes -------------------------------------------------------------------------------------------------

    def page(self) -> bytes:
        """A paragraph for each group, then a configuration of the whole tree and which joints stand."""
        parts: list[Any] = [
            heading(self.tree.name, f"lengths in {self.units.length}, angles in {self.units.angle}"),
            "",
        ]
        for group in self.answer.groups:
            parts += [*self.paragraph(group), ""]
        answer = self.answer
        if answer.q is not None:
            several = len(answer.groups) > 1 or any(len(group.result) > 1 for group in answer.groups)
            parts += ["the first solutions together" if several else "the whole configuration", ""]
            parts += ["q  " + "  ".join(show(value) for value in self.records.joints(answer.q))]
        if answer.still:
            verb = "stands" if len(answer.still) == 1 else "stand"
            where = "as --near says" if self.near else "at zero, or amid limits that leave it out"
            parts += [*([""] if answer.q is not None else []), f"{joint_names(answer.still)} {verb} {where}"]
        while parts[-1] == "":
            parts.pop()
        return render(*map(filled, parts))

    def paragraph(self, group: TipGroup) -> Iterator[Any]:
        """One group: what was found, its configurations, what is to be said of them."""
        result = group.result
        yield f"{', '.join(group.tips)}: {verdict(result, group.idle)}"
        shown = result.solutions or ((result.nearest,) if result.nearest else ())
        joints = [self.records.joints(solution.q) for solution in shown]
        which = [(i, bool(self.tree.revolute[i - 1])) for i in group.joints]
        for drawn in drawn_solutions(shown, joints, bool(result.solutions), which, self.units):
            yield ""
            yield drawn
        notes = [*self.notes(group, result)]
        if notes:
            yield ""
            yield from notes

    def notes(self, group: TipGroup, result: Result) -> Iterator[str]:
        """What is to be said of the rows."""
        question = self.answer.question
        if not result.solutions and result.nearest is not None:
            for tip, (position, angle) in zip(group.tips, group.errors[0].tolist(), strict=True):
                off = f"position error {show(position / self.units.metres)} {self.units.length}"
                if question.tasks[tip] != "position":
                    off += f", angle error {show(angle / self.units.radians)} {self.units.angle}"
                whose = f" of {tip}" if len(group.tips) > 1 else ""
                yield f"~ the nearest configuration found ({off}{whose})"
        shown = result.solutions or ((result.nearest,) if result.nearest else ())
        if any(not solution.within_limits for solution in shown):
            yield "! outside the joint limits"
        words = FamilyWords(self.tree, self.units, question.limits)
        free = [solution.free for solution in shown]
        yield from motions_in_words(result, free, group.idle, words, question.tasks[group.tips[0]], group.redundant)
