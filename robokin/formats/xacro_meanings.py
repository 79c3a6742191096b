"""What names and operators mean between `${` and `}` of a xacro file, as in Python, and what values are too much."""

from __future__ import annotations

import math
from collections.abc import Callable

from robokin.errors import ExpressionError
from robokin.formats.xacro_tables import (
    XacroAbsent,
    XacroList,
    XacroTable,
    XacroValue,
    absent_of,
    as_xacro_number,
    xacro_text,
)

MAX_STRING = 20_000

LARGEST_WHOLE = 10**15
"""A whole number beyond it is a float: none grows without bound."""

MATHS = (
    "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "sqrt", "exp",
    "log", "log10", "hypot", "fabs", "fmod", "pow", "radians", "degrees", "floor", "ceil", "trunc",
)  # fmt: skip

XACRO_FUNCTIONS: dict[str, Callable[..., XacroValue]] = {
    **{name: getattr(math, name) for name in MATHS},
    "abs": abs,
    "min": min,
    "max": max,
    "round": round,
    "int": int,
    "float": float,
    "str": lambda value: xacro_text(value),
    "bool": bool,
    "len": len,
}

METHODS: dict[str, Callable[..., XacroValue]] = {
    **{name: getattr(str, name) for name in ("lower", "upper", "strip", "find", "startswith", "endswith")},
    "split": lambda text, *at: XacroList(tuple(str.split(text, *at))),
}
"""Of strings; none of them makes more of a text than there is."""

CONSTANTS: dict[str, XacroValue] = {
    "pi": math.pi,
    "tau": math.tau,
    "e": math.e,
    "True": True,
    "False": False,
    "true": True,
    "false": False,
}

LOADERS = ("load_yaml", "xacro.load_yaml")

ELSEWHERE = ("load_json", "list", "tuple", "set", "eval", "exec", "open", "lambda", "for")
"""Names of Python's and xacro's that are refused with a word on what to do."""

WAY_OUT = "nothing of a xacro file is run as Python; make a URDF of it with ROS's own xacro, and give that"


def compared(sign: str, a: XacroValue, b: XacroValue) -> bool:
    """a == b and the like."""
    if sign == "in":
        if isinstance(b, str) and isinstance(a, str):
            return a in b
        if isinstance(b, XacroTable | XacroList):
            return a in (b.entries if isinstance(b, XacroTable) else b.items)
        raise ExpressionError("found 'in' before no table, expected a string, a table or a list after it")
    if sign in ("==", "!="):
        return (a == b) == (sign == "==")
    try:
        return {"<": a < b, "<=": a <= b, ">": a > b, ">=": a >= b}[sign]  # type: ignore[operator]
    except TypeError:
        raise ExpressionError("found a string compared with a number, expected two of a kind") from None


def computed(sign: str, a: XacroValue, b: XacroValue) -> XacroValue:
    """a + b and the like. Raises ExpressionError where there is no such value."""
    if (absent := absent_of(a, b)) is not None:
        return absent
    if sign == "+" and isinstance(a, str) and isinstance(b, str):
        return bounded(a + b)
    a, b = as_xacro_number(a, f"'{sign}' beside"), as_xacro_number(b, f"'{sign}' beside")
    try:
        if sign == "**":
            small = isinstance(a, int) and isinstance(b, int) and 0 <= b < 64 and abs(a) < 1 << 20
            return bounded(a**b if small else math.pow(a, b))
        if sign in ("/", "//", "%"):
            return bounded(a / b if sign == "/" else a // b if sign == "//" else a % b)
        return bounded(a + b if sign == "+" else a - b if sign == "-" else a * b)
    except (ZeroDivisionError, OverflowError, ValueError):
        raise ExpressionError(f"found {a!r} {sign} {b!r}, expected numbers for which it has a value") from None


def bounded(value: XacroValue) -> XacroValue:
    """The value, neither too long nor infinite."""
    if isinstance(value, str):
        if len(value) > MAX_STRING:
            raise ExpressionError(f"found a string of {len(value)} characters, expected at most {MAX_STRING}")
        return value
    if isinstance(value, bool | XacroTable | XacroList | XacroAbsent):
        return value
    if isinstance(value, int) and abs(value) > LARGEST_WHOLE:
        value = float(value) if abs(value) < 1 << 1000 else math.inf
    if not math.isfinite(value):
        raise ExpressionError("found a result that is too large, expected a finite number")
    return value
