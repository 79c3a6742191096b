"""The sheet of paper that a lesson fills: what is known, the steps so far, and where the ways part."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from robokin.arrays import Array
from robokin.derivation.formulas import Value, evaluate, tokens

Kind = Literal["number", "length", "angle", "point", "direction", "rotation", "pose"]

DOUBLE = 2.5e-13
"""A square of a sine (or a difference of squares as a part of their sum) below this is 0: two solutions that
differ by its root, less than 1e-6 [rad], count as one everywhere in inverse kinematics."""


@dataclass(frozen=True, eq=False)
class Quantity:
    """A value with what it measures: a number, a length [m], an angle [rad], a point (3,) [m], a direction (3,),
    a rotation (3, 3) or a pose (4, 4) [m].
    """

    value: Value
    kind: Kind


@dataclass(frozen=True, eq=False)
class Step:
    """One line of a lesson: `name` = `formula`, the values that stand in it, and what comes out.

    `branch` says which signs were chosen before (`θ₁ +, θ₃ −`; empty where all ways are still one); `note`
    says what the step is for.
    """

    name: str
    formula: str
    values: Mapping[str, Quantity]
    result: Quantity
    branch: str = ""
    note: str = ""


@dataclass(frozen=True, eq=False)
class WorkedSteps:
    """What is known by name, the steps since the ways last parted, the signs chosen, and why it ends here (or "")."""

    known: Mapping[str, Quantity]
    steps: tuple[Step, ...] = ()
    branch: str = ""
    reason: str = ""

    def __getitem__(self, name: str) -> Value:
        """The value of a name."""
        return self.known[name].value

    def given(self, kind: Kind, **values: Value) -> WorkedSteps:
        """The sheet with more that is known without a step."""
        return replace(self, known={**self.known, **{name: Quantity(value, kind) for name, value in values.items()}})

    def step(self, name: str, formula: str, kind: Kind, note: str = "") -> WorkedSteps:
        """The sheet with one step more: a formula of known names, worked out."""
        used = {word: self.known[word] for word in tokens(formula, self.known) if word in self.known}
        value = evaluate(formula, {word: quantity.value for word, quantity in used.items()})
        result = Quantity(value if np.ndim(value) else float(value), kind)
        step = Step(name, formula, used, result, self.branch, note)
        return replace(self, known={**self.known, name: result}, steps=(*self.steps, step))

    def fork(self, word: str) -> WorkedSteps:
        """One of several ways on from here."""
        return replace(self, steps=(), branch=f"{self.branch}, {word}" if self.branch else word)

    def stop(self, reason: str) -> WorkedSteps:
        """The sheet with the reason why this way ends."""
        return replace(self, reason=reason)


Stage = Callable[[WorkedSteps], Sequence[WorkedSteps]]
"""What is done next: one sheet, or one for each way on."""


def follow(sheet: WorkedSteps, stages: Sequence[Stage]) -> tuple[list[Step], list[WorkedSteps]]:
    """All steps in the order of reading, one way after the other, and the sheet at the end of each."""
    for k, stage in enumerate(stages):
        if sheet.reason:
            break
        ways = stage(sheet)
        if len(ways) == 1:
            sheet = ways[0]
            continue
        steps, ends = list(sheet.steps), []
        for way in ways:
            more, last = follow(way, stages[k + 1 :])
            steps += more
            ends += last
        return steps, ends
    return list(sheet.steps), [sheet]


def both_roots(
    sheet: WorkedSteps, name: str, radicand: str, size: float, kind: Kind, angle: str, notes: tuple[str, str, str]
) -> Sequence[WorkedSteps]:
    """The two ways `name` = ±√(radicand), which decide an angle; one where the root is 0, none where it is not real.

    `size` is that of the terms of the radicand; `notes` say what the step is for, what it means that there is
    but one way, and why there is none.
    """
    square = evaluate(radicand, {word: quantity.value for word, quantity in sheet.known.items()})
    if square < -DOUBLE * size:
        return [sheet.stop(notes[2])]
    if square <= DOUBLE * size:
        return [sheet.step(name, "0", kind, notes[1])]
    return [sheet.fork(f"{angle} {sign}").step(name, f"{sign}√({radicand})", kind, notes[0]) for sign in "+−"]


@dataclass(frozen=True, eq=False)
class PositioningArm:
    """The joints that carry a point, as a lesson solves for them from p_W in the arm's own frame.

    stages: from `p_Wx`, `p_Wy`, `p_Wz` to each joint's variable; variables: its name, joint by joint; zeros:
    what it is when the joint's value is 0; known: the geometry; base: the frame (4, 4) in which p_W is meant;
    rotation: the formula of the last frame's rotation in the base.
    """

    title: str
    stages: tuple[Stage, ...]
    variables: tuple[str, ...]
    zeros: tuple[float, ...]
    known: Mapping[str, Quantity]
    base: Array = field(default_factory=lambda: np.eye(4))
    rotation: str = ""


def index(i: int) -> str:
    """A number as an index below the line."""
    return str(i).translate(str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉"))


def power(i: int) -> str:
    """A number as an index above the line."""
    return str(i).translate(str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹"))


def lengths(**values: float) -> dict[str, Quantity]:
    """Known lengths [m] by name."""
    return {name: Quantity(float(value), "length") for name, value in values.items()}


def angles(**values: float) -> dict[str, Quantity]:
    """Known angles [rad] by name."""
    return {name: Quantity(float(value), "angle") for name, value in values.items()}
