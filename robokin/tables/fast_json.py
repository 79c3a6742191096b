"""pydantic's core, which Typer brings: it reads and writes JSON some ten times faster than Python does."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from importlib import import_module
from typing import Any


@cache
def pydantic_function(name: str) -> Callable[..., Any] | None:
    """A function of pydantic's core; None with an older Typer. Not loaded before it is used."""
    try:
        core = import_module("pydantic_core")
    except ImportError:
        return None
    return getattr(core, name, None)
