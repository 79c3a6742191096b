"""Pictures of workspaces with their figures: panels, clouds, two robots beside one another, plates in text."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from robokin.errors import InputError
from robokin.pictures.compose import arm_line, cloud, counts_in, panel
from robokin.pictures.orientation_picture import degrees_in
from robokin.pictures.picture import Panel, Picture
from robokin.pictures.views import View
from robokin.pictures.workspace_cuts import Cut, usual_views
from robokin.records.workspace_records import WORDS
from robokin.units import Units
from robokin.workspace.analyse import SAMPLES
from robokin.workspace.space import Space
from robokin.workspace.workspace_result import Workspace


def plates_of(found: Workspace, views: Sequence[View], units: Units, cores: int | None = None) -> list[str]:
    """Pictures in text: of what was asked for, else of the plane that shows most."""
    from robokin.pictures.plate import plate, shaded_plate

    plates = []
    for view in views or usual_views(found, units)[:1]:
        shades = shaded_plate(view, found, units, cores)
        words = "\n░ few orientations, ▒ half, ▓ most, █ all" if shades is not None else ""
        plates.append(f"{view.title}{words}\n{shades or plate(view, found, units)}")
    return plates


def workspace_picture(
    found: Sequence[Workspace], views: Sequence[list[View]], cuts: Sequence[list[Cut]], units: Units, ending: str,
    cores: int | None = None,
) -> bytes:  # fmt: skip
    """The workspaces of one robot or two as a file with this ending: .html turns, all others are stills.

    views: the planes that are wanted of each, with what is reachable in them as `cuts`; none for the usual ones.
    """
    page_wanted = ending == ".html"
    if len(found) == 1:
        picture = picture_of(found[0], views[0], cuts[0], units, cores, cut=not page_wanted)
    else:
        picture = comparison(found, views, units, cores)
    if page_wanted:
        from robokin.pictures.workspace_page import page

        return page(picture)
    from robokin.pictures.workspace_stills import still

    return still(picture, ending[1:])


def picture_of(
    found: Workspace, views: Sequence[View], cuts: Sequence[Cut], units: Units, cores: int | None, *, cut: bool
) -> Picture:
    """The planes that were asked for; else the usual ones, and the cloud of a solid or a curved set."""
    from robokin.reports.workspace_tables import figures

    space, robot = found.space, found.space.robot
    line, pose = arm_line(robot)
    panels = [_panel(found, view, line, pose, cores) for view in views or _flat_views(found, units)]
    known = [(name, value) for name, value in figures(found, units, cuts) if name]
    picture = Picture(robot.name, _subtitle(found, units), units, panels, figures=known,
                      robot=robot.id, options=_options(found, views))  # fmt: skip
    if views or not (space.dimension == 3 or not panels):
        return picture
    if not cut and space.dimension == 3:
        from robokin.pictures.solid_set import posed_arms, solid_set

        sections = [panel.outline for panel in panels if panel.radial]
        whole = solid_set(found, sections[0] if sections else None)
        if whole is not None:
            return replace(picture, solid=whole, arms=posed_arms(space))
    return replace(picture, cloud=cloud(space, found.seed, [line], cut=cut and space.dimension == 3))


def _options(found: Workspace, views: Sequence[View]) -> str:
    """What a command says beside the robot to find the same."""
    asked = " --dextrous" if found.dexterity is not None else ""
    asked += "".join(" --section" if view.radial else f" --slice {view.name}" for view in views)
    if found.samples != SAMPLES:
        asked += f" --samples {found.samples}"
    return asked + (f" --seed {found.seed}" if found.seed else "")


def comparison(found: Sequence[Workspace], views: Sequence[list[View]], units: Units, cores: int | None) -> Picture:
    """Two robots' sets beside one another, to one scale."""
    from robokin.reports.workspace_tables import size_text

    panels = []
    for one, own in zip(found, views, strict=True):
        line, pose = arm_line(one.space.robot)
        for view in own or _flat_views(one, units)[:1]:
            drawn = _panel(one, view, line, pose, cores)
            title = f"{one.space.robot.name}: {drawn.title}" if own else one.space.robot.name
            panels.append(replace(drawn, title=title))
    if not panels:
        raise InputError("--plot: these sets are no areas and no solids, expected --plot without --compare")
    sizes = [
        f"{one.space.quantity} {size_text(one.measure, one.space.dimension, units)}"
        if one.space.dimension
        else "a point"
        for one in found
    ]
    return Picture(" and ".join(one.space.robot.name for one in found), "  ·  ".join(sizes), units, panels)


def _flat_views(found: Workspace, units: Units) -> list[View]:
    """The usual planes, where the set has an area in them."""
    return usual_views(found, units) if found.space.dimension == 3 or _is_area(found.space) else []


def _is_area(space: Space) -> bool:
    return space.dimension == 2 and space.basis is not None


def _panel(found: Workspace, view: View, line: Any, pose: str, cores: int | None) -> Panel:
    # A slice shows no arm: its links stand in front of and behind it.
    arms = [line] if view.radial or found.space.dimension == 2 else []
    degrees = None
    if found.dexterity is not None and found.dexterity.orientations:
        words = f"part of the {WORDS[found.dexterity.group]} that can be reached"
        degrees = degrees_in(view, found, words, cores)
    drawn = panel(view, arms=arms, pose=pose, degrees=degrees)
    return replace(drawn, counts=counts_in(view, found.space))


def _subtitle(found: Workspace, units: Units) -> str:
    from robokin.reports.workspace_tables import range_text, size_text

    space, extent = found.space, found.extent
    reach = f"reach {range_text(extent.least, extent.greatest, units)}"
    if not space.dimension:
        return reach
    return f"{space.quantity} {size_text(found.measure, space.dimension, units)}  ·  {reach} from the base"
