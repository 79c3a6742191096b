"""What every JSON document says first: the version of its schema, what it is about, and the units of its quantities."""

from __future__ import annotations

from typing import Any

from robokin.units import Units

SCHEMA = 1
"""The version of all documents. Keys are only added to a version; a key that changes its meaning makes a new one."""


def envelope(key: str, about: str | None, units: Units | None, id: str | None = None) -> dict[str, Any]:
    """The first keys of a document.

    `key` is the command's own word for what the document is about (robot, mechanism, name, file, …) and `about` its
    value, which stands under `id` too, unless the library knows it by another `id`. `units` is None where a document
    holds no quantities.
    """
    record: dict[str, Any] = {"schema": SCHEMA, key: about, "id": about if id is None else id}
    if units is not None:
        record["units"] = units.as_record()
    return record


def configuration_record(head: dict[str, Any], q: list[float], within: bool, pose: dict[str, Any]) -> dict[str, Any]:
    """The answer of `fk` about a robot at one configuration, below the first keys of its document."""
    return {**head, "q": q, "within_limits": within, "pose": pose}
