"""Data frames for Python: the tables that the shell reads and writes as CSV, with pandas where it is installed.

What is read may be a frame of pandas or of polars, a table of pyarrow, a row of pandas, or a dict: columns are found by
their names, in any order, as in a CSV. What is made is a frame of pandas. Without `units` all of it is in metres and
radians, as arrays are; with units, headings say them (`q1 [deg]`), so that it is read again as what it is.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from robokin.arrays import Array
from robokin.brief import Answer
from robokin.documents import expect_units
from robokin.errors import InputError, RobokinError
from robokin.expected import described, expect_choice, expect_columns, expect_kind, expect_numbers, has_names, names_of
from robokin.grading.class_statistics import ClassStatistics
from robokin.grading.mark_items import Report
from robokin.inverse.joint_paths import Path
from robokin.inverse.solutions import BatchResult, Result
from robokin.inverse.solve import solve_ik
from robokin.kinematics.flat_arm import flat_arm
from robokin.kinematics.forward import forward_kinematics
from robokin.kinematics.velocity import Differential, block_of
from robokin.model import Robot, Tree, expect_robot
from robokin.model.joint_units import joint_factors
from robokin.records.jacobian_records import JacobianRecords
from robokin.records.mark_records import report_rows
from robokin.records.path_records import PathRecords
from robokin.records.pose_records import poses_in
from robokin.records.statistics_records import statistics_rows
from robokin.reports import jacobian_report, solution_report
from robokin.tables.headings import FoundColumns
from robokin.tables.joint_columns import JointColumns
from robokin.tables.near_targets import BadRowError
from robokin.tables.orientations import ORIENTATIONS, pose_columns, pose_table
from robokin.tables.pose_columns import PLACES, PoseColumns, poses_from_rows
from robokin.tables.wanted_columns import Wanted, factors
from robokin.units import Units

EXPECTED = "a data frame, a row of one, or a dict, whose columns have names"


def joints(robot: Robot | Tree, table: Any, units: Units | None = None, argument: str = "table") -> Array:
    """The joint values (m, n) [rad | m] of a table, or (n,) of a row, by the names of its columns.

    Names are as in a CSV: q1, q2, … or joint_1, …, or the joints' names; `q1 [deg]` is in that unit, and a plain name
    in `units`, by default radians and metres. Other columns are passed over. `argument` stands in messages. Raises
    InputError where a column is missing, or holds what is no number.
    """
    if not isinstance(robot, Tree):
        robot = expect_robot(robot)
    expect_kind(argument, str, "argument", "the name of an argument")
    own = Units() if units is None else expect_units(units)
    values = _columns(JointColumns(robot, own), table, argument)[0]
    return np.asarray(values * joint_factors(robot, own))


def poses(
    table: Any, units: Units | None = None, robot: Robot | None = None, task: str = "pose", argument: str = "table"
) -> Array:
    """The poses (m, 4, 4) [m] of a table, or (4, 4) of a row, by the names of its columns.

    Names are as in a CSV: x, y, z with roll, pitch, yaw or qw, qx, qy, qz, … or m11 to m44; of a planar `robot`
    x, y, phi too. x, y, z alone say no orientation, and will do for the task "position" only. Units are those of
    `joints`. Raises InputError.
    """
    expect_kind(argument, str, "argument", "the name of an argument")
    own = Units() if units is None else expect_units(units)
    plane = None if robot is None else flat_arm(expect_robot(robot))
    values, found = _columns(PoseColumns(own, None, plane), table, argument)
    if found.way.kind in PLACES and task != "position":
        said = f"found {', '.join(found.way.names)} without an orientation"
        raise InputError(f"{argument}: {said}, expected columns of one too, or the task 'position'")
    rows = np.atleast_2d(values)
    try:
        T = poses_from_rows(rows, found.way.kind, own, plane)
    except BadRowError as error:
        raise InputError(f"{argument}, row {error.row}: {error.sentence}") from None
    return T if values.ndim > 1 else np.asarray(T[0])


def fk(robot: Robot, q: Any, orientation: str = "rpy", units: Units | None = None) -> Any:
    """Poses as a frame with the columns of `robokin fk -f csv`, at q: (m, n) [rad | m], or at a table by its columns.

    orientation: rpy, quaternion, quaternion-xyzw, euler, rotvec, abc or wpr, as `--as` has them.
    Of a table the index is kept, and other columns stand in front. Raises InputError.
    """
    robot = expect_robot(robot)
    expect_choice(orientation, ORIENTATIONS, "orientation")
    own = Units() if units is None else expect_units(units)
    given = q if has_names(q) else None
    values = np.atleast_2d(joints(robot, q, argument="q") if given is not None else _block(robot, q))
    T = poses_in(forward_kinematics(robot, values), own)
    columns = np.concatenate([values / joint_factors(robot, own), pose_table(T, orientation, own)], axis=1) + 0.0
    kinds = _joint_kinds(robot) + "lll" + ("aaa" if ORIENTATIONS[orientation].angles else "uuuu")
    names = [*_joint_names(robot), *pose_columns(orientation)]
    made = _frame(_said(names, kinds, own), columns)
    return made if given is None else _behind(made, given, np.arange(len(values)))


def ik(robot: Robot, T: Any, units: Units | None = None, **options: Any) -> Any:
    """All solutions as a frame with the columns of `robokin ik -f csv`, for poses T: (m, 4, 4) [m], or of a table.

    `options` are those of `robokin.solve_ik`; a table of x, y, z alone asks for positions. Of a table each solution has
    the index of its target, and other columns stand in front. Raises InputError.
    """
    robot = expect_robot(robot)
    own = Units() if units is None else expect_units(units)
    if has_names(T) and "task" not in options:
        kind = _columns(PoseColumns(Units(), None, flat_arm(robot)), T, "T")[1].way.kind
        options["task"] = "position" if kind in PLACES else "pose"
    result = solve_ik(robot, T, **options)
    made = of(result, own)
    return _behind(made, T, made["target"].to_numpy() - 1) if has_names(T) else made


def of(answer: Answer | Report, units: Units | None = None) -> Any:
    """An answer as a frame with the columns of its CSV: solutions, a path, Jacobians, marks, a class's statistics.

    Raises InputError.

    Lengths and angles are in the units, by default metres and radians; marks are in those of the report.
    """
    own = Units() if units is None else expect_units(units)
    if isinstance(answer, Result):
        return _solutions([answer], answer.question, own)
    if isinstance(answer, BatchResult):
        return _solutions(answer, answer.question, own)
    if isinstance(answer, Path):
        records = PathRecords(answer, own)
        own_kinds = _joint_kinds(answer.robot)
        kinds = "u" + own_kinds + "lllaaa" + "u" * (2 * answer.robot.n if records.timed else 0)
        return _frame(_said(records.columns(), kinds, own), records.rows())
    if isinstance(answer, Differential):
        return _jacobians(answer, own)
    if isinstance(answer, Report):
        names, rows = report_rows(answer)
        return _pandas().DataFrame(rows, columns=names)
    if isinstance(answer, ClassStatistics):
        names, rows = statistics_rows(answer)
        return _pandas().DataFrame(rows, columns=names)
    expect_kind(answer, Result, "answer", "solutions, a path, Jacobians or marks: other answers are no tables")
    return None


# What is read -------------------------------------------------------------------------------------------------


def _columns(wanted: Wanted, table: Any, argument: str) -> tuple[Array, FoundColumns]:
    """The wanted numbers (m, k) of a table, or (k,) of a row, in the wanted units, and where they stand."""
    if not has_names(table):
        raise InputError(f"{argument}: found {described(table)}, expected {EXPECTED}")
    names = names_of(table)
    try:
        found = wanted.headed([str(name) for name in names])
    except RobokinError as error:
        raise InputError(f"{argument}: {error}") from None
    values = expect_columns(table, found.places, argument)
    scale = factors(found, wanted.units)
    return (values if scale is None else values * scale), found


def _block(robot: Robot, q: ArrayLike) -> Array:
    values = expect_numbers(q, "q", f"joint values (m, {robot.n}), or a table with a column for each joint")
    if values.ndim not in (1, 2):
        raise InputError(f"q: found {described(values)}, expected ({robot.n},) or (m, {robot.n})")
    return values


# What is made -------------------------------------------------------------------------------------------------


def _pandas() -> ModuleType:
    """The library, where it is installed. Raises RobokinError."""
    try:
        import pandas  # type: ignore[import-untyped,unused-ignore]
    except ImportError:
        raise InputError("a data frame needs pandas, expected it to be installed: pip install pandas") from None
    return pandas  # type: ignore[no-any-return,unused-ignore]


def _joint_names(robot: Robot) -> list[str]:
    return [f"q{i}" for i in range(1, robot.n + 1)]


def _joint_kinds(robot: Robot) -> str:
    return "".join("a" if turns else "l" for turns in robot.revolute)


def _said(names: Sequence[str], kinds: str, units: Units) -> list[str]:
    """Headings with the units of lengths and angles, but for metres and radians."""
    unit = {
        "l": "" if units.length == "m" else f" [{units.length}]",
        "a": "" if units.angle == "rad" else f" [{units.angle}]",
    }
    return [f"{name}{unit.get(kind, '')}" for name, kind in zip(names, kinds.ljust(len(names), "u"), strict=True)]


def _frame(names: Sequence[str], columns: Array) -> Any:
    return _pandas().DataFrame(columns, columns=names)


def _behind(made: Any, given: Any, rows: Array | Any) -> Any:
    """A frame behind the other columns of the table that was asked, a row of it for each of its own, with its index."""
    if isinstance(given, dict):
        cells = {name: np.atleast_1d(cell) for name, cell in given.items()}
        if {column.shape for column in cells.values()} != {(len(next(iter(cells.values()))),)}:
            raise InputError("the dict has columns of different lengths, expected one length")
        given = _pandas().DataFrame(cells)
    if not hasattr(given, "columns"):
        given = given.to_frame().T
    if not hasattr(given, "iloc"):  # polars and pyarrow
        given = given.to_pandas()
    front = given.iloc[rows]
    made = made.set_axis(front.index, axis=0)
    known = {name.partition(" [")[0] for name in made.columns}
    kept = [i for i, name in enumerate(given.columns) if str(name).partition(" [")[0] not in known]
    return _pandas().concat([front.iloc[:, kept], made], axis=1)


def _solutions(results: Sequence[Result] | BatchResult, question: Any, units: Units) -> Any:
    """A row a solution; of a target without one a row with the reason."""
    if question is None:
        raise InputError("answer: this result does not know its question, expected one of robokin.solve_ik")
    robot: Robot = question.robot
    scale = joint_factors(robot, units)
    rows: list[Mapping[str, Any]] = []
    names = _said(solution_report.csv_columns(robot), "uu" + _joint_kinds(robot) + "uulau", units)
    for target, result in enumerate(results, start=1):
        for k, one in enumerate(result, start=1):
            errors = (one.position_error / units.metres, one.angle_error / units.radians)
            q = (one.q / scale + 0.0).tolist()
            rows.append(dict(zip(names, [target, k, *q, one.branch, one.within_limits, *errors, ""], strict=True)))
        if not result:
            nothing = [np.nan] * robot.n
            cells = [target, 0, *nothing, "", None, np.nan, np.nan, result.reason or ""]
            rows.append(dict(zip(names, cells, strict=True)))
    return _pandas().DataFrame(rows, columns=names)


def _jacobians(found: Differential, units: Units) -> Any:
    """A row a configuration: joint values, the matrix row by row, rank, singular values, manipulability, condition."""
    robot, count = found.robot, found.jacobian.shape[-1]
    block = found if found.q.ndim == 2 else block_of(found)
    records = JacobianRecords(robot, units, found.frame, found.task.name)
    sigma = [f"sigma{i}" for i in range(1, block.singular_values.shape[-1] + 1)]
    names = [*jacobian_report.joint_and_matrix_columns(count), "rank", *sigma, "manipulability", "condition"]
    parts: list[Array] = [block.q / joint_factors(robot, units), records.matrices(block).reshape(len(block.q), -1)]
    parts += [
        np.asarray(block.rank[:, None], dtype=np.float64),
        block.singular_values,
        records.volumes(block)[:, None],
        block.condition[:, None],
    ]
    made = _frame(_said(names, _joint_kinds(robot), units), np.concatenate(parts, axis=1) + 0.0)
    return made.astype({"rank": "int64"})
