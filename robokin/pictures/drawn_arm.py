"""Which postures of an arm or a tree a picture has: configurations that are given, and the solutions of a target."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.inverse.solutions import Question, Result
from robokin.inverse.solve import solve_many
from robokin.kinematics.forward import joint_frames
from robokin.kinematics.tips import tip_poses
from robokin.model import Robot, Tree
from robokin.model.joint_units import in_units, joint_factors
from robokin.pictures.arm import arm_of
from robokin.pictures.arm_scene import Posture, Scene, usual_view
from robokin.pictures.skeleton import skeleton_of
from robokin.units import Units

MOST_GHOSTS = 16
"""Solutions that are drawn at most: as many as an arm of six turning joints can have; those of a redundant arm never
end."""

MOST_VALUES = 8
"""Joint values that stand in and beside a tree's picture at most."""

FARTHEST = 1e6
"""Metres that a place is away at most: beyond, nothing is left of an arm in a picture."""


@dataclass(frozen=True, eq=False)
class AskedPostures:
    """The postures to draw, the question with its answer if a target was asked for, and sentences for the user."""

    postures: tuple[Posture, ...]
    question: Question | None = None
    result: Result | None = None
    notes: tuple[str, ...] = field(default=())

    @property
    def unreachable(self) -> bool:
        """Whether a target was asked for that the arm cannot reach."""
        return self.result is not None and not self.result.reachable


def given_postures(robot: Robot | Tree, units: Units, given: Sequence[Array]) -> tuple[Posture, ...]:
    """Configurations (n,) [rad | m] to draw: the first solid, all others pale."""
    # A single arm needs no name beside it: its joint values stand below the title.
    labels = [""] * len(given)
    if len(given) > 1:
        labels = [_posture_name(robot, units, q, number) for number, q in enumerate(given, start=1)]
    return tuple(Posture(q, label, k > 0) for k, (q, label) in enumerate(zip(given, labels, strict=True)))


def _posture_name(robot: Robot | Tree, units: Units, q: Array, number: int) -> str:
    """What a configuration is called: its values, of a tree the pose that it is, or its number where it has many."""
    if isinstance(robot, Robot):
        return values_text(q, robot, units)
    return _pose_at(robot, q) or (values_text(q, robot, units) if robot.n <= MOST_VALUES else f"configuration {number}")


def _pose_at(tree: Tree, q: Array) -> str:
    """The name of the pose that a configuration is; "" where it is none."""
    return next((name for name, values in tree.poses.items() if np.array_equal(values, q)), "")


def solved_postures(
    question: Question, units: Units, given: Sequence[Array], notes: Sequence[str] = (), result: Result | None = None
) -> AskedPostures:
    """What is drawn for a target, beside configurations (n,) [rad | m], if any: all its solutions, up to MOST_GHOSTS.

    Without configurations the first solution is the solid one. Where there is no solution, the nearest configuration is
    drawn. The target is solved for unless its `result` is given; `notes` are sentences on it. Raises InputError for a
    target that is too far away for a picture.
    """
    robot = question.robot
    if result is None:
        if np.max(np.abs(question.T[:3, 3])) > FARTHEST:
            raise InputError("the target is too far away for a picture, expected less")
        result = solve_many(robot, question.T[None], task=question.task)[0]  # type: ignore[arg-type]
    said, postures = [*notes], [*given_postures(robot, units, given)]
    if len(result.solutions) > MOST_GHOSTS:
        said.append(f"{len(result.solutions)} solutions, of which {MOST_GHOSTS} are drawn")
    for k, solution in enumerate(result.solutions[:MOST_GHOSTS]):
        postures.append(Posture(solution.q, solution.branch or f"solution {k + 1}", ghost=bool(given) or k > 0))
    if not result.solutions:
        said.append(f"no solution: {result.reason}")
        if result.nearest is not None:
            gap = result.nearest.position_error / units.metres, result.nearest.angle_error / units.radians
            label = f"nearest: position error {gap[0]:.4g} {units.length}, angle error {gap[1]:.4g} {units.angle}"
            postures.append(Posture(result.nearest.q, label, ghost=bool(given)))
    return AskedPostures(tuple(postures), question, result, tuple(said))


def scene_of(
    robot: Robot | Tree, units: Units, wanted: AskedPostures, name: str, view: tuple[float, float] | None, frames: bool,
    option: str = "q",
) -> Scene:  # fmt: skip
    """The picture of all that is asked for; `name` is what the first configuration is called.

    Raises InputError, which names the option, for an arm that is too long for a picture.
    """
    for posture in wanted.postures:
        if not np.max(np.abs(_places(robot, posture.q))) < FARTHEST:
            raise InputError(f"{option}: the arm is too long for a picture, expected smaller values")
    usual, flat = usual_view(robot)
    solid, asked = wanted.postures[0], wanted.question
    text = values_text(solid.q, robot, units)
    subtitle = f"q = {name} = {text}" if name else f"q = {text}"
    if not isinstance(robot, Robot):
        name = name or _pose_at(robot, solid.q)
        if name or robot.n > MOST_VALUES or (robot.n and not solid.q.any()):
            subtitle = f"q = {name}" if name else f"{robot.n} joints" + ("" if solid.q.any() else " at 0")
    if wanted.result is not None and solid.label and not wanted.unreachable:
        subtitle += f"  (solution 1 of {len(wanted.result.solutions)})"
    return Scene(
        robot.name, subtitle if robot.n else "no joints", units, arm_of(robot), wanted.postures,
        None if asked is None else asked.T, frames, view or usual, flat and view is None,
        turned=asked is None or asked.task == "pose", name=robot.id, note=". ".join(wanted.notes),
    )  # fmt: skip


def arm_picture(scene: Scene, kind: str) -> bytes:
    """A picture as a file: html (a page that turns), or a still by matplotlib."""
    if kind == "html":
        from robokin.pictures.arm_page import arm_page

        return arm_page(scene)
    from robokin.pictures.arm_stills import arm_still

    return arm_still(scene, kind)


def _places(robot: Robot | Tree, q: Array) -> Array:
    """(k, 3) [m] where the joints and the tips are."""
    if isinstance(robot, Robot):
        return joint_frames(robot, q)[:, :3, 3]
    return np.concatenate([skeleton_of(robot).frames(q), tip_poses(robot, q)])[:, :3, 3]


def values_text(q: Array, robot: Robot | Tree, units: Units) -> str:
    """Joint values (n,) [rad | m] in the units, each with its own where they differ."""
    values = in_units(q, joint_factors(robot, units))
    angle = "°" if units.degrees else " rad"
    texts = [
        f"{0.0 if abs(value) < 5e-7 else value:.6g}{angle if turns else ' ' + units.length}"
        for value, turns in zip(values.tolist(), robot.revolute.tolist(), strict=True)
    ]
    if robot.revolute.all() and not units.degrees:
        texts = [text.removesuffix(angle) for text in texts]
        return f"({', '.join(texts)}) rad"
    return f"({', '.join(texts)})"
