"""`solve_tips`: targets for several tips of a tree at once, each group of tips that share joints on its own.

Statement. Of targets for tips of a tree say all configurations, where that can be said, and one otherwise.
Derivation. Tips whose chains share no variable do not know of each other: the tree's configurations are all
combinations of theirs. So tips are put together where their chains share variables, as connected parts of that graph. A
part of one tip is a robot, and `solve_ik` lists what it has. Any other part is searched as a whole (`driven_descent`),
which gives one configuration and proves nothing.
Degenerate case. A tip that no joint moves has no part, and is refused.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import cast

import numpy as np
from numpy.typing import ArrayLike

from robokin.arrays import Array, Flags, Index
from robokin.brief import Answer, Brief
from robokin.errors import InputError, did_you_mean, shown
from robokin.expected import expect_choice, expect_finite, expect_flag, expect_kind, expect_whole
from robokin.inverse.analysis import Task, analysis_of
from robokin.inverse.numeric.driven_descent import ROW_OVER, driven_search
from robokin.inverse.numeric.driven_tips import driven_tips, driving
from robokin.inverse.self_motion.redundant import NOT_FOUND, UNPROVEN
from robokin.inverse.solutions import Arc, Family, Result, Solution
from robokin.inverse.solve import TASKS, solve_ik, target_poses
from robokin.inverse.verify import within_limits
from robokin.model import CoupledRobot, Tree, expect_tree
from robokin.model.graph import SerialChain
from robokin.model.robot import tolerated, within

SEARCH = "damped least squares"
"""The method of tips that are searched for together."""

MOST_NAMED = 6
"""Tips that a sentence names."""


@dataclass(frozen=True, eq=False, repr=False)
class TipQuestion(Brief):
    """What was asked: for these poses T (4, 4) [m] of tips of a tree.

    `tasks` is what of each counts, `limits` whether the joint limits do, `home` (n,) [rad | m] where joints stand that
    nothing moves.
    """

    tree: Tree
    T: Mapping[str, Array]
    tasks: Mapping[str, Task]
    limits: bool
    home: Array


@dataclass(frozen=True, eq=False, repr=False)
class TipGroup(Brief):
    """Tips whose joints are solved for together.

    joints: the numbers, from 1, of the variables of the tree that move them. result: the answer, in configurations (n,)
    of the whole tree in which the joints of other groups stand at the first solution of these. errors: (s, k, 2) of
    each solution, or of the nearest configuration where there is none, each tip's distance [m] and angle [rad] from
    its target. searched: whether a search gave one configuration. idle: joints, from 1, that only move what the tasks
    leave open; redundant: whether the chain has more joints than its task needs.
    """

    tips: tuple[str, ...]
    joints: tuple[int, ...]
    result: Result
    errors: Array
    searched: bool
    idle: tuple[int, ...] = ()
    redundant: bool = False


@dataclass(frozen=True, eq=False, repr=False)
class TipAnswer(Answer):
    """The answer for targets of several tips: the groups of tips that share joints, each with its solutions.

    Every combination of solutions of the groups is a configuration that has all targets; `q` (n,) [rad | m] is that of
    the first ones, None where a group has none. `still` are the numbers, from 1, of the joints that no target moves.
    """

    groups: tuple[TipGroup, ...]
    q: Array | None
    still: tuple[int, ...]
    question: TipQuestion

    @property
    def reachable(self) -> bool:
        """Whether every group has a solution."""
        return all(group.result.reachable for group in self.groups)

    @property
    def complete(self) -> bool:
        """Whether all solutions of every group are listed."""
        return all(group.result.complete for group in self.groups)

    def __repr__(self) -> str:
        """A line: how many solutions each group has."""
        parts = (f"{', '.join(group.tips)}: {len(group.result)}" for group in self.groups)
        return f"<solutions by tip, {'; '.join(parts)}>"


@dataclass(frozen=True, eq=False)
class _TipWish:
    """A target: the tip, its chain, T (4, 4) [m] and what of it counts."""

    tip: str
    chain: SerialChain
    T: Array
    task: Task


def solve_tips(
    tree: Tree,
    targets: Mapping[str, ArrayLike],
    task: Task | Mapping[str, Task] = "pose",
    limits: bool = True,
    near: ArrayLike | None = None,
    most: int | None = None,
    seed: int = 0,
) -> TipAnswer:
    """Configurations that bring several tips of a tree to their targets at once.

    targets: (4, 4) poses in the world [m] by the tips' names, or the names of links; `task` is the whole pose, the
    position with the z axis (`approach`), or the position alone, for all tips or by their names. Tips whose chains
    share no variable are solved for on their own, with the solutions of each that `solve_ik` gives; those that share
    some by a search, which gives one configuration and is never `complete`. Where it finds none the nearest one is
    given. `near` (n,) [rad | m] is where joints stand that no target moves (else zero, or
    amid limits without it), and orders solutions by the joint move from there. `limits`, `most` and `seed` are those of
    `solve_ik`. Raises InputError for what are no tips and no poses, and for tips that no joint moves.
    Source: B. Siciliano et al., Robotics: Modelling, Planning and Control, 2009, sec. 3.5 (augmented task space);
    K. Levenberg, Quart. Appl. Math. 2, 1944; S. R. Buss, J.-S. Kim, Selectively damped least squares for inverse
    kinematics, J. Graphics Tools 10(3), 2005 (several end effectors).
    """
    tree = expect_tree(tree)
    limits, seed = expect_flag(limits, "limits"), expect_whole(seed, "seed", 0)
    most = None if most is None else expect_whole(most, "most", 1)
    wish = None if near is None else expect_finite(near, "near", f"{tree.n} joint values", (tree.n,))
    wishes = _wishes(tree, targets, task)
    home = _home(tree, wish, limits)
    groups = [
        _listed(tree, group[0], wish, limits, most, seed)
        if len(group) == 1
        else _searched(tree, group, home, wish, limits, seed)
        for group in _groups(wishes)
    ]
    return _together(tree, wishes, groups, limits, home)


def _wishes(tree: Tree, targets: Mapping[str, ArrayLike], task: Task | Mapping[str, Task]) -> list[_TipWish]:
    """The targets, checked, in their order."""
    expect_kind(targets, Mapping, "targets", "a mapping of tips to poses (4, 4), such as {'index': T}")
    if not targets:
        raise InputError("targets: found none, expected a pose (4, 4) for at least one tip")
    if isinstance(task, Mapping):
        for name in task:
            if name not in targets:
                raise InputError(f"task: found '{shown(str(name))}', expected tips that have a target")
    found = []
    for tip, T in targets.items():
        check_tip(tree, tip)
        pose = target_poses(T, f"targets['{shown(tip)}']")
        if pose.ndim != 2:
            raise InputError(f"targets: found an array of shape {pose.shape} for {shown(tip)}, expected (4, 4)")
        own = task.get(tip, "pose") if isinstance(task, Mapping) else task
        chain = tree.graph.chain(tree.graph.links[tree.graph.root], tip)
        if not len(chain.variables):
            raise InputError(f"no joint moves the tip {shown(tip)}, expected tips that can move")
        for joint in chain.joints:
            if joint.type not in ("revolute", "prismatic"):
                raise InputError(
                    f"joint {shown(joint.name)} on the way to {shown(tip)} is {shown(joint.type)}, "
                    "expected joints that turn and slide"
                )
        found.append(_TipWish(tip, chain, pose, cast(Task, expect_choice(own, TASKS, "task"))))
    return found


def check_tip(tree: Tree, tip: object, option: str = "targets") -> None:
    """Raise InputError where a tree has no tip and no link of a name."""
    known = [*tree.tips, *(name for name in tree.graph.links if name not in tree.tips)]
    if tip not in known:
        hint = did_you_mean(str(tip), known) or f", expected one of {tree.listed_tips()}"
        raise InputError(f"{option}: found the unknown tip '{shown(str(tip))}'{hint}")


def _home(tree: Tree, near: Array | None, limits: bool) -> Array:
    """(n,) where joints stand that nothing moves [rad | m]: at `near`, or at zero, or amid the limits."""
    low, high = tree.limits.T
    if near is not None:
        return np.clip(near, low, high) if limits else near
    with np.errstate(invalid="ignore"):
        amid = np.where(np.isfinite(low) & np.isfinite(high), (low + high) / 2.0, np.clip(0.0, low, high))
    return np.where((low <= 0.0) & (high >= 0.0), 0.0, amid)


def _groups(wishes: Sequence[_TipWish]) -> list[list[_TipWish]]:
    """The targets whose chains share variables together, in the order of the first of each."""
    groups: list[tuple[set[int], list[_TipWish]]] = []
    for wish in wishes:
        variables, together = set(wish.chain.variables.tolist()), [wish]
        for one in [one for one in groups if one[0] & variables]:
            groups.remove(one)
            variables |= one[0]
            together = [*one[1], *together]
        groups.append((variables, together))
    order = {id(wish): number for number, wish in enumerate(wishes)}
    parts = [sorted(together, key=lambda wish: order[id(wish)]) for _, together in groups]
    return sorted(parts, key=lambda part: order[id(part[0])])


# Of one tip, all solutions ------------------------------------------------------------------------------------


def _listed(tree: Tree, wish: _TipWish, near: Array | None, limits: bool, most: int | None, seed: int) -> TipGroup:
    """The answer for a tip that shares no variable, in its own ones alone."""
    places = _own_places(wish.chain)
    robot = tree.robot(wish.tip)
    own = None if near is None else near[places]
    result = cast(Result, solve_ik(robot, wish.T, limits, own, task=wish.task, most=most, seed=seed))
    shown_ones = result.solutions or ((result.nearest,) if result.nearest else ())
    errors = np.array([[[one.position_error, one.angle_error]] for one in shown_ones]).reshape(-1, 1, 2)
    if wish.task == "position":
        errors[..., 1] = 0.0
    coupled = isinstance(robot, CoupledRobot)
    analysis = analysis_of(robot.free_motion if isinstance(robot, CoupledRobot) else robot, wish.task)
    moves = (robot.drive.S if isinstance(robot, CoupledRobot) else np.eye(robot.n)) != 0.0
    moves[list(analysis.idle)] = False
    idle = tuple(i + 1 for i, moved in zip(places, moves.any(axis=0).tolist(), strict=True) if not moved)
    redundant = analysis.redundancy > 0 and not coupled
    return TipGroup((wish.tip,), tuple(i + 1 for i in places), result, errors, False, idle, redundant)


def _own_places(chain: SerialChain) -> list[int]:
    """The variables (from 0) of a chain in the order of the robot that it is: where each first moves something."""
    first = [int(np.flatnonzero(column)[0]) for column in chain.S.T]
    return [int(chain.variables[k]) for k in sorted(range(len(first)), key=first.__getitem__)]


# Of several, one ----------------------------------------------------------------------------------------------


def _searched(
    tree: Tree, group: Sequence[_TipWish], home: Array, near: Array | None, limits: bool, seed: int
) -> TipGroup:
    """The answer for tips that share variables, in their variables alone."""
    chains = [wish.chain for wish in group]
    variables = driving(chains)
    bounds = tree.limits if limits else np.tile([-np.inf, np.inf], (tree.n, 1))
    following = [coupling.joint for coupling in tree.graph.couplings if not coupling.own]
    tips = driven_tips(chains, [wish.task for wish in group], tree.revolute, bounds, following)
    if not limits:
        tips = replace(tips, rows=tips.rows[:0], offsets=tips.offsets[:0], bounds=tips.bounds[:0])
    T = np.stack([wish.T for wish in group])[None]
    ends = driven_search(tips, T, home[variables], seed)
    own = None if near is None else near[variables]
    counting = tree.limits[variables]
    if own is not None and not limits:  # an angle whose wish is outside the limits is turned next to the wish
        low, high = tolerated(counting)
        counting = np.where(((own < low) | (own > high))[:, None], [-np.inf, np.inf], counting)
    u, _ = within_limits(ends.u, full_turn_joints(tree)[variables], counting, own)
    solution = Solution(
        u[0],
        "",
        bool(within(tree.limits[variables], u[0])) and not np.any(np.abs(tips.over(u)) > ROW_OVER),
        float(ends.place.max()),
        float(ends.angle.max()),
    )
    because = _because(group, variables)
    reached = bool(ends.reached[0])
    result = Result(
        (solution,) if reached else (),
        False,
        SEARCH,
        reason=None if reached else (UNPROVEN if limits else NOT_FOUND),
        nearest=None if reached else solution,
        counts={"listed": int(reached)},
        certificate=f"one found by search, since {because}" if reached else because,
    )
    errors = np.stack([ends.place, ends.angle], axis=-1)
    return TipGroup(tuple(wish.tip for wish in group), tuple((variables + 1).tolist()), result, errors, True)


def full_turn_joints(tree: Tree) -> Flags:
    """(n,) which variables of a tree make no difference when they go on by a full turn."""
    S, _ = tree.graph.value_map
    turns = np.array([tree.graph.joints[number].type == "revolute" for number in tree.graph.moving], dtype=bool)
    whole = np.where(turns[:, None], np.round(S) == S, S == 0.0)
    return np.asarray(tree.revolute & np.all(whole, axis=0))


def _because(group: Sequence[_TipWish], variables: Index) -> str:
    """Why tips are searched for."""
    counts = [sum(int(i) in wish.chain.variables for wish in group) for i in variables]
    shared = [f"q{int(i) + 1}" for i, count in zip(variables, counts, strict=True) if count > 1]
    return f"{_listed_names([wish.tip for wish in group])} share {_listed_names(shared)}"


def _listed_names(names: Sequence[str]) -> str:
    """Some names in a sentence."""
    if len(names) > MOST_NAMED:
        return f"{', '.join(map(shown, names[:MOST_NAMED]))} and {len(names) - MOST_NAMED} more"
    *others, last = map(shown, names)
    return f"{', '.join(others)} and {last}" if others else last


# All of them --------------------------------------------------------------------------------------------------


def _together(
    tree: Tree, wishes: Sequence[_TipWish], groups: Sequence[TipGroup], limits: bool, home: Array
) -> TipAnswer:
    """The answer of all groups, each in configurations in which the others stand at the first one that is given."""
    first = home.copy()
    for group in groups:
        stands = group.result[0] if group.result else group.result.nearest
        if stands is not None:
            first[np.array(group.joints) - 1] = stands.q
    whole = all(group.result.reachable for group in groups)
    moved = {joint for group in groups for joint in group.joints}
    question = TipQuestion(
        tree,
        {wish.tip: wish.T for wish in wishes},
        {wish.tip: wish.task for wish in wishes},
        limits,
        home,
    )
    return TipAnswer(
        tuple(replace(group, result=_of_tree(group, first)) for group in groups),
        first if whole else None,
        tuple(i for i in range(1, tree.n + 1) if i not in moved),
        question,
    )


def _of_tree(group: TipGroup, first: Array) -> Result:
    """The answer of a group, in its joints, as configurations (n,) of the tree with the other joints as in `first`."""
    places, result = np.array(group.joints) - 1, group.result

    def whole(q: Array) -> Array:
        values = np.tile(first, (*q.shape[:-1], 1))
        values[..., places] = q
        return values

    def numbers(joints: Sequence[int]) -> tuple[int, ...]:
        return tuple(sorted(group.joints[i - 1] for i in joints))

    def solution(one: Solution) -> Solution:
        return replace(one, q=whole(one.q), free=numbers(one.free))

    def family(one: Family) -> Family:
        arcs = tuple(Arc(whole(np.atleast_2d(arc.q)), arc.whole, arc.swivel) for arc in one.arcs)
        return replace(one, joints=numbers(one.joints), arcs=arcs)

    return replace(
        result,
        solutions=tuple(map(solution, result.solutions)),
        nearest=None if result.nearest is None else solution(result.nearest),
        families=tuple(map(family, result.families)),
        question=None,
    )
