"""What `robokin plot` and `robokin dof --plot` draw of a mechanism, and the same as text or plain data."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from robokin.arrays import Array
from robokin.cli.output.text import csv_records, json_document, json_line
from robokin.errors import InputError, or_list
from robokin.mobility.assembly import missing_geometry
from robokin.mobility.trace import Trace, trace
from robokin.model import Mechanism
from robokin.pictures.mechanism_scene import MechanismScene, mechanism_scene
from robokin.records.envelope import envelope
from robokin.units import Units

ENDINGS = (".png", ".svg", ".pdf", ".html")

DRAWN_STEPS = 240
"""Configurations of a motion that is drawn, unless another number is asked for."""


def check_drawable(mechanism: Mechanism, output: str | None, option: str) -> None:
    """Raise InputError before the work begins where a picture cannot be drawn after it."""
    if output is not None:
        ending = Path(output).suffix.lower()
        if ending not in ENDINGS:
            raise InputError(f"{option}: found '{output}', expected a name that ends with {or_list(ENDINGS)}")
        if ending != ".html":
            from robokin.pictures.workspace_stills import require_matplotlib

            require_matplotlib(ending)
    if len(missing_geometry(mechanism)) == len(mechanism.joints):
        raise InputError(f"{option}: {mechanism.name} has no geometry, expected where its joints are")


def motion_to_draw(mechanism: Mechanism, drive: str | None = None) -> tuple[Trace | None, str]:
    """The motion that a picture shows; where there is none, None and why."""
    try:
        return trace(mechanism, DRAWN_STEPS, drive), ""
    except InputError as error:
        return None, str(error)


def picture_of(
    mechanism: Mechanism, moved: Trace | None, paths: Array | None, units: Units, ending: str,
    view: tuple[float, float] | None = None, note: str = "",
) -> bytes:  # fmt: skip
    """A mechanism as a file with this ending; planar ones as a flat drawing, unless a view is given."""
    if ending != ".html" and mechanism.space == "planar" and view is None:
        from robokin.pictures.planar_stills import mechanism_picture

        return mechanism_picture(mechanism, moved, paths, units, ending[1:])
    scene = mechanism_scene(mechanism, moved, paths, units, view, note)
    if ending == ".html":
        from robokin.pictures.mechanism_page import mechanism_page

        return mechanism_page(scene)
    from robokin.pictures.mechanism_stills import mechanism_still

    return mechanism_still(scene, ending[1:])


def answer(kind: str, scene: MechanismScene) -> Iterator[bytes]:
    """What a picture shows, as text or as plain data."""
    if kind == "table":
        yield _page(scene)
        return
    document = drawn_record(scene)
    links = document["links"]
    if kind == "csv":
        rows = [[link["name"], joint, *point] for link in links for joint, point in link["points"].items()]
        yield csv_records(["link", "joint", "x", "y", "z"], rows)
        return
    if kind == "jsonl":
        head = envelope("mechanism", scene.mechanism.id, scene.units)
        yield from (json_line(head | link) for link in links)
        return
    yield json_document(document)


def drawn_record(scene: MechanismScene) -> dict[str, Any]:
    """The document of `robokin plot` about a mechanism."""
    mechanism, units = scene.mechanism, scene.units
    links = [{"name": link, "points": _points(mechanism, link, units)} for link in mechanism.links]
    joints = [
        {"name": joint.name, "type": joint.type, "links": list(joint.links),
         "position": None if joint.at is None else (joint.at / units.metres + 0.0).tolist(),
         "axes": None if joint.axes is None else (joint.axes + 0.0).tolist()}
        for joint in mechanism.joints
    ]  # fmt: skip
    more = {"name": mechanism.name, "space": mechanism.space, "ground": mechanism.ground}
    return envelope("mechanism", mechanism.id, units) | more | {"links": links, "joints": joints}


def _points(mechanism: Mechanism, link: str, units: Units) -> dict[str, list[float]]:
    """Where a link's joints are as assembled, in the units."""
    return {
        joint.name: (joint.at / units.metres + 0.0).tolist()
        for joint in mechanism.joints
        if link in joint.links and joint.at is not None
    }


def _page(scene: MechanismScene) -> bytes:
    from robokin.cli.output.tables import heading, pairs, render
    from robokin.pictures.mechanism_text import mechanism_text

    mechanism = scene.mechanism
    moving = [link for link in mechanism.links if link != mechanism.ground]
    entries = [("ground", mechanism.ground), ("links", ", ".join(moving))]
    entries += [("note", scene.note)] if scene.note else []
    return render(heading(mechanism.name, mechanism.space), "", mechanism_text(scene), pairs(entries))
