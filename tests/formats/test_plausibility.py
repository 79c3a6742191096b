"""Notes on numbers in another unit: none on what is sound, one on what is a slip; a small run of the benchmark."""

from __future__ import annotations

import numpy as np
import pytest
from formats.drawn_tables import false_alarms, seen
from formats.texts import DEGREES, HEAD, arm, linkage
from sweeps import sweep

import robokin
from robokin.formats import library_names, read_text
from robokin.formats.library import load_any
from robokin.formats.typed_angles import unit_of_values
from robokin.units import Units

METRES = HEAD + "units: {length: m, angle: deg}\n"


def notes(text):
    return [str(note) for note in read_text(text, "arm.yaml").notes]


@pytest.mark.parametrize("name", sweep(library_names(), 4))
def test_no_description_of_the_library_is_noted(name):
    assert load_any(name).notes == ()


def test_no_sound_table_is_noted():
    assert false_alarms(100, seed=7) == []


def test_nearly_all_slips_are_noted():
    made, found, _ = seen(150, seed=7)
    assert sum(found.values()) >= 0.95 * sum(made.values())


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (arm("type: R, a: 0.3, alpha: 180, limits: [-170, 170]", head=HEAD), "alpha of row 1 is 180 rad, more than a"),
        (arm("type: R, a: 1, limits: [-170, 170]", head=HEAD), "a limit of row 1 is -170 rad"),
        (arm("type: R, a: 0.3, alpha: 45", head=HEAD), "`units: {angle: deg}`"),
        (arm("type: R, a: 0.3", head=HEAD, tail="poses: {home: [90]}\n"), "a value of the pose home is 90 rad"),
        (arm("type: R, a: 0.3", head=HEAD, tail="tool: Rot(z, 45)\n"), "an angle in the tool is 45 rad"),
        (arm("type: R, a: 300, alpha: 1.5708"), "alpha of row 1 is 1.5708 degrees, the decimals of a part of pi"),
        (arm("type: R, a: 300, alpha: -1.57"), "-1.57 degrees"),
        (arm("type: R, a: 300, offset: 0.7854"), "offset of row 1 is 0.7854 degrees"),
        (arm("type: R, a: 300, limits: [-2.967, 2.967]"), "a limit of row 1 is -2.967 degrees"),
        (arm("type: R, a: 300, limits: [-2.9, 2.9]"), "a limit of row 1 is -2.9 degrees"),
        (arm("type: R, a: 300, limits: [-170, 2.967]"), "a limit of row 1 is 2.967 degrees"),
        (arm("type: R, d: 90, alpha: al", head=DEGREES + "parameters: {al: 1.5708}\n"), "alpha of row 1 is 1.5708 deg"),
        (arm("type: R, d: 290, alpha: 90", "type: R, a: 0.27", head=METRES),
         "d of row 1 is 290 m, about a thousand times more than the other lengths, which are up to 0.27 m: if mm are "
         "meant, write 0.29"),
        (arm("type: R, d: 0.12, alpha: 90", "type: R, a: 270"), "d of row 1 is 0.12 mm, about a thousand times less"),
        (arm("type: R, a: 300", "type: R, a: 280", tail="tool: Trans(0, 0, 0.1)\n"), "a length in the tool is 0.1 mm"),
        (arm("type: R, a: 0.3", head=METRES, tail="tool: Trans(0, 0, 125)\n"), "a length in the tool is 125 m"),
        (arm("type: R, d: 330", "type: R, a: 290", head=METRES), "which is too large for a machine"),
        (arm("type: R, d: 0.33", "type: R, a: 0.29"), "which is too small for a machine"),
        (arm("type: R, a: 0.0004", head=METRES), "reach 0.0004 m, which is too small"),
        (linkage("type: revolute, links: [ground, crank], at: [0, 250]"),
         "the mechanism's size 250 m"),
        ("robokin: 1\nkind: wheeled\nname: b\nwheels:\n  - {type: swedish, at: [0.1, 0], roller: 45, radius: 0.05}\n",
         "roller of wheel 1 is 45 rad"),
    ],
)  # fmt: skip
def test_a_slip_is_noted_at_its_place(text, said):
    (note,) = notes(text)
    assert said in note
    assert note.startswith("arm.yaml:")


@pytest.mark.parametrize(
    "text",
    [
        arm("type: R, a: 1, alpha: pi/2, limits: [-pi, pi]", "type: R, a: 0.5", head=HEAD),
        arm("type: R, a: 1, alpha: 1.5708, limits: [-6.98, 6.98]", "type: R, a: 10", head=HEAD),
        arm("type: R, a: 1, limits: [-62.83, 62.83]", head=HEAD),
        arm("type: R, a: 300, alpha: 0.26, limits: [-5, 5]"),
        arm("type: R, a: 431.8123, d: 0.0312, alpha: 89.9873", "type: R, a: 0.3501"),
        arm("type: P, theta: 90, alpha: 90, limits: [0, 40]", "type: R, d: 0.25", head=METRES),
        arm("type: R, a: 45", "type: R, a: 25", "type: R, a: 20"),
        arm("type: R", "type: R, alpha: 90"),
        arm("type: R, a: 0.3", head=METRES, tail="base: Trans(5000, 300, 0)\n"),
        arm("type: R, alpha: 90"),
        arm("type: fixed, theta: 30"),
        arm("type: P, alpha: 90", tail="poses: {home: [0.1]}\n"),  # of an arm without lengths nothing is known
    ],
)
def test_what_can_be_meant_is_not_noted(text):
    assert notes(text) == []


def test_lengths_that_cancel_are_no_reach():
    """A UR5 as calibrated: axes parallel but for 1e-4 rad, and frames hundreds of metres off."""
    rows = ["d: 0.089, alpha: 90", "d: 412.3, a: -0.425, alpha: 0.01", "d: -412.2, a: -0.392", "d: 0.01, alpha: 90",
            "d: 0.095, alpha: -90", "d: 0.08"]  # fmt: skip
    rows = [f"type: R, {row}" for row in rows]
    assert notes(arm(*rows, head=METRES)) == []


def test_several_slips_of_a_kind_are_one_note():
    (note,) = notes(arm("type: R, a: 0.3, alpha: 90, limits: [-170, 170]", "type: R, a: 0.2, alpha: 90", head=HEAD))
    assert note.endswith("(and 3 more)")


# Joint values ------------------------------------------------------------------------------------------------

DEG, RAD = Units("mm", "deg"), Units("mm", "rad")


@pytest.mark.parametrize(
    ("q", "units"),
    [
        ([[0, -1.5708, 1.5708, 0, 0, 0]], DEG),
        ([[0, 1.57, 0, 0, 0, 0]], DEG),
        ([[0, np.pi / 4, -np.pi / 2, 0, 0, 0]], DEG),
        ([[0, 45, 90, 0, 0, 0]], RAD),
        (np.random.default_rng(1).uniform(-np.pi, np.pi, (100, 6)), DEG),
        (np.random.default_rng(1).uniform(-160, 160, (100, 6)), RAD),
    ],
)
def test_joint_values_in_the_other_unit_are_noted(q, units):
    assert unit_of_values(robokin.load("puma560"), units, np.array(q, dtype=float))


@pytest.mark.parametrize(
    ("q", "units"),
    [
        ([[0, 0, 0, 0, 0, 0]], DEG),
        ([[1, 2, 3, 0, 0, 0]], DEG),
        ([[0, 90, 1.5708, 0, 0, 0]], DEG),
        ([[0.5, 1.57, 2.25, 0.1, 0, 0]], DEG),
        ([[-6.9, 3.2, 1.5708, 0, 0, 0]], RAD),
        (np.random.default_rng(1).uniform(-160, 160, (100, 6)), DEG),
        (np.random.default_rng(1).uniform(-3, 3, (100, 6)), DEG),
        (np.random.default_rng(1).uniform(-5, 5, (100, 6)), DEG),
        (np.random.default_rng(1).uniform(-np.pi, np.pi, (100, 6)), RAD),
        ([[np.nan] * 6], DEG),
    ],
)
def test_joint_values_that_can_be_meant_are_not_noted(q, units):
    assert unit_of_values(robokin.load("puma560"), units, np.array(q, dtype=float)) == ""
