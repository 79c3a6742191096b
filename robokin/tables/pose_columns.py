"""Columns of poses: how they may be called, and rows of them as matrices."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError, shown
from robokin.formats.printed_matrices import pose_from_matrix
from robokin.kinematics.flat_arm import planar_pose, upright_tool
from robokin.spatial import nearest_rotation, rotation_error, transform
from robokin.spatial.rotations import DIGITS_LOST
from robokin.tables.headings import FoundColumns, Way, find, partial, refused
from robokin.tables.near_targets import BadRowError, near_enough
from robokin.tables.orientations import MATRIX, ORIENTATIONS
from robokin.tables.wanted_columns import Wanted
from robokin.units import Units

CLEAN = 1e-12
"""A rotation that is off by less holds nothing but rounding."""

ORIGIN = tuple((axis, f"p{axis}", f"pos_{axis}", f"position_{axis}") for axis in "xyz")

POSITION = Way(ORIGIN, "lll", kind="position")

PLANAR = Way((*ORIGIN[:2], ("phi",)), "lla", kind="planar")
"""A target of an arm that moves in the plane of x and y: the place, and the angle of the tool's x axis to x."""

PLANE = Way(ORIGIN[:2], "ll", kind="plane")
"""The place alone."""

MATRIX_WAY = Way(tuple((name,) for name in MATRIX), "uuuluuuluuuluuuu", kind="matrix")


def _way(kind: str) -> Way:
    way = ORIENTATIONS[kind]
    others = [(name, f"orientation_{name[1]}") if name[0] == "q" else (name,) for name in way.columns]
    return Way((*ORIGIN, *others), "lll" + ("a" if way.angles else "u") * len(others), kind=kind)


WAYS = {kind: _way(kind) for kind in ORIENTATIONS} | {"matrix": MATRIX_WAY}
"""The columns of a pose for each way to say its orientation."""

ORDER = ("rpy", "matrix", "quaternion", "euler", "rotvec", "abc", "wpr")
"""The way that is taken of a table that has several."""

BY_COUNT = {3: "position", 6: "rpy", 16: "matrix"}
"""What a row of so many numbers is, where no header and no --as says it."""

ALLOWED = (
    "x, y, z with roll, pitch, yaw or qw, qx, qy, qz or phi, theta, psi or rx, ry, rz or A, B, C or W, P, R, "
    "or x, y, z alone, or m11 to m44"
)

ALLOWED_IN_PLANE = ", or x, y, phi of a planar arm, or x, y alone"

PLACES = (POSITION.kind, PLANE.kind)
"""Ways that leave the orientation open."""

SEVEN = (
    "found 7 values without a header, which do not say whether the quaternion begins or ends with w: expected a header "
    "(x,y,z,qw,qx,qy,qz in any order), or --as quaternion (w, x, y, z) or --as quaternion-xyzw (x, y, z, w)"
)


class PoseColumns(Wanted):
    """The columns of a pose, or of a position alone; `kind` is what --as says, or None.

    `plane` is the pose (4, 4) [m] at zero of an arm that moves in the plane of x and y, whose targets may be x, y, phi
    or x, y; None for other arms.
    """

    key = "matrix"

    def __init__(self, units: Units, kind: str | None, plane: Array | None = None) -> None:
        self.units, self.kind, self.plane = units, kind, plane
        self.what = "a pose"
        self.allowed = ALLOWED + (ALLOWED_IN_PLANE if plane is not None else "")

    def headed(self, headings: Sequence[str]) -> FoundColumns:
        """Where the columns stand below some headings. Raises InputError that lists what is allowed."""
        kinds = ORDER if self.kind is None else (self.kind,)
        found = find([WAYS[kind] for kind in kinds], headings, self.units)
        if found is not None:
            return found
        if self.kind is not None:
            raise refused(headings, f"{', '.join(WAYS[self.kind].names)}, as --as {self.kind} says")
        found = self.in_plane(headings)
        if found is not None:
            return found
        for kind in ORDER:
            turned = Way(WAYS[kind].columns[0 if kind == "matrix" else 3 :], "")
            if some := partial(turned, headings):
                raise refused(headings, f"with '{shown(some[0])}' also the others of its pose: {self.allowed}")
        found = find([POSITION], headings, self.units)
        if found is None:
            raise refused(headings, self.allowed)
        return found

    def in_plane(self, headings: Sequence[str]) -> FoundColumns | None:
        """Where x, y, phi or x, y stand; None where there is more of a pose, or the arm does not move in the plane.

        Raises InputError for a phi that the arm's tool does not have.
        """
        turned = {names for way in WAYS.values() for names in way.columns if names not in PLANAR.columns}
        if self.plane is None or partial(Way((*turned,), ""), headings):
            return None
        way = PLANAR if partial(Way(PLANAR.columns[2:], ""), headings) else PLANE
        found = find([way], headings, self.units)
        if found is not None and way is PLANAR and upright_tool(self.plane):
            phi = headings[found.places[2]]
            said = f"found the column '{shown(phi)}', while the x axis of the tool frame is upright"
            raise InputError(f"{said}, expected x, y alone, or x, y, z, roll, pitch, yaw")
        return found

    def bare(self, count: int) -> Way:
        """What a row of so many numbers is. Raises InputError for a quaternion in an unknown order."""
        if self.kind is None and count == 7:
            raise InputError(SEVEN)
        kind = self.kind or BY_COUNT.get(count, "rpy")
        way = POSITION if kind == "position" else WAYS[kind]
        if count == 2 and self.plane is not None and self.kind is None:
            way = PLANE
        self.what = "the 16 elements of a matrix, row by row" if kind == "matrix" else ", ".join(way.names)
        return way


def poses_from_rows(rows: Array, kind: str, units: Units, plane: Array | None = None) -> Array:
    """Poses (m, 4, 4) [m] from rows (m, k) in the units. Raises BadRowError for the first that is none.

    `plane` is as in `PoseColumns`.
    """
    finite = np.isfinite(rows).all(axis=1)
    if not finite.all():
        raise BadRowError(int(np.argmin(finite)), "found a number that is not finite, expected finite numbers")
    if kind == "matrix":
        return _poses_from_matrices(rows.reshape(-1, 4, 4), units)
    if kind == POSITION.kind:
        return near_enough(transform(np.eye(3), rows * units.metres), units)
    if plane is not None and kind in (PLANAR.kind, PLANE.kind):
        phi = rows[:, 2] * units.radians if kind == PLANAR.kind else None
        return near_enough(planar_pose(plane, rows[:, :2] * units.metres, phi), units)
    way, values = ORIENTATIONS[kind], rows[:, 3:]
    if way.angles:
        R = way.rotation(values * units.radians)
    else:
        with np.errstate(over="ignore"):
            length = np.linalg.norm(values, axis=1)
        wrong = ~(np.abs(length - 1.0) <= DIGITS_LOST)
        if wrong.any():
            row = int(np.argmax(wrong))
            raise BadRowError(row, f"found a quaternion of length {length[row]:.6g}, expected 1")
        R = way.rotation(values / length[:, None])
    return near_enough(transform(R, rows[:, :3] * units.metres), units)


def _poses_from_matrices(M: Array, units: Units) -> Array:
    with np.errstate(all="ignore"):  # of great numbers the products overflow, and are refused
        off = rotation_error(M[:, :3, :3])
        wrong = ~(off <= DIGITS_LOST) | (M[:, 3] != [0.0, 0.0, 0.0, 1.0]).any(axis=1)
    R = M[:, :3, :3]
    for row in np.flatnonzero(wrong):
        try:
            R[row] = pose_from_matrix(M[row], units)[0][:3, :3]
        except ValueError as error:
            raise BadRowError(int(row), str(error)) from None
    cut = off > CLEAN
    if cut.any():
        R[cut] = nearest_rotation(R[cut])
    return near_enough(transform(R, M[:, :3, 3] * units.metres), units)
