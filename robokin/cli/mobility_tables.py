"""Freedoms for eyes: the bookkeeping, the count in both forms, the truth beside it and why."""

from __future__ import annotations

from typing import Any

from robokin.cli.output.numbers import counted
from robokin.cli.output.tables import heading, pairs, render, table

VERDICTS = {
    "right": "the count is right",
    "exceptional": "exceptional: the count is wrong for these dimensions",
    "singular": "singular pose: it can do more here than elsewhere",
    "shaky": "shaky: some of its motions are only a tremble",
    "nearly": "nearly mobile: the dimensions are not exact",
    "disconnected": "disconnected: there is no one mechanism to count",
    "counted": "counted only: without geometry nobody knows",
}
"""Verdicts in words."""


def mobility_table(record: dict[str, Any]) -> bytes:
    """The answer about a mechanism, a robot, or bare numbers."""
    space = f"{record['space']}, λ = {record['lambda']}"
    parts: list[Any] = [heading(record["name"] or "Grübler's count", space), "", _joints(record), ""]
    parts += [pairs(_count(record))]
    if record["kind"] == "mechanism":
        parts += ["", _side_by_side(record), "", pairs(_mechanism_entries(record))]
    elif record["kind"] == "robot":
        parts += ["", pairs(_robot_entries(record))]
    elif record["note"]:
        parts += ["", pairs([("note", record["note"])])]
    return render(*parts)


def _joints(record: dict[str, Any]) -> Any:
    drawn = table()
    for name in ("joint", "type", "number", "f", "C = λ − f"):
        drawn.add_column(name, justify="left" if name in ("joint", "type") else "right", no_wrap=True)
    for joint in record["types"]:
        numbers = (joint["count"], joint["freedoms"], joint["constraints"])
        drawn.add_row(joint["type"], joint["letter"], *map(str, numbers))
    if record["types"]:
        drawn.add_section()
    sums = (f"j = {record['joints']}", f"Σf = {record['freedoms']}", f"ΣC = {record['constraints']['total']}")
    drawn.add_row("sum", "", *sums)
    return drawn


def _count(record: dict[str, Any]) -> list[tuple[str, str]]:
    order, n, j, f = (record[key] for key in ("lambda", "links", "joints", "freedoms"))
    form, total = record["constraints"]["form"], record["constraints"]["total"]
    first = f"{order}({n} − {j} − 1) + {f}"
    second = f"{order}({n} − 1) − {total}"
    width = max(len(first), len(second))
    return [
        ("links", f"n = {n}, the ground included"),
        ("loops", str(record["loops"])),
        ("count", f"F = λ(n − j − 1) + Σf = {first:<{width}} = {record['grubler']}"),
        ("", f"F = λ(n − 1) − ΣC     = {second:<{width}} = {form}"),
    ]


def _side_by_side(record: dict[str, Any]) -> Any:
    drawn = table()
    for name in ("count", "truth"):
        drawn.add_column(name, justify="right", no_wrap=True)
    drawn.add_column("verdict", overflow="fold")
    truth = "?" if record["mobility"] is None else str(record["mobility"])
    drawn.add_row(str(record["grubler"]), truth, VERDICTS[record["verdict"]])
    return drawn


def _mechanism_entries(record: dict[str, Any]) -> list[tuple[str, str]]:
    entries = [("why", _why(record))]
    if record["mobility"] is not None:
        if record["overconstraints"]:
            of = counted(record["lambda"] * record["loops"], "constraint")
            entries.append(("redundant", f"{record['overconstraints']} of the {of} that the loops make"))
        if record["idle"]:
            do = "does" if record["idle"] == 1 else "do"
            what = "the output" if record["output"] else "anything else"
            entries.append(("idle", f"{_freedoms(record['idle'])} that {do} not move {what}"))
        if record["dead_joints"]:
            entries.append(("dead", f"{_joints_named(record['dead_joints'])}, held by the others"))
        entries += _output_entries(record) + _drive_entries(record)
        entries += _numbers_entries(record)
    entries += [("look at", sentence) for sentence in record["slips"]]
    if record["as_expected"] is not None:
        stated = ", ".join(f"{name} {value}" for name, value in record["expected"].items())
        entries.append(("the file", f"{'agrees' if record['as_expected'] else 'differs'}: it states {stated}"))
    return entries


def _why(record: dict[str, Any]) -> str:
    """The sentence; where nothing is special, that."""
    if record["note"]:
        return str(record["note"])
    if not record["loops"]:
        return "there is no loop, so nothing keeps a joint from moving"
    return "the constraints of the loops are independent, so each takes one freedom away, as the count has it"


def _output_entries(record: dict[str, Any]) -> list[tuple[str, str]]:
    output = record["output"]
    if output is None:
        return []
    kind = f": {output['kind']}" if output["freedoms"] else ": it stands still"
    return [("output", f"{output['link']} against {output['against']} has {_freedoms(output['freedoms'])}{kind}")]


def _drive_entries(record: dict[str, Any]) -> list[tuple[str, str]]:
    if record["undriven"] is None:
        return []
    driven, left, of = counted(record["actuated"], "actuated joint"), record["undriven"], record["mobility"]
    text = f"{record['controllable']} of {_freedoms(of)} by {driven}"
    if left:
        text += f"; {_freedoms(left)} left undriven"
        if record["output"] is not None:
            rest = record["output_undriven"]
            text += ", none of the output" if not rest else f", {rest} of the output"
    elif record["actuated"] > record["mobility"]:
        text += ": more drives than freedoms, they can work against one another"
    ratio = "holonomic: CDOF = TDOF" if record["holonomic"] else "CDOF < TDOF"
    return [("controllable", f"{text} ({ratio})")]


def _numbers_entries(record: dict[str, Any]) -> list[tuple[str, str]]:
    """The singular values on both sides of the gap."""
    values, (least, rest) = record["singular_values"], record["gap"]
    count = sum(value >= least for value in values) if least else 0
    if not values:
        return []
    down = f"{_counting(count)}, down to {least:.2g} of the greatest"
    return [("gap", f"{down}; {'there is no other' if count == len(values) else f'the next is {_size(rest)}'}")]


def _counting(count: int) -> str:
    return f"{counted(count, 'singular value')} of the loops {'counts' if count == 1 else 'count'}"


def _size(value: float) -> str:
    return f"{value:.2g}" if value else "0"


def _robot_entries(record: dict[str, Any]) -> list[tuple[str, str]]:
    n, m, r = record["controllable"], record["total"], record["redundancy"]
    relation = "=" if n == m else ">" if n > m else "<"
    word = "holonomic" if record["holonomic"] else "nonholonomic"
    entries = [
        ("mobility", f"{record['mobility']}: a chain without loops moves in every joint"),
        ("controllable", f"CDOF = {n}, its joints, each with a drive"),
        ("total", f"TDOF = M = {m}, the freedoms of what its hand can reach"),
        ("redundancy", f"R = N − M = {n} − {m} = {r}"),
        ("so it is", f"{word}: CDOF {relation} TDOF"),
    ]
    return [*entries, ("note", record["note"])] if record["note"] else entries


def wheeled_table(record: dict[str, Any]) -> bytes:
    """The answer about a wheeled base."""
    mobility, steering = record["mobility"], record["steerability"]
    kinds: dict[str, int] = {}
    for wheel in record["wheels"]:
        kinds[wheel["type"]] = kinds.get(wheel["type"], 0) + 1
    bound = kinds.get("fixed", 0) + kinds.get("steered", 0)
    rank = record["total"] - mobility
    drawn = table()
    for name in ("degree of", ""):
        drawn.add_column(name, no_wrap=True, justify="right" if not name else "left")
    drawn.add_column("is")
    rows = f"{rank} of {counted(bound, 'wheel')} that cannot slip sideways" if bound else "0, no wheel is bound"
    drawn.add_row("mobility", f"δm = {mobility}", f"3 − rank of the constraints ({rows})")
    drawn.add_row("steerability", f"δs = {steering}", "wheels that can be steered on their own")
    drawn.add_row("manoeuvrability", f"δM = {mobility + steering}", "δm + δs")
    entries = [
        ("wheels", ", ".join(f"{count} {kind}" for kind, count in kinds.items())),
        ("CDOF / TDOF", f"δm / 3 = {mobility}/3"),
        ("so it is", _holonomy(record)),
    ]
    if record["note"]:
        entries.append(("note", record["note"]))
    if record["as_expected"] is not None:
        stated = ", ".join(f"{name} {value}" for name, value in record["expected"].items())
        entries.append(("the file", f"{'agrees' if record['as_expected'] else 'differs'}: it states {stated}"))
    return render(heading(record["name"], "a wheeled base in the plane"), "", drawn, "", pairs(entries))


def _holonomy(record: dict[str, Any]) -> str:
    """Whether the base can at once move wherever it can get, by the ratio and by the constraints."""
    mobility, reachable, total = record["mobility"], record["reachable"], record["total"]
    if not mobility:
        return "no vehicle: it cannot move"
    if mobility == total:
        return "holonomic: it can at once move in every direction"
    if record["holonomic"]:
        return (
            f"nonholonomic by the ratio; by its constraints holonomic, since it gets about in {_freedoms(reachable)} "
            f"of {total} only, and in {'that one' if reachable == 1 else 'those'} at once"
        )
    return f"nonholonomic: it gets about in {_freedoms(reachable)}, though only in {mobility} of them at once"


def _freedoms(count: int) -> str:
    return counted(count, "freedom")


def _joints_named(names: list[str]) -> str:
    listed = ", ".join(names[:8]) + (", …" if len(names) > 8 else "")
    return f"joint {listed} never moves" if len(names) == 1 else f"joints {listed} never move"
