"""A pasted Denavit-Hartenberg table to the description of a robot, with a comment beside all that it leaves open."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass

from robokin.errors import ExpressionError, InputError, or_list, shown
from robokin.formats.description_lines import yaml_text
from robokin.formats.expression_tokens import NAME
from robokin.formats.number_expressions import RESERVED, Scope, evaluate
from robokin.formats.pasted_cells import UNITS, plain_text, read_expression
from robokin.formats.pasted_code import OF_LINK
from robokin.formats.pasted_conventions import CONVENTIONS, convention_of
from robokin.formats.pasted_headings import TABLE, PastedHeading, heading_of, units_of_row
from robokin.formats.pasted_joints import FUNCTIONS, IDENTIFIER, KINDS, NUMBERED, JointDraft, TableReader
from robokin.formats.pasted_row import PastedRow
from robokin.formats.pasted_rows import pasted_rows
from robokin.formats.pasted_units import ANGLES, angle_unit, length_unit
from robokin.formats.schema import VERSION
from robokin.units import METRES, Units

PLAIN_NUMBER = re.compile(r"-?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
ASSIGNED = re.compile(
    r"(?<!\w)([A-Za-z]\w*)\s*=\s*"
    r"(-?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|-?(?:\d{1,3}\s?\*\s?)?pi(?:\s?/\s?\d{1,3})?)"
    r"\s*(mm|cm|m|in|deg|°|rad)?"
    r"(?![\w°]|[.,]\d|\s*[-+*/^(]\s*[\w(.])"
)
"""A name and the number that it is: of `L1 = 0.3 + 0.1` the first number is not its value."""


REMARKED = re.compile(r"[#%/].{0,80}?(?:\bin |[\[(])\s?(mm|cm|m|inch(?:es)?|deg|degrees?|rad|radians?)\b(?!/)[\])]?")
"""A unit in the remark behind a value: `a1 = 13  # length of link a1 in cm`, `d1 = 0.09;  % [m]`."""

CHAINED = re.compile(r"=([\d.+\-*/ ()]{1,80})=\s*(-?(?:\d+\.?\d*|\.\d+))(?![\w.])")
"""A number with how it comes about: `0.33 + 0.42 = 0.75`."""

SCALED = re.compile(r"\d(?:\.\d*)?[eE][-+]?\d+\s{0,4}[*×x]\s*$")
"""A factor on a line of its own, as MATLAB prints it above a matrix whose numbers it belongs to."""

PART_OF_PI = re.compile(r"(?<![\w.])(?:(\d{1,4})\s*\*\s*)?pi(?:\s*/\s*(\d{1,4}))?(?!\s*[\w.*/(])")

PLACED = re.compile(r"\b((?:base|tool): (?:Trans|Rot|RPY|Rx|Ry|Rz)\([\w ,.()*/+-]{0,400}\))")
HAND = {"m": "0.1", "cm": "10", "mm": "100", "in": "4"}
"""The length of the hand that waits in a comment, by the unit of length."""

MAX_LINE = 2000
"""Characters of a line beside a table that are looked at."""


@dataclass(frozen=True)
class Wishes:
    """What is said beside a table, None where nothing is: its name, convention, units, types, columns, values."""

    name: str = ""
    convention: str | None = None
    length: str | None = None
    angle: str | None = None
    types: str | None = None
    columns: tuple[str, ...] | None = None
    values: Mapping[str, str] | None = None


@dataclass(frozen=True)
class PastedRobot:
    """A description made of a table: its text, its letters, its units, how it was read, names that lack values."""

    text: str
    types: str
    units: Units
    convention: str
    notes: tuple[str, ...] = ()
    missing: tuple[str, ...] = ()


def described_table(text: str, wishes: Wishes) -> PastedRobot:
    """The description of a robot whose table stands in a text: LaTeX, Markdown, CSV, cells of a spreadsheet, columns.

    Raises InputError where the text has no such table, or leaves open which joint turns and which slides.
    """
    rows, beside = pasted_rows(text, len(wishes.columns) if wishes.columns is not None else None)
    rows, headings = _headed(rows, wishes.columns)
    headings = _numbered(headings, rows)
    caption = " ".join(line[:MAX_LINE] for line in beside)
    headings, convention, notes = convention_of(headings, rows, wishes.convention, caption)
    assigned = _assigned(beside)
    values = {**{name: value for name, (value, _) in assigned.items()}, **(wishes.values or {})}
    for name, value in (wishes.values or {}).items():
        try:
            read_expression(value)
        except ExpressionError as error:
            raise InputError(f"--set {shown(name)}: {error.message}") from None
    commas = _decimal_commas(rows)
    draft = TableReader(headings, rows, wishes.types, assigned, wishes.values or {}, commas).draft()
    notes += [f"the column '{shown(heading.text)}' is left out" for heading in headings if not heading.meaning]
    notes += draft.notes
    for unit in re.findall(r"(?:lengths|angles) in (mm|cm|m|in|deg|rad)\b", caption):
        (draft.angle_units if unit in ("deg", "rad") else draft.length_units).add(unit)
    names = _parameters(draft.rows)
    draft.angle_units |= {unit for name in names if (unit := _assigned_angle(assigned, name))}
    angles = {name: values[name] for name in _named_in(draft.rows, names, ANGLES) if name in values}
    angle, said = angle_unit(headings, draft, angles, wishes.angle)
    notes += said
    lengths = _named_in(draft.rows, names, ("d", "a"))
    draft.length_units |= {assigned[name][1] for name in lengths if name in assigned} & {*METRES}
    length, said = length_unit(headings, draft, [values[name] for name in lengths if name in values], wishes.length)
    notes += said
    lines = _row_lines(draft.rows, angle, convention)
    wrong = [name for name in names if name.lower() in RESERVED or not NAME.fullmatch(name)]
    if wrong:
        raise InputError(f"found '{shown(wrong[0])}' in a cell, expected a number or a name such as l1")
    missing = tuple(name for name in names if name not in values)
    if unused := [name for name in wishes.values or {} if name not in names]:
        raise InputError(
            f"--set {unused[0]}: the table has no such name, expected {or_list(names) if names else 'none'}"
        )
    lacking = "  # the table gives no value: write it here"
    parameters = [f"  {name}: {values.get(name, lacking)}" for name in names]
    text = "\n".join(
        [
            f"robokin: {VERSION}",
            f"name: {yaml_text(wishes.name or 'my arm')}",
            *(f"# {note}" for note in notes),
            f"units: {{length: {length}, angle: {angle}}}",
            f"convention: {convention}   # {CONVENTIONS[convention]}",
            *(["parameters:", *parameters] if names else []),
            "joints:",
            *lines,
            *(_placed(beside) or [f"# tool: Trans(0, 0, {HAND[length]})   # from the last frame to the end effector"]),
            "# poses: {home: [" + ", ".join("0" for row in draft.rows if row.kind != "F") + "]}",
        ]
    )
    types = "".join(row.kind for row in draft.rows)
    return PastedRobot(text + "\n", types, Units(length, angle), convention, tuple(notes), missing)


def _named_in(rows: list[JointDraft], names: list[str], columns: tuple[str, ...]) -> list[str]:
    """Those of some names that stand in cells of these columns."""
    return [name for name in names if any(name in IDENTIFIER.findall(row.cells[c]) for row in rows for c in columns)]


def _refuse_factors(lines: list[str]) -> None:
    """Raise InputError for a line that is a common factor of a matrix."""
    if scaled := next((line for line in lines if SCALED.match(line.strip())), None):
        raise InputError(
            f"found the factor '{shown(scaled.strip())}' beside the table, expected its numbers written out: MATLAB "
            "prints them so after `format shortG`"
        )


def _headed(rows: list[PastedRow], columns: tuple[str, ...] | None) -> tuple[list[PastedRow], list[PastedHeading]]:
    """The rows below the headings and these. Raises InputError where there are none."""
    if columns is not None:
        headings = [heading_of(column) for column in columns]
        if len(headings) != len(rows[0].cells):
            raise InputError(
                f"--columns: found {len(headings)} names, expected one for each of {len(rows[0].cells)} cells"
            )
        own = {heading_of(cell).meaning for cell in rows[0].cells} & {*TABLE}
        return rows[1:] if len(own) >= 3 else rows, _required(headings)
    for turned in (rows, _transposed(rows)):
        headings = [heading_of(cell) for cell in turned[0].cells]
        if len({heading.meaning for heading in headings} & {*TABLE}) >= 3:
            units = units_of_row(turned[1].cells) if len(turned) > 1 else None
            if units is not None:
                headings = [
                    PastedHeading(heading.meaning, heading.text, heading.units + more, heading.before, heading.after)
                    for heading, more in zip(headings, units, strict=True)
                ]
            below = turned[2:] if units is not None else turned[1:]
            if not below:
                raise InputError("found headings and no row below them, expected a row for each joint")
            return below, _required(headings)
    found = ", ".join(shown(cell) for cell in rows[0].cells)
    raise InputError(
        f"found no headings in line {rows[0].line} ({found}), expected such as i, theta, d, a, alpha, or --columns "
        "theta,d,a,alpha in the order of the table"
    )


def _transposed(rows: list[PastedRow]) -> list[PastedRow]:
    """The columns of a table as rows."""
    return [PastedRow(rows[0].line, cells) for cells in zip(*(row.cells for row in rows), strict=True)]


def _numbered(headings: list[PastedHeading], rows: list[PastedRow]) -> list[PastedHeading]:
    """The headings, the first as that of numbers where its cells are such as 1, J1, Joint 1."""
    first = [plain_text(row.cells[0]) for row in rows if row.cells]
    headings = [*headings]
    if headings[0].meaning in ("", "name"):
        numbers = sum(bool(NUMBERED.fullmatch(cell)) for cell in first)
        meaning = "number" if numbers == len(first) else "name"
        headings[0] = PastedHeading(meaning, headings[0].text)
    for k, heading in enumerate(headings):
        cells = [plain_text(row.cells[k]) for row in rows]
        if heading.meaning in ("", "name") and all(cell.lower() in KINDS and cell.strip("-") for cell in cells):
            headings[k] = PastedHeading("type", heading.text)
        elif heading.meaning == "variable" and "theta" not in {h.meaning for h in headings}:
            # A column q of "q1", "q2 - 90" is theta; one of "θ1", "d3" only names what varies.
            if not all(re.fullmatch(r"[A-Za-z]+_?\d*\**", cell) for cell in cells):
                headings[k] = PastedHeading("theta", heading.text, heading.units)
        elif (
            not heading.meaning
            and sum(bool(re.match(r"[-+(]*(?:theta|q)_?\d", cell)) for cell in cells) > len(rows) / 2
        ):
            raise InputError(
                f"found joints' variables in the column '{shown(heading.text)}', expected the heading theta, or "
                "--columns with the names of all columns in order"
            )
    return headings


def _required(headings: list[PastedHeading]) -> list[PastedHeading]:
    """The headings, where they are those of a table. Raises InputError."""
    meanings = [heading.meaning for heading in headings]
    if "d" not in meanings and "r" not in meanings and meanings.count("offset") == 1:
        headings = [
            PastedHeading("d", h.text, h.units, h.before, h.after) if h.meaning == "offset" else h for h in headings
        ]  # angle, offset, length and twist
        meanings = [heading.meaning for heading in headings]
    for name in ("theta", "d", "a", "alpha"):
        if meanings.count(name) > 1:
            raise InputError(f"found two columns {name}, expected one")
    lengths = {"d", "a"} if "r" not in meanings else {"d", "r"} if "d" in meanings else {"a", "r"}
    missing = [name for name in ("alpha", *sorted(lengths)) if name not in meanings]
    if missing:
        raise InputError(f"found no column {missing[0]}, expected the columns theta, d, a and alpha")
    return headings


def _assigned(lines: list[str]) -> dict[str, tuple[str, str]]:
    """Values that stand beside a table, such as L1 = 300 mm, and their units ("" for none), by their names.

    Raises InputError for a common factor, to which the table's own numbers belong.
    """
    _refuse_factors(lines)
    found: dict[str, set[tuple[str, str]]] = {}
    for line in lines:
        line = re.sub(r"(?<=[A-Za-z])_(?=\d)", "", plain_text(line[:MAX_LINE].replace("&=", "=")))
        line = OF_LINK.sub(r"\1\2", re.sub(r"(?<!\w)(?:[A-Za-z]\w{0,20}\.pi|PI|Pi)\b", "pi", line))
        line = CHAINED.sub(_chained, line)
        matches = [*ASSIGNED.finditer(line)]
        for match in matches:
            if re.search(r"(?<!\d)(?<!\d )\b[A-Za-z]\w{0,40}\s?,\s?$", line[: match.start()]):
                continue  # of `d1, d2 = 0.1, 0.2` the first number is that of d1
            remark = REMARKED.search(line, match.end()) if len(matches) == 1 else None
            found.setdefault(match[1], set()).add((match[2], match[3] or (UNITS[remark[1]] if remark else "")))
    return {
        name: next(iter(values)) for name, values in found.items() if len(values) == 1
    }  # of two values none is taken


def _chained(chain: re.Match[str]) -> str:
    """The number alone, where it is what stands before it."""
    try:
        same = math.isclose(evaluate(chain[1].strip(), Scope()).number, float(chain[2]), rel_tol=1e-9)
    except ExpressionError:
        same = False
    return f"= {chain[2]}" if same else chain[0]


def _assigned_angle(assigned: dict[str, tuple[str, str]], name: str) -> str:
    """The unit of the angle that a name is beside the table, "" for none."""
    unit = assigned.get(name, ("", ""))[1]
    return {"°": "deg", "deg": "deg", "rad": "rad"}.get(unit, "")


def _placed(lines: list[str]) -> list[str]:
    """The lines beside a table that are a base or a tool as descriptions have them."""
    found = (
        re.search(r"\b((?:base|tool): (?:Trans|Rot|RPY|Rx|Ry|Rz)\([\w ,.()*/+-]{0,400}\))", line[:MAX_LINE])
        for line in lines
    )
    return [match[1] for match in found if match]


def _decimal_commas(rows: list[PastedRow]) -> bool:
    """Whether the cells have decimal commas. Raises InputError for 1,050, which may be either."""
    cells = [(row.line, cell) for row in rows for cell in row.cells]
    points = any(re.search(r"\d\.\d", cell) for _, cell in cells)
    commas = [(line, match) for line, cell in cells for match in re.finditer(r"(?<![\d,])(\d+),(\d+)(?![\d,])", cell)]
    if not commas or any(re.search(r"[\[(]", cell) for _, cell in cells if "," in cell):
        return False
    thousands = all(len(match[2]) == 3 and match[1] != "0" and len(match[1]) < 4 for _, match in commas)
    if points or thousands:
        line, match = commas[0]
        raise InputError(f"line {line}: found {match[0]}, expected a number with a point, such as 1050 or 1.05")
    return True


def _row_lines(rows: list[JointDraft], angle: str, convention: str) -> list[str]:
    """The rows as YAML, their cells below each other."""
    order = ("alpha", "a", "theta", "d") if convention == "modified" else ("theta", "d", "a", "alpha")
    table, number = [], 0
    for row in rows:
        number += row.kind != "F"
        cells = {"type": row.kind if row.kind != "F" else "fixed"}
        if row.name:
            cells = {"name": yaml_text(row.name)} | cells
        cell, called = row.variable
        for name in order:
            text = row.cells[name]
            if name == cell and row.kind != "F":
                text = re.sub(rf"(?<!\w){re.escape(called)}(?!\w)", f"q{number}", text)
            cells[name] = _in_unit(text, angle, row.line) if name in ANGLES else _bare(text, row.line)
        if row.limits is not None:
            turns = row.kind == "R"
            pair = [_in_unit(limit, angle, row.line) if turns else _bare(limit, row.line) for limit in row.limits]
            low, high = pair if _value(pair[0]) <= _value(pair[1]) else pair[::-1]
            cells["limits"] = f"[{low}, {high}]"
        table.append({name: f"{name}: {text}" for name, text in cells.items()})
    named = [*dict.fromkeys(name for name in ("name", "type", *order, "limits") for cells in table if name in cells)]
    widths = {name: max(len(cells.get(name, "")) for cells in table) + 2 for name in named}
    return [
        "  - {" + "".join(f"{cells[name]}, ".ljust(widths[name]) for name in named if name in cells).rstrip(", ") + "}"
        for cells in table
    ]


def _in_unit(text: str, angle: str, line: int) -> str:
    """An expression of angles in the description's unit."""
    if angle == "deg":
        text = re.sub(r"\bpi\b", "180", PART_OF_PI.sub(_degrees, text))
    return _bare(text, line)


def _degrees(part: re.Match[str]) -> str:
    """A part of pi in degrees, where they are whole and nothing before it is multiplied or divided by it."""
    degrees, rest = divmod(180 * int(part[1] or 1), int(part[2] or 1) or 1)
    apart = part.string[: part.start()].rstrip()[-1:] not in ("*", "/")
    return str(degrees) if apart and not rest and part[2] != "0" else part[0]


def _bare(text: str, line: int) -> str:
    """An expression as a cell: numbers worked out where that is a short number, 0 for nothing."""
    if not text:
        return "0"
    if PLAIN_NUMBER.fullmatch(text):
        return text
    names = [name for name in IDENTIFIER.findall(text) if name not in FUNCTIONS]
    if names or "pi" in text:
        return text
    try:
        value = evaluate(text, Scope()).number
    except ExpressionError as error:
        raise InputError(f"line {line}: '{shown(text)}': {error}, expected a number or an expression") from None
    short = f"{value:.9g}"
    return short if abs(float(short) - value) <= 1e-12 * max(1.0, abs(value)) else text


def _value(text: str) -> float:
    try:
        return evaluate(text, Scope()).number
    except ExpressionError:
        return 0.0


def _parameters(rows: list[JointDraft]) -> list[str]:
    """The names in the cells that are no variables, in order."""
    found: dict[str, None] = {}
    for row in rows:
        for name, text in row.cells.items():
            words = IDENTIFIER.findall(text)
            found |= dict.fromkeys(word for word in words if word not in FUNCTIONS and (name, word) != row.variable)
    return [*found]
