"""`robokin check`: marks, scores, files of a class, autograders, and whatever a student may write."""

from __future__ import annotations

import csv
import io
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from library_entries import names_of
from sweeps import sweep

import robokin
from robokin.model import Robot

from .conftest import refused

DOCS = Path(__file__).parent.parent.parent / "docs"
PUMA = ["check", "fk", "puma560", "--q", "home"]
RIGHT = "-149.09,921.12,20.32"
ROBOTS = names_of(Robot, 1)
PLANAR = ["check", "ik", "planar3r-brac", "--xy", "26.4743,50.8716", "--phi", "85"]


def written(columns, rows):
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([columns, *rows])
    return text.getvalue().encode()


# fk --------------------------------------------------------------------------------------------------------


def test_the_document(call):
    answer = call(*PUMA, "--expect", f"{RIGHT},0,90,91", "--json")
    assert (answer.status, answer.err) == (3, "")
    document = answer.json
    keys = ["schema", "robot", "id", "units", "check", "tolerance", "passed", "total", "score", "undecided", "items"]
    assert list(document) == keys
    assert document["tolerance"] == {"position": 0.5, "angle": 0.1}
    assert (document["passed"], document["total"], document["score"]) == (0, 1, 0.5)
    (item,) = document["items"]
    assert list(item)[:6] == ["id", "status", "score", "expected", "got", "error"]
    assert item["status"] == "wrong orientation"
    assert item["error"]["angle"] == pytest.approx(1.0)
    assert item["got"]["rpy"] == pytest.approx([0, 90, 91])


@pytest.mark.parametrize(
    "answer",
    [
        RIGHT,
        "-149.09 921.12 20.32",
        f"{RIGHT},0,90,90",
        f"{RIGHT},180,90,270",
        f"{RIGHT},.5,-.5,.5,.5",
        f"{RIGHT},-.5,.5,-.5,-.5",
        "[[0,-1,0,-149.09],[0,0,1,921.12],[-1,0,0,20.32],[0,0,0,1]]",
        "[[0,-1,0,-149.09],[0,0,1,921.12],[-1,0,0,20.32]]",
        "0,-1,0,-149.09,0,0,1,921.12,-1,0,0,20.32,0,0,0,1",
        "Trans(-149.09,921.12,20.32) RPY(0,90,90)",
        "trans(-149.09,921.12,20.32) Rot(z,90) Rot(y,450)",
        "-149.09, 431.8+433.07+56.25, 20.32",
    ],
)
def test_every_way_to_say_the_right_pose(call, answer):
    assert call(*PUMA, "--expect", answer).status == 0


@pytest.mark.parametrize(
    ("answer", "status"),
    [
        ("-149.09,921.12,21", "wrong position"),
        (f"{RIGHT},0,90,90.2", "wrong orientation"),
        ("149.09,921.12,20.32,0,0,90", "wrong pose"),
        ("[[0,-2,0,-149.09],[0,0,2,921.12],[-2,0,0,20.32],[0,0,0,1]]", "wrong orientation"),
        ("[[0,1,0,-149.09],[0,0,1,921.12],[-1,0,0,20.32],[0,0,0,1]]", "wrong orientation"),
        ("[[0,-1,0,-149.09],[0,0,1,921.12],[-1,0,0,20.32],[0,0,0,2]]", "not a pose"),
        (f"{RIGHT},1,1,1,1", "not a rotation"),
        ("nan,921.12,20.32", "not a number"),
        ("-149.09,inf,20.32", "not a number"),
        ("-149.09,,20.32", "blank"),
        ("[[nan,-1,0,-149.09],[0,0,1,921.12],[-1,0,0,20.32],[0,0,0,1]]", "not a number"),
        ("", "blank"),
        ("  ", "blank"),
    ],
)
def test_wrong_answers_are_answers(call, answer, status):
    answer = call(*PUMA, "--expect", answer, "--json")
    assert answer.status == 3
    assert answer.json["items"][0]["status"] == status
    assert answer.json["score"] < 1


def test_units_and_tolerances(call):
    assert call(*PUMA, "--expect", RIGHT, "--tol", "0").status == 0
    assert call(*PUMA, "--expect", "-149.09,921.12,20.42", "--tol", "0.1").status == 0
    assert call(*PUMA, "--expect", "-149.09,921.12,20.42", "--tol", "0.0999").status == 3
    assert call(*PUMA, "--expect", "-149.09,921.12,20.42", "--atol", "0", "--rtol", "1e-3").status == 0
    question = ["check", "fk", "puma560", "--q", "pi/2,0,pi/2,0,0,0", "--length", "m", "--angle", "rad", "--json"]
    document = call(*question, "--expect", "-.14909,.92112,.02032,0,pi/2,pi/2").json
    assert document["passed"] == 1
    assert document["tolerance"] == {"position": 0.0005, "angle": pytest.approx(np.radians(0.1))}


def test_several_questions(call):
    answer = call(*PUMA, "--expect", RIGHT, "--q", "0,0,0,0,0,0", "--expect", "0,0,0", "-f", "jsonl")
    assert answer.status == 3
    assert [line["status"] for line in answer.jsonl] == ["pass", "wrong position"]
    assert [line["robot"] for line in answer.jsonl] == ["puma560"] * 2


@pytest.mark.parametrize("kind", sweep(["rpy", "quaternion", "euler", "matrix"], 4))
def test_fk_output_is_a_right_answer_and_a_shifted_one_is_wrong(call, kind, rng):
    for name in ROBOTS[:: len(ROBOTS) // 12]:
        robot = robokin.load(name)
        q = rng.uniform(-1, 1, (6, robot.n)) * 100
        rows = "".join(",".join(map(repr, row)) + "\n" for row in q.tolist()).encode()
        poses = call("fk", name, "--q", "-", "-f", "csv", "--as", kind, stdin=rows)
        answer = call("check", "fk", name, "-i", "-", "--json", stdin=poses.out)
        assert (answer.status, answer.json["passed"]) == (0, 6)
        allowed = answer.json["tolerance"]["position"]
        column = poses.columns.index("m24" if kind == "matrix" else "y")
        for factor, passed in ((0.99, 6), (-1.01, 0)):
            shifted = poses.numbers
            shifted[:, column] += factor * allowed
            answer = call("check", "fk", name, "-i", "-", "--json", stdin=written(poses.columns, shifted.tolist()))
            assert answer.json["passed"] == passed, name
            assert answer.status == (0 if passed else 3)


# ik --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("answers", "status", "score"),
    [
        (["30,45,10"], "pass", 1.0),
        (["390,45,-350"], "pass", 1.0),
        (["85.92,-45,44.08", "30,45,10"], "pass", 1.0),
        (["30,45,10", "390,45,10"], "missing solution", 1 / 3),
        (["30,45,10", "85.92,-45,44.08", "30,45,370"], "duplicate", 2 / 3),
        (["30,45,10", "85.92,-45,44.08", "0,0,0"], "extra", 2 / 3),
        (["30,45,10", "85,-45,44"], "missing and extra", 1 / 3),
        (["31,45,9"], "wrong position", 0.5),
        (["30,45,11"], "wrong pose", 0.0),
        (["30,nan,10"], "not a number", 0.0),
        ([""], "blank", 0.0),
        (["30,,10"], "blank", 0.0),
        (["none"], "solution exists", 0.0),
    ],
)
def test_joint_values(call, answers, status, score):
    answer = call(*PLANAR, *(part for text in answers for part in ("--q", text)), "--json")
    (item,) = answer.json["items"]
    assert (item["status"], item["score"]) == (status, pytest.approx(score))
    assert answer.status == (0 if status == "pass" else 3)


def test_all_and_any(call):
    assert call(*PLANAR, "--q", "30,45,10", "--all", "--json").json["items"][0]["status"] == "missing solution"
    answer = call(*PLANAR, "--q", "30,45,10", "--q", "30,45,10", "--any", "--json")
    assert [item["status"] for item in answer.json["items"]] == ["pass", "pass"]


def test_limits(call):
    target = ["check", "ik", "puma560", "--pose", "Trans(149.09,-921.12,20.32) RPY(0,90,-90)"]
    outside = call(*target, "--q=170,180,0,0,0,0", "--xyz", "0,0,0")
    assert outside.status == 2
    pose = call("fk", "puma560", "--q", "170,0,0,0,0,0", "--json").json["pose"]["matrix"]
    target = ["check", "ik", "puma560", "--matrix", json.dumps(pose), "--q", "170,0,0,0,0,0"]
    answer = call(*target, "--json")
    assert answer.json["items"][0]["status"] == "outside limits"
    assert answer.json["items"][0]["detail"] == "q1 170, expected -160 to 160"
    assert call(*target, "--no-limits").status == 0


def test_no_solution_is_an_answer(call):
    assert call("check", "ik", "planar2r", "--xy", "5,0", "--q", "none").status == 0
    assert call("check", "ik", "planar2r", "--xy", "1,0", "--q", "none").status == 3
    assert call("check", "ik", "planar2r", "--xy", "5,0", "--q", "none", "--q", "0,0").status == 3


@pytest.fixture
def keyed(tmp_path):
    def keyed(key, answers):
        (tmp_path / "key.csv").write_text(key)
        (tmp_path / "answers.csv").write_text(answers)
        return ["-i", str(tmp_path / "answers.csv"), "--key", str(tmp_path / "key.csv")]

    return keyed


def test_what_ik_writes_is_all_right(call, keyed):
    rows = ["500,100,300,180,0,45", "5000,0,0,0,0,0", "400,-200,350,170,10,20"]
    targets = "x,y,z,roll,pitch,yaw\n" + "\n".join(rows) + "\n"
    found = call("ik", "puma560", "-i", "-", "-f", "csv", stdin=targets.encode())
    key = "id,x,y,z,roll,pitch,yaw\n" + "".join(f"{i},{row}\n" for i, row in enumerate(rows, start=1))
    answer = call("check", "ik", "puma560", *keyed(key, found.text), "--all", "--json")
    assert [item["status"] for item in answer.json["items"]] == ["pass"] * 3
    without_one = "\n".join(line for line in found.lines if not line.startswith("1,2,"))
    answer = call("check", "ik", "puma560", *keyed(key, without_one), "--all", "--json")
    assert [item["status"] for item in answer.json["items"]] == ["missing solution", "pass", "pass"]


def test_lines_of_one_target_are_a_set(call):
    rows = [[1, 10, 40, 60, 8.504, 109.004, -57.508], [2, 10, 40, 60, 8.504, 109.004, -57.508],
            [1, 10, 40, 60, 153.367, -109.004, 15.638]]  # fmt: skip
    columns = ["id", "x", "y", "phi", "q1", "q2", "q3"]
    answer = call("check", "ik", "planar3r-brac", "-i", "-", "--json", stdin=written(columns, rows))
    assert [(item["id"], item["status"]) for item in answer.json["items"]] == [("1", "pass"), ("2", "pass")]
    answer = call("check", "ik", "planar3r-brac", "-i", "-", "--json", "--all", stdin=written(columns, rows))
    assert [item["status"] for item in answer.json["items"]] == ["pass", "missing solution"]


# Files -----------------------------------------------------------------------------------------------------

BAD_LINES = {
    "0,0,0,0.9,0,nan": "not a number",
    "0,0,0,0.9,0,-inf": "not a number",
    "0,0,0,0.9,0,": "blank",
    "0,0,0,,,": "blank",
    "0,0,0,0.9,0": "bad line",
    "0,0,0,0.9,0,0,0": "bad line",
    '0,0,0,"0.9"9,0,0': "bad line",
    "0,0,0,0.9,0,1e999": "not a number",
    "0,0,0,0.9,0,two": "not a number",
    "0,0,0,0.9,0,9**9**9": "not a number",
    "0,0,0,0.9,0,__import__('os')": "not a number",
    "0,x,0,0.9,0,0": "not a number",
    "0,0,0,1e300,0,0": "not a number",
    "1e300,0,0,0.9,0,0": "not a number",
    "0,0,0,1e9,0,0": "wrong position",
}


@pytest.mark.parametrize(("line", "status"), sweep(BAD_LINES.items(), 3))
def test_a_bad_line_is_a_wrong_answer(call, line, status):
    text = f"# answers\n\nq1,q2,q3,x,y,z\n0,0,0,0.9,0,0\n{line}\n0,0,0,0.9,0,0\n"
    answer = call("check", "fk", "anthropomorphic", "-i", "-", "--json", stdin=text.encode())
    assert answer.status == 3
    assert [item["status"] for item in answer.json["items"]] == ["pass", status, "pass"]
    assert answer.json["items"][1]["line"] == 5
    if status not in ("wrong position",):
        assert "line 5: " in answer.json["items"][1]["detail"]
    for kind in ("table", "csv", "jsonl"):
        assert call("check", "fk", "anthropomorphic", "-i", "-", "-f", kind, stdin=text.encode()).status == 3


BAD_FILES = {
    "nothing": ("", "found nothing"),
    "a header alone": ("q1,q2,q3,x,y,z\n", "header alone"),
    "no header": ("0,0,0,0.9,0,0\n", "expected a header"),
    "commas and semicolons": ("q1,q2,q3;x;y;z\n0;0;0;1;1;1\n", "expected q1"),
    "an open quote in the header": ('q1,q2,q3,x,y,"z\n0,0,0,0.9,0,0\n', "line 1: found a quote that is not closed"),
    "no pose": ("q1,q2,q3\n0,0,0\n", "no columns of a pose"),
    "half a pose": ("q1,q2,q3,x,y,z,roll\n0,0,0,1,1,1,1\n", "column roll without the others"),
    "no joints": ("id,x,y,z\n1,1,1,1\n", "expected q1"),
    "a column twice": ("q1,q2,q3,x,x,z\n0,0,0,1,1,1\n", "'x' twice"),
    "no text": ("q\x001\0\n\0", "no columns of a pose"),
}


@pytest.mark.parametrize(("text", "said"), BAD_FILES.values(), ids=BAD_FILES)
def test_a_file_that_is_none_is_refused(call, text, said):
    stdin = text.encode(errors="surrogateescape")
    refused(call("check", "fk", "anthropomorphic", "-i", "-", stdin=stdin), said)


CLASS = "student,id,x,y,z,remark\n"
TWO = "id,q1,q2,q3\na,0,0,0\nb,0,90,0\n"


@pytest.mark.parametrize("inside", ["\n", "\r\n", "\r", "\u2028", "\x0c", "\x0b", "\x1c", "\x85"], ids=ascii)
def test_what_stands_in_quotes_is_no_row(call, keyed, inside):
    """RFC 4180, 2.6: a quoted cell may hold the ends of lines."""
    answers = f'{CLASS}s1,a,0.9,0,0,"ok{inside}s2,b,9,9,9,x"\ns2,b,0,0,0.9,\ns3,a,.9,0,0,"say ""hi"", {inside}"\n'
    items = call("check", "fk", "anthropomorphic", *keyed(TWO, answers), "--json").json["items"]
    assert [(item["student"], item["id"], item["status"]) for item in items] == [
        ("s1", "a", "pass"), ("s1", "b", "missing"), ("s2", "a", "missing"), ("s2", "b", "pass"),
        ("s3", "a", "pass"), ("s3", "b", "missing"),
    ]  # fmt: skip


def marks(answer):
    """Student, question and status of each mark."""
    return [(item["student"], item["id"], item["status"]) for item in answer.json["items"]]


def test_quotes_that_do_not_end_cost_their_own_line(call, keyed):
    swallowed = f'{CLASS}s1,a,"0.9,0,0,\ns2,b,0,0,0.9,"x"\ns3,a,0.9,0,0,\n'
    answer = call("check", "fk", "anthropomorphic", *keyed(TWO, swallowed), "--json")
    assert marks(answer) == [
        ("s1", "a", "bad line"), ("s1", "b", "missing"), ("s2", "a", "missing"), ("s2", "b", "pass"),
        ("s3", "a", "pass"), ("s3", "b", "missing"),
    ]  # fmt: skip
    # What may be made up inside of quotes stands against no row that is sure.
    planted = f'{CLASS}s2,b,0,0,0.9,x\ns1,a,0.9,0,0,"x\ns2,b,9,9,9,x",too many\n'
    answer = call("check", "fk", "anthropomorphic", *keyed(TWO, planted), "--json")
    assert ("s2", "b", "pass") in marks(answer)
    assert ("s1", "a", "bad line") in marks(answer)


def test_a_null_byte_costs_its_own_line(call, keyed):
    text = f"{CLASS}s1,a,0.9,0\0,0,\ns2,a,0.9,0,0,\n"
    answer = call("check", "fk", "anthropomorphic", *keyed("id,q1,q2,q3\na,0,0,0\n", text), "--json")
    assert marks(answer) == [("s1", "a", "not a number"), ("s2", "a", "pass")]


def test_latin_1_is_read_and_said(call, tmp_path):
    path = tmp_path / "class.csv"
    path.write_bytes("student,id,q1,q2,q3,x,y,z\nGrün,a,0,0,0,0.9,0,0\nUwe,b,0,0,0,0.9,0,0\n".encode("cp1252"))
    answer = call("check", "fk", "anthropomorphic", "-i", path, "--json")
    assert [item["student"] for item in answer.json["items"]] == ["Grün", "Uwe"]
    assert "line 2: not UTF-8, read as Latin-1" in answer.err
    path.write_bytes("student,id,q1,q2,q3,x,y,z\nGrün,a,0,0,0,0.9,0,0\n".encode() + b"Gr\xfcn,b,0,0,0,0.9,0,0\n")
    answer = call("check", "fk", "anthropomorphic", "-i", path, "--json")
    assert [item["student"] for item in answer.json["items"]] == ["Grün", "Grün"]


@pytest.mark.parametrize("separator", [";", "\t"])
def test_decimal_commas_of_answers(call, separator):
    rows = ["id q1 q2 q3 x y z", "a 0 0 0 0,9 0 0", "b 0 0 0 0.9 0 0", "c 0 0 0 9e-1 0 0", "d 0 0 0 1,234 0 0"]
    text = "\n".join(rows).replace(" ", separator)
    items = call("check", "fk", "anthropomorphic", "-i", "-", "--json", stdin=text.encode()).json["items"]
    # With points elsewhere in the file 1,234 may be a thousand.
    assert [item["status"] for item in items] == ["pass", "pass", "pass", "not a number"]


def test_a_key_asks_the_questions(call, keyed):
    key = "id,q1,q2,q3\na,0,0,0\nb,0,90,0\n"
    answers = "student,id,x,y,z\nAda,b,0,0,.9\nAda,a,.9,0,0\nBen,a,.9,0,0\nBen,a,1,0,0\nBen,c,0,0,0\n"
    answer = call("check", "fk", "anthropomorphic", *keyed(key, answers), "--json")
    assert [(i["student"], i["id"], i["status"]) for i in answer.json["items"]] == [
        ("Ada", "a", "pass"), ("Ada", "b", "pass"), ("Ben", "a", "several answers"), ("Ben", "b", "missing"),
    ]  # fmt: skip
    assert [(mark["student"], mark["score"]) for mark in answer.json["students"]] == [("Ada", 1.0), ("Ben", 0.0)]
    assert "line 6: there is no question 'c' in the key" in answer.err
    refused(
        call("check", "fk", "anthropomorphic", *keyed(key + "a,1,1,1\n", answers)), "line 4: found the id 'a' twice"
    )
    refused(call("check", "fk", "anthropomorphic", *keyed("id,q1,q2,q3\na,0,x,0\n", answers)), "line 2: ", "'x'")


# dh --------------------------------------------------------------------------------------------------------


def test_tables(call, tmp_path):
    arm = (DOCS.parent / "robots" / "arms" / "anthropomorphic.yaml").read_text()
    slips = {
        "right.yaml": (arm, "pass"),
        "length.yaml": (arm.replace("a3: 0.4 ", "a3: 0.41"), "different"),
        "type.yaml": (arm.replace("- {type: revolute, d: 0, a: 0,", "- {type: prismatic, a: 0,"), "other joints"),
        "slip.yaml": (arm.replace("revolute", "revolt", 1), "unreadable"),
        "bars.yaml": ((DOCS.parent / "robots" / "mechanisms" / "four-bar.yaml").read_text(), "no robot"),
    }
    for name, (text, _) in slips.items():
        (tmp_path / name).write_text(text)
    files = [str(tmp_path / name) for name in slips]
    answer = call("check", "dh", *files, "--against", "anthropomorphic", "--json")
    assert answer.status == 3
    assert [item["status"] for item in answer.json["items"]] == [status for _, status in slips.values()]
    assert answer.json["items"][1]["differences"] == [
        {"joint": None, "what": "position of the tool", "found": pytest.approx(0.01), "expected": None}
    ]
    assert call("check", "dh", files[1], "--against", "anthropomorphic", "--up-to", "tool").status == 0
    assert call("check", "dh", files[1], "--against", "anthropomorphic", "--tol", "0.01").status == 0
    refused(call("check", "dh", files[3], "--against", "anthropomorphic"), "slip.yaml", "'revolt'")
    refused(call("check", "dh", files[4], "--against", "anthropomorphic"), "is no robot")


def test_the_puma_s_frames_are_one_robot(call):
    """J. Craig's PUMA 560 has its zeros, base and tool elsewhere than R. Paul's kind of frames."""
    arguments = ["check", "dh", "puma560-craig", "--against", "puma560"]
    item = call(*arguments, "--json").json["items"][0]
    assert item["status"] == "different"
    assert call(*arguments, "--up-to", ",".join(item["needs"])).status == 0
    ur = call("check", "dh", "ur5", "--against", "puma560", "--up-to", "all", "--json").json["items"][0]
    assert ur["detail"].startswith("joint 3: distance between axes 2 and 3: 425 mm, expected 431.8 mm")
    assert ur["needs"] is None


# jacobian and dof ------------------------------------------------------------------------------------------


def test_jacobians(call, rng):
    for name in ("puma560", "scara", "planar2r", "stanford"):
        robot = robokin.load(name)
        q = rng.uniform(-1, 1, robot.n)
        for frame in ("base", "tool"):
            J = robokin.jacobian(robot, q, frame)
            J[:3, robot.revolute] /= robot.units.metres
            factors = np.where(robot.revolute, robot.units.radians, robot.units.metres)
            asked = ["check", "jacobian", name, "--q", ",".join(map(repr, (q / factors).tolist())), "--frame", frame]
            assert call(*asked, "--expect", json.dumps(J.tolist())).status == 0
            J[4, 0] += 0.002
            wrong = call(*asked, "--expect", json.dumps(J.tolist()), "--json")
            assert (wrong.status, wrong.json["score"]) == (3, pytest.approx(1 - 1 / robot.n))
    swapped = "[[0,0],[0,0],[1,1],[-0.6,-0.6],[1,0],[0,0]]"
    answer = call("check", "jacobian", "planar2r", "--q", "0,90", "--expect", swapped, "--json")
    assert "angular rows stand first" in answer.json["items"][0]["detail"]
    tool = "[[0,0],[1.6,0.6],[0,0],[0,0],[0,0],[1,1]]"
    answer = call("check", "jacobian", "planar2r", "--q", "30,0", "--expect", tool, "--json")
    assert "the Jacobian in the tool frame" in answer.json["items"][0]["detail"]


def test_counts(call):
    assert call("check", "dof", "sarrus", "--expect", "0", "--mobility", "1").status == 0
    answer = call("check", "dof", "sarrus", "--expect", "1", "--mobility", "1", "--json")
    assert [item["status"] for item in answer.json["items"]] == ["wrong", "pass"]
    assert call("check", "dof", "--links", "7", "--joints", "6R", "--space", "spatial", "--expect", "6").status == 0
    assert call("check", "dof", "puma560", "--expect", "").status == 3


# Autograders and slips -------------------------------------------------------------------------------------


def test_results_for_an_autograder(call, tmp_path):
    """The keys of Gradescope's Autograder specifications, Output format."""
    path = tmp_path / "results.json"
    answer = call(*PUMA, "--expect", RIGHT, "--q", "home", "--expect", f"{RIGHT},0,0,0", "--gradescope", path,
                  "--points", "10", "--visibility", "after_due_date")  # fmt: skip
    assert answer.status == 3
    results = json.loads(path.read_text())
    assert results["score"] == 7.5
    assert [test["score"] for test in results["tests"]] == [5.0, 2.5]
    assert {test["max_score"] for test in results["tests"]} == {5.0}
    assert [test["status"] for test in results["tests"]] == ["passed", "failed"]
    assert {test["visibility"] for test in results["tests"]} == {"after_due_date"}
    slip = tmp_path / "arm.yaml"
    slip.write_text("robokin: 1\njoints: [")
    assert call("check", "dh", slip, "--against", "puma560", "--gradescope", path).status == 3
    assert json.loads(path.read_text())["score"] == 0.0
    text = b"student,q1,q2,q3,x,y,z\nA,0,0,0,1,0,0\nB,0,0,0,1,0,0\n"
    refused(call("check", "fk", "anthropomorphic", "-i", "-", "--gradescope", path, stdin=text), "2 students")


SLIPS = {
    "no kind": (["check"], ["KIND is missing", "fk, ik, dh, jacobian, dof, new, sheet or statistics"]),
    "a kind that is none": (["check", "fkk"], ["no check 'fkk'", "did you mean 'fk'"]),
    "a robot for a kind": (["check", "puma560"], ["no check 'puma560'", "expected fk"]),
    "no answer": (PUMA, ["--expect is missing"]),
    "no question": (["check", "fk", "puma560", "--expect", RIGHT], ["--q is missing"]),
    "two questions, one answer": ([*PUMA, "--q", "home", "--expect", RIGHT], ["2 --q and 1 --expect"]),
    "two values": ([*PUMA, "--expect", "1,2"], ["found 2 values", "X,Y,Z"]),
    "a word": ([*PUMA, "--expect", "1,2,abc"], ["value 3 of 3", "abc"]),
    "an expression": ([*PUMA, "--expect", "Trans(1,2)"], ["--expect", "Trans(x, y, z)"]),
    "a matrix of 3×3": ([*PUMA, "--expect", "[[1,0,0],[0,1,0],[0,0,1]]"], ["3×3", "4×4"]),
    "a ragged matrix": ([*PUMA, "--expect", "[[1,0,0],[0,1]]"], ["expected a matrix"]),
    "a negative tolerance": ([*PUMA, "--expect", RIGHT, "--tol=-1"], ["--tol", "0 or more"]),
    "a tolerance that is none": ([*PUMA, "--expect", RIGHT, "--rtol", "x"], ["--rtol", "0 or more"]),
    "two sources": ([*PUMA, "--input", "x.csv"], ["exclude each other"]),
    "a key alone": ([*PUMA, "--expect", RIGHT, "--key", "x"], ["--key goes with --input"]),
    "points alone": ([*PUMA, "--expect", RIGHT, "--points", "3"], ["--points", "--gradescope"]),
    "no target": (["check", "ik", "puma560", "--q", "home"], ["no target"]),
    "no joint values": ([*PLANAR], ["--q is missing"]),
    "too few joint values": ([*PLANAR, "--q", "1,2"], ["found 2 values", "expected 3"]),
    "all and any": ([*PLANAR, "--q", "1,2,3", "--all", "--any"], ["exclude each other"]),
    "no other table": (["check", "dh", "puma560"], ["--against is missing"]),
    "no table": (["check", "dh", "--against", "puma560"], ["FILE... is missing"]),
    "a part that is none": (["check", "dh", "ur5", "--against", "ur5", "--up-to", "zeros"], ["'zeros'", "mean 'zero'"]),
    "against a mechanism": (["check", "dh", "ur5", "--against", "four-bar"], ["is a mechanism"]),
    "a short Jacobian": (["check", "jacobian", "planar2r", "--q", "0,0", "--expect", "[[1,2]]"], ["1×2", "6×2"]),
    "a count of words": (["check", "dof", "four-bar", "--expect", "one"], ["'one'", "whole number"]),
    "no count": (["check", "dof", "four-bar"], ["--expect is missing"]),
    "nothing to count": (["check", "dof", "--expect", "1"], ["NAME is missing"]),
    "an unknown option": ([*PUMA, "--expct", "1"], ["'--expct'", "'--expect'"]),
}


@pytest.mark.parametrize(("arguments", "fragments"), SLIPS.values(), ids=SLIPS.keys())
def test_slips_end_in_a_sentence(call, arguments, fragments):
    refused(call(*arguments), *fragments)


def test_output_to_a_file(call, tmp_path):
    path = tmp_path / "marks.csv"
    assert call(*PUMA, "--expect", RIGHT, "-o", path).out == b""
    assert path.read_text().startswith("id,status,score,position_error,detail\n1,pass,1.0,")


@pytest.mark.parametrize("kind", ["fk", "ik", "dh", "jacobian", "dof"])
def test_the_help_of_a_kind(call, kind):
    answer = call("check", kind, "--help")
    assert (answer.status, answer.err) == (0, "")
    assert max(map(len, answer.lines)) <= 80
    assert "Examples:" in answer.lines


# Documentation ---------------------------------------------------------------------------------------------


def shell(command, cwd):
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    environment = {**os.environ, "PATH": path, "COLUMNS": "80"}
    done = subprocess.run(
        ["sh", "-c", command], cwd=cwd, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    return done.returncode, done.stdout.rstrip()


def test_the_autograder_s_line_runs(tmp_path):
    text = (DOCS / "grading.md").read_text()
    (script,) = re.findall(r"^```sh\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    for name in ("submission", "results"):
        (tmp_path / name).mkdir()
    shutil.copy(DOCS / "grading" / "tables" / "ben.yaml", tmp_path / "submission" / "arm.yaml")
    status, printed = shell(script.replace("/autograder", str(tmp_path)), tmp_path)
    assert status == 0, printed
    assert json.loads((tmp_path / "results" / "results.json").read_text())["score"] == 5.0


PLANAR_2R = [
    # Two links of 1 m and 0.6 m at (0°, 90°): the tool at (1, 0.6), so J = [[-0.6, -0.6], [1, 0]] and wz = (1, 1).
    ("[[-0.6,-0.6],[1,0],[1,1]]", 0, 1.0),
    ("[[-0.6,-0.6],[1,0]]", 0, 1.0),
    ("[[-0.6,-0.6],[1,0],[0,0],[0,0],[0,0],[1,1]]", 0, 1.0),
    ("[[-0.6,-0.6],[1,0],[1,2]]", 3, 0.5),
    ("[[-0.6,-0.6],[1,1]]", 3, 0.5),
    ("[[-0.6,-0.6],[1,0],[0,0],[1,1]]", 2, None),
]


@pytest.mark.parametrize(("answer", "status", "score"), PLANAR_2R)
def test_a_planar_jacobian_may_have_its_own_rows(call, answer, status, score):
    given = call("check", "jacobian", "planar2r", "--q", "0,90", "--expect", answer, "--json")
    assert given.status == status
    if score is not None:
        assert given.json["items"][0]["score"] == score


def test_a_spatial_jacobian_has_six_rows(call):
    assert call("check", "jacobian", "scara", "--q", "0,0,0,0", "--expect", "[[1,2,3,4],[1,2,3,4]]").status == 2
