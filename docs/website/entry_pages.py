"""A page for each entry of the library: picture, table, flange, source, description, commands, and what turns."""

from __future__ import annotations

import html
import io
import re
import sys
from pathlib import Path
from typing import Any
from unittest import mock

from robokin import documents
from robokin.cli import run
from robokin.formats.library import library_file, load_any
from robokin.mobility.trace import trace
from robokin.model import Mechanism, Robot, Tree, WheeledBase
from robokin.number_text import show
from robokin.pictures.arm import default_configuration
from robokin.pictures.drawn_arm import arm_picture
from robokin.pictures.drawn_mechanism import picture_of
from robokin.reports.table_files import markdown_table
from website.thumbnails import HEIGHT, WIDTH, home_scene, thumbnail

STEPS = 96
"""Configurations of a mechanism's motion in its turning page: enough for the eye, and a page stays small."""

COLUMNS = "78"
"""Characters of a line that commands print."""

Entry = Robot | Tree | Mechanism | WheeledBase


def write_entry(
    id: str, pages: Path, files: Path, lectures: dict[str, str], playground: bool = False
) -> dict[str, Any]:
    """Write an entry's page (Markdown) below `pages`, its picture and its description below `files`.

    lectures: the page, seen from the entry's, of each lecturer; playground: whether the site has one. Returns what the
    gallery says of the entry.
    """
    entry = load_any(id)
    path = library_file(id)
    assert path is not None
    (files / "pictures" / f"{id}.png").write_bytes(thumbnail(entry))
    (files / "descriptions" / path.name).write_bytes(path.read_bytes())
    record = documents.show(entry)
    text = path.read_text(encoding="utf-8")
    (pages / f"{id}.md").write_text(page_text(entry, record, text, lectures, playground), encoding="utf-8")
    return {"id": id, "name": record["name"], "kind": record["kind"], "folder": path.parent.name,
            "class": record.get("class"), "space": record.get("space"), "joints": joints_in_short(record),
            "description": record["description"], "source": record["source"]}  # fmt: skip


def write_turning(id: str, files: Path) -> None:
    """Write the page of an entry that turns below `files`; bases on wheels have none."""
    entry = load_any(id)
    if not isinstance(entry, WheeledBase):
        (files / "turning" / f"{id}.html").write_bytes(turning_page(entry))


def turning_page(entry: Robot | Tree | Mechanism) -> bytes:
    """What `robokin plot NAME -o NAME.html` writes; a mechanism's motion in fewer steps."""
    if not isinstance(entry, Mechanism):
        return arm_picture(home_scene(entry), "html")
    from robokin.errors import InputError

    try:
        moved, note = trace(entry, STEPS, None), ""
    except InputError as error:
        moved, note = None, str(error)
    return picture_of(entry, moved, None, entry.units, ".html", note=note)


def page_text(
    entry: Entry, record: dict[str, Any], description: str, lectures: dict[str, str], playground: bool = False
) -> str:
    """The page of an entry in Markdown."""
    id, name = record["id"], record["name"]
    alt = f"{name}: {record['description']}" if record["description"] else name
    parts = [
        # Three hundred names beside each page would help nobody: no toctree has it.
        "---\norphan: true\n---",
        f"# {plain(name)}",
        "[All in the gallery](index.md)",
        plain(sentence(record["description"])),
        f'<img class="robot" src="pictures/{id}.png" alt="{html.escape(alt)}" width="{WIDTH}" height="{HEIGHT}">',
        "" if isinstance(entry, WheeledBase) else _turning(id, name),
        f'<a href="../playground/index.html#r={id}">Change it and ask about it in the playground</a>.'
        if playground
        else "",
        two_columns(facts(entry, record)),
        f"## {'Table' if isinstance(entry, Robot | Tree) else 'Joints' if isinstance(entry, Mechanism) else 'Wheels'}",
        _table(entry, record),
        *_first_answer(entry, id),
        "## Source",
        plain(record["source"]),
        *_lecture(record["source"], lectures),
        "## Description",
        f'This is the library\'s file, <a href="descriptions/{id}.yaml" download>{id}.yaml</a>; '
        f"`robokin new mine.yaml --from {id}` begins a description of your own with it.",
        f"```yaml\n{description.rstrip()}\n```",
        "## Commands to try",
        "```sh\n" + "\n".join(commands(entry, id)) + "\n```",
    ]
    return "\n\n".join(part for part in parts if part) + "\n"


def facts(entry: Entry, record: dict[str, Any]) -> list[tuple[str, str]]:
    """Names and what is known of an entry."""
    units = record["units"]
    lines = [("name in commands", f"`{record['id']}`"), ("joints", joints_in_short(record))]
    if isinstance(entry, Robot):
        lines += [
            ("class", record["class"] + (f"; wrist {record['wrist']}" if record["wrist"] else "")),
            ("freedoms", f"N = {record['n']} joints, task M = {record['m']}, redundancy {record['redundancy']}"),
        ]
        if inverse := record["inverse"]:
            some = "some of infinitely many" if record["redundancy"] else "perhaps not all solutions"
            whole = "every solution" if inverse["complete"] else some
            lines.append(("inverse kinematics", plain(f"{inverse['method']}: {inverse['reason']}; {whole}")))
        at = record["at_zero"]
        lines.append(("flange at zero", f"({', '.join(map(show, at['position']))}) {units['length']}"
                                        + (f", z along {at['z_along']}" if at["z_along"] else "")))  # fmt: skip
        lines.append(("convention", record["convention"]))
    elif isinstance(entry, Tree):
        lines.append(("tips", plain(", ".join(tip["name"] for tip in record["tips"]))))
    elif isinstance(entry, Mechanism):
        lines += [
            ("space", record["space"]),
            ("links", plain(f"{len(record['links'])}, the ground ({record['ground']}) included")),
            ("Grübler's count", f"F = {record['grubler']}"),
        ]
    if record.get("poses"):
        lines.append(("poses", plain(", ".join(record["poses"]))))
    if record["parameters"]:
        lines.append(
            ("parameters", plain(", ".join(f"{key} = {show(value)}" for key, value in record["parameters"].items())))
        )
    return [*lines, ("units", f"{units['length']}, {units['angle']}")]


def joints_in_short(record: dict[str, Any]) -> str:
    """How many joints, or wheels, of which types: `6: RRRRRR`."""
    if record["kind"] == "wheeled":
        return f"{len(record['wheels'])} wheels: {', '.join(dict.fromkeys(w['type'] for w in record['wheels']))}"
    types = record.get("joints")
    if isinstance(types, str):
        return f"{len(types)}: {types}" if types else "none that moves"
    kinds = [joint["type"] for joint in record["joints"]]
    return f"{len(kinds)}: " + ", ".join(f"{kinds.count(kind)} {kind}" for kind in dict.fromkeys(kinds))


def commands(entry: Entry, id: str) -> list[str]:
    """Command lines to begin with."""
    if isinstance(entry, WheeledBase):
        return [f"robokin show {id}", f"robokin dof {id}"]
    if isinstance(entry, Mechanism):
        return [f"robokin show {id}", f"robokin dof {id}", f"robokin plot {id} -o {id}.html"]
    if not entry.n:
        return [f"robokin show {id}", f"robokin fk {id} --frames"]
    q = first_pose(entry)
    if isinstance(entry, Tree):
        tip = entry.tips[0]
        return [f"robokin show {id} --tip {tip}", f"robokin fk {id} --q {q}", f"robokin plot {id} -o {id}.html"]
    lines = [f"robokin show {id}", f"robokin fk {id} --q {q} --frames", f"robokin fk {id} --q {q} | robokin ik {id}"]
    return [*lines, f"robokin jacobian {id} --q {q}", f"robokin workspace {id}", f"robokin plot {id} -o {id}.html"]


def first_pose(entry: Robot | Tree) -> str:
    """The configuration that the picture has, as --q takes it."""
    q, name = default_configuration(entry)
    if name:
        return name
    from robokin.model.joint_units import in_units, joint_factors

    return ",".join(f"{value:.6g}" for value in in_units(q, joint_factors(entry, entry.units)) + 0.0)


def two_columns(lines: list[tuple[str, str]]) -> str:
    """Facts as a table."""
    rows = "\n".join(f"| {name} | {value} |" for name, value in lines)
    return f"| fact | value |\n| :-- | :-- |\n{rows}"


def plain(text: str) -> str:
    """Text that Markdown takes for nothing but text."""
    return re.sub(r"([\\`*_{}\[\]<>#|$~^])", r"\\\1", text)


def sentence(text: str) -> str:
    """A description as a sentence."""
    return text[:1].upper() + text[1:] + "." if text and text[-1] not in ".!?" else text


def printed(*arguments: str) -> str:
    """What a command prints, notes included."""
    screen = io.TextIOWrapper(io.BytesIO(), encoding="utf-8", write_through=True)
    # The command runs in this process, on a screen of its own; all of it is put back, whatever the command does.
    with mock.patch.multiple(sys, stdout=screen, stderr=screen), mock.patch.dict("os.environ", COLUMNS=COLUMNS):
        run(list(arguments))
    return screen.buffer.getvalue().decode().rstrip()  # type: ignore[attr-defined]


def console(*arguments: str) -> str:
    """A command and what it prints."""
    return f"```console\n$ robokin {' '.join(arguments)}\n{printed(*arguments)}\n```"


def _first_answer(entry: Entry, id: str) -> list[str]:
    """The flange's frame in the first pose; of a mechanism and a base its freedoms."""
    if isinstance(entry, Mechanism | WheeledBase):
        return ["## Freedoms", console("dof", id)]
    q = first_pose(entry) if entry.n else ""
    title = "The tips" if isinstance(entry, Tree) else "The flange"
    return [f"## {title} in the first pose", console("fk", id, *(["--q", q] if q else []))]


def _turning(id: str, name: str) -> str:
    page = f"turning/{id}.html"
    return (
        f'<details class="turning"><summary>Turn it, and move its joints</summary>\n'
        f'<iframe src="{page}" title="{html.escape(name)}, turning" loading="lazy"></iframe></details>\n\n'
        f'<p><a href="{page}">On a page of its own</a>, as <code>robokin plot</code> writes it.</p>'
    )


def _table(entry: Entry, record: dict[str, Any]) -> str:
    """The table as published; of a mechanism its joints, of a base its wheels."""
    if isinstance(entry, Robot):
        return markdown_table(record).decode().partition("\n\n")[2]
    if isinstance(entry, Tree):
        return printed("convert", record["id"], "-f", "markdown").partition("\n\n")[2]
    if isinstance(entry, Mechanism):
        lines = ["| joint | type | links | at | axis |", "| :-- | :-- | :-- | :-- | :-- |"]
        for joint in record["joints"]:
            at = " ".join(map(show, joint["at"])) if joint["at"] else ""
            axes = "; ".join(" ".join(map(show, axis)) for axis in joint["axes"] or ())
            cells = [joint["name"], joint["type"], ", ".join(joint["links"]), at, axes]
            lines.append(f"| {' | '.join(map(plain, cells))} |")
        return "\n".join(lines)
    lines = ["| wheel | type | x | y | angle | radius |", "| :-- | :-- | --: | --: | --: | --: |"]
    for wheel in record["wheels"]:
        numbers = [*wheel["at"], wheel["angle"], wheel["radius"]]
        cells = [plain(wheel["name"]), wheel["type"], *("" if v is None else show(v) for v in numbers)]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def _lecture(source: str, lectures: dict[str, str]) -> list[str]:
    """Where the docs walk through the lecture that a source names."""
    found = [(who, page) for who, page in lectures.items() if who in source]
    return [f"The lecture is walked through in [{plain(who)}]({page})." for who, page in found]
