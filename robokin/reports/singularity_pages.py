"""The singular configurations of an arm for eyes."""

from __future__ import annotations

from collections.abc import Sequence

from robokin.kinematics.singular import Singularity
from robokin.model import Robot
from robokin.number_text import show
from robokin.records.singularity_records import singularity_record, value_texts
from robokin.reports.page_parts import Part
from robokin.units import Units


def singularity_page(robot: Robot, units: Units, task: str, found: Sequence[Singularity]) -> bytes:
    """All conditions for a task, a paragraph each."""
    from robokin.reports.page_tables import render

    return render(*singularity_parts(robot, units, task, found))


def singularity_parts(robot: Robot, units: Units, task: str, found: Sequence[Singularity]) -> list[Part]:
    """The same as the parts of a page."""
    from robokin.reports.page_tables import heading, pairs

    what = "" if task == "pose" else f"of the {task}, "
    parts: list[Part] = [heading(robot.name, f"{what}lengths in {units.length}, angles in {units.angle}")]
    if not found:
        parts += ["", "no singular configuration was found"]
    for one in found:
        record = singularity_record(robot, units, one)
        entries = []
        if len(one.values):
            notes = [
                f" ({', '.join(filter(None, [posture, '' if inside else 'outside the limits']))})"
                if posture or not inside
                else ""
                for posture, inside in zip(one.posture, one.inside, strict=True)
            ]
            for i, (text, note) in enumerate(zip(value_texts(robot, units, one), notes, strict=True)):
                entries.append(("where" if i == 0 else "or", f"{text}{note}"))
        elif one.equation is not None and one.equation.lettered:
            entries.append(("where", one.equation.lettered))
            entries.append(("", record["condition"].partition(": ")[2]))
        else:
            entries.append(("where", record["condition"]))
        outside = "" if record["example_within_limits"] else "  (outside the limits)"
        entries.append(("such as", f"{'  '.join(show(value) for value in record['example'])}{outside}"))
        entries += [("lost" if i == 0 else "", lost.words) for i, lost in enumerate(one.lost)]
        parts += ["", heading(one.name), pairs(entries)]
    return parts
