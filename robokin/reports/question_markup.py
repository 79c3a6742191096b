"""Texts with tables, once as Markdown and once as LaTeX. Whatever a name holds is text in both."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

from robokin.reports.table_files import latex_escaped, printable

MARKED = re.compile(r"([\\`*_{}\[\]<>#|!~$&])")
"""What Markdown, or HTML within it, would read as something else."""

GREEK = {"theta": "θ", "alpha": "α", "lambda": "λ", "deg": "°"}
VARIABLE = re.compile(r"\b([qvw])([0-9xyz]+)\b")


@dataclass(frozen=True)
class TextBlock:
    """A paragraph; `level` above 0 makes it a heading."""

    text: str
    level: int = 0


@dataclass(frozen=True)
class TableBlock:
    """A table: headings and rows of cells."""

    headings: Sequence[str]
    rows: Sequence[Sequence[str]]


@dataclass(frozen=True)
class RawBlock:
    """What is already written in both."""

    markdown: str
    latex: str


KEPT = 1 << 14
"""Texts of which it is kept how they are written: the same words stand on every sheet."""

Block = TextBlock | TableBlock | RawBlock

PREAMBLE = r"""\documentclass[11pt]{article}
\usepackage[a4paper, margin=25mm]{geometry}
\usepackage{amsmath, booktabs, tikz}
\usepackage[T1]{fontenc}
\setlength{\parindent}{0pt}
\setlength{\parskip}{6pt}
\begin{document}
"""


def markdown(blocks: Sequence[Block]) -> bytes:
    """The blocks as Markdown."""
    return (markdown_parts(blocks) + "\n").encode()


def markdown_parts(blocks: Sequence[Block]) -> str:
    """The same as a part of a text."""
    parts = []
    for block in blocks:
        if isinstance(block, TextBlock):
            parts.append("#" * block.level + " " * bool(block.level) + markdown_escaped(block.text))
        elif isinstance(block, RawBlock):
            parts.append(block.markdown)
        else:
            lines = [[*map(markdown_escaped, line)] for line in (block.headings, *block.rows)]
            lines.insert(1, ["--:"] * len(block.headings))
            parts.append("\n".join(f"| {' | '.join(line)} |" for line in lines))
    return "\n\n".join(parts)


def latex(blocks: Sequence[Block]) -> bytes:
    """The blocks as a LaTeX document; names beyond Latin letters want LuaLaTeX or XeLaTeX."""
    return (PREAMBLE + latex_parts(blocks) + "\n\n\\end{document}\n").encode()


def latex_parts(blocks: Sequence[Block]) -> str:
    """The same as a part of a document."""
    parts = []
    for block in blocks:
        if isinstance(block, TextBlock):
            title = {1: "section*", 2: "subsection*"}.get(block.level)
            text = latex_text(block.text)
            parts.append(rf"\{title}{{{text}}}" if title else text)
        elif isinstance(block, RawBlock):
            parts.append(block.latex)
        else:
            lines = [r"\nopagebreak", r"\begin{tabular}{" + "r" * len(block.headings) + "}", r"\toprule"]
            lines += [_row(block.headings), r"\midrule", *map(_row, block.rows), r"\bottomrule", r"\end{tabular}"]
            parts.append("\n".join(lines))
    return "\n\n".join(parts)


def in_both(blocks: Sequence[Block]) -> RawBlock:
    """Blocks written once, for many texts."""
    return RawBlock(markdown_parts(blocks), latex_parts(blocks))


def _row(cells: Sequence[str]) -> str:
    return " & ".join(map(latex_text, cells)) + r" \\"


@lru_cache(KEPT)
def markdown_escaped(text: str) -> str:
    """A text in which nothing is Markdown or HTML."""
    text = MARKED.sub(r"\\\1", printable(text))
    return re.sub(r"^([-+=]|\d+[.)])(?=\s|$)", _as_text, text)


def _as_text(found: re.Match[str]) -> str:
    """The beginning of a list or of a heading's line as text."""
    return found[1][:-1] + "\\" + found[1][-1]


@lru_cache(KEPT)
def latex_text(text: str) -> str:
    """A text in which nothing is a command, numbers and variables as LaTeX sets them."""
    if re.fullmatch(r"-?[0-9.]+", text):
        return f"${text}$"
    escaped = latex_escaped(text)
    for name, letter in GREEK.items():
        escaped = escaped.replace(letter, r"\textdegree{}" if name == "deg" else rf"$\{name}$")
    return VARIABLE.sub(r"$\1_{\2}$", escaped)
