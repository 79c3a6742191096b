"""A table as it is pasted from a page to rows of cells: LaTeX, Markdown, a spreadsheet, CSV, columns of text."""

from __future__ import annotations

import csv
import re
from itertools import groupby

from robokin.errors import InputError, shown
from robokin.formats.pasted_code import code_rows
from robokin.formats.pasted_headings import TABLE, heading_of
from robokin.formats.pasted_markup import without_markup
from robokin.formats.pasted_row import PastedRow
from robokin.formats.schema import MAX_ROWS

MAX_PASTED = 200_000
"""Characters of a pasted table; a page holds some thousands."""

MIN_CELLS = 3
"""Cells that a line of a table has at least: fewer make no Denavit-Hartenberg table."""

MAX_CELL = 1000
"""Characters of a cell; a remark has some hundreds."""

MAX_COLUMNS = 60
"""Cells of a row in which headings are looked for."""

MAX_HEADING = 60
"""Characters of a heading at most."""

MAX_GAP = 2
"""Lines from one row of a table to the next at most; a line, or nothing, may stand between."""

LATEX_ROW = re.compile(r"&[^&]{0,400}(?:\\\\|\\tabularnewline)")
INVISIBLE = dict.fromkeys(map(ord, "\u200b\u200c\u200d\u2060\ufeff\u00ad"))
BLANKS = {ord(blank): " " for blank in "\u00a0\u2007\u2009\u200a\u202f\u3000"}
BARS = re.compile(r"[|│┃║]")
RULE = re.compile(r"[\s|│┃║+:=\-_─━═┌┐└┘├┤┬┴┼╞╡╪╔╗╚╝╠╣╦╩╬┏┓┗┛┣┫┳┻╋┠┨┯┷╇╈]+")
GLUED = re.compile(r"(?<=[\w)°.*]) ?([-+−–]) (?=[\w(.π√])|(?<=\d) (?=(?:°|deg\b|rad\b|mm\b|cm\b|m\b|in\b))")
"""Blanks within a cell: around a sign, and before a unit."""

WHOLE = re.compile(
    r"\[[^\[\]]{1,80}\]|\b(?:Joint|Link|Axis|Frame) (?:\d{1,2}|i)\b|\w \[(?:rad|deg|mm|cm|m|kg) ?\]", re.IGNORECASE
)
"""What has blanks and is one cell in columns of text: a list, the name of a joint, a heading and its unit."""


REMARK = re.compile(r"(?i)\|([^|]{1,20})(\|.*\|)\s*\(?(revolute|prismatic)(?: joint)?\)?")
"""A line of a table with its joint's type behind it."""

NUMBER = re.compile(r"(?i)(?:[a-z]{1,8}[ _.]?)?\d{1,2}(?:\W.*)?")
"""How the first cell of a joint's row begins."""


def pasted_rows(text: str, width: int | None = None) -> tuple[list[PastedRow], list[str]]:
    """The rows of the table in a text, and the lines beside it; width: its cells, where its headings are not looked at.

    Raises InputError where there is no table, where there are two, and for a row that does not fit.
    """
    if len(text) > MAX_PASTED:
        raise InputError(f"found a text of {len(text)} characters, expected a table of a page")
    text = text.replace("\r\n", "\n").replace("\r", "\n").translate(INVISIBLE | BLANKS)
    text = _uncommented(without_markup(text))
    if (of_code := code_rows(text)) is not None:
        return _short(of_code[0]), of_code[1]
    rows, gaps = (_latex(text), True) if LATEX_ROW.search(text) else _lines(_unmarked(text), width)
    rows = [row for row in rows if sum(map(bool, row.cells)) > 1 or NUMBER.fullmatch(row.cells[0])]
    # The table is the run of lines with as many cells that has headings, or else the longest; others are its caption.
    rows = _evened(rows, gaps, width)
    runs = [run for run in _runs(rows) if len(run[0].cells) >= MIN_CELLS]
    runs = [run for run in runs if len(run[0].cells) == width] or runs
    headed = [below for run in runs if width is None and len(below := _from_headings(run)) > 1]
    if len(headed) > 1:
        lines = " and ".join(f"line {run[0].line}, '{shown(', '.join(run[0].cells))}'" for run in headed[:3])
        raise InputError(f"found {len(headed)} lines of headings ({lines}), expected one table, without its notes")
    table = headed[0] if headed else max(runs, key=len, default=[])
    if len(table) < 2 and len(folded := _folded(text)) > 1:
        return _short(folded), []
    if len(table) < 2:
        raise InputError(
            "found no table, expected a line of headings such as `i, theta, d, a, alpha` and a line for each joint "
            "(CSV, Markdown, LaTeX, or cells copied from a spreadsheet)"
        )
    numbers = {row.line for row in table}
    beside = [line for number, line in enumerate(text.split("\n"), start=1) if number not in numbers and line.strip()]
    return _short(table), beside


def _folded(text: str) -> list[PastedRow]:
    """The rows of a table of which each cell is a line, as some PDFs are copied; none where they are not numbered."""
    lines = [
        PastedRow(number, (line.strip(),)) for number, line in enumerate(text.split("\n"), start=1) if line.strip()
    ]
    meanings = [heading_of(row.cells[0]).meaning if len(row.cells[0]) < MAX_HEADING else "" for row in lines]
    first = meanings.index("number") if "number" in meanings else len(lines)
    width = next((k for k, row in enumerate(lines[first:]) if row.cells[0] == "1"), 0)
    if width < MIN_CELLS or len({*meanings[first : first + width]} & {*TABLE}) < 3 or (len(lines) - first) % width:
        return []
    parts = [lines[k : k + width] for k in range(first, len(lines), width)]
    if any(part[0].cells[0] != str(k) for k, part in enumerate(parts[1:], start=1)):
        return []
    return [PastedRow(part[0].line, tuple(row.cells[0] for row in part)) for part in parts]


def _short(table: list[PastedRow]) -> list[PastedRow]:
    """The rows of a table. Raises InputError for a cell that is none, and for more than a robot has."""
    if len(table) > MAX_ROWS + 2:
        raise InputError(f"found {len(table)} rows, expected at most {MAX_ROWS}")
    for row in table:
        if (most := max(map(len, row.cells))) > MAX_CELL:
            raise InputError(f"line {row.line}: found a cell of {most} characters, expected a number or an expression")
    return table


def _runs(rows: list[PastedRow]) -> list[list[PastedRow]]:
    """The rows in runs with as many cells each, of which headings begin another."""
    runs: list[list[PastedRow]] = []
    for row in rows:
        same = runs and len(row.cells) == len(runs[-1][0].cells)
        if same and not (_of_headings(row.cells) and len(runs[-1]) > 1):
            runs[-1].append(row)
        else:
            runs.append([row])
    return runs


def _of_headings(cells: tuple[str, ...]) -> bool:
    """Whether cells are the headings of a table."""
    headings = (heading_of(cell).meaning for cell in cells[:MAX_COLUMNS] if len(cell) < MAX_HEADING)
    return len({*headings} & {*TABLE}) > 2


def _from_headings(run: list[PastedRow]) -> list[PastedRow]:
    """The rows of a run from its headings on, all where these are in its first column; none without headings."""
    for k, row in enumerate(run):
        if _of_headings(row.cells):
            return run[k:]
    return run if _of_headings(tuple(row.cells[0] for row in run)) else []


def _evened(rows: list[PastedRow], gaps: bool, wished: int | None) -> list[PastedRow]:
    """The rows with as many cells as the headings above them, where those at the end are empty or left out.

    gaps: whether a row may leave out its last cells; wished: how many they have, where headings do not tell.
    Raises InputError for a row whose cells are not those of its headings: it would be lost.
    """
    even, width, before = [], 0, 0
    for row in rows:
        cells = row.cells
        if _of_headings(cells) and wished is None:
            width = len(cells)
        elif len(cells) == wished:
            width = wished
        elif width and len(cells) != width:
            near = row.line - before <= MAX_GAP
            if not any(cells[width:]) and gaps and near and 2 * len(cells) >= width:
                cells = (*cells[:width], *[""] * (width - len(cells)))
            elif near and len(cells) >= MIN_CELLS and NUMBER.fullmatch(cells[0]) and not any("=" in c for c in cells):
                raise InputError(f"line {row.line}: found {len(cells)} cells, expected {width} as in the headings")
            else:
                width = 0
        even.append(PastedRow(row.line, cells))
        before = row.line
    return even


def _uncommented(text: str) -> str:
    """A text without the marks that make each of its lines a comment of a program, or a quotation."""
    lines = text.split("\n")
    for mark in ("#", "%", "//", "*", ">"):
        if all(line.lstrip().startswith(mark) for line in lines if line.strip()):
            return "\n".join(line.strip()[len(mark) :] for line in lines)
    return text


def _unmarked(text: str) -> str:
    """A text without the marks of comments before a line."""
    return re.sub(r"(?m)^[ \t]*(?:%+|//+)(?=[ \t|])", "", text)


def _latex(text: str) -> list[PastedRow]:
    """The rows of a LaTeX tabular or array."""
    text = re.sub(r"(?<!\\)%[^\n]*", "", text)
    start, end = 0, len(text)
    if begin := re.search(r"\\begin\{(tabular[x*]?|array|longtable|[bpv]?matrix|tblr)\}", text):
        start = begin.end()
        found = text.find(f"\\end{{{begin[1]}}}", start)
        end = found if found >= 0 else end
        start += len(_arguments(text[start:end]))
    rows, at = [], start
    for part in re.split(r"(\\\\(?:\s*\[[^\]\n]*\])?|\\tabularnewline)", text[start:end]):
        if not part.startswith(("\\\\", "\\tabularnewline")):
            lead = len(part) - len(part.lstrip())
            line = text.count("\n", 0, at + lead) + 1
            body = re.sub(r"\\(hline|toprule|midrule|bottomrule|(cline|cmidrule)(\([^)]*\))?\{[^}]*\})", " ", part)
            body = re.sub(r"\\multicolumn\{(\d+)\}\{[^}]*\}\{([^{}]*)\}", _spread_over, body)
            cells = tuple(cell.replace("\\&", "&").strip() for cell in re.split(r"(?<!\\)&", body))
            if len(cells) > 1:
                rows.append(PastedRow(line, cells))
        at += len(part)
    return rows


def _arguments(text: str) -> str:
    """What a text begins with that are arguments in brackets, such as `[t]{|c|c|}`."""
    at = 0
    while match := re.match(r"\s*(\[[^\]]*\]|\{(?:[^{}]|\{(?:[^{}]|\{[^{}]*\})*\})*\})", text[at:]):
        at += match.end()
    return text[:at]


def _spread_over(match: re.Match[str]) -> str:
    """A cell over several columns as one and empty ones."""
    return match[2] + " &" * (min(int(match[1]), 20) - 1)


def _lines(text: str, width: int | None) -> tuple[list[PastedRow], bool]:
    """The rows of a table of which each is a line, and whether these may leave out their last cells."""
    lines = [(number, line) for number, line in enumerate(text.split("\n"), start=1)]
    full = [(number, line) for number, line in lines if not RULE.fullmatch(line)]
    for separator in ("|", "\t", ";", ","):
        counts = [len(_parts(line, separator)) for _, line in full]
        of_table = [count for count in counts if count >= MIN_CELLS and width in (None, count)]
        if len(of_table) >= 2:
            rows = [PastedRow(number, _parts(line, separator)) for number, line in full if line.strip()]
            return rows, separator in "|\t"
    return _columns(full, width), False


def _parts(line: str, separator: str) -> tuple[str, ...]:
    """The cells of a line."""
    if separator == "|":
        line = BARS.sub("|", line).strip()
        if remark := REMARK.fullmatch(line):  # such as | 3 | 0 | d₃ | 0 | 0 | (prismatic)
            line = f"| {remark[1].strip()} ({remark[3][0].upper()}){remark[2]}"
        cells = line.split("|")
        cells = cells[1:] if line.startswith("|") else cells
        cells = cells[:-1] if line.endswith("|") and len(cells) > 1 else cells
    elif separator == "\t":
        cells = line.split("\t")
    else:
        try:
            cells = next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])
        except csv.Error:  # a field that no table has
            cells = [line]
    return tuple(cell.strip() for cell in cells)


def _columns(lines: list[tuple[int, str]], width: int | None) -> list[PastedRow]:
    """The rows of a table in columns of text: parted where there are two blanks, or else at each or most blanks."""
    lines = [(number, line.strip()) for number, line in lines if line.strip()]
    whole = [(number, WHOLE.sub(lambda part: part[0].replace(" ", "\0"), line)) for number, line in lines]
    wide = [PastedRow(number, tuple(re.split(r"\s{2,}", line))) for number, line in lines]
    narrow = [PastedRow(number, tuple(line.split())) for number, line in lines]
    glued = [PastedRow(number, tuple(GLUED.sub(lambda sign: sign[1] or "", line).split())) for number, line in lines]
    kept = [
        PastedRow(
            number, tuple(cell.replace("\0", " ") for cell in GLUED.sub(lambda sign: sign[1] or "", line).split())
        )
        for number, line in whole
    ]

    def longest(rows: list[PastedRow]) -> int:
        runs = groupby(rows, key=lambda row: len(row.cells))
        return max((len([*run]) for cells, run in runs if cells >= MIN_CELLS and width in (None, cells)), default=0)

    return max((wide, narrow, glued, kept), key=longest)
