"""The matrices of `robokin fk --symbolic`: as text for eyes, as LaTeX, as plain data."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

from robokin.cli.output.number_columns import PAGE
from robokin.cli.output.numbers import show
from robokin.derivation.symbolic_kinematics import SymbolicKinematics
from robokin.derivation.symbolic_product import Matrix
from robokin.derivation.written_sums import latex, latex_function, latex_name, written
from robokin.model import Robot
from robokin.records.envelope import envelope
from robokin.units import Units

COLUMNS = "nsap"
AXES = "xyz"

BOUND = "\0"
"""Stands for a blank at which no line is broken; no name or formula has it."""


def symbolic_record(robot: Robot, units: Units, symbolic: SymbolicKinematics) -> dict[str, Any]:
    """The JSON document: every entry a text, every symbol a number or what it stands for."""
    record: dict[str, Any] = {
        **envelope("robot", robot.id, units),
        "matrices": [{"name": name, "matrix": _texts(matrix)} for name, matrix in symbolic.matrices.items()],
        "T": _texts(symbolic.T),
    }
    if symbolic.frames:
        record["frames"] = [{"name": name, "matrix": _texts(matrix)} for name, matrix in symbolic.frames.items()]
    functions = {name: f"{function.name}({function.argument})" for name, function in symbolic.functions.items()}
    record["symbols"] = {**symbolic.values, **symbolic.definitions, **functions}
    return record


def symbolic_rows(symbolic: SymbolicKinematics) -> list[list[str]]:
    """The rows of all matrices, each after its matrix's name and its axis."""
    return [
        [name, axis, *texts]
        for name, matrix in _all(symbolic).items()
        for axis, texts in zip(AXES, _texts(matrix), strict=False)
    ]


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


def symbolic_latex(robot: Robot, units: Units, symbolic: SymbolicKinematics) -> str:
    """The matrices as displayed mathematics (amsmath's bmatrix), the symbols' meaning in comments."""
    functions = symbolic.functions

    def drawn(matrix: Matrix) -> str:
        rows = [" & ".join(latex(entry, functions, _show) for entry in row) for row in matrix]
        return "\\begin{bmatrix}\n" + " \\\\\n".join(f"  {row}" for row in rows) + "\n\\end{bmatrix}"

    parts = [f"% {robot.name}"]
    parts += [f"\\[\n{_latex_matrix(name)} = {drawn(matrix)}\n\\]" for name, matrix in symbolic.matrices.items()]
    parts += [f"\\[\n{_latex_matrix(name)} = {drawn(matrix)}\n\\]" for name, matrix in symbolic.frames.items()]
    factors = " ".join(_latex_matrix(name) for name in symbolic.matrices)
    parts.append(f"\\[\nT = {factors} = {drawn(symbolic.T)}\n\\]")
    meanings = [
        f"{latex_function(function)} = \\{function.name}({function.argument})" for function in functions.values()
    ]
    meanings += [f"{latex_name(name)} = {text}" for name, text in symbolic.definitions.items()]
    meanings += [f"{latex_name(name)} = {_show(value)}" for name, value in symbolic.values.items()]
    rest = f"lengths in {units.length}, angles in {units.angle}"
    return "\n".join([*parts, *(f"% {line}" for line in meanings), f"% {rest}"]) + "\n"


def _latex_matrix(name: str) -> str:
    """`A_{1}`, `T^{0}_{3}`; base and tool by what they are."""
    if name in ("base", "tool"):
        return f"T_{{\\mathrm{{{name}}}}}"
    if name.startswith("T_0_"):
        return f"T^{{0}}_{{{name[4:]}}}"
    return f"A_{{{name[1:]}}}"


def _all(symbolic: SymbolicKinematics) -> Mapping[str, Matrix]:
    return {**symbolic.matrices, **symbolic.frames, "T": symbolic.T}


def _texts(matrix: Matrix, number: Callable[[float], str] = repr) -> list[list[str]]:
    return [[written(entry, number) for entry in row] for row in matrix]


def _drawn(matrix: Matrix) -> str:
    """A matrix in brackets where it fits a page, else an entry a line: `nx = …`."""
    texts = _texts(matrix, _show)
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
        yield _listed(f"{name} = {_show(value)}" for name, value in symbolic.values.items())


def _show(value: float) -> str:
    """A number for eyes; a very small one is not shown as 0, which would be another matrix."""
    text = show(value)
    return f"{value:.6g}" if text == "0" and value else text
