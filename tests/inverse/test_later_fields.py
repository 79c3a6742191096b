"""A result without solutions says so at once; what comes nearest to its target is searched for when it is asked for."""

from __future__ import annotations

import copy
import pickle
import threading
from dataclasses import fields, replace

import numpy as np
import pytest

import robokin
from robokin.inverse import target_block
from robokin.inverse.later_fields import changed, nearest_unknown
from robokin.inverse.numeric.closest import TOGETHER


@pytest.fixture
def searches(monkeypatch):
    """The targets that searches for the nearest configuration were made for, one number a search."""
    made = []
    search = target_block.nearest_configurations

    def counted(analysis, T, *given):
        made.append(len(T))
        return search(analysis, T, *given)

    monkeypatch.setattr(target_block, "nearest_configurations", counted)
    return made


def beyond(robot, factor):
    """A pose [m] at a factor of a reachable place, of an arm that is stretched there."""
    T = robokin.forward_kinematics(robot, np.clip(np.zeros(robot.n), *robot.limits.T) + 0.01)
    T[:3, 3] *= factor
    return T


CASES = [
    ("puma560", {}), ("ur5e", {}), ("crx10ia", {}), ("planar3r", {}), ("scorbot", {}), ("panda", {}),
    ("iiwa14", {"hold": {2: 0.3}}), ("puma560", {"task": "position"}), ("puma560", {"turns": True}),
    ("puma560", {"near": [0.1] * 6}), ("puma560", {"method": "numeric"}),
]  # fmt: skip


@pytest.mark.parametrize(("name", "options"), CASES, ids=lambda case: str(case))
@pytest.mark.parametrize("many", [False, True])
def test_what_a_result_says_without_a_search(name, options, many, searches):
    robot = robokin.load(name)
    T = beyond(robot, 3.0)
    asked = robokin.solve_ik(robot, np.array([T, T]) if many else T, **options)
    result = asked[1] if many else asked
    searches.clear()
    for part in {part.name for part in fields(result)} - {"nearest"}:
        getattr(result, part)
    assert (len(result), list(result), result.reachable, bool(result)) == (0, [], False, False)
    assert result.reason == "out of reach"
    assert repr(result) == "<no solution: out of reach>"
    if many:
        assert asked.reason(1) == "out of reach"
        assert "0 reached" in repr(asked)
    assert searches == []
    assert nearest_unknown(result)
    assert result.nearest.position_error > 0.0
    assert searches == [1]
    assert not nearest_unknown(result)
    assert result.nearest is result.nearest
    assert searches == [1]


def unreached(robot):
    return robokin.solve_ik(robot, beyond(robot, 3.0))


def told(solution):
    return (
        *solution.q.tolist(),
        solution.branch,
        solution.within_limits,
        solution.position_error,
        solution.angle_error,
    )


@pytest.mark.parametrize(
    "copied",
    [copy.copy, copy.deepcopy, lambda one: pickle.loads(pickle.dumps(one)), replace, changed],
    ids=["copy", "deepcopy", "pickle", "replace", "changed"],
)
@pytest.mark.parametrize("looked", [False, True])
def test_copies_say_the_same(copied, looked):
    robot = robokin.load("puma560")
    result, expected = unreached(robot), unreached(robot)
    if looked:
        assert result.nearest is not None
    again = copied(result)
    assert again.reason == expected.reason
    assert told(again.nearest) == told(expected.nearest)
    assert again.counts == expected.counts
    assert told(result.nearest) == told(expected.nearest)
    assert type(again) is type(expected)


def test_a_pickled_batch_says_the_same():
    robot = robokin.load("puma560")
    batch = robokin.solve_ik(robot, np.array([beyond(robot, factor) for factor in (0.5, 1.9, 3.0)]))
    again = pickle.loads(pickle.dumps(batch))
    for one, other in zip(batch, again, strict=True):
        assert one.reason == other.reason
        assert (one.nearest is None) == (other.nearest is None) == bool(one)
        if not one:
            assert told(one.nearest) == told(other.nearest)


def test_the_document_is_that_of_a_result_that_was_looked_at():
    robot = robokin.load("ur5e")
    looked = unreached(robot)
    assert looked.nearest is not None
    assert unreached(robot).record() == looked.record()
    assert looked.record()["nearest"] is not None


@pytest.mark.parametrize("hold", [None, {2: 0.3}])
def test_the_reason_that_is_known_before_is_the_one_that_the_search_gives(hold, rng):
    robot = robokin.load("iiwa14" if hold else "puma560")
    q = rng.uniform(-np.pi, np.pi, (40, robot.n))
    T = robokin.forward_kinematics(robot, q)
    T[::3, :3, 3] *= 1.4
    reasons = set()
    for target in T:
        first, then = (robokin.solve_ik(robot, target, hold=hold) for _ in range(2))
        if first:
            assert first.nearest is None
            assert first.reason is None
            continue
        assert then.nearest is not None  # asked for before the reason
        assert first.reason == then.reason
        reasons.add(first.reason)
    assert len(reasons) >= 2


def test_threads_get_one_answer():
    robot = robokin.load("puma560")
    result, found = unreached(robot), []
    threads = [threading.Thread(target=lambda: found.append(told(result.nearest))) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [told(result.nearest)] * 8


def test_of_a_batch_only_what_is_looked_at_is_searched_for(searches):
    robot = robokin.load("puma560")
    T = np.tile(beyond(robot, 3.0), (200, 1, 1))
    T[:, 0, 3] += np.linspace(0.0, 1.0, 200)
    batch = robokin.solve_ik(robot, T)
    assert batch[150].nearest is not None
    assert searches == [1]
    assert all(result.nearest is not None for result in batch)
    assert sum(searches) <= 200 + TOGETHER
    assert len(searches) < 20
