"""`robokin serve`: a question a line in, a document a line out, in order, whatever the line holds."""

from __future__ import annotations

import json
import os
import random
import signal
import subprocess
import sys

import pytest
from jsonschema import Draft202012Validator

from robokin.formats import library
from robokin.quick.questions import LONGEST_LINE
from robokin.records.schemas import document_schema

from .conftest import PROGRAM, environment, refused, strict_json

POSE = "Trans(500,100,300) RPY(180,0,45)"
ARM = "robokin: 1\nname: One joint\njoints: [{type: R, a: 1}]\n"


@pytest.fixture
def ask(call):
    """The answers to some lines."""

    def ask(*lines, end="\n"):
        text = [line if isinstance(line, bytes) else (line if isinstance(line, str) else json.dumps(line)).encode()
                for line in lines]  # fmt: skip
        answer = call("serve", stdin=b"\n".join(text) + end.encode())
        assert (answer.status, answer.err) == (0, "")
        found = [strict_json(line) for line in answer.text.splitlines()]
        validator = Draft202012Validator(document_schema("serve"))
        assert not [error for one in found for error in validator.iter_errors(one)]
        return found

    return ask


def mistake(answer, *fragments, status=2):
    """Whether an answer is an error that says all of this."""
    assert set(answer) <= {"input_id", "error", "status", "line"}
    assert answer["status"] == status
    assert all(fragment in answer["error"] for fragment in fragments), answer
    return True


ASKED = [
    ["fk", "puma560", "--q", "10,20,30,40,50,60"], ["fk", "puma560", "--q", "home", "--angle", "rad"],
    ["fk", "puma560", "--q", "1,2,3,4,5,6", "--frames"], ["fk", "human-hand", "--q", "pinch"],
    ["ik", "puma560", "--pose", POSE], ["ik", "puma560", "--pose", POSE, "--max", "1"],
    ["jacobian", "puma560", "--q", "home"], ["singular", "planar3r"], ["frame", "Trans(1,2,3) Rot(z,90)"],
    ["dof", "four-bar"], ["show", "puma560"], ["show", "car"], ["check", "dof", "four-bar", "--expect", "1"],
    ["check", "fk", "planar2r", "--q", "0,0", "--expect", "1.6,0,0"],
    ["convert", "puma560", "--convention", "modified"],
    ["path", "puma560", "--from", "home", "--to", "80,10,90,0,10,0", "--steps", "4"], ["schema", "fk"],
    ["workspace", "planar2r", "--samples", "64"],
]  # fmt: skip


def test_the_documents_are_those_of_json(call, ask):
    answers = ask(*(" ".join(f"'{word}'" for word in words) for words in ASKED))
    for words, answer in zip(ASKED, answers, strict=True):
        alone = call(*words, "--json")
        assert answer == alone.json, words
        assert alone.status == 0


def test_a_list_of_documents_a_no_and_notes(call, ask):
    several, none, no, noted, wrong = ask(
        "list kuka", "list nothing-at-all", "ik puma560 --xyz 9000,0,0", "fk puma560 --q 500,0,0,0,0,0",
        "check ik planar2r --xy 1,1 --q 10,20",
    )  # fmt: skip
    assert several == {"documents": call("list", "kuka", "--json").json}
    assert none["documents"] == [] and none["status"] == 3 and "nothing-at-all" in none["notes"][0]
    assert no == {"status": 3, **call("ik", "puma560", "--xyz", "9000,0,0", "--json").json}
    assert noted == {
        "notes": ["joint 1 (waist) = 500 deg is outside its limits -160 .. 160"],
        **call("fk", "puma560", "--q", "500,0,0,0,0,0", "--json").json,
    }
    assert wrong["status"] == 3


def test_the_notes_of_a_document_do_not_hide_what_is_said_of_its_description(call, ask, tmp_path):
    """A reach of 600 m is noted on standard error; that a joint is to spare is the document's own note."""
    arm = tmp_path / "arm.yaml"
    rows = "  - {type: P, alpha: 90, limits: [0, 1]}\n" + "  - {type: R, a: 150}\n" * 3
    arm.write_text(f"robokin: 1\nname: Slip\nunits: {{angle: deg}}\njoints:\n{rows}")
    words = ["workspace", str(arm), "--samples", "64"]
    alone = call(*words, "--json")
    said = alone.err.removeprefix("robokin: ").rstrip("\n")
    assert "too large for a machine" in said and alone.json["notes"]
    assert ask(json.dumps({"words": words})) == [{**alone.json, "notes": [said, *alone.json["notes"]]}]


def test_questions_in_json(call, ask):
    """A key is an option: numbers, lists, rows, flags, names with values."""
    questions = [
        ({"command": "fk", "robot": "puma560", "q": [90, 0, 90, 0, 0, 0.5]}, "fk puma560 --q 90,0,90,0,0,0.5"),
        ({"command": "fk", "robot": "puma560", "q": [[0] * 6, [-1.5] * 6]}, "fk puma560 --q 0,0,0,0,0,0 "
         "--q -1.5,-1.5,-1.5,-1.5,-1.5,-1.5"),
        ({"command": "fk", "robot": "puma560", "q": "home", "frames": True, "angle": "rad", "length": None},
         "fk puma560 --q home --frames --angle rad"),
        ({"command": "fk", "robot": "planar2r", "q": [10, 20], "set": {"a2": 0.5}},
         "fk planar2r --q 10,20 --set a2=0.5"),
        ({"command": "fk", "robot": "planar2r", "q": [10, 20], "set": ["a1=1", "a2=2"]},
         "fk planar2r --q 10,20 --set a1=1 --set a2=2"),
        ({"command": "ik", "robot": "puma560", "pose": POSE, "no_limits": True, "max": 2, "turns": False},
         f"ik puma560 --pose '{POSE}' --no-limits --max 2"),
        ({"command": "ik", "robot": "puma560", "matrix": [[1, 0, 0, 500], [0, -1, 0, 100], [0, 0, -1, 300],
                                                          [0, 0, 0, 1]]},
         "ik puma560 --matrix [[1,0,0,500],[0,-1,0,100],[0,0,-1,300],[0,0,0,1]]"),
        ({"command": "ik", "robot": "panda", "pose": "Trans(400,0,400) RPY(180,0,0)", "hold": {"q7": 20}},
         "ik panda --pose 'Trans(400,0,400) RPY(180,0,0)' --hold q7=20"),
        ({"command": "ik", "robot": "human-hand", "target": {"index": [150, 30, -60], "thumb": "Trans(120,20,-50)"}},
         "ik human-hand --target index=150,30,-60 --target thumb=Trans(120,20,-50)"),
        ({"command": "check dof", "arguments": ["four-bar"], "expect": 1}, "check dof four-bar --expect 1"),
        ({"command": "frame", "arguments": ["Rot(x,30)"], "point": [1, 2, 3]}, "frame Rot(x,30) --point 1,2,3"),
        ({"words": ["dof", "four-bar"]}, "dof four-bar"),
    ]  # fmt: skip
    answers = ask(*(asked for asked, _ in questions), *(words for _, words in questions))
    for i, (asked, words) in enumerate(questions):
        assert "error" not in answers[i], answers[i]
        assert answers[i] == answers[i + len(questions)], (asked, words)


@pytest.mark.parametrize("id", [7, -0.5, "a \u2028 b", None, True, [1, {"x": []}], {"id": 1}, "\ud800"])
def test_an_id_comes_back_in_front(ask, id):
    plain, listed, wrong = ask(
        {"id": id, "command": "fk", "robot": "puma560", "q": "home"}, {"command": "list", "id": id},
        {"id": id, "command": "fk"},
    )  # fmt: skip
    for answer in (plain, listed, wrong):
        assert next(iter(answer)) == "input_id"
        assert json.dumps(answer["input_id"]) == json.dumps(id) or id == "\ud800"
    assert plain["id"] == "puma560"


def test_lines_that_ask_nothing_get_nothing(ask):
    assert ask("", "   ", "# fk puma560 --q home", "\t", "\r", "\ufeff") == []
    assert len(ask("\ufefffk puma560 --q home\r", "robokin fk puma560 --q home", "fk puma560 --q home", end="")) == 3


WRONG = {
    "fk puma560 --q 1,2": ("found 2 values", "expected 6"),
    "fk puma --q 1,2": ("no robot or mechanism named 'puma'",),
    "fly puma560": ("there is no command 'fly'",),
    "robokin": ("a command is missing",),
    "--version": ("a command is missing",),
    "fk puma560 --q 'home": ("quotation that does not end",),
    "fk --help": ("no document",),
    "fk puma560 --q home -f csv": ("--json and --format csv exclude each other",),
    "fk puma560 --q -": ("standard input holds the questions",),
    "fk puma560 --input=-": ("standard input holds the questions",),
    "fk puma560 -i /dev/stdin": ("standard input is closed",),
    "fk puma560 --q home -o x.json": ("expected no file to write",),
    "fk puma560 --q home -ox.json": ("expected no file to write",),
    "workspace planar2r --samples 64 --plot x.html": ("expected no file to write",),
    "plot puma560": ("plot draws pictures",),
    "serve": ("served already",),
    "fk no/such.yaml --q 1": ("no such file",),
    "fk / --q 1": ("found a directory",),
    '{"command": "fk"': ("found no JSON at column",),
    '{"command": "fk"} x': ("found no JSON",),
    '{"id": NaN, "command": "fk"}': ("found NaN, expected a finite number",),
    '{"command": "fk", "robot": "puma560", "q": [1e999,0,0,0,0,0]}': ("q: found Infinity",),
    '{"command": 7}': ("a command is missing",),
    '{"command": "fk", "robot": {}}': ("arguments: found {}",),
    '{"command": "fk", "robot": "puma560", "q": [null]}': ("q: found null",),
    '{"command": "fk", "robot": "puma560", "Q x": 1}': ("found the key 'Q x'",),
    '{"command": "fk", "robot": "puma560", "q": "home", "nothing": 1}': ("there is no option '--nothing'",),
    '{"command": "fk", "robot": "puma560", "q": "home", "output": "x.json"}': ("expected no file to write",),
    '{"words": "fk"}': ("words: expected a list",),
    '{"words": ["fk"], "robot": "puma560"}': ("found 'robot' beside words",),
    '{"command": "fk", "robot": "--help", "q": "home"}': ("no robot or mechanism named '--help'",),
    '{"command": "fk", "robot": "puma560", "q": "home", "q": "ready"}': ("found the key 'q' twice",),
    '{"id": {"a": 1, "a": 2}, "words": ["list"]}': ("found the key 'a' twice",),
    '{"id": 1e999, "words": ["list"]}': ("found a number that is too large",),
    '{"id": [{"a": [-1e999]}], "command": "fk"}': ("found a number that is too large",),
    "[1]": ("there is no command '[1]'",),
}


@pytest.mark.parametrize("line", WRONG)
def test_a_mistake_is_a_document(ask, tmp_path, monkeypatch, line):
    monkeypatch.chdir(tmp_path)
    before, wrong, after = ask("fk puma560 --q home", line, "fk puma560 --q home")
    assert mistake(wrong, *WRONG[line])
    assert wrong["line"] == 2
    assert before == after
    assert not [*tmp_path.iterdir()]


def test_bytes_that_are_no_text_and_lines_that_are_too_long(ask):
    deep = b'{"id": ' + b"[" * 100_000
    lines = [b"\xff\xfe", b"\x00", b"fk puma560 --q \xe9", deep, b"a" * (LONGEST_LINE + 1), b"b" * (3 * LONGEST_LINE),
             b"#" * (LONGEST_LINE + 2), b"9" * 5000, b'{"id": ' + b"9" * 5000 + b"}"]  # fmt: skip
    answers = ask(*lines, b"fk puma560 --q home", b" " * LONGEST_LINE)
    assert [answer["line"] for answer in answers[:-1]] == [*range(1, len(lines) + 1)]
    assert all(map(mistake, answers[:-1]))
    assert answers[-1]["robot"] == "puma560"
    assert all(len(json.dumps(answer)) < 2000 for answer in answers)


def test_random_lines_get_an_answer_each(ask):
    rng = random.Random(16)
    words = ["fk", "ik", "puma560", "--q", "home", "0,0,0,0,0,0", "--json", "-f", "{", "}", '"', "'", "\\", "#", "[",
             ":", '{"command":', '"fk"', "check", "list", "--", "-", "é", "\x1b[2J", "\ud800", "-h", "robokin",
             "dof"]  # fmt: skip
    lines = [" ".join(rng.choices(words, k=rng.randint(1, 7))).encode(errors="surrogatepass") for _ in range(300)]
    answers = ask(*lines)
    assert len(answers) == sum(not line.startswith(b"#") or b"\xed" in line for line in lines)
    assert all(answer.get("status", 0) in (0, 2, 3) for answer in answers)
    assert "\x1b" not in json.dumps(answers, ensure_ascii=False)


def test_a_fault_of_one_question_is_not_the_next_one_s(ask, monkeypatch):
    def fail(words):
        raise ZeroDivisionError("by mistake")

    monkeypatch.setattr("robokin.cli.serving._asked", fail)
    broken, fine = ask("dof four-bar", "fk puma560 --q home")
    assert mistake(broken, "the answer failed (ZeroDivisionError: by mistake)", status=1)
    assert fine["robot"] == "puma560"


def test_an_edited_description_is_read_anew(tmp_path):
    """Files and the library's own are kept, but for files that change."""
    arm = tmp_path / "arm.yaml"
    arm.write_text(ARM)
    with serving() as server:
        assert server.asked(f"fk {arm} --q 0")["pose"]["position"][0] == 1.0
        arm.write_text(ARM.replace("a: 1", "a: 2"))
        assert server.asked(f"fk {arm} --q 0")["pose"]["position"][0] == 2.0
        arm.unlink()
        assert mistake(server.asked(f"fk {arm} --q 0"), "no such file")


def test_the_library_s_own_are_read_anew(ask, tmp_path, monkeypatch):
    import shutil

    from robokin.cli.serving import QuestionServer
    from robokin.formats import library_index, plain_robots

    copied = tmp_path / "robots"
    shutil.copytree(library.library_folder(), copied)
    for module in (library, plain_robots, library_index):
        monkeypatch.setattr(module, "library_folder", lambda: copied)
    server = QuestionServer(None, None)
    question = b"fk puma560 --q 0,0,0,0,0,0"
    first = server.answer(question)
    assert server.answer(question) == first
    assert [*server.known] == ["puma560"]
    path = copied / "arms" / "puma560.yaml"
    path.write_text(path.read_text().replace("431.8", "431.9"))
    assert server.answer(question) != first
    assert not server.known


@pytest.mark.parametrize("arm", ["puma560", "planar2r"])
def test_what_is_found_out_of_an_arm_is_found_out_once(ask, monkeypatch, arm):
    """The second question about an arm of the library knows how it is solved."""
    from robokin.inverse import analysis

    asked = []
    analyse = analysis.analyse
    monkeypatch.setattr(analysis, "analyse", lambda *told: asked.append(told) or analyse(*told))
    question = f"ik {arm} --pose Trans(0.3,0.2,0)"
    first, second = ask(question, question)
    assert len(asked) == 1
    assert first == second


@pytest.mark.parametrize("number", [10**400, -(10**400), 10**3000])
def test_whole_numbers_of_any_length_are_read(ask, number):
    """JSON has no greatest number: what is too much for an option is a mistake of the question."""
    for question in ({"command": "fk", "robot": "planar2r", "q": [number, 0]},
                     {"command": "ik", "robot": "planar2r", "xy": "1,0.3", "max": number}):  # fmt: skip
        (answer,) = ask(json.dumps(question))
        assert answer["status"] == 2, answer


class serving:  # noqa: N801 - read as `with serving()`
    """A server in a process of its own."""

    def __enter__(self):
        self.process = subprocess.Popen(
            [*PROGRAM, "serve"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=environment(),
        )
        return self

    def __exit__(self, *error):
        self.process.kill()
        self.process.communicate()

    def asked(self, line):
        self.process.stdin.write(line.encode() + b"\n")
        self.process.stdin.flush()
        return strict_json(self.process.stdout.readline().decode())


def test_each_answer_comes_before_the_next_question():
    with serving() as server:
        for k in range(5):
            assert (
                server.asked(json.dumps({"id": k, "command": "fk", "robot": "puma560", "q": "home"}))["input_id"] == k
            )
        out, err = server.process.communicate()
        assert (out, err, server.process.returncode) == (b"", b"", 0)


@pytest.mark.skipif(os.name == "nt", reason="signals as POSIX has them")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_request_to_end_ends_it(number):
    with serving() as server:
        server.asked("fk puma560 --q home")
        server.process.send_signal(number)
        server.process.stdin.flush()
        assert server.process.wait(10) == 128 + number


def test_who_reads_no_more_ends_it_quietly():
    with serving() as server:
        server.process.stdout.close()
        server.process.stdin.write(b"fk puma560 --q home\n" * 3)
        server.process.stdin.close()
        assert server.process.wait(20) == 0
        assert server.process.stderr.read() == b""
        server.process.stdin, server.process.stdout = None, None


def test_closed_streams(run):
    for closed, sentence in (("<&-", "standard input is closed"), (">&-", "standard output is closed")):
        done = subprocess.run(
            ["sh", "-c", f'exec "$@" {closed}', "sh", *PROGRAM, "serve"], input=None if "<" in closed else b"fk\n",
            env=environment(), capture_output=True, check=False,
        )  # fmt: skip
        assert done.returncode == 2
        assert sentence in done.stderr.decode()


def test_arguments_are_refused(call):
    refused(call("serve", "puma560"), "found 'puma560' at the end")
    assert sys.stdin is not None
