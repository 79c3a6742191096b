"""The wheels of a base's description to a WheeledBase."""

from __future__ import annotations

import math
from collections.abc import Mapping as MappingType
from dataclasses import replace

from robokin.errors import shown
from robokin.formats.description_head import Head
from robokin.formats.node_values import (
    Context,
    choice_of,
    fields_of,
    flag_of,
    list_of,
    number_of,
    refuse_keys_of_others,
    text_of,
    type_of,
    vector_of,
    whole_numbers_of,
)
from robokin.formats.plausibility import notes_on
from robokin.formats.schema import BASE_EXPECTED, MAX_ROWS, STEERINGS, WHEEL, WHEEL_TYPES
from robokin.formats.yaml_tree import Node
from robokin.model import Wheel, WheeledBase

OWN_KEYS = {"offset": ("castor",), "roller": ("swedish",), "turned": ("steered", "castor")}
"""Keys that belong to some types of wheels."""

OTHER_NAMES = {"omni": "swedish with roller: 90 degrees", "mecanum": "swedish with roller: 45 degrees",
               "steering": "steered", "standard": "fixed", "caster": "castor",
               "spherical": "ball", "sphere": "ball"}  # fmt: skip
"""What other books call a type of wheel."""

NO_ROLL = 1e-6
"""Sine of the angle between a Swedish wheel's way and its rollers' below which the wheel would drive nothing."""


def read_wheeled(head: Head) -> WheeledBase:
    """The wheeled base with the fields of `head`. Raises DescriptionError."""
    fields, context = head.fields, head.context
    attempt = context.faults.attempt
    wheels = attempt(None, _wheels, fields["wheels"], context)
    parallel = False
    if "steering" in fields:
        parallel = attempt(False, _steering, fields["steering"], wheels)
    expected = attempt({}, whole_numbers_of, fields["expected"], BASE_EXPECTED, context) if "expected" in fields else {}
    context.faults.stop()
    assert wheels is not None  # else there was a mistake
    base = WheeledBase(
        name=head.name,
        wheels=wheels,
        parallel=parallel,
        id=head.id,
        description=head.description,
        source=head.source,
        units=context.units,
        parameters=head.parameters,
        expected=expected,
    )
    return replace(base, notes=notes_on(context, base))


def _wheels(node: Node, context: Context) -> tuple[Wheel, ...] | None:
    """The wheels; None, and the mistakes gathered, where one is wrong."""
    nodes = list_of(node, "the wheels")
    if not nodes:
        raise node.mark.error("found no wheels, expected at least one")
    if len(nodes) > MAX_ROWS:
        raise node.mark.error(f"found {len(nodes)} wheels, expected at most {MAX_ROWS}")
    before = context.faults.count
    wheels: list[Wheel] = []
    names: dict[str, int] = {}
    for i, item in enumerate(nodes, start=1):
        wheel = context.faults.attempt(None, _wheel, item, i, context)
        if wheel is None:
            continue
        if wheel.name in names:
            context.faults.add(
                item.mark.error(
                    f"found the name '{shown(wheel.name)}' of wheel {i} on wheel {names[wheel.name]} too, "
                    "expected another name"
                )
            )
        names.setdefault(wheel.name, i)
        wheels.append(wheel)
    return tuple(wheels) if context.faults.count == before else None


def _steering(node: Node, wheels: tuple[Wheel, ...] | None) -> bool:
    parallel = choice_of(node, STEERINGS, "the steering") == "parallel"
    if wheels is not None and not any(wheel.type == "steered" for wheel in wheels):
        raise node.mark.error("found 'steering' without a steered wheel, expected a wheel to steer")
    return parallel


def _wheel(node: Node, i: int, context: Context) -> Wheel | None:
    """A wheel; None, and the mistakes gathered, where it is wrong."""
    attempt = context.faults.attempt
    before = context.faults.count
    cells = fields_of(node, WHEEL, f"wheel {i}", context.faults)
    name = attempt(str(i), text_of, cells["name"], f"the name of wheel {i}") if "name" in cells else str(i)
    where = f"of wheel {shown(name)}"
    kind = attempt(None, type_of, cells["type"], WHEEL_TYPES, OTHER_NAMES, where)
    if kind is not None:
        refuse_keys_of_others(cells, OWN_KEYS, kind, "wheel", where, context)
    x, y = attempt((0.0, 0.0), _place, cells["at"], where, context)

    def number(key: str, *, angle: bool) -> float:
        if key not in cells:
            return 0.0
        return attempt(0.0, number_of, cells[key], context, f"{key} {where}", angle=angle)

    def flag(key: str) -> bool:
        return attempt(False, flag_of, cells[key], f"{key} {where}") if key in cells else False

    wheel = Wheel(
        name=name,
        type=kind or "",
        x=x,
        y=y,
        angle=number("angle", angle=True),
        radius=attempt(0.0, _radius, cells["radius"], where, context) if "radius" in cells else 0.0,
        offset=number("offset", angle=False),
        roller=attempt(0.0, _roller, cells, where, context) if kind == "swedish" else 0.0,
        driven=flag("driven"),
        turned=flag("turned"),
    )
    return wheel if context.faults.count == before and kind is not None else None


def _place(node: Node, where: str, context: Context) -> tuple[float, float]:
    list_of(node, f"at {where}", 2)
    x, y, _ = vector_of(node, context, f"at {where}", direction=False, plane=True)
    return float(x), float(y)


def _radius(node: Node, where: str, context: Context) -> float:
    radius = number_of(node, context, f"radius {where}", angle=False)
    if not radius > 0.0:
        raise node.mark.error(f"found {radius / context.units.metres:g} as radius {where}, expected more")
    return radius


def _roller(cells: MappingType[str, Node], where: str, context: Context) -> float:
    """The angle of a swedish wheel's rollers [rad]."""
    right = "90 degrees for an omni wheel, 45 for a mecanum wheel"
    if "roller" not in cells:
        raise cells["type"].mark.error(f"found no 'roller' {where}, a swedish wheel, expected its angle: {right}")
    roller = number_of(cells["roller"], context, f"roller {where}", angle=True)
    if abs(math.sin(roller)) < NO_ROLL:
        raise cells["roller"].mark.error(
            f"found rollers {where} that slip in the direction in which it rolls, expected an angle: {right}"
        )
    return roller
