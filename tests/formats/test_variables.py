"""The joint's variable in its own cell, and with the other sign: the same robot as with offset and sense."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from formats.texts import DEGREES, HEAD, arm, error_of
from kinematics.reference import rot, trans

import robokin
from robokin.formats import load, read_text
from robokin.pictures.arm import arm_of, body_frames

Z = np.eye(3)[2]
PHI = DEGREES + "parameters: {phi: 20, c: 5}\n"


@pytest.mark.parametrize(
    ("text", "offset", "sense"),
    [
        ("q", 0, 1), ("q1", 0, 1), ("theta1", 0, 1), ("waist", 0, 1), ("'q1 + 90'", 90, 1), ("q - 30", -30, 1),
        ("90 + q1", 90, 1), ("90 - q1", 90, -1), ("-q1", 0, -1), ("-theta1 - 45", -45, -1), ("+-+-q1", 0, 1),
        ("phi + q1", 20, 1), ("phi - 2*c - q1", 10, -1), ("sin(30) - waist + 1", 1.5, -1), ("(90) - q", 90, -1),
        ("0 + q + 0", 0, 1), ("deg(pi/2) - q", 90, -1), ("90 - q + 10", 100, -1),
    ],
)  # fmt: skip
def test_a_constant_is_the_offset_and_a_minus_the_sense(text, offset, sense):
    row = read_text(arm(f"name: waist, type: R, theta: {text}, a: 1", head=PHI)).rows[0]
    assert row.offset == pytest.approx(np.radians(offset), abs=1e-15)
    assert (row.sense, row.theta) == (sense, 0.0)
    columns = read_text(PHI + f"joints: {{type: R, name: [waist], theta: [{text}], a: [1]}}\n").rows[0]
    assert (columns.offset, columns.sense) == (row.offset, row.sense)
    slide = read_text(arm(f"name: waist, type: P, d: {text.replace('theta1', 'd1')}", head=PHI)).rows[0]
    if "pi" not in text:
        assert slide.offset == pytest.approx(offset * 1e-3)
    assert slide.sense == sense


def test_the_number_is_that_of_the_joint():
    robot = read_text(arm("type: R, theta: q1", "type: F, d: 5", "type: P, d: d2 + 7", "type: R, theta: 90 - theta3"))
    assert [joint.sense for joint in robot.joints] == [1, 1, -1]
    assert robot.joints[1].offset == 0.007


@pytest.mark.parametrize(
    ("rows", "at", "said"),
    [
        (["type: R, theta: q2"], "5:22", "expected the variable (`theta: q + c`)"),
        (["type: R, theta: q2", "type: R"], "5:22", "found 'q2', the variable of joint 2, expected this"),
        (["type: R, theta: q1 + q2", "type: R"], "5:22", "the variable of joint 2"),
        (["type: F", "type: R, theta: q2", "type: R"], "6:22", "own: q, q1 or theta1"),
        (["type: R, theta: q1 +"], "5:22", "found the end"),
        (["type: R, theta: q1 -"], "5:22", "found the end"),
        (["type: R, theta: 2*q1"], "5:22", "found more than the joint's variable q1 and a constant"),
        (["type: R, theta: q1*2"], "5:22", "expected such as 'q1', 'q1 + c' or 'c - q1'"),
        (["type: R, theta: q1 + q1"], "5:22", "found more than"),
        (["type: R, theta: 90 - (q1)"], "5:22", "found more than"),
        (["type: R, theta: 90/-q1"], "5:22", "found more than"),
        (["type: R, theta: 2**-q1"], "5:22", "found more than"),
        (["type: R, theta: sin(q1)"], "5:22", "found more than"),
        (["type: R, theta: 2 q1"], "5:22", "found more than"),
        (["type: R, theta: d1"], "5:22", "where the joint variable stands"),
        (["type: P, d: theta1"], "5:18", "where the joint variable stands"),
        (["type: R, theta: q1 + zz"], "5:22", "found the unknown name 'zz'"),
        (["type: R, theta: q1 + pi/2"], "5:22", "write deg(pi/2)"),
        (["type: R, theta: q1 + 90, offset: 5"], "5:39", "found 'offset' and a constant in theta of row 1"),
        (["type: R, theta: -q1, sense: -1"], "5:34", "found 'sense' and a minus"),
        (["type: R, sense: 2"], "5:22", "expected 1 or -1"),
        (["type: R, sense: "], "5:22", "expected sense of row 1"),
        (["type: F, sense: 1"], "5:22", "it has no variable"),
    ],
)  # fmt: skip
def test_what_else_stands_there_is_refused(rows, at, said):
    error = error_of(arm(*rows))
    assert said in error.message
    assert f"{error.line}:{error.column}" == at


def test_a_parameter_is_not_the_variable():
    error = error_of(arm("type: R, theta: q1", head=DEGREES + "parameters: {q1: 5}\n"))
    assert "found 'q1', which is a parameter and the joint's variable" in error.message


@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_a_table_with_senses_is_the_product_that_it_states(convention, rng):
    rows = ["type: R, theta: 0.4 - q, d: 0.1, a: 0.2, alpha: 0.3",
            "type: P, theta: 0.5, a: 0.6, alpha: 0.7, d: 0.8 - d2", "type: R, sense: -1, a: 0.3"]  # fmt: skip
    robot = read_text(arm(*rows, head=HEAD + f"convention: {convention}\n"))

    def step(theta, d, a, alpha):
        z, x = rot(Z, theta) @ trans(0, 0, d), trans(a, 0, 0) @ rot(np.eye(3)[0], alpha)
        return z @ x if convention == "standard" else x @ z

    for q in rng.uniform(-2, 2, (5, 3)):
        expected = step(0.4 - q[0], 0.1, 0.2, 0.3) @ step(0.5, 0.8 - q[1], 0.6, 0.7) @ step(-q[2], 0, 0.3, 0)
        assert np.allclose(robokin.forward_kinematics(robot, q), expected, atol=1e-14)
        h = 1e-6 * np.eye(3)
        ahead, behind = (robokin.forward_kinematics(robot, q + sign * h)[:, :3, 3] for sign in (1, -1))
        assert np.allclose(robokin.jacobian(robot, q)[:3], (ahead - behind).T / 2e-6, atol=1e-8)


def test_a_frames_row_turns_and_slides_the_other_way():
    head = HEAD + "convention: frames\n"
    robot = read_text(
        arm("type: R, axis: y, sense: -1, offset: 0.2", "type: P, axis: x, sense: -1, offset: 3", head=head)
    )
    expected = rot([0, 1, 0], 0.2 - 0.7) @ trans(3 - 1, 0, 0)
    assert np.allclose(robokin.forward_kinematics(robot, [0.7, 1.0]), expected, atol=1e-14)


SENSES = {"puma560": [-1, 1, -1, 1, -1, 1], "scara": [1, -1, -1, 1], "stanford": [-1, -1, -1, 1, 1, -1],
          "ur5e": [-1, -1, 1, -1, 1, 1], "planar3r": [1, -1, -1], "cylindrical": [-1, -1, 1]}  # fmt: skip


def with_senses(robot, senses):
    """The robot with variables that enter so, and the limits of its joints turned with them."""
    signs = iter(senses)
    rows = []
    for row in robot.rows:
        sense = next(signs) if row.moves else 1
        low, high = row.limits
        rows.append(replace(row, sense=sense, limits=(low, high) if sense > 0 else (-high, -low)))
    return replace(robot, rows=tuple(rows), poses={})


@pytest.mark.parametrize("name", SENSES)
def test_inverse_kinematics_finds_the_same_postures_with_the_same_names(name, rng):
    robot = load(name)
    senses = np.array(SENSES[name])
    turned = with_senses(robot, SENSES[name])
    low, high = np.clip(robot.limits, -2.0, 2.0).T
    for q in rng.uniform(low, high, (2, robot.n)):
        T = robokin.forward_kinematics(robot, q)
        assert np.allclose(robokin.forward_kinematics(turned, senses * q), T, atol=1e-12)
        ours, theirs = robokin.solve_ik(turned, T), robokin.solve_ik(robot, T)
        assert (ours.complete, len(ours.solutions)) == (theirs.complete, len(theirs.solutions))
        for solution in theirs.solutions:
            (same,) = [other for other in ours.solutions if np.allclose(senses * other.q, solution.q, atol=1e-6)]
            assert same.branch == solution.branch


@pytest.mark.parametrize("name", SENSES)
def test_a_turned_robot_is_drawn_where_it_is(name):
    robot = load(name)
    turned = with_senses(robot, SENSES[name])
    q = np.linspace(0.1, 0.5, robot.n)
    parts = [
        line @ frame[:3, :3].T + frame[:3, 3]
        for arm_, values in ((robot, q), (turned, q * turned.senses))
        for line, frame in zip(arm_of(arm_).lines, body_frames(arm_, values), strict=True)
    ]
    half = len(parts) // 2
    assert all(np.allclose(a, b, atol=1e-9) for a, b in zip(parts[:half], parts[half:], strict=True))


def test_a_held_joint_counts_its_own_way(rng):
    turned = with_senses(load("panda"), [1, 1, -1, -1, 1, 1, -1])
    q = np.array([0.3, 0.4, -0.2, 1.9, 0.3, 1.8, -0.4])
    assert turned.within_limits(q)
    found = robokin.solve_ik(turned, robokin.forward_kinematics(turned, q), hold={2: -0.2})
    assert found.complete
    assert any(np.allclose(solution.q, q, atol=1e-6) for solution in found.solutions)
    assert all(solution.q[2] == -0.2 for solution in found.solutions)
