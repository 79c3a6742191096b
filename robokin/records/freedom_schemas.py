"""Schemas of `robokin dof`: a count, a mechanism, a robot, a wheeled base, and configurations along a motion."""

from __future__ import annotations

from robokin.records.schema_words import (
    UNITS,
    Schema,
    documents,
    flag,
    head,
    items,
    mapping,
    matrix,
    maybe,
    number,
    numbers,
    record,
    rows,
    text,
    texts,
    whole,
    word,
)

COUNTED = "where there is no geometry"
VERDICTS = ("right", "exceptional", "singular", "shaky", "nearly", "undecided", "disconnected", "counted")
OUTPUT = record(
    "How one link moves against another.",
    {
        "link": text("The link that moves."),
        "against": text("The link that it is measured against."),
        "freedoms": whole("Its freedoms.", 0),
        "kind": text("The motion in words."),
    },
)
TYPE = record(
    "Joints of one type.",
    {
        "type": text("Its name."),
        "letter": text("Its letter."),
        "count": whole("How many.", 0),
        "freedoms": whole("Freedoms f of one.", 0),
        "constraints": whole("Constraints C of one.", 0),
    },
)


def _count(named: bool) -> dict[str, Schema]:
    """The keys of every answer."""
    name = text("The name in full.")
    about = head("name", name if named else maybe(name, "for a bare count"), units=False, named=named)
    form = {"form": whole("λ(n − 1) − ΣC: always `grubler`."), "total": whole("ΣC.", 0)}
    return about | {
        "space": word("Where it lives.", "planar", "spherical", "spatial"),
        "lambda": whole("Freedoms of a link by itself, λ.", 3),
        "links": maybe(whole("Links n, with the ground.", 0), "of a wheeled base"),
        "joints": maybe(whole("Joints j; one that pins m links counts m − 1.", 0), "of a wheeled base"),
        "freedoms": maybe(whole("Σf.", 0), "of a wheeled base"),
        "grubler": maybe(whole("λ(n − j − 1) + Σf."), "of a wheeled base"),
        "constraints": maybe(record("The same from constraints.", form), "of a wheeled base"),
        "mobility": maybe(whole("The true mobility.", 0), f"{COUNTED}, and where it is undecided"),
        "mobility_basis": maybe(word("What it rests on.", "geometry"), "where it is null"),
        "overconstraints": maybe(whole("Constraints that say nothing new.", 0), COUNTED),
        "idle": maybe(whole("Freedoms that do not move the output.", 0), COUNTED),
        "controllable": maybe(whole("Freedoms that the motors command.", 0), "where nothing is driven"),
        "holonomic": maybe(flag("Whether all are controllable."), "where nothing is driven"),
        "note": maybe(text("Why count and mobility differ, or what is special."), "where nothing is"),
    }


LOOPS = {"loops": whole("Independent loops.", 0), "types": items(TYPE, "The joints by type.")}
EXPECTED = {
    "expected": maybe(mapping(whole("A number."), "What the file states of the answer."), "where it states nothing"),
    "as_expected": maybe(flag("Whether it is found so."), "where that is not known"),
}


def dof() -> Schema:
    """Documents of `robokin dof`."""
    count = record(
        "A count without a description.",
        _count(False) | LOOPS | {"kind": {"const": "count", "description": "What it is."}},
    )
    robot = record(
        "A robot.",
        {
            **_count(True),
            **LOOPS,
            "kind": {"const": "robot", "description": "What it is."},
            "units": UNITS,
            "verdict": {"const": "right", "description": "A chain has no loops: its count is its mobility."},
            "total": whole("Dimension of the poses that it can reach, M.", 0),
            "redundancy": whole("N − M."),
            "compared": {"const": "joints", "description": "What is compared with `total`."},
        },
    )
    tip = record(
        "A tip.",
        {
            "name": text("Its name."),
            "joints": whole("The joint variables that move it.", 0),
            "alone": flag("Whether none of them moves another tip."),
        },
    )
    tree = record(
        "A tree of links.",
        {
            **_count(True),
            **LOOPS,
            "kind": {"const": "tree", "description": "What it is."},
            "units": UNITS,
            "verdict": word("Whether the count is the mobility, or joints that follow others make it less.",
                            "right", "coupled"),
            "following": whole("Joints that follow others, without a freedom of their own.", 0),
            "tips": items(tip, "What moves each tip."),
        },
    )  # fmt: skip
    about = "Degrees of freedom; with --trace, configurations along a motion (a line of JSON lines holds one)."
    motion, configuration = _motion()
    return documents(
        "dof", about, [], count=count, mechanism=_mechanism(), robot=robot, tree=tree, wheeled=_base(), motion=motion,
        configuration=configuration,
    )  # fmt: skip


def _mechanism() -> Schema:
    mode = record(
        "A way to put the mechanism together.",
        {
            "mode": whole("Its number.", 1),
            "double": flag("Whether two ways fall together here."),
            "joints": mapping(numbers("x, y [length].", 2), "Where the joints are, by name."),
            "links": mapping(number("Angle of its frame [angle]."), "How the links are turned, by name."),
        },
    )
    branch = record(
        "A branch of configurations through this one.",
        {
            "dimension": whole("Its freedoms.", 0),
            "joints": texts("The joints that move in it."),
            "output": maybe(OUTPUT, "without an output"),
        },
    )
    bounds = maybe(items(whole("A mobility.", 0), "Between which the mobility is.", 2), COUNTED)
    return record(
        "A mechanism.",
        {
            **_count(True),
            **LOOPS,
            "kind": {"const": "mechanism", "description": "What it is."},
            "units": UNITS,
            "verdict": word("How count and mobility go together.", *VERDICTS),
            "instantaneous": maybe(whole("Freedoms of velocities here.", 0), COUNTED),
            "generic": maybe(whole("Freedoms of velocities at configurations near by.", 0), COUNTED),
            "if_exact": maybe(whole("The mobility if the dimensions were exact.", 0), "where they are"),
            "singular_values": maybe(numbers("Of the constraints, greatest first [1]."), COUNTED),
            "gap": maybe(
                items({"type": ["number", "null"]}, "Singular values on both sides of the rank [1].", 2), COUNTED
            ),
            "strained": texts("Joints that share constraints which say nothing new."),
            "dead_joints": texts("Joints that never move."),
            "output": maybe(OUTPUT, "without an output"),
            "actuated": whole("Joints that are driven.", 0),
            "undriven": maybe(whole("Freedoms left when those are held.", 0), "where nothing is driven"),
            "output_undriven": maybe(whole("Freedoms left to the output then.", 0), "without an output"),
            "missing": texts("Joints without geometry."),
            "slips": texts("What in the description looks like a mistake."),
            "seed": whole("As given; nothing hangs on it.", 0),
            "decided": maybe(flag("Whether the mobility is decided."), COUNTED),
            "undecided": maybe(text("Why not."), "where it is"),
            "mobility_bounds": bounds,
            "order": maybe(whole("The power of a step with which the constraints forbid a tremble.", 2), "without one"),
            "branches": items(branch, "The branches of configurations through this one."),
            "branch_count": maybe(whole("How many there are.", 0), COUNTED),
            "velocities_only": texts("Contacts that were judged by their velocities alone."),
            "mode": maybe(whole("Which way it is put together.", 1), "where its joints have places"),
            "modes": maybe(items(mode, "The ways to put it together."), "where its joints have places"),
            "modes_complete": maybe(flag("Whether there can be no other."), "where its joints have places"),
            "ground": text("The link that stands still."),
            "ground_named": flag("Whether the file names it."),
            "ground_note": maybe(text("What is doubtful about it."), "where nothing is"),
            **EXPECTED,
        },
    )


def _base() -> Schema:
    return record(
        "A wheeled base.",
        {
            **_count(True),
            "kind": {"const": "wheeled", "description": "What it is."},
            "units": UNITS,
            "wheels": items(record("A wheel.", {"name": text("Its name."), "type": text("Its type.")}), "The wheels."),
            "steerability": whole("Degree of steerability δ_s.", 0),
            "manoeuvrability": whole("Degree of manoeuvrability δ_M = δ_m + δ_s.", 0),
            "total": whole("Freedoms of a body in the plane.", 3),
            "ratio": number("Controllable to total freedoms [1].", 0.0),
            "reachable": whole("Dimension of what it can get to.", 0),
            "compared": word("What is compared with `total`.", "controllable", "mobility"),
            "uncontrolled": whole("Freedoms that no motor commands.", 0),
            "controllable_in_line": whole("The least that motors command at any steering angles.", 0),
            "commanded_steering": whole("Steering freedoms that motors command.", 0),
            "commanded_speeds": whole("Wheels that motors turn.", 0),
            "conditions": whole("Conditions that the motors' speeds must meet.", 0),
            "driven": texts("Wheels that a motor turns."),
            "turned": texts("Wheels that a motor steers."),
            "drive_note": maybe(text("What is special about the motors."), "where nothing is"),
            **EXPECTED,
        },
    )


def _motion() -> tuple[Schema, Schema]:
    step = {
        "step": whole("Its number.", 1),
        "q": mapping(number("The joint's value [joint]."), "Joint values, by name."),
        "links": mapping(matrix("The link's pose"), "The links that move, by name."),
    }
    points = {"points": rows("Where the points of --point are [length].", None, 3)}
    keys = {
        **head("mechanism", text("The mechanism, as `id`.")),
        "driven": text("The joint that leads."),
        "closed": flag("Whether the motion comes back to its beginning."),
    }
    configurations = items(record("A configuration.", step, points), "The configurations.")
    return record("A motion.", keys | {"configurations": configurations}), record(
        "A configuration.", keys | step, points
    )
