"""Threads that ask about one robot at once get what each would get alone: what is found out is found out safely."""

from __future__ import annotations

import pickle
import sys
import threading

import numpy as np
import pytest

import robokin


@pytest.fixture
def hasty():
    """Threads that take turns as often as can be."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    yield
    sys.setswitchinterval(before)


def looked_at(robot, T, q, hold):
    """The bytes of answers of all kinds."""
    one, batch = robokin.solve_ik(robot, T[0], hold=hold), robokin.solve_ik(robot, T[1:5], hold=hold)
    return [
        robokin.forward_kinematics(robot, q).tobytes(),
        robokin.forward_kinematics(robot, q[0]).tobytes(),
        robokin.jacobian(robot, q, "tool").tobytes(),
        robokin.jacobian(robot, q[0]).tobytes(),
        [(solution.q.tobytes(), str(solution.branch)) for solution in one.solutions],
        (one.complete, one.reason),
        batch.q.tobytes(),
        [solution.q.tobytes() for solution in batch[2].solutions],
    ]


@pytest.mark.parametrize("name", ["puma560", "ur5e", "crx10ia", "panda", "stanford"])
def test_eight_threads_ask_about_one_robot(name, hasty, rng):
    known = robokin.load(name)
    hold = {2: 0.3} if known.n == 7 else None
    q = rng.uniform(*np.clip(known.limits, -2.5, 2.5).T, (50, known.n))
    if hold:
        q[:, 2] = 0.3
    T = robokin.forward_kinematics(known, q)
    expected = looked_at(known, T, q, hold)
    robot = pickle.loads(pickle.dumps(known))  # nothing is known of it yet
    result, found, gate = robokin.solve_ik(robot, T[0], hold=hold), [], threading.Barrier(8)

    def work():
        gate.wait()
        lazy = [(solution.q.tobytes(), str(solution.branch)) for solution in result.solutions]
        found.append((lazy == expected[4], looked_at(robot, T, q, hold) == expected))

    threads = [threading.Thread(target=work) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [(True, True)] * 8
