"""The frames of an SDF model: its links, joints, frames and nested models, and where each of them is.

A pose is in the frame that its `relative_to` names, else in that of the model; a joint's in that of its child, a
frame's in that of what it is attached to. Names are of the model's own scope, or of one in it, `A::B`.

Source: SDFormat specification 1.0 to 1.12, and its tutorial on the semantics of poses and frames.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from robokin.arrays import Array
from robokin.errors import did_you_mean, shown
from robokin.formats.snapped_angles import RoundedAngles
from robokin.formats.xml_numbers import numbers_at
from robokin.formats.xml_tree import XmlNode
from robokin.spatial import invert, rotation_from_quaternion, rotation_from_rpy, transform
from robokin.spatial.transforms import FARTHEST

SDF_WORLD = "world"
MODEL = "__model__"
ROOT = "__root__"

NESTED = "::"
"""What parts the names of a nested model and of something in it."""

SHORTEST_QUATERNION = 1e-9

MOST_SHOWN_FRAMES = 8
"""Names that a message of a circle lists."""


@dataclass(eq=False)
class SdfFrame:
    """Something with a pose: a link, a joint, a frame or a model; `local` (4, 4) [m] is its pose as it is written.

    name: with the models that it is nested in; scope: the model whose names its attributes use; inside: of a model the
    names in it. towards: the name of what its pose is in, `home` that by default. holder: the name of what it moves
    with, for a link nothing.
    """

    name: str
    kind: str
    node: XmlNode
    scope: SdfScope | None
    local: Array
    towards: str = ""
    home: SdfFrame | None = None
    holder: str = ""
    inside: SdfScope | None = None


@dataclass(eq=False)
class SdfScope:
    """The names in a model; `own` is the model's frame."""

    prefix: str
    own: SdfFrame
    names: dict[str, SdfFrame] = field(default_factory=dict)
    scopes: dict[str, SdfScope] = field(default_factory=dict)
    links: list[SdfFrame] = field(default_factory=list)

    def find(self, name: str, node: XmlNode, attribute: str = "", world: SdfFrame | None = None) -> SdfFrame:
        """What a name means here. Raises DescriptionError at the node."""
        scope = self
        *outer, last = name.split(NESTED)
        for part in outer:
            if part not in scope.scopes:
                hint = did_you_mean(part, scope.scopes) or ", expected the name of a model in this one"
                raise node.error(f"found the unknown model {shown(repr(part))} in {shown(repr(name))}{hint}", attribute)
            scope = scope.scopes[part]
        if last == MODEL:
            return scope.own
        if last in scope.names:
            return scope.names[last]
        if last in (SDF_WORLD, ROOT) and not outer and world is not None:
            return world
        hint = did_you_mean(last, scope.names) or ", expected the name of a link, a joint or a frame of the model"
        raise node.error(f"found the unknown name {shown(repr(name))}{hint}", attribute)


class SdfPlaces:
    """Where frames are in the outermost model, worked out once for each."""

    def __init__(self, top: SdfFrame, world: SdfFrame) -> None:
        self.world = world
        self.known: dict[SdfFrame, Array] = {top: np.eye(4), world: invert(top.local)}
        self.held: dict[SdfFrame, SdfFrame] = {}
        """Of frames the link that each moves with, as far as it has been asked."""
        self.placed: dict[SdfFrame, SdfFrame] = {}
        """Of a nested model the frame of its own that its pose is of."""

    def pose(self, frame: SdfFrame) -> Array:
        """The pose (4, 4) [m] of a frame in the outermost model. Raises DescriptionError for poses in a circle."""
        way: dict[SdfFrame, None] = {}
        while frame not in self.known:
            if frame in way:
                circle = [one.name for one in way]
                circle = [*circle[circle.index(frame.name) :], frame.name][:MOST_SHOWN_FRAMES]
                names = " → ".join(shown(name) for name in circle)
                raise frame.node.error(f"found poses in a circle, {names}, expected one that leads to the model")
            way[frame] = None
            frame = self.parent(frame)
        T = self.known[frame]
        for one in reversed(way):
            T = T @ self.local(one)
            self.known[one] = T
        return T

    def parent(self, frame: SdfFrame) -> SdfFrame:
        """What a frame's pose is in."""
        if not frame.towards or frame.scope is None:
            assert frame.home is not None  # only the outermost model has none, and its pose is known
            return frame.home
        return frame.scope.find(frame.towards, frame.node, world=self.world)

    def local(self, frame: SdfFrame) -> Array:
        """The pose of a frame in its parent; a nested model may be placed by a frame of its own."""
        if frame not in self.placed:
            return frame.local
        inner, T, seen = self.placed[frame], np.eye(4), set[SdfFrame]()
        while inner is not frame:
            if inner in seen or inner.home is None:
                raise frame.node.error("found a placement frame whose pose does not lead to its model, expected one")
            seen.add(inner)
            T = inner.local @ T
            inner = self.parent(inner)
        return frame.local @ invert(T)

    def link(self, frame: SdfFrame) -> SdfFrame:
        """The link that a frame moves with. Raises DescriptionError for frames attached in a circle."""
        seen: set[SdfFrame] = set()
        while frame.kind not in ("link", SDF_WORLD):
            if frame in self.held:
                frame = self.held[frame]
                break
            if frame in seen:
                raise frame.node.error(f"found {shown(frame.name)} attached to itself, expected a link in the end")
            seen.add(frame)
            scope = frame.scope
            if frame.kind == "model":
                frame = _first_link(frame)
            else:
                assert scope is not None
                frame = scope.find(frame.holder or MODEL, frame.node, world=self.world)
        self.held |= dict.fromkeys(seen, frame)
        return frame


def _first_link(model: SdfFrame) -> SdfFrame:
    """The canonical link of a model: the one that it names, else its first, else the first of a model in it."""
    scope = model.inside
    named = model.node.attributes.get("canonical_link", "")
    inner = [scope] if scope is not None else []
    if named and scope is not None:
        return scope.find(named, model.node, "canonical_link")
    while inner:
        scope = inner.pop(0)
        if scope.links:
            return scope.links[0]
        inner += scope.scopes.values()
    raise model.node.error(f"found the model {shown(model.name)} without a link, expected one")


def pose_in(node: XmlNode, rounded: RoundedAngles) -> tuple[Array, str]:
    """The `<pose>` in an element (4, 4) [m], and the name of what it is in, "" by default. Raises DescriptionError."""
    pose = node.first("pose")
    if pose is None:
        return np.eye(4), ""
    towards = pose.attributes.get("relative_to", "")
    text = pose.text.strip()
    if not text:
        return np.eye(4), towards
    form = pose.attributes.get("rotation_format", "euler_rpy")
    if form == "quat_xyzw":
        x, y, z, *quaternion = numbers_at(text, pose.mark, "the pose", 7, [])
        if np.linalg.norm(quaternion) < SHORTEST_QUATERNION:
            raise pose.error("found a quaternion of length zero, expected a rotation")
        return transform(rotation_from_quaternion([quaternion[3], *quaternion[:3]]), [x, y, z]), towards
    if form != "euler_rpy":
        raise pose.error(f"found {shown(repr(form))}, expected euler_rpy or quat_xyzw", "rotation_format")
    values = numbers_at(text, pose.mark, "the pose", 6, [])
    if any(abs(value) > FARTHEST for value in values):
        raise pose.error(f"found the pose '{shown(text)}', expected numbers of at most {FARTHEST:g}")
    if pose.attributes.get("degrees", "false") in ("true", "1"):
        rpy = list(np.radians(values[3:]))
    else:
        rpy = [rounded.meant(a, t, pose.mark) for a, t in zip(values[3:], text.split()[3:], strict=True)]
    return transform(rotation_from_rpy(rpy), values[:3]), towards
