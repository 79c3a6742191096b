"""Which convention a pasted table is of: what its headings tell, and the text around it."""

from __future__ import annotations

import re
from dataclasses import replace

from robokin.errors import InputError
from robokin.formats.pasted_cells import plain_text
from robokin.formats.pasted_headings import PastedHeading
from robokin.formats.pasted_row import PastedRow

CONVENTIONS = {
    "standard": "A = Rot(z, theta) Trans(0, 0, d) Trans(a, 0, 0) Rot(x, alpha)",
    "modified": "A = Rot(x, alpha) Trans(a, 0, 0) Rot(z, theta) Trans(0, 0, d)",
}

NAMED = r"(?:D-?H\b|denavit|convention|notation|(?:link |joint )?parameters)"
TOLD = {
    "modified": re.compile(
        rf"\b(?:modified|craig(?:['’]s)?|proximal)\W{{1,3}}{NAMED}|\bMDH\b|convention\W{{1,4}}modified", re.I
    ),
    "standard": re.compile(
        rf"\b(?:standard|classic(?:al)?|distal)\W{{1,3}}{NAMED}|\bSDH\b|convention\W{{1,4}}standard", re.I
    ),
}
"""What the text around a table calls its convention; a page that was last modified in May says nothing of it."""


def _own(headings: list[PastedHeading], rows: list[PastedRow]) -> list[PastedHeading]:
    """The headings, d of i - 1 as d where each name in it has the number of the row's angle: d1 beside q1."""
    places = {heading.meaning: k for k, heading in enumerate(headings)}
    if "d" not in places or "theta" not in places or not headings[places["d"]].before:
        return headings
    pairs = [[re.search(r"[a-z]_?(\d+)", plain_text(row.cells[places[c]])) for c in ("d", "theta")] for row in rows]
    if {d[1] == theta[1] for d, theta in pairs if d and theta} != {True}:
        return headings
    return [replace(heading, before=False) if heading.meaning == "d" else heading for heading in headings]


def convention_of(
    headings: list[PastedHeading], rows: list[PastedRow], wished: str | None, caption: str
) -> tuple[list[PastedHeading], str, list[str]]:
    """The headings with r as what it is, the convention, and what is to be told of it.

    Raises InputError where the headings leave open what is what.
    """
    headings = _own(headings, rows)
    meanings = [heading.meaning for heading in headings]
    before = {heading.meaning: heading.before for heading in headings}
    modified = before.get("a", False) or before.get("alpha", False)
    if wished is None and modified and before.get("a", before.get("r")) != before.get("alpha"):
        raise InputError("found a and alpha of different links in the headings, expected --convention")
    if any(before.get(name, False) for name in ("theta", "d")):
        raise InputError(
            "found d or theta of i - 1 in the headings, expected both of the row's own joint; --columns with the names "
            "of all columns in order, such as i,alpha_{i-1},a_{i-1},d,theta, says that they are"
        )
    modified = modified or any(heading.after for heading in headings if heading.meaning in ("theta", "d"))
    told = {name for name, pattern in TOLD.items() if pattern.search(caption)}
    modified = modified or told == {"modified"}
    notes = []
    if "r" in meanings:
        # Khalil and Kleinfinger: alpha_j and d_j of j - 1, theta_j, r_j; elsewhere r is the length of the link, a.
        khalil = "d" in meanings and "sigma" in meanings
        if "d" in meanings and not khalil and "theta" in meanings and meanings.index("alpha") < meanings.index("theta"):
            raise InputError(
                "found columns d and r, which may be a and d of Khalil and Kleinfinger or d and a of others, expected "
                "--columns with the names of all columns in order, such as i,alpha,a,theta,d"
            )
        names = {"r": "d", "d": "a"} if khalil else {"r": "d"} if "a" in meanings else {"r": "a"}
        modified = modified or "sigma" in meanings
        headings = [
            PastedHeading(names.get(h.meaning, h.meaning), h.text, h.units, h.before, h.after) for h in headings
        ]
        notes.append("r is taken for " + ("d, and d for a (Khalil and Kleinfinger)" if len(names) > 1 else names["r"]))
    said = "modified" if modified else "standard"
    if said == "modified" and told == {"standard"}:
        told = set()  # the headings are of i - 1, whatever the text calls that
    if wished is None and len(told) == 1:
        notes.append(f"convention: {said}, as the text says")
    elif wished is None and not modified:
        notes.append(
            "convention: standard, as no heading is of i - 1; --convention modified reads a table like Craig's"
        )
    elif wished == "standard" and modified:
        notes.append("convention: standard, though headings are of i - 1")
    return headings, wished or said, notes
