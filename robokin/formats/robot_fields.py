"""The fields of a robot's description to a Robot."""

from __future__ import annotations

import contextlib
from dataclasses import replace

import numpy as np

from robokin.arrays import Array
from robokin.errors import ExpressionError, InputError, shown
from robokin.formats.chain_forms import read_chain
from robokin.formats.chain_parts import ChainParts
from robokin.formats.couplings import couplings_of
from robokin.formats.description_head import Head
from robokin.formats.node_values import (
    Context,
    list_of,
    number_of,
    parameters_in_position,
    raw_number_of,
    transform_of,
)
from robokin.formats.number_expressions import names_parameters
from robokin.formats.plausibility import notes_on
from robokin.formats.transform_expressions import position_texts
from robokin.formats.yaml_tree import Mapping, Node, Scalar, describe
from robokin.model import JointType, Robot
from robokin.model.coupled_robot import driven
from robokin.model.graph import Coupling
from robokin.model.robot import graph_joint


def read_robot(head: Head) -> Robot:
    """The robot with these fields. Raises DescriptionError."""
    fields, context = head.fields, head.context
    attempt = context.faults.attempt
    chain = read_chain(fields, context)
    base, tool = (
        attempt(np.eye(4), transform_of, fields[name], context, name) if name in fields else np.eye(4)
        for name in ("base", "tool")
    )
    couplings: tuple[Coupling, ...] = ()
    types = chain.types
    if "couplings" in fields:
        couplings = attempt((), _couplings, fields["couplings"], chain, context)
        following = {coupling.joint for coupling in couplings if not coupling.own}
        if types is not None and following:
            moving = [row for row in chain.rows or () if row.moves]
            types = tuple(row.type for row in moving if row.name not in following) if moving else None
    poses = attempt({}, poses_of, fields["poses"], types, context) if "poses" in fields else {}
    context.faults.stop()
    assert chain.rows is not None and chain.convention is not None  # else there was a mistake
    base_texts = parameters_in_position(fields["base"], context) if "base" in fields else ()
    values = {
        "name": head.name,
        "rows": chain.rows,
        "convention": chain.convention,
        "id": head.id,
        "description": head.description,
        "source": head.source,
        "units": context.units,
        "parameters": head.parameters,
        "base": base,
        "tool": tool if np.array_equal(chain.tail, np.eye(4)) else chain.tail @ tool,
        "poses": poses,
        "texts": (
            *((f"base {axis}", text) for axis, text in base_texts),
            *((f"tool {axis}", text) for axis, text in _tool_texts(fields.get("tool"), context, chain)),
        ),
    }
    try:
        robot = driven(values, couplings)
    except InputError as error:  # a circle of couplings, or limits, which have no place of their own
        place = fields["couplings"] if "couplings" in fields else fields.get("joints", fields["name"])
        raise place.mark.error(str(error)) from None
    return replace(robot, notes=notes_on(context, robot))


def _couplings(node: Node, chain: ChainParts, context: Context) -> tuple[Coupling, ...]:
    """The couplings of a chain's joints; none where it could not be read."""
    if chain.rows is None or chain.convention is None:
        raise node.mark.silent().error("the joints are not known")
    joints = tuple(graph_joint(row, chain.convention, i, i + 1, row.name, i) for i, row in enumerate(chain.rows))
    return couplings_of(node, joints, context)


def _tool_texts(node: Node | None, context: Context, chain: ChainParts) -> tuple[tuple[str, str], ...]:
    """The coordinates of the tool that name parameters, behind what a chain has before it."""
    own = node.text if isinstance(node, Scalar) and not node.empty else ""
    before = chain.tail_text
    if not before and np.array_equal(chain.tail, np.eye(4)):
        return () if node is None else parameters_in_position(node, context)
    if not names_parameters(before + " " + own, context.scope):
        return ()
    if not before:
        rows = (f"[{', '.join(map(repr, [*row[:3], row[3] / context.units.metres]))}]" for row in chain.tail.tolist())
        before = f"Matrix([{', '.join(rows)}])"
    with contextlib.suppress(ExpressionError):  # both were read; only together they may be too long
        return position_texts(f"{before} {own}", context.scope, context.units)
    return ()


def poses_of(node: Node, types: tuple[JointType, ...] | None, context: Context) -> dict[str, Array]:
    """The poses by name; types: those of the joints, None where they are not known."""
    if not isinstance(node, Mapping):
        raise node.mark.error(f"found {describe(node)}, expected poses: a mapping of names to lists of joint values")
    poses: dict[str, Array] = {}
    for name, values in node.entries.items():
        what = f"the pose {shown(name)}"
        if not name.replace("-", "_").isidentifier():
            context.faults.add(
                node.keys[name].error(f"found the pose '{shown(name)}', expected a name of letters, digits, - and _")
            )
        poses[name] = context.faults.attempt(np.zeros(0), _pose, values, types, what, context)
    return poses


def _pose(node: Node, types: tuple[JointType, ...] | None, what: str, context: Context) -> Array:
    items = list_of(node, what)
    if types is None:  # how many values it has, and which are angles, is not known
        return np.array(context.faults.each(lambda item: raw_number_of(item, context.scope, what), items))
    if len(items) != len(types):
        raise node.mark.error(f"found {len(items)} values in {what}, expected {len(types)}: one for each joint")
    values = context.faults.each(
        lambda pair: number_of(pair[0], context, what, angle=pair[1] is JointType.REVOLUTE),
        zip(items, types, strict=True),
    )
    return np.array(values)
