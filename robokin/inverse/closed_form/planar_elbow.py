"""Three joints with parallel axes, seen along them: a planar arm of two links and a hand.

Statement. Where the hand's joint is in the plane of the arm, at p, and its direction are given, find the three angles.
Derivation. p = e^(i q1) (l1 + l2 e^(± i q2)) with complex links l1 and l2: |p|² = |l1|² + |l2|² + 2 Re(l1* l2 e^(i q2))
has two elbows. q1 then turns the one side to p, and the hand's angle is what is left.
Degenerate case. A link without length is no link: SingularEverywhereError.
"""

from __future__ import annotations

import math

import numpy as np

from robokin.arrays import Array, Flags
from robokin.inverse.closed_form.equation_pair import RANK
from robokin.inverse.closed_form.loop_axes import SingularEverywhereError
from robokin.inverse.closed_form.trigonometry import CLAMP, Turn, linear_roots
from robokin.kernel.entries import Entry, Vector, angle, minus, plus, times


class PlanarElbow:
    """The planar arm of J1 L J2 M J3.

    l1, l2: the links, in the plane seen along the first axis; turn: the hand's angle where all three are zero; eta: how
    far the three move along the axes; sign: whether the third axis has the direction of the first; signs: of the second
    angle and of the third.
    """

    def __init__(self, L: Array, M: Array) -> None:
        s1, s2 = (float(np.sign(T[2, 2])) for T in (L, M))
        phi1, phi2 = (math.atan2(T[1, 0], T[0, 0]) for T in (L, M))
        self.sign = s1 * s2
        self.signs = s1, s1 * s2
        self.l1 = complex(L[0, 3], L[1, 3])
        # A link whose z is turned over mirrors what follows.
        self.l2 = complex(M[0, 3], s1 * M[1, 3]) * complex(math.cos(phi1), math.sin(phi1))
        self.turn = phi1 + s1 * phi2
        self.eta = float(L[2, 3] + s1 * M[2, 3])
        if min(abs(self.l1), abs(self.l2)) < RANK:
            raise SingularEverywhereError

    def roots(self, p: Vector) -> tuple[Turn, Flags]:
        """Both turns of the second link that bring the hand's joint to p."""
        lever = self.l1.conjugate() * self.l2
        square = plus(times(p[0], p[0]), times(p[1], p[1]))
        e = plus(square, -(abs(self.l1) ** 2) - abs(self.l2) ** 2)
        return linear_roots(lever.real, -lever.imag, times(0.5, e))

    def values(self, p: Vector, across: Vector, turn: Turn) -> list[Entry]:
        """The three joint values for p, the direction of the hand's x axis and the second link's turn."""
        l1, l2 = self.l1, self.l2
        cos2, sin2 = turn
        inner_x = plus(l1.real, minus(times(l2.real, cos2), times(l2.imag, sin2)))
        inner_y = plus(l1.imag, plus(times(l2.imag, cos2), times(l2.real, sin2)))
        p_x, p_y = p
        q1 = angle(plus(times(p_x, inner_x), times(p_y, inner_y)), minus(times(p_y, inner_x), times(p_x, inner_y)))
        q2 = angle(cos2, sin2)
        q3 = angle(*across) - q1 - q2 - self.turn
        return [q1, times(self.signs[0], q2), times(self.signs[1], q3)]

    def reaching(self, start: Array, quarter: Array, half: Array) -> tuple[Turn, Flags]:
        """The turns of a joint that carries p on a circle for which the elbow reaches it, and where there are some.

        start, quarter, half: (s,) complex, where p is at 0, at 90° and at 180°.
        """
        center, arm = (start + half) / 2.0, (start - half) / 2.0
        sense = np.where(((quarter - center) * (1j * arm).conj()).real < 0.0, -1.0, 1.0)
        reach = abs(self.l1) + abs(self.l2)
        least = np.maximum(np.abs(np.abs(center) - np.abs(arm)), abs(abs(self.l1) - abs(self.l2)))
        most = np.minimum(np.abs(center) + np.abs(arm), reach)
        distance = np.abs(start)
        distance = np.where((distance >= least) & (distance <= most), distance, (least + most) / 2.0)
        lever = center.conj() * arm
        e = 0.5 * (distance**2 - np.abs(center) ** 2 - np.abs(arm) ** 2)
        turn, real = linear_roots(lever.real, -sense * lever.imag, e)
        return turn, real & (least <= most + CLAMP)
