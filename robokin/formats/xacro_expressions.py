"""The expressions between `${` and `}` of a xacro file, by a small evaluator of its own: nothing runs as Python.

    value   = either [ if either else value ]      either = both { or both }      both = negated { and negated }
    negated = not negated | sum { (== | != | < | <= | > | >=) sum }
    sum     = product { (+ | -) product }          product = signed { (* | / | // | %) signed }
    signed  = { - | + } power                      power   = atom [ ** signed ]
    atom    = number | string | True | False | name | function ( value { , value } ) | ( value )

Values are numbers, strings and truths, with Python's meaning of the operators. Angles are in radians.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Collection
from dataclasses import dataclass

from robokin.errors import ExpressionError, did_you_mean, shown

XacroValue = float | int | str | bool

MAX_EXPRESSION = 2000
MAX_STRING = 20_000
DEEPEST = 40
LARGEST_WHOLE = 10**15
"""A whole number beyond it is a float: none grows without bound."""

PIECE = re.compile(
    r"\s*(?:(?P<number>(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)(?![\w.])"
    r"|(?P<name>[A-Za-z_][\w.]*)|(?P<string>'[^'\\]*'|\"[^\"\\]*\")|(?P<symbol>\*\*|//|[=!<>]=|[-+*/%()<>,\[\]{}:.=]))"
)

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
CONSTANTS: dict[str, XacroValue] = {
    "pi": math.pi,
    "tau": math.tau,
    "e": math.e,
    "True": True,
    "False": False,
    "true": True,
    "false": False,
}
ELSEWHERE = ("load_yaml", "load_json", "dict", "list", "tuple", "set", "eval", "exec", "open", "lambda", "for")
"""Names of Python's and xacro's that are refused with a word on what to do."""

WAY_OUT = "nothing of a xacro file is run as Python; make a URDF of it with ROS's own xacro, and give that"

WORDS = {"and", "or", "not", "if", "else"}


@dataclass(frozen=True)
class XacroNames:
    """The names that expressions may use: `lookup` gives a value, None for no name; `known` lists all for messages."""

    known: Callable[[], Collection[str]] = tuple
    lookup: Callable[[str], XacroValue | None] = lambda name: None


def xacro_text(value: XacroValue) -> str:
    """A value as it stands in an attribute."""
    return value if isinstance(value, str) else repr(value)


def xacro_typed(text: str) -> XacroValue:
    """What a text stands for in an expression: a number, a truth, else the text."""
    word = text.strip()
    if re.fullmatch(r"[+-]?[0-9]{1,15}", word):
        return int(word)
    if re.fullmatch(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?", word):
        return float(word)
    return {"true": True, "false": False}.get(word.lower(), text)


def evaluate_xacro(text: str, names: XacroNames) -> XacroValue:
    """The value of an expression. Raises ExpressionError."""
    if len(text) > MAX_EXPRESSION:
        raise ExpressionError(f"found an expression of {len(text)} characters, expected at most {MAX_EXPRESSION}")
    parser = _XacroParser(_pieces(text), names)
    value = parser.value()
    if parser.pieces[parser.at][1] in ("[", "."):
        raise ExpressionError("found a part taken of a value, expected numbers, strings and names: " + WAY_OUT)
    if parser.pieces[parser.at][0] != "end":
        raise ExpressionError(f"found '{shown(parser.pieces[parser.at][1])}', expected the end of the expression")
    return value


def _pieces(text: str) -> list[tuple[str, str]]:
    """Kind and text of what an expression is made of."""
    pieces, at = [], 0
    text = text.rstrip()
    while at < len(text):
        match = PIECE.match(text, at)
        if match is None:
            raise ExpressionError(
                f"found '{shown(text[at:].strip())}', expected numbers, names, strings, operators and functions"
            )
        pieces.append((match.lastgroup or "", match[match.lastgroup or ""]))
        at = match.end()
    return [*pieces, ("end", "")]


class _XacroParser:
    """Reads and computes at once."""

    def __init__(self, pieces: list[tuple[str, str]], names: XacroNames) -> None:
        self.pieces, self.names, self.at, self.depth = pieces, names, 0, 0

    def accept(self, *texts: str) -> str:
        """The next piece if it is one of these, else nothing."""
        kind, text = self.pieces[self.at]
        if kind in ("symbol", "name") and text in texts:
            self.at += 1
            return text
        return ""

    def value(self) -> XacroValue:
        self.depth += 1
        if self.depth > DEEPEST:
            raise ExpressionError(f"found an expression nested more than {DEEPEST} deep, expected a flat one")
        result = self.either()
        if self.accept("if"):
            condition = self.either()
            if not self.accept("else"):
                raise ExpressionError("found 'if' without 'else', expected both")
            other = self.value()
            result = result if condition else other
        self.depth -= 1
        return result

    def either(self) -> XacroValue:
        result = self.both()
        while self.accept("or"):
            other = self.both()
            result = result or other
        return result

    def both(self) -> XacroValue:
        result = self.negated()
        while self.accept("and"):
            other = self.negated()
            result = result and other
        return result

    def negated(self) -> XacroValue:
        negative, any_sign = False, False
        while self.accept("not"):
            negative, any_sign = not negative, True
        first = self.sum()
        result: XacroValue = first
        compared = False
        while sign := self.accept("==", "!=", "<=", ">=", "<", ">"):
            second = self.sum()
            holds = _compare(sign, first, second)
            result = (bool(result) and holds) if compared else holds
            first, compared = second, True
        return (not result if negative else bool(result)) if any_sign else result

    def sum(self) -> XacroValue:
        result = self.product()
        while sign := self.accept("+", "-"):
            result = _computed(sign, result, self.product())
        return result

    def product(self) -> XacroValue:
        result = self.signed()
        while sign := self.accept("*", "//", "/", "%"):
            result = _computed(sign, result, self.signed())
        return result

    def signed(self) -> XacroValue:
        negative, any_sign = False, False
        while sign := self.accept("-", "+"):
            negative, any_sign = negative ^ (sign == "-"), True
        result = self.power()
        if any_sign and isinstance(result, str):
            raise ExpressionError(f"found a sign before '{shown(result)}', expected a number")
        return -result if negative and not isinstance(result, str) else result

    def power(self) -> XacroValue:
        base = self.atom()
        if not self.accept("**"):
            return base
        self.depth += 1
        if self.depth > DEEPEST:
            raise ExpressionError(f"found more than {DEEPEST} powers of powers, expected fewer")
        result = _computed("**", base, self.signed())
        self.depth -= 1
        return result

    def atom(self) -> XacroValue:
        kind, text = self.pieces[self.at]
        if kind == "end":
            raise ExpressionError("found the end of the expression, expected a value")
        self.at += 1
        if kind == "number":
            return xacro_typed(text)
        if kind == "string":
            return text[1:-1]
        if kind == "name" and text not in WORDS:
            return self.call(text) if self.accept("(") else self.name(text)
        if text == "(":
            result = self.value()
            if not self.accept(")"):
                raise ExpressionError("found no ')', expected the end of the parentheses")
            return result
        raise ExpressionError(
            f"found '{shown(text)}', expected a value; lists and dictionaries are not read: {WAY_OUT}"
        )

    def name(self, name: str) -> XacroValue:
        value = self.names.lookup(name)
        if value is not None:
            return value
        plain = name.removeprefix("math.")
        if plain in CONSTANTS:
            return CONSTANTS[plain]
        hint = did_you_mean(name, [*self.names.known(), *CONSTANTS]) or ", expected a property, a parameter or pi"
        raise ExpressionError(f"found the unknown name '{shown(name)}'{hint}")

    def call(self, name: str) -> XacroValue:
        plain = name.removeprefix("math.").removeprefix("xacro.").removeprefix("python.")
        if plain not in XACRO_FUNCTIONS:
            if plain in ELSEWHERE or "." in plain:
                raise ExpressionError(
                    f"found {shown(name)}(…), expected numbers, strings and functions such as radians(…): {WAY_OUT}"
                )
            hint = did_you_mean(plain, XACRO_FUNCTIONS) or ", expected one such as radians, sin or sqrt"
            raise ExpressionError(f"found the unknown function '{shown(name)}'{hint}")
        arguments = [] if self.accept(")") else [self.value()]
        while arguments and not self.accept(")"):
            if not self.accept(","):
                raise ExpressionError(f"found no ')' after {name}(…, expected it")
            arguments.append(self.value())
        try:
            return _bounded(XACRO_FUNCTIONS[plain](*arguments))
        except (TypeError, ValueError, ZeroDivisionError, OverflowError):
            where = ", ".join(shown(xacro_text(argument)) for argument in arguments)
            raise ExpressionError(f"found {name}({where}), expected arguments for which it has a value") from None


def _compare(sign: str, a: XacroValue, b: XacroValue) -> bool:
    """a == b and the like."""
    if sign in ("==", "!="):
        return (a == b) == (sign == "==")
    try:
        return {"<": a < b, "<=": a <= b, ">": a > b, ">=": a >= b}[sign]  # type: ignore[operator]
    except TypeError:
        raise ExpressionError("found a string compared with a number, expected two of a kind") from None


def _computed(sign: str, a: XacroValue, b: XacroValue) -> XacroValue:
    """a + b and the like. Raises ExpressionError where there is no such value."""
    if isinstance(a, str) or isinstance(b, str):
        if sign == "+" and isinstance(a, str) and isinstance(b, str):
            return _bounded(a + b)
        word = shown(a if isinstance(a, str) else str(b))
        raise ExpressionError(f"found the string '{word}' beside '{sign}', expected numbers")
    try:
        if sign == "**":
            small = isinstance(a, int) and isinstance(b, int) and 0 <= b < 64 and abs(a) < 1 << 20
            return _bounded(a**b if small else math.pow(a, b))
        if sign in ("/", "//", "%"):
            return _bounded(a / b if sign == "/" else a // b if sign == "//" else a % b)
        return _bounded(a + b if sign == "+" else a - b if sign == "-" else a * b)
    except (ZeroDivisionError, OverflowError, ValueError):
        raise ExpressionError(f"found {a!r} {sign} {b!r}, expected numbers for which it has a value") from None


def _bounded(value: XacroValue) -> XacroValue:
    """The value, neither too long nor infinite."""
    if isinstance(value, str):
        if len(value) > MAX_STRING:
            raise ExpressionError(f"found a string of {len(value)} characters, expected at most {MAX_STRING}")
        return value
    if isinstance(value, bool):
        return value
    if isinstance(value, int) and abs(value) > LARGEST_WHOLE:
        value = float(value) if abs(value) < 1 << 1000 else math.inf
    if not math.isfinite(value):
        raise ExpressionError("found a result that is too large, expected a finite number")
    return value
