"""Arms with joints to spare, made up from a seed, samples of their joint boxes, and sizes that are known otherwise.

What is drawn is meant to be difficult: joints that make whole turns, limits a sliver or nothing apart, parallel and
crossing axes, sliding joints, arms of a millimetre and of a kilometre; and of the samples some at the faces of the
joint box, some at its corners, some at round values.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from robokin.model import Joint, JointType, Robot
from robokin.workspace.space import Space

Array = NDArray[np.float64]
REST = (-np.inf, np.inf)
FAMILIES = ("3R in a plane", "PRR", "waist and 3R", "4R", "5 joints", "6 joints", "7 joints", "waist held")


def drawn_arm(seed: int) -> Robot:
    """An arm of a family, 3 to 7 joints, with limits; the family follows from the seed."""
    rng = np.random.default_rng((seed, 0xA2))
    family = FAMILIES[seed % len(FAMILIES)]
    scale = 10.0 ** rng.integers(-3, 4) if rng.random() < 0.3 else 1.0
    if family == "3R in a plane":
        rows = [turning(rng, a) for a in lengths(rng, 3)]
    elif family == "PRR":
        rows = [sliding(rng, alpha=np.pi / 2), *(turning(rng, a) for a in lengths(rng, 2))]
    elif family in ("waist and 3R", "waist held"):
        offset = rng.choice([0.0, rng.uniform(-0.3, 0.3)])
        waist = turning(rng, offset, alpha=np.pi / 2, d=rng.uniform(0.0, 0.5))
        if family == "waist held":
            value = rng.uniform(-2.0, 2.0)
            waist = replace(waist, limits=(value, value + rng.choice([0.0, 1e-10, 1e-7])))
        rows = [waist, *(turning(rng, a) for a in lengths(rng, 3))]
    else:
        count = 4 if family == "4R" else int(family[0])
        rows = [_any_row(rng, a, family == "4R") for a in lengths(rng, count)]
    rows = [_scaled(row, scale) for row in rows]
    named = [replace(row, name=f"{i + 1}") for i, row in enumerate(rows)]
    return Robot(f"{family} {seed}", tuple(named), id=f"drawn-{seed}")


def lengths(rng: np.random.Generator, count: int) -> Array:
    """Links from a fifth to one."""
    return np.asarray(rng.uniform(0.2, 1.0, count))


def turning(rng: np.random.Generator, a: float, alpha: float = 0.0, d: float = 0.0) -> Joint:
    """A revolute row with limits of any kind."""
    return Joint("", JointType.REVOLUTE, a=float(a), alpha=alpha, d=d, limits=_limits(rng, np.pi))


def sliding(rng: np.random.Generator, a: float = 0.0, alpha: float = 0.0) -> Joint:
    """A prismatic row with limits of any kind."""
    low, high = _limits(rng, 1.0)
    if np.isinf(low):
        low, high = 0.0, rng.uniform(0.3, 1.5)
    return Joint("", JointType.PRISMATIC, a=float(a), alpha=alpha, limits=(low, high))


def _limits(rng: np.random.Generator, half: float) -> tuple[float, float]:
    kind = rng.random()
    if kind < 0.15:
        return REST
    middle = rng.uniform(-half, half)
    if kind < 0.19:
        return middle, middle
    width = rng.uniform(0.3, 1.8 * half) if kind > 0.27 else 10.0 ** rng.uniform(-6.0, -1.0)
    if kind > 0.8:
        # Round ones, as people write them.
        step = np.pi / 12 if half > 1.0 else 0.1
        return float(np.round((middle - width / 2) / step) * step), float(np.ceil((middle + width / 2) / step) * step)
    return float(middle - width / 2), float(middle + width / 2)


def _any_row(rng: np.random.Generator, a: float, turns: bool) -> Joint:
    alpha = rng.choice([0.0, np.pi / 2, -np.pi / 2, rng.uniform(-np.pi, np.pi)])
    a, d = a * (rng.random() < 0.7), rng.uniform(-0.6, 0.6) * (rng.random() < 0.5)
    if not turns and rng.random() < 0.18:
        return sliding(rng, a, float(alpha))
    return turning(rng, float(a), float(alpha), float(d))


def _scaled(row: Joint, scale: float) -> Joint:
    limits = row.limits if row.type is JointType.REVOLUTE else (row.limits[0] * scale, row.limits[1] * scale)
    return replace(row, a=row.a * scale, d=row.d * scale, limits=limits)


def sampled(space: Space, kind: str, count: int, rng: np.random.Generator) -> Array:
    """Joint values (n, count) [rad | m] in the box of a space: "uniform", at its "edges" or "corners", "round" ones."""
    low, high = space.low[:, None], space.high[:, None]
    u = rng.random((len(low), count))
    if kind == "edges":
        # Three in eight of the joints stand at a limit.
        u = np.clip(1.6 * u - 0.3, 0.0, 1.0)
    elif kind == "corners":
        u = np.round(u)
    q = low + (high - low) * u
    if kind == "round":
        step = np.where(space.robot.revolute, np.pi / 36.0, 0.02 * space.size)[:, None]
        q = np.clip(np.round(q / step) * step, low, high)
    return np.asarray(q)


KINDS = ("uniform", "edges", "corners", "round")
