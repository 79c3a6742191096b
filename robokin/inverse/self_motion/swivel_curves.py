"""The self-motions of an arm with a spherical shoulder and wrist (`swivel_arm`) as functions of the swivel angle.

Statement. For poses T give every configuration of the arm as a function of the swivel angle ψ and of three signs: of
the elbow, of the shoulder's middle turn and of the wrist's.
Derivation. At one elbow the upper arm sees W - S as v, and the base sees it as p, of the same length. With
orthonormal ê, f̂ = v̂ × ê in the upper arm, ê towards the elbow, and r̂, n̂ = p̂ × r̂ in the base, r̂ towards axis 1, the
upper arm stands at

    R(ψ) = p̂ v̂ᵀ + cos ψ (r̂ êᵀ + n̂ f̂ᵀ) + sin ψ (n̂ êᵀ - r̂ f̂ᵀ),

which turns v to p, and the elbow by ψ about the line from S to W, from the half plane that axis 1 points into. The hand
in the forearm follows from the transpose. The turns of a triple need the third column and the third row of its matrix
only: ten numbers that are each A cos ψ + B sin ψ + C.
Degenerate case. Of a straight elbow, which is a double root, there is one set of curves; ψ then counts from where the
elbow bends. With W on axis 1 it counts from the base's x axis. With W in S there is no line, and where a middle turn
comes to zero its neighbours turn about one axis: there, and next to it, `doubt` says so.
Entry by entry: those of one pose are floats, those of many are columns. `native/swivel.c` has the same steps.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.self_motion.swivel_arm import SwivelArm
from robokin.inverse.self_motion.swivel_turns import entries_at, joint_values
from robokin.kernel.facts import fact
from robokin.kernel.frames import frames
from robokin.kernel.spared_products import minus, plus, times
from robokin.rotation_entries import Floats

TURN = 2.0 * np.pi

NO_LINE = 1e-3
"""A distance from S to W, as a part of the size, below which W is next to S: a pose's error of 1e-9, what solutions may
have, turns the arm by 1e-6 there."""

ON_LINE = 1e-9
"""The same of the elbow from the line: where ψ is zero is then known to 1e-7, which is no more than a name."""

OFF_LINE = 1e-4
"""Where W is on axis 1, or the elbow on the line, by less than `ON_LINE`, another direction says where ψ is zero; from
here on theirs does. Between the two ψ has no name that would be the same for a pose next to it."""

STRAIGHT = 1e-14
"""How near to 1 the cosine of an elbow is for its two values to be one: some times the rounding of a pose. They are
1.4e-7 from straight then, and configurations 10 times that off at most, by `FIRM`."""

BENT = 5e-7
"""How far from 1 it must be otherwise, 1e-3 rad: an error of 1e-9 that a pose may have moves joints by 1e-6 there."""

ALIGNED = 5e-7
"""How near to 1 the cosine of a middle turn may come, 1e-3 rad: the same of its neighbours."""

FIRM = 0.1
"""With a straight elbow, which may be 1.4e-7 from straight, the least sine of a middle turn and the least distance from
S to W as a part of the size: joints are known to 1e-5 then, and to 1e-3 with what an error of the pose adds."""

SIGNS = np.array([1.0, -1.0])
"""Of the first and of the second value of an elbow or of a middle turn."""

UP, AHEAD = (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)
"""Axis 1, and the direction that ψ counts from where W is on it, in the base."""

Vector = Any
"""Three entries, floats or columns (m,)."""


class OnePose(Floats):
    """The functions of floats that the curves of one pose ask for, with the last digits that numpy gives many."""

    arccos = staticmethod(lambda x: float(np.arccos(x)))
    cos = staticmethod(lambda angle: float(np.cos(angle)))
    sin = staticmethod(lambda angle: float(np.sin(angle)))
    any = staticmethod(bool)


@dataclass(frozen=True, eq=False)
class SwivelCurves:
    """Curves of configurations for m poses.

    q4: (m, 2) the elbows [rad], offset included; real: (m, 2) which of them there are; entries: (m, 2, 2, 5, 3) for
    each elbow and triple the factors of 1, cos ψ and sin ψ in the entries 13, 23, 33, 31, 32 of its matrix; doubt: (m,)
    where an elbow is nearly straight, or hardly has a ψ, or a middle turn comes near zero; straight: (m,) where the
    elbow is taken for straight; axes: (m, 3, 3) the columns p̂, r̂, n̂ in the base, from which ψ counts; bend: (m, 2, 3)
    ê in the frame after joint 3, by which it does.
    """

    arm: SwivelArm
    q4: Array
    real: Flags
    entries: Array
    doubt: Flags
    straight: Flags
    axes: Array
    bend: Array

    def of(self, some: slice) -> SwivelCurves:
        """Those of some poses."""
        return SwivelCurves(
            self.arm,
            self.q4[some],
            self.real[some],
            self.entries[some],
            self.doubt[some],
            self.straight[some],
            self.axes[some],
            self.bend[some],
        )

    def entries_at(self, psi: Array) -> Array:
        """(5, m, 2, 2, K) the entries 13, 23, 33, 31, 32 of the triples at ψ (m, 2, K), by elbow and triple."""
        return entries_at(self.entries.transpose(4, 3, 0, 1, 2)[..., None], psi[:, :, None])

    def configurations(self, row: Index, signs: Index, psi: Array) -> Array:
        """(s, 7) [rad] in [-π, π] the joint values at ψ (s,) of poses (s,).

        signs: (s, 3) by their places in `SIGNS`: of the elbow, the shoulder, the wrist.
        """
        elbow = signs[:, 0]
        factors = self.entries[row, elbow].transpose(3, 2, 1, 0)
        return joint_values(self.arm, factors, self.q4[row, elbow], SIGNS[signs[:, 1:].T], psi)

    def swivel(self, row: Index, elbow: Index, q: Array) -> Array:
        """(s,) ψ [rad] in [-π, π] of configurations q (s, 7) or (7,) [rad] that reach poses (s,) with elbows (s,)."""
        constants = self.arm.chain.constants
        upper = constants[0][:3, :3].T @ frames(self.arm.chain, np.atleast_2d(q))[:, 3, :3, :3] @ constants[3][:3, :3].T
        bend = (upper @ self.bend[row, elbow, :, None])[..., 0]
        seen = (bend[:, None] @ self.axes[row])[:, 0]
        return np.asarray(np.arctan2(seen[:, 2], seen[:, 1]))


@dataclass(frozen=True)
class PlainArm:
    """What of an arm does not depend on a pose, as floats, in the order in which `native/swivel_forms.c` takes them.

    Matrices are rows. seen: S as C3 has it; forearm, forearm_origin: C3; next: C4.
    """

    base: Any
    origin: Vector
    wrist: Vector
    shoulder: Vector
    hand: Any
    seen: Vector
    lower: Vector
    forearm: Any
    forearm_origin: Vector
    next: Any
    upper: Vector
    elbow: Vector


@fact
def plain_arm(arm: SwivelArm) -> PlainArm:
    """The numbers of an arm that its curves are made of."""
    C = arm.chain.constants
    seen = C[3][:3, :3].T @ (arm.upper - C[3][:3, 3])
    numbers = [
        C[0][:3, :3], C[0][:3, 3], arm.wrist, arm.shoulder, arm.hand, seen, arm.lower,
        C[3][:3, :3], C[3][:3, 3], C[4][:3, :3], arm.upper, arm.elbow,
    ]  # fmt: skip
    return PlainArm(*(number.tolist() for number in numbers))


def swivel_curves(arm: SwivelArm, T: Array) -> SwivelCurves:
    """The self-motions at poses T (m, 4, 4) [m]."""
    m = len(T)
    t: Any = T.reshape(16).tolist() if m == 1 else T.reshape(m, 16).T
    q4, real, entries, doubt, straight, axes, bends = curves_by_entry(arm, t, OnePose if m == 1 else np)
    numbers = [*entries, *q4, *bends, *axes]
    table = np.empty((m, len(numbers)))
    for column, number in zip(table.T, numbers, strict=True):
        column[:] = number
    table += 0.0  # of -0 that is 0, whatever a pose alone comes by
    entries, values, bend, axes = table[:, :60], table[:, 60:62], table[:, 62:68], table[:, 68:]
    flags = np.array([*real, straight, doubt]).reshape(4, m)
    shaped = entries.reshape(m, 2, 2, 5, 3), flags[3], flags[2], axes.reshape(m, 3, 3), bend.reshape(m, 2, 3)
    return SwivelCurves(arm, values, flags[:2].T, *shaped)


def curves_by_entry(arm: SwivelArm, t: Any, maths: Any) -> tuple[Any, ...]:
    """What `SwivelCurves` holds, by the entries t of a target [m], row after row: q4, real, entries, doubt, straight,
    axes, bend."""
    a, size = plain_arm(arm), arm.size
    R = (t[0:3], t[4:7], t[8:11])
    turned = _times(R, a.wrist)
    p = _backwards(a.base, [minus(plus(turned[r], t[4 * r + 3]), a.origin[r]) for r in range(3)])
    p = [minus(p[r], a.shoulder[r]) for r in range(3)]
    hand = [_backwards(a.base, _times(R, column)) for column in zip(*a.hand, strict=True)]
    square = _dot(p, p)
    length, off = maths.sqrt(square), maths.hypot(p[0], p[1])
    q4, real, straight, doubt = _elbows(a, square, maths)
    doubt = doubt | (straight & (length < FIRM * size)) | (length < NO_LINE * size)
    # The base's axes.
    beside = off >= ON_LINE * length
    doubt = doubt | (beside & (off < OFF_LINE * length))
    p_axes, _ = _axes(p, [maths.where(beside, *pair) for pair in zip(UP, AHEAD, strict=True)], maths)
    along = [[_dot(axis, column) for column in hand] for axis in p_axes]
    straightest = maths.where(straight, 1.0 - math.sqrt(1.0 - FIRM**2), ALIGNED)
    numbers: list[Any] = []
    bends: list[Any] = []
    for e in range(2):
        triples, bend, far = _triples_at(a, size, q4[e], p_axes, along, maths)
        doubt = doubt | (real[e] & (far >= ON_LINE * size) & (far < OFF_LINE * size))
        for entry, k, r in zip(triples, arm.triples.k.tolist(), arm.triples.r.tolist(), strict=True):
            swing, middle = maths.hypot(entry[7], entry[8]), minus(entry[6], k)
            nearest = maths.minimum(r - (middle + swing), r + (middle - swing)) / r
            doubt = doubt | (real[e] & (nearest < straightest))
            numbers += entry
        bends += bend
    return q4, real, numbers, doubt, straight, [axis[r] for r in range(3) for axis in p_axes], bends


def _elbows(a: PlainArm, square: Any, maths: Any) -> tuple[list[Any], list[Any], Any, Any]:
    """The two values of joint 4, offset included, that |W - S|² allows; whether there are; whether they are taken for
    one; and doubt.

    |W - S|² = |w|² + |s|² - 2 sᵀ Rz(q4) w, with W and S seen from both sides of the joint.
    """
    s, w = a.seen, a.lower
    cosine, sine = s[0] * w[0] + s[1] * w[1], s[1] * w[0] - s[0] * w[1]
    wave = (0.5 * (_dot(s, s) + _dot(w, w) - square) - s[2] * w[2]) / Floats.hypot(cosine, sine)
    past = abs(wave) - 1.0
    straight, bent = abs(past) <= STRAIGHT, abs(past) > STRAIGHT
    amid = math.atan2(sine, cosine)
    side = maths.arccos(maths.maximum(-1.0, maths.minimum(maths.where(straight, maths.rint(wave), wave), 1.0)))
    real = [straight | (past < 0.0), bent & (past < 0.0)]
    return [amid + side, amid - side], real, straight, bent & (abs(past) < BENT)


def _triples_at(
    a: PlainArm, size: float, q4: Any, p_axes: list[Vector], along: list[Vector], maths: Any
) -> tuple[tuple[list[Any], list[Any]], Vector, Any]:
    """The factors of both triples at an elbow q4, offset included, one after the other; ê; how far the elbow is off the
    line.

    p_axes: p̂, r̂, n̂ in the base; along: the hand's columns along each of these.
    """
    c4, s4, w = maths.cos(q4), maths.sin(q4), a.lower
    v = _times(a.forearm, [_wedge(c4, w[0], s4, w[1]), plus(times(s4, w[0]), times(c4, w[1])), w[2]])
    v = [minus(plus(v[r], a.forearm_origin[r]), a.upper[r]) for r in range(3)]
    v_axes, far = _axes(v, a.elbow, maths)
    on_line = far < ON_LINE * size
    if maths.any(on_line):
        across = _cross([row[2] for row in a.forearm], v)
        towards = [maths.where(on_line, *pair) for pair in zip(across, a.elbow, strict=True)]
        v_axes, _ = _axes(v, towards, maths)
    # The forearm's frame sees v̂, ê, f̂: backwards through C3, Rz(q4), C4.
    seen = []
    for column in v_axes:
        x = _backwards(a.forearm, column)
        turned = [plus(times(c4, x[0]), times(s4, x[1])), _wedge(c4, x[1], s4, x[0]), x[2]]
        seen.append(_backwards(a.next, turned))
    last = [row[2] for row in along]
    shoulder = _swung(p_axes, [axis[2] for axis in v_axes], 1.0, 3)
    shoulder += _swung(v_axes, [axis[2] for axis in p_axes], -1.0, 2)
    wrist = _swung(seen, last, -1.0, 3)
    wrist += _swung(along, [axis[2] for axis in seen], 1.0, 2)
    return (shoulder, wrist), v_axes[1], far


def _dot(a: Vector, b: Vector) -> Any:
    return plus(plus(times(a[0], b[0]), times(a[1], b[1])), times(a[2], b[2]))


def _cross(a: Vector, b: Vector) -> Vector:
    return [_wedge(a[1], b[2], a[2], b[1]), _wedge(a[2], b[0], a[0], b[2]), _wedge(a[0], b[1], a[1], b[0])]


def _wedge(a: Any, b: Any, c: Any, d: Any) -> Any:
    """a b - c d."""
    return minus(times(a, b), times(c, d))


def _times(A: Any, x: Vector) -> Vector:
    """A x of a matrix as rows."""
    return [_dot(row, x) for row in A]


def _backwards(A: Any, x: Vector) -> Vector:
    """Aᵀ x of a matrix as rows."""
    return [_dot(column, x) for column in zip(*A, strict=True)]


def _over(a: Any, b: Any) -> Any:
    """a / b."""
    return 0.0 if isinstance(a, float) and a == 0.0 else a / b


def _axes(line: Vector, towards: Vector, maths: Any) -> tuple[list[Vector], Any]:
    """Orthonormal directions along the line, at right angles to it towards something, across; and how far that is from
    the line."""
    length = maths.maximum(maths.sqrt(_dot(line, line)), 1e-300)
    first = [_over(entry, length) for entry in line]
    along = _dot(towards, first)
    second = [minus(towards[r], times(along, first[r])) for r in range(3)]
    along = _dot(second, first)  # what rounding left, of a nearly straight elbow
    second = [minus(second[r], times(along, first[r])) for r in range(3)]
    off = maths.sqrt(_dot(second, second))
    length = maths.maximum(off, 1e-300)
    second = [_over(entry, length) for entry in second]
    return [first, second, _cross(first, second)], off


def _swung(axes: list[Vector], other: Vector, sign: float, rows: int) -> list[Any]:
    """The factors of 1, cos ψ and sin ψ in the first rows of R(±ψ) x, one row after the other.

    axes: what its own come to; other: x in these.
    """
    out = []
    for r in range(rows):
        out.append(times(axes[0][r], other[0]))
        out.append(plus(times(axes[1][r], other[1]), times(axes[2][r], other[2])))
        out.append(times(sign, _wedge(axes[2][r], other[1], axes[1][r], other[2])))
    return out
