"""Six joints in general: elimination by Raghavan and Roth, the roots as eigenvalues by Manocha and Canny.

Statement. Given a loop J0 M0 J1 M1 … J5 M5 = I of six joints, each of which turns or slides, find all joint values.

When, and how many. At most 16 solutions, for regular poses an even number. Any of the six joints may play J0, and
the loop may be followed backwards: twelve splits, all of them right, but where axes are parallel or meet some have
equations that vanish identically. `choose_splits` finds those that serve by trying them.

Derivation. Joint 3 is free to turn (or slide) the frame X = M5 J0 M0 J1 M1 J2 M2 into Y = J5⁻¹ M4⁻¹ J4⁻¹ M3⁻¹, so
fourteen functions of X and of Y must agree, and these are of first degree in (cos, sin) of every joint, or of second
in the d of one that slides (`fourteen`).
 1. The functions of Y are G g, g the 8 products other than 1 of (1, c4, s4) and (1, c5, s5). Six combinations N of the
    fourteen equations, NG = 0, are free of them: E(θ0) f = 0, where f are the 9 products of joints 1 and 2.
 2. Half-angle tangents turn f into v = (1, y, y²) × (1, w, w²). E v = 0 and y E v = 0 are 12 equations, linear in the
    12 products of (1, y, y², y³) and (1, w, w²). They have a solution where det M(x) = 0, x = tan(θ0 / 2): eigenvalues
    of a matrix polynomial, with v as eigenvectors, from which y and w are read.
 3. Where E has cosine and sine of θ0, E = E1 + c Ec + s Es, the rank of Ec + i Es is but 4: a pair of each of the four
    vectors turns with J0. The degree of det M is therefore 16 and not 24, the other 8 roots being x = ±i. With
    u E- = 0 for E- = Ec + i Es, the row u E (cos θ0/2 - i sin θ0/2) is of first degree in half the angle. So rows are
    combined such that as many as possible are free of θ0 (real u) or, in pairs, of first degree (complex u), and
    v and x A2 v, with A2 the quadratic rows alone, obey a 16 × 16 eigenvalue problem. If this structure is not
    clear-cut, and where J0 slides, the 24 × 24 problem of all 12 quadratic rows takes its place.
 4. Joints 4 and 5 follow from the functions of X that are now known, joint 3 from X and Y.

Degenerate case. M is singular for all x: another split. Roots that coincide mix their eigenvectors: another split, or
a loop that is wrong by a trifle, the solutions of which are then refined on the true one. x = ∞ is kept away by an
arbitrary `shift` of θ0; the products are read as ratios, so that y = ∞ and w = ∞ do no harm.

M. Raghavan, B. Roth, "Inverse kinematics of the general 6R manipulator and related linkages", J. Mechanical Design
115(3), 1993; D. Manocha, J. F. Canny, "Efficient inverse kinematics for general 6R manipulators", IEEE Trans. Robotics
and Automation 10(5), 1994. That A(XY) = A(X) A(Y), which spares all symbols, and the rows of low degree are ours.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from robokin.arrays import Array, Complex, Index
from robokin.inverse.elimination import fourteen_functions, pencil
from robokin.inverse.elimination.fourteen_functions import X_PARTS, angle_of
from robokin.inverse.elimination.loop import Candidates, ComplexCandidates, Loop
from robokin.spatial import invert, rotation_from_rpy, transform

SPLITS = 12
"""Six places for the loop to start, each followed forwards (0 … 5) or backwards (6 … 11). 12 … 23 are the same
splits of a loop that is wrong by `PERTURBATION`."""

PERTURBATION = 1e-5
"""Errors given to links [rad | size] to separate roots that coincide: the vectors of two roots so far apart keep some
ten digits, and the solutions are near enough for Newton's steps."""

SHIFT = 0.7
"""θ0 is measured from here [rad], or d0 rotated by it as a ratio: not a fraction of a turn that a robot would use."""

IMAGINARY = 1e-2
"""Roots x of which |Im x| / (1 + |x|²) is less are tried as real. A double root computed from data that is wrong by e
moves by √e: this is the root of 1e-4, for poses and arms near-singular as they come."""

LARGEST = 1e100
"""Roots that a singular pencil makes greater still are infinite; the square of this is not."""

FARTHEST = 1e6
"""A joint that is to slide further than this [size] comes from a root at infinity."""

REAL = 1e-9
"""Im x above which a root is also tried as what it is, a complex one: up to `IMAGINARY` it may be either."""

STEEPEST = 20.0
"""An imaginary part of an angle [rad] beyond this comes from a root at ±i: sines of 1e8 have lost the arm."""

SPURIOUS = 1e-6
"""|x² + 1| of a root that is one of the equations' own x = ±i, but for rounding of a multiple root."""

# The half-angle tangent's (1, y, y²) make (1 + y²) (1, cos, sin).
_HALF = np.array([[1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [0.0, 2.0, 0.0]])


class Equations(NamedTuple):
    """The equations for some targets: M0 … M5, each (b, 4, 4), and M4⁻¹ J4⁻¹ M3⁻¹ on the functions of joint 4
    (b, 15, 3); the matrix C (b, n, n) whose eigenvalues are the roots, and what its vectors are given in, (b, 12, k).

    b is 1 for what does not depend on the target.
    """

    links: list[Array]
    V: Array
    C: Array
    kept: Array | None


class Elimination:
    """A solver for one split of a loop.

    split: 0 … 23. shift: where the half angle of the first joint is measured from [rad]. perturbation: the size of the
    links' errors for splits from 12 on; candidates are then that far from the solutions.
    """

    def __init__(self, loop: Loop, split: int, shift: float = SHIFT, perturbation: float = PERTURBATION) -> None:
        self.split, self.imaginary = split, IMAGINARY
        if split >= SPLITS:
            loop = _perturbed(loop, perturbation)
            self.imaginary = max(IMAGINARY, 3.0 * perturbation**0.5)
        first, self.backwards = split % 6, split % SPLITS >= 6
        # Followed backwards the loop is J6⁻¹ L5⁻¹ J5⁻¹ … J1⁻¹ L6⁻¹: a joint's inverse is the joint at minus its value.
        self.joints = (first - np.arange(6)) % 6 if self.backwards else (first + np.arange(6)) % 6
        after = (self.joints - 1) % 6 if self.backwards else self.joints
        self._links = [
            None if i == 5 else (invert(loop.links[i]) if self.backwards else loop.links[i])[None] for i in after
        ]
        turns = [bool(loop.revolute[i]) for i in self.joints]
        self._turning = np.flatnonzero(loop.revolute)
        self._turns, self._free_turns = turns, turns[3]
        self._forth = [fourteen_functions.joint_action(turns[i], turns[3]) for i in range(3)]
        self._back = {i: fourteen_functions.joint_action(turns[i], turns[3], backwards=True) for i in (4, 5)}
        self._left_alone = fourteen_functions.invariants(turns[5], turns[3])
        self._products = np.kron(*(_HALF if turns[i] else np.eye(3) for i in (1, 2)))
        self.shift, self._zero = shift, np.eye(4)
        self._parts: dict[str, Array] = {}
        if turns[0]:
            self._zero[:2, :2] = [[np.cos(shift), -np.sin(shift)], [np.sin(shift), np.cos(shift)]]
        # The rows' degrees hold for all targets, reachable or not; two random ones show them.
        rng = np.random.default_rng(6)
        targets = transform(rotation_from_rpy(rng.uniform(-3.0, 3.0, (2, 3))), rng.normal(size=(2, 3)))
        self.degrees = pencil.degrees(self._equations(self._around(targets))[1]) if turns[0] else None

    def links(self) -> tuple[int, Array]:
        """Which of M0 … M5 depends on the target, and all (6, 4, 4), the identity in its place."""
        place = next(i for i, M in enumerate(self._links) if M is None)
        return place, np.concatenate([np.eye(4)[None] if M is None else M for M in self._links])

    def candidates(self, closing: Array) -> Candidates:
        """Approximate solutions for L6 (m, 4, 4)."""
        return self.all_candidates(closing, complex_too=False)[0]

    def all_candidates(self, closing: Array, complex_too: bool = True) -> tuple[Candidates, ComplexCandidates]:
        """Approximate solutions for L6 (m, 4, 4): the real ones, and one of each conjugate pair of the complex ones."""
        links, V, C, kept = self.equations(closing)
        roots, vectors = pencil.eigenvectors(np.broadcast_to(C, (len(closing), *C.shape[1:])))
        size = np.minimum(np.abs(roots), LARGEST)
        imaginary = self.imaginary * (1.0 + size * size)

        def products(index: Index, which: Index) -> Complex:
            v = vectors[index, : 12 if kept is None else kept.shape[-1], which]
            return v if kept is None else (_of(kept, index) @ v[..., None])[..., 0]

        index, which = np.nonzero(np.abs(roots.imag) <= imaginary)
        near, v = pencil.separated(index, roots[index, which], products(index, which))
        # Two real roots that are so near that they come out as a pair x ± iδ are taken for x ± δ.
        real = Candidates(*self._candidates(links, V, index, near.real + near.imag, v.real + v.imag))
        if not complex_too:
            return real, ComplexCandidates(np.empty(0, dtype=np.intp), np.empty((0, 6), dtype=complex))
        # Spurious roots x = ±i stand for no angle.
        index, which = np.nonzero((roots.imag > REAL) & (np.abs(roots * roots + 1.0) > SPURIOUS))
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            found = self._candidates(links, V, index, roots[index, which], products(index, which))
        return real, ComplexCandidates(*found)

    def equations(self, closing: Array) -> Equations:
        """The equations for L6 (m, 4, 4)."""
        links = self._around(closing)
        E, turning, V = self._equations(links)
        if self.degrees is not None:
            return Equations(links, V, *pencil.of_turning(E, turning, self.degrees))
        return Equations(links, V, *pencil.of_quadratic(E, self._turns[0], self.shift))

    def _candidates(
        self, links: list[Array], V: Array, index: Index, x: NDArray[Any], products: NDArray[Any]
    ) -> tuple[Index, NDArray[Any]]:
        """Targets and values of candidates for roots x (s,) and products (s, 12), all real or all complex.

        index: (s,) the targets that they belong to.
        """
        values = np.empty((len(x), 6), dtype=x.dtype)
        values[:, self.joints] = self._joint_values(links, V, index, x, products).T
        if self.backwards:
            values = -values
        sound = np.all(np.abs(values) < FARTHEST, axis=1)
        sound &= np.all(np.abs(values.imag[:, self._turning]) < STEEPEST, axis=1)
        return index[sound], values[sound]

    def _around(self, closing: Array) -> list[Array]:
        """M0 … M5, each (1, 4, 4) or, the one that is L6 or its inverse, (m, 4, 4)."""
        target = invert(closing) if self.backwards else closing
        return [target if M is None else M for M in self._links]

    def _equations(self, M: list[Array]) -> tuple[Array, Complex, Array]:
        """E on 1, cos, sin or 1, d, d² of joint 0 (b, 3, 6, 9), what of it turns (b, 6, 4), and M4⁻¹ J4⁻¹ M3⁻¹
        on those of joint 4 (b, 15, 3). b is 1 for all that does not depend on the target."""
        F = self._once("ahead", (0, 1, 2), lambda: self._ahead(M))
        V = self._once("behind", (3, 4), lambda: self._behind(M))
        N = self._once("free of the last", (3, 4), lambda: self._free_of_last(V))
        N = N @ self._once("between", (5,), lambda: fourteen_functions.action(M[5], self._free_turns))
        E = (N[:, None] @ self._forth[0]) @ F[:, None]
        return E, N[..., X_PARTS] + 1j * N[..., X_PARTS + 1], V

    def _once(self, name: str, places: tuple[int, ...], part: Callable[[], Array]) -> Array:
        """A part of the equations, which is kept where none of the links in these places depends on the target."""
        if any(self._links[i] is None for i in places):
            return part()
        if name not in self._parts:
            self._parts[name] = part()
        return self._parts[name]

    def _ahead(self, M: list[Array]) -> Array:
        """The functions of what joints 1 and 2 and M0, M1 and M2 do, on their products (b, 15, 9)."""
        free = self._free_turns
        F = fourteen_functions.action(M[2], free) @ fourteen_functions.start(free)[:, None]
        F = fourteen_functions.action(M[1], free) @ _times_joint(self._forth[2], F)
        return fourteen_functions.action(self._zero @ M[0], free) @ _times_joint(self._forth[1], F) @ self._products

    def _behind(self, M: list[Array]) -> Array:
        """M4⁻¹ J4⁻¹ M3⁻¹ on the functions of joint 4 (b, 15, 3)."""
        free = self._free_turns

        def first() -> Array:
            V = fourteen_functions.action(invert(M[3]), free) @ fourteen_functions.start(free)[:, None]
            return _times_joint(self._back[4], V)

        return fourteen_functions.action(invert(M[4]), free) @ self._once("first behind", (3,), first)

    def _free_of_last(self, V: Array) -> Array:
        """Six combinations (b, 6, 15) of the functions that are free of joints 4 and 5."""
        G = _times_joint(self._back[5], V)[:, 1:]
        N = np.swapaxes(np.linalg.qr(G[..., 1:], mode="complete")[0][..., 8:], -1, -2)
        return np.concatenate([-N @ G[..., :1], N], axis=-1)

    def _joint_values(self, M: list[Array], V: Array, index: Index, x: Array, v: Array) -> Array:
        """The values (6, s) of all joints for roots x (s,) and products v (s, 12)."""
        turns, q = self._turns, np.empty((6, len(x)), dtype=x.dtype)
        q[0] = 2.0 * np.arctan(x) + self.shift if turns[0] else _within_reach(np.tan(np.arctan(x) + self.shift))
        products = v.reshape(-1, 4, 3)
        squares, s = np.square(np.abs(products)), np.arange(len(x))
        q[1] = _ratio(products[s, :, np.argmax(squares.sum(axis=1), axis=1)], turns[1])
        q[2] = _ratio(products[s, np.argmax(squares.sum(axis=2), axis=1)], turns[2])
        X = _columns_of(_of(M[5], index), q)
        for i in range(3):
            X = _times_link(_after_joint(X, turns[i], q[i]), _of(M[i], index))
        f, V = fourteen_functions.of_frames(X.transpose(2, 1, 0), self._free_turns), _of(V, index)
        # Joint 5 leaves some functions alone: in these joint 4 is found, by least squares in (c, s) or (d, d²).
        B = V[:, self._left_alone]
        a, b, e = B[..., 1], B[..., 2], f[:, self._left_alone] - B[..., 0]
        ah, bh = (a.conj(), b.conj()) if np.iscomplexobj(a) else (a, b)
        aa, ab, bb, ae, be = (np.einsum("sk,sk->s", u, w) for u, w in ((ah, a), (ah, b), (bh, b), (ah, e), (bh, e)))
        if turns[4]:
            ba = ab.conj() if np.iscomplexobj(ab) else ab
            q[4] = angle_of(bb * ae - ab * be, aa * be - ba * ae, aa * bb - ab * ba)
            powers = np.cos(q[4]), np.sin(q[4])
        else:
            area = (aa * bb - ab * (ab.conj() if np.iscomplexobj(ab) else ab)).real
            # Where d² does not occur its coefficients are rounding.
            straight = area <= 1e-20 * (aa * aa).real
            q[4] = np.where(straight, ae / (aa + 1e-300), (bb * ae - ab * be) / np.where(straight, 1.0, area))
            q[4] = _within_reach(q[4])
            powers = q[4], q[4] * q[4]
        g = V[..., 0] + V[..., 1] * powers[0][:, None] + V[..., 2] * powers[1][:, None]
        q[5] = -fourteen_functions.moved(turns[5], self._free_turns, g, f)
        Y = _columns_of(np.eye(4)[None], q)
        for i in (5, 4):
            Y = _times_link(_after_joint(Y, turns[i], -q[i]), _of(invert(M[i - 1]), index))
        # Joint 3 turns or slides X to Y.
        if turns[3]:
            xx, yy, yx, xy = (_dots(X[i], Y[j]) for i, j in ((0, 0), (1, 1), (1, 0), (0, 1)))
            q[3] = angle_of(xx + yy, yx - xy, 2.0)
        else:
            q[3] = _dots(X[2], Y[3] - X[3])
        return q


def _perturbed(loop: Loop, size: float) -> Loop:
    """The loop with small random errors in its links: size [rad | size of the arm]."""
    rng = np.random.default_rng(5)
    errors = transform(rotation_from_rpy(size * rng.normal(size=(5, 3))), size * rng.normal(size=(5, 3)))
    return replace(loop, links=loop.links @ errors)


def _times_joint(joint: Array, V: Array) -> Array:
    """A(J) V for A(J) on three functions of the joint: (3, 15, 15) and (b, 15, k) make (b, 15, 3 k)."""
    k = V.shape[-1]
    products = (joint.reshape(45, 15) @ V).reshape(-1, 3, 15, k)
    return np.swapaxes(products, 1, 2).reshape(-1, 15, 3 * k)


def _columns_of(M: Array, q: NDArray[Any]) -> NDArray[Any]:
    """Columns x, y, z, p (4, 3, s) of frames M, (1, 4, 4) or (s, 4, 4), real or complex as joint values q (6, s)."""
    X = np.empty((4, 3, q.shape[1]), dtype=q.dtype)
    X[:] = M[:, :3].transpose(2, 1, 0)
    return X


def _after_joint(X: NDArray[Any], turns: bool, q: NDArray[Any]) -> NDArray[Any]:
    """X J for columns X (4, 3, s), overwritten, and a joint at q (s,)."""
    if turns:
        c, sine = np.cos(q), np.sin(q)
        X[0], X[1] = X[0] * c + X[1] * sine, X[1] * c - X[0] * sine
    else:
        X[3] += q * X[2]
    return X


def _dots(a: NDArray[Any], b: NDArray[Any]) -> NDArray[Any]:
    """(s,) the products of vectors (3, s), each summed in the same order."""
    return np.asarray(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


def _times_link(X: NDArray[Any], M: Array) -> NDArray[Any]:
    """X M for columns X (4, 3, s) and a link, (1, 4, 4) or of each (s, 4, 4).

    Sums in one order, whatever s: a product by BLAS has other last digits for another number of columns.
    """
    out = np.empty_like(X)
    columns = M[0].T.tolist() if len(M) == 1 else M.transpose(2, 1, 0)
    for j, entries in enumerate(columns):
        out[j] = X[0] * entries[0] + X[1] * entries[1] + X[2] * entries[2]
    out[3] += X[3]
    return out


def _of(array: Array, index: Index) -> Array:
    """What candidates with an index (s,) have of an array (b, ...): (s, ...), or (1, ...) if all have the same."""
    return array if len(array) == 1 else array[index]


def _ratio(powers: Array, turns: bool) -> Array:
    """The value (s,) of a joint from a multiple of (1, y, y², …): (s, k). The greater of the ends is trusted."""
    low = np.abs(powers[:, 0]) >= np.abs(powers[:, -1])
    one, y = np.where(low, powers[:, :2].T, powers[:, -2:].T)
    if turns:
        if np.iscomplexobj(y):
            # tan(q / 2) = y / one
            return np.asarray(-1j * np.log((one + 1j * y) / (one - 1j * y)))
        return np.asarray(2.0 * np.arctan2(y, one))
    far = np.abs(y) >= FARTHEST * np.abs(one)
    return _within_reach(np.where(far, FARTHEST, y / np.where(far, 1.0, one)))


def _within_reach(d: Array) -> Array:
    """What a joint slides (s,), kept so small that its square and the like are still numbers."""
    return d if np.iscomplexobj(d) else np.clip(d, -FARTHEST, FARTHEST)
