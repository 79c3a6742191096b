"""An account of where the paths of a homotopy end: in regular solutions, in singular ones, at infinity or on the way.

Statement. Of the ends of all paths to some targets say which are solutions, and of which targets none is missing.
Derivation. Regular ends that differ are different solutions; where they are N there is no other. Where they are fewer,
two starts with other paths must agree, none of their paths lost, and conjugates of ends must be ends. Singular ends are
brought onto real solutions by damped Newton steps.
Degenerate case. Where ends are neither told apart nor brought onto solutions the target stays open.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from robokin.arrays import Array, Complex, Flags, Index
from robokin.inverse.elimination.complex_newton import complex_refine, distinct, jacobian, regular
from robokin.inverse.elimination.loop import Loop
from robokin.inverse.elimination.loop_newton import refine

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

SOON, OUT = 0.02, 10.0
"""Where it goes with the square of 1 / u, rounding stops it by u = 0.01 at this |Im q| [rad]. A path that had come
there on its way to somewhere else would have passed the target where it is infinite within exp(-10) or so."""

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
class Ends:
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

    def part(self, part: slice) -> Ends:
        """Some of them."""
        return Ends(*(getattr(self, one.name)[part] for one in fields(self)))


def told_apart(
    loop: Loop, closing: Array, target: Index, values: Complex, whole: Flags, rows: Index
) -> tuple[Flags, Complex, Array]:
    """Which ends (s,) are known to be solutions of their own, their values (s, 6) and `_apart` of each.

    whole: (s,) the regular ones; rows: (k,) those that may be so close to others that they are not called regular.
    """
    fine, exact, apart = whole.copy(), values.copy(), _apart(values)
    rows = rows[np.abs(values[rows].imag).max(axis=1, initial=0.0) < NEAR_REAL_AXIS]
    if not len(rows):
        return fine, exact, apart
    refined, residual = complex_refine(loop, closing, target[rows], values[rows], FINE_POLISH)
    moved = np.abs(refined - values[rows]).max(axis=1, initial=0.0)
    sure = regular(loop, refined, np.zeros(len(rows)), NEARLY_SINGULAR) & (residual < EXACT) & (moved < MOVED)
    rows = rows[sure]
    fine[rows], exact[rows] = True, refined[sure]
    if len(rows):
        least = np.linalg.svd(jacobian(loop, np.ascontiguousarray(exact[rows].T)), compute_uv=False)[:, -1]
        apart[rows] = ROUNDING / least
    return fine, exact, apart


def judged(loop: Loop, count: int, m: int, tried: list[Ends]) -> Account:
    """The account of m targets from the ends of several starts of `count` paths each."""
    sound = _sound(loop, m, tried)
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


def _united(loop: Loop, tried: list[Ends], which: str) -> tuple[Index, Complex, Array]:
    """The ends of one kind from all starts, and their conjugates, each once: targets (s,), values (s, 6) and how far
    each must be from others (s,)."""
    kind = [getattr(ends, which) for ends in tried]
    target = np.concatenate([ends.target[mine] for ends, mine in zip(tried, kind, strict=True)])
    values = np.concatenate([ends.fine_values[mine] for ends, mine in zip(tried, kind, strict=True)])
    apart = np.concatenate([ends.fine_apart[mine] for ends, mine in zip(tried, kind, strict=True)])
    target, values, apart = np.tile(target, 2), np.concatenate([values, values.conj()]), np.tile(apart, 2)
    once = distinct(loop, target, values, apart)
    return target[once], values[once], apart[once]


def _sound(loop: Loop, m: int, tried: list[Ends]) -> Flags:
    """(k, m) of each of k starts whether no path was lost, no two ended in the same regular solution, and conjugates
    are among the ends."""
    k = len(tried)
    # Each start's targets by numbers of their own, so that all are compared at once.
    target = np.concatenate([ends.target[ends.regular] + i * m for i, ends in enumerate(tried)])
    values = np.concatenate([ends.values[ends.regular] for ends in tried])
    number, apart = np.bincount(target, minlength=k * m), _apart(values)
    once = distinct(loop, target, values, apart)
    twice, conjugates = np.tile(target, 2), np.concatenate([values, values.conj()])
    both = distinct(loop, twice, conjugates, np.tile(apart, 2))
    every = [np.bincount(ends.target, minlength=m) > 0 for ends in tried]
    none_lost = [_number(m, ends.target, ends.lost) == 0 for ends in tried]
    alike = (number == _number(k * m, target, once)) & (number == _number(k * m, twice, both))
    return np.asarray(np.stack(every) & np.stack(none_lost) & alike.reshape(k, m))


def with_seeds_refined(loop: Loop, closing: Array, account: Account) -> Account:
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


def with_paths_near_motions(loop: Loop, closing: Array, account: Account, tried: list[Ends]) -> Account:
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
