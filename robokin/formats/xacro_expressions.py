"""The expressions between `${` and `}` of a xacro file, by a small evaluator of its own: nothing runs as Python.

    value   = either [ if either else value ]      either = both { or both }      both = negated { and negated }
    negated = not negated | sum { (== | != | < | <= | > | >=) sum }
    sum     = product { (+ | -) product }          product = signed { (* | / | // | %) signed }
    signed  = { - | + } power                      power   = part [ ** signed ]
    part    = atom { [ value ] | . name }          atom    = number | string | True | False | name | ( value )
                                                           | function ( value { , value } ) | dict ( name = value … )
                                                           | [ value { , value } ]

and `sum in sum`. Values are numbers, strings and truths, with Python's meaning of the operators, and the tables and
lists of YAML files, of which parts are taken. Angles are in radians.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection
from dataclasses import dataclass

from robokin.errors import ExpressionError, did_you_mean, shown
from robokin.formats.xacro_meanings import (
    CONSTANTS,
    ELSEWHERE,
    LOADERS,
    METHODS,
    WAY_OUT,
    XACRO_FUNCTIONS,
    bounded,
    compared,
    computed,
)
from robokin.formats.xacro_tables import (
    XacroAbsent,
    XacroList,
    XacroTable,
    XacroValue,
    absent_of,
    as_xacro_number,
    part_of_xacro,
    present,
    xacro_text,
    xacro_typed,
)

MAX_EXPRESSION = 2000

DEEPEST = 40

PIECE = re.compile(
    r"\s*(?:(?P<number>(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)(?![\w.])"
    r"|(?P<name>[A-Za-z_][\w.]*)|(?P<string>'[^'\\]*'|\"[^\"\\]*\")|(?P<symbol>\*\*|//|[=!<>]=|[-+*/%()<>,\[\]{}:.=]))"
)

WORDS = {"and", "or", "not", "if", "else", "in"}


def _no_file(name: str) -> XacroValue:
    """What is loaded where no file is."""
    raise ExpressionError(f"found the file '{shown(name)}' in an expression of no file, expected none")


@dataclass(frozen=True)
class XacroNames:
    """The names that expressions may use: `lookup` gives a value, None for no name; `known` lists all for messages.

    `load` gives what is in a YAML file.
    """

    known: Callable[[], Collection[str]] = tuple
    lookup: Callable[[str], XacroValue | None] = lambda name: None
    load: Callable[[str], XacroValue] = _no_file


def evaluate_xacro(text: str, names: XacroNames) -> XacroValue:
    """The value of an expression. Raises ExpressionError."""
    if len(text) > MAX_EXPRESSION:
        raise ExpressionError(f"found an expression of {len(text)} characters, expected at most {MAX_EXPRESSION}")
    parser = _XacroParser(_pieces(text), names)
    value = present(parser.value())
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
            result = result if isinstance(result, XacroAbsent) else result or other
        return result

    def both(self) -> XacroValue:
        result = self.negated()
        while self.accept("and"):
            other = self.negated()
            result = result if isinstance(result, XacroAbsent) else result and other
        return result

    def negated(self) -> XacroValue:
        negative, any_sign = False, False
        while self.accept("not"):
            negative, any_sign = not negative, True
        first = self.sum()
        result: XacroValue = first
        met = False
        while sign := self.accept("==", "!=", "<=", ">=", "<", ">", "in"):
            second = self.sum()
            if (absent := absent_of(first, second)) is not None:
                return absent
            holds = compared(sign, first, second)
            result = (bool(result) and holds) if met else holds
            first, met = second, True
        if not any_sign or isinstance(result, XacroAbsent):
            return result
        return not result if negative else bool(result)

    def sum(self) -> XacroValue:
        result = self.product()
        while sign := self.accept("+", "-"):
            result = computed(sign, result, self.product())
        return result

    def product(self) -> XacroValue:
        result = self.signed()
        while sign := self.accept("*", "//", "/", "%"):
            result = computed(sign, result, self.signed())
        return result

    def signed(self) -> XacroValue:
        negative, any_sign = False, False
        while sign := self.accept("-", "+"):
            negative, any_sign = negative ^ (sign == "-"), True
        result = self.power()
        if not any_sign or isinstance(result, XacroAbsent):
            return result
        number = as_xacro_number(result, "a sign before")
        return -number if negative else number

    def power(self) -> XacroValue:
        base = self.part()
        if not self.accept("**"):
            return base
        self.depth += 1
        if self.depth > DEEPEST:
            raise ExpressionError(f"found more than {DEEPEST} powers of powers, expected fewer")
        result = computed("**", base, self.signed())
        self.depth -= 1
        return result

    def part(self) -> XacroValue:
        result = self.atom()
        while sign := self.accept("[", "."):
            if sign == "[":
                key = present(self.value())
                if not self.accept("]"):
                    raise ExpressionError("found no ']', expected the end of the brackets")
                result = part_of_xacro(result, key)
                continue
            kind, text = self.pieces[self.at]
            self.at += 1
            if kind != "name":
                raise ExpressionError(f"found a part taken of a value, expected [key] or .key: {WAY_OUT}")
            *keys, last = text.split(".")
            for key in keys:
                result = part_of_xacro(result, key)
            result = self.method(result, last) if self.accept("(") else part_of_xacro(result, last)
        return result

    def method(self, value: XacroValue, name: str) -> XacroValue:
        """What a method of a string gives, after its bracket."""
        arguments = self.values(")")
        if (absent := absent_of(value, *arguments)) is not None:
            return absent
        if not isinstance(value, str) or name not in METHODS:
            raise ExpressionError(f"found .{shown(name)}(…), expected a method of strings such as lower(): {WAY_OUT}")
        try:
            return METHODS[name](value, *arguments)
        except (TypeError, ValueError):
            raise ExpressionError(f"found .{name}(…) of '{shown(value)}', expected other arguments") from None

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
        if text == "[":
            return XacroList(tuple(self.values("]")))
        if text == "(":
            result = self.value()
            if not self.accept(")"):
                raise ExpressionError("found no ')', expected the end of the parentheses")
            return result
        raise ExpressionError(
            f"found '{shown(text)}', expected a value; of Python's literals only lists are read: {WAY_OUT}"
        )

    def name(self, name: str) -> XacroValue:
        value = self.names.lookup(name)
        if value is not None:
            return value
        first, _, keys = name.partition(".")
        value = self.names.lookup(first) if keys else None
        if isinstance(value, XacroTable):
            for key in keys.split("."):
                value = part_of_xacro(value, key)
            return value
        plain = name.removeprefix("math.")
        if plain in CONSTANTS:
            return CONSTANTS[plain]
        hint = did_you_mean(name, [*self.names.known(), *CONSTANTS]) or ", expected a property, a parameter or pi"
        raise ExpressionError(f"found the unknown name '{shown(name)}'{hint}")

    def call(self, name: str) -> XacroValue:
        plain = name.removeprefix("math.").removeprefix("xacro.").removeprefix("python.")
        if plain == "dict":
            return self.table()
        owner, _, method = name.rpartition(".")
        if owner and method in METHODS:
            return self.method(self.name(owner), method)
        if plain not in XACRO_FUNCTIONS and name not in LOADERS:
            if plain in ELSEWHERE or "." in plain:
                raise ExpressionError(
                    f"found {shown(name)}(…), expected numbers, strings and functions such as radians(…): {WAY_OUT}"
                )
            hint = did_you_mean(plain, XACRO_FUNCTIONS) or ", expected one such as radians, sin or sqrt"
            raise ExpressionError(f"found the unknown function '{shown(name)}'{hint}")
        arguments = self.values(")")
        if (absent := absent_of(*arguments)) is not None:
            return absent
        if name in LOADERS:
            if len(arguments) != 1 or not isinstance(arguments[0], str):
                raise ExpressionError(f"found {name}(…), expected the name of one YAML file")
            return self.names.load(arguments[0])
        try:
            return bounded(XACRO_FUNCTIONS[plain](*arguments))
        except (TypeError, ValueError, ZeroDivisionError, OverflowError):
            plainly = [a for a in arguments if not isinstance(a, XacroTable | XacroList)]
            where = ", ".join(shown(xacro_text(argument)) for argument in plainly)
            raise ExpressionError(f"found {name}({where}), expected arguments for which it has a value") from None

    def values(self, end: str) -> list[XacroValue]:
        """Values with commas between them, up to a bracket."""
        found: list[XacroValue] = []
        while not self.accept(end):
            if found and not self.accept(","):
                raise ExpressionError(f"found no '{end}' after {len(found)} values, expected it")
            if found and self.accept(end):
                break
            found.append(self.value())
        return found

    def table(self) -> XacroTable:
        """The table that is written `dict(name=value, …)`, after its bracket."""
        entries: dict[str, XacroValue] = {}
        while not self.accept(")"):
            kind, name = self.pieces[self.at]
            self.at += 1
            if kind != "name" or not self.accept("="):
                raise ExpressionError(f"found '{shown(name)}' in dict(…), expected name=value: {WAY_OUT}")
            entries[name] = present(self.value())
            if not self.accept(",") and self.pieces[self.at][1] != ")":
                raise ExpressionError("found no ')' after dict(…, expected it")
        return XacroTable(entries)
