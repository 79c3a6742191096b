"""An XML text as a tree of nodes that know where they stand.

Read by expat itself, without namespaces: a prefix that nothing declares is common in robots' files, and the readers
know tags as they are written. No entity but XML's own five is taken, nothing is fetched, and size, depth and number of
elements are bounded, so that every text ends in a tree or in a sentence.
"""

from __future__ import annotations

import codecs
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from xml.parsers import expat
from xml.parsers.expat import errors as expat_errors

from robokin.errors import DescriptionError, Note, shown
from robokin.formats.excerpts import excerpt
from robokin.formats.yaml_tree import FilePlace

MAX_XML_BYTES = 1 << 24
"""16 MiB: a hundred times the longest description of a robot."""

MAX_ELEMENTS = 200_000
"""Elements of one text; a humanoid with all its meshes has 5,000."""

MAX_DEPTH = 150
"""Elements within each other; the longest chain of bodies in bodies is a third of it."""

ENCODINGS = {"utf-8": "utf-8", "ascii": "utf-8", "utf-16": "utf-8", "iso8859-1": "latin-1", "cp1252": "cp1252"}
"""What a text that declares an encoding is read by, by Python's name of what it declares: ASCII is a part of UTF-8,
and what declares UTF-16 in so many bytes is none."""

DECLARATION = re.compile(r"<\?xml(?=\s)[^>]*?\?>")
DECLARED = re.compile(r"""\bencoding\s*=\s*["']([\w.:-]+)["']""", re.ASCII)
BEFORE_DECLARATION = 1 << 16
"""Bytes in which the declaration of an encoding is sought: it may stand behind the comment of a licence."""
ATTRIBUTE = re.compile(r"""\s*([^\s=>/"']+)\s*=\s*("[^"]*"|'[^']*')""")
LINE_END = re.compile("\r\n|\r|\n")


@dataclass(eq=False)
class XmlText:
    """A text as it was parsed: `data` in UTF-8, from a line and a column (both from 0) on.

    notes: what of it is no XML and was read nonetheless.
    """

    file: str
    text: str
    data: bytes
    lines: int = 0
    columns: int = 0
    notes: tuple[Note, ...] = ()

    @cached_property
    def text_lines(self) -> list[str]:
        """The lines in which places count."""
        return LINE_END.split(self.text)

    def with_line(self, error: DescriptionError) -> DescriptionError:
        """An error of this text, with its line shown."""
        error.excerpt = excerpt(self.text_lines, error.line, error.column, error.width)
        return error

    def place(self, line: int, column: int, width: int = 1) -> FilePlace:
        """The place of expat's line (from 1) and column (from 0)."""
        return FilePlace(self.file, line + self.lines, column + 1 + (self.columns if line == 1 else 0), width)


@dataclass(eq=False, slots=True)
class XmlNode:
    """An element: its tag and attributes as written, prefixes included; `text` is its own without the children's.

    line counts from 1 and column from 0, as expat has them; offset: of its `<` in the document's data.
    """

    tag: str
    attributes: dict[str, str]
    document: XmlText
    line: int
    column: int
    offset: int
    children: list[XmlNode] = field(default_factory=list)
    text: str = ""

    @property
    def mark(self) -> FilePlace:
        """The place of the tag."""
        return self.document.place(self.line, self.column, len(self.tag) + 1)

    def place_of(self, attribute: str) -> FilePlace:
        """The place of an attribute's value as it stands in the tag; that of the tag where it has none."""
        if attribute in self.attributes:
            for name, at, width in self._written():
                if name == attribute:
                    return self._place_at(at, width)
        return self.mark

    def error(self, message: str, attribute: str = "") -> DescriptionError:
        """A DescriptionError at the tag, or at the value of one of its attributes."""
        return self.place_of(attribute).error(message)

    def all(self, *tags: str) -> list[XmlNode]:
        """The children with one of these tags."""
        return [child for child in self.children if child.tag in tags]

    def first(self, tag: str) -> XmlNode | None:
        """The first child with this tag."""
        return next((child for child in self.children if child.tag == tag), None)

    def derived(self, attributes: dict[str, str], children: list[XmlNode], text: str = "") -> XmlNode:
        """A node at the same place with other contents."""
        return XmlNode(self.tag, attributes, self.document, self.line, self.column, self.offset, children, text)

    def _written(self) -> Iterator[tuple[str, int, int]]:
        """Name, place after the tag's `<` and length of every attribute's value as written."""
        raw = self._raw()
        at = len(self.tag) + 1
        while match := ATTRIBUTE.match(raw, at):
            yield match[1], match.start(2) + 1, max(len(match[2]) - 2, 1)
            at = match.end()

    def _raw(self) -> str:
        """The text of the tag, and what follows it in so many bytes."""
        size = 256 + 8 * sum(len(name) + len(value) for name, value in self.attributes.items())
        return self.document.data[self.offset : self.offset + size].decode("utf-8", "ignore")

    def _place_at(self, at: int, width: int) -> FilePlace:
        """The place so many characters after the tag's `<`."""
        breaks = list(LINE_END.finditer(self._raw(), 0, at))
        if not breaks:
            return self.document.place(self.line, self.column + at, width)
        return self.document.place(self.line + len(breaks), at - breaks[-1].end(), width)


def read_xml(data: bytes | str, file: str) -> XmlNode:
    """The root of an XML text; `file` is the name that errors give it.

    Raises DescriptionError with line and column for what is no XML, has a document type (entities are never expanded),
    or is too large or too deep.
    """
    if len(data) > MAX_XML_BYTES:
        raise DescriptionError(f"found a file over {MAX_XML_BYTES >> 20} MiB, expected a description", file, 1, 1)
    text = data.removeprefix("\ufeff") if isinstance(data, str) else _decoded(data, file)
    text = text.rstrip("\0")  # the end of a text in C, written with it
    start = text.lstrip()  # blank lines before the XML declaration are none of XML's, but files have them
    blank = LINE_END.split(text[: len(text) - len(start)])
    document = XmlText(file, text, b"", len(blank) - 1, len(blank[-1]))
    found = declaration_of(start)
    if found is not None and found.start():  # XML has it at the start alone; other readers take it, and so do people
        before = LINE_END.split(start[: found.start()])
        place = document.place(len(before), len(before[-1]), len("<?xml"))
        said = (
            "found the XML declaration behind a comment, expected it at the start of the file; it is read as if there"
        )
        document.notes = (Note(said, place.file, place.line, place.column),)
        start = start[: found.start()] + re.sub(r"[^\r\n]", " ", found[0]) + start[found.end() :]
    document.data = _without_dashes(start).encode("utf-8", "replace")
    return _TreeBuilder(document).read()


def declaration_of(text: str) -> re.Match[str] | None:
    """The XML declaration of a text, which blanks and comments may stand before; None where it has none."""
    at = 0
    while True:
        while text[at : at + 1].isspace():
            at += 1
        if not text.startswith("<!--", at):
            return DECLARATION.match(text, at)
        end = text.find("-->", at + 4)
        if end < 0:
            return None
        at = end + 3


def _decoded(data: bytes, file: str) -> str:
    """The text that bytes are, by their byte order mark, by what they declare, or as UTF-8."""
    encoding = "utf-8-sig"
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        encoding = "utf-16"
    elif not data.startswith(codecs.BOM_UTF8):
        declaration = declaration_of(data[:BEFORE_DECLARATION].decode("latin-1"))  # a letter a byte
        match = DECLARED.search(declaration[0]) if declaration else None
        try:
            encoding = ENCODINGS[codecs.lookup(match[1]).name] if match else encoding
        except (LookupError, UnicodeError):
            assert match is not None
            raise DescriptionError(f"found the encoding '{shown(match[1])}', expected UTF-8", file, 1, 1) from None
    try:
        return data.decode(encoding)
    except UnicodeDecodeError as error:
        before = LINE_END.split(data[: error.start].decode(encoding, "replace"))
        raise DescriptionError(
            f"found bytes that are no text in {encoding.removesuffix('-sig').upper()}, expected XML in UTF-8, or with "
            'its encoding declared: <?xml version="1.0" encoding="…"?>',
            file,
            len(before),
            len(before[-1]) + 1,
        ) from None


def _without_dashes(text: str) -> str:
    """The text with blanks for `--` within comments, which XML forbids and which files have nonetheless."""
    parts, at = [], 0
    while (start := text.find("<!--", at)) >= 0 and (end := text.find("-->", start + 4)) >= 0:
        parts += [text[at : start + 4], text[start + 4 : end].replace("-", " ")]
        at = end
    return "".join([*parts, text[at:]]) if parts else text


class _TreeBuilder:
    """Expat's events to nodes."""

    def __init__(self, document: XmlText) -> None:
        self.document = document
        self.parser = parser = expat.ParserCreate("utf-8")
        parser.buffer_text = True
        parser.StartElementHandler = self.start
        parser.EndElementHandler = self.end
        parser.CharacterDataHandler = self.characters
        parser.StartDoctypeDeclHandler = self.document_type
        self.open: list[XmlNode] = []
        self.root: XmlNode | None = None
        self.count = 0

    def read(self) -> XmlNode:
        """The root. Raises DescriptionError."""
        try:
            self.parser.Parse(self.document.data, True)
        except expat.ExpatError as error:
            raise self.document.with_line(self.refusal(error)) from None
        except DescriptionError as error:
            raise self.document.with_line(error) from None
        assert self.root is not None  # expat refuses a text without an element
        return self.root

    def here(self, width: int = 1) -> FilePlace:
        return self.document.place(self.parser.CurrentLineNumber, self.parser.CurrentColumnNumber, width)

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        parser = self.parser
        self.count += 1
        if self.count > MAX_ELEMENTS:
            raise self.here().error(f"found more than {MAX_ELEMENTS} elements, expected a description of a robot")
        if len(self.open) >= MAX_DEPTH:
            raise self.here().error(
                f"found '{shown(tag)}' within {len(self.open)} others, expected at most {MAX_DEPTH} within each other"
            )
        line, column, offset = parser.CurrentLineNumber, parser.CurrentColumnNumber, parser.CurrentByteIndex
        node = XmlNode(tag, attributes, self.document, line, column, offset)
        if self.open:
            self.open[-1].children.append(node)
        else:
            self.root = node
        self.open.append(node)

    def end(self, _tag: str) -> None:
        self.open.pop()

    def characters(self, text: str) -> None:
        if not text.isspace():
            node = self.open[-1]
            node.text = node.text + text if node.text else text

    def document_type(self, name: str, _system: str | None, _public: str | None, _inside: int) -> None:
        before = LINE_END.split(self.document.data.partition(b"<!DOCTYPE")[0].decode("utf-8"))
        raise self.document.place(len(before), len(before[-1]), 9).error(
            f"found a document type (<!DOCTYPE {shown(name)} …>), expected none: robokin reads no entities of a file's "
            "own; remove it"
        )

    def refusal(self, error: expat.ExpatError) -> DescriptionError:
        """Expat's error in words."""
        place = self.document.place(error.lineno, error.offset)
        last = self.open[-1] if self.open else None
        opened = f"<{shown(last.tag)}> of line {last.mark.line}" if last is not None else ""
        what = expat_errors.messages.get(error.code, "something else")
        if what == expat_errors.XML_ERROR_TAG_MISMATCH:
            return place.error(f"found another end tag, expected that of {opened}")
        if what == expat_errors.XML_ERROR_DUPLICATE_ATTRIBUTE:
            return place.error("found an attribute twice in one tag, expected it once")
        if what == expat_errors.XML_ERROR_NO_ELEMENTS:
            inside = f"the end of the file within {opened}" if last is not None else "no element"
            return place.error(f"found {inside}, expected XML")
        if what == expat_errors.XML_ERROR_UNDEFINED_ENTITY:
            return place.error("found an entity that is none of XML's own, expected &lt; &gt; &amp; &quot; or &apos;")
        if what == expat_errors.XML_ERROR_JUNK_AFTER_DOC_ELEMENT:
            return place.error("found something after the end of the document's element, expected the end of the file")
        within = f" within {opened}" if opened else ""
        return place.error(f"found what is no XML{within} ({what}), expected well-formed XML")
