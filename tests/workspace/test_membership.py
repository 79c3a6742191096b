"""Membership: what forward kinematics reaches is reachable, what a closed form excludes is not, counts are right."""

from __future__ import annotations

import numpy as np
import pytest
from sweeps import sweep

import robokin
from robokin.kernel.geometric_jacobian import motion
from robokin.model import Joint, JointType, Robot
from robokin.workspace.descent import descent_of
from robokin.workspace.membership import finitely_many, reachable, solution_count
from robokin.workspace.sampling import moving_chain, positions
from robokin.workspace.space import space_of

REST = (-np.inf, np.inf)


def planar(*lengths, limits=None):
    limits = limits or [REST] * len(lengths)
    rows = zip(lengths, limits, strict=True)
    return Robot("arm", tuple(Joint(str(i), JointType.REVOLUTE, a=a, limits=b) for i, (a, b) in enumerate(rows)))


def sampled(space, rng, count, beyond=0.0):
    """Joint values (n, count) in the box; with `beyond`, many of them on its faces."""
    u = np.clip((1.0 + 2.0 * beyond) * rng.random((len(space.low), count)) - beyond, 0.0, 1.0)
    return space.low[:, None] + (space.high - space.low)[:, None] * u


def around(radii, rng):
    """Points of the plane z = 0 at distances (m,) from the origin."""
    angle = rng.uniform(-np.pi, np.pi, len(radii))
    return np.stack([radii * np.cos(angle), radii * np.sin(angle), np.zeros(len(radii))], axis=1)


CLOSED = ["planar2r", "scara", "cobra-s350", "spherical", "cylindrical", "cartesian", "puma560-paul", "gp8"]


@pytest.mark.parametrize("name", [*CLOSED, "planar3r"])
def test_every_sampled_position_is_reachable(name, rng):
    space = space_of(robokin.load(name))
    p = positions(space, sampled(space, rng, 1000)).T
    assert reachable(space, p).all()
    if finitely_many(space):
        assert (solution_count(space, p) >= 1).all()


# One in ten thousand may be missed, and is on the boundary; these seeds have none.
@pytest.mark.parametrize(
    "name", sweep(["puma560", "ur5e", "stanford", "thumb", "panda", "irb120", "hc10", "human-arm"], 4)
)
def test_every_sampled_position_of_arms_with_more_joints_is_reachable(name, rng):
    space = space_of(robokin.load(name))
    q = np.concatenate([sampled(space, rng, 1000), sampled(space, rng, 1000, beyond=0.2)], axis=1)
    assert not finitely_many(space)
    assert np.count_nonzero(~reachable(space, positions(space, q).T)) == 0


def test_points_beyond_whole_numbers_are_out_of_reach():
    for name in ("puma560", "ur5e", "iiwa14"):
        points = [[1e30, 0.0, 0.0], [1e18, 1e18, -1e19], [0.3, 0.2, 0.5], [-1e25, 3.0, 1e22]]
        assert reachable(space_of(robokin.load(name)), points).tolist() == [False, False, True, False]


def test_nothing_beyond_the_greatest_distance_or_out_of_the_plane_is_reachable(rng):
    for name in ("puma560", "planar3r", "panda"):
        space = space_of(robokin.load(name))
        p = positions(space, sampled(space, rng, 4000)).T
        middle = p.mean(axis=0)
        most = np.max(np.linalg.norm(p - middle, axis=1))
        away = (p - middle) / np.linalg.norm(p - middle, axis=1)[:, None] * most * 1.5 + middle
        assert not reachable(space, away[:500]).any()
    space = space_of(robokin.load("planar3r"))
    assert not reachable(space, [[0.5, 0.5, 1e-3]]).any()
    assert reachable(space, [[0.5, 0.5, 0.0]]).all()
    assert not reachable(space_of(robokin.load("planar2r")), [[0.5, 0.5, 1e-3]]).any()


@pytest.mark.parametrize(
    "lengths", sweep([((1.0, 0.6),), ((1.0, 0.6, 0.35),), ((1.0, 0.3, 0.2),), ((2.0, 0.5, 0.4, 0.3),)], 4)
)
def test_the_annulus_s_edges(lengths, rng):
    space = space_of(planar(*lengths))
    most, least = sum(lengths), max(0.0, 2.0 * max(lengths) - sum(lengths))
    for depth in (1e-2, 1e-4, 1e-5):
        inner = around(np.full(200, most - depth), rng)
        outer = around(np.full(200, most + depth), rng)
        assert reachable(space, inner).all()
        assert not reachable(space, outer).any()
        if least:
            assert reachable(space, around(np.full(200, least + depth), rng)).all()
            assert not reachable(space, around(np.full(200, least - depth), rng)).any()


@pytest.mark.slow
def test_limits_of_a_redundant_planar_arm_against_all_its_configurations():
    limits = [(-1.0, 1.0), (0.2, 1.5), (-0.5, 1.0), (-0.3, 0.3)]
    space = space_of(planar(1.0, 0.6, 0.4, 0.3, limits=limits))
    # The third and fourth joints on a fine grid; the first two have a closed form then.
    fine = np.stack(np.meshgrid(np.linspace(-0.5, 1.0, 61), np.linspace(-0.3, 0.3, 25), indexing="ij")).reshape(2, -1)
    hand = 0.6 + 0.4 * np.exp(1j * fine[0]) + 0.3 * np.exp(1j * fine.sum(axis=0))
    x, y = np.meshgrid(np.linspace(-1.5, 2.4, 45), np.linspace(-1.2, 2.4, 45))
    target = (x + 1j * y).reshape(-1)
    cosine = (np.abs(target[:, None]) ** 2 - 1.0 - np.abs(hand) ** 2) / (2.0 * np.abs(hand))
    lag = np.angle(hand)
    truth = np.zeros(len(target), dtype=bool)
    with np.errstate(invalid="ignore"):
        for sign in (1.0, -1.0):
            q2 = sign * np.arccos(cosine) - lag
            q1 = np.angle(target[:, None] / (1.0 + hand * np.exp(1j * q2)))
            truth |= np.any((q2 >= 0.2) & (q2 <= 1.5) & (np.abs(q1) <= 1.0), axis=1)
    points = np.stack([target.real, target.imag, np.zeros(len(target))], axis=1)
    found = reachable(space, points)
    # All that the grid has is found; what it has not lies between its configurations, at the edge.
    assert not np.any(truth & ~found)
    assert 0.2 < truth.mean() < 0.5
    assert np.mean(found & ~truth) < 0.01


def test_values_that_are_found_reach_the_points_within_the_limits(rng):
    space = space_of(robokin.load("puma560"))
    points = rng.uniform(-1.0, 1.0, (2000, 3))
    inside, q = descent_of(space).reached(points)
    assert 0.2 < inside.mean() < 0.8
    p = motion(moving_chain(space), q[:, inside]).tool[3]
    assert np.max(np.abs(p.T - points[inside])) <= 1e-7 * space.size
    low, high = space.low[:5, None], space.high[:5, None]
    assert np.all((q[:, inside] >= low) & (q[:, inside] <= high))


def test_the_answer_for_a_point_does_not_depend_on_the_others(rng):
    space = space_of(robokin.load("panda"))
    points = rng.uniform(-0.9, 0.9, (600, 3))
    together = reachable(space, points)
    assert np.array_equal(together, np.concatenate([reachable(space, part) for part in np.array_split(points, 7)]))


def test_counts_of_the_shell(rng):
    # An anthropomorphic arm without limits: four configurations in the open shell, none outside.
    space = space_of(robokin.load("anthropomorphic"))
    p = positions(space, sampled(space, rng, 500))
    assert set(solution_count(space, p.T)) == {4}
    assert not solution_count(space, 3.0 * space.size * np.eye(3)).any()


def test_counts_of_a_planar_arm_within_limits():
    space = space_of(planar(1.0, 0.6, limits=[REST, (-1.0, 2.4)]))
    radius = np.sqrt(1.36 + 1.2 * np.cos([0.5, 1.5, 2.6]))
    points = np.stack([radius, 0.0 * radius, 0.0 * radius], axis=1)
    assert solution_count(space, points).tolist() == [2, 1, 0]


def test_a_curved_surface_s_points():
    rows = (Joint("1", JointType.REVOLUTE, a=1.0, alpha=np.pi / 2), Joint("2", JointType.REVOLUTE, a=0.3))
    space = space_of(Robot("torus", rows))
    assert reachable(space, [[1.3, 0, 0], [0, 0.7, 0], [1.0, 0, 0.3], [1.0, 0, 0], [1.31, 0, 0]]).tolist() == [
        True,
        True,
        True,
        False,
        False,
    ]


def test_an_arm_that_moves_nothing_reaches_a_point():
    space = space_of(Robot("spindle", (Joint("1", JointType.REVOLUTE, d=0.4),)))
    assert reachable(space, [[0, 0, 0.4], [0, 0, 0.5]]).tolist() == [True, False]


def test_infinitely_many_are_not_counted():
    with pytest.raises(ValueError, match="infinitely many"):
        solution_count(space_of(robokin.load("planar3r")), [[0.5, 0.5, 0.0]])


@pytest.mark.parametrize("name", ["puma560", "stanford", "planar3r"])
def test_derivatives_are_differences(name, rng):
    space = space_of(robokin.load(name))
    chain = moving_chain(space)
    q = sampled(space, rng, 20)[list(space.moving)]
    J, _, tool = motion(chain, q)
    full = np.zeros((len(space.low), 20))
    full[list(space.moving)] = q
    assert np.allclose(tool[3], positions(space, full), atol=1e-12)
    for i in range(chain.n):
        step = np.zeros_like(q)
        step[i] = 1e-6
        ahead, behind = motion(chain, q + step).tool[3], motion(chain, q - step).tool[3]
        assert np.allclose((ahead - behind) / 2e-6, J[i], atol=1e-8)
