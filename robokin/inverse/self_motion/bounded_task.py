"""What a redundant arm is asked for within its limits, and Newton's way back to it.

Statement. For an arm with more joints than its task needs bring configurations near those that fulfil the task onto
these, and give the null spaces there.
Derivation. The chain is the arm's without idle joints, with the joints that the task leaves open after them. Newton's
steps are the shortest ones, by the singular values of the Jacobian. What the task leaves open turns freely: the target
is turned to where a configuration has its open joints at zero.
Degenerate case. Singular values that are zero take no part in a step, and their directions belong to the null space.

Here x are joint values [rad | size] and lengths are in the arm's size.
"""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array, Flags, Index
from robokin.inverse.analysis import Analysis
from robokin.inverse.self_motion.pose_correction import CLOSES, SETTLED, errors, scale_of
from robokin.inverse.verify import Found, wrapped
from robokin.kernel.frames import pose
from robokin.kernel.ranks import TASK_RANK
from robokin.kernel.residual import distance_and_angle
from robokin.model.robot import LIMIT_TOLERANCE
from robokin.spatial import nearest_rotation

NEWTON_STEPS = 6
"""Newton's steps of a correction at most: the error is squared each time, from 1e-2."""


class BoundedTask:
    """Targets of an arm, its chain without idle joints, and its limits.

    T: (m, 4, 4) [m]; limits: (n, 2) [rad | m] of all the arm's joints; rest: (n,) where the idle ones are.
    """

    def __init__(self, analysis: Analysis, T: Array, limits: Array, rest: Array) -> None:
        self.analysis, self.chain, self.size = analysis, analysis.solved, analysis.size
        self.T, self.limits, self.rest = T, limits, rest
        self.moving = analysis.moving
        self.scale = scale_of(self.chain, self.size)
        free = np.tile([-np.inf, np.inf], (analysis.open, 1))
        self.low, self.high = (np.concatenate([limits[self.moving], free]) / self.scale[:, None]).T
        self.tolerance = LIMIT_TOLERANCE / self.scale

    def unlimited(self) -> BoundedTask:
        """The same without limits."""
        return BoundedTask(self.analysis, self.T, np.tile([-np.inf, np.inf], (len(self.rest), 1)), self.rest)

    def turned(self, x: Array) -> Array:
        """Points x (s, n) with each angle turned nearest to the middle of its limits, and put within these."""
        both = self.chain.revolute & np.isfinite(self.low) & np.isfinite(self.high)
        middle = np.where(both, 0.5 * (np.where(both, self.low, 0.0) + np.where(both, self.high, 0.0)), 0.0)
        return np.asarray(np.where(both, middle + wrapped(x - middle, self.chain.revolute), x))

    def margin(self, x: Array) -> Array:
        """(s,) the least distance of a joint from its limits at points x (s, n), negative outside."""
        return np.asarray(np.min(np.minimum(x - self.low, self.high - x), axis=1))

    def points(self, found: Found) -> Array:
        """Solutions as points x (s, n), the open joints at zero."""
        q = np.concatenate([found.q[:, self.moving], np.zeros((len(found), self.analysis.open))], axis=1)
        return np.asarray(q / self.scale)

    def targets(self, index: Index, x: Array) -> Array:
        """The targets (s, 4, 4) of points x (s, n), turned in what the task leaves open to where x is."""
        T = self.T[index].copy()
        if not self.analysis.open:
            return T
        R = pose(self.chain, x * self.scale)[:, :3, :3]
        if self.analysis.open == 1:
            # The z axis is the task's; x stays as near to where it is as that allows.
            z = T[:, :3, 2]
            first = R[:, :, 0] - np.sum(R[:, :, 0] * z, axis=1, keepdims=True) * z
            first /= np.linalg.norm(first, axis=1, keepdims=True)
            R = np.stack([first, np.cross(z, first), z], axis=2)
        T[:, :3, :3] = nearest_rotation(R)
        return T

    def inside(self, x: Array) -> Flags:
        """(s,) which points are within the limits."""
        return np.asarray(np.all((x >= self.low - self.tolerance) & (x <= self.high + self.tolerance), axis=1))

    def found(self, index: Index, x: Array, error: Array) -> Found:
        """Those points x (s, n) that close as configurations of the arm, given their errors (s, 6)."""
        own = len(self.moving)
        q = np.tile(self.rest, (len(x), 1))
        q[:, self.moving] = (x * self.scale)[:, :own]
        position, angle = distance_and_angle(error)
        closes = (np.max(np.abs(error), axis=1, initial=0.0) <= CLOSES) & self.inside(x)
        return Found(index, q, position * self.size, angle).pick(closes)

    def corrected(self, T: Array, x: Array) -> tuple[Array, Array, Array]:
        """Points near x (s, n) at targets T (s, 4, 4), their errors (s, 6) and projections (s, n, n) on null spaces.

        Undamped, and ended where a step gains nothing: the null space is that of the last step that did.
        """
        x, error = x.copy(), np.full((len(x), 6), np.inf)
        project = np.zeros((*x.shape, x.shape[1]))
        rows = np.arange(len(x))
        new = x
        for step in range(NEWTON_STEPS + 1):
            e, J = errors(self.chain, T[rows], new, self.size)
            U, values, Vt = np.linalg.svd(J, full_matrices=False)
            null = values <= TASK_RANK
            null[:, self.analysis.window.dimension :] = True
            rank = ~null
            better = np.max(np.abs(e), axis=1) < np.max(np.abs(error[rows]), axis=1)
            some = rows[better]
            x[some], error[some] = new[better], e[better]
            range_ = Vt[better] * rank[better, :, None]
            project[some] = np.eye(x.shape[1]) - np.swapaxes(range_, 1, 2) @ range_
            on = better & (np.max(np.abs(e), axis=1) > SETTLED)
            if step == NEWTON_STEPS or not on.any():
                break
            along = np.einsum("sij,si->sj", U[on], e[on]) * rank[on] / np.where(null[on], 1.0, values[on])
            rows, new = rows[on], new[on] + np.einsum("sji,sj->si", Vt[on], along)
        return x, error, project
