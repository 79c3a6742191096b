"""Every way to put a planar mechanism of given lengths together, at given values of its drives.

Statement. Given a blueprint whose free joints are as many as its loops can place, find all poses of its bodies.

Derivation.
1. Bodies with a weld or a valued joint between them are one body.
2. A group of two bodies on known ones has a quadratic or linear equation (`planar_groups`); each solution goes on by
   itself. Four-bars, slider-cranks, and six-bars driven at a four-bar are nothing else.
3. What is left (a Stephenson chain driven from its far side, a platform on three legs) is cut: one body with two joints
   is left out and one hinge on a known body is turned by z = e^{iφ}, so that pairs of bodies place all others, and the
   body left out fits if the distance of its two joints does, f(z) = 0. The product N(z) of f over all branches of the
   quadratics, times powers of their first and last coefficients, is a Laurent polynomial: its coefficients are read off
   its values at roots of unity, where those beyond its degree must vanish. All its roots near the unit circle are
   tried; the true ones are closed by Newton's method.

Degenerate. Two ways that fall together within 1e-6 (a dead point) are one that is double. Where bodies fold onto one
another so that one is free to turn, the ways are infinitely many, which is said.

Sources: as in `planar_groups`; a platform on three legs has up to six ways: K. H. Hunt, "Structural kinematics of
in-parallel-actuated robot-arms", J. Mechanisms, Transmissions and Automation in Design 105(4), 1983.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from robokin.assembly.planar_cuts import cut_ways
from robokin.assembly.planar_groups import Dyad, PlanarJoint, Pose
from robokin.assembly.planar_pairs import SAME, Gaps, pair_ways
from robokin.errors import InputError
from robokin.model.blueprint import AssemblyMode, Blueprint

ORDERED = 1e-7
"""Heights that differ by less than this part of the size count as the same when ways are put in order."""


@dataclass
class Assemblies:
    """All ways, the highest first; complete: whether there can be no other."""

    modes: tuple[AssemblyMode, ...]
    complete: bool


@dataclass
class Body:
    """Bodies that are fixed to one another: the frame of each, (turn, origin), in that of the first."""

    frames: dict[str, tuple[complex, complex]] = field(default_factory=dict)


def assemblies_of(blueprint: Blueprint) -> Assemblies:
    """All ways to assemble a blueprint. Raises InputError where there is none, with what is lacking, where they are
    infinitely many, and where values are missing or too many."""
    bodies, number = _rigid(blueprint)
    edges = _edges(blueprint, bodies, number)
    ground = number[blueprint.ground]
    _check_count(blueprint, bodies, edges)
    turn, origin = bodies[ground].frames[blueprint.ground]
    u = np.array([1.0 / turn])
    known = {ground: Pose(u, u.conjugate(), np.array([-origin / turn]), np.array([(-origin / turn).conjugate()]))}
    size = _size(blueprint)
    gaps = Gaps()
    names = [next(iter(body.frames)) for body in bodies]
    unknown = frozenset(range(len(bodies))) - {ground}
    found: list[tuple[dict[int, Pose], bool]] = []
    complete = _place(known, unknown, edges, size, gaps, names, found, False)
    modes = [_mode(blueprint, bodies, number, poses, double) for poses, double in found]
    modes = _distinct(modes, size)
    if not modes:
        what = gaps.words or "its loops do not close"
        raise InputError(f"cannot be assembled: {what}, expected other lengths or another value")
    return Assemblies(tuple(_in_order(modes, blueprint, size)), complete)


def _rigid(blueprint: Blueprint) -> tuple[list[Body], dict[str, int]]:
    """Bodies joined by welds and valued joints, and the number of each link's."""
    groups = [Body({name: (1.0 + 0j, 0j)}) for name in blueprint.bodies]
    number = {name: i for i, name in enumerate(blueprint.bodies)}
    for joint in blueprint.joints:
        if joint.type != "fixed" and joint.value is None:
            continue
        a, b = joint.bodies
        if number[a] == number[b]:
            raise InputError(f"joint {joint.name}: {a} and {b} are held already, expected no value there")
        value = joint.value or 0.0
        turn = joint.angles[0] - joint.angles[1] if joint.type != "revolute" else value
        slid = value * np.exp(1j * joint.angles[0]) if joint.type == "prismatic" else 0.0
        u = complex(np.exp(1j * turn))
        t = joint.places[0] + slid - u * joint.places[1]
        # The second's group in the first's frame.
        ua, ta = groups[number[a]].frames[a]
        ub, tb = groups[number[b]].frames[b]
        ug = ua * u / ub
        tg = ta + ua * t - ug * tb
        moved, into = number[b], number[a]
        for name, (w, s) in groups[moved].frames.items():
            groups[into].frames[name] = (ug * w, tg + ug * s)
            number[name] = into
        groups[moved] = Body()
    kept = [i for i, group in enumerate(groups) if group.frames]
    return [groups[i] for i in kept], {name: kept.index(i) for name, i in number.items()}


def _edges(blueprint: Blueprint, bodies: list[Body], number: dict[str, int]) -> list[PlanarJoint]:
    """The free joints between the rigid bodies."""
    edges = []
    for joint in blueprint.joints:
        if joint.type == "fixed" or joint.value is not None:
            continue
        a, b = (number[name] for name in joint.bodies)
        if a == b:
            raise InputError(f"joint {joint.name} joins links that are held already, expected fewer values")
        frames = [bodies[number[name]].frames[name] for name in joint.bodies]
        places = tuple(t + u * p for (u, t), p in zip(frames, joint.places, strict=True))
        ways = tuple(complex(u * np.exp(1j * w)) for (u, _), w in zip(frames, joint.angles, strict=True))
        edges.append(
            PlanarJoint(joint.name, joint.type == "prismatic", a, b, (places[0], places[1]), (ways[0], ways[1]))
        )
    return edges


def _check_count(blueprint: Blueprint, bodies: list[Body], edges: list[PlanarJoint]) -> None:
    left = 3 * (len(bodies) - 1) - 2 * len(edges)
    given = sum(joint.value is not None for joint in blueprint.joints)
    if left > 0:
        more = "1 more joint" if left == 1 else f"{left} more joints"
        raise InputError(f"found {given} values, which leave {left} free, expected the `value` of {more}")
    if left < 0:
        raise InputError(f"found {-left} more conditions than the links have freedoms, expected fewer values or joints")


def _size(blueprint: Blueprint) -> float:
    sizes = [abs(joint.places[0] - other.places[0]) for joint in blueprint.joints for other in blueprint.joints]
    sizes += [abs(place) for joint in blueprint.joints for place in joint.places]
    return max(sizes, default=0.0) or 1.0


def _place(
    known: dict[int, Pose], unknown: frozenset[int], edges: list[PlanarJoint], size: float, gaps: Gaps,
    names: list[str], found: list[tuple[dict[int, Pose], bool]], double: bool,
) -> bool:  # fmt: skip
    """Place what is unknown, group by group, and collect all ways; whether none can be missing."""
    if not unknown:
        found.append((known, double))
        return True
    _check_held_once(known, unknown, edges, names)
    dyad = _dyad_in(known, unknown, edges)
    if dyad is not None:
        complete = True
        for a, b, twice in pair_ways(dyad, known, size, gaps, names):
            more = known | {dyad.a: a, dyad.b: b}
            rest = unknown - {dyad.a, dyad.b}
            complete &= _place(more, rest, edges, size, gaps, names, found, double or twice)
        return complete
    ways, complete = cut_ways(known, unknown, edges, size, gaps, names)
    for poses, twice in ways:
        rest = unknown - poses.keys()
        complete &= _place(known | poses, rest, edges, size, gaps, names, found, double or twice)
    return complete


def _check_held_once(
    known: dict[int, Pose], unknown: frozenset[int], edges: list[PlanarJoint], names: list[str]
) -> None:
    """Raise InputError for a body that two joints hold on known ones: then others are left free."""
    for body in sorted(unknown):
        held = [edge.name for edge in edges if body in (edge.a, edge.b) and edge.other(body) in known]
        if len(held) > 1:
            raise InputError(
                f"{names[body]} is held twice, by joints {held[0]} and {held[1]}, while other links are left free, "
                "expected the values of other joints"
            )


def _dyad_in(known: dict[int, Pose], unknown: frozenset[int], edges: list[PlanarJoint]) -> Dyad | None:
    """A pair of unknown bodies that hang together and on known ones."""
    for middle in edges:
        a, b = middle.a, middle.b
        if a not in unknown or b not in unknown:
            continue
        for first in edges:
            if a not in (first.a, first.b) or first.other(a) not in known:
                continue
            for last in edges:
                if b in (last.a, last.b) and last.other(b) in known:
                    return Dyad(a, b, first, middle, last)
    return None


def _mode(
    blueprint: Blueprint, bodies: list[Body], number: dict[str, int], poses: dict[int, Pose], double: bool
) -> AssemblyMode:
    """A way as places of joints and angles of links."""

    def frame(name: str) -> tuple[complex, complex]:
        pose = poses[number[name]]
        u, t = bodies[number[name]].frames[name]
        return complex(pose.u[0]) * u, complex(pose.t[0]) + complex(pose.u[0]) * t

    places = {}
    for joint in blueprint.joints:
        # A slide is where its block is, not where its guide begins.
        side = int(joint.bodies[0] == blueprint.ground and joint.type == "prismatic")
        u, t = frame(joint.bodies[side])
        places[joint.name] = t + u * joint.places[side]
    angles = {name: float(np.angle(frame(name)[0])) for name in blueprint.bodies}
    return AssemblyMode(places, angles, double)


def _distinct(modes: list[AssemblyMode], size: float) -> list[AssemblyMode]:
    """The ways without repetition; two that fall together are double."""
    kept: list[AssemblyMode] = []
    for mode in modes:
        for i, other in enumerate(kept):
            apart = max(abs(np.angle(np.exp(1j * (mode.angles[name] - other.angles[name])))) for name in mode.angles)
            shift = max(abs(mode.places[name] - other.places[name]) for name in mode.places) / size
            if max(apart, shift) < SAME:
                kept[i] = AssemblyMode(other.places, other.angles, True)
                break
        else:
            kept.append(mode)
    return kept


def _in_order(modes: list[AssemblyMode], blueprint: Blueprint, size: float) -> list[AssemblyMode]:
    """The ways with the highest joints first, in the order of the file; of those as high the one to the right."""

    def key(mode: AssemblyMode) -> list[float]:
        parts: list[float] = []
        for joint in blueprint.joints:
            place = mode.places[joint.name] / (ORDERED * size)
            parts += [-round(place.imag), -round(place.real)]
        return parts

    return sorted(modes, key=key)
