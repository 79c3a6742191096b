"""Paths of complex solutions of a loop, followed from targets where all are known to targets where they are asked for.

Statement. Given the solutions at one target L6, find those that they become as the target moves to another.
Derivation. With a quaternion r, of any length, for L6's rotation and its translation p, the straight line
r = u r0 + (1 - u) r1, p = u p0 + (1 - u) p1 for u from 1 to 0 leads through rigid motions, complex ones where the start
is complex. On it X = J1 L1 … J6 L6 stays I where S q' = -b, b being the twist of L6's motion in its own frame,
ω = 2 (r* r') / r·r and Rᵀp'. From a start in general position the line misses, with probability one, the complex
targets at which solutions meet: only at its end two paths can. Each step predicts by the cubic through the last two
points and their tangents and corrects by two Newton steps. From a start that is not complex, or near the target, the
way is bent: with w = γ u / (1 - u + γ u) in place of u, |γ| = 1, it is an arc from 1 to 0 in the plane of complex w, on
which, for all but some γ, there is none of the finitely many places of the line at which solutions meet.
Degenerate case. Where a path ends in a singular solution q goes like a root of u, mostly the second, and where it leads
to infinity an angle goes like i k log u. Steps are steps in s, u = s²: in s a double solution's path is smooth, and
steps in proportion to s follow all others. u times the speed in u tells them apart, as it vanishes at a solution and
tends to |k| at infinity.
Reference. C. Wampler, A. Morgan, "Solving the 6R inverse position problem using a generic-case solution methodology",
Mechanism and Machine Theory 26 (1991).

All arrays here have the paths last, (…, s), and each operation is on all paths at once.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array, Complex, Flags, Index
from robokin.inverse.elimination.complex_newton import solved
from robokin.inverse.elimination.loop import Loop, follow, native_loop, twist_columns
from robokin.inverse.elimination.loop_newton import closing_at
from robokin.kernel.native_kernel import native

ROOTS = 2
"""u = s²: at the end of a path on which two solutions meet q is then a power series in s."""

FIRST = 0.015
"""Length of a path's first step in s: nothing but the tangent is known there."""

OFF = 5e-2
"""Greatest first correction of a step [rad | size]: the prediction is then closer to its own path than to others."""

AIM = 1e-2
"""First correction [rad | size] that the length of the next step is chosen for."""

CONTRACTS = 0.1
"""Greatest ratio of the second correction to the first. Newton's steps contract by the ratio of the distance from the
solution to that from other solutions: so much for the chance of being drawn to another path."""

BESIDE = 0.05
"""Greatest second correction [rad | size] as a part of s, which is about how far apart two solutions are that meet at
the end: the first correction may be mostly in other directions, and then its ratio says nothing."""

NOISE = 1e-7
"""Second corrections below this [rad | size] need not be smaller than the first: near a singular end, where S has
singular values of 1e-8, rounding is as large."""

EXACT = 1e-12
"""The same of a step to the end itself: what is left of a correction of a regular end where rounding is all there is.
At a singular end rounding is never so small."""

STRIDE = 0.7
"""Greatest length of a step [rad | size]: beyond it the cubic says little of a turn."""

END = 1e-11
"""Value of u at which a path that has not ended in a regular solution is left: a double solution is some 3e-6 away."""

END_S = END ** (1.0 / ROOTS)
"""The same of s."""

NEAR = 1e-6
"""Value of u below which a path on which no further step succeeds counts as having come to its end."""

NEAR_S = NEAR ** (1.0 / ROOTS)
"""The same of s."""

SHORTEST = 5e-8
"""Length of a step, as a part of s, below which a path is given up."""

LAST = 0.8
"""A step that would leave less than a fifth of s goes to the end at once. Where it fails, which it does at a singular
end, so much of s is tried instead."""

AGAIN = 0.5
"""Part of the s of a failed step to the end below which the next one is tried."""

MOST = 400
"""Steps after which a path is given up; the longest of those that end take some hundred."""

LATE_MOST = 120
"""Steps below `NEAR` after which a path is left: ends take some fifteen from there, and up to a hundred where two
solutions are 1e-6 apart. Where several nearly meet rounding makes for any number."""

FAR = 16.0
"""|Im q| [rad], or the logarithm of a slide's length [size], beyond which a path is left: the entries of X are as large
as exp(2 |Im q|), and then nothing is left of their digits."""

BLOCK = 1024
"""Paths at a time: the hundred and fifty or so complex numbers of each (2.4 MB) stay in the second-level cache."""


@dataclass(frozen=True, eq=False)
class Points:
    """Targets as points of the space in which the lines are straight.

    r: (4, m) quaternions w, x, y, z of any length, complex or not; p: (3, m) [size].
    """

    r: Complex
    p: Complex

    def pick(self, index: Index) -> Points:
        """Some of them."""
        return Points(self.r[:, index], self.p[:, index])


@dataclass(frozen=True, eq=False)
class PathEnds:
    """Where the paths (s,) lead.

    values: (6, s) [rad | size]; u: (s,) where they were left, 0 for those that ended in a regular solution;
    speed: (s,) u |dq / du| of the joint that moves the most, [rad] or relative to the length of a slide;
    lost: (s,) given up mid-way.
    """

    values: Complex
    u: Array
    speed: Array
    lost: Flags


def points_of(closing: Complex | Array) -> Points:
    """The points of L6 (m, 4, 4), real or complex.

    The quaternions' products r rᵀ are linear in the rotation's entries: its greatest column is r but for its length.
    """
    R = closing[:, :3, :3].transpose(1, 2, 0).astype(np.complex128)
    d = R[0, 0], R[1, 1], R[2, 2]
    K = np.empty((4, 4, len(closing)), dtype=np.complex128)
    K[0, 0] = 1.0 + d[0] + d[1] + d[2]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        K[i + 1, i + 1] = 1.0 + d[i] - d[j] - d[k]
        K[0, i + 1] = K[i + 1, 0] = R[k, j] - R[j, k]
        K[j + 1, k + 1] = K[k + 1, j + 1] = R[j, k] + R[k, j]
    size = np.linalg.norm(K, axis=1)
    best = np.argmax(size, axis=0)
    every = np.arange(len(closing))
    r = K[:, best, every] / size[best, every]
    return Points(r, np.ascontiguousarray(closing[:, :3, 3].T.astype(np.complex128)))


def track(loop: Loop, start: Points, target: Points, values: Complex, bend: Complex | None = None) -> PathEnds:
    """Follow solutions values (6, s) [rad | size] at start, (s,) points, to target, (s,) points.

    bend: (s,) numbers γ of length 1 by which ways leave the straight lines, 1 where they do not.
    """
    count = values.shape[1]
    bend = np.ones(count, dtype=np.complex128) if bend is None else bend
    # Of the two quaternions of the target's rotation the one nearer to the start's makes the shorter way.
    sign = np.where((start.r.conj() * target.r).sum(axis=0).real < 0.0, -1.0, 1.0)
    target = Points(target.r * sign, target.p)
    known = native_loop(loop)
    if native is None or known is None:
        return tracked_by_columns(loop, start, target, values, bend)
    rows = [_as_rows(np.concatenate([point.r, point.p])) for point in (start, target)]
    to, left = native.tracked(known, *rows, _as_rows(bend[None]), _as_rows(values))
    u, speed, lost = left.T
    return PathEnds(np.ascontiguousarray(to.view(np.complex128).T), u, speed, lost > 0.0)


def _as_rows(columns: Complex) -> Array:
    """Complex columns (k, s) as rows (s, 2 k) of real and imaginary parts."""
    return np.ascontiguousarray(columns.T, dtype=np.complex128).view(np.float64)


def tracked_by_columns(loop: Loop, start: Points, target: Points, values: Complex, bend: Complex) -> PathEnds:
    """`track` in Python, for quaternions of the target that are nearer to the start's."""
    count = values.shape[1]
    ends = PathEnds(values.astype(np.complex128), np.ones(count), np.zeros(count), np.zeros(count, dtype=bool))
    for first in range(0, count, BLOCK):
        part = np.arange(first, min(first + BLOCK, count))
        # A step that leads astray may overflow: it is not accepted.
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            _track(loop, start.pick(part), target.pick(part), bend[part], part, ends)
    return ends


def _track(loop: Loop, start: Points, target: Points, bend: Complex, part: Index, ends: PathEnds) -> None:
    """`track` for a block of paths, whose ends are written to the places `part`."""
    q = np.ascontiguousarray(ends.values[:, part])
    s = np.ones(len(part))
    last, twist = _on_line(start, target, s, bend)
    axes, _, _ = follow(loop, last, q)
    v = ROOTS * solved(twist_columns(loop, axes), twist)
    before, tangent = q, v  # the point before and its tangent; with the infinite step between they say nothing
    h, gone, tried = np.full(len(part), FIRST), np.full(len(part), np.inf), np.full(len(part), np.inf)
    late = np.zeros(len(part))
    for _ in range(MOST):
        # To the end at once, unless that failed not long ago; then not beyond where the path is left.
        ended = s <= END_S
        ending = (h > LAST * s) & (s < AGAIN * tried)
        h = np.where(ending, s, np.minimum(np.minimum(h, LAST * s), np.maximum(s - 0.999 * END_S, 0.0)))
        to = s - h
        D = (q - before) / gone
        guess = q + h * v + (h * h / gone) * (v - D + (1.0 + h / gone) * (v + tangent - 2.0 * D))
        weight = _weights(loop, q)
        stride = (np.abs(guess - q) * weight).max(axis=0)
        last, twist = _on_line(start, target, to**ROOTS, bend)
        axes, error, _ = follow(loop, last, guess)
        first = solved(twist_columns(loop, axes), error)
        guess -= first
        axes, error, _ = follow(loop, last, guess)
        both = solved(twist_columns(loop, axes), np.stack([error, twist], axis=-1))
        second, ahead = both[..., 0], ROOTS * to ** (ROOTS - 1) * both[..., 1]
        guess -= second
        one, two = (np.abs(first) * weight).max(axis=0), (np.abs(second) * weight).max(axis=0)
        small = np.minimum(CONTRACTS * one, np.where(to > 0.0, BESIDE * to, np.inf))
        fine = (one < OFF) & (two < np.maximum(small, np.where(to > 0.0, NOISE, EXACT))) & (stride < STRIDE) & ~ended
        factor = 0.9 * np.minimum((AIM / one) ** 0.25, STRIDE / stride)
        factor = np.where(fine, np.clip(factor, 0.4, 2.5), np.clip(factor, 0.1, 0.4))
        factor[~np.isfinite(factor)] = 0.1
        factor[ending & ~fine] = LAST
        tried[ending & ~fine] = s[ending & ~fine]
        before, tangent = np.where(fine, q, before), np.where(fine, v, tangent)
        q, v, s = np.where(fine, guess, q), np.where(fine, ahead, v), np.where(fine, to, s)
        gone = np.where(fine, h, gone)
        h = h * factor
        stuck = ~fine & (h < SHORTEST * s)
        late += s < NEAR_S
        over = (s <= END_S) | stuck | (late > LATE_MOST) | (distance(loop, q) > FAR)
        if np.count_nonzero(over) > 0.2 * len(s) or over.all():
            _leave(loop, ends, part, over, q, v, s, stuck)
            on = ~over
            part, bend, q, v, s = part[on], bend[on], q[:, on], v[:, on], s[on]
            before, tangent, h, gone, tried = before[:, on], tangent[:, on], h[on], gone[on], tried[on]
            late = late[on]
            start, target = Points(start.r[:, on], start.p[:, on]), Points(target.r[:, on], target.p[:, on])
            if not len(part):
                return
    _leave(loop, ends, part, np.ones(len(part), dtype=bool), q, v, s, s > END_S)


def _leave(
    loop: Loop, ends: PathEnds, part: Index, over: Flags, q: Complex, v: Complex, s: Array, stuck: Flags
) -> None:
    place, u = part[over], s**ROOTS
    ends.values[:, place], ends.u[place] = q[:, over], u[over]
    # u dq/du is s dq/ds, divided by the power.
    ends.speed[place] = s[over] / ROOTS * (np.abs(v[:, over]) * _weights(loop, q[:, over])).max(axis=0)
    ends.lost[place] = stuck[over] & (u[over] > NEAR)


def _weights(loop: Loop, q: Complex) -> Array:
    """What lengths of joint motions count by (6, s): long slides relative to their length."""
    return np.asarray(np.where(loop.revolute[:, None], 1.0, 1.0 / (1.0 + np.abs(q))))


def distance(loop: Loop, q: Complex) -> Array:
    """How far towards infinity values (6, s) are (s,)."""
    return np.asarray(np.where(loop.revolute[:, None], np.abs(q.imag), np.log1p(np.abs(q))).max(axis=0))


def _on_line(start: Points, target: Points, u: Array, bend: Complex) -> tuple[Complex, Complex]:
    """L6's columns (4, 3, s) at u (s,), and the twist (6, s) -b by which joints must move as u falls.

    The place on the line is w = γ u / (1 - u + γ u), γ being the bend (s,).
    """
    rate = target.r - start.r
    below = 1.0 / (1.0 + (bend - 1.0) * u)
    w = bend * u * below
    r = target.r - w * rate
    _, x, y, z = r
    n = 1.0 / (r * r).sum(axis=0)
    rw, rx, ry, rz = 2.0 * n * r
    L = np.empty((4, 3, len(u)), dtype=np.complex128)
    L[0, 0], L[1, 1], L[2, 2] = 1.0 - ry * y - rz * z, 1.0 - rx * x - rz * z, 1.0 - rx * x - ry * y
    L[0, 1], L[1, 0] = rx * y + rw * z, rx * y - rw * z
    L[0, 2], L[2, 0] = rx * z - rw * y, rx * z + rw * y
    L[1, 2], L[2, 1] = ry * z + rw * x, ry * z - rw * x
    slide = target.p - start.p
    L[3] = target.p - w * slide
    b = np.empty((6, len(u)), dtype=np.complex128)
    np.einsum("ics,cs->is", L[:3], slide, out=b[:3])
    a, d, e, f = rate
    b[3] = rw * d - rx * a - ry * f + rz * e
    b[4] = rw * e - ry * a - rz * d + rx * f
    b[5] = rw * f - rz * a - rx * e + ry * d
    b *= -bend * below * below
    return L, b


def points_at(loop: Loop, values: Complex) -> Points:
    """The points of the targets that complex joint values (6, s) [rad | size] reach."""
    return points_of(closing_at(loop, values.T))
