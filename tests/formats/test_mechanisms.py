"""Links and joints: freedoms, contacts, geometry, and every way to write them wrong."""

from __future__ import annotations

import math

import numpy as np
import pytest
from formats.texts import MECHANISM, error_of, linkage

import robokin
from robokin.errors import InputError
from robokin.formats import load, read_text

# The f of each joint type, as docs/format.md states them.
FREEDOMS = {
    "fixed": 0, "revolute": 1, "prismatic": 1, "helical": 1, "cylindrical": 2, "universal": 2, "spherical": 3,
    "planar": 3, "rolling": 1, "gear": 2, "cam": 2, "belt": 2,
}  # fmt: skip
ONE_CONSTRAINT = ("gear", "cam", "belt")


def only_joint(joint, space="planar"):
    return read_text(linkage(joint, space=space)).joints[0]


# What a joint is -------------------------------------------------------------------------------------


@pytest.mark.parametrize(("kind", "f"), FREEDOMS.items())
@pytest.mark.parametrize("space", ["planar", "spherical", "spatial"])
def test_every_type_and_its_freedoms(kind, f, space):
    text = linkage(f"type: {kind}, links: [ground, crank]", space=space)
    if kind == "rolling" and space != "planar":
        error = error_of(text)
        assert f"found '{kind}' of joint 1 in a {space} mechanism" in error.message
        assert (error.line, error.column) == (6, 12)
    else:
        f = 5 if kind in ONE_CONSTRAINT and space == "spatial" else f
        assert read_text(text).joints[0].freedoms == f


@pytest.mark.parametrize(("space", "order"), [("planar", 3), ("spherical", 3), ("spatial", 6)])
def test_spaces_and_their_order(space, order):
    mechanism = read_text(linkage("type: revolute, links: [ground, crank]", space=space))
    assert mechanism.space == space
    assert mechanism.order == order


@pytest.mark.parametrize("space", ["planar", "spherical", "spatial"])
@pytest.mark.parametrize("n", range(8))
def test_a_custom_joint_states_its_freedoms_up_to_those_of_the_space(space, n):
    text = linkage(f"type: custom, links: [ground, crank], freedoms: {n}", space=space)
    most = 6 if space == "spatial" else 3
    if n > most:
        assert f"expected a whole number from 0 to {most}" in error_of(text).message
    else:
        assert read_text(text).joints[0].freedoms == n


def test_a_joint_of_many_links_counts_as_one_less():
    hinge, gears = "type: revolute, links: [ground, crank, coupler]", "type: gear, links: [crank, rocker]"
    mechanism = read_text(linkage(hinge, gears))
    assert [joint.multiplicity for joint in mechanism.joints] == [2, 1]
    assert mechanism.types == "RRG"
    assert mechanism.joints[0].links == ("ground", "crank", "coupler")


def test_the_ground_is_the_first_link_unless_named():
    joint = "type: revolute, links: [ground, crank]"
    assert read_text(linkage(joint)).ground == "ground"
    assert read_text(linkage(joint, tail="ground: rocker\n")).ground == "rocker"


def test_links_may_be_numbers_and_words():
    head = "robokin: 1\nname: x\nspace: planar\nlinks: [0, 1, no, upper  arm]\n"
    text = head + "joints: [{type: revolute, links: [1, upper arm]}]\n"
    assert read_text(text).links == ("0", "1", "no", "upper arm")


@pytest.mark.parametrize(("text", "driven"), [("", False), (", actuated: true", True), (", actuated: false", False)])
def test_driven_joints(text, driven):
    assert only_joint(f"type: revolute, links: [ground, crank]{text}").actuated is driven


# Geometry --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("unit", "metres"), [("m", 1.0), ("cm", 0.01), ("mm", 0.001), ("in", 0.0254)])
def test_points_and_pitches_are_in_the_unit_of_the_file(unit, metres):
    head = f"parameters: {{r: 2}}\nunits: {{length: {unit}, angle: deg}}\n"
    screw = "type: helical, links: [ground, crank], at: [1, r, -3], axis: [0, 0, 5], pitch: 2*r"
    joint = read_text(linkage(screw, space="spatial", tail=head)).joints[0]
    assert np.allclose(joint.at, metres * np.array([1, 2, -3]), rtol=1e-15)
    assert np.array_equal(joint.axes, [[0, 0, 1]])
    assert joint.pitch == pytest.approx(4 * metres / (2 * math.pi), rel=1e-15)


def test_in_the_plane_two_numbers_are_a_point_and_the_axis_stands_out_of_it():
    joint = only_joint("type: revolute, links: [ground, crank], at: [2*cos(60*pi/180), 1]")
    assert np.allclose(joint.at, [1, 1, 0], atol=1e-15)
    assert np.array_equal(joint.axes, [[0, 0, 1]])
    assert np.array_equal(only_joint("type: revolute, links: [ground, crank], at: [1, 2, 0]").at, [1, 2, 0])


def test_a_slider_in_the_plane_has_the_direction_that_it_states():
    assert only_joint("type: prismatic, links: [ground, crank]").axes is None
    assert np.allclose(only_joint("type: prismatic, links: [ground, crank], axis: [3, 4]").axes, [[0.6, 0.8, 0]])


def test_out_of_the_plane_nothing_is_assumed():
    joint = only_joint("type: revolute, links: [ground, crank]", space="spatial")
    assert joint.at is None
    assert joint.axes is None


def test_the_two_directions_of_a_universal_joint():
    joint = only_joint("type: universal, links: [ground, crank], axes: [[1, 0, 0], [0, 2, 0]]", space="spatial")
    assert np.array_equal(joint.axes, [[1, 0, 0], [0, 1, 0]])


def test_the_normal_of_a_planar_joint():
    joint = only_joint("type: planar, links: [ground, crank], normal: [0, 3, 0]", space="spatial")
    assert np.array_equal(joint.axes, [[0, 1, 0]])


def test_a_screw_without_its_pitch_is_no_hinge():
    joint = only_joint("type: helical, links: [ground, crank], at: [0, 0, 0], axis: [0, 0, 1]", space="spatial")
    assert joint.freedoms == 1
    assert joint.axes is None, "its geometry counts as not given"


def test_everything_read_is_read_only():
    mechanism = read_text(linkage("type: revolute, links: [ground, crank], at: [0, 0]", tail="parameters: {a: 1}\n"))
    for array in (mechanism.joints[0].at, mechanism.joints[0].axes):
        with pytest.raises(ValueError):
            array[...] = 1.0
    with pytest.raises(TypeError):
        mechanism.parameters["b"] = 2.0
    with pytest.raises(AttributeError):
        mechanism.name = "x"


# What is wrong ---------------------------------------------------------------------------------------

PAIR = "links: [ground, crank]"


@pytest.mark.parametrize(
    ("joint", "at", "said"),
    [
        ("links: [ground, crank]", "{", "found no 'type' in joint 1"),
        ("type: revolute", "{", "found no 'links' in joint 1"),
        ("type: rotary, links: [ground, crank]", "rotary, links:", "as the type of joint 1"),
        ("type: revolut, links: [ground, crank]", "revolut, links", "did you mean 'revolute'"),
        ("type: R, links: [ground, crank]", "R, links: [gro", "expected fixed, revolute, prismatic"),
        ("type: revolute, links: ground", "ground", "expected the links of joint 1: a list"),
        ("type: revolute, links: []", "[]", "found 0 links of joint 1, expected at least two"),
        ("type: revolute, links: [ground]", "[ground]", "found 1 link of joint 1, expected at least two"),
        ("name: A, type: revolute, links: [ground, crnk]", "crnk]", "as a link of joint A; did you mean 'crank'"),
        ("type: revolute, links: [ground, zzz]", "zzz]", "expected one of ground, crank, coupler, rocker"),
        ("type: revolute, links: [ground, [crank]]", "[crank]]", "found a list of 1"),
        ("type: revolute, links: [ground, crank, ground]", "[ground, crank", "expected different links"),
        (f"type: chain, {PAIR}", "chain, links:", "expected belt with teeth"),
        (f"type: revolute, {PAIR}, ratio: 2", "2", "expected it only on type gear or belt"),
        (f"type: gear, {PAIR}, radii: [1, 2]", "[1, 2]", "expected it only on type belt"),
        (f"type: gear, {PAIR}, ratio: 2, teeth: [1, 2]", "[1, 2]", "found 'ratio' and 'teeth'"),
        (f"type: gear, {PAIR}, ratio: 0", "0", "found 0 as ratio of joint 1"),
        (f"type: gear, {PAIR}, ratio: 1e99", "1e99", "expected one between"),
        (f"type: gear, {PAIR}, ratio: nan", "nan", "expected a finite number"),
        (f"type: gear, {PAIR}, ratio: [1, 2]", "[1, 2]", "found a list of 2"),
        (f"type: belt, {PAIR}, ratio: -2", "-2", "`crossed: true` turns it round"),
        (f"type: gear, {PAIR}, teeth: [10]", "[10]", "expected 2 values"),
        (f"type: gear, {PAIR}, teeth: [10, 0]", "0]", "found 0 teeth"),
        (f"type: gear, {PAIR}, teeth: [10, 12.5]", "12.5]", "expected a whole number from 1"),
        (f"type: belt, {PAIR}, radii: [10, 0]", "0]", "found 0 as a radius"),
        (f"type: belt, {PAIR}, radii: [10, 20, 30]", "[10, 20, 30]", "expected 2 values"),
        (f"type: belt, {PAIR}, crossed: true", "true", "expected 'ratio', 'radii' or 'teeth' beside it"),
        (f"type: gear, {PAIR}, carrier: ground", "ground", "expected 'ratio' or 'teeth' beside it"),
        (f"type: gear, {PAIR}, ratio: 2, carrier: grund", "grund", "did you mean 'ground'"),
        (f"type: gear, {PAIR}, ratio: 2, axis: [0, 1]", "[0, 1]", "found 'axis' and 'ratio'"),
        (
            "type: gear, links: [ground, crank, coupler], ratio: 2",
            "[ground, cr",
            "found 3 links of joint 1, expected two",
        ),
        ("type: belt, links: [ground, crank, coupler], radii: [1, 2, 3], crossed: true", "true", "radii below 0"),
        (f"type: revolute, {PAIR}, pitch: 1", "1", "a revolute joint, expected it only on type helical"),
        (
            f"type: revolute, {PAIR}, axes: [[1, 0], [0, 1]]",
            "[[1, 0], [0, 1",
            "expected it only on type universal or gear",
        ),
        (f"type: revolute, {PAIR}, normal: [0, 0, 1]", "[0, 0, 1]", "expected it only on type planar"),
        (f"type: revolute, {PAIR}, freedoms: 1", "1", "expected it only on type custom"),
        (f"type: custom, {PAIR}", "custom, links:", "found no 'freedoms' of joint 1, expected freedoms: 0 to 3"),
        (f"type: custom, {PAIR}, freedoms: 1.5", "1.5", "found 1.5 freedoms"),
        (f"type: custom, {PAIR}, freedoms: -1", "-1", "expected a whole number from 0 to 3"),
        (f"type: custom, {PAIR}, freedoms: 1e300", "1e300", "expected a whole number"),
        (f"type: custom, {PAIR}, freedoms: nan", "nan", "expected a finite number"),
        (f"type: custom, {PAIR}, freedoms: two", "two", "unknown name 'two'"),
        (f"type: universal, {PAIR}, axis: [0, 0, 1]", "[0, 0, 1]", "expected its two directions: 'axes'"),
        (f"type: universal, {PAIR}, axes: [[1, 0, 0]]", "[[1, 0, 0]]", "expected 2 values"),
        (f"type: universal, {PAIR}, axes: [[1, 0, 0], [2, 0, 0]]", "[[1, 0, 0], [2", "found parallel axes"),
        (f"type: universal, {PAIR}, axes: [[1, 0, 0], [-1e200, 0, 0]]", "[[1, 0, 0], [-", "found parallel axes"),
        (f"type: universal, {PAIR}, axes: [[1, 0, 0], [0, 0, 0]]", "[0, 0, 0]]", "found zero as axes"),
        (f"type: universal, {PAIR}, axes: [1, 0, 0]", "[1, 0, 0]", "found a list of 3"),
        (f"type: planar, {PAIR}, axis: [0, 0, 1], normal: [0, 0, 1]", "[0, 0, 1], nor", "expected one of them"),
        (f"type: revolute, {PAIR}, at: 5", "5", "found '5', expected at of joint 1: a list"),
        (f"type: revolute, {PAIR}, at: [5]", "[5]", "found a list of 1"),
        (f"type: revolute, {PAIR}, at: [1, 2, 3, 4]", "[1, 2, 3, 4]", "found a list of 4"),
        (f"type: revolute, {PAIR}, at: [1, .inf]", ".inf]", "expected a finite number"),
        (f"type: revolute, {PAIR}, at: [1, 1/0]", "1/0]", "division by zero"),
        (f"type: revolute, {PAIR}, axis: [0, 0, 0]", "[0, 0, 0]", "found zero as axis of joint 1"),
        (f"type: revolute, {PAIR}, axis: z", "z", "expected axis of joint 1: a list"),
        (f"type: revolute, {PAIR}, actuated: yes", "yes", "expected true or false"),
        (f"type: revolute, {PAIR}, actuated: 1", "1", "expected true or false"),
        (f"type: revolute, {PAIR}, actuatd: true", "actuatd: true", "did you mean 'actuated'"),
        (f"type: revolute, {PAIR}, limits: [0, 1]", "limits: [0, 1]", "found the unknown key 'limits' in joint 1"),
    ],
)
def test_a_wrong_joint(joint, at, said):
    """`at` is the text that the error points to."""
    text = linkage(joint)
    error = error_of(text)
    assert said in error.message
    assert error.line == 6
    assert text.splitlines()[5][error.column - 1 :].startswith(at)


@pytest.mark.parametrize("space", ["spherical", "spatial"])
@pytest.mark.parametrize("key", ["at", "axis"])
def test_out_of_the_plane_a_point_has_three_numbers(space, key):
    error = error_of(linkage(f"type: revolute, {PAIR}, {key}: [1, 2]", space=space))
    assert "found a list of 2" in error.message
    assert "expected 3 values" in error.message


def replaced(old, new):
    return (MECHANISM.format(space="planar") + f"  - {{type: revolute, {PAIR}}}\n").replace(old, new)


@pytest.mark.parametrize(
    ("text", "at", "said"),
    [
        (replaced("planar", "plane"), "3:8", "did you mean 'planar'"),
        (replaced("space: planar\n", ""), "1:1", "found no 'space' in a mechanism"),
        (replaced("links: [ground, crank, coupler, rocker]\n", ""), "1:1", "found no 'links' in a mechanism"),
        (replaced("[ground, crank, coupler, rocker]", "ground"), "4:8", "found 'ground', expected the links: a list"),
        (replaced("[ground, crank, coupler, rocker]", "[ground]"), "4:8", "found 1 link, expected at least two"),
        (replaced("[ground, crank, coupler, rocker]", "[]"), "4:8", "found 0 links"),
        (replaced("[ground, crank, coupler, rocker]", "[a, b, a]"), "4:15", "found 'a' twice in the links"),
        (replaced("rocker]", "{name: rocker, b: 1}]"), "4:48", "found the unknown key 'b' in a link"),
        (replaced("[ground, crank, coupler, rocker]", "[a, ~]"), "4:12", "found nothing, expected a name"),
        (replaced("joints:\n", "ground: crnk\njoints:\n"), "5:9", "did you mean 'crank'"),
        (replaced("joints:\n", "ground: [a]\njoints:\n"), "5:9", "expected the ground"),
        (replaced("joints:\n", "tool: Trans(1, 0, 0)\njoints:\n"), "5:1", "unknown key 'tool'"),
        (replaced("joints:\n", "poses: {}\njoints:\n"), "5:1", "unknown key 'poses'"),
        (replaced(f"joints:\n  - {{type: revolute, {PAIR}}}\n", "joints: []\n"), "5:9", "found no joints"),
        (replaced(f"joints:\n  - {{type: revolute, {PAIR}}}\n", "joints: {type: RR}\n"), "5:9", "the joints: a list"),
        (replaced(f"  - {{type: revolute, {PAIR}}}\n", "  - [1]\n"), "6:5", "found a list of 1, expected joint 1"),
        (linkage(f"name: A, type: revolute, {PAIR}", f"name: A, type: revolute, {PAIR}"), "7:5", "on joint 1 too"),
        (replaced("[ground, crank, coupler, rocker]", str([*range(1001)])), "4:8", "found 1001 links"),
        (linkage(*[f"type: revolute, {PAIR}"] * 1001), "6:3", "found 1001 joints"),
    ],
)  # fmt: skip
def test_a_wrong_mechanism(text, at, said):
    error = error_of(text)
    assert said in error.message
    assert f"{error.line}:{error.column}" == at


def test_a_mechanism_is_no_robot():
    with pytest.raises(InputError, match="is a mechanism, expected a robot"):
        load("four-bar")
    assert issubclass(InputError, ValueError)
    assert robokin.Mechanism.__name__ == "Mechanism"


def test_the_four_bar_of_the_format():
    """The example of the format's own page."""
    text = """
robokin: 1
name: Four-bar linkage
space: planar
units: {length: m, angle: deg}
links: [ground, crank, coupler, rocker]
joints:
  - {name: A, type: revolute, links: [ground, crank], at: [0, 0]}
  - {name: B, type: revolute, links: [crank, coupler], at: [0, 2]}
  - {name: C, type: revolute, links: [coupler, rocker], at: [3, 3]}
  - {name: D, type: revolute, links: [rocker, ground], at: [4, 0]}
"""
    mechanism = read_text(text)
    assert mechanism.types == "RRRR"
    assert [joint.name for joint in mechanism.joints] == list("ABCD")
    assert [tuple(joint.at) for joint in mechanism.joints] == [(0, 0, 0), (0, 2, 0), (3, 3, 0), (4, 0, 0)]
