"""One pose of an arm with a spherical shoulder and wrist in Python, without blocks: what the blocks give."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from inverse.test_native_swivel import KINDS, check, twin
from inverse.test_swivel import SWIVELS, random_arm, within
from sweeps import sweep

import robokin
from robokin.inverse.self_motion.one_swivel import one_swivel
from robokin.inverse.self_motion.spread import well_spread
from robokin.inverse.self_motion.swivel_code import one_curves
from robokin.inverse.self_motion.swivel_curves import swivel_curves
from robokin.inverse.self_motion.swivel_pieces import swivel_pieces
from robokin.inverse.solutions import Question
from robokin.inverse.solve import _request
from robokin.inverse.swivel_block import SwivelSolution, one_swivel_arm
from robokin.inverse.target_block import TargetBlock


@pytest.mark.parametrize("name", sweep([*SWIVELS, *range(6)], 4))
def test_one_pose_has_what_the_blocks_give(name, rng):
    robot = random_arm(rng) if isinstance(name, int) else robokin.load(name)
    known = one_swivel_arm(robot)
    for kind in KINDS:
        T = robokin.forward_kinematics(robot, within(robot, rng, 6, kind))
        block = TargetBlock(_request(robot, True, None, "auto", "pose", None, 0), T)
        alone = [known.alone.solution(one, 16) for one in T]
        assert [one is not None for one in alone] == (block.swivel.known & ~block.swivel.none).tolist()
        for i in [i for i, one in enumerate(alone) if one is not None][:2]:
            one = SwivelSolution(known, T[i], *alone[i])
            result = one.result(Question(robot, T[i], "pose", True, {}))
            assert result is not None
            check(result, twin(robot, T[i]), 1e-9)


@pytest.mark.parametrize("name", ["iiwa14", "r1pro-left"])
def test_a_pose_among_others_has_the_curves_that_it_has_alone(name, rng):
    robot = robokin.load(name)
    known = one_swivel_arm(robot)
    T = robokin.forward_kinematics(robot, np.concatenate([within(robot, rng, 5, kind) for kind in KINDS]))
    request = replace(_request(robot, True, None, "auto", "pose", None, 0), motions=True)
    many = TargetBlock(request, T)
    for i, one in enumerate(T):
        answer = known.alone.solution(one, 16)
        if answer is not None:
            q = many.found.q[many.found.index == i]
            assert np.max(np.abs(answer[0][:, :7] - q)) <= 1e-12
            assert (answer[3], answer[4]) == (many.closing[i], many.within[i])


@pytest.mark.parametrize("name", sweep([*SWIVELS, *range(12)], 5))
def test_curves_and_pieces_of_one_pose_have_the_digits_of_many(name, rng):
    """Curves by code and pieces by bits, of poses with all that is degenerate too: doubt and every number are alike."""
    robot = random_arm(rng) if isinstance(name, int) else robokin.load(name)
    known = one_swivel_arm(robot)
    q = np.concatenate([within(robot, rng, 12, kind) for kind in KINDS])
    q[:12, (1, 3, 5)] *= rng.choice([1.0, 1.0, 0.0, 1e-9, 1e-5], (12, 3))
    T = robokin.forward_kinematics(robot, q)
    T[:3, :3, 3] *= 3.0  # out of reach
    curves, by_code = swivel_curves(known.arm, T), one_curves(known.arm)
    pieces = swivel_pieces(curves, robot.limits)
    looked_at = 0
    for i, one in enumerate(T):
        found = by_code(*one.ravel().tolist())
        if found is None:
            continue  # a straight elbow, or one on the line
        doubt, q4, real, entries = found
        assert (doubt, real, real) == (curves.doubt[i], *curves.real[i])
        assert np.array_equal(q4, curves.q4[i])
        assert entries.tobytes() == curves.entries[i].tobytes()
        if doubt or not real:
            continue
        alone = known.alone.bounds.pieces(q4, curves.entries[i])
        assert (alone is None) == pieces.doubt[i]
        if alone is not None:
            mine = pieces.row == i
            columns = (pieces.code[mine], pieces.first[mine], pieces.last[mine], pieces.whole[mine])
            assert np.array_equal(np.array(alone).reshape(-1, 4), np.stack(columns, axis=1))
            looked_at += 1
    assert looked_at > 5


def test_the_first_pose_of_an_arm_is_answered_as_the_next_ones(rng):
    """Code is made at the second pose only."""
    robot = robokin.load("iiwa14")
    known = one_swivel_arm(robot)
    for T in robokin.forward_kinematics(robot, within(robot, rng, 6, "anywhere")):
        fresh = one_swivel(known.arm, known.alone.limits, known.alone.rest)
        first, second = (fresh.solution(T, 16) for _ in range(2))
        assert first is not None
        assert first[0].tobytes() == second[0].tobytes()
        assert first[1].tobytes() == second[1].tobytes()
        assert first[2:] == second[2:]


def test_one_target_is_spread_as_among_others(rng):
    """Each table of one target is chosen from as in a table of two, with and without ranks."""
    x, move, rank = rng.uniform(-np.pi, np.pi, (60, 7)), rng.uniform(0.0, 3.0, 60), rng.integers(0, 3, 60)
    index, revolute = np.repeat([0, 1], 30), np.ones(7, dtype=bool)
    for ranks in (rank, np.ones(60, dtype=np.intp)):
        for most in (1, 7, 40):
            both = well_spread(index, x, revolute, move, ranks, most)
            alone = [
                30 * k + well_spread(index[:30], x[part], revolute, move[part], ranks[part], most)
                for k, part in enumerate((slice(0, 30), slice(30, 60)))
            ]
            assert np.array_equal(both, np.concatenate(alone))
