"""The benchmark that reads descriptions from the wild, on the ones in here: it finds what differs."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from conftest import DATA

sys.path.append(str(DATA.parent.parent))
corpora = pytest.importorskip("benchmarks.corpora")
corpus_peers = pytest.importorskip("benchmarks.corpus_peers")

FOLDER = DATA / "descriptions"


@pytest.fixture
def alone(monkeypatch):
    """No other package is there: products alone."""
    monkeypatch.setattr(corpus_peers, "importable", list)


def cases(folder):
    found = corpora.descriptions([folder])
    return {path.name: corpora.judged(path, kind, data, {}, np.random.default_rng(1)) for path, kind, data in found}


def test_descriptions_agree_with_products_of_their_numbers(alone):
    found = cases(FOLDER)
    assert {name: case.outcome for name, case in found.items()} == {
        "claw.xml": "alone", "crane-1.5.sdf": "agree", "crane.sdf": "agree", "crane.urdf": "agree",
        "leg.xacro": "refused", "rig.xacro": "alone", "torso.urdf": "agree",
    }  # fmt: skip
    lines = "\n".join(corpora.report([*found.values()], every=True))
    assert "URDF           2       2       0" in lines
    assert "leg.xacro:2:1: found no <link>" in lines


@pytest.mark.parametrize("name", ["torso.urdf", "crane.sdf"])
def test_what_differs_is_found(alone, tmp_path, name):
    path = tmp_path / name
    text = (FOLDER / name).read_text()
    path.write_text(text.replace("0.2", "0.2001", 1))
    kind = corpora.FORMATS[path.suffix]
    case = corpora.judged(path, kind, text.encode(), {}, np.random.default_rng(1))  # the peer has another text
    assert case.outcome == "DIFFER"
    assert any("DIFFER" in line and name in line for line in corpora.report([case], every=False))


def test_mjcf_is_known_by_its_first_tag():
    for text in (
        b"<mujoco>",
        b'<?xml version="1.0"?>\n<!-- <robot> -->\n<mujoco model="a">',
        b"\xef\xbb\xbf <mujoco/>",
    ):
        assert corpora.is_mjcf(text)
    for text in (b"<mujocoinclude>", b"<robot/>", b"<!-- <mujoco> --><sdf>", b"", b"<!-- " * 5000, b"<? " * 5000):
        assert not corpora.is_mjcf(text)


def test_the_nearest_package_of_a_name_is_meant(tmp_path):
    near, far = tmp_path / "a" / "arm", tmp_path / "b" / "arm"
    for folder in (far, near):
        folder.mkdir(parents=True)
        (folder / "package.xml").write_text("<package><name>arm</name></package>")
    packages = corpora.packages_in([tmp_path])
    assert corpora.nearest(packages, near / "urdf" / "arm.xacro") == {"arm": str(near)}
    assert corpora.nearest(packages, far / "arm.xacro") == {"arm": str(far)}


def test_reasons_are_told_without_names_and_numbers():
    one = corpora.reason_of("/a/b.urdf:3:7: found the joint 'x' twice in line 12\n  3 | <joint")
    assert one == "found the joint '…' twice in line #"
