"""The wheels of a base as `robokin show` has them."""

from __future__ import annotations

from typing import Any

import numpy as np

from robokin.cli.arguments import in_units
from robokin.cli.output.numbers import show
from robokin.model import WheeledBase
from robokin.records.envelope import envelope
from robokin.units import Units


def wheel_record(base: WheeledBase, units: Units) -> dict[str, Any]:
    """A base's wheels, in the given units."""

    def said(value: float, factor: float) -> float:
        return float(in_units(np.array(value), factor))

    return {
        **envelope("base", base.id, units),
        "name": base.name,
        "kind": "wheeled",
        "description": base.description,
        "source": base.source,
        "steering": "parallel" if base.parallel else "independent",
        "parameters": dict(base.parameters),
        "wheels": [
            {
                "name": wheel.name,
                "type": wheel.type,
                "at": [said(wheel.x, units.metres), said(wheel.y, units.metres)],
                "angle": said(wheel.angle, units.radians),
                "radius": said(wheel.radius, units.metres) or None,
                "offset": said(wheel.offset, units.metres) if wheel.type == "castor" else None,
                "roller": said(wheel.roller, units.radians) if wheel.type == "swedish" else None,
                "driven": wheel.driven,
                "turned": wheel.turned,
            }
            for wheel in base.wheels
        ],
    }


def wheel_table(record: dict[str, Any]) -> bytes:
    """The wheels below one another, and what else the description says."""
    from robokin.cli.output.tables import heading, pairs, render, table

    drawn = table()
    numbers = ("x", "y", "angle", "radius", *(key for key in ("offset", "roller") if _some(record, key)))
    for name in ("wheel", "type", *numbers, "motor"):
        drawn.add_column(name, justify="right" if name in numbers else "left")
    for wheel in record["wheels"]:
        values = dict(zip("xy", wheel["at"], strict=True)) | wheel
        cells = ["" if values[name] is None else show(values[name]) for name in numbers]
        motors = [word for word in ("driven", "turned") if wheel[word]]
        drawn.add_row(wheel["name"], wheel["type"], *cells, ", ".join(motors))
    units = record["units"]
    entries = [("steering", "the steered wheels stay parallel")] if record["steering"] == "parallel" else []
    if record["parameters"]:
        listed = ", ".join(f"{name} = {show(value)}" for name, value in record["parameters"].items())
        entries.append(("parameters", listed))
    entries += [("about", record["description"])] if record["description"] else []
    entries += [("source", record["source"])] if record["source"] else []
    rest = f"a wheeled base, lengths in {units['length']}, angles in {units['angle']}"
    return render(heading(record["name"], rest), "", drawn, "", pairs(entries))


def _some(record: dict[str, Any], key: str) -> bool:
    return any(wheel[key] is not None for wheel in record["wheels"])
