"""The fields of a robot's description to a Robot."""

from __future__ import annotations

import contextlib
from dataclasses import replace

import numpy as np

from robokin.arrays import Array
from robokin.errors import ExpressionError, shown
from robokin.formats.chain_forms import read_chain
from robokin.formats.chain_parts import ChainParts
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


def read_robot(head: Head) -> Robot:
    """The robot with these fields. Raises DescriptionError."""
    fields, context = head.fields, head.context
    attempt = context.faults.attempt
    chain = read_chain(fields, context)
    base, tool = (
        attempt(np.eye(4), transform_of, fields[name], context, name) if name in fields else np.eye(4)
        for name in ("base", "tool")
    )
    poses = attempt({}, poses_of, fields["poses"], chain.types, context) if "poses" in fields else {}
    context.faults.stop()
    assert chain.rows is not None and chain.convention is not None  # else there was a mistake
    base_texts = parameters_in_position(fields["base"], context) if "base" in fields else ()
    robot = Robot(
        name=head.name,
        rows=chain.rows,
        convention=chain.convention,  # type: ignore[arg-type]  # choice_of has made sure
        id=head.id,
        description=head.description,
        source=head.source,
        units=context.units,
        parameters=head.parameters,
        base=base,
        tool=tool if np.array_equal(chain.tail, np.eye(4)) else chain.tail @ tool,
        poses=poses,
        texts=(
            *((f"base {axis}", text) for axis, text in base_texts),
            *((f"tool {axis}", text) for axis, text in _tool_texts(fields.get("tool"), context, chain)),
        ),
    )
    return replace(robot, notes=notes_on(context, robot))


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
