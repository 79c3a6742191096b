"""Parquet and Arrow files hold the rows of the CSV, and what is no such file is said."""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys
import threading

import numpy as np
import pyarrow as pa
import pyarrow.feather
import pyarrow.ipc
import pyarrow.parquet as pq
import pytest

import robokin
from robokin.cli import run
from robokin.errors import InputError
from robokin.tables.arrow_library import kind_of_start
from robokin.tables.arrow_writer import GROUP, ArrowWriter
from robokin.tables.carried import Carried
from robokin.tables.joint_columns import JointColumns
from robokin.tables.rows import read_rows

ARM = robokin.load("planar2r")
HOSTILE = ['a,"b"\nc', "", " x ", "0.10", "1e5", "NaN", "true", "é€𝕏", "# no comment", "\\udcff", "'", "007"]


def call(*words):
    return run([str(word) for word in words])


def read(path, carried=None):
    said = []
    carried = carried or Carried((), said.append)
    blocks = [*read_rows(str(path), JointColumns(ARM, ARM.units), carried, said.append)]
    return np.concatenate(blocks) if blocks else np.zeros((0, 2)), said


def written(path, columns, metadata=None):
    table = pa.table(columns).replace_schema_metadata(metadata)
    pq.write_table(table, path)
    return path


@pytest.fixture
def joints(tmp_path, rng):
    """A CSV with columns that go through, of every kind of text."""
    path = tmp_path / "q.csv"
    rows = rng.uniform(-170.0, 170.0, (500, 2))
    rows[0], rows[1] = 0.0, (5e-324, -1e-17)
    lines = ["time,label,q1,q2"]
    for i, (a, b) in enumerate(rows.tolist()):
        label = HOSTILE[i % len(HOSTILE)].replace('"', '""')
        lines.append(f'{i / 10:.2f},"{label}",{a!r},{b!r}')
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.mark.parametrize("ending", ["parquet", "arrow", "feather"])
def test_csv_to_parquet_to_csv_are_the_same_bytes(joints, tmp_path, ending):
    direct, there, back = tmp_path / "p.csv", tmp_path / f"p.{ending}", tmp_path / "b.csv"
    assert call("fk", "planar2r", "-i", joints, "-o", direct) == 0
    assert call("fk", "planar2r", "-i", joints, "-o", there) == 0
    assert call("fk", "planar2r", "-i", there, "-o", back) == 0
    assert back.read_bytes() == direct.read_bytes()
    again = tmp_path / f"a.{ending}"
    assert call("fk", "planar2r", "-i", there, "-o", again) == 0
    assert again.read_bytes() == there.read_bytes()


@pytest.mark.parametrize("command", ["ik", "jacobian"])
def test_the_same_of_other_answers(joints, tmp_path, command):
    poses = joints
    if command == "ik":
        poses = tmp_path / "poses.csv"
        assert call("fk", "planar2r", "-i", joints, "-o", poses) == 0
        poses.write_bytes(poses.read_bytes() + b"9,far," + b"0,0,9,9,0,0,0,0\n")
    results = {}
    for ending in ("csv", "parquet"):
        call(command, "planar2r", "-i", poses, "-o", tmp_path / f"s.{ending}")
        assert call("fk", "planar2r", "-i", tmp_path / f"s.{ending}", "-o", tmp_path / "back.csv") == 0
        results[ending] = (tmp_path / "back.csv").read_bytes()
    assert results["csv"] == results["parquet"]
    table = pq.read_table(tmp_path / "s.parquet")
    types = {"target": "int64", "solution": "int64", "rank": "int64", "within_limits": "bool", "branch": "string",
             "reason": "string", "time": "string", "label": "string"}  # fmt: skip
    assert {str(field.type) for field in table.schema if field.name not in types} == {"double"}
    assert all(str(field.type) == types[field.name] for field in table.schema if field.name in types)
    if command == "ik":
        last = table.slice(table.num_rows - 1).to_pylist()[0]
        assert (last["solution"], last["q1"], last["within_limits"]) == (0, None, None)
        assert "reach" in last["reason"] or last["reason"]


def test_a_table_says_its_robot_and_units_and_is_read_in_them(tmp_path):
    there = tmp_path / "p.parquet"
    q = tmp_path / "q.csv"
    q.write_text("q1,q2\n90,45\n")
    assert call("fk", "planar2r", "-i", q, "-o", there, "--length", "in", "--angle", "rad") == 0
    about = json.loads(pq.read_schema(there).metadata[b"robokin"])
    assert about == {"schema": 1, "robot": "planar2r", "id": "planar2r", "units": {"length": "in", "angle": "rad"}}
    values = pq.read_table(there).to_pylist()[0]
    assert values["q1"] == 90.0
    assert values["q1"] * 180.0 / np.pi == pytest.approx(read(there)[0][0, 0], rel=1e-15)


def test_a_columns_own_unit_counts_before_the_files(tmp_path):
    stated = {"robokin": json.dumps({"units": {"length": "m", "angle": "rad"}})}
    path = written(tmp_path / "q.parquet", {"q1 [deg]": [90.0], "q2": [np.pi]}, stated)
    assert read(path)[0] == pytest.approx(np.array([[90.0, 180.0]]))
    path = written(tmp_path / "q.parquet", {"q1": [1.0], "q2": [2.0]}, {"robokin": '{"units": {"angle": "turn"}}'})
    with pytest.raises(InputError, match=r"found the units .*turn.*, expected length"):
        read(path)
    for nothing in ("{", "[]", "\0", "[" * 9999):
        path = written(tmp_path / "q.parquet", {"q1": [1.0], "q2": [2.0]}, {"robokin": nothing})
        assert read(path)[0].tolist() == [[1.0, 2.0]]


@pytest.mark.parametrize("digits", [3, 10, 17, 25, 60])
def test_decimal_numbers_are_the_doubles_that_are_nearest(tmp_path, rng, digits):
    """Arrow's own cast is one digit off at one of five; Python's float() of the text is not."""
    import decimal

    texts = [f"{x:.{digits}f}" for x in rng.uniform(-3.0, 3.0, 200)] + ["0", "-0.001", "1E-2", "2.50"]
    of = pa.decimal128(digits + 2, digits) if digits < 36 else pa.decimal256(digits + 2, digits)
    numbers = pa.array([decimal.Decimal(text) for text in texts], of)
    for column in (numbers, numbers.dictionary_encode()):
        path = written(tmp_path / "q.parquet", {"q1": column, "q2": np.zeros(len(texts))})
        assert read(path)[0][:, 0].tolist() == [float(text) for text in texts]


@pytest.mark.parametrize("kind", ["int8", "int64", "uint64", "float16", "float32", "decimal128(10, 3)", "dictionary"])
def test_numbers_of_every_type_are_numbers(tmp_path, kind):
    import decimal

    values = [decimal.Decimal(v) for v in (1, -2, 3)] if "decimal" in kind else [1, 2, 3]
    if kind == "dictionary":
        column = pa.array(values, "int64").dictionary_encode()
    elif kind == "decimal128(10, 3)":
        column = pa.array(values, pa.decimal128(10, 3))
    else:
        column = pa.array(np.array(values, "float16") if kind == "float16" else values, kind)
    path = written(tmp_path / "q.parquet", {"q2": column, "q1": [0.5, 0.25, 0.125]})
    assert read(path)[0].tolist() == [[a, float(b)] for a, b in zip((0.5, 0.25, 0.125), values, strict=True)]


def test_columns_go_through_with_their_types(tmp_path):
    import datetime

    noon = datetime.datetime(2024, 2, 29, 12, 0, 0, 5)
    columns = {
        "time": pa.array([0.1, None], "float64"), "n": pa.array([2**53 + 1, -1], "int64"),
        "big": pa.array([2**64 - 1, 0], "uint64"), "yes": [True, None], "word": ["a", None],
        "when": pa.array([noon, None], "timestamp[us]"), "kind": pa.array(["x", "y"]).dictionary_encode(),
        "list": [[1], [2]], "raw": [b"1", b"2"], "q1": [1.0, 2.0], "q2": [3.0, 4.0],
    }  # fmt: skip
    path = written(tmp_path / "q.parquet", columns)
    assert call("fk", "planar2r", "-i", path, "-o", tmp_path / "p.parquet") == 0
    rows = pq.read_table(tmp_path / "p.parquet").to_pylist()
    assert [list(row.values())[:7] for row in rows] == [
        [0.1, 2**53 + 1, str(2**64 - 1), True, "a", "2024-02-29 12:00:00.000005", "x"],
        [None, -1, "0", None, "", "", "y"],
    ]
    assert "list" not in rows[0]
    assert "raw" not in rows[0]
    assert call("fk", "planar2r", "-i", path, "-o", tmp_path / "p.csv") == 0
    first, second = (line.split(",")[:7] for line in (tmp_path / "p.csv").read_text().splitlines()[1:])
    assert first == ["0.1", str(2**53 + 1), str(2**64 - 1), "true", "a", "2024-02-29 12:00:00.000005", "x"]
    assert second == ["", "-1", "0", "", "", "", "y"]


@pytest.mark.parametrize("solution", [False, True])
def test_texts_of_polars_go_through(tmp_path, solution):
    """Its files have texts as views, and categories with them, of which Arrow chooses none by a mask or a number."""
    words = pa.array(["a", "more than twelve bytes", None], "string_view")
    kinds = pa.DictionaryArray.from_arrays(pa.array([1, None, 0], "uint32"), pa.array(["x", "y"], "string_view"))
    columns = {"word": words, "kind": kinds, "q1": [1.0, 2.0, 3.0], "q2": [4.0, 5.0, 6.0]}
    if solution:
        columns |= {"target": [1, 2, 3], "solution": [1, 0, 1]}
    path, table = tmp_path / "q.arrow", pa.table(columns)
    with pa.ipc.new_file(path, table.schema) as file:
        file.write_table(table)
    assert call("fk", "planar2r", "-i", path, "-o", tmp_path / "p.csv") == 0
    rows = [line.split(",")[:3] for line in (tmp_path / "p.csv").read_text().splitlines()[1:]]
    told = [["a", "y", "1.0"], ["more than twelve bytes", "", "2.0"], ["", "x", "3.0"]]
    assert rows == (told[::2] if solution else told)


def test_an_empty_table_is_a_table(tmp_path):
    path = written(tmp_path / "q.parquet", {"q1": pa.array([], "float64"), "q2": pa.array([], "float64")})
    for command in ("fk", "ik"):
        source = tmp_path / "none.parquet" if command == "ik" else path
        target = tmp_path / ("none.parquet" if command == "fk" else "no.parquet")
        assert call(command, "planar2r", "-i", source, "-o", target) == 0
        assert pq.read_table(target).num_rows == 0
        assert {"q1", "q2"} <= {*pq.read_table(target).column_names}


@pytest.mark.parametrize(
    "columns, said",
    [
        ({"q1": ["1", "2"], "q2": [1.0, 2.0]}, "values of type string in the column 'q1', expected numbers"),
        ({"q1": [[1.0], [2.0]], "q2": [1.0, 2.0]}, "values of type list.* in the column 'q1', expected numbers"),
        ({"q1": [{"a": 1.0}] * 2, "q2": [1.0, 2.0]}, "values of type struct.* in the column 'q1', expected numbers"),
        ({"q1": [True, False], "q2": [1.0, 2.0]}, "values of type bool in the column 'q1', expected numbers"),
        ({"q1": [1.0, None], "q2": [1.0, 2.0]}, "row 2: found nothing in the column 'q1', expected a number"),
        ({"q1": [1.0, 2.0], "q2": [np.nan, 2.0]}, "row 1: found nan in the column 'q2', expected a finite number"),
        ({"q1": [1.0, np.inf], "q2": [3.0, 2.0]}, "row 2: found inf in the column 'q1', expected a finite number"),
        ({"a": [1.0], "b": [2.0]}, "found the columns a, b, expected q1, q2"),
        ({"q1": [1.0]}, "found the columns q1, expected q1, q2"),
        ({"q1": [1.0], "q2": [1.0], "q3": [1.0]}, "found the column 'q3', expected q1 to q2 alone"),
    ],
)
def test_what_holds_no_joint_values_is_said(tmp_path, columns, said):
    with pytest.raises(InputError, match=said):
        read(written(tmp_path / "q.parquet", columns))


def test_a_name_that_is_there_twice_is_refused(tmp_path):
    pq.write_table(pa.Table.from_arrays([pa.array([1.0])] * 3, names=["q1", "q2", "q1"]), tmp_path / "q.parquet")
    with pytest.raises(InputError, match="'q1' twice"):
        read(tmp_path / "q.parquet")


@pytest.mark.parametrize("ending", ["parquet", "arrow"])
def test_a_damaged_file_ends_in_a_sentence(tmp_path, ending, rng):
    whole = tmp_path / f"whole.{ending}"
    q = tmp_path / "q.csv"
    q.write_text("q1,q2\n" + "".join(f"{i},{-i}\n" for i in range(3000)))
    assert call("fk", "planar2r", "-i", q, "-o", whole) == 0
    data = whole.read_bytes()
    path = tmp_path / f"q.{ending}"
    for cut in [0, 1, 4, 7, 8, 100, len(data) // 2, len(data) - 9, len(data) - 1]:
        path.write_bytes(data[:cut])
        with pytest.raises(InputError, match=r"this is no whole (Parquet|Arrow) file .*, expected"):
            read(path)
    for _ in range(60):
        # One byte is another: the numbers may be others, or it is said; nothing else may happen.
        place = int(rng.integers(len(data)))
        path.write_bytes(data[:place] + bytes([data[place] ^ int(rng.integers(1, 256))]) + data[place + 1 :])
        try:
            read(path)
        except InputError as error:
            assert "expected" in str(error)
    path.write_bytes(b"q1,q2\n1,2\n")
    with pytest.raises(InputError, match="it begins otherwise"):
        read(path)


def test_the_first_bytes_tell_the_format_where_the_name_does_not(tmp_path):
    table = pa.table({"q1": [1.0], "q2": [2.0]})
    pq.write_table(table, tmp_path / "a")
    pyarrow.feather.write_feather(table, str(tmp_path / "b"), compression="zstd")
    with pyarrow.ipc.new_stream(str(tmp_path / "c"), table.schema) as stream:
        stream.write_table(table)
    for name in "abc":
        assert read(tmp_path / name)[0].tolist() == [[1.0, 2.0]]
    assert kind_of_start(b"q1,q2\n1,") is None


@pytest.mark.parametrize("kind", ["parquet", "arrow"])
def test_a_pipe_is_read_and_written(joints, tmp_path, kind):
    program = [sys.executable, "-c", "from robokin.cli import main; main()", "fk", "planar2r", "-i", "-", "-f"]
    out, direct = (
        subprocess.run([*program, each], input=joints.read_bytes(), capture_output=True, check=True).stdout
        for each in (kind, "csv")
    )
    assert subprocess.run([*program, "csv"], input=out, capture_output=True, check=True).stdout == direct


def test_a_named_pipe_may_come_in_pieces(tmp_path):
    pq.write_table(pa.table({"q1": np.arange(50000.0), "q2": np.arange(50000.0)}), tmp_path / "whole.parquet")
    os.mkfifo(tmp_path / "pipe.parquet")

    def feed():
        data = (tmp_path / "whole.parquet").read_bytes()
        with (tmp_path / "pipe.parquet").open("wb", buffering=0) as pipe:
            for start in range(0, len(data), 10007):
                pipe.write(data[start : start + 10007])

    thread = threading.Thread(target=feed)
    thread.start()
    assert read(tmp_path / "pipe.parquet")[0][:, 0].tolist() == [*range(50000)]
    thread.join()


@pytest.mark.parametrize("kind", ["parquet", "arrow"])
def test_groups_of_rows_do_not_hang_on_blocks(kind, rng):
    count = GROUP + 1234
    table = rng.random((2, count))
    files = []
    for step in (997, GROUP, count):
        stream = io.BytesIO()
        writer = ArrowWriter(stream, kind, [("a", "number"), ("b", "number")], {})
        for start in range(0, count, step):
            writer.columns(table[:, start : start + step])
        assert writer.close() == count
        files.append(stream.getvalue())
    assert files[0] == files[1] == files[2]


def test_a_terminal_gets_no_bytes(monkeypatch, capsys):
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True, raising=False)
    assert call("fk", "planar2r", "--q", "0,0", "-f", "parquet") == 2
    assert "standard output is a terminal, expected --output FILE or a pipe" in capsys.readouterr().err


def test_frames_have_no_room(capsys):
    assert call("fk", "planar2r", "--q", "0,0", "--frames", "-f", "parquet") == 2
    assert "no room for frames" in capsys.readouterr().err


def test_without_pyarrow_a_sentence_says_what_to_install(tmp_path):
    (tmp_path / "q.parquet").write_bytes(b"PAR1PAR1")
    code = (
        "import sys\n"
        "sys.modules['pyarrow'] = None\n"
        "from robokin.cli import run\n"
        "sys.exit(run(['fk', 'planar2r', *sys.argv[1:]]))\n"
    )
    for words in (["-i", "q.parquet"], ["--q", "0,0", "-o", "p.parquet"], ["--q", "0,0", "-f", "arrow"]):
        done = subprocess.run([sys.executable, "-c", code, *words], capture_output=True, text=True, cwd=tmp_path)
        assert done.returncode == 2
        assert "pip install 'robokin[parquet]'" in done.stderr
        assert not done.stdout


def test_answers_of_a_class_may_be_parquet(tmp_path, capsysbinary):
    q = tmp_path / "q.csv"
    q.write_text("id,q1,q2\na,10,20\nb,30,40\n")
    outs = []
    for ending in ("csv", "parquet"):
        assert call("fk", "planar2r", "-i", q, "-o", tmp_path / f"answers.{ending}") == 0
        assert call("check", "fk", "planar2r", "-i", tmp_path / f"answers.{ending}", "--json") == 0
        outs.append(capsysbinary.readouterr().out)
    assert outs[0] == outs[1]
    # What is handed in under another name is text, and never read by a library for columns.
    (tmp_path / "answers.parquet").rename(tmp_path / "trick.csv")
    assert call("check", "fk", "planar2r", "-i", tmp_path / "trick.csv") == 2


def test_columns_of_other_programs_with_points_in_their_names(tmp_path):
    path = written(tmp_path / "q.parquet", {"joint.1": [1.0], "joint.2": [2.0], "a.b": [3.0]})
    assert read(path)[0].tolist() == [[1.0, 2.0]]
