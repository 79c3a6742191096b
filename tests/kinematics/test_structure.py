"""What kind of arm each robot is."""

from __future__ import annotations

import pytest

import robokin
from robokin.kinematics.structure import structure_of

# id: class by the lecture's five, wrist, N, M. The classes of the lectures' own arms are the lectures' words.
KNOWN = {
    "puma560": ("anthropomorphic", "spherical", 6, 6),
    "puma560-craig": ("anthropomorphic", "spherical", 6, 6),
    "anthropomorphic": ("anthropomorphic", "", 3, 3),
    "anthropomorphic-wrist": ("anthropomorphic", "spherical", 6, 6),
    "spherical": ("spherical", "", 3, 3),
    "stanford": ("spherical", "spherical", 6, 6),
    "scara": ("SCARA", "", 4, 4),
    "scara-frames": ("SCARA", "", 3, 3),
    "cylindrical": ("cylindrical", "", 3, 3),
    "cartesian": ("Cartesian", "", 3, 3),
    "planar2r": ("planar", "", 2, 2),
    "planar3r": ("planar", "", 3, 3),
    "spherical-wrist": ("spherical wrist", "", 3, 3),
    "scorbot": ("anthropomorphic", "two axes", 5, 5),
    "thumb": ("anthropomorphic", "two axes", 5, 5),
    "ur5e": ("anthropomorphic", "not spherical", 6, 6),
    "panda": ("anthropomorphic", "not spherical", 7, 6),
    "iiwa14": ("anthropomorphic", "spherical", 7, 6),
    "human-arm": ("anthropomorphic", "spherical", 9, 6),
    "human-body": ("anthropomorphic", "spherical", 21, 6),
    "assembly": ("none (no joints)", "", 0, 0),
}


@pytest.mark.parametrize("name", KNOWN)
def test_class_wrist_and_dimension(name):
    arm, wrist, n, m = KNOWN[name]
    structure = structure_of(robokin.load(name))
    assert structure.arm == arm
    assert structure.wrist.startswith(wrist)
    assert bool(structure.wrist) == bool(wrist)
    assert (structure.joints, structure.dimension, structure.redundancy) == (n, m, n - m)
