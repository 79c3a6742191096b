"""Files in other formats than robokin's own: URDF, xacro, MJCF, SDF."""

from __future__ import annotations

import re
from collections.abc import Mapping as MappingType
from pathlib import Path

from robokin.errors import InputError
from robokin.files import open_path, read_up_to
from robokin.formats.part import Part
from robokin.formats.xml_tree import MAX_XML_BYTES
from robokin.model import Tree

FIRST_TAG = re.compile(rb"<([A-Za-z_][\w.-]*)")
"""The root's tag, where no comment stands before it."""

MACROS = re.compile(rb"<xacro:|[$][{(]")
"""What is left for xacro to do in a file, whatever it is called."""

PROLOGUE = re.compile(rb"<!--.*?-->|<[?!][^>]*>", re.DOTALL)


def read_foreign(path: Path, overrides: MappingType[str, str], mode: int | None, part: Part) -> Tree:
    """The tree in a file of another format, by its ending, and an `.xml` file's by its first tag.

    Raises DescriptionError where it is wrong, InputError where it cannot be read, or is asked for what it has not.
    """
    place = str(path)
    if mode is not None:
        raise InputError(f"--mode: {place} is no mechanism, expected a mechanism whose links have lengths")
    ending = path.suffix.lower()
    if overrides and ending != ".xacro":
        raise InputError(f"{place} has no parameter '{next(iter(overrides))}': it has none")
    expected = "a description (.urdf, .xacro, .xml, .sdf)"
    if ending == ".xacro":
        from robokin.formats.xacro import read_xacro

        return read_xacro(path, packages=part.packages, arguments=overrides, exact=part.exact)
    with open_path(place, expected) as stream:
        data = read_up_to(stream, place, MAX_XML_BYTES, expected)
    if ending in (".xml", ".mjcf"):
        found = FIRST_TAG.search(PROLOGUE.sub(b"", data[:65536]))
        ending = {b"robot": ".urdf", b"sdf": ".sdf"}.get(found[1] if found else b"", ".mjcf")
    if ending == ".urdf":
        if MACROS.search(data):
            from robokin.formats.xacro import read_xacro

            return read_xacro(path, packages=part.packages, exact=part.exact)
        from robokin.formats.urdf import read_urdf

        return read_urdf(data, place, exact=part.exact, id=path.stem)
    if ending == ".sdf":
        from robokin.formats.sdf import read_sdf

        return read_sdf(data, place, exact=part.exact, id=path.stem)
    from robokin.formats.mjcf import read_mjcf

    return read_mjcf(path, place, exact=part.exact, id=path.stem)  # what it includes is beside it
