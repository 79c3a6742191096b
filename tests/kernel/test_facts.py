"""What is kept on an object goes with it, and does not travel."""

from __future__ import annotations

import copy
import gc
import pickle
import threading
import weakref
from dataclasses import replace

import robokin
from robokin.inverse.analysis import analysis_of
from robokin.kernel.chain import chain_of, chain_size
from robokin.kernel.facts import NAME, fact, facts_of
from robokin.workspace.extremes import extent
from robokin.workspace.space import space_of


def test_an_answer_is_found_once():
    robot = robokin.load("puma560")
    assert chain_of(robot) is chain_of(robot)
    assert analysis_of(robot) is analysis_of(robot, "pose")
    assert analysis_of(robot, "position") is not analysis_of(robot)


def test_another_robot_has_facts_of_its_own():
    robot = robokin.load("puma560")
    longer = replace(robot, tool=2.0 * robot.tool - robot.base)
    assert chain_of(longer) is not chain_of(robot)
    assert not facts_of(replace(robot))


def test_copies_and_pickles_leave_facts_behind():
    robot = robokin.load("puma560")
    size, space = chain_size(chain_of(robot)), space_of(robot)
    bounds = extent(space)
    for one in (robot, chain_of(robot), space):
        assert facts_of(one)
        for other in (copy.deepcopy(one), pickle.loads(pickle.dumps(one))):
            assert not vars(other).get(NAME)
    assert chain_size(chain_of(copy.deepcopy(robot))) == size
    assert extent(pickle.loads(pickle.dumps(space))).low.tolist() == bounds.low.tolist()


def test_facts_go_with_their_object():
    robot = replace(robokin.load("puma560"), name="mine")
    analysis = weakref.ref(analysis_of(robot))
    assert analysis() is not None
    del robot
    gc.collect()
    assert analysis() is None


def test_facts_do_not_show():
    robot = robokin.load("puma560")
    before = repr(robot), repr(chain_of(replace(robot)))
    analysis_of(robot)
    chain_size(chain_of(robot))
    assert (repr(robot), repr(chain_of(robot))) == before


def test_threads_that_find_a_fact_out_at_once_get_the_same_object():
    """An arm that one thread prepared for the kernel is of the analysis that the robot keeps, and not of a twin."""
    together = threading.Barrier(4, timeout=30)

    @fact
    def found_together(robot):
        together.wait()
        return [robot.n]

    robot, got = replace(robokin.load("puma560")), []
    threads = [threading.Thread(target=lambda: got.append(found_together(robot))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(got) == 4
    assert all(one is found_together(robot) for one in got)
