"""Schemas of `robokin ik` and `plot`."""

from __future__ import annotations

from robokin.records.pose_schemas import FRAMES, POSE
from robokin.records.schema_words import (
    ROBOT,
    Q,
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

JOINTS = items(whole("A joint, from 1.", 1), "Joints, in numbers from 1.")
TASK = word("What of it counts: all, position and z axis, or position.", "pose", "approach", "position")
INTERVAL = record(
    "A piece of a self-motion within the joint limits.",
    {
        "whole": flag("Whether it is a closed curve, all of it within the limits."),
        "from": Q,
        "to": Q,
        "ranges": mapping(numbers("From and to [joint].", 2), "The least and the greatest value of each joint."),
    },
    {"swivel": numbers("From and to: the elbow's angle about the line from shoulder to wrist [angle].", 2)},
)
FAMILY = record(
    "A self-motion: configurations that are connected and all reach the target.",
    {
        "joints": JOINTS,
        "dimension": whole("1 for a curve, more for a surface.", 0),
        "closed": flag("Whether a curve was followed until it closed."),
        "solution": maybe(whole("Which listed solution stands for it, from 1.", 1), "where none does"),
        "intervals": items(INTERVAL, "Its pieces within the joint limits."),
    },
)
SOLUTION = record(
    "A configuration, with how far its pose is from the target.",
    {
        "q": Q,
        "branch": text("Its name: shoulder, elbow, wrist."),
        "within_limits": flag("Whether it respects the joint limits."),
        "position_error": number("Distance from the target, by forward kinematics [length].", 0.0),
        "angle_error": number("Angle to the target, by forward kinematics [angle].", 0.0),
    },
    {"self_motion": JOINTS},
)
ANY = {
    "description": "A number, or lists of numbers [length, angle or 1].",
    "anyOf": [{"type": "number"}, numbers("A vector."), rows("A matrix.")],
}
EXPLANATION = record(
    "The steps of the closed form (--explain).",
    {
        "title": text("What is solved."),
        "given": mapping(ANY, "What is known at the start, by name."),
        "steps": items(
            record(
                "A step.",
                {
                    "name": text("What is found."),
                    "formula": text("name = formula."),
                    "values": mapping(ANY, "What stands in the formula, by name."),
                    "result": ANY,
                    "branch": text("The signs that were chosen before."),
                    "note": text("What the step is for."),
                },
            ),
            "The steps, in their order.",
        ),
        "branches": items(
            record(
                "The end of a branch.",
                {
                    "branch": text("The signs."),
                    "name": text("The name of the configuration."),
                    "q": maybe(Q, "where the branch has no configuration"),
                    "solution": maybe(whole("Which listed solution it is, from 1.", 1), "where it is none"),
                    "reason": maybe(text("Why it is none."), "where it is one"),
                },
            ),
            "Where the branches end.",
        ),
    },
)


def ik() -> Schema:
    """Documents of `robokin ik`."""
    document = record(
        "All solutions for a target.",
        {
            **head("robot", ROBOT),
            "target": record(
                "What was asked for.",
                {
                    "matrix": matrix("The pose of the end effector in the world"),
                    "task": TASK,
                },
            ),
            "reachable": flag("Whether there is a solution."),
            "complete": flag("Whether every solution is listed, or on one of `families`."),
            "basis": maybe(word("What `complete` rests on.", "counted", "accounted"), "where it is false"),
            "certificate": text("The basis in a sentence, or why there is none."),
            "counts": mapping(whole("A number of candidates.", 0), "How many were left after each step."),
            "families": items(FAMILY, "Self-motions through the target."),
            "families_complete": flag("Whether every self-motion within the limits is one of `families`."),
            "method": text("How it was solved."),
            "reason": maybe(text("Why there is no solution."), "where there is one"),
            "solutions": items(SOLUTION, "The solutions."),
            "nearest": maybe(SOLUTION, "where there is a solution, or none is known"),
        },
        {
            "hold": mapping(number("The joint's value [joint]."), "Joints that are held (--hold), by q and number."),
            "explanation": EXPLANATION,
            "jump": flag("Whether a joint moves by more than --max-jump from the answer before (--near previous)."),
        },
    )  # fmt: skip
    about = "Solutions of the inverse kinematics, a document a target, or one for targets of several tips."
    return documents("ik", about, ["solutions"], solutions=document, tips=_tips())


def _tips() -> Schema:
    """The document for targets of several tips."""
    target = record("What was asked of a tip.", {"matrix": matrix("The pose of the tip in the world"), "task": TASK})
    error = record(
        "How far a tip is from its target.",
        {
            "position_error": number("Distance, by forward kinematics [length].", 0.0),
            "angle_error": number("Angle, by forward kinematics, 0 where it is not asked for [angle].", 0.0),
        },
    )
    solution = record(
        "A configuration of the whole tree; joints of other groups stand at the first solution of these.",
        {
            "q": Q,
            "branch": text("Its name: shoulder, elbow, wrist."),
            "within_limits": flag("Whether the joints of the group respect the joint limits."),
            "tips": mapping(error, "The errors of the group's tips, by their names."),
        },
        {"self_motion": JOINTS},
    )
    group = record(
        "Tips that are solved for together.",
        {
            "tips": texts("Their names."),
            "joints": JOINTS,
            "reachable": flag("Whether there is a solution."),
            "complete": flag("Whether every solution is listed, or on one of `families`."),
            "basis": maybe(word("What `complete` rests on.", "counted", "accounted"), "where it is false"),
            "certificate": text("The basis in a sentence, or why there is none."),
            "counts": mapping(whole("A number of candidates.", 0), "How many were left after each step."),
            "families": items(FAMILY, "Self-motions through the targets."),
            "families_complete": flag("Whether every self-motion within the limits is one of `families`."),
            "method": text("How it was solved."),
            "reason": maybe(text("Why there is no solution."), "where there is one"),
            "solutions": items(solution, "The solutions."),
            "nearest": maybe(solution, "where there is a solution, or none is known"),
        },
    )
    return record(
        "Solutions for targets of several tips (--target).",
        {
            **head("robot", ROBOT),
            "targets": mapping(target, "The targets, by the tips' names."),
            "reachable": flag("Whether every group has a solution."),
            "complete": flag("Whether every solution of every group is listed."),
            "q": maybe(Q, "where a group has no solution"),
            "still": JOINTS,
            "groups": items(group, "Groups of tips that share no joint with each other."),
        },
    )


PLACE = numbers("x, y, z [length].", 3)
JOINT = record(
    "A joint in the picture.",
    {
        "name": text("Its name."),
        "type": word("What it does.", "revolute", "prismatic", "helical"),
        "position": PLACE,
        "axis": numbers("Its axis, a unit vector in the world [1].", 3),
    },
)
TREE_JOINT = record(
    "A joint of a tree in the picture.",
    {
        "name": text("Its name."),
        "type": word("What it does.", "revolute", "prismatic", "helical"),
        "position": PLACE,
        "axis": numbers("Its axis, a unit vector in the world [1].", 3),
    },
)
LINE = rows("Corners of a line [length].", None, 3)


def _trees() -> tuple[Schema, Schema]:
    """The trees of a picture, and one in a line."""
    tree = {
        "label": text("What the picture calls it."),
        "ghost": flag("Whether it is drawn pale."),
        "q": Q,
        "within_limits": flag("Whether all joints are within limits."),
        "lines": items(LINE, "Lines of links, from the root or a fork to the end of a branch."),
        "joints": items(TREE_JOINT, "The joints that move, those that follow others too."),
        "tips": mapping(POSE, "The pose of each tip, by its name."),
    }
    several = items(record("A tree.", tree, {"frames": FRAMES}), "The trees, the solid one first.")
    line = record("A tree.", {**head("robot", ROBOT), **tree}, {"frames": FRAMES})
    return record("Trees.", {**head("robot", ROBOT), "trees": several}), line


def plot() -> Schema:
    """Documents of `robokin plot`."""
    arm = {
        "label": text("What the picture calls it."),
        "ghost": flag("Whether it is drawn pale."),
        "q": Q,
        "within_limits": flag("Whether all joints are within limits."),
        "points": rows("Corners of the stick figure, base to tool [length].", None, 3),
        "joints": items(JOINT, "The joints."),
        "pose": POSE,
    }
    arms = record(
        "Arms.",
        {
            **head("robot", ROBOT),
            "target": maybe(matrix("The pose that was asked for"), "without --ik"),
            "reachable": maybe(flag("Whether it can be reached."), "without --ik"),
            "reason": maybe(text("Why not."), "where it can, and without --ik"),
            "arms": items(record("An arm.", arm, {"frames": FRAMES}), "The arms, the solid one first."),
        },
    )
    link = {
        "name": text("The link's name."),
        "points": mapping(PLACE, "Where its joints are as assembled, by name [length]."),
    }
    joint = {
        "name": text("The joint's name."),
        "type": text("Its type."),
        "links": texts("The links that it joins."),
        "position": maybe(PLACE, "where it is not known"),
        "axes": maybe(rows("Unit directions [1].", None, 3), "where none is known"),
    }
    mechanism = {
        **head("mechanism", text("The mechanism, as `id`.")),
        "name": text("Its name."),
        "space": word("Where it lives.", "planar", "spherical", "spatial"),
        "ground": text("The link that stands still."),
        "links": items(record("A link.", link), "The links."),
        "joints": items(record("A joint.", joint), "The joints."),
    }
    arm_line = record("An arm.", {**head("robot", ROBOT), **arm}, {"frames": FRAMES})
    link_line = record("A link.", {**head("mechanism", text("The mechanism, as `id`.")), **link})
    trees, tree_line = _trees()
    about = "What a picture shows; a line of JSON lines holds one arm, one tree or one link."
    drawn = record("A mechanism.", mechanism)
    return documents(
        "plot", about, [], arms=arms, trees=trees, mechanism=drawn, arm=arm_line, tree=tree_line, link=link_line
    )
