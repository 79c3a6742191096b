"""Redundant arms, counted: answered poses, as many solutions as asked for, held joints, intervals of self-motions.

`python -m benchmarks.redundant` takes every library arm of seven joints and more; `--arms panda,gen3`, `--poses 500`,
`--parts answers,most,held,intervals,narrow` and `--seed` choose. 10,000 poses take some minutes an arm.
"""

from __future__ import annotations

import argparse
import time
import zlib
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from inverse import arms, judge, truth

import robokin
from benchmarks import machine
from robokin.inverse.analysis import analysis_of
from robokin.inverse.hold import held_arm
from robokin.inverse.numeric.closing import newton_within
from robokin.inverse.self_motion.arcs import arcs_within
from robokin.inverse.self_motion.solution_sets import families
from robokin.inverse.solve import solve_many
from robokin.inverse.verify import CLOSES, SAME, residuals

SEED = 201
KINDS = ("inside", "one at a limit", "some", "all but one", "all", "all nearly")
SHARES = (0.5, 0.1, 0.1, 0.1, 0.1, 0.1)
"""How many joints of a configuration are at limits; nearly is 1e-12 to 0.1 [rad | size] inside."""

ROUND = (0, 20, -30, 45, 90, -90, 60)
"""Values [°] at which a joint is held."""

LONG = 4.0
"""Pieces within the limits that are longer than `SAME` times this for each solution asked for have room for as many."""


def ends(robot: robokin.Robot) -> tuple[np.ndarray, np.ndarray]:
    """Where values are drawn from (n,): the limits, or a turn or an arm's size."""
    reach = np.where(robot.revolute, np.pi, analysis_of(robot).size)[:, None] * [-1.0, 1.0]
    low, high = np.where(np.isinf(robot.limits), reach, robot.limits).T
    return low, high


def configurations(robot: robokin.Robot, count: int, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Within the limits (count, n), and the kind of each, a number of KINDS."""
    low, high = ends(robot)
    q = rng.uniform(low, high, (count, robot.n))
    side = np.where(rng.random(q.shape) < 0.5, low, high)
    kind = rng.choice(len(KINDS), count, p=SHARES)
    u = rng.random(q.shape)
    first = np.argsort(u, axis=1) == 0
    masks = np.stack([np.zeros_like(first), first, u < 0.5, ~first, first | True, first | True])
    q = np.where(masks[kind, np.arange(count)], side, q)
    inwards = np.sign(0.5 * (low + high) - q) * 10.0 ** rng.uniform(-12.0, -1.0, q.shape)
    inwards *= np.where(robot.revolute, 1.0, analysis_of(robot).size)
    return np.where((kind == len(KINDS) - 1)[:, None], np.clip(q + inwards, low, high), q), kind


def wrong(robot: robokin.Robot, T: np.ndarray, q: np.ndarray) -> int:
    """How many of the solutions q (m, k, n), NaN where there is none, miss their target or the limits."""
    i, k = np.nonzero(~np.isnan(q[:, :, 0]))
    position, angle = residuals(T[i], robokin.forward_kinematics(robot, q[i, k]))
    off = (position > CLOSES * analysis_of(robot).size + 1e-14) | (angle > CLOSES + 1e-14)
    return int(np.sum(off | ~robot.within_limits(q[i, k])))


def answers(robot: robokin.Robot, poses: int, rng: np.random.Generator) -> str:
    """How many poses get no solution."""
    q, kind = configurations(robot, poses, rng)
    T = robokin.forward_kinematics(robot, q)
    missing, bad, start = np.zeros(poses, dtype=bool), 0, time.process_time()
    for a in range(0, poses, 500):
        result = solve_many(robot, T[a : a + 500])
        missing[a : a + 500] = result.count == 0
        bad += wrong(robot, T[a : a + 500], result.q)
    taken = (time.process_time() - start) / poses * 1e3
    which = ", ".join(f"{KINDS[k]} {c}" for k, c in enumerate(np.bincount(kind[missing], minlength=6)) if c)
    return f"{poses} poses, {missing.sum()} unanswered {which}, {bad} wrong solutions, {taken:.2f} ms a pose"


def most(robot: robokin.Robot, poses: int, rng: np.random.Generator) -> str:
    """Whether as many are listed as asked for where pieces within the limits have room for them."""
    q, _ = configurations(robot, poses, rng)
    T = robokin.forward_kinematics(robot, q)
    said = []
    for wanted in (16, 128):
        result = solve_many(robot, T, most=wanted)
        few = np.flatnonzero(result.count < wanted)
        rows = [i for i in few if room(robot, T[i], q[i], result.q[i]) > LONG * wanted * SAME]
        twice = sum(again(robot, x[~np.isnan(x[:, 0])]) for x in result.q)
        said.append(f"of {wanted} fewer in {len(few)}, though there is room in {len(rows)}, listed twice {twice}")
    return f"{poses} poses: {'; '.join(said)}"


def room(robot: robokin.Robot, T: np.ndarray, q: np.ndarray, listed: np.ndarray) -> float:
    """The length [rad | size] of the pieces within the limits that q (n,) and some of the listed (k, n) are on."""
    analysis = analysis_of(robot)
    if analysis.redundancy != 1:
        return np.inf
    seeds = np.concatenate([q[None], listed[~np.isnan(listed[:, 0])][:20]])
    scale = np.where(robot.revolute, 1.0, analysis.size)
    sets = families(analysis.chain, T[None], seeds, analysis.size)
    length = 0.0
    for curve in sets.curves[0]:
        for arc in arcs_within(curve, analysis.chain, T, robot.limits, analysis.size):
            length += float(np.sum(np.max(np.abs(np.diff(arc.q / scale, axis=0)), axis=1)))
    return length


def again(robot: robokin.Robot, x: np.ndarray) -> int:
    """How many pairs of solutions x (k, n) are the same."""
    gap = judge.gaps(robot, x[:, None], x[None]) / np.where(robot.revolute, 1.0, analysis_of(robot).size)
    return int(np.sum(np.triu(np.max(gap, axis=2) < SAME, 1)))


def held(robot: robokin.Robot, poses: int, rng: np.random.Generator) -> str:
    """The laws for each joint held at random, round and limit values, against a search from random guesses."""
    if analysis_of(robot).redundancy != 1:
        return "not one joint to spare"
    low, high = ends(robot)
    broken: dict[str, int] = {}
    complete = 0
    for i in range(poses):
        q, joint = rng.uniform(low, high), i % robot.n
        value = (q[joint], np.radians(rng.choice(ROUND)), low[joint], high[joint])[rng.integers(4)]
        q[joint] = np.clip(value, low[joint], high[joint])
        T = robokin.forward_kinematics(robot, q)
        arm = held_arm(robot, {joint: q[joint]}).part
        answer, part = robokin.solve_ik(robot, T, hold={joint: q[joint]}), robokin.solve_ik(arm, T)
        scale = truth.Scale(arm)
        known, _ = truth.search(arm, scale, T, rng, guesses=60)
        faults = judge.faults(arm, scale, np.delete(q, joint), T, part, known)
        if analysis_of(arm).solver is None or analysis_of(arm).redundancy:
            # Of an elbow that is held, what is left has a self-motion at every pose.
            faults = [fault for fault in faults if fault not in ("lost", "on no family")]
        if (len(answer.solutions), answer.complete) != (len(part.solutions), part.complete):
            faults.append("another answer than the arm with a fixed joint")
        for fault in faults:
            broken[fault] = broken.get(fault, 0) + 1
        complete += answer.complete
    return f"{poses} poses, complete {complete}, laws broken: {broken or 'none'}"


def intervals(robot: robokin.Robot, poses: int, rng: np.random.Generator) -> str:
    """Whether the pieces of self-motions end on limits and hold all members that are known, of single poses."""
    analysis = analysis_of(robot)
    if analysis.redundancy != 1:
        return "not one joint to spare"
    (low, high), scale = ends(robot), truth.Scale(robot)
    q, _ = configurations(robot, poses, rng)
    grid = np.radians(rng.choice(arms.GRIDS, poses))[:, None]
    third = (np.arange(poses) % 3 == 2)[:, None]
    q = np.where(third, np.clip(np.round(q / grid) * grid, low, high), q)
    off = missed = not_on = members = 0
    for x in q:
        T = robokin.forward_kinematics(robot, x)
        arcs = [arc for family in robokin.solve_ik(robot, T).families for arc in family.arcs]
        for arc in arcs:
            missed += wrong(robot, np.broadcast_to(T, (1, 4, 4)), arc.q[None])
            margins = np.min(np.minimum(arc.q - robot.limits[:, 0], robot.limits[:, 1] - arc.q), axis=1)
            off += not arc.whole and bool(np.max(np.abs(margins[[0, -1]])) > 1e-9)
        guesses = rng.uniform(low, high, (60, robot.n))
        many = np.broadcast_to(T, (len(guesses), 4, 4))
        found, error = newton_within(analysis.chain, many, guesses, analysis.size, robot.limits, 60)
        found = np.concatenate([x[None], found[np.max(np.abs(error), axis=1) < 1e-10]])
        on = [any(judge.on_arc(robot, scale, one, arc.q) for arc in arcs) for one in found]
        members, not_on = members + len(found), not_on + on.count(False)
    return f"{poses} poses: ends off a limit {off}, points that miss {missed}, of {members} members on none {not_on}"


def narrow(robot: robokin.Robot, poses: int, rng: np.random.Generator) -> str:
    """How many poses of the arm with limits as narrow as 1e-4 of its own get no solution."""
    low, high = ends(robot)
    missing, of = 0, 0
    for i in range(-(-poses // 6)):
        width = (high - low) * 10.0 ** (rng.uniform(-4.0, 0.0, robot.n) if i % 2 else rng.uniform(-4.0, -0.3))
        middle = rng.uniform(low, high)
        limits = np.stack([np.maximum(middle - width / 2, low), np.minimum(middle + width / 2, high)], axis=1)
        parts = iter(limits.tolist())
        rows = tuple(replace(row, limits=tuple(next(parts))) if row.moves else row for row in robot.rows)
        part = replace(robot, name=f"{robot.name} with narrow limits", rows=rows, poses={})
        q, _ = configurations(part, 6, rng)
        missing += int(np.sum(solve_many(part, robokin.forward_kinematics(part, q)).count == 0))
        of += 6
    return f"{of} poses, {missing} unanswered"


PARTS: dict[str, Callable[[robokin.Robot, int, np.random.Generator], str]] = {
    "answers": answers, "most": most, "held": held, "intervals": intervals, "narrow": narrow,
}  # fmt: skip


def run(names: list[str], poses: dict[str, int], seed: int) -> None:
    """Print the counts for each arm."""
    for name in names:
        robot = robokin.load(name)
        for part, count in poses.items():
            rng = np.random.default_rng([seed, zlib.crc32(f"{name} {part}".encode())])
            print(f"  {name:<14} {part:<10} {PARTS[part](robot, count, rng)}", flush=True)


def counted() -> None:
    """Some of it for some arms, among the other benchmarks."""
    run(["panda", "iiwa14", "gen72", "r1pro-right", "yumi-right"], {"answers": 2_000}, SEED)


DEFAULT = {"answers": 600, "most": 30, "held": 14, "intervals": 6, "narrow": 24}
"""Poses of each part unless `--poses` says how many."""


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.redundant", description=__doc__)
    parser.add_argument("--arms", default="", help="library arms, separated by commas")
    parser.add_argument("--parts", default=",".join(PARTS))
    parser.add_argument("--poses", type=int, default=None)
    parser.add_argument("--seed", type=int, default=SEED)
    asked = parser.parse_args()
    names = asked.arms.split(",") if asked.arms else arms.library_arms(7, 99)
    print(machine.describe())
    run(names, {part: asked.poses or DEFAULT[part] for part in asked.parts.split(",")}, asked.seed)


if __name__ == "__main__":
    main()
