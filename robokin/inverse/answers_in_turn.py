"""Targets one after the other, each answered by the solution nearest to the answer before it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.inverse.analysis import analysis_of
from robokin.inverse.solutions import BatchResult
from robokin.inverse.solve import solve_many
from robokin.model import Robot

JUMP = math.radians(30.0)
"""A greater move of a turning joint from one target to the next is a jump, where nothing says otherwise."""

PART = 0.1
"""The same of a sliding joint, as a part of the arm's size."""


@dataclass
class Following:
    """Answers targets in their order.

    jump: the greatest move of a turning joint that is none [rad]; last: the answer before (n,) [rad | m], None before
    the first one; jumped: whether the last answer is a jump; jumps: how many were.
    """

    jump: float = JUMP
    last: Array | None = None
    jumped: bool = False
    jumps: int = 0

    def batches(
        self, robot: Robot, blocks: Iterable[Array], arguments: Mapping[str, Any]
    ) -> Iterator[tuple[Array, BatchResult]]:
        """Each target (1, 4, 4) [m] of blocks (m, 4, 4) with its answer.

        The first one's is that nearest to the pose `home`, or where there is none to the joints' zero. After a target
        without a solution the next is answered near to the last answer that there was.
        """
        greatest = np.where(robot.revolute, self.jump, PART * analysis_of(robot).size)
        home = robot.poses.get("home", np.zeros(robot.n))
        for block in blocks:
            for i in range(len(block)):
                T = block[i : i + 1]
                batch = solve_many(
                    robot, T, **{**arguments, "near": home if self.last is None else self.last, "most": 1}
                )
                self.jumped = False
                if batch.count[0]:
                    q = batch.q[0, 0]
                    self.jumped = self.last is not None and bool((np.abs(q - self.last) > greatest).any())
                    self.jumps += self.jumped
                    self.last = q
                yield T, batch
