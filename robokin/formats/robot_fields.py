"""The fields of a robot's description to a Robot."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from robokin.arrays import Array
from robokin.errors import shown
from robokin.formats.description_head import Head
from robokin.formats.joint_table import rows_of
from robokin.formats.node_values import (
    Context,
    choice_of,
    list_of,
    number_of,
    parameters_in_position,
    raw_number_of,
    transform_of,
)
from robokin.formats.plausibility import notes_on
from robokin.formats.schema import CONVENTIONS
from robokin.formats.yaml_tree import Mapping, Node, describe
from robokin.model import JointType, Robot


def read_robot(head: Head) -> Robot:
    """The robot with these fields. Raises DescriptionError."""
    fields, context = head.fields, head.context
    attempt = context.faults.attempt
    convention: str | None = "standard"
    if "convention" in fields:
        convention = attempt(None, choice_of, fields["convention"], CONVENTIONS, "the convention")
    rows, types = attempt((None, None), rows_of, fields["joints"], convention, context)
    base, tool = (
        attempt(np.eye(4), transform_of, fields[name], context, name) if name in fields else np.eye(4)
        for name in ("base", "tool")
    )
    poses = attempt({}, poses_of, fields["poses"], types, context) if "poses" in fields else {}
    context.faults.stop()
    assert rows is not None and convention is not None  # else there was a mistake
    robot = Robot(
        name=head.name,
        rows=rows,
        convention=convention,  # type: ignore[arg-type]  # choice_of has made sure
        id=head.id,
        description=head.description,
        source=head.source,
        units=context.units,
        parameters=head.parameters,
        base=base,
        tool=tool,
        poses=poses,
        texts=tuple(
            (f"{name} {axis}", text)
            for name in ("base", "tool")
            if name in fields
            for axis, text in parameters_in_position(fields[name], context)
        ),
    )
    return replace(robot, notes=notes_on(context, robot))


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
