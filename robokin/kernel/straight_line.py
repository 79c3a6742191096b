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
from robokin.kernel.code_lines import LONGEST, Lines, Term, halves_of, made, needed, tangents_of, walked, written
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
    lines: Lines = []
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
    lines: Lines = []
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
    before: Lines = []
    halves = [half.name for half in halves_of(program, before)[1]]
    lines: Lines = []
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
    return cast(StraightResiduals, _made(program, body, array=np.array, tan=np.tan))


def _worth_while(program: ChainProgram) -> bool:
    return 0 < program.n <= LONGEST


def _walked(
    program: ChainProgram, lines: Lines, given: list[Term] | None = None
) -> list[tuple[Column, Column, Column, Column]]:
    """The frames of a program in terms whose lines are noted, with the tangents of the halves where they are given."""
    values, halves = halves_of(program, lines)
    if given is not None:
        tangents = given
    elif same_tangents():
        tangents = tangents_of(halves, lines)
    else:
        together = Term(lines, f"tangents({', '.join(half.name for half in halves)})")
        tangents = [Term(lines, f"{together.name}[{k}]") for k in range(len(halves))]
    return walked(program, lines, values, tangents)


def _compiled(program: ChainProgram, lines: Lines, entries: list[str], shape: tuple[int, int]) -> Straight:
    """The function that returns the entries as an array of this shape."""
    body = ["def straight(q):", f"    {', '.join(f'q{i}' for i in range(program.n))}, = q"]
    body += needed(lines, entries, "    ")
    body += [f"    found = empty({shape})", f"    fill(found, 0, {', '.join(entries)})", "    return found"]
    return cast(Straight, _made(program, body, fill=Struct(f"{len(entries)}d").pack_into))


def _made(program: ChainProgram, body: list[str], **names: Any) -> Any:
    """The function of some lines, which may use these names besides its own."""
    names = {"empty": np.empty, "tangents": _tangents_of(len(program.turning)), **names}
    return made(body, **names)


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
