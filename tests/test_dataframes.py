"""Data frames in and out: columns are found by their names, never by where they stand; rows keep their index.

Tables of pyarrow are read by the same code as frames of pandas and polars, and stand for them where pandas is missing.
"""

from __future__ import annotations

import io
import re
import subprocess
import sys

import documentation
import numpy as np
import pytest

import robokin
from robokin import InputError, Units

PUMA = robokin.load("puma560")
PLANAR = robokin.load("planar3r")
Q = np.radians(np.random.default_rng(4).uniform(-40, 40, (5, 6)))
T = robokin.forward_kinematics(PUMA, Q)
NAMES = [f"q{i}" for i in range(1, 7)]
MM_DEG = Units("mm", "deg")


class NamedTable:
    """Columns with names, as polars and pyarrow have them: what is read asks for no more."""

    def __init__(self, **columns):
        self.data = columns

    @property
    def columns(self):
        return [*self.data]

    def __getitem__(self, name):
        return self.data[name]


def shuffled(**more):
    columns = dict(zip(NAMES, Q.T, strict=True)) | more
    return NamedTable(**{name: columns[name] for name in sorted(columns, key=lambda name: name[::-1], reverse=True)})


# What is read, without pandas ------------------------------------------------------------------------------------

READS_Q = {
    "forward_kinematics": lambda q: robokin.forward_kinematics(PUMA, q),
    "link_frames": lambda q: robokin.link_frames(PUMA, q),
    "jacobian": lambda q: robokin.jacobian(PUMA, q),
    "differential_kinematics": lambda q: robokin.differential_kinematics(PUMA, q).manipulability,
    "within_limits": PUMA.within_limits,
    "robot.fk": PUMA.fk,
    "robot.plot": lambda q: np.array(PUMA.plot(q, "text").data),
    "trajectory": lambda q: robokin.trajectory(PUMA, q, duration=1.0, steps=4, limits=False).q,
    "documents.fk": lambda q: np.array([one["q"] for one in robokin.documents.fk(PUMA, q)]),
}


@pytest.mark.parametrize("name", READS_Q)
def test_joint_values_are_found_by_their_names(name):
    expected = READS_Q[name](Q)
    assert np.array_equal(READS_Q[name](shuffled(time=np.arange(5.0), note=["a"] * 5)), expected)
    by_joint = NamedTable(**{joint.name: Q[:, i] for i, joint in reversed([*enumerate(PUMA.joints)])})
    assert np.array_equal(READS_Q[name](by_joint), expected)
    assert np.array_equal(READS_Q[name](by_joint.data), expected)


def test_a_dict_is_a_row_by_the_joints_names():
    row = {name: float(value) for name, value in zip(reversed(NAMES), reversed(Q[0]), strict=True)}
    assert np.array_equal(PUMA.fk(row | {"time": 0.1}), T[0])
    nearest = PUMA.ik(T[0], near=row)[0].q
    assert np.array_equal(nearest, PUMA.ik(T[0], near=Q[0])[0].q)
    place = dict(zip(("z", "y", "x"), T[0, 2::-1, 3], strict=True))
    assert PUMA.ik(place | {"roll": 0.0, "pitch": 0.0, "yaw": 0.0}, task="position").reachable
    cells = {"alpha": [0.0, 0.0], "a": [0.5, 0.3], "d": [0.0, 0.0], "theta": [0.0, 0.0]}
    assert np.allclose(robokin.from_table(cells).fk([0.0, 0.0])[:3, 3], [0.8, 0.0, 0.0])


def test_headings_say_units_as_in_a_csv():
    columns = {f"Joint {i} [deg]": np.degrees(Q[:, i - 1]) for i in (6, 1, 3, 2, 5, 4)}
    assert np.allclose(PUMA.fk(NamedTable(**columns)), T, atol=1e-14)
    scara = robokin.load("scara")
    table = NamedTable(**{"q3 [mm]": [100.0], "q1": [0.1], "q2": [0.2], "q4 [deg]": [45.0]})
    assert np.allclose(robokin.dataframes.joints(scara, table), [[0.1, 0.2, 0.1, np.pi / 4]], atol=1e-15)
    plain = NamedTable(q1=[10.0], q2=[20.0], q3=[100.0], q4=[45.0])
    q = robokin.dataframes.joints(scara, plain, MM_DEG)
    assert np.allclose(q, [[np.radians(10), np.radians(20), 0.1, np.pi / 4]], atol=1e-15)


def test_poses_are_found_by_their_names():
    parts = robokin.pose_parts(T, length="mm")
    turned = dict(zip(("qz", "qx", "qw", "qy"), parts.quaternion[:, [3, 1, 0, 2]].T, strict=True))
    table = NamedTable(**turned, **{f"{axis} [mm]": parts.position[:, i] for i, axis in enumerate("xyz")})
    assert np.allclose(robokin.dataframes.poses(table), T, atol=1e-14)
    batch = PUMA.ik(table, limits=False)
    assert np.array_equal(batch.count, PUMA.ik(T, limits=False).count)


def test_a_position_alone_is_no_pose():
    table = NamedTable(x=[0.4], y=[0.2], z=[0.3])
    with pytest.raises(InputError, match="T: found x, y, z without an orientation"):
        PUMA.ik(table)
    assert PUMA.ik(table, task="position").count[0] > 0
    with pytest.raises(InputError, match="T: found x, y without an orientation"):
        PLANAR.ik(NamedTable(x=[0.9], y=[1.2]))
    whole = PLANAR.ik(NamedTable(phi=[1.0], y=[1.2], x=[0.9]))
    assert whole.count[0] == 2
    assert np.allclose(whole.q[0].sum(axis=-1), 1.0)


def test_a_table_of_a_robot_is_read_by_its_columns():
    rows = np.array([[0.1, 0.2, 1.0, np.pi / 2], [0.3, 0.0, 0.5, 0.0]])  # theta, d, a, alpha
    table = NamedTable(A=rows[:, 2], alpha=rows[:, 3], d=rows[:, 1], theta=rows[:, 0])
    assert np.array_equal(robokin.from_table(table).fk([0.4, 0.5]), robokin.from_table(rows).fk([0.4, 0.5]))


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: PUMA.fk(NamedTable(q1=[1.0], q2=[2.0])), "q: found the columns q1, q2, expected q1, q2, q3"),
        (lambda: PUMA.fk(shuffled(q7=np.zeros(5))), "q: found the column 'q7', expected q1 to q6 alone"),
        (lambda: PUMA.fk(shuffled(q1=["a"] * 5)), "q, column 'q1': found an array .* no number"),
        (lambda: PUMA.fk(shuffled(q1=[True] * 5)), "q, column 'q1': found truth values"),
        (lambda: PUMA.fk(shuffled(q1=[1.0]).data), "q: found columns of different lengths"),
        (lambda: PUMA.fk(shuffled(q1=1.0).data), "q: found columns of different lengths"),
        (lambda: PUMA.fk({"q1": 1.0}), "q: found the columns q1, expected q1, q2, q3"),
        (lambda: PUMA.fk(dict.fromkeys(NAMES, "1")), "q, column 'q1': found the string '1', expected numbers"),
        (lambda: PUMA.fk(dict.fromkeys(NAMES, np.ma.masked)), "q, column 'q1': found an array with masked values"),
        (lambda: robokin.from_table({"theta": [0], "d": [0], "a": [1, 1], "alpha": [0]}),
         "table: found columns of different lengths"),
        (lambda: PUMA.ik(shuffled()), "T: found the columns .*expected x, y, z with roll"),
        (lambda: PUMA.ik(T[0], near=NamedTable(q1=[1.0])), "near: found the columns q1"),
        (lambda: PUMA.ik(T[0], near=shuffled()), r"near: found an array of shape \(5, 6\)"),
        (lambda: robokin.interpolate_joints(PUMA, shuffled(), Q[0]), r"start: found an array of shape \(5, 6\)"),
        (lambda: robokin.rpy_from_rotation(shuffled()), "R: found a table whose columns have names"),
        (lambda: robokin.from_table(NamedTable(a=[1], d=[1])), "table: found the columns a, d, expected theta, d, a"),
        (lambda: robokin.dataframes.joints(PUMA, Q), "table: found an array .*, expected a data frame"),
        (lambda: robokin.dataframes.joints("puma560", shuffled()), "robot: found the string"),
        (lambda: robokin.dataframes.poses(NamedTable(x=[1], y=[1], z=[1], qw=[2], qx=[0], qy=[0], qz=[0])),
         "table, row 0: found a quaternion of length 2"),
        (lambda: PUMA.ik(NamedTable(x=[1], y=[1], z=[np.nan], roll=[0], pitch=[0], yaw=[0])),
         "T, row 0: found a number that is not finite"),
        (lambda: robokin.dataframes.of(robokin.mobility_of(robokin.load_mechanism("four-bar"))), "answer: found a Mob"),
    ],
)  # fmt: skip
def test_a_slip_is_said_with_its_argument(call, said):
    with pytest.raises(InputError, match=said):
        call()


def test_tables_of_pyarrow_are_read():
    arrow = pytest.importorskip("pyarrow")
    table = arrow.table({name: Q[:, i] for i, name in [*enumerate(NAMES)][::-1]})
    assert np.array_equal(PUMA.fk(table), T)


def test_pandas_is_not_loaded_unless_a_frame_is_made():
    code = (
        "import sys, numpy as np, robokin\n"
        "robot = robokin.load('planar2r'); robot.ik(robot.fk([1, 1]))._repr_html_(); robot.table\n"
        "print('pandas' in sys.modules, 'pyarrow' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False", "False"]


# What is made, and what of pandas is read -------------------------------------------------------------------------


@pytest.fixture
def pandas():
    return pytest.importorskip("pandas")


@pytest.fixture
def frame(pandas):
    """Joint values in another order, with an index and other columns."""
    made = pandas.DataFrame(Q, columns=NAMES, index=[*"abcde"])[NAMES[::-1]]
    made.insert(2, "time", np.arange(5.0))
    return made


def test_frames_rows_and_plain_frames_of_pandas(pandas, frame):
    assert np.array_equal(PUMA.fk(frame), T)
    assert np.allclose(PUMA.fk(frame.loc["c"]), T[2], atol=1e-15)
    assert np.array_equal(PUMA.fk(pandas.DataFrame(Q)), T)
    assert np.allclose(PUMA.fk(pandas.Series(Q[0])), T[0], atol=1e-15)
    with pytest.raises(InputError, match="q: found the column 'q1' twice"):
        PUMA.fk(pandas.concat([frame, frame[["q1"]]], axis=1))


@pytest.mark.parametrize("units", [None, MM_DEG, Units("in", "rad")])
@pytest.mark.parametrize("orientation", ["rpy", "quaternion", "quaternion-xyzw", "euler", "rotvec", "abc", "wpr"])
def test_what_is_made_is_read_again(frame, units, orientation):
    made = robokin.dataframes.fk(PUMA, frame, orientation, units)
    assert [*made.index] == [*"abcde"]
    assert made.columns[0] == "time"
    assert np.allclose(PUMA.fk(made), T, atol=1e-13)
    assert np.allclose(robokin.dataframes.poses(made), T, atol=1e-13)
    result = robokin.dataframes.ik(PUMA, made, units, limits=False)
    assert {*result.index} == {*"abcde"}
    for name, own in result.groupby(level=0):
        found = robokin.dataframes.joints(PUMA, own)
        assert np.allclose(PUMA.fk(found), T["abcde".index(name)], atol=1e-9)
        assert len(found) == len(PUMA.ik(T["abcde".index(name)], limits=False))


def csv_header(*words, given=b""):
    out = io.BytesIO()
    documentation.robokin([*words, "-f", "csv"], given, out, io.BytesIO())
    return out.getvalue().decode().splitlines()[0].split(",")


def test_columns_are_those_of_the_shell(pandas):
    home = PUMA.poses["home"]
    shell = {
        "fk": (csv_header("fk", "puma560", "--q", "home"), robokin.dataframes.fk(PUMA, home)),
        "ik": (csv_header("ik", "puma560", "--pose", "Trans(500,100,300) RPY(180,0,45)"),
               PUMA.ik(robokin.pose("Trans(500,100,300) RPY(180,0,45)", length="mm", angle="deg")).to_pandas()),
        "path": (csv_header("path", "puma560", "--from", "home", "--to", "80,10,90,0,10,0"),
                 robokin.interpolate_joints(PUMA, home, home - 0.1).to_pandas()),
        "jacobian": (csv_header("jacobian", "puma560", "--q", "home"),
                     robokin.differential_kinematics(PUMA, home).to_pandas()),
    }  # fmt: skip
    for command, (names, made) in shell.items():
        assert [*made.columns] == names, command
    said = robokin.interpolate_joints(PUMA, home, home - 0.1).to_pandas(MM_DEG).columns
    assert [re.sub(r" \[.*", "", name) for name in said] == shell["path"][0]
    assert {"q1 [deg]", "x [mm]", "roll [deg]"} <= {*said}


def test_a_target_without_a_solution_is_a_row_with_its_reason(pandas):
    batch = PLANAR.ik([robokin.pose([9, 9, 0]), robokin.pose([0.9, 1.2, 0])])
    made = batch.to_pandas()
    assert made["solution"].tolist() == [0, 1, 2]
    assert made["target"].tolist() == [1, 2, 2]
    assert made["reason"].tolist() == ["out of reach", "", ""]
    assert made.loc[0, ["q1", "q2", "q3"]].isna().all()


def test_other_columns_of_a_dict_stand_in_front(pandas):
    columns = shuffled(time=np.arange(5.0)).data
    made = robokin.dataframes.fk(PUMA, columns)
    assert made.equals(robokin.dataframes.fk(PUMA, pandas.DataFrame(columns)))
    row = {name: values[0] for name, values in columns.items()}
    assert robokin.dataframes.fk(PUMA, row).iloc[0].equals(made.iloc[0])
    with pytest.raises(InputError, match="different lengths"):
        robokin.dataframes.fk(PUMA, columns | {"time": [1.0]})


def test_other_columns_stand_in_front_but_for_those_that_are_made_anew(frame):
    frame["x"], frame["roll [deg]"] = 1.0, 2.0
    made = robokin.dataframes.fk(PUMA, frame)
    assert [*made.columns] == ["time", *NAMES, "x", "y", "z", "roll", "pitch", "yaw"]
    assert np.allclose(made["x"], T[:, 0, 3])


def test_marks_and_blocks_of_jacobians_are_frames(pandas):
    from robokin.grading import grade_poses

    report = grade_poses(PUMA, Q[:2], [T[0], np.eye(4)], students=["Ann", "Ben"])
    assert report.to_pandas()["status"].tolist() == [item.status for item in report]
    found = robokin.differential_kinematics(PUMA, Q)
    made = found.to_pandas()
    assert np.array_equal(made["rank"], found.rank)
    assert np.allclose(made["j23"], found.jacobian[:, 1, 2])
    assert np.allclose(made["manipulability"], found.manipulability)
