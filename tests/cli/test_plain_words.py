"""Plain command lines are answered without the parser, with the bytes that the parser's way gives."""

from __future__ import annotations

import io
import json
import random
import shutil
import sys
from itertools import pairwise
from unittest import mock

import numpy as np
import pytest
from sweeps import sweep

import robokin
from robokin.cli.app import invoke as parsed
from robokin.errors import RobokinError
from robokin.formats import library, plain_robots
from robokin.formats.library import library_names
from robokin.formats.plain_robots import library_robot, plain_robot
from robokin.quick.plain_poses import PlainPose
from robokin.quick.plain_words import answered
from robokin.units import METRES, RADIANS, Units

from .conftest import strict_json

ARMS = [name for name in library_names() if library_robot(name) is not None]

FORMS = [
    [], ["--json"], ["-f", "jsonl"], ["--format=table", "--angle", "rad"], ["--angle=rad", "--length=in", "--json"],
    ["--length", "m", "-f", "json"], ["--length", "cm"], ["--angle", "deg", "--format", "jsonl", "--length", "mm"],
]  # fmt: skip


class Terminal(io.TextIOWrapper):
    """A stream that says that it is a terminal."""

    def isatty(self):
        return True


def said(words, kind=io.TextIOWrapper):
    """What the parser's way prints, where it has nothing to note; None otherwise."""
    out, err = kind(io.BytesIO(), encoding="utf-8"), io.StringIO()
    with mock.patch.multiple(sys, stdin=io.StringIO(), stdout=out, stderr=err):
        try:
            status = parsed([*words])
        except RobokinError:
            return None
        out.flush()
    return out.buffer.getvalue() if status == 0 and not err.getvalue() else None


def inside(rng, robot, units):
    """Joint values within the limits of a plain robot, as one types them."""
    ends = zip(robot.least, robot.most, robot.factors(units), strict=True)
    drawn = [rng.uniform(max(low, -3.0), min(high, 3.0)) / factor for low, high, factor in ends]
    return ",".join(rng.choice([repr(value), f"{value:.3f}", f"({value!r})", f"{value / 2!r}*2"]) for value in drawn)


def test_most_arms_of_the_library_are_plain():
    known = [name for name in library_names() if isinstance(robokin.formats.load_any(name), robokin.Robot)]
    assert {*ARMS} <= {*known}
    assert len(ARMS) > 0.9 * len(known)
    assert all(plain_robot(robokin.load(name)) is None for name in known if name not in ARMS)


@pytest.mark.parametrize("name", sweep(ARMS, 40))
def test_the_bytes_are_those_of_the_parser_s_way(name):
    rng = random.Random(name)
    for form in rng.sample(FORMS, 3):
        robot = library_robot(name)
        given = dict(word.removeprefix("--").split("=") for word in form if "=" in word)
        given |= {a.removeprefix("--"): b for a, b in pairwise(form) if a.startswith("--")}
        units = Units(given.get("length", robot.units.length), given.get("angle", robot.units.angle))
        q = rng.choice([inside(rng, robot, units), *robot.poses])
        words = ["fk", rng.choice([name, name.upper()]), "--q", q, *form]
        found = answered(words)
        assert found == said(words), words
        assert found is not None or any(word in words for word in robot.poses) or "mm" in words or "0." in q, words


@pytest.mark.parametrize("name", sweep(ARMS, 12))
def test_the_numbers_are_those_of_the_package(name):
    """The kept constants are the chain's, and one configuration is answered as arrays are."""
    robot, kept = robokin.load(name), library_robot(name)
    fresh = plain_robot(robot)
    assert np.allclose(kept.constants, fresh.constants, rtol=0, atol=4e-16 * max(1.0, np.abs(fresh.constants).max()))
    for field in ("id", "name", "units", "turns", "least", "most", "poses", "offsets"):
        assert getattr(kept, field) == getattr(fresh, field)
    rng = np.random.default_rng(3)
    for q in [*rng.uniform(-3, 3, (3, robot.n)), np.zeros(robot.n), np.full(robot.n, np.pi / 2)]:
        units = Units(rng.choice([*METRES]), rng.choice([*RADIANS]))
        factors = np.array(kept.factors(units))
        document = PlainPose(kept, units, (q / factors).tolist()).document()
        T = robokin.forward_kinematics(robot, document["q"] * factors)
        scale = max(1.0, np.abs(T).max() / units.metres)
        T[:3, 3] /= units.metres
        assert np.allclose(document["pose"]["matrix"], T, rtol=0, atol=1e-14 * scale)
        assert np.array_equal(document["pose"]["position"], [row[3] for row in document["pose"]["matrix"][:3]])
        R = np.array(document["pose"]["matrix"])[:3, :3]
        for back, values in (
            (robokin.rotation_from_rpy, np.array(document["pose"]["rpy"]) * units.radians),
            (robokin.rotation_from_quaternion, document["pose"]["quaternion"]),
        ):
            assert np.allclose(back(values), R, rtol=0, atol=3e-12)
        near = (robokin.rpy_from_rotation(R) / units.radians, robokin.quaternion_from_rotation(R))
        assert np.allclose(document["pose"]["rpy"], near[0], rtol=1e-14, atol=1e-13)
        assert np.allclose(document["pose"]["quaternion"], near[1], rtol=0, atol=1e-15)
        assert document["within_limits"] == bool(robot.within_limits(document["q"] * factors))


SLIPS = [
    "fk", "ik", "list", "puma560", "PUMA560", "./puma560", "puma", "", "-", "--", "--q", "--q=", "-q", "--json",
    "--jso", "--json=1", "-f", "-fjson", "-f=json", "--format", "json", "csv", "table", "npy", "0,0,0,0,0,0",
    "0 0 0 0 0 0", "[0,0,0,0,0,0]", "-90,0,90,0,0,0", "pi,0,0,0,0,0", "1.57,0,1.57,0,0,0", "1e999,0,0,0,0,0",
    "0,0,0,0,0", "home", "900,0,0,0,0,0", "nan,0,0,0,0,0", "--angle", "rad", "deg", "grad", "--length", "m", "ft",
    "--frames", "--as", "rpy", "-o", "x.json", "--help", "--version", "four-bar", "human-hand", "scara", "0,0,0,0",
    "\ud800", "é", "\x00", "x" * 5000, "0,0,0,0,0,0 ", "sqrt(2),0,0,0,0,deg(pi)", "--set", "a=1", "--tip", "kuka",
    "nothing-like-it", "1/0,0,0,0,0,0",
]  # fmt: skip


@pytest.mark.parametrize("seed", sweep(range(24), 12))
def test_whatever_is_typed_it_is_right_or_left_to_the_parser(seed):
    rng, known = random.Random(seed), 0
    for _ in range(60):
        words = ["fk", "puma560", "--q", rng.choice(["0,0,0,0,0,0", "home", "10,20,30,40,50,60"])]
        words = rng.choice([words, ["list"], []]) + rng.choices(SLIPS, k=rng.choice([0, 1, 1, 2, 3]))
        if rng.random() < 0.3:
            rng.shuffle(words)
        found = answered(words)
        if found is not None:
            known += 1
            assert found == said(words), words
    assert known > 3


@pytest.mark.parametrize(
    "words", [["list"], ["list", "kuka"], ["list", "scara", "epson", "--json"], ["list", "-f", "csv"]]
)
def test_a_list_is_the_parser_s(words):
    assert answered(words) == said(words) is not None


def test_at_a_terminal_too(monkeypatch):
    for columns in ("80", "40", "20"):
        monkeypatch.setenv("COLUMNS", columns)
        for words in (["fk", "puma560", "--q", "home"], ["list", "fanuc"]):
            with mock.patch.object(sys, "stdout", Terminal(io.BytesIO(), encoding="utf-8")):
                found = answered(words)
            assert found == said(words, Terminal)
            assert b"\x1b[" in found


def test_notes_and_refusals_are_left_to_the_parser(call):
    for q in ("1.57,0,1.57,0,0,0", "500,0,0,0,0,0", "0,0,0", "zero"):
        words = ["fk", "puma560", "--q", q]
        assert answered(words) is None
        assert call(*words).err


def test_an_edited_description_is_read_anew(tmp_path, monkeypatch):
    copied = tmp_path / "robots"
    shutil.copytree(library.library_folder(), copied)
    for module in (library, plain_robots, robokin.formats.library_index):
        monkeypatch.setattr(module, "library_folder", lambda: copied)
    words = ["fk", "puma560", "--q", "home", "--json"]
    before = answered(words)
    assert before is not None
    path = copied / "arms" / "puma560.yaml"
    text = path.read_text()
    path.write_text(text.replace("431.8", "431.9"))  # as long as before
    assert path.read_text() != text
    assert answered(words) is None
    assert strict_json(said(words).decode())["pose"] != strict_json(before.decode())["pose"]
    path.write_text(text)
    assert answered(words) == before
    (copied / "chains.jsonl").write_bytes(b'{"id": "puma560", "check": 1}\n\xff\n')
    assert answered(words) is None
    (copied / "chains.jsonl").unlink()
    assert answered(words) is None


def test_the_kept_chains_are_those_of_the_library():
    """`python -m robokin.formats.plain_robots` makes them; last digits are the processor's own."""
    kept = (library.library_folder() / plain_robots.CHAINS).read_text(encoding="utf-8").splitlines()
    fresh = plain_robots.chains_text().splitlines()
    assert len(kept) == len(fresh)
    for old, new in zip(map(json.loads, kept), map(json.loads, fresh), strict=True):
        numbers = [(np.array(line.pop("constants")), np.array(line.pop("offsets"))) for line in (old, new)]
        assert old == new
        assert all(np.allclose(a, b, rtol=1e-15, atol=4e-16) for a, b in zip(*numbers, strict=True))


def test_a_file_of_ones_own_is_answered_as_by_the_parser(tmp_path):
    rng = random.Random(31)
    read = 0
    for name in rng.sample(ARMS, 24):
        path = tmp_path / f"my-{name}.yaml"
        shutil.copy(library.library_file(name), path)
        for form in rng.sample(FORMS, 2):
            units = library_robot(name).units
            options = dict(pairwise(part for word in form for part in word.split("=")))
            units = units.override(options.get("--length"), options.get("--angle"))
            words = ["fk", str(path), "--q", inside(rng, library_robot(name), units), *form]
            data = answered(words)
            assert data is None or data == said(words), words
            read += data is not None
    assert read > 10
