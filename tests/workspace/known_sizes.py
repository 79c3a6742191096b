"""Random arms whose sets have a size that is known otherwise than by what is tested.

Planar arms of two links by what each radius (or line) is covered by, solids by a formula or by the integral of Pappus'
theorem over such a plane set. Everything here is elementary geometry: see each family.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from robokin.model import Joint, JointType, Robot
from robokin.spatial import rotation_transform, translation_transform

TURN = 2.0 * np.pi
HALF = 0.5 * np.pi
FREE = (-np.inf, np.inf)


@dataclass(frozen=True, eq=False)
class Known:
    """An arm, the size [m^d] of its reachable set, and how far that may be off by, as a part of it."""

    robot: Robot
    size: float
    part: float = 1e-11


NODES, WEIGHTS = np.polynomial.legendre.leggauss(12)
ENDS = np.array([-1.0, 1.0]) * (1.0 - 1e-7)
TO_ENDS = np.polynomial.legendre.legvander(ENDS, 11) @ np.linalg.inv(np.polynomial.legendre.legvander(NODES, 11))


def quad(f, edges, part=1e-14, depth=48):
    """∫ f: (m,) -> (m,) between edges by Gauss's rule in halves, until these and the whole agree; and the polynomial
    and the function at their ends, where a kink would hide from the nodes."""
    a = np.concatenate([np.linspace(x, y, 33)[:-1] for x, y in pairwise(edges)])
    b = np.concatenate([np.linspace(x, y, 33)[1:] for x, y in pairwise(edges)])

    def rule(a, b):
        x = 0.5 * (a + b)[:, None] + 0.5 * (b - a)[:, None] * np.concatenate([NODES, ENDS])
        values = f(x.ravel()).reshape(x.shape)
        off = np.max(np.abs(values[:, :12] @ TO_ENDS.T - values[:, 12:]), axis=1)
        return 0.5 * (b - a) * (values[:, :12] @ WEIGHTS), 0.01 * (b - a) * off

    total, (coarse, _) = 0.0, rule(a, b)
    whole = max(abs(float(np.sum(coarse))), 1e-300)
    for _ in range(depth):
        m = 0.5 * (a + b)
        (left, off_left), (right, off_right) = rule(a, m), rule(m, b)
        bad = np.abs(left + right - coarse) + off_left + off_right > part * whole
        total += float(np.sum((left + right)[~bad]))
        if not bad.any():
            return total
        a, b = np.concatenate([a[bad], m[bad]]), np.concatenate([m[bad], b[bad]])
        coarse = np.concatenate([left[bad], right[bad]])
    return total + float(np.sum(coarse))


def overlap(shift, width):
    """The common part of two arcs of a circle, one `shift` ahead of the other, both `width` long."""
    if width >= TURN * (1.0 - 1e-12):
        return np.full_like(shift, TURN)
    ahead = np.mod(shift, TURN)
    return np.maximum(width - ahead, 0.0) + np.maximum(width + ahead - TURN, 0.0)


def within(value, limits):
    """Whether angles are within limits, up to whole turns."""
    if not np.isfinite(limits).all() or limits[1] - limits[0] >= TURN * (1.0 - 1e-12):
        return np.ones(np.shape(value), dtype=bool)
    return limits[0] + np.mod(value - limits[0], TURN) <= limits[1]


def stroke(limits):
    """How far a joint turns."""
    return min(limits[1] - limits[0], TURN)


def area_2r(l1, l2, first, second):
    """∫ r dr times what of each circle the elbow up and the elbow down reach; r dr = l1 l2 sin e de."""
    width = stroke(first)

    def f(e):
        up, down = within(e, second), within(-e, second)
        beta = np.arctan2(l2 * np.sin(e), l1 + l2 * np.cos(e))
        both = np.where(up & down, overlap(2.0 * beta, width), 0.0)
        return l1 * l2 * np.sin(e) * (width * (up + 0.0 + down) - both)

    return quad(f, elbow_edges(second))


def elbow_edges(second):
    """Elbow angles in [0, π] at which the elbow up or down comes to a limit."""
    ends = [end for end in second if np.isfinite(end)]
    inner = [abs((end + np.pi) % TURN - np.pi) for end in ends]
    return np.array(sorted({0.0, np.pi, *inner}))


def area_rp(first, slide, offset):
    """A line at a distance from a centre turns: each radius has two places on the line."""
    width = stroke(first)

    def f(s):
        # s: the distance along the line from the foot of the perpendicular, on either side.
        up, down = (s >= slide[0]) & (s <= slide[1]), (-s >= slide[0]) & (-s <= slide[1])
        beta = np.arctan2(s, offset) if offset else np.full_like(s, HALF)
        both = np.where(up & down, overlap(2.0 * beta, width), 0.0)
        return s * (width * (up + 0.0 + down) - both)

    return quad(f, np.array(sorted({0.0, *np.abs(slide)})))


def area_pr(length, slide, second):
    """A circle moves along the line x: at each height two places of it."""
    width = slide[1] - slide[0]

    def f(t):
        # y = length sin t; the two places are t and π - t, 2 length cos t apart.
        right, left = within(t, second), within(np.pi - t, second)
        both = np.where(right & left, np.maximum(width - 2.0 * length * np.cos(t), 0.0), 0.0)
        return length * np.cos(t) * (width * (right + 0.0 + left) - both)

    ends = [end for end in second if np.isfinite(end)]
    inner = [np.arcsin(np.clip(np.sin(end), -1.0, 1.0)) for end in ends]
    return quad(f, np.array(sorted({-HALF, HALF, *inner})))


def volume_waist(l1, l2, first, second, third):
    """Two links in a plane through the axis about which it turns by `first`: Pappus' theorem for what each radius from
    the shoulder reaches of its circle, in front of the axis and behind it."""
    width = stroke(first)
    twice = min(2.0 * width, TURN)

    def ring(e):
        beta = np.arctan2(l2 * np.sin(e), l1 + l2 * np.cos(e))
        arcs = [(second[0] + sign * beta, stroke(second)) for sign in (1.0, -1.0) if within(sign * e, third)]
        if not arcs:
            return 0.0
        if any(size >= TURN * (1.0 - 1e-12) for _, size in arcs):
            return 2.0 * twice
        # Behind the axis the same as in front of it at the angle π - φ.
        cuts = {0.5 * np.pi, -0.5 * np.pi}
        for low, size in arcs:
            for end in (low, low + size):
                cuts |= {wrap(end), wrap(np.pi - end)}
        cuts = np.array(sorted(cut for cut in cuts if -HALF <= cut <= HALF))
        middle = 0.5 * (cuts[1:] + cuts[:-1])
        ahead = any_of(middle, arcs)
        behind = any_of(np.pi - middle, arcs)
        reached = np.where(ahead & behind, twice, np.where(ahead | behind, width, 0.0))
        return float(np.sum(reached * (np.sin(cuts[1:]) - np.sin(cuts[:-1]))))

    def f(e):
        r = np.sqrt(l1 * l1 + l2 * l2 + 2.0 * l1 * l2 * np.cos(e))
        return r * l1 * l2 * np.sin(e) * np.array([ring(float(one)) for one in e])

    return quad(f, elbow_edges(third), part=1e-11, depth=24)


def wrap(angle):
    return (angle + np.pi) % TURN - np.pi


def any_of(angles, arcs):
    return np.any([np.mod(angles - low, TURN) <= size for low, size in arcs], axis=0)


# Arms ------------------------------------------------------------------------------------------------------


def revolute(limits, **cells):
    return Joint("r", JointType.REVOLUTE, limits=limits, **cells)


def slide(limits, **cells):
    return Joint("p", JointType.PRISMATIC, limits=limits, **cells)


def turn_limits(rng):
    """Limits of a joint that turns: none, a narrow range, or any."""
    kind = rng.random()
    if kind < 0.2:
        return FREE
    width = rng.uniform(0.02, 0.3) if kind < 0.35 else rng.uniform(0.1, 6.2)
    low = rng.uniform(-np.pi, np.pi)
    if kind > 0.85:
        low = -0.5 * width
    return (low, low + width)


def slide_limits(rng):
    low = rng.uniform(-1.0, 1.0)
    if rng.random() < 0.2:
        low = 0.0
    return (low, low + rng.uniform(0.02, 1.5))


def placed(robot, rng, scale):
    """The arm in any place and direction, and to a scale."""
    rows = tuple(
        replace(
            row, a=scale * row.a, d=scale * row.d,
            limits=row.limits if row.type is JointType.REVOLUTE else tuple(scale * end for end in row.limits),
            offset=row.offset * (1.0 if row.type is JointType.REVOLUTE else scale),
        )
        for row in robot.rows
    )  # fmt: skip
    base = translation_transform(scale * rng.uniform(-1, 1, 3)) @ rotation_transform(
        rng.normal(size=3), rng.uniform(0, 3)
    )
    return replace(robot, rows=rows, base=base)


def arm(*rows):
    return Robot("arm", tuple(replace(row, name=str(i + 1)) for i, row in enumerate(rows)))


def links(rng):
    l1 = rng.uniform(0.1, 1.0)
    l2 = l1 if rng.random() < 0.15 else l1 * 10 ** rng.uniform(-1.0, 1.0)
    return l1, min(l2, 2.0)


def planar_2r(rng):
    l1, l2 = links(rng)
    first, second = turn_limits(rng), turn_limits(rng)
    return arm(revolute(first, a=l1), revolute(second, a=l2)), area_2r(l1, l2, first, second)


def planar_rp(rng):
    first, along = turn_limits(rng), slide_limits(rng)
    offset = 0.0 if rng.random() < 0.3 else rng.uniform(0.0, 0.6)
    return arm(revolute(first, a=offset, alpha=HALF), slide(along)), area_rp(first, along, offset)


def planar_pr(rng):
    along, second = slide_limits(rng), turn_limits(rng)
    length = rng.uniform(0.05, 1.0)
    turns = second if second == FREE else (HALF - second[1], HALF - second[0])
    return arm(slide(along, alpha=HALF), revolute(turns, a=length)), area_pr(length, along, second)


def planar_pp(rng):
    one, two = slide_limits(rng), slide_limits(rng)
    angle = rng.uniform(0.3, np.pi - 0.3)
    size = (one[1] - one[0]) * (two[1] - two[0]) * np.sin(angle)
    return arm(slide(one, alpha=angle), slide(two)), size


def torus(rng):
    """A circle beside an axis, in a plane that holds it: Pappus' theorem; the tube never meets itself."""
    first, second = turn_limits(rng), turn_limits(rng)
    r = rng.uniform(0.05, 0.5)
    R = r + rng.uniform(0.05, 1.0)
    low, high = (-np.pi, np.pi) if second == FREE else second
    high = min(high, low + TURN)
    size = stroke(first) * r * (R * (high - low) + r * (np.sin(high) - np.sin(low)))
    return arm(revolute(first, a=R, alpha=HALF), revolute(second, a=r)), size


def sphere(rng):
    """A circle about a point of the axis, in a plane through it: front and back may fall together."""
    first, second = turn_limits(rng), turn_limits(rng)
    r, width = rng.uniform(0.05, 1.0), stroke(first)

    def f(t):
        # Height r sin t; the places t and π - t are half a turn of the first joint apart.
        right, left = within(t, second), within(np.pi - t, second)
        both = np.where(right & left, overlap(np.full_like(t, np.pi), width), 0.0)
        return r * r * np.cos(t) * (width * (right + 0.0 + left) - both)

    ends = [np.arcsin(np.clip(np.sin(end), -1.0, 1.0)) for end in second if np.isfinite(end)]
    size = quad(f, np.array(sorted({-HALF, HALF, *ends})))
    return arm(revolute(first, alpha=HALF), revolute(second, a=r)), size


def with_a_slide(flat):
    """A plane set times a slide across it, before or behind."""

    def family(rng):
        robot, size = flat(rng)
        along, rows = slide_limits(rng), robot.rows
        turns = rows[0].type is JointType.REVOLUTE
        if turns and rng.random() < 0.5:
            rows = (*rows, slide(along))
        else:
            rows = (slide(along, alpha=0.0 if turns else HALF), *rows)
        return arm(*rows), size * (along[1] - along[0])

    return family


def waist(rng):
    l1, l2 = links(rng)
    first, second, third = (turn_limits(rng) for _ in range(3))
    offset = rng.uniform(-0.5, 0.5) if first == FREE and rng.random() < 0.5 else 0.0
    robot = arm(revolute(first, alpha=HALF, d=offset), revolute(second, a=l1, d=offset), revolute(third, a=l2))
    return robot, volume_waist(l1, l2, first, second, third)


def spherical(rng):
    """A ray of any elevation turns about the upright axis: V = D1 (sin b - sin a) (ρ2³ - ρ1³) / 3."""
    first = turn_limits(rng)
    low, high = np.sort(rng.uniform(-HALF, HALF, 2))
    along = np.sort(rng.uniform(0.0, 1.0, 2))
    size = stroke(first) * (np.sin(high) - np.sin(low)) * (along[1] ** 3 - along[0] ** 3) / 3.0
    return arm(revolute(first, alpha=HALF), revolute((low + HALF, high + HALF), alpha=HALF), slide(tuple(along))), size


def cylinder(rng):
    """A slide along the axis, and one aside that never comes back to it."""
    first, up, out = turn_limits(rng), slide_limits(rng), np.sort(rng.uniform(0.0, 1.0, 2))
    size = 0.5 * stroke(first) * (out[1] ** 2 - out[0] ** 2) * (up[1] - up[0])
    return arm(revolute(first), slide(up, alpha=HALF), slide(tuple(out))), size


def arc(rng):
    first, r = turn_limits(rng), rng.uniform(0.05, 1.0)
    return arm(revolute(first, a=r, d=rng.uniform(-1, 1))), r * stroke(first)


def general_arm(number):
    """Three joints in any directions, whose set has no size that is known otherwise."""
    rng = np.random.default_rng([3, number])
    rows = []
    for _ in range(3):
        low, cells = rng.uniform(-2, 0), {"a": rng.uniform(0.1, 1.0), "alpha": rng.uniform(-3, 3)}
        if rng.random() < 0.3:
            rows.append(slide((low, low + rng.uniform(0.1, 1.0)), theta=1.0, **cells))
        else:
            rows.append(revolute((low, low + rng.uniform(0.3, 6.0)), d=rng.uniform(-0.3, 0.3), **cells))
    return arm(*rows)


def annulus(rng):
    """Three or four links without limits reach a ring, or a disc."""
    lengths = rng.uniform(0.05, 1.0, rng.integers(3, 5))
    most, least = float(np.sum(lengths)), max(0.0, float(2.0 * np.max(lengths) - np.sum(lengths)))
    return arm(*(revolute(FREE, a=float(one)) for one in lengths)), np.pi * (most**2 - least**2)


def two_slides(rng):
    """Two slides along one line that turns about an axis that it meets: as one of both strokes."""
    first, out, more = turn_limits(rng), np.sort(rng.uniform(0.0, 1.0, 2)), rng.uniform(0.05, 0.5)
    size = 0.5 * stroke(first) * ((out[1] + more) ** 2 - out[0] ** 2)
    return arm(revolute(first, alpha=HALF), slide(tuple(out)), slide((0.0, more))), size


FAMILIES = {
    "arc": (1, arc),
    "planar 2R": (2, planar_2r),
    "planar RP": (2, planar_rp),
    "planar PR": (2, planar_pr),
    "planar PP": (2, planar_pp),
    "torus": (2, torus),
    "sphere": (2, sphere),
    "2R and a slide": (3, with_a_slide(planar_2r)),
    "PR and a slide": (3, with_a_slide(planar_pr)),
    "waist and 2R": (3, waist),
    "spherical RRP": (3, spherical),
    "cylindrical RPP": (3, cylinder),
    "planar 3R, 4R": (2, annulus),
    "planar RPP": (2, two_slides),
}
"""Families by name: the dimension of their sets, and what makes an arm of a generator: the arm and its size."""

SCALES = (1e-3, 1.0, 1e3)


def known_arm(family: str, number: int, seed: int = 2026) -> Known:
    """An arm of a family."""
    dimension, make = FAMILIES[family]
    rng = np.random.default_rng([seed, list(FAMILIES).index(family), number])
    robot, size = make(rng)
    scale = SCALES[number % len(SCALES)]
    return Known(placed(robot, rng, scale), size * scale**dimension)
