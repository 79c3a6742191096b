"""`robokin validate`: verdicts, and status 2 if any is wrong."""

from __future__ import annotations

from robokin.description import library_names
from robokin.description.library import library_folder

from .conftest import refused

KEYS = ["file", "valid", "kind", "name", "error", "line", "column"]
GOOD = "robokin: 1\nname: Good arm\njoints:\n  - {type: R, a: 1}\n"
BAD = "robokin: 1\nname: Bad arm\njoints:\n  - {type: R, a: 1}\n  - {type: Q}\n"


def files(tmp_path):
    (tmp_path / "good.yaml").write_text(GOOD)
    (tmp_path / "bad.yaml").write_text(BAD)
    return str(tmp_path / "good.yaml"), str(tmp_path / "bad.yaml")


def test_a_good_file(call, tmp_path):
    good, _ = files(tmp_path)
    answer = call("validate", good)
    assert (answer.status, answer.err) == (0, "")
    assert answer.text == f"ok     {good}: robot Good arm\n"


def test_a_wrong_file_names_its_place(call, tmp_path):
    _, bad = files(tmp_path)
    answer = call("validate", bad)
    assert answer.status == 2
    assert answer.text.startswith(f"wrong  {bad}:5:12: found 'Q'")
    assert answer.err == "robokin: 1 of 1 descriptions is wrong\n"


def test_every_file_has_its_verdict(call, tmp_path):
    good, bad = files(tmp_path)
    answer = call("validate", good, bad, "./none.yaml", "puma560", "four-bar")
    assert answer.status == 2
    assert [line.split()[0] for line in answer.lines] == ["ok", "wrong", "wrong", "ok", "ok"]
    assert answer.err == "robokin: 2 of 5 descriptions are wrong\n"


def test_verdicts_for_programs(call, tmp_path):
    good, bad = files(tmp_path)
    answer = call("validate", good, bad, "four-bar", "--json")
    assert answer.status == 2
    assert all(list(record) == KEYS for record in answer.json)
    assert [record["valid"] for record in answer.json] == [True, False, True]
    assert [record["kind"] for record in answer.json] == ["robot", None, "mechanism"]
    assert [record["line"] for record in answer.json] == [None, 5, None]
    assert answer.json[1]["column"] == 12
    assert call("validate", good, bad, "four-bar", "-f", "jsonl").jsonl == answer.json
    table = call("validate", good, bad, "four-bar", "-f", "csv").csv
    assert table[0] == KEYS
    assert [row[1] for row in table[1:]] == ["True", "False", "True"]


def test_the_verdicts_go_into_a_file_also_when_one_is_wrong(call, tmp_path):
    good, bad = files(tmp_path)
    assert call("validate", good, bad, "-o", tmp_path / "verdicts.csv").status == 2
    assert len((tmp_path / "verdicts.csv").read_text().splitlines()) == 3


def test_the_whole_library_is_valid(call):
    paths = sorted(map(str, library_folder().glob("*.yaml")))
    answer = call("validate", *paths)
    assert (answer.status, answer.err) == (0, "")
    assert len(answer.lines) == len(library_names())


def test_a_name_that_is_no_text(run):
    answer = run("validate", "\udcff.yaml", "--json")
    assert answer.status == 2
    assert answer.json[0]["file"] == "\udcff.yaml"
    assert run("validate", "\udcff.yaml").text.startswith("wrong  \\udcff.yaml: no such file")


def test_at_least_one_file(call):
    refused(call("validate"), "FILE... is missing")
