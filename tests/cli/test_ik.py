"""`robokin ik`: targets of every kind, batches, and what is said when there is no answer."""

from __future__ import annotations

import io
import json
import math
import re
import subprocess
import sys

import numpy as np
import pytest
from sweeps import sweep

import robokin
from robokin.errors import InputError
from robokin.spatial.rotations import DIGITS_LOST

from .conftest import PROGRAM, environment, poses_of, refused

REACHED = "Trans(500,100,300) RPY(180,0,45)"
ARGUMENTS = ["--xyz", "500,100,300", "--rpy", "180,0,45"]
KEYS = [
    "schema", "robot", "id", "units", "target", "reachable", "complete", "basis", "certificate", "counts", "families",
    "families_complete", "method", "reason", "solutions", "nearest",
]  # fmt: skip
SOLUTION = ["q", "branch", "within_limits", "position_error", "angle_error"]
COLUMNS = (
    ["target", "solution"]
    + [f"q{i}" for i in range(1, 7)]
    + ["branch", "within_limits", "position_error", "angle_error", "reason"]
)
REGULAR = [[10.0, 20.0, 30.0, 40.0, 50.0, 60.0], [-70.0, -30.0, 100.0, 15.0, 25.0, -35.0]]


def matrix_text(T):
    return json.dumps(np.asarray(T).tolist())


def npy(array):
    stream = io.BytesIO()
    np.save(stream, array)
    return stream.getvalue()


@pytest.fixture
def joints():
    return "".join(",".join(map(repr, row)) + "\n" for row in REGULAR).encode()


@pytest.fixture
def poses(call, joints):
    """The two poses as `fk` writes them."""

    def poses(*arguments):
        return call("fk", "puma560", "--q", "-", "-f", "csv", *arguments, stdin=joints).out

    return poses


# One target -----------------------------------------------------------------------------------------------


def test_the_document(call):
    answer = call("ik", "puma560", *ARGUMENTS, "--json")
    assert (answer.status, answer.err) == (0, "")
    document = answer.json
    assert list(document) == KEYS
    assert document["robot"] == "puma560"
    assert document["units"] == {"length": "mm", "angle": "deg"}
    assert list(document["target"]) == ["matrix", "task"]
    assert document["target"]["task"] == "pose"
    assert (document["reachable"], document["complete"]) == (True, True)
    assert (document["reason"], document["nearest"]) == (None, None)
    assert document["method"] == "spherical wrist"
    for solution in document["solutions"]:
        assert list(solution) == SOLUTION
        assert solution["within_limits"] is True
        assert np.allclose(poses_of("puma560", solution["q"]), document["target"]["matrix"], rtol=0, atol=1e-8)
        assert solution["position_error"] < 1e-9
        assert solution["angle_error"] < 1e-9
    assert len({solution["branch"] for solution in document["solutions"]}) == len(document["solutions"]) >= 2


def test_every_way_to_say_a_pose(call, tmp_path):
    first = call("ik", "puma560", "--pose", REACHED, "--json").json
    T = first["target"]["matrix"]
    frame = call("frame", REACHED, "--length", "mm", "--json").json
    euler, quaternion = (",".join(map(repr, frame[name])) for name in ("euler", "quaternion"))
    files = {
        "list.json": matrix_text(T),
        "rows.csv": "\n".join(",".join(map(repr, row)) for row in T),
        "spaces.txt": "# a pose\n" + "\n".join(" ".join(map(repr, row)) for row in T),
        "sixteen.csv": ",".join(repr(x) for row in T for x in row),
        "frame.json": json.dumps(frame),
        "metres.json": call("frame", REACHED.replace("500,100,300", ".5,.1,.3"), "--json").text,
        "frame.csv": call("frame", REACHED, "--length", "mm", "--as", "matrix", "-f", "csv").text,
        "rpy.csv": call("frame", REACHED, "--length", "mm", "-f", "csv").text,
        "ik.json": json.dumps(first),
    }
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    np.save(tmp_path / "T.npy", np.array(T))
    ways = [["--matrix", tmp_path / name] for name in [*files, "T.npy"]]
    ways += [["--matrix", matrix_text(T)], ["--matrix", matrix_text(T[:3])], ["--matrix", matrix_text(np.ravel(T))]]
    ways += [ARGUMENTS, ["--xyz", "500 100 300", "--euler", euler], ["--xyz", "5*100,100,300", "--quat", quaternion]]
    ways += [["--xyz", ".5,.1,.3", "--rpy", "pi,0,pi/4", "--length", "m", "--angle", "rad"]]
    for way in ways:
        answer = call("ik", "puma560", *way, "-f", "json")
        assert (answer.status, answer.err) == (0, ""), way
        factor = np.degrees(1.0) if "rad" in way else 1.0
        for solution, expected in zip(answer.json["solutions"], first["solutions"], strict=True):
            assert np.allclose(np.array(solution["q"]) * factor, expected["q"], rtol=0, atol=1e-8), way


def test_the_tools_axis_alone(call):
    answer = call("ik", "puma560", "--xyz", "500,100,300", "--approach", "0,0,-2", "--json")
    assert (answer.status, answer.json["target"]["task"]) == (0, "approach")
    assert answer.json["complete"] is False
    for solution in answer.json["solutions"]:
        T = poses_of("puma560", solution["q"])
        assert np.allclose(T[:3, 2:], [[0, 500], [0, 100], [-1, 300]], rtol=0, atol=1e-6)


def test_a_position_alone(call):
    answer = call("ik", "anthropomorphic", "--xyz", "0.3,0.4,0.5", "--json")
    assert answer.json["units"]["length"] == "m"
    assert answer.json["target"]["task"] == "position"
    assert len(answer.json["solutions"]) == 4
    for solution in answer.json["solutions"]:
        assert np.allclose(poses_of("anthropomorphic", solution["q"])[:3, 3], [0.3, 0.4, 0.5], atol=1e-9)


def test_planar_arms(call):
    answer = call("ik", "planar3r-brac", "--xy", "26.4743,50.8716", "--phi", "85", "--json")
    assert (answer.status, answer.json["target"]["task"]) == (0, "pose")
    assert np.allclose(answer.json["solutions"][0]["q"], [30, 45, 10], atol=1e-3)
    assert len(answer.json["solutions"]) == 2
    two = call("ik", "planar2r", "--xy", "1,0.5", "--json")
    assert (two.status, two.json["target"]["task"], len(two.json["solutions"])) == (0, "position", 2)
    for solution in two.json["solutions"]:
        assert np.allclose(poses_of("planar2r", solution["q"])[:2, 3], [1, 0.5], atol=1e-9)


UPRIGHT = """robokin: 1
name: Upright
units: {length: m, angle: deg}
base: "Rot(x,90)"
joints:
  - {type: R, a: 1}
  - {type: R, a: 1}
"""


def test_a_planar_arm_on_a_wall_has_no_xy(call, tmp_path):
    path = tmp_path / "upright.yaml"
    path.write_text(UPRIGHT)
    refused(call("ik", path, "--xy", "1,1"), "--xy", "plane of x and y", "--xyz")
    assert call("ik", path, "--xyz", "1,0,1").status == 0


def test_a_hand_that_looks_down_has_its_angle(call, tmp_path):
    path = tmp_path / "down.yaml"
    path.write_text(UPRIGHT.replace('base: "Rot(x,90)"', 'tool: "Rot(z,30) Rot(x,180)"'))
    answer = call("ik", path, "--xy", "1,1", "--phi", "30", "--json")
    assert answer.status == 0
    assert [np.round(s["q"], 6).tolist() for s in answer.json["solutions"]] == [[90.0, -90.0]]


# Order, number, limits, method ----------------------------------------------------------------------------


def test_near_orders_by_the_greatest_joint_move(call):
    for near in ("100,50,0,0,0,0", "-100,-150,20,0,10,0", "home"):
        answer = call("ik", "puma560", *ARGUMENTS, "--near", near, "--json")
        start = [0] * 6 if near == "home" else list(map(float, near.split(",")))
        if near == "home":
            start = np.degrees(robokin.load("puma560").poses["home"])
        moves = [np.max(np.abs(np.subtract(s["q"], start))) for s in answer.json["solutions"]]
        assert moves == sorted(moves)
        assert len(moves) > 1
    refused(call("ik", "puma560", *ARGUMENTS, "--near", "1,2,3"), "--near", "3 values", "expected 6")
    refused(call("ik", "puma560", *ARGUMENTS, "--near", "hom"), "--near", "home")


def test_limits(call, tmp_path):
    path = tmp_path / "arm.yaml"
    path.write_text(
        "robokin: 1\nname: Arm\nunits: {length: m, angle: deg}\njoints:\n"
        "  - {type: R, a: 1, limits: [100, 101]}\n  - {type: R, a: 1, limits: [0, 1]}\n"
    )
    answer = call("ik", path, "--xy", "1,1", "--json")
    assert (answer.status, answer.json["reachable"]) == (3, False)
    assert answer.json["reason"] == "outside the joint limits"
    assert list(answer.json["nearest"]) == SOLUTION
    assert answer.json["nearest"]["within_limits"] is True
    assert answer.json["nearest"]["position_error"] > 0.5
    free = call("ik", path, "--xy", "1,1", "--no-limits", "--json")
    assert (free.status, [s["within_limits"] for s in free.json["solutions"]]) == (0, [False, False])
    assert "! outside the joint limits" in call("ik", path, "--xy", "1,1", "--no-limits").text


def test_at_most_so_many(call):
    whole = call("ik", "puma560", *ARGUMENTS, "--json").json
    one = call("ik", "puma560", *ARGUMENTS, "--max", "1", "--json").json
    assert one["solutions"] == whole["solutions"][:1]
    # Not all are listed, though all are known.
    assert (one["complete"], one["basis"], one["certificate"]) == (False, None, whole["certificate"])
    count = len(whole["solutions"])
    assert one["counts"] | {"listed": count} == whole["counts"] | {"turns": one["counts"]["turns"]}
    assert call("ik", "puma560", *ARGUMENTS, "--max", "1").lines[1].startswith(f"1 solution of all {count}: ")
    many = call("ik", "puma560", *ARGUMENTS, "--max", "99", "--json").json
    assert many == whole


def test_methods_agree_and_a_seed_repeats(call):
    exact = call("ik", "puma560", *ARGUMENTS, "--json").json
    assert call("ik", "puma560", *ARGUMENTS, "--method", "analytic", "--json").json == exact
    numeric = call("ik", "puma560", *ARGUMENTS, "--method", "numeric", "--seed", "3", "--json")
    assert numeric.out == call("ik", "puma560", *ARGUMENTS, "--method", "numeric", "--seed", "3", "--json").out
    assert (numeric.json["method"], numeric.json["complete"]) == ("numeric", False)
    found = [s["q"] for s in exact["solutions"]]
    for solution in numeric.json["solutions"]:
        assert min(np.max(np.abs(np.subtract(solution["q"], q))) for q in found) < 1e-4
    refused(call("ik", "puma560", *ARGUMENTS, "--method", "analytics"), "--method", "'analytic'")


def test_a_posture_with_a_self_motion_is_told(call):
    arguments = ["--pose", "Trans(-149.09,921.12,20.32) RPY(0,90,90)"]
    document = call("ik", "puma560", *arguments, "--json").json
    singular = [s for s in document["solutions"] if "self_motion" in s]
    assert [s["self_motion"] for s in singular] == [[4, 6]]
    # One of infinitely many stands for all, and the list of its intervals is what makes the answer complete.
    assert document["complete"] is True
    (family,) = document["families"]
    assert (family["joints"], family["closed"]) == ([4, 6], True)
    assert document["solutions"][family["solution"] - 1] == singular[0]
    for interval in family["intervals"]:
        for q in (interval["from"], interval["to"]):
            assert np.allclose(poses_of("puma560", q), document["target"]["matrix"], rtol=0, atol=1e-5)
    text = " ".join(call("ik", "puma560", *arguments).lines)
    assert "self-motion: joints q4 and q6 can move while the pose stays" in text


def test_a_free_joint_is_told(call):
    arguments = ["scorbot", "--xyz", "300,40,200", "--approach", "0,0,-1", "--no-limits"]
    document = call("ik", *arguments, "--near", "0,0,0,0,30", "--json").json
    assert (document["reachable"], document["complete"], len(document["solutions"])) == (True, False, 4)
    for solution in document["solutions"]:
        assert list(solution) == [*SOLUTION, "self_motion"]
        assert solution["self_motion"] == [5]
        assert solution["q"][4] == pytest.approx(30)
    answer = call("ik", *arguments)
    assert max(map(len, answer.lines)) <= 80
    assert answer.lines[1].startswith("4 solutions, these are all (any value of q5)")
    assert answer.lines[-1] == "free: q5 may have any value; each posture is listed once"
    assert call("ik", *arguments, "--max", "2").lines[1].startswith("2 solutions of all 4 (any value of q5)")


def test_a_redundant_arm_is_told(call):
    arguments = ["panda", "--xyz", "400,100,400", "--rpy", "180,0,0"]
    few = call("ik", *arguments, "--max", "3", "--json").json["solutions"]
    every = call("ik", *arguments, "--json").json["solutions"]
    assert (len(few), len(every)) == (3, 16)
    assert few == every[:3]
    assert all(solution["self_motion"] == [1, 2, 3, 4, 5, 6, 7] for solution in every)
    answer = call("ik", *arguments, "--max", "3")
    assert max(map(len, answer.lines)) <= 80
    assert "self-motion: joints q1 to q7 can move while the pose stays" in answer.text
    text = call("ik", "puma560", "--xyz", "400,200,300").text
    assert "free: q6 may have any value" in text
    assert "self-motion: joints q1 to q5 can move while the position stays" in text


def test_a_tolerance_takes_the_nearest_pose(call):
    arguments = ["ik", "scorbot", "--xyz", "300,40,200", "--rpy", "0,170,8"]
    exact = call(*arguments, "--json")
    assert (exact.status, exact.json["reachable"]) == (3, False)
    assert exact.json["reason"].startswith("orientation not attainable")
    off = exact.json["nearest"]["angle_error"]
    assert 0.01 < off < 0.2
    for tolerance in ("0.01", "0"):
        assert call(*arguments, "--tol-angle", tolerance).status == 3
    assert call(*arguments, "--tol-position", "1").status == 3
    near = call(*arguments, "--tol-angle", "0.2", "--json")
    assert (near.status, near.json["complete"], near.json["reason"], near.json["nearest"]) == (0, False, None, None)
    for solution in near.json["solutions"]:
        assert solution["within_limits"]
        assert solution["angle_error"] == pytest.approx(off, rel=1e-3)
        assert solution["position_error"] < 1e-6
    assert "within the tolerances" in call(*arguments, "--tol-angle", "0.2").text
    rows = call(*arguments, "--tol-angle", "0.2", "-f", "csv")
    assert (rows.status, len(rows.csv)) == (0, 1 + len(near.json["solutions"]))


# No answer ------------------------------------------------------------------------------------------------


def test_out_of_reach(call):
    answer = call("ik", "puma560", "--xyz", "3000,0,0", "--rpy", "0,0,0", "--json")
    assert (answer.status, answer.err) == (3, "")
    assert (answer.json["reachable"], answer.json["reason"], answer.json["solutions"]) == (False, "out of reach", [])
    nearest = answer.json["nearest"]
    T = poses_of("puma560", nearest["q"])
    assert np.linalg.norm(T[:3, 3] - [3000, 0, 0]) == pytest.approx(nearest["position_error"], rel=1e-9)
    assert 1900 < nearest["position_error"] < 2200


def test_of_a_position_no_angle_is_off(call):
    answer = call("ik", "puma560", "--xyz", "3000,0,0", "--json")
    assert answer.json["nearest"]["angle_error"] == 0
    text = call("ik", "puma560", "--xyz", "3000,0,0").text
    assert "no solution: out of reach" in text
    # The arm stretched out: upper arm, forearm with its offset a3, across the shoulder's d2, and the hand's d6.
    reach = math.hypot(431.8 + math.hypot(20.32, 433.07), 149.09) + 56.25
    off = float(re.search(r"position error ([\d.]+) mm", text)[1])
    assert off == pytest.approx(3000 - reach, abs=2e-3)  # a millionth of the arm's size
    assert " deg" not in text.splitlines()[-1]


# Formats --------------------------------------------------------------------------------------------------


def test_the_table(call):
    answer = call("ik", "puma560", *ARGUMENTS)
    assert answer.lines[0] == "PUMA 560  lengths in mm, angles in deg"
    verdict, _, rest = answer.text.partition("\n\n")
    assert re.search(r"\d solutions, these are all.* \(spherical wrist\)$", " ".join(verdict.splitlines()))
    assert rest.splitlines()[0].split() == ["#", *(f"q{i}" for i in range(1, 7)), "shoulder", "elbow", "wrist"]
    assert max(map(len, answer.lines)) <= 80


@pytest.mark.parametrize(("name", "more"), [("human-arm", []), ("panda", []), ("puma560", ["--angle", "rad"])])
def test_a_table_fits_a_page(call, name, more):
    n = robokin.load(name).n
    units = robokin.load(name).units
    q = np.clip(np.full(n, 0.3), *robokin.load(name).limits.T)
    x, y, z = robokin.forward_kinematics(robokin.load(name), q)[:3, 3] / units.metres
    answer = call("ik", name, "--xyz", f"{x!r},{y!r},{z!r}".replace("np.float64", ""), "--max", "2", *more)
    assert answer.status == 0
    assert max(map(len, answer.lines)) <= 80
    shown = " ".join(answer.lines)
    assert all(f"q{i}" in shown for i in range(1, n + 1))


def test_lines_and_rows(call):
    (document,) = call("ik", "puma560", *ARGUMENTS, "-f", "jsonl").jsonl
    assert document == call("ik", "puma560", *ARGUMENTS, "-f", "json").json
    rows = call("ik", "puma560", *ARGUMENTS, "-f", "csv")
    assert rows.columns == COLUMNS
    for number, (row, solution) in enumerate(zip(rows.csv[1:], document["solutions"], strict=True), start=1):
        assert row[:2] == ["1", str(number)]
        assert [float(cell) for cell in row[2:8]] == solution["q"]
        assert row[8:10] == [solution["branch"].replace(", ", " / "), "true"]
        assert [float(cell) for cell in row[10:12]] == [solution["position_error"], solution["angle_error"]]
        assert row[12] == ""


def test_files(call, tmp_path, poses):
    expected = call("ik", "puma560", "-i", "-", "-f", "json", stdin=poses()).json
    for ending in ("csv", "json", "jsonl", "npy"):
        path = tmp_path / f"q.{ending}"
        answer = call("ik", "puma560", "-i", "-", "-o", path, stdin=poses())
        assert (answer.status, answer.out, answer.err) == (0, b"", "")
    assert json.loads((tmp_path / "q.json").read_text()) == expected
    assert [json.loads(line) for line in (tmp_path / "q.jsonl").read_text().splitlines()] == expected
    counts = [len(document["solutions"]) for document in expected]
    array = np.load(tmp_path / "q.npy")
    assert array.shape == (2, max(counts), 6)
    for row, document, count in zip(array, expected, counts, strict=True):
        assert row[:count].tolist() == [solution["q"] for solution in document["solutions"]]
        assert np.isnan(row[count:]).all()
    assert len((tmp_path / "q.csv").read_text().splitlines()) == 1 + sum(counts)
    assert {path.name for path in tmp_path.iterdir()} == {"q.csv", "q.json", "q.jsonl", "q.npy"}


# Batches --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["rpy", "quaternion", "euler", "matrix"])
def test_what_fk_writes_is_read(call, poses, kind):
    answer = call("ik", "puma560", "--input", "-", "-f", "jsonl", stdin=poses("--as", kind))
    assert (answer.status, answer.err) == (0, "")
    for document, q in zip(answer.jsonl, REGULAR, strict=True):
        assert min(np.max(np.abs(np.subtract(s["q"], q))) for s in document["solutions"]) < 1e-8


def test_bare_rows_comments_and_quoted_headings(call, poses):
    expected = call("ik", "puma560", "-i", "-", "-f", "csv", stdin=poses()).csv
    for kind, count in (("rpy", 6), ("quaternion", 7), ("matrix", 16)):
        rows = [line.split(b",")[-count:] for line in poses("--as", kind).splitlines()[1:]]
        bare = b"# poses\n\n" + b"\n".join(b",".join(row) for row in rows)
        told = ["--as", kind] if count == 7 else []
        for text in (bare, b"\xef\xbb\xbf" + bare.replace(b"\n", b"\r\n"), bare.replace(b",", b" ")):
            found = call("ik", "puma560", "-i", "-", *told, "-f", "csv", stdin=text)
            assert (found.status, found.err, len(found.csv)) == (0, "", len(expected))
    quoted = poses().replace(b"q1,", b'"q1",').replace(b"roll", b'"roll"')
    assert call("ik", "puma560", "-i", "-", "-f", "csv", stdin=quoted).csv == expected


def test_json_lines_and_arrays(call, joints, poses, tmp_path):
    expected = call("ik", "puma560", "-i", "-", "-f", "csv", stdin=poses()).csv
    sources = [call("fk", "puma560", "--q", "-", "-f", "jsonl", stdin=joints).out]
    radians = "".join(",".join(map(repr, np.radians(row).tolist())) + "\n" for row in REGULAR).encode()
    sources += [call("fk", "puma560", "--q", "-", "-f", "jsonl", "--length", "m", "--angle", "rad", stdin=radians).out]
    lists = [[float(cell) for cell in line.split(b",")[6:]] for line in poses().splitlines()[1:]]
    sources += ["\n\n".join(map(json.dumps, lists)).encode()]
    for kind in ("matrix", "rpy", "quaternion"):
        path = tmp_path / f"{kind}.npy"
        assert call("fk", "puma560", "--q", "-", "--as", kind, "-o", path, stdin=joints).status == 0
        sources += [path.read_bytes(), npy(np.asfortranarray(np.load(path)))]
    for k, source in enumerate(sources):
        told = ["--as", "quaternion"] if k >= len(sources) - 2 else []
        answer = call("ik", "puma560", "-i", "-", *told, "-f", "csv", stdin=source)
        assert (answer.status, answer.err) == (0, ""), k
        for row, wanted in zip(answer.csv[1:], expected[1:], strict=True):
            assert row[:2] == wanted[:2]
            assert np.allclose(np.array(row[2:8], float), np.array(wanted[2:8], float), rtol=0, atol=1e-6)
    one = call("ik", "puma560", "-i", "-", "-f", "csv", stdin=npy(np.load(tmp_path / "matrix.npy")[0]))
    assert {row[0] for row in one.csv[1:]} == {"1"}


def test_there_and_back_again(call, poses):
    """What `ik` writes is read by `fk`, a configuration a solution; targets without one are left out."""
    stdin = poses() + b"0,0,0,0,0,0,5000,0,0,0,0,0\n"
    for form in ("csv", "jsonl"):
        solved = call("ik", "puma560", "-i", "-", "-f", form, stdin=stdin)
        assert (solved.status, solved.err) == (3, "robokin: 1 of 3 targets has no solution\n")
        back = call("fk", "puma560", "--q", "-", "-f", "csv", stdin=solved.out)
        assert back.status == 0
        assert back.err == "robokin: standard input: 1 target has no solution and is left out\n"
        count = len(solved.csv) - 2 if form == "csv" else sum(len(d["solutions"]) for d in solved.jsonl)
        assert len(back.numbers) == count
        wanted = [[float(cell) for cell in line.split(b",")[6:9]] for line in poses().splitlines()[1:]]
        for row in back.numbers:
            assert min(np.max(np.abs(row[6:9] - p)) for p in np.array(wanted)) < 1e-8
        if form == "jsonl":  # the targets are read again
            assert call("ik", "puma560", "-i", "-", stdin=solved.out).status == 3


def test_units_hold_for_batches(call, joints):
    rows = call("fk", "puma560", "--q", "-", "-f", "csv", stdin=joints)
    numbers = rows.numbers[:, 6:]
    numbers[:, :3] /= 1000
    numbers[:, 3:] *= np.pi / 180
    stdin = "\n".join(",".join(map(repr, row)) for row in numbers.tolist()).encode()
    answer = call("ik", "puma560", "-i", "-", "--length", "m", "--angle", "rad", "-f", "jsonl", stdin=stdin)
    for document, q in zip(answer.jsonl, REGULAR, strict=True):
        assert document["units"] == {"length": "m", "angle": "rad"}
        assert min(np.max(np.abs(np.subtract(s["q"], np.radians(q)))) for s in document["solutions"]) < 1e-8


def test_every_target_gets_its_line(call, poses):
    lines = poses().splitlines()
    stdin = b"\n".join([lines[0], lines[1], b"0,0,0,0,0,0,5000,0,0,0,0,0", lines[2]])
    csv = call("ik", "puma560", "-i", "-", "-f", "csv", stdin=stdin)
    assert csv.status == 3
    rows = [row for row in csv.csv[1:] if row[0] == "2"]
    assert rows == [["2", "0", *[""] * 10, "out of reach"]]
    assert {row[0] for row in csv.csv[1:]} == {"1", "2", "3"}
    documents = call("ik", "puma560", "-i", "-", "-f", "jsonl", stdin=stdin)
    assert (documents.status, [d["reachable"] for d in documents.jsonl]) == (3, [True, False, True])
    table = call("ik", "puma560", "-i", "-", stdin=stdin)
    assert (table.status, table.text.count("lengths in mm")) == (3, 1)
    labels = [line.split(":")[0] for line in table.lines if line.startswith("target")]
    assert labels == ["target 1", "target 2", "target 3"]
    one = call("ik", "puma560", "-i", "-", "--max", "1", "-f", "csv", stdin=poses())
    assert [row[:2] for row in one.csv[1:]] == [["1", "1"], ["2", "1"]]


def test_csv_and_lines_say_the_same(call, rng):
    limits = np.degrees(robokin.load("puma560").limits)
    q = limits[:, 0] + rng.random((1500, 6)) * np.ptp(limits, axis=1)
    stdin = "".join(",".join(map(repr, row)) + "\n" for row in q.tolist()).encode()
    stdin = call("fk", "puma560", "--q", "-", "-f", "csv", stdin=stdin).out
    rows = call("ik", "puma560", "-i", "-", "-f", "csv", stdin=stdin)
    documents = call("ik", "puma560", "-i", "-", "-f", "jsonl", stdin=stdin).jsonl
    assert rows.status == 0
    flat = [
        [str(i), s["q"], s["branch"].replace(", ", " / ")] for i, d in enumerate(documents, 1) for s in d["solutions"]
    ]
    assert [[row[0], [float(cell) for cell in row[2:8]], row[8]] for row in rows.csv[1:]] == flat
    assert len(documents) == 1500
    for values, document in zip(q[:200].tolist(), documents, strict=False):
        moves = np.array([solution["q"] for solution in document["solutions"]]) - values
        assert np.min(np.max(np.abs(moves - 360 * np.round(moves / 360)), axis=1)) < 1e-5


@pytest.mark.parametrize("text", [b"", b"\n\n", b"x,y,z,roll,pitch,yaw\n", b"# none\n"])
def test_nothing_in_is_nothing_out(call, tmp_path, text):
    def answer(*more):
        found = call("ik", "puma560", "-i", "-", *more, stdin=text)
        assert (found.status, found.err) == (0, "")
        return found

    assert answer("-f", "csv").columns == COLUMNS
    assert answer("--json").json == []
    assert answer("-f", "jsonl").out == b""
    answer("-o", tmp_path / "q.npy")
    assert np.load(tmp_path / "q.npy").shape == (0, 0, 6)


@pytest.mark.parametrize("form", sweep(["csv", "jsonl", "table"], 3))
def test_a_line_is_answered_before_the_next_is_asked(form):
    command = [*PROGRAM, "ik", "puma560", "--input", "-", "--max", "1", "-f", form]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=environment()) as process:
        assert process.stdin is not None and process.stdout is not None
        for i in range(2):
            process.stdin.write(b"500,100,30%d,180,0,45\n" % i)
            process.stdin.flush()
            for _ in range({"csv": i == 0, "table": 6 - i}.get(form, 0)):
                process.stdout.readline()
            assert process.stdout.readline()
            assert process.poll() is None
        process.stdin.close()
        process.stdout.read()
        assert process.wait(timeout=60) == 0


PEAK = """
import resource, subprocess, sys
status = subprocess.run([sys.executable, "-c", "from robokin.cli import main; main()", *sys.argv[1:]]).returncode
print(status, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="the unit of ru_maxrss is the system's")
def test_memory_does_not_grow_with_the_input(tmp_path, rng):
    limits = robokin.load("puma560").limits
    q = limits[:, 0] + rng.random((20_000, 6)) * np.ptp(limits, axis=1)
    T = robokin.forward_kinematics(robokin.load("puma560"), q)
    T[:, :3, 3] *= 1000
    peaks = []
    for count in (5_000, 20_000):
        source, target = tmp_path / f"T{count}.csv", tmp_path / f"q{count}.csv"
        source.write_text("".join(",".join(map(repr, row)) + "\n" for row in T[:count].reshape(-1, 16).tolist()))
        done = subprocess.run(
            [sys.executable, "-c", PEAK, "ik", "puma560", "--input", source, "--output", target],
            capture_output=True, check=True, env=environment(),
        )  # fmt: skip
        status, kilobytes = done.stdout.split()
        assert (int(status), done.stderr) == (0, b"")
        peaks.append(int(kilobytes))
        with target.open("rb") as stream:
            last = list(stream)[-1]
        assert last.startswith(b"%d," % count)
    assert peaks[1] < peaks[0] + 20 * 1024


def test_a_closed_pipe_ends_quietly(poses, tmp_path):
    path = tmp_path / "T.csv"
    lines = poses().splitlines()
    path.write_bytes(b"\n".join([lines[0], *lines[1:] * 3000]))
    with subprocess.Popen(
        [*PROGRAM, "ik", "puma560", "-i", str(path), "-f", "csv"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment(),
    ) as process:  # fmt: skip
        assert process.stdout is not None and process.stderr is not None
        process.stdout.readline()
        process.stdout.close()
        assert process.stderr.read() == b""
        assert process.wait(timeout=60) == 0


# Wrong input ----------------------------------------------------------------------------------------------

WRONG = {
    "no target": ([], ["there is no target", "--pose", "--input"]),
    "two targets": (["--pose", REACHED, "--xyz", "1,2,3"], ["--pose and --xyz"]),
    "a target and a batch": (["--input", "-", "--xyz", "1,2,3"], ["--input and --xyz exclude"]),
    "two orientations": ([*ARGUMENTS, "--quat", "1,0,0,0"], ["--rpy and --quat exclude"]),
    "an orientation alone": (["--rpy", "1,2,3"], ["no target"]),
    "an orientation too many": (["--pose", REACHED, "--rpy", "1,2,3"], ["--rpy goes with --xyz"]),
    "phi with a position": (["--xyz", "1,2,3", "--phi", "1"], ["--phi goes with --xy"]),
    "no planar arm": (["--xy", "1,2"], ["planar", "--xyz"]),
    "two coordinates": (["--xyz", "1,2"], ["--xyz", "2 values", "expected 3"]),
    "two angles": (["--xyz", "1,2,3", "--rpy", "1,2"], ["--rpy", "expected 3"]),
    "nan": (["--xyz", "1,2,nan"], ["--xyz", "nan"]),
    "a length that is none": (["--xyz", "1,2,x"], ["--xyz", "value 3 of 3", "x"]),
    "too far": (["--xyz", "1e300,2,3"], ["--xyz", "too far away"]),
    "pi in degrees": (["--xyz", "1,2,3", "--rpy", "pi,0,0"], ["--rpy", "pi"]),
    "a long quaternion": (["--xyz", "1,2,3", "--quat", "1,1,0,0"], ["--quat", "1.41421", "expected 1"]),
    "no direction": (["--xyz", "1,2,3", "--approach", "0,0,0"], ["--approach", "length zero"]),
    "a bad pose": (["--pose", "Tran(1,2,3)"], ["--pose", "Tran"]),
    "sheared": (["--matrix", "[[1,0.2,0,1],[0,1,0,2],[0,0,1,3],[0,0,0,1]]"], ["--matrix", "off by 0.2"]),
    "reflected": (["--matrix", "[[1,0,0,1],[0,1,0,2],[0,0,-1,3],[0,0,0,1]]"], ["--matrix", "reflection"]),
    "scaled": (["--matrix", "[[2,0,0,1],[0,2,0,2],[0,0,2,3],[0,0,0,1]]"], ["--matrix", "off by 3"]),
    "a last row": (["--matrix", "[[1,0,0,1],[0,1,0,2],[0,0,1,3],[0,0,0,2]]"], ["last row 0 0 0 2"]),
    "three by three": (["--matrix", "[[1,0,0],[0,1,0],[0,0,1]]"], ["3×3", "expected 4×4"]),
    "NaN in a matrix": (["--matrix", "[[1,0,0,NaN],[0,1,0,2],[0,0,1,3],[0,0,0,1]]"], ["finite"]),
    "a great integer": (["--matrix", f"[[1,0,0,1{'0' * 400}],[0,1,0,2],[0,0,1,3],[0,0,0,1]]"], ["--matrix"]),
    "words in a matrix": (["--matrix", '[["a"]]'], ["--matrix", "numbers"]),
    "no JSON": (["--matrix", "[[1,0"], ["--matrix", "not JSON"]),
    "a key twice": (["--matrix", '{"matrix": [], "matrix": []}'], ["the key 'matrix' twice", "expected it once"]),
    "no such file": (["--matrix", "none.json"], ["none.json", "no such file"]),
    "a wrong unit": ([*ARGUMENTS, "--length", "km"], ["--length", "km"]),
    "max 0": ([*ARGUMENTS, "--max", "0"], ["--max", "1 or more"]),
    "max of many digits": ([*ARGUMENTS, "--max", "9" * 5000], ["--max", "digits"]),
    "a seed of letters": ([*ARGUMENTS, "--seed", "x"], ["--seed", "'x'"]),
    "a negative seed": ([*ARGUMENTS, "--seed", "-1"], ["--seed", "0 or more"]),
    "a negative length": ([*ARGUMENTS, "--tol-position", "-1"], ["--tol-position", "0 or more"]),
    "a negative angle": ([*ARGUMENTS, "--tol-angle", "-1"], ["--tol-angle", "0 or more"]),
    "two tolerances": ([*ARGUMENTS, "--tol-angle", "1,2"], ["--tol-angle", "2 values"]),
    "nowhere": ([*ARGUMENTS, "-o", "none/q.csv"], ["none/q.csv", "No such file"]),
    "an ending": ([*ARGUMENTS, "-o", "q.txt"], ["q.txt", ".npy"]),
    "no input": (["--input", "none.csv"], ["none.csv", "no such file"]),
    "a directory": (["--input", "."], ["directory"]),
    "a directory of a matrix": (["--matrix", "."], ["directory"]),
}


@pytest.mark.parametrize(("arguments", "fragments"), WRONG.values(), ids=WRONG.keys())
def test_wrong_input(call, arguments, fragments, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    refused(call("ik", "puma560", *arguments), *fragments)


def test_what_has_no_inverse_kinematics(call, tmp_path):
    refused(call("ik", "four-bar", "--xyz", "1,2,3"), "mechanism", "expected a robot")
    path = tmp_path / "fixed.yaml"
    path.write_text("robokin: 1\nname: Post\njoints: []\n")
    assert call("ik", path, "--xyz", "1,2,3").status == 2
    path.write_text("robokin: 1\nname: Post\njoints:\n  - {type: fixed, a: 1}\n")
    assert call("ik", path, "--xyz", "1,2,3").status == 2


ROW = "500,100,300,180,0,45\n"
MATRIX = "1,0,0,500,0,1,0,100,0,0,1,300,0,0,0,1\n"
WRONG_LINES = {
    "a word": ((ROW * 4710 + "500,100,x,180,0,45\n" + ROW), ["line 4711", "x"]),
    "a value too few": ((ROW * 4710 + "500,100,300,180,0\n" + ROW), ["line 4711", "5 values", "expected 6"]),
    "nan": ((ROW + "500,100,nan,180,0,45\n"), ["line 2", "nan"]),
    "too far": (("# a comment\n\n" + ROW + "1e200,100,0,180,0,45\n"), ["line 4", "too far away"]),
    "sheared": (("\n" + MATRIX * 2 + MATRIX.replace("1,0,0,500", "1,.5,0,500")), ["line 4", "off by 0.5"]),
    "reflected": ((MATRIX + MATRIX.replace("0,0,1,300", "0,0,-1,300")), ["line 2", "reflection"]),
    "a last row": ((MATRIX.strip()[:-1] + "2\n"), ["line 1", "last row 0 0 0 2"]),
    "a quaternion": (("x,y,z,qw,qx,qy,qz\n1,2,3,1,0,0,0\n1,2,3,1,0,0,1\n"), ["line 3", "length 1.41421"]),
    "pi in degrees": ((ROW + "1,2,3,pi,0,0\n"), ["line 2", "pi"]),
    "other columns": (("x,y,zz\n1,2,3\n"), ["line 1", "x, y, z with roll, pitch, yaw"]),
    "JSON": (('{"matrix": 3}\n'), ["line 1", "4×4"]),
    "no JSON": (("[1,2,3,4,5,6]\n[1,2\n"), ["line 2", "not JSON"]),
    "no pose": (('[1,2,3,4,5,6]\n\n{"q": [1]}\n'), ["line 3", "no matrix"]),
    "units": (('{"units": "m", "matrix": []}\n'), ["line 1", "units"]),
    "a position": (('{"target": {"task": "place", "matrix": []}}\n'), ["line 1", "place", "expected pose, position"]),
}


@pytest.mark.parametrize(("text", "fragments"), WRONG_LINES.values(), ids=WRONG_LINES.keys())
def test_a_wrong_line_names_its_number(call, text, fragments):
    answer = call("ik", "puma560", "-i", "-", "--max", "1", "-f", "csv", stdin=text.encode())
    assert answer.status == 2
    assert "Traceback" not in answer.err
    assert len(answer.err.splitlines()) == 1
    for fragment in ["standard input", *fragments]:
        assert fragment in answer.err


ARRAYS = {
    "a shape": (npy(np.zeros((2, 5))), "shape (2, 5)"),
    "text": (npy(np.array(["a"])), "type"),
    "complex": (npy(np.zeros((1, 6), complex)), "type"),
    "not finite": (npy(np.array([[500.0, 100, 300, 180, 0, 45], [np.nan] * 6])), "row 2"),
    "no rotation": (npy(np.zeros((3, 4, 4))), "row 1"),
    "cut short": (npy(np.zeros((3, 6)))[:-8], "ends before"),
    "no array": (b"\x93NUMPY what", "npy"),
}


@pytest.mark.parametrize(("data", "fragment"), ARRAYS.values(), ids=ARRAYS.keys())
def test_wrong_arrays(call, tmp_path, data, fragment):
    answer = call("ik", "puma560", "-i", "-", stdin=data)
    assert (answer.status, len(answer.err.splitlines())) == (2, 1)
    assert fragment in answer.err
    path = tmp_path / "T.npy"
    path.write_bytes(data)
    assert call("ik", "puma560", "--matrix", path).status == 2


def test_wrong_files_of_a_matrix(call, tmp_path):
    for name, data in {
        "empty.npy": b"", "empty.csv": b"", "bytes.txt": b"\xff\xfe\x00", "zip.npy": b"PK\x03\x04", "one.csv": b"1\n",
        "words.csv": b"a b c\n", "ragged.csv": b"1,2\n3\n", "list.json": b"[]", "object.json": b"{}",
    }.items():  # fmt: skip
        (tmp_path / name).write_bytes(data)
        refused(call("ik", "puma560", "--matrix", tmp_path / name), name)
    (tmp_path / "two.csv").write_text(ROW * 2)
    refused(call("ik", "puma560", "--matrix", tmp_path / "two.csv"), "two.csv")


def test_a_failed_batch_leaves_no_file(call, tmp_path):
    path = tmp_path / "q.csv"
    assert call("ik", "puma560", "-i", "-", "-o", path, stdin=(ROW + "x\n").encode()).status == 2
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("part", [0.5, 0.99, 1.01, 2.0])
def test_python_and_the_shell_take_the_same_matrices(call, part):
    T = np.eye(4)
    T[0, 1] = part * DIGITS_LOST
    T[:3, 3] = 400.0, 200.0, 100.0
    answer = call("ik", "puma560", "--no-limits", "--json", "--matrix", json.dumps(T.tolist()))
    robot = robokin.load("puma560")
    T[:3, 3] /= 1000.0
    if part > 1.0:
        assert answer.status == 2
        with pytest.raises(InputError, match=r"expected at most 0\.001"):
            robokin.solve_ik(robot, T)
        return
    shell = np.array([solution["q"] for solution in json.loads(answer.out)["solutions"]])
    python = np.array([solution.q for solution in robokin.solve_ik(robot, T, limits=False).solutions])
    assert len(shell) > 0
    assert np.allclose(np.deg2rad(shell), python, atol=1e-9)


@pytest.mark.slow
def test_a_target_far_beyond_the_plane_of_an_arm_has_a_nearest_configuration(call):
    """At poses close by there is no complex solution either to begin a path from."""
    answer = call("ik", "planar2r", "--xyz", "1,-45,-0.6729246136411673", "--length", "cm", "--json")
    assert answer.status == 3
    assert answer.json["nearest"] is not None
