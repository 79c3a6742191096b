"""A robot's table for papers and other programs: Markdown, LaTeX, CSV."""

from __future__ import annotations

import re
from html import escape
from typing import Any

from robokin.number_text import show, show_range
from robokin.reports.description_tables import coupling_in_short, transform_in_short, variable_cell
from robokin.tables.written_rows import csv_records

ROWS = {"robot": "rows", "tree": "joints", "mechanism": "joints", "wheeled": "wheels"}
"""What a CSV has a row for, by the kind of what is described."""

CELLS = {
    "standard": ("theta", "d", "a", "alpha"),
    "modified": ("alpha", "a", "theta", "d"),
    "frames": ("origin", "axis"),
}
"""The cells of a row in the order in which tables have them."""

SYMBOLS = {"theta": r"\theta", "d": "d", "a": "a", "alpha": r"\alpha"}

SPECIAL = {
    "\\": r"\textbackslash{}", "{": r"\{", "}": r"\}", "#": r"\#", "$": r"\$", "%": r"\%", "&": r"\&", "_": r"\_",
    "~": r"\textasciitilde{}", "^": r"\textasciicircum{}",
}  # fmt: skip
"""What LaTeX writes for what it would read as something else."""


def csv_table(record: dict[str, Any]) -> bytes:
    """The rows of what a document describes, all numbers in full."""
    return _csv(record[ROWS[record["kind"]]])


def _csv(rows: list[dict[str, Any]]) -> bytes:
    """Rows as CSV; what one of them has not is empty, such as the pitch of a joint that is none of a screw."""
    names = [*dict.fromkeys(name for row in rows for name in row)]
    return csv_records(names, [[_csv_cell(row.get(name)) for name in names] for row in rows])


def _csv_cell(value: Any) -> Any:
    if isinstance(value, list):
        return " ".join(" ".join(map(str, one.values())) if isinstance(one, dict) else str(one) for one in value)
    return "" if value is None else value


def ends_in_short(record: dict[str, Any]) -> list[str]:
    """Base and tool, those that are there, in a few words each."""
    texts = ((name, transform_in_short(record[name], record["units"]["angle"])) for name in ("base", "tool"))
    return [f"{name}: {text}" for name, text in texts if text]


def _motions_in_short(record: dict[str, Any]) -> list[str]:
    """What joints hang on and what screws advance, those that are there."""
    texts = [f"{row['name']}: advances {show(row['pitch'])} a turn" for row in record["rows"] if row.get("pitch")]
    return texts + [f"coupled: {coupling_in_short(coupling)}" for coupling in record.get("couplings", ())]


def markdown_table(record: dict[str, Any]) -> bytes:
    """A robot's table in Markdown, numbers to six decimals."""
    return _joined([printable(_about(record)), "", *_markdown_lines(record)])


def markdown_branches(name: str, branches: list[dict[str, Any]], tips: list[dict[str, Any]]) -> bytes:
    """The tables of a tree's branches in Markdown, one below the other, and the tips."""
    lines = [printable(_of_branches(name, branches))]
    for record in branches:
        lines += ["", printable(_about_branch(record)), "", *_markdown_lines(record)]
    return _joined([*lines, "", *(f"- {printable(text)}" for text in _tips_in_short(tips, branches))])


def _joined(lines: list[str]) -> bytes:
    return ("\n".join(lines) + "\n").encode()


def _markdown_lines(record: dict[str, Any]) -> list[str]:
    """A table, and base and tool below it."""
    modified = record["convention"] == "modified"
    titles = [_named(name, modified, "{} i-1") for name in CELLS[record["convention"]]]
    lines = [["i", "joint", "type", *titles, "limits"]]
    lines += [[printable(one).replace("\\", "\\\\").replace("|", r"\|") for one in row] for row in _cells_of(record)]
    left = [True, True, True, *[record["convention"] == "frames"] * len(titles), True]
    rule = [":--" if one else "--:" for one in left]
    text = [f"| {' | '.join(line)} |" for line in [lines[0], rule, *lines[1:]]]
    for end in [*ends_in_short(record), *_motions_in_short(record)]:
        text += ["", printable(end)]
    return text


def latex_table(record: dict[str, Any]) -> bytes:
    """A robot's table in LaTeX, as the package booktabs draws it, numbers to six decimals."""
    return _joined([f"% {printable(_about(record))}", r"% \usepackage{booktabs}", *_latex_lines(record)])


def latex_branches(name: str, branches: list[dict[str, Any]], tips: list[dict[str, Any]]) -> bytes:
    """The tables of a tree's branches in LaTeX, one below the other, and the tips."""
    lines = [f"% {printable(_of_branches(name, branches))}", r"% \usepackage{booktabs}"]
    for record in branches:
        lines += ["", f"% {printable(_about_branch(record))}", *_latex_lines(record)]
    return _joined([*lines, "", *(f"% {printable(text)}" for text in _tips_in_short(tips, branches))])


def _latex_lines(record: dict[str, Any]) -> list[str]:
    """A table, and base and tool below it."""
    frames, modified = record["convention"] == "frames", record["convention"] == "modified"
    names = CELLS[record["convention"]]
    titles = [name if frames else _symbol(name, modified) for name in names]
    columns = "rll" + ("l" if frames else "r") * len(names) + "l"
    lines = [
        rf"\begin{{tabular}}{{{columns}}}",
        r"\toprule",
        " & ".join(["$i$", "joint", "type", *titles, "limits"]) + r" \\",
        r"\midrule",
    ]
    for row in _cells_of(record):
        number, name, kind, *cells, limits = row
        cells = [latex_escaped(cell) if frames else _math(cell) for cell in cells]
        lines.append(" & ".join([number, latex_escaped(name), kind, *cells, _math(limits)]) + r" \\")
    ends = [*ends_in_short(record), *_motions_in_short(record)]
    if ends:
        lines.append(r"\midrule")
        lines += [rf"\multicolumn{{{len(columns)}}}{{l}}{{{latex_escaped(end)}}} \\" for end in ends]
    return [*lines, r"\bottomrule", r"\end{tabular}"]


def html_table(record: dict[str, Any]) -> str:
    """A robot's table in HTML, numbers to six decimals."""
    modified = record["convention"] == "modified"
    titles = [
        "i",
        "joint",
        "type",
        *(_named(name, modified, "{} i-1") for name in CELLS[record["convention"]]),
        "limits",
    ]
    head = "".join(f"<th>{title}</th>" for title in titles)
    lines = ["".join(f"<td>{escape(printable(cell))}</td>" for cell in row) for row in _cells_of(record)]
    ends = "".join(f"<p>{escape(printable(end))}</p>" for end in [*ends_in_short(record), *_motions_in_short(record)])
    units = f"<p>lengths in {record['units']['length']}, angles in {record['units']['angle']}</p>"
    body = "".join(f"<tr>{line}</tr>" for line in lines)
    return f"{units}<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>{ends}"


def csv_branches(branches: list[dict[str, Any]]) -> bytes:
    """The rows of a tree's branches, all numbers in full, with the branch and what it stands on before each."""
    rows = [{"branch": record["branch"], "on": record["on"]} | row for record in branches for row in record["rows"]]
    return _csv(rows)


def _of_branches(name: str, branches: list[dict[str, Any]]) -> str:
    length, angle = branches[0]["units"]["length"], branches[0]["units"]["angle"]
    count = "1 branch" if len(branches) == 1 else f"{len(branches)} branches"
    return f"{name}: tree of {count}, lengths in {length}, angles in {angle}"


def _about_branch(record: dict[str, Any]) -> str:
    return f"{record['branch']}, on {record['on']}: {record['convention']} convention"


def _tips_in_short(tips: list[dict[str, Any]], branches: list[dict[str, Any]]) -> list[str]:
    """Where each tip is, in a few words."""
    ends = {record["branch"] for record in branches}
    texts = []
    for tip in tips:
        tool = transform_in_short(tip["tool"], branches[0]["units"]["angle"])
        place = f"the end of {tip['on']}" if tip["on"] in ends else tip["on"]
        texts.append(f"tip {tip['name']}: {place}{f', {tool}' if tool else ''}")
    return texts


def _about(record: dict[str, Any]) -> str:
    length, angle = record["units"]["length"], record["units"]["angle"]
    return f"{record['name']}: {record['convention']} convention, lengths in {length}, angles in {angle}"


def _cells_of(record: dict[str, Any]) -> list[list[str]]:
    """The rows as texts: number, name, type, the convention's cells, limits."""
    return [
        [
            str(row["i"]),
            row["name"],
            row["type"],
            *(variable_cell(row, name, record["units"]["angle"]) for name in CELLS[record["convention"]]),
            "" if row["limits"] is None else show_range(*row["limits"]),
        ]
        for row in record["rows"]
    ]


def _named(name: str, modified: bool, before: str) -> str:
    """The heading of a column; a modified table has a and alpha of the link before."""
    return before.format(name) if modified and name in ("a", "alpha") else name


def _symbol(name: str, modified: bool) -> str:
    index = "{i-1}" if modified and name in ("a", "alpha") else "i"
    return f"${SYMBOLS[name]}_{index}$"


def _math(text: str) -> str:
    """Numbers and variables as LaTeX sets them."""
    if not text:
        return ""
    text = re.sub(r"q(\d+)", r"q_{\1}", text).replace(" .. ", r" \ldots ")
    text = re.sub(r"(\d)e([-+]\d+)", lambda found: rf"{found[1]} \cdot 10^{{{int(found[2])}}}", text)
    return f"${text}$"


def printable(text: str) -> str:
    """A text without what steers a terminal or ends a line."""
    return text if text.isprintable() else "".join(letter if letter.isprintable() else " " for letter in text)


def latex_escaped(text: str) -> str:
    """A text as LaTeX reads it."""
    return "".join(SPECIAL.get(letter, letter) for letter in printable(text))
