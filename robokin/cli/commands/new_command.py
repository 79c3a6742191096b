"""`robokin new`: the description of a robot of one's own."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from robokin.cli.completion import robots, words
from robokin.cli.option_groups import OutputOptions
from robokin.cli.options import AngleOption, LengthOption, SetOption, choose, option, parameter_overrides
from robokin.cli.statuses import DONE, say
from robokin.errors import InputError, shown
from robokin.units import METRES, RADIANS

COLUMNS = ("id", "file", "from", "joints", "convention", "missing")
"""What a CSV has of a description that was made."""


def command(
    place: Annotated[str, typer.Argument(metavar="FILE", help="The file to write, such as arm.yaml; - prints it.")],
    *,
    from_: Annotated[
        str | None, option("--from", "ROBOT", "Begin with a copy: of a library robot or a file (YAML, URDF …).", robots)
    ] = None,
    table: Annotated[
        str | None, option("--table", "FILE", "Begin with a Denavit-Hartenberg table, pasted as it is; - reads it.")
    ] = None,
    convention: Annotated[
        str | None,
        option("--convention", "NAME", "Of the table: standard or modified.", words("standard", "modified")),
    ] = None,
    columns: Annotated[
        str | None, option("--columns", "NAMES", "Of a table without headings: i,theta,d,a,alpha in its order.")
    ] = None,
    types: Annotated[
        str | None, option("--types", "LETTERS", "Of a table without variables: R, P or F (fixed) for each row.")
    ] = None,
    set_: SetOption = None,
    angle: AngleOption = None,
    length: LengthOption = None,
    force: Annotated[
        bool, typer.Option("--force", help="Write over a file that is there.", show_default=False)
    ] = False,
    answer: OutputOptions,
) -> int:
    """A description of one's own robot to start from: an example, a copy, or a table as a page prints it.

    Without an option it is an arm of three joints that says what each line is. A table may be LaTeX, Markdown, CSV,
    cells of a spreadsheet or columns of text, with Greek letters, degree signs and columns in any order. What the
    table leaves open is said, and stands as a comment in the file; lengths that it gives no value for wait in
    `parameters`, or are given by --set.

    Examples:
        robokin new first.yaml
        robokin new my-puma.yaml --from puma560
        robokin new lecture.yaml --table table.txt --set L3=100
        robokin new other.yaml --table joints-table.csv --types RR --length mm
    """
    from robokin.formats.first_description import copied, example, of_table
    from robokin.formats.pasted_description import Wishes
    from robokin.records.new_records import new_record
    from robokin.reports.new_page import new_page
    from robokin.tables.sink import sink
    from robokin.tables.written_rows import csv_records, written

    if from_ is not None and table is not None:
        raise InputError("--from and --table exclude each other, expected one of them")
    given = {"--convention": convention, "--columns": columns, "--types": types, "--set": set_, "--angle": angle,
             "--length": length}  # fmt: skip
    for name, value in given.items():
        if value and table is None:
            raise InputError(f"{name} is about a table, expected --table")
    kind, name = answer.kind, _name(place, force)
    if table is not None:
        wishes = Wishes(
            name, choose(convention, ("standard", "modified"), "--convention"), choose(length, (*METRES,), "--length"),
            choose(angle, (*RADIANS,), "--angle"), types.upper() if types else None,
            tuple(columns.split(",")) if columns else None, parameter_overrides(set_),
        )  # fmt: skip
        text, source = _pasted(table)
        try:
            made = of_table(text, wishes)
        except InputError as error:
            raise InputError(f"{source}: {error}") from None
    else:
        made = copied(from_) if from_ is not None else example(name)
    if place != "-":
        with sink(place, "FILE") as stream:
            stream.write(made.text.encode())
    elif kind == "table":
        for note in made.notes:
            say(note)
    record = new_record(made, place)
    with sink(answer.file) as stream:
        rows = [[*(record[column] for column in COLUMNS[:-1]), " ".join(made.missing)]]
        stream.writelines(written(kind, record, [record], lambda: csv_records(COLUMNS, rows), lambda: new_page(record)))
    return DONE


def _pasted(table: str) -> tuple[str, str]:
    """The text of a table, and what it is called. Raises InputError."""
    from robokin.files import open_input, read_up_to
    from robokin.formats.pasted_rows import MAX_PASTED

    with open_input(table, "a table") as (stream, source):
        data = read_up_to(stream, source, 4 * MAX_PASTED, "a table")
    try:
        return data.decode("utf-8-sig"), source
    except UnicodeDecodeError:
        raise InputError(f"{source}: found bytes that are no text, expected a table in UTF-8") from None


def _name(file: str, force: bool) -> str:
    """The robot's name, which is that of its file. Raises InputError for a file that is not to be written."""
    if file == "-":
        return "my arm"
    path = Path(file)
    if path.suffix.lower() not in (".yaml", ".yml"):
        hint = f"; did you mean {shown(file)}.yaml?" if not path.suffix else ""
        raise InputError(f"found '{shown(file)}', expected a name that ends with .yaml{hint}")
    if os.path.lexists(path) and not force:
        raise InputError(f"{shown(file)} is there already, expected another name, or --force")
    return path.stem
