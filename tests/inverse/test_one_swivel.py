"""One pose of an arm with a spherical shoulder and wrist in Python, without blocks: what the blocks give."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from inverse.test_native_swivel import KINDS, check, twin
from inverse.test_swivel import SWIVELS, random_arm, within
from sweeps import sweep

import robokin
from robokin.inverse.self_motion.spread import well_spread
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
