"""Arms that are left with a joint held at one value after another: what is known of them is what an analysis finds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sweeps import sweep

import robokin
from robokin.inverse import hold
from robokin.inverse.closed_form.spherical_wrist import SphericalTriple
from robokin.inverse.held_forms import held_forms
from robokin.inverse.hold import held_arm
from robokin.inverse.one_target_arm import one_target_arm
from robokin.kernel.chain import chain_of

HELD = [("panda", 4), ("panda", 3), ("panda", 5), ("panda", 6), *(("iiwa14", joint) for joint in (0, 1, 2, 4, 5, 6))]
"""Arms and joints (from 0) whose others have a spherical shoulder or wrist, and code for it."""

GENERAL = pytest.param("panda", 2, marks=pytest.mark.slow)
"""One without."""

ROUND = (0.0, np.pi / 2.0, -np.pi / 2.0, np.pi, np.pi / 4.0, 1e-13, 1e-9, 1e-5)


def taught(name, joint):
    """A robot of its own that was asked for two values of the joint, so that others are found the short way."""
    robot = replace(robokin.load(name))
    for value in (0.3, 0.4):
        assert held_arm(robot, {joint: value}).one is not None
    return robot


def posed(robot, q, joint, value):
    """A pose of the robot with the joint at a value."""
    q = q.copy()
    q[joint] = value
    return robokin.forward_kinematics(robot, q)


@pytest.mark.parametrize(("name", "joint"), [*sweep(HELD, 4), GENERAL])
def test_an_arm_is_known_as_its_analysis_has_it(name, joint, rng):
    robot, fresh = taught(name, joint), replace(robokin.load(name))
    short = 0
    for value in [*rng.uniform(-2.8, 2.8, 5), *ROUND[::2]]:
        known = held_forms(robot, (joint,)).arm([value], lambda: robot)
        if known is None:
            continue  # another arm at this value: analysed as any
        short += 1
        part = held_arm(fresh, {joint: value}).made()
        wanted = one_target_arm(part)
        assert wanted is not None
        analysis = wanted.analysis
        assert np.allclose(chain_of(part).constants, known.analysis.chain.constants, rtol=0, atol=1e-14)
        assert (known.size, known.loop.size) == pytest.approx((wanted.size, wanted.loop.size), rel=1e-14)
        same = ("method", "sentence", "number", "complete", "idle", "open", "redundancy")
        assert [getattr(known.analysis, key) for key in same] == [getattr(analysis, key) for key in same]
        assert type(known.analysis.solver) is type(analysis.solver)
        assert (known.kernel is None) == (wanted.kernel is None)
        assert (known.bounds, known.turning, known.offsets) == (wanted.bounds, wanted.turning, wanted.offsets)
    assert short >= 5


@pytest.mark.parametrize("kernel", ["native", "python"])
@pytest.mark.parametrize(("name", "joint"), [*sweep(HELD, 5), GENERAL])
def test_its_answers_are_those_of_an_arm_that_is_analysed(name, joint, kernel, rng, monkeypatch):
    if kernel == "python":
        monkeypatch.setattr("robokin.inverse.one_target.native", None)
    robot, plain = taught(name, joint), replace(robokin.load(name))
    short = hold._forms
    monkeypatch.setattr(hold, "_forms", lambda arm, joints: None if arm is plain else short(arm, joints))
    low, high = robot.limits.T
    for value in [*rng.uniform(low[joint], high[joint], 3), *(v for v in ROUND[::3] if low[joint] <= v <= high[joint])]:
        q = rng.uniform(low, high)
        T = posed(robot, q, joint, value)
        for limits in (True, False):
            found = robokin.solve_ik(robot, T, limits=limits, hold={joint: value})
            wanted = robokin.solve_ik(plain, T, limits=limits, hold={joint: value})
            assert (len(found.solutions), found.complete, found.method, found.basis, found.certificate) == (
                len(wanted.solutions), wanted.complete, wanted.method, wanted.basis, wanted.certificate,
            )  # fmt: skip
            assert found.counts == wanted.counts
            for one, other in zip(found.solutions, wanted.solutions, strict=True):
                assert np.allclose(one.q, other.q, rtol=0, atol=1e-7)
                assert one.q[joint] == value
                assert (one.branch, one.free, one.within_limits) == (other.branch, other.free, other.within_limits)


def test_a_batch_says_what_single_poses_say(rng):
    robot = taught("panda", 6)
    T = np.stack([posed(robot, rng.uniform(*robot.limits.T), 6, 0.77) for _ in range(8)])
    batch = robokin.solve_ik(robot, T, hold={6: 0.77})
    assert batch.complete
    for i, count in enumerate(batch.count.tolist()):
        single = robokin.solve_ik(robot, T[i], hold={6: 0.77})
        assert np.allclose([one.q for one in single.solutions], batch.q[i, :count], rtol=0, atol=1e-9)


def test_what_the_short_way_cannot_tell_is_found_out_by_comparing(monkeypatch):
    """A number of the code that does not follow the held value is noticed before an answer rests on it."""

    def spoilt(solver, number=SphericalTriple.prepare):
        number(solver)
        solver.known = tuple(float(part) for part in solver.known)

    monkeypatch.setattr(SphericalTriple, "prepare", spoilt)
    forms = held_forms(taught("iiwa14", 5), (5,))
    values = np.linspace(-1.9, 2.0, 3).tolist()
    known = [forms.arm([value], lambda: forms.robot) for value in values]
    assert None in known


def test_arms_of_fewer_joints_are_left_to_the_analysis():
    puma = robokin.load("puma560")
    assert held_forms(puma, (2,)) is None
    assert held_arm(puma, {2: 0.3}).one is None
