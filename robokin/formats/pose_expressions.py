"""Poses from Python: expressions in the grammar of descriptions and of `robokin frame`, or a position and angles."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from robokin.arrays import Array
from robokin.errors import InputError, or_list
from robokin.expected import expect_finite, expect_kind
from robokin.formats.number_expressions import Scope
from robokin.formats.transform_expressions import evaluate_transform
from robokin.spatial import conversions
from robokin.spatial.rigid_poses import rigid
from robokin.spatial.transforms import transform as rigid_transform
from robokin.units import Units


def transform(expression: str, units: Units | None = None) -> Array:
    """The transform (4, 4) [m] of an expression, such as `Trans(0.4, 0, 0.3) RPY(0, pi/2, 0)`; see `pose` too.

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


def pose(
    what: str | ArrayLike,
    *,
    rpy: ArrayLike | None = None,
    euler: ArrayLike | None = None,
    quaternion: ArrayLike | None = None,
    rotvec: ArrayLike | None = None,
    R: ArrayLike | None = None,
    length: str = "m",
    angle: str = "rad",
) -> Array:
    """A pose: of an expression, such as `pose("Trans(400, 0, 300) RPY(0, 90, 0)", length="mm", angle="deg")`.

    Or of a position, what: (..., 3) [m], turned by one of rpy: (..., 3) [rad], euler: (..., 3) [rad] ZYZ,
    quaternion: (..., 4) w, x, y, z, rotvec: (..., 3) [rad], R: (..., 3, 3); by none of these it is not turned. length
    and angle are the units of the numbers that are given; what comes out is in metres. Returns (..., 4, 4) [m].
    Raises InputError, of an expression ExpressionError.
    """
    units = Units(length, angle)
    given = {"rpy": rpy, "euler": euler, "quaternion": quaternion, "rotvec": rotvec, "R": R}
    forms = {name: value for name, value in given.items() if value is not None}
    if isinstance(what, str):
        if forms:
            raise InputError(f"{next(iter(forms))}: is for a position, expected an expression alone, or x, y, z")
        return transform(what, units)
    if len(forms) > 1:
        raise InputError(f"found {' and '.join(forms)}, expected one of {or_list(given)}")
    p = expect_finite(what, "what", "an expression, such as 'Trans(1, 2, 3) Rot(z, pi/2)', or positions (..., 3)")
    if p.ndim == 0 or p.shape[-1] != 3:
        raise InputError(f"what: found an array of shape {p.shape}, expected an expression, or positions x, y, z")
    turned = _rotation(forms, units)
    try:
        np.broadcast_shapes(p.shape[:-1], turned.shape[:-2])
    except ValueError:
        name = next(iter(forms))
        raise InputError(f"{name}: found {turned.shape[:-2]} orientations, expected one for each position") from None
    return rigid(rigid_transform(turned, p * units.metres + 0.0), "what")


def _rotation(forms: dict[str, ArrayLike], units: Units) -> Array:
    """The rotation (..., 3, 3) of the one form that is given, if one is."""
    for name, value in forms.items():
        if name == "R":
            return conversions.rotation_of(value)
        if name == "quaternion":
            return conversions.rotation_from_quaternion(value)
        angles = expect_finite(value, name, "three angles (..., 3)") * units.radians
        made = {
            "rpy": conversions.rotation_from_rpy,
            "euler": conversions.rotation_from_euler,
            "rotvec": conversions.rotation_from_rotvec,
        }
        return made[name](angles)
    return np.eye(3)
