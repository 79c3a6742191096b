"""`robokin check new`: questions with other numbers for each student, and their key."""

from __future__ import annotations

import re
from typing import Annotated

import typer

from robokin.cli.completion import robots
from robokin.cli.option_groups import OptionGroup
from robokin.cli.options import FormatOption, JsonOption, option, output_format
from robokin.cli.statuses import DONE, say
from robokin.errors import InputError, shown

SEED = re.compile(r"[+-]?[0-9]{1,100}")


class SheetPlaces(OptionGroup):
    """Where the files of a sheet go."""

    output: Annotated[str | None, option("--output -o", "FOLDER", "The folder to make, such as week3/.")] = None
    moodle: Annotated[str | None, option("--moodle", "FILE", "Also write the questions as a Moodle quiz (XML).")] = None
    autograder: Annotated[
        str | None, option("--autograder", "FILE", "Also write the .zip of a Gradescope autograder.")
    ] = None
    partial: Annotated[
        str | None, option("--partial", "SCORE", "With --autograder: the least score of a known mistake.")
    ] = None
    points: Annotated[
        str | None, option("--points", "P", "With --autograder: total points.  [default: 1 a question]")
    ] = None


def command(
    things: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="ROBOT...", help="Robots and, for dof, mechanisms: library names or paths; taken in turn.",
            autocompletion=robots, show_default=False,
        ),
    ] = None,
    *,
    questions: Annotated[
        str | None,
        option(
            "--questions", "KINDS",
            "Kinds with counts: fk:2,ik,ik-all,dh,jacobian,dof:2; about one robot fk@puma560.  [default: fk]",
        ),
    ] = None,
    students: Annotated[
        str | None, option("--students", "FILE", "A CSV of the class with a column student.  [default: one sheet]")
    ] = None,
    seed: Annotated[str | None, option("--seed", "N", "A whole number: the same one gives the same sheet.")] = None,
    places: SheetPlaces,
    format: FormatOption = None,
    json: JsonOption = False,
) -> int:  # fmt: skip
    """A sheet of questions with other numbers for each student, and its key.

    Each student's folder has the questions in Markdown and LaTeX, with the robots' tables and sketches, and the form
    answers.csv; the key is in a folder of its own, for robokin check sheet. The numbers follow from the seed, the
    student and the question's number alone. No question is degenerate: all solutions are well apart, away from limits
    and from singular configurations. ik asks for any solution, ik-all for all of them, dh for the table of an arm
    like the robot with other lengths and twists, dof for Grübler's count of a mechanism like the one named (or one of
    the library). What is there is not written over.

    Examples:
        robokin check new puma560 --students class.csv --seed 7 -o week3/
        robokin check new planar2r --questions ik-all,dh,dof@six-bar --seed 7 -o w/
        robokin check new arm.yaml --seed 7 -o w4/ --moodle q.xml --autograder a.zip
    """
    from robokin.cli.arguments import load_entry
    from robokin.cli.check_options import plain_number
    from robokin.grading.answers.class_list import class_list
    from robokin.grading.answers.sheet_subjects import sheet_exercises
    from robokin.grading.questions.sheets import drawn_sheet, wanted_questions
    from robokin.records.sheet_records import new_sheet_record
    from robokin.reports.autograder_files import autograder_options, autograder_zip
    from robokin.reports.moodle_quiz import moodle_quiz
    from robokin.reports.new_sheet_page import new_sheet_page
    from robokin.reports.sheet_files import key_only, sheet_files, sheet_name
    from robokin.tables.folder_sink import expect_new_file, expect_new_folder, write_folder
    from robokin.tables.sink import sink
    from robokin.tables.written_rows import csv_records, written

    chosen = output_format(format, json) or "table"
    if seed is None or not SEED.fullmatch(seed.strip()):
        found = "none" if seed is None else f"'{shown(seed)}'"
        raise InputError(f"--seed: found {found}, expected a whole number; the same one gives the same sheet")
    if places.output is None:
        raise InputError("--output is missing, expected the name of a new folder")
    for name in ("partial", "points") if places.autograder is None else ():
        if getattr(places, name) is not None:
            raise InputError(f"--{name} is about the autograder, expected --autograder FILE with it")
    for name in ("partial", "points"):
        plain_number(getattr(places, name), f"--{name}")
    for path, ending, name in ((places.moodle, ".xml", "--moodle"), (places.autograder, ".zip", "--autograder")):
        if path is not None:
            expect_new_file(path, ending, name)
    folder = expect_new_folder(places.output, "--output")
    wanted = wanted_questions(questions or "fk")
    exercises = sheet_exercises(wanted, things or [], lambda one: load_entry(one, {}))
    class_ = class_list(students, say) if students is not None else ["practice"]
    sheet, name = drawn_sheet(exercises, class_, str(int(seed))), sheet_name(folder)
    notes: list[str] = []
    write_folder(folder, sheet_files(sheet, name), "--output")
    if places.moodle is not None:
        quiz, notes = moodle_quiz(sheet, name)
        with sink(places.moodle, "--moodle") as stream:
            stream.write(quiz)
    if places.autograder is not None:
        options = autograder_options(plain_number(places.partial, "--partial"), plain_number(places.points, "--points"))
        with sink(places.autograder, "--autograder") as stream:
            stream.write(autograder_zip(key_only(sheet, name), options))
    record = new_sheet_record(sheet, name, places.output, {"moodle": places.moodle, "autograder": places.autograder})
    if chosen != "table":
        for note in notes:
            say(note)
    rows = [[one["id"], one["kind"], one["about"]] for one in record["questions"]]
    with sink(None) as stream:
        stream.writelines(
            written(
                chosen, record, [record], lambda: csv_records(["id", "kind", "about"], rows),
                lambda: new_sheet_page(record, notes),
            )
        )  # fmt: skip
    return DONE
