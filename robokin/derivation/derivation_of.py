"""Which lesson an arm has, read off its axes: positioning arms, planar arms, wrists, and arms with a wrist."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from robokin.arrays import Array
from robokin.derivation.anthropomorphic import anthropomorphic_arm
from robokin.derivation.link_numbers import (
    SAME,
    Link,
    end_of,
    link_of,
    row_transform,
)
from robokin.derivation.planar_arms import planar_arm, wrist_point
from robokin.derivation.sliding_arms import cartesian_arm, cylindrical_arm, spherical_arm
from robokin.derivation.worked_steps import PositioningArm, Quantity, Stage, WorkedSteps, angles, index, lengths
from robokin.derivation.wrist import Wrist
from robokin.kernel.chain import Chain, chain_of, chain_size
from robokin.model import Robot
from robokin.spatial import invert, rotation_transform, translation_transform

POSITIONING = (anthropomorphic_arm, spherical_arm, cylindrical_arm, cartesian_arm)


@dataclass(frozen=True, eq=False)
class Derivation:
    """How a lesson goes.

    whole: whether it starts from the hand's whole pose (else from its position); base, rest: the frames (4, 4)
    before the first joint and after the last, T = base · T₀ⁿ · rest; stages, variables, zeros, known: as in `Arm`.
    """

    title: str
    whole: bool
    base: Array
    rest: Array
    stages: tuple[Stage, ...]
    variables: tuple[str, ...]
    zeros: tuple[float, ...]
    known: Mapping[str, Quantity] = field(default_factory=dict)


def plan_of(robot: Robot, held: Array) -> Derivation | None:
    """The plan for a robot, or None if it has no lesson; held: (n,) values of joints that are free [rad | m]."""
    chain = chain_of(robot)
    last = chain.constants[-1] @ invert(robot.tool)
    if chain.n == 6:
        return _decoupled(chain, last, robot.tool, held)
    if chain.n == 3 and (wrist := _wrist_alone(chain, last, robot.tool, held)) is not None:
        return wrist
    turning = int(np.sum(chain.revolute))
    if turning == 3 and (flat := planar_arm(chain, last)) is not None:
        arm, rest = flat
        numbers = [int(i) + 1 for i in np.flatnonzero(chain.revolute)]
        stages = (lambda sheet: wrist_point(sheet, numbers[-1]), *arm.stages)
        return Derivation(arm.title, True, arm.base, rest @ robot.tool, stages, arm.variables, arm.zeros, arm.known)
    if turning == 2 and chain.n <= 3 and (two := planar_arm(chain, chain.constants[-1])) is not None:
        return _positioning(two[0])
    if chain.n == 3:
        for find in POSITIONING:
            found = find(chain, chain.constants[-1])
            if found is not None:
                return _positioning(found)
    return None


def _positioning(arm: PositioningArm) -> Derivation:
    # Twists and K are for the rotation alone, which only a wrist needs.
    known = {name: value for name, value in arm.known.items() if name != "K" and not name.startswith("α")}
    return Derivation(arm.title, False, arm.base, np.eye(4), arm.stages, arm.variables, arm.zeros, known)


@dataclass(frozen=True, eq=False)
class _WristPlace:
    """A wrist's angles: what they are at zero, the hand beyond the last axis, and d of the last joint."""

    wrist: Wrist
    zeros: tuple[float, float, float]
    rest: Array
    d: float
    known: Mapping[str, Quantity]


def _wrist_of(chain: Chain, last: Array, gamma: float, held: float) -> _WristPlace | None:
    """The wrist of the last three joints, if their axes meet at right angles; gamma: the turn left over before them."""
    n, size = chain.n, chain_size(chain)
    if not chain.revolute[n - 3 :].all():
        return None
    one, two = (link_of(chain.constants[i], size) for i in (n - 2, n - 1))
    if not (one.right_angled and two.right_angled):
        return None
    if max(abs(one.a), abs(two.a), abs(one.epsilon + two.delta)) > SAME * size:
        return None
    row, _ = end_of(last, size)
    rest = invert(rotation_transform([0.0, 0.0, 1.0], row.beta) @ translation_transform([0.0, 0.0, row.delta])) @ last
    before = gamma + one.beta, one.gamma + two.beta, two.gamma + row.beta
    zeros = np.array(before) + chain.offsets[n - 3 :]
    wrist = Wrist(n - 2, one.sign, two.sign, held + float(zeros[0]))
    known = angles(**{f"α{index(n - 2)}": one.alpha, f"α{index(n - 1)}": two.alpha})
    return _WristPlace(wrist, tuple(zeros.tolist()), rest, two.epsilon + row.delta, known)


def _wrist_alone(chain: Chain, last: Array, tool: Array, held: Array) -> Derivation | None:
    place = _wrist_of(chain, last, 0.0, float(held[0]))
    if place is None:
        return None
    # The wrist's first link may lie along its axis before the centre: that moves no angle.
    name = place.wrist.name
    stages = (lambda sheet: [sheet.step(name, "R", "rotation")], *place.wrist.stages)
    return Derivation(
        "spherical wrist: the ZYZ angles of its rotation", True, chain.constants[0], place.rest @ tool, stages,
        ("θ₁", "θ₂", "θ₃"), place.zeros, place.known,
    )  # fmt: skip


def _decoupled(chain: Chain, last: Array, tool: Array, held: Array) -> Derivation | None:
    """An arm of three joints with a spherical wrist: the wrist centre for the arm, the rotation for the wrist."""
    size = chain_size(chain)
    three = link_of(chain.constants[3], size)
    place = _wrist_of(chain, last, three.gamma, float(held[3]))
    if place is None:
        return None
    d4 = three.epsilon + link_of(chain.constants[4], size).delta
    d4 = 0.0 if abs(d4) < SAME * size else d4
    row = Link(three.beta, three.delta, three.a, three.alpha, 0.0, 0.0)
    front = Chain(np.concatenate([chain.constants[:3], np.eye(4)[None]]), chain.revolute[:3], chain.offsets[:3])
    arm = _front_arm(front, row, d4)
    if arm is None:
        return None
    known = {**arm.known, **lengths(**{"d₆": place.d}), **place.known}
    name = place.wrist.name

    def centre(sheet: WorkedSteps) -> list[WorkedSteps]:
        formula = "p − d₆·a" if place.d else "p"
        note = "the wrist centre W: back along the approach vector a"
        return [_components(sheet.step("p_W", formula, "point", note))]

    def rotations(sheet: WorkedSteps) -> list[WorkedSteps]:
        sheet = sheet.step("R₀³", arm.rotation, "rotation", "what the arm does to the wrist")
        return [sheet.step(name, "(R₀³)ᵀ·R", "rotation", "what is left for the wrist")]

    return Derivation(
        f"decoupling at the wrist centre; {arm.title}; the wrist's ZYZ angles",
        True, chain.constants[0], place.rest @ tool, (centre, *arm.stages, rotations, *place.wrist.stages),
        (*arm.variables, "θ₄", "θ₅", "θ₆"), (*arm.zeros, *place.zeros), known,
    )  # fmt: skip


def _front_arm(front: Chain, row: Link, d4: float) -> PositioningArm | None:
    """The arm before a wrist."""
    found = anthropomorphic_arm(front, np.eye(4), row, d4)
    if found is not None:
        return found
    end = row_transform(row) @ translation_transform([0.0, 0.0, d4])
    if front.revolute[0] and int(np.sum(front.revolute)) == 2 and (flat := planar_arm(front, end)) is not None:
        return flat[0]
    arms = (find(front, end) for find in (spherical_arm, cylindrical_arm, cartesian_arm))
    return next((arm for arm in arms if arm is not None), None)


def _components(sheet: WorkedSteps) -> WorkedSteps:
    """p_W known by its coordinates as well."""
    return sheet.given("length", **dict(zip(("p_Wx", "p_Wy", "p_Wz"), sheet["p_W"].tolist(), strict=True)))


def first_steps(plan: Derivation, T: Array) -> WorkedSteps:
    """The sheet with the target T (4, 4) [m] brought into the arm's own frames."""
    n = len(plan.variables)
    base, rest = (not np.array_equal(frame, np.eye(4)) for frame in (plan.base, plan.rest))
    sheet = WorkedSteps(plan.known)
    if not plan.whole:
        sheet = sheet.given("point", p=T[:3, 3])
        formula = "p"
        if base:
            sheet = sheet.given("rotation", R_B=plan.base[:3, :3]).given("point", t_B=plan.base[:3, 3])
            formula = "R_Bᵀ·(p − t_B)"
        return _components(sheet.step("p_W", formula, "point", "the point to reach, from the arm's base"))
    sheet = sheet.given("pose", T=T, B=plan.base, E=plan.rest)
    name = f"T₀{'⁰¹²³⁴⁵⁶'[n]}"
    formula = ("B⁻¹·" if base else "") + "T" + ("·E⁻¹" if rest else "")
    sheet = sheet.step(name, formula, "pose", "the last frame's pose, from the arm's base")
    pose = sheet[name]
    sheet = sheet.given("rotation", R=pose[:3, :3]).given("point", p=pose[:3, 3]).given("direction", a=pose[:3, 2])
    sheet = sheet.given("length", **dict(zip(("p_x", "p_y", "p_z"), pose[:3, 3].tolist(), strict=True)))
    return sheet.given("number", n_x=float(pose[0, 0]), n_y=float(pose[1, 0]))
