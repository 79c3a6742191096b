"""Still pictures by matplotlib: .png, .svg, .pdf."""

from __future__ import annotations

import io
from contextlib import contextmanager
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.pictures.picture import Cloud, OrientationDegrees, Panel, Picture

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.path import Path


KINDS = ("png", "svg", "pdf")

RESOLUTION = 160
"""Dots an inch of a .png, and of the clouds inside a .svg or .pdf."""

SIDE = 5.2
"""Inches of a panel's longer side."""

LEFT, RIGHT, BAR, HEAD, FOOT = 0.95, 0.3, 1.25, 1.1, 1.15
"""Inches left and right of a panel, for a colour bar, for the heading, for the axis and the legend below."""

MARGIN = 0.04
"""Room about a set, as a part of its longer side."""

FILL, EDGE, FREE, ARM = "#cfe2f1", "#1b4b72", "#8a8f94", "#c8551b"
"""Colours of the set, its boundary, the boundary without limits, the arm."""

SKIN = ("#55799a", "#93b8d8", "#cfe2f1")
"""Colours of a solid from its lowest to its highest place: those of a page's surface in the shade and in the light."""

MAP = "viridis"
"""Colours of a fraction: even to the eye, and in grey and to the colour-blind."""

STYLE: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 10.0,
    "axes.edgecolor": "#666666",
    "axes.linewidth": 0.8,
    "axes.labelcolor": "#222222",
    "axes.axisbelow": True,
    "grid.color": "#e6e8ea",
    "grid.linewidth": 0.7,
    "xtick.color": "#444444",
    "ytick.color": "#444444",
    "svg.hashsalt": "robokin",
    "svg.fonttype": "none",
}
"""Matplotlib's settings, whatever the user's own are; the salt keeps the names inside an .svg the same."""


def require_matplotlib(ending: str) -> None:
    """Raise InputError, which says how to get it, where matplotlib is missing.

    The advice holds however robokin was installed: from an index, a checkout or a wheel.
    """
    if find_spec("matplotlib") is None:
        raise InputError(
            f"a {ending} is drawn by matplotlib, which is not installed: `pip install matplotlib` where robokin is "
            "installed (with pipx `pipx inject robokin matplotlib`), or take an .html, which needs nothing more"
        )


def still(picture: Picture, kind: str) -> bytes:
    """The picture as a file of one of KINDS. Raises InputError where matplotlib is missing."""
    with drawing(kind) as figure:
        _draw(figure, picture)
        return written(figure, kind)


@contextmanager
def drawing(kind: str) -> Iterator[Figure]:
    """An empty figure in the house's style, whatever the user's own is. Raises InputError without matplotlib."""
    require_matplotlib(f".{kind}")
    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(STYLE)
        yield Figure()


def written(figure: Figure, kind: str, *, tight: bool = False) -> bytes:
    """A figure as a file of one of KINDS, with no date and no version: the same picture is the same file.

    `tight` leaves out what is empty at its edges.
    """
    out = io.BytesIO()
    metadata = {"png": {"Software": None}, "svg": {"Date": None, "Creator": None}, "pdf": {"CreationDate": None}}
    edges: dict[str, Any] = {"bbox_inches": "tight", "pad_inches": 0.2} if tight else {}
    # Polygons of different lengths are padded by matplotlib with memory that nobody has written to.
    with np.errstate(over="ignore", invalid="ignore"):
        figure.savefig(out, format=kind, dpi=RESOLUTION, metadata=metadata[kind], facecolor="white", **edges)
    return out.getvalue()


def _draw(figure: Figure, picture: Picture) -> None:
    """All panels beside one another and to one scale, the cloud at their right, a heading above them."""
    # One colour bar serves all panels: they mean the same.
    last = next((panel for panel in reversed(picture.panels) if panel.degrees is not None), None)
    sizes = [high - low for low, high in (panel.bounds() for panel in picture.panels)]
    longest = max((float(np.max(size)) for size in sizes), default=1.0)
    # What is thin gets some room, though not to scale with its length.
    inches = [np.maximum(SIDE * (1.0 + 2.0 * MARGIN) * size / longest, SIDE / 6.0) for size in sizes]
    widths = [LEFT + size[0] + (BAR if panel is last else RIGHT)
              for size, panel in zip(inches, picture.panels, strict=True)]  # fmt: skip
    tall = max((float(size[1]) for size in inches), default=SIDE)
    if picture.cloud is not None:
        tall = max(tall, 0.8 * SIDE)
        widths.append(tall * 1.12 + 0.35 + (BAR if picture.cloud.meaning else 0.0))
    # Room for the heading, however narrow what is below it.
    width = max(float(sum(widths)), 0.085 * max(len(picture.title) * 1.5, len(picture.subtitle)) + 0.6)
    height = HEAD + tall + FOOT
    figure.set_size_inches(width, height)
    figure.text(0.5, 1.0 - 0.28 / height, picture.title, ha="center", va="center", fontsize=15, fontweight="bold",
                color="#111111")  # fmt: skip
    figure.text(0.5, 1.0 - 0.58 / height, picture.subtitle, ha="center", va="center", fontsize=10.5, color="#444444")
    scale, unit = 1.0 / picture.units.metres, picture.units.length
    left = 0.5 * (width - float(sum(widths)))
    for panel, size, taken in zip(picture.panels, inches, widths, strict=False):
        bottom = FOOT + 0.5 * (tall - size[1])
        place = (left + LEFT, bottom, *size)
        axes = figure.add_axes(_share(place, width, height))
        _panel(axes, size, panel, scale, unit)
        if panel.degrees is not None:
            drawn = _degrees(axes, panel, panel.degrees, scale)
            if panel is last:
                bar = (left + LEFT + size[0] + 0.18, bottom + 0.06 * size[1], 0.16, 0.88 * size[1])
                _bar(figure, drawn, _share(bar, width, height), panel.degrees.meaning)
        left += taken
    if picture.cloud is not None:
        place = (left, FOOT - 0.1, tall * 1.12, tall)
        axes = figure.add_axes(_share(place, width, height), projection="3d", computed_zorder=False)
        drawn = _cloud(axes, picture.cloud, scale, unit)
        if picture.cloud.meaning:
            bar = (left + tall * 1.12 + 0.3, FOOT + 0.15 * tall, 0.16, 0.6 * tall)
            _bar(figure, drawn, _share(bar, width, height), picture.cloud.meaning)


def _share(inches: tuple[float, ...], width: float, height: float) -> tuple[float, float, float, float]:
    """A rectangle (left, bottom, width, height) in parts of the figure."""
    return inches[0] / width, inches[1] / height, inches[2] / width, inches[3] / height


def _bar(figure: Figure, drawn: Any, place: tuple[float, float, float, float], meaning: str) -> None:
    bar = figure.colorbar(drawn, cax=figure.add_axes(place))
    bar.set_label(meaning)
    bar.outline.set_linewidth(0.6)


def _panel(axes: Axes, inches: Array, panel: Panel, scale: float, unit: str) -> None:
    low, high = panel.bounds()
    margin = MARGIN * float(np.max(high - low))
    axes.set(
        aspect="equal",
        anchor="C",
        title=panel.title,
        xlabel=f"{panel.labels[0]} [{unit}]",
        ylabel=f"{panel.labels[1]} [{unit}]",
        xlim=((low[0] - margin) * scale, (high[0] + margin) * scale),
        ylim=((low[1] - margin) * scale, (high[1] + margin) * scale),
    )
    axes.title.set(fontsize=11, color="#222222")
    axes.grid(visible=True)
    axes.spines[["top", "right"]].set_visible(False)
    if panel.free is not None and panel.free.loops:
        _outline(axes, panel.free.loops, scale, facecolor="none", edgecolor=FREE, linestyle=(0, (5, 3)),
                 linewidth=0.9, label="without joint limits")  # fmt: skip
    shaded = panel.degrees is not None
    if panel.outline.loops:
        _outline(axes, panel.outline.loops, scale, facecolor="none" if shaded else FILL, edgecolor="none",
                 label=None if shaded else "reachable")  # fmt: skip
        for i, line in enumerate(panel.edges()):
            axes.plot(*(line * scale).T, color=EDGE, linewidth=1.5, solid_joinstyle="round", zorder=2,
                      label=None if i else "boundary")  # fmt: skip
    if panel.radial:
        axes.axvline(0.0, color=FREE, linewidth=0.8, linestyle=(0, (9, 3, 1.5, 3)), zorder=1)
    name = f"the arm at {panel.pose}" if panel.pose else "the arm"
    for i, arm in enumerate(panel.arms):
        line = arm * scale
        axes.plot(line[:, 0], line[:, 1], color=ARM, linewidth=2.6, solid_capstyle="round", solid_joinstyle="round",
                  label=None if i else name, zorder=4)  # fmt: skip
        axes.plot(line[:-1, 0], line[:-1, 1], "o", markersize=5.5, markerfacecolor="white", markeredgecolor=ARM,
                  markeredgewidth=1.6, zorder=5)  # fmt: skip
    wide = inches[0] > 3.6
    if panel.free is not None or panel.arms:
        below = -0.62 / inches[1]
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, below), ncols=3 if wide else 1, frameon=False,
                    fontsize=8.5, handlelength=1.8, columnspacing=1.4, borderpad=0.0)  # fmt: skip


def _path(loops: Sequence[Array], scale: float) -> Path:
    """The curves as one path: what runs clockwise within another is a hole."""
    from matplotlib.path import Path

    closed = [np.concatenate([loop, loop[:1]]) * scale for loop in loops]
    codes = [code for loop in closed for code in [Path.MOVETO, *[Path.LINETO] * (len(loop) - 2), Path.CLOSEPOLY]]
    return Path(np.concatenate(closed), codes)


def _outline(axes: Axes, loops: Sequence[Array], scale: float, **look: Any) -> None:
    from matplotlib.patches import PathPatch

    axes.add_patch(PathPatch(_path(loops, scale), **look))


def _degrees(axes: Axes, panel: Panel, degrees: OrientationDegrees, scale: float) -> Any:
    """Squares as bright as the fraction, cut off at the set's boundary."""
    from matplotlib.collections import PolyCollection
    from matplotlib.patches import PathPatch

    # Squares slightly too large leave no light seams between them.
    corner = 0.502 * degrees.cell * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    squares = (degrees.points[:, None] + corner) * scale
    drawn = PolyCollection(list(squares), cmap=MAP, linewidths=0.0, antialiased=False, rasterized=True)
    drawn.set_array(degrees.fraction)
    drawn.set_clim(0.0, 1.0)
    axes.add_collection(drawn)
    if panel.outline.loops:
        clip = PathPatch(_path(panel.outline.loops, scale), facecolor="none", edgecolor="none")
        axes.add_patch(clip)
        drawn.set_clip_path(clip)
    return drawn


def _cloud(axes: Any, cloud: Cloud, scale: float, unit: str) -> Any:
    from matplotlib.colors import LinearSegmentedColormap
    from matplotlib.ticker import MaxNLocator

    points = cloud.points * scale
    colours = MAP if cloud.meaning else LinearSegmentedColormap.from_list("skin", SKIN)
    drawn = axes.scatter(*points.T, c=cloud.values, cmap=colours, s=4.0, linewidths=0.0,
                         alpha=0.9, depthshade=False, rasterized=True, zorder=1)  # fmt: skip
    for arm in cloud.arms:
        axes.plot(*(arm * scale).T, color=ARM, linewidth=2.6, marker="o", markersize=4.5, markerfacecolor="white",
                  markeredgecolor=ARM, solid_capstyle="round", zorder=3)  # fmt: skip
    low, high = points.min(axis=0), points.max(axis=0)
    for arm in cloud.arms:
        low, high = np.minimum(low, arm.min(axis=0) * scale), np.maximum(high, arm.max(axis=0) * scale)
    # A point stands in the middle of a unit's cube.
    size = np.maximum(high - low, 0.05 * np.max(high - low) or 1.0)
    middle = 0.5 * (low + high)
    axes.set(
        xlim=(middle[0] - size[0] / 2, middle[0] + size[0] / 2),
        ylim=(middle[1] - size[1] / 2, middle[1] + size[1] / 2),
        zlim=(middle[2] - size[2] / 2, middle[2] + size[2] / 2),
        xlabel=f"x [{unit}]", ylabel=f"y [{unit}]", zlabel=f"z [{unit}]",
    )  # fmt: skip
    axes.set_box_aspect(size, zoom=0.92)
    axes.view_init(elev=22.0, azim=-58.0)
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.set_pane_color((0.97, 0.975, 0.98, 1.0))
        # The ends of the two axes in front meet: one of them goes without its number.
        axis.set_major_locator(MaxNLocator(nbins=5, steps=[1, 2, 5, 10], prune="upper" if axis is axes.xaxis else None))
    axes.tick_params(labelsize=8, pad=1)
    return drawn
