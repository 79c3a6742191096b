"""Answers as HTML for notebooks: the shell's tables, in which nothing is markup but the table itself."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields
from html import escape
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from robokin.arrays import Array
from robokin.brief import Answer, Brief, shown_value
from robokin.documents import document_of
from robokin.errors import InputError, counted
from robokin.expected import expect_numbers
from robokin.model import Mechanism, Robot, Tree, WheeledBase
from robokin.number_text import show
from robokin.reports.html_pages import MOST_ROWS, SIDES, html_page, html_table
from robokin.reports.page_parts import Heading, Part, Table


def html_of(value: Answer | Brief) -> str:
    """An answer, a robot, a mechanism, a wheeled base or a part of an answer as HTML."""
    from robokin.inverse.joint_paths import Path
    from robokin.inverse.solutions import BatchResult, Result
    from robokin.inverse.tip_targets import TipAnswer
    from robokin.kinematics.singular import Singularities
    from robokin.kinematics.velocity import Differential

    if isinstance(value, Result) and value.question is not None:
        return _solutions(document_of(value))
    if isinstance(value, BatchResult):
        return _targets(value)
    if isinstance(value, TipAnswer):
        return _groups(document_of(value))
    if isinstance(value, Path):
        return _path(document_of(value))
    if isinstance(value, Differential):
        return _jacobian(document_of(value)) if value.q.ndim == 1 else _ranks(value)
    if isinstance(value, Singularities):
        from robokin.reports.singularity_pages import singularity_parts

        return html_page(*singularity_parts(value.robot, value.robot.units, value.of, value))
    return html_page(*_parts(value))


def _parts(value: Answer | Brief) -> Sequence[Part]:
    """What the shell's page of a value consists of; of a part of an answer its fields, a row each."""
    from robokin.grading.class_statistics import ClassStatistics
    from robokin.grading.mark_items import Report
    from robokin.mobility.manoeuvrability import Manoeuvrability
    from robokin.mobility.verdict import Mobility
    from robokin.workspace.workspace_result import Workspace

    if isinstance(value, Robot | Tree | Mechanism | WheeledBase):
        from robokin.reports.description_tables import description_parts

        return description_parts(document_of(value))
    if isinstance(value, Mobility):
        from robokin.reports.mobility_tables import mobility_parts

        return mobility_parts(document_of(value))
    if isinstance(value, Manoeuvrability):
        from robokin.reports.mobility_tables import wheeled_parts

        return wheeled_parts(document_of(value))
    if isinstance(value, Workspace):
        from robokin.reports.workspace_tables import workspace_parts

        return workspace_parts(value, value.space.robot.units)
    if isinstance(value, ClassStatistics):
        from robokin.reports.statistics_page import statistics_parts

        return statistics_parts(document_of(value))
    if isinstance(value, Report):
        from robokin.reports.mark_report import report_parts

        return report_parts(value)
    if isinstance(value, Answer) or type(value).__repr__ is not Brief.__repr__:
        return [Heading(repr(value), "")]
    rows = ((part.name, getattr(value, part.name)) for part in fields(value))  # type: ignore[arg-type]
    drawn = _table(
        ["", ""], ([name, str(one) if isinstance(one, str) else shown_value(one)] for name, one in rows), [""]
    )
    drawn.headed = False
    return [Heading(type(value).__name__, ""), drawn]


@dataclass(frozen=True, eq=False)
class MatrixView:
    """A matrix that a notebook shows as a table; `str` is the same in text."""

    rows: tuple[tuple[float, ...], ...]

    def _repr_html_(self) -> str:
        right = SIDES["right"]
        cells = "".join(
            "<tr>" + "".join(f"<td{right}>{escape(show(value))}</td>" for value in row) + "</tr>" for row in self.rows
        )
        bars = "border-left: 2px solid; border-right: 2px solid"
        return f'<table style="{bars}"><tbody>{cells}</tbody></table>'

    def __repr__(self) -> str:
        """The rows below one another, numbers right-aligned."""
        cells = [[show(value) for value in row] for row in self.rows]
        widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
        return "\n".join("  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)) for row in cells)


def matrix(values: ArrayLike) -> MatrixView:
    """A matrix, values: (m, n), such as a pose or a Jacobian, shown in a notebook with at most six decimals.

    Raises InputError for another shape.
    """
    array: Array = expect_numbers(values, "values", "a matrix (m, n) of numbers")
    if array.ndim != 2:
        raise InputError(f"values: found an array of shape {array.shape}, expected a matrix (m, n)")
    return MatrixView(tuple(tuple(row) for row in (array + 0.0).tolist()))


# Tables -------------------------------------------------------------------------------------------------------


def _table(names: Sequence[str], rows: Iterable[Sequence[str]], words: Sequence[str] = ()) -> Table:
    """A table of texts, of numbers in all columns but the first and those that are `words`."""
    drawn = Table()
    for i, name in enumerate(names):
        drawn.add_column(name, justify="left" if not i or name in words else "right")
    for row in rows:
        drawn.add_row(*row)
    return drawn


def _labelled(labels: Iterable[str], rows: Iterable[Sequence[float]]) -> list[list[str]]:
    return [[label, *map(show, row)] for label, row in zip(labels, rows, strict=True)]


def _said(units: dict[str, str]) -> str:
    return f"lengths in {units['length']}, angles in {units['angle']}"


def _joints(count: int) -> list[str]:
    return [f"q{i}" for i in range(1, count + 1)]


def _solutions(document: dict[str, Any]) -> str:
    count = counted(len(document["solutions"]), "solution")
    basis = document["certificate"] if document["complete"] else "perhaps not all"
    head = Heading(f"{count}, {document['method']}", f"{basis}; {_said(document['units'])}")
    listed = [(str(i), one) for i, one in enumerate(document["solutions"], start=1)]
    if not document["reachable"]:
        head = Heading(f"no solution: {document['reason']}", f"{document['method']}; {_said(document['units'])}")
        listed = [("nearest", document["nearest"])] if document.get("nearest") else []
    if not listed:
        return html_page(head)
    rows = [
        [label, *map(show, one["q"]), one["branch"], "yes" if one["within_limits"] else "no"] for label, one in listed
    ]
    names = ["", *_joints(len(listed[0][1]["q"])), "branch", "within limits"]
    return html_page(head, _table(names, rows, ("branch", "within limits")))


def _targets(batch: Any) -> str:
    """The number of solutions of each target of a batch, and the least error among them."""
    rows = []
    for i, count in enumerate(batch.count[:MOST_ROWS].tolist()):
        errors = batch.position_error[i][:count]
        rows.append([str(i), str(count), f"{errors.min():.1g}" if len(errors) else ""])
    drawn = _table(["target", "solutions", "position error [m]"], rows)
    return html_page(Heading(repr(batch), "")) + html_table(drawn, len(batch))


def _groups(document: dict[str, Any]) -> str:
    """The solutions of each group of tips, in its own joints."""
    parts: list[Part] = []
    for group in document["groups"]:
        solutions = group["solutions"]
        found = counted(len(solutions), "solution") if solutions else f"no solution: {group['reason']}"
        basis = group["certificate"] if group["complete"] or not solutions else "perhaps not all"
        rows = [
            [str(i), *(show(one["q"][joint - 1]) for joint in group["joints"]), one["branch"]]
            for i, one in enumerate(solutions, start=1)
        ]
        names = ["", *(f"q{joint}" for joint in group["joints"]), "branch"]
        parts.append(Heading(f"{', '.join(group['tips'])}: {found}, {group['method']}", basis))
        parts += [_table(names, rows, ("branch",))] if rows else []
    return html_page(*parts, _said(document["units"]))


def _path(document: dict[str, Any]) -> str:
    words = [event["words"] for event in document["events"]]
    picked = np.unique(np.linspace(0, len(document["path"]) - 1, 11).round().astype(int)).tolist()
    rows = [_labelled([f"{row['t']:.4g}"], [row["q"]])[0] for row in (document["path"][i] for i in picked)]
    how = "all of it" if document["complete"] else f"up to {document['fraction']:.4g} of it"
    title = f"path of {document['id']}, {counted(len(document['path']), 'row')}, {how}"
    head = Heading(title, "; ".join([*words, _said(document["units"])]))
    return html_page(head, _table(["t", *_joints(len(document["path"][0]["q"]))], rows))


def _jacobian(document: dict[str, Any]) -> str:
    """The matrix of one configuration."""
    units = document["jacobian_units"]
    title = f"rank {document['rank']} of {document['full_rank']}, manipulability {document['manipulability']:.6g}"
    rest = f"in the axes of the {document['frame']}, lengths in {units['length']}, angles in {units['angle']}"
    rows = _labelled(("vx", "vy", "vz", "wx", "wy", "wz"), document["jacobian"])
    return html_page(Heading(title, rest), _table(["", *_joints(len(document["q"]))], rows))


def _ranks(found: Any) -> str:
    """Rank, manipulability and condition of each configuration of a block."""
    ranks, volumes = found.rank.reshape(-1)[:MOST_ROWS].tolist(), found.manipulability.reshape(-1).tolist()
    conditions = found.condition.reshape(-1).tolist()
    rows = [[str(i), str(rank), f"{volumes[i]:.6g}", f"{conditions[i]:.6g}"] for i, rank in enumerate(ranks)]
    drawn = _table(["configuration", "rank", "manipulability", "condition"], rows)
    return html_page(Heading(repr(found), "metres and radians")) + html_table(drawn, len(volumes))
