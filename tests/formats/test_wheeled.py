"""Descriptions of wheeled bases: what is read, and what is said of wrong ones."""

from __future__ import annotations

import copy
import math
import pickle

import pytest
import yaml
from formats.test_schema import SCHEMA, errors
from formats.texts import error_of

import robokin
from robokin.errors import InputError
from robokin.formats import load_any, read_text
from robokin.model import WheeledBase

HEAD = "robokin: 1\nkind: wheeled\nname: base\nunits: {length: mm, angle: deg}\n"


def base(*wheels, tail="", head=HEAD):
    rows = "".join(f"  - {{{wheel}}}\n" for wheel in wheels or ["type: fixed, at: [0, 100]"])
    return f"{head}wheels:\n{rows}{tail}"


def test_a_base_is_read():
    text = base(
        "name: left, type: fixed, at: [0, half], radius: r, driven: true",
        "type: steered, at: [300, -half/2], angle: -30, turned: true",
        "type: castor, at: [-300, 0], offset: 20, radius: 25",
        "type: swedish, at: [1, 2], roller: 45",
        head=HEAD + "parameters: {half: 160, r: 50}\ndescription: a base\nsource: nowhere\nsteering: parallel\n",
        tail="expected: {mobility: 1, steerability: 1, manoeuvrability: 2}\n",
    )
    read = read_text(text, id="b")
    assert isinstance(read, WheeledBase)
    assert (read.id, read.name, read.description, read.source) == ("b", "base", "a base", "nowhere")
    assert (read.parallel, read.types) == (True, "1 fixed, 1 steered, 1 castor, 1 swedish")
    assert dict(read.expected) == {"mobility": 1, "steerability": 1, "manoeuvrability": 2}
    left, front, castor, omni = read.wheels
    assert (left.name, left.x, left.y, left.angle, left.radius) == ("left", 0.0, pytest.approx(0.16), 0.0, 0.05)
    assert (left.driven, left.turned) == (True, False)
    assert (front.name, front.y, front.turned) == ("2", pytest.approx(-0.08), True)
    assert front.angle == pytest.approx(math.radians(-30))
    assert (castor.offset, castor.radius) == (0.02, 0.025)
    assert omni.roller == pytest.approx(math.pi / 4)
    assert list(errors(yaml.safe_load(text), SCHEMA)) == []
    assert repr(read) == "<WheeledBase 'b': 4 wheels>"
    for other in (copy.deepcopy(read), pickle.loads(pickle.dumps(read))):
        assert (other.wheels, dict(other.parameters)) == (read.wheels, dict(read.parameters))


def test_parameters_can_be_set():
    assert robokin.load_wheeled("differential-drive", half_track=200).wheels[0].y == pytest.approx(0.2)


@pytest.mark.parametrize(
    ("wheel", "at", "said"),
    [
        ("type: fixd, at: [0, 0]", "fixd", "did you mean 'fixed'"),
        ("type: mecanum, at: [0, 0]", "mecanum", "expected swedish with roller: 45 degrees"),
        ("type: Omni, at: [0, 0]", "Omni", "expected swedish with roller: 90 degrees"),
        ("type: caster, at: [0, 0]", "caster", "expected castor"),
        ("type: [fixed], at: [0, 0]", "[fixed]", "expected the type of wheel 1"),
        ("at: [0, 0]", "{at", "found no 'type' in wheel 1"),
        ("type: fixed", "{type", "found no 'at' in wheel 1"),
        ("type: fixed, at: [0]", "[0]", "found a list of 1 as at of wheel 1, expected 2 values"),
        ("type: fixed, at: [0, 0, 0]", "[0, 0, 0]", "found a list of 3"),
        ("type: fixed, at: 5", "5", "a list"),
        ("type: fixed, at: [0, .inf]", ".inf]", "expected a finite number"),
        ("type: fixed, at: [0, 1/0]", "1/0]", "division by zero"),
        ("type: fixed, at: [0, 0], angle: pi/2", "pi/2", "expected degrees"),
        ("type: fixed, at: [0, 0], radius: 0", "0}", "found 0 as radius of wheel 1, expected more"),
        ("type: fixed, at: [0, 0], radius: -5", "-5", "found -5 as radius"),
        ("type: fixed, at: [0, 0], offset: 5", "5}", "a fixed wheel, expected it only on type castor"),
        ("type: castor, at: [0, 0], roller: 5", "5}", "a castor wheel, expected it only on type swedish"),
        ("type: fixed, at: [0, 0], turned: true", "true}", "expected it only on type steered or castor"),
        ("type: swedish, at: [0, 0]", "swedish", "found no 'roller' of wheel 1"),
        ("type: swedish, at: [0, 0], roller: 180", "180", "slip in the direction in which it rolls"),
        ("type: fixed, at: [0, 0], driven: yes", "yes", "expected true or false"),
        ("type: fixed, at: [0, 0], drivn: true", "drivn", "did you mean 'driven'"),
        ("type: fixed, at: [1e99, 0]", "1e99", "expected a length below 1e+06 m"),
    ],
)
def test_a_wrong_wheel(wheel, at, said):
    text = base(wheel)
    error = error_of(text)
    assert said in error.message
    assert error.line == 6
    assert text.splitlines()[5][error.column - 1 :].startswith(at)


@pytest.mark.parametrize(
    ("text", "at", "said"),
    [
        (base().replace("wheeled", "wheels"), "2:7", "did you mean 'wheeled'"),
        (base().replace("wheeled", "robot"), "2:7", "expected no 'kind' in the description of a robot"),
        (base().replace("wheeled", "[1]"), "2:7", "expected the kind: wheeled"),
        (base().replace("kind: wheeled\n", ""), "1:1", "found no 'kind' in a wheeled base"),
        (HEAD, "1:1", "found no 'wheels' in a wheeled base"),
        (HEAD + "wheels: []\n", "5:9", "found no wheels"),
        (HEAD + "wheels: 4\n", "5:9", "expected the wheels: a list"),
        (HEAD + "wheels: [4]\n", "5:10", "expected wheel 1"),
        (base(tail="joints: []\n"), "7:1", "found the unknown key 'joints' in a wheeled base"),
        (base(tail="steering: parallel\n"), "7:11", "without a steered wheel"),
        (base("type: steered, at: [0, 0]", tail="steering: paralel\n"), "7:11", "did you mean 'parallel'"),
        (base(tail="expected: {mobilty: 1}\n"), "7:12", "did you mean 'mobility'"),
        (base(tail="expected: {mobility: 1.5}\n"), "7:22", "expected a whole number"),
        (base("name: a, type: fixed, at: [0, 0]", "name: a, type: fixed, at: [1, 0]"), "7:5", "on wheel 1 too"),
        (base(*["type: fixed, at: [0, 0]"] * 1001), "6:3", "found 1001 wheels"),
    ],
)
def test_a_wrong_base(text, at, said):
    error = error_of(text)
    assert said in error.message, error.message
    assert f"{error.line}:{error.column}" == at


def test_what_a_description_describes_is_told():
    assert isinstance(load_any("car"), WheeledBase)
    with pytest.raises(InputError, match="car is a wheeled base, expected a robot"):
        robokin.load("car")
    with pytest.raises(InputError, match="car is a wheeled base, expected a mechanism"):
        robokin.load_mechanism("car")
    with pytest.raises(InputError, match="puma560 is a robot, expected a mechanism"):
        robokin.load_mechanism("puma560")
    with pytest.raises(InputError, match="four-bar is a mechanism, expected a wheeled base"):
        robokin.load_wheeled("four-bar")
    assert robokin.load_mechanism("four-bar", crank_angle=90).joints[1].at[1] == pytest.approx(2.0)


@pytest.mark.parametrize(("word", "expected"), [("spherical", "expected ball"), ("sphere", "expected ball")])
def test_a_ball_is_a_wheel(word, expected):
    text = "robokin: 1\nkind: wheeled\nname: x\nwheels:\n  - {{type: {}, at: [0, 0]{}}}\n"
    assert read_text(text.format("ball", ", driven: true, angle: 1")).wheels[0].driven
    assert expected in error_of(text.format(word, "")).message
    assert "expected it only on type" in error_of(text.format("ball", ", turned: true")).message
