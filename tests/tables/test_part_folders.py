"""Parts are whole or absent, recorded or made anew."""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace

import pytest

from robokin.errors import InputError, OutputError
from robokin.tables.part_files import PartPlace, WrittenPart, part_of, record_of
from robokin.tables.part_folders import PartFolder, read_manifest, whole_parts

QUESTION = {"command": "test", "tolerances": (None, 0.1)}


def filled(data, rows=3):
    def fill(stream):
        for piece in data:
            stream.write(piece)
        return rows, None

    return fill


def made(folder, number, data=(b"ab", b"c")):
    part, back = folder.place.made(number, filled(data), 5, "asked")
    assert back is None
    folder.record(part)
    return part


def test_a_run_is_gone_on_with_where_it_was(tmp_path):
    output = str(tmp_path / "run")
    with PartFolder.opened(output, QUESTION, resume=False) as folder:
        first = made(folder, 0)
        assert first == WrittenPart(0, 3, 3, hashlib.sha256(b"abc").hexdigest(), 5, "asked", None)
        made(folder, 2)
    with pytest.raises(InputError, match="not done, expected --resume to finish it"):
        whole_parts(output)
    with PartFolder.opened(output, QUESTION, resume=True) as folder:
        assert {*folder.recorded} == {0, 2}
        assert folder.place.holds(folder.recorded[0])
        made(folder, 1)
        folder.finish([*folder.recorded.values(), made(folder, 1)])
    assert [path[-21:] for path in whole_parts(output)] == [f"part-{number:08d}.parquet" for number in range(3)]
    assert read_manifest(output)["complete"]


def test_what_ends_a_part_early_leaves_nothing_of_it(tmp_path):
    def fill(stream):
        stream.write(b"half")
        raise ValueError("in the middle")

    with PartFolder.opened(str(tmp_path), QUESTION, resume=False) as folder:
        with pytest.raises(ValueError, match="in the middle"):
            folder.place.made(0, fill, 1, "")
        assert not [path for path in tmp_path.iterdir() if "part" in path.name]


def test_a_worker_elsewhere_hands_its_bytes_back(tmp_path):
    with PartFolder.opened(str(tmp_path), QUESTION, resume=False) as folder:
        here = made(folder, 0)
        for place in (replace(folder.place, word="another"), PartPlace("/nowhere", folder.place.word)):
            part, data = place.made(0, filled([b"ab", b"c"]), 5, "asked")
            assert (part, data) == (here, b"abc")
            assert place.holds(here) is None
        folder.place.write(replace(here, number=4), b"abc")
        assert folder.place.holds(replace(here, number=4))
        assert not folder.place.holds(replace(here, number=5))
        assert not folder.place.holds(replace(here, bytes=4))
        assert not folder.place.holds(replace(here, sha256="0"))


def test_the_word_of_a_run_ends_with_it(tmp_path):
    """A worker that outlives its run does not write to the folder of the next one."""
    with PartFolder.opened(str(tmp_path), QUESTION, resume=False) as folder:
        place = folder.place
        assert place.seen()
    assert not place.seen()
    with PartFolder.opened(str(tmp_path), QUESTION, resume=True):
        assert not place.seen()


@pytest.mark.parametrize(
    "record", [None, 1, [], {}, {"number": 0}, {"number": 1.0, "rows": 1, "bytes": 1, "sha256": ""}]
)
def test_what_is_no_record_is_none(record):
    assert part_of(record) is None


@pytest.mark.parametrize(
    "key, value",
    [("rows", 3), ("number", 1), ("bytes", 6), ("questions", 0), ("asked", "b"), ("found", {}), ("check", 0),
     ("check", None)],
)  # fmt: skip
def test_a_record_that_is_damaged_is_none(key, value):
    """A part whose bytes are right is no help where what is said of it is wrong."""
    part = WrittenPart(0, 2, 5, "0", 7, "a", [1, {"2": None}])
    record = json.loads(json.dumps({"file": part.file} | record_of(part)))
    assert part_of(record) == part
    assert part_of(record | {key: value}) is None
    less = part_of({name: one for name, one in record.items() if name != key})
    assert less == (part if key == "check" else None)  # older folders have no check sums


def test_a_place_that_cannot_be_written(tmp_path):
    (tmp_path / "file").write_text("")
    for output in (str(tmp_path / "file"), str(tmp_path / "file" / "run")):
        opened = PartFolder.opened(output, QUESTION, resume=False)
        with pytest.raises(OutputError, match="expected a folder that can be written"), opened:
            pass


def test_a_part_that_is_missing_or_cut_is_no_table(tmp_path):
    output = str(tmp_path)
    with PartFolder.opened(output, QUESTION, resume=False) as folder:
        folder.finish([made(folder, 0), made(folder, 1)])
    (tmp_path / "part-00000001.parquet").write_bytes(b"ab")
    with pytest.raises(InputError, match="found no file of 3 bytes, expected the part of its run"):
        whole_parts(output)
    manifest = json.loads((tmp_path / "_manifest.json").read_text())
    assert manifest["question"]["tolerances"] == [None, 0.1]
