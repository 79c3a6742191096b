"""What `robokin workspace` answers: figures, sections and slices, and pictures of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from robokin.cli.arguments import parse_numbers
from robokin.cli.output.sink import Destination, sink
from robokin.cli.output.text import csv_records, json_document, json_line, json_list
from robokin.cli.workspaces import WORDS, Cut, flat_row, workspace_record
from robokin.errors import InputError, or_list
from robokin.jobs.stages import about, stage
from robokin.model import Robot
from robokin.pictures.compose import (
    arm_line,
    cloud,
    outline_in,
    outline_of,
    panel,
    plane_region,
    rings_about,
    solid_views,
)
from robokin.pictures.orientation_picture import degrees_in
from robokin.pictures.picture import Panel, Picture
from robokin.pictures.views import View, plane_view, section_view, slice_view
from robokin.units import Units
from robokin.workspace.analyse import analyse_workspace
from robokin.workspace.membership import Membership, finitely_many
from robokin.workspace.size_cells import cells_of
from robokin.workspace.space import Space, space_of
from robokin.workspace.workspace_result import Workspace

PLOTS = (".png", ".svg", ".pdf", ".html")

CUT_POINTS = 16
"""One in so many of the samples is the budget of a cut's area: it has a dimension less than what is sampled."""

LEAST_POINTS = 1024


def report(
    robots: Sequence[Robot],
    units: Units,
    kind: str,
    asked: tuple[bool, Sequence[str]],
    plot: str | None,
    arguments: dict[str, Any],
) -> Iterator[bytes]:
    """The workspaces of one robot or two in a format; `asked` tells whether for the section, and for which slices."""
    cores = arguments["cores"]
    # What is asked for must exist before the work begins.
    views = [asked_views(space_of(robot), units, *asked) for robot in robots]
    found, cuts = [], []
    for robot, own in zip(robots, views, strict=True):
        about(robot.name if len(robots) > 1 else "")
        found.append(analyse_workspace(robot, **arguments))
        cuts.append([_cut(view, arguments) for view in own])
    about("")
    if plot is not None or (kind == "table" and len(robots) == 1):
        stage("picture")
    if plot is not None:
        _draw(plot, found, views, cuts, units, cores)
    if kind == "table":
        from robokin.cli.workspace_tables import comparison_table, workspace_table

        if len(found) > 1:
            yield comparison_table(found, units, cuts)
            return
        plates = plates_of(found[0], views[0], units, cores) if plot is None else []
        yield workspace_table(found[0], units, cuts[0], plates)
        return
    records = [workspace_record(one, units, own) for one, own in zip(found, cuts, strict=True)]
    if kind == "csv":
        rows = [flat_row(record) for record in records]
        columns = list(dict.fromkeys(name for row in rows for name in row))
        yield csv_records(columns, [[row.get(name, "") for name in columns] for row in rows])
    elif kind == "jsonl":
        yield from map(json_line, records)
    elif len(records) == 1:
        yield json_document(records[0])
    else:
        yield from json_list([record] for record in records)


def asked_views(space: Space, units: Units, section: bool, slices: Sequence[str]) -> list[View]:
    """The planes that --section and --slice ask for. Raises InputError where a robot has none such."""
    views: list[View] = []
    if (section or slices) and space.dimension != 3:
        option = "--section" if section else "--slice"
        raise InputError(f"{option}: {space.robot.name} reaches no solid, expected an arm that does")
    if section:
        view = section_view(space)
        if view is None:
            raise InputError(f"--section: the first joint of {space.robot.name} does not turn it, expected --slice")
        views.append(view)
    for text in slices:
        name, equals, value = (part.strip() for part in text.partition("="))
        if name not in ("x", "y", "z") or not equals:
            raise InputError(f"--slice: found '{text}', expected x=, y= or z= and a length")
        at = float(parse_numbers(value, "--slice", [False], units, "a length")[0])
        views.append(slice_view(space, name, at * units.metres, f"{at:g} {units.length}"))
    return views


def usual_views(found: Workspace, units: Units) -> list[View]:
    """The planes that show most of a set; none of a point."""
    space = found.space
    if space.dimension < 3:
        return [plane_view(space)] if space.dimension else []
    # A section stands for all directions; without symmetry the orientations differ from one to the next.
    alike = found.dexterity is None or found.dexterity.section
    return solid_views(space, _teller(units), units.metres, section=alike)


def _teller(units: Units) -> Callable[[float], str]:
    return lambda value: f"{value / units.metres:.4g} {units.length}"


def _cut(view: View, arguments: dict[str, Any]) -> Cut:
    """What is reachable in a plane, with its area."""
    stage(f"area of the {view.title}")
    budget = max(arguments["samples"] // CUT_POINTS, LEAST_POINTS)
    seed, cores = arguments["seed"], arguments["cores"]
    area, cells = cells_of(Membership(view.space), plane_region(view), budget, seed, cores)
    # Where the set is known in closed form, or by its radii, its boundary is found without the cells.
    exact = finitely_many(view.space) or rings_about(view)
    return Cut(view.name, view.title, view.labels, outline_in(view) if exact else outline_of(cells), area)


def plates_of(found: Workspace, views: Sequence[View], units: Units, cores: int | None = None) -> list[str]:
    """Pictures in text: of what was asked for, else of the plane that shows most."""
    from robokin.pictures.plate import plate, shaded_plate

    plates = []
    for view in views or usual_views(found, units)[:1]:
        shades = shaded_plate(view, found, units, cores)
        words = "\n░ few orientations, ▒ half, ▓ most, █ all" if shades is not None else ""
        plates.append(f"{view.title}{words}\n{shades or plate(view, found, units)}")
    return plates


# Pictures -------------------------------------------------------------------------------------------------


def require_drawable(plot: str) -> None:
    """Raise InputError before the work begins where a picture could not be drawn after it."""
    ending = Path(plot).suffix.lower()
    if ending not in PLOTS:
        raise InputError(f"--plot: found '{plot}', expected a name that ends with {or_list(PLOTS)}")
    Destination(plot, "--plot")
    if ending != ".html":
        from robokin.pictures.workspace_stills import require_matplotlib

        require_matplotlib(ending)


def _draw(
    plot: str,
    found: Sequence[Workspace],
    views: Sequence[list[View]],
    cuts: Sequence[list[Cut]],
    units: Units,
    cores: int | None,
) -> None:
    ending = Path(plot).suffix.lower()
    page_wanted = ending == ".html"
    if len(found) == 1:
        picture = picture_of(found[0], views[0], cuts[0], units, cores, cut=not page_wanted)
    else:
        picture = comparison(found, views, units, cores)
    if page_wanted:
        from robokin.pictures.workspace_page import page

        data = page(picture)
    else:
        from robokin.pictures.workspace_stills import still

        data = still(picture, ending[1:])
    with sink(plot, "--plot") as stream:
        stream.write(data)


def picture_of(
    found: Workspace, views: Sequence[View], cuts: Sequence[Cut], units: Units, cores: int | None, *, cut: bool
) -> Picture:
    """The planes that were asked for; else the usual ones, and the cloud of a solid or a curved set."""
    from robokin.cli.workspace_tables import figures

    space = found.space
    line, pose = arm_line(space.robot)
    panels = [_panel(found, view, line, pose, cores) for view in views or _flat_views(found, units)]
    whole = None
    if not views and (space.dimension == 3 or not panels):
        whole = cloud(space, found.seed, [line], cut=cut and space.dimension == 3)
    known = [(name, value) for name, value in figures(found, units, cuts) if name]
    return Picture(space.robot.name, _subtitle(found, units), units, panels, whole, known)


def comparison(found: Sequence[Workspace], views: Sequence[list[View]], units: Units, cores: int | None) -> Picture:
    """Two robots' sets beside one another, to one scale."""
    from robokin.cli.workspace_tables import size_text

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
    return panel(view, arms=arms, pose=pose, degrees=degrees)


def _subtitle(found: Workspace, units: Units) -> str:
    from robokin.cli.workspace_tables import range_text, size_text

    space, extent = found.space, found.extent
    reach = f"reach {range_text(extent.least, extent.greatest, units)}"
    if not space.dimension:
        return reach
    return f"{space.quantity} {size_text(found.measure, space.dimension, units)}  ·  {reach} from the base"
