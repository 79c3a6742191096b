"""Sums of products of symbols, kept as a person would write them: `c1*(a2*c2 + a3*c23) - s1*d3`.

A product does not multiply a sum out: the sum becomes one factor in parentheses, so that what is
multiplied from the right end of a chain comes out nested and short. A sum joins terms that are alike,
takes out what all its terms have in common, and puts its terms and factors in a fixed order:
link lengths, cosines and sines along the chain, joint offsets, parentheses; in a sum first the terms
that begin with a link length, then the longer ones.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

LEAD, TURN, TRAIL, NESTED = range(4)
"""The first number of a symbol's place: lengths across an axis (`a2*c2`), cosines and sines, lengths
along an axis (`c2*d3`); parentheses come last."""

CANCELLED = 1e-13
"""Two coefficients whose sum is this small beside them are opposite: rounding of the products of a few
cosines is near 1e-16, and no coefficient that is meant differs so little from another."""


class Symbol(NamedTuple):
    """A name, and its place among the factors of a product."""

    place: tuple[int, ...]
    name: str


class Sum:
    """Terms in order; none is zero. Equal when the terms are; `size` counts the symbols."""

    __slots__ = ("_hash", "size", "terms")

    def __init__(self, terms: tuple[Product, ...]) -> None:
        self.terms = terms
        self.size = sum(_size(term) for term in terms)
        self._hash = hash(terms)

    def __eq__(self, other: object) -> bool:
        """Whether both have the same terms in the same order."""
        return self is other or (isinstance(other, Sum) and self._hash == other._hash and self.terms == other.terms)

    def __hash__(self) -> int:
        """Of the terms, computed once: sums are nested deeply."""
        return self._hash

    def __bool__(self) -> bool:
        """Whether it is not zero."""
        return bool(self.terms)

    def __repr__(self) -> str:
        """The terms."""
        return f"Sum({self.terms})"


class Product(NamedTuple):
    """A product: a number and factors, each a symbol or a sum in parentheses."""

    coefficient: float
    factors: tuple[Symbol | Sum, ...] = ()


def number(value: float) -> Sum:
    """A number as a sum."""
    return Sum((Product(_tidy(value)),)) if value else ZERO


def symbol(name: str, *place: int) -> Sum:
    """A symbol as a sum."""
    return Sum((Product(1, (Symbol(place, name),)),))


def negative(a: Sum) -> Sum:
    """-a."""
    return Sum(tuple(Product(-term.coefficient, term.factors) for term in a.terms))


def times(a: Sum, b: Sum) -> Sum:
    """a b, not multiplied out."""
    if not a or not b:
        return ZERO
    first, second = _as_term(a), _as_term(b)
    factors = tuple(sorted(first.factors + second.factors, key=_factor_place))
    return _flat(Product(_tidy(first.coefficient * second.coefficient), factors))


def total(parts: Iterable[Sum]) -> Sum:
    """The sum of all parts, in order, with what all its terms share taken out."""
    coefficients: dict[tuple[Symbol | Sum, ...], float] = {}
    for part in parts:
        for coefficient, factors in part.terms:
            before = coefficients.get(factors, 0)
            after = before + coefficient
            gone = abs(after) <= CANCELLED * max(abs(before), abs(coefficient))
            coefficients[factors] = 0 if gone else after
    terms = [Product(_tidy(value), factors) for factors, value in coefficients.items() if value]
    if len(terms) > 1:
        first = dict.fromkeys(terms[0].factors)
        shared = [factor for factor in first if all(factor in term.factors for term in terms[1:])]
        if shared:
            rest = total(Sum((_without(term, shared),)) for term in terms)
            return times(Sum((Product(1, tuple(shared)),)), rest)
    return Sum(tuple(sorted(terms, key=_term_place)))


def symbols_of(sums: Iterable[Sum]) -> list[Symbol]:
    """Every symbol in the sums, once, in order."""
    found: set[Symbol] = set()
    seen: set[Sum] = set()

    def visit(a: Sum) -> None:
        if a in seen:
            return
        seen.add(a)
        for term in a.terms:
            for factor in term.factors:
                if isinstance(factor, Sum):
                    visit(factor)
                else:
                    found.add(factor)

    for a in sums:
        visit(a)
    return sorted(found)


def _without(term: Product, shared: list[Symbol | Sum]) -> Product:
    left = list(term.factors)
    for factor in shared:
        left.remove(factor)
    return Product(term.coefficient, tuple(left))


def _as_term(a: Sum) -> Product:
    """A sum as one product. What goes into parentheses begins with a positive term."""
    if len(a.terms) == 1:
        return a.terms[0]
    if a.terms[0].coefficient < 0:
        return Product(-1, (negative(a),))
    return Product(1, (a,))


def _flat(term: Product) -> Sum:
    """A product as a sum; one that is nothing but parentheses and a sign is the sum in them."""
    inner = term.factors[0] if len(term.factors) == 1 else None
    if isinstance(inner, Sum) and abs(term.coefficient) == 1:
        return inner if term.coefficient > 0 else negative(inner)
    return Sum((term,))


def _tidy(value: float) -> float:
    """A whole number as an int, so that it is written without a point."""
    return int(value) if value == int(value) else value


def _size(term: Product) -> int:
    return sum(factor.size if isinstance(factor, Sum) else 1 for factor in term.factors)


def _factor_place(factor: Symbol | Sum) -> tuple[int, ...]:
    return (NESTED, -factor.size) if isinstance(factor, Sum) else factor.place


def _term_place(term: Product) -> tuple[tuple[int, ...], ...]:
    first = next(_leads(term), None)
    led = (0, *first.place) if first else (1,)
    return (led, (-_size(term),), *map(_factor_place, term.factors))


def _leads(term: Product) -> Iterator[Symbol]:
    return (factor for factor in term.factors if isinstance(factor, Symbol) and factor.place[0] == LEAD)


ZERO = Sum(())
ONE = Sum((Product(1),))
