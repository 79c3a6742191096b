"""What may be said of the solutions that were found for a block of targets, and what it rests on.

- counted: the arm has N complex solutions at almost every pose and nowhere more isolated ones; as many distinct
  regular ones were found. Of a closed form all branches were followed, and its equations are regular: roots that are
  not real are known to be complex.
- accounted: from two independent starts all N paths of a homotopy ended in regular, singular or infinite solutions, the
  same regular ones, and all of these were found.
- nothing: there may be more, and `words` says why.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache

import numpy as np
from numpy.typing import NDArray

from robokin.arrays import Index
from robokin.inverse.self_motion.chosen_members import SelfMotion
from robokin.inverse.verify import Found, merged

NOTHING, COUNTED, ACCOUNTED = 0, 1, 2

BASES = (None, "counted", "accounted")
"""Their names in documents."""


SEARCHED = "found by search, which proves nothing"
"""What is said where nothing vouches for a list."""

SPREAD = "some of infinitely many, far from each other"
"""The same of an arm with more joints than it needs."""


@dataclass(eq=False)
class Claims:
    """Of each target (m,) what its completeness rests on, in words where that needs some.

    N: the number of complex solutions, or of a closed form's branches, that were counted; real: (m,) how many distinct
    real ones were found; candidates, duplicates: (m,) how many were tried, and how many of those that close were the
    same as another one; branches: whether the N are branches of a closed form, whose complex
    roots are known to be complex and not worked out;
    motions: the self-motions of those targets that have some.
    """

    basis: NDArray[np.int8]
    N: int | None
    real: Index
    words: dict[int, str] = field(default_factory=dict)
    motions: dict[int, list[SelfMotion]] = field(default_factory=dict)
    branches: bool = False
    otherwise: str = SEARCHED
    candidates: Index | None = None
    duplicates: Index | None = None

    def sentence(self, i: int) -> str:
        """What the completeness of target i rests on, or why there is none."""
        if i in self.words:
            return self.words[i]
        return (
            counted_sentence(self.N, int(self.real[i]), self.branches) if self.basis[i] == COUNTED else self.otherwise
        )


@cache
def counted_sentence(N: int | None, real: int, branches: bool) -> str:
    """What a list rests on that was counted: N solutions or branches, of which some are real."""
    if branches and real != N:
        return f"all {N} branches of the closed form followed"
    return f"{N} of {N} complex solutions found, {real} real"


def unclaimed(m: int, otherwise: str = SEARCHED) -> Claims:
    """Nothing is said of m targets, but for the words why."""
    return Claims(np.zeros(m, dtype=np.int8), None, np.zeros(m, dtype=np.intp), otherwise=otherwise)


def replaced(found: Found, claims: Claims, again: Index, more: Found, said: Claims) -> tuple[Found, Claims]:
    """The solutions and claims with those of the targets `again` (k,) replaced."""
    kept = np.ones(len(claims.basis), dtype=bool)
    kept[again] = False
    both = merged(found.pick(kept[found.index]), more.numbered(again))
    claims.basis[again], claims.real[again] = said.basis, said.real
    for whole, part in ((claims.candidates, said.candidates), (claims.duplicates, said.duplicates)):
        if whole is not None and part is not None:
            whole[again] += part
    claims.words |= {int(again[i]): said.sentence(i) for i in range(len(again))}
    claims.motions |= {int(again[i]): motions for i, motions in said.motions.items()}
    return both.pick(np.argsort(both.index, kind="stable")), claims
