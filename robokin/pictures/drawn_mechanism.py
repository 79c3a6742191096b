"""A mechanism as a picture: whether it can be drawn, the motion that is shown, and the file."""

from __future__ import annotations

from dataclasses import replace

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.mobility.assembly import missing_geometry
from robokin.mobility.trace import Trace, trace
from robokin.model import Mechanism
from robokin.pictures.mechanism_scene import mechanism_scene
from robokin.pictures.picture_files import MOVING, picture_ending
from robokin.units import Units

DRAWN_STEPS = 240
"""Configurations of a motion that is drawn, unless another number is asked for."""


def check_drawable(mechanism: Mechanism, output: str | None, option: str) -> None:
    """Raise InputError before the work begins where a picture cannot be drawn after it."""
    if output is not None:
        picture_ending(output, option, MOVING)
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
    view: tuple[float, float] | None = None, note: str = "", words: str = "",
) -> bytes:  # fmt: skip
    """A mechanism as a file with this ending; planar ones as a flat drawing, unless a view is given.

    words: the mechanism as a command line has it. Raises InputError for a .gif of what does not move.
    """
    if ending not in (".html", ".gif") and mechanism.space == "planar" and view is None:
        from robokin.pictures.planar_stills import mechanism_picture

        return mechanism_picture(mechanism, moved, paths, units, ending[1:])
    scene = replace(mechanism_scene(mechanism, moved, paths, units, view, note), words=words)
    if ending == ".html":
        from robokin.pictures.mechanism_page import mechanism_page

        return mechanism_page(scene)
    if ending == ".gif":
        from robokin.pictures.mechanism_film import mechanism_film

        return mechanism_film(scene)
    from robokin.pictures.mechanism_stills import mechanism_still

    return mechanism_still(scene, ending[1:])
