"""`robokin ik --explain`: the lesson behind an answer, on a page and as data."""

from __future__ import annotations

import math

import pytest

from .conftest import refused

PLANAR = ["ik", "planar3r-brac", "--xy", "26.4743,50.8716", "--phi", "85", "--explain"]
PUMA = ["ik", "puma560", "--pose", "Trans(-149.09,500,300) RPY(20,130,40)", "--no-limits", "--explain"]


def test_the_page_shows_formulas_numbers_and_ends(call):
    answer = call(*PLANAR)
    assert answer.status == 0
    text = answer.text
    assert "2 solutions, these are all" in text
    assert "The lesson: planar 3R arm\n\ngiven: a₁ = 20,  a₂ = 32,  a₃ = 10\n" in text
    assert (
        "     c₂ = (p_Wx² + p_Wy² − a₁² − a₂²) / (2·a₁·a₂)\n        = (25.6027² + 40.9097² − 20² − 32²) / (2·20·32)"
        in text
    )
    assert "── θ₂ +: elbow down\n" in text
    assert "── θ₂ −: elbow up\n" in text
    assert "s₂ = −√(1 − c₂²)\n        = −√(1 − 0.70" in text
    assert "θ₃ = φ − θ₁ − θ₂\n        = 85° − 30.0" in text
    assert text.endswith("\n2 ways, 2 solutions\n")


@pytest.mark.parametrize("arguments", [PLANAR, PUMA, [*PUMA, "--length", "m"]])
def test_the_page_has_80_columns_and_its_steps_are_numbered(call, arguments):
    lines = call(*arguments).lines
    assert max(map(len, lines)) <= 80
    assert not [line for line in lines if line != line.rstrip()]
    numbers = [int(line[:3]) for line in lines if line[:3].strip().isdigit() and line[3:5] == "  " and line[5:6] != " "]
    assert numbers == list(range(1, len(numbers) + 1))


def test_the_document_has_the_lesson_beside_the_answer(call):
    plain = call(*PUMA[:-1], "--json").json
    document = call(*PUMA, "--json").json
    lesson = document.pop("explanation")
    assert document == plain
    assert list(lesson) == ["title", "given", "steps", "branches"]
    assert lesson["given"]["a₂"] == 431.8
    assert lesson["given"]["α₁"] == pytest.approx(-90.0)
    for step in lesson["steps"]:
        assert list(step) == ["name", "formula", "values", "result", "branch", "note"]
        assert step["formula"].startswith(f"{step['name']} = ")
    assert len(lesson["branches"]) == len(document["solutions"]) == 8
    for branch in lesson["branches"]:
        solution = document["solutions"][branch["solution"] - 1]
        assert branch["q"] == pytest.approx(solution["q"], abs=1e-9)
        assert branch["name"] == solution["branch"]
        assert branch["reason"] is None


def test_a_step_can_be_worked_out_from_its_values(call):
    arm = ["ik", "planar3r-brac", "--xy", "26.4743,50.8716", "--explain", "--json"]
    for arguments, unit in ((["--phi", "85"], math.radians(1.0)), (["--phi", "1.4835", "--angle", "rad"], 1.0)):
        steps = {step["name"]: step for step in call(*arm, *arguments).json["explanation"]["steps"]}
        v = steps["c₂"]["values"]
        square = v["p_Wx"] ** 2 + v["p_Wy"] ** 2 - v["a₁"] ** 2 - v["a₂"] ** 2
        assert steps["c₂"]["result"] == pytest.approx(square / (2 * v["a₁"] * v["a₂"]))
        v = steps["θ₂"]["values"]
        assert steps["θ₂"]["result"] * unit == pytest.approx(math.atan2(v["s₂"], v["c₂"]))


def test_limits_and_reach_are_said(call):
    limited = call(*PUMA[:-2], "--explain", "--json").json
    ends = limited["explanation"]["branches"]
    assert sorted(end["solution"] for end in ends if end["solution"]) == [*range(1, len(limited["solutions"]) + 1)]
    reasons = [end["reason"] for end in ends if not end["solution"]]
    assert reasons
    assert all(reason.startswith("outside the joint limits: q") for reason in reasons)
    far = call("ik", "planar3r", "--xy", "3,1", "--phi", "0", "--explain")
    assert far.status == 3
    assert "→  no way on: c₂ = " in far.text
    assert "> 1: out of reach" in far.text


def test_a_cut_list_says_what_is_not_listed(call):
    lesson = call(*PUMA, "--max", "1", "--json").json["explanation"]
    assert [end["reason"] for end in lesson["branches"]].count("not among the solutions that are listed") == 7


def test_a_line_and_a_file(call, tmp_path):
    assert "explanation" in call(*PLANAR, "-f", "jsonl").jsonl[0]
    assert call(*PLANAR, "-o", tmp_path / "lesson.json").status == 0
    assert '"explanation"' in (tmp_path / "lesson.json").read_text()


def test_what_has_no_lesson(call):
    target = ["--xyz", "300,100,400", "--rpy", "0,0,0", "--explain"]
    refused(call("ik", "ur5", *target), "has no lesson, expected one of these: planar 2R and 3R arms", "SCARA")
    refused(call("ik", "puma560", "--xyz", "300,100,400", "--explain"), "leaves the orientation open")
    refused(call("ik", "planar3r", "--xy", "1,1", "--explain"), "leaves the orientation open")
    refused(call("ik", "puma560", "--input", "-", "--explain", stdin=b""), "--explain and --input exclude each other")
    refused(call(*PLANAR, "-f", "csv"), "--explain: found the format csv, expected table, json or jsonl")
    refused(call(*PLANAR, "--method", "numeric"), "--explain shows the closed form")
