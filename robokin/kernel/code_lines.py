"""Lines of code made of a chain's numbers: terms that stand for entries and note what is done with them.

See `straight_line` for what they are made for. Nothing is loaded here: one configuration needs no arrays.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Callable, Sequence

from robokin.kernel.chain_walk import ChainWalk

TYPE_CHECKING = False  # `typing` has the same, and takes a while to load
if TYPE_CHECKING:
    from typing import Any, Self

    from robokin.kernel.chain_walk import Column

LONGEST = 64
"""Joints of a chain up to which code is made: compiling takes about 0.1 ms for each."""

NAME = re.compile(r"\bv\d+")
"""What a line assigns to."""

SHORT = 40
"""Characters of a line that may stand inside of another one."""

Lines = list[tuple[str, str]]
"""Lines of code: what each assigns to, and what."""

PlainFrame = Callable[[Sequence[float]], tuple[float, ...]]
"""A function of n finite joint values [rad | m]: the three rows of a frame, twelve numbers [m]."""


class Term:
    """An entry that is a line of code: `name` is what the line assigns to, `lines` where it is noted."""

    __slots__ = ("lines", "name")

    def __init__(self, lines: Lines, source: str) -> None:
        self.lines = lines
        self.name = f"v{len(lines)}"
        lines.append((self.name, source))

    @classmethod
    def named(cls, lines: Lines, name: str) -> Self:
        """A term that is there without a line, such as an argument."""
        one = object.__new__(cls)
        one.lines, one.name = lines, name
        return one

    def __mul__(self, other: Term | float) -> Self:
        """A product."""
        return type(self)(self.lines, f"{self.name} * {written(other)}")

    def __rmul__(self, other: float) -> Self:
        """A product with a number in front."""
        return type(self)(self.lines, f"{written(other)} * {self.name}")

    def __add__(self, other: Term | float) -> Self:
        """A sum."""
        return type(self)(self.lines, f"{self.name} + {written(other)}")

    def __radd__(self, other: float) -> Self:
        """A sum with a number in front."""
        return type(self)(self.lines, f"{written(other)} + {self.name}")

    def __sub__(self, other: Term | float) -> Self:
        """A difference."""
        return type(self)(self.lines, f"{self.name} - {written(other)}")

    def __rsub__(self, other: float) -> Self:
        """A difference from a number."""
        return type(self)(self.lines, f"{written(other)} - {self.name}")

    def __truediv__(self, other: Term | float) -> Self:
        """A quotient."""
        return type(self)(self.lines, f"{self.name} / {written(other)}")

    def __neg__(self) -> Self:
        """The term with the other sign."""
        return type(self)(self.lines, f"-{self.name}")


def written(entry: Any) -> str:
    """A term's name, or a number with all its digits, negative ones in brackets."""
    name: str | None = getattr(entry, "name", None)  # of a term, or of a number that is traced
    if name is not None:
        return name
    number = float(entry)
    return repr(number) if math.copysign(1.0, number) > 0.0 else f"({number!r})"


def halves_of(program: ChainWalk, lines: Lines) -> tuple[list[Term], list[Term]]:
    """The values of the joints q0, q1, … as the program takes them, and the halves of the angles that turn."""
    values: list[Term] = []
    for i, factor in enumerate(program.scales):
        value = f"q{i}" if factor == 1.0 else f"q{i} * {written(factor)}"
        if program.starts is not None:
            value += f" + {written(program.starts[i])}"
        values.append(Term(lines, value))
    for i in program.sums:
        values[i] += values[i - 1]
    return values, [values[i] for i in program.turning]


def tangents_of(halves: list[Term], lines: Lines) -> list[Term]:
    """The tangents of some angles, by the C library."""
    return [Term(lines, f"tan({half.name})") for half in halves]


def walked(
    program: ChainWalk, lines: Lines, values: list[Term], tangents: list[Term]
) -> list[tuple[Column, Column, Column, Column]]:
    """The frames of a program in terms whose lines are noted."""
    cosines, sines = [], []
    for t in tangents:
        r = Term(lines, f"2.0 / ({t.name} * {t.name} + 1.0)")
        sines.append(t * r)
        cosines.append(r - 1.0)
    entries: Any = values, cosines, sines
    return list(program.walk(*entries))


def plain_frame(program: ChainWalk) -> PlainFrame:
    """The frame that a program leads to as a function of one configuration, with the C library's tangents."""
    lines: Lines = []
    values, halves = halves_of(program, lines)
    (frame,) = walked(program, lines, values, tangents_of(halves, lines))
    entries = [written(column[k]) for k in range(3) for column in frame]
    body = ["def straight(q):", f"    {', '.join(f'q{i}' for i in range(program.n))}, = q"]
    body += [*needed(lines, entries, "    "), f"    return {', '.join(entries)}"]
    plain: PlainFrame = made(body)
    return plain


def needed(lines: Lines, entries: list[str], deep: str = "        ") -> list[str]:
    """The lines of code that the entries ask for."""
    asked = Counter(name for entry in entries for name in NAME.findall(entry))
    last = {*asked}
    kept: Lines = []
    for name, source in reversed(lines):
        if asked[name]:
            asked.update(NAME.findall(source))
            kept.append((name, source))
    inside: dict[str, str] = {}
    found = []
    for name, source in reversed(kept):
        whole = NAME.sub(lambda found: inside.get(found[0], found[0]), source)
        if asked[name] == 1 and name not in last and len(whole) < SHORT:
            inside[name] = f"({whole})"  # a line less, for what is asked for once
        else:
            found.append(f"{deep}{name} = {whole}")
    return found


def folded(lines: Lines, entries: list[str]) -> tuple[Lines, list[str]]:
    """Lines and entries that come to the same, bit by bit, without changes of sign, - 0.0 and 1.0 *.

    a + (-b) is a - b and (-a) b is -(a b) to the last bit, also where one of them is 0.
    """
    known: dict[str, tuple[bool, str]] = {}
    """What stands for a name: whether with the other sign, and a name, which may be its own."""
    found: Lines = []

    def meant(name: str) -> tuple[bool, str]:
        return known.get(name, (False, name))

    def said(name: str) -> str:
        minus, other = meant(name)
        return f"(-{other})" if minus else other

    for name, source in lines:
        match source.split(" "):
            case [one] if NAME.fullmatch(one[1:]) and one[0] == "-":
                minus, other = meant(one[1:])
                known[name] = (not minus, other)
            case ["1.0", "*", one] | [one, "-", "0.0"]:
                known[name] = meant(one)
            case [left, "*", right]:
                (minus, a), (less, b) = meant(left), meant(right)
                known[name] = (minus != less, name)
                found.append((name, f"{a} * {b}"))
            case [left, "+" | "-" as sign, right]:
                (minus, a), (less, b) = meant(left), meant(right)
                less = less != (sign == "-")
                if minus and not less:
                    minus, a, less, b = less, b, minus, a
                found.append((name, f"{'-' * minus}{a} {'-' if less else '+'} {b}"))
            case _:
                found.append((name, NAME.sub(lambda one: said(one[0]), source)))
    return found, [said(entry) for entry in entries]


def made(body: list[str], **names: Any) -> Any:
    """The function of some lines, which may use these names besides some of `math`."""
    known = {"sqrt": math.sqrt, "tan": math.tan, "inf": math.inf, "nan": math.nan, **names}
    exec(compile("\n".join(body), "<straight line>", "exec"), known)
    return known["straight"]
