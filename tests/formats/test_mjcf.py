"""MuJoCo files: poses by the product of their parts, and what is refused with a sentence at its place."""

from __future__ import annotations

import numpy as np
import pytest

from robokin import spatial
from robokin.errors import DescriptionError
from robokin.formats.mjcf import read_mjcf


def mjcf(bodies, before="", after=""):
    return f"<mujoco>{before}<worldbody>{bodies}</worldbody>{after}</mujoco>"


def fk(tree, q):
    """The pose of every link by its name, joint by joint."""
    graph = tree.graph
    S, o = graph.value_map
    values = dict(zip(graph.moving, S @ np.asarray(q, dtype=float) + o, strict=True))
    poses = {graph.root: graph.base}
    for number, joint in enumerate(graph.joints):
        value = values.get(number, 0.0) + joint.zero
        z = [0.0, 0.0, 1.0]
        motion = np.eye(4)
        if joint.moves:
            slides = joint.type == "prismatic"
            motion = trans(0, 0, value) if slides else spatial.rotation_transform(z, value)
        poses[joint.child] = poses[joint.parent] @ joint.before @ motion @ joint.after
    return {name: poses[number] for number, name in enumerate(graph.links)}


def trans(*p):
    return spatial.translation_transform(p)


def turn(axis, angle):
    return spatial.rotation_transform(axis, angle)


def refusal(text, **kwargs):
    with pytest.raises(DescriptionError) as caught:
        read_mjcf(text, "robot.xml", **kwargs)
    return caught.value


def test_joints_of_a_body_move_it_in_turn_each_about_its_point():
    body = """<body name="a" pos="1 2 3" axisangle="1 1 0 33">
      <joint type="slide" axis="1 1 0" ref="0.3"/><joint axis="0 1 1" pos=".1 .2 .3" ref="20"/>
      <joint axis="1 0 0" pos="0 .2 .3"/></body>"""
    q = np.array([0.4, -0.7, 1.1])
    T = trans(1, 2, 3) @ turn([1, 1, 0], np.radians(33)) @ trans(*(np.array([1, 1, 0]) / np.sqrt(2) * (q[0] - 0.3)))
    T = T @ trans(0.1, 0.2, 0.3) @ turn([0, 1, 1], q[1] - np.radians(20)) @ trans(-0.1, -0.2, -0.3)
    T = T @ trans(0, 0.2, 0.3) @ turn([1, 0, 0], q[2]) @ trans(0, -0.2, -0.3)
    tree = read_mjcf(mjcf(body))
    assert tree.graph.links == ("world", "a~1", "a~2", "a")
    np.testing.assert_allclose(fk(tree, q)["a"], T, atol=1e-14)


@pytest.mark.parametrize(
    ("sequence", "product"),
    [("xyz", lambda x, y, z: x @ y @ z), ("XYZ", lambda x, y, z: z @ y @ x), ("xYz", lambda x, y, z: y @ x @ z)],
)
def test_lower_case_turns_about_axes_that_turn_and_upper_case_about_fixed_ones(sequence, product):
    tree = read_mjcf(mjcf('<body name="a" euler="10 20 30"/>', f'<compiler eulerseq="{sequence}"/>'))
    turns = [turn(axis, np.radians(10.0 * (k + 1))) for k, axis in enumerate(np.eye(3))]
    np.testing.assert_allclose(fk(tree, [])["a"], product(*turns), atol=1e-15)


@pytest.mark.parametrize(
    "written",
    ['quat="2 0 0 2"', 'axisangle="0 0 3 90"', 'euler="0 0 90"', 'xyaxes="0 2 0 -1 5 0"'],
)
def test_every_way_to_write_a_quarter_turn(written):
    pose = fk(read_mjcf(mjcf(f'<body name="a" {written}/>')), [])["a"]
    np.testing.assert_allclose(pose, turn([0, 0, 1], np.pi / 2), atol=1e-15)


def test_defaults_nest_and_a_class_beats_the_childclass_beats_main():
    defaults = """<default><joint axis="1 0 0"/><default class="k"><joint range="-30 60"/>
      <default class="kk"><joint axis="0 1 0"/></default></default></default>"""
    body = """<body name="a"><joint name="main"/><body name="b" childclass="k"><joint name="k"/>
      <joint name="kk" class="kk"/></body></body>"""
    tree = read_mjcf(mjcf(body, defaults))
    limits = [(-np.inf, np.inf)] + [tuple(np.radians([-30.0, 60.0]))] * 2
    np.testing.assert_allclose(tree.limits, limits)
    np.testing.assert_allclose(fk(tree, [0, 0, 0.5])["b"], turn([0, 1, 0], 0.5), atol=1e-15)


def test_a_frame_moves_bodies_joints_and_sites_in_it():
    inner = '<frame pos="0 0 1" euler="90 0 0"><joint axis="0 1 0"/><site name="s" pos="0 0 2"/></frame>'
    tree = read_mjcf(mjcf(f'<frame pos="1 0 0"><body name="a" pos="0 1 0">{inner}</body></frame>'))
    R = turn([1, 0, 0], np.pi / 2)
    np.testing.assert_allclose(fk(tree, [0.3])["a"], trans(1, 1, 0) @ turn([0, 0, 1], 0.3), atol=1e-15)
    assert tree.tips == ("s",)
    np.testing.assert_allclose(tree.graph.tips[0].tool, trans(0, 0, 1) @ R @ trans(0, 0, 2), atol=1e-15)


def test_an_equality_of_joints_is_a_coupling_about_their_references():
    body = '<body name="a"><joint name="x" ref="30"/><body name="b"><joint name="y" ref="10"/></body></body>'
    tree = read_mjcf(mjcf(body, after='<equality><joint joint1="x" joint2="y" polycoef=".1 2"/></equality>'))
    (coupling,) = tree.graph.couplings
    x, y = np.radians([30.0, 10.0])
    assert tree.n == 1
    assert (coupling.joint, coupling.ratios) == ("x", (("y", 2.0),))
    assert coupling.offset == pytest.approx(x + 0.1 - 2 * y)


def test_what_floats_is_the_root_and_what_stands_beside_it_is_left_out():
    hand = '<body name="palm" pos="1 0 0"><freejoint/><body name="finger"><joint/></body></body>'
    tree = read_mjcf(mjcf(hand + '<body name="table"/>'))
    assert tree.graph.links == ("palm", "finger")
    assert [note.message.split()[0] for note in tree.notes] == ["palm", "1"]
    np.testing.assert_array_equal(tree.graph.base, trans(1, 0, 0))


def test_a_ball_is_refused_or_three_hinges():
    body = '<body name="a"><joint name="B" type="ball" pos="0 0 1"/></body>'
    assert "ball joint B" in str(refusal(mjcf(body)))
    tree = read_mjcf(mjcf(body), balls=True)
    q = [0.1, 0.2, 0.3]
    R = turn([1, 0, 0], q[0]) @ turn([0, 1, 0], q[1]) @ turn([0, 0, 1], q[2])
    assert [joint.name for joint in tree.joints] == ["B~x", "B~y", "B~z"]
    np.testing.assert_allclose(fk(tree, q)["a"], trans(0, 0, 1) @ R @ trans(0, 0, -1), atol=1e-15)


def test_angles_cut_in_print_are_meant_unless_exact():
    text = mjcf('<body name="a" euler="1.5708 0 0"/>', '<compiler angle="radian"/>')
    tree = read_mjcf(text)
    np.testing.assert_array_equal(fk(tree, [])["a"], turn([1, 0, 0], np.pi / 2))
    assert len(tree.notes) == 1
    assert fk(read_mjcf(text, exact=True), [])["a"][1, 1] == pytest.approx(np.cos(1.5708), abs=1e-15)


def test_keyframes_are_poses():
    text = mjcf(
        '<body><joint name="x"/><joint name="y"/></body>', after='<keyframe><key name="h" qpos="1 2"/></keyframe>'
    )
    np.testing.assert_array_equal(read_mjcf(text).poses["h"], [1.0, 2.0])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (mjcf("", '<compiler coordinate="global"/>'), "global"),
        (mjcf('<body quat="1 0 0 0" euler="0 0 0"/>'), "quat and euler"),
        (mjcf('<body pos="1,2,3"/>'), "no commas"),
        (mjcf('<body pos="1 2"/>'), "3 numbers"),
        (mjcf('<body><joint axis="0 0 0"/></body>'), "length zero"),
        (mjcf('<body><joint type="hing"/></body>'), "did you mean 'hinge'"),
        (mjcf('<body><joint class="no"/></body>'), "unknown class"),
        (mjcf('<body name="a"/><body name="a"/>'), "twice"),
        (mjcf('<replicate count="2"><body/></replicate>'), "<replicate>"),
        (mjcf('<composite type="cable"/>'), "<composite>"),
        (mjcf('<attach model="m"/>'), "<attach>"),
        (mjcf('<include file="a.xml"/>'), "include"),
        (mjcf('<body><joint limited="true" range="1 0"/></body>'), "range"),
        (mjcf('<body name="a"/>', after='<equality><weld body1="a"/></equality>'), "closes a loop"),
        ("<mujoco/>", "worldbody"),
        ("<robot/>", "<mujoco>"),
    ],
)
def test_a_mistake_is_a_sentence_with_its_place(text, words):
    error = refusal(text)
    assert words in error.message
    assert error.line == 1
    assert error.column > 0
    assert error.excerpt


def test_a_file_is_included_once_by_each_of_its_names(tmp_path):
    (tmp_path / "geom.xml").write_text('<mujocoinclude><site name="s"/></mujocoinclude>')
    (tmp_path / "again.xml").symlink_to("geom.xml")
    main = tmp_path / "main.xml"
    two = '<body name="a"><joint/><include file="geom.xml"/></body><body name="b"><include file="{}"/></body>'
    main.write_text(mjcf(two.format("again.xml").replace("</body>", '<site name="t"/></body>', 1)))
    with pytest.raises(DescriptionError, match="site 's' twice"):  # read twice, as it says: names are another matter
        read_mjcf(main)
    (tmp_path / "geom.xml").write_text("<mujocoinclude><geom/></mujocoinclude>")
    assert read_mjcf(main).graph.links == ("world", "a", "b")
    main.write_text(mjcf(two.format("geom.xml")))
    with pytest.raises(DescriptionError, match=r"'geom\.xml' twice"):
        read_mjcf(main)
    (tmp_path / "geom.xml").write_text('<mujocoinclude><include file="again.xml"/></mujocoinclude>')
    main.write_text(mjcf(two.format("none.xml")))
    with pytest.raises(DescriptionError, match=r"'again\.xml' twice"):  # one that includes itself ends too
        read_mjcf(main)


def test_what_stands_on_a_body_that_is_refused_is_no_mistake_of_its_own():
    error = refusal(mjcf('<body name="a"><joint type="ball"/><body name="b"><joint/><body name="c"/></body></body>'))
    assert "ball" in error.message
    assert not error.others


def test_includes_are_read_from_the_folder_once_and_nowhere_else(tmp_path):
    (tmp_path / "part.xml").write_text('<mujocoinclude><body name="a"><joint/></body></mujocoinclude>')
    (tmp_path.parent / "outside.xml").write_text("<mujocoinclude/>")
    main = tmp_path / "main.xml"
    main.write_text(mjcf('<include file="part.xml"/>'))
    assert read_mjcf(main).graph.links == ("world", "a")
    outside = str(tmp_path.parent / "outside.xml")
    for name in ("../outside.xml", outside, "main.xml", "none.xml"):
        main.write_text(mjcf(f'<include file="{name}"/>'))
        with pytest.raises(DescriptionError):
            read_mjcf(main)
    main.write_text(mjcf('<include file="part.xml"/><include file="part.xml"/>'))
    with pytest.raises(DescriptionError, match="twice"):
        read_mjcf(main)
    (tmp_path / "link.xml").symlink_to(outside)
    main.write_text(mjcf('<include file="link.xml"/>'))
    with pytest.raises(DescriptionError, match="outside"):
        read_mjcf(main)


def test_a_text_cut_off_anywhere_ends_in_a_sentence():
    text = mjcf('<body name="a" euler="1 2 3"><joint name="x" range="0 1"/></body>')
    for end in range(len(text)):
        refusal(text[:end])
