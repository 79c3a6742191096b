"""Robots of one's own files as the few numbers that one configuration's pose hangs on, for answers without arrays.

A plain file is read here: a table of turning and sliding joints in one of the Denavit-Hartenberg conventions, with
right angles between its axes, and with nothing that an error or a note would be said of. Of any other file None is
said, and the reader of all descriptions reads it; so there is one home for messages, and the numbers are those that it
gives, digit by digit: right angles leave products of 0, 1 and -1.
"""

from __future__ import annotations

import math
import stat
from os import lstat
from pathlib import Path
from typing import TYPE_CHECKING, Any

from robokin.errors import ExpressionError
from robokin.formats.expression_tokens import NAME
from robokin.formats.joint_variables import other_variable, own_names, shift_of
from robokin.formats.number_expressions import RESERVED, evaluate
from robokin.formats.parameters import Parameters
from robokin.formats.plain_robots import FILES, PlainRobot
from robokin.formats.plain_yaml import LONGEST, NotPlainError, plain_tree
from robokin.formats.schema import COMMON, TYPE_LETTERS, VERSION
from robokin.formats.written_numbers import decimals, is_part_of_pi
from robokin.formats.yaml_tree import Mapping, Node, Scalar, Sequence
from robokin.kernel.code_lines import LONGEST as MOST_JOINTS
from robokin.units import METRES, RADIANS, Units

if TYPE_CHECKING:
    from collections.abc import Iterator

KEYS = {*COMMON, "convention", "joints", "poses"}
CONSTANTS = {"theta": True, "d": False, "a": False, "alpha": True}
"""Cells of numbers that stay, and whether they are angles."""

CELLS = {"name", "type", "theta", "d", "a", "alpha", "offset", "limits"}

RIGHT = 3.9e-16
"""A sine or a cosine that is less is 0: a little less than what is taken for a right angle everywhere."""

GREATEST = 1e5
"""Numbers [rad | m] that are more are none of a plain file."""

SIZES = (0.061, 59.0)
"""Lengths [m] that the arms of plain files have, added up: notes are made of smaller and larger ones."""

IN_METRES, IN_MILLIMETRES = 5.0, 20.0
"""Lengths from which on, or below which with decimals, a note may be made in files of these units."""

FAR = 1.99
"""Constants that are so many times the arm's size, added up, may be moved to the arm: see `kernel.chain`."""


MOST_KEPT = 32
"""Files whose robots are kept."""


class FileRobots:
    """Robots of plain files, made anew where a file's bytes have changed."""

    def __init__(self) -> None:
        self.known: dict[str, tuple[bytes, PlainRobot | None]] = {}

    def robot(self, name: str) -> PlainRobot | None:
        """The robot of a file; None for a file that is not plain."""
        if not name.endswith(FILES):
            return None
        data = _plain_bytes(name)
        if data is None:
            return None
        if name not in self.known or self.known[name][0] != data:
            if len(self.known) >= MOST_KEPT:
                self.known.clear()
            self.known[name] = data, robot_of_bytes(data, name)
        return self.known[name][1]


def file_robot(name: str) -> PlainRobot | None:
    """The robot of a plain file; None for any other, and for what is no file."""
    data = _plain_bytes(name) if name.endswith(FILES) else None
    return None if data is None else robot_of_bytes(data, name)


def _plain_bytes(name: str) -> bytes | None:
    """What a file holds, if that can be read twice."""
    try:
        if not stat.S_ISREG(lstat(name).st_mode):
            return None
        with open(name, "rb") as stream:  # noqa: PTH123 - a Path takes a while to load
            data = stream.read(LONGEST + 1)
    except (OSError, ValueError):
        return None
    return data if len(data) <= LONGEST else None


def robot_of_bytes(data: bytes, name: str) -> PlainRobot | None:
    """The robot that the bytes of a file with this name describe; None for a file that is not plain."""
    try:
        root = plain_tree(data.decode("utf-8"), name)
        if root is None:
            return None
        found = PlainRobot(_Description(root).fields(Path(name).stem))
    except (NotPlainError, ExpressionError, UnicodeDecodeError, OverflowError):
        return None
    return found if _near(found) else None


class _Description:
    """The fields of a description, read; raises NotPlainError at whatever may need a word."""

    def __init__(self, root: Mapping) -> None:
        self.root = root.entries
        if not self.root.keys() <= KEYS or _text(self.root.get("robokin")) != str(VERSION):
            raise NotPlainError
        self.units = self._units()
        self.texts = self._parameters()
        parameters = Parameters(self.texts, self.units.degrees)
        for name in self.texts:
            parameters.value(name)
        self.scope = parameters.scope()
        self.made: list[float] = []
        """The lengths that the arm is made of [m]."""

    def fields(self, id: str) -> dict[str, Any]:
        """What `PlainRobot` takes."""
        for name in ("description", "source"):
            if name in self.root:
                _text(self.root[name])
        convention = _text(self.root["convention"]) if "convention" in self.root else "standard"
        joints = self.root.get("joints")
        if convention not in ("standard", "modified") or not isinstance(joints, Sequence):
            raise NotPlainError
        rows = [*self._rows(joints.items)]
        turns = [row["turns"] for row in rows]
        limits = [row["limits"] for row in rows]
        poses = self._poses(self.root["poses"], turns) if "poses" in self.root else {}
        self._check_size(turns, limits)
        return {
            "id": id,
            "name": _text(self.root.get("name")),
            "units": [self.units.length, self.units.angle],
            "joints": "".join("R" if turning else "P" for turning in turns),
            "limits": [[*_tolerated(*ends)] for ends in limits],
            "poses": poses,
            "offsets": [row["offset"] + 0.0 for row in rows],
            "constants": _constants(rows, convention),
        }

    def _units(self) -> Units:
        node = self.root.get("units")
        if node is None:
            return Units()
        if not isinstance(node, Mapping) or not node.entries.keys() <= {"length", "angle"}:
            raise NotPlainError
        given = {key: _text(value) for key, value in node.entries.items()}
        if given.get("length", "m") not in METRES or given.get("angle", "rad") not in RADIANS:
            raise NotPlainError
        return Units(**given)

    def _parameters(self) -> dict[str, str]:
        node = self.root.get("parameters")
        if node is None:
            return {}
        if not isinstance(node, Mapping):
            raise NotPlainError
        if any(name.lower() in RESERVED or not NAME.fullmatch(name) for name in node.entries):
            raise NotPlainError
        return {name: _text(value) for name, value in node.entries.items()}

    def _rows(self, nodes: list[Node]) -> Iterator[dict[str, Any]]:
        """The rows of the table, in [rad | m]."""
        names: set[str] = set()
        if not 0 < len(nodes) <= MOST_JOINTS:
            raise NotPlainError
        for number, node in enumerate(nodes, start=1):
            if not isinstance(node, Mapping) or not node.entries.keys() <= CELLS:
                raise NotPlainError
            cells = dict(node.entries)
            kind = _text(cells.get("type"))
            kind = TYPE_LETTERS.get(kind.upper(), kind)
            if kind not in ("revolute", "prismatic"):
                raise NotPlainError
            name = _text(cells["name"]) if "name" in cells else str(number)
            if name in names:
                raise NotPlainError
            names.add(name)
            turns = kind == "revolute"
            self._take_variable(cells, "theta" if turns else "d", number, name, len(nodes))
            row = {cell: self._number(cells.get(cell), angle) for cell, angle in CONSTANTS.items()}
            offset = self._number(cells.get("offset"), turns)
            yield row | {"turns": turns, "offset": offset, "limits": self._limits(cells.get("limits"), turns)}

    def _take_variable(self, cells: dict[str, Node], variable: str, number: int, name: str, count: int) -> None:
        """Take out the variable's own cell; its constant becomes the offset."""
        node = cells.pop(variable, None)
        if node is None:
            return
        text, own = _text(node), own_names(variable, number, name)
        shift = shift_of(text, own, self.scope)
        if shift is None or shift.sense < 0 or other_variable(text, own, variable, count, self.scope) is not None:
            raise NotPlainError
        if shift.constant:
            if "offset" in cells:
                raise NotPlainError
            cells["offset"] = Scalar(shift.constant, node.mark)

    def _number(self, node: Node | None, angle: bool, *, made: bool = True, limit: bool = False) -> float:
        """A number of a cell [rad | m], of which no note may be made."""
        if node is None:
            return 0.0
        text = _text(node)
        value = evaluate(text, self.scope, angle=angle).number
        text, size = self.texts.get(text.strip("+-() "), text), abs(value)
        if size and (self._odd_angle(value, text, limit) if angle else self._odd_length(size, text)):
            raise NotPlainError
        found = value * (self.units.radians if angle else self.units.metres)
        if not abs(found) <= GREATEST:
            raise NotPlainError
        if made and not angle:
            self.made.append(size)
        return found

    def _odd_angle(self, value: float, text: str, limit: bool) -> bool:
        """Whether an angle may be meant in the other unit."""
        if not self.units.degrees:
            return abs(value) > 2.0 * math.pi
        return is_part_of_pi(value, text) or (limit and abs(value) < 6.3)

    def _odd_length(self, size: float, text: str) -> bool:
        """Whether a length may be meant in the other unit."""
        if self.units.length == "m":
            return size >= IN_METRES
        return self.units.length == "mm" and size < IN_MILLIMETRES and decimals(text) > 0

    def _limits(self, node: Node | None, turns: bool) -> tuple[float, float]:
        if node is None:
            return -math.inf, math.inf
        if not isinstance(node, Sequence) or len(node.items) != 2:
            raise NotPlainError
        low, high = (self._number(end, turns, made=False, limit=True) for end in node.items)
        if low > high:
            raise NotPlainError
        return low, high

    def _poses(self, node: Node, turns: list[bool]) -> dict[str, list[float]]:
        if not isinstance(node, Mapping):
            raise NotPlainError
        poses = {}
        for name, values in node.entries.items():
            if not (name.replace("-", "_").isidentifier() and isinstance(values, Sequence)):
                raise NotPlainError
            if len(values.items) != len(turns):
                raise NotPlainError
            pairs = zip(values.items, turns, strict=True)
            poses[name] = [self._number(value, angle, made=False) for value, angle in pairs]
        return poses

    def _check_size(self, turns: list[bool], limits: list[tuple[float, float]]) -> None:
        """Refuse an arm of which a note on its size may be made."""
        slides = sum(
            max((abs(end) for end in ends if math.isfinite(end)), default=0.0)
            for ends, turning in zip(limits, turns, strict=True)
            if not turning
        )
        size = sum(self.made) * self.units.metres + slides
        if size and not SIZES[0] < size < SIZES[1]:
            raise NotPlainError


def _text(node: Node | None) -> str:
    """A word or a line of text that is not empty."""
    if not isinstance(node, Scalar) or node.empty or not node.text.strip():
        raise NotPlainError
    return " ".join(node.text.split())


def _tolerated(low: float, high: float) -> tuple[float | None, float | None]:
    """The ends of what counts as within limits [rad | m]: see `tolerated` of the model."""
    return (
        None if math.isinf(low) else low - max(1e-9, 1e-12 * abs(low)),
        None if math.isinf(high) else high + max(1e-9, 1e-12 * abs(high)),
    )


def _right(angle: float) -> tuple[float, float]:
    """The cosine and the sine of a multiple of a right angle, given in rad."""
    c, s = math.cos(angle), math.sin(angle)
    if abs(s) < RIGHT:
        return math.copysign(1.0, c), 0.0
    if abs(c) < RIGHT:
        return 0.0, math.copysign(1.0, s)
    raise NotPlainError


def _constants(rows: list[dict[str, Any]], convention: str) -> list[list[float]]:
    """The n + 1 transforms between the joints, three rows of four numbers each [m]."""
    n = len(rows)
    still = {"a": 0.0, "alpha": 0.0, "theta": 0.0, "d": 0.0}
    if convention == "standard":
        return [_step(0.0, 0.0, 0.0, 0.0), *(_step(row["theta"], row["d"], row["a"], row["alpha"]) for row in rows)]
    # Rot(z, theta) Trans(0, 0, d) of a row, then Rot(x, alpha) Trans(a, 0, 0) of the next one.
    pairs = zip([still, *rows], [*rows, still], strict=True)
    constants = [_step(row["theta"], row["d"], after["a"], after["alpha"]) for row, after in pairs]
    assert len(constants) == n + 1
    return constants


def _step(theta: float, d: float, a: float, alpha: float) -> list[float]:
    """Rot(z, theta) Trans(0, 0, d) Trans(a, 0, 0) Rot(x, alpha), its angles multiples of a right one."""
    (ct, st), (ca, sa) = _right(theta), _right(alpha)
    numbers = [ct, -st * ca, st * sa, a * ct, st, ct * ca, -ct * sa, a * st, 0.0, sa, ca, d]
    return [number + 0.0 for number in numbers]


def _near(robot: PlainRobot) -> bool:
    """Whether the frames surely stand near the arm, so that none is moved along its axis: see `kernel.chain`.

    Statement. The size is the length of a way from the first hinge's axis to the tool, whatever the hinges'
    angles are; so it is at least the distance between the two, at any angles, slides at 0. The greatest of some is
    looked at.
    """
    norms = [math.hypot(numbers[3], numbers[7], numbers[11]) for numbers in robot.constants]
    first = robot.turns.index(True) if True in robot.turns else 0
    before = sum(norms[: first + 1]) + sum(map(abs, robot.offsets[:first]))
    enough = sum(norms[1:]) / FAR + before

    def distance(q: list[float]) -> float:
        T = robot.frame(q)
        return math.hypot(T[3], T[7], T[11])

    q = [0.0] * len(robot.turns)
    best = distance(q)
    for i, turns in enumerate(robot.turns):
        if best >= enough:
            break
        for quarter in (1, 2, 3) if turns else ():
            tried = [*q[:i], quarter * math.pi / 2.0, *q[i + 1 :]]
            if (found := distance(tried)) > best:
                best, q = found, tried
    return best >= enough
