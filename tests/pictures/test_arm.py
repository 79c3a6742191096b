"""Arms as pieces: they hang together as forward kinematics has them, whatever the convention."""

from __future__ import annotations

import numpy as np
import pytest
from sweeps import sweep

import robokin
from robokin.formats.library import library_names, load_any
from robokin.kinematics.forward import joint_frames, row_frames
from robokin.model import Robot
from robokin.pictures.arm import arm_of, body_frames, default_configuration, line_of, plane_of
from robokin.pictures.arm_bars import ends_of
from robokin.pictures.arm_faces import arm_faces, ordered
from robokin.pictures.arm_scene import axis_names, eye_axes, usual_view

NAMES = ["puma560", "puma560-craig", "scara", "scara-frames", "stanford", "cartesian", "thumb", "gen3", "human-body",
         "assembly", "spherical-wrist"]  # fmt: skip


def somewhere(robot, rng):
    low, high = np.clip(robot.limits, -1.0, 1.0).T
    return rng.uniform(low, np.maximum(high, low))


@pytest.mark.parametrize("name", NAMES)
def test_frames_are_those_of_forward_kinematics(name, rng):
    robot = robokin.load(name)
    arm, q = arm_of(robot), somewhere(robot, rng)
    frames = body_frames(robot, q)
    marks = {mark.name: frames[mark.body] @ mark.T for mark in arm.marks}
    assert np.allclose(marks["base"], robot.base, atol=1e-12)
    assert np.allclose(marks["tool"], robokin.forward_kinematics(robot, q), atol=1e-12)
    rows = row_frames(robot, q)
    assert len(marks) == len(rows) + 2
    for number, T in enumerate(rows, start=1):
        assert np.allclose(marks[str(number)], T, atol=1e-12)


@pytest.mark.parametrize("name", NAMES)
def test_the_line_runs_from_base_to_tool_through_every_frame(name, rng):
    robot = robokin.load(name)
    arm, q = arm_of(robot), somewhere(robot, rng)
    line = line_of(arm, body_frames(robot, q))
    assert np.allclose(line[0], robot.base[:3, 3], atol=1e-9)
    assert np.allclose(line[-1], robokin.forward_kinematics(robot, q)[:3, 3], atol=1e-9)
    for place in row_frames(robot, q)[:, :3, 3]:
        assert np.min(np.linalg.norm(line - place, axis=1)) < 1e-6 * arm.length


@pytest.mark.parametrize("name", NAMES)
def test_each_joint_is_a_piece_of_its_kind_on_its_axis(name, rng):
    robot = robokin.load(name)
    arm, q = arm_of(robot), somewhere(robot, rng)
    frames, starts = body_frames(robot, q), joint_frames(robot, q)[:-1]
    joints = [bar for bar in arm.bars if bar.role in ("revolute", "prismatic")]
    assert [bar.role == "revolute" for bar in joints] == robot.revolute.tolist()
    assert [bar.sides > 4 for bar in joints] == robot.revolute.tolist()
    for bar, start in zip(joints, starts, strict=True):
        for end in ends_of(bar, frames):
            assert np.linalg.norm(np.cross(end - start[:3, 3], start[:3, 2])) < 1e-9


def test_a_slide_reaches_from_its_box_to_where_it_is():
    robot = robokin.load("stanford")
    arm = arm_of(robot)
    (slide,) = [bar for bar in arm.bars if bar.role == "slide"]
    for d in (0.4, 1.1):
        a, b = ends_of(slide, body_frames(robot, np.array([0.3, 0.4, d, 0.0, 0.0, 0.0])))
        assert np.linalg.norm(b - a) == pytest.approx(d)


def test_a_stroke_is_as_long_as_the_limits_allow():
    robot = robokin.load("scara")
    frames = body_frames(robot, default_configuration(robot)[0])
    strokes = [ends_of(bar, frames) for bar in arm_of(robot).bars if bar.role == "stroke"]
    assert max(np.linalg.norm(b - a) for a, b in strokes) == pytest.approx(0.21)


@pytest.mark.parametrize("name", sweep(library_names(), 5))
def test_every_robot_has_a_picture_of_its_default(name):
    robot = load_any(name, {})
    if not isinstance(robot, Robot):
        return
    q, _ = default_configuration(robot)
    assert robot.within_limits(q)
    arm = arm_of(robot)
    assert arm.length > 0.0
    for bar in arm.bars:
        assert np.all(np.isfinite(ends_of(bar, body_frames(robot, q))))


def test_home_is_the_default_where_there_is_one():
    robot = robokin.load("puma560")
    assert default_configuration(robot) == (robot.poses["home"], "home")


def test_planar_arms_are_seen_straight_onto_their_plane():
    assert np.allclose(np.abs(plane_of(robokin.load("planar3r"))), [0.0, 0.0, 1.0])
    assert plane_of(robokin.load("scara")) is None
    view, flat = usual_view(robokin.load("planar3r"))
    assert flat
    assert axis_names(view) == ("x", "y")
    assert not usual_view(robokin.load("puma560"))[1]


def test_the_eye_has_right_handed_axes(rng):
    for azimuth, elevation in rng.uniform(-90.0, 90.0, (20, 2)):
        eye = eye_axes((azimuth, elevation))
        assert np.allclose(eye @ eye.T, np.eye(3), atol=1e-12)
        assert np.linalg.det(eye) == pytest.approx(1.0)
        assert eye[0, 2] == 0.0, "the horizon is level"


def test_faces_are_drawn_from_far_to_near_and_a_ghost_upon_an_arm_is_nothing():
    robot = robokin.load("puma560")
    arm, frames, eye = arm_of(robot), body_frames(robot, robot.poses["home"]), eye_axes((-58.0, 22.0))
    drawn: set[tuple[object, ...]] = set()
    faces = ordered(list(arm_faces(arm, frames, eye, None, drawn)), eye)
    depth = [np.mean(face.corners @ eye[2]) for face in faces]
    assert depth == sorted(depth)
    assert all(face.colour.min() >= 0.0 and face.colour.max() <= 1.0 for face in faces)
    assert not list(arm_faces(arm, frames, eye, "#c8551b", drawn))
