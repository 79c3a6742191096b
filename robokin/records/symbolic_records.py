"""The matrices of a robot in symbols as plain data: every entry a text."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from robokin.derivation.symbolic_kinematics import SymbolicKinematics
from robokin.derivation.symbolic_product import Matrix
from robokin.derivation.written_sums import written
from robokin.model import Robot
from robokin.records.envelope import envelope
from robokin.units import Units

AXES = "xyz"


def symbolic_record(robot: Robot, units: Units, symbolic: SymbolicKinematics) -> dict[str, Any]:
    """The JSON document: every entry a text, every symbol a number or what it stands for."""
    record: dict[str, Any] = {
        **envelope("robot", robot.id, units),
        "matrices": [{"name": name, "matrix": entry_texts(matrix)} for name, matrix in symbolic.matrices.items()],
        "T": entry_texts(symbolic.T),
    }
    if symbolic.frames:
        record["frames"] = [{"name": name, "matrix": entry_texts(matrix)} for name, matrix in symbolic.frames.items()]
    functions = {name: f"{function.name}({function.argument})" for name, function in symbolic.functions.items()}
    record["symbols"] = {**symbolic.values, **symbolic.definitions, **functions}
    return record


def symbolic_rows(symbolic: SymbolicKinematics) -> list[list[str]]:
    """The rows of all matrices, each after its matrix's name and its axis."""
    return [
        [name, axis, *texts]
        for name, matrix in _all(symbolic).items()
        for axis, texts in zip(AXES, entry_texts(matrix), strict=False)
    ]


def _all(symbolic: SymbolicKinematics) -> Mapping[str, Matrix]:
    return {**symbolic.matrices, **symbolic.frames, "T": symbolic.T}


def entry_texts(matrix: Matrix, number: Callable[[float], str] = repr) -> list[list[str]]:
    """A matrix's entries as texts, numbers as `number` writes them."""
    return [[written(entry, number) for entry in row] for row in matrix]
