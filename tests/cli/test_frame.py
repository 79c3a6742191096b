"""`robokin frame`: the lectures' transforms, in every form."""

from __future__ import annotations

import re

import numpy as np
import pytest
from conftest import data

from robokin.spatial import rotation_from_axis_angle, rotation_from_euler, rotation_from_quaternion, rotation_from_rpy

from .conftest import refused

LECTURES = data("lectures.json")
KEYS = [
    "schema", "expression", "id", "units", "matrix", "n", "s", "a", "p", "position", "rpy", "euler", "quaternion",
    "axis_angle", "rotvec",
]  # fmt: skip
H = "Trans(4,-3,7) Rot(y,90) Rot(z,90)"


@pytest.mark.parametrize("example", LECTURES["transforms"], ids=lambda example: example["name"])
def test_the_lectures_transforms(call, example):
    answer = call("frame", example["expression"], "--json")
    assert (answer.status, answer.err) == (0, "")
    assert np.allclose(answer.json["matrix"], example["matrix"], rtol=0, atol=1e-14)


@pytest.mark.parametrize("example", LECTURES["points"], ids=lambda example: example["name"])
def test_the_lectures_points(call, example):
    point = ",".join(map(str, example["point"]))
    answer = call("frame", example["expression"], "--point", point, "--json")
    assert np.allclose(answer.json["point"], example["result"], rtol=0, atol=1e-13)


def test_a_displacement_of_a_frame(call):
    """H3 = H D, once as a product and once by --of."""
    product = next(example for example in LECTURES["transforms"] if example["name"] == "H3 = H D")
    first, _, rest = product["expression"].partition(" Rot(")
    assert np.allclose(
        call("frame", first, "--of", f"Rot({rest}", "--json").json["matrix"], product["matrix"], atol=1e-14
    )


def test_the_document_has_every_form(call):
    document = call("frame", H, "--json").json
    assert list(document) == KEYS
    assert document["expression"] == H
    assert document["units"] == {"length": "m", "angle": "deg"}
    T = np.array(document["matrix"])
    assert [document[letter] for letter in "nsap"] == T[:3].T.tolist()
    assert document["position"] == document["p"] == [4, -3, 7]
    turn = document["axis_angle"]
    assert turn["angle"] == pytest.approx(120)
    rotations = [
        rotation_from_rpy(np.radians(document["rpy"])),
        rotation_from_euler(np.radians(document["euler"])),
        rotation_from_quaternion(document["quaternion"]),
        rotation_from_axis_angle(turn["axis"], np.radians(turn["angle"])),
    ]
    for R in rotations:
        assert np.allclose(R, T[:3, :3], atol=1e-14)


def test_the_inverse(call):
    T = np.array(call("frame", H, "--json").json["matrix"])
    for form in (["frame", H, "--inverse"], ["frame", f"Inv({H})"]):
        assert np.allclose(call(*form, "--json").json["matrix"], np.linalg.inv(T), atol=1e-14)
    assert np.allclose(call("frame", H, "--inverse", "--of", H, "--json").json["matrix"], np.eye(4), atol=1e-14)


def test_nothing_is_the_identity(call):
    for text in ("", "  "):
        assert call("frame", text, "--json").json["matrix"] == np.eye(4).tolist()


def test_units_go_both_ways(call):
    own = call("frame", "Trans(1,2,3) Rot(z,30)", "--point", "1,0,0", "--json").json
    other = call(
        "frame", "Trans(1,2,3) Rot(z,pi/6)", "--point", "1,0,0", "--angle", "rad", "--length", "mm", "--json"
    ).json
    assert other["units"] == {"length": "mm", "angle": "rad"}
    assert np.allclose(other["matrix"], own["matrix"], atol=1e-14)
    assert np.allclose(other["point"], own["point"], atol=1e-14)
    assert np.allclose(other["rpy"], np.radians(own["rpy"]), atol=1e-15)
    assert other["axis_angle"]["angle"] == pytest.approx(np.pi / 6)


@pytest.mark.parametrize(
    ("kind", "columns"),
    [(None, "roll pitch yaw"), ("rpy", "roll pitch yaw"), ("euler", "phi theta psi"), ("quaternion", "qw qx qy qz")],
)
def test_a_row_of_csv(call, kind, columns):
    answer = call("frame", H, "-f", "csv", *(["--as", kind] if kind else []))
    assert answer.columns == ["x", "y", "z", *columns.split()]
    document = call("frame", H, "--json").json
    assert answer.numbers[0].tolist() == [*document["position"], *document[kind or "rpy"]]


def test_a_row_of_csv_with_a_point_or_a_matrix(call):
    answer = call("frame", "Rot(z,90)", "--point", "7,3,0", "-f", "csv")
    assert answer.columns[-3:] == ["point_x", "point_y", "point_z"]
    assert np.allclose(answer.numbers[0, -3:], [-3, 7, 0])
    row = call("frame", H, "-f", "csv", "--as", "matrix").numbers[0]
    assert row[3:].reshape(4, 4).tolist() == call("frame", H, "--json").json["matrix"]


def test_an_array(call, tmp_path):
    assert call("frame", H, "-o", tmp_path / "T.npy").status == 0
    assert np.load(tmp_path / "T.npy").tolist() == call("frame", H, "--json").json["matrix"]
    assert call("frame", H, "-o", tmp_path / "q.npy", "--as", "quaternion").status == 0
    assert np.load(tmp_path / "q.npy").shape == (7,)
    refused(call("frame", H, "--point", "1,2,3", "-o", tmp_path / "p.npy"), "--point", "expected another format")


def test_json_lines(call):
    assert call("frame", H, "-f", "jsonl").jsonl == [call("frame", H, "--json").json]


def test_the_table_shows_the_document(call):
    expression = "Trans(1,-2/3,3) RPY(10,20,30)"
    document = call("frame", expression, "--point", "1,2,3", "--json").json
    text = call("frame", expression, "--point", "1,2,3").text
    turn = document["axis_angle"]
    said = np.array(document["matrix"])[:3].ravel().tolist()
    for part in ("position", "rpy", "euler", "quaternion"):
        said += document[part]
    said += [*turn["axis"], turn["angle"], *document["point"]]
    shown = [float(number) for number in re.findall(r"-?\d+(?:\.\d+)?", text.split("angles in deg")[1])]
    assert np.allclose(shown, said, rtol=0, atol=5.1e-7)


@pytest.mark.parametrize(
    "expression", [H, "Rot(z,180)", "Rot(y,-90)", "Rot(x,360)", "Inv(Trans(0,0,1))", "Euler(0,0,-0)"]
)
def test_there_is_no_negative_zero(call, expression):
    for more in (["--json"], ["-f", "csv"], []):
        text = call("frame", expression, "--point", "0,-0,0", *more).text
        numbers = text.replace(expression, "")
        assert not re.search(r"(?<![\de])-0(\.0*)?(?![\d.e])", numbers), text


def test_a_matrix_in_print_is_made_a_rotation_with_a_note(call):
    answer = call("frame", "Matrix([[0.866,-0.5,0,1],[0.5,0.866,0,2],[0,0,1,3],[0,0,0,1]])", "--json")
    assert answer.status == 0
    assert "nearest rotation" in answer.err
    R = np.array(answer.json["matrix"])[:3, :3]
    assert np.allclose(R @ R.T, np.eye(3), atol=1e-15)


@pytest.mark.parametrize(
    ("arguments", "fragments"),
    [
        (["Trn(1,2,3)"], ["'Trn'", "did you mean 'Trans'"]),
        (["Trans(1,2)"], ["expected Trans(x, y, z)"]),
        (["Trans(1,2,3"], ["expected ')'"]),
        (["Rot(w,90)"], ["expected x, y, z"]),
        (["Rot(z,pi/2)"], ["pi", "deg(pi/2)"]),
        (["Rot([0,0,0],90)"], ["zero", "expected a direction"]),
        (["Quat(1,1,0,0)"], ["length", "expected 1"]),
        (["Matrix([[1,0],[0,1]])"], ["expected 4×4"]),
        (["Matrix([[1,0,0,0],[0,1,0,0],[0,0,-1,0],[0,0,0,1]])"], ["expected a rotation"]),
        (["Trans(1,2,nan)"], ["'nan'"]),
        (["Trans(1e999,0,0)"], ["too large"]),
        (["Trans(1e308,0,0) Trans(1e308,0,0)"], ["too ", "expected"]),
        (["Rot(z,45)", "--point", "1.7e308,1.7e308,0"], ["too far"]),
        ([H, "--of", "Trans(1,2)"], ["--of", "expected Trans(x, y, z)"]),
        ([H, "--point", "1,2"], ["--point", "found 2 values", "expected 3"]),
        ([H, "--point", "1,2,x"], ["--point", "value 3 of 3", "'x'"]),
        ([H, H], ["at the end", "expected nothing more"]),
        ([H, "--angle", "grad"], ["--angle", "expected rad or deg"]),
        (["Rot(z,90);Rot(x,90)"], ["expected"]),
        ([f"{'Inv(' * 60}{')' * 60}"], ["nest"]),
        (["x" * 20_000], ["characters"]),
    ],
)
def test_what_is_no_transform(call, arguments, fragments):
    refused(call("frame", *arguments), *fragments)


# The way to another frame --------------------------------------------------------------------------------------------

FIRST, SECOND = "Trans(1,0,0) Rot(x,20)", "Trans(0,2,1) Rot(z,90)"


def test_the_way_to_another_frame_in_the_document(call):
    document = call("frame", FIRST, "--to", SECOND, "--json").json
    assert list(document) == [*KEYS, "to", "relative", "distance", "screw", "along"]
    for key in KEYS[4:]:
        assert document[key] == call("frame", FIRST, "--json").json[key]
        assert document["to"][key] == call("frame", SECOND, "--json").json[key]
        between = call("frame", f"Inv({FIRST}) {SECOND}", "--json").json[key]
        if key not in ("axis_angle",):
            assert np.allclose(document["relative"][key], between, atol=1e-12)
    assert document["distance"] == pytest.approx(6**0.5)
    assert document["screw"]["angle"] == pytest.approx(document["relative"]["axis_angle"]["angle"])
    assert document["along"] == "line"


def test_a_quarter_turn_about_a_line_and_along_it(call):
    """Rot(z,90) takes (1,0,0) to (0,2,0) about (-0.5,0.5): (1.5,-0.5) turns to (0.5,1.5); and up by 1."""
    words = ("frame", "Trans(1000,0,0)", "--to", "Trans(0,2000,1000) Rot(z,90)", "--length", "mm")
    screw = call(*words, "--json").json["screw"]
    assert screw["axis"] == [0, 0, 1]
    assert np.allclose(screw["point"], [-500, 500, 0])
    assert (screw["angle"], screw["translation"]) == (pytest.approx(90), pytest.approx(1000))
    assert screw["pitch"] == pytest.approx(2000 / np.pi)


@pytest.mark.parametrize("along", ["line", "screw"])
def test_rows_go_from_one_frame_to_the_other(call, along, tmp_path):
    words = ("frame", FIRST, "--to", SECOND, "--along", along, "--steps", "4")
    rows = call(*words, "-f", "csv")
    assert rows.numbers_of("t") == [0.0, 0.25, 0.5, 0.75, 1.0]
    call(*words, "-o", tmp_path / "way.npy")
    T = np.load(tmp_path / "way.npy")
    assert T.shape == (5, 4, 4)
    document = call(*words, "--json").json
    assert np.allclose(T[0], document["matrix"], atol=0)
    assert np.allclose(T[-1], document["to"]["matrix"], atol=0)
    assert np.allclose([rows.numbers_of(axis)[2] for axis in "xyz"], T[2, :3, 3])
    middle = 0.5 * (T[0, :3, 3] + T[-1, :3, 3])
    assert np.allclose(T[2, :3, 3], middle) == (along == "line")
    # Both turn evenly about one direction.
    steps = [T[k, :3, :3].T @ T[k + 1, :3, :3] for k in range(4)]
    assert np.allclose(steps, steps[0], atol=1e-12)


def test_without_a_turn_and_by_half_a_turn(call):
    screw = call("frame", "Rot(x,20)", "--to", "Trans(0,3,4) Rot(x,20)", "--json").json["screw"]
    assert (screw["point"], screw["pitch"], screw["translation"]) == (None, None, pytest.approx(5))
    assert call("frame", "", "--to", "", "--json").json["screw"]["axis"] is None
    assert "same frame" in call("frame", "", "--to", "").text
    assert "a translation" in call("frame", "", "--to", "Trans(1,2,3)").text
    answer = call("frame", "", "--to", "Rot(y,180)", "--json")
    assert (answer.status, answer.json["screw"]["axis"]) == (0, [0, 1, 0])
    assert "half a turn" in answer.err


@pytest.mark.parametrize("ending", ["html", "gif", "svg"])
def test_the_way_is_drawn(call, tmp_path, ending):
    if ending != "html":
        pytest.importorskip("matplotlib")
    path = tmp_path / f"way.{ending}"
    answer = call("frame", FIRST, "--to", SECOND, "--along", "screw", "--plot", path)
    assert (answer.status, answer.err) == (0, "")
    assert path.read_bytes().startswith({"html": b"<!DOCTYPE html>", "gif": b"GIF89a", "svg": b"<?xml"}[ending])


@pytest.mark.parametrize(
    ("arguments", "fragments"),
    [
        (["--along", "screw"], ["--along is about the way", "expected --to"]),
        (["--steps", "3"], ["--steps is about the way"]),
        (["--plot", "a.html"], ["--plot is about the way"]),
        (["--to", SECOND, "--along", "arc"], ["--along", "expected line or screw"]),
        (["--to", SECOND, "--steps", "0"], ["--steps", "from 1"]),
        (["--to", SECOND, "--plot", "a.bmp"], ["--plot: found 'a.bmp'", ".gif"]),
        (["--to", SECOND, "--point", "1,2,3"], ["--point and --to exclude"]),
        (["--to", "Trns(1,2,3)"], ["--to:", "'Trns'"]),
        (["--to", "Trans(1e200,0,0)"], ["too far away"]),
        (["--to", "Trans(1e9,0,0)", "--plot", "a.html"], ["too far away for a picture"]),
    ],
)
def test_what_is_no_way(call, arguments, fragments, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    refused(call("frame", FIRST, *arguments), *fragments)
    assert not list(tmp_path.iterdir())
