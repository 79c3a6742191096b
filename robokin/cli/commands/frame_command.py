"""`robokin frame`: what a transform expression amounts to."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from robokin.cli.option_groups import ArrayOutputOptions, UnitOptions
from robokin.cli.options import AsOption, option, orientation_kind
from robokin.cli.statuses import say
from robokin.errors import ExpressionError, InputError


def command(
    expression: Annotated[
        str,
        typer.Argument(
            metavar="EXPR",
            help="Steps that multiply from left to right: Trans(x,y,z), Rot(x|y|z,angle), Rot([x,y,z],angle), "
            "RPY(roll,pitch,yaw), Euler(phi,theta,psi), Euler(xyz,a,b,c), ABC(a,b,c), WPR(w,p,r), OAT(o,a,t), "
            "RotVec(x,y,z), Quat(w,x,y,z), QuatXYZW(x,y,z,w), DH(theta,d,a,alpha), MDH(alpha,a,theta,d), Inv(...), "
            "Matrix([[...]]).",
            show_default=False,
        ),
    ],
    *,
    of: Annotated[str | None, option("--of", "EXPR", "Map this frame: the result is EXPR times it.")] = None,
    inverse: Annotated[bool, typer.Option("--inverse", help="Take the inverse of EXPR (before --of).")] = False,
    point: Annotated[str | None, option("--point", "X,Y,Z", "Map a point by the result.")] = None,
    as_: AsOption = None,
    output: ArrayOutputOptions,
    typed: UnitOptions,
) -> int:
    """Evaluate a transform expression: matrix, n s a p, angles of every kind, quaternion.

    Angles are in degrees and lengths in metres unless --angle and --length say otherwise.

    Examples:
        robokin frame "Trans(4,-3,7) Rot(y,90) Rot(z,90)"
        robokin frame "Trans(10,5,0) Rot(z,30)" --point 3,7,0
        robokin frame "Inv(Trans(4,3,0) Rot(z,30))" --json
        robokin frame "Rot(z,pi/2)" --angle rad --of "Trans(1,0,0)"
    """
    import numpy as np

    from robokin.cli.arguments import parse_numbers
    from robokin.formats.number_expressions import Scope
    from robokin.formats.transform_expressions import evaluate_transform
    from robokin.records.envelope import envelope
    from robokin.records.pose_records import frame_record, poses_in
    from robokin.reports.frame_report import frame_written
    from robokin.spatial import invert, map_point
    from robokin.tables.sink import sink
    from robokin.units import Units

    kind = output.kind
    columns = orientation_kind(as_)
    units = typed.over(Units(angle="deg"))
    scope = Scope(degrees=units.degrees)
    notes: list[str] = []

    def value(text: str, option: str) -> Any:
        try:
            return evaluate_transform(text, scope, units, notes)
        except ExpressionError as error:
            raise InputError(f"{option}: {error}") from None

    # What is too large is found below, and said in a sentence.
    with np.errstate(over="ignore", invalid="ignore"):
        T = value(expression, "EXPR")
        if inverse:
            T = invert(T)
        if of is not None:
            T = T @ value(of, "--of")
        T = poses_in(T, units)
        mapped = None
        if point is not None:
            mapped = map_point(T, parse_numbers(point, "--point", [False] * 3, units, "x, y, z")) + 0.0
    if not (np.isfinite(T).all() and (mapped is None or np.isfinite(mapped).all())):
        raise InputError("the result is too far away for a number, expected less")
    for note in notes:
        say(note)
    record: dict[str, Any] = {**envelope("expression", expression, units), **frame_record(T, units, columns)}
    if mapped is not None:
        record["point"] = mapped.tolist()
        if kind == "npy":
            raise InputError("--point: an array of a transform has no room for a point, expected another format")

    with sink(output.file) as stream:
        stream.writelines(frame_written(kind, record, T, columns, units, mapped))
    return 0
