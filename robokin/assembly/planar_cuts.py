"""Groups of bodies that no pairs place: all ways to close them, from one polynomial.

One body with two joints is left out, one hinge turned by z on the unit circle; pairs of bodies then place all others
and the body left out fits where f(z) = 0: `assembly_modes` has the derivation.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from robokin.arrays import Array, Complex
from robokin.assembly.planar_closing import closed_state, keep_way, pose_of
from robokin.assembly.planar_groups import (
    Dyad,
    PlanarJoint,
    Pose,
    dyad_poses,
)
from robokin.assembly.planar_pairs import Gaps
from robokin.errors import InputError

SAMPLES = 512
"""Values on the unit circle from which the polynomial is read: a platform on three legs has degree 6."""

VANISHED = 1e-9
"""Coefficients below this part of the greatest are those beyond the degree; rounding leaves 1e-12 or less."""

POWERS = (1, 2, 3, 4)
"""Powers of the pairs' first and last coefficients that are tried to clear the denominators."""

NEAR_CIRCLE = 0.05
"""Roots nearer to the unit circle than this are tried: those of ways that fall together are off by 1e-6 or so."""

ON_CIRCLE, MATCHED = 1e-7, 1e-4
"""A root is on the unit circle, and is that of a way, up to this: simple roots are good to 1e-9 or better."""

TURNS = 64
"""Turns of the hinge from which Newton's steps start in addition, where the roots do not tell all."""


@dataclass(frozen=True)
class CutPlan:
    """How a group is placed: the hinge that is turned, the body on it, the pairs in turn, the body left out with its
    two joints."""

    hinge: PlanarJoint
    body: int
    dyads: tuple[Dyad, ...]
    cut: int
    ends: tuple[PlanarJoint, PlanarJoint]

    @property
    def bodies(self) -> frozenset[int]:
        """All that it places."""
        return frozenset({self.body, self.cut, *(body for dyad in self.dyads for body in (dyad.a, dyad.b))})


def cut_ways(
    known: dict[int, Pose], unknown: frozenset[int], edges: list[PlanarJoint], size: float, gaps: Gaps, names: list[str]
) -> tuple[list[tuple[dict[int, Pose], bool]], bool]:
    """All ways to place some of the unknown bodies, each with whether it is double; whether none can be missing.

    Raises InputError where no cut leaves pairs only.
    """
    plan = min(_plans(known, unknown, edges), key=lambda plan: len(plan.bodies), default=None)
    if plan is None:
        listed = ", ".join(names[i] for i in sorted(unknown)[:8])
        raise InputError(f"the links {listed} hang together in too many ways, expected the `value` of another joint")
    roots, complete = _roots(plan, known)
    inner = [e for e in edges if {e.a, e.b} & plan.bodies and {e.a, e.b} <= plan.bodies | known.keys()]
    bodies = sorted(plan.bodies)
    found: list[tuple[Array, bool]] = []

    def close(values: Iterable[complex]) -> None:
        for z in values:
            for poses in _branches(plan, known, np.array([z / abs(z)])):
                state = _state(poses, bodies, plan, size)
                if state is not None:
                    keep_way(found, closed_state(state, bodies, inner, known, size))

    close(roots)
    if not complete or not _matched(roots, found, bodies.index(plan.body)):
        close(np.exp(2j * np.pi * (np.arange(TURNS) + 0.5) / TURNS))
        complete = complete and _matched(roots, found, bodies.index(plan.body))
    if not complete and any(twice for _, twice in found):
        listed = ", ".join(names[i] for i in bodies[:8])
        raise InputError(
            f"of the links {listed} some are left free while others are held twice, expected the values of other joints"
        )
    if not found:
        _note_gap(plan, known, gaps, names)
    ways = [({body: pose_of(x[3 * i : 3 * i + 3], size) for i, body in enumerate(bodies)}, twice) for x, twice in found]
    return ways, complete


def _matched(roots: Sequence[complex], found: Sequence[tuple[Array, bool]], place: int) -> bool:
    """Whether every root on the unit circle is that of a way that was found, and simple ways are even in number, as
    the real roots of a real polynomial of even degree are."""
    turns = np.exp(1j * np.array([x[3 * place] for x, _ in found]))
    for root in roots:
        if abs(abs(root) - 1.0) < ON_CIRCLE and not np.any(np.abs(turns - root / abs(root)) < MATCHED):
            return False
    return sum(not twice for _, twice in found) % 2 == 0


def _plans(known: dict[int, Pose], unknown: frozenset[int], edges: list[PlanarJoint]) -> Iterator[CutPlan]:
    """All ways to cut a group."""
    for cut in sorted(unknown):
        ends = [edge for edge in edges if cut in (edge.a, edge.b)]
        if len(ends) != 2 or all(edge.slides for edge in ends):
            continue
        for hinge in edges:
            if hinge.slides or cut in (hinge.a, hinge.b) or ((hinge.a in known) == (hinge.b in known)):
                continue
            body = hinge.b if hinge.a in known else hinge.a
            placed, dyads = {*known, body}, []
            rest = unknown - {body, cut}
            wanted = {edge.other(cut) for edge in ends}
            while not wanted <= placed:
                dyad = _dyad(placed, rest, edges)
                if dyad is None:
                    break
                dyads.append(dyad)
                placed |= {dyad.a, dyad.b}
                rest = rest - {dyad.a, dyad.b}
            if wanted <= placed:
                yield CutPlan(hinge, body, tuple(dyads), cut, (ends[0], ends[1]))


def _dyad(placed: set[int], rest: frozenset[int], edges: list[PlanarJoint]) -> Dyad | None:
    for middle in edges:
        if middle.a in rest and middle.b in rest:
            for first, last in product(edges, edges):
                if (
                    middle.a in (first.a, first.b) and first.other(middle.a) in placed
                    and middle.b in (last.a, last.b) and last.other(middle.b) in placed
                ):  # fmt: skip
                    return Dyad(middle.a, middle.b, first, middle, last)
    return None


def _turned(plan: CutPlan, known: dict[int, Pose], z: Complex) -> dict[int, Pose]:
    """The known poses, and that of the body on the hinge that is turned, for each z (m,)."""
    poses = {
        body: Pose(*(np.broadcast_to(part, z.shape) for part in (p.u, p.v, p.t, p.c))) for body, p in known.items()
    }
    P, Pc = poses[plan.hinge.other(plan.body)].point(plan.hinge.at(plan.hinge.other(plan.body)))
    at = plan.hinge.at(plan.body)
    poses[plan.body] = Pose(z, 1.0 / z, P - z * at, Pc - at.conjugate() / z)
    return poses


def _fit(plan: CutPlan, poses: dict[int, Pose]) -> Complex:
    """What the body left out lacks of fitting: 0 where it does [m² | m]."""
    one, two = plan.ends
    P, Pc = poses[one.other(plan.cut)].point(one.at(one.other(plan.cut)))
    Q, Qc = poses[two.other(plan.cut)].point(two.at(two.other(plan.cut)))
    span = two.at(plan.cut) - one.at(plan.cut)
    if not one.slides and not two.slides:
        return np.asarray((P - Q) * (Pc - Qc) - abs(span) ** 2)
    if one.slides:
        one, two, P, Q, Pc, Qc, span = two, one, Q, P, Qc, Pc, -span
    # The hinge is as far beside the slide as the body has it.
    guide = poses[two.other(plan.cut)]
    way = two.way(two.other(plan.cut))
    e, ec = guide.u * way, guide.v * way.conjugate()
    own = two.way(plan.cut)
    beside = span * own.conjugate() - span.conjugate() * own
    return np.asarray((Q - P) * ec - (Qc - Pc) * e - beside)


def _roots(plan: CutPlan, known: dict[int, Pose]) -> tuple[list[complex], bool]:
    """The roots near the unit circle of the product over all branches; whether it was seen to be a polynomial."""
    # Off the circle's symmetric points, where coefficients of pairs may vanish.
    z = np.exp(2j * np.pi * (np.arange(SAMPLES) + 0.37) / SAMPLES)
    with np.errstate(all="ignore"):
        for power in POWERS:
            values = _norm(plan, _turned(plan, known, z), 0, power)
            if not np.all(np.isfinite(values)):
                continue
            numbers = np.fft.fft(values) / SAMPLES
            order = np.fft.fftfreq(SAMPLES, 1.0 / SAMPLES).astype(int)
            numbers = numbers * np.exp(-2j * np.pi * 0.37 * order / SAMPLES)
            size = float(np.max(np.abs(numbers)))
            counted = np.abs(order[np.abs(numbers) > VANISHED * size])
            degree = int(np.max(counted, initial=0))
            if not size > 0.0 or degree > SAMPLES // 4:
                continue
            ascending = np.array([numbers[np.flatnonzero(order == k)[0]] for k in range(-degree, degree + 1)])
            roots = np.roots(ascending[::-1])
            near = [complex(root) for root in roots if abs(abs(root) - 1.0) < NEAR_CIRCLE]
            return near, True
    return [], False


def _norm(plan: CutPlan, poses: dict[int, Pose], level: int, power: int) -> Complex:
    """The product over the branches from a level on, with the pairs' coefficients that clear its denominators."""
    if level == len(plan.dyads):
        return _fit(plan, poses)
    dyad = plan.dyads[level]
    found, numbers = dyad_poses(dyad, poses)
    product_ = np.ones_like(poses[plan.body].u)
    for a, b in found:
        product_ = product_ * _norm(plan, poses | {dyad.a: a, dyad.b: b}, level + 1, power)
    clearing = (numbers[0] * numbers[2]) ** (power * 2 ** (len(plan.dyads) - 1 - level))
    return np.asarray(product_ * clearing)


def _branches(plan: CutPlan, known: dict[int, Pose], z: Complex) -> list[dict[int, Pose]]:
    """The poses of all but the body left out, on every branch."""
    ways = [_turned(plan, known, z)]
    with np.errstate(all="ignore"):
        for dyad in plan.dyads:
            ways = [poses | {dyad.a: a, dyad.b: b} for poses in ways for a, b in dyad_poses(dyad, poses)[0]]
    return ways


def _state(poses: dict[int, Pose], bodies: Sequence[int], plan: CutPlan, size: float) -> Array | None:
    """Real numbers (3 n,) to start from: angle and origin [size] of each body."""
    x = []
    for body in bodies:
        if body == plan.cut:
            one, two = plan.ends
            P, Q = (complex(poses[e.other(plan.cut)].point(e.at(e.other(plan.cut)))[0][0]) for e in (one, two))
            span = two.at(plan.cut) - one.at(plan.cut)
            slide = one if one.slides else two if two.slides else None
            if slide is not None:
                turn = complex(poses[slide.other(body)].u[0]) * slide.way(slide.other(body)) / slide.way(body)
                hinge, P = (two, Q) if one.slides else (one, P)
            else:
                turn, hinge = (Q - P) / span if abs(span) > 0.0 else 1.0 + 0j, one
            turn = turn / (abs(turn) or 1.0)
            origin = P - turn * hinge.at(body)
        else:
            pose = poses[body]
            turn = complex(pose.u[0])
            turn = turn / abs(turn) if abs(turn) > 0.0 else 1.0 + 0j
            origin = complex(0.5 * (pose.t[0] + np.conj(pose.c[0])))
        x += [np.angle(turn), origin.real / size, origin.imag / size]
    state = np.array(x, dtype=np.float64)
    return state if np.all(np.isfinite(state)) else None


def _note_gap(plan: CutPlan, known: dict[int, Pose], gaps: Gaps, names: list[str]) -> None:
    """How near the body left out comes to fitting, over a turn of the hinge."""
    z = np.exp(2j * np.pi * np.arange(2048) / 2048)
    one, two = plan.ends
    length = abs(two.at(plan.cut) - one.at(plan.cut))
    least, words = np.inf, ""
    for poses in _branches(plan, known, z):
        real = np.ones(len(z), dtype=bool)
        for pose in poses.values():
            real &= np.abs(np.abs(pose.u) - 1.0) < 1e-6
        if not real.any():
            continue
        if one.slides or two.slides:
            lack = np.where(real, np.abs(_fit(plan, poses)) / 2.0, np.inf)
            gap = float(np.min(lack))
            said = f"{names[plan.cut]} misses its place by @{gap}@ at least"
        else:
            P = poses[one.other(plan.cut)].point(one.at(one.other(plan.cut)))[0]
            Q = poses[two.other(plan.cut)].point(two.at(two.other(plan.cut)))[0]
            lack = np.where(real, np.abs(np.abs(P - Q) - length), np.inf)
            k = int(np.argmin(lack))
            gap = float(lack[k])
            side = "short" if abs(P[k] - Q[k]) > length else "long"
            said = f"{names[plan.cut]} with @{length}@ is too {side} by @{gap}@ at least"
        if gap < least:
            least, words = gap, said
    if words:
        gaps.note(least, words)
