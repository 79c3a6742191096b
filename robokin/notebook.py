"""Answers as HTML for notebooks: tables of plain text, in which nothing is markup but the table itself."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from robokin.arrays import Array
from robokin.brief import Answer
from robokin.documents import document_of
from robokin.errors import InputError, counted
from robokin.expected import expect_numbers
from robokin.model import Mechanism, Robot, WheeledBase
from robokin.number_text import show

MOST_ROWS = 50
"""Rows of a table: more are counted below it."""

RIGHT = ' style="text-align: right"'


def html_of(value: Answer) -> str:
    """An answer, a robot, a mechanism or a wheeled base as HTML."""
    from robokin.inverse.joint_paths import Path
    from robokin.inverse.solutions import BatchResult, Result
    from robokin.inverse.tip_targets import TipAnswer
    from robokin.kinematics.velocity import Differential

    if isinstance(value, Robot):
        return _robot(document_of(value))
    if isinstance(value, Mechanism):
        return _mechanism(document_of(value))
    if isinstance(value, WheeledBase):
        return _base(document_of(value))
    if isinstance(value, Result) and value.question is not None:
        return _solutions(document_of(value))
    if isinstance(value, BatchResult):
        rows = [[str(i), str(count), *_least(value, i)] for i, count in enumerate(value.count[:MOST_ROWS].tolist())]
        return _captioned(repr(value)) + _table(["target", "solutions", "position error [m]"], rows, len(value))
    if isinstance(value, TipAnswer):
        return _groups(document_of(value))
    if isinstance(value, Path):
        return _path(document_of(value))
    if isinstance(value, Differential) and value.q.ndim == 1:
        document = document_of(value)
        names = [f"q{i}" for i in range(1, value.robot.n + 1)]
        head = [f"rank {document['rank']} of {document['full_rank']}, manipulability {document['manipulability']:.6g}"]
        labels = ("vx", "vy", "vz", "wx", "wy", "wz")
        return _captioned(*head) + _table(["", *names], _labelled(labels, document["jacobian"]))
    return _captioned(repr(value))


@dataclass(frozen=True, eq=False)
class MatrixView:
    """A matrix that a notebook shows as a table; `str` is the same in text."""

    rows: tuple[tuple[float, ...], ...]

    def _repr_html_(self) -> str:
        cells = "".join(
            "<tr>" + "".join(f"<td{RIGHT}>{escape(show(value))}</td>" for value in row) + "</tr>" for row in self.rows
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


def _table(names: Sequence[str], rows: Iterable[Sequence[str]], whole: int | None = None) -> str:
    """A table of texts; `whole` is how many rows there are, if not all are given."""
    shown = [*rows]
    head = "".join(f"<th>{escape(name)}</th>" for name in names)
    body = "".join("<tr>" + "".join(f"<td{RIGHT}>{escape(cell)}</td>" for cell in row) + "</tr>" for row in shown)
    more = (len(shown) if whole is None else whole) - len(shown)
    foot = f"<p>and {counted(more, 'row')} more</p>" if more > 0 else ""
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>{foot}"


def _captioned(title: str, *more: str) -> str:
    rest = "".join(f"<br>{escape(one)}" for one in more)
    return f"<p><b>{escape(title)}</b>{rest}</p>"


def _numbers(values: Iterable[float] | None) -> str:
    return "" if values is None else " ".join(map(show, values))


def _cell(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    return show(value) if isinstance(value, int | float) else str(value)


def _labelled(labels: Iterable[str], rows: Iterable[Sequence[float]]) -> list[list[str]]:
    return [[label, *map(show, row)] for label, row in zip(labels, rows, strict=True)]


def _said(units: dict[str, str]) -> str:
    return f"lengths in {units['length']}, angles in {units['angle']}"


def _robot(document: dict[str, Any]) -> str:
    """The table, as `robokin show` has it; in a DH table the variable stands with its offset."""
    frames = document["convention"] == "frames"
    columns = ["origin", "axis"] if frames else ["theta", "d", "a", "alpha"]
    if document["convention"] == "modified":
        columns = ["alpha", "a", "theta", "d"]
    rows = []
    for row in document["rows"]:
        cells = []
        for name in columns:
            if name == "origin":
                cells.append(_numbers(line[3] for line in row["origin"][:3]))
            elif name == "axis":
                cells.append(_numbers(row["axis"]))
            elif row[name] is None:
                offset = row["offset"] or 0.0
                sign = "+" if offset > 0.0 else "-"
                cells.append(str(row["variable"]) + (f" {sign} {show(abs(offset))}" if offset else ""))
            else:
                cells.append(show(row[name]))
        rows.append([str(row["i"]), row["name"], row["type"], *cells, _numbers(row["limits"])])
    title = f"{document['convention']} convention, {_said(document['units'])}"
    return _captioned(document["name"], document["class"], title) + _table(
        ["i", "joint", "type", *("place" if name == "origin" else name for name in columns), "limits"], rows
    )


def _mechanism(document: dict[str, Any]) -> str:
    rows = [
        [joint["name"], joint["type"], ", ".join(joint["links"]), str(joint["freedoms"]), _numbers(joint["at"])]
        for joint in document["joints"]
    ]
    count = f"{document['space']}, {counted(len(document['links']), 'link')}, Grübler's count {document['grubler']}"
    return _captioned(document["name"], count, _said(document["units"])) + _table(
        ["joint", "type", "links", "f", "at"], rows
    )


def _base(document: dict[str, Any]) -> str:
    names = ("name", "type", "angle", "radius", "offset", "roller", "driven", "turned")
    rows = [[_cell(wheel[name]) for name in names] + [_numbers(wheel["at"])] for wheel in document["wheels"]]
    return _captioned(document["name"], _said(document["units"])) + _table([*names, "at"], rows)


def _solutions(document: dict[str, Any]) -> str:
    count = counted(len(document["solutions"]), "solution")
    if not document["reachable"]:
        return _captioned(f"no solution: {document['reason']}", document["method"])
    basis = document["certificate"] if document["complete"] else "perhaps not all"
    names = [f"q{i}" for i in range(1, len(document["solutions"][0]["q"]) + 1)]
    rows = [
        [str(i), *map(show, one["q"]), one["branch"], _cell(one["within_limits"])]
        for i, one in enumerate(document["solutions"][:MOST_ROWS], start=1)
    ]
    said = _said(document["units"])
    return _captioned(f"{count}, {document['method']}", basis, said) + _table(
        ["", *names, "branch", "within limits"], rows, len(document["solutions"])
    )


def _groups(document: dict[str, Any]) -> str:
    """The solutions of each group of tips, in its own joints."""
    parts = []
    for group in document["groups"]:
        solutions = group["solutions"]
        found = counted(len(solutions), "solution") if solutions else f"no solution: {group['reason']}"
        basis = group["certificate"] if group["complete"] or not solutions else "perhaps not all"
        rows = [
            [str(i), *(show(one["q"][joint - 1]) for joint in group["joints"]), one["branch"]]
            for i, one in enumerate(solutions[:MOST_ROWS], start=1)
        ]
        names = ["", *(f"q{joint}" for joint in group["joints"]), "branch"]
        parts.append(_captioned(f"{', '.join(group['tips'])}: {found}, {group['method']}", basis))
        parts += [_table(names, rows, len(solutions))] if rows else []
    return "".join(parts) + f"<p>{escape(_said(document['units']))}</p>"


def _path(document: dict[str, Any]) -> str:
    words = [event["words"] for event in document["events"]]
    picked = np.unique(np.linspace(0, len(document["path"]) - 1, 11).round().astype(int)).tolist()
    names = [f"q{i}" for i in range(1, len(document["path"][0]["q"]) + 1)]
    rows = [_labelled([f"{row['t']:.4g}"], [row["q"]])[0] for row in (document["path"][i] for i in picked)]
    how = "all of it" if document["complete"] else f"up to {document['fraction']:.4g} of it"
    title = f"path of {document['id']}, {counted(len(document['path']), 'row')}, {how}"
    return _captioned(title, *words, _said(document["units"])) + _table(["t", *names], rows)


def _least(value: Any, i: int) -> list[str]:
    """The least position error of a target's solutions."""
    errors = value.position_error[i][: value.count[i]]
    return [f"{errors.min():.1g}" if len(errors) else ""]
