"""Mechanisms of the literature have the freedom that their sources give them, in any order, size and place."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest
from mobility import literature, variations
from mobility.linkages import linkage, unit
from mobility.test_library import anywhere
from sweeps import sweep

from robokin.mobility.trace import trace
from robokin.mobility.verdict import mobility_of
from robokin.model import Mechanism, MechanismJoint

ENTRIES = [*literature.entries(), *variations.entries()]


def dimensions(found):
    return [size for size, _ in found.branches]


@pytest.mark.parametrize("name, mechanism, branches, order", sweep(ENTRIES, 3), ids=[name for name, *_ in ENTRIES])
def test_the_freedom_is_that_of_the_literature(name, mechanism, branches, order):
    for found in (mobility_of(mechanism), mobility_of(anywhere(mechanism, np.random.default_rng(3), 1e3))):
        assert dimensions(found) == branches
        assert found.mobility == branches[0]
        assert (found.motion.order, found.verdict == "shaky") == (order, order is not None)


def test_no_loop_goes_through_a_link_that_only_hangs_on_a_pin():
    """A flat parallelogram and a four-bar share a pin with a link that dangles: in any order these are four blocks."""
    for links in list(permutations(("l", "b", "x", "y", "z")))[::13]:
        found = mobility_of(linkage([
            ("R", ("0", "l"), (0, 0)), ("R", ("b", "r"), (4, 0)), ("R", ("r", "0"), (3, 0)), ("R", links, (1, 0)),
            ("R", ("x", "u"), (2, 2)), ("R", ("u", "v"), (3, 3.5)), ("R", ("v", "y"), (0.2, 3)),
        ]))  # fmt: skip
        assert (found.mobility, found.count, dimensions(found)) == (4, 4, [4, 4])
        assert sorted(len(part.block.elements) for part in found.motion.parts) == [1, 1, 4, 4]


def test_a_traced_pin_is_measured_from_its_first_link():
    """The first link dangles, so the pin's pairs leave it out; its columns are those of the others against it."""
    joints = [("R", ("0", "l"), (0, 0)), ("R", ("b", "r"), (4, 1)), ("R", ("r", "0"), (3, 0))]
    moved = trace(linkage([*joints, ("R", ("z", "l", "b", "x"), (1, 1))]), 4, drive="0")
    turns = np.unwrap(np.arctan2(moved.poses[..., 1, 0], moved.poses[..., 0, 0]), axis=0)
    at = dict(zip(moved.links, turns.T, strict=True))
    columns = [moved.labels.index(f"3.{k}") for k in (1, 2, 3)]
    off = moved.values[:, columns] - np.stack([at[name] - at["z"] for name in ("l", "b", "x")], axis=1)
    assert np.max(np.abs(np.sin(0.5 * off))) < 1e-9


@pytest.mark.parametrize("scale", [1e-6, 1e-3, 1.0, 1e3])
def test_screws_in_one_point_have_their_pitch_for_size(scale):
    rng = np.random.default_rng(6)
    at = scale * rng.normal(size=3)
    joints = [MechanismJoint(str(i), "helical", (str(i), str((i + 1) % 7)), 1, at, unit(rng.normal(size=3))[None],
                             scale * (0.05 + 0.01 * i)) for i in range(7)]  # fmt: skip
    found = mobility_of(Mechanism("screws", "spatial", tuple("0123456"), tuple(joints), "0"))
    assert (found.mobility, found.verdict) == (1, "right")
    assert found.motion.gap[0] > 0.01


def test_hinges_through_one_point_beside_others_are_of_no_size():
    """Rounding of a point that is not the linkage's middle is neither a distance nor a pitch."""
    for seed in range(12):
        rng = np.random.default_rng(seed)
        at, away = rng.normal(size=3), rng.normal(size=3)
        hinges = [("R", pair, at, rng.normal(size=3)) for pair in (("0", "a"), ("a", "b"), ("b", "c"), ("c", "0"))]
        found = mobility_of(linkage([*hinges, ("R", ("0", "d"), at + away, away)], "spatial"))
        assert (found.mobility, found.verdict) == (2, "exceptional")
        assert found.motion.gap[0] > 1e-3
        truss = [("R", pair, at, z) for pair, z in ((("0", "a"), (1, 0, 0)), (("a", "b"), (1, 1, 1)),
                                                    (("b", "0"), (0, 1, 1)))]  # fmt: skip
        flat = mobility_of(linkage([*truss, ("R", ("0", "d"), at + away, away)], "spatial"))
        assert (flat.mobility, flat.motion.order) == (1, 2)
