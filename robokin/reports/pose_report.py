"""Answers of `robokin fk`, a block at a time: from poses to every format."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from typing import IO, TYPE_CHECKING, Any

import numpy as np

from robokin.arrays import Array
from robokin.model import Robot
from robokin.records.envelope import envelope
from robokin.records.pose_blocks import PoseMaker
from robokin.records.pose_records import PoseBlock, configuration_records
from robokin.reports.answer_stream import SharedStream
from robokin.tables.carried import Carried, nothing
from robokin.tables.orientations import orientation, pose_columns, pose_table
from robokin.tables.written_rows import csv_header, csv_rows, page
from robokin.units import Units

if TYPE_CHECKING:
    from robokin.jobs.ordered_map import Workers

RECORD_KEYS = ("schema", "robot", "id", "units", "q", "within_limits", "pose", "frames")
"""What a JSON document says itself."""


def csv_columns(robot: Robot, orientation: str | None) -> list[str]:
    """The columns of a CSV."""
    return [*(f"q{i}" for i in range(1, robot.n + 1)), *pose_columns(orientation or "rpy")]


@dataclass(frozen=True)
class PoseReport(SharedStream):
    """Poses at blocks of configurations as bytes; `maker` counts those outside the limits.

    `orientation` is how to say it, None as usual; `alone` tells that one configuration was asked for, by an option;
    `carried` is what goes through.
    """

    maker: PoseMaker
    orientation: str | None
    alone: bool
    carried: Carried = field(default_factory=nothing)
    begun: bool = False
    """Whether what stands above all answers is written."""
    cores: int | None = 1

    @property
    def robot(self) -> Robot:
        """The robot that is asked about."""
        assert isinstance(self.maker.robot, Robot)
        return self.maker.robot

    @property
    def units(self) -> Units:
        """The units of what goes in and out."""
        return self.maker.units

    @property
    def about(self) -> dict[str, Any]:
        """What a file says of the answers beside its columns."""
        return envelope("robot", self.robot.id, self.units)

    def from_number(self, first: int, carried: Carried) -> PoseReport:
        """The same for the configurations behind the first ones."""
        return replace(self, maker=self.maker.from_number(first), carried=carried, begun=first > 0, cores=1)

    def alone_from(self, first: int, carried: Carried) -> PoseReport:
        """The same, with what stands above all answers."""
        return replace(self.from_number(first, carried), begun=False)

    def bare(self) -> PoseReport:
        """The same without what is carried."""
        return replace(self, carried=nothing())

    def workers(self, kind: str) -> Workers:
        """Threads where the native kernel does the work: it lets go of the interpreter's lock."""
        from robokin.kernel.native_kernel import native

        return "threads" if native is not None and kind == "csv" and not self.carried.names else "processes"

    @property
    def found(self) -> tuple[int, int]:
        """How many configurations are outside the limits, and the number of the first one."""
        return self.maker.outside, self.maker.first_outside

    def add(self, rows: int, found: tuple[int, int]) -> None:
        """Count configurations that were answered elsewhere, and those among them outside the limits."""
        self.maker.add(rows, *found)

    def documents(self, blocks: Iterable[Array]) -> Iterator[Iterable[dict[str, Any]]]:
        """The documents of each block."""
        more = [self.orientation] if self.orientation else []
        for poses in self.maker.of(blocks):
            yield map(self.carried.in_front_of, configuration_records(self.robot, self.units, poses, more))

    def csv(self, answers: Iterable[Array]) -> Iterator[bytes]:
        """A row a configuration."""
        columns = csv_columns(self.robot, self.orientation)
        begun = self.begun
        for poses in self.maker.of(answers):
            table = np.concatenate([poses.q, pose_table(poses.T, self.orientation or "rpy", self.units)], axis=1)
            head = b"" if begun else csv_header(columns)
            yield self.carried.before(head, csv_rows(table))
            begun = True
        if not begun:
            yield self.carried.before(csv_header(columns), b"")

    def arrow(self, kind: str, blocks: Iterable[Array], stream: IO[bytes]) -> int:
        """The columns of the CSV; the number of rows. Text in between would take several times as long."""
        from robokin.tables.arrow_writer import ArrowWriter, columns_of

        columns, writer = csv_columns(self.robot, self.orientation), None
        for poses in self.maker.of(blocks):
            table = np.concatenate([poses.q, pose_table(poses.T, self.orientation or "rpy", self.units)], axis=1)
            if writer is None:
                named = columns_of([*self.carried.names, *columns], self.carried)
                writer = ArrowWriter(stream, kind, named, self.about)
            writer.columns([*self.carried.columns(len(table)), *np.ascontiguousarray(table.T)])
        named = columns_of([*self.carried.names, *columns], self.carried)
        return (writer or ArrowWriter(stream, kind, named, self.about)).close()

    def shared(self, answers: Iterable[Array]) -> Iterator[PoseBlock]:
        """The poses of each block, by as many threads as there are cores to use."""
        if self.cores == 1:
            yield from self.maker.of(answers)
            return
        from robokin.jobs.ordered_map import ordered_map, usable_cores
        from robokin.reports.shared_blocks import WINDOW, numbered

        window = WINDOW * (self.cores or usable_cores())
        blocks = numbered(answers, self.carried)
        for poses, found in ordered_map(self._poses_of, blocks, self.cores, window, "threads"):
            self.maker.add(len(poses.q), *found)
            yield poses

    def _poses_of(self, task: tuple[int, Array, Carried]) -> tuple[PoseBlock, tuple[int, int]]:
        first, block, _ = task
        maker = self.maker.from_number(first)
        (poses,) = maker.of([block])
        return poses, (maker.outside, maker.first_outside)

    def npy(self, answers: Iterable[Array], stream: IO[bytes]) -> None:
        """The matrices (m, 4, 4), or with --as the columns of the poses, or with frames all of these."""
        from robokin.tables.array_writer import ArrayWriter

        kind = self.orientation or "matrix"
        writer: ArrayWriter | None = None
        shape: tuple[int, ...] = (4, 4) if kind == "matrix" else (len(pose_columns(kind)),)
        for poses in self.shared(answers):
            block = poses.T if kind == "matrix" else pose_table(poses.T, kind, self.units)
            if poses.frames is not None:
                block = poses.frames
            writer = writer or ArrayWriter(stream, block.shape[1:])
            writer.write(block)
        (writer or ArrayWriter(stream, shape)).close()

    def table(self, answers: Iterable[Array]) -> Iterator[bytes]:
        """A page, or a line for each configuration."""
        if self.alone:
            from robokin.reports.page_tables import render

            yield from (render(*self.page(poses)) for poses in self.maker.of(answers))
            return
        from robokin.reports.number_columns import NumberColumns

        kind = self.orientation or "rpy"
        head = f"{self.robot.name}  lengths in {self.units.length}, angles in {self.units.angle}\n\n"
        head = "" if self.begun else head
        columns = None
        for poses in self.maker.of(answers):
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

    def page(self, poses: PoseBlock) -> list[Any]:
        """All that can be said of one pose, for eyes."""
        from robokin.reports.page_tables import heading, number_table
        from robokin.reports.pose_pages import LABELS, pose_page

        T = poses.T[0]
        kinds = [kind for kind in dict.fromkeys([self.orientation or "rpy", "rpy", "quaternion"]) if kind in LABELS]
        said = [(kind, orientation(T, kind, self.units).tolist()) for kind in kinds]
        parts = pose_page(self.robot.name, self.units, poses.q[0].tolist(), T[:3].tolist(), said)
        for i, frame in enumerate([] if poses.frames is None else poses.frames[0], start=1):
            parts += ["", heading(f"frame {i}"), number_table("nsap", frame[:3].tolist(), "xyz")]
        return parts
