"""Stills of arms: whole files, the same every time, with their words."""

from __future__ import annotations

from xml.etree import ElementTree

import numpy as np
import pytest
from sweeps import sweep

import robokin
from robokin.errors import InputError
from robokin.pictures.arm import arm_of, default_configuration
from robokin.pictures.arm_scene import Posture, Scene, usual_view
from robokin.pictures.arm_stills import arm_still

pytest.importorskip("matplotlib")


def scene(name, postures=None, frames=False, target=None, turned=True):
    robot = robokin.load(name)
    view, flat = usual_view(robot)
    postures = postures or [Posture(default_configuration(robot)[0])]
    return Scene(robot.name, "q = (…)", robot.units, arm_of(robot), postures, target, frames, view, flat, turned)


def words(data):
    return "\n".join(text for text in ElementTree.fromstring(data.decode()).itertext() if text.strip())


@pytest.mark.parametrize(("kind", "start"), [("png", b"\x89PNG\r\n\x1a\n"), ("pdf", b"%PDF-"), ("svg", b"<?xml")])
@pytest.mark.parametrize("name", sweep(["stanford", "planar3r"], 2))
def test_a_file_is_what_its_ending_says_and_always_the_same(name, kind, start):
    data = arm_still(scene(name), kind)
    assert data.startswith(start)
    assert arm_still(scene(name), kind) == data


def test_a_solid_arm_has_three_axes_with_units_and_its_frames_are_numbered():
    text = words(arm_still(scene("puma560", frames=True), "svg"))
    for word in ("PUMA 560", "q = (…)", "x [mm]", "y [mm]", "z [mm]", "2, 3", "6, tool"):
        assert word in text
    assert "2, 3" not in words(arm_still(scene("puma560"), "svg"))


def test_a_planar_arm_has_two_axes_to_one_scale():
    text = words(arm_still(scene("planar3r"), "svg"))
    assert "x [m]" in text
    assert "y [m]" in text
    assert "z [m]" not in text


@pytest.mark.parametrize("turned", sweep([True, False], 2))
def test_ghosts_are_named_and_the_target_is_shown(turned):
    robot = robokin.load("planar3r")
    postures = [Posture(np.zeros(3), "straight"), Posture(np.ones(3), "a name & more", ghost=True)]
    data = arm_still(scene("planar3r", postures, target=robokin.forward_kinematics(robot, np.ones(3)), turned=turned),
                     "svg")  # fmt: skip
    for word in ("1  straight", "2  a name & more", "target", "tool", "base"):
        assert word in words(data)


def test_without_matplotlib_the_sentence_says_how_to_get_it(monkeypatch):
    monkeypatch.setattr("robokin.pictures.workspace_stills.find_spec", lambda name: None)
    with pytest.raises(InputError, match="`pip install matplotlib`"):
        arm_still(scene("puma560"), "png")
