"""A pose has the same answer among others as alone, singular poses of arms with slides without limits included.

Their self-motions have no end, many have mirror images that are as near to the arm's zeros, and what a curve comes to
must not depend on the curves that are followed beside it.
"""

from __future__ import annotations

import zlib

import numpy as np
import pytest
from inverse import arms, judge

import robokin
from robokin.inverse.analysis import analysis_of
from robokin.inverse.self_motion.straight_motions import straight_line


def singular_poses(number):
    """A random chain of the benchmark, and two of each kind of its round, singular and limit configurations."""
    robot = arms.random_chain(np.random.default_rng([560, number]))
    rng = np.random.default_rng([560, zlib.crc32(f"chain {number} {robot.types}".encode())])
    scale = judge.Scale(robot)
    return robot, scale, np.concatenate([arms.configurations(robot, scale, rng, 2, kind) for kind in arms.KINDS[1:]])


@pytest.mark.parametrize("number", [5, 7, 10, 326, 591, 817, 947])
def test_answers_are_those_of_the_poses_alone(number):
    robot, scale, q = singular_poses(number)
    T = robokin.forward_kinematics(robot, q)
    together = robokin.solve_ik(robot, T)
    looked_again = [i for i in range(len(T)) if together[i].basis != "counted" or together[i].families][:8]
    assert looked_again
    for i in looked_again:
        assert judge.differs_alone(robot, scale, together[i], robokin.solve_ik(robot, T[i])) == "", (number, i)


def test_a_straight_line_of_slides_is_one_self_motion():
    # PPRP of the benchmark: at q3 = 180° its slides are in one plane, and solutions were found 20 km away.
    robot, _, _ = singular_poses(591)
    size = analysis_of(robot).size
    q = np.array([[0.3, -0.2, np.pi, 0.4], [-7.0, 2.0, np.pi, 5.0]])
    for T in robokin.forward_kinematics(robot, q):
        result = robokin.solve_ik(robot, T)
        assert len(result.families) == len(result.solutions) == 1
        assert result.families[0].joints == (1, 2, 4)
        # The greatest move from the arm's zeros is least; among those with none greater than the turn's all moves are.
        at = result.solutions[0].q[[0, 1, 3]] / size
        line = at + np.linspace(-2.0, 2.0, 4001)[:, None] * np.linalg.svd(slides_of(robot, q[0]))[2][-1]
        greatest, length = np.maximum(np.max(np.abs(line), axis=1), np.pi), np.linalg.norm(line, axis=1)
        mine = max(float(np.max(np.abs(at))), np.pi)
        assert mine <= np.min(greatest) + 1e-6
        assert np.linalg.norm(at) <= np.min(length[greatest <= mine + 1e-9], initial=np.inf) + 1e-6


def slides_of(robot, q):
    """(3, k) the directions of a robot's slides at q (n,)."""
    return robokin.jacobian(robot, q)[:3, ~robot.revolute]


def test_straight_lines_are_of_slides_or_of_one_axis(rng):
    for _ in range(50):
        J = rng.normal(size=(6, 5))
        J[3:, 2:] = 0.0  # the last three slide
        J[:3, 4] = J[:3, 2] * rng.normal() + J[:3, 3] * rng.normal()
        way = np.r_[0.0, 0.0, np.linalg.svd(J[:3, 2:])[2][-1]]
        line = straight_line(J, way)
        assert np.max(np.abs(J @ line)) < 1e-12
        assert abs(line @ way) > 1.0 - 1e-9
        assert straight_line(J, rng.normal(size=5)) is None
        # Two slides that are not parallel move the tool whatever they do.
        assert straight_line(J, np.array([0.0, 0.0, 0.7, 0.7, 0.0])) is None


def test_slides_are_followed_to_their_limits_however_long():
    """A gantry whose axes are two hundredths of its strokes apart."""
    strokes = (0.93, 0.33)
    robot = arms.random_chain(np.random.default_rng([77, 33]))
    assert (robot.types, robot.limits[[0, 2], 1].tolist()) == ("PRP", list(strokes))
    for q in ([0.93, 0.0, 0.0825], [0.465, 0.0, 0.2475]):
        result = robokin.solve_ik(robot, robokin.forward_kinematics(robot, np.array(q)))
        (family,) = result.families
        (arc,) = family.arcs
        total = q[0] + q[2]
        ends = sorted(arc.q[[0, -1], 0].tolist())
        # What both slides leave of the line on which their sum stays.
        np.testing.assert_allclose(ends, [max(0.0, total - strokes[1]), min(strokes[0], total)], rtol=0, atol=1e-9)
