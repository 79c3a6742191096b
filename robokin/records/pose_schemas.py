"""Schemas of `robokin fk`, `frame`, `jacobian`, `singular` and `path`."""

from __future__ import annotations

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
    whole,
    word,
)

RPY = numbers("Roll, pitch, yaw: R = Rz(yaw) Ry(pitch) Rx(roll) [angle].", 3)
EULER = numbers("Z Y Z Euler angles phi, theta, psi [angle].", 3)
ROTVEC = numbers("The rotation vector: axis times angle [angle].", 3)
QUATERNION = numbers("The rotation as a quaternion w, x, y, z of length 1 [1].", 4)
POSITION = numbers("The origin x, y, z [length].", 3)

ON_DEMAND = {
    "quaternion_xyzw": numbers("The quaternion as x, y, z, w [1].", 4),
    "abc": numbers("KUKA's angles A, B, C [angle].", 3),
    "wpr": numbers("FANUC's angles W, P, R [angle].", 3),
}
"""Orientations that are there when --as asks for them."""

POSE = record(
    "A pose of the end effector in the world.",
    {"matrix": matrix("The pose"), "position": POSITION, "rpy": RPY, "quaternion": QUATERNION},
    {
        "euler": EULER,
        "rotvec": ROTVEC,
        **ON_DEMAND,
    },
)
FRAMES = items(
    record("A frame.", {"name": text("The row's number, from 1."), "matrix": matrix("Its pose in the world")}),
    "The frame after each row of the table.",
)
SYMBOLS = items(items({"type": "string"}, "A row of expressions."), "A matrix of expressions, row by row.")
NAMED_SYMBOLS = items(
    record("A matrix.", {"name": text("Its name, such as A1."), "matrix": SYMBOLS}), "The matrices that T is made of."
)


def fk() -> Schema:
    """Documents of `robokin fk`."""
    pose = record(
        "The pose of the end effector at joint values.",
        {**head("robot", ROBOT), "q": Q, "within_limits": flag("Whether all joints are within limits."), "pose": POSE},
        {"frames": FRAMES},
    )
    tips = record(
        "The poses of a tree's tips at joint values.",
        {
            **head("robot", ROBOT),
            "q": Q,
            "within_limits": flag("Whether all joints are within limits."),
            "tips": mapping(POSE, "The pose of each tip, by its name."),
        },
    )
    symbolic = record(
        "Forward kinematics in symbols (--symbolic).",
        {
            **head("robot", ROBOT),
            "matrices": NAMED_SYMBOLS,
            "T": SYMBOLS,
            "symbols": mapping({"type": ["string", "number"]}, "What each symbol stands for: a number or a text."),
        },
        {"frames": NAMED_SYMBOLS},
    )
    return documents(
        "fk",
        "Poses, or forward kinematics in symbols.",
        ["pose", "tips"],
        pose=pose,
        tips=tips,
        symbolic=symbolic,
    )


def frame() -> Schema:
    """Documents of `robokin frame`."""
    axis_angle = record(
        "The rotation as an angle about an axis.",
        {"axis": numbers("A unit vector [1].", 3), "angle": number("From 0 to half a turn [angle].", 0.0)},
    )
    columns = {
        name: numbers(f"Column {name} of the rotation: the frame's {axis} axis [1].", 3)
        for name, axis in zip("nsa", "xyz", strict=True)
    }
    forms: dict[str, Schema] = {
        "matrix": matrix("The transform"),
        **columns,
        "p": numbers("Column p: the origin [length].", 3),
        "position": POSITION,
        "rpy": RPY,
        "euler": EULER,
        "quaternion": QUATERNION,
        "axis_angle": axis_angle,
        "rotvec": ROTVEC,
    }
    screw = record(
        "The screw motion from the first frame to the second, in the coordinates of both.",
        {
            "axis": maybe(numbers("The direction of the axis, a unit vector [1]", 3), "where nothing moves."),
            "point": maybe(numbers("The place of the axis nearest to the origin [length]", 3), "of a translation."),
            "angle": number("The turn about the axis, from 0 to half a turn [angle].", 0.0),
            "translation": number("The slide along the axis [length]."),
            "pitch": maybe(number("The slide for each radian [length]"), "of a translation."),
        },
    )
    document = record(
        "A transform, and with --to the way from it to another.",
        {**head("expression", text("The transform expression.")), **forms},
        {
            **ON_DEMAND,
            "point": numbers("Where --point is taken to [length].", 3),
            "to": record("The frame of --to.", {"expression": text("Its transform expression."), **forms}, ON_DEMAND),
            "relative": record("The second frame in the first.", forms, ON_DEMAND),
            "distance": number("From one origin to the other [length].", 0.0),
            "screw": screw,
            "along": word("How the frame moves in a picture and in rows.", "line", "screw"),
        },
    )
    return documents("frame", "A transform in every form; `id` repeats the expression.", [], transform=document)


LOST = record(
    "A direction that the tool cannot move in.",
    {
        "twist": numbers("Of length 1, linear before angular, lengths in `size` [1].", 6),
        "words": text("The same in words."),
    },
)


def jacobian() -> Schema:
    """Documents of `robokin jacobian`."""
    document = record(
        "The geometric Jacobian at joint values, and what it says.",
        {
            **head("robot", ROBOT),
            "jacobian_units": record(
                "The units of `jacobian`: angles are radians there.",
                {"length": word("Unit of lengths.", "m", "cm", "mm", "in"), "angle": word("Unit of angles.", "rad")},
            ),
            "q": Q,
            "frame": word("Whose axes the twist is in.", "base", "tool"),
            "task": word("What of the twist counts.", "pose", "position", "orientation"),
            "jacobian": rows("6×n, a row each for vx, vy, vz, wx, wy, wz [length/rad or 1; 1 or 0].", 6),
            "rank": whole("Directions that the tool can move in here.", 0),
            "full_rank": whole("Directions that it can move in at other configurations.", 0),
            "size": number("The arm's size, which makes lengths pure numbers [length].", 0.0),
            "singular_values": numbers("Greatest first, lengths in `size` [1]."),
            "manipulability": number("√det(J Jᵀ) of the Jacobian as it is printed.", 0.0),
            "condition": maybe(number("Greatest by least singular value [1].", 1.0), "where it is infinite"),
            "singular_direction": maybe(items(LOST, "Directions that are lost here."), "where nothing is lost"),
            "null_space_joints": items(whole("A joint, from 1.", 1), "Joints that can move while the tool stands."),
        },
        {
            "force": numbers("The force [N] and the moment [N m] that the tool is to exert, in the frame's axes.", 6),
            "torques": numbers("What the joints have to give for it: Jᵀ F [N m, of slides N]."),
        },
    )
    return documents("jacobian", "Jacobians.", ["jacobian"], jacobian=document)


def singular() -> Schema:
    """Documents of `robokin singular`."""
    about = {
        **head("robot", ROBOT),
        "task": word("What of the twist counts.", "pose", "position", "orientation"),
        "full_rank": whole("Directions that the tool can move in in general.", 0),
    }
    one = {
        "name": word("Where it is.", "shoulder", "elbow", "boundary", "wrist", "general"),
        "joints": items(whole("A joint, from 1.", 1), "The joints that the condition is on."),
        "condition": text("The condition in a line."),
        "values": {
            "description": "Of one joint its values, of several a list for each set of values [joint].",
            "anyOf": [numbers("Values of one joint."), rows("Sets of values.")],
        },
        "within_limits": items(flag("Whether the joint limits allow them."), "A flag for each of `values`."),
        "example": Q,
        "example_within_limits": flag("Whether the example is within the joint limits."),
        "lost": text("What the tool cannot do at the example."),
    }
    whole_list = record(
        "All singular configurations.",
        {**about, "singularities": items(record("A condition.", one), "The conditions that were found.")},
    )
    return documents(
        "singular", "Singular configurations; a line of JSON lines holds one.", [], singularities=whole_list,
        singularity=record("One condition.", about | one),
    )  # fmt: skip


def _branched() -> dict[str, Schema]:
    """What a path says of its branches, where there are some."""
    turn = record(
        "A first move: joints turn while the tool stands still, where a line goes on only from another configuration.",
        {
            "steps": whole("How many steps it takes.", 0),
            "joints": items(whole("A joint, from 1.", 1), "Those that turn."),
            "end": numbers("The configuration that the line begins from [joint]."),
        },
    )
    each_turn = record(
        "A turn of joints while the tool stands still, to a configuration from which a line goes on.",
        {
            "fraction": number("Where on the path it begins, from 0 to 1 [1].", 0.0),
            "row": whole("The place in `path` of its first row, from 0.", 0),
            "steps": whole("How many steps it takes.", 0),
            "joints": items(whole("A joint, from 1.", 1), "Those that turn."),
            "end": numbers("The configuration that the line goes on from [joint]."),
        },
    )
    branch = record(
        "A branch that was tried for a path.",
        {
            "branch": text("The name of its posture at the start, empty where the arm has none."),
            "start": numbers("The configuration that it begins from [joint]."),
            "complete": flag("Whether it reaches the end."),
            "fraction": number("The part of the lines or the arc that it can follow, from 0 to 1 [1].", 0.0),
            "travel": numbers("How far each joint goes, both ways counted [joint]."),
            "ends_by": maybe(text("What ends it."), "where it reaches the end"),
            "chosen": flag("Whether the path takes it."),
        },
    )
    blend = record(
        "A point that the tool passes by.",
        {
            "point": whole("Which one, from 1.", 1),
            "fraction": number("Where on the path the tool is nearest to it, from 0 to 1 [1].", 0.0),
            "begins": number("Where the blend begins [1].", 0.0),
            "ends": number("Where it ends [1].", 0.0),
            "distance": number("How far from the point the tool passes [length].", 0.0),
            "angle": number(
                "By how much its orientation differs from the point's there, 0 where that is not followed [angle].", 0.0
            ),
        },
    )
    return {
        "hold": mapping(number("The joint's value [joint]."), "Joints that are held (--hold), by q and number."),
        "blends": items(blend, "The points between that the tool passes by (--blend, --blend-radius)."),
        "choices": items(text("A sentence."), "What may be meant otherwise: half a turn, blends without a point."),
        "branch": text("The name of the posture that a line or an arc begins in."),
        "branch_at_end": text("The name of that which it ends in: another one after a singular configuration."),
        "reorientation": turn,
        "reorientations": items(each_turn, "All such turns, also those at points between."),
        "branches": items(branch, "The branches that were tried, the best first: of a line or an arc from a pose, or "
                          "that does not reach its end."),
    }  # fmt: skip


def path() -> Schema:
    """Documents of `robokin path`."""
    row = {
        "t": number("Time [s], of a path without a duration from 0 to 1 [1].", 0.0),
        "q": Q,
        "position": POSITION,
        "rpy": RPY,
    }
    rates = {
        "velocity": numbers("The joints' velocities [joint/s]."),
        "acceleration": numbers("The joints' accelerations [joint/s²]."),
    }
    timed = {
        "duration": number("How long it takes [s].", 0.0),
        "fastest": record("The greatest of each joint among the rows, without sign.", rates),
    }
    event = record(
        "Something on the way.",
        {
            "kind": word("What happens.", "limit", "singularity", "unreachable", "jump"),
            "fraction": number("Where on the path, from 0 to 1 [1].", 0.0),
            "joint": maybe(whole("The joint, from 1.", 1), "where it is not about one joint"),
            "value": maybe(number("The joint's value there [joint]."), "where it is not about one joint"),
            "words": text("The same in words."),
        },
    )
    document = record(
        "A path.",
        {
            **head("robot", ROBOT),
            "kind": word("How the tool moves.", "joint", "line", "arc"),
            "steps": whole("Steps that were asked for.", 1),
            "complete": flag("Whether the end is reached."),
            "fraction": number("The part of the path that can be followed, from 0 to 1 [1].", 0.0),
            "length": number("How far the tool's origin travels [length].", 0.0),
            "greatest_moves": numbers("How far apart each joint's least and greatest values are [joint]."),
            "least_manipulability": number("The least √det(J Jᵀ) on the way.", 0.0),
            "events": items(event, "What happens on the way, in its order."),
            "path": items(record("A row.", row, rates), "The rows, from the start to where the path ends."),
        },
        timed | _branched(),
    )
    line = record("A row (JSON lines).", {**head("robot", ROBOT), **row}, rates)
    return documents("path", "A path; a line of JSON lines holds one row.", [], path=document, row=line)
