"""How a question says a pose: what of it counts for an arm, and in which numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.grading.questions.typed_numbers import angle_text, decimal_text
from robokin.kinematics.flat_arm import flat_arm, upright_tool
from robokin.kinematics.forward import forward_kinematics
from robokin.kinematics.jacobian import jacobian
from robokin.kinematics.structure import arm_size
from robokin.model import Robot
from robokin.spatial import rpy_from_rotation
from robokin.units import Units

STEEP = np.radians(80.0)
"""Beyond this pitch roll and yaw are no numbers to ask for: at 90° only their difference is known."""

FLAT = np.radians(4.03)
"""An orientation whose angles are all smaller would be nearly right in any unit."""

SAMPLES = 16
"""Configurations by which it is seen what an arm can do."""

MATRIX = tuple(f"m{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3, 4))


@dataclass(frozen=True)
class PoseForm:
    """The numbers of a pose, `names`; the rows of the Jacobian that belong to it; what of the pose counts, `task`."""

    kind: str
    names: tuple[str, ...]
    rows: tuple[int, ...]
    task: str = "pose"

    @property
    def turns(self) -> bool:
        """Whether an orientation counts."""
        return self.task == "pose"

    def unit(self, name: str, units: Units) -> str:
        """The unit of one of the numbers, "" for none."""
        if name in ("x", "y", "z") or name in ("m14", "m24", "m34"):
            return units.length
        return "" if name.startswith("m") else units.angle

    def texts(self, T: Array, units: Units, decimals: tuple[int, int]) -> dict[str, str]:
        """A pose (4, 4) [m] as its numbers in the units; decimals of lengths and of angles."""
        lengths, angles = decimals
        p = T[:3, 3] / units.metres
        found: dict[str, str] = {}
        if self.kind == "matrix":
            for name in MATRIX:
                i, j = int(name[1]) - 1, int(name[2]) - 1
                found[name] = decimal_text(p[i], lengths) if j == 3 else decimal_text(T[i, j], 6)
            return found
        for i, name in enumerate(("x", "y", "z")):
            if name in self.names:
                found[name] = decimal_text(p[i], lengths)
        if "phi" in self.names:
            found["phi"] = angle_text(np.arctan2(T[1, 0], T[0, 0]) / units.radians, angles, units)
        if "roll" in self.names:
            rpy = rpy_from_rotation(T[:3, :3]) / units.radians
            found |= {
                name: angle_text(value, angles, units)
                for name, value in zip(("roll", "pitch", "yaw"), rpy, strict=True)
            }
        return found

    def fits(self, T: Array) -> bool:
        """Whether a pose (4, 4) can be said so: no number jumps with the last digit, and the unit of angles matters."""
        if self.kind == "rpy":
            rpy = np.abs(rpy_from_rotation(T[:3, :3]))
            return bool(rpy[1] < STEEP and np.max(rpy) > FLAT)
        return "phi" not in self.names or bool(abs(np.arctan2(T[1, 0], T[0, 0])) > FLAT)


PLANAR = PoseForm("planar", ("x", "y", "phi"), (0, 1, 5))
PLANE = PoseForm("planar", ("x", "y"), (0, 1), "position")
POSITION = PoseForm("position", ("x", "y", "z"), (0, 1, 2), "position")
RPY = PoseForm("rpy", ("x", "y", "z", "roll", "pitch", "yaw"), (0, 1, 2, 3, 4, 5))
ENTRIES = PoseForm("matrix", MATRIX, (0, 1, 2, 3, 4, 5))


def asked_form(robot: Robot) -> PoseForm:
    """What forward kinematics is asked of an arm: x, y, phi in the plane, the position of three joints, else a pose."""
    zero = flat_arm(robot)
    if zero is not None and not upright_tool(zero):
        return PLANAR
    if robot.n <= 3 and places_by_joints(robot):
        return POSITION
    poses = forward_kinematics(robot, samples(robot))
    return RPY if any(RPY.fits(T) for T in poses) else ENTRIES


def target_form(robot: Robot) -> PoseForm:
    """What inverse kinematics is asked of it: the same, but x, y alone of two joints in the plane."""
    form = asked_form(robot)
    return PLANE if form is PLANAR and robot.n < 3 else form


def samples(robot: Robot) -> Array:
    """(m, n) [rad | m] configurations at which nothing is special but by chance."""
    rng = np.random.default_rng(41)
    spread = np.where(robot.revolute, 1.5, 0.5 * arm_size(robot))
    return np.asarray(rng.uniform(-1.0, 1.0, (SAMPLES, robot.n)) * spread)


def places_by_joints(robot: Robot) -> bool:
    """Whether the position alone, and no orientation, follows from and fixes the joints of an arm of few."""
    return bool(np.max(regularity(robot, samples(robot), POSITION.rows)) > REGULAR)


REGULAR = 0.0237
"""Configurations count as regular where the smallest singular value is more than this part of the greatest. An odd
number: none of an arm at round joint values is just this, so that rounding decides nowhere."""


def regularity(robot: Robot, q: Array, rows: tuple[int, ...]) -> Array:
    """(m,) how far configurations q: (m, n) [rad | m] are from singular ones: the smallest singular value as a part of
    the greatest, lengths measured by the arm's size."""
    J = np.array(jacobian(robot, q))
    size = arm_size(robot)
    # A metre of a slide is weighed as the size's part, as a metre at the tool is.
    J = J * np.where(robot.revolute, 1.0, size)
    J[..., :3, :] /= size
    values = np.linalg.svd(J[..., list(rows), :], compute_uv=False)
    return np.asarray(values[..., -1] / np.maximum(values[..., 0], 1e-300))


def given_values(form: PoseForm, given: Mapping[str, float]) -> Array:
    """The numbers of a pose in their order."""
    return np.array([float(given[name]) for name in form.names])
