"""Numbers in descriptions of other formats, and files of far more parts than a robot has."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robokin.errors import DescriptionError
from robokin.formats.mjcf import read_mjcf
from robokin.formats.mjcf_bodies import MOST_BODIES, MOST_SITES
from robokin.formats.mjcf_tree import MOST_BESIDE
from robokin.formats.sdf import read_sdf
from robokin.formats.sdf_models import MOST_FRAMES, MOST_JOINTS, MOST_LINKS
from robokin.formats.xml_numbers import number_at, numbers_at
from robokin.formats.yaml_tree import FilePlace

PLACE = FilePlace("robot.xml", 1, 1, 1)


def one_by_one(text):
    """What a text's words are, each read alone."""
    return tuple(number_at(word, PLACE, "it") for word in text.split())


@pytest.mark.parametrize(
    "text", ["1 2 3", " -1e-3\t+.5\n5. ", "1E5", "0 -0 00012", "", "  ", "1e308 -1e-320", "3 \f\v4"]
)
def test_numbers_together_are_those_one_by_one(text):
    assert numbers_at(text, PLACE, "it", None, []) == one_by_one(text)


@pytest.mark.parametrize(
    "text",
    [
        "1_0",
        "nan",
        "inf",
        "-Infinity",
        "1e999",
        "1e",
        "e5",
        "--1",
        "1-2",
        "1.2.3",
        ".",
        "+",
        "１",
        "1 2x",
        "0x10",
        "1,2",
    ],
)
def test_what_is_no_number_is_refused_however_many_there_are(text):
    for count in (None, 1, 3):
        with pytest.raises(DescriptionError, match="found"):
            numbers_at(f"1 {text} 2", PLACE, "it", count, [])


def test_random_numbers_are_read_to_the_last_digit(rng):
    values = rng.normal(size=200) * 10.0 ** rng.integers(-300, 300, 200)
    text = " ".join(map(repr, values.tolist()))
    assert numbers_at(text, PLACE, "it", 200, []) == tuple(values.tolist())


def test_a_wrong_count_of_numbers_is_told():
    with pytest.raises(DescriptionError, match="3 numbers"):
        numbers_at("1 2", PLACE, "it", 3, [])


def parts(tag, count, inside=""):
    return "".join(f'<{tag} name="{tag[0]}{number}">{inside}</{tag}>' for number in range(count))


def of_model(inside):
    return f'<sdf version="1.7"><model name="m">{inside}</model></sdf>'


JOINT = "<parent>a</parent><child>b</child>"


@pytest.mark.parametrize(
    ("text", "what"),
    [
        (of_model(parts("link", MOST_LINKS + 1)), "links"),
        (of_model('<link name="a"/>' + parts("frame", MOST_FRAMES + 9)), "frames"),
        (of_model(parts("joint", MOST_JOINTS + 1, JOINT)), "joints"),
        (of_model(parts("model", MOST_FRAMES + 1, '<link name="a"/>')), "models"),
        (of_model(f'<model name="in">{parts("link", MOST_LINKS)}</model><link name="one"/>'), "links"),
    ],
)
def test_an_sdf_file_of_too_many_parts_is_refused_with_one_sentence(text, what):
    with pytest.raises(DescriptionError, match=f"more than .* {what}") as caught:
        read_sdf(text, "robot.sdf")
    assert not caught.value.others
    assert caught.value.column > 0


@pytest.mark.parametrize(
    ("inside", "what"),
    [
        (parts("body", MOST_BODIES + 50), "bodies"),
        ('<body name="a">' + parts("site", MOST_SITES + 50) + "</body>", "sites"),
    ],
)
def test_an_mjcf_file_of_too_many_parts_is_refused_with_one_sentence(inside, what):
    with pytest.raises(DescriptionError, match=f"more than .* {what}") as caught:
        read_mjcf(f"<mujoco><worldbody>{inside}</worldbody></mujoco>", "robot.xml")
    assert not caught.value.others


def keyframed(qpos):
    bodies = '<body name="a"><joint name="q"/></body>'
    key = f'<keyframe><key name="home" qpos="{qpos}"/></keyframe>'
    return f"<mujoco><worldbody>{bodies}</worldbody>{key}</mujoco>"


@pytest.mark.parametrize("count", [2, MOST_BESIDE + 7])
def test_a_keyframe_of_another_number_of_values_is_refused_whatever_the_number(count):
    with pytest.raises(DescriptionError, match=f"found {count} values in qpos, expected 1"):
        read_mjcf(keyframed("0 " * count))


def test_keyframes_are_poses():
    tree = read_mjcf(keyframed(" 0.5 "))
    np.testing.assert_array_equal(tree.poses["home"], [0.5])
    assert math.isclose(tree.limits[0, 1], math.inf)
