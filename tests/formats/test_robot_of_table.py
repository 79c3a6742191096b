"""Robots made of tables in Python, and what a robot answers by itself."""

from __future__ import annotations

import numpy as np
import pytest

import robokin

UR5 = [[0, 0.089159, 0, np.pi / 2], [0, 0, -0.425, 0], [0, 0, -0.39225, 0], [0, 0.10915, 0, np.pi / 2],
       [0, 0.09465, 0, -np.pi / 2], [0, 0.0823, 0, 0]]  # fmt: skip
"""Universal Robots, support article "DH parameters for calculations of kinematics and dynamics"."""
Q = np.random.default_rng(0).uniform(-3, 3, (5, 6))


def test_a_table_of_numbers_is_the_robot():
    made, library = robokin.from_table(UR5), robokin.load("ur5")
    np.testing.assert_allclose(made.fk(Q), library.fk(Q), atol=1e-12)
    scaled = np.array(UR5) * [180 / np.pi, 1000, 1000, 180 / np.pi]
    np.testing.assert_allclose(robokin.from_table(scaled, length="mm", angle="deg").fk(Q), library.fk(Q), atol=1e-12)
    shifted = np.array(UR5)
    shifted[:, 0] = 0.3
    np.testing.assert_allclose(robokin.from_table(shifted).fk(Q), library.fk(Q + 0.3), atol=1e-12)


def test_slides_and_craigs_convention():
    made = robokin.from_table([[0, 0.1, 0, 0], [0.2, 0, 0, -np.pi / 2]], types="RP", convention="modified", name="a b")
    assert (made.types, made.convention, made.name) == ("RP", "modified", "a b")
    np.testing.assert_allclose(made.fk([0, 0.5])[:3, 3], [0, 0.5, 0.1], atol=1e-12)


def test_a_text_is_read_as_it_is_pasted():
    text = "i  θ  d  a  α\n1  q1  L1  0  90°\n2  q2  0  300  0"
    with pytest.raises(robokin.InputError, match="no value for L1"):
        robokin.from_table(text)
    made = robokin.Robot.from_dh(text, values={"L1": 400})
    assert made.fk([0, 0])[:3, 3] == pytest.approx([0.3, 0, 0.4])


@pytest.mark.parametrize("number", [1e-6, 1e-300, -2.5e-9, 6.123233995736766e-17, 1e5])
def test_numbers_are_taken_however_they_are_written(number):
    """The e of 1e-06 is no length's name."""
    joint = robokin.from_table([[number, 0.3, 0.2, number], [0, 0, 0.5, 0]]).joints[0]
    assert (joint.offset, joint.alpha) == (number, number)
    if abs(number) < 1.0:
        assert robokin.from_table([[0, 0.3, number, 0], [0, 0, 0.5, 0]]).joints[0].a == number


@pytest.mark.parametrize(
    "text", ["2.5e-01", "2.5E-1", "25.e-02", "25.E-2", ".25e+0", ".025e1", "25e-2 m", "1 - 75.e-02"]
)
def test_exponents_of_ten_in_a_text_are_no_names(text):
    """As numpy and MATLAB print them; a number before a letter is a factor."""
    made = robokin.from_table(f"i,theta,d,a,alpha\n1,q1,{text},0,90°\n2,q2,2e,2E+e,0", values={"e": 0.1, "E": 0.2})
    assert [joint.d for joint in made.joints] == [pytest.approx(0.25, abs=1e-15), pytest.approx(0.2, abs=1e-15)]
    assert made.joints[1].a == pytest.approx(0.5, abs=1e-15)


@pytest.mark.parametrize(
    ("text", "value"),
    [("2½", 2.5), ("-1½", -1.5), ("2 ¾ m", 2.75), ("½", 0.5), ("½L1", 5.0), ("L1/½", 20.0), ("L1 − ½", 9.5),
     ("√½", 0.5**0.5), ("½√2", 0.5**0.5), ("¾²", 0.5625), ("½(L1+2)", 6.0), ("½π", np.pi / 2), ("5½/2", 2.75)],
)  # fmt: skip
def test_a_fraction_that_is_one_letter_is_a_number(text, value):
    """2½ is two and a half; its digits alone would be 21/2."""
    table = f"|theta|d|a|alpha|\n|--|--|--|--|\n|q1|{text}|0|90°|\n|q2|L1|0|0|"
    made = robokin.from_table(table, values={"L1": 10}, length="m")
    assert made.joints[0].d == pytest.approx(value, abs=1e-15)
    with pytest.raises(robokin.InputError, match="L1"):
        robokin.from_table(table.replace(text, "L1½"), values={"L1": 10}, length="m")


@pytest.mark.parametrize("factor", ["   1.0e+03 *", "1.0e-3 ×", "1e+03  *"])
def test_a_common_factor_is_not_passed_over(factor):
    """As MATLAB prints a matrix with small and large numbers."""
    text = f"{factor}\ntheta  d  a  alpha\n0  0.4000  0  0.0900\n0  0  0.3000  0\n"
    with pytest.raises(robokin.InputError, match="found the factor"):
        robokin.from_table(text, types="RR", angle="deg")


def test_methods_are_the_functions():
    robot = robokin.load("puma560")
    q = robot.poses["home"]
    T = robot.fk(q)
    np.testing.assert_array_equal(T, robokin.forward_kinematics(robot, q))
    np.testing.assert_array_equal(robot.jacobian(q, "tool"), robokin.jacobian(robot, q, "tool"))
    assert [one.branch for one in robot.ik(T, limits=False)] == [
        one.branch for one in robokin.solve_ik(robot, T, limits=False)
    ]
    assert robot.plot(q).kind == "html" and robot.plot(q, kind="text").kind == "text"
    hand = robokin.load("human-hand", tip="index")
    assert hand.fk(np.zeros(hand.n)).shape == (4, 4)


def test_a_description_is_read_again(tmp_path):
    robot = robokin.from_table(UR5)
    (tmp_path / "ur.yaml").write_text(robot.to_yaml())
    np.testing.assert_allclose(robokin.load(tmp_path / "ur.yaml").fk(Q), robot.fk(Q), atol=1e-12)


@pytest.mark.parametrize(
    ("table", "options"),
    [([1, 2], {}), ([[1, 2, 3]], {}), ([[0, 0, 0, np.nan]], {}), ([], {}), ("hello", {}), (UR5, {"types": "RR"}),
     (UR5, {"types": 3}), (UR5, {"convention": "craig"}), (UR5, {"length": "km"}), (UR5, {"values": {"L1": 1.0}}),
     (UR5, {"values": 3}), (UR5, {"name": 3}), (None, {})],
)  # fmt: skip
def test_what_is_no_table_is_told(table, options):
    with pytest.raises(robokin.InputError):
        robokin.from_table(table, **options)
