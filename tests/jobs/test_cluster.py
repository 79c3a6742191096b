"""A Dask cluster of processes here: the same results, whatever happens to its workers."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from robokin.errors import InputError, RobokinError
from robokin.jobs import cluster as clusters
from robokin.jobs.cluster import cluster
from robokin.jobs.ordered_map import WorkerError, finished_map, ordered_map


def environment(name):
    return os.environ.get(name)


def square(x):
    time.sleep(0.01)
    return x * x, os.getpid()


def fail_at_five(x):
    if x == 5:
        raise InputError("found five, expected another")
    return x


def end_at_five(x):
    if x == 5:
        os._exit(9)
    return x


def end_once(task):
    """The first who gets the task is lost with it."""
    x, mark = task
    if x == 5 and not Path(mark).exists():
        Path(mark).touch()
        os._exit(9)
    return x


@pytest.fixture(scope="module")
def two():
    with cluster("local:2") as workers:
        assert workers == 2
        yield


def test_results_come_in_order_from_other_processes(two):
    found = [*ordered_map(square, range(30))]
    assert [value for value, _ in found] == [x * x for x in range(30)]
    assert len({process for _, process in found} - {os.getpid()}) == 2
    assert sorted(value for value, _ in finished_map(square, range(30))) == [x * x for x in range(30)]


def test_workers_keep_their_memory_and_have_a_core_each(two):
    """Dask's own setting gives each block's arrays back to the system, half as much time again."""
    if "MALLOC_TRIM_THRESHOLD_" in os.environ:
        pytest.skip("set here for all programs")
    assert [*ordered_map(environment, ["MALLOC_TRIM_THRESHOLD_", "OPENBLAS_NUM_THREADS"])] == [None, "1"]


def test_an_error_comes_back_as_it_is(two):
    with pytest.raises(InputError, match="found five, expected another"):
        [*ordered_map(fail_at_five, range(30))]


def test_a_lost_worker_costs_its_task_and_nothing_else(two, tmp_path):
    tasks = [(x, str(tmp_path / "mark")) for x in range(20)]
    assert [*ordered_map(end_once, tasks)] == [*range(20)]
    assert (tmp_path / "mark").exists()


def test_a_task_that_ends_every_worker_is_given_up(two):
    with pytest.raises(WorkerError, match="several workers came to an end with the same part, expected"):
        [*ordered_map(end_at_five, range(8))]
    assert [*ordered_map(fail_at_five, range(4))] == [*range(4)]


def test_a_worker_of_another_version_is_refused(two, monkeypatch):
    known = clusters.versions()
    monkeypatch.setattr(clusters, "versions", lambda: (("robokin", "9.9"), *known[1:]))
    with cluster("local:1"), pytest.raises(WorkerError, match=r"has robokin 0\.1\.0, expected 9\.9 as here"):
        [*ordered_map(square, range(3))]


def test_tasks_of_a_cluster_without_workers_are_given_up(monkeypatch):
    from distributed import LocalCluster

    monkeypatch.setattr(clusters, "LEFT_ALONE", 1.0)
    monkeypatch.setattr(clusters, "LOOKING", 0.1)
    own = LocalCluster(n_workers=1, threads_per_worker=1, processes=False, dashboard_address="127.0.0.1:0")
    with own, cluster(own.scheduler_address) as workers:
        assert workers == 1
        own.scale(0)
        for mapped in (ordered_map, finished_map):
            with pytest.raises(WorkerError, match="the cluster has had no worker for 1 s, expected at least one"):
                [*mapped(square, range(3))]


def test_the_address_may_be_that_of_a_scheduler_or_its_file(tmp_path):
    from distributed import LocalCluster

    with LocalCluster(n_workers=1, threads_per_worker=2, processes=False, dashboard_address="127.0.0.1:0") as own:
        with cluster(own.scheduler_address) as workers:
            assert workers == 2
            assert [value for value, _ in ordered_map(square, range(9))] == [x * x for x in range(9)]
        file = tmp_path / "scheduler.json"
        file.write_text(json.dumps({"type": "Scheduler", "address": own.scheduler_address}))
        with cluster(f" {file.rename(tmp_path / 'scheduler')} "):
            assert [value for value, _ in ordered_map(square, range(9))] == [x * x for x in range(9)]


@pytest.mark.parametrize(
    "address, said",
    [
        ("", "found no address"),
        ("local:0", r"local:N with N from 1 to 1024"),
        ("local:two", r"local:N with N from 1 to 1024"),
        ("local:99999999999", r"local:N with N from 1 to 1024"),
        ("local:1 2", r"local:N with N from 1 to 1024"),
        ("nonsense", "found the cluster 'nonsense'"),
        ("127.0.0.1", "found the cluster '127.0.0.1', expected local:N, tcp://HOST:PORT"),
        ("tcp://127.0.0.1", "found the cluster 'tcp://127.0.0.1', expected local:N, tcp://HOST:PORT"),
        ("tcp://:8786", "found the cluster 'tcp://:8786'"),
        ("tcp://127.0.0.1:99999", "found the cluster 'tcp://127.0.0.1:99999'"),
        ("http://127.0.0.1:8786", "found the cluster 'http://127.0.0.1:8786'"),
        ("tls://127.0.0.1:1", "expected certificates in Dask's settings"),
        ("tcp://[::1]:1/", r"no scheduler answers at tcp://\[::1\]:1 in"),
        ("tcp://127.0.0.1:1", "no scheduler answers at tcp://127.0.0.1:1"),
        ("nowhere.json", "nowhere.json: no such file"),
    ],
)
def test_what_is_no_address_is_said(address, said, monkeypatch):
    monkeypatch.setattr(clusters, "CONNECTING", 0.3)
    monkeypatch.setitem(clusters.SETTINGS, "distributed.comm.timeouts.connect", "0.3s")
    with pytest.raises(RobokinError, match=said) as error, cluster(address):
        pass
    assert "expected" in str(error.value)


@pytest.mark.parametrize(
    "written, said",
    [(text, "found no address of a scheduler in it") for text in (b"", b"x", b"[]", b'{"id": 1}', b"\xff\x00")]
    + [(b'{"address": "nonsense"}', "found the cluster 'nonsense'"), (None, "Is a directory")],
)
def test_a_file_that_is_no_schedulers_is_said(written, said, tmp_path):
    file = tmp_path / "scheduler.json"
    if written is None:
        file.mkdir()
    else:
        file.write_bytes(written)
    with pytest.raises(RobokinError, match=said) as error, cluster(str(file)):
        pass
    assert "expected" in str(error.value)


def test_without_dask_a_sentence_says_what_to_install():
    code = (
        "import sys\n"
        "sys.modules['distributed'] = None\n"
        "from robokin.cli import run\n"
        "sys.exit(run(['workspace', 'planar2r', '--cluster', 'local:2']))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 2
    assert "expected Dask: pip install 'robokin[cluster]'" in done.stderr
