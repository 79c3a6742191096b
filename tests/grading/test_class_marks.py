"""From Python a class gets the marks that `robokin check` gives it."""

from __future__ import annotations

import numpy as np
import pytest

import robokin
from robokin.errors import InputError
from robokin.grading import grade_configurations, grade_jacobians, grade_poses, grade_tables
from robokin.grading.feedback import LEVELS
from robokin.grading.marking import AnswerTask, GivenValue, Rules, Subject, marked
from robokin.records.mark_records import report_record

PUMA = robokin.load("puma560")
PLANAR = robokin.load("planar2r")
Q = PUMA.poses["home"]
T = robokin.forward_kinematics(PUMA, Q)


def turned(T, angle=0.1):
    moved = T.copy()
    moved[:3, :3] = moved[:3, :3] @ robokin.rotation_from_rpy([0.0, 0.0, angle])
    return moved


@pytest.mark.parametrize("budget", [None, 10.0])
def test_poses(budget):
    far = T.copy()
    far[0, 3] += 0.1
    report = grade_poses(PUMA, [Q] * 4, [T, far, turned(T), turned(far)], budget=budget)
    assert [item.status for item in report.items] == ["pass", "wrong position", "wrong orientation", "wrong pose"]
    assert [item.score for item in report.items] == [1.0, 0.5, 0.5, 0.0]
    assert (report.score, report.passed, report.right, report.robot) == (0.5, 1, False, "puma560")
    assert report.items[1].error["position"] == pytest.approx(100.0)  # the description's millimetres
    assert grade_poses(PUMA, [Q], [turned(T)], task="position").right


def test_levels_of_feedback_and_partial_credit():
    inverse = T.copy()
    inverse[:3, :3] = T[:3, :3].T
    report = grade_poses(PUMA, [Q], [inverse], partial=0.8, ids=["frame 6"], students=["ann"])
    (item,) = report.items
    assert (item.id, item.student, item.mistake, item.score) == ("frame 6", "ann", "inverse rotation", 0.8)
    told = [item.detail(level) for level in LEVELS]
    assert told[0] == ""
    assert "transposed" in told[1]
    assert "expected" not in told[2]
    assert "expected" in told[3]
    assert report_record(report, "verdict")["items"][0]["expected"] is None
    assert report_record(report)["students"][0]["score"] == 0.8


def test_sets_are_compared_with_all_solutions():
    target = robokin.forward_kinematics(PLANAR, [0.4, 0.9])
    ways = [one.q for one in robokin.solve_ik(PLANAR, target, task="position", limits=False)]
    assert len(ways) == 2
    far = target.copy()
    far[0, 3] += 10.0
    asked = {"task": "position", "limits": False}
    report = grade_configurations(PLANAR, [target] * 3 + [far], [ways, ways[:1], None, None], every=True, **asked)
    assert [item.status for item in report.items] == ["pass", "missing solution", "solution exists", "pass"]
    assert report.items[1].score == 0.5
    alone = grade_configurations(PLANAR, [target], [[*ways, ways[0]]], every=False, **asked)
    assert [(item.status, item.counted) for item in alone.items] == [("pass", True)] * 2 + [("pass", False)]


def test_jacobians_and_tables():
    J = robokin.jacobian(PLANAR, [0.4, 0.9])
    tool = robokin.jacobian(PLANAR, [0.4, 0.9], frame="tool")
    report = grade_jacobians(PLANAR, [[0.4, 0.9]] * 3, [J, J[[0, 1, 5]], tool])
    assert [item.mistake for item in report.items] == [None, None, "frame"]
    assert [item.passed for item in report.items] == [True, True, False]
    craig = robokin.load("puma560-craig")
    report = grade_tables(PUMA, [PUMA, craig], ids=["own", "craig"])
    assert [item.status for item in report.items] == ["pass", "different"]
    assert grade_tables(craig, [craig], up_to=["base"], students=["ann"]).students()["ann"].right


class Endless(Subject):
    """A check that comes to no end."""

    def mark(self, task):
        while True:
            pass


def test_what_is_too_much_is_not_decided():
    subject = Endless(PUMA, PUMA.units, robokin.default_tolerance(PUMA))
    tasks = [AnswerTask(name, GivenValue(Q), ()) for name in "ab"]
    items = list(marked(subject, tasks, Rules(budget=0.1)))
    assert [(item.id, item.status, item.decided, item.score) for item in items] == [
        ("a", "not decided", False, 0.0), ("b", "not decided", False, 0.0)
    ]  # fmt: skip


def test_what_is_no_answer_is_refused():
    with pytest.raises(InputError, match="2 questions and 1 answers"):
        grade_poses(PUMA, [Q, Q], [T])
    with pytest.raises(InputError, match="partial"):
        grade_poses(PUMA, [Q], [T], partial=2.0)
    with pytest.raises(InputError, match=r"J: found an array of shape \(2, 2\)"):
        grade_jacobians(PUMA, [Q], [np.eye(2)])
    with pytest.raises(InputError, match="finite joint values"):
        grade_configurations(PUMA, [T], [[[1.0, 2.0]]])
    with pytest.raises(AttributeError, match="no attribute 'grade'"):
        robokin.grading.grade  # noqa: B018 - that it raises is the point
