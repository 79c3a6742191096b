"""The elimination finds every solution of any six joints: those that made the pose, and as many as are known."""

from __future__ import annotations

import itertools
import json
from pathlib import Path

import numpy as np
import pytest
from sweeps import sweep

import robokin
from robokin.inverse.elimination import fourteen_functions as fourteen
from robokin.inverse.elimination.loop import loop_of
from robokin.inverse.elimination.loop_newton import closing_at, determinants, refine
from robokin.inverse.elimination.splits import (
    SPLITS,
    Elimination,
    choose_splits,
    count_solutions,
    generic_count,
    rescue_candidates,
)
from robokin.kernel.chain import Chain, chain_of
from robokin.kernel.frames import joint_motion
from robokin.spatial import nearest_rotation, rotation_from_rpy, transform
from robokin.spatial.dh import standard_dh

EXAMPLES = json.loads((Path(__file__).parent.parent / "data" / "six_r_examples.json").read_text())
ARMS = ["crx10ia", "j2n6s200", "xarm6", "ur5e", "hc10", "m1013", "gen3-lite", "piper-old", "xmate-sr3", "z1"]


def chain(types, a, alpha, d, theta):
    """A chain of Denavit-Hartenberg rows; theta is the constant angle of a sliding joint."""
    rows = [
        standard_dh(0.0 if kind == "R" else theta[i], d[i] if kind == "R" else 0.0, a[i], alpha[i])
        for i, kind in enumerate(types)
    ]
    return Chain(np.stack([np.eye(4), *rows]), np.array([kind == "R" for kind in types]), np.zeros(6))


def random_loop(rng, types="RRRRRR"):
    lengths = rng.normal(size=(2, 6))
    return loop_of(chain(types, lengths[0], rng.uniform(-3, 3, 6), lengths[1], rng.uniform(-3, 3, 6)))


def special_loop(rng, types="RRRRRR"):
    """Half of the lengths 0 and most twists right angles, of those arms that are not singular everywhere."""
    while True:
        lengths = rng.normal(size=(2, 6)) * (rng.random((2, 6)) < 0.5)
        twists, angles = rng.choice([0.0, np.pi / 2, -np.pi / 2, 1.0], (2, 6))
        loop = loop_of(chain(types, lengths[0], twists, lengths[1], angles))
        if np.max(determinants(loop, values_of(loop, rng, 4))) > 1e-6:
            return loop


def values_of(loop, rng, count):
    spans = np.where(loop.revolute, np.pi, 1.0)
    return rng.uniform(-spans, spans, (count, 6))


def gaps(loop, a, b):
    gap = a - b
    return np.max(np.abs(np.where(loop.revolute, gap - 2 * np.pi * np.round(gap / (2 * np.pi)), gap)), axis=-1)


def solutions(loop, closing, candidates, steps):
    """Distinct solutions, and for each its target."""
    values, position, angle = refine(loop, closing, candidates.index, candidates.values, steps)
    kept = []
    for i in np.flatnonzero((position < 1e-9) & (angle < 1e-9)):
        same = [k for k in kept if candidates.index[k] == candidates.index[i]]
        if not same or np.min(gaps(loop, values[same], values[i])) > 1e-5:
            kept.append(i)
    return candidates.index[kept], values[kept]


def found(loop, index, values, wanted):
    hits = index[gaps(loop, values, wanted[index]) < 1e-6]
    return len(np.unique(hits)) / len(wanted)


def share_found(loop, split, wanted, steps=2):
    closing = closing_at(loop, wanted)
    candidates = Elimination(loop, split).candidates(closing)
    values, _, _ = refine(loop, closing, candidates.index, candidates.values, steps)
    return found(loop, candidates.index, values, wanted)


def rescued(loop, splits, wanted):
    """What the best split finds and, where that is doubtful, the rescue."""
    closing = closing_at(loop, wanted)
    real, imaginary = Elimination(loop, splits[0]).all_candidates(closing)
    index, values = solutions(loop, closing, real, 12)
    parts = [(index, values), (imaginary.index, imaginary.values)]
    again = np.flatnonzero(count_solutions(loop, closing, parts, 2).number != generic_count(loop, splits))
    more = rescue_candidates(loop, splits, closing[again])
    return found(loop, np.append(index, again[more.index]), np.concatenate([values, more.values]), wanted)


@pytest.mark.parametrize("seed", range(6))
def test_a_general_arm_is_solved_with_an_even_number_of_solutions(seed):
    rng = np.random.default_rng(seed)
    loop = random_loop(rng)
    splits, wanted = choose_splits(loop), values_of(loop, rng, 60)
    closing = closing_at(loop, wanted)
    index, values = solutions(loop, closing, Elimination(loop, splits[0]).candidates(closing), 3)
    assert found(loop, index, values, wanted) == 1.0
    assert not np.any(np.bincount(index, minlength=60) % 2)
    assert share_found(loop, splits[0], wanted) == 1.0


@pytest.mark.parametrize("split", range(2 * SPLITS))
def test_every_split_serves_a_general_arm(split):
    rng = np.random.default_rng(20)
    loop = random_loop(rng)
    assert share_found(loop, split, values_of(loop, rng, 30), steps=4) == 1.0


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example["id"])
def test_published_examples_have_their_number_of_solutions(example):
    twists, angles = np.deg2rad(example["alpha"]), np.deg2rad(example["theta"])
    loop = loop_of(chain(example["joints"], example["a"], twists, example["d"], angles))
    T = np.array(example["pose"], dtype=float)
    T[:3, :3] = nearest_rotation(T[:3, :3])
    closing = loop.closing(T[None])
    splits = choose_splits(loop)
    # A spherical wrist makes the published fifth arm special: what one split lacks the others have.
    more = rescue_candidates(loop, splits, closing)
    one = solutions(loop, closing, Elimination(loop, splits[0]).candidates(closing), 6)[1]
    assert len(one) == example["count"]
    assert len(solutions(loop, closing, more, 0)[1]) == example["count"]
    if example["joints"] == "RRRRRR":
        for known in np.deg2rad(example["solutions"]):
            assert np.min(gaps(loop, one, known)) < 10.0 ** -example["solution_digits"]


@pytest.mark.parametrize("place", range(6))
def test_one_sliding_joint_anywhere(place):
    rng = np.random.default_rng(place)
    loop = random_loop(rng, "R" * place + "P" + "R" * (5 - place))
    wanted = values_of(loop, rng, 30)
    for split in range(SPLITS):
        assert share_found(loop, split, wanted, steps=3) == 1.0


@pytest.mark.parametrize("places", sweep([(two,) for two in itertools.combinations(range(6), 2)], 3))
def test_two_sliding_joints_anywhere(places):
    rng = np.random.default_rng(places)
    loop = random_loop(rng, "".join("P" if i in places else "R" for i in range(6)))
    splits = choose_splits(loop)
    assert len(splits) >= 2
    for split in splits[:2]:
        assert share_found(loop, split, values_of(loop, rng, 30), steps=3) == 1.0


@pytest.mark.parametrize("types", sweep(["RRRRRR", "PRRRRR", "RRPRRR", "RPRRPR"], 4))
def test_arms_with_zero_lengths_and_right_angles(types):
    rng = np.random.default_rng(11)
    for _ in range(6):
        loop = special_loop(rng, types)
        assert rescued(loop, choose_splits(loop), values_of(loop, rng, 20)) == 1.0


@pytest.mark.parametrize("name", sweep(ARMS, 3))
def test_arms_on_sale(name):
    loop = loop_of(chain_of(robokin.load(name)))
    splits, wanted = choose_splits(loop), values_of(loop, np.random.default_rng(1), 60)
    assert splits[0] < SPLITS
    assert rescued(loop, splits, wanted) == 1.0


@pytest.mark.parametrize(
    "name", sweep(["crx10ia", "j2n6s200", "xarm6", "hc10", "gen3-lite", "piper-old", "crx20ia-l"], 4)
)
def test_an_elimination_finds_all_sixteen_complex_solutions_of_an_arm_on_sale(name):
    """Six joints have at most 16 (E. J. F. Primrose, Mech. Mach. Theory 21, 1986), and these arms have them all."""
    loop = loop_of(chain_of(robokin.load(name)))
    splits = choose_splits(loop)
    assert generic_count(loop, splits) == 16
    closing = closing_at(loop, values_of(loop, np.random.default_rng(12), 40))
    parts = [(part.index, part.values) for part in Elimination(loop, splits[0]).all_candidates(closing)]
    counted = count_solutions(loop, closing, parts, 2)
    assert np.max(counted.number) == 16
    assert np.mean(counted.number == 16) >= 0.95
    complex_ = np.abs(counted.values.imag).max(axis=1) > 1e-7
    assert counted.kept.sum() + (counted.kept & complex_).sum() == counted.number.sum()


@pytest.mark.parametrize("name", sweep(["crx10ia", "j2n6s200", "xarm6", "hc10", "gen3-lite", "piper-old"], 3))
@pytest.mark.parametrize("distance", sweep([1e-2, 1e-4, 1e-5], 3))
def test_near_singular_poses(name, distance):
    loop = loop_of(chain_of(robokin.load(name)))
    wanted = singular_values_of_joints(loop, np.random.default_rng(2), 12)
    wanted = wanted + distance * np.random.default_rng(3).normal(size=wanted.shape)
    more = rescue_candidates(loop, choose_splits(loop), closing_at(loop, wanted))
    hits = more.index[gaps(loop, more.values, wanted[more.index]) < 1e-5]
    assert len(np.unique(hits)) == len(wanted)


@pytest.mark.parametrize("name", sweep(["crx10ia", "xarm6", "hc10", "manocha-canny-1994"], 4))
def test_singular_poses_have_an_answer(name):
    loop = loop_of(chain_of(robokin.load(name)))
    wanted = singular_values_of_joints(loop, np.random.default_rng(4), 12)
    wanted = np.concatenate([wanted, np.random.default_rng(5).integers(-1, 3, (12, 6)) * np.pi / 2])
    more = rescue_candidates(loop, choose_splits(loop), closing_at(loop, wanted))
    assert len(np.unique(more.index)) == len(wanted)


def singular_values_of_joints(loop, rng, count):
    """Joint values where det S = 0, between values where it has opposite signs, by bisection."""
    low = values_of(loop, rng, 8 * count)
    high = low + rng.normal(size=low.shape)
    sign = np.sign(signed(loop, low))
    turns = sign * signed(loop, high) < 0
    low, high, sign = low[turns][:count], high[turns][:count], sign[turns][:count]
    assert len(low) == count
    for _ in range(55):
        middle = 0.5 * (low + high)
        before = (sign * signed(loop, middle) > 0)[:, None]
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    return low


def signed(loop, values):
    """det S, the columns written as the definition says."""
    dets = []
    for q in values:
        X, S = np.eye(4), np.empty((6, 6))
        for i, turns in enumerate(loop.revolute):
            z, o = X[:3, 2], X[:3, 3]
            S[i] = [*np.cross(o, z), *z] if turns else [*z, 0, 0, 0]
            X = X @ joint_motion(bool(turns), q[i : i + 1])[0] @ (loop.links[i] if i < 5 else np.eye(4))
        dets.append(np.linalg.det(S))
    return np.array(dets)


def test_no_target_and_a_target_out_of_reach():
    loop = random_loop(np.random.default_rng(0))
    solver = Elimination(loop, 1)
    assert solver.candidates(np.empty((0, 4, 4))).values.shape == (0, 6)
    closing = transform(np.eye(3), np.array([[50.0, 0.0, 0.0]]))
    assert not len(solutions(loop, closing, solver.candidates(closing), 10)[0])
    assert not len(rescue_candidates(loop, [1], closing).index)


@pytest.mark.parametrize("free_turns", [True, False])
def test_the_fourteen_functions_are_moved_by_matrices(free_turns):
    rng = np.random.default_rng(1)
    X, Y = transform(rotation_from_rpy(rng.uniform(-3, 3, (2, 9, 3))), rng.normal(size=(2, 9, 3)))
    A, f = fourteen.action(X, free_turns), fourteen.of_frames(Y, free_turns)
    np.testing.assert_allclose((A @ f[..., None])[..., 0], fourteen.of_frames(X @ Y, free_turns), atol=1e-13)
    np.testing.assert_allclose(A @ fourteen.action(Y, free_turns), fourteen.action(X @ Y, free_turns), atol=1e-13)
    for turns in (True, False):
        q = rng.uniform(-3, 3, 9)
        J = joint_motion(turns, q)
        powers = np.stack([np.ones(9), np.cos(q), np.sin(q)] if turns else [np.ones(9), q, q * q], axis=1)
        parts = np.einsum("sk,kij->sij", powers, fourteen.joint_action(turns, free_turns))
        np.testing.assert_allclose(parts, fourteen.action(J, free_turns), atol=1e-13)
        left_alone = fourteen.invariants(turns, free_turns)
        np.testing.assert_allclose(fourteen.of_frames(J @ Y, free_turns)[:, left_alone], f[:, left_alone], atol=1e-13)
        free = joint_motion(free_turns, q)
        np.testing.assert_allclose(fourteen.of_frames(Y @ free, free_turns), f, atol=1e-13)


@pytest.mark.parametrize("types", ["RRRRRR", "PRPRRR"])
def test_newton_converges_quadratically_and_says_what_is_left(types):
    rng = np.random.default_rng(5)
    loop = random_loop(rng, types)
    wanted = values_of(loop, rng, 300)
    wanted = wanted[determinants(loop, wanted) > 1e-3]
    closing, index = closing_at(loop, wanted), np.arange(len(wanted))
    start = wanted + 1e-4 * rng.normal(size=wanted.shape)
    left = []
    for steps in range(4):
        values, position, angle = refine(loop, closing, index, start, steps)
        X = np.linalg.inv(closing) @ closing_at(loop, values)
        np.testing.assert_allclose(position, np.linalg.norm(X[:, :3, 3], axis=1), atol=2e-4 * 10.0**-steps)
        left.append(np.max(position + angle))
    assert left[1] < 1e-6
    assert left[2] < 1e-10
    assert left[3] < 1e-13
    assert np.max(gaps(loop, values, wanted)) < 1e-9


def test_newton_is_safe_where_the_arm_is_singular():
    loop = loop_of(chain_of(robokin.load("puma560")))
    wanted = values_of(loop, np.random.default_rng(3), 50)
    wanted[:, 4] = 0.0
    start = wanted + 1e-3 * np.random.default_rng(4).normal(size=wanted.shape)
    values, position, angle = refine(loop, closing_at(loop, wanted), np.arange(50), start, 12)
    assert max(position.max(), angle.max()) < 1e-10
    assert np.max(gaps(loop, values, wanted)) < 2e-2


def test_a_half_turn_does_not_pass_for_closed():
    loop = random_loop(np.random.default_rng(8))
    values = values_of(loop, np.random.default_rng(9), 1)
    closing = closing_at(loop, values) @ transform(rotation_from_rpy([np.pi, 0.0, 0.0]), np.zeros(3))
    _, _, angle = refine(loop, closing, np.array([0]), values, 0)
    assert angle[0] == pytest.approx(np.pi)
