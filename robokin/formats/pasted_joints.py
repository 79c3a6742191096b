"""The rows of a pasted Denavit-Hartenberg table: which cell holds the variable, what is a length, what a limit."""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import dataclass, field

from robokin.errors import ExpressionError, InputError, shown
from robokin.formats.pasted_cells import UNIT, UNITS, PastedCell, pasted_cell, plain_text, read_expression
from robokin.formats.pasted_headings import PastedHeading
from robokin.formats.pasted_row import PastedRow

IDENTIFIER = re.compile(r"(?<!\w)(?<!\d\.)[A-Za-z]\w*")
FUNCTIONS = ("pi", "sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "abs", "min", "max", "deg", "rad")
VARIABLES = {
    "theta": re.compile(r"(theta|q|th|phi|psi|beta|gamma|t)(i|j|\d{1,3})?$", re.IGNORECASE),
    "d": re.compile(r"(d|q|s|r|b|lambda)(i|j|\d{1,3})?$"),
}
"""What the variable of a joint is called in the column theta, and in d where theta has none."""

KINDS = {
    "r": "R", "rev": "R", "revolute": "R", "rot": "R", "rotary": "R", "rotational": "R", "rotation": "R",
    "turning": "R",
    "p": "P", "pri": "P", "prismatic": "P", "linear": "P", "sliding": "P", "translational": "P", "t": "P", "slide": "P",
    "f": "F", "fixed": "F", "": "", "-": "",
}  # fmt: skip
END_ROW = re.compile(
    r"(?i)(?:.*[^a-z])?(?:ee|e\.\s?e\.?|tcp|tool|end|endeff\w*|effector|gripper|hand|flange)(?:[^a-z].*)?"
)
"""What a row without a joint is called: that of the tool."""

NUMBERED = re.compile(
    r"(?i)(?:[a-z]{1,8}[ _.]?)?(\d{1,3})(?:\s*(?:->|→|-|to|:)\s*(?:\d{1,3}|[a-z.]{1,8}))?(?:\s*\(.{0,12}\))?:?"
)
"""How a row's number is written: 1, J1, Joint 1:, 0->1, 1-2, 3(R)."""

VALUE = r"[-+]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?\s*\*?\s*(?:pi)?|pi)(?:\s*/\s*\d+)?"
PAIRS = (
    re.compile(rf"[\[(<]?\s*(?P<low>{VALUE})\s*(?:,|;|to|…|\.\.+|~|/|:|<.*<|≤.*≤)\s*(?P<high>{VALUE})\s*[\])>]?"),
    re.compile(rf"[\[(]?\s*(?P<low>{VALUE})\s+(?P<high>{VALUE})\s*[\])]?"),
    re.compile(rf"[\[(]?\s*(?P<low>{VALUE})\s*-\s*(?P<high>{VALUE})\s*[\])]?"),
)
"""A joint's two limits in one cell."""


@dataclass
class JointDraft:
    """A row on its way to a description.

    kind: R, P or F; cells: theta, d, a and alpha as expressions, "" for nothing; variable: the cell of the variable and
    what it is called there, "" where the cell is a constant; limits: two values, None for none.
    """

    line: int
    kind: str
    cells: dict[str, str]
    variable: tuple[str, str] = ("", "")
    name: str = ""
    limits: tuple[str, str] | None = None


@dataclass
class TableDraft:
    """The rows of a table, the units that its cells name, and what is to be told of how it was read."""

    rows: list[JointDraft] = field(default_factory=list)
    angle_units: set[str] = field(default_factory=set)
    length_units: set[str] = field(default_factory=set)
    notes: list[str] = field(default_factory=list)


class TableReader:
    """Reads the rows under some headings.

    types: the letter of each row where the table does not say them; known: names that have a value beside the table:
    a length of it is no variable, an angle is (a page tells where a joint stands); given: names that have a value
    otherwise, and are no variables.
    """

    def __init__(
        self,
        headings: list[PastedHeading],
        rows: list[PastedRow],
        types: str | None,
        known: Collection[str],
        given: Collection[str],
        commas: bool,
    ) -> None:
        self.headings, self.rows, self.commas = headings, rows, commas
        self.known = {"theta": given, "d": {*known, *given}}
        if types is not None and (len(types) != len(rows) or set(types) - set("RPF")):
            raise InputError(
                f"--types: found '{shown(types)}', expected a letter R, P or F for each of the table's {len(rows)} rows"
            )
        self.types = types
        self.read = [{name: self.cell(name, row) for name in ("theta", "d", "a", "alpha", "offset")} for row in rows]
        self.starred = any(cells[name].variable for cells in self.read for name in ("theta", "d"))
        self.named = [self.variable(cells, row) for cells, row in zip(self.read, rows, strict=True)]
        self._one_each()

    def text(self, meaning: str, row: PastedRow) -> str:
        """The text of a row's cell in the first column with a meaning."""
        for heading, cell in zip(self.headings, row.cells, strict=False):
            if heading.meaning == meaning:
                return cell
        return ""

    def cell(self, meaning: str, row: PastedRow) -> PastedCell:
        """What a row's cell says. Raises InputError where that is no number, name or expression."""
        text = self.text(meaning, row)
        cell = pasted_cell(text, decimal_commas=self.commas)
        if meaning not in ("theta", "d", "a", "alpha", "offset"):
            return cell
        if meaning == "theta" and "=" in text:
            raise InputError(f"line {row.line}: found '{shown(text)}', expected the joint's variable or a number alone")
        if (called := re.fullmatch(r"([a-z]+\d+)\s*\(.*\)", cell.text)) and called[1] not in FUNCTIONS:
            raise InputError(
                f"line {row.line}: found '{shown(text)}', expected {called[1]} alone, or the number added as in "
                f"{called[1]} - 90"
            )
        raised = re.search(r"[¹²³⁴⁵⁶⁷⁸⁹]", text)
        if raised and (meaning == "theta" or re.fullmatch(r"[-+]?[\w.]+\*\*\d+", cell.text)):
            raise InputError(
                f"line {row.line}: found '{shown(text)}', expected it without the mark of a footnote, or ** for a power"
            )
        if cell.text:
            try:
                read_expression(cell.text)
            except ExpressionError as error:
                raise InputError(f"line {row.line}: '{shown(text)}' in {meaning}: {error.message}") from None
        return cell

    def variable(self, cells: dict[str, PastedCell], row: PastedRow) -> tuple[str, str]:
        """The cell that a row names its variable in, and its name ("" where it only says that it varies).

        Raises InputError for an angle that has a variable's name and no star, where stars mark variables.
        """
        told = re.fullmatch(r"(theta|d)(?:i|j|\d+)?\**", plain_text(self.text("variable", row)).replace("_", ""))
        for name in (told[1],) if told else ("theta", "d"):
            cell = cells[name]
            words = [word for word in IDENTIFIER.findall(cell.text) if word not in FUNCTIONS]
            fitting = [word for word in words if VARIABLES[name].match(word) and word not in self.known[name]]
            if cell.variable:
                return name, (fitting or words or [""])[0]
            if fitting and not self.starred:
                return name, fitting[0]
            if fitting and name == "theta" and not cells["d"].variable:
                raise InputError(
                    f"line {row.line}: found {shown(fitting[0])} without a star, expected one on each variable or none"
                )
        return (told[1], "") if told else ("", "")

    def _one_each(self) -> None:
        """Raise InputError where a row has the variable of another, or numbers are not in order."""
        owners: dict[str, int] = {}
        before = (-1, -1)
        for k, (_, called) in enumerate(self.named):
            digits = re.search(r"\d+$", called)
            leading = NUMBERED.fullmatch(
                plain_text(self.text("number", self.rows[k]) or self.text("name", self.rows[k]))
            )
            now = (int(leading[1]) if leading else before[0] + 1, int(digits[0]) if digits else before[1])
            if called in owners or now[0] <= before[0] or (digits and now[1] <= before[1]):
                found = called if digits else f"row {now[0]}"
                raise InputError(
                    f"line {self.rows[k].line}: found {shown(found)} after {shown(self._before(k))}, expected the rows "
                    "from the base to the tool, each with a variable of its own"
                )
            before = now
            if digits:
                owners[called] = k
        for k, cells in enumerate(self.read):
            for cell in cells.values():
                for word in IDENTIFIER.findall(cell.text):
                    if owners.get(word, k) != k:
                        raise InputError(
                            f"line {self.rows[k].line}: found {shown(word)}, the variable of line "
                            f"{self.rows[owners[word]].line}, expected rows with their own variable alone: joints that "
                            "move together are `couplings` of a description"
                        )

    def _before(self, k: int) -> str:
        """What the row before is called by."""
        return self.named[k - 1][1] or plain_text(self.text("number", self.rows[k - 1]))

    def draft(self) -> TableDraft:
        """The rows. Raises InputError with the line of what cannot be read."""
        draft = TableDraft()
        for k, row in enumerate(self.rows):
            kind = self.kind(k)
            cell, called = self.named[k]
            if cell != {"R": "theta", "P": "d"}.get(kind):
                cell, called = {"R": "theta", "P": "d", "F": ""}[kind], ""
            cells = {name: self.read[k][name].text for name in ("theta", "d", "a", "alpha")}
            draft.notes += self._told(k, kind)
            if kind != "F":
                if not re.fullmatch(r"0*\.?0*", cells[cell]) and not called:
                    draft.notes.append(
                        f"line {row.line}: {cell} {cells[cell]} is what it is where the joint is at zero"
                    )
                cells[cell], called = self._variable_cell(cells[cell], called, k)
            joint = JointDraft(row.line, kind, cells, (cell, called), self._name(row))
            joint.limits = self._limits(row, draft) if kind != "F" else None
            draft.rows.append(joint)
            self._units(k, draft)
        if self.types is None and not any(cell for cell, _ in self.named) and not any(map(self._typed, self.rows)):
            where = "it stands in the empty cell" if "theta" in self.meanings() else "each row turns about theta"
            draft.notes.append(f"no row names its variable: {where}; --types says otherwise")
        fixed = sum("its row is fixed" in note for note in draft.notes)
        if fixed > 1 and 2 * fixed > len(draft.rows):
            raise InputError(
                f"found no variable in {fixed} of {len(draft.rows)} rows, expected one such as q1 or theta1 in the "
                f"cell that varies, or --types with a letter for each row, such as {'R' * len(draft.rows)}"
            )
        return draft

    def _told(self, k: int, kind: str) -> list[str]:
        """What is to be told of the kind of a row that nothing in the table says outright."""
        row, (cell, called) = self.rows[k], self.named[k]
        if self.types is not None or self._typed(row) or self._said(k):
            return []
        if kind == "F":
            return [f"line {row.line} names no variable: its row is fixed"]
        if kind == "P" and cell == "d" and not self.starred:
            return [f"line {row.line} slides: {called} stands in d and no variable in theta; --types says otherwise"]
        return []

    def _typed(self, row: PastedRow) -> bool:
        """Whether a column says the type of a row."""
        return bool(self.text("type", row) or self.text("sigma", row) or self.text("variable", row))

    def _said(self, k: int) -> str:
        """What a row says of its type, in a column of its own or beside its number, as in 3(P)."""
        row = self.rows[k]
        beside = re.fullmatch(r"\w+\s*\((\w+)(\W*)\)", plain_text(self.text("number", row)))
        if beside is None or beside[1].lower() not in KINDS:
            return self.text("type", row)
        if beside[2]:
            raise InputError(
                f"line {row.line}: found '{shown(beside[1] + beside[2])}' beside the number, expected R (revolute), "
                "P (prismatic) or nothing"
            )
        return self.text("type", row) or beside[1]

    def kind(self, k: int) -> str:
        """The letter of a row. Raises InputError where nothing says it."""
        row, cells = self.rows[k], self.read[k]
        if self.types is not None:
            return self.types[k]
        said = plain_text(self._said(k)).lower()
        if sigma := plain_text(self.text("sigma", row)):
            return {"0": "R", "1": "P", "2": "F"}.get(sigma, "") or self._unknown(k, f"sigma {sigma}")
        if said not in KINDS:
            raise InputError(f"line {row.line}: found the type '{shown(said)}', expected R (revolute) or P (prismatic)")
        called = plain_text(self.text("name", row) or self.text("number", row))
        if not said and not self.starred and self.named[k][0] == "d" and END_ROW.fullmatch(called):
            return "F"  # its d is a length
        if KINDS[said] or self.named[k][0]:
            return KINDS[said] or {"theta": "R", "d": "P"}[self.named[k][0]]
        if any(cell for cell, _ in self.named):
            return "F"
        # In a table that names no variable the cell that is left empty is where it stands.
        if bool(cells["theta"].text) != bool(cells["d"].text) or "theta" not in self.meanings():
            return "P" if cells["theta"].text and not cells["d"].text else "R"
        return self._unknown(k, f"theta {cells['theta'].text or 'empty'} and d {cells['d'].text or 'empty'}")

    def meanings(self) -> set[str]:
        """What the columns mean."""
        return {heading.meaning for heading in self.headings}

    def _unknown(self, k: int, found: str) -> str:
        raise InputError(
            f"line {self.rows[k].line}: found {found}, and no joint's variable, expected one such as q1 or theta1 in "
            "the cell that varies, a column `type` of R and P, or --types with a letter for each row, such as "
            f"{'R' * len(self.rows)}"
        )

    def _variable_cell(self, text: str, called: str, k: int) -> tuple[str, str]:
        """The cell of a row's variable with its constant and its sense, and what the variable is called there."""
        offset = self.read[k]["offset"].text
        constant = "" if re.fullmatch(r"0*\.?0*", text) else text
        if called:
            constant = re.sub(rf"(?<!\w){re.escape(called)}(?!\w)", "", constant).strip() if text else ""
            plain = text in ("", called) or not re.search(r"[-+*/]\s*(?:\)|$)|\(\s*(?:[*/]|\))", constant)
        sense = plain_text(self.text("sense", self.rows[k])).lstrip("+")
        if sense not in ("", "1", "1.0", "-1", "-1.0"):
            raise InputError(f"line {self.rows[k].line}: found the sense '{shown(sense)}', expected 1 or -1")
        if called and not plain and not sense.startswith("-"):
            text = text or called  # such as 90 - q1
        else:
            called, minus = called or "q", "-" if sense.startswith("-") else ""
            text = _sum(minus + called, constant)
        return (_sum(text, offset) if not re.fullmatch(r"0*\.?0*", offset) else text), called

    def _name(self, row: PastedRow) -> str:
        """The joint's name, where there is more than its number."""
        name = " ".join(self.text("name", row).split()).strip("`*")
        plain = plain_text(name)
        return "" if NUMBERED.fullmatch(plain) or re.fullmatch(r"[\d\W]*|[ivxIVX]+", plain) else name

    def _limits(self, row: PastedRow, draft: TableDraft) -> tuple[str, str] | None:
        """The limits of a row as two texts."""
        low, high = self.cell("low", row).text, self.cell("high", row).text
        if low and high:
            return low, high
        text = plain_text(self.text("limits", row))
        draft.notes += [f"line {row.line}: one limit alone is left out"] if low or high else []
        if not text or text in ("-", "∞", "±∞", "inf"):
            return None
        if self.commas:
            text = re.sub(r"(?<=\d),(?=\d)", ".", text)
        bare = UNIT.sub("", text.replace("°", "")).strip()
        bare = re.sub(r"(^|[\[(,;…~:]|\.\.|\bto)\s*([-+])\s+(?=[\d.])", r"\1 \2", bare).strip()
        if match := re.fullmatch(rf"[\[(]?\s*(?:±|\+/-|\+-|-/\+)\s*({VALUE})\s*[\])]?", bare):
            return f"-{match[1]}", match[1]
        for pattern in PAIRS:
            if match := pattern.fullmatch(bare):
                return match["low"].lstrip("+"), match["high"].lstrip("+")
        raise InputError(f"line {row.line}: found the limits '{shown(text)}', expected such as -170 to 170 or ±170")

    def _units(self, k: int, draft: TableDraft) -> None:
        """Gather the units that a row's cells name."""
        row = draft.rows[-1]
        for name, cell in self.read[k].items():
            angle = name in ("theta", "alpha") or (name == "offset" and row.kind != "P")
            for unit in cell.units:
                if (unit in ("deg", "rad")) != angle:
                    what, wanted = ("an angle", "deg or rad") if angle else ("a length", "a unit of length")
                    raise InputError(f"line {row.line}: found {unit} in {name}, {what}, expected {wanted}")
                (draft.angle_units if angle else draft.length_units).add(unit)
        for meaning in ("limits", "low", "high"):
            text = plain_text(self.text(meaning, self.rows[k]))
            units = {UNITS[match[1]] for match in UNIT.finditer(text)} | ({"deg"} if "°" in text else set())
            if row.kind == "R":
                draft.angle_units |= units & {"deg", "rad"}
            elif row.kind == "P":
                draft.length_units |= units - {"deg", "rad"}


def _sum(first: str, second: str) -> str:
    """The sum of two expressions as it is written."""
    second = second.strip().removeprefix("+").strip()
    if not second:
        return first
    return f"{first} - {second[1:].strip()}" if second.startswith("-") else f"{first} + {second}"
