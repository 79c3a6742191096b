"""From a workspace to what its pictures show."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise, product

import numpy as np

from robokin.arrays import Array, Flags
from robokin.kinematics.forward import forward_kinematics, link_frames
from robokin.model import Robot
from robokin.pictures.outline import CELLS, Outline, trace
from robokin.pictures.picture import Cloud, GridTable, OrientationDegrees, Panel
from robokin.pictures.views import UPRIGHT, View, freed, section_view, slice_view
from robokin.workspace.extremes import extent
from robokin.workspace.membership import Membership, counted, solution_count
from robokin.workspace.region import Region, region_of
from robokin.workspace.sampling import joint_values, positions
from robokin.workspace.size_cells import Cells, split_cells
from robokin.workspace.space import Space, space_of

SHADOW = 1 << 17
"""Configurations that show how large a picture must be, and what a set without a plane looks like."""

LEVEL = 1 << 14
"""Configurations that show at which level a set is widest."""

MARGIN = 0.03
"""Room about sampled points, as a part of their spread: their bounds are that much short at most."""

POINTS = 5000
"""Points looked at for an outline where each must be sought for."""

RING_HALVINGS = 12
"""Bisections of a ring's radius."""

ROUND = 360
"""Corners of a circle."""

CLOUD = 24000
"""Points of a cloud: more are a solid ball to the eye, and a slow page."""

COUNT_STEPS = 100
"""Steps along a picture's longer side at which solutions are counted."""

BEND = 0.5
"""Joint angle [rad] of an arm that has no named pose: neither straight nor folded."""


def solid_views(space: Space, say: Callable[[float], str], size: float, section: bool = True) -> list[View]:
    """The planes that show a solid: the section that is turned about the first axis, and a level slice where the set
    is widest; an upright slice where there is no such section, or `section` is False. Titles say why a slice is there.

    `say` writes a length [m] in its unit; slices are at whole multiples of size [m], or finer ones in a small set.
    """
    p = sampled(space, LEVEL)
    turned = section_view(space)
    middle = 0.5 * (p.min(axis=0) + p.max(axis=0))
    level, aside = float(middle[2]), float(middle[1])
    why, why_aside = "halfway up", "halfway across"
    if turned is not None and turned.labels[1] == "z":
        r, z = turned.places(p).T
        level, aside = float(z[np.argmax(r)]), float(turned.origin[1])
        why, why_aside = "where the set is widest", "through the first joint's axis"
    # Round to the unit where that is fine enough.
    size = min(size, 10.0 ** np.floor(np.log10(0.01 * float(np.max(np.ptp(p, axis=0))))))
    level, aside = (round(value / size) * size + 0.0 for value in (level, aside))
    upright, flat = slice_view(space, "y", aside, say(aside)), slice_view(space, "z", level, say(level))
    upright, flat = (
        replace(view, title=f"{view.title}, {words}") for view, words in ((upright, why_aside), (flat, why))
    )
    return [turned if turned is not None and section else upright, flat]


def panel(
    view: View,
    cells: int | None = None,
    arms: Sequence[Array] = (),
    pose: str = "",
    degrees: OrientationDegrees | None = None,
) -> Panel:
    """The set in a plane, with arms (k, 3) [m] in a named pose and, where limits matter, its outline without them."""
    outline = outline_in(view, cells)
    without = None
    robot = view.space.robot
    limited = any(robot.revolute[i] and not view.space.full[i] for i in range(robot.n))
    if limited and view.space.gears is None:
        without = outline_in(replace(view, space=space_of(freed(robot))), cells)
    shown = [view.places(arm) for arm in arms]
    return Panel(view.title, view.labels, outline, without, shown, pose, degrees, view.radial)


def outline_in(view: View, cells: int | None = None) -> Outline:
    """The outline of what is reachable in a plane."""
    space = view.space
    low, high = bounds_in(view)
    if rings_about(view):
        return _rings(view, float(np.max(np.abs([low, high]))))
    if counted(space):
        return trace(view.contains, low, high, cells or CELLS)
    known = split_cells(Membership(space), plane_region(view), POINTS, POINTS, cores=None)
    return outline_of(known, cells)


def outline_of(known: Cells, cells: int | None = None) -> Outline:
    """The outline of a plane set that is known by cells of a plane's region."""
    return trace(known.contains, known.region.low, known.region.high, cells or CELLS)


def plane_region(view: View) -> Region:
    """The box of a plane that holds the set's shadow on it."""
    low, high = bounds_in(view)
    return Region("plane", low, high, view.origin, np.stack([view.right, view.up], axis=1))


def rings_about(view: View) -> bool:
    """Whether what is seen is made of whole rings about the axis of symmetry."""
    axis = view.space.axis
    if axis is None or view.radial:
        return False
    return bool(np.linalg.norm(np.cross(np.cross(view.right, view.up), axis[:3, 2])) < UPRIGHT)


def _rings(view: View, reach: float) -> Outline:
    """The outline of rings about the axis of symmetry: only their radii are sought for."""
    axis = view.space.axis
    assert axis is not None
    foot = np.array([(axis[:3, 3] - view.origin) @ view.right, (axis[:3, 3] - view.origin) @ view.up])
    step = 2.0 * (reach + float(np.linalg.norm(foot))) / (4 * CELLS)

    def inside(r: Array) -> Flags:
        return view.contains(foot + np.stack([np.abs(r), np.zeros_like(r)], axis=1))

    r = np.asarray(step * (np.arange(4 * CELLS) + 0.5), dtype=np.float64)
    mask = np.concatenate([inside(r), [False]])
    changes = np.flatnonzero(mask[1:] != mask[:-1])
    within = np.where(mask[changes], changes, changes + 1) * step + 0.5 * step
    without = np.where(mask[changes], changes + 1, changes) * step + 0.5 * step
    for _ in range(RING_HALVINGS):
        middle = 0.5 * (within + without)
        at = inside(middle)
        within, without = np.where(at, middle, within), np.where(at, without, middle)
    turn = np.linspace(0.0, 2.0 * np.pi, ROUND, endpoint=False)
    ring = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    # The outermost is an outside, and so is every other one; they end at the axis or at a hole about it.
    loops = [foot + r * (ring if mask[i] else ring[::-1]) for i, r in zip(changes, within, strict=True)]
    return Outline(tuple(loops), step)


def bounds_in(view: View) -> tuple[Array, Array]:
    """Corners (2,), (2,) [m] of a box that holds the set's shadow on a plane."""
    space = view.space
    if view.radial:
        region = region_of(space, extent(space))
        low, high = region.low, region.high
        middle = view.places(region.points(np.array([[0.0, 0.0]])))[0, 1]
        low, high = np.array([low[0], low[1] + middle]), np.array([high[0], high[1] + middle])
    else:
        bounds = extent(space)
        corners = view.places(np.array(list(product(*zip(bounds.low, bounds.high, strict=True)))))
        low, high = corners.min(axis=0), corners.max(axis=0)
        if np.min(np.abs(np.abs([*view.right, *view.up]) - 0.5)) < 0.5 - UPRIGHT:
            # A slanting plane: the box's corners stand out, and samples show how far.
            places = view.places(sampled(space))
            room = MARGIN * np.max(np.ptp(places, axis=0))
            low, high = np.maximum(low, places.min(axis=0) - room), np.minimum(high, places.max(axis=0) + room)
    margin = MARGIN * float(np.max(high - low))
    low, high = low - margin, high + margin
    if view.radial:
        # The axis belongs to the picture: what is missing about it is a hole.
        low[0] = 0.0
    return low, high


def counts_in(view: View, space: Space) -> GridTable | None:
    """How many configurations of a space reach the places of a plane; None where there are infinitely many, or where
    the plane shows what other half planes have, too."""
    if not counted(space) or space.basis is None or (view.radial and space.axis is None):
        return None
    low, high = bounds_in(view)
    step = float(np.max(high - low)) / COUNT_STEPS
    shape = tuple(np.ceil((high - low) / step).astype(int) + 1)
    places = np.stack(np.meshgrid(*(low[i] + step * np.arange(shape[i]) for i in (0, 1)), indexing="ij"), axis=-1)
    count = np.minimum(solution_count(space, view.points(places.reshape(-1, 2))), 254)
    return GridTable("uv", low, np.full(2, step), count.astype(np.uint8).reshape(shape))


def cloud(space: Space, seed: int = 0, arms: Sequence[Array] = (), cut: bool = False) -> Cloud:
    """Points all over the reachable set, evenly: one to a cell; `cut` takes out the half in front, as a page does."""
    p = sampled(space, 4 * SHADOW, seed)
    low, size = p.min(axis=0), np.ptp(p, axis=0)
    if not space.dimension:
        return Cloud(p[:1], p[:1, 2], "", list(arms))
    # Cells so small that there are about as many as points are wanted.
    step = float(np.max(size)) / 12.0
    keep = np.arange(len(p))
    for _ in range(24):
        index = np.floor((p - low) / step).astype(np.int64)
        keep = np.unique((index[:, 0] * 4096 + index[:, 1]) * 4096 + index[:, 2], return_index=True)[1]
        if len(keep) >= CLOUD:
            break
        step /= 1.1
    chosen = p[np.sort(keep)]
    if cut:
        section = section_view(space)
        middle = 0.5 * (p.min(axis=0) + p.max(axis=0)) if section is None else section.origin
        chosen = chosen[chosen[:, 1] >= middle[1]]
    return Cloud(chosen, chosen[:, 2], "", list(arms))


def drawn_poses(robot: Robot) -> dict[str, Array]:
    """The configurations (n,) [rad | m] that pictures show, by name: what the description names, `home` first; else one
    that is neither straight nor folded, without a name."""
    if robot.poses:
        first = "home" if "home" in robot.poses else next(iter(robot.poses))
        return {first: robot.poses[first], **robot.poses}
    low, high = np.clip(robot.limits, -10.0, 10.0).T
    return {"": np.clip(np.where(robot.revolute, BEND, 0.5 * (low + high)), low, high)}


def arm_line(robot: Robot) -> tuple[Array, str]:
    """The arm from its base to its tool, (k, 3) [m], in a pose that the description names, and the pose's name."""
    name, q = next(iter(drawn_poses(robot).items()))
    frames, tool = link_frames(robot, q), forward_kinematics(robot, q)[:3, 3]
    corners = [frames[0, :3, 3]]
    for before, after in pairwise(frames):
        step = after[:3, 3] - before[:3, 3]
        # A link of a table runs along the joint's axis and across it: its corner is drawn.
        if robot.convention == "standard":
            corners.append(before[:3, 3] + (step @ before[:3, 2]) * before[:3, 2])
        elif robot.convention == "modified":
            corners.append(after[:3, 3] - (step @ after[:3, 2]) * after[:3, 2])
        corners.append(after[:3, 3])
    line = np.array([*corners, tool])
    apart = np.linalg.norm(np.diff(line, axis=0), axis=1) > 1e-9
    return line[np.concatenate([[True], apart])], name


def sampled(space: Space, count: int = SHADOW, seed: int = 0) -> Array:
    """(m, 3) where an even sequence of configurations puts the tool [m]."""
    return positions(space, joint_values(space, "sobol", seed, 0, count, count)).T
