"""`robokin workspace` of fingers, pendant arms and screws: every option answers, or says what it cannot do."""

from __future__ import annotations

import json

import numpy as np
import pytest
from cli.conftest import refused
from cli.test_couplings import FINGER, PENDANT, SCREW, write  # noqa: F401  (a fixture)
from cli.test_documents import document_schema, known_fault

import robokin

TEXTS = {"finger": FINGER, "pendant": PENDANT, "screw": SCREW.replace("a: 300}", "a: 300, limits: [-90, 90]}")}
FEW = ("--samples", "2000")


@pytest.fixture
def paths(write):  # noqa: F811
    return {name: write(text, f"{name}.yaml") for name, text in TEXTS.items()}


@pytest.mark.parametrize("name", TEXTS)
def test_every_form_of_the_answer_is_there(call, paths, tmp_path, name):
    answer = call("workspace", paths[name], *FEW)
    assert answer.status == 0
    assert not answer.err
    record = call("workspace", paths[name], *FEW, "--slice", "z=10", "--json").json
    assert known_fault(document_schema("workspace"), record) is None
    assert record["volume"] > 0.0
    assert record["cuts"][0]["area"] is not None
    assert call("workspace", paths[name], *FEW, "--format", "csv").text.startswith("robot,")
    for ending in ("svg", "html") if name == "finger" else ("html",):
        assert call("workspace", paths[name], *FEW, "--plot", tmp_path / f"a.{ending}").status == 0
        assert (tmp_path / f"a.{ending}").stat().st_size > 1000
    if name == "screw":
        assert call("workspace", paths[name], *FEW, "--compare", "planar2r").status == 0


@pytest.mark.parametrize("name", TEXTS)
def test_samples_are_poses_of_values_within_all_limits(call, paths, tmp_path, name):
    robot = robokin.load(paths[name])
    out = tmp_path / "a.csv"
    assert call("workspace", paths[name], "--samples", "300", "--with", "joints,poses", "--output", out).status == 0
    rows = np.genfromtxt(out, delimiter=",", names=True)
    q = np.radians(np.stack([rows[f"q{i + 1}"] for i in range(robot.n)], axis=1))
    assert robot.within_limits(q).all()
    T = robokin.forward_kinematics(robot, q)
    np.testing.assert_allclose(T[:, :3, 3] * 1000.0, np.stack([rows[a] for a in "xyz"], axis=1), atol=1e-6)
    lines = tmp_path / "a.jsonl"
    assert call("workspace", paths[name], "--samples", "5", "--output", lines).status == 0
    for line in lines.read_text().splitlines():
        assert known_fault(document_schema("workspace"), json.loads(line)) is None


@pytest.mark.parametrize("name", TEXTS)
def test_places_that_forward_kinematics_reaches_are_there(call, paths, name):
    robot = robokin.load(paths[name])
    low, high = robot.limits.T
    low, high = np.maximum(low, -3.0), np.minimum(high, 3.0)
    q = low + (high - low) * np.random.default_rng(6).random((400, robot.n))
    q = q[robot.within_limits(q)][:3]
    assert len(q) == 3
    places = [",".join(map(repr, p)) for p in (robokin.forward_kinematics(robot, q)[:, :3, 3] * 1000.0).tolist()]
    at = [part for place in places for part in ("--at", place)]
    records = call("workspace", paths[name], *at, "--json").json
    for record in records:
        assert known_fault(document_schema("workspace"), record) is None
        assert record["reachable"]
    answer = call("workspace", paths[name], "--at", "5000,0,0")
    assert answer.status == 3
    assert "not proven" not in answer.text  # farther away than the arm is long


def test_a_fingers_places_have_configurations_that_are_not_counted(call, paths):
    answer = call("workspace", paths["finger"], "--at", "60,0,-50")
    assert answer.status == 0
    assert "not counted" in answer.text
    assert call("workspace", paths["finger"], "--at", "60,0,-50", "--json").json["solutions"] is None


def test_what_cannot_be_sound_is_refused_by_its_option(call, paths, write, tmp_path):  # noqa: F811
    spare = FINGER.replace("alpha: -90", "alpha: 0, a: 10").replace(
        "  - {name: dip", "  - {name: mid, type: R, a: 20, limits: [0, 60]}\n  - {name: dip"
    )
    refused(call("workspace", write(spare), "--dextrous", *FEW), "dextrous", "joint dip hangs on pip")
    refused(call("workspace", paths["finger"], "--dextrous", *FEW), "dextrous", "joint dip hangs on pip")
    out = tmp_path / "a.csv"
    grid = call("workspace", paths["pendant"], "--sampling", "grid", "--samples", "100", "--output", out)
    refused(grid, "sampling", "found 'grid', expected 'sobol' or 'random'")
    assert not out.exists()
    led = FINGER.replace("follows: pip", "follows: abd")
    refused(call("workspace", write(led), "--section", *FEW), "--section", "moves others, too", "expected --slice")
    assert call("workspace", write(led), *FEW).status == 0
    endless = SCREW.replace(", limits: [0, 3600]", "")
    refused(call("workspace", write(endless), *FEW), "joint spindle turns without limits")
