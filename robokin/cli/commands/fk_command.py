"""`robokin fk`: joint values to poses, one, several, or a stream of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import IO, TYPE_CHECKING, Annotated, Any

import typer

from robokin.cli.completion import named_poses
from robokin.cli.options import (
    AngleOption,
    ArrayOutputOption,
    AsOption,
    DropOption,
    FormatOption,
    JsonOption,
    LengthOption,
    RobotArgument,
    SetOption,
    effective_units,
    orientation_kind,
    output_format,
    parameter_overrides,
)

if TYPE_CHECKING:
    from robokin.arrays import Array
    from robokin.cli.records import PoseBlock
    from robokin.model import Robot
    from robokin.tables.carried import Carried
    from robokin.units import Units


def command(
    robot: RobotArgument,
    q: Annotated[
        list[str] | None,
        typer.Option(
            "--q",
            metavar="Q",
            help="Joint values separated by commas or spaces, expressions allowed; or the name of a pose of the "
            "description; or - for a configuration a line on standard input. Repeatable.",
            autocompletion=named_poses,
        ),
    ] = None,
    input: Annotated[
        str | None,
        typer.Option(
            "--input",
            "-i",
            metavar="FILE",
            help="A configuration a line: .csv (with a header or without), .jsonl, .json or .npy; - for standard "
            "input.",
        ),
    ] = None,
    frames: Annotated[bool, typer.Option("--frames", help="Also the frame after each row of the table.")] = False,
    symbolic: Annotated[bool, typer.Option("--symbolic", help="The matrices in symbols, c1*c23, and no --q.")] = False,
    latex: Annotated[bool, typer.Option("--latex", help="With --symbolic: in LaTeX, or -o FILE.tex.")] = False,
    python: Annotated[bool, typer.Option("--python", help="With --symbolic: a numpy function, or -o FILE.py.")] = False,
    numbers: Annotated[bool, typer.Option("--numbers", help="With --symbolic: lengths and twists as numbers.")] = False,
    as_: AsOption = None,
    drop: DropOption = False,
    output: ArrayOutputOption = None,
    format: FormatOption = None,
    json: JsonOption = False,
    angle: AngleOption = None,
    length: LengthOption = None,
    set_: SetOption = None,
) -> int:
    """Forward kinematics: the pose of the end effector at given joint values.

    Angles and lengths are in the description's units unless --angle and --length say otherwise.

    Examples:
        robokin fk puma560 --q 90,0,90,0,0,0
        robokin fk puma560 --q "-90 0 90 0 atan2(3,4) 0" --json
        robokin fk puma560 --q home --frames
        robokin fk puma560 --input joints.csv --output poses.csv
        shuf -n 3 joints.csv | robokin fk puma560 --q - -f csv
        robokin fk anthropomorphic --symbolic
    """
    from robokin.cli.arguments import load_robot, parse_configuration
    from robokin.cli.output.sink import format_of, sink
    from robokin.cli.poses import PoseMaker
    from robokin.cli.statuses import say
    from robokin.tables.carried import Carried

    if symbolic or latex or python or numbers:
        from robokin.cli.symbolic_answer import check_options, form_of, write_symbolic

        forms = {"--latex": latex, "--python": python, "--numbers": numbers}
        check_options(symbolic, forms, {"--q": q, "--input": input, "--as": as_})
        form = form_of(output, output_format(format, json), latex=latex, python=python)
        model = load_robot(robot, parameter_overrides(set_))
        units = effective_units(model.units, length, angle)
        write_symbolic(model, units, form, output, numbers=numbers, frames=frames)
        return 0
    kind = format_of(output, output_format(format, json), arrays=True)
    orientation = orientation_kind(as_)
    model = load_robot(robot, parameter_overrides(set_))
    units = effective_units(model.units, length, angle)
    source = _source(model, q, input)
    if frames and kind == "csv":
        raise _wrong("--frames: a row of CSV has no room for frames, expected the format table, json, jsonl or npy")

    maker = PoseMaker(model, units, frames)
    names = csv_columns(model, orientation) if kind == "csv" else RECORD_KEYS
    carried = Carried(names, say, wanted=source is not None and not drop and kind in ("csv", "json", "jsonl"))
    from robokin.cli.configurations import read_configurations, say_unit

    if source is not None:
        alone, blocks = False, read_configurations(source, model, units, carried)
    else:
        import numpy as np

        given = np.array([parse_configuration(text, model, units) for text in q or [""]])
        if not all(text.strip() in model.poses for text in q or [""]):
            say_unit(model, units, given)
        for note in maker.outside_notes(given):
            say(note)
        alone, blocks = len(given) == 1, iter([given])
    writer = _Writer(model, units, orientation, alone, carried)
    with sink(output) as stream:
        for data in writer.write(kind, maker.of(blocks), stream):
            stream.write(data)
            stream.flush()  # whoever waits for an answer gets it before the next question
    summary = maker.outside_summary() if source is not None else None
    if summary:
        say(summary)
    return 0


def _source(robot: Robot, q: list[str] | None, input: str | None) -> str | None:
    """What to read configurations from; None when they are given as arguments."""
    if input is not None and q:
        raise _wrong("--input and --q exclude each other, expected one of them")
    source = input if input is not None else "-" if q == ["-"] else None
    if q and "-" in q and source is None:
        raise _wrong("--q - stands for all configurations on standard input, expected no other --q beside it")
    if source is not None and not robot.n:
        raise _wrong(f"{robot.name} has no joints and one pose, expected no configurations to read")
    if source is None and not q and robot.n:
        example = ",".join(["0"] * robot.n)
        raise _wrong(
            f"--q is missing, expected {robot.n} values, one for each joint of {robot.name} ({robot.types}), "
            f"such as --q {example}; --q - reads standard input"
        )
    return source


RECORD_KEYS = ("robot", "units", "q", "within_limits", "pose", "frames", "schema")
"""What a JSON document says itself; an `id` of the input takes the place of its own, which `robot` says too."""


def csv_columns(robot: Robot, orientation: str | None) -> list[str]:
    """The columns of a CSV."""
    from robokin.tables.orientations import pose_columns

    return [*(f"q{i}" for i in range(1, robot.n + 1)), *pose_columns(orientation or "rpy")]


def _wrong(sentence: str) -> Exception:
    from robokin.errors import InputError

    return InputError(sentence)


@dataclass(frozen=True)
class _Writer:
    """Poses to bytes. `alone` tells that one configuration was asked for, by --q; `carried` is what goes through."""

    robot: Robot
    units: Units
    orientation: str | None
    alone: bool
    carried: Carried

    def write(self, kind: str, answers: Iterable[PoseBlock], stream: IO[bytes]) -> Iterator[bytes]:
        """The answers in a format, piece by piece; arrays go to the stream themselves."""
        if kind == "npy":
            self.npy(answers, stream)
            return iter(())
        if self.alone and kind in ("table", "json"):
            return self.one(kind, next(iter(answers)))
        return {"csv": self.csv, "jsonl": self.jsonl, "json": self.json, "table": self.table}[kind](answers)

    def one(self, kind: str, poses: PoseBlock) -> Iterator[bytes]:
        if kind == "json":
            from robokin.cli.output.text import json_document

            yield json_document(*self.records(poses))
        else:
            from robokin.cli.output.tables import render

            yield render(*self.page(poses))

    def csv(self, answers: Iterable[PoseBlock]) -> Iterator[bytes]:
        import numpy as np

        from robokin.cli.output.text import csv_header, csv_rows
        from robokin.tables.orientations import pose_table

        columns = csv_columns(self.robot, self.orientation)
        begun = False
        for poses in answers:
            table = np.concatenate([poses.q, pose_table(poses.T, self.orientation or "rpy", self.units)], axis=1)
            head = b"" if begun else csv_header(columns)
            yield self.carried.before(head, csv_rows(table))
            begun = True
        if not begun:
            yield self.carried.before(csv_header(columns), b"")

    def jsonl(self, answers: Iterable[PoseBlock]) -> Iterator[bytes]:
        from robokin.cli.output.text import json_line

        for poses in answers:
            yield b"".join(json_line(record) for record in self.records(poses))

    def json(self, answers: Iterable[PoseBlock]) -> Iterator[bytes]:
        from robokin.cli.output.text import json_list

        return json_list(self.records(poses) for poses in answers)

    def npy(self, answers: Iterable[PoseBlock], stream: IO[bytes]) -> None:
        from robokin.cli.output.array_files import ArrayWriter
        from robokin.tables.orientations import pose_columns, pose_table

        kind = self.orientation or "matrix"
        writer: ArrayWriter | None = None
        shape: tuple[int, ...] = (4, 4) if kind == "matrix" else (len(pose_columns(kind)),)
        for poses in answers:
            block = poses.T if kind == "matrix" else pose_table(poses.T, kind, self.units)
            if poses.frames is not None:
                block = poses.frames
            writer = writer or ArrayWriter(stream, block.shape[1:])
            writer.write(block)
        (writer or ArrayWriter(stream, shape)).close()

    def table(self, answers: Iterable[PoseBlock]) -> Iterator[bytes]:
        from robokin.cli.output.number_columns import NumberColumns
        from robokin.cli.output.text import page
        from robokin.tables.orientations import pose_columns, pose_table

        kind = self.orientation or "rpy"
        head = f"{self.robot.name}  lengths in {self.units.length}, angles in {self.units.angle}\n\n"
        columns = None
        for poses in answers:
            numbers = range(poses.first, poses.first + len(poses.q))
            if kind == "matrix" or poses.frames is not None:
                columns = columns or NumberColumns([("#", 5), ("frame", 5), ("", 1)], "nsap", "uuul", self.units)
                lines = columns.lines(*self.matrices(poses, numbers))
            else:
                names = pose_columns(kind)
                kinds = "lll" + ("aaa" if len(names) == 6 else "uuuu")
                columns = columns or NumberColumns([("#", 5)], names, kinds, self.units)
                lines = columns.lines(((number,) for number in numbers), pose_table(poses.T, kind, self.units))
            yield page(f"{head}{columns.heading if head else ''}{lines}")
            head = ""

    def matrices(self, poses: PoseBlock, numbers: Iterable[int]) -> tuple[list[tuple[object, str, str]], Array]:
        """Three lines for each matrix of a block, with their labels."""
        import numpy as np

        all_frames = poses.T[:, None]
        names = ["hand"]
        if poses.frames is not None:
            all_frames = np.concatenate([poses.frames, all_frames], axis=1)
            names = [*(str(i) for i in range(1, poses.frames.shape[1] + 1)), "hand"]
        first = [(name if axis == "x" else "", axis) for name in names for axis in "xyz"]
        labels: list[tuple[object, str, str]] = [
            (number if k == 0 else "", *label) for number in numbers for k, label in enumerate(first)
        ]
        return labels, all_frames[:, :, :3].reshape(-1, 4)

    def records(self, poses: PoseBlock) -> Iterator[dict[str, Any]]:
        """The JSON documents of a block."""
        from robokin.cli.records import configuration_records

        more = [self.orientation] if self.orientation else []
        for record in configuration_records(self.robot, self.units, poses, more):
            yield self.carried.in_front_of(record)

    def page(self, poses: PoseBlock) -> list[Any]:
        """All that can be said of one pose, for eyes."""
        from robokin.cli.output.numbers import show
        from robokin.cli.output.tables import heading, number_table, pairs
        from robokin.tables.orientations import orientation

        T = poses.T[0]
        parts: list[Any] = [heading(self.robot.name, f"lengths in {self.units.length}, angles in {self.units.angle}")]
        parts += ["", number_table("nsap", T[:3].tolist(), "xyz"), ""]
        entries = [("q", "  ".join(show(value) for value in poses.q[0]))] if self.robot.n else []
        entries.append(("position", "  ".join(show(value) for value in T[:3, 3])))
        labels = {"rpy": "roll pitch yaw", "quaternion": "quaternion", "euler": "Euler ZYZ", "abc": "A B C",
                  "quaternion-xyzw": "x y z w", "rotvec": "rotation vector", "wpr": "W P R"}  # fmt: skip
        for kind in dict.fromkeys([self.orientation or "rpy", "rpy", "quaternion"]):
            if kind in labels:
                values = orientation(T, kind, self.units)
                entries.append((labels[kind], "  ".join(show(value) for value in values)))
        parts.append(pairs(entries))
        for i, frame in enumerate([] if poses.frames is None else poses.frames[0], start=1):
            parts += ["", heading(f"frame {i}"), number_table("nsap", frame[:3].tolist(), "xyz")]
        return parts
