"""The notebooks of docs/notebooks: their cells run in order in one namespace, and what each shows, as Jupyter has it.

IPython is not needed: of the last expression of a cell the text and the table are taken as it takes them. Pages that
turn are not kept in the files, since GitHub shows none and they are long. `make docs` writes what cells show today.
"""

from __future__ import annotations

import ast
import contextlib
import io
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

NOTEBOOKS = Path(__file__).parent.parent / "docs" / "notebooks"

HEAD = {
    "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
    "language_info": {"name": "python"},
}


def notebooks() -> list[Path]:
    """The notebooks by name."""
    return sorted(NOTEBOOKS.glob("*.ipynb"))


def read(path: Path) -> dict[str, Any]:
    """A notebook as plain data."""
    document: dict[str, Any] = json.loads(path.read_text())
    return document


def source_of(cell: dict[str, Any]) -> str:
    """The text of a cell."""
    return "".join(cell["source"])


def shown_by(source: str, names: dict[str, Any], number: int) -> Iterator[dict[str, Any]]:
    """Run a cell among names that are known; its outputs."""
    body = ast.parse(source).body
    last = ast.Expression(body.pop().value) if body and isinstance(body[-1], ast.Expr) else None
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(ast.Module(body, []), f"cell {number}", "exec"), names)
        value = eval(compile(last, f"cell {number}", "eval"), names) if last is not None else None
    if printed.getvalue():
        yield {"name": "stdout", "output_type": "stream", "text": lines(printed.getvalue())}
    if value is None:
        return
    html = getattr(value, "_repr_html_", lambda: None)()
    data = {"text/html": lines(html)} if html and "<iframe" not in html else {}
    if html and "<iframe" in html:
        return
    data["text/plain"] = lines(repr(value))
    yield {"data": data, "execution_count": number, "metadata": {}, "output_type": "execute_result"}


def lines(text: str) -> list[str]:
    """A text as notebooks keep it: a list of lines with their ends."""
    return text.splitlines(keepends=True)


def run(document: dict[str, Any]) -> dict[str, Any]:
    """The notebook with what its cells show today."""
    names: dict[str, Any] = {"__name__": "__main__"}
    cells = []
    count = 0
    for i, cell in enumerate(document["cells"], start=1):
        made = {"cell_type": cell["cell_type"], "id": f"cell-{i}", "metadata": {}, "source": lines(source_of(cell))}
        if cell["cell_type"] == "code":
            count += 1
            made |= {"execution_count": count, "outputs": [*shown_by(source_of(cell), names, count)]}
        cells.append(made)
    return {"cells": cells, "metadata": HEAD, "nbformat": 4, "nbformat_minor": 5}


def text_of(document: dict[str, Any]) -> str:
    """A notebook as its file holds it."""
    return json.dumps(document, indent=1, ensure_ascii=False, sort_keys=True) + "\n"
