"""`robokin dof`: the count in both forms, the truth beside it, motions and pictures."""

from __future__ import annotations

import subprocess
import sys
from importlib.util import find_spec

import numpy as np
import pytest
from sweeps import sweep

import robokin
from robokin.formats import library_names, load_any
from robokin.mobility.verdict import mobility_of
from robokin.model import Mechanism, Robot, Tree, WheeledBase

from .conftest import refused

KEYS = ["schema", "name", "id", "space", "lambda", "links", "joints", "freedoms", "grubler", "constraints", "mobility",
        "mobility_basis", "overconstraints", "idle", "controllable", "holonomic", "note"]  # fmt: skip
"""The contract's keys, in its order; every answer has them."""

MECHANISM = "robokin: 1\nname: Test\nspace: {space}\nunits: {{length: mm, angle: deg}}\nlinks: [{links}]\njoints:\n"


def described(tmp_path, links, *joints, space="planar", tail=""):
    path = tmp_path / "test.yaml"
    rows = "".join(f"  - {{{joint}}}\n" for joint in joints)
    path.write_text(MECHANISM.format(space=space, links=links) + rows + tail)
    return str(path)


FOUR = ["name: A, type: revolute, links: [ground, crank], at: [0, 0]",
        "name: B, type: revolute, links: [crank, coupler], at: [0, 20]",
        "name: C, type: revolute, links: [coupler, rocker], at: [30, 30]",
        "name: D, type: revolute, links: [rocker, ground], at: [40, 0]"]  # fmt: skip
LINKS = "ground, crank, coupler, rocker"


# Bare numbers ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("links", "joints", "space", "f", "count"),
    [
        ("7", "6R", "spatial", 6, 6), ("14", "12S,6P", "spatial", 42, 12), ("14", "6U,6P,6S", "spatial", 36, 6),
        ("4", "4R", "planar", 4, 1), ("4", "3R,1P", "planar", 4, 1), ("4", "RRRP", "planar", 4, 1),
        ("4", "rrrp", "planar", 4, 1), ("4", "3 revolute, 1 prismatic", "planar", 4, 1), ("4", "4R", "spatial", 4, -2),
        ("4", "4R", "spherical", 4, 1), ("4", "2R,2S", "spatial", 8, 2), ("4", "R,R,S,S", "spatial", 8, 2),
        ("3", "2R,1G", "spherical", 4, 1), ("3", "2R,bevel", "spherical", 4, 1), ("3", "2R,belt", "planar", 4, 1),
        ("4", "3R,2 gears", "spherical", 7, 1), ("3", "2R,G", "planar", 4, 1),
        ("3", "2R,G", "spatial", 7, 1), ("2", "hinge", "planar", 1, 1),
        ("5", "4R 2G", "planar", 8, 2), ("4", "3 pins, slider", "planar", 4, 1), ("4", "2R+2S", "spatial", 8, 2),
        ("11", "3R,12S", "spatial", 39, 9), ("2", "1F", "spatial", 0, 0), ("2", "1E", "planar", 3, 3),
        ("2", "H", "spatial", 1, 1), ("2", "1C", "spatial", 2, 2),
    ],
)  # fmt: skip
def test_bare_counts(call, links, joints, space, f, count):
    answer = call("dof", "--links", links, "--joints", joints, "--space", space, "--json")
    assert (answer.status, answer.err) == (0, "")
    record = answer.json
    assert list(record)[: len(KEYS)] == KEYS
    order = 6 if space == "spatial" else 3
    assert (record["freedoms"], record["grubler"], record["constraints"]["form"]) == (f, count, count)
    assert record["constraints"]["total"] == order * record["joints"] - f
    assert (record["name"], record["space"], record["lambda"], record["kind"]) == (None, space, order, "count")
    assert record["mobility"] is record["mobility_basis"] is record["controllable"] is None
    assert sum(part["count"] * part["freedoms"] for part in record["types"]) == f


def test_a_bare_count_is_written_out(call):
    text = call("dof", "--links", "14", "--joints", "12S,6P", "--space", "spatial").text
    assert "F = λ(n − j − 1) + Σf = 6(14 − 18 − 1) + 42 = 12" in text
    assert "F = λ(n − 1) − ΣC     = 6(14 − 1) − 66      = 12" in text
    assert "loops  5" in text


def test_too_few_joints_are_noticed(call):
    record = call("dof", "--links", "7", "--joints", "4R", "--space", "planar", "--json").json
    assert record["grubler"] == 10
    assert "7 links need at least 6 joints to hang together" in record["note"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--joints", "4B"], ["unknown joint 'B'", "did you mean S (spherical)?"]),
        (["--joints", "4X"], ["unknown joint 'X'", "expected one of R revolute, P prismatic"]),
        (["--joints", "4 revolut"], ["did you mean R (revolute)?"]),
        (["--joints", "6RUS"], ["6 legs RUS", "6R,6U,6S"]),
        (["--joints", ""], ["expected a count and a letter"]),
        (["--joints", "R6"], ["'R6'", "expected a count and a letter"]),
        (["--joints", "6"], ["expected a count and a letter"]),
        (["--joints", "6R,,2S"], ["expected a count and a letter"]),
        (["--joints", "-6R"], ["expected a count and a letter"]),
        (["--joints", "9999999R"], ["at most 1000000"]),
        (["--joints", "9" * 5000 + "R"], ["at most 1000000"]),
        (["--joints", "4S", "--space", "planar"], ["spherical joint (S) in a planar", "expected R, P, E, F or G"]),
        (["--joints", "4P", "--space", "spherical"], ["in a spherical mechanism"]),
        (["--links", "0"], ["--links: found '0'", "expected a whole number from 1"]),
        (["--links", "four"], ["--links: found 'four'"]),
        (["--links", "1e3"], ["--links: found '1e3'"]),
        (["--space", "3d"], ["--space: found '3d'", "planar, spherical or spatial"]),
        (["--space", "spacial"], ["did you mean 'spatial'"]),
        (["--trace", "4"], ["--trace is for a description"]),
        (["--set", "a=1"], ["--set is for a description"]),
        (["four-bar"], ["--links counts without a description, expected it without four-bar"]),
        (["--output", "x.npy"], ["expected --trace N"]),
    ],
)
def test_slips_in_bare_counts(call, arguments, said):
    base = {"--links": "4", "--joints": "4R", "--space": "spatial"}
    given = [word for option, value in base.items() if option not in arguments for word in (option, value)]
    refused(call("dof", *given, *arguments), *said)


@pytest.mark.parametrize("missing", ["--links", "--joints", "--space"])
def test_a_count_needs_all_three(call, missing):
    base = {"--links": "4", "--joints": "4R", "--space": "spatial"}
    refused(call("dof", *[word for option in base if option != missing for word in (option, base[option])]), missing)
    refused(call("dof"), "NAME is missing")


def test_a_bare_count_starts_without_numpy():
    code = (
        "import sys, io\nfrom robokin.cli import run\nkept, sys.stdout = sys.stdout, io.TextIOWrapper(io.BytesIO())\n"
        "status = run(sys.argv[1:])\nsys.stdout = kept\nprint(status, 'numpy' in sys.modules, 'yaml' in sys.modules)"
    )
    for more in ([], ["--json"], ["-f", "csv"]):
        words = ["dof", "--links", "7", "--joints", "6R", "--space", "spatial", *more]
        done = subprocess.run([sys.executable, "-c", code, *words], capture_output=True, text=True, check=True)
        assert done.stdout.split() == ["0", "False", "False"]


# Mechanisms ------------------------------------------------------------------------------------------


def test_count_and_truth_side_by_side(call):
    text = call("dof", "sarrus").text
    assert "F = λ(n − j − 1) + Σf = 6(6 − 6 − 1) + 6 = 0" in text
    assert "F = λ(n − 1) − ΣC     = 6(6 − 1) − 30    = 0" in text
    lines = text.splitlines()
    row = lines[next(i for i, line in enumerate(lines) if line.startswith("Grübler   mobility")) + 2]
    assert row.split(maxsplit=2)[:2] == ["0", "1"]
    assert "exceptional" in row
    assert "special dimensions: 1 of the constraints in space is redundant" in " ".join(text.split())


def test_the_record_of_a_mechanism(call):
    record = call("dof", "sarrus", "--json").json
    assert list(record)[: len(KEYS)] == KEYS
    assert (record["name"], record["space"], record["lambda"]) == ("Sarrus linkage", "spatial", 6)
    assert (record["links"], record["joints"], record["freedoms"], record["grubler"]) == (6, 6, 6, 0)
    assert (record["mobility"], record["mobility_basis"], record["overconstraints"]) == (1, "geometry", 1)
    assert (record["verdict"], record["loops"], record["instantaneous"], record["generic"]) == ("exceptional", 1, 1, 1)
    assert record["output"]["kind"] == "translation along a line"
    assert (record["output"]["freedoms"], record["output"]["against"]) == (1, "base")
    assert (record["controllable"], record["undriven"], record["holonomic"]) == (1, 0, True)
    assert (record["gap"][0] > 0.1, record["gap"][1] < 1e-12) == (True, True)
    assert len(record["singular_values"]) == 6
    assert (record["as_expected"], record["dead_joints"], record["missing"], record["slips"]) == (True, [], [], [])
    assert record["kind"] == "mechanism"
    assert set(record["units"]) == {"length", "angle"}


@pytest.mark.parametrize("name", sweep(library_names(), 4))
def test_every_entry_has_an_answer_that_agrees_with_its_file(call, name):
    entry = load_any(name)
    answer = call("dof", name, "-f", "jsonl")
    assert (answer.status, answer.err) == (0, "")
    (record,) = answer.jsonl
    assert list(record)[: len(KEYS)] == KEYS
    assert record["id"] == name
    if isinstance(entry, Robot):
        assert record["mobility"] == record["grubler"] == record["controllable"] == entry.n
        assert (record["links"], record["redundancy"]) == (entry.n + 1, entry.n - record["total"])
        assert record["holonomic"] == (entry.n >= record["total"])
        return
    assert record.get("as_expected") is not False
    table = call("dof", name)
    assert table.status == 0
    assert max(map(len, table.lines)) <= 80


def test_formats_agree(call, tmp_path):
    record = call("dof", "four-bar", "--json").json
    assert call("dof", "four-bar", "-f", "jsonl").jsonl == [record]
    answer = call("dof", "four-bar", "-f", "csv")
    row = dict(zip(answer.columns, answer.csv[1], strict=True))
    assert (row["name"], row["grubler"], row["mobility"]) == ("Four-bar linkage", "1", "1")
    path = tmp_path / "four.json"
    assert call("dof", "four-bar", "--output", path).out == b""
    assert path.read_bytes() == call("dof", "four-bar", "--json").out


def test_between_two_links(call):
    record = call("dof", "four-bar", "--between", "coupler,crank", "--json").json
    assert record["output"] == {
        "link": "coupler", "against": "crank", "freedoms": 1, "kind": "rotation about an axis",
    }  # fmt: skip
    text = call("dof", "four-bar", "--between", " rocker , crank ").text
    assert "rocker against crank has 1 freedom: rotation about an axis" in text
    refused(call("dof", "four-bar", "--between", "rocker"), "--between", "expected two links with a comma")
    refused(call("dof", "four-bar", "--between", "rocker,crnk"), "unknown link 'crnk'", "did you mean 'crank'")
    refused(call("dof", "four-bar", "--between", "rocker,rocker"), "twice")
    refused(call("dof", "car", "--between", "a,b"), "--between is for mechanisms")


def test_a_mechanism_without_geometry_is_counted(call, tmp_path):
    joints = [joint.partition(", at")[0] for joint in FOUR]
    record = call("dof", described(tmp_path, LINKS, *joints), "--json").json
    assert (record["grubler"], record["mobility"], record["mobility_basis"]) == (1, None, None)
    assert (record["verdict"], record["missing"]) == ("counted", ["A", "B", "C", "D"])
    some = call("dof", described(tmp_path, LINKS, *FOUR[:3], joints[3])).text
    assert "counted only: no geometry is given for joint D" in some


def test_a_mechanism_in_pieces(call, tmp_path):
    text = " ".join(call("dof", described(tmp_path, LINKS, *FOUR[1:3])).text.split())
    assert "disconnected" in text
    assert "no joint holds the mechanism to its ground, ground" in text
    record = call("dof", described(tmp_path, LINKS + ", spare", *FOUR), "--json").json
    assert (record["verdict"], record["mobility"], record["grubler"]) == ("disconnected", None, 4)
    assert record["note"].startswith("no joint leads from the ground to spare")


def test_slips_of_the_pen(call, tmp_path):
    same = FOUR[1].replace("[0, 20]", "[0, 0]")
    path = described(tmp_path, LINKS, FOUR[0], same, *FOUR[2:])
    assert "link crank has no length" in call("dof", path).text.replace("\n", " ")
    assert len(call("dof", path, "--json").json["slips"]) == 1
    tilted = FOUR[3] + ", axis: [0, 0.1, 1]"
    answer = call("dof", described(tmp_path, LINKS, *FOUR[:3], tilted))
    refused(answer, "the axis of joint D", "expected space: spatial")
    zero = FOUR[3] + ", axis: [0, 0, 0]"
    refused(call("dof", described(tmp_path, LINKS, *FOUR[:3], zero)), "test.yaml:10:", "found zero as axis of joint D")
    self_ = FOUR[3].replace("[rocker, ground]", "[rocker, rocker]")
    refused(call("dof", described(tmp_path, LINKS, *FOUR[:3], self_)), "found a link twice")
    kind = FOUR[3].replace("revolute", "revolte")
    refused(call("dof", described(tmp_path, LINKS, *FOUR[:3], kind)), "'revolte'", "did you mean 'revolute'")


def test_a_file_that_expects_something_else(call, tmp_path):
    path = described(tmp_path, LINKS, *FOUR, tail="expected: {mobility: 2}\n")
    assert call("dof", path, "--json").json["as_expected"] is False
    assert "the file  differs: it states mobility 2" in call("dof", path).text


def test_a_nearly_mobile_one(call, tmp_path):
    """A third crank that is a tenth of a millimetre too long."""
    third = ["type: revolute, links: [ground, third], at: [15, 0]",
             "type: revolute, links: [third, coupler], at: [15.001, 20]"]  # fmt: skip
    four = [FOUR[0], FOUR[1], FOUR[2].replace("[30, 30]", "[30, 20]"), FOUR[3].replace("[40, 0]", "[30, 0]")]
    path = described(tmp_path, LINKS + ", third", *four, *third)
    record = call("dof", path, "--json").json
    assert (record["verdict"], record["mobility"], record["if_exact"]) == ("nearly", 0, 1)
    assert "if its dimensions were exact" in record["note"]
    exact = described(tmp_path, LINKS + ", third", *four, third[0], third[1].replace("15.001", "15"))
    assert call("dof", exact, "--json").json["mobility"] == 1


def test_drives(call):
    text = call("dof", "6-sps").text
    assert "6 freedoms left unactuated, none of the output" in " ".join(text.split())
    record = call("dof", "6-sps", "--json").json
    assert (record["mobility"], record["controllable"], record["holonomic"], record["idle"]) == (12, 6, False, 6)


def test_the_seed_is_said_and_changes_nothing(call):
    answers = [call("dof", "bennett", "--seed", seed, "--json").json for seed in ("0", "7")]
    assert [answer.pop("seed") for answer in answers] == [0, 7]
    assert answers[0] == answers[1]
    assert call("dof", "bennett", "--json").out == call("dof", "bennett", "--json").out
    refused(call("dof", "bennett", "--seed", "x"), "--seed: found 'x'")


def test_ways_to_put_a_mechanism_together(call, tmp_path):
    record = call("dof", "four-bar-by-lengths", "--json").json
    assert (record["mode"], record["modes_complete"], len(record["modes"])) == (1, True, 2)
    assert record["modes"][0]["links"]["crank"] == pytest.approx(60)
    assert record["modes"][1]["joints"]["C"] == pytest.approx([70.32956032, -74.29444804])
    text = call("dof", "four-bar-by-lengths", "--mode", "2").text
    assert "133.881  72.4712" in text
    assert next(line for line in text.splitlines() if "this one" in line).strip().startswith("2")
    rows = call("dof", "four-bar-by-lengths", "--mode", "2", "--trace", "4", "-f", "csv").numbers
    assert rows.shape == (4, 13)
    for name in ("a.html", "a.png"):
        if name.endswith("png"):
            pytest.importorskip("matplotlib")
        answer = call("dof", "stephenson-by-lengths", "--mode", "6", "--plot", tmp_path / name)
        assert (answer.status, (tmp_path / name).exists()) == (0, True)
    points = call("plot", "four-bar-by-lengths", "--mode", "2", "--json").json["joints"]
    assert points[2]["position"][1] < 0
    assert call("dof", "four-bar", "--json").json["modes"] is None
    refused(call("dof", "four-bar-by-lengths", "--mode", "3"), "--mode: found 3, expected 1 or 2")
    refused(call("dof", "four-bar-by-lengths", "--mode", "0"), "--mode: found '0'")
    refused(call("dof", "four-bar", "--mode", "1"), "has the places of its joints")
    refused(call("dof", "puma560", "--mode", "1"), "is no mechanism")
    refused(call("dof", "four-bar-by-lengths", "--set", "angle=1e9*0+200", "--set", "angl=1"), "did you mean 'angle'?")


def test_the_ground_is_said(call, tmp_path):
    record = call("dof", "four-bar", "--json").json
    assert (record["ground"], record["ground_named"], record["ground_note"]) == ("ground", False, None)
    assert "ground        ground, the first link" in call("dof", "four-bar").text
    named = described(tmp_path, LINKS, *FOUR, tail="ground: crank\n")
    record = call("dof", named, "--json").json
    assert (record["ground"], record["ground_named"], record["ground_note"]) == ("crank", True, None)
    assert "crank, as the file says" in call("dof", named).text


@pytest.mark.parametrize(
    ("links", "ground", "said"),
    [
        ("crank, ground, coupler, rocker", "ground", "though ground looks like it: `ground: ground`"),
        ("crank, Base plate, coupler, rocker", "Base plate", "though Base plate looks like it"),
        ("rocker, a, coupler, crank", "a", "though its name is that of a link that moves"),
        ("b, d, a, c", "d", None),
        ("c, d, a, b", "d", "though all drives are at d and none at c"),
    ],
)
def test_a_first_link_that_does_not_look_like_the_ground_gets_a_note(call, tmp_path, links, ground, said):
    first, _, *rest = (part.strip() for part in links.split(","))
    names = {"ground": ground, "crank": first, "coupler": rest[0], "rocker": rest[1]}
    if said and "drives" in said:
        names = {"ground": "d", "crank": "a", "coupler": "b", "rocker": "c"}
    if said is None:
        names = {"ground": "d", "crank": "b", "coupler": "a", "rocker": "c"}
    joints = [", ".join(part for part in joint.split(", ")) for joint in FOUR]
    for old, new in names.items():
        joints = [joint.replace(f"[{old},", f"[@{new},").replace(f" {old}]", f" @{new}]") for joint in joints]
    joints = [joint.replace("@", "") for joint in joints]
    joints[0] += ", actuated: true"
    answer = call("dof", described(tmp_path, links, *joints), "--json")
    assert answer.status == 0
    note = answer.json["ground_note"]
    assert (note is None) if said is None else said in note
    assert answer.json["mobility"] == 1


# Robots and bases ------------------------------------------------------------------------------------


def test_a_robot(call):
    record = call("dof", "puma560", "--json").json
    assert list(record)[: len(KEYS)] == KEYS
    assert (record["links"], record["joints"], record["grubler"], record["constraints"]) == (
        7, 6, 6, {"form": 6, "total": 30},
    )  # fmt: skip
    assert (record["controllable"], record["total"], record["redundancy"], record["holonomic"]) == (6, 6, 0, True)
    assert record["note"] is None
    text = call("dof", "puma560").text
    assert "F = λ(n − j − 1) + Σf = 6(7 − 6 − 1) + 6 = 6" in text
    assert "R = N − M = 6 − 6 = 0" in text


def test_a_planar_and_a_redundant_robot(call):
    planar = call("dof", "planar3r", "--json").json
    assert (planar["space"], planar["lambda"], planar["grubler"], planar["total"]) == ("planar", 3, 3, 3)
    arm = call("dof", "human-arm", "--json").json
    assert (arm["mobility"], arm["total"], arm["redundancy"], arm["holonomic"]) == (9, 6, 3, True)
    assert arm["note"].startswith("redundant: 9 joints for the 6 freedoms")


def test_wheeled_bases(call):
    car = call("dof", "car", "--json").json
    assert list(car)[: len(KEYS)] == KEYS
    assert (car["mobility"], car["steerability"], car["manoeuvrability"]) == (1, 1, 2)
    assert (car["controllable"], car["total"], car["compared"], car["holonomic"]) == (1, 3, "mobility", False)
    assert car["ratio"] == 1 / 3
    assert "nonholonomic" in call("dof", "car").text
    mecanum = call("dof", "mecanum", "--json").json
    assert (mecanum["ratio"], mecanum["holonomic"]) == (1.0, True)
    assert "holonomic: it can at once move in every direction" in call("dof", "mecanum").text
    swerve = call("dof", "swerve", "--json").json
    assert (swerve["manoeuvrability"], swerve["controllable"], swerve["holonomic"]) == (3, 1, False)
    assert "by its constraints holonomic" in call("dof", "skid-steer").text


# Motions ---------------------------------------------------------------------------------------------


def test_a_trace_as_csv(call):
    answer = call("dof", "four-bar", "--trace", "36", "--point", "coupler:3,4", "-f", "csv")
    assert answer.columns[:4] == ["A", "B", "C", "D"]
    assert answer.columns[4:7] == ["crank.x", "crank.y", "crank.angle"]
    assert answer.columns[-2:] == ["P1.x", "P1.y"]
    rows = answer.numbers
    assert rows.shape == (36, 15)
    assert np.allclose(rows[:, 0], np.arange(0, 360, 10), atol=1e-10)
    assert tuple(rows[0, -2:]) == (3.0, 4.0)
    # The crank's pose is a turn about A, which is at the origin.
    assert np.allclose(rows[:, 4:6], 0.0, atol=1e-12)
    assert np.allclose(np.cos(np.radians(rows[:, 6] - rows[:, 0])), 1.0)


@pytest.mark.slow
def test_formats_of_a_trace_agree(call, tmp_path):
    words = ["dof", "slider-crank", "--trace", "7", "--point", "rod:1,0.5", "--point", "slider:0,0"]
    table = call(*words, "-f", "csv").numbers
    np.save(tmp_path / "here.npy", table)
    assert call(*words, "--output", tmp_path / "t.npy").out == b""
    assert np.array_equal(np.load(tmp_path / "t.npy"), table)
    call(*words, "--output", tmp_path / "t.csv")
    assert (tmp_path / "t.csv").read_bytes() == call(*words, "-f", "csv").out
    documents = call(*words, "-f", "jsonl").jsonl
    whole = call(*words, "--json").json
    assert [document["step"] for document in documents] == [*range(1, 8)]
    assert (whole["driven"], whole["closed"], whole["mechanism"]) == ("A", True, "slider-crank")
    for document, configuration, row in zip(documents, whole["configurations"], table, strict=True):
        head = {key: value for key, value in whole.items() if key != "configurations"}
        assert document == head | configuration
        assert list(document["q"].values()) == row[:4].tolist()
        assert document["links"]["crank"][0][3] == row[4]
        assert np.ravel([point[:2] for point in document["points"]]).tolist() == row[-4:].tolist()
    shown = call(*words)
    assert "the motion comes back to its beginning" in shown.text
    assert max(map(len, shown.lines)) <= 80


def test_a_trace_in_other_units(call):
    metres = call("dof", "slider-crank", "--trace", "5", "-f", "csv").numbers
    other = call("dof", "slider-crank", "--trace", "5", "-f", "csv", "--length", "mm", "--angle", "rad")
    slider = other.columns.index("slider.x")
    assert np.allclose(other.numbers[:, slider], 1000 * metres[:, slider])
    assert np.allclose(other.numbers[:, 0], np.radians(metres[:, 0]))
    point = call("dof", "slider-crank", "--trace", "1", "--point", "rod:1000,500", "--length", "mm", "-f", "csv")
    assert point.numbers[0, -2:].tolist() == [1000.0, 500.0]


def test_a_trace_in_space(call):
    answer = call("dof", "sarrus", "--trace", "4", "--point", "platform:0,0,1", "-f", "csv")
    assert answer.columns[-3:] == ["P1.x", "P1.y", "P1.z"]
    assert "platform.yaw" in answer.columns
    assert answer.numbers.shape[0] == 4


def test_a_parameter_changes_the_motion(call):
    first = call("dof", "four-bar", "--trace", "3", "-f", "csv").numbers
    other = call("dof", "four-bar", "--set", "crank_angle=80", "--trace", "3", "-f", "csv").numbers
    assert not np.allclose(first[1], other[1])


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["four-bar", "--trace", "0"], ["--trace: found '0'", "expected a whole number from 1"]),
        (["four-bar", "--trace", "many"], ["--trace: found 'many'"]),
        (["four-bar", "--trace", "1000000"], ["to 100000"]),
        (["four-bar", "--drive", "A"], ["--drive is about a motion", "--trace N or --plot"]),
        (["four-bar", "--point", "crank:1,2"], ["--point is about a motion"]),
        (["four-bar", "--trace", "3", "--drive", "Q"], ["unknown joint 'Q'"]),
        (["four-bar", "--trace", "3", "--point", "crnk:1,2"], ["--point", "unknown link 'crnk'", "'crank'"]),
        (["four-bar", "--trace", "3", "--point", "1,2"], ["expected LINK:X,Y"]),
        (["four-bar", "--trace", "3", "--point", "crank:1"], ["--point: found 1 value", "expected 2: x, y"]),
        (["four-bar", "--trace", "3", "--point", "crank:1,b"], ["--point", "b"]),
        (["sarrus", "--trace", "3", "--point", "platform:1,2"], ["expected 3: x, y and z"]),
        (["four-bar", "--trace", "3", "--between", "crank,coupler"], ["exclude each other"]),
        (["puma560", "--trace", "3"], ["--trace is for mechanisms"]),
        (["car", "--trace", "3"], ["--trace is for mechanisms"]),
        (["parallel-four-bar-detuned", "--trace", "3"], ["does not move"]),
        (["shaky-triangle", "--trace", "3"], ["only trembles"]),
        (["cam-roller", "--trace", "3"], ["contacts"]),
        (["four-bar", "--output", "x.npy"], ["an array holds configurations", "--trace N"]),
        (["four-bar", "--output", "x.txt"], ["expected a name that ends with"]),
        (["four-bar", "--plot", "x.bmp"], ["--plot: found 'x.bmp'", ".png, .svg, .pdf, .html or .gif"]),
        (["puma560", "--plot", "x.png"], ["--plot is for mechanisms"]),
        (["fourbar"], ["did you mean four-bar"]),
        (["four-bar", "extra"], ["'extra'", "expected nothing more"]),
    ],
)
def test_what_dof_cannot_do(call, words, said, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    refused(call("dof", *words), *said)
    assert list(tmp_path.iterdir()) == []


# Pictures --------------------------------------------------------------------------------------------

drawn = pytest.mark.skipif(find_spec("matplotlib") is None, reason="matplotlib is not installed")


@drawn
@pytest.mark.parametrize(("ending", "start"), sweep([(".png", b"\x89PNG"), (".svg", b"<?xml"), (".pdf", b"%PDF")], 3))
def test_a_picture(call, tmp_path, ending, start):
    path = tmp_path / f"four{ending}"
    answer = call("dof", "four-bar", "--plot", path, "--point", "coupler:3,4")
    assert (answer.status, answer.err) == (0, "")
    assert answer.out == call("dof", "four-bar").out
    first = path.read_bytes()
    assert first.startswith(start)
    call("dof", "four-bar", "--plot", path, "--point", "coupler:3,4")
    assert path.read_bytes() == first, "the same picture is the same file"


@drawn
@pytest.mark.parametrize("name", sweep(["shaky-triangle", "planetary", "scotch-yoke", "wedge", "jansen-leg"], 5))
def test_what_does_not_move_or_slides_is_drawn_too(call, tmp_path, name):
    path = tmp_path / "p.svg"
    assert call("dof", name, "--plot", path).status == 0
    text = path.read_text()
    mechanism = load_any(name)
    assert mechanism.name in text
    for joint in mechanism.joints:
        assert f">{joint.name}<" in text


@drawn
def test_a_mechanism_in_pieces_is_drawn_too(call, tmp_path):
    path = described(tmp_path, LINKS, FOUR[0], FOUR[3])
    answer = call("dof", path, "--plot", tmp_path / "p.png")
    assert (answer.status, answer.err) == (0, "")


@drawn
def test_a_picture_and_a_trace_at_once(call, tmp_path):
    answer = call("dof", "four-bar", "--trace", "12", "-f", "csv", "--plot", tmp_path / "p.svg")
    assert answer.numbers.shape == (12, 13)
    assert (tmp_path / "p.svg").exists()


def test_without_matplotlib_a_sentence_says_how_to_get_it(call, tmp_path, monkeypatch):
    monkeypatch.setattr("robokin.pictures.workspace_stills.find_spec", lambda name: None)
    refused(call("dof", "four-bar", "--plot", tmp_path / "p.png"), "matplotlib", "`pip install matplotlib`")


# From Python -----------------------------------------------------------------------------------------


def test_the_same_from_python(call):
    found = robokin.mobility_of(robokin.load_mechanism("bennett"))
    record = call("dof", "bennett", "--json").json
    assert (found.count, found.mobility, found.verdict, found.note) == tuple(
        record[key] for key in ("grubler", "mobility", "verdict", "note")
    )
    assert robokin.mobility_of is mobility_of
    assert {type(load_any(name)) for name in library_names()} == {Robot, Tree, Mechanism, WheeledBase}
