"""`robokin frame`: what a transform expression amounts to."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from robokin.cli.options import (
    AngleOption,
    ArrayOutputOption,
    AsOption,
    FormatOption,
    JsonOption,
    LengthOption,
    effective_units,
    orientation_kind,
    output_format,
)


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
    of: Annotated[
        str | None,
        typer.Option("--of", metavar="EXPR", help="Map this frame: the result is EXPR times it."),
    ] = None,
    inverse: Annotated[bool, typer.Option("--inverse", help="Take the inverse of EXPR (before --of).")] = False,
    point: Annotated[str | None, typer.Option("--point", metavar="X,Y,Z", help="Map a point by the result.")] = None,
    as_: AsOption = None,
    output: ArrayOutputOption = None,
    format: FormatOption = None,
    json: JsonOption = False,
    angle: AngleOption = None,
    length: LengthOption = None,
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
    from robokin.cli.output.sink import format_of, sink
    from robokin.cli.output.text import csv_header, csv_rows, json_document, json_line
    from robokin.cli.records import frame_record, poses_in
    from robokin.cli.statuses import say
    from robokin.errors import ExpressionError, InputError
    from robokin.formats.number_expressions import Scope
    from robokin.formats.transform_expressions import evaluate_transform
    from robokin.records.envelope import envelope
    from robokin.spatial import invert, map_point
    from robokin.tables.orientations import pose_columns, pose_table
    from robokin.units import Units

    kind = format_of(output, output_format(format, json), arrays=True)
    columns = orientation_kind(as_)
    units = effective_units(Units(angle="deg"), length, angle)
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

    with sink(output) as stream:
        if kind == "json":
            stream.write(json_document(record))
        elif kind == "jsonl":
            stream.write(json_line(record))
        elif kind == "csv":
            names, row = pose_columns(columns or "rpy"), pose_table(T[None], columns or "rpy", units)
            if mapped is not None:
                names, row = (*names, "point_x", "point_y", "point_z"), np.hstack([row, mapped[None]])
            stream.write(csv_header(names) + csv_rows(row))
        elif kind == "npy":
            row = T if columns in (None, "matrix") else pose_table(T[None], columns, units)[0]
            np.lib.format.write_array(stream, row, version=(1, 0))
        else:
            stream.write(_table(record, units, columns))
    return 0


LABELS = {"quaternion_xyzw": "x y z w", "rotvec": "rotation vector", "abc": "A B C", "wpr": "W P R"}
"""What a table says of an orientation that it has on demand only."""


def _table(record: dict[str, Any], units: Any, kind: str | None) -> bytes:
    from robokin.cli.output.numbers import show
    from robokin.cli.output.tables import heading, number_table, pairs, render

    def row(values: list[float]) -> str:
        return "  ".join(show(value) for value in values)

    turn = record["axis_angle"]
    entries = [
        ("position", row(record["position"])),
        ("roll pitch yaw", row(record["rpy"])),
        ("Euler ZYZ", row(record["euler"])),
        ("quaternion", row(record["quaternion"])),
        ("axis, angle", f"{row(turn['axis'])}, {show(turn['angle'])}"),
    ]
    if (key := (kind or "rpy").replace("-", "_")) in LABELS:
        entries.insert(1, (LABELS[key], row(record[key])))
    if "point" in record:
        entries.append(("point", row(record["point"])))
    return render(
        heading(record["expression"] or "identity", f"lengths in {units.length}, angles in {units.angle}"),
        "",
        number_table("nsap", record["matrix"][:3], "xyz"),
        "",
        pairs(entries),
    )
