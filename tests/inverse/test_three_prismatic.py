"""Three sliding joints: both solutions, in any order of the joints."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from inverse.loops import outcome, random_links, regular, right_angles, values_of
from sweeps import sweep

from robokin.inverse.closed_form.three_prismatic import ThreePrismatic
from robokin.inverse.elimination.loop import Loop

ORDERS = list(itertools.combinations(range(6), 3))


def random_loop(rng, sliding, special):
    revolute = np.ones(6, dtype=bool)
    revolute[list(sliding)] = False
    return Loop(revolute, random_links(rng, special), np.eye(4), np.eye(4), 1.0)


@pytest.mark.parametrize("special", sweep([False, True], 2))
@pytest.mark.parametrize("sliding", ORDERS)
def test_the_joints_that_made_the_pose_are_found(sliding, special, rng):
    tried = 0
    while tried < 3:
        loop = random_loop(rng, sliding, special)
        solver = ThreePrismatic.find(loop)
        assert (solver is not None) == regular(loop, rng)
        if solver is None:
            continue
        tried += 1
        result = outcome(solver, loop, values_of(loop, rng, 60))
        assert result.found == 1.0
        assert result.open == 0
        assert np.all(result.closing == 2)


def test_the_sentence_names_the_sliding_joints(rng):
    solver = ThreePrismatic.find(random_loop(rng, (0, 2, 5), special=False))
    assert solver.sentence.startswith("joints 1, 3, 6 are prismatic")
    assert solver.method == "three prismatic joints"


def test_round_angles_of_round_arms(rng):
    # Where the sliding axes lie in a plane the shortest lengths are a point of the family; where in addition the first
    # and third revolute axes are parallel, the one angle chosen may not serve.
    solved = []
    for sliding in ORDERS:
        for _ in range(20):
            loop = random_loop(rng, sliding, special=True)
            solver = ThreePrismatic.find(loop)
            if solver is not None:
                solved.append(outcome(solver, loop, right_angles(loop, rng, 40), steps=4).solved)
    assert np.mean(solved) > 0.9


def test_other_numbers_of_sliding_joints_are_left_to_others(rng):
    assert ThreePrismatic.find(random_loop(rng, (0, 1), special=False)) is None
    assert ThreePrismatic.find(random_loop(rng, (0, 1, 2, 3), special=False)) is None


def test_no_target_and_no_number(rng):
    solver = ThreePrismatic.find(random_loop(rng, (1, 3, 4), special=False))
    assert solver.candidates(np.empty((0, 4, 4))).values.shape == (0, 6)
    values = solver.candidates(np.full((2, 4, 4), np.nan)).values
    assert not np.isfinite(values).all(axis=1).any()
