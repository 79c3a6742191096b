"""How one link can move against another, and what kind of motion that is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robokin.arrays import Array
from robokin.kernel.ranks import RANK


@dataclass(frozen=True)
class Output:
    """The motion of a link against another: its freedoms and its kind in words."""

    link: str
    against: str
    freedoms: int
    kind: str


def twist_basis(twists: Array) -> Array:
    """An orthonormal basis (6, r) of the twists (6, k) [size and rad]."""
    if not twists.size:
        return np.zeros((6, 0))
    U, values, _ = np.linalg.svd(twists, full_matrices=False)
    return np.asarray(U[:, : int(np.sum(values > RANK))])


def kind_of(basis: Array) -> str:
    """What the motions with a basis of twists (6, r) are, at this configuration and to first order."""
    r = basis.shape[1]
    if r == 0:
        return "none"
    if r == 6:
        return "free"
    _, turning, V = np.linalg.svd(basis[3:])
    turns = int(np.sum(turning > RANK))
    # Combinations of the basis that do not turn are slides.
    slides = basis[:3] @ V[turns:].T
    if turns == 0:
        return {1: "translation along a line", 2: "translation in a plane", 3: "translation in space"}[r]
    if turns == 1:
        return _about_one_direction(basis, slides, r)
    if turns == 3 and r == 3 and _common_point(basis):
        return "rotation about a point"
    if turns == 2 and r == 2 and _common_point(basis):
        return "rotation about two axes that meet"
    if (turns == 3 and r == 5) or (turns == 3 and r == 4):
        return f"general, {r} freedoms: {r - 3} translations and 3 rotations"
    return f"general, {r} freedoms"


def _about_one_direction(basis: Array, slides: Array, r: int) -> str:
    axis = np.linalg.svd(basis[3:])[0][:, 0]
    if r == 1:
        v, w = basis[:3, 0], basis[3:, 0]
        advance = float(v @ w / (w @ w))
        return "rotation about an axis" if abs(advance) < RANK else "screw motion about an axis"
    if r == 4:
        return "translation in space and rotation about one direction (Schoenflies)"
    along = np.linalg.norm(axis @ slides)
    if r == 2 and along > 1.0 - RANK and _pitch_free(basis, axis):
        return "rotation about an axis and translation along it"
    if r == 3 and along < RANK and _pitch_free(basis, axis):
        return "planar: translation in a plane and rotation about its normal"
    return f"rotation about one direction with {'a translation' if r == 2 else 'two translations'}"


def _pitch_free(basis: Array, axis: Array) -> bool:
    """Whether turning makes no advance of its own along the axis, slides along it apart."""
    _, _, V = np.linalg.svd(basis[3:])
    turning, slides = basis @ V[0], basis[:3] @ V[1:].T
    advance = axis @ turning[:3]
    return bool(abs(advance) < RANK or np.linalg.norm(axis @ slides) > RANK)


def _common_point(basis: Array) -> bool:
    """Whether all twists are turns about one point o: v = o × w for each."""
    v, w = basis[:3].T, basis[3:].T
    rows = np.zeros((len(w), 3, 3))
    # v = o × w = -[w] o
    rows[:, 0, 1], rows[:, 0, 2], rows[:, 1, 2] = w[:, 2], -w[:, 1], w[:, 0]
    rows[:, 1, 0], rows[:, 2, 0], rows[:, 2, 1] = -w[:, 2], w[:, 1], -w[:, 0]
    M, right = rows.reshape(-1, 3), v.reshape(-1)
    o = np.linalg.lstsq(M, right, rcond=1e-9)[0]
    return bool(np.linalg.norm(M @ o - right) < RANK)
