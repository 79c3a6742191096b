"""Marking what nobody can be trusted with: no file and no line costs another student's mark, and none earns one."""

from __future__ import annotations

import json
import os
import socket

import pytest
from sweeps import sweep

import robokin
from robokin.formats import library
from robokin.formats.library import load_any

from .conftest import refused

ARM = "anthropomorphic"
AGAINST = ["--against", ARM]
KEY = "id,x,y,phi\n1,10,40,60\n2,90,0,0\n"
RIGHT, OTHER = "8.504,109.004,-57.508", "153.367,-109.004,15.638"
IK = ["check", "ik", "planar3r-brac"]


def table(name=ARM):
    """The text of a description of the library."""
    (path,) = library.library_folder().rglob(f"{name}.yaml")
    return path.read_text()


MODIFIED = """\
robokin: 1
name: h
units: {length: m, angle: deg}
convention: modified
joints:
  - {type: revolute, a: LENGTH, alpha: 0}
  - {type: revolute, a: 0, alpha: 90}
  - {type: revolute, a: 0.5, alpha: 0}
tool: Trans(0.4,0,0)
"""


@pytest.fixture
def folder(tmp_path):
    """Two students' answers, one of them right."""
    for name, text in (("ada", table()), ("ben", table().replace("alpha: 90", "alpha: 9"))):
        (tmp_path / name).mkdir()
        (tmp_path / name / "arm.yaml").write_text(text)
    return tmp_path


def hostile(folder, name):
    """A folder with nothing in it, where a hostile student's file goes."""
    (folder / name).mkdir()
    return folder / name / "arm.yaml"


def hand_in_hostile_files(folder):
    """Files of all kinds that are no answers; what is said of each."""
    secret = folder.parent / "secret.txt"
    secret.write_text("the-secret: of-another\n")
    os.mkfifo(hostile(folder, "pipe"))
    hostile(folder, "link").symlink_to(secret)
    hostile(folder, "device").symlink_to("/dev/zero")
    hostile(folder, "dangling").symlink_to("nowhere.yaml")
    (folder / "other").symlink_to(folder / "ada")
    hostile(folder, "folder").mkdir()
    hostile(folder, "bytes").write_bytes(b"robokin: 1\nname: \xff\xfe\n")
    hostile(folder, "large").write_bytes(b"a" * (2 << 20))
    hostile(folder, "deep").write_text("[" * 100_000)
    hostile(folder, "great").write_text(MODIFIED.replace("LENGTH", "1e16"))
    (folder / "dash").mkdir()
    (folder / "dash" / "--against=x.yaml").write_text(table("scara"))
    with socket.socket(socket.AF_UNIX) as listening:
        try:
            listening.bind(str(hostile(folder, "s")))
        except OSError:  # the path is too long for a socket here
            hostile(folder, "t").write_text("")


def test_a_hostile_file_costs_its_own_mark_and_nothing_else(call, folder):
    alone = call("check", "dh", folder, *AGAINST, "--json").json["items"]
    assert [(item["id"], item["status"]) for item in alone] == [
        ("ada/arm.yaml", "pass"),
        ("ben/arm.yaml", "different"),
    ]
    hand_in_hostile_files(folder)
    answer = call("check", "dh", folder, *AGAINST, "--json")
    assert (answer.status, answer.err) == (3, "")
    own = ("ada/arm.yaml", "ben/arm.yaml")
    assert [item for item in answer.json["items"] if item["id"] in own] == alone
    assert not [item for item in answer.json["items"] if item["id"] not in own and item["status"] == "pass"]
    assert "the-secret" not in answer.text
    assert not [item for item in answer.json["items"] if item["id"].startswith("other")]
    said = {item["id"]: item["detail"] for item in answer.json["items"]}
    assert "found a pipe" in said["pipe/arm.yaml"]
    assert "found a symbolic link" in said["link/arm.yaml"]
    assert "found a folder" in said["folder/arm.yaml"]


def test_links_are_followed_where_that_is_asked_for(call, folder):
    hostile(folder, "link").symlink_to(folder / "ada" / "arm.yaml")
    path = folder / "link" / "arm.yaml"
    refused(call("check", "dh", path, *AGAINST), "found a symbolic link", "--follow")
    assert call("check", "dh", path, *AGAINST, "--follow").status == 0


def test_files_of_one_name_have_ids_of_their_own(call, folder):
    files = [folder / name / "arm.yaml" for name in ("ada", "ben")]
    items = call("check", "dh", *files, *AGAINST, "--json").json["items"]
    assert [item["id"] for item in items] == ["ada/arm.yaml", "ben/arm.yaml"]
    (folder / "empty").mkdir()
    items = call("check", "dh", folder / "ada", folder / "empty", *AGAINST, "--json").json["items"]
    assert [item["status"] for item in items] == ["pass", "unreadable"]
    refused(call("check", "dh", folder / "empty", *AGAINST), "found none in the folder")


def test_an_empty_name_is_an_answer_that_cannot_be_read(call, folder):
    items = call("check", "dh", "", folder / "ada" / "arm.yaml", "", *AGAINST, "--json").json["items"]
    assert [(item["id"], item["status"]) for item in items] == [
        ("", "unreadable"), ("arm.yaml", "pass"), ("", "unreadable"),
    ]  # fmt: skip


def test_a_file_called_like_an_option_is_a_file(call, folder, monkeypatch):
    monkeypatch.chdir(folder)
    for name, text in (("ada.yaml", table()), ("--against=ben.yaml", table("scara")), ("ben.yaml", table("scara"))):
        (folder / name).write_text(text)
    names = sorted(path.name for path in folder.glob("*.yaml"))
    answer = call("check", "dh", *names, *AGAINST, "--json")
    assert answer.json["robot"] == ARM
    assert [item["status"] for item in answer.json["items"]] == ["other joints", "pass", "other joints"]
    (folder / "--gradescope=ben.yaml").write_text("")
    call("check", "dh", *names, "--gradescope=ben.yaml", *AGAINST)
    assert (folder / "ben.yaml").read_text() == table("scara")
    refused(call("check", "dh", *names), "found no --against but in the name of a file")
    (folder / "--json").write_text("")
    refused(call("check", "dh", "--json", *names, *AGAINST), "'--json'", "-- before the files")
    assert call("check", "dh", folder, *AGAINST, "--json").status == 3
    assert call("check", "dh", *AGAINST, "--json", "--", *names).json["robot"] == ARM


def test_a_file_called_like_a_robot_is_a_file(call, folder, monkeypatch):
    monkeypatch.chdir(folder)
    (folder / "puma560").write_text(table())
    assert call("check", "dh", "puma560", "--against", "puma560").status == 3


# Time ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("length", ["1e16", "1e6", "3e5"])
def test_great_lengths_come_to_an_end(call, tmp_path, length):
    """The match of these stayed at the first joint for ever."""
    path = tmp_path / "arm.yaml"
    path.write_text(MODIFIED.replace("LENGTH", length))
    answer = call("check", "dh", path, *AGAINST, "--json")
    assert answer.status in (2, 3)


@pytest.mark.parametrize("row", range(6))
def test_great_lengths_anywhere_come_to_an_end(row):
    from dataclasses import replace

    from robokin.grading.same_robot import compare_tables
    from robokin.grading.tolerance import default_tolerance

    robot = load_any("m1013")
    for length in (1e30, 1e16, 1e7):
        rows = list(robot.rows)
        rows[row] = replace(rows[row], d=length)
        found = compare_tables(robot, replace(robot, rows=tuple(rows)), default_tolerance(robot), frozenset())
        assert not found.same
        assert 0.0 <= found.score < 1.0


def test_an_answer_that_takes_too_long_is_not_decided(call, tmp_path):
    slow = ",".join(["+".join(["sin(1)"] * 1200)] * 3)
    lines = "".join(f"Mallory,1,{slow}\n" for _ in range(100))
    (tmp_path / "key.csv").write_text(KEY)
    (tmp_path / "answers.csv").write_text(f"student,id,q1,q2,q3\nAda,1,{RIGHT}\nAda,1,{OTHER}\n{lines}Ben,1,{RIGHT}\n")
    answer = call(
        *IK, "-i", tmp_path / "answers.csv", "--key", tmp_path / "key.csv", "--all", "--budget", "0.3", "--json"
    )
    marks = {item["student"]: item for item in answer.json["items"] if item["id"] == "1"}
    assert answer.status == 3
    assert marks["Ada"]["status"] == "pass"
    assert marks["Ben"]["status"] == "missing solution"
    assert (marks["Mallory"]["status"], marks["Mallory"]["score"]) == ("not decided", 0.0)
    assert [item["decided"] for item in answer.json["items"] if item["student"] == "Mallory"] == [False, True]
    assert answer.json["undecided"] == 1
    refused(call(*IK, "--xy", "1,1", "--q", "1,1,1", "--budget", "0"), "--budget", "seconds")


# Scores ----------------------------------------------------------------------------------------------------


@pytest.fixture
def keyed(call, tmp_path):
    def keyed(lines, *options, key=KEY, command=IK, columns="student,id,q1,q2,q3"):
        (tmp_path / "key.csv").write_text(key)
        (tmp_path / "answers.csv").write_text("\n".join([columns, *lines]) + "\n")
        files = ["-i", tmp_path / "answers.csv", "--key", tmp_path / "key.csv"]
        return call(*command, *files, *options, "--json").json

    return keyed


def test_repetition_earns_nothing(keyed):
    key = KEY.splitlines()[0] + "\n1,10,40,60\n"
    copies = [f"s,1,{8.504 + 1e-6 * i + 360 * (i % 2)},109.004,-57.508" for i in range(9)]
    for wrong in ("0,0,0", "9.5,109.004,-58.504", "x,0,0"):
        document = keyed([*copies, f"s,1,{wrong}"], "--any", key=key)
        assert document["score"] == 0.5
        assert (document["passed"], document["total"]) == (1, 2)
        assert document["students"][0]["score"] == 0.5
    # Neither do more answers to an easy question.
    both = keyed([f"s,1,{RIGHT}", f"s,1,{OTHER}", "s,2,9,9,9"], "--any")
    assert both["score"] == 0.5
    assert keyed([f"s,1,{RIGHT}", f"s,1,{RIGHT}", "s,2,none,,"], "--any")["score"] == 1.0
    assert keyed(["s,1,,,"] * 9 + [f"s,1,{RIGHT}"], "--any", key=key)["score"] == 0.5


def test_repeated_lines_of_poses_do_not_count(call):
    rows = ["0,0,0,0.9,0,0"] * 9 + ["0,90,0,9,9,9"]
    text = "q1,q2,q3,x,y,z\n" + "\n".join(rows) + "\n"
    document = call("check", "fk", ARM, "-i", "-", "--json", stdin=text.encode()).json
    assert (document["score"], document["total"]) == (0.5, 2)


def test_that_there_is_no_solution_just_beside_what_an_arm_reaches_is_said_with_how_far(call):
    """A wrist that is tilted by half a degree is none that four joints reach; 1.605 m is 5 mm beyond 1 m + 0.6 m."""
    tilted = ("check", "ik", "scara", "--xyz", "375.5,420.9,336.9", "--rpy", "180,0.5,0", "--q", "none")
    assert "; the nearest pose is off by " in call(*tilted, "--json").json["items"][0]["detail"]
    told = call(*tilted, "--json", "--feedback", "part").json["items"][0]["detail"]
    assert told == "right: orientation not attainable by this arm at that position"
    far = call("check", "ik", "planar2r", "--xy", "1.605,0", "--q", "none", "--json").json["items"][0]["detail"]
    assert far == "right: out of reach; the nearest pose is off by 0.005 m"


def test_none_needs_a_proof(call):
    """A search that finds nothing proves nothing; out of reach of a planar arm is proven."""
    item = call(*IK, "--xy", "90,0", "--q", "none", "--json").json["items"][0]
    assert (item["status"], item["detail"]) == ("pass", "right: out of reach")
    robot = robokin.load("panda")
    T = robokin.forward_kinematics(robot, [0.0, 0.3, 0.0, -2.0, 0.0, 2.0, 0.0])
    T[:3, 3] += [0.0, 0.0, 0.9]
    T[:3, 3] /= robot.units.metres
    result = call("ik", "panda", "--matrix", json.dumps(T.tolist()), "--json").json
    item = call("check", "ik", "panda", "--matrix", json.dumps(T.tolist()), "--q", "none", "--json").json["items"][0]
    assert item["status"] == ("not decided" if "not proven" in result["reason"] else "pass")
    assert item["decided"] == (item["status"] == "pass")


def test_of_infinitely_many_each_is_compared_with_few(call, tmp_path):
    """Lines in number, the time a line each: the same answer 400 times is one, and 400 along a self-motion are 400."""
    lines = [f"0,0,0,{k / 4},0,{-k / 4}" for k in range(400)]
    target = call("fk", "puma560", "--q", "0,0,0,0,0,0", "-f", "csv").lines
    text = f"{target[0].split(',yaw')[0].replace('q1,q2,q3,q4,q5,q6,', '')},yaw,q1,q2,q3,q4,q5,q6\n"
    pose = ",".join(target[1].split(",")[6:])
    for rows, right in ((lines, 400), (lines[:1] * 400, 1)):
        data = (text + "".join(f"{pose},{row}\n" for row in rows)).encode()
        item = call("check", "ik", "puma560", "-i", "-", "--all", "--json", stdin=data).json["items"][0]
        assert sum(answer["status"] == "pass" for answer in item["answers"]) == right


# Feedback --------------------------------------------------------------------------------------------------

LEVELS = ["verdict", "part", "distance", "answer"]


def everything_said(answer, results):
    """What a student may read."""
    return answer.text + json.dumps([test["output"] for test in json.loads(results.read_text())["tests"]])


QUESTIONS = {
    "fk": (["check", "fk", ARM, "--q", "0,30,0", "--expect", "1,2,3,4,5,6"], ["0.779423", "0.45"]),
    "ik": ([*IK, "--xy", "10,40", "--phi", "60", "--all", "--q", RIGHT], ["153.36", "109.0044", "15.63"]),
    "limits": (["check", "ik", "puma560", "--xyz=-149.09,921.12,20.32", "--rpy", "0,90,90", "--q", "90,0,90,0,0,290"],
               ["266", "532"]),
    "none": ([*IK, "--xy", "10,40", "--phi", "60", "--q", "none"], ["2 sol"]),
    "dof": (["check", "dof", "four-bar", "--expect", "7"], [": 1", "expected 1", "-1"]),
    "jacobian": (["check", "jacobian", "planar2r", "--q", "0,90", "--expect", "[[9,9],[9,9],[9,9],[9,9],[9,9],[9,9]]"],
                 ["-0.6", "0.6"]),
}  # fmt: skip


@pytest.mark.parametrize(("arguments", "secrets"), sweep(QUESTIONS.values(), 3), ids=QUESTIONS)
def test_students_are_not_told_the_right_answer(call, tmp_path, arguments, secrets):
    results = tmp_path / "results.json"
    hidden = call(*arguments, "--gradescope", results)
    page = everything_said(hidden, results).replace("0 of 1 answer right", "").split("tolerance")[-1]
    data = call(*arguments, "--feedback", "part", "--json").json["items"]
    texts = [page, json.dumps([item | {"id": "", "score": 0} for item in data])]
    for secret in secrets:
        assert not [text for text in texts if secret in text], secret
    assert call(*arguments, "--feedback", "answer", "--json").json == call(*arguments, "--json").json


def test_levels_tell_more_and_more(call, tmp_path):
    path = tmp_path / "arm.yaml"
    path.write_text(table().replace("alpha: 90", "alpha: 45", 1))
    said = {}
    for level in LEVELS:
        item = call("check", "dh", path, *AGAINST, "--feedback", level, "--json").json["items"][0]
        assert item["score"] == pytest.approx(0.75)
        said[level] = (item["status"], item["detail"])
    assert said == {
        "verdict": ("wrong", ""),
        "part": ("different", "row 1: alpha is wrong"),
        "distance": ("different", "row 1: alpha 45 deg is off by 45 deg"),
        "answer": ("different", "row 1: alpha 45 deg, expected 90 deg"),
    }
    refused(call("check", "dh", path, *AGAINST, "--feedback", "all"), "--feedback", "verdict")


def test_known_mistakes_are_said_and_scored(call, tmp_path):
    question = ["check", "fk", "puma560", "--q", "home", "--expect", "-.14909,.92112,.02032"]
    item = call(*question, "--json").json["items"][0]
    assert (item["status"], item["score"], item["mistake"]) == ("wrong position", 0.0, "length unit")
    assert "lengths are in m, expected mm" in item["detail"]
    assert call(*question, "--partial", "0.4", "--json").json["score"] == 0.4
    right = ["check", "fk", "puma560", "--q", "home", "--expect", "-149.09,921.12,20.32", "--partial", "0.4", "--json"]
    assert call(*right).json["items"][0] | {"score": 1.0, "mistake": None} == call(*right).json["items"][0]
    path = tmp_path / "arm.yaml"
    path.write_text(table("puma560").replace("convention: standard", "convention: modified"))
    item = call("check", "dh", path, "--against", "puma560", "--partial", "0.5", "--json").json["items"][0]
    assert (item["score"], item["mistake"]) == (0.5, "convention")
    refused(call(*question, "--partial", "2"), "--partial", "from 0 to 1")
