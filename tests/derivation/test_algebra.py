"""Sums and products stay what they are worth, short, and in one order."""

from __future__ import annotations

import numpy as np
import pytest

from robokin.derivation.angle_sums import Angle, NamedAngle, Trigonometry
from robokin.derivation.symbol_sums import (
    LEAD,
    ONE,
    TRAIL,
    TURN,
    ZERO,
    negative,
    number,
    symbol,
    symbols_of,
    times,
    total,
)
from robokin.derivation.written_sums import written

A2, C1, S1, D3 = symbol("a2", LEAD, 2), symbol("c1", TURN, 1, 0), symbol("s1", TURN, 1, 1), symbol("d3", TRAIL, 3)


def test_factors_stand_as_lectures_write_them():
    assert written(times(times(D3, C1), A2)) == "a2*c1*d3"
    assert written(times(times(S1, number(-2)), C1)) == "-2*c1*s1"
    assert written(times(C1, total([D3, A2]))) == "c1*(a2 + d3)"


def test_like_terms_join_and_opposite_ones_vanish():
    assert total([A2, C1, negative(A2)]) == C1
    assert total([A2, A2]) == times(number(2), A2)
    assert total([number(0.1), number(0.2), number(-0.3)]) == ZERO
    assert not total([])
    assert times(ZERO, A2) is ZERO
    assert times(ONE, total([A2, D3])) == total([A2, D3])


def test_what_all_terms_share_is_taken_out_once():
    assert written(total([times(C1, A2), times(C1, D3)])) == "c1*(a2 + d3)"
    assert written(total([times(C1, A2), times(S1, A2)])) == "a2*(c1 + s1)"
    assert written(total([times(C1, A2), times(S1, D3)])) == "a2*c1 + s1*d3"


def test_a_sign_stands_before_parentheses():
    inner = negative(total([A2, D3]))
    assert written(times(C1, inner)) == "-c1*(a2 + d3)"
    assert written(total([times(C1, inner), times(C1, negative(inner))])) == "0"
    assert written(negative(inner)) == "a2 + d3"


def random_sum(rng, depth):
    leaves = [A2, C1, S1, D3, number(float(rng.integers(-2, 3))), number(float(rng.normal()))]
    if depth == 0:
        return leaves[rng.integers(len(leaves))]
    parts = [random_sum(rng, depth - 1) for _ in range(rng.integers(1, 4))]
    return total(parts) if rng.random() < 0.5 else times(parts[0], parts[-1])


def test_random_expressions_keep_their_value(rng):
    scope = {"a2": 1.7, "c1": -0.6, "s1": 0.8, "d3": 0.3}

    for _ in range(500):
        a, b = random_sum(rng, 3), random_sum(rng, 3)
        x, y = eval(written(a), dict(scope)), eval(written(b), dict(scope))
        assert eval(written(total([a, b])), dict(scope)) == pytest.approx(x + y, abs=1e-11, rel=1e-11)
        assert eval(written(times(a, b)), dict(scope)) == pytest.approx(x * y, abs=1e-11, rel=1e-11)
        assert total([a, negative(a)]) == ZERO
        assert set(symbols_of([a])) <= {term.factors[0] for leaf in (A2, C1, S1, D3) for term in leaf.terms}


def test_cosines_and_sines_of_sums_of_angles(rng):
    trigonometry = Trigonometry(spaced=False)
    parts = [NamedAngle(i, str(i), f"q{i}") for i in (1, 2, 3)]
    q = rng.uniform(-3, 3, 3)
    for _ in range(200):
        signs = rng.integers(-1, 2, 3)
        angle = Angle(int(rng.integers(4)))
        for part, sign in zip(parts, signs, strict=True):
            if sign:
                angle = angle.plus(Angle(0, ((part, 1),)), int(sign))
        value = angle.quarters * np.pi / 2 + float(signs @ q)
        scope = {f"q{i}": each for i, each in enumerate(q, start=1)} | {"cos": np.cos, "sin": np.sin}
        for found, expected in ((trigonometry.cos(angle), np.cos(value)), (trigonometry.sin(angle), np.sin(value))):
            for name, function in trigonometry.functions.items():
                scope[name] = eval(f"{function.name}({function.argument})", dict(scope))
            assert eval(written(found), dict(scope)) == pytest.approx(expected, abs=1e-14)
