"""Products of turns about z, shifts and constant rotations, in symbols.

Turns about one and the same direction are added before anything is multiplied: between two turns
stands a constant rotation, and where it leaves the z axis on its line, Rz(a) Rz(k) F Rz(b) =
Rz(a + k ± b) F with F = 1 or a half turn about x. What is left is a product of fewer factors,

    T = [Rz(A1) p1 + …] R1 [Rz(A2) …] R2 …,

each factor a planar arm of its own, `a2*c2 + a3*c23`. They are multiplied from the right end, which
nests the result, c1*(c23*(…) - s23*…) - s1*(…), as J. J. Craig, Introduction to Robotics, 3rd ed.,
eq. (3.14) prints the PUMA's.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from robokin.derivation.angle_sums import Angle, Trigonometry
from robokin.derivation.symbol_sums import ONE, ZERO, Sum, negative, number, times, total
from robokin.errors import InputError

Vector = tuple[Sum, Sum, Sum]
Matrix = tuple[tuple[Sum, ...], ...]

EXACT = 1e-15
"""An entry of a product of constant rotations this near to a number of a few digits (0, 1, 0.75) is meant
to be just that: the rounding of such a product is below it."""


MAX_SYMBOLS = 1_000_000
"""Symbols of a column that is worked out. An arm of seven joints has some hundred, the 21 joints of a human
body 100,000; every further turn about another axis makes it half as long again."""


@dataclass(frozen=True)
class Turn:
    """A rotation about z."""

    angle: Angle


@dataclass(frozen=True)
class SymbolicShift:
    """A translation."""

    vector: Vector


@dataclass(frozen=True)
class Tilt:
    """A constant rotation: `rows` (3, 3) in symbols, `values` (3, 3) what they are worth."""

    rows: Matrix
    values: tuple[tuple[float, ...], ...]


Element = Turn | SymbolicShift | Tilt

NOWHERE: Vector = (ZERO, ZERO, ZERO)


def _exact(value: float) -> float:
    short = float(f"{value:.12g}") if abs(value) > EXACT else 0.0
    return short if abs(value - short) <= EXACT else value


def tilt(values: Iterable[Iterable[float]]) -> Tilt:
    """A constant rotation (3, 3) in numbers; what is 0, ±1 or 0.5 but for rounding is exactly that."""
    clean = tuple(tuple(_exact(float(value)) for value in row) for row in values)
    return Tilt(tuple(tuple(number(value) for value in row) for row in clean), clean)


STILL = tilt(((1, 0, 0), (0, 1, 0), (0, 0, 1)))


@dataclass
class ProductPiece:
    """Rz(angle), then a half turn about x if `flipped`, then a translation."""

    angle: Angle = field(default_factory=Angle)
    flipped: bool = False
    shift: Vector = NOWHERE


@dataclass
class Group:
    """Turns about one direction, and the constant rotation after them."""

    pieces: list[ProductPiece]
    tilt: Tilt = STILL


def product(elements: Iterable[Element], trigonometry: Trigonometry) -> Matrix:
    """The product (4, 4) of the elements, from left to right. Raises InputError when it is endlessly long."""
    columns: list[Vector] = [_column(STILL.rows, j) for j in range(3)]
    position = NOWHERE
    for group in reversed(_groups(elements)):
        last = group.pieces[-1]
        columns = [_turned(last, _mapped(group.tilt, column), trigonometry) for column in columns]
        ends = [_turned(last, _sum(_mapped(group.tilt, position), last.shift), trigonometry)]
        ends += [_turned(piece, piece.shift, trigonometry) for piece in group.pieces[:-1]]
        position = _sum(*ends)
        if sum(entry.size for entry in position + columns[0]) > MAX_SYMBOLS:
            raise InputError(
                f"the product of the matrices has over {MAX_SYMBOLS:,} symbols, "
                "expected a chain with fewer turns about different axes"
            )
    rows = [(*(column[i] for column in columns), position[i]) for i in range(3)]
    return (*rows, (ZERO, ZERO, ZERO, ONE))


def _groups(elements: Iterable[Element]) -> list[Group]:
    groups = [Group([ProductPiece()])]
    for element in elements:
        group = groups[-1]
        if isinstance(element, SymbolicShift):
            last = group.pieces[-1]
            last.shift = _sum(last.shift, _mapped(group.tilt, element.vector))
        elif isinstance(element, Tilt):
            group.tilt = _after(group.tilt, element)
        elif not element.angle.parts:  # nothing that moves: no reason to part what is parallel
            group.tilt = _after(group.tilt, _quarters(element.angle.quarters))
        else:
            piece = _continued(group, element.angle)
            if piece is None:
                groups.append(Group([ProductPiece(element.angle)]))
            else:
                group.pieces.append(piece)
                group.tilt = STILL
    return groups


def _continued(group: Group, angle: Angle) -> ProductPiece | None:
    """The piece that a turn adds to a group; None when its axis has another direction."""
    (c, _, _), (s, _, _), (_, _, z) = group.tilt.values
    quadrants = {(1.0, 0.0): 0, (0.0, 1.0): 1, (-1.0, 0.0): 2, (0.0, -1.0): 3}
    if abs(z) != 1.0 or (c, s) not in quadrants:
        return None
    last = group.pieces[-1]
    flipped = last.flipped != (z < 0)
    turned = last.angle.plus(Angle(quadrants[c, s]), -1 if last.flipped else 1)
    return ProductPiece(turned.plus(angle, -1 if flipped else 1), flipped)


def _quarters(count: int) -> Tilt:
    c, s = ((1, 0), (0, 1), (-1, 0), (0, -1))[count % 4]
    return tilt(((c, -s, 0), (s, c, 0), (0, 0, 1)))


def _after(first: Tilt, second: Tilt) -> Tilt:
    values = tuple(
        tuple(sum(first.values[i][k] * second.values[k][j] for k in range(3)) for j in range(3)) for i in range(3)
    )
    clean = tilt(values)
    if all(value in (0.0, 1.0, -1.0) for row in clean.values for value in row):
        return clean
    columns = [_mapped(first, _column(second.rows, j)) for j in range(3)]
    return Tilt(tuple(tuple(column[i] for column in columns) for i in range(3)), clean.values)


def _column(rows: Sequence[Sequence[Sum]], j: int) -> Vector:
    return rows[0][j], rows[1][j], rows[2][j]


def _mapped(by: Tilt, v: Vector) -> Vector:
    x, y, z = (total(times(a, b) for a, b in zip(row, v, strict=True)) for row in by.rows)
    return x, y, z


def _sum(*vectors: Vector) -> Vector:
    x, y, z = (total(parts) for parts in zip(*vectors, strict=True))
    return x, y, z


def _turned(piece: ProductPiece, v: Vector, trigonometry: Trigonometry) -> Vector:
    if not any(v):
        return v
    c, s = trigonometry.cos(piece.angle), trigonometry.sin(piece.angle)
    x, y, z = (v[0], negative(v[1]), negative(v[2])) if piece.flipped else v
    return total((times(c, x), negative(times(s, y)))), total((times(s, x), times(c, y))), z
