"""Plain calls, answered by the native kernel at once: robot and joint values are looked at there.

A call of one configuration takes less time than Python needs to look at its arguments. So the kernel does that: it
knows a robot by the chain that its facts hold, and takes an array of floats, or a list of them, with a value for each
joint. It gives None for all else, and for many configurations: then the arguments are checked in Python, which has the
words for what is wrong.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from robokin.kernel.chain import chain_of
from robokin.kernel.facts import facts_of
from robokin.kernel.native_kernel import handle, native
from robokin.kinematics.code_at_once import jacobian_by_code, pose_by_code
from robokin.model import Robot

NAME = "chain at once"
"""What the kernel calls the fact, which no function has found (see `fact`)."""

ALONE = 1
"""The number of cores of a plain call; who gives another object may mean the same, and is asked in Python."""


pose_at_once: Callable[[Robot, Any], Any] = pose_by_code if native is None else native.pose_at_once
"""The poses of the tool (..., 4, 4) at q (..., n), or None."""

jacobian_at_once: Callable[[Robot, Any], Any] = jacobian_by_code if native is None else native.jacobian_at_once
"""The Jacobians (..., 6, n) in the axes of the base, or None."""


def keep_at_once(robot: Robot) -> None:
    """Let the kernel know a robot whose joints move one by one from now on."""
    if native is not None and type(robot) is Robot and NAME not in facts_of(robot):
        known = handle(chain_of(robot))
        if known is not None:
            facts_of(robot)[NAME] = known
