"""Other descriptions of a robot: the same arm in other frames, and with the base, tool, zeros and senses moved."""

from __future__ import annotations

import dataclasses

import numpy as np

from robokin.kernel.chain import chain_of
from robokin.model import Joint, JointType, Robot
from robokin.spatial import invert, rotation_from_rpy, rotation_transform, transform, translation_transform

FLIP = rotation_transform([1.0, 0.0, 0.0], np.pi)


def any_motion(rng, size):
    return transform(rotation_from_rpy(rng.uniform(-np.pi, np.pi, 3)), rng.uniform(-size, size, 3))


def symmetry(rng, turning, size):
    """A motion that commutes with a joint's."""
    shift = [0.0, 0.0, rng.uniform(-size, size)] if turning else rng.uniform(-size, size, 3)
    return rotation_transform([0.0, 0.0, 1.0], rng.uniform(-np.pi, np.pi)) @ translation_transform(shift)


def joint_motion(turning, value):
    if turning:
        return rotation_transform([0.0, 0.0, 1.0], value)
    return translation_transform([0.0, 0.0, value])


def redrawn(robot, rng, size, free=()):
    """The robot in the frames convention, every frame moved as far as its joint allows; and c and s of q = s (q + c).

    `free` are base, tool, zero and sign: what is changed besides.
    """
    chain = chain_of(robot)
    n = chain.n
    zeros = rng.uniform(-1.5, 1.5, n) if "zero" in free else np.zeros(n)
    signs = rng.choice([1, -1], n) if "sign" in free else np.ones(n, dtype=int)
    left = [any_motion(rng, size) if "base" in free else np.eye(4)]
    right = []
    for turning, sign, zero, offset in zip(chain.revolute, signs, zeros, chain.offsets, strict=True):
        g = symmetry(rng, turning, size) @ (FLIP if sign < 0 else np.eye(4))
        right.append(g)
        # The offset goes into the constant; the zero's shift comes before the joint's motion in the new frames.
        left.append(invert(joint_motion(turning, zero - offset) @ g))
    right.append(any_motion(rng, size) if "tool" in free else np.eye(4))
    constants = [a @ C @ b for a, C, b in zip(left, chain.constants, right, strict=True)]
    joints = [
        Joint(f"j{i}", JointType.REVOLUTE if turning else JointType.PRISMATIC, origin=C, axis=[0.0, 0.0, 1.0])
        for i, (turning, C) in enumerate(zip(chain.revolute, constants, strict=False))
    ]
    other = Robot(robot.name, tuple(joints), "frames", id=robot.id, units=robot.units, tool=constants[-1])
    return other, zeros, signs


def with_cell(robot, row, **cells):
    """The robot with a row changed."""
    rows = list(robot.rows)
    rows[row] = dataclasses.replace(rows[row], **cells)
    return dataclasses.replace(robot, rows=tuple(rows))
