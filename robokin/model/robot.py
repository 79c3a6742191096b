"""A robot: a base, a table of rows (joints and fixed steps), a tool. Metres and radians throughout."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property
from types import MappingProxyType
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from robokin.arrays import Array, Flags, read_only
from robokin.brief import Brief, Described
from robokin.errors import InputError, Note, shown
from robokin.expected import expect_kind, expect_numbers
from robokin.model.graph import NO_LIMITS, Graph, GraphJoint, Tip
from robokin.model.named_values import plain_joint_values
from robokin.model.robot_methods import RobotMethods
from robokin.spatial import exact, invert, translation_transform, z_to
from robokin.spatial.dh import modified_dh, standard_dh
from robokin.units import Units

Convention = Literal["standard", "modified", "frames"]

LIMIT_TOLERANCE = 1e-9
"""A joint value this far [rad | m] outside its limits is still within: limits are inclusive, and a
value that went through a change of units or a solver lands within rounding of them."""

HALF_TURN = np.diag([1.0, -1.0, -1.0, 1.0])
"""F, half a turn about x; its own inverse."""

NO_LIMIT = 1e100
"""A limit beyond this [rad | m] is none: volumes made of such ways are no numbers."""

LIMIT_ROUNDING = 1e-12
"""The same as a part of the limit: what rounding does to a value after a solver, where a slide is longer than a
kilometre."""


class JointType(StrEnum):
    """What a row of the table does: turn about z, slide along z, or neither."""

    REVOLUTE = "revolute"
    PRISMATIC = "prismatic"
    FIXED = "fixed"

    @classmethod
    def of(cls, turns: bool) -> JointType:
        """That of a variable: an angle or a length."""
        return cls.REVOLUTE if turns else cls.PRISMATIC

    @property
    def letter(self) -> str:
        """R, P or F, as in `RRPRRR`."""
        return self.value[0].upper()


@dataclass(frozen=True, eq=False, repr=False)
class Joint(Brief):
    """One row of the table.

    In a DH table the cells `theta`, `d`, `a`, `alpha` hold the constants of the row (`theta` of a
    revolute and `d` of a prismatic row are 0: the variable stands there, shifted by `offset`). In the
    `frames` convention the row is `origin` (4, 4), then the motion about or along `axis` (3,). `sense` is the sign with
    which the variable enters: theta = sense · q + offset (d of a slide, the motion of a `frames` row), 1 or -1.
    `texts` are the cells that name parameters, as they are written (`("a", "l1/2")`); of an origin the
    coordinates `x`, `y`, `z`. `pitch` [m/rad] is what a helical row, a revolute one that slides as it turns, advances
    along its axis, `motion_limits` what the joint itself may do, where that is not what is typed; only a `CoupledRobot`
    has such rows.
    """

    name: str
    type: JointType
    theta: float = 0.0
    d: float = 0.0
    a: float = 0.0
    alpha: float = 0.0
    offset: float = 0.0
    limits: tuple[float, float] = (-np.inf, np.inf)
    origin: Array | None = None
    axis: Array | None = None
    texts: tuple[tuple[str, str], ...] = ()
    sense: int = 1
    pitch: float = 0.0
    motion_limits: tuple[float, float] = (-np.inf, np.inf)

    def __post_init__(self) -> None:
        """Make the arrays read-only, limits beyond `NO_LIMIT` none; refuse those between which there is no number."""
        low, high = self.limits
        if not (low <= high and low < np.inf and high > -np.inf):
            raise InputError(f"joint {self.name} has the limits {low:g} to {high:g}, expected min ≤ max")
        if max(-low, high) > NO_LIMIT:
            limits = (low if low > -NO_LIMIT else -np.inf, high if high < NO_LIMIT else np.inf)
            object.__setattr__(self, "limits", limits)
        for name in ("origin", "axis"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, read_only(getattr(self, name)))

    @property
    def moves(self) -> bool:
        """Whether the row has a joint variable."""
        return self.type is not JointType.FIXED

    @property
    def unlimited(self) -> bool:
        """Whether the joint has no limits."""
        return bool(np.isinf(self.limits[0]) and np.isinf(self.limits[1]))


@dataclass(frozen=True, eq=False)
class Robot(RobotMethods, Described):
    """A serial chain: T = base · row 1 · … · row m · tool, as the description gives it.

    `rows` are all rows of the table, `joints` those with a variable, in the order of q. `texts` are the
    coordinates of base and tool that name parameters (`("tool z", "d6")`); `notes` say what in the description looks
    like a slip, such as angles in another unit.
    """

    name: str
    rows: tuple[Joint, ...]
    convention: Convention = "standard"
    id: str = ""
    description: str = ""
    source: str = ""
    units: Units = field(default_factory=Units)
    parameters: Mapping[str, float] = field(default_factory=dict)
    base: Array = field(default_factory=lambda: np.eye(4))
    tool: Array = field(default_factory=lambda: np.eye(4))
    poses: Mapping[str, Array] = field(default_factory=dict)
    texts: tuple[tuple[str, str], ...] = ()
    notes: tuple[Note, ...] = ()

    def __post_init__(self) -> None:
        """Make every array and mapping read-only; refuse poses of the wrong length."""
        self._check_rows()
        for name, pose in self.poses.items():
            if np.shape(pose) != (self.n,):
                raise InputError(f"pose '{name}' has {np.size(pose)} values, expected {self.n}: one a joint")
        frozen = {name: read_only(pose) for name, pose in self.poses.items()}
        object.__setattr__(self, "poses", MappingProxyType(frozen))
        object.__setattr__(self, "parameters", MappingProxyType(dict(self.parameters)))
        object.__setattr__(self, "base", read_only(self.base))
        object.__setattr__(self, "tool", read_only(self.tool))

    def _check_rows(self) -> None:
        """Raise InputError for rows that one variable each does not move."""
        if any(row.pitch or row.motion_limits != NO_LIMITS for row in self.rows):
            raise InputError("found a helical row or limits of its motion, expected a CoupledRobot")

    @cached_property
    def joints(self) -> tuple[Joint, ...]:
        """The rows with a joint variable, in the order of q."""
        return tuple(row for row in self.rows if row.moves)

    @cached_property
    def n(self) -> int:
        """The number of joint variables, N."""
        return len(self.joints)

    @cached_property
    def types(self) -> str:
        """The joints' types in a word, such as RRPRRR."""
        return "".join(joint.type.letter for joint in self.joints)

    @cached_property
    def revolute(self) -> Flags:
        """(n,) whether each joint turns."""
        mask = np.array([joint.type is JointType.REVOLUTE for joint in self.joints], dtype=bool)
        mask.flags.writeable = False
        return mask

    @cached_property
    def senses(self) -> Array:
        """(n,) the sign with which each variable enters, 1 or -1."""
        return read_only(np.array([float(joint.sense) for joint in self.joints]))

    @cached_property
    def limits(self) -> Array:
        """(n, 2) least and greatest value of each joint [rad | m], ±inf where there is none."""
        return read_only(np.array([joint.limits for joint in self.joints]).reshape(self.n, 2))

    @cached_property
    def graph(self) -> Graph:
        """The table as a graph: link 0 has the base's frame, link i the frame after row i; the tip is the tool."""
        joints = [graph_joint(row, self.convention, i, i + 1, row.name, i) for i, row in enumerate(self.rows)]
        links = ("base", *(str(i + 1) for i in range(len(joints))))
        return Graph(links, tuple(joints), base=self.base, tips=(Tip("tool", len(joints), self.tool),))

    def within_limits(self, q: ArrayLike) -> Flags:
        """(...) whether each q: (..., n) [rad | m] respects every limit; limits are inclusive.

        Raises InputError when q has another length than n.
        """
        q = expect_numbers(plain_joint_values(self, q), "q", f"joint values: numbers in an array (..., {self.n})")
        if q.ndim == 0 or q.shape[-1] != self.n:
            raise InputError(
                f"q: found an array of shape {q.shape}, expected (..., {self.n}): one value for each joint"
            )
        return within(self.limits, q)

    def __repr__(self) -> str:
        """A line that names the robot."""
        return f"<Robot {self.id or self.name!r}: {self.types or 'no joints'}, {self.convention} convention>"


def expect_robot(value: object, argument: str = "robot") -> Robot:
    """The value, if it is a robot. Raises InputTypeError that says how to get one."""
    if isinstance(value, Robot):
        return value
    name = f"'{shown(value)}'" if isinstance(value, str) else "name_or_path"
    robot: Robot = expect_kind(value, Robot, argument, f"a Robot, as robokin.load({name}) gives it")
    return robot


def graph_joint(row: Joint, convention: str, parent: int, child: int, name: str, number: int) -> GraphJoint:
    """A row as a joint of a graph between two links, by their numbers."""
    before, after = row_constants(row, convention)
    kind, zero = str(row.type), row.sense * row.offset
    if row.pitch:  # a graph's joint advances from where it would stand at the zero of its turn
        kind, after = "helical", translation_transform(np.array([0.0, 0.0, -row.pitch * zero])) @ after
    return GraphJoint(
        name, kind, parent, child, int(row.moves), before, after, row.pitch, zero, row.limits, number, row.motion_limits
    )  # fmt: skip


def row_constants(row: Joint, convention: str) -> tuple[Array, Array]:
    """The constant transforms (4, 4) before and after the motion of one row, the motion being along z.

    A variable that enters with the other sign turns the frame of its joint by half a turn about x, and back:
    Rot(z, offset - q) = F Rot(z, q - offset) F, and so of a slide.
    """
    before, after = _constants(row, convention)
    if row.moves and row.sense < 0:
        return before @ HALF_TURN, HALF_TURN @ after
    return before, after


def _constants(row: Joint, convention: str) -> tuple[Array, Array]:
    """The same for a variable that enters with its own sign."""
    # The variable's own cell is 0 in the row, so that one formula serves every type of row.
    if convention == "standard":
        return np.eye(4), standard_dh(row.theta, row.d, row.a, row.alpha)
    if convention == "modified":
        return modified_dh(row.alpha, row.a, 0.0, 0.0), standard_dh(row.theta, row.d, 0.0, 0.0)
    origin = np.eye(4) if row.origin is None else row.origin
    if row.type is JointType.FIXED or row.axis is None:
        return origin, np.eye(4)
    A = z_to(row.axis)
    return exact(origin @ A), invert(A)


def within(limits: Array, q: Array) -> Flags:
    """(...) whether each q: (..., n) [rad | m] respects the limits (n, 2), which are inclusive."""
    low, high = tolerated(limits)
    return np.asarray(np.all((q >= low) & (q <= high), axis=-1))


def tolerated(limits: Array) -> tuple[Array, Array]:
    """The least and the greatest values (n,) [rad | m] that count as within limits (n, 2)."""
    size = np.where(np.isfinite(limits), np.abs(limits), 0.0)
    margin = np.maximum(LIMIT_TOLERANCE, LIMIT_ROUNDING * size)
    return limits[:, 0] - margin[:, 0], limits[:, 1] + margin[:, 1]
