"""A few hundred hostile calls, the same in every run; `make fuzz` makes tens of thousands."""

from __future__ import annotations

import os

import fuzz
import pytest
from fuzz_calls import Call
from fuzz_run import Outcome, faults

CALLS = 300


@pytest.fixture
def few_threads(monkeypatch):
    monkeypatch.setitem(os.environ, "OPENBLAS_NUM_THREADS", "1")


def test_hostile_calls_end_in_an_answer_or_a_sentence(few_threads):
    answered, found = set(), {}
    for call, outcome in fuzz.calls("sample", 120.0, most=CALLS):
        answered.add((call.arguments[0], outcome.status))
        found |= dict.fromkeys(faults(call, outcome), (call.arguments, outcome.err or outcome.crash))
    assert not found
    assert {status for _, status in answered} >= {0, 2}
    assert len({command for command, _ in answered}) > 8


FINE = Outcome(0, b'{"a": 1}\n', "", 0.1)


@pytest.mark.parametrize(
    ("outcome", "fault"),
    [
        (Outcome(1, b"", "", 0.1), "status 1: fk"),
        (Outcome(None, b"", "", 0.1, "Traceback …", "KeyError at units.py:read"), "KeyError at units.py:read"),
        (Outcome(0, b"", "", 99.0), "slow: fk"),
        (Outcome(0, b"", "x.py:3: RuntimeWarning: overflow\n", 0.1), "warning: RuntimeWarning: overflow"),
        (Outcome(2, b"", "", 0.1), "status 2 without a sentence: fk"),
        (Outcome(2, b"", "robokin: \x1b[2J, expected none\n", 0.1), "steering characters: fk"),
        (Outcome(0, b'{"a": NaN}', "", 0.1), "no JSON: fk"),
        (Outcome(0, b"{}", "", 0.1, left=("q.csv.part",)), "left behind: fk"),
    ],
)
def test_what_is_wrong_with_an_outcome_has_a_name(outcome, fault):
    call = Call(("fk", "puma560", "--json"))
    assert list(faults(call, FINE)) == []
    assert list(faults(call, outcome)) == [fault]


def test_a_call_that_kills_its_process_or_never_ends_is_a_finding(monkeypatch):
    import fuzz_run

    monkeypatch.setattr(fuzz_run, "HARD", 0.5)
    monkeypatch.setattr(
        fuzz_run,
        "in_this_process",
        lambda call: os._exit(9) if "die" in call.arguments else __import__("signal").pause(),
    )
    for word, fault in (("die", "killed: fk die"), ("wait", "hang: fk wait")):
        worker = fuzz_run.Worker()
        call = Call(("fk", word))
        worker.ask(call)
        while (outcome := worker.answer()) is None:
            pass
        worker.end()
        assert list(faults(call, outcome)) == [fault.replace(f" {word}", "")]
