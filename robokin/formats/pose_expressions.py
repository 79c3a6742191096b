"""Transform expressions from Python: the grammar of descriptions and of `robokin frame`, in SI."""

from __future__ import annotations

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError
from robokin.expected import expect_kind
from robokin.formats.number_expressions import Scope
from robokin.formats.transform_expressions import evaluate_transform
from robokin.units import Units


def transform(expression: str, units: Units | None = None) -> Array:
    """The transform (4, 4) [m] of an expression, such as `Trans(0.4, 0, 0.3) RPY(0, pi/2, 0)`.

    units: those of the numbers in the expression, by default metres and radians; `Units("mm", "deg")` reads
    `Trans(400, 0, 300) RPY(0, 90, 0)`. The result is in metres in any case. Raises ExpressionError.
    """
    expect_kind(expression, str, "expression", "a transform expression, such as 'Trans(1, 2, 3) Rot(z, pi/2)'")
    own = Units() if units is None else units
    expect_kind(own, Units, "units", "units, such as robokin.Units('mm', 'deg')")
    with np.errstate(over="ignore", invalid="ignore"):
        T = evaluate_transform(expression, Scope(degrees=own.degrees), own)
    if not np.isfinite(T).all():
        raise InputError("expression: the result is too far away for a number, expected less")
    return T + 0.0
