"""A page in one file that needs no network: the set turns with the mouse and is cut open, beside it its planes."""

from __future__ import annotations

import base64
import html
import json
import re
from importlib import resources
from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.pictures.arm_faces import COLOURS
from robokin.pictures.arm_scene import SLANTING
from robokin.pictures.picture import CLOSED, Cloud, GridTable, Panel, Picture, PosedArm, SolidSet, parts

DIGITS = 5
"""Significant digits of a place in a plane picture: far finer than a screen."""

INCLUDE = re.compile(r"@INCLUDE ([a-z]+\.(?:js|css|html))@")
"""Where a page takes in a script or a style that it shares with others."""

COMMENT = re.compile(r"^ *// .*\n", re.MULTILINE)
"""A line of a script that is for its developers: a page carries none."""

STEPS = 65535
"""Steps along a side of the cloud's box."""


def page(picture: Picture) -> bytes:
    """The picture as an .html file."""
    units = picture.units
    scale = 1.0 / units.metres
    low, high = _box(picture)
    solid, cloud = picture.solid, picture.cloud
    data = {
        "title": picture.title,
        "note": "",
        "subtitle": picture.subtitle,
        "robot": picture.robot,
        "options": picture.options,
        "length": units.length,
        "angle": units.angle,
        "radians": units.radians,
        "figures": [list(pair) for pair in picture.figures],
        "plates": [_plate(panel, scale) for panel in picture.panels],
        "solid": None if solid is None else _solid(solid, scale),
        "cloud": None if cloud is None else _cloud(cloud, scale),
        "arms": [_arm(arm, scale) for arm in picture.arms],
        "flat": solid is None and cloud is None,
        "box": _short(np.array([low, high]) * scale),
        "size": float(f"{float(np.max(high - low)) * scale:.{DIGITS}g}"),
        # The floor lies below all that is drawn.
        "forked": True,
        "view": list(SLANTING),
        "colours": COLOURS,
    }
    return filled("page.html", picture.title, data)


def filled(template: str, title: str, data: dict[str, Any]) -> bytes:
    """A page of this folder with its title and its data in their places."""
    # Inside a script element nothing may look like its end.
    text = json.dumps(data, ensure_ascii=True, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
    folder = resources.files("robokin.pictures")
    page = folder.joinpath(template).read_text(encoding="utf-8")
    page = INCLUDE.sub(lambda found: folder.joinpath(found[1]).read_text(encoding="utf-8").rstrip("\n"), page)
    page = COMMENT.sub("", page)
    before, _, rest = page.partition("@TITLE@")
    middle, _, after = rest.partition("@DATA@")
    return (before + html.escape(title) + middle + text + after).encode(errors="backslashreplace")


def _plate(panel: Panel, scale: float) -> dict[str, Any]:
    low, high = panel.bounds()
    margin = 0.04 * float(np.max(high - low))
    record: dict[str, Any] = {
        "title": panel.title,
        "labels": list(panel.labels),
        "box": _short(np.concatenate([low - margin, high + margin]) * scale),
        "loops": [_short(loop * scale) for loop in panel.outline.loops],
        "edges": [_short(line * scale) for line in panel.edges()],
        "free": [_short(loop * scale) for loop in panel.free.loops] if panel.free else [],
        "arms": [_short(arm * scale) for arm in panel.arms],
        "pose": panel.pose,
        "cells": None,
        "meaning": "",
    }
    record["counts"] = None if panel.counts is None else _table(panel.counts, scale)
    if panel.degrees is not None:
        degrees = panel.degrees
        first = degrees.points.min(axis=0)
        index = np.round((degrees.points - first) / degrees.cell).astype(int)
        values = np.full(index.max(axis=0) + 1, 255, dtype=np.uint8)
        values[tuple(index.T)] = parts(degrees.fraction)
        step = np.full(2, degrees.cell)
        record |= {"cells": _table(GridTable("uv", first, step, values), scale), "meaning": degrees.meaning}
    return record


def _short(values: Array) -> Any:
    return json.loads(json.dumps(values.tolist()), parse_float=lambda text: float(f"{float(text):.{DIGITS}g}"))


def _box(picture: Picture) -> tuple[Array, Array]:
    """Corners (3,), (3,) [m] of a box about the set and the arm in its first pose."""
    corners: list[Array] = []
    if picture.cloud is not None:
        corners += [picture.cloud.points, *picture.cloud.arms]
    if picture.solid is not None:
        corners += [solid_corners(picture.solid)]
        corners += [np.array([end for piece in arm.pieces for end in piece[1:3]]) for arm in picture.arms[:1]]
    points = np.concatenate(corners) if corners else np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]])
    low, high = points.min(axis=0), points.max(axis=0)
    room = np.maximum(0.5 * (1e-6 * np.max(high - low) - (high - low)), 0.0) if np.any(high > low) else np.full(3, 0.5)
    return low - room, high + room


def solid_corners(solid: SolidSet) -> Array:
    """(m, 3) [m] points whose box is the solid's."""
    if solid.axis is None:
        assert solid.block is not None
        sides = solid.block.low + 0.5 * solid.block.step, solid.block.step * (np.array(solid.block.values.shape) - 2)
        return np.stack([sides[0], sides[0] + sides[1]])
    turn = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    line = np.concatenate(solid.loops)
    r, z = line[np.unique(np.concatenate([line.argmin(axis=0), line.argmax(axis=0)]))].T
    points = np.stack(
        [np.outer(r, np.cos(turn)), np.outer(r, np.sin(turn)), np.repeat(z[:, None], 24, axis=1)], axis=-1
    )
    return np.asarray(points.reshape(-1, 3) @ solid.axis[:3, :3].T + solid.axis[:3, 3])


def _solid(solid: SolidSet, scale: float) -> dict[str, Any]:
    record: dict[str, Any] = {"axis": None, "gaps": None}
    if solid.axis is not None and solid.low is not None:
        axis = solid.axis.copy()
        axis[:3, 3] *= scale
        record |= {
            "axis": (axis + 0.0).ravel().tolist(),
            "loops": [_short(loop * scale) for loop in solid.loops],
            "edges": [_short(line * scale) for line in solid.edges],
            "low": (solid.low * scale).tolist(),
            "step": solid.step * scale,
            "shape": list(solid.shape),
        }
    if solid.gaps is not None:
        # Middles in parts of a turn, halves of widths from the one that is no gap to half a turn.
        middle = np.round(solid.gaps[..., 0] / (2.0 * np.pi) * STEPS)
        half = np.round((solid.gaps[..., 1] - CLOSED) / (np.pi - CLOSED) * STEPS)
        record |= {"gaps": _packed(np.stack([middle, half], axis=-1).astype("<u2")), "closed": CLOSED,
                   "most": solid.gaps.shape[2]}  # fmt: skip
    for name in ("block", "counts", "freedom"):
        table = getattr(solid, name)
        record[name] = None if table is None else _table(table, scale)
    return record


def _table(table: GridTable, scale: float) -> dict[str, Any]:
    """A table with its runs of equal bytes: the byte, and how many follow."""
    flat = table.values.ravel()
    starts = np.flatnonzero(np.concatenate([[True], flat[1:] != flat[:-1]]))
    runs = np.diff(np.append(starts, len(flat)))
    # A run of more than 255 is several.
    parts_of = -(-runs // 255)
    lengths = np.full(int(parts_of.sum()), 255)
    lengths[np.cumsum(parts_of) - 1] = runs - 255 * (parts_of - 1)
    pairs = np.stack([np.repeat(flat[starts], parts_of), lengths], axis=1).astype(np.uint8)
    lengths_of = np.array([scale, scale, 1.0 if table.kind == "rza" else scale])[: len(table.low)]
    return {"kind": table.kind, "low": (table.low * lengths_of).tolist(), "step": (table.step * lengths_of).tolist(),
            "shape": list(table.values.shape), "runs": _packed(pairs)}  # fmt: skip


def _packed(values: Any) -> str:
    return base64.b64encode(np.ascontiguousarray(values).tobytes()).decode()


def _arm(arm: PosedArm, scale: float) -> dict[str, Any]:
    pieces = [
        [role, _short(a * scale), _short(b * scale), _short(across), float(f"{width * scale:.{DIGITS}g}"), sides]
        for role, a, b, across, width, sides in arm.pieces
    ]
    return {"name": arm.name, "pieces": pieces}


def _cloud(cloud: Cloud, scale: float) -> dict[str, Any]:
    corners = np.concatenate([cloud.points, *cloud.arms])
    low, high = corners.min(axis=0), corners.max(axis=0)
    # A flat cloud's box is as thin as a line, but no thinner.
    thick = np.maximum(high - low, 1e-6 * np.max(high - low) or 1.0)
    packed = np.round(np.clip((cloud.points - low) / thick, 0.0, 1.0) * STEPS).astype("<u2")
    return {
        "points": _packed(packed),
        "low": (low * scale).tolist(),
        "high": ((low + thick) * scale).tolist(),
        "arms": [(arm * scale).tolist() for arm in cloud.arms],
    }
