"""Matrices in symbols of robots whose joints hang on each other: they are worth what the numbers say."""

from __future__ import annotations

import re

import numpy as np
import pytest
from derivation.evaluation import evaluated, matrix_of

import robokin
from robokin.derivation.symbolic_kinematics import symbolic_kinematics
from robokin.derivation.written_sums import written
from robokin.kinematics.dh_table import to_convention
from robokin.model.coupled_robot import driven
from robokin.model.graph import Coupling
from robokin.model.robot import Joint, JointType
from robokin.units import Units

SI = Units("m", "rad")
RATIOS = (1.0, -1.0, 2.0, 2 / 3, -13 / 72, 0.0)


def chain(seed):
    """A random robot with couplings, slides, screws, fixed rows, senses and offsets."""
    rng = np.random.default_rng(seed)
    rows = []
    for i in range(int(rng.integers(2, 5))):
        kind = JointType(str(rng.choice(["revolute", "revolute", "revolute", "prismatic", "fixed"])))
        angle = [0.0, np.pi / 2, float(rng.uniform(-2, 2))]
        d, offset = (float(part) for part in rng.choice([0.0, 0.2], 2))
        rows.append(
            Joint(
                f"j{i + 1}", kind, a=float(rng.choice([0.0, 0.3])), alpha=float(rng.choice(angle)),
                d=d * (kind != "prismatic"),
                offset=float(rng.choice(angle)) if kind == "revolute" else offset * (kind != "fixed"),
                sense=int(rng.choice([1, -1])) if kind != "fixed" else 1,
                pitch=0.05 if kind == "revolute" and rng.random() < 0.2 else 0.0,
            )
        )  # fmt: skip
    moving = [row.name for row in rows if row.moves]
    couplings = []
    for number, name in enumerate(moving[1:], start=1):
        if rng.random() < 0.7:
            others = rng.choice(moving[:number], int(rng.integers(1, number + 1)), replace=False)
            ratios = tuple((str(other), float(rng.choice(RATIOS))) for other in others)
            shift = float(rng.choice([0.0, np.pi / 2, 0.1]))
            couplings.append(Coupling(name, ratios, shift, bool(rng.random() < 0.5)))
    tool = np.eye(4)
    tool[:3, 3] = rng.choice([0.0, 0.1], 3)
    return driven({"name": "chain", "rows": tuple(rows), "tool": tool}, tuple(couplings))


@pytest.mark.parametrize("seed", range(40))
def test_symbols_are_worth_the_forward_kinematics_in_every_unit_and_convention(seed):
    robot = chain(seed)
    q = np.random.default_rng(seed).uniform(-2.0, 2.0, (20, robot.n))
    T = robokin.forward_kinematics(robot, q)
    for convention in ("standard", "modified", "frames"):
        other = to_convention(robot, convention)
        assert np.allclose(robokin.forward_kinematics(other, q), T, atol=1e-12)
        for units, numbers in ((Units("mm", "deg"), False), (SI, True)):
            assert np.max(np.abs(evaluated(other, q, units, numbers) - T)) < 1e-10


@pytest.mark.parametrize("seed", range(0, 40, 5))
def test_the_matrices_are_a_product_with_one_for_each_row(seed):
    robot = chain(seed)
    symbolic = symbolic_kinematics(robot, SI, frames=True)
    q = np.random.default_rng(seed).uniform(-2.0, 2.0, (5, robot.n))
    product = np.eye(4)
    for name, matrix in symbolic.matrices.items():
        product = product @ matrix_of(robot, symbolic, matrix, q)
        assert name in ("base", "tool") or np.allclose(
            product, matrix_of(robot, symbolic, symbolic.frames[f"T_0_{name[1:]}"], q)
        )
    assert np.allclose(product, robokin.forward_kinematics(robot, q))
    assert len([name for name in symbolic.matrices if name.startswith("A")]) == len(robot.rows)


def planar(*couplings):
    rows = tuple(Joint(f"j{i}", JointType.REVOLUTE, a=0.1 * i) for i in (1, 2, 3))
    return driven({"name": "planar", "rows": rows}, couplings)


def x_of(robot):
    return written(symbolic_kinematics(robot, SI).T[0][3])


def test_what_parallel_axes_take_from_each_other_is_gone():
    """A forearm that is held against the horizontal: its angle in space is what is typed."""
    horizontal = planar(Coupling("j2", (("j1", -1.0),), own=True), Coupling("j3", (("j2", -1.0),), own=True))
    assert re.sub("a[0-9]", "a", x_of(horizontal)) == "a*c1 + a*c2 + a*c13"  # θ3 = q3 - (q2 - q1)
    symbolic = symbolic_kinematics(horizontal, SI)
    assert symbolic.functions["c2m1"].argument == "q2 - q1"
    assert not symbolic.definitions


def test_ratios_are_definitions_and_whole_ones_are_not():
    follows = planar(Coupling("j3", (("j2", 1.0),)))
    assert x_of(follows) == "a1*c1 + a2*c12 + a3*c122"
    geared = symbolic_kinematics(planar(Coupling("j3", (("j2", 2 / 3),), 0.1)), SI)
    assert geared.definitions == {"theta3": "0.6666666666666666*q2 + 0.1"}
    # In degrees the offset is in degrees and the ratio is the same.
    geared = symbolic_kinematics(planar(Coupling("j3", (("j2", 0.5),), np.radians(5))), Units("mm", "deg"))
    assert geared.definitions == {"theta3": "0.5*q2 + 5"}


def test_a_screw_is_one_matrix_and_advances_in_the_units():
    rows = (Joint("j1", JointType.REVOLUTE, d=0.1, pitch=0.01 / (2 * np.pi)),)
    symbolic = symbolic_kinematics(driven({"name": "screw", "rows": rows}, ()), Units("mm", "deg"))
    assert list(symbolic.matrices) == ["A1"]
    assert eval(symbolic.definitions["d1"], {"q1": 360.0}) == pytest.approx(110.0)


def test_from_python():
    follows = planar(Coupling("j3", (("j2", 1.0),)))
    assert robokin.symbols(follows).T[0][3] == x_of(follows)
