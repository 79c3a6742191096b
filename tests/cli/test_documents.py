"""Every document says what it is about, and is what `robokin schema COMMAND` says."""

from __future__ import annotations

import itertools
import json
from functools import cache
from pathlib import Path

import pytest
from jsonschema import Draft202012Validator
from sweeps import sweep

from robokin.formats.library import library_names
from robokin.records.schemas import CHECKS, HOMES, document_schema

from .conftest import invoke

ROOT = Path(__file__).parent.parent.parent
PENDANT, FINGERS, SCREW = (str(ROOT / name) for name in (
    "docs/trees/pendant.yaml", "docs/trees/fingers.yaml", "tests/data/screw.yaml"))  # fmt: skip
TABLE = str(ROOT / "tests/data/pasted_table.txt")
POSE = "Trans(500,100,300) RPY(180,0,45)"
COMMANDS = [
    ["list", "puma"],
    ["validate", "puma560", "four-bar", "car", "no/such.yaml", "nothing"],
    ["show", "puma560"], ["show", "puma560-craig"], ["show", "scara-frames"], ["show", "four-bar"], ["show", "car"],
    ["show", "planetary"], ["show", "omni-three"],
    ["convert", "puma560", "--convention", "modified"], ["convert", "puma560", "--convention", "frames"],
    ["new", "-"], ["new", "-", "--from", "puma560"], ["new", "-", "--table", TABLE],
    ["convert", "human-hand"], ["show", "human-hand", "--tip", "index"],
    ["fk", "puma560", "--q", "home"], ["fk", "puma560", "--q", "home", "--frames", "--as", "euler"],
    ["fk", "human-hand", "--q", "fist"], ["dof", "human-hand"], ["show", "human-hand"],
    ["show", PENDANT], ["show", SCREW], ["show", FINGERS, "--tip", "index"], ["fk", SCREW, "--q", "1,2,3"],
    ["ik", PENDANT, "--xyz", "500,100,700", "--rpy", "180,60,0"], ["ik", SCREW, "--xyz", "500,100,-5"],
    ["ik", PENDANT, "--xyz", "500,100,2700", "--rpy", "180,60,0"], ["plot", SCREW, "--frames"], ["dof", SCREW],
    ["ik", FINGERS, "--tip", "index", "--xyz", "125,45,80", "--hold", "index.pip=52.713"], ["fk", SCREW, "--symbolic"],
    ["path", FINGERS, "--tip", "index", "--from", "0,0,0", "--to", "0,5,6", "--line", "--steps", "3"],
    ["check", "dh", PENDANT, "--against", PENDANT], ["check", "dh", SCREW, "--against", PENDANT],
    ["convert", SCREW, "--convention", "modified"], ["convert", PENDANT, "--convention", "modified"],
    ["jacobian", "planar2r", "--q", "1,2", "--force", "1,2,3"],
    ["path", "planar2r", "--from", "0,10", "--to", "40,20", "--to", "5,5", "--duration", "2", "--steps", "3"],
    ["path", PENDANT, "--from", "0,0,0,0,10,0", "--to", "0,100,0,0,10,0", "--steps", "4"], ["singular", PENDANT],
    ["fk", "planar2r", "--q", "1,2", "--q", "3,4"], ["fk", "anthropomorphic", "--symbolic"],
    ["fk", "anthropomorphic", "--symbolic", "--frames", "--numbers"], ["fk", "puma560", "--q", "0,0,0,0,0,999"],
    ["fk", "scara", "--q", "0,0,0,0", "--length", "in", "--angle", "rad", "--as", "matrix"],
    ["ik", "puma560", "--pose", POSE], ["ik", "puma560", "--pose", POSE, "--no-limits", "--max", "2"],
    ["ik", "puma560", "--pose", POSE, "--explain"], ["ik", "puma560", "--xyz", "9000,0,0"],
    ["ik", "puma560", "--xyz", "500,100,300", "--approach", "0,0,1"], ["ik", "planar2r", "--xy", "1,1"],
    ["ik", "planar3r", "--xyz", "1,1,0"], ["ik", "puma560", "--pose", "Trans(500,100,3000) RPY(180,0,45)"],
    ["ik", "iiwa14", "--pose", "Trans(500,100,600) RPY(180,0,0)", "--max", "3"],
    ["ik", "panda", "--pose", "Trans(400,0,400) RPY(180,0,0)", "--max", "3"],
    ["ik", "panda", "--pose", "Trans(400,0,400) RPY(180,0,0)", "--hold", "q7=20"],
    ["ik", "planar2r", "--xy", "5,5", "--explain"],
    ["ik", "human-hand", "--target", "index=150,30,-60", "--target", "thumb=Trans(120,20,-50)"],
    ["ik", "puma560", "--xyz", "603.7329687947455,257.8443651077811,660.87284679477", "--rpy", "0,50,10"],
    ["workspace", "puma560", "--samples", "64", "--dextrous"], ["workspace", "planar2r", "--samples", "64"],
    ["workspace", "planar3r", "--samples", "64", "--dextrous", "--compare", "planar2r"],
    ["workspace", "spherical", "--samples", "64", "--section", "--slice", "z=0.1"],
    ["workspace", "spherical-wrist", "--samples", "64", "--dextrous"],
    ["workspace", "planar3r", "--at", "1,0.5,0", "--at", "9,0,0"], ["workspace", "puma560", "--at", "300,300,300"],
    ["workspace", "planar2r", "--at", "1,0.5,0"],
    ["dof", "four-bar"], ["dof", "sarrus"], ["dof", "puma560"], ["dof", "car"], ["dof", "differential-drive"],
    ["dof", "four-bar-by-lengths"], ["dof", "four-bar", "--between", "coupler,crank"],
    ["dof", "--links", "7", "--joints", "6R", "--space", "spatial"],
    ["dof", "slider-crank", "--trace", "3", "--point", "rod:1,0"], ["dof", "bennett", "--trace", "2"],
    ["frame", "Trans(1,2,3) Rot(z,90)"], ["frame", "Rot(x,30)", "--point", "1,2,3", "--inverse"], ["frame", ""],
    ["frame", "Rot(x,30)", "--to", "Trans(1,2,3)"], ["frame", "", "--to", ""],
    ["frame", "", "--to", "Trans(1,0,0) Rot(z,30)", "--along", "screw", "--as", "quaternion-xyzw"],
    ["jacobian", "puma560", "--q", "home"], ["jacobian", "planar2r", "--q", "0,0", "--frame", "tool"],
    ["jacobian", "scara", "--q", "0,0,0,0", "--q", "10,20,30,40"],
    ["jacobian", "panda", "--q", "0,0,0,-90,0,90,0", "--task", "position"],
    ["singular", "planar3r"], ["singular", "anthropomorphic", "--task", "position"],
    ["path", "puma560", "--from", "home", "--to", "80,10,90,0,10,0", "--steps", "4"],
    ["path", "planar2r", "--from", "10,20", "--to", "20,40", "--to", "5,60", "--line", "--blend", "0.5"],
    ["path", "scara", "--from", "0,60,100,0", "--to", "40,60,50,60", "--hold", "q2=60", "--steps", "3"],
    ["path", "ur5e", "--from", "0,-90,90,0,90,0", "--pose", "Trans(-491.8,-133.3,487.8) RPY(90,0,90)", "--line"],
    ["path", "planar2r", "--from", "10,20", "--xy", "1,0.5", "--line", "--steps", "3"],
    ["path", "planar2r", "--from", "10,20", "--xy", "9,9", "--line", "--steps", "3"],
    ["path", "puma560", "--from", "home", "--xyz", "-300,700,200", "--line", "--steps", "3"],
    ["path", "puma560", "--from", "Trans(500,300,200)", "--to", "Trans(400,300,200)", "--line", "--steps", "3"],
    ["plot", "puma560"], ["plot", "planar3r", "--q", "30,40,50", "--q", "60,20,10", "--frames"],
    ["plot", "scara", "--ik", "400,200,300"], ["plot", "planar2r", "--ik", "9,9"], ["plot", "bennett"],
    ["plot", "human-hand", "--q", "pinch", "--q", "open", "--frames"],
    ["check", "fk", "puma560", "--q", "home", "--expect", "-149.09, 921.12, 20.32"],
    ["check", "fk", "planar2r", "--q", "90,0", "--expect", "Trans(0,1.6,0)Rot(z,90)"],
    ["check", "fk", "planar2r", "--q", "0,0", "--expect", ""],
    ["check", "ik", "planar2r", "--xy", "1,1", "--q", "10,20"],
    ["check", "ik", "planar2r", "--xy", "5,5", "--q", "none"],
    ["check", "ik", "planar2r", "--xy", "1,1", "--q", "10,20", "--q", ""],
    ["check", "ik", "planar2r", "--xy", "1,1", "--q", ""],
    ["check", "dh", "puma560-craig", "--against", "puma560"], ["check", "dh", "puma560", "--against", "puma560"],
    ["check", "dh", "planar2r", "four-bar", "no/such.yaml", "--against", "puma560"],
    ["check", "dh", "anthropomorphic", "--against", "anthropomorphic", "--set", "a2=0.6"],
    ["check", "jacobian", "planar2r", "--q", "0,90", "--expect", "[[1,2],[1,2],[0,0],[0,0],[0,0],[1,1]]"],
    ["check", "dof", "four-bar", "--expect", "1"], ["check", "dof", "sarrus", "--expect", "1", "--mobility", ""],
    ["check", "dof", "--links", "4", "--joints", "4R", "--space", "planar", "--expect", "1"],
]  # fmt: skip
"""Command lines whose documents are looked at, as JSON and as JSON lines."""

UNITLESS = {("dof", None), ("check", "dof"), ("validate", None)}
"""What may hold no quantities: bare counts, and files that are no descriptions."""


LINED = ("path", "singular", "plot", "check", "dof", "fk", "list", "validate")
"""Commands whose lines of JSON are looked at too: of the others they are the documents of --json."""


def schema_of(words):
    check = words[1] if words[0] == "check" else None
    return document_schema(words[0], check), (words[0], check)


def known_fault(schema, document):
    """What is wrong with a document, by the variant that comes nearest."""
    errors = sorted(Draft202012Validator(schema).iter_errors(document), key=str)
    if not errors:
        return None
    deepest = max(errors[0].context or errors, key=lambda error: len(error.absolute_path))
    return f"{list(deepest.absolute_path)}: {deepest.message[:300]}"


@cache
def answers_to(words):
    """The document of a command line, and its lines of JSON where they are other documents."""
    forms = ["json", *(["jsonl"] if words[0] in LINED else [])]
    answers = [invoke(*words, "-f", form) for form in forms]
    for answer in answers:
        assert answer.status in (0, 2, 3), answer.err
    return [answers[0].json, *(line for answer in answers[1:] for line in answer.jsonl)]


@pytest.mark.parametrize("words", sweep(COMMANDS, 4), ids=lambda words: " ".join(words)[:70])
def test_documents_are_what_their_schema_says(words):
    schema, kind = schema_of(words)
    for document in answers_to(tuple(words)):
        assert known_fault(schema, document) is None
        for one in document if isinstance(document, list) else [document]:
            assert one["schema"] == 1
            assert "id" in one
            assert kind in UNITLESS or set(one["units"]) == {"length", "angle"}


@pytest.mark.parametrize("name", library_names()[::12])
def test_whatever_the_library_holds_is_shown_and_counted_as_the_schemas_say(call, name):
    for command in ("show", "dof", "validate"):
        document = call(command, name, "--json").json
        assert known_fault(document_schema(command), document) is None
        (one,) = [one for one in (document if isinstance(document, list) else [document]) if one["id"] == name]
        assert one["units"]


def test_rows_of_samples_are_documents(call, tmp_path):
    for more in ([], ["--with", "joints,poses"], ["--with", "poses", "--as", "euler"]):
        path = tmp_path / "samples.jsonl"
        call("workspace", "puma560", "--samples", "3", "--output", path, *more)
        for line in path.read_text().splitlines():
            assert known_fault(document_schema("workspace"), json.loads(line)) is None
            assert set(json.loads(line)) <= {"schema", "robot", "id", "units", "position", "q", "pose"}


@pytest.mark.parametrize(("a", "quantity"), [(0, None), (1, "length")])
def test_workspaces_of_a_point_and_of_a_curve_are_documents(call, tmp_path, a, quantity):
    path = tmp_path / "arm.yaml"
    path.write_text(f"robokin: 1\nname: One joint\njoints: [{{type: R, a: {a}}}]\n")
    document = call("workspace", path, "--samples", "64", "--dextrous", "--json").json
    assert known_fault(document_schema("workspace"), document) is None
    assert (quantity or "reach") in document
    assert ("holds" in document["dexterity"]["sets"]["every"]) == (quantity is None)


@pytest.fixture(scope="module")
def sheet_documents(tmp_path_factory):
    """The documents of a sheet that is made, marked and counted, by their kinds."""
    place = tmp_path_factory.mktemp("sheet")
    made = invoke("check", "new", "planar3r-brac", "--questions", "fk,ik,ik-all,dh,jacobian,dof", "--seed", "1", "-o",
                  place / "s", "--json")  # fmt: skip
    form = (place / "s" / "key" / "answers.csv").read_text().replace("practice,1,x,cm,", "practice,1,x,cm,9")
    (place / "a.csv").write_text(form.replace("practice,2,q", "practice,2,"))
    marked = [invoke("check", "sheet", place / "s" / "key", "-i", place / "a.csv", "-f", form, "--feedback", level)
              for form in ("json", "jsonl") for level in ("answer", "verdict")]  # fmt: skip
    slip = ["check", "fk", "puma560", "--q", "home", "--expect", "-0.14909,0.92112,0.02032"]
    (place / "m.jsonl").write_bytes(marked[2].out + invoke(*slip, "-f", "jsonl").out)
    counted = invoke("check", "statistics", place / "m.jsonl", "--json")
    sheets = [marked[0].json, marked[1].json, *marked[2].jsonl, *marked[3].jsonl]
    return {"new": [made.json], "sheet": sheets, "statistics": [counted.json]}


@pytest.mark.parametrize("kind", ["new", "sheet", "statistics"])
def test_documents_about_sheets_are_what_their_schemas_say(sheet_documents, kind):
    schema = document_schema("check", kind)
    for document in sheet_documents[kind]:
        assert known_fault(schema, document) is None
        assert document["schema"] == 1
    promised = {name for _, part in parts(schema) for name in part.get("properties", {})}
    assert promised - set().union(*map(keys_of, sheet_documents[kind])) == set()


def test_marks_of_a_class_are_documents(call, tmp_path):
    answers = tmp_path / "answers.csv"
    answers.write_text("student,id,q1,q2,x,y,z\nana,a,0,0,1.6,0,0\nbo,a,0,0,1,0,\nbo,b,10,x,1,1,1\n")
    for words in (["check", "fk", "planar2r", "-i", answers], ["check", "ik", "planar2r", "-i", answers]):
        for document in answers_to(tuple(words)):
            assert known_fault(document_schema("check", words[1]), document) is None


# The schemas ------------------------------------------------------------------------------------------------------

ALL = [(command, None) for command in HOMES if command != "check"] + [("check", kind) for kind in CHECKS]


@pytest.mark.parametrize(("command", "check"), ALL)
def test_a_schema_is_one_and_describes_every_key(call, command, check):
    schema = call("schema", *filter(None, (command, check))).json
    assert schema == document_schema(command, check)
    Draft202012Validator.check_schema(schema)
    for place, part in parts(schema):
        for name, value in part.get("properties", {}).items():
            assert value.get("description"), f"{place}: {name}"
        if "properties" in part:
            assert part["additionalProperties"] is False, place


def parts(schema, place=""):
    """Every schema within a schema."""
    yield place, schema
    for key in ("properties", "$defs"):
        for name, value in schema.get(key, {}).items():
            yield from parts(value, f"{place}/{name}")
    for key in ("items", "additionalProperties"):
        if isinstance(schema.get(key), dict):
            yield from parts(schema[key], place)
    for value in schema.get("anyOf", []):
        yield from parts(value, place)


def test_a_missing_a_new_and_a_changed_key_are_caught(call):
    document = call("fk", "puma560", "--q", "home", "--json").json
    schema = document_schema("fk")
    assert known_fault(schema, document) is None
    for key, value in itertools.chain(document.items(), [("id", 3)]):
        assert known_fault(schema, {name: one for name, one in document.items() if name != key})
        assert known_fault(schema, {**document, key: None if value != 3 else value})
    assert known_fault(schema, {**document, "more": 1})
    assert known_fault(schema, {**document, "pose": {**document["pose"], "more": 1}})


@pytest.mark.parametrize(("command", "check"), [one for one in ALL if one[1] not in ("new", "sheet", "statistics")])
def test_every_key_of_a_schema_is_in_some_document(command, check):
    """No schema promises what no command writes."""
    schema = document_schema(command, check)
    promised = {name for _, part in parts(schema) for name in part.get("properties", {})}
    written = set()
    for words in COMMANDS:
        if schema_of(words)[1] == (command, check):
            written = written.union(*map(keys_of, answers_to(tuple(words))))
    assert promised - written <= ELSEWHERE.get((command, check), set())


ORIENTATIONS = {"quaternion_xyzw", "rotvec", "abc", "wpr"}
ELSEWHERE = {
    ("fk", None): ORIENTATIONS,
    ("frame", None): ORIENTATIONS,
    ("show", None): {"joint", "ratio", "beside"},  # of couplings, which test_trees and test_couplings have
    ("convert", None): {"joint", "ratio", "beside"},
    ("ik", None): {"jump"},  # of files, which test_ik_near_previous has
    ("plot", None): ORIENTATIONS | {"euler"},
    ("workspace", None): {*ORIENTATIONS, "euler", "rpy", "quaternion", "matrix", "pose", "q", "holds", "length_error"},
    ("check", "fk"): {"student", "students", "line", "approach", "matrix", "task", "relative"},
    ("check", "ik"): {"student", "students", "line", "approach", "matrix", "rpy", "relative"},
    ("check", "dh"): {"student", "students", "line", "relative"},
    ("check", "jacobian"): {"student", "students", "line", "relative"},
    ("check", "dof"): {"student", "students", "line", "position", "angle", "relative"},
    ("serve", None): {"input_id", "status", "notes", "error", "line", "documents"},  # test_serve has them
}
"""Keys that only other options bring: other orientations, samples, files of a class."""


def keys_of(document):
    if isinstance(document, dict):
        return set(document).union(*map(keys_of, document.values()))
    return set().union(*map(keys_of, document)) if isinstance(document, list) else set()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["fkk"], "did you mean 'fk'?"),
        (["check"], "expected fk, ik, dh, jacobian, dof, new, sheet or statistics"),
        (["check", "ikk"], "there is no check 'ikk'"),
        (["fk", "ik"], "only check has kinds"),
        (["check", "ik", "dh"], "expected one command"),
        (["schema"], "there is no schema of 'schema'"),
    ],
)
def test_a_wrong_name_is_said(call, words, said):
    answer = call("schema", *words)
    assert (answer.status, answer.out) == (2, b"")
    assert said in answer.err


def test_truth_values_are_those_of_json_in_every_format(call):
    cells = [
        cell
        for words in (["validate", "puma560", "no/such.yaml"], ["show", "car"], ["dof", "four-bar"], ["dof", "car"],
                      ["ik", "planar2r", "--xy", "1,1"], ["workspace", "planar2r", "--at", "1,0,0"])
        for row in call(*words, "-f", "csv").csv
        for cell in row
    ]  # fmt: skip
    assert "True" not in cells
    assert "False" not in cells
    assert {"true", "false"} <= set(cells)


@pytest.mark.parametrize("level", sweep(["verdict", "part", "distance"], 3))
def test_marks_of_which_less_is_told_are_documents(call, tmp_path, level):
    jacobian = ["jacobian", "planar2r", "--q", "0,90", "--expect", "[[1,2],[1,2],[0,0],[0,0],[0,0],[1,1]]"]
    for words in (
        ["fk", "planar2r", "--q", "0,0", "--expect", "1,2,3"], ["dh", "planar2r", "ur5", "--against", "puma560"],
        ["ik", "planar2r", "--xy", "1,0.5", "--q", "0,0", "--q", "1,1"], jacobian, ["dof", "four-bar", "--expect", "3"],
    ):  # fmt: skip
        for document in answers_to(("check", *words, "--feedback", level)):
            assert known_fault(document_schema("check", words[0]), document) is None


def test_what_is_not_decided_is_a_document(call, tmp_path):
    slow = ",".join(["+".join(["sin(1)"] * 1200)] * 6)
    (tmp_path / "answers.csv").write_text("q1,q2,x,y,z,roll,pitch,yaw\n0,0," + slow + "\n")
    document = call("check", "fk", "planar2r", "-i", tmp_path / "answers.csv", "--budget", "0.01", "--json").json
    assert document["items"][0]["status"] == "not decided"
    assert known_fault(document_schema("check", "fk"), document) is None
