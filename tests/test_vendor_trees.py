"""Hands and torsos of the library against poses that Pinocchio and MuJoCo find in their makers' own descriptions."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import data

import robokin

VENDORS = data("vendor_trees.json")
NEAR = 1e-9
"""How near tips have to come [m, or entries of a rotation] where the source is not rounded further."""

CHAINS_OF_THEIR_OWN = [
    ("allegro-hand", "index", "allegro-index"),
    ("allegro-hand", "thumb", "allegro-thumb"),
    ("leap-hand", "index", "leap-index"),
    ("leap-hand", "thumb", "leap-thumb"),
    ("yumi", "left", "yumi-left"),
    ("yumi", "right", "yumi-right"),
]

EVERY_ENTRY = pytest.mark.parametrize("entry", VENDORS, ids=lambda entry: entry["id"])


@EVERY_ENTRY
def test_every_tip_is_where_the_makers_description_has_it(entry):
    tree = robokin.load_tree(entry["id"])
    assert tree.tips == tuple(entry["tips"])
    for row in entry["rows"]:
        found = robokin.tip_poses(tree, row["q"])
        for place, numbers in zip(found, row["poses"].values(), strict=True):
            np.testing.assert_allclose(place[:3], np.reshape(numbers, (3, 4)), atol=entry.get("tolerance", NEAR))


@EVERY_ENTRY
def test_the_limits_are_the_makers(entry):
    tree = robokin.load_tree(entry["id"])
    np.testing.assert_allclose(tree.limits, entry["limits"], atol=5e-6)


@EVERY_ENTRY
def test_the_source_is_told_and_its_licence(entry):
    assert all(entry[key] for key in ("repository", "file", "commit", "licence", "peer", "base"))
    source = " ".join(robokin.load_tree(entry["id"]).source.split())
    assert entry["repository"] in source
    assert entry["licence"].split()[0].rstrip(";") in source


@EVERY_ENTRY
def test_named_poses_are_within_the_limits_and_nothing_looks_like_a_slip(entry):
    tree = robokin.load_tree(entry["id"])
    assert not tree.notes
    for name, pose in tree.poses.items():
        assert tree.within_limits(pose), name


@pytest.mark.parametrize("hand", ["allegro-hand", "leap-hand", "shadow-hand"])
def test_a_fist_brings_the_fingertips_near_the_palm(hand):
    tree = robokin.load_tree(hand)
    reach = {name: np.linalg.norm(robokin.tip_poses(tree, q)[:, :3, 3], axis=1) for name, q in tree.poses.items()}
    fingers = slice(0, -1)  # the thumb is the last tip
    assert np.all(reach["fist"][fingers] < 0.75 * reach["open"][fingers])


@pytest.mark.parametrize(("name", "tip", "chain"), CHAINS_OF_THEIR_OWN)
def test_a_finger_or_an_arm_is_that_of_its_own_file(name, tip, chain):
    """Limits there are printed to a degree or three digits."""
    whole, alone = robokin.load(name, tip=tip), robokin.load(chain)
    q = np.random.default_rng(560).uniform(-1.0, 1.0, (20, whole.n))
    np.testing.assert_allclose(robokin.forward_kinematics(whole, q), robokin.forward_kinematics(alone, q), atol=1e-14)
    np.testing.assert_allclose(whole.limits, alone.limits, atol=0.015)


def test_baxters_arms_mirror_each_other_and_its_fingers_close_on_the_tip():
    tree = robokin.load_tree("baxter")
    arms = {side: robokin.load("baxter", tip=side) for side in ("left", "right")}
    q = np.random.default_rng(560).uniform(-1.0, 1.0, (20, 7))
    mirrored = q * [-1, 1, -1, 1, -1, 1, -1]
    left = robokin.forward_kinematics(arms["left"], q)[..., :3, 3]
    right = robokin.forward_kinematics(arms["right"], mirrored)[..., :3, 3]
    np.testing.assert_allclose(left * [1, -1, 1], right, atol=1e-14)
    followers = [coupling.joint for coupling in tree.graph.couplings]
    assert followers == ["left-finger-2.slide", "right-finger-2.slide"]
    assert (tree.n, tree.types) == (17, "RRRRRRRRPRRRRRRRP")
