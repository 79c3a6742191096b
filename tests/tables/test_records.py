"""CSV as RFC 4180 says, in pieces of any size, with the numbers of its lines."""

from __future__ import annotations

import csv
import io
import random

import pytest

from robokin.errors import InputError
from robokin.tables.csv_records import RecordReader, separator_of
from robokin.tables.text_source import MAX_ROW


class Pieces:
    """A stream that hands out its bytes in pieces of random sizes, and counts how many it still has."""

    def __init__(self, data: bytes, seed: int = 0, most: int = 40) -> None:
        self.data, self.random, self.most = data, random.Random(seed), most

    def read1(self, count: int) -> bytes:
        size = self.random.randint(1, self.most)
        piece, self.data = self.data[:size], self.data[size:]
        return piece


def read(data: bytes, seed: int = 0, most: int = 40, notes: list[str] | None = None, spaces: bool = False):
    said = [] if notes is None else notes
    return list(RecordReader(Pieces(data, seed, most), "file", said.append, spaces=spaces).records())


CELLS = [
    "1",
    "a b",
    "",
    "x,y",
    'say "hi"',
    "two\nlines",
    "cr\r\nlf",
    "\u2028",
    "\x0c",
    "ü",
    "# no comment",
    ";",
    "\t",
    "0.5",
]


@pytest.mark.parametrize("seed", range(40))
def test_what_is_written_is_read_again(seed):
    drawn = random.Random(seed)
    width = drawn.randint(2, 5)
    # The first cell is neither blank nor the beginning of a comment, for a line of those is passed over.
    rows = [[drawn.choice(["k", "1"]), *drawn.choices(CELLS, k=width - 1)] for _ in range(30)]
    rows[0] = ["k", *(f"c\n{i}" for i in range(1, width))]
    text = io.StringIO()
    separator, ending = drawn.choice(",;\t"), drawn.choice(["\n", "\r\n"])
    csv.writer(text, delimiter=separator, lineterminator=ending).writerows(rows)
    found = read(text.getvalue().encode(), seed)
    assert [record.cells for record in found] == [[cell.strip() for cell in row] for row in rows]
    lines = text.getvalue().encode().splitlines(keepends=True)
    for record, row in zip(found, rows, strict=True):
        one = io.StringIO()
        csv.writer(one, delimiter=separator, lineterminator=ending).writerow(row)
        assert b"".join(lines[record.line - 1 : record.last]) == one.getvalue().encode()


@pytest.mark.parametrize("ending", [b"\n", b"\r\n", b"\r"])
def test_ends_of_lines(ending):
    text = ending.join([b"a,b", b"", b"1,2", b"  # a pause", b" ", b"3,4"])
    for seed in range(5):
        for tail in (b"", ending):
            found = read(text + tail, seed, most=3)
            assert [(record.cells, record.line) for record in found] == [
                (["a", "b"], 1),
                (["1", "2"], 3),
                (["3", "4"], 6),
            ]


def test_a_quote_that_is_not_closed_is_named_where_it_opens():
    with pytest.raises(InputError, match="file, line 3: found a quote that is not closed"):
        read(b'a,b\n1,2\n3,"4\n5,6\n7,8\n')
    with pytest.raises(InputError, match=r"file, line 2: found a cell of more than .*; quotes make one row"):
        read(b'a,b\n3,"4\n' + b"5,6\n" * MAX_ROW, most=100_000)


def test_what_is_too_long_is_refused():
    with pytest.raises(InputError, match="line 2: longer than"):
        read(b"a,b\n" + b"1" * (2 * MAX_ROW), most=100_000)
    with pytest.raises(InputError, match="line 2: found a row of more than"):
        read(b"a,b\n" + b"1" * (2 * MAX_ROW) + b"\n", most=4 * MAX_ROW)
    (_, record) = read(b"a,b\n1," + b"1" * (csv.field_size_limit() + 1) + b"\n", most=100_000)
    assert "found a cell of more than" in record.fault


def test_a_quote_in_the_wrong_place_is_a_fault_of_its_record_alone():
    found = read(b'a,b\n"1"2,3\n4,5\n')
    assert [bool(record.fault) for record in found] == [False, True, False]
    assert found[2].cells == ["4", "5"]


@pytest.mark.parametrize("text", ["a,b\n1,2\n".encode("utf-16"), "a,b\n".encode("utf-16-be"), "ab\n".encode("utf-32")])
def test_utf_16_is_refused(text):
    with pytest.raises(InputError, match=r"expected UTF-8|no text"):
        read(text)
    with pytest.raises(InputError, match="spreadsheet"):
        read(b"PK\x03\x04\x14\x00\x06")


def test_latin_1_is_read_line_by_line_and_said_once():
    notes: list[str] = []
    data = "a,b\nGrün,1\n".encode() + "Größe €,2\nñ,3\n".encode("cp1252")
    found = read(b"\xef\xbb\xbf" + data, notes=notes)
    assert [record.cells[0] for record in found] == ["a", "Grün", "Größe €", "ñ"]
    assert notes == ["file, line 3: not UTF-8, read as Latin-1 (Windows-1252)"]


SEPARATORS = {
    "1,2": ",", "1, 2": ",", "1;2": ";", "1,5;2,5": ";", "1\t2": "\t", "1,5\t2,5": "\t", "1 2": " ", "1,5": ",",
    "atan2(1,2);3": ";", "atan2(1,2)": " ", "(((1,2)": " ", '"a;b",c': ",", '"a,b";c': ";", '"a"': ",", "x ,\ty": ",",
    "a,b,c;d": ",", "a;b;c,d": ";", "sqrt(2),1": ",",
    "a\tb;c\td": "\t", '"a"\t"b,c"': "\t", '"a\nb";"c,d,e"': ";", "q1": " ", ";": ";", "a\tb c": "\t",
}  # fmt: skip


@pytest.mark.parametrize(("line", "separator"), SEPARATORS.items(), ids=SEPARATORS)
def test_the_first_line_tells_what_separates_cells(line, separator):
    assert separator_of(line) == separator


@pytest.mark.parametrize("line", ["a,b;c", "a,b\tc", "a;b\tc", "1,5 2,5", "1,5 2,5 3,5"])
def test_a_line_that_may_be_read_in_two_ways_is_refused(line):
    with pytest.raises(InputError, match="expected one of them"):
        separator_of(line)
