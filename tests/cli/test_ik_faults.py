"""Inverse kinematics from the shell where it was wrong once: poses as `fk` writes them, in a pipe and as a matrix."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest
from sweeps import sweep

ROUND = [
    ("xarm6", "20,-30,-60,0,60,10", 4),
    ("xarm6", "-90,50,-30,0,110,70", 1),
    ("piper-old", "50,120,-50,0,-60,-50", 1),
    ("hc10", "-120,150,150,30,-180,-60", 12),
    ("crx20ia-l", "90,90,0,-90,0,90", 8),
    ("big-yam", "-150,0,0,90,-90,0", 1),
    ("yam", "-60,180,60,60,90,0", 1),
    ("viperx300s", "120,-90,90,120,30,0", 1),
    ("cr5", "180,-120,150,0,0,-60", 1),
]
"""Arms and configurations within their limits, and how many solutions there are at least (regular ones, where more
than one): found by Newton's method from thousands of random guesses."""

FIVE = """
robokin: 1
name: Five joints
units: {length: mm, angle: deg}
joints:
  - {type: revolute, d: 500, a: -300, alpha: 90}
  - {type: revolute, d: 250, a: -300, alpha: -90}
  - {type: revolute, d: 0, a: 350, alpha: 90}
  - {type: revolute, d: 300, a: -300, alpha: 180}
  - {type: revolute, d: 0, a: 0, alpha: -90}
"""

WRIST = """
robokin: 1
name: Three slides and a ZYZ wrist
units: {length: m, angle: deg}
convention: frames
joints:
  - {type: prismatic, axis: x}
  - {type: prismatic, axis: y}
  - {type: prismatic, axis: z}
  - {type: revolute, axis: z}
  - {type: revolute, axis: y}
  - {type: revolute, axis: z}
"""


@pytest.fixture
def by_pipe(call):
    """The rows of `robokin fk ROBOT --q=Q -f csv | robokin ik ROBOT -i - -f csv`."""

    def by_pipe(robot, q, *more):
        poses = call("fk", robot, f"--q={q}", "-f", "csv")
        assert poses.status == 0, poses
        answer = call("ik", robot, "-i", "-", "-f", "csv", *more, stdin=poses.out)
        rows = answer.csv[1:]
        return [row for row in rows if row[1] != "0"], answer

    return by_pipe


@pytest.fixture
def by_matrix(call):
    """The document of `robokin ik ROBOT --matrix`, the matrix as `fk --json` gives it."""

    def by_matrix(robot, q, *more):
        pose = call("fk", robot, f"--q={q}", "--json").json["pose"]["matrix"]
        return call("ik", robot, "--matrix", json.dumps(pose), "--json", *more)

    return by_matrix


@pytest.mark.parametrize(("robot", "q", "least"), sweep(ROUND, 3))
def test_round_poses_in_a_pipe(by_pipe, robot, q, least):
    rows, answer = by_pipe(robot, q)
    assert answer.status == 0, answer.text
    assert len(rows) >= least


@pytest.mark.parametrize(("robot", "q", "least"), sweep(ROUND, 3))
def test_round_poses_as_a_matrix(by_matrix, robot, q, least):
    answer = by_matrix(robot, q)
    assert answer.status == 0, answer.text
    assert len(answer.json["solutions"]) >= least


def test_five_joints_in_a_pipe(by_pipe, by_matrix, tmp_path):
    path = tmp_path / "five.yaml"
    path.write_text(FIVE)
    rows, answer = by_pipe(path, "35,0,70,68,-42")
    assert answer.status == 0, answer.text
    assert any(np.allclose(np.array(row[2:7], dtype=float), [35, 0, 70, 68, -42], atol=1e-6) for row in rows)
    assert by_matrix(path, "35,0,70,68,-42").status == 0


def test_a_pose_next_to_right_angles(by_pipe):
    q = "-90.0000004,-90,-89.9999998,0,-89.9999996,-89.9999999"
    rows, answer = by_pipe("anthropomorphic-wrist", q, "--no-limits")
    assert answer.status == 0, answer.text
    assert rows


def test_solutions_that_only_limits_exclude(by_pipe, by_matrix):
    """Four of the eight are outside the limits of the elbow and of the fifth joint."""
    rows, _ = by_pipe("xarm6", "20,-30,-60,0,60,10", "--no-limits")
    assert len(rows) == 8
    assert len(by_matrix("xarm6", "20,-30,-60,0,60,10", "--no-limits").json["solutions"]) == 8


# Near a configuration -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("robot", ["ur5e", "ur10e", "cr5"])
def test_near_a_configuration_that_solves_the_pose(by_pipe, robot):
    q = "10,-80,70,20,0,30"
    rows, _ = by_pipe(robot, q, "--near", q)
    assert np.allclose(np.array(rows[0][2:8], dtype=float), [10, -80, 70, 20, 0, 30], atol=1e-4)


@pytest.mark.parametrize("robot", sweep(["ur5e", "cr5"], 2))
def test_a_line_from_a_singular_configuration_to_itself(call, robot):
    q = "10,-80,70,20,0,30"
    answer = call("path", robot, "--from", q, "--to", q, "--line", "--steps", "10", "-f", "csv")
    assert (answer.status, len(answer.csv)) == (0, 12), answer
    assert np.allclose(answer.numbers[:, 1:7], [10, -80, 70, 20, 0, 30], atol=1e-4)


@pytest.mark.parametrize("start", sweep(["1,2,3,-90,0,90", "1,2,3,0,0,0"], 2))
def test_a_line_that_starts_with_a_straight_wrist(call, tmp_path, start):
    """Rot(x, 90) is Rz(-90) Ry(90) Rz(90): q4 and q6 turn against each other first, and the tool stands still."""
    path = tmp_path / "wrist.yaml"
    path.write_text(WRIST)
    arguments = ["--from", start, "--pose", "Trans(1,2,3) Rot(x,90)", "--line", "--steps", "20", "-f", "csv"]
    answer = call("path", path, *arguments)
    assert answer.status == 0, answer
    wrist = answer.numbers[-1, 4:7] % 360
    assert np.allclose(wrist, [270, 90, 90], atol=1e-4) or np.allclose(wrist, [90, 270, 270], atol=1e-4)


# What is said ---------------------------------------------------------------------------------------------------

POSE = ["--pose", "Trans(300,200,400) RPY(170,10,20)"]


def test_a_cut_list_says_how_many_there_are(call):
    whole = call("ik", "puma560", *POSE, "--no-limits").lines[1]
    count = int(re.match(r"(\d+) solutions", whole).group(1))
    cut = call("ik", "puma560", *POSE, "--no-limits", "--max", "1").lines[1]
    assert count > 1
    assert "may be more" not in cut
    assert re.search(rf"\b{count}\b", cut), cut


def test_whole_turns_within_the_limits(call):
    """ur5e: ±360° for five of six joints, ±180° for the elbow: each solution has 32 equivalents."""
    found = call("ik", "ur5e", *POSE, "--json").json["solutions"]
    assert all(abs(abs(value) - 360 * (abs(value) > 180)) > 1e-6 for one in found for value in one["q"])
    turned = call("ik", "ur5e", *POSE, "--turns", "--json").json["solutions"]
    assert len(turned) == 32 * len(found)
    assert len({tuple(np.round(one["q"], 6)) for one in turned}) == len(turned)
    assert all(np.all(np.abs(one["q"]) <= 360.0 + 1e-6) for one in turned)
    assert str(32 * len(found)) in call("ik", "ur5e", *POSE).text


@pytest.mark.parametrize("robot", sweep(["ur5e", "stanford", "raghavan-roth-rprrpr", "z1"], 4))
def test_nothing_is_written_to_stderr_at_round_poses(by_pipe, robot):
    for q in ("0,0,400,0,0,0", "90,-90,400,0,90,0") if robot == "stanford" else ("0,0,0,0,0,0", "90,-90,0,0,90,0"):
        _, answer = by_pipe(robot, q)
        assert "Warning" not in answer.err
        assert "Traceback" not in answer.err
