"""The laws of a complete answer on a sample of poses of every arm: what `make completeness` counts at length."""

from __future__ import annotations

import numpy as np
import pytest
from inverse.arms import KINDS, configurations, dh_of, in_own_units, library_arms, random_chain
from inverse.judge import differ, differs_alone, faults, listed, on_arc, shaken, solve
from inverse.truth import REGULAR, Scale, errors, least_singular_value, search
from sweeps import sweep

import robokin
from robokin.inverse.solutions import Arc, Family, Result, Solution


def laws_broken(robot, q, rng, searched):
    """The inputs among q: (m, n) at which a law is broken, and which."""
    scale = Scale(robot)
    T = robokin.forward_kinematics(robot, q)
    results, others = solve(robot, T), robokin.solve_ik(robot, shaken(T, rng))
    out = []
    for i, result in enumerate(results):
        known = search(robot, scale, T[i], rng, guesses=150)[0] if i == searched else ()
        broken = faults(robot, scale, q[i], T[i], result, known)
        if differ(robot, scale, listed(robot, result), others.q[i, : others.count[i]]):
            broken.append("by an ulp")
        if i == searched and differs_alone(robot, scale, result, robokin.solve_ik(robot, T[i])):
            broken.append("batch")
        # Within 1e-6 of a pose at which singularities meet what is listed may be 1e-3 beside what made it; it is said.
        if broken and not (broken == ["on no family"] and not result.complete):
            out.append((in_own_units(robot, q[i]), broken))
    return out


@pytest.mark.parametrize("part", sweep(range(10), 10))
def test_arms_of_the_library(part):
    out = []
    for name in library_arms()[part::10]:
        robot = robokin.load(name)
        rng = np.random.default_rng([560, part, len(name)])
        kinds = rng.choice(KINDS, 3, replace=False)
        q = np.concatenate([configurations(robot, Scale(robot), rng, 1, kind) for kind in kinds])
        out += [(name, *one) for one in laws_broken(robot, q, rng, part % 3)]
    assert out == []


@pytest.mark.parametrize("part", sweep(range(5), 5))
def test_random_chains(part):
    out = []
    for k in range(6 * part, 6 * part + 6):
        rng = np.random.default_rng([24, k])
        robot = random_chain(rng)
        kinds = rng.choice(KINDS, 4, replace=False)
        q = np.concatenate([configurations(robot, Scale(robot), rng, 1, kind) for kind in kinds])
        out += [(dh_of(robot), *one) for one in laws_broken(robot, q, rng, part % 4)]
    assert out == []


# The judge itself ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "count"), [("puma560", 8), ("ur5e", 8), ("scara", 2)])
def test_newtons_method_finds_what_is_known(name, count):
    """Eight solutions with a wrist or three parallel axes: B. Siciliano et al., Robotics, 2009, section 2.12."""
    robot = robokin.load(name)
    scale, rng = Scale(robot), np.random.default_rng(3)
    T = robokin.forward_kinematics(robot, np.full(robot.n, 0.4))
    found, least = search(robot, scale, T, rng)
    assert len(found) == count
    assert np.min(least) > REGULAR
    assert np.max(np.abs(errors(robot, scale, found, np.broadcast_to(T, (count, 4, 4))))) < 1e-13


def test_newtons_method_finds_as_many_as_the_elimination():
    """D. Manocha, J. Canny, Efficient inverse kinematics for general 6R manipulators, 1994: an arm with up to 16."""
    robot = robokin.load("manocha-canny-1994")
    scale, rng = Scale(robot), np.random.default_rng(3)
    q = rng.uniform(-3, 3, (40, 6))
    T = robokin.forward_kinematics(robot, q)
    counts = robokin.solve_ik(robot, T).count
    most = int(np.argmax(counts))
    found, _ = search(robot, scale, T[most], rng, guesses=1500)
    assert len(found) == counts[most]


def test_every_law_can_be_broken():
    """An answer with something taken away or put in is not let through."""
    robot = robokin.load("puma560")
    scale = Scale(robot)
    q = np.radians([10.0, -30.0, 60.0, 20.0, 40.0, 50.0])
    T = robokin.forward_kinematics(robot, q)
    right = robokin.solve_ik(robot, T)
    assert len(right.solutions) > 1
    assert faults(robot, scale, q, T, right, [one.q for one in right.solutions]) == []
    mine = [one for one in right.solutions if np.allclose(one.q, q, atol=1e-6)]
    others = tuple(one for one in right.solutions if one not in mine)
    assert faults(robot, scale, q, T, Result((), False, "")) == ["unanswered"]
    assert faults(robot, scale, q, T, Result((), True, "")) == ["unanswered", "falsely complete"]
    assert faults(robot, scale, q, T, Result(others, False, "")) == ["lost"]
    assert faults(robot, scale, q, T, Result(tuple(mine), True, ""), [one.q for one in others]) == ["falsely complete"]
    assert faults(robot, scale, q, T, Result((*right.solutions, mine[0]), False, "")) == ["twice"]
    off = Solution(q + 1e-4 * np.eye(6)[1], "", True, 0.0, 0.0)
    assert faults(robot, scale, q, T, Result((*right.solutions, off), False, "")) == ["wrong"]
    out = Solution(q + 2 * np.pi * np.eye(6)[3], "", True, 0.0, 0.0)
    assert faults(robot, scale, q, T, Result((*others, out), False, "")) == ["wrong"]
    assert differ(robot, scale, listed(robot, right), listed(robot, right)[1:])
    assert differs_alone(robot, scale, right, Result(right.solutions[1:], right.complete, ""))


def test_a_self_motion_is_told_from_one_of_its_members():
    """puma560 with a straight wrist: q4 + q6 alone counts."""
    robot = robokin.load("puma560")
    scale = Scale(robot)
    q = np.radians([10.0, -30.0, 60.0, 20.0, 0.0, 50.0])
    T = robokin.forward_kinematics(robot, q)
    turn = np.radians(np.linspace(-110.0, 110.0, 45))[:, None]
    points = q + (turn - q[3]) * [0.0, 0.0, 0.0, 1.0, 0.0, -1.0]
    member = Solution(points[0], "", True, 0.0, 0.0, (4, 6))
    alone = Result((member,), False, "")
    assert faults(robot, scale, q, T, alone) == ["on no family"]
    whole = Result((member,), True, "", families=(Family((4, 6), 1, False, (Arc(points),), 0),))
    assert faults(robot, scale, q, T, whole) == []
    half = Result((member,), True, "", families=(Family((4, 6), 1, False, (Arc(points[:20]),), 0),))
    assert faults(robot, scale, q, T, half) == ["on no family", "falsely complete"]
    assert on_arc(robot, scale, q + 2 * np.pi, points)
    assert not on_arc(robot, scale, q + 0.01 * np.eye(6)[4], points)
    assert least_singular_value(robot, scale, q) < 1e-12
