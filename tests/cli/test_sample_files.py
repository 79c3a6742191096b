"""Files of samples: what they hold, in which units, and that an interruption changes no byte."""

from __future__ import annotations

import errno
import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import pytest
from sweeps import sweep

import robokin
from robokin.cli.statuses import say
from robokin.errors import InputError, OutputError
from robokin.reports import sample_files, sample_rows
from robokin.reports.sample_files import write_samples
from robokin.reports.sample_rows import Samples, sample_format
from robokin.units import Units
from robokin.workspace.sampling import joint_values, positions
from robokin.workspace.space import space_of

KINDS = ("csv", "jsonl", "npy", "ply")
COUNT = 2500


@pytest.fixture(autouse=True)
def small_blocks(monkeypatch):
    for module in (sample_rows, sample_files):
        monkeypatch.setattr(module, "BLOCK", 1000)


@pytest.fixture
def puma():
    return space_of(robokin.load("puma560"))


def samples_of(space, kind="csv", **more):
    return Samples(space, space.robot.units, kind, **{"samples": COUNT, **more})


def expected(samples):
    """q, p and T of all samples, in the units, straight from the package."""
    space, units = samples.space, samples.units
    q = joint_values(space, samples.sampling, samples.seed, 0, samples.count, samples.samples, samples.every)
    factors = np.where(space.robot.revolute, units.radians, units.metres)
    return q.T / factors, positions(space, q).T / units.metres, robokin.forward_kinematics(space.robot, q.T)


def read_ply(path):
    """The names of the properties, and the rows, of a point cloud of doubles."""
    head, _, rest = path.read_bytes().partition(b"end_header\n")
    lines = head.decode().splitlines()
    assert lines[:2] == ["ply", "format binary_little_endian 1.0"]
    names = [line.split()[2] for line in lines if line.startswith("property double ")]
    (count,) = [int(line.split()[2]) for line in lines if line.startswith("element vertex ")]
    return names, np.frombuffer(rest, "<f8").reshape(count, len(names))


def read(path):
    """The names of the columns (None for an array) and the rows of a file."""
    if path.suffix == ".npy":
        return None, np.load(path)
    if path.suffix == ".ply":
        return read_ply(path)
    if path.suffix == ".csv":
        head, *rows = path.read_text().splitlines()
        return head.split(","), np.array([[float(cell) for cell in row.split(",")] for row in rows])
    documents = [json.loads(line) for line in path.read_text().splitlines()]
    return None, np.array([document["position"] for document in documents])


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("sampling", ["sobol", "random", "grid"])
def test_positions_are_written_as_they_are(kind, sampling, puma, tmp_path):
    samples = samples_of(puma, kind, sampling=sampling, seed=3)
    path = tmp_path / f"cloud.{kind}"
    assert write_samples(str(path), samples, cores=1) == 0
    names, rows = read(path)
    assert names in (None, ["x", "y", "z"])
    assert np.array_equal(rows, expected(samples)[1] + 0.0)
    assert len(rows) == samples.count
    assert [entry.name for entry in tmp_path.iterdir()] == [path.name]


@pytest.mark.parametrize("orientation", ["rpy", "quaternion", "euler", "matrix"])
@pytest.mark.parametrize("kind", ["csv", "npy", "ply"])
def test_joints_and_orientations_stand_beside_them(kind, orientation, puma, tmp_path):
    samples = samples_of(puma, kind, joints=True, orientation=orientation, samples=1200)
    path = tmp_path / f"cloud.{kind}"
    write_samples(str(path), samples, cores=1)
    q, p, T = expected(samples)
    names, rows = read(path)
    names = names or samples.columns
    column = {name: rows[:, i] for i, name in enumerate(names)}
    assert np.array_equal(np.stack([column[name] for name in "xyz"], axis=1), p)
    assert np.array_equal(np.stack([column[f"q{i}"] for i in range(1, 7)], axis=1), q)
    if orientation == "matrix":
        R = np.stack([[column[f"m{i}{j}"] for j in (1, 2, 3)] for i in (1, 2, 3)]).transpose(2, 0, 1)
        assert np.allclose(R, T[:, :3, :3], rtol=0, atol=1e-15)
        assert np.array_equal(column["m14"], column["x"])
    assert names[0] == ("x" if kind == "ply" else "q1")


def test_json_lines_are_documents_of_their_own(puma, tmp_path):
    path = tmp_path / "cloud.jsonl"
    samples = samples_of(puma, "jsonl", joints=True, orientation="euler", samples=50)
    write_samples(str(path), samples)
    q, p, T = expected(samples)
    documents = [json.loads(line) for line in path.read_text().splitlines()]
    for i, document in enumerate(documents):
        assert list(document) == ["schema", "robot", "id", "units", "q", "position", "pose"]
        assert document["robot"] == "puma560"
        assert document["units"] == {"length": "mm", "angle": "deg"}
        assert document["q"] == q[i].tolist()
        assert document["position"] == document["pose"]["position"] == p[i].tolist()
        assert list(document["pose"]) == ["matrix", "position", "rpy", "quaternion", "euler"]
        assert np.allclose(np.array(document["pose"]["matrix"])[:3, :3], T[i, :3, :3], rtol=0, atol=1e-15)
    assert len(documents) == 50


def test_what_is_written_can_be_read_by_forward_kinematics(puma, tmp_path, call):
    for kind in ("csv", "jsonl"):
        path = tmp_path / f"cloud.{kind}"
        samples = samples_of(puma, kind, joints=True, samples=40)
        write_samples(str(path), samples)
        answer = call("fk", "puma560", "--input", path, "-f", "csv")
        assert answer.status == 0
        found = answer.numbers[:, [answer.columns.index(name) for name in "xyz"]]
        assert np.allclose(found, expected(samples)[1], rtol=0, atol=1e-9)


def test_units_are_those_asked_for(puma, tmp_path):
    for units in (Units("m", "rad"), Units("in", "deg")):
        path = tmp_path / "cloud.csv"
        samples = replace(samples_of(puma), units=units, joints=True, orientation="rpy")
        write_samples(str(path), samples)
        names, rows = read(path)
        q, p, _ = expected(samples)
        assert np.array_equal(rows[:, :9], np.concatenate([q, p], axis=1))
        assert names == ["q1", "q2", "q3", "q4", "q5", "q6", "x", "y", "z", "roll", "pitch", "yaw"]


@pytest.mark.parametrize("kind", KINDS)
def test_the_positions_do_not_depend_on_what_stands_beside_them(kind, puma, tmp_path):
    found = []
    for i, more in enumerate([{}, {"joints": True}, {"orientation": "rpy"}]):
        path = tmp_path / f"{i}.{kind}"
        samples = samples_of(puma, kind, **more)
        write_samples(str(path), samples)
        _, rows = read(path)
        place = 0 if kind == "jsonl" else samples.columns.index("x")
        found.append(rows[:, place : place + 3])
    assert np.array_equal(found[0], found[1])
    assert np.array_equal(found[0], found[2])


@pytest.mark.parametrize("kind", KINDS)
def test_cores_change_no_byte(kind, puma, tmp_path):
    written = []
    for cores in (1, 2, 3):
        path = tmp_path / f"{cores}.{kind}"
        write_samples(str(path), samples_of(puma, kind, joints=True), cores=cores)
        written.append(path.read_bytes())
    assert written[0] == written[1] == written[2]


def stop_after(blocks, error):
    def progress(done, count):
        nonlocal blocks
        blocks -= 1
        if not blocks:
            raise error

    return progress


@pytest.mark.parametrize("error", [KeyboardInterrupt(), SystemExit(143)])
@pytest.mark.parametrize("cores", [1, 2])
@pytest.mark.parametrize("kind", KINDS)
def test_what_is_interrupted_is_resumed_to_the_same_bytes(kind, cores, error, puma, tmp_path, capsys):
    samples = samples_of(puma, kind, joints=True)
    write_samples(str(tmp_path / f"whole.{kind}"), samples, cores=1)
    path = tmp_path / f"cloud.{kind}"
    with pytest.raises(type(error)):
        write_samples(str(path), samples, cores=cores, progress=stop_after(2, error), say=say)
    assert not path.exists()
    said = capsys.readouterr().err
    assert "2,000 of 2,500 samples are kept in cloud." in said
    assert "--resume goes on from there" in said
    told = []
    assert write_samples(str(path), samples, 1, resume=True, progress=lambda *done: told.append(done)) == 2000
    assert told == [(2500, 2500)]
    assert path.read_bytes() == (tmp_path / f"whole.{kind}").read_bytes()
    assert sorted(entry.name for entry in tmp_path.iterdir()) == [path.name, f"whole.{kind}"]


def test_without_resume_the_work_begins_anew(puma, tmp_path):
    path = tmp_path / "cloud.csv"
    with pytest.raises(KeyboardInterrupt):
        write_samples(str(path), samples_of(puma), progress=stop_after(1, KeyboardInterrupt()))
    assert write_samples(str(path), samples_of(puma, seed=9)) == 0
    assert np.array_equal(read(path)[1], expected(samples_of(puma, seed=9))[1])


def test_resume_with_nothing_to_resume_begins(puma, tmp_path):
    path = tmp_path / "cloud.npy"
    assert write_samples(str(path), samples_of(puma, "npy"), resume=True) == 0
    assert np.load(path).shape == (COUNT, 3)


def test_an_interruption_before_the_first_block_leaves_nothing(puma, tmp_path, monkeypatch, capsys):
    def interrupted(self, number):
        raise KeyboardInterrupt

    monkeypatch.setattr(Samples, "block", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_samples(str(tmp_path / "cloud.csv"), samples_of(puma), cores=1, say=say)
    assert "nothing was written" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("change", "fragment"),
    [
        ({"seed": 2}, "was made with seed 0, found 2"),
        ({"samples": 9000}, "was made with samples 2500, found 9000"),
        ({"sampling": "random"}, "was made with sampling sobol, found random"),
        ({"joints": True}, "was made with joints False, found True"),
        ({"orientation": "rpy"}, "was made with orientation None, found rpy"),
        ({"units": Units("m", "rad")}, "was made with length mm, found m"),
        ({"space": space_of(robokin.load("scara"))}, "was made with robot puma560, found scara"),
        ({"space": space_of(replace(robokin.load("puma560"), tool=np.diag([1.0, -1, -1, 1])))}, "another description"),
    ],
)
def test_only_the_same_work_is_resumed(change, fragment, puma, tmp_path):
    path = tmp_path / "cloud.csv"
    with pytest.raises(KeyboardInterrupt):
        write_samples(str(path), samples_of(puma), progress=stop_after(1, KeyboardInterrupt()))
    before = (tmp_path / "cloud.csv.part").read_bytes()
    with pytest.raises(InputError) as refusal:
        write_samples(str(path), replace(samples_of(puma), **change), resume=True)
    assert fragment in str(refusal.value)
    assert (tmp_path / "cloud.csv.part").read_bytes() == before
    assert write_samples(str(path), samples_of(puma), resume=True) == 1000


def test_a_part_that_has_no_sample_yet_is_begun(puma, tmp_path, monkeypatch):
    # Killed while the header was written.
    with monkeypatch.context() as patched:
        patched.setattr(sample_files._Part, "_keep", lambda self, count: "")
        fill_up(patched, 3)
        with pytest.raises(OutputError):
            write_samples(str(tmp_path / "cloud.csv"), samples_of(puma))
    assert (tmp_path / "cloud.csv.part").read_bytes() == b"x,y"
    assert write_samples(str(tmp_path / "cloud.csv"), samples_of(puma), resume=True) == 0


STRANGE = [
    None,
    "",
    "[]",
    '{"done": 1}',
    '{"settings": {}, "done": -1, "size": 5}',
    "[" * 100_000,
    "{" * 70_000,
    " " * (1 << 17),
]


@pytest.mark.parametrize("state", STRANGE, ids=range(len(STRANGE)))
def test_a_strange_part_is_not_gone_on_with(state, puma, tmp_path):
    (tmp_path / "cloud.csv.part").write_text("something else")
    if state is not None:
        (tmp_path / "cloud.csv.part.json").write_text(state)
    with pytest.raises(InputError, match=r"cloud\.csv\.part is not the beginning of this file|was made with"):
        write_samples(str(tmp_path / "cloud.csv"), samples_of(puma), resume=True)
    assert (tmp_path / "cloud.csv.part").read_text() == "something else"


def test_a_part_that_lost_its_end_is_not_gone_on_with(puma, tmp_path):
    path, part = tmp_path / "cloud.npy", tmp_path / "cloud.npy.part"
    with pytest.raises(KeyboardInterrupt):
        write_samples(str(path), samples_of(puma, "npy"), progress=stop_after(2, KeyboardInterrupt()))
    part.write_bytes(part.read_bytes()[:-8])
    with pytest.raises(InputError, match="not the beginning"):
        write_samples(str(path), samples_of(puma, "npy"), resume=True)


def left(space, folder, kind="csv", **more):
    """What an interrupted run of 2,000 of 2,500 samples leaves: the part, and what its side file says."""
    with pytest.raises(KeyboardInterrupt):
        write_samples(str(folder / f"cloud.{kind}"), samples_of(space, kind, **more),
                      progress=stop_after(2, KeyboardInterrupt()))  # fmt: skip
    part, side = folder / f"cloud.{kind}.part", folder / f"cloud.{kind}.part.json"
    return part, side, json.loads(side.read_text())


@pytest.mark.parametrize("kind", sweep(KINDS, 4))
@pytest.mark.parametrize("place", [0, 5, -1])
def test_a_part_with_another_byte_is_not_gone_on_with(kind, place, puma, tmp_path):
    part, _, _ = left(puma, tmp_path, kind)
    data = bytearray(part.read_bytes())
    data[place] ^= 1
    part.write_bytes(data)
    with pytest.raises(InputError, match=r"not the beginning of this file, .* without --resume it is written anew"):
        write_samples(str(tmp_path / f"cloud.{kind}"), samples_of(puma, kind), resume=True)
    assert part.read_bytes() == data, "nothing is lost"
    assert write_samples(str(tmp_path / f"cloud.{kind}"), samples_of(puma, kind)) == 0


@pytest.mark.parametrize("kind", sweep(KINDS, 4))
@pytest.mark.parametrize(
    "change",
    [{"done": 10**18}, {"done": 10**400}, {"done": 1000}, {"done": 2500}, {"done": 1999}, {"done": True}, {"done": 2e3},
     {"size": 10**18}, {"size": 3}, {"size": None}, {"sum": 0}, {"sum": "x"}, {"sum": None}, {"done": 0, "size": 9**9}],
    ids=str,
)  # fmt: skip
def test_a_side_file_that_says_something_else_is_not_believed(kind, change, puma, tmp_path):
    part, side, state = left(puma, tmp_path, kind)
    before = part.read_bytes()
    side.write_text(json.dumps(state | change))
    with pytest.raises(InputError, match="not the beginning"):
        write_samples(str(tmp_path / f"cloud.{kind}"), samples_of(puma, kind), resume=True)
    assert part.read_bytes() == before


def test_what_stands_behind_the_whole_blocks_is_cut_off(puma, tmp_path):
    write_samples(str(tmp_path / "whole.csv"), samples_of(puma))
    part, _, _ = left(puma, tmp_path)
    part.write_bytes(part.read_bytes() + b"1,2")
    assert write_samples(str(tmp_path / "cloud.csv"), samples_of(puma), resume=True) == 2000
    assert (tmp_path / "cloud.csv").read_bytes() == (tmp_path / "whole.csv").read_bytes()


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes with a name")
def test_a_part_that_is_no_file_is_left_alone(puma, tmp_path):
    precious = tmp_path / "precious"
    precious.write_text("kept")
    part = tmp_path / "cloud.csv.part"
    part.symlink_to(precious)
    with pytest.raises(OutputError, match=r"cloud\.csv\.part is a link"):
        write_samples(str(tmp_path / "cloud.csv"), samples_of(puma))
    assert precious.read_text() == "kept"
    part.unlink()
    os.mkfifo(part)
    with pytest.raises(OutputError, match=r"cloud\.csv\.part is no file"):
        write_samples(str(tmp_path / "cloud.csv"), samples_of(puma))
    part.unlink()
    part.write_text("x")
    os.mkfifo(tmp_path / "cloud.csv.part.json")
    with pytest.raises(InputError, match="not the beginning"):
        write_samples(str(tmp_path / "cloud.csv"), samples_of(puma), resume=True)


def fill_up(monkeypatch, room):
    """Let the disk have room for so many bytes more."""
    write = os.write

    def limited(number, data):
        nonlocal room
        if len(data) > room:
            if not room:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            data = data[:room]
        written = write(number, data)
        room -= written
        return written

    monkeypatch.setattr(sample_files.os, "write", limited)


@pytest.mark.parametrize("kind", KINDS)
def test_a_full_disk_keeps_the_whole_blocks(kind, puma, tmp_path, monkeypatch):
    samples, path = samples_of(puma, kind), tmp_path / f"cloud.{kind}"
    write_samples(str(tmp_path / f"whole.{kind}"), samples)
    whole = (tmp_path / f"whole.{kind}").read_bytes()
    with monkeypatch.context() as patched:
        fill_up(patched, len(whole) // 2)
        with pytest.raises(OutputError, match=r"No space left on device, 1,000 of 2,500 samples are kept in cloud"):
            write_samples(str(path), samples)
    assert len((tmp_path / f"cloud.{kind}.part").read_bytes()) < len(whole) // 2
    assert write_samples(str(path), samples, resume=True) == 1000
    assert path.read_bytes() == whole


def test_a_disk_that_is_full_at_once_is_left_as_it_was(puma, tmp_path, monkeypatch):
    (tmp_path / "cloud.csv").write_text("old")
    fill_up(monkeypatch, 100)
    with pytest.raises(OutputError, match="No space left on device, nothing was written"):
        write_samples(str(tmp_path / "cloud.csv"), samples_of(puma))
    assert [entry.name for entry in tmp_path.iterdir()] == ["cloud.csv"]
    assert (tmp_path / "cloud.csv").read_text() == "old"


def test_places_that_cannot_be_written_are_refused(puma, tmp_path):
    (tmp_path / "folder.csv").mkdir()
    for place, reason in [("folder.csv", "found a directory"), ("nowhere/cloud.csv", "No such file or directory")]:
        with pytest.raises(OutputError, match=reason):
            write_samples(str(tmp_path / place), samples_of(puma))


@pytest.mark.parametrize("length", [243, 247, 250, 255, 300])
def test_a_name_that_has_no_room_for_the_unfinished_file_leaves_nothing(length, puma, tmp_path):
    with pytest.raises(OutputError, match="File name too long"):
        write_samples(str(tmp_path / f"{'x' * (length - 4)}.csv"), samples_of(puma))
    assert not list(tmp_path.iterdir())


def test_a_file_of_no_samples_is_refused(puma, tmp_path):
    with pytest.raises(InputError, match="found 0 samples, expected at least 1"):
        write_samples(str(tmp_path / "cloud.csv"), samples_of(puma, samples=0))
    assert not list(tmp_path.iterdir())


def test_a_link_stays_a_link(puma, tmp_path):
    (tmp_path / "link.csv").symlink_to(tmp_path / "cloud.csv")
    write_samples(str(tmp_path / "link.csv"), samples_of(puma))
    assert (tmp_path / "link.csv").is_symlink()
    assert len((tmp_path / "cloud.csv").read_text().splitlines()) == COUNT + 1


def test_two_runs_do_not_write_the_same_file(puma, tmp_path):
    path = str(tmp_path / "cloud.csv")

    def again(done, count):
        with pytest.raises(OutputError, match=r"another run is writing cloud\.csv\.part"):
            write_samples(path, samples_of(puma))

    write_samples(path, samples_of(puma), cores=1, progress=again)
    assert len((tmp_path / "cloud.csv").read_text().splitlines()) == COUNT + 1


@pytest.mark.parametrize("name", ["cloud", "cloud.txt", "cloud.json", "csv"])
def test_an_unknown_ending_is_refused(name):
    with pytest.raises(InputError, match=r"expected a name that ends with \.csv, \.jsonl, \.npy, \.ply, \.parquet"):
        sample_format(name)
    assert sample_format("a/b.PLY") == "ply"


LONG = """
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs are started without
import robokin
from robokin.cli.statuses import say
from robokin.reports.sample_files import write_samples
from robokin.reports.sample_rows import Samples
from robokin.workspace.space import space_of

space = space_of(robokin.load("planar3r"))
try:
    samples = Samples(space, space.robot.units, "csv", samples=200_000)
    write_samples(sys.argv[1], samples, cores=2, resume="resume" in sys.argv, say=say)
except KeyboardInterrupt:
    sys.exit(130)
"""


@pytest.mark.skipif(os.name == "nt", reason="there are no such signals")
@pytest.mark.parametrize("number", sweep([signal.SIGINT, signal.SIGKILL], 2))
def test_a_run_that_is_hit_by_a_signal_is_resumed(number, tmp_path):
    path, part = tmp_path / "cloud.csv", tmp_path / "cloud.csv.part"
    command = [sys.executable, "-c", LONG, str(path)]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, start_new_session=True)
    while process.poll() is None and (not part.exists() or part.stat().st_size < 1_000_000):
        time.sleep(0.005)
    if number == signal.SIGKILL:
        process.kill()
    else:
        os.killpg(process.pid, number)
    _, said = process.communicate(timeout=30)
    if process.returncode == 0:
        pytest.skip("the work was done before the signal came")
    assert b"Traceback" not in said
    if number == signal.SIGINT:
        assert process.returncode == 130
        assert b"samples are kept in cloud.csv.part" in said
    # The lock of a killed run goes with its last process.
    deadline = time.monotonic() + 20
    while (done := subprocess.run([*command, "resume"], capture_output=True, check=False)).returncode:
        assert b"another run" in done.stderr, done
        assert time.monotonic() < deadline
        time.sleep(0.2)
    subprocess.run([*command[:3], str(tmp_path / "whole.csv")], check=True)
    assert path.read_bytes() == (tmp_path / "whole.csv").read_bytes()
