"""Workspaces to plain data: what JSON says, and what the table and the pictures pick from."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from robokin.arrays import Array
from robokin.model.joint_units import joint_factors
from robokin.pictures.workspace_cuts import Cut
from robokin.records.envelope import envelope
from robokin.spatial import quaternion_from_rotation
from robokin.units import Units
from robokin.workspace.place import WorkspacePlace
from robokin.workspace.sizes import Measure
from robokin.workspace.workspace_result import Dexterity, Workspace

SETS = {
    "reachable": "some orientation",
    "several": "more than one orientation (the lecture's dexterous workspace)",
    "every": "every orientation on the grid (the dexterous workspace)",
}
"""The three sets by name, with what a place needs to be in them."""

GROUPS = {
    "SO(2)": "angles about the one axis that the tool turns about",
    "S2": "directions of the tool's z axis",
    "SO(3)": "rotations",
    "curve": "a curve of rotations, which no grid of them meets",
    "finite": "finitely many: the position leaves no more",
}
"""What an orientation is for an arm, by its group."""


STILL = 1e-9
"""A component of a unit vector that changes by less stands still."""

WORDS = {"SO(2)": "angles", "S2": "directions", "SO(3)": "rotations", "curve": "rotations", "finite": "rotations"}
"""What each of them is called in short."""


def workspace_record(found: Workspace, units: Units, cuts: Sequence[Cut] = ()) -> dict[str, Any]:
    """The JSON document of a workspace."""
    space, extent = found.space, found.extent
    factors = joint_factors(space.robot, units)
    record: dict[str, Any] = {
        **envelope("robot", space.robot.id, units),
        "samples": found.samples,
        "seed": found.seed,
        "sampling": found.sampling,
        "bounds": {"min": _lengths(extent.low, units), "max": _lengths(extent.high, units)},
        "reach": {"min": extent.least / units.metres, "max": extent.greatest / units.metres, "from": "base"},
        "dimension": space.dimension,
    }
    if space.dimension:
        record |= measure_record(found.measure, space.quantity, space.dimension, units)
        record |= {"method": found.measure.method, "evaluations": found.measure.evaluations}
        record["error_is_proven"] = found.measure.exact
    record |= {
        "moving_joints": [i + 1 for i in space.moving],
        "symmetric": space.axis is not None,
        "structural_length": found.structural_length / units.metres,
        "length_index": found.length_index,
        "volume_index": found.volume_index,
        "at": {
            "min": (extent.q_low / factors + 0.0).tolist(),
            "max": (extent.q_high / factors + 0.0).tolist(),
            "least": (extent.q_least / factors + 0.0).tolist(),
            "greatest": (extent.q_greatest / factors + 0.0).tolist(),
        },
        "dexterity": dexterity_record(found.dexterity, found, units) if found.dexterity else None,
        "cuts": [cut_record(cut, units) for cut in cuts],
        "notes": list(found.notes),
    }
    return record


def measure_record(measure: Measure, quantity: str, dimension: int, units: Units) -> dict[str, Any]:
    """`{"volume": …, "volume_error": …}`, in the length unit to the power of the dimension; null where not known."""
    if not known(measure):
        return {quantity: None, f"{quantity}_error": None}
    factor = units.metres**dimension
    return {quantity: measure.value / factor, f"{quantity}_error": measure.error / factor}


def known(measure: Measure) -> bool:
    """Whether a size could be found."""
    return bool(np.isfinite(measure.value) and np.isfinite(measure.error))


def dexterity_record(dexterity: Dexterity, found: Workspace, units: Units) -> dict[str, Any]:
    """How freely the tool can be turned: the three sets, and the map place by place."""
    quantity, dimension = found.space.quantity, found.space.dimension
    measures = {"reachable": dexterity.some, "several": dexterity.several, "every": dexterity.every}
    holds = holds_at_a_point(dexterity)
    return {
        "group": dexterity.group,
        "orientation": GROUPS[dexterity.group],
        "orientations": dexterity.orientations,
        "spacing": dexterity.spacing / units.radians,
        "mean": dexterity.mean if dexterity.orientations else None,
        "sets": {
            name: {
                "needs": SETS[name],
                **(measure_record(measure, quantity, dimension, units) if dimension else {"holds": holds[name]}),
            }
            for name, measure in measures.items()
        },
        "map": {
            "cell": dexterity.cell / units.metres,
            "section": dexterity.section,
            "points": (dexterity.points / units.metres + 0.0).tolist(),
            "fraction": dexterity.fraction.tolist(),
        },
    }


def holds_at_a_point(dexterity: Dexterity) -> dict[str, bool]:
    """Of a set that is one point, which of the three sets that is in."""
    every = dexterity.orientations > 0 and dexterity.mean == 1.0
    return {
        "reachable": True,
        "several": (dexterity.group != "finite" and dexterity.mean > 0.0) or dexterity.group == "curve",
        "every": every,
    }


def cut_record(cut: Cut, units: Units) -> dict[str, Any]:
    """A section or slice: its area, parts and holes, and its boundary."""
    return {
        "cut": cut.name,
        "axes": list(cut.labels),
        **measure_record(cut.area, "area", 2, units),
        "parts": cut.outline.pieces,
        "holes": len(cut.outline.holes),
        "outline": [_lengths(loop, units) for loop in cut.outline.loops],
    }


def place_record(place: WorkspacePlace, robot: str, units: Units) -> dict[str, Any]:
    """Whether a place is reachable, and with which orientations."""
    reached = len(place.rotations)
    record: dict[str, Any] = {
        **envelope("robot", robot, units),
        "position": _lengths(place.point, units),
        "reachable": place.reachable,
        "reachable_is_proven": place.proven,
        "solutions": place.solutions,
        "group": place.group,
        "orientation": GROUPS[place.group],
        "orientations": place.tried or None,
        "reached": reached if place.tried or place.group == "finite" else None,
        "fraction": place.fraction if place.tried else None,
    }
    if place.group == "SO(2)" and place.tried:
        turning = ranges_of(place)
        record["ranges"] = [[first / units.radians, last / units.radians] for first, last in turning.angles]
        record["ranges_of"] = turning.words or None
    if place.group == "S2":
        record["directions"] = (place.rotations[:, :, 2] + 0.0).tolist()
    elif place.group != "curve":
        record["quaternions"] = (quaternion_from_rotation(place.rotations) + 0.0).tolist() if reached else []
    return record


class Ranges(NamedTuple):
    """Ranges of angles [rad], each from its first to its last, and what turns so, in words; nothing where all or none
    of the angles can be reached."""

    angles: list[tuple[float, float]]
    words: str


def ranges_of(place: WorkspacePlace) -> Ranges:
    """Which way the tool's x axis (or y, where that stands still) can point, about an axis of the world."""
    for i in (0, 1):
        pointing = place.rotations[:, :, i]
        still = np.ptp(pointing, axis=0) < STILL if len(pointing) else np.zeros(3)
        if len(place.ranges) and np.sum(still) == 1:
            break
    else:
        return Ranges([], "")
    k = int(np.argmax(still))
    ends = place.ranges[:, :, :, i]
    angles = np.arctan2(ends[:, :, (k + 2) % 3], ends[:, :, (k + 1) % 3])
    angles[:, 1] += 2.0 * np.pi * (angles[:, 1] < angles[:, 0])
    return Ranges([(float(a), float(b)) for a, b in angles], f"{'xy'[i]} axis about {'xyz'[k]}")


def flat_row(record: dict[str, Any]) -> dict[str, Any]:
    """The figures of a workspace's document as one row of a CSV."""
    bounds = {f"{axis}_{end}": record["bounds"][end][i] for i, axis in enumerate("xyz") for end in ("min", "max")}
    quantity = next((name for name in ("volume", "area", "length") if name in record), "")
    row = {
        "robot": record["robot"],
        "samples": record["samples"],
        "seed": record["seed"],
        **bounds,
        "reach_min": record["reach"]["min"],
        "reach_max": record["reach"]["max"],
        "dimension": record["dimension"],
        "quantity": quantity,
        "size": record.get(quantity, 0.0),
        "size_error": record.get(f"{quantity}_error", 0.0),
        "structural_length": record["structural_length"],
        "length_index": record["length_index"],
        "volume_index": record["volume_index"],
    }
    if record["dexterity"]:
        for name, figures in record["dexterity"]["sets"].items():
            if quantity:
                row |= {name: figures[quantity], f"{name}_error": figures[f"{quantity}_error"]}
            else:
                row[name] = str(figures["holds"]).lower()
        row["mean"] = record["dexterity"]["mean"]
    return {name: "" if value is None else value for name, value in row.items()}


def _lengths(values: Array, units: Units) -> Any:
    return (values / units.metres + 0.0).tolist()
