"""Newton's steps and paths of the native kernel lead where Python's lead, wherever they begin."""

from __future__ import annotations

import threading
from dataclasses import replace

import numpy as np
import pytest
from inverse.loops import named
from kernel.test_straight_line import random_robots
from library_entries import entry

import robokin
from robokin.formats.read import read_text
from robokin.inverse.analysis import analysis_of
from robokin.inverse.elimination import complex_newton, homotopy_paths, loop_newton
from robokin.inverse.elimination.complex_newton import complex_refine
from robokin.inverse.elimination.homotopy_paths import points_of, track
from robokin.inverse.elimination.loop import native_loop
from robokin.inverse.elimination.loop_newton import closing_at, refine
from robokin.inverse.elimination.monodromy import started
from robokin.inverse.elimination.native_elimination import candidates_at
from robokin.inverse.elimination.splits import count_solutions
from robokin.inverse.numeric import least_squares
from robokin.inverse.numeric.least_squares import descend
from robokin.inverse.second_look import known_solutions
from robokin.inverse.self_motion import fronts, pose_correction
from robokin.inverse.self_motion.curve_tracing import leads_away, trace_many
from robokin.inverse.self_motion.pose_correction import corrected
from robokin.kernel import native_kernel
from robokin.kernel.chain import chain_of, chain_size
from robokin.kernel.native_kernel import handle

native = native_kernel.native
pytestmark = pytest.mark.skipif(native is None, reason="no native kernel in use")

LOOPS = ("crx10ia", "ur5e", "stanford")
"""Without a closed form, with parallel axes, with a slide."""

CHAINS = ("panda", "crx10ia", "scara", "stanford")


@pytest.fixture
def in_python(monkeypatch):
    """What a function gives without the native kernel."""

    def asked(function, *given, **named):
        with monkeypatch.context() as patch:
            for module in (complex_newton, homotopy_paths, loop_newton, least_squares, pose_correction, fronts):
                patch.setattr(module, "native", None)
            return function(*given, **named)

    return asked


def everywhere(revolute, rng, count):
    """Joint values (4 count, n): random, round, singular where several are 0, and far around."""
    n = len(revolute)
    q = rng.uniform(-3.0, 3.0, (4 * count, n))
    q[count : 2 * count] = np.radians(15.0) * rng.integers(-12, 13, (count, n))
    q[2 * count : 3 * count] *= rng.random((count, n)) < 0.4
    q[3 * count :] *= 10.0
    return np.where(revolute, q, 0.1 * q)


def digits(parts):
    return b"".join(np.ascontiguousarray(part).tobytes() for part in parts)


@pytest.mark.parametrize("name", LOOPS)
def test_complex_values_are_refined_alike(name, rng, instructions, in_python):
    loop = named(name)
    q = everywhere(loop.revolute, rng, 20)
    index = np.arange(len(q))
    start = q + 0.03 * rng.normal(size=q.shape) + 0.3j * rng.normal(size=q.shape)
    closing = closing_at(loop, q)
    values, residual = complex_refine(loop, closing, index, start, 12)
    wished, expected = in_python(complex_refine, loop, closing, index, start, 12)
    both = (residual < 1e-13) & (expected < 1e-13)
    assert np.mean((residual < 1e-13) == (expected < 1e-13)) > 0.9
    regular = both & complex_newton.regular(loop, wished, expected, 1e-3)
    assert np.count_nonzero(regular) > 20
    assert np.abs(values - wished)[regular].max() < 1e-10
    # The residual is that of the values.
    again = in_python(complex_refine, loop, closing, index, values, 0)[1]
    assert np.abs(again - residual)[both].max() < 1e-14


@pytest.mark.parametrize("name", LOOPS[:2])
def test_real_values_are_refined_alike(name, rng, instructions, in_python):
    loop = named(name)
    q = everywhere(loop.revolute, rng, 60)
    start, index = q + rng.choice([0.01, 0.3], (len(q), 1)) * rng.normal(size=q.shape), np.arange(len(q))
    closing = closing_at(loop, q)
    values, position, angle = refine(loop, closing, index, start, 15)
    wished, *lack = in_python(refine, loop, closing, index, start, 15)
    closes, wished_closes = position + angle < 1e-9, sum(lack) < 1e-9
    assert np.mean(closes == wished_closes) > 0.97
    assert np.mean(closes) > 0.7
    far = np.abs(values - wished).max(axis=1)[closes & wished_closes]
    # Where the arm is singular what closes to 1e-9 is known to the root of that.
    assert far.max() < 1e-4
    assert np.median(far) < 1e-12


@pytest.mark.parametrize("name", LOOPS)
def test_paths_end_alike(name, rng, instructions, in_python):
    loop, analysis = named(name), analysis_of(entry(name))
    start = started(loop, known_solutions(loop, analysis.solver, analysis.number))[0]
    N, q = start.values.shape[1], everywhere(loop.revolute, rng, 2)
    target = points_of(closing_at(loop, q)).pick(np.repeat(np.arange(len(q)), N))
    asked = loop, start.point.pick(np.zeros(N * len(q), dtype=int)), target, np.tile(start.values, len(q))
    bend = np.exp(1j * rng.uniform(-1.0, 1.0, N * len(q)))
    for more in ((), (bend,)):
        ends, wished = track(*asked, *more), in_python(track, *asked, *more)
        # A regular random pose, all of whose paths end.
        assert not ends.u[: 2 * N].any()
        assert np.abs(ends.values - wished.values)[:, : 2 * N].max() < 1e-9
        both = (ends.u == 0.0) & (wished.u == 0.0)
        assert np.mean((ends.u == 0.0) == (wished.u == 0.0)) > 0.9
        assert np.abs(ends.values - wished.values)[:, both].max() < 1e-4
        assert np.mean(ends.lost == wished.lost) > 0.95


@pytest.mark.parametrize("name", CHAINS)
def test_descents_end_alike_within_limits_and_without(name, rng, instructions, in_python):
    robot = entry(name)
    chain = chain_of(robot)
    size, scale = chain_size(chain), np.where(chain.revolute, 1.0, chain_size(chain))
    low, high = np.clip(np.nan_to_num(robot.limits, posinf=3.0, neginf=-3.0), -3.0, 3.0).T
    q = everywhere(chain.revolute, rng, 20)
    q[:40] = np.clip(q[:40], low, high)
    T = robokin.forward_kinematics(robot, q)
    start = q + 0.3 * scale * rng.normal(size=q.shape)
    for limits in (None, np.stack([low, high], axis=1)):
        x, e = descend(chain, T, start, size, limits=limits)
        wished, left = in_python(descend, chain, T, start, size, limits=limits)
        assert limits is None or np.all((x >= low - 1e-12) & (x <= high + 1e-12))
        closes, expected = np.abs(e).max(axis=1) < 1e-9, np.abs(left).max(axis=1) < 1e-9
        assert np.mean(closes == expected) > 0.95
        assert np.median(np.abs(x - wished)[closes & expected]) < 1e-8
        assert np.median(np.abs(e - left)) < 1e-9
        # Errors are those of the values.
        again = robokin.kernel.residual.error_and_jacobian(chain, T, x, size)[0]
        assert np.abs(again - e)[np.linalg.norm(e[:, 3:], axis=1) < 3.0].max() < 1e-11


@pytest.mark.parametrize("name", CHAINS)
def test_corrections_lead_to_the_same_places(name, rng, instructions, in_python):
    robot = entry(name)
    chain = chain_of(robot)
    size, n = chain_size(chain), chain.n
    scale = pose_correction.scale_of(chain, size)
    q = everywhere(chain.revolute, rng, 20)[:60]
    T, x = robokin.forward_kinematics(robot, q), q / scale + 0.02 * rng.normal(size=q.shape)
    plane = np.linalg.svd(robokin.jacobian(robot, q) * scale)[2][:, -1:]
    locks = np.where(rng.random((len(q), n, 1)) < 0.2, np.eye(n), 0.0)
    many = rng.integers(3, 40, len(q))
    for normals, steps in ((None, 8), (plane, many), (np.concatenate([plane, locks], axis=1), 8)):
        asked = chain, T, x, size, normals, steps, 1e-13, 1e-7
        got, wished = corrected(*asked), in_python(corrected, *asked)
        closes, expected = got[1] <= 5e-10, wished[1] <= 5e-10
        assert np.mean(closes == expected) > 0.9
        for mine, theirs in zip(got, wished, strict=True):
            gap = np.abs(mine - theirs)
            assert np.median(gap) < 1e-12
        # What is given back belongs together.
        e, J = pose_correction.errors(chain, T, got[0], size)
        assert np.abs(J - got[2]).max() < 1e-12
        assert np.abs(np.abs(e).max(axis=1) - got[1])[np.abs(e).max(axis=1) < 1.0].max() < 1e-12


def tangents(robot, q, size):
    """The null vectors (s, n) of the Jacobians at q (s, n), joint values and lengths in sizes."""
    J = robokin.jacobian(robot, q)
    J[:, :3] /= size
    return np.linalg.svd(J * np.where(robot.revolute, 1.0, size))[2][:, -1]


@pytest.mark.parametrize("name", ["panda", "iiwa14", "xarm7", "gen3"])
def test_curves_have_the_same_points(name, rng, instructions, in_python):
    robot = entry(name)
    chain = chain_of(robot)
    size = chain_size(chain)
    q = np.concatenate([rng.uniform(-2.0, 2.0, (4, 7)), np.radians(30.0) * rng.integers(-3, 4, (3, 7))])
    asked = chain, robokin.forward_kinematics(robot, q), q, tangents(robot, q, size), size
    assert np.array_equal(leads_away(*asked), in_python(leads_away, *asked))
    for mine, theirs in zip(trace_many(*asked), in_python(trace_many, *asked), strict=True):
        assert mine.closed == theirs.closed
        assert mine.ended == theirs.ended
        # Where one passes a crossing its steps hang on the last digits.
        assert mine.ended or abs(len(mine.x) - len(theirs.x)) <= 2
        if mine.x.shape == theirs.x.shape:
            assert np.abs(mine.x - theirs.x).max() < 1e-6
            assert np.abs(mine.tangents - theirs.tangents).max() < 1e-5
    whole = trace_many(*asked)
    alone = [trace_many(chain, asked[1][i : i + 1], q[i : i + 1], asked[3][i : i + 1], size)[0] for i in range(4)]
    assert digits(curve.x for curve in whole[:4]) == digits(curve.x for curve in alone)


def test_curves_with_slides_end_where_python_ends_them(rng, in_python):
    robot = read_text(
        "robokin: 1\nname: RRRRPRR\nunits: {length: m, angle: deg}\njoints:\n"
        "  - {type: revolute, d: 0.3, a: 0, alpha: 90}\n  - {type: revolute, d: 0, a: 0.3, alpha: -90}\n"
        "  - {type: revolute, d: 0.1, a: 0.2, alpha: 90}\n  - {type: revolute, d: 0.2, a: 0.1, alpha: 60}\n"
        "  - {type: prismatic, theta: 20, a: 0, alpha: 90, limits: [-1, 1]}\n"
        "  - {type: revolute, d: 0.1, a: 0.1, alpha: -90}\n  - {type: revolute, d: 0.1, a: 0, alpha: 0}\n"
    )
    chain = chain_of(robot)
    size = chain_size(chain)
    q = rng.uniform(-1.0, 1.0, (6, 7))
    x = q / np.where(chain.revolute, 1.0, size)
    asked = chain, robokin.forward_kinematics(robot, q), x, tangents(robot, q, size), size, None, robot.limits
    for mine, theirs in zip(trace_many(*asked), in_python(trace_many, *asked), strict=True):
        assert (mine.closed, mine.ended) == (theirs.closed, theirs.ended)
        assert abs(len(mine.x) - len(theirs.x)) <= 2


def test_random_chains_descend_alike(rng, in_python):
    for robot in random_robots(rng, 40):
        chain = chain_of(robot)
        if chain.n > native.most_moved:
            continue
        size = chain_size(chain)
        q = everywhere(chain.revolute, rng, 3)[:9]
        T = robokin.forward_kinematics(robot, q)
        start = q + 0.05 * rng.normal(size=q.shape)
        e, left = (call(chain, T, start, size)[1] for call in (descend, lambda *a: in_python(descend, *a)))
        assert np.mean((np.abs(e).max(axis=1) < 1e-9) == (np.abs(left).max(axis=1) < 1e-9)) > 0.85, robot


@pytest.mark.parametrize("name", ["crx10ia", "hc10"])
def test_candidates_are_those_of_python(name, rng, instructions):
    robot = entry(name)
    analysis = analysis_of(robot)
    q = np.concatenate([rng.uniform(-3, 3, (20, 6)), np.radians(15.0) * rng.integers(-12, 13, (20, 6))])
    closing = analysis.loop.closing(robokin.forward_kinematics(robot, q))
    solver = analysis.solver.first
    counts = []
    for found in (candidates_at(solver, analysis.loop, closing), solver.all_candidates(closing)):
        assert all(np.all(np.diff(part.index) >= 0) for part in found)
        parts = [(part.index, part.values) for part in found]
        counts.append(count_solutions(analysis.loop, closing, parts, 4).number)
    assert np.array_equal(counts[0][:20], counts[1][:20])
    assert np.mean(counts[0] == counts[1]) > 0.8
    assert not len(candidates_at(solver, analysis.loop, closing, complex_too=False)[1].index)


def calls(rng):
    """Calls of all kinds, as functions of which rows (s,) they are made for."""
    loop = named("crx10ia")
    known, q = native_loop(loop), rng.uniform(-3.0, 3.0, (21, 6))
    closing = closing_at(loop, q)
    numbers = (q + 0.2 * rng.normal(size=q.shape) + 0.2j * rng.normal(size=q.shape)).view(np.float64)
    last = closing.astype(complex).reshape(-1, 16).view(np.float64)
    points = [np.ascontiguousarray(np.concatenate([p.r, p.p]).T).view(np.float64)
              for p in (points_of(closing[::-1]), points_of(closing))]  # fmt: skip
    bend = np.tile([0.6, 0.8], (21, 1))
    robot = entry("panda")
    chain = chain_of(robot)
    arm, x = handle(chain), rng.uniform(-2.0, 2.0, (21, 7))
    T = robokin.forward_kinematics(robot, x)
    start, ones, normals = x + 0.1 * rng.normal(size=x.shape), np.ones(21), rng.normal(size=(21, 1, 7))
    numbers_of = np.zeros((42, 6))
    numbers_of[:, 0], numbers_of[:, 1], numbers_of[:, 4] = 0.05, 0.1, 1.0
    ways = tangents(robot, x, 1.0)
    state = np.concatenate([np.tile(x, (2, 1)), np.concatenate([ways, -ways]), np.zeros((42, 7)), numbers_of], axis=1)
    endless = np.full((42, 7), np.inf)

    def steps(i):
        both = np.append(i, i + 21)
        wide = -endless[both], endless[both]
        curves = np.zeros(len(i)), np.full(len(i), 25.0)
        asked = np.tile(T, (2, 1, 1))[both], np.full(len(both), 8.0), *wide, state[both], *curves, 1.0, 8.0
        state_of, closed, *_ = native.advanced(arm, *asked)
        return state_of[: len(i)], state_of[len(i) :], closed

    return [
        steps,
        lambda i: native.refined(known, closing[i], q[i] + 0.1, 15),
        lambda i: native.complex_refined(known, last[i], numbers[i], 6, 0.5),
        lambda i: native.tracked(known, points[0][i], points[1][i], bend[i], numbers[i]),
        lambda i: native.descended(arm, T[i], ones[i], start[i], 1.0, *robot.limits.T, 30),
        lambda i: native.corrected(arm, T[i], normals[i], 1, 9 * ones[i], start[i], 1.0, 1e-13, 1e-7),
    ]


def test_rows_are_alone_and_all_instructions_give_the_same_digits(rng):
    every, before = np.arange(21), native.instructions()
    for call in calls(rng):
        native.instructions("base")
        expected = call(every)
        for i in (0, 7, 20):
            assert digits(call(every[i : i + 1])) == digits(part[i : i + 1] for part in expected)
        assert digits(call(every[::-1])) == digits(part[::-1] for part in expected)
        assert [len(part) for part in call(every[:0])] == [0] * len(expected)
        native.instructions(before)
        assert digits(call(every)) == digits(expected)


def test_what_is_no_number_ends_and_stays_in_its_row(rng, instructions):
    every, strange = np.arange(9), (np.nan, np.inf, -np.inf, 1e300, 1e15)
    loop, robot = named("crx10ia"), entry("panda")
    chain = chain_of(robot)
    q, x = rng.uniform(-3.0, 3.0, (9, 6)), rng.uniform(-2.0, 2.0, (9, 7))
    closing, T = closing_at(loop, q), robokin.forward_kinematics(robot, x)
    calls_of = [
        lambda c, v: refine(loop, c, every, v, 15),
        lambda c, v: complex_refine(loop, c, every, v + 0j, 15),
        lambda c, v: descend(chain, c, v, 1.0),
        lambda c, v: corrected(chain, c, v, 1.0),
    ]
    for call, targets, values in zip(calls_of, (closing, closing, T, T), (q, q, x, x), strict=True):
        expected = call(targets, values + 0.01)
        for wrong in strange:
            broken, bent = values + 0.01, targets.copy()
            broken[2, 3] = bent[5, 1, 2] = wrong
            with np.errstate(all="ignore"):
                got = call(bent, broken)
            rest = np.delete(every, [2, 5])
            assert digits(part[rest] for part in got) == digits(part[rest] for part in expected)
    points = np.full((9, 14), np.nan), np.full((9, 14), 1e300)
    for start in points:
        for target in points:
            _, left = native.tracked(native_loop(loop), start, target, np.ones((9, 2)), np.zeros((9, 12)))
            assert np.all(left[:, 0] > 0.0)


def test_arrays_that_do_not_fit_are_refused(rng):
    loop, slides = native_loop(named("crx10ia")), native_loop(named("stanford"))
    arm = handle(chain_of(entry("panda")))
    one = np.ones

    def advanced(chain, m, s, state=27, most=1.0, steps=1.0):
        wide = one((m, 7)), one((m, 7))
        left = np.full(s, steps)
        return native.advanced(chain, one((m, 4, 4)), np.full(m, most), *wide, one((m, state)), one(s), left, 1.0, 8.0)

    for wrong in (
        lambda: native.refined(loop, one((2, 4, 4)), one((3, 6)), 3),
        lambda: native.refined(loop, one((3, 4, 4)), one((3, 5)), 3),
        lambda: native.refined(loop, one((3, 4, 4)), one((3, 6)), -1),
        lambda: native.refined(slides, one((3, 4, 4)), one((3, 6)), 3),
        lambda: native.refined(arm, one((3, 4, 4)), one((3, 6)), 3),
        lambda: native.complex_refined(loop, one((3, 16)), one((3, 12)), 3, 0.5),
        lambda: native.tracked(loop, one((3, 14)), one((2, 14)), one((3, 2)), one((3, 12))),
        lambda: native.descended(arm, one((3, 4, 4)), one(3), one((3, 6)), 1.0, one(7), one(7), 3),
        lambda: native.descended(arm, one((3, 4, 4)), one(3), one((3, 7)), 1.0, one(6), one(7), 3),
        lambda: native.corrected(arm, one((3, 4, 4)), one((3, 9, 7)), 9, one(3), one((3, 7)), 1.0, 0.0, 0.0),
        lambda: native.corrected(arm, one((3, 4, 4)), one((3, 2, 7)), 1, one(3), one((3, 7)), 1.0, 0.0, 0.0),
        lambda: native.corrected(arm, one((3, 4, 4)), one((3, 1, 7)), 1, np.inf * one(3), one((3, 7)), 1.0, 0.0, 0.0),
        lambda: native.corrected(arm, one((3, 4, 4)), one((3, 1, 7)), 1, np.nan * one(3), one((3, 7)), 1.0, 0.0, 0.0),
        lambda: native.followed_rows(arm, one((3, 4, 4)), one((1, 6)), one((1, 7)), one((4, 7)), 1.0, 0, True, False),
        lambda: native.followed_rows(arm, one((3, 4, 4)), one((1, 7)), one((1, 7)), one((2, 7)), 1.0, 0, True, False),
        lambda: native.followed_rows(arm, one((3, 4, 4)), one((1, 7)), one((1, 7)), one((4, 7)), 1.0, 8, True, False),
        lambda: native.refined(loop, one((3, 4, 4)), one((3, 6)), 10**9),
        lambda: native.refined(loop, one((3, 4, 4)), one((3, 6)), 99_999),
        lambda: native.complex_refined(loop, one((3, 32)), one((3, 12)), 99_999, 0.5),
        lambda: native.descended(arm, one((3, 4, 4)), one(3), one((3, 7)), 1.0, one(7), one(7), 99_999),
        lambda: native.corrected(arm, one((3, 4, 4)), one((3, 1, 7)), 1, 1e4 * one(3), one((3, 7)), 1.0, 0.0, 0.0),
        lambda: native.candidates(arm, one((3, 4, 4))),
        lambda: advanced(arm, 4, 2, most=np.inf),
        lambda: advanced(arm, 4, 2, most=np.nan),
        lambda: advanced(arm, 4, 2, most=1e4),
        lambda: advanced(arm, 4, 2, most=-1.0),
        lambda: advanced(arm, 4, 2, steps=np.nan),
        lambda: advanced(arm, 4, 2, steps=99_999.0),
        lambda: advanced(arm, 3, 1),
        lambda: advanced(arm, 2, 2),
        lambda: advanced(arm, 4, 2, state=26),
        lambda: advanced(loop, 4, 2),
    ):
        with pytest.raises(ValueError, match=r"fit|steps|turning|six|normals|open|PyCapsule"):
            wrong()
    for few in (
        native.refined,
        native.complex_refined,
        native.tracked,
        native.descended,
        native.corrected,
        native.followed_rows,
        native.advanced,
    ):
        with pytest.raises(TypeError):
            few(loop)
    long = replace(entry("panda"), rows=entry("panda").rows * 3, poses={})
    with pytest.raises(ValueError, match="fewer"):
        native.descended(handle(chain_of(long)), one((1, 16)), one(1), one((1, 21)), 1.0, one(21), one(21), 3)


def test_long_slides_and_long_chains_are_steps_of_python(rng, in_python):
    chain = chain_of(entry("stanford"))
    size = chain_size(chain)
    q = rng.uniform(-2.0, 2.0, (8, 6))
    q[::2, 2] = 100.0 * size
    T = robokin.forward_kinematics(entry("stanford"), q)
    start = q + 0.01
    x, _ = descend(chain, T, start, size)
    assert digits([x[::2]]) == digits([in_python(descend, chain, T[::2], start[::2], size)[0]])


def test_several_threads_may_ask_at_once(rng):
    every = np.arange(21)
    for call in calls(rng):
        expected, answers = digits(call(every)), []
        threads = [
            threading.Thread(target=lambda call=call, answers=answers: answers.append(digits(call(every))))
            for _ in range(3)
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert answers == [expected] * 3
