"""Which links of a tree are its tips, by what they are called where there is a choice."""

from __future__ import annotations

import re
from collections.abc import Sequence

from robokin.model.graph import GraphJoint, Tip

TOOL_WORDS = (
    "tool0", "tcp", "ee", "eef", "end_effector", "endeffector", "tool", "gripper_frame", "grasp",
    "gripper", "hand", "flange",
)  # fmt: skip
"""Words in the names of links that are meant as tips, the surest first."""

SURE = 9
"""So many of them are tips even where something moves on the same body: the point between a gripper's fingers."""


def default_tips(links: Sequence[str], joints: Sequence[GraphJoint]) -> tuple[Tip, ...]:
    """The tips of a tree of links, in the order of the links.

    A body is what fixed joints hold together. Of a body on which no other moves, the leaf whose name has the surest
    word is a tip, and all its leaves where none has one. Other leaves are tips if their names say so for sure.
    """
    body = list(range(len(links)))
    inner = {joint.parent for joint in joints}
    moved = {joint.child for joint in joints if joint.moves}
    above = {joint.child: joint.parent for joint in joints}

    def bearer(link: int) -> int:
        """The first link of a link's body."""
        way = []
        while link not in moved and link in above and body[link] == link:
            way.append(link)
            link = above[link]
        for other in way:
            body[other] = body[link]
        return body[link]

    bearing = {bearer(joint.parent) for joint in joints if joint.moves}
    leaves: dict[int, list[int]] = {}
    for link in range(len(links)):
        if link not in inner:
            leaves.setdefault(bearer(link), []).append(link)
    chosen: list[int] = []
    for first, group in leaves.items():
        ranks = {link: _rank(links[link]) for link in group}
        best = min(ranks.values())
        if first in bearing:
            chosen += [link for link in group if ranks[link] < SURE]
        else:
            chosen += [link for link in group if ranks[link] == best]
    return tuple(Tip(links[link], link) for link in sorted(chosen))


def _rank(name: str) -> int:
    """The number of the first of `TOOL_WORDS` in a name, or their count."""
    ranks = (
        number
        for number, word in enumerate(TOOL_WORDS)
        if re.search(rf"(?<![a-z]){word}(?![a-z])", name, re.IGNORECASE)
    )
    return next(ranks, len(TOOL_WORDS))
