"""A small picture of a plane set for a terminal, with its axes."""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array, Flags
from robokin.pictures.picture import round_name, round_steps

MARGIN = 9
"""Characters left of the picture: a number and the axis."""

WIDTH = 78 - MARGIN
"""Characters of the picture's width at most: the page has 80."""

HEIGHT = 22
"""Lines of the picture's height at most, so that it stands on one screen with its table."""

SHADES = " ░▒▓█"
"""From none of the orientations to all of them."""

# Bits of a braille character by row and column of its dots (Unicode 2800).
_BITS = np.array([[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]])


def dot_grid(low: Array, high: Array, dots: tuple[int, int] = (2, 4)) -> tuple[Array, float]:
    """Centres (rows, columns, 2) of the dots that fill the box low, high (2,), the top row first; their distance.

    dots: how many stand beside and above one another in a character; (1, 2) are half characters.
    """
    size = np.maximum(high - low, 1e-3 * np.max(high - low))
    step = float(max(size[0] / (WIDTH * dots[0]), size[1] / (HEIGHT * dots[1])))
    columns, rows = (max(int(np.ceil(size[i] / (step * dots[i]) - 1e-6)), 1) * dots[i] for i in range(2))
    middle = 0.5 * (low + high)
    x = middle[0] + step * (np.arange(columns) - 0.5 * (columns - 1))
    y = middle[1] - step * (np.arange(rows) - 0.5 * (rows - 1))
    return np.stack(np.meshgrid(x, y), axis=-1), step


def braille(mask: Flags) -> list[str]:
    """Lines of characters whose dots are the true ones of mask (rows, columns): four by two a character."""
    rows, columns = mask.shape
    cells = mask.reshape(rows // 4, 4, columns // 2, 2)
    codes = 0x2800 + np.einsum("iajb,ab->ij", cells, _BITS)
    return ["".join(" " if code == 0x2800 else chr(code) for code in line) for line in codes.tolist()]


def shaded(fraction: Array) -> list[str]:
    """Lines of characters as dark as the fraction (rows, columns), NaN where there is nothing.

    Blank only where there is nothing, full only where it is 1.
    """
    steps = len(SHADES) - 1
    level = np.clip(np.ceil(np.nan_to_num(fraction) * (steps - 1)), 1, steps - 1)
    level = np.where(fraction >= 1.0, steps, level)
    level = np.where(np.isnan(fraction), 0, level).astype(int)
    return ["".join(SHADES[k] for k in line) for line in level.tolist()]


def framed(lines: list[str], corner: Array, step: tuple[float, float], labels: tuple[str, str]) -> str:
    """Lines with axes at their left and below.

    corner: (2,) the picture's lower left corner; step: a character's width and height, both in the units that the
    labels name.
    """
    height, width = len(lines), max(map(len, lines))
    top = corner[1] + height * step[1]
    marks = {}
    for value in round_steps(corner[1], top, max(height // 3, 2)).tolist():
        marks[min(max(int((top - value) / step[1]), 0), height - 1)] = round_name(value)
    page = [f"{labels[1]:>{MARGIN}}"]
    for i, line in enumerate(lines):
        edge = "┤" if i in marks else "│"
        page.append(f"{marks.get(i, ''):>{MARGIN - 2}} {edge}{line}".rstrip())
    ruler, names = ["─"] * width, [" "] * (MARGIN + width + MARGIN)
    room = 0
    for value in round_steps(corner[0], corner[0] + width * step[0], max(width // 10, 2)).tolist():
        at = min(max(int((value - corner[0]) / step[0]), 0), width - 1)
        name = round_name(value)
        start = max(MARGIN + at - len(name) // 2, room)
        ruler[at] = "┬"
        names[start : start + len(name)] = name
        room = start + len(name) + 1
    page.append(" " * (MARGIN - 1) + "└" + "".join(ruler))
    below = "".join(names).rstrip()
    space = MARGIN + width - len(labels[0])
    # The name of the axis stands at its end, below where a number would be in its way.
    if space > len(below):
        page.append(below + " " * (space - len(below)) + labels[0])
    else:
        page += [below, " " * max(space, 0) + labels[0]]
    return "\n".join(page) + "\n"
