"""Three axes through one point: every solution, at every place, with every mixture of the other joints."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from inverse.loops import (
    RIGHT,
    closing_of,
    joint,
    named,
    outcome,
    right_angles,
    singular_values_of,
    spherical_loop,
    values_of,
)
from sweeps import sweep

from robokin.inverse.closed_form.loop_axes import meeting_point
from robokin.inverse.closed_form.spherical_wrist import SphericalTriple
from robokin.inverse.elimination.loop import loop_of
from robokin.kernel.chain import Chain
from robokin.spatial import invert
from robokin.spatial.dh import standard_dh

TYPES = ["".join(letters) for letters in itertools.product("RP", repeat=3)]
ARMS = ["puma560", "stanford", "anthropomorphic-wrist", "irb140", "kr6-r900"]


@pytest.mark.parametrize("special", [False, True])
@pytest.mark.parametrize("types", sweep(TYPES, 4))
def test_the_joints_that_made_the_pose_are_found_at_every_place(types, special, rng):
    spurious = 0
    for first in range(4):
        for _ in range(3):
            loop = spherical_loop(rng, first, types, special)
            solver = SphericalTriple.find(loop)
            assert solver is not None
            assert "meet in one point" in solver.sentence
            result = outcome(solver, loop, values_of(loop, rng, 40), steps=3)
            assert result.found == 1.0
            spurious += result.open
    # Almost double complex roots are kept as if real; there are few.
    assert spurious <= 0.05 * 12 * 40 * 8


@pytest.mark.parametrize("name", ARMS)
def test_arms_of_the_library(name, rng):
    loop = named(name)
    solver = SphericalTriple.find(loop)
    assert solver is not None
    assert solver.sentence == "axes 4, 5, 6 meet in one point"
    assert solver.method == "spherical wrist"
    q = values_of(loop, rng, 300)
    result = outcome(solver, loop, q)
    assert result.found == 1.0
    assert result.open == 0
    assert np.max(result.closing) == 8
    raw = solver.candidates(closing_of(loop, q)).values
    assert len(raw) == np.sum(result.closing)
    if name in ("puma560", "stanford", "anthropomorphic-wrist"):
        assert np.all(result.closing == 8)


@pytest.mark.parametrize("name", ARMS)
@pytest.mark.parametrize("bend", [0.0, np.pi])
def test_a_singular_wrist_keeps_the_arm_and_gives_a_representative(name, bend, rng):
    loop = named(name)
    q = values_of(loop, rng, 200)
    q[:, 4] = bend
    result = outcome(SphericalTriple.find(loop), loop, q, joints=[0, 1, 2, 4])
    assert result.found == 1.0


@pytest.mark.parametrize("exponent", range(-8, -2))
def test_near_the_singular_wrist_both_solutions_are_kept(exponent, rng):
    loop = named("puma560")
    q = values_of(loop, rng, 100)
    q[:, 4] = 10.0**exponent * rng.choice([-1.0, 1.0], 100)
    result = outcome(SphericalTriple.find(loop), loop, q)
    assert result.found == 1.0
    assert np.all(result.closing == 8)


@pytest.mark.parametrize("off", [0.0, 1e-9, 1e-6, 1e-3])
@pytest.mark.parametrize("vary", [1, 2])
def test_elbow_and_shoulder_of_the_puma(vary, off, rng):
    loop = named("puma560")
    q = singular_values_of(loop, rng, 60, vary)
    q[:, vary] += off
    assert outcome(SphericalTriple.find(loop), loop, q).found == 1.0


@pytest.mark.parametrize("name", ["anthropomorphic-wrist", "irb140", "kr6-r900"])
@pytest.mark.parametrize("vary", [1, 2])
def test_singular_poses_of_arms_whose_point_may_come_to_the_first_axis(name, vary, rng):
    # With the point on axis 1 that joint is free: something is found, if not what made the pose.
    loop = named(name)
    assert outcome(SphericalTriple.find(loop), loop, singular_values_of(loop, rng, 60, vary), steps=3).solved == 1.0


@pytest.mark.parametrize("name", ARMS)
def test_round_angles(name, rng):
    loop = named(name)
    assert outcome(SphericalTriple.find(loop), loop, right_angles(loop, rng, 200), steps=3).solved == 1.0


@pytest.mark.parametrize("types", sweep(TYPES, 4))
def test_round_angles_of_round_arms(types, rng):
    solved = []
    for first in range(4):
        for _ in range(3):
            loop = spherical_loop(rng, first, types, special=True)
            q = right_angles(loop, rng, 40)
            solved.append(outcome(SphericalTriple.find(loop), loop, q, steps=4).solved)
    # What is missing are poses that are singular twice over.
    assert np.mean(solved) > 0.97


def test_a_folded_arm_of_equal_links_frees_the_shoulder(rng):
    """The point comes to axis 2 (and to axis 1, in this arm) when the elbow is folded."""
    rows = [(0, 0, RIGHT), (0, 0.4, 0), (0, 0, RIGHT), (0.4, 0, -RIGHT), (0, 0, RIGHT), (0, 0, 0)]
    constants = np.stack([np.eye(4), *(standard_dh(0.0, d, a, twist) for d, a, twist in rows)])
    loop = loop_of(Chain(constants, np.ones(6, dtype=bool), np.zeros(6)))
    solver = SphericalTriple.find(loop)
    for off, least in ((0.0, 1.0), (1e-9, 1.0), (1e-6, 0.97), (1e-3, 1.0)):
        q = values_of(loop, rng, 100)
        q[:, 2] = -RIGHT + off
        assert outcome(solver, loop, q, steps=0, joints=[2]).found >= least


@pytest.mark.parametrize("beyond", [-1e-9, 1e-9])
def test_at_the_end_of_the_reach(beyond, rng):
    loop = named("puma560")
    solver = SphericalTriple.find(loop)
    q = singular_values_of(loop, rng, 40, 2)
    closing = closing_of(loop, q)
    # An arm that is shorter or longer by so much is as good as a target that is further or nearer.
    links = loop.links.copy()
    links[:3, :3, 3] *= 1.0 - beyond
    smaller = replace(loop, links=links)
    candidates = SphericalTriple.find(smaller).candidates(closing)
    assert np.isfinite(candidates.values).all()
    assert len(np.unique(candidates.index)) == len(q)
    assert len(np.unique(solver.candidates(closing).index)) == len(q)


def test_a_free_first_joint_gives_a_slanting_wrist_an_orientation_that_it_can_reach(rng):
    """The point on axis 1, for one position of joints 2 and 3, and a wrist that does not reach every orientation."""
    found = []
    for _ in range(8):
        loop = spherical_loop(rng, 3, "RRR", special=False)
        q = np.tile(values_of(loop, rng, 1), (60, 1))
        q[:, [0, 3, 4, 5]] = values_of(loop, rng, 60)[:, [0, 3, 4, 5]]
        links = loop.links.copy()
        point = joint(True, q[0, 2]) @ links[2] @ [0.0, 0.0, meeting_point(loop, 3)[1], 1.0]
        wanted = invert(links[0] @ joint(True, q[0, 1])) @ [0.0, 0.0, 0.2, 1.0]
        links[1, :3, 3] = (wanted - links[1] @ point + links[1, :, 3])[:3]
        loop = replace(loop, links=links)
        found.append(outcome(SphericalTriple.find(loop), loop, q, steps=4, joints=[1, 2]).found)
    # What is missing is within reach for less than the fan's 15° of joint 1.
    assert np.mean(found) > 0.98


def test_what_is_not_spherical_is_left_to_others(rng):
    assert SphericalTriple.find(named("ur5e")) is None
    loop = named("puma560")
    links = loop.links.copy()
    links[4, 0, 3] += 1e-6
    bent = replace(loop, links=links)
    assert SphericalTriple.find(bent) is None
    nearly = SphericalTriple.find(bent, tolerance=1e-5)
    assert nearly is not None
    assert 0.5e-6 < nearly.deviation < 2e-6
    assert outcome(nearly, bent, values_of(bent, rng, 100), steps=6).found > 0.97


def test_no_target_and_no_number():
    solver = SphericalTriple.find(named("kr6-r900"))
    assert solver.candidates(np.empty((0, 4, 4))).values.shape == (0, 6)
    closing = np.full((2, 4, 4), np.nan)
    values = solver.candidates(closing).values
    assert not np.isfinite(values).all(axis=1).any()
