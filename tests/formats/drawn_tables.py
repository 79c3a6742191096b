"""Tables drawn at random, and slips between units in them.

Tables are drawn as people write them; a slip writes one number, or all, in the other unit (m and mm, deg and rad) and
leaves the stated units as they are. What no rule can see is counted too: a length of 15 mm written as 15 in a table in
metres, limits of a few degrees, whatever is as likely meant as not.
"""

from __future__ import annotations

import math
import random
from collections import Counter
from dataclasses import dataclass, field, replace

from robokin.errors import DescriptionError
from robokin.formats import read_text
from robokin.model import Robot

SOUND = 200
SLIPS = 500
SEED = 26

FORMS = {"theta": "angle", "alpha": "angle", "offset": "angle", "d": "length", "a": "length"}


@dataclass(frozen=True)
class Table:
    """A table in metres and degrees, and how it is written; rows: cells, limits (two numbers) under `limits`."""

    kind: str
    rows: tuple[dict[str, object], ...]
    length: str = "mm"
    angle: str = "deg"
    stated: bool = True
    tool: float = 0.0
    home: tuple[float, ...] = ()
    written: dict[tuple[object, ...], str] = field(default_factory=dict)

    def cells(self) -> list[tuple[tuple[object, ...], str, float]]:
        """Every number that is not 0: where it is, `length` or `angle`, its value [m | deg]."""
        found: list[tuple[tuple[object, ...], str, float]] = []
        for i, row in enumerate(self.rows):
            for name, value in row.items():
                kind = FORMS.get(name, "angle" if row["type"] == "R" else "length")
                if name == "offset" and row["type"] == "P":
                    kind = "length"
                for j, number in enumerate(value if isinstance(value, tuple) else (value,)):
                    if isinstance(number, float) and number:
                        found.append(((i, name, j), kind, number))
        if self.tool:
            found.append((("tool",), "length", self.tool))
        found += [(("home", i), "angle", value) for i, value in enumerate(self.home) if value]
        return found

    def text(self, wrong: tuple[tuple[object, ...], ...] = ()) -> str:
        """The description; the numbers at `wrong` are in the unit that is not stated."""
        texts = {}
        for place, kind, value in self.cells():
            texts[place] = self._number(kind, value, place in wrong)
        lines = ["robokin: 1", f"name: {self.kind}"]
        if self.stated:
            lines.append(f"units: {{length: {self.length}, angle: {self.angle}}}")
        lines.append("joints:")
        for i, row in enumerate(self.rows):
            parts = []
            for name, value in row.items():
                if name == "type":
                    parts.append(f"type: {value}")
                elif isinstance(value, tuple):
                    parts.append(f"{name}: [{', '.join(texts.get((i, name, j), '0') for j in range(2))}]")
                else:
                    parts.append(f"{name}: {texts.get((i, name, 0), '0')}")
            lines.append(f"  - {{{', '.join(parts)}}}")
        if self.tool:
            lines.append(f"tool: Trans(0, 0, {texts['tool',]})")
        if self.home:
            values = [texts.get(("home", i), "0") for i in range(len(self.home))]
            lines.append(f"poses: {{home: [{', '.join(values)}]}}")
        return "\n".join(lines) + "\n"

    def _number(self, kind: str, value: float, wrong: bool) -> str:
        if kind == "length":
            metres = (self.length == "m") != wrong
            return f"{value:.6g}" if metres else f"{value * 1000.0:.6g}"
        if (self.angle == "deg") != wrong:
            return f"{value:.6g}"
        radians = math.radians(value)
        return f"{radians:.4f}".rstrip("0").rstrip(".")


def sound_table(dice: random.Random) -> Table:
    """A table as somebody writes it who makes no slip."""
    kind = dice.choice(
        ["industrial", "cobot", "hobby", "lecture", "symbols", "planar", "scara", "gantry", "hand", "big"]
    )
    table = globals()[f"_{kind}"](dice)
    units = dice.choice([("mm", "deg")] * 5 + [("m", "deg")] * 2 + [("m", "rad")] * 2 + [("mm", "rad")])
    if kind in ("lecture", "symbols"):
        units = dice.choice([("m", "deg"), ("m", "rad"), ("m", "rad")])
    stated = units != ("m", "rad") or dice.random() < 0.5
    return replace(table, length=units[0], angle=units[1], stated=stated)


def tables_of(robot: Robot) -> list[Table]:
    """The table of a robot in four pairs of units, none of which it need have been written in."""
    rows: list[dict[str, object]] = []
    for row in robot.rows:
        factor = math.degrees(1.0) if row.type == "revolute" else 1.0
        cells: dict[str, object] = {"type": row.type.letter, "a": round(row.a, 8)}
        cells["alpha"] = round(math.degrees(row.alpha), 6)
        if row.type != "revolute":
            cells["theta"] = round(math.degrees(row.theta), 6)
        if row.type != "prismatic":
            cells["d"] = round(row.d, 8)
        if row.offset:
            cells["offset"] = round(row.offset * factor, 6)
        if not row.unlimited:
            cells["limits"] = tuple(round(end * factor, 6) for end in row.limits)
        rows.append(cells)
    units = [(length, angle) for length in ("m", "mm") for angle in ("deg", "rad")]
    return [Table(robot.id, tuple(rows), length, angle) for length, angle in units]


def _limits(dice: random.Random, low: int = 60, high: int = 180) -> tuple[float, float]:
    most = float(dice.randrange(low, high + 1, 5))
    return (-most, most) if dice.random() < 0.7 else (-most, float(dice.randrange(low, high + 1, 5)))


def _six(dice: random.Random, scale: float, step: float) -> list[dict[str, object]]:
    def length(least: float, most: float) -> float:
        return round(round(dice.uniform(least, most) * scale / step) * step, 6)

    alphas = dice.choice([(-90.0, 0.0, -90.0, 90.0, -90.0, 0.0), (90.0, 0.0, 90.0, -90.0, 90.0, 0.0)])
    lengths = [(0.3, 0.05), (0.0, 0.4), (0.0, 0.03), (0.4, 0.0), (0.0, 0.0), (0.08, 0.0)]
    rows = []
    for (d, a), alpha in zip(lengths, alphas, strict=True):
        row: dict[str, object] = {"type": "R"}
        row["d"] = length(0.8 * d, 1.4 * d) if d else 0.0
        row["a"] = length(0.8 * a, 1.4 * a) if a else 0.0
        row["alpha"] = alpha
        if dice.random() < 0.7:
            row["limits"] = _limits(dice)
        if dice.random() < 0.2:
            row["offset"] = dice.choice([-90.0, 90.0, 180.0])
        rows.append(row)
    return rows


def _industrial(dice: random.Random) -> Table:
    rows = _six(dice, dice.uniform(0.8, 3.0), dice.choice([0.005, 0.001, 0.0005]))
    rows[5]["limits"] = (-float(dice.choice([350, 360, 400])), float(dice.choice([350, 360, 400])))
    home = tuple(float(dice.choice([0, 0, 30, 45, 90, -90])) for _ in rows) if dice.random() < 0.5 else ()
    return Table("industrial", tuple(rows), tool=dice.choice([0.0, 0.1, 0.125]), home=home)


def _cobot(dice: random.Random) -> Table:
    def length(most: float) -> float:
        return round(dice.uniform(0.4 * most, most), 5)

    rows: list[dict[str, object]] = [
        {"type": "R", "d": length(0.2), "a": 0.0, "alpha": 90.0},
        {"type": "R", "d": 0.0, "a": -length(0.7), "alpha": 0.0},
        {"type": "R", "d": 0.0, "a": -length(0.6), "alpha": 0.0},
        {"type": "R", "d": length(0.2), "a": 0.0, "alpha": 90.0},
        {"type": "R", "d": length(0.15), "a": 0.0, "alpha": -90.0},
        {"type": "R", "d": length(0.12), "a": 0.0, "alpha": 0.0},
    ]
    for row in rows:
        row["limits"] = (-360.0, 360.0)
    return Table("cobot", tuple(rows))


def _hobby(dice: random.Random) -> Table:
    def length(least: int, most: int) -> float:
        return dice.randrange(2 * least, 2 * most) / 2000.0

    rows: list[dict[str, object]] = [
        {"type": "R", "d": length(30, 90), "a": 0.0, "alpha": 90.0},
        {"type": "R", "a": length(60, 130), "alpha": 0.0},
        {"type": "R", "a": length(60, 130), "alpha": 0.0},
        {"type": "R", "a": length(20, 80), "alpha": dice.choice([0.0, 90.0])},
    ]
    for row in rows:
        row["limits"] = (-90.0, 90.0) if dice.random() < 0.5 else (0.0, 180.0)
    return Table("hobby", tuple(rows[: dice.choice([3, 4])]))


def _lecture(dice: random.Random) -> Table:
    rows: list[dict[str, object]] = []
    for _ in range(dice.randrange(2, 7)):
        row: dict[str, object] = {"type": "R" if dice.random() < 0.75 else "P"}
        row["a"] = dice.choice([0.0, 1.0, 0.5, 2.0, 0.4, 10.0])
        if row["type"] == "R":
            row["d"] = dice.choice([0.0, 0.0, 1.0, 0.5])
        row["alpha"] = dice.choice([0.0, 90.0, -90.0, 180.0])
        rows.append(row)
    rows[0]["a"] = dice.choice([1.0, 0.5, 2.0])
    return Table("lecture", tuple(rows))


def _symbols(dice: random.Random) -> Table:
    alphas = [dice.choice([0.0, 90.0, -90.0]) for _ in range(dice.randrange(2, 7))]
    return Table("symbols", tuple({"type": "R", "a": 1.0, "d": dice.choice([0.0, 1.0]), "alpha": x} for x in alphas))


def _planar(dice: random.Random) -> Table:
    rows: list[dict[str, object]] = []
    for _ in range(dice.choice([2, 3])):
        row: dict[str, object] = {"type": "R", "a": dice.randrange(4, 24) * 0.05}
        if dice.random() < 0.6:
            row["limits"] = _limits(dice)
        rows.append(row)
    return Table("planar", tuple(rows))


def _scara(dice: random.Random) -> Table:
    rows: list[dict[str, object]] = [
        {"type": "R", "d": dice.randrange(150, 420) / 1000, "a": dice.randrange(125, 450, 25) / 1000},
        {"type": "R", "a": dice.randrange(125, 450, 25) / 1000, "alpha": 180.0},
        {"type": "P", "alpha": 0.0, "limits": (0.0, dice.choice([0.1, 0.15, 0.2, 0.21, 0.4]))},
        {"type": "R", "d": dice.choice([0.0, 0.05]), "limits": (-360.0, 360.0)},
    ]
    for row in rows[:2]:
        row["limits"] = _limits(dice, 100, 170)
    return Table("scara", tuple(rows))


def _gantry(dice: random.Random) -> Table:
    alphas = (-90.0, 90.0, 0.0)
    sizes = [dice.choice([1.2, 2.5, 6.0, 12.0, 20.0, 40.0]), dice.choice([0.8, 3.0, 8.0]), dice.choice([0.3, 0.5, 1.5])]
    rows: list[dict[str, object]] = [
        {"type": "P", "theta": 90.0, "alpha": alpha, "limits": (0.0, size)}
        for alpha, size in zip(alphas, sizes, strict=True)
    ]
    if dice.random() < 0.5:
        rows.append({"type": "R", "d": 0.25, "a": dice.choice([0.0, 0.15]), "limits": (-180.0, 180.0)})
    return Table("gantry", tuple(rows), tool=dice.choice([0.0, 0.12, 0.2]))


def _hand(dice: random.Random) -> Table:
    rows: list[dict[str, object]] = [
        {"type": "R", "a": dice.randrange(0, 25) / 1000, "alpha": 90.0, "limits": (-20.0, 20.0)},
        {"type": "R", "a": dice.randrange(380, 520) / 10000, "limits": (-10.0, 90.0)},
        {"type": "R", "a": dice.randrange(220, 320) / 10000, "limits": (0.0, 100.0)},
        {"type": "R", "a": dice.randrange(180, 260) / 10000, "limits": (0.0, 80.0)},
    ]
    return Table("hand", tuple(rows))


def _big(dice: random.Random) -> Table:
    rows: list[dict[str, object]] = [
        {"type": "R", "d": dice.randrange(10, 40) / 10, "alpha": 90.0, "limits": (-180.0, 180.0)},
        *(
            {"type": "R", "a": dice.randrange(30, 120) / 10, "limits": _limits(dice)}
            for _ in range(dice.choice([3, 4]))
        ),
    ]
    return Table("big", tuple(rows))


def slip(table: Table, dice: random.Random) -> tuple[str, str] | None:
    """A text of the table with a slip, and its kind; None where the table has no number to slip on."""
    kind = dice.choice(["length", "angle"])
    places = [place for place, what, value in table.cells() if what == kind]
    if not places:
        return None
    if dice.random() < 0.5:
        return table.text(tuple(places)), f"{kind}, all"
    return table.text((dice.choice(places),)), f"{kind}, one"


def noted(text: str) -> bool:
    """Whether a description is noted or refused."""
    try:
        return bool(read_text(text).notes)
    except DescriptionError:
        return True


def false_alarms(count: int = SOUND, seed: int = SEED) -> list[str]:
    """The sound tables, of so many, that are noted."""
    dice = random.Random(seed)
    return [text for text in (sound_table(dice).text() for _ in range(count)) if noted(text)]


def seen(count: int = SLIPS, seed: int = SEED) -> tuple[Counter[str], Counter[str], list[str]]:
    """Of so many slips, by kind: how many there are, how many are noted; the texts of those that are not."""
    dice = random.Random(seed)
    made: Counter[str] = Counter()
    found: Counter[str] = Counter()
    missed = []
    while sum(made.values()) < count:
        table = sound_table(dice)
        if (wrong := slip(table, dice)) is None:
            continue
        text, kind = wrong
        made[kind] += 1
        found[kind] += noted(text)
        if not noted(text):
            missed.append(f"# {kind}\n{text}")
    return made, found, missed
