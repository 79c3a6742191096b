"""Six joints, three consecutive revolute ones of which turn about one point.

The loop is read so that it says J_a A J_b B J_c C S D = I, S = J1 P J2 Q J3 the three joints whose axes
meet in a point w. The other three are revolute or prismatic in any mixture; the three may come first, in
the middle or last (a loop read backwards is a loop), and what depends on the target is either B or D.

The point. S carries w, as its last joint sees it, to w as its first joint sees it, so with u = C w, g = D⁻¹ w

    J_a A J_b B J_c u = g.

With v = B J_c u, a function of q_c, and y = J_b v it reads A y + t = J_a⁻¹ g (A the rotation, t the translation).
What J_a leaves alone gives two equations, linear in y and |y|²:

    a revolute   r3 · y = g_z - t_z,    2 (Aᵀt) · y + |y|² = |g|² - |t|²      (r1, r2, r3 the rows of A)
    a prismatic  r1 · y = g_x - t_x,    r2 · y = g_y - t_y

1. b revolute: y_z = v_z and |y|² = |v|² are functions of q_c as well, and what remains is

       N y_xy = e(q_c)    with a constant 2×2 matrix N.

   N of rank 2: y_xy = N⁻¹e and |y_xy|² = |v|² - v_z², one equation in q_c of the second degree in its cosine and sine
   (of the fourth in its length): up to four solutions. Where v_z and |v|² vary with one and the same n_c cos q_c +
   n_s sin q_c (b and c parallel: most arms with an offset shoulder), it is quadratic in that, and then linear.
   N of rank 1 (a meets b or is parallel to it: PUMA): one combination of the two equations is free of y and linear in
   cos q_c, sin q_c, two solutions; the other is n · y_xy = ε, with |y_xy| known two more. The equation of rank 2 would
   be a square here, its double roots worth half of the digits, and is never formed.
   N of rank 0: a and b are one axis, and the arm singular everywhere.
2. b prismatic: y_xy = v_xy, and y_z = ζ is unknown in its place. Where the first equation (a prismatic: one of the
   two) contains ζ it is ζ = ζ(q_c), put into the other; else it is an equation in q_c alone, and the other one in ζ.

q_b turns v_xy to y_xy (or is ζ - v_z), q_a turns (A y + t)_xy to g_xy (or is g_z - (A y + t)_z).

The orientation. S = (J_a A J_b B J_c C)ᵀ Dᵀ: three turns, two solutions (turns.py). At most 4 · 2 = 8 solutions.

Degenerate: where v_xy = 0 (the point on axis b) q_b is free, where g_xy = 0 (on axis a) q_a. They are 0 then, and
stand for a family; a wrist that does not reach every orientation chooses from a fan of values. Where q_c's equation
says nothing a fan of q_c is tried, and the others choose.

Reference: D. L. Pieper, "The kinematics of manipulators under computer control", Stanford AI Memo 72, 1968.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.closed_form.backwards import backwards, backwards_closing
from robokin.inverse.closed_form.equation_pair import Pair
from robokin.inverse.closed_form.gather import (
    Marks,
    chosen_positions,
    gathered,
    in_front,
    joined,
)
from robokin.inverse.closed_form.joint_functions import (
    FAN,
    LOOSE,
    Form,
    Motion,
    Prismatic,
    Revolute,
    combined,
    kind,
    loose,
    parallel_gradient,
)
from robokin.inverse.closed_form.loop_axes import ORDINALS, SingularEverywhereError, meeting_point
from robokin.inverse.closed_form.trigonometry import (
    CLAMP,
    both,
    linear_roots,
    quadratic_roots,
    turn_between,
)
from robokin.inverse.closed_form.turns import right_angled, three_turns
from robokin.inverse.elimination.loop import Candidates, Loop
from robokin.kernel.entries import (
    Entry,
    EntryFrame,
    Vector,
    applied_back,
    columns,
    constant,
    dot,
    minus,
    moved,
    moved_back,
    plus,
    root,
    taken,
    times,
    transposed,
)

GEOMETRIC = 1e-9
"""Axes that pass each other at less than this (in units of the arm's size) meet: tables of decimal
fractions and degrees are good to 1e-12, those of measured arms no better than 1e-5."""

Equations = tuple[list[Form], Form, list[Form]]


class SphericalTriple:
    """The solver for a loop whose joints first, first + 1, first + 2 (first: 0 to 3) meet in a point."""

    def __init__(self, loop: Loop, first: int) -> None:
        self.first = first
        self.deviation, _, _ = meeting_point(loop, first)
        self.method = ("spherical shoulder", "spherical elbow", "spherical elbow", "spherical wrist")[first]
        self.sentence = f"axes {ORDINALS[first]} meet in one point"
        self.reversed = first in (0, 2)
        if self.reversed:
            loop, first = backwards(loop), 3 - first
        links = [constant(L) for L in loop.links]
        self.joints = (0, 1, 2, 3, 4, 5) if first == 3 else (4, 5, 0, 1, 2, 3)
        self.a, self.b, self.c = (kind(bool(loop.revolute[i])) for i in self.joints[:3])
        self.A, self.C = links[self.joints[0]], links[self.joints[2]]
        self.B = links[1] if first == 3 else None
        self.D = links[3] if first == 1 else None
        self.P, self.Q = links[self.joints[3]].R, links[self.joints[4]].R
        _, self.near, self.far = meeting_point(loop, first)
        self.prepare()

    @classmethod
    def find(cls, loop: Loop, tolerance: float = GEOMETRIC) -> SphericalTriple | None:
        """The solver if three consecutive revolute axes meet within the tolerance [size], or None."""
        found = []
        for first in meeting_triples(loop, tolerance):
            try:
                found.append(cls(loop, first))
            except SingularEverywhereError:
                continue
        return min(found, key=lambda solver: (solver.cost, solver.deviation), default=None)

    def prepare(self) -> None:
        """u, the two equations in (y_x, y_y, y_z, |y|²), their right sides less g's part, and how to solve them."""
        self.u = moved(self.C, [0.0, 0.0, self.near])
        r1, r2, r3 = self.A.R
        t = self.A.t
        if self.a is Revolute:
            back = applied_back(self.A.R, t)
            rows = [[*r3, 0.0], [*(times(2.0, part) for part in back), 1.0]]
            self.known = times(-1.0, t[2]), times(-1.0, dot(t, t))
        else:
            rows = [[*r1, 0.0], [*r2, 0.0]]
            self.known = times(-1.0, t[0]), times(-1.0, t[1])
        self.rows = cast(list[list[float]], rows)
        if self.b is Revolute:
            pair = Pair([(row[0], row[1]) for row in self.rows])
        else:
            # ζ in place of y_xy; where the second equation has ζ² the first must serve, if it can.
            pair = Pair([(row[2], 0.0) for row in (self.rows if self.a is Prismatic else [self.rows[0], [0.0] * 3])])
        if pair.rank == 0 and (self.b is Revolute or self.a is Prismatic):
            raise SingularEverywhereError
        self.pair = pair
        self.cost = pair.rank + (3 if self.B is None else 0)

    def candidates(self, closing: Array) -> Candidates:
        """Every solution for the targets of L6: closing (m, 4, 4)."""
        with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
            target = columns(closing)
            if self.reversed:
                target = backwards_closing(target)
            B, D = self.B or target, self.D or target
            index = np.arange(len(closing))
            g = self.point(D)
            equations = self.equations(B, g)
            marks = Marks(len(closing))
            q_c, real, loose = self._third(equations)
            found = self._from_third(B, D, g, equations, q_c, real, index, marks)
            if loose is None:
                return marks.on(found, True)
            marks.loose |= loose
            # q_c's equation says nothing: whatever q_c the others can serve.
            index = index[np.broadcast_to(loose, index.shape)]
            fan = self.c.fan
            every = np.ones(np.shape(fan[0]), dtype=bool)
            B, D = taken(B, index), taken(D, index)
            g = self.point(D)
            more = self._from_third(B, D, g, self.equations(B, g), fan, every, index, marks)
            return marks.on(joined(found, more), True)

    def point(self, D: EntryFrame) -> Vector:
        """g."""
        return moved_back(D, [0.0, 0.0, self.far])

    def _from_third(
        self,
        B: EntryFrame,
        D: EntryFrame,
        g: Vector,
        equations: Equations,
        q_c: Motion,
        real: Flags,
        index: Index,
        marks: Marks,
    ) -> Candidates:
        """The candidates for given q_c."""
        q_b, y, real = self._second(equations, q_c, real)
        x = moved(self.A, y)
        q_a: Motion = turn_between(x, g) if self.a is Revolute else (minus(g[2], x[2]),)
        for kind_of_joint, lever in ((self.a, g), (self.b, y)):
            if kind_of_joint is Revolute:
                marks.short(lever[0], lever[1], index)
        found = self._wrist(B, D, (q_a, q_b, q_c), real, index, marks)
        if right_angled(self.P, self.Q):
            return found
        # Not every orientation is within reach of this wrist, so a free joint must look for those that are.
        for joint, kind_of_joint, lever in ((0, self.a, x), (1, self.b, y)):
            free = plus(times(lever[0], lever[0]), times(lever[1], lever[1])) < LOOSE**2
            if kind_of_joint is Revolute and np.any(free & real):
                positions, chosen = chosen_positions((q_a, q_b, q_c), free & real)
                positions[joint] = Revolute.fan
                every = np.ones((len(FAN), 1), dtype=bool)
                marks.loose[index[chosen]] = True
                fanned = self._wrist(taken(B, chosen), taken(D, chosen), positions, every, index[chosen], marks)
                found = joined(found, fanned)
        return found

    def _wrist(
        self, B: EntryFrame, D: EntryFrame, positions: Sequence[Motion], real: Flags, index: Index, marks: Marks
    ) -> Candidates:
        """The candidates for given positions of a, b and c."""
        others = (self.a, self.b, self.c)
        R = transposed(D.R)
        for joint, position, link in zip(others, positions, (self.A, B, self.C), strict=True):
            R = transposed([applied_back(link.R, joint.back_direction(position, part)) for part in transposed(R)])
        marks.short(R[0][2], R[1][2], index, wrist=True)
        *turns, reached = three_turns(self.P, self.Q, R)
        values = [joint.value(position) for joint, position in zip(others, positions, strict=True)]
        values += [in_front(q, real) for q in turns]
        order = [5 - j for j in self.joints] if self.reversed else list(self.joints)
        return gathered(index, dict(zip(order, values, strict=True)), real[None] & in_front(reached, real))

    def equations(self, B: EntryFrame, g: Vector) -> Equations:
        """v, |v|² and e, the two equations less what they have in y_z and |y|² (y_xy if b slides), of q_c."""
        c = self.c
        carried = c.carried(self.u)
        v: list[Form] = [combined((*row, t), (*carried, [1.0])) for row, t in zip(B.R, B.t, strict=True)]
        back = applied_back(B.R, B.t)
        square = combined(
            (1.0, 1.0, *(times(2.0, part) for part in back)), (c.square(self.u), [dot(B.t, B.t)], *carried)
        )
        known = (g[2], dot(g, g)) if self.a is Revolute else (g[0], g[1])
        right: list[Form] = [[plus(k, length)] for k, length in zip(known, self.known, strict=True)]
        pairs = zip(right, self.rows, strict=True)
        if self.b is Revolute:
            return v, square, [combined((1.0, -row[2], -row[3]), (f, v[2], square)) for f, row in pairs]
        return v, square, [combined((1.0, -row[0], -row[1]), (f, v[0], v[1])) for f, row in pairs]

    def _third(self, equations: Equations) -> tuple[Motion, Flags, Flags | None]:
        """All q_c, which are real, and for which targets q_c is not determined."""
        v, square, e = equations
        main, rest = e[self.pair.main], e[self.pair.rest]
        if self.b is Revolute:
            if self.pair.rank == 1:
                return self._first_degree(combined((1.0, -self.pair.ratio), (rest, main)))
            solved = [combined(row, e) for row in self.pair.inverse]
            return self._second_degree([(1.0, f, f) for f in (*solved, v[2])], combined((-1.0,), (square,)))
        if self.pair.rank == 0:
            return self._first_degree(e[0])
        zeta = combined((1.0 / self.rows[self.pair.main][2],), (main,))
        linear = combined((-1.0, self.rows[self.pair.rest][2]), (rest, zeta))
        if self.a is Prismatic:
            return self._first_degree(linear)
        return self._second_degree([(1.0, zeta, zeta), (-1.0, v[2], v[2])], combined((1.0, 1.0), (linear, square)))

    def _second(self, equations: Equations, q_c: Motion, real: Flags) -> tuple[Motion, list[Entry], Flags]:
        """q_b and y for given q_c, and which are real."""
        c = self.c
        v, _, e = equations
        v_x, v_y, v_z = (c.at(part, q_c) for part in v)
        square = plus(times(v_x, v_x), times(v_y, v_y))
        if self.b is Revolute:
            if self.pair.rank == 1:
                along = times(c.at(e[self.pair.main], q_c), 1.0 / self.pair.size)
                rest = minus(square, times(along, along))
                across = in_front(both(0.0, root(rest)), real)
                real = (real & np.asarray(rest >= -CLAMP))[None]
                n_x, n_y = self.pair.n
                y = [minus(times(n_x, along), times(n_y, across)), plus(times(n_y, along), times(n_x, across)), v_z]
            else:
                y = [*(c.at(combined(row, e), q_c) for row in self.pair.inverse), v_z]
            return turn_between((v_x, v_y), y), y, real
        if self.pair.rank == 0:
            heights, solvable = quadratic_roots(1.0, self.rows[1][2], minus(square, c.at(e[1], q_c)))
            y_z: Entry = in_front(heights, real)
            real = real[None] & in_front(solvable, real)
        else:
            y_z = times(c.at(e[self.pair.main], q_c), 1.0 / self.rows[self.pair.main][2])
        return (minus(y_z, v_z),), [v_x, v_y, y_z], real

    def _first_degree(self, f: Form) -> tuple[Motion, Flags, Flags | None]:
        """All q_c with f = 0."""
        return *self.c.roots(f), loose(f)

    def _second_degree(
        self, products: list[tuple[float, Form, Form]], linear: Form
    ) -> tuple[Motion, Flags, Flags | None]:
        """All q_c with Σ k f g + linear = 0."""
        if self.c is Revolute:
            n = parallel_gradient([linear, *(f for _, f, _ in products)])
            if n is not None:
                # All depend on ℓ = n · (cos, sin) alone: a quadratic in ℓ, then ℓ's two angles.
                f = sum_of_products(
                    Prismatic, [(k, along_gradient(f, n), along_gradient(g, n)) for k, f, g in products]
                )
                k = combined((1.0, 1.0), (f, along_gradient(linear, n)))
                ell, real = quadratic_roots(k[2], k[1], k[0])
                turn, reached = linear_roots(*n, ell)
                return turn, real & reached, loose(k)
        f = combined((1.0, 1.0), (sum_of_products(self.c, products), linear))
        return *self.c.roots(f), loose(f)


def meeting_triples(loop: Loop, tolerance: float = GEOMETRIC) -> list[int]:
    """The first of each three consecutive revolute axes that meet within the tolerance [size]."""
    turning = loop.revolute.tolist()
    return [
        first for first in range(4) if all(turning[first : first + 3]) and meeting_point(loop, first)[0] <= tolerance
    ]


def sum_of_products(c: type[Revolute] | type[Prismatic], products: list[tuple[float, Form, Form]]) -> Form:
    """Σ k f g."""
    return combined([k for k, _, _ in products], [c.product(f, g) for _, f, g in products])


def along_gradient(f: Form, n: tuple[float, float]) -> Form:
    """A function of n · (cos, sin) as a polynomial in it."""
    return [f[0], dot(n, f[1:3])]
