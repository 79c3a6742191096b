"""`robokin fk`: joint values to poses, one, several, or a stream of them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any

import typer

from robokin.cli.options import (
    ORIENTATIONS,
    AngleOption,
    AsOption,
    FormatOption,
    JsonOption,
    LengthOption,
    OutputOption,
    RobotArgument,
    SetOption,
    choose,
    effective_units,
    output_format,
    parameter_overrides,
)

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]


def command(
    robot: RobotArgument,
    q: Annotated[
        list[str] | None,
        typer.Option(
            "--q",
            metavar="Q",
            help="Joint values separated by commas or spaces, expressions allowed (90,0,sqrt(2)); the name of a "
            "pose; or - for a configuration a line on standard input. Repeatable.",
        ),
    ] = None,
    input: Annotated[
        str | None,
        typer.Option("--input", "-i", metavar="FILE", help="Configurations, one a line: .csv, .jsonl or .npy; - too."),
    ] = None,
    frames: Annotated[bool, typer.Option("--frames", help="Also the frame after each row of the table.")] = False,
    as_: AsOption = None,
    output: OutputOption = None,
    format: FormatOption = None,
    json: JsonOption = False,
    angle: AngleOption = None,
    length: LengthOption = None,
    set_: SetOption = None,
) -> int:
    """Forward kinematics: the pose of the end effector at given joint values.

    Angles and lengths are in the description's units unless --angle and --length say otherwise.

    Example: robokin fk puma560 --q 90,0,90,0,0,0
    """
    from robokin.cli.arguments import load_robot, parse_configuration
    from robokin.cli.output.sink import format_of
    from robokin.errors import InputError

    kind = format_of(output, output_format(format, json))
    columns = choose(as_, ORIENTATIONS, "--as")
    model = load_robot(robot, parameter_overrides(set_))
    units = effective_units(model.units, length, angle)
    task = _Task(model, units, frames, columns, kind, output)

    if input is not None and q:
        raise InputError("--input and --q exclude each other, expected one of them")
    source = input if input is not None else "-" if q == ["-"] else None
    if q and "-" in q and source is None:
        raise InputError("--q - stands for all configurations on standard input, expected no other --q beside it")
    if source is not None:
        task.stream(source)
        return 0
    if not q and model.n:
        example = ",".join(["0"] * model.n)
        raise InputError(
            f"--q is missing, expected {model.n} values, one for each joint of {model.name} "
            f"({model.types}), such as --q {example}"
        )
    task.answer([parse_configuration(text, model, units) for text in q or [""]])
    return 0


class _Task:
    """What is to be computed and how it is to be written."""

    def __init__(
        self, robot: Any, units: Any, frames: bool, columns: str | None, kind: str, output: str | None
    ) -> None:
        from robokin.cli.arguments import joint_factors

        self.robot, self.units, self.frames, self.columns = robot, units, frames, columns
        self.kind, self.output = kind, output
        self.factors = joint_factors(robot, units)
        self.outside = 0
        self.first_outside = 0
        self.count = 0

    # One or several configurations of the command line ------------------------------------------------

    def answer(self, configurations: list[Array]) -> None:
        """Write the poses at the given configurations, each (n,) in the units."""
        import numpy as np

        q = np.array(configurations)
        for text in self.limit_notes(q):
            from robokin.cli import say

            say(text)
        if self.kind == "table":
            from robokin.cli.output.sink import sink
            from robokin.cli.output.tables import render

            with sink(None) as stream:
                stream.write(render(*self.tables(q)))
        elif self.kind == "json" and len(q) == 1:
            from robokin.cli.output.sink import sink
            from robokin.cli.output.text import json_document

            with sink(self.output) as stream:
                stream.write(json_document(next(self.records(q))))
        else:
            self.write_blocks(iter([q]))

    def limit_notes(self, q: Array) -> Iterator[str]:
        """A sentence for each joint value outside its limits."""
        from robokin.cli.output.numbers import show

        for values in q:
            for i, joint in enumerate(self.robot.joints):
                low, high = (limit / self.factors[i] for limit in joint.limits)
                if not self.within_one(i, values[i]):
                    unit = self.units.angle if joint.type == "revolute" else self.units.length
                    name = "" if joint.name == str(i + 1) else f" ({joint.name})"
                    limits = f"{show(low)} .. {show(high)}"
                    yield f"joint {i + 1}{name} = {show(values[i])} {unit} is outside its limits {limits}"

    def within_one(self, i: int, value: float) -> bool:
        from robokin.model.robot import LIMIT_TOLERANCE

        low, high = self.robot.joints[i].limits
        return bool(low - LIMIT_TOLERANCE <= value * self.factors[i] <= high + LIMIT_TOLERANCE)

    # A stream ------------------------------------------------------------------------------------------

    def stream(self, source: str) -> None:
        """Write the poses at the configurations of a file or of standard input."""
        from robokin.cli import say
        from robokin.cli.rows import Columns, open_input, read_rows

        robot = self.robot
        columns = Columns(
            names=tuple(f"q{i}" for i in range(1, robot.n + 1)),
            aliases=tuple(joint.name for joint in robot.joints),
            angles=tuple(bool(turns) for turns in robot.revolute),
            key="q",
            what=f"{robot.n} values a line, one for each joint of {robot.name} ({robot.types})",
        )
        with open_input(source) as (stream, name):
            self.write_blocks(read_rows(stream, name, columns, self.units))
        if self.outside:
            say(f"{self.outside} of {self.count} configurations are outside the joint limits, "
                f"first configuration {self.first_outside}")  # fmt: skip

    def write_blocks(self, blocks: Iterator[Array]) -> None:
        """Write blocks of configurations (m, n) in the chosen format."""
        from robokin.cli.output.sink import sink

        with sink(self.output) as stream:
            for data in getattr(self, f"_{self.kind}")(blocks, stream):
                stream.write(data)

    def _csv(self, blocks: Iterator[Array], stream: Any) -> Iterator[bytes]:
        import numpy as np

        from robokin.cli.output.text import csv_header, csv_rows
        from robokin.cli.records import pose_columns, pose_table

        kind = self.columns or "rpy"
        yield csv_header([*(f"q{i}" for i in range(1, self.robot.n + 1)), *pose_columns(kind)])
        for q in blocks:
            T = self.poses(q)
            yield csv_rows(np.concatenate([q + 0.0, pose_table(T, kind, self.units)], axis=1))

    def _jsonl(self, blocks: Iterator[Array], stream: Any) -> Iterator[bytes]:
        from robokin.cli.output.text import json_line

        for q in blocks:
            yield b"".join(json_line(record) for record in self.records(q))

    def _json(self, blocks: Iterator[Array], stream: Any) -> Iterator[bytes]:
        from robokin.cli.output.text import json_list

        return json_list(record for q in blocks for record in self.records(q))

    def _npy(self, blocks: Iterator[Array], stream: Any) -> Iterator[bytes]:
        from robokin.cli.output.arrays import ArrayWriter
        from robokin.cli.records import pose_columns, pose_table

        kind = self.columns or "matrix"
        if self.frames:
            shape: tuple[int, ...] = (len(self.robot.rows), 4, 4)
        else:
            shape = (4, 4) if kind == "matrix" else (len(pose_columns(kind)),)
        writer = ArrayWriter(stream, shape)
        for q in blocks:
            if self.frames:
                writer.write(self.row_frames(q))
            else:
                T = self.poses(q)
                writer.write(T if kind == "matrix" else pose_table(T, kind, self.units))
        writer.close()
        return iter(())

    def _table(self, blocks: Iterator[Array], stream: Any) -> Iterator[bytes]:
        from robokin.cli.output.tables import number_table, render
        from robokin.cli.records import pose_columns, pose_table

        kind = self.columns or "rpy"
        for q in blocks:
            yield render(number_table(pose_columns(kind), pose_table(self.poses(q), kind, self.units).tolist()))

    # Computing -------------------------------------------------------------------------------------------

    def poses(self, q: Array) -> Array:
        """Poses (m, 4, 4) in the units at q (m, n) in the units; counts what is outside the limits."""
        from robokin.cli.records import poses_in
        from robokin.kinematics.forward import forward_kinematics

        si = q * self.factors
        outside = ~self.robot.within_limits(si)
        if outside.any():
            if not self.outside:
                self.first_outside = self.count + int(outside.argmax()) + 1
            self.outside += int(outside.sum())
        self.count += len(q)
        return poses_in(forward_kinematics(self.robot, si), self.units)

    def row_frames(self, q: Array) -> Array:
        """Frames (m, rows, 4, 4) in the units."""
        from robokin.cli.records import poses_in
        from robokin.kinematics.forward import row_frames

        self.count += len(q)
        return poses_in(row_frames(self.robot, q * self.factors), self.units)

    def records(self, q: Array) -> Iterator[dict[str, Any]]:
        """The JSON documents at q (m, n) in the units."""
        from robokin.cli.records import configuration_record, poses_in
        from robokin.kinematics.forward import row_frames

        T = self.poses(q)
        within = self.robot.within_limits(q * self.factors).tolist()
        frames: list[Any] = [None] * len(q)
        if self.frames:
            frames = list(poses_in(row_frames(self.robot, q * self.factors), self.units))
        for i in range(len(q)):
            yield configuration_record(self.robot, self.units, q[i] + 0.0, within[i], T[i], frames[i])

    def tables(self, q: Array) -> list[Any]:
        """The tables for eyes."""
        from robokin.cli.output.numbers import show
        from robokin.cli.output.tables import heading, number_table, pairs
        from robokin.cli.records import ORIENTATION_COLUMNS, orientation, pose_columns, pose_table

        units = self.units
        head = heading(self.robot.name, f"lengths in {units.length}, angles in {units.angle}")
        T = self.poses(q)
        if len(q) > 1:
            kind = self.columns or "rpy"
            rows = pose_table(T, kind, units).tolist()
            return [head, "", number_table(pose_columns(kind), rows, [str(i) for i in range(1, len(q) + 1)])]
        parts: list[Any] = [head, "", number_table("nsap", T[0, :3].tolist(), "xyz"), ""]
        entries = [("q", "  ".join(show(value) for value in q[0]))] if self.robot.n else []
        entries.append(("position", "  ".join(show(value) for value in T[0, :3, 3])))
        labels = {"rpy": "roll pitch yaw", "quaternion": "quaternion", "euler": "Euler ZYZ"}
        for kind in dict.fromkeys([self.columns or "rpy", "rpy", "quaternion"]):
            if kind in labels and kind in ORIENTATION_COLUMNS:
                values = orientation(T[0], kind, units)
                entries.append((labels[kind], "  ".join(show(value) for value in values)))
        parts.append(pairs(entries))
        if self.frames:
            for i, frame in enumerate(self.row_frames(q)[0], start=1):
                parts += ["", heading(f"frame {i}"), number_table("nsap", frame[:3].tolist(), "xyz")]
        return parts
