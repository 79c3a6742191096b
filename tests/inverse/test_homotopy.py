"""The homotopy finds the generic number of complex solutions, and no regular real one is missing where it says so."""

from __future__ import annotations

import json
from functools import lru_cache, partial
from pathlib import Path

import numpy as np
import pytest
from inverse.loops import closing_of, gaps, named, random_links, with_types
from sweeps import sweep

import robokin
from robokin.inverse.analysis import General, analysis_of
from robokin.inverse.elimination.complex_newton import complex_refine, distinct, regular, regular_and_distinct
from robokin.inverse.elimination.homotopy import Homotopy
from robokin.inverse.elimination.homotopy_paths import points_at, points_of
from robokin.inverse.elimination.loop import Loop, loop_of
from robokin.inverse.elimination.loop_newton import refine
from robokin.inverse.elimination.starts_close_by import CloseBy
from robokin.inverse.second_look import known_solutions
from robokin.kernel.chain import Chain
from robokin.spatial import nearest_rotation
from robokin.spatial.dh import standard_dh

EXAMPLES = json.loads((Path(__file__).parent.parent / "data" / "six_r_examples.json").read_text())
TURN = 2.0 * np.pi

# The generic numbers: 16 for six revolute joints (Primrose 1986; Lee and Liang 1988), 8 where three axes meet in a
# point (Pieper 1968) or are parallel.
NUMBERS = {"xarm6": 16, "hc10": 16, "crx10ia": 16, "puma560": 8, "ur5e": 8, "yam": 8, "stanford": 8}


@lru_cache
def homotopy(name):
    return Homotopy(general_loop() if name == "general" else named(name))


def general_loop(types="RRRRRR", seed=4):
    return Loop(
        np.array([kind == "R" for kind in types]), random_links(np.random.default_rng(seed), False), np.eye(4),
        np.eye(4), 1.0,
    )  # fmt: skip


def values_on_grid(loop, rng, count, degrees):
    turns = 360 // degrees
    angles = rng.integers(-turns // 2 + 1, turns // 2 + 1, (count, 6)) * np.deg2rad(degrees)
    return np.where(loop.revolute, angles, rng.integers(-2, 3, (count, 6)) * 0.15)


def poses_of(loop, rng, kind, count):
    if kind == "random":
        return np.where(loop.revolute, rng.uniform(-np.pi, np.pi, (count, 6)), rng.uniform(-0.4, 0.4, (count, 6)))
    if kind == "q4 = 0":
        q = poses_of(loop, rng, "random", count)
        q[:, 3] = 0.0
        return q
    if kind == "one ulp off 90°":
        q = values_on_grid(loop, rng, count, 90)
        return np.nextafter(q, np.where(rng.random(q.shape) < 0.5, -9.0, 9.0))
    if kind == "near 30°":
        return values_on_grid(loop, rng, count, 30) + rng.normal(size=(count, 6)) * 10.0 ** rng.uniform(-12, -5)
    return values_on_grid(loop, rng, count, int(kind.rstrip("°")))


def regular_solutions(loop, closing, rng, starts):
    """Regular real solutions (s,), (s, 6) that Newton's steps find from many starts."""
    index = np.repeat(np.arange(len(closing)), starts)
    spread = np.where(loop.revolute, np.pi, 0.5)
    values, position, angle = refine(loop, closing, index, rng.uniform(-spread, spread, (len(index), 6)), 24)
    closed = np.hypot(position, angle) < 1e-10
    index, values = index[closed], values[closed]
    values, residual = complex_refine(loop, closing, index, values, 1)
    kept = regular(loop, values, residual, 1e-4)
    return index[kept], values[kept].real


def missing(loop, account, index, values):
    """(s,) whether values (s, 6) for the targets index are not in the account."""
    least = np.full(len(index), np.inf)
    for i in np.unique(index):
        mine = account.values[account.index == i]
        for s in np.flatnonzero(index == i):
            least[s] = np.min(np.max(gaps(loop, mine, values[s]), axis=1), initial=np.inf)
    return least > 1e-6


@pytest.mark.parametrize("name", sweep(NUMBERS, 4))
def test_the_number_of_complex_solutions_of_known_arms(name):
    assert homotopy(name).count == NUMBERS[name]


def test_six_general_revolute_joints_have_sixteen_solutions():
    assert homotopy("general").count == 16


def test_three_sliding_joints():
    """The turns alone decide the orientation: two solutions, and the slides then follow from linear equations."""
    loop = general_loop("PPRRRP")
    found = Homotopy(loop)
    assert found.count == 2
    rng = np.random.default_rng(6)
    q = poses_of(loop, rng, "random", 8)
    account = found.account(closing_of(loop, q))
    assert account.closed.all()
    assert not missing(loop, account, np.arange(8), q).any()


def test_an_arm_that_is_singular_everywhere_has_no_number():
    parallel = Loop(np.ones(6, dtype=bool), np.tile(np.eye(4), (5, 1, 1)), np.eye(4), np.eye(4), 1.0)
    found = Homotopy(parallel)
    assert found.count is None
    with pytest.raises(ValueError, match="could not be established"):
        found.account(np.eye(4)[None])


@pytest.mark.parametrize("kind", sweep(["random", "90°", "30°", "q4 = 0", "one ulp off 90°", "near 30°"], 2))
@pytest.mark.parametrize("name", sweep(["xarm6", "ur5e", "stanford"], 3))
def test_no_regular_solution_is_missing_where_the_account_is_closed(name, kind):
    found, rng = homotopy(name), np.random.default_rng(8)
    loop = found.loop
    q = poses_of(loop, rng, kind, 12)
    closing = closing_of(loop, q)
    account = found.account(closing)
    assert account.closed.mean() > 0.9
    assert np.all(account.regular + account.singular + account.infinite + account.lost == found.count)
    own = regular(loop, q, np.zeros(len(q)), 1e-4)
    index, values = regular_solutions(loop, closing, rng, 60)
    index, values = np.concatenate([index, np.flatnonzero(own)]), np.concatenate([values, q[own]])
    assert not missing(loop, account, index, values)[account.closed[index]].any()


@pytest.mark.parametrize("name", ["crx10ia", "puma560"])
def test_what_is_listed_closes_and_is_listed_once(name):
    found, rng = homotopy(name), np.random.default_rng(9)
    loop = found.loop
    closing = closing_of(loop, poses_of(loop, rng, "90°", 10))
    account = found.account(closing)
    _, position, angle = refine(loop, closing, account.index, account.values, 0)
    assert np.max(np.hypot(position, angle)) < 1e-11
    assert distinct(loop, account.index, account.values, 1e-6).all()
    assert np.array_equal(np.bincount(account.index, minlength=10), account.real)
    assert len(account.singular_index)  # these poses are singular for one configuration or another
    _, position, angle = refine(loop, closing, account.singular_index, account.singular_values, 0)
    assert np.max(np.hypot(position, angle)) < 1e-6


def test_generic_targets_are_reached_by_all_solutions():
    found = homotopy("general")
    q = poses_of(found.loop, np.random.default_rng(10), "random", 10)
    account = found.account(closing_of(found.loop, q))
    assert account.closed.all()
    assert np.all(account.regular == 16)
    assert np.all(account.real % 2 == 0)
    assert account.words(0) == f"of 16 paths 16 end in regular solutions ({account.real[0]} real)"


@pytest.mark.parametrize("example", sweep(EXAMPLES[::3], 2), ids=lambda example: example["id"])
def test_published_examples_have_their_number_of_real_solutions(example):
    rows = [
        standard_dh(0.0 if kind == "R" else np.deg2rad(theta), d if kind == "R" else 0.0, a, np.deg2rad(alpha))
        for kind, theta, d, a, alpha in zip(
            example["joints"], example["theta"], example["d"], example["a"], example["alpha"], strict=True
        )
    ]
    turning = np.array([kind == "R" for kind in example["joints"]])
    loop = loop_of(Chain(np.stack([np.eye(4), *rows]), turning, np.zeros(6)))
    T = np.array(example["pose"], dtype=float)
    T[:3, :3] = nearest_rotation(T[:3, :3])
    account = Homotopy(loop).account(loop.closing(T[None]))
    assert account.closed.all()
    assert account.real[0] == example["count"]


def test_points_give_back_the_target():
    """The point of the target that complex joint values reach belongs to a rotation that closes the loop."""
    loop, rng = general_loop(), np.random.default_rng(12)
    q = poses_of(loop, rng, "random", 20)
    ours, given = points_at(loop, q.T.astype(complex)), points_of(closing_of(loop, q))
    assert np.max(np.abs(ours.p - given.p)) < 1e-13
    along = np.abs((ours.r.conj() * given.r).sum(axis=0))
    assert np.allclose(along, np.linalg.norm(ours.r, axis=0) * np.linalg.norm(given.r, axis=0))


def test_complex_newton_steps_bring_values_back():
    loop, rng = general_loop(), np.random.default_rng(13)
    q = poses_of(loop, rng, "random", 50)
    q = q[regular(loop, q, np.zeros(len(q)), 0.05)]
    index = np.arange(len(q))
    off = q + 1e-4 * (rng.normal(size=q.shape) + 1j * rng.normal(size=q.shape))
    found, residual = complex_refine(loop, closing_of(loop, q), index, off, 4)
    assert np.max(residual) < 1e-14
    assert np.max(np.abs(found - q)) < 1e-11


def test_half_turns_are_not_closed():
    """The error's skew part vanishes where a turn by 180° is missing; the residual does not."""
    loop, rng = general_loop(), np.random.default_rng(14)
    q = poses_of(loop, rng, "random", 5)
    exact, residual = complex_refine(loop, closing_of(loop, q), np.arange(5), q, 0)
    assert np.max(residual) < 1e-14
    _, residual = complex_refine(loop, closing_of(loop, q) @ np.diag([-1.0, -1.0, 1.0, 1.0]), np.arange(5), exact, 0)
    assert np.min(residual) > 0.1


def test_copies_turns_and_conjugates_are_counted_rightly():
    loop, rng = general_loop("RRPRRR"), np.random.default_rng(15)
    q = poses_of(loop, rng, "random", 40) + 1j * rng.uniform(0.1, 0.5, (40, 6))
    turns = TURN * rng.integers(-2, 3, q.shape) * loop.revolute
    values = np.concatenate([q, q + turns + 1e-9, q.conj(), q.conj() + turns])
    index = np.tile(np.arange(40), 4)
    order = rng.permutation(len(index))
    kept = distinct(loop, index[order], values[order])
    assert np.array_equal(np.bincount(index[order][kept]), np.full(40, 2))


def test_singular_candidates_and_those_that_do_not_close_are_not_counted():
    loop = with_types(0, "RRR", random_links(np.random.default_rng(16), False))
    rng = np.random.default_rng(17)
    q = poses_of(loop, rng, "random", 3)
    straight = named("puma560")
    index, residual = np.arange(3), np.array([0.0, 1e-15, 1e-3])
    assert regular_and_distinct(loop, index, q, residual).tolist() == [True, True, False]
    assert not regular_and_distinct(straight, index, np.zeros((3, 6)), np.zeros(3)).any()  # q5 = 0


@pytest.mark.parametrize("name", sweep(["xarm6", "hc10", "puma560", "ur5e"], 4))
def test_starts_close_by_lead_where_far_ones_do(name):
    """The kinds of ends are as many, and the regular ones the same: at random poses and at singular ones."""
    analysis = analysis_of(robokin.load(name))
    loop, solver = analysis.loop, analysis.solver
    beside = CloseBy(loop, getattr(solver, "first", solver) if isinstance(solver, General) else solver, analysis.number)
    rng = np.random.default_rng([3, len(name)])
    q = np.concatenate([poses_of(loop, rng, kind, 4) for kind in ("random", "q4 = 0", "90°", "30°")])
    closing = closing_of(loop, q)
    near = beside(closing)
    assert len(near.chosen) > 4
    for around, values in zip(near.closing, near.values, strict=True):
        # All solutions there, and each but once.
        flat, index = values.reshape(-1, 6), np.repeat(np.arange(len(values)), values.shape[1])
        exact, residual = complex_refine(loop, around, index, flat, 1)
        assert np.max(residual) < 1e-9
        assert np.max(np.abs(exact - flat)) < 1e-6
        assert regular_and_distinct(loop, index, exact, residual).all()
    known = partial(known_solutions, loop, solver, analysis.number)
    short, far = Homotopy(loop, known, beside).account(closing), Homotopy(loop, known).account(closing)
    both = short.closed & far.closed
    assert both.sum() >= 14
    for kind in ("regular", "real", "singular", "infinite"):
        assert np.array_equal(getattr(short, kind)[both], getattr(far, kind)[both]), kind
    for i in np.flatnonzero(both):
        ours, theirs = short.values[short.index == i], far.values[far.index == i]
        off = np.max(np.abs(gaps(loop, ours[:, None], theirs[None])), axis=2)
        assert np.all(np.min(off, axis=1, initial=9.0) < 1e-8)
