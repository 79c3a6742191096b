"""The options that say a target, the same in every command that has one."""

from __future__ import annotations

from typing import Annotated

import typer

PoseOption = Annotated[str | None, typer.Option("--pose", metavar="EXPR", help="The target as a transform expression.")]
MatrixOption = Annotated[
    str | None, typer.Option("--matrix", metavar="[[..]]|FILE", help="The target as a 4×4 matrix, or a file of one.")
]
XyzOption = Annotated[
    str | None, typer.Option("--xyz", metavar="X,Y,Z", help="The target's position; alone: any orientation.")
]
RpyOption = Annotated[str | None, typer.Option("--rpy", metavar="R,P,Y", help="With --xyz: roll, pitch, yaw.")]
EulerOption = Annotated[
    str | None, typer.Option("--euler", metavar="PHI,THETA,PSI", help="With --xyz: ZYZ Euler angles.")
]
QuatOption = Annotated[
    str | None, typer.Option("--quat", metavar="W,X,Y,Z", help="With --xyz: a quaternion of length 1.")
]
ApproachOption = Annotated[
    str | None, typer.Option("--approach", metavar="X,Y,Z", help="With --xyz: the tool's z axis only, any roll.")
]
XyOption = Annotated[str | None, typer.Option("--xy", metavar="X,Y", help="The position for a planar arm.")]
PhiOption = Annotated[
    str | None, typer.Option("--phi", metavar="PHI", help="With --xy: the angle of the end effector.")
]


def target_texts(
    pose: str | None, matrix: str | None, xyz: str | None, rpy: str | None, euler: str | None, quat: str | None,
    approach: str | None, xy: str | None, phi: str | None,
) -> dict[str, str | None]:  # fmt: skip
    """What was typed, by the options' names, as `parse_target` reads it."""
    return {
        "--pose": pose, "--matrix": matrix, "--xyz": xyz, "--rpy": rpy, "--euler": euler, "--quat": quat,
        "--approach": approach, "--xy": xy, "--phi": phi,
    }  # fmt: skip
