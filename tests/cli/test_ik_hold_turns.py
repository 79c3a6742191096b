"""`robokin ik --turns` and `--hold`: every format, words, and what they do not go with."""

from __future__ import annotations

import io

import numpy as np
import pytest

import robokin

from .conftest import poses_of, refused

UR5E = ["ik", "ur5e", "--xyz", "400,200,300", "--rpy", "180,0,0"]
PANDA = ["ik", "panda", "--xyz", "400,100,400", "--rpy", "180,0,0"]

NAMED = """robokin: 1
name: Named
units: {length: m, angle: deg}
joints:
  - {name: base, type: R, a: 1, limits: [-90, 90]}
  - {name: elbow, type: R, a: 1}
  - {name: q2, type: P, alpha: 0, theta: 0, limits: [0, 1]}
  - {name: q4, type: R, a: 0.5}
"""


def values(document):
    return [solution["q"] for solution in document["solutions"]]


# Full turns -----------------------------------------------------------------------------------------------


def test_without_turns_their_number_is_said(call):
    answer = call(*UR5E)
    assert answer.lines[-1] == "with full turns of joints within the limits 256 solutions: --turns lists them"
    assert call(*UR5E, "--json").json["counts"]["turns"] == 256
    # A list that was cut does not count its full turns: they would be those of a part.
    assert "full turns" not in call(*UR5E, "--max", "2").text
    # Where there are no more it is not said, nor without limits.
    assert "full turns" not in call(*UR5E, "--no-limits").text
    assert "turns" not in call(*UR5E, "--no-limits", "--json").json["counts"]
    assert "full turns" not in call("ik", "panda", *PANDA[2:], "--hold", "q3=20").text
    assert "full turns" not in call("ik", "ur5e", "--xyz", "9000,0,0", "--rpy", "0,0,0").text


def test_turns_in_every_format(call, tmp_path):
    plain, turned = call(*UR5E, "--json").json, call(*UR5E, "--turns", "--json").json
    assert len(turned["solutions"]) == turned["counts"]["turns"] == turned["counts"]["listed"] == 256
    assert turned["complete"] == plain["complete"]
    assert values(turned)[::32] == values(plain)
    for q, branch in zip(values(turned), [s["branch"] for s in turned["solutions"]], strict=True):
        base = next(s for s in plain["solutions"] if s["branch"] == branch and np.allclose(
            (np.subtract(q, s["q"]) + 180.0) % 360.0, 180.0, atol=1e-6))  # fmt: skip
        assert np.allclose((np.subtract(q, base["q"]) + 180.0) % 360.0, 180.0, atol=1e-9)
        assert np.max(np.abs(q)) <= 360.0
    assert call(*UR5E, "--turns", "-f", "jsonl").jsonl == [turned]
    rows = call(*UR5E, "--turns", "-f", "csv")
    assert rows.columns == call(*UR5E, "-f", "csv").columns
    assert [[float(cell) for cell in row[2:8]] for row in rows.csv[1:]] == values(turned)
    assert [row[8] for row in rows.csv[1:]] == [s["branch"].replace(", ", " / ") for s in turned["solutions"]]
    path = tmp_path / "q.npy"
    assert call(*UR5E, "--turns", "-o", path).status == 0
    assert np.load(path)[0].tolist() == values(turned)
    table = call(*UR5E, "--turns")
    assert table.lines[1].startswith("256 solutions, full turns included, these are all")
    assert max(map(len, table.lines)) <= 80
    assert sum(line.split()[0].isdigit() for line in table.lines[5:] if line) == 256


def test_turns_of_a_batch(call):
    target = b"400,200,300,180,0,0\n9000,0,0,0,0,0\n400,200,300,180,0,0\n"
    one = call(*UR5E, "--turns", "-f", "csv").csv[1:]
    rows = call("ik", "ur5e", "-i", "-", "--turns", "-f", "csv", stdin=target)
    assert rows.status == 3
    assert [row[1:] for row in rows.csv[1:] if row[0] == "1"] == [row[1:] for row in one]
    assert [row[1:] for row in rows.csv[1:] if row[0] == "3"] == [row[1:] for row in one]
    assert [row[1] for row in rows.csv[1:] if row[0] == "2"] == ["0"]
    documents = call("ik", "ur5e", "-i", "-", "--turns", "-f", "jsonl", stdin=target).jsonl
    assert [document["counts"]["turns"] for document in documents] == [256, 0, 256]
    back = call("fk", "ur5e", "--q", "-", "-f", "csv", stdin=rows.out)
    assert np.allclose(back.numbers[:, 6:9], [400, 200, 300], atol=1e-6)


def test_a_batch_of_turns_in_pieces_is_the_same(call, monkeypatch):
    target = "".join(f"{400 + k},200,300,180,0,0\n" for k in range(5)).encode()
    whole = call("ik", "ur5e", "-i", "-", "--turns", "-f", "csv", stdin=target).out
    monkeypatch.setattr("robokin.reports.solution_report.TURNED_ROWS", 33)
    assert call("ik", "ur5e", "-i", "-", "--turns", "-f", "csv", stdin=target).out == whole


def test_turns_near_and_max(call):
    near = "300,-100,-90,-240,-90,-200"
    document = call(*UR5E, "--turns", "--near", near, "--json").json
    moves = [np.max(np.abs(np.subtract(q, list(map(float, near.split(",")))))) for q in values(document)]
    assert moves == sorted(moves)
    few = call(*UR5E, "--turns", "--near", near, "--max", "3", "--json").json
    assert values(few) == values(document)[:3]
    assert (few["complete"], few["basis"], few["certificate"]) == (False, None, document["certificate"])
    assert (few["counts"]["turns"], few["counts"]["listed"]) == (256, 3)
    text = " ".join(call(*UR5E, "--turns", "--max", "3").lines)
    assert "3 solutions of all 256, full turns included" in text


def test_joints_without_limits_are_not_turned_and_that_is_said(call, tmp_path):
    path = tmp_path / "arm.yaml"
    path.write_text(
        "robokin: 1\nname: Arm\nunits: {length: m, angle: deg}\njoints:\n"
        "  - {type: R, a: 1}\n  - {type: R, a: 1, limits: [-360, 360]}\n  - {type: R, a: 0.3}\n"
    )
    answer = call("ik", path, "--xy", "1,1", "--phi", "20", "--turns")
    assert answer.lines[1].startswith("4 solutions, full turns included, these are all")
    assert answer.lines[-1] == "full turns: q1 and q3 have no limits and are not turned"
    held = call("ik", path, "--xy", "1,1", "--hold", "q1=0", "--turns")
    assert held.lines[-1] == "full turns: q3 has no limits and is not turned"


def test_absurd_turns_are_refused_in_a_sentence(call, tmp_path):
    path = tmp_path / "arm.yaml"
    path.write_text(
        "robokin: 1\nname: Arm\nunits: {length: m, angle: deg}\njoints:\n"
        "  - {type: R, a: 1, limits: [-1e9, 1e9]}\n  - {type: R, a: 1, limits: [-1e9, 1e9]}\n"
    )
    refused(call("ik", path, "--xy", "1,1", "--turns"), "full turns of each solution", "at most 10000")
    answer = call("ik", path, "--xy", "1,1")
    assert answer.status == 0
    assert "with full turns of joints within the limits more than" in answer.text
    assert max(map(len, answer.lines)) <= 80
    assert call("ik", path, "--xy", "1,1", "--json").json["counts"]["turns"] > 10**13


def test_turns_need_limits(call):
    refused(call(*UR5E, "--turns", "--no-limits"), "--turns and --no-limits exclude each other")


# Held joints ----------------------------------------------------------------------------------------------


def test_a_held_joint_is_in_the_document_and_in_the_sentence(call):
    document = call(*PANDA, "--hold", "q7=20", "--json").json
    names = list(document)
    assert names[names.index("target") + 1] == "hold"
    assert document["hold"] == {"q7": 20.0}
    assert "hold" not in call(*PANDA, "--json").json
    assert len(document["solutions"]) >= 1
    for solution in document["solutions"]:
        assert solution["q"][6] == 20.0
        assert "self_motion" not in solution
        assert np.allclose(poses_of("panda", solution["q"]), document["target"]["matrix"], rtol=0, atol=1e-6)
    text = call(*PANDA, "--hold", "q7=20").lines[1]
    count = len(document["solutions"])
    assert text.startswith(f"{count} solution{'s' if count > 1 else ''} with q7 held at 20, these are all")


def test_the_held_value_has_the_digits_that_were_asked_for(call):
    q = "10,20,30,-60,40,50,7.1"
    poses = call("fk", "iiwa14", f"--q={q}", "-f", "csv").out
    for value in ("30", "29.99"):
        document = call("ik", "iiwa14", "-i", "-", "--hold", f"q3={value}", "-f", "jsonl", stdin=poses).jsonl[0]
        assert {found[2] for found in values(document)} == {float(value)}
    rows = call("ik", "iiwa14", "-i", "-", "--hold", "q3=30", "-f", "csv", stdin=poses)
    assert {row[4] for row in rows.csv[1:]} == {"30.0"}


def test_every_way_to_name_a_joint(call, tmp_path):
    first = call(*PANDA, "--hold", "q3=20", "--json").json
    assert values(call(*PANDA, "--hold", "3=20", "--json").json) == values(first)
    assert values(call(*PANDA, "--hold", " q3 = 40/2 ", "--json").json) == values(first)
    found = call(*PANDA[:4], "--rpy", "pi,0,0", "--angle", "rad", "--hold", "q3=pi/9", "--json").json
    assert found["hold"] == {"q3": pytest.approx(np.pi / 9)}
    assert np.allclose(np.degrees(values(found)), values(first), atol=1e-6)
    path = tmp_path / "arm.yaml"
    path.write_text(NAMED)
    target = ["ik", path, "--xyz", "1.2,0.8,0.25", "--rpy", "0,0,30", "--json"]
    for name in ("elbow", "q2"):
        answer = call(*target, "--hold", f"{name}=40")
        if name == "q2":  # the second joint by its place, the third by its name
            refused(answer, "--hold", "'q2' names joint 2 and joint 3", "number")
        else:
            assert answer.json["hold"] == {"q2": 40.0}
    assert call(*target, "--hold", "3=0.25").json["hold"] == {"q3": 0.25}
    assert call(*target, "--hold", "q4=10").json["hold"] == {"q4": 10.0}


def test_several_held_joints(call):
    q = [10.0, 20.0, 30.0, -100.0, 40.0, 90.0, 50.0]
    T = poses_of("panda", q)
    arguments = ["ik", "panda", "--matrix", str(T.tolist()), "--hold", "q7=50", "--hold", "q1=10"]
    document = call(*arguments, "--json").json
    assert document["hold"] == {"q1": 10.0, "q7": 50.0}
    assert list(document["hold"]) == ["q1", "q7"]
    assert any(np.allclose(found, q, atol=1e-5) for found in values(document))
    assert "with q1 held at 10 and q7 held at 50" in " ".join(call(*arguments).lines)
    same = call(*PANDA, "--hold", "q1=0", "--hold", "q7=0", "--no-limits")
    assert "with q1 and q7 held at 0" in " ".join(same.lines)


def test_hold_in_every_format_and_in_batches(call, tmp_path):
    document = call(*PANDA, "--hold", "q7=20", "--json").json
    rows = call(*PANDA, "--hold", "q7=20", "-f", "csv")
    assert [[float(cell) for cell in row[2:9]] for row in rows.csv[1:]] == values(document)
    path = tmp_path / "q.npy"
    assert call(*PANDA, "--hold", "q7=20", "-o", path).status == 0
    assert np.load(path)[0].tolist() == values(document)
    stdin = b"400,100,400,180,0,0\n9000,0,0,0,0,0\n"
    batch = call("ik", "panda", "-i", "-", "--hold", "q7=20", "-f", "jsonl", stdin=stdin)
    assert batch.status == 3
    assert batch.jsonl[0] == document
    assert batch.jsonl[1]["nearest"]["q"][6] == 20.0
    assert batch.jsonl[1]["reason"] == "out of reach"
    text = call("ik", "panda", "-i", "-", "--hold", "q7=20", stdin=stdin).text
    assert "target 2: no solution with q7 held at 20: out of reach" in text


def test_a_held_value_must_be_within_the_limits(call):
    refused(call(*PANDA, "--hold", "q3=170"), "--hold q3: found 170", "expected -166", "to 166", "--no-limits")
    answer = call(*PANDA, "--hold", "q3=170", "--no-limits", "--json")
    assert not any(solution["within_limits"] for solution in answer.json["solutions"])
    metres = call("ik", "stanford", "--xyz", "500,100,300", "--rpy", "180,0,0", "--hold", "q3=200")
    refused(metres, "expected 304.8 to 1270 mm")


def test_hold_with_tolerances_and_tasks(call):
    arguments = ["ik", "scorbot", "--xyz", "300,40,200", "--rpy", "0,170,8"]
    exact = call(*arguments, "--json").json["nearest"]["q"]
    held = [*arguments, "--tol-angle", "0.2", "--tol-position", "0.5", "--hold", f"q5={exact[4]!r}"]
    document = call(*held, "--json").json
    assert document["reachable"]
    assert all(q[4] == exact[4] for q in values(document))
    open_ = call("ik", "scorbot", "--xyz", "300,40,200", "--approach", "0,0,-1", "--no-limits", "--hold", "q5=12")
    assert "free" not in open_.text
    assert open_.lines[1].startswith("4 solutions with q5 held at 12, ")


WRONG = {
    "no value": (["--hold", "q3"], ["found 'q3'", "JOINT=VALUE"]),
    "an empty value": (["--hold", "q3="], ["JOINT=VALUE"]),
    "no joint": (["--hold", "=3"], ["JOINT=VALUE"]),
    "a joint too many": (["--hold", "q8=3"], ["no joint 'q8'", "q7"]),
    "zero": (["--hold", "0=3"], ["no joint '0'"]),
    "a word": (["--hold", "shoulder=3"], ["no joint 'shoulder'", "expected q1 to q7"]),
    "twice": (["--hold", "q3=3", "--hold", "3=4"], ["q3 is held twice"]),
    "two values": (["--hold", "q3=3,4"], ["--hold q3", "2 values"]),
    "nan": (["--hold", "q3=nan"], ["--hold q3", "nan"]),
    "pi in degrees": (["--hold", "q3=pi"], ["--hold q3", "pi"]),
    "all": ([word for i in range(1, 8) for word in ("--hold", f"{i}={-90 if i == 4 else 10}")], ["all 7 joints"]),
    "an explanation": (["--hold", "q3=3", "--explain"], ["--explain and --hold exclude"]),
}


@pytest.mark.parametrize(("arguments", "fragments"), WRONG.values(), ids=WRONG.keys())
def test_wrong_holds(call, arguments, fragments):
    refused(call(*PANDA, *arguments), *fragments)


def test_hold_and_turns_together(call):
    q = np.radians([20.0, -70.0, 100.0, -60.0, 50.0, 10.0])
    T = robokin.forward_kinematics(robokin.load("ur5e"), q)
    T[:3, 3] *= 1000.0
    stream = io.StringIO()
    np.savetxt(stream, T.reshape(1, 16), fmt="%.17g", delimiter=",")
    document = call(
        "ik", "ur5e", "-i", "-", "--hold", "q1=20", "--turns", "-f", "jsonl", stdin=stream.getvalue().encode()
    ).jsonl[0]
    assert {solution["q"][0] for solution in document["solutions"]} == {20.0}
    assert len(document["solutions"]) == document["counts"]["turns"]
    assert len(document["solutions"]) % 16 == 0
