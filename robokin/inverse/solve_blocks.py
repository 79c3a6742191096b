"""Blocks of targets to verified configurations, whatever the arm."""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array, Index
from robokin.inverse.analysis import Analysis, General, chain_pose_parts
from robokin.inverse.claims import COUNTED, SPREAD, Claims, replaced, unclaimed
from robokin.inverse.elimination.complex_newton import SURE
from robokin.inverse.second_look import look_again
from robokin.inverse.verify import Found, distinct, distinct_and_close, merged, nothing
from robokin.inverse.window import SINGULAR, TOLD_APART, beyond_chain, nearly_singular, solve_window
from robokin.inverse.window_form import window_form
from robokin.kernel.native_kernel import native
from robokin.spatial import invert, rotation_transform

BLOCK = 8000
"""Targets at a time: the interpreter's share is spread thin, and the columns of a closed form stay in cache."""

KEPT = 2**24
"""Bytes of memory that a process keeps for the next block instead of giving them back after each."""

HELD_SAMPLES = 48
"""Values at which the joints of a redundant arm are held, for each target."""

MORE_SAMPLES = 192
"""The same for a target that those do not serve: still a tenth of the time that a search takes."""

OPEN_TURN = np.array([0.31, -0.47, 0.73])
"""Rotation vector [rad] by which targets are turned in what the task leaves open; unlike right angles, no arm's
favourite."""


def _keep_memory() -> None:
    """Have memory that was used kept, up to a few times `KEPT`.

    Fetching it anew for each block takes a third of a closed form's time. The GNU C library raises its threshold for
    what it gives back when a great block is freed (mallopt(3)); one that nobody has written to costs nothing. Elsewhere
    this does nothing.
    """
    memory = np.empty(KEPT, dtype=np.uint8)
    del memory


_keep_memory()


def solve_block(
    analysis: Analysis,
    T: Array,
    limits: Array,
    near: Array | None,
    rest: Array,
    more: bool = False,
    thorough: bool = True,
) -> tuple[Found, Claims]:
    """Every configuration found for targets T: (m, 4, 4), m at most a block, duplicates removed, and what to say of it.

    q: (s, n) holds the arm's own joints only; idle ones are at `rest` (n,). For a redundant arm the joints outside the
    window are held at the values of `near` (n,), if it is given, and at values spread over the limits (n, 2); with
    `more` at further and more such values, for targets that the first do not serve. What is doubtful is looked at again
    if `thorough`.
    """
    if analysis.solver is None:
        return nothing(analysis.chain.n - analysis.open), unclaimed(len(T))
    moving = analysis.moving
    T = turned_in_the_open(analysis, T)
    if not analysis.redundancy:
        open_joints = np.tile([-np.inf, np.inf], (analysis.open, 1))
        bounds = np.concatenate([limits[moving], open_joints])
        at_rest = np.concatenate([rest[moving], np.zeros(analysis.open)])
        wish = None if near is None else np.concatenate([near[moving], np.zeros(analysis.open)])
        if thorough:
            found, claims = complete_solutions(analysis, T, at_rest, bounds, wish)
        else:
            found, claims = quick_solutions(analysis, T), unclaimed(len(T))
    else:
        held = spread(analysis, limits[moving])
        if more:
            held = np.concatenate(
                [at_limits(analysis, limits[moving]), spread(analysis, limits[moving], MORE_SAMPLES, HELD_SAMPLES)]
            )
        elif near is not None:
            first = np.zeros((1, analysis.solved.n))
            first[0, : len(moving)] = near[moving]
            held = np.concatenate([first, held])
        found, claims = _solve_held(analysis, T, held), unclaimed(len(T), SPREAD)
    found = Found(found.index, found.q[:, : len(moving)], found.position, found.angle)
    if len(moving) and analysis.open:
        found = distinct(found, analysis.solved.revolute[: len(moving)], analysis.size)
    elif not len(moving):
        found = found.pick(np.unique(found.index, return_index=True)[1])
    if not analysis.idle:
        return found, claims
    q = np.tile(rest, (len(found), 1))
    q[:, moving] = found.q
    return Found(found.index, q, found.position, found.angle), claims


def quick_block(analysis: Analysis, T: Array, limits: Array, rest: Array) -> Found:
    """`solve_block` without the second look, for those who ask for a million targets and can do without some."""
    return solve_block(analysis, T, limits, None, rest, thorough=False)[0]


def quick_solutions(analysis: Analysis, T: Array) -> Found:
    """What the window's solver finds for its own targets."""
    found, _ = solve_window(analysis, T, count=False)
    return distinct(found, analysis.own.revolute, analysis.size)


def turned_in_the_open(analysis: Analysis, T: Array) -> Array:
    """Targets (m, 4, 4) turned in what the task leaves open.

    A chain with open joints is singular where one of them stands like one of the arm's own, and that depends on the
    values of the open joints: a cylindrical arm with the roll at zero, as forward kinematics gives it, and a virtual
    axis parallel to the first. Any other values serve the task as well.
    """
    if not analysis.open or analysis.redundancy:
        return T
    axis = OPEN_TURN if analysis.open == 3 else OPEN_TURN * [0.0, 0.0, 1.0]
    return T @ rotation_transform(axis, float(np.linalg.norm(axis)))


def complete_solutions(
    analysis: Analysis, T: Array, rest: Array, limits: Array, near: Array | None
) -> tuple[Found, Claims]:
    """All that the window can do for its own targets, those looked at twice of which anything is doubtful.

    rest: (window,) where a joint that is free is put; limits: (window, 2); near: (window,) the wish for self-motions.
    """
    chain = analysis.own
    found, doubt = solve_window(analysis, T)
    # Nothing is added on the way from candidates to the list: where as many are left they are the same.
    tried, m = doubt.candidates, len(found)
    closing = tried if int(tried.sum()) == m else np.bincount(found.index, minlength=len(T))
    found, equal, close = distinct_and_close(found, chain.revolute, analysis.size)
    count = closing.copy() if len(found) == m else np.bincount(found.index, minlength=len(T))
    # Two that come out as one may have been two, so near to each other that Newton's steps led both to the same.
    doubt.certain[equal] = True
    doubt.certain |= count == 0
    if chain.n == 6:
        doubt.certain |= count % 2 == 1
    else:
        # The six joints may be singular where the arm's own are not.
        doubt.certain |= doubt.possible
    doubt.possible[close] = True
    possible = np.flatnonzero(doubt.possible & ~doubt.certain)
    if len(possible):
        rows = rows_of(possible, count)
        whole = count[found.index[rows]] == (analysis.number if chain.n == 6 else -1)
        # What has not settled is told apart by nothing, however far its neighbours are.
        off = np.maximum(found.position[rows] / analysis.size, found.angle[rows])
        least = np.maximum(np.where(whole, TOLD_APART, SINGULAR), np.sqrt(off / SURE))
        doubt.certain[found.index[rows[nearly_singular(chain, found.q[rows], analysis.size, least)]]] = True
    again = np.flatnonzero(doubt.certain)
    again = again[~beyond_chain(chain, T[again], analysis.size)]
    claims = Claims(np.full(len(T), COUNTED, dtype=np.int8), analysis.number, count)
    claims.candidates, claims.duplicates = tried.copy(), closing - count
    claims.branches = not isinstance(analysis.solver, General)
    if not len(again):
        return found, claims
    part = found.pick(rows_of(again, count))
    part = Found(np.repeat(np.arange(len(again)), count[again]), part.q, part.position, part.angle)
    few = np.zeros(len(again), dtype=bool) if doubt.few is None else doubt.few[again]
    return replaced(found, claims, again, *look_again(analysis, T[again], part, rest, limits, near, few))


def rows_of(targets: Index, count: Index) -> Index:
    """The places (s,) of some targets' configurations in a list by target, of which each target has `count` (m,)."""
    numbers = count[targets]
    first = (np.cumsum(count) - count)[targets]
    return np.repeat(first - np.cumsum(numbers) + numbers, numbers) + np.arange(int(numbers.sum()))


def _solve_held(analysis: Analysis, T: Array, held: Array) -> Found:
    """Solutions with the joints outside the window held at each of some rows; q: (s, n)."""
    window, chain = analysis.window, analysis.solved
    before, after = chain_pose_parts(chain, window, held)
    m, k = len(T), len(held)
    # Every target with every row, the target counting slower.
    inner = invert(before)[None] @ T[:, None] @ invert(after)[None]
    found = nothing(chain.n)
    parts = []
    flat = inner.reshape(m * k, 4, 4)
    for start in range(0, m * k, BLOCK):
        part = held_solutions(analysis, np.ascontiguousarray(flat[start : start + BLOCK]))
        # What differs in a held joint is different: only the few solutions of one row need a comparison.
        part = distinct(part, chain.revolute[window.first : window.last], analysis.size)
        index = part.index + start
        q = held[index % k].copy()
        q[:, window.first : window.last] = part.q
        parts.append(Found(index // k, q, part.position, part.angle))
    for part in parts:
        found = merged(found, part)
    return found


def held_solutions(analysis: Analysis, T: Array) -> Found:
    """Solutions of the window of a redundant arm for its own targets (m, 4, 4), by target: what is plain by the native
    kernel, if it has the closed form."""
    form = window_form(analysis)
    if native is None or form is None or not native.rigid(T):
        return solve_window(analysis, T, count=False)[0]
    plain, _, listed, q, position, angle, _ = native.solutions(form, T, False, None)
    rows = (np.arange(q.shape[1]) < listed[:, None]) & plain[:, None]
    found = Found(np.nonzero(rows)[0], q[rows], position[rows], angle[rows])
    rest = np.flatnonzero(~plain)
    if not len(rest):
        return found
    both = merged(found, solve_window(analysis, T[rest], count=False)[0].numbered(rest))
    return both.pick(np.argsort(both.index, kind="stable"))


def at_limits(analysis: Analysis, limits: Array) -> Array:
    """Values (k, n) for the joint outside the window at its limits, where it is one of the arm's own; none of more.

    A piece within the limits on which it moves little is mostly one that its limits cut.
    """
    free = [i for i in range(analysis.solved.n) if not analysis.window.first <= i < analysis.window.last]
    ends = limits[free[0]] if len(free) == 1 and free[0] < len(limits) else np.empty(0)
    held = np.zeros((int(np.sum(np.isfinite(ends))), analysis.solved.n))
    held[:, free[:1]] = ends[np.isfinite(ends), None]
    return held


def spread(analysis: Analysis, limits: Array, count: int = HELD_SAMPLES, start: int = 0) -> Array:
    """Values (count, n) for the joints outside the window, evenly spread over their limits [rad | m].

    limits: (k, 2) those of the arm's joints that are solved for, idle ones left out.

    The points of an additive sequence whose steps are powers of the root of x^(d+1) = x + 1 (M. Roberts,
    "The unreasonable effectiveness of quasirandom sequences", 2018): they fill a box of any dimension evenly
    and can be continued.
    """
    chain, window = analysis.solved, analysis.window
    own = len(limits)
    free = [i for i in range(chain.n) if not window.first <= i < window.last]
    root = 2.0
    for _ in range(40):
        root = (1.0 + root) ** (1.0 / (len(free) + 1))
    fractions = (0.5 + np.outer(np.arange(start, start + count) + 1, root ** -np.arange(1.0, len(free) + 1))) % 1.0
    held = np.zeros((count, chain.n))
    for column, i in enumerate(free):
        reach = np.pi if chain.revolute[i] else analysis.size
        low, high = limits[i] if i < own else (-np.inf, np.inf)
        low = max(low, -reach) if np.isinf(low) else low
        high = min(high, reach) if np.isinf(high) else high
        held[:, i] = low + (high - low) * fractions[:, column]
    return held
