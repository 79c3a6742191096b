"""What is said of each entry of the library in a list, without reading all descriptions.

`index.jsonl` in the library's folder has a line for each description, with the check sum of the file that it was made
from. A line counts only for a file with that check sum; any other file is read, so that nobody sees what is no longer
so. `python -m robokin.formats.library_index` writes the index anew; a test says when it should be.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from robokin.formats.kept_robots import check_sum_in
from robokin.formats.library import library_files, library_folder

INDEX = "index.jsonl"


@dataclass(frozen=True)
class Entry:
    """An entry of the library.

    `kind` is robot, mechanism or wheeled; `joints` the types of its joints; `dof` its freedoms, None where its file
    does not state them; `words` say what it is beside its name: its class of arm, its space, its kinds of joints.
    """

    id: str
    name: str
    kind: str
    joints: str
    dof: int | None
    source: str
    units: dict[str, str]
    description: str
    words: str

    def record(self) -> dict[str, Any]:
        """What a list says of it."""
        return {name: getattr(self, name) for name in ("id", "name", "kind", "joints", "dof", "source", "units")}


def library_entries() -> list[Entry]:
    """All entries, sorted by id."""
    known = _known()
    entries = []
    for path in library_files():
        check, entry = known.get(path.stem, (None, None))
        entries.append(entry if entry is not None and check == check_sum(path) else entry_of(path))
    return entries


def entry_of(path: Path) -> Entry:
    """The entry of a description of the library, by reading it."""
    from robokin.formats.read import read_file
    from robokin.model import Mechanism, Robot, Tree

    loaded = read_file(path, id=path.stem)
    dof: Any
    if isinstance(loaded, Robot):
        from robokin.kinematics.structure import structure_of

        structure = structure_of(loaded)
        kind, dof = "robot", loaded.n
        words = ["robot", structure.arm, "redundant" if structure.redundancy > 0 else ""]
    elif isinstance(loaded, Mechanism):
        kind, dof = "mechanism", loaded.expected.get("mobility")
        words = ["mechanism", loaded.space, *sorted({joint.type for joint in loaded.joints})]
    elif isinstance(loaded, Tree):
        kind, dof = "tree", loaded.n
        words = ["tree", "branches", *loaded.tips]
    else:
        kind, dof = "wheeled", loaded.expected.get("mobility")
        words = ["wheeled base", "mobile", *sorted({wheel.type for wheel in loaded.wheels})]
    text = " ".join(word for word in [*words, *_folders(path)] if word)
    units = loaded.units.as_record()
    return Entry(loaded.id, loaded.name, kind, loaded.types, dof, loaded.source, units, loaded.description, text)


def index_text() -> str:
    """The index of the library as it is now."""
    lines = [{"check": check_sum(path), **asdict(entry_of(path))} for path in library_files()]
    return "".join(json.dumps(line, ensure_ascii=False) + "\n" for line in lines)


def _known() -> dict[str, tuple[int, Entry]]:
    """The index: by id the check sum of the file and the entry. A line that is none says nothing."""
    try:
        text = (library_folder() / INDEX).read_text(encoding="utf-8")
    except (OSError, ValueError):
        return {}
    known = {}
    for line in text.splitlines():
        try:
            fields = json.loads(line)
            check = fields.pop("check")
            known[fields["id"]] = check, Entry(**fields)
        except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
            continue
    return known


def check_sum(path: Path) -> int:
    """The check sum of a description of the library."""
    return check_sum_in(library_folder(), path)


def _folders(path: Path) -> tuple[str, ...]:
    """The folders of the library that a description is in: they say what kind of thing it is."""
    return path.relative_to(library_folder()).parts[:-1]


if __name__ == "__main__":
    (library_folder() / INDEX).write_text(index_text(), encoding="utf-8")
