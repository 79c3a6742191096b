"""Pages off a terminal are what Rich would draw, whoever draws them."""

from __future__ import annotations

import random

import pytest
from rich.cells import cell_len

from robokin.reports import page_tables
from robokin.reports.page_parts import Table
from robokin.reports.page_tables import heading, number_table, pairs
from robokin.reports.plain_pages import NARROW, plain_page, width_of
from robokin.reports.rich_pages import rich_page

WORDS = [
    "", " ", "a", "12.5", "-90.000001", "wrist", "shoulder right, elbow up", "θ₁", "α+β", "±180°", "–", "Grübler",
    "joint3", "x" * 30, "1" * 23, "Raghavan and Roth, 1990: sixteen solutions", "関節", "e\u0301", "two  blanks",
    " led", "trailing   ", "no\u00a0break", "\u00ad", "tab\there", "☃",
]  # fmt: skip


def lines(text):
    return [line.rstrip() for line in text.split("\n")]


def fitted(parts, page=80):
    return [(part, *page_tables._fit(part, page)) if isinstance(part, Table) else (part, 0, []) for part in parts]


def drawn(rng):
    """A table of random cells."""
    made = Table(gap=rng.choice([1, 2, 3]), headed=rng.random() < 0.7)
    columns = rng.randint(1, 7)
    for _ in range(columns):
        made.add_column(
            rng.choice(WORDS), justify=rng.choice(["left", "right"]), style=rng.choice(["", "cyan"]),
            no_wrap=rng.random() < 0.3, max_width=rng.choice([None, None, 8, 12]),
        )  # fmt: skip
    for _ in range(rng.randint(0, 5)):
        cells = [" ".join(rng.choices(WORDS, k=rng.choice([1, 1, 2, 6]))) for _ in range(columns)]
        made.add_row(*cells[: rng.choice([columns, columns, rng.randint(1, columns)])], style=rng.choice([None, "red"]))
        if rng.random() < 0.3:
            made.add_section()
    return made


def test_random_tables_are_those_of_rich():
    rng, plain = random.Random(5), 0
    for _ in range(1500):
        parts = fitted([drawn(rng)])
        own = plain_page(parts)
        if own is not None:
            plain += 1
            assert lines(own) == lines(rich_page(parts, 80, False))
    assert plain > 150


def test_headings_texts_and_the_house_s_tables_are_those_of_rich():
    for parts in (
        [heading("PUMA 560", "lengths in mm, angles in deg"), "", number_table("nsap", [[1.0, -0.5, 0.0, 1e16]], "x")],
        [heading("a" * 60, "b" * 30), "\nlast line", pairs([("q", "1  2  3"), ("reason", "too far " * 20)])],
        [heading("", "x"), heading("x"), "", "two\nlines ", pairs([])],
    ):
        page = fitted(parts)
        own = plain_page(page)
        assert own is not None
        assert lines(own) == lines(rich_page(page, 80, False))


def test_narrow_letters_are_narrow():
    wide = [chr(c) for c in range(0x3000) if NARROW.fullmatch(chr(c)) and cell_len(chr(c)) != 1]
    assert wide == []
    for word in WORDS:
        assert width_of(word) == cell_len(word)


@pytest.mark.parametrize("text", ["関節", "e\u0301", "👩‍🔧"])
def test_what_it_cannot_draw_it_leaves_to_rich(text):
    made = Table()
    made.add_column("a", max_width=20)
    made.add_row(text)
    assert plain_page(fitted([made])) is None
