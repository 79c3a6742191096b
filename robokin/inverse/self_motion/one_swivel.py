"""One pose of an arm with a spherical shoulder and wrist, without blocks: what `native/swivel.c` gives, in Python.

Statement. Give the pieces of a pose's self-motions within the joint limits and the solutions that are listed of them.
Derivation. The steps are those of a block (`swivel_pieces`, `swivel_members`, `spread`): the curves by straight-line
code (`swivel_code`), the pieces by bits (`one_pieces`), the rest for a table of one pose. The configurations are proven
by forward kinematics, here by products with the chain's constants, joint after joint: of some tens of them numpy's
share of a call is more than the work.
Degenerate case. Where a step doubts, or nothing is within the limits, nothing is given.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import count

import numpy as np

from robokin.arrays import Array, Index
from robokin.inverse.self_motion.one_pieces import OneBounds
from robokin.inverse.self_motion.spread import spread_of_one
from robokin.inverse.self_motion.swivel_arm import SwivelArm
from robokin.inverse.self_motion.swivel_code import one_curves
from robokin.inverse.self_motion.swivel_curves import SIGNS, TURN, SwivelCurves, swivel_curves
from robokin.inverse.self_motion.swivel_members import COUNTS, placed
from robokin.inverse.self_motion.swivel_pieces import CODES, CURVES, SwivelPieces, swivel_bounds, swivel_pieces
from robokin.inverse.self_motion.swivel_turns import joint_values
from robokin.inverse.verify import CLOSES, within_limits
from robokin.kernel.chain import Chain
from robokin.kernel.facts import fact
from robokin.model.robot import tolerated

STILL = 1e-9
"""A joint [rad] that moves by less along a curve stands still."""

LOOKS = np.linspace(-np.pi, np.pi, 13)[:-1]
"""Values of ψ at which it is seen which joints move: after the first two mostly all are."""

FIRST_LOOKS, SECOND_LOOKS = np.full((CURVES, 2), LOOKS[:2]).T
"""The first two for every curve."""

NO_DOUBT = np.zeros(1, dtype=bool)

ELBOW, CODE_SIGNS = CODES[:, 0], SIGNS[CODES[:, 1:]].T.copy()
"""By curve the place of its elbow's sign, and the signs of the middle turns (2, c)."""

ALL_BUT_THE_ELBOW = 127 - 8
"""The joints that may move, as bits."""

BITS = 1 << np.arange(7)

FROM_Z = [2, 3, 0, 1]
"""Columns z, p, x, y of a frame's x, y, z, p."""

Answer = tuple[Array, Array, list[int], int, int]
"""Rows of solutions (k, 10): joint values, position, angle, curve; pieces (p, 4): curve, first and last ψ, whole; by
curve the joints, as bits, that move along it; how many close, and how many are within the limits."""


@dataclass(frozen=True, eq=False)
class OneSwivel:
    """An arm with its limits (7, 2), what counts as within them, and resting values (7,) [rad]."""

    arm: SwivelArm
    limits: Array
    low: Array
    high: Array
    rest: Array

    @cached_property
    def bounds(self) -> OneBounds:
        """The limits as equations."""
        return OneBounds(swivel_bounds(self.arm, self.limits))

    @cached_property
    def _poses(self) -> Iterator[int]:
        """Which pose of the arm it is: code is made at the second one, since it takes as long as twenty poses."""
        return count()

    def solution(self, T: Array, most: int) -> Answer | None:
        """The answer for a target T (4, 4) [m], up to `most` solutions; None where the blocks are to look at it."""
        known = one_curves(self.arm)(*T.ravel().tolist()) if next(self._poses) else None
        if known is None:
            curves = swivel_curves(self.arm, T[None])
            pieces = None if curves.doubt[0] else swivel_pieces(curves, self.limits)
            if pieces is None or pieces.doubt[0] or not len(pieces.row):
                return None
            return self._listed(T, most, curves.q4[0], curves.entries[0], pieces)
        doubt, q4, real, numbers = known
        entries = numbers.reshape(2, 2, 5, 3)
        found = None if doubt or not real else self.bounds.pieces(q4, entries)
        if not found:
            return None
        code, first, last, whole = np.array([number for piece in found for number in piece]).reshape(-1, 4).T
        row = np.zeros(len(code), dtype=np.intp)
        pieces = SwivelPieces(row, code.astype(np.intp), first, last, whole, NO_DOUBT)
        return self._listed(T, most, np.array(q4), entries, pieces)

    def _listed(self, T: Array, most: int, q4: Array, entries: Array, pieces: SwivelPieces) -> Answer | None:
        """What is listed of some pieces on curves with elbows q4 (2,) [rad] and `entries` (2, 2, 5, 3)."""
        arm = self.arm
        of, psi = placed(pieces, COUNTS[0])
        own, many = sorted(set(pieces.code.tolist())), len(psi)
        code = np.concatenate([pieces.code[of], own, own])
        psi = np.concatenate([psi, FIRST_LOOKS[: len(own)], SECOND_LOOKS[: len(own)]])
        elbow = ELBOW[code]
        factors = entries.transpose(3, 2, 1, 0).take(elbow, axis=3)
        q = joint_values(arm, factors, q4[elbow], CODE_SIGNS[:, code], psi)
        moving = self._moving(T, own, q[many:])
        q, code = q[:many], code[:many]
        position, angle = _missing(arm.chain, q, T)
        closes = (position <= CLOSES * arm.size) & (angle <= CLOSES)
        if not closes.all():
            q, position, angle, code = q[closes], position[closes], angle[closes], code[closes]
        closing = len(q)
        if not ((q >= self.low) & (q <= self.high)).all():
            q, inside = within_limits(q, arm.chain.revolute, self.limits, None)
            q, position, angle, code = q[inside], position[inside], angle[inside], code[inside]
        if not len(q):
            return None
        x = q.T
        chosen = spread_of_one(x - TURN * np.rint(x / TURN), np.abs(q - self.rest).max(axis=1), most)
        table = np.empty((len(chosen), 10))
        table[:, :7], table[:, 7], table[:, 8], table[:, 9] = q[chosen], position[chosen], angle[chosen], code[chosen]
        rows = np.array([pieces.code, pieces.first, pieces.last, pieces.whole]).T
        return table, rows, moving, closing, len(q)

    def _moving(self, T: Array, own: list[int], q: Array) -> list[int]:
        """By curve the joints, as bits, that move along it: curves `own` (c,), seen at the first looks q (2 c, 7)."""
        seen = _moved(q, len(own))
        if any(bits != ALL_BUT_THE_ELBOW for bits in seen):
            seen = moving_joints(swivel_curves(self.arm, T[None]), 0, np.array(own))
        moving = [0] * CURVES
        for code, bits in zip(own, seen, strict=True):
            moving[code] = bits
        return moving


def one_swivel(arm: SwivelArm, limits: Array, rest: Array) -> OneSwivel:
    """An arm as one pose takes it, for limits (7, 2) and resting values (7,) [rad]."""
    return OneSwivel(arm, limits, *tolerated(limits), rest)


def moving_joints(curves: SwivelCurves, i: int, codes: Index) -> list[int]:
    """The joints, as bits, that move along curves (c,) of pose i."""
    c, k = len(codes), len(LOOKS)
    return _moved(curves.configurations(np.full(c * k, i), CODES[np.tile(codes, k)], np.repeat(LOOKS, c)), c)


def _moved(q: Array, count: int) -> list[int]:
    """The joints, as bits, that are not alike in all configurations (k count, 7), look after look, of each curve."""
    q = q.reshape(-1, count, 7)
    away = q[1:] - q[0]
    away -= TURN * np.rint(away / TURN)
    moves = np.abs(away, out=away).max(axis=0) > STILL
    bits: list[int] = (moves @ BITS).tolist()
    return bits


@fact
def _steps(chain: Chain) -> tuple[Array, list[Array]]:
    """The first constant's columns z, p, x, y (4, 3, 1), and of each joint, which turns, and the constant after it the
    factors (4, 6) of cos q x, cos q y, sin q x, sin q y, z, p in these."""
    first, *rest = chain.constants
    factors = [np.stack([C[0], C[1], -C[1], C[0], C[2], C[3]], axis=1)[FROM_Z] for C in rest]
    return first[:3].T[FROM_Z, :, None].copy(), factors


def _missing(chain: Chain, q: Array, T: Array) -> tuple[Array, Array]:
    """What configurations q (s, 7) lack of a target T (4, 4): distances (s,) [m] and angles (s,) [rad].

    As `verify.residuals` has it.
    """
    first, factors = _steps(chain)
    # Of each joint in turn the products with cosine and sine, then the columns z, p, x, y before it; one table is read
    # while the other is filled.
    one, other = np.empty((2, 8, 3, len(q)))
    one[4:] = first
    turns = np.empty((7, 2, 1, 1, len(q)))
    angles = q.T + chain.offsets[:, None]
    np.cos(angles, out=turns[:, 0, 0, 0])
    np.sin(angles, out=turns[:, 1, 0, 0])
    for turn, factor in zip(turns, factors, strict=True):
        np.multiply(one[6:], turn, out=one[:4].reshape(2, 2, 3, -1))
        np.matmul(factor, one[:6].reshape(6, -1), out=other[4:].reshape(4, -1))
        one, other = other, one
    off = one[4:]
    off -= T[:3].T[FROM_Z, :, None]
    off *= off
    squares = np.add.reduce(off, axis=1)
    chord = np.sqrt(squares[2] + squares[3] + squares[0])
    return np.sqrt(squares[1]), 2.0 * np.arcsin(np.minimum(chord / np.sqrt(8.0), 1.0))
