"""Which link stands still, and whether that looks like a slip: the first link is the ground unless a file names one."""

from __future__ import annotations

import re

from robokin.model import Mechanism

GROUNDS = {
    "ground", "base", "frame", "fixed", "world", "chassis", "housing", "earth", "floor", "wall", "bed", "stand",
    "gestell", "rahmen",
}  # fmt: skip
"""Words that name what stands still."""

MOVERS = {
    "crank", "coupler", "rocker", "rod", "conrod", "slider", "piston", "planet", "pinion", "follower", "crosshead",
    "wheel", "cam", "worm", "sun", "pulley", "cage",
}  # fmt: skip
"""Words that name what moves, in almost all mechanisms that have it."""


def ground_doubt(mechanism: Mechanism) -> str | None:
    """Why the ground is perhaps not meant, in words, or None. A file that names its ground is never doubted."""
    if mechanism.ground_named:
        return None
    ground, links = mechanism.ground, mechanism.links
    first = f"{ground} is the ground, since it is the first link"
    others = [link for link in links if link != ground and _words(link) & GROUNDS]
    if others and not _words(ground) & GROUNDS:
        return f"{first}, though {others[0]} looks like it: `ground: {others[0]}` would say so"
    if _words(ground) & MOVERS and not _words(ground) & GROUNDS:
        return f"{first}, though its name is that of a link that moves: `ground: NAME` would name another"
    carrier = _carrier_of_drives(mechanism)
    if carrier is not None:
        here = sum(joint.actuated and ground in joint.links for joint in mechanism.joints)
        where = f"all drives are at {carrier} and {'none' if not here else f'only {here} of them'} at {ground}"
        return f"{first}, though {where}: `ground: NAME` would name another"
    return None


def _words(name: str) -> set[str]:
    return set(re.findall(r"[^\W\d_]+", name.casefold()))


def _carrier_of_drives(mechanism: Mechanism) -> str | None:
    """The link at which all driven hinges are, if not all of them are at the ground and that has two joints only.

    Driven slides stand between links that move in every hexapod and excavator: they say nothing about the ground.
    """
    driven = [joint for joint in mechanism.joints if joint.actuated]
    at_ground = [joint for joint in mechanism.joints if mechanism.ground in joint.links]
    if not driven or len(at_ground) > 2 or any(joint.type != "revolute" for joint in driven):
        return None
    if all(mechanism.ground in joint.links for joint in driven):
        return None
    shared = [link for link in mechanism.links if all(link in joint.links for joint in driven)]
    # Of a drive's two links the one with more joints carries it; where both have two, either may.
    count = {link: sum(link in joint.links for joint in mechanism.joints) for link in shared}
    return max(shared, key=lambda link: count[link]) if shared else None
