"""Which part of a description is meant: a chain of a tree, and how a file of another format is read."""

from __future__ import annotations

from collections.abc import Mapping as MappingType
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from robokin.errors import InputError

if TYPE_CHECKING:
    from robokin.model import Mechanism, Robot, Tree, WheeledBase


@dataclass(frozen=True)
class Part:
    """tip, root: the names of the links, or tips, between which the chain is; None for the only tip and the root.

    exact: whether angles of other formats that are right angles cut in print are taken as they are written.
    packages: the folders of packages that a xacro file names. whole: whether a tree is asked for even where it has
    one tip.
    """

    tip: str | None = None
    root: str | None = None
    exact: bool = False
    packages: MappingType[str, str] = field(default_factory=dict)
    whole: bool = False

    def of(self, described: Robot | Mechanism | WheeledBase | Tree) -> Robot | Mechanism | WheeledBase | Tree:
        """The part of what a file describes. Raises InputError where it has none such."""
        from robokin.model import Robot, Tree

        named = self.tip is not None or self.root is not None
        if isinstance(described, Robot) and (named or self.whole):
            described = tree_of(described)
        if not isinstance(described, Tree):
            if named:
                raise InputError("--tip, --root: expected the description of a robot or a tree")
            return described
        if self.whole or not (named or described.serial):
            return described
        return described.robot(self.tip, self.root)


def tree_of(robot: Robot) -> Tree:
    """A serial robot as a tree of one branch."""
    from robokin.model import Tree

    return Tree(
        robot.name,
        robot.graph,
        robot.id,
        robot.description,
        robot.source,
        robot.units,
        robot.parameters,
        robot.poses,
        robot.notes,
    )
