"""A mechanism in motion: assembled configurations along a curve of them.

From the given configuration the mechanism goes on in the direction that it came from, projected on what the loops
allow, by small steps that are closed again; so it passes dead points, where a driven joint turns back, and singular
poses without a change of branch. It ends where it began, if the curve is closed, or when a joint has gone far.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from robokin.arrays import Array, Flags
from robokin.brief import Brief
from robokin.errors import InputError, did_you_mean, shown
from robokin.kernel.ranks import LOOP_RANK
from robokin.mobility.assembly import Assembly, assembled
from robokin.mobility.linkage import Linkage, LinkageState
from robokin.mobility.roles import still_freedoms
from robokin.mobility.trace_columns import labels_of, of_pins, whole_rotations
from robokin.mobility.true_mobility import TrueMobility, beginnings_of, kernel_at, motion_of, velocities_of
from robokin.model import Mechanism

PACE = 0.04
"""Greatest joint motion of a step [rad | size]: some 160 to a turn."""

FARTHEST = 8.0 * np.pi
"""Where a joint that has gone as far [rad | size] without the mechanism coming back ends the curve: a crank that
must turn twice for the rest to repeat has done so."""

FARTHEST_GEARED = 40.0 * np.pi
"""The same where gears or belts couple joints: wheels of 17 and 20 teeth are back after 20 turns of the first."""

STOPS = 1e-3
"""A step of the joint that leads [rad | size] below which it stops or turns back there: a fortieth of a pace."""

ASSEMBLED = 10.0 * LOOP_RANK
"""A state that lacks no more [size, rad] is assembled: a geometry whose errors `LOOP_RANK` takes for none leaves some
times as much at the end of a step; an exact one closes to 1e-15."""

SINGULAR_PART = 1e-9
"""A direction whose part in the kernel is less leads nowhere."""


@dataclass(frozen=True, eq=False, repr=False)
class Trace(Brief):
    """Configurations along a motion.

    labels: a name for each freedom; values: (m, f) joint values from the given configuration [rad | m]; turning: (f,)
    whether each is an angle; links: names; poses: (m, links, 4, 4) displacements of the links [m]; closed: whether the
    motion comes back to where it began; driven: the joint that leads.
    """

    mechanism: Mechanism
    labels: tuple[str, ...]
    values: Array
    turning: Flags
    poses: Array
    closed: bool
    driven: str

    @property
    def links(self) -> tuple[str, ...]:
        """The links' names."""
        return self.mechanism.links


def trace(mechanism: Mechanism, count: int, drive: str | None = None) -> Trace:
    """`count` configurations along the motion from the given one: in even steps of the joint that leads, or where it
    turns back on the way, of the joint that moves most at the time.

    `drive` names the joint that leads, by default the first actuated one; other actuated joints are held, but for the
    first where the leader is none of them and takes its place. Raises InputError when there is no motion, or none of
    that joint, or none that the description tells.
    """
    _check_whole(mechanism)
    assembly = assembled(mechanism)
    if assembly.wandering:
        raise InputError(
            f"{mechanism.name} has contacts (joint {', '.join(assembly.wandering[:6])}), whose points wander as the "
            "description does not say, expected hinges and slides, and gears whose wheels turn on one carrier"
        )
    linkage = assembly.linkage
    leader, held = _roles(assembly, drive)
    motion = _motion(assembly)
    still = still_freedoms(linkage, motion)
    direction = _beginning(assembly, motion, leader, held, still)
    held = held | still
    states, totals, closed = _follow(linkage, direction, held)
    if len(states) == 1:
        raise InputError(f"{mechanism.name} only trembles where it stands, expected a mechanism that moves")
    lead = _lead(assembly, leader, totals)
    if lead is None:
        picked, values = _evenly(linkage, states, totals, count, held, closed)
    else:
        picked, values = _by_leader(linkage, states, totals, count, held, closed, lead)
    names = [joint.name for joint in mechanism.joints]
    labels = labels_of(assembly, names)
    values = of_pins(assembly, whole_rotations(assembly, picked, values))
    turning = np.linalg.norm(linkage.screws[:, 3:], axis=1) > 0.5
    values = np.where(turning, values, values * assembly.size)
    poses = assembly.placed(np.stack([state.bodies[: len(mechanism.links)] for state in picked]))
    return Trace(mechanism, labels, values, turning, poses, closed, names[leader])


def _check_whole(mechanism: Mechanism) -> None:
    """Raise InputError for what is in several pieces."""
    parts = mechanism.graph.parts
    if len(parts) > 1:
        raise InputError(f"no joint leads from the ground to {parts[1][0]}, expected a mechanism of one piece")


def _roles(assembly: Assembly, drive: str | None) -> tuple[int, Flags]:
    """The number of the joint that leads, and (f,) which freedoms are held."""
    joints = assembly.mechanism.joints
    names = [joint.name for joint in joints]
    if drive is not None and drive not in names:
        hint = did_you_mean(drive, names) or f", expected one of {', '.join(names[:12])}"
        raise InputError(f"drive: found the unknown joint '{shown(drive)}'{hint}")
    actuated = [i for i, joint in enumerate(joints) if joint.actuated]
    moving = [i for i, joint in enumerate(joints) if joint.freedoms]
    if not moving:
        raise InputError(f"{assembly.mechanism.name} has no joint that can move, expected one to follow")
    leader = names.index(drive) if drive is not None else (actuated or moving)[0]
    if leader not in actuated:
        actuated = actuated[1:]  # the joint that leads takes the place of a drive
    held = np.isin(assembly.own, [i for i in actuated if i != leader])
    return leader, held


def _motion(assembly: Assembly) -> TrueMobility:
    """What the mechanism can do. Raises InputError where that is nothing, or not known."""
    motion = motion_of(assembly.linkage, assembly.mechanism.order)
    name = assembly.mechanism.name
    if motion.instantaneous and not motion.finite:
        if motion.undecided is not None:
            raise InputError(f"it is undecided whether {name} moves, expected a mechanism that is known to move")
        raise InputError(f"{name} only trembles where it stands, expected a mechanism that moves")
    return motion


def _beginning(assembly: Assembly, motion: TrueMobility, leader: int, held: Flags, still: Flags) -> Array:
    """The direction (f,) in which the leader goes on most of all, the rest as little as may be."""
    linkage = assembly.linkage
    kernel = _held(beginnings_of(linkage, motion) if motion.finite else velocities_of(linkage, motion), held)
    kernel = np.where(still[:, None], 0.0, kernel)
    rows = kernel[assembly.own == leader]
    name = assembly.mechanism.joints[leader].name
    if not kernel.shape[1]:
        raise InputError(f"{assembly.mechanism.name} does not move, expected a mechanism with a mobility of 1 or more")
    if not rows.size or np.linalg.norm(rows) < SINGULAR_PART:
        raise InputError(f"joint {name} does not move, expected one that does: --drive names another")
    # The least motion with a unit of the leader's first freedom that moves.
    row = rows[int(np.argmax(np.linalg.norm(rows, axis=1)))]
    direction = kernel @ (row / (row @ row))
    return np.asarray(direction / np.max(np.abs(direction)))


def _allowed(linkage: Linkage, state: LinkageState, held: Flags) -> Array:
    """The kernel (f, k) of the loops with some joints held."""
    return _held(kernel_at(linkage, state)[1], held)


def _held(kernel: Array, held: Flags) -> Array:
    """An orthonormal basis (f, k) of the velocities that leave some joints where they are."""
    kernel = np.linalg.qr(kernel)[0] if kernel.shape[1] else kernel
    if not held.any():
        return kernel
    _, values, Vt = np.linalg.svd(kernel[held])
    return np.asarray(kernel @ Vt[int(np.sum(values > 1e-8)) :].T)


def _follow(linkage: Linkage, direction: Array, held: Flags) -> tuple[list[LinkageState], list[Array], bool]:
    """States along the curve, the joints' totals (f,) there, and whether it comes back to its beginning."""
    state, total = linkage.reference, np.zeros(linkage.freedoms)
    states, totals = [state], [total]
    away = False
    farthest = FARTHEST_GEARED if len(linkage.rows) else FARTHEST
    while np.max(np.abs(total)) < farthest + PACE:
        after = _onward(linkage, state, direction, PACE, held)
        if after is None:
            return states, totals, False
        state, step = after
        total = total + step
        direction = step / np.max(np.abs(step))
        states.append(state)
        totals.append(total)
        distance = np.max(np.abs(state.bodies - linkage.reference.bodies))
        away = away or distance > 4.0 * PACE
        if away and distance <= 1.5 * PACE and _meets(linkage, state, direction):
            return states, totals, True
    return states, totals, False


def _meets(linkage: Linkage, state: LinkageState, direction: Array) -> bool:
    """Whether the beginning lies ahead, within one pace: the last step leads onto it and not past it."""
    after = _onward(linkage, state, direction, PACE, np.zeros(linkage.freedoms, dtype=bool))
    if after is None:
        return False
    here = np.linalg.norm(state.bodies - linkage.reference.bodies)
    there = np.linalg.norm(after[0].bodies - linkage.reference.bodies)
    step = np.linalg.norm(after[0].bodies - state.bodies)
    # On the way past it both ends of the step lie about as far off as the step is long, and no farther.
    return bool(max(here, there) <= 1.05 * step)


def _onward(
    linkage: Linkage, state: LinkageState, direction: Array, pace: float, held: Flags
) -> tuple[LinkageState, Array] | None:
    """The state one pace along the curve and how the joints moved; None where the curve ends."""
    kernel = _allowed(linkage, state, held)
    ahead = kernel @ (kernel.T @ direction)
    size = np.max(np.abs(ahead), initial=0.0)
    if size < SINGULAR_PART:
        return None
    for part in (1.0, 0.5, 0.25, 0.1):
        dq = ahead * (part * pace / size)
        after, back, lacking = linkage.closed(linkage.moved(state, dq), keep=held if held.any() else None)
        step = dq + back
        if lacking <= ASSEMBLED and np.linalg.norm(step - dq) <= 0.5 * np.linalg.norm(dq):
            return after, step
    return None


def _evenly(
    linkage: Linkage, states: list[LinkageState], totals: list[Array], count: int, held: Flags, closed: bool
) -> tuple[list[LinkageState], Array]:
    """`count` states evenly spaced by the greatest joint motion, and the joints' totals (count, f)."""
    along = np.concatenate([[0.0], np.cumsum([np.max(np.abs(b - a)) for a, b in pairwise(totals)])])
    end = along[-1]
    if closed:
        # What is left from the last state to the beginning closes the curve.
        left = np.linalg.norm(states[-1].bodies - states[0].bodies)
        pace = np.linalg.norm(states[-1].bodies - states[-2].bodies)
        end += (along[-1] - along[-2]) * left / pace
    wanted = np.linspace(0.0, end, count, endpoint=not closed)
    picked, values = [], []
    for goal in wanted:
        i = min(int(np.searchsorted(along, goal, side="right")) - 1, len(states) - 1)
        state, total = states[i], totals[i]
        rest = goal - along[i]
        if rest > 1e-12:
            direction = totals[min(i + 1, len(totals) - 1)] - totals[max(min(i, len(totals) - 2), 0)]
            after = _onward(linkage, state, direction, rest, held)
            if after is not None:
                state, total = after[0], total + after[1]
        picked.append(state)
        values.append(total)
    return picked, np.array(values)


def _lead(assembly: Assembly, leader: int, totals: list[Array]) -> int | None:
    """The leader's freedom if it goes on all along the motion, and does not stop or turn back."""
    (own,) = np.nonzero(assembly.own == leader)
    if len(own) != 1:
        return None
    steps = np.diff(np.array(totals)[:, own[0]])
    return int(own[0]) if np.all(steps > STOPS) or np.all(steps < -STOPS) else None


def _by_leader(
    linkage: Linkage,
    states: list[LinkageState],
    totals: list[Array],
    count: int,
    held: Flags,
    closed: bool,
    lead: int,
) -> tuple[list[LinkageState], Array]:
    """`count` states in even steps of the freedom that leads, and the joints' totals (count, f)."""
    along = np.array(totals)[:, lead]
    sign, keep = np.sign(along[-1]), held.copy()
    keep[lead] = True
    end = along[-1]
    if closed:  # whole turns, of which the last step to the beginning is left
        end = sign * 2.0 * np.pi * max(round(abs(end) / (2.0 * np.pi)), 1)
    picked, values = [], []
    for goal in np.linspace(0.0, end, count, endpoint=not closed):
        i = min(int(np.searchsorted(sign * along, sign * goal, side="right")) - 1, len(states) - 1)
        k = min(i, len(states) - 2)
        direction = totals[k + 1] - totals[k]
        dq = direction * ((goal - along[i]) / direction[lead])
        state, back, _ = linkage.closed(linkage.moved(states[i], dq), keep=keep)
        total = totals[i] + dq + back
        picked.append(state)
        values.append(total)
    return picked, np.array(values)
