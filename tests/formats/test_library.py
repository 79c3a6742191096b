"""Names and paths: the library, files here and there, and what to do about a name that is not there."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from formats.texts import arm

import robokin
from robokin.errors import InputError, RobokinError
from robokin.formats import library_names, load, load_any
from robokin.formats.library import KINDS, is_path, library_files, library_folder
from robokin.model import Mechanism, Robot, Tree, WheeledBase
from robokin.units import METRES, RADIANS


@pytest.mark.parametrize("name", library_names())
def test_every_entry_of_the_library_loads(name):
    entry = load_any(name)
    assert isinstance(entry, Robot | Tree | Mechanism | WheeledBase)
    assert entry.id == name
    assert entry.source
    assert entry.units.length in METRES
    assert entry.units.angle in RADIANS
    assert all(math.isfinite(value) for value in entry.parameters.values())


@pytest.mark.parametrize("name", library_names())
def test_every_number_of_the_library_is_finite_and_every_limit_holds_something(name):
    entry = load_any(name)
    if not isinstance(entry, Robot):
        return
    assert np.all(np.isfinite(entry.base))
    assert np.all(np.isfinite(entry.tool))
    for row in entry.rows:
        assert all(map(math.isfinite, (row.theta, row.d, row.a, row.alpha, row.offset)))
    for joint in entry.joints:
        assert joint.limits[0] < joint.limits[1]
    for pose in entry.poses.values():
        assert pose.shape == (entry.n,)


def test_every_file_states_its_units():
    for path in library_files():
        assert "units:" in path.read_text(encoding="utf-8"), path


def test_names_are_sorted_and_many():
    names = library_names()
    assert names == sorted(names)
    assert len(names) > 100


def test_a_name_stands_once_and_every_file_in_the_folder_of_its_kind():
    """One folder deep, with nothing beside the descriptions: what stands elsewhere has no name."""
    assert len(set(library_names())) == len(library_names())
    assert sorted(library_folder().rglob("*.yaml")) == sorted(library_files())
    assert {path.name for path in library_folder().iterdir() if path.is_dir()} == set(KINDS)
    kinds = {"arms": Robot | Tree, "hands": Robot | Tree, "mechanisms": Mechanism, "bases": WheeledBase}
    for path in library_files():
        assert isinstance(load_any(path.stem), kinds[path.parent.name])


@pytest.mark.parametrize("name", ["arms", "hands", "arms\\puma560", ".", "..", "*", "puma560.", "-"])
def test_a_folder_is_no_name(name):
    with pytest.raises(InputError, match=r"in the library|no such file"):
        load_any(name)


@pytest.mark.parametrize(
    ("name", "path"),
    [("puma560", False), ("no-such", False), ("", False), (".", False), ("..", False), ("arm.yaml", True),
     ("./arm", True),
     ("a/b", True), ("/", True), ("arm.yml", True), ("arm.txt", True), ("../x", True), (".yaml", False)],
)  # fmt: skip
def test_what_has_a_slash_or_an_ending_is_a_path(name, path):
    assert is_path(name) is path


@pytest.mark.parametrize(
    ("name", "near"),
    [("puma56", "puma560"), ("PUMA56", "puma560"), ("puma 560", "puma560"), ("stanfrod", "stanford"),
     ("fourbar", "four-bar"),
     ("scra", "scara")],
)  # fmt: skip
def test_a_wrong_name_gets_the_nearest(name, near):
    with pytest.raises(InputError) as caught:
        load(name)
    assert f"named '{name}' in the library" in str(caught.value)
    assert near in str(caught.value).split("did you mean")[1]


@pytest.mark.parametrize(
    "name", ["", "zzzzzzzz", "x" * 5000, "\0", "puma560\n\n", "*", "é" * 300, "\x1b[31m", ".", "..", "~"]
)
def test_a_strange_name_ends_in_a_sentence(name):
    with pytest.raises(InputError) as caught:
        load(name)
    assert str(caught.value).isprintable()
    assert len(str(caught.value)) < 300


@pytest.mark.parametrize(
    "path", ["\0/x", "x\0.yaml", "a/" + "b" * 5000, "no/such/arm.yaml", "arm.yaml", "/", "/dev/null/x", "./puma560"]
)
def test_a_strange_path_ends_in_a_sentence(path, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match="expected"):
        load(path)


def test_a_file_is_read_from_a_path(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("arm.yaml").write_text(arm("type: R, a: 5"))
    Path("puma560").write_text(arm("type: P, a: 5"))
    for path in ("arm.yaml", "./arm.yaml", Path("arm.yaml"), tmp_path / "arm.yaml", str(tmp_path / "arm.yaml")):
        robot = load(path)
        assert (robot.id, robot.types) == ("arm", "R")
    assert load("./puma560").types == "P"
    assert load(Path("puma560")).types == "P"
    assert load("puma560").types == "RRRRRR", "a name is the library's, whatever lies in the folder"


def test_a_spoiled_file_of_the_library_does_not_hide_what_a_wrong_name_may_mean(tmp_path, monkeypatch):
    (tmp_path / "arms").mkdir()
    (tmp_path / "arms" / "a-good.yaml").write_text("robokin: 1\nname: Puma\n")
    (tmp_path / "arms" / "b-binary.yaml").write_bytes(bytes(range(256)))
    (tmp_path / "arms" / "c-link.yaml").symlink_to(tmp_path / "nothing.yaml")
    (tmp_path / "arms" / "d-folder.yaml").mkdir()
    monkeypatch.setattr("robokin.formats.library.library_folder", lambda: tmp_path)
    with pytest.raises(InputError, match=r"no robot or mechanism named 'puma'.*in the title of a-good"):
        load_any("puma")


def test_a_file_in_the_folder_is_pointed_at(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("myarm").write_text(arm())
    with pytest.raises(InputError, match=r"write \./myarm"):
        load("myarm")


# Parameters ------------------------------------------------------------------------------------------


def test_parameters_of_an_entry_can_be_set():
    """The lengths are the file's own cells, and so in its units."""
    robot = robokin.load("planar3r", a1=5, a2="2*a1", a3=np.float64(0.5))
    assert dict(robot.parameters) == {"a1": 5.0, "a2": 10.0, "a3": 0.5}
    assert [row.a for row in robot.rows] == [5.0, 10.0, 0.5]
    assert dict(load("planar3r").parameters) != dict(robot.parameters), "the library stays as it is"


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"a9": 1}, "has no parameter 'a9'; did you mean"),
        ({"zzz": 1}, "expected one of a1, a2, a3"),
        ({"a1": math.nan}, "parameter a1=nan: found 'nan', expected a finite number"),
        ({"a1": -math.inf}, "finite"),
        ({"a1": ""}, "parameter a1=: found nothing, expected a number"),
        ({"a1": "1 +"}, "parameter a1=1 +: found the end"),
        ({"a1": "a2", "a2": "a1"}, "in a circle (a1 -> a2 -> a1)"),
        ({"a1": "1/0"}, "division by zero"),
        ({"a1": "[1]"}, "expected a number"),
        ({"a1": None}, "parameter a1: found None, expected a number or an expression"),
        ({"a1": [1]}, "found [1], expected a number"),
        ({"a1": {}}, "found {}, expected a number"),
        ({"a1": 1j}, "found 1j, expected a number"),
        ({"a1": 10**400}, "expected a number"),
        ({"a1": object()}, "expected a number"),
    ],
)
def test_a_wrong_parameter_ends_in_a_sentence(given, said):
    with pytest.raises(RobokinError) as caught:
        robokin.load("planar3r", **given)
    assert said in str(caught.value)
    assert isinstance(caught.value, ValueError)


def test_a_robot_without_parameters_takes_none():
    with pytest.raises(InputError, match="has no parameter 'x': it has none"):
        load("puma560", x=1)
