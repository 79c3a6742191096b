"""The size of a set from its membership alone: analytic sets, honest bounds, scaling, one answer on any cores."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from sweeps import sweep

from robokin.workspace.region import Region
from robokin.workspace.size_cells import cells_of, checked, poisson_limit, split_cells
from robokin.workspace.sizes import Measure

Array = NDArray[np.float64]
Oracle = Callable[[Array], NDArray[np.bool_]]

E = np.eye(3)
ORIGIN = np.zeros(3)
LINE = Region("line", np.array([-2.0]), np.array([1.9]), ORIGIN, E[:, :1])
PLANE = Region("plane", np.array([-1.3, -1.2]), np.array([1.2, 1.25]), ORIGIN, E[:, :2])
UNIT = Region("plane", np.zeros(2), np.ones(2), ORIGIN, E[:, :2])
BOX = Region("box", np.full(3, -1.1), np.full(3, 1.1), ORIGIN, E)
DISC = Region("disc", np.zeros(1), np.array([1.7]), ORIGIN, E[:, :1])
SECTION = Region("section", np.array([0.0, -1.1]), np.array([1.15, 1.1]), ORIGIN, E[:, [0, 2]])


def length(p: Array) -> Array:
    return np.asarray(np.linalg.norm(p, axis=1))


def set_measure(inside: Oracle, region: Region, budget: int, seed: int = 0, cores: int | None = 1) -> Measure:
    """The size alone."""
    return cells_of(inside, region, budget, seed, cores)[0]


def ball(p: Array) -> NDArray[np.bool_]:
    return np.asarray(length(p) < 1.0)


def shell(p: Array) -> NDArray[np.bool_]:
    return np.asarray((length(p) < 1.0) & (length(p) > 0.3))


def ring(p: Array) -> NDArray[np.bool_]:
    return np.asarray((length(p) < 1.0) & (np.hypot(p[:, 0], p[:, 1]) > 0.3))


def slabs(p: Array) -> NDArray[np.bool_]:
    """Twenty slabs of a two-hundredth each."""
    return np.asarray((20.0 * p[:, 0]) % 1.0 < 0.1)


def dust(p: Array) -> NDArray[np.bool_]:
    """Features far smaller than the first cells."""
    return np.asarray(((100.0 * p[:, 0]) % 1.0 < 0.1) & (p[:, 1] > 0.8))


def brick(p: Array) -> NDArray[np.bool_]:
    return np.asarray(np.all((p > [-0.31, -0.7, -0.2]) & (p < [0.9, 0.1, 0.77]), axis=1))


SHELL = 4.0 / 3.0 * np.pi * (1.0 - 0.3**3)
# A ball without a cylinder through its middle: 4/3 π (R² - r²)^(3/2), the napkin ring.
RING = 4.0 / 3.0 * np.pi * 0.91**1.5
CASES = {
    "interval": (ball, LINE, 2.0),
    "two intervals": (shell, LINE, 1.4),
    "annulus by its radius": (shell, DISC, np.pi * 0.91),
    "disc": (ball, PLANE, np.pi),
    "annulus": (shell, PLANE, np.pi * 0.91),
    "slabs": (slabs, UNIT, 0.1),
    "dust": (dust, UNIT, 0.02),
    "shell": (shell, BOX, SHELL),
    "brick": (brick, BOX, 1.21 * 0.8 * 0.97),
    "shell by its section": (shell, SECTION, SHELL),
    "ring by its section": (ring, SECTION, RING),
}


@pytest.mark.parametrize("name", sweep(CASES, 4))
def test_the_truth_is_within_the_bound(name: str) -> None:
    inside, region, truth = CASES[name]
    measures = [set_measure(inside, region, 6000, seed) for seed in range(40)]
    honest = [abs(found.value - truth) <= found.error for found in measures]
    assert np.mean(honest) >= 0.95
    assert all(found.evaluations <= 6000 for found in measures)


@pytest.mark.parametrize("name", sweep(["slabs", "dust", "shell"], 3))
def test_there_is_no_bias(name: str) -> None:
    inside, region, truth = CASES[name]
    values = np.array([set_measure(inside, region, 3000, seed).value for seed in range(80)])
    assert abs(np.mean(values) - truth) <= 4.0 * np.std(values) / np.sqrt(len(values))


@pytest.mark.parametrize(("name", "most"), [("disc", 1e-3), ("shell by its section", 1e-3), ("shell", 5e-3)])
def test_the_bound_is_small_at_the_usual_budget(name: str, most: float) -> None:
    inside, region, truth = CASES[name]
    found = set_measure(inside, region, 131072)
    assert abs(found.value - truth) <= found.error <= most * truth


def test_nothing_and_everything() -> None:
    nothing = set_measure(lambda p: np.zeros(len(p), dtype=bool), BOX, 4000)
    assert nothing.value == 0.0
    everything = set_measure(lambda p: np.ones(len(p), dtype=bool), BOX, 4000)
    assert abs(everything.value - 2.2**3) <= everything.error


def test_a_larger_set_is_larger_by_the_power() -> None:
    bigger = replace(PLANE, low=3.0 * PLANE.low, high=3.0 * PLANE.high)
    small, large = set_measure(shell, PLANE, 5000), set_measure(lambda p: shell(p / 3.0), bigger, 5000)
    assert large.value == pytest.approx(9.0 * small.value, rel=1e-12)
    assert large.error == pytest.approx(9.0 * small.error, rel=1e-12)


def test_a_moved_and_turned_set_is_as_large() -> None:
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    moved = replace(SECTION, origin=np.array([5.0, -2.0, 1.0]), directions=turn @ SECTION.directions)
    there = set_measure(lambda p: ring((p - moved.origin) @ turn), moved, 5000)
    here = set_measure(ring, SECTION, 5000)
    assert there.value == pytest.approx(here.value, rel=1e-9)


def test_one_answer_on_any_number_of_cores() -> None:
    assert set_measure(shell, PLANE, 20000, 5, cores=1) == set_measure(shell, PLANE, 20000, 5, cores=2)
    assert set_measure(shell, PLANE, 20000, 5) != set_measure(shell, PLANE, 20000, 6)


def test_cells_fill_the_region_and_show_the_set() -> None:
    found, cells = cells_of(ring, SECTION, 20000)
    sizes = SECTION.sizes(cells.low, cells.high)
    assert np.sum(sizes) == pytest.approx(np.pi * 1.15**2 * 2.2)
    assert float(sizes @ cells.fraction) == pytest.approx(cells.size)
    # The first cells are all alike; of the others the boundary is known to the square of their sides.
    middle = SECTION.points(0.5 * (cells.low + cells.high))[: cells.settled]
    assert np.mean(ring(middle) == (cells.fraction[: cells.settled] == 1.0)) > 0.99
    assert cells.size == pytest.approx(RING, rel=5e-4)
    assert abs(cells.size - RING) < found.error
    assert not np.any(ring(SECTION.points(cells.beyond)))


def test_a_test_corrects_what_another_oracle_thought() -> None:
    def rough(p):
        return length(p) < 1.0  # it does not see the hole

    cells = split_cells(rough, PLANE, 6000, 6000)
    test = checked(shell, cells, 6000)
    assert cells.size == pytest.approx(np.pi, rel=1e-3)
    assert abs(test.measure.value - np.pi * 0.91) <= test.measure.error
    # What it refutes is in the hole, and stands for its size.
    off = np.minimum(length(test.refuted) - 0.3, np.abs(length(test.refuted) - 1.0))
    assert np.all(off <= 1e-3)
    assert np.sum(test.share) == pytest.approx(np.pi * 0.09, rel=0.3)


class Near:
    """A ball that tells how far points are from it, but for those beyond 1.2."""

    least = 64

    def __call__(self, p: Array) -> NDArray[np.bool_]:
        return ball(p)

    def lacks(self, p: Array) -> Array:
        """The way from the ball to points (m, 3)."""
        away = p - p / np.maximum(length(p), 1.0)[:, None]
        away[length(p) <= 1.0] = 0.0
        away[length(p) > 1.2] = np.nan
        return np.asarray(away)


@pytest.mark.parametrize(("region", "truth"), [(PLANE, np.pi), (SECTION, 4.0 / 3.0 * np.pi), (BOX, 4.0 / 3.0 * np.pi)])
def test_distances_tell_crossings(region: Region, truth: float) -> None:
    """As good a boundary as by halving, for fewer points."""
    told, halved = split_cells(Near(), region, 4000, 4000), split_cells(ball, region, 4000, 4000)
    assert told.size == pytest.approx(truth, rel=1e-2 if region is BOX else 1e-3)
    assert abs(told.size - truth) <= 2.0 * abs(halved.size - truth)
    both = [checked(ball, cells, 20000).share.sum() for cells in (told, halved)]
    assert both[0] <= both[1] + 0.01 * truth


@pytest.mark.parametrize("d", [1, 2, 3])
def test_a_boundary_that_is_flat_is_met_exactly(d: int) -> None:
    """Each simplex holds of a half space what it should, and the parts of it that are said to be in it."""
    rng = np.random.default_rng(d)
    region = Region("box" if d == 3 else "plane" if d == 2 else "line", np.zeros(d), np.ones(d), ORIGIN, E[:, :d])
    for _ in range(10):
        normal = rng.normal(size=d)
        offset = float(normal @ rng.uniform(0.3, 0.7, d))

        def inside(p: Array, normal: Array = normal, offset: float = offset) -> NDArray[np.bool_]:
            return np.asarray(p[:, :d] @ normal < offset)

        cells = split_cells(inside, region, 3000, 3000)
        truth = np.mean(rng.random((400_000, d)) @ normal < offset)
        assert cells.size == pytest.approx(truth, abs=0.004)
        assert checked(inside, cells, 4000).share.sum() <= 0.002


def test_the_limit_of_a_poisson_mean() -> None:
    # By definition: so many events or fewer have just that chance. None in 95 % is the rule of three.
    assert poisson_limit(0, 0.05) == pytest.approx(2.9957, rel=1e-4)
    for count, risk in ((0, 0.005), (3, 0.025), (20, 0.005), (400, 0.01)):
        limit = poisson_limit(count, risk)
        logs = np.append(0.0, np.cumsum(np.log(limit / np.arange(1, count + 1))))
        assert np.sum(np.exp(logs - limit)) == pytest.approx(risk)
