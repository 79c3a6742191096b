"""The options that say a target, the same in every command that has one."""

from __future__ import annotations

from typing import Annotated

from robokin.cli.option_groups import OptionGroup
from robokin.cli.options import option
from robokin.errors import InputError


class TargetOptions(OptionGroup):
    """A target by one of --pose, --matrix, --xyz and --xy, and what goes with them."""

    pose: Annotated[str | None, option("--pose", "EXPR", "The target as a transform expression.")] = None
    matrix: Annotated[
        str | None, option("--matrix", "[[..]]|FILE", "The target as a 4×4 matrix, or a file of one.")
    ] = None
    xyz: Annotated[str | None, option("--xyz", "X,Y,Z", "The target's position; alone: any orientation.")] = None
    rpy: Annotated[str | None, option("--rpy", "R,P,Y", "With --xyz: roll, pitch, yaw.")] = None
    euler: Annotated[str | None, option("--euler", "PHI,THETA,PSI", "With --xyz: ZYZ Euler angles.")] = None
    quat: Annotated[str | None, option("--quat", "W,X,Y,Z", "With --xyz: a quaternion of length 1.")] = None
    approach: Annotated[
        str | None,
        option("--approach", "X,Y,Z", "With --xyz: the tool's z axis only, any roll."),
    ] = None
    xy: Annotated[str | None, option("--xy", "X,Y", "The position for a planar arm.")] = None
    phi: Annotated[str | None, option("--phi", "PHI", "With --xy: the angle of the end effector.")] = None

    @property
    def texts(self) -> dict[str, str | None]:
        """What was typed, by the options' names, as `parse_target` reads it."""
        return {f"--{name}": getattr(self, name) for name in type(self).__annotations__}

    @property
    def given(self) -> list[str]:
        """The options that were typed."""
        return [name for name, text in self.texts.items() if text is not None]

    def exclude(self, option: str, value: object) -> None:
        """Raise InputError where an option that takes a target's place was typed beside one."""
        if value is not None and self.given:
            raise InputError(f"{option} and {self.given[0]} exclude each other, expected one of them")
