"""Whether a mechanism would move, or move more, if its dimensions were exact: as far as their digits explain it.

Statement. Some singular values of a block's equations are small, though not zero. Let the numbers of its joints be off
by what their last digits leave open. Are there changes within that for which those singular values are zero and the
block moves in their directions, too, and not only to first order?

With the small ones taken for zero the constraints are reduced to a kernel larger by them, g(x) = 0. In an exact
mechanism g vanishes all about; here it leaves g(x_i) at some points of great radius. A number p off by δ changes that
by

    ∂g/∂p δ = (U0ᵀ - C A⁻¹ U1ᵀ) ∂F/∂p δ,    A = U1ᵀ J V1, C = U0ᵀ J V1,

so the least δ, in units of what the digits leave open, with g(x_i) + Σ_p ∂g(x_i)/∂p δ_p = 0 for all points at once is a
linear problem. Where it has a solution, and none of the changes is greater than its unit, the digits explain it.

Degenerate. A structure that is nearly shaky, such as a flat triangle, is not explained: its constraints are curved, and
no small change of a number takes that away. Numbers that nobody wrote (a mechanism made by a program) count as written
if they are short, as in 0.25, and else may be off by `NEARLY` of the size.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from robokin.kernel.ranks import LOOP_RANK
from robokin.mobility.assembly import Assembly
from robokin.mobility.chart import Chart
from robokin.mobility.linkage_blocks import Block, chart_of
from robokin.mobility.reduced import Reduced, directions
from robokin.mobility.screws import Element, elements_of
from robokin.mobility.true_mobility import BlockMobility
from robokin.model import MechanismJoint, Rounding

NEARLY = 4e-3
"""Singular values below this part of the greatest, but not zero, may be those of a geometry that is wrong by about as
much. Those of mechanisms with good transmission are greater than 7e-3."""

APART = 30.0
"""Singular values of a geometry that is not quite exact stand apart from the others by more than this factor."""

MOST_POINTS = 40
"""Points at which it is looked: of a large kernel, a part of the directions."""

WRITTEN = 6
"""Digits up to which a number that nobody wrote is taken for one that somebody chose: 0.25, but not 0.7071067811865."""

ROUNDED = 3
"""Digits that such a number must have to be taken for a rounded one."""

EXPLAINED = 0.1
"""The part of what the constraints leave that may be left with the changes made: they are taken to first order."""

LOOKED_AT = (0.4, 0.3, 0.2, 0.1)
"""Radii [rad | size] of the points."""


def nearly_more(assembly: Assembly, part: BlockMobility) -> int:
    """How many more motions a block would have if its dimensions were exact: 0 where their digits do not explain it."""
    chart = part.block.chart
    if part.undecided is not None or not np.any((part.values > LOOP_RANK) & (part.values < NEARLY)):
        return 0
    values = Reduced(chart, np.zeros(chart.n), cut=LOOP_RANK).values
    regular, few = values[values >= NEARLY], values[(values > LOOP_RANK) & (values < NEARLY)]
    small = len(few)
    if not small or (len(regular) and regular[-1] < APART * few[0]):
        return 0  # a long chain has small ones of all sizes
    reduced = Reduced(chart, np.zeros(chart.n), kernel=part.kernel - len(part.block.spins) + small)
    d = directions(reduced.k)
    d = d[:: max(1, len(d) * len(LOOKED_AT) // MOST_POINTS)]
    found = reduced.at(np.concatenate([radius * d for radius in LOOKED_AT]))
    if not np.any(found.solved):
        return 0
    q = reduced.q(found.x, found.y)[found.solved]
    g = found.g[found.solved]
    changes = [change for change in _changes(assembly, part.block) if change is not None]
    if not changes:
        return 0
    F, J = chart.both(q)
    JV1 = J @ reduced.V1
    # A constraint's change with y solved anew: (U0ᵀ - C A⁻¹ U1ᵀ) ∂F/∂p.
    back = np.linalg.lstsq
    W = np.array([
        reduced.U0.T - (back((reduced.U1.T @ M).T, (reduced.U0.T @ M).T, rcond=None)[0].T @ reduced.U1.T) for M in JV1
    ])  # fmt: skip
    D = np.stack([np.einsum("ncm,nm->nc", W, other.lack(q) - F).ravel() for other in changes], axis=1)
    greatest = float(np.max(np.abs(g)))
    # Of all changes that leave no more than that, about the least.
    weight = (0.3 * EXPLAINED * greatest) ** 2
    least = -np.linalg.solve(D.T @ D + weight * np.eye(D.shape[1]), D.T @ g.ravel())
    left = float(np.max(np.abs(g.ravel() + D @ least)))
    return small if left < EXPLAINED * greatest and float(np.max(np.abs(least))) <= 1.0 else 0


def _changes(assembly: Assembly, block: Block) -> list[Chart | None]:
    """The block's chart with each of its numbers off by what its digits leave open."""
    names = {assembly.linkage.elements[number].name for number in block.elements}
    charts: list[Chart | None] = []
    for joint in assembly.mechanism.joints:
        if joint.name not in names:
            continue
        rounding = joint.rounding or _assumed(joint, assembly.size * block.size)
        for changed in _off(joint, rounding):
            charts.append(_with(assembly, block, changed))
    return charts


def _off(joint: MechanismJoint, rounding: Rounding) -> list[MechanismJoint]:
    """The joint with one number off, for each that may be."""
    found = []
    if joint.at is not None:
        found += [replace(joint, at=joint.at + off) for off in np.diag(rounding.at) if np.any(off)]
    if joint.axes is not None and joint.type not in ("gear", "cam", "rolling"):
        for i, j in zip(*np.nonzero(rounding.axes), strict=True):
            axes = joint.axes.copy()
            axes[i, j] += rounding.axes[i, j]
            axes[i] /= np.linalg.norm(axes[i])
            found.append(replace(joint, axes=axes))
    if rounding.pitch:
        found.append(replace(joint, pitch=joint.pitch + rounding.pitch))
    return found


def _with(assembly: Assembly, block: Block, joint: MechanismJoint) -> Chart | None:
    """The block's chart with another joint in the place of that of its name."""
    parts = elements_of(joint, assembly.middle, assembly.size)
    elements: list[Element] = []
    count = 0
    for number in block.elements:
        element = assembly.linkage.elements[number]
        if element.name == joint.name:
            element = replace(element, screws=parts[count % len(parts)][0])
            count += 1
        elements.append(element)
    return chart_of(elements, block)


def _assumed(joint: MechanismJoint, size: float) -> Rounding:
    """How far the numbers of a joint that nobody wrote may be off."""
    at = np.zeros(3) if joint.at is None else np.array([_unit(x, size) for x in joint.at])
    axes = np.zeros((0, 3)) if joint.axes is None else np.array([[_unit(x, 1.0) for x in axis] for axis in joint.axes])
    turn = 2.0 * math.pi
    return Rounding(at, axes, _unit(turn * joint.pitch, size * turn) / turn if joint.pitch else 0.0)


def _unit(number: float, size: float) -> float:
    """The unit in the last place of the shortest text of a number, or what one that was calculated may be off."""
    mantissa, _, exponent = f"{number:.11e}".partition("e")
    digits = mantissa.lstrip("-").replace(".", "").rstrip("0")
    if len(digits) < ROUNDED:
        return 0.0
    if len(digits) > WRITTEN:
        return NEARLY * size
    return float(10.0 ** (int(exponent) - len(digits) + 1))
