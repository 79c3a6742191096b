"""Rows of redundant arms, and of arms without a closed form, by the kernel: those of Python's steps one at a time."""

from __future__ import annotations

import numpy as np
import pytest
from library_entries import entry

import robokin
from robokin.inverse.follow import NEAR
from robokin.inverse.hold import held_arm
from robokin.inverse.path_goals import Goal, Manner
from robokin.inverse.paths_to_poses import path_through
from robokin.inverse.plain_rows import PlainRows
from robokin.kernel.native_kernel import native

pytestmark = pytest.mark.skipif(native is None, reason="no native kernel in use")

HELD = {"panda": 2, "iiwa14": 2, "crx10ia": None, "planar3r": None}
"""Arms, and which joint of those with joints to spare is held for one without a closed form."""


@pytest.fixture
def one_by_one(monkeypatch):
    """A path without rows by the kernel."""

    def asked(*given, **named):
        with monkeypatch.context() as patch:
            patch.setattr(PlainRows, "run", lambda self, poses, q, ahead: (np.empty((0, len(q))), ahead))
            return robokin.follow_line(*given, **named)

    return asked


def some_line(robot, rng, far):
    """A configuration within the limits and the pose of another."""
    low, high = np.where(np.isfinite(robot.limits), robot.limits, np.array([-2.0, 2.0])).T
    q = 0.7 * rng.uniform(low, high)
    end = np.clip(q + rng.uniform(-far, far, robot.n), low, high)
    return q, robokin.forward_kinematics(robot, end)


@pytest.mark.parametrize("held", [False, True])
@pytest.mark.parametrize("name", HELD)
def test_rows_are_those_of_steps_one_at_a_time(name, held, rng, instructions, one_by_one):
    robot, joint = entry(name), HELD[name]
    if held:
        if joint is None:
            pytest.skip("no joint is to spare")
        robot = held_arm(robot, {joint: 0.3}).part
    for far, steps, task in ((0.4, 60, "pose"), (1.5, 60, "pose"), (0.4, 7, "position"), (1.5, 60, "position")):
        q, T = some_line(robot, rng, far)
        path = robokin.follow_line(robot, q, T, steps, task=task)
        expected = one_by_one(robot, q, T, steps, task=task)
        assert len(path) == len(expected)
        np.testing.assert_allclose(path.q, expected.q, atol=1e-6)
        assert path.fraction == pytest.approx(expected.fraction, abs=1e-7)
        assert [event.kind for event in path.events] == [event.kind for event in expected.events]


@pytest.mark.parametrize("name", ["panda", "iiwa14"])
def test_rows_close_to_rounding_and_keep_to_limits(name, rng):
    robot = entry(name)
    complete = 0
    for _ in range(8):
        q, T = some_line(robot, rng, 0.8)
        path = robokin.follow_line(robot, q, T, 500)
        straight = path.T[0, :3, 3] + path.s[:, None] * (T[:3, 3] - path.T[0, :3, 3])
        np.testing.assert_allclose(path.T[:, :3, 3], straight, atol=2e-12)
        assert robot.within_limits(path.q).all()
        assert np.max(np.abs(np.diff(path.q, axis=0))) <= NEAR
        complete += path.complete
    assert complete >= 2


def test_a_joint_that_meets_its_limit_is_held_by_the_kernel(one_by_one):
    robot = entry("panda")
    q = np.radians([0.0, -30.0, 0.0, -100.0, 0.0, 90.0, 0.0])
    T = robokin.forward_kinematics(robot, q)
    T[:3, 3] = [0.3, 0.0, 0.35]
    free = robokin.follow_line(robot, q, T, 200, limits=False)
    path, expected = robokin.follow_line(robot, q, T, 200), one_by_one(robot, q, T, 200)
    assert path.complete == expected.complete
    np.testing.assert_allclose(path.q, expected.q, atol=1e-6)
    assert robot.within_limits(path.q).all() and len(free) >= len(path)


def test_an_arm_without_a_closed_form_keeps_its_branch_past_a_singularity(one_by_one):
    """Beside it solutions are listed, elsewhere steps lead on; both to the same rows."""
    robot = held_arm(entry("iiwa14"), {2: 0.4}).part
    q = np.radians([20.0, 40.0, -60.0, 10.0, 3.0, 30.0])
    end = np.radians([25.0, 45.0, -65.0, 10.0, -3.0, 30.0])
    T = robokin.forward_kinematics(robot, end)
    path, expected = robokin.follow_line(robot, q, T, 400), one_by_one(robot, q, T, 400)
    np.testing.assert_allclose(path.q, expected.q, atol=1e-6)
    assert len(path) == len(expected)


def test_a_path_with_a_held_joint_has_the_solutions_that_are_listed(rng):
    robot = entry("panda")
    q = np.radians([0.0, -30.0, 0.0, -100.0, 0.0, 90.0, 0.0])
    T = robokin.forward_kinematics(robot, q)
    T[:3, 3] = [0.4, 0.1, 0.4]
    part = held_arm(robot, {2: 0.0}).part
    path = path_through(part, q[[0, 1, 3, 4, 5, 6]], [Goal(T=T)], 1000, Manner("line"))
    assert path.complete
    for i in rng.integers(0, 1001, 5):
        listed = robokin.solve_ik(part, path.T[i], limits=False).solutions
        assert min(np.max(np.abs(one.q - path.q[i])) for one in listed) < 1e-8
