"""Plain files: what is read without PyYAML and without arrays is what the reader of all descriptions gives."""

from __future__ import annotations

import random
import re
from collections.abc import Iterator

import fuzz_files
import pytest

from robokin.errors import RobokinError
from robokin.formats.faults import Faults
from robokin.formats.plain_files import FileRobots, file_robot, robot_of_bytes
from robokin.formats.plain_robots import PlainRobot, plain_robot
from robokin.formats.plain_yaml import plain_tree
from robokin.formats.read import read_bytes
from robokin.formats.yaml_reader import read_tree
from robokin.model import Robot

NAME = "folder/mine.yaml"

TOKENS = (
    " ", "  ", "\n", "\n  ", "#", " #", ",", ":", ": ", "- ", "-", "[", "]", "{", "}", "'", '"', "|", ">", ">-", "&a",
    "*a", "!t", "?", "? ", "%", "@", "`", "---\n", "...", "\t", "~", "null", "<<: ", "(", ")", "é", "\u2028", "\x85",
    "\ufeff", "\U0001f600", "\\", "\r\n", "\r", "a", "  - ", "x: 1\n", "''", "\xa0", "=", ",]", "# c\n",
)  # fmt: skip

WORDS = (
    "0", "-0", "90", "-90", "1.57", "1.5708", "6.2", "0.5", "4.9", "5.0", "12.5", "1e3", "1e9", "999999", "pi", "pi/2",
    "q1", "theta1", "q1+90", "90-q1", "nan", "inf", "null", "~", "x", "2*l1", "deg(1)", "45", "270", "540", "1e-9",
    "19.9", "0.01", "[0, 1]", "[1, 0]", "P", "prismatic", "fixed", "H", "m", "cm", "rad", "deg", "modified", "frames",
    "name", "d", "theta", "offset", "limits", "sense", "type", "-1",
)  # fmt: skip

TABLE = """robokin: 1
name: "two, links"
description: >-
  a text that # goes on
  to a second line
units: {length: mm, angle: deg}  # as it is drawn
parameters:
  l1: 300
joints:
  - {name: shoulder, type: R, theta: q1 + 90, a: l1,
     limits: [-170, 170]}
  # the second one
  - type: revolute
    a: 200
    limits: [-90, 90]
poses: {home: [0, 45]}
"""


def told(robot: PlainRobot | None) -> str | None:
    """All numbers of a robot, a zero with its sign."""
    return None if robot is None else repr(sorted(item for item in vars(robot).items() if item[0] != "frame"))


def slowly(data: bytes) -> str | None:
    """The same from the tree that PyYAML gives; None where there is an error, a note or no such robot."""
    try:
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("robokin.formats.read.plain_tree", lambda text, file: None)
            read = read_bytes(data, NAME, id="mine")
    except RobokinError:
        return None
    return told(plain_robot(read)) if isinstance(read, Robot) and not read.notes else None


def changed(rng: random.Random, text: str) -> str:
    """A text with a few slips."""
    for _ in range(rng.choice((1, 1, 2, 3))):
        at = rng.randrange(len(text))
        end = min(len(text), at + rng.choice((1, 2, 3, 10, 60)))
        draw = rng.random()
        if draw < 0.5:
            text = text[:at] + rng.choice(TOKENS) + text[at:]
        elif draw < 0.7:
            text = text[:at] + text[end:] + " "
        elif draw < 0.8:
            text = text[:at] + text[at:end] * 2 + text[end:]
        else:
            lines = text.split("\n")
            i = rng.randrange(len(lines))
            other = ("  " + lines[i], lines[i].strip(), lines[i] + " ", lines[i].replace(", ", ",  # c\n     ", 1))
            lines[i] = rng.choice(other)
            text = "\n".join(lines)
    return text


def other_words(rng: random.Random, text: str) -> str:
    """A text with a few other words and numbers."""
    for _ in range(rng.choice((1, 1, 2, 3))):
        found = rng.choice([*re.finditer(r"[-\w.]+", text)])
        text = text[: found.start()] + rng.choice(WORDS) + text[found.end() :]
    return text


def texts(seed: int, count: int) -> Iterator[str]:
    """Descriptions, right and wrong."""
    rng = random.Random(seed)
    whole = [data.decode() for data in fuzz_files.descriptions()]
    plain = [text for text in whole if robot_of_bytes(text.encode(), NAME)]
    for _ in range(count):
        draw = rng.random()
        if draw < 0.4:
            yield changed(rng, rng.choice(whole))
        elif draw < 0.9:
            yield other_words(rng, rng.choice(plain))
        else:
            yield fuzz_files.description(rng).decode()


def agrees(text: str) -> tuple[bool, bool]:
    """Assert that both ways agree on a text; whether it was read the short way as a tree, and as a robot."""
    tree, robot = plain_tree(text, NAME), robot_of_bytes(text.encode(), NAME)
    if tree is not None:
        faults = Faults()
        assert tree == read_tree(text, NAME, faults), text
        assert not faults.found
    if robot is not None:
        assert told(robot) == slowly(text.encode()), text
    return tree is not None, robot is not None


def test_the_library_is_read_as_it_is_without_pyyaml() -> None:
    read = [agrees(data.decode()) for data in fuzz_files.descriptions()]
    trees, robots = (sum(column) for column in zip(*read, strict=True))
    assert trees > 0.9 * len(read)
    assert robots > 0.3 * len(read)


def test_slips_are_read_as_they_are_without_pyyaml() -> None:
    read = [agrees(text) for text in texts(seed=1, count=400)]
    assert all(sum(column) > 40 for column in zip(*read, strict=True))


@pytest.mark.slow
def test_many_slips_are_read_as_they_are_without_pyyaml() -> None:
    for text in texts(seed=2, count=20_000):
        agrees(text)


def test_a_plain_table_is_read_the_short_way() -> None:
    assert agrees(TABLE) == (True, True)


@pytest.mark.parametrize(
    "old, new",
    [
        ("a: 200", "a: 200\n    alpha: 45"),  # no right angle
        ("a: 200", "a: 0.2"),  # may be in metres
        ("a: 200", "a: 200000"),  # may be in another unit
        ("-90, 90", "-1.57, 1.57"),  # may be in radians
        ("-90, 90", "90, -90"),
        ("45]", "45, 0]"),
        ("robokin: 1", "robokin: 2"),
        ("l1: 300", "l1: l2\n  l2: l1"),
        ("name: shoulder", 'name: "2"'),
        ("R, theta", "F, theta"),
        ("poses", "tool: Rot(x, 30)\nposes"),
        ("joints:", "other: 1\njoints:"),
        ("joints:", f"{1100 * 'k'}: 1\njoints:"),
    ],
)
def test_what_may_need_a_word_is_left_to_the_reader(old: str, new: str) -> None:
    assert old in TABLE
    assert not agrees(TABLE.replace(old, new))[1]


def test_a_file_is_read_anew_when_it_has_changed(tmp_path) -> None:
    path = tmp_path / "arm.yaml"
    path.write_text(TABLE)
    files = FileRobots()
    first = files.robot(str(path))
    assert first is not None
    assert files.robot(str(path)) is first
    path.write_text(TABLE.replace("200", "201"))
    assert told(files.robot(str(path))) == told(file_robot(str(path))) != told(first)
    path.write_text("robokin: 1\n")
    assert files.robot(str(path)) is None


def test_only_plain_files_are_read(tmp_path) -> None:
    (tmp_path / "real.yaml").write_text(TABLE)
    (tmp_path / "link.yaml").symlink_to(tmp_path / "real.yaml")
    for name in ("link.yaml", "absent.yaml", "folder.yaml/"):
        assert file_robot(str(tmp_path / name)) is None
    assert file_robot("a\0b.yaml") is None
