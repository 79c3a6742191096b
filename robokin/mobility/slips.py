"""What looks like a slip of the pen in a mechanism: links of no length, hinges that lie in one another."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from robokin.mobility.assembly import STRAIGHT, size_of
from robokin.model import Mechanism, MechanismJoint


def slips_of(mechanism: Mechanism) -> tuple[str, ...]:
    """A sentence for each: nothing here is forbidden, but it is seldom what was meant."""
    size = size_of(mechanism)
    found = []
    for a, b in combinations(mechanism.joints, 2):
        shared = [link for link in a.links if link in b.links]
        if not shared or not _coincide(a, b, size):
            continue
        names = f"joints {a.name} and {b.name}"
        if len(shared) > 1:
            found.append(f"{names} both join {' and '.join(shared[:2])} in the same place: one of them does nothing")
        elif len([joint for joint in mechanism.joints if shared[0] in joint.links]) == 2:
            found.append(f"{names} lie in the same place: link {shared[0]} has no length and turns freely")
    return tuple(found)


def _coincide(a: MechanismJoint, b: MechanismJoint, size: float) -> bool:
    """Whether two joints allow the same turns: two hinges on one line, two ball joints in one point."""
    if a.type != b.type or a.type not in ("revolute", "spherical") or a.at is None or b.at is None:
        return False
    apart = (b.at - a.at) / size
    if a.type == "spherical":
        return bool(np.linalg.norm(apart) < STRAIGHT)
    if a.axes is None or b.axes is None:
        return False
    parallel = np.linalg.norm(np.cross(a.axes[0], b.axes[0])) < STRAIGHT
    return bool(parallel and np.linalg.norm(np.cross(apart, a.axes[0])) < STRAIGHT)
