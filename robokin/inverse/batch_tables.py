"""The native kernel's answers for a batch: tables that threads fill, and blocks of them for those that ask for more.

Statement. Have the kernel answer what it can of the targets of a batch, on the cores that are asked for.
Derivation. It answers each target by itself, so that threads may share the targets in any way; each writes into its own
rows of tables that all have in common. Where a target's answer takes little time the tables become those of the
result, and what a single answer needs is found once more; elsewhere the result gets a copy.
Degenerate case. Targets that the kernel leaves have rows without numbers.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.target_block import TargetBlock
from robokin.jobs.ordered_map import ordered_map

PACKED = 16_000
"""Targets whose rows are copied at once: a millisecond's work."""


class BatchTables(NamedTuple):
    """Tables for m targets with so many rows each, in the order in which the native kernel takes them.

    plain: (m,) which targets are answered; tried, closing, within, listed: (m,) how many candidates there were, and how
    many solutions close, count for the limits and are listed; q: (m, rows, n), position, angle: (m, rows), inside:
    (m, rows) what is listed, NaN and False beyond.
    """

    plain: Flags
    tried: Index
    closing: Index
    within: Index
    listed: Index
    q: Array
    position: Array
    angle: Array
    inside: Flags

    def part(self, targets: slice | Flags) -> BatchTables:
        """The tables of some targets: views for a slice."""
        a = self
        return BatchTables(
            a.plain[targets], a.tried[targets], a.closing[targets], a.within[targets], a.listed[targets],
            a.q[targets], a.position[targets], a.angle[targets], a.inside[targets],
        )  # fmt: skip


def empty_tables(m: int, rows: int, n: int) -> BatchTables:
    """Tables that are to be filled."""
    tried, closing, within, listed = (np.empty(m, dtype=np.intp) for _ in range(4))
    q, position, angle = np.empty((m, rows, n)), np.empty((m, rows)), np.empty((m, rows))
    plain, inside = np.empty(m, dtype=bool), np.empty((m, rows), dtype=bool)
    return BatchTables(plain, tried, closing, within, listed, q, position, angle, inside)


def with_held_values(q: Array, pattern: Array) -> Array:
    """Joint values (..., k) with those of held joints between them, (..., n); NaN where these are (padded rows).

    pattern: (n,) the values of the joints that are held, NaN for the k others.
    """
    out, held = np.empty((*q.shape[:-1], len(pattern))), ~np.isnan(pattern)
    out[..., ~held] = q
    out[..., held] = np.where(np.isnan(q[..., :1]), np.nan, pattern[held])
    return out


@dataclass(frozen=True, eq=False)
class NativeKind:
    """How the native kernel answers a request.

    rows: of a target; n: its joints; share: targets that a thread takes at once; fill: puts the answers for targets
    (k, 4, 4) into tables; block: makes the answers for targets of which all are answered from their tables; proven:
    whether lists are complete that are not cut; quick: whether an answer takes less time than to keep it; pattern: (n,)
    of joints that are held in these tables their values, NaN for the others, or None.
    """

    rows: int
    n: int
    share: int
    fill: Callable[[Array, BatchTables], None]
    block: Callable[[Array, BatchTables], TargetBlock]
    proven: bool
    quick: bool
    pattern: Array | None = None

    def filled(self, T: Array, cores: int | None) -> BatchTables:
        """The tables for targets T (m, 4, 4) [m]."""
        tables = empty_tables(len(T), self.rows, self.n)

        def part(start: int) -> None:
            targets = slice(start, start + self.share)
            self.fill(T[targets], tables.part(targets))

        deque(ordered_map(part, range(0, len(T), self.share), cores, workers="threads"), maxlen=0)
        return tables


class NativeAnswers:
    """The native kernel's answers for a batch of targets T (m, 4, 4) [m]."""

    def __init__(self, kind: NativeKind, T: Array, size: int, cores: int | None) -> None:
        """size: targets of a block that single answers are made from; cores: all usable ones for None."""
        self.kind, self.T, self.size, self.cores = kind, T, size, cores
        self.tables: BatchTables | None = kind.filled(T, cores)
        self.plain, self.count = self.tables.plain, self.tables.listed
        cut = bool((self.tables.within > self.count).any())
        self.complete = not cut and (kind.proven or not self.plain.any())
        self._blocks: dict[int, TargetBlock] = {}

    @property
    def starts(self) -> range:
        """The first target of each block."""
        return range(0, len(self.T), self.size)

    def block(self, start: int) -> TargetBlock:
        """The answers for those from `start` that are answered."""
        if start not in self._blocks:
            targets = slice(start, start + self.size)
            T = self.T[targets]
            tables = self.kind.filled(T, 1) if self.tables is None else self.tables.part(targets)
            plain = self.plain[targets]
            if not plain.all():
                T, tables = T[plain], tables.part(plain)
            self._blocks.setdefault(start, self.kind.block(T, tables))
        return self._blocks[start]

    def place(self, i: int) -> tuple[TargetBlock, int] | None:
        """The block that answers target i, and the target's number in it; None if it is another's."""
        start = i - i % self.size
        return (self.block(start), int(np.count_nonzero(self.plain[start:i]))) if self.plain[i] else None

    def listed(self, most: int) -> tuple[Array, Array, Array, Flags]:
        """What is listed in tables of `most` rows a target, for the result to have: q, position, angle, inside."""
        assert self.tables is not None
        *_, q, position, angle, inside = self.tables
        if self.kind.quick:
            self.plain, self.count, self.tables = self.plain.copy(), self.count.copy(), None
            if most == self.kind.rows:
                return q, position, angle, inside
        wide = min(most, self.kind.rows)
        made = empty_tables(len(q), most, self.kind.n)[-4:]

        def part(start: int) -> None:
            targets = slice(start, start + PACKED)
            for to, table in zip(made, (q, position, angle, inside), strict=True):
                to[targets, :wide] = table[targets, :wide]
                to[targets, wide:] = np.nan if to.dtype == np.float64 else False

        deque(ordered_map(part, range(0, len(q), PACKED), self.cores, workers="threads"), maxlen=0)
        return made
