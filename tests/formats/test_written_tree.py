"""A tree that is written as branches loads again: the same tips at every q, limits, order and names."""

from __future__ import annotations

import numpy as np
import pytest
from sweeps import sweep

import robokin
from robokin.errors import InputError
from robokin.formats import library_names, load_any, read_text
from robokin.formats.tree_bodies import bodies_of
from robokin.formats.tree_branches import branches_of
from robokin.formats.written_tree import written_tree
from robokin.model import Tree
from robokin.model.graph import Coupling, Graph, GraphJoint, Tip

from .drawn_trees import drawn_tree, tips_apart, values_of

SAME = 1e-12
CONVENTIONS = ("frames", "standard", "modified")
TREES = [name for name in library_names() if isinstance(load_any(name), Tree)]


def read_again(tree, convention):
    """The tree that is read from what is written of one, which it must be, and its parts."""
    parts = branches_of(tree, convention)
    text = written_tree(parts)
    back = read_text(text)
    assert isinstance(back, Tree), text
    rng = np.random.default_rng(1)
    q = values_of(tree, rng)
    order = [*parts.order]
    assert sorted(order) == [*range(tree.n)]
    assert back.n == tree.n
    snapped = 0.0 if not parts.notes else 1e-8
    assert tips_apart(tree, q, back, q[:, order]) <= SAME + snapped, text
    assert back.types == "".join(tree.types[place] for place in order)
    some = values_of(tree, rng, 50)
    assert np.array_equal(back.within_limits(some[:, order]), tree.within_limits(some))
    assert len(back.tips) == len(tree.tips)
    limits = np.clip(tree.limits[order], -1e6, 1e6)
    unlimited = np.isinf(tree.limits[order]).all(axis=1) & np.isinf(back.limits).all(axis=1)
    np.testing.assert_allclose(np.clip(back.limits, -1e6, 1e6)[~unlimited], limits[~unlimited], rtol=1e-14, atol=1e-300)
    for name, pose in tree.poses.items() if tree.n else ():
        np.testing.assert_allclose(back.poses[name], pose[order], rtol=4e-16, atol=0.0)
    return parts, back


@pytest.mark.parametrize("convention", CONVENTIONS)
@pytest.mark.parametrize("name", TREES)
def test_trees_of_the_library_load_again(name, convention):
    tree = robokin.load_tree(name)
    parts, back = read_again(tree, convention)
    assert parts.order == tuple(range(tree.n))
    assert [joint.name for joint in back.joints] == [joint.name for joint in tree.joints]
    assert back.tips == tree.tips
    assert (back.name, back.description, back.source) == (tree.name, tree.description, tree.source)
    assert back.units == tree.units


@pytest.mark.parametrize("convention", CONVENTIONS)
@pytest.mark.parametrize("seed", sweep(range(20), 7))
def test_random_trees_load_again(seed, convention):
    rng = np.random.default_rng(seed)
    for _ in range(20):
        tree = drawn_tree(rng)
        _, back = read_again(tree, convention)
        assert back.tips == tree.tips
        assert back.units == tree.units


@pytest.mark.parametrize("seed", sweep(range(10), 5))
def test_names_that_descriptions_cannot_hold(seed):
    rng = np.random.default_rng([seed, 1])
    for _ in range(30):
        read_again(drawn_tree(rng, hostile=True), "frames")


@pytest.mark.parametrize("seed", sweep(range(10), 5))
def test_what_has_been_read_is_written_with_the_same_branches(seed):
    """Joints called `branch.joint` keep their names and their order, whatever stands on which of them."""
    rng = np.random.default_rng([seed, 2])
    for _ in range(10):
        _, tree = read_again(drawn_tree(rng), CONVENTIONS[rng.integers(3)])
        parts, back = read_again(tree, CONVENTIONS[rng.integers(3)])
        assert parts.order == tuple(range(tree.n))
        assert [joint.name for joint in back.joints] == [joint.name for joint in tree.joints]
        assert back.graph.links == tree.graph.links
        assert back.tips == tree.tips


FINGERS = """\
robokin: 1
name: Two fingers
units: {length: mm, angle: deg}
branches:
  palm: {joints: [{name: wrist, type: R, alpha: 90}, {name: plate, type: fixed, a: 10}, {name: bend, type: P}]}
  index:
    on: palm.wrist
    base: Trans(90, 20, 0)
    joints: [{name: mcp, type: R, a: 45, limits: [-10, 90]}, {name: pip, type: R, a: 26}, {name: dip, type: R, a: 20}]
  screw: {on: palm, joints: [{type: R}, {name: advance, type: P}], tool: "Trans(1, 0, 0)"}
couplings:
  - {joint: index.dip, follows: pip, ratio: 2/3}
  - {joint: advance, follows: {screw.1: 5/360, bend: 1}, offset: 7}
tips: [index, {name: knuckle, on: index.mcp, tool: "Trans(0, 0, 5)"}, {name: eye, on: base, tool: "Rot(z, 90)"}, palm]
"""


@pytest.mark.parametrize("convention", CONVENTIONS)
def test_branches_on_joints_and_tips_anywhere(convention):
    tree = read_text(FINGERS)
    parts, back = read_again(tree, convention)
    assert [branch.on for branch in parts.branches] == ["", "palm.wrist", "palm"]
    assert [joint.name for joint in back.joints] == [joint.name for joint in tree.joints]
    assert back.tips == tree.tips
    text = written_tree(parts)
    assert "{joint: index.dip, follows: index.pip, ratio: 2/3}" in text
    assert "{joint: screw.advance, follows: {screw.1: 1/72, palm.bend: 1}, offset: 7}" in text
    assert '- {name: eye, on: base, tool: "Rot(z, 90)"}' in text


NAMES = """\
robokin: 1
name: "yes"
branches:
  a: {joints: [{name: "2", type: R, a: 1}, {name: "1", type: R, a: 1}, {name: "yes", type: R, a: 1}]}
  "yes": {on: a.2, joints: [{type: R, a: 2}]}
  "no": {on: a.yes, joints: [{name: x.y, type: R, a: 2}]}
  "null": {on: "yes", joints: [{type: R, a: 2}], tool: "Rot(z, 1)"}
couplings: [{joint: null.1, follows: {a.2: 1, yes.1: 2}}]
tips: [a, "no", "null", {name: "on", on: base}, {name: "1e3", on: no.x.y}, base]
"""


@pytest.mark.parametrize("convention", CONVENTIONS)
def test_names_that_mean_something_to_yaml(convention):
    tree = read_text(NAMES)
    parts, back = read_again(tree, convention)
    assert back.tips == tree.tips
    assert back.graph.links == tree.graph.links
    text = written_tree(parts)
    assert '  "yes":\n    on: a.2\n' in text
    assert 'tips:\n  - a\n  - "no"\n  - "null"\n  - {name: "on", on: base}\n  - {name: "1e3", on: no.x.y' in text
    assert text.endswith("  - base\n")


@pytest.mark.parametrize("convention", CONVENTIONS)
def test_branches_without_lengths(convention):
    text = "robokin: 1\nname: w\nbranches:\n  a: {joints: [{type: R, alpha: 1}, {type: R, alpha: -1}, {type: R}]}\n"
    more = "  b: {on: a, joints: [{type: R, alpha: 1}, {type: P}]}\n  c: {on: a, joints: [{type: P}, {type: P}]}\n"
    read_again(read_text(text + more), convention)


def test_a_branch_without_a_table_stays_one_of_frames():
    """Axes 1e-4 rad from parallel; the other branch has its table."""
    text = """\
robokin: 1
name: two
convention: frames
branches:
  a: {joints: [{type: R}, {type: R, origin: "Trans(0.4, 0.01, 0) RPY(0.0001, 0, 0)"}]}
  b: {joints: [{type: R}, {type: R, origin: "Trans(1, 0, 0)"}]}
  c: {joints: [{type: R}, {type: R, origin: "Trans(1, 0, 0)"}]}
"""
    parts, _ = read_again(read_text(text), "standard")
    assert [branch.chain.convention for branch in parts.branches] == ["frames", "standard", "standard"]
    (note,) = parts.notes
    assert "0.0001 rad from parallel" in note.message
    assert "two, a" in note.message
    assert "    convention: frames\n" in written_tree(parts)


def turn(name, parent, child, **more):
    return GraphJoint(name, "revolute", parent, child, **more)


def test_joints_that_no_variable_moves_are_fixed():
    """A joint that follows one which is fixed, and one that follows that."""
    joints = (turn("a", 0, 1), turn("b", 1, 2, after=np.diag([1.0, -1.0, -1.0, 1.0])), turn("c", 2, 3), turn("d", 3, 4))
    couplings = (Coupling("b", (), 0.3), Coupling("c", (("b", 2.0), ("a", 1.0)), 0.1), Coupling("d", (), 0.5, own=True))
    graph = Graph(("0", "1", "2", "3", "4"), joints, tips=(Tip("t", 4),), couplings=couplings)
    parts, back = read_again(Tree("held", graph), "frames")
    assert [row.name for row in parts.branches[0].chain.rows] == ["a", "c", "d"]
    assert back.n == 2


def test_nothing_moves():
    graph = Graph(
        ("0", "1"), (GraphJoint("f", "fixed", 0, 1, 0, np.diag([1.0, -1.0, -1.0, 1.0])),), tips=(Tip("1", 1),)
    )
    parts, back = read_again(Tree("", graph, "stone"), "standard")
    assert (parts.order, back.n, back.name) == ((), 0, "stone")


def test_what_is_no_tree_is_refused():
    loop = Graph(("0", "1", "2"), (turn("a", 0, 1), turn("b", 0, 2), turn("c", 1, 2)))
    with pytest.raises(InputError, match="several joints lead to the link 2"):
        bodies_of(loop)
    apart = Graph(("0", "1", "2", "3"), (turn("a", 0, 1), turn("b", 2, 3)))
    with pytest.raises(InputError, match="no joints lead from the root to joint b"):
        bodies_of(apart)
    ball = Graph(("0", "1"), (GraphJoint("a", "spherical", 0, 1, 3),), tips=(Tip("1", 1),))
    with pytest.raises(InputError, match="joint a is spherical"):
        branches_of(Tree("ball", ball))
    many = tuple(turn(f"j{i}", i, i + 1) for i in range(1001))
    with pytest.raises(InputError, match="1001 rows in all branches, expected at most 1000"):
        written_tree(branches_of(Tree("snake", Graph(tuple(map(str, range(1002))), many, tips=(Tip("t", 1001),)))))
