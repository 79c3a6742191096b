"""Robots whose joints hang on each other, in the shell: what is typed, what moves, and what is refused."""

from __future__ import annotations

import json

import numpy as np
import pytest
from cli.conftest import refused
from cli.test_documents import known_fault

from robokin.records.schemas import document_schema

PENDANT = """robokin: 1
name: Pendant arm
units: {length: mm, angle: deg}
joints:
  - {name: J1, type: R, d: 400, a: 50, alpha: -90, limits: [-170, 170]}
  - {name: J2, type: R, a: 400, offset: -90, limits: [-60, 140]}
  - {name: J3, type: R, a: 30, alpha: -90, limits: [-120, 200], motion_limits: [-90, 90]}
  - {name: J4, type: R, d: 400, alpha: 90, limits: [-190, 190]}
  - {name: J5, type: R, alpha: -90, limits: [-120, 120]}
  - {name: J6, type: R, d: 80, limits: [-360, 360]}
couplings:
  - {joint: J3, adds: J2, ratio: -1}
poses: {bent: [10, 20, 30, 40, 50, 60]}
"""

FINGER = """robokin: 1
name: Finger
units: {length: mm, angle: deg}
joints:
  - {name: abd, type: R, alpha: -90, limits: [-20, 20]}
  - {name: mcp, type: R, a: 46, limits: [-45, 90]}
  - {name: pip, type: R, a: 27, limits: [0, 100]}
  - {name: dip, type: R, a: 18, limits: [0, 60]}
couplings: [{joint: dip, follows: pip, ratio: 2/3}]
"""

SCREW = """robokin: 1
name: Screw
units: {length: mm, angle: deg}
joints:
  - {type: R, a: 300}
  - {type: R, a: 250, alpha: 180}
  - {name: spindle, type: helical, pitch: 20, limits: [0, 3600]}
"""


@pytest.fixture
def write(tmp_path):
    def written(text, name="robot.yaml"):
        path = tmp_path / name
        path.write_text(text)
        return path

    return written


def test_what_is_typed_is_what_comes_back(call, write):
    path = write(PENDANT)
    pose = call("fk", path, "--q", "bent", "--json").json["pose"]
    position, rpy = (",".join(map(repr, pose[key])) for key in ("position", "rpy"))
    found = call("ik", path, f"--xyz={position}", f"--rpy={rpy}", "--json").json
    assert found["complete"] and found["basis"] == "counted"
    assert any(max(abs(a - b) for a, b in zip(s["q"], [10, 20, 30, 40, 50, 60], strict=True)) < 1e-6
               for s in found["solutions"])  # fmt: skip
    plain = write(PENDANT.replace("couplings:\n  - {joint: J3, adds: J2, ratio: -1}\n", ""), "plain.yaml")
    matrix = call("fk", plain, "--q", "10,20,10,40,50,60", "--json").json["pose"]["matrix"]
    np.testing.assert_allclose(matrix, pose["matrix"], rtol=0, atol=1e-11)


def test_tables_and_documents_say_what_hangs_on_what(call, write):
    for text, said in ((PENDANT, "J3 adds -1 J2"), (FINGER, "dip follows 0.666667 pip"), (SCREW, "helical")):
        path = write(text)
        assert said in call("show", path).text
        assert call("show", path, "--json").json["kind"] == "robot"
        assert call("validate", path).status == 0
    record = call("show", write(SCREW), "--json").json
    assert (record["rows"][2]["type"], record["rows"][2]["pitch"]) == ("helical", pytest.approx(20.0))
    assert call("show", write(FINGER), "--json").json["couplings"] == [
        {"joint": "dip", "own": False, "ratios": [{"joint": "pip", "ratio": 2 / 3}], "offset": 0.0}
    ]
    assert "of 4 freedoms 3 are left" in call("dof", write(FINGER)).text
    assert "helical" in call("dof", write(SCREW)).text


def test_freedoms_are_marked_as_they_are_counted(call, write):
    for entry in (write(FINGER), write(SCREW, "screw.yaml"), "human-hand", "baxter", "planar3r"):
        said = call("dof", entry, "--json").json
        right = ["check", "dof", entry, "--expect", said["grubler"], "--mobility", said["mobility"]]
        assert call(*right).status == 0
        assert call(*right[:3], "--expect", said["grubler"] + 1).status == 3


def test_other_commands_take_them(call, write):
    for text, q in ((PENDANT, "10,20,30,40,50,60"), (FINGER, "10,20,30"), (SCREW, "10,20,30")):
        path = write(text)
        for command in (("jacobian", path, "--q", q), ("singular", path), ("plot", path, "--q", q),
                        ("path", path, "--from", q, "--to", q), ("plot", path, "--q", q, "--json", "--frames"),
                        ("check", "fk", path, "--q", q, "--expect", "1,2,3")):  # fmt: skip
            assert call(*command).status in (0, 3), command
    line = call("path", write(PENDANT), "--from", "0,0,0,0,10,0", "--to", "10,20,30,0,10,0", "--line", "--json").json
    assert line["fraction"] == 1.0
    over = call("path", write(PENDANT), "--from", "0,0,0,0,10,0", "--to", "0,100,0,0,10,0", "--json").json
    assert "the motion of joint J3 leaves its limits" in str(over["events"])
    assert over["fraction"] == pytest.approx(0.9)


def test_a_motion_outside_its_limits_is_named_and_no_other(call, write):
    # J3 = -60 - 100, though each value that is typed is within its own limits.
    err = call("fk", write(PENDANT), "--q", "0,100,-60,0,0,0").err
    assert err == "robokin: the motion of joint J3 = -160 deg is outside its limits -90 .. 90\n"
    assert call("fk", write(PENDANT), "--q", "0,150,100,0,0,0").err == (
        "robokin: joint 2 (J2) = 150 deg is outside its limits -60 .. 140\n"
    )
    # What one joint alone moves bounds that joint: 60 deg of the follower are 90 of its leader.
    assert call("fk", write(FINGER), "--q", "0,0,99").err == (
        "robokin: joint 3 (pip) = 99 deg is outside its limits 0 .. 90\n"
    )


def test_limits_that_are_shown_are_those_that_are_left(call, write):
    finger = call("show", write(FINGER), "--json").json
    assert [row["limits"] for row in finger["rows"][2:]] == [[0.0, 90.0], [0.0, 60.0]]
    pendant = call("show", write(PENDANT), "--json").json
    assert pendant["rows"][2]["motion_limits"] == [-90.0, 90.0]
    assert "J3 itself -90 .. 90" in call("show", write(PENDANT)).text
    assert "spindle 20 mm a turn" in call("show", write(SCREW)).text


def test_what_is_typed_can_be_held(call, write):
    path = write(PENDANT)
    pose = call("fk", path, "--q", "bent", "--json").json["pose"]
    position, rpy = (",".join(map(repr, pose[key])) for key in ("position", "rpy"))
    held = call("ik", path, f"--xyz={position}", f"--rpy={rpy}", "--hold", "J2=20", "--json").json
    assert held["complete"] and all(one["q"][1] == 20.0 for one in held["solutions"])
    assert known_fault(document_schema("ik"), held) is None
    assert {one["branch"] for one in held["solutions"]} <= {
        one["branch"] for one in call("ik", path, f"--xyz={position}", f"--rpy={rpy}", "--json").json["solutions"]
    }
    assert call("ik", path, f"--xyz={position}", f"--rpy={rpy}", "--hold", "J3=30", "--json").json["complete"] is False
    refused(
        call("ik", path, f"--xyz={position}", "--hold", "J2=140", "--hold", "J3=-120"),
        "with q2 and q3 held so, joints that hang on them have no value within their limits",
    )


def test_a_line_of_a_finger(call, write):
    path = write(FINGER)
    words = ("path", path, "--from", "0,0,0", "--to", "5,20,30", "--line", "--steps", "8")
    answer = call(*words, "--json")
    assert answer.status == 0 and answer.json["complete"]
    assert known_fault(document_schema("path"), answer.json) is None
    assert answer.json["path"][-1]["q"] == pytest.approx([5, 20, 30], abs=1e-5)
    positions = np.array([row["position"] for row in answer.json["path"]])
    along = positions - positions[0]
    assert np.linalg.norm(np.cross(along, along[-1]), axis=1) == pytest.approx(np.zeros(9), abs=1e-6)
    over = call("path", path, "--from", "0,0,0", "--to", "5,20,95", "--line", "--steps", "8", "--json")
    assert (over.status, over.json["events"][-1]["kind"]) == (3, "limit")


def test_matrices_in_symbols_of_what_is_typed(call, write):
    text = call("fk", write(FINGER), "--symbolic").text
    assert "theta4 = 0.6666666666666666*q3\n" in text
    assert "c1*(a2*c2 + a3*c23 + a4*c234)" in text
    document = call("fk", write(PENDANT), "--symbolic", "--json").json
    assert known_fault(document_schema("fk"), document) is None
    assert document["T"][2][3] == "a2*c2 + c3*(a3 - c4*s5*d6) - s3*(c5*d6 + d4) + d1"  # θ2 + θ3 = q3, as typed
    assert "d3 = 0.05555555555555555*q3" in call("fk", write(SCREW), "--symbolic", "--python").text


def test_a_leader_beside_the_chain_moves_what_is_drawn(call, write):
    arm = """robokin: 1
name: Two
units: {length: mm, angle: deg}
branches:
  left: {joints: [{name: a, type: R, d: 0, a: 50, alpha: 0, limits: [-10, 90]}]}
  right: {joints: [{name: b, type: R, d: 0, a: 40, alpha: 0}, {name: c, type: R, d: 0, a: 30, alpha: 0}]}
couplings: [{joint: right.c, follows: left.a, ratio: 2}]
"""
    path = write(arm)
    assert "\ntool  30  40  0  mm" in call("plot", path, "--tip", "right", "--q", "90,-45").text
    page = json.loads(call("plot", path, "--tip", "right", "--json").text)
    assert [len(arm["joints"]) for arm in page["arms"]] == [2]
    assert "beside     q2 is left.a, -10 .. 90\n" in call("show", path, "--tip", "right").text
    record = call("show", path, "--tip", "right", "--json").json
    assert record["beside"] == [{"variable": "q2", "joint": "left.a", "type": "revolute", "limits": [-10.0, 90.0]}]
    assert known_fault(document_schema("show"), record) is None


def test_a_single_joint_takes_a_negative_value(call, write):
    path = write("robokin: 1\nname: One\nunits: {length: mm, angle: deg}\njoints: [{type: R, a: 100}]\n")
    assert call("fk", path, "--q", "-90", "--json").json["pose"]["position"] == pytest.approx([0, -100, 0])
    refused(call("fk", path, "--q", "-home"), "unknown name 'home'")


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("ratio: 2/3", "ratio: 0.5"), "joint 4: what it hangs on: 0.5 of joint 3, expected 0.666667 of joint 3"),
        (("follows: pip", "adds: pip"), "joint 4: what it hangs on: 0.666667 of joint 3 + itself, expected"),
        (("a: 27", "a: 28"), "row 3: a 28 mm, expected 27 mm"),
    ],
)
def test_tables_are_marked_by_what_hangs_on_what_too(call, write, tmp_path, change, said):
    right = write(FINGER)
    given = tmp_path / "given.yaml"
    assert change[0] in FINGER
    given.write_text(FINGER.replace(*change))
    assert call("check", "dh", right, "--against", right).status == 0
    answer = call("check", "dh", given, "--against", right, "--json")
    (item,) = answer.json["items"]
    assert (answer.status, item["status"]) == (3, "different")
    assert said in item["detail"]


@pytest.mark.parametrize(
    ("command", "said"),
    [
        (("ik", "--xyz", "60,0,-20", "--hold", "dip=3"), "joint 'dip' follows others, expected one of q1 to q3"),
        (("ik", "--xyz", "60,0,-20", "--explain"), "joint dip hangs on pip"),
    ],
)
def test_what_needs_joints_one_by_one_says_which_does_not(call, write, command, said):
    path = write(FINGER)
    refused(call(command[0], path, *command[1:]), said)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (FINGER.replace("follows: pip", "follows: dip"), "the couplings go round in a circle"),
        (FINGER.replace("follows: pip", "follows: pipp"), "found the unknown joint 'pipp'; did you mean 'pip'"),
        (FINGER.replace("[0, 60]", "[200, 260]"), "no value of joint pip is within the limits of all joints"),
        (SCREW.replace("pitch: 20, ", ""), "found no 'pitch' of row 3"),
        (SCREW.replace("pitch: 20", "pitch: 0"), "found the pitch 0 of row 3"),
        (SCREW.replace("helical", "R"), "found 'pitch' of row 3, expected it on a helical row alone"),
        (
            PENDANT.replace("bent: [10, 20, 30, 40, 50, 60]", "bent: [10, 20]"),
            "found 2 values in the pose bent, expected 6",
        ),
        (FINGER + "poses: {fist: [0, 0, 0, 0]}\n", "found 4 values in the pose fist, expected 3"),
    ],
)
def test_mistakes_are_said_with_their_place(call, write, text, said):
    result = call("validate", write(text))
    assert result.status in (2, 3)
    assert said in result.text + result.err
