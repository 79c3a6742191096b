"""`robokin check new`, `sheet` and `statistics`: a class from the numbers to the statistics."""

from __future__ import annotations

import csv
import io
import json
import os
import re
import shutil
import subprocess
import sys
import zipfile
from xml.etree import ElementTree

import numpy as np
import pytest

import robokin
from robokin.grading.answers.sheet_keys import read_sheet_key
from robokin.tables.written_rows import no_formula

from .conftest import invoke, refused

STUDENTS = "student,mail\nada,a@x\nben,b@x\n=cmd(),c\n../../etc,d\nZoë,e\n"
KINDS = "fk,ik,ik-all@planar2r,dh@scara,jacobian@planar2r,dof"


@pytest.fixture
def class_(tmp_path):
    path = tmp_path / "class.csv"
    path.write_text(STUDENTS)
    return path


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A sheet that is made once."""
    place = tmp_path_factory.mktemp("sheets") / "week3"
    students = place.parent / "class.csv"
    students.write_text(STUDENTS)
    answer = invoke("check", "new", "puma560", "planar3r-brac", "--questions", KINDS, "--students", students, "--seed",
                    "7", "-o", place)  # fmt: skip
    assert answer.status == 0, answer.err
    return place


@pytest.fixture
def sheet(tmp_path, made):
    """The folder of a sheet of five students."""
    return shutil.copytree(made, tmp_path / "week3")


def rows(text):
    return list(csv.DictReader(io.StringIO(text)))


def written(path, lines):
    with path.open("w", newline="") as stream:
        writer = csv.DictWriter(stream, lines[0])
        writer.writeheader()
        writer.writerows(lines)
    return path


def right_lines(sheet, student=None):
    lines = rows((sheet / "key" / "answers.csv").read_text())
    return [line for line in lines if student in (None, line["student"])]


# Making -----------------------------------------------------------------------------------------------------------


def test_a_sheet_has_a_folder_for_each_student_and_a_key_apart(sheet):
    folders = sorted(path.name for path in (sheet / "students").iterdir())
    assert len(folders) == 5
    assert {"ada", "ben"} <= set(folders)
    for folder in (sheet / "students").iterdir():
        assert {path.name for path in folder.iterdir()} == {
            "questions.md", "questions.tex", "answers.csv", "puma560.svg", "planar3r-brac.svg", "planar2r.svg",
        }  # fmt: skip
        assert {line["answer"] for line in rows((folder / "answers.csv").read_text())} == {""}
    assert {path.name for path in (sheet / "key").iterdir()} == {
        "sheet.json",
        "questions.jsonl",
        "answers.csv",
        "robots",
    }
    assert not [path for path in sheet.parent.rglob("*") if ".part" in path.name]


def test_nothing_of_a_name_is_markup_or_a_formula(sheet):
    for path in (sheet / "students").rglob("*"):
        if path.suffix == ".csv":
            for line in rows(path.read_text()):
                assert line["student"][0].isalnum()
    folder = next(path for path in (sheet / "students").iterdir() if path.name.startswith("cmd"))
    assert (folder / "questions.md").read_text().startswith("# week3: =cmd()")
    assert r"\section*{week3: =cmd()}" in (folder / "questions.tex").read_text()


def test_names_of_students_are_text_in_latex_and_markdown(call, tmp_path):
    (tmp_path / "class.csv").write_text('student\n"\\input{/etc/passwd} $x$ <script>*a*"\n')
    assert call("check", "new", "planar2r", "--students", tmp_path / "class.csv", "--seed", "1", "-o",
                tmp_path / "s").status == 0  # fmt: skip
    (folder,) = (tmp_path / "s" / "students").iterdir()
    tex, md = (folder / "questions.tex").read_text(), (folder / "questions.md").read_text()
    assert r"\input" not in tex
    assert r"\textbackslash{}input\{/etc/passwd\} \$x\$" in tex
    assert "<script>" not in md.replace(r"\<script\>", "")


def test_the_same_seed_is_the_same_bytes(call, tmp_path, class_, sheet):
    (tmp_path / "again").mkdir()
    place = tmp_path / "again" / "week3"
    call("check", "new", "puma560", "planar3r-brac", "--questions", KINDS, "--students", class_, "--seed", "+07", "-o",
         f"{place}/")  # fmt: skip
    before, after = (
        {str(path.relative_to(root)): path.read_bytes() for path in root.rglob("*") if path.is_file()}
        for root in (sheet, place)
    )
    assert before == after


@pytest.mark.parametrize("seed", ["-1", "0", str(10**60)])
def test_any_whole_number_is_a_seed(call, tmp_path, seed):
    answer = call("check", "new", "planar2r", f"--seed={seed}", "-o", tmp_path / "s", "--json")
    assert answer.json["seed"] == seed


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (["--seed", "x"], "--seed: found 'x'"), ([], "--seed: found none"), (["--seed", "1.5"], "whole number"),
        (["--seed", "1", "--questions", "fkk"], "did you mean 'fk'?"),
        (["--seed", "1", "--points", "3"], "--autograder"), (["--seed", "1", "--moodle", "q.txt"], "ends with .xml"),
        (["--seed", "1", "--questions", "ik-all@panda"], "infinitely"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said_before_anything_is_written(call, tmp_path, more, said):
    refused(call("check", "new", "planar2r", "-o", tmp_path / "s", *more), said)
    assert not (tmp_path / "s").exists()


def test_what_is_there_is_not_written_over(call, tmp_path, sheet):
    before = (sheet / "key" / "sheet.json").read_bytes()
    refused(call("check", "new", "planar2r", "--seed", "1", "-o", sheet), "is there already")
    quiz = tmp_path / "quiz.xml"
    quiz.write_text("mine")
    refused(call("check", "new", "planar2r", "--seed", "1", "-o", tmp_path / "s", "--moodle", quiz), "is there already")
    assert (sheet / "key" / "sheet.json").read_bytes() == before
    assert quiz.read_text() == "mine"
    assert not (tmp_path / "s").exists()


@pytest.mark.parametrize("place", [".", "/", "", "..", "a\0b"])
def test_a_name_that_is_no_new_folder_is_refused(call, tmp_path, monkeypatch, place):
    monkeypatch.chdir(tmp_path)
    answer = call("check", "new", "planar2r", "--seed", "1", "-o", place)
    assert (answer.status, answer.out) == (2, b"")
    assert not [*tmp_path.iterdir()]


def test_a_folder_that_cannot_be_made_is_said(call, tmp_path):
    (tmp_path / "file").write_text("")
    answer = call("check", "new", "planar2r", "--seed", "1", "-o", tmp_path / "file" / "s")
    assert answer.status == 2
    assert "Traceback" not in answer.err


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("student\n", "header alone"), ("", "found nothing"), ("who\nada\n", "column student"),
        ("student\nada\nben\nada\n", "a second time (line 2)"), ("student\nada\n\n,\n", "1"),
        ("student,x\n,1\n", "found no student"), ("student\n" + "a" * 201 + "\n", "200 characters"),
        ('student\n"a\nb"\n', "can be seen"), ("student\na\u202eb\n", "can be seen"),
        ("1,2\n3,4\n", "column student"),
    ],
)  # fmt: skip
def test_a_class_that_is_none_is_refused(call, tmp_path, text, said):
    path = tmp_path / "class.csv"
    path.write_text(text)
    answer = call("check", "new", "planar2r", "--students", path, "--seed", "1", "-o", tmp_path / "s")
    assert answer.status == 2
    assert said in answer.err
    assert not (tmp_path / "s").exists()


def test_a_robot_of_ones_own_in_other_units(call, tmp_path):
    (tmp_path / "my arm.yaml").write_text(
        "robokin: 1\nname: mine\nunits: {length: in, angle: rad}\njoints:\n"
        "  - {type: R, d: 12, alpha: -pi/2, limits: [-2, 2]}\n  - {type: R, a: 10}\n  - {type: P, limits: [1, 9]}\n"
    )
    place = tmp_path / "s"
    answer = call(
        "check", "new", tmp_path / "my arm.yaml", "--questions", "fk,ik,dh,jacobian", "--seed", "1", "-o", place
    )
    assert answer.status == 0, answer.err
    marks = call("check", "sheet", place / "key", "-i", place / "key" / "answers.csv", "--json")
    assert (marks.status, marks.json["score"]) == (0, 1.0)


# Marking ----------------------------------------------------------------------------------------------------------


def test_the_key_marks_itself(call, sheet):
    answer = call("check", "sheet", sheet / "key", "-i", sheet / "key" / "answers.csv", "--json")
    assert answer.status == 0
    assert answer.json["passed"] == answer.json["total"] == 30
    assert {one["student"] for one in answer.json["students"]} == {"ada", "ben", "=cmd()", "../../etc", "Zoë"}
    assert {item["score"] for item in answer.json["items"]} == {1.0}


def test_what_is_handed_out_and_handed_back_is_marked(call, sheet, tmp_path):
    """Forms that nobody filled in are blank; in a folder each is its student's."""
    answer = call("check", "sheet", sheet / "key", "-i", sheet / "students", "--json")
    assert answer.status == 3
    assert {item["status"] for item in answer.json["items"]} == {"blank"}
    empty = written(tmp_path / "few.csv", right_lines(sheet, "ada")[:1])
    items = call("check", "sheet", sheet / "key", "-i", empty, "--json").json["items"]
    assert [item["status"] for item in items].count("missing") == 29
    assert items[0]["status"] == "blank"  # one number of six is no pose


def test_nobody_answers_for_somebody_else(call, sheet, tmp_path):
    folder = tmp_path / "in"
    (folder / "ada").mkdir(parents=True)
    written(folder / "ada" / "answers.csv", right_lines(sheet, "ada"))
    stolen = [line | {"student": "ada", "answer": "9"} for line in right_lines(sheet, "ben")]
    written(folder / "ben.csv", stolen)
    written(folder / "other.csv", stolen)
    answer = call("check", "sheet", sheet / "key", "-i", folder, "--json")
    passed = {one["student"]: one["passed"] for one in answer.json["students"]}
    assert passed["ada"] == 6
    assert passed["ben"] == 0
    assert "this is the file of ben" in answer.err
    (folder / "ben").mkdir()
    written(folder / "ben" / "ada.csv", right_lines(sheet, "ada"))  # whose folder it is counts, not what is in it
    (folder / "ada" / "answers.csv").unlink()
    again = call("check", "sheet", sheet / "key", "-i", folder, "--json").json
    assert {one["student"]: one["passed"] for one in again["students"]}["ada"] == 0
    assert "ada has a file" in answer.err


def test_lines_that_say_two_things_are_one_wrong_answer(call, sheet, tmp_path):
    lines = right_lines(sheet, "ada")
    twice = written(tmp_path / "a.csv", [*lines, lines[0] | {"answer": "123"}, lines[-1], lines[-2] | {"answer": ""}])
    items = call("check", "sheet", sheet / "key", "-i", twice, "--student", "ada", "--json").json["items"]
    assert [item["status"] for item in items] == ["bad line", *["pass"] * 5]
    assert "found two answers for x" in items[0]["detail"]


@pytest.mark.parametrize("junk", ["nan", "inf", "x", "1e99", "=1+1", "--", "1;2", "\u202e1", "9" * 400, "'"])
def test_any_answer_is_marked(call, sheet, tmp_path, junk):
    lines = [line | {"answer": junk} for line in right_lines(sheet, "ada")]
    answer = call(
        "check", "sheet", sheet / "key", "-i", written(tmp_path / "a.csv", lines), "--student", "ada", "--json"
    )
    assert answer.status == 3
    assert answer.json["passed"] == 0
    assert len(answer.json["items"]) == 6


def test_decimal_commas_are_numbers(call, sheet, tmp_path):
    lines = right_lines(sheet, "ada")
    text = "\n".join([";".join(lines[0]), *(";".join(v.replace(".", ",") for v in line.values()) for line in lines)])
    (tmp_path / "a.csv").write_text(text + "\n")
    assert call("check", "sheet", sheet / "key", "-i", tmp_path / "a.csv", "--student", "ada").status == 0


def test_columns_that_are_not_there_and_keys_that_are_none_are_said(call, sheet, tmp_path):
    (tmp_path / "a.csv").write_text("student,id\nada,1\n")
    refused(call("check", "sheet", sheet / "key", "-i", tmp_path / "a.csv"), "expected quantity as well")
    refused(call("check", "sheet", sheet, "-i", tmp_path / "a.csv"), "found no sheet.json")
    refused(call("check", "sheet", sheet / "key"), "--input is missing")
    refused(
        call("check", "sheet", sheet / "key", "-i", tmp_path / "a.csv", "--student", "eve"),
        "--student: found 0 students",
    )
    for name, text in (
        ("sheet.json", "[]"),
        ("sheet.json", "{"),
        ("questions.jsonl", "{}\n"),
        ("questions.jsonl", "x"),
    ):
        kept = (sheet / "key" / name).read_text()
        (sheet / "key" / name).write_text(text)
        answer = call("check", "sheet", sheet / "key", "-i", tmp_path / "a.csv")
        assert (answer.status, "Traceback" in answer.err) == (2, False), answer.err
        (sheet / "key" / name).write_text(kept)


def test_feedback_and_partial_credit(call, sheet, tmp_path):
    lines = right_lines(sheet, "ada")
    wrong = [line | {"answer": str(float(line["answer"]) / 1000)} if line["unit"] == "mm" else line for line in lines]
    path = written(tmp_path / "a.csv", wrong)
    words = ["check", "sheet", sheet / "key", "-i", path, "--student", "ada", "--json"]
    items = call(*words).json["items"]
    assert items[0]["mistake"] == "length unit"
    assert items[0]["score"] == 0.5
    assert call(*words, "--partial", "0.8").json["items"][0]["score"] == 0.8
    right = lines[0]["answer"]
    for level in ("verdict", "part", "distance"):
        document = call(*words, "--feedback", level).json
        assert right not in json.dumps([item | {"got": None} for item in document["items"]])
        assert {item["expected"] for item in document["items"]} == {None}


def test_a_decimal_comma_between_commas_is_named(call, sheet, tmp_path):
    lines = [line | {"answer": "1,234"} for line in right_lines(sheet, "ada") if line["id"] == "1"]
    page = call("check", "sheet", sheet / "key", "-i", written(tmp_path / "a.csv", lines), "--student", "ada").text
    assert "found a decimal comma, expected a point (in '1,234')" in " ".join(page.split())


def test_no_spreadsheet_runs_a_name_in_marks(call, sheet):
    words = ("check", "sheet", sheet / "key", "-i", sheet / "key" / "answers.csv")
    names = {row[1] for row in call(*words, "-f", "csv").csv[1:]}
    assert "'=cmd()" in names
    assert not [name for name in names if name[0] in "=+-@"]
    assert "=cmd()" in {item["student"] for item in call(*words, "--json").json["items"]}


@pytest.mark.parametrize(
    ("cell", "said"),
    [("=1", "'=1"), ("@x", "'@x"), ("-x", "'-x"), ("\t=1", "'\t=1"), ("-1.5", "-1.5"), ("+1e3", "+1e3"),
     (-1.5, -1.5), (None, None), ("", ""), ("a=1", "a=1")],
)  # fmt: skip
def test_what_begins_like_a_formula_and_is_no_number_is_text(cell, said):
    assert no_formula(cell) == said


def test_statistics_count_slips(call, sheet, tmp_path):
    lines = [
        line | {"answer": str(np.radians(float(line["answer"])))}
        if line["id"] == "2" and line["student"] in ("ada", "ben") else line
        for line in right_lines(sheet)
    ]  # fmt: skip
    marks = tmp_path / "marks.jsonl"
    call("check", "sheet", sheet / "key", "-i", written(tmp_path / "all.csv", lines), "-o", marks)
    found = call("check", "statistics", marks, "--json").json
    assert found["answers"] == 30
    (mistake,) = found["mistakes"]
    assert (mistake["mistake"], mistake["answers"], mistake["students"]) == ("angle unit", 2, 2)
    assert mistake["questions"] == [{"id": "2", "answers": 2}]
    assert [one["right"] for one in found["questions"]] == [5, 3, 5, 5, 5, 5]
    table = call("check", "statistics", marks, "-f", "csv").csv
    assert table[0] == ["id", "kind", "about", "answers", "right", "unanswered", "score", "angle unit"]
    assert [row[-1] for row in table[1:]] == ["0", "2", "0", "0", "0", "0"]
    assert "angle unit (2)" in call("check", "statistics", marks).text
    page = call("check", "sheet", sheet / "key", "-i", tmp_path / "all.csv").text
    assert "28 of 30 answers right" in page


def test_statistics_read_marks_of_any_check(call, tmp_path):
    marks = tmp_path / "marks.json"
    call("check", "fk", "puma560", "--q", "home", "--expect", "-0.14909,0.92112,0.02032", "-o", marks)
    found = call("check", "statistics", marks, marks, "--json").json
    assert [one["kind"] for one in found["questions"]] == ["fk"]
    assert found["mistakes"][0]["mistake"] == "length unit"
    for text in ("", "x", "[]", "{}", '{"items": 3}', '{"id": 1, "status": 2, "score": 7}', "3\n4"):
        marks.write_text(text)
        refused(call("check", "statistics", marks), "expected the .json or .jsonl")


# Gradescope and Moodle --------------------------------------------------------------------------------------------

GRADESCOPE = {"score": float, "output": str, "tests": list}
"""Keys of results.json that are written, as Gradescope's Autograder specifications name them."""

TEST = {"name": str, "score": float, "max_score": float, "status": str, "output": str}


@pytest.fixture
def autograder(call, tmp_path, class_):
    """An autograder unpacked as Gradescope does, and the folder of its sheet."""
    place, archive = tmp_path / "w", tmp_path / "grader.zip"
    answer = call("check", "new", "puma560", "--questions", "fk,ik,dof", "--students", class_, "--seed", "7",
                  "-o", place, "--autograder", archive, "--points", "30", "--partial", "0.5")  # fmt: skip
    assert answer.status == 0, answer.err
    root = tmp_path / "autograder"
    (root / "submission").mkdir(parents=True)
    with zipfile.ZipFile(archive) as packed:
        packed.extractall(root / "source")
        modes = {one.filename: one.external_attr >> 16 & 0o777 for one in packed.infolist()}
    assert modes["setup.sh"] == modes["run_autograder"] == 0o755
    return root, place


def run_autograder(root, *users):
    (root / "submission_metadata.json").write_text(json.dumps({"id": 1, "users": list(users)}))
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    environment |= {"AUTOGRADER": str(root), "PYTHON": sys.executable}
    subprocess.run(["sh", str(root / "source" / "run_autograder")], env=environment, check=True)
    return json.loads((root / "results" / "results.json").read_text())


@pytest.mark.skipif(sys.platform == "win32", reason="a shell")
def test_an_autograder_marks_a_submission(autograder):
    root, place = autograder
    lines = right_lines(place, "ada")
    lines = [line | {"answer": str(float(line["answer"]) / 1000)} if line["unit"] == "mm" else line for line in lines]
    written(root / "submission" / "my answers.csv", lines)
    # what a student hands in is never run or imported
    (root / "submission" / "robokin.py").write_text("raise SystemExit('run')")
    found = run_autograder(root, {"email": "ada@uni.example", "id": 5, "name": "Ada"})
    assert {name: type(value) for name, value in found.items()} == GRADESCOPE
    assert [{name: type(value) for name, value in test.items()} for test in found["tests"]] == [TEST] * 3
    assert [test["status"] for test in found["tests"]] == ["failed", "passed", "passed"]
    assert found["score"] == pytest.approx(25.0)
    assert sum(test["max_score"] for test in found["tests"]) == pytest.approx(30.0)
    assert "in m, expected mm" in found["tests"][0]["output"]


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="a shell")
def test_a_submission_of_nobody_in_the_class_is_told_so(autograder):
    root, _ = autograder
    nobody = run_autograder(root, {"email": "eve@uni.example", "id": 6, "name": "Eve"})
    assert nobody["score"] == 0.0
    assert "expected one" in nobody["output"]
    (root / "submission" / "answers.csv").write_bytes(b"\xff\xfe" + "student,id".encode("utf-16-le"))
    unread = run_autograder(root, {"email": "ada@uni.example", "id": 5, "name": "Ada"})
    assert (unread["score"], len(unread["tests"])) == (0.0, 3)
    assert "answers.csv" in unread["output"]
    assert "not marked" in unread["output"]


def gaps(text):
    """The gaps of a cloze question: the values that are right, each with its tolerance."""
    return [
        [tuple(map(float, one.split(":"))) for one in gap.removeprefix("=").split("~=")]
        for gap in re.findall(r"\{1:NUMERICAL:([^}]*)\}", text)
    ]


def test_a_moodle_quiz_is_xml_whose_gaps_hold_the_key(call, tmp_path, class_):
    class_.write_text('student\nada\n"<b>&amp; ]]>"\n')
    place, quiz = tmp_path / "w", tmp_path / "quiz.xml"
    answer = call("check", "new", "puma560", "--questions", "fk,ik:2,dh,ik-all,jacobian,dof", "--students", class_,
                  "--seed", "7", "-o", place, "--moodle", quiz)  # fmt: skip
    assert answer.status == 0
    assert "question 4 (dh) is not in the quiz: several tables are right" in answer.text
    root = ElementTree.parse(quiz).getroot()
    assert root.tag == "quiz"
    categories = [one.findtext("category/text") for one in root.findall("question[@type='category']")]
    assert categories == [f"$course$/w/question {i}" for i in (1, 2, 3, 6, 7)]
    names = [one.findtext("name/text") for one in root.findall("question[@type='cloze']")]
    assert "w 1 <b>&amp; ]]>" in names
    assert root.find(".//file").get("name") == "puma560.svg"
    # One solution is meant, and joint values are compared one by one: the text says nothing else.
    texts = [one for one in root.itertext() if "is to be at" in one]
    assert texts
    assert all("each angle may be off by 0.1 deg" in one.casefold() for one in texts)
    assert not any("any solution" in one or "lead to" in one for one in texts)
    key = read_sheet_key(str(place / "key"))
    for one in root.findall("question[@type='cloze']"):
        _, id, student = one.findtext("name/text").split(" ", 2)
        exercise, given = key.exercises[id], key.numbers[student, id]
        found = gaps(one.findtext("questiontext/text"))
        assert len(found) == len(exercise.quantities(given))
        if exercise.kind == "ik":
            robot = exercise.robot
            q = np.radians([gap[0][0] for gap in found])
            T = robokin.forward_kinematics(robot, q)
            assert robokin.check_configuration(robot, exercise.question(given).T, q).right
            assert np.allclose(T[:3, 3], [given[name] / 1000 for name in "xyz"], atol=1e-4)
        else:
            for gap, answer_ in zip(found, exercise.answers(given), strict=True):
                assert min(abs(value - float(answer_)) for value, _ in gap) < 1e-9
                assert all(far >= 0 for _, far in gap)


def test_python_makes_marks_and_counts_a_sheet_as_the_shell_does(call, tmp_path, class_):
    place, quiz, archive = tmp_path / "week3", tmp_path / "q.xml", tmp_path / "a.zip"
    made = call("check", "new", "planar3r-brac", "--questions", "fk,ik-all,dof", "--students", class_, "--seed", "7",
                "-o", place, "--moodle", quiz, "--autograder", archive, "--points", "30", "--json")  # fmt: skip
    students = [one["student"] for one in csv.DictReader(class_.read_text().splitlines())]
    sheet = robokin.question_sheet("planar3r-brac", "fk,ik-all,dof", seed=7, students=students, name="week3")
    assert sheet.files() == {
        path.relative_to(place).as_posix(): path.read_bytes() for path in place.rglob("*") if path.is_file()
    }
    with pytest.warns(UserWarning, match=r"question 2 \(ik-all\) is not in the quiz"):
        assert sheet.moodle() == quiz.read_bytes()
    assert sheet.autograder(points=30) == archive.read_bytes()
    others = {"moodle": str(quiz), "autograder": str(archive)}
    assert sheet.record(str(place)) | others == json.loads(made.text)
    # Robots that are loaded already, and a sheet for nobody in particular.
    again = robokin.question_sheet(
        [robokin.load("planar3r-brac"), robokin.load_mechanism("four-bar")], "fk,dof", seed=7
    )
    assert (again.students, [one["about"] for one in again.questions]) == (("practice",), ["planar3r-brac", "four-bar"])

    answers = place / "key" / "answers.csv"
    lines = [*csv.DictReader(answers.read_text().splitlines())]
    lines[0]["answer"] = str(float(lines[0]["answer"]) / 100)
    written(answers, [*lines, lines[0] | {"id": "9"}])
    with pytest.warns(UserWarning, match="there is no question '9'; not marked"):
        marks = robokin.mark_sheet(place / "key", [answers], partial=0.5, budget=None)
    marked = call("check", "sheet", place / "key", "-i", answers, "--partial", "0.5", "--json")
    assert marks.record() == json.loads(marked.text)
    (tmp_path / "m.json").write_text(marked.text)
    counted = json.loads(call("check", "statistics", tmp_path / "m.json", "--json").text)
    assert robokin.statistics_of(tmp_path / "m.json").record() == counted
    assert robokin.statistics_of(marks).record() | {"id": counted["id"], "file": counted["file"]} == counted
