"""What is decided once for an arm and a task: how its inverse kinematics is solved, and why so.

Every arm is brought to a loop of six joints:

- What the task leaves open (the roll about the approach direction, the whole orientation) becomes joints at
  the tool that may take any value.
- A joint that only moves what the task leaves open (the roll of a hand of which the direction alone is asked
  for) is idle: the others are solved for without it, whatever its value.
- An arm with more joints than directions it can move in keeps a window of consecutive joints that can do all
  that the arm can; the joints before and after it are held at chosen values, which only moves the target.
- An arm or window with fewer than six joints gets virtual joints that must come out as zero.

The loop then has a closed form (three axes that meet in a point, three parallel axes, three sliding joints)
or is solved by elimination.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np

from robokin.arrays import Array, Index
from robokin.inverse.closed_form.spherical_wrist import SphericalTriple
from robokin.inverse.closed_form.three_parallel_axes import ThreeParallel
from robokin.inverse.closed_form.three_prismatic import ThreePrismatic
from robokin.inverse.elimination.loop import Loop, loop_of
from robokin.inverse.elimination.loop_newton import closing_at
from robokin.inverse.elimination.padding import Padded, padded_chains
from robokin.inverse.elimination.splits import choose_splits, elimination_of, generic_count
from robokin.jobs.arbitrary_numbers import arbitrary
from robokin.kernel.chain import Chain, chain_of, chain_size, with_joints, with_joints_at
from robokin.kernel.facts import fact
from robokin.kernel.frames import frames, pose
from robokin.kernel.ranks import RANK
from robokin.kernel.residual import error_and_jacobian
from robokin.model import Robot

Task = Literal["pose", "approach", "position"]

CLOSED_FORMS = (SphericalTriple, ThreePrismatic, ThreeParallel)


@dataclass(frozen=True, eq=False)
class Window:
    """Joints `first` to `last` - 1 of a chain, to be solved for; the others are held.

    dimension: how many directions the whole chain can move the tool in.
    """

    first: int
    last: int
    dimension: int


@dataclass(frozen=True, eq=False)
class Analysis:
    """How an arm's inverse kinematics is solved for a task.

    chain: the arm's joints and after them the `open` joints that the task leaves free; idle: those of the
    arm's joints, from 0, that only move what the task leaves open; solved: the chain without them; window:
    what is solved for of that; six: the window padded to six joints; loop: the same as a loop; solver: what
    solves it; method, sentence: its name and why it applies; complete: whether it finds every solution but
    for the values of idle joints; number: how many complex solutions the loop has at a random pose, or how many roots
    the closed form's equations have; None where it could not be told.
    """

    chain: Chain
    open: int
    size: float
    idle: tuple[int, ...]
    solved: Chain
    window: Window
    six: Padded | None
    loop: Loop | None
    solver: Any
    method: str
    sentence: str
    complete: bool
    number: int | None = None

    @property
    def redundancy(self) -> int:
        """How many joints are held besides the idle ones: the dimension of the self-motion without them."""
        return self.solved.n - (self.window.last - self.window.first)

    @cached_property
    def own(self) -> Chain:
        """The window's joints alone: what is solved for, without virtual joints."""
        return window_chain(self.solved, self.window)

    @property
    def moving(self) -> Index:
        """The arm's joints, from 0, that are not idle."""
        return np.array([i for i in range(self.chain.n - self.open) if i not in self.idle], dtype=np.intp)


def analysis_of(robot: Robot, task: Task = "pose") -> Analysis:
    """The analysis of a robot for a task, made when it is first asked for."""
    return known_analysis(robot, task)


@fact
def known_analysis(robot: Robot, task: Task) -> Analysis:
    """The same, with the task by its place."""
    return analyse(chain_of(robot), task)


def analyse(chain: Chain, task: Task = "pose") -> Analysis:
    """Decide how the inverse kinematics of a chain is solved."""
    size = chain_size(chain)
    whole, open_joints = with_open_joints(chain, task)
    idle = idle_joints(whole, open_joints, size)
    if idle:
        whole, open_joints = with_open_joints(chain, task, roll_first=True)
    solved = with_joints_at(whole, dict.fromkeys(idle, 0.0))
    told = whole, open_joints, size, idle, solved
    windows = _windows(solved, size)
    for window in windows:
        part = window_chain(solved, window)
        found = _closed_form(part)
        if found is not None:
            six, loop, solver = found
            own = min(part.n, solved.n - open_joints - window.first)
            method, reason = _named(solver, six, solved, part, own)
            held = solved.n - part.n
            sentence = _sentence(reason, six, held)
            leaves = solver.candidates(trial_closing(loop)).leaves
            return Analysis(*told, window, six, loop, solver, method, sentence, held == 0, leaves)
    for window in windows:
        part = window_chain(solved, window)
        general = _by_elimination(part)
        if general is not None:
            six, loop, solver = general
            held = solved.n - part.n
            sentence = _sentence(solver.sentence, six, held)
            number = generic_count(loop, solver.splits) if held == 0 else None
            return Analysis(*told, window, six, loop, solver, solver.method, sentence, held == 0, number)
    window = Window(0, solved.n, _dimension(solved, size, 0, solved.n))
    sentence = "no six of its joints can do all that the arm can: damped least squares from many starts"
    return Analysis(*told, window, None, None, None, "numeric", sentence, complete=False)


def with_open_joints(chain: Chain, task: Task, roll_first: bool = False) -> tuple[Chain, int]:
    """The chain with joints at the tool for what the task leaves open: none, the roll, or all three turns.

    With the roll first it may stand for an idle last joint, which turns about the same axis in many arms.
    """
    axes = {"pose": (), "approach": (2,), "position": (2, 1, 0) if roll_first else (0, 1, 2)}[task]
    return with_joints(chain, axes, [True] * len(axes)), len(axes)


def idle_joints(chain: Chain, open_joints: int, size: float) -> tuple[int, ...]:
    """The arm's joints, from 0, each of which only moves what the task leaves open, whatever the others do.

    What is asked of the tool does not depend on such a joint: its column in the Jacobian is everywhere a
    combination of the open joints' columns.
    """
    own = chain.n - open_joints
    if not open_joints:
        return ()
    J = _generic_jacobians(chain, size)
    basis = np.linalg.qr(J[:, :, own:])[0]
    rest = J[:, :, :own] - basis @ (np.swapaxes(basis, 1, 2) @ J[:, :, :own])
    return tuple(int(i) for i in np.flatnonzero(np.max(np.linalg.norm(rest, axis=1), axis=0) < RANK))


def window_chain(chain: Chain, window: Window) -> Chain:
    """The window's joints with the constants between them; what stands before and after is left out."""
    a, b = window.first, window.last
    constants = chain.constants[a : b + 1].copy()
    if a > 0:
        constants[0] = np.eye(4)
    if b < chain.n:
        constants[-1] = np.eye(4)
    return Chain(constants, chain.revolute[a:b], chain.offsets[a:b])


def _dimension(chain: Chain, size: float, first: int, last: int) -> int:
    """Rank of the columns of some joints in the Jacobian, at a generic configuration."""
    values = np.linalg.svd(_generic_jacobians(chain, size)[:, :, first:last], compute_uv=False)
    return int(np.max(np.sum(values > RANK * values[:, :1], axis=1))) if last > first else 0


def moves_in_all_directions(chain: Chain, size: float) -> bool:
    """Whether a chain can move its tool in all six directions."""
    J = _generic_jacobians(chain, size, 1)[0]
    # |det J| is the least singular value times five others, whose product is at most (|J|² / 5)^(5/2).
    if abs(float(np.linalg.det(J))) > 2.0 * RANK * float(np.sum(J * J)) ** 3 / 5.0**2.5:
        return True
    return _dimension(chain, size, 0, chain.n) == 6


def _generic_jacobians(chain: Chain, size: float, count: int = 3) -> Array:
    """Jacobians (count, 6, n), lengths in sizes, at arbitrary configurations."""
    q = 2.0 * arbitrary(11, 3, chain.n)[:count] * np.where(chain.revolute, 1.0, size)
    target = np.tile(np.eye(4), (count, 1, 1))
    return error_and_jacobian(chain, np.array(target), q, size)[1]


def _windows(chain: Chain, size: float) -> list[Window]:
    """Windows of consecutive independent joints that can do all that the chain can; those at the base first."""
    dimension = _dimension(chain, size, 0, chain.n)
    starts = range(chain.n - dimension, -1, -1) if chain.n > dimension else range(1)
    candidates = [Window(start, start + dimension, dimension) for start in sorted(starts)]
    return [w for w in candidates if _dimension(chain, size, w.first, w.last) == dimension]


def _closed_form(part: Chain) -> tuple[Padded, Loop, Any] | None:
    """The first closed form among the ways to make six joints of a window."""
    for six in padded_chains(part):
        loop = loop_of(six.chain)
        for form in CLOSED_FORMS:
            solver = form.find(loop)
            if solver is not None:
                return six, loop, solver
    return None


def _by_elimination(part: Chain) -> tuple[Padded, Loop, General] | None:
    """The elimination for the first way to make six joints of a window that it serves."""
    for six in padded_chains(part, most=3):
        loop = loop_of(six.chain)
        splits = choose_splits(loop)
        if splits:
            return six, loop, General(loop, splits)
    return None


def trial_closing(loop: Loop) -> Array:
    """L6 (1, 4, 4) of an arbitrary pose, the first of `trial_poses`."""
    return closing_at(loop, arbitrary(7, 1, 6) * np.where(loop.revolute, np.pi, 1.0))


class General:
    """The elimination with its chosen splits, in the shape of a closed form."""

    method = "elimination"
    sentence = "no three axes meet in a point or are parallel: Raghavan and Roth's elimination"

    def __init__(self, loop: Loop, splits: list[int]) -> None:
        self.splits = splits
        self.first = elimination_of(loop, splits[0])

    def candidates(self, closing: Array) -> Any:
        """Candidates by the best split."""
        return self.first.candidates(closing)


def _named(solver: Any, six: Padded, whole: Chain, part: Chain, own: int) -> tuple[str, str]:
    """The method's name and reason in the arm's joints, the first `own` of the solver's: it may have others as well."""
    if six.virtual and part.revolute.all() and len({*_directions(part)}) == 1:
        return "planar", "all axes are parallel: a planar arm"
    # Virtual joints, and those that the task leaves open, are no wrist of the arm.
    if six.virtual == 0 and getattr(solver, "first", 0) + 3 <= own:
        if whole.n > part.n:
            return solver.method, f"closed form of six joints ({solver.method})"
        return solver.method, solver.sentence
    if own <= 3 and six.virtual not in (1, 2):
        return "positioning arm", f"{own} joints that place a point: a closed form"
    if whole.n > part.n and six.virtual == 0:
        return "closed form", "closed form of six joints"
    return "closed form", f"a closed form of {own} joints"


def _directions(part: Chain) -> list[int]:
    """A number for each axis's direction, the same for parallel ones, at a generic configuration."""
    q = np.random.default_rng(3).uniform(-1.0, 1.0, (1, part.n))
    z = frames(part, q)[0, :-1, :3, 2]
    parallel = np.linalg.norm(np.cross(z[:, None], z[None]), axis=2) < RANK
    return [int(np.argmax(row)) for row in parallel]


def _sentence(reason: str, six: Padded, held: int) -> str:
    parts = [reason]
    if six.virtual:
        count = "one virtual joint" if six.virtual == 1 else f"{six.virtual} virtual joints"
        parts.append(f"with {count} at the tool that must stand still")
    if held:
        parts.append(f"{held} joint{'s' if held > 1 else ''} held at chosen values")
    return "; ".join(parts)


def chain_pose_parts(chain: Chain, window: Window, held: Array) -> tuple[Array, Array]:
    """What stands before and after the window (k, 4, 4) with the other joints at held values (k, n).

    `held` has all n columns [rad | m]; those of the window are not used.
    """
    q = held.copy()
    q[:, window.first : window.last] = 0.0
    F = frames(chain, q)
    before = F[:, window.first] if window.first else np.broadcast_to(np.eye(4), (len(q), 4, 4))
    if window.last == chain.n:
        return before, np.broadcast_to(np.eye(4), (len(q), 4, 4))
    # From the frame after the window's last joint (its constant is left to this part) to the tool.
    tail = Chain(
        np.concatenate([chain.constants[window.last : window.last + 1], chain.constants[window.last + 1 :]]),
        chain.revolute[window.last :],
        chain.offsets[window.last :],
    )
    after = pose(tail, held[:, window.last :])
    return before, after
