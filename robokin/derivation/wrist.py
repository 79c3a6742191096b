"""The spherical wrist: three axes through one point, each at right angles to the next. ZYZ angles, two solutions.

R = R_z(θ₄) R_x(α₄) R_z(θ₅) R_x(α₅) R_z(θ₆) with α₄, α₅ = ±90°. With s₄ = sin α₄ and s₅ = sin α₅ its third column is
(s₅ sin θ₅ cos θ₄, s₅ sin θ₅ sin θ₄, -s₄ s₅ cos θ₅) and its third row (s₄ sin θ₅ cos θ₆, -s₄ sin θ₅ sin θ₆, …): θ₅ by
its cosine and the root of the squares, with both signs, then θ₄ and θ₆. For α₄ = -90°, α₅ = 90° they are ZYZ angles.
Degenerate: sin θ₅ = 0, axes 4 and 6 on one line; θ₄ is held and θ₆ is what is left.
Source: B. Siciliano et al., Robotics: Modelling, Planning and Control, 2009, sec. 2.12.5.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from robokin.derivation.worked_steps import Stage, WorkedSteps, index, power

STRAIGHT = 1e-9
"""A sine of θ₅ below this is 0: it is rounding, and θ₄ would be made of it."""


@dataclass(frozen=True)
class Wrist:
    """first: the number of its first joint, from 1; before, after: the signs of its twists; held: the value of
    the first angle where it is free [rad].
    """

    first: int
    before: int
    after: int
    held: float

    @property
    def name(self) -> str:
        """The rotation of the wrist's last frame in its first: R₃⁶."""
        return f"R{index(self.first - 1)}{power(self.first + 2)}"

    @property
    def stages(self) -> tuple[Stage, ...]:
        """θ₅ (two ways), θ₄, θ₆."""
        return self.middle, self.outer

    def middle(self, sheet: WorkedSteps) -> Sequence[WorkedSteps]:
        """θ₅ = atan2(±√(r₁₃² + r₂₃²), ∓r₃₃)."""
        R = sheet[self.name]
        entries = {
            f"r{index(i)}{index(k)}": float(R[i - 1, k - 1]) for i, k in ((1, 3), (2, 3), (3, 1), (3, 2), (3, 3))
        }
        sheet = sheet.given("number", **entries)
        cosine = "−r₃₃" if self.before * self.after > 0 else "r₃₃"
        theta = f"θ{index(self.first + 1)}"
        root = "√(r₁₃² + r₂₃²)"
        if R[0, 2] ** 2 + R[1, 2] ** 2 <= STRAIGHT**2:
            held = f"θ{index(self.first)}"
            line = f"axes {self.first} and {self.first + 2} lie on one line: only their sum counts, {held} is held"
            return [sheet.step(theta, f"atan2(0, {cosine})", "angle", line)]
        return [sheet.fork(f"{theta} {sign}").step(theta, f"atan2({sign}{root}, {cosine})", "angle") for sign in "+−"]

    def outer(self, sheet: WorkedSteps) -> Sequence[WorkedSteps]:
        """θ₄ and θ₆, with the sign that θ₅ has."""
        four, five, six = (f"θ{index(self.first + i)}" for i in range(3))
        R = sheet[self.name]
        if R[0, 2] ** 2 + R[1, 2] ** 2 <= STRAIGHT**2:
            alpha, beta = f"α{index(self.first)}", f"α{index(self.first + 1)}"
            sheet = sheet.given("angle", **{"θ₀": self.held}).step(four, "θ₀", "angle", "any value will do")
            M = f"(R_z({four})·R_x({alpha})·R_z({five})·R_x({beta}))"
            sheet = sheet.step("N", f"{M}ᵀ·{self.name}", "rotation", "the last turn on its own")
            sheet = sheet.given("number", **{"n₁₁": float(sheet["N"][0, 0]), "n₂₁": float(sheet["N"][1, 0])})
            return [sheet.step(six, "atan2(n₂₁, n₁₁)", "angle")]
        side = 1 if sheet[five] > 0.0 else -1
        left, right = _sign(self.after * side), _sign(self.before * side)
        sheet = sheet.step(four, f"atan2({left}r₂₃, {left}r₁₃)", "angle")
        other = _sign(-self.before * side)
        return [sheet.step(six, f"atan2({other}r₃₂, {right}r₃₁)", "angle")]


def _sign(value: int) -> str:
    return "−" if value < 0 else ""
