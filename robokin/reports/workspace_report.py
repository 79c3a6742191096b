"""Answers of `robokin workspace` in every format: figures, sections and slices of one robot or two, and places."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from robokin.model import Robot
from robokin.pictures.workspace_cuts import Cut
from robokin.records.workspace_records import flat_row, place_record, workspace_record
from robokin.tables.written_rows import csv_records, json_documents, json_line
from robokin.units import Units
from robokin.workspace.place import WorkspacePlace
from robokin.workspace.workspace_result import Workspace


def workspaces_written(
    found: Sequence[Workspace], cuts: Sequence[Sequence[Cut]], units: Units, kind: str, plates: Sequence[str] = ()
) -> Iterator[bytes]:
    """The workspaces of one robot or two, with their cuts, in a format; `plates` are pictures in text for the page."""
    if kind == "table":
        from robokin.reports.workspace_tables import comparison_table, workspace_table

        if len(found) > 1:
            return iter([comparison_table(found, units, cuts)])
        return iter([workspace_table(found[0], units, cuts[0], plates)])
    records = [workspace_record(one, units, own) for one, own in zip(found, cuts, strict=True)]
    if kind == "csv":
        rows = [flat_row(record) for record in records]
        columns = list(dict.fromkeys(name for row in rows for name in row))
        return iter([csv_records(columns, [[row.get(name, "") for name in columns] for row in rows])])
    return map(json_line, records) if kind == "jsonl" else json_documents(records)


def places_written(places: Sequence[WorkspacePlace], robot: Robot, units: Units, kind: str) -> Iterator[bytes]:
    """Places of a robot's workspace in a format."""
    if kind == "table":
        from robokin.reports.workspace_tables import places_table

        return iter([places_table(places, robot.name, units)])
    records = [place_record(place, robot.id, units) for place in places]
    if kind == "csv":
        names = ["reachable", "solutions", "group", "orientations", "reached", "fraction"]
        rows = [
            [*record["position"], str(record["reachable"]).lower(),
             *("" if record[name] is None else record[name] for name in names[1:])]
            for record in records
        ]  # fmt: skip
        return iter([csv_records(["x", "y", "z", *names], rows)])
    return map(json_line, records) if kind == "jsonl" else json_documents(records)
