"""The kinematic graph: trees and couplings against products of transforms, tables and mechanisms as views on it."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest
from kinematics.reference import rot, trans
from mobility.linkages import four_bar, linkage

import robokin
from robokin.errors import InputError
from robokin.formats import library_names, load_any
from robokin.kinematics.forward import row_frames
from robokin.kinematics.tips import tip_poses
from robokin.mobility.assembly import assembled
from robokin.model import Mechanism, Robot, Tree
from robokin.model.graph import Coupling, Graph, GraphJoint, Tip
from robokin.model.topology import topology_of
from robokin.spatial import rotation_from_rpy, transform

MOTIONS = {
    "revolute": lambda value: rot([0, 0, 1], value),
    "prismatic": lambda value: trans(0, 0, value),
    "fixed": lambda value: np.eye(4),
}


@pytest.fixture(scope="module")
def library():
    """The library's entries by their class."""
    entries = [load_any(name) for name in library_names()]
    return {kind: [entry for entry in entries if isinstance(entry, kind)] for kind in (Robot, Mechanism)}


def pose(rng):
    return trans(*rng.normal(size=3)) @ rot(rng.normal(size=3), rng.uniform(-3, 3))


def tree(rng, count):
    """A tree whose links are numbered at random, each standing on one drawn before, with a tip on every link."""
    numbers = rng.permutation(count).tolist()
    joints = []
    for k in range(1, count):
        parent, child = numbers[rng.integers(k)], numbers[k]
        kind = str(rng.choice([*MOTIONS]))
        freedoms = int(kind != "fixed")
        zero = rng.normal() if freedoms else 0.0
        joints.append(GraphJoint(f"j{k}", kind, parent, child, freedoms, pose(rng), pose(rng), zero=zero))
    joints = [joints[i] for i in rng.permutation(len(joints))]
    tips = tuple(Tip(f"tip {link}", link, pose(rng)) for link in range(count))
    return Graph(tuple(f"link {i}" for i in range(count)), tuple(joints), numbers[0], pose(rng), tips)


def link_poses(graph, values):
    """The pose (4, 4) of each link in the world, at the values of the joints that move, from the definition."""
    value_of = dict(zip(graph.moving, values, strict=True))
    T = {graph.root: graph.base}
    while len(T) < len(graph.links):
        for number, joint in enumerate(graph.joints):
            if joint.parent in T:
                motion = MOTIONS[joint.type](value_of.get(number, 0.0) + joint.zero)
                T[joint.child] = T[joint.parent] @ joint.before @ motion @ joint.after
    return T


def tip_pose(part, u):
    """The pose (4, 4) of a part's tip at the graph's variables u."""
    T = part.constants[0]
    values = part.S @ u[part.variables] + part.offsets
    for joint, value, C in zip(part.joints, values, part.constants[1:], strict=True):
        T = T @ MOTIONS[joint.type](value) @ C
    return T


def coupled(graph, rng):
    """The graph with joints that follow one or two others, or add them; joints only lean on those before in a list."""
    names = [graph.joints[number].name for number in graph.moving]
    order = [names[i] for i in rng.permutation(len(names))]
    couplings = []
    for k in range(1, len(order), 2):
        others = rng.choice(k, size=min(k, 2), replace=False)
        ratios = tuple((order[other], float(rng.normal())) for other in others)
        couplings.append(Coupling(order[k], ratios, float(rng.normal()), own=bool(rng.integers(2))))
    return replace(graph, couplings=tuple(couplings[::-1]))


# Tables ----------------------------------------------------------------------------------------------------------


def test_the_chain_of_a_table_is_the_robots(library, rng):
    for robot in library[Robot]:
        part = robot.graph.chain("base", "tool")
        assert np.array_equal(part.S, np.eye(robot.n))
        assert [joint.limits for joint in part.joints] == [joint.limits for joint in robot.joints]
        q = rng.uniform(-1, 1, robot.n)
        found, own = tip_pose(part, q), robokin.forward_kinematics(robot, q)
        # Calibrated tables have frames some 100 m off the arm.
        lengths = float(np.sum(np.linalg.norm(part.constants[:, :3, 3], axis=1)))
        assert np.allclose(found, own, atol=1e-13 * max(lengths, 1.0)), robot.id


@pytest.mark.parametrize("name", ["puma560", "puma560-craig", "scara-frames", "human-body", "fanuc"])
def test_the_links_of_a_table_are_the_frames_of_its_rows(name, rng):
    robot = robokin.load(name)
    q = rng.uniform(-1, 1, robot.n)
    graph = robot.graph
    T = link_poses(graph, q)
    rows = row_frames(robot, q)
    assert np.allclose([T[i + 1] for i in range(len(robot.rows))], rows, atol=1e-12)
    part = graph.chain("1", graph.links[-2])
    assert np.allclose(T[1] @ tip_pose(part, q), T[len(robot.rows) - 1], atol=1e-12)


def test_a_graph_is_kept_on_its_robot_and_not_pickled():
    robot = robokin.load("puma560")
    plain = pickle.dumps(robot)
    assert robot.graph is robot.graph
    assert pickle.dumps(robot) == plain
    with pytest.raises(ValueError, match="read-only"):
        robot.graph.joints[0].after[0, 3] = 1.0


# Trees and couplings ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(8))
def test_the_tips_of_a_tree_are_its_chains(seed):
    rng = np.random.default_rng([15, seed])
    graph = coupled(tree(rng, int(rng.integers(2, 14))), rng)
    S, o = graph.value_map
    u = rng.normal(size=len(graph.variables))
    T = link_poses(graph, S @ u + o)
    for tip in graph.tips:
        part = graph.chain(graph.links[graph.root], tip.name)
        assert np.allclose(tip_pose(part, u), T[tip.link] @ tip.tool, atol=1e-12)
        assert np.allclose(tip_pose(graph.chain(graph.links[graph.root], graph.links[tip.link]), u), T[tip.link])


@pytest.mark.parametrize("seed", range(8))
def test_joints_keep_their_couplings(seed):
    rng = np.random.default_rng([16, seed])
    graph = coupled(tree(rng, 12), rng)
    S, o = graph.value_map
    u = rng.normal(size=len(graph.variables))
    values = dict(zip([graph.joints[number].name for number in graph.moving], S @ u + o, strict=True))
    own = dict(zip([graph.joints[number].name for number in graph.variables], u, strict=True))
    for coupling in graph.couplings:
        assert (coupling.joint in own) == coupling.own
        expected = sum(ratio * values[name] for name, ratio in coupling.ratios) + coupling.offset
        assert values[coupling.joint] == pytest.approx(expected + own.get(coupling.joint, 0.0))
    for name in own.keys() - {coupling.joint for coupling in graph.couplings}:
        assert values[name] == own[name]


def test_two_fingers_on_a_palm():
    """A wrist that two fingers stand on; the outer joint of each follows by two thirds, one finger alone."""
    joints = [GraphJoint("wrist", "revolute", 0, 1, after=trans(90, 0, 0))]
    for side, first in (("index", 2), ("ring", 4)):
        joints += [
            GraphJoint(f"{side}.pip", "revolute", 1, first, before=trans(0, 20 if first == 2 else -18, 0)),
            GraphJoint(f"{side}.dip", "revolute", first, first + 1, before=trans(26, 0, 0)),
        ]
    links = ("base", "palm", "index middle", "index end", "ring middle", "ring end")
    couplings = tuple(Coupling(f"{side}.dip", ((f"{side}.pip", 2 / 3),)) for side in ("index", "ring"))
    hand = Graph(links, tuple(joints), tips=(Tip("index", 3, trans(20, 0, 0)),), couplings=couplings)
    assert hand.variables == (0, 1, 3)
    part = hand.chain("base", "index")
    assert part.variables.tolist() == [0, 1]
    assert np.array_equal(part.S, [[1, 0], [0, 1], [0, 2 / 3]])
    z = [0, 0, 1]
    expected = rot(z, 0.3) @ trans(90, 20, 0) @ rot(z, 0.6) @ trans(26, 0, 0) @ rot(z, 0.4) @ trans(20, 0, 0)
    assert np.allclose(tip_pose(part, np.array([0.3, 0.6, 9.0])), expected, atol=1e-12)
    with pytest.raises(InputError, match="no joints lead from link index middle to ring end"):
        hand.chain("index middle", "ring end")


# Mechanisms ------------------------------------------------------------------------------------------------------


def test_a_mechanism_is_joints_of_two_links(library):
    for mechanism in library[Mechanism]:
        graph, count = mechanism.graph, sum(joint.multiplicity for joint in mechanism.joints)
        assert len(graph.joints) == count
        assert len(graph.topology.loops) == count - len(mechanism.links) + len(graph.parts)
        for joint in graph.joints:
            row = mechanism.joints[joint.row]
            assert {graph.links[joint.parent], graph.links[joint.child]} <= set(row.links)
            assert (joint.name, joint.type, joint.freedoms) == (row.name, row.type, row.freedoms)


def test_an_open_mechanism_moves_as_its_chain_does(rng):
    mechanism = linkage(
        [("R", "01", (1, 2, 0), (0, 1, 1)), ("P", "12", (1, 0, 0), (1, 1, 0)), ("R", "23", (0, 1, 3), (1, 0, -2))],
        "spatial",
    )
    assembly = assembled(mechanism)
    q = rng.uniform(-1, 1, 3)
    body = assembly.linkage
    state = body.moved(body.reference, q / np.array([1.0, assembly.size, 1.0]))
    assert np.allclose(tip_pose(mechanism.graph.chain("0", "3"), q), assembly.placed(state.bodies)[3], atol=1e-12)


def test_a_chain_needs_axes_in_known_places():
    ball = linkage([("R", "01", (0, 0, 0), (0, 0, 1)), ("S", "12", (1, 0, 0))], "spatial")
    with pytest.raises(InputError, match="joint 1 has no axis in a known place, expected a hinge or a slide"):
        ball.graph.chain("0", "2")
    # Where a loop's tree goes through a joint from its second link no chain leads.
    with pytest.raises(InputError, match="no joints lead from link 0 to 3"):
        four_bar([(0, 0), (1, 2), (4, 3), (5, 0)]).graph.chain("0", "3")


# Topology --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(20))
def test_ways_lead_from_the_root_to_each_link(seed):
    """Signs add up the joints' ends: the ways of a forest are inverse to the incidence of its joints."""
    rng = np.random.default_rng(seed)
    links, count = int(rng.integers(1, 9)), int(rng.integers(0, 12)) if seed else 0
    ends = [tuple(rng.choice(links, 2, replace=False).tolist()) for _ in range(count if links > 1 else 0)]
    found = topology_of(links, ends, range(links))
    incidence = np.zeros((links, len(ends)))
    for number, (a, b) in enumerate(ends):
        incidence[[a, b], number] = -1.0, 1.0
    assert np.array_equal(found.signs @ incidence.T, np.eye(links) - np.eye(links)[found.root])
    assert len(found.steps) + len(found.loops) == len(ends)
    assert len(found.steps) == links - len(set(found.root.tolist())) == np.linalg.matrix_rank(incidence)
    reached = set(found.root.tolist())
    for link, number, parent in found.steps:
        assert parent in reached
        assert {link, parent} == set(ends[number])
        assert (found.parent[link], found.joint[link]) == (parent, number)
        reached.add(link)


# Sentences -------------------------------------------------------------------------------------------------------

LINKS = ("a", "b", "c")
JOINTS = (GraphJoint("p", "revolute", 0, 1), GraphJoint("q", "helical", 1, 2, pitch=0.1))


@pytest.mark.parametrize(
    ("parts", "said"),
    [
        ({"links": ("a", "b", "a")}, "found the link 'a' twice, expected different names"),
        ({"tips": (Tip("t", 1), Tip("t", 2))}, "found the tip 't' twice, expected different names"),
        ({"tips": (Tip("t", 3),)}, "found link 3 of tip t, expected 0 to 2"),
        ({"root": -1}, "found link -1 of the root, expected 0 to 2"),
        ({"joints": (GraphJoint("p", "revolute", 0, 7),)}, "found link 7 of joint p, expected 0 to 2"),
        ({"joints": (GraphJoint("p", "revolute", 1, 1),)}, "joint p joins a link to itself, expected two links"),
        (
            {"couplings": (Coupling("q", (("x", 1.0),)),)},
            "found the joint 'x' of a coupling nowhere, expected the",
        ),
        ({"couplings": (Coupling("p", (("q", 1.0),)), Coupling("p", (("q", 2.0),)))}, "two couplings of one joint"),
        (
            {"couplings": (Coupling("p", (("q", 1.0),)), Coupling("q", (("p", 1.0),), own=True))},
            "the couplings go round in a circle, p → q → p, expected one joint that is free",
        ),
        ({"couplings": (Coupling("p", (("p", 1.0),)),)}, "the couplings go round in a circle, p → p"),
        (
            {"joints": (*JOINTS, GraphJoint("p", "revolute", 0, 2)), "couplings": (Coupling("q", (("p", 1.0),)),)},
            "found the joint 'p' of a coupling twice",
        ),
    ],
)
def test_what_is_no_graph_is_refused_with_a_sentence(parts, said):
    with pytest.raises(InputError) as caught:
        Graph(**{"links": LINKS, "joints": JOINTS, **parts})
    assert said in str(caught.value)


def test_an_unknown_tip_is_refused():
    with pytest.raises(InputError, match="found the unknown link 'thumb', expected one of a, b, c"):
        Graph(LINKS, JOINTS).chain("a", "thumb")
    # Tips come before links, and a link's own name once.
    named = Graph(LINKS, JOINTS, tips=(Tip("finger", 2), Tip("b", 1)))
    with pytest.raises(InputError, match=r"found the unknown link 'thumb', expected one of finger, b, a, c$"):
        named.chain("a", "thumb")
    with pytest.raises(InputError, match=r"found the unknown link 'thumb', expected one of a, b, c$"):
        named.chain("thumb", "finger")
    many = tuple(f"l{i}" for i in range(20))
    with pytest.raises(InputError, match=r"expected one of l0, .*l11, …$"):
        Graph(many, tuple(GraphJoint(f"j{i}", "fixed", i, i + 1) for i in range(19))).chain("l0", "thumb")


@pytest.mark.parametrize("pitch", [0.02, -0.005, 0.0])
def test_a_helical_joint_advances_along_its_axis(pitch):
    """T = B Rot(z, v) Trans(0, 0, pitch v) A, with v = q + zero, beside a joint before and one after it."""
    rng = np.random.default_rng(21)
    B, A = (transform(rotation_from_rpy(rng.uniform(-1, 1, 3)), rng.uniform(-1, 1, 3)) for _ in range(2))
    joints = (
        GraphJoint("turn", "revolute", 0, 1, after=A),
        GraphJoint("screw", "helical", 1, 2, before=B, after=A, pitch=pitch, zero=0.3),
        GraphJoint("slide", "prismatic", 2, 3, before=B),
    )
    tree = Tree("screw", Graph(("a", "b", "c", "d"), joints, tips=(Tip("tip", 3),)))
    assert tree.n == 3

    def motion(turn, slide):
        return transform(rotation_from_rpy([0.0, 0.0, turn]), [0.0, 0.0, slide])

    for q in rng.uniform(-2, 2, (20, 3)):
        v = q[1] + 0.3
        expected = motion(q[0], 0) @ A @ B @ motion(v, pitch * v) @ A @ B @ motion(0, q[2])
        np.testing.assert_allclose(tip_poses(tree, q)[0], expected, atol=1e-14)
