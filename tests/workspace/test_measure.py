"""Sizes of reachable sets: closed forms within the stated bound, scaling, moved bases, one answer on any cores."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from sweeps import sweep

import robokin
from robokin.errors import InputError
from robokin.model import Joint, JointType, Robot
from robokin.spatial import rotation_transform, transform
from robokin.workspace.extremes import extent
from robokin.workspace.measure import measure, several_measure, structural_length
from robokin.workspace.space import space_of

INF = np.inf
HALF = np.pi / 2
REST = (-INF, INF)


def arm(*rows, base=None, tool=None):
    """A robot of rows (letter, d, a, alpha, limits), the joint's own cell being its offset."""
    joints = []
    for i, (letter, d, a, alpha, limits) in enumerate(rows):
        if letter == "R":
            joints.append(Joint(str(i + 1), JointType.REVOLUTE, d=d, a=a, alpha=alpha, limits=limits))
        else:
            joints.append(Joint(str(i + 1), JointType.PRISMATIC, offset=d, a=a, alpha=alpha, limits=limits))
    base = np.eye(4) if base is None else base
    return Robot("arm", tuple(joints), base=base, tool=np.eye(4) if tool is None else tool)


def planar(*lengths, limits=None):
    limits = limits or [REST] * len(lengths)
    return arm(*(("R", 0.0, a, 0.0, limit) for a, limit in zip(lengths, limits, strict=True)))


def shell(upper, fore, offset=0.0, limits=(REST, REST, REST)):
    first, second, third = limits
    return arm(("R", 0, 0, HALF, first), ("R", offset, upper, 0, second), ("R", 0, fore, 0, third))


def puma_centre(scale=1.0, limits=True, base=None, tool=None, shift=0.0):
    """The wrist's centre of the PUMA 560: a2 = 431.8, d2 = 149.09, a3 = -20.32, d4 = 433.07 mm."""
    degrees = [(-160, 160), (-225, 45), (-45, 225)] if limits else [(-INF, INF)] * 3
    first, second, third = [tuple(np.radians(pair)) for pair in degrees]
    first = (first[0] + shift, first[1] + shift)
    at_wrist = transform(np.eye(3), np.array([0.0, 0.0, 0.43307 * scale]))
    rows = (
        ("R", 0.0, 0.0, -HALF, first),
        ("R", 0.14909 * scale, 0.4318 * scale, 0.0, second),
        ("R", 0.0, -0.02032 * scale, HALF, third),
    )
    return arm(*rows, base=base, tool=at_wrist if tool is None else at_wrist @ tool)


def size_of(robot, samples=1 << 14, seed=0, cores=1):
    space = space_of(robot)
    return measure(space, extent(space), samples, seed, cores)[0]


def within(found, truth, part=0.005):
    """The truth is within the bound, and the bound is at most this part of it."""
    assert abs(found.value - truth) <= found.error
    assert found.error <= part * truth


RADII = (np.hypot(0.02032, 0.43307) + 0.4318, abs(np.hypot(0.02032, 0.43307) - 0.4318))

# Robot, size; the formulas are elementary: annuli, shells, sectors, Pappus' theorem.
CLOSED_FORMS = {
    "planar 2R": (planar(1.0, 0.6), 4 * np.pi * 0.6),
    # The map is injective: l1 l2 D1 (cos c - cos d).
    "planar 2R with limits": (
        planar(1.0, 0.6, limits=[(-0.5, 1.7), (0.3, 2.4)]),
        0.6 * 2.2 * (np.cos(0.3) - np.cos(2.4)),
    ),
    "arc": (arm(("R", 0, 0.7, 0, (-0.4, 1.1))), 0.7 * 1.5),
    "line": (arm(("P", 0, 0.7, 0, (0.1, 0.5))), 0.4),
    "torus": (arm(("R", 0, 1.0, HALF, REST), ("R", 0, 0.3, 0, REST)), 4 * np.pi**2 * 0.3),
    "shell": (shell(0.5, 0.3), 4 / 3 * np.pi * (0.8**3 - 0.2**3)),
    # A lateral offset takes a cylinder out of a greater shell and leaves the volume (the napkin ring).
    "shell with an offset": (shell(0.5, 0.3, 0.15), 4 / 3 * np.pi * (0.8**3 - 0.2**3)),
    "PUMA wrist centre": (puma_centre(limits=False), 4 / 3 * np.pi * (RADII[0] ** 3 - RADII[1] ** 3)),
    "RPP": (
        arm(("R", 0, 0, 0, (-1.0, 2.0)), ("P", 0.2, 0, -HALF, (0.0, 0.5)), ("P", 0.0, 0, 0, (0.3, 0.9))),
        1.5 * (0.9**2 - 0.3**2) * 0.5,
    ),
    "SCARA": (
        arm(("R", 0, 0.5, 0, REST), ("R", 0, 0.3, np.pi, REST), ("P", 0, 0, 0, (0.1, 0.3)), ("R", 0, 0, 0, REST)),
        4 * np.pi * 0.15 * 0.2,
    ),
}


@pytest.mark.parametrize("name", CLOSED_FORMS)
def test_sizes_with_a_closed_form(name):
    robot, truth = CLOSED_FORMS[name]
    within(size_of(robot), truth)


def test_a_spherical_arm_with_limits():
    # The third joint slides along the ray with elevation q2: V = D1 (sin b - sin a) (r2³ - r1³) / 3.
    low, high = 0.2, 1.1
    robot = arm(
        ("R", 0, 0, HALF, (-1.0, 2.0)), ("R", 0, 0, HALF, (low + HALF, high + HALF)), ("P", 0, 0, 0, (0.3, 0.9))
    )
    within(size_of(robot), 3.0 * (np.sin(high) - np.sin(low)) * (0.9**3 - 0.3**3) / 3.0)


def test_a_cartesian_arm_is_a_box():
    robot = arm(("P", 0, 0, HALF, (0, 0.5)), ("P", 0, 0, HALF, (-0.1, 0.3)), ("P", 0, 0, 0, (0, 0.7)))
    robot = replace(robot, rows=tuple(replace(row, theta=HALF) for row in robot.rows))
    within(size_of(robot), 0.5 * 0.4 * 0.7)


def test_the_puma_wrist_centre_with_limits():
    # 2.52795 ± 7e-5: the same integral over three joints with 4 · 2^20 other points, and 2.52792 by hit or miss.
    found = size_of(puma_centre(), 1 << 15)
    assert abs(found.value - 2.52793) <= found.error + 1e-4
    assert found.error <= 0.005 * found.value


@cache
def puma_size():
    return size_of(puma_centre(), 1 << 13)


def test_a_scaled_arm_s_volume_scales_by_the_cube():
    assert size_of(puma_centre(scale=2.5), 1 << 13).value == pytest.approx(2.5**3 * puma_size().value, rel=1e-9)


def test_base_tool_and_zero_do_not_matter():
    base = rotation_transform([1.0, 2.0, -0.5], 0.8)
    base[:3, 3] = 0.3, -0.2, 0.5
    turned = rotation_transform([0.3, -1.0, 0.5], 1.3)
    for robot in (puma_centre(base=base), puma_centre(tool=turned), puma_centre(shift=0.7)):
        assert size_of(robot, 1 << 13).value == pytest.approx(puma_size().value, rel=1e-9)


def test_the_same_on_any_number_of_cores_and_another_for_another_seed():
    one = size_of(puma_centre(), 1 << 12, cores=1)
    assert one == size_of(puma_centre(), 1 << 12, cores=2)
    assert one != size_of(puma_centre(), 1 << 12, seed=1)
    redundant = planar(0.5, 0.4, 0.3, limits=[(-2.0, 2.0), (-1.0, 1.0), (-1.0, 1.0)])
    assert size_of(redundant, 1 << 12, cores=1) == size_of(redundant, 1 << 12, cores=2)


LINKS = [(1.0, 0.6, 0.35), (1.0, 0.3, 0.2), (0.5, 0.4, 0.3, 0.2), (2.0, 0.4, 0.3, 0.2), (0.05,) * 20, (0.1, 0.05) * 12]


@pytest.mark.parametrize("lengths", sweep([(lengths,) for lengths in LINKS], 3))
def test_redundant_planar_arms_reach_an_annulus(lengths):
    most, least = sum(lengths), max(0.0, 2.0 * max(lengths) - sum(lengths))
    # Searches with many joints cost more, so that fewer are made.
    samples, part = (1 << 14, 0.005) if len(lengths) < 8 else (1 << 17, 0.02)
    within(size_of(planar(*lengths), samples), np.pi * (most**2 - least**2), part)


@pytest.mark.slow
def test_many_joints_reach_a_ball():
    """Eighteen unlimited joints of which hardly any sample is stretched: that is no reason to call the rim empty."""
    found = robokin.analyse_workspace(robokin.load("human-body"), samples=1 << 16)
    size, reach = found.measure, found.extent.greatest
    assert found.extent.least < 1e-6
    assert abs(size.value - 4.0 / 3.0 * np.pi * reach**3) <= size.error < 0.06 * size.value


@pytest.mark.slow
def test_a_redundant_arm_with_a_hand_reaches_a_shell():
    # Three links that move in a plane through the first axis, and a hand that leaves it.
    def robot(first):
        rows = [("R", 0, 0, HALF, first), ("R", 0, 0.5, 0, REST), ("R", 0, 0.25, 0, REST)]
        return arm(*rows, ("R", 0, 0, HALF, REST), ("R", 0, 0.1, 0, REST))

    truth = 4 / 3 * np.pi * (0.85**3 - 0.15**3)
    within(size_of(robot(REST), 1 << 17), truth)
    # The arm bends over backwards, so that limits of the first joint take nothing off.
    within(size_of(robot((-2.5, 2.4)), 1 << 17), truth)


@pytest.mark.parametrize("stroke", [5.0, 1.0])
def test_a_redundant_sector(stroke):
    # Two slides along one line, which turns: the radius goes from 0.3 to 0.9.
    robot = arm(("R", 0, 0, HALF, (0.2, 0.2 + stroke)), ("P", 0.3, 0, 0, (0, 0.4)), ("P", 0, 0, 0, (0, 0.2)))
    within(size_of(robot, 1 << 17), stroke / 2.0 * (0.9**2 - 0.3**2))


def test_the_puma_s_tool_tip_without_limits():
    # 3.363 by 131072 points that were tried in 600 directions each.
    found = size_of(replace_limits(robokin.load("puma560")), 1 << 15)
    assert abs(found.value - 3.363) < found.error + 0.008


def replace_limits(robot):
    return replace(robot, rows=tuple(replace(row, limits=REST) for row in robot.rows))


def test_where_two_orientations_are_possible():
    full = planar(1.0, 0.6)
    within(several_measure(space_of(full), 1 << 12, 0, 1), 4 * np.pi * 0.6)
    elbow = planar(1.0, 0.6, limits=[REST, (0.3, 2.4)])
    assert several_measure(space_of(elbow), 1 << 12, 0, 1).value == 0.0
    # Both elbows from 0.3 to 1 serve the same annulus; what the range from 1 to 2.4 adds has one only.
    uneven = planar(1.0, 0.6, limits=[REST, (-1.0, 2.4)])
    rim = np.pi * ((1.36 + 1.2) - (1.36 + 1.2 * np.cos(1.0)))
    within(several_measure(space_of(uneven), 1 << 14, 0, 1), rim)
    with pytest.raises(ValueError, match="infinitely many"):
        several_measure(space_of(robokin.load("planar3r")), 64, 0, 1)


def test_structural_lengths():
    assert structural_length(shell(0.5, 0.3, 0.15)) == pytest.approx(0.95)
    assert structural_length(arm(("P", 0, 0, 0, (0.1, 0.5)), ("R", 0.2, -0.3, 0, REST))) == pytest.approx(0.9)


def test_the_whole_answer():
    found = robokin.analyse_workspace(shell(0.5, 0.5), samples=1 << 14, cores=1)
    assert found.extent.greatest == pytest.approx(1.0)
    within(found.measure, 4 / 3 * np.pi)
    # The ideal articulated arm: L / V^(1/3) = (3 / 4π)^(1/3), and its ball is filled.
    assert found.length_index == pytest.approx(0.6204, abs=1e-3)
    assert found.volume_index == pytest.approx(1.0, abs=5e-3)
    assert not found.notes
    flat = robokin.analyse_workspace(planar(0.5, 0.4, 0.3, 0.2), samples=1 << 12, cores=1)
    assert flat.length_index is None
    assert "not proven" in flat.notes[0]
    # One joint to spare: closed forms decide.
    decided = robokin.analyse_workspace(planar(0.5, 0.4, 0.3), samples=1 << 12, cores=1)
    assert decided.measure.exact
    assert not decided.notes


def test_what_cannot_be_asked():
    with pytest.raises(InputError, match="samples: found 0, expected a whole number of 1 or more"):
        robokin.analyse_workspace(planar(1.0, 0.6), samples=0)
    with pytest.raises(InputError, match="sampling: found 'dice', expected 'sobol', 'random' or 'grid'"):
        robokin.analyse_workspace(planar(1.0, 0.6), sampling="dice")
