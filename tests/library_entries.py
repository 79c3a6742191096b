"""The library for tests that go through it: each file is read once a run, and names are told apart by kind."""

from __future__ import annotations

import math
from functools import cache

from robokin.formats import library_names, load_any
from robokin.model import Mechanism, Robot, WheeledBase


@cache
def entry(name: str) -> Robot | Mechanism | WheeledBase:
    """What the library has under a name, which is frozen."""
    return load_any(name)


def names_of(kind: type, least: int = 0, most: float = math.inf) -> list[str]:
    """The names of the library's robots, mechanisms or wheeled bases; of robots those with so many joints."""
    named = [name for name in library_names() if isinstance(entry(name), kind)]
    return [name for name in named if kind is not Robot or least <= entry(name).n <= most]
