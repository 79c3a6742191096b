"""Two equations N x = e in x and y with a constant 2×2 matrix N, by the rank of N.

Rank 2: x = N⁻¹e. Rank 1: with n the direction of the greater row (the `main` one), the combination
e_rest - ratio e_main = 0 is free of x, and n · x = e_main / size is left.
"""

from __future__ import annotations

from robokin.kernel.entries import root

RANK = 1e-5
"""A matrix whose lesser row, but for its part along the greater, is shorter than this has rank 1, and one
whose rows are all shorter has rank 0. What is neglected is a change of the arm of that size, which Newton
steps make up for; two almost dependent equations would magnify rounding by the square of its inverse."""


class Pair:
    """The matrix N: rows of two numbers."""

    def __init__(self, rows: list[tuple[float, float]]) -> None:
        sizes = [root(row[0] * row[0] + row[1] * row[1]) for row in rows]
        self.main = 0 if sizes[0] >= sizes[1] else 1
        self.rest = 1 - self.main
        self.size = sizes[self.main]
        self.rank = 0
        if self.size < RANK:
            return
        (a, b), (c, d) = rows
        determinant = a * d - b * c
        self.n = rows[self.main][0] / self.size, rows[self.main][1] / self.size
        self.ratio = (a * c + b * d) / (self.size * self.size)
        self.rank = 2 if abs(determinant) >= RANK * self.size else 1
        if self.rank == 2:
            self.inverse = [[d / determinant, -b / determinant], [-c / determinant, a / determinant]]
