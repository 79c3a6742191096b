"""`robokin workspace`: sizes that are known, queries, cuts, files and pictures, and what is refused."""

from __future__ import annotations

import json

import numpy as np
import pytest
from pictures.page_tables import unpacked
from sweeps import sweep

from .conftest import invoke, poses_of, refused

FEW = ("--samples", "4096")
"""As many samples as an answer needs that is not judged by its error."""

SOME = ("--samples", "16384")
"""As many as a cut's area needs: an eighth of them is looked at."""

SIXTH = 1.0 / 6.0 * 2.0 * np.pi
"""Sixty degrees [rad]."""


@pytest.fixture
def arm(tmp_path):
    """A planar arm of two links whose joints turn little, in a file."""

    def written(*joints, units="{length: m, angle: deg}"):
        path = tmp_path / "arm.yaml"
        lines = "".join(f"  - {{{joint}}}\n" for joint in joints)
        path.write_text(f"robokin: 1\nname: Arm\nunits: {units}\njoints:\n{lines}")
        return str(path)

    return written


def two_links(arm):
    """The area reached is l1 l2 D1 (cos c - cos d), the second joint turning from c to d and the first by D1."""
    return arm("type: R, a: 1, limits: [0, 60]", "type: R, a: 0.6, limits: [60, 90]"), 0.6 * SIXTH * 0.5


# Figures --------------------------------------------------------------------------------------------------


def test_a_document_says_what_the_contract_says(call):
    document = call("workspace", "planar2r", "--json").json
    assert document["robot"] == "planar2r"
    assert document["units"] == {"length": "m", "angle": "deg"}
    assert (document["samples"], document["seed"], document["sampling"]) == (131072, 0, "sobol")
    assert np.allclose(document["bounds"]["min"], [-1.6, -1.6, 0.0], atol=1e-9)
    assert np.allclose(document["bounds"]["max"], [1.6, 1.6, 0.0], atol=1e-9)
    assert document["reach"] == {"min": pytest.approx(0.4), "max": pytest.approx(1.6), "from": "base"}
    assert document["dimension"] == 2
    assert abs(document["area"] - 4.0 * np.pi * 0.6) <= document["area_error"] <= 0.005 * document["area"]
    assert "volume" not in document
    assert (document["dexterity"], document["cuts"]) == (None, [])


def test_areas_and_volumes_are_in_the_units(call, arm):
    path, area = two_links(arm)
    document = call("workspace", path, "--length", "in", "--json").json
    assert document["area"] * 0.0254**2 == pytest.approx(area, rel=0.005)
    box = call("workspace", "cartesian", *FEW, "--length", "mm", "--json").json
    low, high = (np.array(box["bounds"][end]) for end in ("min", "max"))
    assert box["volume"] == pytest.approx(np.prod(high - low), rel=1e-6)


def test_where_the_bounds_are_reached_forward_kinematics_agrees(call):
    document = call("workspace", "scara", *FEW, "--json").json
    for end in ("min", "max"):
        p = poses_of("scara", document["at"][end])[:, :3, 3]
        assert np.allclose(np.diag(p), document["bounds"][end], atol=1e-6)
    p = poses_of("scara", [document["at"]["least"], document["at"]["greatest"]])[:, :3, 3]
    assert np.allclose(np.linalg.norm(p, axis=1), [document["reach"]["min"], document["reach"]["max"]], atol=1e-6)


@pytest.mark.slow
def test_the_answer_is_the_same_bytes_on_one_core_and_on_two(call):
    one = call("workspace", "stanford", *FEW, "--cores", "1", "--json")
    two = call("workspace", "stanford", *FEW, "--cores", "2", "--json")
    assert one.status == 0
    assert one.out == two.out
    # The size of a set that three joints reach is an estimate.
    volumes = [call("workspace", "gp8", *FEW, "--seed", seed, "--json").json["volume"] for seed in (0, 7)]
    assert volumes[0] != volumes[1]


def test_the_formats_say_the_same(call):
    document = call("workspace", "scara", *FEW, "--json").json
    assert call("workspace", "scara", *FEW, "-f", "jsonl").jsonl == [document]
    answer = call("workspace", "scara", *FEW, "-f", "csv")
    row = dict(zip(answer.columns, answer.csv[1], strict=True))
    assert len(answer.csv) == 2
    assert float(row["size"]) == document["volume"]
    assert (row["quantity"], row["robot"]) == ("volume", "scara")
    assert [float(row[f"{axis}_min"]) for axis in "xyz"] == document["bounds"]["min"]


@pytest.mark.parametrize("robot", ["planar2r", "scara", "spherical", "cartesian", "planar3r"])
def test_a_table_has_its_figures_and_its_picture_on_a_page(call, robot):
    answer = call("workspace", robot, *FEW)
    assert (answer.status, answer.err) == (0, "")
    assert max(map(len, answer.lines)) <= 80
    assert any(line.startswith(("area", "volume")) and "±" in line for line in answer.lines)
    assert "⣿⣿⣿" in answer.text
    assert "└" in answer.text
    assert answer.lines[-1].strip().endswith("[mm]" if robot == "scara" else "[m]")


def test_a_curved_surface_has_an_area_and_no_volume(call, arm):
    path = arm("type: R, a: 0.5, alpha: 90", "type: R, a: 0.2")
    document = call("workspace", path, "--samples", "16384", "--json").json
    assert document["dimension"] == 2
    # A torus.
    assert document["area"] == pytest.approx(4.0 * np.pi**2 * 0.5 * 0.2, rel=0.005)
    assert (document["length_index"], document["volume_index"]) == (None, None)


# Orientations ---------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def freedom(tmp_path_factory):
    """A planar arm's orientations: the answer, and the page that shows them."""
    path = tmp_path_factory.mktemp("freedom") / "arm.html"
    return invoke("workspace", "planar3r", "--dextrous", *FEW, "--json", "--plot", path), path


def test_the_three_sets_are_named_and_have_sizes(freedom):
    document = freedom[0].json
    dexterity = document["dexterity"]
    assert dexterity["group"] == "SO(2)"
    sets = dexterity["sets"]
    assert list(sets) == ["reachable", "several", "every"]
    assert "lecture" in sets["several"]["needs"]
    assert "the dexterous workspace" in sets["every"]["needs"]
    assert sets["reachable"]["area"] == document["area"]
    # The closed form of the arm with links 1, 0.6 and 0.35: a ring from 0.75 to 1.25.
    assert abs(sets["every"]["area"] - np.pi) <= sets["every"]["area_error"]
    assert len(dexterity["map"]["points"]) == len(dexterity["map"]["fraction"]) > 100
    assert 0.0 < min(dexterity["map"]["fraction"]) <= max(dexterity["map"]["fraction"]) == 1.0


@pytest.mark.slow
def test_shades_show_where_every_orientation_is_reached(call):
    answer = call("workspace", "planar3r", "--dextrous", *FEW)
    assert max(map(len, answer.lines)) <= 80
    for shade in "░▒▓█":
        assert shade * 2 in answer.text
    assert "⣿" not in answer.text
    assert "the lecture's dexterous workspace" in " ".join(answer.text.split())


def test_an_arm_with_finitely_many_orientations_has_a_lectures_set_only(call):
    sets = call("workspace", "planar2r", "--dextrous", *FEW, "--json").json["dexterity"]["sets"]
    assert sets["several"]["area"] == pytest.approx(sets["reachable"]["area"], rel=0.01)
    assert sets["every"] == {"needs": sets["every"]["needs"], "area": 0.0, "area_error": 0.0}


# Queries --------------------------------------------------------------------------------------------------


def test_a_place_is_reachable_or_not(call):
    answer = call("workspace", "planar2r", "--at", "1,0.5,0", "--json")
    assert answer.status == 0
    assert (answer.json["reachable"], answer.json["solutions"], answer.json["reached"]) == (True, 2, 2)
    answer = call("workspace", "planar2r", "--at", "0.1,0,0", "--json")
    assert answer.status == 3
    assert (answer.json["reachable"], answer.json["solutions"]) == (False, 0)


def test_several_places_are_a_list_and_all_must_be_reachable(call):
    places = ("--at", "1,0.5,0", "--at", "1 0 1")
    answer = call("workspace", "planar2r", *places, "--json")
    assert answer.status == 3
    assert [record["reachable"] for record in answer.json] == [True, False]
    assert call("workspace", "planar2r", *places, "-f", "jsonl").jsonl == answer.json
    rows = call("workspace", "planar2r", *places, "-f", "csv").csv
    assert [row[3] for row in rows] == ["reachable", "true", "false"]
    table = call("workspace", "planar2r", *places)
    assert table.status == 3
    assert [row.split()[3] for row in table.lines[4:6]] == ["yes", "no"]


def test_a_place_has_its_orientations(call, arm):
    # The hand of a third link points anywhere about z; its own joint keeps it near the forearm.
    path = arm("type: R, a: 1", "type: R, a: 0.6", "type: R, a: 0.35, limits: [-10, 10]")
    document = call("workspace", path, "--at", "1.2,0,0", "--json").json
    assert document["group"] == "SO(2)"
    assert 0.0 < document["fraction"] < 1.0
    assert document["reached"] == len(document["quaternions"])
    # At most 10 degrees between the last two links: ranges on both sides, which mirror each other.
    assert document["ranges_of"] == "x axis about z"
    (a, b), (c, d) = document["ranges"]
    assert (a, b) == pytest.approx((-d, -c), abs=1e-7)
    assert b - a + d - c == pytest.approx(360.0 * document["fraction"], abs=1e-7)
    table = call("workspace", path, "--at", "1.2,0,0")
    assert "its x axis at" in " ".join(table.text.split())


def test_a_place_is_in_the_units(call):
    assert call("workspace", "planar2r", "--at", "1000,500,0", "--length", "mm", "--json").json["position"] == [
        1000.0,
        500.0,
        0.0,
    ]


# Cuts -----------------------------------------------------------------------------------------------------


def test_a_slice_has_its_area_and_its_boundary(call):
    document = call("workspace", "scara", *SOME, "--slice", "z=200", "--json").json
    (cut,) = document["cuts"]
    area = np.pi * (600.0**2 - 50.0**2)
    assert (cut["cut"], cut["axes"], cut["parts"], cut["holes"]) == ("z=200", ["x", "y"], 1, 1)
    assert abs(cut["area"] - area) <= cut["area_error"]
    radii = sorted(float(np.mean(np.hypot(*np.array(loop).T))) for loop in cut["outline"])
    assert radii == pytest.approx([50.0, 600.0], rel=1e-3)


def test_a_slice_beside_the_set_is_empty(call):
    (cut,) = call("workspace", "scara", *FEW, "--slice", "z=0", "--json").json["cuts"]
    assert (cut["area"], cut["parts"], cut["outline"]) == (0.0, 0, [])


def test_the_section_is_that_of_the_half_plane(call):
    (cut,) = call("workspace", "scara", *SOME, "--section", "--json").json["cuts"]
    assert (cut["cut"], cut["axes"]) == ("section", ["r", "z"])
    assert abs(cut["area"] - 550.0 * 210.0) <= cut["area_error"]
    low, high = np.min(cut["outline"][0], axis=0), np.max(cut["outline"][0], axis=0)
    assert np.allclose([low, high], [[50.0, 127.0], [600.0, 337.0]], atol=0.5)


def test_what_is_asked_for_is_drawn_in_text(call):
    answer = call("workspace", "scara", *FEW, "--slice", "x=100", "--section")
    assert "slice at x = 100 mm" in answer.lines
    assert "section through the first joint's axis" in answer.lines
    assert sum("└" in line for line in answer.lines) == 2


# Two robots -----------------------------------------------------------------------------------------------


def test_two_robots_stand_side_by_side(call):
    answer = call("workspace", "planar2r", "--compare", "planar2r", *FEW)
    assert (answer.status, answer.err) == (0, "")
    assert "1 times as much" in answer.text
    records = call("workspace", "planar2r", "--compare", "scara", *FEW, "--json").json
    assert [record["robot"] for record in records] == ["planar2r", "scara"]
    # Both in the units of the first.
    assert records[1]["units"] == records[0]["units"]
    assert records[1]["reach"]["max"] < 1.0
    rows = call("workspace", "planar2r", "--compare", "scara", *FEW, "-f", "csv").csv
    assert len(rows) == 3


# Files ----------------------------------------------------------------------------------------------------


def test_samples_with_joints_are_where_forward_kinematics_has_them(call, tmp_path):
    path = tmp_path / "cloud.csv"
    answer = call("workspace", "puma560", "--samples", "64", "--with", "joints,poses", "--output", path)
    assert (answer.status, answer.out, answer.err) == (0, b"", "")
    header, *lines = path.read_text().splitlines()
    assert header.split(",") == [f"q{i}" for i in range(1, 7)] + ["x", "y", "z", "roll", "pitch", "yaw"]
    rows = np.array([[float(cell) for cell in line.split(",")] for line in lines])
    assert len(rows) == 64
    assert np.allclose(poses_of("puma560", rows[:, :6])[:, :3, 3], rows[:, 6:9], atol=1e-9)


def test_a_finished_file_is_written_again_with_resume(call, tmp_path):
    path = tmp_path / "cloud.npy"
    assert call("workspace", "planar2r", "--samples", "50", "--output", path).status == 0
    first = path.read_bytes()
    assert call("workspace", "planar2r", "--samples", "50", "--output", path, "--resume").status == 0
    assert path.read_bytes() == first
    assert np.load(path).shape == (50, 3)


# Pictures -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "start"), [("a.png", b"\x89PNG"), ("a.svg", b"<?xml"), ("a.html", b"<!DOCTYPE html>")]
)
def test_a_picture_goes_to_its_file(call, tmp_path, name, start):
    if not name.endswith("html"):
        pytest.importorskip("matplotlib")
    path = tmp_path / name
    answer = call("workspace", "planar2r", *FEW, "--plot", path)
    assert (answer.status, answer.err) == (0, "")
    assert path.read_bytes().startswith(start)
    assert "⣿" not in answer.text, "the picture in text is for who asked for none"
    assert [file.name for file in tmp_path.iterdir()] == [name]


def test_a_page_shows_a_map_of_orientations_and_the_figures(freedom):
    _, _, rest = freedom[1].read_text().partition('<script id="data" type="application/json">')
    data = json.loads(rest.partition("</script>")[0])
    assert data["title"] == "Three-link planar arm"
    assert "area" in dict(data["figures"])
    (plate,) = data["plates"]
    parts = unpacked(plate["cells"])
    x, y = (
        low + step * np.arange(n)
        for low, step, n in zip(*(plate["cells"][k] for k in ("low", "step", "shape")), strict=True)
    )
    radius = np.hypot(*np.meshgrid(x, y, indexing="ij"))
    assert np.all(parts[(np.abs(radius - 1.0) < 0.2)] == 254)


def test_without_matplotlib_nothing_is_worked_out_before_the_sentence(call, monkeypatch, tmp_path):
    monkeypatch.setattr("robokin.pictures.workspace_stills.find_spec", lambda name: None)
    path = tmp_path / "a.png"
    refused(call("workspace", "puma560", "--plot", path), "`pip install matplotlib`")
    assert not path.exists()


# What is refused ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "fragments"),
    sweep(
        [
            (["planar2r", "--samples", "0"], ["--samples", "found '0'", "whole number"]),
            (["planar2r", "--samples", "-5"], ["--samples", "-5"]),
            (["planar2r", "--samples", "many"], ["--samples", "many"]),
            (["planar2r", "--samples", "9" * 40], ["--samples"]),
            (["planar2r", "--seed", "-1"], ["--seed"]),
            (["planar2r", "--cores", "0"], ["--cores"]),
            (["planar2r", "--sampling", "sobel"], ["sobel", "did you mean 'sobol'"]),
            (["planar2r", "--voxel", "0.1"], ["--voxel", "--dextrous"]),
            (["planar3r", "--dextrous", "--voxel", "0"], ["--voxel", "greater than 0"]),
            (["planar3r", "--dextrous", "--voxel", "50"], ["voxel"]),
            (["planar3r", "--dextrous", "--voxel", "1e-9"], ["voxel", "cells"]),
            (["planar2r", "--slice", "z=0"], ["--slice", "no solid"]),
            (["planar2r", "--section"], ["--section", "no solid"]),
            (["cartesian", "--section"], ["--section", "--slice"]),
            (["scara", "--slice", "0.3"], ["--slice", "found '0.3'"]),
            (["scara", "--slice", "w=0.3"], ["--slice", "w=0.3"]),
            (["scara", "--slice", "z=up"], ["--slice"]),
            (["scara", "--at", "1,2"], ["--at", "found 2 values"]),
            (["planar2r", "--at", "1,2,0", "--compare", "scara"], ["--at", "--compare", "exclude"]),
            (["planar2r", "--at", "1,2,0", "--plot", "a.png"], ["--at", "--plot", "exclude"]),
            (["planar2r", "--output", "a.csv", "--dextrous"], ["--output", "--dextrous", "exclude"]),
            (["planar2r", "--output", "a.csv", "--json"], ["--output", "--json"]),
            (["planar2r", "--output", "a.txt"], ["a.txt", ".ply"]),
            (["planar2r", "--with", "joints"], ["--with", "--output"]),
            (["planar2r", "--resume"], ["--resume", "--output"]),
            (["planar2r", "--with", "forces", "--output", "a.csv"], ["--with", "forces"]),
            (["planar2r", "--as", "rpy", "--output", "a.csv"], ["--as", "--with poses"]),
            (["planar2r", "--plot", "a.gif"], ["a.gif", ".html"]),
            (["planar2r", "--compare", "scra"], ["scra", "scara"]),
            (["planar2r", "--plot", "nowhere/a.html", "--samples", "4096"], ["--plot", "nowhere"]),
            (["four-bar"], ["mechanism"]),
        ],
        3,
    ),
)
def test_what_is_wrong_gets_a_sentence(call, arguments, fragments, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    refused(call("workspace", *arguments), *fragments)
    assert not list(tmp_path.iterdir())


def test_sliding_joints_need_limits(call, arm):
    refused(call("workspace", arm("type: R, a: 1", "type: P, alpha: 90")), "joint 2", "limits")


def test_a_place_of_a_planar_arm_has_two_values(call):
    flat = call("workspace", "planar3r", "--at", "1,0.5", "--json")
    assert (flat.status, flat.err) == (0, "")
    assert flat.out == call("workspace", "planar3r", "--at", "1,0.5,0", "--json").out
    assert call("workspace", "puma560", "--at", "1,0.5").status == 2


@pytest.mark.parametrize(
    "way", [["--cores", "2"], pytest.param(["--cluster", "local:2"], marks=pytest.mark.slow)], ids=str
)
def test_places_are_the_same_whoever_works_at_them(call, way):
    asked = ["workspace", "puma560", "--at", "500,100,300", "--at", "5000,0,0", "--at", "200,300,100", "--json"]
    one, shared = call(*asked), call(*asked, *way)
    assert one.status == shared.status == 3
    assert one.out == shared.out
