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
from collections.abc import Callable
from functools import cache
from struct import Struct
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from robokin.arrays import Array
from robokin.kernel.code_lines import (
    LONGEST,
    Lines,
    Term,
    folded,
    halves_of,
    made,
    needed,
    tangents_of,
    walked,
    written,
)
from robokin.kernel.columns import ChainProgram
from robokin.kernel.entries import Entry
from robokin.kernel.facts import fact

if TYPE_CHECKING:
    from robokin.kernel.chain_walk import Column

SAMPLES = 4096
"""Angles at which numpy's tangent and the C library's are compared: where they are two functions, one in two hundred
differs in its last digit."""

Straight = Callable[[list[float]], Array]
"""A function of n joint values [rad | m]; it raises ValueError where one is infinite, or there are not n."""


StraightResiduals = Callable[[list[list[float]], list[float]], list[tuple[float, float]]]
"""A function of some rows of n joint values [rad | m], all finite, and of the columns x, y, z, p of a target: of each
row the distance [m] and the angle [rad] that are missing."""


@fact
def straight_frame(program: ChainProgram) -> Straight | None:
    """The frame (4, 4) [m] that a program leads to, as a function of one configuration; None where there is no code."""
    if not _worth_while(program):
        return None
    code = _ChainCode(program)
    (frame,) = code.frames()
    rows = [[column[k] for column in frame] for k in range(3)]
    entries = [written(entry) for row in rows for entry in row]
    return code.compiled([*entries, "0.0", "0.0", "0.0", "1.0"], (4, 4))


@fact
def straight_jacobian(program: ChainProgram, tool: bool) -> Straight | None:
    """The geometric Jacobian of a program that leads to every joint and to the tool, by columns: (n, 6) [m | 1].

    With `tool` the rows x, y, z of the tool's rotation follow: (n + 2, 6), of which the last 3 numbers are 0. None
    where there is no code.
    """
    if not _worth_while(program):
        return None
    code = _ChainCode(program)
    *starts, end = code.frames()
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
    return code.compiled([written(entry) for entry in entries], (program.n + 2 * tool, 6))


@fact
def straight_residuals(program: ChainProgram) -> StraightResiduals | None:
    """How far the frames that a program leads to are from a target; None where there is no code.

    As `residual.TargetPoses` has it: the angle is the chord |R_a - R_b| / √2.
    """
    if not _worth_while(program):
        return None
    before: Lines = []
    halves = [half.name for half in halves_of(program, before)[1]]
    lines: Lines = []
    given = [Term.named(lines, f"h{k}") for k in range(len(halves))]
    (frame,) = walked(program, lines, halves_of(program, lines)[0], given)
    targets: list[Any] = [Term.named(lines, f"t{k}") for k in range(12)]
    entries = [entry for column in frame for entry in column]
    off = [target - entry for target, entry in zip(targets, entries, strict=True)]
    sums = []
    for part in (off[9:], off[:9]):
        total = part[0] * part[0]
        for one in part[1:]:
            total = total + one * one
        sums.append(total.name)
    lines, sums = folded(lines, sums)
    values = ", ".join(f"q{i}" for i in range(program.n))
    body = ["def straight(rows, target):", f"    {', '.join(target.name for target in targets)} = target"]
    body += ["    halves, off, k = [], [], 0", f"    for {values}, in rows:", *needed(before, halves)]
    body += [
        f"        halves += ({''.join(f'{half}, ' for half in halves)})",
        "    tangents = tan(array(halves)).tolist()",
    ]
    body += [f"    for {values}, in rows:"]
    if given:
        body += [f"        {', '.join(half.name for half in given)}, = tangents[k : k + {len(given)}]"]
        body += [f"        k += {len(given)}"]
    body += [*needed(lines, sums), f"        off.append((sqrt({sums[0]}), sqrt({sums[1]} * 0.5)))", "    return off"]
    return cast(StraightResiduals, made(body, array=np.array, tan=np.tan))


def _worth_while(program: ChainProgram) -> bool:
    return 0 < program.n <= LONGEST


class _ChainCode:
    """The lines of a function that takes one configuration of a program and returns an array."""

    def __init__(self, program: ChainProgram) -> None:
        self.program = program
        self.lines: Lines = []
        self.begin = [f"    {', '.join(f'q{i}' for i in range(program.n))}, = q"]

    def frames(self) -> list[tuple[Column, Column, Column, Column]]:
        """The frames of the program in terms whose lines are noted."""
        values, halves = halves_of(self.program, self.lines)
        if same_tangents() or not halves:
            return walked(self.program, self.lines, values, tangents_of(halves, self.lines))
        # An array of angles: if their sum is finite all of them are, and nothing can be said of them.
        names = [half.name for half in halves]
        self.begin += needed(self.lines, names, "    ")
        given = [Term.named(self.lines, f"h{k}") for k in range(len(halves))]
        ask = f"(tangents if ({' + '.join(names)}) * 0.0 == 0.0 else quiet_tangents)({', '.join(names)})"
        self.begin += [f"    {', '.join(one.name for one in given)}, = {ask}"]
        return walked(self.program, self.lines, values, given)

    def compiled(self, entries: list[str], shape: tuple[int, int]) -> Straight:
        """The function that returns the entries as an array of this shape."""
        lines, entries = folded(self.lines, entries)
        body = ["def straight(q):", *self.begin, *needed(lines, entries, "    ")]
        body += [f"    found = empty({shape})", f"    fill(found, 0, {', '.join(entries)})", "    return found"]
        tangents = _tangents_of(len(self.program.turning))

        def quiet_tangents(*halves: float) -> list[float]:
            with np.errstate(invalid="ignore"):  # of an infinite angle, for which the batch says nothing either
                return tangents(*halves)

        names = {"empty": np.empty, "fill": Struct(f"{len(entries)}d").pack_into}
        return cast(Straight, made(body, tangents=tangents, quiet_tangents=quiet_tangents, **names))


def _tangents_of(count: int) -> Callable[..., list[float]]:
    """numpy's tangents of some angles, as floats."""
    fill: Callable[..., None] = Struct(f"{count}d").pack_into
    empty, tan = np.empty, np.tan

    def tangents(*halves: float) -> list[float]:
        angles = empty(count)
        fill(angles, 0, *halves)
        found: list[float] = tan(angles, angles).tolist()
        return found

    return tangents


@cache
def same_tangents() -> bool:
    """Whether numpy's tangent is the C library's: on some processors it has its own, with other last digits."""
    angles = np.random.default_rng(7).uniform(-2.0, 2.0, SAMPLES)
    return bool(np.tan(angles).tolist() == [math.tan(angle) for angle in angles.tolist()])
