"""Robots whose joints hang on each other, with some of what is typed held: the others are solved for."""

from __future__ import annotations

import numpy as np
import pytest

import robokin
from robokin.inverse.hold import held_arm
from robokin.model import CoupledRobot
from robokin.model.robot import Robot

from .test_coupled_joints import ARMS, FREE, coupled, finger, random_values, same


@pytest.mark.parametrize("name", ARMS)
def test_what_is_held_stands_and_the_rest_is_found(name):
    base, couplings = ARMS[name]
    limits = [[-3.0, 3.0]] * 6 if base != "stanford" else [[-3.0, 3.0]] * 2 + [[-5.0, 5.0]] + [[-3.0, 3.0]] * 3
    arm = coupled(robokin.load(base), couplings, limits)
    rng = np.random.default_rng(41)
    for q in random_values(arm, rng, 4):
        held = {int(i): float(q[i]) for i in rng.choice(arm.n, 2, replace=False)}
        T = robokin.forward_kinematics(arm, q)
        found = robokin.solve_ik(arm, T, hold=held)
        assert any(same(one.q, q, arm.revolute) for one in found)
        for one in found:
            assert all(one.q[i] == value for i, value in held.items())
            assert np.allclose(robokin.forward_kinematics(arm, one.q), T, atol=1e-8)
            assert arm.within_limits(one.q)


def test_held_solutions_are_those_of_the_whole_that_have_the_value():
    """Where both lists are all, one is a part of the other."""
    arm = coupled(robokin.load("puma560"), ARMS["pendant"][1])
    for q in random_values(arm, np.random.default_rng(42), 6):
        T = robokin.forward_kinematics(arm, q)
        whole = robokin.solve_ik(arm, T, limits=False)
        part = robokin.solve_ik(arm, T, limits=False, hold={1: q[1]})
        assert whole.complete and part.complete
        wanted = [one for one in whole if abs(np.angle(np.exp(1j * (one.q[1] - q[1])))) < 1e-7]
        assert len(wanted) == len(part)
        for one, branch in ((one, one.branch) for one in part):
            (twin,) = [other for other in wanted if same(one.q, other.q, arm.revolute)]
            assert twin.branch == branch


def test_what_is_left_is_as_simple_as_it_can_be():
    pendant = coupled(robokin.load("puma560"), ARMS["pendant"][1])
    # J3 = u3 - u2 + offset: with u2 held each joint has a variable alone, with u3 held two joints have one.
    assert type(held_arm(pendant, {1: 0.3}).part) is Robot
    left = held_arm(pendant, {2: 0.3}).part
    assert isinstance(left, CoupledRobot) and left.drive.S.shape == (6, 5)
    assert type(held_arm(pendant, {1: 0.3, 2: 0.1}).part) is Robot
    # With its leader held a follower stands still.
    assert type(held_arm(finger(), {2: 0.5}).part) is Robot
    assert held_arm(finger(), {2: 0.5}).part.n == 2


def test_all_of_what_is_left_or_not():
    arm = finger()
    q = np.array([0.1, 0.4, 0.7])
    T = robokin.forward_kinematics(arm, q)
    with_leader = robokin.solve_ik(arm, T, task="position", hold={2: q[2]})
    assert with_leader.complete
    assert any(same(one.q, q, arm.revolute) for one in with_leader)
    searched = robokin.solve_ik(arm, T, task="position", hold={0: q[0]})
    assert not searched.complete
    assert any(same(one.q, q, arm.revolute) for one in searched)


def test_limits_of_joints_that_stand_or_hang_on_one_now_count():
    motion = [FREE, FREE, [-1.0, 1.0], *[FREE] * 3]
    arm = coupled(robokin.load("puma560"), ARMS["pendant"][1], [[-3.0, 3.0]] * 6, motion)
    q = np.array([0.3, 0.5, 0.6, 0.4, 0.5, 0.6])
    T = robokin.forward_kinematics(arm, q)
    free = robokin.solve_ik(arm, T, hold={1: q[1]}, limits=False)
    within = robokin.solve_ik(arm, T, hold={1: q[1]})
    assert len(within) == sum(one.within_limits for one in free)
    assert [one.within_limits for one in free] == [bool(arm.within_limits(one.q)) for one in free]
    # u3 - u2 + 0.1 = 2.6 is outside ±1, whatever the others do.
    with pytest.raises(robokin.InputError, match="with q2 and q3 held so, joints that hang on them have no value"):
        robokin.solve_ik(arm, T, hold={1: 0.0, 2: 2.5})
    assert not any(one.within_limits for one in robokin.solve_ik(arm, T, hold={1: 0.0, 2: 2.5}, limits=False))
    with pytest.raises(robokin.InputError, match="with q2 held so"):
        robokin.solve_ik(
            coupled(robokin.load("puma560"), ARMS["pendant"][1], [[-3.0, 3.0]] * 2 + [[-0.1, 0.1]] + [[-3.0, 3.0]] * 3,
                    motion), T, hold={1: 2.5})  # fmt: skip


def test_a_batch_near_and_turns():
    arm = coupled(robokin.load("puma560"), ARMS["wrist"][1], [[-6.0, 6.0]] * 6)
    q = random_values(arm, np.random.default_rng(43), 5)
    q[:, 3] = 0.4
    T = robokin.forward_kinematics(arm, q)
    batch = robokin.solve_ik(arm, T, hold={3: 0.4})
    for i in range(5):
        alone = robokin.solve_ik(arm, T[i], hold={3: 0.4}, near=q[i])
        assert np.max(np.abs(alone[0].q - q[i])) < 1e-7
        assert len(alone) == batch.count[i]
        turned = robokin.solve_ik(arm, T[i], hold={3: 0.4}, turns=True)
        assert len(turned) >= len(alone)
        assert all(one.q[3] == 0.4 for one in turned)
    assert np.all(batch.q[..., 3][~np.isnan(batch.q[..., 3])] == 0.4)
