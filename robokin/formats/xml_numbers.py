"""Numbers in the attributes and texts of XML nodes, by robokin's own strict reading.

`nan`, `inf`, `1_000` and digits of other scripts, which Python's float takes, are no numbers of a description.
"""

from __future__ import annotations

import math
import re

from robokin.errors import Note, counted, shown
from robokin.formats.xml_tree import XmlNode
from robokin.formats.yaml_tree import FilePlace

NUMBER = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
COMMA_AFTER = re.compile(r",(?=\s|$)")
"""A comma that can only part numbers: one between two digits may be meant as a decimal point."""

PLAIN = re.compile(r"[0-9eE+.\- \t\r\n\f\v]+")
"""Of these characters Python's float takes what is a number here, and nothing else."""

BLANK = re.compile(r"[ \t\r\n\f\v]+")


def number_at(text: str, place: FilePlace, what: str) -> float:
    """A finite number from a text; `what` it is, for messages. Raises DescriptionError at the place."""
    text = text.strip(" \t\r\n\f\v")
    if not NUMBER.fullmatch(text):
        found = f"'{shown(text)}'" if text else "nothing"
        raise place.error(f"found {found} as {what}, expected a number such as 1.5")
    number = float(text)
    if not math.isfinite(number):
        raise place.error(f"found '{shown(text)}' as {what}, expected a finite number")
    return number


def numbers_at(text: str, place: FilePlace, what: str, count: int | None, notes: list[Note]) -> tuple[float, ...]:
    """So many finite numbers (any, for None) with blanks between them; `what` they are, for messages.

    Commas followed by a blank are taken as such, with a note. Raises DescriptionError at the place.
    """
    if (plain := _plain_numbers(text)) is not None and count in (None, len(plain)):
        return plain
    parts = BLANK.split(COMMA_AFTER.sub(" ", text).strip(" \t\r\n\f\v")) if text.strip() else []
    if count is not None and len(parts) != count:
        comma = ", with blanks and no commas between them" if "," in text else ""
        raise place.error(f"found '{shown(text)}' as {what}, expected {counted(count, 'number')}{comma}")
    if COMMA_AFTER.search(text):
        message = f"found commas in {what} ('{shown(text)}'), taken as blanks: other programs refuse them"
        notes.append(Note(message, place.file, place.line, place.column))
    return tuple(number_at(part, place, what) for part in parts)


def _plain_numbers(text: str) -> tuple[float, ...] | None:
    """The finite numbers in a text without anything else; None where there is more to say of it."""
    if not PLAIN.fullmatch(text):
        return None
    try:
        numbers = tuple(map(float, text.split()))
    except ValueError:
        return None
    return numbers if all(map(math.isfinite, numbers)) else None


def number_of(node: XmlNode, attribute: str, default: float | None = None) -> float:
    """The number that an attribute is. Raises DescriptionError; for none too, without a default."""
    if attribute not in node.attributes:
        if default is None:
            raise node.error(f"found <{shown(node.tag)}> without '{attribute}', expected it")
        return default
    return number_at(node.attributes[attribute], node.place_of(attribute), f"'{attribute}'")


def numbers_of(node: XmlNode, attribute: str, count: int, notes: list[Note]) -> tuple[float, ...]:
    """The so many numbers that an attribute is. Raises DescriptionError; for none too."""
    if attribute not in node.attributes:
        raise node.error(f"found <{shown(node.tag)}> without '{attribute}', expected it")
    place = node.place_of(attribute)
    return numbers_at(node.attributes[attribute], place, f"'{attribute}'", count, notes)
