"""Freedoms to plain data: of mechanisms, robots and wheeled bases, with the same keys for all."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from robokin.formats.joint_counts import LETTERS
from robokin.model import CoupledRobot, Mechanism, Robot, Tree, WheeledBase
from robokin.records.count_records import count_record, type_record
from robokin.records.envelope import envelope
from robokin.units import Units

if TYPE_CHECKING:
    from robokin.mobility.manoeuvrability import Manoeuvrability
    from robokin.mobility.output import Output
    from robokin.mobility.verdict import Mobility


NAMES = {name: letter for letter, (name, _) in LETTERS.items()}


def mechanism_record(found: Mobility, units: Units, seed: int) -> dict[str, Any]:
    """Count and truth of a mechanism."""
    from robokin.mobility.ground import ground_doubt
    from robokin.mobility.slips import slips_of

    mechanism, motion = found.mechanism, found.motion
    types = _types(mechanism)
    record = count_record(mechanism.name, mechanism.space, len(mechanism.links), types)
    record |= {
        "mobility": found.mobility,
        "mobility_basis": None if found.mobility is None else "geometry",
        "overconstraints": found.redundant,
        "idle": found.idle,
        "controllable": found.controllable,
        "holonomic": found.holonomic,
        "note": found.note,
        "kind": "mechanism",
        "id": mechanism.id,
        "units": units.as_record(),
        "verdict": found.verdict,
        "loops": len(mechanism.graph.topology.loops),
        "instantaneous": None if motion is None else motion.instantaneous,
        "generic": None if motion is None else motion.generic,
        "if_exact": motion.instantaneous + found.nearly if motion and found.verdict == "nearly" else None,
        "singular_values": None if motion is None else motion.values.tolist(),
        "gap": None if motion is None else list(motion.gap),
        "strained": list(found.strained),
        "dead_joints": list(found.dead),
        "output": _output_record(found.output),
        "actuated": found.actuated,
        "undriven": found.undriven,
        "output_undriven": found.output_undriven,
        "missing": list(found.missing),
        "slips": list(slips_of(mechanism)),
        "seed": seed,
        "decided": None if motion is None else motion.undecided is None,
        "undecided": None if motion is None else motion.undecided,
        "mobility_bounds": None if motion is None else [motion.finite, motion.most],
        "order": None if motion is None else motion.order,
        "branches": _branch_records(found),
        "branch_count": None if motion is None else motion.count,
        "velocities_only": list(found.wandering),
        "mode": mechanism.mode or None,
        "modes": _modes(mechanism, units),
        "modes_complete": mechanism.modes_complete if mechanism.modes else None,
        "ground": mechanism.ground,
        "ground_named": mechanism.ground_named,
        "ground_note": ground_doubt(mechanism),
    }
    record |= _compared(dict(mechanism.expected), record)
    return record


def _modes(mechanism: Mechanism, units: Units) -> list[dict[str, Any]] | None:
    """The ways to put the mechanism together, in the units; None where its joints have their places."""
    if not mechanism.modes:
        return None
    return [
        {
            "mode": number,
            "double": mode.double,
            "joints": {
                name: [place.real / units.metres + 0.0, place.imag / units.metres + 0.0]
                for name, place in mode.places.items()
            },
            "links": {name: angle / units.radians + 0.0 for name, angle in mode.angles.items()},
        }
        for number, mode in enumerate(mechanism.modes, start=1)
    ]


def _branch_records(found: Mobility) -> list[dict[str, Any]]:
    """Each branch of configurations through the pose."""
    outputs = found.outputs or (found.output,) * len(found.branches)
    return [
        {"dimension": size, "joints": list(names), "output": _output_record(output)}
        for (size, names), output in zip(found.branches, outputs, strict=True)
    ]


def _types(mechanism: Mechanism) -> list[dict[str, Any]]:
    """The joints by type, in the order in which they first come; a joint of m links is m - 1."""
    counts: dict[tuple[str, int], int] = {}
    for joint in mechanism.joints:
        key = joint.type, joint.freedoms
        counts[key] = counts.get(key, 0) + joint.multiplicity
    return [type_record(name, NAMES.get(name, "G"), count, f, mechanism.order) for (name, f), count in counts.items()]


def _output_record(output: Output | None) -> dict[str, Any] | None:
    if output is None:
        return None
    return {"link": output.link, "against": output.against, "freedoms": output.freedoms, "kind": output.kind}


def _compared(expected: dict[str, int], record: dict[str, Any]) -> dict[str, Any]:
    """What the file states of the answer, and whether it is found so; None where it states nothing."""
    if not expected:
        return {"expected": None, "as_expected": None}
    output = record.get("output")
    found = record | {"output": output["freedoms"] if output else None}
    same = [found[name] == value for name, value in expected.items() if found[name] is not None]
    return {"expected": expected, "as_expected": all(same) if same else None}


def robot_record(robot: Robot, units: Units) -> dict[str, Any]:
    """A serial chain's count, which is true: it has no loops. CDOF are its joints, TDOF the poses it can reach."""
    from robokin.kinematics.structure import structure_of

    structure = structure_of(robot)
    space = "planar" if structure.arm == "planar" else "spatial"
    counts = {letter: robot.types.count(letter) for letter in dict.fromkeys(robot.types)}
    order = 3 if space == "planar" else 6
    types = [type_record(LETTERS[letter][0], letter, count, 1, order) for letter, count in counts.items()]
    n, m, spare = robot.n, structure.dimension, structure.redundancy
    note = None
    if spare > 0:
        note = f"redundant: {n} joints for the {m} freedoms of what it reaches, so {spare} could be held at any value"
    return count_record(robot.name, space, n + 1, types) | {
        "mobility": n,
        "mobility_basis": "geometry",
        "overconstraints": 0,
        "idle": 0,
        "controllable": n,
        "holonomic": structure.holonomic,
        "note": note,
        "kind": "robot",
        "id": robot.id,
        "units": units.as_record(),
        "verdict": "right",
        "total": m,
        "redundancy": spare,
        "compared": "joints",
    }


def jointed_record(entry: Robot | Tree, units: Units) -> dict[str, Any]:
    """The count of a robot, or of a tree: of joints that follow others, too, where the robot has such."""
    if isinstance(entry, CoupledRobot):
        from robokin.formats.part import tree_of

        entry = tree_of(entry)
    return tree_record(entry, units) if isinstance(entry, Tree) else robot_record(entry, units)


def tree_record(tree: Tree, units: Units) -> dict[str, Any]:
    """A tree's count, which is true but for joints that follow others; what moves each tip."""
    moving = [tree.graph.joints[number] for number in tree.graph.moving]
    counts = {kind: sum(joint.type == kind for joint in moving) for kind in dict.fromkeys(j.type for j in moving)}
    types = [type_record(str(kind), NAMES.get(str(kind), "G"), count, 1, 6) for kind, count in counts.items()]
    following = len(moving) - tree.n
    note = None
    if following:
        follow = "joint follows another" if following == 1 else "joints follow others"
        note = f"{following} {follow}: of {len(moving)} freedoms {tree.n} are left"
    graph = tree.graph
    variables = [graph.chain(graph.links[graph.root], tip).variables.tolist() for tip in tree.tips]
    shared = {tip: sum(bool({*own} & {*other}) for other in variables) > 1
              for tip, own in zip(tree.tips, variables, strict=True)}  # fmt: skip
    return count_record(tree.name, "spatial", len(moving) + 1, types) | {
        "mobility": tree.n,
        "mobility_basis": "geometry",
        "overconstraints": 0,
        "idle": 0,
        "controllable": tree.n,
        "holonomic": True,
        "note": note,
        "kind": "tree",
        "id": tree.id,
        "units": units.as_record(),
        "verdict": "coupled" if following else "right",
        "following": following,
        "tips": [
            {"name": tip, "joints": len(own), "alone": not shared[tip]}
            for tip, own in zip(tree.tips, variables, strict=True)
        ],
    }


def wheeled_record(base: WheeledBase, found: Manoeuvrability, units: Units) -> dict[str, Any]:
    """A base's degrees of mobility, steerability and manoeuvrability, and what its motors command of the first two."""
    commands = found.commands
    record = {
        **envelope("name", base.name, None, base.id),
        "space": "planar",
        "lambda": found.total,
        **dict.fromkeys(("links", "joints", "freedoms", "grubler", "constraints")),
        "mobility": found.mobility,
        "mobility_basis": "geometry",
        "overconstraints": None,
        "idle": None,
        "controllable": found.controllable,
        "holonomic": found.holonomic,
        "note": found.note,
        "kind": "wheeled",
        "units": units.as_record(),
        "wheels": [{"name": wheel.name, "type": wheel.type} for wheel in base.wheels],
        "steerability": found.steerability,
        "manoeuvrability": found.manoeuvrability,
        "total": found.total,
        "ratio": found.ratio,
        "reachable": found.reachable,
        "compared": "controllable" if found.uncontrolled else "mobility",
        "uncontrolled": found.uncontrolled,
        "controllable_in_line": commands.least,
        "commanded_steering": commands.steering,
        "commanded_speeds": commands.speeds,
        "conditions": commands.conditions,
        "driven": [wheel.name for wheel in base.wheels if wheel.driven],
        "turned": [wheel.name for wheel in base.wheels if wheel.turned],
        "drive_note": commands.note,
    }
    return record | _compared(dict(base.expected), record)
