"""Three parallel axes: every solution, at every place, with or without a sliding joint among the others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from inverse.loops import named, outcome, parallel_loop, right_angles, singular_values_of, values_of, with_types
from sweeps import sweep

from robokin.inverse.closed_form.three_parallel_axes import ThreeParallel

TYPES = ["RRR", "RRP", "RPR", "PRR"]
ARMS = ["ur3", "ur5e", "ur10", "ur20"]


@pytest.mark.parametrize("special", [False, True])
@pytest.mark.parametrize("types", sweep(TYPES, 4))
def test_the_joints_that_made_the_pose_are_found_at_every_place(types, special, rng):
    spurious = 0
    for first in range(4):
        for _ in range(3):
            loop = parallel_loop(rng, first, types, special)
            solver = ThreeParallel.find(loop)
            assert solver is not None
            assert "are parallel" in solver.sentence
            result = outcome(solver, loop, values_of(loop, rng, 40), steps=3)
            assert result.found == 1.0
            spurious += result.open
    assert spurious <= 0.05 * 12 * 40 * 8


@pytest.mark.parametrize("name", ARMS)
def test_arms_of_the_library(name, rng):
    loop = named(name)
    solver = ThreeParallel.find(loop)
    assert solver is not None
    assert solver.sentence == "axes 2, 3, 4 are parallel"
    assert solver.method == "three parallel axes"
    result = outcome(solver, loop, values_of(loop, rng, 300))
    assert result.found == 1.0
    # Just beyond the reach of the elbow a double solution is proposed.
    assert result.open <= 0.003 * len(result.index)
    assert np.max(result.closing) == 8
    assert np.all(result.closing % 2 == 0)


@pytest.mark.parametrize("name", ARMS)
@pytest.mark.parametrize("bend", [0.0, np.pi])
def test_with_four_parallel_axes_every_branch_of_the_family_has_a_point(name, bend, rng):
    # Joints 1 and 5 are determined. Of the others there is a curve, over whatever distances the wrist can have from the
    # shoulder, in up to four sheets: two elbows, and joint 6 and its mirror image.
    loop = named(name)
    q = values_of(loop, rng, 200)
    q[:, 4] = bend
    result = outcome(ThreeParallel.find(loop), loop, q, joints=[0, 4])
    assert result.found == 1.0
    assert np.min(result.closing) >= 4


@pytest.mark.parametrize("exponent", range(-9, -2))
def test_near_four_parallel_axes_both_solutions_are_kept(exponent, rng):
    loop = named("ur5e")
    q = values_of(loop, rng, 100)
    q[:, 4] = 10.0**exponent * rng.choice([-1.0, 1.0], 100)
    assert outcome(ThreeParallel.find(loop), loop, q).found == 1.0


@pytest.mark.parametrize("off", [0.0, 1e-9, 1e-6, 1e-3])
@pytest.mark.parametrize("vary", [1, 2])
def test_elbow_and_shoulder_of_the_ur(vary, off, rng):
    loop = named("ur5e")
    q = singular_values_of(loop, rng, 60, vary)
    q[:, vary] += off
    assert outcome(ThreeParallel.find(loop), loop, q, steps=3).found == 1.0


@pytest.mark.parametrize("name", ARMS)
def test_round_angles(name, rng):
    loop = named(name)
    assert outcome(ThreeParallel.find(loop), loop, right_angles(loop, rng, 200), steps=3).solved == 1.0


@pytest.mark.parametrize("types", sweep(TYPES, 4))
def test_round_angles_of_round_arms(types, rng):
    solved = []
    for first in range(4):
        for _ in range(3):
            loop = parallel_loop(rng, first, types, special=True)
            solved.append(outcome(ThreeParallel.find(loop), loop, right_angles(loop, rng, 40), steps=4).solved)
    # What is missing are poses that are singular twice over.
    assert np.mean(solved) > 0.94


@pytest.mark.parametrize("beyond", [-1e-9, 1e-9])
def test_at_the_end_of_the_reach(beyond, rng):
    loop = named("ur5e")
    q = values_of(loop, rng, 60)
    q[:, 2] = 0.0
    links = loop.links.copy()
    links[1:3, :3, 3] *= 1.0 - beyond
    result = outcome(ThreeParallel.find(replace(loop, links=links)), loop, q, steps=3)
    assert result.solved == 1.0


def test_what_has_no_three_parallel_axes_or_no_wrist_is_left_to_others(rng):
    assert ThreeParallel.find(named("puma560")) is None
    for types in ("RPP", "PRP", "PPR", "PPP"):
        loop = parallel_loop(rng, 1, "RRR", special=False)
        assert ThreeParallel.find(with_types(1, types, loop.links)) is None
    loop = named("ur5e")
    links = loop.links.copy()
    links[1, :3, :3] = links[1, :3, :3] @ [[1.0, 0.0, 0.0], [0.0, 1.0, -1e-6], [0.0, 1e-6, 1.0]]
    bent = replace(loop, links=links)
    assert ThreeParallel.find(bent) is None
    nearly = ThreeParallel.find(bent, tolerance=1e-5)
    assert nearly is not None
    assert nearly.deviation == pytest.approx(1e-6, rel=1e-3)
    assert outcome(nearly, bent, values_of(bent, rng, 100), steps=6).found > 0.97


def test_no_target_and_no_number():
    solver = ThreeParallel.find(named("ur5e"))
    assert solver.candidates(np.empty((0, 4, 4))).values.shape == (0, 6)
    values = solver.candidates(np.full((2, 4, 4), np.nan)).values
    assert not np.isfinite(values).all(axis=1).any()
