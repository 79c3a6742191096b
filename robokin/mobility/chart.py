"""Configurations of a part of a linkage by coordinates, many at once: what its loops lack, and how that changes.

Model. Each joint is a product of turns, slides and screws, one coordinate q each:

    h = exp(q_1 S_1) exp(q_2 S_2) …,    g_b = g_a h,

exp in closed form, since S⁴ = -S² for a twist with |w| = 1 and S² = 0 for a slide: I + q S + (1 - cos q) S² +
(q - sin q) S³ for turns, slides and screws alike. A joint outside the spanning forest closes a loop, which lacks

    G = g_a h g_b⁻¹:  its translation t and the axis part of its rotation, ½ (R - Rᵀ)^∨,

smooth functions that vanish where the loop is closed. With dG = [ξ] G - G [ξ'], ξ the sum of the columns on the way to
a and through the joint, ξ' that on the way to b, they change by

    v + w × t - R v'    and    ½ (tr R - R) (w - R w').

Not a `kernel.chain.Chain`, which is a line of joints that turn about z or slide along it, with constants between them:
here bodies branch and meet again, a screw has a pitch, and joints stand where they are at the reference.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.model.topology import topology_of
from robokin.spatial import invert
from robokin.spatial.twists import moved_screws, skew

OUT_OF_PLANE = 1e-12
"""Parts of unit twists below this are rounding."""


@dataclass(frozen=True, eq=False)
class ChartEdge:
    """A joint from body a to body b as a product of motions about its screws (n, 6) in order; none is fixed."""

    a: int
    b: int
    screws: Array


class Chart:
    """Coordinates q (n,) of edges, all their screws in order, from the configuration given, q = 0.

    rows: (m, n) linear equations on q beside the loops; roots: all bodies, those first from which others are reached;
    planar: whether only what happens in the plane z = 0 counts, by
    default if nothing leaves it.
    """

    def __init__(self, edges: list[ChartEdge], rows: Array, roots: tuple[int, ...], planar: bool | None = None) -> None:
        self.edges, self.roots = edges, roots
        self.screws = np.concatenate([edge.screws for edge in edges]) if edges else np.zeros((0, 6))
        self.n = len(self.screws)
        self.rows = rows
        self.first = np.cumsum([0, *(len(edge.screws) for edge in edges)])
        self._powers = _powers(self.screws)
        # Bodies are numbered as the edges come to them.
        numbers = {body: i for i, body in enumerate(dict.fromkeys(body for edge in edges for body in (edge.a, edge.b)))}
        self.ends = [(numbers[edge.a], numbers[edge.b]) for edge in edges]
        self.topology = topology_of(len(numbers), self.ends, (numbers[root] for root in roots))
        self.chords, signs = self.topology.loops, self.topology.signs
        # A column of an edge counts for the bodies beyond it.
        edge_of = np.repeat(np.arange(len(edges)), np.diff(self.first))
        self._there, self._back = np.zeros((2, len(self.chords), self.n))
        for there, back, chord in zip(self._there, self._back, self.chords, strict=True):
            a, b = self.ends[chord]
            there += signs[a][edge_of] + (edge_of == chord)
            back += signs[b][edge_of]
        out = float(np.max(np.abs(self.screws[:, [2, 3, 4]]), initial=0.0))
        self.planar = out < OUT_OF_PLANE if planar is None else planar
        self._kept = np.array([0, 1, 5]) if self.planar else np.arange(6)

    @property
    def equations(self) -> int:
        """How many there are: of loops and rows."""
        return len(self._kept) * len(self.chords) + len(self.rows)

    def _exponentials(self, q: Array) -> Array:
        """The motions (N, n, 4, 4) about each screw, at q (N, n)."""
        cosine, sine = 1.0 - np.cos(q), q - np.sin(q)
        X1, X2, X3 = self._powers
        return np.asarray(
            np.eye(4) + q[..., None, None] * X1 + cosine[..., None, None] * X2 + sine[..., None, None] * X3
        )

    def joint(self, number: int, q: Array) -> tuple[Array, Array]:
        """The displacement h (4, 4) of an edge at q (n,), and the twists (m, 6) of its motions there, seen from a."""
        own = slice(self.first[number], self.first[number + 1])
        h, twists = np.eye(4), np.zeros((own.stop - own.start, 6))
        E = self._exponentials(q[None])[0, own]
        for i, screw in enumerate(self.screws[own]):
            twists[i] = moved_screws(h[None], screw[None])[0]
            h = h @ E[i]
        return h, twists

    def frames(self, q: Array) -> tuple[Array, Array]:
        """Bodies (N, b, 4, 4) and what carries each screw (N, n, 4, 4), at q (N, n)."""
        E = self._exponentials(q)
        bodies = np.empty((len(q), len(self.topology.root), 4, 4))
        carried = np.empty((len(q), self.n, 4, 4))
        bodies[:] = np.eye(4)
        for body, number, parent in self.topology.steps:
            forward = self.ends[number][0] == parent
            g = bodies[:, parent]
            columns = range(self.first[number], self.first[number + 1])
            if not forward:
                for j in reversed(columns):
                    g = g @ invert(E[:, j])
                    carried[:, j] = g
            else:
                for j in columns:
                    carried[:, j] = g
                    g = g @ E[:, j]
            bodies[:, body] = g
        self._ends = []
        for chord in self.chords:
            g = bodies[:, self.ends[chord][0]]
            for j in range(self.first[chord], self.first[chord + 1]):
                carried[:, j] = g
                g = g @ E[:, j]
            self._ends.append(g)
        return bodies, carried

    def lack(self, q: Array) -> Array:
        """What loops and rows lack (N, m), at q (N, n)."""
        bodies, _ = self.frames(q)
        return self._lack(q, self._gaps(bodies))

    def both(self, q: Array) -> tuple[Array, Array]:
        """What loops and rows lack (N, m) and its derivative (N, m, n), at q (N, n)."""
        bodies, carried = self.frames(q)
        gaps = self._gaps(bodies)
        R, t = carried[..., :3, :3], carried[..., :3, 3]
        w = (R @ self.screws[:, 3:, None])[..., 0]
        v = (R @ self.screws[:, :3, None])[..., 0] + _cross(t, w)
        N = len(q)
        if not self.chords:
            return q @ self.rows.T, np.broadcast_to(self.rows, (N, *self.rows.shape))
        columns = np.concatenate([v, w], axis=2).transpose(0, 2, 1)  # (N, 6, n)
        there, back = (columns[:, None] * way[None, :, None, :] for way in (self._there, self._back))  # (N, l, 6, n)
        RG, tG = gaps[..., :3, :3], gaps[..., :3, 3]
        turned = there[:, :, 3:] - RG @ back[:, :, 3:]
        moved = there[:, :, :3] - skew(tG) @ there[:, :, 3:] - RG @ back[:, :, :3]
        turned = 0.5 * (np.trace(RG, axis1=2, axis2=3)[..., None, None] * turned - RG @ turned)
        J = np.concatenate([moved, turned], axis=2)[:, :, self._kept].reshape(N, -1, self.n)
        if len(self.rows):
            J = np.concatenate([J, np.broadcast_to(self.rows, (N, *self.rows.shape))], axis=1)
        return self._lack(q, gaps), J

    def _gaps(self, bodies: Array) -> Array:
        """The loops' gaps (N, l, 4, 4)."""
        gaps = np.empty((len(bodies), len(self.chords), 4, 4))
        for k, chord in enumerate(self.chords):
            gaps[:, k] = self._ends[k] @ invert(bodies[:, self.ends[chord][1]])
        return gaps

    def _lack(self, q: Array, gaps: Array) -> Array:
        R, t = gaps[..., :3, :3], gaps[..., :3, 3]
        w = 0.5 * np.stack([R[..., 2, 1] - R[..., 1, 2], R[..., 0, 2] - R[..., 2, 0], R[..., 1, 0] - R[..., 0, 1]], -1)
        lacking = np.concatenate([t, w], axis=2)[:, :, self._kept].reshape(len(q), -1)
        return np.concatenate([lacking, q @ self.rows.T], axis=1) if len(self.rows) else lacking


def _powers(screws: Array) -> tuple[Array, Array, Array]:
    """The matrices S, S², S³ (n, 4, 4) of unit twists (n, 6)."""
    X = np.zeros((len(screws), 4, 4))
    X[:, :3, :3] = skew(screws[:, 3:])
    X[:, :3, 3] = screws[:, :3]
    return X, X @ X, X @ X @ X


def _cross(a: Array, b: Array) -> Array:
    """Cross products (…, 3), without numpy's checks."""
    out = np.empty(np.broadcast_shapes(a.shape, b.shape))
    out[..., 0] = a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1]
    out[..., 1] = a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2]
    out[..., 2] = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return out
