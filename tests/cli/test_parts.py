"""Folders of parts: the same bytes on any number of workers, after any interruption, and for nobody else's question."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import psutil
import pyarrow.dataset
import pyarrow.parquet as pq
import pytest

PROGRAM = [sys.executable, "-c", "from robokin.cli import main; main()"]
SAMPLES = ["workspace", "puma560", "--samples", "2e5", "--part-rows", "1e4", "--with", "joints,poses"]
WHOLE = 20
"""Parts of these samples."""

PATIENCE = 120.0


def files_of(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def refused(answer, *words):
    assert answer.status == 2
    assert answer.err.count("\n") == 1, answer.err
    for word in words:
        assert word in answer.err


@pytest.fixture(scope="module")
def reference(tmp_path_factory):
    """The samples in parts, made by one process without interruption."""
    folder = tmp_path_factory.mktemp("reference") / "run"
    subprocess.run([*PROGRAM, *SAMPLES, "-o", f"{folder}/", "--cores", "1"], check=True)
    files = files_of(folder)
    assert len(files) == WHOLE + 2
    return files


@contextlib.contextmanager
def begun(*words, parts=2):
    """A run of its own that has recorded some parts, or more by now."""
    journal = Path(words[words.index("-o") + 1]) / "_done.jsonl"
    process = subprocess.Popen([*PROGRAM, *words], stderr=subprocess.PIPE, start_new_session=True)
    try:
        until = time.monotonic() + PATIENCE
        while not journal.exists() or journal.read_bytes().count(b"\n") < parts:
            assert process.poll() is None, process.stderr.read()
            assert time.monotonic() < until
            time.sleep(0.005)
        yield process
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        process.stderr.close()


def resumed(folder, *more):
    subprocess.run([*PROGRAM, *SAMPLES, "-o", folder, "--resume", *more], check=True, capture_output=True)
    return files_of(Path(folder))


@pytest.mark.parametrize(
    "way",
    [["--cores", "2"], pytest.param(["--cluster", "local:1"], marks=pytest.mark.slow), ["--cluster", "local:3"]],
    ids=str,
)
def test_any_number_of_workers_gives_the_same_bytes(call, tmp_path, reference, way):
    assert call(*SAMPLES, "-o", f"{tmp_path}/run/", *way).status == 0
    assert files_of(tmp_path / "run") == reference


def test_the_parts_are_the_samples_of_one_file(call, tmp_path, reference):
    for name, data in reference.items():
        (tmp_path / "run").mkdir(exist_ok=True)
        (tmp_path / "run" / name).write_bytes(data)
    assert call(*SAMPLES[:4], "--with", "joints,poses", "-o", tmp_path / "all.npy").status == 0
    assert call(*SAMPLES[:4], "--with", "joints,poses", "-o", tmp_path / "all.parquet").status == 0
    whole = np.load(tmp_path / "all.npy")
    parts = pyarrow.dataset.dataset(tmp_path / "run").to_table()
    one = pq.read_table(tmp_path / "all.parquet")
    assert parts.equals(one)
    assert one.column_names == [*(f"q{i}" for i in range(1, 7)), "x", "y", "z", "roll", "pitch", "yaw"]
    assert (np.stack([column.to_numpy() for column in one.columns], axis=1) == whole).all()


def test_the_manifest_says_what_was_asked_and_what_is_there(reference):
    import hashlib

    manifest = json.loads(reference["_manifest.json"])
    assert manifest["complete"] is True
    assert manifest["rows"] == 200_000
    assert manifest["question"]["seed"] == 0
    assert manifest["question"]["part_rows"] == 10_000
    assert [part["file"] for part in manifest["parts"]] == [f"part-{i:08d}.parquet" for i in range(WHOLE)]
    for part in manifest["parts"]:
        assert hashlib.sha256(reference[part["file"]]).hexdigest() == part["sha256"]
        assert len(reference[part["file"]]) == part["bytes"]


@pytest.mark.parametrize(
    "way", [["--cores", "1"], pytest.param(["--cores", "2"], marks=pytest.mark.slow), ["--cluster", "local:2"]], ids=str
)
def test_a_run_that_is_killed_is_gone_on_with(tmp_path, reference, way):
    folder = tmp_path / "run"
    with begun(*SAMPLES, "-o", f"{folder}/", *way) as process:
        children = psutil.Process(process.pid).children(recursive=True)
        process.kill()
        process.wait()
        # Workers do not outlive it for long.
        _, alive = psutil.wait_procs(children, timeout=PATIENCE)
        assert not alive
    left = files_of(folder)
    assert len(left) < len(reference) + 5
    for name, data in left.items():
        if name.startswith("part-"):
            assert data == reference[name]
    assert resumed(str(folder)) == reference


@pytest.mark.parametrize("number", [signal.SIGINT, pytest.param(signal.SIGTERM, marks=pytest.mark.slow)])
@pytest.mark.parametrize("way", [["--cores", "2"], ["--cluster", "local:2"]], ids=str)
def test_a_run_that_is_asked_to_end_keeps_whole_parts(tmp_path, reference, number, way):
    folder = tmp_path / "run"
    with begun(*SAMPLES, "-o", f"{folder}/", *way) as process:
        os.killpg(process.pid, number) if number == signal.SIGINT else process.send_signal(number)
        assert process.wait(PATIENCE) == 128 + number
        assert b"Traceback" not in process.stderr.read()
    left = files_of(folder)
    assert not [name for name in left if name.startswith(".")]
    assert json.loads(left["_manifest.json"])["complete"] is False
    recorded = left["_done.jsonl"].count(b"\n")
    assert recorded >= 1
    assert resumed(str(folder), *way) == reference


def test_a_worker_that_is_killed_changes_no_byte(tmp_path, reference):
    folder = tmp_path / "run"
    with begun(*SAMPLES, "-o", f"{folder}/", "--cluster", "local:2") as process:
        workers = [
            one for one in psutil.Process(process.pid).children(recursive=True)
            if "spawn_main" in " ".join(one.cmdline())
        ]  # fmt: skip
        assert len(workers) >= 2
        workers[0].kill()
        assert process.wait(PATIENCE) == 0
        assert process.stderr.read() == b""
    assert files_of(folder) == reference


def test_two_runs_do_not_write_one_folder(call, tmp_path, reference):
    folder = f"{tmp_path}/run/"
    with begun(*SAMPLES, "-o", folder, "--cores", "1", parts=1) as process:
        process.send_signal(signal.SIGSTOP)
        refused(call(*SAMPLES, "-o", folder, "--resume"), "another run is writing this folder", "expected")
        process.send_signal(signal.SIGCONT)
        assert process.wait(PATIENCE) == 0
    assert files_of(tmp_path / "run") == reference


def restored(folder, reference):
    folder.mkdir()
    for name, data in reference.items():
        (folder / name).write_bytes(data)
    return folder


@pytest.mark.parametrize("way", [[], pytest.param(["--cluster", "local:2"], marks=pytest.mark.slow)], ids=str)
def test_parts_that_are_gone_cut_or_changed_are_made_anew(call, tmp_path, reference, way):
    folder = restored(tmp_path / "run", reference)
    (folder / "part-00000003.parquet").unlink()
    with (folder / "part-00000007.parquet").open("r+b") as stream:
        stream.truncate(1000)
    with (folder / "part-00000011.parquet").open("r+b") as stream:
        stream.seek(5000)
        stream.write(b"?")
    (folder / ".part-00000012.parquet.0123abcd.part").write_bytes(b"half")
    answer = call(*SAMPLES, "-o", folder, "--resume", *way)
    assert "170,000 of 200,000 samples were there before" in answer.err
    assert files_of(folder) == reference


def test_a_manifest_that_was_changed_is_said_and_made_anew(call, tmp_path, reference):
    """A record that is damaged would leave its rows out without a word."""
    folder = restored(tmp_path / "run", reference)
    whole = json.loads(reference["_manifest.json"])

    def changed(change):
        manifest = json.loads(json.dumps(whole))
        change(manifest)
        (folder / "_manifest.json").write_text(json.dumps(manifest))

    for change in (
        lambda found: found["parts"][3].update(rows=7),
        lambda found: found["parts"][3].update(sha256="0"),
        lambda found: found["parts"].pop(),
        lambda found: found["parts"].pop(0),
        lambda found: found["parts"].reverse(),
        lambda found: found["parts"].append(found["parts"][3]),
        lambda found: found["parts"].append(None),
        lambda found: found.pop("parts"),
        lambda found: found.update(rows=1),
    ):
        changed(change)
        refused(call("fk", "puma560", "-i", folder), "_manifest.json: it was changed, expected", "--resume")
    assert call(*SAMPLES, "-o", folder, "--resume").status == 0
    assert files_of(folder) == reference


def test_a_torn_journal_costs_its_last_part(call, tmp_path, reference):
    folder = restored(tmp_path / "run", reference)
    manifest = json.loads(reference["_manifest.json"])
    lines = [json.dumps({k: v for k, v in part.items() if k != "file"}) for part in manifest.pop("parts")]
    manifest["complete"] = False
    (folder / "_manifest.json").write_text(json.dumps(manifest))
    hostile = [
        "",
        "{",
        "[]",
        "1",
        '{"number": -1}',
        '{"number": 5, "rows": true, "bytes": 1, "sha256": "0"}',
        lines[9][:40],
    ]
    (folder / "_done.jsonl").write_text("\n".join([*lines[:9], *hostile]))
    assert "90,000 of" in call(*SAMPLES, "-o", folder, "--resume").err
    assert files_of(folder) == reference


@pytest.mark.parametrize(
    "other, said",
    [
        (["--seed", "3"], "made with seed 0, found 3"),
        (["--sampling", "random"], "made with sampling sobol, found random"),
        (["--length", "m"], "made with length mm, found m"),
    ],
)
def test_a_folder_of_another_question_is_refused(call, tmp_path, reference, other, said):
    folder = restored(tmp_path / "run", reference)
    refused(call(*SAMPLES, "-o", folder, "--resume", *other), said, "expected the same")
    assert files_of(folder) == reference


def test_a_folder_of_other_parts_samples_or_versions_is_refused(call, tmp_path, reference):
    folder = restored(tmp_path / "run", reference)
    words = [*SAMPLES]
    words[words.index("1e4")] = "2e4"
    refused(call(*words, "-o", folder, "--resume"), "made with part_rows 10000, found 20000")
    refused(call("fk", "puma560", "-i", folder, "-o", folder, "--resume"), "made with command workspace, found fk")
    text = (folder / "_manifest.json").read_text()
    (folder / "_manifest.json").write_text(text.replace('"robokin": "', '"robokin": "9'))
    refused(call(*SAMPLES, "-o", folder, "--resume"), "made with versions", "expected the same")
    for nothing in ("", "{}", "[1]", "[" * 99999, '{"question": 1}', '{"question": {}, "parts": 5}'):
        (folder / "_manifest.json").write_text(nothing)
        refused(call(*SAMPLES, "-o", folder, "--resume"), "this is no manifest of parts, expected one as robokin")


def test_what_else_is_there_is_left_alone(call, tmp_path, reference):
    folder = restored(tmp_path / "run", reference)
    refused(call(*SAMPLES, "-o", f"{folder}/"), "found the parts of a run, expected --resume")
    (folder / "thesis.tex").write_text("mine")
    refused(call(*SAMPLES, "-o", f"{folder}/", "--resume"), "found 'thesis.tex'", "expected an empty folder")
    (folder / "thesis.tex").unlink()
    (folder / "_manifest.json").unlink()
    refused(call(*SAMPLES, "-o", f"{folder}/", "--resume"), "found parts without _manifest.json")
    (tmp_path / "file").write_text("mine")
    refused(call(*SAMPLES, "-o", f"{tmp_path}/file/"), "expected a folder that can be written")
    assert (tmp_path / "file").read_text() == "mine"


# Rows of a file --------------------------------------------------------------------------------------------


@pytest.fixture
def rows(tmp_path, rng):
    path = tmp_path / "q.csv"
    lines = [f"{i / 10},{','.join(map(repr, row))}" for i, row in enumerate(rng.uniform(-99, 99, (3000, 6)).tolist())]
    path.write_text("\n".join(["time,q1,q2,q3,q4,q5,q6", *lines]) + "\n")
    return path


@pytest.mark.parametrize("command", ["fk", "ik"])
def test_answers_in_parts_are_those_of_one_file(call, tmp_path, rows, command):
    source = rows
    if command == "ik":
        source = tmp_path / "poses.csv"
        assert call("fk", "puma560", "-i", rows, "-o", source).status == 0
    words = [command, "puma560", "-i", source]
    direct = call(*words, "-f", "parquet", "--cores", "1")
    (tmp_path / "one.parquet").write_bytes(direct.out)
    kept = {}
    for name, way in {"a": ["--cores", "1"], "b": ["--cores", "2"], "c": ["--cluster", "local:2"]}.items():
        answer = call(*words, "-o", f"{tmp_path}/{name}/", "--part-rows", "700", *way)
        assert (answer.status, answer.err) == (direct.status, direct.err)
        kept[name] = files_of(tmp_path / name)
    assert kept["a"] == kept["b"] == kept["c"]
    assert pyarrow.dataset.dataset(tmp_path / "a").to_table().equals(pq.read_table(tmp_path / "one.parquet"))
    shared = call(*words, "-f", "csv", "--cluster", "local:2")
    assert shared.out == call(*words, "-f", "csv").out
    # The folder is read as one table.
    back = call("fk", "puma560", "-i", tmp_path / "a", "-f", "csv")
    assert back.out == call("fk", "puma560", "-i", tmp_path / "one.parquet", "-f", "csv").out


def test_rows_that_are_others_now_are_refused(call, tmp_path, rows):
    words = ["fk", "puma560", "-o", f"{tmp_path}/run/", "--part-rows", "1000"]
    assert call(*words, "-i", rows).status == 0
    before = files_of(tmp_path / "run")
    (tmp_path / "run" / "part-00000001.parquet").unlink()
    lines = rows.read_text().splitlines(keepends=True)
    for changed in (
        [*lines[:50], "7,1,2,3,4,5,6\n", *lines[51:]],
        lines[:-1],
        [lines[0].replace("time", "t"), *lines[1:]],
    ):
        rows.write_text("".join(changed))
        answer = call(*words, "-i", rows, "--resume")
        refused(answer, "was made from other rows than there are now", "expected the same input")
    rows.write_text("".join(lines[:1001]))
    refused(call(*words, "-i", rows, "--resume"), "has more parts than there are rows now")
    rows.write_text("".join(lines))
    (tmp_path / "run" / "part-00000001.parquet").unlink(missing_ok=True)
    again = call(*words, "-i", rows, "--resume")
    assert "2,000 rows were there before" in again.err
    assert files_of(tmp_path / "run") == before


def test_no_rows_are_one_empty_part(call, tmp_path):
    (tmp_path / "q.csv").write_text("q1,q2\n")
    for name, command in (("a", "fk"), ("b", "ik")):
        source = tmp_path / "q.csv" if command == "fk" else tmp_path / "a"
        assert call(command, "planar2r", "-i", source, "-o", f"{tmp_path}/{name}/").status == 0
        assert pq.read_table(tmp_path / name / "part-00000000.parquet").num_rows == 0


def test_a_bad_row_ends_in_its_sentence_and_keeps_what_is_whole(call, tmp_path, rows):
    rows.write_text(rows.read_text() + "1,2\n")
    words = ["fk", "puma560", "-i", rows, "-o", f"{tmp_path}/run/", "--part-rows", "100", "--cores", "1"]
    refused(call(*words), "line 3002: found 2 values, expected 7")
    assert len([*(tmp_path / "run").glob("part-*")]) >= 1
    refused(call("fk", "puma560", "-i", tmp_path / "run"), "a run that is not done, expected --resume to finish it")


@pytest.mark.parametrize(
    "words, said",
    [
        (["fk", "puma560", "--q", "home", "-o", "run/"], "is for the rows of a file, expected --input"),
        (["fk", "puma560", "--q", "home", "--cluster", "local:2"], "is for the rows of a file, expected --input"),
        (["fk", "puma560", "-i", "q.csv", "--resume"], "expected --output FOLDER/"),
        (["fk", "puma560", "-i", "q.csv", "--part-rows", "5", "-o", "p.csv"], "expected --output FOLDER/"),
        (["fk", "puma560", "-i", "q.csv", "-o", "run/", "--part-rows", "0"], "expected a whole number from 1"),
        (["fk", "puma560", "-i", "q.csv", "-o", "run/", "-f", "csv"], "say different things"),
        (["fk", "puma560", "-i", "q.csv", "--cluster", "local:2", "--cores", "2"], "exclude each other"),
        (["fk", "human-hand", "-i", "q.csv", "-o", "run/"], "is a tree, expected --tip"),
        (["ik", "puma560", "--xyz", "1,2,3", "-o", "run/"], "is for the rows of a file, expected --input"),
        (["workspace", "puma560", "--part-rows", "5"], "expected --output"),
        (["workspace", "puma560", "-o", "a.csv", "--part-rows", "5"], "expected --output FOLDER/"),
        (["workspace", "puma560", "-o", "a.parquet", "--resume"], "expected a folder of parts"),
        (["workspace", "puma560", "--cluster", "local:2", "--cores", "2"], "exclude each other"),
        (["workspace", "puma560", "--at", "1,2,3", "--cluster", "local:x"], "--cluster: found the cluster 'local:x'"),
        (["workspace", "puma560", "--at", "1,2,3", "--cluster", ""], "--cluster: found no address"),
        (["check", "fk", "puma560", "--q", "home", "--expect", "1,2,3", "--cluster", "local:2"], "goes with --input"),
    ],
)
def test_options_that_do_not_go_together(call, tmp_path, monkeypatch, words, said):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "q.csv").write_text("q1,q2,q3,q4,q5,q6\n1,2,3,4,5,6\n")
    refused(call(*words), said)
    assert not (tmp_path / "run").exists()


@pytest.mark.skipif(sys.platform == "win32", reason="there a folder stays as long as somebody is in it")
@pytest.mark.parametrize(
    "words",
    [
        ["workspace", "planar2r", "--samples", "1e4", "-o", "run/"],
        ["check", "new", "planar2r", "fk:1", "--seed", "1", "-o", "week"],
    ],
)
def test_where_the_folder_one_is_in_is_gone_the_place_is_named(call, tmp_path, monkeypatch, words):
    (tmp_path / "gone").mkdir()
    monkeypatch.chdir(tmp_path / "gone")
    (tmp_path / "gone").rmdir()
    refused(call(*words), f"{words[-2].replace('-o', '--output')} {words[-1]}: No such file or directory")


def test_a_folder_of_other_parquet_files_is_read_in_the_order_of_its_numbers(call, tmp_path):
    import pyarrow as pa

    folder = tmp_path / "dask"
    folder.mkdir()
    for number in (0, 1, 2, 10):
        pq.write_table(pa.table({"q1": [float(number)], "q2": [0.0]}), folder / f"part.{number}.parquet")
    (folder / "_metadata").write_bytes(b"?")
    assert call("fk", "planar2r", "-i", folder, "-f", "csv").numbers_of("q1") == [0.0, 1.0, 2.0, 10.0]
    refused(call("fk", "planar2r", "-i", tmp_path), "a directory without .parquet files, expected")


@pytest.mark.parametrize("command", ["analyse", "check"])
def test_a_cluster_gives_the_same_answer(call, tmp_path, command):
    words = ["workspace", "planar3r", "--dextrous", "--samples", "2048", "--json"]
    if command == "check":
        lines = [f"{i},{i},{i / 2},{i / 3},1,0" for i in range(150)]
        (tmp_path / "a.csv").write_text("\n".join(["id,q1,q2,x,y,z", *lines]))
        words = ["check", "fk", "planar2r", "-i", str(tmp_path / "a.csv"), "--json"]
    here, there = call(*words), call(*words, "--cluster", "local:2")
    assert (there.status, there.out, there.err) == (here.status, here.out, here.err)


@pytest.mark.parametrize("cores", ["1", "2"])
def test_workers_that_do_not_see_the_folder_hand_their_bytes_back(call, tmp_path, reference, monkeypatch, cores):
    from robokin.tables.part_files import PartPlace

    main, seen = os.getpid(), PartPlace.seen
    monkeypatch.setattr(PartPlace, "seen", lambda place: os.getpid() == main and cores == "2" and seen(place))
    assert call(*SAMPLES, "-o", f"{tmp_path}/run/", "--cores", cores).status == 0
    assert files_of(tmp_path / "run") == reference


def test_a_full_disk_keeps_whole_parts(tmp_path, reference):
    """What a limit on the size of files refuses, a disk without room refuses too."""
    import resource

    folder = tmp_path / "run"
    largest = max(len(data) for name, data in reference.items() if name.startswith("part-"))

    def limited():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (largest - 100, largest - 100))

    words = [*PROGRAM, *SAMPLES, "-o", f"{folder}/", "--cores", "1"]
    done = subprocess.run(words, capture_output=True, text=True, preexec_fn=limited)
    assert done.returncode == 2
    assert "the parts that are whole are kept, --resume goes on" in done.stderr
    assert not [path for path in folder.iterdir() if path.name.startswith(".")]
    assert resumed(str(folder)) == reference


def test_a_folder_of_another_description_is_refused(call, tmp_path):
    """The same name, another arm."""
    import robokin

    robot = tmp_path / "arm.yaml"
    text = (Path(robokin.__file__).parent.parent / "robots" / "arms" / "planar2r.yaml").read_text()
    robot.write_text(text)
    words = ["workspace", robot, "--samples", "1000", "-o", f"{tmp_path}/run/"]
    assert call(*words).status == 0
    robot.write_text(text.replace("a2: 0.6", "a2: 0.7"))
    assert robot.read_text() != text
    refused(call(*words, "--resume"), "was made from another description of arm", "expected the same one")
