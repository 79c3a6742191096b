"""Grübler's count as plain data, with the keys that every answer about freedoms has."""

from __future__ import annotations

from typing import Any

from robokin.errors import counted
from robokin.formats.joint_counts import FLAT_CONTACT, LAMBDA, LETTERS
from robokin.mobility.count import grubler, grubler_by_constraints
from robokin.records.envelope import envelope


def bare_record(links: int, counts: dict[str, int], space: str) -> dict[str, Any]:
    """The count's record, with the keys that every answer has."""
    types = [type_record(LETTERS[letter][0], letter, count, _freedoms(letter, space), LAMBDA[space])
             for letter, count in counts.items()]  # fmt: skip
    j = sum(counts.values())
    note = None
    if j < links - 1:
        note = (
            f"{counted(links, 'link')} need at least {counted(links - 1, 'joint')} to hang together; with {j} the "
            "count adds up parts that move independently"
        )
    return {**count_record(None, space, links, types), "kind": "count", "note": note}


def _freedoms(letter: str, space: str) -> int:
    return FLAT_CONTACT if letter == "G" and space != "spatial" else LETTERS[letter][1]


def type_record(name: str, letter: str, count: int, f: int, order: int) -> dict[str, Any]:
    """A line of the bookkeeping: joints of one type."""
    return {"type": name, "letter": letter, "count": count, "freedoms": f, "constraints": order - f}


def count_record(name: str | None, space: str, links: int, types: list[dict[str, Any]]) -> dict[str, Any]:
    """The keys that every answer has, filled as far as a count goes."""
    order = LAMBDA[space]
    f = [record["freedoms"] for record in types for _ in range(record["count"])]
    form, total = grubler_by_constraints(order, links, f), order * len(f) - sum(f)
    return {
        **envelope("name", name, None),
        "space": space,
        "lambda": order,
        "links": links,
        "joints": len(f),
        "freedoms": sum(f),
        "grubler": grubler(order, links, f),
        "constraints": {"form": form, "total": total},
        "mobility": None,
        "mobility_basis": None,
        "overconstraints": None,
        "idle": None,
        "controllable": None,
        "holonomic": None,
        "note": None,
        "loops": max(len(f) - links + 1, 0),
        "types": types,
    }
