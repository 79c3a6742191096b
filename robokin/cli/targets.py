"""Targets of `robokin ik`: what the options and the lines of a batch say, as poses."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.cli.arguments import parse_numbers, split_vector
from robokin.cli.statuses import say
from robokin.errors import ExpressionError, InputError
from robokin.formats.number_expressions import Scope
from robokin.formats.transform_expressions import evaluate_transform
from robokin.kinematics.flat_arm import flat_arm, planar_pose, upright_tool
from robokin.model import Robot
from robokin.spatial import rotation_from_euler, rotation_from_quaternion, rotation_from_rpy, transform
from robokin.spatial.rotations import DIGITS_LOST
from robokin.tables.near_targets import near_enough
from robokin.units import Units


@dataclass(frozen=True)
class Target:
    """One target: T (4, 4) [m], the task (pose, approach or position), and sentences the user should see."""

    T: Array
    task: str
    notes: tuple[str, ...] = ()


def parse_target(options: dict[str, str | None], robot: Robot, units: Units) -> Target:
    """The target that the options say. Raises InputError when they say none, or two."""
    kinds = [name for name in ("--pose", "--matrix", "--xyz", "--xy") if options.get(name) is not None]
    if len(kinds) != 1:
        said = f"found {' and '.join(kinds)}" if kinds else "there is no target"
        raise InputError(f"{said}, expected one of --pose, --matrix, --xyz, --xy or --input")
    turns = [name for name in ("--rpy", "--euler", "--quat", "--approach") if options.get(name) is not None]
    if turns and kinds != ["--xyz"]:
        raise InputError(f"{turns[0]} goes with --xyz, expected it without {kinds[0]}")
    if options.get("--phi") is not None and kinds != ["--xy"]:
        raise InputError("--phi goes with --xy, the target of a planar arm")
    if len(turns) > 1:
        raise InputError(f"{' and '.join(turns)} exclude each other, expected one of them")
    text = options[kinds[0]] or ""
    if kinds == ["--pose"]:
        notes: list[str] = []
        try:
            T = evaluate_transform(text, Scope(degrees=units.degrees), units, notes)
        except ExpressionError as error:
            raise InputError(f"--pose: {error}") from None
        return Target(placed(T[:3, :3], T[:3, 3], "--pose", units), "pose", tuple(notes))
    if kinds == ["--matrix"]:
        return _matrix(text, units)
    if kinds == ["--xy"]:
        return _planar(text, options.get("--phi"), robot, units)
    p = parse_place(text, "--xyz", robot, units)
    if not turns:
        return Target(placed(np.eye(3), p, "--xyz", units), "position")
    R, task = _rotation(turns[0], options[turns[0]] or "", units)
    return Target(placed(R, p, "--xyz", units), task)


def _rotation(option: str, text: str, units: Units) -> tuple[Array, str]:
    if option == "--rpy":
        angles = parse_numbers(text, option, [True] * 3, units, "roll, pitch, yaw") * units.radians
        return rotation_from_rpy(angles), "pose"
    if option == "--euler":
        angles = parse_numbers(text, option, [True] * 3, units, "phi, theta, psi") * units.radians
        return rotation_from_euler(angles), "pose"
    if option == "--quat":
        return rotation_from_quaternion(_quaternion(text, option, units)), "pose"
    z = parse_numbers(text, option, [False] * 3, units, "x, y, z of the tool's z axis")
    z = z / max(np.max(np.abs(z)), np.finfo(float).tiny)
    length = float(np.linalg.norm(z))
    if length < 0.5:
        raise InputError(f"{option}: found a direction of length zero, expected the direction of the tool's z axis")
    z = z / length
    # Any x axis serves: the roll about z is left open.
    x = np.cross([0.0, 1.0, 0.0] if abs(z[1]) < 0.9 else [1.0, 0.0, 0.0], z)
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z], axis=1), "approach"


def _quaternion(text: str, option: str, units: Units) -> Array:
    values = parse_numbers(text, option, [False] * 4, units, "w, x, y, z")
    length = math.hypot(*values)
    if not abs(length - 1.0) <= DIGITS_LOST:
        raise InputError(f"{option}: found a quaternion of length {length:.6g}, expected 1")
    return values / length


def parse_place(text: str, option: str, robot: Robot, units: Units) -> Array:
    """A place (3,) [m]: x, y, z, or x, y alone for an arm that moves in the plane of x and y.

    Raises InputError that names the option.
    """
    if len(split_vector(text)) == 2 and (zero := flat_arm(robot)) is not None:
        x, y = parse_numbers(text, option, [False] * 2, units, "x, y") * units.metres
        return np.array([x, y, zero[2, 3]])
    also = ", or x, y" if flat_arm(robot) is not None else ""
    return parse_numbers(text, option, [False] * 3, units, f"x, y, z{also}") * units.metres


def _planar(text: str, phi: str | None, robot: Robot, units: Units) -> Target:
    from robokin.kinematics.structure import structure_of

    if structure_of(robot).arm != "planar":
        raise InputError(f"--xy is for planar arms, and {robot.name} is none, expected --xyz")
    zero = flat_arm(robot)
    if zero is None:
        raise InputError(f"--xy: {robot.name} does not move in the plane of x and y, expected --xyz")
    place = parse_numbers(text, "--xy", [False] * 2, units, "x, y") * units.metres
    if phi is None:
        return Target(_near(planar_pose(zero, place, None), "--xy", units), "position")
    (angle,) = parse_numbers(phi, "--phi", [True], units, "the angle of the tool's x axis to x") * units.radians
    if upright_tool(zero):
        raise InputError(f"--phi: the x axis of {robot.name}'s tool frame is upright, expected --xyz and --rpy")
    return Target(_near(planar_pose(zero, place, angle), "--xy", units), "pose")


def placed(R: Array, p: Array, option: str, units: Units) -> Array:
    """The pose (4, 4) [m] of a rotation (3, 3) and a place (3,) [m]. Raises InputError for one that is too far away."""
    return _near(transform(R, p), option, units)


def _near(T: Array, option: str, units: Units) -> Array:
    try:
        return near_enough(T, units)
    except ValueError as error:
        raise InputError(f"{option}: {error}") from None


def _matrix(text: str, units: Units) -> Target:
    from robokin.tables.pose_files import pose_in_file, pose_in_json

    inline = text.lstrip().startswith(("[", "{"))
    name = "--matrix" if inline else f"--matrix {text}"
    try:
        T, note = pose_in_json(text, name, units) if inline else pose_in_file(text, name, units, say)
    except ValueError as error:
        raise InputError(f"{name}: {error}") from None
    return Target(T, "pose", (note,) if note else ())
