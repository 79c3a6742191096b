"""`robokin list`: what the library holds."""

from __future__ import annotations

import pytest
from sweeps import sweep

from robokin.formats import library_index, library_names, load_any

from .conftest import refused

KEYS = ["id", "name", "kind", "joints", "dof", "source"]


def test_the_keys_are_the_contract_s(call):
    answer = call("list", "--json")
    assert (answer.status, answer.err) == (0, "")
    assert all(list(record) == ["schema", *KEYS, "units"] for record in answer.json)
    assert [record["id"] for record in answer.json] == library_names()


def test_what_an_entry_says(call):
    entries = {record["id"]: record for record in call("list", "--json").json}
    puma = entries["puma560"]
    assert (puma["name"], puma["kind"], puma["joints"], puma["dof"]) == ("PUMA 560", "robot", "RRRRRR", 6)
    assert puma["source"].startswith("C. Laschi")
    assert (entries["four-bar"]["kind"], entries["four-bar"]["joints"]) == ("mechanism", "RRRR")
    assert (entries["scara"]["joints"], entries["scara"]["dof"]) == ("RRPR", 4)
    for record in entries.values():
        assert record["kind"] in ("robot", "tree", "mechanism", "wheeled")
        assert record["source"]
        if record["kind"] in ("robot", "tree"):
            assert record["dof"] == len(record["joints"])
        elif record["dof"] is not None:
            assert record["dof"] == load_any(record["id"]).expected["mobility"]
    assert (entries["sarrus"]["dof"], entries["car"]["dof"]) == (1, 1)
    assert (entries["car"]["kind"], entries["car"]["joints"]) == ("wheeled", "2 fixed, 2 steered")


def test_the_formats_agree(call):
    records = call("list", "--json").json
    assert call("list", "-f", "jsonl").jsonl == records
    answer = call("list", "-f", "csv")
    assert answer.columns == KEYS
    shown = [["" if record[name] is None else str(record[name]) for name in KEYS] for record in records]
    assert answer.csv[1:] == shown


def test_every_name_is_in_the_table_on_a_line_of_its_own(call):
    lines = call("list").lines
    names = library_names()
    assert set(names) <= {line.split()[0] for line in lines if line[:1].strip()}
    kinds = [record["kind"] for record in call("list", "--json").json]
    robots, mechanisms, bases = (
        sum(kinds.count(kind) for kind in group) for group in (("robot", "tree"), ("mechanism",), ("wheeled",))
    )
    assert lines[-1] == f"{robots} robots, {mechanisms} mechanisms, {bases} wheeled bases"


def ids(answer):
    return {record["id"] for record in answer.json}


@pytest.mark.parametrize(
    "words", sweep([["kuka"], ["KUKA", "arc"], ["mechanism"], ["wheeled"], ["RRPR"], ["kuka arc"]], 3)
)
def test_words_narrow_the_list(call, words):
    records = call("list", "--json").json
    found = call("list", *words, "--json").json
    assert 0 < len(found) < len(records)
    assert found == [record for record in records if record in found], "in the order of the library"
    for word in " ".join(words).split():
        assert ids(call("list", *words, "--json")) <= ids(call("list", word, "--json"))


def test_words_are_not_letters_within_words(call):
    """`ur` is Universal Robots' and no part of `four`, `source` or `URDF`."""
    records = {record["id"]: record for record in call("list", "ur", "--json").json}
    assert {"ur3", "ur5e", "ur30"} <= set(records)
    assert len(records) < 20
    assert "four-bar" not in records
    assert ids(call("list", "560", "--json")) >= {"puma560", "puma560-craig"}
    assert ids(call("list", "puma560", "--json")) == ids(call("list", "PUMA 560", "--json"))
    assert ids(call("list", "staubli", "--json")) == ids(call("list", "Stäubli", "--json")) != set()


@pytest.mark.parametrize(
    ("word", "some"),
    sweep(
        [
            ("scara", {"scara", "cobra-s600", "adept-one", "epson-ls3-401s", "tp80", "kr5-scara-r350"}),
            ("planar", {"planar3r", "four-bar"}),
            ("anthropomorphic", {"puma560"}),
            ("spherical", {"stanford", "spherical-four-bar"}),
            ("redundant", {"panda", "iiwa7"}),
            ("gear", {"gear-pair"}),
            ("mobile", {"car", "mecanum"}),
        ],
        3,
    ),
)
def test_a_word_finds_what_is_of_that_kind(call, word, some):
    assert some <= ids(call("list", word, "--json"))


def test_nothing_found_is_said_and_is_a_no(call):
    for form, empty in (("json", []), ("jsonl", []), ("csv", [KEYS])):
        answer = call("list", "no such thing", "-f", form)
        assert answer.status == 3
        assert getattr(answer, form) == empty
    refused(call("list", "zzzz"), "nothing in the library has the word 'zzzz'", "robokin list", status=3)
    refused(call("list", "stanfrod"), "did you mean 'stanford'", status=3)
    refused(call("list", "kuka", "wheeled"), "'kuka' and 'wheeled' together", status=3)
    refused(call("list", "\x1b[31m!"), "\\x1b[31m!", status=3)
    refused(call("list", "-", "."), status=3)
    assert call("list", "puma560-akb").lines[-1] == "1 robot, 0 mechanisms"
    assert call("list", "mecanum").lines[-1] == "0 robots, 0 mechanisms, 1 wheeled base"


# The index ------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_index_says_what_the_descriptions_say():
    kept = library_index.library_folder() / library_index.INDEX
    assert kept.read_text(encoding="utf-8") == library_index.index_text(), (
        "the library has changed: run python -m robokin.formats.library_index"
    )


@pytest.fixture
def library(tmp_path, monkeypatch):
    """A small library of its own."""
    for name in ("library", "library_index"):
        monkeypatch.setattr(f"robokin.formats.{name}.library_folder", lambda: tmp_path)
    for name in ("scara", "four-bar", "car"):
        source = next(path for path in SOURCES if path.stem == name)
        folder = tmp_path / source.parent.name
        folder.mkdir(exist_ok=True)
        (folder / source.name).write_text(source.read_text(encoding="utf-8"), encoding="utf-8")
    return tmp_path


SOURCES = library_index.library_files()


def listed():
    return [entry.record() for entry in library_index.library_entries()]


def test_an_index_that_is_old_broken_or_not_there_changes_nothing(library):
    plain = listed()
    assert [record["id"] for record in plain] == ["car", "four-bar", "scara"]
    index = library / library_index.INDEX
    index.write_text(library_index.index_text(), encoding="utf-8")
    assert listed() == plain
    for text in ("", "<<<<<<< HEAD\n", "{}\n[]\n1\n", '{"check": 1, "id": "car"}\n', "[" * 5000 + "\n", "\udcff"):
        index.write_bytes(text.encode(errors="surrogateescape"))
        assert listed() == plain
    index.write_text(library_index.index_text(), encoding="utf-8")
    arm = library / "arms" / "scara.yaml"
    arm.write_text(arm.read_text(encoding="utf-8").replace("name: SCARA arm", "name: Another arm"), encoding="utf-8")
    assert listed()[2]["name"] == "Another arm"
    (library / "bases" / "car.yaml").unlink()
    assert [record["id"] for record in listed()] == ["four-bar", "scara"]


def test_an_entry_that_is_in_the_index_is_not_read(library, monkeypatch):
    plain = listed()
    (library / library_index.INDEX).write_text(library_index.index_text(), encoding="utf-8")
    monkeypatch.setattr(library_index, "entry_of", None)
    assert listed() == plain
