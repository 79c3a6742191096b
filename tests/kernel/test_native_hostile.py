"""Whatever the native functions are called with, they answer or refuse: none ends the process."""

from __future__ import annotations

import numpy as np
import pytest
from kernel import test_native_descents, test_native_ways_down
from library_entries import entry

import robokin
from robokin.inverse.elimination.native_elimination import candidates_at, native_elimination
from robokin.inverse.solution_names import branch_names
from robokin.kernel import native_kernel

native = native_kernel.native
pytestmark = pytest.mark.skipif(native is None, reason="no native kernel in use")

NUMBERS = [
    10**9, -(10**9), 2**31, 2**63, 10**30, -1, 0, 3, 1e300, -1e300, 1e-320, np.nan, np.inf, -np.inf, True, None, "x",
    b"x", [1.0], (1.0,), 99_999,
]  # fmt: skip

STATED = ("with_arrays", "instructions")
"""Functions that change what others use."""


@pytest.fixture(scope="module")
def good():
    """Right arguments of each function, as they are called by what robokin does."""
    rng, known = np.random.default_rng(5), {}
    robokin.forward_kinematics(robokin.load("puma560"), np.zeros(6))  # what takes functions at its import has them
    names = [name for name in dir(native) if callable(getattr(native, name)) and name[0] != "_"]
    with pytest.MonkeyPatch.context() as patch:
        for name in names:
            kept, function = known.setdefault(name, []), getattr(native, name)

            def noted(*told, kept=kept, function=function):
                kept.append(told)
                return function(*told)

            patch.setattr(native, name, noted)
        asked(rng)
    return {name: calls[-6:] for name, calls in known.items() if name not in STATED}


def asked(rng):
    """Questions that between them call every function."""
    for name in ("puma560", "crx10ia", "iiwa14", "stanford"):
        robot = robokin.load(name)
        q = rng.uniform(-2.0, 2.0, (4, robot.n))
        T = robokin.forward_kinematics(robot, q)
        robokin.jacobian(robot, np.tile(q, (100, 1)))
        for limits in (False, True):
            assert robokin.solve_ik(robot, T[0], limits=limits).solutions is not None
            robokin.solve_ik(robot, T, limits=limits)
            if robot.n == 7:
                robokin.solve_ik(robot, T, limits=limits, hold={2: 0.3})
        branch_names(robot, q)
        # Who asks for one pose has taken these functions when it was imported.
        native.pose_at_once(robot, q)
        native.jacobian_at_once(robot, q[0].tolist())
    for call in (*test_native_descents.calls(rng), *test_native_ways_down.calls(rng)):
        call(np.arange(4))
    analysis = robokin.inverse.analysis.analysis_of(entry("crx10ia"))
    closing = test_native_descents.closing_at(analysis.loop, rng.uniform(-3.0, 3.0, (4, 6)))
    candidates_at(analysis.solver.first, analysis.loop, closing)
    native_elimination(analysis.solver.first, analysis.loop, analysis.six.chain, analysis.number).many(
        robokin.forward_kinematics(entry("crx10ia"), rng.uniform(-2.0, 2.0, (4, 6)))
    )
    native.rows_in(b"1,a,2\n3,b,4\n", b",", bytes([1, 2, 1]))
    native.text_of_rows(rng.normal(size=(3, 4)))
    native.shortest(rng.normal(size=(3, 6, 7)), rng.normal(size=(3, 6)), 1e-7)
    chain = native.plain_chain(tuple(np.tile(np.eye(4).ravel(), 3).tolist()), (1.0, 0.0), (0.0, 0.5))
    native.plain_pose(chain, (0.1, 0.2))
    robot = entry("panda")
    q = rng.uniform(-2.0, 2.0, (3, 7))
    T, left = robokin.forward_kinematics(robot, q), rng.normal(size=(3, 6))
    robokin.follow_line(robot, np.full(7, 0.5), robokin.forward_kinematics(robot, np.full(7, 0.6)), 50, limits=False)
    arm = native_kernel.handle(test_native_descents.chain_of(robot))
    assert robokin.solve_ik(robot, T[0]).families
    native.finely_closed(arm, T, q, left, 1.0, 6, 0.1, 1e-9, 1e-14)
    native.regular(test_native_descents.native_loop(analysis.loop), rng.normal(size=(3, 12)), np.full(3, 0.1))


def test_every_function_is_called(good):
    assert not [name for name, calls in good.items() if not calls]


def bent(value, rng):
    """An array in another layout, of another type, of other rows or with other numbers in it."""
    broken = np.array(value, dtype=np.float64)
    if broken.size:
        broken.flat[rng.integers(broken.size)] = rng.choice([np.nan, np.inf, -np.inf, 1e300, 1e-320, -1.0, 1e15, 511.0])
    return [
        lambda: value.astype(np.float32), lambda: value.astype(">f8"), lambda: value.astype(np.int64),
        lambda: np.asfortranarray(value), lambda: value[::2], lambda: value[::-1], lambda: value[:0],
        lambda: np.zeros((*value.shape[:-1], 0)), lambda: value.astype(object), lambda: value.ravel(),
        lambda: value[None], lambda: np.broadcast_to(value.ravel()[:1], value.shape), lambda: value.tolist(),
        lambda: np.frombuffer(b"\0" + broken.tobytes(), "u1")[1:].view("f8").reshape(value.shape),
        lambda: value.reshape(value.shape + (1,) * 20), lambda: value.astype(complex), lambda: broken, lambda: broken,
    ][rng.integers(18)]()  # fmt: skip


def other(value, rng, handles):
    """Something else in the place of an argument."""
    if isinstance(value, np.ndarray) and value.size and rng.random() < 0.95:
        return bent(value, rng)
    if type(value).__name__ == "PyCapsule" and rng.random() < 0.8:
        return handles[rng.integers(len(handles))]
    if isinstance(value, bytes) and rng.random() < 0.8:
        broken = bytearray(value)
        broken[rng.integers(len(broken))] = rng.integers(256)
        return bytes(broken) * int(rng.integers(1, 3))
    return NUMBERS[rng.integers(len(NUMBERS))]


@pytest.mark.filterwarnings("ignore")
def test_hostile_calls_are_answered_or_refused(good, rng, instructions):
    names = sorted(good)
    handles = [told for calls in good.values() for call in calls for told in call if type(told).__name__ == "PyCapsule"]
    refusals = 0
    for _ in range(3000):
        name = names[rng.integers(len(names))]
        told = list(good[name][rng.integers(len(good[name]))])
        for place in rng.integers(len(told), size=rng.integers(1, 3)):
            told[place] = other(told[place], rng, handles)
        try:
            getattr(native, name)(*told[: len(told) - (rng.random() < 0.02)])
        except (TypeError, ValueError, OverflowError, IndexError) as error:
            assert str(error)
            refusals += 1
    assert 250 < refusals < 2750
