"""Numbers and transforms as texts that read as just the same value: the shortest there is."""

from __future__ import annotations

import math

import numpy as np

from robokin.arrays import Array
from robokin.formats.number_expressions import Scope
from robokin.formats.transform_expressions import evaluate_transform
from robokin.units import Units

DIGITS = 17
"""Digits that tell any two numbers of double precision apart."""

PARTS_OF_PI = (1, 2, 3, 4, 6, 12)

SLACK = 4e-16
"""An angle [rad] that is worked out from a rotation may be off by this."""

EXACTLY = 1e-15
"""Entries of a rotation, as it is read from its text, may be off by this."""


def number_text(value: float, factor: float = 1.0, slack: float = 0.0) -> str:
    """The shortest number that, times the factor, is the value, or nearer to it than the slack.

    Where no number is, as in a unit with an awkward factor, the one with most digits.
    """
    value = float(value)
    wanted = value / factor
    for digits in range(1, DIGITS + 1):
        text = f"{wanted:.{digits}g}"
        if abs(float(text) * factor - value) <= slack:
            break
    else:
        near = (wanted, math.nextafter(wanted, math.inf), math.nextafter(wanted, -math.inf))
        text = repr(min(near, key=lambda one: abs(one * factor - value)))
    number = float(text)
    if number == int(number) and abs(number) < 1e15:
        return str(int(number))
    return repr(number)


def length_text(value: float, units: Units) -> str:
    """A length [m] in the unit."""
    return number_text(value, units.metres)


def angle_text(value: float, units: Units, slack: float = 0.0) -> str:
    """An angle [rad] in the unit; in radians a part of pi is written as such."""
    if not units.degrees and value:
        for part in PARTS_OF_PI:
            times = round(value * part / math.pi)
            if times and abs(times) <= 2 * part and abs(times * math.pi / part - value) <= slack:
                sign, count = "-" if times < 0 else "", f"{abs(times)}*" if abs(times) > 1 else ""
                return f"{sign}{count}pi" + (f"/{part}" if part > 1 else "")
    return number_text(value, units.radians, slack)


def rpy_exactly(R: Array) -> tuple[float, float, float]:
    """Roll, pitch and yaw [rad] of a rotation (3, 3), each from what the ones before it leave.

    Rounding of one is made up for by the next, also where the pitch is nearly a right angle.
    """
    yaw = math.atan2(R[1, 0], R[0, 0])
    rest = _about("z", -yaw) @ R
    pitch = math.atan2(-rest[2, 0], rest[0, 0])
    rest = _about("y", -pitch) @ rest
    return math.atan2(rest[2, 1], rest[1, 1]) + 0.0, pitch + 0.0, yaw + 0.0


def transform_text(T: Array, units: Units) -> str:
    """A transform expression that is T (4, 4) [m]; "" for the identity.

    A turn is said about an axis or by roll, pitch and yaw; where that would change an entry by more than 1e-15, the
    matrix is written.
    """
    shift = ""
    if np.any(T[:3, 3] != 0.0):
        shift = f"Trans({', '.join(length_text(float(value), units) for value in T[:3, 3])})"
    R = T[:3, :3]
    if np.array_equal(R, np.eye(3)):
        return shift
    for turn in _turns(R, units):
        text = f"{shift} {turn}".strip()
        read = evaluate_transform(text, Scope(degrees=units.degrees), units)
        if float(np.max(np.abs(read[:3, :3] - R))) <= EXACTLY:
            return text
    rows = [[*map(number_text, row[:3]), length_text(row[3], units)] for row in T[:3]]
    listed = ", ".join(f"[{', '.join(row)}]" for row in [*rows, ["0", "0", "0", "1"]])
    return f"Matrix([{listed}])"


def _turns(R: Array, units: Units) -> list[str]:
    """Ways to write a rotation (3, 3), the shorter ones first."""
    angles = rpy_exactly(R)
    texts = [angle_text(angle, units, SLACK) for angle in angles]
    written = [f"Rot({axis}, {text})" for axis, text in zip("xyz", texts, strict=True) if text != "0"]
    about_y = angle_text(math.atan2(R[0, 2], R[0, 0]), units, SLACK)  # more than a right angle turns roll and yaw over
    return [*(written if len(written) == 1 else [f"Rot(y, {about_y})"]), f"RPY({', '.join(texts)})"]


def _about(axis: str, angle: float) -> Array:
    """The rotation (3, 3) about y or z."""
    c, s = math.cos(angle), math.sin(angle)
    if axis == "y":
        return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
