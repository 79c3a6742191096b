"""What a MuJoCo file says once for all of its bodies: the compiler's settings and the classes of defaults.

Source: MuJoCo 4.0, XML reference, `compiler` and `default`; what it leaves open was tried with mujoco 4.0.0.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from robokin.arrays import Array
from robokin.errors import did_you_mean, or_list, shown
from robokin.formats.snapped_angles import RoundedAngles
from robokin.formats.xml_numbers import numbers_at
from robokin.formats.xml_tree import XmlNode
from robokin.spatial import rotation_from_axis_angle, rotation_from_quaternion, transform, z_to
from robokin.spatial.transforms import FARTHEST

MAIN = "main"
"""The class of what names none."""

ORIENTATIONS = {"quat": 4, "axisangle": 4, "euler": 3, "xyaxes": 6, "zaxis": 3}
"""The ways to write an orientation, and how many numbers each takes."""

DEFAULTED = ("joint", "site", "equality")
"""Elements whose defaults matter here."""

MOST_CLASSES = 2000
"""Classes of one file; a hand has some 30."""

NO_LENGTH = 1e-14
"""What is shorter has no direction, as in mujoco."""


def values_of(node: XmlNode, key: str, count: int | None) -> tuple[float, ...] | None:
    """The so many numbers of an attribute (any, for None), or None where it is absent or empty.

    Raises DescriptionError; also for commas between them, which MuJoCo refuses.
    """
    text = node.attributes.get(key, "")
    if not text.strip():
        return None
    if "," in text:
        raise node.error(
            f"found '{shown(text)}' as '{key}', expected numbers with blanks and no commas between them", key
        )
    values = numbers_at(text, node.place_of(key), f"'{key}'", count, [])
    if max(map(abs, values), default=0.0) > FARTHEST:
        raise node.error(f"found '{shown(text)}' as '{key}', expected numbers of at most {FARTHEST:g}", key)
    return values


def choice_of(node: XmlNode, key: str, choices: Collection[str], otherwise: str) -> str:
    """One of the words that an attribute may be. Raises DescriptionError."""
    word = node.attributes.get(key, otherwise)
    if word not in choices:
        hint = did_you_mean(word, choices) or f", expected {or_list(choices)}"
        raise node.error(f"found '{shown(word)}' as '{key}'{hint}", key)
    return word


def flag_of(node: XmlNode, key: str, otherwise: bool) -> bool:
    """Whether an attribute is true. Raises DescriptionError for what is neither true nor false."""
    return choice_of(node, key, ("true", "false"), "true" if otherwise else "false") == "true"


@dataclass(frozen=True)
class MjcfCompiler:
    """Settings of a whole file: the unit of its angles, the order of its Euler angles, what a range without a word on
    limits means.
    """

    degrees: bool = True
    euler: str = "xyz"
    autolimits: bool = True

    def angle(self, value: float) -> float:
        """An angle of the file [rad]."""
        return math.radians(value) if self.degrees else value


def compiler_of(sections: Iterable[XmlNode]) -> MjcfCompiler:
    """The settings of a file; of several sections the last word counts. Raises DescriptionError."""
    degrees, euler, autolimits = True, "xyz", True
    for node in sections:
        degrees = choice_of(node, "angle", ("degree", "radian"), "degree" if degrees else "radian") == "degree"
        autolimits = flag_of(node, "autolimits", autolimits)
        if choice_of(node, "coordinate", ("local", "global"), "local") == "global":
            raise node.error(
                'found coordinate="global", which MuJoCo no longer reads, expected coordinates in the parent\'s frame',
                "coordinate",
            )
        euler = node.attributes.get("eulerseq", euler)
        if len(euler) != 3 or set(euler.lower()) - set("xyz"):
            raise node.error(
                f"found eulerseq {shown(repr(euler))}, expected three of x, y, z (turning axes), X, Y, Z (fixed ones)",
                "eulerseq",
            )
    return MjcfCompiler(degrees, euler, autolimits)


@dataclass
class MjcfClasses:
    """The classes of defaults: of each the attributes of every element; a class has its parent's but where it says
    otherwise.
    """

    known: dict[str, dict[str, dict[str, str]]] = field(default_factory=lambda: {MAIN: {tag: {} for tag in DEFAULTED}})

    def add(self, section: XmlNode) -> None:
        """Read a `<default>` at the top of a file. Raises DescriptionError."""
        if section.attributes.get("class", MAIN) != MAIN:
            raise section.error("found the outermost default class under another name, expected 'main'", "class")
        self._read(section, MAIN)

    def _read(self, section: XmlNode, name: str) -> None:
        own = self.known[name]
        for node in section.children:
            if node.tag in own:
                own[node.tag] = merged(own[node.tag], node.attributes)
        for node in section.children:
            if node.tag != "default":
                continue
            inner = node.attributes.get("class", "")
            if not inner or inner in self.known:
                found = f"the class {shown(repr(inner))} twice" if inner else "a default inside another without a class"
                raise node.error(f"found {found}, expected a class of its own", "class")
            if len(self.known) >= MOST_CLASSES:
                raise node.error(f"found more than {MOST_CLASSES} classes, expected a robot")
            self.known[inner] = {tag: dict(values) for tag, values in own.items()}
            self._read(node, inner)

    def expect(self, node: XmlNode, key: str, otherwise: str) -> str:
        """The class that an attribute names, or `otherwise`. Raises DescriptionError for one that there is not."""
        name = node.attributes.get(key) or otherwise
        if name not in self.known:
            hint = did_you_mean(name, self.known) or f", expected one of {', '.join([*self.known][:12])}"
            raise node.error(f"found the unknown class {shown(repr(name))}{hint}", key)
        return name

    def filled(self, node: XmlNode, childclass: str = MAIN, tag: str = "") -> XmlNode:
        """An element with what its class says where it is silent. Raises DescriptionError."""
        name = self.expect(node, "class", childclass)
        return node.derived(merged(self.known[name][tag or node.tag], node.attributes), node.children)


def merged(under: dict[str, str], over: dict[str, str]) -> dict[str, str]:
    """Attributes over others; an orientation in one way replaces one in another."""
    if any(key in over for key in ORIENTATIONS):
        under = {key: value for key, value in under.items() if key not in ORIENTATIONS}
    return {**under, **over}


@dataclass
class MjcfPoses:
    """Reads places and orientations in a file's settings."""

    compiler: MjcfCompiler
    rounded: RoundedAngles

    def pose_of(self, node: XmlNode) -> Array:
        """The pose (4, 4) [m] that an element's `pos` and orientation say, in its parent's frame."""
        return transform(self.rotation_of(node), values_of(node, "pos", 3) or (0.0, 0.0, 0.0))

    def rotation_of(self, node: XmlNode) -> Array:
        """The orientation (3, 3) of an element. Raises DescriptionError."""
        said = [key for key in ORIENTATIONS if node.attributes.get(key, "").strip()]
        if len(said) > 1:
            raise node.error(f"found {said[0]} and {said[1]}, expected one orientation", said[1])
        if not said:
            return np.eye(3)
        (key,) = said
        values = values_of(node, key, ORIENTATIONS[key]) or ()
        if key == "quat":
            return rotation_from_quaternion(_direction(node, key, values))
        if key == "axisangle":
            axis = _direction(node, key, values[:3])
            return rotation_from_axis_angle(axis, self.angle(node, key, values, 3))
        if key == "euler":
            return self._euler(node, values)
        if key == "zaxis":
            return np.asarray(z_to(_direction(node, key, values))[:3, :3])
        x = _direction(node, key, values[:3])
        y = np.array(values[3:])
        y = _direction(node, key, (y - (x @ y) * x).tolist())
        return np.stack([x, y, np.cross(x, y)], axis=-1)

    def angle(self, node: XmlNode, key: str, values: Sequence[float], place: int) -> float:
        """One of the numbers of an attribute as an angle [rad]."""
        if self.compiler.degrees:
            return self.compiler.angle(values[place])
        return self.rounded.meant(values[place], node.attributes[key].split()[place], node.place_of(key))

    def _euler(self, node: XmlNode, values: Sequence[float]) -> Array:
        """Three turns, each about an axis that has turned (lower case) or a fixed one (upper case)."""
        R = np.eye(3)
        for place, letter in enumerate(self.compiler.euler):
            axis = np.eye(3)["xyz".index(letter.lower())]
            turn = rotation_from_axis_angle(axis, self.angle(node, "euler", values, place))
            R = R @ turn if letter.islower() else turn @ R
        return np.asarray(R)


def _direction(node: XmlNode, key: str, values: Sequence[float]) -> Array:
    """Values divided by their length. Raises DescriptionError where that is nothing."""
    length = math.hypot(*values)
    if length < NO_LENGTH:
        found = shown(node.attributes[key])
        raise node.error(f"found '{found}' as '{key}', in which a direction is zero, expected one with a length", key)
    return np.array(values) / length
