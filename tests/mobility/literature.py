"""Mechanisms of the literature, each with the freedom that its source gives it where it is drawn.

Every entry is (name, mechanism, branches, order): the dimensions of the branches through the pose, [0] a structure, and
the order of the constraint that forbids a tremble, where there is one. Sources:

[Be] G. T. Bennett, "Deformable octahedra", Proc. London Math. Soc. 10, 1912; R. Bricard, "Mémoire sur la théorie de
     l'octaèdre articulé", J. Math. Pures Appl. 3, 1897.
[Br] R. Bricard, Leçons de cinématique II, 1927; J. E. Baker, "An analysis of the Bricard linkages", Mech. Mach. Theory
     15, 1980 (line-symmetric, plane-symmetric, trihedral, and Altmann's as one of them).
[Di] A. C. Dixon, "On certain deformable frameworks", Messenger Math. 29, 1899.
[DG] B. Grünbaum, G. C. Shephard, Lectures on lost mathematics, 1975 (Jessen's icosahedron, shaky of order 2).
[GD] M. Husty, A. Karger, "Self-motions of Griffis-Duffy type parallel manipulators", IEEE ICRA, 2000; A. Karger,
     "Architecture singular planar parallel manipulators", Mech. Mach. Theory 38, 2003.
[My] F. E. Myard, "Contribution à la géométrie des systèmes articulés", Bull. Soc. Math. France 59, 1931.
[Sc] P. Schatz, Rhythmusforschung und Technik, 1975.
[Wh] W. Whiteley, "Infinitesimal motions of a bipartite framework", Pacific J. Math. 110, 1984 (K33 on a conic).
[Wu] W. Wunderlich, "Starre, kippende, wackelige und bewegliche Achtflache", Elem. Math. 20, 1965.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
from mobility.known import truss
from mobility.linkages import linkage, loop, unit

PI = np.pi


def panels(points, faces):
    """Rigid faces, hinged where two of them have an edge in common."""
    owners = {}
    for number, face in enumerate(faces):
        for edge in combinations(sorted(face), 2):
            owners.setdefault(edge, []).append(str(number))
    points = [np.array(p, dtype=float) for p in points]
    return linkage(
        [("R", tuple(links), points[a], points[b] - points[a]) for (a, b), links in owners.items() if len(links) == 2],
        "spatial",
    )


def octahedron(one, other):
    """Eight triangles; one[i] and other[i] (3, 3) are opposite corners."""
    return panels([*one, *other], [(i, 1 + j, 2 + k) for i in (0, 3) for j in (0, 3) for k in (0, 3)])


def placed(theta, a, alpha, d):
    """The end and the axes of a ring of hinges by its table (a, α of the link after each, d and θ about each)."""
    T, axes = np.eye(4), []
    for turn, length, twist, offset in zip(theta, a, alpha, d, strict=True):
        axes.append((T[:3, 3], T[:3, 2]))
        c, s, ca, sa = np.cos(turn), np.sin(turn), np.cos(twist), np.sin(twist)
        T = T @ [[c, -s * ca, s * sa, length * c], [s, c * ca, -c * sa, length * s], [0, sa, ca, offset], [0, 0, 0, 1]]
    return T, axes


def ring(a, alpha, d=None, symmetry=None, seed=0):
    """The ring somewhere where it closes to the last digit, found by Newton's steps from angles drawn at random;
    symmetry: (n, m) how angles hang together there."""
    d = np.zeros(len(a)) if d is None else np.array(d)
    M = np.eye(len(a)) if symmetry is None else np.array(symmetry, dtype=float)
    rng = np.random.default_rng(seed)

    def lacking(x):
        T = placed(M @ x, a, alpha, d)[0]
        return np.concatenate([T[:3, 3], (T[:3, :3] - np.eye(3)).ravel()])

    for _ in range(40):
        x = rng.uniform(-2.5, 2.5, M.shape[1])
        for _ in range(60):
            off, h = lacking(x), 1e-6 * np.eye(len(x))
            J = np.stack([(lacking(x + e) - lacking(x - e)) / 2e-6 for e in h], axis=1)
            dx = np.linalg.lstsq(J, -off, rcond=1e-7)[0]
            x = x + dx * min(1.0, 0.3 / max(np.max(np.abs(dx)), 0.3))
        if np.max(np.abs(lacking(x))) < 2e-14:
            return loop(placed(M @ x, a, alpha, d)[1])
    raise AssertionError("the ring does not close")


def hexapod(feet, tops):
    """Six legs of fixed length, with universal joints below."""
    joints = []
    for i, (p, q) in enumerate(zip(feet, tops, strict=True)):
        joints += [("U", ("0", f"leg {i}"), p, (1, 0, 0), (0, 1, 0)), ("S", (f"leg {i}", "platform"), q)]
    return linkage(joints, "spatial")


def k33(points):
    """Bars from each of three points to each of three others."""
    return truss(points, [(i, j) for i in range(3) for j in range(3, 6)])


def two_triangles(one, other):
    """Triangles with a bar between each two corners."""
    return truss([*one, *other], [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)])


def plane():
    """Bars in the plane."""
    rng = np.random.default_rng(2)
    turn = np.array([0.1, 1.3, 2.9, 4.0, 0.8, 5.3])
    cross = [(1, 0), (2.3, 0), (-1.1, 0), (0, 1), (0, -0.7), (0, 2.2)]
    yield "Dixon 1", k33(cross), [1], None  # [Di]
    yield "Dixon 1, seven points", truss([*cross, (0, 0.4)], [(i, j) for i in range(3) for j in range(3, 7)]), [1], None
    corners = [(sx * x, sy * y) for x, y in ((2, 1), (0.7, 1.6)) for sx in (1, -1) for sy in (1, -1)]
    between = [(i, j) for i in range(4) for j in range(4, 8)]
    yield "Dixon 2", truss(corners, between), [1], None  # [Di]
    yield "Dixon 2, a corner away", truss([(2.25, 1), *corners[1:]], between), [0], None
    yield "K33 on an ellipse", k33(np.stack([2 * np.cos(turn), np.sin(turn)], axis=1)), [0], 2  # [Wh]
    yield "K33 on slanted lines", k33([*cross[:3], *((0.5 * y, y) for _, y in cross[3:])]), [0], 2  # a conic, too
    yield "K33 anywhere", k33(rng.normal(size=(6, 2))), [0], None
    triangle, centre = np.array([(0, 0), (3, 0.3), (1, 2)]), np.array([1.2, 0.6])
    # Desargues: corners in perspective.
    yield "in perspective", two_triangles(triangle, centre + (triangle - centre) * [[0.4], [0.5], [0.3]]), [0], 2
    yield "alike in perspective", two_triangles(triangle, centre + 0.4 * (triangle - centre)), [0], 2
    yield "shifted", two_triangles(triangle, np.add(triangle, (0.7, 3))), [1], None
    yield "in perspective from infinity", two_triangles(triangle, np.add(triangle, ((0, 3), (0, 4), (0, 5)))), [0], 2
    corner = np.stack([[i + 0.5 * k, j + 0.4 * k] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
    cube = [(a, b) for a, b in combinations(range(8), 2) if (a ^ b).bit_count() == 1]
    yield "a cube drawn in the plane", truss(corner, cube), [2], None  # three directions of edges turn freely


def polyhedra():
    """Hinged faces."""
    rng = np.random.default_rng(2)
    one = rng.normal(size=(3, 3))
    yield "Bricard's octahedron 1", octahedron(one, one * [-1, -1, 1]), [1], None  # [Be]
    mirrored = one * [[1, 1, 1], [1, 1, 1], [0, 1, 1]]
    yield "Bricard's octahedron 2", octahedron(mirrored, [*(one[:2] * [-1, 1, 1]), (0, 0.3, -1)]), [1], None
    yield "Bricard's octahedron 3, flat", flat_octahedron(), [1], None
    yield "an octahedron anywhere", octahedron(one, rng.normal(size=(3, 3))), [0], None
    for degrees, shaky in ((30, True), (90, False), (210, True)):
        angles = 2.0 * PI * np.arange(3) / 3.0
        above = np.stack([np.cos(angles + np.radians(degrees)), np.sin(angles + np.radians(degrees)), 1.3 + 0 * angles])
        below = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
        yield (
            f"triangles turned by {degrees}°",
            octahedron(below, above.T[[2, 0, 1]]),
            [0],
            2 if shaky else None,
        )  # [Wu]
    points = [np.roll([2.0 * a, 1.0 * b, 0.0], k) for k in range(3) for a in (1, -1) for b in (1, -1)]
    squares = {(i, j): np.sum((points[i] - points[j]) ** 2) for i, j in combinations(range(12), 2)}
    near = {edge for edge, square in squares.items() if min(abs(square - 6.0), abs(square - 16.0)) < 0.1}
    faces = [face for face in combinations(range(12), 3) if all(edge in near for edge in combinations(face, 2))]
    assert len(faces) == 20
    yield "Jessen's icosahedron", panels(points, faces), [0], 2  # [DG]


def flat_octahedron():
    """Bricard's third kind laid flat: two pairs of opposite corners where tangents from the third pair to one of two
    concentric circles meet."""
    A, D = np.array([3.0, 0.4]), np.array([-1.7, 2.6])

    def meeting(radius, sign):
        normals = []
        for P in (A, D):
            angle = np.arctan2(P[1], P[0]) + sign * np.arccos(radius / np.hypot(*P))
            normals.append((np.cos(angle), np.sin(angle)))
        return [*np.linalg.solve(normals, [radius, radius]), 0.0]

    one, other = ([meeting(radius, sign) for radius in (0.8, 1.1)] for sign in (1, -1))
    return octahedron([(*A, 0.0), *one], [(*D, 0.0), *other])


def rings():
    """Single loops of hinges."""
    twist = np.radians(50.0)
    halves = [PI / 2, PI / 2, 3 * PI / 2] * 2
    twice = np.vstack([np.eye(3)] * 2)
    s = np.sin(twist)
    yield "Myard", ring([s, 1, 0, 1, s], [twist, PI / 2, PI - 2 * twist, PI / 2, PI - twist]), [1], None  # [My]
    line = ring([1, 0.6, 1.4] * 2, [0.9, 0.5, 1.7] * 2, [0.2, -0.3, 0.5] * 2, twice)
    yield "Bricard, line-symmetric", line, [1], None  # [Br]
    last = np.sqrt(1 + 1.21 + 0.81 - 0.64 - 1.44)
    yield "Bricard, trihedral", ring([1, 0.8, 1.1, 1.2, 0.9, last], [PI / 2, 3 * PI / 2] * 3), [1], None
    yield "Bricard, plane-symmetric", mirrored_ring(), [1], None
    yield "Altmann", ring([1, 0, 0.7] * 2, halves, None, twice), [1], None
    yield "Schatz", ring([0, 1, 1, 1, 0, np.sqrt(3)], [PI / 2] * 5 + [0], [0.4, 0, 0, 0, 0, -0.4]), [1], None  # [Sc]
    flat = [((0, 0, 0), (np.cos(x), np.sin(x), 0)) for x in (0, 0.5, 1.6, 1.1)]
    yield "spherical parallelogram laid flat", loop(flat, "spherical"), [1, 1], None
    flat = [((0, 0, 0), (np.cos(x), np.sin(x), 0)) for x in (0, 0.5, 1.6, 2.5)]
    yield "spherical four-bar, stretched", loop(flat, "spherical"), [0], 2
    even = [(0, 0, 1), (0, np.sin(0.7), np.cos(0.7))]
    folded = loop([((0, 0, 0), even[0]), ((1, 0, 0), even[1])] * 2)
    yield "Bennett with equal sides, folded", folded, [1, 1], None


def mirrored_ring():
    """Six hinges: two in a plane, x = 0, or across it, and two anywhere with their mirror images."""
    rng = np.random.default_rng(4)
    side = [(np.add(rng.normal(size=3), (2, 0, 0)), unit(rng.normal(size=3))) for _ in range(2)]
    image = [(p * [-1, 1, 1], z * [-1, 1, 1]) for p, z in side]
    middle = [(np.array([0, y, 0.3 * y]), unit([0, 0.4, y])) for y in (-1.5, 1.8)]
    return loop([middle[0], *side, middle[1], *image[::-1]])


def platforms():
    """Parallel robots with fixed legs."""
    rng = np.random.default_rng(2)
    Q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    Q *= np.sign(np.linalg.det(Q))
    angles = 2.0 * PI * np.arange(6) / 6.0 + [0, 0.2, 0.1, -0.1, 0.3, 0.05]
    feet = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    tops = 0.6 * feet @ Q.T + (0.2, 0.1, 1.5)
    yield "hexagons alike", hexapod(feet, tops), [1], None  # on circles in perspective: [GD]
    yield "hexagons anywhere", hexapod(feet, tops + 0.1 * rng.normal(size=(6, 3))), [0], None
    corners = np.array([[np.cos(t), np.sin(t), 0.0] for t in 2.0 * PI * np.arange(3) / 3.0])
    middles = 0.5 * (corners + np.roll(corners, -1, axis=0))
    on_triangle = np.stack([corners, middles], axis=1).reshape(6, 3)
    tops = 0.8 * np.roll(on_triangle, -1, axis=0) @ Q.T + (0.1, 0.2, 1.6)
    yield "Griffis-Duffy", hexapod(on_triangle, tops), [1], None  # [GD]
    joints = []
    for i in range(3):
        out = np.array([np.cos(2.2 * i), np.sin(2.2 * i), 0.0])
        across = (-out[1], out[0], 0.0)
        joints += [
            ("R", ("0", f"lower {i}"), out, across),
            ("S", (f"lower {i}", f"upper {i}"), np.add(2 * out, (0, 0, 1))),
            ("R", (f"upper {i}", "platform"), np.add(out, (0, 0, 2)), across),
        ]
    yield "3-RSR", linkage(joints, "spatial"), [3], None


def entries():
    """All of them."""
    for kind in (plane, polyhedra, rings, platforms):
        yield from kind()
