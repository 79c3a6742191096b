"""SDF files: poses by the product of their parts, what an axis is in by version, what is refused with a sentence."""

from __future__ import annotations

import numpy as np
import pytest

from robokin import spatial
from robokin.errors import DescriptionError
from robokin.formats.sdf import read_sdf

AXIS = "<axis><xyz>1 0 0</xyz></axis>"


def sdf(model, version="1.7", name="m"):
    return f'<sdf version="{version}"><model name="{name}">{model}</model></sdf>'


def link(name, pose=""):
    return f'<link name="{name}">{pose}</link>'


def joint(name, parent, child, inside=AXIS, kind="revolute"):
    return f'<joint name="{name}" type="{kind}"><parent>{parent}</parent><child>{child}</child>{inside}</joint>'


def trans(*p):
    return spatial.translation_transform(p)


def turn(axis, angle):
    return spatial.rotation_transform(axis, angle)


def step(graph_joint, value):
    """The pose of a joint's child in its parent at a value [rad]."""
    return graph_joint.before @ turn([0, 0, 1], value) @ graph_joint.after


def refusal(text, **kwargs):
    with pytest.raises(DescriptionError) as caught:
        read_sdf(text, "robot.sdf", **kwargs)
    return caught.value


def test_links_are_in_the_model_and_a_joint_is_in_its_child():
    a, b = "<pose>0 0 1 0 0 .5</pose>", "<pose>1 0 2 .3 0 0</pose>"
    text = sdf(
        "<pose>5 0 0 0 0 0</pose>"
        + link("a", a)
        + link("b", b)
        + joint("j", "a", "b", "<pose>0 0 -1 0 0 0</pose>" + AXIS)
    )
    T_a, T_b = trans(0, 0, 1) @ turn([0, 0, 1], 0.5), trans(1, 0, 2) @ turn([1, 0, 0], 0.3)
    tree = read_sdf(text)
    expected = np.linalg.inv(T_a) @ T_b @ trans(0, 0, -1) @ turn([1, 0, 0], 0.7) @ trans(0, 0, 1)
    np.testing.assert_allclose(step(tree.joints[0], 0.7), expected, atol=1e-14)
    np.testing.assert_allclose(tree.graph.base, trans(5, 0, 0) @ T_a, atol=1e-15)
    assert tree.tips == ("b",)


@pytest.mark.parametrize(
    ("version", "axis", "in_model"),
    [
        ("1.4", AXIS, True),
        ("1.6", AXIS, False),
        ("1.6", "<axis><xyz>1 0 0</xyz><use_parent_model_frame>1</use_parent_model_frame></axis>", True),
        ("1.7", AXIS, False),
        ("1.7", '<axis><xyz expressed_in="__model__">1 0 0</xyz></axis>', True),
        ("1.7", '<axis><xyz expressed_in="a">1 0 0</xyz></axis>', True),
    ],
)
def test_what_an_axis_is_in_depends_on_the_version(version, axis, in_model):
    tree = read_sdf(sdf(link("a") + link("b", "<pose>0 0 0 0 0 1</pose>") + joint("j", "a", "b", axis), version))
    R = turn([0, 0, 1], 1.0)
    expected = turn([1, 0, 0], 0.4) @ R if in_model else R @ turn([1, 0, 0], 0.4)
    np.testing.assert_allclose(step(tree.joints[0], 0.4), expected, atol=1e-15)


def test_poses_are_in_what_they_name_and_frames_on_the_last_link_are_tips():
    model = link("a", "<pose>1 0 0 0 0 0</pose>") + link("b", '<pose relative_to="j">0 0 1 0 0 0</pose>')
    model += joint("j", "a", "b", '<pose relative_to="a">0 2 0 0 0 0</pose>' + AXIS)
    model += '<frame name="tool" attached_to="b"><pose>0 0 3 0 0 0</pose></frame>'
    tree = read_sdf(sdf(model))
    np.testing.assert_allclose(
        step(tree.joints[0], 0.4), trans(0, 2, 0) @ turn([1, 0, 0], 0.4) @ trans(0, 0, 1), atol=1e-15
    )
    assert tree.tips == ("tool",)
    np.testing.assert_array_equal(tree.graph.tips[0].tool, trans(0, 0, 3))


def test_names_in_a_nested_model_have_its_name_before_them():
    inner = (
        '<model name="N" placement_frame="b"><pose>0 0 1 0 0 0</pose>'
        + link("b", "<pose>1 0 0 0 0 0</pose>")
        + "</model>"
    )
    tree = read_sdf(sdf(link("a") + inner + joint("k", "a", "N::b"), "1.8"))
    assert tree.graph.links == ("a", "N::b")
    np.testing.assert_allclose(step(tree.joints[0], 0.0), trans(0, 0, 1), atol=1e-15)


def test_limits_of_1e16_are_none_and_a_mimic_is_a_coupling():
    limit = "<limit><lower>-1e16</lower><upper>2</upper></limit>"
    mimic = '<mimic joint="j"><multiplier>2</multiplier><offset>.5</offset><reference>.1</reference></mimic>'
    model = link("a") + link("b") + link("c") + joint("j", "a", "b", f"<axis>{limit}</axis>")
    tree = read_sdf(sdf(model + joint("k", "b", "c", f"<axis>{mimic}</axis>")))
    np.testing.assert_array_equal(tree.limits, [[-np.inf, 2.0]])
    (coupling,) = tree.graph.couplings
    assert (coupling.joint, coupling.ratios, coupling.offset) == ("k", (("j", 2.0),), pytest.approx(0.3))


def test_two_axes_are_two_joints_and_a_screw_advances():
    axes = "<axis><xyz>1 0 0</xyz></axis><axis2><xyz>0 1 0</xyz></axis2>"
    tree = read_sdf(sdf(link("a") + link("b") + joint("u", "a", "b", axes, "universal")))
    first, second = tree.joints
    assert (first.name, second.name) == ("u~1", "u~2")
    np.testing.assert_allclose(
        step(first, 0.3) @ step(second, 0.4), turn([1, 0, 0], 0.3) @ turn([0, 1, 0], 0.4), atol=1e-15
    )
    screw = "<screw_thread_pitch>0.5</screw_thread_pitch>" + AXIS
    (one,) = read_sdf(sdf(link("a") + link("b") + joint("s", "a", "b", screw, "screw"))).joints
    assert (one.type, one.pitch) == ("helical", pytest.approx(0.5 / (2 * np.pi)))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (sdf(link("a") + link("b") + joint("j", "a", "b") + joint("k", "b", "a")), "circle"),
        (sdf(link("a") + link("b") + link("c") + joint("j", "a", "c") + joint("k", "b", "c")), "closes a loop"),
        (sdf(link("a") + joint("j", "a", "a")), "itself"),
        (sdf(link("a") + joint("j", "x", "a")), "unknown name"),
        (sdf(link("a", '<pose relative_to="a"/>')), "circle"),
        (sdf(link("a") + link("a")), "twice"),
        (sdf(link("a") + "<include><uri>model://x</uri></include>"), "<include>"),
        (sdf(link("a") + link("b") + joint("j", "a", "b", "")), "without <axis>"),
        (sdf(link("a") + link("b") + joint("j", "a", "b", "<axis><xyz>0 0 0</xyz></axis>")), "length zero"),
        (sdf(link("a") + link("b") + joint("j", "a", "b", AXIS, "gearbox")), "gearbox"),
        (sdf(link("a") + link("b") + joint("j", "a", "b", "", "ball")), "ball joint j"),
        (sdf(link("a", "<pose>0 0 nan 0 0 0</pose>")), "nan"),
        (sdf(""), "without links"),
        (sdf(link("a"), ""), "version"),
        ("<robot/>", "<sdf>"),
    ],
)
def test_a_mistake_is_a_sentence_with_its_place(text, words):
    error = refusal(text)
    assert words in error.message
    assert error.line == 1
    assert error.column > 0
    assert error.excerpt


def test_a_long_chain_of_frames_is_worked_out_once():
    frames = "".join(f'<frame name="f{i}" attached_to="{f"f{i - 1}" if i else "a"}"/>' for i in range(20_000))
    assert len(read_sdf(sdf(link("a") + frames)).tips) == 20_000


def test_a_text_cut_off_anywhere_ends_in_a_sentence():
    text = sdf(link("a") + link("b") + joint("j", "a", "b"))
    for end in range(len(text)):
        refusal(text[:end])
