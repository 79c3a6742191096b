"""The planes that show a workspace, and what is reachable in them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from robokin.jobs.stages import stage
from robokin.pictures.compose import outline_in, outline_of, plane_region, rings_about, solid_views
from robokin.pictures.outline import Outline
from robokin.pictures.views import View, plane_view
from robokin.units import Units
from robokin.workspace.membership import Membership, counted
from robokin.workspace.size_cells import cells_of
from robokin.workspace.sizes import Measure
from robokin.workspace.workspace_result import Workspace


@dataclass(frozen=True, eq=False)
class Cut:
    """What is reachable in a plane: `name` as it was asked for (z=0.3, or section), its outline, its area [m²]."""

    name: str
    title: str
    labels: tuple[str, str]
    outline: Outline
    area: Measure


CUT_POINTS = 16
"""One in so many of the samples is the budget of a cut's area: it has a dimension less than what is sampled."""

LEAST_POINTS = 1024


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


def cut_of(view: View, samples: int, seed: int = 0, cores: int | None = None) -> Cut:
    """What is reachable in a plane, with its area; samples: of the whole workspace, of which a cut takes a part."""
    stage(f"area of the {view.title}")
    budget = max(samples // CUT_POINTS, LEAST_POINTS)
    area, cells = cells_of(Membership(view.space), plane_region(view), budget, seed, cores)
    # Where the set is known in closed form, or by its radii, its boundary is found without the cells.
    exact = counted(view.space) or rings_about(view)
    return Cut(view.name, view.title, view.labels, outline_in(view) if exact else outline_of(cells), area)
