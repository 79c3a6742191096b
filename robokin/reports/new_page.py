"""What `robokin new` prints: the description, or what was written and what is left to do."""

from __future__ import annotations

import shlex
from typing import Any

from robokin.reports.page_tables import render
from robokin.tables.written_rows import page


def new_page(record: dict[str, Any]) -> bytes:
    """The page of a description, from its document."""
    file = record["file"]
    if file == "-":
        return page(record["description"])
    units, typed = record["units"], shlex.quote(file)
    what = f"a copy of {record['from']}" if record["from"] else f"an arm of joints {record['joints']}"
    lines = [f"{file}: {what}, lengths in {units['length']}, angles in {units['angle']}"]
    lines += [f"- {note}" for note in record["notes"]]
    if record["missing"]:
        names = ", ".join(record["missing"])
        lines.append(f"no value yet: {names}; write them under `parameters`, or give them with --set NAME=VALUE")
    lines.append(f"{'then' if record['missing'] else 'next'}: robokin show {typed}")
    return render("\n".join(lines) + "\n")
