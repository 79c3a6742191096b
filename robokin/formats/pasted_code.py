"""A Denavit-Hartenberg table that a program holds: links of a toolbox, matrices, lists of lists, a list a column."""

from __future__ import annotations

import re
from itertools import islice

from robokin.errors import InputError, shown
from robokin.formats.pasted_headings import TABLE, heading_of
from robokin.formats.pasted_row import PastedRow

LINK = re.compile(r"\b(?:(Revolute|Prismatic)(M?)(?:DH)?|(DH)?Link)\s*\(")
LISTED = re.compile(r"\s*\[([^\[\]]{1,400})\]([^;\n]{0,80})")
VECTOR = re.compile(
    r"(?<![\w.])['\"]?([A-Za-z][\w.]{0,40})['\"]?\s*[=:]\s*"
    r"(?:(?:[\w.]{1,20}\()?['\"]?[\[(]([^\[\]=]{1,600})\]|[\w.]{0,20}\bsymbols\(['\"]([^'\"]{1,600})['\"])"
)
MATRIX = re.compile(r"=\s*(?:[\w.]{1,40}\()?\s*[\[{]|^[ \t]*[\[{]\s{0,40}[\[{]", re.MULTILINE)
GROUP = re.compile(r"[\[{]([^\[\]{}]{3,4000})[\]}]")
TUPLE = re.compile(
    r"(?m)^([ \t]{0,40}(?:\w{1,40} ?= ?)?\[?[ \t]{0,40})\(([^\n\[\]]{1,400})\)([ \t]{0,9},?[ \t]{0,9}\]?[ \t]{0,9})$"
)
"""A row of a list that is a tuple, on a line of its own."""

COMMENT = re.compile(r"(?:%|#|//)(.*)")
INDEXED = re.compile(r"(?<![\w.])(?:self\.)?([A-Za-z]\w{0,20})\[\s*(\d{1,2})\s*\]")
CALLED_Q = ("q", "qs", "qsym", "th", "theta", "thetas", "t", "joints", "joint", "angles", "joint_angles", "symbols")
"""What a program calls the list of its joints' variables."""

LISTED_Q = re.compile(r"(?:q|qs|th|thetas?|joints?)_(?:syms?|symbols|vec|list|values|vals|vars?|i)")
"""The same with a word behind it."""

OF_LINK = re.compile(r"(?<![\w.])(alpha|alp|a|d|theta|th|l)\((\d{1,2})\)", re.IGNORECASE)
"""An entry of MATLAB's lists of lengths and angles."""

UNPACKED = re.compile(
    r"(?m)^[ \t]{0,40}(?:for (?:\w{1,20}, ?)?)?\(?(\w{1,20}(?: ?, ?\w{1,20}){3,5})\)? ?"
    r"(?:= ?[\w.]{1,40}(?:\[[^\[\]\n]{1,20}\]){0,2}[ \t]{0,40}$|in )"
)
"""Where a program takes a row apart: `alpha, a, d, theta = table[i]`, `for theta, d, a, alpha in table`."""

DICTIONARY = re.compile(r"\s*['\"]?\w{1,40}['\"]?\s*:(?!:)")
ORIGIN = re.compile(r"\bOriginLink\s*\(|\bikpy\b")
"""What only programs with ikpy have, whose links add their theta to the joint's variable (ikpy, link.py)."""

RECORD = re.compile(r"\{|\b\w{1,30}\(")
FIELD = re.compile(r"['\"]?(theta|d|a|alpha|offset|type)['\"]?\s*[=:]\s*(.*)", re.DOTALL)
JOINED = re.compile(r"\s['\"]?(?:theta|d|a|alpha|offset|type)['\"]?\s?[=:](?!=)")
"""Another number of a row in a value, where a comma is lost."""

SYMBOL = re.compile(r"(?:\w{1,20}\.)?[sS]ymbols?\(\s*['\"]([^'\"]{1,40})['\"][^()]{0,60}\)")
ENTRY = re.compile(r"(?<![\w.])['\"]?(?:self\.)?(alpha|al|a|d|q|theta|th)_?(\d{1,2})['\"]?\s*:\s*")
LIMITED = re.compile(r"(?m)^[ \t]*(?:self\.)?(\w{1,40}(?:\(\d{1,2}\)|\[\d{1,2}\])?)\.qlim\s*=\s*([^\n;]{1,200})")
ASSIGNED_TO = re.compile(r"(?:self\.)?(\w{1,40}(?:\(\d{1,2}\)|\[\d{1,2}\])?)\s*=\s*[\w.]{0,40}$")
CONTINUED = re.compile(r"\.\.\.[^\n]{0,400}\n")
LINK_COLUMNS = ("theta", "d", "a", "alpha", "sigma", "offset")
"""What `Link([…])` of the Robotics Toolbox takes, in order (P. Corke, Robotics, Vision and Control, chapter 7)."""

MIN_NUMBERS = 4
"""Numbers in a row of a matrix at least."""

MAX_NAME = 120
"""Characters before a link in which the name is looked for that it is given."""

MAX_VALUE = 200
"""Characters of a value in a dictionary."""

MAX_RECORDS = 500
"""Dictionaries that are looked at; a program of an arm has a dozen."""

MAX_CALL = 2000
"""Characters of the arguments of one link."""


def code_rows(text: str) -> tuple[list[PastedRow], list[str]] | None:
    """The rows of the table in a program, headings first where it has any, and the lines beside; None for no program.

    Raises InputError for links that cannot be read.
    """
    lines = text.split("\n")
    if sum("|" in line for line in lines) > 1 or "&" in text:
        return None
    bare = _indexed("\n".join(COMMENT.sub("", line) for line in lines))
    for reader in (_links, _records, _entries, _vectors, _matrix):
        rows, beside = reader(bare, text)
        if len(rows) > 1:
            return rows, [*beside, *(line for line in lines if not GROUP.search(line) and not LINK.search(line))]
    return None


def _indexed(text: str) -> str:
    """A program whose lists' entries are names: the joints' variables from q1 on, others as they are counted."""
    first: dict[str, int] = {}
    for name, index in INDEXED.findall(text):
        first[name] = min(int(index), first.get(name, int(index)))

    def named(entry: re.Match[str]) -> str:
        if entry[1].lower() in CALLED_Q or LISTED_Q.fullmatch(entry[1].lower()):
            return f"q{int(entry[2]) + (first[entry[1]] == 0)}"
        return f"{entry[1]}{entry[2]}"

    return OF_LINK.sub(r"\1\2", INDEXED.sub(named, text))


def _links(bare: str, text: str) -> tuple[list[PastedRow], list[str]]:
    """The rows of links of a toolbox, such as `Link([0 0.4 0.025 pi/2])` and `RevoluteDH(d=0.4, a=0.025)`."""
    rows, conventions = [], set()
    limits = {name: _plain(pair) for name, pair in LIMITED.findall(bare)}
    for match in LINK.finditer(bare):
        line, rest = _line(bare, match.start()), bare[match.end() : match.end() + MAX_CALL]
        told, words = _listed(listed, line) if (listed := LISTED.match(rest)) else _arguments(rest)
        if not told:
            raise InputError(f"line {line}: found a link without numbers, expected its theta, d, a and alpha")
        if told.get("flip", "False") not in ("False", "false", "0"):
            raise InputError(f"line {line}: found a link with flip, expected links that turn the way of their axis")
        if (owner := ASSIGNED_TO.search(bare[max(0, match.start() - MAX_NAME) : match.start()])) and owner[1] in limits:
            told.setdefault("qlim", limits[owner[1]])
        if match[3] and "offset" not in told and ORIGIN.search(bare):
            told["offset"], told["theta"] = told.get("theta", ""), ""
        slides = _slides(match, told, words, bool(listed), line)
        free = "d" if slides else "theta"  # whatever number stands there
        told[free] = told[free] if re.search(r"[A-Za-z]", told.get(free, "").replace("pi", "")) else ""
        rows.append(_row(line, told, "P" if slides else "R"))
        said = "standard" if match[1] or match[3] or "standard" in words else ""
        modified = match[2] or "modified" in words or told.get("mdh", "0") in ("1", "True")
        conventions.add("modified" if modified else said)
    if "modified" in conventions and len(conventions) > 1:
        raise InputError("found links in the modified convention and others, expected one convention")
    return _with_headings(rows), [f"{name} convention" for name in sorted(conventions) if name]


def _slides(match: re.Match[str], told: dict[str, str], words: set[str], listed: bool, line: int) -> bool:
    """Whether a link is that of a sliding joint. Raises InputError where it is left open.

    `Link('theta', 0, 'a', 1, …)` slides, as its angle is a constant (P. Corke, Robotics Toolbox, Link.m); an angle that
    is given to a link that turns is dropped there, and an offset elsewhere (ikpy).
    """
    if match[1] or {"prismatic", "revolute"} & words or "sigma" in told:
        return match[1] == "Prismatic" or "prismatic" in words or told.get("sigma") == "1"
    theta = told.get("theta", "")
    if listed or not theta:
        return False
    if not match[3] and "=" not in match.string[match.end() : match.end() + MAX_CALL].split(")")[0]:
        if "d" in told:
            raise InputError(
                f"line {line}: found a link with theta and d, expected d alone where it turns, theta where it slides"
            )
        return True
    if not re.fullmatch(r"[-+]?0*\.?0*|[A-Za-z]\w*", theta) or theta == "pi":
        raise InputError(
            f"line {line}: found theta {theta} of a link that turns, expected it as offset (the Robotics Toolbox "
            "drops it, ikpy adds it)"
        )
    return False


def _listed(match: re.Match[str], line: int) -> tuple[dict[str, str], set[str]]:
    """What a link is given in a list, and the words behind it. Raises InputError."""
    cells = _cells(match[1])
    if not 4 <= len(cells) <= 6:
        raise InputError(f"line {line}: found {len(cells)} numbers in a Link, expected theta, d, a, alpha")
    return dict(zip(LINK_COLUMNS, cells, strict=False)), {"modified", "standard"} & {*re.findall(r"\w+", match[2])}


def _row(line: int, told: dict[str, str], kind: str) -> PastedRow:
    """A link as a row: its type, theta, d, a, alpha, offset and limits."""
    limits = told.get("qlim", "")
    if pair := re.fullmatch(r"([^\[]*)\[\s*([^\[\],\s]+)[\s,]+([^\[\],\s]+)\s*\]\)?(\s*\*\s*(?:pi/180|deg))?", limits):
        degrees = "°" if pair[4] or re.search(r"(?:deg2rad|radians)\($", pair[1].strip()) else ""
        limits = f"{pair[2]}{degrees} to {pair[3]}{degrees}"
    return PastedRow(line, (kind, *(told.get(name, "") for name in ("theta", "d", "a", "alpha", "offset")), limits))


def _with_headings(rows: list[PastedRow]) -> list[PastedRow]:
    """Rows of links below their headings."""
    return [PastedRow(rows[0].line, ("type", "theta", "d", "a", "alpha", "offset", "limits")), *rows] if rows else []


def _arguments(text: str) -> tuple[dict[str, str], set[str]]:
    """What a call is given by name, up to its closing parenthesis, and the words that stand alone."""
    parts = _parted(CONTINUED.sub(" ", text), ",")
    told: dict[str, str] = {}
    words: set[str] = set()
    k = 0
    while k < len(parts):
        name, equals, value = parts[k].partition("=")
        quoted = re.fullmatch(r"['\"](\w+)['\"]", parts[k])
        if equals:
            told[name.strip()] = _plain(value)
        elif quoted and quoted[1] in (*LINK_COLUMNS, "qlim", "flip") and k + 1 < len(parts):
            told[quoted[1]] = _plain(parts[k + 1])
            k += 1
        elif quoted:
            words.add(quoted[1])
        k += 1
    return (told if {"d", "a", "alpha", "theta", "offset"} & {*told} else {}), words


def _records(bare: str, text: str) -> tuple[list[PastedRow], list[str]]:
    """The rows of `{"d": 0.4, "a": 0, "alpha": pi/2}` and `Joint(d=0.4, a=0, alpha=pi/2)`, each with the same names."""
    found: list[tuple[int, dict[str, str]]] = []
    opened = (match for match in RECORD.finditer(bare) if "alpha" in bare[match.end() : match.end() + MAX_VALUE])
    for match in islice(opened, MAX_RECORDS):
        parts = _parted(bare[match.end() : match.end() + MAX_CALL], ",")
        fields = [field for part in parts if (field := FIELD.fullmatch(part))]
        if glued := next((field for field in fields if JOINED.search(field[2])), None):
            raise InputError(
                f"line {_line(bare, match.start())}: found '{shown(glued[0])}', expected a comma between the numbers"
            )
        told = {field[1]: SYMBOL.sub(r"\1", _plain(field[2])) for field in fields}
        if {"d", "a", "alpha"} <= {*told} and len(told) == len(fields):
            found.append((_line(bare, match.start()), told))
    if len(found) < 2:
        return [], []
    names = [*found[0][1]]
    for line, told in found:
        if {*told} != {*names}:
            raise InputError(f"line {line}: found {', '.join(told)}, expected {', '.join(names)} as in the first")
    rows = [PastedRow(line, tuple(told[name] for name in names)) for line, told in found]
    return [PastedRow(found[0][0], tuple(names)), *rows], []


def _entries(bare: str, text: str) -> tuple[list[PastedRow], list[str]]:
    """The rows of `{alpha0: 0, a0: 0, d1: 0.75, q1: q1, …}`: what has no value is the joint's variable.

    Raises InputError for a length or a twist without a value, and for a value that is given twice.
    """
    found: dict[str, dict[int, str]] = {"alpha": {}, "a": {}, "d": {}, "theta": {}}
    lines: dict[int, int] = {}
    matches = [*ENTRY.finditer(bare)]
    if len(matches) < 2 * MIN_NUMBERS:
        return [], []
    for match in matches:
        column, value = found[{"al": "alpha", "q": "theta", "th": "theta"}.get(match[1], match[1])], match.end()
        cell = _plain(_parted(bare[value : value + MAX_VALUE], ",")[0].split("\n")[0])
        if column.setdefault(int(match[2]), cell) != cell:
            raise InputError(f"line {_line(bare, value)}: found {match[1]}{match[2]} twice, expected one value")
        if column is found["d"]:
            lines[int(match[2])] = _line(bare, value)
    before = min(found["alpha"], default=1) == 0
    line, last = _line(bare, matches[0].start()), max((*found["d"], *found["theta"]), default=0)
    headings = ("i", "alpha_{i-1}", "a_{i-1}", "d", "theta") if before else ("i", "alpha", "a", "d", "theta")
    rows = [PastedRow(line, headings)]
    for i in range(1, last + 1):
        cells = [found[name].get(i - before, "") for name in ("alpha", "a")] + [found["d"].get(i, "")]
        if "" in cells:
            name = ("alpha", "a", "d")[cells.index("")]
            number = i if name == "d" else i - before
            raise InputError(f"found no value of {name}{number}, expected alpha, a and d of each of {last} joints")
        rows.append(PastedRow(lines[i], (str(i), *cells, found["theta"].get(i, f"q{i}"))))
    return rows, []


def _vectors(bare: str, text: str) -> tuple[list[PastedRow], list[str]]:
    """The rows of `d = [0.4 0 0]` and its like: each list is a column."""
    columns: dict[str, tuple[str, ...]] = {}
    line = 1
    for match in VECTOR.finditer(bare):
        name = match[1].rpartition(".")[2]
        if heading_of(name).meaning in ("theta", "d", "a", "alpha", "offset") and ";" not in (match[2] or ""):
            columns[name], line = _cells(match[2] or match[3]), _line(bare, match.start())
    sizes = {len(cells) for cells in columns.values()}
    if len({heading_of(name).meaning for name in columns} & {*TABLE}) < 3 or len(sizes) != 1:
        return [], []
    return [
        PastedRow(line, (*columns,)),
        *(PastedRow(line, cells) for cells in zip(*columns.values(), strict=True)),
    ], []


def _matrix(bare: str, text: str) -> tuple[list[PastedRow], list[str]]:
    """The rows of a matrix or of a list of lists, below the headings that a comment beside it has."""
    if not MATRIX.search(bare):
        return [], []
    bare = TUPLE.sub(r"\1[\2]\3", bare)
    rows = []
    for match in GROUP.finditer(bare):
        at = match.start(1)
        for part in re.split(r"([;\n])", match[1]):
            cells = _cells(part.strip().strip(","))
            if len(cells) > 1 and not DICTIONARY.match(part):
                rows.append(PastedRow(_line(bare, at + len(part) - len(part.lstrip())), cells))
            at += len(part)
    width = max((len(row.cells) for row in rows), default=0)
    if sum(len(row.cells) >= MIN_NUMBERS for row in rows) < 2:
        return [], []
    for row in rows:
        if len(row.cells) != width:
            raise InputError(f"line {row.line}: found {len(row.cells)} numbers, expected {width} as in other rows")
    told = [headings for headings in (_commented(text, width), _unpacked(bare, width)) if headings]
    if len({tuple(heading_of(cell).meaning for cell in headings.cells) for headings in told}) > 1:
        raise InputError(
            f"line {told[1].line}: found {', '.join(told[1].cells)} and in line {told[0].line} "
            f"{', '.join(told[0].cells)}, expected one order of a row's numbers, or --columns"
        )
    return [*told[:1], *rows], []


def _commented(text: str, width: int) -> PastedRow | None:
    """The comment of a program that has the headings of a matrix: of several that of which most is understood."""
    found: list[tuple[int, PastedRow]] = []
    for number, line in enumerate(text.split("\n"), start=1):
        if comment := COMMENT.search(line):
            body = re.sub(r"^[^\[]*\[|[\];].*$", "", comment[1]).strip(" ;.")
            separator = next((sign for sign in "|," if sign in body), None)
            cells = tuple(cell.strip() for cell in body.split(separator))
            meanings = [heading_of(cell).meaning for cell in cells]
            if len(cells) == width and len({*meanings} & {*TABLE}) > 2:
                found.append((-sum(map(bool, meanings)), PastedRow(number, cells)))
    return min(found, key=lambda one: one[0])[1] if found else None


def _unpacked(bare: str, width: int) -> PastedRow | None:
    """The headings of a matrix where its rows are taken apart, in one order alone."""
    found = {}
    for match in UNPACKED.finditer(bare):
        cells = tuple(cell.strip() for cell in match[1].split(","))
        if len(cells) == width and len({heading_of(cell).meaning for cell in cells} & {*TABLE}) > 3:
            found[cells] = PastedRow(_line(bare, match.start(1)), cells)
    return next(iter(found.values())) if len(found) == 1 else None


def _line(text: str, at: int) -> int:
    return text.count("\n", 0, at) + 1


def _parted(text: str, separator: str) -> list[str]:
    """The parts of a text between separators outside brackets, up to a bracket that closes what is not open."""
    depth, start, parts = 0, 0, []
    for k, letter in enumerate(text):
        depth += (letter in "([{") - (letter in ")]}")
        if depth < 0:
            text = text[:k]
            break
        if letter == separator and not depth:
            parts.append(text[start:k].strip())
            start = k + 1
    return [*parts, text[start:].strip()]


def _cells(text: str) -> tuple[str, ...]:
    """The numbers and expressions in a row of a program: between commas, or between blanks."""
    text = _plain(text)
    if "," in text:
        return (*(part.strip("'\"") for part in _parted(text, ",")),)
    text = re.sub(r"\s*([*/])\s*", r"\1", re.sub(r"(?<=\S)\s+([-+])\s+(?=\S)", r"\1", text))
    return tuple(part.strip("'\"") for part in text.split())


def _plain(text: str) -> str:
    """An expression of a program without what only its language needs."""
    text = re.sub(r"\((?:float|double)\)|\.\.\.", " ", text)
    text = re.sub(r"(?<![\w.])[A-Za-z]\w{0,20}\.pi\b", "pi", text)
    text = re.sub(r"(?<=[\d.])[fF]\b", "", text)
    text = re.sub(r"\b(?:[\w.]{1,20}\.)?(?:rad|radians|deg2rad)\(\s*(-?[\d.]{1,20})\s*\)", r"\1°", text)
    return text.strip().strip("'\"")
