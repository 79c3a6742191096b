"""Arms with a spherical shoulder and wrist as the native kernel knows them.

The kernel gives for a pose the pieces of its self-motions within the joint limits (`swivel_pieces`) and the solutions
that are listed of them (`swivel_members`, `spread`), by the same steps. Where one of these doubts it gives nothing.
"""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array
from robokin.inverse.self_motion.swivel_arm import SwivelArm
from robokin.inverse.self_motion.swivel_curves import plain_arm
from robokin.inverse.self_motion.swivel_members import COUNTS
from robokin.inverse.self_motion.swivel_pieces import SwivelBounds
from robokin.inverse.self_motion.swivel_turns import TRIPLES
from robokin.kernel.native_kernel import handle, native
from robokin.model.robot import tolerated

MOST_LISTED = COUNTS[0] // 2
"""Solutions of a pose that are asked for at most: for more, configurations are put between those of the first count."""


def native_swivel(arm: SwivelArm, limits: Array, rest: Array) -> object | None:
    """What the native kernel knows an arm by, for limits (7, 2) and resting values (7,) [rad]; None without it."""
    chain = handle(arm.chain)
    if native is None or chain is None:
        return None
    triples, bounds = arm.triples, SwivelBounds(arm, limits)
    numbers = [
        [arm.size], *vars(plain_arm(arm)).values(), triples.k, triples.r, triples.cos_phi, triples.sin_phi, triples.u,
        triples.v,
    ]  # fmt: skip
    table = np.zeros((7, 6))
    for column, number in enumerate((bounds.middle, bounds.half, bounds.stops)):
        table[TRIPLES, column] = number[:, 0, 0, :, 0, 0].T
    table[3, :2] = bounds.elbow
    table[:, 3], table[:, 4] = tolerated(limits)
    table[:, 5] = rest
    made: object = native.swivel(
        chain,
        np.concatenate([np.ravel(part) for part in numbers]).astype(np.float64),
        table,
        np.concatenate([bounds.matrix, bounds.value.reshape(-1, 1)], axis=1),
    )
    return made
