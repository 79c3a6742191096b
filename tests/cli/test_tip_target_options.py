"""`robokin ik --target`: several tips of a tree at once."""

from __future__ import annotations

import numpy as np
import pytest
from jsonschema import validate

import robokin

from .conftest import refused

FINGERS = """\
robokin: 1
name: Two fingers
units: {length: mm, angle: deg}
branches:
  palm:  {joints: [{name: wrist, type: revolute, alpha: 90, limits: [-60, 60]}]}
  index:
    {on: palm, base: "Trans(90, 20, 0)",
     joints: [{name: mcp, type: revolute, a: 45, limits: [-10, 90]},
              {name: pip, type: revolute, a: 26, limits: [0, 100]}]}
  ring:
    {on: palm, base: "Trans(88, -18, 0)",
     joints: [{name: mcp, type: revolute, a: 41, limits: [-10, 90]},
              {name: pip, type: revolute, a: 24, limits: [0, 99]}]}
poses: {point: [0, 0, 0, 80, 70]}
"""
HAND = robokin.load_tree("human-hand")
INDEX, LITTLE = "index=150,30,-60", "little=Trans(110,-34,-50)"


@pytest.fixture
def fingers(tmp_path):
    path = tmp_path / "fingers.yaml"
    path.write_text(FINGERS)
    return str(path)


def placed(path, q):
    """The targets that say where the tips are at q [deg], in millimetres, and where that is [m]."""
    T = robokin.tip_poses(robokin.load_tree(path), np.deg2rad(q))
    texts = [",".join(repr(x) for x in (1e3 * p).tolist()) for p in T[:, :3, 3]]
    return ["--target", f"index={texts[0]}", "--target", f"ring={texts[1]}"], T


def test_every_format_says_the_same(call, fingers, tmp_path):
    options, T = placed(fingers, [10.0, 20.0, 30.0, 40.0, 50.0])
    answer = call("ik", fingers, *options, "--json")
    assert answer.status == 0
    document = answer.json
    validate(document, call("schema", "ik").json)
    (group,) = document["groups"]
    assert (group["tips"], group["joints"], document["still"]) == (["index", "ring"], [1, 2, 3, 4, 5], [])
    assert (document["reachable"], document["complete"], group["basis"]) == (True, False, None)
    assert group["certificate"] == "one found by search, since index and ring share q1"
    np.testing.assert_allclose(document["q"], group["solutions"][0]["q"])
    again = robokin.tip_poses(robokin.load_tree(fingers), np.deg2rad(document["q"]))
    np.testing.assert_allclose(again[:, :3, 3], T[:, :3, 3], atol=1e-9)
    for errors in group["solutions"][0]["tips"].values():
        assert errors["position_error"] < 1e-7
        assert errors["angle_error"] == 0.0
    assert call("ik", fingers, *options, "-f", "jsonl").jsonl == [document]
    table = call("ik", fingers, *options)
    assert table.status == 0
    assert table.lines[2].startswith("index, ring: 1 solution, there may be more: one found by search")
    rows = tmp_path / "rows.csv"
    assert call("ik", fingers, *options, "-o", rows).status == 0
    answer = call("ik", fingers, *options, "-f", "csv")
    assert answer.columns[:4] == ["target", "solution", "q1", "q2"]
    assert answer.csv[1][:2] == ["index ring", "1"]
    back = call("fk", fingers, "-i", str(rows), "-f", "csv")
    assert back.numbers_of("index.x") == pytest.approx([1e3 * T[0, 0, 3]], abs=1e-6)
    assert back.numbers_of("ring.z") == pytest.approx([1e3 * T[1, 2, 3]], abs=1e-6)


def test_independent_tips_are_listed_by_tip_as_for_each_alone(call):
    document = call("ik", "human-hand", "--target", INDEX, "--target", "thumb=120,22,-50", "--json").json
    validate(document, call("schema", "ik").json)
    assert [group["tips"] for group in document["groups"]] == [["index"], ["thumb"]]
    for group, place in zip(document["groups"], ("150,30,-60", "120,22,-50"), strict=True):
        alone = call("ik", "human-hand", "--tip", group["tips"][0], "--xyz", place, "--json").json
        own = np.array(group["joints"]) - 1
        for key in ("reachable", "complete", "basis", "certificate", "counts", "method", "reason"):
            assert group[key] == alone[key]
        for mine, theirs in zip(group["solutions"], alone["solutions"], strict=True):
            np.testing.assert_allclose(np.array(mine["q"])[own], theirs["q"], rtol=1e-14, atol=1e-12)
    cut = call("ik", "human-hand", "--target", INDEX, "--max", "2", "--json").json
    assert len(cut["groups"][0]["solutions"]) == 2
    assert document["still"] == [*range(10, 22)]


def test_a_target_that_is_not_had_gives_a_reason_the_nearest_and_status_3(call, fingers):
    answer = call("ik", fingers, "--target", "index=150,20,10", "--target", "ring=900,0,0")
    assert answer.status == 3
    assert "no solution: none within the joint limits found by search (not proven unreachable)" in " ".join(
        answer.lines
    )
    assert answer.text.count("~ the nearest configuration found") == 2
    document = call("ik", fingers, "--target", "index=150,20,10", "--target", "ring=900,0,0", "--json").json
    validate(document, call("schema", "ik").json)
    assert document["q"] is None
    assert document["groups"][0]["nearest"]["tips"]["ring"]["position_error"] > 500.0
    rows = call("ik", "human-hand", "--target", INDEX, "--target", "thumb=900,0,0", "--max", "1", "-f", "csv").csv
    assert [row[:2] for row in rows[1:]] == [["index", "1"], ["thumb", "0"]]
    assert rows[2][-1] == "out of reach"


def test_near_says_where_joints_stand(call, fingers):
    options, _ = placed(fingers, [0.0, 0.0, 0.0, 80.0, 70.0])
    found = call("ik", fingers, *options, "--near", "point", "--json").json
    np.testing.assert_allclose(found["q"], [0, 0, 0, 80, 70], atol=1e-6)
    answer = call("ik", "human-hand", "--target", INDEX, "--near", "fist")
    assert "q1 to q5 and q10 to q21 stand as --near says" in " ".join(answer.lines)
    refused(call("ik", fingers, *options, "--near", "1,2"), "--near", "expected 5")


def test_expressions_are_poses_and_three_numbers_positions(call):
    asked = {
        "index=Trans(150,30,-60) RPY(-90,66,7.6)": "pose",
        "index = rot(z,30)": "pose",
        "index=[[1,0,0,150],[0,1,0,30],[0,0,1,-60],[0,0,0,1]]": "pose",
        "index=100*1.5, 3*10, sqrt(4)": "position",
        "index=150 30 -60": "position",
        "index=[150,30,-60]": "position",
        "index=sqrt(22500),30,-60": "position",
        "index.dip=150,30,-60": "position",
    }
    for text, task in asked.items():
        document = call("ik", "human-hand", "--target", text, "--json").json
        (target,) = document["targets"].values()
        assert target["task"] == task, text
    metres = call("ik", "human-hand", "--target", "index=0.15,0.03,-0.06", "--length", "m", "--json").json
    assert metres["reachable"]
    assert metres["targets"]["index"]["matrix"][0][3] == 0.15


@pytest.mark.parametrize(
    ("typed", "said"),
    [
        (["indx=1,2,3"], ["found the unknown tip 'indx'", "did you mean 'index'"]),
        (["foot=1,2,3"], ["found the unknown tip 'foot'", "thumb, index, middle"]),
        (["index"], ["--target: found 'index', expected TIP=X,Y,Z"]),
        (["index="], ["expected TIP=X,Y,Z"]),
        (["=1,2,3"], ["expected TIP=X,Y,Z"]),
        (["index=1,2"], ["--target index: found 2 values", "expected 3"]),
        (["index=1,2,y"], ["--target index: value 3 of 3"]),
        (["index=Trns(1,2,3)"], ["unknown step 'Trns'", "did you mean 'Trans'"]),
        (["index=Trans(1,2"], ["--target index"]),
        (["index=nan,0,0"], ["--target index", "expected a finite number"]),
        (["index=1e300,0,0"], ["--target index: found a target too far away"]),
        (["index=[[1,2],[3,4]]"], ["--target index: found a matrix of 2×2"]),
        (["index=1,2,3", "--target", "index=1,2,4"], ["--target: index has two targets"]),
        (["index=1,2,3", "--xyz", "1,2,3"], ["--target and --xyz exclude each other"]),
        (["index=1,2,3", "--tip", "index"], ["--target and --tip exclude each other"]),
        (["index=1,2,3", "--input", "x.csv"], ["--target and --input exclude each other"]),
        (["index=1,2,3", "--hold", "q1=2"], ["--target and --hold exclude each other"]),
        (["index=1,2,3", "--turns"], ["--target and --turns exclude each other"]),
        (["index=1,2,3", "--explain"], ["--target and --explain exclude each other"]),
        (["index=1,2,3", "--phi", "0"], ["--target and --phi exclude each other"]),
        (["index=1,2,3", "-o", "q.npy"], ["found the format npy, expected table, json, jsonl or csv"]),
        (["index=1,2,3", "--max", "0"], ["--max"]),
        (["index=1,2,3", "--seed", "x"], ["--seed"]),
    ],
)
def test_what_is_no_target_is_refused(call, typed, said):
    refused(call("ik", "human-hand", "--target", *typed), *said)


def test_a_serial_robot_and_a_mechanism_have_no_targets_by_tip(call):
    refused(call("ik", "puma560", "--target", "tool=1,2,3"), "is a serial robot, expected --pose")
    refused(call("ik", "four-bar", "--target", "tool=1,2,3"), "four-bar is a mechanism")
    refused(call("ik", "car", "--target", "tool=1,2,3"), "car is a wheeled base")
