"""Count and truth side by side: the mobility of a mechanism with the sentence that says why they differ."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.brief import Answer
from robokin.errors import InputError, InputTypeError, did_you_mean
from robokin.expected import described, expect_whole
from robokin.mobility.assembly import Assembly, assembled, missing_geometry, space_fault
from robokin.mobility.count import grubler
from robokin.mobility.nearly import nearly_more
from robokin.mobility.output import Output, kind_of, twist_basis
from robokin.mobility.reasons import reason
from robokin.mobility.roles import idle_freedoms, moving_joints, strained_joints
from robokin.mobility.true_mobility import STILL, TrueMobility, along, motion_of, velocities_of
from robokin.model import Mechanism, expect_mechanism


@dataclass(frozen=True, eq=False, repr=False)
class Mobility(Answer):
    """What is known of a mechanism's freedom.

    count: Grübler's; motion: from geometry, None without. mobility: the greatest dimension of the branches of
    configurations through this one, None without geometry and where it is undecided. verdict: `right`, `exceptional`,
    `singular`, `shaky`, `nearly`, `undecided`, `disconnected` or `counted` (no geometry). nearly: how many more motions
    there would be if the dimensions were exact. branches: each with its dimension and the joints that move in it, and
    `outputs` how the output moves in each, where there are several and an output.
    redundant: constraints that say nothing new, of λ a loop, and `strained` the joints that share them. idle: freedoms
    that do not move the output. dead: joints that never move. outputs: the links asked for. undriven: freedoms that
    are left when the actuated joints are held, `output_undriven` the output's; None without actuated joints.
    missing: joints without geometry; wandering: contacts that were judged by their velocities at this configuration
    alone; note: the sentence, or None.
    """

    mechanism: Mechanism
    count: int
    motion: TrueMobility | None
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
    nearly: int = 0
    branches: tuple[tuple[int, tuple[str, ...]], ...] = ()
    wandering: tuple[str, ...] = ()
    outputs: tuple[Output, ...] = ()

    @property
    def controllable(self) -> int | None:
        """How many of the freedoms the actuated joints command; None where that or the mobility is not known."""
        return None if self.mobility is None or self.undriven is None else self.mobility - self.undriven

    @property
    def holonomic(self) -> bool | None:
        """Whether the actuated joints command all freedoms; None where that is not known."""
        return None if self.controllable is None else self.controllable == self.mobility

    def __repr__(self) -> str:
        """A line: the count beside the mobility, and the verdict."""
        name, known = self.mechanism.id or self.mechanism.name, "not known" if self.mobility is None else self.mobility
        return f"<mobility of {name}: {known}, Grübler's count {self.count}: {self.verdict}>"


def mobility_of(mechanism: Mechanism, between: tuple[str, str] | None = None, seed: int = 0) -> Mobility:
    """The mobility of a mechanism, counted and true; `between` two links (the moving one first) or its output.

    `seed` has no influence on the answer. Raises InputError for links that are not the mechanism's, and for axes
    that do not fit the mechanism's space.
    Source: M. Grübler, Getriebelehre, 1917 (the count); C. W. Wampler, J. D. Hauenstein, A. J. Sommese, Mechanism
    mobility and a local dimension test, Mech. Mach. Theory 46(9), 2011 (the mobility of the geometry).
    """
    mechanism, _ = expect_mechanism(mechanism), expect_whole(seed, "seed", 0)
    fault = space_fault(mechanism)
    if fault:
        raise InputError(fault)
    pair = _between(mechanism, between)
    count = grubler(mechanism.order, len(mechanism.links), (joint.freedoms for joint in mechanism.graph.joints))
    missing = missing_geometry(mechanism)
    parts = mechanism.graph.parts
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
    wandering = frozenset(i for i, e in enumerate(assembly.linkage.elements) if e.name in assembly.wandering)
    motion = motion_of(assembly.linkage, mechanism.order, wandering)
    return _judged(mechanism, count, assembly, motion, pair, driven)


def _loose(mechanism: Mechanism, parts: tuple[tuple[str, ...], ...]) -> str:
    """What hangs on nothing, in words."""
    if len(parts[0]) == 1:
        return f"no joint holds the mechanism to its ground, {mechanism.ground}"
    floating = [", ".join(part[:6]) + (", …" if len(part) > 6 else "") for part in parts[1:]]
    links = sum(len(part) for part in parts[1:])
    return (
        f"no joint leads from the ground to {' and to '.join(floating[:4])} ({links} of {len(mechanism.links)} links)"
    )


def _judged(
    mechanism: Mechanism,
    count: int,
    assembly: Assembly,
    motion: TrueMobility,
    pair: tuple[str, str] | None,
    driven: int,
) -> Mobility:
    linkage, T = assembly.linkage, motion.tangent
    nearly = sum(nearly_more(assembly, part) for part in motion.parts)
    verdict = _verdict(count, motion, nearly)
    branches = tuple((course.dimension, moving_joints(assembly, course.moving)) for course in motion.courses)
    outputs = _outputs(assembly, motion, pair) if pair is not None and motion.count > 1 else ()
    if motion.undecided is not None:
        note = reason(mechanism, count, motion, verdict, (), nearly)
        return Mobility(
            mechanism, count, motion, assembly, None, verdict, None, (), None, (), None, driven, None, None, (), note,
            nearly, branches, assembly.wandering,
        )  # fmt: skip
    moving = {name for _, names in branches for name in names}
    dead = tuple(joint.name for joint in mechanism.joints if joint.name not in moving and joint.freedoms)
    bodies = linkage.body_twists(motion.state, T)
    output = idle = undriven = output_undriven = here = None
    if pair is not None:
        output = outputs[0] if outputs else _output(assembly, bodies, pair)
        idle = motion.finite - output.freedoms
        here = _output_here(assembly, motion, pair)
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
    strained = strained_joints(assembly, motion) if motion.redundant else ()
    note = reason(mechanism, count, motion, verdict, strained, nearly)
    if output is not None and here is not None and here < output.freedoms:
        lost = f"singular pose: {output.link} has {here} freedoms here, {output.freedoms} away from it"
        verdict, note = "singular" if verdict == "right" else verdict, lost if note is None else f"{note}; {lost}"
    return Mobility(
        mechanism, count, motion, assembly, motion.finite, verdict, motion.redundant, strained, idle, dead, output,
        driven, undriven, output_undriven, (), note, nearly, branches, assembly.wandering, outputs,
    )  # fmt: skip


def _output(assembly: Assembly, bodies: Array, pair: tuple[str, str]) -> Output:
    """How one link moves against another where the bodies have twists (n, 6, d)."""
    basis = twist_basis(bodies[assembly.link(pair[0])] - bodies[assembly.link(pair[1])])
    return Output(*pair, basis.shape[1], kind_of(basis))


def _outputs(assembly: Assembly, motion: TrueMobility, pair: tuple[str, str]) -> tuple[Output, ...]:
    """How one link moves against another in each branch."""
    found = []
    for course in motion.courses:
        state, T = along(assembly.linkage, motion.parts, course.branches)
        found.append(_output(assembly, assembly.linkage.body_twists(state, T), pair))
    return tuple(found)


def _output_here(assembly: Assembly, motion: TrueMobility, pair: tuple[str, str]) -> int:
    """The output's freedoms at the given configuration."""
    linkage = assembly.linkage
    bodies = linkage.body_twists(linkage.reference, velocities_of(linkage, motion))
    return int(twist_basis(bodies[assembly.link(pair[0])] - bodies[assembly.link(pair[1])]).shape[1])


def _between(mechanism: Mechanism, between: tuple[str, str] | None) -> tuple[str, str] | None:
    """The link whose motion is asked for and the one that it is measured against."""
    if between is None:
        return (mechanism.output, mechanism.ground) if mechanism.output else None
    if not isinstance(between, tuple | list) or len(between) != 2 or not all(isinstance(name, str) for name in between):
        raise InputTypeError(f"between: found {described(between)}, expected two links, such as {mechanism.links[:2]}")
    for name in between:
        if name not in mechanism.links:
            hint = did_you_mean(name, mechanism.links) or f", expected one of {', '.join(mechanism.links[:12])}"
            raise InputError(f"between: found the unknown link '{name}'{hint}")
    if between[0] == between[1]:
        raise InputError(f"between: found the link '{between[0]}' twice, expected two different links")
    return between


def _verdict(count: int, motion: TrueMobility, nearly: int) -> str:
    if motion.undecided is not None:
        return "undecided"
    if nearly:
        return "nearly"
    if motion.count > 1:
        return "singular"
    if motion.finite < motion.generic:
        return "shaky"
    if motion.instantaneous > motion.generic:
        return "singular"
    # A count below 0 says that nothing moves, and by how many constraints more than it takes.
    return "right" if motion.finite == max(count, 0) else "exceptional"
