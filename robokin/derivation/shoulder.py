"""The first joint of an arm whose second axis crosses it at right angles: how the arm turns to face the point.

Statement. The arm moves in a plane at the distance d from axis 1. The point lies in it if and only if p · z₁ = d, which
is p_x s₁ - p_y c₁ = ±d; with r² = p_x² + p_y² and ρ = c₁p_x + s₁p_y = ±√(r² - d²) there are two solutions, the shoulder
right (ρ ≥ 0) and left, θ₁ = atan2(p_y, p_x) ∓ atan2(d, ρ). None for r < d; r = d = 0 leaves θ₁ open.
Source: J. J. Craig, Introduction to Robotics, 3rd ed., eq. (4.64) to (4.70); for d = 0 B. Siciliano et al., Robotics:
Modelling, Planning and Control, 2009, sec. 2.12.4.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from robokin.derivation.two_links import ON_AXIS
from robokin.derivation.worked_steps import Stage, WorkedSteps, both_roots


@dataclass(frozen=True)
class Shoulder:
    """d: the name of the lateral offset, or "" for none; a1, d1: names of the place of axis 2, or "";
    sign: that of sin α₁; size: the arm's [m].
    """

    d: str
    a1: str
    d1: str
    sign: int
    size: float

    @property
    def stages(self) -> tuple[Stage, ...]:
        """Distance, root (two ways), θ₁ and the point in the arm's plane."""
        return self.distance, self.root, self.turn, self.plane

    @property
    def u(self) -> str:
        """The point's coordinate from axis 2, away from axis 1."""
        return "u" if self.a1 else "ρ"

    @property
    def v(self) -> str:
        """The point's coordinate from axis 2, along y₁: up, or down where α₁ = -90°."""
        return "v" if self.d1 or self.sign < 0 else "p_Wz"

    def distance(self, sheet: WorkedSteps) -> Sequence[WorkedSteps]:
        """r."""
        note = "the distance of W from axis 1"
        sheet = sheet.step("r", "√(p_Wx² + p_Wy²)", "length", note)
        if sheet["r"] <= ON_AXIS * self.size and not self.d:
            return [sheet.stop("W lies on axis 1: θ₁ may have any value")]
        return [sheet]

    def root(self, sheet: WorkedSteps) -> Sequence[WorkedSteps]:
        """ρ = ±√(r² - d²), the distance within the arm's plane."""
        if not self.d:
            return [sheet.fork(f"θ₁ {sign}").step("ρ", sign * (sign == "−") + "r", "length") for sign in "+−"]
        notes = (
            "the distance of W from axis 1 within the arm's plane",
            "r = |d|: both signs are one",
            "r < |d|: out of reach, W is nearer to axis 1 than the arm's plane",
        )
        size = sheet["r"] ** 2 + sheet[self.d] ** 2
        return both_roots(sheet, "ρ", f"r² − {self.d}²", size, "length", "θ₁", notes)

    def turn(self, sheet: WorkedSteps) -> Sequence[WorkedSteps]:
        """θ₁."""
        if self.d:
            formula = f"atan2(p_Wy, p_Wx) {'−' if self.sign < 0 else '+'} atan2({self.d}, ρ)"
        else:
            formula = "atan2(p_Wy, p_Wx)" if sheet["ρ"] > 0.0 else "atan2(−p_Wy, −p_Wx)"
        return [sheet.step("θ₁", formula, "angle")]

    def plane(self, sheet: WorkedSteps) -> Sequence[WorkedSteps]:
        """The point from axis 2, in the arm's plane."""
        if self.a1:
            sheet = sheet.step("u", f"ρ − {self.a1}", "length", "the distance of W from axis 2, along x₁")
        if self.v == "v":
            up = f"p_Wz − {self.d1}" if self.d1 else "p_Wz"
            down = f"{self.d1} − p_Wz" if self.d1 else "−p_Wz"
            note = "the height of W over axis 2" if self.sign > 0 else "along y₁, which points down"
            sheet = sheet.step("v", up if self.sign > 0 else down, "length", note)
        return [sheet]
