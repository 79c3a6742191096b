"""Moving pictures as .gif files, drawn by Pillow, which matplotlib brings with it.

A film is shots of one scene from one eye, which do not hang on the machine's fonts or clock: the same is drawn to the
same bytes. What a page shows is drawn in the same way: faces from the farthest to the nearest, lines and names on them.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from robokin.arrays import Array
from robokin.pictures.arm_faces import Face, colour, ordered
from robokin.pictures.arm_scene import eye_axes
from robokin.pictures.picture import round_steps
from robokin.pictures.workspace_stills import require_matplotlib
from robokin.units import Units

if TYPE_CHECKING:
    from PIL.Image import Image

WIDTH, HEIGHT, HEAD = 640, 540, 52
"""Pixels of a shot, and of the heading in it."""

FINE = 2
"""Pixels are drawn this many times finer, and mixed."""

RATE, MOST_SHOTS = 15, 75
"""Shots a second, and at most: a film stays below some hundred kilobytes."""

SHORTEST, LONGEST, HELD = 0.4, 10.0, 1000
"""Seconds of a film at least and at most, whatever the motion takes, and milliseconds for which its end is held."""

INK, DIM, GRID, PAPER = "#1c2126", "#5c6670", "#e3e7eb", "#ffffff"
"""Colours of letters, of what is less, of the floor, of the sheet."""

FAINT = 0.6
"""How pale the part of a way is that is still to come."""

COLOURS_OF_ALL = 128
"""Colours of a film: it is smaller than with 256, and looks the same."""

NEARLY_WHITE = 248
"""Parts of red, green and blue from which a colour is taken for the paper's."""

SAMPLES = 6
"""Shots whose colours are looked at."""


@dataclass(frozen=True, eq=False)
class Shot:
    """One picture of a film: faces in any order, fronts that nothing hides, names with their places (3,) [m].

    ways: lines (k, 3) [m] with their colours and the row up to which each has been gone, where a dot stands; lines: the
    same, faint throughout and without a dot.
    """

    faces: Sequence[Face]
    caption: str = ""
    fronts: Sequence[Face] = ()
    names: Sequence[tuple[Array, str]] = ()
    ways: Sequence[tuple[Array, str, int]] = ()
    lines: Sequence[tuple[Array, str]] = ()


@dataclass(frozen=True, eq=False)
class FilmStage:
    """What all shots have in common: title, the box [m] that they take, azimuth and elevation [°] of the eye, units."""

    title: str
    box: tuple[Array, Array]
    view: tuple[float, float]
    units: Units


def film_rows(times: Array, seconds: float, closed: bool = False) -> tuple[list[int], int]:
    """Which rows of a motion a film shows, and for how many milliseconds each.

    times: (m,) of the rows; seconds: how long the motion takes; a closed one does not show its beginning twice.
    """
    seconds = min(max(seconds, SHORTEST), LONGEST)
    count = max(min(round(seconds * RATE) + 1, MOST_SHOTS, len(times)), 1)
    # Even in time: rows may not be.
    wanted = np.linspace(times[0], times[-1], count)
    rows = np.searchsorted(0.5 * (times[1:] + times[:-1]), wanted).tolist()
    # A gif counts hundredths of a second; many programs take less than two for ten.
    pause = max(round(100.0 * seconds / max(count - (not closed), 1)), 2) * 10
    return rows, pause


def film(stage: FilmStage, rows: Sequence[int], pause: int, shot: Callable[[int], Shot], closed: bool = False) -> bytes:
    """The shots of rows as a .gif, which repeats; pause: milliseconds of each. Raises InputError without matplotlib."""
    require_matplotlib(".gif")
    from PIL import Image

    sheet = _Sheet(stage)
    shots = [sheet.drawn(shot(row)) for row in rows]
    # One palette for all: it costs no bytes in each, and nothing flickers.
    few = [shots[i] for i in np.unique(np.linspace(0, len(shots) - 1, SAMPLES).astype(int))]
    montage = Image.new("RGB", (WIDTH, HEIGHT * len(few)))
    for i, picture in enumerate(few):
        montage.paste(picture, (0, HEIGHT * i))
    picked = montage.quantize(COLOURS_OF_ALL - 1, method=Image.Quantize.MEDIANCUT).getpalette()
    found = np.array(picked, dtype=int).reshape(-1, 3)
    palette = Image.new("P", (1, 1))
    # White paper stays white: what is nearly white would be taken for it.
    palette.putpalette([255, 255, 255, *found[found.min(axis=1) < NEARLY_WHITE].ravel().tolist()])
    flat = [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in shots]
    pauses = [pause] * len(flat)
    if not closed:
        pauses[-1] = HELD
    out = io.BytesIO()
    flat[0].save(out, "GIF", save_all=True, append_images=flat[1:], duration=pauses, loop=0, optimize=False)
    return out.getvalue()


class _Sheet:
    """Draws shots: where points of the world are on paper, and what all shots begin with."""

    def __init__(self, stage: FilmStage) -> None:
        import matplotlib as mpl
        from PIL import Image, ImageDraw, ImageFont

        self.stage = stage
        self.eye = eye_axes(stage.view)
        low, high = stage.box
        corners = np.array([[(low, high)[i >> k & 1][k] for k in range(3)] for i in range(8)]) @ self.eye[:2].T
        least, most = corners.min(axis=0), corners.max(axis=0)
        self.middle = 0.5 * (least + most)
        size = np.maximum(most - least, 1e-12)
        self.scale = 0.92 * FINE * min(WIDTH / size[0], (HEIGHT - HEAD) / size[1])
        fonts = Path(mpl.get_data_path()) / "fonts" / "ttf"
        self.title = ImageFont.truetype(str(fonts / "DejaVuSans-Bold.ttf"), 17 * FINE)
        self.small = ImageFont.truetype(str(fonts / "DejaVuSans.ttf"), 12 * FINE)
        self.bold = ImageFont.truetype(str(fonts / "DejaVuSans-Bold.ttf"), 11 * FINE)
        self.ground = Image.new("RGB", (WIDTH * FINE, HEIGHT * FINE), PAPER)
        pen = ImageDraw.Draw(self.ground)
        self._floor(pen)
        pen.text((WIDTH * FINE / 2, 18 * FINE), _fitted(pen, stage.title, self.title), INK, self.title, anchor="mm")

    def at(self, points: Array) -> list[tuple[float, float]]:
        """Where points (k, 3) [m] are on the fine sheet."""
        flat = (points @ self.eye[:2].T - self.middle) * self.scale
        places = np.array([WIDTH / 2, (HEIGHT + HEAD) / 2]) * FINE + flat * [1.0, -1.0]
        return list(map(tuple, places.tolist()))

    def _floor(self, pen: Any) -> None:
        """A grid of round steps where the base stands, or below what hangs far down."""
        (low, high), unit = self.stage.box, self.stage.units
        level = 0.0 if low[2] <= 0.0 <= high[2] and low[2] > -0.3 * (high[2] - low[2]) else low[2]
        steps = round_steps(0.0, float(np.max(high - low)) / unit.metres, 9)
        step = float(steps[-1] - steps[-2]) * unit.metres if len(steps) > 1 else float(np.max(high - low)) or 1.0
        ticks = [np.arange(np.floor(low[k] / step), np.ceil(high[k] / step) + 1.0) * step for k in (0, 1)]
        for k in (0, 1):
            for value in ticks[k]:
                ends = np.full((2, 3), level)
                ends[:, k] = value
                ends[:, 1 - k] = ticks[1 - k][[0, -1]]
                pen.line(self.at(ends), GRID, FINE)
        text = f"grid {step / unit.metres:.6g} {unit.length}"
        pen.text((10 * FINE, (HEIGHT - 10) * FINE), text, DIM, self.small, anchor="ls")

    def drawn(self, shot: Shot) -> Image:
        """A shot, of the film's size."""
        from PIL import ImageDraw

        picture = self.ground.copy()
        pen = ImageDraw.Draw(picture)
        for points, paint_name in shot.lines:
            if len(points) > 1:
                pen.line(self.at(points), _rgb(colour(paint_name, FAINT)), FINE)
        for face in [*ordered(list(shot.faces), self.eye), *ordered(list(shot.fronts), self.eye)]:
            paint = tuple(np.round(face.colour * 255.0).astype(int).tolist())
            pen.polygon(self.at(face.corners), fill=paint, outline=paint)
        for points, paint_name, gone in shot.ways:
            places, strong = self.at(points), _rgb(colour(paint_name))
            if len(places) > 1:
                pen.line(places, _rgb(colour(paint_name, FAINT)), FINE)
            if gone > 0:
                pen.line(places[: gone + 1], strong, 2 * FINE, joint="curve")
            x, y = places[gone]
            pen.ellipse([x - 4 * FINE, y - 4 * FINE, x + 4 * FINE, y + 4 * FINE], fill=strong)
        self._letters(pen, shot.names)
        pen.text((WIDTH * FINE / 2, 40 * FINE), _fitted(pen, shot.caption, self.small), DIM, self.small, anchor="mm")
        return picture.reduce(FINE)

    def _letters(self, pen: Any, names: Sequence[tuple[Array, str]]) -> None:
        from robokin.pictures.arm_stills import spread_labels

        places = [self.at(place[None])[0] for place, _ in names]
        points = [np.array([x, -y]) / FINE for x, y in places]
        asides = spread_labels(points, [text for _, text in names])
        for (x, y), (_, text), (right, up) in zip(places, names, asides, strict=True):
            place = (x + right * FINE, y - (up + 4) * FINE)
            pen.text(place, text, INK, self.bold, anchor="lm" if right > 0 else "rm", stroke_width=FINE,
                     stroke_fill=PAPER)  # fmt: skip


def _rgb(paint: Array) -> tuple[int, ...]:
    return tuple(np.round(paint * 255.0).astype(int).tolist())


def _fitted(pen: Any, text: str, font: Any) -> str:
    """A line that fits the sheet, cut where it does not."""
    if pen.textlength(text, font) <= (WIDTH - 20) * FINE:
        return text
    while text and pen.textlength(text + "…", font) > (WIDTH - 20) * FINE:
        text = text[:-1]
    return text + "…"
