"""The language of printed formulas."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robokin.derivation.formulas import evaluate, tokens
from robokin.spatial import invert, rotation_from_axis_angle, transform

Z = rotation_from_axis_angle([0.0, 0.0, 1.0], 0.3)


@pytest.mark.parametrize(
    ("formula", "value"),
    [
        ("2·x − y/4", 2 * 3.0 - 5.0 / 4),
        ("x − y − 1", 3.0 - 5.0 - 1.0),
        ("−x² + y", -9.0 + 5.0),
        ("(x² + y² − 1) / (2·x·y)", 33.0 / 30.0),
        ("x / y / 2", 0.3),
        ("−√(x² + y²)", -math.sqrt(34.0)),
        ("+√(1 − (x/y)²)", 0.8),
        ("atan2(−x, −y)", math.atan2(-3.0, -5.0)),
        ("cos(x)·sin(y)", math.cos(3.0) * math.sin(5.0)),
        ("0", 0.0),
    ],
)
def test_numbers(formula, value):
    assert evaluate(formula, {"x": 3.0, "y": 5.0}) == pytest.approx(value, abs=1e-15)


def test_a_name_with_an_index_is_no_square():
    values = {"R₀³": Z, "a": 2.0, "a₁": 3.0}
    assert tokens("(R₀³)ᵀ·a₁²", values) == ["(", "R₀³", ")", "ᵀ", "·", "a₁", "²"]
    assert evaluate("a₁²·a", values) == 18.0


def test_matrices_and_vectors():
    p, q = np.array([1.0, 2.0, 3.0]), np.array([0.0, -1.0, 2.0])
    T = transform(Z, p)
    values = {"R": Z, "p": p, "q": q, "T": T, "d": 2.0}
    np.testing.assert_allclose(evaluate("Rᵀ·(p − d·q)", values), Z.T @ (p - 2.0 * q), atol=1e-15)
    np.testing.assert_allclose(evaluate("T⁻¹·T·T⁻¹", values), invert(T), atol=1e-15)
    np.testing.assert_allclose(evaluate("R_z(d)·R_z(d)ᵀ", values), np.eye(3), atol=1e-15)
    assert evaluate("p·q", values) == 4.0


@pytest.mark.parametrize("formula", ["2·u", "x x", "x ^ 2"])
def test_what_is_no_formula(formula):
    with pytest.raises(ValueError, match="expected"):
        evaluate(formula, {"x": 1.0})
