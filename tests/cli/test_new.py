"""`robokin new`: what is written loads, what is open is said, what is there stays."""

from __future__ import annotations

from pathlib import Path

import pytest

from .conftest import refused

TABLE = Path(__file__).parent.parent / "data/pasted_table.txt"


def test_the_example_is_a_robot_of_every_command(call, tmp_path):
    file = tmp_path / "arm.yaml"
    answer = call("new", file)
    assert (answer.status, answer.err) == (0, "") and f"robokin show {file}" in answer.text
    assert call("fk", file, "--q", "home", "--json").json["pose"]["position"] == pytest.approx([330, 0, 700])
    assert call("validate", file).status == 0
    assert call("ik", file, "--xyz", "330,0,700").status == 0
    assert call("fk", file, "--q", "home", "--set", "upper=400", "--json").json["pose"]["position"][2] == pytest.approx(
        800
    )


def test_a_file_that_is_there_stays(call, tmp_path):
    file = tmp_path / "arm.yaml"
    file.write_text("mine")
    refused(call("new", file), "is there already, expected another name, or --force")
    assert file.read_text() == "mine"
    assert call("new", file, "--force").status == 0 and "robokin: 1" in file.read_text()
    link = tmp_path / "link.yaml"
    link.symlink_to(tmp_path / "nowhere.yaml")
    refused(call("new", link), "is there already")


def test_a_copy_is_the_library_file_with_its_comments(call, tmp_path):
    file = tmp_path / "p.yaml"
    assert call("new", file, "--from", "PUMA560").status == 0
    library = Path(__file__).parent.parent.parent / "robots/arms/puma560.yaml"
    assert file.read_bytes() == library.read_bytes()
    assert call("new", "-", "--from", file).out == library.read_bytes()
    urdf = tmp_path / "p.urdf"
    assert call("convert", "puma560", "-o", urdf).status == 0
    assert "convention: frames" in call("new", "-", "--from", urdf).text
    assert "branches:" in call("new", "-", "--from", "human-hand").text
    refused(call("new", "-", "--from", "puma56"), "did you mean puma560")


def test_a_table_of_a_file_and_of_standard_input(call, tmp_path):
    file = tmp_path / "arm.yaml"
    answer = call("new", file, "--table", TABLE)
    assert answer.status == 0 and "no value yet: L3" in answer.text and "convention: standard" in answer.text
    refused(call("show", file), "found nothing, expected parameter L3")
    assert call("new", file, "--table", "-", "--set", "L3=100", "--force", stdin=TABLE.read_bytes()).status == 0
    assert call("fk", file, "--q", "0,90,0", "--json").json["pose"]["position"] == pytest.approx([400, 0, 400])
    document = call("new", "-", "--table", TABLE, "--json").json
    assert (document["joints"], document["missing"], document["units"]) == (
        "RRR",
        ["L3"],
        {"length": "mm", "angle": "deg"},
    )
    printed = call("new", "-", "--table", TABLE)
    assert printed.text == document["description"] and "convention: standard" in printed.err
    assert call("new", "-", "--table", TABLE, "-f", "csv").csv[1] == ["-", "-", "", "RRR", "standard", "L3"]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["arm"], "expected a name that ends with .yaml; did you mean arm.yaml?"),
        (["arm.urdf"], "expected a name that ends with .yaml"),
        (["no/such/arm.yaml"], "expected a place that can be written"),
        (["-", "--length", "mm"], "--length is about a table, expected --table"),
        (["-", "--set", "a=1"], "--set is about a table"),
        (["-", "--table", "no.txt"], "no.txt: no such file, expected a table"),
        (["-", "--table", TABLE, "--from", "puma560"], "exclude each other"),
        (["-", "--table", TABLE, "--convention", "craig"], "--convention: found 'craig'"),
        (["-", "--table", TABLE, "--types", "RR"], "expected a letter R, P or F for each of the table's 3 rows"),
        (["-", "--table", TABLE, "--columns", "i,theta,d"], "expected one for each of 6 cells"),
        (["-", "--table", TABLE, "--set", "L9=1"], "the table has no such name, expected L1, L2 or L3"),
        (["-", "--table", TABLE, "--length", "feet"], "--length: found 'feet'"),
        (["-", "--from", "four-bar", "--types", "R"], "--types is about a table"),
        ([], "FILE"),
    ],
)
def test_slips_are_told(call, words, said, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    refused(call("new", *words), said)
    assert not [*tmp_path.iterdir()]


def test_bytes_that_are_no_text(call):
    refused(call("new", "-", "--table", "-", stdin=b"i,theta\xff\xfe"), "standard input: found bytes that are no text")
