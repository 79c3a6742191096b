"""Whatever an answer does, it costs itself and no other."""

from __future__ import annotations

import os
import time

import numpy as np
import pytest

from robokin.errors import DescriptionError, InputError
from robokin.jobs.guarded import LINUX, Overrun, guarded


def answer(task):
    """Does what its task says, and hands the task back."""
    if task == "loops":
        while True:
            pass
    if task == "waits":
        time.sleep(60)
    if task == "calculates in a library":
        np.linalg.eigvals(np.random.default_rng(0).normal(size=(3000, 3000)))
    if task == "fills the memory":
        kept = []
        while True:
            kept.append(np.zeros(1 << 22))
    if task == "dies":
        os._exit(3)
    if task == "trips":
        return [][1]
    if task == "writes":
        print("a word")
        os.write(2, b"a word")
    return task


HOSTILE = ["loops", "waits", "calculates in a library", "dies", "trips", *(["fills the memory"] if LINUX else [])]


@pytest.mark.parametrize("hostile", HOSTILE)
def test_an_answer_that_is_too_much_is_given_up_and_the_others_go_on(hostile):
    outcomes = list(guarded(answer, ["a", hostile, "b", hostile], budget=0.2))
    assert [outcomes[0], outcomes[2]] == ["a", "b"]
    assert all(isinstance(outcome, Overrun) for outcome in outcomes[1::2]), outcomes


def test_results_come_in_order_and_nothing_is_said(capfd):
    assert list(guarded(answer, [*range(50), "writes"])) == [*range(50), "writes"]
    assert list(guarded(answer, [])) == []
    assert capfd.readouterr() == ("", "")


def refusing(task):
    if task:
        raise DescriptionError("found this, expected that", "a.yaml", 2, 3)
    return task


def test_an_error_that_is_the_user_s_is_raised_in_its_turn():
    outcomes = guarded(refusing, [0, 1, 0])
    assert next(outcomes) == 0
    with pytest.raises(InputError, match=r"a\.yaml:2:3: found this, expected that"):
        next(outcomes)


def test_nothing_goes_on_when_nobody_waits_for_it():
    from multiprocessing import active_children

    before = set(active_children())
    outcomes = guarded(answer, ["a", "waits"])
    assert next(outcomes) == "a"
    assert set(active_children()) - before
    outcomes.close()
    assert not set(active_children()) - before
