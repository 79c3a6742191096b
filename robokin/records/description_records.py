"""What a description describes, as `robokin show`, `list` and `validate` say it: plain data."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from robokin.errors import DescriptionError, InputError, Note
from robokin.formats.library import load_any
from robokin.kinematics.structure import structure_of
from robokin.mobility.count import grubler
from robokin.model import CoupledRobot, Joint, Mechanism, Robot, Tree, WheeledBase
from robokin.model.joint_units import in_units, joint_factors
from robokin.number_text import show
from robokin.records.envelope import SCHEMA, envelope
from robokin.records.pose_records import poses_in
from robokin.units import Units

if TYPE_CHECKING:
    from robokin.formats.tree_branches import TreeBranches

KINDS = {Robot: "robot", Mechanism: "mechanism", WheeledBase: "wheeled", Tree: "tree"}
"""What the key `kind` says of that which a description describes."""

ZERO_DECIMALS = 9
"""Decimals of the place at zero: 1e-9 m and less is far below what a table states, and far above rounding."""


def kind_of(entry: Robot | Mechanism | WheeledBase | Tree) -> str:
    """`robot`, `mechanism`, `wheeled` or `tree`."""
    return next(name for kind, name in KINDS.items() if isinstance(entry, kind))


def zero_record(robot: Robot, units: Units) -> dict[str, Any]:
    """Where the tool frame stands with every joint at zero: its origin, its z, and the base's axis that z is along.

    `z_along` is None where z slants.
    """
    from robokin.kinematics.forward import forward_kinematics

    T = poses_in(forward_kinematics(robot, np.zeros(robot.n)), units)
    # Adding 0 makes 0 of -0.
    position, z = ((np.round(T[:3, column], ZERO_DECIMALS) + 0.0).tolist() for column in (3, 2))
    along = [f"{'+-'[value < 0]}{axis}" for axis, value in zip("xyz", z, strict=True) if abs(value) == 1]
    return {"position": position, "z": z, "z_along": along[0] if along else None}


Verdict = Robot | Mechanism | WheeledBase | Tree | InputError
"""What a description describes, or what is wrong with it."""


def described_record(entry: Robot | Mechanism | WheeledBase | Tree, units: Units) -> dict[str, Any]:
    """The document of `robokin show` about whatever a description describes."""
    if isinstance(entry, Tree):
        return links_record(entry, units)
    if isinstance(entry, Robot):
        return robot_record(entry, units)
    if isinstance(entry, Mechanism):
        return mechanism_record(entry, units)

    return wheel_record(entry, units)


def verdict_of(file: str) -> Verdict:
    """What a file, or a name of the library, describes, or what is wrong with it."""
    try:
        return load_any(file)
    except InputError as error:
        return error


def file_record(file: str, verdict: Verdict) -> dict[str, Any]:
    """The document of `robokin validate` about a file, or a name of the library: whether it is a description."""
    record: dict[str, Any] = {"schema": SCHEMA, "file": file, "id": Path(file).stem}
    nothing: dict[str, Any] = {"valid": False, "kind": None, "name": None, "error": None, "line": None, "column": None}
    record |= nothing | {"errors": [], "notes": [], "units": None}
    if not isinstance(verdict, Exception):
        found = {"valid": True, "kind": kind_of(verdict), "name": verdict.name, "units": verdict.units.as_record()}
        return record | found | {"id": verdict.id, "notes": [_place(note) for note in verdict.notes]}
    record["error"] = getattr(verdict, "sentence", str(verdict))
    record["line"] = getattr(verdict, "line", 0) or None
    record["column"] = getattr(verdict, "column", 0) or None
    record["errors"] = [_place(error) for error in getattr(verdict, "errors", ())] or [
        {"line": None, "column": None, "message": str(verdict)}
    ]
    return record


def _place(said: Note | DescriptionError) -> dict[str, Any]:
    return {"line": said.line, "column": said.column, "message": said.message}


def robot_record(robot: Robot, units: Units) -> dict[str, Any]:
    """All that is known of a robot, in the given units."""
    structure = structure_of(robot)
    own = {joint.name: f"q{number}" for number, joint in enumerate(robot.joints, start=1)}
    left = {joint.name: joint.limits for joint in robot.joints}  # those that what follows a joint leaves it
    rows = [
        _row_record(
            i, replace(row, limits=left.get(row.name, row.limits)) if row.moves else row,
            own.get(row.name) if row.moves else None, robot.convention, units,
        )
        for i, row in enumerate(robot.rows, start=1)
    ]  # fmt: skip
    coupled: dict[str, Any] = {}
    if isinstance(robot, CoupledRobot):
        coupled = {"couplings": _couplings(robot, units)}
        beside = [joint for joint in robot.joints if joint.name not in {row.name for row in robot.rows}]
        coupled |= {"beside": [_beside(joint, own[joint.name], units) for joint in beside]} if beside else {}
    factors = joint_factors(robot, units)
    return {
        **envelope("robot", robot.id, units),
        "name": robot.name,
        "kind": "robot",
        "description": robot.description,
        "source": robot.source,
        "convention": robot.convention,
        "joints": robot.types,
        "class": structure.arm,
        "wrist": structure.wrist or None,
        "n": robot.n,
        "m": structure.dimension,
        "redundancy": structure.redundancy,
        "grubler": grubler(6, robot.n + 1, [1] * robot.n),
        "inverse": _inverse_record(robot),
        "parameters": dict(robot.parameters),
        "base": poses_in(robot.base.copy(), units).tolist(),
        "tool": poses_in(robot.tool.copy(), units).tolist(),
        "at_zero": zero_record(robot, units),
        "rows": rows,
        **coupled,
        "poses": {name: in_units(q, factors).tolist() for name, q in robot.poses.items()},
    }


def _couplings(robot: CoupledRobot, units: Units) -> list[dict[str, Any]]:
    """What the joints of a robot hang on, in the given units."""
    kinds = {row.name: row.type for row in robot.rows} | {joint.name: joint.type for joint in robot.joints}

    def factor(name: str) -> float:
        return units.metres if kinds.get(name) == "prismatic" else units.radians

    found = []
    for coupling in robot.drive.couplings:
        mine = factor(coupling.joint)
        ratios = [
            {"joint": other, "ratio": ratio if factor(other) == mine else ratio * factor(other) / mine}
            for other, ratio in coupling.ratios
        ]
        offset = float(in_units(np.array(coupling.offset), mine))
        found.append({"joint": coupling.joint, "own": coupling.own, "ratios": ratios, "offset": offset})
    return found


def _beside(joint: Joint, variable: str, units: Units) -> dict[str, Any]:
    """A joint that is not in the chain and moves joints of it, in the given units."""
    factor = units.radians if joint.type == "revolute" else units.metres
    low, high = joint.limits
    limits = None if np.isinf(low) else [float(in_units(np.array(end), factor)) for end in (low, high)]
    return {"variable": variable, "joint": joint.name, "type": str(joint.type), "limits": limits}


def _row_record(i: int, row: Joint, variable: str | None, convention: str, units: Units) -> dict[str, Any]:
    def in_angle(value: float) -> float:
        return float(in_units(np.array(value), units.radians))

    def in_length(value: float) -> float:
        return float(in_units(np.array(value), units.metres))

    turns = row.type == "revolute"
    kind = "helical" if row.pitch else str(row.type)
    own = in_angle if turns else in_length
    record: dict[str, Any] = {"i": i, "name": row.name, "type": kind, "variable": variable}
    if convention == "frames":
        origin = np.eye(4) if row.origin is None else row.origin
        record["origin"] = poses_in(origin.copy(), units).tolist()
        record["axis"] = None if row.axis is None or not row.moves else row.axis.tolist()
    else:
        record["theta"] = None if turns else in_angle(row.theta)
        record["d"] = None if row.type == "prismatic" else in_length(row.d)
        record["a"] = in_length(row.a)
        record["alpha"] = in_angle(row.alpha)
    record["offset"] = own(row.offset) if row.moves else None
    record["sense"] = row.sense if row.moves else None
    if row.pitch:
        record["pitch"] = in_length(row.pitch * 2.0 * np.pi)
    if np.isfinite(row.motion_limits).all():
        record["motion_limits"] = [own(end) for end in row.motion_limits]
    low, high = row.limits
    record["limits"] = None if np.isinf(low) else [own(low), own(high)]
    return record


def _inverse_record(robot: Robot) -> dict[str, Any] | None:
    """How the inverse kinematics is solved, why so, and whether every solution is found."""
    from robokin.inverse.analysis import analysis_of  # a list of the library needs no solver

    if not robot.n:
        return None
    if isinstance(robot, CoupledRobot):
        from robokin.inverse.coupled_joints import about_inverse

        method, reason, complete = about_inverse(robot)
        return {"method": method, "reason": reason, "complete": complete}
    analysis = analysis_of(robot)
    return {"method": analysis.method, "reason": analysis.sentence, "complete": analysis.complete}


def mechanism_record(mechanism: Mechanism, units: Units) -> dict[str, Any]:
    """A mechanism's links and joints and Grübler's count, in the given units."""
    freedoms = [joint.freedoms for joint in mechanism.joints for _ in range(joint.multiplicity)]
    return {
        **envelope("mechanism", mechanism.id, units),
        "name": mechanism.name,
        "kind": "mechanism",
        "description": mechanism.description,
        "source": mechanism.source,
        "space": mechanism.space,
        "links": list(mechanism.links),
        "ground": mechanism.ground,
        "output": mechanism.output or None,
        "grubler": grubler(mechanism.order, len(mechanism.links), freedoms),
        "parameters": dict(mechanism.parameters),
        "joints": [
            {
                "name": joint.name,
                "type": joint.type,
                "links": list(joint.links),
                "freedoms": joint.freedoms,
                "at": None if joint.at is None else (joint.at / units.metres).tolist(),
                "axes": None if joint.axes is None else joint.axes.tolist(),
                "actuated": joint.actuated,
                "turns": [joint.gearing[0] / number for number in joint.gearing] or None,
                "carrier": joint.carrier or None,
            }
            for joint in mechanism.joints
        ],
    }


def links_record(tree: Tree, units: Units) -> dict[str, Any]:
    """A tree's joints with the links that they join, and its tips, in the given units."""
    graph = tree.graph
    variables = {number: place for place, number in enumerate(graph.variables, start=1)}
    coupled = {coupling.joint: coupling for coupling in graph.couplings}

    turns = {joint.name: joint.turns for joint in graph.joints}

    def factor(name: str) -> float:
        return units.radians if turns[name] else units.metres

    def hangs(name: str) -> list[dict[str, Any]]:
        ratios = coupled[name].ratios if name in coupled else ()
        return [
            {"joint": other, "ratio": ratio if turns[name] == turns[other] else ratio * factor(other) / factor(name)}
            for other, ratio in ratios
        ]

    joints: list[dict[str, Any]] = []
    for number in graph.moving:
        joint = graph.joints[number]
        # Of a variable those that what follows it leaves.
        limits = tree.limits[variables[number] - 1] if number in variables else np.array(joint.limits)
        joints.append(
            {
                "i": len(joints) + 1,
                "name": joint.name,
                "type": str(joint.type),
                "variable": f"q{variables[number]}" if number in variables else None,
                "parent": graph.links[joint.parent],
                "child": graph.links[joint.child],
                "limits": None if np.isinf(limits).all() else in_units(limits, factor(joint.name)).tolist(),
                "follows": hangs(joint.name),
            }
        )
    factors = joint_factors(tree, units)
    return {
        **envelope("robot", tree.id, units),
        "name": tree.name,
        "kind": "tree",
        "description": tree.description,
        "source": tree.source,
        "parameters": dict(tree.parameters),
        "n": tree.n,
        "joints": joints,
        "tips": [{"name": tip.name, "link": graph.links[tip.link]} for tip in graph.tips],
        "poses": {name: in_units(q, factors).tolist() for name, q in tree.poses.items()},
    }


def branch_records(parts: TreeBranches, units: Units) -> list[dict[str, Any]]:
    """The tables of a tree's branches, in the given units: of each its name, what it stands on, and its rows.

    Variables have the numbers that they have in the tree; where a joint follows others its value stands in their place,
    and what is added to it in the row's offset.
    """
    records = []
    from robokin.formats.tree_branches import WORLD  # only who writes tables of trees needs it

    for branch in parts.branches:
        chain, rows = branch.chain, []
        for place, row in enumerate(branch.rows):
            variable = None
            if row.moves:
                variable, more = _value_text(parts.tree, branch.joints[place], units)
                row = replace(row, offset=row.offset + more)
            rows.append(_row_record(place + 1, row, variable, chain.convention, units))
        records.append(
            {
                "branch": branch.name,
                "on": branch.on or WORLD,
                "units": units.as_record(),
                "convention": chain.convention,
                "base": poses_in(chain.base.copy(), units).tolist(),
                "tool": poses_in(chain.tool.copy(), units).tolist(),
                "rows": rows,
            }
        )
    return records


def _value_text(tree: Tree, number: int, units: Units) -> tuple[str, float]:
    """The variables that a joint's value is made of, `q2` or `0.5 q2 - q3`, and what is added [rad | m]."""
    graph = tree.graph
    joint = graph.joints[number]
    S, o = graph.value_map
    place = graph.moving.index(number)
    ratios, more = S[place], float(o[place])
    own = units.radians if joint.turns else units.metres
    text = ""
    for i in np.nonzero(ratios)[0]:
        ratio = float(ratios[i]) * (units.radians if tree.revolute[i] else units.metres) / own
        size = "" if abs(ratio) == 1.0 else f"{show(abs(ratio))} "
        sign = ("-" if ratio < 0 else "") if not text else (" - " if ratio < 0 else " + ")
        text += f"{sign}{size}q{i + 1}"
    return text, more


def tip_records(parts: TreeBranches, units: Units) -> list[dict[str, Any]]:
    """The tips of a tree's branches, in the given units: of each its name, what it is on, and its tool."""
    return [{"name": tip.name, "on": tip.on, "tool": poses_in(tip.tool.copy(), units).tolist()} for tip in parts.tips]


def wheel_record(base: WheeledBase, units: Units) -> dict[str, Any]:
    """A base's wheels, in the given units."""

    def said(value: float, factor: float) -> float:
        return float(in_units(np.array(value), factor))

    return {
        **envelope("base", base.id, units),
        "name": base.name,
        "kind": "wheeled",
        "description": base.description,
        "source": base.source,
        "steering": "parallel" if base.parallel else "independent",
        "parameters": dict(base.parameters),
        "wheels": [
            {
                "name": wheel.name,
                "type": wheel.type,
                "at": [said(wheel.x, units.metres), said(wheel.y, units.metres)],
                "angle": said(wheel.angle, units.radians),
                "radius": said(wheel.radius, units.metres) or None,
                "offset": said(wheel.offset, units.metres) if wheel.type == "castor" else None,
                "roller": said(wheel.roller, units.radians) if wheel.type == "swedish" else None,
                "driven": wheel.driven,
                "turned": wheel.turned,
            }
            for wheel in base.wheels
        ],
    }
