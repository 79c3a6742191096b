"""Schemas of `robokin workspace`: the whole, a place, and a line of samples."""

from __future__ import annotations

from robokin.records.pose_schemas import POSE
from robokin.records.schema_words import (
    ROBOT,
    Q,
    Schema,
    documents,
    flag,
    head,
    items,
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

UNKNOWN = "where it is not known"
GROUP = word("What an orientation is for this arm.", "SO(2)", "S2", "SO(3)", "curve", "finite")
POINT = numbers("x, y, z [length].", 3)
PLACES = {
    "min": rows("Configurations with the least x, y and z [joint].", 3),
    "max": rows("Configurations with the greatest x, y and z [joint].", 3),
    "least": Q,
    "greatest": Q,
}


def sizes(about: str, *names: str) -> dict[str, Schema]:
    """A size and the bound of its error, by the name of the quantity."""
    keys = {}
    for name in names:
        power = {"length": "length", "area": "length²", "volume": "length³"}[name]
        keys[name] = maybe(number(f"{about}: its {name} [{power}].", 0.0), UNKNOWN)
        keys[f"{name}_error"] = maybe(number(f"The true value is within ± this, at 99 % [{power}].", 0.0), UNKNOWN)
    return keys


def workspace() -> Schema:
    """Documents of `robokin workspace`."""
    place = record(
        "Whether a place is reachable, and with which orientations (--at).",
        {
            **head("robot", ROBOT),
            "position": POINT,
            "reachable": flag("Whether it is."),
            "reachable_is_proven": flag("Whether that is proven, or found by search."),
            "solutions": maybe(whole("Configurations that reach it.", 0), "where there are infinitely many"),
            "group": GROUP,
            "orientation": text("The same in words."),
            "orientations": maybe(whole("Orientations that were tried.", 1), "where none had to be"),
            "reached": maybe(whole("How many of them can be reached.", 0), UNKNOWN),
            "fraction": maybe(number("The part that can be reached, from 0 to 1 [1].", 0.0), UNKNOWN),
        },
        {
            "ranges": rows("Ranges of the angle that can be reached, from and to [angle].", None, 2),
            "ranges_of": maybe(text("What turns by that angle."), "where all or none can be reached"),
            "directions": rows("Directions of the tool's z axis that can be reached [1].", None, 3),
            "quaternions": rows("Orientations that can be reached, w, x, y, z [1].", None, 4),
        },
    )
    sample = record(
        "A sample (--output FILE.jsonl).",
        {**head("robot", ROBOT), "position": POINT}, {"q": Q, "pose": POSE},
    )  # fmt: skip
    about = "What an arm can reach, at a place, or sampled."
    return documents("workspace", about, ["workspace", "place"], workspace=_whole(), place=place, sample=sample)


def _whole() -> Schema:
    cut = record(
        "A section or a slice.",
        {
            "cut": text("Which one."),
            "axes": texts("The names of its axes."),
            **sizes("What is reachable in it", "area"),
            "parts": whole("Its parts.", 0),
            "holes": whole("Its holes.", 0),
            "outline": items(rows("A closed line [length].", None, 2), "Its boundary."),
        },
    )
    return record(
        "What an arm can reach.",
        {
            **head("robot", ROBOT),
            "samples": whole("How much was looked at.", 1),
            "seed": whole("The random seed.", 0),
            "sampling": word("How samples are taken.", "sobol", "random", "grid"),
            "bounds": record("A box about the set.", {"min": POINT, "max": POINT}),
            "reach": record(
                "Distances of the tool's origin.",
                {
                    "min": number("The least [length].", 0.0),
                    "max": number("The greatest [length].", 0.0),
                    "from": {"const": "base", "description": "From where."},
                },
            ),
            "dimension": whole("Of the set: 3 for a solid, 2, 1, or 0 for a point.", 0),
            "moving_joints": items(whole("A joint, from 1.", 1), "Joints that move the tool's origin."),
            "symmetric": flag("Whether the set is symmetric about the first joint's axis."),
            "structural_length": number("Sum of links' lengths and strokes [length].", 0.0),
            "length_index": maybe(number("That length by the cube root of the volume [1].", 0.0), "without a volume"),
            "volume_index": maybe(number("The volume by that of the ball of that radius [1].", 0.0), "without one"),
            "at": record("Configurations at the bounds.", PLACES),
            "dexterity": maybe(_dexterity(), "without --dextrous"),
            "cuts": items(cut, "Sections and slices that were asked for."),
            "notes": texts("What to know about the figures."),
        },
        {
            **sizes("The reachable set", "length", "area", "volume"),
            "method": text("How the size was found."),
            "evaluations": whole("Points or configurations that were looked at.", 0),
            "error_is_proven": flag("Whether the bound has no part that is unknown."),
        },
    )


def _dexterity() -> Schema:
    one = record(
        "A set of places.",
        {"needs": text("What a place needs to be in it.")},
        {
            **sizes("The set", "length", "area", "volume"),
            "holds": flag("Of a set that is one point: whether it is it."),
        },
    )
    return record(
        "How freely the tool can be turned (--dextrous).",
        {
            "group": GROUP,
            "orientation": text("The same in words."),
            "orientations": whole("Orientations of the grid.", 0),
            "spacing": number("Between them [angle].", 0.0),
            "mean": maybe(number("Mean part that can be reached, from 0 to 1 [1].", 0.0), "without a grid"),
            "sets": record("The three sets.", dict.fromkeys(("reachable", "several", "every"), one)),
            "map": record(
                "Place by place.",
                {
                    "cell": number("Side of a cell [length].", 0.0),
                    "section": flag("Whether it is of the half plane that the first joint turns."),
                    "points": rows("Centres of the cells [length].", None, 3),
                    "fraction": numbers("The part that can be reached there, from 0 to 1 [1]."),
                },
            ),
        },
    )
