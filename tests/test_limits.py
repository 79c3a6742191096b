"""docs/limits.md says the limits that the code has."""

from __future__ import annotations

import ast
import re
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
ROW = re.compile(r"^\| (.+) \| ([\d.,e]+)(?: (KiB|MiB|GiB))? \| `([A-Z_]+)` \|$", re.MULTILINE)
ROWS = ROW.findall((ROOT / "docs" / "limits.md").read_text())
UNITS = {"": 1, "KiB": 1 << 10, "MiB": 1 << 20, "GiB": 1 << 30}


@cache
def constants():
    """Every constant of the package by its name, with the values that it has in different modules."""
    found = {}
    for path in sorted((ROOT / "robokin").rglob("*.py")):
        for line in ast.parse(path.read_text()).body:
            if not isinstance(line, ast.Assign | ast.AnnAssign):
                continue
            for name in line.targets if isinstance(line, ast.Assign) else [line.target]:
                if isinstance(name, ast.Name) and name.id.isupper() and is_arithmetic(line.value):
                    code = compile(ast.Expression(line.value), str(path), "eval")
                    found.setdefault(name.id, {})[path.stem] = eval(code, {"__builtins__": {}})
    return found


def is_arithmetic(value):
    """Whether an expression is made of numbers alone."""
    return value is not None and all(
        isinstance(node, ast.Constant | ast.BinOp | ast.UnaryOp | ast.operator | ast.unaryop)
        and not (isinstance(node, ast.Constant) and not isinstance(node.value, int | float))
        for node in ast.walk(value)
    )


def test_the_page_has_rows_and_all_of_them_are_read():
    page = (ROOT / "docs" / "limits.md").read_text()
    assert len(ROWS) == len(re.findall(r"^\| .*`[A-Z_]+` \|$", page, re.MULTILINE)) > 15


@pytest.mark.parametrize(("what", "number", "unit", "name"), ROWS, ids=[row[0] for row in ROWS])
def test_a_limit_is_the_one_of_the_code(what, number, unit, name):
    stated = float(number.replace(",", "")) * UNITS[unit]
    assert stated in constants().get(name, {}).values(), constants().get(name)
