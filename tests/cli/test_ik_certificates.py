"""What `robokin ik` says of completeness and of self-motions, shown with results made by hand."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

import robokin
from robokin.grading.configuration_marks import countable
from robokin.inverse.solutions import Arc, Family, Result, Solution
from robokin.reports import solution_report as answers_module
from robokin.reports.solution_verdicts import verdict

KEYS = ["complete", "basis", "certificate", "counts", "families", "families_complete", "method"]
"""What a document says from `complete` on, in this order."""

TARGET = ["--xyz", "500,100,300", "--rpy", "180,0,45"]


def solution(degrees, free=(), branch="shoulder right, elbow up, wrist flip"):
    return Solution(np.radians(degrees), branch, True, 1e-13, 1e-14, free)


def arc(*degrees, whole=False):
    return Arc(np.radians(degrees), whole)


def regular(count=8, **more):
    return Result(tuple(solution([float(k), 0, 0, 0, 10, 0]) for k in range(count)), method="spherical wrist", **more)


STRAIGHT = [10.0, -20.0, 100.0, 0.0, 0.0, 30.0]
"""A configuration in degrees with a straight wrist."""

TURNED = [10.0, -20.0, 100.0, 20.0, 0.0, 10.0]
"""Another one for the same pose."""


def straight(*arcs, closed=True, dimension=1, complete=True):
    """Two regular solutions and one that stands for the self-motion of joints 4 and 6."""
    family = Family((4, 6), dimension, closed, arcs, 2)
    return Result(
        (solution([1.0, 0, 0, 0, 10, 0]), solution([2.0, 0, 0, 0, 10, 0]), solution(STRAIGHT, (4, 6))),
        complete, "spherical wrist", basis="accounted" if complete else None,
        certificate="8 paths from two starts ended: 2 regular, 6 singular" if complete else "1 of 8 paths was lost",
        families=(family,), counts={"closing": 3, "listed": 3},
    )  # fmt: skip


@pytest.fixture
def shown(call, monkeypatch):
    """What the command prints where the solver answers with a given result."""

    def shown(result, *arguments):
        monkeypatch.setattr(answers_module, "solve_many", lambda robot, T, **_: [result for _ in T])
        return call("ik", "puma560", *TARGET, *arguments)

    return shown


def below_the_table(answer):
    """The lines after the last row of numbers."""
    last = max(i for i, line in enumerate(answer.lines) if line and line.split()[0].lstrip("!~").isdigit())
    return answer.lines[last + 2 :]


# The document ---------------------------------------------------------------------------------------------


def test_a_count_is_in_the_document(shown):
    result = regular(
        complete=True, basis="counted", certificate="8 of 8 complex solutions found, 8 real", counts={"listed": 8}
    )
    document = shown(result, "--json").json
    names = list(document)
    assert names[names.index("complete") : names.index("method") + 1] == KEYS
    assert (document["basis"], document["certificate"]) == ("counted", "8 of 8 complex solutions found, 8 real")
    assert (document["counts"], document["families"]) == ({"listed": 8}, [])
    assert shown(result, "-f", "jsonl").jsonl == [document]


def test_without_a_proof_there_is_no_basis(shown):
    document = shown(regular(complete=False, certificate="15 of 16 complex solutions found"), "--json").json
    assert (document["complete"], document["basis"]) == (False, None)
    assert document["certificate"] == "15 of 16 complex solutions found"


def test_a_self_motion_is_in_the_document(shown):
    turns = [[*STRAIGHT[:3], q4, 0.0, 30.0 - q4] for q4 in (-110.0, 0.0, 170.0)]
    document = shown(straight(arc(*turns)), "--json").json
    (family,) = document["families"]
    assert list(family) == ["joints", "dimension", "closed", "solution", "intervals"]
    assert (family["joints"], family["dimension"], family["closed"], family["solution"]) == ([4, 6], 1, True, 3)
    (interval,) = family["intervals"]
    assert list(interval) == ["whole", "from", "to", "ranges"]
    assert interval["whole"] is False
    assert interval["from"] == pytest.approx(turns[0])
    assert interval["to"] == pytest.approx(turns[-1])
    assert interval["ranges"] == {"q4": pytest.approx([-110.0, 170.0]), "q6": pytest.approx([-140.0, 140.0])}
    radians = shown(straight(arc(*turns)), "--json", "--angle", "rad").json["families"][0]["intervals"][0]
    assert radians["ranges"]["q4"] == pytest.approx(np.radians([-110.0, 170.0]))


def test_ranges_are_those_along_the_arc_not_of_its_ends(shown):
    back = [[*STRAIGHT[:3], q4, 0.0, q6] for q4, q6 in ((0.0, 0.0), (40.0, -90.0), (0.0, -360.0))]
    (interval,) = shown(straight(arc(*back, whole=True)), "--json").json["families"][0]["intervals"]
    assert interval["whole"] is True
    assert interval["ranges"] == {"q4": pytest.approx([0.0, 40.0]), "q6": pytest.approx([-360.0, 0.0])}


def test_a_csv_has_the_columns_that_it_had(shown, call):
    plain = call("ik", "puma560", *TARGET, "-f", "csv").columns
    assert plain[-5:] == ["branch", "within_limits", "position_error", "angle_error", "reason"]


# The sentence ---------------------------------------------------------------------------------------------


def test_all_and_why(shown):
    answer = shown(
        regular(complete=True, basis="counted", certificate="8 of 8 complex solutions found, 8 real"), "--no-limits"
    )
    assert answer.lines[1:4] == [
        "8 solutions, these are all: 8 of 8 complex solutions found, 8 real",
        "(spherical wrist)",
        "",
    ]


def test_there_may_be_more_and_why(shown):
    answer = shown(regular(1, complete=False, certificate="15 of 16 complex solutions found."), "--no-limits")
    assert answer.lines[1:4] == [
        "1 solution, there may be more: 15 of 16 complex solutions found",
        "(spherical wrist)",
        "",
    ]


def test_a_cut_list_says_of_how_many():
    known = regular(
        3, complete=False, all_known=True, certificate="8 of 8 complex solutions found, 5 real",
        counts={"closing": 5, "within_limits": 4, "turns": 9, "listed": 3},
    )  # fmt: skip
    why = "8 of 8 complex solutions found, 5 real (spherical wrist)"
    assert verdict(known).replace("\xa0", " ") == f"3 solutions of all 4: {why}"
    assert verdict(known, (5,)).startswith("3 solutions of all 4 (any value of q5): ")
    assert verdict(known, turns=True).startswith("3 solutions of all 9, full turns included: ")
    assert verdict(known, held="q1 held at 2").startswith("3 solutions with q1 held at 2 of all 4: ")
    without_limits = regular(3, complete=False, all_known=True, counts={"closing": 5, "listed": 3})
    assert verdict(without_limits).startswith("3 solutions of all 5 ")
    unknown = regular(3, complete=False, counts={"closing": 5, "within_limits": 4, "listed": 3})
    assert verdict(unknown).startswith("3 solutions, there may be more ")


def test_a_self_motion_whose_solution_was_cut_away_has_none(call):
    """q5 = 0 of a UR5e: two self-motions and four regular solutions, which come first."""
    poses = call("fk", "ur5e", "--q=10,-80,70,20,0,30", "-f", "csv").out
    arguments = ["ik", "ur5e", "-i", "-", "--max", "1"]
    cut = call(*arguments, "-f", "jsonl", stdin=poses).jsonl[0]
    assert [family["solution"] for family in cut["families"]] == [None] * len(cut["families"])
    assert "stands for it" not in call(*arguments, stdin=poses).text
    whole = call(*arguments[:4], "-f", "jsonl", stdin=poses).jsonl[0]
    for family in whole["families"]:
        assert whole["solutions"][family["solution"] - 1]["self_motion"] == family["joints"]


def test_a_result_without_a_certificate_reads_as_before():
    assert verdict(regular(complete=True)).replace("\xa0", " ") == "8 solutions, these are all (spherical wrist)"


@pytest.mark.parametrize(("most", "listed"), [(None, "16 solutions"), (1, "1 solution")])
def test_solutions_that_are_all_on_known_self_motions_are_said_to_be_of_them(most, listed):
    arm = robokin.load("iiwa14")
    result = robokin.solve_ik(arm, robokin.transform("Trans(0.5, 0.1, 0.6) RPY(0, pi, 0)"), most=most)
    assert result.families_complete and len(result.families) == 8
    assert verdict(result).startswith(f"{listed} of 8 self-motions, every self-motion within the limits is given: ")


def test_a_solution_that_stands_for_a_self_motion_is_counted_as_that():
    said = verdict(straight(arc(STRAIGHT, TURNED)))
    assert said.startswith("2 solutions and 1 self-motion, these are all: 8 paths from two starts ended")
    said = verdict(straight(arc(STRAIGHT, TURNED), complete=False))
    assert said.startswith("2 solutions and 1 self-motion, there may be more: 1 of 8 paths was lost")
    # Where the limits leave one configuration of it, or none, it is a solution as others are.
    assert verdict(straight(arc(STRAIGHT))).startswith("3 solutions, these are all: ")
    assert verdict(straight()).startswith("3 solutions, these are all: ")


def test_a_self_motion_outside_the_limits_is_not_told(shown):
    answer = shown(straight())
    assert not any("stands for it" in line for line in answer.lines)
    (family,) = shown(straight(), "--json").json["families"]
    assert (family["solution"], family["intervals"]) == (None, [])
    nowhere = replace(straight(), solutions=(), reason="outside the joint limits", complete=True)
    assert "self-motion" not in shown(nowhere).text
    assert shown(nowhere, "--json").json["families"][0]["solution"] is None


@pytest.mark.parametrize(
    ("counts", "certificate", "words"),
    [
        ({"closing": 8, "listed": 0}, "", "; 8 found and closing, 0 within the joint limits"),
        (
            {"found": 20, "closing": 16, "distinct": 8, "within_limits": 0, "listed": 0}, "8 of 8 found",
            "; 8 found and closing, 0 within the joint limits; 8 of 8 found",
        ),
        ({"found": 8, "closing": 0, "distinct": 0, "listed": 0}, "", "; 8 candidates found, 0 closing"),
        ({"closing": 0, "listed": 0}, "8 of 8 found, 0 real", "; 8 of 8 found, 0 real"),
        ({"closing": 0, "listed": 0}, "", ""),
        ({}, "", ""),
    ],
)  # fmt: skip
def test_none_says_where_the_candidates_went(counts, certificate, words):
    basis = "counted" if certificate else None
    reason = "outside the joint limits"
    known = bool(certificate)
    result = Result((), True, "elimination", reason, None, counts, False, basis, certificate, known)
    assert verdict(result).replace("\xa0", " ") == f"no solution: outside the joint limits{words} (elimination)"


def test_none_without_a_proof_says_its_reason_alone():
    result = Result((), False, "numeric", "none found", None, {"closing": 0}, certificate="found by search")
    assert verdict(result) == "no solution: none found (numeric)"


def test_none_within_the_limits_is_counted_by_the_command(call, tmp_path):
    path = tmp_path / "arm.yaml"
    path.write_text(
        "robokin: 1\nname: Arm\nunits: {length: m, angle: deg}\njoints:\n"
        "  - {type: R, a: 1, limits: [100, 101]}\n  - {type: R, a: 1, limits: [0, 1]}\n"
    )
    answer = call("ik", path, "--xy", "1,1")
    assert answer.status == 3
    assert "2 found and closing, 0 within the joint limits" in answer.text.replace("\n", " ")
    assert call("ik", path, "--xy", "1,1", "--json").json["counts"]["closing"] == 2


# Self-motions in words ------------------------------------------------------------------------------------


def test_a_self_motion_in_words(shown):
    turns = [[*STRAIGHT[:3], q4, 0.0, 30.0 - q4] for q4 in (-110.0, 0.0, 170.0)]
    assert below_the_table(shown(straight(arc(*turns)), "--no-limits")) == [
        "self-motion: joints q4 and q6 can move while the pose stays; solution 3 stands",
        "for it",
        "  q4 from -110 to 170 with q6 from 140 to -140",
    ]


def test_a_whole_curve_in_words(shown):
    round_ = [[*STRAIGHT[:3], q4, 0.0, 30.0 - q4] for q4 in (0.0, 120.0, 240.0, 360.0)]
    back = [[*STRAIGHT[:3], q4, 0.0, 30.0] for q4 in (0.0, 40.0, 10.0, 0.0)]
    answer = below_the_table(shown(straight(arc(*round_, whole=True), arc(*back, whole=True))))
    assert "  a closed curve, all of it within the limits: q4 from 0 to 360 with q6 from 30" in answer
    assert "    to -330" in answer
    assert "  a closed curve, all of it within the limits: q4 between 0 and 40 with q6 at 30" in answer
    free = below_the_table(shown(straight(arc(*round_, whole=True)), "--no-limits"))
    assert free[-1] == "  a closed curve: q4 from 0 to 360 with q6 from 30 to -330"


def test_pieces_points_and_what_was_not_followed(shown):
    piece = [[*STRAIGHT[:3], q4, 0.0, -q4] for q4 in (10.0, 20.5)]
    touch = [[*STRAIGHT[:3], 90.0, 0.0, -90.0]]
    answer = below_the_table(shown(straight(arc(*piece), arc(*touch), closed=False)))
    assert "  q4 from 10 to 20.5 with q6 from -10 to -20.5" in answer
    assert "  one configuration within the limits: q4 = 90 and q6 = -90" in answer
    assert "  it was not followed to its end: there may be more of it" in answer
    surface = below_the_table(shown(straight(dimension=2, closed=False)))
    assert " ".join(surface).startswith(
        "self-motion: joints q4 and q6 can move while the pose stays in 2 independent ways; solution 3 stands for it"
    )


def test_every_line_fits_a_page(shown):
    many = [np.linspace(-179.123, 179.456, 6) * k for k in (1.0, -1.0)]
    family = Family((1, 2, 3, 4, 5, 6), 1, True, (arc(*many),), 0)
    result = Result(
        (solution(many[0], (1, 2, 3, 4, 5, 6)),), True, "elimination", basis="accounted", certificate="path " * 40,
        families=(family,),
    )  # fmt: skip
    answer = shown(result)
    assert max(map(len, answer.lines)) <= 80
    assert "\xa0" not in answer.text


def test_a_self_motion_without_its_curve_has_the_glossary_s_words(shown):
    result = Result((solution(STRAIGHT, (4, 6)),), False, "spherical wrist")
    assert below_the_table(shown(result, "--no-limits")) == [
        "self-motion: joints q4 and q6 can move while the pose stays; one such posture is",
        "listed",
    ]


# What else reads a result ---------------------------------------------------------------------------------


def test_of_a_self_motion_no_solution_can_be_missing():
    assert countable(regular(complete=True))
    assert not countable(straight(arc(STRAIGHT)))
    assert not countable(regular(complete=False))


def test_the_nearest_pose_is_never_said_to_be_complete(call):
    arguments = ["scorbot", "--xyz", "300,40,200", "--rpy", "0,170,8", "--tol-angle", "0.2"]
    document = call("ik", *arguments, "--json").json
    assert document["solutions"]
    assert (document["complete"], document["basis"], document["families"]) == (False, None, [])
    assert "nearest pose" in document["certificate"]


def test_families_of_the_library_reach_the_pose(call):
    """Whatever self-motions are reported: both ends of each interval reach the target."""
    document = call("ik", "puma560", "--pose", "Trans(-149.09,921.12,20.32) RPY(0,90,90)", "--json").json
    robot = robokin.load("puma560")
    for family in document["families"]:
        for interval in family["intervals"]:
            for end in ("from", "to"):
                T = robokin.forward_kinematics(robot, np.radians(interval[end]))
                T[:3, 3] *= 1000.0
                assert np.allclose(T, document["target"]["matrix"], rtol=0, atol=1e-6), json.dumps(family)
