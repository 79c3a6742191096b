"""Whole numbers drawn from a seed: the same on every machine, in every version of Python and numpy.

The numbers are those of SHA-256 over a seed, a student, a question and a count, so that nobody's depend on who else is
in the class, on the order, or on how many numbers another question takes.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from typing import TypeVar

Value = TypeVar("Value")

BLOCK = 8
"""Bytes of a number; the remainder of a division by less than 2^32 is even to a part in 2^32."""


class SeededNumbers:
    """A stream of numbers that its names alone decide."""

    def __init__(self, *names: str) -> None:
        # As JSON, so that no two lists of names are one text.
        self.names = json.dumps(["robokin questions", 1, *names], ensure_ascii=True).encode()
        self.count = 0
        self.left = b""

    def below(self, most: int) -> int:
        """A whole number from 0 to most - 1, all equally likely."""
        if not self.left:
            self.left = hashlib.sha256(self.names + self.count.to_bytes(8, "big")).digest()
            self.count += 1
        block, self.left = self.left[:BLOCK], self.left[BLOCK:]
        return int.from_bytes(block, "big") % most

    def choice(self, values: Sequence[Value]) -> Value:
        """One of some values, all equally likely."""
        return values[self.below(len(values))]
