"""Planar mechanisms as still pictures: links, joints, and the paths of points, by matplotlib."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

import numpy as np

from robokin.arrays import Array, Index
from robokin.mobility.gear_wheels import belt_lines, wheels_of
from robokin.mobility.trace import Trace
from robokin.model import Mechanism, MechanismJoint
from robokin.pictures.mechanism_shape import GROUND, LINKS, PATHS
from robokin.pictures.workspace_stills import FREE, RESOLUTION, STYLE, require_matplotlib
from robokin.units import Units

if TYPE_CHECKING:
    from matplotlib.axes import Axes


SIDE = 6.0
"""Inches of the drawing's longer side."""

LEFT, RIGHT, HEAD, FOOT = 0.9, 0.35, 0.95, 0.95
"""Inches about the drawing."""

MARGIN = 0.07
"""Room about what is drawn, as a part of its longer side."""

BLOCK = 0.05
"""Length of a slide's block, as a part of the longer side."""


def mechanism_picture(mechanism: Mechanism, trace: Trace | None, paths: Array | None, units: Units, kind: str) -> bytes:
    """A planar mechanism as assembled, as a file of type `kind`: png, svg or pdf.

    trace: its motion; the ways of its pins are drawn faintly. paths: (m, points, 3) [m] those of points, boldly.
    Raises InputError where matplotlib is missing.
    """
    require_matplotlib(f".{kind}")
    import matplotlib as mpl
    from matplotlib.figure import Figure

    scale = 1.0 / units.metres
    ways = [way * scale for way in _ways(mechanism, trace)]
    bold = [] if paths is None else [paths[:, i, :2] * scale for i in range(paths.shape[1])]
    closed = trace is not None and trace.closed
    low, high = _bounds(mechanism, [*ways, *bold], scale)
    size = np.maximum(high - low, 0.15 * np.max(high - low))
    low, high = 0.5 * (low + high - size), 0.5 * (low + high + size)
    inches = SIDE * size / np.max(size)
    out = io.BytesIO()
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(STYLE)
        width = max(float(inches[0]) + LEFT + RIGHT, 0.13 * len(mechanism.name) + 1.0)
        height = float(inches[1]) + HEAD + FOOT
        figure = Figure(figsize=(width, height))
        place = ((width - inches[0] - RIGHT + LEFT) / 2.0 / width, FOOT / height, inches[0] / width, inches[1] / height)
        axes = figure.add_axes(place)
        axes.set(aspect="equal", xlim=(low[0], high[0]), ylim=(low[1], high[1]),
                 xlabel=f"x [{units.length}]", ylabel=f"y [{units.length}]")  # fmt: skip
        axes.grid(visible=True)
        axes.spines[["top", "right"]].set_visible(False)
        figure.text(0.5, 1.0 - 0.32 / height, mechanism.name, ha="center", va="center", fontsize=14, fontweight="bold")
        for way in ways:
            axes.plot(*_loop(way, closed).T, color=FREE, linewidth=0.8, linestyle=(0, (4, 2.5)), zorder=1)
        _draw(axes, mechanism, scale, float(np.max(size)))
        for i, path in enumerate(bold):
            colour = PATHS[i % len(PATHS)]
            axes.plot(*_loop(path, closed).T, color=colour, linewidth=2.0, zorder=6, label=f"P{i + 1}")
            axes.plot(*path[0], "o", color=colour, markersize=5, zorder=7)
        handles, _ = axes.get_legend_handles_labels()
        if handles:
            axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=min(len(handles), 6), frameon=False,
                        fontsize=8.5, handlelength=1.6, columnspacing=1.3)  # fmt: skip
        metadata = {"png": {"Software": None}, "svg": {"Date": None, "Creator": None}, "pdf": {"CreationDate": None}}
        figure.savefig(out, format=kind, dpi=RESOLUTION, metadata=metadata[kind], facecolor="white",
                       bbox_inches="tight")  # fmt: skip
    return out.getvalue()


def _loop(path: Array, closed: bool) -> Array:
    return np.concatenate([path, path[:1]]) if closed else path


def _pins(mechanism: Mechanism, link: str) -> Array:
    """Where the joints of a link are (k, 2) [m], each place once."""
    points = [
        joint.at[:2]
        for joint in mechanism.joints
        if link in joint.links and joint.at is not None and not joint.gearing and joint.type not in ("gear", "rolling")
    ]
    return np.unique(np.array(points).reshape(-1, 2).round(12), axis=0)


def _ways(mechanism: Mechanism, trace: Trace | None) -> list[Array]:
    """The ways (m, 2) [m] of all pins that move."""
    if trace is None:
        return []
    ways = []
    for joint in mechanism.joints:
        if joint.at is None or mechanism.ground in joint.links or joint.type == "prismatic" or joint.gearing:
            continue
        T = trace.poses[:, trace.links.index(joint.links[0])]
        ways.append(T[:, :2, :3] @ joint.at + T[:, :2, 3])
    return ways


def _bounds(mechanism: Mechanism, curves: list[Array], scale: float) -> tuple[Array, Array]:
    points = [joint.at[None, :2] * scale for joint in mechanism.joints if joint.at is not None]
    for wheel in wheels_of(mechanism):
        points += [(wheel.centre[None, :2] + sign * wheel.radius) * scale for sign in (-1.0, 1.0)]
    everything = np.concatenate([*points, *curves]) if points else np.array([[-1.0, -1.0], [1.0, 1.0]])
    low, high = everything.min(axis=0), everything.max(axis=0)
    room = MARGIN * (float(np.max(high - low)) or 1.0) + BLOCK * (float(np.max(high - low)) or 1.0)
    return low - room, high + room


def _draw(axes: Axes, mechanism: Mechanism, scale: float, size: float) -> None:
    """Links as lines and faces, joints as rings, slides as blocks on their guides."""
    moving = [link for link in mechanism.links if link != mechanism.ground]
    colours = {link: LINKS[i % len(LINKS)] for i, link in enumerate(moving)} | {mechanism.ground: GROUND}
    for link in moving:
        _link(axes, _pins(mechanism, link) * scale, colours[link], link)
    _wheels(axes, mechanism, scale, colours)
    for joint in mechanism.joints:
        if joint.at is None or joint.gearing:
            continue
        place = joint.at[:2] * scale
        if joint.type == "prismatic":
            _slide(axes, mechanism, joint, place, colours, size)
            continue
        contact = joint.type in ("gear", "cam", "rolling")
        if mechanism.ground in joint.links and not contact:
            _support(axes, place, size)
        axes.plot(*place, "D" if contact else "o", markersize=4.5 if contact else 7.0, markerfacecolor="white",
                  markeredgecolor="#222222", markeredgewidth=1.3, zorder=5)  # fmt: skip
        _name(axes, joint.name, place, (5, 5))


def _wheels(axes: Axes, mechanism: Mechanism, scale: float, colours: dict[str, str]) -> None:
    """The wheels of gears and belts as circles, and the straight parts of belts."""
    from matplotlib.colors import to_rgb
    from matplotlib.patches import Circle

    wheels = wheels_of(mechanism)
    for wheel in wheels:
        told = axes.get_legend_handles_labels()[1]
        label = wheel.link if wheel.link not in told and wheel.link != mechanism.ground else None
        face = "none" if wheel.ring else (*to_rgb(colours[wheel.link]), 0.15)
        axes.add_patch(Circle((wheel.centre[0] * scale, wheel.centre[1] * scale), wheel.radius * scale, facecolor=face,
                              edgecolor=colours[wheel.link], linewidth=2.0, zorder=2, label=label))  # fmt: skip
    for joint in mechanism.joints:
        mine = [wheel for wheel in wheels if wheel.joint == joint.name]
        if joint.type == "belt" and mine:
            for line in belt_lines(mine):
                axes.plot(*(line[:, :2] * scale).T, color="#222222", linewidth=1.6, zorder=3)


def _link(axes: Axes, pins: Array, colour: str, name: str) -> None:
    """A line between two pins, a face between more."""
    look: dict[str, Any] = {"color": colour, "linewidth": 3.0, "solid_capstyle": "round", "zorder": 3, "label": name}
    if len(pins) > 2:
        ring = pins[_around(pins)]
        axes.fill(*ring.T, color=colour, alpha=0.22, linewidth=0.0, zorder=2)
        axes.plot(*np.concatenate([ring, ring[:1]]).T, solid_joinstyle="round", **look)
    elif len(pins) == 2:
        axes.plot(*pins.T, **look)


def _around(pins: Array) -> Index:
    """The order in which pins lie about their middle."""
    offset = pins - pins.mean(axis=0)
    return np.argsort(np.arctan2(offset[:, 1], offset[:, 0]), kind="stable")


def _support(axes: Axes, place: Array, size: float) -> None:
    """The ground below a fixed pin: a triangle on a hatched line."""
    from matplotlib.patches import Polygon

    h = 0.022 * size
    corners = place + h * np.array([[0.0, 0.0], [-1.0, -1.7], [1.0, -1.7]])
    axes.add_patch(Polygon(corners, facecolor="#e4e6e8", edgecolor=GROUND, linewidth=1.0, zorder=2))
    x = place[0] + h * np.linspace(-1.4, 1.4, 5)
    y = place[1] - 1.7 * h
    axes.plot(x[[0, -1]], [y, y], color=GROUND, linewidth=1.2, zorder=2)
    for at in x:
        axes.plot([at, at - 0.5 * h], [y, y - 0.6 * h], color=GROUND, linewidth=0.8, zorder=2)


def _slide(
    axes: Axes, mechanism: Mechanism, joint: MechanismJoint, place: Array, colours: dict[str, str], size: float
) -> None:
    """A block that slides on its guide; the guide is the ground's where that is one of the links."""
    from matplotlib.patches import Polygon

    assert joint.axes is not None
    guide = mechanism.ground if mechanism.ground in joint.links else joint.links[0]
    block = next(link for link in joint.links if link != guide)
    along = joint.axes[0, :2] / (np.linalg.norm(joint.axes[0, :2]) or 1.0)
    across = np.array([-along[1], along[0]])
    reach = 4.0 * BLOCK * size
    ends = np.array([place - reach * along, place + reach * along])
    axes.plot(*ends.T, color=colours[guide], linewidth=1.1, linestyle=(0, (7, 2)), zorder=2)
    half = 0.5 * BLOCK * size * np.array([[1, 0.6], [-1, 0.6], [-1, -0.6], [1, -0.6]])
    corners = place + half[:, :1] * along + half[:, 1:] * across
    told = axes.get_legend_handles_labels()[1]
    label = block if block not in told else None
    axes.add_patch(Polygon(corners, facecolor="white", edgecolor=colours[block], linewidth=2.0, zorder=4, label=label))
    _name(axes, joint.name, place, (-4, -14))


def _name(axes: Axes, name: str, place: Array, off: tuple[int, int]) -> None:
    """A joint's name beside it."""
    axes.annotate(name, (place[0], place[1]), xytext=off, textcoords="offset points", fontsize=8.5, zorder=8,
                  color="#222222")  # fmt: skip
