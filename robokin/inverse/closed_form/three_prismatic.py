"""Six joints, three revolute and three prismatic ones in any order.

Sliding does not turn the hand, so the revolute joints i < j < k alone make the orientation: with the constant
rotations before, between and after them multiplied out, J1 L1 … J6 L6 = I says

    Rz(q_i) P Rz(q_j) Q Rz(q_k) = W,

three turns, two solutions (turns.py), which exist for every W where neighbouring axes are at right angles. Then the
translation of the loop, Σ d_n z_n + p = 0 with z_n the directions of the sliding axes and p the position of the end at
d = 0, is linear in the three lengths: one solution each. At most 2 solutions.

Degenerate: where the three directions lie in a plane the pose is singular: no lengths serve, or a family of them, of
which the shortest is given. Where neighbouring revolute axes are parallel, or the directions always in a plane, the
arm is singular everywhere.

Reference: D. L. Pieper, "The kinematics of manipulators under computer control", Stanford AI Memo 72, 1968 (any three
prismatic joints).
"""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array, Flags
from robokin.inverse.closed_form.gather import LEVER, Marks, gathered
from robokin.inverse.closed_form.joint_functions import Motion, Prismatic, Revolute, kind
from robokin.inverse.closed_form.loop_axes import PARALLEL
from robokin.inverse.closed_form.turns import three_turns
from robokin.inverse.elimination.loop import Candidates, Loop
from robokin.kernel.entries import (
    Entry,
    EntryFrame,
    Matrix,
    Vector,
    applied,
    columns,
    constant,
    dot,
    minus,
    moved,
    multiplied,
    times,
    transposed,
)

PLANAR = 1e-10
"""Three directions that span less than this volume lie in a plane: solving for the lengths would leave
them fewer than six digits."""

IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
TRIALS = 8
"""Random positions at which the directions are looked at; that all are singular by chance is out of the question."""


class ThreePrismatic:
    """The solver for a loop of three revolute and three prismatic joints."""

    method = "three prismatic joints"
    deviation = 0.0

    def __init__(self, loop: Loop) -> None:
        self.kinds = [kind(bool(revolute)) for revolute in loop.revolute]
        self.links = [constant(L) for L in loop.links]
        self.turning = np.flatnonzero(loop.revolute)
        self.sliding = np.flatnonzero(~loop.revolute)
        first, second, third = (int(i) for i in self.turning)
        self.before = transposed(self._rotation(0, first))
        self.P, self.Q = self._rotation(first, second), self._rotation(second, third)
        self.after = self._rotation(third, 5)
        numbers = [str(i + 1) for i in self.sliding]
        self.sentence = f"joints {', '.join(numbers)} are prismatic, so that the other three make the orientation"

    @classmethod
    def find(cls, loop: Loop) -> ThreePrismatic | None:
        """The solver if three joints are prismatic and the arm is not singular everywhere, or None."""
        if int(np.sum(loop.revolute)) != 3:
            return None
        solver = cls(loop)
        parallel = any(np.hypot(float(M[0][2]), float(M[1][2])) < PARALLEL for M in (solver.P, solver.Q))
        return None if parallel or solver._planar_everywhere() else solver

    def _rotation(self, start: int, stop: int) -> Matrix:
        """The rotation of the links from joint start to joint stop."""
        R = IDENTITY
        for link in self.links[start:stop]:
            R = multiplied(R, link.R)
        return R

    def _planar_everywhere(self) -> bool:
        angles = np.random.default_rng(0).uniform(-np.pi, np.pi, (3, TRIALS))
        turns: dict[int, Motion] = {int(i): (np.cos(q), np.sin(q)) for i, q in zip(self.turning, angles, strict=True)}
        _, directions = self._translation(turns, EntryFrame(IDENTITY, [0.0, 0.0, 0.0]))
        return bool(np.max(np.abs(np.asarray(dot(directions[0], crossed(directions[1], directions[2]))))) < PARALLEL)

    def candidates(self, closing: Array) -> Candidates:
        """Every solution for the targets of L6: closing (m, 4, 4)."""
        with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
            end = columns(closing)
            W = multiplied(self.before, transposed(multiplied(self.after, end.R)))
            *angles, real = three_turns(self.P, self.Q, W)
            turns: dict[int, Motion] = {
                int(i): (np.cos(q), np.sin(q)) for i, q in zip(self.turning, angles, strict=True)
            }
            p, directions = self._translation(turns, end)
            lengths, planar = solved(directions, p)
            values: dict[int, Entry] = {int(i): q for i, q in zip(self.turning, angles, strict=True)}
            values |= {int(i): d for i, d in zip(self.sliding, lengths, strict=True)}
            found = gathered(np.arange(len(closing)), values, real)
            marks = Marks(len(closing))
            marks.short(W[0][2], W[1][2], np.arange(len(closing)))
            marks.near |= np.broadcast_to(planar, (2, len(closing))).any(axis=0)
            return marks.on(found, True)

    def _translation(self, turns: dict[int, Motion], end: EntryFrame) -> tuple[Vector, list[Vector]]:
        """The translation of the loop at lengths 0, and the directions of the sliding axes in order."""
        p: Vector = end.t
        directions: list[Vector] = []
        for i in reversed(range(6)):
            if i < 5:
                p = moved(self.links[i], p)
                directions = [applied(self.links[i].R, z) for z in directions]
            if self.kinds[i] is Prismatic:
                directions.insert(0, [0.0, 0.0, 1.0])
            else:
                p = Revolute.onward(turns[i], p)
                directions = [Revolute.onward(turns[i], z) for z in directions]
        return p, directions


def solved(directions: list[Vector], p: Vector) -> tuple[list[Array], Flags]:
    """The lengths d with Σ d_n z_n + p = 0, by Cramer's rule; the shortest ones where the z_n lie in a plane.

    Also where they nearly do.
    """
    a, b, c = directions
    normals = [crossed(b, c), crossed(c, a), crossed(a, b)]
    volume = np.asarray(dot(a, normals[0]))
    planar = np.abs(volume) < PLANAR
    scale = -1.0 / np.where(planar, 1.0, volume)
    lengths = [np.asarray(times(scale, dot(n, p))) for n in normals]
    if planar.any():
        shape = np.broadcast_shapes(planar.shape, *(length.shape for length in lengths))
        lengths = [np.broadcast_to(length, shape).copy() for length in lengths]
        chosen = np.broadcast_to(planar, shape)
        entries = [np.broadcast_to(part, shape)[chosen] for v in (*directions, p) for part in v]
        M = np.stack(entries, axis=-1).reshape(-1, 4, 3)
        shortest = -np.linalg.pinv(np.swapaxes(M[:, :3], 1, 2), rcond=PLANAR) @ M[:, 3, :, None]
        for length, part in zip(lengths, shortest[..., 0].T, strict=True):
            length[chosen] = part
    return lengths, np.abs(volume) < LEVER


def crossed(u: Vector, v: Vector) -> Vector:
    """u × v."""
    return [
        minus(times(u[1], v[2]), times(u[2], v[1])),
        minus(times(u[2], v[0]), times(u[0], v[2])),
        minus(times(u[0], v[1]), times(u[1], v[0])),
    ]
