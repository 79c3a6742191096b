"""`robokin jacobian`: the matrix and what it says, in every format."""

from __future__ import annotations

import numpy as np
import pytest

import robokin

from .conftest import refused

Q = "10,20,30,40,50,60"
KEYS = [
    "schema", "robot", "id", "units", "jacobian_units", "q", "frame", "task", "jacobian", "rank", "full_rank", "size",
    "singular_values", "manipulability", "condition", "singular_direction", "null_space_joints",
]  # fmt: skip


@pytest.mark.parametrize("frame", ["base", "tool"])
def test_the_document(call, frame):
    answer = call("jacobian", "puma560", "--q", Q, "--frame", frame, "--json")
    assert (answer.status, answer.err) == (0, "")
    document = answer.json
    assert list(document) == KEYS
    assert document["units"] == {"length": "mm", "angle": "deg"}
    assert document["jacobian_units"] == {"length": "mm", "angle": "rad"}
    J = robokin.jacobian(robokin.load("puma560"), np.radians([10, 20, 30, 40, 50, 60]), frame)
    J[:3] *= 1000.0
    assert np.allclose(document["jacobian"], J, atol=1e-10)
    assert (document["rank"], document["full_rank"], document["frame"]) == (6, 6, frame)
    assert document["manipulability"] == pytest.approx(abs(np.linalg.det(J)))
    assert document["condition"] == pytest.approx(document["singular_values"][0] / document["singular_values"][-1])
    assert document["singular_direction"] is None
    assert document["null_space_joints"] == []


def test_units_go_both_ways(call):
    own = call("jacobian", "puma560", "--q", Q, "--json").json
    q = "rad(10),rad(20),rad(30),rad(40),rad(50),rad(60)"
    other = call("jacobian", "puma560", "--q", q, "--angle", "rad", "--length", "m", "--json").json
    assert np.allclose(np.array(own["jacobian"])[:3], 1000.0 * np.array(other["jacobian"])[:3])
    assert np.allclose(np.array(own["jacobian"])[3:], np.array(other["jacobian"])[3:])
    assert np.allclose(own["singular_values"], other["singular_values"])
    assert own["manipulability"] == pytest.approx(1e9 * other["manipulability"])
    assert own["size"] == pytest.approx(1000.0 * other["size"])


def test_sliding_joints_have_lengths_in_the_length_unit(call):
    q = "10,20,500,40,50,60"
    own = np.array(call("jacobian", "stanford", "--q", q, "--json").json["jacobian"])
    other = call("jacobian", "stanford", "--q", "10,20,0.5,40,50,60", "--length", "m", "--json").json
    metres = np.array(other["jacobian"])
    assert np.allclose(own[:, 2], metres[:, 2])
    assert np.allclose(own[:3, [0, 1, 3, 4, 5]], 1000.0 * metres[:3, [0, 1, 3, 4, 5]])


def test_a_singular_configuration(call):
    document = call("jacobian", "puma560", "--q", "10,20,30,40,0,60", "--json").json
    assert (document["rank"], document["condition"], document["manipulability"]) == (5, None, 0.0)
    (lost,) = document["singular_direction"]
    assert lost["words"].startswith("rotation about")
    assert np.linalg.norm(lost["twist"]) == pytest.approx(1.0)
    assert document["null_space_joints"] == [4, 6]


def test_the_task(call):
    document = call("jacobian", "planar2r", "--q", "30,60", "--json").json
    assert (document["task"], document["full_rank"]) == ("position", 2)
    assert document["manipulability"] == pytest.approx(0.6 * np.sin(np.pi / 3))
    assert call("jacobian", "puma560", "--q", Q, "--task", "position", "--json").json["full_rank"] == 3


def test_a_batch_is_its_singles(call, tmp_path):
    rows = b"q1,q2,q3,q4,q5,q6\n10,20,30,40,50,60\n10,20,30,40,0,60\n"
    answer = call("jacobian", "puma560", "--q", "-", "-f", "jsonl", stdin=rows)
    singles = [call("jacobian", "puma560", "--q", q, "--json").json for q in (Q, "10,20,30,40,0,60")]
    assert answer.jsonl == singles
    assert call("jacobian", "puma560", "--q", "-", "--json", stdin=rows).json == singles
    table = call("jacobian", "puma560", "--q", "-", "-f", "csv", stdin=rows).csv
    assert table[0][:7] == ["q1", "q2", "q3", "q4", "q5", "q6", "j11"]
    assert table[0][-3:] == ["sigma6", "manipulability", "condition"]
    assert [float(cell) for cell in table[1][6:42]] == np.ravel(singles[0]["jacobian"]).tolist()
    assert [row[-1] == "" for row in table[1:]] == [False, True]
    source = tmp_path / "q.csv"
    source.write_bytes(rows)
    assert call("jacobian", "puma560", "-i", source, "-o", tmp_path / "J.npy").status == 0
    assert np.load(tmp_path / "J.npy").tolist() == [one["jacobian"] for one in singles]


def test_the_answer_of_fk_is_legal_input(call):
    poses = call("fk", "puma560", "--q", Q, "-f", "csv").out
    assert call("jacobian", "puma560", "-i", "-", "-f", "jsonl", stdin=poses).jsonl[0]["q"] == [10, 20, 30, 40, 50, 60]


def test_tables_fit_a_page(call):
    for robot, q in (("puma560", ["10,20,30,40,0,60"]), ("human-arm", ["0,0,0,0,0,0,0,0,0"]), ("puma560", [Q, "home"])):
        answer = call("jacobian", robot, *(part for one in q for part in ("--q", one)))
        assert answer.status == 0
        assert max(map(len, answer.lines)) <= 80
        assert "…" not in answer.text


@pytest.mark.parametrize(
    ("arguments", "fragments"),
    [
        (["puma560"], ["--q is missing", "expected 6 values"]),
        (["puma560", "--q", "1,2"], ["found 2 values", "expected 6"]),
        (["puma560", "--q", Q, "--frame", "bas"], ["--frame", "'bas'", "expected base or tool", "'base'"]),
        (["puma560", "--q", Q, "--task", "x"], ["--task", "expected pose, position or orientation"]),
        (["assembly", "--q", ""], ["no joints"]),
        (["puma560", "--q", Q, "--input", "x.csv"], ["exclude each other"]),
        (["puma560", "--q", Q, "--q", "-"], ["no other --q"]),
        (["scara", "--q", "0,0,1e300,0"], ["configuration 1", "too far"]),
    ],
)
def test_what_is_wrong_is_said(call, arguments, fragments):
    refused(call("jacobian", *arguments), *fragments)


def test_torques_that_hold_a_force(call):
    """A planar arm of links 1 m and 0.6 m: τ1 = x Fy - y Fx, τ2 = (x - x1) Fy - (y - y1) Fx."""
    document = call("jacobian", "planar2r", "--q", "30,60", "--force", "3,-10,0", "--json").json
    x1, y1, x, y = np.sqrt(3) / 2, 0.5, np.sqrt(3) / 2, 1.1
    assert document["force"] == [3, -10, 0, 0, 0, 0]
    assert document["torques"] == pytest.approx([x * -10 - y * 3, (x - x1) * -10 - (y - y1) * 3])
    again = call("jacobian", "planar2r", "--q", "30,60", "--force", "3,-10,0", "--json", "--length", "mm").json
    assert again["torques"] == pytest.approx(document["torques"])
    assert "torques" in call("jacobian", "planar2r", "--q", "30,60", "--force", "3,-10,0").text
    table = call("jacobian", "planar2r", "--q", "30,60", "--q", "10,20", "--force", "0,0,0,0,0,2", "-f", "csv")
    assert table.columns[-2:] == ["tau1", "tau2"] and table.numbers[:, -2:].tolist() == [[2, 2], [2, 2]]
    assert "tau1" not in call("jacobian", "planar2r", "--q", "30,60", "-f", "csv").text
    assert "torques" not in call("jacobian", "planar2r", "--q", "30,60", "--json").json


def test_the_power_of_a_force_is_that_of_its_torques(call):
    """τ · dq = F · dx, in the base's axes and in the tool's; of slides too."""
    rng = np.random.default_rng(0)
    for robot in ("puma560", "stanford", "scara"):
        F = rng.uniform(-5, 5, 6)
        for frame in ("base", "tool"):
            words = [
                "--q",
                ",".join(["12"] * robokin.load(robot).n),
                "--frame",
                frame,
            ]
            words += ["--force", ",".join(map(repr, F.tolist())), "--length", "m", "--json"]
            document = call("jacobian", robot, *words).json
            rates = rng.uniform(-1, 1, len(document["torques"]))
            assert document["torques"] @ rates == pytest.approx(F @ (np.array(document["jacobian"]) @ rates))


@pytest.mark.parametrize("text", ["1,2", "1,2,3,4", "a,b,c", "1,2,nan", ""])
def test_a_wrong_force_is_told(call, text):
    refused(call("jacobian", "planar2r", "--q", "30,60", "--force", text), "--force")
