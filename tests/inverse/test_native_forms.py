"""Closed forms in the native kernel: what Python's code gives, for one pose and for many; what is wrong is refused."""

from __future__ import annotations

import threading
from dataclasses import replace

import numpy as np
import pytest
from inverse import arms
from inverse.truth import Scale
from library_entries import entry, names_of

import robokin
from robokin.inverse import answered_batch
from robokin.inverse.closed_form.form_tape import OPERATIONS, form_tape
from robokin.inverse.closed_form.straight_forms import compiled_form, straight_source
from robokin.inverse.one_target import plain_pose, solve_one
from robokin.inverse.one_target_arm import one_target_arm
from robokin.inverse.posture_code import posture_code
from robokin.inverse.postures import postures_of
from robokin.inverse.window import least_singular_values
from robokin.kernel import native_kernel
from robokin.kernel.chain import chain_of
from robokin.kernel.native_kernel import handle
from robokin.model import CoupledRobot, Robot

native = native_kernel.native
pytestmark = pytest.mark.skipif(native is None, reason="no native kernel in use")

ROUNDING = 2e-14
"""Of joint values [rad], times the least singular value there."""


def known_arms(rng, random=12):
    """The library's arms that the kernel knows, and some random ones."""
    six = [entry(name) for name in names_of(Robot, least=6, most=6)]
    some = [robot for robot in six if not isinstance(robot, CoupledRobot)]
    while random:
        robot = arms.random_chain(rng)
        if robot.n == 6 and (arm := one_target_arm(robot)) is not None and arm.kernel is not None:
            some.append(robot)
            random -= 1
    for robot in some:
        arm = one_target_arm(robot)
        if arm is not None and arm.kernel is not None:
            yield robot, arm


def poses(robot, rng, each=1):
    """Targets at random, round, singular and limit configurations."""
    scale = Scale(robot)
    q = np.concatenate([arms.configurations(robot, scale, rng, each, kind) for kind in arms.KINDS])
    return robokin.forward_kinematics(robot, q)


def without_kernel(change, robot, T, **options):
    """The answers of the blocks in Python."""
    with change.context() as patch:
        patch.setattr(answered_batch, "kernel_form", lambda request: None)
        return robokin.solve_ik(robot, T, **options)


def test_the_library_has_arms_that_the_kernel_knows(rng):
    names = {robot.id for robot, _ in known_arms(rng, 0)}
    assert {"puma560", "ur5e", "irb120"} <= names


def test_one_pose_is_answered_as_by_python(instructions, rng):
    answered = asked = 0
    for number, (robot, arm) in enumerate(list(known_arms(rng))[instructions == "base" :: 6]):
        twin, chain = replace(arm, kernel=None), arm.analysis.six.chain
        near = None if number % 3 else rng.uniform(-4.0, 4.0, 6)
        for T in poses(robot, rng):
            if not plain_pose(T):
                continue
            one, other = (solve_one(way, T, bool(number % 2), None, near) for way in (arm, twin))
            asked += one is not None
            if other is None:
                continue
            assert one is not None, (robot.id, T.tolist())
            answered += 1
            mine, theirs = one.table, other.table
            assert len(mine) == len(theirs), (robot.id, T.tolist())
            gap = np.max(np.abs(mine[:, :6] - theirs[:, :6]))
            assert gap * np.min(least_singular_values(chain, theirs[:, :6], arm.size)) < ROUNDING, (
                robot.id,
                T.tolist(),
            )
            np.testing.assert_array_equal(mine[:, 8], theirs[:, 8])
            np.testing.assert_array_equal(mine[:, 9], [other._equivalents(k) for k in range(len(theirs))])
            inside = mine[:, 8] != 0.0
            assert (one.inside, one.turns) == (inside.sum(), mine[inside, 9].sum())
            assert (one.inside, one.tried) == (other.inside, other.tried)
            assert np.max(mine[:, 6:8]) < 1e-12
    assert answered > 0.9 * asked > 50


@pytest.mark.parametrize("options", [{}, {"limits": False}, {"most": 3}, {"near": [0.3, -1.0, 0.7, 2.0, -0.4, 4.0]}])
def test_a_batch_is_answered_as_by_the_blocks(options, rng, monkeypatch):
    for robot, arm in list(known_arms(rng, 4))[len(options) :: 18]:
        T = poses(robot, rng)
        mine, theirs = robokin.solve_ik(robot, T, **options), without_kernel(monkeypatch, robot, T, **options)
        assert (mine.complete, mine.method) == (theirs.complete, theirs.method)
        np.testing.assert_array_equal(mine.count, theirs.count)
        assert mine.q.shape == theirs.q.shape
        for i, (one, other) in enumerate(zip(mine, theirs, strict=True)):
            for name in ("certificate", "complete", "basis", "postures", "reason", "counts", "all_known"):
                assert getattr(one, name) == getattr(other, name), (robot.id, i, name)
            assert len(one.families) == len(other.families)
            least = np.min(
                least_singular_values(arm.analysis.six.chain, theirs.q[i, : len(other)], arm.size), initial=1
            )
            # Equally near ones, by the last digit, may change places.
            places = [np.argmin([np.max(np.abs(s.q - solution.q)) for s in other]) for solution in one]
            assert "near" in options or places == list(range(len(one)))
            for place, solution in zip(places, one, strict=True):
                expected = other[place]
                assert np.max(np.abs(solution.q - expected.q)) * least < ROUNDING, (robot.id, i)
                assert (solution.branch, solution.free) == (expected.branch, expected.free)
                assert solution.within_limits == expected.within_limits


def test_every_number_of_poses_in_any_order_gives_the_same_digits(rng):
    for name in ("puma560", "ur5e", "irb120"):
        robot = entry(name)
        T = poses(robot, rng, 3)
        whole = robokin.solve_ik(robot, T, limits=False)
        for some in (rng.permutation(len(T)), np.arange(5), np.arange(17), rng.integers(0, len(T), 300)):
            part = robokin.solve_ik(robot, T[some], limits=False)
            assert [one.tobytes() for one in part.q[:, :1]] == [one.tobytes() for one in whole.q[some, :1]]
            np.testing.assert_array_equal(part.count, whole.count[some])
        for i in range(0, len(T), 4):
            alone = robokin.solve_ik(robot, T[i], limits=False)
            assert [solution.q.tobytes() for solution in alone] == [solution.q.tobytes() for solution in whole[i]]
            assert [solution.branch for solution in alone] == [solution.branch for solution in whole[i]]


def test_all_instructions_give_the_same_digits(rng):
    if native.instructions() != "avx2":
        pytest.skip("there is one set of instructions here")
    for robot, arm in known_arms(rng, 6):
        T = poses(robot, rng)
        answers = []
        for name in ("base", "avx2"):
            native.instructions(name)
            answers.append(native.solutions(arm.kernel, T, True, None))
        assert [part.tobytes() for part in answers[0]] == [part.tobytes() for part in answers[1]], robot.id


def test_mirrored_and_far_and_turned_targets_are_left_to_others(rng):
    arm = one_target_arm(entry("puma560"))
    T = robokin.forward_kinematics(arm.robot, np.full(6, 0.4))
    assert native.solution(arm.kernel, T, True, None, None) is not None
    changes = {(0, 0): 0.5, (1, 2): np.nan, (3, 0): 1e-3, (2, 3): np.inf}
    for place, value in changes.items():
        wrong = T.copy()
        wrong[place] = value
        assert native.solution(arm.kernel, wrong, True, None, None) is None
        if not np.isfinite(value):
            assert native.solutions(arm.kernel, np.stack([wrong, T]), True, None)[0].tolist() == [False, True]
    far = T.copy()
    far[0, 3] = 9.0
    rows, _, tried, *_ = native.solution(arm.kernel, far, True, None, None)
    assert (rows.shape, tried) == ((0, 10), 0)
    plain, count, listed, *_ = native.solutions(arm.kernel, np.stack([far, T]), True, None)
    assert (plain.tolist(), count.tolist(), int(listed[0])) == ([True, True], [0, 8], 0)
    assert not native.rigid(-T)
    assert native.rigid(np.stack([T, T])[None])
    assert not native.rigid(np.eye(3))
    for other in (T.tolist(), T.astype(np.float32), T[:3], T[None], T.astype(">f8"), T.view(np.matrix), None, "T"):
        assert native.solution(arm.kernel, other, True, None, None) is None
    turned = np.asfortranarray(T)
    np.testing.assert_array_equal(
        native.solution(arm.kernel, turned, True, None, None)[0], native.solution(arm.kernel, T, True, None, None)[0]
    )


MEANING = {
    "added": lambda a, b, c, d: a + b, "less": lambda a, b, c, d: a - b, "times": lambda a, b, c, d: a * b,
    "over": lambda a, b, c, d: a / b, "minus": lambda a, b, c, d: -a, "root": lambda a, b, c, d: np.sqrt(a),
    "magnitude": lambda a, b, c, d: abs(a), "signed": lambda a, b, c, d: np.copysign(a, b),
    "clamped": lambda a, b, c, d: min(max(a, -1.0), 1.0), "chosen": lambda a, b, c, d: b if a > 0.0 else c,
    "greater": lambda a, b, c, d: max(a, b), "angle": lambda a, b, c, d: np.arctan2(a, b),
    "paired": lambda a, b, c, d: a * b + c * d, "crossed": lambda a, b, c, d: a * b - c * d,
}  # fmt: skip


def interpreted(tape, rows, roots):
    """The joint values of the leaves for a choice of roots, or what is in the way."""
    values = np.zeros(tape.slots)
    values[:12], values[12 : 12 + len(tape.constants)] = rows, tape.constants
    for operation, out, level, *where in tape.steps.astype(int).tolist():
        name = OPERATIONS[operation]
        a, b, c, d = values[where[::2]].tolist()
        if name in ("real", "needed", "lever"):
            if not a >= b:
                return name
        elif name != "entered":
            values[out] = MEANING[name](a, b, c, d) if name != "both" else b if roots[level - 1] else a
    return values[tape.leaves[:, :, 0].astype(int)].tolist()


def test_a_tape_says_what_its_source_says(rng):
    for robot, arm in list(known_arms(rng, 4))[::3]:
        source = straight_source(arm.analysis.solver)
        if source is None:
            continue  # an arm by elimination
        tape, form = form_tape(source), compiled_form(source)
        for T in robokin.forward_kinematics(robot, rng.uniform(-3.0, 3.0, (3, 6))):
            rows = arm.loop.closing(T[None])[0, :3].ravel()
            expected = form(rows.tolist())
            choices = [[bool(k >> i & 1) for i in range(tape.levels)] for k in range(2**tape.levels)]
            found = [interpreted(tape, rows, choice) for choice in choices]
            if expected is None:
                assert {"needed", "lever"} & set(map(str, found))
                continue
            leaves = [tuple(leaf) for some in found if some != "real" for leaf in some]
            assert sorted(leaves) == sorted(expected)


def test_source_that_is_not_understood_has_no_tape():
    head = "def straight(rows):\n    r00, r01, r02, r03, r10, r11, r12, r13, r20, r21, r22, r23 = rows\n"
    for line in ("v0 = r00 % r01", "v0 = sin(r00)", "while True: pass", "v0 = [r00]", "v0 = r00 ** 2.0", "del r00"):
        assert form_tape(head + f"    {line}\n    return []") is None


def parts():
    """The arguments of a form that fit each other."""
    arm = one_target_arm(entry("puma560"))
    tape = form_tape(straight_source(arm.analysis.solver))
    links = np.stack([arm.loop.first, arm.loop.last])
    limits = np.zeros((6, 7))
    limits[:, :2] = -np.inf, np.inf
    sizes = np.array([arm.loop.size, arm.size])
    return [handle(arm.analysis.six.chain), links, sizes, tape.steps, tape.constants, tape.leaves, tape.levels, limits]


def test_signs_that_name_postures_are_those_of_python(instructions, rng):
    told = 0
    for robot in [*map(entry, names_of(Robot, least=6, most=6)[::6]), *(arms.random_chain(rng) for _ in range(12))]:
        if isinstance(robot, CoupledRobot) or robot.n != 6:
            continue
        postures = postures_of(chain_of(robot))
        known = posture_code(postures)
        if known is None:
            assert postures.numbered or not postures.signs
            continue
        told += 1
        q = np.concatenate([rng.uniform(-3.0, 3.0, (20, 6)), np.pi / 12 * rng.integers(-12, 13, (41, 6))])
        axes = postures.axes(q)
        expected = sum(sign.holds(axes).astype(int) << bit for bit, sign in enumerate(postures.signs))
        np.testing.assert_array_equal(native.sides(known, q), expected)
        np.testing.assert_array_equal(native.sides(known, q[::-1]), expected[::-1])
        assert [native.sides(known, one[None])[0] for one in q[:9]] == expected[:9].tolist()
    assert told > 8


def test_hostile_signs_are_refused():
    chain, none = parts()[0], np.zeros((0, 11))
    zero, first = np.zeros(0), np.zeros((1, 2))
    known = native.signs(chain, 1.0, none, zero, first)
    with pytest.raises(ValueError):
        native.sides(known, np.zeros((3, 5)))
    with pytest.raises(ValueError):
        native.sides(chain, np.zeros((3, 6)))
    with pytest.raises((TypeError, ValueError)):
        native.sides(known, [0.0] * 6)
    with pytest.raises(ValueError):
        native.solution(known, np.eye(4), True, None, None)
    wrong = [
        (known, 1.0, none, zero, first), (chain, 0.0, none, zero, first), (chain, np.nan, none, zero, first),
        (chain, 1.0, np.zeros((1, 8)), zero, first), (chain, 1.0, none, np.zeros(600), first),
        (chain, 1.0, none, zero, first + 512), (chain, 1.0, none, zero, np.zeros((7, 2))),
        (chain, 1.0, np.zeros((1, 11)), zero, first), (chain, 1.0, none, zero, np.array([[3.0, 1.0]])), (chain, 1.0),
    ]  # fmt: skip
    for arguments in wrong:
        with pytest.raises((TypeError, ValueError)):
            native.signs(*arguments)
    assert len(native.sides(known, np.zeros((0, 6)))) == 0


def test_hostile_forms_are_refused(rng):
    good = parts()
    native.form(*good)
    three = handle(native_kernel.Chain(np.stack([np.eye(4)] * 4), np.ones(3, dtype=bool), np.zeros(3)))
    slide = handle(native_kernel.Chain(np.stack([np.eye(4)] * 7), np.arange(6) > 0, np.zeros(6)))
    wrong = {
        0: [None, "chain", three, slide, good],
        1: [good[1][0], good[1][:, :3], np.zeros((3, 4, 4)), None],
        2: [np.zeros(2), np.array([1.0, np.nan]), np.ones(3), 1.0, -good[2]],
        3: [good[3][:, :9], np.zeros((5000, 11)), None, good[3][:, 0]],
        4: [np.zeros(600), None],
        5: [good[5][:, :5], np.tile(good[5], (3, 1, 1)), good[5][:0], good[5] + 0.5, good[5] + 600.0, -good[5] - 1.0],
        6: [-1, 4, 0.5, np.nan, "2", None, 1e300, 1],
        7: [good[7][:5], good[7][:, :6], None],
    }
    for place, values in wrong.items():
        for value in values:
            arguments = [*good]
            arguments[place] = value
            with pytest.raises((TypeError, ValueError, OverflowError)):
                native.form(*arguments)
    for _ in range(300):
        steps = good[3].copy()
        row, column = rng.integers(len(steps)), rng.integers(11)
        steps[row, column] = rng.choice([-1.0, 19.0, 512.0, 511.0, 4.0, 0.5, np.nan, np.inf, 1e300, -1e300])
        try:
            form = native.form(*good[:3], steps, *good[4:])
        except ValueError:
            continue
        T = robokin.forward_kinematics(entry("puma560"), rng.uniform(-3.0, 3.0, (9, 6)))
        native.solutions(form, T, True, None)
        native.solution(form, T[0], True, None, None)
    for count in (0, 1, 3, 6):
        with pytest.raises(TypeError):
            native.solution(*[native.form(*good)] * count)
        with pytest.raises(TypeError):
            native.solutions(*[native.form(*good)] * count)
    form, T = native.form(*good), np.eye(4)
    for wish in ([0.0] * 6, np.zeros(5), "wish", 3):
        with pytest.raises((TypeError, ValueError)):
            native.solution(form, T, True, wish, None)
    with pytest.raises(ValueError, match="targets"):
        native.solutions(form, np.zeros((2, 4, 5)), True, None)
    with pytest.raises((TypeError, ValueError)):
        native.solutions(form, T, True, None)
    with pytest.raises(ValueError):
        native.solution(good[0], T, True, None, None)
    assert [len(part) for part in native.solutions(form, np.zeros((0, 4, 4)), True, None)] == [0] * 7


def test_targets_that_change_meanwhile_do_no_harm(rng):
    robot = entry("ur5e")
    arm = one_target_arm(robot)
    T = robokin.forward_kinematics(robot, rng.uniform(-3.0, 3.0, (4000, 6)))
    ready = threading.Event()

    def disturb():
        while not ready.is_set():
            T[rng.integers(4000)] = rng.choice([0.0, np.nan, 1e308, 1.0])

    other = threading.Thread(target=disturb)
    other.start()
    for _ in range(20):
        plain, count, listed, q, *_ = native.solutions(arm.kernel, T, True, None)
        assert np.all(count[~plain] == 0)
        assert np.all(listed <= count)
        assert np.all(np.isnan(q) == (np.arange(q.shape[1]) >= listed[:, None])[:, :, None])
    ready.set()
    other.join()
