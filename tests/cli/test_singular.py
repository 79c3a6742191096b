"""`robokin singular`: conditions in the units, in every format."""

from __future__ import annotations

import json

import numpy as np
import pytest
from sweeps import sweep

from .conftest import refused

KEYS = ["name", "joints", "condition", "values", "within_limits", "example", "example_within_limits", "lost"]


def test_the_document(call):
    answer = call("singular", "puma560", "--json")
    assert (answer.status, answer.err) == (0, "")
    document = answer.json
    assert list(document) == ["schema", "robot", "id", "units", "task", "full_rank", "singularities"]
    shoulder, elbow, wrist = document["singularities"]
    assert all(list(one) == KEYS for one in (shoulder, elbow, wrist))
    assert shoulder["condition"] == "a2 c2 + a3 c23 + d4 s23 = 0: 431.8 c2 - 20.32 c23 + 433.07 s23 = 0"
    assert elbow["values"] == pytest.approx(np.degrees([np.arctan2(-433.07, 20.32), np.arctan2(433.07, -20.32)]))
    assert "atan2(d4, a3)" in elbow["condition"]
    assert (wrist["joints"], wrist["values"], wrist["within_limits"]) == ([5], [0.0, 180.0], [True, False])


@pytest.mark.parametrize("robot", sweep(["puma560", "anthropomorphic", "stanford", "scara", "ur5e", "iiwa14"], 3))
def test_the_examples_are_singular(call, robot):
    for one in call("singular", robot, "--json").json["singularities"]:
        q = ",".join(map(repr, one["example"]))
        document = call("jacobian", robot, "--q", q, "--json").json
        assert document["rank"] < document["full_rank"]
        assert one["lost"] == "; ".join(lost["words"] for lost in document["singular_direction"])


def test_units_and_parameters(call):
    own = call("singular", "anthropomorphic", "--json").json["singularities"]
    other = call("singular", "anthropomorphic", "--json", "--angle", "rad", "--length", "mm", "--set", "a2=0.7").json
    assert other["units"] == {"length": "mm", "angle": "rad"}
    assert own[1]["values"] == [0.0, 180.0]
    assert other["singularities"][1]["values"] == [0.0, np.pi]
    assert "700 c2 + 400 c23" in other["singularities"][0]["condition"]


def test_other_formats(call, tmp_path):
    document = call("singular", "puma560", "--json").json
    head = {name: document[name] for name in ("schema", "robot", "id", "units", "task", "full_rank")}
    assert call("singular", "puma560", "-f", "jsonl").jsonl == [{**head, **one} for one in document["singularities"]]
    table = call("singular", "puma560", "-f", "csv").csv
    assert table[0] == ["name", "joints", "condition", "values", "example", "lost"]
    assert [float(value) for value in table[3][3].split()] == [0.0, 180.0]
    assert call("singular", "puma560", "-o", tmp_path / "s.json").status == 0
    assert json.loads((tmp_path / "s.json").read_text()) == document


def test_none_is_an_answer(call):
    assert call("singular", "cartesian", "--json").json["singularities"] == []
    assert "no singular configuration" in call("singular", "cartesian").text


def test_tables_fit_a_page(call):
    for robot in ("puma560", "iiwa14", "scorbot", "ur5e"):
        answer = call("singular", robot)
        assert answer.status == 0
        assert max(map(len, answer.lines)) <= 80
        assert "…" not in answer.text


@pytest.mark.parametrize(
    ("arguments", "fragments"),
    [
        (["pum560"], ["'pum560'", "did you mean", "puma560"]),
        (["assembly"], ["no joints"]),
        (["four-bar"], ["mechanism", "expected a robot"]),
        (["puma560", "--task", "pos"], ["--task", "'pos'", "'position'"]),
        (["puma560", "-o", "x.npy"], ["expected a name that ends with"]),
    ],
)
def test_what_is_wrong_is_said(call, arguments, fragments):
    refused(call("singular", *arguments), *fragments)
