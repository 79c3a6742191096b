"""What a picture shows, before anything is drawn: panels of plane sets and a cloud, in metres."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from robokin.arrays import Array
from robokin.pictures.outline import Outline
from robokin.units import Units

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
class Panel:
    """A plane set on its axes.

    labels: the axes' names; outline: the set; free: what it would be without the joints' limits; arms: lines (k, 2)
    [m] from the base to the tool, pose what theirs is called; degrees: colours instead of one fill; radial: whether the
    first label is a distance from an axis.
    """

    title: str
    labels: tuple[str, str]
    outline: Outline
    free: Outline | None = None
    arms: Sequence[Array] = ()
    pose: str = ""
    degrees: OrientationDegrees | None = None
    radial: bool = False

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
class Picture:
    """Panels and a cloud under a title. `figures` are names with what is known, a line each."""

    title: str
    subtitle: str
    units: Units
    panels: Sequence[Panel] = ()
    cloud: Cloud | None = None
    figures: Sequence[tuple[str, str]] = field(default=())


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
