"""Descriptions of trees: branches, couplings, tips, and what is wrong in them."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

import robokin
from robokin.errors import DescriptionError, InputError
from robokin.formats import read_text
from robokin.model import Robot, Tree

FINGERS = """\
robokin: 1
name: Two fingers
units: {length: mm, angle: deg}
branches:
  palm:  {joints: [{name: wrist, type: revolute, alpha: 90, limits: [-60, 60]}]}
  index:
    on: palm
    base: Trans(90, 20, 0)
    joints:
      - {name: mcp, type: revolute, a: 45, limits: [-10, 90]}
      - {name: pip, type: revolute, a: 26, limits: [0, 100]}
      - {name: dip, type: revolute, a: 20, limits: [0, 50]}
  ring:  {on: palm, base: "Trans(88, -18, 0)", joints: [{name: mcp, type: revolute, a: 41}]}
"""
COUPLED = FINGERS + "couplings: [{joint: index.dip, follows: index.pip, ratio: 2/3}]\n"


def dh(theta, d, a, alpha):
    """Rot(z, theta) Trans(a, 0, d) Rot(x, alpha), written out."""
    c, s, ca, sa = math.cos(theta), math.sin(theta), math.cos(alpha), math.sin(alpha)
    return np.array([[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]])


def shift(*p):
    T = np.eye(4)
    T[:3, 3] = p
    return T


def test_a_tips_pose_is_the_product_of_its_chain_and_a_follower_turns_with_its_leader():
    tree = read_text(COUPLED)
    assert isinstance(tree, Tree)
    assert (tree.n, tree.types, tree.tips) == (4, "RRRR", ("index", "ring"))
    assert [joint.name for joint in tree.joints] == ["palm.wrist", "index.mcp", "index.pip", "ring.mcp"]
    q = np.random.default_rng(5).uniform(-1.0, 1.0, (50, 4))
    T = robokin.tip_poses(tree, q)
    for (wrist, mcp, pip, ring), (index_pose, ring_pose) in zip(q, T, strict=True):
        palm = dh(wrist, 0, 0, math.pi / 2)
        finger = dh(mcp, 0, 0.045, 0) @ dh(pip, 0, 0.026, 0) @ dh(2 / 3 * pip, 0, 0.020, 0)
        np.testing.assert_allclose(index_pose, palm @ shift(0.09, 0.02, 0) @ finger, atol=1e-15)
        np.testing.assert_allclose(ring_pose, palm @ shift(0.088, -0.018, 0) @ dh(ring, 0, 0.041, 0), atol=1e-15)


def test_a_leader_has_the_limits_that_its_followers_leave():
    """dip within 0 to 50 leaves pip 75 of its 100 degrees."""
    np.testing.assert_allclose(np.rad2deg(read_text(COUPLED).limits[2]), [0.0, 75.0], atol=1e-12)
    np.testing.assert_allclose(np.rad2deg(read_text(FINGERS).limits[2]), [0.0, 100.0], atol=1e-12)


def test_limits_that_leave_nothing_are_refused():
    with pytest.raises(InputError, match=r"no value is within the limits of both"):
        read_text(COUPLED.replace("limits: [0, 50]", "limits: [80, 90]"))


def test_branches_in_any_order_are_the_same_tree():
    """q runs in the order of the file, so it is shuffled along."""
    head, *parts = FINGERS.split("\n  ")
    parts = "\n  ".join(parts).replace("ring:", "\0ring:").replace("index:", "\0index:").split("\0")
    own = {"palm": [0], "index": [1, 2, 3], "ring": [4]}
    first = read_text(FINGERS)
    q = np.random.default_rng(6).uniform(-1.0, 1.0, 5)
    expected = dict(zip(first.tips, robokin.tip_poses(first, q), strict=True))
    for order in itertools.permutations(parts):
        text = head + "\n" + "".join("  " + part.strip() + "\n" for part in order)
        tree = read_text(text)
        names = [part.partition(":")[0].strip() for part in order]
        T = robokin.tip_poses(tree, q[[k for name in names for k in own[name]]])
        for tip, pose in zip(tree.tips, T, strict=True):
            np.testing.assert_allclose(pose, expected[tip], atol=1e-15)


def test_ratios_between_turns_and_slides_are_in_the_units_of_the_file():
    """A screw of 5 mm a turn, in degrees and millimetres."""
    text = """\
robokin: 1
name: screw
units: {length: mm, angle: deg}
branches:
  b: {joints: [{name: turn, type: revolute}, {name: advance, type: prismatic}]}
couplings: [{joint: advance, follows: turn, ratio: 5/360, offset: 7}]
"""
    tree = read_text(text)
    T = robokin.tip_poses(tree, [math.pi])
    np.testing.assert_allclose(T[0, :3, 3], [0.0, 0.0, 0.0095], atol=1e-15)


def test_couplings_chain_in_any_order_and_add():
    text = """\
robokin: 1
name: chain
branches:
  b: {joints: [{name: a, type: revolute}, {name: b, type: revolute}, {name: c, type: revolute}]}
couplings:
  - {joint: c, follows: b, ratio: 2}
  - {joint: b, adds: {a: -1}, offset: 0.5}
"""
    tree = read_text(text)
    S, o = tree.graph.value_map
    assert [joint.name for joint in tree.joints] == ["b.a", "b.b"]
    np.testing.assert_array_equal(S, [[1, 0], [-1, 1], [-2, 2]])
    np.testing.assert_array_equal(o, [0, 0.5, 1.0])


def test_the_chain_to_a_tip_is_a_robot_with_every_answer():
    tree = read_text(FINGERS)
    robot = tree.robot("index")
    assert isinstance(robot, Robot)
    assert [joint.name for joint in robot.joints] == ["palm.wrist", "index.mcp", "index.pip", "index.dip"]
    q = np.random.default_rng(7).uniform(-0.5, 0.5, (20, 5))
    T = robokin.tip_poses(tree, q)
    np.testing.assert_allclose(robokin.forward_kinematics(robot, q[:, :4]), T[:, 0], atol=1e-15)
    result = robokin.solve_ik(robot, T[0, 0], limits=False)
    assert result.complete
    assert any(np.allclose(solution.q, q[0, :4], atol=1e-9) for solution in result.solutions)


def test_a_robot_is_a_tree_of_one_branch():
    """Every robot of a few kinds, at random: its tree's only tip is its tool."""
    for name in ("puma560", "scara", "ur5e", "puma560-craig", "panda"):
        robot, tree = robokin.load(name), robokin.load_tree(name)
        assert len(tree.tips) == 1
        q = np.random.default_rng(8).uniform(-1.0, 1.0, (20, robot.n))
        T = robokin.forward_kinematics(robot, q)
        np.testing.assert_allclose(robokin.tip_poses(tree, q)[:, 0], T, atol=1e-14)
        np.testing.assert_allclose(robokin.forward_kinematics(tree.robot(), q), T, atol=1e-14)


def test_the_hands_fingers_are_chains_of_the_published_lengths():
    """Straight fingers end at the sum of their parts: Buchholz et al. 1992, HL = 190, HB = 85 mm."""
    hand = robokin.load_tree("human-hand")
    assert (hand.n, hand.tips) == (21, ("thumb", "index", "middle", "ring", "little"))
    T = robokin.tip_poses(hand, np.zeros(21))
    parts = {
        "index": (0.447, 0.251, 0.245 + 0.143 + 0.097),
        "middle": (0.446, 0.0, 0.266 + 0.170 + 0.108),
        "ring": (0.409, -0.206, 0.244 + 0.165 + 0.107),
        "little": (0.368, -0.402, 0.204 + 0.117 + 0.093),
    }
    for tip, (x, y, phalanges) in parts.items():
        place = T[hand.tips.index(tip), :3, 3]
        np.testing.assert_allclose(place, [0.190 * (x + phalanges), 0.085 * y, 0.0], atol=1e-12)


def test_the_hands_thumb_is_the_lectures_table():
    """The same rows as the library's thumb, on the wrist and with other lengths."""
    hand, thumb = robokin.load_tree("human-hand").robot("thumb"), robokin.load("thumb", l1=47.69, l2=37.24, l3=30.02)
    q = np.random.default_rng(9).uniform(-1.0, 1.0, (20, 5))
    base = shift(0.190 * 0.048, 0.085 * 0.266, 0.0) @ dh(-math.pi / 2, 0, 0, 0)
    np.testing.assert_allclose(
        robokin.forward_kinematics(hand, q), base @ robokin.forward_kinematics(thumb, q), atol=1e-12
    )


def test_the_hands_poses_do_what_they_are_called():
    """Fingertips meet at pinch and tripod within 3 and 16 mm (a finger's pad is thicker), far off when open."""
    hand = robokin.load_tree("human-hand")
    tips = {name: robokin.tip_poses(hand, q)[:, :3, 3] for name, q in hand.poses.items()}
    assert {*tips} == {"open", "fist", "pinch", "tripod"}
    for q in hand.poses.values():
        assert hand.within_limits(q)
    assert np.linalg.norm(tips["pinch"][0] - tips["pinch"][1]) < 0.003
    assert max(np.linalg.norm(tips["tripod"][0] - tips["tripod"][k]) for k in (1, 2)) < 0.016
    assert np.linalg.norm(tips["open"][0] - tips["open"][1]) > 0.08
    assert np.max(tips["fist"][1:, 0]) < 0.11
    assert np.max(tips["fist"][:, 2]) < 0.0


WRONG = {
    "unknown branch": ("on: palm\n", "on: pal\n", r"7:9: found the unknown branch 'pal'; did you mean 'palm'"),
    "circle": ("palm:  {joints", "palm:  {on: ring, joints", "stand on each other in a circle"),
    "itself": ("palm:  {joints", "palm:  {on: palm, joints", "stand on each other in a circle"),
    "name": ("ring:  {on", "base:  {on", "expected a name of letters"),
    "row": ("a: 26", "b: 26", "found the unknown key 'b'"),
    "key": ("on: palm\n", "onto: palm\n", "found the unknown key 'onto' in the branch index"),
}


@pytest.mark.parametrize("case", WRONG)
def test_what_is_wrong_is_said_with_its_place(case):
    old, new, message = WRONG[case]
    assert old in FINGERS
    with pytest.raises(DescriptionError, match=message):
        read_text(FINGERS.replace(old, new))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("couplings: [{joint: dip, follows: pip}, {joint: pip, follows: dip}]", "go round in a circle"),
        ("couplings: [{joint: dip, follows: dip}]", "go round in a circle"),
        ("couplings: [{joint: mcp, follows: dip}]", "found 'mcp' in several branches"),
        ("couplings: [{joint: dip, follows: pop}]", "found the unknown joint 'pop'"),
        ("couplings: [{joint: dip}]", "expected one of them"),
        ("couplings: [{joint: dip, follows: pip, adds: pip}]", "expected one of them"),
        ("couplings: [{joint: dip, follows: {pip: 1}, ratio: 2}]", "beside a mapping"),
        ("couplings: [{joint: dip, follows: pip}, {joint: dip, follows: pip}]", "found a second coupling"),
        ("couplings: [{joint: dip, follows: pip, ratio: 1e400}]", "ratio"),
        ("couplings: [{joint: dip, follows: pip, ratio: 1e300}]", "multiply its values too far"),
        ("couplings: [{joint: dip, follows: pip, ratio: 1e5}, {joint: pip, adds: index.mcp, ratio: 1e5}]", "too far"),
        ("tips: [index, thumb]", "found the unknown place 'thumb' of a tip"),
        ("tips: [index, index]", "found the tip 'index' twice"),
        ("tips: []", "found no tips"),
        ("poses: {fist: [1, 2, 3]}", "found 3 values in the pose fist, expected 5"),
    ],
)
def test_wrong_couplings_tips_and_poses(text, message):
    with pytest.raises(DescriptionError, match=message) as caught:
        read_text(FINGERS + text + "\n")
    assert caught.value.line == 14


def test_tips_at_inner_links_with_their_own_tools():
    tree = read_text(FINGERS + "tips: [ring, {name: knuckle, on: index.mcp, tool: 'Trans(0, 0, 5)'}]\n")
    T = robokin.tip_poses(tree, np.zeros(5))
    np.testing.assert_allclose(T[1, :3, 3], [0.135, -0.005, 0.02], atol=1e-15)
    with pytest.raises(InputError, match=r"found the unknown link 'thumb'"):
        tree.robot("thumb")
    np.testing.assert_allclose(robokin.forward_kinematics(tree.robot("knuckle"), [0.0, 0.0]), T[1], atol=1e-15)
    chain = tree.robot("index.dip", root="index.mcp")
    assert chain.types == "RR"


def test_load_names_the_tips_of_a_tree(tmp_path):
    path = tmp_path / "fingers.yaml"
    path.write_text(FINGERS)
    with pytest.raises(InputError, match=r"has 2 tips, expected one of index, ring"):
        robokin.load(path)
    assert robokin.load(path, tip="ring").n == 2
    with pytest.raises(InputError, match=r"unknown link 'rin'; did you mean 'ring'"):
        robokin.load(path, tip="rin")
    with pytest.raises(InputError, match=r"is a tree of links, expected a mechanism"):
        robokin.load_mechanism(path)


# Chains in other forms -------------------------------------------------------------------------------------------

FORMS = {
    "screws": """\
convention: screws
base: Trans(10, 20, l) Rot(z, 30)
home: Trans(500, 0, l) Rot(y, 90)
joints:
  - {name: a, type: R, axis: z, limits: [-90, 90]}
  - {name: b, type: R, axis: y, at: [0, 0, l]}
  - {name: c, type: P, axis: [1, 0, 1], sense: -1}
""",
    "ets": """\
base: Rot(x, 20)
ets: tz(l) Rz(q1) tx(100) Ry(-q2) tx(200) Rz(q3 + 90) tz(q4) Rx(30)
limits: [[-90, 90], ~, ~, [0, 50]]
tool: Trans(1, 2, 3)
""",
    "opw": """\
convention: opw
base: Trans(0, 0, l)
a1: 100
a2: -50
b: 10
c1: 300
c2: l
c3: 250
c4: 80
offsets: [0, 0, -90, 0, 0, 180]
senses: [1, 1, -1, 1, -1, 1]
limits: [[-90, 90], ~, ~, ~, ~, ~]
tool: Trans(0, 0, 30) Rot(z, 15)
""",
}
HEAD = "robokin: 1\nname: forms\nunits: {length: mm, angle: deg}\nparameters: {l: 123}\n"


def indented(text):
    return "".join(f"    {line}\n" for line in text.splitlines())


@pytest.mark.parametrize("form", FORMS)
def test_a_branch_in_another_form_is_the_chain_of_the_robot(form):
    """Alone, and on the end of a table; with a table on its own end; the file's convention is that of the tables."""
    robot = read_text(HEAD + FORMS[form])
    branches = (
        f"convention: modified\nbranches:\n  arm:\n{indented(FORMS[form])}"
        "  torso: {joints: [{type: R, a: 70, alpha: 20, d: 30}], tool: 'Trans(1, 2, 3)'}\n"
        f"  other:\n    on: torso\n{indented(FORMS[form])}"
        "  hand: {on: arm, convention: standard, joints: [{name: finger, type: R, a: 70, alpha: 20}]}\n"
    )
    tree = read_text(HEAD + branches)
    assert tree.tips == ("other", "hand")
    n = robot.n
    np.testing.assert_array_equal(tree.limits[:n], robot.limits)
    assert [joint.name for joint in tree.joints[:n]] == [f"arm.{joint.name}" for joint in robot.joints]
    rng = np.random.default_rng(11)
    for _ in range(5):
        q, p, t, f = rng.uniform(-1, 1, n), rng.uniform(-1, 1, n), *rng.uniform(-1, 1, 2)
        other, hand = robokin.tip_poses(tree, [*q, t, *p, f])
        torso = dh(0, 0, 0.07, math.radians(20)) @ dh(t, 0.03, 0, 0) @ shift(0.001, 0.002, 0.003)
        np.testing.assert_allclose(other, torso @ robokin.forward_kinematics(robot, p), atol=1e-14)
        end = robokin.forward_kinematics(robot, q) @ dh(f, 0, 0.07, math.radians(20))
        np.testing.assert_allclose(hand, end, atol=1e-14)
    assert read_text(HEAD + branches).robot("hand").n == n + 1


def test_a_files_convention_is_that_of_branches_that_state_none():
    own = "".join(line + "\n" for line in FORMS["screws"].splitlines() if not line.startswith("convention"))
    tree = read_text(HEAD + f"convention: screws\nbranches:\n  a:\n{indented(own)}  b:\n{indented(FORMS['ets'])}")
    robot = read_text(HEAD + FORMS["screws"])
    q = np.full(tree.n, 0.3)
    np.testing.assert_allclose(robokin.tip_poses(tree, q)[0], robokin.forward_kinematics(robot, q[:3]), atol=1e-15)


def test_joints_of_other_forms_follow_and_are_stood_on():
    text = HEAD + (
        "branches:\n  a: {ets: 'Rz(q1) tx(100) Rz(q2)'}\n  b: {on: a.1, ets: 'tx(50) Rz(q1)'}\n"
        "couplings: [{joint: a.2, follows: b.1, ratio: 2}]\ntips: [a, b]\n"
    )
    tree = read_text(text)
    a, b = robokin.tip_poses(tree, [0.3, 0.2])
    np.testing.assert_allclose(a, dh(0.3, 0, 0.1, 0) @ dh(0.4, 0, 0, 0), atol=1e-15)
    np.testing.assert_allclose(b, dh(0.3, 0, 0.05, 0) @ dh(0.2, 0, 0, 0), atol=1e-15)


@pytest.mark.parametrize(
    ("branch", "message"),
    [
        ("{convention: screws, joints: [{type: R}]}", "7:6: found no 'home' in the branch a"),
        ("{convention: screws, home: '', tool: '', joints: [{type: R}]}", "found 'tool' beside `convention: screws`"),
        ("{convention: opw, c2: 1}", "found no 'c3' in the branch a"),
        ("{ets: 'Rz(q1)', joints: [{type: R}]}", "found 'joints' beside `ets`"),
        ("{ets: 'Rz(q1) Rq(q2)'}", "found the unknown step 'Rq' in ets"),
        ("{ets: 'tz(1)'}", "found no joint in ets"),
        ("{convention: screw, home: '', joints: [{type: R}]}", "did you mean 'screws'"),
        ("{home: '', joints: [{type: R}]}", "found 'home' in a table of joints, expected it only with `convention: sc"),
        ("[1]", "found a list"),
        ("{ets: 'Rz(q1)', name: a}", "found the unknown key 'name' in the branch a"),
    ],
)
def test_mistakes_in_other_forms_have_their_place(branch, message):
    text = HEAD.replace("parameters: {l: 123}\n", "parameters: {l: 123}\n\n") + f"branches:\n  a: {branch}\n"
    with pytest.raises(DescriptionError) as raised:
        read_text(text)
    assert message in str(raised.value)
