"""Tables of robots whose joints hang on each other: the axes, what hangs on what, and how much."""

from __future__ import annotations

import numpy as np
import pytest

import robokin
from robokin.grading.same_robot import compare_tables
from robokin.grading.tolerance import default_tolerance
from robokin.kinematics.dh_table import to_convention

ROWS = """
  - {name: A, type: R, d: 100, a: 0, alpha: 90}
  - {name: B, type: R, d: 0, a: 200, alpha: 0}
  - {name: C, type: R, d: 0, a: 150, alpha: 0}
  - {name: D, type: helical, d: 10, a: 0, alpha: 0, pitch: 5}
"""
FOLLOWS = "{joint: C, follows: B, ratio: 2/3, offset: 5}"


def arm(tmp_path, coupling=FOLLOWS, rows=ROWS, base=""):
    text = f"robokin: 1\nname: Arm\nunits: {{length: mm, angle: deg}}\n{base}joints:{rows}"
    path = tmp_path / "arm.yaml"
    path.write_text(text + (f"couplings:\n  - {coupling}\n" if coupling else ""))
    return robokin.load(path)


def compared(right, given, free=()):
    return compare_tables(right, given, default_tolerance(right, table=True), frozenset(free))


def test_a_table_is_itself_in_every_convention(tmp_path):
    right = arm(tmp_path)
    for convention in ("standard", "modified", "frames"):
        found = compared(right, to_convention(right, convention))
        assert found.same
        assert (found.score, found.couplings) == (1.0, ())


@pytest.mark.parametrize(
    ("coupling", "expected"),
    [
        ("{joint: C, follows: B, ratio: 0.5, offset: 5}", ((2, 0.5),)),
        ("{joint: C, follows: B, ratio: -2/3, offset: 5}", ((2, -2 / 3),)),
        ("{joint: C, follows: A, ratio: 2/3, offset: 5}", ((1, 2 / 3),)),
        ("{joint: C, adds: B, ratio: 2/3, offset: 5}", ((2, 2 / 3), (3, 1.0))),
    ],
)
def test_what_a_joint_hangs_on_counts_and_nothing_left_open_excuses_it(tmp_path, coupling, expected):
    right, given = arm(tmp_path), arm(tmp_path, coupling)
    for free in ((), ("base", "tool", "zero", "sign")):
        for a, b, found in ((right, given, expected), (given, right, ((2, 2 / 3),))):
            verdict = compared(a, b, free)
            assert not verdict.same
            assert verdict.needs is None
            (one,) = verdict.couplings
            assert one.joint == 3
            assert [joint for joint, _ in one.found] == [joint for joint, _ in found]
            assert [ratio for _, ratio in one.found] == pytest.approx([ratio for _, ratio in found])
            assert verdict.score == pytest.approx(1.0 - 1.0 / (5 - ("tool" in free)))


def test_an_offset_is_a_zero_and_a_pitch_is_no_length(tmp_path):
    right = arm(tmp_path)
    shifted = arm(tmp_path, FOLLOWS.replace("5}", "8}"))
    assert not compared(right, shifted).same
    assert compared(right, shifted, ("zero",)).same
    screw = arm(tmp_path, rows=ROWS.replace("pitch: 5", "pitch: 6"))
    (one,) = compared(right, screw).couplings
    assert (one.joint, one.pitches) == (4, pytest.approx((6e-3 / (2 * np.pi), 5e-3 / (2 * np.pi))))


def test_senses_that_are_open_turn_ratios_too(tmp_path):
    right = arm(tmp_path, rows=ROWS.replace("helical", "R").replace(", pitch: 5", ""))
    # Joint 3 the other way round, its axis turned over: the ratio changes its sign with it.
    rows = """
  - {name: A, type: R, d: 100, a: 0, alpha: 90}
  - {name: B, type: R, d: 0, a: 200, alpha: 180}
  - {name: C, type: R, d: 0, a: 150, alpha: 180}
  - {name: D, type: R, d: 10, a: 0, alpha: 0}
"""
    given = arm(tmp_path, "{joint: C, follows: B, ratio: -2/3, offset: -5}", rows)
    q = np.random.default_rng(3).uniform(-2, 2, (5, 3))
    assert np.allclose(robokin.forward_kinematics(right, q), robokin.forward_kinematics(given, q))
    assert compared(right, given, ("sign",)).same
    assert not compared(right, arm(tmp_path, FOLLOWS, rows), ("sign", "zero")).same


def test_joints_that_no_coupling_moves_are_other_ones(tmp_path):
    right, plain = arm(tmp_path), arm(tmp_path, "", ROWS.replace("helical", "R").replace(", pitch: 5", ""))
    assert [one.joint for one in compared(plain, right).couplings] == [3, 4]
    assert [one.joint for one in compared(right, plain).couplings] == [3, 4]
    assert compared(right, robokin.load("puma560")).match is None
