"""The notebooks of the lectures run, and show what is kept in them."""

from __future__ import annotations

import re

import documentation
import pytest
from notebooks import NOTEBOOKS, notebooks, read, run, source_of, text_of

LECTURES = {path.stem for path in (NOTEBOOKS.parent / "lectures").glob("*.md")}

LARGEST = 200_000
"""Bytes of a notebook: what GitHub shows without a word."""


@pytest.mark.parametrize("path", notebooks(), ids=lambda path: path.stem)
def test_a_notebook_shows_what_is_kept_in_it(path, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    kept = read(path)
    today = run(kept)
    for old, new in zip(kept["cells"], today["cells"], strict=True):
        assert documentation.same(text_of(new), text_of(old)), f"{source_of(old)}\nstale; `make docs` writes it anew"
    assert kept["metadata"] == today["metadata"]
    assert [*tmp_path.iterdir()] == []


@pytest.mark.parametrize("path", notebooks(), ids=lambda path: path.stem)
def test_a_notebook_is_small_and_checks_itself(path):
    assert len(path.read_bytes()) < LARGEST
    sources = [source_of(cell) for cell in read(path)["cells"]]
    assert sources[0].startswith("# ")
    assert sum(len(re.findall(r"^assert ", source, re.M)) for source in sources) >= 4
    assert any(".plot(" in source or "draw(" in source for source in sources)
    assert any(".table" in source or "record()" in source for source in sources)


def test_each_lecture_has_a_notebook_and_each_page_of_it_a_link():
    assert {path.stem for path in notebooks()} == LECTURES
    for name in LECTURES:
        assert f"(../notebooks/{name}.ipynb)" in (NOTEBOOKS.parent / "lectures" / f"{name}.md").read_text()
        assert f"(notebooks/{name}.ipynb)" in (NOTEBOOKS.parent / "README.md").read_text()
