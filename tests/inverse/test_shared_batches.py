"""A batch that several cores share has the answers that one core finds, to the last digit."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest

import robokin
from robokin.errors import InputError
from robokin.inverse import answered_batch


@pytest.fixture
def small_blocks(monkeypatch):
    monkeypatch.setattr(answered_batch, "BLOCK", 8)


@pytest.mark.parametrize(
    ("name", "asked"),
    [
        ("puma560", {}),
        ("puma560", {"turns": True, "most": 3}),
        ("puma560", {"near": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6], "limits": False}),
        ("panda", {"hold": {2: 0.3}}),
        ("scorbot", {"task": "approach"}),
    ],
    ids=str,
)
def test_a_batch_has_the_same_answers(name, asked, small_blocks, rng):
    robot = robokin.load(name)
    low, high = np.clip(robot.limits, -3.0, 3.0).T
    T = robokin.forward_kinematics(robot, rng.uniform(low, high, (30, robot.n)))
    T[11, :3, 3] += 40.0  # out of reach
    T[12] = robokin.forward_kinematics(robot, np.zeros(robot.n))  # a self-motion, perhaps
    one, two = (robokin.solve_ik(robot, T, cores=cores, **asked) for cores in (1, 2))
    for field in ("q", "count", "position_error", "angle_error", "within_limits"):
        assert np.array_equal(
            getattr(one, field), getattr(two, field), equal_nan=field not in ("count", "within_limits")
        )
    assert (one.complete, one.method, one.branches()) == (two.complete, two.method, two.branches())
    assert [one.reason(i) for i in (11, 12)] == [two.reason(i) for i in (11, 12)]
    for i in (0, 11, 12, 29):
        assert one[i].record() == two[i].record()


@pytest.mark.parametrize("cores", [0, 1.5, "2"])
def test_cores_are_a_whole_number(cores):
    robot = robokin.load("puma560")
    with pytest.raises(InputError, match="cores"):
        robokin.solve_ik(robot, np.tile(np.eye(4), (3, 1, 1)), cores=cores)
    with pytest.raises(InputError, match="cores"):
        robokin.forward_kinematics(robot, np.zeros((3, 6)), cores=cores)


@pytest.mark.parametrize("asked", [{}, {"turns": True}, {"hold": {2: 0.3}}, {"most": 2}], ids=str)
def test_a_batch_survives_pickles_and_copies(asked, rng):
    robot = robokin.load("puma560")
    T = robokin.forward_kinematics(robot, np.vstack([np.zeros(6), rng.uniform(-1, 1, (2, 6))]))
    T[2, :3, 3] += 10.0
    batch = robokin.solve_ik(robot, T, **asked)
    for other in (pickle.loads(pickle.dumps(batch)), copy.deepcopy(batch)):
        assert np.array_equal(batch.q, other.q, equal_nan=True)
        assert batch.branches() == other.branches()
        assert batch.reason(2) == other.reason(2)
        assert [one.record() for one in batch] == [one.record() for one in other]
