"""`robokin frame`: what a transform expression amounts to."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from robokin.cli.completion import words
from robokin.cli.option_groups import ArrayOutputOptions, UnitOptions
from robokin.cli.options import AsOption, choose, option, orientation_kind, whole_number
from robokin.cli.statuses import say
from robokin.errors import ExpressionError, InputError

if TYPE_CHECKING:
    from robokin.arrays import Array
    from robokin.inverse.frame_motions import FrameMotion
    from robokin.units import Units

STEPS, MOST_STEPS = 10, 100_000
"""Steps of a way when nobody says how many, and at most."""


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
    to: Annotated[
        str | None, option("--to", "EXPR", "The way to this frame: the transform between the two, the screw motion.")
    ] = None,
    along: Annotated[
        str | None,
        option("--along", "WAY", "With --to: line or screw.  [default: line]", words("line", "screw")),
    ] = None,
    steps: Annotated[
        str | None, option("--steps", "N", "With --to: steps of the way in a CSV or an array.  [default: 10]")
    ] = None,
    plot: Annotated[
        str | None,
        option("--plot -p", "FILE", "With --to: draw it to .html that plays it, .gif, or .png, .svg, .pdf."),
    ] = None,
    as_: AsOption = None,
    output: ArrayOutputOptions,
    typed: UnitOptions,
) -> int:
    """Evaluate a transform expression: matrix, n s a p, angles of every kind, quaternion.

    Angles are in degrees and lengths in metres unless --angle and --length say otherwise.

    With --to the frame moves to another one: its origin in a straight line while it turns about one fixed direction,
    or with --along screw about one line in space and along it, both evenly. The screw motion is said for either way:
    its axis and a place of it in the coordinates of EXPR, the angle, the translation, and the pitch: the translation
    for each radian. A CSV or an array has a row for each step of the way.

    Examples:
        robokin frame "Trans(4,-3,7) Rot(y,90) Rot(z,90)"
        robokin frame "Trans(10,5,0) Rot(z,30)" --point 3,7,0
        robokin frame "Inv(Trans(4,3,0) Rot(z,30))" --json
        robokin frame "Rot(z,pi/2)" --angle rad --of "Trans(1,0,0)"
        robokin frame "Trans(1,0,0)" --to "Trans(0,2,1) Rot(z,90)"
        robokin frame "" --to "Trans(1,2,0) RPY(30,60,90)" --along screw -p way.html
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
    _check_way(to, {"--along": along, "--steps": steps, "--plot": plot}, point)
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
        motion = None if to is None else _motion(T, value(to, "--to"), along, steps)
        T = poses_in(T.copy(), units)
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
    if motion is not None and to is not None:
        from robokin.records.frame_motion_records import motion_record

        for note in motion.notes:
            say(note)
        record |= motion_record(motion, to, units, columns)
        if plot is not None:
            first = f"Inv({expression})" if inverse else expression
            _draw(plot, motion, (f"{first} {of or ''}", to), units)
    with sink(output.file) as stream:
        stream.writelines(frame_written(kind, record, T, columns, units, mapped, motion))
    return 0


def _check_way(to: str | None, about: dict[str, str | None], point: str | None) -> None:
    """Raise InputError for options about the way to another frame without one, and for what does not go with it."""
    for name, given in about.items():
        if given is not None and to is None:
            raise InputError(f"{name} is about the way to another frame, expected --to with it")
    if to is not None and point is not None:
        raise InputError("--point and --to exclude each other, expected one of them")
    if (plot := about["--plot"]) is not None:
        from robokin.pictures.picture_files import MOVING, picture_ending

        picture_ending(plot, "--plot", MOVING)


def _motion(first: Array, last: Array, along: str | None, steps: str | None) -> FrameMotion:
    """The way from one frame to another (4, 4) [m]. Raises InputError."""
    from robokin.inverse.frame_motions import ALONG, frame_motion

    way = choose(along, ALONG, "--along") or ALONG[0]
    return frame_motion(first, last, way, whole_number(steps, "--steps", 1, MOST_STEPS) or STEPS)


def _draw(plot: str, motion: FrameMotion, names: tuple[str, str], units: Units) -> None:
    """Draw the way to a file."""
    from robokin.pictures.drawn_frames import frames_picture
    from robokin.tables.sink import sink

    picture = frames_picture(motion, names, units, plot.rpartition(".")[2].lower())
    with sink(plot, "--plot") as stream:
        stream.write(picture)
