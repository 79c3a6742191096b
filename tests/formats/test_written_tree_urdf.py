"""A tree that is written as URDF is read as the same tree: poses of its tips, limits, order of q."""

from __future__ import annotations

from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
from sweeps import sweep

import robokin
from robokin.errors import InputError
from robokin.formats import library_names, load_any, read_text
from robokin.formats.description_lines import different_names
from robokin.formats.urdf import read_urdf
from robokin.formats.written_tree_urdf import tree_urdf
from robokin.formats.written_urdf import valid_name
from robokin.model import Tree
from robokin.model.graph import Tip

from .drawn_trees import drawn_tree, tips_apart, values_of

SAME = 1e-12
TREES = [name for name in library_names() if isinstance(load_any(name), Tree)]


def read_again(tree):
    """The tree that is read from the URDF of one, with the same tips: links by their names."""
    back = read_urdf(tree_urdf(tree), "a.urdf", exact=True)
    names = different_names(valid_name(tip.name, f"tip_{i}", "link") for i, tip in enumerate(tree.graph.tips, start=1))
    tips = tuple(Tip(name, back.graph.links.index(name)) for name in names)
    same = replace(back, graph=replace(back.graph, tips=tips))
    q = values_of(tree, np.random.default_rng(1))
    assert back.types == tree.types
    assert tips_apart(tree, q, same, q) <= SAME
    far = np.abs(tree.limits) > 9e5
    assert np.array_equal(far, np.abs(back.limits) > 9e5)
    np.testing.assert_allclose(back.limits[~far], tree.limits[~far], rtol=1e-14, atol=1e-300)
    return back


@pytest.mark.parametrize("name", TREES)
def test_trees_of_the_library(name):
    tree = robokin.load_tree(name)
    back = read_again(tree)
    # A URDF names no tips: its readers take the last links.
    assert {*tree.tips} <= {*back.graph.links}
    assert [joint.name for joint in back.joints] == [joint.name for joint in tree.joints]


@pytest.mark.parametrize("seed", sweep(range(20), 5))
def test_random_trees(seed):
    rng = np.random.default_rng([seed, 3])
    for _ in range(30):
        tree = drawn_tree(rng, helical=False, adds=False)
        read_again(tree)


@pytest.mark.parametrize("seed", sweep(range(10), 5))
def test_names_that_no_link_has(seed):
    rng = np.random.default_rng([seed, 4])
    for _ in range(30):
        tree = drawn_tree(rng, helical=False, adds=False, hostile=True)
        read_again(tree)
        root = ElementTree.fromstring(tree_urdf(tree))
        for kind in ("link", "joint"):
            names = [one.get("name") for one in root.findall(kind)]
            assert len(names) == len({*names})
            assert all(name[0].isascii() and name[0].isalpha() for name in names)


def test_a_urdf_that_was_read_is_written_with_its_links_and_joints():
    text = """\
<robot name="gripper">
  <link name="body"/><link name="left"/><link name="right"/><link name="camera"/>
  <joint name="grip" type="prismatic"><parent link="body"/><child link="left"/>
    <origin xyz="0 0.1 0" rpy="0 0.2 0"/><axis xyz="0 1 0"/><limit lower="0" upper="0.04"/></joint>
  <joint name="other" type="prismatic"><parent link="body"/><child link="right"/>
    <axis xyz="0 1 0"/><limit lower="-0.04" upper="0"/><mimic joint="grip" multiplier="-1" offset="0.001"/></joint>
  <joint name="eye" type="fixed"><parent link="body"/><child link="camera"/><origin xyz="0 0 1"/></joint>
</robot>
"""
    tree = read_urdf(text, "gripper.urdf")
    back = read_again(tree)
    assert back.graph.links == tree.graph.links
    assert [joint.name for joint in back.graph.joints] == [joint.name for joint in tree.graph.joints]
    assert back.tips == tree.tips
    assert back.graph.couplings == tree.graph.couplings


PAIR = """\
robokin: 1
name: pair
branches:
  a: {joints: [{name: p, type: R}, {name: q, type: R, a: 1}, {name: r, type: R, a: 1}]}
couplings:
"""


@pytest.mark.parametrize(
    ("couplings", "message"),
    [
        ("[{joint: r, adds: p}]", "joint a.r moves with a.p, a.r, expected joints that move by themselves"),
        ("[{joint: r, follows: {p: 1, q: 2}}]", "joint a.r moves with a.p, a.q, expected"),
    ],
)
def test_what_a_urdf_cannot_say_is_said(couplings, message):
    with pytest.raises(InputError, match=message):
        tree_urdf(read_text(PAIR.replace("couplings:\n", f"couplings: {couplings}\n")))


def test_a_screw_has_no_type_in_a_urdf():
    rng = np.random.default_rng(5)
    tree = next(tree for tree in iter(lambda: drawn_tree(rng), None) if "H" in tree.types)
    with pytest.raises(InputError, match="is helical, which a URDF has no type for; -f yaml holds it"):
        tree_urdf(tree)


def test_joints_that_follow_in_a_chain_mimic_the_one_that_moves():
    text = PAIR.replace(
        "couplings:\n", "couplings: [{joint: r, follows: q, ratio: 2}, {joint: q, follows: p, offset: 1}]\n"
    )
    (first, second) = ElementTree.fromstring(tree_urdf(read_text(text))).iter("mimic")
    assert dict(first.items()) == {"joint": "a.p", "multiplier": "1", "offset": "1"}
    assert dict(second.items()) == {"joint": "a.p", "multiplier": "2", "offset": "2"}


def test_couplings_that_cancel_leave_their_offset():
    """r adds p - q, and q is p + 1: r moves by itself, one radian back, and so do the limits of its motion."""
    text = PAIR.replace(
        "couplings:\n", "couplings: [{joint: q, follows: p, offset: 1}, {joint: r, adds: {p: 1, q: -1}}]\n"
    )
    text = text.replace("{name: r, type: R, a: 1}", "{name: r, type: R, a: 1, limits: [-9, 9], motion_limits: [-2, 2]}")
    back = read_again(read_text(text))
    np.testing.assert_allclose(back.limits[1], [-1.0, 3.0], atol=1e-15)
