"""Ways down to nearest configurations by the native kernel lead where Python's lead, wherever they begin."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from kernel.test_native_descents import digits, everywhere
from library_entries import entry

import robokin
from robokin.inverse.numeric import second_order, turn_in_place
from robokin.inverse.numeric.position_first import DescentEnds, Ways
from robokin.inverse.numeric.second_order import LEAST, go_down, go_down_by_columns
from robokin.inverse.numeric.turn_in_place import HAS_POSITION, turned_by_columns, turned_in_place
from robokin.kernel import native_kernel
from robokin.kernel.chain import chain_of, chain_size
from robokin.kernel.native_kernel import handle
from robokin.spatial import nearest_rotation

native = native_kernel.native
pytestmark = pytest.mark.skipif(native is None, reason="no native kernel in use")

CHAINS = ("puma560", "ur5e", "panda", "stanford", "planar3r", "scara", "human-arm")


def asked(name, rng, count=30):
    """Chain, size, targets (4, 3, s), starts (n, s) and limits (n, 1) twice, of targets that are mostly not reached."""
    robot = entry(name)
    chain = chain_of(robot)
    size = chain_size(chain)
    scale = np.where(chain.revolute, 1.0, size)
    x = everywhere(chain.revolute, rng, count) / scale
    T = robokin.forward_kinematics(robot, everywhere(chain.revolute, rng, count))
    T[:, :3, 3] *= rng.uniform(0.3, 1.8, (len(T), 1))
    T[::2, :3, :3] = nearest_rotation(rng.normal(size=(len(T[::2]), 3, 3)))
    low, high = (robot.limits / scale[:, None]).T[..., None]
    return chain, size, np.ascontiguousarray(T[:, :3].transpose(2, 1, 0)), np.ascontiguousarray(x.T), (low, high)


@pytest.mark.parametrize("weight", [1e-2, 1e-6, 0.0])
@pytest.mark.parametrize("name", CHAINS)
def test_ways_lead_where_python_s_lead(name, weight, rng, instructions):
    chain, size, T, x, limits = asked(name, rng)
    w = np.full(x.shape[1], weight)
    for steps, alike in ((0, 1.0), (1, 0.95), (8, 0.9), (40, 0.5)):
        given = {"steps": steps, "still": 1e-9, "least": LEAST if weight else 1e-9}
        ends, place, turn = go_down(chain, T, x, size, limits, w, **given)
        wished, wished_place, wished_turn = go_down_by_columns(chain, T, x, size, limits, w, **given)
        same = np.max(np.abs(ends - wished), axis=0) <= 1e-7 * (1.0 + np.max(np.abs(wished), axis=0))
        assert np.mean(same) >= alike  # where minima are flat, rounding decides where in them a way ends
        f, expected = place + weight * turn, wished_place + weight * wished_turn
        assert np.mean(np.abs(f - expected) <= 1e-6 * expected + 1e-14) >= 0.95
        assert np.all((ends >= limits[0]) & (ends <= limits[1]))


@pytest.mark.parametrize("name", CHAINS)
def test_what_is_left_is_that_of_the_end(name, rng, instructions):
    chain, size, T, x, limits = asked(name, rng)
    one = np.ones(x.shape[1])
    ends, place, turn = go_down(chain, T, x, size, limits, one, steps=9, still=1e-9)
    here = second_order.slope(chain, T, ends, size, one)
    assert np.allclose(place, here.place, rtol=1e-9, atol=1e-15)
    assert np.allclose(turn, here.turn, rtol=1e-9, atol=1e-15)


def at_their_places(name, rng):
    """Chain, size, starts that have the position of their targets, some of whose joints are at limits."""
    robot = entry(name)
    chain = chain_of(robot)
    size = chain_size(chain)
    scale = np.where(chain.revolute, 1.0, size)
    reach = np.where(chain.revolute, np.pi, size)[:, None] * [-1.0, 1.0]
    low, high = np.where(np.isinf(robot.limits), reach, robot.limits).T
    q = rng.uniform(low, high, (60, chain.n))
    q = np.where(rng.random(q.shape) < 0.2, np.where(rng.random(q.shape) < 0.5, low, high), q)
    T = robokin.forward_kinematics(robot, q)
    T[:, :3, :3] = nearest_rotation(rng.normal(size=(len(T), 3, 3)))
    box = (np.broadcast_to(bound[:, None], (chain.n, len(q))) for bound in (robot.limits / scale[:, None]).T)
    return Ways(chain, size, *box), np.ascontiguousarray(T[:, :3].transpose(2, 1, 0)), (q / scale).T


@pytest.mark.parametrize("name", CHAINS)
def test_tools_turn_in_place_as_in_python(name, rng, instructions, monkeypatch):
    ways, T, x = at_their_places(name, rng)
    begun = DescentEnds(x, np.zeros(x.shape[1]), np.ones(x.shape[1]))
    for steps, alike in ((1, 0.9), (3, 0.75)):
        monkeypatch.setattr(turn_in_place, "STEPS", steps)
        found = turned_in_place(ways, T, begun)
        wished, distance, turn = turned_by_columns(ways, T, x)
        assert np.mean(np.max(np.abs(found.x - wished), axis=0) <= 1e-6) >= alike
        assert np.max(found.distance) <= HAS_POSITION
        assert np.max(distance) <= HAS_POSITION
        left = 2.0 * np.arcsin(np.sqrt(np.minimum(0.5 * turn, 1.0)))
        assert np.mean(np.abs(found.angle - left) <= 1e-6) >= alike
    monkeypatch.undo()
    found = turned_in_place(ways, T, begun)
    before = second_order.slope(ways.chain, T, x, ways.size, np.ones(x.shape[1])).turn
    assert np.all(1.0 - np.cos(found.angle) <= before + 1e-12)
    assert np.all((found.x >= ways.low - 1e-15) & (found.x <= ways.high + 1e-15))


def calls(rng):
    """Calls on some rows (k,) of what there is."""
    chain, size, T, x, (low, high) = asked("panda", rng, 6)
    targets, starts = T.reshape(12, -1).T.copy(), x.T.copy()
    lows, highs = (np.tile(bound.T, (len(starts), 1)) for bound in (low, high))
    weights = 10.0 ** rng.uniform(-8.0, 0.0, len(starts))
    ways, at, q = at_their_places("panda", rng)
    places, values = at.reshape(12, -1).T.copy(), q.T.copy()
    arm = handle(chain)
    return [
        lambda i: native.gone_down(arm, targets[i], starts[i], size, lows[i], highs[i], weights[i], 20, 1e-6, 1e-14),
        lambda i: native.gone_down(arm, targets[i], starts[i], size, low.T, high.T, weights[i], 20, 1e-6, 1e-14),
        lambda i: native.turned(arm, places[i], values[i], ways.size, ways.low.T[i], ways.high.T[i], 9),
    ]


def test_rows_are_alone_and_all_instructions_give_the_same_digits(rng):
    every, before = np.arange(21), native.instructions()
    one_row_of_limits = []
    for call in calls(rng):
        native.instructions("base")
        expected = call(every)
        one_row_of_limits.append(digits(expected))
        for i in (0, 7, 20):
            assert digits(call(every[i : i + 1])) == digits(part[i : i + 1] for part in expected)
        assert digits(call(every[::-1])) == digits(part[::-1] for part in expected)
        assert [len(part) for part in call(every[:0])] == [0] * len(expected)
        native.instructions(before)
        assert digits(call(every)) == digits(expected)
    assert one_row_of_limits[0] == one_row_of_limits[1]


@pytest.mark.parametrize("wrong", [np.nan, np.inf, -np.inf, 1e300, 1e15])
def test_what_is_no_number_ends_and_stays_in_its_row(wrong, rng, instructions):
    chain, size, T, x, limits = asked("puma560", rng, 4)
    ways, places, values = at_their_places("puma560", rng)
    w = np.full(x.shape[1], 1e-3)

    def down(T, x):
        ends, *left = go_down(chain, T, x, size, limits, w, steps=15, still=1e-9)
        return ends.T, *left

    def turned(T, x):
        ends, *left = turned_in_place(ways, T, DescentEnds(x, np.zeros(x.shape[1]), np.ones(x.shape[1])))
        return ends.T, *left

    for call, targets, starts in ((down, T, x), (turned, places, values)):
        expected = call(targets, starts)
        bent, broken = targets.copy(), starts.copy()
        bent[1, 2, 5] = broken[3, 2] = wrong
        with np.errstate(all="ignore"):
            got = call(bent, broken)
        rest = np.delete(np.arange(starts.shape[1]), [2, 5])
        assert digits(part[rest] for part in got) == digits(part[rest] for part in expected)


def test_arrays_that_do_not_fit_are_refused():
    arm, one = handle(chain_of(entry("panda"))), np.ones

    def down(m=3, n=7, width=12, bounds=1, others=1, steps=3, weights=3):
        wide = one((bounds, n)), one((others, n))
        return native.gone_down(arm, one((m, width)), one((3, n)), 1.0, *wide, one(weights), steps, 1e-9, 1e-14)

    def turned(m=3, n=7, bounds=3, steps=3):
        return native.turned(arm, one((m, 12)), one((3, n)), 1.0, one((bounds, n)), one((bounds, n)), steps)

    assert len(down()[0]) == len(turned()[0]) == 3
    for wrong in (
        lambda: down(m=2), lambda: down(n=6), lambda: down(width=16), lambda: down(bounds=2), lambda: down(others=3),
        lambda: down(bounds=2, others=2), lambda: down(steps=-1), lambda: down(weights=1), lambda: turned(m=2),
        lambda: turned(n=6), lambda: turned(bounds=1), lambda: turned(steps=10**9),
    ):  # fmt: skip
        with pytest.raises(ValueError, match=r"fit|steps"):
            wrong()
    for few in (native.gone_down, native.turned):
        with pytest.raises(TypeError):
            few(arm)
    long = replace(entry("panda"), rows=entry("panda").rows * 3, poses={})
    wide, chain = one((1, 21)), handle(chain_of(long))
    with pytest.raises(ValueError, match="fewer"):
        native.gone_down(chain, one((1, 12)), wide, 1.0, wide, wide, one(1), 3, 1e-9, 1e-14)
    with pytest.raises(ValueError, match="fewer"):
        native.turned(chain, one((1, 12)), wide, 1.0, wide, wide, 3)


def test_long_chains_go_down_in_python():
    long = replace(entry("panda"), rows=entry("panda").rows * 3, poses={})
    chain = chain_of(long)
    T = np.ascontiguousarray(robokin.forward_kinematics(long, np.full((2, 21), 0.1))[:, :3].transpose(2, 1, 0))
    x, endless = np.full((21, 2), 0.12), np.full((21, 1), np.inf)
    given = chain, T, x, chain_size(chain), (-endless, endless), np.full(2, 1e-2)
    for one, other in zip(
        go_down(*given, steps=2, still=1e-9), go_down_by_columns(*given, steps=2, still=1e-9), strict=True
    ):
        assert np.array_equal(one, other)
