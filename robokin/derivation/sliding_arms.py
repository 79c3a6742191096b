"""Arms with sliding joints: the spherical arm RRP, the cylindrical RPP, the Cartesian PPP.

- Spherical: axis 2 at right angles to axis 1, the slide at right angles to axis 2. The shoulder first; then from axis 2
  the point is at (b, d₃) turned by θ₂, so d₃ = ±√(u² + v² - b²): four solutions.
- Cylindrical: one slide along axis 1, the height; one across it. From axis 1 the point is at (d₃, d) turned: two.
- Cartesian: three slides at right angles to each other, each the component of p along it: one.
Source: B. Siciliano et al., Robotics: Modelling, Planning and Control, 2009, sec. 2.12.3 (the spherical arm).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from robokin.arrays import Array
from robokin.derivation.link_numbers import (
    ROUNDING,
    SAME,
    Z,
    link_of,
    right,
)
from robokin.derivation.shoulder import Shoulder
from robokin.derivation.two_links import ON_AXIS
from robokin.derivation.worked_steps import (
    PositioningArm,
    Quantity,
    Stage,
    WorkedSteps,
    angles,
    both_roots,
    index,
    lengths,
)
from robokin.kernel.chain import Chain, chain_size
from robokin.spatial import rotation_transform


def spherical_arm(chain: Chain, end: Array) -> PositioningArm | None:
    """The arm RRP that carries the point at `end` (4, 4), or None for another arm."""
    size = chain_size(chain)
    one, two = link_of(chain.constants[1], size), link_of(chain.constants[2], size)
    if chain.revolute.tolist() != [True, True, False] or not one.right_angled or not two.right_angled:
        return None
    after = rotation_transform(Z, two.gamma) @ end
    k_x, k_y, k_z = after[:3, 3] + [0.0, 0.0, two.epsilon]
    d, b = one.epsilon + two.delta + two.sign * k_y, two.a + k_x
    d, b = (0.0 if abs(length) < ROUNDING * size else float(length) for length in (d, b))
    # b: the distance of the slide's line from axis 2 within the arm's plane.
    known = lengths(**{name: value for name, value in (("a₁", one.a), ("d₁", one.delta), ("d₂", d)) if value})
    known |= lengths(b=b) | angles(**{"α₁": one.alpha})
    known |= {"K": Quantity((rotation_transform([1.0, 0.0, 0.0], two.alpha) @ after)[:3, :3], "rotation")}
    shoulder = Shoulder("d₂" if d else "", "a₁" if one.a else "", "d₁" if one.delta else "", one.sign, size)
    turned = np.array([one.beta, one.gamma + two.beta, k_z])
    return PositioningArm(
        "spherical arm: the shoulder, the slide's length, and its angle",
        (*shoulder.stages, *_outwards(shoulder, two.sign, size)),
        ("θ₁", "θ₂", "d₃"),
        tuple((turned + chain.offsets).tolist()),
        known,
        chain.constants[0],
        "R_z(θ₁)·R_x(α₁)·R_z(θ₂)·K",
    )


def _outwards(shoulder: Shoulder, sign: int, size: float) -> tuple[Stage, ...]:
    """d₃ and θ₂ from the point (u, v)."""
    u, v = shoulder.u, shoulder.v

    def slide(sheet: WorkedSteps) -> Sequence[WorkedSteps]:
        square = sheet[u] ** 2 + sheet[v] ** 2
        if math.sqrt(square) <= ON_AXIS * size and not sheet["b"]:
            return [sheet.stop("W lies on axis 2: θ₂ may have any value")]
        notes = (
            "the slide: out, or back through axis 2",
            "both signs are one",
            "out of reach, W is nearer to axis 2 than the slide's line",
        )
        return both_roots(sheet, "d₃", f"{u}² + {v}² − b²", square + sheet["b"] ** 2, "length", "d₃", notes)

    def turn(sheet: WorkedSteps) -> Sequence[WorkedSteps]:
        return [sheet.step("θ₂", f"atan2({v}, {u}) − atan2({'−' if sign > 0 else ''}d₃, b)", "angle")]

    return slide, turn


def cylindrical_arm(chain: Chain, end: Array) -> PositioningArm | None:
    """The arm RPP, its slides along and across axis 1 in any order, or None for another arm."""
    if chain.revolute.tolist() != [True, False, False]:
        return None
    size = chain_size(chain)
    second = chain.constants[1]
    third = second @ chain.constants[2]
    directions = {2: second[:3, 2], 3: third[:3, 2]}
    along = [i for i, z in directions.items() if math.hypot(z[0], z[1]) < SAME]
    across = [i for i, z in directions.items() if abs(z[2]) < SAME]
    if not along or not across:
        return None
    (i,), (j,) = along, across
    start = (third @ end)[:3, 3]
    e = directions[j]
    d = float(e[0] * start[1] - e[1] * start[0])
    zeros = {1: 0.0, i: 0.0, j: float(e[:2] @ start[:2])}
    d = 0.0 if abs(d) < ROUNDING * size else d
    known = lengths(**{"h₀": float(start[2]), "d": d}) | angles(ε=right(math.atan2(e[1], e[0])))
    known |= {"K": Quantity((third @ end)[:3, :3], "rotation")}
    lift, out = f"d{index(i)}", f"d{index(j)}"

    def height(sheet: WorkedSteps) -> Sequence[WorkedSteps]:
        formula = "p_Wz − h₀" if directions[i][2] > 0.0 else "h₀ − p_Wz"
        sheet = sheet.step(lift, formula, "length", "the height is the first slide's alone")
        sheet = sheet.step("r", "√(p_Wx² + p_Wy²)", "length", "the distance of W from axis 1")
        if sheet["r"] <= ON_AXIS * size and not d:
            return [sheet.stop("W lies on axis 1: θ₁ may have any value")]
        return [sheet]

    def slide(sheet: WorkedSteps) -> Sequence[WorkedSteps]:
        notes = "the slide: out, or back through axis 1", "both signs are one", "r < |d|: out of reach"
        return both_roots(sheet, out, "r² − d²", sheet["r"] ** 2 + d**2, "length", out, notes)

    def turn(sheet: WorkedSteps) -> Sequence[WorkedSteps]:
        return [sheet.step("θ₁", f"atan2(p_Wy, p_Wx) − atan2(d, {out}) − ε", "angle")]

    return PositioningArm(
        "cylindrical arm: the height, the radius, and the angle",
        (height, slide, turn),
        ("θ₁", "d₂", "d₃"),
        tuple((np.array([zeros[1], zeros[2], zeros[3]]) + chain.offsets).tolist()),
        known,
        chain.constants[0],
        "R_z(θ₁)·K",
    )


def cartesian_arm(chain: Chain, end: Array) -> PositioningArm | None:
    """The arm PPP with slides at right angles to each other, or None for another arm."""
    if chain.revolute.tolist() != [False, False, False]:
        return None
    second = chain.constants[1]
    third = second @ chain.constants[2]
    z = [Z, second[:3, 2], third[:3, 2]]
    if max(abs(z[0] @ z[1]), abs(z[0] @ z[2]), abs(z[1] @ z[2])) > SAME:
        return None
    known = {f"z{index(i)}": Quantity(direction, "direction") for i, direction in enumerate(z)}
    known |= {"k": Quantity((third @ end)[:3, 3], "point"), "K": Quantity((third @ end)[:3, :3], "rotation")}

    def slides(sheet: WorkedSteps) -> Sequence[WorkedSteps]:
        sheet = sheet.step("w", "p_W − k", "point", "from where W is when all slides are at 0")
        for i in range(3):
            sheet = sheet.step(f"d{index(i + 1)}", f"z{index(i)}·w", "length", "its part along the slide" * (i == 0))
        return [sheet]

    return PositioningArm(
        "Cartesian arm: each slide its own coordinate",
        (slides,),
        ("d₁", "d₂", "d₃"),
        tuple(chain.offsets.tolist()),
        known,
        chain.constants[0],
        "K",
    )
