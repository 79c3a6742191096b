"""Gears, belts and chains of a known ratio: counts, senses, motions, and what cannot be told."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from mobility.linkages import unit
from sweeps import sweep

import robokin
from robokin.errors import InputError
from robokin.formats import read_text
from robokin.mobility.trace import trace
from robokin.mobility.verdict import mobility_of
from robokin.model import Mechanism, MechanismJoint

# Turns of the second joint for one of the first, by hand: a wheel of z teeth turns z' / z times; Willis, Principles of
# Mechanism, 1841, for the planetary sets: (sun - carrier) / (ring - carrier) = -ring / sun.
RATIOS = {
    ("gear-pair", "A", "B"): -1 / 2.5,
    ("planetary", "A", "B"): 1 / (1 + 4 / 2),
    ("bevel-pair", "A", "B"): -15 / 30,
    ("worm-drive", "A", "B"): 2 / 30,
    ("belt-drive", "A", "B"): 20 / 40,
    ("belt-drive", "A", "C"): 20 / 30,
    ("geared-five-bar", "A", "E"): 1.0,  # E is written from the right crank to the ground
}


@pytest.mark.parametrize(("name", "first", "second"), sweep(RATIOS, 3))
def test_wheels_of_the_library_turn_at_their_ratio(name, first, second):
    found = trace(robokin.load_mechanism(name), 7)
    assert found.closed
    a, b = (found.values[:, found.labels.index(joint)] for joint in (first, second))
    assert np.allclose(b, RATIOS[name, first, second] * a, atol=1e-9)


def test_a_differential_s_cage_turns_with_the_mean():
    differential = robokin.load_mechanism("bevel-differential")
    for held in "LR":
        joints = [replace(j, actuated=j.name in (held, "C")) for j in differential.joints]
        found = trace(replace(differential, joints=tuple(joints)), 5, "C")
        left, right, cage = (found.values[:, found.labels.index(name)] for name in "LRC")
        assert np.allclose(2 * cage, left + right, atol=1e-9)
        assert np.ptp(cage) > 1.0


def test_a_gear_counts_one_constraint_in_every_space():
    text = "robokin: 1\nname: x\nspace: {}\nlinks: [g, a, b]\njoints:\n  - {{type: {}, links: [a, b]}}\n"
    for kind in ("gear", "cam", "belt"):
        for space, f in (("planar", 2), ("spherical", 2), ("spatial", 5)):
            (joint,) = read_text(text.format(space, kind)).joints
            assert joint.freedoms == f


# Trains drawn at random ------------------------------------------------------------------------------------


def train(rng, count, space="spatial", carrier_turns=False):
    """Wheels 1 … count on hinges of a carrier, each geared to one before; the ratios r of wheel i to its partner."""
    carrier = "arm" if carrier_turns else "0"
    links = ["0", *(["arm"] if carrier_turns else []), *(f"w{i}" for i in range(count))]
    joints, ratios = [], []
    if carrier_turns:
        joints.append(MechanismJoint("arm", "revolute", ("0", "arm"), 1, np.zeros(3), np.array([[0.0, 0.0, 1.0]])))
    for i in range(count):
        axis = unit(rng.normal(size=3)) if space == "spatial" else np.array([0.0, 0.0, rng.choice([-1.0, 1.0])])
        at = rng.normal(size=3) * (1.0, 1.0, space == "spatial")
        pair = (carrier, f"w{i}") if rng.random() < 0.5 else (f"w{i}", carrier)
        joints.append(MechanismJoint(f"h{i}", "revolute", pair, 1, at, axis[None], actuated=i == 0))
    for i in range(1, count):
        partner = int(rng.integers(i))
        ratio = float(rng.choice([-3.0, -1.0, -0.5, 0.5, 2.0, 4.0]))
        axes = np.array([joints[int(carrier_turns) + k].axes[0] * rng.choice([-1, 1]) for k in (i, partner)])
        f = 5 if space == "spatial" else 2
        gear = MechanismJoint(f"g{i}", "gear", (f"w{i}", f"w{partner}"), f, axes=axes, gearing=(1.0, ratio))
        joints.append(gear)
        ratios.append((i, partner, ratio, axes))
    order = rng.permutation(len(joints))
    return Mechanism("a train", space, tuple(links), tuple(joints[k] for k in order), "0"), ratios


def turn_about(T, axis):
    """The turn of displacements T (m, 4, 4) about an axis (3,), by the axis-angle of each step to the next."""
    steps = np.swapaxes(T[:-1, :3, :3], 1, 2) @ T[1:, :3, :3]
    w = np.stack([steps[:, 2, 1] - steps[:, 1, 2], steps[:, 0, 2] - steps[:, 2, 0], steps[:, 1, 0] - steps[:, 0, 1]], 1)
    return np.concatenate([[0.0], np.cumsum(np.arcsin(np.clip(0.5 * w @ axis, -1.0, 1.0)))])


@pytest.mark.parametrize("space", sweep(["planar", "spatial"], 2))
@pytest.mark.parametrize("carrier_turns", [False, True])
def test_trains_of_gears_count_and_turn_as_their_ratios_say(space, carrier_turns, rng):
    for _ in range(2):
        mechanism, ratios = train(rng, int(rng.integers(2, 5)), space, carrier_turns)
        found = mobility_of(mechanism)
        assert found.mobility == found.count == 1 + carrier_turns
        assert found.redundant == 0
        motion = trace(mechanism, 400, "h0")
        arm = motion.poses[:, motion.links.index("arm")] if carrier_turns else np.eye(4)
        for i, partner, ratio, axes in ratios:
            turns = []
            for wheel, axis in zip((i, partner), axes, strict=True):
                T = np.linalg.inv(arm) @ motion.poses[:, motion.links.index(f"w{wheel}")]
                turns.append(turn_about(T, axis))
            # Four hundred steps of a long motion may leap over a turn: the speeds tell.
            small = np.all(np.abs(np.diff(turns)) < 1.0, axis=0)
            assert np.allclose(np.diff(turns[0])[small], ratio * np.diff(turns[1])[small], atol=1e-6)


def test_a_train_scaled_and_shifted_turns_alike(rng):
    mechanism, _ = train(rng, 2)
    for scale in (1e-3, 1e3):
        joints = [replace(j, at=None if j.at is None else scale * j.at + 7.0) for j in mechanism.joints]
        moved = replace(mechanism, joints=tuple(joints))
        assert np.allclose(trace(moved, 5, "h0").values, trace(mechanism, 5, "h0").values, atol=1e-9)


# Senses and carriers -----------------------------------------------------------------------------------------

PAIR = """
robokin: 1
name: A pair
space: {space}
units: {{length: mm, angle: deg}}
links: [ground, a, b]
joints:
  - {{name: A, type: revolute, links: [ground, a], {first}, actuated: true}}
  - {{name: B, type: revolute, links: [ground, b], {second}}}
  - {{name: G, {gear}}}
"""


def ratio_of(gear, first="at: [0, 0]", second="at: [30, 0]", space="planar"):
    found = trace(read_text(PAIR.format(space=space, first=first, second=second, gear=gear)), 3)
    return found.values[1, 1] / found.values[1, 0]


@pytest.mark.parametrize(
    ("gear", "expected"),
    sweep([
        ("type: gear, links: [a, b], teeth: [10, 20]", -0.5), ("type: gear, links: [b, a], teeth: [20, 10]", -0.5),
        ("type: gear, links: [a, b], teeth: [10, 20], at: [10, 0]", -0.5),
        ("type: gear, links: [a, b], teeth: [10, 40], at: [-10, 0]", 0.25),
        ("type: gear, links: [a, b], ratio: -2", -0.5), ("type: gear, links: [a, b], ratio: 2", 0.5),
        ("type: gear, links: [b, a], ratio: 2", 2.0),
        ("type: gear, links: [a, b], ratio: 2, axes: [[0, 0, 1], [0, 0, -1]]", -0.5),
        ("type: belt, links: [a, b], ratio: 2", 0.5), ("type: belt, links: [a, b], ratio: 2, crossed: true", -0.5),
        ("type: belt, links: [a, b], radii: [5, 20]", 0.25), ("type: belt, links: [a, b], teeth: [12, 36]", 1 / 3),
        ("type: belt, links: [a, b], radii: [5, 20], crossed: true", -0.25),
        ("type: belt, links: [a, b], radii: [5, -20]", -0.25), ("type: gear, links: [a, b], ratio: 20/6", 0.3),
        ("type: gear, links: [a, b], ratio: 3, carrier: ground", 1 / 3),
    ], 4),
)  # fmt: skip
def test_senses(gear, expected):
    assert ratio_of(gear) == pytest.approx(expected, abs=1e-9)
    # The joints' own directions do not matter to a train in the plane, but for their values' signs.
    turned = ratio_of(gear, second="at: [30, 0], axis: [0, 0, -1]")
    if "axes" not in gear:
        assert turned == pytest.approx(-expected, abs=1e-9)


@pytest.mark.parametrize(
    ("gear", "said"),
    [
        ("type: gear, links: [a, b], teeth: [2, 30]", "expected `at`, where they touch, or a ratio"),
        ("type: gear, links: [a, b], teeth: [2, 30], at: [0, 8, 0]", "go across one another"),
        ("type: belt, links: [a, b], radii: [2, 30]", "do not turn about parallel axes"),
        ("type: gear, links: [a, b], ratio: 2, axes: [[0, 1, 0], [0, 0, 1]]", "about the given axes"),
        ("type: gear, links: [a, b], ratio: 2, carrier: a", "do not both turn on a"),
        ("type: gear, links: [a, ground], ratio: 2", "do not turn on one link"),
    ],
)
def test_what_cannot_be_told(gear, said):
    text = PAIR.format(
        space="spatial", first="at: [0, 0, 0], axis: [1, 0, 0]", second="at: [0, 35, 0], axis: [0, 0, 1]", gear=gear
    )
    with pytest.raises(InputError, match=said) as caught:
        mobility_of(read_text(text))
    assert "expected" in str(caught.value)


def test_wheels_that_two_links_may_carry_need_a_carrier():
    """A gear between crank and rocker of a four-bar: on the ground, or on the coupler."""
    four = robokin.load_mechanism("four-bar")
    gear = MechanismJoint("G", "gear", ("crank", "rocker"), 2, gearing=(1.0, 2.0))
    with pytest.raises(InputError, match=r"may turn on ground or coupler.*`carrier: NAME`"):
        mobility_of(replace(four, joints=(*four.joints, gear)))
    for carrier in ("ground", "coupler"):
        found = mobility_of(replace(four, joints=(*four.joints, replace(gear, carrier=carrier))))
        assert (found.count, found.mobility) == (0, 0)


def test_redundant_planets_are_found_by_teeth_too():
    planet = "  - {{name: C{i}, type: revolute, links: [carrier, p{i}], at: [3*cos({a}), 3*sin({a})]}}\n"
    planet += "  - {{name: D{i}, type: gear, links: [sun, p{i}], teeth: [20, 10]}}\n"
    planet += "  - {{name: E{i}, type: gear, links: [p{i}, ring], teeth: [10, 40], at: [4*cos({a}), 4*sin({a})]}}\n"
    text = "robokin: 1\nname: x\nspace: planar\nunits: {angle: deg}\nlinks: [ring, sun, carrier, p0, p1, p2]\njoints:\n"
    text += "  - {name: A, type: revolute, links: [ring, sun], at: [0, 0], actuated: true}\n"
    text += "  - {name: B, type: revolute, links: [ring, carrier], at: [0, 0]}\n"
    text += "".join(planet.format(i=i, a=120 * i) for i in range(3))
    found = mobility_of(read_text(text))
    assert (found.count, found.mobility, found.redundant) == (-1, 1, 2)
    wrong = mobility_of(read_text(text.replace("D1, type: gear, links: [sun, p1], teeth: [20, 10]",
                                               "D1, type: gear, links: [sun, p1], teeth: [21, 10]")))  # fmt: skip
    assert wrong.mobility == 0
