"""Which signs tell an arm's solutions apart, read off its axes.

Statement. Six joints solve a pose in steps of at most two roots each where three of their axes meet in a point w, or
are parallel, and two neighbours of the other three axes lie in a plane (they meet or are parallel). The root of each
step is told by the sign of a quantity that is zero only where the arm is singular. So the signs together name each
solution, no two alike, and no sign changes as long as the arm moves without passing a singularity.

Derivation. With the velocity v_i = z_i × (w - o_i) of the point w (z_i for a slide), r = w - m seen from a point m:

- The three turns about w have two solutions, with the sign of z_1 · (z_2 × z_3), which is that of their middle joint's
  sine. The others, i and j the two in a plane and k the third, bring w to its place, where det(v_i, v_j, v_k) falls
  into two factors, each the derivative of a step's equation:
      i, j meet in m         r · (z_i × z_j)          v_k · r          (the distance |r| depends on q_k alone)
      i, j parallel          z_i · (r_i × r_j)        v_k · z_i        (the height along z_i depends on q_k alone;
                                                                        r_i, r_j from the axes to w)
      j slides across i      r_i · z_j                v_k · z_i
      i, j slide             1                        v_k · (z_i × z_j)
- Three axes parallel to h: they are a planar arm with two elbows, told by its area h · ((p_2 - p_1) × (p_3 - p_2)).
  What they leave alone, direction of h and height along h, is a matter of the other three:
      i, j meet in m         h · (z_i × z_j)          (z_k × (m - o_k)) · h
      i, j parallel          h · (z_i × z_k)          (z_i × (o_j - o_i)) · h
- Three slides: the three turns, as above.

Fewer joints: a point on the last axis, or the tool's, is brought to its place by the first three as above; parallel
axes have an elbow.

Degenerate case. Where no two axes lie in a plane a step has four roots, and some arms move from one solution to another
without passing a singularity (P. Wenger, A new general formalism for the kinematic analysis of all nonredundant
manipulators, ICRA 1992): no sign can tell them apart. Then the sign of det J is all that can be said, and a number is
needed. Arms that are calibrated have axes that nearly meet and nearly are parallel: they have the signs of the arm that
they were designed as.

Reference: that solutions lie between singularities, P. Borrel, A. Liégeois, A study of multiple manipulator inverse
kinematic solutions with applications to trajectory planning and workspace determination, ICRA 1986.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.inverse.posture_signs import (
    UNDECIDED,
    Point,
    Quantity,
    Sign,
    area_of,
    determinant,
    lever_area,
    mirrored,
    multiple,
    side_of,
    triple_product,
    turn_of,
)
from robokin.jobs.arbitrary_numbers import arbitrary
from robokin.kernel.chain import Chain, chain_size
from robokin.kernel.joint_axes import NEARLY, Axes, cross, dot

UPRIGHT = 0.05
"""A reach in the arm's size that is none: the arm stands upright. Calibration moves it by less than a hundredth."""

ALONG = 0.9
"""Cosine of the angle of an x axis and the common normal that it is meant to be along, in calibrated tables too."""

ORDER = ("shoulder", "elbow", "slide", "forearm", "wrist", "hand", "det")
"""In which order the parts of an arm are named."""


@dataclass(frozen=True, eq=False)
class Postures:
    """The signs that name the solutions of a chain's joints; numbered: whether they need a number as well."""

    chain: Chain
    size: float
    signs: tuple[Sign, ...]
    numbered: bool

    def axes(self, q: Array) -> Axes:
        """The axes at configurations q: (s, n) [rad | m]."""
        return Axes(self.chain, q, self.size)


POINT_WORDS = {
    (3, 1): ("elbow", "shoulder"), (3, 0): ("shoulder", "elbow"), (0, 3): ("elbow", "wrist"),
    (0, 4): ("wrist", "elbow"), (1, 4): ("wrist", "shoulder"), (2, 0): ("shoulder", "wrist"),
}  # fmt: skip
"""By the first of the three axes that meet in a point and the first of the two in a plane, joints from 0: what the sign
of the two is called, and that of the joint left over."""

PARALLEL_WORDS = {
    (1, 4): ("wrist", "shoulder"), (0, 3): ("wrist", "hand"), (0, 4): ("wrist", "forearm"),
    (2, 0): ("shoulder", "wrist"), (3, 0): ("shoulder", "forearm"), (3, 1): ("forearm", "shoulder"),
}  # fmt: skip
"""The like where three axes are parallel."""

FLIPS = ("shoulder", "elbow", "elbow", "wrist")
"""What the turn about a point is called, by the first of its three joints."""


def postures_of(chain: Chain) -> Postures:
    """The signs for a chain of at most six joints that do not depend on each other."""
    arm = _Arm(chain)
    if chain.n < 6:
        signs, enough = list(_of_fewer(arm)), True
    else:
        signs, enough = _about_a_point(arm) or _in_a_plane(arm) or _with_slides(arm) or ([], False)
    if not enough:
        signs.append(side_of("det", determinant))
    signs.sort(key=lambda sign: ORDER.index(sign.part))
    return Postures(chain, arm.size, tuple(signs), numbered=not enough)


class _Arm:
    """A chain and its axes at arbitrary configurations: what holds there but for chance holds everywhere."""

    def __init__(self, chain: Chain) -> None:
        self.chain, self.size, self.turns = chain, chain_size(chain), chain.revolute
        q = arbitrary(20, 3, chain.n)
        self.axes = self.at(np.where(self.turns, q, q * self.size))

    def at(self, q: Array) -> Axes:
        """The axes at configurations q: (s, n) [rad | m]."""
        return Axes(self.chain, q, self.size)


def _about_a_point(arm: _Arm) -> tuple[list[Sign], bool] | None:
    """The signs where three axes of six meet in a point, and whether they are enough; None for other arms."""
    for first in (3, 0, 1, 2):
        if arm.axes.concurrent(first, first + 1, first + 2):

            def centre(axes: Axes, i: int = first) -> Array:
                return np.asarray(0.5 * (axes.meeting(i, i + 1) + axes.meeting(i + 1, i + 2)))

            turn = turn_of(FLIPS[first], first, first + 1, first + 2)
            placing = _placing(arm, first, centre)
            return ([turn], False) if placing is None else ([*placing, turn], True)
    return None


def _in_a_plane(arm: _Arm) -> tuple[list[Sign], bool] | None:
    """The same where three axes of six are parallel."""
    for first in (1, 0, 2, 3):
        three = first, first + 1, first + 2
        if not (arm.turns[list(three)].all() and arm.axes.parallel(*three)):
            continue
        for i, j, k in _neighbours(first):
            found = _direction(arm, first, i, j, k)
            if found is not None:
                height, turn = found
                elbow = area_of(*three)
                if height is None:
                    return [side_of("elbow", elbow), turn], True
                if k == 0:
                    sign = _reach_sign(arm, height, first)
                    height = multiple(sign, height)
                    elbow = mirrored(multiple(sign, elbow), height)
                return [side_of(PARALLEL_WORDS[first, i][1], height), side_of("elbow", elbow), turn], True
        return [side_of("elbow", area_of(*three))], False
    return None


def _direction(arm: _Arm, first: int, i: int, j: int, k: int) -> tuple[Quantity | None, Sign] | None:
    """What tells the ways apart to bring three parallel axes to their direction and height, by joints i, j and k.

    The height's sign (None where there is one way only) and the direction's; None if i, j are in no plane.
    """
    h = first + 2 if i > first else first
    turning = [joint for joint in (i, j, k) if arm.turns[joint]]
    part = PARALLEL_WORDS[first, i][0]
    if len(turning) == 2:
        a, b = turning
        return None, _turn_between(part, first, h, a, b)
    if len(turning) < 2:
        return None
    if arm.axes.meet(i, j):

        def height(axes: Axes) -> Array:
            return dot(axes.velocity(k, axes.meeting(i, j)), axes.z[:, first])

        return height, _turn_between(part, first, h, i, j)
    if arm.axes.parallel(i, j):

        def across(axes: Axes) -> Array:
            return dot(cross(axes.z[:, i], axes.foot(j, axes.o[:, i]) - axes.o[:, i]), axes.z[:, first])

        return across, _turn_between(part, first, h, i, k)
    return None


def _turn_between(part: str, first: int, h: int, i: int, j: int) -> Sign:
    """The turn by which joints i and j bring the direction of axis h, one of three from `first` on, to its place."""
    order = sorted((h, i, j)) if (i > first) == (j > first) else (i, h, j)
    return turn_of(part, *order)


def _with_slides(arm: _Arm) -> tuple[list[Sign], bool] | None:
    """The same where three joints of six slide."""
    turning = np.flatnonzero(arm.turns).tolist()
    return ([turn_of("wrist", *turning)], True) if len(turning) == 3 else None


def _of_fewer(arm: _Arm) -> Iterator[Sign]:
    """The signs for fewer than six joints."""
    axes, n = arm.axes, arm.chain.n
    turning = np.flatnonzero(arm.turns).tolist()
    if len(turning) >= 2 and axes.parallel(*range(n)):
        i, j = turning[:2]

        def end(axes: Axes) -> Array:
            return axes.foot(turning[2], axes.tip) if len(turning) > 2 else axes.tip

        yield side_of("elbow", multiple(-1.0, lever_area(i, j, end)))
    elif n == 2 and axes.meet(0, 1):
        yield side_of("shoulder", triple_product(0, 1, lambda axes: axes.tip))
    elif n == 3 and axes.concurrent(0, 1, 2):
        yield turn_of("wrist", 0, 1, 2)
    elif n >= 3:
        yield from _placing(arm, 3, _end_point(arm)) or []


def _end_point(arm: _Arm) -> Point:
    """The point that the first three joints bring to its place: on the last axis, or the tool's of three joints."""
    last = arm.chain.n - 1
    if last < 3 or not arm.turns[last]:
        return lambda axes: axes.tip
    if not arm.turns[last - 1] or arm.axes.parallel(last - 1, last):
        return lambda axes: axes.foot(last, axes.tip)
    return lambda axes: axes.nearest(last - 1, last)


def _placing(arm: _Arm, first: int, point: Point) -> list[Sign] | None:
    """The signs for the joints that bring a point to its place, those that follow the three from `first` on.

    None where no two of them are in a plane.
    """
    for kind in (_by_parallel, _by_meeting, _by_slide):
        for i, j, k in _neighbours(first):
            found = kind(arm, first, i, j, k, point)
            if found is not None:
                return found
    return None


def _neighbours(first: int) -> list[tuple[int, int, int]]:
    """The pairs i, i + 1 of the three joints other than first, first + 1, first + 2, and for each the third joint."""
    a, b, c = ((first + step) % 6 for step in (3, 4, 5))
    pairs = [(b, c, a), (a, b, c)] if first == 3 else [(a, b, c), (b, c, a)]
    return [pair for pair in pairs if pair[0] < pair[1]]


def _by_parallel(arm: _Arm, first: int, i: int, j: int, k: int, point: Point) -> list[Sign] | None:
    """The signs where axes i and j are parallel, or None."""
    if not (arm.turns[i] and arm.turns[j] and arm.axes.parallel(i, j)):
        return None

    def height(axes: Axes) -> Array:
        return dot(axes.velocity(k, point(axes)), axes.z[:, i])

    elbow = lever_area(i, j, point)
    if k in (1, 2, 3, 4):
        # Seen along the two axes a planar arm, whose elbow is up to the left of its line.
        left = side_of("elbow", multiple(-1.0, elbow))
        return [side_of("forearm", height), left] if arm.turns[k] else [left]
    pair, word = POINT_WORDS[first, i]
    if not arm.turns[k]:
        return [side_of(pair, elbow)]
    sign = _reach_sign(arm, height, i) if k == 0 else 1.0
    reach = multiple(sign, height)
    return [side_of(word, reach), side_of(pair, mirrored(multiple(sign, elbow), reach))]


def _by_meeting(arm: _Arm, first: int, i: int, j: int, k: int, point: Point) -> list[Sign] | None:
    """The signs where axes i and j meet, or None."""
    if not arm.axes.meet(i, j):
        return None

    def away(axes: Axes) -> Array:
        w = point(axes)
        return dot(axes.velocity(k, w), w - axes.meeting(i, j))

    pair, other = POINT_WORDS[first, i]
    side = triple_product(i, j, point)
    if not arm.turns[k]:
        # The lectures' spherical arm: the second joint's sine, whichever way the slide has gone.
        return [side_of(pair, multiple(-1.0, mirrored(side, away))), side_of("slide", away)]
    return [side_of(pair, side), side_of(other, away)]


def _by_slide(arm: _Arm, first: int, i: int, j: int, k: int, point: Point) -> list[Sign] | None:
    """The signs where joints i and j slide, or one slides across the axis of the other; or None."""
    word = POINT_WORDS[first, i][1]
    if not (arm.turns[i] or arm.turns[j]):
        if not arm.turns[k]:
            return []
        # Of the two the one that is less along the axis carries the point outwards.
        slant = [float(np.max(np.linalg.norm(arm.axes.across(k, slide), axis=1))) for slide in (i, j)]
        out = (i, j)[int(np.argmax(slant))]
        sign = float(np.sign(dot(arm.axes.across(i, j), arm.axes.across(k, out))[0]))
        return [side_of("slide", lambda axes: sign * dot(axes.velocity(k, point(axes)), axes.across(i, j)))]
    if arm.turns[i] and arm.turns[j]:
        return None
    turn, slide = (i, j) if arm.turns[i] else (j, i)
    if np.max(np.abs(dot(arm.axes.z[:, i], arm.axes.z[:, j]))) > NEARLY:
        return None
    reach = side_of("slide", lambda axes: dot(point(axes) - axes.foot(turn, point(axes)), axes.z[:, slide]))
    if not arm.turns[k]:
        return [reach]
    return [side_of(word, lambda axes: dot(axes.velocity(k, point(axes)), axes.z[:, turn])), reach]


def _reach_sign(arm: _Arm, height: Quantity, joint: int) -> float:
    """The sign that makes a reach from the first axis positive on the side that x of link 1 points to.

    The common normal of two axes that meet may have either direction, and a Denavit-Hartenberg table chooses one. Where
    a table has no such x, the side is that to which the arm reaches in its zero position, or, if it stands upright
    there, with the joint at 90°.
    """
    across = arm.axes.across(0, joint)
    length = np.linalg.norm(across, axis=1)
    # Parallel axes have no direction across them.
    cosine = dot(arm.axes.x[:, 1], across) / np.where(length > UNDECIDED, length, np.inf)
    if np.min(np.abs(cosine)) > ALONG:
        return -float(np.sign(cosine[0]))
    q = np.zeros((2, arm.chain.n))
    q[1, joint] = 0.5 * np.pi
    reach = height(arm.at(q))
    told = reach[np.abs(reach) > UPRIGHT]
    return float(np.sign(told[0])) if len(told) else -1.0
