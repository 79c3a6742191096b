"""The worked steps behind an answer of `robokin ik` for eyes."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby

from robokin.derivation.formulas import tokens
from robokin.derivation.worked_steps import Quantity, Step
from robokin.errors import counted
from robokin.records.worked_step_records import Explanation
from robokin.tables.written_rows import page

WIDTH = 80
"""Columns of a page."""

PLACES = 9
"""Decimals beyond which a number on a page is rounding of 0."""

KINDS = ("length", "angle", "number", "point", "direction", "rotation", "pose")
MATRICES = ("rotation", "pose")


@dataclass(frozen=True, eq=False)
class WorkedStepPage:
    """Writes worked steps with the answer that they explain."""

    explained: Explanation

    def page(self) -> bytes:
        """The steps as text of 80 columns."""
        return page("\n".join(["", *self.lines()]) + "\n")

    def lines(self) -> Iterator[str]:
        """Title, geometry, steps with the ways' headings and ends, and a count."""
        yield from _wrapped(f"The lesson: {self.explained.lesson.title}", "", "  ")
        yield ""
        lesson = self.explained.lesson
        given = sorted(lesson.given.items(), key=lambda entry: (KINDS.index(entry[1].kind), entry[0]))
        plain = [f"{name} = {self.shown(q)}" for name, q in given if q.kind not in MATRICES]
        if plain:
            yield from _wrapped("given: " + ",  ".join(plain), "", "       ")
        for name, quantity in given:
            if quantity.kind in MATRICES:
                yield from self.matrix(name, quantity, "       ")
        ends = {end.branch: k for k, end in enumerate(lesson.ends)}
        number = 0
        for branch, steps in groupby(lesson.steps, key=lambda step: step.branch):
            if branch:
                yield ""
                words = self.words(branch)
                yield from _wrapped(f"── {branch}" + (f": {words}" if words else ""), "", "   ")
            for step in steps:
                number += 1
                yield from self.step(number, step)
            if branch in ends:
                yield from self.end(ends[branch])
        yield ""
        reached = sum(number is not None for number in self.explained.numbers)
        yield from _wrapped(
            f"{counted(len(self.explained.lesson.ends), 'way')}, {counted(reached, 'solution')}", "", ""
        )

    def words(self, branch: str) -> str:
        """What all postures beyond a choice of signs have in their names."""
        below = [
            name.split(", ")
            for end, name in zip(self.explained.lesson.ends, self.explained.names, strict=True)
            if name and (end.branch == branch or end.branch.startswith(branch + ", "))
        ]
        return ", ".join(word for word in below[0] if all(word in name for name in below)) if below else ""

    def step(self, number: int, step: Step) -> Iterator[str]:
        """A step: what it is for, the formula, the formula with numbers, the result."""
        first, margin = f"{number:3}  ", " " * 5
        if step.note:
            yield from _wrapped(step.note, first, margin)
            first = margin
        hanging = margin + " " * (len(step.name) + 3)
        equals = margin + " " * (len(step.name) + 1) + "= "
        yield from _wrapped(f"{step.name} = {step.formula}", first, hanging)
        numbers = self.substituted(step)
        result = self.shown(step.result)
        if numbers not in (step.formula, result):
            yield from _wrapped(numbers, equals, hanging)
        if step.result.kind in MATRICES:
            yield from self.matrix("", step.result, equals)
        elif result != step.formula:
            unit = f" {self.explained.units.length}" if step.result.kind in ("length", "point") else ""
            yield from _wrapped(result + unit, equals, hanging)

    def end(self, k: int) -> Iterator[str]:
        """What a way has come to."""
        end, number = self.explained.lesson.ends[k], self.explained.numbers[k]
        if end.q is None:
            yield from _wrapped(f"no way on: {end.reason}", "  →  ", "     ")
            return
        q = "q = (" + ", ".join(map(_number, self.explained.joints(end.q))) + ")"
        said = f"solution {number}" if number else f"no solution ({self.explained.reason(end, number)})"
        yield from _wrapped(f"{said}: {q}", "  →  ", "     ")

    def substituted(self, step: Step) -> str:
        """The formula with numbers and vectors in place of their names."""
        words = tokens(step.formula, step.values)
        text, place = "", 0
        for k, word in enumerate(words):
            start = step.formula.index(word, place)
            text += step.formula[place:start]
            place = start + len(word)
            quantity = step.values.get(word)
            if quantity is None or quantity.kind in MATRICES:
                text += word
                continue
            shown = self.shown(quantity)
            after = words[k + 1] if k + 1 < len(words) else ""
            opened = k == 0 or (words[k - 1] in ("(", ",") and after in (")", ",", "+", "−"))
            text += f"({shown})" if shown.startswith("−") and (not opened or after == "²") else shown
        return text

    def shown(self, quantity: Quantity) -> str:
        """A number or a vector as a page shows it, an angle with its unit; a matrix by nothing."""
        value = self.explained.plain(quantity)
        if isinstance(value, list):
            return "" if quantity.kind in MATRICES else "(" + ", ".join(map(_number, value)) + ")"
        return _number(value) + (("°" if self.explained.units.degrees else " rad") if quantity.kind == "angle" else "")

    def matrix(self, name: str, quantity: Quantity, margin: str) -> Iterator[str]:
        """A matrix, a row a line."""
        cells = [[_number(value) for value in row] for row in self.explained.plain(quantity)]
        widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
        left = margin + (f"{name} = " if name else "")
        for i, row in enumerate(cells):
            a, b = ("⎡⎤" if i == 0 else "⎣⎦") if i in (0, len(cells) - 1) else "⎢⎥"
            line = "  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True))
            yield f"{left if i == 0 else ' ' * len(left)}{a} {line} {b}"


def _number(value: float) -> str:
    """Six digits, with a typographic minus."""
    return f"{round(value, PLACES) + 0.0:.6g}".replace("-", "−")


def _wrapped(text: str, first: str, rest: str) -> list[str]:
    """Lines of at most 80 columns, broken at blanks; a product of rotations that is longer also at its signs."""
    if max(map(len, text.split(" "))) > WIDTH - max(len(first), len(rest)):
        text = text.replace("·R_", "· R_")
    return textwrap.wrap(
        text, WIDTH, initial_indent=first, subsequent_indent=rest, break_long_words=False, break_on_hyphens=False
    )
