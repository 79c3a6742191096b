"""A robot or a tree in every form that `robokin convert` writes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from robokin.cli.statuses import say
from robokin.errors import InputError

if TYPE_CHECKING:
    from robokin.formats.tree_branches import TreeBranches
    from robokin.model import Robot, Tree
    from robokin.units import Units


def written_form(described: Robot | Tree, units: Units, kind: str, convention: Any = None) -> bytes:
    """A robot or a tree in a format and a convention, by default a robot's own; what has changed is said on stderr.

    Raises InputError.
    """
    from robokin.model import Tree

    if isinstance(described, Tree):
        return _of_tree(described, units, kind, convention)
    return _of_robot(described, units, kind, convention)


def _of_robot(robot: Robot, units: Units, kind: str, convention: Any) -> bytes:
    """The robot in a convention, by default its own, and in a format."""
    from robokin.kinematics.dh_table import to_convention

    made = to_convention(robot, convention or robot.convention)
    for note in made.notes[len(robot.notes) :]:
        say(str(note))
    return WRITERS[kind](replace(made, units=units), units)


def _of_tree(tree: Tree, units: Units, kind: str, convention: Any) -> bytes:
    """The tree in a format, the tables of its branches in a convention, by default frames."""
    tree = replace(tree, units=units)
    if kind == "urdf":
        from robokin.formats.written_tree_urdf import tree_urdf

        return tree_urdf(tree).encode()
    if kind in ("json", "jsonl"):
        from robokin.records.description_records import links_record
        from robokin.tables.written_rows import written

        if convention is not None:
            raise InputError(
                "--convention: found the document of a tree, which has no table, expected -f yaml, markdown, latex or "
                f"csv, or --tip with one of {tree.listed_tips()}"
            )
        record = links_record(tree, units)
        return b"".join(written(kind, record, [record], bytes, bytes))
    from robokin.formats.tree_branches import branches_of

    parts = branches_of(tree, convention or "frames")
    for note in parts.notes:
        say(str(note))
    if kind == "yaml":
        from robokin.formats.written_tree import written_tree

        _say_order([joint.name for joint in tree.joints], parts.order)
        return written_tree(parts).encode()
    return _branch_tables(parts, units, kind)


def _say_order(names: Sequence[str], order: Sequence[int]) -> None:
    """Say that joint values come in another order than before, where they do."""
    if [*order] != [*range(len(names))]:
        said = ", ".join(names[number] for number in order)
        say(f"the joint values are in another order than before: q is {said}")


def _branch_tables(parts: TreeBranches, units: Units, kind: str) -> bytes:
    """The tables of a tree's branches: Markdown, LaTeX or CSV."""
    from robokin.records.description_records import branch_records, tip_records
    from robokin.reports import table_files

    records, tips = branch_records(parts, units), tip_records(parts, units)
    if kind == "csv":
        for record in records:
            if ends := table_files.ends_in_short(record):
                say(f"a CSV has no place for {'; '.join(ends)} of {record['branch']}")
        return table_files.csv_branches(records)
    write = table_files.markdown_branches if kind == "markdown" else table_files.latex_branches
    return write(parts.tree.name or parts.tree.id, records, tips)


def _yaml(robot: Robot, units: Units) -> bytes:
    from robokin.formats.written_robot import row_order, written

    _say_order([joint.name for joint in robot.joints], row_order(robot))
    return written(robot).encode()


def _urdf(robot: Robot, units: Units) -> bytes:
    from robokin.model import CoupledRobot

    if isinstance(robot, CoupledRobot):
        from robokin.formats.part import tree_of
        from robokin.formats.written_tree_urdf import tree_urdf

        return tree_urdf(tree_of(robot)).encode()
    from robokin.formats.written_urdf import urdf_text

    return urdf_text(robot).encode()


def _table(name: str) -> Callable[[Robot, Units], bytes]:
    """The writer of a table, a function of `robokin.reports.table_files`."""

    def write(robot: Robot, units: Units) -> bytes:
        from robokin.records.description_records import robot_record
        from robokin.reports import table_files

        record = robot_record(robot, units)
        if name == "csv_table" and (ends := table_files.ends_in_short(record)):
            say(f"a CSV has no place for {'; '.join(ends)}")
        data: bytes = getattr(table_files, name)(record)
        return data

    return write


def _document(kind: str) -> Callable[[Robot, Units], bytes]:
    """The writer of the document, the same as that of `robokin show`."""

    def write(robot: Robot, units: Units) -> bytes:
        from robokin.records.description_records import robot_record
        from robokin.tables.written_rows import written

        record = robot_record(robot, units)
        return b"".join(written(kind, record, [record], bytes, bytes))

    return write


WRITERS: dict[str, Callable[[Robot, Units], bytes]] = {
    "yaml": _yaml,
    "urdf": _urdf,
    "markdown": _table("markdown_table"),
    "latex": _table("latex_table"),
    "csv": _table("csv_table"),
    "json": _document("json"),
    "jsonl": _document("jsonl"),
}
