"""Count and truth side by side: the mobility of a mechanism with the sentence that says why they differ."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robokin.errors import InputError, did_you_mean
from robokin.mobility.assembly import Assembly, assembled, missing_geometry, parts_of, space_fault
from robokin.mobility.count import grubler
from robokin.mobility.mobility import Motion, kernel_at, motion_of
from robokin.mobility.output import Output, kind_of, twist_basis
from robokin.mobility.reasons import nearly_more, reason
from robokin.mobility.roles import STILL, idle_freedoms, shares, strained_joints
from robokin.model import Mechanism

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Mobility:
    """What is known of a mechanism's freedom.

    count: Grübler's; motion: from geometry, None without. mobility: the finite one, None without geometry.
    verdict: `right`, `exceptional`, `singular`, `shaky`, `nearly`, `disconnected` or `counted` (no geometry).
    redundant: constraints that say nothing new, of λ a loop, and `strained` the joints that share them. idle: freedoms
    that do not move the output. dead: joints that never move. outputs: the links asked for. undriven: freedoms that
    are left when the actuated joints are held, `output_undriven` the output's; None without actuated joints.
    missing: joints without geometry; note: the sentence, or None.
    """

    mechanism: Mechanism
    count: int
    motion: Motion | None
    assembly: Assembly | None
    mobility: int | None
    verdict: str
    redundant: int | None
    strained: tuple[str, ...]
    idle: int | None
    dead: tuple[str, ...]
    output: Output | None
    actuated: int
    undriven: int | None
    output_undriven: int | None
    missing: tuple[str, ...]
    note: str | None


def mobility_of(mechanism: Mechanism, between: tuple[str, str] | None = None, seed: int = 0) -> Mobility:
    """The mobility of a mechanism, counted and true; `between` two links (the moving one first) or its output.

    Raises InputError for links that are not the mechanism's, and for axes that do not fit the mechanism's space.
    """
    fault = space_fault(mechanism)
    if fault:
        raise InputError(fault)
    pair = _between(mechanism, between)
    freedoms = [joint.freedoms for joint in mechanism.joints for _ in range(joint.multiplicity)]
    count = grubler(mechanism.order, len(mechanism.links), freedoms)
    missing = missing_geometry(mechanism)
    parts = parts_of(mechanism)
    driven = sum(joint.actuated for joint in mechanism.joints)
    if len(parts) > 1:
        note = f"{_loose(mechanism, parts)}: the count adds up parts that move independently"
        return Mobility(
            mechanism, count, None, None, None, "disconnected", None, (), None, (), None, driven, None, None, missing,
            note,
        )  # fmt: skip
    if missing:
        listed = ", ".join(missing[:6]) + (", …" if len(missing) > 6 else "")
        note = f"counted only: no geometry is given for joint{'s' if len(missing) > 1 else ''} {listed}"
        return Mobility(
            mechanism, count, None, None, None, "counted", None, (), None, (), None, driven, None, None, missing, note
        )
    assembly = assembled(mechanism)
    contacts = any(joint.type in ("gear", "cam", "rolling") for joint in mechanism.joints)
    motion = motion_of(assembly.linkage, mechanism.order, seed, velocities_only=contacts)
    return _judged(mechanism, count, assembly, motion, pair, driven)


def _loose(mechanism: Mechanism, parts: list[tuple[str, ...]]) -> str:
    """What hangs on nothing, in words."""
    if len(parts[0]) == 1:
        return f"no joint holds the mechanism to its ground, {mechanism.ground}"
    floating = [", ".join(part[:6]) + (", …" if len(part) > 6 else "") for part in parts[1:]]
    links = sum(len(part) for part in parts[1:])
    return (
        f"no joint leads from the ground to {' and to '.join(floating[:4])} ({links} of {len(mechanism.links)} links)"
    )


def _judged(
    mechanism: Mechanism, count: int, assembly: Assembly, motion: Motion, pair: tuple[str, str] | None, driven: int
) -> Mobility:
    linkage, T = assembly.linkage, motion.tangent
    verdict = _verdict(count, motion)
    moves = shares(assembly, T)
    dead = tuple(
        joint.name for joint, size in zip(mechanism.joints, moves, strict=True) if size < STILL and joint.freedoms
    )
    bodies = linkage.body_twists(motion.state, T)
    output = idle = undriven = output_undriven = here = None
    if pair is not None:
        twists = bodies[assembly.link(pair[0])] - bodies[assembly.link(pair[1])]
        basis = twist_basis(twists)
        output = Output(*pair, basis.shape[1], kind_of(basis))
        idle = motion.finite - basis.shape[1]
        here = _output_here(assembly, pair)
    else:
        idle = idle_freedoms(assembly, motion)
    if driven:
        rows = np.array([mechanism.joints[number].actuated for number in assembly.own], dtype=bool)
        _, values, Vt = np.linalg.svd(T[rows])
        passive = T @ Vt[int(np.sum(values > STILL)) :].T
        undriven = passive.shape[1]
        if pair is not None:
            left = linkage.body_twists(motion.state, passive)
            output_undriven = twist_basis(left[assembly.link(pair[0])] - left[assembly.link(pair[1])]).shape[1]
    strained = strained_joints(assembly, motion.state) if motion.redundant else ()
    note = reason(mechanism, count, motion, verdict, strained)
    if output is not None and here is not None and here < output.freedoms:
        lost = f"singular pose: {output.link} has {here} freedoms here, {output.freedoms} away from it"
        verdict, note = "singular" if verdict == "right" else verdict, lost if note is None else f"{note}; {lost}"
    return Mobility(
        mechanism, count, motion, assembly, motion.finite, verdict, motion.redundant, strained, idle, dead, output,
        driven, undriven, output_undriven, (), note,
    )  # fmt: skip


def _output_here(assembly: Assembly, pair: tuple[str, str]) -> int:
    """The output's freedoms at the given configuration."""
    linkage = assembly.linkage
    bodies = linkage.body_twists(linkage.reference, kernel_at(linkage, linkage.reference)[1])
    return int(twist_basis(bodies[assembly.link(pair[0])] - bodies[assembly.link(pair[1])]).shape[1])


def _between(mechanism: Mechanism, between: tuple[str, str] | None) -> tuple[str, str] | None:
    """The link whose motion is asked for and the one that it is measured against."""
    if between is None:
        return (mechanism.output, mechanism.ground) if mechanism.output else None
    for name in between:
        if name not in mechanism.links:
            hint = did_you_mean(name, mechanism.links) or f", expected one of {', '.join(mechanism.links[:12])}"
            raise InputError(f"found the unknown link '{name}'{hint}")
    if between[0] == between[1]:
        raise InputError(f"found the link '{between[0]}' twice, expected two different links")
    return between


def _verdict(count: int, motion: Motion) -> str:
    if nearly_more(motion):
        return "nearly"
    if motion.finite < motion.generic:
        return "shaky"
    if motion.instantaneous > motion.generic:
        return "singular"
    # A count below 0 says that nothing moves, and by how many constraints more than it takes.
    return "right" if motion.finite == max(count, 0) else "exceptional"
