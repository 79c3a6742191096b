"""Branches over a whole path: the best of all, what ends the others, and starts where joints first turn."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import robokin
from robokin.inverse.path_goals import Goal, Manner
from robokin.inverse.paths_to_poses import path_through
from robokin.inverse.trajectories import Timing, motion_limits
from robokin.pictures.arm_track import track_of
from robokin.records.path_records import PathRecords
from robokin.reports.path_report import PathReport
from robokin.spatial.angles import circled

PUMA = robokin.load("puma560")
SCARA = robokin.load("scara")
PLANAR = robokin.load("planar2r")
LINES = [
    (PUMA, "Trans(0.5, 0.3, 0.2) RPY(0, 1, 0)", "Trans(-0.3, 0.5, 0.2) RPY(0, 1, 1)"),
    (PUMA, "Trans(0.4, -0.3, 0.3) RPY(0.3, 2, 0)", "Trans(0.5, 0.4, 0.1) RPY(0, 2, 1)"),
    (SCARA, "Trans(0.3, 0.2, 0.25) RPY(pi, 0, 0)", "Trans(0.2, -0.3, 0.25) RPY(pi, 0, 1)"),
]


def brute(robot, start, curve):
    """The branch from start (n,) by the nearest of all solutions at many poses (m, 4, 4), or None where it jumps."""
    rows = [start]
    for T in curve:
        all_ = robokin.solve_ik(robot, T, limits=False)
        if not len(all_):
            return None
        gaps = [circled(one.q - rows[-1], robot.revolute) for one in all_]
        gap = min(gaps, key=lambda one: np.max(np.abs(one)))
        if np.max(np.abs(gap)) > 0.3:
            return None
        rows.append(rows[-1] + gap)
    return np.array(rows)


@pytest.mark.parametrize("k", range(len(LINES)))
def test_the_best_branch_is_that_of_a_search_over_all(k):
    robot, first, last = LINES[k]
    T0, T1 = robokin.transform(first), robokin.transform(last)
    path = path_through(robot, Goal(T=T0), [Goal(T=T1)], 100, Manner("line"))
    rows = path.T
    limits = np.where(np.isfinite(robot.limits), robot.limits, np.array([-1e9, 1e9]))
    travels = []
    for one in robokin.solve_ik(robot, T0, limits=False):
        q = brute(robot, one.q, rows[1:])
        if q is None:
            continue
        for j in np.flatnonzero(robot.revolute):
            turns = [q[:, j] + 2 * np.pi * m for m in (-1, 0, 1)]
            inside = [v for v in turns if v.min() >= limits[j, 0] - 1e-9 and v.max() <= limits[j, 1] + 1e-9]
            q[:, j] = inside[0] if inside else np.nan
        if np.isfinite(q).all() and robot.within_limits(q).all():
            scale = np.where(robot.revolute, 1.0, robokin.differential_kinematics(robot, one.q).task.size)
            travels.append(np.max(np.sum(np.abs(np.diff(q, axis=0)), axis=0) / scale))
    assert path.complete == bool(travels)
    scale = np.where(robot.revolute, 1.0, robokin.differential_kinematics(robot, path.q[0]).task.size)
    own = np.max(np.sum(np.abs(np.diff(path.q, axis=0)), axis=0) / scale)
    assert own == pytest.approx(min(travels), abs=1e-3)
    assert sum(one.complete for one in path.branches) == len(travels)
    assert [one.chosen for one in path.branches] == [True] + [False] * (len(path.branches) - 1)
    assert robot.within_limits(path.q).all()


def test_a_start_that_ends_early_is_told_the_others():
    start = np.radians([10, -111.25, -8.55, 40.81, 78.11, 17])
    goal = Goal(T=robokin.transform("Trans(-0.3, 0.5, 0.2) RPY(0, 1, 1)"))
    path = path_through(PUMA, start, [goal], 100, Manner("line"))
    assert not path.complete and (path.events[-1].kind, path.events[-1].joint) == ("limit", 5)
    best = path.branches[0]
    assert best.complete and not best.chosen
    (own,) = [one for one in path.branches if one.chosen]
    assert own.fraction == path.fraction
    # What is said to get there does.
    assert path_through(PUMA, best.start, [goal], 30, Manner("line")).complete
    np.testing.assert_allclose(robokin.forward_kinematics(PUMA, best.start), path.T[0], atol=1e-9)


def test_joints_turn_first_where_a_straight_wrist_cannot_go_on():
    home = PUMA.poses["home"]
    T = robokin.forward_kinematics(PUMA, home)
    T[:3, 3] = [-0.3, 0.7, 0.2]
    path = robokin.follow_line(PUMA, home, T, 40)
    assert path.complete and path.reorientation == 40 and len(path) == 81
    turn = path.T[:41]
    assert np.abs(turn - turn[0]).max() < 1e-9
    np.testing.assert_array_equal(path.q[0], home)
    assert np.flatnonzero(path.q[40] != home).tolist() == [3, 5]
    # From there on a step half as long moves joints half as far: nothing jumps.
    finer = robokin.follow_line(PUMA, home, T, 80)
    steps = [np.abs(np.diff(one.q[one.reorientation :], axis=0)).max() for one in (path, finer)]
    assert steps[1] < 0.6 * steps[0]
    # Who begins there needs no turn.
    assert robokin.follow_line(PUMA, path.q[40], T, 40).reorientation == 0


@pytest.mark.parametrize(
    ("duration", "rate"), [(None, None), pytest.param(6.0, None, marks=pytest.mark.slow), (6.0, 20.0)]
)
def test_the_first_turn_keeps_to_limits_and_to_the_duration(duration, rate):
    home = PUMA.poses["home"]
    T = robokin.forward_kinematics(PUMA, home)
    T[:3, 3] = [-0.3, 0.7, 0.2]
    timing = Timing(motion_limits(PUMA, 1.0, 3.0), duration=duration, rate=rate)
    path = path_through(PUMA, home, [Goal(T=T)], 50, Manner("line", timing=timing))
    assert path.complete and path.reorientation > 0
    assert np.abs(path.velocity).max() <= 1.0 + 1e-6 and np.abs(path.acceleration).max() <= 3.0 + 1e-6
    assert path.t[-1] == pytest.approx(path.duration) and (duration is None or path.duration == duration)
    assert (np.diff(path.t) > 0).all()
    # Velocities are the derivatives of the rows.
    middle = (path.q[2:] - path.q[:-2]) / (path.t[2:] - path.t[:-2])[:, None]
    inner = np.abs(np.arange(1, len(path) - 1) - path.reorientation) > 1
    np.testing.assert_allclose(middle[inner], path.velocity[1:-1][inner], atol=0.02)


@pytest.mark.slow
def test_a_stretched_arm_folds_to_the_side_that_its_limits_leave():
    rows = list(PLANAR.rows)
    T = robokin.transform("Trans(0.9, 0.1, 0)")
    for low, high in ((-2.5, 0.0), (0.0, 2.5)):
        rows[1] = replace(rows[1], limits=(low, high))
        arm = replace(PLANAR, rows=tuple(rows))
        path = robokin.follow_line(arm, [0.0, 0.0], T, 20)
        assert path.complete and arm.within_limits(path.q).all()


@pytest.mark.parametrize("name", ["puma560", "ur5e", "scara", "anthropomorphic"])
def test_rows_do_not_hang_on_how_many_there_are(name, rng):
    """Every row closes, and coarse rows are those of a fine path, there and back."""
    robot = robokin.load(name)
    task = "position" if robot.n == 3 else None
    for _ in range(3):
        low, high = np.maximum(robot.limits, -2.0)[:, 0], np.minimum(robot.limits, 2.0)[:, 1]
        start, end = rng.uniform(low, high, (2, robot.n))
        end = start + 0.3 * (end - start)
        T = robokin.forward_kinematics(robot, end)
        coarse, fine = (robokin.follow_line(robot, start, T, steps, limits=False, task=task) for steps in (8, 160))
        assert coarse.fraction == pytest.approx(fine.fraction, abs=1e-4)
        if not coarse.complete:
            continue
        np.testing.assert_allclose(coarse.q, fine.q[::20], atol=1e-7)
        back = robokin.follow_line(robot, coarse.q[-1], coarse.T[0], 8, limits=False, task=task)
        np.testing.assert_allclose(back.q[::-1], coarse.q, atol=1e-6)
        line = coarse.T[0, :3, 3] + coarse.s[:, None] * (T[:3, 3] - coarse.T[0, :3, 3])
        np.testing.assert_allclose(coarse.T[:, :3, 3], line, atol=1e-9)


def test_points_of_a_path_by_joints_are_the_best_together():
    """The sum of the farthest moves is the least of all ways through the solutions; one by one the nearest is worse."""
    texts = [
        "Trans(0.5, 0.3, 0.2) RPY(0, 2, 0)",
        "Trans(0.2, 0.6, 0.2) RPY(0, 2, 1)",
        "Trans(-0.5, 0.3, 0.2) RPY(0, 2, 2)",
    ]
    goals = [Goal(T=robokin.transform(text)) for text in texts]
    start = np.radians([10.0, -30, 60, 0, 40, 0])
    timing = Timing(motion_limits(PUMA, None, None), duration=3.0)
    path = path_through(PUMA, start, goals, 3, Manner("joint", timing=timing))
    sets = [np.array([s.q for s in robokin.solve_ik(PUMA, g.T, turns=True)]) for g in goals]
    best = np.zeros(1)
    before = start[None]
    for rows in sets:
        moves = np.max(np.abs(rows[None] - before[:, None]), axis=2)
        best, before = np.min(best[:, None] + moves, axis=0), rows
    curve = path_through(PUMA, start, goals, 3000, Manner("joint", timing=timing))
    stops = [np.argmin(np.max(np.abs(curve.T - g.T), axis=(1, 2))) for g in goals]
    points = np.concatenate([start[None], curve.q[stops]])
    assert path.complete
    assert np.sum(np.max(np.abs(np.diff(points, axis=0)), axis=1)) == pytest.approx(best.min(), abs=1e-3)


MID = (
    np.radians([10, -2, 65, 0, 67, 0]),
    [Goal(q=PUMA.poses["home"]), Goal(T=robokin.transform("Trans(-0.3, 0.7, 0.2) RPY(0, pi/2, pi/2)"))],
)


@pytest.mark.parametrize("rate", [None, 7.0])
def test_a_turn_in_the_middle_is_told(rate):
    timing = None if rate is None else Timing(motion_limits(PUMA, None, None), duration=9.0, rate=rate)
    path = path_through(PUMA, *MID, 10, Manner("line", timing=timing))
    (turn,) = path.turns
    assert path.complete and not path.reorientation and turn.joints == [4, 6]
    assert turn.fraction == pytest.approx(1 / 3) and "joints 4 and 6 turn, in" in turn.words
    rows = slice(turn.row, turn.row + turn.steps + 1)
    assert np.abs(path.T[rows] - path.T[turn.row]).max() < 1e-8
    assert np.abs(path.T[turn.row + turn.steps + 1] - path.T[turn.row]).max() > 1e-6
    assert np.abs(path.T[turn.row - 1] - path.T[turn.row]).max() > 1e-6
    np.testing.assert_allclose(path.q[turn.row + turn.steps], turn.end, atol=1e-9)


def test_a_turn_has_its_mark_and_each_event_its_own_words():
    path = path_through(PUMA, *MID, 10, Manner("line"))
    track = track_of(path)
    words = [*(event.words for event in path.events), path.turns[0].words]
    assert sorted(word for _, word in track.marks) == sorted(words)
    rows = [row for row, _ in track.marks]
    assert rows == sorted(rows), "what happens is listed in the order in which it comes"
    assert (path.turns[0].row, path.turns[0].words) in track.marks
    notes = PathReport(PathRecords(path, PUMA.units))
    told = [*notes.event_notes(), *notes.turn_notes()]
    assert all(said.endswith(word) for said, word in zip(told, words, strict=True))
    assert sorted([*told, *notes.end_notes()]) == sorted(notes.notes())


@pytest.mark.parametrize("rate", [7.0, 10.3])
def test_the_end_of_a_first_turn_is_at_the_first_pose_between_rows_too(rate):
    home = PUMA.poses["home"]
    T = robokin.forward_kinematics(PUMA, home)
    T[:3, 3] = [-0.3, 0.7, 0.2]
    timing = Timing(motion_limits(PUMA, None, None), duration=3.0, rate=rate)
    path = path_through(PUMA, home, [Goal(T=T)], 10, Manner("line", timing=timing))
    (turn,) = path.turns
    assert turn.joints == [4, 6] and turn.steps == path.reorientation and turn.row == 0
    np.testing.assert_allclose(robokin.forward_kinematics(PUMA, turn.end), path.T[0], atol=1e-9)
    assert np.abs(path.T[: turn.steps + 1] - path.T[0]).max() < 1e-9 < np.abs(path.T[turn.steps + 1] - path.T[0]).max()


def test_a_first_turn_is_no_part_of_what_a_branch_follows():
    home = PUMA.poses["home"]
    ends = [robokin.forward_kinematics(PUMA, home) for _ in range(2)]
    ends[0][:3, 3], ends[1][:3, 3] = [-0.3, 0.7, 0.2], [0.6, -0.4, 0.3]
    path = path_through(PUMA, home, [Goal(T=T) for T in ends], 5, Manner("line"))
    assert path.turns and not path.complete
    (own,) = [one for one in path.branches if one.chosen]
    # A turn and two lines: three pieces of the path's fraction, two of that of the lines.
    assert own.fraction == pytest.approx((3.0 * path.fraction - 1.0) / 2.0)
    assert own.fraction < path.branches[0].fraction < path.fraction


def test_the_rows_of_a_path_that_ends_early_are_counted_from_the_whole():
    goals = [Goal(T=robokin.transform(text)) for text in ("Trans(3, 0, 0)", "Trans(0.5, 0.5, 0)")]
    path = path_through(PLANAR, np.radians([30, 40]), goals, 20, Manner("line"))
    whole = path_through(PLANAR, np.radians([30, 40]), goals[1:] * 2, 20, Manner("line"))
    assert not path.complete and path.steps == whole.steps == 40
    np.testing.assert_array_equal(path.t, whole.t[: len(path)])
    np.testing.assert_allclose(path.s, whole.s[: len(path)], atol=1e-15)
