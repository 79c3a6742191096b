"""The fields of a tree's description, branches with couplings and tips, to a Tree."""

from __future__ import annotations

from dataclasses import dataclass, replace
from graphlib import CycleError, TopologicalSorter

import numpy as np

from robokin.arrays import Array
from robokin.errors import InputError, did_you_mean, shown
from robokin.formats.chain_forms import BRANCH_FORMS, form_of, read_chain, without_other_keys
from robokin.formats.couplings import couplings_of
from robokin.formats.description_head import Head
from robokin.formats.node_values import (
    Context,
    choice_of,
    fields_of,
    list_of,
    text_of,
    transform_of,
)
from robokin.formats.robot_fields import poses_of
from robokin.formats.schema import CONVENTIONS, MAX_ROWS, OTHER_FORMS, TIP
from robokin.formats.yaml_tree import Mapping, Node, describe
from robokin.model import Joint, JointType, Tree
from robokin.model.graph import Graph, GraphJoint, Tip
from robokin.model.robot import graph_joint

WORLD = "base"
"""The link that branches stand on which name none."""


@dataclass(frozen=True)
class _Branch:
    """A serial chain; `on` is the branch, or the joint, at whose end it stands, "" for the base."""

    name: str
    on: str
    base: Array
    tool: Array
    rows: tuple[Joint, ...]
    convention: str
    node: Node

    @property
    def end(self) -> str:
        """The name of its last link."""
        return f"{self.name}.{self.rows[-1].name}"


def read_tree_fields(head: Head) -> Tree:
    """The tree with these fields. Raises DescriptionError."""
    fields, context = head.fields, head.context
    attempt = context.faults.attempt
    convention = "standard"
    if "convention" in fields:
        known = (*CONVENTIONS, *OTHER_FORMS)
        convention = attempt(convention, choice_of, fields["convention"], known, "the convention")
    branches = attempt({}, _branches, fields["branches"], convention, context)
    base = attempt(np.eye(4), transform_of, fields["base"], context, "base") if "base" in fields else np.eye(4)
    context.faults.stop()
    ends = _ends(branches)
    joints = tuple(_joints(branches, ends, context))
    context.faults.stop()
    couplings = attempt((), couplings_of, fields["couplings"], joints, context) if "couplings" in fields else ()
    tips = tuple(attempt([], _tips, fields.get("tips"), branches, ends, context))
    context.faults.stop()
    links = (WORLD, *(f"{branch.name}.{row.name}" for branch in branches.values() for row in branch.rows))
    try:
        graph = Graph(links, joints, base=base, tips=tips, couplings=couplings)
    except InputError as error:  # a circle of couplings, which has no place of its own
        raise fields.get("couplings", fields["branches"]).mark.error(str(error)) from None
    types = tuple(JointType.of(graph.joints[number].turns) for number in graph.variables)
    poses = attempt({}, poses_of, fields["poses"], types, context) if "poses" in fields else {}
    context.faults.stop()
    return Tree(head.name, graph, head.id, head.description, head.source, context.units, head.parameters, poses)


def _branches(node: Node, convention: str, context: Context) -> dict[str, _Branch]:
    if not isinstance(node, Mapping) or not node.entries:
        raise node.mark.error(f"found {describe(node)}, expected branches: a mapping of names to chains")
    found: dict[str, _Branch] = {}
    for name, value in node.entries.items():
        if not name.replace("-", "_").isidentifier() or name == WORLD:
            context.faults.add(
                node.keys[name].error(
                    f"found the branch '{shown(name)}', expected a name of letters, digits, - and _, not {WORLD}"
                )
            )
        branch = context.faults.attempt(None, _branch, name, value, convention, context)
        if branch is not None:
            found[name] = branch
    if sum(len(branch.rows) for branch in found.values()) > MAX_ROWS:
        raise node.mark.error(f"found more than {MAX_ROWS} rows in all branches, expected at most {MAX_ROWS}")
    return found


def _branch(name: str, node: Node, convention: str, context: Context) -> _Branch | None:
    """One branch, its chain in any of the forms that a robot's has; None where it is wrong."""
    form = "table"
    if isinstance(node, Mapping):
        form = form_of(node, convention)
        node = without_other_keys(node, form, context.faults, BRANCH_FORMS)
    fields = fields_of(node, BRANCH_FORMS[form], f"the branch {shown(name)}", context.faults)
    attempt = context.faults.attempt
    chain = read_chain(fields, context, convention if convention in CONVENTIONS else "standard")
    base, tool = (
        attempt(np.eye(4), transform_of, fields[key], context, f"{key} of {name}") if key in fields else np.eye(4)
        for key in ("base", "tool")
    )
    on = attempt("", text_of, fields["on"], "the name of a branch") if "on" in fields else ""
    on = "" if on == WORLD else on
    if chain.rows is None or chain.convention is None:
        return None
    tool = tool if np.array_equal(chain.tail, np.eye(4)) else chain.tail @ tool
    return _Branch(name, on, base, tool, chain.rows, chain.convention, fields.get("on", node))


def _ends(branches: dict[str, _Branch]) -> dict[str, tuple[str, Array]]:
    """The link, by its name, and the tool (4, 4) there that each name of a place means: branches and joints."""
    ends = {"": (WORLD, np.eye(4)), WORLD: (WORLD, np.eye(4))}
    for branch in branches.values():
        ends |= {f"{branch.name}.{row.name}": (f"{branch.name}.{row.name}", np.eye(4)) for row in branch.rows}
    return ends | {branch.name: (branch.end, branch.tool) for branch in branches.values()}


def _joints(branches: dict[str, _Branch], ends: dict[str, tuple[str, Array]], context: Context) -> list[GraphJoint]:
    """The joints of all branches in the order of the file."""
    links = [WORLD, *(f"{branch.name}.{row.name}" for branch in branches.values() for row in branch.rows)]
    below = {}
    for branch in branches.values():
        if branch.on not in ends:
            hint = did_you_mean(branch.on, ends) or f", expected one of {', '.join([*branches])}"
            context.faults.add(branch.node.mark.error(f"found the unknown branch '{shown(branch.on)}'{hint}"))
        below[branch.name] = {branch.on.partition(".")[0]} & branches.keys()
    try:
        TopologicalSorter(below).prepare()
    except CycleError as error:
        circle = " → ".join(error.args[1][::-1])
        first = branches[error.args[1][0]]
        raise first.node.mark.error(
            f"the branches stand on each other in a circle, {circle}, expected one that stands on the {WORLD}"
        ) from None
    context.faults.stop()
    joints: list[GraphJoint] = []
    for branch in branches.values():
        parent, tool = ends[branch.on]
        carried = tool @ branch.base
        for row in branch.rows:
            name = f"{branch.name}.{row.name}"
            ends_of_row = links.index(parent), links.index(name)
            joint = graph_joint(row, branch.convention, *ends_of_row, name, len(joints))
            joints.append(replace(joint, before=carried @ joint.before))
            parent, carried = name, np.eye(4)
    return joints


def _tips(
    node: Node | None, branches: dict[str, _Branch], ends: dict[str, tuple[str, Array]], context: Context
) -> list[Tip]:
    """The tips that are listed; by default every branch on which nothing stands."""
    links = [WORLD, *(f"{branch.name}.{row.name}" for branch in branches.values() for row in branch.rows)]
    if node is None:
        carrying = {branch.on.partition(".")[0] for branch in branches.values()}
        names = [name for name in branches if name not in carrying]
        return [Tip(name, links.index(ends[name][0]), ends[name][1]) for name in names]
    found: list[Tip] = []
    for item in list_of(node, "tips: a list of branches"):
        tip = context.faults.attempt(None, _tip, item, links, ends, context)
        if tip is not None and tip.name in [one.name for one in found]:
            context.faults.add(item.mark.error(f"found the tip '{tip.name}' twice, expected different names"))
        elif tip is not None:
            found.append(tip)
    if not found:
        raise node.mark.error("found no tips, expected at least one")
    return found


def _tip(item: Node, links: list[str], ends: dict[str, tuple[str, Array]], context: Context) -> Tip:
    tool = np.eye(4)
    if isinstance(item, Mapping):
        fields = fields_of(item, TIP, "a tip", context.faults)
        name, place = text_of(fields["name"], "the name of a tip"), fields.get("on", fields["name"])
        if "tool" in fields:
            tool = context.faults.attempt(tool, transform_of, fields["tool"], context, f"tool of {name}")
    else:
        name, place = text_of(item, "the name of a branch"), item
    on = text_of(place, "the name of a branch, or of a joint")
    if on not in ends or not on:
        hint = did_you_mean(on, [end for end in ends if end]) or ", expected the name of a branch, or branch.joint"
        raise place.mark.error(f"found the unknown place '{shown(on)}' of a tip{hint}")
    link, own = ends[on]
    return Tip(name, links.index(link), own @ tool)
