"""Small pictures for the gallery: the faces that `robokin plot` draws, on nothing, so that they suit either theme."""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence

import numpy as np
from PIL import Image, ImageDraw

from robokin.arrays import Array
from robokin.model import Mechanism, Robot, Tree, WheeledBase
from robokin.pictures.arm import body_frames, default_configuration
from robokin.pictures.arm_faces import COLOURS, Face, arm_faces, colour, frame_faces, ordered
from robokin.pictures.arm_scene import Scene, eye_axes
from robokin.pictures.drawn_arm import AskedPostures, given_postures, scene_of
from robokin.pictures.mechanism_scene import mechanism_scene, shape_faces

WIDTH, HEIGHT = 640, 480
"""Pixels of a picture; pages show it at half of that and more."""

FINER = 2
"""Each pixel is the mean of so many by so many."""

MARGIN = 18
"""Pixels that stay free about what is drawn."""

WHEELS = {"fixed": "#2b628f", "steered": "#c8551b", "castor": "#5f5f9e", "swedish": "#2a8f3c", "ball": "#6e6a3a"}
"""Colours of wheels by their kind."""

TYRE = 0.4
"""Width of a wheel whose radius is 1."""


def thumbnail(entry: Robot | Tree | Mechanism | WheeledBase) -> bytes:
    """The picture of an entry of the library as a PNG without a background."""
    if isinstance(entry, WheeledBase):
        return painted(_plan(entry), eye_axes((-90.0, 90.0)))
    if isinstance(entry, Mechanism):
        scene = mechanism_scene(entry, None, None, entry.units)
        eye = eye_axes(scene.view)
        still = np.tile(np.eye(4), (len(entry.links), 1, 1))
        return painted(ordered(list(shape_faces(scene.shape, still, eye)), eye), eye)
    arm = home_scene(entry)
    return painted(_arm(arm), eye_axes(arm.view))


def home_scene(robot: Robot | Tree) -> Scene:
    """What `robokin plot` draws of a robot when nothing else is asked for."""
    q, name = default_configuration(robot)
    return scene_of(robot, robot.units, AskedPostures(given_postures(robot, robot.units, [q])), name, None, False)


def painted(faces: Sequence[Face], eye: Array) -> bytes:
    """Faces from the farthest to the nearest, as large as the picture allows."""
    flat = [face.corners @ eye[:2].T for face in faces]
    low, high = np.min(np.concatenate(flat), axis=0), np.max(np.concatenate(flat), axis=0)
    room = FINER * (np.array([WIDTH, HEIGHT]) - 2.0 * MARGIN)
    scale = float(np.min(room / np.maximum(high - low, 1e-9)))
    middle, centre = 0.5 * (low + high), 0.5 * FINER * np.array([WIDTH, HEIGHT])
    sheet = Image.new("RGBA", (FINER * WIDTH, FINER * HEIGHT), (255, 255, 255, 0))
    pen = ImageDraw.Draw(sheet)
    for face, corners in zip(faces, flat, strict=True):
        paint = (*np.rint(255.0 * face.colour).astype(int).tolist(), 255)
        places = [tuple(p) for p in (centre + scale * (corners - middle) * [1.0, -1.0]).tolist()]
        pen.polygon(places, fill=paint, outline=paint)
    stream = io.BytesIO()
    sheet.reduce(FINER).quantize(128, method=Image.Quantize.FASTOCTREE).save(stream, "PNG")
    return stream.getvalue()


def _arm(scene: Scene) -> list[Face]:
    """A robot, and in front of it the axes of its frames."""
    eye = eye_axes(scene.view)
    frames = body_frames(scene.arm.robot, scene.postures[0].q)
    length = scene.arm.length
    axes = [
        face
        for mark in scene.marks()
        for face in frame_faces(frames[mark.body] @ mark.T, length * scene.arm.axes(mark.body), eye)
    ]
    return [*ordered(list(arm_faces(scene.arm, frames, eye)), eye), *ordered(axes, eye)]


def _plan(base: WheeledBase) -> list[Face]:
    """A base on wheels from above: its wheels, lines from the middle of them to each, and x and y of its frame."""
    places = np.array([[wheel.x, wheel.y, 0.0] for wheel in base.wheels])
    middle = places.mean(axis=0)
    size = max(float(np.max(np.ptp(places, axis=0))), *(2.0 * wheel.radius for wheel in base.wheels), 1e-6)
    faces = [_strip(middle, place, 0.03 * size, COLOURS["link"]) for place in places]
    for wheel, place in zip(base.wheels, places, strict=True):
        radius, paint = wheel.radius or 0.08 * size, WHEELS[wheel.type]
        along = np.array([np.cos(wheel.angle), np.sin(wheel.angle), 0.0])
        if wheel.type == "ball":
            faces.append(_disc(place, radius, paint))
            continue
        if wheel.type == "castor":
            hub = place - wheel.offset * along
            faces += [_strip(place, hub, 0.02 * size, COLOURS["base"]), _disc(place, 0.03 * size, COLOURS["base"])]
            place = hub
        faces.append(_strip(place - radius * along, place + radius * along, TYRE * radius, paint))
    for k, axis in enumerate("xy"):
        faces.append(_strip(np.zeros(3), 0.18 * size * np.eye(3)[k], 0.014 * size, COLOURS[axis]))
    return faces


def _strip(a: Array, b: Array, width: float, paint: str) -> Face:
    """A line from a to b (3,) [m] of some width [m]."""
    long = float(np.linalg.norm(b - a))
    along = (b - a) / long if long > 0.0 else np.array([1.0, 0.0, 0.0])
    aside = 0.5 * width * np.array([-along[1], along[0], 0.0])
    return Face(np.array([a + aside, b + aside, b - aside, a - aside]), colour(paint))


def _disc(centre: Array, radius: float, paint: str) -> Face:
    """A disc (3,) [m]."""
    return Face(np.array([centre + radius * spoke for spoke in _circle(24)]), colour(paint))


def _circle(count: int) -> Iterator[Array]:
    """Directions (3,) all around."""
    for turn in 2.0 * np.pi * np.arange(count) / count:
        yield np.array([np.cos(turn), np.sin(turn), 0.0])
