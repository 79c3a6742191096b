"""What `solve_ik` answers: frozen values, each solution with its own residual."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, fields, replace
from functools import partial
from typing import TYPE_CHECKING, Any, SupportsIndex, overload

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.brief import Answer, Brief
from robokin.errors import InputTypeError
from robokin.expected import described
from robokin.inverse.later_fields import FOUND_BY, changed, nothing_yet, with_later_families
from robokin.kernel.native_kernel import native
from robokin.model import Robot


@dataclass(frozen=True, eq=False, repr=False)
class Solution(Brief):
    """One joint configuration.

    q: (n,) [rad | m]; `branch` names it (shoulder, elbow, wrist) or is empty; the errors are those of its
    pose against the target, measured by forward kinematics [m, rad]. `free` names the joints that may
    trade motion with each other at this configuration while the pose stays (a self-motion), in
    numbers from 1; it is empty where the solution stands alone.
    """

    q: Array
    branch: str
    within_limits: bool
    position_error: float
    angle_error: float
    free: tuple[int, ...] = field(default_factory=tuple)

    def __getstate__(self) -> dict[str, Any]:
        """The fields, for copies and pickles."""
        return {part.name: getattr(self, part.name) for part in fields(self)}

    if not TYPE_CHECKING:  # who reads the types knows the fields alone

        def __getattr__(self, name: str) -> Any:
            """The branch or the free joints, where they are not worked out yet."""
            known = self.__dict__
            later = known.get(LATER.get(name))
            if later is not None:
                find, place = later
                known[name] = find(place)
                known.pop(LATER[name], None)
            if name in known:  # found here, or meanwhile by another thread
                return known[name]
            raise AttributeError(f"'{type(self).__name__}' object has no attribute '{name}'", name=name, obj=self)


LATER = {"branch": "_name", "free": "_free"}
"""Where a solution keeps what finds a field that is not worked out yet: a function, and what it is asked."""


class SolutionInMaking(Brief):
    """A solution before it is frozen: fields are set in a fraction of the time, and then it is made a `Solution`."""


def named_later(
    name: Callable[[int], str],
    table: Array,
    joints: int,
    free: tuple[int, ...] | list[tuple[int, ...]] | Callable[[int], tuple[int, ...]] = (),
    rows: list[int] | None = None,
    within: bool = False,
    pattern: Array | None = None,
    first: int = 0,
) -> tuple[Solution, ...]:
    """Solutions whose branches are found when they are first asked for.

    table: (k, joints + 3 or more) of each the joint values [rad | m], the distance and the angle that it lacks [m, rad]
    and whether it is within the limits; rows: which of them, in order; within: only those within the limits;
    name: gives the branch of the one in a row, counted from `first`; free: what is free of all, of each row, or a
    function like `name`; pattern: (n,) values of joints that are held, NaN where those of the table stand.
    """
    if native is not None:
        made: tuple[Solution, ...] = native.solution_objects(
            Solution, name, table, joints, free, rows, within, pattern, first
        )
        return made
    return tuple(_named_later(name, table, joints, free, rows, within, pattern, first))


def _named_later(
    name: Callable[[int], str],
    table: Array,
    joints: int,
    free: tuple[int, ...] | list[tuple[int, ...]] | Callable[[int], tuple[int, ...]],
    rows: list[int] | None,
    within: bool,
    pattern: Array | None,
    first: int,
) -> Iterator[Solution]:
    """The same without the native kernel."""
    if pattern is None:
        q = table[:, :joints].copy()
    else:
        q = np.tile(pattern, (len(table), 1))
        q[:, np.isnan(pattern)] = table[:, :joints]
    told: list[list[float]] = table[:, joints : joints + 3].tolist()
    for row in range(len(told)) if rows is None else rows:
        position, angle, inside = told[row]
        if within and not inside:
            continue
        one: Any = SolutionInMaking()
        one.q = q[row]
        one.within_limits = inside != 0.0
        one.position_error = position
        one.angle_error = angle
        one._name = (name, first + row)
        if callable(free):
            one._free = (free, first + row)
        else:
            one.free = free[row] if type(free) is list else free
        one.__class__ = Solution
        yield one


@dataclass(frozen=True, eq=False, repr=False)
class Arc(Brief):
    """A piece of a self-motion that lies within the joint limits.

    q: (k, n) [rad | m] configurations along it, each reaching the pose; the first and the last are its ends,
    where a joint meets its limit. `whole` is true where the self-motion is a closed curve that lies within the
    limits everywhere, and the first and the last are then the same but for full turns. `swivel` is the interval of the
    swivel angle [rad] that it covers, from the first to the last, of an arm that has one (`swivel_angle`).
    """

    q: Array
    whole: bool = False
    swivel: tuple[float, float] | None = None

    def __getstate__(self) -> dict[str, Any]:
        """The fields, for copies and pickles."""
        return {part.name: getattr(self, part.name) for part in fields(self)}

    if not TYPE_CHECKING:  # who reads the types knows the fields alone

        def __getattr__(self, name: str) -> Any:
            """The configurations, where they are not worked out yet."""
            known = self.__dict__
            find = known.get("_find")
            if find is not None and name == "q":
                known["q"] = find()
                known.pop("_find", None)
            if name in known:  # found here, or meanwhile by another thread
                return known[name]
            raise AttributeError(f"'{type(self).__name__}' object has no attribute '{name}'", name=name, obj=self)


def arc_later(find: Callable[[], Array], whole: bool, swivel: tuple[float, float]) -> Arc:
    """An arc whose configurations are worked out when they are first asked for."""
    one = object.__new__(Arc)
    one.__dict__.update(whole=whole, swivel=swivel, _find=find)
    return one


@dataclass(frozen=True, eq=False, repr=False)
class Family(Brief):
    """A self-motion: a connected set of configurations that all reach the pose.

    joints: those that move, in numbers from 1; dimension: 1 for a curve, more for a surface; closed: whether the
    curve was followed until it closed; arcs: its pieces within the limits (all of it where limits do not count);
    solution: which of the listed solutions, from 0, stands for it, or -1 where none does (none is within the limits,
    or the list was cut).
    """

    joints: tuple[int, ...]
    dimension: int
    closed: bool
    arcs: tuple[Arc, ...]
    solution: int


@dataclass(frozen=True, eq=False, repr=False)
class Question(Brief):
    """What was asked: for the pose T (4, 4) or (m, 4, 4) [m] of a robot's tool.

    `task` is what of the pose counts, `limits` whether the joint limits do, `hold` the joints (from 0) that are held
    at values [rad | m].
    """

    robot: Robot
    T: Array
    task: str = "pose"
    limits: bool = True
    hold: Mapping[int, float] = field(default_factory=dict)


@dataclass(frozen=True, eq=False, repr=False)
class Result(Answer):
    """The answer for one target: a sequence of its solutions.

    `complete` is true only where every solution is listed, or stands on one of the `families`; `basis` is what
    that rests on: "counted" (as many complex solutions found as the arm has at any pose), "accounted" (the paths
    of a homotopy from two independent starts all ended: regular, singular or infinite), None where not all solutions
    are known. Where they are, and `complete` is false, the list was cut, or only `postures` holds. `certificate` says
    the basis in a sentence with the numbers, or why there is none. `reason` says why there is no solution; `nearest`
    is then the closest configuration found. `counts` says how many were left after each filter: "closing" (distinct
    ones that reach the pose), "within_limits", "listed"; and how many the listed ones make with full turns of joints
    within the limits: "turns". `postures` is true where every solution is listed or differs from a listed one only in
    joints that are free on their own, whatever the others do. `families_complete` is true where every self-motion is
    one of the `families`, but for those that are nowhere within the limits: where all solutions are known, and of arms
    with a spherical shoulder and wrist.
    """

    solutions: tuple[Solution, ...]
    complete: bool
    method: str
    reason: str | None = field(default_factory=nothing_yet)
    nearest: Solution | None = field(default_factory=nothing_yet)
    counts: Mapping[str, int] = field(default_factory=dict)
    postures: bool = False
    basis: str | None = field(default_factory=nothing_yet)
    certificate: str = field(default_factory=str)
    all_known: bool = False
    families: tuple[Family, ...] = field(default_factory=tuple)
    question: Question | None = field(default_factory=nothing_yet)
    families_complete: bool = field(default_factory=bool)

    def __getstate__(self) -> dict[str, Any]:
        """The fields, and what finds self-motions that are not worked out yet, for copies and pickles."""
        # Worked out now: what finds it knows a whole block of targets.
        found = {
            name: getattr(self, name) for name in ("nearest", "basis", "question") if FOUND_BY[name] in self.__dict__
        }
        return {**self.__dict__, **found}

    if not TYPE_CHECKING:  # who reads the types knows the fields alone

        def __getattr__(self, name: str) -> Any:
            """What is not worked out yet: question, self-motions, proof, reason, what is nearest."""
            known = self.__dict__
            place = FOUND_BY.get(name)
            find = known.get(place)
            if find is not None:
                known.update(find())
                known.pop(place, None)
            if name in known:  # found here, or meanwhile by another thread
                return known[name]
            raise AttributeError(f"'{type(self).__name__}' object has no attribute '{name}'", name=name, obj=self)

    @property
    def reachable(self) -> bool:
        """Whether there is a solution."""
        return bool(self.solutions)

    def __len__(self) -> int:
        """The number of solutions."""
        return len(self.solutions)

    @overload
    def __getitem__(self, i: SupportsIndex) -> Solution: ...
    @overload
    def __getitem__(self, i: slice) -> tuple[Solution, ...]: ...
    def __getitem__(self, i: SupportsIndex | slice) -> Solution | tuple[Solution, ...]:
        """Solution i, or a tuple of some. Raises IndexError."""
        try:
            return self.solutions[i]
        except IndexError:
            why = "" if self.solutions else f": {self.reason}"
            raise IndexError(f"solution {i} of {len(self.solutions)}{why}") from None

    def __iter__(self) -> Iterator[Solution]:
        """The solutions in their order."""
        return iter(self.solutions)

    def __repr__(self) -> str:
        """A line: how many solutions, whether they are all, or why there is none."""
        if not self.solutions:
            return f"<no solution: {self.reason}>"
        count = "1 solution" if len(self) == 1 else f"{len(self)} solutions"
        return f"<{count}, {'these are all' if self.complete else 'perhaps not all'}: {self.method}>"


def _at(known: list[Any], i: int) -> Any:
    """What is known of target i."""
    return known[i]


@dataclass(frozen=True, eq=False, repr=False)
class BatchResult(Answer):
    """The answers for m targets as arrays, padded with NaN; `result[i]` is the answer for target i.

    q: (m, k, n) [rad | m]; count: (m,); position_error, angle_error: (m, k) [m, rad];
    within_limits: (m, k), False where padded.
    """

    q: Array
    count: Index
    position_error: Array
    angle_error: Array
    within_limits: Flags
    complete: bool
    method: str
    single: Callable[[int], Result]
    """Makes the answer for one target: reasons are worked out only for those that are looked at."""
    branches: Callable[[], list[str]]
    """Names all solutions, target after target: as many as `count` has in all."""
    reason: Callable[[int], str | None]
    """Says why a target has no solution."""
    question: Question | None = None
    alone: Callable[[Array], Result] | None = None
    """Answers one target T (4, 4) [m] by itself, of arms whose self-motions are looked for when they are asked for."""

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled with the answers for all targets, which are made for it."""
        answers = [self.single(i) for i in range(len(self))]
        reasons = [None if self.count[i] else self.reason(i) for i in range(len(self))]
        arrays = (self.q, self.count, self.position_error, self.angle_error, self.within_limits)
        made: tuple[Any, ...] = (partial(_at, answers), partial(list, self.branches()), partial(_at, reasons))
        return type(self), (*arrays, self.complete, self.method, *made, self.question, self.alone)

    def __len__(self) -> int:
        """The number of targets."""
        return len(self.count)

    def __getitem__(self, i: SupportsIndex) -> Result:
        """The answer for target i, negative ones from the end. Raises IndexError."""
        if not hasattr(i, "__index__"):
            raise InputTypeError(f"index: found {described(i)}, expected the number of a target, from 0")
        number = i.__index__()
        if not -len(self) <= number < len(self):
            raise IndexError(f"target {number} of {len(self)}")
        number %= len(self)
        result = self.single(number)
        if self.question is None:
            return result
        T = self.question.T[number]
        result = changed(result, question=replace(self.question, T=T))
        return result if self.alone is None else with_later_families(result, partial(self.alone, T))

    def __iter__(self) -> Iterator[Result]:
        """The answers in the order of the targets."""
        return (self[i] for i in range(len(self)))

    def __repr__(self) -> str:
        """A line: how many targets, and how many of them are reached."""
        return f"<{len(self)} targets, {int((self.count > 0).sum())} reached: {self.method}>"
