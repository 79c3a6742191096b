"""The native kernel gives what Python's code gives, wherever joints stand, with every set of instructions."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import threading
from dataclasses import replace

import numpy as np
import pytest
from kernel.test_straight_line import configurations, library, random_robots

import robokin
from robokin.kernel import native_kernel, native_module
from robokin.kernel.chain import Chain, chain_of
from robokin.kernel.frames import program_to_joints, program_to_tool, run
from robokin.kernel.geometric_jacobian import jacobian_of
from robokin.kernel.native_kernel import handle
from robokin.kernel.residual import errors_by_columns

native = native_kernel.native
needs_kernel = pytest.mark.skipif(native is None, reason="no native kernel in use")

ROUNDING = 4e-15
"""Of entries, as a part of the chain's greatest number: a product of some ten matrices."""


def both_ways(robot, q, rng):
    """The greatest differences, by what was asked, as parts of the greatest number of each."""
    chain = chain_of(robot)
    known = handle(chain)
    # Values of slides enter what is added up.
    long = max(1.0, float(np.max(np.abs(q[:, ~chain.revolute]), initial=0.0)))
    F = run(program_to_joints(chain), q)
    size = max(long, float(np.max(np.abs(F))))
    pairs = [
        (native.pose(known, q), run(program_to_tool(chain), q)[:, 0], size),
        (native.frames(known, q), F, size),
        (native.jacobian(known, q, 1.0, False), jacobian_of(F, chain.revolute), size),
        (native.jacobian(known, q, 0.7, True), jacobian_of(F, chain.revolute, "tool", 0.7), size),
    ]
    T = F[rng.permutation(len(q)), -1].copy()
    T[:, :3, 3] += rng.normal(size=(len(q), 3))
    e, J = native.errors(known, T, q, 0.7)
    e_twin, J_twin = errors_by_columns(chain, T, q, 0.7)
    # Next to half a turn the vector of an error is known to half of its digits.
    near = np.linalg.norm(e_twin[:, 3:], axis=1) < 3.1
    pairs += [(e[near], e_twin[near], size), (J, J_twin, size)]
    return [float(np.max(np.abs(a - b), initial=0.0)) / scale for a, b, scale in pairs]


@needs_kernel
def test_random_chains_at_random_round_and_far_configurations(instructions, rng):
    for robot in random_robots(rng, 300):
        differences = both_ways(robot, configurations(rng, robot.n), rng)
        # A joint 10^6 radians around is known to 1e-10, whoever reduces it.
        assert max(differences) < 1e-9, (robot, differences)
        ordinary = configurations(rng, robot.n)[:7]
        differences = both_ways(robot, ordinary, rng)
        assert max(differences[:4] + differences[5:]) < ROUNDING * (1 + robot.n), (robot, differences)
        assert differences[4] < 1e-13, (robot, differences)


@needs_kernel
def test_every_robot_of_the_library_at_its_limits_and_zero(instructions, rng):
    for robot in library():
        limits = np.clip(np.nan_to_num(robot.limits, posinf=np.pi, neginf=-np.pi), -10.0, 10.0)
        q = np.stack([limits[:, 0], limits[:, 1], np.zeros(robot.n), np.full(robot.n, np.pi / 2)])
        differences = both_ways(robot, q, rng)
        assert max(differences[:4] + differences[5:]) < ROUNDING * (1 + robot.n), (robot.id, differences)


@needs_kernel
def test_all_instructions_and_all_numbers_of_configurations_give_the_same_digits(rng):
    if native.instructions() != "avx2":
        pytest.skip("there is one set of instructions here")
    for robot in list(random_robots(rng, 30)):
        chain = chain_of(robot)
        known, q = handle(chain), configurations(rng, robot.n)
        T = native.pose(known, q[::-1].copy())
        answers = []
        for name in ("base", "avx2"):
            native.instructions(name)
            answers.append(
                [
                    native.pose(known, q),
                    native.jacobian(known, q, 1.0, True),
                    *native.errors(known, T, q, 1.0),
                    native.jacobian(known, q, 1.0, False),
                ]
            )
        for a, b in zip(*answers, strict=True):
            assert a.tobytes() == b.tobytes()
        for k, one in enumerate(q):
            e, J = native.errors(known, T[k], one, 1.0)
            for name in ("base", "avx2"):
                native.instructions(name)
                alone = [native.pose(known, one), native.jacobian(known, one, 1.0, True), e, J]
                alone.append(native.jacobian(known, one, 1.0, False))
                assert all(a[k].tobytes() == b.tobytes() for a, b in zip(answers[0], alone, strict=True))


@needs_kernel
def test_one_configuration_and_many_have_the_same_signs_of_zeros_and_no_numbers_in_the_same_places(instructions, rng):
    odd = [0.0, -0.0, np.nan, np.inf, -np.inf, 1e5, 1.0000001e5, -1e300, 5e-324, np.pi]
    for robot in random_robots(rng, 60):
        known = handle(chain_of(robot))
        q = np.where(rng.random((40, robot.n)) < 0.4, rng.choice(odd, (40, robot.n)), rng.uniform(-3, 3, (40, robot.n)))
        T, J = native.pose(known, q), native.jacobian(known, q, 1.0, False)
        for k, one in enumerate(q):
            for many, alone in ((T, native.pose(known, one)), (J, native.jacobian(known, one, 1.0, False))):
                none = np.isnan(alone)
                assert np.array_equal(none, np.isnan(many[k]))
                assert many[k][~none].tobytes() == alone[~none].tobytes()


@needs_kernel
def test_sines_and_cosines_are_right_to_the_last_digit_but_one(instructions, rng):
    turn = Chain(np.stack([np.eye(4)] * 2), np.array([True]), np.zeros(1))
    x = np.concatenate(
        [
            rng.uniform(-1e5, 1e5, 100_000),
            rng.uniform(-7.0, 7.0, 100_000),
            np.arange(-2000, 2001) * (np.pi / 4),
            np.nextafter(np.arange(-200, 201) * (np.pi / 2), np.inf),
            10.0 ** rng.uniform(-300, 0, 1000),
            [0.0, -0.0, 1e5, 1e6, -1e15, 1e300],
        ]
    )
    T = native.pose(handle(turn), x[:, None])
    for found, exact in ((T[:, 1, 0], np.sin), (T[:, 0, 0], np.cos)):
        true = exact(x.astype(np.longdouble))
        off = np.abs(found.astype(np.longdouble) - true) / np.spacing(np.abs(true.astype(np.float64)))
        assert float(np.max(off)) < 1.0


@needs_kernel
def test_what_is_no_number_stays_in_its_row(rng):
    robot = robokin.load("stanford")
    q = rng.uniform(-1, 1, (9, 6))
    for value in (np.nan, np.inf, -np.inf):
        bad = q.copy()
        bad[4, 1] = value
        T = robokin.forward_kinematics(robot, bad)
        assert np.isnan(T[4, :3]).any()
        rest = np.delete(np.arange(9), 4)
        assert T[rest].tobytes() == robokin.forward_kinematics(robot, q)[rest].tobytes()


@needs_kernel
@pytest.mark.parametrize("q", [np.zeros(5), np.zeros((3, 7)), np.zeros(()), [0.0] * 6, None], ids=repr)
def test_wrong_shapes_are_refused(q):
    known = handle(chain_of(robokin.load("puma560")))
    for ask in (native.pose, native.frames):
        with pytest.raises((TypeError, ValueError)):
            ask(known, q)
        with pytest.raises((TypeError, ValueError)):
            ask(object(), np.zeros(6))
    with pytest.raises((TypeError, ValueError)):
        native.errors(known, np.zeros((2, 4, 4)), np.zeros((3, 6)), 1.0)
    for shapes in (((3, 4, 4), 6, 6), ((2, 4, 4), (1, 0), 1), ((1, 4, 4), 0, 0), ((34, 4, 4), 33, 33)):
        with pytest.raises(ValueError, match="fit"):
            native.chain(*map(np.zeros, shapes))


@needs_kernel
def test_numbers_that_change_the_arrays_meanwhile_change_nothing():
    known, q = handle(chain_of(robokin.load("puma560"))), np.zeros((1, 6))

    class Size:
        def __float__(self):
            q.shape = (6, 1)
            return 1.0

        __bool__ = None

    with pytest.raises(ValueError, match="each joint"):
        native.jacobian(known, q, Size(), False)
    with pytest.raises(OverflowError):
        native.jacobian(known, np.zeros(6), 10**400, False)
    with pytest.raises(TypeError):
        native.jacobian(known, np.zeros(6), 1.0, Size())


@needs_kernel
def test_answers_are_written_where_a_caller_wants_them(instructions, rng):
    known, q = handle(chain_of(robokin.load("puma560"))), rng.uniform(-3, 3, (300, 6))
    asks = {
        native.pose: (known, q),
        native.frames: (known, q),
        native.jacobian: (known, q, 1.0, True),
    }
    for ask, arguments in asks.items():
        plain = ask(*arguments)
        out = np.full_like(plain, np.nan)
        assert ask(*arguments, out) is out
        assert out.tobytes() == plain.tobytes()
        fixed = plain.copy()
        fixed.flags.writeable = False
        for wrong in (None, plain[:-1], plain.astype(np.float32), np.asfortranarray(plain), fixed, plain[::2], [0.0],
                      np.zeros((2, *plain.shape))[0, ::-1], plain.astype(">f8")):  # fmt: skip
            with pytest.raises((TypeError, ValueError)):
                ask(*arguments, wrong)
        with pytest.raises(TypeError):
            ask(*arguments, out, out)


@needs_kernel
def test_any_layout_of_the_values_and_any_leading_shape(rng):
    robot = robokin.load("puma560")
    q = rng.uniform(-3, 3, (4, 3, 6))
    T = robokin.forward_kinematics(robot, q)
    assert T.shape == (4, 3, 4, 4)
    assert robokin.forward_kinematics(robot, np.asfortranarray(q)).tobytes() == T.tobytes()
    assert robokin.forward_kinematics(robot, q[::-1])[::-1].tobytes() == T.tobytes()
    assert robokin.forward_kinematics(robot, q.astype(">f8")).tobytes() == T.tobytes()
    assert robokin.forward_kinematics(robot, q[:0]).shape == (0, 3, 4, 4)
    q.flags.writeable = False
    assert robokin.forward_kinematics(robot, q).tobytes() == T.tobytes()


@needs_kernel
def test_threads_and_copies(rng):
    robot = robokin.load("panda")
    q = rng.uniform(-2, 2, (3000, 7))
    T = robokin.forward_kinematics(robot, q)
    assert robokin.forward_kinematics(pickle.loads(pickle.dumps(robot)), q).tobytes() == T.tobytes()
    same = []
    threads = [
        threading.Thread(target=lambda: same.append(robokin.forward_kinematics(robot, q).tobytes() == T.tobytes()))
        for _ in range(8)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert same == [True] * 8


def test_long_chains_are_followed_in_python(rng):
    robot = robokin.load("puma560")
    rows = [replace(row, name=f"q{i}") for i, row in enumerate(robot.rows * 6)]
    long = robokin.Robot("long", tuple(rows))
    assert handle(chain_of(long)) is None
    assert robokin.forward_kinematics(long, np.zeros(36)).shape == (4, 4)


@pytest.mark.parametrize(
    ("asked", "status", "text"),
    [
        ("python", 0, "python\n"),
        ("", 0, f"{robokin.kernel_in_use}\n"),
        ("c", 1, "ROBOKIN_KERNEL is c, expected python or native"),
    ],
)
def test_the_kernel_is_chosen_by_the_environment(asked, status, text):
    environment = {**os.environ, "ROBOKIN_KERNEL": asked}
    if not asked:
        environment["ROBOKIN_KERNEL"] = os.environ.get("ROBOKIN_KERNEL", "")
    program = "import robokin; print(robokin.kernel_in_use)"
    done = subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True)
    assert done.returncode == status
    assert text in (done.stdout if not status else done.stderr)


def test_a_missing_kernel_is_named_where_it_is_insisted_on(monkeypatch):
    monkeypatch.setitem(sys.modules, "robokin.kernel._native", None)
    monkeypatch.delattr("robokin.kernel._native", raising=False)
    monkeypatch.setenv("ROBOKIN_KERNEL", "")
    assert native_module.native_module() is None
    monkeypatch.setenv("ROBOKIN_KERNEL", "native")
    with pytest.raises(robokin.InputError, match="no native kernel"):
        native_module.native_module()
