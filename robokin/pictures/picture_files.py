"""The files that pictures are drawn to, by their endings."""

from __future__ import annotations

from pathlib import Path

from robokin.errors import InputError, or_list

ENDINGS = (".png", ".svg", ".pdf", ".html")

MOVING = (*ENDINGS, ".gif")
"""The same of what moves."""


def picture_ending(output: str, option: str, endings: tuple[str, ...] = ENDINGS) -> str:
    """The ending of a picture's name, one of `endings`; `option` is what named it.

    Raises InputError, before the work begins, for one that cannot be drawn: an unknown ending, or a still without
    matplotlib.
    """
    ending = Path(output).suffix.lower()
    if ending not in endings:
        still = ": a .gif is of what moves, a path or a mechanism" if ending == ".gif" else ""
        raise InputError(f"{option}: found '{output}', expected a name that ends with {or_list(endings)}{still}")
    if ending != ".html":
        from robokin.pictures.workspace_stills import require_matplotlib

        require_matplotlib(ending)
    return ending
