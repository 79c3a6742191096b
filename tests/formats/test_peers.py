"""Descriptions of every format against poses that Pinocchio and MuJoCo find in them, kept as figures."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import DATA, data

import robokin
from robokin.errors import DescriptionError
from robokin.model.graph import Graph, Tip

FOLDER = DATA / "descriptions"
RECORDED = data("peer_poses.json")
NEAR = 1e-9
"""As near as files of other makers have to come [m, or entries of a rotation]."""

SAME_ROBOTS = {"crane.urdf": ("crane.sdf", "crane-1.5.sdf")}
"""Files that say the robot of another in the words of another format."""

CASES = [(entry, name) for entry in RECORDED for name in (entry["file"], *SAME_ROBOTS.get(entry["file"], ()))]
IDS = [name for _, name in CASES]


def poses_of(tree, values):
    """The poses of every link, `link NAME`, and of every tip, `tip NAME`, at joint values by their names."""
    graph = tree.graph
    tips = [Tip(f"link {name}", number) for number, name in enumerate(graph.links)]
    tips += [Tip(f"tip {tip.name}", tip.link, tip.tool) for tip in graph.tips]
    every = Graph(graph.links, graph.joints, graph.root, graph.base, tuple(tips), graph.couplings)
    tree = robokin.Tree(tree.name, every)
    T = robokin.tip_poses(tree, [values[joint.name] for joint in tree.joints])
    return dict(zip(tree.tips, T, strict=True))


@pytest.mark.parametrize(("entry", "name"), CASES, ids=IDS)
def test_every_link_and_site_is_where_a_peer_finds_it(entry, name):
    tree = robokin.load_tree(FOLDER / name, exact=True)
    for row in entry["rows"]:
        assert {joint.name for joint in tree.joints} == row["q"].keys()
        found = poses_of(tree, row["q"])
        base = np.linalg.inv(tree.graph.base) if name != entry["file"] else np.eye(4)
        for place, numbers in row["poses"].items():
            if place == "link world":
                continue
            np.testing.assert_allclose(base @ found[place], [*np.reshape(numbers, (3, 4)), [0, 0, 0, 1]], atol=NEAR)


@pytest.mark.parametrize("entry", RECORDED, ids=lambda entry: entry["file"])
def test_the_figures_tell_who_found_them_and_leave_no_link_out(entry):
    assert entry["peer"].partition(" ")[2] and len(entry["rows"]) >= 4
    tree = robokin.load_tree(FOLDER / entry["file"], exact=True)
    between = {link for link in tree.graph.links if "~" in link}  # links between the joints of one body
    for row in entry["rows"]:
        assert {f"link {name}" for name in tree.graph.links if name not in between} <= row["poses"].keys()


def test_what_follows_is_no_variable():
    followers = {"torso.urdf": {"grip_right", "pad", "nod"}, "claw.xml": {"first_far", "second_near", "second_far"}}
    for name, names in followers.items():
        tree = robokin.load_tree(FOLDER / name)
        assert {coupling.joint for coupling in tree.graph.couplings} == names
        assert not names & {joint.name for joint in tree.joints}


def test_arguments_of_a_xacro_file_change_what_is_built():
    tree = robokin.load_tree(FOLDER / "rig.xacro", foot="false", width="0.6")
    assert tree.n == 6 and tree.tips == ("left_peg", "right_peg")
    np.testing.assert_allclose(poses_of(tree, {joint.name: 0.0 for joint in tree.joints})["link left_hip"][1, 3], 0.3)


@pytest.mark.parametrize(
    ("name", "found", "put", "message"),
    [
        ("torso.urdf", '<axis xyz="0 3 4"/>', '<axis xyz="0 0 0"/>', "axis"),
        ("torso.urdf", '<mimic joint="grip" ', '<mimic joint="pad" ', "circle"),
        ("claw.xml", 'polycoef="0.1 0.7"', 'polycoef="0.1 0.7 0.2"', "polynomial"),
        ("claw.xml", 'euler="20 -35 50"', 'euler="20 -35"', "3 numbers"),
        ("crane.sdf", 'expressed_in="along"', 'expressed_in="alone"', "alone"),
        ("crane-1.5.sdf", "<child>hook</child>", "<child>jib</child>", "closes a loop"),
    ],
)
def test_one_word_wrong_is_refused_at_its_line(tmp_path, name, found, put, message):
    text = (FOLDER / name).read_text()
    assert text.count(found) == 1
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "stand.xml").write_text((FOLDER / "parts" / "stand.xml").read_text())
    (tmp_path / name).write_text(text.replace(found, put))
    with pytest.raises(DescriptionError, match=message) as caught:
        robokin.load_tree(tmp_path / name)
    assert caught.value.line >= text[: text.index(found)].count("\n") - 3
