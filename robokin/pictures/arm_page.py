"""A page in one file that needs no network: the arm turns with the mouse and moves with a slider for each joint.

The page computes forward kinematics itself, from the constants of the bodies; `window.robokin.fk(q)` is that function:
joint values in the page's units in, a 4×4 matrix with its origin in the page's length unit out; `tips(q)` gives those
of all tips by name.
"""

from __future__ import annotations

import shlex
from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.model.joint_units import in_units, joint_factors
from robokin.pictures.arm import default_configuration
from robokin.pictures.arm_bars import LINK, Bar
from robokin.pictures.arm_faces import COLOURS, CROSS, PALE, PALE_PALM, TRACE
from robokin.pictures.arm_scene import Scene
from robokin.pictures.skeleton import branches_of, leads_of
from robokin.pictures.workspace_page import filled

DIGITS = 5
"""Significant digits of what is only drawn: far finer than a screen."""

ROW_DIGITS = 9
"""Significant digits of a path's joint values: more than the page shows."""

OWN = COLOURS["revolute"]
"""The colour beside the name of an arm that stands alone: that of its joints."""


def arm_page(scene: Scene) -> bytes:
    """The scene as an .html file."""
    robot, units = scene.arm.robot, scene.units
    scale = 1.0 / units.metres
    skeleton = scene.arm.skeleton
    low, high = scene.bounds()
    home, home_name = default_configuration(robot)
    poses = {home_name or "default": home} | dict(robot.poses)
    data = {
        "title": scene.title,
        "words": scene.words or shlex.quote(scene.name),
        "length": units.length,
        "angle": units.angle,
        "radians": units.radians,
        # What forward kinematics needs, in all its digits; the rest is for the eye.
        "bodies": [_body(scene, i, scale) for i in range(len(skeleton.bodies))],
        "tips": [[tip.name, tip.body, _scaled(tip.T, scale)] for tip in skeleton.tips],
        "joints": [_joint(scene, i) for i in range(robot.n)],
        "groups": [list(group) for group in branches_of(robot)],
        "q": _values(scene, scene.postures[0].q),
        "poses": {name: _values(scene, q) for name, q in poses.items()},
        "ghosts": [
            {"q": _values(scene, posture.q), "label": posture.label, "ghost": posture.ghost, "colour": paint or OWN}
            for posture, paint in zip(scene.postures, scene.colours(), strict=True)
        ],
        "path": _path(scene),
        "trace": TRACE,
        "target": None if scene.target is None else _scaled(scene.target, scale),
        "turned": scene.turned,
        "note": scene.note,
        "frames": [
            [mark.name, mark.body, _scaled(mark.T, scale), mark.end, scene.arm.axes(mark.body)]
            for mark in scene.arm.marks
        ],
        "shown": scene.frames,
        "bars": [_bar(bar, scale) for bar in scene.arm.bars],
        "palms": [[palm.body, short_numbers(palm.corners * scale)] for palm in scene.arm.palms],
        "width": scene.arm.length * LINK * scale,
        "size": scene.arm.length * scale,
        "forked": scene.arm.forked,
        "box": short_numbers(np.array([low, high]) * scale),
        "view": list(scene.view),
        "colours": COLOURS | {"cross": CROSS},
        "pale": [*PALE, PALE_PALM],
    }
    return filled("arm.html", scene.title, data)


def _body(scene: Scene, i: int, scale: float) -> list[Any]:
    """A body as the page moves it: the one before it, the joint's start there, how far it turns [rad] and slides
    [length] for each unit of its value, and the value as a sum: [joint, factor] of each joint's, and a constant."""
    skeleton, factors = scene.arm.skeleton, _factors(scene)
    body, row = skeleton.bodies[i], skeleton.S[i]
    turn, slide = body.rates
    parts = [[int(j), float(row[j] * factors[j])] for j in np.flatnonzero(row)]
    return [body.parent, _scaled(body.start, scale), turn, slide * scale, parts, float(skeleton.o[i]) + 0.0]


def _scaled(T: Array, scale: float) -> list[float]:
    T = np.array(T)
    T[:3, 3] *= scale
    values: list[float] = (T + 0.0).ravel().tolist()
    return values


def _values(scene: Scene, q: Array) -> list[float]:
    """Joint values in the units."""
    values: list[float] = (q / _factors(scene) + 0.0).tolist()
    return values


def _factors(scene: Scene) -> Array:
    return joint_factors(scene.arm.robot, scene.units)


def _joint(scene: Scene, i: int) -> dict[str, Any]:
    """A joint as its slider needs it; `free` tells which ends are none of the description's."""
    robot, factor = scene.arm.robot, float(_factors(scene)[i])
    joint, limits = robot.joints[i], robot.limits[i]
    # Without limits a joint turns once round, and slides by the arm's length.
    reach = np.pi if robot.revolute[i] else scene.arm.length
    ends = [sign * reach if np.isinf(end) else end for sign, end in zip((-1.0, 1.0), limits, strict=True)]
    return {
        "name": joint.name,
        "type": "R" if robot.revolute[i] else "P",
        "leads": leads_of(robot, i),
        "limits": [float(f"{end / factor:.12g}") for end in ends],
        "free": [bool(np.isinf(end)) for end in limits],
    }


def _path(scene: Scene) -> dict[str, Any] | None:
    """A path as the page plays it: its rows in the units, the ends as they were typed."""
    track = scene.track
    if track is None:
        return None
    factors = _factors(scene)
    q = short_numbers(track.q / factors, ROW_DIGITS)
    q[0], q[-1] = in_units(track.q[0], factors).tolist(), in_units(track.q[-1], factors).tolist()
    return {
        "t": short_numbers(track.t, ROW_DIGITS),
        "q": q,
        "rates": None if track.rates is None else short_numbers(track.rates / factors),
        "timed": track.timed,
        "seconds": track.seconds,
        "marks": [list(mark) for mark in track.marks],
    }


def _bar(bar: Bar, scale: float) -> list[Any]:
    ends = [short_numbers(bar.a * scale), short_numbers(bar.b * scale), short_numbers(bar.across)]
    return [bar.role, *bar.bodies, *ends, float(f"{bar.width * scale:.{DIGITS}g}"), bar.sides]


def short_numbers(values: Array, count: int = DIGITS) -> Any:
    """Numbers as a page's data, in lists and to so many significant digits."""
    digits = [float(f"{value:.{count}g}") + 0.0 for value in np.ravel(values).tolist()]
    return np.reshape(digits, np.shape(values)).tolist()
