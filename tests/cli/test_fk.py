"""`robokin fk` on what is typed: the answer in every format, units, poses with names, frames, limits."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest
from conftest import data
from sweeps import sweep

import robokin
from robokin.spatial import (
    rotation_from_euler,
    rotation_from_quaternion,
    rotation_from_rpy,
)

from .conftest import poses_of, refused

Q = "10,-20,30,40,-50,60"
VALUES = [10.0, -20.0, 30.0, 40.0, -50.0, 60.0]
COLUMNS = {
    "rpy": ["roll", "pitch", "yaw"],
    "quaternion": ["qw", "qx", "qy", "qz"],
    "euler": ["phi", "theta", "psi"],
    "matrix": [f"m{i}{j}" for i in range(1, 5) for j in range(1, 5)],
}


def rotation(kind, values):
    """The rotation that an orientation's columns say, degrees where there are angles."""
    if kind == "matrix":
        return np.reshape(values, (4, 4))[:3, :3]
    if kind == "quaternion":
        return rotation_from_quaternion(values)
    return {"rpy": rotation_from_rpy, "euler": rotation_from_euler}[kind](np.radians(values))


# What is in a document -----------------------------------------------------------------------------------


def test_the_document_has_the_contract_s_keys(call):
    answer = call("fk", "puma560", "--q", Q, "-f", "json")
    assert (answer.status, answer.err) == (0, "")
    assert list(answer.json) == ["schema", "robot", "id", "units", "q", "within_limits", "pose"]
    assert list(answer.json["pose"]) == ["matrix", "position", "rpy", "quaternion"]
    assert answer.json["robot"] == "puma560"
    assert answer.json["units"] == {"length": "mm", "angle": "deg"}
    assert answer.json["q"] == VALUES
    assert answer.json["within_limits"] is True


def test_json_has_every_digit_of_what_the_package_computes(call):
    pose = call("fk", "puma560", "--q", Q, "--json").json["pose"]
    T = poses_of("puma560", VALUES)
    # numpy's sine of arrays may be another one than that of one number, in the last digit.
    np.testing.assert_allclose(pose["matrix"], T, rtol=1e-14, atol=1e-13)
    assert pose["position"] == [row[3] for row in pose["matrix"][:3]]


def test_the_numbers_are_python_s_own(call):
    text = call("fk", "puma560", "--q", "1e-7,0.1,1/3,0,0,0", "--json").text
    assert json.dumps(json.loads(text)["q"]) in text
    assert "1e-07, 0.1, 0.3333333333333333" in text


@pytest.mark.parametrize("kind", ["rpy", "quaternion"])
def test_the_orientations_are_the_matrix_in_other_words(call, kind):
    pose = call("fk", "puma560", "--q", Q, "--json").json["pose"]
    assert np.allclose(rotation(kind, pose[kind]), np.array(pose["matrix"])[:3, :3], atol=1e-14)


def test_as_euler_adds_the_euler_angles_to_a_document(call):
    pose = call("fk", "puma560", "--q", Q, "--json", "--as", "euler").json["pose"]
    assert list(pose) == ["matrix", "position", "rpy", "quaternion", "euler"]
    assert np.allclose(rotation("euler", pose["euler"]), np.array(pose["matrix"])[:3, :3], atol=1e-14)


@pytest.mark.parametrize("pose", data("lectures.json")["poses"], ids=lambda pose: pose["robot"])
def test_the_lectures_poses(call, pose):
    q = pose["q"] if isinstance(pose["q"], str) else ",".join(map(str, pose["q"]))
    document = call("fk", pose["robot"], *(["--q", q] if q else []), "--json").json
    assert [document["units"]["length"], document["units"]["angle"]] == pose["units"]
    if "matrix" in pose:
        assert np.allclose(document["pose"]["matrix"], pose["matrix"], rtol=0, atol=pose["tolerance"])
    else:
        assert np.allclose(document["pose"]["position"], pose["position"], rtol=0, atol=pose["tolerance"])


# How joint values are written ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    "text",
    [
        "10 -20 30 40 -50 60",
        "[10, -20, 30, 40, -50, 60]",
        "  10,-20 , 30,40,\t-50,60 ",
        "5*2,-(20),sqrt(900),atan2(40*0,1)+40,-50,min(60,70)",
        "10.0,-2e1,.3e2,40.,-50,60",
    ],
)
def test_a_vector_may_be_written_in_many_ways(call, text):
    assert call("fk", "puma560", "--q", text, "--json").out == call("fk", "puma560", "--q", Q, "--json").out


def test_a_vector_may_start_with_a_minus(call):
    assert call("fk", "puma560", "--q", "-90,0,90,0,0,0", "--json").json["q"][0] == -90
    assert call("fk", "puma560", "--q=-90,0,90,0,0,0", "--json").json["q"][0] == -90


def test_a_pose_has_a_name(call):
    named = call("fk", "puma560", "--q", "home", "--json")
    assert named.out == call("fk", "puma560", "--q", "90,0,90,0,0,0", "--json").out
    radians = call("fk", "puma560", "--q", "home", "--json", "--angle", "rad").json["q"]
    assert np.allclose(radians, [np.pi / 2, 0, np.pi / 2, 0, 0, 0], rtol=1e-15)


def test_a_robot_without_joints_needs_no_values(call):
    answer = call("fk", "assembly", "--json")
    assert (answer.status, answer.json["q"], answer.json["within_limits"]) == (0, [], True)
    assert call("fk", "assembly", "-f", "csv").columns == ["x", "y", "z", "roll", "pitch", "yaw"]


def test_options_may_come_before_the_robot(call):
    assert call("fk", "--q", Q, "--json", "puma560").out == call("fk", "puma560", "--q", Q, "--json").out


def test_a_path_is_a_robot_too(call, tmp_path):
    path = tmp_path / "arm.yaml"
    path.write_text("robokin: 1\nname: Arm\nunits: {angle: deg}\njoints:\n  - {type: R, a: 2}\n")
    document = call("fk", str(path), "--q", "90", "--json").json
    assert document["robot"] == "arm"
    assert document["pose"]["position"] == pytest.approx([0, 2, 0])


# Units and parameters ------------------------------------------------------------------------------------


def test_other_units_go_both_ways(call):
    own = call("fk", "scara", "--q", "90,45,100,30", "--json").json
    other = call(
        "fk", "scara", "--q", "pi/2,pi/4,0.1,pi/6", "--angle", "rad", "--length", "m", "--json"
    ).json  # fmt: skip
    assert other["units"] == {"length": "m", "angle": "rad"}
    assert np.allclose(np.array(own["pose"]["position"]) / 1000, other["pose"]["position"], atol=1e-15)
    assert np.allclose(np.radians(own["pose"]["rpy"]), other["pose"]["rpy"], atol=1e-15)
    assert np.allclose(own["pose"]["quaternion"], other["pose"]["quaternion"], atol=1e-15)


@pytest.mark.parametrize(("unit", "millimetres"), [("m", 1000.0), ("cm", 10.0), ("mm", 1.0), ("in", 25.4)])
def test_every_length_unit(call, unit, millimetres):
    own = call("fk", "puma560", "--q", Q, "--json").json
    other = call("fk", "puma560", "--q", Q, "--json", "--length", unit).json
    assert other["q"] == own["q"]
    assert np.allclose(np.array(other["pose"]["position"]) * millimetres, own["pose"]["position"], rtol=1e-14)


def test_set_overrides_a_parameter(call):
    pose = call("fk", "scara-frames", "--q", "0,0,0", "--set", "l1=500", "--set", "l2=l3/2", "--json").json["pose"]
    assert np.allclose(pose["matrix"], poses_of("scara-frames", [0, 0, 0], l1=500, l2="l3/2"), rtol=0, atol=0)
    assert pose["position"][2] == pytest.approx(500)


# Several configurations ----------------------------------------------------------------------------------


def test_several_configurations_make_a_list(call):
    answer = call("fk", "puma560", "--q", Q, "--q", "home", "--json")
    single = [call("fk", "puma560", "--q", q, "--json").json for q in (Q, "home")]
    assert [document["q"] for document in answer.json] == [document["q"] for document in single]
    assert [list(document) for document in answer.json] == [list(document) for document in single]
    for one, other in zip(answer.json, single, strict=True):
        assert np.allclose(one["pose"]["matrix"], other["pose"]["matrix"], rtol=0, atol=1e-12)


def test_json_lines_are_the_same_documents(call):
    lines = call("fk", "puma560", "--q", Q, "--q", "home", "-f", "jsonl").jsonl
    assert lines == call("fk", "puma560", "--q", Q, "--q", "home", "--json").json
    (one,) = call("fk", "puma560", "--q", Q, "-f", "jsonl").jsonl
    assert one == call("fk", "puma560", "--q", Q, "--json").json


@pytest.mark.parametrize("kind", [None, *COLUMNS])
def test_the_columns_of_a_csv(call, kind):
    chosen = [] if kind is None else ["--as", kind]
    answer = call("fk", "puma560", "--q", Q, "--q", "home", "-f", "csv", *chosen)
    kind = kind or "rpy"
    assert answer.columns == ["q1", "q2", "q3", "q4", "q5", "q6", "x", "y", "z", *COLUMNS[kind]]
    T = poses_of("puma560", [VALUES, [90, 0, 90, 0, 0, 0]])
    assert answer.numbers[:, :6].tolist() == [VALUES, [90, 0, 90, 0, 0, 0]]
    assert answer.numbers[:, 6:9].tolist() == T[:, :3, 3].tolist()
    for row, pose in zip(answer.numbers[:, 9:], T, strict=True):
        assert np.allclose(rotation(kind, row), pose[:3, :3], atol=1e-14)


def test_a_matrix_in_a_csv_is_the_whole_matrix(call):
    row = call("fk", "puma560", "--q", Q, "-f", "csv", "--as", "matrix").numbers[0]
    assert row[9:].tolist() == poses_of("puma560", VALUES).ravel().tolist()


def test_csv_and_json_say_the_same_numbers(call):
    row = call("fk", "puma560", "--q", Q, "-f", "csv").numbers[0].tolist()
    document = call("fk", "puma560", "--q", Q, "--json").json
    assert row[:6] == document["q"]
    said = [*document["pose"]["position"], *document["pose"]["rpy"]]
    np.testing.assert_allclose(row[6:], said, rtol=1e-14, atol=1e-13)  # see above


# Frames --------------------------------------------------------------------------------------------------


def test_frames_are_listed_on_demand(call):
    document = call("fk", "puma560", "--q", Q, "--frames", "--json").json
    assert list(document) == ["schema", "robot", "id", "units", "q", "within_limits", "pose", "frames"]
    assert [frame["name"] for frame in document["frames"]] == ["1", "2", "3", "4", "5", "6"]
    assert [list(frame) for frame in document["frames"]] == [["name", "matrix"]] * 6
    robot = robokin.load("puma560")
    links = robokin.link_frames(robot, np.radians(VALUES))[1:]
    links[:, :3, 3] /= 0.001
    assert np.allclose([frame["matrix"] for frame in document["frames"]], links, rtol=0, atol=1e-10)
    assert np.allclose(document["frames"][-1]["matrix"], document["pose"]["matrix"], rtol=0, atol=1e-10)


def test_frames_in_json_lines_and_in_arrays(call, tmp_path):
    frames = [d["frames"] for d in call("fk", "scara", "--q", "1,2,3,4", "--q", "0,0,0,0", "--frames", "--json").json]
    lines = call("fk", "scara", "--q", "1,2,3,4", "--q", "0,0,0,0", "--frames", "-f", "jsonl").jsonl
    assert [line["frames"] for line in lines] == frames
    path = tmp_path / "frames.npy"
    assert call("fk", "scara", "--q", "1,2,3,4", "--q", "0,0,0,0", "--frames", "-o", path).status == 0
    assert np.load(path).tolist() == [[frame["matrix"] for frame in one] for one in frames]


def test_frames_in_the_table(call):
    one = call("fk", "scara", "--q", "1,2,3,4", "--frames").text
    assert [line for line in one.splitlines() if line.startswith("frame")] == [f"frame {i}" for i in range(1, 5)]
    several = call("fk", "scara", "--q", "1,2,3,4", "--q", "0,0,0,0", "--frames").lines
    assert len([line for line in several if re.match(r" +(\d+ +)?(\d|hand)  x ", line)]) == 2 * 5


def test_a_csv_has_no_room_for_frames(call):
    refused(call("fk", "puma560", "--q", Q, "--frames", "-f", "csv"), "--frames", "expected", "jsonl")


# Limits --------------------------------------------------------------------------------------------------


def test_outside_the_limits_is_an_answer_with_a_warning(call):
    answer = call("fk", "puma560", "--q", "170,0,90,0,0,0", "--json")
    assert answer.status == 0
    assert answer.json["within_limits"] is False
    assert answer.err == "robokin: joint 1 (waist) = 170 deg is outside its limits -160 .. 160\n"


def test_the_warning_names_the_configuration_and_speaks_the_units(call):
    answer = call("fk", "scara", "--q", "0,0,0,0", "--q", "0,0,-0.1,0", "--angle", "rad", "--length", "m", "-f", "csv")
    assert answer.status == 0
    assert answer.err.startswith("robokin: configuration 2: joint 3")
    assert " = -0.1 m is outside its limits 0 .. " in answer.err


def test_a_value_just_outside_is_not_shown_as_the_limit(call):
    assert "= 160.0001 deg is outside" in call("fk", "puma560", "--q", "160.0001,0,0,0,0,0").err


@pytest.mark.parametrize("name", sweep(["puma560", "gen3", "panda", "ur5e", "scara", "stanford", "fr3", "rizon4"], 4))
@pytest.mark.parametrize("angle", ["deg", "rad"])
def test_limits_are_inclusive_as_they_are_printed(call, name, angle):
    rows = [row for row in call("show", name, "--json", "--angle", angle).json["rows"] if row["variable"]]
    printed = re.findall(r"(-?[\d.]+) \.\. (-?[\d.]+)", call("show", name, "--angle", angle).text)
    assert len(printed) == sum(row["limits"] is not None for row in rows)
    for ends in (0, 1):
        exact = ",".join("0" if row["limits"] is None else repr(row["limits"][ends]) for row in rows)
        limits = iter(printed)
        typed = ",".join("0" if row["limits"] is None else next(limits)[ends] for row in rows)
        for q in (exact, typed):
            answer = call("fk", name, "--q", q, "--json", "--angle", angle)
            assert (answer.err, answer.json["within_limits"]) == ("", True)


# Numbers -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("output", ["json", "jsonl", "csv", "table"])
def test_there_is_no_negative_zero(call, output):
    q = ["--q", "home", "--q", "-0.0,-0,0,-1e-320,-1e-9,0", "--q", "-90,90,-90,180,-180,-90"]
    for more in ([], ["--as", "euler"], ["--as", "quaternion"], ["--as", "matrix"]):
        text = call("fk", "puma560", *q, "-f", output, *more).text
        assert not re.search(r"(?<![\de])-0(\.0*)?(?![\d.e])", text), text


@pytest.mark.parametrize("kind", ["table", "json", "jsonl", "csv"])
def test_a_pose_too_far_for_a_number_is_refused(call, tmp_path, kind):
    path = tmp_path / "slides.yaml"
    path.write_text("robokin: 1\nname: Slides\njoints: [{type: P}, {type: P}]\n")
    refused(call("fk", path, "--q", "1e308,1e308", "-f", kind), "configuration 1", "too far away")
    answer = call("fk", path, "--q", "-", "-f", kind, stdin=b"1,2\n3,4\n1e308,1e308\n")
    refused(answer, "configuration 3", "too far away")


def test_the_largest_numbers_are_numbers(call):
    answer = call("fk", "cartesian", "--q", "1e300,-1e300,1e-300", "--json")
    assert answer.status == 0
    assert answer.json["q"] == [1e300, -1e300, 1e-300]


def test_the_table_shows_the_numbers_of_the_document(call):
    document = call("fk", "puma560", "--q", Q, "--json").json
    text = call("fk", "puma560", "--q", Q).text
    shown = [float(number) for number in re.findall(r"-?\d+(?:\.\d+)?", text.split("lengths in")[1])]
    matrix = np.array(document["pose"]["matrix"])[:3].ravel()
    said = [*matrix, *document["q"], *document["pose"]["position"], *document["pose"]["rpy"]]
    assert np.allclose(shown, [*said, *document["pose"]["quaternion"]], rtol=0, atol=5.1e-7)


def test_the_table_of_several_shows_the_numbers_of_the_csv(call):
    several = ["--q", Q, "--q", "home", "--q", "1,2,3,4,5,6"]
    for kind in ("rpy", "euler", "quaternion"):
        rows = call("fk", "puma560", *several, "-f", "csv", "--as", kind).numbers[:, 6:]
        lines = call("fk", "puma560", *several, "--as", kind).lines
        shown = np.array([line.split() for line in lines[4:]], dtype=float)
        assert lines[2].split() == ["#", "x", "y", "z", *COLUMNS[kind]]
        assert shown[:, 0].tolist() == [1, 2, 3]
        assert np.allclose(shown[:, 1:], rows, rtol=0, atol=5.1e-4)
