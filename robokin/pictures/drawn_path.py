"""A path of an arm as a picture: a page that plays it, a film, a still with the arm at some of its rows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from robokin.inverse.joint_paths import Path
from robokin.pictures.arm import body_frames
from robokin.pictures.arm_faces import TRACE, arm_faces, frame_faces
from robokin.pictures.arm_scene import Posture, Scene, eye_axes
from robokin.pictures.arm_track import rows_of, track_of
from robokin.pictures.drawn_arm import AskedPostures, arm_picture, scene_of
from robokin.pictures.film import FilmStage, Shot, film, film_rows
from robokin.units import Units

GHOSTS = 6
"""Arms that a still shows along a path, with the first and the last."""

WAYS = {"joint": "joint by joint", "line": "a straight line", "arc": "an arc"}


def path_picture(
    path: Path, units: Units, kind: str, notes: Sequence[str] = (), view: tuple[float, float] | None = None,
    words: str = "",
) -> bytes:  # fmt: skip
    """A path as a file: html (a page that plays it), gif, or a still: png, svg or pdf.

    notes: sentences on the way, first those of each event and of each turn of joints; words: the robot as a command
    line has it. Raises InputError for a path that is too long for a picture, and without matplotlib for all but pages.
    """
    scene = _scene(path, units, kind == "html", notes, view, words)
    return _film(scene) if kind == "gif" else arm_picture(scene, kind)


def _scene(
    path: Path, units: Units, page: bool, notes: Sequence[str], view: tuple[float, float] | None, words: str
) -> Scene:
    """The start and some rows as ghosts, the end solid; on a page that moves, the start solid and the end a ghost."""
    last, end = len(path.t) - 1, "end" if path.complete else "as far as it can be followed"
    if not last:
        postures = [Posture(path.q[0])]
    elif page:
        postures = [Posture(path.q[0], "start"), Posture(path.q[-1], end, ghost=True)]
    else:
        rows = rows_of(last + 1, GHOSTS)
        names = {0: "start", last: end}
        postures = [Posture(path.q[row], names.get(row, ""), ghost=row < last) for row in rows]
    # What is said of an event or a turn stands at its mark, where there is a way to mark.
    told = tuple(notes[len(path.events) + len(path.turns) :] if last else notes)
    scene = scene_of(path.robot, units, AskedPostures(tuple(postures), notes=told), "", view, False, "--from")
    seconds = "" if path.duration is None else f", {path.duration:.6g} s"
    far = "" if path.complete else f", followed up to {path.fraction:.4g}"
    return replace(scene, subtitle=WAYS[path.kind] + seconds + far, track=track_of(path, notes), words=words)


def _film(scene: Scene) -> bytes:
    track, arm = scene.track, scene.arm
    assert track is not None
    eye = eye_axes(scene.view)
    rows, pause = film_rows(track.t, float(track.t[-1] - track.t[0]) * track.seconds)

    def shot(row: int) -> Shot:
        frames = body_frames(arm.robot, track.q[row])
        marks = [(frames[mark.body] @ mark.T, mark) for mark in scene.marks()]
        fronts = [face for T, mark in marks for face in frame_faces(T, arm.length * arm.axes(mark.body), eye)]
        clock = f"t = {track.t[row]:.3f}{' s' if track.timed else ''}"
        return Shot(
            list(arm_faces(arm, frames, eye)), f"{scene.subtitle}   {clock}", fronts,
            [(T[:3, 3], mark.name) for T, mark in marks], [(track.places, TRACE, row)],
        )  # fmt: skip

    low, high = scene.bounds()
    return film(FilmStage(scene.title, (np.asarray(low), np.asarray(high)), scene.view, scene.units), rows, pause, shot)
