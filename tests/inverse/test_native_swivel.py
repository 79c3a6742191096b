"""Arms with a spherical shoulder and wrist in the native kernel: what Python's steps give; what is wrong is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from inverse.test_swivel import SWIVELS, random_arm, within
from sweeps import sweep

import robokin
from robokin.inverse.batch_tables import empty_tables
from robokin.inverse.single_answer import result_of
from robokin.inverse.solve import _request
from robokin.inverse.swivel_block import one_swivel_arm, solve_swivel
from robokin.inverse.target_block import TargetBlock
from robokin.kernel.native_kernel import native

pytestmark = pytest.mark.skipif(native is None, reason="no native kernel in use")

KINDS = ["anywhere", "some at limits", "all at limits", "round"]


def twin(robot, T, most=None):
    """The answer of the blocks in Python for a target (4, 4)."""
    request = replace(_request(robot, True, None, "auto", "pose", most, 0), motions=True)
    return result_of(request, TargetBlock(request, T[None]), 0)


def check(one, other, off):
    """Two results say the same, joint values to within off [rad]."""
    assert len(one) == len(other)
    for a, b in zip(one, other, strict=True):
        assert np.max(np.abs(a.q - b.q)) <= off
        assert (a.branch, a.free, a.within_limits) == (b.branch, b.free, b.within_limits)
    for name in ("complete", "method", "reason", "postures", "basis", "certificate", "families_complete", "all_known"):
        assert getattr(one, name) == getattr(other, name)
    assert {**other.counts, "turns": one.counts["turns"]} == dict(one.counts)
    assert len(one.families) == len(other.families)
    for f, g in zip(one.families, other.families, strict=True):
        assert (f.joints, f.dimension, f.closed, f.solution) == (g.joints, g.dimension, g.closed, g.solution)
        for a, b in zip(f.arcs, g.arcs, strict=True):
            assert a.whole == b.whole
            assert np.allclose(a.swivel, b.swivel, rtol=0, atol=1e-9)
            assert np.allclose(a.q[[0, -1]], b.q[[0, -1]], rtol=0, atol=1e-7)


def answered(robot, T):
    """The kernel's numbers for a target (4, 4), or None."""
    return solve_swivel(one_swivel_arm(robot), T, None)


@pytest.mark.parametrize("name", sweep([*SWIVELS, *range(12)], 4))
def test_the_kernel_gives_what_the_blocks_give(name, rng):
    robot = random_arm(rng) if isinstance(name, int) else robokin.load(name)
    for kind in KINDS:
        T = robokin.forward_kinematics(robot, within(robot, rng, 6, kind))
        block = TargetBlock(_request(robot, True, None, "auto", "pose", None, 0), T)
        alone = [answered(robot, one) for one in T]
        # It answers what is not doubted and has something within the limits, and nothing else.
        assert [one is not None for one in alone] == (block.swivel.known & ~block.swivel.none).tolist()
        for i in [i for i, one in enumerate(alone) if one is not None][:2]:
            check(robokin.solve_ik(robot, T[i]), twin(robot, T[i]), 1e-9)


@pytest.mark.parametrize("most", [1, 5, 33, 34])
def test_fewer_and_more_solutions(most, rng):
    robot = robokin.load("iiwa14")
    T = robokin.forward_kinematics(robot, within(robot, rng, 2, "anywhere"))
    batch = robokin.solve_ik(robot, T, most=most)
    for i in range(2):
        one = robokin.solve_ik(robot, T[i], most=most)
        assert len(one) == most
        check(one, twin(robot, T[i], most), 1e-9)
        check(one, batch[i], 0.0)


def test_a_shuffled_batch_has_the_same_digits(rng):
    robot = robokin.load("iiwa14")
    q = np.concatenate([within(robot, rng, 6, kind) for kind in KINDS])
    T = robokin.forward_kinematics(robot, q)
    order = rng.permutation(len(T))
    one, other = robokin.solve_ik(robot, T), robokin.solve_ik(robot, T[order])
    assert np.array_equal(one.q[order], other.q, equal_nan=True)
    assert np.array_equal(one.position_error[order], other.position_error, equal_nan=True)
    assert np.array_equal(one.count[order], other.count)
    for i in (0, 7, 20):
        alone = robokin.solve_ik(robot, T[i])
        assert np.array_equal(one.q[i, : one.count[i]], [solution.q for solution in alone])


def test_what_is_no_arm_or_no_target_is_refused():
    robot = robokin.load("iiwa14")
    kernel = one_swivel_arm(robot).kernel
    for arguments in ((kernel, np.eye(3), 16), (kernel, np.eye(4)[None], 16), (kernel, np.eye(4), 0)):
        with pytest.raises(ValueError, match=r"expected|asked"):
            native.swivel_solution(*arguments)
    for arguments in ((kernel, np.eye(4), 34), (kernel, np.eye(4)[None], 2**70)):
        with pytest.raises((ValueError, OverflowError)):
            native.swivel_solutions(*arguments, empty_tables(1, 16, 7))
    for tables in (empty_tables(2, 16, 7), empty_tables(1, 15, 7), empty_tables(1, 16, 6), (), list(range(9)), None):
        with pytest.raises(ValueError, match="tables"):
            native.swivel_solutions(kernel, np.eye(4)[None], 16, tables)
    with pytest.raises((TypeError, ValueError)):
        native.swivel_solution(object(), np.eye(4), 16)
    with pytest.raises(ValueError, match="do not fit"):
        native.swivel(
            robokin.kernel.native_kernel.handle(one_swivel_arm(robot).arm.chain),
            np.zeros(99),
            np.zeros((7, 6)),
            np.zeros((13, 11)),
        )
    for T in (np.full((4, 4), np.nan), np.full((4, 4), np.inf), np.full((4, 4), 1e300)):
        assert native.swivel_solution(kernel, T, 16) is None
        tables = empty_tables(1, 16, 7)
        native.swivel_solutions(kernel, T[None], 16, tables)
        assert not tables.plain.any()
        assert np.isnan(tables.q).all()


def test_other_arms_are_left_to_the_blocks():
    for name in ("panda", "gen3", "puma560", "human-arm"):
        assert one_swivel_arm(robokin.load(name)) is None
