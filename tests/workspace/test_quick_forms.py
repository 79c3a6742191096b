"""The native closed form tells orientations apart as the blocks in Python do."""

from __future__ import annotations

import numpy as np
import pytest

import robokin
from robokin.kernel.native_kernel import native
from robokin.spatial import nearest_rotation
from robokin.workspace import trials
from robokin.workspace.space import space_of


@pytest.mark.skipif(native is None, reason="no native kernel in use")
@pytest.mark.parametrize("name", ["puma560", "ur5e", "irb120"])
def test_the_same_orientations_are_reached(name, rng, monkeypatch):
    robot = robokin.load(name)
    space = space_of(robot)
    q = rng.uniform(*np.clip(robot.limits, -3.0, 3.0).T, (1500, 6))
    T = robokin.forward_kinematics(robot, q)
    # Its own, random ones, and places far off.
    T[500:1000, :3, :3] = nearest_rotation(rng.normal(size=(500, 3, 3)))
    T[1000:, :3, 3] *= rng.uniform(0.0, 3.0, (500, 1))
    some, values = trials.configurations(space, "pose", T[:, :3, 3], T[:, :3, :3])
    assert np.array_equal(some, ~np.isnan(values[:, 0]))
    assert some[:500].all()
    monkeypatch.setattr(trials, "quick_within", lambda *asked: None)
    others, _ = trials.configurations(space, "pose", T[:, :3, 3], T[:, :3, :3])
    assert np.array_equal(some, others)
    assert robot.within_limits(values[some]).all()
    assert np.allclose(robokin.forward_kinematics(robot, values[some]), T[some], rtol=0, atol=1e-8)
