"""Code without a loop for one configuration of a chain, made once from the chain's numbers.

Statement. Give the tool's frame and the geometric Jacobian at one configuration in a few microseconds: numpy's share of
one call is about one microsecond, and columns of a single number take a hundred of them.
Derivation. The chain's program (`columns`) is walked once with terms in place of arrays. Each operation on terms is
noted as a line of Python, in the order in which the arrays would be touched; what nothing asks for is left out, and the
rest is compiled as one function of floats. So the results are those of a batch, bit by bit: both are sums and products
of floats in one order, and tangents are numpy's where those of the C library differ from them.
The source holds numbers, names that are made here and nothing else.
Degenerate case. Of a long chain the code would take longer to compile than it ever saves: `LONGEST`. Where the
compiled function cannot say what numpy says (tan of infinity) it raises ValueError, and the batch is asked.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Callable
from functools import cache
from struct import Struct
from typing import Any, cast

import numpy as np

from robokin.arrays import Array
from robokin.kernel.columns import ChainProgram, Column, Entries
from robokin.kernel.entries import Entry
from robokin.kernel.facts import fact

LONGEST = 64
"""Joints of a chain up to which code is made: compiling takes about 0.1 ms for each."""

SAMPLES = 4096
"""Angles at which numpy's tangent and the C library's are compared: where they are two functions, one in two hundred
differs in its last digit."""

NAME = re.compile(r"\bv\d+")
"""What a line assigns to."""

PRODUCT = re.compile(r"v\d+ \* v\d+")

Straight = Callable[[list[float]], Array]
"""A function of n joint values [rad | m]; it raises ValueError where one is infinite, or there are not n."""


StraightResiduals = Callable[[list[list[float]], list[float]], list[tuple[float, float]]]
"""A function of some rows of n joint values [rad | m], all finite, and of the columns x, y, z, p of a target: of each
row the distance [m] and the angle [rad] that are missing."""


class Term:
    """An entry that is a line of code: `name` is what the line assigns to, `lines` where it is noted."""

    __slots__ = ("lines", "name")

    def __init__(self, lines: list[tuple[str, str]], source: str) -> None:
        self.lines = lines
        self.name = f"v{len(lines)}"
        lines.append((self.name, source))

    @classmethod
    def named(cls, lines: list[tuple[str, str]], name: str) -> Term:
        """A term that is there without a line, such as an argument."""
        one = object.__new__(cls)
        one.lines, one.name = lines, name
        return one

    def __mul__(self, other: Term | float) -> Term:
        """A product."""
        return Term(self.lines, f"{self.name} * {written(other)}")

    def __rmul__(self, other: float) -> Term:
        """A product with a number in front."""
        return Term(self.lines, f"{written(other)} * {self.name}")

    def __add__(self, other: Term | float) -> Term:
        """A sum."""
        return Term(self.lines, f"{self.name} + {written(other)}")

    def __radd__(self, other: float) -> Term:
        """A sum with a number in front."""
        return Term(self.lines, f"{written(other)} + {self.name}")

    def __sub__(self, other: Term | float) -> Term:
        """A difference."""
        return Term(self.lines, f"{self.name} - {written(other)}")

    def __rsub__(self, other: float) -> Term:
        """A difference from a number."""
        return Term(self.lines, f"{written(other)} - {self.name}")

    def __truediv__(self, other: Term | float) -> Term:
        """A quotient."""
        return Term(self.lines, f"{self.name} / {written(other)}")

    def __neg__(self) -> Term:
        """The term with the other sign."""
        return Term(self.lines, f"-{self.name}")


def written(entry: Any) -> str:
    """A term's name, or a number with all its digits, negative ones in brackets."""
    if isinstance(entry, Term):
        return entry.name
    number = float(entry)
    return repr(number) if math.copysign(1.0, number) > 0.0 else f"({number!r})"


@fact
def straight_frame(program: ChainProgram) -> Straight | None:
    """The frame (4, 4) [m] that a program leads to, as a function of one configuration; None where there is no code."""
    if not _worth_while(program):
        return None
    lines: list[tuple[str, str]] = []
    (frame,) = _walked(program, lines)
    rows = [[column[k] for column in frame] for k in range(3)]
    entries = [written(entry) for row in rows for entry in row]
    entries[3::4] = [written(entry) for entry in frame[3]]
    return _compiled(program, lines, [*entries, "0.0", "0.0", "0.0", "1.0"], (4, 4))


@fact
def straight_jacobian(program: ChainProgram, tool: bool) -> Straight | None:
    """The geometric Jacobian of a program that leads to every joint and to the tool, by columns: (n, 6) [m | 1].

    With `tool` the rows x, y, z of the tool's rotation follow: (n + 2, 6), of which the last 3 numbers are 0. None
    where there is no code.
    """
    if not _worth_while(program):
        return None
    lines: list[tuple[str, str]] = []
    *starts, end = _walked(program, lines)
    entries: list[Entry] = []
    for turn, (_, _, z, o) in zip(program.turns, starts, strict=True):
        if turn is None:
            entries += [*z, 0.0, 0.0, 0.0]
            continue
        x, y, w = (p - q for p, q in zip(end[3], o, strict=True))
        entries += [z[1] * w - z[2] * y, z[2] * x - z[0] * w, z[0] * y - z[1] * x, *z]
    if tool:
        entries += [column[k] for k in range(3) for column in end[:3]]
        entries += [0.0, 0.0, 0.0]
    return _compiled(program, lines, [written(entry) for entry in entries], (program.n + 2 * tool, 6))


@fact
def straight_residuals(program: ChainProgram) -> StraightResiduals | None:
    """How far the frames that a program leads to are from a target; None where there is no code.

    As `residual.TargetPoses` has it: the angle is the chord |R_a - R_b| / √2.
    """
    if not _worth_while(program):
        return None
    before: list[tuple[str, str]] = []
    halves = [half.name for half in _halves(program, before)[1]]
    lines: list[tuple[str, str]] = []
    given = [Term.named(lines, f"h{k}") for k in range(len(halves))]
    (frame,) = _walked(program, lines, given)
    targets: list[Any] = [Term.named(lines, f"t{k}") for k in range(12)]
    entries = [entry for column in frame for entry in column]
    off = [target - entry for target, entry in zip(targets, entries, strict=True)]
    sums = []
    for part in (off[9:], off[:9]):
        total = part[0] * part[0]
        for one in part[1:]:
            total = total + one * one
        sums.append(total.name)
    values = ", ".join(f"q{i}" for i in range(program.n))
    body = ["def straight(rows, target):", f"    {', '.join(target.name for target in targets)} = target"]
    body += ["    halves, off, k = [], [], 0", f"    for {values}, in rows:", *_needed(before, halves)]
    body += [
        f"        halves += ({''.join(f'{half}, ' for half in halves)})",
        "    tangents = tan(array(halves)).tolist()",
    ]
    body += [f"    for {values}, in rows:"]
    if given:
        body += [f"        {', '.join(half.name for half in given)}, = tangents[k : k + {len(given)}]"]
        body += [f"        k += {len(given)}"]
    body += [*_needed(lines, sums), f"        off.append((sqrt({sums[0]}), sqrt({sums[1]} * 0.5)))", "    return off"]
    return cast(StraightResiduals, _made(program, body, array=np.array, tan=np.tan))


def _worth_while(program: ChainProgram) -> bool:
    return 0 < program.n <= LONGEST


def _halves(program: ChainProgram, lines: list[tuple[str, str]]) -> tuple[list[Term], list[Term]]:
    """The values of the joints q0, q1, … as the program takes them, and the halves of the angles that turn."""
    values: list[Term] = []
    for i, factor in enumerate(program.factors[:, 0].tolist()):
        value = f"q{i}" if factor == 1.0 else f"q{i} * {written(factor)}"
        if program.offsets is not None:
            value += f" + {written(program.offsets[i, 0])}"
        values.append(Term(lines, value))
    for i in program.sums:
        values[i] += values[i - 1]
    return values, [values[i] for i in program.turning]


def _walked(
    program: ChainProgram, lines: list[tuple[str, str]], given: list[Term] | None = None
) -> list[tuple[Column, Column, Column, Column]]:
    """The frames of a program in terms whose lines are noted, with the tangents of the halves where they are given."""
    values, halves = _halves(program, lines)
    if given is not None:
        tangents = given
    elif same_tangents():
        tangents = [Term(lines, f"tan({half.name})") for half in halves]
    else:
        together = Term(lines, f"tangents({', '.join(half.name for half in halves)})")
        tangents = [Term(lines, f"{together.name}[{k}]") for k in range(len(halves))]
    cosines, sines = [], []
    for t in tangents:
        r = Term(lines, f"2.0 / ({t.name} * {t.name} + 1.0)")
        sines.append(t * r)
        cosines.append(r - 1.0)
    entries = (cast(Entries, part) for part in (values, cosines, sines))
    return list(program.walk(*entries))


def _compiled(
    program: ChainProgram, lines: list[tuple[str, str]], entries: list[str], shape: tuple[int, int]
) -> Straight:
    """The function that returns the entries as an array of this shape."""
    body = ["def straight(q):", f"    {', '.join(f'q{i}' for i in range(program.n))}, = q"]
    body += _needed(lines, entries, "    ")
    body += [f"    found = empty({shape})", f"    fill(found, 0, {', '.join(entries)})", "    return found"]
    return cast(Straight, _made(program, body, fill=Struct(f"{len(entries)}d").pack_into))


def _needed(lines: list[tuple[str, str]], entries: list[str], deep: str = "        ") -> list[str]:
    """The lines of code that the entries ask for."""
    asked = Counter(entries)
    kept: list[tuple[str, str]] = []
    for name, source in reversed(lines):
        if asked[name]:
            asked.update(NAME.findall(source))
            kept.append((name, source))
    inside: dict[str, str] = {}
    found = []
    for name, source in reversed(kept):
        whole = NAME.sub(lambda found: inside.get(found[0], found[0]), source)
        if asked[name] == 1 and name not in entries and PRODUCT.fullmatch(whole):
            inside[name] = f"({whole})"  # a line less, for a product that is asked for once
        else:
            found.append(f"{deep}{name} = {whole}")
    return found


def _made(program: ChainProgram, body: list[str], **names: Any) -> Any:
    """The function of some lines, which may use these names besides its own."""
    names = {"empty": np.empty, "sqrt": math.sqrt, "tan": math.tan, "inf": math.inf, "nan": math.nan, **names}
    names.setdefault("tangents", _tangents_of(len(program.turning)))
    exec(compile("\n".join(body), "<straight line>", "exec"), names)
    return names["straight"]


def _tangents_of(count: int) -> Callable[..., list[float]]:
    """numpy's tangents of some angles, as floats."""
    fill: Callable[..., None] = Struct(f"{count}d").pack_into

    def tangents(*halves: float) -> list[float]:
        angles = np.empty(count)
        fill(angles, 0, *halves)
        with np.errstate(invalid="ignore"):  # of an infinite angle, for which the batch says nothing either
            found: list[float] = np.tan(angles, angles).tolist()
        return found

    return tangents


@cache
def same_tangents() -> bool:
    """Whether numpy's tangent is the C library's: on some processors it has its own, with other last digits."""
    angles = np.random.default_rng(7).uniform(-2.0, 2.0, SAMPLES)
    return bool(np.tan(angles).tolist() == [math.tan(angle) for angle in angles.tolist()])
