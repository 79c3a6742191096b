"""Inverse kinematics of an arm with some joints held: the rest is an arm of its own, and is solved as that.

Statement. Given values for some joints of an arm of n, find every value of the others that reaches a pose.
Derivation. A joint that stands still is a constant transform between its neighbours: the row of the table becomes a
fixed one, theta + offset + value of a revolute joint, d + offset + value of a prismatic one, or in frames
origin · motion(offset + value). What is left is an arm of fewer joints, for which everything holds that is said of
arms: a redundant one of seven joints with one held has finitely many solutions at a generic pose, and they can all
be found. Of its configurations the held values make configurations of the whole arm.
Degenerate case. At a held value at which the rest cannot do all that it otherwise could (two of its axes on one
line), the rest is analysed as the special arm that it then is.
"""

from __future__ import annotations

import math
from collections import OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from functools import cache, cached_property, partial
from typing import Any

import numpy as np

from robokin.arrays import Array, Index
from robokin.errors import InputError
from robokin.inverse.analysis import analysis_of, known_analysis
from robokin.inverse.held_drive import drive_left
from robokin.inverse.held_forms import HeldForms, held_forms
from robokin.inverse.later_fields import changed, nearest_unknown, with_later_nearest
from robokin.inverse.one_answer import OneAnswer
from robokin.inverse.one_target_arm import OneTargetArm, one_target_arm
from robokin.inverse.solution_names import branch_names
from robokin.inverse.solutions import Arc, BatchResult, Family, Result, Solution, named_later
from robokin.inverse.unmade_result import told_result
from robokin.jobs.shared_rows import by_threads
from robokin.kernel.chain import chain_of, row_standing
from robokin.kernel.facts import fact, tell
from robokin.model import CoupledRobot, Robot
from robokin.model.robot import LIMIT_TOLERANCE

KEPT = 16
"""Arms with joints held that are kept for one robot: enough for a few values in turn; a sweep over many values must
not fill the memory."""

PLAIN = (float, int, np.float64)
"""Types of values that are taken as they are."""

SHARE = 16_000
"""Targets whose solutions a thread puts together at once."""


@dataclass(frozen=True, eq=False)
class HeldArm:
    """A robot's table with some joints held.

    n: joints of the whole robot; joints: (h,) the held ones, from 0; values: (h,) theirs [rad | m]; inside: whether
    these are within the limits; free: (n - h,) the others, from 0; made: gives the arm of these; forms: how it is known
    for any values.
    """

    n: int
    joints: Index
    values: Array
    inside: bool
    free: Index
    made: Callable[[], Robot]
    forms: HeldForms | None = None

    @cached_property
    def part(self) -> Robot:
        """The arm of the joints that are not held."""
        part = self.made()
        known: OneTargetArm | None = self._known
        if known is not None:
            tell(chain_of, known.analysis.chain, part)
            tell(known_analysis, known.analysis, part, "pose")
            tell(one_target_arm, self._known, part)
        return part

    @cached_property
    def one(self) -> OneTargetArm | None:
        """What answers one pose for the part; None where blocks do."""
        return one_target_arm(self.part) if self._known is None else self._known

    @cached_property
    def _known(self) -> OneTargetArm | None:
        return None if self.forms is None else self.forms.arm(self.values.tolist(), self._part)

    def _part(self) -> Robot:
        return self.part

    def __getstate__(self) -> dict[str, Any]:
        """The fields, for copies and pickles; code, and what the native kernel knows, are found out again."""
        return {part.name: getattr(self, part.name) for part in fields(self)} | {"forms": None}

    @cached_property
    def pattern(self) -> Array:
        """(n,) the values of the joints that are held, NaN elsewhere."""
        values = np.full(self.n, np.nan)
        values[self.joints] = self.values
        return values

    def own(self, q: Array) -> Array:
        """Those of joint values (..., n) that are not held, (..., n - h)."""
        return q[..., self.free]

    def whole(self, q: Array) -> Array:
        """Joint values (..., n) from those of the part (..., n - h); NaN where these are (padded rows)."""
        out = np.empty((*q.shape[:-1], self.n))
        self._put(q, out)
        return out

    def whole_batch(self, q: Array, cores: int | None) -> Array:
        """The same of the configurations (m, k, n - h) of a batch, which cores share."""
        m, k, n = q.shape
        return by_threads(
            lambda rows, out: self._put(rows.reshape(len(rows), k, n), out), q.reshape(m, k * n), (k, self.n), SHARE,
            cores,
        )  # fmt: skip

    def _put(self, q: Array, out: Array) -> None:
        source = np.zeros(self.n, dtype=np.intp)
        source[self.free] = np.arange(len(self.free))
        np.take(q, source, axis=-1, out=out, mode="clip")  # clip: or else it works on a copy of `out`
        out[..., self.joints] = np.where(np.isnan(q[..., :1]), np.nan, self.values)

    def numbers(self, joints: tuple[int, ...]) -> tuple[int, ...]:
        """Joints of the part in the whole robot's numbers; both count from 1."""
        return tuple(int(self.free[i - 1]) + 1 for i in joints)


def held_arm(robot: Robot, hold: Mapping[int, float]) -> HeldArm:
    """The arm that is left of a robot when joints (from 0) are held at values [rad | m]. Kept for the next call.

    Raises InputError for joints that the robot does not have, values that are no numbers, and when nothing is left.
    """
    checked = tuple(sorted(_checked(robot, hold).items()))
    kept = _held_arms(robot)
    arm = kept.get(checked)
    if arm is None:
        arm = kept.setdefault(checked, _held(robot, dict(checked)))
    try:
        kept.move_to_end(checked)
        if len(kept) > KEPT:
            kept.popitem(last=False)
    except KeyError:  # another thread has let go of it in between
        pass
    return arm


def arm_held_before(robot: Robot, hold: dict[int, float]) -> HeldArm | None:
    """The arm of joints and values that were held before, as `held_arm` has it; None where that has to look at them."""
    for joint, value in hold.items():
        if type(joint) is not int or type(value) not in PLAIN:
            return None  # what equals a number may be none
    kept, asked = _held_arms(robot), tuple(hold.items())
    try:
        arm = kept[asked]
        kept.move_to_end(asked)
    except KeyError:
        return None
    return arm


@fact
def _held_arms(robot: Robot) -> OrderedDict[tuple[tuple[int, float], ...], HeldArm]:
    """The arms that were last asked for, none at first, by the joints and their values."""
    return OrderedDict()


def _forms(robot: Robot, joints: tuple[int, ...]) -> HeldForms | None:
    """How the arms that are left are known, from the second one on: for a single value it does not pay."""
    asked = _asked(robot)
    if joints in asked:
        return held_forms(robot, joints)
    asked.add(joints)
    return None


@fact
def _asked(robot: Robot) -> set[tuple[int, ...]]:
    """The joints that were held so far."""
    return set()


def check_held_limits(robot: Robot, arm: HeldArm) -> None:
    """Raise InputError where a held value is outside the joint's limits, or leaves no value to one that hangs on it."""
    if arm.inside:
        return
    for joint, value in zip(arm.joints.tolist(), arm.values.tolist(), strict=True):
        if not held_inside(robot, joint, value):
            low, high = robot.limits[joint].tolist()
            unit = "rad" if robot.revolute[joint] else "m"
            raise InputError(
                f"q{joint + 1} is held at {value:.6g} {unit}, outside its limits; "
                f"expected {low:.6g} to {high:.6g} {unit}, or limits=False"
            )
    if not arm.inside:
        names = " and ".join(f"q{joint + 1}" for joint in arm.joints.tolist())
        raise InputError(
            f"with {names} held so, joints that hang on {'them' if len(arm.joints) > 1 else 'it'} have no value within "
            "their limits; expected other values, or no limits"
        )


def held_inside(robot: Robot, joint: int, value: float) -> bool:
    """Whether a value [rad | m] of a joint (from 0) is within its limits, which are inclusive."""
    low, high = robot.limits[joint].tolist()
    return bool(low - LIMIT_TOLERANCE <= value <= high + LIMIT_TOLERANCE)


def with_held_joints(robot: Robot, arm: HeldArm, batch: BatchResult, cores: int | None = 1) -> BatchResult:
    """The answers of the part as answers of the robot: the held values put in, joints by the robot's numbers.

    The kernel has put them in already where it made the table.
    The solutions are some of all that the robot has at the pose. Where these are finitely many, the robot's names tell
    them apart; a redundant robot's do not, and the postures are named as the part's.
    """
    motion = robot.free_motion if isinstance(robot, CoupledRobot) else robot
    renamed = not (isinstance(robot, CoupledRobot) and not robot.drive.invertible)
    renamed = renamed and analysis_of(motion).redundancy == 0
    count = batch.count.copy()
    q = batch.q if batch.q.shape[2] == arm.n else arm.whole_batch(batch.q, cores)

    def single(i: int) -> Result:
        return _whole_result(arm, batch[i], robot if renamed else None)

    def branches() -> list[str]:
        return _names(robot, q[np.arange(q.shape[1]) < count[:, None]]) if renamed else batch.branches()

    return replace(batch, q=q, within_limits=batch.within_limits & arm.inside, single=single, branches=branches)


def whole_answer(robot: Robot, arm: HeldArm, answer: OneAnswer, question: dict[str, Any]) -> dict[str, Any]:
    """The fields of the part's answer to a question as one of the robot: see `with_held_joints`."""
    named = robot if analysis_of(robot).redundancy == 0 else None
    if arm.inside:
        return answer.told(question, arm.pattern, named)
    return vars(_whole_result(arm, told_result(answer.told(question)), named))


def own_near(arm: HeldArm, near: Array | None) -> Array | None:
    """The part's own of the wished values near: (n,) [rad | m]."""
    return None if near is None else arm.own(near)


def _checked(robot: Robot, hold: Mapping[int, float]) -> dict[int, float]:
    checked: dict[int, float] = {}
    for joint, value in hold.items():
        if isinstance(joint, bool) or not isinstance(joint, (int, np.integer)) or not 0 <= joint < robot.n:
            raise InputError(
                f"hold: found joint {joint!r}, expected 0 to {robot.n - 1}: the joints of {robot.name} count from 0"
            )
        try:
            number = np.nan if isinstance(value, (bool, np.bool_, str)) else float(value)
        except (TypeError, ValueError):
            number = np.nan
        if not math.isfinite(number):
            raise InputError(f"hold: found {value!r} for joint {joint}, expected a finite number [rad | m]")
        checked[int(joint)] = number
    if len(checked) == robot.n:
        raise InputError(f"all {robot.n} joints of {robot.name} are held, expected at least one that can move")
    return checked


def _held(robot: Robot, hold: dict[int, float]) -> HeldArm:
    joints, values = np.array(list(hold), dtype=np.intp), np.array(list(hold.values()))
    free = np.array([i for i in range(robot.n) if i not in hold], dtype=np.intp)
    inside = all(held_inside(robot, joint, value) for joint, value in hold.items())
    if isinstance(robot, CoupledRobot):
        part, left = drive_left(robot, hold, _name(robot, hold))
        return HeldArm(robot.n, joints, values, inside and left, free, partial(_given, part))
    forms = _forms(robot, tuple(hold))
    return HeldArm(robot.n, joints, values, inside, free, partial(_part_of, robot, hold), forms)


def _given(part: Robot) -> Robot:
    return part


def _name(robot: Robot, hold: dict[int, float]) -> str:
    return f"{robot.name} with {', '.join(f'q{i + 1}' for i in hold)} held"


def _part_of(robot: Robot, hold: dict[int, float]) -> Robot:
    """The arm of the joints that are not held."""
    rows, number = [], 0
    for row in robot.rows:
        if row.moves:
            rows.append(row_standing(row, hold[number], robot.convention) if number in hold else row)
            number += 1
        else:
            rows.append(row)
    return replace(robot, name=_name(robot, hold), rows=tuple(rows), poses={}, texts=())


def _whole_result(arm: HeldArm, result: Result, named: Robot | None) -> Result:
    """The answer for one target; `named` is the robot that its postures are named for, None for the part's names."""
    solutions = _whole_solutions(arm, result.solutions, named)
    families = tuple(_whole_family(arm, family) for family in result.families)
    whole = changed(result, solutions=solutions, families=families)
    if nearest_unknown(result):
        return with_later_nearest(whole, vars(result).get("reason"), partial(_whole_why, arm, result, named))
    if result.nearest is None:
        return whole
    return changed(whole, nearest=_whole_why(arm, result, named)[1])


def _whole_why(arm: HeldArm, result: Result, named: Robot | None) -> tuple[str, Solution]:
    """Why there is no solution, and what comes nearest."""
    assert result.reason is not None and result.nearest is not None
    return result.reason, _whole_solutions(arm, (result.nearest,), named)[0]


def _whole_solutions(arm: HeldArm, shown: tuple[Solution, ...], named: Robot | None) -> tuple[Solution, ...]:
    """The part's solutions as the robot's."""

    @cache
    def names() -> list[str]:
        if named is None:
            return [solution.branch for solution in shown]
        return _names(named, arm.whole(np.array([solution.q for solution in shown])))

    told = [
        (*solution.q.tolist(), solution.position_error, solution.angle_error, solution.within_limits and arm.inside)
        for solution in shown
    ]
    table = np.array(told, dtype=np.float64).reshape(len(shown), len(arm.free) + 3)
    free = [arm.numbers(solution.free) if solution.free else () for solution in shown]
    return named_later(partial(_of, names), table, len(arm.free), free, pattern=arm.pattern)


def _names(robot: Robot, q: Array) -> list[str]:
    """The names of configurations q (s, n) [rad | m], which are those of what moves where joints hang on each other."""
    if isinstance(robot, CoupledRobot):
        return branch_names(robot.free_motion, robot.drive.motions(q))
    return branch_names(robot, q)


def _whole_family(arm: HeldArm, family: Family) -> Family:
    arcs = tuple(Arc(arm.whole(arc.q), arc.whole) for arc in family.arcs)
    return replace(family, joints=arm.numbers(family.joints), arcs=arcs)


def _of(names: Callable[[], list[str]], k: int) -> str:
    return names()[k]
