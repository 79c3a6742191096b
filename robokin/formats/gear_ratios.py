"""The ratio of gears and belts, as a description states it: by itself, by teeth, by radii."""

from __future__ import annotations

from collections.abc import Mapping as MappingType

from robokin.formats.node_values import Context, flag_of, list_of, number_of, raw_number_of
from robokin.formats.yaml_tree import Node

GEARED = ("ratio", "teeth", "radii")
"""Keys that state a ratio; one of them says it."""

MOST_TEETH = 10**6
"""Teeth of a wheel; more are a slip of the key."""


def gearing_of(
    cells: MappingType[str, Node], kind: str, space: str, links: tuple[str, ...], where: str, context: Context
) -> tuple[tuple[float, ...], bool]:
    """A number for each link, which its turns are multiplied by to be the same for all; whether they are teeth that
    mesh. Empty where no ratio is stated. Raises DescriptionError."""
    given = [key for key in GEARED if key in cells]
    if len(given) > 1:
        raise cells[given[1]].mark.error(f"found '{given[0]}' and '{given[1]}' {where}, expected one of them")
    for key in ("crossed", "carrier", "axes"):
        if key in cells and not given and kind in ("gear", "belt"):
            raise cells[key].mark.error(f"found '{key}' {where} without a ratio, expected {_ways(kind)} beside it")
    if not given:
        return (), False
    (key,) = given
    if "axis" in cells:
        raise cells["axis"].mark.error(
            f"found 'axis' and '{key}' {where}, expected one of them: the common normal of a contact, or the ratio"
        )
    if (key == "ratio" or kind == "gear") and len(links) != 2:
        raise cells["links"].mark.error(f"found {len(links)} links {where}, expected two: a ratio is that of two")
    if len(links) != 2 and "crossed" in cells:
        raise cells["crossed"].mark.error(f"found 'crossed' {where}, expected radii below 0 for pulleys on the back")
    if key == "ratio":
        return _by_ratio(cells, kind, where, context), False
    nodes = list_of(cells[key], f"{key} {where}", len(links))
    if key == "radii":
        numbers = context.faults.each(lambda node: _pulley(node, where, context), nodes)
    else:
        numbers = context.faults.each(lambda node: _teeth(node, where, context), nodes)
    if kind == "belt" and _crossed(cells, where):
        numbers[1] = -numbers[1]
    return tuple(numbers), kind == "gear"


def _ways(kind: str) -> str:
    return "'ratio' or 'teeth'" if kind == "gear" else "'ratio', 'radii' or 'teeth'"


def _by_ratio(cells: MappingType[str, Node], kind: str, where: str, context: Context) -> tuple[float, float]:
    node = cells["ratio"]
    ratio = raw_number_of(node, context.scope, f"ratio {where}")
    if not abs(ratio) > 1e-9 or not abs(ratio) < 1e9:
        raise node.mark.error(f"found {ratio:g} as ratio {where}, expected one between 1e-9 and 1e9, or below 0")
    if kind == "belt" and ratio < 0.0:
        raise node.mark.error(f"found {ratio:g} as ratio {where}, expected more than 0: `crossed: true` turns it round")
    return 1.0, -ratio if kind == "belt" and _crossed(cells, where) else ratio


def _crossed(cells: MappingType[str, Node], where: str) -> bool:
    return "crossed" in cells and flag_of(cells["crossed"], f"crossed {where}")


def _pulley(node: Node, where: str, context: Context) -> float:
    radius = number_of(node, context, f"radii {where}", angle=False)
    if not abs(radius) > 0.0:
        raise node.mark.error(f"found 0 as a radius {where}, expected more: a pulley's radius")
    return radius


def _teeth(node: Node, where: str, context: Context) -> float:
    number = raw_number_of(node, context.scope, f"teeth {where}")
    if number != int(number) or not 1 <= number <= MOST_TEETH:
        raise node.mark.error(f"found {number:g} teeth {where}, expected a whole number from 1 to {MOST_TEETH}")
    return number
