"""What all kinds of description begin with."""

from __future__ import annotations

from dataclasses import dataclass

from robokin.formats.node_values import Context
from robokin.formats.yaml_tree import Node


@dataclass(frozen=True)
class Head:
    """What stands before the table: the common fields, read; `fields` are all."""

    fields: dict[str, Node]
    id: str
    name: str
    description: str
    source: str
    parameters: dict[str, float]
    context: Context
