"""Links with lengths, or with the places of their joints in frames of their own, to assembled mechanisms."""

from __future__ import annotations

import re
from collections.abc import Mapping as MappingType
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from robokin.assembly.assembly_modes import Assemblies, assemblies_of
from robokin.errors import InputError, did_you_mean, shown
from robokin.formats.node_values import Context, fields_of, list_of, number_of, raw_number_of, text_of, vector_of
from robokin.formats.schema import LINK
from robokin.formats.yaml_tree import FilePlace, Mapping, Node, describe
from robokin.model import MechanismJoint
from robokin.model.blueprint import AssemblyMode, BlueJoint, Blueprint

PLACED = ("revolute", "prismatic", "fixed")
"""Joints that lengths can place; gears and belts with a ratio need no place."""

METRES = re.compile(r"@([^@]+)@")
"""A length in metres inside a sentence."""


@dataclass
class LinkShape:
    """What a link says of itself; mark: where it is written."""

    mark: FilePlace
    length: float | None = None
    places: dict[str, complex] = field(default_factory=dict)
    directions: dict[str, float] = field(default_factory=dict)
    marks: dict[str, FilePlace] = field(default_factory=dict)
    stated: bool = False


def links_of(node: Node, context: Context, plane: bool) -> tuple[tuple[str, ...], dict[str, LinkShape]]:
    """The links' names, none where one of them cannot be read, and the shapes of all."""
    shapes: dict[str, LinkShape] = {}
    known = True
    for item in list_of(node, "the links"):
        name = context.faults.attempt("", _link_name, item, context)
        if not name:  # it may be the one that a joint names
            known = False
        elif name in shapes:
            known = False
            context.faults.add(item.mark.error(f"found '{shown(name)}' twice in the links, expected each name once"))
        else:
            shapes[name] = context.faults.attempt(LinkShape(item.mark), _shape, item, name, context)
    shaped = [name for name, shape in shapes.items() if shape.stated]
    if shaped and not plane:
        raise shapes[shaped[0]].mark.error(
            f"found the shape of link {shown(shaped[0])} in a mechanism that is not planar, expected `at` and "
            "`axis` on its joints"
        )
    return tuple(shapes) if known else (), shapes


def _link_name(item: Node, context: Context) -> str:
    if isinstance(item, Mapping):
        return text_of(fields_of(item, LINK, "a link", context.faults)["name"], "a link's name")
    return text_of(item, "a name")


def _shape(item: Node, name: str, context: Context) -> LinkShape:
    """What a link says of its shape; a plain name says nothing."""
    if not isinstance(item, Mapping):
        return LinkShape(item.mark)
    cells = fields_of(item, LINK, "a link", context.faults)
    shape = LinkShape(item.mark, stated=len(cells) > 1)
    if "length" in cells:
        shape.length = context.faults.attempt(1.0, _length, cells["length"], name, context)
        if "places" in cells:
            raise cells["places"].mark.error(f"found 'length' and 'places' of link {shown(name)}, expected one of them")
    for key in ("places", "directions"):
        if key not in cells:
            continue
        entries = cells[key]
        if not isinstance(entries, Mapping):
            raise entries.mark.error(
                f"found {describe(entries)}, expected {key} of link {shown(name)}: a mapping of joints' names"
            )
        for joint, value in entries.entries.items():
            what = f"{key} of link {shown(name)}, {shown(joint)}"
            if key == "places":
                x, y, _ = context.faults.attempt(
                    np.zeros(3), vector_of, value, context, what, direction=False, plane=True
                )
                shape.places[joint] = complex(x, y)
            else:
                shape.directions[joint] = context.faults.attempt(0.0, number_of, value, context, what, angle=True)
            shape.marks[joint] = entries.keys[joint]
    return shape


def _length(node: Node, name: str, context: Context) -> float:
    length = number_of(node, context, f"length of link {shown(name)}", angle=False)
    if not length > 0.0:
        raise node.mark.error(
            f"found {length / context.units.metres:g} as length of link {shown(name)}, expected more than 0"
        )
    return length


def value_of(node: Node, kind: str, where: str, context: Context) -> float:
    """The value of a joint [rad | m]."""
    return number_of(node, context, f"value {where}", angle=kind == "revolute")


def assembled_joints(
    joints: tuple[MechanismJoint, ...], nodes: Sequence[MappingType[str, Node]], values: dict[str, float],
    shapes: dict[str, LinkShape], ground: str, mark: FilePlace, context: Context,
) -> Assemblies:  # fmt: skip
    """All ways to put the links together. Raises DescriptionError, with lengths in the file's units."""
    places = _places(joints, nodes, shapes, ground, values)
    blue = []
    for joint, cells in zip(joints, nodes, strict=True):
        if joint.gearing:
            continue
        if joint.type not in PLACED:
            raise cells["type"].mark.error(
                f"found {joint.type} of joint {shown(joint.name)} in a mechanism by lengths, expected revolute, "
                "prismatic or fixed, or a gear or belt with its ratio"
            )
        if joint.name in values and len(joint.links) > 2:
            raise cells["value"].mark.error(
                f"found a value of joint {shown(joint.name)}, which joins {len(joint.links)} links, expected it on two"
            )
        first = joint.links[0]
        for other in joint.links[1:]:
            # What stands still is what the other is measured against.
            pair = (other, first) if other == ground and joint.name in values else (first, other)
            at = (places[joint.name, pair[0]], places[joint.name, pair[1]])
            directions = tuple(_direction(joint, link, shapes, ground) for link in pair)
            blue.append(
                BlueJoint(joint.name, joint.type, pair, at, (directions[0], directions[1]), values.get(joint.name))
            )
    try:
        return assemblies_of(Blueprint(tuple(shapes), ground, tuple(blue)))
    except InputError as error:
        units = context.units
        text = METRES.sub(lambda found: f"{float(found[1]) / units.metres:.6g} {units.length}", str(error))
        raise mark.error(text if text.startswith("found") else f"found links that do not fit: {text}") from None


def _places(
    joints: tuple[MechanismJoint, ...], nodes: Sequence[MappingType[str, Node]], shapes: dict[str, LinkShape],
    ground: str, values: MappingType[str, float],
) -> dict[tuple[str, str], complex]:  # fmt: skip
    """Where each joint is in the frame of each of its links [m]."""
    mine: dict[str, list[MechanismJoint]] = {
        link: [joint for joint in joints if link in joint.links and not joint.gearing] for link in shapes
    }
    written = {joint.name: cells for joint, cells in zip(joints, nodes, strict=True)}
    places: dict[tuple[str, str], complex] = {}
    for joint, cells in zip(joints, nodes, strict=True):
        for key in ("at", "axis"):
            if key in cells and ground not in joint.links:
                raise cells[key].mark.error(
                    f"found '{key}' of joint {shown(joint.name)} in a mechanism by lengths, expected it only on joints "
                    f"of {shown(ground)}, which stands still"
                )
    for link, shape in shapes.items():
        names = [joint.name for joint in mine[link]]
        for name, mark in shape.marks.items():
            if name not in names:
                hint = did_you_mean(name, names) or f", expected one of {', '.join(names[:12])}"
                raise mark.error(f"found the unknown joint '{shown(name)}' on link {shown(link)}{hint}")
        at = {joint.name: joint.at for joint in mine[link] if link == ground and joint.at is not None}
        if at and (shape.length is not None or shape.places):
            name = next(iter(at))
            raise written[name]["at"].mark.error(
                f"found 'at' of joint {shown(name)} beside the shape of {shown(ground)}, expected one of them"
            )
        if shape.length is not None and len(names) != 2:
            raise shape.mark.error(
                f"found a length of link {shown(link)}, which has {len(names)} joints, expected `places` of them"
            )
        # A crank's angle is that of its line away from the joint that turns it.
        ordered = sorted(mine[link], key=lambda joint: link != ground and joint.name not in values)
        for k, joint in enumerate(ordered):
            where = at.get(joint.name)
            if where is not None:
                place = complex(where[0], where[1])
            elif shape.length is not None:
                place = complex(k * shape.length)
            else:
                place = shape.places.get(joint.name, 0j)
            places[joint.name, link] = place
        _check_told(link, mine[link], at, shape)
    return places


def _check_told(link: str, joints: list[MechanismJoint], at: MappingType[str, object], shape: LinkShape) -> None:
    """Raise DescriptionError for a link of several hinges that says nowhere where they are."""
    if shape.length is not None or (shape.stated and shape.places):
        missing = [joint.name for joint in joints if shape.places and joint.name not in shape.places]
        if missing:
            raise shape.mark.error(f"found no place of joint {shown(missing[0])} on link {shown(link)}, expected it")
        return
    hinges = [joint.name for joint in joints if joint.type != "prismatic" and joint.name not in at]
    if len(hinges) > 1 or (hinges and at):
        listed = ", ".join(hinges)
        raise shape.mark.error(
            f"found no length of link {shown(link)}, which has the joints {listed}, expected `length` or `places`"
        )


def _direction(joint: MechanismJoint, link: str, shapes: dict[str, LinkShape], ground: str) -> float:
    """The direction of a slide or a weld in a link's frame [rad]: that of x unless it is given."""
    if link == ground and joint.type == "prismatic" and joint.axes is not None:
        return float(np.arctan2(joint.axes[0, 1], joint.axes[0, 0]))
    return shapes[link].directions.get(joint.name, 0.0)


def placed(
    joints: tuple[MechanismJoint, ...], mode: AssemblyMode, shapes: dict[str, LinkShape], ground: str
) -> tuple[MechanismJoint, ...]:
    """The joints with their places and directions in the world, put together in one way."""
    made = []
    for joint in joints:
        if joint.name not in mode.places:
            made.append(joint)
            continue
        at = mode.places[joint.name]
        axes = joint.axes
        if joint.type == "prismatic":
            angle = mode.angles[joint.links[0]] + _direction(joint, joint.links[0], shapes, ground)
            axes = np.array([[np.cos(angle), np.sin(angle), 0.0]])
        made.append(replace(joint, at=np.array([at.real, at.imag, 0.0]), axes=axes, rounding=None))
    return tuple(made)


def mode_of(node: Node | None, asked: int | None, count: int, context: Context, file: str) -> int:
    """Which of the ways is meant, from 1. Raises DescriptionError, or InputError for one asked for elsewhere."""
    known = "1" if count == 1 else "1 or 2" if count == 2 else f"1 to {count}"
    if asked is not None:
        if not 1 <= asked <= count:
            raise InputError(f"--mode: found {asked}, expected {known}: {file} can be put together in so many ways")
        return asked
    if node is None:
        return 1
    number = raw_number_of(node, context.scope, "the mode")
    if number != int(number) or not 1 <= number <= count:
        raise node.mark.error(f"found {number:g} as the mode, expected {known}: as many ways there are")
    return int(number)
