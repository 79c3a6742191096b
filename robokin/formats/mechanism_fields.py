"""The links and joints of a mechanism's description to a Mechanism."""

from __future__ import annotations

import math
from collections.abc import Mapping as MappingType
from dataclasses import replace

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError, did_you_mean, shown
from robokin.formats.description_head import Head
from robokin.formats.gear_ratios import GEARED, gearing_of
from robokin.formats.link_lengths import LinkShape, assembled_joints, links_of, mode_of, placed, value_of
from robokin.formats.node_values import (
    Context,
    choice_of,
    direction_roundings_of,
    fields_of,
    flag_of,
    list_of,
    number_of,
    raw_number_of,
    refuse_keys_of_others,
    rounding_of,
    roundings_of,
    text_of,
    type_of,
    vector_of,
    whole_numbers_of,
)
from robokin.formats.plausibility import notes_on
from robokin.formats.schema import EXPECTED, FREEDOMS, MAX_ROWS, MECHANISM_JOINT, ONE_CONSTRAINT, SPACES
from robokin.formats.yaml_tree import Node
from robokin.model import Mechanism, MechanismJoint, Rounding
from robokin.model.blueprint import AssemblyMode
from robokin.model.mechanism import LAMBDA

OWN_KEYS = {
    "pitch": ("helical",), "axes": ("universal", "gear"), "normal": ("planar",), "freedoms": ("custom",),
    "ratio": ("gear", "belt"), "teeth": ("gear", "belt"), "radii": ("belt",), "crossed": ("belt",),
    "carrier": ("gear", "belt"),
}  # fmt: skip
"""Keys that belong to some types of joints."""

OTHER_NAMES = {"chain": "belt with teeth", "bevel": "gear", "worm": "gear", "pin": "revolute", "hinge": "revolute",
               "slider": "prismatic", "ball": "spherical", "screw": "helical"}  # fmt: skip
"""What other books call a type of joint."""


def read_mechanism(head: Head, mode: int | None = None) -> Mechanism:
    """The mechanism with the fields of `head`; `mode`: which way to put it together, if its links have lengths.

    Raises DescriptionError, and InputError for a mode that there is not.
    """
    fields, context = head.fields, head.context
    attempt = context.faults.attempt
    space = attempt(None, choice_of, fields["space"], SPACES, "the space")
    links, shapes = attempt(((), {}), _links_of, fields["links"], context, space)
    ground = links[0] if links else ""
    if "ground" in fields:
        ground = attempt(ground, _link, fields["ground"], links, "the ground")
    joints, cells = attempt(([], []), _joints, fields["joints"], space, links, context)
    output = attempt("", _output, fields["output"], links, ground) if "output" in fields else ""
    expected = attempt({}, whole_numbers_of, fields["expected"], EXPECTED, context) if "expected" in fields else {}
    context.faults.stop()
    assert space is not None  # else there was a mistake
    # How links fit together is asked only of links and joints that are right.
    modes, mode, whole = _assembled(fields, joints, cells, shapes, ground, space, mode, head)
    mechanism = Mechanism(
        name=head.name,
        space=space,  # type: ignore[arg-type]  # choice_of has made sure
        links=links,
        joints=tuple(joints),
        ground=ground,
        output=output,
        expected=expected,
        id=head.id,
        description=head.description,
        source=head.source,
        units=context.units,
        parameters=head.parameters,
        ground_named="ground" in fields,
        modes=modes,
        mode=mode,
        modes_complete=whole,
    )
    return replace(mechanism, notes=notes_on(context, mechanism))


def _links_of(node: Node, context: Context, space: str | None) -> tuple[tuple[str, ...], dict[str, LinkShape]]:
    links, shapes = links_of(node, context, space in ("planar", None))
    count = len(list_of(node, "the links"))
    if count < 2:
        raise node.mark.error(f"found {_links(count)}, expected at least two: the ground is one")
    if len(links) > MAX_ROWS:
        raise node.mark.error(f"found {len(links)} links, expected at most {MAX_ROWS}")
    return links, shapes


def _joints(
    node: Node, space: str | None, links: tuple[str, ...], context: Context
) -> tuple[list[MechanismJoint], list[dict[str, Node]]]:
    """The joints and their entries; space: None where it is not known."""
    nodes = list_of(node, "the joints")
    if not nodes:
        raise node.mark.error("found no joints, expected at least one")
    if len(nodes) > MAX_ROWS:
        raise node.mark.error(f"found {len(nodes)} joints, expected at most {MAX_ROWS}")
    joints: list[MechanismJoint] = []
    entries: list[dict[str, Node]] = []
    names: dict[str, int] = {}
    for i, item in enumerate(nodes, start=1):
        cells = context.faults.attempt(None, fields_of, item, MECHANISM_JOINT, f"joint {i}", context.faults)
        if cells is None:
            continue
        name = str(i)
        if "name" in cells:
            name = context.faults.attempt(name, text_of, cells["name"], f"the name of joint {i}")
        if name in names:
            context.faults.add(
                item.mark.error(
                    f"found the name '{shown(name)}' of joint {i} on joint {names[name]} too, expected another name"
                )
            )
        names.setdefault(name, i)
        joint = context.faults.attempt(None, _joint, cells, name, space, links, context)
        if joint is not None:
            joints.append(joint)
            entries.append(cells)
    return joints, entries


def _output(node: Node, links: tuple[str, ...], ground: str) -> str:
    output = _link(node, links, "the output")
    if output == ground:
        raise node.mark.error(f"found the ground '{shown(output)}' as the output, expected a link that moves")
    return output


def _assembled(
    fields: MappingType[str, Node], joints: list[MechanismJoint], cells: list[dict[str, Node]],
    shapes: dict[str, LinkShape], ground: str, space: str, mode: int | None, head: Head,
) -> tuple[tuple[AssemblyMode, ...], int, bool]:  # fmt: skip
    """Put joints in the places that lengths say; the ways there are, the number of the one, whether those are all."""
    values: dict[str, float] = {}
    for joint, given in zip(joints, cells, strict=True):
        if "value" in given:
            value = head.context.faults.attempt(None, _value, given["value"], joint, space, head.context)
            values[joint.name] = 0.0 if value is None else value
    head.context.faults.stop()
    if not values and not any(shape.stated for shape in shapes.values()):
        if mode is not None:
            raise InputError(f"--mode: {head.name} has the places of its joints, expected a mechanism by lengths")
        if "mode" in fields:
            raise fields["mode"].mark.error("found 'mode' without lengths of links, expected it with `length` of links")
        return (), 0, True
    mark = fields["links"].mark
    ways = assembled_joints(tuple(joints), cells, values, shapes, ground, mark, head.context)
    mode = mode_of(fields.get("mode"), mode, len(ways.modes), head.context, head.name)
    joints[:] = placed(tuple(joints), ways.modes[mode - 1], shapes, ground)
    return ways.modes, mode, ways.complete


def _value(node: Node, joint: MechanismJoint, space: str, context: Context) -> float:
    if joint.type not in ("revolute", "prismatic") or space != "planar":
        raise node.mark.error(
            f"found 'value' of joint {shown(joint.name)}, expected it on hinges and slides of planar mechanisms"
        )
    return value_of(node, joint.type, f"of joint {shown(joint.name)}", context)


def _joint(
    cells: MappingType[str, Node], name: str, stated: str | None, links: tuple[str, ...], context: Context
) -> MechanismJoint | None:
    """A joint; None, and the mistakes gathered, where it is wrong. stated: the space, None where it is not known."""
    attempt = context.faults.attempt
    before = context.faults.count
    where = f"of joint {shown(name)}"
    space = stated or "planar"  # where a point may have two numbers or three
    kind = attempt(None, type_of, cells["type"], MECHANISM_JOINT["type"].choices, OTHER_NAMES, where)
    joined = attempt((), _joined, cells["links"], links, where, context)
    if kind == "rolling" and space != "planar":
        context.faults.add(
            cells["type"].mark.error(
                f"found '{kind}' {where} in a {space} mechanism, expected it in a planar one: "
                "use type custom with freedoms"
            )
        )
    if kind is not None:
        refuse_keys_of_others(cells, OWN_KEYS, kind, "joint", where, context)
    at = attempt(None, _at, cells["at"], space, where, context) if "at" in cells else None
    pitch = attempt(0.0, _pitch, cells, where, context)
    actuated = attempt(False, flag_of, cells["actuated"], f"actuated {where}") if "actuated" in cells else False
    carrier = attempt("", _link, cells["carrier"], links, f"the carrier {where}") if "carrier" in cells else ""
    axes: Array | None = None
    freedoms = 0
    if kind is not None and stated is not None:
        axes = attempt(None, _axes, cells, kind, space, where, context)
        freedoms = attempt(0, _freedoms, cells, kind, LAMBDA[space], where, context)
    if kind is None or stated is None or context.faults.count > before or not joined:
        return None
    gearing, meshes = gearing_of(cells, kind, space, joined, where, context)
    return MechanismJoint(
        name=name,
        type=kind,
        links=joined,
        freedoms=freedoms,
        at=at,
        axes=axes,
        pitch=pitch,
        actuated=actuated,
        gearing=gearing,
        meshes=meshes,
        carrier=carrier,
        rounding=_rounding(cells, 0 if axes is None else len(axes), where, context),
    )


def _joined(node: Node, links: tuple[str, ...], where: str, context: Context) -> tuple[str, ...]:
    """The links that a joint joins."""
    items = list_of(node, f"the links {where}")
    joined = tuple(context.faults.each(lambda item: _link(item, links, f"a link {where}"), items))
    if len(joined) < 2:
        raise node.mark.error(f"found {_links(len(joined))} {where}, expected at least two")
    if len(set(joined)) < len(joined):
        raise node.mark.error(f"found a link twice in the links {where}, expected different links")
    return joined


def _rounding(cells: MappingType[str, Node], count: int, where: str, context: Context) -> Rounding:
    """How far the numbers of a joint with `count` axes may be off, as they are written; they have been read before."""
    at, axes, pitch = np.zeros(3), np.zeros((count, 3)), 0.0
    if "at" in cells:
        at = roundings_of(cells["at"], context, f"at {where}") * context.units.metres
    if "axes" in cells:
        nodes = list_of(cells["axes"], f"axes {where}")
    else:
        nodes = [cells[key] for key in ("axis", "normal") if key in cells][:1]
    for i, node in enumerate(nodes[:count]):
        axes[i] = direction_roundings_of(node, context, f"axes {where}")
    if "pitch" in cells:
        pitch = rounding_of(cells["pitch"], context, f"pitch {where}") * context.units.metres / (2.0 * math.pi)
    return Rounding(at, axes, pitch)


def _links(count: int) -> str:
    return "1 link" if count == 1 else f"{count} links"


def _at(node: Node, space: str, where: str, context: Context) -> Array:
    """A point on the joint (3,) [m]."""
    return vector_of(node, context, f"at {where}", direction=False, plane=space == "planar")


def _link(node: Node, links: tuple[str, ...], what: str) -> str:
    name = text_of(node, what)
    if not links:
        raise node.mark.silent().error(f"found '{shown(name)}' as {what}, expected links that can be read")
    if name not in links:
        hint = did_you_mean(name, links) or f", expected one of {', '.join(links[:12])}"
        raise node.mark.error(f"found the unknown link '{shown(name)}' as {what}{hint}")
    return name


def _freedoms(cells: MappingType[str, Node], kind: str, most: int, where: str, context: Context) -> int:
    """What the joint lets two links do against each other: at most what the space has, λ."""
    if kind in ONE_CONSTRAINT:
        return most - 1
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
        if kind == "universal" and np.linalg.norm(np.cross(axes[0], axes[1])) < 1e-9:
            raise cells["axes"].mark.error(f"found parallel axes {where}, expected two directions")
        return axes
    if kind in ONE_CONSTRAINT and (not plane or kind == "belt" or any(key in cells for key in GEARED)):
        return None  # what is known of it is its ratio
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
