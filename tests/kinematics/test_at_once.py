"""Plain calls answered at once by the native kernel: the digits of a batch, and the checks of every other call."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest
from inverse import arms
from inverse.test_coupled_joints import coupled

import robokin
from robokin.kernel.facts import facts_of
from robokin.kernel.native_kernel import native
from robokin.kinematics.at_once import NAME


def same(a, b):
    """Arrays of the same digits, signs of zeros and NaN included."""
    return np.array_equal(a, b, equal_nan=True) and np.array_equal(np.signbit(a), np.signbit(b))


@pytest.mark.skipif(native is None, reason="no native kernel in use")
def test_one_configuration_has_the_digits_of_a_batch(instructions, rng):
    robots = [arms.random_chain(rng) for _ in range(30)] + [
        robokin.load(name) for name in ("puma560", "iiwa14", "panda")
    ]
    for robot in robots:
        q = rng.normal(size=(12, robot.n)) * rng.choice([1.0, 10.0, 1e4, 1e6], size=(12, 1))
        q[0], q[1], q[2, 0], q[3, -1], q[4] = 0.0, np.round(q[1]), np.nan, np.inf, -0.0
        T, J = robokin.forward_kinematics(robot, q), robokin.jacobian(robot, q)
        for row, pose, twists in zip(q, T, J, strict=True):
            assert same(robokin.forward_kinematics(robot, row), pose)
            assert same(robokin.forward_kinematics(robot, row.tolist()), pose)
            assert same(robokin.jacobian(robot, row), twists)
            assert same(robokin.jacobian(robot, row.tolist()), twists)
        assert same(robokin.forward_kinematics(robot, q[None]), T[None])


@pytest.mark.parametrize("find", [robokin.forward_kinematics, robokin.jacobian])
def test_what_is_not_plain_is_checked_as_before(find):
    robot = robokin.load("puma560")
    q = np.arange(6.0) / 10.0
    plain = find(robot, q)
    # Twice: the first call lets the kernel know the robot.
    for _ in range(2):
        strided = np.stack([q, q], axis=1)[:, 0]
        for other in (strided, tuple(q), [0, 0.1, 0.2, 0.3, 0.4, 0.5], q.astype(np.longdouble), q.astype(">f8")):
            assert np.allclose(find(robot, other), plain, rtol=0, atol=1e-15)
        for wrong in (
            q[:5],
            [0.1] * 7,
            0.3,
            np.float64(0.3),
            [True] * 6,
            [1j] * 6,
            ["a"] * 6,
            None,
            [[0.1] * 6, [0.1]],
        ):
            with pytest.raises(robokin.InputError):
                find(robot, wrong)
        for cores in (True, 1.5, "1", 0, [1]):
            with pytest.raises(robokin.InputError):
                find(robot, q, cores=cores)
        for no_robot in ("puma560", None, {"_facts": 1}, q):
            with pytest.raises(robokin.InputError, match="expected a Robot"):
                find(no_robot, q)
        masked = np.ma.masked_array(q, mask=[False] * 5 + [True])
        for hidden in (masked, [*masked], tuple(masked), [masked, masked], [[masked], [q]]):
            with pytest.raises(robokin.InputError, match="masked"):
                find(robot, hidden)
        assert find(robot, np.empty((0, 6))).shape[0] == 0
    with pytest.raises(robokin.InputError, match="frame"):
        robokin.jacobian(robot, q, frame="tol")
    assert not np.allclose(robokin.jacobian(robot, q, frame="tool"), robokin.jacobian(robot, q))


def test_what_looks_like_a_robot_is_none():
    class Fake:
        pass

    for facts in ({NAME: object()}, {NAME: None}, {}, 3):
        fake = Fake()
        fake._facts = facts
        with pytest.raises(robokin.InputError, match="expected a Robot"):
            robokin.forward_kinematics(fake, [0.0] * 6)


def test_copies_know_nothing_yet_and_answer_the_same(rng):
    robot = robokin.load("puma560")
    q = rng.normal(size=6)
    T = robokin.forward_kinematics(robot, q)
    assert (NAME in facts_of(robot)) == (native is not None)
    for other in (copy.copy(robot), copy.deepcopy(robot), pickle.loads(pickle.dumps(robot))):
        assert np.array_equal(robokin.forward_kinematics(other, q), T)


def test_an_arm_whose_joints_hang_on_each_other_is_left_to_python(rng):
    robot = coupled(robokin.load("puma560"), [(2, 1, 1.0, True)])
    q = rng.normal(size=robot.n)
    T = robokin.forward_kinematics(robot, q)
    assert NAME not in facts_of(robot)
    assert np.array_equal(robokin.forward_kinematics(robot, q), T)
