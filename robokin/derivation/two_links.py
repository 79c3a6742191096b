"""Two links in a plane: the elbow by the law of cosines, then the first angle. Half of all lessons end here.

Statement. A point at (u, v) is reached by links a and b, a e(θ₁) + b e(θ₁ + θ₂) = (u, v), if and only if the cosine
c₂ = (u² + v² - a² - b²) / (2ab) is in [-1, 1]: then with s₂ = ±√(1 - c₂²), two solutions or one.
Derivation. Squaring and summing gives c₂; with c₂ and s₂ known the two equations are linear in c₁ and s₁.
Degenerate: u = v = 0, where θ₁ may have any value.
Source: B. Siciliano et al., Robotics: Modelling, Planning and Control, 2009, sec. 2.12.1.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robokin.derivation.worked_steps import DOUBLE, Stage, WorkedSteps, both_roots, index

ON_AXIS = 1e-9
"""A point this near [part of the links' length] to an axis lies on it: the direction to it is then rounding."""


@dataclass(frozen=True)
class TwoLinks:
    """Names of what is known, and which joints: their numbers from 1.

    u, v: the point; a, b: the links; psi: the angle from the second joint's x axis to the second link, or "";
    sign: -1 where the second joint turns the other way round.
    """

    first: int
    second: int
    u: str
    v: str
    a: str
    b: str
    psi: str = ""
    sign: int = 1

    @property
    def stages(self) -> tuple[Stage, ...]:
        """Cosine, sine (two ways), second angle and first angle."""
        return self.cosine, self.sine, self.angles

    def cosine(self, sheet: WorkedSteps) -> Sequence[WorkedSteps]:
        """c₂, if there is an angle with that cosine."""
        c = f"c{index(self.second)}"
        formula = f"({self.u}² + {self.v}² − {self.a}² − {self.b}²) / (2·{self.a}·{self.b})"
        sheet = sheet.step(c, formula, "number", "squaring and summing both coordinates")
        value = sheet[c]
        if 1.0 - value * value >= -DOUBLE:
            return [sheet]
        beyond = (value > 0.0) == (sheet[self.a] * sheet[self.b] > 0.0)
        why = "out of reach, the links are too short" if beyond else "out of reach, the point is too near"
        return [sheet.stop(f"{c} = {value:.6g} {'> 1' if value > 0.0 else '< −1'}: {why}".replace("-", "−"))]

    def sine(self, sheet: WorkedSteps) -> Sequence[WorkedSteps]:
        """s₂ = ±√(1 - c₂²)."""
        k = index(self.second)
        notes = "", f"c{k}² = 1: the arm is stretched or folded, and both signs are one", ""
        return both_roots(sheet, f"s{k}", f"1 − c{k}²", 1.0, "number", f"θ{k}", notes)

    def angles(self, sheet: WorkedSteps) -> Sequence[WorkedSteps]:
        """Both angles."""
        j, k = index(self.first), index(self.second)
        sign = "−" if self.sign < 0 else ""
        offset = f" − {self.psi}" if self.psi else ""
        sheet = sheet.step(f"θ{k}", f"{sign}atan2(s{k}, c{k}){offset}", "angle")
        u, v, a, b = self.u, self.v, self.a, self.b
        if np.hypot(sheet[u], sheet[v]) <= ON_AXIS * (abs(sheet[a]) + abs(sheet[b])):
            return [sheet.stop(f"the point lies on axis {self.first}: θ{j} may have any value")]
        below = f" / ({u}² + {v}²)"
        sheet = sheet.step(f"c{j}", f"(({a} + {b}·c{k})·{u} + {b}·s{k}·{v}){below}", "number")
        sheet = sheet.step(f"s{j}", f"(({a} + {b}·c{k})·{v} − {b}·s{k}·{u}){below}", "number")
        return [sheet.step(f"θ{j}", f"atan2(s{j}, c{j})", "angle")]
