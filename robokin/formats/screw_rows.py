"""Joint axes in the base's frame and the tool's pose, all at q = 0, to rows: the product of exponentials.

T = e^(S1 q1) … e^(Sn qn) home. Each axis becomes a frame that is parallel to the base's: its origin is the way from the
axis before, and from the last one the tool stands at Trans(-p) home.
"""

from __future__ import annotations

from collections.abc import Mapping as MappingType
from dataclasses import replace

import numpy as np

from robokin.formats.chain_parts import ChainParts
from robokin.formats.joint_table import rows_of
from robokin.formats.node_values import Context, parameters_in_position, transform_of
from robokin.formats.yaml_tree import Node, Scalar
from robokin.model import JointType
from robokin.spatial import translation_transform
from robokin.units import Units


def chain_of_screws(fields: MappingType[str, Node], context: Context) -> ChainParts:
    """The chain that `home` and the axes in `joints` describe; mistakes are gathered."""
    attempt, before = context.faults.attempt, context.faults.count
    home = attempt(np.eye(4), transform_of, fields["home"], context, "home")
    rows, types = attempt((None, None), rows_of, fields["joints"], "screws", context)
    if rows is None or context.faults.count > before:
        return ChainParts(None, types, "frames")
    point = np.zeros(3)
    named: dict[str, str] = {}
    chained = []
    for row in rows:
        assert row.origin is not None
        there, texts = row.origin[:3, 3], dict(row.texts)
        if row.type is JointType.PRISMATIC and not there.any() and not texts:  # a slide is anywhere
            there, texts = point, named
        ways = tuple((axis, _way(axis, texts, there, named, point, context.units)) for axis in "xyz")
        origin = translation_transform(there - point)
        chained.append(replace(row, origin=origin, texts=tuple((axis, text) for axis, text in ways if text)))
        point, named = there, texts
    tail_text = ""
    home_node = fields["home"]
    if isinstance(home_node, Scalar) and (named or parameters_in_position(home_node, context)):
        far = [named.get(axis) or _number(point[i], context.units) for i, axis in enumerate("xyz")]
        tail_text = f"Trans({', '.join(f'-({part})' if part else '0' for part in far)}) {home_node.text}"
    return ChainParts(tuple(chained), types, "frames", translation_transform(-point) @ home, tail_text)


def _way(axis: str, texts: dict[str, str], there: np.ndarray, named: dict[str, str], point: np.ndarray,
         units: Units) -> str:  # fmt: skip
    """How far it is from one point to another along a coordinate, where it names parameters; else ""."""
    i = "xyz".index(axis)
    if not (axis in texts or axis in named) or texts.get(axis) == named.get(axis):
        return ""
    to = texts.get(axis) or _number(there[i], units)
    back = named.get(axis) or _number(point[i], units)
    if not back:
        return to
    return f"({to}) - ({back})" if to else f"-({back})"


def _number(length: float, units: Units) -> str:
    """A length as an expression, "" for none."""
    return repr(float(length / units.metres)) if length else ""
