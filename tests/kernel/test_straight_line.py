"""The code for one configuration gives what the batch gives, bit by bit, for every robot and any angle."""

from __future__ import annotations

import copy
import math
import pickle
import threading
from dataclasses import replace

import numpy as np
import pytest
from kinematics.chains import random_chain
from library_entries import entry, names_of

import robokin
from robokin.kernel import straight_line
from robokin.kernel.chain import chain_of
from robokin.kernel.facts import NAME
from robokin.kernel.frames import pose, program_to_joints, program_to_tool
from robokin.kernel.geometric_jacobian import jacobian
from robokin.kernel.residual import TargetPoses
from robokin.kernel.straight_line import LONGEST, straight_frame, straight_jacobian, straight_residuals
from robokin.model import CoupledRobot, Joint, JointType, Robot

ROUND = np.radians(15.0)


def configurations(rng, n):
    """(9, n) random, round, standing at zero, and far around."""
    return np.concatenate(
        [
            rng.uniform(-3, 3, (3, n)),
            ROUND * rng.integers(-24, 25, (3, n)),
            np.zeros((1, n)),
            rng.uniform(-1, 1, (1, n)) * 1e6,
            np.where(rng.random((1, n)) < 0.5, np.pi, -0.0),
        ]
    )


def random_robots(rng, count):
    for number in range(count):
        convention = ("standard", "modified", "frames")[number % 3]
        robot = random_chain(rng, int(rng.integers(1, 9)), convention, special=bool(rng.integers(2)))
        if number % 4 == 0:
            rows = (replace(row, sense=-1 if row.moves and rng.random() < 0.5 else 1) for row in robot.rows)
            robot = replace(robot, rows=tuple(rows))
        if robot.n:
            yield robot


def library():
    robots = [entry(name) for name in names_of(Robot, least=1)]
    return [robot.free_motion if isinstance(robot, CoupledRobot) else robot for robot in robots]


def same_as_the_batch(robot, q):
    T, J, J_tool = (robokin.forward_kinematics(robot, q), *(robokin.jacobian(robot, q, f) for f in ("base", "tool")))
    assert T.tobytes() == pose(chain_of(robot), q).tobytes()
    assert J.tobytes() == jacobian(chain_of(robot), q).tobytes()
    for k, one in enumerate(q):
        found = robokin.forward_kinematics(robot, one)
        assert found.tobytes() == T[k].tobytes()
        assert robokin.jacobian(robot, one).tobytes() == J[k].tobytes()
        np.testing.assert_allclose(robokin.jacobian(robot, one, "tool"), J_tool[k], rtol=0, atol=1e-15 * _size(J_tool))
        assert found.flags.writeable


def _size(values):
    return max(1.0, float(np.max(np.abs(values), initial=0.0)))


def test_random_chains(rng):
    for robot in random_robots(rng, 300):
        same_as_the_batch(robot, configurations(rng, robot.n))


def test_every_robot_of_the_library(rng):
    for robot in library():
        same_as_the_batch(robot, configurations(rng, robot.n)[1:8:2])


def test_the_other_tangent_differs_in_the_last_digits_only(rng, monkeypatch):
    other = not straight_line.same_tangents()
    monkeypatch.setattr(straight_line, "same_tangents", lambda: other)
    for robot in random_robots(rng, 40):
        chain = chain_of(robot)
        frame = straight_frame(program_to_tool(chain))
        columns = straight_jacobian(program_to_joints(chain), False)
        for q in configurations(rng, robot.n)[:7]:
            T, J = pose(chain, q), jacobian(chain, q)
            np.testing.assert_allclose(frame(q.tolist()), T, rtol=0, atol=4e-15 * robot.n * _size(T))
            np.testing.assert_allclose(columns(q.tolist()).T, J, rtol=0, atol=4e-15 * robot.n * _size(J))


def test_what_is_no_number():
    robot = robokin.load("puma560")
    q = np.array([0.1, math.nan, 0.3, 0.4, 0.5, 0.6])
    for ask in (robokin.forward_kinematics, robokin.jacobian):
        np.testing.assert_array_equal(ask(robot, q), ask(robot, q[None])[0])
        q[3] = math.inf
        with np.errstate(invalid="ignore"):
            np.testing.assert_array_equal(ask(robot, q), ask(robot, q[None])[0])
        q[3] = 0.4


@pytest.mark.parametrize("values", [[1, 2, 3, 4, 5, 6], (0.5,) * 6, np.arange(6), np.arange(6, dtype=np.float32)])
def test_other_kinds_of_numbers(values):
    robot = robokin.load("puma560")
    as_floats = np.asarray(values, dtype=np.float64)
    for ask in (robokin.forward_kinematics, robokin.jacobian):
        assert ask(robot, values).tobytes() == ask(robot, as_floats).tobytes()
    every_other = np.repeat(as_floats, 2)[::2]
    swapped = as_floats.astype(">f8")
    for q in (every_other, swapped):
        assert np.array_equal(robokin.forward_kinematics(robot, q), robokin.forward_kinematics(robot, as_floats))


def test_answers_are_apart():
    robot = robokin.load("ur5e")
    first, again = (robokin.forward_kinematics(robot, np.full(6, 0.3)) for _ in range(2))
    first[:] = 7.0
    assert not np.any(again == 7.0)


def test_long_chains_have_no_code(rng):
    rows = tuple(Joint(str(i), JointType.REVOLUTE, a=0.1, alpha=0.3) for i in range(LONGEST + 1))
    longest = Robot("long", rows)
    assert straight_frame(program_to_tool(chain_of(longest))) is None
    for robot in (longest, replace(longest, rows=rows[1:]), replace(longest, rows=())):
        same_as_the_batch(robot, rng.uniform(-3, 3, (2, robot.n)))


def test_the_code_stays_behind(rng):
    robot = robokin.load("panda")
    q = rng.uniform(-1, 1, 7)
    T, J = robokin.forward_kinematics(robot, q), robokin.jacobian(robot, q)
    for other in (copy.copy(robot), copy.deepcopy(robot), pickle.loads(pickle.dumps(robot))):
        assert not vars(other).get(NAME)
        assert robokin.forward_kinematics(other, q).tobytes() == T.tobytes()
        assert robokin.jacobian(other, q).tobytes() == J.tobytes()


def test_many_threads_ask_at_once(rng):
    robot = replace(robokin.load("crx10ia"))
    q = rng.uniform(-3, 3, (200, 6))
    T, J = robokin.forward_kinematics(replace(robot), q), robokin.jacobian(replace(robot), q)
    wrong = []

    def ask():
        for k, one in enumerate(q):
            if robokin.forward_kinematics(robot, one).tobytes() != T[k].tobytes():
                wrong.append(k)
            if robokin.jacobian(robot, one).tobytes() != J[k].tobytes():
                wrong.append(k)

    threads = [threading.Thread(target=ask) for _ in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_what_is_missing_of_a_target(rng):
    for robot in random_robots(rng, 60):
        chain = chain_of(robot)
        residuals = straight_residuals(program_to_tool(chain))
        rows = configurations(rng, robot.n)
        for T in (pose(chain, rows[0]), pose(chain, rows[4])):
            targets = TargetPoses(chain, np.broadcast_to(T, (len(rows), 4, 4)))
            expected = targets.residuals(np.arange(len(rows)), np.ascontiguousarray(rows.T))
            found = residuals(rows.tolist(), T[:3].T.ravel().tolist())
            np.testing.assert_allclose(np.transpose(found), expected, rtol=1e-15, atol=0)
        assert residuals([], T[:3].T.ravel().tolist()) == []
