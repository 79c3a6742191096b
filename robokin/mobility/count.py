"""Grübler's count, in both of its forms."""

from __future__ import annotations

from collections.abc import Iterable


def grubler(order: int, links: int, freedoms: Iterable[int]) -> int:
    """F = λ(n - j - 1) + Σf, the freedoms that the numbers of links and joints let one expect.

    `order` is λ (3 in the plane and on the sphere, 6 in space), `links` n counts the ground, and
    `freedoms` holds f for each of the j joints between two links.
    Source: M. Grübler, Getriebelehre, 1917; M. Yim, Robotics: Fundamentals, week 5.
    """
    f = list(freedoms)
    return order * (links - len(f) - 1) + sum(f)


def grubler_by_constraints(order: int, links: int, freedoms: Iterable[int]) -> int:
    """F = λ(n - 1) - ΣC with C = λ - f: always the same number as `grubler`."""
    return order * (links - 1) - sum(order - f for f in freedoms)
