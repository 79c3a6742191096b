"""Six joints, three consecutive revolute ones of which have parallel axes.

The loop is read so that it says J_a A J_b B J_c C S D = I, S = J1 L1 J2 L2 J3 the three joints with parallel (or
opposite) axes. They may stand anywhere (a loop read backwards is a loop); what depends on the target is A or D.

The direction. S keeps z but for a sign σ. With h = R_Dᵀ z and u = σ R_C z that is

    R_bᵀ R_Aᵀ R_aᵀ h = R_B R_c u,

the direction of the parallel axes in the middle of the loop, seen from both sides. The height: along that direction
S moves by a constant η, and so

    (R_aᵀ h) · t_A + (R_c u) · (R_Bᵀ t_B) + u · t_C + t_D,z + σ η = 0.

1. a, b, c revolute. The z of the direction, which b leaves alone, and the height are linear in the cosines and sines
   of q_a and q_c:  f(q_a) + G (cos q_c, sin q_c) = 0  with a constant 2×2 matrix G.
   G of rank 2: (cos q_c, sin q_c) = -G⁻¹f has length 1: one equation of the second degree in q_a, up to four solutions.
   G of rank 1 (UR, read from the hand: the wrist's axes 4 and 5 meet): one combination is free of q_c and linear in
   cos q_a, sin q_a, two solutions; the other then gives q_c, two more. The square is never formed.
   Last, b turns one of the two directions to the other.
2. One of a, b, c prismatic: the direction is a matter of the two that turn (two_turns: two solutions), and the height
   is linear in the length. With more prismatic joints the hand keeps a direction, and the arm is singular everywhere.

The plane. Seen along its axes S is a planar arm of two links, l1 and l2, and a hand: up to two elbows.
At most 4 · 2 = 8 solutions.

Degenerate: where the direction is that of axis b (UR: q5 = 0), four axes are parallel and b is free to turn as far
as the elbow reaches. A lever of the length 1e-16 would decide q_b; so there, besides what rounding decides, b is set
to 0 if the elbow reaches, else to the middle of what it reaches, and mirrored: a point on every branch of the family.
Where q_a's equation, or a length's, says nothing, a fan of values is tried, and the elbow chooses.

Reference: the conditions are those of Duffy, "Analysis of Mechanisms and Robot Manipulators", 1980, for loops with
parallel axes; that they are linear at every position, prismatic joints included, is the derivation above.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.closed_form.backwards import backwards, backwards_closing
from robokin.inverse.closed_form.equation_pair import RANK, Pair
from robokin.inverse.closed_form.gather import (
    Marks,
    chosen_positions,
    gathered,
    in_front,
    joined,
    turn_in_front,
)
from robokin.inverse.closed_form.joint_functions import (
    FAN,
    LENGTHS,
    LOOSE,
    Form,
    Motion,
    Prismatic,
    Revolute,
    combined,
    kind,
    loose,
    seen_turned,
    square_across,
)
from robokin.inverse.closed_form.loop_axes import ORDINALS, SingularEverywhereError, tilt
from robokin.inverse.closed_form.planar_elbow import PlanarElbow
from robokin.inverse.closed_form.trigonometry import (
    Turn,
    linear_roots,
    normalized,
    turn_between,
)
from robokin.inverse.closed_form.turns import two_turns
from robokin.inverse.elimination.loop import Candidates, Loop
from robokin.kernel.entries import (
    Entry,
    EntryFrame,
    Matrix,
    Vector,
    applied,
    applied_back,
    columns,
    constant,
    dot,
    moved_back,
    multiplied,
    plus,
    taken,
    times,
    transposed,
)  # fmt: skip

PARALLEL = 1e-9
"""Axes at less than this angle [rad] are parallel: tables of decimal fractions and degrees are good to
1e-12, those of measured arms no better than 1e-5."""


class ThreeParallel:
    """The solver for a loop whose joints first, first + 1, first + 2 (first: 0 to 3) have parallel axes."""

    method = "three parallel axes"

    def __init__(self, loop: Loop, first: int) -> None:
        self.first = first
        self.deviation = tilt(loop, first)
        self.sentence = f"axes {ORDINALS[first]} are parallel"
        self.reversed = first in (0, 1)
        if self.reversed:
            loop, first = backwards(loop), 3 - first
        links = [constant(L) for L in loop.links]
        self.joints = (0, 1, 2, 3, 4, 5) if first == 3 else (5, 0, 1, 2, 3, 4)
        self.a, self.b, self.c = (kind(bool(loop.revolute[i])) for i in self.joints[:3])
        self.free = 1 if self.b is Revolute else 0
        self.A = links[0] if first == 3 else None
        self.B, self.C = links[self.joints[1]], links[self.joints[2]]
        self.D = links[4] if first == 2 else None
        self.elbow = PlanarElbow(loop.links[self.joints[3]], loop.links[self.joints[4]])
        self.u = [times(self.elbow.sign, row[2]) for row in self.C.R]
        self._prepare_direction()

    @classmethod
    def find(cls, loop: Loop, tolerance: float = PARALLEL) -> ThreeParallel | None:
        """The solver if three consecutive revolute axes are parallel within the tolerance [rad], or None."""
        found = []
        for first in range(4):
            if loop.revolute[first : first + 3].all() and tilt(loop, first) <= tolerance:
                try:
                    found.append(cls(loop, first))
                except SingularEverywhereError:
                    continue
        return min(found, key=lambda solver: (solver.rank, solver.deviation), default=None)

    def _prepare_direction(self) -> None:
        """What the direction and the height have of q_c."""
        if sum(joint is Revolute for joint in (self.a, self.b, self.c)) < 2:
            raise SingularEverywhereError
        self.beta = [self.B.R[2], applied_back(self.B.R, self.B.t)]
        self.rank = 0
        if self.c is not Revolute and abs(float(self.u[2])) < RANK:
            raise SingularEverywhereError
        if self.c is not Revolute or self.a is not Revolute or self.b is not Revolute:
            return
        (k_c, k_s), (l_c, l_s) = (self._lever_of_c(beta) for beta in self.beta)
        self.G = Pair([(-k_c, -k_s), (l_c, l_s)])
        self.height = l_c, l_s
        self.direct = math.hypot(k_c, k_s) >= RANK
        self.rank = self.G.rank
        if self.rank == 0:
            raise SingularEverywhereError

    def _lever_of_c(self, beta: Vector) -> tuple[float, float]:
        """What (R_c u) · β has of cos q_c and sin q_c."""
        x, y = (float(part) for part in self.u[:2])
        beta_x, beta_y = (float(part) for part in beta[:2])
        return x * beta_x + y * beta_y, x * beta_y - y * beta_x

    def candidates(self, closing: Array) -> Candidates:
        """Every solution for the targets of L6: closing (m, 4, 4)."""
        with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
            target = columns(closing)
            if self.reversed:
                target = backwards_closing(target)
            A = self.A or target
            D = self.D or target
            index = np.arange(len(closing))
            marks = Marks(len(closing))
            if not self.rank:
                return marks.on(self._sliding(A, D, index, marks))
            f = self.equations(A, D)
            q_a, real, loose = self._first(f)
            found = self._from_first(A, D, f, q_a, real, index, marks)
            if loose is None:
                return marks.on(found)
            marks.loose |= loose
            # q_a's equation says nothing: whatever q_a the others can serve.
            index = index[np.broadcast_to(loose, index.shape)]
            real = np.ones((len(FAN), 1), dtype=bool)
            A, D = taken(A, index), taken(D, index)
            more = self._from_first(A, D, self.equations(A, D), Revolute.fan, real, index, marks)
            return marks.on(joined(found, more))

    def _offset(self, D: EntryFrame) -> Entry:
        """What the height has of no joint."""
        return plus(plus(D.t[2], dot(self.u, self.C.t)), self.elbow.sign * self.elbow.eta)

    def equations(self, A: EntryFrame, D: EntryFrame) -> list[Form]:
        """f(q_a), case 1: direction and height less what they have of cos q_c and sin q_c."""
        h, u, beta = D.R[2], self.u, self.beta
        return [
            combined((1.0, -1.0), (seen_turned(h, [row[2] for row in A.R]), [times(u[2], beta[0][2])])),
            combined((1.0, 1.0, 1.0), (seen_turned(h, A.t), [times(u[2], beta[1][2])], [self._offset(D)])),
        ]

    def _first(self, f: list[Form]) -> tuple[Motion, Flags, Flags | None]:
        """All q_a, which are real, and for which targets q_a is not determined."""
        if self.rank == 2:
            products = [Revolute.product(part, part) for part in (combined(row, f) for row in self.G.inverse)]
            equation = combined((1.0, 1.0, -1.0), (*products, [1.0]))
        else:
            equation = combined((1.0, -self.G.ratio), (f[self.G.rest], f[self.G.main]))
        return *Revolute.roots(equation), loose(equation)

    def _from_first(
        self, A: EntryFrame, D: EntryFrame, f: list[Form], q_a: Motion, real: Flags, index: Index, marks: Marks
    ) -> Candidates:
        """The candidates for given q_a, case 1."""
        w = applied_back(A.R, Revolute.back(q_a, D.R[2]))
        if self.rank == 2:
            # -G⁻¹f
            minus_c, minus_s = (Revolute.at(combined(row, f), q_a) for row in self.G.inverse)
            q_c = normalized(times(-1.0, minus_c), times(-1.0, minus_s))
            q_b = turn_between(applied(self.B.R, Revolute.onward(q_c, self.u)), w)
        else:
            if self.direct:
                q_b, q_c, reached = two_turns(self.B.R, self.u, w)
            else:
                q_c, reached = linear_roots(*self.height, times(-1.0, Revolute.at(f[1], q_a)))
                q_c = turn_in_front(q_c, real)
                q_b = turn_between(applied(self.B.R, Revolute.onward(q_c, self.u)), w)
            q_b, q_c = (turn_in_front(turn, real) for turn in (q_b, q_c))
            real = real[None] & in_front(reached, real)
        marks.short(w[0], w[1], index)
        return self._elbows_and_families(A, D, (q_a, q_b, q_c), real, square_across(w), index, marks)

    def _directions(self, A: EntryFrame, D: EntryFrame) -> tuple[Matrix, Vector, Vector]:
        """P, s and w of Rz(α) P Rz(β) s = w, case 2."""
        if self.b is Prismatic:
            return multiplied(A.R, self.B.R), self.u, D.R[2]
        if self.a is Prismatic:
            return self.B.R, self.u, applied_back(A.R, D.R[2])
        return transposed(A.R), D.R[2], applied(self.B.R, self.u)

    def _sliding(self, A: EntryFrame, D: EntryFrame, index: Index, marks: Marks) -> Candidates:
        """The candidates, case 2."""
        P, s, w = self._directions(A, D)
        alpha, beta, real = two_turns(P, s, w)
        found = self._from_turns(A, D, alpha, beta, real, index, marks)
        aligned = np.asarray(times(square_across(P[2]), square_across(s)) < LOOSE**2) & real[0]
        if not aligned.any():
            return found
        # Two axes are parallel: β turns the direction about itself, or α undoes what β does.
        chosen = np.flatnonzero(np.broadcast_to(aligned, index.shape))
        A, D, index = taken(A, chosen), taken(D, chosen), index[chosen]
        marks.loose[index] = True
        P, s, w = self._directions(A, D)
        fan = Revolute.fan
        alpha = turn_between(applied(P, Revolute.onward(fan, s)), w)
        every = np.ones((len(FAN), 1), dtype=bool)
        return joined(found, self._from_turns(A, D, alpha, fan, every, index, marks))

    def _from_turns(
        self, A: EntryFrame, D: EntryFrame, alpha: Motion, beta: Motion, real: Flags, index: Index, marks: Marks
    ) -> Candidates:
        """The candidates for given α and β, case 2: the height gives the length."""
        h, u = D.R[2], self.u
        before: Vector
        after: Vector
        if self.b is Prismatic:
            q_a, q_c = alpha, beta
            before, after = Revolute.back(q_a, h), Revolute.onward(q_c, u)
            slope, lever = applied_back(A.R, before)[2], square_across(h)
        elif self.a is Prismatic:
            q_b, q_c = alpha, beta
            before, after = h, Revolute.onward(q_c, u)
            slope, lever = h[2], square_across(applied_back(A.R, h))
        else:
            # Rz(-q_b) R_Aᵀ Rz(-q_a) h = R_B u.
            q_b, q_a = (alpha[0], times(-1.0, alpha[1])), (beta[0], times(-1.0, beta[1]))
            before, after = Revolute.back(q_a, h), u
            slope, lever = u[2], square_across(applied(self.B.R, u))
        height = plus(plus(dot(before, A.t), dot(after, self.beta[1])), self._offset(D))
        lost = np.abs(np.asarray(slope)) < RANK
        length: Motion = (np.where(lost, 0.0, np.asarray(times(-1.0, height)) / np.where(lost, 1.0, slope)),)
        positions: Sequence[Motion]
        if self.b is Prismatic:
            positions = q_a, length, q_c
        else:
            positions = (length, q_b, q_c) if self.a is Prismatic else (q_a, q_b, length)
        marks.short(slope, 0.0, index)
        found = self._elbows_and_families(A, D, positions, real, lever, index, marks)
        lost = lost & real & (np.abs(np.asarray(height)) < LOOSE)
        if not lost.any():
            return found
        # The sliding axis is at right angles to the direction: whatever length the elbow can serve.
        here, chosen = chosen_positions(positions, lost)
        here[[self.a, self.b, self.c].index(Prismatic)] = Prismatic.fan
        marks.loose[index[chosen]] = True
        every = np.ones((len(LENGTHS), 1), dtype=bool)
        return joined(found, self._plane(taken(A, chosen), taken(D, chosen), here, every, index[chosen]))

    def _elbows_and_families(
        self,
        A: EntryFrame,
        D: EntryFrame,
        positions: Sequence[Motion],
        real: Flags,
        lever: Entry,
        index: Index,
        marks: Marks,
    ) -> Candidates:
        """The candidates for given positions of a, b, c; lever: the squared sine that decides the free joint's."""
        found = self._plane(A, D, positions, real, index)
        free = real & np.asarray(lever < LOOSE**2)
        if not free.any():
            return found
        here, chosen = chosen_positions(positions, free)
        marks.loose[index[chosen]] = True
        return joined(found, self._family(taken(A, chosen), taken(D, chosen), here, index[chosen]))

    def _plane(
        self, A: EntryFrame, D: EntryFrame, positions: Sequence[Motion], real: Flags, index: Index
    ) -> Candidates:
        """The candidates for given positions of a, b and c."""
        p, across = self.seen_from_first(A, D, positions)
        turn, reached = self.elbow.roots(p)
        turn = turn_in_front(turn, real)
        joints = (self.a, self.b, self.c)
        values = [joint.value(position) for joint, position in zip(joints, positions, strict=True)]
        values += self.elbow.values(p, across, turn)
        order = [5 - j for j in self.joints] if self.reversed else list(self.joints)
        return gathered(index, dict(zip(order, values, strict=True)), real[None] & in_front(reached, real))

    def seen_from_first(self, A: EntryFrame, D: EntryFrame, positions: Sequence[Motion]) -> tuple[Vector, Vector]:
        """x and y of S's origin and of its x axis: those of C⁻¹ J_c⁻¹ B⁻¹ J_b⁻¹ A⁻¹ J_a⁻¹ D⁻¹."""
        p: Vector = moved_back(D, [0.0, 0.0, 0.0])
        x: Vector = D.R[0]
        joints = (self.a, self.b, self.c)
        for joint, position, link in zip(joints, positions, (A, self.B, self.C), strict=True):
            p = moved_back(link, joint.back(position, p))
            x = applied_back(link.R, joint.back_direction(position, x))
        return p[:2], x[:2]

    def _family(self, A: EntryFrame, D: EntryFrame, positions: Sequence[Motion], index: Index) -> Candidates:
        """Candidates where the free joint (b, or a if b slides) sees nothing but the reach of the elbow."""

        def with_turn(turn: Turn) -> list[Motion]:
            return [turn if j == self.free else position for j, position in enumerate(positions)]

        def point(turn: Turn) -> Array:
            x, y = self.seen_from_first(A, D, with_turn(turn))[0]
            return np.asarray(x + 1j * np.asarray(y))

        turn, real = self.elbow.reaching(point((1.0, 0.0)), point((0.0, 1.0)), point((-1.0, 0.0)))
        return self._plane(A, D, with_turn(turn), real, index)
