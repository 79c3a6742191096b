"""The wheels of a base's description to a WheeledBase."""

from __future__ import annotations

import math
from collections.abc import Mapping as MappingType
from dataclasses import replace

from robokin.errors import or_list, shown
from robokin.formats.description_head import Head
from robokin.formats.node_values import (
    Context,
    choice_of,
    fields_of,
    flag_of,
    list_of,
    number_of,
    text_of,
    vector_of,
    whole_number_of,
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
    expected = attempt({}, _expected, fields["expected"], context) if "expected" in fields else {}
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
    kind = attempt(None, _type, cells["type"], where)
    for key, owners in OWN_KEYS.items():
        if kind is not None and key in cells and kind not in owners:
            context.faults.add(
                cells[key].mark.error(
                    f"found '{key}' {where}, a {kind} wheel, expected it only on type {or_list(owners)}"
                )
            )
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


def _type(node: Node, where: str) -> str:
    """The type of a wheel; what other books call it is answered with our word."""
    text = text_of(node, f"the type {where}: {or_list(WHEEL_TYPES)}")
    if text.casefold() in OTHER_NAMES:
        raise node.mark.error(f"found '{shown(text)}' as the type {where}, expected {OTHER_NAMES[text.casefold()]}")
    return choice_of(node, WHEEL_TYPES, f"the type {where}")


def _expected(node: Node, context: Context) -> dict[str, int]:
    """What the source says of the base's freedoms."""
    cells = fields_of(node, BASE_EXPECTED, "what is expected", context.faults)
    return {
        key: context.faults.attempt(0, whole_number_of, cell, context, f"expected {key}") for key, cell in cells.items()
    }
