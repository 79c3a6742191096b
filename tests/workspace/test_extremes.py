"""Bounds and reach are those of closed forms, no sample goes beyond, and moving or scaling the arm does as it must."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sweeps import sweep

import robokin
from robokin.errors import InputError
from robokin.kinematics.forward import forward_kinematics
from robokin.model import Joint, JointType, Robot
from robokin.spatial import rotation_transform, translation_transform
from robokin.workspace.extremes import _polish, _scaled, _sweep, extent
from robokin.workspace.goals import Goals, derivatives
from robokin.workspace.sampling import joint_values, positions
from robokin.workspace.space import space_of

EXACT = 1e-9
"""Errors allowed, as a part of the arm's size."""

LIBRARY = ["puma560", "planar3r", "scara", "stanford", "thumb", "panda", "ur5e", "cylindrical", "kr5-arc", "iiwa7"]


def revolute(name, limits=(-np.inf, np.inf), **cells):
    return Joint(name, JointType.REVOLUTE, limits=limits, **cells)


def slide(name, limits, **cells):
    return Joint(name, JointType.PRISMATIC, limits=limits, **cells)


def planar(*lengths, limits=None):
    limits = limits or [(-np.inf, np.inf)] * len(lengths)
    return Robot("planar", tuple(revolute(str(i), limits[i], a=a) for i, a in enumerate(lengths)))


@pytest.mark.parametrize(
    "lengths", [(1, 0.6), (1, 1), (0.6, 1), (1, 0.6, 0.35), (2, 0.5, 0.3), (0.3, 0.2, 1.5, 0.1), (1, 1, 1, 1)]
)
def test_a_planar_arm_reaches_its_annulus(lengths):
    found = extent(space_of(planar(*lengths)))
    total, inner = sum(lengths), max(0, 2 * max(lengths) - sum(lengths))
    assert found.greatest == pytest.approx(total, abs=EXACT * total)
    assert found.least == pytest.approx(inner, abs=EXACT * total)
    assert np.allclose(found.high, [total, total, 0], rtol=0, atol=EXACT * total)
    assert np.allclose(found.low, [-total, -total, 0], rtol=0, atol=EXACT * total)


def test_limits_cut_a_planar_arm():
    # Joint 1 within ±30°, joint 2 between 60° and 120°: the least reach is folded farthest.
    l1, l2 = 1.0, 0.6
    found = extent(space_of(planar(l1, l2, limits=[(-np.pi / 6, np.pi / 6), (np.pi / 3, 2 * np.pi / 3)])))
    near, far = (np.sqrt(l1**2 + l2**2 + 2 * l1 * l2 * np.cos(t)) for t in (2 * np.pi / 3, np.pi / 3))
    assert found.least == pytest.approx(near, abs=EXACT)
    assert found.greatest == pytest.approx(far, abs=EXACT)
    # The greatest x lies on the x axis; the other bounds at limits of both joints.
    assert found.high[0] == pytest.approx(far, abs=EXACT)
    assert found.high[1] == pytest.approx(l1 * 0.5 + l2, abs=EXACT)
    assert found.low[1] == pytest.approx(-l1 * 0.5 + l2 * 0.5, abs=EXACT)
    assert found.low[0] == pytest.approx(l1 * np.cos(np.pi / 6) - l2 * np.cos(np.pi / 6), abs=EXACT)


def wrist_centre(limits=True):
    """The PUMA 560 up to its wrist's centre."""
    robot = robokin.load("puma560")
    rows = [
        replace(row, d=0.0) if i == 5 else row if limits else replace(row, limits=(-np.inf, np.inf))
        for i, row in enumerate(robot.rows)
    ]
    return replace(robot, rows=tuple(rows), tool=np.eye(4), base=np.eye(4), poses={})


def test_the_puma_s_wrist_centre_reaches_its_sphere():
    # A lateral offset of 149.09 mm, an upper arm of 431.8, a forearm of √(20.32² + 433.07²).
    arm = 0.4318 + np.hypot(0.02032, 0.43307)
    free = extent(space_of(wrist_centre(limits=False)))
    assert free.greatest == pytest.approx(np.hypot(arm, 0.14909), abs=EXACT)
    assert free.greatest == pytest.approx(0.878096, abs=5e-7)
    assert free.least == pytest.approx(np.hypot(0.4318 - np.hypot(0.02032, 0.43307), 0.14909), abs=EXACT)
    assert np.allclose(free.high[:2], free.greatest, rtol=0, atol=EXACT)
    assert free.high[2] == pytest.approx(arm, abs=EXACT)
    assert free.low[2] == pytest.approx(-arm, abs=EXACT)


def test_the_puma_s_limits_cut_its_wrist_centre_s_bounds():
    # Compared with a sampled box, good to some millimetres.
    found = extent(space_of(wrist_centre()))
    assert np.allclose(found.low, [-0.877, -0.878, -0.739], rtol=0, atol=0.005)
    assert np.allclose(found.high, [0.876, 0.877, 0.865], rtol=0, atol=0.005)


def test_a_cartesian_arm_fills_its_box():
    quarter = np.pi / 2
    robot = Robot(
        "box",
        (
            slide("1", (0.1, 0.6), alpha=-quarter, theta=-quarter),
            slide("2", (-0.2, 0.3), alpha=-quarter, theta=-quarter),
            slide("3", (0.0, 0.4)),
        ),
    )
    found = extent(space_of(robot))
    corners = [(a, b, c) for a in (0.1, 0.6) for b in (-0.2, 0.3) for c in (0.0, 0.4)]
    p = forward_kinematics(robot, np.array(corners))[:, :3, 3]
    assert np.allclose(found.low, p.min(axis=0), rtol=0, atol=EXACT)
    assert np.allclose(found.high, p.max(axis=0), rtol=0, atol=EXACT)
    assert found.least == pytest.approx(0.1, abs=EXACT)  # straight above the base, not at a corner
    assert found.greatest == pytest.approx(np.linalg.norm([0.6, 0.3, 0.4]), abs=EXACT)


def test_a_polar_arm_reaches_from_stroke_to_stroke():
    robot = Robot("polar", (revolute("1", alpha=-np.pi / 2), slide("2", (0.3, 0.9))))
    found = extent(space_of(robot))
    assert (found.least, found.greatest) == pytest.approx((0.3, 0.9), abs=EXACT)
    assert np.allclose(found.high, [0.9, 0.9, 0], rtol=0, atol=EXACT)


def test_reach_is_counted_from_the_base_wherever_that_is(rng):
    robot = planar(1, 0.6, 0.2)
    base = translation_transform([3.0, -2.0, 1.0]) @ rotation_transform([1.0, 2.0, 3.0], 0.7)
    moved = extent(space_of(replace(robot, base=base)))
    assert (moved.least, moved.greatest) == pytest.approx((0.2, 1.8), abs=EXACT * 4)
    assert np.array_equal(moved.origin, base[:3, 3])
    half = 1.8 * np.sqrt(1 - base[:3, 2] ** 2)  # a disc's bounds, tilted
    assert np.allclose(moved.high, base[:3, 3] + half, rtol=0, atol=EXACT * 4)
    assert np.allclose(moved.low, base[:3, 3] - half, rtol=0, atol=EXACT * 4)


@pytest.mark.parametrize("name", sweep(LIBRARY, 4))
def test_no_sample_goes_beyond(name):
    space = space_of(robokin.load(name))
    found = extent(space)
    tolerance = EXACT * space.size
    for start in range(0, 1_000_000, 100_000):
        p = positions(space, joint_values(space, "random", 99, start, 100_000, 1_000_000))
        assert np.all(p.min(axis=1) >= found.low - tolerance)
        assert np.all(p.max(axis=1) <= found.high + tolerance)
        r = np.linalg.norm(p - found.origin[:, None], axis=0)
        assert r.min() >= found.least - tolerance
        assert r.max() <= found.greatest + tolerance


@pytest.mark.parametrize("seed", range(4))
def test_no_sample_of_a_random_arm_goes_beyond(seed):
    rng = np.random.default_rng(seed)
    rows = []
    for i in range(5):
        cells = {"a": rng.uniform(-0.5, 0.5), "alpha": rng.uniform(-3, 3)}
        low = rng.uniform(-3, 0)
        if rng.random() < 0.25:
            rows.append(slide(str(i), (0.2 * low, 0.2 * low + rng.uniform(0.1, 0.6)), theta=1.0, **cells))
        else:
            rows.append(revolute(str(i), (low, low + rng.uniform(0.5, 7)), d=rng.uniform(-0.3, 0.3), **cells))
    space = space_of(Robot("random", tuple(rows), tool=translation_transform([0.1, 0.2, 0.1])))
    found = extent(space)
    p = positions(space, joint_values(space, "random", 1, 0, 100_000, 100_000))
    tolerance = EXACT * space.size
    assert np.all(p.min(axis=1) >= found.low - tolerance)
    assert np.all(p.max(axis=1) <= found.high + tolerance)
    r = np.linalg.norm(p - found.origin[:, None], axis=0)
    assert r.min() >= found.least - tolerance
    assert r.max() <= found.greatest + tolerance
    # Another seed's starts lead to the same places.
    other = extent(space, seed=17)
    assert np.allclose(other.low, found.low, rtol=0, atol=tolerance)
    assert np.allclose(other.high, found.high, rtol=0, atol=tolerance)
    assert (other.least, other.greatest) == pytest.approx((found.least, found.greatest), abs=tolerance)


@pytest.mark.parametrize("name", ["puma560", "scara", "panda"])
def test_the_joint_values_lead_there_and_are_within_the_limits(name):
    robot = robokin.load(name)
    space = space_of(robot)
    found = extent(space)
    for i in range(3):
        for q, value in ((found.q_low[i], found.low[i]), (found.q_high[i], found.high[i])):
            assert robot.within_limits(q)
            assert forward_kinematics(robot, q)[i, 3] == pytest.approx(value, abs=EXACT)
    for q, value in ((found.q_least, found.least), (found.q_greatest, found.greatest)):
        assert np.all((q >= space.low) & (q <= space.high))
        assert np.linalg.norm(forward_kinematics(robot, q)[:3, 3] - found.origin) == pytest.approx(value, abs=EXACT)


def test_scaling_the_arm_scales_its_extent():
    robot = robokin.load("puma560")
    k = 1000.0
    scaled = replace(
        robot, rows=tuple(replace(row, a=k * row.a, d=k * row.d) for row in robot.rows), base=np.eye(4), tool=np.eye(4)
    )
    small, large = (extent(space_of(arm)) for arm in (replace(robot, base=np.eye(4), tool=np.eye(4)), scaled))
    assert np.allclose(large.low, k * small.low, rtol=1e-9)
    assert np.allclose(large.high, k * small.high, rtol=1e-9)
    assert (large.least, large.greatest) == pytest.approx((k * small.least, k * small.greatest), rel=1e-9)


def test_the_answer_is_the_same_every_time():
    space = space_of(robokin.load("stanford"))
    one, two = extent(space, seed=3), extent(space_of(robokin.load("stanford")), seed=3)
    for name in ("low", "high", "q_low", "q_high", "q_least", "q_greatest"):
        assert np.array_equal(getattr(one, name), getattr(two, name))
    assert (one.least, one.greatest) == (two.least, two.greatest)


def test_a_wrist_that_moves_nothing_stays_where_it_is():
    found = extent(space_of(robokin.load("spherical-wrist", d6=0)))
    assert np.array_equal(found.low, found.high)
    assert found.least == found.greatest


def test_a_slide_without_limits_is_named():
    robot = Robot("endless", (revolute("1"), slide("2", (-np.inf, np.inf))))
    with pytest.raises(InputError, match="joint 2 slides without limits"):
        space_of(robot)


@pytest.mark.parametrize("name", ["puma560", "stanford"])
def test_gradients_and_hessians_are_finite_differences(name, rng):
    box = _scaled(space_of(robokin.load(name)))
    m, n, step = 6, box.chain.n, 1e-5
    goals = Goals(rng.normal(size=(m, 3)), rng.normal(size=m), rng.normal(size=3))
    q = rng.uniform(-1, 1, (m, n))
    _, gradient, H = derivatives(box.chain, goals, q)
    for i in range(n):
        ahead, behind = (derivatives(box.chain, goals, q + sign * step * np.eye(n)[i]) for sign in (1, -1))
        slope = (goals.values(ahead[0]) - goals.values(behind[0])) / (2 * step)
        assert np.allclose(gradient[:, i], slope, rtol=0, atol=1e-8)
        assert np.allclose(H[:, i], (ahead[1] - behind[1]) / (2 * step), rtol=0, atol=1e-8)


def test_a_corner_of_the_joint_limits_is_not_missed():
    robot = Robot(
        "corner",
        (
            slide("1", (0.0, 1.08), alpha=-np.pi / 2),
            revolute("2", (-4.26, 0.229), a=0.243),
            revolute("3", (-4.387, -1.172), a=0.654),
        ),
    )
    # At both upper limits: 0.243 cos 0.229 + 0.654 cos(0.229 - 1.172).
    corner = 0.243 * np.cos(0.229) + 0.654 * np.cos(0.229 - 1.172)
    for seed in range(3):
        assert extent(space_of(robot), seed).high[0] == pytest.approx(corner, abs=EXACT)


def any_arm(number):
    """Two to six joints with any limits, many of their lengths and angles round."""
    rng = np.random.default_rng([31, number])
    scale, rows = 10.0 ** rng.integers(-3, 4), []
    for i in range(rng.integers(2, 7)):
        cells = {"a": scale * rng.choice([0.0, rng.uniform(0.05, 1.0)])}
        cells["alpha"] = rng.choice([0.0, np.pi / 2, -np.pi / 2, rng.uniform(-3, 3)])
        low = rng.uniform(-4.0, 2.0)
        if rng.random() < 0.25:
            limits = (scale * low, scale * (low + rng.uniform(0.02, 1.5)))
            rows.append(slide(str(i), limits, theta=rng.uniform(-3, 3), **cells))
        else:
            rows.append(
                revolute(str(i), (low, low + rng.uniform(0.05, 6.5)), d=scale * rng.uniform(-0.5, 0.5), **cells)
            )
    return Robot("any", tuple(rows), tool=translation_transform(scale * rng.uniform(-0.5, 0.5, 3)))


@pytest.mark.parametrize("number", sweep(range(12), 4))
def test_a_dense_search_finds_nothing_beyond(number):
    """Coordinate descent and Newton's method from 300 configurations, many of them at limits, for each question."""
    space = space_of(any_arm(number))
    box, moving, each = _scaled(space), list(space.moving), 300
    rng = np.random.default_rng(number)
    part = rng.choice([0.0, 1.0, -1.0, -1.0], (8 * each, len(moving)))
    q = box.low + (box.high - box.low) * np.where(part < 0.0, rng.random(part.shape), part)
    g = np.concatenate([np.eye(3), -np.eye(3), np.zeros((2, 3))])
    w, origin = np.array([0.0] * 6 + [1.0, -1.0]), space.robot.base[:3, 3] / space.size
    goals = Goals(np.repeat(g, each, axis=0), np.repeat(w, each), origin)
    for _ in range(12):
        f = _sweep(box, goals, q)
    order = np.argsort(f.reshape(8, each), axis=1)[:, :24]
    chosen = (order + each * np.arange(8)[:, None]).ravel()
    f = _polish(box, goals.taken(chosen), q[chosen])[1].reshape(8, 24).min(axis=1)
    found = extent(space)
    assert np.all(found.low / space.size <= f[:3] + EXACT)
    assert np.all(-found.high / space.size <= f[3:6] + EXACT)
    assert found.least / space.size <= np.sqrt(2.0 * max(f[6], 0.0)) + EXACT
    assert -found.greatest / space.size <= -np.sqrt(-2.0 * f[7]) + EXACT
