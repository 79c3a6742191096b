"""Apache Arrow, which comes with `robokin[parquet]`: loaded where a file in one of its formats is read or written."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from robokin.errors import InputError

ENDINGS = {".parquet": "parquet", ".arrow": "arrow", ".feather": "arrow"}
"""Formats by the ending of a name. Feather (version 2) is Arrow's own format of files."""

KINDS = ("parquet", "arrow")

MAGIC = {b"PAR1": "parquet", b"ARROW1": "arrow", b"\xff\xff\xff\xff": "arrow"}
"""What files begin with; the last is a stream, without the index that a file has at its end."""


def pyarrow(module: str = "pyarrow") -> Any:
    """A module of Arrow's library. Raises InputError where it is not installed."""
    try:
        return import_module(module)
    except ImportError as error:
        missing = error.name if isinstance(error, ModuleNotFoundError) else "pyarrow"
        raise InputError(
            f"found no module {missing}, expected pyarrow for Parquet and Arrow files: pip install 'robokin[parquet]'"
        ) from None


def kind_of_start(head: bytes) -> str | None:
    """The format of a file that begins with some bytes, eight of them if there are so many; None for another one."""
    return next((kind for magic, kind in MAGIC.items() if head.startswith(magic)), None)
