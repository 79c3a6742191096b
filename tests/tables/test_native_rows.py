"""A CSV is read alike with the native kernel and without: numbers, lines, what goes through, and what is refused."""

from __future__ import annotations

import random

import numpy as np
import pytest

import robokin
from robokin.errors import InputError
from robokin.kernel.native_kernel import native
from robokin.tables import csv_rows
from robokin.tables.carried import Carried
from robokin.tables.csv_rows import CsvReader
from robokin.tables.joint_columns import JointColumns
from robokin.units import Units

pytestmark = pytest.mark.skipif(native is None, reason="no native kernel in use")

PLAIN = ["1", "-0", "-2.5", "3e-7", "0.125", "-0.0", "1234567.0625", "9007199254740993", "0.1234567890123456789"]
LONG = "1" * 400
ODD = [
    LONG,
    "+1",
    ".5",
    "5.",
    "007",
    "pi/2",
    "1e999",
    "nan",
    "",
    "1,5",
    '"2"',
    "-",
    "1 2",
    "x",
    "1.0.0",
    "٣",
    "90deg",
    "1_0",
]
TEXTS = ["a", "b c", " d ", "", "0", "ä", '"q,;"', "#", "1.5", "-", "\x0b", "\xa0e"]


class Pieces:
    """A stream that hands out its bytes in pieces."""

    def __init__(self, data, at_random):
        self.data, self.random = data, at_random

    def read1(self, count):
        size = self.random.choice([7, 60, 500, 5000])
        piece, self.data = self.data[:size], self.data[size:]
        return piece


def read(data, seed):
    """All that can be told of a file: its rows, their lines, the cells that go through, notes, and the error."""
    robot = robokin.load("planar2r")
    notes, blocks, lines, fault = [], [], [], ""
    carried = Carried((), notes.append)
    reader = CsvReader(Pieces(data, random.Random(seed)), "file", JointColumns(robot, Units()), carried, notes.append)
    try:
        for block in reader.rows():
            blocks += block.tolist()
            lines += list(reader.row_lines)
    except InputError as error:
        fault = str(error)
    cells = [list(row) for row in carried.rows]
    seen = reader.decimal.seen if not fault and reader.decimal.commas else None
    return repr(blocks), lines, cells, notes, fault, seen, reader.unsolved


def file_of(at_random):
    separator = at_random.choice([",", ",", ";", "\t", " "])
    columns = at_random.choice([["q1", "q2"], ["q2", "q1"], ["t", "q1", "q2"], ["q2", "n", "q1", "t"], None,
                                ["target", "solution", "q1", "q2"], ["q1 [rad]", "q2"]])  # fmt: skip
    if columns and separator == " ":
        columns = [name for name in columns if " " not in name]
    odd = at_random.choice([0, 0, 0.003, 0.02])
    comma = separator in ";\t" and at_random.random() < 0.3
    lines = [separator.join(columns)] if columns else []
    for _ in range(at_random.randint(0, 60)):
        cells = []
        for name in columns or ["q1", "q2"]:
            if name[0] == "q":
                cell = at_random.choice(ODD if at_random.random() < odd else PLAIN)
                cell = cell.replace(".", ",") if comma else cell
            else:
                cell = at_random.choice(TEXTS if at_random.random() < odd else ["12", "0.5", "a b", "x"])
            cells.append(at_random.choice(["", "", "", " "]) + cell + at_random.choice(["", "", "", " ", "\t"]))
        lines.append(separator.join(cells))
        if at_random.random() < odd:
            lines.append(at_random.choice(["", " ", "# comment", "1", ",,,", "\t", "1 2 3"]))
    end = at_random.choice(["\n", "\n", "\r\n", "\r"])
    return (end.join(lines) + at_random.choice(["", end, end * 2])).encode()


@pytest.mark.parametrize("seed", range(6))
def test_files_of_all_kinds(seed, monkeypatch):
    at_random = random.Random(seed)
    plain = 0
    for _ in range(250):
        data = file_of(at_random)
        seed = at_random.randint(0, 999)
        ours = read(data, seed)
        with monkeypatch.context() as patch:
            patch.setattr(csv_rows, "native", None)
            assert read(data, seed) == ours, data
        plain += not ours[4]
    assert plain > 60


def test_a_long_file_of_plain_numbers_needs_no_other_reader(monkeypatch, rng):
    q = rng.uniform(-100, 100, (5000, 2))
    data = b"q1,q2\n" + native.text_of_rows(q)
    monkeypatch.setattr(csv_rows, "number_in", None)
    monkeypatch.setattr(csv_rows, "numbers_of", None)
    assert read(data, 1)[0] == repr(q.tolist())
    assert np.array_equal(read(data, 1)[1], range(2, 5002))
