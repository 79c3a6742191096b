"""Answers of `robokin path`: rows for programs, a summary for eyes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import IO

import numpy as np

from robokin.arrays import Array
from robokin.errors import counted
from robokin.inverse.followed_curves import joint_scale
from robokin.number_text import show
from robokin.records.envelope import envelope
from robokin.records.path_records import PathRecords
from robokin.tables.number_records import document_with_rows, json_row_lines
from robokin.tables.written_rows import csv_header, csv_rows

SAME = 1e-6
"""Joint values [rad | m] that differ by less are one."""

ALIKE = 1e-9
"""Orientations that differ by a smaller angle [rad] are one."""

SHOWN = 11
"""Rows of the table: the whole path is for CSV, JSON lines and arrays."""

WIDEST = 7
"""Joints whose values fit the width of a page."""


@dataclass(frozen=True, eq=False)
class PathReport:
    """A path in every format; `wanted` are joint values (n,) [rad | m] that a line was asked to end with, if it was."""

    records: PathRecords
    wanted: Array | None = None

    def write(self, kind: str, stream: IO[bytes]) -> Iterator[bytes]:
        """The path in a format; arrays go to the stream themselves."""
        if kind == "npy":
            np.lib.format.write_array(stream, self.records.rows(), version=(1, 0))
        elif kind == "csv":
            yield csv_header(self.records.columns()) + csv_rows(self.records.rows())
        elif kind == "jsonl":
            head = envelope("robot", self.records.robot.id, self.records.units)
            yield from json_row_lines(head, self.records.fields(), self.records.rows())
        elif kind == "json":
            records = self.records
            yield from document_with_rows(records.summary(), "path", records.fields(), records.rows())
        else:
            yield from self.page()

    def notes(self) -> Iterator[str]:
        """Sentences on what happens on the way, and on where the path ends."""
        path = self.records.path
        told = [(event.fraction, sentence) for event, sentence in zip(path.events, self.event_notes(), strict=True)]
        turned = [(turn.fraction, sentence) for turn, sentence in zip(path.turns, self.turn_notes(), strict=True)]
        yield from (sentence for _, sentence in sorted([*turned, *told], key=lambda one: one[0]))
        yield from self.end_notes()

    def turn_notes(self) -> Iterator[str]:
        """A sentence on each turn of joints while the tool stands still."""
        for turn in self.records.path.turns:
            yield f"at {show(turn.fraction)} of the path: {turn.words}" if turn.fraction else turn.words

    def event_notes(self) -> Iterator[str]:
        """A sentence on each event on the way."""
        robot, path, units = self.records.robot, self.records.path, self.records.units
        for event in path.events:
            record = self.records.event(event)
            value = ""
            if record["value"] is not None:
                assert event.joint is not None
                turns = robot.revolute[event.joint - 1]
                value = f" at {show(record['value'])} {units.angle if turns else units.length}"
            yield f"at {show(event.fraction)} of the path: {event.words}{value}"

    def end_notes(self) -> Iterator[str]:
        """Sentences on where the path ends, and on its postures and branches."""
        path = self.records.path
        yield from self.blend_notes()
        yield from path.choices
        if not path.complete:
            rows = counted(len(path.t), "row")
            yield f"it can be followed up to {show(path.fraction)} of the path: {rows} of {path.steps + 1}"
        elif self.wanted is not None:
            gap = path.q[-1] - self.wanted
            if np.max(np.abs(gap)) > SAME:
                end = "  ".join(show(value) for value in self.records.joints()[-1])
                yield f"the line ends at that pose with another configuration: {end}"

        postures = self.records.postures()
        if postures and postures["branch"] != postures["branch_at_end"]:
            yield f"the posture changes from {postures['branch']} to {postures['branch_at_end']} on the way"
        yield from self.branch_notes()

    def blend_notes(self) -> Iterator[str]:
        """A sentence on each point that the tool passes by."""
        units = self.records.units
        for one in self.records.path.blends:
            blend = self.records.blend(one)
            angle = f", turned by {show(blend['angle'])} {units.angle}" if one.angle > ALIKE else ""
            yield f"passes point {one.point} at {show(blend['distance'])} {units.length}{angle}"

    def branch_notes(self) -> Iterator[str]:
        """Sentences on the branches that were tried."""
        robot, path, units = self.records.robot, self.records.path, self.records.units
        branches = path.branches
        if not branches:
            return
        reach, best = sum(one.complete for one in branches), branches[0]
        tried = f"of {len(branches)} branches from this pose" if len(branches) > 1 else "of 1 branch from this pose"
        start = ",".join(show(value) for value in self.records.branch(best)["start"])
        name = f" ({best.name})" if best.name else ""
        if not reach:
            lines = f" of the {'arc' if path.kind == 'arc' else 'line'}" if path.turns else ""
            gets = "" if best.chosen else f"; the one from {start}{name} gets farthest, to {show(best.fraction)}{lines}"
            yield f"{tried} none reaches the end{gets}"
        elif best.chosen:
            joint = int(np.argmax(best.travel / joint_scale(robot)))
            travel = show(self.records.branch(best)["travel"][joint])
            unit = units.angle if robot.revolute[joint] else units.length
            most = f"joint {joint + 1} by {travel} {unit}"
            yield f"{tried} {reach} can reach the end; taken is that with the least travel{name}: {most}"
        else:
            yield f"{tried} {reach} can reach the end: start from {start}{name}"

    def page(self) -> Iterator[bytes]:
        """A summary, and some rows."""
        from robokin.reports.number_columns import NumberColumns
        from robokin.reports.page_tables import heading, pairs, render

        robot, path, units = self.records.robot, self.records.path, self.records.units
        what = {"line": "a straight line", "arc": "an arc", "joint": "joint by joint"}[path.kind]
        entries = [
            ("steps", f"{path.steps}"),
            ("length", f"{show(path.length / units.metres)} {units.length}"),
            ("joint moves", "  ".join(show(value) for value in self.records.moves())),
            ("least manipulability", f"{self.records.least():.9g}"),
        ]
        if path.duration is not None:
            fastest = self.records.fastest()
            entries.insert(1, ("duration", f"{show(path.duration)} s"))
            for name in ("velocity", "acceleration"):
                entries.append((f"greatest {name}", "  ".join(f"{value:.6g}" for value in fastest[name])))
        if path.held is not None:
            entries.insert(
                1, ("held", "  ".join(f"{name} = {show(value)}" for name, value in self.records.held().items()))
            )
        entries += [("note", sentence) for sentence in self.notes()]
        rest = f"{what}, lengths in {units.length}, angles in {units.angle}"
        yield render(heading(robot.name, rest), "", pairs(entries))
        if robot.n <= WIDEST:
            q = self.records.joints()
            picked = np.unique(np.linspace(0, len(q) - 1, min(SHOWN, len(q))).round().astype(int))
            names = [f"q{i}" for i in range(1, robot.n + 1)]
            kinds = "".join("a" if turns else "l" for turns in robot.revolute)
            columns = NumberColumns([("t", 6)], names, kinds, units)
            lines = columns.lines(((f"{path.t[i]:.4f}",) for i in picked.tolist()), q[picked])
            yield f"\n{columns.heading}{lines}".encode()
