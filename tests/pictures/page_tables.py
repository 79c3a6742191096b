"""Tables as the page of a workspace has them."""

from __future__ import annotations

import base64

import numpy as np


def unpacked(table):
    """The bytes of a page's table from its runs: a byte, and how many of it."""
    runs = np.frombuffer(base64.b64decode(table["runs"]), dtype=np.uint8).reshape(-1, 2)
    return np.repeat(runs[:, 0], runs[:, 1]).reshape(table["shape"])
