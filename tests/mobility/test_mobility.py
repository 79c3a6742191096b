"""True mobility: where the count is right, special, singular, shaky, or nearly; and what must not matter."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import pytest
from mobility.linkages import bennett, chain_of_four_bars, four_bar, generic_loop, linkage, loop, slider_crank
from sweeps import sweep

import robokin
from robokin.errors import InputError
from robokin.kernel.ranks import LOOP_RANK
from robokin.mobility.count import grubler, grubler_by_constraints
from robokin.mobility.verdict import mobility_of
from robokin.model import Mechanism


@pytest.mark.parametrize("order", [3, 6])
def test_both_forms_of_the_count_agree(order, rng):
    for _ in range(50):
        links, f = int(rng.integers(1, 20)), rng.integers(0, order + 1, rng.integers(0, 30)).tolist()
        assert grubler(order, links, f) == grubler_by_constraints(order, links, f)


@pytest.mark.parametrize(("count", "mobility"), [(5, 0), (6, 0), (7, 1), (8, 2), (9, 3)])
def test_a_ring_without_anything_special(count, mobility):
    for seed in range(5):
        found = mobility_of(generic_loop(count, seed))
        assert (found.count, found.mobility) == (count - 6, mobility)
        assert found.verdict in ("right", "exceptional")
        assert found.redundant == 0 or count == 5


def test_five_hinges_are_no_mechanism_and_lock_each_other():
    found = mobility_of(generic_loop(5))
    assert (found.count, found.mobility, found.redundant) == (-1, 0, 1)


def test_planar_rings():
    assert mobility_of(four_bar([(0, 0), (1, 2), (4, 3), (5, 0.5)])).mobility == 1
    assert mobility_of(four_bar([(0, 0), (1, 2), (4, 3), (5, 0.5), (3, -1)])).mobility == 2
    assert mobility_of(slider_crank()).mobility == 1


@pytest.mark.parametrize("wrong", [1e-3, 1e-6, 3e-8])
def test_bennett_s_linkage_nearly(wrong):
    """Off by more than LOOP_RANK it is rigid, and the answer says by how much it misses."""
    found = mobility_of(bennett(wrong))
    assert (found.verdict, found.mobility) == ("nearly", 0)
    assert 0.1 * wrong < found.motion.gap[0] < 10 * wrong
    assert "would have 1 freedom if its dimensions were exact" in found.note


@pytest.mark.parametrize("wrong", [0.0, 1e-12, 1e-10, 1e-9, 3e-9, 8e-9])
def test_bennett_s_linkage_exactly(wrong):
    assert LOOP_RANK == 1e-8
    found = mobility_of(bennett(wrong))
    assert (found.verdict, found.mobility, found.redundant, found.count) == ("exceptional", 1, 3, -2)
    assert found.motion.gap[0] > 0.1
    assert found.motion.gap[1] < LOOP_RANK


@pytest.mark.parametrize("space", ["planar", "spatial"])
def test_a_shaky_triangle(space):
    axes = [(np.array([x, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])) for x in (0.0, 1.0, 2.5)]
    found = mobility_of(loop(axes, space))
    assert (found.motion.instantaneous, found.mobility, found.verdict) == (1, 0, "shaky")
    assert "leads nowhere" in found.note


def test_a_flat_parallelogram():
    found = mobility_of(four_bar([(0, 0), (1, 0), (4, 0), (3, 0)]))
    assert (found.motion.instantaneous, found.motion.generic, found.mobility) == (2, 1, 1)
    assert found.verdict == "singular"
    assert found.note == (
        "singular pose: 2 instantaneous freedoms here, 1 away from it; 2 branches of configurations meet in it, of 1 "
        "freedom each"
    )


@pytest.mark.parametrize("seed", range(4))
def test_the_answer_does_not_hang_on_the_seed(seed):
    for name, mobility in (("sarrus", 1), ("3-upu-snu", 3), ("shaky-triangle-on-a-hinge", 1), ("tripteron", 3)):
        assert mobility_of(robokin.load_mechanism(name), seed=seed).mobility == mobility


def test_the_mobility_is_the_count_and_the_redundant_constraints():
    """At a regular pose, in the space that the count is made in."""
    for mechanism in (generic_loop(6), generic_loop(5), bennett(), slider_crank(), chain_of_four_bars(3),
                      robokin.load_mechanism("orthoglide"), robokin.load_mechanism("6-sps")):  # fmt: skip
        found = mobility_of(mechanism)
        assert found.mobility == found.count + found.redundant


def test_a_planar_linkage_counted_in_space_has_three_more_redundant_constraints_a_loop():
    flat = chain_of_four_bars(2)
    spatial = mobility_of(replace(flat, space="spatial"))
    assert (spatial.count, spatial.mobility, spatial.redundant) == (2 - 6, 2, 6)


def relabelled(mechanism: Mechanism, rng) -> Mechanism:
    """The same mechanism with its links, its joints and each joint's links in another order."""
    joints = [replace(joint, links=tuple(rng.permutation(joint.links).tolist())) for joint in mechanism.joints]
    order = rng.permutation(len(joints))
    links = tuple(rng.permutation(mechanism.links).tolist())
    return replace(mechanism, links=links, joints=tuple(joints[i] for i in order))


def scaled(mechanism: Mechanism, k: float) -> Mechanism:
    joints = [replace(joint, at=None if joint.at is None else k * joint.at, pitch=k * joint.pitch)
              for joint in mechanism.joints]  # fmt: skip
    return replace(mechanism, joints=tuple(joints))


@pytest.mark.parametrize("k", sweep([1e-6, 1e-3, 1e3, 1e6], 4))
def test_neither_order_nor_size_matters(k, rng):
    for mechanism in (bennett(), bennett(1e-6), generic_loop(6), slider_crank(),
                      four_bar([(0, 0), (1, 0), (4, 0), (3, 0)])):  # fmt: skip
        plain = mobility_of(mechanism)
        for other in (scaled(mechanism, k), relabelled(mechanism, rng), scaled(relabelled(mechanism, rng), k)):
            found = mobility_of(other)
            assert (found.mobility, found.verdict, found.redundant) == (
                plain.mobility, plain.verdict, plain.redundant,
            )  # fmt: skip


def test_a_chain_of_200_links():
    mechanism = chain_of_four_bars(66)
    assert len(mechanism.links) == 199
    start = time.process_time()
    found = mobility_of(mechanism)
    assert time.process_time() - start < 10.0
    assert (found.count, found.mobility, found.verdict) == (66, 66, "right")


def test_drives_that_suffice_and_drives_that_do_not():
    five = [(0, 0), (1, 2), (4, 3), (5, 1), (4, 0)]
    one, two = ([replace(joint, actuated=i in chosen) for i, joint in enumerate(four_bar(five).joints)]
                for chosen in ((0,), (0, 4)))  # fmt: skip
    assert mobility_of(replace(four_bar(five), joints=tuple(one))).undriven == 1
    assert mobility_of(replace(four_bar(five), joints=tuple(two))).undriven == 0
    assert mobility_of(four_bar(five)).undriven is None


def test_dead_joints_are_named():
    """A triangle on a hinge turns, and its own hinges never do."""
    found = mobility_of(linkage([("R", "01", (0, 0)), ("R", "12", (1, 0)), ("R", "23", (3, 0)), ("R", "31", (2, 2))]))
    assert (found.mobility, found.dead) == (1, ("1", "2", "3"))


def test_what_cannot_be_asked():
    with pytest.raises(InputError, match=r"unknown link 'crnk'.*did you mean 'crank'"):
        mobility_of(robokin.load_mechanism("four-bar"), ("crnk", "ground"))
    with pytest.raises(InputError, match="twice, expected two different links"):
        mobility_of(robokin.load_mechanism("four-bar"), ("crank", "crank"))
