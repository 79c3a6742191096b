"""`robokin ik --target TIP=…`: targets for several tips of a tree, from what is typed to the answer."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, cast

from robokin.cli.option_groups import ArrayOutputOptions, DescriptionOptions
from robokin.cli.statuses import DONE, NO, say
from robokin.errors import ExpressionError, InputError, shown

if TYPE_CHECKING:
    from robokin.cli.targets import Target
    from robokin.inverse.analysis import Task
    from robokin.model import Tree
    from robokin.units import Units

OPTION = "--target"

STEP = re.compile(r"\s*([^\W\d]\w*)\s*\(")
"""A name with what is given to it in parentheses."""

EXPECTED = "expected TIP=X,Y,Z for a position or TIP=EXPR for a pose"


def refuse_beside(typed: Mapping[str, Any]) -> None:
    """Raise InputError where an option was typed that does not go with --target; typed: values by option."""
    for option, value in typed.items():
        if value is not None and value is not False:
            raise InputError(f"{OPTION} and {option} exclude each other, expected one of them")


def answer_tips(
    name: str,
    texts: Sequence[str],
    *,
    near: str | None,
    output: ArrayOutputOptions,
    description: DescriptionOptions,
    arguments: Mapping[str, Any],
) -> int:
    """Write the answer to targets such as `index=150,20,-40`, and give the status; arguments: those of `solve_tips`.

    Raises InputError for what is no target, and for a robot of one tip.
    """
    from robokin.cli.configurations import typed_configurations
    from robokin.inverse.tip_targets import solve_tips
    from robokin.model.joint_units import joint_factors
    from robokin.reports.tip_solution_report import FORMATS, TipSolutionReport
    from robokin.tables.sink import sink

    kind = output.kind
    if kind not in FORMATS:
        raise InputError(f"{OPTION}: found the format {kind}, expected table, json, jsonl or csv")
    tree, units = description.tree(name)
    if tree.serial:
        raise InputError(f"{OPTION}: {tree.name} is a serial robot, expected --pose, --matrix, --xyz or --xy")
    targets = parse_tip_targets(texts, tree, units)
    for note in (note for target in targets.values() for note in target.notes):
        say(note)
    wish = None
    if near is not None:
        wish = typed_configurations([near], tree, units, "--near")[0] * joint_factors(tree, units)
    answer = solve_tips(
        tree,
        {tip: target.T for tip, target in targets.items()},
        {tip: cast("Task", target.task) for tip, target in targets.items()},
        near=wish,
        **arguments,
    )
    with sink(output.file) as stream:
        for data in TipSolutionReport(answer, units, near is not None).written(kind):
            stream.write(data)
    return DONE if answer.reachable else NO


def parse_tip_targets(texts: Sequence[str], tree: Tree, units: Units) -> dict[str, Target]:
    """The targets by the tips' names. Raises InputError for unknown tips, a tip twice, and what is no target."""
    from robokin.inverse.tip_targets import check_tip

    found: dict[str, Target] = {}
    for text in texts:
        tip, equals, value = text.partition("=")
        tip = tip.strip()
        if not equals or not tip or not value.strip():
            raise InputError(f"{OPTION}: found '{shown(text)}', {EXPECTED}")
        check_tip(tree, tip, OPTION)
        if tip in found:
            raise InputError(f"{OPTION}: {shown(tip)} has two targets, expected one for a tip")
        found[tip] = _target(value, f"{OPTION} {shown(tip)}", units)
    return found


def _target(text: str, option: str, units: Units) -> Target:
    """A position of three numbers, or the pose that a transform expression says."""
    import numpy as np

    from robokin.cli.arguments import parse_numbers
    from robokin.cli.targets import Target, placed
    from robokin.formats.number_expressions import Scope
    from robokin.formats.transform_expressions import evaluate_transform
    from robokin.tables.pose_files import pose_in_json

    if text.lstrip().startswith("[["):
        try:
            T, note = pose_in_json(text, option, units)
        except ValueError as error:
            raise InputError(f"{option}: {error}") from None
        return Target(T, "pose", (note,) if note else ())
    if not _is_expression(text):
        place = parse_numbers(text, option, [False] * 3, units, "x, y, z, or a transform expression") * units.metres
        return Target(placed(np.eye(3), place, option, units), "position")
    notes: list[str] = []
    try:
        T = evaluate_transform(text, Scope(degrees=units.degrees), units, notes)
    except ExpressionError as error:
        raise InputError(f"{option}: {error}") from None
    return Target(placed(T[:3, :3], T[:3, 3], option, units), "pose", tuple(notes))


def _is_expression(text: str) -> bool:
    """Whether a text begins with a step, such as `Trans(`, and not with a number or a function of numbers."""
    from robokin.formats.number_expressions import RESERVED

    first = STEP.match(text)
    return first is not None and first[1] not in RESERVED
