"""The matrices of a robot in symbols: a page of text, and every other form."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Iterator

from robokin.derivation.symbolic_kinematics import SymbolicKinematics
from robokin.derivation.symbolic_latex import shown_number, symbolic_latex
from robokin.derivation.symbolic_product import Matrix
from robokin.derivation.symbolic_python import python_source
from robokin.model import Robot
from robokin.records.symbolic_records import AXES, entry_texts, symbolic_record, symbolic_rows
from robokin.reports.number_columns import PAGE
from robokin.tables.written_rows import csv_records, encode, json_document, json_line, page
from robokin.units import Units

COLUMNS = "nsap"

BOUND = "\0"
"""Stands for a blank at which no line is broken; no name or formula has it."""


def symbolic_page(robot: Robot, units: Units, symbolic: SymbolicKinematics) -> str:
    """The matrices and the meaning of their symbols, a page of 80 columns."""
    rest = f"{robot.convention} convention, lengths in {units.length}, angles in {units.angle}"
    gap = "  " if len(robot.name) + len(rest) + 2 <= PAGE else "\n"
    parts = [f"{robot.name}{gap}{rest}"]
    parts += [f"{name} =\n{_drawn(matrix)}" for name, matrix in {**symbolic.matrices, **symbolic.frames}.items()]
    factors = _filled(f"T = {' '.join(symbolic.matrices)} =", "    ")
    parts.append(f"{factors}\n{_drawn(symbolic.T)}")
    parts.append("\n".join(_legend(symbolic)))
    return "\n\n".join(part for part in parts if part) + "\n"


def _drawn(matrix: Matrix) -> str:
    """A matrix in brackets where it fits a page, else an entry a line: `nx = …`."""
    texts = entry_texts(matrix, shown_number)
    columns = [_column(column) for column in zip(*texts, strict=True)]
    lines = [f"[ {'  '.join(row)} ]" for row in zip(*columns, strict=True)]
    if len(lines[0]) <= PAGE:
        return "\n".join(lines)
    entries: list[str] = []
    for name, column in zip(COLUMNS, zip(*texts[:3], strict=True), strict=True):
        entries += [f"{name}{axis} = {text}" for axis, text in zip(AXES, column, strict=True)]
    return "\n".join(_wrapped(entry, "     ") for entry in entries)


def _column(texts: tuple[str, ...]) -> list[str]:
    """Texts of one width, their signs before the others' first letters."""
    signed = any(text.startswith("-") for text in texts)
    lines = [f" {text}" if signed and not text.startswith("-") else text for text in texts]
    width = max(map(len, lines))
    return [line.ljust(width) for line in lines]


def _wrapped(text: str, indent: str) -> str:
    """A text in lines of a page, broken before a sign."""
    for sign in "+-":
        text = text.replace(f" {sign} ", f" {sign}{BOUND}")
    return _filled(text, indent)


def _listed(items: Iterable[str]) -> str:
    """Items with commas between them in lines of a page, none broken."""
    return _filled(", ".join(item.replace(" ", BOUND) for item in items), "  ")


def _filled(text: str, indent: str) -> str:
    lines = textwrap.wrap(text, PAGE, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False)
    return "\n".join(lines).replace(BOUND, " ")


def _legend(symbolic: SymbolicKinematics) -> Iterator[str]:
    """What the symbols mean, a paragraph for each kind."""
    if symbolic.functions:
        yield _listed(f"{name} = {each.name}({each.argument})" for name, each in symbolic.functions.items())
    if symbolic.definitions:
        yield _listed(f"{name} = {text}" for name, text in symbolic.definitions.items())
    if symbolic.notes:
        yield _listed(f"{name} = {text}" for name, text in symbolic.notes.items())
    if symbolic.values:
        yield _listed(f"{name} = {shown_number(value)}" for name, value in symbolic.values.items())


def symbolic_written(form: str, robot: Robot, units: Units, symbolic: SymbolicKinematics) -> bytes:
    """The matrices in a form: python, latex, or one of the formats of every command."""
    if form == "python":
        return encode(python_source(robot, units, symbolic))
    if form == "latex":
        return page(symbolic_latex(robot, units, symbolic))
    if form == "table":
        return page(symbolic_page(robot, units, symbolic))
    if form == "csv":
        return csv_records(["matrix", "axis", "n", "s", "a", "p"], symbolic_rows(symbolic))
    record = symbolic_record(robot, units, symbolic)
    return json_document(record) if form == "json" else json_line(record)
