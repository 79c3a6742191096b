"""`robokin check dof`: answered counts of freedoms."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from robokin.cli.check_options import CountMarkOptions
from robokin.cli.completion import robots, words
from robokin.cli.options import choose, option, parameter_overrides
from robokin.errors import InputError, shown

SPACES = ("planar", "spherical", "spatial")


def command(
    name: Annotated[
        str | None,
        typer.Argument(
            metavar="[NAME]",
            help="A mechanism or a robot: of `robokin list`, or a path to a description.",
            autocompletion=robots,
            show_default=False,
        ),
    ] = None,
    *,
    expect: Annotated[str | None, option("--expect", "N", "The answer for Grübler's count.")] = None,
    mobility: Annotated[str | None, option("--mobility", "N", "The answer for the true mobility.")] = None,
    links: Annotated[str | None, option("--links", "N", "Without a description: links, with the ground.")] = None,
    joints: Annotated[
        str | None, option("--joints", "JOINTS", "With --links: joints by type, such as 6R or 12S,6P.")
    ] = None,
    space: Annotated[
        str | None, option("--space", "SPACE", "With --links: planar, spherical or spatial.", words(*SPACES))
    ] = None,
    way: CountMarkOptions,
) -> int:
    """Mark an answered number of freedoms: Grübler's count, the true mobility, or both.

    Examples:
        robokin check dof four-bar --expect 1
        robokin check dof sarrus --expect 0 --mobility 1 --json
        robokin check dof --links 7 --joints 6R --space spatial --expect 6
    """
    from robokin.grading.count_marks import count_item
    from robokin.grading.mark_items import Report

    if expect is None and mobility is None:
        raise InputError("--expect is missing, expected --expect N for the count or --mobility N for the true mobility")
    bare = {"--links": links, "--joints": joints, "--space": space}
    given = [option for option, value in bare.items() if value is not None]
    if name is not None and given:
        raise InputError(f"{given[0]} counts without a description, expected it without {name}")
    if name is None and way.set_:
        raise InputError("--set is for a description, expected its name")
    record = _counted(links, joints, space) if name is None else _described(name, parameter_overrides(way.set_))
    items = []
    if expect is not None:
        items.append(count_item("count", expect, "--expect", record["grubler"], ""))
    if mobility is not None:
        note = str(record["note"] or "there is no geometry")
        items.append(count_item("mobility", mobility, "--mobility", record["mobility"], note))
    label = record["name"] or "counted"
    return way.deliver(Report("dof", str(record.get("id") or name or label), None, {}, tuple(items)))


def _counted(links: str | None, joints: str | None, space: str | None) -> dict[str, Any]:
    """The count of bare numbers."""
    from robokin.formats.joint_counts import parse_joints
    from robokin.grading.answers.typed_answers import whole_number
    from robokin.records.count_records import bare_record

    if links is None or joints is None or space is None:
        raise InputError("NAME is missing, expected a mechanism, or all of --links, --joints and --space")
    chosen = choose(space, SPACES, "--space")
    number = whole_number(links, "--links")
    if number is None or not 1 <= number <= 10**6:
        raise InputError(f"--links: found '{shown(links)}', expected a whole number from 1 to 1000000")
    assert chosen is not None
    return bare_record(number, parse_joints(joints, chosen), chosen)


def _described(name: str, overrides: dict[str, str]) -> dict[str, Any]:
    """The count and the mobility of what a description describes."""
    from robokin.cli.arguments import load_noted
    from robokin.mobility.verdict import mobility_of
    from robokin.model import Mechanism, Robot, Tree
    from robokin.records.freedom_records import jointed_record, mechanism_record

    entry = load_noted(name, overrides, None, None)
    if isinstance(entry, Mechanism):
        return mechanism_record(mobility_of(entry), entry.units, 0)
    if isinstance(entry, Robot | Tree):
        return jointed_record(entry, entry.units)
    raise InputError(f"{name} is a wheeled base, expected a mechanism or a robot")
