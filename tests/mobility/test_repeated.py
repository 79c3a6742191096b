"""Branches along which constraints vanish many times: structures that tremble while what carries them moves."""

from __future__ import annotations

import numpy as np
import pytest
from mobility import known
from mobility.linkages import linkage
from mobility.test_library import anywhere
from sweeps import sweep

from robokin.errors import InputError
from robokin.mobility.trace import trace
from robokin.mobility.verdict import mobility_of


def carried(mechanism):
    """A planar mechanism on the coupler of a parallelogram, its last joint with the ground on a second coupler that
    moves alike, so that all of it is one block."""
    letters = {"revolute": "R", "prismatic": "P"}
    last = max(i for i, joint in enumerate(mechanism.joints) if "0" in joint.links)
    joints = []
    for i, joint in enumerate(mechanism.joints):
        links = tuple(("other carrier" if i == last else "carrier") if name == "0" else name for name in joint.links)
        axis = [tuple(joint.axes[0])] if joint.type == "prismatic" else []
        joints.append((letters[joint.type], links, tuple(joint.at[:2]), *axis))
    for crank, x in (("left", -5.0), ("right", -4.0)):
        joints += [("R", ("0", crank), (x, 0.0)), ("R", (crank, "carrier"), (x + 0.6, 1.5)),
                   ("R", (crank, "other carrier"), (x + 0.6, 1.5))]  # fmt: skip
    return linkage(joints)


P, AXIS = known.inflection_point(known.FOUR_BAR, 0.3)
CARRIED = {
    "a stretched chain": (known.collinear([0.0, 1.0, 2.5]), 2),
    "a stretched chain of three": (known.collinear([0.0, 1.0, 2.0, 3.5]), 2),
    "a point of inflection": (known.slotted(known.FOUR_BAR, P, AXIS), 3),
    "a cascade of two": (known.cascade(2), 4),
    "Watt's point": (linkage(known.watt()), 5),
}


@pytest.mark.parametrize("name", sweep(CARRIED, 2))
def test_what_trembles_on_a_parallelogram_moves_with_it_alone(name):
    mechanism, order = CARRIED[name]
    made = carried(mechanism)
    rng = np.random.default_rng(len(name))
    for each in (made, anywhere(made, rng, 1e-3), anywhere(made, rng, 1e3)):
        found = mobility_of(each)
        assert (found.mobility, found.verdict, found.motion.order) == (1, "shaky", order)
        assert [size for size, _ in found.branches] == [1]
        motion, frame = found.motion, found.assembly.linkage
        assert np.max(np.abs(frame.lack(motion.state))) < 1e-12, "the branch's point is assembled"
        assert np.max(np.abs(frame.jacobian(motion.state) @ motion.tangent)) < 1e-7
    moving = {joint.name for joint in made.joints if "left" in joint.links or "right" in joint.links}
    assert set(mobility_of(made).branches[0][1]) == moving


def test_undecided_says_between_what_it_is():
    """Constraints of order 8 are below rounding at half of the way to the pose."""
    found = mobility_of(carried(known.cascade(3)))
    assert found.verdict == "undecided"
    assert found.mobility is None
    assert (found.motion.finite, found.motion.most) == (0, 1)
    assert "at least 0 and at most 1 is a motion" in found.note


def test_what_trembles_stays_where_it_is_as_the_rest_is_traced():
    mechanism = carried(linkage(known.watt()))
    moved = trace(mechanism, 5, drive="6")
    dead = [i for i, label in enumerate(moved.labels) if int(label) < 6]
    assert np.max(np.abs(moved.values[:, dead])) < 1e-9
    assert np.max(np.abs(moved.values)) > 1.0
    with pytest.raises(InputError, match="joint 0 does not move"):
        trace(mechanism, 5, drive="0")
    with pytest.raises(InputError, match="it is undecided whether"):
        trace(carried(known.cascade(3)), 5)
