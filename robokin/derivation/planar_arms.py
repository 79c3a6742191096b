"""Arms whose turning axes are all parallel: planar 2R and 3R, SCARA with its slide at any place.

A slide along the axes commutes with every turn about them, so it is solved for on its own, from the height; what is
left is a planar arm. An axis that points the other way (the SCARA's twist of 180°) turns the other way round.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robokin.arrays import Array
from robokin.derivation.link_numbers import (
    SAME,
    Z,
    end_of,
    link_of,
    reach_of,
)
from robokin.derivation.two_links import TwoLinks
from robokin.derivation.worked_steps import PositioningArm, Quantity, Stage, WorkedSteps, angles, index, lengths
from robokin.kernel.chain import Chain, chain_size
from robokin.spatial import invert, rotation_transform


def planar_arm(chain: Chain, end: Array) -> tuple[PositioningArm, Array] | None:
    """The arm whose parallel joints carry the point at `end`, or for three turning ones the whole pose.

    end: (4, 4) the transform after the last joint. Returns the arm and for three turning joints what of `end` the
    hand has beyond the last link; None for another arm. With one slide among the joints, the height is solved too.
    """
    turning = [i for i in range(chain.n) if chain.revolute[i]]
    sliding = [i for i in range(chain.n) if not chain.revolute[i]]
    if len(turning) not in (2, 3) or len(sliding) > 1:
        return None
    base, between, signs = _merged(chain)
    if signs is None:
        return None
    size, n = chain_size(chain), len(turning)
    links = [link_of(C, size) for C in between]
    last, rest = end_of(between[-1] @ end, size)
    if n == 2:
        last = reach_of(between[-1] @ end, size)
    links[-1] = last
    a = [link.a for link in links]
    if min(abs(a[0]), abs(a[1])) < SAME * size or not all(link.parallel for link in links[: n - 1]):
        return None
    numbers = [i + 1 for i in turning]
    sigma = [1, *np.cumprod([link.sign for link in links[: n - 1]]).tolist()]
    names = [f"a{index(i)}" for i in numbers]
    stages: list[Stage] = []
    u, v = "p_Wx", "p_Wy"
    one, two = numbers[0], numbers[1]
    stages += TwoLinks(one, two, u, v, names[0], names[1], sign=sigma[1]).stages
    known = lengths(**dict(zip(names, a, strict=True)))
    before = [link.gamma for link in links]
    zeros = np.zeros(chain.n)
    variables = [f"θ{index(i + 1)}" if chain.revolute[i] else f"d{index(i + 1)}" for i in range(chain.n)]
    for k, i in enumerate(turning):
        zeros[i] = chain.offsets[i] + links[k].beta + (before[k - 1] if k else 0.0)
    if n == 3:
        stages.append(_third(numbers, sigma))
    if len(sliding):
        i = sliding[0]
        stages.insert(0, _slide(i + 1, "p_Wz" if n == 2 else "p_z", signs[i]))
        height = float((invert(base) @ _at_zero(chain) @ end)[2, 3])
        known |= lengths(**{"h₀": height})
        zeros[i] = chain.offsets[i]
    title = "SCARA arm: the height, and a planar arm" if len(sliding) else f"planar {n}R arm"
    rotation = f"R_z(θ{index(one)})·R_x(α{index(one)})·R_z(θ{index(two)})·K"
    if n == 2:
        K = (rotation_transform(Z, -last.beta) @ between[-1] @ end)[:3, :3]
        known |= {**angles(**{f"α{index(one)}": links[0].alpha}), "K": Quantity(K, "rotation")}
    arm = PositioningArm(title, tuple(stages), tuple(variables), tuple(zeros.tolist()), known, base, rotation)
    return arm, rest


def _merged(chain: Chain) -> tuple[Array, list[Array], dict[int, int] | None]:
    """The frame of the first turning joint, the transforms after each turning joint but for the end, and how each
    slide points (1 or -1 along the first axis), all slides being at 0; None unless all axes are parallel.
    """
    frame = chain.constants[0]
    between: list[Array] = []
    axes: list[Array] = []
    base = None
    for i in range(chain.n):
        if chain.revolute[i]:
            base = frame if base is None else base
            between.append(np.eye(4))
        axes.append(frame[:3, 2])
        if i + 1 < chain.n:
            if between:
                between[-1] = between[-1] @ chain.constants[i + 1]
            frame = frame @ chain.constants[i + 1]
    if base is None:
        return frame, between, None
    first = base[:3, 2]
    if any(np.linalg.norm(np.cross(first, z)) > SAME for z in axes):
        return base, between, None
    return base, between, {i: int(np.sign(first @ z)) for i, z in enumerate(axes)}


def _at_zero(chain: Chain) -> Array:
    """The frame (4, 4) after the last joint's motion, with every joint at 0."""
    T: Array = chain.constants[0]
    for C in chain.constants[1:-1]:
        T = T @ C
    return T


def _third(numbers: Sequence[int], sigma: Sequence[int]) -> Stage:
    """The last angle from φ = θ₁ + σ₂θ₂ + σ₃θ₃."""
    one, two, three = (f"θ{index(i)}" for i in numbers)
    inner = f"φ − {one} {'−' if sigma[1] > 0 else '+'} {two}"
    other = f"{one} {'+' if sigma[1] > 0 else '−'} {two} − φ"
    return lambda sheet: [sheet.step(three, inner if sigma[2] > 0 else other, "angle")]


def _slide(number: int, height: str, sign: int) -> Stage:
    formula = f"{height} − h₀" if sign > 0 else f"h₀ − {height}"
    return lambda sheet: [sheet.step(f"d{index(number)}", formula, "length", "the height is the slide's alone")]


def wrist_point(sheet: WorkedSteps, last: int) -> Sequence[WorkedSteps]:
    """φ and p_W of a planar arm of three turning joints, from the tool's pose in the arm's frame."""
    a = f"a{index(last)}"
    sheet = sheet.step("φ", "atan2(n_y, n_x)", "angle", "the end effector's angle: its x axis in the plane")
    if not sheet[a]:
        sheet = sheet.step("p_Wx", "p_x", "length", "the last link has no length")
        return [sheet.step("p_Wy", "p_y", "length")]
    sheet = sheet.step("p_Wx", f"p_x − {a}·cos(φ)", "length", "back along the last link to the wrist point W")
    return [sheet.step("p_Wy", f"p_y − {a}·sin(φ)", "length")]
