"""The links and joints of a mechanism's description to a Mechanism."""

from __future__ import annotations

import math
from collections.abc import Mapping as MappingType

import numpy as np
from numpy.typing import NDArray

from robokin.description.cells import (
    Context,
    choice_of,
    fields_of,
    flag_of,
    list_of,
    names_of,
    number_of,
    raw_number_of,
    text_of,
    vector_of,
)
from robokin.description.read import Head
from robokin.description.schema import EXPECTED, FREEDOMS, MAX_ROWS, MECHANISM_JOINT, SPACES
from robokin.description.tree import Node
from robokin.errors import did_you_mean, shown
from robokin.model import Mechanism, MechanismJoint
from robokin.model.mechanism import LAMBDA

Array = NDArray[np.float64]

PLANE_ONLY = ("gear", "cam", "rolling")
"""Contacts whose freedoms are those of the plane."""

OWN_KEYS = {"pitch": "helical", "axes": "universal", "normal": "planar", "freedoms": "custom"}
"""Keys that belong to one type of joint."""


def read_mechanism(fields: MappingType[str, Node], head: Head) -> Mechanism:
    """The mechanism with these fields. Raises DescriptionError."""
    space = choice_of(fields["space"], SPACES, "the space")
    links = names_of(fields["links"], "the links")
    if len(links) < 2:
        raise fields["links"].mark.error(f"found {_links(len(links))}, expected at least two: the ground is one")
    if len(links) > MAX_ROWS:
        raise fields["links"].mark.error(f"found {len(links)} links, expected at most {MAX_ROWS}")
    ground = links[0]
    if "ground" in fields:
        ground = _link(fields["ground"], links, "the ground")
    joints: list[MechanismJoint] = []
    names: dict[str, int] = {}
    nodes = list_of(fields["joints"], "the joints")
    if not nodes:
        raise fields["joints"].mark.error("found no joints, expected at least one")
    if len(nodes) > MAX_ROWS:
        raise fields["joints"].mark.error(f"found {len(nodes)} joints, expected at most {MAX_ROWS}")
    for i, node in enumerate(nodes, start=1):
        joint = _joint(fields_of(node, MECHANISM_JOINT, f"joint {i}"), i, space, links, head.context)
        if joint.name in names:
            raise node.mark.error(
                f"found the name '{shown(joint.name)}' of joint {i} on joint {names[joint.name]} too, "
                "expected another name"
            )
        names[joint.name] = i
        joints.append(joint)
    output = _link(fields["output"], links, "the output") if "output" in fields else ""
    if output == ground:
        raise fields["output"].mark.error(
            f"found the ground '{shown(output)}' as the output, expected a link that moves"
        )
    return Mechanism(
        name=head.name,
        space=space,  # type: ignore[arg-type]  # choice_of has made sure
        links=links,
        joints=tuple(joints),
        ground=ground,
        output=output,
        expected=_expected(fields["expected"], head.context) if "expected" in fields else {},
        id=head.id,
        description=head.description,
        source=head.source,
        units=head.context.units,
        parameters=head.parameters,
    )


def _expected(node: Node, context: Context) -> dict[str, int]:
    """What the source says of the mechanism's freedoms."""
    numbers = {}
    for key, cell in fields_of(node, EXPECTED, "what is expected").items():
        number = raw_number_of(cell, context.scope, f"expected {key}")
        if number != int(number):
            raise cell.mark.error(f"found {number:g} as expected {key}, expected a whole number")
        numbers[key] = int(number)
    return numbers


def _joint(
    cells: MappingType[str, Node], i: int, space: str, links: tuple[str, ...], context: Context
) -> MechanismJoint:
    name = text_of(cells["name"], f"the name of joint {i}") if "name" in cells else str(i)
    where = f"of joint {shown(name)}"
    kind = choice_of(cells["type"], MECHANISM_JOINT["type"].choices, f"the type {where}")
    joined = tuple(_link(item, links, f"a link {where}") for item in list_of(cells["links"], f"the links {where}"))
    if len(joined) < 2:
        raise cells["links"].mark.error(f"found {_links(len(joined))} {where}, expected at least two")
    if len(set(joined)) < len(joined):
        raise cells["links"].mark.error(f"found a link twice in the links {where}, expected different links")
    if kind in PLANE_ONLY and space != "planar":
        raise cells["type"].mark.error(
            f"found '{kind}' {where} in a {space} mechanism, expected it in a planar one: use type custom with freedoms"
        )
    for key, owner in OWN_KEYS.items():
        if key in cells and kind != owner:
            raise cells[key].mark.error(f"found '{key}' {where}, a {kind} joint, expected it only on type {owner}")
    return MechanismJoint(
        name=name,
        type=kind,
        links=joined,
        freedoms=_freedoms(cells, kind, LAMBDA[space], where, context),
        at=_at(cells["at"], space, where, context) if "at" in cells else None,
        axes=_axes(cells, kind, space, where, context),
        pitch=_pitch(cells, where, context),
        actuated=flag_of(cells["actuated"], f"actuated {where}") if "actuated" in cells else False,
    )


def _links(count: int) -> str:
    return "1 link" if count == 1 else f"{count} links"


def _at(node: Node, space: str, where: str, context: Context) -> Array:
    """A point on the joint (3,) [m]."""
    return vector_of(node, context, f"at {where}", direction=False, plane=space == "planar")


def _link(node: Node, links: tuple[str, ...], what: str) -> str:
    name = text_of(node, what)
    if name not in links:
        hint = did_you_mean(name, links) or f", expected one of {', '.join(links[:12])}"
        raise node.mark.error(f"found the unknown link '{shown(name)}' as {what}{hint}")
    return name


def _freedoms(cells: MappingType[str, Node], kind: str, most: int, where: str, context: Context) -> int:
    """What the joint lets two links do against each other: at most what the space has, λ."""
    if kind != "custom":
        return FREEDOMS[kind]
    if "freedoms" not in cells:
        raise cells["type"].mark.error(f"found no 'freedoms' {where}, expected freedoms: 0 to {most} on type custom")
    number = raw_number_of(cells["freedoms"], context.scope, f"freedoms {where}")
    if number != int(number) or not 0 <= number <= most:
        raise cells["freedoms"].mark.error(
            f"found {number:g} freedoms {where}, expected a whole number from 0 to {most}, as the space has"
        )
    return int(number)


def _axes(cells: MappingType[str, Node], kind: str, space: str, where: str, context: Context) -> Array | None:
    """Unit directions (k, 3), or None where the joint has or is given none."""
    plane = space == "planar"
    if "axis" in cells and kind == "universal":
        raise cells["axis"].mark.error(f"found 'axis' {where}, a universal joint, expected its two directions: 'axes'")
    if "axis" in cells and "normal" in cells:
        raise cells["axis"].mark.error(f"found 'axis' and 'normal' {where}, expected one of them: they say the same")
    if kind == "helical" and "pitch" not in cells:
        return None  # a direction alone would make a hinge of it, so the geometry counts as not given
    if "axes" in cells:
        pair = list_of(cells["axes"], f"axes {where}", 2)
        axes = np.array([vector_of(item, context, f"axes {where}", direction=True, plane=plane) for item in pair])
        if np.linalg.norm(np.cross(axes[0], axes[1])) < 1e-9:
            raise cells["axes"].mark.error(f"found parallel axes {where}, expected two directions")
        return axes
    for key in ("axis", "normal"):
        if key in cells:
            return vector_of(cells[key], context, f"{key} {where}", direction=True, plane=plane)[None]
    # In the plane a hinge's axis, and a planar joint's normal, can only be the plane's own.
    if plane and kind in ("revolute", "planar", "rolling", "gear", "cam"):
        return np.array([[0.0, 0.0, 1.0]])
    return None


def _pitch(cells: MappingType[str, Node], where: str, context: Context) -> float:
    """Advance [m/rad] of a helical joint; the file states it for one turn."""
    if "pitch" not in cells:
        return 0.0
    return number_of(cells["pitch"], context, f"pitch {where}", angle=False) / (2.0 * math.pi)
