"""A mechanism in motion: assembled configurations along a curve of them.

From the given configuration the mechanism goes on in the direction that it came from, projected on what the loops
allow, by small steps that are closed again; so it passes dead points, where a driven joint turns back, and singular
poses without a change of branch. It ends where it began, if the curve is closed, or when a joint has gone far.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from robokin.errors import InputError, did_you_mean, shown
from robokin.mobility.assembly import Assembly, assembled, parts_of
from robokin.mobility.linkage import Linkage, State
from robokin.mobility.mobility import ASSEMBLED, kernel_at
from robokin.mobility.screws import logarithm
from robokin.model import Mechanism

Array = NDArray[np.float64]

CONTACTS = ("gear", "cam", "rolling")
"""Joints at a point that wanders on both links."""

PACE = 0.04
"""Greatest joint motion of a step [rad | size]: some 160 to a turn."""

FARTHEST = 8.0 * np.pi
"""Where a joint that has gone as far [rad | size] without the mechanism coming back ends the curve: a crank that
must turn twice for the rest to repeat has done so."""

STOPS = 1e-3
"""A step of the joint that leads [rad | size] below which it stops or turns back there: a fortieth of a pace."""

SINGULAR_PART = 1e-9
"""A direction whose part in the kernel is less leads nowhere."""


@dataclass(frozen=True, eq=False)
class Trace:
    """Configurations along a motion.

    labels: a name for each freedom; values: (m, f) joint values from the given configuration [rad | m]; turning: (f,)
    whether each is an angle; links: names; poses: (m, links, 4, 4) displacements of the links [m]; closed: whether the
    motion comes back to where it began; driven: the joint that leads.
    """

    mechanism: Mechanism
    labels: tuple[str, ...]
    values: Array
    turning: NDArray[np.bool_]
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
    linkage = assembly.linkage
    leader, held = _roles(assembly, drive)
    direction = _beginning(assembly, leader, held)
    states, totals, closed = _follow(linkage, direction, held)
    if len(states) == 1:
        raise InputError(f"{mechanism.name} only trembles where it stands, expected a mechanism that moves")
    lead = _lead(assembly, leader, totals)
    if lead is None:
        picked, values = _evenly(linkage, states, totals, count, held, closed)
    else:
        picked, values = _by_leader(linkage, states, totals, count, held, closed, lead)
    names = [joint.name for joint in mechanism.joints]
    labels = _labels(assembly, names)
    values = _whole_rotations(assembly, picked, values)
    turning = np.linalg.norm(linkage.screws[:, 3:], axis=1) > 0.5
    values = np.where(turning, values, values * assembly.size)
    poses = assembly.placed(np.stack([state.bodies[: len(mechanism.links)] for state in picked]))
    return Trace(mechanism, labels, values, turning, poses, closed, names[leader])


def _check_whole(mechanism: Mechanism) -> None:
    """Raise InputError for what cannot be followed from its geometry."""
    contacts = [joint.name for joint in mechanism.joints if joint.type in CONTACTS]
    if contacts:
        raise InputError(
            f"{mechanism.name} has contacts (joint {', '.join(contacts[:6])}), whose points wander as the description "
            "does not say, expected hinges and slides only"
        )
    parts = parts_of(mechanism)
    if len(parts) > 1:
        raise InputError(f"no joint leads from the ground to {parts[1][0]}, expected a mechanism of one piece")


def _roles(assembly: Assembly, drive: str | None) -> tuple[int, NDArray[np.bool_]]:
    """The number of the joint that leads, and (f,) which freedoms are held."""
    joints = assembly.mechanism.joints
    names = [joint.name for joint in joints]
    if drive is not None and drive not in names:
        hint = did_you_mean(drive, names) or f", expected one of {', '.join(names[:12])}"
        raise InputError(f"found the unknown joint '{shown(drive)}'{hint}")
    actuated = [i for i, joint in enumerate(joints) if joint.actuated]
    moving = [i for i, joint in enumerate(joints) if joint.freedoms]
    if not moving:
        raise InputError(f"{assembly.mechanism.name} has no joint that can move, expected one to follow")
    leader = names.index(drive) if drive is not None else (actuated or moving)[0]
    if leader not in actuated:
        actuated = actuated[1:]  # the joint that leads takes the place of a drive
    held = np.isin(assembly.own, [i for i in actuated if i != leader])
    return leader, held


def _beginning(assembly: Assembly, leader: int, held: NDArray[np.bool_]) -> Array:
    """The direction (f,) in which the leader goes on most of all, the rest as little as may be."""
    linkage = assembly.linkage
    kernel = _allowed(linkage, linkage.reference, held)
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


def _allowed(linkage: Linkage, state: State, held: NDArray[np.bool_]) -> Array:
    """The kernel (f, k) of the loops with some joints held."""
    if not held.any():
        return kernel_at(linkage, state)[1]
    kernel = kernel_at(linkage, state)[1]
    _, values, Vt = np.linalg.svd(kernel[held])
    return np.asarray(kernel @ Vt[int(np.sum(values > 1e-8)) :].T)


def _follow(linkage: Linkage, direction: Array, held: NDArray[np.bool_]) -> tuple[list[State], list[Array], bool]:
    """States along the curve, the joints' totals (f,) there, and whether it comes back to its beginning."""
    state, total = linkage.reference, np.zeros(linkage.freedoms)
    states, totals = [state], [total]
    away = False
    while np.max(np.abs(total)) < FARTHEST:
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


def _meets(linkage: Linkage, state: State, direction: Array) -> bool:
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
    linkage: Linkage, state: State, direction: Array, pace: float, held: NDArray[np.bool_]
) -> tuple[State, Array] | None:
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
    linkage: Linkage, states: list[State], totals: list[Array], count: int, held: NDArray[np.bool_], closed: bool
) -> tuple[list[State], Array]:
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
    states: list[State],
    totals: list[Array],
    count: int,
    held: NDArray[np.bool_],
    closed: bool,
    lead: int,
) -> tuple[list[State], Array]:
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


def _labels(assembly: Assembly, names: list[str]) -> tuple[str, ...]:
    """A name for each freedom: the joint's, with a number where it has several."""
    labels = []
    for number, name in enumerate(names):
        count = int(np.sum(assembly.own == number))
        labels += [name] if count == 1 else [f"{name}.{k + 1}" for k in range(count)]
    return tuple(labels)


def _whole_rotations(assembly: Assembly, states: list[State], values: Array) -> Array:
    """The values with those of joints that turn about a point or move in a plane read off their displacements.

    Turns about different axes do not add: such a joint's values are the parts of its displacement's logarithm.
    """
    linkage = assembly.linkage
    for j, element in enumerate(linkage.elements):
        if len(element.screws) < 3:
            continue
        logs = logarithm(np.stack([state.joints[j] for state in states]))
        parts = np.linalg.lstsq(element.screws.T, logs.T, rcond=None)[0]
        values[:, linkage.joint == j] = parts.T
    return values
