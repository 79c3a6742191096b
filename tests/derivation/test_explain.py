"""Lessons: every number is the value of its formula, and the ends are the solutions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from library_entries import entry, names_of
from sweeps import sweep

import robokin
from robokin.derivation.derivation_of import plan_of
from robokin.derivation.explain import explain_ik
from robokin.derivation.formulas import evaluate
from robokin.errors import InputError
from robokin.formats.library import library_names
from robokin.inverse.solution_names import branch_names
from robokin.inverse.verify import wrapped
from robokin.kinematics.jacobian import jacobian
from robokin.model import Joint, JointType, Robot
from robokin.spatial import nearest_rotation, transform
from robokin.spatial.dh import standard_dh

REGULAR = 0.02
"""Least singular value of the Jacobian, lengths in the arm's reach, of a pose at which solutions do not run together:
rounding of 1e-16 is at most some 1e-12 there, on each of the other branches as well."""


def robots():
    """The library's robots that have a lesson."""
    found = [entry(name) for name in names_of(Robot, 1)]
    return [robot for robot in found if plan_of(robot, np.zeros(robot.n)) is not None]


LIBRARY = robots()
ids = [robot.id for robot in LIBRARY]


def regular_poses(robot, rng, count):
    """Poses the arm reaches, no configuration of which is near a singular one."""
    low, high = np.clip(robot.limits, -np.pi, np.pi).T
    while count:
        q = rng.uniform(low, high)
        T = robokin.forward_kinematics(robot, q)
        everywhere = [s.q for s in robokin.solve_ik(robot, T, limits=False).solutions]
        if everywhere and min(least_singular_value(robot, q) for q in everywhere) > REGULAR:
            count -= 1
            yield q, T


def least_singular_value(robot, q):
    J = jacobian(robot, q)
    size = max(1e-3, float(np.max(np.abs(J[:3]))))
    J = J / np.array([size, size, size, 1.0, 1.0, 1.0])[:, None]
    J[:, ~robot.revolute] *= size
    return float(np.linalg.svd(J, compute_uv=False)[robot.n - 1])


def solutions_match(robot, T, **asked):
    """Whether the ends without a reason are the solutions, one for one, to 1e-9."""
    lesson = explain_ik(robot, T, **asked)
    result = robokin.solve_ik(robot, T, **asked)
    ends = [end for end in lesson.ends if end.q is not None and not end.reason]
    assert len(ends) == len(result.solutions), (robot, lesson.ends)
    left = [solution.q for solution in result.solutions]
    for end in ends:
        errors = [np.max(np.abs(end.q - q)) for q in left]
        assert min(errors, default=np.inf) < 1e-9, (robot, end, left)
        left.pop(int(np.argmin(errors)))
    numbers_follow(lesson)
    return lesson


def numbers_follow(lesson):
    """Whether each result is the value of its formula."""
    for step in lesson.steps:
        values = {name: quantity.value for name, quantity in step.values.items()}
        np.testing.assert_array_equal(evaluate(step.formula, values), step.result.value)


@pytest.mark.parametrize("robot", sweep(LIBRARY, 4), ids=ids)
def test_the_ends_are_the_solutions(robot, rng):
    for q, T in regular_poses(robot, rng, 1):
        lesson = solutions_match(robot, T)
        reached = [end.q for end in lesson.ends if end.q is not None and not end.reason]
        assert min(np.max(np.abs(wrapped((q - found)[None], robot.revolute))) for found in reached) < 1e-9
        solutions_match(robot, T, limits=False)
        solutions_match(robot, T, near=robot.limits.clip(-0.1, 0.1).mean(axis=1))
        if not plan_of(robot, q).whole:
            solutions_match(robot, T, task="position")
            solutions_match(robot, T, task="position", limits=False)
            solutions_match(robot, T, task="approach", limits=False)


def test_every_arm_with_a_spherical_wrist_and_six_joints_has_a_lesson():
    from robokin.kinematics.structure import structure_of

    for name in library_names():
        try:
            robot = robokin.load(name)
        except robokin.RobokinError:
            continue
        if robot.n == 6 and structure_of(robot).wrist.startswith("spherical"):
            assert name in ids


@pytest.mark.parametrize(
    ("name", "count"),
    [("planar2r", 2), ("planar3r", 2), ("anthropomorphic", 4), ("spherical", 4), ("cylindrical", 2), ("cartesian", 1),
     ("scara", 2), ("spherical-wrist", 2), ("puma560", 8), ("stanford", 8)],
)  # fmt: skip
def test_the_number_of_ways(name, count, rng):
    robot = robokin.load(name)
    task = "pose" if plan_of(robot, np.zeros(robot.n)).whole else "position"
    for _, T in regular_poses(robot, rng, 3):
        lesson = explain_ik(robot, T, task=task, limits=False)
        assert [end.reason for end in lesson.ends] == [""] * count


def test_the_anthropomorphic_arm_has_the_four_postures_of_the_lecture():
    """W. Lucia, ENGR 7401 lecture 2, Inverse Kinematic: Anthropomorphic Arm."""
    robot = robokin.load("anthropomorphic")
    T = robokin.forward_kinematics(robot, [0.5, 0.7, 0.9])
    q = np.array([end.q for end in explain_ik(robot, T, task="position").ends])
    assert sorted(branch_names(robot, q)) == [
        "shoulder left, elbow down", "shoulder left, elbow up",
        "shoulder right, elbow down", "shoulder right, elbow up",
    ]  # fmt: skip


def test_the_planar_arm_is_solved_as_on_the_slide():
    """W. Lucia, ENGR 7401 lecture 2, 3 D.O.F planar manipulator (Closed Form Solution)."""
    robot = robokin.load("planar3r")
    a1, a2, a3 = 1.0, 0.6, 0.35
    phi, q = 1.1, np.array([0.4, 0.5, 0.2])
    T = robokin.forward_kinematics(robot, q)
    lesson = explain_ik(robot, T)
    first = {step.name: step.result.value for step in lesson.steps if step.branch in ("", "θ₂ +")}
    p_x, p_y = T[:2, 3] - a3 * np.array([np.cos(phi), np.sin(phi)])
    c2 = (p_x**2 + p_y**2 - a1**2 - a2**2) / (2 * a1 * a2)
    s2 = np.sqrt(1 - c2**2)
    c1 = ((a1 + a2 * c2) * p_x + a2 * s2 * p_y) / (p_x**2 + p_y**2)
    s1 = ((a1 + a2 * c2) * p_y - a2 * s2 * p_x) / (p_x**2 + p_y**2)
    slide = {"φ": phi, "p_Wx": p_x, "p_Wy": p_y, "c₂": c2, "s₂": s2, "θ₂": 0.5, "c₁": c1, "s₁": s1}
    slide |= {"θ₁": 0.4, "θ₃": 0.2}
    assert list(first) == ["T₀³", *slide]
    for name, value in slide.items():
        assert first[name] == pytest.approx(value, abs=1e-14)


# Arms that are in no library -------------------------------------------------------------------------------

RIGHT = np.pi / 2.0


def arm(rng, types, twists, lengths, turned):
    """A robot with random numbers: twists in right angles, lengths (a, d) as 0 or 1 for zero or any."""
    rows = []
    for letter, twist, (a, d) in zip(types, twists, lengths, strict=True):
        kind = JointType.REVOLUTE if letter == "R" else JointType.PRISMATIC
        cells = {"a": a * rng.uniform(0.2, 1.0) * rng.choice([-1, 1]), "alpha": twist * RIGHT}
        if kind is JointType.REVOLUTE:
            cells["d"] = d * rng.uniform(-0.3, 0.3)
        else:
            # Three slides must be at right angles, so that the second turns the third out of the first's way.
            cells["theta"] = RIGHT if types.startswith("PPP") else float(rng.choice([0.0, RIGHT, 0.4])) * turned
        rows.append(Joint(letter, kind, offset=float(rng.choice([0.0, RIGHT, 0.3])), **cells))
    base = transform(nearest_rotation(rng.normal(size=(3, 3))), rng.normal(size=3))
    tool = transform(nearest_rotation(rng.normal(size=(3, 3))), 0.1 * rng.normal(size=3))
    return Robot("random", tuple(rows), base=base, tool=tool)


def as_frames(robot, rng):
    """The same robot in the frames convention, its frames turned about and moved along the joints' axes."""
    rows, before = [], np.eye(4)
    for row in robot.rows:
        turn = transform(nearest_rotation(rng.normal(size=(3, 3))), np.zeros(3))
        inverse = transform(turn[:3, :3].T, np.zeros(3))
        rows.append(Joint(row.name, row.type, origin=before @ inverse, axis=turn[:3, 2].copy(), offset=row.offset))
        before = turn @ standard_dh(row.theta, row.d, row.a, row.alpha)
    return replace(robot, rows=tuple(rows), convention="frames", tool=before @ robot.tool)


ANY, NONE = (1, 1), (0, 0)
WRIST = ((0, 1), (0, 0), (0, 1))
KINDS = {
    "planar 2R": ("RR", lambda s: (1 - s[0], 0), ((1, 1), (1, 1))),
    "planar 3R": ("RRR", lambda s: (1 - s[0], 1 - s[1], 0), ((1, 1), (1, 1), (1, 1))),
    "SCARA": ("RRPR", lambda s: (1 - s[0], 1 - s[1], 0, 0), ((1, 1), (1, 1), (0, 0), (1, 1))),
    "SCARA, slide first": ("PRRR", lambda s: (1 - s[0], 1 - s[1], 0, 0), ((1, 1), (1, 1), (1, 0), (1, 1))),
    "RRP": ("RRP", lambda s: (1 - s[0], 1 - s[1], 0), ((1, 1), (1, 1), (1, 0))),
    "anthropomorphic": ("RRR", lambda s: (s[0], 1 - s[1], 0), ((1, 1), (1, 1), (1, 1))),
    "spherical": ("RRP", lambda s: (s[0], s[1], 0), ((1, 1), (1, 1), (1, 0))),
    "cylindrical": ("RPP", lambda s: (1 - s[0], s[1], 0), ((1, 1), (1, 0), (1, 0))),
    "cylindrical, out first": ("RPP", lambda s: (s[0], s[1], 0), ((1, 1), (1, 0), (1, 0))),
    "Cartesian": ("PPP", lambda s: (s[0], s[1], 0), ((1, 0), (1, 0), (1, 0))),
    "wrist": ("RRR", lambda s: (s[0], s[1], 1 - s[2]), WRIST),
    "anthropomorphic and wrist": ("RRRRRR", lambda s: (s[0], 1 - s[1], s[2], s[3], s[4], 0), (ANY, ANY, ANY, *WRIST)),
    "straight forearm and wrist": ("RRRRRR", lambda s: (s[0], 0, s[2], s[3], s[4], 0), (NONE, ANY, NONE, *WRIST)),
    "spherical and wrist": ("RRPRRR", lambda s: (s[0], s[1], s[2], s[3], s[4], 1), (ANY, ANY, (1, 0), *WRIST)),
    "cylindrical and wrist": ("RPPRRR", lambda s: (0, s[1], s[2], s[3], s[4], 1), ((1, 1), (1, 0), (1, 0), *WRIST)),
    "Cartesian and wrist": ("PPPRRR", lambda s: (s[0], s[1], s[2], s[3], s[4], 1), ((1, 0), (1, 0), (1, 0), *WRIST)),
    "SCARA and wrist": ("RRPRRR", lambda s: (1 - s[0], 1 - s[1], s[2], s[3], s[4], 0), (ANY, ANY, (1, 0), *WRIST)),
}  # fmt: skip
"""Types, twists by random signs, and which lengths are not zero."""


@pytest.mark.parametrize("kind", sweep(KINDS, 4))
def test_arms_of_any_make(kind, rng):
    types, twists, lengths = KINDS[kind]
    for _ in range(2):
        robot = arm(rng, types, twists(rng.choice([-1, 1], 6)), lengths, turned=kind.startswith(("planar", "SCARA")))
        for same in (robot, as_frames(robot, rng)):
            assert plan_of(same, np.zeros(same.n)) is not None, kind
            for _, T in regular_poses(same, rng, 1):
                solutions_match(same, T)
                if same.n <= 3 and not plan_of(same, np.zeros(same.n)).whole:
                    solutions_match(same, T, task="position")


# Where there is less to say --------------------------------------------------------------------------------


def test_a_point_out_of_reach_says_where_the_steps_end():
    robot = robokin.load("planar3r")
    T = robokin.forward_kinematics(robot, [0.3, 0.0, 0.0])
    T[:2, 3] *= 1.5
    (end,) = explain_ik(robot, T).ends
    assert end.q is None
    assert end.reason.startswith("c₂ = 4.39219")
    assert "> 1: out of reach, the links are too short" in end.reason
    T[:2, 3] = T[:2, :2] @ [0.35 + 0.1, 0.0]
    (end,) = explain_ik(robot, T).ends
    assert "< −1: out of reach, the point is too near" in end.reason


def test_the_shoulder_of_a_puma_keeps_its_distance():
    robot = robokin.load("puma560")
    T = robokin.forward_kinematics(robot, np.zeros(6))
    T[:3, 3] += np.array([0.05, 0.05, 0.3]) - robokin.link_frames(robot, np.zeros(6))[4, :3, 3]
    (end,) = explain_ik(robot, T).ends
    assert end.reason == "r < |d|: out of reach, W is nearer to axis 1 than the arm's plane"


def test_a_straight_wrist_keeps_its_first_joint():
    robot = robokin.load("puma560")
    q = np.array([0.2, -0.4, 0.6, 0.0, 0.0, 1.0])
    T = robokin.forward_kinematics(robot, q)
    for near in (None, np.array([0.0, 0.0, 0.0, 0.3, 0.0, 0.0])):
        ends = [end.q for end in explain_ik(robot, T, near=near).ends if end.q is not None and not end.reason]
        kept = q if near is None else q + np.array([0.0, 0.0, 0.0, 0.3, 0.0, -0.3])
        assert min(np.max(np.abs(end - kept)) for end in ends) < 1e-9


def test_a_stretched_arm_has_one_way():
    robot = robokin.load("planar2r")
    T = robokin.forward_kinematics(robot, [0.7, 0.0])
    lesson = solutions_match(robot, T)
    assert len(lesson.ends) == 1
    assert "both signs are one" in next(step for step in lesson.steps if step.name == "s₂").note


def test_a_target_on_the_first_axis_leaves_it_open():
    robot = robokin.load("anthropomorphic")
    T = transform(np.eye(3), [0.0, 0.0, 0.5])
    (end,) = explain_ik(robot, T, task="position").ends
    assert end.reason == "W lies on axis 1: θ₁ may have any value"


def test_what_a_positioning_arm_cannot_choose_is_said():
    robot = robokin.load("anthropomorphic")
    T = robokin.forward_kinematics(robot, [0.5, 0.7, 0.9])
    reasons = [end.reason for end in explain_ik(robot, T).ends]
    assert sorted(reasons) == ["", *["reaches the position, and not the orientation"] * 3]
    flat = robokin.load("planar2r")
    reasons = [end.reason for end in explain_ik(flat, transform(np.eye(3), [1.0, 0.5, 0.2]), task="position").ends]
    assert reasons == ["misses the position: the arm has no joint for what is left"] * 2


def test_joints_outside_their_limits_are_named():
    robot = robokin.load("spherical")
    T = robokin.forward_kinematics(robot, [0.5, 0.7, 0.9])
    reasons = {end.reason for end in explain_ik(robot, T, task="position").ends}
    assert reasons == {"", "outside the joint limits: q₃"}


@pytest.mark.parametrize("name", ["ur5", "iiwa7", "scorbot", "panda"])
def test_arms_without_a_lesson(name):
    robot = robokin.load(name)
    with pytest.raises(InputError, match="has no lesson, expected one of these: planar 2R and 3R arms"):
        explain_ik(robot, np.eye(4))


@pytest.mark.parametrize(("name", "task"), [("puma560", "position"), ("planar3r", "approach"), ("scara", "position")])
def test_a_lesson_that_starts_from_the_whole_pose(name, task):
    with pytest.raises(InputError, match="leaves the orientation open"):
        explain_ik(robokin.load(name), np.eye(4), task=task)
