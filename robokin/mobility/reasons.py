"""The sentence that says why a count and the truth differ."""

from __future__ import annotations

from robokin.mobility.true_mobility import TrueMobility
from robokin.model import Mechanism

SPACES = {"planar": "in the plane", "spherical": "on the sphere", "spatial": "in space"}


def reason(
    mechanism: Mechanism, count: int, motion: TrueMobility, verdict: str, strained: tuple[str, ...], nearly: int
) -> str | None:
    """Why count and truth differ, or what else is special; None where there is nothing to say."""
    true = motion.finite
    if verdict == "right":
        if count < 0:
            return f"rigid, as a count below 0 says: {-count} constraint{_s(-count)} more than it takes"
        return None
    if verdict == "undecided":
        return (
            f"undecided: {motion.undecided}; of {motion.instantaneous} instantaneous "
            f"freedom{_s(motion.instantaneous)} {_between(motion.finite, motion.most)}"
        )
    if verdict == "nearly":
        size = motion.values[motion.rank - nearly]
        would = motion.instantaneous + nearly
        return (
            f"would have {would} freedom{_s(would)} if its dimensions were exact: they miss by about {size:.1g} of its "
            "size; give them as expressions, or with more digits"
        )
    if verdict == "shaky":
        return _trembles(motion)
    here = _here(motion)
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


def _between(least: int, most: int) -> str:
    """How many freedoms are a motion, as far as it is known."""
    if least == most:
        return f"{least} {'is' if least == 1 else 'are'} known to be a motion, but not all branches are known"
    return f"at least {least} and at most {most} {'is a motion' if most == 1 else 'are motions'}"


def _trembles(motion: TrueMobility) -> str:
    """What only trembles, and which order of the constraints forbids it."""
    true = motion.finite
    infinitesimal = f"{motion.generic} infinitesimal motion{_s(motion.generic)}"
    forbids = "that no constraint forbids at first sight"
    end = "" if motion.order in (None, 2) else f": constraints of order {motion.order} forbid it"
    if not true:
        lead = "leads" if motion.generic == 1 else "lead"
        return f"shaky: {infinitesimal} {forbids} {lead} nowhere, it is only a tremble{end}"
    lead = "leads" if true == 1 else "lead"
    return f"shaky: of {infinitesimal} {forbids} only {true} {lead} somewhere, the rest is a tremble{end}"


def _here(motion: TrueMobility) -> str:
    """What is special of the pose; "" where nothing is."""
    here = ""
    if motion.instantaneous > motion.generic or motion.count > 1:
        here = f"singular pose: {motion.instantaneous} instantaneous freedoms here, {motion.generic} away from it"
    if motion.count > 1:
        sizes = [course.dimension for course in motion.courses]
        if len(set(sizes)) == 1:
            of = f"{sizes[0]} freedom{_s(sizes[0])} each"
        else:
            of = ", ".join(str(size) for size in sizes[:8]) + (", …" if motion.count > 8 else "") + " freedoms"
        here += f"; {motion.count} branches of configurations meet in it, of {of}"
    if motion.finite < motion.generic:
        here += f"; of {motion.generic} infinitesimal motions along the greatest only {motion.finite} "
        here += f"{'leads' if motion.finite == 1 else 'lead'} somewhere"
    return here


def _s(count: int) -> str:
    return "" if count == 1 else "s"


def _listed(names: tuple[str, ...]) -> str:
    shown = ", ".join(names[:8]) + (", …" if len(names) > 8 else "")
    return f"joint{_s(len(names))} {shown}"
