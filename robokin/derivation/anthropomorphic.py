"""The anthropomorphic arm RRR: axis 2 at right angles to axis 1, axis 3 parallel to axis 2. Four solutions.

Any shoulder (a₁, d₁), lateral offset (d₂ + d₃) and forearm (a₃ and d₄ at right angles, PUMA's bent forearm).
First the shoulder, then two links a₂ and a₃ in the arm's plane; for a forearm of two parts its length and its angle
ℓ₃ = √(a₃² + d₄²) and ψ₃ stand for them.
Source: B. Siciliano et al., Robotics: Modelling, Planning and Control, 2009, sec. 2.12.4.
"""

from __future__ import annotations

import math

import numpy as np

from robokin.arrays import Array
from robokin.derivation.link_numbers import (
    ROUNDING,
    SAME,
    Link,
    link_of,
    reach_of,
)
from robokin.derivation.shoulder import Shoulder
from robokin.derivation.two_links import TwoLinks
from robokin.derivation.worked_steps import PositioningArm, Stage, WorkedSteps, angles, lengths
from robokin.kernel.chain import Chain, chain_size


def anthropomorphic_arm(chain: Chain, end: Array, row: Link | None = None, d4: float = 0.0) -> PositioningArm | None:
    """The arm of three joints whose last carries the point at `end` (4, 4), or None for another arm.

    With a wrist, row: the last link up to axis 4, d4: from there to the wrist centre [m].
    """
    size = chain_size(chain)
    one, two = link_of(chain.constants[1], size), link_of(chain.constants[2], size)
    if chain.n != 3 or not chain.revolute.all() or not one.right_angled or not two.parallel:
        return None
    three = reach_of(end, size) if row is None else row
    reach = math.hypot(three.a, math.sin(three.alpha) * d4)
    if abs(two.a) < SAME * size or reach < SAME * size:
        return None
    d2, d3 = one.epsilon + two.delta, two.epsilon + three.delta + math.cos(three.alpha) * d4
    known = lengths(**{"a₂": two.a})
    stages: list[Stage] = []
    d = "d₂" if abs(d2) > ROUNDING * size else ""
    if d:
        known |= lengths(**{"d₂": d2})
    if abs(d3) > ROUNDING * size:
        known |= lengths(**{"d₃": d3})
        sign = "+" if two.sign > 0 else "−"
        formula = f"d₂ {sign} d₃" if d else sign * (sign == "−") + "d₃"
        stages.append(lambda sheet: [sheet.step("d", formula, "length", "the distance of the arm's plane")])
        d = "d" if abs(d2 + two.sign * d3) > ROUNDING * size else ""
    for name, value in (("a₁", one.a), ("d₁", one.delta)):
        if value:
            known |= lengths(**{name: value})
    shoulder = Shoulder(d, "a₁" if one.a else "", "d₁" if one.delta else "", one.sign, size)
    b, psi = "a₃", ""
    if d4 and not three.parallel:
        known |= lengths(**{"d₄": d4}) | angles(**{"α₃": three.alpha})
        stages.append(_forearm(three))
        b, psi = "ℓ₃", "ψ₃"
    if three.a or not psi:
        known |= lengths(**{"a₃": three.a})
    elbow = TwoLinks(2, 3, shoulder.u, shoulder.v, "a₂", b, psi, two.sign)
    before = (0.0, one.gamma, two.gamma)
    turned = [link.beta + gamma for link, gamma in zip((one, two, three), before, strict=True)]
    known |= angles(**{"α₁": one.alpha, "α₂": two.alpha})
    return PositioningArm(
        "anthropomorphic arm: the shoulder, and two links in its plane",
        (*stages, *shoulder.stages, *elbow.stages),
        ("θ₁", "θ₂", "θ₃"),
        tuple((np.array(turned) + chain.offsets).tolist()),
        known,
        chain.constants[0],
        "R_z(θ₁)·R_x(α₁)·R_z(θ₂)·R_x(α₂)·R_z(θ₃)·R_x(α₃)",
    )


def _forearm(three: Link) -> Stage:
    """ℓ₃ and ψ₃: the wrist centre from axis 3, in the plane across it."""
    across = "d₄" if three.right_angled else "sin(α₃)·d₄"
    side = ("−d₄" if three.sign > 0 else "d₄") if three.right_angled else "−sin(α₃)·d₄"
    square = across if three.right_angled else f"({across})"

    def forearm(sheet: WorkedSteps) -> list[WorkedSteps]:
        length = f"√(a₃² + {square}²)" if three.a else f"√({square}²)"
        sheet = sheet.step("ℓ₃", length, "length", "from axis 3 to W")
        return [sheet.step("ψ₃", f"atan2({side}, {'a₃' if three.a else '0'})", "angle", "from x₃ to W")]

    return forearm
