"""Arms and configurations for tests of inverse kinematics: round ones, at limits, next to singular poses, at random."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from inverse.truth import Scale, least_singular_value
from library_entries import names_of

import robokin
from robokin.formats.read import read_text
from robokin.model import Joint, JointType, Robot

RIGHT = np.pi / 2

GRIDS = (90, 45, 30, 15)
"""Steps of round angles, in degrees."""

DISTURBED = (1e-12, 1e-9, 1e-6)
"""Distances from a round configuration [rad | size]."""

KINDS = ("random", *(f"grid {step}" for step in GRIDS), "q4 = 0", "at limits", *(f"round + {x:g}" for x in DISTURBED))
"""The kinds of configurations that `configurations` makes."""


def library_arms(least=2, most=6):
    """The names of the library's robots with so many joints."""
    return names_of(Robot, least, most)


def on_grid(robot, scale, rng, count, step):
    """(count, n) values within the limits that are multiples of step degrees; of a slide, of step / 360 of its way."""
    q = np.empty((count, robot.n))
    for k in range(robot.n):
        low, high = scale.low[k], scale.high[k]
        if robot.revolute[k]:
            unit = np.radians(step)
            values = unit * np.arange(np.ceil(low / unit - 1e-9), np.floor(high / unit + 1e-9) + 1)
        else:
            values = np.linspace(low, high, round(360 / step) + 1)
        q[:, k] = rng.choice(values, count) if len(values) else (low + high) / 2.0
    return np.clip(q, *robot.limits.T)


def configurations(robot, scale, rng, count, kind):
    """(count, n) joint values of a kind, within the limits [rad | m]."""
    q = rng.uniform(scale.low, scale.high, (count, robot.n))
    if kind.startswith("grid"):
        q = on_grid(robot, scale, rng, count, int(kind.split()[1]))
    elif kind == "q4 = 0":
        q[:, min(3, robot.n - 1)] = 0.0
    elif kind == "at limits":
        # One joint after another at one of its limits and the rest anywhere, or on a grid, or all at limits.
        ends = np.stack([scale.low, scale.high])
        for i, one in enumerate(np.resize(rng.permutation(2 * robot.n), count)):
            case = rng.integers(5)
            if case > 1:
                q[i] = on_grid(robot, scale, rng, 1, (90, 30)[case % 2])[0]
            if case == 4:
                q[i] = ends[rng.integers(0, 2, robot.n), np.arange(robot.n)]
            q[i, one // 2] = ends[one % 2, one // 2]
    elif kind.startswith("round"):
        step = rng.choice(GRIDS, count)
        q = np.array([on_grid(robot, scale, rng, 1, one)[0] for one in step]).reshape(count, robot.n)
        off = float(kind.split()[-1])
        q = q + off * rng.uniform(-1.0, 1.0, q.shape) * scale.unit
    return np.clip(q, *robot.limits.T)


def random_chain(rng):
    """A robot of two to six joints with special geometry that is not singular everywhere.

    None to three joints slide. Half of the lengths are 0; the twists are 0, right angles, 180° or anything. Half of
    the arms have limits.
    """
    n = int(rng.choice([2, 3, 4, 5, 6], p=[0.06, 0.12, 0.22, 0.25, 0.35]))
    while True:
        sliding = rng.choice(n, int(rng.integers(0, min(3, n) + 1)), replace=False)
        limited = rng.random() < 0.5
        rows = []
        for i in range(n):
            a, d = np.round(rng.uniform(-0.5, 0.5, 2), 2) * (rng.random(2) < 0.5) + 0.0
            twist = rng.choice([0.0, RIGHT, -RIGHT, np.pi, rng.uniform(-3.0, 3.0)])
            if i in sliding:
                limits = (0.0, round(rng.uniform(0.3, 1.0), 2)) if limited else (-np.inf, np.inf)
                theta = rng.choice([0.0, 0.0, RIGHT, -RIGHT])
                rows.append(Joint(f"q{i + 1}", JointType.PRISMATIC, theta=theta, a=a, alpha=twist, limits=limits))
            else:
                limits = tuple(np.radians(rng.choice([[-180, 180], [-150, 150], [-90, 120]]))) if limited else None
                limits = limits or (-np.inf, np.inf)
                rows.append(Joint(f"q{i + 1}", JointType.REVOLUTE, d=d, a=a, alpha=twist, limits=limits))
        robot = Robot("random chain", tuple(rows))
        scale = Scale(robot)
        q = rng.uniform(scale.low, scale.high, (8, n))
        if np.max(least_singular_value(robot, scale, q)) > 1e-3:
            return robot


def table(rows, convention="standard", name="table"):
    """A robot of turning joints from rows (d [m], a [m], alpha [°])."""
    joints = [
        Joint(f"q{i + 1}", JointType.REVOLUTE, d=d, a=a, alpha=float(np.radians(alpha)))
        for i, (d, a, alpha) in enumerate(rows)
    ]
    return Robot(name, tuple(joints), convention=convention)


def in_own_units(robot, q):
    """Joint values in degrees and millimetres, rounding of the units taken out of round ones."""
    values = np.where(robot.revolute, np.degrees(q), 1000.0 * np.asarray(q)).tolist()
    return [round(v, 9) + 0.0 if abs(v - round(v, 9)) < 2e-13 else v for v in values]


def dh_of(robot):
    """The table of a random chain as text."""
    cells = []
    for joint in robot.rows:
        turns = joint.type is JointType.REVOLUTE
        own = f"d {joint.d + 0.0:g}" if turns else f"theta {np.degrees(joint.theta):g}"
        ends = np.round(np.degrees(joint.limits) if turns else joint.limits, 9).tolist()
        limits = "" if joint.unlimited else f", limits {ends}"
        alpha = float(np.degrees(joint.alpha))
        cells.append(f"{joint.type.letter}({own}, a {joint.a + 0.0:g}, alpha {alpha!r}{limits})")
    return " ".join(cells)


def pose_of(robot, q_degrees):
    """The pose (4, 4) of joint values in degrees and metres."""
    q = np.where(robot.revolute, np.radians(q_degrees), q_degrees)
    return robokin.forward_kinematics(robot, q)


def with_limits(robot, limits):
    """The robot with other limits (n, 2) [rad | m]; every row moves."""
    rows = (replace(row, limits=tuple(map(float, own))) for row, own in zip(robot.rows, limits, strict=True))
    return replace(robot, rows=tuple(rows))


OFFSET_WRIST = read_text(
    """
robokin: 1
name: An arm with an offset wrist, whose limits are met by two joints at once
source: derived from the URDF of an early big YAM (github.com/i2rt-robotics/i2rt)
units: {length: mm, angle: deg}
parameters: {upper_arm: sqrt(378.697**2 + 68**2), slant: "atan2(68, 378.697)"}
base: Rot(x, 180)
joints:
  - {type: revolute, offset: 0,           d: -130.5519, a: 21.9115,     alpha: 90,   limits: [-150, 175]}
  - {type: revolute, offset: slant - 180, d: 0,         a: upper_arm,   alpha: 180,  limits: [0, 180]}
  - {type: revolute, offset: slant - 180, d: 0,         a: 381.981,     alpha: -180, limits: [0, 180]}
  - {type: revolute, offset: 0,           d: -0.4568,   a: 73.9989,     alpha: 90,   limits: [-90, 90]}
  - {type: revolute, offset: -90,         d: -0.1993,   a: 0.000239858, alpha: 90,   limits: [-90, 90]}
  - {type: revolute, offset: 180,         d: -35.6,     a: 0,           alpha: 0,    limits: [-120, 120]}
"""
)
"""An arm of six joints, two of whose limits one configuration of a self-motion is at."""

SPHERICAL_WRIST = read_text(
    """
robokin: 1
name: An arm with a shoulder to the side and a spherical wrist
source: the table of the Stäubli TX2-90L in ARTE, a Robotics Toolbox for Education
units: {length: mm, angle: deg}
joints:
  - {type: revolute, offset: 0,   d: 478, a: 50,  alpha: -90}
  - {type: revolute, offset: -90, d: 50,  a: 500, alpha: 0}
  - {type: revolute, offset: 90,  d: 0,   a: 0,   alpha: 90}
  - {type: revolute, offset: 0,   d: 550, a: 0,   alpha: -90}
  - {type: revolute, offset: 0,   d: 0,   a: 0,   alpha: 90}
  - {type: revolute, offset: 0,   d: 100, a: 0,   alpha: 0}
"""
)
"""One without limits."""
