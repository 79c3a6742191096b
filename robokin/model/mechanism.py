"""A mechanism: links joined by joints that may form loops. Metres and radians throughout."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType
from typing import Literal

import numpy as np

from robokin.arrays import Array, read_only
from robokin.brief import Brief, Described
from robokin.errors import Note, shown
from robokin.expected import expect_kind
from robokin.model.blueprint import AssemblyMode
from robokin.model.graph import Graph, GraphJoint
from robokin.model.pins import pairs
from robokin.spatial import invert, z_to
from robokin.units import Units

Space = Literal["planar", "spherical", "spatial"]

LAMBDA: Mapping[str, int] = MappingProxyType({"planar": 3, "spherical": 3, "spatial": 6})
"""Freedoms of an unconstrained link by the space that it lives in: Grübler's λ."""


@dataclass(frozen=True, eq=False, repr=False)
class Rounding(Brief):
    """How far a joint's numbers may be off: a unit in the last place that was written, 0 for what is exact.

    at (3,) [m], axes (k, 3), pitch [m/rad].
    """

    at: Array
    axes: Array
    pitch: float = 0.0


@dataclass(frozen=True, eq=False, repr=False)
class MechanismJoint(Brief):
    """A joint between two or more links.

    `freedoms` is f, what it lets two links do against each other; a joint of m links counts as m - 1
    such joints. `at` (3,) [m] is a point on it and `axes` (k, 3) are its unit directions in the
    assembled configuration (two for a universal joint, the normal for a planar one); None where the
    description gives no geometry. `pitch` [m/rad] is a helical joint's advance. `rounding` says how far these may be
    off, as they were written; None where nobody wrote them.

    `gearing` holds, for gears and belts whose ratio is known, a number for each link: the first times the first link's
    turn is the second times the second's, and so on, all turns measured from the link that carries the wheels
    (`carrier`, "" where only one can) and about `axes` (2, 3), or about the hinges' own axes. `meshes` says that they
    are numbers of teeth, whose senses follow from where the wheels touch.
    """

    name: str
    type: str
    links: tuple[str, ...]
    freedoms: int
    at: Array | None = None
    axes: Array | None = None
    pitch: float = 0.0
    actuated: bool = False
    gearing: tuple[float, ...] = ()
    meshes: bool = False
    carrier: str = ""
    rounding: Rounding | None = None

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        for name in ("at", "axes"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, read_only(getattr(self, name)))

    @property
    def frame(self) -> Array:
        """(4, 4) [m] a frame on a hinge, slide or screw with z along its axis; NaN where that is not given, or has no
        place, and of other joints but fixed ones."""
        if self.type == "fixed":
            return np.eye(4)
        placed = self.at is not None or self.type == "prismatic"
        if self.type not in ("revolute", "prismatic", "helical") or self.axes is None or not placed:
            return np.full((4, 4), np.nan)
        T = z_to(self.axes[0])
        T[:3, 3] = 0.0 if self.at is None else self.at
        return T

    @property
    def multiplicity(self) -> int:
        """How many two-link joints it counts as: m - 1 for m links."""
        return len(self.links) - 1


@dataclass(frozen=True, eq=False)
class Mechanism(Described):
    """Links, the joints between them, the link that stands still, and the one that the others serve, if named.

    `ground_named` says whether the ground is named as such, or just the first link. `expected` is what the source says:
    `grubler`, `mobility`, `overconstraints`, `output`, `idle`. `modes` are the ways to put together a mechanism whose
    description gives lengths, `mode` the number, from 1, of the one that its joints stand in (0 where their places are
    given), and `modes_complete` says that there can be no other.
    """

    name: str
    space: Space
    links: tuple[str, ...]
    joints: tuple[MechanismJoint, ...]
    ground: str
    output: str = ""
    id: str = ""
    description: str = ""
    source: str = ""
    units: Units = field(default_factory=Units)
    parameters: Mapping[str, float] = field(default_factory=dict)
    expected: Mapping[str, int] = field(default_factory=dict)
    ground_named: bool = True
    modes: tuple[AssemblyMode, ...] = ()
    mode: int = 0
    modes_complete: bool = True
    notes: tuple[Note, ...] = ()

    def __post_init__(self) -> None:
        """Make the mappings read-only."""
        object.__setattr__(self, "parameters", MappingProxyType(dict(self.parameters)))
        object.__setattr__(self, "expected", MappingProxyType(dict(self.expected)))

    @property
    def order(self) -> int:
        """Grübler's λ: the freedoms of an unconstrained link."""
        return LAMBDA[self.space]

    @property
    def types(self) -> str:
        """The joints' types in a word, such as RRRP; E is a planar joint, G any contact."""
        letters = {"fixed": "F", "revolute": "R", "prismatic": "P", "helical": "H", "cylindrical": "C",
                   "universal": "U", "spherical": "S", "planar": "E"}  # fmt: skip
        return "".join(letters.get(joint.type, "G") * joint.multiplicity for joint in self.joints)

    @cached_property
    def graph(self) -> Graph:
        """Links and joints of two links, those of more taken apart; every link's frame is the world's as assembled."""
        numbers = {link: number for number, link in enumerate(self.links)}
        joined = pairs([tuple(numbers[link] for link in joint.links) for joint in self.joints])
        joints = []
        for row, (joint, ends) in enumerate(zip(self.joints, joined, strict=True)):
            T = joint.frame
            joints += [
                GraphJoint(joint.name, joint.type, a, b, joint.freedoms, T, invert(T), joint.pitch, row=row)
                for a, b in ends
            ]
        return Graph(self.links, tuple(joints), self.links.index(self.ground))

    def __repr__(self) -> str:
        """A line that names the mechanism."""
        return f"<Mechanism {self.id or self.name!r}: {len(self.links)} links, {len(self.joints)} joints>"


def expect_mechanism(value: object, argument: str = "mechanism") -> Mechanism:
    """The value, if it is a mechanism. Raises InputTypeError that says how to get one."""
    name = f"'{shown(value)}'" if isinstance(value, str) else "name_or_path"
    how = f"a Mechanism, as robokin.load_mechanism({name}) gives it"
    mechanism: Mechanism = expect_kind(value, Mechanism, argument, how)
    return mechanism
