"""The page of an arm, in a real browser: its forward kinematics is Python's, and its sliders move it."""

from __future__ import annotations

import json
import re
import sys

import numpy as np
import pytest
from sweeps import sweep

import robokin
from robokin.formats.library import library_names, load_any
from robokin.model import Robot
from robokin.pictures.arm import arm_of, default_configuration
from robokin.pictures.arm_page import arm_page
from robokin.pictures.arm_scene import Posture, Scene, usual_view

from .browser import evaluate, needs_browser

MIXED = """
robokin: 1
name: Every kind of row
units: {length: cm, angle: rad}
convention: %s
base: "Trans(10, 20, 5) Rot(x, 0.3)"
tool: "Trans(1, 2, 12) RPY(0.1, 0.2, 0.3)"
joints:
  - {type: fixed, theta: 0.4, d: 7, a: 3, alpha: 0.2}
  - {type: R, offset: 0.7, d: 30, a: 5, alpha: -1.1, limits: [-2, 1]}
  - {type: P, theta: 0.5, offset: 4, a: -6, alpha: 0.9, limits: [-5, 40]}
  - {type: fixed, theta: -1, d: -2, a: 8, alpha: 0.6}
  - {type: R, d: 11, a: 9, alpha: 0.5}
  - {type: P, theta: 0.2, a: 2, alpha: 1.3}
"""

FRAMES = """
robokin: 1
name: Frames about and along any axis
units: {length: in, angle: deg}
convention: frames
joints:
  - {type: R, origin: "Trans(1, 2, 3) Rot(y, 20)", axis: [1, 2, 3]}
  - {type: fixed, origin: "Trans(0, 4, 0) RPY(10, 20, 30)"}
  - {type: P, origin: "Trans(0, 0, 5)", axis: [0, -1, 1], limits: [-3, 8]}
  - {type: R, origin: "Rot(z, 90)", axis: [0, -1, 0]}
"""

ROBOTS = ["puma560", "puma560-craig", "stanford", "scara-frames", "cartesian", "standard", "modified", "frames"]

POSITIONS = 100


@pytest.fixture
def load(tmp_path):
    def load(name):
        texts = {"standard": MIXED % "standard", "modified": MIXED % "modified", "frames": FRAMES}
        if name not in texts:
            return robokin.load(name)
        path = tmp_path / f"{name}.yaml"
        path.write_text(texts[name])
        return robokin.load(path)

    return load


def page_of(robot, postures=None, target=None, frames=False):
    view, flat = usual_view(robot)
    postures = postures or [Posture(default_configuration(robot)[0])]
    arm = arm_of(robot)
    return arm_page(Scene(robot.name, "", robot.units, arm, postures, target, frames, view, flat, True, "arm"))


def data_of(page):
    (text,) = re.findall(r'<script id="data" type="application/json">(.*?)</script>', page.decode(), re.DOTALL)
    return json.loads(text)


def factors(robot):
    return np.where(robot.revolute, robot.units.radians, robot.units.metres)


def within_sliders(page, rng, count=POSITIONS):
    limits = np.array([joint["limits"] for joint in data_of(page)["joints"]])
    return rng.uniform(limits[:, 0], limits[:, 1], (count, len(limits)))


@needs_browser
@pytest.mark.parametrize("name", sweep(ROBOTS, 4))
def test_forward_kinematics_in_the_page_is_pythons(name, load, rng, tmp_path):
    robot = load(name)
    page = page_of(robot)
    q = within_sliders(page, rng)
    answer = evaluate(page, f"return {json.dumps(q.tolist())}.map((q) => window.robokin.fk(q));", tmp_path)
    T = robokin.forward_kinematics(robot, q * factors(robot))
    T[:, :3, 3] /= robot.units.metres
    assert np.shape(answer) == (POSITIONS, 4, 4)
    assert np.max(np.abs(np.array(answer) - T)) < 1e-9


@needs_browser
def test_sliders_boxes_and_buttons_move_the_arm_and_what_is_shown(rng, tmp_path):
    robot = robokin.load("stanford")
    configurations = [default_configuration(robot)[0], np.array([0.5, 0.4, 1.0, 0.3, 0.2, 0.1])]
    found = [Posture(q, label) for q, label in zip(configurations, ["first", "other"], strict=True)]
    page = page_of(robot, found)
    script = """
    const $ = (id) => document.getElementById(id);
    const image = () => [...$("canvas").toDataURL()].reduce((sum, c) => (31 * sum + c.charCodeAt(0)) | 0, 7);
    const shown = () => ["x", "y", "z", "roll", "pitch", "yaw"].map((id) => +$(id).textContent);
    const state = async () => {
      await frame(); await frame();
      return {q: window.robokin.q(), shown: shown(), image: image()};
    };
    const states = [await state()];
    for (const [i, value] of [[1, 30], [2, -20], [3, 900]]) {
      $("slider" + i).value = value;
      $("slider" + i).dispatchEvent(new Event("input", {bubbles: true}));
    }
    states.push(await state());
    const box = document.querySelectorAll("input[type=number]")[2];
    box.value = 5000; box.dispatchEvent(new Event("input")); box.dispatchEvent(new Event("change"));
    states.push(await state());
    document.querySelectorAll("#list button")[1].click();
    states.push(await state());
    document.querySelector("#poses button").click();
    states.push(await state());
    const pointer = (kind, x) =>
      $("canvas").dispatchEvent(new PointerEvent(kind, {pointerId: 1, clientX: x, clientY: 200, buttons: 1}));
    pointer("pointerdown", 100); pointer("pointermove", 180); pointer("pointerup", 180);
    states.push(await state());
    $("canvas").dispatchEvent(new WheelEvent("wheel", {deltaY: -300, clientX: 300, clientY: 300, cancelable: true}));
    states.push(await state());
    $("frames").click();
    states.push(await state());
    return {states, command: $("command").textContent};
    """
    answer = evaluate(page, script, tmp_path)
    assert isinstance(answer, dict), answer
    first, moved, clamped, other, again, turned, nearer, frames = answer["states"]
    assert moved["q"] == [30, -20, 900, 0, 0, 0]
    T = robokin.forward_kinematics(robot, np.array(moved["q"]) * factors(robot))
    assert np.allclose(moved["shown"][:3], 1000.0 * T[:3, 3], atol=0.006)
    R = robokin.forward_kinematics(robot, np.array(other["q"]) * factors(robot))[:3, :3]
    from robokin.spatial import rpy_from_rotation

    assert np.allclose(other["shown"][3:], np.degrees(rpy_from_rotation(R)), atol=0.006)
    assert clamped["q"][2] == pytest.approx(1270.0), "a number beyond the limits stops at them"
    assert np.allclose(np.array(other["q"]) * factors(robot), found[1].q)
    assert again["q"] == first["q"]
    images = [state["image"] for state in (first, moved, clamped, other, turned, nearer, frames)]
    assert len(set(images)) == len(images), "every one of these changes the picture"
    assert again["image"] == first["image"]
    assert answer["command"].startswith("robokin fk arm --q=0,0,787.4,0,0,0")


@needs_browser
def test_a_robot_without_joints_has_a_page_too(tmp_path):
    answer = evaluate(page_of(robokin.load("assembly")), "return window.robokin.fk([]);", tmp_path)
    T = robokin.forward_kinematics(robokin.load("assembly"), np.zeros(0))
    T[:3, 3] /= robokin.load("assembly").units.metres
    assert np.allclose(answer, T, atol=1e-9)


def test_a_page_needs_no_network_and_no_matplotlib(monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    text = page_of(robokin.load("puma560")).decode()
    assert not re.search(r"https?://|<link|<img|src=|@import|url\((?!#)", text)
    assert "<title>PUMA 560</title>" in text


@pytest.mark.slow
def test_every_robot_of_the_library_has_a_small_page():
    for name in library_names():
        robot = load_any(name, {})
        if isinstance(robot, Robot):
            assert len(page_of(robot)) < 60_000


def test_a_slider_ends_at_the_limits_and_at_half_a_turn_without_any():
    joints = data_of(page_of(robokin.load("stanford")))["joints"]
    assert joints[0]["limits"] == [-180.0, 180.0]
    assert joints[0]["free"] == [True, True]
    assert joints[2]["limits"] == [304.8, 1270.0]
    assert joints[2]["free"] == [False, False]


def test_names_from_a_file_are_text(tmp_path):
    path = tmp_path / "arm.yaml"
    path.write_text('robokin: 1\nname: "</script><b>"\njoints:\n  - {type: R, a: 1, name: "<i>"}\n')
    page = page_of(robokin.load(path))
    assert b"<b>" not in page
    assert data_of(page)["title"] == "</script><b>"
