"""Self-motions: what is one, that its points reach the pose, its pieces within the limits, its nearest member."""

from __future__ import annotations

import numpy as np
import pytest
from inverse.arms import OFFSET_WRIST, SPHERICAL_WRIST
from sweeps import sweep

import robokin
from robokin.inverse.elimination.loop import chain_size
from robokin.inverse.self_motion.arcs import arcs_within
from robokin.inverse.self_motion.nearest_member import nearest_on
from robokin.inverse.self_motion.singular_solutions import classify, trace
from robokin.inverse.self_motion.solution_sets import families, on_curve
from robokin.kernel.chain import chain_of
from robokin.kernel.residual import error_and_jacobian
from robokin.model import Joint, JointType, Robot

R, P = JointType.REVOLUTE, JointType.PRISMATIC
TURN = 2 * np.pi
LIMIT = 2.0

FOUR_BAR = Robot("4R", tuple(Joint(str(i), R, a=a, limits=(-LIMIT, LIMIT)) for i, a in enumerate((0.5, 0.4, 0.3, 0.2))))
SLIDER = Robot(
    "RRPR",
    (
        Joint("1", R, a=0.5, limits=(-2.0, 2.0)),
        Joint("2", R, alpha=np.pi / 2),
        Joint("3", P, limits=(0.1, 0.9), alpha=-np.pi / 2),
        Joint("4", R, a=0.2),
    ),
)
SLIDES = Robot("PRP", (Joint("1", P, limits=(-1, 1)), Joint("2", R, limits=(-1, 2)), Joint("3", P, limits=(-0.5, 0.5))))

CURVES = [
    ("puma560", (10, 20, 30, 40, 0, 60), (4, 6)),
    ("stanford", (10, 20, 0.3, 40, 0, 20), (4, 6)),
    ("ur5e", (10, -80, 70, 20, 0, 30), (2, 3, 4, 6)),
    ("yam", (-60, 180, 60, 60, 90, 0), (2, 3, 4, 6)),
    ("big-yam", (-150, 0, 0, 90, -90, 0), (2, 3, 4, 6)),
    ("viperx300s", (120, -90, 90, 120, 30, 0), (1, 4, 5, 6)),
    ("tx2-60", (-90, 0, 180, 90, 180, 180), (4, 6)),
    ("cr5", (180, -120, 150, 0, 0, -60), (2, 3, 4, 6)),
    ("panda", (10, 20, 30, -90, 20, 60, 10), (1, 2, 3, 4, 5, 6, 7)),
    ("iiwa14", (10, 20, 30, -90, 20, 60, 10), (1, 2, 3, 5, 6, 7)),
    (FOUR_BAR, (20, 30, -40, 20), (1, 2, 3, 4)),
    (SLIDER, (20, 30, 0.4, 20), (1, 2, 3, 4)),
    ("spherical-wrist", (0, 0, 30), (1, 3)),
]
ISOLATED = [
    ("puma560", (10, 20, 30, 40, 50, 60), 0),
    ("scara", (10, 20, 0.1, 30), 0),
    ("scara", (10, 0, 0.1, 30), 1),
    ("ur5e", (10, -80, 0, 20, 50, 30), 1),
    (FOUR_BAR, (20, 0, 0, 0), 2),
    # Folds of the shoulder and of the wrist at once: four solutions merge.
    ("ur5e", (90, -180, 0, -90, 180, 0), 2),
    ("tx2-60", (-90, 0, 0, 0, 90, 90), 2),
    # Three solutions merge: contact of second order with a self-motion.
    ("xarm6", (30, -90, -90, 0, 180, -150), 1),
]


def arm(robot, values):
    """The robot, its chain and size, q [rad | m] and its pose."""
    robot = robokin.load(robot) if isinstance(robot, str) else robot
    q = np.where(robot.revolute, np.radians(values), values)
    chain = chain_of(robot)
    return robot, chain, chain_size(chain), q, robokin.forward_kinematics(robot, q)


def modulo(robot, gap):
    return np.where(robot.revolute, gap - TURN * np.round(gap / TURN), gap)


def distance_to(robot, rows, q):
    """The distance of q (n,) from the line through rows (k, n), angles modulo full turns."""
    gap = modulo(robot, q - rows)
    if len(rows) == 1:
        return np.linalg.norm(gap[0])
    chord = np.diff(rows, axis=0)
    along = np.clip(np.sum(gap[:-1] * chord, axis=1) / np.maximum(np.sum(chord**2, axis=1), 1e-30), 0, 1)
    return np.min(np.linalg.norm(gap[:-1] - along[:, None] * chord, axis=1))


def assert_reaches(robot, T, q):
    gap = robokin.forward_kinematics(robot, q) - T
    assert np.max(np.abs(gap)) < 1e-9


@pytest.mark.parametrize(("robot", "values", "joints"), CURVES)
def test_a_self_motion_is_followed_until_it_closes(robot, values, joints):
    robot, chain, size, q, T = arm(robot, values)
    local = classify(chain, T, q[None], size)
    assert (local.dimension[0], local.double[0]) == (1, False)
    curve = trace(chain, T, q, size)
    assert (curve.closed, curve.dimension, curve.joints) == (True, 1, joints)
    assert_reaches(robot, T, curve.q)
    turns = (curve.q[-1] - curve.q[0]) / TURN
    assert np.allclose(turns, np.where(robot.revolute, np.round(turns), 0.0), rtol=0, atol=1e-12)
    assert np.max(np.abs(np.diff(curve.x, axis=0))) < 0.3
    assert np.min(np.max(np.abs(curve.q - q), axis=1)) < 1e-9


@pytest.mark.parametrize(("robot", "values", "null"), ISOLATED)
def test_singular_and_yet_alone(robot, values, null):
    _, chain, size, q, T = arm(robot, values)
    local = classify(chain, T, q[None], size)
    assert (local.null[0], local.dimension[0], len(local.ways[0])) == (null, 0, 0)
    assert trace(chain, T, q, size) is None


def test_a_direction_that_nearly_closes_is_no_curve():
    """A step of 0.01 along the second zero of the tangent cone leaves an error of 1e-11, one of 0.1 of 1e-7."""
    _, chain, size, q, T = arm("hc10", (180, 0, 180, 0, -90, 180))
    local = classify(chain, T, q[None], size)
    assert (local.null[0], local.dimension[0]) == (2, 1)
    assert np.allclose(local.ways[0], [np.sqrt(0.5) * np.array([1, 0, 0, 1, 0, 0])])


def test_curves_that_nearly_cross_are_told_apart():
    """Offsets of 12 mm make of each crossing of a spherical shoulder two curves some 0.04 rad apart."""
    robot, chain, size, q, T = arm("gen3", (180, 0, -90, 90, -180, -90, 0))
    curve = trace(chain, T, q, size)
    assert curve.closed
    assert len(curve.q) < 500
    assert_reaches(robot, T, curve.q)


@pytest.mark.parametrize(("robot", "values", "joints"), sweep(CURVES, 4))
def test_every_member_has_the_same_family(robot, values, joints, rng):
    robot, chain, size, q, T = arm(robot, values)
    curve = trace(chain, T, q, size)
    seeds = curve.q[rng.integers(0, len(curve.q), 4)] + np.where(robot.revolute, TURN, 0.0) * rng.integers(
        -1, 2, robot.n
    )
    again = trace(chain, T, seeds[0], size)
    assert on_curve(curve, chain, T, again.q, size).all()
    assert on_curve(again, chain, T, curve.q, size).all()
    off = q.copy()
    off[curve.joints[0] - 1] += 1e-3
    assert not on_curve(curve, chain, T, off[None], size)[0]
    found = families(chain, T, np.concatenate([seeds, q[None]]), size)
    assert len(found.curves[0]) == 1
    assert np.all(found.of == 0)


@pytest.mark.parametrize(("robot", "values", "joints"), CURVES)
def test_arcs_are_what_is_within_the_limits(robot, values, joints, rng):
    robot, chain, size, q, T = arm(robot, values)
    curve = trace(chain, T, q, size)
    arcs = arcs_within(curve, chain, T, robot.limits, size)
    low, high = robot.limits.T
    for arc in arcs:
        assert_reaches(robot, T, arc.q)
        assert robot.within_limits(arc.q).all()
        if arc.whole:
            assert np.max(np.abs(modulo(robot, arc.q[-1] - arc.q[0]))) < 1e-9
        else:
            for end in (arc.q[0], arc.q[-1]):
                assert np.min(np.minimum(np.abs(end - low), np.abs(high - end))) < 1e-9
    # A dense line through the curve: each of its points within the limits is on an arc, and no other is.
    for a, b in zip(curve.q[:-1], curve.q[1:], strict=True):
        point = a + (b - a) * rng.random()
        margin = np.min(np.where(robot.revolute & np.isinf(high - low), np.inf, np.minimum(*_margins(robot, point))))
        distance = min((distance_to(robot, arc.q, point) for arc in arcs), default=np.inf)
        if margin > 0.01:
            assert distance < 0.01
        if margin < -0.01:
            assert distance > 0.005
    if np.min(np.minimum(*_margins(robot, q))) >= -1e-9:
        assert min(distance_to(robot, arc.q, q) for arc in arcs) < 0.01


def _margins(robot, q):
    """Above the least and below the greatest value of each joint, angles turned to the middle of their limits."""
    low, high = robot.limits.T
    middle = np.where(np.isfinite(high - low), 0.5 * (np.where(np.isfinite(low), low, 0) + high), 0.0)
    middle = np.where(np.isfinite(middle), middle, 0.0)
    q = np.where(robot.revolute, middle + modulo(robot, q - middle), q)
    return q - low, high - q


def test_limits_touched_in_one_configuration():
    robot, chain, size, q, T = arm("big-yam", (-150, 0, 0, 90, -90, 0))
    (arc,) = arcs_within(trace(chain, T, q, size), chain, T, robot.limits, size)
    assert np.allclose(arc.q, q[None], rtol=0, atol=1e-9)
    # The same from other members: the touch is then between two of the curve's points.
    points = trace(chain, T, q, size).q
    for i in range(0, 60, 6):
        other = trace(chain, T, points[i] + 0.4 * (points[i + 1] - points[i]), size)
        (arc,) = arcs_within(other, chain, T, robot.limits, size)
        assert np.allclose(arc.q, q[None], rtol=0, atol=2e-9)
        found = nearest_on(other, chain, T, q + 0.2, robot.limits, size)
        assert np.allclose(found, q, rtol=0, atol=2e-9)


@pytest.mark.parametrize("gap", [1e-3, 1e-5, 1e-7])
@pytest.mark.parametrize("inside", [True, False])
def test_a_narrow_arc_and_a_narrow_break(gap, inside):
    """Limits at `gap` from the greatest value of a joint leave, or cut, some 2 √gap of the curve around it."""
    _, chain, size, q, T = arm(FOUR_BAR, (20, 30, -40, 20))
    curve = trace(chain, T, q, size)
    fine = np.concatenate([curve.q[:-1] + np.diff(curve.q, axis=0) * f for f in np.linspace(0, 1, 20)[:-1]])
    e, J = error_and_jacobian(chain, np.broadcast_to(T, (len(fine), 4, 4)), fine, size)
    fine += np.einsum("snc,sc->sn", np.linalg.pinv(J, rcond=1e-3), e)
    top = np.max(fine[:, 1])
    limits = np.tile([-np.inf, np.inf], (4, 1))
    limits[1] = (top - gap, 3.0) if inside else (-3.0, top - gap)
    arcs = arcs_within(curve, chain, T, limits, size)
    assert len(arcs) == 1
    assert not arcs[0].whole
    assert np.allclose(arcs[0].q[[0, -1], 1], top - gap, rtol=0, atol=1e-9)


def test_limits_wider_than_a_turn_and_just_a_turn():
    robot, chain, size, q, T = arm("puma560", (10, 20, 30, 40, 0, 60))
    curve = trace(chain, T, q, size)
    wide = np.tile([-1.5 * TURN, 1.5 * TURN], (6, 1))
    (arc,) = arcs_within(curve, chain, T, wide, size)
    assert arc.whole
    # q4 + q6 = 100°: q4 from -80° to 180° and, one turn on, from -180° to -80°.
    arcs = arcs_within(curve, chain, T, wide / 3.0, size)
    ends = sorted(sorted(np.degrees(arc.q[[0, -1], 3])) for arc in arcs)
    assert np.allclose(ends, [[-180, -80], [-80, 180]])
    assert not any(arc.whole for arc in arcs)
    # One joint of the two unlimited.
    limits = robot.limits.copy()
    limits[5] = -np.inf, np.inf
    (arc,) = arcs_within(curve, chain, T, limits, size)
    assert np.allclose(sorted(np.degrees(arc.q[[0, -1], 3])), [-110, 170])


def test_no_arc_where_a_joint_that_stands_still_is_outside():
    robot, chain, size, q, T = arm("tx2-60", (-90, 0, 180, 90, 180, 180))
    curve = trace(chain, T, q, size)
    assert arcs_within(curve, chain, T, robot.limits, size) == ()
    assert nearest_on(curve, chain, T, q, robot.limits, size) is None


@pytest.mark.parametrize(("robot", "values", "joints"), sweep(CURVES, 4))
def test_the_nearest_member_is_the_nearest(robot, values, joints, rng):
    robot, chain, size, q, T = arm(robot, values)
    curve = trace(chain, T, q, size)
    scale = np.where(robot.revolute, 1.0, size)
    free = np.tile([-np.inf, np.inf], (robot.n, 1))
    dense = np.concatenate([curve.q[:-1] + np.diff(curve.q, axis=0) * f for f in (0.0, 0.25, 0.5, 0.75)])
    for limits in (robot.limits, free):
        fits = np.all(np.minimum(*_margins(robot, q)) >= -1e-9) or limits is free
        if fits:
            assert np.max(np.abs(nearest_on(curve, chain, T, q, limits, size) - q)) < 1e-9
        for _ in range(2):
            near = q + scale * rng.uniform(-1.5, 1.5, robot.n)
            found = nearest_on(curve, chain, T, near, limits, size)
            if found is None:
                assert limits is not free
                continue
            assert_reaches(robot, T, found)
            assert np.all((found >= limits[:, 0] - 1e-9) & (found <= limits[:, 1] + 1e-9))
            if limits is free:
                move = np.max(np.abs(modulo(robot, found - near)) / scale)
                others = np.max(np.abs(modulo(robot, dense - near)) / scale, axis=1)
                # Chords leave the curve by up to 0.003.
                assert move <= np.min(others) + 4e-3
                assert move >= np.min(others) - 0.06


def test_a_wish_full_turns_away_is_met_where_limits_allow(rng):
    robot, chain, size, q, T = arm("ur5e", (10, -80, 70, 20, 0, 30))
    curve = trace(chain, T, q, size)
    wish = q + TURN * np.array([0, 0, 0, 0, 1, -1])
    assert np.allclose(nearest_on(curve, chain, T, wish, robot.limits, size), wish, rtol=0, atol=1e-9)


def test_members_of_one_family_are_one():
    robot, chain, size, _, T = arm("tx2-60", (-90, 0, 180, 90, 180, 180))
    seeds = np.radians([(-90, 0, 180, a, 180, b) for a, b in ((90, 180), (0, 90), (45, 135))])
    assert np.allclose(robokin.forward_kinematics(robot, seeds), T, rtol=0, atol=1e-12)
    found = families(chain, T, seeds, size)
    assert len(found.curves[0]) == 1
    assert found.of.tolist() == [0, 0, 0]


def test_families_of_several_targets_at_once(rng):
    robot, chain, size, _, _ = arm("puma560", np.zeros(6))
    low, high = robot.limits.T
    q = rng.uniform(low, high, (12, 6))
    q[::2, 4] = 0.0
    T = robokin.forward_kinematics(robot, q)
    seeds = np.repeat(q, 2, axis=0)
    seeds[1::2, 3] += 0.7
    seeds[1::2, 5] -= 0.7
    index = np.repeat(np.arange(12), 2)
    keep = np.arange(24) % 4 != 3  # the second of a regular pair does not reach its pose
    found = families(chain, T, seeds[keep], size, index[keep])
    assert [len(curves) for curves in found.curves] == [1, 0] * 6
    assert np.array_equal(found.of, np.where(index[keep] % 2, -1, 0))


def test_where_curves_cross_each_is_followed():
    """A four-bar folded onto one line: two ways on, which meet again, so that each direction is on a curve."""
    robot, chain, size, q, T = arm(FOUR_BAR, (20, 180, 0, 180))
    local = classify(chain, T, q[None], size)
    assert (local.null[0], local.dimension[0], len(local.ways[0])) == (2, 1, 2)
    found = families(chain, T, q[None], size)
    for way in local.ways[0]:
        curve = trace(chain, T, q, size, way)
        assert_reaches(robot, T, curve.q)
        assert any(on_curve(other, chain, T, curve.q, size).all() for other in found.curves[0])


def test_sliding_joints_with_one_axis_trade_between_their_limits():
    robot, chain, size, q, T = arm(SLIDES, (0.3, 20, 0.4))
    curve = trace(chain, T, q, size)
    assert (curve.closed, curve.ended, curve.joints) == (False, "bound", (1, 3))
    (arc,) = arcs_within(curve, chain, T, robot.limits, size)
    assert np.allclose(sorted(arc.q[[0, -1], 0]), [0.2, 1.0], rtol=0, atol=1e-9)
    assert np.allclose(
        nearest_on(curve, chain, T, [0.0, 0.0, 0.0], robot.limits, size)[[0, 2]], [0.35, 0.35], atol=1e-6
    )


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("anthropomorphic-wrist", (90, -90, 90, 180, -180, -90)),  # axes 1, 4 and 6 are one
        ("iiwa14", (0, 0, 150, 90, -30, 0, 150)),  # axes 1 and 3 are one, and so are 5 and 7
    ],
)
def test_a_surface(name, values, rng):
    robot, chain, size, q, T = arm(name, values)
    assert classify(chain, T, q[None], size).dimension[0] == 2
    curve = trace(chain, T, q, size)
    assert curve.dimension == 2
    assert len(curve.sheets) == 2
    for sheet in curve.sheets:
        assert_reaches(robot, T, sheet.q)
    member = nearest_on(curve, chain, T, q + 0.1, robot.limits, size)
    assert_reaches(robot, T, member)
    assert robot.within_limits(member)
    assert on_curve(curve, chain, T, member[None], size)[0]


@pytest.mark.parametrize("name", ["ur5e", "viperx300s", "cr5"])
def test_round_configurations_lie_on_their_own_arcs(name, rng):
    """Joints at multiples of 30° within the limits: what is singular there and no fold is on an arc, exactly."""
    robot = robokin.load(name)
    chain, step = chain_of(robot), np.pi / 6
    size = chain_size(chain)
    low, high = robot.limits.T
    q = step * np.stack(
        [
            rng.integers(np.ceil(a / step - 1e-9), np.floor(b / step + 1e-9) + 1, 400)
            for a, b in zip(np.maximum(low, -np.pi), np.minimum(high, np.pi), strict=True)
        ],
        axis=1,
    )
    T = robokin.forward_kinematics(robot, q)
    local = classify(chain, T, q, size)
    rows = np.flatnonzero(local.dimension == 1)[:6]
    assert len(rows)
    for i, curves in zip(rows, families(chain, T[rows], q[rows], size, np.arange(len(rows))).curves, strict=True):
        assert all(curve.closed for curve in curves)
        arcs = [arc for curve in curves for arc in arcs_within(curve, chain, T[i], robot.limits, size)]
        assert min(distance_to(robot, arc.q, q[i]) for arc in arcs) < 0.01
        assert any(
            np.max(np.abs(nearest_on(curve, chain, T[i], q[i], robot.limits, size) - q[i])) < 1e-9 for curve in curves
        )


def test_a_self_motion_is_found_from_where_it_crosses_another_one():
    # A wrist that is folded back turns on itself; where its middle axis meets the elbow's fold two null vectors are.
    robot = SPHERICAL_WRIST
    q = np.radians([-90.0, 90.0, 180.0, 90.0, 180.0, 180.0])
    result = robokin.solve_ik(robot, robokin.forward_kinematics(robot, q))
    assert result.complete
    (family,) = result.families
    assert family.joints == (4, 6)


def test_two_limits_that_are_met_at_once_leave_one_configuration_of_a_self_motion():
    # Joint 2 comes back into its limits where joint 3 leaves its own.
    robot = OFFSET_WRIST
    q = np.radians([-90.0, 180.0, 180.0, 0.0, -90.0, 0.0])
    result = robokin.solve_ik(robot, robokin.forward_kinematics(robot, q))
    (family,) = result.families
    points = [arc.q[0] for arc in family.arcs if len(arc.q) == 1]
    assert any(np.max(np.abs(point - q)) < 1e-9 for point in points)
    near = robokin.solve_ik(robot, robokin.forward_kinematics(robot, q), near=q)
    np.testing.assert_allclose(near.solutions[0].q, q, atol=1e-9)
