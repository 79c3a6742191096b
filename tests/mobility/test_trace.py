"""Mechanisms in motion: loops stay closed, closed forms are met, curves come back."""

from __future__ import annotations

import numpy as np
import pytest
from mobility.linkages import bennett, four_bar, generic_loop, linkage, slider_crank
from sweeps import sweep

import robokin
from robokin.errors import InputError
from robokin.mobility.trace import trace
from robokin.spatial import invert

PARALLELOGRAM = [(0.0, 0.0), (1.0, 2.0), (4.0, 2.0), (3.0, 0.0)]


def gaps(found):
    """How far the joints of a trace come apart: distances between the points that should be one, and axes."""
    worst = 0.0
    for joint in found.mechanism.joints:
        T = [found.poses[:, found.links.index(link)] for link in joint.links]
        for other in T[1:]:
            relative = invert(T[0]) @ other
            if joint.type in ("revolute", "spherical", "universal"):
                moved = relative[:, :3, :3] @ joint.at + relative[:, :3, 3]
                worst = max(worst, float(np.max(np.abs(moved - joint.at))))
            if joint.type in ("revolute", "prismatic"):
                axis = joint.axes[0]
                worst = max(worst, float(np.max(np.abs(relative[:, :3, :3] @ axis - axis))))
            if joint.type == "prismatic":
                assert np.allclose(relative[:, :3, :3], np.eye(3), atol=1e-12)
    return worst


@pytest.mark.parametrize(
    "mechanism",
    sweep([
        four_bar([(0, 0), (1, 2), (4, 3), (5, 0.5)]), four_bar(PARALLELOGRAM), slider_crank(), bennett(),
        generic_loop(7), robokin.load_mechanism("sarrus"), robokin.load_mechanism("jansen-leg"),
        robokin.load_mechanism("rssr"),
    ], 4),
    ids=["four-bar", "parallelogram", "slider-crank", "Bennett", "7R", "Sarrus", "Jansen", "RSSR"],
)  # fmt: skip
def test_the_loops_stay_closed(mechanism):
    size = max(float(np.max(np.abs(joint.at))) for joint in mechanism.joints if joint.at is not None)
    found = trace(mechanism, 40)
    assert found.poses.shape == (40, len(mechanism.links), 4, 4)
    assert gaps(found) < 1e-11 * size
    assert np.allclose(found.poses[0], np.eye(4), atol=1e-12)
    assert np.allclose(found.poses[:, found.links.index(mechanism.ground)], np.eye(4))
    assert np.max(np.abs(found.values[0])) == 0.0


def test_a_slider_crank_moves_by_its_closed_form():
    """x = r cos θ + sqrt(l² − r² sin² θ)."""
    r, rod, first = 1.0, 3.0, 0.8
    found = trace(slider_crank(r, rod, first), 90)
    assert found.closed
    assert np.allclose(np.abs(np.diff(found.values[:, 0])), 2 * np.pi / 90, atol=1e-12)
    theta = first + found.values[:, 0]
    x = r * np.cos(theta) + np.sqrt(rod**2 - r**2 * np.sin(theta) ** 2)
    slider = found.poses[:, found.links.index("3"), 0, 3]
    assert np.allclose(slider, x - x[0], atol=1e-12)
    assert np.allclose(found.values[:, 3], -slider, atol=1e-12), "the joint leads from the slider to the ground"


def test_a_parallelogram_s_coupler_goes_in_a_circle_without_turning():
    found = trace(four_bar(PARALLELOGRAM), 60)
    coupler = found.poses[:, found.links.index("2")]
    assert np.allclose(coupler[:, :3, :3], np.eye(3), atol=1e-10)
    B = coupler[:, :2, 3] + (1.0, 2.0)
    assert np.allclose(np.linalg.norm(B, axis=1), np.sqrt(5.0), atol=1e-11)


def test_a_coupler_curve_comes_back():
    mechanism = robokin.load_mechanism("four-bar")
    found = trace(mechanism, 200)
    assert found.closed
    point = np.array([3.0, 4.0, 0.0])
    coupler = found.poses[:, found.links.index("coupler")]
    path = coupler[:, :3, :3] @ point + coupler[:, :3, 3]
    steps = np.linalg.norm(np.diff(path, axis=0, append=path[:1]), axis=1)
    assert steps.max() < 0.15, "the last place leads on to the first"
    # Distances in the coupler do not change: the point stays where it was from B and from C.
    for name in "BC":
        at = next(joint.at for joint in mechanism.joints if joint.name == name)
        pin = coupler[:, :3, :3] @ at + coupler[:, :3, 3]
        assert np.allclose(np.linalg.norm(path - pin, axis=1), np.linalg.norm(point - at), atol=1e-11)


def test_a_rocker_turns_back_and_the_curve_still_comes_back():
    found = trace(robokin.load_mechanism("four-bar"), 120, "D")
    assert (found.driven, found.closed) == ("D", True)
    assert gaps(found) < 1e-11
    angles = found.values[:, found.labels.index("D")]
    assert angles.max() - angles.min() < np.pi, "a rocker does not go round"


def test_peaucellier_s_point_goes_on_a_line():
    mechanism = robokin.load_mechanism("peaucellier-lipkin")
    found = trace(mechanism, 50)
    at = next(joint for joint in mechanism.joints if joint.name == "D")
    T = found.poses[:, found.links.index(at.links[0])]
    x = (T[:, :3, :3] @ at.at + T[:, :3, 3])[:, 0]
    assert np.ptp(x) < 1e-10


def test_other_drives_are_held():
    five = robokin.load_mechanism("five-bar")
    found = trace(five, 20)
    driven = [joint.name for joint in five.joints if joint.actuated]
    assert len(driven) == 2
    held = next(name for name in driven if name != found.driven)
    assert np.max(np.abs(found.values[:, found.labels.index(held)])) < 1e-12
    assert np.ptp(found.values[:, found.labels.index(found.driven)]) > 0.5


@pytest.mark.slow
def test_joints_of_several_freedoms_have_numbered_values():
    found = trace(robokin.load_mechanism("rssr"), 5)
    assert len(found.labels) == found.values.shape[1] == 8
    assert len(set(found.labels)) == 8


def test_what_cannot_be_followed():
    with pytest.raises(InputError, match="does not move, expected"):
        trace(generic_loop(6), 5)
    with pytest.raises(InputError, match="only trembles"):
        trace(robokin.load_mechanism("shaky-triangle"), 5)
    with pytest.raises(InputError, match="unknown joint 'E'"):
        trace(robokin.load_mechanism("four-bar"), 5, "E")
    with pytest.raises(InputError, match="contacts"):
        trace(robokin.load_mechanism("cam-roller"), 5)
    with pytest.raises(InputError, match="no joint leads from the ground to 1"):
        trace(linkage([("R", "12", (0, 0))]), 5)
    dead = linkage([("R", "01", (0, 0)), ("R", "12", (1, 0)), ("R", "23", (3, 0)), ("R", "31", (2, 2))])
    with pytest.raises(InputError, match=r"joint 1 does not move.*--drive"):
        trace(dead, 5, "1")


def test_gears_on_a_carrier_turn_as_their_radii_say():
    """Willis: with the ring fixed the carrier turns sun / (sun + ring) as fast as the sun, all the way round."""
    planetary = robokin.load_mechanism("planetary")
    found = trace(planetary, 40)
    sun, carrier = (found.values[:, found.labels.index(name)] for name in "AB")
    radii = planetary.parameters
    ring = radii["sun"] + 2 * radii["planet"]
    assert np.ptp(sun) > 6.0
    assert np.allclose(carrier * (radii["sun"] + ring), sun * radii["sun"], atol=1e-10)
    pair = trace(robokin.load_mechanism("gear-pair"), 20)
    assert np.allclose(pair.values[:, 0], -2.5 * pair.values[:, 1], atol=1e-10)
