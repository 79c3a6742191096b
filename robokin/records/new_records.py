"""The document of `robokin new`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from robokin.formats.first_description import FirstDescription
from robokin.records.envelope import envelope


def new_record(made: FirstDescription, file: str) -> dict[str, Any]:
    """The document about a description that was made, and written to a file (- for none)."""
    about = envelope("file", file, made.units, Path(file).stem)
    about |= {"from": made.source or None, "joints": made.types or None, "convention": made.convention or None}
    return about | {"notes": [*made.notes], "missing": [*made.missing], "description": made.text}
