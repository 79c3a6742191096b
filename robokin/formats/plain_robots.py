"""Robots as the few numbers that one configuration's pose hangs on, for answers that need no arrays.

`chains.jsonl` in the library's folder has a line for each arm whose joints move one by one, with the check sum of the
file that it was made from. A line counts only for a file with that check sum; any other file is read.
`python -m robokin.formats.plain_robots` writes the file anew, and that of `kept_robots`; a test says when it should be.
"""

from __future__ import annotations

import json
import re
from functools import cached_property
from math import inf, isfinite
from typing import TYPE_CHECKING, Any

from robokin.formats.kept_robots import TABLES
from robokin.formats.library import library_file, library_files, library_folder
from robokin.formats.library_index import check_sum
from robokin.formats.vector_expressions import parse_floats
from robokin.kernel.chain_walk import ChainWalk, shift_of
from robokin.kernel.code_lines import LONGEST, PlainFrame, plain_frame
from robokin.kernel.native_module import native_module
from robokin.units import Units, value_in_unit

if TYPE_CHECKING:
    from robokin.model import Robot

CHAINS = "chains.jsonl"

FILES = (".yaml", ".yml")
"""Endings of descriptions in robokin's own format."""

NAME = re.compile(r"[a-z0-9]+(-[a-z0-9]+)*")
"""Names of the library."""


class PlainRobot:
    """An arm whose joints move one by one.

    turns: of each of its n joints whether it turns; least and most: what counts as within its limits; poses: named
    ones, each n values; offsets: n; constants: the n + 1 transforms between the joints, three rows of four numbers
    each; all in [rad | m].
    """

    def __init__(self, fields: dict[str, Any]) -> None:
        """`fields` as `fields_of` gives them."""
        self.id: str = fields["id"]
        self.name: str = fields["name"]
        self.units = Units(*fields["units"])
        self.turns = [letter == "R" for letter in fields["joints"]]
        self.least = [-inf if low is None else float(low) for low, _ in fields["limits"]]
        self.most = [inf if high is None else float(high) for _, high in fields["limits"]]
        self.poses = {name: [*map(float, values)] for name, values in fields["poses"].items()}
        self.offsets = [*map(float, fields["offsets"])]
        self.constants = [[*map(float, numbers)] for numbers in fields["constants"]]
        if not len(self.turns) == len(self.least) == len(self.offsets) == len(self.constants) - 1:
            raise ValueError("a line of the chains does not fit itself")

    @cached_property
    def frame(self) -> PlainFrame:
        """The tool's frame as a function of n joint values [rad | m]: its first three rows, twelve numbers [m]."""
        known = native_module()
        if known is not None and len(self.turns) <= known.most_joints:
            constants = tuple(number for C in self.constants for number in (*C, 0.0, 0.0, 0.0, 1.0))
            handle = known.plain_chain(constants, tuple(map(float, self.turns)), tuple(self.offsets))
            pose = known.plain_pose
            return lambda q: pose(handle, tuple(q))
        last = len(self.constants) - 1
        steps = [
            [shift_of([numbers[k : k + 4] for k in (0, 4, 8)], mark=i == last)]
            for i, numbers in enumerate(self.constants)
        ]
        return plain_frame(ChainWalk(steps, self.turns, self.offsets))

    def factors(self, units: Units) -> list[float]:
        """SI in one unit of each joint's value [rad | m]."""
        return [units.radians if turns else units.metres for turns in self.turns]

    def configuration(self, text: str, units: Units) -> tuple[list[float], bool]:
        """n joint values in the units, from a vector or from the name of a pose, and whether from a name.

        Raises InputError for what is neither.
        """
        name = text.strip()
        if name in self.poses:
            return [*map(value_in_unit, self.poses[name], self.factors(units))], True
        return parse_floats(text, "--q", self.turns, units, "one for each joint"), False

    def within_limits(self, q: list[float]) -> bool:
        """Whether n joint values [rad | m] respect every limit."""
        return all(low <= value <= high for low, value, high in zip(self.least, q, self.most, strict=True))


def plain_robot(robot: Robot) -> PlainRobot | None:
    """A robot as plain numbers; None for one whose joints hang on each other, that has none, or too many."""
    fields = fields_of(robot)
    return None if fields is None else PlainRobot(fields)


def library_robot(name: str) -> PlainRobot | None:
    """An arm of the library by its name, in any case; None where the library's own file must be read."""
    name = name.lower()
    if not NAME.fullmatch(name) or (path := library_file(name)) is None:
        return None
    try:
        text = (library_folder() / CHAINS).read_bytes()
        start = text.find(b'{"id": "%s",' % name.encode())
        fields = json.loads(text[start : text.find(b"\n", start)]) if start >= 0 else None
        return PlainRobot(fields) if fields and fields["check"] == check_sum(path) else None
    except (OSError, ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return None


def fields_of(robot: Robot) -> dict[str, Any] | None:
    """What `chains.jsonl` says of a robot, but for the check sum; None for one that it has not."""
    from robokin.kernel.chain import chain_of
    from robokin.model import CoupledRobot
    from robokin.model.robot import tolerated

    if isinstance(robot, CoupledRobot) or not 0 < robot.n <= LONGEST:
        return None
    chain = chain_of(robot)
    limits = zip(*(ends.tolist() for ends in tolerated(robot.limits)), strict=True)
    return {
        "id": robot.id,
        "name": robot.name,
        "units": [robot.units.length, robot.units.angle],
        "joints": robot.types,
        "limits": [[_short(end) if isfinite(end) else None for end in ends] for ends in limits],
        "poses": {name: [*map(_short, pose.tolist())] for name, pose in robot.poses.items()},
        "offsets": [*map(_short, chain.offsets.tolist())],
        "constants": [[*map(_short, C[:3].ravel().tolist())] for C in chain.constants],
    }


def chains_text() -> str:
    """The chains of the library as it is now."""
    from robokin.formats.read import read_file
    from robokin.model import Robot

    lines = []
    for path in library_files():
        loaded = read_file(path, id=path.stem)
        fields = fields_of(loaded) if isinstance(loaded, Robot) and not loaded.notes else None
        if fields is not None:
            first = {"id": fields.pop("id"), "check": check_sum(path)}
            lines.append(json.dumps(first | fields, ensure_ascii=False) + "\n")
    return "".join(lines)


def tables_text() -> str:
    """The tables of the library as it is now: see `kept_robots`."""
    from robokin.formats.kept_robots import kept_fields
    from robokin.formats.read import read_file
    from robokin.model import Robot

    lines = []
    for path in library_files():
        loaded = read_file(path, id=path.stem)
        kept = kept_fields(loaded) if isinstance(loaded, Robot) else None
        if kept is not None:
            first = {"id": kept.pop("id"), "check": check_sum(path)}
            lines.append(json.dumps(first | kept, ensure_ascii=False) + "\n")
    return "".join(lines)


def _short(value: float) -> float | int:
    """A number as a whole one where nothing is lost; a zero keeps its sign."""
    return int(value) if value.is_integer() and abs(value) < 2**53 and str(value) != "-0.0" else value


if __name__ == "__main__":
    (library_folder() / CHAINS).write_text(chains_text(), encoding="utf-8")
    (library_folder() / TABLES).write_text(tables_text(), encoding="utf-8")
