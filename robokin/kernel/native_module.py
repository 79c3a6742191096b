"""Which native kernel there is, if any. Nothing else is loaded here: who has numbers alone needs no arrays."""

from __future__ import annotations

import os
import sys

from robokin.errors import InputError

TYPE_CHECKING = False  # `typing` has the same, and takes a while to load
if TYPE_CHECKING:
    from types import ModuleType

INTERFACE = 10
"""What the C code offers; one of another version, as an old build leaves it in the sources, is not used."""


def native_module() -> ModuleType | None:
    """The kernel for what ROBOKIN_KERNEL says; None for Python's own code. Raises InputError."""
    choice = os.environ.get("ROBOKIN_KERNEL", "")
    if choice not in ("", "python", "native"):
        raise InputError(f"ROBOKIN_KERNEL is {choice}, expected python or native")
    # A Python without its lock would load a module that is not made for it.
    if choice != "python" and "t" not in getattr(sys, "abiflags", ""):
        try:
            from robokin.kernel import _native
        except ImportError:
            pass
        else:
            if getattr(_native, "interface", None) == INTERFACE:
                return _native
    if choice == "native":
        raise missing()
    return None


def missing() -> InputError:
    """The error where the kernel that is insisted on is not there."""
    return InputError("ROBOKIN_KERNEL is native, but this installation has no native kernel")
