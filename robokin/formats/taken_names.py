"""The names that a file gives, and names for what it leaves without one."""

from __future__ import annotations

from robokin.errors import shown
from robokin.formats.xml_tree import XmlNode


class TakenNames:
    """The names that there are, of every kind of element."""

    def __init__(self) -> None:
        self.taken: dict[str, set[str]] = {}

    def take(self, node: XmlNode, kind: str, name: str) -> str:
        """A name, if no other has it. Raises DescriptionError."""
        known = self.taken.setdefault(kind, set())
        if name in known:
            raise node.error(f"found the {kind} {shown(repr(name))} twice, expected different names", "name")
        if name:
            known.add(name)
        return name

    def free(self, kind: str, name: str) -> str:
        """A name that nothing of this kind has, near to the one given."""
        known = self.taken.setdefault(kind, set())
        while name in known:
            name += "~"
        known.add(name)
        return name
