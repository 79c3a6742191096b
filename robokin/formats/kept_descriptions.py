"""Descriptions that are read once and kept, for who answers many questions in one process."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Hashable, Iterator
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from robokin.model import Mechanism, Robot, Tree, WheeledBase

MOST_KEPT = 32
"""Descriptions that are kept."""


class Kept:
    """What was read, by the bytes that it was read from; None where nothing is kept."""

    descriptions: dict[Any, Robot | Mechanism | WheeledBase | Tree] | None = None


def keeps() -> bool:
    """Whether what is read is kept: then what is found out of it is found out once."""
    return Kept.descriptions is not None


@contextlib.contextmanager
def kept_descriptions() -> Iterator[None]:
    """Here what has been read once is not made again, unless its bytes have changed."""
    Kept.descriptions = {}
    try:
        yield
    finally:
        Kept.descriptions = None


def read_once(
    key: Hashable, read: Callable[[], Robot | Mechanism | WheeledBase | Tree]
) -> Robot | Mechanism | WheeledBase | Tree:
    """What `read` gives, or has given for this key where descriptions are kept."""
    if Kept.descriptions is None:
        return read()
    found = Kept.descriptions.pop(key, None)
    found = read() if found is None else found
    Kept.descriptions[key] = found  # the last that was asked for
    if len(Kept.descriptions) > MOST_KEPT:
        del Kept.descriptions[next(iter(Kept.descriptions))]
    return found
