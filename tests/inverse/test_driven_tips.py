"""Tips driven by shared and coupled variables: what their joints reach is found, and what is found closes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from inverse.random_trees import configurations, random_tree
from sweeps import sweep

import robokin
from robokin.inverse.numeric.driven_descent import driven_ends, driven_search, ended
from robokin.inverse.numeric.driven_tips import driven_tips, errors_and_slopes, turn_of_axes
from robokin.model import Tree
from robokin.model.graph import Coupling, Graph, GraphJoint, Tip
from robokin.spatial import rotation_from_axis_angle, rotation_from_rpy, transform

TASKS = ("pose", "approach", "position")


def tips_of(tree, tasks):
    graph = tree.graph
    parts = [graph.chain(graph.links[graph.root], name) for name in tree.tips]
    following = [one.joint for one in graph.couplings if not one.own]
    return driven_tips(parts, tasks, tree.revolute, tree.limits, following), np.unique(
        [i for part in parts for i in part.variables]
    )


@pytest.mark.parametrize("seed", sweep(range(60), 5))
def test_what_the_joints_reach_is_found(seed):
    rng = np.random.default_rng(seed)
    tree = random_tree(rng)
    tips, variables = tips_of(tree, [TASKS[i] for i in rng.integers(0, 3, len(tree.tips))])
    q = configurations(tree, 4, rng)
    T = robokin.tip_poses(tree, q)
    np.testing.assert_allclose(tips.poses(q[:, variables]), T, atol=1e-12)
    assert ended(tips, T, q[:, variables]).reached.all()
    found = driven_search(tips, T, np.clip(np.zeros(tips.n), *tips.limits.T), seed)
    assert found.reached.all()
    assert np.all((found.u >= tips.limits[:, 0]) & (found.u <= tips.limits[:, 1]))
    whole = np.zeros((4, tree.n))
    whole[:, variables] = found.u
    again = robokin.tip_poses(tree, whole)
    np.testing.assert_allclose(again[..., :3, 3], T[..., :3, 3], atol=3e-9 * tips.size)
    for i, task in enumerate(tips.tasks):
        columns = {"pose": [0, 1, 2], "approach": [2], "position": []}[task]
        np.testing.assert_allclose(again[:, i, :3, columns], T[:, i, :3, columns], atol=1e-8)


@pytest.mark.parametrize("task", TASKS)
def test_the_slopes_are_those_of_the_errors(task, rng):
    tree = random_tree(np.random.default_rng(4))
    tips, variables = tips_of(tree, [task] * len(tree.tips))
    u = configurations(tree, 1, rng)[:, variables]
    T = tips.poses(u)
    step = 1e-5
    _, J = errors_and_slopes(tips, T, u)
    for j in range(tips.n):
        moved = u + step * tips.scale * np.eye(tips.n)[j] * [[1.0], [-1.0]]
        e, _ = errors_and_slopes(tips, np.repeat(T, 2, axis=0), moved)
        np.testing.assert_allclose((e[1] - e[0]) / (2.0 * step), J[0, :, j], atol=1e-8)


def test_a_target_is_answered_alone_as_among_others():
    tree = random_tree(np.random.default_rng(8))
    tips, _ = tips_of(tree, ["position"] * len(tree.tips))
    T = robokin.tip_poses(tree, configurations(tree, 3, np.random.default_rng(1)))
    home = np.clip(np.zeros(tips.n), *tips.limits.T)
    together, again = driven_search(tips, T, home), driven_search(tips, T, home)
    np.testing.assert_array_equal(together.u, again.u)
    for i in range(3):
        assert driven_search(tips, T[i : i + 1], home).reached.tolist() == together.reached[i : i + 1].tolist()
    assert driven_search(tips, T[:0], home).u.shape == (0, tips.n)
    stands = tips.poses(home[None])
    beside = driven_search(tips, np.concatenate([T, stands]), home)
    assert beside.reached.all()
    np.testing.assert_array_equal(beside.u[3], home)


def test_values_that_hang_on_several_variables_keep_limits_of_their_own():
    """Two joints and one that is their sum: where the sum is bounded the elbow's other side is what is left."""
    joints = (
        GraphJoint("a", "revolute", 0, 1, after=transform(np.eye(3), [1.0, 0.0, 0.0])),
        GraphJoint("b", "revolute", 1, 2, after=transform(np.eye(3), [1.0, 0.0, 0.0])),
        GraphJoint("c", "revolute", 2, 3, after=transform(np.eye(3), [1.0, 0.0, 0.0]), limits=(-0.1, 0.1)),
    )
    graph = Graph(
        ("base", "1", "2", "3"),
        joints,
        tips=(Tip("tip", 3),),
        couplings=(Coupling("c", (("a", 1.0), ("b", 1.0))),),
    )
    tips, _ = tips_of(Tree("sum", graph), ["position"])
    for u in ([0.7, -0.65], [-1.2, 1.3], [2.0, -2.1]):
        T = tips.poses(np.array([u]))
        found = driven_search(tips, T, np.zeros(2))
        assert found.reached.all()
        assert abs(found.u[0].sum()) <= 0.1 + 1e-8
    T = tips.poses(np.array([[0.7, 0.3]]))
    found = driven_search(tips, T, np.zeros(2))
    assert not found.reached.any()
    assert found.place[0, 0] > 1e-3
    # Of a joint that adds a variable of its own the limits are of that one, and those of its motion are told apart.
    own = replace(graph, couplings=(Coupling("c", (("a", 1.0), ("b", 1.0)), own=True),))
    assert not len(tips_of(Tree("sum", own), ["position"])[0].rows)
    bounded = replace(own, joints=(*joints[:2], replace(joints[2], motion_limits=(-0.2, 0.3))))
    np.testing.assert_array_equal(tips_of(Tree("sum", bounded), ["position"])[0].bounds, [[-0.2, 0.3]])


def test_the_nearest_is_a_minimum_within_the_limits(rng):
    tree = robokin.load_tree("human-hand")
    tips, _ = tips_of(tree, ["position"] * 5)
    T = tips.poses(tips.limits.mean(axis=1)[None])
    T[:, :, :3, 3] += rng.normal(size=(1, 5, 3)) * 0.2
    found = driven_search(tips, T, np.clip(np.zeros(tips.n), *tips.limits.T))
    assert not found.reached.any()
    off = np.sum((found.place / tips.sizes) ** 2)
    near = np.clip(found.u + 1e-3 * rng.normal(size=(200, tips.n)), *tips.limits.T)
    others = ended(tips, np.repeat(T, 200, axis=0), near)
    assert np.min(np.sum((others.place / tips.sizes) ** 2, axis=1)) >= off - 1e-9


@pytest.mark.parametrize("far", [0.3, 40.0, 7e4])
@pytest.mark.parametrize("bound", [np.inf, 1e6])
def test_a_slide_goes_many_sizes(far, bound):
    tilted = transform(rotation_from_rpy([1.2, 0.0, 0.0]), np.zeros(3))
    joints = (
        GraphJoint("rail", "prismatic", 0, 1, after=transform(np.eye(3), [1.0, 0.0, 0.0]), limits=(-bound, bound)),
        GraphJoint("b", "revolute", 1, 2, before=tilted, after=transform(np.eye(3), [1.0, 0.0, 0.0])),
        GraphJoint("c", "revolute", 1, 3, after=transform(np.eye(3), [0.0, 1.0, 0.0])),
    )
    tree = Tree("rail", Graph(("base", "1", "2", "3"), joints, tips=(Tip("p", 2), Tip("q", 3))))
    tips, _ = tips_of(tree, ["pose", "position"])
    u = np.array([[far, 1.0, -2.0]])
    found = driven_search(tips, tips.poses(u), np.zeros(3))
    assert found.reached.all()
    np.testing.assert_allclose(found.u, u, rtol=1e-9, atol=1e-9)


def test_opposite_axes_are_turned_by_half_a_turn():
    z = np.array([[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [0.0, 1.0, 0.0]])
    for axis, turn in zip(z, turn_of_axes(z, -z), strict=True):
        assert np.linalg.norm(turn) == pytest.approx(np.pi)
        np.testing.assert_allclose(rotation_from_axis_angle(turn / np.pi, np.pi) @ axis, -axis, atol=1e-12)


def test_a_descent_ends_within_the_limits_to_the_last_digit():
    tree = robokin.load_tree("human-hand")
    tips, _ = tips_of(tree, ["pose"] * 5)
    low, high = tips.limits.T
    T = tips.poses(np.stack([low, high]))
    ends = driven_ends(tips, T, np.stack([high, low]))
    assert np.all((ends.u >= low) & (ends.u <= high))
