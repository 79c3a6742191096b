"""The documents of the command line for Python: the same plain data that `robokin COMMAND … --json` prints.

Each function is named by its command, takes what the package's functions take (SI and radians), and gives what JSON
holds, in the description's units or in those that are asked for:

    robokin.documents.fk(robot, q)
    robokin.documents.ik(robot, T)["solutions"]
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path as File
from typing import TYPE_CHECKING, Any, Literal, cast

import numpy as np
from numpy.typing import ArrayLike

from robokin.arrays import Array
from robokin.brief import Answer
from robokin.errors import InputError
from robokin.expected import described, expect_choice, expect_finite, expect_flag, expect_kind
from robokin.model import Mechanism, Robot, Tree, WheeledBase, expect_robot
from robokin.units import Units

if TYPE_CHECKING:
    from robokin.grading.mark_items import Report
    from robokin.inverse.solutions import Question, Result
    from robokin.kinematics.velocity import Differential, TaskName

Document = dict[str, Any]

ORIENTATIONS = ("rpy", "quaternion", "euler", "matrix")


def document_of(value: Answer, units: Units | None = None) -> Any:
    """The document of an answer; a list of them for an answer to several questions.

    Of a robot, a mechanism, a wheeled base or a tree that of `robokin show`.
    Raises InputError for what is no answer.
    """
    from robokin.grading.class_statistics import ClassStatistics
    from robokin.inverse.joint_paths import Path
    from robokin.inverse.solutions import BatchResult, Result
    from robokin.inverse.tip_targets import TipAnswer
    from robokin.kinematics.singular import Singularities
    from robokin.kinematics.velocity import Differential
    from robokin.mobility.manoeuvrability import Manoeuvrability
    from robokin.mobility.verdict import Mobility
    from robokin.symbol_matrices import Symbols
    from robokin.workspace.workspace_result import Workspace

    own = None if units is None else expect_units(units)
    if isinstance(value, Robot | Mechanism | WheeledBase | Tree):
        return show(value, own)
    if isinstance(value, Symbols):
        return value.record(own)
    if isinstance(value, ClassStatistics):
        from robokin.records.statistics_records import statistics_record

        return statistics_record(value)
    if isinstance(value, Result | BatchResult):
        return _solutions(value, own)
    if isinstance(value, TipAnswer):
        from robokin.records.tip_solution_records import TipSolutionRecords

        return TipSolutionRecords(value, own or value.question.tree.units).document()
    if isinstance(value, Differential):
        return _differential(value, own)
    if isinstance(value, Singularities):
        return singular(value.robot, value.asked, own)
    if isinstance(value, Path):
        from robokin.records.path_records import PathRecords

        return PathRecords(value, own or value.robot.units).document()
    if isinstance(value, Workspace):
        from robokin.records.workspace_records import workspace_record

        return workspace_record(value, own or value.space.robot.units)
    if isinstance(value, Mobility):
        from robokin.records.freedom_records import mechanism_record

        return mechanism_record(value, own or value.mechanism.units, 0)
    if isinstance(value, Manoeuvrability):
        from robokin.records.freedom_records import wheeled_record

        return wheeled_record(value.base, value, own or value.base.units)
    return expect_kind(value, Answer, "value", "an answer of one of robokin's functions")


def expect_units(value: object) -> Units:
    """Units. Raises InputTypeError."""
    return cast(Units, expect_kind(value, Units, "units", "units, such as robokin.Units('mm', 'deg')"))


def show(entry: Robot | Mechanism | WheeledBase | Tree, units: Units | None = None) -> Document:
    """What `robokin show` says of a robot, a mechanism, a wheeled base or a tree. Raises InputTypeError."""
    from robokin.records.description_records import described_record

    if not isinstance(entry, Robot | Mechanism | WheeledBase | Tree):
        expect_kind(
            entry, Robot, "entry", "a robot, a mechanism or a wheeled base, as robokin.load(name_or_path) gives"
        )
    return described_record(entry, entry.units if units is None else expect_units(units))


def check(report: Report, feedback: str = "answer") -> Document:
    """What `robokin check` says of marks, as a level of feedback (verdict, part, distance, answer) tells it.

    Raises InputError.
    """
    from robokin.grading.feedback import LEVELS
    from robokin.grading.mark_items import Report
    from robokin.records.mark_records import report_record

    report = expect_kind(report, Report, "report", "marks, as robokin.mark_sheet gives them")
    return report_record(report, expect_choice(feedback, LEVELS, "feedback"))


def library() -> list[Document]:
    """What `robokin list` says: an entry for everything in the library."""
    from robokin.formats.library_index import library_entries
    from robokin.records.envelope import SCHEMA

    return [{"schema": SCHEMA, **entry.record()} for entry in library_entries()]


def validate(file: str | File) -> Document:
    """What `robokin validate` says of a file, or of a name of the library. Raises InputTypeError."""
    from robokin.records.description_records import file_record, verdict_of

    if not isinstance(file, str | File):
        expect_kind(file, str, "file", "a file's path or a name of the library")
    return file_record(str(file), verdict_of(str(file)))


def fk(
    robot: Robot, q: ArrayLike, frames: bool = False, orientation: str | None = None, units: Units | None = None
) -> Any:
    """What `robokin fk` says of joint values q: (n,) [rad | m], or a list of documents for (m, n).

    `frames` adds the frame after each row of the table, `orientation` another form of the rotation. Raises InputError.
    """
    from robokin.kinematics.forward import forward_kinematics, joint_values, row_frames
    from robokin.records.pose_records import PoseBlock, configuration_records, poses_in

    robot, frames = expect_robot(robot), expect_flag(frames, "frames")
    more = [] if orientation is None else [expect_choice(orientation, ORIENTATIONS, "orientation")]
    own = robot.units if units is None else expect_units(units)
    values = _configurations(joint_values(robot, q))
    rows = values.reshape(-1, robot.n)
    with np.errstate(over="ignore", invalid="ignore"):
        T = poses_in(forward_kinematics(robot, rows), own)
        at = poses_in(row_frames(robot, rows), own) if frames else None
    for poses in (T, at):
        if poses is not None and not np.isfinite(poses).all():
            raise InputError("q: the pose is too far away for a number, expected less")
    block = PoseBlock(1, _in_joint_units(robot, own, rows), robot.within_limits(rows), T, at)
    records = [*configuration_records(robot, own, block, more)]
    return records[0] if values.ndim == 1 else records


def ik(robot: Robot, T: ArrayLike, units: Units | None = None, explain: bool = False, **options: Any) -> Any:
    """What `robokin ik` says of a target T: (4, 4) [m], or a list of documents for (m, 4, 4).

    `explain` adds the steps of the closed form; `options` are those of `robokin.solve_ik`. Raises InputError.
    """
    from robokin.inverse.solve import solve_ik

    result = solve_ik(robot, T, **options)
    return _solutions(result, None if units is None else expect_units(units), expect_flag(explain, "explain"), options)


def jacobian(
    robot: Robot,
    q: ArrayLike,
    frame: Literal["base", "tool"] = "base",
    task: TaskName | None = None,
    units: Units | None = None,
) -> Any:
    """What `robokin jacobian` says of joint values q: (n,) [rad | m], or a list of documents for (m, n).

    Raises InputError.
    """
    from robokin.kinematics.velocity import differential_kinematics

    found = differential_kinematics(robot, q, frame, task)
    return _differential(found, None if units is None else expect_units(units))


def singular(robot: Robot, task: TaskName | None = None, units: Units | None = None) -> Document:
    """What `robokin singular` says of a robot. Raises InputError for one without joints."""
    from robokin.kinematics.singular import singular_configurations
    from robokin.records.singularity_records import singular_record

    own = expect_robot(robot).units if units is None else expect_units(units)
    return singular_record(robot, own, task, singular_configurations(robot, task))


def dof(entry: Robot | Mechanism | WheeledBase | Tree, units: Units | None = None) -> Document:
    """What `robokin dof` says of a robot, a mechanism, a wheeled base or a tree. Raises InputTypeError."""
    if isinstance(entry, Robot | Tree):
        from robokin.records.freedom_records import jointed_record

        return jointed_record(entry, entry.units if units is None else expect_units(units))
    if isinstance(entry, WheeledBase):
        from robokin.mobility.manoeuvrability import manoeuvrability_of

        return cast(Document, document_of(manoeuvrability_of(entry), units))
    from robokin.mobility.verdict import mobility_of

    return cast(Document, document_of(mobility_of(entry), units))


def workspace(robot: Robot, units: Units | None = None, **options: Any) -> Document:
    """What `robokin workspace` says of a robot; `options` are those of `robokin.analyse_workspace`.

    Raises InputError.
    """
    from robokin.workspace.analyse import analyse_workspace

    return cast(Document, document_of(analyse_workspace(robot, **options), units))


def place(robot: Robot, point: ArrayLike, seed: int = 0, units: Units | None = None) -> Document:
    """What `robokin workspace --at` says of a point: (3,) [m]. Raises InputError."""
    from robokin.records.workspace_records import place_record
    from robokin.workspace.place import at_point
    from robokin.workspace.space import space_of

    robot = expect_robot(robot)
    p = expect_finite(point, "point", "three finite numbers [m]", (3,))
    own = robot.units if units is None else expect_units(units)
    return place_record(at_point(space_of(robot), p, seed=seed), robot.id, own)


def frame(expression: str, units: Units | None = None) -> Document:
    """What `robokin frame` says of a transform expression in the units (by default metres and degrees).

    Raises ExpressionError for what cannot be read, InputError for a result that is too far away for a number.
    """
    from robokin.formats.number_expressions import Scope
    from robokin.formats.transform_expressions import evaluate_transform
    from robokin.records.envelope import envelope
    from robokin.records.pose_records import frame_record, poses_in

    expression = cast(str, expect_kind(expression, str, "expression", "a transform expression, such as 'Rot(z, 90)'"))
    own = Units(angle="deg") if units is None else expect_units(units)
    with np.errstate(over="ignore", invalid="ignore"):
        T = poses_in(evaluate_transform(expression, Scope(degrees=own.degrees), own, []), own)
    if not np.isfinite(T).all():
        raise InputError("expression: the result is too far away for a number, expected less")
    return {**envelope("expression", expression, own), **frame_record(T, own)}


def plot(
    what: Robot | Tree | Mechanism | Result,
    q: ArrayLike | None = None,
    frames: bool = False,
    units: Units | None = None,
) -> Document:
    """What `robokin plot` says of a robot or a tree at q: (n,) or (m, n) [rad | m], of solutions, or of a mechanism.

    Raises InputError.
    """
    own = None if units is None else expect_units(units)
    if isinstance(what, Mechanism):
        from robokin.pictures.drawn_mechanism import check_drawable
        from robokin.pictures.mechanism_scene import mechanism_scene
        from robokin.records.picture_records import drawn_record

        if q is not None:
            raise InputError("q: is for robots, expected none for a mechanism")
        check_drawable(what, None, "what")
        return drawn_record(mechanism_scene(what, None, None, own or what.units))
    from robokin.drawings import scene_with
    from robokin.records.picture_records import arms_record

    return arms_record(*scene_with(what, q, expect_flag(frames, "frames"), None, own))


def schema(command: str, check: str | None = None) -> Document:
    """The JSON Schema of a command's documents, as `robokin schema COMMAND` prints it. Raises InputError."""
    from robokin.records.schemas import document_schema

    expect_kind(command, str, "command", "a command's name, such as 'fk'")
    expect_kind(check, (str, type(None)), "check", "what is checked, such as 'ik', or None")
    return document_schema(command, check)


# What is shared -----------------------------------------------------------------------------------------------


def _configurations(q: Array) -> Array:
    if q.ndim > 2:
        raise InputError(f"q: found {described(q)}, expected (n,) or (m, n): a document for each configuration")
    return expect_finite(q, "q", "finite joint values")


def _in_joint_units(robot: Robot, units: Units, q: Array) -> Array:
    """Joint values (m, n) in the units, without the last digit's dust of a change of units."""
    from robokin.model.joint_units import in_units, joint_factors

    with np.errstate(over="ignore", invalid="ignore"):
        values = in_units(q, joint_factors(robot, units))
    if not np.isfinite(values).all():
        raise InputError("q: found a number that is too large for the unit, expected less")
    return values


def _solutions(
    result: Any, units: Units | None, explain: bool = False, options: Mapping[str, Any] | None = None
) -> Any:
    from robokin.inverse.solutions import Result

    if not isinstance(result, Result):
        return [_solutions(one, units, explain, options) for one in result]
    if result.question is None:
        raise InputError("this result does not know its question, expected one of robokin.solve_ik")
    return _solution_document(result, result.question, units or result.question.robot.units, explain, options or {})


def _solution_document(
    result: Result, question: Question, units: Units, explain: bool, options: Mapping[str, Any]
) -> Document:
    from robokin.records.solution_records import SolutionRecords

    robot = question.robot
    q = np.zeros((1, robot.n))
    q[0, [*question.hold]] = [*question.hold.values()]
    held = dict(zip(question.hold, _in_joint_units(robot, units, q)[0, [*question.hold]].tolist(), strict=True))
    document = SolutionRecords(robot, units, question.task, held).record(question.T, result)
    if explain:
        from robokin.records.worked_step_records import explanation_of

        arguments = {"task": question.task, "limits": question.limits}
        if options.get("near") is not None:
            arguments["near"] = np.asarray(options["near"], dtype=np.float64)
        document["explanation"] = explanation_of(robot, units, question.T, result, **arguments).record()
    return document


def _differential(found: Differential, units: Units | None) -> Any:
    from robokin.kinematics.velocity import block_of
    from robokin.records.jacobian_records import JacobianRecords

    robot, q = found.robot, _configurations(found.q)
    own = units or robot.units
    maker = JacobianRecords(robot, own, found.frame, found.task.name)
    rows = q.reshape(-1, robot.n)
    whole = block_of(found)
    records = [*maker.records(_in_joint_units(robot, own, rows), whole)]
    return records[0] if q.ndim == 1 else records
