"""`.npy` files written as the arrays come, their number not known beforehand."""

from __future__ import annotations

from typing import IO

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class ArrayWriter:
    """Writes blocks (m, ...) of float64 one after the other as one array.

    The header is written again at the end, when the number of rows is known; NumPy pads it so that its
    length does not depend on that number.
    """

    def __init__(self, stream: IO[bytes], shape: tuple[int, ...]) -> None:
        """Start an array whose rows have the given shape, on a stream that can seek."""
        self.stream = stream
        self.shape = shape
        self.count = 0
        self._header()

    def write(self, block: Array) -> None:
        """Append a block (m, *shape)."""
        self.count += len(block)
        self.stream.write(np.ascontiguousarray(block, dtype="<f8").data)

    def close(self) -> None:
        """Write the final header."""
        self.stream.seek(0)
        self._header()

    def _header(self) -> None:
        header = {"descr": "<f8", "fortran_order": False, "shape": (self.count, *self.shape)}
        np.lib.format.write_array_header_1_0(self.stream, header)
