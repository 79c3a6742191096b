"""Moving pictures as .gif files, and stills of paths: whole, the same every time, of a bounded size."""

from __future__ import annotations

import io
from xml.etree import ElementTree

import numpy as np
import pytest

import robokin
from robokin.errors import InputError
from robokin.inverse.frame_motions import frame_motion
from robokin.pictures.arm_track import track_of
from robokin.pictures.drawn_frames import frames_picture
from robokin.pictures.drawn_mechanism import motion_to_draw, picture_of
from robokin.pictures.drawn_path import path_picture
from robokin.pictures.film import MOST_SHOTS, film_rows
from robokin.spatial import rotation_from_rpy, transform

pytest.importorskip("matplotlib")

MOST = 1_000_000
"""Bytes of a film."""

PLANAR = robokin.load("planar2r")
PATH = robokin.trajectory(PLANAR, np.radians([[10.0, 20.0], [80.0, 60.0]]), duration=1.0, steps=400)


def frames_of(data):
    from PIL import Image

    film = Image.open(io.BytesIO(data))
    found = []
    for k in range(film.n_frames):
        film.seek(k)
        found.append((np.asarray(film.convert("RGB")), film.info["duration"]))
    return film, found


def test_a_path_as_a_film():
    data = path_picture(PATH, PLANAR.units, "gif")
    assert data == path_picture(PATH, PLANAR.units, "gif")
    assert len(data) < MOST
    film, frames = frames_of(data)
    assert film.info["loop"] == 0
    assert 10 <= len(frames) <= MOST_SHOTS
    pauses = [pause for _, pause in frames]
    assert sum(pauses[:-1]) == pytest.approx(1000, rel=0.1), "it is as fast as the path"
    assert pauses[-1] == 1000
    pictures = np.array([picture for picture, _ in frames])
    assert np.all(pictures[:, 100, 2] == 255), "paper is white"
    assert len({picture.tobytes() for picture in pictures}) == len(frames)


@pytest.mark.parametrize(("name", "closed"), [("four-bar", True), ("screw-jack", False)])
def test_a_mechanism_as_a_film(name, closed):
    mechanism = robokin.load_mechanism(name)
    moved, _ = motion_to_draw(mechanism)
    assert moved.closed is closed
    data = picture_of(mechanism, moved, None, mechanism.units, ".gif")
    assert len(data) < MOST
    _, frames = frames_of(data)
    assert len({pause for _, pause in frames}) == 1, "it goes on without a stop"


def test_what_does_not_move_is_no_film():
    mechanism = robokin.load_mechanism("shaky-triangle")
    moved, note = motion_to_draw(mechanism)
    with pytest.raises(InputError, match=r"a \.gif shows a motion: .*only trembles.*expected"):
        picture_of(mechanism, moved, None, mechanism.units, ".gif", note=note)


def test_a_frame_as_a_film():
    motion = frame_motion(np.eye(4), transform(rotation_from_rpy([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 2.0])))
    data = frames_picture(motion, ("", "there"), PLANAR.units, "gif")
    assert data == frames_picture(motion, ("", "there"), PLANAR.units, "gif")
    assert len(data) < MOST


@pytest.mark.parametrize("apart", [0.0, 1e-12, 1e-3, 1e5])
@pytest.mark.parametrize("kind", ["svg", "html"])
def test_frames_near_and_far_are_drawn(apart, kind):
    last = np.eye(4)
    last[0, 3] = apart
    for first in (np.eye(4), transform(np.eye(3), np.array([50.0, 0.0, 0.0]))):
        motion = frame_motion(first, first @ last, "screw")
        assert frames_picture(motion, ("a", "b"), PLANAR.units, kind)


def test_rows_of_a_film_are_even_in_time():
    times = np.concatenate([np.linspace(0.0, 0.1, 100), np.linspace(0.2, 2.0, 19)])
    rows, pause = film_rows(times, 2.0)
    assert rows[0] == 0
    assert rows[-1] == len(times) - 1
    assert np.all(np.diff(rows) >= 0)
    assert np.max(np.abs(times[rows] - np.linspace(0.0, 2.0, len(rows)))) <= 0.05 + 1e-9
    assert pause * (len(rows) - 1) == pytest.approx(2000, rel=0.1)
    assert len(film_rows(np.linspace(0.0, 1.0, 5000), 600.0)[0]) <= MOST_SHOTS
    assert film_rows(np.array([0.0]), 0.0)[0] == [0]


def test_a_still_of_a_path_has_its_way_its_ends_and_what_happens():
    ends = np.radians([[90.0, -30.0, 60.0, 0.0, 40.0, 0.0], [60.0, -20.0, 70.0, 10.0, 400.0, 0.0]])
    outside = robokin.trajectory(robokin.load("puma560"), ends, duration=1.0)
    assert outside.events
    data = path_picture(outside, outside.robot.units, "svg", ["joint 5 leaves its limits there"])
    text = "\n".join(ElementTree.fromstring(data.decode()).itertext())
    said = (
        "1  start",
        "2  as far as it can be followed",
        "joint 5 leaves its limits there",
        "joint by joint, 1 s, fol",
    )
    for word in said:
        assert word in " ".join(text.split("\n")), word
    assert data.decode().count("#d0021b") >= 2
    assert data == path_picture(outside, outside.robot.units, "svg", ["joint 5 leaves its limits there"])


def test_a_path_of_one_row_is_a_picture_of_an_arm():
    path = robokin.follow_line(PLANAR, [0.1, 0.2], transform(np.eye(3), np.array([9.0, 9.0, 0.0])))
    for kind in ("html", "gif", "svg"):
        assert path_picture(path, PLANAR.units, kind)


def test_a_track_keeps_both_ends():
    track = track_of(PATH)
    assert np.array_equal(track.q[[0, -1]], PATH.q[[0, -1]])
    assert len(track.t) <= 181
    assert np.allclose(track.places, robokin.forward_kinematics(PLANAR, track.q)[:, :3, 3])


def test_without_matplotlib_the_sentence_says_how_to_get_it(monkeypatch):
    monkeypatch.setattr("robokin.pictures.workspace_stills.find_spec", lambda name: None)
    with pytest.raises(InputError, match="`pip install matplotlib`"):
        path_picture(PATH, PLANAR.units, "gif")
