"""The native kernel, where there is one: frames, Jacobians and residuals of chains, and numbers as text, in C.

It is optional and gives what Python's code gives, but for the last digits. `ROBOKIN_KERNEL=python` does without it,
`ROBOKIN_KERNEL=native` insists on it.
"""

from __future__ import annotations

import os
from types import ModuleType

import numpy as np

from robokin.kernel.chain import Chain
from robokin.kernel.facts import fact
from robokin.kernel.native_module import missing, native_module


def _with_arrays(module: ModuleType | None) -> ModuleType | None:
    """The kernel, if this numpy is one that it knows."""
    try:
        if module is not None:
            module.with_arrays()
    except ImportError:
        if os.environ.get("ROBOKIN_KERNEL") == "native":
            raise missing() from None
        return None
    return module


native = _with_arrays(native_module())
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
