"""What kind of motion a basis of twists is."""

from __future__ import annotations

import numpy as np
import pytest
from mobility.linkages import linkage

import robokin
from robokin.mobility.output import kind_of, twist_basis
from robokin.mobility.screws import slide, turn
from robokin.mobility.verdict import mobility_of
from robokin.spatial.twists import exponential, moved_screws

X, Y, Z = np.eye(3)
O = np.array([0.3, -0.5, 0.8])  # noqa: E741 - a point that lies on no axis
SCREW = turn(O, Z) + 0.2 * slide(Z)
KINDS = {
    "none": [],
    "translation along a line": [slide(X)],
    "translation in a plane": [slide(X), slide(Y)],
    "translation in space": [slide(X), slide(Y), slide(Z)],
    "rotation about an axis": [turn(O, Z)],
    "screw motion about an axis": [SCREW],
    "rotation about an axis and translation along it": [turn(O, Z), slide(Z)],
    "rotation about one direction with a translation": [turn(O, Z), slide(X)],
    "planar: translation in a plane and rotation about its normal": [turn(O, Z), slide(X), slide(Y)],
    "rotation about one direction with two translations": [turn(O, Z), slide(X), slide(Z)],
    "translation in space and rotation about one direction (Schoenflies)": [turn(O, Z), slide(X), slide(Y), slide(Z)],
    "rotation about two axes that meet": [turn(O, X), turn(O, Y)],
    "rotation about a point": [turn(O, X), turn(O, Y), turn(O, Z)],
    "general, 2 freedoms": [turn(O, X), turn(O + Z, Y)],
    "general, 3 freedoms": [turn(O, X), turn(O + Z, Y), turn(O + X, Z)],
    "general, 4 freedoms: 1 translations and 3 rotations": [turn(O, X), turn(O, Y), turn(O, Z), slide(X)],
    "general, 5 freedoms: 2 translations and 3 rotations": [
        turn(O, X), turn(O, Y), turn(O, Z), slide(X), slide(Y)
    ],
    "free": [*map(slide, (X, Y, Z)), *(turn(O, axis) for axis in (X, Y, Z))],
}  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
def test_kinds_are_told_anywhere_and_in_any_basis(kind, rng):
    twists = np.array(KINDS[kind]).reshape(-1, 6)
    assert kind_of(twist_basis(twists.T)) == kind
    for _ in range(5):
        g = np.repeat(exponential(rng.normal(size=(1, 6))), len(twists), axis=0)
        mixed = rng.normal(size=(len(twists) + 2, len(twists))) @ moved_screws(g, twists)
        assert kind_of(twist_basis(mixed.T)) == kind


def test_a_basis_is_orthonormal_and_spans(rng):
    twists = rng.normal(size=(6, 3)) @ rng.normal(size=(3, 5))
    basis = twist_basis(twists)
    assert basis.shape == (6, 3)
    assert np.allclose(basis.T @ basis, np.eye(3))
    assert np.allclose(basis @ (basis.T @ twists), twists)
    assert twist_basis(np.zeros((6, 0))).shape == (6, 0)


@pytest.mark.parametrize(
    ("pair", "freedoms", "kind"),
    [(("coupler", "ground"), 1, "rotation about an axis"), (("ground", "coupler"), 1, "rotation about an axis"),
     (("rocker", "crank"), 1, "rotation about an axis")],
)  # fmt: skip
def test_any_two_links(pair, freedoms, kind):
    output = mobility_of(robokin.load_mechanism("four-bar"), pair).output
    assert (output.link, output.against, output.freedoms, output.kind) == (*pair, freedoms, kind)


def test_idle_freedoms_are_those_that_the_output_does_not_see():
    """The coupler of an RSSR spins about its own line."""
    joints = [("R", "01", (0, 0, 0), (0, 0, 1)), ("S", "12", (1, 0, 0)), ("S", "23", (2, 2, 0.7)),
              ("R", "30", (3, 1, 0.2), (0.3, 1, 0.2))]  # fmt: skip
    found = mobility_of(linkage(joints, "spatial"), ("3", "0"))
    assert (found.count, found.mobility, found.idle, found.output.freedoms) == (2, 2, 1, 1)
    assert mobility_of(linkage(joints, "spatial")).idle == 1
