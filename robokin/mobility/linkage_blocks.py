"""A linkage taken apart: blocks that do not bind each other, and links that spin on their own.

Blocks. Two joints are of one block if some loop goes through both (the biconnected components of the graph of bodies
and joints); rows that couple joints of two blocks make one of them. No block's constraints touch another's joints, so
configurations are any combination of those of the blocks, and dimensions add. A block without a loop is a joint on its
own. Each block is measured in its own size: a small mechanism far from a large one is as exact as alone.

Own spins. A link between two joints of a block can move by itself in every motion that both joints allow, such as a rod
between two ball joints about its line. In the link's own frame these are the same at all configurations, so they are
freedoms of their own: held in the chart, and added afterwards.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array, Index
from robokin.brief import Brief
from robokin.mobility.chart import Chart, ChartEdge
from robokin.mobility.linkage import Linkage, LinkageState
from robokin.mobility.screws import Element
from robokin.model.topology import components
from robokin.spatial import transform
from robokin.spatial.twists import moved_screws

SPIN = 1e-9
"""Sine of the angle between the motions of two joints below which they are one motion."""

ONE_POINT = 1e-10
"""A block's joints [the linkage's size] that are not farther apart are in one point, and pitches that are not greater
are none: rounding 1e5 sizes away from the world's origin."""


@dataclass(frozen=True, eq=False)
class Spin:
    """A motion (6,) of one body at the reference, in the linkage's units, and the two elements that allow it."""

    body: int
    elements: tuple[int, int]
    screw: Array


@dataclass(frozen=True, eq=False, repr=False)
class Block(Brief):
    """A part of a linkage: its elements, their freedoms (f',), the spins that are held, and coordinates for the rest.

    bases: for each element the matrix (m, f) that takes its coordinates in the chart to its freedoms; middle (3,) and
    size: the block's units in the linkage's; whole: the chart in which no spin is held.
    """

    elements: tuple[int, ...]
    freedoms: Index
    spins: tuple[Spin, ...]
    chart: Chart
    bases: tuple[Array, ...]
    middle: Array
    size: float
    whole: Chart


def blocks_of(linkage: Linkage) -> list[Block]:
    """The blocks of a linkage, in the order of their first joints."""
    groups = components([(e.a, e.b) for e in linkage.elements])
    groups = _joined(groups, linkage)
    return [_block(linkage, tuple(sorted(group))) for group in sorted(groups, key=min)]


def spread_of(points: Array, otherwise: float, least: float = 0.0) -> float:
    """The size of what lies at points (n, 3): their greatest distance from their middle; where they are one point (not
    farther apart than `least`), the other length, or 1."""
    if len(points):
        spread = float(np.max(np.linalg.norm(points - points.mean(axis=0), axis=1)))
        # The mean of equal points is off by rounding: that is no size.
        if spread > max(1e-12 * float(np.max(np.abs(points))), least):
            return spread
    return otherwise or 1.0


def _joined(groups: list[set[int]], linkage: Linkage) -> list[set[int]]:
    """Groups of elements, those that a row couples as one."""
    for row in linkage.rows:
        coupled = {int(j) for j in linkage.joint[row != 0.0]}
        touched = [group for group in groups if group & coupled]
        groups = [group for group in groups if group not in touched]
        if touched:
            groups.append(set().union(*touched))
    return groups


def _block(linkage: Linkage, numbers: tuple[int, ...]) -> Block:
    elements = [linkage.elements[j] for j in numbers]
    freedoms = np.concatenate([np.nonzero(linkage.joint == j)[0] for j in numbers]).astype(np.intp)
    rows = linkage.rows[np.any(linkage.rows[:, freedoms] != 0.0, axis=1)][:, freedoms]
    points = np.array([e.at for e in elements if e.at is not None]).reshape(-1, 3)
    middle = points.mean(axis=0) if len(points) else np.zeros(3)
    # Along its axis a unit turn of a screw slides by the pitch.
    pitch = max((abs(float(screw[:3] @ screw[3:])) for e in elements for screw in e.screws), default=0.0)
    size = spread_of(points, pitch if pitch > ONE_POINT else 0.0, ONE_POINT)
    first = np.cumsum([0, *(len(e.screws) for e in elements)])
    spins, held = _spins(linkage, numbers, rows, first) if len(numbers) > 1 else ([], {})
    touched = {body for e in elements for body in (e.a, e.b)}
    roots = tuple(body for body in linkage.bodies if body in touched)
    # Where spins are held, each screw left is a combination of the element's.
    bases = tuple(held.get(number, np.eye(len(e.screws))) for number, e in zip(numbers, elements, strict=True))
    edges, bases = _edges(elements, bases, middle, size)
    columns = [rows[:, first[k] : first[k + 1]] @ basis.T for k, basis in enumerate(bases)]
    chart = Chart(edges, np.concatenate(columns, axis=1) if columns else rows, roots)
    whole = chart
    if spins:
        everything = tuple(np.eye(len(e.screws)) for e in elements)
        edges, scaled = _edges(elements, everything, middle, size)
        coupled = [rows[:, first[k] : first[k + 1]] @ basis.T for k, basis in enumerate(scaled)]
        whole = Chart(edges, np.concatenate(coupled, axis=1), roots)
    return Block(numbers, freedoms, tuple(spins), chart, bases, middle, size, whole)


def chart_of(elements: list[Element], block: Block) -> Chart:
    """The chart of a block whose elements have other screws than its own."""
    return Chart(
        _edges(elements, block.bases, block.middle, block.size)[0],
        block.chart.rows,
        block.chart.roots,
        block.chart.planar,
    )


def _edges(
    elements: list[Element], bases: tuple[Array, ...], middle: Array, size: float
) -> tuple[list[ChartEdge], tuple[Array, ...]]:
    """The elements in a block's units, their screws those of bases (m, f) of their freedoms; and the bases that lead to
    screws of unit length."""
    edges, scaled = [], []
    for element, basis in zip(elements, bases, strict=True):
        screws = _in_units(basis @ element.screws, middle, size)
        turns, slides = np.linalg.norm(screws[:, 3:], axis=1), np.linalg.norm(screws[:, :3], axis=1)
        lengths = np.where(turns > 1e-9, turns, slides)[:, None]
        edges.append(ChartEdge(element.a, element.b, screws / lengths))
        scaled.append(basis / lengths)
    return edges, tuple(scaled)


def _in_units(screws: Array, middle: Array, size: float) -> Array:
    """Twists (n, 6) about the linkage's origin in its units as those about a block's middle in its size."""
    v = screws[:, :3] + np.cross(screws[:, 3:], middle)
    return np.concatenate([v / size, screws[:, 3:]], axis=1)


def _spins(
    linkage: Linkage, numbers: tuple[int, ...], rows: Array, first: Index
) -> tuple[list[Spin], dict[int, Array]]:
    """The motions of single links that two joints allow, and for the elements in which they are held a basis (m, f) of
    the other motions, in the element's freedoms."""
    at: dict[int, list[int]] = {}
    for k, number in enumerate(numbers):
        for body in (linkage.elements[number].a, linkage.elements[number].b):
            at.setdefault(body, []).append(k)
    spins: list[Spin] = []
    bases: dict[int, Array] = {}
    held = np.zeros((0, int(first[-1])))
    for body, pair in at.items():
        if len(pair) != 2:
            continue
        one, two = (linkage.elements[numbers[k]] for k in pair)
        if not len(one.screws) or not len(two.screws):
            continue
        for mine, others in _shared(one.screws, two.screws):
            speeds = np.zeros(int(first[-1]))
            # The body alone moves by ξ: the joint that leads to it by ξ, the one that leads away by -ξ.
            speeds[first[pair[0]] : first[pair[0] + 1]] = mine if one.b == body else -mine
            speeds[first[pair[1]] : first[pair[1] + 1]] = others if two.b == body else -others
            if np.any(np.abs(rows @ speeds) > SPIN):
                continue
            if len(held) and np.linalg.norm(speeds - held.T @ np.linalg.lstsq(held.T, speeds, rcond=None)[0]) < 1e-6:
                continue
            for k, element, part in ((pair[0], one, mine), (pair[1], two, others)):
                if numbers[k] not in bases:
                    bases[numbers[k]] = _others(element.screws, part)
                    spins.append(Spin(body, (numbers[pair[0]], numbers[pair[1]]), part @ element.screws))
                    held = np.concatenate([held, speeds[None]])
                    break
    return spins, bases


def _shared(one: Array, two: Array) -> list[tuple[Array, Array]]:
    """The motion that two joints' screws (m, 6), (n, 6) have in common, in coordinates of each: none, or one."""
    Q, P = np.linalg.qr(one.T)[0], np.linalg.qr(two.T)[0]
    U, cosines, _ = np.linalg.svd(Q.T @ P)
    common = int(np.sum(1.0 - cosines < 0.5 * SPIN))
    # Where there are more, links have no size: what is left is the chart's.
    if common != 1:
        return []
    screw = Q @ U[:, 0]
    parts = [np.linalg.lstsq(screws.T, screw, rcond=None)[0] for screws in (one, two)]
    if any(np.linalg.norm(part @ screws - screw) > SPIN for part, screws in zip(parts, (one, two), strict=True)):
        return []
    return [(parts[0], parts[1])]


def _others(screws: Array, held: Array) -> Array:
    """A basis (f - 1, f) of the motions of an element beside one, in its freedoms."""
    along = np.abs(held) > (1.0 - 1e-12) * np.linalg.norm(held)
    return np.eye(len(held))[~along] if np.any(along) else np.linalg.svd(held[None])[2][1:]


def state_of(linkage: Linkage, parts: list[tuple[Block, Array]]) -> LinkageState:
    """Where a linkage is with each block at coordinates q (n,) of its chart."""
    joints = linkage.reference.joints.copy()
    values = np.zeros(linkage.freedoms)
    for block, q in parts:
        for k, number in enumerate(block.elements):
            h, _ = block.chart.joint(k, q)
            R, t = h[:3, :3], h[:3, 3]
            joints[number] = transform(R, block.middle - R @ block.middle + block.size * t)
            own = slice(block.chart.first[k], block.chart.first[k + 1])
            values[linkage.joint == number] = q[own] @ block.bases[k]
    return linkage.placed(joints, values)


def speeds_of(linkage: Linkage, state: LinkageState, block: Block, q: Array, tangent: Array) -> Array:
    """The joints' speeds (f, d + spins) in motions tangent (n, d) of a block at q, the spins held in the chart last."""
    T = np.zeros((linkage.freedoms, tangent.shape[1] + len(block.spins)))
    for k, number in enumerate(block.elements):
        own = slice(block.chart.first[k], block.chart.first[k + 1])
        _, twists = block.chart.joint(k, q)
        w = twists[:, 3:]
        seen = np.concatenate([block.size * twists[:, :3] - np.cross(w, block.middle), w], axis=1).T @ tangent[own]
        T[linkage.joint == number, : tangent.shape[1]] = np.linalg.lstsq(
            linkage.elements[number].screws.T, seen, rcond=None
        )[0]
    for column, spin in enumerate(block.spins, start=tangent.shape[1]):
        for number in spin.elements:
            element, h = linkage.elements[number], state.joints[number]
            seen = moved_screws(h[None], spin.screw[None])[0] if element.b == spin.body else -spin.screw
            T[linkage.joint == number, column] = np.linalg.lstsq(element.screws.T, seen, rcond=None)[0]
    return T
