"""Wheeled bases: mobility, steerability and manoeuvrability; holonomic or not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from library_entries import names_of

import robokin
from robokin.mobility.manoeuvrability import manoeuvrability_of
from robokin.mobility.wheel_rows import WheelFrame, kernel_of, sliding_row
from robokin.model import Wheel, WheeledBase

BASES = names_of(WheeledBase)

# Degrees of mobility and steerability, and what the base can get about in: G. Campion, G. Bastin, B. d'Andréa-Novel,
# IEEE Trans. Robotics and Automation 12(1), 1996, for the five types; the last four by hand from their definitions.
DEGREES = {
    "omni-three": (3, 0, 3), "mecanum": (3, 0, 3), "differential-drive": (2, 0, 3), "one-steer": (2, 1, 3),
    "bicycle": (1, 1, 3), "car": (1, 1, 3), "tricycle": (1, 1, 3), "two-steer": (1, 2, 3), "swerve": (1, 2, 3),
    "synchro-drive": (1, 1, 2), "skid-steer": (1, 0, 1), "two-nonparallel-wheels": (1, 0, 1),
}  # fmt: skip

# How many of δm and of δs their motors command. The base with one steered wheel turns about that wheel's point as
# it likes; all others are driven in whatever they can do.
COMMANDED = {name: (1, 1) if name == "one-steer" else degrees[:2] for name, degrees in DEGREES.items()}

HERE = WheelFrame(0.0, 0.0, 1.0)


def wheel(kind, x, y, degrees=0.0, motors="", offset=0.0, roller=90.0):
    """A wheel; motors: r rolls it, t turns it."""
    return Wheel(
        f"{kind} {x} {y} {degrees}", kind, x, y, np.radians(degrees), offset=offset,
        roller=np.radians(roller) if kind == "swedish" else 0.0, driven="r" in motors, turned="t" in motors,
    )  # fmt: skip


def degrees_of(*wheels, parallel=False):
    found = manoeuvrability_of(WheeledBase("a base", tuple(wheels), parallel))
    return found.mobility, found.steerability, found.reachable


def test_the_library_has_them_all():
    assert set(BASES) == set(DEGREES)


@pytest.mark.parametrize("name", BASES)
def test_a_base_of_the_library(name):
    base = robokin.load_wheeled(name)
    found = robokin.manoeuvrability_of(base)
    assert (found.mobility, found.steerability, found.reachable) == DEGREES[name]
    assert found.manoeuvrability == found.mobility + found.steerability
    assert base.expected == {
        "mobility": found.mobility, "steerability": found.steerability, "manoeuvrability": found.manoeuvrability,
    }  # fmt: skip
    assert (found.commands.controllable, found.commands.steering) == COMMANDED[name]
    assert found.holonomic == (found.controllable == found.reachable)
    assert found.ratio == found.controllable / 3


@pytest.mark.parametrize("name", BASES)
def test_neither_place_nor_size_nor_order_matters(name, rng):
    base = robokin.load_wheeled(name)
    turn, shift, scale = rng.uniform(-np.pi, np.pi), rng.normal(size=2), 10.0 ** rng.uniform(-3, 3)
    c, s = np.cos(turn), np.sin(turn)
    moved = [
        replace(w, x=scale * (c * w.x - s * w.y + shift[0]), y=scale * (s * w.x + c * w.y + shift[1]),
                angle=w.angle + turn)
        for w in base.wheels
    ]  # fmt: skip
    order = rng.permutation(len(moved))
    found = manoeuvrability_of(replace(base, wheels=tuple(moved[i] for i in order)))
    assert (found.mobility, found.steerability, found.reachable) == DEGREES[name]


@pytest.mark.parametrize("name", BASES)
def test_more_castors_change_nothing(name):
    base = robokin.load_wheeled(name)
    more = (*base.wheels, wheel("castor", 5.0, -3.0, 40), wheel("swedish", -2.0, 1.0, 10))
    found = manoeuvrability_of(replace(base, wheels=more))
    assert (found.mobility, found.steerability, found.reachable) == DEGREES[name]


def test_a_wheel_s_row_is_the_speed_across_it(rng):
    for _ in range(20):
        x, y, angle, vx, vy, w = rng.normal(size=6)
        velocity = np.array([vx - w * y, vy + w * x])
        across = np.array([-np.sin(angle), np.cos(angle)])
        row = sliding_row(HERE, wheel("fixed", x, y, np.degrees(angle)), angle)
        assert row @ [vx, vy, w] == pytest.approx(velocity @ across)


def test_a_steered_wheel_looks_where_it_goes(rng):
    for _ in range(20):
        w, twist = wheel("steered", *rng.normal(size=2)), rng.normal(size=3)
        assert sliding_row(HERE, w, HERE.heading(w, twist)) @ twist == pytest.approx(0.0, abs=1e-12)


def test_what_is_allowed_breaks_no_constraint(rng):
    C = rng.normal(size=(2, 3))
    assert np.allclose(C @ kernel_of(C), 0.0)
    assert np.array_equal(kernel_of(np.zeros((0, 3))), np.eye(3))


@pytest.mark.parametrize(
    ("wheels", "expected"),
    [
        ([wheel("castor", 0, 0)], (3, 0, 3)),
        ([wheel("fixed", 0, 0)], (2, 0, 3)),
        ([wheel("steered", 0, 0)], (2, 1, 3)),
        ([wheel("fixed", 0, 1), wheel("fixed", 0, -1), wheel("fixed", 0, 3)], (2, 0, 3)),
        ([wheel("fixed", 0, 1), wheel("fixed", 0, -1), wheel("steered", 0, 3)], (2, 0, 3)),
        ([wheel("fixed", 0, 1), wheel("steered", 0, 3), wheel("steered", 1, 3)], (1, 1, 3)),
        ([wheel("steered", 0, 0), wheel("steered", 0, 0)], (2, 1, 3)),
        ([wheel("fixed", 0, 0), wheel("fixed", 1, 0, 90), wheel("fixed", 0.3, 0.7, 45)], (0, 0, 0)),
        ([wheel("fixed", 0, 0), wheel("fixed", 1, 0)], (1, 0, 1)),
    ],
)
def test_small_bases(wheels, expected):
    """Among them a steered wheel on the axle of the fixed ones, which must stay as it is."""
    assert degrees_of(*wheels) == expected


def test_what_is_special_is_said():
    notes = {name: robokin.manoeuvrability_of(robokin.load_wheeled(name)).note for name in BASES}
    assert notes["bicycle"] is None
    assert notes["car"] == "1 of the 2 steered wheels has to follow the others"
    assert "parallel and apart" in notes["skid-steer"]
    assert "meet in one point" in notes["two-nonparallel-wheels"]
    assert "never turns" in notes["synchro-drive"]


# What motors command ----------------------------------------------------------------------------------


def commands(*wheels, parallel=False):
    return manoeuvrability_of(WheeledBase("a base", tuple(wheels), parallel)).commands


def mecanum(rollers, motors="rrrr"):
    places = [(1.0, 0.7), (1.0, -0.7), (-1.0, 0.7), (-1.0, -0.7)]
    return [
        wheel("swedish", x, y, 0.0, motor.replace("-", ""), roller=roller)
        for (x, y), roller, motor in zip(places, rollers, motors, strict=True)
    ]


# By hand: a driven wheel's row is the direction that its motor moves its point in, with the arm of that about the
# base's origin; the count is the rank of the rows on what the wheels that cannot slip leave.
LEFT, RIGHT = wheel("fixed", 0, 1, 0, "r"), wheel("fixed", 0, -1, 0, "r")
BY_HAND = {
    "castors only": ([wheel("castor", 1, 0, offset=0.1), wheel("castor", -1, 1, offset=0.1)], (0, 0, 0)),
    "balls only": ([wheel("ball", 1, 0), wheel("ball", -1, 1), wheel("ball", -1, -1)], (0, 0, 0)),
    "mecanum": (mecanum([-45, 45, 45, -45]), (3, 0, 4)),
    "all rollers at 45": (mecanum([45, 45, 45, 45]), (2, 0, 4)),
    "crossed the wrong way": (mecanum([45, -45, -45, 45]), (3, 0, 4)),
    "rollers alike on each side": (mecanum([45, -45, 45, -45]), (3, 0, 4)),
    "three of four": (mecanum([-45, 45, 45, -45], "rrr-"), (3, 0, 3)),
    "two of four": (mecanum([-45, 45, 45, -45], "rr--"), (2, 0, 2)),
    "two omni wheels": ([wheel("swedish", 0, 1, 0, "r"), wheel("swedish", 0, -1, 0, "r")], (2, 0, 2)),
    "omni wheels through one point": ([wheel("swedish", 1, 0, 0, "r"), wheel("swedish", 0, 1, 90, "r"),
                                       wheel("swedish", 1, 1, 45, "r")], (2, 0, 3)),
    "three driven balls": ([wheel("ball", 1, 0, 90, "r"), wheel("ball", -1, 1, 210, "r"),
                            wheel("ball", -1, -1, 330, "r")], (3, 0, 3)),
    "one driven side": ([LEFT, replace(RIGHT, driven=False)], (1, 0, 1)),
    "differential": ([LEFT, RIGHT], (2, 0, 2)),
    "differential, not driven": ([replace(LEFT, driven=False), replace(RIGHT, driven=False)], (0, 0, 0)),
    "driven at its turning point": ([wheel("fixed", 0, 0, 0, "r"), wheel("fixed", 1, 0, 0)], (1, 0, 1)),
    "driven where nothing moves": ([wheel("fixed", 0.1, 0.7, 90), wheel("fixed", 0.7, 0.1), wheel("castor", 1, 1),
                                    wheel("swedish", 0.7, 0.7, 0, "r")], (0, 0, 1)),
    "bicycle, rear driven": ([wheel("fixed", 0, 0, 0, "r"), wheel("steered", 1, 0, 0, "t")], (1, 1, 1)),
    "bicycle, nobody steers": ([wheel("fixed", 0, 0, 0, "r"), wheel("steered", 1, 0)], (1, 0, 1)),
    "bicycle, nobody pedals": ([wheel("fixed", 0, 0), wheel("steered", 1, 0, 0, "t")], (0, 1, 0)),
    "bicycle, front does both": ([wheel("fixed", 0, 0), wheel("steered", 1, 0, 0, "rt")], (1, 1, 1)),
    "a castor with one motor": ([wheel("castor", 1, 0, 0, "r", 0.2), wheel("castor", -1, 0, 0, "", 0.2)], (1, 0, 1)),
    "a castor with both motors": ([wheel("castor", 1, 0, 0, "rt", 0.2), wheel("castor", -1, 0, 0, "", 0.2)], (2, 0, 2)),
    "two castors with both": ([wheel("castor", 1, 0, 0, "rt", 0.2), wheel("castor", -1, 0, 0, "rt", 0.2)], (3, 0, 4)),
    "wheels that conflict": ([wheel("fixed", 0, 0, 0, "r"), wheel("fixed", 1, 0, 90, "r"),
                              wheel("fixed", 0.3, 0.7, 45, "r")], (0, 0, 3)),
    "two-steer, one turned": ([wheel("steered", 1, 0, 0, "rt"), wheel("steered", -1, 0, 0, "r")], (1, 1, 2)),
}  # fmt: skip
"""Controllable freedoms of δm, commanded ones of δs, speeds that are commanded."""


@pytest.mark.parametrize("name", BY_HAND)
def test_what_motors_command(name):
    wheels, expected = BY_HAND[name]
    found = commands(*wheels)
    assert (found.controllable, found.steering, found.speeds) == expected
    assert found.conditions == found.speeds - found.controllable


def free_twists(wheels, angles):
    """An independent count: speeds (v_x, v_y, ω, φ̇ …, β̇ …) under every wheel's two equations, the commanded ones
    held; how many twists are left. A wheel's point goes along at r φ̇, and across at what its kind has."""
    n = len(wheels)
    equations, held = [], []
    for i, (w, angle) in enumerate(zip(wheels, angles, strict=True)):
        x = w.x - (w.offset * np.cos(angle) if w.type == "castor" else 0.0)
        y = w.y - (w.offset * np.sin(angle) if w.type == "castor" else 0.0)
        velocity = np.zeros((2, 3 + 3 * n))
        velocity[:, :3] = [[1.0, 0.0, -y], [0.0, 1.0, x]]
        velocity[:, 3 + i] -= np.cos(angle), np.sin(angle)  # rolling
        side = [-np.sin(angle), np.cos(angle)]
        if w.type == "castor":  # the wheel swings behind its swivel
            velocity[:, 3 + n + i] -= w.offset * np.array(side)
        if w.type == "swedish":
            side = [np.cos(angle + w.roller), np.sin(angle + w.roller)]
        if w.type in ("swedish", "ball"):  # slips along its rollers, a ball across
            velocity[:, 3 + 2 * n + i] -= side
        equations += [*velocity]
        held += [3 + i] if w.driven else []
        held += [3 + n + i] if w.turned and w.type == "castor" else []
    A = np.array([*equations, *np.eye(3 + 3 * n)[held]])
    _, values, Vt = np.linalg.svd(A)
    twists = Vt[int(np.sum(values > 1e-9)) :, :3]
    return int(np.sum(np.linalg.svd(twists, compute_uv=False) > 1e-9)) if len(twists) else 0


def test_what_is_left_free_is_what_all_wheels_equations_leave(rng):
    """Bases of wheels at random, of all kinds but steered ones, whose angles follow from one another."""
    for _ in range(150):
        wheels = []
        for i in range(rng.integers(1, 6)):
            kind = str(rng.choice(["fixed", "castor", "swedish", "ball"], p=[0.2, 0.3, 0.3, 0.2]))
            motors = "".join(m for m in "rt" if rng.random() < 0.5)
            if kind != "castor":
                motors = motors.replace("t", "")
            made = wheel(
                kind, *rng.integers(-2, 3, 2), 45.0 * rng.integers(0, 8), motors, 0.3, rng.choice([45, 90, 60])
            )
            wheels.append(replace(made, name=str(i)))
        angles = [w.angle if w.type != "castor" else rng.uniform(-3, 3) for w in wheels]
        free = replace_motors(wheels)
        found = manoeuvrability_of(WheeledBase("a base", tuple(wheels)))
        assert found.mobility == free_twists(free, angles)
        assert found.uncontrolled == free_twists(wheels, angles)


def replace_motors(wheels):
    """The wheels without motors."""
    return [replace(w, driven=False, turned=False) for w in wheels]


@pytest.mark.parametrize("name", BY_HAND)
def test_commands_depend_on_neither_place_nor_size_nor_order(name, rng):
    wheels, expected = BY_HAND[name]
    turn, shift, scale = rng.uniform(-np.pi, np.pi), 30.0 * rng.normal(size=2), 10.0 ** rng.uniform(-3, 3)
    c, s = np.cos(turn), np.sin(turn)
    moved = [
        replace(w, x=scale * (c * w.x - s * w.y + shift[0]), y=scale * (s * w.x + c * w.y + shift[1]),
                angle=w.angle + turn, offset=scale * w.offset)
        for w in wheels
    ]  # fmt: skip
    found = commands(*[moved[i] for i in rng.permutation(len(moved))])
    assert (found.controllable, found.steering, found.speeds) == expected


def test_what_motors_lack_is_said():
    found = commands(*BY_HAND["three driven balls"][0])
    assert found.note is None
    assert commands(*BY_HAND["castors only"][0]).note == "no wheel is driven"
    assert "1 freedom that no motor commands" in commands(*BY_HAND["one driven side"][0]).note
    assert "1 freedom of steering that no motor commands" in commands(*BY_HAND["bicycle, nobody steers"][0]).note
    three = [wheel("castor", x, y, 0, "r", 0.2) for x, y in ((1, 0), (-1, 1), (-1, -1))]
    found = commands(*three)
    assert (found.controllable, found.least) == (3, 2)
    assert "only 2 where the driven castors stand in line" in found.note
    assert not manoeuvrability_of(WheeledBase("a base", tuple(mecanum([45] * 4)))).holonomic
