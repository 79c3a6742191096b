"""What `robokin plot` draws: the arms that the options ask for, and the title above them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.cli.arguments import in_units, joint_factors, parse_numbers, split_vector
from robokin.cli.output.numbers import show
from robokin.cli.output.text import csv_records, json_document, json_line
from robokin.cli.records import pose_records, poses_in
from robokin.cli.targets import Target, parse_target
from robokin.errors import InputError, or_list, shown
from robokin.inverse.solutions import Result
from robokin.inverse.solve import solve_many
from robokin.kinematics.forward import forward_kinematics, row_frames
from robokin.kinematics.structure import structure_of
from robokin.model import Robot
from robokin.pictures.arm import arm_of, body_frames, line_of
from robokin.pictures.arm_scene import Posture, Scene, usual_view
from robokin.records.envelope import envelope
from robokin.units import Units

ENDINGS = (".png", ".svg", ".pdf", ".html")

MOST_GHOSTS = 16
"""Solutions that are drawn at most: as many as an arm of six turning joints can have; those of a redundant arm never
end."""

FARTHEST = 1e6
"""Metres that a place is away at most: beyond, nothing is left of an arm in a picture."""


@dataclass(frozen=True, eq=False)
class AskedPostures:
    """The postures to draw, the target with its answer if there is one, and sentences for the user."""

    postures: tuple[Posture, ...]
    target: Target | None = None
    result: Result | None = None
    notes: tuple[str, ...] = field(default=())

    @property
    def unreachable(self) -> bool:
        """Whether a target was asked for that the arm cannot reach."""
        return self.result is not None and not self.result.reachable


def ending_of(output: str) -> str:
    """The ending of the picture's name. Raises InputError where nothing could be drawn."""
    ending = Path(output).suffix.lower()
    if ending not in ENDINGS:
        raise InputError(f"--output: found '{output}', expected a name that ends with {or_list(ENDINGS)}")
    if ending != ".html":
        from robokin.pictures.workspace_stills import require_matplotlib

        require_matplotlib(ending)
    return ending


def view_of(text: str | None) -> tuple[float, float] | None:
    """Azimuth and elevation [°] of --view. Raises InputError."""
    if text is None:
        return None
    azimuth, elevation = parse_numbers(text, "--view", [True] * 2, Units(angle="deg"), "azimuth, elevation in degrees")
    if abs(elevation) > 90.0 or abs(azimuth) > 360.0:
        raise InputError(f"--view: found {text}, expected an azimuth within ±360 and an elevation within ±90 degrees")
    return float(azimuth), float(elevation)


def target_of(text: str, robot: Robot, units: Units) -> Target:
    """The target of --ik: a transform expression, a matrix, a position x, y, z alone, or x, y of a planar arm."""
    if not text.strip():
        raise InputError("--ik: found nothing, expected x,y,z or a transform expression")
    if text.lstrip().startswith("[["):
        return _target({"--matrix": text}, robot, units)
    # With a comma more, what commas outside parentheses separate is told from an expression.
    count = len(split_vector(text.strip().removeprefix("[").removesuffix("]") + ",0")) - 1
    if count > 3 or (count == 2 and structure_of(robot).arm != "planar"):
        raise InputError(f"--ik: found {count} values in '{shown(text)}', expected x,y,z or a transform expression")
    return _target({{2: "--xy", 3: "--xyz"}.get(count, "--pose"): text}, robot, units)


def _target(options: dict[str, str | None], robot: Robot, units: Units) -> Target:
    """The target that one of the options of `robokin ik` says, whose messages name --ik."""
    try:
        return parse_target(options, robot, units)
    except InputError as error:
        raise InputError(re.sub(rf"{next(iter(options))}\b", "--ik", str(error))) from None


def wanted_target(ik: str | None, options: dict[str, str | None], robot: Robot, units: Units) -> Target | None:
    """The target of --ik, or of the options that `robokin ik` has; None without. Raises InputError for both."""
    given = [name for name, value in options.items() if value is not None]
    if ik is not None and given:
        raise InputError(f"--ik and {given[0]} exclude each other, expected one of them")
    if (ik is not None or given) and not robot.n:
        raise InputError(f"{robot.name} has no joints, expected a robot that can move")
    if ik is not None:
        return target_of(ik, robot, units)
    return parse_target(options, robot, units) if given else None


def asked(robot: Robot, units: Units, given: Sequence[Array], target: Target | None) -> AskedPostures:
    """What is drawn for configurations (n,) [rad | m] and a target.

    The first configuration is drawn solid, all others pale. With a target and no configuration the first solution
    is the solid one; where there is no solution, the nearest configuration is drawn with the solid one beside it.
    """
    if target is None:
        # A single arm needs no name beside it: its joint values stand below the title.
        labels = [values_text(q, robot, units) if len(given) > 1 else "" for q in given]
        return AskedPostures(
            tuple(Posture(q, label, k > 0) for k, (q, label) in enumerate(zip(given, labels, strict=True)))
        )
    if np.max(np.abs(target.T[:3, 3])) > FARTHEST:
        raise InputError("the target is too far away for a picture, expected less")
    result = solve_many(robot, target.T[None], task=target.task)[0]  # type: ignore[arg-type]
    return with_solutions(robot, units, given, target, result)


def with_solutions(robot: Robot, units: Units, given: Sequence[Array], target: Target, result: Result) -> AskedPostures:
    """What is drawn for configurations (n,) [rad | m] and a target with its answer."""
    found = [(solution.q, solution.branch) for solution in result.solutions[:MOST_GHOSTS]]
    notes = list(target.notes)
    if len(result.solutions) > MOST_GHOSTS:
        notes.append(f"{len(result.solutions)} solutions, of which {MOST_GHOSTS} are drawn")
    postures = [Posture(q, values_text(q, robot, units) if len(given) > 1 else "", k > 0) for k, q in enumerate(given)]
    for k, (q, branch) in enumerate(found):
        postures.append(Posture(q, branch or f"solution {k + 1}", ghost=bool(given) or k > 0))
    if not found:
        notes.append(f"no solution: {result.reason}")
        if result.nearest is not None:
            gap = result.nearest.position_error / units.metres, result.nearest.angle_error / units.radians
            label = f"nearest: position error {gap[0]:.4g} {units.length}, angle error {gap[1]:.4g} {units.angle}"
            postures.append(Posture(result.nearest.q, label, ghost=bool(given)))
    return AskedPostures(tuple(postures), target, result, tuple(notes))


def scene_of(
    robot: Robot, units: Units, wanted: AskedPostures, name: str, view: tuple[float, float] | None, frames: bool
) -> Scene:
    """The picture of all that is asked for; `name` is what the first configuration is called."""
    usual, flat = usual_view(robot)
    solid = wanted.postures[0]
    text = values_text(solid.q, robot, units)
    subtitle = f"q = {name} = {text}" if name else f"q = {text}"
    if wanted.result is not None and solid.label and not wanted.unreachable:
        subtitle += f"  (solution 1 of {len(wanted.result.solutions)})"
    return Scene(
        robot.name, subtitle if robot.n else "no joints", units, arm_of(robot), wanted.postures,
        None if wanted.target is None else wanted.target.T, frames, view or usual, flat and view is None,
        turned=wanted.target is None or wanted.target.task == "pose", name=robot.id, note=". ".join(wanted.notes),
    )  # fmt: skip


def values_text(q: Array, robot: Robot, units: Units) -> str:
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


# Without a picture ----------------------------------------------------------------------------------------


def answer(kind: str, scene: Scene, wanted: AskedPostures) -> Iterator[bytes]:
    """What a picture shows, as text or as plain data."""
    robot, units = scene.arm.robot, scene.units
    if kind == "table":
        yield _page(scene, wanted)
        return
    document = arms_record(scene, wanted)
    arms = document["arms"]
    if kind == "csv":
        rows = [
            [number, corner, *point]
            for number, arm in enumerate(arms, start=1)
            for corner, point in enumerate(arm["points"], start=1)
        ]
        yield csv_records(["arm", "corner", "x", "y", "z"], rows)
        return
    head = envelope("robot", robot.id, units)
    if kind == "jsonl":
        yield from (json_line({**head, **arm}) for arm in arms)
        return
    yield json_document(document)


def arms_record(scene: Scene, wanted: AskedPostures) -> dict[str, Any]:
    """The document of `robokin plot` about an arm."""
    target = None if scene.target is None else poses_in(scene.target.copy(), scene.units).tolist()
    more: dict[str, Any] = {"target": target, "reachable": None, "reason": None}
    if wanted.result is not None:
        more |= {"reachable": wanted.result.reachable, "reason": wanted.result.reason}
    arms = [_record(scene, posture) for posture in scene.postures]
    return envelope("robot", scene.arm.robot.id, scene.units) | more | {"arms": arms}


def _record(scene: Scene, posture: Posture) -> dict[str, Any]:
    """An arm as a picture has it: its values, its corners from base to tool, its joints, its pose."""
    robot, units = scene.arm.robot, scene.units
    frames = body_frames(robot, posture.q)
    points = line_of(scene.arm, frames) / units.metres + 0.0
    record: dict[str, Any] = {
        "label": posture.label,
        "ghost": posture.ghost,
        "q": in_units(posture.q, joint_factors(robot, units)).tolist(),
        "within_limits": bool(robot.within_limits(posture.q)),
        "points": points.tolist(),
        "joints": [
            {"name": joint.name, "type": joint.type.value, "position": (frame[:3, 3] / units.metres + 0.0).tolist(),
             "axis": (frame[:3, 2] + 0.0).tolist()}
            for joint, frame in zip(robot.joints, frames[1:], strict=True)
        ],
        "pose": pose_records(poses_in(forward_kinematics(robot, posture.q), units)[None], units)[0],
    }  # fmt: skip
    if scene.frames:
        matrices = poses_in(row_frames(robot, posture.q), units).tolist()
        record["frames"] = [{"name": str(i), "matrix": matrix} for i, matrix in enumerate(matrices, start=1)]
    return record


def _page(scene: Scene, wanted: AskedPostures) -> bytes:
    from robokin.cli.output.tables import heading, pairs, render
    from robokin.pictures.arm_text import arm_text

    robot, units = scene.arm.robot, scene.units
    T = poses_in(forward_kinematics(robot, scene.postures[0].q), units)
    entries = [("tool", "  ".join(show(value) for value in T[:3, 3].tolist()) + f"  {units.length}")]
    named = [posture for posture in scene.postures if posture.label]
    entries += [(f"{k}", posture.label) for k, posture in enumerate(named, start=1)]
    return render(heading(scene.title, scene.subtitle), "", arm_text(scene), pairs(entries))
