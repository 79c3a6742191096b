"""The description that a robot of one's own begins with: an example with every key explained, or a copy."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from robokin.errors import InputError
from robokin.files import open_path, read_up_to
from robokin.formats.description_lines import yaml_text
from robokin.formats.library import library_file, load_any
from robokin.formats.part import Part
from robokin.formats.pasted_description import Wishes, described_table
from robokin.formats.read import MAX_BYTES, read_text
from robokin.formats.schema import VERSION
from robokin.formats.written_robot import written
from robokin.formats.written_tree import written_tree
from robokin.model import Robot, Tree
from robokin.units import Units

EXAMPLE = """\
robokin: {version}                 # the format's version
name: {name}
units: {{length: mm, angle: deg}}  # length: m, cm, mm or in; angle: deg or rad
convention: standard       # A = Rot(z, theta) Trans(0, 0, d) Trans(a, 0, 0) Rot(x, alpha); or modified (Craig), frames
parameters:                # names for the cells below; --set upper=350 tries another value
  upper: 300
  fore: 250
joints:                    # a row for each joint; its variable stands in theta (R) or d (P)
  - {{name: waist,    type: R, theta: q1,      d: 400, a: 0,     alpha: -90, limits: [-170, 170]}}
  - {{name: shoulder, type: R, theta: q2 - 90, d: 0,   a: upper, alpha: 0,   limits: [-120, 120]}}
  - {{name: elbow,    type: R, theta: q3,      d: 0,   a: fore,  alpha: 0,   limits: [-150, 150]}}
tool: Trans(80, 0, 0)      # from the last frame to the end effector; also RPY(…), Rot(z, 90)
# base: Trans(0, 0, 0)     # from the world to frame 0
poses:                     # configurations by name: robokin fk FILE --q home
  home: [0, 0, 90]
"""


@dataclass(frozen=True)
class FirstDescription:
    """A description to begin with: its text, what it is a copy of ("" for none), and how a table was read.

    types, convention: of an example and of a table, "" of a copy; missing: names of lengths without a value.
    """

    text: str
    units: Units
    source: str = ""
    types: str = ""
    convention: str = ""
    notes: tuple[str, ...] = ()
    missing: tuple[str, ...] = ()


def example(name: str) -> FirstDescription:
    """The description of an arm of three joints that says what each of its lines is."""
    text = EXAMPLE.format(version=VERSION, name=yaml_text(name))
    return FirstDescription(text, Units("mm", "deg"), types="RRR", convention="standard")


def of_table(text: str, wishes: Wishes) -> FirstDescription:
    """The description of the robot whose table stands in a text. Raises InputError for what is none, or wrong."""
    made = described_table(text, wishes)
    whole = made.text
    for name in made.missing:  # they may be any number; what is wrong beside is told at once
        whole = re.sub(rf"(?m)^  {name}:.*$", f"  {name}: 1", whole)
    read_text(whole, "the table's description")
    return FirstDescription(made.text, made.units, "", made.types, made.convention, made.notes, made.missing)


def copied(source: str) -> FirstDescription:
    """The description of a library robot or of a YAML file as it stands, comments too; of other formats as YAML.

    Raises InputError for what is not there or wrong.
    """
    described = load_any(source, None, None, Part(whole=True))
    path = library_file(source.lower())
    path = path if path is not None else Path(source)
    if path.suffix.lower() in (".yaml", ".yml"):
        with open_path(str(path), "a description") as stream:
            text = read_up_to(stream, str(path), MAX_BYTES, "a description").decode("utf-8-sig")
        return FirstDescription(text, described.units, source)
    if isinstance(described, Tree):
        from robokin.formats.tree_branches import branches_of

        return FirstDescription(written_tree(branches_of(described, "frames")), described.units, source)
    if isinstance(described, Robot):
        return FirstDescription(written(described), described.units, source)
    raise InputError(f"--from: {source} is no robot, expected a library name or a file of a robot")
