"""Pictures made of characters."""

from __future__ import annotations

import numpy as np
import pytest

from robokin.pictures.outline import trace
from robokin.pictures.picture import round_steps
from robokin.pictures.plate import filled
from robokin.pictures.text_pictures import HEIGHT, SHADES, braille, dot_grid, framed, shaded


def test_every_dot_has_its_place():
    mask = np.zeros((4, 4), dtype=bool)
    mask[0, 0] = mask[3, 1] = mask[1, 3] = True
    assert braille(mask) == [chr(0x2800 + 0x01 + 0x80) + chr(0x2800 + 0x10)]
    assert braille(np.ones((4, 2), dtype=bool)) == ["⣿"]
    assert braille(np.zeros((4, 2), dtype=bool)) == [" "]


def test_shades_tell_none_and_all_apart():
    fraction = np.array([[np.nan, 0.0, 0.01, 0.5, 0.999, 1.0]])
    (line,) = shaded(fraction)
    assert line[0] == " "
    assert SHADES.index(line[1]) == SHADES.index(line[2]) == 1
    assert line[4] == "▓"
    assert line[5] == "█"


@pytest.mark.parametrize("size", [(1.0, 1.0), (3.0, 0.2), (0.01, 2.0), (5.0, 5.0)])
def test_a_picture_fits_the_page(size):
    low = np.array([-0.3, 7.0])
    grid, step = dot_grid(low, low + size)
    lines = braille(np.ones(grid.shape[:2], dtype=bool))
    page = framed(
        lines, np.array([grid[0, 0, 0], grid[-1, 0, 1]]) - step / 2, (2 * step, 4 * step), ("r [mm]", "z [mm]")
    )
    rows = page.splitlines()
    assert max(map(len, rows)) <= 80
    assert len(rows) <= HEIGHT + 4
    assert rows[0].endswith("z [mm]")
    assert rows[-1].endswith("r [mm]")
    # The dots fill the box, and hardly more.
    assert np.all(grid.reshape(-1, 2).min(axis=0) <= low + step)
    assert np.all(grid.reshape(-1, 2).max(axis=0) >= low + size - step)


def test_numbers_stand_where_they_belong():
    page = framed(["⣿" * 40] * 10, np.array([-2.0, 0.0]), (0.1, 0.1), ("x [m]", "y [m]"))
    rows = page.splitlines()
    ruler, names, label = rows[-3:]
    assert names.split() == ["-2", "0", "2"]
    assert ruler[names.index("0")] == "┬"
    assert label.endswith("x [m]")
    (half,) = (row for row in rows if row.strip().startswith("0.5"))
    assert rows.index(half) == 1 + 5


@pytest.mark.parametrize(("low", "high", "most"), [(-1.0, 1.0, 5), (0.0, 931.2, 4), (-3e-4, 9e-4, 6), (99.0, 101.0, 3)])
def test_steps_are_round_and_within(low, high, most):
    steps = round_steps(low, high, most)
    assert 1 < len(steps) <= most
    assert np.all((steps >= low - 1e-9) & (steps <= high + 1e-9))
    step = steps[1] - steps[0]
    assert np.allclose(np.diff(steps), step)
    assert np.isclose(np.log10(step) % 1.0, [0.0, np.log10(2.0), np.log10(5.0), 1.0], atol=1e-6).any()


def test_an_outline_is_filled_where_the_set_is():
    def inside(p):
        return (np.hypot(*p.T) < 1.0) & (np.hypot(*(p - [0.2, 0.1]).T) > 0.4)

    low, high = np.array([-1.0, -1.0]), np.array([1.0, 1.0])
    grid, _ = dot_grid(low, high)
    mask = filled(trace(inside, low, high), grid)
    assert np.mean(mask == inside(grid.reshape(-1, 2)).reshape(mask.shape)) > 0.999
