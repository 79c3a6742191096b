"""Targets for several tips of a tree: what is independent is listed whole, what is not is found and not proven."""

from __future__ import annotations

import numpy as np
import pytest
from inverse.random_trees import configurations, random_tree
from sweeps import sweep

import robokin
from robokin.errors import InputError
from robokin.formats.library import library_file
from robokin.inverse.solutions import Solution
from robokin.model import Tree
from robokin.model.graph import Graph, GraphJoint, Tip
from robokin.spatial import rotation_from_rpy, transform

HAND = robokin.load_tree("human-hand")
ARM = """
      - {name: s1, type: revolute, d: 0.3, alpha: 90, limits: [-170, 170]}
      - {name: s2, type: revolute, alpha: -90, limits: [-120, 120]}
      - {name: s3, type: revolute, d: 0.4, alpha: 90, limits: [-170, 170]}
      - {name: e, type: revolute, alpha: -90, limits: [-120, 120]}
      - {name: w1, type: revolute, d: 0.4, alpha: 90, limits: [-170, 170]}
      - {name: w2, type: revolute, alpha: -90, limits: [-120, 120]}
      - {name: w3, type: revolute, d: 0.1, limits: [-175, 175]}
"""
TORSO = f"""robokin: 1
name: Torso
units: {{length: m, angle: deg}}
branches:
  torso:
    joints:
      - {{name: lift, type: prismatic, limits: [0.1, 0.4]}}
      - {{name: yaw, type: revolute, d: 0.5, alpha: 90, limits: [-90, 90]}}
      - {{name: lean, type: revolute, a: 0.3, alpha: -90, limits: [-20, 60]}}
  left: {{on: torso, base: "Trans(0, 0.2, 0.1) Rot(x, -60)", joints: [{ARM.replace("- {", "{").replace("}", "},")}]}}
  right: {{on: torso, base: "Trans(0, -0.2, 0.1) Rot(x, 60)", joints: [{ARM.replace("- {", "{").replace("}", "},")}]}}
  head: {{joints: [{{name: nod, type: revolute, a: 0.2}}]}}
"""


@pytest.fixture(scope="module")
def torso(tmp_path_factory):
    path = tmp_path_factory.mktemp("trees") / "torso.yaml"
    path.write_text(TORSO)
    return robokin.load_tree(path)


@pytest.fixture(scope="module")
def coupled(tmp_path_factory):
    """The hand whose fingers' last joints follow the ones before them, as in life."""
    fingers = ("index", "middle", "ring", "little")
    path = tmp_path_factory.mktemp("trees") / "hand.yaml"
    text = library_file("human-hand").read_text().split("poses:")[0]
    text += "couplings:\n" + "".join(f"  - {{joint: {f}.dip, follows: {f}.pip, ratio: 2/3}}\n" for f in fingers)
    path.write_text(text)
    return robokin.load_tree(path)


def at(tree, q, tips):
    poses = robokin.tip_poses(tree, q)
    return {tip: poses[..., tree.tips.index(tip), :, :] for tip in tips}


def within(tree, rng):
    reach = np.where(tree.revolute, np.pi, 0.3)[:, None] * [-1.0, 1.0]
    return rng.uniform(*np.where(np.isinf(tree.limits), reach, tree.limits).T)


def closes(tree, answer, exact=1e-8):
    """Every solution of every group has the targets of its tips, by the poses of all tips."""
    for group in answer.groups:
        for solution in group.result:
            for tip, T in at(tree, solution.q, group.tips).items():
                wish, task = answer.question.T[tip], answer.question.tasks[tip]
                columns = {"pose": [0, 1, 2, 3], "approach": [2, 3], "position": [3]}[task]
                np.testing.assert_allclose(T[:3, columns], wish[:3, columns], atol=exact)
            if answer.question.limits:
                own = np.array(group.joints) - 1
                assert np.all(solution.q[own] >= tree.limits[own, 0] - 1e-9)
                assert np.all(solution.q[own] <= tree.limits[own, 1] + 1e-9)
                assert solution.within_limits


@pytest.mark.parametrize("task", ["pose", "position", "approach"])
def test_independent_tips_have_the_lists_of_their_chains(task, rng):
    T = at(HAND, within(HAND, rng), ("index", "thumb", "ring"))
    answer = robokin.solve_tips(HAND, T, task)
    assert [group.tips for group in answer.groups] == [("index",), ("thumb",), ("ring",)]
    assert answer.reachable
    closes(HAND, answer)
    for group in answer.groups:
        (tip,), own = group.tips, np.array(group.joints) - 1
        alone = robokin.solve_ik(HAND.robot(tip), T[tip], task=task)
        assert (group.result.complete, group.result.basis, group.result.counts) == (
            alone.complete, alone.basis, alone.counts,
        )  # fmt: skip
        assert len(group.result) == len(alone)
        for mine, theirs in zip(group.result, alone, strict=True):
            np.testing.assert_array_equal(mine.q[own], theirs.q)
            assert mine.branch == theirs.branch
            assert mine.free == tuple(own[i - 1] + 1 for i in theirs.free)
    assert answer.complete == all(group.result.complete for group in answer.groups)


def test_all_targets_are_had_at_once_by_the_first_solutions(rng):
    q = within(HAND, rng)
    T = at(HAND, q, HAND.tips)
    answer = robokin.solve_tips(HAND, T)
    assert answer.complete
    assert answer.still == ()
    for tip, pose in at(HAND, answer.q, HAND.tips).items():
        np.testing.assert_allclose(pose, T[tip], atol=1e-9)


def test_joints_that_nothing_moves_stay(torso):
    T = at(HAND, HAND.poses["pinch"], ("index",))
    answer = robokin.solve_tips(HAND, T)
    assert answer.still == tuple(i for i in range(1, 22) if i not in (6, 7, 8, 9))
    assert np.all(np.delete(answer.q, [5, 6, 7, 8]) == 0.0)
    near = HAND.poses["fist"]
    answer = robokin.solve_tips(HAND, T, near=near)
    np.testing.assert_array_equal(np.delete(answer.q, [5, 6, 7, 8]), np.delete(near, [5, 6, 7, 8]))
    # Zero is outside the limits of the lift.
    head = robokin.solve_tips(torso, {"head": torso.graph.base}, "position")
    assert head.question.home[0] == pytest.approx(0.25)


@pytest.mark.parametrize("seed", sweep(range(12), 6))
@pytest.mark.parametrize("task", ["pose", "approach", "position"])
def test_arms_on_a_torso_are_found_together(torso, task, seed):
    T = at(torso, within(torso, np.random.default_rng(seed)), ("right", "left"))
    answer = robokin.solve_tips(torso, T, task, seed=seed)
    (group,) = answer.groups
    assert group.tips == ("right", "left")
    assert group.searched
    assert answer.reachable
    assert not answer.complete
    assert group.result.basis is None
    assert "left share q1, q2 and q3" in group.result.certificate
    assert answer.still == (18,)
    closes(torso, answer)


def test_one_arm_of_a_torso_is_a_serial_robot(torso, rng):
    T = at(torso, within(torso, rng), ("left", "head"))
    answer = robokin.solve_tips(torso, T, {"head": "position"})
    assert [group.searched for group in answer.groups] == [False, False]
    assert [group.joints for group in answer.groups] == [tuple(range(1, 11)), (18,)]
    closes(torso, answer)


@pytest.mark.parametrize("seed", sweep(range(20), 5))
def test_joints_that_follow_do_so(coupled, seed):
    rng = np.random.default_rng(seed)
    T = at(coupled, within(coupled, rng), ("index", "thumb", "little"))
    answer = robokin.solve_tips(coupled, T, {"index": "pose", "thumb": "position", "little": "position"})
    assert not any(group.searched for group in answer.groups)
    closes(coupled, answer)
    for group in answer.groups:  # they are the answers of the chains
        (tip,), own = group.tips, np.array(group.joints) - 1
        alone = robokin.solve_ik(coupled.robot(tip), T[tip], task=answer.question.tasks[tip])
        np.testing.assert_array_equal([one.q[own] for one in group.result], [one.q for one in alone])
    # A hand without couplings reaches the same with the value that the coupling says.
    place = HAND.tips.index("index")
    q = np.zeros(21)
    index = np.array(answer.groups[0].joints) - 1
    q[5:8] = answer.q[index]
    q[8] = q[7] * 2.0 / 3.0
    np.testing.assert_allclose(robokin.tip_poses(HAND, q)[place], T["index"], atol=1e-9)


@pytest.mark.parametrize("ulps", [-1, 0, 1])
@pytest.mark.parametrize("q", ["zero", "low", "high"])
def test_round_and_extreme_targets_are_had(coupled, torso, q, ulps):
    for tree, tips in ((coupled, ("index", "middle")), (torso, ("left", "right"))):
        limits = np.where(np.isinf(tree.limits), 0.0, tree.limits)
        at_q = {"zero": np.clip(0.0, *limits.T), "low": limits[:, 0], "high": limits[:, 1]}[q]
        T = at(tree, at_q, tips)
        for pose in T.values():
            pose[:3] += ulps * np.spacing(pose[:3])
        answer = robokin.solve_tips(tree, T, "pose")
        assert answer.reachable
        closes(tree, answer)


@pytest.mark.parametrize("seed", sweep(range(40), 5))
def test_tips_of_any_tree_close(seed):
    """Alone, where `solve_ik` answers in the joints of their chain, and together."""
    rng = np.random.default_rng(100 + seed)
    tree = random_tree(rng)
    (q,) = configurations(tree, 1, rng)
    T = at(tree, q, tree.tips)
    task = ("pose", "approach", "position")[seed % 3]
    for tips in (*((tip,) for tip in tree.tips), tree.tips):
        answer = robokin.solve_tips(tree, {tip: T[tip] for tip in tips}, task)
        assert answer.reachable
        closes(tree, answer, 3e-8)
        assert {*answer.still} == {*range(1, tree.n + 1)} - {joint for group in answer.groups for joint in group.joints}


def test_what_is_not_found_has_a_nearest_and_no_proof(torso, coupled):
    far = {"left": transform(np.eye(3), [9.0, 0.0, 0.0]), "right": transform(np.eye(3), [0.5, -0.4, 0.8])}
    answer = robokin.solve_tips(torso, far, "position")
    (group,) = answer.groups
    assert answer.q is None
    assert not answer.reachable
    assert "not proven unreachable" in group.result.reason
    assert isinstance(group.result.nearest, Solution)
    assert group.errors.shape == (1, 2, 2)
    places = at(torso, group.result.nearest.q, ("left", "right"))
    for (distance, _), tip in zip(group.errors[0], group.tips, strict=True):
        assert np.linalg.norm(places[tip][:3, 3] - far[tip][:3, 3]) == pytest.approx(distance, rel=1e-9, abs=1e-12)
    # What is proven of a tip alone stays so beside others that are reached.
    T = at(coupled, np.clip(0.1, *coupled.limits.T), ("index",)) | {"thumb": transform(np.eye(3), [0.0, 5.0, 0.0])}
    answer = robokin.solve_tips(coupled, T, "position")
    assert [group.result.reachable for group in answer.groups] == [True, False]
    assert answer.groups[1].result.reason == "out of reach"
    assert answer.q is None


def test_without_limits_full_turns_are_taken_back(torso):
    q = np.full(torso.n, 0.4)
    T = at(torso, q, ("left", "right"))
    answer = robokin.solve_tips(torso, T, limits=False, near=q)
    np.testing.assert_allclose(answer.q, q, atol=1e-9)
    free = robokin.solve_tips(torso, T, limits=False)
    closes(torso, free)
    assert np.all(np.abs(free.q[torso.revolute]) <= np.pi + 1e-9)


def test_an_answer_is_the_same_again_and_does_not_hang_on_the_order(torso):
    T = at(torso, np.full(torso.n, 0.3), ("left", "right", "head"))
    first = robokin.solve_tips(torso, T, {"head": "position"})
    again = robokin.solve_tips(torso, T, {"head": "position"})
    np.testing.assert_array_equal(first.q, again.q)
    turned = robokin.solve_tips(torso, dict(reversed(T.items())), {"head": "position"})
    assert [group.tips for group in turned.groups] == [("head",), ("right", "left")]
    closes(torso, turned)


def test_inner_links_are_targets_too():
    """A palm and a finger on it; the two ask for what both can have, and for what they cannot."""
    joints = (
        GraphJoint("wrist", "revolute", 0, 1, after=transform(np.eye(3), [1.0, 0.0, 0.0])),
        GraphJoint("knuckle", "revolute", 1, 2, after=transform(np.eye(3), [0.5, 0.0, 0.0])),
    )
    base = transform(rotation_from_rpy([0.1, 0.2, 0.3]), [1.0, 2.0, 3.0])
    tree = Tree("hand", Graph(("base", "palm", "finger"), joints, base=base, tips=(Tip("tip", 2), Tip("inner", 1))))
    T = at(tree, [0.4, -0.7], ("tip", "inner"))
    answer = robokin.solve_tips(tree, {"tip": T["tip"], "palm": T["inner"]})
    assert answer.groups[0].tips == ("tip", "palm")
    np.testing.assert_allclose(answer.q, [0.4, -0.7], atol=1e-9)
    other = robokin.solve_tips(tree, {"tip": T["tip"], "palm": at(tree, [0.9, 0.0], ("inner",))["inner"]})
    assert not other.reachable
    assert other.groups[0].result.nearest is not None


def test_what_is_no_target_is_refused(torso):
    T = np.eye(4)
    fixed = Tree("fixed", Graph(("base", "a"), (GraphJoint("j", "fixed", 0, 1, 0),), tips=(Tip("tip", 1),)))
    for call, said in (
        (lambda: robokin.solve_tips(HAND, {}), "expected a pose"),
        (lambda: robokin.solve_tips(HAND, {"indx": T}), "did you mean 'index'"),
        (lambda: robokin.solve_tips(HAND, {"foot": T}), "expected one of thumb, index"),
        (lambda: robokin.solve_tips(HAND, {"index": np.eye(3)}), "targets['index']: found an array of shape (3, 3)"),
        (lambda: robokin.solve_tips(HAND, {"index": np.stack([T, T])}), "for index, expected"),
        (lambda: robokin.solve_tips(HAND, {"index": T * np.nan}), "not finite"),
        (lambda: robokin.solve_tips(HAND, {"index": T}, "place"), "expected 'pose'"),
        (lambda: robokin.solve_tips(HAND, {"index": T}, {"thumb": "pose"}), "expected tips that have a target"),
        (lambda: robokin.solve_tips(HAND, {"index": T}, near=np.zeros(4)), "21 joint values"),
        (lambda: robokin.solve_tips(HAND, [T]), "expected a mapping"),
        (lambda: robokin.solve_tips(robokin.load("puma560"), {"tool": T}), "expected a Tree"),
        (lambda: robokin.solve_tips(fixed, {"tip": T}), "no joint moves"),
        (lambda: robokin.solve_tips(torso, {"left": T}, seed=-1), "seed"),
        (lambda: robokin.solve_tips(torso, {"left": T}, most=0), "most"),
    ):
        with pytest.raises(InputError) as caught:
            call()
        assert said in str(caught.value), str(caught.value)
