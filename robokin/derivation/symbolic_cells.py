"""What a cell of a table says, in the names of the description's parameters."""

from __future__ import annotations

import ast
import math
from collections.abc import Callable, Mapping

MAX_TEXT = 200
"""Characters of a cell that is worth reading as a formula; a longer one goes by a letter of its own."""

AGREES = 1e-9
"""A formula is what the cell says when both have the same value, to this relative error: far above the
rounding of either, far below any other reading of the text."""

Linear = dict[str, float]
"""Coefficients by the parameter's name; the constant under ""."""

OPERATIONS: dict[type[ast.operator], Callable[[float, float], float]] = {
    ast.Add: lambda a, b: a + b,
    ast.Sub: lambda a, b: a - b,
    ast.Mult: lambda a, b: a * b,
    ast.Div: lambda a, b: a / b,
    ast.Pow: lambda a, b: float(a**b),
}


def linear_of(text: str, value: float, parameters: Mapping[str, float]) -> Linear | None:
    """A cell's text as coefficients of the parameters in it; None when it is anything but a linear form.

    The expressions of a description are, as far as they are linear, Python's own. `value` is what the
    cell amounts to and `parameters` what the names do, all in the units of the file.
    """
    if len(text) > MAX_TEXT:
        return None
    try:
        form = _linear(ast.parse(" ".join(text.split()), mode="eval").body, parameters)
        found = sum(coefficient * parameters.get(name, 1.0) for name, coefficient in form.items())
        scale = max((abs(coefficient * parameters.get(name, 1.0)) for name, coefficient in form.items()), default=0.0)
    except (SyntaxError, ValueError, ArithmeticError, RecursionError, MemoryError, TypeError):
        return None
    return form if abs(found - value) <= AGREES * max(scale, abs(value)) else None


def names_in(text: str, parameters: Mapping[str, float]) -> set[str]:
    """The parameters that a linear cell names."""
    if len(text) > MAX_TEXT:
        return set()
    try:
        tree = ast.parse(" ".join(text.split()), mode="eval")
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return set()
    return {node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and node.id in parameters}


def _linear(node: ast.expr, parameters: Mapping[str, float]) -> Linear:
    if isinstance(node, ast.Constant) and isinstance(node.value, (int, float)):
        return {"": float(node.value)}
    if isinstance(node, ast.Name) and node.id in parameters:
        return {node.id: 1.0}
    if isinstance(node, ast.Name) and node.id == "pi":
        return {"": math.pi}
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.USub, ast.UAdd)):
        return _scaled(_linear(node.operand, parameters), -1.0 if isinstance(node.op, ast.USub) else 1.0)
    if isinstance(node, ast.BinOp) and type(node.op) in OPERATIONS:
        return _combined(node.op, _linear(node.left, parameters), _linear(node.right, parameters))
    raise ValueError


def _combined(operator: ast.operator, a: Linear, b: Linear) -> Linear:
    if isinstance(operator, (ast.Add, ast.Sub)):
        sign = 1.0 if isinstance(operator, ast.Add) else -1.0
        return {name: a.get(name, 0.0) + sign * b.get(name, 0.0) for name in {**a, **b}}
    if set(a) | set(b) == {""}:
        return {"": OPERATIONS[type(operator)](a[""], b[""])}
    if set(b) == {""} and isinstance(operator, (ast.Mult, ast.Div)):
        return _scaled(a, b[""] if isinstance(operator, ast.Mult) else 1.0 / b[""])
    if set(a) == {""} and isinstance(operator, ast.Mult):
        return _scaled(b, a[""])
    raise ValueError


def _scaled(a: Linear, factor: float) -> Linear:
    return {name: factor * coefficient for name, coefficient in a.items()}
