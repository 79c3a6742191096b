"""Arms with an orthogonal or parallel base and a spherical wrist, by seven lengths, to rows.

With u_i = sense_i q_i - offset_i the flange is at

    Rz(u1) Trans(a1, b, c1) Ry(u2) Tz(c2) Ry(u3) Trans(a2, 0, c3) Rz(u4) Ry(u5) Rz(u6) Tz(c4),

so at zero the arm points straight up. The parameters are those of M. Brandstötter, A. Angerer and M. Hofbaur, "An
analytical solution of the inverse kinematics problem of industrial serial manipulators with an ortho-parallel basis and
a spherical wrist", Austrian Robotics Workshop 2014; their offsets are subtracted.
"""

from __future__ import annotations

from collections.abc import Mapping as MappingType

import numpy as np

from robokin.formats.chain_parts import ChainParts, limits_by_joint
from robokin.formats.joint_row import sense_of
from robokin.formats.node_values import Context, list_of, number_of, parameters_in
from robokin.formats.yaml_tree import Node
from robokin.model import Joint, JointType
from robokin.spatial import translation_transform

LENGTHS = ("a1", "a2", "b", "c1", "c2", "c3", "c4")

AXES = "zyyzyz"

PLACES: tuple[tuple[str, str, str], ...] = (
    ("", "", ""), ("a1", "b", "c1"), ("", "", "c2"), ("a2", "", "c3"), ("", "", ""), ("", "", ""),
)  # fmt: skip
"""Which lengths are x, y and z from each joint to the next."""


def chain_of_opw(fields: MappingType[str, Node], context: Context) -> ChainParts:
    """The chain of six joints that lengths, `offsets`, `senses` and `limits` describe; mistakes are gathered."""
    attempt = context.faults.attempt
    before = context.faults.count
    types = (JointType.REVOLUTE,) * 6
    lengths = {
        name: attempt(0.0, number_of, fields[name], context, name, angle=False) for name in LENGTHS if name in fields
    }
    offset_nodes = attempt([], list_of, fields["offsets"], "the offsets", 6) if "offsets" in fields else []
    offsets = [
        attempt(0.0, number_of, node, context, f"offset {i}", angle=True) for i, node in enumerate(offset_nodes, 1)
    ]
    senses = [1] * 6
    if "senses" in fields:
        nodes = attempt([], list_of, fields["senses"], "the senses", 6)
        senses = [attempt(1, sense_of, node, f"of joint {i}", context) for i, node in enumerate(nodes, 1)]
    limits = [(-np.inf, np.inf)] * 6
    if "limits" in fields:
        limits = attempt(limits, limits_by_joint, fields["limits"], types, context)
    if context.faults.count > before:
        return ChainParts(None, types, "frames")
    named = {name: text for name in lengths if (text := parameters_in(fields[name], context))}
    rows = []
    for i, (axis, place) in enumerate(zip(AXES, PLACES, strict=True)):
        texts = [(letter, named[name]) for letter, name in zip("xyz", place, strict=True) if name in named]
        if offset_nodes and (text := parameters_in(offset_nodes[i], context)):
            texts.append(("offset", f"-({text})"))
        rows.append(
            Joint(
                name=str(i + 1),
                type=JointType.REVOLUTE,
                offset=0.0 - offsets[i] if offset_nodes else 0.0,
                limits=limits[i],
                origin=translation_transform([lengths.get(name, 0.0) for name in place]),
                axis=np.array([float(axis == letter) for letter in "xyz"]),
                texts=tuple(texts),
                sense=senses[i],
            )
        )
    tail = translation_transform([0.0, 0.0, lengths.get("c4", 0.0)])
    return ChainParts(tuple(rows), types, "frames", tail, f"Trans(0, 0, {named['c4']})" if "c4" in named else "")
