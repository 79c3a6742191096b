"""Trees in pictures: every branch is where forward kinematics has it, joints that follow move, names are text."""

from __future__ import annotations

import json
import re
from xml.etree import ElementTree

import numpy as np
import pytest

import robokin
from robokin.errors import InputError
from robokin.model import Tree
from robokin.model.graph import Coupling, Graph, GraphJoint, Tip
from robokin.pictures.arm import arm_of, body_frames, lines_of, plane_of
from robokin.pictures.arm_bars import ends_of
from robokin.pictures.arm_scene import LYING, SLANTING, STANDING, usual_view
from robokin.pictures.skeleton import branches_of, leads_of, skeleton_of
from robokin.spatial import rotation_transform, translation_transform
from robokin.units import Units

from .browser import evaluate, needs_browser

HOSTILE = "</script><b>&\"'"


def moved(x=0.0, y=0.0, z=0.0, turn=0.0):
    return translation_transform([x, y, z]) @ rotation_transform(np.array([0.6, 0.0, 0.8]), turn)


def mixed(**more):
    """A trunk that slides, a gripper whose fingers follow it and each other, a screw, a branch without a tip."""
    joints = (
        GraphJoint("mount", "fixed", 0, 1, 0, moved(0.1, 0.2, 0.3, 0.4)),
        GraphJoint("lift", "prismatic", 1, 2, 1, moved(z=0.2, turn=0.3), moved(0.1), zero=0.05, limits=(-0.1, 0.4)),
        GraphJoint("turn", "revolute", 2, 3, 1, moved(0.3, turn=-1.0), moved(0.02, 0.01, 0.2, 0.3), zero=0.2),
        GraphJoint("screw", "helical", 2, 4, 1, moved(y=0.3, turn=0.8), moved(0.1, turn=0.2), pitch=0.02),
        GraphJoint("left", "revolute", 3, 5, 1, moved(y=0.1), moved(0.1), limits=(-1.0, 1.0)),
        GraphJoint("right", "revolute", 3, 6, 1, moved(y=-0.1), moved(0.1)),
        GraphJoint("nail", "prismatic", 6, 7, 1, moved(0.05, turn=0.1), moved()),
        GraphJoint("flag", "fixed", 3, 8, 0, moved(z=0.3)),
        GraphJoint("spare", "revolute", 0, 9, 1, moved(x=-0.3), moved(z=0.1)),
    )
    tips = (Tip("left", 5, moved(0.05)), Tip("nail", 7), Tip("screw", 4, moved(0.1, turn=0.5)), Tip("wrist", 3))
    couplings = (
        Coupling("right", (("left", -1.0),), 0.1),
        Coupling("nail", (("right", 0.02), ("lift", 0.5)), 0.01),
        Coupling("screw", (("turn", 2.0),), own=True),
    )
    links = ("ground", *(joint.name for joint in joints))
    fields = {"id": "mixed", "units": Units("cm", "deg")} | more
    return Tree("A <mixed> tree", Graph(links, joints, 0, moved(0.2, turn=0.7), tips, couplings), **fields)


FINGERS = """\
robokin: 1
name: Two fingers
units: {length: mm, angle: deg}
branches:
  palm:  {joints: [{name: wrist, type: revolute, alpha: 90, limits: [-60, 60]}]}
  index:
    {on: palm, base: "Trans(90, 20, 0)",
     joints: [{name: mcp, type: revolute, a: 45}, {name: pip, type: revolute, a: 26}, {name: dip, type: R, a: 20}]}
  ring:  {on: palm, base: "Trans(88, -18, 0)", joints: [{name: mcp, type: revolute, a: 41}]}
couplings: [{joint: index.dip, follows: index.pip, ratio: 2/3, offset: 5}]
"""


@pytest.fixture
def load(tmp_path):
    def load(name):
        if name == "mixed":
            return mixed()
        if name != "fingers":
            return robokin.load_tree(name)
        path = tmp_path / "fingers.yaml"
        path.write_text(FINGERS)
        return robokin.load_tree(path)

    return load


NAMES = ["human-hand", "fingers", "mixed", "puma560"]


def data_of(tree, **more):
    page = robokin.draw(tree, kind="html", **more).data
    (text,) = re.findall(r'<script id="data" type="application/json">(.*?)</script>', page.decode(), re.DOTALL)
    return json.loads(text)


@pytest.mark.parametrize("name", NAMES)
def test_tips_are_where_forward_kinematics_has_them(name, load, rng):
    tree = load(name)
    skeleton = skeleton_of(tree)
    assert [tip.name for tip in skeleton.tips] == list(tree.tips)
    for q in rng.uniform(-1.0, 1.0, (20, tree.n)):
        frames = skeleton.frames(q)
        found = [frames[tip.body] @ tip.T for tip in skeleton.tips]
        assert np.allclose(found, robokin.tip_poses(tree, q), atol=1e-12)


@pytest.mark.parametrize("name", NAMES)
def test_lines_run_from_the_root_or_a_line_to_every_tip(name, load, rng):
    tree = load(name)
    arm, q = arm_of(tree), rng.uniform(-1.0, 1.0, tree.n)
    lines = lines_of(arm, body_frames(tree, q))
    assert np.allclose(lines[0][0], tree.graph.base[:3, 3], atol=1e-12)
    # Each further line begins where others pass; every tip is an end of one, or on its way.
    before = lines[0]
    for line in lines[1:]:
        assert np.min(np.linalg.norm(before - line[0], axis=1)) < 1e-9
        before = np.concatenate([before, line])
    for T in robokin.tip_poses(tree, q):
        assert np.min(np.linalg.norm(before - T[:3, 3], axis=1)) < 1e-9


@pytest.mark.parametrize("name", ["puma560", "scara", "stanford", "puma560-craig", "gen3", "assembly"])
def test_a_tree_of_one_branch_is_drawn_as_the_arm(name, rng):
    robot, tree = robokin.load(name), robokin.load_tree(name)
    q = rng.uniform(-1.0, 1.0, robot.n)
    one, other = arm_of(robot), arm_of(tree)
    assert one.length == pytest.approx(other.length)
    assert [(bar.role, bar.bodies, bar.sides) for bar in one.bars] == [
        (bar.role, bar.bodies, bar.sides) for bar in other.bars
    ]
    for a, b in zip(one.bars, other.bars, strict=True):
        assert a.width == pytest.approx(b.width)
        assert np.allclose(ends_of(a, body_frames(robot, q)), ends_of(b, body_frames(tree, q)), atol=1e-9)
    assert (one.palms, other.palms, one.forked) == ((), (), False)
    assert usual_view(robot) == usual_view(tree)


def test_a_table_whose_frames_stand_far_from_the_arm_is_drawn_where_it_is(tmp_path):
    path = tmp_path / "arm.yaml"
    path.write_text("""
robokin: 1
name: Axes that are parallel but for a trifle
units: {length: m, angle: rad}
joints:
  - {type: R, d: 0.1, alpha: 1.5708}
  - {type: R, a: 0.4, alpha: 0.0001, d: 800}
  - {type: R, a: 0.3, d: -800}
  - {type: R, d: 0.1, alpha: 1.57}
""")
    robot = robokin.load(path)
    q = np.array([0.1, 0.2, 0.3, 0.4])
    frames = body_frames(robot, q)
    tool = arm_of(robot).marks[-1]
    assert np.allclose(frames[tool.body] @ tool.T, robokin.forward_kinematics(robot, q), atol=1e-9)


def test_the_hand_has_a_palm_and_its_joints_are_sized_by_their_fingers():
    hand = robokin.load_tree("human-hand")
    arm = arm_of(hand)
    (palm,) = arm.palms
    assert palm.body == 0
    assert len(palm.corners) == 6  # the wrist, the thumb's saddle and four knuckles
    assert np.allclose(palm.corners[:, 2], 0.0, atol=1e-9)
    joints = [bar for bar in arm.bars if bar.role == "revolute"]
    assert len(joints) == hand.n == 21
    shortest = min(0.097 * 0.19, 0.093 * 0.19)  # the last bones of index and little finger
    assert max(2.0 * bar.width for bar in joints) < shortest
    assert not [bar for bar in arm.bars if bar.role == "base"]


def test_a_thumb_beside_the_plane_leaves_the_palm_to_the_others_and_three_in_a_row_have_none():
    def fan(places):
        joints = [
            GraphJoint(f"j{i}", "revolute", 0, i, 1, moved(*place), moved(0.1)) for i, place in enumerate(places, 1)
        ]
        tips = tuple(Tip(f"t{i}", i) for i in range(1, len(joints) + 1))
        return Tree("fan", Graph(("base", *(tip.name for tip in tips)), tuple(joints), tips=tips))

    knuckles = [(0.1, 0.03 * i, 0.0) for i in range(4)]
    (palm,) = arm_of(fan([*knuckles, (0.05, 0.0, 0.06)])).palms
    assert np.allclose(palm.corners[:, 2], 0.0)
    assert len(palm.corners) == 5
    assert arm_of(fan([(0.1, 0.0, 0.0), (0.2, 0.0, 0.0)])).palms == ()
    assert arm_of(fan([(0.1, 0.0, 0.0), (0.0, 0.1, 0.0), (0.0, 0.0, 0.1), (-0.1, -0.1, -0.1)])).palms == ()


def test_a_hand_is_seen_from_above_and_a_standing_body_from_the_front():
    assert usual_view(robokin.load_tree("human-hand")) == (LYING, False)

    def pair(*ends):
        joints = tuple(GraphJoint(f"j{i}", "revolute", 0, i, 1, moved(*end, 0.3), moved(z=-0.1, y=0.02 * i))
                       for i, end in enumerate(ends, 1))  # fmt: skip
        return Tree("pair", Graph(("base", "a", "b"), joints, tips=(Tip("a", 1), Tip("b", 2))))

    assert usual_view(pair((0.0, 0.5, 1.0), (0.0, -0.5, 1.0))) == (STANDING, False)
    assert usual_view(pair((0.9, 0.9, 0.9), (-0.9, 0.0, 0.0))) == (SLANTING, False)
    assert plane_of(mixed()) is None


def test_sliders_stand_in_branches_and_name_the_joints_that_follow(load):
    fingers = load("fingers")
    assert branches_of(fingers) == [("palm", [0]), ("index", [1, 2]), ("ring", [3])]
    assert [leads_of(fingers, i) for i in range(4)] == [[], [], ["index.dip"], []]
    assert branches_of(robokin.load("puma560")) == [("", [0, 1, 2, 3, 4, 5])]
    tree = mixed()
    named = [name for name, _ in branches_of(tree)]
    assert sorted(i for _, members in branches_of(tree) for i in members) == list(range(tree.n))
    assert len(set(named)) == len(named)
    assert leads_of(tree, 0) == ["nail"]  # lift
    assert leads_of(tree, [joint.name for joint in tree.joints].index("turn")) == ["screw"]


def test_a_joint_without_a_known_motion_is_refused():
    joint = GraphJoint("free", "floating", 0, 1, 6)
    tree = Tree("free", Graph(("a", "b"), (joint,), tips=(Tip("b", 1),)))
    with pytest.raises(InputError, match="joint free is floating, expected a hinge, a slide or a screw"):
        arm_of(tree)
    unknown = GraphJoint("nowhere", "revolute", 0, 1, before=np.full((4, 4), np.nan))
    with pytest.raises(InputError, match="nowhere has no axis"):
        arm_of(Tree("x", Graph(("a", "b"), (unknown,), tips=(Tip("b", 1),))))


@needs_browser
@pytest.mark.parametrize("name", ["human-hand", "fingers", "mixed"])
def test_forward_kinematics_in_the_page_is_that_of_every_tip(name, load, rng, tmp_path):
    tree = load(name)
    q = rng.uniform(-50.0, 50.0, (20, tree.n))
    page = robokin.draw(tree, kind="html").data
    script = f"""
    const q = {json.dumps(q.tolist())}, tip = document.getElementById("tip"), found = q.map(window.robokin.tips);
    tip.value = 1; tip.dispatchEvent(new Event("change"));
    return [found, q.map(window.robokin.fk)];
    """
    found, chosen = evaluate(page, script, tmp_path)
    T = robokin.tip_poses(tree, q * np.where(tree.revolute, tree.units.radians, tree.units.metres))
    T[..., :3, 3] /= tree.units.metres
    assert [*found[0]] == list(tree.tips)
    answer = np.array([[poses[tip] for tip in tree.tips] for poses in found])
    assert np.max(np.abs(answer - T)) < 1e-9
    assert np.allclose(chosen, T[:, 1], atol=1e-9)


@needs_browser
def test_a_slider_moves_what_follows_it_and_poses_are_buttons(load, tmp_path):
    fingers = load("fingers")
    script = """
    const $ = (id) => document.getElementById(id), shown = () => ["x", "y", "z"].map((id) => +$(id).textContent);
    $("slider3").value = 30; $("slider3").dispatchEvent(new Event("input"));
    const bent = shown();
    $("tip").value = 1; $("tip").dispatchEvent(new Event("change"));
    return {bent, other: shown(), groups: [...document.querySelectorAll("summary")].map((e) => e.textContent),
      leads: [...document.querySelectorAll(".leads")].map((e) => e.textContent), q: window.robokin.q()};
    """
    answer = evaluate(robokin.draw(fingers, kind="html").data, script, tmp_path)
    T = robokin.tip_poses(fingers, np.radians(answer["q"]))
    assert answer["q"] == [0, 0, 30, 0]
    assert np.allclose(answer["bent"], 1e3 * T[0, :3, 3], atol=0.006)
    assert np.allclose(answer["other"], 1e3 * T[1, :3, 3], atol=0.006)
    assert answer["groups"] == ["palm", "index", "ring"]
    assert answer["leads"] == ["moves index.dip too"]
    hand = robokin.load_tree("human-hand")
    script = """
    const buttons = [...document.querySelectorAll("#poses button")];
    buttons.find((button) => button.textContent === "fist").click();
    return [buttons.map((button) => button.textContent), window.robokin.q(),
      [...document.querySelectorAll("details")].map((group) => group.open)];
    """
    names, q, opened = evaluate(robokin.draw(hand, kind="html").data, script, tmp_path)
    assert names == ["reset", "default", *hand.poses]
    assert np.allclose(np.radians(q), hand.poses["fist"])
    assert opened == [True, False, False, False, False], "of many joints one branch is open"


@needs_browser
def test_names_from_a_file_are_text_on_the_page(tmp_path):
    joints = (
        GraphJoint(HOSTILE, "revolute", 0, 1, 1, moved(0.1), moved(0.1)),
        GraphJoint("<img src=x onerror=alert(1)>", "revolute", 0, 2, 1, moved(0.1, 0.1), moved(0.1)),
    )
    tips = (Tip(HOSTILE, 1), Tip("<i>", 2))
    coupling = Coupling("<img src=x onerror=alert(1)>", ((HOSTILE, 0.5),))
    tree = Tree(HOSTILE, Graph(("base", "a", "<u>"), joints, tips=tips, couplings=(coupling,)), poses={"<s>": [0.1]})
    page = robokin.draw(tree, kind="html", frames=True).data
    assert page.count(b"<b>") == page.count(b"<img") == page.count(b"<i>") == page.count(b"<s>") == 0
    script = 'return [Object.keys(window.robokin.tips([0])), document.querySelectorAll("b, img, i, u, s").length];'
    names, elements = evaluate(page, script, tmp_path)
    assert names == [HOSTILE, "<i>"]
    assert elements == 0
    pytest.importorskip("matplotlib")
    words = "".join(ElementTree.fromstring(robokin.draw(tree, kind="svg").data.decode()).itertext())
    assert HOSTILE in words


def test_a_page_is_small_and_a_hand_of_sixty_joints_too():
    arms = [(f"a{i}", i) for i in range(10)]
    joints, links = [], ["base"]
    for name, i in arms:
        for k in range(6):
            parent = 0 if k == 0 else len(links) - 1
            links.append(f"{name}.{k}")
            joints.append(GraphJoint(f"{name}.{k}", "revolute", parent, len(links) - 1, 1,
                                     moved(0.0, 0.1 * i) if k == 0 else moved(0.2), moved(turn=0.1)))  # fmt: skip
    tips = tuple(Tip(name, links.index(f"{name}.5"), moved(0.1)) for name, _ in arms)
    tree = Tree("many", Graph(tuple(links), tuple(joints), tips=tips))
    assert tree.n == 60
    assert [name for name, _ in branches_of(tree)] == [name for name, _ in arms]
    assert len(robokin.draw(tree, kind="html").data) < 100_000
    assert len(robokin.draw(robokin.load_tree("human-hand"), kind="html").data) < 60_000


@pytest.mark.parametrize("pose", ["", "open", "fist", "pinch", "tripod"])
def test_the_text_is_a_page_of_80_columns_with_the_names_of_tips(pose):
    hand = robokin.load_tree("human-hand")
    text = str(robokin.draw(hand, hand.poses[pose] if pose else None, "text"))
    assert max(map(len, text.splitlines())) <= 80
    for tip in hand.tips:
        assert tip in text
    assert "[mm]" in text


def test_names_of_tips_far_too_long_are_cut_in_text():
    hand = robokin.load_tree("human-hand")
    graph = hand.graph
    tips = tuple(Tip("x" * 70 + str(i), tip.link, tip.tool) for i, tip in enumerate(graph.tips))
    tree = Tree("long", Graph(graph.links, graph.joints, graph.root, graph.base, tips))
    text = str(robokin.draw(tree, kind="text"))
    assert max(map(len, text.splitlines())) <= 80
    assert "xxx…" in text


def test_a_still_names_the_tips_and_ghosts_are_called_by_their_poses():
    pytest.importorskip("matplotlib")
    hand = robokin.load_tree("human-hand")
    drawing = robokin.draw(hand, [hand.poses["pinch"], hand.poses["open"], np.full(21, 0.01)], "svg")
    words = "\n".join(ElementTree.fromstring(drawing.data.decode()).itertext())
    for word in ("Human hand", "q = pinch", "1  pinch", "2  open", "3  configuration 3", "middle", "ring", "little"):
        assert word in words
    assert robokin.draw(hand, kind="svg").data == robokin.draw(hand, kind="svg").data
    frames = robokin.draw(hand, kind="svg", frames=True).data.decode()
    assert "index.pip" in frames
    assert "index.pip" not in robokin.draw(hand, kind="svg").data.decode()


@pytest.mark.parametrize("q", [[0.0] * 20, [0.0] * 22, [[0.0] * 21] * 0, 1.0, [np.nan] * 21])
def test_q_of_another_length_is_refused(q):
    with pytest.raises(InputError, match=r"^q: "):
        robokin.draw(robokin.load_tree("human-hand"), q, "text")


def test_what_is_too_far_away_is_refused():
    with pytest.raises(InputError, match="too long for a picture"):
        robokin.draw(mixed(), [1e9, 0.0, 0.0, 0.0, 0.0], "text")


def test_names_in_wide_letters_and_of_tips_in_one_place_find_room():
    graph = robokin.load_tree("human-hand").graph
    wide = tuple(Tip("指" * k, tip.link, tip.tool) for k, tip in enumerate(graph.tips, start=1))
    text = str(robokin.draw(Tree("手", Graph(graph.links, graph.joints, tips=wide)), kind="text"))
    columns = [len(line) + line.count("指") for line in text.splitlines()]
    assert max(columns) <= 80
    assert sorted(line.count("指") for line in text.splitlines())[-1] >= 5
    middle = graph.tips[2]
    together = tuple(Tip(f"finger {k}", middle.link, middle.tool) for k in range(5))
    text = str(robokin.draw(Tree("one", Graph(graph.links, graph.joints, tips=together)), kind="text"))
    for k in range(5):
        assert f"finger {k}" in text
