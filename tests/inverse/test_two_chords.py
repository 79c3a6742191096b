"""Equations of the second degree in cosine and sine, as code: every angle that made one; arms that ask for one."""

from __future__ import annotations

import numpy as np
import pytest
from inverse.loops import parallel_loop, spherical_loop, values_of

import robokin
from robokin.inverse.closed_form.form_code import FormCode
from robokin.inverse.closed_form.form_tape import form_tape
from robokin.inverse.closed_form.spherical_wrist import SphericalTriple
from robokin.inverse.closed_form.straight_forms import _function, compiled_form, straight_source
from robokin.inverse.closed_form.three_parallel_axes import ThreeParallel
from robokin.inverse.closed_form.trigonometry import second_degree_roots
from robokin.inverse.closed_form.two_chords import turns_of_second_degree
from robokin.inverse.elimination.loop_newton import closing_at
from robokin.inverse.hold import held_arm
from robokin.inverse.one_target_arm import one_target_arm
from robokin.kernel.code_lines import Term

ROUNDING = 1e-14
"""Of an equation with coefficients of length 1."""

FOURTH = [("panda", 4), ("xarm7", 4), ("gen72", 4)]
"""Arms and joints (from 0) whose others have a shoulder in one point, and an equation of the fourth degree."""


@pytest.fixture(scope="module")
def angles_of():
    """The code for an equation of five coefficients, as a function that gives its angles, or None."""
    code = FormCode()
    names = ("r00", "r01", "r02", "r03", "r10")
    place = code.angle(turns_of_second_degree(code, [Term.named(code, name) for name in names]))
    head = ", ".join(f"r{i}{j}" for i in range(3) for j in range(4))
    source = _function(code, head, [[f"a{place}"] * 6])
    assert form_tape(source) is not None
    form = compiled_form(source)

    def angles(h):
        leaves = form([*map(float, h), *[0.0] * 7])
        return None if leaves is None else np.array([leaf[0] for leaf in leaves])

    return angles


def chord(a, b):
    """The line through the circle's points at two angles: x c + y s + z = 0."""
    return np.cos((a + b) / 2), np.sin((a + b) / 2), -np.cos((a - b) / 2)


def equation(theta):
    """The equation whose angles are four given ones: a product of two chords."""
    (x, y, z), (u, v, w) = chord(*theta[:2]), chord(*theta[2:])
    return [z * w + 0.5 * (x * u + y * v), x * w + z * u, y * w + z * v, 0.5 * (x * u - y * v), 0.5 * (x * v + y * u)]


def value(h, theta):
    return h[0] + h[1] * np.cos(theta) + h[2] * np.sin(theta) + h[3] * np.cos(2 * theta) + h[4] * np.sin(2 * theta)


def gaps(one, other):
    """How far each angle of either is from the nearest of the other."""
    off = np.abs(np.remainder(one[:, None] - other + np.pi, 2 * np.pi) - np.pi)
    return max(off.min(axis=0).max(), off.min(axis=1).max())


def test_four_angles_are_found_of_the_equation_that_they_make(angles_of, rng):
    answered = 0
    for theta in rng.uniform(-np.pi, np.pi, (1000, 4)):
        h = np.array(equation(theta)) * 10.0 ** rng.uniform(-4, 3)
        found = angles_of(h)
        if found is None:
            continue
        answered += 1
        assert len(found) == 4
        assert np.max(np.abs(value(h, found))) < ROUNDING * np.linalg.norm(h)
        separate = np.min(np.abs(np.sin(0.5 * (theta[:, None] - theta)[np.triu_indices(4, 1)])))
        assert gaps(found, theta) < 1e-13 / separate**2
    assert answered > 990


@pytest.mark.parametrize("round_ones", [[], [2, 4], [1, 3], [4], [1, 2]])
def test_as_many_angles_are_real_as_by_eigenvalues(angles_of, round_ones, rng):
    counts = set()
    for _ in range(400):
        h = rng.normal(size=5) * 10.0 ** rng.uniform(-2, 0, 5)
        h[round_ones] = 0.0
        found = angles_of(h)
        (c, s), real = second_degree_roots([np.array([part]) for part in h])
        wanted = np.arctan2(s, c)[real]
        if found is None:
            continue  # pairs that coincide for a symmetry
        assert len(found) == len(wanted), h
        counts.add(len(found))
        assert not len(found) or gaps(found, wanted) < 1e-6
    assert counts == {0, 4} if round_ones == [1, 2] else counts == {0, 2, 4}


def test_angles_that_nearly_meet_are_all_kept_or_left_to_others(angles_of, rng):
    for theta in rng.uniform(-np.pi, np.pi, (1500, 4)):
        theta[1] = theta[0] + 10.0 ** rng.uniform(-9, -1)
        if rng.random() < 0.3:
            theta[2] = theta[0] - 10.0 ** rng.uniform(-9, -1)
        found = angles_of(equation(theta))
        assert found is None or len(found) == 4
        assert found is None or gaps(found, theta) < 1e-3


@pytest.mark.parametrize("h", [[1, 0, 0, 0, 0], [0, 0, 0, 1, 0], [1, 2, 0, 0, 0], [0, 0, 0, 0, -1], [1, 0, 0, 1, 0]])
def test_equations_of_round_numbers_have_an_answer_or_none(angles_of, h):
    found = angles_of(h)
    assert found is None or np.max(np.abs(value(np.array(h), found)), initial=0.0) < 1e-9


def loops(rng):
    """Loops whose first equation has the fourth degree."""
    for first in range(4):
        for special in (False, True):
            yield from ((SphericalTriple, spherical_loop(rng, first, "RRR", special)) for _ in range(4))
            yield from ((ThreeParallel, parallel_loop(rng, first, "RRR", special)) for _ in range(4))


def test_the_code_gives_what_the_arrays_give(rng):
    seen, asked, answered = set(), 0, 0
    for form, loop in loops(rng):
        solver = form.find(loop)
        if solver is None or (solver.pair.rank if form is SphericalTriple else solver.rank) != 2:
            continue
        source = straight_source(solver)
        tape = form_tape(source)
        assert tape.slots < 512
        assert len(tape.leaves) << tape.levels == 8
        straight = compiled_form(source)
        seen.add(form)
        closing = closing_at(loop, values_of(loop, rng, 10))
        wanted = solver.candidates(closing)
        for k, target in enumerate(closing):
            leaves = straight(target[:3].ravel().tolist())
            theirs = wanted.values[wanted.index == k]
            asked += 1
            if leaves is None or len(leaves) != len(theirs):
                continue
            off = np.abs(np.remainder(np.array(leaves)[:, None] - theirs + np.pi, 2 * np.pi) - np.pi).max(axis=2)
            answered += bool(max(off.min(axis=0).max(), off.min(axis=1).max()) < 1e-5)
    assert len(seen) == 2
    assert answered > 0.95 * asked > 100


@pytest.mark.parametrize(("name", "joint"), FOURTH)
def test_held_arms_of_the_library_are_answered_as_by_the_blocks(name, joint, rng, monkeypatch):
    robot = robokin.load(name)
    part = held_arm(robot, {joint: 0.7318}).part
    assert one_target_arm(part).form is not None
    q = rng.uniform(*np.clip(part.limits, -3.1, 3.1).T, (25, 6))
    T = robokin.forward_kinematics(part, q)
    found = [robokin.solve_ik(part, target) for target in T]
    monkeypatch.setattr("robokin.inverse.answered_batch.kernel_form", lambda request: None)
    for one, other in zip(found, robokin.solve_ik(part, T), strict=True):
        for name in ("complete", "basis", "certificate", "reason", "counts", "method"):
            assert getattr(one, name) == getattr(other, name), name
        assert len(one) == len(other)
        assert all(np.max(np.abs(a.q - b.q)) < 1e-9 for a, b in zip(one, other, strict=True))
        assert [a.branch for a in one] == [b.branch for b in other]
