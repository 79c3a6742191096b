"""Fields of a result that are found when they are first asked for: self-motions, proofs, and what comes nearest.

Statement. To look at a result costs what is looked at: whether a pose is reached is known long before what comes
nearest to it, which is a search, or what its self-motions are, which are followed, or what else proves that there is
no solution.
Derivation. A result without such fields holds a function that gives them by name, and takes them from it when it is
asked (`Result.__getattr__`). Others made of it (`changed`) hold the same function.
Degenerate case. Copies and pickles: what is nearest is found for them, since what finds it knows a block of targets.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, TypeVar

MOTIONS, WHY, PROOF, QUESTION = "_alone", "_why", "_proof", "_question"
"""Where a result keeps the functions."""

FOUND_BY = {
    "families": MOTIONS, "families_complete": MOTIONS, "reason": WHY, "nearest": WHY, "basis": PROOF,
    "certificate": PROOF, "question": QUESTION,
}  # fmt: skip
"""Which of them finds a field."""

Kept = TypeVar("Kept")


def nothing_yet() -> None:
    """No value, for a field that the class itself must have none of: an instance may find it later."""


def with_later_families(result: Kept, alone: Callable[[], Any]) -> Kept:
    """A result whose self-motions are those of the answer for its target alone, found when they are first asked for."""
    return _with_later(result, MOTIONS, ("families", "families_complete"), partial(_families, alone))


def with_later_nearest(result: Kept, reason: str | None, find: Callable[[], tuple[str, Any]]) -> Kept:
    """A result without solutions whose nearest configuration is found when it is first asked for.

    find: gives the reason and the configuration; reason: None where it is not known before.
    """
    unknown = ("nearest", "reason") if reason is None else ("nearest",)
    one = result if reason is None else changed(result, reason=reason)
    return _with_later(one, WHY, unknown, partial(_why, find))


def with_later_proof(result: Kept, find: Callable[[], tuple[str, str]]) -> Kept:
    """A result whose basis and certificate, which `find` gives, are found when they are first asked for."""
    return _with_later(result, PROOF, ("basis", "certificate"), partial(_proof, find))


def nearest_unknown(result: object) -> bool:
    """Whether a result's nearest configuration is still to be found."""
    return WHY in vars(result)


def changed(result: Kept, **others: Any) -> Kept:
    """A result with some other fields. What is not found yet stays so, for which `dataclasses.replace` would ask."""
    known = vars(result)  # makes a result that was not made yet, and its class with it
    one = object.__new__(type(result))
    one.__dict__.update(known, **others)
    return one


def _with_later(result: Kept, place: str, unknown: tuple[str, ...], find: Callable[[], dict[str, Any]]) -> Kept:
    known = {name: value for name, value in vars(result).items() if name not in unknown}
    one = object.__new__(type(result))
    one.__dict__.update(known, **{place: find})
    return one


def _families(alone: Callable[[], Any]) -> dict[str, Any]:
    result = alone()
    return {"families": result.families, "families_complete": result.families_complete}


def _why(find: Callable[[], tuple[str, Any]]) -> dict[str, Any]:
    reason, nearest = find()
    return {"reason": reason, "nearest": nearest}


def _proof(find: Callable[[], tuple[str, str]]) -> dict[str, Any]:
    basis, certificate = find()
    return {"basis": basis, "certificate": certificate}
