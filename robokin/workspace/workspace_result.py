"""What is known of a workspace: frozen values, each size with the bound of its error."""

from __future__ import annotations

from dataclasses import dataclass, field

from robokin.arrays import Array
from robokin.brief import Answer, Brief
from robokin.workspace.size_cells import Cells
from robokin.workspace.sizes import Extent, Measure
from robokin.workspace.space import Space


@dataclass(frozen=True, eq=False, repr=False)
class Dexterity(Brief):
    """How freely the tool can be turned, place by place.

    group: what an orientation means for this arm: "SO(2)" (turns about one axis), "S2" (directions of the
    tool's z axis) or "SO(3)"; "finite", where the position leaves only finitely many, or "curve", where it leaves
    infinitely many but too few for a grid of all: then there is no map. orientations: how many the size of `every`
    was found with, `spacing` [rad] apart, and `tried` how many of a coarser grid the map was. points: (c, 3) [m] the
    places (centres of the cells where some were reached); cell: their side [m]; fraction: (c,) of the orientations
    that can be reached; section: whether points lie in the half
    plane y = 0 of the arm's axis, the rest following by symmetry. mean: the fraction's mean over the reachable set.
    some, several, every: the sizes of the sets with some orientation (the reachable set), with more than one (the
    lecture's dextrous set) and with every one on the grid (the standard dextrous set).
    """

    group: str
    orientations: int
    spacing: float
    points: Array
    cell: float
    fraction: Array
    section: bool
    mean: float
    some: Measure
    several: Measure
    every: Measure
    tried: int = 0


@dataclass(frozen=True, eq=False, repr=False)
class Workspace(Answer):
    """What a robot can reach.

    space: its joints' box and the set's dimension; samples, seed, sampling: what the answers were made from.
    structural_length [m]: Σ (|a| + |d|) over the links plus the strokes of the sliding joints. length_index:
    that length over the cube root of the volume; volume_index: the volume as a part of the sphere of that
    radius; both None unless the set has a volume. cells: what the size was found with, where points were looked at;
    if the set is not symmetric about an axis but they are, the first joint's limits do not count in them.
    """

    space: Space
    samples: int
    seed: int
    sampling: str
    extent: Extent
    measure: Measure
    structural_length: float
    length_index: float | None
    volume_index: float | None
    dexterity: Dexterity | None = None
    notes: tuple[str, ...] = field(default=())
    cells: Cells | None = None

    def __repr__(self) -> str:
        """A line: the size with its bound."""
        robot, size, power = self.space.robot, self.measure, ("", "", "²", "³")[self.space.dimension]
        what = (
            f"{self.space.quantity} {size.value:.6g} ± {size.error:.2g} m{power}" if self.space.dimension else "a point"
        )
        return f"<workspace of {robot.id or robot.name}: {what}>"
