"""Groups of two links in the plane, with hinges and slides: the quadratic equations that place them.

Statement. Links a and b hang together by a joint, and by one joint each on links whose poses are known. Find their
poses.

Derivation. A pose takes the point p of a link's frame to t + u p, |u| = 1. In isotropic coordinates a point is the
pair (p, p̄) and a turn (u, 1/u), and all equations are polynomials, also where there is no real solution. A hinge at
known P leaves t = P - u a₁. A slide on a known guide (point G, direction e) leaves u = e/ε and t = G + s e - u a₁.

    hinge, hinge, hinge   P + α u = Q + β w:   αD̄ u² + (ββ̄ - αᾱ - DD̄) u + ᾱD = 0,   D = Q - P
    hinge, hinge, slide   P + α u on a line:   αē u² + (Kē - K̄e) u - ᾱe = 0,            K = P - G - w (b₂ - b₃)
    hinge, slide, hinge   u (κ + s ε) = D:     D̄ε u² - (κε̄ - κ̄ε) u - Dε̄ = 0
    two slides            linear in how far they slide

Sources: Assur's groups of the second class: I. I. Artobolevsky, Theory of Mechanisms and Machines, 1975; isotropic
coordinates: C. W. Wampler, "Solving the kinematics of planar mechanisms", J. Mechanical Design 121(3), 1999.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Complex, Flags, Index


@dataclass(frozen=True, eq=False)
class Pose:
    """Poses of a link: turns u with their inverses v, origins t with their conjugates c, all (...,)."""

    u: Complex
    v: Complex
    t: Complex
    c: Complex

    def point(self, p: complex) -> tuple[Complex, Complex]:
        """Where a point of the link's frame is, in isotropic coordinates."""
        return self.t + self.u * p, self.c + self.v * p.conjugate()

    def pick(self, keep: Flags | Index) -> Pose:
        """Some of the poses."""
        return Pose(self.u[keep], self.v[keep], self.t[keep], self.c[keep])


@dataclass(frozen=True)
class PlanarJoint:
    """A joint between two bodies a and b: its places and, of a slide, its directions (unit numbers) in their frames."""

    name: str
    slides: bool
    a: int
    b: int
    places: tuple[complex, complex]
    ways: tuple[complex, complex]

    def at(self, body: int) -> complex:
        """Its place on one of its bodies."""
        return self.places[0] if body == self.a else self.places[1]

    def way(self, body: int) -> complex:
        """Its direction on one of its bodies."""
        return self.ways[0] if body == self.a else self.ways[1]

    def other(self, body: int) -> int:
        """The body at its other end."""
        return self.b if body == self.a else self.a


@dataclass(frozen=True)
class Dyad:
    """Bodies a and b with the joints known–a, a–b, b–known."""

    a: int
    b: int
    first: PlanarJoint
    middle: PlanarJoint
    last: PlanarJoint

    @property
    def linear(self) -> bool:
        """Whether it has one solution, not two: where two of its joints slide."""
        return self.first.slides + self.middle.slides + self.last.slides > 1


def dyad_poses(dyad: Dyad, known: dict[int, Pose]) -> tuple[list[tuple[Pose, Pose]], tuple[Complex, Complex, Complex]]:
    """The poses of both bodies, for each of the one or two solutions; the quadratic's coefficients, or 1, 1 and
    what is divided by where two joints slide."""
    if dyad.linear:
        first, last, divisor = _linear(dyad, known)
        return [(first, last)], (np.ones_like(divisor), np.ones_like(divisor), divisor)
    if dyad.first.slides:  # slide, hinge, hinge is hinge, hinge, slide from the other side
        turned = Dyad(dyad.b, dyad.a, dyad.last, dyad.middle, dyad.first)
        found, numbers = dyad_poses(turned, known)
        return [(b, a) for a, b in found], numbers
    a, b = dyad.a, dyad.b
    P, Pc = _point(dyad.first, a, known)
    alpha = dyad.middle.at(a) - dyad.first.at(a)
    if dyad.middle.slides:
        return _hinge_slide_hinge(dyad, known, P, Pc, alpha)
    if dyad.last.slides:
        e, ec, G, Gc = _guide(dyad.last, b, known)
        w, wc = e / dyad.last.way(b), ec * dyad.last.way(b)
        beta = dyad.middle.at(b) - dyad.last.at(b)
        K, Kc = P - G - w * beta, Pc - Gc - wc * beta.conjugate()
        numbers = (alpha * ec, K * ec - Kc * e, -alpha.conjugate() * e)
        solutions = []
        for u, v in _roots(*numbers):
            s = 0.5 * ((K + alpha * u) * ec + (Kc + alpha.conjugate() * v) * e)
            first = Pose(u, v, P - u * dyad.first.at(a), Pc - v * dyad.first.at(a).conjugate())
            at = dyad.last.at(b)
            solutions.append((first, Pose(w, wc, G + s * e - w * at, Gc + s * ec - wc * at.conjugate())))
        return solutions, numbers
    Q, Qc = _point(dyad.last, b, known)
    beta = dyad.middle.at(b) - dyad.last.at(b)
    D, Dc = Q - P, Qc - Pc
    middle = beta * beta.conjugate() - alpha * alpha.conjugate() - D * Dc
    numbers = (alpha * Dc, middle, alpha.conjugate() * D)
    solutions = []
    for u, v in _roots(*numbers):
        w, wc = (alpha * u - D) / beta, (alpha.conjugate() * v - Dc) / beta.conjugate()
        first = Pose(u, v, P - u * dyad.first.at(a), Pc - v * dyad.first.at(a).conjugate())
        last = Pose(w, wc, Q - w * dyad.last.at(b), Qc - wc * dyad.last.at(b).conjugate())
        solutions.append((first, last))
    return solutions, numbers


def _hinge_slide_hinge(
    dyad: Dyad, known: dict[int, Pose], P: Complex, Pc: Complex, alpha: complex
) -> tuple[list[tuple[Pose, Pose]], tuple[Complex, Complex, Complex]]:
    a, b = dyad.a, dyad.b
    Q, Qc = _point(dyad.last, b, known)
    D, Dc = Q - P, Qc - Pc
    e, f = dyad.middle.way(a), dyad.middle.way(b)
    kappa = (dyad.middle.at(b) - dyad.last.at(b)) * e / f - alpha
    across = kappa * e.conjugate() - kappa.conjugate() * e
    numbers = (Dc * e, np.full_like(D, -across), -D * e.conjugate())
    solutions = []
    for u, v in _roots(*numbers):
        w, wc = u * e / f, v * f / e
        first = Pose(u, v, P - u * dyad.first.at(a), Pc - v * dyad.first.at(a).conjugate())
        last = Pose(w, wc, Q - w * dyad.last.at(b), Qc - wc * dyad.last.at(b).conjugate())
        solutions.append((first, last))
    return solutions, numbers


def _point(edge: PlanarJoint, body: int, known: dict[int, Pose]) -> tuple[Complex, Complex]:
    """Where the known end of a joint of a body is."""
    return known[edge.other(body)].point(edge.at(edge.other(body)))


def _guide(edge: PlanarJoint, body: int, known: dict[int, Pose]) -> tuple[Complex, Complex, Complex, Complex]:
    """Direction and point of the known guide that a body slides on."""
    pose = known[edge.other(body)]
    way = edge.way(edge.other(body))
    G, Gc = pose.point(edge.at(edge.other(body)))
    return pose.u * way, pose.v * way.conjugate(), G, Gc


def _linear(dyad: Dyad, known: dict[int, Pose]) -> tuple[Pose, Pose, Complex]:
    """The solution where two of the joints slide: how far they do solves two linear equations with a determinant."""
    a, b = dyad.a, dyad.b
    if not dyad.first.slides:  # from the side of the slide on a known guide
        turned = Dyad(b, a, dyad.last, dyad.middle, dyad.first)
        second, first, divisor = _linear(turned, known)
        return first, second, divisor
    e, ec, G, Gc = _guide(dyad.first, a, known)
    u, v = e / dyad.first.way(a), ec * dyad.first.way(a)
    at = dyad.middle.at(a) - dyad.first.at(a)
    if dyad.last.slides:
        f, fc, H, Hc = _guide(dyad.last, b, known)
        w, wc = f / dyad.last.way(b), fc * dyad.last.way(b)
        beta = dyad.middle.at(b) - dyad.last.at(b)
        right, rightc = H + w * beta, Hc + wc * beta.conjugate()
    else:
        way = dyad.middle.way(a)
        f, fc = u * way, v * way.conjugate()
        w, wc = f / dyad.middle.way(b), fc * dyad.middle.way(b)
        Q, Qc = _point(dyad.last, b, known)
        beta = dyad.middle.at(b) - dyad.last.at(b)
        right, rightc = Q + w * beta, Qc + wc * beta.conjugate()
    R, Rc = right - G - u * at, rightc - Gc - v * at.conjugate()
    # s e - r f = R: the component across f.
    with np.errstate(divide="ignore", invalid="ignore"):
        divisor = e * fc - ec * f
        s = (R * fc - Rc * f) / divisor
    first = Pose(u, v, G + s * e - u * dyad.first.at(a), Gc + s * ec - v * dyad.first.at(a).conjugate())
    if dyad.last.slides:
        C, Cc = first.point(dyad.middle.at(a))
        last = Pose(w, wc, C - w * dyad.middle.at(b), Cc - wc * dyad.middle.at(b).conjugate())
    else:
        last = Pose(w, wc, Q - w * dyad.last.at(b), Qc - wc * dyad.last.at(b).conjugate())
    return first, last, divisor


def _roots(A: Complex, B: Complex, C: Complex) -> list[tuple[Complex, Complex]]:
    """Both roots of A u² + B u + C = 0 with their inverses; no digits are lost where they are far apart."""
    A, B, C = np.broadcast_arrays(np.asarray(A, complex), np.asarray(B, complex), np.asarray(C, complex))
    root = np.sqrt(B * B - 4.0 * A * C)
    big = -0.5 * (B + np.where((B.conjugate() * root).real >= 0.0, root, -root))
    with np.errstate(divide="ignore", invalid="ignore"):
        return [(big / A, A / big), (C / big, big / C)]
