"""What several rooms of tests share."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

DATA = Path(__file__).parent / "data"


@pytest.fixture
def rng() -> np.random.Generator:
    """Random numbers that are the same in every run."""
    return np.random.default_rng(560)


def data(name: str) -> Any:
    """A file of golden values."""
    return json.loads((DATA / name).read_text())


@pytest.fixture(params=["base", "avx2"])
def instructions(request: pytest.FixtureRequest) -> Iterator[str]:
    """Each set of vector instructions of the native kernel that this machine has, in use within the test."""
    from robokin.kernel.native_kernel import native

    if native is None:
        pytest.skip("no native kernel in use")
    before = native.instructions()
    try:
        native.instructions(request.param)
    except ValueError:
        pytest.skip("this machine does not have them")
    yield request.param
    native.instructions(before)
