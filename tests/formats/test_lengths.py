"""Mechanisms by lengths: what is read, which way is chosen, and every way to write them wrong."""

from __future__ import annotations

import numpy as np
import pytest
from formats.texts import error_of

import robokin
from robokin.errors import InputError
from robokin.formats import load_any, read_text
from robokin.mobility.trace import trace
from robokin.mobility.verdict import mobility_of

FOUR = """robokin: 1
name: Four-bar
space: planar
units: {length: mm, angle: deg}
links:
  - {name: ground,  length: 100}
  - {name: crank,   length: 40}
  - {name: coupler, length: 120}
  - {name: rocker,  length: 80}
joints:
  - {name: A, type: revolute, links: [ground, crank], actuated: true, value: 60}
  - {name: B, type: revolute, links: [crank, coupler]}
  - {name: C, type: revolute, links: [coupler, rocker]}
  - {name: D, type: revolute, links: [rocker, ground]}
"""
SLIDER = """robokin: 1
name: Slider-crank
space: planar
units: {length: mm, angle: deg}
links:
  - {name: ground, places: {A: [0, 0], D: [0, 10]}}
  - {name: crank, length: 30}
  - {name: rod, length: 100}
  - slider
joints:
  - {name: A, type: revolute, links: [ground, crank], actuated: true, value: 50}
  - {name: B, type: revolute, links: [crank, rod]}
  - {name: C, type: revolute, links: [rod, slider]}
  - {name: D, type: prismatic, links: [ground, slider]}
"""


def old(text, a, b):
    assert a in text
    return text.replace(a, b, 1)


def places(mechanism):
    return {joint.name: joint.at[:2] for joint in mechanism.joints}


def test_a_four_bar_is_put_together_in_two_ways():
    ways = [places(read_text(FOUR, mode=number)) for number in (1, 2)]
    B = 0.04 * np.array([0.5, np.sqrt(0.75)])
    for at in ways:
        assert np.allclose(at["A"], [0, 0])
        assert np.allclose(at["B"], B)
        assert np.allclose(at["D"], [0.1, 0])
        assert np.linalg.norm(at["C"] - at["B"]) == pytest.approx(0.12)
        assert np.linalg.norm(at["C"] - at["D"]) == pytest.approx(0.08)
    assert ways[0]["C"][1] > 0 > ways[1]["C"][1]
    mechanism = read_text(FOUR)
    assert (mechanism.mode, len(mechanism.modes), mechanism.modes_complete) == (1, 2, True)
    assert mechanism.modes[0].angles["crank"] == pytest.approx(np.pi / 3)
    assert mobility_of(mechanism).mobility == 1
    assert trace(mechanism, 8).closed


def test_the_file_s_mode_and_the_asked_one():
    text = FOUR + "mode: 2\n"
    assert read_text(text).mode == 2
    assert read_text(text, mode=1).mode == 1
    for mode in (0, 3):
        with pytest.raises(InputError, match=f"--mode: found {mode}, expected 1 or 2"):
            read_text(text, mode=mode)
    with pytest.raises(InputError, match="has the places of its joints"):
        load_any("four-bar", mode=1)
    with pytest.raises(InputError, match="is no mechanism"):
        load_any("puma560", mode=1)


def test_a_slider_crank_slides_where_it_must():
    right, left = (places(read_text(SLIDER, mode=number)) for number in (1, 2))
    x, y = 30 * np.cos(np.radians(50)), 30 * np.sin(np.radians(50))
    reach = np.sqrt(100**2 - (y - 10) ** 2)
    assert np.allclose(1e3 * right["C"], [x + reach, 10])
    assert np.allclose(1e3 * left["C"], [x - reach, 10])
    turned = SLIDER.replace("D: [0, 10]}}", "D: [0, 10]}, directions: {D: 90}}")
    up = places(read_text(turned))
    assert np.allclose(1e3 * up["C"], [0, y + np.sqrt(100**2 - x**2)])
    slide = next(joint for joint in read_text(turned).joints if joint.name == "D")
    assert np.allclose(slide.axes, [[0, 1, 0]], atol=1e-12)


def test_a_drive_that_slides():
    """A crane's boom on a cylinder between two moving links."""
    text = """robokin: 1
name: Crane
space: planar
units: {length: mm, angle: deg}
links:
  - {name: ground, places: {O: [0, 0], A: [60, 0]}}
  - {name: boom, places: {O: [0, 0], B: [80, 0]}}
  - tube
  - rod
joints:
  - {name: O, type: revolute, links: [ground, boom]}
  - {name: A, type: revolute, links: [ground, tube]}
  - {name: S, type: prismatic, links: [tube, rod], actuated: true, value: 100}
  - {name: B, type: revolute, links: [rod, boom]}
"""
    for number, up in ((1, 1), (2, -1)):
        at = places(read_text(text, mode=number))
        assert 1e3 * np.linalg.norm(at["B"] - at["A"]) == pytest.approx(100)
        assert 1e3 * np.linalg.norm(at["B"]) == pytest.approx(80)
        assert np.sign(at["B"][1]) == up
    assert trace(read_text(text), 5).driven == "S"


def test_a_drive_at_the_other_end_is_measured_from_the_ground():
    """The rocker driven at D: its line from D to C stands at the angle."""
    text = old(old(FOUR, ", actuated: true, value: 60", ""), "[rocker, ground]", "[rocker, ground], value: 60")
    for pair in ("[rocker, ground]", "[ground, rocker]"):
        for number in (1, 2):
            at = places(read_text(text.replace("[rocker, ground]", pair), mode=number))
            way = at["C"] - at["D"]
            assert np.degrees(np.arctan2(way[1], way[0])) == pytest.approx(60)


def test_the_ground_may_have_places_on_its_joints():
    text = FOUR.replace("- {name: ground,  length: 100}", "- ground")
    text = text.replace("value: 60", "value: 60, at: [10, 5]").replace(
        "[rocker, ground]", "[rocker, ground], at: [110, 5]"
    )
    a, b = places(read_text(text)), places(read_text(FOUR))
    for name in "ABCD":
        assert np.allclose(a[name], b[name] + [0.01, 0.005])


def test_six_ways_of_a_six_bar():
    six = robokin.load_mechanism("stephenson-by-lengths")
    assert (len(six.modes), six.modes_complete, six.mode) == (6, True, 1)
    heights = [mode.places["B"].imag for mode in six.modes]
    assert heights == sorted(heights, reverse=True)
    other = load_any("stephenson-by-lengths", {"angle": "-100"})
    assert len(other.modes) in (2, 4, 6)


def test_dead_points_and_scales():
    dead = FOUR.replace("value: 60", "value: 0").replace("120", "140")
    mechanism = read_text(dead)
    assert [mode.double for mode in mechanism.modes] == [True]
    for unit, metres in (("m", 1.0), ("in", 0.0254)):
        scaled = read_text(FOUR.replace("length: mm", f"length: {unit}"))
        assert np.allclose(places(scaled)["C"], metres / 1e-3 * places(read_text(FOUR))["C"])


def test_gears_take_part_in_the_motion():
    text = FOUR.replace("joints:", "  - {name: wheel, length: 10}\njoints:").replace(
        "{name: ground,  length: 100}", "{name: ground, places: {A: [0, 0], D: [100, 0], W: [-30, 0]}}"
    )
    text = text.replace("wheel, length: 10}", "wheel, places: {W: [0, 0]}}")
    text += "  - {name: W, type: revolute, links: [ground, wheel], value: 0}\n"
    text += "  - {name: G, type: gear, links: [crank, wheel], ratio: -0.5}\n"
    mechanism = read_text(text)
    assert mobility_of(mechanism).mobility == 1
    found = trace(mechanism, 5)
    assert np.allclose(found.values[:, found.labels.index("W")], -2 * found.values[:, found.labels.index("A")])


@pytest.mark.parametrize(
    ("text", "place", "said"),
    [
        (old(FOUR, "length: 100", "length: 300"), "6:3", "B and D are 282.135 mm apart, which coupler and rocker"),
        (old(FOUR, "length: 100", "length: 300"), "6:3", "do not reach by 82.1347 mm"),
        (old(FOUR, "length: 100", "length: 0"), "6:29", "found 0 as length of link ground, expected more than 0"),
        (old(FOUR, "length: 100", "length: -1"), "6:29", "found -1 as length"),
        (old(FOUR, "length: 100", "length: nan"), "6:29", "expected a finite number"),
        (old(FOUR, "length: 100", "lenght: 100"), "6:21", "did you mean 'length'"),
        (old(FOUR, "length: 100", "length: 100, places: {A: [0, 0]}"), "6:42", "expected one of them"),
        (old(FOUR, "name: crank,   length: 40", "length: 40"), "7:5", "found no 'name' in a link"),
        (old(FOUR, "{name: crank,   length: 40}", "crank"),
         "7:5", "found no length of link crank, which has the joints A, B"),
        (old(FOUR, "name: crank, ", "name: ground, "), "7:5", "found 'ground' twice in the links"),
        (old(FOUR, "{name: crank,   length: 40}", "{name: crank, places: {A: [0, 0]}}"),
         "7:5", "found no place of joint B"),
        (old(FOUR, "{name: crank,   length: 40}", "{name: crank, places: {A: [0, 0], X: [1, 0]}}"), "7:39",
         "found the unknown joint 'X' on link crank"),
        (old(FOUR, "{name: crank,   length: 40}", "{name: crank, places: [0, 1]}"),
         "7:27", "a mapping of joints' names"),
        (old(FOUR, "{name: crank,   length: 40}", "{name: crank, places: {A: 1}}"),
         "7:31", "found '1', expected places"),
        (old(FOUR, "value: 60", "value: sixty"), "11:78", "unknown name 'sixty'"),
        (old(FOUR, ", value: 60", ""),
         "6:3", "found 0 values, which leave 1 free, expected the `value` of 1 more joint"),
        (old(FOUR, "[crank, coupler]", "[crank, coupler], value: 3"), "6:3", "1 more conditions than"),
        (old(FOUR, "[crank, coupler]", "[crank, coupler], at: [3, 4]"),
         "12:60", "expected it only on joints of ground"),
        (old(FOUR, "[rocker, ground]", "[rocker, ground], at: [3, 4]"), "14:60", "beside the shape of ground"),
        (old(FOUR, "space: planar", "space: spatial"), "6:5", "in a mechanism that is not planar"),
        (FOUR + "mode: 3\n", "15:7", "found 3 as the mode, expected 1 or 2"),
        (FOUR + "mode: 1.5\n", "15:7", "found 1.5 as the mode"),
        (FOUR + "mode: up\n", "15:7", "unknown name 'up'"),
        (old(FOUR, "type: revolute, links: [coupler, rocker]", "type: cam, links: [coupler, rocker]"), "13:21",
         "found cam of joint C in a mechanism by lengths"),
        (old(FOUR, "{name: rocker,  length: 80}", "{name: rocker, length: 80}\n  - spare"), "6:3", "leave 3 free"),
        (old(SLIDER, "D: [0, 10]", "D: [0, 200]"), "6:3", "C is 177.019 mm beside the slide D, which rod with 100 mm"),
    ],
)  # fmt: skip
def test_what_is_wrong_has_its_place(text, place, said):
    error = error_of(text)
    assert said in error.message
    assert f"{error.line}:{error.column}" == place


@pytest.mark.parametrize("text", [FOUR, SLIDER])
def test_cut_and_garbled_texts_end_in_a_sentence(text, rng):
    """Lines left out, numbers and words put elsewhere: an answer, or an error with its place."""
    words = ["0", "-1", "1e300", "ground", "[1, 2]", "{}", "~", "x", "A", "length: 3", "value: 2"]
    for _ in range(150):
        lines = text.splitlines()
        for _ in range(int(rng.integers(1, 3))):
            i = int(rng.integers(len(lines)))
            if rng.random() < 0.3:
                del lines[i]
                continue
            parts = lines[i].split(" ")
            parts[int(rng.integers(len(parts)))] = str(rng.choice(words))
            lines[i] = " ".join(parts)
        broken = "\n".join(lines) + "\n"
        try:
            read_text(broken)
        except InputError as error:
            assert "expected" in str(error) or "did you mean" in str(error)
