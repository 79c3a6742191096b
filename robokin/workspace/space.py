"""What of a robot moves its tool's origin, over which joint values, and what kind of set that makes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from robokin.arrays import Array, Flags
from robokin.brief import Brief
from robokin.errors import InputError
from robokin.kernel.chain import Chain, chain_of, chain_size, row_standing
from robokin.kernel.frames import frames
from robokin.kernel.geometric_jacobian import jacobian_of
from robokin.kernel.ranks import RANK
from robokin.model import CoupledRobot, Robot
from robokin.spatial.angles import TURN
from robokin.workspace.geared_box import geared_box
from robokin.workspace.half_spaces import HalfSpaces

STILL = 1e-9
"""A joint that moves the origin by less, as a part of the arm's size, does not move it."""

HELD = 1e-9
"""A joint with less of a range [rad | size] has one value."""

PROBES = 64
"""Random configurations at which ranks and spans are looked at."""


@dataclass(frozen=True, eq=False, repr=False)
class Gears(Brief):
    """How the n variables of a robot whose joints hang on each other move the m joints of its chain: v = S u.

    S: (m, n); constant parts of v are in the chain's offsets. cuts: what the variables must satisfy beside their box.
    telling: (m,) which joints move the tool's origin at all: the turn of a spindle that carries it does not.
    """

    S: Array
    cuts: HalfSpaces
    telling: Flags


@dataclass(frozen=True, eq=False, repr=False)
class Space(Brief):
    """A robot's joint box and what its image under the tool's origin is like.

    Of a robot whose joints hang on each other (`gears`) the box is that of its variables, and the chain that of the
    joints that they move; what is said of joints here is said of variables.

    low, high: (n,) the box [rad | m]; a revolute joint that can make a whole turn has just one, whose
    `full` is True. moving: the joints (from 0) that move the tool's origin. dimension: of the reachable set.
    basis: (3, dimension) orthonormal directions of the plane or line that holds a flat set, centre (3,) a
    point of it [m]; None for a curved surface or curve. axis: (4, 4) a frame whose z axis the set is symmetric
    about, since the first moving joint makes a whole turn about it; else None. size: the arm's size [m].
    """

    robot: Robot
    chain: Chain
    low: Array
    high: Array
    full: Flags
    moving: tuple[int, ...]
    dimension: int
    basis: Array | None
    centre: Array
    axis: Array | None
    size: float
    gears: Gears | None = None

    @property
    def held(self) -> Flags:
        """(n,) which joints' limits leave them one value."""
        return np.asarray(self.high - self.low <= HELD * np.where(self.robot.revolute, 1.0, self.size))

    @cached_property
    def arm(self) -> Robot:
        """The robot with fixed rows for the joints that are held: its joints are those that can be chosen.

        With gears the arm of all their joints, each of which moves by itself and without limits.
        """
        held, robot = self.held, self.robot
        if isinstance(robot, CoupledRobot):
            return robot.free_motion
        if not held.any():
            return robot
        middle = (0.5 * (self.low + self.high)).tolist()
        standing = {id(joint): at for joint, at, stays in zip(robot.joints, middle, held, strict=True) if stays}
        rows = [
            row_standing(row, standing[id(row)], robot.convention) if id(row) in standing else row for row in robot.rows
        ]
        return replace(robot, rows=tuple(rows), poses={})

    @property
    def quantity(self) -> str:
        """What the size of the reachable set is called."""
        return ("point", "length", "area", "volume")[self.dimension]

    def motions(self, q: Array) -> Array:
        """The values (..., m) of the chain's joints at q (..., n) [rad | m]: q itself, without gears."""
        return q if self.gears is None else np.asarray(q @ self.gears.S.T)

    def by_variables(self, J: Array, size: float = 1.0) -> Array:
        """Derivatives (..., k, n) by the variables from those by the chain's joints (..., k, m), where a slide's value
        is told in sizes [m]."""
        if self.gears is None:
            return J
        return J @ self.scaled_gears(size)

    def scaled_gears(self, size: float) -> Array:
        """(m, n) S, where the values of slides are told in sizes [m]."""
        assert self.gears is not None
        unit, own = (np.where(turns, 1.0, size) for turns in (self.robot.revolute, self.chain.revolute))
        return np.asarray(self.gears.S * unit / own[:, None])

    @property
    def leads(self) -> bool:
        """Whether the first moving joint turns or shifts all that follows, and nothing else: so it is without gears."""
        if self.gears is None or not self.moving:
            return True
        S, first = self.gears.S, self.moving[0]
        rows = np.flatnonzero(S[:, first])
        if len(rows) != 1 or S[rows[0], first] != 1.0 or self.gears.cuts.linked[first]:
            return False
        return bool(np.sum(S[rows[0]] != 0.0) == 1 and not np.any(S[: rows[0]]))


def space_of(robot: Robot) -> Space:
    """The space of a robot. Raises InputError that names the sliding joints without limits."""
    if not robot.n:
        raise InputError(f"{robot.name} has no joints, expected a robot that can move")
    gears = None
    if isinstance(robot, CoupledRobot):
        low, high, full, cuts = geared_box(robot)
        chain = chain_of(robot.free_motion)
        chain = replace(chain, offsets=chain.offsets + robot.drive.offsets)
        gears = Gears(robot.drive.S, cuts, np.ones(chain.n, dtype=bool))
        ends = np.stack([gears.S * low, gears.S * high])
        least, greatest = ends.min(axis=0).sum(axis=1), ends.max(axis=0).sum(axis=1)
    else:
        low, high, full = joint_box(robot)
        chain = chain_of(robot)
        least, greatest = low, high
    slides = np.where(chain.revolute, 0.0, np.abs(least) + np.abs(greatest))
    size = chain_size(chain) + float(np.sum(slides))
    # An arm without any length: what is small is judged by its unit.
    size = size or robot.units.metres
    shape = Space(robot, chain, low, high, full, (), 0, np.zeros((3, 0)), np.zeros(3), None, size, gears)
    # Values of no meaning: whatever holds at all of them holds everywhere.
    q = low + (high - low) * np.random.default_rng(11).random((PROBES, robot.n))
    F = frames(chain, shape.motions(q))
    points, J = F[:, -1, :3, 3], jacobian_of(F, chain.revolute, size=size)[:, :3]
    if gears is not None:
        telling = np.max(np.linalg.norm(J, axis=1), axis=0) > STILL
        shape = replace(shape, gears=replace(gears, telling=telling))
        J = shape.by_variables(J, size)
    J[:, :, high - low <= HELD * np.where(robot.revolute, 1.0, size)] = 0.0
    moving = tuple(int(i) for i in np.flatnonzero(np.max(np.linalg.norm(J, axis=1), axis=0) > STILL))
    if not moving:
        return replace(shape, centre=points[0])
    values = np.linalg.svd(J, compute_uv=False)
    dimension = int(np.max(np.sum(values > RANK * values[:, :1], axis=1)))
    _, spread, directions = np.linalg.svd(points - points[0])
    flat = dimension == 3 or bool(np.all(spread[dimension:] <= RANK * spread[0]))
    basis = np.eye(3) if dimension == 3 else directions[:dimension].T if flat else None
    space = replace(shape, moving=moving, dimension=dimension, basis=basis, centre=points[0].copy())
    first = moving[0]
    if not (robot.revolute[first] and full[first] and first == 0 and space.leads):
        return space
    lead = 0 if gears is None else int(np.flatnonzero(gears.S[:, first])[0])
    return replace(space, axis=F[0, lead].copy())


def joint_box(robot: Robot) -> tuple[Array, Array, Flags]:
    """low, high (n,) [rad | m] and which revolute joints make a whole turn. Raises InputError."""
    low, high = robot.limits[:, 0].copy(), robot.limits[:, 1].copy()
    endless = ~robot.revolute & ~(np.isfinite(low) & np.isfinite(high))
    if np.any(endless):
        names = ", ".join(str(i + 1) for i in np.flatnonzero(endless))
        joints = f"joint {names} slides" if np.sum(endless) == 1 else f"joints {names} slide"
        raise InputError(f"{joints} without limits, expected limits in the description: the workspace has no bound")
    full = robot.revolute & ~(high - low < TURN * (1.0 - 1e-12))
    # One whole turn about the middle of the limits; half a turn each way where there is none.
    with np.errstate(invalid="ignore"):
        middle = np.where(np.isfinite(low) & np.isfinite(high), 0.5 * (low + high), 0.0)
    middle = np.where(np.isfinite(low) & ~np.isfinite(high), low + np.pi, middle)
    middle = np.where(~np.isfinite(low) & np.isfinite(high), high - np.pi, middle)
    return np.where(full, middle - np.pi, low), np.where(full, middle + np.pi, high), full
