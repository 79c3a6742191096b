"""The native kernel, where there is one: frames, Jacobians and residuals of chains, and numbers as text, in C.

It is optional and gives what Python's code gives, but for the last digits. `ROBOKIN_KERNEL=python` does without it,
`ROBOKIN_KERNEL=native` insists on it.
"""

from __future__ import annotations

import os
import sys
from types import ModuleType

import numpy as np

from robokin.errors import InputError
from robokin.kernel.chain import Chain
from robokin.kernel.facts import fact

INTERFACE = 2
"""What the C code offers; one of another version, as an old build leaves it in the sources, is not used."""


def _loaded(choice: str) -> ModuleType | None:
    """The kernel for what ROBOKIN_KERNEL says; None for Python's own code."""
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
        raise InputError("ROBOKIN_KERNEL is native, but this installation has no native kernel")
    return None


native = _loaded(os.environ.get("ROBOKIN_KERNEL", ""))
"""The kernel in use, or None."""

kernel_in_use = "python" if native is None else "native"


@fact
def handle(chain: Chain) -> object | None:
    """What the native kernel knows a chain by; None where Python follows it."""
    if native is None or chain.n > native.most_joints or not chain.n:
        return None
    made: object = native.chain(
        np.ascontiguousarray(chain.constants), chain.revolute.astype(np.float64), np.ascontiguousarray(chain.offsets)
    )
    return made
