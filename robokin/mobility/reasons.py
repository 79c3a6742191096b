"""The sentence that says why a count and the truth differ."""

from __future__ import annotations

from robokin.mobility.mobility import NEARLY, Motion
from robokin.model import Mechanism

APART = 30.0
"""Singular values of a geometry that is not quite exact stand apart from the others by more than this factor."""

SPACES = {"planar": "in the plane", "spherical": "on the sphere", "spatial": "in space"}


def nearly_more(motion: Motion) -> int:
    """How many more motions there would be if the geometry were exact: singular values small and apart."""
    if not motion.nearly:
        return 0
    counted = motion.values[: motion.rank]
    regular = counted[counted >= NEARLY]
    small = counted[counted < NEARLY]
    if len(regular) and regular[-1] < APART * small[0]:
        return 0
    return len(small)


def reason(mechanism: Mechanism, count: int, motion: Motion, verdict: str, strained: tuple[str, ...]) -> str | None:
    """Why count and truth differ, or what else is special; None where there is nothing to say."""
    true = motion.finite
    if verdict == "right":
        if count < 0:
            return f"rigid, as a count below 0 says: {-count} constraint{_s(-count)} more than it takes"
        return None
    if verdict == "nearly":
        more = nearly_more(motion)
        size = motion.values[motion.rank - more]
        would = motion.instantaneous + more
        return (
            f"would have {would} freedom{_s(would)} if its dimensions were exact: they miss by about {size:.1g} of its "
            "size; give them as expressions, or with more digits"
        )
    if verdict == "shaky":
        infinitesimal = f"{motion.generic} infinitesimal motion{_s(motion.generic)}"
        forbids = "that no constraint forbids at first sight"
        if not true:
            lead = "leads" if motion.generic == 1 else "lead"
            return f"shaky: {infinitesimal} {forbids} {lead} nowhere, it is only a tremble"
        lead = "leads" if true == 1 else "lead"
        return f"shaky: of {infinitesimal} {forbids} only {true} {lead} somewhere, the rest is a tremble"
    here = ""
    if motion.instantaneous > motion.generic:
        here = f"singular pose: {motion.instantaneous} instantaneous freedoms here, {motion.generic} away from it"
    if true == count:
        return here or None
    where = f" (shared by {_listed(strained)})" if strained else ""
    if true > count:
        are = "is" if motion.redundant == 1 else "are"
        why = (
            f"special dimensions: {motion.redundant} of the constraints {SPACES[mechanism.space]} {are} redundant"
            f"{where}, so it moves with {true} freedom{_s(true)} where the count says {count}"
        )
    else:
        why = f"the count promises {count}, but {true} freedom{_s(true)} remain{_s(2 if true == 1 else 1)}{where}"
    return f"{here}; {why}" if here else why


def _s(count: int) -> str:
    return "" if count == 1 else "s"


def _listed(names: tuple[str, ...]) -> str:
    shown = ", ".join(names[:8]) + (", …" if len(names) > 8 else "")
    return f"joint{_s(len(names))} {shown}"
