"""What the benchmarks say of their history: a slow day is no news, a slow line is."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parent.parent


@pytest.fixture
def history(monkeypatch):
    """benchmarks.history, without what importing it does to this process."""
    monkeypatch.setattr(sys, "path", [str(ROOT), *sys.path])
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        monkeypatch.setenv(name, "1")
    from benchmarks import history

    return history


@pytest.fixture
def before(rng):
    return {f"line {i}": float(value) for i, value in enumerate(rng.uniform(0.05, 900, 40))}


def slower(figures, rng, day=1.0, noise=0.02):
    return {name: value * day * float(np.exp(rng.normal(0, noise))) for name, value in figures.items()}


def test_a_slow_day_is_no_news(history, before, rng):
    for day in (0.5, 1.0, 1.4, 3.0):
        assert history.worse(before, slower(before, rng, day)) == []


def test_a_line_that_got_slower_is_named_with_its_growth(history, before, rng):
    now = slower(before, rng, 1.3)
    now["line 7"] *= 2.0
    (found,) = history.worse(before, now)
    assert (found.name, found.before, found.now) == ("line 7", before["line 7"], now["line 7"])
    assert abs(found.growth - 2.0) < 0.15


def test_noisy_figures_ask_for_more(history, before, rng):
    now = slower(before, rng, noise=0.3)
    now["line 3"] = before["line 3"] * 1.3
    assert "line 3" not in [one.name for one in history.worse(before, now)]


def test_few_figures_stand_for_themselves(history):
    assert [one.name for one in history.worse({"a": 1.0, "b": 1.0}, {"a": 1.2, "b": 1.3, "c": 9.0})] == ["b"]
    assert history.worse({}, {"a": 1.0}) == []
    assert history.worse({"a": 0.0}, {"a": 1.0}) == []


def test_a_run_is_kept_and_compared_with_the_last_on_its_machine(history, monkeypatch, tmp_path, capsys, before):
    from benchmarks import machine

    monkeypatch.setenv("BENCH_HISTORY", str(tmp_path / "runs"))
    monkeypatch.setattr(machine, "figures", dict(before))
    monkeypatch.setattr(history.time, "strftime", lambda form, t: "2026-01-01T00:00:00Z")
    history.keep()
    assert "the first such run on this machine" in capsys.readouterr().out
    (path,) = (tmp_path / "runs").iterdir()
    run = json.loads(path.read_text())
    assert run["figures"] == before
    other = {**run, "time": "2026-01-01T12:00:00Z", "machine": "another"}
    (tmp_path / "runs" / "2026-01-01T120000Z.json").write_text(json.dumps(other))
    monkeypatch.setattr(machine, "figures", {**before, "line 1": before["line 1"] * 3})
    monkeypatch.setattr(history.time, "strftime", lambda form, t: "2026-01-02T00:00:00Z")
    history.keep()
    said = capsys.readouterr().out
    assert "1 of 40 figures got worse beyond noise since 2026-01-01T00:00:00Z" in said
    assert "line 1 " in said


@pytest.mark.parametrize(
    "text",
    ["", "{", "[]", "3", "null", "{}", '{"time": 3, "figures": {}}', '{"time": "x"}', '{"time": "x", "figures": [1]}',
     '{"time": "x", "figures": {"a": "1"}}', '{"time": "x", "figures": {"a": null}}', "\x00"],
)  # fmt: skip
def test_a_file_that_is_no_run_is_named_and_passed_over(history, monkeypatch, tmp_path, capsys, before, text):
    from benchmarks import machine

    monkeypatch.setenv("BENCH_HISTORY", str(tmp_path))
    monkeypatch.setattr(machine, "figures", dict(before))
    monkeypatch.setattr(history.time, "strftime", lambda form, t: "2026-01-01T00:00:00Z")
    history.keep()
    (tmp_path / "2026-01-01T000001Z.json").write_text(text)
    monkeypatch.setattr(history.time, "strftime", lambda form, t: "2026-01-02T00:00:00Z")
    capsys.readouterr()
    history.keep()
    said = capsys.readouterr().out
    assert "2026-01-01T000001Z.json is no run, and is passed over" in said
    assert "none of 40 figures got worse beyond noise since 2026-01-01T00:00:00Z" in said
    assert (tmp_path / "2026-01-02T000000Z.json").exists()


def test_a_run_that_cannot_be_kept_is_compared_all_the_same(history, monkeypatch, tmp_path, capsys, before):
    from benchmarks import machine

    monkeypatch.setenv("BENCH_HISTORY", str(tmp_path / "file" / "runs"))
    (tmp_path / "file").write_text("")
    monkeypatch.setattr(machine, "figures", dict(before))
    history.keep()
    assert "not kept: " in capsys.readouterr().out


def test_lines_are_kept_under_their_benchmark(history, monkeypatch, capsys):
    from benchmarks import machine

    monkeypatch.setattr(machine, "figures", {})
    machine.begin("forward")
    machine.line("one", "1,234.5", "µs")
    machine.line("two", "–", "not installed")
    machine.line("three", "7", time=False)
    assert machine.figures == {"forward: one": 1234.5}
    assert "one" in capsys.readouterr().out
