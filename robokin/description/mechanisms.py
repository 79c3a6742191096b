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
    raw_number_of,
    text_of,
    vector_of,
)
from robokin.description.read import Head
from robokin.description.schema import FREEDOMS, MECHANISM_JOINT, SPACES
from robokin.description.tree import Node
from robokin.errors import did_you_mean
from robokin.model import Mechanism, MechanismJoint

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
        raise fields["links"].mark.error(f"found {len(links)} link, expected at least two: the ground is one")
    ground = links[0]
    if "ground" in fields:
        ground = _link(fields["ground"], links, "the ground")
    joints: list[MechanismJoint] = []
    names: dict[str, int] = {}
    nodes = list_of(fields["joints"], "the joints")
    if not nodes:
        raise fields["joints"].mark.error("found no joints, expected at least one")
    for i, node in enumerate(nodes, start=1):
        joint = _joint(fields_of(node, MECHANISM_JOINT, f"joint {i}"), i, space, links, head.context)
        if joint.name in names:
            raise node.mark.error(
                f"joint {i} is named '{joint.name}' like joint {names[joint.name]}, expected another name"
            )
        names[joint.name] = i
        joints.append(joint)
    return Mechanism(
        name=head.name,
        space=space,  # type: ignore[arg-type]  # choice_of has made sure
        links=links,
        joints=tuple(joints),
        ground=ground,
        id=head.id,
        description=head.description,
        source=head.source,
        units=head.context.units,
        parameters=head.parameters,
    )


def _joint(
    cells: MappingType[str, Node], i: int, space: str, links: tuple[str, ...], context: Context
) -> MechanismJoint:
    name = text_of(cells["name"], f"the name of joint {i}") if "name" in cells else str(i)
    where = f"of joint {name}"
    kind = choice_of(cells["type"], MECHANISM_JOINT["type"].choices, f"the type {where}")
    joined = tuple(_link(item, links, f"a link {where}") for item in list_of(cells["links"], f"the links {where}"))
    if len(joined) < 2:
        raise cells["links"].mark.error(f"found {len(joined)} link {where}, expected at least two")
    if len(set(joined)) < len(joined):
        raise cells["links"].mark.error(f"joint {name} joins a link to itself, expected different links")
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
        freedoms=_freedoms(cells, kind, where, context),
        at=vector_of(cells["at"], context, f"at {where}", direction=False) if "at" in cells else None,
        axes=_axes(cells, kind, space, where, context),
        pitch=_pitch(cells, where, context),
        actuated=flag_of(cells["actuated"], f"actuated {where}") if "actuated" in cells else False,
    )


def _link(node: Node, links: tuple[str, ...], what: str) -> str:
    name = text_of(node, what)
    if name not in links:
        hint = did_you_mean(name, links) or f", expected one of {', '.join(links)}"
        raise node.mark.error(f"found the unknown link '{name}' as {what}{hint}")
    return name


def _freedoms(cells: MappingType[str, Node], kind: str, where: str, context: Context) -> int:
    if kind != "custom":
        return FREEDOMS[kind]
    if "freedoms" not in cells:
        raise cells["type"].mark.error(f"'freedoms' is missing {where}, expected freedoms: 0 to 6 on type custom")
    number = raw_number_of(cells["freedoms"], context.scope, f"freedoms {where}")
    if number != int(number) or not 0 <= number <= 6:
        raise cells["freedoms"].mark.error(f"found {number:g} freedoms {where}, expected a whole number from 0 to 6")
    return int(number)


def _axes(cells: MappingType[str, Node], kind: str, space: str, where: str, context: Context) -> Array | None:
    """Unit directions (k, 3), or None where the joint has or is given none."""
    if "axes" in cells:
        pair = list_of(cells["axes"], f"axes {where}", 2)
        axes = np.array([vector_of(item, context, f"axes {where}", direction=True) for item in pair])
        if np.linalg.norm(np.cross(axes[0], axes[1])) < 1e-9:
            raise cells["axes"].mark.error(f"the two axes {where} are parallel, expected two directions")
        return axes
    for key in ("axis", "normal"):
        if key in cells:
            return vector_of(cells[key], context, f"{key} {where}", direction=True)[None]
    # In the plane a hinge's axis, and a planar joint's normal, can only be the plane's own.
    if space == "planar" and kind in ("revolute", "planar", "rolling", "gear", "cam"):
        return np.array([[0.0, 0.0, 1.0]])
    return None


def _pitch(cells: MappingType[str, Node], where: str, context: Context) -> float:
    """Advance [m/rad] of a helical joint; the file states it for one turn."""
    if "pitch" not in cells:
        return 0.0
    per_turn = raw_number_of(cells["pitch"], context.scope, f"pitch {where}") * context.units.metres
    return per_turn / (2.0 * math.pi)
