"""Schemas of `robokin list`, `show`, `convert`, `new` and `validate`."""

from __future__ import annotations

from robokin.records.schema_words import (
    ROBOT,
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

KIND = word("What it is.", "robot", "mechanism", "wheeled", "tree")
SPACE = word("Where it lives.", "planar", "spherical", "spatial")
PARAMETERS = mapping(number("Its value, in the description's units."), "The description's parameters, by name.")


def list_() -> Schema:
    """Documents of `robokin list`."""
    keys = head("name", text("The name in full."))
    document = record(
        "An entry of the library.",
        {
            **keys,
            "kind": KIND,
            "joints": text("The joints' types, or what else tells it apart, in a word: RRRRRR."),
            "dof": maybe(whole("Joints of a robot, or the freedoms that the file states."), "where none are stated"),
            "source": text("Where the numbers come from."),
        },
    )
    return documents("list", "The library; `units` are those of the description.", ["entry"], entry=document)


def validate() -> Schema:
    """Documents of `robokin validate`."""
    place = record(
        "A place in the file, and what is said of it.",
        {
            "line": maybe(whole("Where, from 1.", 1), "where that is not known"),
            "column": maybe(whole("Where in the line, from 1.", 1), "where that is not known"),
            "message": text("What is said of it."),
        },
    )
    document = record(
        "Whether a file is a description.",
        {
            **head("file", text("The file, as it was given."), units=False),
            "valid": flag("Whether it is one."),
            "kind": maybe(KIND, "where it is none"),
            "name": maybe(text("The name in full."), "where it is none"),
            "error": maybe(text("What is wrong."), "where nothing is"),
            "line": maybe(whole("Where, from 1.", 1), "where that is not known"),
            "column": maybe(whole("Where in the line, from 1.", 1), "where that is not known"),
            "errors": items(place, "Every mistake, in the order of the file."),
            "notes": items(place, "What looks like a slip in a description that can be read."),
            "units": maybe(UNITS, "where it is none"),
        },
    )
    return documents("validate", "A verdict for each file.", ["verdict"], verdict=document)


def show() -> Schema:
    """Documents of `robokin show`."""
    about = _about()
    variants = {
        "robot": _robot(about, made=True),
        "tree": _tree(about),
        "mechanism": _mechanism(about),
        "wheeled": _base(about),
    }
    return documents("show", "What a description describes.", [], **variants)


def convert() -> Schema:
    """Documents of `robokin convert`."""
    about = _about()
    text = "A robot, as `show` has it, in the convention asked for, or a tree."
    return documents("convert", text, [], robot=_robot(about), tree=_tree(about))


def new() -> Schema:
    """Documents of `robokin new`."""
    document = record(
        "A description that was made.",
        {
            **head("file", text("The file that was written, - for none.")),
            "from": maybe(text("The robot or the file that it is a copy of."), "where it is none"),
            "joints": maybe(text("The rows' types in a word, such as RRP, F for a fixed one."), "of a copy"),
            "convention": maybe(word("The convention of its table.", "standard", "modified"), "of a copy"),
            "notes": texts("How a table was read, where it left that open."),
            "missing": texts("The names of lengths for which a table gives no value."),
            "description": text("The description itself, YAML."),
        },
    )
    return documents("new", "A description of a robot of one's own.", ["description"], description=document)


def _about() -> dict[str, Schema]:
    """What is said of everything that can be described."""
    return {
        "name": text("The name in full."),
        "description": text("What it is, in a line."),
        "source": text("Where the numbers come from."),
        "parameters": PARAMETERS,
    }


def _row() -> Schema:
    limits = maybe(numbers("Least and greatest value [joint].", 2), "where it has none")
    frames = {
        "origin": maybe(matrix("Pose in the frame before, at q = 0"), "in a DH table"),
        "axis": maybe(numbers("The joint's axis [1].", 3), "of a fixed row, and where it is z"),
    }
    cells = {
        "theta": maybe(number("Its constant [angle]."), "where the variable stands"),
        "d": maybe(number("Its constant [length]."), "where the variable stands"),
        "a": number("The row's a [length]."),
        "alpha": number("The row's alpha [angle]."),
    }
    return record(
        "A row of the table.",
        {
            "i": whole("Its number.", 1),
            "name": text("Its name."),
            "type": word("What it does.", "revolute", "prismatic", "helical", "fixed"),
            "variable": maybe(text("Its variable, such as q1."), "of a fixed row, and of one that follows others"),
            "offset": maybe(number("Added to the variable [joint]."), "of a fixed row"),
            "sense": maybe(whole("1, or -1 where the variable enters with the other sign.", -1), "of a fixed row"),
            "limits": limits,
        },
        frames
        | cells
        | {
            "pitch": number("What a helical row advances in a turn [length]."),
            "motion_limits": numbers("Least and greatest value of the joint itself [joint].", 2),
        },
    )


def _robot(about: dict[str, Schema], made: bool = False) -> Schema:
    """A robot; made: whether its table may be one that nobody wrote."""
    source = {"const": "frames", "description": "What the table was made from, where nobody wrote it."}
    at_zero = record(
        "Where the tool frame stands with every joint at zero.",
        {
            "position": numbers("Its origin [length].", 3),
            "z": numbers("Its z axis [1].", 3),
            "z_along": maybe(word("The base's axis that z is along.", "+x", "-x", "+y", "-y", "+z", "-z"), "else"),
        },
    )
    inverse = record(
        "How the inverse kinematics is solved.",
        {
            "method": text("The method."),
            "reason": text("Why that one."),
            "complete": flag("Whether every solution is found."),
        },
    )
    return record(
        "A robot.",
        {
            **head("robot", ROBOT),
            **about,
            "kind": {"const": "robot", "description": "What it is."},
            "convention": word("How the rows are read.", "standard", "modified", "frames"),
            "joints": text("The joints' types in a word, such as RRRRRR."),
            "class": text("The class of arm."),
            "wrist": maybe(text("The wrist."), "where it has none"),
            "n": whole("Joints, N.", 0),
            "m": whole("Dimension of the poses that it can reach, M.", 0),
            "redundancy": whole("R = N − M."),
            "grubler": whole("Grübler's count."),
            "inverse": maybe(inverse, "of a robot without joints"),
            "base": matrix("From the world to the first frame"),
            "tool": matrix("From the last frame to the end effector"),
            "at_zero": at_zero,
            "rows": items(_row(), "The table."),
            "poses": mapping(numbers("Joint values [joint]."), "Named poses."),
        },
        ({"made_from": source} if made else {})
        | {
            "couplings": items(_coupling(), "Of a robot whose joints hang on each other: which on which."),
            "beside": items(_beside(), "Joints that are not in the chain and move joints of it."),
        },
    )


def _beside() -> Schema:
    return record(
        "A joint beside the chain.",
        {
            "variable": text("Its variable, such as q3."),
            "joint": text("Its name."),
            "type": word("How it moves.", "revolute", "prismatic"),
            "limits": maybe(numbers("Its least and its greatest value [joint]."), "where it has none"),
        },
    )


def _coupling() -> Schema:
    ratio = record(
        "A joint, and what its value counts.",
        {"joint": text("Its name."), "ratio": number("Of one unit's value to the other's.")},
    )
    return record(
        "A joint whose value hangs on those of others.",
        {
            "joint": text("Its name."),
            "own": flag("Whether it has a variable of its own, which is added; else it follows."),
            "ratios": items(ratio, "What it hangs on."),
            "offset": number("What is added [joint]."),
        },
    )


def _mechanism(about: dict[str, Schema]) -> Schema:
    joint = record(
        "A joint.",
        {
            "name": text("Its name."),
            "type": text("Its type."),
            "links": texts("The links that it joins."),
            "freedoms": whole("Its freedoms f.", 0),
            "at": maybe(numbers("A point on it [length].", 3), "where none is given"),
            "axes": maybe(rows("Its unit directions [1].", None, 3), "where none is given"),
            "actuated": flag("Whether it is driven."),
            "turns": maybe(numbers("Of gears and belts: each link's turns for one of the first [1]."), "of others"),
            "carrier": maybe(text("The link that carries the wheels."), "where it is clear, and of others"),
        },
    )
    return record(
        "A mechanism.",
        {
            **head("mechanism", text("The mechanism, as `id`.")),
            **about,
            "kind": {"const": "mechanism", "description": "What it is."},
            "space": SPACE,
            "links": texts("The links."),
            "ground": text("The link that stands still."),
            "output": maybe(text("The link that the others serve."), "where none is named"),
            "grubler": whole("Grübler's count."),
            "joints": items(joint, "The joints."),
        },
    )


def _tree(about: dict[str, Schema]) -> Schema:
    other = record(
        "Another joint that it hangs on.",
        {"joint": text("Its name."), "ratio": number("To its value, in SI [1, rad/m or m/rad].")},
    )
    joint = record(
        "A joint that moves.",
        {
            "i": whole("Its number.", 1),
            "name": text("Its name."),
            "type": text("Its type."),
            "variable": maybe(text("Its variable, such as q1."), "where it follows another joint"),
            "parent": text("The link before it."),
            "child": text("The link after it."),
            "limits": maybe(numbers("Least and greatest value [joint].", 2), "where it has none"),
            "follows": items(other, "The joints whose values are added to its own, or are its value."),
        },
    )
    tip = record("A tip.", {"name": text("Its name."), "link": text("The link that it is on.")})
    return record(
        "A tree of links.",
        {
            **head("robot", text("The tree, as `id`.")),
            **about,
            "kind": {"const": "tree", "description": "What it is."},
            "n": whole("Joint variables N.", 0),
            "joints": items(joint, "The joints that move."),
            "tips": items(tip, "The frames that are asked for."),
            "poses": mapping(numbers("Joint values [joint]."), "Named configurations."),
        },
    )


def _base(about: dict[str, Schema]) -> Schema:
    wheel = record(
        "A wheel.",
        {
            "name": text("Its name."),
            "type": word("What it is.", "fixed", "steered", "castor", "swedish", "ball"),
            "at": numbers("Where it is, x and y [length].", 2),
            "angle": number("The direction in which it rolls [angle]."),
            "radius": maybe(number("Its radius [length].", 0.0), "where none is given"),
            "offset": maybe(number("A castor's, from swivel to wheel [length]."), "of others"),
            "roller": maybe(number("The direction of a Swedish wheel's rollers [angle]."), "of others"),
            "driven": flag("Whether a motor turns it."),
            "turned": flag("Whether a motor steers it."),
        },
    )
    return record(
        "A wheeled base.",
        {
            **head("base", text("The base, as `id`.")),
            **about,
            "kind": {"const": "wheeled", "description": "What it is."},
            "steering": word("How steered wheels go together.", "independent", "parallel"),
            "wheels": items(wheel, "The wheels."),
        },
    )
