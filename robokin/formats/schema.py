"""What a description may hold: the fields, once, for the reader, for the messages and for `robokin schema`."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from robokin.units import METRES, RADIANS

VERSION = 1
"""The version of the format that this robokin reads."""

MAX_ROWS = 1000
"""Rows of a table, links or joints of a mechanism; the human body has 21 rows."""


@dataclass(frozen=True)
class Field:
    """A key of a mapping: what it holds (the name of a definition in the JSON Schema) and a line on it."""

    holds: str
    doc: str
    required: bool = False
    choices: tuple[str, ...] = ()


Fields = dict[str, Field]

CONVENTIONS = ("standard", "modified", "frames")
OTHER_FORMS = ("screws", "opw")
"""What `convention` may also say: ways to write a chain that are read as rows of `frames`."""

ROW_TYPES = ("revolute", "prismatic", "helical", "fixed")
SPACES = ("planar", "spherical", "spatial")

COMMON: Fields = {
    "robokin": Field("version", f"format version: {VERSION}", required=True),
    "name": Field("text", "the name in full", required=True),
    "description": Field("text", "one line"),
    "source": Field("text", "where the numbers come from, and which of them are not published"),
    "units": Field("units", "units of every length and angle in the file; default m and rad"),
    "parameters": Field("parameters", "named numbers, usable in every cell below, overridable with --set"),
}

ROBOT: Fields = {
    **COMMON,
    "convention": Field("text", "default standard", choices=CONVENTIONS),
    "base": Field("transform", "fixed transform from the world to frame 0"),
    "joints": Field("rows", "the table: a list of rows, or one list for each column", required=True),
    "tool": Field("transform", "fixed transform from the last frame to the end effector"),
    "couplings": Field("couplings", "joints whose values hang on those of others"),
    "poses": Field("poses", "named configurations, usable as --q NAME"),
}

LIMIT_LIST = Field("limit_list", "[min, max] of each q, ~ for none")

SCREWS: Fields = {
    **COMMON,
    "convention": Field("text", "screws: the product of exponentials", required=True, choices=("screws",)),
    "base": ROBOT["base"],
    "home": Field("transform", "the tool's pose in frame 0 at q = 0", required=True),
    "joints": Field("screw_rows", "the joints' axes in frame 0 at q = 0: rows, or one list for each column", True),
    "couplings": ROBOT["couplings"],
    "poses": ROBOT["poses"],
}

ETS: Fields = {
    **COMMON,
    "base": ROBOT["base"],
    "ets": Field("text", "elementary steps from the base to the tool: tz(0.3) Rz(q1) tx(0.1) Ry(-q2)", required=True),
    "limits": LIMIT_LIST,
    "tool": ROBOT["tool"],
    "couplings": ROBOT["couplings"],
    "poses": ROBOT["poses"],
}

OPW: Fields = {
    **COMMON,
    "convention": Field("text", "opw: an arm with a wrist, by seven lengths", required=True, choices=("opw",)),
    "base": ROBOT["base"],
    "a1": Field("number", "from the first axis forward to the second; default 0"),
    "a2": Field("number", "from the third axis to that of the forearm, where the arm points up; default 0"),
    "b": Field("number", "from the first axis to the left; default 0"),
    "c1": Field("number", "from the base up to the second axis; default 0"),
    "c2": Field("number", "from the second axis to the third", required=True),
    "c3": Field("number", "from the third axis to the wrist's centre, along the forearm", required=True),
    "c4": Field("number", "from the wrist's centre to the flange; default 0"),
    "offsets": Field("six_numbers", "six angles, subtracted: each joint turns by sense · q - offset; default 0"),
    "senses": Field("six_senses", "six times 1 or -1; default 1"),
    "limits": LIMIT_LIST,
    "tool": ROBOT["tool"],
    "couplings": ROBOT["couplings"],
    "poses": ROBOT["poses"],
}

UNITS: Fields = {
    "length": Field("text", "default m", choices=tuple(METRES)),
    "angle": Field("text", "default rad", choices=tuple(RADIANS)),
}

ROW: Fields = {
    "name": Field("text", "the joint's name"),
    "type": Field("text", "revolute (R), prismatic (P), helical (H) or fixed (F)", required=True, choices=ROW_TYPES),
    "limits": Field("limits", "[min, max] of q; absent: unlimited"),
    "offset": Field("number", "constant shift of the variable: theta = q + offset, or d = q + offset"),
    "sense": Field("sense", "-1: the variable enters with the other sign, theta = offset - q; default 1"),
}

MOTION: Fields = {
    "pitch": Field("number", "what a helical row advances along its axis in one turn"),
    "motion_limits": Field("limits", "[min, max] of the joint itself, where what is typed is not what it does"),
}

DH_ROW: Fields = {
    **ROW,
    "theta": Field("number", "angle about z; on a revolute row only its variable: q1, q1 + 90, 90 - q1"),
    "d": Field("number", "length along z; on a prismatic row only its variable"),
    "a": Field("number", "length along x"),
    "alpha": Field("number", "angle about x"),
    **MOTION,
}

FRAME_ROW: Fields = {
    **ROW,
    "origin": Field("transform", "pose of the joint frame in the previous one at q = 0"),
    "axis": Field("axis", "x, y, z or [x, y, z]; default z"),
    **MOTION,
}

TREE: Fields = {
    **COMMON,
    "convention": Field(
        "text", "of every branch that states none; default standard", choices=(*CONVENTIONS, *OTHER_FORMS)
    ),
    "base": Field("transform", "fixed transform from the world to the base"),
    "branches": Field("branches", "the branches by name, each a serial chain", required=True),
    "couplings": Field("couplings", "joints whose values hang on those of others"),
    "tips": Field("tips", "the frames that are asked for; default every branch on which nothing stands"),
    "poses": Field("poses", "named configurations, usable as --q NAME"),
}  # fmt: skip

ON_BRANCH = Field("text", "the branch, or the joint (branch.joint), at whose end it stands; default the base")

BRANCH: Fields = {
    "on": ON_BRANCH,
    "convention": Field("text", "default that of the file", choices=CONVENTIONS),
    "base": Field("transform", "fixed transform from there to its frame 0"),
    "joints": ROBOT["joints"],
    "tool": Field("transform", "fixed transform from its last frame to its end"),
}


def _as_branch(robot: Fields) -> Fields:
    """The fields of a branch whose chain is written as that of a robot."""
    own = {name: field for name, field in robot.items() if name not in (*COMMON, "convention", "poses")}
    told: Fields = {"convention": replace(robot["convention"], required=False)} if "convention" in robot else {}
    ends: Fields = {name: BRANCH[name] for name in ("base", "tool") if name in own}
    return {"on": ON_BRANCH, **told, **own, **ends}


BRANCH_SCREWS, BRANCH_ETS, BRANCH_OPW = _as_branch(SCREWS), _as_branch(ETS), _as_branch(OPW)

COUPLING: Fields = {
    "joint": Field("text", "the joint whose value hangs on others'", required=True),
    "follows": Field("coupled", "the joint that it follows, without a variable of its own, or joints with ratios"),
    "adds": Field("coupled", "the joint whose value is added to its own variable, or joints with ratios"),
    "ratio": Field("number", "of its value to the other's, in the units of the file; default 1"),
    "offset": Field("number", "what is added to its value; default 0"),
}

TIP: Fields = {
    "name": Field("text", "what the tip is called", required=True),
    "on": Field("text", "the branch, or the joint (branch.joint), that it is on; default the branch of its name"),
    "tool": Field("transform", "fixed transform from there to the tip"),
}

SCREW_ROW: Fields = {
    "name": ROW["name"],
    "type": Field("text", "revolute (R), prismatic (P) or helical (H)", required=True,
                  choices=ROW_TYPES[:3]),
    "limits": ROW["limits"],
    "sense": ROW["sense"],
    "axis": Field("axis", "its direction in frame 0 at q = 0: x, y, z or [x, y, z]; default z"),
    "at": Field("place_in_space", "a point [x, y, z] on it in frame 0 at q = 0; default the origin"),
    **MOTION,
}  # fmt: skip

MECHANISM: Fields = {
    **COMMON,
    "space": Field("text", "the space that the links move in", required=True, choices=SPACES),
    "links": Field("links", "the links, by name or with their lengths; the first is the ground", required=True),
    "ground": Field("text", "the link that stands still, if it is not the first"),
    "joints": Field("mechanism_joints", "the joints between the links", required=True),
    "mode": Field("number", "which of the ways to put links of given lengths together is meant; default 1"),
    "output": Field("text", "the link whose motion the mechanism serves; `robokin dof` says how it moves"),
    "expected": Field("expected", "what the source says of its freedoms, to be compared with what is found"),
}

LINK: Fields = {
    "name": Field("text", "the link's name", required=True),
    "length": Field("number", "the distance of its two joints; its x axis runs from the first of them to the second"),
    "places": Field("places", "where its joints are in its own frame, [x, y] by joint"),
    "directions": Field("directions", "in which direction slides run there, an angle from its x axis by joint"),
}

EXPECTED: Fields = {
    "grubler": Field("number", "the count, F"),
    "mobility": Field("number", "the true mobility"),
    "overconstraints": Field("number", "redundant constraints, of λ a loop"),
    "output": Field("number", "freedoms of the output"),
    "idle": Field("number", "freedoms that do not move the output"),
}

FREEDOMS = {
    "fixed": 0, "revolute": 1, "prismatic": 1, "helical": 1, "cylindrical": 2, "universal": 2,
    "spherical": 3, "planar": 3, "rolling": 1, "gear": 2, "cam": 2, "belt": 2,
}  # fmt: skip
"""Freedoms f of the joint types; `custom` states its own, and those of `ONE_CONSTRAINT` depend on the space."""

ONE_CONSTRAINT = ("gear", "cam", "belt")
"""Joints that take one freedom whatever space they are in: f = λ - 1, 2 in the plane and on the sphere, 5 in space."""

MECHANISM_JOINT: Fields = {
    "name": Field("text", "the joint's name"),
    "type": Field("text", "the kind of joint", required=True, choices=(*FREEDOMS, "custom")),
    "links": Field("names", "the two or more links that it joins", required=True),
    "at": Field("point", "a point on the joint in the assembled configuration"),
    "axis": Field("vector", "its direction in the assembled configuration"),
    "axes": Field("vectors", "the two directions of a universal joint, or those about which a gear's turns count"),
    "normal": Field("vector", "the normal of a planar joint's plane"),
    "pitch": Field("number", "a helical joint's advance along its axis in one turn"),
    "freedoms": Field("number", "the freedoms of a custom joint"),
    "ratio": Field("number", "turns of a gear's or belt's first wheel for one of the second; below 0 the other way"),
    "teeth": Field("numbers", "the teeth of a gear's or chain's wheels, in the order of its links"),
    "radii": Field("numbers", "the radii of a belt's pulleys; below 0 those that run on its back"),
    "crossed": Field("flag", "whether a belt is crossed between its two pulleys"),
    "carrier": Field("text", "the link that carries the wheels, where more than one could"),
    "value": Field(
        "number",
        "in a mechanism by lengths: how far the second link is turned or has slid, of the ground's joints the other",
    ),
    "actuated": Field("flag", "whether the joint is driven"),
}

KINDS = ("wheeled",)
WHEEL_TYPES = ("fixed", "steered", "castor", "swedish", "ball")
STEERINGS = ("independent", "parallel")

WHEELED: Fields = {
    **COMMON,
    "kind": Field("text", "wheeled: a base on wheels; a robot and a mechanism state no kind", True, KINDS),
    "wheels": Field("wheels", "the wheels, in the base's frame", required=True),
    "steering": Field("text", "whether the steered wheels always point the same way; default independent",
                      choices=STEERINGS),
    "expected": Field("base_expected", "what the source says of its freedoms, to be compared with what is found"),
}  # fmt: skip

WHEEL: Fields = {
    "name": Field("text", "the wheel's name; default its number"),
    "type": Field("text", "the kind of wheel", required=True, choices=WHEEL_TYPES),
    "at": Field("place", "where it touches the ground (a castor: its swivel)", required=True),
    "angle": Field("number", "the direction in which it rolls, from the x axis; default 0"),
    "radius": Field("number", "its radius"),
    "offset": Field("number", "a castor's distance from swivel to wheel"),
    "roller": Field("number", "a Swedish wheel's angle from its way to its rollers': 90° omni, 45° mecanum"),
    "driven": Field("flag", "whether a motor rolls it"),
    "turned": Field("flag", "whether a motor steers it"),
}

BASE_EXPECTED: Fields = {
    "mobility": Field("number", "the degree of mobility"),
    "steerability": Field("number", "the degree of steerability"),
    "manoeuvrability": Field("number", "the degree of manoeuvrability: the sum of both"),
    "controllable": Field("number", "the freedoms, of the degree of mobility, that the motors command"),
}


def json_schema() -> dict[str, Any]:
    """The format as a JSON Schema (draft 2020-12), for editors that complete and check YAML."""
    number = {"anyOf": [{"type": "number"}, {"type": "string", "description": "an expression such as l1/2"}]}
    numbers: dict[str, Any] = {"type": "array", "items": {"$ref": "#/$defs/number"}}
    # An editor's YAML makes a number of the name 1, and null of an empty value; the reader takes both.
    text = {"type": ["string", "number"]}
    columns = {
        name: {"type": "array"} for name in (*DH_ROW, *FRAME_ROW) if name != "type"
    } | {"type": {"type": ["string", "array"], "description": "one letter a row, such as RRPRRR"}}  # fmt: skip
    screw_columns = {name: columns.get(name, {"type": "array"}) for name in SCREW_ROW}
    limits = {**numbers, "minItems": 2, "maxItems": 2}
    definitions: dict[str, Any] = {
        "version": {"const": VERSION},
        "text": text,
        "flag": {"type": "boolean"},
        "sense": {"enum": [1, -1]},
        "number": number,
        "transform": {"type": ["string", "null"], "description": "such as Trans(0, 0, 660) Rot(z, 90)"},
        "units": _object(UNITS),
        "parameters": {"type": ["object", "null"], "additionalProperties": {"$ref": "#/$defs/number"}},
        "poses": {"type": "object", "additionalProperties": numbers},
        "branches": {
            "type": "object",
            "additionalProperties": {
                "anyOf": [_object(fields) for fields in (BRANCH, BRANCH_SCREWS, BRANCH_ETS, BRANCH_OPW)]
            },
        },
        "coupled": {"anyOf": [text, {"type": "object", "additionalProperties": {"$ref": "#/$defs/number"}}]},
        "couplings": {"type": "array", "items": _object(COUPLING)},
        "tips": {"type": "array", "items": {"anyOf": [text, _object(TIP)]}, "minItems": 1},
        "expected": _object(EXPECTED),
        "base_expected": _object(BASE_EXPECTED),
        "limits": limits,
        "limit_list": {"type": "array", "items": {"anyOf": [limits, {"type": "null"}]}},
        "six_numbers": {**numbers, "minItems": 6, "maxItems": 6},
        "six_senses": {"type": "array", "items": {"$ref": "#/$defs/sense"}, "minItems": 6, "maxItems": 6},
        "links": {"type": "array", "items": {"anyOf": [text, _object(LINK)]}, "minItems": 2},
        "places": {"type": "object", "additionalProperties": {**numbers, "minItems": 2, "maxItems": 3}},
        "directions": {"type": "object", "additionalProperties": number},
        "numbers": {**numbers, "minItems": 2},
        "names": {"type": "array", "items": text, "minItems": 2},
        "vector": {**numbers, "minItems": 2, "maxItems": 3},
        "point": {**numbers, "minItems": 2, "maxItems": 3},
        "place": {**numbers, "minItems": 2, "maxItems": 2},
        "place_in_space": {**numbers, "minItems": 3, "maxItems": 3},
        "vectors": {"type": "array", "items": {"$ref": "#/$defs/vector"}, "minItems": 2, "maxItems": 2},
        "axis": {"anyOf": [{"enum": ["x", "y", "z"]}, {**numbers, "minItems": 3, "maxItems": 3}]},
        "row": {"anyOf": [_object(DH_ROW), _object(FRAME_ROW)]},
        "rows": _table({"$ref": "#/$defs/row"}, columns),
        "screw_rows": _table(_object(SCREW_ROW), screw_columns),
        "mechanism_joints": {"type": "array", "items": _object(MECHANISM_JOINT), "minItems": 1},
        "wheels": {"type": "array", "items": _object(WHEEL), "minItems": 1},
    }
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "robokin description, version 1",
        "description": "A robot, a tree of branches, a mechanism (links and joints, with loops), or a wheeled base.",
        "anyOf": [_object(fields) for fields in (ROBOT, SCREWS, ETS, OPW, TREE, MECHANISM, WHEELED)],
        "$defs": definitions,
    }


TYPE_LETTERS = {"R": "revolute", "P": "prismatic", "F": "fixed", "H": "helical"}
"""Short names of the row types."""


def _table(row: dict[str, Any], columns: dict[str, Any]) -> dict[str, Any]:
    """A table by rows, or by columns."""
    by_columns = {"type": "object", "properties": columns, "additionalProperties": False, "required": ["type"]}
    return {"anyOf": [{"type": "array", "items": row, "minItems": 1}, by_columns]}


def _object(fields: Fields) -> dict[str, Any]:
    properties: dict[str, Any] = {}
    for name, field in fields.items():
        if field.choices:
            letters = [letter for letter, full in TYPE_LETTERS.items() if full in field.choices]
            short = letters if "revolute" in field.choices and len(field.choices) <= len(ROW_TYPES) else []
            properties[name] = {"enum": [*field.choices, *short], "description": field.doc}
        else:
            properties[name] = {"$ref": f"#/$defs/{field.holds}", "description": field.doc}
    return {
        "type": "object",
        "properties": properties,
        "required": [name for name, field in fields.items() if field.required],
        "additionalProperties": False,
    }
