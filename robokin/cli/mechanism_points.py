"""Points of a mechanism's links, as `robokin dof` and `robokin plot` take them."""

from __future__ import annotations

import numpy as np

from robokin.cli.arguments import parse_numbers, split_vector
from robokin.errors import InputError, did_you_mean, shown
from robokin.mobility.point_paths import Point
from robokin.model import Mechanism
from robokin.units import Units


def typed_point(text: str, mechanism: Mechanism, units: Units) -> Point:
    """A point such as `coupler:1,2`, of a link and in the assembled configuration. Raises InputError."""
    link, colon, place = text.rpartition(":")
    link = link.strip()
    if not colon or not link:
        raise InputError(f"--point: found '{shown(text)}', expected LINK:X,Y, such as {mechanism.links[-1]}:1,2")
    if link not in mechanism.links:
        hint = did_you_mean(link, mechanism.links) or f", expected one of {', '.join(mechanism.links[:12])}"
        raise InputError(f"--point: found the unknown link '{shown(link)}'{hint}")
    plane = mechanism.space == "planar" and len(split_vector(place)) != 3
    what = "x, y" if plane else "x, y and z"
    numbers = parse_numbers(place, "--point", [False] * (2 if plane else 3), units, what)
    return Point(link, np.append(numbers, 0.0)[:3] * units.metres)
