"""Numbers that note how they came about, so that what is calculated of some can be calculated of others.

Statement. Code is made for an arm from its numbers (`code_lines`); for an arm that differs in a few of them give the
numbers of its code without making it again.
Derivation. A traced number is a float: whoever calculates with it goes the way that its value leads to. Each operation
is noted as a line of Python, each comparison with what came of it. The lines are compiled as a function of the first
numbers, which answers where all comparisons come out as they did: there the same code would have been made, with the
same operations in the same order.
Degenerate case. Where a comparison comes out otherwise there is no answer (None). What is calculated by other means
than those below is not noted: who traces compares with what is made anew.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from typing import Any

NAME = re.compile(r"\bc\d+\b")
"""A traced number in code."""


class NumberTrace:
    """The operations and comparisons with traced numbers."""

    def __init__(self) -> None:
        self.inputs: list[str] = []
        self.lines: list[tuple[str, str]] = []
        self.outcomes: dict[str, None] = {}

    def given(self, value: float) -> Traced:
        """The next of the first numbers."""
        one = Traced.of(value, self, f"c{len(self.inputs) + len(self.lines)}")
        self.inputs.append(one.name)
        return one

    def noted(self, value: float, source: str) -> Traced:
        """What an operation comes to."""
        one = Traced.of(value, self, f"c{len(self.inputs) + len(self.lines)}")
        self.lines.append((one.name, source))
        return one

    def compared(self, one: Traced, sign: str, other: float, outcome: bool) -> bool:
        """The outcome of a comparison, noted."""
        self.outcomes[f"({one.name} {sign} {_source(other)}) is {outcome}"] = None
        return outcome

    def function(self, wanted: Sequence[str]) -> Callable[[Sequence[float]], tuple[float, ...] | None]:
        """The numbers that are wanted, by their names, of other first numbers; None where these lead elsewhere."""
        conditions = [*self.outcomes]
        asked = {*wanted, *(name for one in conditions for name in NAME.findall(one))}
        kept = []
        for name, source in reversed(self.lines):
            if name in asked:
                asked.update(NAME.findall(source))
                kept.append(f"    {name} = {source}")
        unpacked = [f"    {', '.join(self.inputs)}, = given"] if self.inputs else []
        body = ["def calculated(given):", *unpacked, *reversed(kept)]
        body += [f"    if not ({one}): return None" for one in conditions]
        body.append(f"    return ({''.join(f'{one}, ' for one in wanted)})")
        names: dict[str, Any] = {"sqrt": math.sqrt}
        exec(compile("\n".join(body), "<traced>", "exec"), names)
        found: Callable[[Sequence[float]], tuple[float, ...] | None] = names["calculated"]
        return found


def _source(number: float) -> str:
    return number.name if isinstance(number, Traced) else f"({float(number)!r})"


class Traced(float):
    """A number with its name in a trace."""

    __slots__ = ("name", "trace")
    name: str
    trace: NumberTrace

    @classmethod
    def of(cls, value: float, trace: NumberTrace, name: str) -> Traced:
        """A number of a trace."""
        one = cls(value)
        one.name, one.trace = name, trace
        return one

    def __mul__(self, other: float) -> Traced:
        """A product."""
        return self._after(float.__mul__, other, "*")

    def __rmul__(self, other: float) -> Traced:
        """A product with a number in front."""
        return self._before(float.__mul__, other, "*")

    def __add__(self, other: float) -> Traced:
        """A sum."""
        return self._after(float.__add__, other, "+")

    def __radd__(self, other: float) -> Traced:
        """A sum with a number in front."""
        return self._before(float.__add__, other, "+")

    def __sub__(self, other: float) -> Traced:
        """A difference."""
        return self._after(float.__sub__, other, "-")

    def __rsub__(self, other: float) -> Traced:
        """A difference from a number."""
        return self._before(float.__sub__, other, "-")

    def __truediv__(self, other: float) -> Traced:
        """A quotient."""
        return self._after(float.__truediv__, other, "/")

    def __rtruediv__(self, other: float) -> Traced:
        """A quotient of a number."""
        return self._before(float.__truediv__, other, "/")

    def __neg__(self) -> Traced:
        """The number with the other sign."""
        return self.trace.noted(-float(self), f"-{self.name}")

    def __abs__(self) -> Traced:
        """Its size."""
        return self.trace.noted(abs(float(self)), f"abs({self.name})")

    def root(self) -> Traced:
        """Its square root."""
        return self.trace.noted(math.sqrt(self), f"sqrt({self.name})")

    def __eq__(self, other: object) -> bool:
        """No: that a product with 0 or 1 is spared (`spared_products`) changes no sum, and others may not be that."""
        return False

    def __ne__(self, other: object) -> bool:
        """Yes."""
        return True

    def __lt__(self, other: float) -> bool:
        """Whether it is less."""
        return self.trace.compared(self, "<", other, float(self) < float(other))

    def __le__(self, other: float) -> bool:
        """Whether it is no more."""
        return self.trace.compared(self, "<=", other, float(self) <= float(other))

    def __gt__(self, other: float) -> bool:
        """Whether it is more."""
        return self.trace.compared(self, ">", other, float(self) > float(other))

    def __ge__(self, other: float) -> bool:
        """Whether it is no less."""
        return self.trace.compared(self, ">=", other, float(self) >= float(other))

    def __bool__(self) -> bool:
        """Whether it is anything but 0."""
        return True

    __hash__ = float.__hash__

    def _after(self, operation: Callable[[float, float], float], other: float, sign: str) -> Traced:
        if not isinstance(other, float):
            return NotImplemented
        return self.trace.noted(operation(float(self), float(other)), f"{self.name} {sign} {_source(other)}")

    def _before(self, operation: Callable[[float, float], float], other: float, sign: str) -> Traced:
        if not isinstance(other, float):
            return NotImplemented
        return self.trace.noted(operation(float(other), float(self)), f"{_source(other)} {sign} {self.name}")
