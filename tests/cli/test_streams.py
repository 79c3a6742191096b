"""`robokin fk` on files and pipes: what is read, in which forms, a block at a time."""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys

import numpy as np
import pytest
from sweeps import sweep

from .conftest import PROGRAM, environment, poses_of, refused

ROWS = [[10.0, -20.0, 30.0, 40.0, -50.0, 60.0], [1.5, 2.0, 3.0, 4.0, 5.0, 6.0], [0.0, 0.0, 90.0, 0.0, 0.0, 0.0]]
PLAIN = b"10,-20,30,40,-50,60\n1.5,2,3,4,5,6\n0,0,90,0,0,0\n"
NAMES = b"q1,q2,q3,q4,q5,q6\n"


def npy(array, version=(1, 0)):
    stream = io.BytesIO()
    np.lib.format.write_array(stream, np.asarray(array), version=version)
    return stream.getvalue()


@pytest.fixture
def expected(call):
    return call("fk", "puma560", *(part for row in ROWS for part in ("--q", ",".join(map(str, row)))), "-f", "csv").text


# Text ----------------------------------------------------------------------------------------------------

TEXTS = {
    "plain": PLAIN,
    "no final newline": PLAIN.rstrip(),
    "CRLF": PLAIN.replace(b"\n", b"\r\n"),
    "byte order mark": b"\xef\xbb\xbf" + PLAIN,
    "byte order mark and header": b"\xef\xbb\xbf" + NAMES + PLAIN,
    "header": NAMES + PLAIN,
    "header and CRLF": (NAMES + PLAIN).replace(b"\n", b"\r\n"),
    "header with spaces": b" q1 , q2,q3 ,q4,q5,\tq6\n" + PLAIN,
    "quoted header": b'"q1","q2","q3","q4","q5","q6"\n' + PLAIN,
    "joints' names": b"waist,shoulder,elbow,wrist roll,wrist bend,flange\n" + PLAIN,
    "another order": b"q6,q5,q4,q3,q2,q1\n60,-50,40,30,-20,10\n6,5,4,3,2,1.5\n0,0,0,90,0,0\n",
    "own columns": b"x,q1,q2,q3,q4,q5,q6,yaw\n1,10,-20,30,40,-50,60,a\n2,1.5,2,3,4,5,6,\n3,0,0,90,0,0,0,nan\n",
    "own numeric columns": b"x,q1,q2,q3,q4,q5,q6\n1,10,-20,30,40,-50,60\n2,1.5,2,3,4,5,6\n3,0,0,90,0,0,0\n",
    "semicolons": PLAIN.replace(b",", b";"),
    "decimal commas": NAMES.replace(b",", b";") + PLAIN.replace(b",", b";").replace(b".", b","),
    "tabs": (NAMES + PLAIN).replace(b",", b"\t"),
    "tabs and decimal commas": PLAIN.replace(b",", b"\t").replace(b".", b","),
    "CR alone": (NAMES + PLAIN).replace(b"\n", b"\r"),
    "numbered otherwise": b"Joint_1,joint2,JOINT 3,joint-4,joint_5,joint_6\n" + PLAIN,
    "theta": b"theta1,theta2,theta3,theta4,theta5,theta6\n" + PLAIN,
    "joints' names in capitals": b"FLANGE,shoulder,elbow,Wrist_Roll,wrist bend,Waist\n"
    b"60,-20,30,40,-50,10\n6,2,3,4,5,1.5\n0,0,90,0,0,0\n",
    "units": b"q1 [deg],q2[deg],q3 (deg),q4_deg,q5/deg,q6 [degrees]\n" + PLAIN,
    "quoted cells": b'"10","-20","30",40,-50,60\n1.5,2,3,4,5,6\n0,0,"90",0,0,0\n',
    "blank lines": b"\n\n10,-20,30,40,-50,60\n\n1.5,2,3,4,5,6\n   \n0,0,90,0,0,0\n\n",
    "comments": b"# joints\n10,-20,30,40,-50,60\n# a pause\n1.5,2,3,4,5,6\n0,0,90,0,0,0\n",
    "comments before a header": b"# joints\n\n" + NAMES + PLAIN,
    "spaces between": b"10 -20 30 40 -50 60\n1.5 2\t3 4 5   6\n0 0 90 0 0 0\n",
    "spaces around": b" 10, -20 ,30, 40,-50,60 \n1.5, 2,3,4,5,6\n0,0,90,0,0,0\n",
    "expressions": b'5*2,-20,60/2,40,-50,60\n3/2,2,3,4,5,6\n0,0,"atan2(1,0)",0,0,0\n',
    "numbers in other words": b"1e1,-2E+1,+30,40.,-050,60\n1.50,2,3,4,5,6\n.0,0,9e1,0,-0,0\n",
}
JSON_LINES = {
    "lists": b"[10,-20,30,40,-50,60]\n[1.5,2,3,4,5,6]\n[0,0,90,0,0,0]\n",
    "objects": b'{"q":[10,-20,30,40,-50,60]}\n{"pose":1,"q":[1.5,2,3,4,5,6]}\n{"q":[0,0,90,0,0,0]}',
    "mixed": b'\n\n[10,-20,30,40,-50,60]\r\n\n{"q":[1.5,2,3,4,5,6]}\n[0,0,"45*2",0,0,0]\n',
    "a list": b"[\n[10,-20,30,40,-50,60],\n[1.5,2,3,4,5,6],[0,0,\n90,0,0,0]\n]\n",
    "a list on a line": b"[[10,-20,30,40,-50,60],[1.5,2,3,4,5,6],[0,0,90,0,0,0]]",
    "names": b'{"q1":10,"q2":-20,"q3":30,"q4":40,"q5":-50,"q6":60}\n{"q":{"Joint 1":1.5,"joint_2":2,"joint_3":3,'
    b'"joint_4":4,"joint_5":5,"joint_6":6}}\n{"q6":0,"q5":0,"q4":"0","q3":90,"q2":0,"q1":0}\n',
    "byte order mark": b"\xef\xbb\xbf[10,-20,30,40,-50,60]\n[1.5,2,3,4,5,6]\n[0,0,90,0,0,0]\n",
}
ALL_TEXTS = {**TEXTS, **{f"JSON lines: {name}": text for name, text in JSON_LINES.items()}}


@pytest.mark.parametrize("text", sweep(ALL_TEXTS.values(), 3), ids=ALL_TEXTS.keys())
def test_standard_input_in_every_form(call, expected, text):
    for option in ("--q", "--input"):
        answer = call("fk", "puma560", option, "-", "-f", "csv", stdin=text)
        assert (answer.status, answer.err, answer.text) == (0, "", expected)


@pytest.mark.parametrize("name", ["a.csv", "a.CSV", "a.txt", "a"])
def test_a_file_of_csv(call, expected, tmp_path, name):
    path = tmp_path / name
    path.write_bytes(NAMES + PLAIN)
    assert call("fk", "puma560", "--input", path, "-f", "csv").text == expected


@pytest.mark.parametrize("name", ["a.jsonl", "a.txt"])
def test_a_file_of_json_lines(call, expected, tmp_path, name):
    path = tmp_path / name
    path.write_bytes(JSON_LINES["objects"])
    assert call("fk", "puma560", "-i", path, "-f", "csv").text == expected


def test_a_line_may_come_in_pieces(run, expected):
    """A block ends where a read ends, not where a line does."""
    reader, writer = os.pipe()
    with subprocess.Popen(
        [*PROGRAM, "fk", "puma560", "--q", "-", "-f", "csv"], stdin=reader, stdout=subprocess.PIPE, env=environment()
    ) as process:
        os.close(reader)
        for piece in (b"10,-20,3", b"0,40,-50,60", b"\n1.5,2,3,4,5", b",6\n0,0,90,0,0,0"):
            os.write(writer, piece)
        os.close(writer)
        assert process.communicate(timeout=60)[0].decode() == expected


@pytest.mark.parametrize(
    "text",
    [b"", b"\n\n", NAMES, b"# nothing\n", NAMES.rstrip()],
    ids=["empty", "blank", "header", "comment", "header alone"],
)
def test_nothing_in_is_nothing_out(call, tmp_path, text):
    def answer(*more):
        return call("fk", "puma560", "--q", "-", *more, stdin=text)

    assert answer("-f", "csv").text == "q1,q2,q3,q4,q5,q6,x,y,z,roll,pitch,yaw\n"
    assert answer("--json").json == []
    assert answer("-f", "jsonl").out == b""
    assert answer().status == 0
    assert answer("-o", tmp_path / "none.npy").status == 0
    assert np.load(tmp_path / "none.npy").shape == (0, 4, 4)


@pytest.mark.parametrize("form", ["csv", "jsonl"])
def test_the_output_is_legal_input(call, form):
    first = call("fk", "puma560", "--q", "-", "-f", form, stdin=PLAIN)
    again = call("fk", "puma560", "--q", "-", "-f", form, stdin=first.out)
    assert (again.status, again.err, again.out) == (0, "", first.out)


def test_a_document_that_states_its_units_is_read_in_them(call):
    q = "pi/2,pi/4,0.1,pi/6"
    radians = call("fk", "scara", "--q", q, "--angle", "rad", "--length", "m", "-f", "jsonl").out
    (document,) = call("fk", "scara", "--q", "-", "-f", "jsonl", stdin=radians).jsonl
    assert document["units"] == {"length": "mm", "angle": "deg"}
    assert np.allclose(document["q"], [90, 45, 100, 30], rtol=1e-14)


def test_other_units_hold_for_what_is_read(call):
    radians = (",".join(repr(float(value)) for value in np.radians(ROWS[0])) + "\n").encode()
    answer = call("fk", "puma560", "--q", "-", "--angle", "rad", "-f", "csv", stdin=radians)
    assert np.allclose(answer.numbers[0, 6:9], poses_of("puma560", ROWS[0])[:3, 3], atol=1e-10)


@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS.keys())
def test_an_older_typer_without_pydantic_reads_and_writes_the_same(call, expected, monkeypatch, text):
    for module in ("tables.csv_rows", "tables.written_rows"):
        monkeypatch.setattr(f"robokin.{module}.pydantic_function", lambda name: None)
    monkeypatch.setattr("robokin.tables.csv_rows.native", None)
    monkeypatch.setattr("robokin.tables.written_rows._kernel", lambda: None)
    answer = call("fk", "puma560", "--q", "-", "-f", "csv", stdin=text)
    assert answer.err == ""
    assert [[float(cell) for cell in line.split(",")] for line in answer.lines[1:]] == [
        [float(cell) for cell in line.split(",")] for line in expected.splitlines()[1:]
    ]


# Arrays --------------------------------------------------------------------------------------------------

NOTHING = {"blank": b"\n", "spaces": b" \t\r\n", "comments": b"# nothing\n", "both": b"\n#\n  #\n"}


@pytest.mark.parametrize("line", NOTHING)
@pytest.mark.parametrize("begun", [b"", b"1,2\n", b'{"q": [1, 2]}\n', b"[\n"])
def test_a_stream_that_goes_on_without_rows_is_refused(call, begun, line):
    """Such as that of `yes ''`, which has no end."""
    if begun[:1] in (b"{", b"[") and line in ("comments", "both"):
        pytest.skip("JSON has no comments")
    answer = call(
        "fk", "planar2r", "-i", "-", "-f", "csv", stdin=begun + NOTHING[line] * ((5 << 20) // len(NOTHING[line]))
    )
    assert answer.status == 2
    assert "bytes of blank lines and comments, expected rows" in answer.err
    assert "Traceback" not in answer.err
    assert answer.out.count(b"\n") == (2 if begun in (b"1,2\n", b'{"q": [1, 2]}\n') else answer.out.count(b"\n"))


def test_many_blank_lines_between_rows_are_passed_over(call):
    gap = (b" " * 99 + b"\n") * (3 << 13)
    answer = call("fk", "planar2r", "-i", "-", "-f", "csv", stdin=gap + b"10,20\n" + gap + b"30,40\n" + gap)
    assert (answer.status, [row[:2] for row in answer.csv[1:]]) == (0, [["10.0", "20.0"], ["30.0", "40.0"]])


def test_a_quote_that_opens_before_endless_lines_is_refused_in_time(call):
    answer = call("fk", "planar2r", "-i", "-", stdin=b'1,"' + b"\n" * (2 << 20))
    assert answer.status == 2
    assert "line 1" in answer.err


ARRAYS = {
    "float64": np.array(ROWS),
    "float32": np.array(ROWS, dtype=np.float32),
    "float16": np.array(ROWS, dtype=np.float16),
    "big-endian": np.array(ROWS, dtype=">f8"),
    "Fortran order": np.asfortranarray(ROWS),
}


@pytest.mark.parametrize("array", ARRAYS.values(), ids=ARRAYS.keys())
@pytest.mark.parametrize("version", [(1, 0), (2, 0), (3, 0)])
def test_arrays(call, expected, tmp_path, array, version):
    path = tmp_path / "q.npy"
    path.write_bytes(npy(array, version))
    assert call("fk", "puma560", "--input", path, "-f", "csv").text == expected
    assert call("fk", "puma560", "--q", "-", "-f", "csv", stdin=path.read_bytes()).text == expected


def test_arrays_of_integers_and_of_one_row(call):
    row = call("fk", "puma560", "--q", "1,2,3,4,5,6", "-f", "csv").out
    for array in (np.array([[1, 2, 3, 4, 5, 6]]), np.arange(1.0, 7.0), np.arange(1, 7, dtype=np.uint8)):
        assert call("fk", "puma560", "--q", "-", "-f", "csv", stdin=npy(array)).out == row


def test_one_joint_takes_a_list_of_values(call, tmp_path):
    path = tmp_path / "one.yaml"
    path.write_text("robokin: 1\nname: One\njoints: [{type: P}]\n")
    for stdin in (npy(np.arange(3.0)), npy(np.arange(3.0)[:, None]), b"0\n1\n2\n", b"q1\n0\n1\n2\n"):
        assert call("fk", path, "--q", "-", "-f", "csv", stdin=stdin).numbers[:, 3].tolist() == [0, 1, 2]


def test_long_arrays_in_either_order(call, rng, tmp_path):
    q = rng.uniform(-90, 90, (20_001, 6))
    T = poses_of("puma560", q)
    for name, array in (("c", q), ("fortran", np.asfortranarray(q))):
        np.save(tmp_path / f"{name}.npy", array)
        assert call("fk", "puma560", "-i", tmp_path / f"{name}.npy", "-o", tmp_path / "T.npy").status == 0
        assert np.allclose(np.load(tmp_path / "T.npy"), T, rtol=0, atol=1e-9)
    answer = call("fk", "puma560", "--q", "-", "-f", "csv", stdin=npy(np.asfortranarray(q)))
    assert answer.numbers[:, :6].tolist() == q.tolist()


@pytest.mark.parametrize(
    ("data", "fragments"),
    [
        (npy(np.zeros((3, 5))), ["shape (3, 5)", "expected", "(rows, 6)"]),
        (npy(np.zeros((2, 3, 5))), ["shape (2, 3, 5)"]),
        (npy(np.zeros(5)), ["shape (5,)"]),
        (npy(np.array(1.0)), ["shape ()"]),
        (npy(np.zeros((1, 6), dtype=complex)), ["complex128"]),
        (npy(np.zeros((1, 6), dtype=bool)), ["bool"]),
        (npy(np.array([["a"] * 6])), ["type <U1"]),
        (npy(np.zeros(6, dtype=[("a", float)])), ["type [('a', '<f8')]"]),
        (npy(np.array(ROWS))[:-8], ["ends before its 3 rows"]),
        (npy(np.asfortranarray(ROWS))[:-8], ["ends before its 3 rows"]),
        (npy(np.array(ROWS))[:40], ["no .npy file"]),
        (b"\x93NUMPY\x01\x00\x08\x00{'a': (\n", ["no .npy file"]),
        (b"\x93NUMPY\x09\x00\x08\x00{'a': (\n", ["no .npy file"]),
        (npy([[0] * 6, [0, 0, np.nan, 0, 0, 0]]), ["row 2", "not finite"]),
        (npy([[0] * 6, [0] * 6, [0, 0, -np.inf, 0, 0, 0]]), ["row 3", "not finite"]),
    ],
)
def test_arrays_that_are_none(call, tmp_path, data, fragments):
    refused(call("fk", "puma560", "--q", "-", "-f", "jsonl", stdin=data), "standard input", "expected", *fragments)
    path = tmp_path / "bad.npy"
    path.write_bytes(data)
    refused(call("fk", "puma560", "--input", path, "-o", tmp_path / "out.npy"), "bad.npy", *fragments)
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["bad.npy"]


def test_an_array_of_objects_is_not_unpickled(call):
    array = npy_of_objects()
    refused(call("fk", "puma560", "--q", "-", stdin=array), "type object", "expected an array of numbers")


def npy_of_objects():
    stream = io.BytesIO()
    np.save(stream, np.array([[print] * 6], dtype=object), allow_pickle=True)
    return stream.getvalue()


def test_an_array_may_promise_more_than_there_is(call):
    header = io.BytesIO()
    for order in (False, True):
        header = io.BytesIO()
        np.lib.format.write_array_header_1_0(
            header, {"descr": "<f8", "fortran_order": order, "shape": (10**15, 6)}
        )  # fmt: skip
        refused(call("fk", "puma560", "--q", "-", "-f", "csv", stdin=header.getvalue()), "it ends before")


# Arrays out ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("kind", "shape"), [(None, (4, 4)), ("matrix", (4, 4)), ("rpy", (6,)), ("quaternion", (7,))])
def test_arrays_of_poses(call, tmp_path, kind, shape):
    path = tmp_path / "T.npy"
    assert call("fk", "puma560", "--q", "-", "-o", path, *(["--as", kind] if kind else []), stdin=PLAIN).status == 0
    array = np.load(path)
    assert (array.shape, array.dtype) == ((3, *shape), np.float64)
    rows = call("fk", "puma560", "--q", "-", "-f", "csv", "--as", kind or "matrix", stdin=PLAIN).numbers
    assert array.reshape(3, -1).tolist() == rows[:, 9 if shape == (4, 4) else 6 :].tolist()


# A batch is many single ones -----------------------------------------------------------------------------


@pytest.mark.parametrize("name", sweep(["puma560", "scara", "panda", "stanford", "human-arm"], 2))
def test_a_batch_equals_the_single_answers(call, rng, name):
    n = len([row for row in call("show", name, "--json").json["rows"] if row["variable"]])
    q = rng.uniform(-90, 90, (40, n))
    stdin = "".join(",".join(map(repr, row)) + "\n" for row in q.tolist()).encode()
    batch = call("fk", name, "--q", "-", "-f", "jsonl", stdin=stdin).jsonl
    table = call("fk", name, "--q", "-", "-f", "csv", stdin=stdin).numbers
    for values, document, row in zip(q.tolist(), batch, table.tolist(), strict=True):
        single = call("fk", name, "--q", ",".join(map(repr, values)), "--json").json
        assert document["q"] == single["q"] == values == row[:n]
        assert list(document) == list(single)
        assert document["within_limits"] == single["within_limits"]
        assert np.allclose(document["pose"]["matrix"], single["pose"]["matrix"], rtol=1e-13, atol=1e-12)
        assert row[n : n + 3] == document["pose"]["position"]
        assert row[n + 3 :] == document["pose"]["rpy"]


def test_one_line_makes_a_list_of_one(call):
    answer = call("fk", "puma560", "--q", "-", "--json", stdin=b"1,2,3,4,5,6\n")
    assert [document["q"] for document in answer.json] == [[1, 2, 3, 4, 5, 6]]


def test_every_number_comes_back_as_it_went_in(call, rng):
    q = np.concatenate([rng.uniform(-1e3, 1e3, (300, 3)), 10.0 ** rng.uniform(-300, 300, (300, 3))])
    lines = [",".join(map(repr, row)) for row in q.tolist()]
    for extra in ("", '"1","1","1"\n'):  # the fast way and the slow one
        answer = call("fk", "cartesian", "--q", "-", "-f", "csv", stdin=(extra + "\n".join(lines)).encode())
        assert answer.numbers[-600:, :3].tolist() == q.tolist()


@pytest.mark.slow
def test_a_long_batch_crosses_blocks(call, rng):
    q = rng.uniform(-90, 90, (12_345, 6))
    stdin = "".join(",".join(map(repr, row)) + "\n" for row in q.tolist()).encode()
    answer = call("fk", "puma560", "--q", "-", "-f", "csv", stdin=stdin)
    assert answer.numbers[:, :6].tolist() == q.tolist()
    assert np.allclose(answer.numbers[:, 6:9], poses_of("puma560", q)[:, :3, 3], rtol=0, atol=1e-9)
    documents = call("fk", "puma560", "--q", "-", "--json", stdin=stdin).json
    assert [document["q"] for document in documents] == q.tolist()


def test_a_long_table_has_one_heading(call):
    lines = call("fk", "puma560", "--q", "-", stdin=b"1,2,3,4,5,6\n-170,5,6,7,8,9\n" * 10_000).lines
    assert sum("roll" in line for line in lines) == 1
    assert len(lines) == 4 + 20_000
    assert len({len(line) for line in lines[3:]}) == 1
    assert [line.split()[0] for line in lines[4:]] == [str(i) for i in range(1, 20_001)]


def test_what_is_outside_the_limits_is_counted(call, tmp_path):
    stdin = b"0,0,0,0,0,0\n161,0,0,0,0,0\n0,0,0,0,0,0\n-170,0,0,0,0,0\n"
    sentence = "robokin: 2 of 4 configurations are outside the joint limits, the first is number 2\n"
    for more in (["-f", "csv"], ["--json"], ["-f", "jsonl"], [], ["--frames", "-o", tmp_path / "f.npy"]):
        answer = call("fk", "puma560", "--q", "-", *more, stdin=stdin)
        assert (answer.status, answer.err) == (0, sentence)
    flags = [d["within_limits"] for d in call("fk", "puma560", "--q", "-", "--json", stdin=stdin).json]
    assert flags == [True, False, True, False]


# Streaming -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("form", sweep(["csv", "jsonl", "table"], 3))
def test_a_line_is_answered_before_the_next_is_asked(form):
    command = [*PROGRAM, "fk", "puma560", "--q", "-", "-f", form]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=environment()) as process:
        assert process.stdin is not None and process.stdout is not None
        for i in range(3):
            process.stdin.write(b"%d,2,3,4,5,6\n" % i)
            process.stdin.flush()
            for _ in range({"csv": 1, "table": 4}.get(form, 0) if i == 0 else 0):
                process.stdout.readline()
            line = process.stdout.readline()
            q1 = json.loads(line)["q"][0] if form == "jsonl" else float(line.split(b",")[0].split()[0])
            assert q1 == (i + 1 if form == "table" else i)
            assert process.poll() is None
        process.stdin.close()
        assert process.wait(timeout=60) == 0


PEAK = """
import resource, subprocess, sys
status = subprocess.run([sys.executable, "-c", "from robokin.cli import main; main()", *sys.argv[1:]]).returncode
print(status, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="the unit of ru_maxrss is the system's")
@pytest.mark.parametrize(("ending", "order"), [("csv", "C"), ("npy", "C"), ("npy", "F")])
def test_memory_does_not_grow_with_the_input(tmp_path, rng, ending, order):
    count = 300_000
    source, target = tmp_path / f"q.{ending}", tmp_path / f"T.{ending}"
    if ending == "npy":
        np.save(source, np.asarray(rng.uniform(-40, 40, (count, 6)), order=order))
    else:
        block = "".join(",".join(map(repr, row)) + "\n" for row in rng.uniform(-40, 40, (3_000, 6)).tolist())
        source.write_text(block * (count // 3_000))
    done = subprocess.run(
        [sys.executable, "-c", PEAK, "fk", "puma560", "--input", source, "--output", target],
        capture_output=True, check=True, env=environment(),
    )  # fmt: skip
    status, kilobytes = done.stdout.split()
    assert (int(status), done.stderr) == (0, b"")
    assert int(kilobytes) < 150 * 1024
    if ending == "npy":
        assert np.load(target, mmap_mode="r").shape == (count, 4, 4)
    else:
        with target.open("rb") as stream:
            assert sum(1 for _ in stream) == count + 1
