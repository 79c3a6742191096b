"""What forward kinematics reaches is never denied, whatever the arm and wherever in its joint box; and what is said of
what is not found."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from sweeps import sweep
from workspace.spare_arms import KINDS, drawn_arm, sampled
from workspace.spare_sizes import FAMILIES, spare_arm

import robokin
from robokin.kernel.frames import frames
from robokin.model import Joint, JointType, Robot
from robokin.workspace.attitudes import attitudes, group_of
from robokin.workspace.descent import descent_of
from robokin.workspace.extremes import extent
from robokin.workspace.measure import measure
from robokin.workspace.membership import decided, proven_out, reachable
from robokin.workspace.one_spare import one_spare_of
from robokin.workspace.place import at_point
from robokin.workspace.placing_joints import ClosedForm
from robokin.workspace.region import region_of
from robokin.workspace.sampling import positions
from robokin.workspace.space import space_of
from robokin.workspace.trials import at_one_place, table
from robokin.workspace.witnesses import denied_share


def planar(*rows):
    """A planar arm of revolute rows (length, lowest, highest) [m, deg]."""
    joints = (
        Joint(str(i), JointType.REVOLUTE, a=a, limits=(np.radians(low), np.radians(high)))
        for i, (a, low, high) in enumerate(rows)
    )
    return Robot("arm", tuple(joints))


FOLDED = planar((0.84, 12, 69), (0.26, -239, -112), (0.62, -237, 76))


ON_EDGES = robokin.forward_kinematics(
    robokin.load("so-101"),
    [
        [-1.1124600085838021, -1.7453292519943295, -1.69, -0.2081972607069571, -0.002914782828840501],
        [0.9954015489747872, -1.7453292519943295, -1.69, -0.19054974924779966, 0.0828695244379114],
    ],
)[:, :3, 3]
"""Where the SO-101 comes with its second and third joint as far folded as they go."""


@pytest.mark.parametrize(
    ("robot", "point"),
    [
        (FOLDED, (1.1982485243397283, -0.2883585541295732, 0.0)),
        (robokin.load("scorbot"), (-0.2760816838856534, -0.1532972107628303, 0.7367543185347126)),
        (drawn_arm(28), (0.9499253653153266, 0.7703069586076401, 0.3664731491408801)),
        # Two joints at their limits, with which the others are next to singular.
        (robokin.load("so-101"), ON_EDGES[0]),
        (robokin.load("so-101"), ON_EDGES[1]),
    ],
    ids=["three links", "scorbot", "a sliver of five joints", *(f"on an edge {i}" for i in (1, 2))],
)
def test_points_behind_a_barrier(robot, point):
    assert reachable(space_of(robot), [point]).all()
    assert at_point(space_of(robot), point).reachable


# Seeds of every family; among them those of whose samples searches from near the point alone deny some.
@pytest.mark.parametrize("seed", sweep([*range(24), 181, 195, 205, 229, 246, 251, 259, 267, 275, 277, 280, 290], 4))
def test_no_sample_of_a_drawn_arm_is_denied(seed, rng):
    space = space_of(drawn_arm(seed))
    if not space.moving:
        pytest.skip("all of its joints are held")
    for kind in KINDS:
        p = positions(space, sampled(space, kind, 500, rng)).T
        assert np.count_nonzero(~reachable(space, p)) == 0, kind


def test_no_sample_of_a_circle_is_denied_that_two_joints_of_one_axis_reach(rng):
    """What the first joint leaves alone is one point, which samples know but for rounding."""
    space = space_of(drawn_arm(123))
    assert (len(space.moving), space.dimension) == (2, 1)
    p = positions(space, sampled(space, "uniform", 20000, rng)).T
    assert reachable(space, p).all()


@pytest.mark.parametrize(
    "name", sweep(["scorbot-er4u", "openarm-left", "kr5-arc", "panda", "piper-old", "stanford"], 3)
)
def test_no_sample_of_a_library_arm_is_denied(name, rng):
    space = space_of(robokin.load(name))
    for kind in KINDS:
        p = positions(space, sampled(space, kind, 1500, rng)).T
        assert np.count_nonzero(~reachable(space, p)) == 0, kind


def brute(space, points, k, count):
    """Whether points are reached with one of many values of moving joint k, by closed forms of the others."""
    there = np.zeros(len(points), dtype=bool)
    joint = space.moving[k]
    for value in np.linspace(space.low[joint], space.high[joint], count):
        low, high, full = space.low.copy(), space.high.copy(), space.full.copy()
        low[joint] = high[joint] = value
        full[joint] = False
        part = replace(space, low=low, high=high, full=full, moving=tuple(i for i in space.moving if i != joint))
        left = np.flatnonzero(~there)
        there[left] = ClosedForm(part).counts(points[left]) > 0
    return there


@pytest.mark.parametrize(("family", "number"), sweep([("planar 3R", 1), ("PRR", 2), ("waist and 3R", 1)], 3))
def test_one_spare_joint_is_decided_by_its_limits(family, number, rng):
    space = space_of(spare_arm(family, number)[0])
    exact = one_spare_of(space)
    assert exact is not None
    assert decided(space)
    bounds = extent(space)
    points = bounds.low + (bounds.high - bounds.low) * rng.random((300, 3))
    found, q = exact.reached(points)
    assert 0.1 < found.mean() < 0.95
    full = np.zeros((len(space.low), int(found.sum())))
    full[list(space.moving)] = q[:, found]
    assert np.max(np.abs(positions(space, full).T - points[found])) <= 1e-6 * space.size
    there = brute(space, points, 0 if space.dimension == 2 else 1, 120)
    # The many values lack what lies between them, and nothing else.
    assert not np.any(there & ~found)
    assert np.mean(found & ~there) < 0.05


def test_what_is_decided():
    assert decided(space_of(FOLDED))
    assert decided(space_of(robokin.load("scorbot")))
    assert decided(space_of(robokin.load("scara")))
    puma = space_of(robokin.load("puma560"))
    assert not decided(puma)
    assert proven_out(puma, [[0.0, 0.0, -0.9], [3.0, 0.0, 0.0]]).tolist() == [False, True]
    assert one_spare_of(space_of(planar((0.5, -90, 90), (0.5, -90, 90), (0.0, -90, 90)))) is None


def test_a_place_says_whether_it_is_proven(rng):
    puma = space_of(robokin.load("puma560"))
    assert at_point(puma, [0.0, 0.0, -0.9], 8).proven is False
    assert at_point(puma, [5.0, 0.0, 0.0], 8).proven is True
    assert at_point(space_of(FOLDED), [0.1, 0.1, 0.0], 8).proven is True


@pytest.mark.slow
def test_searches_learn_from_what_they_deny():
    space = space_of(drawn_arm(277))
    region = region_of(space, extent(space))
    share = denied_share(space, region, 4096, 0, 1)
    assert 0.0 < share < 0.02
    assert share == denied_share(space_of(drawn_arm(277)), region, 4096, 0, 1)
    assert descent_of(space).learned


@pytest.mark.parametrize("family", sweep([name for name in FAMILIES if name != "planar 4R"], 5))
def test_bounds_hold_and_more_points_do_not_break_them(family):
    robot, size = spare_arm(family, 3)
    space = space_of(robot)
    bounds = extent(space)
    errors = []
    for samples in (2048, 131072):
        found, _ = measure(space, bounds, samples, 1, 1)
        assert abs(found.value - size) <= found.error + FAMILIES[family] * size
        assert found.exact == decided(space)
        errors.append(found.error)
    assert all(b < a for a, b in pairwise(errors))


def test_orientations_beside_reached_ones_are_not_denied():
    space = space_of(robokin.load("openarm-left"))
    grid = attitudes(space, group_of(space), 400, 0)
    q = 0.5 * (space.low + space.high) + 0.2 * (space.high - space.low)
    p = frames(space.chain, q[None])[0, -1, :3, 3]
    quick, found = table(space, grid, p[None])[0], at_one_place(space, grid, p)
    assert np.all(found[quick])
    assert np.sum(found) > np.sum(quick)


def test_ranges_of_angles_of_an_arm_with_a_joint_to_spare():
    robot = planar((0.84, 12, 69), (0.26, -139, 112), (0.62, -137, 76), (0.3, -47, 26))
    place = at_point(space_of(robot), [1.1, 0.5, 0.0])
    assert len(place.ranges) == 1
    angles = np.degrees(np.arctan2(place.ranges[0, :, 1, 0], place.ranges[0, :, 0, 0]))
    # By the last link's angle on a fine scale and the first joint's on another, the others having a closed form.
    assert np.allclose(np.sort(angles), [-69.34040828, -16.93638], atol=2e-4)
