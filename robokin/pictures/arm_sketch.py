"""A sketch of an arm in lines, as SVG and as TikZ: small, the same bytes everywhere, and without a library.

The links are straight lines from joint to joint. Arms in the plane of x and y are seen from above, others from the
side and above (isometric).
"""

from __future__ import annotations

from dataclasses import dataclass
from html import escape

import numpy as np

from robokin.arrays import Array
from robokin.kinematics.flat_arm import flat_arm
from robokin.kinematics.forward import joint_frames
from robokin.kinematics.structure import arm_size
from robokin.model import Robot
from robokin.model.joint_units import in_units, joint_factors
from robokin.number_text import show
from robokin.pictures.arm_faces import COLOURS

WIDTH, HEIGHT, EDGE = 360.0, 260.0, 34.0
"""The picture and the room at its edges [px]."""

ISOMETRIC = np.array([[-np.sqrt(0.75), np.sqrt(0.75), 0.0], [0.5, 0.5, -1.0]])
"""From x, y, z to the right and down: x to the left and front, y to the right and front, z up."""

ABOVE = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])

BENT = np.radians(30.0)
"""Angles of an arm in the plane, which at zero would be a straight line."""

TOGETHER = 9.0
"""Joints nearer than this in the picture [px] share their label."""

PER_CENTIMETRE = 45.0
"""Pixels of a centimetre in TikZ."""


@dataclass(frozen=True, eq=False)
class ArmSketch:
    """Lines of an arm [px]: points (k, 2) from the base to the end effector, joints with their places and labels.

    axes: of the end effector, each with its end (2,); q: the values (n,) that are drawn, in the robot's units.
    """

    points: Array
    joints: tuple[tuple[str, bool, Array], ...]
    axes: tuple[tuple[str, str, Array], ...]
    q: tuple[float, ...]

    @property
    def about(self) -> str:
        """At which configuration the arm is drawn."""
        return f"drawn at q = ({', '.join(map(show, self.q))}), links as straight lines from joint to joint"

    def svg(self, name: str) -> bytes:
        """The sketch as SVG."""
        line = " ".join(f"{_px(x)},{_px(y)}" for x, y in self.points)
        parts = [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH:.0f} {HEIGHT:.0f}" width="{WIDTH:.0f}" '
            f'height="{HEIGHT:.0f}" font-family="sans-serif" font-size="12">',
            f"<title>{escape(name)}</title>",
            f'<rect width="{WIDTH:.0f}" height="{HEIGHT:.0f}" fill="#ffffff"/>',
            f'<polyline points="{line}" fill="none" stroke="#5d6d7e" stroke-width="5" stroke-linejoin="round" '
            'stroke-linecap="round"/>',
        ]
        x0, y0 = self.points[0]
        parts.append(f'<path d="M{_px(x0 - 14)},{_px(y0 + 4)} h28 v5 h-28 z" fill="#85929e"/>')
        for name_, colour, end in self.axes:
            x, y = self.points[-1]
            parts.append(
                f'<path d="M{_px(x)},{_px(y)} L{_px(end[0])},{_px(end[1])}" stroke="{colour}" stroke-width="2"/>'
                f'<text x="{_px(end[0] + 3)}" y="{_px(end[1] + 3)}" fill="{colour}">{name_}</text>'
            )
        for label, turns, (x, y) in self.joints:
            shape = f'<circle cx="{_px(x)}" cy="{_px(y)}" r="5"' if turns else (
                f'<rect x="{_px(x - 5)}" y="{_px(y - 5)}" width="10" height="10"'
            )  # fmt: skip
            parts.append(f'{shape} fill="#ffffff" stroke="#1c2833" stroke-width="2"/>')
            if label:
                parts.append(f'<text x="{_px(x + 9)}" y="{_px(y - 8)}" fill="#1c2833">{label}</text>')
        return ("\n".join([*parts, "</svg>"]) + "\n").encode()

    def tikz(self) -> list[str]:
        """The sketch as lines of a TikZ picture."""
        line = " -- ".join(map(_cm, self.points))
        parts = [r"\begin{tikzpicture}[line join=round, line cap=round]", rf"\draw[line width=2pt, gray] {line};"]
        for name, _, end in self.axes:
            parts.append(rf"\draw[->] {_cm(self.points[-1])} -- {_cm(end)} node[right] {{\footnotesize ${name}$}};")
        for label, turns, at in self.joints:
            shape = "circle (2.5pt)" if turns else "+(-2.5pt,-2.5pt) rectangle +(2.5pt,2.5pt)"
            parts.append(rf"\filldraw[fill=white] {_cm(at)} {shape};")
            if label:
                text = ", ".join(f"q_{{{one[1:]}}}" for one in label.split(", "))
                parts.append(rf"\node[above right] at {_cm(at)} {{\footnotesize ${text}$}};")
        return [*parts, r"\end{tikzpicture}"]


def arm_sketch(robot: Robot) -> ArmSketch:
    """The sketch of a robot."""
    flat = flat_arm(robot) is not None
    q = _drawn_values(robot, flat)
    frames = np.array(joint_frames(robot, q))
    reach = 0.16 * arm_size(robot)
    ends = frames[-1, :3, 3] + reach * frames[-1, :3, :3].T
    view = ABOVE if flat else ISOMETRIC
    solid = np.concatenate([robot.base[None, :3, 3], frames[:, :3, 3], ends])
    drawn = solid @ view.T
    low, high = drawn.min(axis=0), drawn.max(axis=0)
    scale = float(np.min((np.array([WIDTH, HEIGHT]) - 2.0 * EDGE) / np.maximum(high - low, 1e-9)))
    drawn = (drawn - 0.5 * (low + high)) * scale + np.array([WIDTH, HEIGHT]) / 2.0
    points, tips = drawn[:-3], drawn[-3:]
    labels = [f"q{i}" for i in range(1, robot.n + 1)]
    places = points[1:-1]
    for i in range(len(places) - 1, 0, -1):
        if np.hypot(*(places[i] - places[i - 1])) < TOGETHER:
            labels[i - 1], labels[i] = f"{labels[i - 1]}, {labels[i]}", ""
    turning = [bool(turns) for turns in robot.revolute]
    if len(turning) != len(places):  # joints that hang on others are drawn, and have no variable of their own
        labels, turning = [""] * len(places), [True] * len(places)
    shown = tuple(in_units(q, joint_factors(robot, robot.units)).tolist())
    axes = tuple(
        (name, COLOURS[name], tip) for name, tip in zip("xyz", tips, strict=True)
        if np.hypot(*(tip - points[-1])) > TOGETHER
    )  # fmt: skip
    return ArmSketch(points, tuple(zip(labels, turning, places, strict=True)), axes, shown)


def _drawn_values(robot: Robot, flat: bool) -> Array:
    """Joint values (n,) [rad | m]: zero or what is nearest to it in the limits, slides out by a part of the arm."""
    wished = np.where(robot.revolute, BENT if flat else 0.0, 0.3 * arm_size(robot))
    return np.asarray(np.clip(wished, robot.limits[:, 0], robot.limits[:, 1]))


def _px(value: float) -> str:
    return show(round(float(value), 1))


def _cm(point: Array) -> str:
    return f"({show(round(float(point[0]) / PER_CENTIMETRE, 2))},{show(round(-float(point[1]) / PER_CENTIMETRE, 2))})"
