"""A planar mechanism as lengths: bodies with the places of their joints in frames of their own, and driven values.

Points of a plane are complex numbers [m], directions are angles [rad].
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class BlueJoint:
    """A joint of two bodies: `revolute`, `prismatic` or `fixed`.

    places: where it is in the frame of each; angles: its direction there, that of a slide or a weld. value: how far the
    second body is turned [rad] against the first, or has slid along the direction [m]; None where that is asked.
    """

    name: str
    type: str
    bodies: tuple[str, str]
    places: tuple[complex, complex]
    angles: tuple[float, float] = (0.0, 0.0)
    value: float | None = None


@dataclass(frozen=True)
class Blueprint:
    """Bodies, the one that stands still with its frame as the world's, and the joints between them."""

    bodies: tuple[str, ...]
    ground: str
    joints: tuple[BlueJoint, ...]


@dataclass(frozen=True)
class AssemblyMode:
    """A way to put a mechanism together.

    places: of each joint in the world [m]; angles: of each body's frame [rad]; double: whether two ways fall together
    here, as at a dead point.
    """

    places: dict[str, complex]
    angles: dict[str, float]
    double: bool = False
