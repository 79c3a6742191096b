"""What one command writes another reads: every format, every orientation, every usual header."""

from __future__ import annotations

import io
import itertools
import json

import numpy as np
import pytest
from sweeps import sweep

from .conftest import refused

KINDS = ["rpy", "quaternion", "quaternion-xyzw", "euler", "rotvec", "abc", "wpr", "matrix"]
FORMATS = ["csv", "jsonl", "json", "npy"]
ROUND = [[0, 0, 0, 0, 0, 0], [90, 0, 90, 0, 0, 0], [0, -90, 180, 0, 0, 0], [10, 20, 30, 0, 90, 0]]


@pytest.fixture(scope="module")
def joints() -> list[list[float]]:
    drawn = np.random.default_rng(13).uniform(-90, 90, (4, 6))
    return [*drawn.tolist(), *ROUND]


def text(rows, header="", separator=",") -> bytes:
    lines = [separator.join(map(repr, row)) for row in rows]
    return ("\n".join([header, *lines] if header else lines) + "\n").encode()


@pytest.mark.parametrize(("kind", "form"), sweep(list(itertools.product(KINDS, FORMATS)), 4))
def test_there_and_back(call, tmp_path, joints, kind, form):
    """Law 6: fk's output is legal input to ik and the other way round, and is the same pose again."""
    poses, q, again = (tmp_path / f"{name}.{form}" for name in ("poses", "q", "again"))
    assert call("fk", "puma560", "-i", "-", "--as", kind, "-o", poses, stdin=text(joints)).status == 0
    # A file without a header is to be told: arrays have none.
    told = ["--as", kind] if form == "npy" and kind != "matrix" else []
    solved = call("ik", "puma560", "-i", poses, *told, "--no-limits", "-o", q)
    assert (solved.status, solved.err) == (0, "")
    assert call("fk", "puma560", "-i", q, "--as", "matrix", "-o", again).status == 0
    expected = call("fk", "puma560", "-i", "-", "--as", "matrix", "-f", "csv", stdin=text(joints)).numbers[:, 6:]
    expected = expected[:, -16:]
    if form == "npy":
        found = np.load(again).reshape(-1, 16)
    elif form == "csv":
        found = np.array([list(map(float, line.split(",")[-16:])) for line in again.read_text().splitlines()[1:]])
    else:
        documents = json.loads(again.read_text()) if form == "json" else map(json.loads, again.read_text().splitlines())
        found = np.array([np.ravel(document["pose"]["matrix"]) for document in documents])
    off = np.abs(found[:, None] - expected[None]).max(axis=2).min(axis=1)
    assert np.max(off) < 1e-6
    assert len({*np.abs(found[:, None] - expected[None]).max(axis=2).argmin(axis=1)}) >= len(joints) - 1


HEADERS = {
    "x,y,z,qx,qy,qz,qw": "quaternion-xyzw",
    "QX, QY, QZ, QW, X, Y, Z": None,
    "x,y,z,rx,ry,rz": "rotvec",
    "A,B,C,X,Y,Z": None,
    "x,y,z,w,p,r": "wpr",
    "px,py,pz,Roll,Pitch,Yaw": "rpy",
    "position.x,position.y,position.z,orientation.x,orientation.y,orientation.z,orientation.w": "quaternion-xyzw",
    "x_mm,y [mm],z (mm),roll_deg,pitch/deg,yaw [degrees]": "rpy",
}


@pytest.mark.parametrize(("header", "kind"), HEADERS.items(), ids=HEADERS)
@pytest.mark.parametrize("separator", sweep([",", ";", "\t"], 3))
def test_usual_headers(call, joints, header, kind, separator):
    poses = {}
    for way in KINDS:
        answer = call("fk", "puma560", "-i", "-", "--as", way, "-f", "csv", stdin=text(joints[:3]))
        poses |= dict(zip(answer.columns, answer.numbers.T.tolist(), strict=True))
    names = {"w": "W", "p": "P", "r": "R", "px": "x", "py": "y", "pz": "z"}
    wanted = []
    for cell in header.split(","):
        name = cell.strip().split("_")[0].split("/")[0].split(" ")[0].replace("position.", "")
        name = "q" + name[-1] if name.startswith("orientation.") else names.get(name, name)
        wanted.append(poses[name if name in poses else name.lower()])
    rows = [list(row) for row in zip(*wanted, strict=True)]
    solved = call(
        "ik", "puma560", "-i", "-", "-f", "jsonl", stdin=text(rows, header.replace(",", separator), separator)
    )
    expected = call("fk", "puma560", "-i", "-", "-f", "jsonl", stdin=text(joints[:3]))
    for answer, pose in zip(solved.jsonl, expected.jsonl, strict=True):
        assert answer["target"]["task"] == "pose"
        assert np.allclose(answer["target"]["matrix"], pose["pose"]["matrix"], rtol=0, atol=1e-9)
    if kind is not None:  # the same without the header
        bare = call("ik", "puma560", "-i", "-", "-f", "csv", "--as", kind, stdin=text(rows))
        assert bare.numbers_of("q1") == solved_numbers(solved)


def solved_numbers(answer) -> list[float]:
    return [one["q"][0] for document in answer.jsonl for one in document["solutions"]]


def test_units_of_a_header_are_converted(call):
    rows = b"q1 [rad],q2_deg,q3_m,q4 (rad)\npi/2,45,0.1,pi/6\n"
    other = b"90,45,100,30\n"
    first = call("fk", "scara", "-i", "-", "-f", "csv", stdin=rows)
    second = call("fk", "scara", "-i", "-", "-f", "csv", stdin=other)
    assert np.allclose(first.numbers, second.numbers, rtol=0, atol=1e-10)
    refused(call("fk", "scara", "-i", "-", stdin=b"q1_mm,q2,q3,q4\n1,2,3,4\n"), "unit mm", "'q1_mm'", "deg, rad")
    refused(
        call("fk", "scara", "-i", "-", stdin=b"q1,q2,q3_deg,q4\n1,2,3,4\n"), "unit deg", "expected a unit of lengths"
    )


WRONG_POSES = {
    "seven columns": (b"500,100,300,1,0,0,0\n", "line 1: found 7 values without a header", "quaternion-xyzw"),
    "seven columns with spaces": (b"500 100 300 1 0 0 0\n", "found 7 values without a header"),
    "seven in a list": (b"[500,100,300,1,0,0,0]\n", "line 1: found 7 values without a header"),
    "no such header": (b"a,b,c\n1,2,3\n", "found the columns a, b, c", "A, B, C", "m11 to m44", "qw, qx, qy, qz"),
    "half an orientation": (b"x,y,z,roll,pitch\n1,2,3,4,5\n", "with 'roll' also the others", "roll, pitch, yaw"),
    "twice": (b"x,y,z,X,roll,pitch,Yaw\n1,2,3,4,5,6,7\n", "x and X", "expected one of them"),
    "no quaternion": (b"x,y,z,qx,qy,qz,qw\n1,2,3,0,0,0,2\n", "line 2: found a quaternion of length 2"),
    "five": (b"1,2,3,4,5\n", "found 5 values, expected 6: x, y, z, roll, pitch, yaw"),
    "commas twice": (b"1,5 2,5 3,5\n", "found commas and spaces"),
    "both decimal signs": (b"1,5;2,5;3,5\n1,5;2.5;3,5\n", "line 2: found decimal commas and decimal points"),
    "thousands": (b"1.234,5;2,5;3,5\n", "line 1: ", "'1.234,5'"),
    "quoted comma": (b'"1,5","2,5",3\n', "found a comma in the number '1,5'", "semicolons"),
    "mixed tasks": (b"[1,2,3]\n[1,2,3,4,5,6]\n", "line 2: found a target of the task pose, expected position"),
    "an odd list": (b"[[1,0,0],[0,1,0],[0,0,1]]\n", "line 1: ", "3×3"),
}


@pytest.mark.parametrize(("data", "said"), [(data, said) for data, *said in WRONG_POSES.values()], ids=WRONG_POSES)
def test_what_may_be_two_things_is_refused(call, data, said):
    refused(call("ik", "puma560", "-i", "-", "-f", "csv", "--no-limits", stdin=data), *said)


def test_as_must_fit_the_header_and_the_count(call):
    rows = b"x,y,z,roll,pitch,yaw\n500,100,300,180,0,45\n"
    refused(call("ik", "puma560", "-i", "-", "--as", "abc", stdin=rows), "expected x, y, z, A, B, C, as --as abc says")
    refused(call("ik", "puma560", "-i", "-", "--as", "quat", stdin=b"1,2,3,4,5,6\n"), "found 6 values, expected 7")
    refused(call("ik", "puma560", "--xyz", "1,2,3", "--as", "abc"), "expected --input")
    for kind in ("quat", "quaternion"):
        q = call("ik", "puma560", "-i", "-", "--as", kind, "-f", "csv", stdin=b"500,100,300,0,1,0,0\n")
        assert q.numbers_of("q1") == call(
            "ik", "puma560", "--xyz", "500,100,300", "--rpy", "180,0,0", "-f", "csv"
        ).numbers_of("q1")


def test_positions_alone_are_a_task(call, tmp_path):
    expected = call("ik", "anthropomorphic", "--xyz", "0.5,0.2,0.4", "-f", "csv").text
    np.save(tmp_path / "p.npy", [[0.5, 0.2, 0.4]])
    for data in (
        b"x,y,z\n0.5,0.2,0.4\n",
        b"0.5,0.2,0.4\n",
        b"[0.5,0.2,0.4]",
        b'{"x":0.5,"y":0.2,"z":0.4}',
        b"z;x;y\n0,4;0,5;0,2\n",
    ):
        assert call("ik", "anthropomorphic", "-i", "-", "-f", "csv", stdin=data).text == expected
    assert call("ik", "anthropomorphic", "-i", tmp_path / "p.npy", "-f", "csv").text == expected
    solved = call("ik", "anthropomorphic", "--xyz", "0.5,0.2,0.4", "-f", "jsonl")
    assert call("ik", "anthropomorphic", "-i", "-", "-f", "csv", stdin=solved.out).text == expected


def test_other_joint_headers_are_refused_with_what_is_allowed(call):
    rows = b"1,2,3,4,5,6\n"
    answer = call("fk", "ur5e", "-i", "-", stdin=b"shoulder_pan_joint,shoulder_lift_joint,c,d,e,f\n" + rows)
    refused(answer, "found the columns shoulder_pan_joint", "expected q1, q2, q3, q4, q5, q6", "joint_1, theta1")
    refused(call("fk", "puma560", "-i", "-", stdin=b"a,b,c,d,e,f\n" + rows), "waist, shoulder, elbow")
    refused(call("fk", "puma560", "-i", "-", stdin=b"q0,q1,q2,q3,q4,q5\n" + rows), "expected q1, q2")
    # Columns of another arm, or numbered from 0, are not passed over.
    refused(call("fk", "puma560", "-i", "-", stdin=b"q1,q2,q3,q4,q5,q6,q7\n1,2,3,4,5,6,7\n"), "'q7'", "q1 to q6 alone")
    refused(
        call(
            "fk",
            "puma560",
            "-i",
            "-",
            stdin=b"joint_0,joint_1,joint_2,joint_3,joint_4,joint_5,joint_6\n1,2,3,4,5,6,7\n",
        ),
        "'joint_0'",
    )


# Targets in the plane -------------------------------------------------------------------------------------

PLANAR_TARGETS = [(0.9, 1.2, 90), (1, 0.8, -30), (0.3, -1.1, 200)]
IN_PLANE = {
    "x,y,phi": lambda x, y, phi: f"{x},{y},{phi}",
    "phi,y,x": lambda x, y, phi: f"{phi},{y},{x}",
    "X;Y;Phi [rad]": lambda x, y, phi: f"{x};{y};{phi}*pi/180",
    "x [cm],y [mm],phi": lambda x, y, phi: f"{100 * x},{1000 * y},{phi}",
}


@pytest.mark.parametrize("robot", ["planar2r", "planar3r", "planar3r-brac"])
@pytest.mark.parametrize("header", IN_PLANE)
def test_targets_in_the_plane_are_those_of_xy_and_phi(call, robot, header):
    scale = 30 if robot == "planar3r-brac" else 1
    targets = [(scale * x, scale * y, phi) for x, y, phi in PLANAR_TARGETS]
    rows = "\n".join([header, *(IN_PLANE[header](*target) for target in targets)]) + "\n"
    units = [] if robot != "planar3r-brac" else ["--length", "m"]
    found = call("ik", robot, "-i", "-", *units, "-f", "jsonl", stdin=rows.encode()).jsonl
    for (x, y, phi), document in zip(targets, found, strict=True):
        single = call("ik", robot, f"--xy={x},{y}", f"--phi={phi}", *units, "--json").json
        assert document["target"]["task"] == single["target"]["task"] == "pose"
        np.testing.assert_allclose(document["target"]["matrix"], single["target"]["matrix"], rtol=0, atol=1e-12)
        assert document["reachable"] == single["reachable"]
        np.testing.assert_allclose(*[[one["q"] for one in each["solutions"]] for each in (document, single)], atol=1e-6)


@pytest.mark.parametrize(
    "text",
    [
        b"x,y\n1,0.8\n0.3,-1.1\n", b"1,0.8\n0.3,-1.1\n", b"1 0.8\n0.3 -1.1\n", b"[1,0.8]\n[0.3,-1.1]\n",
        b"[[1,0.8],[0.3,-1.1]]", b"y,x\n0.8,1\n-1.1,0.3\n",
        b'{"x":1,"y":0.8}\n{"x":0.3,"y":-1.1}\n', b'{"position":[1,0.8]}\n{"position":[0.3,-1.1]}\n',
    ],
)  # fmt: skip
def test_a_place_in_the_plane_is_that_of_xy(call, tmp_path, text):
    found = call("ik", "planar2r", "-i", "-", "-f", "jsonl", stdin=text).jsonl
    assert found == [call("ik", "planar2r", f"--xy={place}", "-f", "jsonl").jsonl[0] for place in ("1,0.8", "0.3,-1.1")]
    path = tmp_path / "places.npy"
    np.save(path, np.array([[1, 0.8], [0.3, -1.1]]))
    assert call("ik", "planar2r", "-i", path, "-f", "jsonl").jsonl == found


def test_other_columns_go_through_beside_targets_in_the_plane(call):
    rows = b"id,phi,x,y,time\na,0,1,0.8,0.5\n"
    answer = call("ik", "planar3r", "-i", "-", "-f", "csv", stdin=rows)
    assert answer.columns[:3] == ["id", "time", "target"]
    assert answer.csv[1][:3] == ["a", "0.5", "1"]
    documents = b'{"id": 3, "x": 1, "y": 0.8, "phi": 0, "time": 2}\n'
    (first, *_) = call("ik", "planar3r", "-i", "-", "-f", "jsonl", stdin=documents).jsonl
    assert [*first.items()][:2] == [("input_id", 3), ("time", 2)]


def test_three_values_of_a_planar_arm_without_a_header_are_a_position(call):
    bare = call("ik", "planar2r", "-i", "-", "--json", stdin=b"1,0.8,0\n").json
    assert bare == call("ik", "planar2r", "-i", "-", "--json", stdin=b"x,y,z\n1,0.8,0\n").json
    assert bare[0]["target"]["task"] == "position"
    poses = call("fk", "planar2r", "--q", "10,20", "-f", "csv")
    assert call("ik", "planar2r", "-i", "-", "-f", "jsonl", stdin=poses.out).jsonl[0]["target"]["task"] == "pose"


@pytest.mark.parametrize(
    ("robot", "text", "fragments"),
    [
        ("planar3r", "x,y,z,phi\n1,1,0,1\n", ["line 1", "with 'phi' also", "x, y, phi of a planar arm"]),
        ("planar3r", "x,y,phi,theta,psi\n1,1,1,1,1\n", ["line 1", "with 'phi' also"]),
        ("planar3r", "x,y,yaw\n1,1,1\n", ["line 1", "with 'yaw' also"]),
        ("planar3r", "x,phi\n1,1\n", ["line 1", "with 'phi' also"]),
        ("planar3r", "x,y,phi,phi\n1,1,1,1\n", ["line 1", "'phi' twice"]),
        ("planar3r", "x,y,phi [mm]\n1,1,1\n", ["line 1", "unit mm", "deg, rad"]),
        ("planar3r", "x,y,phi\n1,1,nan\n", ["line 2", "'nan'"]),
        ("planar3r", "x,y,phi\n0,1,1\n1e300,1,1\n", ["line 3", "too far away"]),
        ("planar3r", "x,y,phi\n1,1\n", ["line 2", "found 2 values, expected 3"]),
        ("planar3r", "1,1\n1,1,1\n", ["line 2", "found 3 values, expected 2"]),
        ("planar3r", '{"position": [1, 1], "rpy": [0, 0, 1]}\n', ["line 1", "found 5 numbers", "expected 6"]),
        ("planar3r", '{"x": 1, "y": 1}\n{"x": 1, "y": 1, "phi": 3}\n', ["line 2", "task pose"]),
        ("puma560", "x,y,phi\n1,1,1\n", ["line 1", "with 'phi' also"]),
        ("puma560", "x,y\n1,1\n", ["line 1", "found the columns x, y, expected"]),
        ("puma560", "1,1\n", ["line 1", "found 2 values, expected 6"]),
    ],
)
def test_what_is_no_target_in_the_plane(call, robot, text, fragments):
    refused(call("ik", robot, "-i", "-", stdin=text.encode()), *fragments)


def test_as_says_that_a_target_is_a_whole_pose(call, tmp_path):
    refused(call("ik", "planar3r", "-i", "-", "--as", "rpy", stdin=b"x,y,phi\n1,1,1\n"), "line 1", "as --as rpy says")
    refused(call("ik", "planar3r", "-i", "-", "--as", "rpy", stdin=b"1,1\n"), "line 1", "found 2 values, expected 6")
    np.save(tmp_path / "places.npy", np.ones((3, 2)))
    for words in (["planar3r", "--as", "rpy"], ["puma560"]):
        refused(call("ik", *words, "-i", tmp_path / "places.npy"), "shape (3, 2)")


def test_a_plane_that_is_not_that_of_x_and_y_and_a_tool_that_is_upright(call, tmp_path):
    path = tmp_path / "arm.yaml"
    rows = "joints: [{type: R, a: 1}, {type: R, a: 1}]\nunits: {length: m, angle: deg}\n"
    path.write_text(f"robokin: 1\nname: Upright tool\n{rows}tool: Rot(y, 90)\n")
    refused(call("ik", path, "-i", "-", stdin=b"x,y,phi\n1,1,0\n"), "line 1", "'phi'", "upright", "x, y alone")
    assert call("ik", path, "-i", "-", stdin=b"x,y\n1,1\n").status == 0
    path.write_text(f"robokin: 1\nname: Standing arm\n{rows}base: Rot(x, 90)\n")
    refused(call("ik", path, "-i", "-", stdin=b"x,y\n1,1\n"), "line 1", "x, y, expected")


# Columns that are not understood -------------------------------------------------------------------------

CARRIED = b'time,q2,q1,id,note\n0.10,20,10,007,"a, ""b"""\n0.5,-40,30,#1,ok\n'


def test_other_columns_go_through_in_front(call):
    answer = call("fk", "planar2r", "-i", "-", "-f", "csv", stdin=CARRIED)
    assert answer.columns[:5] == ["time", "id", "note", "q1", "q2"]
    assert [row[:5] for row in answer.csv[1:]] == [
        ["0.10", "007", 'a, "b"', "10.0", "20.0"],
        ["0.5", "#1", "ok", "30.0", "-40.0"],
    ]
    first, second = call("fk", "planar2r", "-i", "-", "-f", "jsonl", stdin=CARRIED).jsonl
    assert list(first)[:6] == ["time", "input_id", "note", "schema", "robot", "id"]
    assert (first["time"], first["input_id"], first["note"]) == (0.1, "007", 'a, "b"')
    assert (first["schema"], first["robot"], first["id"]) == (1, "planar2r", "planar2r")
    assert (second["time"], second["q"]) == (0.5, [30.0, -40.0])
    assert call("fk", "planar2r", "-i", "-", "--json", stdin=CARRIED).json == [first, second]
    assert call("fk", "planar2r", "-i", "-", stdin=CARRIED).status == 0


def test_they_go_through_the_whole_pipe(call):
    poses = call("fk", "planar2r", "-i", "-", "-f", "csv", stdin=CARRIED)
    solved = call("ik", "planar2r", "-i", "-", "-f", "csv", stdin=poses.out)
    assert solved.columns[:6] == ["time", "id", "note", "target", "solution", "q1"]
    again = call("fk", "planar2r", "-i", "-", "-f", "csv", stdin=solved.out)
    assert again.columns == poses.columns
    assert [row[:3] for row in again.csv] == [row[:3] for row in poses.csv]
    jacobians = call("jacobian", "planar2r", "-i", "-", "-f", "csv", stdin=solved.out)
    assert [row[:3] for row in jacobians.csv] == [row[:3] for row in poses.csv]
    documents = call("fk", "planar2r", "-i", "-", "-f", "jsonl", stdin=CARRIED)
    solved = call("ik", "planar2r", "-i", "-", "-f", "jsonl", stdin=documents.out)
    again = call("fk", "planar2r", "-i", "-", "-f", "csv", stdin=solved.out)
    assert again.columns == poses.columns
    assert [row[1:3] for row in again.csv] == [row[1:3] for row in poses.csv]


def test_each_solution_of_a_target_has_its_cells(call):
    rows = b"id,x,y,z\na,1,0.8,0\nb,5,5,0\nc,1.2,0.3,0\n"
    answer = call("ik", "planar2r", "-i", "-", "-f", "csv", stdin=rows)
    assert answer.status == 3
    assert [row[:3] for row in answer.csv[1:]] == [
        ["a", "1", "1"], ["a", "1", "2"], ["b", "2", "0"], ["c", "3", "1"], ["c", "3", "2"],
    ]  # fmt: skip
    documents = call("ik", "planar2r", "-i", "-", "--json", stdin=rows).json
    assert [document["input_id"] for document in documents] == ["a", "b", "c"]
    assert {document["id"] for document in documents} == {"planar2r"}


COMMANDS_OF_ROWS = ["fk", "ik", "jacobian"]


@pytest.mark.parametrize("command", COMMANDS_OF_ROWS)
def test_a_document_keeps_its_own_keys_beside_those_of_the_input(call, command):
    """Whatever the columns are called: what a document says of itself is what it says without them."""
    values = b"1,0.8,0" if command == "ik" else b"10,20"
    names = b"x,y,z" if command == "ik" else b"q1,q2"
    (plain,) = call(command, "planar2r", "-i", "-", "-f", "jsonl", stdin=names + b"\n" + values + b"\n").jsonl
    own = [name for name in plain if name not in ("q", "pose")]
    rows = ",".join([*own, names.decode()]) + "\n" + "7," * len(own) + values.decode() + "\n"
    answer = call(command, "planar2r", "-i", "-", "-f", "jsonl", stdin=rows.encode())
    assert answer.jsonl == [{"input_id": 7} | plain]
    left_out = [line for line in answer.err.splitlines() if "is left out" in line]
    assert len(left_out) == len(own) - 1


@pytest.mark.parametrize(
    ("header", "keys"),
    [
        ("id", ["input_id"]),
        ("id,input_id", ["input_input_id", "input_id"]),
        ("input_id,id,time", ["input_id", "input_input_id", "time"]),
        ("input_id", ["input_id"]),
        ("id,input_id,input_input_id", ["input_input_input_id", "input_id", "input_input_id"]),
    ],
)
@pytest.mark.parametrize("form", ["json", "jsonl"])
def test_an_id_has_another_name_in_documents_and_its_own_behind_them(call, header, keys, form):
    cells = [str(i) for i in range(5, 5 + len(keys))]
    rows = f"{header},q1,q2\n{','.join(cells)},10,20\n{','.join(cells)},30,40\n".encode()
    documents = call("fk", "planar2r", "-i", "-", "-f", form, stdin=rows)
    first = (documents.json if form == "json" else documents.jsonl)[0]
    assert [(name, str(first[name])) for name in list(first)[: len(keys)]] == [*zip(keys, cells, strict=True)]
    again = call("jacobian", "planar2r", "-i", "-", "-f", form, stdin=documents.out)
    second = (again.json if form == "json" else again.jsonl)[0]
    assert [*second.items()][: len(keys)] == [*first.items()][: len(keys)]
    if "id" in header.split(","):
        table = call("ik", "planar2r", "-i", "-", "-f", "csv", stdin=documents.out)
        assert table.columns[: len(keys)] == header.split(",")
        assert table.csv[1][: len(keys)] == cells


def test_an_id_of_any_value_of_json_goes_through(call):
    given = [7, None, "a", {"b": [1]}, "planar2r", True]
    rows = "".join(json.dumps({"id": value, "q": [10, 20]}) + "\n" for value in given).encode()
    documents = call("fk", "planar2r", "-i", "-", "-f", "jsonl", stdin=rows)
    assert [document["input_id"] for document in documents.jsonl] == given
    again = call("jacobian", "planar2r", "-i", "-", "-f", "jsonl", stdin=documents.out)
    assert [document["input_id"] for document in again.jsonl] == given
    older = b'{"id": 7, "schema": 1, "robot": "planar2r", "q": [10, 20]}\n'  # with no id of its own
    assert call("jacobian", "planar2r", "-i", "-", "-f", "jsonl", stdin=older).jsonl[0]["input_id"] == 7


def test_drop_leaves_them_out(call):
    plain = b"q1,q2\n10,20\n30,-40\n"
    for command in ("fk", "jacobian"):
        for form in ("csv", "jsonl"):
            assert (
                call(command, "planar2r", "-i", "-", "--drop", "-f", form, stdin=CARRIED).out
                == call(command, "planar2r", "-i", "-", "-f", form, stdin=plain).out
            )
    poses = call("fk", "planar2r", "-i", "-", "-f", "csv", stdin=CARRIED).out
    assert call("ik", "planar2r", "-i", "-", "--drop", "-f", "csv", stdin=poses).columns[0] == "target"


def test_a_name_that_the_output_has_is_left_out_and_said(call):
    answer = call("ik", "planar2r", "-i", "-", "-f", "csv", stdin=b"reason,x,y,z\nwhy,1,0.8,0\n")
    assert answer.columns[0] == "target"
    assert "the column 'reason' is left out" in answer.err
    answer = call("fk", "planar2r", "-i", "-", "-f", "csv", stdin=b'{"t":1,"q":[1,2]}\n{"t":2,"u":3,"q":[1,2]}\n')
    assert [row[0] for row in answer.csv] == ["t", "1", "2"]
    assert "the key 'u' is left out" in answer.err


def test_plain_blocks_and_others_pass_the_same_cells(call):
    """A block of nothing but numbers is read in another way than one with a comment."""
    rows = "".join(f"{i / 7!r},{i},{-i},{i:03}\n" for i in range(60))
    plain = call("fk", "planar2r", "-i", "-", "-f", "csv", stdin=f"t,q1,q2,n\n{rows}".encode())
    slow = call("fk", "planar2r", "-i", "-", "-f", "csv", stdin=f"t,q1,q2,n\n{rows}# end\n".encode())
    assert plain.out == slow.out
    assert plain.csv[8][:2] == ["1.0", "007"]


# Branches, aliases ---------------------------------------------------------------------------------------


def test_a_line_of_ik_can_be_split_at_its_commas(call):
    answer = call("ik", "puma560", "--xyz", "500,100,300", "--rpy", "180,0,45", "-f", "csv")
    for line, row in zip(answer.lines, answer.csv, strict=True):
        assert line.split(",") == row
    assert answer.csv[1][8] == "shoulder left / elbow up / wrist flip"
    document = call("ik", "puma560", "--xyz", "500,100,300", "--rpy", "180,0,45", "--json").json
    assert document["solutions"][0]["branch"] == "shoulder left, elbow up, wrist flip"


def test_quaternion_is_quat(call):
    target = ["ik", "puma560", "--xyz", "500,100,300"]
    for option in (["--quaternion", "0,1,0,0"], ["--quaternion=0,1,0,0"]):
        assert call(*target, *option, "--json").out == call(*target, "--quat", "0,1,0,0", "--json").out
    assert (
        call("fk", "puma560", "--q", "home", "--as", "quat").out
        == call("fk", "puma560", "--q", "home", "--as", "quaternion").out
    )


# JSON ----------------------------------------------------------------------------------------------------

POSES = {
    "a list of documents": '[\n{{"pose": {{"matrix": {m}}}}}\n]',
    "on one line": '[{{"matrix": {m}}}]',
    "position and quaternion": '{{"position": [500, 100, 300], "quaternion": [0, 1, 0, 0]}}',
    "position and rpy": '{{"pose": {{"position": [500, 100, 300], "rpy": [180, 0, 0]}}, "units": {{"angle": "deg"}}}}',
    "names": '{{"x": 500, "y": 100, "z": 300, "qw": 0, "qx": 1, "qy": 0, "qz": 0}}',
    "names with units": '{{"x_m": 0.5, "y_mm": 100, "z [cm]": 30, "roll": 180, "pitch": 0, "yaw": 0}}',
    "a row": "[500, 100, 300, 180, 0, 0]",
    "rows": "[[500, 100, 300, 180, 0, 0]]",
    "a pretty document": '{{\n  "target": {{\n "matrix": {m}, "task": "pose"}}\n}}\n',
}


@pytest.mark.parametrize("form", POSES.values(), ids=POSES)
def test_documents_of_poses(call, form):
    matrix = [[1, 0, 0, 500], [0, -1, 0, 100], [0, 0, -1, 300], [0, 0, 0, 1]]
    expected = call("ik", "puma560", "--matrix", json.dumps(matrix), "-f", "csv").text
    answer = call("ik", "puma560", "-i", "-", "-f", "csv", stdin=form.format(m=matrix).encode())
    assert (answer.err, answer.text) == ("", expected)


WRONG_TEXTS = {
    "not closed": (b"[\n[1,2],\n[3,4]\n", "this is not JSON"),
    "no comma": (b"[\n[1,2]\n[3,4]\n]\n,", "found more after the end"),
    "a word": (b"[\n[1,2],\nx\n]", "line 3: this is not JSON"),
    "after the end": (b'{\n"q": [1, 2]\n}\n[1,2]\n', "found more after the end"),
    "deep": (b"[\n" + b"[" * 100_000, "this is not JSON"),
    "endless": (b"[\n[1" + b" " * (3 << 20), "longer than"),
}


@pytest.mark.parametrize(("data", "said"), WRONG_TEXTS.values(), ids=WRONG_TEXTS)
def test_texts_that_are_no_json(call, tmp_path, data, said):
    refused(call("fk", "planar2r", "-i", "-", "-o", tmp_path / "x.csv", stdin=data), said)


# Arrays --------------------------------------------------------------------------------------------------


def header(text: str, version: tuple[int, int] = (1, 0)) -> bytes:
    size = 2 if version == (1, 0) else 4
    body = text.encode() + b" " * (-(len(text) + 8 + size + 1) % 64) + b"\n"
    return b"\x93NUMPY" + bytes(version) + len(body).to_bytes(size, "little") + body


def described(shape: str, descr: str = "'<f8'", fortran: str = "False") -> str:
    return f"{{'descr': {descr}, 'fortran_order': {fortran}, 'shape': {shape}, }}"


FULL = np.arange(4.0).tobytes()
BAD_ARRAYS = {
    "a negative count": (header(described("(-1, 2)")) + FULL, "shape (-1, 2)"),
    "two negative counts": (header(described("(-2, -2)")) + FULL, "shape (-2, -2)"),
    "a truth as a count": (header(described("(True, 2)")) + FULL[:16], "shape (True, 2)"),
    "bytes behind": (header(described("(2, 2)")) + FULL + b"\0", "more bytes behind its 2 rows"),
    "another array behind": (header(described("(2, 2)")) + FULL + header(described("(2, 2)")) + FULL, "more bytes"),
    "no rows and bytes": (header(described("(0, 2)")) + FULL, "more bytes behind its 0 rows"),
    "bytes behind Fortran": (header(described("(2, 2)", fortran="True")) + FULL + b"\0", "more bytes"),
    "too short": (header(described("(2, 2)")) + FULL[:-1], "ends before its 2 rows"),
    "huge": (header(described(f"({10**30}, 2)")) + FULL, "ends before its"),
    "huge Fortran": (header(described(f"({10**30}, 2)", fortran="True")) + FULL, "expected"),
    "no list": (header(described("2")) + FULL, "no .npy file"),
    "a half count": (header(described("(2.0, 2)")) + FULL, "no .npy file"),
    "objects": (header(described("(2, 2)", "'|O'")) + FULL, "type object"),
    "texts": (header(described("(2, 2)", "'<U1'")) + FULL, "type <U1"),
    "nan": (header(described("(2, 2)")) + np.array([[0, 1], [np.nan, 0]]).tobytes(), "row 2: ", "not finite"),
    "nan in a block": (header(described("(1, 2, 2)")) + np.array([[0, 1], [np.nan, 0]]).tobytes(), "row 2: "),
    "too great": (header(described("(1, 2)", "'<f16'")) + np.full(2, np.longdouble("1e4000")).tobytes(), "not finite"),
    "a version of tomorrow": (header(described("(2, 2)"), (4, 0)) + FULL, "no .npy file"),
    "a header without end": (b"\x93NUMPY\x02\x00\xff\xff\xff\xff" + b" " * 100, "header is longer"),
    "a header that is code": (header("__import__('os').system('true')") + FULL, "no .npy file"),
    "a header that adds": (header(described("(1, 1 + 1)")) + FULL, "header holds more than plain values)"),
    "a header of one word": (header("'" + "x" * 9000 + "'") + FULL, "not a dictionary: 'xxx", "...), expected"),
    "a type of many names": (
        header(described("(2, 2)", repr([(f"a{i}", "<f8") for i in range(400)]))),
        "..., expected",
    ),
    "a shape of many counts": (header(described(str((0,) * 2000))), "shape (0, 0,", "..., expected"),
    "an odd escape": (header("{'descr': '\\d'}") + FULL, "no .npy file"),
    "nothing": (b"\x93NUMPY", "no .npy file"),
    "cut in the header": (header(described("(2, 2)"))[:40], "no .npy file"),
}


@pytest.mark.parametrize(("data", "said"), [(data, said) for data, *said in BAD_ARRAYS.values()], ids=BAD_ARRAYS)
def test_an_array_is_checked_whole(call, tmp_path, data, said):
    path = tmp_path / "q.npy"
    path.write_bytes(data)
    refused(call("fk", "planar2r", "-i", path, "-o", tmp_path / "out.csv"), *said)
    refused(call("fk", "planar2r", "-i", "-", "-o", tmp_path / "out.csv", stdin=data), *said)
    assert not (tmp_path / "out.csv").exists()


@pytest.mark.parametrize("dtype", ["<f8", ">f8", "<f4", ">i4", "<u2", "<f2", "|i1", "<f16"])
@pytest.mark.parametrize("fortran", sweep([False, True], 2))
@pytest.mark.parametrize("version", [(1, 0), (2, 0), (3, 0)])
def test_arrays_of_every_kind(call, tmp_path, dtype, fortran, version):
    q = np.array([[10, 20], [30, 40], [0, 5]]).astype(dtype)
    stream = io.BytesIO()
    np.lib.format.write_array(stream, np.asfortranarray(q) if fortran else q, version=version)
    expected = call("fk", "planar2r", "-i", "-", "-f", "csv", stdin=b"10,20\n30,40\n0,5\n").out
    (tmp_path / "q.npy").write_bytes(stream.getvalue())
    assert call("fk", "planar2r", "-i", tmp_path / "q.npy", "-f", "csv").out == expected
    assert call("fk", "planar2r", "-i", "-", "-f", "csv", stdin=stream.getvalue()).out == expected


@pytest.mark.slow
def test_arrays_of_poses_in_fortran_order(call, tmp_path):
    call("fk", "puma560", "-i", "-", "-o", tmp_path / "T.npy", stdin=text(ROUND[1:3]))
    T = np.load(tmp_path / "T.npy")
    expected = call("ik", "puma560", "-i", tmp_path / "T.npy", "-f", "csv").out
    for shape in ((2, 4, 4), (2, 16)):
        np.save(tmp_path / "F.npy", np.asfortranarray(T.reshape(shape)))
        assert call("ik", "puma560", "-i", tmp_path / "F.npy", "-f", "csv").out == expected
    np.save(tmp_path / "one.npy", np.asfortranarray(T[0]))
    np.save(tmp_path / "one_c.npy", T[0])
    assert (
        call("ik", "puma560", "-i", tmp_path / "one.npy", "-f", "csv").out
        == call("ik", "puma560", "-i", tmp_path / "one_c.npy", "-f", "csv").out
    )


def test_solutions_padded_with_nan_are_read(call, tmp_path):
    rows = b"x,y,z\n1,0.8,0\n5,5,0\n1.2,0.3,0\n"
    call("ik", "planar2r", "-i", "-", "-o", tmp_path / "q.npy", stdin=rows)
    answer = call("fk", "planar2r", "-i", tmp_path / "q.npy", "-f", "csv")
    assert np.allclose(answer.numbers[:, 2:4], [[1, 0.8], [1, 0.8], [1.2, 0.3], [1.2, 0.3]])
