"""Arms with a spherical shoulder and wrist: self-motions as intervals of the swivel angle, none missed or made up."""

from __future__ import annotations

import numpy as np
import pytest
from inverse import arms
from sweeps import sweep

import robokin
from robokin.inverse.analysis import analysis_of
from robokin.inverse.self_motion.arcs import arcs_of_each
from robokin.inverse.self_motion.solution_sets import families
from robokin.inverse.self_motion.swivel_arm import swivel_arm
from robokin.inverse.self_motion.swivel_curves import TURN, swivel_curves
from robokin.inverse.self_motion.swivel_pieces import swivel_pieces
from robokin.kernel.chain import chain_of, chain_size

SWIVELS = [
    "iiwa14",
    "iiwa7",
    "rm75",
    "sia20d",
    "xmate-pro7",
    "r1pro-left",
    "r1pro-right",
    "openarm-left",
    "openarm-right",
]
"""The library's arms with a swivel angle."""

OTHERS = ["panda", "fr3", "gen3", "gen72", "rizon4", "kassow-kr810", "puma560", "human-arm"]


def within(robot, rng, count, kind):
    """Configurations (count, 7) within the limits: anywhere, some joints at limits, all, or multiples of 45°."""
    low, high = np.where(np.isinf(robot.limits), [-np.pi, np.pi], robot.limits).T
    q = rng.uniform(low, high, (count, 7))
    if kind == "round":
        grid = np.round(q / (np.pi / 4)) * (np.pi / 4)
        return np.where((grid < low) | (grid > high), q, grid)
    share = {"anywhere": 0.0, "some at limits": 0.4, "all at limits": 1.0}[kind]
    return np.where(rng.random(q.shape) < share, np.where(rng.random(q.shape) < 0.5, low, high), q)


def random_arm(rng):
    """A random arm with a swivel angle: any elbow and tool; one joint without limits or with ±180°."""

    def some():
        return float(rng.choice([0.0, rng.uniform(-0.5, 0.5)]))

    def right():
        return float(rng.choice([-90, 90]))

    def twist():
        return float(rng.choice([90.0, -90.0, rng.uniform(-180.0, 180.0)]))

    upper, fore = float(rng.uniform(0.2, 0.6)), float(rng.uniform(0.2, 0.6))
    rows = [(some(), 0, right()), (0, 0, right()), (upper, some(), twist()), (some(), some(), twist())]
    rows += [(fore, 0, right()), (0, 0, right()), (some(), some(), twist())]
    middle, half = rng.uniform(-1.0, 1.0, 7), rng.uniform(0.5, 3.0, 7)
    limits = np.stack([middle - half, middle + half], axis=1)
    limits[rng.integers(7)] = rng.choice([np.inf, np.pi]) * np.array([-1.0, 1.0])
    return arms.with_limits(arms.table(rows), limits)


def covered(curves, pieces, row, q):
    """(s,) whether configurations q (s, 7) of poses (s,) are on pieces, ends included but for 1e-6."""
    on = np.zeros(len(row), dtype=bool)
    for piece in range(len(pieces.row)):
        mine = np.flatnonzero((row == pieces.row[piece]) & ~on)
        signs = np.tile(pieces.signs[piece], (len(mine), 1))
        psi = curves.swivel(row[mine], signs[:, 0], q[mine])
        away = curves.configurations(row[mine], signs, psi) - q[mine]
        same = np.max(np.abs(away - TURN * np.round(away / TURN)), axis=1) < 1e-5
        along = (psi - pieces.first[piece] + 1e-6) % TURN
        on[mine[same & (along <= pieces.last[piece] - pieces.first[piece] + 2e-6)]] = True
    return on


def check(robot, q, values):
    """What holding joints at values gives, and q itself, is on the pieces; the pieces are within the limits and end
    where a joint meets one. Returns how many poses are known."""
    T = robokin.forward_kinematics(robot, q)
    curves = swivel_curves(swivel_arm(chain_of(robot)), T)
    pieces = swivel_pieces(curves, robot.limits)
    row, found = [np.arange(len(q))], [q]
    for joint, value in values:
        held = robokin.solve_ik(robot, T, hold={joint: value})
        i, k = np.nonzero(~np.isnan(held.q[:, :, 0]))
        row.append(i)
        found.append(held.q[i, k])
    row, found = np.concatenate(row), np.concatenate(found)
    known = ~pieces.doubt
    row, found = row[known[row]], found[known[row]]
    assert covered(curves, pieces, row, found).all()
    pieces = pieces.of(known)
    low, high = robot.limits.T
    middle = np.where(np.isfinite(low), 0.5 * (low + np.where(np.isfinite(low), high, 0.0)), 0.0)
    for part in (0.0, 1e-3, 0.3, 0.8, 1.0):
        at = pieces.first + part * (pieces.last - pieces.first)
        x = curves.configurations(pieces.row, pieces.signs, at)
        x = middle + (x - middle) - TURN * np.round((x - middle) / TURN)
        assert np.max(np.abs(robokin.forward_kinematics(robot, x) - T[pieces.row]), initial=0.0) < 1e-9
        margin = np.min(np.minimum(x - low, high - x), axis=1)
        assert np.all(margin >= -1e-9)
        assert part not in (0.0, 1.0) or np.all(pieces.whole | (np.abs(margin) <= 1e-9))
    return int(known.sum())


@pytest.mark.parametrize("kind", ["anywhere", "some at limits", "all at limits", "round"])
@pytest.mark.parametrize("name", sweep(SWIVELS, 3))
def test_no_piece_is_missed_and_none_invented(name, kind, rng):
    robot = robokin.load(name)
    values = [(joint, float(rng.uniform(*robot.limits[joint]))) for joint in (0, 2, 4)]
    known = check(robot, within(robot, rng, 20, kind), values)
    # Of poses at limits and round ones most have a joint that keeps to a limit, or come by something straight.
    assert kind != "anywhere" or known >= 18


@pytest.mark.parametrize("k", sweep(range(12), 2))
def test_no_piece_of_any_such_arm(k, rng):
    robot = random_arm(rng)
    assert swivel_arm(chain_of(robot)) is not None
    check(robot, within(robot, rng, 20, "anywhere"), [(2, 0.3), (0, -0.2)])
    check(robot, within(robot, rng, 20, "some at limits"), [])


@pytest.mark.parametrize("name", OTHERS)
def test_other_arms_are_not_taken_for_one(name):
    robot = robokin.load(name)
    assert swivel_arm(chain_of(robot)) is None
    with pytest.raises(robokin.InputError, match="has no swivel angle, expected seven turning joints"):
        robokin.swivel_angle(robot, np.zeros(7))


@pytest.mark.parametrize("name", sweep(["iiwa14", "r1pro-left", "rm75"], 2))
def test_the_same_curves_are_followed(name, rng):
    """Following from one configuration gives the pieces of its own curve, with the same ends."""
    robot = robokin.load(name)
    q = within(robot, rng, 3, "anywhere")
    for one, T in zip(q, robokin.forward_kinematics(robot, q), strict=True):
        result = robokin.solve_ik(robot, T)
        assert result.families_complete
        chain = chain_of(robot)
        size = chain_size(chain)
        curves = families(chain, T[None], one[None], size).curves[0]
        found = arcs_of_each(curves, chain, np.broadcast_to(T, (len(curves), 4, 4)), robot.limits, size)
        told = [arc.q[[0, -1]] for family in result.families for arc in family.arcs]
        for arc in found[0]:
            ends = arc.q[[0, -1]]
            near = min(
                float(np.max(np.abs(np.where(robot.revolute, np.angle(np.exp(1j * (ends - other))), 0.0))))
                for pair in told
                for other in (pair, pair[::-1])
            )
            assert near < 1e-8 or arc.whole


def test_nothing_within_the_limits_is_proven():
    robot = robokin.load("iiwa14")
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = robokin.rotation_from_rpy(np.radians([10.0, 80.0, 30.0])), [0.0003, 0.0002, 0.0008]
    result = robokin.solve_ik(robot, T)
    assert (result.reachable, result.complete, result.families_complete) == (False, True, True)
    assert result.reason == "outside the joint limits"
    assert robokin.solve_ik(robot, T, limits=False).reachable
    T[:3, 3] = [0.0, 0.0, 1.4]
    result = robokin.solve_ik(robot, T)
    assert (result.reason, result.families_complete) == ("out of reach", True)


def test_a_straight_elbow_has_half_the_curves(rng):
    robot = robokin.load("iiwa14")
    q = np.radians([11.0, 20.0, 30.0, 0.0, 50.0, 60.0, 71.0])
    result = robokin.solve_ik(robot, robokin.forward_kinematics(robot, q))
    assert result.families_complete
    assert [family.joints for family in result.families] == [(3, 5)] * 4
    assert all(family.solution >= 0 for family in result.families)


def test_a_straight_shoulder_is_followed_and_nothing_claimed():
    robot = robokin.load("iiwa14")
    q = np.radians([30.0, 0.0, 60.0, -90.0, 45.0, 60.0, -30.0])
    result = robokin.solve_ik(robot, robokin.forward_kinematics(robot, q))
    assert result.reachable
    assert not result.families_complete


NEXT_TO = [
    # Shoulder with q2 along a limit; an elbow that may be straight, or not.
    ("r1pro-left", [-180.0, 180.0, -49.040174613454575, 5.0336e-06, 49.04017461345458, -1.8007e-06, -3.4764e-07]),
    # On the curves with the other solution of the shoulder q1 is -170, its limit, all along.
    ("iiwa14", [10.0, 20.0, 30.0, 0.0, 50.0, 60.0, 71.0]),
    ("iiwa14", [11.0, 20.0, 30.0, 1e-4, 50.0, 60.0, 71.0]),
    ("iiwa14", [11.0, 20.0, 30.0, 0.04, 50.0, 60.0, 71.0]),
    ("iiwa14", [11.0, 2.0, 30.0, 0.0, 50.0, 60.0, 71.0]),
    ("iiwa14", [11.0, 0.01, 30.0, 40.0, 50.0, 60.0, 71.0]),
    ("iiwa14", [11.0, 20.0, 30.0, 40.0, 50.0, 1e-5, 71.0]),
    ("iiwa14", [11.0, 120.0, 30.0, 40.0, 50.0, 120.000001, 71.0]),
    ("iiwa14", [11.0, 20.0, 30.0, 120.000001, 50.0, 60.0, 71.0]),
]
"""Configurations [°] on curves next to what has no swivel angle, or next to where a limit cuts otherwise."""


@pytest.mark.parametrize(("name", "q"), NEXT_TO)
def test_next_to_a_degenerate_case_nothing_is_claimed(name, q):
    robot = robokin.load(name)
    T = robokin.forward_kinematics(robot, np.radians(q))
    pieces = swivel_pieces(swivel_curves(swivel_arm(chain_of(robot)), T[None]), robot.limits)
    assert pieces.doubt.all()


@pytest.mark.parametrize("by", [-1e-5, -1e-8, 0.0, 1e-8, 1e-5])
@pytest.mark.parametrize("joint", [0, 1, 2, 4, 5, 6])
def test_where_a_joint_nearly_touches_a_limit_nothing_is_claimed(joint, by, rng):
    """A limit is put where the joint turns back along one curve, or next to there."""
    robot = robokin.load("iiwa14")
    T = robokin.forward_kinematics(robot, within(robot, rng, 12, "anywhere"))
    curves = swivel_curves(swivel_arm(chain_of(robot)), T)
    psi = np.linspace(-np.pi, np.pi, 40001)
    free = np.tile([-np.inf, np.inf], (7, 1))
    for row in np.flatnonzero(~swivel_pieces(curves, free).doubt):
        q = curves.configurations(np.full(len(psi), row), np.zeros((len(psi), 3), dtype=int), psi)[:, joint]
        inside = np.flatnonzero((q[1:-1] > q[:-2]) & (q[1:-1] > q[2:]) & (np.abs(q[1:-1]) < 3.0)) + 1
        for k in inside[:1]:
            limits = free.copy()
            limits[joint] = -3.1, q[k] + by
            assert swivel_pieces(curves, limits).doubt[row]


def test_all_joints_at_limits_leave_a_point_or_a_piece():
    robot = robokin.load("iiwa14")
    q = robot.limits[np.arange(7), [1, 0, 1, 0, 1, 1, 0]]
    result = robokin.solve_ik(robot, robokin.forward_kinematics(robot, q))
    arcs = [arc for family in result.families for arc in family.arcs]
    assert min(float(np.min(np.max(np.abs(arc.q - q), axis=1))) for arc in arcs) < 1e-9
    for arc in arcs:
        assert robot.within_limits(arc.q).all()


def test_the_nearest_member_of_every_self_motion_comes_first(rng):
    robot = robokin.load("iiwa14")
    for q in within(robot, rng, 4, "anywhere"):
        T = robokin.forward_kinematics(robot, q)
        wish = np.clip(q + rng.normal(size=7) * 0.1, *robot.limits.T)
        result = robokin.solve_ik(robot, T, near=wish)
        members = np.concatenate([arc.q for family in result.families for arc in family.arcs])
        assert np.max(np.abs(result[0].q - wish)) <= np.min(np.max(np.abs(members - wish), axis=1)) + 1e-9


@pytest.mark.parametrize("name", sweep(SWIVELS, 2))
def test_the_swivel_angle_and_its_solutions(name, rng):
    robot = robokin.load(name)
    q = within(robot, rng, 20, "anywhere")
    psi = robokin.swivel_angle(robot, q)
    assert psi.shape == (20,)
    for one, angle in zip(q, psi.tolist(), strict=True):
        T = robokin.forward_kinematics(robot, one)
        found = robokin.swivel_solutions(robot, T, angle)
        assert np.min(np.max(np.abs(np.angle(np.exp(1j * (found - one)))), axis=1)) < 1e-8
        assert robot.within_limits(found).all()
        free = robokin.swivel_solutions(robot, T, angle + 0.4, limits=False)
        assert len(free) == 8
        assert np.allclose(robokin.forward_kinematics(robot, free), T, rtol=0, atol=1e-9)
        assert np.allclose(np.angle(np.exp(1j * (robokin.swivel_angle(robot, free) - angle - 0.4))), 0, atol=1e-8)


def test_the_swivel_angle_is_the_elbows_about_the_line():
    """iiwa14: shoulder at 360 mm; the elbow's point is on axis 4, 420 mm on; ψ by the angle of two planes."""
    robot = robokin.load("iiwa14")
    q = np.radians([10.0, 40.0, 70.0, -60.0, 50.0, 60.0, 70.0])
    frames = robokin.link_frames(robot, q)
    shoulder = np.array([0.0, 0.0, 0.36])
    elbow = frames[3][:3, 3] if abs(np.linalg.norm(frames[3][:3, 3] - shoulder) - 0.42) < 1e-9 else frames[4][:3, 3]
    T = robokin.forward_kinematics(robot, q)
    arm = swivel_arm(chain_of(robot))
    line = T[:3, :3] @ arm.wrist + T[:3, 3] - shoulder
    line /= np.linalg.norm(line)
    plane, up = np.cross(line, elbow - shoulder), np.cross(line, [0.0, 0.0, 1.0])
    expected = np.arctan2(line @ np.cross(up, plane), up @ plane)
    assert np.isclose(robokin.swivel_angle(robot, q), expected, rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda robot: robokin.swivel_angle(robot, [0.0] * 6), r"q: found an array of shape \(6,\), expected"),
        (lambda robot: robokin.swivel_angle(robot, [np.nan] * 7), "expected finite numbers"),
        (lambda robot: robokin.swivel_solutions(robot, np.eye(4)[None], 0.1), "expected one"),
        (lambda robot: robokin.swivel_solutions(robot, np.eye(4), [0.1]), "expected one finite angle"),
        (lambda robot: robokin.swivel_solutions(robot, np.eye(4), np.inf), "expected one finite angle"),
    ],
)
def test_bad_input_is_told(call, said):
    with pytest.raises(robokin.InputError, match=said):
        call(robokin.load("iiwa14"))


def test_batches_and_single_poses_agree(rng):
    robot = robokin.load("iiwa14")
    T = robokin.forward_kinematics(robot, within(robot, rng, 5, "some at limits"))
    batch = robokin.solve_ik(robot, T)
    for one, many in zip(T, batch, strict=True):
        alone = robokin.solve_ik(robot, one)
        assert np.array_equal([solution.q for solution in alone], [solution.q for solution in many])
    assert analysis_of(robot).redundancy == 1
