"""All that can be said of one pose, for eyes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from robokin.number_text import show
from robokin.reports.page_tables import heading, number_table, pairs
from robokin.units import Units

LABELS = {"rpy": "roll pitch yaw", "quaternion": "quaternion", "euler": "Euler ZYZ", "abc": "A B C",
          "quaternion-xyzw": "x y z w", "rotvec": "rotation vector", "wpr": "W P R"}  # fmt: skip
"""What a page calls the ways to say an orientation."""


def pose_page(
    name: str, units: Units, q: Sequence[float], rows: Sequence[Sequence[float]],
    orientations: Iterable[tuple[str, Sequence[float]]],
) -> list[Any]:  # fmt: skip
    """The parts of a page about a robot's pose: its three rows of four numbers, and its orientation in some ways."""
    parts: list[Any] = [heading(name, f"lengths in {units.length}, angles in {units.angle}")]
    parts += ["", number_table("nsap", rows, "xyz"), ""]
    entries = [("q", q)] if q else []
    entries += [("position", [row[3] for row in rows])]
    entries += [(LABELS[kind], values) for kind, values in orientations if kind in LABELS]
    parts.append(pairs([(label, "  ".join(map(show, values))) for label, values in entries]))
    return parts
