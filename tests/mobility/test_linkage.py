"""Bodies, joints and loops: twists by finite differences, loops that close."""

from __future__ import annotations

import numpy as np
import pytest
from mobility.linkages import bennett, chain_of_four_bars, four_bar, generic_loop, linkage, slider_crank

from robokin.errors import InputError
from robokin.mobility.assembly import assembled, missing_geometry, size_of, space_fault
from robokin.mobility.linkage import CLOSED
from robokin.mobility.slips import slips_of
from robokin.mobility.true_mobility import kernel_at
from robokin.mobility.verdict import mobility_of
from robokin.spatial import invert
from robokin.spatial.twists import logarithm

SQUARE = [(0.0, 0.0), (1.0, 2.0), (4.0, 3.0), (5.0, 0.5)]
EXAMPLES = {"four-bar": four_bar(SQUARE), "slider-crank": slider_crank(), "Bennett": bennett(), "7R": generic_loop(7)}


def test_the_bodies_twists_are_the_differences_of_their_poses(rng):
    """An open chain of all kinds of joints, at a configuration away from the reference."""
    chain = linkage(
        [("R", "01", (0, 0, 0), (0, 0, 1)), ("P", "12", (1, 0, 0), (1, 1, 0)), ("C", "23", (1, 1, 0), (0, 1, 1)),
         ("S", "34", (2, 1, 1)), ("U", "45", (2, 2, 1), (1, 0, 0), (0, 1, 0)), ("H", "56", (3, 2, 1), (1, 2, 3)),
         ("E", "67", (3, 3, 1), (0, 0, 1))],
        "spatial",
    )  # fmt: skip
    body = assembled(chain).linkage
    state = body.moved(body.reference, rng.normal(size=body.freedoms))
    speeds = rng.normal(size=body.freedoms)
    h = 1e-6
    ahead, back = (body.moved(state, sign * h * speeds) for sign in (1, -1))
    found = logarithm(ahead.bodies @ invert(back.bodies)) / (2 * h)
    assert np.allclose(found, body.body_twists(state, speeds[:, None])[:, :, 0], atol=1e-7)


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_loops_equations_are_the_differences_of_what_they_lack(name, rng):
    body = assembled(EXAMPLES[name]).linkage
    state = body.reference
    J = body.jacobian(state)
    h = 1e-6
    for speeds in rng.normal(size=(5, body.freedoms)):
        ahead, back = (body.lack(body.moved(state, sign * h * speeds)) for sign in (1, -1))
        assert np.allclose((ahead - back) / (2 * h), J @ speeds, atol=1e-7)


@pytest.mark.parametrize("name", EXAMPLES)
def test_loops_are_closed_again(name, rng):
    body = assembled(EXAMPLES[name]).linkage
    assert np.max(np.abs(body.lack(body.reference))) == 0.0
    _, kernel = kernel_at(body, body.reference)
    moved = body.moved(body.reference, 0.3 * kernel @ rng.normal(size=kernel.shape[1]))
    assert np.max(np.abs(body.lack(moved))) > 1e-4
    state, _, lacking = body.closed(moved)
    assert lacking <= CLOSED
    assert np.max(np.abs(body.lack(state))) <= CLOSED


def test_held_joints_stay(rng):
    body = assembled(four_bar(SQUARE)).linkage
    keep = np.array([True, False, False, False])
    state, moved, lacking = body.closed(body.moved(body.reference, np.array([0.2, 0, 0, 0])), keep=keep)
    assert lacking <= CLOSED
    assert moved[0] == 0.0
    # The crank's displacement is the turn by 0.2 that it was given.
    assert np.arctan2(state.joints[0][1, 0], state.joints[0][0, 0]) == pytest.approx(0.2, abs=1e-14)


def test_the_loops_are_as_many_as_joints_beyond_a_tree():
    for mechanism, loops in ((four_bar(SQUARE), 1), (chain_of_four_bars(5), 5)):
        assert len(assembled(mechanism).linkage.loops) == loops
    triple = linkage([("R", "012", (0, 0)), ("R", "01", (1, 0))])
    body = assembled(triple).linkage
    assert (len(body.elements), len(body.loops)) == (3, 1)


def test_the_size_is_the_spread_of_the_joints():
    assert size_of(four_bar([(0, 0), (2, 0), (2, 2), (0, 2)])) == pytest.approx(np.sqrt(2))
    assert size_of(linkage([("P", "01", None, (1, 0, 0))])) == 1.0


def test_what_is_missing_is_named():
    mechanism = linkage([("R", "01", (0, 0)), ("R", "12", None), ("P", "20", (1, 0))])
    assert missing_geometry(mechanism) == ("1", "2")
    with pytest.raises(InputError, match="no geometry for joint 1, 2, expected"):
        assembled(mechanism)


def test_parts_that_no_joint_connects():
    mechanism = linkage([("R", "12", (0, 0)), ("R", "34", (1, 0)), ("R", "23", (1, 0)), ("R", "56", (0, 1))])
    assert mechanism.graph.parts == (("0",), ("1", "2", "3", "4"), ("5", "6"))
    found = mobility_of(mechanism)
    assert (found.verdict, found.mobility) == ("disconnected", None)
    assert found.note.startswith("no joint holds the mechanism to its ground, 0")
    floating = mobility_of(linkage([("R", "01", (0, 0)), ("R", "23", (1, 0))]))
    assert floating.note.startswith("no joint leads from the ground to 2, 3")


@pytest.mark.parametrize(
    ("joint", "said"),
    [(("R", "01", (0, 0), (0, 0.1, 1)), "joint 0 is not at right angles to the plane by 5.71°"),
     (("P", "01", (0, 0), (0, 1, 1)), "joint 0 is out of the plane by 45°")],
)  # fmt: skip
def test_axes_that_are_not_the_planes(joint, said):
    with pytest.raises(InputError) as caught:
        mobility_of(linkage([joint, ("R", "12", (1, 0))]))
    assert said in str(caught.value)
    assert "expected space: spatial" in str(caught.value)


def test_axes_that_miss_the_centre_of_a_sphere():
    axes = [((0, 0, 0), (1, 0, 0)), ((0, 0, 0), (0, 1, 0)), ((0, 0, 0.5), (1, 1, 0)), ((0, 0, 0), (0, 1, 1))]
    skew = linkage([("R", (str(i), str((i + 1) % 4)), p, z) for i, (p, z) in enumerate(axes)], "spherical")
    assert "misses the point where the others meet" in space_fault(skew)
    met = linkage([("R", (str(i), str((i + 1) % 4)), (0, 0, 0), z) for i, (_, z) in enumerate(axes)], "spherical")
    assert space_fault(met) is None


def test_slips_of_the_pen():
    assert slips_of(four_bar(SQUARE)) == ()
    assert slips_of(four_bar([(0, 0), (0, 0), (4, 3), (5, 0)])) == (
        "joints 0 and 1 lie in the same place: link 1 has no length and turns freely",
    )
    twice = linkage([("R", "01", (0, 0)), ("R", "01", (0, 0)), ("R", "12", (1, 0))])
    assert slips_of(twice) == ("joints 0 and 1 both join 0 and 1 in the same place: one of them does nothing",)
    balls = linkage([("S", "01", (0, 0, 1)), ("S", "12", (0, 0, 1))], "spatial")
    assert "link 1 has no length" in slips_of(balls)[0]
    wrist = linkage([("R", "01", (0, 0, 0), (1, 0, 0)), ("R", "12", (0, 0, 0), (0, 1, 0))], "spatial")
    assert slips_of(wrist) == ()
