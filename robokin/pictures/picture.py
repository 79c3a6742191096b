"""What a picture shows, before anything is drawn: panels of plane sets and a cloud, in metres."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from robokin.arrays import Array, Bytes
from robokin.pictures.outline import Outline
from robokin.units import Units

CLOSED = -0.3
"""Half the width [rad] of a gap that is none, in a solid that a joint's limits leave open."""

ON_AXIS = 0.02
"""A boundary nearer to the axis than this part of a cell is the axis itself, as well as bisection has it."""


@dataclass(frozen=True, eq=False)
class OrientationDegrees:
    """How freely the tool can be turned, place by place: points (c, 2) [m], squares of side `cell` [m] about them,
    fraction (c,) of the orientations; `meaning` is what stands at the colour bar."""

    points: Array
    fraction: Array
    cell: float
    meaning: str


@dataclass(frozen=True, eq=False)
class GridTable:
    """Bytes `values` (n0, n1[, n2]) at the nodes low + step · index of a grid; of fractions 254 is all, and 255 none.

    kind: what its coordinates are: "rz" a section's [m], "rza" with the angle [rad], "xyz" the world's, "uv" a plane's.
    """

    kind: str
    low: Array
    step: Array
    values: Bytes


@dataclass(frozen=True, eq=False)
class Panel:
    """A plane set on its axes.

    labels: the axes' names; outline: the set; free: what it would be without the joints' limits; arms: lines (k, 2)
    [m] from the base to the tool, pose what theirs is called; degrees: colours instead of one fill; radial: whether the
    first label is a distance from an axis; counts: how many configurations reach its places.
    """

    title: str
    labels: tuple[str, str]
    outline: Outline
    free: Outline | None = None
    arms: Sequence[Array] = ()
    pose: str = ""
    degrees: OrientationDegrees | None = None
    radial: bool = False
    counts: GridTable | None = None

    def edges(self) -> list[Array]:
        """The boundary as lines (k, 2) [m], but for what lies on the axis that a section is turned about: there is
        none there."""
        lines: list[Array] = []
        for loop in self.outline.loops:
            near = loop[:, 0] < ON_AXIS * self.outline.cell if self.radial else np.zeros(len(loop), dtype=bool)
            hidden = near & np.roll(near, 1) & np.roll(near, -1)
            if not hidden.any():
                lines.append(np.concatenate([loop, loop[:1]]))
                continue
            # Begun where it is hidden, the loop falls into the parts that are not.
            first = int(np.argmax(hidden))
            turned, shown = np.roll(loop, -first, axis=0), ~np.roll(hidden, -first)
            ends = np.flatnonzero(np.diff(np.concatenate([[False], shown, [False]]).astype(int)))
            lines += [turned[a:b] for a, b in zip(ends[::2], ends[1::2], strict=True)]
        return lines

    def bounds(self) -> tuple[Array, Array]:
        """Corners (2,), (2,) [m] of a box about all that is drawn."""
        parts = [*self.outline.loops, *(self.free.loops if self.free else ()), *self.arms]
        if not self.outline.loops and self.degrees is not None:
            parts += [self.degrees.points - 0.5 * self.degrees.cell, self.degrees.points + 0.5 * self.degrees.cell]
        points = np.concatenate(parts) if parts else np.array([[0.0, 0.0], [1.0, 1.0]])
        return points.min(axis=0), points.max(axis=0)


@dataclass(frozen=True, eq=False)
class Cloud:
    """Points (m, 3) [m], what they are coloured by (m,) with its name ("" where that is the height), and arms as
    lines (k, 3) [m]."""

    points: Array
    values: Array
    meaning: str = ""
    arms: Sequence[Array] = ()


@dataclass(frozen=True, eq=False)
class SolidSet:
    """A solid that can be reached.

    axis (4, 4): the frame that the section (r, z) turns about; edges: lines (k, 2) [m] of its boundary,
    `loops` all of it, the axis included; gaps (n0, n1, k, 2) [rad]: the middle and half the width of what is left out
    at nodes low + step · index of the section, none where the solid is whole. Where there is no axis `block` says which
    points of the world are in it (1) or not (0). counts: how many configurations reach its places; freedom: with which
    part of the orientations.
    """

    axis: Array | None
    loops: tuple[Array, ...] = ()
    edges: tuple[Array, ...] = ()
    low: Array | None = None
    step: float = 0.0
    shape: tuple[int, int] = (0, 0)
    gaps: Array | None = None
    block: GridTable | None = None
    counts: GridTable | None = None
    freedom: GridTable | None = None


@dataclass(frozen=True, eq=False)
class PosedArm:
    """An arm in a named pose ("" where it has no name), as straight pieces: role, a, b, across (3,) [m], width [m],
    number of sides."""

    name: str
    pieces: Sequence[tuple[str, Array, Array, Array, float, int]]


@dataclass(frozen=True, eq=False)
class Picture:
    """Panels and a cloud under a title. `figures` are names with what is known, a line each. solid, arms, robot and
    options: what a page shows beside them: the set itself, the arm in its poses, and what a shell calls them."""

    title: str
    subtitle: str
    units: Units
    panels: Sequence[Panel] = ()
    cloud: Cloud | None = None
    figures: Sequence[tuple[str, str]] = field(default=())
    solid: SolidSet | None = None
    arms: Sequence[PosedArm] = ()
    robot: str = ""
    options: str = ""


def round_steps(low: float, high: float, most: int) -> Array:
    """Round numbers in low … high, at most `most` of them and two where that is possible; 0 is one if it is within."""
    width = high - low
    if not width > 0.0 or most < 2:
        return np.array([low])
    power = 10.0 ** np.floor(np.log10(width / most))
    for step in (power * factor for factor in (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)):
        first, last = np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9)
        if last - first + 1 <= most:
            return np.asarray(np.arange(first, last + 1) * step + 0.0)
    return np.array([low])


def round_name(value: float) -> str:
    """A round number as an axis shows it."""
    return f"{value:.6g}"


def parts(fraction: Array) -> Bytes:
    """Fractions in 0 … 1 as bytes 0 … 254; 255 where there is none."""
    return np.where(np.isfinite(fraction), np.round(254.0 * np.nan_to_num(fraction)), 255.0).astype(np.uint8)
