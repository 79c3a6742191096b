"""The answers for all targets of a batch, block after block, as one result.

Statement. Answer some thousands of targets at a time, on the cores that are asked for, and put the answers in the order
of the targets.
Derivation. Where the native kernel knows the arm it answers what is plain (`plain_targets`); what it leaves is answered
together, whatever block it comes from. The arrays are padded with NaN; names, reasons and single answers are made for
those that ask.
Degenerate case. No targets: no solutions, and nothing that is not complete.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from robokin.arrays import Array, Index
from robokin.inverse.plain_targets import PlainBlock, kernel_form
from robokin.inverse.single_answer import known_reason, result_of, why_not
from robokin.inverse.solutions import BatchResult, Result
from robokin.inverse.solve_blocks import BLOCK
from robokin.inverse.swivel_block import SwivelBlock, swivel_request
from robokin.inverse.target_block import Request, TargetBlock
from robokin.jobs.ordered_map import ordered_map


@dataclass(frozen=True, eq=False)
class _Share:
    """The answers of a block for some targets of the batch: targets: (k,) in rising order, or a slice of them."""

    targets: Index | slice
    block: TargetBlock

    def place(self, i: int) -> tuple[TargetBlock, int] | None:
        """The block that answers target i, and the target's number in it; None if it is another's."""
        if isinstance(self.targets, slice):
            return (self.block, i - self.targets.start) if self.targets.start <= i < self.targets.stop else None
        k = int(np.searchsorted(self.targets, i))
        return (self.block, k) if k < len(self.targets) and self.targets[k] == i else None


def answered_batch(request: Request, T: Array, cores: int | None) -> BatchResult:
    """The answers for targets T (m, 4, 4) [m], on some cores, all usable ones for None."""
    parts: list[_Share] = []
    left = None
    kind = _native_kind(request)
    if kind is not None:
        lefts = [np.empty(0, dtype=np.intp)]
        answers = ordered_map(partial(kind, request), _blocks(T), cores, workers="threads")
        for start, plain in zip(_starts(T), answers, strict=True):
            lefts.append(start + np.flatnonzero(~plain.plain))
            whole = slice(start, start + len(plain.plain))
            parts.append(_Share(start + np.flatnonzero(plain.plain) if len(lefts[-1]) else whole, plain))
        left = np.concatenate(lefts)
    others = T if left is None else T[left]
    for start, block in zip(
        _starts(others), ordered_map(partial(TargetBlock, request), _blocks(others), cores), strict=True
    ):
        whole = slice(start, start + len(block.T))
        parts.append(_Share(whole if left is None else left[whole], block))
    for part in parts:
        part.block.request = request
    return _batch(request, len(T), parts)


def _native_kind(request: Request) -> Callable[[Request, Array], PlainBlock | SwivelBlock] | None:
    """The blocks of the native kernel that a request is for, if any."""
    if kernel_form(request) is not None:
        return PlainBlock
    return None if swivel_request(request) is None else SwivelBlock


def _starts(T: Array) -> range:
    return range(0, len(T), BLOCK)


def _blocks(T: Array) -> list[Array]:
    return [T[start : start + BLOCK] for start in _starts(T)]


def _batch(request: Request, m: int, parts: list[_Share]) -> BatchResult:
    """The answers of all parts for m targets."""
    n = request.robot.n
    counts = np.zeros(m, dtype=np.intp)
    for part in parts:
        counts[part.targets] = part.block.count
    most = int(counts.max(initial=0))
    q, position, angle = np.empty((m, most, n)), np.empty((m, most)), np.empty((m, most))
    inside = np.empty((m, most), dtype=bool)
    for part in parts:
        at = part.targets
        q[at], position[at], angle[at], inside[at] = part.block.padded(most)

    def place(i: int) -> tuple[TargetBlock, int]:
        return next(found for part in parts if (found := part.place(i)) is not None)

    def single(i: int) -> Result:
        block, k = place(i)
        return result_of(request, *(block.answered_by(k) if isinstance(block, PlainBlock) else (block, k)))

    def reason(i: int) -> str | None:
        block, k = place(i)
        if block.count[k]:
            return None
        known = known_reason(block, k)
        return why_not(request, block, k)[0] if known is None else known

    analysis = request.analysis
    method = "numeric" if request.method == "numeric" else analysis.method
    complete = not analysis.idle and all(
        bool(np.all(part.block.claims.basis > 0) and not part.block.cut.any()) for part in parts
    )
    names = partial(_names, parts, counts)
    return BatchResult(q, counts, position, angle, inside, complete, method, single, names, reason)


def _names(parts: list[_Share], counts: Index) -> list[str]:
    """The names of all solutions, target after target, of which each has so many (m,)."""
    if all(isinstance(part.targets, slice) for part in parts):
        return [name for part in parts for name in part.block.names]
    first = np.cumsum(counts) - counts
    names = np.empty(int(counts.sum()), dtype=object)
    for part in parts:
        count = part.block.count
        start = np.repeat(first[part.targets] - np.cumsum(count) + count, count)
        names[start + np.arange(len(start))] = part.block.names
    listed: list[str] = names.tolist()
    return listed
