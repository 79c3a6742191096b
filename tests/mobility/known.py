"""Mechanisms whose freedom at the pose drawn is known beforehand, each with why.

Every entry is (name, mechanism, branches): the dimensions of the branches through the pose, the greatest first; [0] is
a structure. `ORDERS` has the order of the constraint that forbids a tremble, where it is known too.
"""

from __future__ import annotations

import numpy as np
from mobility.linkages import bennett, chain_of_four_bars, four_bar, generic_loop, linkage, loop

Y, Z = (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


def cranks(places, length=1.0):
    """Equal cranks between the ground and one coupler, all laid on a line: a parallelogram at its change point."""
    joints = []
    for i, x in enumerate(places):
        joints += [("R", ("0", f"c{i}"), (x, 0.0)), ("R", (f"c{i}", "b"), (x + length, 0.0))]
    return linkage(joints)


def watt(point=(0.0, 0.0), slot=Y, x=0.0, mirror=1.0, prefix=""):
    """Watt's four-bar, unit coupler, cranks of 2; its midpoint leaves the line x = 0 as y⁵. With a slot there."""
    a, b, c, d = (prefix + name for name in ("crank", "coupler", "rocker", "slider"))
    places = [(-2.0, 0.5), (0.0, 0.5), (0.0, -0.5), (2.0, -0.5)]
    A, B, C, D = [(x + mirror * px, py) for px, py in places]
    joints = [("R", ("0", a), A), ("R", (a, b), B), ("R", (b, c), C), ("R", (c, "0"), D)]
    if slot is not None:
        P = (x + mirror * point[0], point[1])
        joints += [("R", (b, d), P), ("P", (d, "0"), P, slot)]
    return joints


def double_watt(mirror, distance=5.0):
    """Two of Watt's linkages with a bar between their midpoints, across the lines that these nearly follow.

    With y on one and y + u on the other the bar asks for u² = 2 d (x₂ - x₁), x = ±a y⁵. Mirrored that is a cusp
    u² = c y⁵, which is a motion though every finite order forbids its beginning; not mirrored u = 0 is one, and
    u = -10 d a y⁴ another. R. Connelly, H. Servatius, "Higher-order rigidity: what is the proper definition?", 1994.
    """
    joints = watt(slot=None) + watt(slot=None, x=distance, mirror=mirror, prefix="second ")
    joints += [("R", ("coupler", "bar"), (0.0, 0.0)), ("R", ("bar", "second coupler"), (distance, 0.0))]
    return linkage(joints)


def coupler_series(points, P, order=10):
    """The power series (order + 1,) in a crank's angle of a coupler point P, as complex numbers: independent of the
    package. points: the four hinges."""
    A, B, C, D, P = (complex(*p) for p in (*points, P))

    def times(f, g):
        return np.convolve(f, g)[: order + 1]

    crank = np.array([1j**n for n in range(order + 1)]) / np.cumprod([1.0, *range(1, order + 1)])
    one = np.eye(order + 1)[0].astype(complex)
    # B' = A + (B - A) e^{it}; the coupler turns by c = e^{iψ}: |B' + (C - B) c - D| = |C - D| fixes ψ, order by order.
    moved = (B - A) * crank + A * one
    psi = np.zeros(order + 1)

    def turned(psi):
        result, term = one.copy(), one.copy()
        for n in range(1, order + 1):
            term = times(term, 1j * psi) / n
            result = result + term
        return result

    slope = 2.0 * ((C - D).conjugate() * 1j * (C - B)).real
    for n in range(1, order + 1):
        arm = moved + (C - B) * turned(psi) - D * one
        psi[n] = -times(arm, arm.conj()).real[n] / slope
    return moved + (P - B) * turned(psi)


def leaving(points, P, axis, order=10):
    """The order in which a coupler point leaves the line through it along an axis; None beyond `order`."""
    normal = complex(-axis[1], axis[0]) / np.hypot(*axis[:2])
    series = coupler_series(points, P, order)
    off = (series[1:] * normal.conjugate()).real
    clear = np.nonzero(np.abs(off) > 1e-7)[0]
    return int(clear[0]) + 1 if len(clear) else None


FOUR_BAR = [(0.0, 0.0), (1.0, 1.5), (3.6, 2.6), (4.0, 0.0)]


def inflection_point(points, along):
    """A coupler point on the inflection circle, and its direction (2,): κ = 0 there. along: where on the circle."""
    velocity, acceleration = _turning(points)
    # P' = v + i w (P - B), P'' = a + (i α - w²)(P - B): κ = 0 is Im(conj P' P'') = 0, a circle; on a ray from the pole.
    (v, w), (a, alpha) = velocity, acceleration
    B = complex(*points[1])
    pole = B - v / (1j * w)
    ray = np.exp(1j * along)
    # On the ray P - pole = s e: P' = i w s e; P'' = p0 + (i α - w²) s e with p0 the acceleration of the pole.
    p0 = a + (1j * alpha - w * w) * (pole - B)
    # Im(conj(i w s e) (p0 + (iα - w²) s e)) = 0, s ≠ 0
    slope = (np.conj(1j * w * ray) * (1j * alpha - w * w) * ray).imag
    s = -(np.conj(1j * w * ray) * p0).imag / slope
    P, direction = pole + s * ray, 1j * w * ray
    return (P.real, P.imag), (direction.real, direction.imag)


def _turning(points):
    """The coupler's motion as the crank turns: of B (velocity, turning) and (acceleration, its change)."""
    two = [coupler_series(points, P, 2) for P in (points[1], points[2])]
    arm = complex(*points[2]) - complex(*points[1])
    first = (two[1][1] - two[0][1]) / (1j * arm)
    second = (2.0 * (two[1][2] - two[0][2]) / arm + first.real**2) / 1j
    return (two[0][1], first.real), (2.0 * two[0][2], second.real)


def ball_point(points):
    """The coupler point of an order-4 contact with its tangent: where an inflection is stationary. By bisection."""

    def third(along):
        P, axis = inflection_point(points, along)
        series = coupler_series(points, P, 4)
        return (series[3] * complex(-axis[1], axis[0]).conjugate()).real / np.hypot(*axis) ** 1

    angles = np.linspace(0.05, np.pi - 0.05, 400)
    values = [third(angle) for angle in angles]
    for a, b, fa, fb in zip(angles, angles[1:], values, values[1:], strict=False):
        if fa * fb < 0 and abs(fa) + abs(fb) < 1.0:
            for _ in range(200):
                middle = 0.5 * (a + b)
                a, b, fa = (middle, b, third(middle)) if fa * third(middle) > 0 else (a, middle, fa)
            P, axis = inflection_point(points, 0.5 * (a + b))
            if abs(complex(*P)) < 30.0:
                return P, axis
    raise AssertionError("no Ball point")


def slotted(points, P, axis):
    """A four-bar with a coupler point in a straight slot."""
    A, B, C, D = points
    return linkage([
        ("R", ("0", "crank"), A), ("R", ("crank", "coupler"), B), ("R", ("coupler", "rocker"), C),
        ("R", ("rocker", "0"), D), ("R", ("coupler", "slider"), P), ("P", ("slider", "0"), P, (*axis, 0.0)),
    ])  # fmt: skip


def hexagon(kind, legs=6, shift=(0.0, 0.0, 0.0), radius=2.0, height=2.0):
    """Equal legs between congruent regular polygons. All parallel, the platform swings on a sphere: 2. In the middle it
    can twist and rise, too: another branch of 1. Ball joints below let each leg spin: n more."""
    joints = []
    for i in range(legs):
        angle = 2.0 * np.pi * i / legs
        foot = np.array([radius * np.cos(angle), radius * np.sin(angle), 0.0])
        axes = [(1.0, 0.0, 0.0), Y] if kind == "U" else []
        joints += [(kind, ("0", f"leg {i}"), foot, *axes),
                   ("S", (f"leg {i}", "platform"), foot + np.array([0.0, 0.0, height]) + np.array(shift))]  # fmt: skip
    return linkage(joints, "spatial")


def sarrus(angle, between=np.pi / 2, r=2.0, arm=1.0, legs=2, reach=None):
    """Sarrus's linkage with plates at an angle to the base; at 0 it is folded flat, and its plates can also turn on the
    base's hinges and its platform with them: 2 (both limbs planar and coaxial), beside the rise: 1."""
    joints = []
    c, s = np.cos(angle), np.sin(angle)
    for i in range(legs):
        out = np.array([np.cos(i * between), np.sin(i * between), 0.0])
        axis = np.array([-out[1], out[0], 0.0])
        last = r * out + [0.0, 0.0, 2 * arm * s] if reach is None else reach * out
        joints += [("R", ("0", f"lower {i}"), r * out, axis),
                   ("R", (f"lower {i}", f"upper {i}"), (r + arm * c) * out + [0.0, 0.0, arm * s], axis),
                   ("R", (f"upper {i}", "platform"), last, axis)]  # fmt: skip
    return linkage(joints, "spatial")


def collinear(places, space="planar"):
    """A ring of hinges on a line: bars that are stretched or folded along it."""
    return loop([(np.array([x, 0.0, 0.0]), Z) for x in places], space)


def cascade(stages, locked=True):
    """Slider-cranks at their dead points, each slider driving the next crank across: the last slider moves by the power
    2^stages of the first crank's turn, and the lock at its place forbids that."""
    joints, drive = [], None
    foot, along = np.zeros(2), np.array([1.0, 0.0])
    for k in range(stages):
        crank, rod, slider = f"crank {k}", f"rod {k}", f"slider {k}"
        end = foot + 3.0 * along
        held = locked and k == stages - 1
        joints += [("R", ("0", crank), foot), ("R", (crank, rod), foot + along),
                   ("R", (rod, "0" if held else slider), end)]  # fmt: skip
        if not held:
            joints.append(("P", (slider, "0"), end, (*along, 0.0)))
        if drive is not None:
            joints += [("R", (drive[0], f"bar {k}"), drive[1]), ("R", (f"bar {k}", crank), foot + along)]
        drive, across = (slider, end), np.array([-along[1], along[0]])
        foot, along = end + 1.3 * along - across, across
    return linkage(joints)


def truss(points, bars):
    """Bars between points; the first bar is the ground."""
    at = {}
    for i, (a, b) in enumerate(bars):
        for p in (a, b):
            at.setdefault(p, []).append(str(i))
    joints = []
    for p, links in at.items():
        joints += [("R", (links[0], other), points[p]) for other in links[1:]]
    return linkage(joints)


def on_a_hinge(joints, at=(-3.0, 1.0)):
    """The same on a link that turns on the ground: one freedom more."""
    above = [(letter, tuple("table" if name == "0" else name for name in names), *rest)
             for letter, names, *rest in joints]  # fmt: skip
    return linkage([("R", ("0", "table"), at), *above])


def library_like():
    """All of them."""
    rng = np.random.default_rng(5)
    yield "three cranks", cranks([0, 2, 4]), [1]
    yield "three cranks, other spacing", cranks([0, 1.3, 4.7]), [1]
    yield "four cranks", cranks([0, 1.3, 4.7, 6], 0.8), [1]
    yield "five cranks", cranks([0, 1.3, 4.7, 6, 9.1], 2.3), [1]
    yield "two cranks", cranks([0, 3]), [1, 1]
    yield "rhombus, stretched", four_bar([(0, 0), (1, 0), (2, 0), (1, 0)]), [1, 1]
    yield "rhombus, folded", four_bar([(0, 0), (1, 0), (0, 0), (1, 0)]), [1, 1]
    yield "kite, folded", four_bar([(0, 0), (1, 0), (3, 0), (1, 0)]), [1, 1]
    yield "Watt's point", linkage(watt()), [0]
    yield "Watt's point across", linkage(watt(slot=(1.0, 0.0, 0.0))), [0]
    yield "Watt's point on a hinge", on_a_hinge(watt()), [1]
    yield "double Watt, mirrored", double_watt(-1.0), [1]
    yield "double Watt", double_watt(1.0), [1, 1]
    for i in range(3):
        P, axis = inflection_point(FOUR_BAR, 0.3 + 0.9 * i)
        yield f"inflection point {i}", slotted(FOUR_BAR, P, axis), [0]
    P, axis = ball_point(FOUR_BAR)
    yield "Ball's point", slotted(FOUR_BAR, P, axis), [0]
    yield (
        "no linear algebra",
        slotted(FOUR_BAR, (3.250000000000054, 4.875000000000037), (0.897314507098484, 0.4413917481677749)),
        [0],
    )
    yield "hexagon U-S", hexagon("U"), [2, 1]
    yield "hexagon U-S, aside", hexagon("U", shift=(1.0, 0.0, 0.0)), [2]
    yield "hexagon S-S", hexagon("S"), [8, 7]
    yield "hexagon S-S, aside", hexagon("S", shift=(0.7, 0.4, 0.0)), [8]
    yield "five legs", hexagon("U", legs=5, height=1.3), [2, 1]
    yield "square of legs", hexagon("U", legs=4, radius=1.4, height=1.0), [2, 2, 2]  # g = φ² (a (u² - v²) + b u v)
    yield "Sarrus, folded", sarrus(0.0), [2, 1]
    yield "Sarrus, folded askew", sarrus(0.0, 1.1), [2, 1]
    yield "Sarrus", sarrus(0.8), [1]
    yield "Sarrus, three limbs", sarrus(0.8, 2.0, legs=3), [1]
    yield "Sarrus, stretched", sarrus(0.0, reach=4.0), [0]
    yield "cascade of two", cascade(2), [0]
    yield "cascade of three", cascade(3), [0]
    yield "cascade of four", cascade(4), [0]
    yield "cascade of three, unlocked", cascade(3, locked=False), [1]
    yield "shaky triangle", collinear([0, 1, 2.5]), [0]
    yield "shaky triangle in space", collinear([0, 1, 2.5], "spatial"), [0]
    yield "stretched pentagon", collinear([0, 1, 2, 3, 4.5]), [0]
    yield "pentagon on a line", collinear([0, 1, 2.2, 0.9, 3.0]), [2]
    balls = [("S", "01", (0, 0, 0)), ("S", "12", (1, 0, 0)), ("S", "20", (3, 0, 0))]
    yield "balls on a line", linkage(balls, "spatial"), [2]  # both rods spin, neither moves
    yield "polygon on a line, stretched", collinear([*range(7), 7.5]), [0]
    yield "polygon on a line, folded", collinear([0, 2.1, 0.3, 4.0, 1.7, 5.2, 3.3, 2.6]), [5]
    yield "two flat parallelograms, one on the other", linkage(
        [("R", (a, b), p) for base, top, x in (("0", "b", 0.0), ("b", "d", 5.0))
         for a, b, p in ((base, base + "l", (x, 0.0)), (base + "l", top, (x + 1.0, 0.0)),
                         (top, base + "r", (x + 4.0, 0.0)), (base + "r", base, (x + 3.0, 0.0)))]
    ), [2, 2, 2, 2]  # fmt: skip
    yield "Bennett", bennett(), [1]
    yield "generic ring of six", generic_loop(6, 3), [0]
    yield "generic ring of seven", generic_loop(7, 3), [1]
    yield "chain of four-bars", chain_of_four_bars(4), [4]
    shaken = rng.uniform(-1, 1, 4)
    yield "a four-bar anywhere", four_bar([(0, 0), (1 + 0.1 * shaken[0], 1.5), (3, 2 + 0.1 * shaken[1]), (4, 0)]), [1]


ORDERS = {
    "Watt's point": 5, "Watt's point on a hinge": 5, "Ball's point": 4, "shaky triangle": 2, "Sarrus, stretched": 2,
    "shaky triangle in space": 2, "inflection point 0": 3, "inflection point 1": 3, "inflection point 2": 3,
    "balls on a line": 2, "cascade of two": 4, "cascade of three": 8, "polygon on a line, stretched": 2,
}  # fmt: skip
