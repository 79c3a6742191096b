"""Numbers as text and from text by the native kernel: what repr and float give, to the last bit."""

from __future__ import annotations

import math
import random
import threading
from decimal import Context, Decimal

import numpy as np
import pytest

from robokin.kernel import native_kernel
from robokin.tables import written_rows

native = native_kernel.native
pytestmark = pytest.mark.skipif(native is None, reason="no native kernel in use")

NUMBERS = b"\1"


def read(texts):
    """The numbers of lines of one cell, or None."""
    found = native.rows_in("\n".join(texts).encode(), b",", NUMBERS)
    return None if found is None else found[0][:, 0]


def expect_as_float(texts):
    found = read(texts)
    assert found is not None
    expected = np.array([float(text) for text in texts])
    wrong = np.flatnonzero(found.view(np.int64) != expected.view(np.int64))
    assert not len(wrong), [texts[i] for i in wrong[:5]]


def as_python_writes(x):
    return ",".join(map(written_rows._number, x.tolist())).encode() + b"\n"


def expect_there_and_back(x):
    x = np.ascontiguousarray(x[np.isfinite(x)])
    text = native.text_of_rows(x[None])
    assert text == as_python_writes(x)
    back = native.rows_in(text, b",", NUMBERS * len(x))[0]
    assert back.tobytes() == x.tobytes()


def neighbours(x, count):
    """Numbers, and those that are next to them."""
    bits = np.abs(x).view(np.int64)[:, None] + np.arange(-count, count + 1)
    return bits[(bits >= 0) & (bits < 0x7FF << 52)].view(np.float64)


def test_any_bits(rng):
    expect_there_and_back(rng.integers(0, 2**64, 200_000, dtype=np.uint64).view(np.float64))


def test_subnormal_numbers(rng):
    expect_there_and_back(rng.integers(1, 2**52, 20_000).view(np.float64))
    expect_there_and_back(np.arange(1, 3000).view(np.float64))


def test_all_powers_of_two_and_of_ten_and_their_neighbours():
    expect_there_and_back(neighbours(np.ldexp(1.0, np.arange(-1074, 1024)), 3))
    tens = np.array([float(f"{d}e{k}") for k in range(-323, 309) for d in (1, 2, 5, 9.999999999999999) if d * k < 308])
    expect_there_and_back(neighbours(tens, 6))


def test_whole_numbers_fractions_and_what_robots_have(rng):
    for x in (
        np.arange(-3000.0, 3000.0),
        np.arange(-30000, 30000) / 1000,
        rng.integers(-(2**53), 2**53, 20_000).astype(np.float64),
        rng.uniform(-180, 180, 50_000),
        np.round(rng.uniform(-999, 999, 50_000), 3),
        rng.uniform(-1, 1, 50_000) * 10.0 ** rng.integers(-20, 20, 50_000),
    ):
        expect_there_and_back(x)


@pytest.mark.parametrize(
    ("x", "text"),
    [
        (0.0, "0.0"), (-0.0, "-0.0"), (math.nan, "NaN"), (math.inf, "Infinity"), (-math.inf, "-Infinity"), (1.0, "1.0"),
        (5e-324, "5e-324"), (-1.7976931348623157e308, "-1.7976931348623157e+308"), (1e15, "1000000000000000.0"),
        (9999999999999998.0, "9999999999999998.0"), (1e16, "1e+16"), (123456789012345680.0, "1.2345678901234568e+17"),
        (1e-5, "0.00001"), (-1.2345678901234567e-5, "-0.000012345678901234568"), (9.999e-6, "9.999e-6"),
        (2.0**-44, "5.684341886080802e-14"), (9007199254740993.0, "9007199254740992.0"), (1e23, "1e+23"),
        (0.1 + 0.2, "0.30000000000000004"),
    ],
)  # fmt: skip
def test_what_numbers_look_like(x, text):
    assert native.text_of_rows(np.array([[x]])) == text.encode() + b"\n"
    assert written_rows._number(x) == text


def test_python_writes_the_same_with_pydantic_and_without(rng, monkeypatch):
    x = rng.integers(0, 2**64, (1000, 4), dtype=np.uint64).view(np.float64)
    x[0] = [np.nan, np.inf, -np.inf, -0.0]
    x[1:300] = rng.uniform(-1, 1, (299, 4)) * 10.0 ** rng.integers(-8, 20, (299, 4))
    text = written_rows.csv_rows(x)
    monkeypatch.setattr(written_rows, "_kernel", lambda: None)
    assert written_rows.csv_rows(x) == text
    monkeypatch.setattr(written_rows, "pydantic_function", lambda name: None)
    assert written_rows.csv_rows(x) == text


def test_an_older_core_that_writes_no_plus(monkeypatch):
    monkeypatch.setattr(written_rows, "_kernel", lambda: None)
    monkeypatch.setattr(written_rows, "pydantic_function", lambda name: lambda rows: b"[1e16,2.5e-7,1.0,3e100]")
    assert written_rows.csv_rows(np.zeros((2, 2))) == b"1e+16,2.5e-7\n1.0,3e+100\n"


def test_any_layout_of_a_table(rng):
    x = rng.normal(size=(40, 6))
    lines = native.text_of_rows(x).splitlines()
    assert native.text_of_rows(x[::-1]).splitlines() == lines[::-1]
    assert native.text_of_rows(np.asfortranarray(x)).splitlines() == lines
    assert native.text_of_rows(x.astype(">f8")).splitlines() == lines
    assert native.text_of_rows(x[:0]) == b""
    assert native.text_of_rows(x[:3, :0]) == b"\n\n\n"
    assert native.text_of_rows(np.arange(4).reshape(2, 2)) == b"0.0,1.0\n2.0,3.0\n"


# Reading ---------------------------------------------------------------------------------------------------


def test_texts_of_any_number_of_digits():
    at_random = random.Random(560)
    texts = []
    for _ in range(60_000):
        digits = "".join(at_random.choices("0123456789", k=at_random.randint(1, 25)))
        if at_random.random() < 0.6:
            place = at_random.randint(0, len(digits))
            digits = f"{digits[:place]}.{digits[place:]}"
        exponent = f"{at_random.choice('eE')}{at_random.choice(['', '+', '-'])}{at_random.randint(0, 280)}"
        texts.append(at_random.choice(["", "-", "+"]) + digits + (exponent if at_random.random() < 0.6 else ""))
    expect_as_float(texts)


def test_texts_in_the_middle_between_two_doubles():
    at_random = random.Random(560)
    exact = Context(prec=1200)
    texts = []
    for _ in range(1500):
        x = float(np.array([at_random.randrange(0x7FE << 52)], dtype=np.uint64).view(np.float64)[0])
        middle = exact.divide(exact.add(Decimal(x), Decimal(math.nextafter(x, math.inf))), Decimal(2))
        texts += [f"{middle:.{digits}e}" for digits in (15, 16, 17, 18, 19, 25, 40, 750)]
        whole = at_random.getrandbits(53) | 1 << 53 | 1
        texts += [f"{whole}", f"{whole}e{at_random.randint(0, 3)}", f"{5 * whole}e-1", f"{25 * whole}e-2"]
        texts.append(f"{at_random.getrandbits(64)}e{at_random.randint(-345, 285)}")
    expect_as_float(texts)


def test_texts_at_the_ends_of_what_there_is():
    expect_as_float([
        "2.4703282292062327e-324", "2.4703282292062328e-324", "4.9406564584124654e-324", "1e-400", "0e99999999999",
        "0.0e-99999999999999999999", "2.2250738585072011e-308", "2.2250738585072012e-308", "1.7976931348623157e308",
        "1.7976931348623158e308", "2.225073858507201136057409796709131975934819546351645648e-308", "9007199254740993",
        "-0", "-0.0", "+.5e-0", "5.", "007", f"{'0' * 700}1", f"0.{'0' * 300}123", f"1{'0' * 300}",
    ])  # fmt: skip


@pytest.mark.parametrize(
    "text",
    [" ", "+", ".", "e5", "1e", "1e+", "1 2", "1,2", "nan", "inf", "1e309", "-1e400", "1_0", "0x1", "1\0", "\0", "١",
     "1#", '"1"', "1\r2", "\n", "1\n\n", "--1", "1.2.3", "1e5.0", "1;2", "pi", f"{'9' * 900}"],
)  # fmt: skip
def test_what_is_not_plain_is_left_to_the_reader_in_python(text):
    assert read([text]) is None
    assert read(["1.5", text, "2.5"]) is None


def test_ends_of_lines():
    for text in (b"1\n2", b"1\n2\n", b"1\r\n2\r\n", b" 1 \r\n2\t\n"):
        assert native.rows_in(text, b",", NUMBERS)[0].tolist() == [[1.0], [2.0]]
    for text in (b"1\n\n2", b"1\r2", b"1\n2\r", b"1\r\r\n2"):
        assert native.rows_in(text, b",", NUMBERS) is None
    assert native.rows_in(b"", b",", NUMBERS)[0].shape == (0, 1)


def test_cells_that_go_through_and_those_that_do_not():
    kinds = bytes([2, 1, 0, 1, 2])
    text = b" a b ;1.5; what ;-2;\r\n;3;;4e0; c"
    rows, cells, points = native.rows_in(text, b";", kinds)
    assert rows.tolist() == [[1.5, -2.0], [3.0, 4.0]]
    assert cells == [["a b", ""], ["", "c"]]
    assert points is True
    assert native.rows_in(b"1\t 2 \t3\n", b"\t", bytes([1, 2, 1]))[1:] == ([["2"]], False)
    assert native.rows_in(b"  1 \t 2  3 \n4 5 6\n", b" ", NUMBERS * 3)[0].tolist() == [[1, 2, 3], [4, 5, 6]]
    assert native.rows_in(b"1,0\n", b",", bytes([1, 3])) is None
    assert native.rows_in(b"1,1\n", b",", bytes([1, 3]))[0].tolist() == [[1.0]]
    for text in (b'1,"a"\n', b"1,#\n", b"1,\xc3\xa4\n", b"1,a\0\n", b"1\n", b"1,2,3\n", b"1,a\x0bb\n", b"1,a\rb\n"):
        assert native.rows_in(text, b",", bytes([1, 2])) is None
    for text in (b"1 \n", b"1 a,b\n", b"1 2 3\n"):
        assert native.rows_in(text, b" ", bytes([1, 2])) is None


def test_a_text_of_line_ends_takes_no_memory():
    assert native.rows_in(b"\n" * 100_000, b",", NUMBERS * 1_000_000) is None
    assert native.rows_in(b"1\n" * 100_000, b",", NUMBERS * 1_000_000) is None


@pytest.mark.parametrize(
    "arguments",
    [(), (b"1",), ("1", b",", NUMBERS), (b"1", b"", NUMBERS), (b"1", b",,", NUMBERS), (b"1", b"\0", NUMBERS),
     (b"1", b",", b""), (b"1", b",", b"\4"), (b"1", b",", b"\xff"), (b"1", b"1", NUMBERS), (b"1", b",", bytearray(1))],
)  # fmt: skip
def test_wrong_arguments_are_refused(arguments):
    with pytest.raises((TypeError, ValueError)):
        native.rows_in(*arguments)


@pytest.mark.parametrize("table", [None, [[1.0]], np.zeros(3), np.zeros((2, 2, 2)), np.array([["a"]])], ids=repr)
def test_what_is_no_table_is_refused(table):
    with pytest.raises((TypeError, ValueError)):
        native.text_of_rows(table)


def test_threads(rng):
    x = rng.normal(size=(3000, 6))
    long = [f"{value:.40f}" for value in x[:, 0].tolist()]  # such numbers ask Python
    text = native.text_of_rows(x)
    same = []

    def work():
        for _ in range(5):
            same.append(native.text_of_rows(x) == text)
            same.append(native.rows_in(text, b",", NUMBERS * 6)[0].tobytes() == x.tobytes())
            same.append(np.array_equal(read(long), [float(one) for one in long]))

    threads = [threading.Thread(target=work) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert same == [True] * 120


def test_rows_are_written_as_by_repr_with_the_kernel_and_without() -> None:
    rng = np.random.default_rng(1)
    x = rng.normal(size=(2000, 4)) * 10.0 ** rng.integers(-20, 20, (2000, 4))
    x[:4] = [
        [0.0, -0.0, np.nan, np.inf],
        [1e-7, 5e-5, 1e-10, 1e-9],
        [1e15, 1e16, 1e17, 1e22],
        [1e-3, 1e-4, 5e-324, 1.0],
    ]
    assert written_rows.number_lines(x) == [",".join(map(repr, row)) for row in x.tolist()]
