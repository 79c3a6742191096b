"""Answers of `robokin fk` about the tips of a tree, a block at a time: from poses to every format."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import IO, Any

import numpy as np

from robokin.arrays import Array
from robokin.model import Tree
from robokin.number_text import show
from robokin.records.envelope import envelope
from robokin.records.pose_blocks import PoseMaker
from robokin.records.pose_records import PoseBlock, tip_records
from robokin.reports.answer_stream import AnswerStream
from robokin.tables.carried import Carried, nothing
from robokin.tables.orientations import pose_columns, pose_table
from robokin.tables.written_rows import csv_header, csv_rows, page
from robokin.units import Units

TIP_KEYS = ("schema", "robot", "id", "units", "q", "within_limits", "tips")
"""What a JSON document says itself."""

LONGEST = 24
"""Characters of a tip's name in a table."""


def tip_columns(tree: Tree, orientation: str | None) -> list[str]:
    """The columns of a CSV: the joint values, then a group for each tip."""
    poses = (f"{tip}.{column}" for tip in tree.tips for column in pose_columns(orientation or "rpy"))
    return [*(f"q{i}" for i in range(1, tree.n + 1)), *poses]


@dataclass(frozen=True)
class TipReport(AnswerStream):
    """Poses of all tips of a tree at blocks of configurations as bytes.

    `orientation` is how to say it, None as usual; `alone` tells that one configuration was asked for, by an option;
    `carried` is what goes through.
    """

    tree: Tree
    maker: PoseMaker
    orientation: str | None
    alone: bool
    carried: Carried = field(default_factory=nothing)

    @property
    def units(self) -> Units:
        """The units of what goes in and out."""
        return self.maker.units

    @property
    def about(self) -> dict[str, Any]:
        """What a file says of the answers beside its columns."""
        return envelope("robot", self.tree.id, self.units)

    def documents(self, blocks: Iterable[Array]) -> Iterator[Iterable[dict[str, Any]]]:
        """The documents of each block."""
        more = [self.orientation] if self.orientation else []
        for poses in self.maker.of(blocks):
            yield map(self.carried.in_front_of, tip_records(self.tree, self.units, poses, more))

    def csv(self, blocks: Iterable[Array]) -> Iterator[bytes]:
        """A row a configuration."""
        head = csv_header(tip_columns(self.tree, self.orientation))
        for poses in self.maker.of(blocks):
            rows = self._numbers(poses, self.orientation or "rpy").reshape(len(poses.q), -1)
            yield self.carried.before(head, csv_rows(np.concatenate([poses.q, rows], axis=1)))
            head = b""
        if head:
            yield self.carried.before(head, b"")

    def npy(self, blocks: Iterable[Array], stream: IO[bytes]) -> None:
        """The matrices (m, tips, 4, 4), or with --as the columns of the poses (m, tips, k)."""
        from robokin.tables.array_writer import ArrayWriter

        kind = self.orientation or "matrix"
        shape = (4, 4) if kind == "matrix" else (len(pose_columns(kind)),)
        writer = ArrayWriter(stream, (len(self.tree.tips), *shape))
        for poses in self.maker.of(blocks):
            writer.write(poses.T if kind == "matrix" else self._numbers(poses, kind))
        writer.close()

    def table(self, blocks: Iterable[Array]) -> Iterator[bytes]:
        """A line for each tip of each configuration."""
        from robokin.reports.number_columns import NumberColumns

        kind = self.orientation if self.orientation not in (None, "matrix") else "rpy"
        assert kind is not None
        names = pose_columns(kind)
        width = min(max(map(len, ("tip", *self.tree.tips))), LONGEST)
        labels = [("tip", width)] if self.alone else [("#", 5), ("tip", width)]
        columns = NumberColumns(labels, names, "lll" + ("aaa" if len(names) == 6 else "uuuu"), self.units)
        head = f"{self.tree.name}  lengths in {self.units.length}, angles in {self.units.angle}\n\n"
        for poses in self.maker.of(blocks):
            if self.alone and self.tree.n:
                head += f"q  {'  '.join(show(value) for value in poses.q[0])}\n\n"
            lines = columns.lines(self._labels(poses, width), self._numbers(poses, kind).reshape(-1, len(names)))
            yield page(f"{head}{columns.heading if head else ''}{lines}")
            head = ""

    def _labels(self, poses: PoseBlock, width: int) -> Iterator[tuple[object, ...]]:
        for number in range(poses.first, poses.first + len(poses.q)):
            for k, tip in enumerate(self.tree.tips):
                short = tip if len(tip) <= width else f"{tip[: width - 1]}…"
                yield (short,) if self.alone else (number if k == 0 else "", short)

    def _numbers(self, poses: PoseBlock, kind: str) -> Array:
        """(m, tips, k) the columns of the poses."""
        table = pose_table(poses.T.reshape(-1, 4, 4), kind, self.units)
        return table.reshape(len(poses.q), len(self.tree.tips), -1)
