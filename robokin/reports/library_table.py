"""The library as `robokin list` prints it."""

from __future__ import annotations

from typing import Any

from robokin.errors import counted
from robokin.reports.page_tables import render, table


def library_table(records: list[dict[str, Any]]) -> bytes:
    """A row for each entry, and how many there are of each kind."""
    drawn = table()
    drawn.add_column("id", style="cyan", no_wrap=True)
    drawn.add_column("name")
    drawn.add_column("joints", max_width=12)
    drawn.add_column("dof", justify="right")
    for record in records:
        dof = "–" if record["dof"] is None else str(record["dof"])
        drawn.add_row(record["id"], record["name"], record["joints"], dof)
    kinds = [record["kind"] for record in records]
    robots = kinds.count("robot") + kinds.count("tree")  # a hand is a robot with several tips
    sums = [counted(robots, "robot"), counted(kinds.count("mechanism"), "mechanism")]
    if "wheeled" in kinds:
        sums.append(counted(kinds.count("wheeled"), "wheeled base"))
    return render(drawn, "\n" + ", ".join(sums))
