"""Formulas as lessons print them, and their values: `c₂ = (x² + y² − a₁² − a₂²) / (2·a₁·a₂)`.

What is printed is what is computed: a step's result is the value of its formula's text. The language:

    sum      [+|−] product {(+|−) product}
    product  power {(·|/) power}         · multiplies matrices and vectors as well; two vectors to a number
    power    atom {² | ᵀ | ⁻¹}
    atom     a number, a name, a function of arguments in brackets, √(sum), (sum)
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping
from typing import Any

import numpy as np

from robokin.spatial import invert, rotation_from_axis_angle

Value = Any
"""A number or an array (3,), (3, 3), (4, 4)."""

FUNCTIONS: dict[str, Callable[..., Value]] = {
    "atan2": np.arctan2,
    "cos": np.cos,
    "sin": np.sin,
    "R_z": lambda angle: rotation_from_axis_angle([0.0, 0.0, 1.0], angle),
    "R_x": lambda angle: rotation_from_axis_angle([1.0, 0.0, 0.0], angle),
    "√": np.sqrt,
}
MARKS = ("⁻¹", "²", "ᵀ", "+", "−", "·", "/", "(", ")", ",")


def tokens(formula: str, names: Collection[str]) -> list[str]:
    """The words of a formula, given the names of its values. Raises ValueError for what is no word."""
    known = sorted([*names, *FUNCTIONS, *MARKS], key=len, reverse=True)
    pattern = re.compile("|".join([*map(re.escape, known), r"\d+(?:\.\d+)?"]))
    words, place = [], 0
    while place < len(formula):
        if formula[place] == " ":
            place += 1
            continue
        found = pattern.match(formula, place)
        if found is None:
            raise ValueError(f"found '{formula[place:]}' in '{formula}', expected one of {', '.join(known)}")
        words.append(found.group())
        place = found.end()
    return words


def evaluate(formula: str, values: Mapping[str, Value]) -> Value:
    """The value of a formula [SI units and radians], given the values of its names."""
    reader = _Reader(tokens(formula, values), values)
    value = reader.sum()
    if reader.words[reader.place :]:
        raise ValueError(f"found '{reader.words[reader.place]}' in '{formula}', expected its end")
    return value


class _Reader:
    """Recursive descent, a method for each rule of the language."""

    def __init__(self, words: list[str], values: Mapping[str, Value]) -> None:
        self.words, self.values, self.place = words, values, 0

    def take(self, *wanted: str) -> str:
        """The next word if it is one of those, or nothing."""
        if self.place < len(self.words) and self.words[self.place] in wanted:
            self.place += 1
            return self.words[self.place - 1]
        return ""

    def sum(self) -> Value:
        sign = self.take("+", "−")
        value = self.product()
        if sign == "−":
            value = -value
        while sign := self.take("+", "−"):
            term = self.product()
            value = value + term if sign == "+" else value - term
        return value

    def product(self) -> Value:
        value = self.power()
        while sign := self.take("·", "/"):
            factor = self.power()
            value = value / factor if sign == "/" else _times(value, factor)
        return value

    def power(self) -> Value:
        value = self.atom()
        while mark := self.take("²", "ᵀ", "⁻¹"):
            value = value * value if mark == "²" else value.T if mark == "ᵀ" else invert(value)
        return value

    def atom(self) -> Value:
        word = self.words[self.place]
        self.place += 1
        if word in self.values:
            return self.values[word]
        if word == "(":
            return self.bracket()[0]
        if word in FUNCTIONS:
            self.place += 1
            return FUNCTIONS[word](*self.bracket())
        return float(word)

    def bracket(self) -> list[Value]:
        """What stands between an opening bracket, already read, and its end."""
        arguments = [self.sum()]
        while self.take(","):
            arguments.append(self.sum())
        self.place += 1
        return arguments


def _times(a: Value, b: Value) -> Value:
    return a @ b if np.ndim(a) and np.ndim(b) else a * b
