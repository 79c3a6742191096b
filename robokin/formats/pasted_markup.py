"""HTML in a pasted text, as Markdown has it: subscripts, entities, whole tables; each line keeps its number."""

from __future__ import annotations

import html
import re

from robokin.errors import InputError

TAG = re.compile(r"</?(?:su[bp]|t[drh]|table|thead|tbody|br|b|i|u|em|strong|span|code|p|div|font|center|math)\b", re.I)
SUBSCRIPT = re.compile(r"<sub\b[^<>]*>\s*([^<>]{0,40}?)\s*</sub>", re.IGNORECASE)
RAISED = re.compile(r"<sup\b[^<>]*>\s*([^<>]{0,40}?)\s*</sup>", re.IGNORECASE)
ROW = re.compile(r"<tr\b[^<>]*>(.{0,4000}?)(?=</tr\s*>|<tr\b|</table|</tbody|$)", re.IGNORECASE | re.DOTALL)
CELL = re.compile(r"<t[dh]\b([^<>]*)>(.{0,1000}?)(?=</t[dh]\s*>|<t[dh]\b|$)", re.IGNORECASE | re.DOTALL)
ENTITY = re.compile(r"&#?\w{1,31};")
OTHER = re.compile(r"</?[A-Za-z][^<>]{0,400}>")
TILDED = re.compile(r"(?<=\w)~([\w+\-]{1,5})~(?!\w)")
WIKI = re.compile(r"(?m)^[ \t]*\{\|")
HIDDEN = re.compile(r"<!--|-->|<(script|style)\b.{0,2000}?</\1\s*>", re.IGNORECASE | re.DOTALL)


def without_markup(text: str) -> str:
    """A text without HTML, on the lines that it has: the rows of its tables have tabs between their cells.

    Raises InputError for a table with cells over several rows or columns: where they end cannot be seen.
    """
    text = TILDED.sub(r"_{\1}", text)  # of Pandoc and AsciiDoc
    if WIKI.search(text):
        text = re.sub(r"(?m)^[ \t]*(?:\{\||\|[-}+]).*$", "", text)
        text = re.sub(r"(?m)^[ \t]*[!|](.*)$", lambda row: "|" + re.sub(r"\|\||!!", "|", row[1]) + "|", text)
    if not TAG.search(text) and not ENTITY.search(text):
        return text
    text = HIDDEN.sub(lambda found: "\n" * found[0].count("\n"), text)
    text = SUBSCRIPT.sub(r"_{\1}", text)
    text = RAISED.sub(lambda raised: "°" if raised[1].lower() in ("o", "°", "∘") else f"^{{{raised[1]}}}", text)
    text = ROW.sub(lambda row: _row(row, text), text)
    return ENTITY.sub(lambda found: html.unescape(found[0]), _without_tags(text))


def _row(row: re.Match[str], text: str) -> str:
    """A row of a table as a line, and as many empty lines as it has more."""
    cells = []
    for attributes, cell in CELL.findall(row[1]):
        if re.search(r"(?:row|col)span\s*=\s*['\"]?(?!1\b)\d", attributes, re.IGNORECASE):
            line = text.count("\n", 0, row.start()) + 1
            raise InputError(f"line {line}: found a cell over several rows or columns, expected a cell for each")
        cells.append(" ".join(_without_tags(cell).split()))
    return "\t".join(cells) + "\n" * row[0].count("\n")


def _without_tags(text: str) -> str:
    """A text without its tags, a blank for each that ends a line."""
    text = re.sub(r"<br\s*/?>", " ", text, flags=re.IGNORECASE)
    return OTHER.sub("", text)
