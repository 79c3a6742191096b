"""The numbers of a Denavit-Hartenberg table of an arm of frames, before they are parted into rows.

A slide may stand anywhere on its way, and frames anywhere on their axes: where axes are nearly parallel, and their
common normal so far away that its foot is lost in rounding, a slide is moved near, and else the table refused.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError, shown
from robokin.kinematics.common_normal import FAR_FEET, PARALLEL, NormalStep, normal_step, turn, turn_and_shift
from robokin.model import Robot
from robokin.model.robot import Convention, row_constants
from robokin.spatial import exact, invert

NEGLIGIBLE = 1e-13
"""The same for one cell: what is shorter, in the arm's size, or a smaller angle [rad], is rounding."""


@dataclass(frozen=True)
class TableCells:
    """The numbers of a table before they are parted into rows.

    base, tool: (4, 4) [m]; link: (a, alpha) before the first motion; steps: (n) of what stands after each motion;
    tilt [rad]: how far axes that count as parallel are from it.
    """

    base: Array
    link: tuple[float, float]
    steps: tuple[NormalStep, ...]
    tool: Array
    tilt: float


def constant_steps(robot: Robot) -> list[Array]:
    """The constant steps (n + 1) of (4, 4) before, between and after the motions along z, without base and tool."""
    steps = [np.eye(4)]
    for row in robot.rows:
        before, after = row_constants(replace(row, sense=1), robot.convention)
        steps[-1] = steps[-1] @ before
        if row.moves:
            steps.append(after)
        else:
            steps[-1] = steps[-1] @ after
    return steps


def cells_of(robot: Robot, convention: Convention, size: float) -> TableCells:
    """The numbers of the table of a robot of frames."""
    small = NEGLIGIBLE * size
    turns = robot.revolute
    steps = _with_slides_near(robot, constant_steps(robot), size)
    base, link, rest = _first(robot.base, steps[0], convention, small)
    found, tilt = [], 0.0
    for i in range(1, robot.n):
        step = normal_step(rest @ steps[i], small)
        if step.tilted(FAR_FEET * size) and not turns[i]:
            # A slide may stand anywhere: it is moved to the frame before it, and its place is the next row's matter.
            moved = rest @ steps[i]
            away = moved[:3, :3].T @ moved[:3, 3]
            steps[i + 1] = _moved(away) @ steps[i + 1]
            step = normal_step(turn(moved), small)
        if step.tilted(FAR_FEET * size):
            raise _refusal(robot, i, step, convention)
        tilt = max(tilt, step.snapped)
        found.append(step)
        rest = step.rest()
    last = rest @ steps[robot.n]
    whole = normal_step(last @ robot.tool, small).ended()
    ends = _nothing(whole.e, whole.phi, small) and whole.snapped <= NEGLIGIBLE
    if convention == "modified":
        ends = ends and _nothing(whole.a, whole.alpha, small)
    if ends:
        found.append(whole)
        tool = np.eye(4)
    else:
        found.append(NormalStep(math.atan2(rest[1, 0], rest[0, 0]), float(rest[2, 3]), 0.0, 0.0))
        tool = exact(steps[robot.n] @ robot.tool)
    return TableCells(base, link, tuple(found), tool, tilt)


def _nothing(length: float, angle: float, small: float) -> bool:
    """Whether a length [m] and an angle [rad] are both no more than rounding."""
    return abs(length) <= small and abs(angle) <= NEGLIGIBLE


def _moved(p: Array) -> Array:
    """The translation (4, 4) by p: (3,) [m]."""
    T = np.eye(4)
    T[:3, 3] = p
    return T


def _with_slides_near(robot: Robot, steps: list[Array], size: float) -> list[Array]:
    """The steps, slides moved onto the next axis where that is nearly parallel to theirs and the normal far away."""
    for i in range(robot.n - 1, 0, -1):
        step = normal_step(steps[i], NEGLIGIBLE * size)
        if not robot.revolute[i - 1] and step.tilted(FAR_FEET * size):
            steps[i - 1] = steps[i - 1] @ _moved(steps[i][:3, 3])
            steps[i] = turn(steps[i])
    return steps


def _first(base: Array, step: Array, convention: Convention, small: float) -> tuple[Array, tuple[float, float], Array]:
    """The base, a and alpha before the first motion, and what is passed on through it.

    A modified table holds a and alpha where nothing else is needed. Else the base's z lies on the first axis, its
    origin at the foot of the perpendicular from the old one, its x as near to the old one as it can be.
    """
    if convention == "modified":
        whole = normal_step(step, small)
        if _nothing(whole.d, whole.theta, small) and not whole.snapped > NEGLIGIBLE and not whole.tilted(math.inf):
            return base, (whole.a, whole.alpha), whole.rest()
    z, p = step[:3, 2], step[:3, 3]
    along = float(z @ p)
    x = np.array([1.0, 0.0, 0.0]) - z[0] * z
    if float(np.linalg.norm(x)) < PARALLEL:
        x = np.array([0.0, 1.0, 0.0]) - z[1] * z
    x /= np.linalg.norm(x)
    phi = math.atan2(float(step[:3, 0] @ np.cross(z, x)), float(step[:3, 0] @ x))
    rest = turn_and_shift(phi, along)
    return exact(base @ exact(step @ invert(rest))), (0.0, 0.0), rest


def _refusal(robot: Robot, i: int, step: NormalStep, convention: Convention) -> InputError:
    """The error for joint i + 1 (from 1) whose axis is nearly parallel to that of the joint before it."""
    before, after = robot.joints[i - 1].name, robot.joints[i].name
    return InputError(
        f"the axes of joints {shown(before)} and {shown(after)} of {shown(robot.name)} are {step.tilt:.2g} rad from "
        f"parallel and their common normal is {step.feet:.3g} m away, expected axes that are parallel or clearly not "
        f"for a {convention} table; convention frames holds them as they are"
    )
