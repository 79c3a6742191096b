"""Workspaces of robots whose joints hang on each other: fingers, forearms held against the horizontal, screws."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from workspace.coupled_arms import FREE, P, R, adds, arm, drawn_arm, follows, planar_finger, spatial_finger

import robokin
from robokin.model import Joint
from robokin.model.coupled_robot import driven
from robokin.model.graph import Coupling
from robokin.spatial import rotation_transform, translation_transform
from robokin.workspace.extremes import extent
from robokin.workspace.geared_starts import spread_to_limits
from robokin.workspace.measure import measure
from robokin.workspace.membership import counted, decided, reachable, solution_count
from robokin.workspace.place import at_point
from robokin.workspace.sampling import joint_values, moving_cuts, positions, sample_count
from robokin.workspace.space import space_of

TURN = 2.0 * np.pi


def pendant(limits=((-2.8, 2.8), (-1.0, 2.4), (-2.0, 3.4)), motion=(-1.5, 1.5)):
    """A shoulder and a forearm whose typed angle is that against the horizontal."""
    rows = [
        Joint("j1", R, d=0.4, a=0.05, alpha=-np.pi / 2, limits=limits[0]),
        Joint("j2", R, a=0.4, limits=limits[1]),
        Joint("j3", R, a=0.43, limits=limits[2], motion_limits=motion),
    ]
    return arm(rows, adds(3, 2, -1.0))


def at_limits(space, count, seed):
    """(n, count) values of which many are at limits of variables and of joints."""
    q = np.tile(0.5 * (space.low + space.high)[:, None], (1, count))
    moving = list(space.moving)
    q[moving] = spread_to_limits(moving_cuts(space), space.low[moving], space.high[moving], count, 3, seed)
    return q


@pytest.mark.parametrize("seed", [0, 1, 5, 6, 8, 9, 11, 14, 15, 18, 23, 28])
def test_what_forward_kinematics_reaches_is_a_member_and_within_the_bounds(seed):
    robot = drawn_arm(seed)
    space = space_of(robot)
    assert space.gears is not None
    count = 600
    q = joint_values(space, "sobol", seed, 0, count, count, every=True)
    p = positions(space, q)
    assert robot.within_limits(q.T).all()
    np.testing.assert_allclose(robokin.forward_kinematics(robot, q.T)[:, :3, 3], p.T, atol=1e-11 * space.size)
    edge = positions(space, at_limits(space, count, seed))
    p = np.concatenate([p, edge], axis=1)
    assert reachable(space, p.T).all()
    found, room = extent(space), 1e-9 * space.size
    assert np.all(p.min(axis=1) >= found.low - room)
    assert np.all(p.max(axis=1) <= found.high + room)
    away = np.linalg.norm(p - found.origin[:, None], axis=0)
    assert found.least - room <= away.min()
    assert away.max() <= found.greatest + room
    place = at_point(space, p[:, 0], 16)
    assert place.reachable
    assert place.proven


def test_samples_are_spread_evenly_over_what_limits_leave():
    # |q3 - q2| <= 1/2 of the unit square.
    rows = [Joint("j1", R, a=1.0, limits=(0.0, 1.0)), Joint("j2", R, a=1.0, limits=(0.0, 1.0)),
            Joint("j3", R, a=1.0, limits=(0.0, 1.0), motion_limits=(-0.5, 0.5))]  # fmt: skip
    space = space_of(arm(rows, adds(3, 2, -1.0)))
    for kind in ("sobol", "random"):
        q = joint_values(space, kind, 5, 0, 60_000, 60_000)
        assert np.all(np.abs(q[2] - q[1]) <= 0.5 + 1e-12)
        whole = 0.75
        corner = np.mean((q[1] < 0.25) & (q[2] < 0.25))
        band = np.mean(np.abs(q[2] - q[1]) < 0.25)
        assert corner == pytest.approx(0.0625 / whole, abs=0.004)
        assert band == pytest.approx((1.0 - 0.75**2) / whole, abs=0.008)
        again = joint_values(space, kind, 5, 1000, 50, 60_000)
        np.testing.assert_array_equal(again, q[:, 1000:1050])
    with pytest.raises(robokin.InputError, match="found 'grid', expected 'sobol' or 'random'"):
        sample_count(space, "grid", 100)


def ring_area(lengths, ratios, stroke, second, parts=4001, rings=4000):
    """The area of a planar finger in rings about the first axis: of each what arcs of that joint's stroke cover."""
    u = np.linspace(*second, parts)
    turned, x = u.copy(), lengths[0] + lengths[1] * np.exp(1j * u)
    for length, ratio in zip(lengths[2:], ratios, strict=True):
        turned = turned + ratio * u
        x = x + length * np.exp(1j * turned)
    radius, angle = np.abs(x), np.unwrap(np.angle(x))
    edges = np.linspace(radius.min(), radius.max(), rings + 1)
    total = 0.0
    for low, high in pairwise(edges.tolist()):
        middle = 0.5 * (low + high)
        cut = np.flatnonzero((radius[1:] > middle) != (radius[:-1] > middle))
        part = (middle - radius[cut]) / (radius[cut + 1] - radius[cut])
        starts = np.sort(np.mod(angle[cut] + part * (angle[cut + 1] - angle[cut]), TURN))
        gaps = np.diff(np.append(starts, starts[0] + TURN))
        total += middle * (high - low) * float(np.sum(np.minimum(gaps, stroke)))
    return total


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("samples", [3000, 40_000])
def test_areas_of_planar_fingers_are_those_of_their_rings(seed, samples):
    rng = np.random.default_rng((seed, 0xF17))
    lengths = rng.uniform(0.2, 1.0, 3 + seed % 2).tolist()
    ratios = rng.choice([1.0, 2.0 / 3.0, -0.5, 0.77, 2.0], len(lengths) - 2).tolist()
    low, scale = rng.uniform(-2.0, 1.0), float(rng.choice([1e-3, 1.0, 1e3]))
    second, stroke = (low, low + rng.uniform(0.5, 2.5)), TURN if seed % 4 == 0 else rng.uniform(0.5, 6.0)
    first = FREE if stroke == TURN else (0.3, 0.3 + stroke)
    robot = planar_finger(lengths, ratios, first, second, scale)
    found = robokin.analyse_workspace(robot, samples=samples, seed=seed, cores=1)
    truth = ring_area(lengths, ratios, stroke, second) * scale**2
    assert abs(found.measure.value - truth) <= found.measure.error + 2e-4 * truth
    assert found.space.quantity == "area"
    assert (found.space.axis is not None) == (stroke == TURN)


def finger_volume(parts=2001):
    """The volume of the spatial finger: how far its tip is from the second joint only the third says, and less the
    more it bends; so each place of its plane, which turns by 0.7 about z, has one configuration."""
    mcp, pip = np.meshgrid(np.linspace(-0.8, 1.6, parts), np.linspace(0.0, 1.7, parts), indexing="ij")
    x = 0.046 + 0.027 * np.exp(1j * pip) + 0.018 * np.exp(5.0 / 3.0 * 1j * pip)
    slope = 0.027j * np.exp(1j * pip) + 0.03j * np.exp(5.0 / 3.0 * 1j * pip)
    radial = np.real(np.conj(x) * slope) / np.abs(x)
    assert np.all(radial <= 0.0)
    weight = np.abs(x) * -radial * np.abs(np.real(x * np.exp(1j * mcp)))
    return 0.7 * float(np.trapezoid(np.trapezoid(weight, pip[0], axis=1), mcp[:, 0]))


@pytest.mark.parametrize("samples", [3000, 60_000])
def test_the_volume_of_a_finger_is_that_of_its_plane_turned(samples):
    found = robokin.analyse_workspace(spatial_finger(), samples=samples, cores=1)
    assert abs(found.measure.value - finger_volume()) <= found.measure.error
    assert not found.measure.exact
    assert any("not found by search" in note for note in found.notes)


def test_scale_and_place_change_nothing_else():
    base = translation_transform([1.0, -2.0, 3.0]) @ rotation_transform([0.0, 0.6, 0.8], 1.1)
    plain = robokin.analyse_workspace(spatial_finger(), samples=8192, cores=1)
    for scale in (1e-3, 1e3):
        other = robokin.analyse_workspace(spatial_finger(scale), samples=8192, cores=1)
        assert other.measure.value / scale**3 == pytest.approx(plain.measure.value, rel=1e-6)
        np.testing.assert_allclose(other.extent.high / scale, plain.extent.high, atol=1e-11)
    moved = robokin.analyse_workspace(spatial_finger(base=base), samples=8192, cores=1)
    assert abs(moved.measure.value - plain.measure.value) <= moved.measure.error + plain.measure.error
    assert moved.extent.greatest == pytest.approx(plain.extent.greatest, rel=1e-9)
    again = robokin.analyse_workspace(spatial_finger(), samples=8192, cores=2)
    assert again.measure == plain.measure


def test_limits_of_motions_alone_make_the_plain_arms_set():
    limits = [(-2.0, 2.0), (-1.0, 1.4), (-1.5, 1.5)]
    robot = pendant((limits[0], limits[1], FREE), limits[2])
    plain = driven({"name": "plain", "rows": tuple(
        Joint(row.name, R, d=row.d, a=row.a, alpha=row.alpha, limits=own)
        for row, own in zip(robot.rows, limits, strict=True))}, ())  # fmt: skip
    one, other = space_of(robot), space_of(plain)
    assert len(one.gears.cuts.h) == 2
    ours, theirs = extent(one), extent(other)
    for name in ("low", "high", "least", "greatest"):
        np.testing.assert_allclose(getattr(ours, name), getattr(theirs, name), atol=1e-9)
    assert counted(one)
    assert decided(one)
    rng = np.random.default_rng(3)
    points = rng.uniform(-1.0, 1.4, (3000, 3))
    np.testing.assert_array_equal(reachable(one, points), reachable(other, points))
    np.testing.assert_array_equal(solution_count(one, points), solution_count(other, points))
    a, _ = measure(one, ours, 60_000, 0, 1)
    b, _ = measure(other, theirs, 60_000, 0, 1)
    assert abs(a.value - b.value) <= a.error + b.error
    assert a.exact


def test_both_kinds_of_limits_count():
    space = space_of(pendant())
    # The extreme is on the edge where the forearm may not bend more.
    found = extent(space)
    grid = np.stack(np.meshgrid(*(np.linspace(a, b, 241) for a, b in ((-1.0, 2.4), (-2.0, 3.4)))), axis=-1).reshape(
        -1, 2
    )
    grid = grid[np.abs(grid[:, 1] - grid[:, 0]) <= 1.5]
    q = np.concatenate([np.zeros((len(grid), 1)), grid], axis=1)
    p = robokin.forward_kinematics(space.robot, q)[:, :3, 3]
    away = np.linalg.norm(p, axis=1)
    assert found.greatest >= away.max() - 1e-12
    assert found.greatest - away.max() < 1e-3
    assert found.least <= away.min() + 1e-12
    assert away.min() - found.least < 2e-2
    assert found.low[2] <= p[:, 2].min() + 1e-12
    assert p[:, 2].min() - found.low[2] < 1e-3
    for q in (*found.q_low, *found.q_high, found.q_least, found.q_greatest):
        assert space.robot.within_limits(q)


def test_a_straight_line_of_two_gears_is_measured_from_end_to_end():
    # Links of one length that turn against each other: 2 cos u along x, there and back in a turn.
    rows = [Joint("j1", R, a=0.5), Joint("j2", R, a=0.5)]
    robot = arm(rows, follows(2, 1, -2.0))
    found = robokin.analyse_workspace(robot, samples=1000, cores=1)
    assert (found.space.dimension, found.space.quantity) == (1, "length")
    assert found.measure.value == pytest.approx(2.0, abs=1e-8)
    assert reachable(found.space, [[0.3, 0.0, 0.0], [-1.0, 0.0, 0.0], [1.01, 0.0, 0.0], [0.3, 0.01, 0.0]]).tolist() == [
        True, True, False, False
    ]  # fmt: skip


def test_what_is_gone_over_twice_counts_once():
    robot = arm([Joint("j1", R, a=0.0), Joint("j2", R, a=0.5)], follows(2, 1, 1.0))
    found = robokin.analyse_workspace(robot, samples=1000, cores=1)  # a circle, twice in a turn
    assert abs(found.measure.value - np.pi) <= found.measure.error
    assert found.measure.error < 0.02 * np.pi
    tilted = arm([Joint("j1", R, a=1e-3), Joint("j2", R, a=0.5)], follows(2, 1, -3.0))
    found = robokin.analyse_workspace(
        tilted, samples=1000, cores=1
    )  # nearly a circle, with two turns to one of its own
    u = np.linspace(0.0, TURN, 100_001)
    truth = float(np.mean(np.abs(1e-3 - 1.0 * np.exp(-3j * u))) * TURN)
    assert abs(found.measure.value - truth) <= found.measure.error
    once = robokin.analyse_workspace(planar_finger([0.5, 0.5], [], FREE, (0.2, 0.2)), samples=1000, cores=1)
    assert once.measure.value > 0.0
    # A ratio of one half leads back after two turns: once round.
    half = arm([Joint("j1", R, a=0.0), Joint("j2", R, a=0.5)], follows(2, 1, 0.5))
    space = space_of(half)
    assert space.high[0] - space.low[0] == pytest.approx(2.0 * TURN)


def test_a_cardioid_and_a_helix_have_their_lengths():
    rows = [Joint("j1", R, a=0.5), Joint("j2", R, a=0.5)]
    found = robokin.analyse_workspace(arm(rows, follows(2, 1, 1.0)), samples=1000, cores=1)
    u = np.linspace(0.0, TURN, 100_001)
    truth = float(np.mean(np.abs(0.5 + np.exp(1j * u))) * TURN)
    assert abs(found.measure.value - truth) <= found.measure.error
    assert found.measure.error < 0.01 * truth
    rows = [
        Joint("j1", R, a=0.4, limits=(-1.0, 1.0)),
        Joint("j2", R, d=0.1, limits=(0.0, 10.0 * TURN), pitch=0.02 / TURN),
    ]
    rows.insert(1, Joint("j3", R, a=0.3, limits=(0.2, 1.5)))
    scara = robokin.analyse_workspace(arm(rows), samples=1000, cores=1)
    # A spindle's turn moves nothing: the sector of two links, times its stroke.
    area = 2.0 * 0.4 * 0.3 * (np.cos(0.2) - np.cos(1.5))
    assert scara.measure.value == pytest.approx(area * 0.2, abs=scara.measure.error)
    assert scara.measure.error < 1e-9
    assert scara.measure.exact
    screw = arm([Joint("j1", R, a=0.3, limits=(0.0, 3.0 * TURN), pitch=0.1 / TURN)])
    helix = robokin.analyse_workspace(screw, samples=1000, cores=1)
    truth = 3.0 * float(np.hypot(TURN * 0.3, 0.1))
    assert abs(helix.measure.value - truth) <= helix.measure.error
    np.testing.assert_allclose(helix.extent.high, [0.3, 0.3, 0.3], atol=1e-9)
    assert helix.structural_length == pytest.approx(0.3 + 0.3)


def test_a_curved_surface_of_two_drives_has_its_area():
    # A point that a second drive moves through the plane of the first axis, with a stroke of 0.6 about it.
    rows = [
        Joint("j1", R, a=0.4, alpha=np.pi / 2, limits=(0.0, 0.6)),
        Joint("j2", R, a=0.2, limits=(-1.0, 1.0)),
        Joint("j3", R, a=0.1),
    ]
    found = robokin.analyse_workspace(arm(rows, follows(3, 2, 0.5)), samples=20_000, cores=1)
    u = np.linspace(-1.0, 1.0, 20_001)
    x = 0.4 + 0.2 * np.exp(1j * u) + 0.1 * np.exp(1.5j * u)
    truth = 0.6 * float(np.sum(np.abs(0.5 * (x[1:] + x[:-1]).real) * np.abs(np.diff(x))))
    assert found.space.basis is None
    assert abs(found.measure.value - truth) <= found.measure.error
    assert found.measure.error < 0.02 * truth
    assert not found.measure.exact


@pytest.mark.parametrize(
    ("robot", "said"),
    [
        (lambda: arm([Joint("j1", R), Joint("j2", R, a=1.0)], follows(2, 1, np.sqrt(2.0))), "j1 turns without limits"),
        (lambda: arm([Joint("j1", R, a=1.0, pitch=0.1)]), "j1 turns without limits"),
        (lambda: arm([Joint("j1", P), Joint("j2", R, a=1.0)], follows(2, 1, 1.0)), "j1 slides without limits"),
        (lambda: pendant((FREE, FREE, FREE)), "j2 turns without limits"),
        (lambda: pendant(((-1.0, 1.0), (0.0, 0.5), (2.5, 3.0))), "no values are within the limits of all joints"),
    ],
)  # fmt: skip
def test_values_without_end_and_none_are_refused_by_name(robot, said):
    with pytest.raises(robokin.InputError, match=said):
        space_of(robot())


def test_orientations_of_a_finger_with_joints_to_spare_are_not_told():
    rows = [Joint(f"j{i}", R, a=0.1, limits=(-1.0, 1.0)) for i in range(1, 4)] + [Joint("j4", R, a=0.1)]
    robot = arm(rows, follows(4, 3, 2.0 / 3.0))
    with pytest.raises(robokin.InputError, match="dextrous: joint j4 hangs on j3"):
        robokin.analyse_workspace(robot, samples=1000, dextrous=True)
    place = at_point(space_of(robot), robokin.forward_kinematics(robot, [0.1, 0.2, 0.3])[:3, 3])
    assert place.reachable
    assert place.tried == 0


def test_orientations_of_a_pendant_arm_are_those_within_both_kinds_of_limits():
    rows = [Joint("j1", R, a=0.5, limits=(-1.0, 1.0)), Joint("j2", R, a=0.4, limits=(-1.5, 1.5)),
            Joint("j3", R, a=0.2, limits=(-2.0, 2.0), motion_limits=(-0.7, 0.7))]  # fmt: skip
    robot = arm(rows, adds(3, 2, -1.0))
    space, rng = space_of(robot), np.random.default_rng(4)
    q = joint_values(space, "random", 0, 0, 40, 40)
    for i in range(8):
        T = robokin.forward_kinematics(robot, q[:, i])
        place = at_point(space, T[:3, 3])
        angle = np.arctan2(place.rotations[:, 1, 0], place.rotations[:, 0, 0])
        assert np.min(np.abs(angle - np.arctan2(T[1, 0], T[0, 0]))) < 0.05
        for R_own, turned in zip(place.rotations[::20], angle[::20], strict=True):
            pose = T.copy()
            pose[:3, :3] = R_own
            assert len(robokin.solve_ik(robot, pose)) > 0, turned
        # And of those that are not given none is found.
        for turned in rng.uniform(-np.pi, np.pi, 6):
            pose = T @ rotation_transform([0.0, 0.0, 1.0], turned)
            mine = np.arctan2(pose[1, 0], pose[0, 0])
            if len(angle) and np.min(np.abs(angle - mine)) > 0.05:
                assert len(robokin.solve_ik(robot, pose)) == 0
    found = robokin.analyse_workspace(robot, samples=2048, dextrous=True, cores=1)
    assert found.dexterity.group == "SO(2)"
    assert 0.0 < found.dexterity.mean < 1.0


def palletizer():
    """An arm whose tool stays level, with its first joint's limits a quarter of a turn to either side."""
    rows = [
        Joint("j1", R, d=0.1, alpha=np.pi / 2, limits=(-np.pi / 2, np.pi / 2)),
        Joint("j2", R, a=0.2, limits=(np.radians(-60), np.radians(140))),
        Joint("j3", R, a=0.15, limits=(np.radians(-120), np.radians(20))),
        Joint("j4", R, a=0.06, limits=(np.radians(-100), np.radians(100))),
    ]
    return arm(rows, Coupling("j4", (("j2", -1.0), ("j3", -1.0)), 0.0, False))


def test_a_limit_at_which_nothing_changes_stops_no_descent():
    """At j1 = 90° y has no slope in j1, and steps of the other joints were cut off by its rounding."""
    found = robokin.analyse_workspace(palletizer(), samples=2000, cores=1)
    np.testing.assert_allclose([found.extent.low[1], found.extent.high[1]], [-0.41, 0.41], rtol=0, atol=1e-12)


def test_how_often_orientations_of_followers_come_is_not_guessed():
    with pytest.raises(robokin.InputError, match="dextrous: joint j4 hangs on j2"):
        robokin.analyse_workspace(palletizer(), samples=1000, dextrous=True)
