"""More mechanisms of the kinds of `known` and `literature`, with numbers that are worked out or drawn here.

Every entry is (name, mechanism, branches, order), as in `literature`: the dimensions of the branches through the pose,
[0] a structure, and the order of the constraint that forbids a tremble, where there is one. Sources:

[Bu] L. Burmester, "Die Brennpunktmechanismen", Z. Math. Phys. 38, 1893: a focus of a conic that touches the four sides
     of a four-bar can be joined to a point of each.
[BR] O. Bottema, B. Roth, Theoretical Kinematics, 1979, chapter 8: a point joined to the centre of its path's curvature
     leaves the circle in order 3, on the cubic of stationary curvature in order 4.
[CS] R. Connelly, H. Servatius, "Higher-order rigidity: what is the proper definition?", 1994 (a cusp).
[De] E. Delassus, "Les chaînes articulées fermées et déformables à quatre membres", Bull. Sci. Math. 46, 1922 (screws).
[Ro] S. Roberts, "On three-bar motion in plane space", Proc. London Math. Soc. 7, 1875: the cognates.
[Br], [Di] as in `literature`.

A linkage of which bodies are hinged in a ring at lines S_i moves to second order along q with Σ q_i S_i = 0 where
Σ_{i<j} q_i q_j [S_i, S_j] is among the combinations of the S_i: of lines in a linear complex one quadratic form of q
must vanish, of lines in two of them two.
"""

from __future__ import annotations

from itertools import pairwise, product

import numpy as np
from mobility.known import FOUR_BAR, Y, ball_point, coupler_series, inflection_point, truss
from mobility.linkages import Z, linkage, loop, unit
from mobility.literature import hexapod, panels

from robokin.model import Mechanism, MechanismJoint

PI = np.pi
WATT = [(-2.0, 0.5), (0.0, 0.5), (0.0, -0.5), (2.0, -0.5)]


# Four-bars with something more in the plane.


def focal(turns, side=1.0, wrong=0.0):
    """Burmester's focal mechanism about an ellipse with the half axes 5 and 3, whose tangents at four angles are the
    sides, and one focus or the other; `wrong`: how far the first bar's pin is from where it must be, in its sides."""
    F, ends = np.array([4.0 * side, 0.0]), zip((turns[3] - 2 * PI, *turns), turns, strict=False)
    corners = [np.array([5 * np.cos((s + t) / 2), 3 * np.sin((s + t) / 2)]) / np.cos((s - t) / 2) for s, t in ends]

    def pins(A, B, C, D):
        """On AB and CD at parts s and 1 - s, where F is seen from both under one angle against them."""
        along, heights, ways = [], [], []
        for P, Q in ((A, B), (C, D)):
            u = unit(Q - P)
            along.append((F - P) @ u)
            heights.append(u[0] * (F - P)[1] - u[1] * (F - P)[0])
            ways.append(np.linalg.norm(Q - P))
        s = along[0] / heights[0] - (along[1] - ways[1]) / heights[1]
        s /= ways[0] / heights[0] + ways[1] / heights[1]
        return A + (s + wrong) * (B - A), C + (1 - s) * (D - C)

    A, B, C, D = corners
    (K, M), (L, N) = pins(A, B, C, D), pins(B, C, D, A)
    sides = [("R", (str(i), str((i + 1) % 4)), p) for i, p in enumerate((B, C, D, A))]
    bars = [("R", (str(i), f"bar {i}"), p) for i, p in enumerate((K, L, M, N))]
    return linkage([*sides, *bars, ("R", tuple(f"bar {i}" for i in range(4)), F)])


def cognates(points, P, count=3):
    """Two or three four-bars whose couplers draw one curve, pinned together where they draw it [Ro]."""
    A, B, C, D, P = (complex(*p) for p in (*points, P))
    ratio = (P - B) / (C - B)
    third, left, right = A + ratio * (D - A), A + P - B, D + P - C
    rings = [(A, B, C, D), (A, left, left + ratio * (P - left), third),
             (D, right, right + (1 - ratio) * (P - right), third)]  # fmt: skip
    joints = [("R", tuple(f"coupler {k}" for k in range(count)), (P.real, P.imag))]
    for k, ring in enumerate(rings[:count]):
        names = ["0", f"left {k}", f"coupler {k}", f"right {k}", "0"]
        joints += [("R", pair, (p.real, p.imag)) for pair, p in zip(pairwise(names), ring, strict=True)]
    return linkage(joints)


def with_more(points, *more):
    """A four-bar with more joints."""
    names = ["0", "crank", "coupler", "rocker", "0"]
    return linkage([("R", names[i : i + 2], p) for i, p in enumerate(points)] + list(more))


def joined(points, P, centre):
    """A four-bar with a bar from a coupler point to the ground."""
    return with_more(points, ("R", ("coupler", "bar"), P), ("R", ("bar", "0"), centre))


def across(points, P, axis, side, length=2.0):
    """A bar square to the way of a coupler point to a slider that goes along it: u² = 2 length × what the point leaves
    its tangent by, to the bar's side, u being the slider's lead."""
    axis = unit(axis[:2])
    Q = np.array(P) + side * length * np.array([-axis[1], axis[0]])
    slider = ("P", ("slider", "0"), Q, (*axis, 0.0))
    return with_more(points, ("R", ("coupler", "bar"), P), ("R", ("bar", "slider"), Q), slider)


def centre_of_curvature(points, P):
    """(2,) that of a coupler point's path."""
    series = coupler_series(points, P, 2)
    v, a = series[1], 2.0 * series[2]
    centre = complex(*P) + 1j * v * abs(v) ** 2 / (v.conjugate() * a).imag
    return centre.real, centre.imag


def circle_series(points, P, centre, order):
    """(order + 1,) the power series of the squared distance of a coupler point from a centre."""
    arm = coupler_series(points, P, order) - complex(*centre) * np.eye(order + 1)[0]
    return np.convolve(arm, arm.conj())[: order + 1].real


def stationary(points, along):
    """A coupler point on a ray from the crank's end, of an angle, where its path's curvature is stationary."""
    ray = np.array([np.cos(along), np.sin(along)])

    def third(s):
        P = np.array(points[1]) + s * ray
        return circle_series(points, P, centre_of_curvature(points, P), 3)[3]

    places = np.linspace(0.2, 4.0, 300)
    values = [third(s) for s in places]
    for a, b, fa, fb in zip(places, places[1:], values, values[1:], strict=False):
        if fa * fb < 0.0 and abs(fa) + abs(fb) < 3.0:
            for _ in range(100):
                middle = 0.5 * (a + b)
                a, b, fa = (middle, b, third(middle)) if fa * third(middle) > 0.0 else (a, middle, fa)
            return tuple(np.array(points[1]) + 0.5 * (a + b) * ray)
    raise AssertionError("no point of stationary curvature")


def side_taken(points, P, axis, order):
    """On which side of its tangent a coupler point leaves it, 1.0 or -1.0."""
    normal = complex(-axis[1], axis[0])
    return float(np.sign((coupler_series(points, P, order)[order] * normal.conjugate()).real))


def isosceles(cranks, angle=PI / 2):
    """Cranks with rods of their own length on one slider, which stands on the cranks' axle: u (u - 2 r cos θ) = 0 of
    each. With u = 0 all turn freely; or all turn with the slider, only where they stand across its way."""
    joints = [("P", ("slider", "0"), (0.0, 0.0), (1.0, 0.0, 0.0))]
    for i, r in enumerate(cranks):
        end = r * np.array([np.cos(angle), np.sin(angle)])
        joints += [("R", ("0", f"crank {i}"), (0.0, 0.0)), ("R", (f"crank {i}", f"rod {i}"), end),
                   ("R", (f"rod {i}", "slider"), (0.0, 0.0))]  # fmt: skip
    return linkage(joints)


def wheels(radii, centres, meshes):
    """Wheels on fixed axles, in mesh where they touch."""
    base = linkage([("R", ("0", str(i + 1)), p) for i, p in enumerate(centres)])
    joints = list(base.joints)
    for k, (a, b) in enumerate(meshes):
        p, q = np.array(centres[a], dtype=float), np.array(centres[b], dtype=float)
        assert np.isclose(np.linalg.norm(q - p), radii[a] + radii[b])
        at, along = p + radii[a] * unit(q - p), unit(q - p)
        axis = np.array([[-along[1], along[0], 0.0]])
        joints.append(MechanismJoint(f"mesh {k}", "gear", (str(a + 1), str(b + 1)), 2, np.append(at, 0.0), axis))
    return Mechanism("wheels", "planar", base.links, tuple(joints), "0")


def polygon(n, side=2.0):
    """The corners of a regular polygon."""
    r = side / (2.0 * np.sin(PI / n))
    return [(r * np.cos(2 * PI * i / n), r * np.sin(2 * PI * i / n)) for i in range(n)]


def plane():
    """In the plane."""
    rng = np.random.default_rng(1)
    for i, turns in enumerate([(0.3, 1.7, 3.4, 5.0), (0.5, 2.0, 3.9, 5.2)]):
        for side in (1.0, -1.0):
            yield f"Burmester's focal mechanism {i} {side:+.0f}", focal(turns, side), [1], None  # [Bu]
        yield f"its bar elsewhere {i}", focal(turns, 1.0, 0.1), [0], None
    for i, P in enumerate([(2.0, 3.5), (3.3, 1.0)]):
        yield f"Roberts's cognates {i}", cognates(FOUR_BAR, P), [1], None
        yield f"two of Roberts's cognates {i}", cognates(FOUR_BAR, P, 2), [1], None
    for i in range(2):
        P = rng.uniform(-1.0, 4.0, 2)
        centre = np.array(centre_of_curvature(FOUR_BAR, P))
        yield f"a bar on the path's normal {i}", joined(FOUR_BAR, P, P + 0.6 * (centre - P)), [0], 2
        yield f"a bar to the centre of curvature {i}", joined(FOUR_BAR, P, centre), [0], 3  # [BR]
        P = stationary(FOUR_BAR, 0.3 + 0.4 * i)
        centre = centre_of_curvature(FOUR_BAR, P)
        yield f"a bar from a point of stationary curvature {i}", joined(FOUR_BAR, P, centre), [0], 4
        P = tuple(rng.uniform(-1.0, 4.0, 2))
        velocity = coupler_series(FOUR_BAR, P, 1)[1]
        axis = (velocity.real, velocity.imag)
        side = side_taken(FOUR_BAR, P, axis, 2)
        yield f"a bar across a path, inside {i}", across(FOUR_BAR, P, axis, side), [1, 1], None
        yield f"a bar across a path, outside {i}", across(FOUR_BAR, P, axis, -side), [0], 2
        P, axis = inflection_point(FOUR_BAR, 0.4 + 0.8 * i)
        yield f"a cusp of order 3 {i}", across(FOUR_BAR, P, axis, 1.0 - 2.0 * i), [1], None  # [CS]
    P, axis = ball_point(FOUR_BAR)
    side = side_taken(FOUR_BAR, P, axis, 4)
    yield "a bar across at Ball's point, inside", across(FOUR_BAR, P, axis, side), [1, 1], None  # branches that touch
    yield "a bar across at Ball's point, outside", across(FOUR_BAR, P, axis, -side), [0], 4
    yield "a cusp of order 5", across(WATT, (0.0, 0.0), (0.0, 1.0), 1.0), [1], None  # [CS]
    yield "an isosceles slider-crank on its own axle", isosceles([1.0], 0.7), [1], None
    yield "an isosceles slider-crank across", isosceles([1.0]), [1, 1], None
    yield "two isosceles cranks on one slider", isosceles([1.0, 1.7]), [2, 1], None
    yield "three isosceles cranks on one slider", isosceles([1.0, 1.7, 0.6]), [3, 1], None
    third = (2.3**2 + 1.8**2 - 2.1**2) / 4.6  # where the third wheel touches both others
    centres = [(0.0, 0.0), (2.3, 0.0), (third, np.sqrt(1.8**2 - third**2))]
    yield "three wheels in a row", wheels([1.0, 1.3, 0.8], centres, [(0, 1), (1, 2)]), [1], None
    yield "three wheels each with each", wheels([1.0, 1.3, 0.8], centres, [(0, 1), (1, 2), (2, 0)]), [0], None
    for n in (4, 5):
        ring = [(i, (i + 1) % n) for i in range(n)]
        yield f"a ring of {n} wheels", wheels([1.0] * n, polygon(n), ring), [1 - n % 2], None
    corners = [(sx * x, sy * y) for x, y in ((2, 1), (0.7, 1.6)) for sx in (1, -1) for sy in (1, -1)]
    yield (
        "Dixon 2, seven points",
        truss(corners[:7], [(i, j) for i in range(4) for j in range(4, 7)]),
        [1],
        None,
    )  # [Di]
    cross = [(1, 0), (2.3, 0), (-1.1, 0), (0.5, 0), (0, 1), (0, -0.7), (0, 2.2), (0, -1.9)]
    yield "Dixon 1, eight points", truss(cross, [(i, j) for i in range(4) for j in range(4, 8)]), [1], None
    yield "three slides", linkage([("P", "01", (0, 0), (1, 0, 0)), ("P", "12", (1, 0), (1, 1, 0)),
                                   ("P", "20", (2, 0), (0, 1, 0))]), [1], None  # fmt: skip


# Space.


def screws(rows):
    """A ring of screws (point, axis, pitch)."""
    n = len(rows)
    joints = tuple(
        MechanismJoint(str(i), "helical", (str(i), str((i + 1) % n)), 1, np.array(p, float), unit(z)[None], pitch)
        for i, (p, z, pitch) in enumerate(rows)
    )
    return Mechanism("screws", "spatial", tuple(str(i) for i in range(n)), joints, "0")


def lines_in(n, complexes, rng):
    """n lines (point, direction) in one linear complex or two."""
    bases, lines = [(rng.normal(size=3), rng.normal(size=3)) for _ in range(complexes)], []
    for _ in range(n):
        p = rng.normal(size=3)
        normals = [v + np.cross(w, p) for w, v in bases]
        lines.append((p, unit(np.cross(normals[0], rng.normal(size=3) if complexes == 1 else normals[1]))))
    return lines


def second_order(lines):
    """The quadratic forms of the velocities that must vanish, each (k, k)."""
    S = np.array([np.concatenate([z, np.cross(p, z)]) for p, z in lines])
    U, values, Vt = np.linalg.svd(S.T)
    rank, n = int(np.sum(values > 1e-9)), len(lines)
    forms = []
    for wrench in U[:, rank:].T:
        M = np.zeros((n, n))
        for i in range(n):
            for j in range(i + 1, n):
                a, b = S[i], S[j]
                bracket = [*np.cross(a[:3], b[:3]), *(np.cross(a[:3], b[3:]) + np.cross(a[3:], b[:3]))]
                M[i, j] = M[j, i] = 0.5 * wrench @ bracket
        forms.append(Vt[rank:] @ M @ Vt[rank:].T)
    return forms


def ways_of_one(form):
    """The branches that a quadratic form of velocities leaves, and the order where it leaves none."""
    values = np.linalg.eigvalsh(form)
    if np.all(values > 0.0) or np.all(values < 0.0):
        return [0], 2
    return ([1, 1] if len(values) == 2 else [len(values) - 1]), None


def ways_of_two(A, B):
    """The same of two forms of three velocities: conics in a plane, that meet in up to four real points."""
    R, _ = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))
    # By the coefficients of x², x and 1, polynomials in y, the resultant is a quartic of y.
    (a2, a1, a0), (b2, b1, b0) = (
        (np.poly1d([M[0, 0]]), np.poly1d([2 * M[0, 1], 2 * M[0, 2]]), np.poly1d([M[1, 1], 2 * M[1, 2], M[2, 2]]))
        for M in (R.T @ A @ R, R.T @ B @ R)
    )
    roots = ((a2 * b0 - a0 * b2) ** 2 - (a2 * b1 - a1 * b2) * (a1 * b0 - a0 * b1)).roots
    real = int(np.sum(np.abs(roots.imag) < 1e-7 * (1.0 + np.abs(roots))))
    return ([1] * real, None) if real else ([0], 2)


def sheet(columns, rows, skew=0.0):
    """A flat sheet of panels that folds along straight lines, or, with a skew, as Miura's."""
    x, y = np.cumsum([0.0, *(1.0 + 0.2 * np.arange(columns))]), np.cumsum([0.0, *(1.1 + 0.15 * np.arange(rows))])
    points = [(a + skew * (j % 2), b, 0.0) for a in x for j, b in enumerate(y)]
    at = np.arange(len(points)).reshape(columns + 1, rows + 1)
    faces = [(at[i, j], at[i + 1, j], at[i + 1, j + 1], at[i, j + 1]) for i in range(columns) for j in range(rows)]
    return panels(points, faces)


def flat_vertex(*angles):
    """Panels about one corner, laid flat, with creases at angles."""
    return loop([(np.zeros(3), np.array([np.cos(a), np.sin(a), 0.0])) for a in angles], "spherical")


def symmetric(rng, half, mirror):
    """A ring of hinges that a half turn about a line takes to itself, or a mirror that two of its hinges lie in."""
    hinges = [(rng.normal(size=3), unit(rng.normal(size=3))) for _ in range(half)]
    H = np.diag([1.0, 1.0, -1.0]) if mirror else np.diag([-1.0, -1.0, 1.0])
    if not mirror:
        return loop(hinges + [(H @ p, H @ z) for p, z in hinges])
    within = [(H @ p + p, unit(H @ z + z)) for p, z in (rng.normal(size=(2, 3)) for _ in range(2))]
    return loop([within[0], *hinges, within[1], *((H @ p, -H @ z) for p, z in hinges[::-1])])


def space():
    """In space and on the sphere."""
    para = [(0, 0, 0), (1, 1.5, 0), (4, 1.5, 0), (3, 0, 0)]
    fitting, other = (0.1, 0.25, 0.3, 0.15), (0.1, 0.25, 0.3, 0.1)
    yield (
        "a parallelogram of screws that agree",
        screws(list(zip(para, [Z] * 4, fitting, strict=True))),
        [1],
        None,
    )  # [De]
    yield "a parallelogram of screws that do not", screws(list(zip(para, [Z] * 4, other, strict=True))), [0], None
    yield "screws on one axis", screws([((0, 0, i), Z, h) for i, h in enumerate((0.1, 0.2, 0.35))]), [1], None
    yield (
        "five parallel screws",
        screws([((np.cos(i), 1.3 * np.sin(i), 0), Z, 0.1 + 0.07 * i) for i in range(5)]),
        [1],
        None,
    )
    rng = np.random.default_rng(3)
    P, Q = np.zeros(3), np.array([1.5, 0.4, 0.8])
    at_P, at_Q = ([(p, unit(rng.normal(size=3))) for _ in range(4)] for p in (P, Q))
    upright = [(rng.normal(size=3), np.array(Z)) for _ in range(3)]
    slanted = [(rng.normal(size=3), unit((1.0, 0.3, 0.2))) for _ in range(3)]
    yield "hinges through two points", loop(at_P[:3] + at_Q[:3]), [1], None
    yield "seven hinges through two points", loop(at_P + at_Q[:3]), [2], None
    yield "parallel hinges and such through a point", loop(upright + at_Q[:3]), [1], None
    yield "hinges of two directions", loop(upright + slanted), [1], None
    for k in range(2):
        yield f"a ring symmetric about a line {k}", symmetric(np.random.default_rng(k), 3, False), [1], None  # [Br]
        yield f"a ring symmetric to a plane {k}", symmetric(np.random.default_rng(k), 2, True), [1], None  # [Br]
    yield "eight hinges symmetric about a line", symmetric(np.random.default_rng(3), 4, False), [2], None
    yield "eight hinges symmetric to a plane", symmetric(np.random.default_rng(3), 3, True), [2], None
    yield "two planes", linkage([("E", "01", (0, 0, 0), Z), ("E", "01", (1, 0, 0), Y)], "spatial"), [1], None
    yield "three creases laid flat", flat_vertex(0.0, 2.0, 4.0), [0], 2
    yield "four creases in less than half a turn", flat_vertex(0.0, 0.4, 0.9, 1.3), [0], 2
    yield "four creases laid flat", flat_vertex(0.0, 1.0, 2.7, 4.6), [1, 1], None
    yield "five creases laid flat", flat_vertex(0.0, 1.0, 2.3, 3.8, 5.0), [2], None
    yield "a map in two by two", sheet(2, 2), [1, 1], None
    yield "a map in three by two", sheet(3, 2), [2, 1], None
    yield "a map in four by three", sheet(4, 3), [3, 2], None
    # A vertex of Miura's folds along the straight crease alone or along all; of two in a row all folds depend on the
    # crease between them, of two on a zigzag it is folded by both or by none.
    yield "Miura's fold laid flat, two in a row", sheet(3, 2, 0.4), [1, 1, 1, 1], None
    yield "Miura's fold laid flat, two on a zigzag", sheet(2, 3, 0.4), [2, 1], None
    yield "Miura's fold laid flat, four", sheet(3, 3, 0.4), [2, 1, 1, 1], None
    for n, seeds in ((6, range(2)), (7, range(5)), (8, range(3))):
        for seed in seeds:
            lines = lines_in(n, 1, np.random.default_rng(100 * n + seed))
            yield f"{n} hinges in a complex {seed}", loop(lines), *ways_of_one(*second_order(lines))
    for seed in range(5):
        lines = lines_in(7, 2, np.random.default_rng(seed))
        yield f"7 hinges in two complexes {seed}", loop(lines), *ways_of_two(*second_order(lines))
    for seed in range(2):
        rng = np.random.default_rng(seed)
        feet, tops = rng.normal(size=(6, 3)), np.add(rng.normal(size=(6, 3)), (0.0, 0.0, 3.0))
        w, v = rng.normal(size=(2, 3))
        normals = v + np.cross(w, feet)
        off = np.sum(normals * (tops - feet), axis=1) / np.sum(normals**2, axis=1)
        yield f"six legs in a complex {seed}", hexapod(feet, tops - off[:, None] * normals), [0], 2


def cube_on_a_line(a, b, c):
    """A cube's twelve edges as bars in the plane, all along one line: lengths of the three directions."""
    places = [(i * a + j * b + k * c, 0.0) for i in (0, 1) for j in (0, 1) for k in (0, 1)]
    return truss(places, [(p, q) for p in range(8) for q in range(p) if (p ^ q).bit_count() == 1])


def branches_of_cube(a, b, c):
    """The dimensions of its branches: to second order each face is a parallelogram or crossed.

    Of heights y of the corners a face with edges of lengths a and b asks for a² / a + b² / b to be alike on both ways
    round: (a1 - a2) ((a1 + a2) / a - (b1 + b2) / b) = 0, a1 being what y changes by along an edge. So the branches
    are the greatest of 64 linear spaces.
    """
    sizes = {4: a, 2: b, 1: c}
    x = np.array([sum(size for bit, size in sizes.items() if p & bit) for p in range(8)])

    def rise(p, q):
        return np.eye(8)[q] - np.eye(8)[p]

    faces = []
    for i, j in ((4, 2), (4, 1), (2, 1)):
        for p in (0, 7 - i - j):
            one, two, left, right = rise(p, p | i), rise(p | j, p | i | j), rise(p, p | j), rise(p | i, p | i | j)
            faces.append((one - two, (one + two) / sizes[i] - (left + right) / sizes[j]))
    spaces = []
    for choice in product((0, 1), repeat=6):
        rows = np.array([*(face[k] for face, k in zip(faces, choice, strict=True)), np.ones(8), x])
        _, values, Vt = np.linalg.svd(rows)
        V = Vt[int(np.sum(values > 1e-9)) :]
        spaces.append(V.T @ V)
    greatest = [P for P in spaces if np.trace(P) > 0.5
                and not any(np.trace(Q) > np.trace(P) + 0.5 and np.allclose(Q @ P, P) for Q in spaces)]  # fmt: skip
    different = [P for i, P in enumerate(greatest) if not any(np.allclose(P, Q) for Q in greatest[:i])]
    return sorted((round(np.trace(P)) for P in different), reverse=True)


def lattice_on_a_line(along, up):
    """Bars of parallelograms side by side and on one another in the plane, all along one line: each may be a
    parallelogram or crossed, whatever the others are, so that of n in a row or square there are
    2^n branches."""
    x, y = np.cumsum([0.0, *along]), np.cumsum([0.0, *up])
    at = np.arange(len(x) * len(y)).reshape(len(x), len(y))
    bars = [pair for line in (*at, *at.T) for pair in pairwise(line.tolist())]
    return truss([(a + b, 0.0) for a in x for b in y], bars)


def many():
    """Poses in which many branches meet."""
    for lengths in ((1.0, 1.6, 2.3), (1.0, 1.0, 2.3), (1.0, 1.6, 2.6)):
        yield f"a cube on a line {lengths}", cube_on_a_line(*lengths), branches_of_cube(*lengths), None
    yield "three parallelograms on a line", lattice_on_a_line([1.0, 0.8, 1.7], [1.3]), [3] * 8, None
    yield "four parallelograms on a line", lattice_on_a_line([1.0, 0.8], [1.3, 0.6]), [3] * 16, None


def entries():
    """All of them."""
    yield from many()
    yield from plane()
    yield from space()
