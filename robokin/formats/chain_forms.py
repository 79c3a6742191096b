"""Which way a robot's chain is written: as a table, as `screws`, by `ets` or by the lengths of `opw`."""

from __future__ import annotations

from collections.abc import Mapping as MappingType

import numpy as np

from robokin.errors import or_list
from robokin.formats.chain_parts import ChainParts
from robokin.formats.faults import Faults
from robokin.formats.joint_table import rows_of
from robokin.formats.node_values import Context, choice_of
from robokin.formats.schema import (
    BRANCH,
    BRANCH_ETS,
    BRANCH_OPW,
    BRANCH_SCREWS,
    CONVENTIONS,
    ETS,
    OPW,
    OTHER_FORMS,
    ROBOT,
    SCREWS,
    Fields,
)  # fmt: skip
from robokin.formats.yaml_tree import Mapping, Node, Scalar

FORMS: dict[str, Fields] = {"table": ROBOT, "screws": SCREWS, "ets": ETS, "opw": OPW}
BRANCH_FORMS: dict[str, Fields] = {"table": BRANCH, "screws": BRANCH_SCREWS, "ets": BRANCH_ETS, "opw": BRANCH_OPW}
"""What the description of a robot, and a branch of a tree, may hold in each form."""

NAMED = {
    "table": "a table of joints",
    "screws": "`convention: screws`",
    "ets": "`ets`",
    "opw": "`convention: opw`",
}
"""The forms as a message says them."""


def form_of(root: Mapping, stated: str = "") -> str:
    """The form that a chain is meant in, one of `FORMS`, by its keys and its convention, by default the stated one."""
    if "ets" in root.entries:
        return "ets"
    node = root.entries.get("convention")
    convention = node.text.strip() if isinstance(node, Scalar) else "" if node is not None else stated
    if convention in OTHER_FORMS:
        return convention
    if node is not None and convention not in CONVENTIONS:  # a slip of the key
        return "screws" if "home" in root.entries else "opw" if {"c2", "c3"} <= root.entries.keys() else "table"
    return "table"


def without_other_keys(
    root: Mapping, form: str, faults: Faults, forms: MappingType[str, Fields] = FORMS
) -> Mapping:  # fmt: skip
    """A description without the keys that belong to other forms than its own: these are mistakes."""
    known = forms[form]
    keys, entries = dict(root.keys), dict(root.entries)
    for name, mark in root.keys.items():
        owners = [NAMED[other] for other, fields in forms.items() if name in fields]
        if name not in known and owners:
            del keys[name], entries[name]
            said = f"'{name}' beside {NAMED[form]}" if form != "table" else f"'{name}' in {NAMED[form]}"
            why = ": 'home' is the tool's pose" if (form, name) == ("screws", "tool") else ""
            faults.add(mark.error(f"found {said}, expected it only with {or_list(owners)}{why}"))
    return Mapping(entries, root.mark, keys)


def read_chain(fields: MappingType[str, Node], context: Context, stated: str = "standard") -> ChainParts:
    """The chain that the fields of a robot or a branch describe; mistakes are gathered.

    stated: the convention of a table that says none. Raises DescriptionError where nothing of it can be read.
    """
    attempt = context.faults.attempt
    convention: str | None = stated
    if "convention" in fields:
        known = (*CONVENTIONS, *OTHER_FORMS)
        convention = attempt(None, choice_of, fields["convention"], known, "the convention")
    # Only the reader that is needed is imported: it is part of the time that a command takes to start.
    if "ets" in fields:
        from robokin.formats.elementary_steps import chain_of_steps

        return attempt(ChainParts(None, None, None), chain_of_steps, fields, context)
    if "home" in fields:
        from robokin.formats.screw_rows import chain_of_screws

        return chain_of_screws(fields, context)
    if "c2" in fields:
        from robokin.formats.opw_lengths import chain_of_opw

        return chain_of_opw(fields, context)
    rows, types = attempt((None, None), rows_of, fields["joints"], convention, context)
    return ChainParts(rows, types, convention, np.eye(4))
