"""What `robokin check new` prints: what was written, and what to do with it."""

from __future__ import annotations

import shlex
from typing import Any

from robokin.errors import counted
from robokin.reports.page_tables import render, table


def new_sheet_page(record: dict[str, Any], notes: list[str]) -> bytes:
    """The page about a sheet, from its document."""
    drawn = table()
    for name in ("id", "kind", "about"):
        drawn.add_column(name)
    for one in record["questions"]:
        drawn.add_row(one["id"], one["kind"], one["about"])
    folder = record["folder"].rstrip("/")
    said = f"{folder}/students: a folder for each of {counted(record['students'], 'student')}, to hand out"
    kept = f"{folder}/key: the key, which no student may see"
    lines = [said, kept]
    lines += [f"{record['moodle']}: the Moodle quiz"] if record["moodle"] else []
    lines += [f"{record['autograder']}: the Gradescope autograder"] if record["autograder"] else []
    lines += [f"- {note}" for note in notes]
    lines.append(f"then: robokin check sheet {shlex.quote(folder + '/key')} -i ANSWERS")
    return render(drawn, "", "\n".join(lines))
