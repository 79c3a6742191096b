"""`robokin list`: what the library holds."""

from __future__ import annotations

import pytest

from robokin.description import library_names, load_any

KEYS = ["id", "name", "kind", "joints", "dof", "source"]


def test_the_keys_are_the_contract_s(call):
    answer = call("list", "--json")
    assert (answer.status, answer.err) == (0, "")
    assert all(list(record) == KEYS for record in answer.json)
    assert [record["id"] for record in answer.json] == library_names()


def test_what_an_entry_says(call):
    entries = {record["id"]: record for record in call("list", "--json").json}
    puma = entries["puma560"]
    assert (puma["name"], puma["kind"], puma["joints"], puma["dof"]) == ("PUMA 560", "robot", "RRRRRR", 6)
    assert puma["source"].startswith("C. Laschi")
    assert (entries["four-bar"]["kind"], entries["four-bar"]["joints"]) == ("mechanism", "RRRR")
    assert (entries["scara"]["joints"], entries["scara"]["dof"]) == ("RRPR", 4)
    for record in entries.values():
        assert record["kind"] in ("robot", "mechanism", "wheeled")
        assert record["source"]
        if record["kind"] == "robot":
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
    shown = [["" if value is None else str(value) for value in record.values()] for record in records]
    assert answer.csv[1:] == shown


def test_every_name_is_in_the_table_on_a_line_of_its_own(call):
    lines = call("list").lines
    names = library_names()
    assert set(names) <= {line.split()[0] for line in lines if line[:1].strip()}
    kinds = [record["kind"] for record in call("list", "--json").json]
    robots, mechanisms, bases = (kinds.count(kind) for kind in ("robot", "mechanism", "wheeled"))
    assert lines[-1] == f"{robots} robots, {mechanisms} mechanisms, {bases} wheeled bases"


@pytest.mark.parametrize("words", [["kuka"], ["KUKA", "arc"], ["mechanism"], ["wheeled"], ["RRPR"]])
def test_words_narrow_the_list(call, words):
    records = call("list", "--json").json
    found = call("list", *words, "--json").json
    assert 0 < len(found) < len(records)
    text = [" ".join(map(str, record.values())).lower() for record in records]
    assert found == [r for r, t in zip(records, text, strict=True) if all(word.lower() in t for word in words)]


def test_nothing_found_is_an_empty_list(call):
    assert call("list", "no such thing", "--json").json == []
    assert call("list", "no such thing", "-f", "csv").csv == [KEYS]
    assert call("list", "no such thing").lines[-1] == "0 robots, 0 mechanisms"
    assert call("list", "puma560-akb").lines[-1] == "1 robot, 0 mechanisms"
    assert call("list", "mecanum").lines[-1] == "0 robots, 0 mechanisms, 1 wheeled base"
