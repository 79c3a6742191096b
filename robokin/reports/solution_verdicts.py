"""The first sentence of an answer of `robokin ik`: how many solutions, whether these are all, and why that is known."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from robokin.errors import counted
from robokin.inverse.solutions import Result
from robokin.records.self_motion_records import moves_within, solution_number
from robokin.reports.self_motion_words import joint_names

BLANK = "\N{NO-BREAK SPACE}"
"""Keeps the method's name on one line; it is printed as a blank."""


def verdict(result: Result, idle: Sequence[int] = (), held: str = "", turns: bool = False) -> str:
    """The sentence about a result.

    idle: the joints, from 1, that only move what the task leaves open; held: the joints that are held and their
    values in words, or ""; turns: whether full turns are listed too.
    """
    method = f"({result.method})".replace(" ", BLANK)
    held = f" with {held}" if held else ""
    if not result.reachable:
        # Without a basis the certificate speaks of what was found, which is nothing; the reason says what is known.
        because = "; ".join([*_left(result.counts), *(_certificate(result) if result.all_known else ())])
        return f"no solution{held}: {result.reason}{'; ' if because else ''}{because} {method}"
    rests_on = "".join(f": {sentence}" for sentence in _certificate(result))
    turned = ", full turns included" if turns else ""
    but = f" (any value of {joint_names(idle)})" if idle else ""
    if total := _cut_from(result, turns):
        listed = counted(len(result.solutions), "solution")
        once = ", each self-motion counted once" if any(map(moves_within, result.families)) else ""
        return f"{listed}{held} of all {total}{turned}{once}{but}{rests_on} {method}"
    whole = "these are all" if result.complete else "there may be more"
    if result.families_complete and not result.complete:
        within = " within the limits" if "within_limits" in result.counts else ""
        whole = f"every self-motion{within} is given"
    if result.postures and not result.complete:
        whole = f"these are all{but}"
    listed = counted(len(result.solutions), "solution") if turns else _listed(result)
    return f"{listed}{held}{turned}, {whole}{rests_on} {method}"


def _cut_from(result: Result, turns: bool) -> int:
    """How many solutions a list that was cut is cut from, where all of them are known; 0 for another list."""
    if not result.all_known or result.complete or result.postures:
        return 0
    total = result.counts.get("turns" if turns else "within_limits", result.counts.get("closing", 0))
    return total if total > len(result.solutions) else 0


def _listed(result: Result) -> str:
    """`2 solutions and 1 self-motion`: a solution that stands for a self-motion is counted as that.

    Where all self-motions are known, all solutions are on them: `16 solutions of 8 self-motions`.
    """
    moving = [family for family in result.families if moves_within(family)]
    if result.families_complete and not result.complete and moving and len(moving) == len(result.families):
        return f"{counted(len(result.solutions), 'solution')} of {counted(len(moving), 'self-motion')}"
    standing = {number for family in moving if (number := solution_number(family, result))}
    alone = len(result.solutions) - len(standing)
    parts = [counted(alone, "solution")] if alone or not standing else []
    parts += [counted(len(moving), "self-motion")] if standing else []
    return " and ".join(parts)


def _certificate(result: Result) -> Iterator[str]:
    """What `complete` rests on, or why it is false."""
    if sentence := result.certificate.strip().rstrip("."):
        yield sentence


def _left(counts: Mapping[str, int]) -> Iterator[str]:
    """Where the candidates went of a target without a solution."""
    closing = counts.get("distinct", counts.get("closing", 0))
    if closing and not counts.get("within_limits", counts.get("listed", 0)):
        yield f"{closing} found and closing, 0 within the joint limits"
    elif counts.get("found") and not closing:
        yield f"{counted(counts['found'], 'candidate')} found, 0 closing"
