"""`robokin frame`: what a transform expression amounts to."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from robokin.cli.options import (
    ORIENTATIONS,
    AngleOption,
    AsOption,
    FormatOption,
    JsonOption,
    LengthOption,
    OutputOption,
    choose,
    effective_units,
    output_format,
)


def command(
    expression: Annotated[
        str,
        typer.Argument(
            metavar="EXPR",
            help="Steps that multiply from left to right: Trans(x,y,z), Rot(x|y|z,angle), Rot([x,y,z],angle), "
            "RPY(roll,pitch,yaw), Euler(phi,theta,psi), Quat(w,x,y,z), DH(theta,d,a,alpha), MDH(alpha,a,theta,d), "
            "Inv(...), Matrix([[...]]).",
            show_default=False,
        ),
    ],
    of: Annotated[
        str | None,
        typer.Option("--of", metavar="EXPR", help="Map this frame by EXPR: the result is EXPR times it."),
    ] = None,
    inverse: Annotated[bool, typer.Option("--inverse", help="Take the inverse of EXPR.")] = False,
    point: Annotated[str | None, typer.Option("--point", metavar="X,Y,Z", help="Map a point by the result.")] = None,
    as_: AsOption = None,
    output: OutputOption = None,
    format: FormatOption = None,
    json: JsonOption = False,
    angle: AngleOption = None,
    length: LengthOption = None,
) -> int:
    """Evaluate a transform expression: matrix, n s a p, angles of every kind, quaternion.

    Angles are in degrees and lengths in metres unless --angle and --length say otherwise.

    Example: robokin frame "Trans(4,-3,7) Rot(y,90) Rot(z,90)"
    """
    from robokin.cli import say
    from robokin.cli.arguments import parse_numbers
    from robokin.cli.output.sink import format_of, sink
    from robokin.cli.output.text import csv_header, csv_rows, json_document, json_line
    from robokin.cli.records import frame_record, pose_columns, pose_table, poses_in
    from robokin.description.expressions import Scope
    from robokin.description.transforms import evaluate_transform
    from robokin.errors import ExpressionError, InputError
    from robokin.spatial import invert, map_point
    from robokin.units import Units

    kind = format_of(output, output_format(format, json))
    columns = choose(as_, ORIENTATIONS, "--as") or "rpy"
    units = effective_units(Units(angle="deg"), length, angle)
    scope = Scope(degrees=units.degrees)
    notes: list[str] = []

    def value(text: str, option: str) -> Any:
        try:
            return evaluate_transform(text, scope, units, notes)
        except ExpressionError as error:
            raise InputError(f"{option}: {error}") from None

    T = value(expression, "EXPR")
    if inverse:
        T = invert(T)
    if of is not None:
        T = T @ value(of, "--of")
    for note in notes:
        say(note)
    T = poses_in(T, units)
    record: dict[str, Any] = {"expression": expression, "units": units.as_record(), **frame_record(T, units)}
    if point is not None:
        p = parse_numbers(point, "--point", [False] * 3, units, "x, y, z")
        record["point"] = (map_point(T, p) + 0.0).tolist()

    with sink(output) as stream:
        if kind == "json":
            stream.write(json_document(record))
        elif kind == "jsonl":
            stream.write(json_line(record))
        elif kind == "csv":
            stream.write(csv_header(pose_columns(columns)) + csv_rows(pose_table(T[None], columns, units)))
        elif kind == "npy":
            from robokin.cli.output.arrays import ArrayWriter

            writer = ArrayWriter(stream, (4, 4))
            writer.write(T[None])
            writer.close()
        else:
            stream.write(_table(record, units))
    return 0


def _table(record: dict[str, Any], units: Any) -> bytes:
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
    if "point" in record:
        entries.append(("point", row(record["point"])))
    return render(
        heading(record["expression"] or "identity", f"lengths in {units.length}, angles in {units.angle}"),
        "",
        number_table("nsap", record["matrix"][:3], "xyz"),
        "",
        pairs(entries),
    )
