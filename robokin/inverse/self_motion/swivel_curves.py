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
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.self_motion.swivel_arm import SwivelArm, Triples
from robokin.inverse.verify import HALF_TURN
from robokin.kernel.frames import frames

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

    def turns(self, psi: Array) -> tuple[Array, Array]:
        """The triples at ψ (m, 2, K): turns (m, 2, 2, 2, 3, K) by elbow, triple and sign of the middle one; its cosine.

        [rad] in [-π, π], offsets included; the cosine (m, 2, 2, K) is beyond ±1 where there is no turn.
        """
        wave = np.stack([np.ones_like(psi), np.cos(psi), np.sin(psi)], axis=2)
        return _turns(np.moveaxis(self.entries @ wave[:, :, None], 3, 0), self.arm.triples, SIGNS[:, None])

    def configurations(self, row: Index, signs: Index, psi: Array) -> Array:
        """(s, 7) [rad] in [-π, π] the joint values at ψ (s,) of poses (s,).

        signs: (s, 3) by their places in `SIGNS`: of the elbow, the shoulder, the wrist.
        """
        elbow = signs[:, 0]
        wave = np.stack([np.ones_like(psi), np.cos(psi), np.sin(psi)], axis=1)
        g = np.einsum("stjk,sk->jts", self.entries[row, elbow], wave)
        turns, _ = _turns(g, self.arm.triples, SIGNS[signs[:, 1:].T][:, None])
        q = np.empty((len(psi), 7))
        q[:, :3], q[:, 3], q[:, 4:] = turns[0, 0].T, self.q4[row, elbow], turns[1, 0].T
        q -= self.arm.chain.offsets
        q -= TURN * np.round(q / TURN)
        q[q < HALF_TURN - np.pi] += TURN  # -180° is 180°, whatever the last digits say
        return q

    def swivel(self, row: Index, elbow: Index, q: Array) -> Array:
        """(s,) ψ [rad] in [-π, π] of configurations q (s, 7) or (7,) [rad] that reach poses (s,) with elbows (s,)."""
        constants = self.arm.chain.constants
        upper = constants[0][:3, :3].T @ frames(self.arm.chain, np.atleast_2d(q))[:, 3, :3, :3] @ constants[3][:3, :3].T
        bend = (upper @ self.bend[row, elbow, :, None])[..., 0]
        seen = (bend[:, None] @ self.axes[row])[:, 0]
        return np.asarray(np.arctan2(seen[:, 2], seen[:, 1]))


def swivel_curves(arm: SwivelArm, T: Array) -> SwivelCurves:
    """The self-motions at poses T (m, 4, 4) [m]."""
    constants = arm.chain.constants
    base = constants[0]
    p = (T[:, :3, :3] @ arm.wrist + T[:, :3, 3] - base[:3, 3]) @ base[:3, :3] - arm.shoulder
    hand = base[:3, :3].T @ T[:, :3, :3] @ arm.hand
    q4, real, straight, doubt = _elbows(arm, p)
    v_axes, unnamed = _upper_axes(arm, q4)
    p_axes, no_line = _base_axes(p, arm.size)
    doubt |= no_line | np.any(unnamed & real, axis=1)
    doubt |= straight & (np.linalg.norm(p, axis=1) < FIRM * arm.size)
    # The forearm's frame before its turn sees ê, f̂, v̂; the base sees the hand's columns along r̂, n̂, p̂.
    Rz = _about_z(q4)
    forearm = constants[3][:3, :3] @ Rz @ constants[4][:3, :3]
    seen = np.swapaxes(forearm, -1, -2) @ v_axes  # (m, 2, 3, 3) columns v̂, ê, f̂
    along = np.swapaxes(p_axes, -1, -2) @ hand  # (m, 3, 3) rows p̂, r̂, n̂
    m = len(T)
    entries = np.empty((m, 2, 2, 5, 3))
    entries[:, :, 0, :3] = _swung(p_axes[:, None], v_axes[:, :, 2])
    entries[:, :, 0, 3:] = _swung(v_axes, p_axes[:, None, 2], -1.0)[..., :2, :]
    entries[:, :, 1, :3] = _swung(seen, along[:, None, :, 2], -1.0)
    entries[:, :, 1, 3:] = _swung(np.swapaxes(along, 1, 2)[:, None], seen[:, :, 2])[..., :2, :]
    straightest = np.where(straight, 1.0 - np.sqrt(1.0 - FIRM**2), ALIGNED)
    doubt |= np.any((_alignment(arm, entries) < straightest[:, None]) & real, axis=1)
    return SwivelCurves(arm, q4, real, entries, doubt, straight, p_axes, v_axes[..., 1])


def _elbows(arm: SwivelArm, p: Array) -> tuple[Array, Flags, Flags, Flags]:
    """The values (m, 2) of joint 4, offset included, that W - S = p (m, 3) allows; whether there are; whether they are
    taken for one (m,); and doubt (m,).

    |W - S|² = |w|² + |s|² - 2 sᵀ Rz(q4) w, with W and S seen from both sides of the joint.
    """
    C = arm.chain.constants[3]
    s, w = C[:3, :3].T @ (arm.upper - C[:3, 3]), arm.lower
    cosine, sine = s[0] * w[0] + s[1] * w[1], s[1] * w[0] - s[0] * w[1]
    wave = (0.5 * (s @ s + w @ w - np.einsum("mi,mi->m", p, p)) - s[2] * w[2]) / np.hypot(cosine, sine)
    beyond = np.abs(wave) - 1.0
    straight = np.abs(beyond) <= STRAIGHT
    x = np.clip(np.where(straight, np.round(wave), wave), -1.0, 1.0)
    q4 = np.arctan2(sine, cosine) + np.arccos(x)[:, None] * SIGNS
    real = np.stack([straight | (beyond < 0.0), ~straight & (beyond < 0.0)], axis=1)
    return q4, real, straight, ~straight & (np.abs(beyond) < BENT)


def _upper_axes(arm: SwivelArm, q4: Array) -> tuple[Array, Flags]:
    """The directions v̂, ê, f̂ as columns (m, 2, 3, 3) in the frame after joint 3; and (m, 2) where the elbow is next to
    the line, but not on it."""
    C = arm.chain.constants[3]
    v = (_about_z(q4) @ arm.lower) @ C[:3, :3].T + C[:3, 3] - arm.upper
    towards = np.broadcast_to(arm.elbow, v.shape)
    axes, off = _axes(v, towards)
    on_line = off < ON_LINE * arm.size
    if on_line.any():
        axes, _ = _axes(v, np.where(on_line[..., None], np.cross(C[:3, 2], v), towards))
    return axes, ~on_line & (off < OFF_LINE * arm.size)


def _base_axes(p: Array, size: float) -> tuple[Array, Flags]:
    """The directions p̂, r̂, n̂ as columns (m, 3, 3) in the base, r̂ towards axis 1; where W is next to S, or to
    axis 1 but not on it."""
    length = np.linalg.norm(p, axis=1)
    off = np.hypot(p[:, 0], p[:, 1])
    beside = off >= ON_LINE * length
    axes, _ = _axes(p, np.where(beside[:, None], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]))
    return axes, (length < NO_LINE * size) | (beside & (off < OFF_LINE * length))


def _axes(line: Array, towards: Array) -> tuple[Array, Array]:
    """Orthonormal directions (..., 3, 3) as columns, along the line, at right angles to that towards something, across;
    and (...) how far that is from the line."""
    first = line / np.maximum(np.linalg.norm(line, axis=-1, keepdims=True), 1e-300)
    second = towards - np.sum(towards * first, axis=-1, keepdims=True) * first
    second -= np.sum(second * first, axis=-1, keepdims=True) * first  # what rounding left, of a nearly straight elbow
    length = np.linalg.norm(second, axis=-1, keepdims=True)
    second = second / np.maximum(length, 1e-300)
    return np.stack([first, second, np.cross(first, second)], axis=-1), length[..., 0]


def _swung(axes: Array, other: Array, sign: float = 1.0) -> Array:
    """The factors (..., 3, 3) of 1, cos ψ and sin ψ in R(±ψ) x: axes are what its own come to, `other` is x in these.

    axes: (..., 3, 3) as columns; other: (..., 3).
    """
    still = axes[..., 0] * other[..., None, 0]
    cosine = axes[..., 1] * other[..., None, 1] + axes[..., 2] * other[..., None, 2]
    sine = sign * (axes[..., 2] * other[..., None, 1] - axes[..., 1] * other[..., None, 2])
    return np.stack([still, cosine, sine], axis=-1)


def _alignment(arm: SwivelArm, entries: Array) -> Array:
    """(m, 2) how near the cosine of a middle turn comes to ±1 at some ψ; negative where it is beyond."""
    triples = arm.triples
    swing = np.hypot(entries[..., 2, 1], entries[..., 2, 2])
    middle = entries[..., 2, 0] - triples.k
    least = np.minimum(triples.r - (middle + swing), triples.r + (middle - swing)) / triples.r
    return np.asarray(np.min(least, axis=2))


def _about_z(angle: Array) -> Array:
    """Rz (..., 3, 3) of angles (...) [rad]."""
    R = np.zeros((*angle.shape, 3, 3))
    R[..., 0, 0] = R[..., 1, 1] = np.cos(angle)
    R[..., 1, 0] = np.sin(angle)
    R[..., 0, 1], R[..., 2, 2] = -R[..., 1, 0], 1.0
    return R


def _turns(g: Array, triples: Triples, signs: Array) -> tuple[Array, Array]:
    """Turns (..., 2, c, 3, K) of triples for entries g (5, ..., 2, K), and the cosines of the middle ones.

    signs: (c, 1) or (2, 1, K) of the middle turns' sines.
    """
    cosine = (g[2] - triples.k[:, None]) / triples.r[:, None]
    x = np.clip(cosine, -1.0, 1.0)[..., None, :]
    y = np.sqrt((1.0 - x) * (1.0 + x)) * signs
    cp, sp = np.cos(triples.phi)[:, None, None], np.sin(triples.phi)[:, None, None]
    cb, sb = x * cp - y * sp, y * cp + x * sp
    u, v = triples.u[..., None, None], triples.v[..., None, None]
    u0, u1 = (part[0] + part[1] * cb + part[2] * sb for part in u)
    v0, v1 = (part[0] + part[1] * cb + part[2] * sb for part in v)
    g13, g23, _, g31, g32 = g[..., None, :]
    turns = np.empty((*sb.shape[:-1], 3, sb.shape[-1]))
    np.arctan2(g23 * u0 - g13 * u1, g13 * u0 + g23 * u1, out=turns[..., 0, :])
    np.arctan2(sb, cb, out=turns[..., 1, :])
    np.arctan2(v1 * g31 - v0 * g32, v0 * g31 + v1 * g32, out=turns[..., 2, :])
    return turns, cosine
