"""Questions about Grübler's count: a mechanism like one of the library, with other numbers of links."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar

from robokin.errors import InputError
from robokin.grading.count_marks import count_item
from robokin.grading.feedback import alike, joined
from robokin.grading.mark_items import NOT_A_NUMBER, WRONG, Item
from robokin.grading.marking import AnswerTask, GivenAnswer, GivenValue, NoAnswerError
from robokin.grading.mistakes import Mistake
from robokin.grading.questions.exercise import AskedQuantity, Exercise, Given
from robokin.grading.questions.seeded_numbers import SeededNumbers
from robokin.mobility.count import grubler
from robokin.model import Mechanism
from robokin.model.mechanism import LAMBDA

if TYPE_CHECKING:
    from robokin.grading.answers.answer_files import Row

FREEDOMS = MappingProxyType({"revolute": 1, "prismatic": 1, "cylindrical": 2, "universal": 2, "spherical": 3})
"""The joints of these questions, with their freedoms."""

NEW_JOINTS = {
    "planar": ("revolute", "revolute", "prismatic"),
    "spherical": ("revolute",),
    "spatial": ("revolute", "prismatic", "cylindrical", "universal", "spherical"),
}

FEWEST, MOST = -6, 9
"""Counts that are asked for."""

LARGEST = 20
"""Links or joints of a mechanism that somebody may be asked to count."""

FREEDOM = "freedoms"


@dataclass(frozen=True)
class Pairs:
    """What is counted of a mechanism: its space, its links, and its joints with the two links of each, from 0."""

    space: str
    links: int
    joints: tuple[tuple[str, int, int], ...]


@dataclass(frozen=True, eq=False)
class CountExercise(Exercise):
    """The count of a mechanism like one that is known."""

    pairs: Pairs

    kind: ClassVar[str] = "dof"
    wanting: ClassVar[str] = "few enough to count"

    def candidate(self, numbers: SeededNumbers) -> Given | None:
        """The mechanism with links put into its loops, and chains beside them."""
        joints: list[list[Any]] = [list(joint) for joint in self.pairs.joints]
        links = self.pairs.links
        for _ in range(1 + numbers.below(3)):
            if numbers.below(2):
                one = numbers.choice(joints)
                joints.append([numbers.choice(NEW_JOINTS[self.pairs.space]), links, one[2]])
                one[2] = links
                links += 1
            else:
                first = numbers.below(links)
                last = (first + 1 + numbers.below(links - 1)) % links
                between = 1 + numbers.below(2)
                stops = [first, *range(links, links + between), last]
                for a, b in pairwise(stops):
                    joints.append([numbers.choice(NEW_JOINTS[self.pairs.space]), a, b])
                links += between
        count = self._count(links, joints)
        if not FEWEST <= count <= MOST or max(links, len(joints)) > LARGEST:
            return None
        given = {"space": self.pairs.space, "joints": [[kind, *sorted((a, b))] for kind, a, b in joints]}
        asked = self.question(given)
        slips = [number for number, _ in asked["slips"].values() if number != asked["right"]]
        return given if len(set(slips)) == len(slips) else None  # so that a slip can be told from its number

    def _count(self, links: int, joints: Sequence[Sequence[Any]]) -> int:
        return grubler(LAMBDA[self.pairs.space], links, (FREEDOMS[joint[0]] for joint in joints))

    def quantities(self, given: Given) -> tuple[AskedQuantity, ...]:
        """One number."""
        return (AskedQuantity(FREEDOM),)

    def answers(self, given: Given) -> list[str]:
        """The count."""
        return [str(self.question(given)["right"])]

    def subject(self, given: Given) -> CountCheck:
        """The check of counts."""
        return CountCheck()

    def question(self, given: Given) -> dict[str, Any]:
        """The right number, and those that known mistakes lead to."""
        joints = given["joints"]
        links, order = 1 + max(max(joint[1:]) for joint in joints), LAMBDA[given["space"]]
        freedoms = [FREEDOMS[joint[0]] for joint in joints]
        slips = {
            "ground": (grubler(order, links - 1, freedoms), "the ground is a link, too"),
            "space": (grubler(9 - order, links, freedoms), f"a free link has {order} freedoms here"),
            "freedoms of joints": (grubler(order, links, [1] * len(joints)), "not each joint has one freedom"),
            "constraints": (order * (links - 1) - sum(freedoms), "what a joint takes away is λ minus its freedoms"),
        }
        return {"right": grubler(order, links, freedoms), "slips": slips}

    def answer(self, given: Given, row: Row) -> tuple[GivenAnswer, ...]:
        """The number that was answered."""
        fault: Any = f"line {row.line}: {row.fault}" if row.fault else row.cells[FREEDOM]
        return (GivenAnswer(GivenValue(fault), fault, line=row.line),)


@dataclass(frozen=True, eq=False)
class CountCheck:
    """What counts are marked against."""

    unsaid: ClassVar[Mapping[str, Any]] = MappingProxyType({})

    def mark(self, task: AnswerTask) -> tuple[Item]:
        """The mark of a number; a number that a known mistake leads to is said to be that."""
        asked, no_number = task.question(), {"count": None}
        right = asked["right"]
        try:
            text = task.answers[0].read()
        except NoAnswerError as wrong:
            return (task.item(wrong.status, 0.0, alike(wrong.detail), expected=right, error=no_number),)
        try:
            item = count_item(task.id, text, "answer", right, "")
        except InputError as error:
            return (task.item(NOT_A_NUMBER, 0.0, alike(str(error)), expected=right, error=no_number),)
        mistake = None
        if item.status == WRONG:
            found = [Mistake(name, said) for name, (count, said) in asked["slips"].items() if count == item.got]
            mistake = found[0] if len(found) == 1 else None
        words = item.words if mistake is None else joined([alike(mistake.said), item.words])
        return (
            Item(
                task.id, item.status, item.score, item.expected, item.got, item.error, words, task.student, task.line,
                mistake=None if mistake is None else mistake.name,
            ),
        )  # fmt: skip


def pairs_of(mechanism: Mechanism) -> Pairs | None:
    """What is counted of a mechanism, joints of many links taken apart; None where it has joints of other kinds."""
    if not all(joint.type in FREEDOMS for joint in mechanism.joints):
        return None
    graph = mechanism.graph
    order = [graph.root, *(i for i in range(len(mechanism.links)) if i != graph.root)]
    number = {link: place for place, link in enumerate(order)}
    joints = tuple((joint.type, number[joint.parent], number[joint.child]) for joint in graph.joints)
    return Pairs(mechanism.space, len(mechanism.links), joints)
