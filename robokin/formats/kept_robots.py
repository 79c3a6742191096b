"""Arms of the library as values that need no reading, for commands that would take longer to read them than to answer.

`tables.jsonl` in the library's folder has a line for each arm whose joints move one by one, with the check sum of the
file that it was made from: see `plain_robots`. What is made of a line is what the reader makes of the file.
`python -m robokin.formats.plain_robots` writes the file anew; a test says when it should be.
"""

from __future__ import annotations

import json
import zlib
from dataclasses import fields
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from robokin.model import Joint, Robot

TABLES = "tables.jsonl"

ARRAYS = ("origin", "axis", "base", "tool")
"""Fields that are arrays."""


def check_sum_in(folder: Path, path: Path) -> int:
    """The check sum of a description of the library in a folder, and of the folders in it that the file is in."""
    text = path.read_bytes().replace(b"\r\n", b"\n")  # a checkout on Windows has other ends of lines
    return zlib.crc32(text, zlib.crc32(" ".join(path.relative_to(folder).parts[:-1]).encode()))


def kept_robot(folder: Path, path: Path) -> Robot | None:
    """The arm that a file of the library in a folder describes; None where the file must be read."""
    try:
        text = (folder / TABLES).read_bytes()
        start = text.find(b'{"id": "%s",' % path.stem.encode())
        kept = json.loads(text[start : text.find(b"\n", start)]) if start >= 0 else None
        return _robot(kept) if kept and kept.pop("check") == check_sum_in(folder, path) else None
    except (OSError, ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return None


def _robot(kept: dict[str, Any]) -> Robot:
    import numpy as np

    from robokin.model import Joint, Robot
    from robokin.model.robot import JointType
    from robokin.units import Units

    rows = []
    for row in kept.pop("rows"):
        values = _arrays(row)
        low, high = values.pop("limits", (None, None))
        values["limits"] = (-inf if low is None else low, inf if high is None else high)
        values["type"] = JointType(values["type"])
        values["texts"] = tuple(map(tuple, values.get("texts", ())))
        rows.append(Joint(**values))
    kept["units"] = Units(*kept["units"])
    kept["poses"] = {name: np.array(pose, dtype=np.float64) for name, pose in kept["poses"].items()}
    kept["texts"] = tuple(map(tuple, kept["texts"]))
    return Robot(rows=tuple(rows), **_arrays(kept))


def _arrays(kept: dict[str, Any]) -> dict[str, Any]:
    """Fields with arrays for the lists that stand for them."""
    import numpy as np

    return {
        name: np.array(value, dtype=np.float64) if name in ARRAYS and value is not None else value
        for name, value in kept.items()
    }


def kept_fields(robot: Robot) -> dict[str, Any] | None:
    """What `tables.jsonl` says of a robot, but for the check sum; None for one that it has not."""
    from robokin.model import CoupledRobot

    if isinstance(robot, CoupledRobot) or robot.notes:
        return None
    values = {part.name: getattr(robot, part.name) for part in fields(robot)}
    del values["notes"]
    values["rows"] = [_row_fields(row) for row in robot.rows]
    values["units"] = [robot.units.length, robot.units.angle]
    values["parameters"] = dict(robot.parameters)
    values["poses"] = {name: pose.tolist() for name, pose in robot.poses.items()}
    return {"id": values.pop("id")} | {
        name: value.tolist() if name in ARRAYS else value for name, value in values.items()
    }


def _row_fields(row: Joint) -> dict[str, Any]:
    """The fields of a row that are not what they mostly are."""
    kept: dict[str, Any] = {}
    for part in fields(row):
        value = getattr(row, part.name)
        if part.name in ARRAYS:
            if value is not None:
                kept[part.name] = value.tolist()
        elif part.name == "limits":
            kept["limits"] = [None if abs(end) == inf else end for end in value]
        elif part.name in ("name", "type") or value != part.default or str(value) == "-0.0":
            kept[part.name] = value
    return kept
