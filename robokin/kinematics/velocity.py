"""What the Jacobian says at a configuration: how freely the tool can move, and what is lost where it cannot.

Lengths and angles do not compare, so the singular values are those of the Jacobian with lengths, also those of
sliding joints, in the arm's characteristic size; rank and condition rest on them. Manipulability is the books'
number, √det(J Jᵀ) of the Jacobian as it stands (T. Yoshikawa, Manipulability of robotic mechanisms, Int. J. Robotics
Research 4(2), 1985): the product of the raw singular values.

A twist u cannot be made where uᵀJ = 0. Such a u is a wrench (f, m) that no joint feels: m = 0 at a point says that
the point cannot move along f; f = 0 that the tool cannot turn about m; in any case that it cannot turn about m
while the point at which m is taken stands still.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace
from typing import Any, Literal, SupportsIndex, get_args

import numpy as np
from numpy.typing import ArrayLike

from robokin.arrays import Array, Flags, Index
from robokin.brief import Answer, Brief
from robokin.errors import InputError, InputTypeError
from robokin.expected import described, expect_choice, expect_finite
from robokin.kernel.facts import fact
from robokin.kernel.joint_axes import nearest_point
from robokin.kernel.ranks import RANK
from robokin.kinematics.forward import joint_frames
from robokin.kinematics.jacobian import jacobian
from robokin.kinematics.structure import arm_size, structure_of
from robokin.model import CoupledRobot, Robot, expect_robot
from robokin.model.named_values import plain_joint_values

TaskName = Literal["pose", "position", "orientation"]

SQUARED = 1e-10
"""Squares of singular values below this part of the sum of all are told by the values themselves."""

ROWS = {"pose": slice(0, 6), "position": slice(0, 3), "orientation": slice(3, 6)}


@dataclass(frozen=True, eq=False, repr=False)
class MotionTask(Brief):
    """Which part of the twist counts for an arm.

    dimension: M, in how many directions the arm moves the tool at a generic configuration; span: (6, s), lengths in
    sizes, all directions that it can move in somewhere, in the axes of the world (s > M for arms of five joints, say).
    """

    name: TaskName
    dimension: int
    size: float
    span: Array

    @property
    def rows(self) -> slice:
        """The rows of the Jacobian that count."""
        return ROWS[self.name]


@dataclass(frozen=True, eq=False, repr=False)
class Differential(Answer):
    """Differential kinematics at configurations: leading dimensions as those of q.

    jacobian: (..., 6, n) [m/rad | 1, 1 | 0], as `robokin.jacobian`; rank: (...); singular_values: (..., M), greatest
    first, lengths in the task's size; raw_singular_values: (..., M) of the Jacobian in metres; manipulability: (...)
    their product, 0 where the rank is less than M; condition: (...) greatest by least of `singular_values`, infinite
    where the rank is less; null_space: (..., n, n) rows that span R^n, of which those from `rank` on are joint rates,
    in radians and sizes, that do not move the tool.
    """

    task: MotionTask
    jacobian: Array
    rank: Index
    singular_values: Array
    raw_singular_values: Array
    manipulability: Array
    condition: Array
    null_space: Array
    robot: Robot
    q: Array
    frame: Literal["base", "tool"] = "base"

    def __len__(self) -> int:
        """The number of configurations of a block. Raises InputTypeError for a single one."""
        if self.q.ndim < 2:
            raise InputTypeError("found the answer at one configuration, which has no length, expected q: (m, n)")
        return len(self.q)

    def __bool__(self) -> bool:
        """An answer is one whatever its length."""
        return True

    def __getitem__(self, i: SupportsIndex | slice) -> Differential:
        """The answer at configuration i, or at some. Raises IndexError."""
        if not isinstance(i, slice) and not hasattr(i, "__index__"):
            raise InputTypeError(f"index: found {described(i)}, expected the number of a configuration, from 0")
        if self.q.ndim < 2:
            raise InputTypeError("found the answer at one configuration, which has no parts, expected q: (m, n)")
        return _each(self, lambda values: values[i])

    def __iter__(self) -> Iterator[Differential]:
        """The answers in the order of the configurations."""
        return (self[i] for i in range(len(self)))

    def __repr__(self) -> str:
        """A line: the rank, and how near to less of it."""
        name, full = self.robot.id or self.robot.name, self.task.dimension
        if self.q.ndim < 2:
            volume, condition = float(self.manipulability), float(self.condition)
            said = f"manipulability {volume:.6g}, condition {condition:.6g}"
            return f"<Jacobian of {name}: rank {int(self.rank)} of {full}, {said}>"
        low, high = (int(self.rank.min()), int(self.rank.max())) if self.rank.size else (0, 0)
        rank = f"{high}" if low == high else f"{low} to {high}"
        return f"<{self.rank.size} Jacobians of {name}: rank {rank} of {full}>"


@dataclass(frozen=True, eq=False, repr=False)
class Lost(Brief):
    """A direction that the tool cannot move in.

    twist: (6,) of length 1, linear before angular, lengths in sizes; words: the same in words.
    """

    twist: Array
    words: str


def _each(found: Differential, changed: Callable[[Any], Any]) -> Differential:
    """An answer with all its arrays changed alike."""
    names = [part.name for part in fields(found) if part.name not in ("task", "robot", "frame")]
    return replace(found, **{name: changed(getattr(found, name)) for name in names})


def block_of(found: Differential) -> Differential:
    """The answer at one configuration as that of a block of one; of a block as it is."""
    return found if found.q.ndim > 1 else _each(found, lambda values: np.asarray(values)[None])


def motion_task(robot: Robot, name: TaskName | None = None) -> MotionTask:
    """What counts for an arm: the whole pose, the position or the orientation; by itself what the books take.

    Arms of up to three joints place a point, if their joints move the tool's origin in as many directions, or else
    turn the tool (a wrist), if they turn it about as many axes. For all others the whole pose counts. Raises
    InputError for a robot without joints, or for another name.
    """
    robot = expect_robot(robot)
    if not robot.n:
        raise InputError(f"{robot.name} has no joints, expected a robot that can move")
    if name is not None:
        expect_choice(name, get_args(TaskName), "task")
    return _task(robot, name)


@fact
def _task(robot: Robot, name: TaskName | None) -> MotionTask:
    size = arm_size(robot)
    # Arbitrary configurations: what holds at them but for chance holds nearly everywhere.
    q = np.random.default_rng(7).uniform(-1.0, 1.0, (8, robot.n)) * np.where(robot.revolute, 1.0, size)
    J = scaled(robot, jacobian(robot, q), size)

    def rank(rows: slice) -> int:
        values = np.linalg.svd(J[:, rows], compute_uv=False)
        return int(np.max(np.sum(values > RANK * np.maximum(values[:, :1], RANK), axis=1)))

    if name is None:
        name = "pose"
        # Variables beside a chain may be more than its joints: these say what the arm does.
        joints = min(robot.n, len(robot.drive.offsets)) if isinstance(robot, CoupledRobot) else robot.n
        if joints <= 3:
            for part in ("position", "orientation"):
                if name == "pose" and rank(ROWS[part]) == joints:
                    name = part
    counted = np.zeros_like(J)
    counted[:, ROWS[name]] = J[:, ROWS[name]]
    u, values, _ = np.linalg.svd(np.moveaxis(counted, 1, 0).reshape(6, -1))
    span = u[:, : int(np.sum(values > RANK * max(values[0], RANK)))]
    return MotionTask(name, rank(ROWS[name]), size, span)


def scaled(robot: Robot, J: Array, size: float) -> Array:
    """Jacobians (..., 6, n) with lengths in units of `size` [m], also those of sliding joints."""
    S = np.array(J)
    S[..., :3, :] /= size
    S[..., ~robot.revolute] *= size
    return S


def differential_kinematics(
    robot: Robot, q: ArrayLike, frame: Literal["base", "tool"] = "base", task: TaskName | None = None
) -> Differential:
    """The Jacobian at q with its rank, singular values, manipulability and condition number.

    q: (..., n) [rad | m]; `frame` gives the axes of the Jacobian; `task` what counts of the twist: pose, position,
    orientation, by itself as `motion_task` says. Raises InputError for a robot without joints, for another shape of q
    and for what is not finite.
    Source: T. Yoshikawa, Manipulability of robotic mechanisms, Int. J. Robotics Research 4(2), 1985.
    """
    kind = motion_task(robot, task)
    q = expect_finite(plain_joint_values(robot, q), "q", "finite joint values (..., n)")
    J = jacobian(robot, q, frame)
    if not np.isfinite(J).all():
        raise InputError("q: the pose is too far away for a number, expected less")
    M, rows = kind.dimension, kind.rows
    _, values, null = np.linalg.svd(scaled(robot, J, kind.size)[..., rows, :])
    values = values[..., :M]
    raw = np.asarray(np.linalg.svd(J[..., rows, :], compute_uv=False)[..., :M], dtype=np.float64)
    greatest = np.max(values, axis=-1, initial=0.0)
    rank = np.asarray(np.sum(values > RANK * np.maximum(greatest, RANK)[..., None], axis=-1), dtype=np.intp)
    regular = (rank == M) & (M > 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        condition = np.where(regular, greatest / np.min(values, axis=-1, initial=np.inf), np.inf)
    manipulability = np.where(regular, np.prod(raw, axis=-1), 0.0)
    return Differential(kind, J, rank, values, raw, manipulability, condition, null, robot, q, frame)


def dexterity(robot: Robot, q: Array, task: TaskName | None = None, below: float = np.inf) -> tuple[Array, Array]:
    """The least singular value and the manipulability, (m,) each, at q (m, n): those of `differential_kinematics`.

    The former is infinite of an arm that cannot move its tool, and where it is not below a value: most configurations
    are far from singular, which a determinant tells in a tenth of the time. Of square Jacobians the latter is |det J|.
    """
    kind = motion_task(robot, task)
    J = jacobian(robot, q)
    if not np.isfinite(J).all():
        raise InputError("q: the pose is too far away for a number, expected less")
    M, rows = kind.dimension, kind.rows
    least, volume = np.full(len(q), np.inf), np.zeros(len(q))
    if not M:
        return least, volume
    S, raw = scaled(robot, J, kind.size)[:, rows], J[:, rows]
    near = _may_be_near(S, M, below) if np.isfinite(below) else np.ones(len(q), dtype=bool)
    values = np.linalg.svd(S[near], compute_uv=False)[:, :M]
    least[near] = values[:, -1]
    singular = np.flatnonzero(near)[values[:, -1] <= RANK * np.maximum(values[:, 0], RANK)]
    by_values = near
    if raw.shape[1] == raw.shape[2] == M:
        volume, by_values = np.abs(np.linalg.det(raw)), np.zeros(len(q), dtype=bool)
    elif raw.shape[1] == M:
        # Rows of lengths in sizes, so that squares lose no digits.
        unit = np.where(np.arange(6)[rows] < 3, kind.size, 1.0)
        even = raw[~near] / unit[:, None]
        volume[~near] = np.prod(unit) * np.sqrt(np.linalg.det(even @ np.swapaxes(even, 1, 2)))
    else:
        by_values = np.ones(len(q), dtype=bool)
    volume[by_values] = np.prod(np.linalg.svd(raw[by_values], compute_uv=False)[:, :M], axis=1)
    volume[singular] = 0.0
    return least, volume


def nearly_singular(robot: Robot, q: Array, below: float, task: TaskName | None = None) -> Flags:
    """Whether the least singular value at q (m, n) is below a value: (m,), as `dexterity` has it."""
    return np.asarray(dexterity(robot, q, task, below)[0] < below)


def _may_be_near(S: Array, M: int, below: float) -> Flags:
    """Whether the least of M singular values of S (m, k, n) may be below a value: False where that is sure, (m,)."""
    near: Flags = np.ones(len(S), dtype=bool)
    if M < 2 or min(S.shape[1:]) != M:
        return near
    # Squares of the others add up to no more than that of all elements: so great is their product at most.
    total = np.sum(S * S, axis=(1, 2))
    most = (total / (M - 1)) ** (M - 1)
    if S.shape[1] == S.shape[2]:
        squared = np.linalg.det(S) ** 2
    else:
        across = np.swapaxes(S, 1, 2)
        squared = np.linalg.det(S @ across if S.shape[1] == M else across @ S)
    # Of what is squared rounding leaves a part of all elements.
    return np.asarray(squared < most * np.maximum((2.0 * below) ** 2, SQUARED * total))


def is_singular(robot: Robot, q: Array, task: TaskName | None = None) -> bool:
    """Whether the rank at joint values q (n,) is less than at others."""
    found = differential_kinematics(robot, q, task=task)
    return bool(found.rank < found.task.dimension)


def null_space_joints(found: Differential) -> list[tuple[int, ...]]:
    """For each configuration the joints, from 1, that can move together while the tool stands still to first order."""
    n = found.null_space.shape[-1]
    ranks, null = found.rank.reshape(-1), found.null_space.reshape(-1, n, n)
    still = np.arange(n) >= ranks[:, None]
    moved = np.max(np.abs(null) * still[:, :, None], axis=1) > RANK
    return [tuple((np.flatnonzero(row) + 1).tolist()) for row in moved]


def lost_directions(
    robot: Robot, q: ArrayLike, frame: Literal["base", "tool"] = "base", task: TaskName | None = None
) -> list[Lost]:
    """What the tool cannot do at one configuration q: (n,) [rad | m] where the rank is less than generic; else [].

    Directions in which the arm can never move are no loss and left out.
    """
    kind = motion_task(robot, task)
    q = np.asarray(q, dtype=np.float64)
    J = np.zeros((6, robot.n))
    J[kind.rows] = scaled(robot, jacobian(robot, q), kind.size)[kind.rows]
    u, values, _ = np.linalg.svd(kind.span.T @ J)
    rank = int(np.sum(values > RANK * max(values[0], RANK)))
    if rank >= kind.dimension:
        return []
    F = joint_frames(robot, q)
    centre = wrist_centre(robot, F)
    points = [(f"joint {k + 1}", F[k, :3, 3]) for k in range(len(F) - 2, -1, -1)]
    if centre is not None:
        points = [("the wrist centre", centre)]
    offsets = [(name, (point - F[-1, :3, 3]) / kind.size) for name, point in points]
    twists = _sparse((kind.span @ u[:, rank:]).T)
    turn = F[-1, :3, :3] if frame == "tool" else np.eye(3)
    return [_lost(twist, offsets, turn, centre is not None) for twist in twists]


def wrist_centre(robot: Robot, frames: Array) -> Array | None:
    """(..., 3) where the last three axes meet [m], of joint frames (..., n + 1, 4, 4); None for no such wrist."""
    if not structure_of(robot).wrist.startswith("spherical"):
        return None
    z, o = frames[..., -4:-1, :3, 2], frames[..., -4:-1, :3, 3]
    # The point nearest to the last two axes, which are never parallel in a wrist.
    return nearest_point(z[..., 1, :], o[..., 1, :], z[..., 2, :], o[..., 2, :])


def _lost(twist: Array, offsets: list[tuple[str, Array]], turn: Array, wrist: bool) -> Lost:
    f, m = twist[:3] @ turn, twist[3:] @ turn
    u = np.concatenate([f, m])
    u = np.where(np.abs(u) < RANK, 0.0, u) / np.linalg.norm(u)
    u = u * np.sign(u[np.flatnonzero(u)[0]]) + 0.0
    f, m = u[:3], u[3:]
    if not f.any():
        return Lost(u, f"rotation about {_direction(m)}")
    if not m.any():
        return Lost(u, f"translation along {_direction(f)}")
    moments = [(name, m - np.cross(offset @ turn, f)) for name, offset in offsets]
    for name, about in moments:
        if np.linalg.norm(about) < 10.0 * RANK:
            return Lost(u, f"translation of {name} along {_direction(f)}")
    still, about = moments[0] if wrist else ("the tool's origin", m)
    return Lost(u, f"rotation about {_direction(about)} while {still} stands still")


def _direction(v: Array) -> str:
    """A unit vector in words, its first element that is not zero positive."""
    unit = np.round(v / np.linalg.norm(v), 4)
    unit = unit * np.sign(unit[np.flatnonzero(unit)[0]]) + 0.0
    return f"[{', '.join(f'{x:.4f}'.rstrip('0').rstrip('.') for x in unit)}]"


def _sparse(basis: Array) -> Array:
    """Vectors (k, 6) of length 1 that span the same as (k, 6), with few entries each: Gauss and Jordan's form."""
    out = basis.copy()
    for i in range(len(out)):
        row, column = divmod(int(np.argmax(np.abs(out[i:]))), out.shape[1])
        out[[i, i + row]] = out[[i + row, i]]
        out[i] /= out[i, column]
        others = np.arange(len(out)) != i
        out[others] -= out[others, column][:, None] * out[i]
    return np.asarray(out / np.linalg.norm(out, axis=1, keepdims=True))
