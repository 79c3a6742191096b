"""The lectures' worked matrices and closed forms, as their slides print them."""

from __future__ import annotations

import re

import numpy as np
import pytest
from conftest import data

import robokin
from robokin.formats.number_expressions import Scope
from robokin.formats.transform_expressions import evaluate_transform
from robokin.spatial import map_point
from robokin.units import Units

LECTURES = data("lectures.json")
DEGREES = Units(angle="deg")


def ids(entries, key):
    return [entry[key] for entry in entries]


def transform(text):
    return evaluate_transform(text, Scope(degrees=True), DEGREES)


@pytest.mark.parametrize("entry", LECTURES["transforms"], ids=ids(LECTURES["transforms"], "name"))
def test_transform_examples(entry):
    assert np.allclose(transform(entry["expression"]), entry["matrix"], atol=1e-14)


@pytest.mark.parametrize("entry", LECTURES["points"], ids=ids(LECTURES["points"], "name"))
def test_points_mapped_by_a_transform(entry):
    assert np.allclose(map_point(transform(entry["expression"]), entry["point"]), entry["result"], atol=1e-14)


@pytest.mark.parametrize("entry", LECTURES["poses"], ids=ids(LECTURES["poses"], "robot"))
def test_worked_poses(entry):
    robot = robokin.load(entry["robot"])
    length, angle = Units(*entry["units"]).metres, Units(*entry["units"]).radians
    q = robot.poses[entry["q"]] if isinstance(entry["q"], str) else np.where(robot.revolute, angle, length) * entry["q"]
    T = robokin.forward_kinematics(robot, q)
    T[:3, 3] /= length
    if "matrix" in entry:
        assert np.max(np.abs(T - entry["matrix"])) <= entry["tolerance"]
    else:
        assert np.max(np.abs(T[:3, 3] - entry["position"])) <= entry["tolerance"]


def test_the_brac_example_as_printed():
    """The note multiplies matrices rounded to two digits; each of its products is that of its own factors."""
    printed = {key: np.array(value) for key, value in LECTURES["links_of_brac_example"].items() if key.startswith("T")}
    assert np.max(np.abs(printed["T1"] @ printed["T2"] - printed["T12"])) < 0.02
    robot = robokin.load("planar3r-brac")
    T = robokin.forward_kinematics(robot, np.radians([30.0, 45.0, 10.0]))
    # So its 26.6 and 51.14 cm are 0.13 and 0.27 cm from the exact 26.4743 and 50.8716.
    assert 0.1 < abs(printed["T"][0, 3] - 100 * T[0, 3]) < 0.2
    assert 0.2 < abs(printed["T"][1, 3] - 100 * T[1, 3]) < 0.3


def symbols(q, variables, parameters):
    """c1, s12, c123, … and the parameters and sliding joints, by their names on the slides."""
    found = dict(parameters)
    angles = {}
    for name, value in zip(variables, q, strict=True):
        if name.startswith("t"):
            angles[name[1:]] = value
        else:
            found[name] = value
    for first in angles:
        total, label = 0.0, ""
        for index in sorted(key for key in angles if key >= first):
            total, label = total + angles[index], label + index
            found[f"c{label}"], found[f"s{label}"] = np.cos(total), np.sin(total)
    return found


@pytest.mark.parametrize("entry", LECTURES["closed_forms"], ids=ids(LECTURES["closed_forms"], "robot"))
def test_closed_forms_at_random_joint_values(entry, rng):
    robot = robokin.load(entry["robot"])
    units = robot.units
    # A parameter is a length here; the forms are compared in the file's own unit.
    for _ in range(100):
        q = np.where(robot.revolute, rng.uniform(-3.2, 3.2, robot.n), rng.uniform(0.0, 1.0, robot.n))
        shown = np.where(robot.revolute, q, q / units.metres)
        names = symbols(shown, entry["q"], robot.parameters)
        for text in (cell for row in entry["matrix"] for cell in row):
            assert re.fullmatch(r"[-+*()\d\sa-z]*", text)
        expected = np.array([[eval(cell, {"__builtins__": {}}, names) for cell in row] for row in entry["matrix"]])
        T = robokin.forward_kinematics(robot, q)
        T[:3, 3] /= units.metres
        assert np.max(np.abs(T - expected)) < 1e-12 * max(1.0, float(np.max(np.abs(expected))))


def test_the_stanford_arm_is_the_spherical_arm_with_the_spherical_wrist(rng):
    stanford = robokin.load("stanford")
    q = rng.uniform(-1, 1, 6)
    d2, d6 = (stanford.parameters[name] * stanford.units.metres for name in ("d2", "d6"))
    arm = robokin.load("spherical", d2=d2 / robokin.load("spherical").units.metres)
    wrist = robokin.load("spherical-wrist", d6=d6 / robokin.load("spherical-wrist").units.metres)
    expected = robokin.forward_kinematics(arm, q[:3]) @ robokin.forward_kinematics(wrist, q[3:])
    assert np.allclose(robokin.forward_kinematics(stanford, q), expected, atol=1e-14)
