"""Whether an answer of inverse kinematics keeps the laws, given a configuration that made the pose.

The laws, for the pose T(q) of a configuration q within the limits:

- unanswered: there is a solution, since q is one.
- lost: a regular q is among the solutions.
- on no family: a singular q is listed, or stands on one of the self-motions that are given.
- falsely complete: where `complete` is said, q and every other known solution is listed or stands on a self-motion.
- wrong: each listed solution reaches the pose, and is within the limits.
- twice: no solution is listed twice.
- by an ulp: the regular solutions are the same when the last digits of the pose are not.
- batch: a pose among others is answered as the same pose alone.
"""

from __future__ import annotations

import numpy as np
from inverse.truth import REGULAR, TURN, Scale, errors, gaps, least_singular_value, polished, search

import robokin

SAME = 1e-6
"""A regular solution is found when a listed one differs by less [rad | size]."""

DOUBLE = 1e-4
"""The same for a singular solution: where m of them meet, rounding of 1e-16 moves them by its m-th root."""

ROUNDING = 1e-14
"""What rounding does to a pose [size | rad], amply: over the least singular value it is what it does to a solution."""

SINGULAR = 1e-13
"""A lesser singular value is zero but for rounding."""

TWICE = 1e-5
"""Two listed solutions that are nearer [rad | size] may be one, unless they stand on a self-motion."""

BETWEEN = 1e-13
"""They are one if the pose midway between them is off by less [size | rad]: between two roots that are g apart it is
off by about g²."""

ON_ARC = 1e-3
"""A configuration nearer [rad | size] to an arc stands on it."""

BENT = 0.03
"""How far an arc may be from the chord between two of its points, over the chord's length: an eighth of the angle that
the arc turns by between them, a seventh of a right angle."""

REACHED = 2e-9
"""The error [size | rad] with which a solution may be listed."""

INSIDE = 1e-9
"""A value so far [rad | m] outside its limits is within."""

EXACTLY = 1e-12
"""Regular solutions of a pose alone and among others differ by less [rad | size]; singular ones by `DOUBLE`."""

CLUSTER = 1e-2
"""So near [rad | size] to a root that counts many times a search ends: around it the pose is off by rounding only."""


def listed(robot, result):
    """(k, n) the solutions of a result."""
    return np.array([solution.q for solution in result.solutions]).reshape(-1, robot.n)


def farness(robot, scale, q, others):
    """(k,) the greatest joint difference [rad | size] of q: (n,) from each of others: (k, n)."""
    return np.max(gaps(robot, others, q) / scale.unit, axis=1, initial=0.0)


def among(robot, scale, q, others, tolerance):
    """Whether q: (n,) is one of others: (k, n)."""
    return bool(len(others)) and bool(np.min(farness(robot, scale, q, others)) < tolerance)


def within_limits(robot, q, slack=INSIDE):
    """Whether some turns bring q: (n,) into the limits."""
    low, high = robot.limits.T
    up = np.where(robot.revolute & np.isfinite(low), np.ceil((low - slack - q) / TURN), 0.0)
    moved = q + TURN * up
    return bool(np.all((moved >= low - slack) & (moved <= high + slack)))


def on_arc(robot, scale, q, points):
    """Whether q: (n,) stands on the polyline through points: (k, n), whole turns aside."""
    a = points[: max(len(points) - 1, 1)] / scale.unit
    b = points[min(1, len(points) - 1) :] / scale.unit
    middle = (a + b) / 2.0
    x = q / scale.unit
    x = x - np.where(robot.revolute, TURN * np.round((x - middle) / TURN), 0.0)
    along = b - a
    length = np.sum(along * along, axis=1)
    t = np.sum((x - a) * along, axis=1) / np.where(length > 0.0, length, 1.0)
    nearest = a + np.clip(t, 0.0, 1.0)[:, None] * along
    return bool(np.any(np.max(np.abs(x - nearest), axis=1) < ON_ARC + BENT * np.sqrt(length)))


def on_family(robot, scale, q, result):
    """Whether q: (n,) stands on one of a result's self-motions.

    A curve is tested by its arcs. Of a surface only the joints that stand still are: its arcs are curves in it.
    """
    for family in result.families:
        if any(on_arc(robot, scale, q, np.atleast_2d(arc.q)) for arc in family.arcs):
            return True
        if family.dimension > 1:
            still = [k for k in range(robot.n) if k + 1 not in family.joints]
            off = gaps(robot, result.solutions[family.solution].q, q) / scale.unit
            if np.all(off[still] < ON_ARC):
                return True
    return False


def has(robot, scale, q, result):
    """Whether q: (n,) is listed or stands on a self-motion of the result."""
    solutions = listed(robot, result)
    if among(robot, scale, q, solutions, SAME):
        return True
    least = float(least_singular_value(robot, scale, q))
    if least >= REGULAR:
        return False
    tolerance = np.clip(ROUNDING / least, DOUBLE, 0.1) if least > SINGULAR else DOUBLE
    return among(robot, scale, q, solutions, tolerance) or on_family(robot, scale, q, result)


def faults(robot, scale, q, T, result, known=(), limits=True):
    """The laws that an answer to T: (4, 4) breaks. q: (n,) made the pose; known: other solutions (s, n)."""
    broken = []
    solutions = listed(robot, result)
    found = has(robot, scale, q, result)
    regular = least_singular_value(robot, scale, q) >= REGULAR
    if not len(solutions):
        broken.append("unanswered")
    elif not found:
        broken.append("lost" if regular else "on no family")
    if result.complete:
        others = [x for x in known if not limits or within_limits(robot, x, -SAME)]
        missing = [x for x in others if not has(robot, scale, x, result)]
        if not found or any(not around_a_root(robot, scale, x, T, solutions) for x in missing):
            broken.append("falsely complete")
    if len(solutions):
        off = np.max(np.abs(errors(robot, scale, solutions, np.broadcast_to(T, (len(solutions), 4, 4)))))
        outside = limits and not robot.within_limits(solutions).all()
        if off > REACHED or outside:
            broken.append("wrong")
        if listed_twice(robot, scale, solutions, T, result):
            broken.append("twice")
    return broken


def around_a_root(robot, scale, q, T, solutions):
    """Whether q: (n,), a singular one, is next to one of the solutions (k, n) with nothing but solutions between."""
    if least_singular_value(robot, scale, q) >= REGULAR:
        return False
    for other in solutions[farness(robot, scale, q, solutions) < CLUSTER]:
        middle = q + (other - q - np.where(robot.revolute, TURN * np.round((other - q) / TURN), 0.0)) / 2.0
        if np.max(np.abs(errors(robot, scale, middle[None], T[None]))) < BETWEEN:
            return True
    return False


def listed_twice(robot, scale, solutions, T, result):
    """Whether two of the solutions (k, n) are one."""
    for i, q in enumerate(solutions[:-1]):
        for other in solutions[i + 1 :][farness(robot, scale, q, solutions[i + 1 :]) < TWICE]:
            # Apart by whole turns, or one polished better than the other: both are brought home first.
            turns = np.where(robot.revolute, TURN * np.round((other - q) / TURN), 0.0)
            pair, _ = polished(robot, scale, np.stack([q, other - turns]), T)
            if len(pair) < 2:
                continue
            off = np.max(np.abs(errors(robot, scale, pair.mean(axis=0)[None], T[None])))
            if off < BETWEEN and not on_family(robot, scale, q, result):
                return True
    return False


def shaken(T, rng):
    """T: (m, 4, 4) with the entries of its first three rows moved by one ulp, or 1e-17 where that is more."""
    out = T.copy()
    step = np.maximum(np.spacing(np.abs(T[:, :3])), 1e-17)
    out[:, :3] += step * rng.choice([-1.0, 0.0, 1.0], T[:, :3].shape)
    return out


def differ(robot, scale, a, b):
    """Whether a regular solution of one list (k, n) is not in the other (l, n)."""
    for some, all_ in ((a, b), (b, a)):
        if len(some):
            regular = least_singular_value(robot, scale, some) >= REGULAR
            if any(not among(robot, scale, q, all_, SAME) for q in some[regular]):
                return True
    return False


def differs_alone(robot, scale, result, alone):
    """In what the answer in a batch differs from that for the pose alone, or nothing."""
    a, b = listed(robot, result), listed(robot, alone)
    if len(a) != len(b):
        return f"{len(a)} solutions, alone {len(b)}"
    if (result.complete, result.basis) != (alone.complete, alone.basis):
        return f"complete {result.complete}, {result.basis}, alone {alone.complete}, {alone.basis}"
    if len(result.families) != len(alone.families):
        return f"{len(result.families)} self-motions, alone {len(alone.families)}"
    if not len(a):
        return ""
    regular = least_singular_value(robot, scale, a) >= REGULAR
    tolerance = np.where(regular, EXACTLY, DOUBLE)
    # Whole turns count here: two answers to one pose are the same numbers. Of singular solutions, which are known to
    # half of their digits, -180 and 180 degrees are the same.
    gap = a - b
    turned = np.where(robot.revolute & ~regular[:, None], gap - 2 * np.pi * np.round(gap / (2 * np.pi)), gap)
    off = np.max(np.abs(turned) / scale.unit, axis=1)
    return f"a solution is off by {np.max(off):.1e}" if np.any(off > tolerance) else ""


def solve(robot, T, **arguments):
    """The answers for T: (m, 4, 4), each a result of its own."""
    batch = robokin.solve_ik(robot, T, **arguments)
    return [batch[i] for i in range(len(T))]


def breaking(robot, q, limits=True, searched=0):
    """Which of the configurations q: (m, n) [rad | m] have poses whose answers break laws, and which laws.

    limits: whether they count; searched: for how many poses solutions are also searched from random guesses.
    Returns the joint values in degrees and metres with what is broken.
    """
    scale, rng = Scale(robot), np.random.default_rng(7)
    T = robokin.forward_kinematics(robot, q)
    out = []
    for i, result in enumerate(solve(robot, T, limits=limits)):
        known = search(robot, scale, T[i], rng)[0] if i < searched else ()
        laws = faults(robot, scale, q[i], T[i], result, known, limits)
        if laws:
            out.append((robot.id, np.where(robot.revolute, np.degrees(q[i]), q[i]).round(7).tolist(), laws))
    return out
