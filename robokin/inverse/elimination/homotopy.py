"""All complex solutions of a six-joint loop by following paths, and an account of where each of them ends.

Statement. A loop has a generic number N of complex solutions: no target has more isolated ones. From a target at which
all N are known as many paths lead to any other. Where each of them ends in a regular solution, in a singular one or at
infinity, all regular solutions have been found, also where the arm is singular.
Derivation. Near the target of a regular solution all targets have one close by, so that it is where one of the N paths
from a start in general position ends. Regular ends are then all regular solutions. Where all N are known at a pose
close by (`starts_close_by`) the way from there takes a third of the steps; bent into the complex (`paths`), it misses
the targets at which solutions meet as one from a complex start does.
Degenerate case. Two paths may pass so near to each other that a step goes over to the wrong one; then both end alike,
and a regular solution is missing. An account is closed only where two starts, with other targets and so other paths,
agree. For a real target the conjugates of solutions are solutions: this is checked as well.
Reference. C. Wampler, A. Morgan, "Solving the 6R inverse position problem using a generic-case solution methodology",
Mechanism and Machine Theory 26 (1991); A. Morgan, A. Sommese, "Coefficient-parameter polynomial continuation", Applied
Mathematics and Computation 29 (1989).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from robokin.arrays import Array, Complex, Flags, Index
from robokin.inverse.elimination.complex_newton import (
    complex_refine,
    distinct,
    jacobian,
    regular,
)
from robokin.inverse.elimination.homotopy_paths import NEAR, Points, distance, points_of, track
from robokin.inverse.elimination.loop import Loop
from robokin.inverse.elimination.loop_newton import refine
from robokin.inverse.elimination.monodromy import Known, Start, another_start, started, two_starts
from robokin.inverse.elimination.starts_close_by import Beside

BENDS = np.exp(1.3j), np.exp(1.0j)
"""γ of the ways from two targets close by: they go around what is between them and the target, at about a right angle.
Not one the conjugate of the other, which would lead to the conjugate paths."""

REGULAR = 1e-5
"""Least singular value of S above which an end is regular: two solutions that are about as far apart meet at targets
that are about the square of this away, which paths must come nearer to than that."""

APART = 1e-6
"""Regular ends that differ by less in every joint [rad | size] are one: with singular values above `REGULAR` rounding
moves them by 1e-10."""

GROWS_FROM, APART_MOST = 7.0, 1e-3
"""|Im q| [rad] from which that distance grows with exp(2 |Im q|), as rounding does, and its greatest value. No solution
out there is real, but as many have to be counted."""

MOVED = 1e-2
"""Greatest motion [rad | size] of an end's last corrections: what is drawn further does not belong to its path."""

REAL = 1e-7
"""Imaginary part [rad | size] up to which a regular end is real: of a pair of conjugates of which one has singular
values above `REGULAR` each has a larger one."""

NEARLY_REAL = 0.5
"""Imaginary part [rad | size] up to which a singular end is taken for a real one: where four solutions meet, its path
was left at a distance like the fourth root of 1e-9, times what the arm's motion is worth there (0.3 has been seen)."""

SPEED = 0.05
"""Least u times speed of a path that leads to infinity, where it tends to a fraction that is rarely below 1/4; at
singular ends it tends to zero."""

GONE = 2.5
"""|Im q| [rad] (or the logarithm of a slide's length [size]) that such a path has reached at u = 1e-9, 1/8 of 20.7 and
more. A path to a place where four solutions meet, or near a self-motion, may be fast as well, but has not gone far."""

LATE = 1e-3
"""Value of u before which no path is taken to have gone to infinity unless it is as far out as `OUT`."""

SOON, OUT = 0.02, 10.0
"""Where it goes with the square of 1 / u, rounding stops it by u = 0.01 at this |Im q| [rad]. A path that had come
there on its way to somewhere else would have passed the target where it is infinite within exp(-10) or so."""

POLISH = 4
"""Newton steps for ends; from 1e-3, where paths that passed close to a singular solution may have been left, and
less."""

NEARLY_SINGULAR, EXACT = 2e-8, 2e-15
"""Least singular value and greatest relative residual at which an end that is not regular is still a solution of its
own. Rounding leaves some 3e-16 of it."""

FINE_POLISH = 14
"""Newton steps for such ends: from 3e-6, where a path to two solutions that nearly meet is left, each halves the
distance until it is about as great as that between the two."""

ROUNDING = 2e-14
"""Such ends that differ by less than this over their least singular value [rad | size] are one. Of a double solution
rounding makes two ends with a least singular value s of some 4e-8, which are about s apart: a tenth of this over s."""

NEAR_REAL_AXIS = 2.0
"""|Im q| [rad | size] up to which such ends are looked for: farther out rounding grows."""

STEPS = 25
"""Newton steps for the real parts of singular ends: each but halves the error at a double solution."""

SEED = 1e-7
"""What a singular end may then lack of closing [size and rad]: more, and it belongs to complex solutions."""

SAME = 1e-6
"""Singular ends that differ by less in every joint [rad | size] are listed once."""


@dataclass(frozen=True, eq=False)
class Account:
    """Where all paths to m targets end.

    count: N; index: (s,) and values: (s, 6) the regular real solutions [rad | size], the arguments of J1 … J6;
    singular_index, singular_values: the real configurations near ends that are singular, which lie on self-motions or
    are solutions where several meet; regular, singular, infinite, lost: (m,) the paths of one start that ended so, and
    real: (m,) how many of the regular ends are real. closed: (m,) whether all N solutions were found to be regular, or
    from two starts no path was lost and both found the same regular ends, of which no other start found more.
    """

    count: int
    index: Index
    values: Array
    singular_index: Index
    singular_values: Array
    regular: Index
    real: Index
    singular: Index
    infinite: Index
    lost: Index
    closed: Flags

    def words(self, i: int) -> str:
        """A sentence with the numbers for target i."""
        regular, real = self.regular[i], self.real[i]
        parts = [f"{regular} end{'' if regular != 1 else 's'} in regular solutions ({real} real)"]
        if self.singular[i]:
            parts.append(f"{self.singular[i]} in singular ones")
        if self.infinite[i]:
            parts.append(f"{self.infinite[i]} at infinity")
        if self.lost[i]:
            parts.append(f"{self.lost[i]} on the way")
        listed = parts[0] if len(parts) == 1 else ", ".join(parts[:-1]) + " and " + parts[-1]
        return f"of {self.count} paths {listed}" + ("" if self.closed[i] else "; two starts do not agree")


@dataclass(frozen=True, eq=False)
class _Ends:
    """Where the paths (s,) from one start end: the target of each, its values (s, 6) [rad | size], and whether these
    are a regular solution, a singular one, at infinity, or where it was lost on the way; fine: those that are known to
    be solutions of their own, with their values and how far apart from others they must be: regular ones, and singular
    ones that Newton's steps tell apart."""

    target: Index
    values: Complex
    regular: Flags
    singular: Flags
    infinite: Flags
    lost: Flags
    fine: Flags
    fine_values: Complex
    fine_apart: Array

    def part(self, part: slice) -> _Ends:
        """Some of them."""
        return _Ends(*(getattr(self, one.name)[part] for one in fields(self)))


class _Begun(NamedTuple):
    """Where the paths to some targets begin.

    chosen: (m,) the targets; point: (m,) points; values: (6, m, N) the solutions there [rad | size]; bend: γ.
    """

    chosen: Index
    point: Points
    values: Complex
    bend: complex


class Homotopy:
    """What follows the paths of a loop. Starts are made when they are first needed, and kept."""

    def __init__(
        self,
        loop: Loop,
        known: Callable[[], list[Known]] | None = None,
        beside: Callable[[Array], Beside] | None = None,
    ) -> None:
        """`known` gives all solutions at two targets, if another solver can: a start is then one track away.

        `beside` gives all those at two targets close to each of some, as far as it can, which makes short ways.
        """
        self.loop, self._known, self._beside = loop, known, beside
        self._starts: list[Start] = []

    @cached_property
    def count(self) -> int | None:
        """N, the generic number of complex solutions; None where two independent searches do not agree on it.

        It is even: an odd one is not believed.
        """
        found = started(self.loop, self._known()) if self._known is not None else None
        found = found or two_starts(self.loop)
        if found is None:
            return None
        number: int = found[0].values.shape[1]
        if number % 2:
            return None
        self._starts = list(found)
        return number

    def account(self, closing: Array, most: int = 4) -> Account:
        """Follow all paths to L6 (m, 4, 4) from two starts, and from more, where these do not agree.

        These are two targets close by where all solutions are known, else two complex ones that serve for all; then
        further ones of these, up to `most`. Raises ValueError where the number of solutions is not known.
        """
        if self.count is None:
            raise ValueError("the number of complex solutions of this arm could not be established")
        m = len(closing)
        begun = self._close_by(closing)
        used = np.full(m, 2)
        for one in begun:
            used[one.chosen] = 0
        begun += [self._far(k, np.flatnonzero(used == 2)) for k in range(2)]
        tried = self._ends(closing, begun)
        verdict = _judged(self.loop, self.count, m, tried)
        for k in (0, *range(2, most)):
            # After starts close by two that serve for all, thereafter one more.
            starts = range(2) if k == 0 else range(k, k + 1)
            open_ = np.flatnonzero(~verdict.closed & (used == k))
            if len(open_) and all(self._start(i) is not None for i in starts):
                tried += self._ends(closing, [self._far(i, open_) for i in starts])
                verdict = _judged(self.loop, self.count, m, tried)
                used[open_] = starts.stop
        return _with_paths_near_motions(self.loop, closing, _with_seeds_refined(self.loop, closing, verdict), tried)

    def _close_by(self, closing: Array) -> list[_Begun]:
        """Starts for those of the targets beside which all solutions are known at two poses."""
        found = None if self._beside is None else self._beside(closing)
        if found is None or not len(found.chosen) or found.values.shape[2] != self.count:
            return []
        return [
            _Begun(found.chosen, points_of(near), np.ascontiguousarray(values.transpose(2, 0, 1)), bend)
            for near, values, bend in zip(found.closing, found.values, BENDS, strict=True)
        ]

    def _far(self, k: int, chosen: Index) -> _Begun:
        """Start k for some targets (m,)."""
        start = self._starts[k]
        many = np.broadcast_to(start.values[:, None], (6, len(chosen), start.values.shape[1]))
        return _Begun(chosen, start.point.pick(np.zeros(len(chosen), dtype=np.intp)), many, 1.0)

    def _start(self, k: int) -> Start | None:
        """Start k, from 0: the first two are independent, further ones are reached from the first, if they are."""
        while len(self._starts) <= k:
            more = another_start(self.loop, self._starts[0], seed=100 + len(self._starts))
            if more is None:
                return None
            self._starts.append(more)
        return self._starts[k]

    def _ends(self, closing: Array, begun: list[_Begun]) -> list[_Ends]:
        """The ends of the paths from some starts, all followed together."""
        loop = self.loop
        N = begun[0].values.shape[2]
        target = np.concatenate([np.repeat(one.chosen, N) for one in begun])
        bend = np.concatenate([np.full(N * len(one.chosen), one.bend, dtype=np.complex128) for one in begun])
        home = Points(
            np.concatenate([np.repeat(one.point.r, N, axis=1) for one in begun], axis=1),
            np.concatenate([np.repeat(one.point.p, N, axis=1) for one in begun], axis=1),
        )
        at = np.concatenate([one.values.reshape(6, -1) for one in begun], axis=1)
        ends = track(loop, home, points_of(closing).pick(target), at, bend)
        values = np.ascontiguousarray(ends.values.T)
        # Paths left shortly before a nearly singular solution may still reach it: all that came near the end are tried.
        late = np.flatnonzero(~ends.lost & (ends.u < LATE))
        refined, residual = complex_refine(loop, closing, target[late], values[late], POLISH)
        moved = np.abs(refined - values[late]).max(axis=1, initial=0.0)
        good = np.flatnonzero(regular(loop, refined, residual, REGULAR) & (moved < MOVED))
        values[late[good]] = refined[good]
        whole = np.zeros(len(target), dtype=bool)
        whole[late[good]] = True
        out = distance(loop, ends.values)
        gone = np.where(ends.u < LATE, out > GONE, (ends.u < SOON) & (out > OUT))
        infinite = ~whole & gone & (ends.speed > SPEED)
        lost = ~whole & ~infinite & (ends.lost | (ends.u > NEAR))
        singular = ~whole & ~infinite & ~lost
        fine = _told_apart(loop, closing, target, values, whole, np.flatnonzero(singular & (ends.u < LATE)))
        everything = _Ends(target, values, whole, singular, infinite, lost, *fine)
        last = np.cumsum([N * len(one.chosen) for one in begun]).tolist()
        return [everything.part(slice(end - N * len(one.chosen), end)) for one, end in zip(begun, last, strict=True)]


def _told_apart(
    loop: Loop, closing: Array, target: Index, values: Complex, whole: Flags, rows: Index
) -> tuple[Flags, Complex, Array]:
    """Which ends (s,) are known to be solutions of their own, their values (s, 6) and `_apart` of each.

    whole: (s,) the regular ones; rows: (k,) those that may be so close to others that they are not called regular.
    """
    fine, exact, apart = whole.copy(), values.copy(), _apart(values)
    rows = rows[np.abs(values[rows].imag).max(axis=1, initial=0.0) < NEAR_REAL_AXIS]
    refined, residual = complex_refine(loop, closing, target[rows], values[rows], FINE_POLISH)
    moved = np.abs(refined - values[rows]).max(axis=1, initial=0.0)
    sure = regular(loop, refined, np.zeros(len(rows)), NEARLY_SINGULAR) & (residual < EXACT) & (moved < MOVED)
    rows = rows[sure]
    fine[rows], exact[rows] = True, refined[sure]
    if len(rows):
        least = np.linalg.svd(jacobian(loop, np.ascontiguousarray(exact[rows].T)), compute_uv=False)[:, -1]
        apart[rows] = ROUNDING / least
    return fine, exact, apart


def _judged(loop: Loop, count: int, m: int, tried: list[_Ends]) -> Account:
    """The account of m targets from the ends of several starts of `count` paths each."""
    sound = np.stack([_sound(loop, m, ends) for ends in tried])
    target, values, _ = _united(loop, tried, "regular")
    number = np.bincount(target, minlength=m)
    found = np.stack([_number(m, ends.target, ends.regular) for ends in tried])
    agrees = _alike(sound & (found == number), np.stack([_number(m, ends.target, ends.infinite) for ends in tried]))
    real = np.abs(values.imag).max(axis=1, initial=0.0) < REAL
    whole = number == count
    if not whole.all():
        # Where singular ends, told apart, make it all N, these are all.
        fine_target, fine_values, apart = _united(loop, tried, "fine")
        told = ~whole & (np.bincount(fine_target, minlength=m) == count)
        kept, more = ~told[target], told[fine_target]
        near_real = 2.0 * np.abs(fine_values.imag).max(axis=1, initial=0.0) < apart
        target, values = np.append(target[kept], fine_target[more]), np.append(values[kept], fine_values[more], axis=0)
        real, whole = np.append(real[kept], near_real[more]), whole | told
        number = np.where(told, count, number)
    best, every = np.argmax(agrees, axis=0), np.arange(m)

    def of_one_start(kind: str) -> Index:
        numbers = np.stack([_number(m, ends.target, getattr(ends, kind)) for ends in tried])[best, every]
        return np.asarray(np.where(whole, 0, numbers))

    singular = [
        ends.singular & ~whole[ends.target] & (np.abs(ends.values.imag).max(axis=1, initial=0.0) < NEARLY_REAL)
        for ends in tried
    ]
    return Account(
        count,
        target[real],
        values[real].real.copy(),
        np.concatenate([ends.target[chosen] for ends, chosen in zip(tried, singular, strict=True)]),
        np.concatenate([ends.values[chosen].real for ends, chosen in zip(tried, singular, strict=True)]),
        np.where(whole, count, found[best, every]),
        np.bincount(target[real], minlength=m),
        of_one_start("singular"),
        of_one_start("infinite"),
        of_one_start("lost"),
        whole | ((agrees.sum(axis=0) >= 2) & (number < count)),
    )


def _alike(agrees: Flags, infinite: Index) -> Flags:
    """(k, m) which of k starts agree on the regular ends, and of these with another on how many (k, m) are infinite.

    Where only one agrees it is left as it is.
    """
    same = (infinite[:, None] == infinite[None]) & agrees[:, None] & agrees[None]
    paired = agrees & (same.sum(axis=1) >= 2)
    return np.where(agrees.sum(axis=0) >= 2, paired, agrees)


def _united(loop: Loop, tried: list[_Ends], which: str) -> tuple[Index, Complex, Array]:
    """The ends of one kind from all starts, and their conjugates, each once: targets (s,), values (s, 6) and how far
    each must be from others (s,)."""
    kind = [getattr(ends, which) for ends in tried]
    target = np.concatenate([ends.target[mine] for ends, mine in zip(tried, kind, strict=True)])
    values = np.concatenate([ends.fine_values[mine] for ends, mine in zip(tried, kind, strict=True)])
    apart = np.concatenate([ends.fine_apart[mine] for ends, mine in zip(tried, kind, strict=True)])
    target, values, apart = np.tile(target, 2), np.concatenate([values, values.conj()]), np.tile(apart, 2)
    once = distinct(loop, target, values, apart)
    return target[once], values[once], apart[once]


def _sound(loop: Loop, m: int, ends: _Ends) -> Flags:
    """(m,) whether no path was lost, no two ended in the same regular solution, and conjugates are among the ends."""
    target, values = ends.target[ends.regular], ends.values[ends.regular]
    number = np.bincount(target, minlength=m)
    once = distinct(loop, target, values, _apart(values))
    twice = np.concatenate([target, target])
    conjugates = np.concatenate([values, values.conj()])
    both = distinct(loop, twice, conjugates, _apart(conjugates))
    all_arrive = (np.bincount(ends.target, minlength=m) > 0) & (_number(m, ends.target, ends.lost) == 0)
    return np.asarray(all_arrive & (number == _number(m, target, once)) & (number == _number(m, twice, both)))


def _with_seeds_refined(loop: Loop, closing: Array, account: Account) -> Account:
    """The account with the singular configurations brought onto solutions.

    Those that are near none are left out, and their targets not closed: real solutions may be near by, so near to
    each other that they were not told apart.
    """
    index, values = account.singular_index, account.singular_values
    values, position, angle = refine(loop, closing, index, values, STEPS)
    near = np.hypot(position, angle) < SEED
    closed = account.closed.copy()
    closed[index[~near]] = False
    index, values = index[near], values[near]
    once = distinct(loop, index, values, SAME)
    return replace(account, singular_index=index[once], singular_values=values[once], closed=closed)


def _with_paths_near_motions(loop: Loop, closing: Array, account: Account, tried: list[_Ends]) -> Account:
    """The account with the targets not closed at which paths may have gone astray instead of to infinity.

    Next to a pose with a self-motion the curve of this, which goes to infinity where it is complex, nearly solves the
    loop: a path may follow it out, past the solution where it would end. The real part of such an end is then close to
    a singular solution, which becomes one of the singular configurations.
    """
    doubtful = account.closed & (account.infinite > 0)
    wandering = [(ends.infinite | ends.singular) & doubtful[ends.target] for ends in tried]
    target = np.concatenate([ends.target[chosen] for ends, chosen in zip(tried, wandering, strict=True)])
    values = np.concatenate([ends.values[chosen] for ends, chosen in zip(tried, wandering, strict=True)])
    near = np.abs(values.imag).max(axis=1, initial=0.0) < OUT
    target, seeds = target[near], values[near].real
    if not len(target):
        return account
    seeds, position, angle = refine(loop, closing, target, seeds, STEPS)
    residual = np.hypot(position, angle)
    astray = (residual < SEED) & ~regular(loop, seeds, np.zeros(len(seeds)), REGULAR)
    index = np.concatenate([account.singular_index, target[astray]])
    values = np.concatenate([account.singular_values, seeds[astray]])
    once = distinct(loop, index, values, SAME)
    closed = account.closed.copy()
    closed[target[astray]] = False
    return replace(account, singular_index=index[once], singular_values=values[once], closed=closed)


def _apart(values: Complex) -> Array:
    """The distance (s,) [rad | size] below which regular ends (s, 6) are one."""
    beyond = np.abs(values.imag).max(axis=1, initial=0.0) - GROWS_FROM
    return np.asarray(np.minimum(APART * np.exp(2.0 * np.clip(beyond, 0.0, GROWS_FROM)), APART_MOST))


def _number(m: int, target: Index, chosen: Flags) -> Index:
    return np.bincount(target[chosen], minlength=m)
