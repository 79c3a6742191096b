"""Forward kinematics is the product of its parts, for every chain, batch and convention."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from kinematics.chains import random_chain
from kinematics.reference import forward, frames
from library_entries import names_of
from sweeps import sweep

import robokin
from robokin.errors import InputError
from robokin.kernel.columns import BLOCK, cos_sin_of_halves
from robokin.kernel.native_kernel import native
from robokin.kinematics.forward import joint_frames, row_frames
from robokin.model import Joint, JointType, Robot

ROBOTS = names_of(Robot)


def values(robot, rng, *shape):
    return rng.uniform(-3.5, 3.5, (*shape, robot.n))


@pytest.mark.parametrize("name", sweep(ROBOTS, 4))
def test_every_robot_of_the_library_equals_an_independent_product(name, rng):
    robot = robokin.load(name)
    q = values(robot, rng, 8)
    expected = np.array([forward(robot, row) for row in q])
    size = max(1e-3, float(np.max(np.abs(expected[:, :3, 3]))))
    T = robokin.forward_kinematics(robot, q)
    assert np.max(np.abs(T[:, :3, 3] - expected[:, :3, 3])) < 1e-12 * size
    assert np.max(np.abs(T[:, :3, :3] - expected[:, :3, :3])) < 1e-12


@pytest.mark.parametrize("convention", ["standard", "modified", "frames"])
@pytest.mark.parametrize("special", [False, True])
def test_random_chains_equal_an_independent_product(convention, special, rng):
    for n in (*range(1, 9), 15):
        for _ in range(6):
            robot = random_chain(rng, n, convention, special)
            q = values(robot, rng, 3)
            expected = np.array([forward(robot, row) for row in q])
            assert np.max(np.abs(robokin.forward_kinematics(robot, q) - expected)) < 1e-12 * 20


@pytest.mark.parametrize("convention", ["standard", "modified", "frames"])
def test_every_frame_on_the_way_is_a_part_of_the_product(convention, rng):
    for _ in range(15):
        robot = random_chain(rng, 7, convention, special=True)
        q = values(robot, rng)
        expected = np.array(frames(robot, q))
        assert np.allclose(row_frames(robot, q), expected[1:-1], atol=1e-13)
        links = robokin.link_frames(robot, q)
        assert links.shape == (robot.n + 1, 4, 4)
        assert np.allclose(links[-1] @ robot.tool, robokin.forward_kinematics(robot, q), atol=1e-13)
        if all(row.moves for row in robot.rows):
            assert np.allclose(links, expected[:-1], atol=1e-13)
        joints = joint_frames(robot, q)
        assert np.allclose(joints[-1], expected[-1], atol=1e-13)


def test_fixed_rows_extend_the_link_they_follow(rng):
    robot = robokin.load("assembly")
    assert robot.n == 0
    assert robokin.link_frames(robot, []).shape == (1, 4, 4)
    assert row_frames(robot, []).shape == (3, 4, 4)
    assert np.allclose(robokin.link_frames(robot, [])[0], robokin.forward_kinematics(robot, []))


def test_joint_frames_have_the_axis_along_z(rng):
    """Moving joint k leaves the origin and the z axis of its own frame where they are."""
    robot = random_chain(rng, 6, "frames")
    q = values(robot, rng)
    before = joint_frames(robot, q)
    for k in range(robot.n):
        moved = q.copy()
        moved[k] += 0.1
        after = joint_frames(robot, moved)
        assert np.allclose(after[k], before[k], atol=1e-14)
        change = np.linalg.inv(after[-1]) @ before[-1]
        assert not np.allclose(change, np.eye(4), atol=1e-3)


@pytest.mark.parametrize("name", ["puma560", "scara", "human-body", "panda", "scara-frames", "ur5e"])
def test_a_batch_is_its_singles(name, rng):
    robot = robokin.load(name)
    q = values(robot, rng, BLOCK + 37)
    T = robokin.forward_kinematics(robot, q)
    for i in (0, 1, 7, BLOCK - 1, BLOCK, BLOCK + 36):
        assert np.max(np.abs(T[i] - robokin.forward_kinematics(robot, q[i]))) < 1e-15 * 10
    shaped = robokin.forward_kinematics(robot, q[:24].reshape(2, 3, 4, robot.n))
    assert shaped.shape == (2, 3, 4, 4, 4)
    assert np.array_equal(shaped.reshape(24, 4, 4), robokin.forward_kinematics(robot, q[:24]))
    assert robokin.forward_kinematics(robot, q[:0]).shape == (0, 4, 4)


def test_both_conventions_describe_one_arm(rng):
    """A standard table is a modified one with a and alpha moved down a row, and a tool for the last."""
    for _ in range(20):
        standard = random_chain(rng, 6)
        rows = [row for row in standard.rows if row.moves]
        standard = Robot("standard", tuple(rows), base=standard.base)
        a, alpha = [0.0, *(row.a for row in rows)], [0.0, *(row.alpha for row in rows)]
        modified = Robot(
            "modified",
            tuple(
                Joint(row.name, row.type, theta=row.theta, d=row.d, a=a[i], alpha=alpha[i], offset=row.offset)
                for i, row in enumerate(rows)
            ),
            "modified",
            base=standard.base,
            tool=forward(Robot("last", (Joint("x", JointType.FIXED, a=a[-1], alpha=alpha[-1]),)), []),
        )
        q = values(standard, rng, 4)
        A, B = robokin.forward_kinematics(standard, q), robokin.forward_kinematics(modified, q)
        assert np.max(np.abs(A - B)) < 1e-13


def test_poses_are_rigid(rng):
    T = robokin.forward_kinematics(robokin.load("human-body"), rng.uniform(-3, 3, (200, 21)))
    assert np.max(np.abs(np.swapaxes(T[:, :3, :3], 1, 2) @ T[:, :3, :3] - np.eye(3))) < 1e-13
    assert np.all(T[:, 3] == [0, 0, 0, 1])


def test_cosine_and_sine_from_the_tangent_of_the_half():
    angles = np.concatenate(
        [np.linspace(-20, 20, 100_001), np.pi * np.arange(-8, 9) / 2, np.pi + np.array([1e-9, -1e-9])]
    )
    c, s = cos_sin_of_halves(0.5 * angles[None])
    assert np.max(np.abs(c[0] - np.cos(angles))) < 2e-15
    assert np.max(np.abs(s[0] - np.sin(angles))) < 2e-15


def test_nan_stays_in_its_row():
    robot = robokin.load("puma560")
    q = np.zeros((3, 6))
    q[1, 2] = np.nan
    T = robokin.forward_kinematics(robot, q)
    assert np.isnan(T[1]).any()
    assert not np.isnan(T[[0, 2]]).any()


@pytest.mark.parametrize("q", [np.zeros(5), np.zeros((2, 7)), 1.0, "abc", [[0, 0], [0]], None])
def test_wrong_joint_values_are_refused(q):
    with pytest.raises(InputError, match=r"6|numbers"):
        robokin.forward_kinematics(robokin.load("puma560"), q)


def test_the_input_is_left_alone(rng):
    q = rng.uniform(-1, 1, (10, 6))
    kept = q.copy()
    robokin.forward_kinematics(robokin.load("puma560"), q)
    assert np.array_equal(q, kept)


@pytest.mark.parametrize("m", [0, 1, 8, 50])
@pytest.mark.parametrize("name", ["puma560", "stanford", "m20ia"])
def test_a_batch_that_threads_share_has_the_same_numbers(name, m, monkeypatch, rng):
    from robokin.kinematics import forward, jacobian

    for module in (forward, jacobian):
        monkeypatch.setattr(module, "SHARE", 8)
    robot = robokin.load(name)
    q = rng.normal(size=(2, m, robot.n))
    for ask in (robokin.forward_kinematics, robokin.jacobian, partial(robokin.jacobian, frame="tool")):
        one = ask(robot, q)
        for cores in (2, 3, None, np.int64(2)):
            shared = ask(robot, q, cores=cores)
            assert shared.shape == one.shape
            assert shared.tobytes() == one.tobytes()
        assert ask(robot, q[0, :1].reshape(-1, robot.n), cores=2).tobytes() == one[0, :1].tobytes()


@pytest.mark.parametrize("cores", [0, -1, 1.5, "2", True, 10**6])
@pytest.mark.parametrize("ask", [robokin.forward_kinematics, robokin.jacobian])
def test_what_is_no_number_of_cores_is_refused(ask, cores):
    with pytest.raises(robokin.InputError, match="cores"):
        ask(robokin.load("puma560"), np.zeros(6), cores=cores)


@pytest.mark.skipif(native is None, reason="Python's kernel may round a block otherwise than one configuration")
def test_a_coupled_arm_alone_has_the_digits_that_it_has_among_others(tmp_path, rng):
    """BLAS sums one row in another order than many."""
    rows = "".join(f"  - {{name: j{i}, type: R, d: 0.{i}, a: 0.{7 - i}, alpha: {90 * (i % 2)}}}\n" for i in range(1, 7))
    couplings = "  - {joint: j5, adds: {j6: 2/3, j1: 1/3, j3: 0.7, j2: -0.1}}\n  - {joint: j2, adds: j4, ratio: 1/7}\n"
    path = tmp_path / "coupled.yaml"
    path.write_text(f"robokin: 1\nname: x\nunits: {{length: m, angle: rad}}\njoints:\n{rows}couplings:\n{couplings}")
    for robot, poses in (
        (robokin.load(path), robokin.forward_kinematics),
        (robokin.load_tree("baxter"), robokin.tip_poses),
    ):
        q = rng.uniform(-3.0, 3.0, (40, robot.n))
        many = poses(robot, np.tile(q, (50, 1)))[:40]
        assert np.array_equal(many, [poses(robot, one) for one in q])
        if robot.name == "x":
            J = robokin.jacobian(robot, np.tile(q, (50, 1)))[:40]
            assert np.array_equal(J, [robokin.jacobian(robot, one) for one in q])
            assert np.array_equal(robokin.link_frames(robot, q), [robokin.link_frames(robot, one) for one in q])
