"""`robokin ik --near previous`: targets of a file one after the other, each near to the answer before it."""

from __future__ import annotations

import json

import numpy as np
import pytest

import robokin

from .conftest import invoke, refused

PATH = ["path", "puma560", "--from", "90,-30,60,0,40,0", "--xyz", "-300,700,200", "--line", "-f", "csv"]


@pytest.fixture(scope="module")
def rows():
    return invoke(*PATH, "--steps", "40").out


def test_a_recorded_line_stays_on_one_branch(call, rows):
    answer = call("ik", "puma560", "-i", "-", "--near", "previous", "-f", "csv", stdin=rows)
    assert (answer.status, answer.err) == (0, "")
    q = np.array([answer.numbers_of(f"q{k}") for k in range(1, 7)]).T
    assert len(q) == 41 and len({row[answer.columns.index("branch")] for row in answer.csv[1:]}) == 1
    assert np.abs(np.diff(q, axis=0)).max() < 5 and {row[-1] for row in answer.csv[1:]} == {"false"}
    poses = robokin.forward_kinematics(robokin.load("puma560"), np.radians(q))
    lines = np.array([[float(cell) for cell in line.split(",")] for line in rows.decode().splitlines()[1:]])
    np.testing.assert_allclose(poses[:, :3, 3] * 1000, lines[:, 7:10], atol=1e-6)


def test_each_answer_is_the_nearest_to_the_one_before(call, rows):
    table = call("ik", "puma560", "-i", "-", "--near", "previous", "-f", "csv", stdin=rows)
    q = np.array([table.numbers_of(f"q{k}") for k in range(1, 7)]).T
    every = call("ik", "puma560", "-i", "-", "--turns", "-f", "csv", stdin=rows)
    numbers = {}
    for row in every.csv[1:]:
        numbers.setdefault(int(row[1]), []).append([float(cell) for cell in row[3:9]])
    for k in range(1, len(q)):
        moves = np.abs(np.array(numbers[k + 1]) - q[k - 1]).max(axis=1)
        assert np.abs(q[k] - q[k - 1]).max() <= moves.min() + 1e-9


def test_the_first_is_near_home(call):
    near_home = call("fk", "puma560", "--q", "88,2,91,1,3,2", "-f", "csv").out
    (row,) = call("ik", "puma560", "-i", "-", "--near", "previous", "-f", "jsonl", stdin=near_home).jsonl
    assert row["solutions"][0]["q"] == pytest.approx([88, 2, 91, 1, 3, 2]) and row["jump"] is False


def test_jumps_are_said(call, rows):
    lines = rows.splitlines()
    torn = b"\n".join([*lines[:3], lines[-1]]) + b"\n"
    answer = call("ik", "puma560", "-i", "-", "--near", "previous", "--max-jump", "5", "-f", "csv", stdin=torn)
    assert [row[-1] for row in answer.csv[1:]] == ["false", "false", "true"]
    assert "1 jump: a joint moves by more than 5 deg" in answer.err
    page = call("ik", "puma560", "-i", "-", "--near", "previous", "--max-jump", "5", stdin=torn)
    assert "target 3 (a jump): " in page.text and "target 2: " in page.text


def test_a_target_without_an_answer_is_passed_by(call):
    lines = ["x,y,z,roll,pitch,yaw", "500,100,300,180,0,45", "9000,0,0,0,0,0", "500,101,300,180,0,45"]
    answer = call("ik", "puma560", "-i", "-", "--near", "previous", "--json", stdin="\n".join(lines).encode())
    first, none, last = json.loads(answer.text)
    assert answer.status == 3 and not none["reachable"] and none["jump"] is False
    assert np.abs(np.subtract(first["solutions"][0]["q"], last["solutions"][0]["q"])).max() < 1


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--max", "2"], "--max: --near previous gives one solution"),
        (["--turns"], "--turns: --near previous gives one solution"),
        (["-o", "folder/"], "--output: --near previous gives one solution"),
        (["--max-jump", "-1"], "--max-jump: found -1, expected 0 or more"),
        (["--max-jump", "far"], "--max-jump"),
    ],
)
def test_what_does_not_go_with_it(call, rows, words, said):
    refused(call("ik", "puma560", "-i", "-", "--near", "previous", *words, stdin=rows), said)


def test_it_is_for_files(call):
    refused(call("ik", "puma560", "--xyz", "500,100,300", "--near", "previous"), "expected --input with it")
    refused(call("ik", "puma560", "--xyz", "500,100,300", "--max-jump", "3"), "--max-jump goes with --near previous")
