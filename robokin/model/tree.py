"""A tree of links: a hand, a torso with two arms. Metres and radians throughout.

Every chain from a link to a tip is a robot of its own; `q` of the tree runs through the joints with a variable in the
order of the description.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from robokin.arrays import Array, Flags, combined, read_only
from robokin.brief import Described
from robokin.errors import InputError, Note, shown
from robokin.expected import expect_kind, expect_numbers
from robokin.model.coupled_robot import CoupledRobot, drive_of, driven
from robokin.model.graph import Graph, GraphJoint
from robokin.model.named_values import plain_joint_values
from robokin.model.robot import Joint, JointType, Robot, within
from robokin.spatial import exact, translation_transform
from robokin.units import Units

MOST_LISTED = 24
"""Tips that a message lists."""

ROUND_AXIS = 1e-15
"""Entries of an axis this near 0 or ±1 are meant to be."""

NO_SHIFT = 1e-15
"""Length [m] below which a joint's axis passes through the origin of the frame after it."""


@dataclass(frozen=True, eq=False)
class Tree(Described):
    """Links with joints between them, and the frames on them that are asked for (`graph.tips`).

    `poses` are named configurations (n,); `notes` say what in the description looks like a slip.
    """

    name: str
    graph: Graph
    id: str = ""
    description: str = ""
    source: str = ""
    units: Units = field(default_factory=Units)
    parameters: Mapping[str, float] = field(default_factory=dict)
    poses: Mapping[str, Array] = field(default_factory=dict)
    notes: tuple[Note, ...] = ()

    def __post_init__(self) -> None:
        """Make every array and mapping read-only; refuse poses of the wrong length."""
        for name, pose in self.poses.items():
            if np.shape(pose) != (self.n,):
                raise InputError(f"pose '{name}' has {np.size(pose)} values, expected {self.n}: one a joint")
        frozen = {name: read_only(pose) for name, pose in self.poses.items()}
        object.__setattr__(self, "poses", MappingProxyType(frozen))
        object.__setattr__(self, "parameters", MappingProxyType(dict(self.parameters)))
        _ = self.limits  # limits that leave no value are refused at once

    @cached_property
    def joints(self) -> tuple[GraphJoint, ...]:
        """The joints with a variable of their own, in the order of q."""
        return tuple(self.graph.joints[number] for number in self.graph.variables)

    @cached_property
    def n(self) -> int:
        """The number of joint variables, N."""
        return len(self.joints)

    @cached_property
    def types(self) -> str:
        """The joints' types in a word, such as RRPRRR."""
        return "".join(joint.type[0].upper() for joint in self.joints)

    @cached_property
    def revolute(self) -> Flags:
        """(n,) whether each variable is an angle."""
        mask = np.array([joint.type != JointType.PRISMATIC for joint in self.joints], dtype=bool)
        mask.flags.writeable = False
        return mask

    @cached_property
    def limits(self) -> Array:
        """(n, 2) least and greatest value of each joint [rad | m], ±inf where there is none.

        Those of joints that follow one other joint alone are among them: the range is what all allow.
        """
        limits = np.array([joint.limits for joint in self.joints]).reshape(self.n, 2)
        S, o = self.graph.value_map
        for place, number in enumerate(self.graph.moving):
            (led,) = np.nonzero(S[place])
            if len(led) != 1:
                continue
            implied = sorted((bound - o[place]) / S[place, led[0]] for bound in self.graph.value_limits[place].tolist())
            low, high = limits[led[0]]
            limits[led[0]] = max(low, implied[0]), min(high, implied[1])
            if limits[led[0], 0] > limits[led[0], 1]:
                name = self.graph.joints[number].name
                raise InputError(
                    f"joint {shown(name)} follows {shown(self.joints[led[0]].name)}, and no value is within "
                    "the limits of both, expected limits that agree"
                )
        return read_only(limits)

    @cached_property
    def tips(self) -> tuple[str, ...]:
        """The names of the tips."""
        return tuple(tip.name for tip in self.graph.tips)

    @cached_property
    def serial(self) -> bool:
        """Whether it is a serial robot: one tip, and every joint on the way there moves by itself."""
        return len(self.tips) == 1 and not self.graph.couplings

    def within_limits(self, q: ArrayLike) -> Flags:
        """(...) whether each q: (..., n) [rad | m] respects every limit; limits are inclusive.

        Raises InputError when q has another length than n.
        """
        values = self.values_of(q)
        S, o = self.graph.value_map
        return within(self.limits, values) & within(self.graph.value_limits, combined(values, S.T) + o)

    def values_of(self, q: ArrayLike) -> Array:
        """q: (..., n) [rad | m] as an array (..., n) of floats.

        Raises InputError where it has another length than n.
        """
        values = expect_numbers(plain_joint_values(self, q), "q", "joint values: numbers in an array (..., n)")
        if values.ndim == 0 or values.shape[-1] != self.n:
            given = "a single number" if values.ndim == 0 else f"{values.shape[-1]} in the last dimension"
            raise InputError(f"q: found {given}, expected {self.n}: one value for each joint of {self.name}")
        return values

    def robot(self, tip: str | None = None, root: str | None = None) -> Robot:
        """The chain from a link (by default the root) to a tip or a link, as a robot of the `frames` convention.

        Without a tip the only one is meant. Where joints of the chain hang on others it is a `CoupledRobot`, whose q
        are the variables that move it. Raises InputError where there are several tips, and where no joints lead from
        one to the other.
        """
        if tip is None:
            if len(self.tips) != 1:
                raise InputError(f"{self.name} has {len(self.tips)} tips, expected one of {self.listed_tips()}")
            (tip,) = self.tips
        start = self.graph.links[self.graph.root] if root is None else root
        way, tool = self.graph.way(start, tip)
        S, o = self.graph.value_map
        moving = [number for number in way if self.graph.joints[number].moves]
        values = [self.graph.moving.index(number) for number in moving]
        (led,) = np.nonzero(np.any(S[values] != 0.0, axis=0))
        # In the order of the way; what stands on another way comes where it first moves something on this one.
        order = sorted(led.tolist(), key=lambda place: min(np.flatnonzero(S[values, place])))
        parts: dict[str, Any] = {
            "name": self.name,
            "convention": "frames",
            "id": self.id,
            "description": self.description,
            "source": self.source,
            "units": self.units,
            "parameters": self.parameters,
            "base": self.graph.frame_of(start),
            "poses": {name: pose[order] for name, pose in self.poses.items()},
            "notes": self.notes,
        }
        joints = [self.graph.joints[number] for number in moving]
        coupled = {coupling.joint: coupling for coupling in self.graph.couplings}
        plain = not any(joint.name in coupled for joint in joints)
        self._refuse_unknown(joints, tip)
        rows, tool = _rows([self.graph.joints[number] for number in way], tool)
        parts |= {"rows": rows, "tool": tool}
        if plain and not any(row.pitch for row in rows):
            return driven(parts, ())
        chosen = [self.joints[place] for place in order]
        variables = [Joint(one.name, JointType.of(one.turns), limits=one.limits, pitch=one.pitch) for one in chosen]
        couplings = tuple(coupled[joint.name] for joint in joints if joint.name in coupled)
        drive = drive_of([row for row in rows if row.moves], variables, S[values][:, order], o[values], couplings)
        return CoupledRobot(**parts, drive=drive)

    def listed_tips(self) -> str:
        """The names of the tips in a line."""
        more = ", …" if len(self.tips) > MOST_LISTED else ""
        return ", ".join(shown(name) for name in self.tips[:MOST_LISTED]) + more

    def _refuse_unknown(self, joints: Sequence[GraphJoint], tip: str) -> None:
        """Raise InputError for a joint of another kind than those of chains."""
        for joint in joints:
            if joint.type not in (JointType.REVOLUTE, JointType.PRISMATIC, "helical"):
                raise InputError(
                    f"joint {shown(joint.name)} on the way to {shown(tip)} is {shown(joint.type)}, "
                    "expected revolute, prismatic and helical joints"
                )

    def __repr__(self) -> str:
        """A line that names the tree."""
        return f"<Tree {self.id or self.name!r}: {self.types or 'no joints'}, {len(self.tips)} tips>"


def expect_tree(value: object, argument: str = "tree") -> Tree:
    """The value, if it is a tree. Raises InputTypeError that says how to get one."""
    tree: Tree = expect_kind(value, Tree, argument, "a Tree, as robokin.load_tree(path) gives it")
    return tree


def _rows(joints: Sequence[GraphJoint], tool: Array) -> tuple[tuple[Joint, ...], Array]:
    """The rows of a table of frames for joints in turn, and the tool (4, 4) [m] after the last.

    A joint whose axis passes through the origin of the frame after it is told by that frame and the axis in it, as
    most descriptions say it; of another the frame is the joint's own.
    """
    rows: list[Joint] = []
    carried = np.eye(4)
    for joint in joints:
        if not joint.moves:
            origin = exact(carried @ joint.before @ joint.after)
            rows.append(Joint(joint.name, JointType.FIXED, origin=origin))
            carried = np.eye(4)
            continue
        through = float(np.max(np.abs(joint.after[:3, 3]))) <= NO_SHIFT
        origin = joint.before @ joint.after if through else joint.before
        axis = joint.after[2, :3] if through else np.array([0.0, 0.0, 1.0])
        whole = np.round(axis)
        axis = np.where(np.abs(axis - whole) <= ROUND_AXIS, whole, axis) + 0.0
        if joint.pitch and joint.zero:  # a row advances from where it stands at the zero of its variable
            origin = origin @ translation_transform(joint.pitch * joint.zero * axis)
        rows.append(
            Joint(
                joint.name,
                JointType.of(joint.turns),
                offset=joint.zero,
                limits=joint.limits,
                origin=exact(carried @ origin),
                axis=axis,
                pitch=joint.pitch,
                motion_limits=joint.motion_limits,
            )
        )
        carried = np.eye(4) if through else joint.after
    return tuple(rows), exact(carried @ tool)
