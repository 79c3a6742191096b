"""Numbers that note how they came about: what is calculated of other ones is what the calculation gives of them."""

from __future__ import annotations

import math

import pytest

from robokin.kernel.entries import dot, root
from robokin.kernel.traced_numbers import NumberTrace, Traced


def calculated(a, b):
    """Some sums, products and quotients, by a way that hangs on which is greater."""
    if a > b:
        return (1.0 - a) / (2.0 * b + -a), root(a * a + b * b)
    return dot([a, 0.0, b], [b, 1.0, 3.0]), abs(b - a) / 4.0


def traced(a, b):
    trace = NumberTrace()
    results = calculated(trace.given(a), trace.given(b))
    return trace.function([one.name for one in results]), results


def test_other_numbers_go_the_same_way(rng):
    for _ in range(20):
        a, b, c, d = rng.uniform(0.1, 2.0, 4).tolist()
        function, results = traced(a, b)
        assert all(isinstance(one, Traced) for one in results)
        assert function([a, b]) == calculated(a, b) == tuple(float(one) for one in results)
        assert function([c, d]) == (calculated(c, d) if (a > b) == (c > d) else None)


def test_numbers_that_are_spared_in_plain_calculations_are_not_in_traced_ones():
    function, _ = traced(0.0, 1.0)
    assert function([0.25, 0.5]) == calculated(0.25, 0.5)


def test_what_is_not_noted_is_refused():
    one = NumberTrace().given(2.0)
    with pytest.raises(TypeError):
        2 * one
    assert not isinstance(math.sin(one), Traced)
