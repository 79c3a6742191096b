"""The wheels of a base's description to a WheeledBase."""

from __future__ import annotations

import math
from collections.abc import Mapping as MappingType

from robokin.description.cells import (
    Context,
    choice_of,
    fields_of,
    flag_of,
    list_of,
    number_of,
    raw_number_of,
    text_of,
    vector_of,
)
from robokin.description.read import Head
from robokin.description.schema import BASE_EXPECTED, MAX_ROWS, STEERINGS, WHEEL, WHEEL_TYPES
from robokin.description.tree import Node
from robokin.errors import or_list, shown
from robokin.model import Wheel, WheeledBase

OWN_KEYS = {"offset": ("castor",), "roller": ("swedish",), "turned": ("steered", "castor")}
"""Keys that belong to some types of wheels."""

OTHER_NAMES = {"omni": "swedish with roller: 90 degrees", "mecanum": "swedish with roller: 45 degrees",
               "steering": "steered", "standard": "fixed", "caster": "castor",
               "spherical": "ball", "sphere": "ball"}  # fmt: skip
"""What other books call a type of wheel."""

NO_ROLL = 1e-6
"""Sine of the angle between a Swedish wheel's way and its rollers' below which the wheel would drive nothing."""


def read_wheeled(fields: MappingType[str, Node], head: Head) -> WheeledBase:
    """The wheeled base with these fields. Raises DescriptionError."""
    nodes = list_of(fields["wheels"], "the wheels")
    if not nodes:
        raise fields["wheels"].mark.error("found no wheels, expected at least one")
    if len(nodes) > MAX_ROWS:
        raise fields["wheels"].mark.error(f"found {len(nodes)} wheels, expected at most {MAX_ROWS}")
    wheels: list[Wheel] = []
    names: dict[str, int] = {}
    for i, node in enumerate(nodes, start=1):
        wheel = _wheel(fields_of(node, WHEEL, f"wheel {i}"), i, head.context)
        if wheel.name in names:
            raise node.mark.error(
                f"found the name '{shown(wheel.name)}' of wheel {i} on wheel {names[wheel.name]} too, "
                "expected another name"
            )
        names[wheel.name] = i
        wheels.append(wheel)
    parallel = False
    if "steering" in fields:
        parallel = choice_of(fields["steering"], STEERINGS, "the steering") == "parallel"
        if not any(wheel.type == "steered" for wheel in wheels):
            raise fields["steering"].mark.error("found 'steering' without a steered wheel, expected a wheel to steer")
    return WheeledBase(
        name=head.name,
        wheels=tuple(wheels),
        parallel=parallel,
        id=head.id,
        description=head.description,
        source=head.source,
        units=head.context.units,
        parameters=head.parameters,
        expected=_expected(fields["expected"], head.context) if "expected" in fields else {},
    )


def _wheel(cells: MappingType[str, Node], i: int, context: Context) -> Wheel:
    name = text_of(cells["name"], f"the name of wheel {i}") if "name" in cells else str(i)
    where = f"of wheel {shown(name)}"
    kind = _type(cells["type"], where)
    for key, owners in OWN_KEYS.items():
        if key in cells and kind not in owners:
            raise cells[key].mark.error(
                f"found '{key}' {where}, a {kind} wheel, expected it only on type {or_list(owners)}"
            )
    list_of(cells["at"], f"at {where}", 2)
    x, y, _ = vector_of(cells["at"], context, f"at {where}", direction=False, plane=True)

    def number(key: str, *, angle: bool) -> float:
        return number_of(cells[key], context, f"{key} {where}", angle=angle) if key in cells else 0.0

    radius = number("radius", angle=False)
    if "radius" in cells and not radius > 0.0:
        raise cells["radius"].mark.error(f"found {radius / context.units.metres:g} as radius {where}, expected more")
    roller = number("roller", angle=True)
    if kind == "swedish":
        right = "90 degrees for an omni wheel, 45 for a mecanum wheel"
        if "roller" not in cells:
            raise cells["type"].mark.error(f"found no 'roller' {where}, a swedish wheel, expected its angle: {right}")
        if abs(math.sin(roller)) < NO_ROLL:
            raise cells["roller"].mark.error(
                f"found rollers {where} that slip in the direction in which it rolls, expected an angle: {right}"
            )
    return Wheel(
        name=name,
        type=kind,
        x=float(x),
        y=float(y),
        angle=number("angle", angle=True),
        radius=radius,
        offset=number("offset", angle=False),
        roller=roller,
        driven=flag_of(cells["driven"], f"driven {where}") if "driven" in cells else False,
        turned=flag_of(cells["turned"], f"turned {where}") if "turned" in cells else False,
    )


def _type(node: Node, where: str) -> str:
    """The type of a wheel; what other books call it is answered with our word."""
    text = text_of(node, f"the type {where}: {or_list(WHEEL_TYPES)}")
    if text.casefold() in OTHER_NAMES:
        raise node.mark.error(f"found '{shown(text)}' as the type {where}, expected {OTHER_NAMES[text.casefold()]}")
    return choice_of(node, WHEEL_TYPES, f"the type {where}")


def _expected(node: Node, context: Context) -> dict[str, int]:
    """What the source says of the base's freedoms."""
    numbers = {}
    for key, cell in fields_of(node, BASE_EXPECTED, "what is expected").items():
        number = raw_number_of(cell, context.scope, f"expected {key}")
        if number != int(number):
            raise cell.mark.error(f"found {number:g} as expected {key}, expected a whole number")
        numbers[key] = int(number)
    return numbers
