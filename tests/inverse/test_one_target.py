"""One pose is answered as the blocks answer it, number by number, and what is left to them is answered by them."""

from __future__ import annotations

import copy
import pickle
import threading
from dataclasses import fields, replace

import numpy as np
import pytest
from library_entries import entry, names_of

import robokin
from robokin.inverse import solve
from robokin.inverse.one_target import plain_pose, solve_one
from robokin.inverse.one_target_arm import one_target_arm
from robokin.inverse.solutions import Result
from robokin.inverse.solve import solve_many, target_poses
from robokin.kernel.facts import NAME
from robokin.model import CoupledRobot, Robot

TOLD = [part.name for part in fields(Result)]
"""What a result tells."""

ROUND = np.radians(15.0)


def arms():
    six = [entry(name) for name in names_of(Robot, least=6, most=6)]
    return [robot for robot in six if not isinstance(robot, CoupledRobot) and one_target_arm(robot) is not None]


def configurations(rng, robot):
    """Random, round, nearly singular ones, and one with a joint at its limit."""
    yield rng.uniform(-3, 3, 6)
    yield ROUND * rng.integers(-12, 13, 6)
    right = np.where(rng.random(6) < 0.5, np.pi / 2 * rng.integers(-2, 3, 6), rng.uniform(-3, 3, 6))
    yield right + rng.choice([0.0, 1e-12, 1e-9, 1e-6, 1e-4, 1e-3], 6)
    limits = np.clip(robot.limits, -6.3, 6.3)
    q, joint = rng.uniform(*limits.T), rng.integers(6)
    q[joint] = limits[joint, rng.integers(2)] + rng.choice([0.0, 1e-10, -1e-10, 1e-8, 1e-4, 1e-3])
    yield q


def assert_same(one, other):
    for name in TOLD:
        if name not in ("solutions", "question", "families", "counts", "nearest"):
            assert getattr(one, name) == getattr(other, name), name
    assert list(one.counts.items()) == list(other.counts.items())
    assert len(one) == len(other)
    assert not one.families
    assert not other.families
    # Roots of an elimination are polished, by steps that do not come to the same last digits everywhere.
    polished = one.method == "elimination"
    for mine, theirs in zip(one, other, strict=True):
        if polished:
            np.testing.assert_allclose(mine.q, theirs.q, rtol=0, atol=1e-9)
        else:
            assert mine.q.tobytes() == theirs.q.tobytes()
        assert (mine.branch, mine.within_limits, mine.free) == (theirs.branch, theirs.within_limits, theirs.free)
        # Of these the blocks' own last digits depend on how many are summed at once.
        assert mine.position_error == pytest.approx(theirs.position_error, abs=1e-13 if polished else 1e-15)
        assert mine.angle_error == pytest.approx(theirs.angle_error, abs=1e-13 if polished else 1e-15)


def test_the_blocks_say_the_same(rng):
    answered = asked = 0
    for number, robot in enumerate(arms()):
        arm = one_target_arm(robot)
        for kind, q in enumerate(configurations(rng, robot)):
            T = robokin.forward_kinematics(robot, q)
            limits, most = bool((number + kind) % 2), None if number % 3 else 2
            asked += 1
            if plain_pose(T) and solve_one(arm, T, limits, most) is not None:
                answered += 1
                expected = solve_many(robot, T, limits, most=most)[0]
                assert_same(robokin.solve_ik(robot, T, limits=limits, most=most), expected)
    assert answered > 0.6 * asked


@pytest.mark.parametrize("name", ["puma560", "ur5e"])
def test_a_solution_near_a_limit_needs_no_blocks_where_the_arm_is_regular(name, rng):
    robot = robokin.load(name)
    arm, answered = one_target_arm(robot), 0
    for k, q in enumerate(rng.uniform(*np.clip(robot.limits, -3.0, 3.0).T, (12, 6))):
        joint = k % 6
        q[joint] = robot.limits[joint, k % 2] + (-1.0) ** k * 10.0 ** rng.uniform(-3.5, -2.5)
        T = robokin.forward_kinematics(robot, q)
        if plain_pose(T) and solve_one(arm, T, True, None) is not None:
            answered += 1
            assert_same(robokin.solve_ik(robot, T), solve_many(robot, T[None])[0])
    assert answered >= 8


def in_blocks(monkeypatch, *question, **options):
    """The answer that the blocks give to a question."""
    with monkeypatch.context() as change:
        change.setattr(solve, "_one_target", lambda *_: None)
        result = robokin.solve_ik(*question, **options)
        len(result)
    return result


@pytest.mark.parametrize("name", ["puma560", "ur5e", "crx10ia"])
def test_a_wish_orders_the_list_in_the_same_way(name, rng, monkeypatch):
    robot = entry(name)
    for k in range(12):
        T = robokin.forward_kinematics(robot, rng.uniform(*np.clip(robot.limits, -3, 3).T))
        near = rng.uniform(*np.clip(robot.limits, -6, 6).T) if k % 3 else rng.uniform(-9, 9, 6)
        options = {"near": near, "limits": bool(k % 2), "most": None if k % 4 else 1}
        assert_same(robokin.solve_ik(robot, T, **options), in_blocks(monkeypatch, robot, T, **options))


@pytest.mark.parametrize("name", ["panda", "iiwa14"])
def test_a_held_joint_leaves_the_same_list(name, rng, monkeypatch):
    robot = entry(name)
    for k in range(8):
        q = rng.uniform(*robot.limits.T)
        T, joint = robokin.forward_kinematics(robot, q), 2 if k % 2 else int(rng.integers(7))
        options = {"hold": {joint: float(q[joint])}, "limits": bool(k % 3), "near": q if k % 4 == 0 else None}
        one = robokin.solve_ik(robot, T, **options)
        assert_same(one, in_blocks(monkeypatch, robot, T, **options))
        assert dict(one.question.hold) == options["hold"]
        assert one.question.robot is robot
    with pytest.raises(robokin.InputError, match="joint 9"):
        robokin.solve_ik(robot, T, hold={9: 0.0})
    with pytest.raises(robokin.InputError, match="outside its limits"):
        robokin.solve_ik(robot, T, hold={1: 50.0})


@pytest.mark.parametrize(("name", "hold"), [("puma560", None), ("ur5e", None), ("crx10ia", None), ("iiwa14", {2: 0.3})])
def test_a_pose_without_a_solution_is_told_alike_alone_in_a_batch_and_by_the_blocks(name, hold, rng, monkeypatch):
    robot = entry(name)
    T = robokin.forward_kinematics(robot, rng.uniform(-3, 3, (16, robot.n)))
    away = 10.0 ** rng.uniform(-2, 0.5, (16, 1))
    away[:4] = 1.0 + 10.0 ** rng.uniform(-6, -1, (4, 1))
    T[:, :3, 3] *= away
    batch = robokin.solve_ik(robot, T, hold=hold)
    shown = [name for name in TOLD if name not in ("solutions", "question", "families", "counts", "nearest")]
    for i in range(16):
        one, expected = robokin.solve_ik(robot, T[i], hold=hold), in_blocks(monkeypatch, robot, T[i], hold=hold)
        assert_same(one, expected)
        assert [getattr(batch[i], name) for name in shown] == [getattr(expected, name) for name in shown]
        assert batch.reason(i) == expected.reason
        if len(one) == 0 and i % 4 == 0:
            assert one.nearest.q.tobytes() == expected.nearest.q.tobytes()
            assert one.nearest.branch == expected.nearest.branch
            again = pickle.loads(pickle.dumps(robokin.solve_ik(robot, T[i], hold=hold)))
            assert (again.basis, again.certificate, again.reason) == (one.basis, one.certificate, one.reason)


def test_no_solution_is_known_without_blocks(monkeypatch):
    def asked(*_, **__):
        raise AssertionError("the blocks are asked")

    robots = [entry(name) for name in ("puma560", "ur5e", "crx10ia")]
    poses = [robokin.forward_kinematics(robot, np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])) for robot in robots]
    if any(one_target_arm(robot).kernel is None for robot in robots):
        pytest.skip("without the kernel it is for the blocks")
    monkeypatch.setattr(solve, "solve_many", asked)
    for robot, T in zip(robots, poses, strict=True):
        T[:3, 3] *= 1.9
        result = robokin.solve_ik(robot, T)
        assert not result
        assert (result.complete, result.postures, result.all_known, result.families) == (True, True, True, ())
        assert result.counts == dict.fromkeys(("found", "duplicates", "closing", "within_limits", "listed", "turns"), 0)


def test_every_proven_list_has_the_joint_values_that_made_the_pose(rng):
    for name in ("puma560", "ur5e", "irb120"):
        if name not in names_of(Robot):
            continue
        robot = entry(name)
        for q in rng.uniform(-3, 3, (30, 6)):
            result = robokin.solve_ik(robot, robokin.forward_kinematics(robot, q), limits=False)
            gap = np.abs(np.array([solution.q for solution in result]) - q)
            assert np.min(np.max(np.minimum(gap, 2 * np.pi - gap), axis=1)) < 1e-8
            assert result.complete
            assert max(solution.position_error for solution in result) < 1e-12


def far(T):
    T[0, 3] = 1e13


def bent(T):
    T[0, 0] += 1e-6


def mirrored(T):
    T[:3, 0] *= -1.0


def moved(T):
    T[3, 0] = 1e-6


def lost(T):
    T[1, 2] = np.nan


def endless(T):
    T[2, 3] = np.inf


@pytest.mark.parametrize("change", [far, bent, mirrored, moved, lost, endless], ids=lambda change: change.__name__)
def test_poses_that_are_not_plain_are_left_to_the_blocks(change):
    robot = entry("puma560")
    T = robokin.forward_kinematics(robot, np.full(6, 0.4))
    assert plain_pose(T)
    change(T)
    assert not plain_pose(T)
    try:
        poses = target_poses(T)
    except robokin.InputError as error:
        with pytest.raises(robokin.InputError, match=str(error)[:20]):
            robokin.solve_ik(robot, T)
    else:
        assert_same(robokin.solve_ik(robot, T), solve_many(robot, poses)[0])


def test_what_is_plain_is_taken_as_it_is(rng):
    robot = entry("ur5e")
    for q in rng.uniform(-3, 3, (50, 6)):
        T = robokin.forward_kinematics(robot, q)
        if plain_pose(T):
            assert target_poses(T).tobytes() == T.tobytes()
    assert not plain_pose(T.tolist())
    assert not plain_pose(T[None])
    assert not plain_pose(T.astype(np.float32))


def test_wrong_questions_are_refused_as_ever():
    robot, T = entry("puma560"), np.eye(4)
    wrong = [{"most": 0}, {"seed": -1}, {"method": "best"}, {"task": "turn"}, {"limits": "no"}, {"cores": 0}]
    for options in [*wrong, {"cores": True}, {"most": True}, {"near": [1.0]}, {"hold": [2]}, {"turns": "yes"}]:
        with pytest.raises(robokin.InputError):
            robokin.solve_ik(robot, T, **options)
    with pytest.raises(robokin.InputTypeError):
        robokin.solve_ik("puma560", T)


def answers(robot):
    """Results that nobody has looked at: one made without blocks, one of blocks, one of a pose out of reach."""
    T = robokin.forward_kinematics(robot, np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6]))
    away = T.copy()
    away[:3, 3] = 50.0
    return [lambda: robokin.solve_ik(robot, T), lambda: robokin.solve_ik(robot, T, near=np.zeros(6)),
            lambda: robokin.solve_ik(robot, away)]  # fmt: skip


def test_results_are_what_they_were_whoever_looks_first(tmp_path):
    for ask in answers(entry("puma560")):
        seen = ask()
        expected = repr(seen), len(seen), [solution.branch for solution in seen], seen.reason, dict(seen.counts)
        for look in (
            copy.copy, copy.deepcopy, lambda one: pickle.loads(pickle.dumps(one)), replace,
            lambda one: (vars(one), one)[1], lambda one: (one.record(), one)[1], lambda one: (one.complete, one)[1],
        ):  # fmt: skip
            one = look(ask())
            assert type(one) is type(seen)
            found = repr(one), len(one), [solution.branch for solution in one], one.reason, dict(one.counts)
            assert found == expected
            assert isinstance(one, type(seen))


def test_solutions_are_named_when_asked():
    robot = entry("puma560")
    T = robokin.forward_kinematics(robot, np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6]))
    names = [solution.branch for solution in robokin.solve_ik(robot, T)]
    assert len(set(names)) == len(names)
    for look in (copy.copy, copy.deepcopy, lambda one: pickle.loads(pickle.dumps(one)), replace):
        assert [look(solution).branch for solution in robokin.solve_ik(robot, T)] == names
    one = robokin.solve_ik(robot, T)[0]
    with pytest.raises(AttributeError, match="colour"):
        one.colour  # noqa: B018
    assert repr(one) == repr(robokin.solve_ik(robot, T)[0])
    with pytest.raises(AttributeError):
        one.branch = "mine"


def test_answers_do_not_follow_what_was_given():
    robot = entry("crx10ia") if "crx10ia" in names_of(Robot) else entry("puma560")
    T = robokin.forward_kinematics(robot, np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6]))
    for near in (None, np.zeros(6)):
        expected = [solution.q for solution in robokin.solve_ik(robot, T, near=near)]
        given = T.copy()
        result = robokin.solve_ik(robot, given, near=near)
        given[:3, 3] = 7.0
        if near is not None:
            near[:] = 2.0
        np.testing.assert_array_equal([solution.q for solution in result], expected)
        np.testing.assert_array_equal(result.question.T, T)


def test_threads_see_one_answer():
    robot = replace(entry("ur5e"))
    T = robokin.forward_kinematics(robot, np.array([0.1, -1.2, 0.3, 0.4, 0.5, 0.6]))
    expected = [(solution.branch, solution.q.tolist()) for solution in robokin.solve_ik(robot, T)]
    wrong = []

    def look(result):
        if [(solution.branch, solution.q.tolist()) for solution in result] != expected:
            wrong.append(result)

    for _ in range(20):
        result = robokin.solve_ik(robot, T)
        threads = [threading.Thread(target=look, args=(result,)) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    assert not wrong


def test_the_code_stays_with_its_robot():
    robot = replace(entry("puma560"))
    robokin.solve_ik(robot, np.eye(4))
    for other in (copy.deepcopy(robot), pickle.loads(pickle.dumps(robot))):
        assert not vars(other).get(NAME)
