"""Names of solutions: shoulder right or left, elbow up or down, wrist flip or no-flip, and numbers where words fail.

The words say on which side of the arm's singularities a configuration is (see `postures`): one name means the same
posture as long as the arm passes no singularity, and no two solutions of a pose have the same one.

- shoulder right: the wrist centre (or the tool of a positioning arm) lies on the positive side of the first axis, where
  x₁ · (w - o₁) ≥ 0 with x₁ the direction in which the arm reaches at the given q₁. With the lecture's table of the
  anthropomorphic arm this is θ₁ = atan2(p_y, p_x), shoulder left is half a turn on.
- elbow up: the elbow lies above the line from the shoulder to the wrist, above being the direction of the first axis;
  if the shoulder is set off from that axis the name stays while the wrist is between the two. For a planar arm: to the
  left of the line from the base to the wrist.
- wrist no-flip: the wrist's middle axis has turned to the positive side, sin θ ≥ 0.
- slide forward: the slide carries the wrist away from where the axes before it meet.

Where signs cannot tell all solutions apart (arms without a closed form) a number is added, in the order of q1, q2, …
among the solutions of the pose with the same signs. A number is no posture: it may change where another solution
appears. An arm with more joints than it needs is named by those that are solved for, the others being held: of what is
listed for different values of those, two may have one name.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from robokin.arrays import Array, Index
from robokin.inverse.analysis import Window, analysis_of, window_chain
from robokin.inverse.posture_code import posture_code
from robokin.inverse.postures import Postures, postures_of
from robokin.inverse.verify import SAME, wrapped
from robokin.kernel.chain import chain_of
from robokin.kernel.facts import fact
from robokin.kernel.native_kernel import native
from robokin.model import Robot

FEW = 100
"""Numbers of which a set is made faster than they are sorted."""

HELD = 1e-6
"""Held joints that differ by less [rad | size] have one value."""


def branch_names(robot: Robot, q: Array, index: Index | None = None) -> list[str]:
    """The name of each configuration q: (s, n) [rad | m], or "" where the arm has no words and one solution.

    index: (s,) the target that each is a solution for. With it, solutions of one target that signs do not tell apart
    are numbered, and q should hold all of them; without it each is named by its signs alone.
    """
    if not len(q):
        return []
    window, postures = _postures(robot)
    part = slice(window.first, window.last)
    code = _codes(postures, np.asarray((q * robot.senses)[:, part], dtype=np.float64))
    numbers = np.zeros(len(q), dtype=np.intp)
    if index is not None and not _told_apart(index, code, postures):
        numbers = _numbers(robot, q, index, code, part, postures)
    names: dict[tuple[int, int], str] = {}
    for key in set(zip(code.tolist(), numbers.tolist(), strict=True)):
        words = [sign.word(bool(key[0] >> bit & 1)) for bit, sign in enumerate(postures.signs)]
        names[key] = ", ".join([*words, f"number {key[1]}"] if key[1] else words)
    return [names[key] for key in zip(code.tolist(), numbers.tolist(), strict=True)]


def _codes(postures: Postures, q: Array) -> Index:
    """(s,) a bit for each sign of configurations q (s, n): those with one code have one name."""
    known = posture_code(postures)
    if native is not None and known is not None:
        bits: Index = native.sides(known, q)
        return bits
    axes = postures.axes(q)
    code = np.zeros(len(q), dtype=np.intp)
    for bit, sign in enumerate(postures.signs):
        code |= sign.holds(axes).astype(np.intp) << bit
    return code


def _told_apart(index: Index, code: Index, postures: Postures) -> bool:
    """Whether the codes of each target's configurations differ, so that none needs a number."""
    if postures.numbered:
        return False
    keys = index << len(postures.signs) | code
    return len(np.unique(keys)) == len(keys) if len(keys) > FEW else len(set(keys.tolist())) == len(keys)


def listed_names(robot: Robot, q: Array, index: Index, every: tuple[Array, Index]) -> list[str]:
    """The names of some solutions q: (s, n), index: (s,) among all that there are: (t, n) and (t,), sorted by target.

    So a solution has the same name whether or not joint limits, or a cut, leave the others in the list.
    """
    q_all, index_all = every
    if not len(q):
        return []
    names = branch_names(robot, q_all, index_all)
    if np.array_equal(q, q_all):
        return names
    scale = np.where(robot.revolute, 1.0, analysis_of(robot).size)
    start = np.searchsorted(index_all, index)
    count = np.searchsorted(index_all, index, side="right") - start
    best, least = start.copy(), np.full(len(q), np.inf)
    for step in range(int(count.max(initial=0))):
        row = np.minimum(start + step, len(q_all) - 1)
        gap = np.max(np.abs(wrapped(q_all[row] - q, robot.revolute)) / scale, axis=1)
        nearer = (step < count) & (gap < least)
        best[nearer], least[nearer] = row[nearer], gap[nearer]
    return [names[row] for row in best.tolist()]


@fact
def _postures(robot: Robot) -> tuple[Window, Postures]:
    window = analysis_of(robot).window
    if window.last - window.first > 6:
        window = Window(0, 0, window.dimension)
    # Up is up whichever way a variable counts: the axes are those of the table.
    plain = replace(robot, rows=tuple(replace(row, sense=1) for row in robot.rows))
    chain = chain_of(robot if np.all(robot.senses > 0.0) else plain)
    return window, postures_of(window_chain(chain, window))


def _numbers(robot: Robot, q: Array, index: Index, code: Index, part: slice, postures: Postures) -> Index:
    """(s,) the number of each configuration among those of the same target, signs and held joints, or 0 for none.

    Configurations that differ by whole turns only have the same one.
    """
    scale = np.where(robot.revolute, 1.0, postures.size)
    values = np.round(wrapped(q, robot.revolute) / scale / SAME)
    # -180° is 180°.
    values = np.where(robot.revolute & (values <= -np.floor(np.pi / SAME)), np.round(np.pi / SAME), values)
    others = np.delete(np.arange(robot.n), np.arange(robot.n)[part])
    keys = [np.round(values[:, i] * (SAME / HELD)) for i in others[::-1]]
    order = np.lexsort([*(values[:, i] for i in range(robot.n)[::-1]), *keys, code, index])
    key = np.stack([index, code, *(values[:, i] for i in others)], axis=1)[order]
    new_group = np.ones(len(q), dtype=bool)
    new_group[1:] = np.any(np.diff(key, axis=0) != 0, axis=1)
    gap = np.abs(wrapped(np.diff(q[order], axis=0), robot.revolute)) / scale
    another = new_group.copy()
    another[1:] |= np.max(gap, axis=1, initial=0.0) > SAME
    group = np.cumsum(new_group) - 1
    rank = np.cumsum(another)
    rank = rank - rank[np.flatnonzero(new_group)][group] + 1
    most = np.zeros(group[-1] + 1, dtype=np.intp)
    np.maximum.at(most, group, rank)
    numbers = np.zeros(len(q), dtype=np.intp)
    numbers[order] = np.where((most[group] > 1) | postures.numbered, rank, 0)
    return numbers
