"""Questions drawn from a seed: the laws that numbers keep, and that keys are right."""

from __future__ import annotations

import hashlib
import itertools
import json
import os
import subprocess
import sys

import numpy as np
import pytest
from sweeps import sweep

import robokin
from robokin.formats.library import library_names, load_any
from robokin.grading.answers.answer_files import Row
from robokin.grading.answers.sheet_answers import SheetTask
from robokin.grading.answers.sheet_subjects import sheet_exercises
from robokin.grading.marking import Rules
from robokin.grading.questions.seeded_numbers import SeededNumbers
from robokin.grading.questions.sheet_marks import sheet_report
from robokin.grading.questions.sheets import WantedQuestion, drawn_sheet, wanted_questions
from robokin.grading.questions.student_names import file_names
from robokin.grading.questions.typed_numbers import angle_text, decimal_text, multiples, round_step
from robokin.model import Mechanism
from robokin.model.joint_units import in_units, joint_factors
from robokin.units import Units

STUDENTS = ["ada", "ben", "cem", "dora", "eva", "fil"]


def sheet(kinds, *names, students=STUDENTS, seed="7"):
    return drawn_sheet(sheet_exercises(wanted_questions(kinds), names, load_any), students, seed)


def marks(drawn, change=lambda question, answers: answers):
    """The marks of the right answers to a sheet, or of what is made of them."""
    tasks = []
    for question in drawn:
        one, given = question.exercise, question.given
        answers = dict(zip([q.name for q in one.quantities(given)], one.answers(given), strict=True))
        task = one.task(given, Row(change(question, answers), 1), question.student)
        tasks.append(
            SheetTask(task.id, task.question, task.answers, task.student, task.line, marker=one.subject(given))
        )
    return sheet_report("sheet", {one.id: one for one in drawn.exercises}, tasks, Rules(None))


# Numbers ----------------------------------------------------------------------------------------------------------


def test_numbers_are_those_of_a_hash_that_anybody_can_compute():
    names = json.dumps(["robokin questions", 1, "7", "ada"], ensure_ascii=True).encode()
    block = hashlib.sha256(names + bytes(8)).digest()
    expected = [int.from_bytes(block[i : i + 8], "big") % 1000 for i in range(0, 32, 8)]
    numbers = SeededNumbers("7", "ada")
    assert [numbers.below(1000) for _ in range(4)] == expected


def test_a_student_has_the_same_numbers_in_any_class():
    kinds = "fk,ik,ik-all,dh,jacobian,dof"
    whole = sheet(kinds, "planar3r-brac")
    alone = sheet(kinds, "planar3r-brac", students=["eva"])
    turned = sheet(kinds, "planar3r-brac", students=STUDENTS[::-1])
    assert whole.numbers[4] == alone.numbers[0] == turned.numbers[1]
    assert sheet(f"{kinds},fk", "planar3r-brac").numbers[4][:6] == whole.numbers[4]


def test_seeds_and_students_and_questions_have_numbers_of_their_own():
    drawn = sheet("fk:2", "puma560")
    more = sheet("fk:2", "puma560", seed="8")
    all_ = [json.dumps(given) for one in (drawn, more) for own in one.numbers for given in own]
    assert len(set(all_)) == len(all_)


@pytest.mark.parametrize(
    ("value", "decimals", "text"),
    [(0.125, 2, "0.13"), (-0.125, 2, "-0.13"), (2.5, 0, "3"), (-0.001, 2, "0"), (1e-17, 4, "0"), (12.0, 3, "12"),
     (0.1 + 0.2, 6, "0.3"), (99.9996, 3, "100"), (100.0, 0, "100"), (1.005, 2, "1.01")],
)  # fmt: skip
def test_numbers_are_rounded_half_away_from_zero(value, decimals, text):
    assert decimal_text(value, decimals) == text
    for off in (1e-13, -1e-13):  # what another kernel's last digits do
        assert decimal_text(value + off, decimals) == text


def test_half_a_turn_has_one_sign():
    assert angle_text(-180.0, 2, Units("mm", "deg")) == angle_text(180.0, 2, Units("mm", "deg")) == "180"
    assert angle_text(-np.pi, 4, Units("m", "rad")) == "3.1416"


def test_multiples_are_the_numbers_that_their_digits_say():
    assert multiples((5, -2), -0.1, 0.16) == [-0.1, -0.05, 0.0, 0.05, 0.1, 0.15]
    assert [round_step(length) for length in (0.07, 0.1, 9.99, 1.0)] == [(5, -2), (1, -1), (5, 0), (1, 0)]


# Questions --------------------------------------------------------------------------------------------------------

ARMS = ("puma560", "planar2r", "planar3r-brac", "anthropomorphic", "scara", "stanford", "ur5", "panda", "cylindrical",
        "raghavan-roth-rprrpr", "gen3-lite", "so-100", "human-arm", "cartesian", "spherical-wrist")  # fmt: skip


def kinds_for(name):
    entry = load_any(name)
    return ["dof"] if isinstance(entry, Mechanism) else ["fk", "ik", "ik-all", "dh", "jacobian"]


def drawn_kinds(name, students):
    for kind in kinds_for(name):
        try:
            exercises = sheet_exercises([WantedQuestion(kind)], [name], load_any)
            yield kind, drawn_sheet(exercises, students, "3")
        except robokin.InputError as error:
            assert "expected" in str(error)


@pytest.mark.parametrize("name", sweep(ARMS, 3))
def test_the_key_has_full_marks(name):
    for kind, drawn in drawn_kinds(name, STUDENTS):
        assert marks(drawn).score == 1.0, kind


@pytest.mark.slow
@pytest.mark.parametrize("part", range(8))
def test_the_key_has_full_marks_for_all_that_the_library_holds(part):
    """Some two thousand questions."""
    total = 0
    for name in library_names()[part::8]:
        if isinstance(load_any(name), (robokin.Robot, Mechanism)):
            for kind, drawn in drawn_kinds(name, STUDENTS[:2]):
                report = marks(drawn)
                assert report.right, (name, kind, report.items)
                total += len(report.items)
    assert total > 180


@pytest.mark.parametrize("name", sweep(("puma560", "planar3r-brac", "anthropomorphic", "ur5", "stanford"), 3))
def test_no_two_solutions_are_near_and_none_is_at_a_limit_or_singular(name):
    """By the solver without limits, and the Jacobian's determinant, in one convention of lengths or another."""
    drawn = sheet("ik", name)
    exercise = drawn.exercises[0]
    robot, allowed = exercise.robot, exercise.allowed
    for question in drawn:
        target = exercise.question(question.given)
        found = robokin.solve_ik(robot, target.T, limits=False, task=target.task)
        assert found.complete
        assert not found.families
        q = np.array([one.q for one in found.solutions])
        for one, other in itertools.combinations(q, 2):
            off = np.abs(np.remainder(one - other + np.pi, 2 * np.pi) - np.pi)
            assert np.max(np.where(robot.revolute, off / allowed.angle, np.abs(one - other) / allowed.position)) > 19
        for limit in robot.limits.T:
            bound = np.where(np.isfinite(limit), limit, 0.0)
            gap = np.where(
                robot.revolute, np.abs(np.remainder(q - bound + np.pi, 2 * np.pi) - np.pi), np.abs(q - bound)
            )
            assert np.all(gap[np.broadcast_to(np.isfinite(limit), gap.shape)] > 10 * allowed.angle)
        rows = list(exercise.form.rows)
        for one in q:  # a singular value of nothing would let a solution go on for a while
            J = robokin.jacobian(robot, one)[rows]
            assert np.linalg.svd(J / np.abs(J).max(), compute_uv=False)[-1] > 1e-3


@pytest.mark.parametrize("name", ["puma560", "scara", "planar2r"])
def test_numbers_that_are_given_can_be_typed(name):
    for question in sheet("fk,ik,jacobian", name):
        for value in question.given.get("q", []):
            assert len(f"{abs(value):g}") <= 5
        for text in (f"{value:.10g}" for key, value in question.given.items() if key not in ("q", "made_of")):
            assert len(text.lstrip("-").replace(".", "")) <= 8


def test_values_of_joints_are_inside_their_limits_and_no_right_angles():
    for question in sheet("fk:3", "puma560"):
        robot = question.exercise.robot
        q = np.radians(question.given["q"])
        assert robot.within_limits(q)
        assert all(value % 90 for value in question.given["q"])
        assert np.min(np.abs(q[:, None] - robot.limits)) > np.radians(2.5)


def test_an_arm_with_few_joints_never_makes_none_right():
    """A rounded target is beside what four joints reach; it is not said to be out of reach."""
    drawn = sheet("ik:2", "so-100", "scara", students=STUDENTS[:3])
    said = marks(drawn, lambda question, answers: {name: "none" if name == "q1" else "" for name in answers})
    assert said.passed == 0


def test_counts_are_of_mechanisms_that_hang_together():
    for question in sheet("dof:6", "four-bar", "rssr", "spherical-four-bar"):
        joints = question.given["joints"]
        links = 1 + max(max(joint[1:]) for joint in joints)
        reached = {0}
        for _ in joints:
            reached |= {b for _, a, b in joints if a in reached} | {a for _, a, b in joints if b in reached}
        assert reached == set(range(links))
        order = 6 if question.given["space"] == "spatial" else 3
        f = {"revolute": 1, "prismatic": 1, "cylindrical": 2, "universal": 2, "spherical": 3}
        count = order * (links - 1) - sum(order - f[kind] for kind, *_ in joints)
        assert question.exercise.answers(question.given) == [str(count)]


@pytest.mark.parametrize(
    ("kinds", "name", "said"),
    [
        ("ik-all", "panda", "infinitely many ways"), ("dh", "cartesian", "no lengths"),
        ("dh", "so-100", "no Denavit-Hartenberg table"), ("dh", "z1", "multiple of 90°"),
        ("fk", "four-bar", "ROBOT is missing"), ("fk", "assembly", "no joints"), ("dof", "gear-pair", "plain joints"),
        ("fk", "car", "neither"),
    ],
)  # fmt: skip
def test_what_cannot_be_asked_is_said(kinds, name, said):
    with pytest.raises(robokin.InputError, match=said):
        sheet(kinds, name)


@pytest.mark.parametrize("text", ["", "fk:0", "fk:x", "fkk", "fk,,ik", "fk:101", "fk:-1", "ik:1:2"])
def test_wrong_kinds_are_said(text):
    with pytest.raises(robokin.InputError, match="--questions"):
        wanted_questions(text)


# Slips ------------------------------------------------------------------------------------------------------------


def units_changed(names, factor):
    return lambda question, answers: {
        name: repr(float(text) * factor) if name.rstrip("123456") in names else text for name, text in answers.items()
    }


SLIPS = {
    "angle unit": ("ik", "puma560", units_changed(["q"], np.pi / 180)),
    "length unit": ("fk", "puma560", units_changed(["x", "y", "z"], 1e-3)),
    "roll and yaw": ("fk", "puma560", lambda _, own: own | {"roll": own["yaw"], "yaw": own["roll"]}),
    "sign": ("ik", "puma560", units_changed(["q"], -1.0)),
    "a and d": ("dh", "puma560", lambda _, own: {
        name: own[name[:-1] + {"a": "d", "d": "a"}[name[-1]]] if name[-2:] in (" a", " d") else text
        for name, text in own.items()}),
    "transposed": ("jacobian", "puma560", lambda _, own: dict(
        zip(own, np.array([*own.values()]).reshape(6, 6).T.ravel().tolist(), strict=True))),
    "ground": ("dof", "six-bar", lambda _, own: {"freedoms": str(int(own["freedoms"]) - 3)}),
}  # fmt: skip


@pytest.mark.parametrize("slip", SLIPS)
def test_a_slip_is_named(slip):
    kind, name, change = SLIPS[slip]
    report = marks(sheet(kind, name), change)
    named = [item.mistake == slip for item in report.items]
    assert report.passed == 0
    assert sum(named) >= len(named) - 1, [item.mistake for item in report.items]


def test_a_slip_that_is_in_all_solutions_is_named():
    """The elbow's sign is wrong in both: the right angles of the first joint then lead elsewhere."""
    changed = {"solution 1 q2": -1.0, "solution 2 q2": -1.0}
    report = marks(
        sheet("ik-all", "planar2r"),
        lambda _, own: {name: repr(float(text) * changed.get(name, 1.0)) for name, text in own.items()},
    )
    assert [item.mistake for item in report.items] == ["sign"] * len(STUDENTS)


@pytest.mark.parametrize("name", ["planar2r", "stanford", "scara", "anthropomorphic"])
def test_joint_values_with_the_decimals_that_are_said_to_be_enough_are_right(name):
    """Each is off by as much as rounding can: up or down by half a unit of the last decimal, by chance."""
    rng = np.random.default_rng(5)

    def rounded(question, own):
        lengths, angles = question.exercise.enough_decimals(question.given)
        turning = [quantity.unit == "deg" for quantity in question.exercise.quantities(question.given)]
        robot = question.exercise.robot
        exact = in_units(question.exercise.solutions(question.given)[0], joint_factors(robot, robot.units))
        half = np.where(turning, 0.5 * 10.0**-angles, 0.5 * 10.0**-lengths)
        return dict(zip(own, map(repr, (exact + rng.choice([-1.0, 1.0], len(half)) * half).tolist()), strict=True))

    report = marks(sheet("ik", name), rounded)
    assert report.passed == len(STUDENTS)


# Names ------------------------------------------------------------------------------------------------------------

HOSTILE = ["../../etc/passwd", "/root", "..", ".", "=cmd()|'x'", "+1", "-1", "@x", "con", "CON.txt", "a/b", "a\\b",
           "Zoë", "李", "a" * 200, "x ", "ada", "Ada", "a.", ".a", "nul", "a:b", "a\tb", "%PATH%", "$HOME",
           "`id`"]  # fmt: skip


def test_names_of_files_are_names_of_files():
    names = file_names(HOSTILE)
    assert len({name.casefold() for name in names.values()}) == len(HOSTILE)
    for student, name in names.items():
        assert name[0].isalnum(), student
        assert name[-1].isalnum(), student
        assert len(name) <= 64, student
        assert set(name) <= set("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._@+-"), student
        assert name.casefold() not in ("con", "nul"), student
    assert file_names(["ada"]) == {"ada": "ada"}
    assert file_names(["s.ada@uni.edu"]) == {"s.ada@uni.edu": "s.ada@uni.edu"}


@pytest.mark.slow
def test_both_kernels_write_the_same_bytes(tmp_path):
    words = "check new puma560 ur5 planar2r scara --questions fk:2,ik:4,ik-all:2,dh,jacobian:2,dof:2 --seed 7 -o sheet"
    found = []
    for kernel in ("native", "python"):
        place = tmp_path / kernel
        place.mkdir()
        environment = {**os.environ, "ROBOKIN_KERNEL": kernel}
        code = "from robokin.cli import main; main()"
        subprocess.run([sys.executable, "-c", code, *words.split()], cwd=place, env=environment, check=True)
        files = sorted(path for path in place.rglob("*") if path.is_file())
        found.append({str(path.relative_to(place)): path.read_bytes() for path in files})
    assert found[0] == found[1]


def test_the_key_of_an_arm_of_few_joints_is_the_solution_of_the_pose_before_rounding():
    """A search for something near a rounded target ends where the tolerance does: such keys were wrong."""
    drawn = sheet("ik,ik-all", "h1-left", students=["s2", "s12"], seed="11")
    report = marks(drawn)
    assert report.right
    for question in drawn:
        near = min(
            np.max(np.abs(q - question.exercise.si(question.given["made_of"])))
            for q in question.exercise.solutions(question.given)
        )
        assert near < 1e-9
