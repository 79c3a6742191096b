"""Whether the numbers of a description look like those of another unit: notes, never errors.

What is looked for is a slip between metres and millimetres (a factor of 1000) or degrees and radians (57.3), of one
number or of all. Each rule names what makes it sure enough; what could as well be meant is not noted. Lengths of
hundreds of metres that cancel, as calibration finds them, are looked at by the arm's size.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable

from robokin.errors import Note
from robokin.formats.node_values import Context, Number
from robokin.formats.written_numbers import decimals, is_part_of_pi, is_whole_degrees, whole
from robokin.model import CoupledRobot, Mechanism, Robot, WheeledBase

FARTHEST = 100.0
"""Reach [m] that no arm has; gantries have some tens."""

FARTHEST_ARM = 60.0
"""Reach [m] of an arm with hinges alone that is noted in a file in metres: few booms are longer."""

NEAREST = 1e-3
"""Reach [m] below which nothing is built by joints."""

NEAREST_IN_SMALL_UNITS = 1e-2
"""The same in a file whose unit is small, where 1.2 for 1.2 m is a slip: the smallest fingers have some 40 mm."""

SMALL_ARM = 6e-2
"""Reach [m] below which, in such a file, lengths below a millimetre are noted if they are written with few decimals."""

TURNS = 20.0
"""A joint's value [rad] that is hardly meant, three turns; robots' last joints turn by ±400° (7 rad) and more."""

MOST_TURNS = 100
"""Turns up to which limits in radians are taken for what they are if they are a multiple of pi."""

FACTOR = 1000.0
"""Between metres and millimetres."""

FITS = 5.0
"""A number that is a thousand times off must fit among the others once that is mended, at most this far beyond them."""

OUTLIERS = ((20.0, 40.0), (5.0, 100.0))
"""In a file in metres a length of so much must be so many times the others to be taken for millimetres."""

SMALL = 5.0
"""In a file in millimetres a length must be below this to be taken for metres."""

LARGE_ARM = 20.0
"""The same where the others are whole metres and more, all written without decimals."""

SLIDES = ("limits", "the")
"""First words of what numbers are that say how a joint moves, and not how the arm is made: limits and poses."""

WORLD = ("base",)
"""The same for where an arm stands."""


def notes_on(context: Context, described: Robot | Mechanism | WheeledBase) -> tuple[Note, ...]:
    """What looks like a slip in a description, one note for each kind, at its first place."""
    angles = [number for number in context.numbers if number.angle and number.value]
    lengths = [number for number in context.numbers if not number.angle and number.value]
    found = [
        _degrees(angles) if not context.units.degrees else _radians(angles),
        _outliers(context, lengths) or _size(context, lengths, described),
    ]
    return tuple(note for note in found if note is not None)


# Angles ----------------------------------------------------------------------------------------------


def _degrees(angles: list[Number]) -> Note | None:
    """Numbers of degrees in a file in radians: constants beyond a turn, joint values beyond three.

    Of limits one end may be a whole number beyond a turn, if the other is written as radians are.
    """
    partners = _partners(angles)

    def wrong(number: Number) -> bool:
        size = abs(number.value)
        if "pi" in number.text or is_part_of_pi(number.value, number.text, MOST_TURNS) or size <= 2.0 * math.pi + 0.01:
            return False
        other = partners.get(id(number))
        beside = other is not None and decimals(other.text) >= 3 and whole(number.text)
        return size > TURNS or not _moves(number) or beside

    return _note(
        angles,
        wrong,
        lambda number: f"{number.value:g} rad, more than a turn: if degrees are meant, state `units: {{angle: deg}}`",
    )


def _radians(angles: list[Number]) -> Note | None:
    """Numbers of radians in a file in degrees: decimals of pi, and limits within a few degrees."""
    partners = _partners(angles)

    def narrow(number: Number) -> bool:
        other = partners.get(id(number))
        if not number.what.startswith("limits") or abs(number.value) > 2.0 * math.pi:
            return False
        if other is None or whole(other.text):  # 0 and a whole number say nothing of the unit
            return is_whole_degrees(number.value, number.text)
        ends = (number, other)
        if max(abs(end.value) for end in ends) > 2.0 * math.pi:
            return False
        wide = max(abs(end.value) for end in ends) >= 1.0 and any(decimals(end.text) >= 1 for end in ends)
        return wide or all(is_whole_degrees(end.value, end.text) for end in ends)

    def said(number: Number) -> str:
        part = "" if narrow(number) else ", the decimals of a part of pi"
        return f"{number.value:g} degrees{part}: if radians are meant, state `units: {{angle: rad}}`"

    return _note(angles, lambda number: is_part_of_pi(number.value, number.text) or narrow(number), said)


def _partners(angles: list[Number]) -> dict[int, Number]:
    """The other end of each of the limits that has one that is not 0, by `id`."""
    ends: dict[str, list[Number]] = {}
    for number in angles:
        if number.what.startswith("limits"):
            ends.setdefault(number.what, []).append(number)
    return {id(pair[i]): pair[1 - i] for pair in ends.values() if len(pair) == 2 for i in range(2)}


# Lengths ---------------------------------------------------------------------------------------------


def _size(context: Context, lengths: list[Number], described: Robot | Mechanism | WheeledBase) -> Note | None:
    """An arm or a mechanism that is too large or too small to be built."""
    if not lengths:
        return None
    metres, unit = context.units.metres, context.units.length
    made = [number for number in lengths if _makes(number)] or lengths
    size = _reach(described, lengths) if isinstance(described, Robot) else max(abs(n.value) for n in lengths) * metres
    hinges = isinstance(described, Robot) and bool(described.n) and bool(described.revolute.all())
    small = isinstance(described, Robot) and unit != "m"
    if size > (FARTHEST_ARM if hinges and unit == "m" else FARTHEST):
        too, other = "large", "`units: {length: mm}`" if unit == "m" else "a larger number of a smaller unit"
    elif 0.0 < size < (NEAREST_IN_SMALL_UNITS if small else NEAREST) or (
        small and 0.0 < size < SMALL_ARM and _fine(lengths)
    ):
        too, other = "small", "`units: {length: m}`" if unit != "m" else "metres"
    else:
        return None
    number = max(made, key=lambda number: abs(number.value))
    what = "the arm's reach" if isinstance(described, Robot) else "the mechanism's size"
    return Note(
        f"{_called(number)} is {number.value:g} {unit}, and so {what} {size:.3g} m, which is too {too} for a machine: "
        f"if another unit is meant, state {other}",
        number.mark.file, number.mark.line, number.mark.column,
    )  # fmt: skip


def _fine(lengths: list[Number]) -> bool:
    """Whether some lengths are below 1 and none is written with many decimals, as metres are."""
    return any(abs(number.value) < 1.0 for number in lengths) and all(decimals(n.text) <= 2 for n in lengths)


def _reach(robot: Robot, lengths: list[Number]) -> float:
    """How far an arm reaches at most [m], slides without limits at rest; from sums of the table where these are not
    suspicious, since they are quicker."""
    metres = robot.units.metres
    slides = sum(
        max((abs(end) for end in joint.limits if math.isfinite(end)), default=0.0)
        for joint in robot.joints
        if joint.type == "prismatic"
    )
    made = sum(abs(number.value) for number in lengths if _makes(number)) * metres
    if made + slides <= FARTHEST_ARM or not robot.n:
        return made + slides
    import numpy as np

    from robokin.kernel.chain import chain_of, chain_size  # what is far off may cancel
    from robokin.kinematics.forward import forward_kinematics

    tip = (forward_kinematics(robot, np.zeros(robot.n)) - robot.base)[:3, 3]
    arm = robot.free_motion if isinstance(robot, CoupledRobot) else robot
    return min(max(chain_size(chain_of(arm)), float(np.linalg.norm(tip))), made) + slides


def _outliers(context: Context, lengths: list[Number]) -> Note | None:
    """Lengths that are a thousand times off the others, and among them if that is mended."""
    metres = context.units.length == "m"
    if context.units.length not in ("m", "mm"):
        return None
    suspect = _may_be_millimetres if metres else _may_be_metres
    others = [number for number in lengths if _makes(number) and not suspect(number)]
    others = others or [number for number in lengths if number.what.startswith("limits") and not suspect(number)]
    if not others:
        return None
    suspects = [number for number in lengths if suspect(number) and not number.what.startswith("limits")]
    least, most = (choose(abs(number.value) for number in others) for choose in (min, max))
    finest = max(decimals(number.text) for number in others)
    # Whoever states micrometres elsewhere means them here.
    if not metres and (most < 10.0 or finest > 2):
        return None

    def wrong(number: Number) -> bool:
        size = abs(number.value)
        if number.what.startswith("the pose") or (metres and number.what.startswith("limits")):
            return False
        if metres:
            outlies = any(size >= enough and size >= ratio * most for enough, ratio in OUTLIERS)
            if not outlies or not _fits(size / FACTOR, least, most, FITS):
                return False
            # Lengths that cancel are those of frames far off, as calibration puts them; others say where an arm stands.
            beside = [other for other in suspects if other is not number]
            cancels = any(abs(number.value + other.value) <= 2.0 * most for other in beside)
            return not cancels and (_makes(number) or all(other.what != number.what for other in beside))
        if suspect(number):
            # A frame stands a little beside an axis often enough, a row of a table hardly ever.
            return _fits(size * FACTOR, least, most, 1.0 if number.what.startswith("origin") else FITS)
        large = size < LARGE_ARM and finest == 0 and decimals(number.text) > 0
        return large and _fits(size * FACTOR, least, most, 1.0)

    def said(number: Number) -> str:
        mended = number.value / FACTOR if metres else number.value * FACTOR
        unit, other, than = ("m", "mm", "more") if metres else ("mm", "m", "less")
        return (
            f"{number.value:g} {unit}, about a thousand times {than} than the other lengths, which are up to {most:g} "
            f"{unit}: if {other} are meant, write {mended:.10g}"
        )

    return _note(lengths, wrong, said)


def _fits(size: float, least: float, most: float, factor: float) -> bool:
    return least / factor <= size <= most * factor


def _may_be_millimetres(number: Number) -> bool:
    return abs(number.value) >= OUTLIERS[-1][0]


def _may_be_metres(number: Number) -> bool:
    """Whether a number in a file in millimetres is written as metres are; what comes from an expression is not."""
    size = abs(number.value)
    few = decimals(number.text)
    return (size < 1.0 and few >= 1) or (size < SMALL and few >= 2)


# Notes -----------------------------------------------------------------------------------------------


def _moves(number: Number) -> bool:
    return number.what.split()[0] in SLIDES


def _makes(number: Number) -> bool:
    """Whether a number says how an arm is made, and not how it moves or where it stands."""
    return number.what.split()[0] not in (*SLIDES, *WORLD)


def _note(numbers: Iterable[Number], wrong: Callable[[Number], bool], said: Callable[[Number], str]) -> Note | None:
    """A note on the first number that is wrong, with how many more there are."""
    found = [number for number in numbers if wrong(number)]
    if not found:
        return None
    first = min(found, key=lambda number: (number.mark.line, number.mark.column))
    places = {(number.mark.line, number.mark.column, number.value) for number in found}
    more = f" (and {len(places) - 1} more)" if len(places) > 1 else ""
    mark = first.mark
    return Note(f"{_called(first)} is {said(first)}{more}", mark.file, mark.line, mark.column)


def _called(number: Number) -> str:
    """What a number is, as a sentence begins: `alpha of row 1`, `a limit of row 1`, `a length in the tool`."""
    first, _, rest = number.what.partition(" ")
    if first == "limits":
        return f"a limit {rest}"
    if first == "the":
        return f"a value of {number.what}"
    if first in ("base", "tool", "origin"):
        return f"{'an angle' if number.angle else 'a length'} in the {number.what}"
    return number.what
