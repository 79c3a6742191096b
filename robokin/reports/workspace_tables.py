"""Workspaces for eyes."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from math import floor, log10

import numpy as np

from robokin.errors import counted
from robokin.number_text import show
from robokin.pictures.workspace_cuts import Cut
from robokin.records.workspace_records import GROUPS, WORDS, holds_at_a_point, known, ranges_of
from robokin.reports.page_parts import WIDTH, Part
from robokin.reports.page_tables import heading, pairs, render, table
from robokin.units import Units
from robokin.workspace.place import WorkspacePlace
from robokin.workspace.sizes import Measure
from robokin.workspace.workspace_result import Dexterity, Workspace

POWERS = {1: "", 2: "²", 3: "³"}

LARGE = 1e6
"""A size of more than so many of its units is said in metres: 2.5 m³ rather than 2500000000 mm³."""

DIGITS = 7
"""Digits of a size at most."""

SMALL = 1e-6
"""A relative error below this is not said in per cent."""

DECIMALS = {"m": 4, "cm": 2, "mm": 1, "in": 3}
"""Decimals of a bound: what shows in a table is exact to them."""

NOT_PROVEN = "no: not found by search (not proven unreachable)"
"""What is said below places, of which one is not reached and might be."""

KINDS = {0: "a point", 1: "a curve", 2: "a surface", 3: "a solid"}


def workspace_table(found: Workspace, units: Units, cuts: Sequence[Cut] = (), plates: Sequence[str] = ()) -> bytes:
    """The page of a workspace: its figures, then its pictures in text."""
    parts = workspace_parts(found, units, cuts)
    for plate in plates:
        parts += ["", plate.rstrip("\n")]
    return render(*parts)


def workspace_parts(found: Workspace, units: Units, cuts: Sequence[Cut] = ()) -> list[Part]:
    """The parts of the page but for the pictures."""
    robot = found.space.robot
    parts: list[Part] = [heading(robot.name, f"lengths in {units.length}, angles in {units.angle}"), ""]
    parts.append(pairs(figures(found, units, cuts)))
    for note in found.notes:
        parts += ["", textwrap.fill(note, WIDTH)]
    return parts


def figures(found: Workspace, units: Units, cuts: Sequence[Cut] = ()) -> list[tuple[str, str]]:
    """What is known, as names and texts."""
    space, extent = found.space, found.extent
    moved = counted(len(space.moving), "joint")
    entries = [
        ("reachable", f"{_kind(found)}; {moved} of {space.robot.n} move{'s' * (len(space.moving) == 1)} the tool")
    ]
    for i, name in enumerate("xyz"):
        entries.append((name, range_text(extent.low[i], extent.high[i], units)))
    entries.append(("reach", f"{range_text(extent.least, extent.greatest, units)} from the base"))
    if space.dimension:
        entries.append((space.quantity, size_text(found.measure, space.dimension, units)))
        if known(found.measure):
            entries.append(("", f"{found.measure.method}; {found.measure.evaluations} points, seed {found.seed}"))
    entries.append(("structural L", f"{length_text(found.structural_length, units)} {units.length}"))
    if found.length_index is not None and found.volume_index is not None:
        entries.append(("L / ∛V", f"{found.length_index:.4f}  (0.6204 for the ideal arm, 3 for a Cartesian cube)"))
        entries.append(("V / (4/3 π L³)", f"{found.volume_index:.4f}"))
    for cut in cuts:
        parts, holes = counted(cut.outline.pieces, "part"), counted(len(cut.outline.holes), "hole")
        entries.append((cut.name, f"area {size_text(cut.area, 2, units)}; {parts}, {holes}"))
    if found.dexterity is not None:
        entries += _dexterity(found.dexterity, found, units)
    return entries


def comparison_table(found: Sequence[Workspace], units: Units, cuts: Sequence[Sequence[Cut]]) -> bytes:
    """Two workspaces side by side, a row for each figure; both in the units of the first."""
    columns = [dict(figures(one, units, own)) for one, own in zip(found, cuts, strict=True)]
    drawn = table()
    drawn.add_column("", style="cyan", no_wrap=True)
    for one in found:
        drawn.add_column(one.space.robot.name)
    for name in dict.fromkeys(name for column in columns for name in column):
        if name:
            drawn.add_row(name.strip(), *(column.get(name, "") for column in columns))
    sizes = [one.measure.value for one in found]
    notes = []
    if found[0].space.dimension == found[1].space.dimension and min(sizes) > 0.0:
        notes = ["", f"{found[0].space.quantity}: {sizes[1] / sizes[0]:.4g} times as much in the second"]
    rest = f"lengths in {units.length}, angles in {units.angle}"
    return render(heading("Workspaces", rest), "", drawn, *notes)


def _kind(found: Workspace) -> str:
    space = found.space
    flat = space.basis is not None and space.dimension < 3
    kind = {0: "a point", 1: "a line", 2: "part of a plane"}[space.dimension] if flat else KINDS[space.dimension]
    return kind + (", symmetric about the first axis" if space.axis is not None else "")


def _dexterity(dexterity: Dexterity, found: Workspace, units: Units) -> list[tuple[str, str]]:
    dimension = found.space.dimension
    what = WORDS[dexterity.group] + (" of the tool's z axis" if dexterity.group == "S2" else "")
    entries = [("orientations", GROUPS[dexterity.group])]
    if dexterity.orientations:
        spacing = f"{dexterity.spacing / units.radians:.3g} {units.angle}"
        entries = [("orientations", f"{dexterity.orientations} {what}, {spacing} apart")]
        entries.append(("mean", f"{100.0 * dexterity.mean:.1f} % of them, over the reachable set"))
    sets = {
        "one or more": (dexterity.some, "the reachable workspace"),
        "more than one": (dexterity.several, "the lecture's dexterous workspace"),
        "every": (dexterity.every, "the dexterous workspace"),
    }
    if not dimension:
        holds = holds_at_a_point(dexterity).values()
        return entries + [
            (f"  {name}", f"{'yes' if there else 'no'}: {whose}")
            for (name, (_, whose)), there in zip(sets.items(), holds, strict=True)
        ]
    for name, (measure, whose) in sets.items():
        part = f", {100.0 * measure.value / dexterity.some.value:.1f} %" if dexterity.some.value > 0.0 else ""
        entries.append((f"  {name}", f"{size_text(measure, dimension, units)}{part}: {whose}"))
    return entries


def size_text(measure: Measure, dimension: int, units: Units) -> str:
    """A size with its bound: two digits of the bound, and as many decimals of the size, if they are not too many."""
    if not known(measure):
        return "not known"
    metres, unit = units.metres**dimension, units.length
    if max(measure.value, measure.error) / metres > LARGE and unit != "m":
        metres, unit = 1.0, "m"
    value, error = measure.value / metres, measure.error / metres
    unit += POWERS[dimension]
    if value <= 0.0:
        return f"0 {unit}" + (f" ± {error:.2g} {unit}" if error else "")
    most = DIGITS - 1 - floor(log10(value))
    decimals = max(min(1 - floor(log10(error)), most) if error else most, 0)
    bound = f"{error:.{decimals}f}"
    if error and not float(bound):
        bound = f"{error:.1g}"
    part = f" ({100.0 * error / value:.2g} %)" if error > SMALL * value else ""
    return f"{value:.{decimals}f} ± {bound} {unit}{part}"


def range_text(low: float, high: float, units: Units) -> str:
    """`low .. high mm` for two lengths [m]."""
    return f"{length_text(low, units)} .. {length_text(high, units)} {units.length}"


def length_text(value: float, units: Units) -> str:
    """A length [m] in the unit, with the decimals of a bound."""
    text = f"{value / units.metres:.{DECIMALS[units.length]}f}"
    return f"{0.0:.{DECIMALS[units.length]}f}" if float(text) == 0.0 else text


def places_table(places: Sequence[WorkspacePlace], name: str, units: Units) -> bytes:
    """A row for each place that was asked about."""
    drawn = table()
    for column in ("x", "y", "z"):
        drawn.add_column(column, justify="right", no_wrap=True)
    for column in ("reachable", "solutions", "orientations"):
        drawn.add_column(column)
    for place in places:
        point = [show(float(value)) for value in place.point / units.metres + 0.0]
        drawn.add_row(
            *point, "yes" if place.reachable else "no", solutions_text(place), orientations_text(place, units)
        )
    rest = f"lengths in {units.length}, angles in {units.angle}"
    notes = [] if all(place.proven for place in places) else ["", NOT_PROVEN]
    return render(heading(name, rest), "", drawn, *notes)


def solutions_text(place: WorkspacePlace) -> str:
    """How many configurations there are."""
    if not place.counted:
        return "not counted"
    return "infinitely many" if place.solutions is None else str(place.solutions)


def orientations_text(place: WorkspacePlace, units: Units) -> str:
    """Which orientations a place can be reached with, in short."""
    reached = len(place.rotations)
    if not place.reachable:
        return "none"
    if place.group == "curve":
        return GROUPS["curve"]
    if not place.tried and place.group != "finite":
        return "not tried: joints hang on each other"
    if not place.tried:
        return f"{reached} that differ" if place.counted else f"{reached} found by search"
    if len(place.ranges):
        return f"{100.0 * place.fraction:.1f} % of all angles{ranges_text(place, units)}"
    text = f"{100.0 * reached / place.tried:.1f} % of {place.tried} {WORDS[place.group]}"
    if place.group == "S2" and 0 < reached < place.tried:
        middle = np.sum(place.rotations[:, :, 2], axis=0)
        if np.linalg.norm(middle) > 1e-6 * reached:
            shown = ", ".join(show(round(float(value), 3)) for value in middle / np.linalg.norm(middle))
            text += f", about ({shown})"
    return text


def ranges_text(place: WorkspacePlace, units: Units) -> str:
    """The angles of the tool that can be reached, in words."""
    angles, words = ranges_of(place)
    if not angles:
        return ""
    shown = ", ".join(f"{show(a / units.radians)} .. {show(b / units.radians)}" for a, b in angles)
    own, about = words.split(" about ")
    return f": its {own} at {shown} {units.angle} about {about}"
