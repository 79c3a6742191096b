"""A solid that can be reached, as a page draws it: by its section where the first joint turns it, else by points.

The first joint turns all that follows. So a solid is its section (r, z), and at each place of it the angles at which
the joint's limits leave something out: gaps. Where it makes a whole turn there are none.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from robokin.arrays import Array, Bytes, Flags, Index
from robokin.pictures.arm import arm_of, body_frames
from robokin.pictures.arm_bars import ends_of
from robokin.pictures.compose import drawn_poses, outline_in
from robokin.pictures.orientation_picture import OrientationMap, map_in_space
from robokin.pictures.outline import Outline
from robokin.pictures.picture import CLOSED, GridTable, Panel, PosedArm, SolidSet, parts
from robokin.pictures.views import View, section_view
from robokin.workspace.membership import counted, drawn_reachable, solution_count
from robokin.workspace.sampling import joint_values, positions
from robokin.workspace.space import Space

if TYPE_CHECKING:
    from robokin.workspace.workspace_result import Workspace

NODES = 9000
"""Nodes of the grid over the section's box: steps of a hundredth of its sides."""

BLOCK_NODES = 40
"""Nodes along the longest side of a solid that has no section."""

CONFIGURATIONS = 1 << 19
"""Configurations that show at which angles a place of the section is reached: some hundred for each."""

ENOUGH = 12
"""Configurations at a place from which on its gaps are believed."""

MOST_GAPS = 3
"""Gaps of a place at most: of a joint that turns by a third of a turn there may be as many."""

COARSE = 2
"""Steps of the section's grid to one of the grid on which solutions are counted, where angles differ, too."""

ANGLES = 48
"""Angles of that grid."""

MOST_POSES = 8
"""Poses at most that a page has a choice of."""


def solid_set(found: Workspace, section: Outline | None) -> SolidSet | None:
    """The solid of a workspace; `section`: its section's outline, where that is known already. None where its outline
    was not found."""
    space = found.space
    view = section_view(space)
    if view is None:
        return SolidSet(None, block=_block(space, found), freedom=map_in_space(found))
    outline = outline_in(view) if section is None else section
    if not outline.loops:
        return None
    corners = np.concatenate(outline.loops)
    low, high = corners.min(axis=0), corners.max(axis=0)
    step = float(np.sqrt(np.prod(high - low) / NODES))
    # Thin sets have as many steps across as make a surface.
    step = min(step, float(np.min(high - low)) / 12.0)
    across, along = np.ceil((high - low) / step - 1e-9).astype(int) + 3
    sides = int(across), int(along)
    # A step beyond each end; about the axis the other side is the same.
    first = np.array([max(low[0] - step, -step), low[1] - step])
    axis = np.eye(4)
    axis[:3, :3] = np.stack([view.right, np.cross(view.up, view.right), view.up], axis=1)
    axis[:3, 3] = view.origin
    panel = Panel("", view.labels, outline, radial=True)
    gaps = None if space.axis is not None else _gaps(space, view, axis, first, step, sides)
    return SolidSet(
        axis, outline.loops, tuple(panel.edges()), first, step, sides, gaps,
        counts=_counts(space, view, axis, first, step, sides), freedom=_freedom(found, view, first, step, sides),
    )  # fmt: skip


def nodes_of(low: Array, step: Array | float, shape: tuple[int, ...]) -> Array:
    """(..., d) the places of a grid's nodes."""
    steps = np.broadcast_to(step, (len(shape),))
    sides = [low[i] + steps[i] * np.arange(n) for i, n in enumerate(shape)]
    return np.stack(np.meshgrid(*sides, indexing="ij"), axis=-1)


def _gaps(space: Space, view: View, axis: Array, low: Array, step: float, shape: tuple[int, int]) -> Array:
    """(n0, n1, k, 2) [rad] the middle and half the width of the gaps at the nodes of a section."""
    first = space.moving[0]
    q = joint_values(space, "sobol", 0, 0, CONFIGURATIONS, CONFIGURATIONS)
    q[first] = 0.0
    offset = (positions(space, q).T - axis[:3, 3]) @ axis[:3, :3]
    index = np.round((np.stack([np.hypot(offset[:, 0], offset[:, 1]), offset[:, 2]], axis=1) - low) / step).astype(int)
    inside = np.all((index >= 0) & (index < shape), axis=1)
    node = index[inside] @ np.array([shape[1], 1])
    # A configuration reaches all angles from where the joint's range begins to where it ends; a joint whose axis points
    # down turns the other way.
    turned = view.space.axis
    assert turned is not None
    least = space.low[first] if turned[:3, 2] @ view.up > 0.0 else -space.high[first]
    begin = np.mod(np.arctan2(offset[inside, 1], offset[inside, 0]) + least, 2.0 * np.pi)
    range_ = float(space.high[first] - space.low[first])
    order = np.lexsort((begin, node))
    node, begin = node[order], begin[order]
    starts = np.concatenate([[True], node[1:] != node[:-1]])
    where = np.flatnonzero(starts)
    number = np.cumsum(starts) - 1
    # The next beginning at the same node, round the circle.
    following = np.append(begin[1:], 0.0)
    last = np.append(where[1:], len(node)) - 1
    following[last] = begin[where] + 2.0 * np.pi
    wide = following - begin - range_
    count = min(int(2.0 * np.pi / range_ + 1e-9), MOST_GAPS)
    gaps = np.zeros((shape[0] * shape[1], count, 2))
    gaps[..., 1] = CLOSED
    known = np.zeros(shape[0] * shape[1], dtype=bool)
    # Where few fell nothing is known of the ends, if there are places enough where many did.
    fell = np.diff(np.append(where, len(node)))
    known[node[where[fell >= min(ENOUGH, int(np.median(fell)))]]] = True
    open_ = np.flatnonzero(wide > 0.0)
    # The widest of each node first.
    open_ = open_[np.lexsort((-wide[open_], number[open_]))]
    rank = np.arange(len(open_)) - np.searchsorted(number[open_], number[open_])
    some = rank < count
    gaps[node[open_[some]], rank[some], 0] = following[open_[some]] - 0.5 * wide[open_[some]]
    gaps[node[open_[some]], rank[some], 1] = 0.5 * wide[open_[some]]
    gaps[..., 0] = np.mod(gaps[..., 0], 2.0 * np.pi)
    gaps = np.asarray(gaps.reshape(*shape, count, 2))
    known = known.reshape(shape)
    # About the axis the other side has the same, half a turn on.
    if low[0] < 0.0 and shape[0] > 2:
        gaps[0], known[0] = gaps[2], known[2]
        gaps[0, ..., 0] = np.mod(gaps[0, ..., 0] + np.pi, 2.0 * np.pi)
    gaps = _spread(gaps, known)
    if count == 1:
        # Few configurations fall to some nodes: their neighbours know better where the gap ends.
        for _ in range(2):
            beside = np.pad(gaps[..., 0, :], ((1, 1), (1, 1), (0, 0)), mode="edge")
            around = np.lib.stride_tricks.sliding_window_view(beside, (3, 3), axis=(0, 1))
            around = around.reshape(*shape, 2, 9)
            turn = np.mod(around[:, :, 0] - gaps[..., 0] + np.pi, 2.0 * np.pi) - np.pi
            # Where there is no gap its middle has no meaning.
            turn = np.where(around[:, :, 1] > CLOSED, turn, 0.0)
            gaps[..., 0, 0] = np.mod(gaps[..., 0, 0] + np.median(turn, axis=-1), 2.0 * np.pi)
            gaps[..., 0, 1] = np.median(around[:, :, 1], axis=-1)
    return gaps


def _spread(gaps: Array, known: Flags) -> Array:
    """Gaps where no configuration fell, as at a neighbour that is known."""
    gaps, known = gaps.copy(), known.copy()
    while not known.all() and known.any():
        before = known.copy()
        for axis in (0, 1):
            for by in (1, -1):
                there = np.roll(before, by, axis)
                edge = [slice(None), slice(None)]
                edge[axis] = slice(0, 1) if by > 0 else slice(-1, None)
                there[tuple(edge)] = False
                take = there & ~known
                gaps[take] = np.roll(gaps, by, axis)[take]
                known |= take
    return gaps


def _counts(space: Space, view: View, axis: Array, low: Array, step: float, shape: tuple[int, int]) -> GridTable | None:
    """How many configurations reach the nodes of a section; where they differ all round, those of a coarser grid."""
    if not counted(space):
        return None
    if space.axis is not None:
        places = nodes_of(low, step, shape).reshape(-1, 2)
        count = solution_count(space, view.points(np.abs(places) * [1.0, 0.0] + places * [0.0, 1.0]))
        return GridTable("rz", low, np.full(2, step), _bytes(count).reshape(shape))
    fewer = ((shape[0] - 1) // COARSE + 1, (shape[1] - 1) // COARSE + 1, ANGLES)
    steps = np.array([COARSE * step, COARSE * step, 2.0 * np.pi / ANGLES])
    r, z, a = np.moveaxis(nodes_of(np.append(low, 0.0), steps, fewer).reshape(-1, 3), 1, 0)
    points = np.stack([r * np.cos(a), r * np.sin(a), z], axis=1) @ axis[:3, :3].T + axis[:3, 3]
    return GridTable("rza", np.append(low, 0.0), steps, _bytes(solution_count(space, points)).reshape(fewer))


def _freedom(found: Workspace, view: View, low: Array, step: float, shape: tuple[int, int]) -> GridTable | None:
    """Which part of the orientations can be reached at the nodes of a section, or in space."""
    if found.dexterity is None or not found.dexterity.section:
        return map_in_space(found)
    freedom = OrientationMap.of(view, found)
    if freedom is None:
        return None
    places = nodes_of(low, step, shape).reshape(-1, 2)
    fraction = freedom.at(np.abs(places) * [1.0, 0.0] + places * [0.0, 1.0])
    return GridTable("rz", low, np.full(2, step), parts(fraction).reshape(shape))


def _block(space: Space, found: Workspace) -> GridTable:
    """Which nodes of a grid can be reached."""
    low, high = found.extent.low, found.extent.high
    step = float(np.max(high - low)) / (BLOCK_NODES - 2)
    # The boundary of a box that fills its extent falls halfway between nodes.
    shape = tuple(int(n) for n in np.maximum(np.round((high - low) / step), 1).astype(int) + 2)
    steps = (high - low) / (np.array(shape) - 2)
    first = low - 0.5 * steps
    points = nodes_of(first, steps, shape).reshape(-1, 3)
    inside = (
        found.cells.contains(found.cells.region.coordinates(points)) if found.cells else drawn_reachable(space, points)
    )
    return GridTable("xyz", first, steps, inside.astype(np.uint8).reshape(shape))


def _bytes(count: Index) -> Bytes:
    return np.minimum(count, 254).astype(np.uint8)


def posed_arms(space: Space) -> list[PosedArm]:
    """The arm in its named poses, as `robokin plot` draws it; one without a name looks ahead."""
    robot = space.robot
    shape, found = arm_of(robot), []
    for name, q in list(drawn_poses(robot).items())[:MOST_POSES]:
        if not name and space.moving[0] == 0 and robot.revolute[0]:
            q = np.concatenate([np.clip([0.0], space.low[0], space.high[0]), q[1:]])
        frames = body_frames(robot, q)
        pieces = []
        for bar in shape.bars:
            a, b = ends_of(bar, frames)
            pieces.append((bar.role, a, b, frames[bar.bodies[0], :3, :3] @ bar.across, bar.width, bar.sides))
        found.append(PosedArm(name, pieces))
    return found
