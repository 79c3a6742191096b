"""How large a set is, and how far it comes: frozen values with the bounds of their errors."""

from __future__ import annotations

from dataclasses import dataclass

from robokin.arrays import Array
from robokin.brief import Brief


@dataclass(frozen=True)
class Measure:
    """A length [m], area [m²] or volume [m³] of a set.

    The true value lies within value ± error (with 99 % confidence where points are drawn at random); `method`
    says in words how it was found, `evaluations` how many points or configurations were looked at. `exact` says
    that the error is that of a random estimate only, with no systematic part that is unknown.
    """

    value: float
    error: float
    method: str
    evaluations: int
    exact: bool = True


@dataclass(frozen=True, eq=False, repr=False)
class Extent(Brief):
    """How far the tool's origin comes: low, high (3,) along the world's axes [m]; least and greatest distance [m]
    from `origin` (3,), the base's. q_low, q_high (3, n) and q_least, q_greatest (n,) are where [rad | m]."""

    low: Array
    high: Array
    least: float
    greatest: float
    origin: Array
    q_low: Array
    q_high: Array
    q_least: Array
    q_greatest: Array
