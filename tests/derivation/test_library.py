"""The matrices in symbols are worth what the numeric forward kinematics says, for every robot and chain."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from derivation.evaluation import evaluated, matrix_of, source_of
from kinematics.chains import random_chain
from library_entries import names_of
from sweeps import sweep

import robokin
from robokin.derivation.symbolic_kinematics import symbolic_kinematics
from robokin.derivation.symbolic_product import MAX_SYMBOLS
from robokin.errors import InputError
from robokin.kinematics.forward import row_frames
from robokin.model import Joint, JointType, Robot
from robokin.units import Units

ROBOTS = names_of(Robot, 0, 7)

TOLERANCE = 1e-10
"""Metres, and entries of a rotation."""

SI = Units("m", "rad")


@pytest.mark.parametrize("name", sweep(ROBOTS, 5))
def test_a_thousand_configurations_of_every_robot_of_the_library(name, rng):
    robot = robokin.load(name)
    q = rng.uniform(-4.0, 4.0, (1000, robot.n))
    T = robokin.forward_kinematics(robot, q)
    for units, numbers in ((robot.units, False), (SI, True)):
        assert np.max(np.abs(evaluated(robot, q, units, numbers) - T)) < TOLERANCE


@pytest.mark.parametrize(
    "name", ["puma560", "puma560-craig", "scara-frames", "thumb", "z1", "openarm-left", "raghavan-roth-1990"]
)
def test_the_matrices_multiply_to_the_product_and_to_every_frame(name, rng):
    robot = robokin.load(name)
    q = rng.uniform(-3.0, 3.0, (50, robot.n))
    symbolic = symbolic_kinematics(robot, SI, frames=True)
    values = {name: matrix_of(robot, symbolic, matrix, q) for name, matrix in symbolic.matrices.items()}
    product = np.eye(4)
    for value in values.values():
        product = product @ value
    assert np.max(np.abs(product - robokin.forward_kinematics(robot, q))) < TOLERANCE
    frames = row_frames(robot, q)
    assert len(symbolic.frames) == frames.shape[1]
    for k, matrix in enumerate(symbolic.frames.values()):
        assert np.max(np.abs(matrix_of(robot, symbolic, matrix, q) - frames[:, k])) < TOLERANCE


@pytest.mark.parametrize("convention", sweep(["standard", "modified", "frames"], 3))
@pytest.mark.parametrize("special", [False, True])
def test_random_chains(convention, special, rng):
    for n in range(1, 7):
        for units in (SI, SI, Units("mm", "deg"), Units("mm", "deg")):
            robot = random_chain(rng, n if special else min(n, 5), convention, special)
            q = rng.uniform(-3.0, 3.0, (20, robot.n))
            difference = evaluated(robot, q, units, bool(rng.integers(2))) - robokin.forward_kinematics(robot, q)
            assert np.max(np.abs(difference)) < TOLERANCE


def test_the_python_form_takes_any_batch_and_needs_no_names_but_its_own(rng):
    robot = robokin.load("stanford")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        scope = {}
        exec(compile(source_of(robot), "fk.py", "exec"), scope)
    forward = scope["forward_kinematics"]
    q = rng.uniform(-1, 1, (2, 3, 6))
    assert forward(q).shape == (2, 3, 4, 4)
    assert np.array_equal(forward(q)[1, 2], forward(list(q[1, 2])))


def test_a_chain_without_joints_is_a_constant():
    robot = robokin.load("assembly")
    assert (
        np.max(np.abs(evaluated(robot, np.zeros((3, 0)), SI) - robokin.forward_kinematics(robot, np.zeros((3, 0)))))
        < 1e-12
    )


def test_a_product_that_would_never_end_is_refused():
    rows = tuple(Joint(str(i), JointType.REVOLUTE, alpha=np.pi / 2) for i in range(400))
    with pytest.raises(InputError, match=f"over {MAX_SYMBOLS:,} symbols, expected a chain with fewer turns"):
        symbolic_kinematics(Robot("snake", rows))


def test_parallel_axes_in_any_number_are_one_turn(rng):
    rows = tuple(Joint(str(i), JointType.REVOLUTE, a=0.1) for i in range(1, 41))
    robot = Robot("planar snake", rows)
    q = rng.uniform(-1, 1, (5, 40))
    assert np.max(np.abs(evaluated(robot, q, SI) - robokin.forward_kinematics(robot, q))) < TOLERANCE
    assert symbolic_kinematics(robot).T[0][0].size == 1
