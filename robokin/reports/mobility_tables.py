"""Freedoms for eyes: the bookkeeping, the count in both forms, the mobility beside it and why."""

from __future__ import annotations

import math
from typing import Any

from robokin.errors import counted
from robokin.reports.page_parts import Part
from robokin.reports.page_tables import heading, pairs, render, table

MODE_COLUMNS = 3
"""Joints whose places are listed for each way to put a mechanism together; the document has all of them."""

VERDICTS = {
    "right": "the count is right",
    "exceptional": "exceptional: the count is wrong for these dimensions",
    "singular": "singular pose: it can do more here than elsewhere",
    "shaky": "shaky: some of its motions are only a tremble",
    "nearly": "nearly mobile: the dimensions are not exact",
    "undecided": "undecided: what is known does not settle it",
    "disconnected": "disconnected: there is no one mechanism to count",
    "counted": "counted only: without geometry nobody knows",
}
"""Verdicts in words."""


BRANCHES = 6
"""Branches that a table lists."""


def mobility_table(record: dict[str, Any]) -> bytes:
    """The answer about a mechanism, a robot, or bare numbers."""
    return render(*mobility_parts(record))


def mobility_parts(record: dict[str, Any]) -> list[Part]:
    """The same as the parts of a page."""
    space = f"{record['space']}, λ = {record['lambda']}"
    parts: list[Part] = [heading(record["name"] or "Grübler's count", space), "", _joints(record), ""]
    parts += [pairs(_count(record))]
    if record["kind"] == "mechanism":
        parts += ["", _side_by_side(record), "", pairs(_mechanism_entries(record))]
        if record["modes"]:
            parts += ["", _modes(record)]
            if not record["modes_complete"]:
                parts += ["found by search: there may be more ways to put it together"]
    elif record["kind"] == "robot":
        parts += ["", pairs(_robot_entries(record))]
    elif record["kind"] == "tree":
        parts += ["", pairs(_tree_entries(record))]
    elif record["note"]:
        parts += ["", pairs([("note", record["note"])])]
    return parts


def _tree_entries(record: dict[str, Any]) -> list[tuple[str, str]]:
    entries = [("mobility", f"{record['mobility']}  (a tree has no loops)")]
    if record["note"]:
        entries += [("note", record["note"])]
    for place, tip in enumerate(record["tips"]):
        shared = "" if tip["alone"] else ", some of which move others too"
        entries.append(("" if place else "tips", f"{tip['name']}: {_joint_count(tip['joints'])}{shared}"))
    return entries


def _joint_count(count: int) -> str:
    return f"{count} joint variable{'' if count == 1 else 's'}"


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
    for name in ("Grübler", "mobility"):
        drawn.add_column(name, justify="right", no_wrap=True)
    drawn.add_column("verdict")
    mobility = "?" if record["mobility"] is None else str(record["mobility"])
    verdict = VERDICTS[record["verdict"]]
    if record["verdict"] == "singular" and (record["branch_count"] or 1) > 1:
        verdict = f"singular pose, where {record['branch_count']} branches meet: it can do more here than elsewhere"
    drawn.add_row(str(record["grubler"]), mobility, verdict)
    return drawn


def _mechanism_entries(record: dict[str, Any]) -> list[tuple[str, str]]:
    entries = [("why", _why(record)), ("ground", _ground(record))]
    if record["mobility"] is not None:
        if record["overconstraints"]:
            of = counted(record["lambda"] * record["loops"], "constraint")
            entries.append(("redundant", f"{record['overconstraints']} of the {of} that the loops make"))
        if record["idle"]:
            do = "does" if record["idle"] == 1 else "do"
            what = "the output" if record["output"] else "anything else"
            entries.append(("passive", f"{_freedoms(record['idle'])} that {do} not move {what}"))
        if record["dead_joints"]:
            entries.append(("dead", f"{_joints_named(record['dead_joints'])}, held by the others"))
        entries += _branch_entries(record)
        if record["order"] is not None:
            entries.append(
                ("order", f"{record['order']}: with this power of a step the constraints forbid the tremble")
            )
        entries += _output_entries(record) + _drive_entries(record)
        entries += _numbers_entries(record)
    entries += [("look at", sentence) for sentence in record["slips"]]
    if record["as_expected"] is not None:
        stated = ", ".join(f"{name} {value}" for name, value in record["expected"].items())
        entries.append(("the file", f"{'agrees' if record['as_expected'] else 'differs'}: it states {stated}"))
    return entries


def _modes(record: dict[str, Any]) -> Any:
    """The ways to put it together: where the joints are that are elsewhere in some."""
    modes = record["modes"]
    size = max(math.hypot(*place) for mode in modes for place in mode["joints"].values())
    names = [
        name for name, place in modes[0]["joints"].items()
        if any(math.dist(place, mode["joints"][name]) > 1e-9 * size for mode in modes[1:])
    ]  # fmt: skip
    names = (names or list(modes[0]["joints"]))[:MODE_COLUMNS]
    drawn = table()
    drawn.add_column("mode", justify="right")
    for name in names:
        drawn.add_column(f"{name} [{record['units']['length']}]", justify="right")
    drawn.add_column("")
    for mode in modes:
        places = ["  ".join(f"{value:.6g}" for value in _rounded(mode["joints"][name])) for name in names]
        said = [word for word, true in (("this one", mode["mode"] == record["mode"]),
                                        ("double: a dead point", mode["double"])) if true]  # fmt: skip
        drawn.add_row(str(mode["mode"]), *places, ", ".join(said))
    return drawn


def _rounded(place: list[float]) -> list[float]:
    """A place whose rounding errors beside larger numbers are none."""
    least = 1e-9 * max(map(abs, place))
    return [0.0 if abs(value) <= least else value for value in place]


def _ground(record: dict[str, Any]) -> str:
    """Which link stands still and who says so."""
    if record["ground_note"]:
        return str(record["ground_note"])
    return f"{record['ground']}, {'as the file says' if record['ground_named'] else 'the first link'}"


def _why(record: dict[str, Any]) -> str:
    """The sentence; where nothing is special, that."""
    if record["note"]:
        return str(record["note"])
    if not record["loops"]:
        return "there is no loop, so nothing keeps a joint from moving"
    return "the constraints of the loops are independent, so each takes one freedom away, as the count has it"


def _branch_entries(record: dict[str, Any]) -> list[tuple[str, str]]:
    """Each branch with its freedoms and what moves in it, where there are several."""
    branches, count = record["branches"], record["branch_count"] or 1
    if count < 2:
        return []
    entries = []
    for branch in branches[:BRANCHES]:
        names = branch["joints"]
        listed = ", ".join(names[:8]) + (", …" if len(names) > 8 else "")
        moving = f"joint{'' if len(names) == 1 else 's'} {listed} move{'s' if len(names) == 1 else ''}"
        output = branch["output"]
        does = f"; {output['link']}: {output['kind'] if output['freedoms'] else 'stands still'}" if output else ""
        entries.append(("branch", f"{_freedoms(branch['dimension'])}: {moving if names else 'nothing moves'}{does}"))
    if count > BRANCHES:
        entries.append(("", f"and {count - BRANCHES} more"))
    return entries


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
        text += f"; {_freedoms(left)} left unactuated"
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
    return render(*wheeled_parts(record))


def wheeled_parts(record: dict[str, Any]) -> list[Part]:
    """The same as the parts of a page."""
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
        ("controllable", _commanded(record)),
        ("CDOF / TDOF", f"{record['controllable']}/3" if record["uncontrolled"] else f"δm / 3 = {mobility}/3"),
        ("so it is", _holonomy(record)),
    ]
    if record["note"]:
        entries.append(("note", record["note"]))
    if record["as_expected"] is not None:
        stated = ", ".join(f"{name} {value}" for name, value in record["expected"].items())
        entries.append(("the file", f"{'agrees' if record['as_expected'] else 'differs'}: it states {stated}"))
    return [heading(record["name"], "a wheeled base in the plane"), "", drawn, "", pairs(entries)]


def _commanded(record: dict[str, Any]) -> str:
    """What the motors command of both degrees."""
    castors = {wheel["name"] for wheel in record["wheels"] if wheel["type"] == "castor"}
    turned = [name for name in record["turned"] if name not in castors]
    text = f"{record['controllable']} of δm = {record['mobility']} by {counted(len(record['driven']), 'driven wheel')}"
    if swivels := castors.intersection(record["turned"]):
        text += f" and {counted(len(swivels), 'turned castor')}"
    if record["steerability"] or turned:
        of = f"{record['commanded_steering']} of δs = {record['steerability']}"
        text += f", {of} by {counted(len(turned), 'turned wheel')}"
    return text + (f"; {record['drive_note']}" if record["drive_note"] else "")


def _holonomy(record: dict[str, Any]) -> str:
    """Whether the base can at once move wherever it can get, by the ratio and by the constraints."""
    mobility, reachable, total = record["mobility"], record["reachable"], record["total"]
    if not mobility:
        return "no vehicle: it cannot move"
    if not record["controllable"]:
        return f"not driven: nothing is commanded; pushed, it can at once move in {_freedoms(mobility)}"
    if record["uncontrolled"]:
        free = "in every direction" if mobility == total else f"in {_freedoms(mobility)} at once"
        return (
            f"underdriven: its wheels let it move {free}, its motors command {record['controllable']} of them; "
            f"the rest is left to push and slope"
        )
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
