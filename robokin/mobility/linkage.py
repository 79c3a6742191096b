"""A mechanism as bodies, joints and loops, and how it is moved without coming apart.

Statement. Given the joints of an assembled mechanism, find the velocities that its loops allow, and move it.

Model. Each joint lets one body move against another in a subgroup of the rigid motions: turns about a line, slides
along one, both, turns about a point, motions in a plane, screws. Its basis is a set of twists at the reference
configuration (v, w), written in the world's frame; a universal joint is two hinges with a body between them, a joint
of m bodies m - 1 joints. The bodies are at g (4, 4), their displacement from the reference, and

    g_b = g_a h,    h in the joint's subgroup,

so that the twists of a joint are now Ad(g_a) S. A spanning tree gives every body a path of joints from the ground;
each joint outside the tree closes a loop. Twists in the world's frame add: with path signs P,

    xi_i = Σ_j P_ij S_j dq_j,    and for each loop  Σ_j M_lj S_j dq_j = 0,    M_c = P_a + e_c - P_b.

Rows. What couples joints beside the loops, gears whose wheels turn on one carrier, are linear equations with constant
coefficients, R q = 0 in the joints' values q. They hold for joints whose freedoms commute (hinges, slides, screws,
cylindrical joints): the values of others do not add.

Moving. Every joint is moved within its subgroup, h ← exp(S dq) h, so that joints never come apart; what a loop
then lacks, the logarithm of g_a h_c g_b⁻¹, is closed by Newton steps with the pseudo-inverse of M S.

Source: A. Müller, "Kinematic topology and constraints of multi-loop linkages", Robotica 36(11), 2018, for the
loops in screws; J. M. Hervé, "Analyse structurelle des mécanismes par groupe des déplacements", Mech. Mach. Theory
13, 1978, for joints as subgroups.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array, Flags
from robokin.brief import Brief
from robokin.kernel.ranks import LOOP_RANK
from robokin.mobility.screws import Element
from robokin.model.topology import topology_of
from robokin.spatial import invert
from robokin.spatial.twists import exponential, logarithm, moved_screws

CLOSED = 1e-12
"""A loop that lacks less [size and rad] is closed: some ten thousand times the rounding of its product."""

NEWTON_STEPS = 25
"""Steps to close the loops; near a regular configuration four are enough."""


@dataclass(frozen=True, eq=False, repr=False)
class LinkageState(Brief):
    """Where a linkage is: bodies (n, 4, 4) and joints (j, 4, 4), displacements from the reference, and how far each
    freedom has gone, values (f,) [rad | size]: exact where a joint's freedoms commute."""

    bodies: Array
    joints: Array
    values: Array


class Linkage:
    """Bodies and elementary joints in units of the mechanism's size.

    screws: (f, 6) the twists of all freedoms at the reference; joint, body: (f,) the joint of each and the body
    that carries it; paths: (n, j) the signs with which joints lead from the ground to each body; loops: (l, j); rows:
    (m, f) linear equations between the joints' values, beside the loops.
    """

    def __init__(self, bodies: int, ground: int, elements: list[Element], rows: Array | None = None) -> None:
        self.elements, self.ground = elements, ground
        self.screws = np.concatenate([e.screws for e in elements]) if elements else np.zeros((0, 6))
        counts = [len(e.screws) for e in elements]
        self.joint = np.repeat(np.arange(len(elements)), counts)
        self.body = np.repeat([e.a for e in elements], counts).astype(np.intp)
        topology = topology_of(bodies, [(e.a, e.b) for e in elements], (ground,))
        self.paths, self.order, self.chords = topology.signs, topology.steps, list(topology.loops)
        self.loops = np.zeros((len(self.chords), len(elements)))
        for row, j in zip(self.loops, self.chords, strict=True):
            row += self.paths[elements[j].a] - self.paths[elements[j].b]
            row[j] += 1.0
        self.rows = np.zeros((0, len(self.screws))) if rows is None else rows
        unmoved = np.tile(np.eye(4), (bodies, 1, 1)), np.tile(np.eye(4), (len(elements), 1, 1))
        self.reference = LinkageState(*unmoved, np.zeros(len(self.screws)))

    @property
    def bodies(self) -> tuple[int, ...]:
        """The bodies that joints lead to, the ground first, nearer ones before those beyond."""
        return (self.ground, *(body for body, _, _ in self.order))

    @property
    def freedoms(self) -> int:
        """Σf of the elementary joints."""
        return len(self.screws)

    def twists(self, state: LinkageState) -> Array:
        """The twists (f, 6) of all freedoms where the linkage is."""
        return moved_screws(state.bodies[self.body], self.screws)

    def jacobian(self, state: LinkageState) -> Array:
        """The equations of loops and rows (6 l + m, f): what joint speeds must not add up to."""
        S = self.twists(state)
        loops = (self.loops[:, None, self.joint] * S.T).reshape(6 * len(self.loops), len(S))
        return np.concatenate([loops, self.rows])

    def body_twists(self, state: LinkageState, speeds: Array) -> Array:
        """The twists (n, 6, k) of the bodies for joint speeds (f, k)."""
        moves = self.twists(state)[:, :, None] * speeds[:, None, :]
        return np.asarray(np.einsum("nf,fck->nck", self.paths[:, self.joint], moves))

    def moved(self, state: LinkageState, dq: Array) -> LinkageState:
        """The state after every joint has moved by dq (f,) within its subgroup."""
        steps = np.zeros((len(self.elements), 6))
        np.add.at(steps, self.joint, self.screws * dq[:, None])
        return self.placed(exponential(steps) @ state.joints, state.values + dq)

    def placed(self, joints: Array, values: Array) -> LinkageState:
        """The state with displacements (j, 4, 4) of the joints; of those that close loops, too."""
        bodies = self.reference.bodies.copy()
        for body, j, parent in self.order:
            h = joints[j] if self.elements[j].a == parent else invert(joints[j])
            bodies[body] = bodies[parent] @ h
        return LinkageState(bodies, joints, values)

    def lack(self, state: LinkageState) -> Array:
        """What the loops lack of closing and the rows of zero (6 l + m,) [size, rad]."""
        if not self.chords:
            return np.asarray(self.rows @ state.values)
        a = [self.elements[j].a for j in self.chords]
        b = [self.elements[j].b for j in self.chords]
        gap = state.bodies[a] @ state.joints[self.chords] @ invert(state.bodies[b])
        return np.concatenate([logarithm(gap).reshape(-1), self.rows @ state.values])

    def closed(
        self,
        state: LinkageState,
        tolerance: float = CLOSED,
        keep: Flags | None = None,
        rank: float = LOOP_RANK,
    ) -> tuple[LinkageState, Array, float]:
        """The nearest closed state that Newton's steps find, how the joints moved (f,), and what it still lacks.

        keep: (f,) joints that are True stay where they are; rank: singular values below this close no loop.
        """
        total = np.zeros(self.freedoms)
        error = self.lack(state)
        best = float(np.max(np.abs(error), initial=0.0))
        for _ in range(NEWTON_STEPS):
            if best <= tolerance:
                break
            J = self.jacobian(state)
            if keep is not None:
                J = J * ~keep
            dq = -_solve(J, error, rank)
            longest = float(np.max(np.abs(dq), initial=0.0))
            dq *= min(1.0, 0.5 / longest) if longest else 1.0
            after = self.moved(state, dq)
            error_after = self.lack(after)
            now = float(np.max(np.abs(error_after), initial=0.0))
            if now >= best and best < 1e-9:
                break  # rounding has the last word
            state, error, best = after, error_after, now
            total += dq
        return state, total, best


def _solve(J: Array, error: Array, rank: float) -> Array:
    """The least step that closes as much as can be closed; what rank says is zero stays unmoved."""
    return np.asarray(np.linalg.lstsq(J, error, rcond=rank)[0])
