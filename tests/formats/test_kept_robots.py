"""Arms of the library that are kept as values are what the reader makes of their files."""

from __future__ import annotations

import dataclasses
import json
import shutil
from collections.abc import Mapping

import numpy as np
import pytest
from sweeps import sweep

import robokin
from robokin.formats import kept_robots, library, library_index, plain_robots
from robokin.formats.kept_robots import kept_robot
from robokin.formats.library import library_files
from robokin.formats.read import read_file
from robokin.model import Robot

FILES = library_files()


def same(a, b):
    """Whether two values are the same to the last bit, and of the same types."""
    if type(a) is not type(b):
        return False
    if isinstance(a, np.ndarray):
        return (a.dtype, a.tobytes(), a.flags.writeable) == (b.dtype, b.tobytes(), b.flags.writeable)
    if isinstance(a, tuple):
        return len(a) == len(b) and all(map(same, a, b))
    if isinstance(a, Mapping):
        return [*a] == [*b] and all(same(a[key], b[key]) for key in a)
    if dataclasses.is_dataclass(a):
        return all(same(getattr(a, part.name), getattr(b, part.name)) for part in dataclasses.fields(a))
    return repr(a) == repr(b)


@pytest.mark.parametrize("path", sweep(FILES, 8), ids=lambda path: path.stem)
def test_a_kept_arm_is_the_one_that_is_read(path):
    kept = kept_robot(library.library_folder(), path)
    if kept is None:
        assert type(read_file(path)) is not Robot or read_file(path).notes
        return
    read = read_file(path, id=path.stem)
    assert same(kept, read)
    assert same(robokin.load(path.stem), read)
    assert np.array_equal(kept.graph.chain("base", "tool").constants, read.graph.chain("base", "tool").constants)


def test_parameters_are_read():
    assert robokin.load("planar2r", a2=2).rows[1].a == 2.0


def test_a_line_counts_for_its_file_alone(tmp_path, monkeypatch):
    copied = tmp_path / "robots"
    shutil.copytree(library.library_folder(), copied)
    for module in (library, library_index):
        monkeypatch.setattr(module, "library_folder", lambda: copied)
    path = copied / "arms" / "puma560.yaml"
    assert kept_robot(library.library_folder(), path) is not None
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace("431.8", "431.9"), encoding="utf-8")
    assert kept_robot(library.library_folder(), path) is None
    assert robokin.load("puma560").rows[1].a == 0.4319
    path.write_text("robokin: 2\n", encoding="utf-8")
    with pytest.raises(robokin.DescriptionError):
        robokin.load("puma560")
    path.write_text(text, encoding="utf-8")
    kept = copied / kept_robots.TABLES
    check = library_index.check_sum(path)
    for line in (f'{{"id": "puma560", "check": {check}}}', f'{{"id": "puma560", "check": {check}, "rows": [1]}}',
                 '{"id": "puma560", ', "[" * 5000, "\xff"):  # fmt: skip
        kept.write_bytes(line.encode("latin-1"))
        assert kept_robot(library.library_folder(), path) is None
        assert robokin.load("puma560").n == 6
    kept.unlink()
    assert robokin.load("puma560").n == 6


@pytest.mark.slow
def test_the_kept_tables_are_those_of_the_library():
    """`python -m robokin.formats.plain_robots` makes them; last digits of sines are the processor's own."""
    kept = (library.library_folder() / kept_robots.TABLES).read_text(encoding="utf-8").splitlines()
    fresh = plain_robots.tables_text().splitlines()
    assert [json.loads(line)["id"] for line in kept] == [json.loads(line)["id"] for line in fresh]
    assert [json.loads(line)["check"] for line in kept] == [json.loads(line)["check"] for line in fresh]
