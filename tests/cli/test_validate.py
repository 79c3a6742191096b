"""`robokin validate`: verdicts, and status 2 if any is wrong."""

from __future__ import annotations

import re

import pytest

from robokin.formats import library_names
from robokin.formats.library import library_files

from .conftest import refused

KEYS = ["file", "valid", "kind", "name", "error", "line", "column", "errors", "notes"]
COLUMNS = [*KEYS[:7], "notes"]
SLIPS = "robokin: 1\nname: Slips\njoints:\n  - {type: R, alhpa: 1}\n  - {type: R, a: x, theta: 5}\n"
DOUBTS = "robokin: 1\nname: Doubts\njoints:\n  - {type: R, d: 290, alpha: 90, limits: [-170, 170]}\n"
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
    verdicts = [line.split()[0] for line in answer.lines if not line.startswith(" ")]
    assert verdicts == ["ok", "wrong", "wrong", "ok", "ok"]
    assert answer.err == "robokin: 2 of 5 descriptions are wrong\n"


def test_verdicts_for_programs(call, tmp_path):
    good, bad = files(tmp_path)
    answer = call("validate", good, bad, "four-bar", "--json")
    assert answer.status == 2
    assert all(list(record) == ["schema", "file", "id", *KEYS[1:], "units"] for record in answer.json)
    assert [record["valid"] for record in answer.json] == [True, False, True]
    assert [record["kind"] for record in answer.json] == ["robot", None, "mechanism"]
    assert [record["line"] for record in answer.json] == [None, 5, None]
    assert answer.json[1]["column"] == 12
    assert call("validate", good, bad, "four-bar", "-f", "jsonl").jsonl == answer.json
    table = call("validate", good, bad, "four-bar", "-f", "csv").csv
    assert table[0] == COLUMNS
    assert [row[1] for row in table[1:]] == ["true", "false", "true"]


def test_the_verdicts_go_into_a_file_also_when_one_is_wrong(call, tmp_path):
    good, bad = files(tmp_path)
    assert call("validate", good, bad, "-o", tmp_path / "verdicts.csv").status == 2
    assert len((tmp_path / "verdicts.csv").read_text().splitlines()) == 3


def test_the_whole_library_is_valid(call):
    paths = list(map(str, library_files()))
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


def test_all_mistakes_are_said_with_their_lines(call, tmp_path):
    path = tmp_path / "slips.yaml"
    path.write_text(SLIPS)
    answer = call("validate", path)
    assert answer.status == 2
    assert answer.err == "robokin: 1 of 1 descriptions is wrong\n"
    text = answer.text.replace(f"{path}", "slips.yaml")
    assert text.startswith("wrong  slips.yaml:4:15: found the unknown key 'alhpa'")
    assert (
        "\n          4 |   - {type: R, alhpa: 1}\n            |               ^~~~~\n       slips.yaml:5:18: a of row 2"
        in text
    )
    assert text.count("\n       slips.yaml:5:") == 2
    (record,) = call("validate", path, "--json").json
    assert record["error"] == f"{path}:4:15: {record['errors'][0]['message']}"
    assert [(one["line"], one["column"]) for one in record["errors"]] == [(4, 15), (5, 18), (5, 28)]
    assert record["notes"] == []
    refusal = call("fk", path, "--q", "0,0").err
    assert refusal.startswith(f"robokin: {path}:4:15: found the unknown key 'alhpa'")
    assert refusal.count("^") == 3
    assert (
        call("check", "dh", path, path, "--against", "planar2r", "--json").json["items"][0]["detail"] == record["error"]
    )


def test_what_is_doubtful_is_noted(call, tmp_path):
    path = tmp_path / "doubts.yaml"
    path.write_text(DOUBTS)
    answer = call("validate", path)
    assert (answer.status, answer.err) == (0, "")
    assert [line.split()[0] for line in answer.lines] == ["ok", "note", "note"]
    assert f"note   {path}:4:30: alpha of row 1 is 90 rad" in answer.text
    (record,) = call("validate", path, "--json").json
    assert (record["valid"], record["errors"]) == (True, [])
    assert [(note["line"], note["column"]) for note in record["notes"]] == [(4, 30), (4, 18)]
    assert "4:30: alpha" in call("validate", path, "-f", "csv").csv[1][7]
    said = call("fk", path, "--q", "0", "--json")
    assert said.status == 0
    assert said.err == f"robokin: {path}:4:30: {record['notes'][0]['message']}; 1 more: robokin validate {path}\n"
    assert "alpha of row 1" in call("show", path).err
    assert call("fk", "puma560", "--q", "home").err == ""


def test_joint_values_in_radians_are_noted(call):
    note = "robokin: joint values such as -1.5708 are read as degrees; for radians give --angle rad\n"
    assert call("fk", "puma560", "--q", "0,-1.5708,1.5708,0,0,0").err == note
    assert call("fk", "puma560", "--q", "0,-1.5708,1.5708,0,0,0", "--angle", "rad").err == ""
    rows = b"q1,q2\n0.7854,1.5708\n-1.5708,3.1416\n"
    assert "standard input: joint values" in call("fk", "planar2r", "-i", "-", stdin=rows).err
    assert "read as radians" in call("fk", "planar2r", "--angle", "rad", "--q", "45,90").err


RADIANS = "0,-1.5708,1.5708,0,0,0"
ENTRIES = "[[1,2],[3,4],[0,0],[0,0],[0,0],[1,1]]"


@pytest.mark.parametrize(
    ("words", "option"),
    [
        (["path", "puma560", "--from", RADIANS, "--to", "home"], "--from"),
        (["path", "puma560", "--from", "home", "--to", RADIANS], "--to"),
        (["plot", "puma560", "--q", RADIANS], ""),
        (["plot", "puma560", "--q", "home", "--q", RADIANS], ""),
        (["ik", "puma560", "--xyz", "400,100,300", "--rpy", "180,0,0", "--near", RADIANS], "--near"),
        (["ik", "panda", "--xyz", "400,100,400", "--rpy", "180,0,0", "--hold", "q3=1.5708"], "--hold"),
        (["check", "fk", "puma560", "--q", RADIANS, "--expect", "1,2,3"], ""),
        (["check", "ik", "puma560", "--xyz", "400,100,300", "--q", RADIANS], ""),
        (["check", "ik", "puma560", "--xyz", "400,100,300", "--q", "none", "--q", RADIANS, "--q", "1,2"], ""),
        (["check", "jacobian", "planar2r", "--q", "0,1.5708", "--expect", ENTRIES], ""),
    ],
    ids=lambda value: value if isinstance(value, str) else " ".join(value),
)
def test_joint_values_in_radians_are_noted_wherever_they_are_typed(call, words, option):
    where = f"{option}: " if option else ""
    note = f"robokin: {where}joint values such as [-.0-9]+ are read as degrees; for radians give --angle rad"
    found = [line for line in call(*words).err.splitlines() if "read as degrees" in line]
    assert [bool(re.fullmatch(note, line)) for line in found] == [True]
    assert "read as" not in call(*words, "--angle", "rad").err


@pytest.mark.parametrize(
    "words",
    [
        ["path", "puma560", "--from", "home", "--to", "10,20,30,40,50,60"],
        ["plot", "puma560", "--q", "home"],
        ["ik", "puma560", "--xyz", "400,100,300", "--near", "home"],
        ["check", "ik", "puma560", "--xyz", "400,100,300", "--q", "none"],
        ["check", "ik", "puma560", "--xyz", "400,100,300", "--q", "nan,0,0,0,0,0"],
        ["check", "ik", "puma560", "--xyz", "400,100,300", "--q", "1e400,0,0,0,0,0"],
        ["check", "ik", "puma560", "--xyz", "400,100,300", "--q", ""],
        ["check", "fk", "puma560", "--q", "10,20,30,40,50,60", "--expect", "1,2,3"],
    ],
    ids=" ".join,
)
def test_other_joint_values_are_not_noted(call, words):
    assert "read as" not in call(*words).err


def test_questions_of_a_file_in_radians_are_noted_and_answers_are_not(call, tmp_path):
    rows = "id,q1,q2,x,y,z\na,0.7854,1.5708,1,2,0\nb,-1.5708,3.1416,,,\n"
    path, key = tmp_path / "answers.csv", tmp_path / "key.csv"
    path.write_text(rows)
    key.write_text("id;q1;q2\na;0,7854;1,5708\n")
    note = "joint values such as 0.7854 are read as degrees"
    assert f"{path}: {note}" in call("check", "fk", "planar2r", "-i", path).err
    said = call("check", "fk", "planar2r", "-i", path, "--key", key).err
    assert (f"{key}: {note}" in said, f"{path}: {note}" in said) == (True, False)
    assert "read as" not in call("check", "ik", "planar2r", "-i", path).err
    path.write_text('q1,q2,x,y,z\nnan,15.708,1,2,0\n,,1,2,0\n1e999,x,1,2,0\n"3,1,1,1,1\n')
    assert "read as" not in call("check", "fk", "planar2r", "-i", path).err
