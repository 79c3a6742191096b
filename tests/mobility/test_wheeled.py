"""Wheeled bases: mobility, steerability and manoeuvrability; holonomic or not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import robokin
from robokin.description import library_names, load_any
from robokin.mobility.wheeled import _heading, _kernel, _row, manoeuvrability_of
from robokin.model import Wheel, WheeledBase

BASES = [name for name in library_names() if isinstance(load_any(name), WheeledBase)]

# Degrees of mobility and steerability, and what the base can get about in: G. Campion, G. Bastin, B. d'Andréa-Novel,
# IEEE Trans. Robotics and Automation 12(1), 1996, for the five types; the last four by hand from their definitions.
DEGREES = {
    "omni-three": (3, 0, 3), "mecanum": (3, 0, 3), "differential-drive": (2, 0, 3), "one-steer": (2, 1, 3),
    "bicycle": (1, 1, 3), "car": (1, 1, 3), "tricycle": (1, 1, 3), "two-steer": (1, 2, 3), "swerve": (1, 2, 3),
    "synchro-drive": (1, 1, 2), "skid-steer": (1, 0, 1), "two-nonparallel-wheels": (1, 0, 1),
}  # fmt: skip


def wheel(kind, x, y, degrees=0.0):
    return Wheel(f"{kind} {x} {y}", kind, x, y, np.radians(degrees), roller=np.pi / 2 if kind == "swedish" else 0.0)


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
    assert found.holonomic == (found.mobility == found.reachable)
    assert found.ratio == found.mobility / 3


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
        row = _row(wheel("fixed", x, y, np.degrees(angle)), angle, 1.0)
        assert row @ [vx, vy, w] == pytest.approx(velocity @ across)


def test_a_steered_wheel_looks_where_it_goes(rng):
    for _ in range(20):
        w, twist = wheel("steered", *rng.normal(size=2)), rng.normal(size=3)
        assert _row(w, _heading(w, twist, 1.0), 1.0) @ twist == pytest.approx(0.0, abs=1e-12)


def test_what_is_allowed_breaks_no_constraint(rng):
    C = rng.normal(size=(2, 3))
    assert np.allclose(C @ _kernel(C), 0.0)
    assert np.array_equal(_kernel(np.zeros((0, 3))), np.eye(3))


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
