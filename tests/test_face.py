"""The package as Python sees it: short `repr`s, the shell's documents, and a sentence for whatever is wrong."""

from __future__ import annotations

import dataclasses
import doctest
import inspect
import io
import itertools
import json
import pickle
import re
import subprocess
import sys
import tempfile
from fractions import Fraction
from pathlib import Path

import documentation
import numpy as np
import pytest
from sweeps import sweep

import robokin
from robokin import InputError, RobokinError, Units
from robokin.grading import grade_poses

PUMA = robokin.load("puma560")
PLANAR = robokin.load("planar2r")
HAND = robokin.load_tree("human-hand")
FOUR_BAR = robokin.load_mechanism("four-bar")
HAND = robokin.load_tree("human-hand")
CAR = robokin.load_wheeled("car")
Q = np.radians([10.0, -50.0, 100.0, 20.0, 30.0, 40.0])
T = robokin.forward_kinematics(PUMA, Q)
PLANAR_T = robokin.forward_kinematics(PLANAR, [0.3, 0.4])
SHEET_OF_QUESTIONS = robokin.question_sheet(PLANAR, "fk,dof", seed=7, students=["Ann", "Ben"], name="week3")
PLACE = tempfile.TemporaryDirectory()
SHEET_OF_QUESTIONS.write(f"{PLACE.name}/week3")
KEY, ANSWERS = f"{PLACE.name}/week3/key", f"{PLACE.name}/week3/key/answers.csv"
FORM = f"{PLACE.name}/week3/students/Ann/answers.csv"
MARKS = robokin.mark_sheet(KEY, ANSWERS, budget=None)
IIWA = robokin.load("iiwa14")
IIWA_T = robokin.forward_kinematics(IIWA, np.ones(7))


def test_a_result_is_a_sequence_of_its_solutions():
    result = robokin.solve_ik(PUMA, T)
    assert len(result) == len(result.solutions) > 1
    assert [*result] == [*result.solutions]
    assert result[0] is result.solutions[0]
    assert result[-1] is result.solutions[-1]
    assert result[1:3] == result.solutions[1:3]
    assert any(np.allclose(one.q, Q) for one in result)
    assert not robokin.solve_ik(PUMA, np.diag([1.0, 1.0, 1.0, 1.0]) + 9.0 * np.eye(4, k=3))
    with pytest.raises(IndexError, match=f"solution 99 of {len(result)}$"):
        result[99]
    with pytest.raises(IndexError, match="solution 0 of 0: out of reach"):
        robokin.solve_ik(PUMA, np.diag([1.0, 1.0, 1.0, 1.0]) + 9.0 * np.eye(4, k=3))[0]


def test_a_batch_gives_the_answer_of_each_target():
    batch = robokin.solve_ik(PUMA, np.stack([T, T]))
    assert len(batch) == 2
    assert np.array_equal(batch[-1][0].q, batch[np.int64(0)][0].q)
    for wrong in ("0", 1.0, None, slice(2)):
        with pytest.raises((InputError, TypeError), match="expected the number of a target"):
            batch[wrong]


# Short -----------------------------------------------------------------------------------------------------------


def public_values():
    yield from (PUMA.table, PLANAR.table, robokin.singular_configurations(PLANAR), robokin.pose_parts(T))
    yield grade_poses(PUMA, [Q, Q], [T, T])
    result = robokin.solve_ik(PUMA, robokin.forward_kinematics(PUMA, [0.1, -0.8, 1.7, 0, 0, 0]))
    yield from (PUMA, PUMA.rows[0], FOUR_BAR, FOUR_BAR.joints[0], CAR, CAR.wheels[0], PUMA.units, HAND)
    yield from (result, result[0], *result.families, *(arc for family in result.families for arc in family.arcs))
    yield from (result.question, robokin.solve_ik(PUMA, [T, T]), robokin.load("human-body"))
    tips = robokin.solve_tips(HAND, {"index": robokin.tip_poses(HAND, HAND.poses["pinch"])[1]})
    yield from (tips, tips.groups[0], tips.question, *tips.groups[0].result)
    yield from robokin.singular_configurations(PLANAR)
    path = robokin.interpolate_joints(PUMA, Q, Q + 0.5, 200)
    yield from (path, *path.events, robokin.follow_line(PLANAR, [0.3, 0.4], robokin.forward_kinematics(PLANAR, [1, 1])))
    found = robokin.differential_kinematics(PUMA, Q)
    yield from (found, found.task, robokin.differential_kinematics(PUMA, np.tile(Q, (50, 1))))
    workspace = robokin.analyse_workspace(PLANAR, samples=64, dextrous=True)
    yield from (workspace, workspace.space, workspace.measure, workspace.extent, workspace.dexterity)
    yield from (robokin.mobility_of(FOUR_BAR), robokin.manoeuvrability_of(CAR), robokin.symbols(PLANAR))
    yield from (robokin.draw(PLANAR, kind="text"), robokin.notebook.matrix(T), robokin.default_tolerance(PUMA))
    yield robokin.check_pose(PUMA, Q, T)
    yield from (SHEET_OF_QUESTIONS, MARKS, robokin.statistics_of(MARKS))


@pytest.mark.parametrize("value", [*public_values()], ids=lambda value: type(value).__name__)
def test_a_repr_is_a_line_or_a_few(value):
    text = repr(value)
    assert 5 < len(text) < 500
    assert text.count("\n") < 5
    assert " object at 0x" not in text


def test_every_public_value_is_a_table_in_a_notebook():
    for value in public_values():
        if type(value).__name__ in ("Units", "Tolerance", "Wheel", "Measure"):  # a line says them
            continue
        html = value._repr_html_()
        assert html is None or html.startswith("<"), type(value)
        assert html is not None or value.kind in ("svg", "png", "pdf")


def test_the_table_of_a_robot_is_what_the_shell_shows():
    table = PUMA.table
    out = io.BytesIO()
    documentation.robokin(["show", "puma560"], b"", out, io.BytesIO())
    assert out.getvalue().decode().startswith(f"{table}\n")
    assert len(table) == 6
    assert table[1] == PUMA.record()["rows"][1]
    assert [row["name"] for row in table] == [joint.name for joint in PUMA.rows]
    assert "4 more rows" in repr(table)
    assert "3 more rows" not in repr(PLANAR.table)
    with pytest.raises(IndexError):
        table[6]
    for name in ("panda", "scara-frames", "assembly", "puma560-craig"):
        assert str(robokin.load(name).table).count("\n") >= 1 + len(robokin.load(name).rows)


def test_a_block_of_answers_is_a_sequence():
    block = robokin.differential_kinematics(PUMA, np.stack([Q, 2 * Q, 3 * Q]))
    assert len(block) == 3
    assert np.array_equal(block[-1].jacobian, robokin.jacobian(PUMA, 3 * Q))
    assert len(block[1:]) == 2
    assert [one.record() for one in block] == block.record()
    single = block[0]
    assert single
    for wrong in (lambda: len(single), lambda: single[0], lambda: block["0"]):
        with pytest.raises(TypeError, match="expected"):
            wrong()
    path = robokin.interpolate_joints(PLANAR, [0, 0], [1, 1], 4)
    assert np.array_equal(path[-1], [1, 1])
    assert np.array_equal([*path], path.q)
    assert path[1:3].shape == (2, 2)
    report = grade_poses(PUMA, [Q, Q], [T, np.eye(4)])
    assert (len(report), report[0].status, [item.passed for item in report]) == (2, "pass", [True, False])
    assert repr(report) == "<check fk of puma560: 1 of 2 answers right, score 0.5>"


def test_singular_conditions_are_a_tuple_with_the_shells_document():
    found = robokin.singular_configurations(PUMA)
    assert isinstance(found, tuple)
    assert found.record() == robokin.documents.singular(PUMA)
    assert repr(found) == "<3 singular conditions of puma560: shoulder, elbow, wrist>"
    again = pickle.loads(pickle.dumps(found))
    assert (repr(again), again.asked, len(again)) == (repr(found), None, 3)
    assert robokin.singular_configurations(PUMA, "position").record()["task"] == "position"


def test_what_results_hold_is_brief_too():
    def walk(value, depth=0):
        if dataclasses.is_dataclass(value) and not isinstance(value, type):
            assert len(repr(value)) < 500, type(value)
            for part in dataclasses.fields(value) if depth < 6 else ():
                walk(getattr(value, part.name), depth + 1)
        for item in value[:5] if isinstance(value, tuple | list) else ():
            walk(item, depth + 1)

    for value in public_values():
        walk(value)
    for name in ("parallel-four-bar", "four-bar-by-lengths", "gear-pair"):
        walk(robokin.mobility_of(robokin.load_mechanism(name)))


@pytest.mark.parametrize(
    "value", [PUMA, FOUR_BAR, CAR, HAND, robokin.solve_ik(PUMA, T)[0], robokin.default_tolerance(PUMA)]
)
def test_values_are_frozen(value):
    with pytest.raises(AttributeError):
        value.name = "another"
    assert repr(pickle.loads(pickle.dumps(value))) == repr(value)


def test_html_holds_no_markup_of_others(tmp_path):
    evil = "<script>alert(1)</script>"
    path = tmp_path / "arm.yaml"
    path.write_text(
        f"robokin: 1\nname: {evil}\njoints:\n  - {{name: '{evil}', type: R, a: 1}}\n  - {{type: R, a: 1}}\n"
    )
    robot = robokin.load(path)
    joint = f"{{name: A, type: revolute, links: ['{evil}', b], at: [0, 0]}}"
    path.write_text(f"robokin: 1\nname: {evil}\nspace: planar\nlinks: ['{evil}', b]\njoints:\n  - {joint}\n")
    mechanism = robokin.load_mechanism(path)
    shown = [
        robot, mechanism, robokin.solve_ik(robot, robokin.forward_kinematics(robot, [0.1, 0.2])),
        robokin.symbols(robot),
        robokin.differential_kinematics(robot, [0.1, 0.2]), robokin.interpolate_joints(robot, [0, 0], [1, 1], 3),
        robokin.analyse_workspace(robot, samples=64), robokin.mobility_of(mechanism), robokin.draw(robot, kind="text"),
        robokin.draw(robot, kind="html"), robokin.notebook.matrix(T), CAR, robokin.manoeuvrability_of(CAR),
        robokin.solve_ik(robot, [np.eye(4), np.eye(4)]),
        robokin.solve_tips(HAND, {"index": np.eye(4)}, "position"),
    ]  # fmt: skip
    for value in shown:
        html = value._repr_html_()
        assert "<script" not in html, type(value)
        assert html.startswith("<")


# The shell's documents -------------------------------------------------------------------------------------------


def shell(*words):
    """The document that the shell prints."""
    out = io.BytesIO()
    documentation.robokin([*map(str, words), "--json"], b"", out, io.BytesIO())
    return json.loads(out.getvalue())


def typed(robot, *values):
    """Joint values as the shell turns them into SI."""
    return np.array(values) * np.where(robot.revolute, robot.units.radians, robot.units.metres)


HOME = typed(PUMA, 90.0, 0.0, 90.0, 0.0, 0.0, 0.0)
SCARA = robokin.load("scara")
PANDA = robokin.load("panda")
MM_DEG, M_RAD = Units("mm", "deg"), Units("m", "rad")
TARGET = robokin.transform("Trans(500,100,300) RPY(180,0,45)", MM_DEG)
DOCUMENTS = {
    "list": (["list"], lambda: robokin.documents.library()),
    "show": (["show", "puma560"], PUMA.record),
    "show in units": (["show", "puma560", "--length", "m", "--angle", "rad"], lambda: PUMA.record(M_RAD)),
    "show a mechanism": (["show", "four-bar"], FOUR_BAR.record),
    "show a base": (["show", "car"], CAR.record),
    "validate": (["validate", "puma560"], lambda: [robokin.documents.validate("puma560")]),
    "validate nothing": (["validate", "no/such.yaml"], lambda: [robokin.documents.validate("no/such.yaml")]),
    "fk": (["fk", "puma560", "--q", "home"], lambda: robokin.documents.fk(PUMA, PUMA.poses["home"])),
    "fk with all": (
        ["fk", "scara", "--q", "10,20,0.0305,40", "--frames", "--as", "euler", "--length", "m"],
        lambda: robokin.documents.fk(SCARA, typed(SCARA, 10, 20, 30.5, 40), True, "euler", Units("m", "deg")),
    ),
    "fk of several": (
        ["fk", "planar2r", "--q", "10,20", "--q", "30,40"],
        lambda: robokin.documents.fk(PLANAR, [typed(PLANAR, 10, 20), typed(PLANAR, 30, 40)]),
    ),
    "symbols": (
        ["fk", "anthropomorphic", "--symbolic"],
        lambda: robokin.symbols(robokin.load("anthropomorphic")).record(),
    ),
    "ik": (
        ["ik", "puma560", "--pose", "Trans(500,100,300) RPY(180,0,45)"],
        lambda: robokin.solve_ik(PUMA, TARGET).record(),
    ),
    "ik with all": (
        ["ik", "puma560", "--pose", "Trans(500,100,300) RPY(180,0,45)", "--no-limits", "--explain", "--angle", "deg"],
        lambda: robokin.documents.ik(PUMA, TARGET, explain=True, limits=False),
    ),
    "ik with a joint held": (
        ["ik", "panda", "--pose", "Trans(400,0,400) RPY(180,0,0)", "--hold", "q7=20"],
        lambda: robokin.solve_ik(
            PANDA, robokin.transform("Trans(400,0,400) RPY(180,0,0)", MM_DEG), hold={6: np.radians(20.0)}
        ).record(),
    ),
    "ik out of reach": (
        ["ik", "planar2r", "--xyz", "9,9,0"],
        lambda: robokin.documents.ik(PLANAR, robokin.transform("Trans(9,9,0)"), task="position"),
    ),
    "ik of several tips": (
        ["ik", "human-hand", "--target", "index=Trans(150,30,-60) RPY(-90,66,7.6)", "--target", "little=110,-34,-50"],
        lambda: robokin.solve_tips(
            HAND,
            {
                "index": robokin.transform("Trans(150,30,-60) RPY(-90,66,7.6)", MM_DEG),
                "little": robokin.transform("Trans(110,-34,-50)", MM_DEG),
            },
            {"little": "position"},
        ).record(),
    ),
    "jacobian": (["jacobian", "puma560", "--q", "home"], lambda: robokin.documents.jacobian(PUMA, PUMA.poses["home"])),
    "jacobian of several": (
        ["jacobian", "planar2r", "--q", "0,0", "--q", "10,20", "--frame", "tool"],
        lambda: robokin.differential_kinematics(PLANAR, [[0, 0], typed(PLANAR, 10, 20)], "tool").record(),
    ),
    "singular": (["singular", "planar3r"], lambda: robokin.documents.singular(robokin.load("planar3r"))),
    "path": (
        ["path", "puma560", "--from", "home", "--to", "80,10,90,0,10,0", "--steps", "4"],
        lambda: robokin.interpolate_joints(PUMA, PUMA.poses["home"], typed(PUMA, 80, 10, 90, 0, 10, 0), 4).record(),
    ),
    "workspace": (
        ["workspace", "planar2r", "--samples", "64", "--dextrous"],
        lambda: robokin.analyse_workspace(PLANAR, samples=64, dextrous=True).record(),
    ),
    "a place": (["workspace", "planar2r", "--at", "1,0.5,0"], lambda: robokin.documents.place(PLANAR, [1, 0.5, 0])),
    "dof": (["dof", "four-bar"], lambda: robokin.mobility_of(FOUR_BAR).record()),
    "dof of a robot": (["dof", "puma560"], lambda: robokin.documents.dof(PUMA)),
    "dof of a base": (["dof", "car"], lambda: robokin.manoeuvrability_of(CAR).record()),
    "frame": (["frame", "Trans(1,2,3) Rot(z,90)"], lambda: robokin.documents.frame("Trans(1,2,3) Rot(z,90)")),
    "plot": (["plot", "puma560", "--frames"], lambda: robokin.documents.plot(PUMA, frames=True)),
    "plot at several": (
        ["plot", "planar2r", "--q", "10,20", "--q", "30,40"],
        lambda: robokin.documents.plot(PLANAR, [typed(PLANAR, 10, 20), typed(PLANAR, 30, 40)]),
    ),
    "plot of solutions": (
        ["plot", "puma560", "--ik", "Trans(500,100,300) RPY(180,0,45)"],
        lambda: robokin.documents.plot(robokin.solve_ik(PUMA, TARGET)),
    ),
    "plot of a tree": (["plot", "human-hand", "--frames"], lambda: robokin.documents.plot(HAND, frames=True)),
    "plot of a mechanism": (["plot", "bennett"], lambda: robokin.documents.plot(robokin.load_mechanism("bennett"))),
    "schema": (["schema", "fk"], lambda: robokin.documents.schema("fk")),
}


@pytest.mark.parametrize("name", DOCUMENTS)
def test_python_gives_the_document_that_the_shell_prints(name):
    words, made = DOCUMENTS[name]
    document = made()
    assert json.loads(json.dumps(document, allow_nan=False)) == shell(*words)


# Wrong types and wrong values ------------------------------------------------------------------------------------

WRONG = [
    None, 3, -1, 2.5, True, "puma560", "", b"x", [], [[]], [1, [2]], ["a"], [1.0, "2"], {}, {1: 2}, {1, 2}, object(),
    np.nan, np.inf, 1j, [1j] * 6, np.full(6, np.nan), np.full((4, 4), np.inf), np.eye(3), np.zeros((2, 3, 4)),
    np.array([None] * 6), np.array(["1"] * 6), np.array([True] * 6), np.ma.masked_array(np.zeros(6), mask=[1] * 6),
    np.zeros(0), np.array(5.0), 10**400, [10**400] * 6, Fraction(1, 3), PUMA, FOUR_BAR, CAR, int, lambda: 0, Path("x"),
    np.datetime64("2020-01-01"), np.array(["2020-01-01"] * 6, dtype="datetime64[D]"), range(6), iter([1]), 1e308,
    np.full(6, 1e308), Units("mm", "deg"), robokin.solve_ik(PLANAR, PLANAR_T), "pose", "Trans(1", "svg", (1, 2),
]  # fmt: skip
RIGHT = {
    "load": {"name_or_path": "puma560", "tip": "tool", "root": None, "exact": False},
    "load_tree": {"name_or_path": "human-hand", "exact": False},
    "tip_poses": {"tree": HAND, "q": np.zeros(21)},
    "load_mechanism": {"name_or_path": "four-bar"},
    "load_wheeled": {"name_or_path": "car"},
    "forward_kinematics": {"robot": PUMA, "q": Q, "cores": 1},
    "link_frames": {"robot": PUMA, "q": Q},
    "jacobian": {"robot": PUMA, "q": Q, "frame": "tool", "cores": 1},
    "differential_kinematics": {"robot": PUMA, "q": Q, "frame": "base", "task": "pose"},
    "singular_configurations": {"robot": PLANAR, "task": None},
    "solve_ik": {
        "robot": PLANAR, "T": PLANAR_T, "limits": True, "near": [0.0, 0.0], "method": "auto", "task": "pose", "most": 2,
        "seed": 0, "turns": False, "hold": {0: 0.3}, "cores": 1,
    },
    "solve_tips": {
        "tree": HAND, "targets": {"index": robokin.tip_poses(HAND, HAND.poses["pinch"])[1]}, "task": "position",
        "limits": True, "near": np.zeros(21), "most": 2, "seed": 0,
    },
    "swivel_angle": {"robot": IIWA, "q": np.zeros(7)},
    "swivel_solutions": {"robot": IIWA, "T": IIWA_T, "swivel": 0.2, "limits": True},
    "follow_line": {"robot": PLANAR, "start": [0.3, 0.4], "T": PLANAR_T, "steps": 2, "limits": True, "task": None},
    "interpolate_joints": {"robot": PLANAR, "start": [0.3, 0.4], "end": [0.5, 0.6], "steps": 2, "limits": True},
    "trajectory": {
        "robot": PLANAR, "points": [[0.3, 0.4], [0.5, 0.6]], "duration": 2.0, "profile": "cubic", "max_velocity": 1.0,
        "max_acceleration": 9.0, "passing": "stop", "blend": 0.5, "steps": 2, "rate": None, "limits": True,
    },
    "to_convention": {"robot": PUMA, "convention": "modified"},
    "mobility_of": {"mechanism": FOUR_BAR, "between": ("rocker", "ground"), "seed": 0},
    "manoeuvrability_of": {"base": CAR},
    "analyse_workspace": {
        "robot": PLANAR, "samples": 16, "seed": 0, "sampling": "sobol", "cores": 1, "dextrous": False, "voxel": None
    },
    "draw": {"what": PLANAR, "q": [0.1, 0.2], "kind": "text", "frames": False, "view": None, "units": None},
    "symbols": {"robot": PLANAR, "numbers": False, "frames": False, "units": None},
    "transform": {"expression": "Rot(z, 1)", "units": None},
    "pose": {
        "what": [1, 2, 3], "rpy": [1, 2, 3], "euler": None, "quaternion": None, "rotvec": None, "R": None,
        "length": "mm", "angle": "deg",
    },
    "pose_parts": {"T": T, "length": "mm", "angle": "deg"},
    "invert_pose": {"T": T},
    "dataframes.joints": {"robot": PUMA, "table": Q, "units": None, "argument": "table"},
    "dataframes.poses": {"table": T, "units": None, "robot": None, "task": "pose", "argument": "table"},
    "dataframes.fk": {"robot": PUMA, "q": Q, "orientation": "rpy", "units": None},
    "dataframes.ik": {"robot": PLANAR, "T": PLANAR_T, "units": None},
    "dataframes.of": {"answer": PUMA, "units": None},
    "default_tolerance": {"robot": PUMA, "table": False},
    "check_pose": {"robot": PUMA, "q": Q, "T": T, "tolerance": None, "task": "pose"},
    "check_configuration": {
        "robot": PLANAR, "T": PLANAR_T, "q": [0, 0], "tolerance": None, "task": "pose", "limits": True
    },
    "check_solutions": {
        "robot": PLANAR, "T": PLANAR_T, "answers": [[0, 0]], "tolerance": None, "task": "pose", "limits": True
    },
    "question_sheet": {
        "about": "planar2r", "questions": "fk", "seed": 7, "students": ["Ann", "Ben"], "name": "week3",
    },
    "mark_sheet": {
        "key": KEY, "answers": FORM, "student": "Ann", "budget": None, "partial": 0.5, "follow": False,
    },
    "statistics_of": {"marks": MARKS},
    "check_table": {"robot": PUMA, "given": PUMA, "tolerance": None, "up_to": ["base"]},
    **{f"rotation_from_{name}": {name: values} for name, values in
       {"rpy": [1, 2, 3], "euler": [1, 2, 3], "rotvec": [1, 2, 3], "quaternion": [1, 0, 0, 0]}.items()},
    "rotation_from_axis_angle": {"axis": [0, 0, 1], "angle": 1.0},
    **{f"{name}_from_rotation": {"R": np.eye(3)} for name in ("rpy", "euler", "rotvec", "quaternion", "axis_angle")},
    "documents.check": {"report": MARKS, "feedback": "part"},
    "documents.fk": {"robot": PUMA, "q": Q, "frames": False, "orientation": None, "units": None},
    "documents.ik": {"robot": PLANAR, "T": PLANAR_T, "units": None, "explain": False},
    "documents.jacobian": {"robot": PUMA, "q": Q, "frame": "base", "task": None, "units": None},
    "documents.singular": {"robot": PLANAR, "task": None, "units": None},
    "documents.dof": {"entry": FOUR_BAR, "units": None},
    "documents.show": {"entry": PUMA, "units": None},
    "documents.workspace": {"robot": PLANAR, "units": None},
    "documents.place": {"robot": PLANAR, "point": [1, 0, 0], "seed": 0, "units": None},
    "documents.frame": {"expression": "Rot(z, 90)", "units": None},
    "documents.plot": {"what": PLANAR, "q": [0.1, 0.2], "frames": False, "units": None},
    "documents.validate": {"file": "puma560"},
    "documents.schema": {"command": "fk", "check": None},
    "documents.document_of": {"value": PUMA, "units": None},
    "documents.expect_units": {"value": Units()},
    "documents.library": {},
    "Units": {"length": "mm", "angle": "deg"},
    "Tolerance": {"position": 1e-3, "angle": 1e-3, "relative": 0.0, "size": 1.0},
    "Robot.within_limits": {"self": PUMA, "q": Q},
    "from_table": {
        "table": [[0, 1, 0, 1.57], [0, 0, 1, 0]], "types": "RP", "convention": "standard", "length": "m",
        "angle": "rad",
        "name": "arm", "values": None,
    },
    "notebook.matrix": {"values": np.eye(3)},
    "notebook.html_of": {"value": PUMA},
    "library_names": {},
}  # fmt: skip
"""A right call of every public function, with all of its arguments."""

HEAVY = {"documents.library", "documents.workspace"}


def function(name):
    value = robokin
    for part in name.split("."):
        value = getattr(value, part)
    return value


def called(name, arguments):
    """The function's answer; `documents.workspace` looks at few samples."""
    more = {"samples": 16, "cores": 1} if name == "documents.workspace" else {}
    return function(name)(**arguments, **more)


def test_every_public_function_is_called_here():
    modules = {"dataframes": robokin.dataframes, "documents": robokin.documents, "notebook": robokin.notebook}
    names = {name for name in robokin.__all__ if inspect.isfunction(getattr(robokin, name))}
    for prefix, module in modules.items():
        own = {
            name
            for name, value in vars(module).items()
            if inspect.isfunction(value) and value.__module__ == module.__name__
        }
        names |= {f"{prefix}.{name}" for name in own if not name.startswith("_")}
    names |= {"Units", "Tolerance", "Robot.within_limits"}
    assert names == set(RIGHT)
    for name in names:
        parameters = inspect.signature(function(name)).parameters.values()
        assert {p.name for p in parameters if p.kind not in (p.VAR_KEYWORD, p.VAR_POSITIONAL)} == set(RIGHT[name]), name
        assert inspect.getdoc(function(name)), name


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("name", sweep(RIGHT, 3))
def test_whatever_is_given_ends_in_an_answer_or_a_sentence(name):
    if not name.startswith("dataframes."):  # whose right calls stand in tests/test_dataframes.py
        called(name, RIGHT[name])
    for argument, value in itertools.product(RIGHT[name], WRONG):
        if (name in HEAVY and argument == "units") or argument == "self":
            continue
        arguments = {**RIGHT[name], argument: value}
        try:
            called(name, arguments)
        except RobokinError as error:
            sentence = str(error)
            assert isinstance(error, ValueError), sentence
            assert 10 < len(sentence) < 400, (argument, sentence)
            assert "object at 0x" not in sentence, (argument, sentence)
        except Exception as error:
            raise AssertionError(f"{name}({argument}={value!r}) raised {type(error).__name__}: {error}") from error


@pytest.mark.parametrize("value", WRONG, ids=lambda value: type(value).__name__)
def test_whatever_a_parameter_is_set_to_ends_in_a_robot_or_a_sentence(value):
    try:
        assert robokin.load("planar2r", a1=value).n == 2
    except InputError as error:
        assert 10 < len(str(error)) < 400


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: robokin.forward_kinematics("puma560", Q), ["found the string 'puma560'", "robokin.load('puma560')"]),
        (lambda: robokin.solve_ik(FOUR_BAR, T), ["found a Mechanism", "expected a Robot", "robokin.load("]),
        (lambda: robokin.mobility_of(PUMA), ["found a Robot", "robokin.load_mechanism("]),
        (lambda: robokin.manoeuvrability_of("car"), ["robokin.load_wheeled('car')"]),
        (lambda: robokin.forward_kinematics(PUMA, ["1"] * 6), ["q: found a list", "no number"]),
        (lambda: robokin.forward_kinematics(PUMA, [1j] * 6), ["complex numbers"]),
        (lambda: robokin.forward_kinematics(PUMA, [1, [2]]), ["rows of different lengths"]),
        (lambda: robokin.load(None), ["found None", "a name of the library"]),
        (lambda: PUMA.ik("Trans(1,2,3)"), ["T: found the string 'Trans(1,2,3)'"]),
        (lambda: robokin.Robot.from_dh(None), ["table: found None", "rows of theta, d, a and alpha"]),
    ],
)
def test_a_wrong_type_is_a_type_error_with_a_sentence(call, said):
    with pytest.raises(InputError) as caught:
        call()
    assert isinstance(caught.value, ValueError)
    assert isinstance(caught.value, TypeError) or "rows" in str(caught.value)
    for words in said:
        assert words in str(caught.value)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: PUMA.fk([0] * 5), "q: found 5 in the last dimension, expected 6"),
        (lambda: PUMA.fk(1.0), "q: found a single number, expected 6"),
        (lambda: robokin.tip_poses(HAND, [0] * 20), "q: found 20 in the last dimension, expected 21"),
        (lambda: PUMA.ik(np.eye(3)), r"T: found an array of shape \(3, 3\), expected a pose"),
        (lambda: PUMA.ik(2 * np.eye(4)), "T: found a pose whose last row"),
        (lambda: PUMA.ik(T, near=[1, 2]), r"near: found an array of shape \(2,\), expected 6 values"),
        (lambda: PUMA.ik(T, near=[np.nan] * 6), "near: found a number that is not finite"),
        (lambda: robokin.follow_line(PLANAR, [0, 0], [PLANAR_T] * 2), r"T: found poses of shape \(2, 4, 4\)"),
        (lambda: robokin.swivel_angle(IIWA, np.zeros(6)), r"q: found an array of shape \(6,\)"),
        (lambda: robokin.swivel_solutions(IIWA, [IIWA_T] * 2, 0.1), "T: found poses of shape"),
        (lambda: robokin.solve_tips(HAND, {"index": [1, 2, 3]}), r"targets\['index'\]: found an array of shape"),
        (lambda: robokin.mobility_of(FOUR_BAR, ("a", "b")), "between: found the unknown link 'a'"),
        (lambda: robokin.from_table([[0, 1, 0, 0]], types="RR"), "^types: found 'RR', expected a letter"),
        (lambda: robokin.from_table("nonsense"), "^table: found no table"),
    ],
)
def test_a_message_names_the_argument(call, said):
    with pytest.raises(InputError, match=said):
        call()


# Pictures, symbols, transforms, marks ----------------------------------------------------------------------------


def test_a_drawing_is_what_the_shell_draws(tmp_path):
    file = tmp_path / "arm.html"
    code = "import sys; from robokin.cli import run; sys.exit(run(sys.argv[1:]))"
    subprocess.run([sys.executable, "-c", code, "plot", "puma560", "-o", str(file)], check=True)
    drawn = robokin.draw(PUMA, kind="html")
    assert drawn.data == file.read_bytes()
    drawn.save(tmp_path / "again.html")
    assert (tmp_path / "again.html").read_bytes() == drawn.data
    with pytest.raises(InputError, match=r"ends with \.html"):
        drawn.save(tmp_path / "arm.png")
    assert "sandbox" in drawn._repr_html_()
    assert robokin.draw(robokin.solve_ik(PUMA, T), kind="html").data.count(b"elbow") > 1
    assert str(robokin.draw(FOUR_BAR, kind="text")).strip()
    path = robokin.interpolate_joints(PLANAR, [0.1, 0.2], [0.8, 1.0], 20)
    assert b'"path":{' in robokin.draw(path, kind="html").data
    with pytest.raises(InputError, match="q: is for robots"):
        robokin.draw(path, [0.1, 0.2], kind="html")
    with pytest.raises(InputError, match=r"a \.gif is of what moves"):
        robokin.draw(PLANAR, kind="gif")


def test_symbols_are_texts_and_sources():
    found = robokin.symbols(PLANAR)
    assert found.T[0][3] == "a1*c1 + a2*c12"
    assert list(found.matrices) == ["A1", "A2"]
    assert found.symbols["a1"] == 1.0
    assert "bmatrix" in found.latex()
    scope = {}
    exec(found.python(), scope)
    made = next(value for value in scope.values() if inspect.isfunction(value))
    assert np.allclose(made(np.degrees([0.3, 0.4])), PLANAR_T)


def test_a_transform_is_in_si():
    assert np.allclose(robokin.transform("Trans(400, 0, 0) Rot(z, 90)", MM_DEG)[:3, 3], [0.4, 0, 0])
    assert np.allclose(robokin.transform("Rot(z, pi/2)")[:2, :2], [[0, -1], [1, 0]], atol=1e-15)


@pytest.mark.parametrize("seed", range(5))
def test_conversions_are_inverses(seed):
    rng = np.random.default_rng(seed)
    v = rng.uniform(-1.7, 1.7, (4, 3)) * rng.choice([1e-9, 1e-3, 1.0])
    v[0] = 0.0
    R = robokin.rotation_from_rotvec(v)
    assert np.allclose(robokin.rotvec_from_rotation(R), v, rtol=1e-6, atol=1e-15)
    axis, angle = robokin.axis_angle_from_rotation(R)
    assert np.allclose(robokin.rotation_from_axis_angle(axis, angle), R, atol=1e-14)
    for name in ("rpy", "euler", "quaternion"):
        there, back = (getattr(robokin, form.format(name)) for form in ("{}_from_rotation", "rotation_from_{}"))
        assert np.allclose(back(there(R)), R, atol=1e-14)


def test_marks_are_those_of_the_shell():
    assert robokin.check_pose(PUMA, Q, T).right
    moved = T.copy()
    moved[0, 3] += 0.01
    mark = robokin.check_pose(PUMA, Q, moved)
    assert (mark.status, round(mark.position, 12), mark.angle) == ("wrong position", 0.01, 0.0)
    assert robokin.check_pose(PUMA, Q, moved, robokin.Tolerance(0.02, 0.01)).right
    result = robokin.solve_ik(PUMA, T)
    assert robokin.check_configuration(PUMA, T, Q).right
    assert robokin.check_solutions(PUMA, T, [one.q for one in result]).status == "pass"
    assert len(robokin.check_solutions(PUMA, T, [Q]).missing) == len(result) - 1
    assert robokin.check_table(PUMA, robokin.load("puma560-craig"), up_to=["base", "tool", "zero", "sign"]).score > 0.2
    assert robokin.check_table(PUMA, PUMA).same


def test_the_page_of_the_documentation_holds(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    page = (Path(__file__).parent.parent / "docs" / "python.md").read_text()
    code = "\n".join(re.findall(r"```python\n(.*?)```", page, re.DOTALL))
    example = doctest.DocTestParser().get_doctest(code, {}, "python.md", "python.md", 0)
    faults = []
    doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE).run(example, out=faults.append)
    assert not faults, "".join(faults)
    listed = set(re.findall(r"`(\w+)`", "\n".join(line for line in page.splitlines() if line.startswith("| `"))))
    named = {name for name in robokin.__all__ if inspect.isfunction(getattr(robokin, name))}
    told = {f"{a}_from_{b}" for a, b in [("rotation", n) for n in listed] + [(n, "rotation") for n in listed]}
    assert named - listed - told <= {"default_tolerance", "library_names"}


def test_the_start_of_the_package_loads_nothing_more():
    code = (
        "import sys, robokin; print(len([n for n in sys.modules if n.startswith('robokin')]), 'numpy' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["1", "False"]
