"""What every way to write a chain comes to: rows, and what stands between the last of them and the tool."""

from __future__ import annotations

from collections.abc import Sequence as SequenceType
from dataclasses import dataclass, field

import numpy as np

from robokin.arrays import Array
from robokin.formats.joint_row import limits_of
from robokin.formats.node_values import Context, list_of
from robokin.formats.yaml_tree import Node, Scalar
from robokin.model import Joint, JointType


@dataclass(frozen=True)
class ChainParts:
    """The rows of a chain in a convention of the model; None where one of them is wrong, its mistakes gathered.

    types: those of the joints, None where they are not known; tail: the constant transform (4, 4) [m] from the last row
    to where `tool` begins; tail_text: an expression for it, "" where it names no parameter.
    """

    rows: tuple[Joint, ...] | None
    types: tuple[JointType, ...] | None
    convention: str | None
    tail: Array = field(default_factory=lambda: np.eye(4))
    tail_text: str = ""


def limits_by_joint(
    node: Node, types: SequenceType[JointType], context: Context
) -> list[tuple[float, float]]:  # fmt: skip
    """The limits of each joint from one list, [rad | m]; nothing in the place of a pair is no limit.

    Raises DescriptionError.
    """
    pairs = list_of(node, "the limits")
    if len(pairs) != len(types):
        raise node.mark.error(f"found limits for {len(pairs)} joints, expected {len(types)}: a pair for each, or ~")

    def pair(item: tuple[int, Node, JointType]) -> tuple[float, float]:
        number, limits, kind = item
        if isinstance(limits, Scalar) and limits.empty:
            return (-np.inf, np.inf)
        return limits_of(limits, kind is JointType.REVOLUTE, f"of joint {number}", context)

    return context.faults.each(pair, zip(range(1, len(types) + 1), pairs, types, strict=True))
