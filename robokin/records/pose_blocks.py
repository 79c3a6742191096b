"""Poses at many configurations, a block at a time, in the units of whoever asks."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from robokin.arrays import Array, combined
from robokin.errors import InputError
from robokin.kinematics.forward import forward_kinematics, row_frames
from robokin.kinematics.tips import tip_poses
from robokin.model import CoupledRobot, Joint, Robot, Tree
from robokin.model.graph import GraphJoint
from robokin.model.joint_units import in_units, joint_factors
from robokin.model.robot import within
from robokin.number_text import show_range
from robokin.records.pose_records import PoseBlock, poses_in
from robokin.units import Units


class PoseMaker:
    """Turns blocks of configurations into blocks of poses, and counts what is outside the limits."""

    def __init__(self, robot: Robot | Tree, units: Units, frames: bool) -> None:
        """`frames` asks for the frame after every row of the table, too; a tree has the poses of its tips."""
        self.robot, self.units, self.frames = robot, units, frames
        self.factors = joint_factors(robot, units)
        self.count = 0
        self.outside = 0
        self.first_outside = 0

    def of(self, blocks: Iterable[Array]) -> Iterator[PoseBlock]:
        """The poses at blocks of configurations (m, n) in the units. Raises InputError where there is none."""
        for q in blocks:
            si = q * self.factors
            within = self.robot.within_limits(si)
            # What is too large is found below, and said in a sentence.
            with np.errstate(over="ignore", invalid="ignore"):
                T = poses_in(self._poses(si), self.units)
                frames = None
                if self.frames and isinstance(self.robot, Robot):
                    frames = poses_in(row_frames(self.robot, si), self.units)
            for result in (T, frames):
                # Rotations are finite for finite angles; only positions can grow too large.
                if result is not None and not np.isfinite(result[..., :3, 3]).all():
                    finite = np.isfinite(result).reshape(len(q), -1).all(axis=1)
                    number = self.count + int(finite.argmin()) + 1
                    raise InputError(f"configuration {number}: the pose is too far away for a number, expected less")
            yield PoseBlock(self.count + 1, q + 0.0, within, T, frames)
            first = self.count + int(within.argmin()) + 1
            self.add(len(q), len(q) - int(within.sum()), first)

    def _poses(self, q: Array) -> Array:
        """The poses (m, 4, 4), of a tree (m, tips, 4, 4), at q: (m, n) [rad | m]."""
        if isinstance(self.robot, Tree):
            return tip_poses(self.robot, q)
        return forward_kinematics(self.robot, q)

    def add(self, count: int, outside: int, first_outside: int) -> None:
        """Count a block of configurations, and those that are outside the limits; the number of the first of these."""
        if outside and not self.outside:
            self.first_outside = first_outside
        self.outside += outside
        self.count += count

    def from_number(self, first: int) -> PoseMaker:
        """The same for the configurations behind the first ones."""
        maker = PoseMaker(self.robot, self.units, self.frames)
        maker.count = first
        return maker

    def outside_notes(self, q: Array) -> Iterator[str]:
        """A sentence for each value of a few configurations (m, n) that is outside its limits.

        Beside the joints' these are the motions of those that hang on others, where limits of their own bound them.
        """
        for number, values in enumerate(q, start=1):
            which = f"configuration {number}: " if len(q) > 1 else ""
            si = values * self.factors
            for i, joint in enumerate[Joint | GraphJoint](self.robot.joints):
                if not within(self.robot.limits[i : i + 1], si[i : i + 1]):
                    name = "" if joint.name == str(i + 1) else f" ({joint.name})"
                    turns = bool(self.robot.revolute[i])
                    yield f"{which}joint {i + 1}{name} {self._outside(si[i], self.robot.limits[i], turns)}"
            for name, value, limits, turns in self._motions(si):
                if not within(limits[None], np.array([value])):
                    yield f"{which}the motion of joint {name} {self._outside(value, limits, turns)}"

    def _motions(self, q: Array) -> Iterator[tuple[str, float, Array, bool]]:
        """Of a configuration (n,) [rad | m] each motion that several joints make and that has limits of its own.

        Its joint's name, its value, the limits (2,), and whether it turns. What one alone makes counts in its limits.
        """
        robot = self.robot
        if isinstance(robot, CoupledRobot):
            S, o, limits = robot.drive.S, robot.drive.offsets, robot.drive.limits
            moved = [(joint.name, bool(turns)) for joint, turns in zip(
                robot.free_motion.joints, robot.free_motion.revolute, strict=True)]  # fmt: skip
        elif isinstance(robot, Tree):
            (S, o), limits = robot.graph.value_map, robot.graph.value_limits
            moved = [(joint.name, joint.turns) for joint in map(robot.graph.joints.__getitem__, robot.graph.moving)]
        else:
            return
        bounded = np.isfinite(limits).any(axis=1) & (np.count_nonzero(S, axis=1) > 1)
        for i in np.flatnonzero(bounded).tolist():
            name, turns = moved[i]
            yield name, float(combined(q, S[i, :, None])[0] + o[i]), limits[i], turns

    def _outside(self, value: float, limits: Array, turns: bool) -> str:
        """`= 200 deg is outside its limits -170 .. 170`, of a value and limits (2,) [rad | m]."""
        factor = self.units.radians if turns else self.units.metres
        unit = self.units.angle if turns else self.units.length
        low, high = (float(in_units(np.array(end), factor)) if np.isfinite(end) else float(end) for end in limits)
        return f"= {value / factor:.12g} {unit} is outside its limits {show_range(low, high)}"

    def outside_summary(self) -> str | None:
        """A sentence on the configurations of a stream that were outside the limits; None if none was."""
        if not self.outside:
            return None
        verb = "is" if self.outside == 1 else "are"
        return (
            f"{self.outside} of {self.count} configurations {verb} outside the joint limits, "
            f"the first is number {self.first_outside}"
        )
