"""Joints whose values hang on those of others, as a description says it."""

from __future__ import annotations

from robokin.errors import did_you_mean, shown
from robokin.formats.node_values import Context, fields_of, list_of, number_of, raw_number_of, text_of
from robokin.formats.schema import COUPLING
from robokin.formats.yaml_tree import Mapping, Node, Scalar
from robokin.model.graph import Coupling, GraphJoint


def couplings_of(node: Node, joints: tuple[GraphJoint, ...], context: Context) -> tuple[Coupling, ...]:
    """The couplings of some joints; mistakes are gathered. Raises DescriptionError where there is no list."""
    found: list[Coupling] = []
    for item in list_of(node, "couplings: a list"):
        coupling = context.faults.attempt(None, _coupling, item, joints, context)
        if coupling is not None and coupling.joint in [one.joint for one in found]:
            context.faults.add(item.mark.error(f"found a second coupling of {coupling.joint}, expected one with all"))
        elif coupling is not None:
            found.append(coupling)
    return tuple(found)


def _coupling(node: Node, joints: tuple[GraphJoint, ...], context: Context) -> Coupling | None:
    """One coupling, its ratios and offset in SI."""
    before = context.faults.count
    fields = fields_of(node, COUPLING, "a coupling", context.faults)
    own = "adds" in fields
    if own == ("follows" in fields):
        raise node.mark.error("found no 'follows' and no 'adds' in a coupling, or both, expected one of them")
    joint = context.faults.attempt(None, _named, fields["joint"], joints)
    others = fields["adds" if own else "follows"]
    pairs: list[tuple[Node, Node | None]] = [(others, fields.get("ratio"))]
    if isinstance(others, Mapping):
        if "ratio" in fields:
            raise fields["ratio"].mark.error("found 'ratio' beside a mapping of joints to ratios, expected one of them")
        pairs = [(Scalar(name, others.keys[name], quoted=True), value) for name, value in others.entries.items()]
        if not pairs:
            raise others.mark.error("found no joints in a coupling, expected a mapping of joints to ratios")
    ratios = []
    for name, value in pairs:
        other = context.faults.attempt(None, _named, name, joints)
        number = 1.0
        if value is not None:
            number = context.faults.attempt(1.0, raw_number_of, value, context.scope, "the ratio")
        if joint is not None and other is not None:
            unit = context.factor(joint.turns) / context.factor(other.turns)
            ratios.append((other.name, number * unit if joint.turns != other.turns else number))
    if joint is None or context.faults.count > before:
        return None
    offset = 0.0
    if "offset" in fields:
        offset = number_of(fields["offset"], context, "the offset of a coupling", angle=joint.turns)
    return Coupling(joint.name, tuple(ratios), offset, own)


def _named(node: Node, joints: tuple[GraphJoint, ...]) -> GraphJoint:
    """The moving joint that is called so: by its branch and name, or by its name alone where that is unique."""
    text = text_of(node, "the name of a joint")
    moving = [joint for joint in joints if joint.moves]
    full = [joint for joint in moving if joint.name == text]
    found = full or [joint for joint in moving if joint.name.partition(".")[2] == text]
    if len(found) == 1:
        return found[0]
    names = [joint.name for joint in moving]
    if found:
        raise node.mark.error(f"found '{shown(text)}' in several branches, expected one of {', '.join(names)}")
    hint = did_you_mean(text, names) or f", expected one of {', '.join(names[:12])}"
    raise node.mark.error(f"found the unknown joint '{shown(text)}'{hint}")
