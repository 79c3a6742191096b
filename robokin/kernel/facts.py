"""What is found out once of a robot, a chain or a space, and kept on that object.

Such objects are frozen: what follows from their fields never changes. It lives as long as the object, and is no part
of it: copies by value and pickles leave it behind, and it has no say in equality.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar, TypeVarTuple

NAME = "_facts"
"""The attribute that holds them, beside the fields."""

Owner = TypeVar("Owner")
Rest = TypeVarTuple("Rest")
Found = TypeVar("Found")


class Facts(dict[Any, Any]):
    """Answers by function and arguments."""

    def __reduce__(self) -> tuple[type[Facts], tuple[()]]:
        """Pickled and copied as empty: it is quicker to find them out again than to carry them along."""
        return Facts, ()


def fact(find: Callable[[Owner, *Rest], Found]) -> Callable[[Owner, *Rest], Found]:
    """A function of a frozen object, and of hashable arguments by position, that keeps its answers on the object."""

    @wraps(find)
    def known(owner: Owner, *rest: *Rest) -> Found:
        found: Found
        try:
            found = owner.__dict__[NAME][find, rest]
        except KeyError:
            pass
        else:
            return found
        found = find(owner, *rest)
        # Threads that find it out at the same time all go on with one: facts that rest on each other fit together.
        kept: Found = facts_of(owner).setdefault((find, rest), found)
        return kept

    return known


def facts_of(owner: object) -> Facts:
    """The facts that are known of an object."""
    # A frozen dataclass lets its attributes be set here only.
    facts: Facts = vars(owner).setdefault(NAME, Facts())
    return facts


def tell(known: Callable[..., object], found: object, owner: object, *rest: object) -> None:
    """Have an answer of a `fact` that was found out by another way."""
    find: Any = known
    facts_of(owner)[find.__wrapped__, rest] = found
