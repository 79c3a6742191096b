"""The answers for all targets of a batch, block after block, as one result.

Statement. Answer some thousands of targets at a time, on the cores that are asked for, and put the answers in the order
of the targets.
Derivation. Where the native kernel knows the arm it answers what is plain (`plain_targets`); what it leaves is answered
together, whatever block it comes from. The arrays are padded with NaN; names, reasons and single answers are made for
those that ask.
Degenerate case. No targets: no solutions, and nothing that is not complete.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robokin.arrays import Array, Index
from robokin.inverse.batch_tables import NativeAnswers, NativeKind, empty_tables, with_held_values
from robokin.inverse.plain_targets import PlainBlock, kernel_form, plain_kind
from robokin.inverse.single_answer import known_reason, result_of, why_not
from robokin.inverse.solutions import BatchResult, Result
from robokin.inverse.solve_blocks import BLOCK
from robokin.inverse.swivel_block import swivel_kind, swivel_request
from robokin.inverse.target_block import Request, TargetBlock
from robokin.jobs.ordered_map import ordered_map


@dataclass(frozen=True, eq=False)
class _Share:
    """The answers of a block for some targets of the batch: targets: (k,) in rising order, or a slice of them."""

    targets: Index | slice
    block: TargetBlock

    def fill(self, held: Array | None, *tables: NDArray[Any]) -> None:
        """Put what is listed into its rows of tables for all targets (`TargetBlock.pad`).

        held: (n,) of joints that are held in these tables their values, NaN for the others, or None.
        """
        if held is None and isinstance(self.targets, slice):
            q, position, angle, inside = (table[self.targets] for table in tables)
            self.block.pad(q, position, angle, inside)
            return
        own = [np.empty((len(self.block.T), *table.shape[1:]), dtype=table.dtype) for table in tables]
        q, position, angle, inside = own
        if held is None:
            self.block.pad(q, position, angle, inside)
        else:
            values = np.empty((*q.shape[:2], int(np.isnan(held).sum())))
            self.block.pad(values, position, angle, inside)
            own[0] = with_held_values(values, held)
        for table, part in zip(tables, own, strict=True):
            table[self.targets] = part

    def place(self, i: int) -> tuple[TargetBlock, int] | None:
        """The block that answers target i, and the target's number in it; None if it is another's."""
        if isinstance(self.targets, slice):
            return (self.block, i - self.targets.start) if self.targets.start <= i < self.targets.stop else None
        k = int(np.searchsorted(self.targets, i))
        return (self.block, k) if k < len(self.targets) and self.targets[k] == i else None


def answered_batch(request: Request, T: Array, cores: int | None) -> BatchResult:
    """The answers for targets T (m, 4, 4) [m], on some cores, all usable ones for None.

    Where the native kernel has part in them held joints (`Request.pattern`) are among their joint values.
    """
    kind = _native_kind(request)
    # What is shared, or answered once more for a single answer, are smaller blocks.
    known = None if kind is None else NativeAnswers(kind, T, BLOCK // 2, cores)
    left = None if known is None else np.flatnonzero(~known.plain)
    others = T if left is None else T[left]
    starts = range(0, len(others), BLOCK if cores == 1 else BLOCK // 2)
    blocks = [others[start : start + starts.step] for start in starts]
    parts: list[_Share] = []
    for start, block in zip(starts, ordered_map(partial(TargetBlock, request), blocks, cores), strict=True):
        whole = slice(start, start + len(block.T))
        parts.append(_Share(whole if left is None else left[whole], block))
    for part in parts:
        part.block.request = request
    return _batch(request, len(T), known, parts)


def _native_kind(request: Request) -> NativeKind | None:
    """How the native kernel answers a request, if it does."""
    if kernel_form(request) is not None:
        return plain_kind(request)
    return None if swivel_request(request) is None else swivel_kind(request)


def _batch(request: Request, m: int, known: NativeAnswers | None, parts: list[_Share]) -> BatchResult:
    """The answers of the native kernel and of blocks for m targets."""
    counts = np.zeros(m, dtype=np.intp) if known is None else known.count.copy()
    for part in parts:
        counts[part.targets] = part.block.count
    most = int(counts.max(initial=0))
    held = None if known is None else known.kind.pattern
    q, position, angle, inside = empty_tables(m, most, request.robot.n)[-4:] if known is None else known.listed(most)
    for part in parts:
        part.fill(held, q, position, angle, inside)

    def place(i: int) -> tuple[TargetBlock, int]:
        found = None if known is None else known.place(i)
        return found or next(found for part in parts if (found := part.place(i)) is not None)

    def single(i: int) -> Result:
        block, k = place(i)
        return result_of(request, *(block.answered_by(k) if isinstance(block, PlainBlock) else (block, k)))

    def reason(i: int) -> str | None:
        block, k = place(i)
        if block.count[k]:
            return None
        why = known_reason(block, k)
        return why_not(request, block, k)[0] if why is None else why

    analysis = request.analysis
    method = "numeric" if request.method == "numeric" else analysis.method
    complete = not analysis.idle and (known is None or known.complete)
    complete = complete and all(
        bool(np.all(part.block.claims.basis > 0) and not part.block.cut.any()) for part in parts
    )
    names = partial(_names, known, parts, counts.copy())
    return BatchResult(q, counts, position, angle, inside, complete, method, single, names, reason)


def _names(known: NativeAnswers | None, parts: list[_Share], counts: Index) -> list[str]:
    """The names of all solutions, target after target, of which each has so many (m,)."""
    if known is None:
        return [name for part in parts for name in part.block.names]
    blocks = [(start + np.flatnonzero(known.plain[start : start + known.size]), start) for start in known.starts]
    first = np.cumsum(counts) - counts
    names = np.empty(int(counts.sum()), dtype=object)

    def put(targets: Index | slice, block: TargetBlock) -> None:
        count = block.count
        start = np.repeat(first[targets] - np.cumsum(count) + count, count)
        names[start + np.arange(len(start))] = block.names

    for targets, start in blocks:
        put(targets, known.block(start))
    for part in parts:
        put(part.targets, part.block)
    listed: list[str] = names.tolist()
    return listed
