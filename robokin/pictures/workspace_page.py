"""A page in one file that needs no network: the cloud turns with the mouse, beside it the plane pictures."""

from __future__ import annotations

import base64
import html
import json
import re
from importlib import resources
from typing import Any

import numpy as np

from robokin.arrays import Array
from robokin.pictures.picture import Cloud, Panel, Picture

DIGITS = 5
"""Significant digits of a place in a plane picture: far finer than a screen."""

INCLUDE = re.compile(r"@INCLUDE ([a-z]+\.(?:js|css))@")
"""Where a page takes in a script or a style that it shares with others."""

STEPS = 65535
"""Steps along a side of the cloud's box."""


def page(picture: Picture) -> bytes:
    """The picture as an .html file."""
    scale = 1.0 / picture.units.metres
    data = {
        "title": picture.title,
        "subtitle": picture.subtitle,
        "unit": picture.units.length,
        "figures": [list(pair) for pair in picture.figures],
        "plates": [_plate(panel, scale) for panel in picture.panels],
        "cloud": None if picture.cloud is None else _cloud(picture.cloud, scale, picture.units.length),
    }
    return filled("page.html", picture.title, data)


def filled(template: str, title: str, data: dict[str, Any]) -> bytes:
    """A page of this folder with its title and its data in their places."""
    # Inside a script element nothing may look like its end.
    text = json.dumps(data, ensure_ascii=True, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
    folder = resources.files("robokin.pictures")
    page = folder.joinpath(template).read_text(encoding="utf-8")
    page = INCLUDE.sub(lambda found: folder.joinpath(found[1]).read_text(encoding="utf-8").rstrip("\n"), page)
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
        "cells": None,
    }
    if panel.degrees is not None:
        places = np.column_stack([panel.degrees.points * scale, panel.degrees.fraction])
        record |= {"cells": _short(places), "cell": panel.degrees.cell * scale, "meaning": panel.degrees.meaning}
    return record


def _short(values: Array) -> Any:
    return json.loads(json.dumps(values.tolist()), parse_float=lambda text: float(f"{float(text):.{DIGITS}g}"))


def _cloud(cloud: Cloud, scale: float, unit: str) -> dict[str, Any]:
    corners = np.concatenate([cloud.points, *cloud.arms])
    low, high = corners.min(axis=0), corners.max(axis=0)
    # A flat cloud's box is as thin as a line, but no thinner.
    thick = np.maximum(high - low, 1e-6 * np.max(high - low) or 1.0)
    high = low + thick
    least, most = float(cloud.values.min()), float(cloud.values.max())
    values = (cloud.values - least) / max(most - least, 1e-300)
    if cloud.meaning:
        least, most, values = 0.0, 1.0, cloud.values
    packed = np.column_stack([(cloud.points - low) / thick, values])
    packed = np.round(np.clip(packed, 0.0, 1.0) * STEPS).astype("<u2")
    factor = 1.0 if cloud.meaning else scale
    return {
        "points": base64.b64encode(packed.tobytes()).decode(),
        "low": (low * scale).tolist(),
        "high": (high * scale).tolist(),
        "range": [float(f"{least * factor:.4g}"), float(f"{most * factor:.4g}")],
        "meaning": cloud.meaning or f"z [{unit}]",
        "arms": [(arm * scale).tolist() for arm in cloud.arms],
    }
